// See open_chain.h. Each formulation is generated and its operations are counted. One that is too
// expensive by the pattern of the mass matrix alone is not generated.
#include "formulate/recursive/open_chain.h"
#include "formulate/formulate.h"
#include "formulate/operation_count.h"
#include "formulate/recursive/articulated_body.h"
#include "formulate/recursive/composite_body.h"
#include "formulate/dynamics/dynamics.h"
#include "formulate/beam/flexible_body.h"

#include <math.h>

// Limit: operations of a program, because they take memory. Shorter programs have their loops
// rerolled (codegen/reroll.h); for longer ones a sparse solver is called.
static const double longest_program = 1e7;

static double cost_of(struct ct_build *b, const ct_ex *e, size_t n)
{
    const struct ct_tape_counts c = ct_ex_count(b->ctx->scratch, b->x, e, n);
    return ct_counted_cost(&c);
}

// ---- M u' = Q -----------------------------------------------------------------------------------

// A pivot, and its reciprocal if it divides more than two numbers: that is cheaper, but rounds
// twice.
struct pivot {
    ct_ex value, reciprocal;
};

// Entries of row k left of the diagonal that are not zero.
static size_t nonzeros_below(const struct ct_symmetric *H, size_t k)
{
    const struct ct_symmetric_place *p = H->row[k].place;
    size_t n = 0;
    for (size_t i = 0; i < H->row[k].n && p[i].column < k; i++)
        n += !ct_ex_is_zero(H->value[p[i].value]);
    return n;
}

static struct pivot take_pivot(struct ct_exs *x, const struct ct_symmetric *H, size_t k)
{
    struct pivot p = {ct_symmetric_get(H, k, k), CT_EX_ZERO};
    if (nonzeros_below(H, k) > 1)
        p.reciprocal = ct_ex_div(x, CT_EX_ONE, p.value);
    return p;
}

static ct_ex divide(struct ct_exs *x, ct_ex a, const struct pivot *p)
{
    return ct_ex_is_zero(p->reciprocal) ? ct_ex_div(x, a, p->value)
                                        : ct_ex_mul(x, a, p->reciprocal);
}

// M = L' D L from the last speed to the first, as straight-line code: speeds are numbered from
// ground outwards, so that this order causes no fill-in in a branched chain, and structural zeros
// cost nothing. M is positive definite, so that no pivoting is needed. H: M. Source: Featherstone
// (2008), key featherstone2008, 8.5.
static ct_ex *solve_symbolic(struct ct_build *b, struct ct_symmetric *H, const ct_ex *Q,
                             ct_ex *pivots)
{
    struct ct_exs *x = b->x;
    const size_t n = b->eqs->nu;
    struct pivot *pivot = CT_NEWN(b->arena, struct pivot, n + 1);
    ct_ex *u = CT_NEWN(b->arena, ct_ex, n + 1);
    // H becomes D on the diagonal and L (unit, lower) below
    for (size_t k = n; k-- > 0;) {
        pivot[k] = take_pivot(x, H, k);
        pivots[k] = pivot[k].value;
        const struct ct_symmetric_place *p = H->row[k].place;
        for (size_t i = H->row[k].n; i-- > 0;) {
            const ct_ex v = H->value[p[i].value];
            if (p[i].column >= k || ct_ex_is_zero(v))
                continue;
            const ct_ex a = divide(x, v, &pivot[k]);
            for (size_t j = 0; j <= i; j++)
                ct_symmetric_subtract(x, H, p[i].column, p[j].column,
                                      ct_ex_mul(x, a, H->value[p[j].value]));
            H->value[p[i].value] = a;
        }
    }
    for (size_t k = 0; k < n; k++)
        u[k] = Q[k];
    for (size_t k = n; k-- > 0;) // L' z = Q
        for (size_t i = 0; i < H->row[k].n && H->row[k].place[i].column < k; i++) {
            const struct ct_symmetric_place p = H->row[k].place[i];
            u[p.column] = ct_ex_sub(x, u[p.column], ct_ex_mul(x, H->value[p.value], u[k]));
        }
    for (size_t k = 0; k < n; k++) { // D y = z, L u = y
        u[k] = divide(x, u[k], &pivot[k]);
        for (size_t i = 0; i < H->row[k].n && H->row[k].place[i].column < k; i++) {
            const struct ct_symmetric_place p = H->row[k].place[i];
            u[k] = ct_ex_sub(x, u[k], ct_ex_mul(x, H->value[p.value], u[p.column]));
        }
    }
    return u;
}

