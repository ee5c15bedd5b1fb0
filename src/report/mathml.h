// Mathematics as presentation MathML Core, for pages in HTML.
//
// The source is the LaTeX of expr/print.h and of ct_derivation_text for a page of CT_LOOK_HTML
// or CT_LOOK_LATEX; this module translates it:
//
//     \frac{m \, l^{2}}{3} \, \ddot{\theta}     ->     <mfrac>...</mfrac> <mover><mi>θ</mi><mo>¨</mo></mover>
//
// An equation is one element. Its sides are rows of terms that wrap; each term lists the
// components it comes from:
//
//     <math data-equation="main.u" class="equation">
//       <mrow class="side"> <mrow class="term" data-component="crank rod"> ... </mrow> ... </mrow>
//       <mrow class="right"> <mo>=</mo> <mrow class="side"> <mrow class="term" ...> ... </mrow> ... </mrow> </mrow>
//     </math>
//
// What always holds: the output is well-formed XML in UTF-8. Text of a model is escaped;
// characters that XML does not allow, invalid UTF-8, and those that change the direction of
// text become U+FFFD. Layout is left to ct_mathml_style; a page without it is readable.
#ifndef CT_REPORT_MATHML_H
#define CT_REPORT_MATHML_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/// Text in HTML and in attributes in double quotes: escaped, at most n bytes.
void ct_html_text(FILE *out, const char *s, size_t n);

/// Style sheet rules for this output.
extern const char ct_mathml_style[];

/// Mathematics, without an element `math` around it.
void ct_mathml_row(FILE *out, const char *latex);
/// The same in an element `math` of its own, within a line of text.
void ct_mathml_inline(FILE *out, const char *latex);

/// A term at the top level of a side of an equation.
struct ct_mathml_term {
    const char *latex;      ///< with its sign, as of ct_ex_terms: "m \\, g", " - m \\, g"
    const char *plain;      ///< text in place of latex, of class `plain`; NULL: latex
    const char *components; ///< names separated by blanks; NULL: not known, no attribute
    const char *value; ///< text of an element of class `value` after it; NULL: no such element
    const char *note;  ///< plain words behind all this, of class `note`; NULL: none
};

struct ct_mathml_side {
    const struct ct_mathml_term *term;
    size_t n; ///< 0: there is no such side
};

struct ct_mathml_equation {
    const char *name; ///< data-equation; NULL: no attribute
    struct ct_mathml_side left, right;
};

/// left = right, or left alone.
void ct_mathml_equation(FILE *out, const struct ct_mathml_equation *e);

/// nrow x ncolumn cells of mathematics, row by row; has_names: the first row and the first
/// column are names. "." is an entry that is zero, "" one that stays blank.
void ct_mathml_matrix(FILE *out, const char *const *cell, size_t nrow, size_t ncolumn,
                      bool has_names);

#endif
