// Origin of the terms of the equations: the components of the model that contribute to each of
// them.
//
//     (r^2*(m1/4 + m2 + m3) + J1)*main.q''     crank, crank.pin, rod, slider, main; r, m1, J1, m2, m3
//
// A term lists a component if its value depends on the data of that component (masses,
// positions, stiffnesses, pitches, efforts ...) or contains one of its coordinates or
// multipliers. Directions of axes count with their coordinates.
//
// Method: the equations are derived again, on the same trees, from a model in which every
// number of a component is multiplied by the mark of that component, a symbol of value 1. Marks
// are propagated like parameters. A simplified term and the marked equation are both expanded.
// A monomial of the term has the marks of the same monomial in the marked equation; the marks
// of merged terms are united. This is done only on request.
//
// What always holds: the terms of a side sum to that side of the equation; a component on which
// a term depends is in its list. If a sum is too long to be expanded the list may contain more.
#ifndef CT_REPORT_PROVENANCE_H
#define CT_REPORT_PROVENANCE_H

#include "report/derivation.h"
#include "report/marked_model.h"

enum ct_equation_kind {
    CT_EQUATION_MOTION,       // M u' = Q + J' lam, one a speed
    CT_EQUATION_POSITION,     // Phi = 0, one a row
    CT_EQUATION_ACCELERATION, // J u' = -gam, one a row
    CT_EQUATION_EFFORT,       // of drivers: left side = 0
    CT_EQUATION_OUTPUT, // an output that is a reaction or an acceleration, in terms of u' and lam
};

/// A top-level term of one side of an equation, with its sign.
struct ct_equation_term {
    enum ct_equation_kind kind;
    size_t equation; // index of the speed, row, driver or output
    bool is_right;
    ct_ex e;                // as printed; may use definitions
    const char *text;       // the same, as printed after the previous term
    ct_ex full;             // the same without definitions
    const uint32_t *origin; // into the list of origins, ascending  (norigin)
    size_t norigin;
};

struct ct_provenance {
    struct ct_origin *origin; // in the order of the file
    size_t norigin;
    struct ct_equation_term *term; // ordered by kind, equation, side, then as printed
    size_t nterm;
};

/**
 * The terms of the reduced equations and where they come from.
 *
 * r       in    the equations as they are printed (ct_derivation_reduce of d)
 * p       out   lives in d->a
 *
 * Cost    a second derivation of the equations, and their expansion
 */
void ct_provenance_derive(struct ct_derivation *d, const struct ct_reduced *r,
                          struct ct_provenance *p);

/// Name of the equation of a term: of its speed, row or driver, as in JSON.
const char *ct_provenance_equation(const struct ct_equations *e,
                                   const struct ct_equation_term *t);

/// The full expressions of all terms (nterm), for ct_ex_values, ct_tape_compile or
/// ct_evaluator_add_program with the store e->x. In a.
ct_ex *ct_provenance_values(struct ct_arena *a, const struct ct_provenance *p);

#endif