// Operation count of the symbolic solution from the nonzeros of H; d: nonzeros in the row of pivot
// k.
static double symbolic_cost(const struct ct_symmetric *H)
{
    double cost = 0;
    for (size_t k = 0; k < H->n; k++) {
        const double d = (double)nonzeros_below(H, k);
        cost += d * d + 6 * d + 5;
    }
    return cost;
}

static double dense_cost(double n)
{
    return n * n * n / 3 + 2 * n * n + CT_DENSE_CALL_COST;
}

// ---- candidates ---------------------------------------------------------------------------------

struct trial {
    ct_ex *solution, *pivot;
    double cost; // INFINITY: not applicable
};

// Lower bound of the cost with a mass matrix: speeds are coupled only along a branch, which gives
// the nonzeros of the lower triangle.
static double least_matrix_cost(struct ct_build *b, const struct ct_members *s)
{
    const size_t n = b->eqs->nu;
    double *above = CT_NEWN(b->ctx->scratch, double, s->n), cost = 0, nonzeros = 0;
    for (size_t i = 1; i < s->n; i++) {
        const struct ct_member *m = &s->member[i];
        const bool is_root = m->beam && s->beam[m->beam - 1].root == (int)i;
        const int own = is_root ? b->flexible[m->beam - 1].nelastic : m->beam ? 0 : m->nfree;
        above[i] = above[m->parent] + own;
        const bool is_band = m->beam && b->flexible[m->beam - 1].kinematics != CT_AXIAL_CHAIN;
        for (int k = 0; k < own; k++) { // in a band more entries may be zero
            const double d = above[m->parent] + (is_band ? 0 : k);
            cost += d * d + 6 * d + 5;
            nonzeros += d + 1;
        }
    }
    return fmin(cost, dense_cost((double)n)) + 2 * nonzeros;
}

static struct trial try_matrix(struct ct_build *b, struct ct_symmetric *H, const ct_ex *Q)
{
    const size_t n = b->eqs->nu;
    ct_ex *all = NULL; // M and Q
    size_t k = 0, cap = 0;
    for (size_t i = 0; i < H->nvalue; i++)
        CT_PUSH(b->ctx->scratch, all, k, cap, H->value[i]);
    for (size_t i = 0; i < n; i++)
        CT_PUSH(b->ctx->scratch, all, k, cap, Q[i]);
    const double symbolic = symbolic_cost(H), dense = dense_cost((double)n);
    // there are at least as many nodes as operations: count operations only for very many nodes
    const double most = (double)b->x->nnode + symbolic;
    const bool is_short = symbolic < dense && most < longest_program;
    const double assembly = is_short ? 0 : cost_of(b, all, k);
    struct trial t = {NULL, NULL, assembly + dense};
    if (is_short || (symbolic < dense && assembly + symbolic < longest_program)) {
        t.pivot = CT_NEWN(b->arena, ct_ex, n + 1);
        t.solution = solve_symbolic(b, H, Q, t.pivot);
        t.cost = cost_of(b, t.solution, n);
    }
    return t;
}

