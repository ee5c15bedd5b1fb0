// See beam_parts.h.
#include "report/beam_parts.h"

#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/dynamics/dynamics.h"
#include "formulate/dynamics/small_motion.h"

#include <string.h>

// Layout: number of operators and operands below which a name is not shorter.
enum { LEAST_NAMED = 8 };

static const char *const axis_name[] = {"x", "y", "z"};

static void remember(struct ct_arena *a, struct ct_beam_parts *p, ct_ex node, ct_ex symbol)
{
    size_t n = p->n;
    CT_PUSH(a, p->node, n, p->node_cap, node);
    CT_PUSH(a, p->symbol, p->n, p->symbol_cap, symbol);
}

// Replaces the symbols of the frame's angular velocity in `value` by their expressions.
static ct_ex without_names(struct ct_exs *x, const struct ct_beam_parts *p, ct_ex value)
{
    return p->nangular_velocity && ct_ex_kinds(x, value) & 1u << CT_SYM_LOCAL
             ? ct_ex_subst(x, value, p->angular_velocity, p->angular_velocity_full,
                           (size_t)p->nangular_velocity)
             : value;
}

static ct_ex make(struct ct_arena *a, struct ct_exs *x, struct ct_beam_parts *p, ct_ex value,
                  const char *name)
{
    const ct_ex symbol = ct_ex_sym(x, CT_SYM_LOCAL, ct_arena_strdup(x->arena, name),
                                   (uint32_t)p->definitions.n);
    const struct ct_reduced_definition d
        = {.symbol = symbol, .value = value, .full = without_names(x, p, value)};
    CT_PUSH(a, p->definitions.at, p->definitions.n, p->definition_cap, d);
    return symbol;
}

// A symbol defined as `value`; value itself if it is short or constant.
static ct_ex define(struct ct_arena *a, struct ct_exs *x, struct ct_beam_parts *p, ct_ex value,
                    const char *name)
{
    const bool is_constant = !(ct_ex_kinds(x, value) & ~(1u << CT_SYM_PARAM));
    if (is_constant || ct_reduced_size(x, value, LEAST_NAMED) < LEAST_NAMED)
        return value;
    return make(a, x, p, value, name);
}

// As define, for the angular velocity of a frame. always: also if it is short. In space, with
// several beams, it always gets a name, so that the parts of equal beams differ by names alone.
static ct_ex define_angular_velocity(struct ct_arena *a, struct ct_exs *x,
                                     struct ct_beam_parts *p, ct_ex value, const char *name,
                                     bool always)
{
    const ct_ex symbol = !always || ct_ex_is_const(x, value, NULL)
                           ? define(a, x, p, value, name)
                           : make(a, x, p, value, name);
    if (!ct_ex_same(symbol, value)) {
        p->angular_velocity[p->nangular_velocity] = symbol;
        p->angular_velocity_full[p->nangular_velocity++] = value;
    }
    return symbol;
}

// The symbol of a node of the equations: the known one, or that of a new definition.
static ct_ex name(struct ct_arena *a, struct ct_exs *x, struct ct_beam_parts *p, ct_ex value,
                  const char *text)
{
    const ct_ex known = ct_beam_parts_name(p, value);
    const ct_ex symbol = ct_ex_same(known, value) ? define(a, x, p, value, text) : known;
    if (!ct_ex_same(symbol, known))
        remember(a, p, value, symbol);
    return symbol;
}

// In a planar mechanism: is axis i of the beam the normal of the plane?
static bool is_normal(struct ct_build *b, const struct ct_flexible *f, int i)
{
    double v;
    const ct_ex n = ct_base_into(b, f, b->topology->normal).e[i];
    return !ct_ex_is_const(b->x, n, &v) || v != 0;
}

static void name_rigid(struct ct_arena *a, struct ct_build *b, const struct ct_flexible *f,
                       struct ct_beam_parts *p, struct ct_inertia *I)
{
    static const char *const entry[] = {"xx", "yx", "zx", "xy", "yy", "zy", "xz", "yz", "zz"};
    for (int i = 0; i < 3; i++)
        I->moment.e[i] = name(a, b->x, p, I->moment.e[i],
                              ct_arena_printf(a, "s_%s.%s", f->name, axis_name[i]));
    for (int i = 0; i < 9; i++) { // column-major, symmetric: the same nodes
        const int row = i % 3, column = i / 3;
        if (b->topology->is_planar && (row != column || !is_normal(b, f, row)))
            continue;
        I->inertia.e[i] = name(
            a, b->x, p, I->inertia.e[i],
            ct_arena_printf(a, "i_%s.%s", f->name, entry[row > column ? column + 3 * row : i]));
    }
}

