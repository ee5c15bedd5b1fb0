// See residual.h.
//
// Coordinates are varied along the directions of the speeds: dq_i = sum_k Z_ik de_k with q' =
// Z(q) u. For a plain coordinate that is the coordinate itself, for a quaternion a body rotation.
#include "formulate/residual/residual.h"
#include "formulate/recursive/composite_body.h"
#include "formulate/residual/auxiliary_unknowns.h"
#include "formulate/operation_count.h"

#include <string.h>

// Groups of seed directions: position, speed and u' along each speed k, then auxiliary unknowns.
enum { POSITION, SPEED, ACCELERATION, INNER, NLEVEL = INNER };

struct seeds {
    struct ct_arena *a; // NULL: scratch
    struct ct_seed *e;
    size_t n, cap;
};

static void add_seed(struct ct_build *b, struct seeds *s, ct_ex symbol, size_t direction,
                     ct_ex value)
{
    const struct ct_seed seed = {symbol, (uint32_t)direction, value};
    CT_PUSH(s->a ? s->a : b->ctx->scratch, s->e, s->n, s->cap, seed);
}

static size_t direction(const struct ct_build *b, int level, size_t speed)
{
    return (size_t)level * b->eqs->nu + speed;
}

// Adds the seeds of the coordinates: the entries of Z.
static void add_position_seeds(struct ct_build *b, struct seeds *s)
{
    const struct ct_equations *e = b->eqs;
    struct ct_arena *scratch = b->ctx->scratch;
    struct seeds speeds = {0};
    struct ct_slope *Z;
    ct_ex *rate = CT_NEWN(scratch, ct_ex, e->nq + 1);
    for (size_t i = 0; i < e->nq; i++)
        rate[i] = e->q[i].rate;
    for (size_t k = 0; k < e->nu; k++)
        add_seed(b, &speeds, e->u[k].symbol, k, CT_EX_ONE);
    const size_t nZ
        = ct_ex_jacobian(b->x, scratch, scratch, rate, e->nq, speeds.e, speeds.n, &Z);
    for (size_t i = 0; i < nZ; i++)
        add_seed(b, s, e->q[Z[i].row].symbol, direction(b, POSITION, Z[i].direction),
                 Z[i].value);
}

// Picks the entries of one group; their directions are then counted from 0.
static size_t pick(struct ct_build *b, const struct ct_slope *all, size_t n, int level,
                   struct ct_slope **out)
{
    size_t nout = 0, cap = 0;
    *out = NULL;
    for (size_t i = 0; i < n; i++) {
        struct ct_slope s = all[i];
        const size_t first = direction(b, level, 0);
        if (s.direction < first || (level < INNER && s.direction >= first + b->eqs->nu))
            continue;
        s.direction -= (uint32_t)first;
        CT_PUSH(b->arena, *out, nout, cap, s);
    }
    return nout;
}

// M u' - Q - J' lam, where M and Q differ from those of the sweep (truncated equations).
static void assemble_rows(struct ct_build *b, ct_ex *r)
{
    const struct ct_equations *e = b->eqs;
    struct ct_exs *x = b->x;
    for (size_t k = 0; k < e->nu; k++)
        r[k] = ct_ex_neg(x, e->Q[k]);
    for (size_t i = 0; i < e->nM; i++) {
        const int k = e->M[i].row, l = e->M[i].column;
        r[k] = ct_ex_add(x, r[k], ct_ex_mul(x, e->M[i].value, e->u[l].derivative));
        if (k != l)
            r[l] = ct_ex_add(x, r[l], ct_ex_mul(x, e->M[i].value, e->u[k].derivative));
    }
    for (size_t i = 0; i < e->nJ; i++) {
        const int k = e->J[i].column;
        r[k] = ct_ex_sub(x, r[k], ct_ex_mul(x, e->J[i].value, e->row[e->J[i].row].lam));
    }
}

// Derives r by the sweep in ground axes or, in space, by inverse dynamics in body axes, whichever
// needs fewer operations.
static void derive_rows(struct ct_build *b, ct_ex *r)
{
    const size_t n = b->eqs->nu;
    const struct ct_members *s
        = b->topology->is_planar || b->nflexible ? NULL : ct_members_derive(b);
    for (size_t k = 0; k < n; k++)
        r[k] = ct_sweep_residual(b, (int)k);
    if (!s)
        return;
    ct_ex *by_members = CT_NEWN(b->ctx->scratch, ct_ex, n + 1);
    ct_composite_residual(b, s, b->loads->effort, by_members);
    const struct ct_tape_counts recursive = ct_ex_count(b->ctx->scratch, b->x, r, n),
                                other = ct_ex_count(b->ctx->scratch, b->x, by_members, n);
    for (size_t k = 0; k < n && ct_counted_cost(&other) < ct_counted_cost(&recursive); k++)
        r[k] = by_members[k];
}

