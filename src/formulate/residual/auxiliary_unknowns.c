// See auxiliary_unknowns.h.
//
// The computational graph of r is reduced step by step (scarcity.h). For each degree of reduction
// the cost of factoring the extended matrix is predicted from its pattern. Too many auxiliary
// unknowns are as bad as too few.
#include "formulate/residual/auxiliary_unknowns.h"

#include "expr/scarcity.h"
#include "numeric/factors.h"
#include "numeric/inverse.h"

#include <math.h>
#include <string.h>

struct search {
    struct ct_build *b;
    struct ct_arena *a;
    const ct_ex *r;
    const struct ct_seed *seed;
    size_t nseed, nu, nrow;
};

// Pattern of a symmetric square matrix.
struct places {
    struct ct_arena *a;
    int *row, *column;
    size_t n, row_cap, column_cap;
};

static void add_entry(struct places *p, int row, int column)
{
    for (int k = 0; k < 2; k++) {
        size_t n = p->n;
        CT_PUSH(p->a, p->row, n, p->row_cap, k ? column : row);
        CT_PUSH(p->a, p->column, p->n, p->column_cap, k ? row : column);
    }
}

// Cost of assembly, one factorisation and the solutions of a step. An entry is a sum of three parts
// of a few terms.
static double work_of(double nz, double factorization, double fill)
{
    // Derived: an entry is a sum of three products with three loads, one each for positions, speeds
    // and accelerations
    const double assembly = 8;
    // Chosen: solutions per factorisation
    const double solutions = 8;
    return assembly * nz + factorization + solutions * 2 * fill;
}

static double full_work(double n)
{
    return work_of(n * n / 2, 2. / 3 * n * n * n, n * n);
}

// Cost with a matrix of these entries, the constraint rows and n unknowns.
static double sparse_work(const struct search *s, const int *row, const int *column,
                          size_t nentry, size_t n)
{
    const struct ct_equations *e = s->b->eqs;
    struct ct_arena *a = ct_arena_create_under(s->a);
    struct places p = {.a = a};
    const int size = (int)(n + 2 * s->nrow);
    for (size_t i = 0; i < nentry; i++)
        add_entry(&p, row[i], column[i]);
    for (size_t i = 0; i < 2 * e->nJ; i++) { // one multiplier for positions, one for speeds
        const struct ct_entry *J = &e->J[i / 2];
        add_entry(&p, (int)(n + (i % 2) * s->nrow) + J->row, J->column);
    }
    for (int i = 0; i < size; i++)
        add_entry(&p, i, i);
    int *place = CT_NEWN(a, int, p.n), *order = CT_NEWN(a, int, size + 1);
    struct ct_pattern *graph = ct_pattern_create(a, size, p.row, p.column, (int)p.n, place);
    const bool ok = ct_pattern_minimum_degree(graph, order);
    const double work
        = ok ? CT_SPARSE_OPERATION_COST * work_of(graph->nz, graph->operations, graph->fill)
             : INFINITY;
    ct_arena_destroy(a);
    return work;
}

// Cost without auxiliary unknowns.
static double plain_work(const struct search *s)
{
    struct ct_arena *a = ct_arena_create_under(s->a);
    struct ct_seed *seed = CT_NEWN(a, struct ct_seed, s->nseed + 1);
    struct ct_slope *entry;
    double operations;
    memcpy(seed, s->seed, s->nseed * sizeof *seed);
    for (size_t i = 0; i < s->nseed; i++)
        seed[i].direction %= (uint32_t)s->nu;
    const size_t n = ct_ex_pattern(s->b->x, a, a, s->r, s->nu, seed, s->nseed, (uint32_t)s->nu,
                                   &entry, &operations);
    int *row = CT_NEWN(a, int, n + 1), *column = CT_NEWN(a, int, n + 1);
    for (size_t i = 0; i < n; i++) {
        row[i] = (int)entry[i].row;
        column[i] = (int)entry[i].direction;
    }
    const double work = sparse_work(s, row, column, n, s->nu);
    ct_arena_destroy(a);
    return work;
}

// Cost with the remaining nodes of g as auxiliary unknowns.
static double thinned_work(const struct search *s, const struct ct_scarcity *g, size_t ninner)
{
    struct ct_arena *a = ct_arena_create_under(s->a);
    int *row, *column;
    const size_t n = ct_scarcity_entries(g, a, &row, &column);
    const double work = sparse_work(s, row, column, n, s->nu + ninner);
    ct_arena_destroy(a);
    return work;
}

// Takes the best of several degrees of reduction, if it costs less than `work`.
static size_t thin_out(const struct search *s, double work, ct_ex **inner)
{
    // Number of edges that the elimination of a node may add. Limit: of a search by doubling
    const long first = 4, last = 256;
    struct ct_scarcity *g
        = ct_scarcity_create(s->b->x, s->a, s->r, s->nu, s->seed, s->nseed, (uint32_t)s->nu);
    size_t nbest = 0;
    for (long most = first; most <= last; most *= 2) {
        ct_ex *node;
        ct_scarcity_thin(g, most);
        const size_t n = ct_scarcity_nodes(g, s->a, &node);
        const double now = n ? thinned_work(s, g, n) : INFINITY;
        if (now >= work)
            continue;
        work = now;
        *inner = node;
        nbest = n;
    }
    return nbest;
}

// Is the matrix expensive enough for a search? The search takes as long as a thousand steps with
// small full matrices.
static bool is_worth_a_search(const struct search *s, double work)
{
    // Limit: of the time of the search
    const double few = 40;
    return work > full_work(few) / few * (double)(s->nu + s->nrow);
}

size_t ct_auxiliary_unknowns_choose(struct ct_build *b, const ct_ex *r,
                                    const struct ct_seed *seed, size_t nseed, ct_ex **inner)
{
    const struct ct_equations *e = b->eqs;
    *inner = NULL;
    if (e->nu <= CT_MOST_INVERTED)
        return 0;
    const struct search s
        = {b, ct_arena_create_under(b->arena), r, seed, nseed, e->nu, e->nrow};
    const double full = full_work((double)(s.nu + 2 * s.nrow));
    const double least = is_worth_a_search(&s, full) ? fmin(plain_work(&s), full) : 0;
    ct_ex *found = NULL;
    const size_t n = is_worth_a_search(&s, least) ? thin_out(&s, least, &found) : 0;
    if (n) {
        *inner = CT_NEWN(b->arena, ct_ex, n);
        memcpy(*inner, found, n * sizeof *found);
    }
    ct_arena_destroy(s.a);
    return n;
}
