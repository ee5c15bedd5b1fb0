// Implicit methods on small problems written out: orders, tolerances, constraints, events,
// stiffness.
#include "tests/check.h"
#include "integrate/implicit/newton_iteration.h"
#include "integrate/problem.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NU = 2, MOST_M = 1, MOST_NY = 5 };

// A problem: q, u, and one quadrature of q0^2.
struct model {
    int nu, m;
    // r, phi, v as in struct ct_dae; q (+) d is q + d
    void (*residual)(double t, const double *q, const double *u, const double *a,
                     const double *lam, double *r, double *phi, double *v);
    // accelerations and multipliers
    void (*solve)(double t, const double *q, const double *u, double *a, double *lam);
    double q[MOST_NU], u[MOST_NU];
    long undefined; // the number of the residual that is no number; 0: none
};

// ---- the problems -------------------------------------------------------------------------------

// A pendulum whose inertia grows with its angle, with a damper: M(q) and Q(q, u) are nonlinear.
static void swing(double t, const double *q, const double *u, const double *a,
                  const double *lam, double *r, double *phi, double *v)
{
    (void)lam;
    (void)phi;
    (void)v;
    const double M = 1 + 0.5 * sin(q[0]) * sin(q[0]), dM = sin(q[0]) * cos(q[0]);
    r[0] = M * a[0] + 0.5 * dM * u[0] * u[0] + sin(q[0]) + 0.2 * u[0] - 0.3 * cos(2 * t);
}

static void solve_swing(double t, const double *q, const double *u, double *a, double *lam)
{
    const double none = 0;
    double r;
    swing(t, q, u, &none, lam, &r, NULL, NULL);
    a[0] = -r / (1 + 0.5 * sin(q[0]) * sin(q[0]));
}

static const struct model swinging = {1, 0, swing, solve_swing, {1.2}, {0.4}};

// A mass on a rod whose length changes: Phi = (|q|^2 - L(t)^2)/2, gravity 2, masses 1 and 3 along x
// and y.
static double rod_square(double t, int order)
{
    const double w = 1.7; // L^2 = 1 + 0.2 sin(w t)
    return order == 0 ? 1 + 0.2 * sin(w * t)
         : order == 1 ? 0.2 * w * cos(w * t)
                      : -0.2 * w * w * sin(w * t);
}

static void rod(double t, const double *q, const double *u, const double *a, const double *lam,
                double *r, double *phi, double *v)
{
    r[0] = a[0] + 0.1 * u[0] - q[0] * lam[0];
    r[1] = 3 * a[1] + 0.1 * u[1] + 6 - q[1] * lam[0];
    phi[0] = (q[0] * q[0] + q[1] * q[1] - rod_square(t, 0)) / 2;
    v[0] = q[0] * u[0] + q[1] * u[1] - rod_square(t, 1) / 2;
}

static void solve_rod(double t, const double *q, const double *u, double *a, double *lam)
{
    // q . a + |u|^2 - (L^2)''/2 = 0 with a = free + W q lam
    const double fx = -0.1 * u[0], fy = (-0.1 * u[1] - 6) / 3;
    const double gam = u[0] * u[0] + u[1] * u[1] - rod_square(t, 2) / 2;
    lam[0] = -(gam + q[0] * fx + q[1] * fy) / (q[0] * q[0] + q[1] * q[1] / 3);
    a[0] = fx + q[0] * lam[0];
    a[1] = fy + q[1] * lam[0] / 3;
}

static const struct model rodded = {2, 1, rod, solve_rod, {1, 0}, {0.17, 0.3}};

// Free fall with gravity 2.
static void fall(double t, const double *q, const double *u, const double *a, const double *lam,
                 double *r, double *phi, double *v)
{
    (void)t, (void)q, (void)u, (void)lam, (void)phi, (void)v;
    r[0] = a[0] + 2;
}

static void solve_fall(double t, const double *q, const double *u, double *a, double *lam)
{
    (void)t, (void)q, (void)u, (void)lam;
    a[0] = -2;
}

static const struct model falling = {1, 0, fall, solve_fall, {1}, {0}};