// ---- derivatives --------------------------------------------------------------------------------

// Time of the predicted evaluations of a run over that of generating a program (nodes, listing,
// machine code). Chosen: 300 evaluations, where generation takes as long as 1500.
static const double expected_use = 0.2;

// Common input of both ways: r followed by the auxiliary unknowns, v, and the seeds.
struct slopes {
    ct_ex *r, *v;
    size_t nu, ninner, nr, nrow; // nr: nu + ninner
    struct seeds all;
    size_t nplace; // of the seeds
};

static void add_all_seeds(struct ct_build *b, struct slopes *s)
{
    const struct ct_equations *e = b->eqs;
    add_position_seeds(b, &s->all);
    s->nplace = s->all.n;
    for (size_t k = 0; k < e->nu; k++) {
        add_seed(b, &s->all, e->u[k].symbol, direction(b, SPEED, k), CT_EX_ONE);
        add_seed(b, &s->all, e->u[k].derivative, direction(b, ACCELERATION, k), CT_EX_ONE);
    }
}

static void sort_out(struct ct_build *b, struct ct_residual *f, const struct ct_slope *all,
                     size_t n)
{
    f->ndq = pick(b, all, n, POSITION, &f->dq);
    f->ndu = pick(b, all, n, SPEED, &f->du);
    f->nda = pick(b, all, n, ACCELERATION, &f->da);
    f->ndk = pick(b, all, n, INNER, &f->dk);
}

// Derives each entry as an expression.
static void derive_entries(struct ct_build *b, struct ct_residual *f, const struct slopes *s)
{
    struct ct_arena *scratch = b->ctx->scratch;
    struct ct_slope *all;
    const size_t n
        = ct_ex_jacobian(b->x, scratch, scratch, s->r, s->nr, s->all.e, s->all.n, &all);
    sort_out(b, f, all, n);
    f->ndv
        = ct_ex_jacobian(b->x, scratch, b->arena, s->v, s->nrow, s->all.e, s->nplace, &f->dv);
}

// The derivative of one expression along the seeds, whose values are symbols.
static ct_ex derivative_along(struct ct_build *b, ct_ex f, const struct seeds *s)
{
    struct ct_slope *d;
    return ct_ex_jacobian(b->x, b->ctx->scratch, b->ctx->scratch, &f, 1, s->e, s->n, &d)
             ? d->value
             : CT_EX_ZERO;
}

// Derives r' and v' along one direction of positions, speeds and accelerations, whose components
// are inputs.
static struct ct_directional *derive_along(struct ct_build *b, const struct slopes *s)
{
    const struct ct_equations *e = b->eqs;
    struct ct_directional *along = CT_NEW(b->arena, struct ct_directional);
    const size_t nu = e->nu, n = NLEVEL * nu + s->ninner;
    struct seeds seeds = {0};
    ct_ex *speed = CT_NEWN(b->ctx->scratch, ct_ex, nu + 1);
    along->nseed = n;
    along->seed = CT_NEWN(b->arena, ct_ex, n + 1);
    along->rate = CT_NEWN(b->arena, ct_ex, s->nr + e->nrow + 1);
    for (size_t k = 0; k < n; k++)
        along->seed[k] = ct_ex_sym(b->x, CT_SYM_SEED, "d", (uint32_t)k);
    for (size_t k = 0; k < nu; k++)
        speed[k] = e->u[k].symbol;
    for (size_t i = 0; i < e->nq; i++) // q' = Z(q) u
        add_seed(b, &seeds, e->q[i].symbol, 0,
                 ct_ex_subst(b->x, e->q[i].rate, speed, along->seed, nu));
    const size_t nplace = seeds.n;
    for (size_t k = 0; k < nu; k++) {
        add_seed(b, &seeds, e->u[k].symbol, 0, along->seed[nu + k]);
        add_seed(b, &seeds, e->u[k].derivative, 0, along->seed[2 * nu + k]);
    }
    for (size_t k = 0; k < s->ninner; k++)
        add_seed(b, &seeds, s->r[nu + k], 0, along->seed[NLEVEL * nu + k]);
    struct ct_slope *d;
    const size_t nr = ct_ex_jacobian(b->x, b->ctx->scratch, b->ctx->scratch, s->r, s->nr,
                                     seeds.e, seeds.n, &d);
    for (size_t i = 0; i < nr; i++)
        along->rate[d[i].row] = d[i].value;
    seeds.n = nplace;
    for (size_t i = 0; i < e->nrow; i++)
        along->rate[s->nr + i] = derivative_along(b, s->v[i], &seeds);
    return along;
}

