// Programs that solve a closed system in closed form, for one choice of rows and columns.
//
//     solved    u', q'                                  one at every evaluation
//     checked   u', lam after a refinement, residuals   one a step
//     closing   Phi, v and the corrections for them     in projections
//
// The order of pivots is fixed, so it is watched: the strength of a form is that of its weakest pivot
// against the entries around it, and what is left of the equations is measured.
#ifndef CT_SOLVE_CLOSED_H
#define CT_SOLVE_CLOSED_H

#include "formulate/elimination.h"
#include "solve/machine.h"

struct ct_form {
    struct ct_arena *arena; // its own
    const struct ct_closed *c;
    int *row, *dependent; // kept rows, dependent columns, ascending: what it is for
    struct ct_program solved, checked, closing;
    double M_size, J_size; // largest entries where it was made
    // results of checked
    const double *a, *lam; // u' (nu), multipliers of c->row (rank)
    double left,
        left_better; // residual against the terms of the equations, before and after refinement
    double kappa;    // largest entry of B
    // results of closing
    const double *phi, *v, *dq, *du; // (nrow), (nrow), (nu), (nu)
};

/// Form of a partition with the shadow at the machine's input, after ct_machine_motion. NULL if it would
/// cost more than the solve by matrices: operations [multiplications or additions]. Owned by a until destroyed.
struct ct_form *ct_form_create(struct ct_arena *a, struct ct_machine *m,
                               const struct ct_partition *p, double operations);
void ct_form_destroy(struct ct_machine *m, struct ct_form *f);
bool ct_form_is_for(const struct ct_form *f, const struct ct_partition *p);

/// u' (nu, out) and q' at the machine's input. Returns the strength, 0 if there is no finite result.
double ct_form_solve(struct ct_form *f, struct ct_machine *m, double *a);
/// Fill the results of checked at the machine's input.
void ct_form_check(struct ct_form *f, struct ct_machine *m);
/// Fill the results of closing at the machine's input. Returns the strength.
double ct_form_close(struct ct_form *f, struct ct_machine *m);

#endif