// Forces with u' = 0: quadratic velocity forces, elastic forces, and forces of the motion
// relative to the frame.
static void name_forces(struct ct_arena *a, struct ct_build *b, const struct ct_flexible *f,
                        struct ct_beam_parts *p, struct ct_named_inertia *out)
{
    struct ct_exs *x = b->x;
    ct_ex3 less[2];
    const struct ct_base m = ct_flexible_base(b, f, CT_BIAS),
                         effective = ct_flexible_effective_base(b, f, &m, &less[0], &less[1]);
    const size_t nu = b->eqs->nu;
    struct ct_base base = {{{{0}}}};
    p->nangular_velocity = 0;
    for (int i = 0; i < 3; i++)
        base.w.e[i] = define_angular_velocity(
            a, x, p, effective.w.e[i], ct_arena_printf(a, "om_%s.%s", f->name, axis_name[i]),
            b->nflexible > 1 && !b->topology->is_planar);
    ct_ex *inertia = CT_NEWN(a, ct_ex, nu + 1), *elastic = CT_NEWN(a, ct_ex, nu + 1);
    ct_flexible_inertia_rows(b, f, &base, CT_BIAS, inertia);
    ct_flexible_stiffness_rows(b, f, elastic);
    for (int k = 0; k < f->nelastic; k++) {
        const int u = f->elastic[k].u;
        out->velocity[k] = define(a, x, p, ct_ex_neg(x, inertia[u]),
                                  ct_arena_printf(a, "Q_vf_%s", f->elastic[k].name));
        out->elastic[k]
            = define(a, x, p, elastic[u], ct_arena_printf(a, "V_q_%s", f->elastic[k].name));
    }
    f->inertia->method->wrench(b, f, &base, CT_BIAS, &out->force, &out->torque);
    for (int i = 0; i < 3; i++) {
        out->force.e[i] = name(a, x, p, out->force.e[i],
                               ct_arena_printf(a, "F_v_%s.%s", f->name, axis_name[i]));
        out->torque.e[i] = name(a, x, p, out->torque.e[i],
                                ct_arena_printf(a, "T_v_%s.%s", f->name, axis_name[i]));
    }
}

static void name_elastic(struct ct_arena *a, struct ct_build *b, const struct ct_flexible *f,
                         struct ct_beam_parts *p, struct ct_named_inertia *out)
{
    struct ct_exs *x = b->x;
    const size_t n = (size_t)f->nelastic;
    struct ct_symmetric M = ct_symmetric_create(a, b->eqs->nu);
    ct_flexible_columns(b, f, &out->columns, &M);
    for (size_t k = 0; k < n; k++) {
        const char *of = f->elastic[k].name;
        for (int i = 0; i < 3; i++) {
            ct_ex *m_rf = &out->columns.m_rf[k].e[i],
                  *m_thetaf = &out->columns.m_thetaf[k].e[i];
            *m_rf = name(a, x, p, *m_rf, ct_arena_printf(a, "m_rf_%s.%s", of, axis_name[i]));
            *m_thetaf = name(a, x, p, *m_thetaf,
                             ct_arena_printf(a, "m_thetaf_%s.%s", of, axis_name[i]));
        }
        for (size_t l = 0; l <= k; l++) {
            const size_t row = (size_t)f->elastic[k].u, column = (size_t)f->elastic[l].u;
            const char *to = f->elastic[l].name + strlen(f->name) + 1;
            out->M[k * n + l] = out->M[l * n + k]
                = name(a, x, p, ct_symmetric_get(&M, row, column),
                       ct_arena_printf(a, "m_ff_%s.%s", of, to));
        }
    }
    name_forces(a, b, f, p, out);
}

// Limit: of the time to collect, and of what is printed: coordinates (two elements in space);
// operators and operands of all parts.
enum { MOST_COORDINATES = 12, MOST_SPEEDS = 1000, LONGEST = 40000 };

// Sums over integration points of varying sections are too long to print.
static bool varies(const struct ct_exs *x, const struct ct_beam *beam)
{
    const ct_ex of[]
        = {beam->mass_per_length, beam->area, beam->Iy, beam->Iz, beam->J, beam->E, beam->G};
    unsigned kinds = 0;
    for (size_t i = 0; i < COUNT(of); i++)
        kinds |= ct_ex_kinds(x, of[i]);
    return kinds & 1u << CT_SYM_LOCAL;
}

struct ct_named_inertia *ct_named_inertia_create(struct ct_arena *a, size_t n)
{
    struct ct_named_inertia *s = CT_NEW(a, struct ct_named_inertia);
    s->columns
        = (struct ct_elastic_columns){CT_NEWN(a, ct_ex3, n + 1), CT_NEWN(a, ct_ex3, n + 1)};
    s->M = CT_NEWN(a, ct_ex, n * n + 1);
    s->velocity = CT_NEWN(a, ct_ex, n + 1);
    s->elastic = CT_NEWN(a, ct_ex, n + 1);
    return s;
}

