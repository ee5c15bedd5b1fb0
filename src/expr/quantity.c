// See quantity.h.
#include "expr/quantity.h"

#include "expr/character.h"
#include "expr/unit.h"

#include <math.h>
#include <string.h>

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

// The word that starts there, as far as a unit would reach.
static const char *word_at(struct ct_arena *a, const char *p)
{
    size_t n = 0;
    while (ct_is_letter(p[n]) || (n && ct_is_digit(p[n])) || (p[n] & 0x80))
        n++;
    return ct_arena_strndup(a, p, n);
}

static bool report_unit(struct ct_ctx *ctx, const struct ct_quantity *q,
                        enum ct_unit_result result, size_t at)
{
    if (result == CT_UNIT_EXPONENT)
        return ct_error(ctx, q->mark, CT_E_UNIT,
                        "'%s': the exponent of a unit is one digit with an optional sign",
                        q->text);
    if (result == CT_UNIT_SYNTAX)
        return ct_error(
            ctx, q->mark, CT_E_UNIT,
            "'%s': a number with a unit stands alone, in an expression numbers are SI",
            q->text);
    const char *name = word_at(ctx->scratch, q->unit + at), *near = ct_unit_nearest(name);
    if (name[0] == '_')
        return ct_error(ctx, q->mark, CT_E_NUMBER, "'%s': digits cannot be grouped with '_'",
                        q->text);
    if (q->is_name(q->user, name))
        return ct_error(ctx, q->mark, CT_E_SYNTAX, "'%s': an operator is missing before '%s'",
                        q->text, name);
    if (near)
        return ct_error(ctx, q->mark, CT_E_UNIT, "unknown unit '%s'; did you mean '%s'?", name,
                        near);
    return ct_error(ctx, q->mark, CT_E_UNIT, "unknown unit '%s'", name);
}

static bool check_dimension(struct ct_ctx *ctx, const struct ct_quantity *q,
                            const struct ct_unit *u)
{
    if (!q->wanted)
        return true;
    struct ct_unit wanted;
    size_t at;
    ct_unit_parse(q->wanted, strlen(q->wanted), &wanted, &at);
    if (ct_unit_same(u, &wanted))
        return true;
    if (!q->wanted[0])
        return ct_error(ctx, q->mark, CT_E_DIMENSION,
                        "'%s' is in %s, but a number without a unit is wanted here", q->text,
                        q->unit);
    return ct_error(ctx, q->mark, CT_E_DIMENSION,
                    "'%s' is in %s, but a quantity in %s is wanted here", q->text, q->unit,
                    q->wanted);
}

bool ct_quantity_read(struct ct_ctx *ctx, const struct ct_quantity *q, double *value)
{
    struct ct_unit u;
    size_t at;
    const enum ct_unit_result result = ct_unit_parse(q->unit, strlen(q->unit), &u, &at);
    if (result != CT_UNIT_OK)
        return report_unit(ctx, q, result, at);
    *value *= u.si;
    if (!isfinite(*value))
        return ct_error(ctx, q->mark, CT_E_NUMBER, "'%s': the number is too large", q->text);
    return check_dimension(ctx, q, &u);
}
