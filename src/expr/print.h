// Expressions as text: for people, for LaTeX, for C.
//
//     text    m2*l1*l2*cos(q1 - q2)*u2^2 - m1*g*l1*sin(q1)      reads back as the same expression
//     LaTeX   m_{2} \, l_{1} \, l_{2} \, \cos\left(q_{1} - q_{2}\right) ...
//     C       ((m2*l1)*l2)*cos(q1 - q2)                          reads back as the same operations
//
// Text and LaTeX flatten sums and products and put them into an order that does not depend on the
// order of construction: factors are number, parameters, coordinates, functions, speeds,
// accelerations, multipliers; terms with accelerations come first, then speeds, coordinates,
// parameters, functions. C keeps every operation and its order, so that bits agree.
//
// What always holds: parentheses only where the grammar of model files needs them; numbers are the
// shortest that read back to the same bits.
#ifndef CT_EXPR_PRINT_H
#define CT_EXPR_PRINT_H

#include "expr/ex.h"

enum ct_print_style { CT_PRINT_TEXT, CT_PRINT_LATEX, CT_PRINT_C };

/// How to print. All zero: text, symbols by their names.
struct ct_print {
    enum ct_print_style style;
    /// The text of a symbol in this style; NULL: its name, made valid by ct_latex_name or
    /// ct_c_name.
    const char *(*symbol)(void *data, struct ct_arena *a, const struct ct_sym *s);
    /// A name to print instead of a node, or NULL to print the node (see share.h).
    const char *(*node)(void *data, ct_ex e);
    /// Rank of a symbol: symbols of a product stand in ascending rank (masses before lengths, say),
    /// then in the order of creation.
    int (*rank)(void *data, const struct ct_sym *s);
    void *data;
    /// Items (operators and operands) after which the rest is printed as `...`; 0: 20000.
    /// Parentheses nested more than 500 deep are cut in any case. A graph of n nodes can unfold to
    /// a tree of 2^n: name shared nodes first (share.h).
    size_t limit;
    /// Print simple fractions in place of decimals. In terms with a parameter: halves, quarters,
    /// eighths, m*l^2/4 in place of 0.25*m*l^2. A term without a parameter keeps its decimal,
    /// because its number comes from data: 1.5*x'', not 3*x''/2. Other numbers: those that are the
    /// double nearest to a small fraction (fraction.h): 13*m/35. The text reads back to the same
    /// value up to round-off, but not to the same nodes. Text and LaTeX.
    bool fractions;
    /// Fractions in terms without a parameter as well: no number comes from data.
    bool no_data;
    /// Width of a line of LaTeX [pt]; 0: CT_LATEX_LINE.
    size_t line;
};

/// e as text; p may be NULL. The text and all work space live in a.
const char *ct_ex_text(struct ct_arena *a, const struct ct_exs *x, ct_ex e,
                       const struct ct_print *p);
/// As ct_ex_text, but p->node is not asked for e itself: the right side of a definition of e.
const char *ct_ex_text_body(struct ct_arena *a, const struct ct_exs *x, ct_ex e,
                            const struct ct_print *p);

/// A term of a sum.
struct ct_print_term {
    ct_ex value;        ///< an operand of the sum
    bool is_subtracted; ///< the term is -value
    const char *text;   ///< with its sign: " + m*g", " - m*g", the first one "m*g" or "-m*g"
};
/// The terms of e in the order in which ct_ex_text prints them; their texts joined are its text. An
/// e that is no sum is one term. Returns their number. The list lives in a. Text and LaTeX.
size_t ct_ex_terms(struct ct_arena *a, const struct ct_exs *x, ct_ex e,
                   const struct ct_print *p, struct ct_print_term **term);

/// The shortest decimal that reads back to the same bits.
const char *ct_number_text(struct ct_arena *a, double v);
/// A C constant of type double with the same bits.
const char *ct_number_c(struct ct_arena *a, double v);

/// LaTeX of a name: crank.q -> q_{\mathrm{crank}}, theta1'' -> \ddot{\theta}_{1}, mass ->
/// \mathrm{mass}
const char *ct_latex_name(struct ct_arena *a, const char *name);
/// A name with a backslash before each character that has a meaning in LaTeX.
const char *ct_latex_quoted(struct ct_arena *a, const char *name);
/// Estimated width of a LaTeX formula (length characters of s) on the page [pt], in Computer Modern
/// of 10 pt, to a few per cent.
size_t ct_latex_width(const char *s, size_t length);
/// Layout: width of a line [pt], that of the class article at 10 pt; a wider fraction is printed as
/// a product.
enum { CT_LATEX_LINE = 345 };
/// A C identifier from a name: characters that C does not allow become _, a prime becomes d.
/// Different names can give the same identifier; the caller must tell them apart.
const char *ct_c_name(struct ct_arena *a, const char *name);

/// C text of one operator on operands that are identifiers or in parentheses. Not for leaves and
/// tables.
const char *ct_c_operation(struct ct_arena *a, enum ct_op op, const char *const arg[3]);

#endif
