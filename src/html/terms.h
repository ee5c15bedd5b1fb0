// The terms of the equations of motion with their values along the run.
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
        *expression; // in the order of the page: terms, an output before its own  (nexpression)
    size_t nexpression;
    size_t *column; // of each term in these; that of an output stands before its first term
    size_t nvalue;  // expressions with values: all of them, or none where there are too many
    struct ct_program program;
    size_t stride, nrow, cap; // of the rows of the page
    double *value;            // nrow x nvalue, a row after the other
};

/// The terms of a system's equations, mathematics as for HTML. sys: a copy of its own, with its mass matrix and
/// forces. Raises the guard.
void ct_terms_create(struct ct_terms_recording *t, struct ct_arena *a, struct ct_system *sys);
/// On the evaluator of a run of another copy of that system, which gives nrow rows. a: the arena of the run. Raises
/// the guard.
void ct_terms_compile(struct ct_arena *a, struct ct_terms_recording *t, struct ct_run *run,
                      size_t nrow);
/// Row number i, where the run has just given the results. Raises the guard.
void ct_terms_keep(struct ct_arena *a, struct ct_terms_recording *t, struct ct_run *run,
                   size_t i, bool is_last);

#endif
