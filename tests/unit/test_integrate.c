// Integration against solutions in closed form: orders, tolerances, samples, projection. The
// explicit methods, which stand first in the table; test_implicit.c has the others, test_events.c
// events, test_failed_runs.c what cannot go on.
#include "integrate/step_control.h"
#include "integrate/stiffness.h"
#include "integrate/stepper.h"
#include "tests/unit/integration.h"

#include <float.h>

// --- orders and tolerances -------------------------------------------------------------------

static void methods_are_found_by_name(void **unused)
{
    (void)unused;
    for (int i = 0; i < ct_nmethod; i++)
        assert_ptr_equal(ct_method_find(ct_methods[i]->name), ct_methods[i]);
    assert_null(ct_method_find("euler"));
}

static double kepler_error(const struct ct_method *method, int nstep)
{
    struct record *r = begin();
    double y[NY];
    kepler_exact(0, y);
    r->exact = kepler_exact;
    check_fine(r, run(r, method, (struct ct_problem){.ny = 4, .rhs = kepler},
                      (struct ct_integrate_options){.t1 = 4, .step = 4.0 / nstep}, y));
    assert_int_equal(r->stats.steps, nstep);
    const double error = distance(r, 4, y);
    end(r);
    return error;
}

static void halving_a_fixed_step_shows_the_order(void **unused)
{
    (void)unused;
    // steps small enough for the leading term, errors above 1e-13 for round-off
    static const struct {
        const char *name;
        int nstep;
    } cases[] = {{"rk4", 320}, {"dopri5", 160}, {"dop853", 40}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct ct_method *m = ct_method_find(cases[i].name);
        const double order
            = log2(kepler_error(m, cases[i].nstep) / kepler_error(m, 2 * cases[i].nstep));
        printf("%s: order %.2f\n", m->name, order);
        check_close("order", order, m->order, 0.45);
    }
}

static enum ct_eval even(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    (void)y;
    dy[0] = 1. / 3;
    return CT_EVAL_OK;
}

// Summed without care, a hundred thousand steps leave an error of some hundred round-off errors or
// more.
static void roundings_of_many_steps_do_not_add_up(void **unused)
{
    (void)unused;
    static const char *const names[] = {"rk4", "dopri5", "dop853"};
    for (size_t i = 0; i < COUNT(names); i++) {
        struct record *r = begin();
        double y[1] = {1};
        check_fine(r,
                   run(r, ct_method_find(names[i]), (struct ct_problem){.ny = 1, .rhs = even},
                       (struct ct_integrate_options){.t1 = 1, .step = 1e-5}, y));
        check_close(names[i], y[0], 4. / 3, 2 * DBL_EPSILON);
        end(r);
    }
}

static enum ct_eval swinging(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    dy[0] = y[1];
    dy[1] = -y[0];
    return CT_EVAL_OK;
}

// out_s = sum_j A_sj v_j of the first n stages, more exactly than A is.
static void times_table(const struct ct_tableau *m, int n, const long double *v,
                        long double *out)
{
    for (int s = 0; s < n; s++) {
        out[s] = 0;
        for (int j = 0; j < s; j++)
            out[s] += (long double)m->A[s * m->stride + j] * v[j];
    }
}

// Rounded one by one, its coefficients miss conditions up to order 4 by up to 4.6e-16.
static void the_table_of_dop853_fulfils_conditions_below_rounding(void **unused)
{
    (void)unused;
    enum { STAGES = 12 };
    if (LDBL_EPSILON > 1e-18)
        return; // nothing to see it with
    const struct ct_tableau *m = ct_method_find("dop853")->tableau;
    assert_int_equal(m->stages, STAGES + 1);
    long double one[STAGES], c[STAGES], Ac[STAGES], AAc[STAGES], cc[STAGES], Acc[STAGES];
    long double sum[8] = {0};
    for (int s = 0; s < STAGES; s++)
        one[s] = 1;
    times_table(m, STAGES, one, c);
    for (int s = 0; s < STAGES; s++)
        cc[s] = c[s] * c[s];
    times_table(m, STAGES, c, Ac);
    times_table(m, STAGES, Ac, AAc);
    times_table(m, STAGES, cc, Acc);
    for (int s = 0; s < STAGES; s++) {
        const long double b = m->A[STAGES * m->stride + s];
        const long double of[]
            = {1, c[s], cc[s], Ac[s], c[s] * cc[s], c[s] * Ac[s], Acc[s], AAc[s]};
        for (size_t k = 0; k < COUNT(sum); k++)
            sum[k] += b * of[k];
    }
    static const int wanted[] = {1, 2, 3, 6, 4, 8, 12, 24};
    for (size_t k = 0; k < COUNT(sum); k++)
        check_close("condition, in roundings", (double)(wanted[k] * sum[k] - 1) / DBL_EPSILON,
                    0, 0.05);
}

