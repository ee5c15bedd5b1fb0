// See tree_selection.h: operation count to evaluate and solve the equations of a pair of trees.
#include "formulate/topology/tree_selection.h"

#include "expr/tape.h"
#include "formulate/operation_count.h"

// Graph of a symmetric matrix during elimination.
struct minor {
    size_t n;
    bool *near;     // n x n
    size_t *degree; // number of remaining neighbours; SIZE_MAX: eliminated
};

static void join(struct minor *g, size_t i, size_t j)
{
    if (i == j || g->near[i + g->n * j])
        return;
    g->near[i + g->n * j] = g->near[j + g->n * i] = true;
    g->degree[i]++;
    g->degree[j]++;
}

static struct minor minor_of(struct ct_arena *scratch, const struct ct_equations *e)
{
    const size_t n = e->nu + e->nrow;
    struct minor g = {n, CT_NEWN(scratch, bool, n *n + 1), CT_NEWN(scratch, size_t, n + 1)};
    for (size_t i = 0; i < e->nM; i++)
        join(&g, (size_t)e->M[i].row, (size_t)e->M[i].column);
    for (size_t i = 0; i < e->nJ; i++)
        join(&g, e->nu + (size_t)e->J[i].row, (size_t)e->J[i].column);
    return g;
}

static size_t least_degree(const struct minor *g)
{
    size_t best = 0;
    for (size_t i = 1; i < g->n; i++)
        if (g->degree[i] < g->degree[best])
            best = i;
    return best;
}

// Operations of a sparse LDL' of [M J'; J 0] by minimum degree on its graph: sum of d^2 + 4 d + 3.
static double factor_cost(struct ct_arena *scratch, const struct ct_equations *e)
{
    const size_t n = e->nu + e->nrow;
    if (n > 4000) // the adjacency matrix would be too large
        return (double)n * (double)n * (double)n / 3;
    struct minor g = minor_of(scratch, e);
    double cost = 0;
    size_t *list = CT_NEWN(scratch, size_t, n + 1);
    for (size_t step = 0; step < n; step++) {
        const size_t best = least_degree(&g);
        size_t d = 0;
        for (size_t j = 0; j < n; j++)
            if (g.near[j + n * best] && g.degree[j] != SIZE_MAX) {
                list[d++] = j;
                g.degree[j]--;
            }
        g.degree[best] = SIZE_MAX;
        for (size_t i = 0; i < d; i++)
            for (size_t j = 0; j < i; j++)
                join(&g, list[i], list[j]);
        cost += (double)(d * d + 4 * d + 3);
    }
    return cost;
}

double ct_equations_cost(struct ct_arena *scratch, const struct ct_equations *e)
{
    const size_t n = e->nM + e->nu + e->nJ + e->nrow;
    ct_ex *all = CT_NEWN(scratch, ct_ex, n + 1);
    size_t k = 0;
    for (size_t i = 0; i < e->nM; i++)
        all[k++] = e->M[i].value;
    for (size_t i = 0; i < e->nu; i++)
        all[k++] = e->Q[i];
    for (size_t i = 0; i < e->nJ; i++)
        all[k++] = e->J[i].value;
    for (size_t i = 0; i < e->nrow; i++)
        all[k++] = e->row[i].gam;
    const struct ct_tape_counts c = ct_ex_count(scratch, e->x, all, k);
    // In multiplications: the vector operations of a multi-stage integrator.
    // Default: weight of the number of speeds against the length of the equations.
    // Test: operation_counts
    const double per_speed = 20;
    return ct_counted_cost(&c) + per_speed * (double)e->nu + factor_cost(scratch, e);
}
