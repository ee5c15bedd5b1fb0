// See export_text.h.
#include "codegen/export_text.h"

#include "expr/print.h"

void ct_export_put(struct ct_export_text *t, const char *s)
{
    for (; *s; s++)
        CT_PUSH(t->arena, t->s, t->n, t->cap, *s);
}

void ct_export_putf(struct ct_export_text *t, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    ct_export_put(t, ct_arena_vprintf(t->arena, fmt, ap));
    va_end(ap);
}

void ct_export_put_named(struct ct_export_text *t, const char *s)
{
    for (; *s; s++) {
        if (*s != '@' && *s != '$') {
            CT_PUSH(t->arena, t->s, t->n, t->cap, *s);
            continue;
        }
        for (const char *c = t->name; *c; c++) {
            const bool small = *c >= 'a' && *c <= 'z';
            CT_PUSH(t->arena, t->s, t->n, t->cap,
                    *s == '$' && small ? (char)(*c - 'a' + 'A') : *c);
        }
    }
}

void ct_export_put_lines(struct ct_export_text *t, const char *const *line)
{
    for (; *line; line++)
        ct_export_put_named(t, *line);
}

void ct_export_put_numbers(struct ct_export_text *t, const double *v, size_t n)
{
    ct_export_put(t, "{");
    for (size_t k = 0; k < n; k++)
        ct_export_putf(t, "%s%s,", k % 4 ? " " : "\n    ", ct_number_c(t->arena, v[k]));
    ct_export_put(t, n ? "\n}" : "0}");
}

void ct_export_put_integers(struct ct_export_text *t, const int *v, size_t n)
{
    ct_export_put(t, "{");
    for (size_t k = 0; k < n; k++)
        ct_export_putf(t, "%s%d,", k % 16 ? " " : "\n    ", v[k]);
    ct_export_put(t, n ? "\n}" : "0}");
}

const char *ct_export_finish(struct ct_export_text *t)
{
    CT_PUSH(t->arena, t->s, t->n, t->cap, '\0');
    return t->s;
}