// Coefficients of dop853 that are rounded one by one take 7.8e-16 (omega h)^2 of the energy in each
// step: 1.9e-12 of these.
static void a_million_steps_keep_the_energy(void **unused)
{
    (void)unused;
    struct record *r = begin();
    double y[2] = {1, 0};
    check_fine(r,
               run(r, ct_method_find("dop853"), (struct ct_problem){.ny = 2, .rhs = swinging},
                   (struct ct_integrate_options){.t1 = 5e4, .step = 0.05}, y));
    assert_int_equal(r->stats.steps, 1000000);
    printf("energy %.2g\n", y[0] * y[0] + y[1] * y[1] - 1);
    check_close("energy", y[0] * y[0] + y[1] * y[1], 1,
                3e-13); // round-off errors of either sign
    end(r);
}

// Largest error of one step, and of its interpolants without and with preparation.
static void local_errors(const struct ct_method *m, double h, double *step, double *rough,
                         double *fine)
{
    const struct ct_problem p = {.ny = 4, .rhs = kepler};
    struct ct_integrate_stats stats = {0};
    struct record r = {.ny = 4, .exact = kepler_exact};
    double y[NY], dy[NY], y1[NY], dy1[NY], out[NY], err, t = 0.5;
    struct ct_arena *arena = ct_arena_create();
    void *work = m->create(arena, m, &p);
    kepler_exact(t, y);
    kepler(NULL, t, y, dy);
    assert_int_equal(m->step(&p, t, h, y, dy, NULL, y1, dy1, &err, work, &stats), CT_EVAL_OK);
    *step = distance(&r, t + h, y1);
    *rough = *fine = 0;
    for (int i = 1; i < 20 && (m->has_rough_dense || !m->prepare); i++) {
        m->dense(&p, h, i / 20.0, y, y1, work, out);
        *rough = fmax(*rough, distance(&r, t + h * i / 20, out));
    }
    if (m->prepare)
        assert_int_equal(m->prepare(&p, t, h, y, y1, work, &stats), CT_EVAL_OK);
    for (int i = 0; i <= 20; i++) {
        m->dense(&p, h, i / 20.0, y, y1, work, out);
        *fine = fmax(*fine, distance(&r, t + h * i / 20, out));
    }
    ct_arena_destroy(arena);
}

static void interpolants_have_their_order(void **unused)
{
    (void)unused;
    static const struct {
        const char *name;
        double h, rough, fine; // powers of h
    } cases[] = {{"rk4", 0.05, 4, 4}, {"dopri5", 0.05, 5, 6}, {"dop853", 0.1, 0, 8}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct ct_method *m = ct_method_find(cases[i].name);
        double step[2], rough[2], fine[2];
        for (int k = 0; k < 2; k++)
            local_errors(m, cases[i].h / (1 + k), &step[k], &rough[k], &fine[k]);
        printf("%s: powers of the step %.2f, interpolants %.2f %.2f\n", m->name,
               log2(step[0] / step[1]), log2(rough[0] / rough[1]), log2(fine[0] / fine[1]));
        if (cases[i].rough > 0)
            check_close("rough", log2(rough[0] / rough[1]), cases[i].rough, 0.45);
        check_close("fine", log2(fine[0] / fine[1]), cases[i].fine, 0.45);
    }
}

static void errors_follow_the_tolerance(void **unused)
{
    (void)unused;
    double times[201];
    fill_even(times, 201, 20);
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        double before = INFINITY;
        for (int digits = 5; digits <= 11; digits += 2) {
            struct record *r = begin();
            double y[NY];
            kepler_exact(0, y);
            r->exact = kepler_exact;
            const double tol = pow(10, -digits);
            check_fine(r, run(r, ct_methods[m], (struct ct_problem){.ny = 4, .rhs = kepler},
                              (struct ct_integrate_options){
                                  .t1 = 20, .atol = tol, .sample = times, .nsample = 201},
                              y));
            printf("%s %g: %ld steps, %ld evaluations, error %.1e, of samples %.1e\n",
                   ct_methods[m]->name, tol, r->stats.steps, r->stats.evaluations,
                   r->worst_step, r->worst_sample);
            assert_int_equal(r->nsample, 201);
            // a hundredfold tolerance is about a hundredfold error: at least ten
            check_below("ladder", r->worst_sample, before / 10);
            // the interpolant adds nothing to what has accumulated
            check_below("samples", r->worst_sample, 1.2 * r->worst_step);
            before = r->worst_sample;
            end(r);
        }
        check_below("at 1e-11", before, 1e-7);
    }
}

static void samples_of_dopri5_are_as_good_as_steps(void **unused)
{
    (void)unused;
    double times[2001], y[NY] = {0};
    fill_even(times, 2001, 20);
    struct record *r = begin();
    r->exact = attractor_exact;
    check_fine(r,
               run(r, ct_method_find("dopri5"), (struct ct_problem){.ny = 1, .rhs = attractor},
                   (struct ct_integrate_options){
                       .t1 = 20, .atol = 1e-10, .sample = times, .nsample = 2001},
                   y));
    check_below("samples", r->worst_sample, 1.1 * r->worst_step);
    check_below("steps", r->worst_step, 1e-9); // ten tolerances
    end(r);
}