// ---- colours ------------------------------------------------------------------------------------

// Entries by direction: entry[start[d] ... start[d + 1]) are the rows of direction d.
struct columns {
    size_t *start;
    uint32_t *row;
};

static struct columns list_columns(struct ct_arena *a, const struct ct_slope *s, size_t n,
                                   size_t ndirection)
{
    struct columns c = {CT_NEWN(a, size_t, ndirection + 2), CT_NEWN(a, uint32_t, n + 1)};
    for (size_t i = 0; i < n; i++)
        c.start[s[i].direction + 2]++;
    for (size_t d = 2; d < ndirection + 2; d++)
        c.start[d] += c.start[d - 1];
    for (size_t i = 0; i < n; i++)
        c.row[c.start[s[i].direction + 1]++] = s[i].row;
    return c;
}

// Directions of one colour have no row in common, so that one derivative along their sum gives all
// their entries. Greedy colouring in the order of the directions. Source: Curtis, Powell and Reid
// (1974), key curtis1974.
static void colour(struct ct_build *b, struct ct_directional *along, const struct ct_slope *s,
                   size_t n, size_t nrow)
{
    struct ct_arena *scratch = b->ctx->scratch;
    const struct columns c = list_columns(scratch, s, n, along->nseed);
    size_t *first = CT_NEWN(scratch, size_t, nrow + 2);             // slopes are sorted by row
    uint32_t *taken = CT_NEWN(scratch, uint32_t, along->nseed + 1); // by colour: 1 + direction
    along->colour = CT_NEWN(b->arena, uint32_t, along->nseed + 1);
    for (size_t i = 0; i < n; i++)
        first[s[i].row + 1]++;
    for (size_t r = 0; r < nrow; r++)
        first[r + 1] += first[r];
    for (uint32_t d = 0; d < along->nseed; d++) {
        if (c.start[d] == c.start[d + 1])
            continue;
        for (size_t k = c.start[d]; k < c.start[d + 1]; k++)
            for (size_t i = first[c.row[k]]; s[i].direction < d; i++)
                taken[along->colour[s[i].direction]] = d + 1;
        uint32_t mine = 0;
        while (taken[mine] == d + 1)
            mine++;
        along->colour[d] = mine;
        if (mine >= along->ncolour)
            along->ncolour = mine + 1;
    }
}

static double cost_along(struct ct_build *b, const struct ct_directional *along, size_t nrate)
{
    const struct ct_tape_counts c = ct_ex_count(b->ctx->scratch, b->x, along->rate, nrate);
    return ct_counted_cost(&c) * (1 + expected_use * CT_LANE_COST * (double)along->ncolour);
}

// Entries of the longest row of a list sorted by row.
static double longest_row(const struct ct_slope *s, size_t n)
{
    size_t most = 0;
    for (size_t first = 0, i = 0; i < n; i++) {
        first = s[i].row == s[first].row ? first : i;
        most = i - first >= most ? i - first + 1 : most;
    }
    return (double)most;
}