static struct trial try_cutsets(struct ct_build *b)
{
    const struct ct_equations *e = b->eqs;
    struct ct_arena *work = ct_arena_create_under(b->ctx->scratch);
    ct_dynamics_derive(b);
    struct ct_symmetric H = ct_symmetric_create(work, e->nu);
    for (size_t i = 0; i < e->nM; i++)
        *ct_symmetric_at(&H, (size_t)e->M[i].row, (size_t)e->M[i].column) = e->M[i].value;
    const struct trial t = try_matrix(b, &H, e->Q);
    ct_arena_destroy(work);
    return t;
}

static struct trial try_composite(struct ct_build *b, const struct ct_members *s)
{
    struct ct_arena *work = ct_arena_create_under(b->ctx->scratch);
    struct ct_symmetric H = ct_symmetric_create(work, b->eqs->nu);
    ct_ex *Q = CT_NEWN(b->arena, ct_ex, b->eqs->nu + 1);
    ct_composite_derive(b, s, b->loads->effort, &H, Q);
    struct trial t = try_matrix(b, &H, Q);
    ct_arena_destroy(work);
    if (!t.solution)
        t.cost = INFINITY; // a solver call uses M and Q of the equations
    return t;
}

static struct trial try_articulated(struct ct_build *b, const struct ct_members *s)
{
    ct_ex *pivot = CT_NEWN(b->arena, ct_ex, b->eqs->nu + 1),
          *u = ct_articulated_solve(b, s, b->loads->effort, pivot);
    return (struct trial){u, pivot, cost_of(b, u, b->eqs->nu)};
}

// The mass matrix is the readable form and the most accurate one. Another form must be clearly
// cheaper.

double ct_open_cost(struct ct_build *b, double by_matrix)
{
    const struct ct_members *s = b->eqs->nrow ? NULL : ct_members_derive(b);
    const double articulated = s ? try_articulated(b, s).cost : INFINITY;
    return articulated < CT_CLEARLY_CHEAPER * by_matrix ? articulated : by_matrix;
}

static enum ct_formulation cheapest(const struct trial *t, enum ct_formulation wanted)
{
    enum ct_formulation best = CT_FORMULATION_CUTSETS;
    if (wanted != CT_FORMULATION_AUTO && isfinite(t[wanted].cost))
        return wanted;
    for (int k = CT_FORMULATION_CUTSETS; k < CT_NFORMULATION; k++)
        if (t[k].cost
            < (best == CT_FORMULATION_CUTSETS ? CT_CLEARLY_CHEAPER : 1) * t[best].cost)
            best = (enum ct_formulation)k;
    return best;
}

void ct_open_solve(struct ct_build *b, enum ct_formulation which)
{
    struct ct_equations *e = b->eqs;
    struct trial t[CT_NFORMULATION];
    const bool tries_members = which == CT_FORMULATION_AUTO || which > CT_FORMULATION_CUTSETS;
    const struct ct_members *s = tries_members ? ct_members_derive(b) : NULL;
    for (int k = 0; k < CT_NFORMULATION; k++)
        t[k] = (struct trial){NULL, NULL, INFINITY};
    if (s && which != CT_FORMULATION_COMPOSITE)
        t[CT_FORMULATION_ARTICULATED] = try_articulated(b, s);
    const double known = t[CT_FORMULATION_ARTICULATED].cost;
    const bool by_matrix = e->nu <= CT_SMALL_SYSTEM || !s || least_matrix_cost(b, s) < known;
    if (by_matrix && s && !s->nbeam && which != CT_FORMULATION_ARTICULATED
        && !b->topology->is_planar)
        t[CT_FORMULATION_COMPOSITE] = try_composite(b, s);
    // in space body axes always need fewer operations than ground axes
    if (by_matrix && !isfinite(t[CT_FORMULATION_COMPOSITE].cost))
        t[CT_FORMULATION_CUTSETS] = try_cutsets(b);
    e->formulation = cheapest(t, which);
    e->solution = t[e->formulation].solution;
    e->pivot = t[e->formulation].pivot;
    for (int k = 0; k < CT_NFORMULATION; k++)
        e->formulation_cost[k] = t[k].cost;
}
