// Names and texts of the derivation; see derivation.h.
#include "report/derivation.h"

#include "expr/collect.h"

#include <string.h>

// A rate reads as the primed coordinate; angular velocities keep their own names.
static const char *plain_name(const struct ct_derivation *d, const struct ct_sym *s)
{
    const struct ct_equations *e = d->e;
    const bool is_speed = s->kind == CT_SYM_U || s->kind == CT_SYM_A;
    if (!is_speed || s->index >= e->nu)
        return s->name;
    const struct ct_u *u = &e->u[s->index];
    const char *prime = s->kind == CT_SYM_A ? "'" : "";
    return u->q >= 0 ? ct_arena_printf(d->a, "%s'%s", e->q[u->q].name, prime)
                     : ct_arena_printf(d->a, "%s%s", u->name, prime);
}

static const char *symbol(void *data, struct ct_arena *a, const struct ct_sym *s)
{
    const struct ct_derivation *d = data;
    const char *name = plain_name(d, s);
    if (d->page.look != CT_LOOK_LATEX)
        return name;
    if (s->kind != CT_SYM_LAM)
        return ct_latex_name(a, name);
    return d->e->nrow == 1 ? "\\lambda" : ct_arena_printf(a, "\\lambda_{%u}", s->index + 1);
}

void ct_derivation_init(struct ct_derivation *d, struct ct_arena *a, struct ct_equations *e,
                        const struct ct_model *m, enum ct_look look)
{
    *d = (struct ct_derivation){.a = a, .e = e, .m = m, .page = {.arena = a, .look = look}};
    d->print = (struct ct_print){
        .style = look == CT_LOOK_LATEX ? CT_PRINT_LATEX : CT_PRINT_TEXT,
        .symbol = symbol,
        .data = d,
        .fractions = true,
    };
}

const char *ct_derivation_text(struct ct_derivation *d, ct_ex v)
{
    return ct_ex_text(d->a, d->e->x, v, &d->print);
}

const char *ct_derivation_collected(struct ct_derivation *d, ct_ex v)
{
    const struct ct_collect_options o = {.scratch = d->a};
    return ct_derivation_text(d, ct_ex_collect(d->e->x, v, &o));
}

const char *ct_derivation_name(struct ct_derivation *d, const char *name)
{
    return d->page.look == CT_LOOK_LATEX ? ct_latex_name(d->a, name) : name;
}

const char *ct_derivation_of(struct ct_derivation *d, const char *letter, const char *name)
{
    if (d->page.look != CT_LOOK_LATEX)
        return ct_arena_printf(d->a, "%s(%s)", letter, name);
    char *quoted = CT_NEWN(d->a, char, 2 * strlen(name) + 1), *q = quoted;
    for (; *name; name++) {
        if (strchr("_#$%&{}", *name))
            *q++ = '\\';
        *q++ = *name;
    }
    return ct_arena_printf(d->a, "%s_{\\mathrm{%s}}", letter, quoted);
}

const char *ct_derivation_vector(struct ct_derivation *d, ct_ex3 v)
{
    return ct_arena_printf(d->a, d->page.look == CT_LOOK_LATEX ? "(%s,\\; %s,\\; %s)" : "[%s, %s, %s]",
                           ct_derivation_text(d, v.e[0]), ct_derivation_text(d, v.e[1]),
                           ct_derivation_text(d, v.e[2]));
}
