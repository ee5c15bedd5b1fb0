// A run recorded for the page: its samples and the first position of the mechanism.
//
// What always holds: rows are every `stride`-th sample and the last one. A system without an
// end time has one row, its start.
#ifndef CT_HTML_RECORDING_H
#define CT_HTML_RECORDING_H

#include "analysis/loops.h"
#include "draw/animation.h"
#include "html/terms.h"
#include "sim/sim.h"

struct ct_recording {
    struct ct_sim *sim;
    struct ct_animation animation; // has the same rows
    double *first;                 // values of its scene at the start
    struct ct_terms_recording *terms;
    size_t stride, nsample; // samples of the run
    size_t nrow, ncolumn;   // ncolumn: outputs
    size_t time_cap, value_cap;
    double *time;  // (nrow) [s]
    double *value; // nrow x ncolumn, a row after the other
    size_t seen;   // number of samples so far
    struct ct_loops loops;
    size_t nnear, near_cap, near_time_cap;
    double *near;      // distance from a singular configuration: nnear x (1 + loops.nloop)
    double *near_time; // (nnear) [s]
};

/// Prepares a recording before the run of `sys` is created. sys is a private copy, see
/// ct_system_borrow. terms: filled by ct_terms_create. Raises the guard.
void ct_recording_create(struct ct_recording *r, struct ct_system *sys,
                         struct ct_terms_recording *terms);
/// Runs and records. False with a diagnostic.
bool ct_recording_run(struct ct_ctx *ctx, struct ct_recording *r, struct ct_sim *sim,
                      FILE *progress);

#endif