// --- samples ---------------------------------------------------------------------------------

static void a_run_of_no_length_gives_its_sample(void **unused)
{
    (void)unused;
    static const double now[] = {2};
    struct record *r = begin();
    double y[NY] = {1, 0};
    check_fine(r,
               run(r, ct_method_find("dop853"), (struct ct_problem){.ny = 2, .rhs = oscillator},
                   (struct ct_integrate_options){
                       .t0 = 2, .t1 = 2, .atol = 1e-8, .sample = now, .nsample = 1},
                   y));
    assert_int_equal(r->nsample, 1);
    assert_int_equal(r->nstep, 0);
    assert_true(r->value[0][0] == 1);
    end(r);
}

static void one_sample_at_the_end_is_the_end(void **unused)
{
    (void)unused;
    static const double last[] = {2};
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        struct record *r = begin();
        double y[NY] = {1, 0};
        check_fine(r, run(r, ct_methods[m], (struct ct_problem){.ny = 2, .rhs = oscillator},
                          (struct ct_integrate_options){
                              .t1 = 2, .atol = 1e-8, .sample = last, .nsample = 1},
                          y));
        assert_int_equal(r->nsample, 1);
        assert_memory_equal(r->value[0], y, 2 * sizeof *y);
        assert_true(r->stats.last_time == 2);
        end(r);
    }
}

static void fixed_steps_are_even_between_samples(void **unused)
{
    (void)unused;
    static const double times[] = {0, 0.25, 1};
    struct record *r = begin();
    double y[NY] = {1, 0};
    check_fine(r, run(r, ct_method_find("rk4"), (struct ct_problem){.ny = 2, .rhs = oscillator},
                      (struct ct_integrate_options){
                          .t1 = 1, .step = 0.1, .sample = times, .nsample = 3},
                      y));
    assert_int_equal(r->nstep, 3 + 8); // ceil(0.25 / 0.1) + ceil(0.75 / 0.1)
    assert_true(r->step[2] == 0.25);
    for (int i = 3; i < 11; i++)
        check_close("step", r->step[i] - r->step[i - 1], 0.75 / 8, 1e-15);
    end(r);
}

// --- what is watched, projected and allocated ------------------------------------------------

// The oscillator and the integral of a signal much faster than it.
static enum ct_eval with_quadrature(void *user, double t, const double *y, double *dy)
{
    dy[2] = sin(200 * t);
    return oscillator(user, t, y, dy);
}

static void a_quadrature_does_not_shorten_steps(void **unused)
{
    (void)unused;
    static const bool all[] = {true, true, true}, two[] = {true, true, false};
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        long steps[3];
        for (int k = 0; k < 3; k++) {
            struct record *r = begin();
            double y[NY] = {1, 0, 0};
            check_fine(r, run(r, ct_methods[m],
                              (struct ct_problem){.ny = k ? 3 : 2,
                                                  .rhs = k ? with_quadrature : oscillator,
                                                  .error_controlled = k == 1 ? two : all},
                              (struct ct_integrate_options){.t1 = 10, .atol = 1e-8}, y));
            steps[k] = r->stats.steps;
            end(r);
        }
        assert_int_equal(steps[1], steps[0]);
        assert_true(steps[2] > 3 * steps[0]);
    }
}

static void a_group_is_measured_by_its_largest_member(void **unused)
{
    (void)unused;
    static const int of[] = {0, -1, 0, 1};
    double size[2];
    const struct ct_groups g = {2, of, size};
    const double y[] = {1e-9, 2, -3, 0}, y1[] = {0, 1, 4, 0.5}, e[] = {4, 2, 8, 1};
    const struct ct_tolerance tolerance = {.rtol = 1};
    struct ct_problem p = {.ny = 4, .groups = &g};
    assert_true(fabs(ct_stepper_norm(&p, &tolerance, y, y1, e) - sqrt((1 + 1 + 4 + 4) / 4.))
                < 1e-15);
    p.groups = NULL;
    assert_true(ct_stepper_norm(&p, &tolerance, y, y1, e) > 1e9);
    // an oscillation has the size of its amplitude, not of the place that passes through zero
    static const int both[] = {0, 0};
    const struct ct_groups one = {1, both, size};
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        long steps[2];
        for (int k = 0; k < 2; k++) {
            struct record *r = begin();
            double state[NY] = {1, 0};
            check_fine(r, run(r, ct_methods[m],
                              (struct ct_problem){
                                  .ny = 2, .rhs = oscillator, .groups = k ? &one : NULL},
                              (struct ct_integrate_options){.t1 = 100, .atol = 1e-12}, state));
            steps[k] = r->stats.steps;
            end(r);
        }
        assert_true(steps[1] < steps[0]);
    }
}

// A pendulum of length 1 in gravity 1 as a point (x, y, x', y') on a circle.
static enum ct_eval point_on_circle(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    const double r2 = y[0] * y[0] + y[1] * y[1], v2 = y[2] * y[2] + y[3] * y[3];
    const double lam = (v2 - y[1]) / r2; // from x x'' + y y'' + v2 = 0
    dy[0] = y[2];
    dy[1] = y[3];
    dy[2] = -lam * y[0];
    dy[3] = -lam * y[1] - 1;
    return CT_EVAL_OK;
}

