// Where the terms of the equations come from: the components of the model behind each of them.
//
//     (r^2*(m1/4 + m2 + m3) + J1)*main.q''     crank, crank.pin, rod, slider, main; r, m1, J1, m2, m3
//
// A term names a component if its value depends on the data of that component (masses, places,
// stiffnesses, pitches, efforts ...) or shows one of its coordinates or multipliers. Directions
// of axes count with the coordinates that they belong to.
//
// Method: the equations are derived once more, on the same trees, from a model in which every
// number of a component is multiplied by a symbol of that component, its mark, whose value is
// 1. Marks are carried through the derivation like any parameter. A term that was simplified
// and collected is expanded, as is the marked equation, and each monomial of the term has the
// marks that this monomial has in the marked equation; where terms merge these are united.
// Nothing of this is done unless it is asked for.
//
// What always holds: the terms of a side sum to that side of the equation; a component that a
// term depends on is in its list. Where a sum is too long to be expanded the list may be longer
// than needed.
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
    size_t equation; // speed, row, driver or output, as the kind says
    bool is_right;
    ct_ex e;                // as it is printed: may use definitions
    const char *text;       // the same, as it stands behind the terms before it
    ct_ex full;             // the same without definitions
    const uint32_t *origin; // into the list of origins, ascending  (norigin)
    size_t norigin;
};

struct ct_provenance {
    struct ct_origin *origin; // in the order of the file
    size_t norigin;
    struct ct_equation_term
        *term; // by kind, equation, side; within a side in the order of print
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

/// Values of all terms: the full expressions (nterm), for ct_ex_values, ct_tape_compile or
/// ct_evaluator_add_program with the store e->x. In a.
ct_ex *ct_provenance_values(struct ct_arena *a, const struct ct_provenance *p);

#endif
