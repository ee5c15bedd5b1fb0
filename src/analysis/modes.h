// Natural motions about a configuration, for the pictures of them.
#ifndef CT_ANALYSIS_MODES_H
#define CT_ANALYSIS_MODES_H

#include "analysis/configuration.h"
#include "analysis/eigenvalues.h"

struct ct_modes {
    struct ct_ctx own;
    struct ct_system *system;
    struct ct_configuration at;
    struct ct_sim_options run;
    long count; // asked for; 0: the usual number
    struct ct_motion_mode *mode;
    size_t n, all; // shown, found
    const char *how;
    const char **coordinate; // nu names
};

/// The evaluator of s->at.l stands where the coordinates have moved by `amount` of a shape (nu) from the state y0, the
/// loops closed again. s->at.l->y is that place then.
void ct_modes_displace(struct ct_modes *s, const double *y0, const double *shape,
                       double amount);

#endif
