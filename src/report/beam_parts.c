// See beam_parts.h.
#include "report/beam_parts.h"

#include "formulate/beam_dynamics/beam_dynamics.h"

#include <string.h>

// Layout: operators and operands below which a name is no shorter.
enum { LEAST_NAMED = 8 };

static const char *const axis_name[] = {"x", "y", "z"};

static void replace(struct ct_arena *a, struct ct_beam_parts *p, ct_ex of, ct_ex by)
{
    size_t n = p->n;
    CT_PUSH(a, p->of, n, p->of_cap, of);
    CT_PUSH(a, p->by, p->n, p->by_cap, by);
}

// value under a name, or itself where it is short or constant.
static ct_ex define(struct ct_arena *a, struct ct_exs *x, struct ct_beam_parts *p, ct_ex value,
                    const char *name)
{
    const bool is_constant = !(ct_ex_kinds(x, value) & ~(1u << CT_SYM_PARAM));
    if (is_constant || ct_reduced_size(x, value, LEAST_NAMED) < LEAST_NAMED)
        return value;
    const ct_ex symbol = ct_ex_sym(x, CT_SYM_LOCAL, ct_arena_strdup(x->arena, name),
                                   (uint32_t)p->definitions.n);
    const struct ct_reduced_definition d = {.symbol = symbol, .value = value, .full = value};
    CT_PUSH(a, p->definitions.at, p->definitions.n, p->definition_cap, d);
    return symbol;
}

// value, a node of the equations.
static ct_ex name(struct ct_arena *a, struct ct_exs *x, struct ct_beam_parts *p, ct_ex value,
                  const char *text)
{
    const ct_ex known = ct_beam_parts_name(p, x, value);
    const ct_ex symbol = ct_ex_same(known, value) ? define(a, x, p, value, text) : known;
    if (!ct_ex_same(symbol, known))
        replace(a, p, value, symbol);
    return symbol;
}

// Of a planar mechanism: is axis i of the beam the normal of the plane?
static bool is_normal(struct ct_build *b, const struct ct_flexible *f, int i)
{
    double v;
    const ct_ex n = ct_base_into(b, f, b->topology->normal).e[i];
    return !ct_ex_is_const(b->x, n, &v) || v != 0;
}

static void name_rigid(struct ct_arena *a, struct ct_build *b, const struct ct_flexible *f,
                       struct ct_beam_parts *p)
{
    static const char *const entry[] = {"xx", "yx", "zx", "xy", "yy", "zy", "xz", "yz", "zz"};
    for (int i = 0; i < 3; i++)
        name(a, b->x, p, f->inertia->moment.e[i],
             ct_arena_printf(a, "s_%s.%s", f->name, axis_name[i]));
    for (int i = 0; i < 9; i++) { // column-major, symmetric: the same nodes
        const bool is_there
            = b->topology->is_planar ? i % 4 == 0 && is_normal(b, f, i / 4) : i / 3 >= i % 3;
        if (is_there)
            name(a, b->x, p, f->inertia->inertia.e[i],
                 ct_arena_printf(a, "i_%s.%s", f->name, entry[i]));
    }
}

// Forces with u' = 0: what the base's acceleration gives, less Q_vf, and the elastic ones.
static void name_forces(struct ct_arena *a, struct ct_build *b, const struct ct_flexible *f,
                        const ct_ex3 *moved, const ct_ex3 *swept, struct ct_beam_parts *p)
{
    struct ct_exs *x = b->x;
    ct_ex3 F, T, less[2];
    const struct ct_base m = ct_flexible_base(b, f, CT_BIAS),
                         felt = ct_flexible_felt(b, f, &m, &less[0], &less[1]),
                         turned = {.w = felt.w};
    const size_t nu = b->eqs->nu;
    ct_ex *all = CT_NEWN(a, ct_ex, nu + 1), *inertia = CT_NEWN(a, ct_ex, nu + 1),
          *still = CT_NEWN(a, ct_ex, nu + 1), *elastic = CT_NEWN(a, ct_ex, nu + 1);
    ct_flexible_rows(b, f, &felt, CT_BIAS, all);
    ct_flexible_inertia_rows(b, f, &felt, CT_BIAS, inertia);
    ct_flexible_inertia_rows(b, f, &turned, CT_BIAS, still);
    ct_flexible_stiffness_rows(b, f, elastic);
    for (int k = 0; k < f->nelastic; k++) {
        const int u = f->elastic[k].u;
        const ct_ex Q
            = define(a, x, p, ct_ex_neg(x, still[u]),
                     ct_arena_printf(a, "Q_vf_%s", f->elastic[k].name)),
            V = define(a, x, p, elastic[u], ct_arena_printf(a, "V_q_%s", f->elastic[k].name));
        ct_ex by
            = ct_ex_add(x, ct_ex3_dot(x, moved[k], felt.a), ct_ex3_dot(x, swept[k], felt.al));
        by = ct_ex_sub(x, by, Q);
        replace(a, p, inertia[u], by);
        replace(a, p, all[u], ct_ex_add(x, by, V));
    }
    f->inertia->method->wrench(b, f, &felt, CT_BIAS, &F, &T);
    for (int i = 0; i < 3; i++) {
        name(a, x, p, F.e[i], ct_arena_printf(a, "F_v_%s.%s", f->name, axis_name[i]));
        name(a, x, p, T.e[i], ct_arena_printf(a, "T_v_%s.%s", f->name, axis_name[i]));
    }
}

