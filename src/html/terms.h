// The terms of the equations of motion with their values over the run.
#ifndef CT_HTML_TERMS_H
#define CT_HTML_TERMS_H

#include "report/provenance.h"
#include "sim/sim.h"

struct ct_terms_recording {
    struct ct_derivation derivation;
    struct ct_reduced reduced;
    struct ct_provenance provenance;
    bool uses_multipliers;
    ct_ex
        // in the order of the page: terms; the expression of an output precedes its terms
        // (nexpression)
        *expression;
    size_t nexpression;
    size_t *column; // index of each term in `expression`
    size_t nvalue;  // number of expressions with values: all, or 0 if there are too many
    struct ct_program program;
    size_t stride, nrow, cap; // of the recorded rows
    double *value;            // nrow x nvalue, row by row
};

/// Lists the terms of a system's equations, as mathematics for HTML. sys: a private copy with
/// mass matrix and forces. Raises the guard.
void ct_terms_create(struct ct_terms_recording *t, struct ct_arena *a, struct ct_system *sys);
/// Compiles them for the evaluator of a run of another copy of that system, which gives nrow
/// rows. a: arena of the run. Raises the guard.
void ct_terms_compile(struct ct_arena *a, struct ct_terms_recording *t, struct ct_run *run,
                      size_t nrow);
/// Stores row i after the run has given its results. Raises the guard.
void ct_terms_keep(struct ct_arena *a, struct ct_terms_recording *t, struct ct_run *run,
                   size_t i, bool is_last);

#endif
