// See evaluator.h: motions in the speeds, with quaternions.
#include "solve/evaluator/evaluator.h"

#include <math.h>

void ct_quaternion_normalise(double *p)
{
    const double norm = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
    for (int i = 0; i < 4 && norm > 0; i++)
        p[i] /= norm;
}

void ct_evaluator_normalise(const struct ct_evaluator *m, double *q)
{
    for (size_t i = 0; i < m->nq; i++)
        if (m->e->q[i].quaternion == 0)
            ct_quaternion_normalise(q + i);
}

// p <- p o exp(d/2)
static void turn_quaternion(double *p, const double *d)
{
    const double angle = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    const double c = cos(angle / 2), s = angle > 0 ? sin(angle / 2) / angle : 0.5;
    const double v[3] = {s * d[0], s * d[1], s * d[2]}, w[4] = {p[0], p[1], p[2], p[3]};
    p[0] = w[0] * c - w[1] * v[0] - w[2] * v[1] - w[3] * v[2];
    p[1] = w[1] * c + w[0] * v[0] + w[2] * v[2] - w[3] * v[1];
    p[2] = w[2] * c + w[0] * v[1] + w[3] * v[0] - w[1] * v[2];
    p[3] = w[3] * c + w[0] * v[2] + w[1] * v[1] - w[2] * v[0];
    ct_quaternion_normalise(p);
}

void ct_evaluator_retract(const struct ct_evaluator *m, double *q, const double *d)
{
    // quaternions and angular velocities follow each other in the same order
    size_t next = 0;
    for (size_t k = 0; k < m->e->nmotion; k++) {
        if (m->e->u[k].q >= 0) {
            q[m->e->u[k].q] += d[k];
            continue;
        }
        while (m->e->q[next].quaternion != 0)
            next++;
        turn_quaternion(q + next, d + k);
        next++;
        k += 2;
    }
}

// T^-1 = 1 + th~/2 + (1 - (t/2) cot(t/2))/t^2 th~^2, t = |th|
static void chart_rate3(double *rate, const double *th, const double *w)
{
    const double square = th[0] * th[0] + th[1] * th[1] + th[2] * th[2],
                 half = sqrt(square) / 2;
    // below a hundredth the series is right to round-off: its next term is t^4 / 30240
    const double c = half < 0.005 ? 1. / 12 + square / 720 : (1 - half / tan(half)) / square;
    const double x[3] = {th[1] * w[2] - th[2] * w[1], th[2] * w[0] - th[0] * w[2],
                         th[0] * w[1] - th[1] * w[0]};
    const double xx[3] = {th[1] * x[2] - th[2] * x[1], th[2] * x[0] - th[0] * x[2],
                          th[0] * x[1] - th[1] * x[0]};
    for (int i = 0; i < 3; i++)
        rate[i] = w[i] + x[i] / 2 + c * xx[i];
}

void ct_evaluator_chart_rate(const struct ct_evaluator *m, const double *d, const double *w,
                             double *rate)
{
    for (size_t k = 0; k < m->nu; k++) {
        if (m->e->u[k].q >= 0 || ct_speed_is_state(m->e, k)) {
            rate[k] = w[k];
            continue;
        }
        chart_rate3(rate + k, d + k, w + k);
        k += 2;
    }
}