static enum ct_eval onto_circle(void *user, double t, double *y)
{
    (void)user;
    (void)t;
    const double r = hypot(y[0], y[1]);
    y[0] /= r;
    y[1] /= r;
    const double outwards = y[0] * y[2] + y[1] * y[3];
    y[2] -= outwards * y[0];
    y[3] -= outwards * y[1];
    return CT_EVAL_OK;
}

static enum ct_eval pendulum(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    dy[0] = y[1];
    dy[1] = -sin(y[0]);
    return CT_EVAL_OK;
}

static void projection_keeps_steps_and_samples_on_the_circle(void **unused)
{
    (void)unused;
    double times[101];
    fill_even(times, 101, 20);
    struct record *want = begin();
    double angle[NY] = {2, 0};
    check_fine(want, run(want, ct_method_find("dop853"),
                         (struct ct_problem){.ny = 2, .rhs = pendulum},
                         (struct ct_integrate_options){
                             .t1 = 20, .atol = 1e-13, .sample = times, .nsample = 101},
                         angle));
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        struct record *r = begin();
        double y[NY] = {sin(2), -cos(2), 0, 0};
        check_fine(
            r, run(r, ct_methods[m],
                   (struct ct_problem){.ny = 4, .rhs = point_on_circle, .project = onto_circle},
                   (struct ct_integrate_options){
                       .t1 = 20, .atol = 1e-9, .sample = times, .nsample = 101},
                   y));
        for (int i = 0; i < 101; i++) {
            const double *z = r->value[i], phi = want->value[i][0];
            check_close("length", hypot(z[0], z[1]), 1, 4 * DBL_EPSILON);
            check_close("radial speed", z[0] * z[2] + z[1] * z[3], 0, 4 * DBL_EPSILON);
            check_close(
                "angle",
                atan2(z[0] * cos(phi) + z[1] * sin(phi), z[0] * sin(phi) - z[1] * cos(phi)), 0,
                1e-6); // a thousand tolerances in 20 s
        }
        end(r);
    }
    end(want);
}

static void nothing_is_allocated_while_stepping(void **unused)
{
    (void)unused;
    double times[101];
    fill_even(times, 101, 8);
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        struct record *r = begin();
        r->limit = 0.9;
        double y[NY] = {1, 0};
        check_fine(r, run(r, ct_methods[m], bouncing,
                          (struct ct_integrate_options){
                              .t1 = 8, .atol = 1e-9, .sample = times, .nsample = 101},
                          y));
        assert_true(r->nevent > 2);
        for (int i = 1; i < r->nstep; i++)
            assert_int_equal(r->used[i], r->used[0]);
        end(r);
    }
}

// Powers of errors in step control have four digits, whatever the error and the order.
static void next_steps_are_those_of_the_pi_controller(void **unused)
{
    const double safety = 0.8, least = 0.2, most = 5;
    (void)unused;
    for (int order = 2; order <= 8; order += 3) {
        const struct ct_method method = {.error_order = order};
        struct ct_step_control c = ct_step_control_start();
        double before = 1e-4;
        c.h = 0.1;
        double error = 0.9;
        for (int i = 0; i < 28; i++, error *= 0.37) { // down to 1e-12
            const double h = c.h, beta = 0.2 / (order + 1);
            const double power = 1. / (order + 1) - 0.75 * beta;
            const double factor = safety * pow(error, -power) * pow(before, beta);
            const double wanted = h * fmin(fmax(factor, least), most);
            ct_step_control_accept(&c, &method, h, error);
            assert_true(fabs(c.h / wanted - 1) < 3e-4);
            before = fmax(error, 1e-4);
        }
        c.h = 1;
        ct_step_control_accept(&c, &method, c.h, 0);
        assert_true(c.h == most);
    }
}

// --- vibrations --------------------------------------------------------------------------------------------

static const double omega = 7;

static enum ct_eval vibration(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    dy[0] = y[1];
    dy[1] = -omega * omega * y[0];
    return CT_EVAL_OK;
}

static enum ct_eval swing(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    dy[0] = y[1];
    dy[1] = -sin(y[0]);
    return CT_EVAL_OK;
}

// (8.12): the term of the error's order of exp(i omega h) is a hundredth of what is asked. The rate
// is that of the vibration to (omega h)^2/24 at a change of accelerations by 5 %.
static void the_first_step_from_rest_is_that_of_the_motion_to_come(void **unused)
{
    (void)unused;
    static const char *const names[] = {"dopri5", "dop853"};
    for (size_t i = 0; i < COUNT(names); i++)
        for (int power = -4; power >= -10; power -= 2) {
            const double T = pow(10, power);
            const struct ct_method *m = ct_method_find(names[i]);
            const int n = m->error_order + 1;
            struct record *r = begin();
            double y[NY] = {1, 0};
            check_fine(
                r, run(r, m, (struct ct_problem){.ny = 2, .nq = 1, .nu = 1, .rhs = vibration},
                       (struct ct_integrate_options){.t1 = 1, .rtol = T, .atol = T / 100}, y));
            const double wanted = pow(T / 100 * tgamma(n + 1), 1. / n) / omega;
            check_close("first step, over that of (8.12)", r->step[0] / wanted, 1, 0.01);
            end(r);
        }
}

