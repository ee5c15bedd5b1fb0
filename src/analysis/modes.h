// Natural modes about a configuration, as used by their pictures and animations.
#ifndef CT_ANALYSIS_MODES_H
#define CT_ANALYSIS_MODES_H

#include "analysis/configuration.h"
#include "analysis/eigenvalues.h"

struct ct_modes {
    struct ct_ctx own;
    struct ct_system *system;
    struct ct_configuration at;
    struct ct_sim_options run;
    long count; // number of modes requested; 0: the default
    struct ct_motion_mode *mode;
    size_t n, all; // number of modes listed, number found
    const char *how;
    const char **coordinate; // names of the coordinates (nu)
};

/// Moves the evaluator of s->at.l from the state y0 by `amount` times a shape (nu) and closes
/// the loops again. s->at.l->y is then that position.
void ct_modes_displace(struct ct_modes *s, const double *y0, const double *shape,
                       double amount);

#endif
