// The residual of implicit methods at up to four points side by side: stages of a step are few points at once.
//
//     input[4 * slot + point], out[4 * k + point]
//
// What always holds: results have the bits of the machine's own residual.
#ifndef CT_SOLVE_ABREAST_H
#define CT_SOLVE_ABREAST_H

#include "solve/machine.h"

enum { CT_ABREAST = 4 };

struct ct_abreast {
    const struct ct_listing *listing;
    size_t ninput;
    struct ct_native *native; // NULL: the tape is run
    struct ct_tape *tape;     // NULL until it is needed
    double *input, *out, *work;
    size_t nwork;
};

/// Of the listing of a residual with so many inputs.
struct ct_abreast *ct_abreast_create(struct ct_arena *a, const struct ct_listing *l,
                                     size_t ninput);
/// Native code, or the tape; then as below.
void ct_abreast_use(struct ct_arena *a, struct ct_abreast *s, bool native, const double *input);
/// Parameters have changed.
void ct_abreast_prepare(struct ct_abreast *s, const double *input);
/// Inputs from `first` on, the same at all points.
void ct_abreast_spread(struct ct_abreast *s, const double *input, size_t first);
void ct_abreast_run(struct ct_abreast *s);

#endif