// ---- where stability holds steps up -------------------------------------------------------------

static double damping, turning;

static enum ct_eval spiral(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    dy[0] = -damping * y[0] - turning * y[1];
    dy[1] = turning * y[0] - damping * y[1];
    return CT_EVAL_OK;
}

// What a step of length 1 leaves of one, exp(i phase) being where its rate points to; *error (out):
// its estimate.
static double left_of_one(const struct ct_method *m, void *work, double rate, double phase,
                          double *error)
{
    const struct ct_problem p = {.ny = 2, .rhs = spiral};
    const struct ct_tolerance absolute = {0, 1};
    struct ct_integrate_stats stats = {0};
    double y[2] = {1, 0}, dy[2], y1[2], dy1[2];
    damping = -rate * cos(phase);
    turning = rate * sin(phase);
    spiral(NULL, 0, y, dy);
    m->step(&p, 0, 1, y, dy, &absolute, y1, dy1, error, work, &stats);
    return hypot(y1[0], y1[1]);
}

// Up to `stability_limit` nothing left of the imaginary axis becomes larger, and of what is damped
// a longer step has the larger estimate: not far beyond, that falls to nothing while what is left
// of an error grows.
static void stable_steps_make_nothing_larger(void **unused)
{
    (void)unused;
    const double pi = acos(-1);
    for (int i = 0; i < ct_nmethod; i++) {
        const struct ct_method *m = ct_methods[i];
        struct ct_arena *a = ct_arena_create();
        double error, most = 0, peak = 0;
        if (m->stability_limit > 0) {
            void *work = m->create(a, m, &(struct ct_problem){.ny = 2, .rhs = spiral});
            for (int k = 1; k <= 40; k++)
                for (int j = 0; j <= 40; j++)
                    most = fmax(most, left_of_one(m, work, m->stability_limit * k / 40,
                                                  pi / 2 * (1 + j / 40.), &error));
            check_below("what a stable step leaves", most, 1);
            for (most = 0; left_of_one(m, work, peak + 0.01, pi, &error), error > most;
                 peak += 0.01)
                most = error;
            printf("%s: the estimate is largest at %.2f\n", m->name, peak);
            check_close("stable", m->stability_limit / peak, 0.95, 0.05);
        }
        ct_arena_destroy(a);
    }
}

// ---- the rate of the fastest motion -------------------------------------------------------------

static double growth;

// A vibration whose rate grows by that factor from test to test.
static enum ct_eval quickening(void *user, double t, const double *y, double *dy)
{
    (void)user;
    const double rate = omega * pow(growth, t);
    dy[0] = y[1];
    dy[1] = -rate * rate * y[0];
    return CT_EVAL_OK;
}

// It is known where three tests in a row find it the same within a factor of two.
static void rates_that_change_by_more_than_twice_do_not_last(void **unused)
{
    (void)unused;
    enum { STEPS = 100, TESTS = 4 };
    const struct ct_problem p = {.ny = 2, .nq = 1, .nu = 1, .rhs = quickening};
    const double y[] = {1, 0};
    static const double growths[] = {1, 1.7, 2.4, 8};
    for (size_t i = 0; i < COUNT(growths); i++) {
        struct ct_arena *a = ct_arena_create();
        struct ct_integrate_stats stats = {0};
        struct ct_stiffness *s = ct_stiffness_create(a, &p, &stats, 1e-6, 1, 2);
        growth = growths[i];
        for (int k = 1; k <= STEPS * TESTS; k++)
            ct_stiffness_detect(s, (double)k / STEPS, y, 1e9);
        check_close("fast", s->fast / (omega * pow(growth, TESTS)), 1, 0.01);
        assert_true(isfinite(ct_stiffness_stable_step(s, ct_method_find("dop853")))
                    == (growth < 2));
        ct_arena_destroy(a);
    }
}

// A motion whose acceleration grows at the rate `growth`, with a vibration at rest.
static enum ct_eval forced(void *user, double t, const double *y, double *dy)
{
    (void)user;
    dy[0] = y[1];
    dy[1] = exp(growth * (t - 3)) - 1e4 * y[0];
    return CT_EVAL_OK;
}

// After three tests in steps of 1/100, the rate of the vibration.
static struct ct_stiffness *watch_forced(struct ct_arena *a, const struct ct_problem *p,
                                         const struct ct_integrate_stats *stats, double rate,
                                         double speed)
{
    const double y[] = {speed > 0 ? 1 : 0, speed};
    struct ct_stiffness *s = ct_stiffness_create(a, p, stats, 1e-6, 1, 2);
    growth = rate;
    for (int k = 1; k <= 300; k++)
        ct_stiffness_detect(s, 0.01 * k, y, 1e9);
    return s;
}

