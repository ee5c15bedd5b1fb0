// Newmark's method of average acceleration: the trapezoidal rule, without numerical damping. The
// method does not damp errors of multipliers, so each step starts with the acceleration from the
// equations of motion. Source: Newmark (1959), key newmark1959.
#include "integrate/implicit/alpha.h"

static const struct ct_alpha coefficients = {
    .beta = 1. / 4,
    .gamma = 1. / 2,
    .is_stabilised = true,
    .starts_anew = true,
};

const struct ct_method ct_method_newmark = {
    CT_ALPHA_METHOD,
    .name = "newmark",
    .summary = "Newmark's average acceleration (trapezoidal rule) on the stabilised index-2 "
               "form, without damping",
    .source = "newmark1959",
    .coefficients = &coefficients,
};
