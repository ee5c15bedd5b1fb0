// See small_motion.h.
#include "formulate/dynamics/small_motion.h"
#include "formulate/beam/flexible_body.h"
#include "formulate/operation_count.h"

#include <string.h>

struct small {
    struct ct_seed *seed; // one direction for each coordinate and speed
    ct_ex *symbol, *zero;
    size_t n, seed_cap, symbol_cap;
    bool *is_small;        // by speed
    bool has_condensation; // massless rotations of small beams are condensed (beam_dynamics.h)
};

static void add(struct ct_build *b, struct small *s, ct_ex symbol)
{
    const struct ct_seed seed = {symbol, (uint32_t)s->n, CT_EX_ONE};
    size_t n = s->n;
    CT_PUSH(b->ctx->scratch, s->symbol, n, s->symbol_cap, symbol);
    CT_PUSH(b->ctx->scratch, s->seed, s->n, s->seed_cap, seed);
}

static void add_unknown(struct ct_build *b, struct small *s, int q, int u)
{
    add(b, s, b->eqs->q[q].symbol);
    add(b, s, b->eqs->u[u].symbol);
    s->is_small[u] = true;
}

static bool collect_joint(struct ct_build *b, struct small *s, int j, struct ct_mark at)
{
    if (b->topology->edge_of_joint[j] < 0)
        return true; // a gear has no coordinate
    const struct ct_edge_info *e = &b->topology->edge[b->topology->edge_of_joint[j]];
    for (int k = 0; k < e->ncoordinate; k++) {
        const struct ct_coordinate *c = &b->kinematics->coordinate[e->first_coordinate + k];
        if (c->driver >= 0 || (!c->in_translation && !c->in_rotation))
            continue;
        if (e->trial->quaternion >= 0 && k >= e->trial->quaternion)
            return ct_error(b->ctx, at, CT_E_TREE,
                            "small: the free rotation of joint '%s' has no small coordinates",
                            e->name);
        if (c->u < 0)
            return ct_error(b->ctx, at, CT_E_TREE,
                            "small: joint '%s' closes a loop; only a branch has coordinates "
                            "that can be small",
                            e->name);
        add_unknown(b, s, c->q, c->u);
    }
    return true;
}

static bool collect(struct ct_build *b, struct small *s)
{
    struct ct_mark at;
    bool ok = true;
    s->is_small = CT_NEWN(b->arena, bool, b->eqs->nu + 1);
    for (size_t j = 0; j < b->model->njoint; j++)
        if (ct_build_is_small(b, b->model->joint[j].name, &at))
            ok &= collect_joint(b, s, (int)j, at);
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        if (ct_flexible_is_small(b, f))
            for (int k = 0; k < f->nelastic; k++) {
                add_unknown(b, s, f->elastic[k].q, f->elastic[k].u);
                s->has_condensation |= f->condensation != NULL;
            }
    }
    s->zero = CT_NEWN(b->ctx->scratch, ct_ex, s->n + 1);
    return ok;
}

// f (n) and its derivatives along the seeds of all small symbols, evaluated with these at zero.
// *slope lives in scratch.
static size_t expand(struct ct_build *b, const struct small *s, const ct_ex *f, size_t n,
                     const struct ct_seed *seed, ct_ex *at_zero, struct ct_slope **slope)
{
    struct ct_arena *scratch = b->ctx->scratch;
    const size_t nslope = ct_ex_jacobian(b->x, scratch, scratch, f, n, seed, s->n, slope);
    ct_ex *all = CT_NEWN(scratch, ct_ex, n + nslope + 1);
    memcpy(all, f, n * sizeof *all);
    for (size_t i = 0; i < nslope; i++)
        all[n + i] = (*slope)[i].value;
    ct_ex_subst_list(b->x, all, n + nslope, s->symbol, s->zero, s->n);
    memcpy(at_zero, all, n * sizeof *all);
    for (size_t i = 0; i < nslope; i++)
        (*slope)[i].value = all[n + i];
    return nslope;
}

// f(0) + sum of df/dx(0) x, x the small symbols, by the entries of the Jacobian.
static void truncate_by_matrix(struct ct_build *b, const struct small *s, const ct_ex *f,
                               size_t n, ct_ex *out)
{
    struct ct_slope *slope;
    const size_t nslope = expand(b, s, f, n, s->seed, out, &slope);
    for (size_t i = 0; i < nslope; i++)
        out[slope[i].row]
            = ct_ex_add(b->x, out[slope[i].row],
                        ct_ex_mul(b->x, slope[i].value, s->symbol[slope[i].direction]));
}