// Stiff: q'' + 1e4 q' + 1e4 (q - cos t) = 0, from rest at q = 1.5.
static void creep(double t, const double *q, const double *u, const double *a,
                  const double *lam, double *r, double *phi, double *v)
{
    (void)lam, (void)phi, (void)v;
    r[0] = a[0] + 1e4 * u[0] + 1e4 * (q[0] - cos(t));
}

static void solve_creep(double t, const double *q, const double *u, double *a, double *lam)
{
    (void)lam;
    a[0] = -1e4 * u[0] - 1e4 * (q[0] - cos(t));
}

static const struct model creeping = {1, 0, creep, solve_creep, {1.5}, {0}};

// ---- the problem of a model ---------------------------------------------------------------------

struct user {
    const struct model *model;
    long nresidual; // evaluations
    struct ct_ctx ctx;
    struct ct_integrate_stats stats;
    size_t used;    // of the arena after the first step
    bool has_grown; // since then
    double worst_phi, worst_v;
    double last,
        lam[MOST_M]; // of the last residual at the latest time: where the iteration ended
    int nevent;
    double event[100];
    double sample[3][MOST_NY];
    int nsample;
};

static enum ct_eval rhs(void *user, double t, const double *y, double *dy)
{
    const struct model *m = ((struct user *)user)->model;
    double lam[MOST_M];
    memcpy(dy, y + m->nu, (size_t)m->nu * sizeof *y);
    m->solve(t, y, y + m->nu, dy + m->nu, lam);
    dy[2 * m->nu] = y[0] * y[0];
    return CT_EVAL_OK;
}

static int rows(void *user, long *version)
{
    *version = 1;
    return ((struct user *)user)->model->m;
}

static void retract(void *user, const double *q, const double *d, double *q1)
{
    for (int i = 0; i < ((struct user *)user)->model->nu; i++)
        q1[i] = q[i] + d[i];
}

static void chart_rate(void *user, const double *d, const double *w, double *rate)
{
    (void)d;
    memcpy(rate, w, (size_t)((struct user *)user)->model->nu * sizeof *w);
}

static enum ct_eval start(void *user, double t, const double *y, double *a, double *lam)
{
    const struct model *m = ((struct user *)user)->model;
    m->solve(t, y, y + m->nu, a, lam);
    return CT_EVAL_OK;
}

static enum ct_eval residual(void *user, double t, const double *q, const double *u,
                             const double *a, const double *lam, double *r, double *phi,
                             double *v)
{
    struct user *s = user;
    s->model->residual(t, q, u, a, lam, r, phi, v);
    if (++s->nresidual == s->model->undefined)
        r[0] = NAN;
    if (t >= s->last && s->model->m) {
        s->last = t;
        memcpy(s->lam, lam, (size_t)s->model->m * sizeof *lam);
    }
    return CT_EVAL_OK;
}

// By central differences: as good as an iteration needs.
static enum ct_eval tangent(void *user, double t, const double *q, const double *u,
                            const double *a, const double *lam, double *M, double *C, double *K,
                            double *J, double *D)
{
    const struct model *m = ((struct user *)user)->model;
    const double h = 1e-5;
    for (int level = 0; level < 3; level++)
        for (int k = 0; k < m->nu; k++) {
            double x[3][MOST_NU], r[2][MOST_NU], phi[2][MOST_M], v[2][MOST_M];
            for (int side = 0; side < 2; side++) {
                memcpy(x[0], q, (size_t)m->nu * sizeof *q);
                memcpy(x[1], u, (size_t)m->nu * sizeof *q);
                memcpy(x[2], a, (size_t)m->nu * sizeof *q);
                x[level][k] += side ? h : -h;
                m->residual(t, x[0], x[1], x[2], lam, r[side], phi[side], v[side]);
            }
            double *A = level == 0 ? K : level == 1 ? C : M;
            for (int i = 0; i < m->nu; i++)
                A[i + m->nu * k] = (r[1][i] - r[0][i]) / (2 * h);
            for (int i = 0; i < m->m && level == 0; i++) {
                J[i + m->m * k] = (phi[1][i] - phi[0][i]) / (2 * h);
                D[i + m->m * k] = (v[1][i] - v[0][i]) / (2 * h);
            }
        }
    return CT_EVAL_OK;
}

