// A page of headings, sentences, tables and equations, in three formats: text, LaTeX, HTML.
//
// The caller writes mathematics in the style of the format (expr/print.h; HTML takes LaTeX,
// which mathml.h translates) and marks it as such. The format adds layout, line breaks and
// escapes. What always holds: equations break between terms only; a line of text has at most
// CT_PAGE_WIDTH columns unless a single term is wider.
#ifndef CT_REPORT_PAGE_H
#define CT_REPORT_PAGE_H

#include "expr/print.h"

// Layout: of a page
enum { CT_PAGE_WIDTH = 100 };
/// Layout: lines of a screen. In longer output subexpressions get names, and summaries omit
/// equations.
enum { CT_MOST_LINES = 30 };
/// Width of a line of mathematics in HTML on a phone of 390 px [pt] in LaTeX of 10 pt, which is
/// 1 em: 24 em of 16 px less margins of 1 em.
/// Layout: of a page
enum { CT_PAGE_PHONE = 220 };

enum ct_page_kind {
    CT_PAGE_TITLE,    // of a stage
    CT_PAGE_HEADING,  // of a part of it
    CT_PAGE_SENTENCE, // text
    CT_PAGE_TABLE,
    CT_PAGE_EQUATIONS, // a group, aligned
    CT_PAGE_MATRIX,    // with names of its rows and columns
};

enum ct_look { CT_LOOK_TEXT, CT_LOOK_LATEX, CT_LOOK_HTML };

struct ct_page_equation {
    const char *label;        // text before it; NULL: none
    const char *left, *right; // mathematics; right NULL: left alone
    const char *note;         // text after it; NULL: none
    const char *about;        // the component whose terminal equation it is; NULL: none
    const char *name;         // of the speed or row that it belongs to; NULL: none
    // the components of each term, in their order on the page: names separated by blanks; NULL:
    // not known
    const char *const *left_components, *const *right_components;
};

struct ct_page_block {
    enum ct_page_kind kind;
    const char *text;  // TITLE, HEADING, SENTENCE
    bool is_folded;    // HEADING: HTML folds the block that follows
    const char *align; // TABLE: one letter a column: l or r plain, L or R mathematics
    // row by row. TABLE: the first row is the head, plain. MATRIX: mathematics; the first row has
    // the names of the columns, the first column those of the rows
    const char **cell;
    size_t ncell, cell_cap;
    size_t ncolumn; // MATRIX: number of columns, that of the row names included
    struct ct_page_equation *equation;
    size_t nequation, equation_cap;
};

struct ct_page {
    struct ct_arena *arena;
    enum ct_look look;
    const char *about; // component of the equations being added
    bool is_summary;   // long lists are shortened
    bool is_full;      // nothing is left out, however long
    struct ct_page_block *block;
    size_t nblock, block_cap;
};

void ct_page_title(struct ct_page *p, const char *text);
void ct_page_heading(struct ct_page *p, const char *text);
/// A heading of a block that may be skipped.
void ct_page_folded_heading(struct ct_page *p, const char *text);
void ct_page_sentence(struct ct_page *p, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));
/// Starts a table; cells follow row by row, the head first.
void ct_page_table(struct ct_page *p, const char *align);
void ct_page_cell(struct ct_page *p, const char *text);
void ct_page_row(struct ct_page *p, const char *const *cell, size_t n);
#define CT_PAGE_ROW(p, ...)                                                                    \
    ct_page_row((p), (const char *const[]){__VA_ARGS__},                                       \
                COUNT(((const char *const[]){__VA_ARGS__})))
/// Starts a matrix of ncolumn columns, that of the names of its rows included; cells follow as
/// of a table.
void ct_page_matrix(struct ct_page *p, size_t ncolumn);
/// Ends the matrix. If it is wider or longer than a page it is removed, and false is returned.
bool ct_page_matrix_end(struct ct_page *p);
/// Starts a group of equations.
void ct_page_equations(struct ct_page *p);
/// Which of n items of a list a page shows: in a summary of a long list the first and last few,
/// and an ellipsis for the others.
enum ct_shown { CT_SHOWN, CT_SHOWN_AS_MORE, CT_LEFT_OUT };
enum ct_shown ct_page_shown(const struct ct_page *p, size_t i, size_t n);
/// The same for all tables and groups of equations on the page, which state the number of
/// omitted ones, and for sides of equations longer than a screen.
void ct_page_shorten(struct ct_page *p);
/// Adds an equation and returns it, so that the caller can set the other fields.
struct ct_page_equation *ct_page_equation(struct ct_page *p, const char *label,
                                          const char *left, const char *right,
                                          const char *note);

/// Does a matrix fit lines of CT_PAGE_WIDTH columns, or a page of LaTeX?
bool ct_page_text_fits(const struct ct_page_block *b);
bool ct_page_latex_fits(const struct ct_page_block *b);

/// Columns of a UTF-8 string.
size_t ct_text_width(const char *s);

void ct_page_print_text(FILE *out, const struct ct_page *p);
/// A fragment for a document that uses amsmath and longtable; lines are as wide as those of
/// article at 10 pt.
void ct_page_print_latex(FILE *out, const struct ct_page *p);
/// A whole document without scripts; mathematics is MathML.
void ct_page_print_html(FILE *out, const struct ct_page *p, const char *title);
/// The blocks of the page without the enclosing document; they need ct_page_style and
/// ct_mathml_style. Titles are headings of level `level`, 1 to 5, headings one below. Writes
/// into p->arena.
void ct_page_print_html_blocks(FILE *out, const struct ct_page *p, int level);
extern const char ct_page_style[];

/// Length of the first top-level term of a sum in any style: up to the next sign " + " or " - "
/// outside all brackets; strlen(s) if there is no other.
size_t ct_page_first_term(const char *s);

#endif