// The same by one directional derivative along x. Recursive sums along a beam stay recursive.
static void truncate_by_direction(struct ct_build *b, const struct small *s, const ct_ex *f,
                                  size_t n, ct_ex *out)
{
    struct ct_seed *seed = CT_NEWN(b->ctx->scratch, struct ct_seed, s->n + 1);
    ct_ex *along = CT_NEWN(b->ctx->scratch, ct_ex, s->n + 1);
    struct ct_slope *slope;
    for (size_t i = 0; i < s->n; i++) {
        along[i] = ct_ex_sym(b->x, CT_SYM_SEED, "along", (uint32_t)i);
        seed[i] = (struct ct_seed){s->symbol[i], 0, along[i]};
    }
    const size_t nslope = expand(b, s, f, n, seed, out, &slope);
    for (size_t i = 0; i < nslope; i++)
        out[slope[i].row] = ct_ex_add(b->x, out[slope[i].row], slope[i].value);
    ct_ex_subst_list(b->x, out, n, along, s->symbol, s->n);
}

static double cost_of(struct ct_build *b, const ct_ex *f, size_t n)
{
    const struct ct_tape_counts c = ct_ex_count(b->ctx->scratch, b->x, f, n);
    return ct_counted_cost(&c);
}

// Could sums over the entries of the Jacobian cost less than f (n) to first order? An entry takes
// two operations.
static bool may_be_sparse(struct ct_build *b, const struct small *s, const ct_ex *f, size_t n)
{
    struct ct_arena *scratch = b->ctx->scratch;
    struct ct_slope *entry;
    double unused;
    const size_t nentry = ct_ex_pattern(b->x, scratch, scratch, f, n, s->seed, s->n,
                                        (uint32_t)s->n, &entry, &unused);
    return 2 * (double)nentry < cost_of(b, f, n) + (double)n;
}

// f (n) to first order. With condensed rotations the Jacobian is full. The cheaper of both ways is
// taken.
static void truncate(struct ct_build *b, const struct small *s, ct_ex *f, size_t n)
{
    ct_ex *matrix = CT_NEWN(b->ctx->scratch, ct_ex, n + 1),
          *direction = s->has_condensation ? CT_NEWN(b->ctx->scratch, ct_ex, n + 1) : NULL;
    if (direction)
        truncate_by_direction(b, s, f, n, direction);
    const bool wants_matrix = !direction || may_be_sparse(b, s, direction, n);
    if (wants_matrix)
        truncate_by_matrix(b, s, f, n, matrix);
    const bool is_matrix
        = wants_matrix && (!direction || cost_of(b, matrix, n) <= cost_of(b, direction, n));
    memcpy(f, is_matrix ? matrix : direction, n * sizeof *f);
}

static bool is_between_small(const struct small *s, const struct ct_entry *m)
{
    return s->is_small[m->row] && s->is_small[m->column];
}

// Mass matrix: entries between small speeds are taken at zero. All are processed in one call,
// because each call traverses all expressions.
static void truncate_masses(struct ct_build *b, const struct small *s)
{
    struct ct_equations *e = b->eqs;
    ct_ex *large = CT_NEWN(b->ctx->scratch, ct_ex, e->nM + 1),
          *rest = CT_NEWN(b->ctx->scratch, ct_ex, e->nM + 1);
    size_t nlarge = 0, nrest = 0, kept = 0;
    for (size_t i = 0; i < e->nM; i++)
        if (is_between_small(s, &e->M[i]))
            rest[nrest++] = e->M[i].value;
        else
            large[nlarge++] = e->M[i].value;
    ct_ex_subst_list(b->x, rest, nrest, s->symbol, s->zero, s->n);
    truncate(b, s, large, nlarge);
    nlarge = nrest = 0;
    for (size_t i = 0; i < e->nM; i++) {
        struct ct_entry m = e->M[i];
        m.value = is_between_small(s, &m) ? rest[nrest++] : large[nlarge++];
        if (!ct_ex_is_zero(m.value))
            e->M[kept++] = m;
    }
    e->nM = kept;
}

bool ct_small_motion_is_wanted(const struct ct_build *b)
{
    for (size_t i = 0; i < b->nflexible; i++)
        if (b->flexible[i].formulation == CT_BEAM_STRETCH_LINEAR)
            return true;
    return b->model->simulation.small.given && b->model->simulation.small.n > 0;
}

bool ct_small_motion_derive(struct ct_build *b)
{
    struct small s = {0};
    if (!collect(b, &s))
        return false;
    if (!s.n)
        return true;
    b->eqs->is_small = s.is_small;
    truncate_masses(b, &s);
    truncate(b, &s, b->eqs->Q, b->eqs->nmotion);
    return true;
}

void ct_small_motion_momenta(struct ct_build *b, ct_ex *p)
{
    struct small s = {0};
    if (collect(b, &s) && s.n)
        truncate(b, &s, p, b->eqs->nmotion);
}