static bool at_step(void *user, double t, const double *y)
{
    struct user *s = user;
    const struct model *m = s->model;
    double r[MOST_NU], phi[MOST_M] = {0}, v[MOST_M] = {0}, zero[MOST_NU] = {0};
    m->residual(t, y, y + m->nu, zero, zero, r, phi, v);
    s->worst_phi = fmax(s->worst_phi, fabs(phi[0]));
    s->worst_v = fmax(s->worst_v, fabs(v[0]));
    if (!s->used)
        s->used = ct_arena_used(s->ctx.model);
    s->has_grown |= ct_arena_used(s->ctx.model) != s->used;
    return true;
}

static bool at_sample(void *user, double t, const double *y)
{
    struct user *s = user;
    (void)t;
    memcpy(s->sample[s->nsample++], y, (size_t)(2 * s->model->nu + 1) * sizeof *y);
    return true;
}

// Integrate to t1; y (out). What is left of the run stays in s.
static bool run(struct user *s, const struct model *m, const char *method, struct ct_problem p,
                struct ct_integrate_options o, double *y)
{
    static const int q_of[MOST_NU] = {0, 1};
    const struct ct_dae dae
        = {s, m->nu, m->nu, m->m, q_of, 1, rows, retract, chart_rate, start, residual, tangent};
    *s = (struct user){.model = m, .ctx.model = ct_arena_create()};
    p.user = s;
    p.ny = 2 * m->nu + 1;
    p.dae = &dae;
    p.rhs = rhs;
    if (o.rtol == 0)
        o.rtol = o.atol;
    o.at_step = at_step;
    o.at_sample = at_sample;
    memcpy(y, m->q, (size_t)m->nu * sizeof *y);
    memcpy(y + m->nu, m->u, (size_t)m->nu * sizeof *y);
    y[2 * m->nu] = 0;
    const bool ok = ct_integrate(&s->ctx, ct_method_find(method), &p, &o, y, &s->stats);
    ct_ctx_print(&s->ctx, stdout);
    ct_arena_destroy(s->ctx.model);
    return ok;
}

static const struct ct_problem plain = {0};

static const char *const implicit[]
    = {"radau5", "generalized-alpha", "generalized-alpha-index3", "hht", "newmark"};

static void reference(const struct model *m, double t1, double *y)
{
    struct user s;
    assert_true(
        run(&s, m, "dop853", plain, (struct ct_integrate_options){.t1 = t1, .atol = 1e-14}, y));
}

static double distance(const double *a, const double *b, int n)
{
    double worst = 0;
    for (int i = 0; i < n; i++)
        worst = fmax(worst, fabs(a[i] - b[i]));
    return worst;
}

// ---- orders -------------------------------------------------------------------------------------

// Places, speeds and quadratures by halving the step.
static void check_order(const struct model *m, const char *method, int nstep, double want)
{
    const double t1 = 2;
    double exact[MOST_NY], y[2][MOST_NY];
    struct user s;
    reference(m, t1, exact);
    for (int k = 0; k < 2; k++)
        assert_true(run(&s, m, method, plain,
                        (struct ct_integrate_options){.t1 = t1, .step = t1 / (nstep << k)},
                        y[k]));
    double order[3], error[3];
    for (int part = 0; part < 3; part++) {
        const int first = part * m->nu, n = part < 2 ? m->nu : 1;
        error[part] = distance(y[1] + first, exact + first, n);
        order[part] = log2(distance(y[0] + first, exact + first, n) / error[part]);
    }
    printf("%s, %d rows: orders %.2f %.2f %.2f, errors %.1e %.1e %.1e; phi %.0e, v %.0e\n",
           method, m->m, order[0], order[1], order[2], error[0], error[1], error[2],
           s.worst_phi, s.worst_v);
    for (int part = 0; part < 3; part++)
        CHECK_CLOSE(order[part], want, 0, part < 2 ? 0.15 * want : 0.3 * want);
    assert_false(s.has_grown);
    assert_true(s.worst_phi < 1e-10); // what the iteration leaves
    if (m->m && strcmp(method, "generalized-alpha-index3") != 0)
        assert_true(s.worst_v < 1e-10);
}