// Vibrations four times as fast as the motion must be resolved by any method; thirty times as fast,
// in steps near the limit of stability, are stiff.
static void vibrations_far_above_the_motion_are_stiff(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    const struct ct_integrate_stats stats = {.evaluations = 1};
    const struct ct_problem p = {.ny = 2, .nq = 1, .nu = 1, .rhs = forced};
    assert_int_equal(watch_forced(a, &p, &stats, 25, 0)->in_a_row, 0);
    assert_int_equal(watch_forced(a, &p, &stats, 3, 0)->in_a_row, 3);
    ct_arena_destroy(a);
}

// Where no output depends on speeds, vibrations some thousand times as fast as positions change
// need not be resolved; those three hundred times as fast do.
static void vibrations_without_outputs_are_far_above_the_motion(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    const struct ct_integrate_stats stats = {.evaluations = 1};
    const bool requested[] = {false};
    const struct ct_problem p
        = {.ny = 2, .nq = 1, .nu = 1, .rhs = forced, .requested_speeds = requested};
    assert_false(watch_forced(a, &p, &stats, 1, 0.3)->is_far);
    assert_true(watch_forced(a, &p, &stats, 1, 0.03)->is_far);
    ct_arena_destroy(a);
}

// A trial is made where three hundred steps to come would not pay it and three thousand would, and
// again when the steps since then took ten times its work.
static void trials_take_a_small_part_of_the_work(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    const struct ct_integrate_stats stats = {.evaluations = 1};
    const struct ct_problem p = {.ny = 2, .nq = 1, .nu = 1, .rhs = forced};
    for (int k = 0; k < 2; k++) {
        struct ct_stiffness *s = watch_forced(a, &p, &stats, 3, 0);
        const double y[] = {0, 0}, end = 4 + 0.01 * (k ? 3000 : 300);
        bool is_due = false;
        for (int i = 301; i <= 400; i++)
            is_due = ct_stiffness_detect(s, 0.01 * i, y, end);
        assert_true(is_due == (k == 1));
        s->evaluations = 6;
        ct_stiffness_postpone(s, 4, 6 * 200, &(struct ct_cost){.evaluation = 1});
        assert_in_range(s->next_trial - s->count, 1000, 4000);
    }
    ct_arena_destroy(a);
}

// Steps of a trial that grow eightfold up to 1e5 times the first one, every fourth with new
// derivatives: it measures the time per work of the long ones, in thirty steps at most.
static void trials_measure_steps_that_have_grown(void **unused)
{
    (void)unused;
    struct ct_integrate_stats stats = {0};
    struct ct_trial r
        = {.cost = {.residual = 1, .tangent = 6}, .stats = &stats, .end = INFINITY};
    double t = 0, h = 1;
    int n = 0;
    do {
        t += h;
        h = fmin(8 * h, 1e5);
        stats.evaluations += 12;
        stats.jacobians += n++ % 4 == 0;
    } while (ct_trial_step(&r, t));
    assert_in_range(n, 10, 30);
    check_close("time per work", ct_trial_time_per_work(&r), 1e5 / 13.5, 0.02 * 1e5 / 13.5);
}

// y'' = -2 d y' - rate^2 y for two masses, {rate, d} of each.
static double dying[2][2];

static enum ct_eval two_that_die(void *user, double t, const double *y, double *dy)
{
    (void)user, (void)t;
    for (int i = 0; i < 2; i++) {
        dy[i] = y[2 + i];
        dy[2 + i] = -2 * dying[i][1] * y[2 + i] - dying[i][0] * dying[i][0] * y[i];
    }
    return CT_EVAL_OK;
}

// The watch of a motion of that speed, after six tests that are a time of one apart; an event at
// that time.
static struct ct_stiffness *watch_two(struct ct_arena *a,
                                      const struct ct_integrate_stats *stats, double speed,
                                      double event)
{
    enum { STEPS = 100, TESTS = 6 };
    static const struct ct_problem p = {.ny = 4, .nq = 2, .nu = 2, .rhs = two_that_die};
    const double y[] = {1, 1, speed, 0};
    struct ct_stiffness *s = ct_stiffness_create(a, &p, stats, 1e-6, 2, 4);
    s->excited = -INFINITY;
    for (int k = 1; k <= STEPS * TESTS; k++) {
        if ((double)k / STEPS > event)
            s->excited = event;
        ct_stiffness_detect(s, (double)k / STEPS, y, 1e9);
    }
    return s;
}

// Against the roots of z^2 + 2 d z + rate^2, of which the watch finds the one of the larger size.
static void the_rate_at_which_the_fastest_motion_dies_is_found(void **unused)
{
    (void)unused;
    static const double of[][2]
        = {{1e3, 0}, {1e3, 2}, {1e3, 300}, {1e3, 900}, {1e3, 5e3}, {1e3, -2}};
    for (size_t i = 0; i < COUNT(of); i++) {
        struct ct_arena *a = ct_arena_create();
        const struct ct_integrate_stats stats = {0};
        const double rate = of[i][0], d = of[i][1];
        memcpy(dying, (double[2][2]){{rate, d}, {1, 0.1}}, sizeof dying);
        const struct ct_stiffness *s = watch_two(a, &stats, 0, INFINITY);
        const double want = d > rate ? d + sqrt(d * d - rate * rate) : d;
        check_close("decay", s->decay, want, 1e-3 * fmax(fabs(want), 1));
        assert_true(s->has_decayed == (6 * want > log(1e6)));
        ct_arena_destroy(a);
    }
}

