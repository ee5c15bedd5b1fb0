// The generalised-alpha method with the constraints on positions alone (index 3).  (8.1)
//
// Damping at infinity rho = 4/5. Order 2 in q, u and lam; v = J u + Phi_t is not zero but of order
// h^2. It is not projected, as this would reduce the order of lam by one. Source: Arnold and Bruls
// (2007), key arnold2007.
#include "integrate/implicit/alpha.h"

static const struct ct_alpha coefficients = {
    .alpha_m = 1. / 3, // (2 rho - 1) / (rho + 1)
    .alpha_f = 4. / 9, // rho / (rho + 1)
    .beta = 25. / 81,  // (gamma + 1/2)^2 / 4
    .gamma = 11. / 18, // 1/2 + alpha_f - alpha_m
};

const struct ct_method ct_method_generalized_alpha_index3 = {
    CT_ALPHA_METHOD,
    .violates_velocity_constraints = true,
    .name = "generalized-alpha-index3",
    .summary = "generalised-alpha with rho = 0.8 on the index-3 form: speeds meet the "
               "constraints to order 2",
    .source = "arnold2007",
    .coefficients = &coefficients,
};