static void orders_are_those_of_the_theory(void **unused)
{
    (void)unused;
    const struct model *const model[] = {&swinging, &rodded};
    for (size_t k = 0; k < COUNT(model); k++)
        for (size_t i = 0; i < COUNT(implicit); i++) {
            const bool is_radau = i == 0;
            check_order(model[k], implicit[i], is_radau ? 16 << model[k]->m : 400,
                        is_radau ? 5 : 2);
        }
}

// The multipliers that the methods carry, at the end of the run.
static void check_orders_of_multipliers(const struct model *m)
{
    const double t1 = 2;
    double exact[MOST_NY], y[MOST_NY], a[MOST_NU], lam;
    reference(m, t1, exact);
    m->solve(t1, exact, exact + m->nu, a, &lam);
    for (size_t i = 0; i < COUNT(implicit); i++) {
        const bool is_radau = i == 0;
        const int nstep = is_radau ? 32 : 400;
        double error[2];
        for (int k = 0; k < 2; k++) {
            struct user s;
            assert_true(run(&s, m, implicit[i], plain,
                            (struct ct_integrate_options){.t1 = t1, .step = t1 / (nstep << k)},
                            y));
            assert_true(s.last == t1);
            error[k] = fabs(s.lam[0] - lam);
        }
        const double order = log2(error[0] / error[1]), want = is_radau ? 3 : 2;
        printf("%s: multipliers of order %.2f, error %.1e\n", implicit[i], order, error[1]);
        CHECK_CLOSE(order, want, 0, 0.15 * want);
    }
}

static void orders_of_multipliers_are_those_of_the_theory(void **unused)
{
    (void)unused;
    check_orders_of_multipliers(&rodded);
}

// From the multipliers at the start of the step it is 20 with radau5 and 6.6 with the others.
static void corrections_begin_with_multipliers_as_they_go_on(void **unused)
{
    (void)unused;
    static const struct {
        const char *method;
        double most; // evaluations a step
    } list[] = {{"radau5", 17.5}, {"hht", 5.4}, {"newmark", 5.4}};
    for (size_t i = 0; i < COUNT(list); i++) {
        struct user s;
        double y[MOST_NY];
        assert_true(run(&s, &rodded, list[i].method, plain,
                        (struct ct_integrate_options){.t1 = 2, .atol = 1e-8}, y));
        const double each = (double)s.stats.evaluations / (double)s.stats.steps;
        printf("%s: %ld steps, %.2f evaluations each\n", list[i].method, s.stats.steps, each);
        assert_true(each < list[i].most);
    }
}

// A residual that is no number asks for newer derivatives or a smaller step, and leaves no trace.
static void residuals_that_are_no_numbers_are_tried_again(void **unused)
{
    (void)unused;
    struct model broken = rodded;
    const struct ct_integrate_options o = {.t1 = 2, .atol = 1e-6};
    double want[MOST_NY], y[MOST_NY];
    struct user s;
    assert_true(run(&s, &rodded, "hht", plain, o, want));
    for (broken.undefined = 40; broken.undefined < 48; broken.undefined++) {
        assert_true(run(&s, &broken, "hht", plain, o, y));
        assert_true(s.nresidual > broken.undefined);
        for (int i = 0; i < 4; i++)
            CHECK_CLOSE(y[i], want[i], 0, 5e-6); // of an error of 4e-4
    }
}

// The hidden constraint is met to second order by the index-3 form, at each step.
static void index3_meets_speeds_to_second_order(void **unused)
{
    (void)unused;
    double v[2], y[MOST_NY];
    struct user s;
    for (int k = 0; k < 2; k++) {
        assert_true(run(&s, &rodded, "generalized-alpha-index3", plain,
                        (struct ct_integrate_options){.t1 = 2, .step = 2. / (400 << k)}, y));
        v[k] = s.worst_v;
    }
    printf("v %.1e %.1e\n", v[0], v[1]);
    CHECK_CLOSE(log2(v[0] / v[1]), 2, 0, 0.2);
}

