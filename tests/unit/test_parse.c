// Expressions as written: values, precedence, places of mistakes.
#include "expr/parse.h"
#include "tests/check.h"

#include <stdlib.h>
#include <string.h>

struct bench {
    struct ct_ctx ctx;
    struct ct_exs x;
    ct_ex t, a, b;
};

static int create(void **state)
{
    struct bench *s = calloc(1, sizeof *s);
    *state = s;
    if (!s || !(s->ctx.model = ct_arena_create()) || !(s->ctx.scratch = ct_arena_create()))
        return -1;
    ct_exs_init(&s->x, s->ctx.model);
    s->t = ct_ex_sym(&s->x, CT_SYM_TIME, "t", 0);
    s->a = ct_ex_sym(&s->x, CT_SYM_PARAM, "a", 0);
    s->b = ct_ex_sym(&s->x, CT_SYM_PARAM, "b", 1);
    return 0;
}

static int destroy(void **state)
{
    struct bench *s = *state;
    ct_arena_destroy(s->ctx.model);
    ct_arena_destroy(s->ctx.scratch);
    free(s);
    return 0;
}

static enum ct_name_result find_name(void *user, const char *name, ct_ex *e, const char **why)
{
    struct bench *s = user;
    (void)why;
    *e = name[0] == 'a' ? s->a : name[0] == 'b' ? s->b : s->t;
    return strlen(name) == 1 && strchr("abt", name[0]) ? CT_NAME_OK : CT_NAME_UNKNOWN;
}

static enum ct_name_result find_signal(void *user, const char *text, const char *first,
                                       const char *in, struct ct_mark where,
                                       struct ct_mark where_in, ct_ex *e, const char **why)
{
    struct bench *s = user;
    (void)why;
    assert_int_equal(strncmp(text, first, strlen(first)), 0);
    assert_true(!in || where_in.column > where.column);
    *e = ct_ex_sym(&s->x, CT_SYM_SIGNAL, text, 0);
    return CT_NAME_OK;
}

static bool parse_unit(struct bench *s, const char *text, const char *unit, ct_ex *e)
{
    static const char *const known[] = {"t", "a", "b"};
    const struct ct_scope scope = {.x = &s->x,
                                   .user = s,
                                   .name = find_name,
                                   .signal = find_signal,
                                   .known = known,
                                   .nknown = COUNT(known),
                                   .unit = unit};
    const struct ct_text at = {text, {"model", 0, 0}, true, 0};
    return ct_parse(&s->ctx, &scope, at, e);
}

static bool parse(struct bench *s, const char *text, ct_ex *e)
{
    return parse_unit(s, text, NULL, e);
}

// with t = 2, a = 3, b = 5
static void expressions_have_the_values_of_the_grammar(void **state)
{
    static const struct {
        const char *text;
        double value;
    } cases[] = {
        {"-2^2", -4},
        {"2^3^2", 512},
        {"2^-1", 0.5},
        {"-a^2", -9},
        {"2 - 3 - 4", -5},
        {"24 / 4 / 2", 3},
        {"2*-3", -6},
        {"--a", 3},
        {"+3", 3},
        {"1 - -1", 2},
        {"(a + b)*t", 16},
        {"a < b", 1},
        {"a >= b", 0},
        {"a <= 3", 1},
        {"a > 3", 0},
        {"a == 3", 1},
        {"2 < 1 + 3", 1},
        {"(a < b) + 1", 2},
        {"if(t < 1, a, b)", 5},
        {"if(t >= 2, a, b)", 3},
        {"min(a, b, t)", 2},
        {"max(a, b)", 5},
        {"abs(-a)", 3},
        {"sign(0*a)", 0},
        {"sign(-b)", -1},
        {"atan2(a - 2, -1)", 2.3561944901923448},
        {"sqrt(a^2 + 16)", 5},
        {"exp(log(b))", 5},
        {"sin(pi/2)", 1},
        {"asin(1) - acos(0)", 0},
        {"atan(1)*4 - pi", 0},
        {"cosh(a)^2 - sinh(a)^2", 1},
        {"tanh(0) + tan(0) + cos(0)", 1},
        {"1e-4", 1e-4},
        {" .5 ", 0.5},
        {"152 mm", 0.152},
        {"-30 deg", -0.52359877559829882},
        {"7e10Pa", 7e10},
        {"5 1/s", 5},
    };
    struct bench *s = *state;
    const double value[] = {2, 3, 5};
    for (size_t i = 0; i < COUNT(cases); i++) {
        ct_ex e;
        print_message("%s\n", cases[i].text);
        assert_true(parse(s, cases[i].text, &e));
        // some operations, each correct to an ulp or two
        CHECK_CLOSE(ct_ex_value(&s->x, e, value), cases[i].value, 1e-14, 1e-13);
    }
}