// Two of about one rate are not one motion: what dies of them is not told from what they make
// together.
static void several_fastest_motions_are_not_taken_to_die(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    const struct ct_integrate_stats stats = {0};
    memcpy(dying, (double[2][2]){{1000, 200}, {1000.5, 0}}, sizeof dying);
    assert_false(watch_two(a, &stats, 0, INFINITY)->has_decayed);
    ct_arena_destroy(a);
}

// Nor is what a motion changes by as it goes on.
static void what_dies_at_the_pace_of_the_motion_is_not_dead(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    const struct ct_integrate_stats stats = {0};
    memcpy(dying, (double[2][2]){{1e3, 50}, {1, 0.1}}, sizeof dying);
    assert_true(watch_two(a, &stats, 25, INFINITY)->has_decayed);
    assert_false(watch_two(a, &stats, 75, INFINITY)->has_decayed);
    ct_arena_destroy(a);
}

static void what_an_event_excites_has_to_die_again(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    const struct ct_integrate_stats stats = {0};
    memcpy(dying, (double[2][2]){{1e3, 5}, {1, 0.1}}, sizeof dying);
    assert_true(watch_two(a, &stats, 0, INFINITY)->has_decayed);
    const struct ct_stiffness *s = watch_two(a, &stats, 0, 4.5);
    check_close("integrated_decay", s->integrated_decay, 1.5 * 5, 0.1);
    assert_false(s->has_decayed);
    ct_arena_destroy(a);
}

// ---- samples between steps ----------------------------------------------------------------------

// What it takes to see that the interpolant holds is next to nothing.
static void samples_of_what_steps_follow_cost_no_steps_of_their_own(void **unused)
{
    (void)unused;
    enum { SAMPLES = 1000 };
    static double time[SAMPLES];
    const struct ct_problem p = {.ny = 2, .nq = 1, .nu = 1, .rhs = swing};
    const double to_interpolate = 3;
    long evaluations[2], steps = 0;
    for (int i = 0; i < SAMPLES; i++)
        time[i] = 0.1 * (i + 1);
    for (int k = 0; k < 2; k++) {
        struct record *r = begin();
        double y[NY] = {2, 0};
        check_fine(r, run(r, ct_method_find("dop853"), p,
                          (struct ct_integrate_options){.t1 = time[SAMPLES - 1],
                                                        .atol = 1e-6,
                                                        .sample = time,
                                                        .nsample = k ? SAMPLES : 0},
                          y));
        evaluations[k] = r->stats.evaluations;
        steps = r->stats.steps;
        end(r);
    }
    printf("%ld steps, %ld and %ld evaluations\n", steps, evaluations[0], evaluations[1]);
    check_below("evaluations for samples, of each step",
                (double)(evaluations[1] - evaluations[0]) / (double)steps,
                1.05 * to_interpolate);
}

// Drawn fast to a speed of one and something that fades or swells: the interpolant errs by ever
// less or more of what is asked for.
static const double draws = 1e3;
static double swells, part; // [1/s], of the speed at the start

static enum ct_eval drawn(void *user, double t, const double *y, double *dy)
{
    (void)user;
    dy[0] = y[1];
    dy[1] = -draws * (y[1] - 1 - part * exp(swells * t));
    return CT_EVAL_OK;
}

static void drawn_exact(double t, double *y)
{
    const double left = part * draws / (draws + swells);
    y[0] = t + left * expm1(swells * t) / swells;
    y[1] = 1 + left * exp(swells * t);
}

static double damping_step(void *user)
{
    (void)user;
    return 4 / draws;
}

// What each sample costs; *error: of the worst, of what is asked for.
static double cost_of_samples(double *error)
{
    enum { SAMPLES = 1000 };
    static double time[SAMPLES];
    const struct ct_problem p
        = {.ny = 2, .nq = 1, .nu = 1, .rhs = drawn, .longest_step = damping_step};
    const double asked = 1e-9;
    long evaluations[2];
    for (int i = 0; i < SAMPLES; i++)
        time[i] = 0.02 * (i + 0.5);
    for (int k = 0; k < 2; k++) {
        struct record *r = begin();
        double y[NY];
        drawn_exact(0, y);
        r->exact = drawn_exact;
        check_fine(r,
                   run(r, ct_method_find("dop853"), p,
                       (struct ct_integrate_options){
                           .t1 = 20, .atol = asked, .sample = time, .nsample = k ? SAMPLES : 0},
                       y));
        evaluations[k] = r->stats.evaluations;
        *error = r->worst_sample / asked;
        end(r);
    }
    printf("%ld and %ld evaluations, error %.3g\n", evaluations[0], evaluations[1], *error);
    return (double)(evaluations[1] - evaluations[0]) / SAMPLES;
}

