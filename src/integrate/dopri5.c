// Dormand-Prince 5(4): six stages a step, the seventh is the first of the next.
//
// The interpolant is the cubic Hermite polynomial of the step with a quartic correction,
//
//     y(t + theta h) = Hermite(theta) + theta^2 (1 - theta)^2 h sum d_i k_i
//
// accurate to h^5 like a single step. Sources: Dormand and Prince (1980), key dormand1980, table 2;
// interpolant by Shampine (1986), as in Hairer, Norsett and Wanner (1993), II.6, key hairer1993.
#include "integrate/stepper.h"

#include <string.h>

enum { STAGES = 7 };

static const double C[STAGES] = {0, 1. / 5, 3. / 10, 4. / 5, 8. / 9, 1, 1};

static const double A[STAGES][STAGES] = {
    [1] = {1. / 5},
    [2] = {3. / 40, 9. / 40},
    [3] = {44. / 45, -56. / 15, 32. / 9},
    [4] = {19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729},
    [5] = {9017. / 3168, -355. / 33, 46732. / 5247, 49. / 176, -5103. / 18656},
    [6] = {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84}, // = y1
};

// fifth order minus fourth order
static const double E[STAGES]
    = {71. / 57600, 0, -71. / 16695, 71. / 1920, -17253. / 339200, 22. / 525, -1. / 40};

static const double D[STAGES] = {
    -12715105075. / 11282082432, 0,
    87487479700. / 32700410799,  -10690763975. / 1880347072,
    701980252875. / 199316789632, -1453857185. / 822651844,
    69997945. / 29380423,
};

// work: k (ny x 7), one vector (ny) for stage points, error and correction
static size_t work_size(int ny)
{
    return (STAGES + 1) * (size_t)ny;
}

static enum ct_eval step(const struct ct_problem *p, double t, double h, const double *y,
                         const double *dy, const struct ct_tolerance *tolerance, double *y1,
                         double *dy1, double *err, double *work,
                         struct ct_integrate_stats *stats)
{
    const int n = p->ny;
    const size_t bytes = (size_t)n * sizeof *y;
    double *k = work, *point = work + STAGES * n;
    memcpy(k, dy, bytes);
    for (int s = 1; s < STAGES; s++) {
        ct_stepper_combine(point, y, h, A[s], k, s, n);
        const enum ct_eval e = ct_stepper_rhs(p, t + C[s] * h, point, k + s * n, stats);
        if (e != CT_EVAL_OK)
            return e;
    }
    memcpy(y1, point, bytes); // the last stage point
    memcpy(dy1, k + (STAGES - 1) * n, bytes);
    if (tolerance) {
        ct_stepper_combine(point, NULL, h, E, k, STAGES, n);
        *err = ct_stepper_norm(p, tolerance, y, y1, point);
    }
    return CT_EVAL_OK;
}

static void dense(const struct ct_problem *p, double h, double theta, const double *y,
                  const double *y1, double *work, double *out)
{
    const int n = p->ny;
    const double *k = work, bubble = theta * theta * (1 - theta) * (1 - theta);
    double *correction = work + STAGES * n;
    ct_stepper_combine(correction, NULL, h * bubble, D, k, STAGES, n);
    ct_stepper_hermite(out, theta, h, y, k, y1, k + (STAGES - 1) * n, n);
    for (int i = 0; i < n; i++)
        out[i] += correction[i];
}

const struct ct_method ct_method_dopri5 = {
    .name = "dopri5",
    .summary = "Dormand-Prince 5(4), explicit, for smooth motions without stiff parts",
    .source = "dormand1980",
    .order = 5,
    .error_order = 4,
    .work = work_size,
    .step = step,
    .dense = dense,
};
