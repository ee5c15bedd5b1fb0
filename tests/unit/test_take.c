// What is taken over runs from functions in closed form: extremes, means, zeros; kinks and jumps
// inside of steps.
#include "integrate/take.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { MOST = 8 };
typedef void functions(double t, double *f);

// Steps as long as 1/n of T over [0, T]; returns the number of points that were asked for.
static long scan(const enum ct_take_kind *kind, size_t n, functions *f, double T, int steps,
                 double rtol, double *out)
{
    struct ct_arena *a = ct_arena_create();
    struct ct_take_scan *s = ct_take_scan_create(a, kind, n);
    long asked = 0;
    ct_take_scan_begin(s, rtol, 0);
    for (int i = 0; i < steps; i++) {
        double t, v[MOST];
        ct_take_scan_step(s, T * i / steps, T * (i + 1) / steps);
        for (; ct_take_scan_wants(s, &t); asked++) {
            assert_true(t >= T * i / steps && t <= T * (i + 1) / steps);
            f(t, v);
            ct_take_scan_give(s, v);
        }
    }
    f(T, out);
    ct_take_scan_results(s, out);
    ct_arena_destroy(a);
    return asked;
}

static void close_to(double got, double want, double error)
{
    if (!(fabs(got - want) <= error))
        fail_msg("%.17g, not %.17g: off by %.3g", got, want, fabs(got - want));
}

static void wave(double t, double *f)
{
    for (int i = 0; i < 6; i++)
        f[i] = sin(t);
    f[6] = -1 - sin(t); // touches zero from below
    f[7] = cos(3 * t);
}

static void extremes_means_and_zeros_are_those_of_the_function(void **unused)
{
    (void)unused;
    static const enum ct_take_kind kind[MOST]
        = {CT_TAKE_MAX,  CT_TAKE_MIN,   CT_TAKE_MEAN, CT_TAKE_RMS,
           CT_TAKE_TIME, CT_TAKE_FINAL, CT_TAKE_MAX,  CT_TAKE_TIME};
    const double T = 20;
    double got[MOST];
    for (int steps = 3; steps < 200; steps *= 3) {
        scan(kind, MOST, wave, T, steps, 1e-9, got);
        close_to(got[0], 1, 1e-10);
        close_to(got[1], -1, 1e-10);
        close_to(got[2], (1 - cos(T)) / T, 1e-10);
        close_to(got[3], sqrt(0.5 - sin(2 * T) / 4 / T), 1e-10);
        close_to(got[4], 2 * acos(-1), 1e-9);
        close_to(got[5], sin(T), 0);
        close_to(got[6], 0, 1e-10);
        close_to(got[7], acos(-1) / 2, 1e-9);
    }
}

static void rough(double t, double *f)
{
    f[0] = f[1] = fabs(t - 1 / 3.);    // a kink
    f[2] = f[3] = t > 2 / 3. ? 2 : -1; // a jump
    f[4] = t * t - 1e-3 * (t > 0.5);
}

static void kinks_and_jumps_in_steps_are_found(void **unused)
{
    (void)unused;
    static const enum ct_take_kind kind[]
        = {CT_TAKE_MIN, CT_TAKE_MEAN, CT_TAKE_TIME, CT_TAKE_MEAN, CT_TAKE_MAX};
    double got[5];
    const long asked = scan(kind, 5, rough, 1, 1, 1e-9, got);
    close_to(got[0], 0, 1e-9);
    close_to(got[1], 1 / 18. + 2 / 9., 1e-10);
    close_to(got[2], 2 / 3., 1e-15);
    close_to(got[3], 0, 1e-9);
    close_to(got[4], 0.999, 1e-10);
    assert_true(asked < 2500);
}

// Interpolants of noise never hold.
static void noise(double t, double *f)
{
    uint64_t z = (uint64_t)(t * 0x1p53) * 0x9e3779b97f4a7c15u;
    z ^= z >> 29;
    z *= 0xbf58476d1ce4e5b9u;
    f[0] = f[1] = (double)(z >> 11) / 0x1p53;
}

static void noise_takes_a_bounded_number_of_points(void **unused)
{
    (void)unused;
    static const enum ct_take_kind kind[] = {CT_TAKE_MAX, CT_TAKE_MEAN};
    double got[2];
    const long asked = scan(kind, 2, noise, 1, 1, 1e-9, got);
    assert_true(asked < 9 * 500);
    assert_true(got[0] > 0.9 && got[0] < 2 && got[1] > 0.3 && got[1] < 0.7);
}

static void smooth(double t, double *f)
{
    f[0] = sin(t);
}

static void where_nothing_can_be_five_points_are_enough(void **unused)
{
    (void)unused;
    static const enum ct_take_kind most[] = {CT_TAKE_MAX};
    double got;
    const int steps = 400;
    const long asked = scan(most, 1, smooth, 20, steps, 1e-9, &got);
    assert_true(asked < 6.5 * steps); // 9 near the tops
    close_to(got, 1, 1e-10);
}

static void a_run_of_no_length_has_what_it_ends_with(void **unused)
{
    (void)unused;
    static const enum ct_take_kind kind[]
        = {CT_TAKE_MAX, CT_TAKE_MEAN, CT_TAKE_RMS, CT_TAKE_TIME};
    double out[] = {-2, -2, -2, -2};
    struct ct_arena *a = ct_arena_create();
    struct ct_take_scan *s = ct_take_scan_create(a, kind, 4);
    ct_take_scan_begin(s, 1e-9, 0);
    ct_take_scan_results(s, out);
    assert_true(out[0] == -2 && out[1] == -2 && out[2] == 2 && isnan(out[3]));
    ct_arena_destroy(a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(extremes_means_and_zeros_are_those_of_the_function),
        cmocka_unit_test(kinks_and_jumps_in_steps_are_found),
        cmocka_unit_test(noise_takes_a_bounded_number_of_points),
        cmocka_unit_test(where_nothing_can_be_five_points_are_enough),
        cmocka_unit_test(a_run_of_no_length_has_what_it_ends_with),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
