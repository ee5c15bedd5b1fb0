// Units by recursive descent over a table; see unit.h.
#include "expr/unit.h"
#include "base/pi.h"
#include "base/ctx.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name;
    struct ct_unit unit;
} units[] = {
    // Definition: SI units, their decimal multiples, and other common units
    {"m", {1, 1, 0, 0}},
    {"mm", {1e-3, 1, 0, 0}},
    {"cm", {1e-2, 1, 0, 0}},
    {"km", {1e3, 1, 0, 0}},
    {"kg", {1, 0, 1, 0}},
    {"g", {1e-3, 0, 1, 0}},
    {"t", {1e3, 0, 1, 0}},
    {"s", {1, 0, 0, 1}},
    {"ms", {1e-3, 0, 0, 1}},
    {"min", {60, 0, 0, 1}},
    {"h", {3600, 0, 0, 1}},
    {"rad", {1, 0, 0, 0}},
    {"deg", {CT_PI / 180, 0, 0, 0}},
    {"N", {1, 1, 1, -2}},
    {"kN", {1e3, 1, 1, -2}},
    {"MN", {1e6, 1, 1, -2}},
    {"Pa", {1, -1, 1, -2}},
    {"kPa", {1e3, -1, 1, -2}},
    {"MPa", {1e6, -1, 1, -2}},
    {"GPa", {1e9, -1, 1, -2}},
    {"J", {1, 2, 1, -2}},
    {"W", {1, 2, 1, -3}},
    {"Hz", {1, 0, 0, -1}},
    {"rpm", {CT_PI / 30, 0, 0, -1}}, // turns per minute as an angular velocity
};

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (c & 0x80);
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static size_t name_length(const char *text, size_t n)
{
    size_t k = 0;
    while (k < n && (is_letter(text[k]) || (k && is_digit(text[k]))))
        k++;
    return k;
}

static const struct ct_unit *find_unit(const char *name, size_t n)
{
    for (size_t i = 0; i < COUNT(units); i++)
        if (strlen(units[i].name) == n && strncmp(units[i].name, name, n) == 0)
            return &units[i].unit;
    return NULL;
}

struct scan {
    const char *text;
    size_t n, i;
};

static void skip_blanks(struct scan *s)
{
    while (s->i < s->n && (s->text[s->i] == ' ' || s->text[s->i] == '\t'))
        s->i++;
}

static bool take(struct scan *s, char c)
{
    skip_blanks(s);
    if (s->i == s->n || s->text[s->i] != c)
        return false;
    s->i++;
    return true;
}

// ^ and an integer of one digit; 1 if there is no ^
static enum ct_unit_result scan_exponent(struct scan *s, int *exponent)
{
    *exponent = 1;
    if (!take(s, '^'))
        return CT_UNIT_OK;
    const int sign = take(s, '-') ? -1 : 1;
    skip_blanks(s);
    if (s->i == s->n || !is_digit(s->text[s->i]))
        return CT_UNIT_EXPONENT;
    *exponent = sign * (s->text[s->i] - '0');
    s->i++;
    return s->i < s->n && (is_digit(s->text[s->i]) || s->text[s->i] == '.') ? CT_UNIT_EXPONENT
                                                                            : CT_UNIT_OK;
}

static enum ct_unit_result scan_factor(struct scan *s, struct ct_unit *u)
{
    skip_blanks(s);
    if (s->i < s->n && s->text[s->i] == '1') { // as in 1/s
        s->i++;
        *u = (struct ct_unit){.si = 1};
        return CT_UNIT_OK;
    }
    const size_t k = name_length(s->text + s->i, s->n - s->i);
    if (k == 0)
        return CT_UNIT_SYNTAX;
    const struct ct_unit *found = find_unit(s->text + s->i, k);
    if (!found)
        return CT_UNIT_UNKNOWN;
    s->i += k;
    int p;
    const enum ct_unit_result result = scan_exponent(s, &p);
    *u = (struct ct_unit){pow(found->si, p), p * found->m, p * found->kg, p * found->s};
    return result;
}

static bool exponents_are_small(const struct ct_unit *u)
{
    enum { LARGEST = 1000 }; // Limit: far from overflow, with a message
    return abs(u->m) < LARGEST && abs(u->kg) < LARGEST && abs(u->s) < LARGEST;
}

enum ct_unit_result ct_unit_parse(const char *text, size_t n, struct ct_unit *unit, size_t *at)
{
    struct scan s = {text, n, 0};
    *unit = (struct ct_unit){.si = 1};
    skip_blanks(&s);
    enum ct_unit_result result = CT_UNIT_OK;
    for (int sign = 1; s.i < n;) {
        struct ct_unit f;
        result = scan_factor(&s, &f);
        if (result != CT_UNIT_OK)
            break;
        unit->si = sign > 0 ? unit->si * f.si : unit->si / f.si;
        unit->m += sign * f.m;
        unit->kg += sign * f.kg;
        unit->s += sign * f.s;
        if (!exponents_are_small(unit)) {
            result = CT_UNIT_EXPONENT;
            break;
        }
        if (take(&s, '*'))
            sign = 1;
        else if (take(&s, '/'))
            sign = -1;
        else {
            skip_blanks(&s);
            result = s.i == n ? CT_UNIT_OK : CT_UNIT_SYNTAX;
            break;
        }
        skip_blanks(&s);
        if (s.i == n) // nothing after the operator
            result = CT_UNIT_SYNTAX;
    }
    *at = s.i;
    return result;
}

bool ct_unit_same(const struct ct_unit *a, const struct ct_unit *b)
{
    return a->m == b->m && a->kg == b->kg && a->s == b->s;
}

const char *ct_unit_nearest(const char *text)
{
    char name[16] = {0};
    const size_t k = name_length(text, strlen(text));
    if (k == 0 || k >= sizeof name)
        return NULL;
    memcpy(name, text, k); // NOLINT(bugprone-not-null-terminated-result): name is zeroed
    const char *names[COUNT(units)];
    size_t n = 0;
    // a slip of two letters in three is none: `in` is not suggested as `min`
    for (size_t i = 0; i < COUNT(units); i++)
        if (k > 2 || strlen(units[i].name) <= k)
            names[n++] = units[i].name;
    return ct_nearest(name, names, n);
}

static size_t count_digits(const char *s)
{
    size_t n = 0;
    while (is_digit(s[n]))
        n++;
    return n;
}

size_t ct_number_parse(const char *text, double *value)
{
    size_t n = count_digits(text);
    size_t digits = n;
    if (text[n] == '.') {
        const size_t after = count_digits(text + n + 1);
        digits += after;
        n += 1 + after;
    }
    if (digits == 0)
        return 0;
    if (text[n] == 'e' || text[n] == 'E') {
        const size_t sign = text[n + 1] == '+' || text[n + 1] == '-';
        const size_t power = count_digits(text + n + 1 + sign);
        if (power)
            n += 1 + sign + power;
    }
    // strtod depends on the locale's decimal point, but it rounds correctly; so the text is
    // converted for it
    enum { LONGEST = 400 }; // Limit: of the stack; more digits than a double has exponents
    char copy[LONGEST + 1];
    const size_t used = n < LONGEST ? n : LONGEST;
    memcpy(copy, text, used);
    copy[used] = 0;
    char *point = memchr(copy, '.', used);
    if (point)
        *point = localeconv()->decimal_point[0];
    *value = n <= LONGEST ? strtod(copy, NULL) : HUGE_VAL;
    return n;
}