static bool may_have_parts(const struct ct_equations *e, const struct ct_flexible *f)
{
    return f->nelastic && f->nelastic <= MOST_COORDINATES && e->nu <= MOST_SPEEDS
        && !varies(e->x, f->beam);
}

bool ct_beam_parts_exist(const struct ct_equations *e)
{
    bool any = false;
    for (size_t i = 0; i < e->build->nflexible; i++)
        any = any || may_have_parts(e, &e->build->flexible[i]);
    return any && !ct_small_motion_is_wanted(e->build);
}

bool ct_beam_parts_are_long(const struct ct_exs *x, const struct ct_definitions *list)
{
    double size = 0;
    for (size_t k = 0; k < list->n && size <= LONGEST; k++)
        size += ct_reduced_size(x, list->at[k].value, LONGEST - size + 1);
    return size > LONGEST;
}

bool ct_beam_parts_add(struct ct_arena *a, struct ct_equations *e, size_t i,
                       enum ct_long_parts which, struct ct_beam_parts *p)
{
    const struct ct_flexible *f = &e->build->flexible[i];
    const struct ct_beam_parts before = *p;
    if (!may_have_parts(e, f))
        return false;
    struct ct_inertia *I = CT_NEW(a, struct ct_inertia);
    struct ct_named_inertia *named = ct_named_inertia_create(a, (size_t)f->nelastic);
    *I = *f->inertia;
    I->named = named;
    name_rigid(a, e->build, f, p, I);
    const struct ct_definitions rigid
        = {p->definitions.at + before.definitions.n, p->definitions.n - before.definitions.n};
    bool is_long = which == CT_LONG_PARTS_NONE && ct_beam_parts_are_long(e->x, &rigid);
    if (!is_long) {
        name_elastic(a, e->build, f, p, named);
        const struct ct_definitions all = {p->definitions.at + before.definitions.n,
                                           p->definitions.n - before.definitions.n};
        is_long = which == CT_LONG_PARTS_NONE && ct_beam_parts_are_long(e->x, &all);
    }
    if (is_long) {
        p->n = before.n;
        p->definitions.n = before.definitions.n;
    } else if (p->inertia) {
        p->inertia[i] = I;
    }
    return !is_long;
}

void ct_beam_parts_derive(struct ct_arena *a, struct ct_equations *e, enum ct_long_parts which,
                          struct ct_beam_parts *p)
{
    const size_t n = e->build->nflexible;
    *p = (struct ct_beam_parts){.inertia = CT_NEWN(a, struct ct_inertia *, n + 1)};
    // terms of higher order in `small` coordinates are dropped by differentiation, which takes
    // names for constants
    for (size_t i = 0; i < n && !ct_small_motion_is_wanted(e->build); i++)
        ct_beam_parts_add(a, e, i, which, p);
}

void ct_named_dynamics_derive(struct ct_arena *a, const struct ct_equations *e,
                              struct ct_inertia *const *inertia, struct ct_named_dynamics *out)
{
    struct ct_equations *made = CT_NEW(a, struct ct_equations);
    struct ct_build b = *e->build;
    struct ct_flexible *f = CT_NEWN(a, struct ct_flexible, b.nflexible + 1);
    for (size_t i = 0; i < b.nflexible; i++) {
        f[i] = b.flexible[i];
        if (inertia[i])
            f[i].inertia = inertia[i];
    }
    *made = *b.eqs;
    made->M = NULL;
    made->nM = made->M_cap = 0;
    made->Q = CT_NEWN(a, ct_ex, e->nu + 1);
    made->has_dynamics = false;
    b.arena = a;
    b.flexible = f;
    b.eqs = made;
    b.dynamics.masses = (struct ct_lumped_masses){0};
    b.dynamics.sweep[CT_BIAS] = b.dynamics.sweep[CT_FULL] = NULL;
    ct_dynamics_derive(&b);
    *out = (struct ct_named_dynamics){.M = made->M,
                                      .nM = made->nM,
                                      .Q = made->Q,
                                      .effort = CT_NEWN(a, ct_ex, e->ndriver + 1)};
    for (size_t i = 0; i < e->ncoordinate; i++)
        if (e->coordinate[i].driver >= 0)
            out->effort[e->coordinate[i].driver] = ct_driver_effort(&b, (int)i);
}

ct_ex ct_beam_parts_name(const struct ct_beam_parts *p, ct_ex node)
{
    for (size_t i = 0; i < p->n; i++)
        if (ct_ex_same(p->node[i], node))
            return p->symbol[i];
    return node;
}