// Whether it does is asked seldom, but soon enough: of what fades few samples have steps of their
// own, and what swells is seen in time.
static void samples_cost_steps_of_their_own_while_the_interpolant_errs(void **unused)
{
    (void)unused;
    const double to_interpolate = 3, step = 12;
    double error;
    swells = -1;
    part = 1;
    check_below("evaluations for samples of what fades", cost_of_samples(&error),
                to_interpolate + 0.2 * step);
    swells = 1;
    part = 1e-9;
    cost_of_samples(&error);
    check_below("error of samples of what swells", error, 1);
}

// Of a motion that is none, too: accelerations have changed by so little where the rate is found
// that it is the one at the start.
static void the_rate_from_rest_is_that_of_the_start(void **unused)
{
    (void)unused;
    const struct ct_method *m = ct_method_find("dop853");
    const double T = 1e-6, from = 1.2;
    const int n = m->error_order + 1;
    struct record *r = begin();
    double y[NY] = {from, 0};
    check_fine(r, run(r, m, (struct ct_problem){.ny = 2, .nq = 1, .nu = 1, .rhs = swing},
                      (struct ct_integrate_options){.t1 = 10, .rtol = T, .atol = T / 100}, y));
    const double wanted = pow(T / 100 * tgamma(n + 1), 1. / n) / sqrt(cos(from));
    printf("first step %.4f of that of the pendulum\n", r->step[0] / wanted);
    check_close("first step, over that of (8.12)", r->step[0] / wanted, 1, 0.12);
    end(r);
}

// (8.14): the errors of all steps of that length come to T at the end, each in the same direction
// of phase.
static void followed_steps_err_by_the_tolerance_at_the_end(void **unused)
{
    (void)unused;
    const double time = 100;
    for (int power = -4; power >= -8; power -= 2) {
        const double T = pow(10, power);
        const struct ct_method *m = ct_method_find("dop853");
        const double steps = ceil(time / ct_stiffness_accurate_step(m, omega, time, T));
        double y[NY] = {1, 0};
        struct record *r = begin();
        r->stop_after = 0;
        check_fine(r,
                   run(r, m, (struct ct_problem){.ny = 2, .nq = 1, .nu = 1, .rhs = vibration},
                       (struct ct_integrate_options){.t1 = time, .step = time / steps}, y));
        const double error = hypot(y[0] - cos(omega * time), y[1] / omega + sin(omega * time));
        check_close("error at the end, over T", error / T, 1, 0.3);
        end(r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(next_steps_are_those_of_the_pi_controller),
        cmocka_unit_test(stable_steps_make_nothing_larger),
        cmocka_unit_test(the_rate_from_rest_is_that_of_the_start),
        cmocka_unit_test(rates_that_change_by_more_than_twice_do_not_last),
        cmocka_unit_test(vibrations_far_above_the_motion_are_stiff),
        cmocka_unit_test(vibrations_without_outputs_are_far_above_the_motion),
        cmocka_unit_test(trials_take_a_small_part_of_the_work),
        cmocka_unit_test(trials_measure_steps_that_have_grown),
        cmocka_unit_test(the_rate_at_which_the_fastest_motion_dies_is_found),
        cmocka_unit_test(several_fastest_motions_are_not_taken_to_die),
        cmocka_unit_test(what_dies_at_the_pace_of_the_motion_is_not_dead),
        cmocka_unit_test(what_an_event_excites_has_to_die_again),
        cmocka_unit_test(samples_of_what_steps_follow_cost_no_steps_of_their_own),
        cmocka_unit_test(samples_cost_steps_of_their_own_while_the_interpolant_errs),
        cmocka_unit_test(methods_are_found_by_name),
        cmocka_unit_test(halving_a_fixed_step_shows_the_order),
        cmocka_unit_test(roundings_of_many_steps_do_not_add_up),
        cmocka_unit_test(the_table_of_dop853_fulfils_conditions_below_rounding),
        cmocka_unit_test(a_million_steps_keep_the_energy),
        cmocka_unit_test(interpolants_have_their_order),
        cmocka_unit_test(errors_follow_the_tolerance),
        cmocka_unit_test(samples_of_dopri5_are_as_good_as_steps),
        cmocka_unit_test(a_run_of_no_length_gives_its_sample),
        cmocka_unit_test(one_sample_at_the_end_is_the_end),
        cmocka_unit_test(fixed_steps_are_even_between_samples),
        cmocka_unit_test(a_quadrature_does_not_shorten_steps),
        cmocka_unit_test(a_group_is_measured_by_its_largest_member),
        cmocka_unit_test(projection_keeps_steps_and_samples_on_the_circle),
        cmocka_unit_test(nothing_is_allocated_while_stepping),
        cmocka_unit_test(the_first_step_from_rest_is_that_of_the_motion_to_come),
        cmocka_unit_test(followed_steps_err_by_the_tolerance_at_the_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