static void errors_follow_the_tolerance(void **unused)
{
    (void)unused;
    const struct model *const model[] = {&swinging, &rodded};
    for (size_t k = 0; k < COUNT(model); k++)
        for (size_t i = 0; i < COUNT(implicit); i++) {
            const int ny = 2 * model[k]->nu + 1;
            const double time[] = {0.777, 2.222, 3};
            double exact[3][MOST_NY], y[MOST_NY], before = INFINITY;
            for (int j = 0; j < 3; j++)
                reference(model[k], time[j], exact[j]);
            for (int digits = 4; digits <= 8; digits += 2) {
                struct user s;
                double worst = 0;
                assert_true(
                    run(&s, model[k], implicit[i], plain,
                        (struct ct_integrate_options){
                            .t1 = 3, .atol = pow(10, -digits), .sample = time, .nsample = 3},
                        y));
                for (int j = 0; j < 3; j++)
                    worst = fmax(worst, distance(s.sample[j], exact[j], ny));
                printf("%s, %d rows, 1e-%d: %ld steps, %ld refused, %ld evaluations, %ld "
                       "Jacobians, %ld factorizations, error %.1e\n",
                       implicit[i], model[k]->m, digits, s.stats.steps, s.stats.rejected_steps,
                       s.stats.evaluations, s.stats.jacobians, s.stats.factorizations, worst);
                // order 2: a hundredfold tolerance is a step 4.6 times as long, an error 21 times
                // as large
                assert_true(worst < before / 8);
                assert_true(worst < 300 * pow(10, -2. / 3 * digits));
                assert_false(s.has_grown);
                // most steps use old derivatives and old factors
                assert_true(digits < 8 || s.stats.jacobians < s.stats.steps / 2);
                before = worst;
            }
        }
}

// ---- events, stiffness, misuse ------------------------------------------------------------------

static enum ct_eval height(void *user, double t, const double *y, double *g)
{
    (void)user, (void)t;
    g[0] = y[0];
    return CT_EVAL_OK;
}

static enum ct_eval bounce(void *user, double t, double *y, const double *dy,
                           const signed char *crossed, bool is_time)
{
    (void)dy;
    struct user *s = user;
    assert_true(crossed[0] < 0 && !is_time);
    s->event[s->nevent++] = t;
    y[1] *= -0.8;
    return CT_EVAL_OK;
}

static void steps_restart_after_an_impact(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < COUNT(implicit); i++) {
        struct user s;
        double y[MOST_NY];
        assert_true(run(&s, &falling, implicit[i],
                        (struct ct_problem){.nroot = 1, .root = height, .event = bounce},
                        (struct ct_integrate_options){.t1 = 6, .atol = 1e-8}, y));
        double t = 1, v = 2;
        int n = 0;
        for (; t < 6; n++) {
            CHECK_CLOSE(s.event[n], t, 0, 1e-9); // parabolas are exact but for the iteration
            v *= 0.8;
            t += v;
        }
        assert_int_equal(s.nevent, n);
        t -= v;
        CHECK_CLOSE(y[0], v * (6 - t) - (6 - t) * (6 - t), 0, 1e-8);
        assert_false(s.has_grown);
    }
}

static void stiff_decay_takes_few_steps(void **unused)
{
    (void)unused;
    // q = A cos(t - p) + B exp(-l t) + ..., l ~ 1: the fast part is gone after 1e-3 s
    double exact[MOST_NY], y[MOST_NY];
    reference(&creeping, 3, exact);
    for (size_t i = 0; i < COUNT(implicit); i++) {
        struct user s;
        assert_true(run(&s, &creeping, implicit[i], plain,
                        (struct ct_integrate_options){.t1 = 3, .atol = 1e-5}, y));
        printf("%s: %ld steps, error %.1e %.1e\n", implicit[i], s.stats.steps,
               fabs(y[0] - exact[0]), fabs(y[1] - exact[1]));
        assert_true(s.stats.steps < 1000); // an explicit method is limited to 3e-4 s: 1e4 steps
        CHECK_CLOSE(y[0], exact[0], 0, 1e-3);
    }
}

static void implicit_methods_want_a_residual(void **unused)
{
    (void)unused;
    struct user s = {.model = &falling, .ctx.model = ct_arena_create()};
    const struct ct_problem p = {.user = &s, .ny = 3, .rhs = rhs};
    const struct ct_integrate_options o = {.t1 = 1, .rtol = 1e-6, .atol = 1e-6};
    double y[3] = {1, 0, 0};
    assert_false(ct_integrate(&s.ctx, ct_method_find("radau5"), &p, &o, y, &s.stats));
    assert_int_equal(s.ctx.diagnostic[0].code, CT_E_INTEGRATE_OPTION);
    ct_arena_destroy(s.ctx.model);
}

