// The equations of motion of a model as C source that stands alone.
//
//     NAME.h  NAME.c     motion and constraint programs, their layout, accelerations; C99 and libm
//     NAME_test.c        compares with recorded values or integrates from the start; shows the calls
//
// What always holds: the same equations give the same text; no globals but constant tables;
// compiles without warnings; functions are short enough for compilers (c.h).
#ifndef CT_CODEGEN_EXPORT_H
#define CT_CODEGEN_EXPORT_H

#include "expr/listing.h"
#include "formulate/equations.h"

/// Values to compare with: inputs, outputs of both programs, accelerations (nu).
struct ct_export_state {
    const double *input, *motion, *constraint, *a;
};

struct ct_export {
    const char *name;  // C identifier, prefix of all that is public
    const char *title; // of the model
    const struct ct_equations *e;
    // outputs: M, Q, J, gam, q' and phi, v, J; inputs in one layout
    const struct ct_listing *motion, *constraint;
    // u', q', nfree pivots that must be positive and npivot pivots with |pivot| scale > weakest.
    // Where this fails, accelerations are found from the motion program. NULL: everywhere
    const struct ct_listing *solved;
    size_t nfree, npivot;
    const double *scale;
    double weakest;
    size_t rank; // of the constraints
    size_t at_q, at_u, at_switch, at_memory, ninput;
    const struct ct_export_state *state; // the first one is the start
    size_t nstate;
    unsigned lanes; // > 1: both programs for so many inputs side by side, too
};

/// The texts of the files; they live in a.
const char *ct_export_header(struct ct_arena *a, const struct ct_export *x);
const char *ct_export_source(struct ct_arena *a, const struct ct_export *x);
const char *ct_export_test(struct ct_arena *a, const struct ct_export *x);

#endif
