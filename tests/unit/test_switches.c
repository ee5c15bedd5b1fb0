// Places where expressions switch along a symbol.
#include "expr/switches.h"
#include "tests/check.h"

enum { MOST = 20 };

struct fixture {
    struct ct_arena *a;
    struct ct_exs x;
    ct_ex s, p;
};

static void begin(struct fixture *f)
{
    f->a = ct_arena_create();
    ct_exs_init(&f->x, f->a);
    f->p = ct_ex_sym(&f->x, CT_SYM_PARAM, "p", 0);
    f->s = ct_ex_sym(&f->x, CT_SYM_LOCAL, "s", 0);
}

static void check_places(struct fixture *f, ct_ex e, const double *want, int n)
{
    double value[] = {1.3, 0}, place[MOST];
    assert_int_equal(ct_ex_switches(&f->x, f->a, e, f->s, 0, 3, value, place, MOST), n);
    for (int i = 0; i < n; i++)
        CHECK_CLOSE(place[i], want[i], 1e-13, 0);
}

static void a_place_may_depend_on_parameters(void **unused)
{
    (void)unused;
    struct fixture f;
    begin(&f);
    struct ct_exs *x = &f.x;
    const ct_ex below = ct_ex_fun2(x, CT_OP_LT, f.s, f.p);
    check_places(&f, ct_ex_if(x, below, CT_EX_ONE, f.s), (const double[]){1.3}, 1);
    check_places(&f, ct_ex_fun(x, CT_OP_ABS, ct_ex_sub(x, ct_ex_scale(x, 2, f.s), f.p)),
                 (const double[]){0.65}, 1);
    check_places(&f, ct_ex_mul(x, f.s, f.p), NULL, 0);
    ct_arena_destroy(f.a);
}

static void all_roots_are_found_in_order(void **unused)
{
    (void)unused;
    const double pi = 3.14159265358979323846;
    struct fixture f;
    begin(&f);
    struct ct_exs *x = &f.x;
    // sign(sin(4 s)) and, nested, min(s, 2) > 1.5; x^2 < 1.69; a double root is a place too
    const ct_ex wave
        = ct_ex_fun(x, CT_OP_SIGN, ct_ex_fun(x, CT_OP_SIN, ct_ex_scale(x, 4, f.s)));
    check_places(&f, wave, (const double[]){pi / 4, pi / 2, 3 * pi / 4}, 3);
    const ct_ex capped = ct_ex_fun2(x, CT_OP_MIN, f.s, ct_ex_const(x, 2));
    check_places(&f, ct_ex_fun2(x, CT_OP_GT, capped, ct_ex_const(x, 1.5)),
                 (const double[]){1.5, 2}, 2);
    const ct_ex square = ct_ex_mul(x, f.s, f.s);
    check_places(&f, ct_ex_fun2(x, CT_OP_LE, square, ct_ex_const(x, 1.69)),
                 (const double[]){1.3}, 1);
    const ct_ex off = ct_ex_sub(x, f.s, CT_EX_ONE);
    check_places(&f, ct_ex_fun(x, CT_OP_ABS, ct_ex_pow(x, off, ct_ex_const(x, 2))),
                 (const double[]){1}, 1);
    ct_arena_destroy(f.a);
}

static void ends_and_equal_places_count_once_or_not(void **unused)
{
    (void)unused;
    struct fixture f;
    begin(&f);
    struct ct_exs *x = &f.x;
    const ct_ex at_end = ct_ex_fun2(x, CT_OP_MAX, f.s, ct_ex_const(x, 3 - 1e-12));
    check_places(&f, at_end, NULL, 0);
    const ct_ex twice = ct_ex_add(x, ct_ex_fun2(x, CT_OP_LT, f.s, f.p),
                                  ct_ex_fun(x, CT_OP_SIGN, ct_ex_sub(x, f.s, f.p)));
    check_places(&f, twice, (const double[]){1.3}, 1);
    // 0 all along (0, 1): nothing switches there
    const ct_ex flat = ct_ex_sub(x, ct_ex_fun2(x, CT_OP_MAX, f.s, CT_EX_ONE), CT_EX_ONE);
    check_places(&f, ct_ex_fun(x, CT_OP_SIGN, flat), (const double[]){1}, 1);
    ct_arena_destroy(f.a);
}

// Up to a thousand millionth of the whole apart, and no more.
static void places_that_are_close_are_one(void **unused)
{
    (void)unused;
    struct fixture f;
    begin(&f);
    struct ct_exs *x = &f.x;
    const ct_ex first = ct_ex_fun2(x, CT_OP_LT, f.s, CT_EX_ONE);
    const ct_ex close = ct_ex_fun2(x, CT_OP_LT, f.s, ct_ex_const(x, 1 + 3 * 0.5e-9)),
                apart = ct_ex_fun2(x, CT_OP_LT, f.s, ct_ex_const(x, 1 + 3 * 2e-9));
    check_places(&f, ct_ex_add(x, first, close), (const double[]){1}, 1);
    check_places(&f, ct_ex_add(x, first, apart), (const double[]){1, 1 + 3 * 2e-9}, 2);
    ct_arena_destroy(f.a);
}

static void too_many_are_said(void **unused)
{
    (void)unused;
    struct fixture f;
    begin(&f);
    struct ct_exs *x = &f.x;
    double value[] = {1.3, 0}, place[MOST];
    const ct_ex comb
        = ct_ex_fun(x, CT_OP_SIGN, ct_ex_fun(x, CT_OP_SIN, ct_ex_scale(x, 1e3, f.s)));
    assert_int_equal(ct_ex_switches(x, f.a, comb, f.s, 0, 3, value, place, MOST), -1);
    const ct_ex unknown = ct_ex_fun(x, CT_OP_ABS, ct_ex_fun(x, CT_OP_TAN, f.s)); // not enclosed
    assert_int_equal(ct_ex_switches(x, f.a, unknown, f.s, 0, 3, value, place, MOST), -1);
    ct_arena_destroy(f.a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_place_may_depend_on_parameters),
        cmocka_unit_test(all_roots_are_found_in_order),
        cmocka_unit_test(ends_and_equal_places_count_once_or_not),
        cmocka_unit_test(places_that_are_close_are_one),
        cmocka_unit_test(too_many_are_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
