// Dormand-Prince 5(4): six stages a step, the seventh is the first of the next.
//
// Dense output: two interpolants correct the cubic Hermite polynomial of the step, with t = theta:
//
//     quartic   t^2 (1 - t)^2 h sum d_i k_i        error of order h^5, costs nothing; for roots
//     quintic   t^2 (1 - t)^2 h (a + b t)          error of order h^6 like the step; for samples
//
// a and b make the slope at t = 1/5 and 1/2 that of f at the points of the quartic: their error
// h^5 counts as h^6 in the integral (bootstrapping). Where errors do not accumulate the quartic is
// off by some 20 tolerances though the steps keep to one; hence the two evaluations more.
//
// Sources: Dormand and Prince (1980), key dormand1980, table 2; quartic by Shampine (1986) as in
// Hairer, Norsett and Wanner (1993), II.6, key hairer1993; bootstrapping by Enright, Jackson,
// Norsett and Thomsen (1986), key enright1986.
#include "integrate/stepper.h"

enum { STAGES = 7 }; // Definition: of the method.

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
    -12715105075. / 11282082432,  0,
    87487479700. / 32700410799,   -10690763975. / 1880347072,
    701980252875. / 199316789632, -1453857185. / 822651844,
    69997945. / 29380423,
};

struct work {
    struct ct_compensation carry;
    double *k;                     // (ny x 7)
    double *point, *slope, *a, *b; // (ny) each
    bool is_prepared;
};

static void *create(struct ct_arena *arena, const struct ct_method *method,
                    const struct ct_problem *p)
{
    (void)method;
    const size_t n = (size_t)p->ny;
    struct work *w = CT_NEW(arena, struct work);
    *w = (struct work){.carry = ct_compensation_create(arena, p->ny),
                       .k = CT_NEWN(arena, double, STAGES *n),
                       .point = CT_NEWN(arena, double, n),
                       .slope = CT_NEWN(arena, double, n),
                       .a = CT_NEWN(arena, double, n),
                       .b = CT_NEWN(arena, double, n)};
    return w;
}

static enum ct_eval step(const struct ct_problem *p, double t, double h, const double *y,
                         const double *dy, const struct ct_tolerance *tolerance, double *y1,
                         double *dy1, double *err, void *work, struct ct_integrate_stats *stats)
{
    const int n = p->ny;
    struct work *w = work;
    double *k = w->k, *point = w->point;
    w->is_prepared = false;
    ct_stepper_copy(k, dy, n);
    for (int s = 1; s < STAGES; s++) {
        if (s == STAGES - 1)
            ct_stepper_advance(point, y, h, A[s], k, s, &w->carry);
        else
            ct_stepper_combine(point, y, h, A[s], k, s, n);
        const enum ct_eval e = ct_stepper_rhs(p, t + C[s] * h, point, k + s * n, stats);
        if (e != CT_EVAL_OK)
            return e;
    }
    ct_stepper_copy(y1, point, n); // the last stage point
    ct_stepper_copy(dy1, k + (STAGES - 1) * n, n);
    if (tolerance) {
        ct_stepper_combine(point, NULL, h, E, k, STAGES, n);
        ct_stepper_subtract_roundoff(p, h, point);
        *err = ct_stepper_error(p, tolerance, t + h, y, y1, point);
    }
    return CT_EVAL_OK;
}

static void quartic(double *out, double h, double theta, const double *y, const double *y1,
                    const struct work *w, int n)
{
    const double bubble = theta * theta * (1 - theta) * (1 - theta);
    ct_stepper_combine(w->slope, NULL, h * bubble, D, w->k, STAGES, n);
    ct_stepper_hermite(out, theta, h, y, w->k, y1, w->k + (STAGES - 1) * n, n);
    for (int i = 0; i < n; i++)
        out[i] += w->slope[i];
}

// out (n) = f at the point of the quartic at theta, minus the slope of the Hermite polynomial.
static enum ct_eval slope_defect(double *out, double theta, const struct ct_problem *p,
                                 double t, double h, const double *y, const double *y1,
                                 const struct work *w, struct ct_integrate_stats *stats)
{
    const int n = p->ny;
    quartic(w->point, h, theta, y, y1, w, n);
    const enum ct_eval e = ct_stepper_rhs(p, t + theta * h, w->point, out, stats);
    const double *dy = w->k, *dy1 = w->k + (STAGES - 1) * n, rest = 1 - theta;
    for (int i = 0; i < n && e == CT_EVAL_OK; i++)
        out[i] -= 6 * theta * rest * (y1[i] - y[i]) / h + rest * (1 - 3 * theta) * dy[i]
                + theta * (3 * theta - 2) * dy1[i];
    return e;
}