// Derives along directions if that is requested or cheaper than entry by entry. True: done.
static bool try_along(struct ct_build *b, struct ct_residual *f, const struct slopes *s,
                      enum ct_slope_form form)
{
    struct ct_arena *scratch = b->ctx->scratch;
    struct ct_slope *all, *more;
    double operations, more_operations;
    const size_t ndirection = NLEVEL * s->nu + s->ninner;
    size_t n = ct_ex_pattern(b->x, scratch, scratch, s->r, s->nr, s->all.e, s->all.n,
                             (uint32_t)ndirection, &all, &operations);
    const double entries = operations * (1 + expected_use);
    // the derivative along a direction takes no fewer operations than r, for as many colours as
    // the longest row has entries
    const struct ct_tape_counts c = ct_ex_count(scratch, b->x, s->r, s->nu);
    const double executions = expected_use * CT_LANE_COST * longest_row(all, n);
    if (form == CT_SLOPES_AUTO && entries < (2 + executions) * ct_counted_cost(&c))
        return false;
    struct ct_directional *along = derive_along(b, s);
    sort_out(b, f, all, n);
    f->ndv = ct_ex_pattern(b->x, scratch, b->arena, s->v, s->nrow, s->all.e, s->nplace,
                           (uint32_t)ndirection, &f->dv, &more_operations);
    more = CT_NEWN(scratch, struct ct_slope, n + f->ndv + 1);
    if (n)
        memcpy(more, all, n * sizeof *more);
    for (size_t i = 0; i < f->ndv; i++, n++) {
        more[n] = f->dv[i];
        more[n].row += (uint32_t)s->nr;
    }
    colour(b, along, more, n, s->nr + s->nrow);
    if (form == CT_SLOPES_AUTO && cost_along(b, along, s->nr + s->nrow) > entries)
        return false;
    f->along = along;
    return true;
}

size_t ct_residual_seeds(struct ct_build *b, struct ct_arena *a, struct ct_seed **out,
                         size_t *nplace)
{
    struct slopes s = {.all = {.a = a}};
    add_all_seeds(b, &s);
    *nplace = s.nplace;
    *out = s.all.e;
    return s.all.n;
}

void ct_residual_rows(struct ct_build *b)
{
    struct ct_equations *e = b->eqs;
    if (e->residual)
        return;
    e->residual = CT_NEW(b->arena, struct ct_residual);
    e->residual->r = CT_NEWN(b->arena, ct_ex, e->nu + 1);
    if (e->is_small)
        assemble_rows(b, e->residual->r);
    else
        derive_rows(b, e->residual->r);
}

// Appends the auxiliary unknowns of f to the rows and to the seeds.
static void add_inner(struct ct_build *b, struct ct_residual *f, struct slopes *s)
{
    f->nauxiliary = ct_auxiliary_unknowns_choose(b, f->r, s->all.e, s->all.n, &f->auxiliary);
    s->ninner = f->nauxiliary;
    s->nr = s->nu + s->ninner;
    s->r = CT_NEWN(b->ctx->scratch, ct_ex, s->nr + 1);
    memcpy(s->r, f->r, s->nu * sizeof *s->r);
    for (size_t k = 0; k < s->ninner; k++) {
        s->r[s->nu + k] = f->auxiliary[k];
        add_seed(b, &s->all, f->auxiliary[k], direction(b, INNER, k), CT_EX_ONE);
    }
}

void ct_residual_derive(struct ct_build *b, enum ct_slope_form form)
{
    const struct ct_equations *e = b->eqs;
    struct slopes s = {.nu = e->nu, .nrow = e->nrow};
    ct_residual_rows(b);
    struct ct_residual *f
        = CT_NEW(b->arena, struct ct_residual); // an earlier one does not change
    *f = (struct ct_residual){.r = e->residual->r, .has_slopes = true};
    b->eqs->residual = f;
    s.v = CT_NEWN(b->ctx->scratch, ct_ex, e->nrow + 1);
    for (size_t i = 0; i < e->nrow; i++)
        s.v[i] = e->row[i].v;
    add_all_seeds(b, &s);
    add_inner(b, f, &s);
    if (form == CT_SLOPES_ENTRIES || !try_along(b, f, &s, form))
        derive_entries(b, f, &s);
}

size_t ct_slopes_derive(struct ct_build *b, struct ct_arena *a, const ct_ex *f, size_t nf,
                        const ct_ex *more, size_t nmore, struct ct_slope **out)
{
    struct ct_equations *e = b->eqs;
    struct seeds seeds = {0};
    size_t nplace;
    seeds.n = seeds.cap = ct_residual_seeds(b, b->ctx->scratch, &seeds.e, &nplace);
    const size_t first = direction(b, NLEVEL, 0);
    for (size_t i = 0; i < e->nrow; i++)
        add_seed(b, &seeds, e->row[i].lam, first + i, CT_EX_ONE);
    for (size_t i = 0; i < nmore; i++)
        add_seed(b, &seeds, more[i], first + e->nrow + i, CT_EX_ONE);
    return ct_ex_jacobian(b->x, b->ctx->scratch, a, f, nf, seeds.e, seeds.n, out);
}