static void name_elastic(struct ct_arena *a, struct ct_build *b, const struct ct_flexible *f,
                         struct ct_beam_parts *p)
{
    struct ct_exs *x = b->x;
    const size_t n = (size_t)f->nelastic, nu = b->eqs->nu;
    ct_ex *M = CT_NEWN(a, ct_ex, nu * nu + 1);
    struct ct_columns c = {CT_NEWN(a, ct_ex3, n + 1), CT_NEWN(a, ct_ex3, n + 1)};
    ct_flexible_columns(b, f, &c, M);
    for (size_t k = 0; k < n; k++) {
        const char *of = f->elastic[k].name;
        for (int i = 0; i < 3; i++) {
            c.moved[k].e[i] = name(a, x, p, c.moved[k].e[i],
                                   ct_arena_printf(a, "m_rf_%s.%s", of, axis_name[i]));
            c.swept[k].e[i] = name(a, x, p, c.swept[k].e[i],
                                   ct_arena_printf(a, "m_thetaf_%s.%s", of, axis_name[i]));
        }
        for (size_t l = 0; l <= k; l++) {
            const size_t row = (size_t)f->elastic[k].u, column = (size_t)f->elastic[l].u;
            const char *to = f->elastic[l].name + strlen(f->name) + 1;
            name(a, x, p, M[(row > column ? row : column) + nu * (row > column ? column : row)],
                 ct_arena_printf(a, "m_ff_%s.%s", of, to));
        }
    }
    name_forces(a, b, f, c.moved, c.swept, p);
}

// Two elements in space; operators and operands of all parts that are collected and read.
// Limit: of the time to collect; beyond, the sums are counted
enum { MOST_COORDINATES = 12, MOST_SPEEDS = 1000, LONGEST = 40000 };

// Sums over points of sections that vary are not read by anyone.
static bool varies(const struct ct_exs *x, const struct ct_beam *beam)
{
    const ct_ex of[]
        = {beam->mass_per_length, beam->area, beam->Iy, beam->Iz, beam->J, beam->E, beam->G};
    unsigned kinds = 0;
    for (size_t i = 0; i < COUNT(of); i++)
        kinds |= ct_ex_kinds(x, of[i]);
    return kinds & 1u << CT_SYM_LOCAL;
}

bool ct_beam_parts_add(struct ct_arena *a, struct ct_equations *e, size_t i,
                       struct ct_beam_parts *p)
{
    const struct ct_flexible *f = &e->build->flexible[i];
    const struct ct_beam_parts before = *p;
    double size = 0;
    if (!f->nelastic || f->nelastic > MOST_COORDINATES || e->nu > MOST_SPEEDS
        || varies(e->x, f->beam))
        return false;
    name_rigid(a, e->build, f, p);
    for (size_t k = before.definitions.n; k < p->definitions.n; k++)
        size += ct_reduced_size(e->x, p->definitions.at[k].value, LONGEST - size + 1);
    const size_t rigid = p->definitions.n;
    if (size <= LONGEST)
        name_elastic(a, e->build, f, p);
    for (size_t k = rigid; k < p->definitions.n && size <= LONGEST; k++)
        size += ct_reduced_size(e->x, p->definitions.at[k].value, LONGEST - size + 1);
    if (size > LONGEST) {
        p->n = before.n;
        p->definitions.n = before.definitions.n;
    }
    return size <= LONGEST;
}

void ct_beam_parts_derive(struct ct_arena *a, struct ct_equations *e, struct ct_beam_parts *p)
{
    *p = (struct ct_beam_parts){0};
    for (size_t i = 0; i < e->build->nflexible; i++)
        ct_beam_parts_add(a, e, i, p);
}

ct_ex ct_beam_parts_name(const struct ct_beam_parts *p, const struct ct_exs *x, ct_ex node)
{
    for (size_t i = 0; i < p->n; i++)
        if (ct_ex_same(p->of[i], node) && ct_ex_symbol(x, p->by[i]))
            return p->by[i];
    return node;
}
