// Naming shared subexpressions.
#include "expr/print.h"
#include "expr/share.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

struct fixture {
    struct ct_arena *arena;
    struct ct_exs x;
    ct_ex t1, l, q, r;
};

static void start(struct fixture *f)
{
    f->arena = ct_arena_create();
    ct_exs_init(&f->x, f->arena);
    f->t1 = ct_ex_sym(&f->x, CT_SYM_PARAM, "t1", 0);
    f->l = ct_ex_sym(&f->x, CT_SYM_PARAM, "length", 1);
    f->q = ct_ex_sym(&f->x, CT_SYM_Q, "crank.q", 0);
    f->r = ct_ex_sym(&f->x, CT_SYM_Q, "rod.q", 1);
}

// l cos(q) + t1 sin(q + r)
static ct_ex reach(struct fixture *f)
{
    struct ct_exs *x = &f->x;
    ct_ex both = ct_ex_fun(x, CT_OP_SIN, ct_ex_add(x, f->q, f->r));
    return ct_ex_add(x, ct_ex_mul(x, f->l, ct_ex_fun(x, CT_OP_COS, f->q)),
                     ct_ex_mul(x, f->t1, both));
}

static const struct ct_share_options all = {.enough = 1};

static void repeated_sum_gets_a_name_no_symbol_has(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    ct_ex p = reach(&f), e = ct_ex_mul(x, ct_ex_mul(x, p, p), ct_ex_fun(x, CT_OP_EXP, p));
    struct ct_share s = ct_ex_share(f.arena, x, &e, 1, &all);
    const struct ct_print print = {.node = ct_share_name, .data = &s};
    assert_int_equal(s.n, 1);
    assert_string_equal(s.at[0].name, "t2"); // t1 is a parameter
    assert_string_equal(ct_ex_text_body(f.arena, x, s.at[0].e, &print),
                        "t1*sin(crank.q + rod.q) + length*cos(crank.q)");
    assert_string_equal(ct_ex_text(f.arena, x, e, &print), "t2^2*exp(t2)");
    ct_arena_destroy(f.arena);
}

static void a_label_is_the_name(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    ct_ex p = reach(&f), e = ct_ex_mul(&f.x, ct_ex_mul(&f.x, p, p), p);
    ct_ex_label(&f.x, p, "tip.x");
    struct ct_share s = ct_ex_share(f.arena, &f.x, &e, 1, &all);
    const struct ct_print print = {.node = ct_share_name, .data = &s};
    assert_int_equal(s.n, 1);
    assert_string_equal(ct_ex_text(f.arena, &f.x, e, &print), "tip.x^3");
    ct_arena_destroy(f.arena);
}

static void small_and_trivial_stay(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    ct_ex p = reach(&f), e = ct_ex_mul(x, p, p), sum = CT_EX_ZERO;
    assert_int_equal(ct_ex_share(f.arena, x, &e, 1, NULL).n, 0); // fits the screen as it is
    for (int k = 1; k < 50; k++)
        sum = ct_ex_add(x, ct_ex_fun(x, CT_OP_SIN, sum),
                        ct_ex_scale(x, k, ct_ex_fun(x, CT_OP_SIN, f.q)));
    struct ct_share s = ct_ex_share(f.arena, x, &sum, 1, &all);
    assert_int_equal(s.n, 0); // sin(q) many times, but nothing else twice
    ct_arena_destroy(f.arena);
}

// A tree of 2^60 leaves becomes a screen of definitions, each of them used.
static void an_endless_tree_fits_a_screen(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    ct_ex e = f.q;
    for (int k = 0; k < 60; k++)
        e = ct_ex_add(x, ct_ex_fun(x, CT_OP_EXP, e), ct_ex_mul(x, f.l, e));
    struct ct_share s = ct_ex_share(f.arena, x, &e, 1, NULL);
    const struct ct_print print = {.node = ct_share_name, .data = &s};
    char *lines = ct_arena_strdup(f.arena, ct_ex_text(f.arena, x, e, &print));
    for (size_t k = s.n; k-- > 0;) {
        // what a definition uses comes before it
        assert_non_null(strstr(lines, s.at[k].name));
        lines = ct_arena_printf(f.arena, "%s = %s\n%s", s.at[k].name,
                                ct_ex_text_body(f.arena, x, s.at[k].e, &print), lines);
    }
    assert_true(strlen(lines) < 4000);
    ct_arena_destroy(f.arena);
}

// A recursion of 2000 named steps, each used twice: more paths than a double counts, and a line a
// step.
static void names_come_first_where_they_are_asked_for(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    ct_ex e = f.q;
    for (int k = 0; k < 2000; k++) {
        e = ct_ex_add(x, ct_ex_fun(x, CT_OP_SIN, e), ct_ex_mul(x, f.l, e));
        ct_ex_label(x, e, ct_arena_printf(f.arena, "a_%d", k));
    }
    const struct ct_share_options o = {.most = SIZE_MAX, .names_first = true};
    const struct ct_share s = ct_ex_share(f.arena, x, &e, 1, &o);
    assert_int_equal(s.n, 1999); // the last one is the expression itself
    assert_string_equal(s.at[0].name, "a_0");
    assert_true(s.size > 2000 * 20 && s.size < 2000 * 50);
    ct_arena_destroy(f.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(repeated_sum_gets_a_name_no_symbol_has),
        cmocka_unit_test(a_label_is_the_name),
        cmocka_unit_test(small_and_trivial_stay),
        cmocka_unit_test(an_endless_tree_fits_a_screen),
        cmocka_unit_test(names_come_first_where_they_are_asked_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
