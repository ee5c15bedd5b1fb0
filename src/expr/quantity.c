// See quantity.h.
#include "expr/quantity.h"

#include "expr/character.h"
#include "expr/unit.h"

#include <math.h>
#include <string.h>

struct reader {
    struct ct_ctx *ctx;
    const struct ct_scope *scope;
    struct ct_text text;
};

// [sign] number blanks unit
bool ct_quantity_split(const char *text, double *value, const char **unit)
{
    const char *p = text;
    while (ct_is_blank(*p))
        p++;
    const double sign = *p == '-' ? -1 : 1;
    p += *p == '-' || *p == '+';
    while (ct_is_blank(*p))
        p++;
    const size_t n = ct_number_parse(p, value);
    *value *= sign;
    p += n;
    const bool has_gap = ct_is_blank(*p);
    while (ct_is_blank(*p))
        p++;
    *unit = p;
    // two-byte letters: a unit such as a micrometre, unknown but a unit
    return n && (ct_is_letter(*p) || (*p & 0x80) || (has_gap && p[0] == '1' && p[1] == '/'));
}

static bool report_unit(const struct reader *s, enum ct_unit_result result, const char *unit,
                        size_t at)
{
    const struct ct_mark mark = s->text.mark;
    const char *bad = unit + at;
    int n = 0;
    while (ct_is_letter(bad[n]) || (n && ct_is_digit(bad[n])) || (bad[n] & 0x80))
        n++;
    char *name = ct_arena_strndup(s->ctx->scratch, bad, (size_t)n);
    if (result == CT_UNIT_EXPONENT)
        return ct_error(s->ctx, mark, CT_E_UNIT,
                        "'%s': the exponent of a unit is one digit with an optional sign",
                        s->text.text);
    if (result == CT_UNIT_SYNTAX)
        return ct_error(
            s->ctx, mark, CT_E_UNIT,
            "'%s': a number with a unit stands alone, in an expression numbers are SI",
            s->text.text);
    if (name[0] == '_')
        return ct_error(s->ctx, mark, CT_E_NUMBER, "'%s': digits cannot be grouped with '_'",
                        s->text.text);
    if (ct_scope_knows(s->scope, name) || ct_is_function(name))
        return ct_error(s->ctx, mark, CT_E_SYNTAX, "'%s': an operator is missing before '%s'",
                        s->text.text, name);
    const char *near = ct_unit_nearest(name);
    if (near)
        return ct_error(s->ctx, mark, CT_E_UNIT, "unknown unit '%s'; did you mean '%s'?", name,
                        near);
    return ct_error(s->ctx, mark, CT_E_UNIT, "unknown unit '%s'", name);
}

static bool check_dimension(const struct reader *s, const struct ct_unit *u, const char *unit)
{
    if (!s->scope->unit)
        return true;
    struct ct_unit wanted;
    size_t at;
    ct_unit_parse(s->scope->unit, strlen(s->scope->unit), &wanted, &at);
    if (ct_unit_same(u, &wanted))
        return true;
    if (!s->scope->unit[0])
        return ct_error(s->ctx, s->text.mark, CT_E_DIMENSION,
                        "'%s' is in %s, but a number without a unit is wanted here",
                        s->text.text, unit);
    return ct_error(s->ctx, s->text.mark, CT_E_DIMENSION,
                    "'%s' is in %s, but a quantity in %s is wanted here", s->text.text, unit,
                    s->scope->unit);
}

bool ct_quantity_read(struct ct_ctx *ctx, const struct ct_scope *scope, struct ct_text text,
                      double value, const char *unit, ct_ex *e)
{
    const struct reader s = {ctx, scope, text};
    struct ct_unit u;
    size_t at;
    const enum ct_unit_result result = ct_unit_parse(unit, strlen(unit), &u, &at);
    if (result != CT_UNIT_OK)
        return report_unit(&s, result, unit, at);
    value *= u.si;
    if (!isfinite(value))
        return ct_error(ctx, text.mark, CT_E_NUMBER, "'%s': the number is too large",
                        text.text);
    *e = ct_ex_const(scope->x, value);
    return check_dimension(&s, &u, unit);
}

const char *ct_parse_unit(const char *text)
{
    double value;
    const char *unit;
    return ct_quantity_split(text, &value, &unit) ? unit : NULL;
}
