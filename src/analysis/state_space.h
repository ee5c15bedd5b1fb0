// Linearised equations as x' = A x + B f, positions and speeds as states.  (section 9.4)
#ifndef CT_ANALYSIS_STATE_SPACE_H
#define CT_ANALYSIS_STATE_SPACE_H

#include "analysis/linearization.h"

/// x = (places, speeds): coordinates y of ct_linear that move mass, then those without mass
/// that dampers hold, then the speeds of the first. g (nfree) are forces along the independent
/// speeds, Z' B f. Column-major, no gaps.
struct ct_state_space {
    int n, nplace, nspeed; // n = nplace + nspeed
    const int *place;      // of the states: index of the independent speed; -1 for a mixture
    const int *speed;
    double *A;           // n x n
    double *B;           // n x nfree:  x' = A x + B g
    double *y_x, *y_g;   // nfree x n, nfree x nfree:  y = y_x x + y_g g
    double *w_x, *w_g;   // the speeds w
    double *dw_x, *dw_g; // w'
};

/// Massless coordinates without dampers follow the others; what rates of g add to their speeds
/// is left out. Errors: CT_E_MASSLESS if nothing holds a massless coordinate.
bool ct_state_space_create(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_linear *l,
                           struct ct_state_space *out);

#endif