// ---- round-off of forces ------------------------------------------------------------------------

// A spring whose force is off by a grain in all places but one, and how far from there it is looked
// at.
static const double stiffness = 1e4, grain = 1e-6;
static double farthest;
static bool is_of_inertia; // the error is relative to the acceleration

static enum ct_eval find_grainy(void *user, double t, const double *q, const double *u,
                                const double *a, const double *lam, double *r, double *phi,
                                double *v)
{
    (void)user, (void)t, (void)u, (void)lam, (void)phi, (void)v;
    farthest = fmax(farthest, fabs(q[0] - 1));
    r[0] = a[0] + stiffness * q[0] + (q[0] != 1 ? (is_of_inertia ? a[0] : 1) * grain : 0);
    return CT_EVAL_OK;
}

static enum ct_eval derive_grainy(void *user, double t, const double *q, const double *u,
                                  const double *a, const double *lam, double *M, double *C,
                                  double *K, double *J, double *D)
{
    (void)user, (void)t, (void)q, (void)u, (void)a, (void)lam, (void)J, (void)D;
    M[0] = 1;
    C[0] = 0;
    K[0] = stiffness;
    return CT_EVAL_OK;
}

static int no_rows(void *user, long *version)
{
    (void)user;
    *version = 1;
    return 0;
}

// What a correction that has stalled comes to, of that size.
static enum ct_convergence judge_stalled(struct ct_newton_iteration *it, double size)
{
    const double far[] = {1, 1, 1, 1};
    ct_newton_iteration_start(it);
    ct_newton_iteration_test_convergence(it, size, far, far, 1);
    return ct_newton_iteration_test_convergence(it, size, far, far, 1);
}

// (8.17): stages may add up three times what is seen of a round-off, and looks differ by two. What
// is 25 times as much is none. Forces are looked at where places cannot be told apart, from 8
// round-off errors on.
static void compare_stalled_corrections(bool with_inertia)
{
    is_of_inertia = with_inertia;
    static const int q_of[] = {0};
    const struct ct_dae dae = {.nq = 1,
                               .nu = 1,
                               .q_of = q_of,
                               .rows = no_rows,
                               .residual = find_grainy,
                               .tangent = derive_grainy,
                               .is_plain = true};
    const struct ct_problem p = {.ny = 2, .dae = &dae};
    const struct ct_tolerance tight = {1e-12, 1e-12};
    const double y[] = {1, 1}, acceleration[] = {1}, zero[] = {0}, h = 1e-2;
    struct ct_integrate_stats stats = {0};
    struct ct_arena *a = ct_arena_create();
    struct ct_newton_iteration *it = ct_newton_iteration_create(a, &p, true, false);
    ct_newton_iteration_begin(it, &tight, h, y);
    assert_int_equal(ct_newton_iteration_refresh(it, 0, y, y + 1, acceleration, zero, &stats),
                     CT_EVAL_OK);
    assert_true(ct_newton_iteration_factor(it, 2 / h, 4 / (h * h), 0, &stats));
    farthest = 0;
    const double *noise = ct_newton_iteration_roundoff(it);
    const double seen = ct_newton_iteration_norm(it, noise, noise + 1, 1, 1);
    printf("seen %.3g of the tolerance, %.3g roundings away\n", seen, farthest / DBL_EPSILON);
    assert_true(seen > 1 && farthest >= 4 * DBL_EPSILON && farthest <= 32 * DBL_EPSILON);
    assert_int_equal(judge_stalled(it, 6 * seen), CT_CONVERGED);
    assert_int_not_equal(judge_stalled(it, 25 * seen), CT_CONVERGED);
    ct_arena_destroy(a);
}

static void stalled_corrections_are_compared_with_roundoff_of_forces(void **unused)
{
    (void)unused;
    compare_stalled_corrections(false);
}

// Of 1000 beam elements whose shortest waves vibrate the round-off of M u' is 2500 times that of the
// forces.
static void stalled_corrections_are_compared_with_roundoff_of_inertia_forces(void **unused)
{
    (void)unused;
    compare_stalled_corrections(true);
}

