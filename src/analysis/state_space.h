// The linearised equations in state-space form x' = A x + B f with positions and speeds as
// states (section 9.4).
#ifndef CT_ANALYSIS_STATE_SPACE_H
#define CT_ANALYSIS_STATE_SPACE_H

#include "analysis/linearization.h"

/// x consists of the coordinates y of ct_linear that move mass, then of the massless
/// coordinates with dampers, then of the speeds of the first. g (nfree) are forces along the
/// independent speeds, Z' B f. Matrices are column-major without gaps.
struct ct_state_space {
    int n, nplace, nspeed; // n = nplace + nspeed
    const int *place; // by position state: index of the independent speed; -1 for a combination
    const int *speed;
    double *A;           // n x n
    double *B;           // n x nfree:  x' = A x + B g
    double *y_x, *y_g;   // nfree x n, nfree x nfree:  y = y_x x + y_g g
    double *w_x, *w_g;   // w = w_x x + w_g g: speeds
    double *dw_x, *dw_g; // w' = dw_x x + dw_g g: accelerations
};

/// Massless coordinates without dampers follow the others. The contribution of rates of g to
/// their speeds is left out. Errors: CT_E_MASSLESS if neither stiffness nor damping determines
/// a massless coordinate.
bool ct_state_space_create(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_linear *l,
                           struct ct_state_space *out);

#endif
