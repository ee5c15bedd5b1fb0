// What tests of integration share: a record of what a run does, and problems with solutions in
// closed form.
#ifndef CT_TESTS_UNIT_INTEGRATION_H
#define CT_TESTS_UNIT_INTEGRATION_H

#include "integrate/problem.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { MOST = 2048, NY = 4 };

// What a run leaves behind; also the user data of all problems here.
struct record {
    struct ct_ctx ctx;
    struct ct_integrate_stats stats;
    int nstep, nsample, nevent;
    double step[MOST], event[MOST], sample[MOST], value[MOST][NY];
    signed char crossed[MOST][NY];
    bool is_time[MOST];
    size_t used[MOST]; // of the arena at each step
    const double *due; // time events, ended by INFINITY
    int ny, nroot, mode, accepted;
    double limit;                       // meaning depends on the problem
    void (*exact)(double t, double *y); // NULL: unknown
    double worst_step, worst_sample;    // against `exact`
    int stop_after;                     // steps, 0: never
};

static inline void check_below(const char *what, double got, double limit)
{
    if (!(got <= limit)) {
        printf("%s: got %.6g, wanted at most %.6g\n", what, got, limit);
        fail();
    }
}

static inline void check_close(const char *what, double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance)) {
        printf("%s: got %.17g, wanted %.17g within %g\n", what, got, want, tolerance);
        fail();
    }
}

static inline double distance(const struct record *r, double t, const double *y)
{
    double z[NY], worst = 0;
    r->exact(t, z);
    for (int i = 0; i < r->ny; i++)
        worst = fmax(worst, fabs(z[i] - y[i]));
    return worst;
}

static inline bool at_step(void *user, double t, const double *y)
{
    struct record *r = user;
    if (r->nstep < MOST) {
        r->used[r->nstep] = ct_arena_used(r->ctx.model);
        r->step[r->nstep] = t;
    }
    r->nstep++;
    if (r->exact)
        r->worst_step = fmax(r->worst_step, distance(r, t, y));
    return r->nstep != r->stop_after;
}

static inline bool at_sample(void *user, double t, const double *y)
{
    struct record *r = user;
    assert_true(r->nsample < MOST);
    r->sample[r->nsample] = t;
    memcpy(r->value[r->nsample++], y, (size_t)r->ny * sizeof *y);
    if (r->exact)
        r->worst_sample = fmax(r->worst_sample, distance(r, t, y));
    return true;
}

static inline double next_due(void *user, double t)
{
    const double *due = ((struct record *)user)->due;
    while (*due <= t)
        due++;
    return *due;
}

static inline enum ct_eval note_event(void *user, double t, double *y, const double *dy,
                                      const signed char *crossed, bool is_time)
{
    (void)dy;
    struct record *r = user;
    (void)y;
    assert_true(r->nevent < MOST);
    r->event[r->nevent] = t;
    r->is_time[r->nevent] = is_time;
    memcpy(r->crossed[r->nevent++], crossed, (size_t)r->nroot);
    return CT_EVAL_OK;
}

static inline bool run(struct record *r, const struct ct_method *method, struct ct_problem p,
                       struct ct_integrate_options o, double *y)
{
    p.user = r;
    r->ny = p.ny;
    r->nroot = p.nroot;
    o.at_step = at_step;
    o.at_sample = at_sample;
    if (o.rtol == 0)
        o.rtol = o.atol;
    return ct_integrate(&r->ctx, method, &p, &o, y, &r->stats);
}

static inline struct record *begin(void)
{
    struct record *r = calloc(1, sizeof *r);
    r->ctx.model = ct_arena_create();
    return r;
}

static inline void end(struct record *r)
{
    ct_arena_destroy(r->ctx.model);
    free(r);
}

static inline void check_fine(const struct record *r, bool ok)
{
    ct_ctx_print(&r->ctx, stdout);
    assert_true(ok);
}

static inline void check_error(const struct record *r, bool ok, enum ct_code code)
{
    assert_false(ok);
    assert_int_equal(r->ctx.nerror, 1);
    assert_int_equal(r->ctx.diagnostic[0].code, code);
}

static inline void fill_even(double *s, int n, double t1)
{
    for (int i = 0; i < n; i++)
        s[i] = t1 * i / (n - 1);
}

// --- the problems ---------------------------------------------------------------------------

// Kepler's orbit of eccentricity 0.3: smooth, nonlinear, errors accumulate.
static const double eccentricity = 0.3;

static inline void kepler_exact(double t, double *y)
{
    double E = t;
    for (int i = 0; i < 50; i++) // Newton's method on E - e sin E = t
        E -= (E - eccentricity * sin(E) - t) / (1 - eccentricity * cos(E));
    const double d = 1 - eccentricity * cos(E), b = sqrt(1 - eccentricity * eccentricity);
    y[0] = cos(E) - eccentricity;
    y[1] = b * sin(E);
    y[2] = -sin(E) / d;
    y[3] = b * cos(E) / d;
}

static inline enum ct_eval kepler(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    const double r = hypot(y[0], y[1]), r3 = r * r * r;
    dy[0] = y[2];
    dy[1] = y[3];
    dy[2] = -y[0] / r3;
    dy[3] = -y[1] / r3;
    return CT_EVAL_OK;
}

// y = sin 3t, which attracts: errors of steps die out, those of interpolation are seen alone.
static inline void attractor_exact(double t, double *y)
{
    y[0] = sin(3 * t);
}

static inline enum ct_eval attractor(void *user, double t, const double *y, double *dy)
{
    (void)user;
    dy[0] = 3 * cos(3 * t) - 2 * (y[0] - sin(3 * t)) * (1 + y[0] * y[0]);
    return CT_EVAL_OK;
}

// y = (cos t, -sin t)
static inline void oscillator_exact(double t, double *y)
{
    y[0] = cos(t);
    y[1] = -sin(t);
}

static inline enum ct_eval oscillator(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    dy[0] = y[1];
    dy[1] = -y[0];
    return CT_EVAL_OK;
}

// A ball over a floor at height 0 under gravity 2, restitution in `limit`.
static inline enum ct_eval ball(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    dy[0] = y[1];
    dy[1] = -2;
    return CT_EVAL_OK;
}

static inline enum ct_eval height(void *user, double t, const double *y, double *g)
{
    (void)user;
    (void)t;
    g[0] = y[0];
    return CT_EVAL_OK;
}

static inline enum ct_eval bounce(void *user, double t, double *y, const double *dy,
                                  const signed char *crossed, bool is_time)
{
    struct record *r = user;
    note_event(user, t, y, dy, crossed, is_time);
    if (crossed[0] < 0)
        y[1] *= -r->limit;
    return CT_EVAL_OK;
}

static const struct ct_problem bouncing
    = {.ny = 2, .rhs = ball, .nroot = 1, .root = height, .event = bounce};

// ... with what is due as well
static const struct ct_problem bouncing_on_time = {.ny = 2,
                                                   .rhs = ball,
                                                   .nroot = 1,
                                                   .root = height,
                                                   .next_time_event = next_due,
                                                   .event = bounce};

#endif