// Two masses that move alike, the second held by a spring: the row is off by a grain in all places
// but one.
static enum ct_eval find_grainy_row(void *user, double t, const double *q, const double *u,
                                    const double *a, const double *lam, double *r, double *phi,
                                    double *v)
{
    (void)user, (void)t;
    r[0] = a[0] - lam[0];
    r[1] = a[1] + stiffness * q[1] + lam[0];
    phi[0] = q[0] - q[1] + (q[0] != 1 ? grain : 0);
    v[0] = u[0] - u[1];
    return CT_EVAL_OK;
}

static enum ct_eval derive_grainy_row(void *user, double t, const double *q, const double *u,
                                      const double *a, const double *lam, double *M, double *C,
                                      double *K, double *J, double *D)
{
    (void)user, (void)t, (void)q, (void)u, (void)a, (void)lam;
    memset(M, 0, 4 * sizeof *M);
    memset(C, 0, 4 * sizeof *C);
    memset(K, 0, 4 * sizeof *K);
    memset(D, 0, 2 * sizeof *D);
    M[0] = M[3] = 1;
    K[3] = stiffness;
    J[0] = 1;
    J[1] = -1;
    return CT_EVAL_OK;
}

static int one_row(void *user, long *version)
{
    (void)user;
    *version = 1;
    return 1;
}

// (8.17): what rows are off by moves the masses apart by as much, d, which the spring feels: both
// swing by k d/2/(2 m e + k) for it.
static void stalled_corrections_are_compared_with_roundoff_of_constraints(void **unused)
{
    (void)unused;
    static const int q_of[] = {0, 1};
    const struct ct_dae dae = {.nq = 2,
                               .nu = 2,
                               .most_rows = 1,
                               .q_of = q_of,
                               .rows = one_row,
                               .residual = find_grainy_row,
                               .tangent = derive_grainy_row,
                               .is_plain = true};
    const struct ct_problem p = {.ny = 4, .dae = &dae};
    const struct ct_tolerance tight = {1e-12, 1e-12};
    const double y[] = {1, 1, 1, 1}, zero[] = {0, 0}, h = 1e-2, c = 2 / h, e = c * c;
    struct ct_integrate_stats stats = {0};
    struct ct_arena *a = ct_arena_create();
    struct ct_newton_iteration *it = ct_newton_iteration_create(a, &p, true, false);
    ct_newton_iteration_begin(it, &tight, h, y);
    assert_int_equal(ct_newton_iteration_refresh(it, 0, y, y + 2, zero, zero, &stats),
                     CT_EVAL_OK);
    assert_true(ct_newton_iteration_factor(it, c, e, 0, &stats));
    const double *noise = ct_newton_iteration_roundoff(it);
    const double seen = ct_newton_iteration_norm(it, noise, noise + 2, 2, 1);
    const double swing = stiffness * grain / 2 / (2 * e + stiffness);
    CHECK_CLOSE(fabs(noise[0] - noise[1]) / grain, 1, 1e-6,
                0); // round-off errors beside the grain
    CHECK_CLOSE(fabs(noise[2]) / (c * swing), 1, 1e-6, 0);
    CHECK_CLOSE(noise[3] / noise[2], 1, 1e-6, 0);
    assert_int_equal(judge_stalled(it, 6 * seen), CT_CONVERGED);
    assert_int_not_equal(judge_stalled(it, 25 * seen), CT_CONVERGED);
    ct_arena_destroy(a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(orders_are_those_of_the_theory),
        cmocka_unit_test(orders_of_multipliers_are_those_of_the_theory),
        cmocka_unit_test(corrections_begin_with_multipliers_as_they_go_on),
        cmocka_unit_test(residuals_that_are_no_numbers_are_tried_again),
        cmocka_unit_test(stalled_corrections_are_compared_with_roundoff_of_forces),
        cmocka_unit_test(stalled_corrections_are_compared_with_roundoff_of_inertia_forces),
        cmocka_unit_test(stalled_corrections_are_compared_with_roundoff_of_constraints),
        cmocka_unit_test(index3_meets_speeds_to_second_order),
        cmocka_unit_test(errors_follow_the_tolerance),
        cmocka_unit_test(steps_restart_after_an_impact),
        cmocka_unit_test(stiff_decay_takes_few_steps),
        cmocka_unit_test(implicit_methods_want_a_residual),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
