// The generalised-alpha method with both constraint levels imposed: the default implicit method.
// (8.4)
//
// Damping at infinity rho = 4/5; Chung and Hulbert (1993), key chung1993, give the others for it.
// Order 2 in q, u and lam. Source: Arnold, Cardona and Bruls as in Bruls, Cardona and Arnold
// (2012), key bruls2012.
#include "integrate/implicit/alpha.h"

static const struct ct_alpha coefficients = {
    .alpha_m = 1. / 3, // (2 rho - 1) / (rho + 1)
    .alpha_f = 4. / 9, // rho / (rho + 1)
    .beta = 25. / 81,  // (gamma + 1/2)^2 / 4
    .gamma = 11. / 18, // 1/2 + alpha_f - alpha_m
    .is_stabilised = true,
};

const struct ct_method ct_method_generalized_alpha = {
    CT_ALPHA_METHOD,
    .name = "generalized-alpha",
    .summary = "generalised-alpha with rho = 0.8 on the stabilised index-2 form, for stiff "
               "systems and long runs",
    .source = "bruls2012",
    .coefficients = &coefficients,
};