static void mistakes_are_shown_at_their_character(void **state)
{
    static const struct {
        const char *text;
        enum ct_code code;
        int column;
    } cases[] = {
        {"1 +", CT_E_SYNTAX, 3},          {"a $ b", CT_E_SYNTAX, 2},
        {"a + c", CT_E_NAME_UNKNOWN, 4},  {"sin(a", CT_E_SYNTAX, 5},
        {"a < b < 1", CT_E_SYNTAX, 6},    {"2*(a", CT_E_SYNTAX, 4},
        {"2*sinn(a)", CT_E_FUNCTION, 2},  {"", CT_E_SYNTAX, 0},
        {"\xc3\xa9 + $", CT_E_SYNTAX, 0}, {"3 kgs", CT_E_UNIT, 0},
        {"1e999", CT_E_NUMBER, 0},        {"a 3", CT_E_SYNTAX, 2},
        {"a**b", CT_E_SYNTAX, 2},         {"x.", CT_E_SYNTAX, 2},
        {".inf", CT_E_NUMBER, 0},
    };
    struct bench *s = *state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        ct_ex e;
        s->ctx.ndiagnostic = 0;
        print_message("%s\n", cases[i].text);
        assert_false(parse(s, cases[i].text, &e));
        assert_int_equal(s->ctx.diagnostic[0].code, cases[i].code);
        assert_int_equal(s->ctx.diagnostic[0].mark.column, cases[i].column);
    }
}

static void all_unknown_names_of_one_expression_are_reported(void **state)
{
    struct bench *s = *state;
    ct_ex e;
    assert_false(parse(s, "foo + bar*sin(baz)", &e));
    assert_int_equal(s->ctx.nerror, 3);
}

static void signals_keep_their_text_in_normal_form(void **state)
{
    struct bench *s = *state;
    ct_ex e;
    assert_true(parse(s, "rod.tip.velocity.x   in  rod.tip", &e));
    assert_string_equal(ct_ex_symbol(&s->x, e)->name, "rod.tip.velocity.x in rod.tip");
    assert_true(parse(s, "body.quaternion.0", &e));
    assert_string_equal(ct_ex_symbol(&s->x, e)->name, "body.quaternion.0");
    assert_true(parse(s, "-2*pin.q^2 + inner.q", &e));

    const char *normal;
    assert_true(ct_parse_is_signal(s->ctx.model, " a.q  in b ", &normal));
    assert_string_equal(normal, "a.q in b");
    assert_false(ct_parse_is_signal(s->ctx.model, "a", &normal));
    assert_false(ct_parse_is_signal(s->ctx.model, "2*a.q", &normal));
    assert_false(ct_parse_is_signal(s->ctx.model, "a.q in ", &normal));
    assert_false(ct_parse_is_signal(s->ctx.model, "a.q + b.q", &normal));
}

static void dimensions_are_checked_against_the_wanted_one(void **state)
{
    static const struct {
        const char *text, *unit;
        bool fits;
    } cases[] = {
        {"3 mm", "m", true},
        {"3 kg", "m", false},
        {"3 deg", "m", false},
        {"3 deg", "rad", true},
        {"3 deg", "", true},
        {"3 kg", "", false},
        {"3 N*m", "N*m/rad", true},
        {"3 N*m/rad", "N*m", true},
        {"3 N/m", "N*m/rad", false},
        {"3 rpm", "rad/s", true},
        {"3", "m", true},
        {"2*a", "m", true},
        {"3 J", "N*m", true},
        {"1 kN*s/mm", "N*s/m", true},
    };
    struct bench *s = *state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        ct_ex e;
        s->ctx.ndiagnostic = 0;
        print_message("%s as %s\n", cases[i].text, cases[i].unit);
        assert_int_equal(parse_unit(s, cases[i].text, cases[i].unit, &e), cases[i].fits);
        if (!cases[i].fits)
            assert_int_equal(s->ctx.diagnostic[0].code, CT_E_DIMENSION);
    }
}

static void nesting_and_length_are_bounded(void **state)
{
    struct bench *s = *state;
    enum { N = 20000 };
    char *text = ct_arena_alloc(s->ctx.model, N + 1);
    ct_ex e;
    const char fill[] = {'(', '-', '1', '^'};
    for (size_t i = 0; i < sizeof fill; i++)
        for (size_t n = 1; n <= N; n *= 10) {
            memset(text, fill[i], n);
            text[n] = 0;
            const bool ok = parse(s, text, &e);
            assert_true(!ok || (fill[i] == '1' && n <= 100));
        }
    for (size_t i = 0; i + 1 < 16000; i += 2)
        memcpy(text + i, "a+", 2);
    memcpy(text + 15998, "b", 2);
    assert_true(parse(s, text, &e)); // long, but flat: whoever recurses over it has room
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, create, destroy)
    const struct CMUnitTest tests[] = {
        CASE(expressions_have_the_values_of_the_grammar),
        CASE(mistakes_are_shown_at_their_character),
        CASE(all_unknown_names_of_one_expression_are_reported),
        CASE(signals_keep_their_text_in_normal_form),
        CASE(dimensions_are_checked_against_the_wanted_one),
        CASE(nesting_and_length_are_bounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