static enum ct_eval prepare(const struct ct_problem *p, double t, double h, const double *y,
                            const double *y1, void *work, struct ct_integrate_stats *stats)
{
    struct work *w = work;
    enum ct_eval e = slope_defect(w->b, 1. / 2, p, t, h, y, y1, w, stats);
    if (e == CT_EVAL_OK)
        e = slope_defect(w->a, 1. / 5, p, t, h, y, y1, w, stats);
    if (e != CT_EVAL_OK)
        return e;
    // slope of t^2 (1 - t)^2 (a + b t):  b / 16 at 1/2,  (24 a + 8 b) / 125 at 1/5
    for (int i = 0; i < p->ny; i++) {
        w->b[i] *= 16;
        w->a[i] = (125 * w->a[i] - 8 * w->b[i]) / 24;
    }
    w->is_prepared = true;
    return CT_EVAL_OK;
}

static void dense(const struct ct_problem *p, double h, double theta, const double *y,
                  const double *y1, void *work, double *out)
{
    const int n = p->ny;
    const struct work *w = work;
    const double bubble = theta * theta * (1 - theta) * (1 - theta);
    if (!w->is_prepared) {
        quartic(out, h, theta, y, y1, w, n);
        return;
    }
    ct_stepper_hermite(out, theta, h, y, w->k, y1, w->k + (STAGES - 1) * n, n);
    for (int i = 0; i < n; i++)
        out[i] += h * bubble * (w->a[i] + theta * w->b[i]);
}

static const struct ct_tableau tableau
    = {.stages = STAGES, .stride = STAGES, .C = C, .A = &A[0][0], .E = E, .nerror = STAGES};

// The quintic as a table: stages 7 and 8 are f at the points of the quartic at 1/2 and 1/5. With b
// the last row of A,
//
//     point   t^2 (3 - 2 t) b + t (1 - t)^2 e_0 - t^2 (1 - t) e_6 + t^2 (1 - t)^2 D
//     miss    k_point - 6 t (1 - t) b - (1 - t) (1 - 3 t) e_0 - t (3 t - 2) e_6
//     F_1     16 miss(1/2),  F_0 = (125 miss(1/5) - 8 F_1) / 24
#define POINT(t, b, d) (t) * (t) * (3 - 2 * (t)) * (b) + (t) * (t) * (1 - (t)) * (1 - (t)) * (d)
#define MISS(t, b) (-6 * (t) * (1 - (t)) * (b))
#define F1(b) (16 * MISS(0.5, b))
#define F0(b) ((125 * MISS(0.2, b) - 8 * F1(b)) / 24)
enum { DENSE_STAGES = STAGES + 2 }; // Definition: of the method.

static const double dense_C[] = {1. / 2, 1. / 5};

// Definition: weights of the solution of order 5, the last row of A.
#define B0 (35. / 384)
#define B2 (500. / 1113)
#define B3 (125. / 192)
#define B4 (-2187. / 6784)
#define B5 (11. / 84)

static const double dense_A[][DENSE_STAGES] = {
    {POINT(0.5, B0, -12715105075. / 11282082432) + 0.125, 0,
     POINT(0.5, B2, 87487479700. / 32700410799), POINT(0.5, B3, -10690763975. / 1880347072),
     POINT(0.5, B4, 701980252875. / 199316789632), POINT(0.5, B5, -1453857185. / 822651844),
     POINT(0.5, 0, 69997945. / 29380423) - 0.125},
    {POINT(0.2, B0, -12715105075. / 11282082432) + 0.128, 0,
     POINT(0.2, B2, 87487479700. / 32700410799), POINT(0.2, B3, -10690763975. / 1880347072),
     POINT(0.2, B4, 701980252875. / 199316789632), POINT(0.2, B5, -1453857185. / 822651844),
     POINT(0.2, 0, 69997945. / 29380423) - 0.032},
};

// Of e_0: -(1 - t) (1 - 3 t) is 1/4 at 1/2 and -0.32 at 1/5; of e_6: -t (3 t - 2) is 1/4 and 0.28.
static const double dense_D[][DENSE_STAGES] = {
    {F0(B0) + (125 * -0.32 - 8 * 4) / 24, 0, F0(B2), F0(B3), F0(B4), F0(B5),
     (125 * 0.28 - 8 * 4) / 24, -8. * 16 / 24, 125. / 24},
    {F1(B0) + 4, 0, F1(B2), F1(B3), F1(B4), F1(B5), 4, 16, 0},
};

static const struct ct_dense_tableau dense_tableau = {.stages = DENSE_STAGES,
                                                      .corrections = 2,
                                                      .stride = DENSE_STAGES,
                                                      .C = dense_C,
                                                      .A = &dense_A[0][0],
                                                      .D = &dense_D[0][0]};

const struct ct_method ct_method_dopri5 = {
    .name = "dopri5",
    .summary = "Dormand-Prince 5(4), explicit, for smooth motions without stiff parts",
    .source = "dormand1980",
    .tableau = &tableau,
    .dense_tableau = &dense_tableau,
    .order = 5,
    .error_order = 4,
    .create = create,
    .restart = ct_compensation_restart,
    .accept = ct_compensation_accept,
    .step = step,
    .prepare = prepare,
    .has_rough_dense = true,
    .dense = dense,
};
