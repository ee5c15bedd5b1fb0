// Names and texts shared by the stages of the derivation, in the format of the page.
#ifndef CT_REPORT_DERIVATION_H
#define CT_REPORT_DERIVATION_H

#include "graph/graph.h"
#include "report/page.h"
#include "report/reduced.h"

/// Systems of more speeds than this are printed in recursive form, with lists shortened to
/// their first and last entries unless all is requested. A larger mass matrix has more columns
/// than a line has characters.
enum { CT_MOST_MATRIX_SPEEDS = CT_PAGE_WIDTH };

struct ct_derivation {
    struct ct_arena *a;
    struct ct_arena *work; // workspace of one text, then cleared
    struct ct_equations *e;
    const struct ct_model *m;
    bool is_recursive; // which form the equations get (reduced.h)
    struct ct_page page;
    struct ct_print print; // style of expressions, in the format of the page
    const int *rank;       // of the first nrank symbols: their order in products
    size_t nrank;
};

void ct_derivation_init(struct ct_derivation *d, struct ct_arena *a, struct ct_equations *e,
                        const struct ct_model *m, enum ct_look look);

/// A text that grows at its end at a cost proportional to the added text. Initialise with
/// zeros.
struct ct_growing_text {
    char *at; // ends with a zero, which n does not count; NULL while nothing was added
    size_t n, cap;
};
void ct_derivation_append(struct ct_derivation *d, struct ct_growing_text *t, const char *more);

/// An expression in a style of print.
const char *ct_derivation_text_as(struct ct_derivation *d, ct_ex v, const struct ct_print *p);
/// An expression as mathematics of the page.
const char *ct_derivation_text(struct ct_derivation *d, ct_ex v);
/// The same where no number comes from the model's data: q/2, not 0.5*q.
const char *ct_derivation_exact(struct ct_derivation *d, ct_ex v);
/// As ct_derivation_text, for the collected expression.
const char *ct_derivation_collected(struct ct_derivation *d, ct_ex v);
/// A name of the model as mathematics: "crank.q", or LaTeX of it.
const char *ct_derivation_name(struct ct_derivation *d, const char *name);
/// A vector or rotation of a component or frame: F(rod), or a bold letter with a subscript.
const char *ct_derivation_of(struct ct_derivation *d, const char *letter, const char *name);
/// The generalised force along a coordinate.
const char *ct_derivation_effort(struct ct_derivation *d, const char *coordinate);
/// Three components: [a, b, c], or 0.
const char *ct_derivation_vector(struct ct_derivation *d, ct_ex3 v);
/// A direction: x, -y, or [a, b, c].
const char *ct_derivation_axis(struct ct_derivation *d, ct_ex3 n);

/// Approximate number of lines of v.
size_t ct_derivation_lines(struct ct_derivation *d, ct_ex v);
/// Prints definitions under a heading; nothing if there are none.
void ct_derivation_put_definitions(struct ct_derivation *d, const char *heading,
                                   const struct ct_definitions *list);

/// Inertia minus weight, m*(a(C) - g), and I*al + w x I*w, of a body that is not a beam; NULL
/// if zero. The through variables of the body are their negatives.
const char *ct_derivation_inertia_force(struct ct_derivation *d, const struct ct_body *body);
const char *ct_derivation_inertia_torque(struct ct_derivation *d, const struct ct_body *body);

/// Is mathematics of the page in LaTeX? HTML uses it too.
static inline bool ct_derivation_is_latex(const struct ct_derivation *d)
{
    return d->page.look != CT_LOOK_TEXT;
}

/// Prepares the reduced equations for reading: collected, or with definitions if they are long.
void ct_derivation_reduce(struct ct_derivation *d, struct ct_reduced *r);

/// The same with the elastic coordinates of each beam as one vector; r: constraints and
/// efforts. False: equations are short without this, or no beam has named parts.
struct ct_beam_blocks;
bool ct_derivation_blocks(struct ct_derivation *d, struct ct_reduced *r,
                          struct ct_beam_blocks *s);

/// Prints the mass matrix and the Jacobian of the constraints; if they are larger than a page,
/// only their sizes.
void ct_derivation_put_matrices(struct ct_derivation *d, const struct ct_reduced *r);

/// Circuit equations after substitution of the terminal equations: positions of the bodies that
/// are chords, and constraint rows. Long ones are given by their definitions.
struct ct_substituted {
    int *edge;  // of the bodies: chords of translation
    ct_ex3 *at; // centres of mass in ground axes [m]
    size_t n;
    ct_ex *phi; // nrow
    struct ct_definitions definitions;
};
void ct_derivation_substitute(struct ct_derivation *d, struct ct_substituted *s);

/// The cutset equation F(own) + F(...) - ... of branch `own`; row i of a cutset matrix, given
/// by rows (its transpose in compressed columns).
const char *ct_derivation_cutset(struct ct_derivation *d, const struct ct_incidence *rows,
                                 int i, int own, const char *letter);
/// d or S of a chord as a sum over the branches from its tail to its head.
const char *ct_derivation_circuit(struct ct_derivation *d, const struct ct_tree *t, int chord,
                                  bool of_rotation);

void ct_stage_terminal(struct ct_derivation *d);
void ct_stage_graph(struct ct_derivation *d);
void ct_stage_tree(struct ct_derivation *d);
void ct_stage_cutset(struct ct_derivation *d);
void ct_stage_circuit(struct ct_derivation *d);
void ct_stage_reduced(struct ct_derivation *d);

/// Prints the formats for programs.
void ct_derivation_print_json(FILE *out, struct ct_derivation *d, unsigned stages);
void ct_derivation_print_c(FILE *out, struct ct_derivation *d);

#endif
