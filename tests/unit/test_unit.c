// Numbers and units as written.
#include "expr/unit.h"
#include "tests/check.h"

#include <string.h>

static void listed_units_have_their_si_values(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double si;
        int m, kg, s;
    } cases[] = {
        {"mm", 1e-3, 1, 0, 0},
        {"km", 1e3, 1, 0, 0},
        {"g", 1e-3, 0, 1, 0},
        {"t", 1e3, 0, 1, 0},
        {"min", 60, 0, 0, 1},
        {"h", 3600, 0, 0, 1},
        {"deg", 0.017453292519943295, 0, 0, 0},
        {"rpm", 0.10471975511965978, 0, 0, -1},
        {"MN", 1e6, 1, 1, -2},
        {"GPa", 1e9, -1, 1, -2},
        {"kg*m^2", 1, 2, 1, 0},
        {"kg / m^3", 1, -3, 1, 0},
        {"N*m/rad", 1, 2, 1, -2},
        {"N*m*s/rad", 1, 2, 1, -1},
        {"1/s", 1, 0, 0, -1},
        {"m/s/s", 1, 1, 0, -2},
        {"mm^-2", 1e6, -2, 0, 0},
        {"kN*mm", 1, 2, 1, -2},
        {"W*s/J", 1, 0, 0, 0},
        {"", 1, 0, 0, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct ct_unit u;
        size_t at;
        print_message("%s\n", cases[i].text);
        assert_int_equal(ct_unit_parse(cases[i].text, strlen(cases[i].text), &u, &at),
                         CT_UNIT_OK);
        CHECK_CLOSE(u.si, cases[i].si, 1e-15, 0); // a few products of rounded factors
        assert_int_equal(u.m, cases[i].m);
        assert_int_equal(u.kg, cases[i].kg);
        assert_int_equal(u.s, cases[i].s);
    }
}

static void what_is_no_unit_is_refused_at_its_place(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        enum ct_unit_result result;
        size_t at;
    } cases[] = {
        {"lbs", CT_UNIT_UNKNOWN, 0},  {"N*foo", CT_UNIT_UNKNOWN, 2},
        {"m*", CT_UNIT_SYNTAX, 2},    {"m^2.5", CT_UNIT_EXPONENT, 3},
        {"m^x", CT_UNIT_EXPONENT, 2}, {"m m", CT_UNIT_SYNTAX, 2},
        {"(m)", CT_UNIT_SYNTAX, 0},   {"m^12", CT_UNIT_EXPONENT, 3},
        {"10/s", CT_UNIT_SYNTAX, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct ct_unit u;
        size_t at;
        print_message("%s\n", cases[i].text);
        assert_int_equal(ct_unit_parse(cases[i].text, strlen(cases[i].text), &u, &at),
                         cases[i].result);
        assert_int_equal(at, cases[i].at);
    }
}

static void a_number_ends_where_its_digits_end(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        size_t n;
        double value;
    } cases[] = {
        {"1e-4", 4, 1e-4}, {".5", 2, 0.5},         {"1.", 2, 1},
        {"12x", 2, 12},    {"1e", 1, 1},           {"1e+", 1, 1},
        {"1.2.3", 3, 1.2}, {"0x10", 1, 0},         {"1_000", 1, 1},
        {".", 0, 0},       {"e5", 0, 0},           {"-1", 0, 0},
        {"1E5m", 3, 1e5},  {"1e999", 5, HUGE_VAL}, {"1e-999", 6, 0},
        {"0.1", 3, 0.1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double v = 0;
        print_message("%s\n", cases[i].text);
        assert_int_equal(ct_number_parse(cases[i].text, &v), cases[i].n);
        if (cases[i].n)
            assert_true(v == cases[i].value);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(listed_units_have_their_si_values),
        cmocka_unit_test(what_is_no_unit_is_refused_at_its_place),
        cmocka_unit_test(a_number_ends_where_its_digits_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
