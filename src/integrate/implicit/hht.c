// The method of Hilber, Hughes and Taylor as the member alpha_m = 0 of the generalised-alpha
// family.
//
// alpha_f = 1/9 damps at infinity as much as rho = 4/5. The weights stand on accelerations, not on
// forces as in the original, so that the order is 2 with a mass matrix that changes, too. Source:
// Hilber, Hughes and Taylor (1977), key hilber1977; Chung and Hulbert (1993), key chung1993.
#include "integrate/implicit/alpha.h"

static const struct ct_alpha coefficients = {
    .alpha_m = 0,
    .alpha_f = 1. / 9, // - alpha of the source
    .beta = 25. / 81,  // (1 + alpha_f)^2 / 4
    .gamma = 11. / 18, // 1/2 + alpha_f
    .is_stabilised = true,
};

const struct ct_method ct_method_hht = {
    CT_ALPHA_METHOD,
    .name = "hht",
    .summary = "Hilber-Hughes-Taylor with alpha = -1/9 on the stabilised index-2 form",
    .source = "hilber1977",
    .coefficients = &coefficients,
};
