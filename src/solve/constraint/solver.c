// See solver.h.
#include "solve/constraint/solver.h"

#include "formulate/operation_count.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Limit: nodes of the expressions of a symbolic solver; with more another solver is used. A
// node takes about a microsecond and half a kilobyte: two seconds and a gigabyte in all.
static const double most_nodes = 2e6;
// Limit: the same where the caller requests a symbolic solver.
static const double most_requested_nodes = 8e6;
// Ratio of the nodes of all programs, checks and projections included, to those of the
// solution.
// Default: about the largest ratio; a symbolic solver with more nodes is not made. Test:
// solvers
static const double all_programs_ratio = 4;
// The symbolic solver of [M J'; J 0] is made if its predicted cost is below this fraction of
// the others'.
// Default: the time to make it against the time that it saves. Test: solvers
static const double kkt_cost_ratio = 0.9;

static int ascending(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

static int *sorted(struct ct_arena *a, const int *v, size_t n)
{
    int *copy = CT_NEWN(a, int, n + 1);
    memcpy(copy, v, n * sizeof *copy);
    qsort(copy, n, sizeof *copy, ascending);
    return copy;
}

// The cheaper of two solvers; the other is destroyed. Either may be NULL.
static struct ct_solver *cheaper(struct ct_evaluator *m, struct ct_solver *a,
                                 struct ct_solver *b)
{
    if (!a || !b)
        return a ? a : b;
    const bool first = a->cost <= b->cost;
    ct_solver_destroy(m, first ? b : a);
    return first ? a : b;
}

double ct_solver_code_size(double operations)
{
    // Bytes of machine code per operation. Derived: measured on lattices and nets, 10 to 11.6.
    const double bytes = 11;
    return bytes * operations;
}

// Straight-line code is read once per evaluation. The second-level cache, which code and data
// share, holds programs up to `near` bytes completely and almost nothing of programs beyond
// `far` bytes. A byte outside it takes the time of `per_byte` operations.
double ct_solver_straight_cost(double operations, double bytes)
{
    // Derived: measured on lattices and nets of 110 to 2000 unknowns, on processors with 2 MiB of
    // that cache (docs/performance.md).
    const double near = 1 << 20, far = 3 << 20, per_byte = 0.33;
    const double missed = fmin(1, fmax(0, (bytes - near) / (far - near)));
    return operations + per_byte * missed * bytes;
}

// The largest number of operations of straight-line code that cost no more than `cost`.
static double longest(double cost)
{
    double low = 0, high = cost; // low costs less, high as much or more
    while (high - low > 1) {
        const double middle = (low + high) / 2;
        *(ct_solver_straight_cost(middle, ct_solver_code_size(middle)) < cost ? &low : &high)
            = middle;
    }
    return high;
}

static double cost_of(const struct ct_solver *f)
{
    return f ? f->cost : INFINITY;
}

// The largest number of nodes with which a symbolic solver is cheaper than one of this cost.
static double most_nodes_of(double cost)
{
    return fmin(all_programs_ratio * longest(fmin(cost, most_nodes)), most_nodes);
}

const double *ct_solver_values(struct ct_arena *a, const struct ct_evaluator *m)
{
    if (!m->e->augmented)
        return NULL;
    double *value = CT_NEWN(a, double, m->e->x->nsym + 1);
    ct_evaluator_values(m, m->e->x, value);
    return value;
}

// The cheapest solver other than dense matrices; fills the costs c (dense is given).
static struct ct_solver *compare(struct ct_arena *a, struct ct_evaluator *m,
                                 const struct ct_partition_sets *partition,
                                 struct ct_solver_costs *c)
{
    struct ct_arena *own = ct_arena_create_under(a);
    struct ct_partition_sets p = *partition;
    struct ct_solver *f = NULL;
    p.value = ct_solver_values(own, m);
    if (p.nfree) {
        p.pivots = ct_pivot_order_find(own, m->e, &p, m->motion.out, m->Q + m->nu, most_nodes);
        p.has_no_pivots = !p.pivots;
    }
    if (p.pivots) {
        const double operations = ct_solver_operations(&m->motion) + p.pivots->operations;
        c->symbolic_kkt = ct_solver_straight_cost(operations, ct_solver_code_size(operations));
    }
    if (m->nu + p.rank >= CT_FEWEST_SPARSE_UNKNOWNS) {
        f = ct_solver_sparse.create(a, m, &p, 0);
        c->sparse = cost_of(f);
    }
    const double others = fmin(c->dense, fmin(c->sparse, c->symbolic_kkt));
    struct ct_solver *symbolic = ct_solver_symbolic.create(a, m, &p, most_nodes_of(others));
    c->symbolic = cost_of(symbolic);
    f = cheaper(m, f, symbolic);
    if (c->symbolic_kkt < kkt_cost_ratio * (f ? f->cost : c->dense))
        f = cheaper(m, f,
                    ct_solver_symbolic_kkt.create(a, m, &p, most_nodes_of(c->symbolic_kkt)));
    ct_arena_destroy(own);
    return f;
}

struct ct_solver *ct_solver_create(struct ct_arena *a, struct ct_evaluator *m,
                                   const struct ct_partition_sets *p, double operations,
                                   const struct ct_solver_kind *kind,
                                   struct ct_solver_costs *costs)
{
    struct ct_solver_costs c = {.symbolic = NAN, .symbolic_kkt = NAN, .sparse = NAN};
    c.dense = ct_solver_operations(&m->motion) + operations + CT_DENSE_CALL_COST;
    struct ct_solver *f = kind ? kind->create(a, m, p, most_nodes) : compare(a, m, p, &c);
    if (f && !kind && f->cost > c.dense) {
        ct_solver_destroy(m, f);
        f = NULL;
    }
    if (costs)
        *costs = c;
    return f;
}

struct ct_solver *ct_solver_create_within(struct ct_arena *a, struct ct_evaluator *m,
                                          const struct ct_partition_sets *p,
                                          const struct ct_solver_kind *kind, double cost)
{
    return kind->create(a, m, p, most_nodes_of(cost));
}

struct ct_solver *ct_solver_create_any_length(struct ct_arena *a, struct ct_evaluator *m,
                                              const struct ct_partition_sets *p,
                                              const struct ct_solver_kind *kind)
{
    return kind->create(a, m, p, most_requested_nodes);
}

void ct_solver_set_partition(struct ct_solver *f, const struct ct_partition_sets *p)
{
    f->row = sorted(f->arena, p->row, p->rank);
    f->dependent = sorted(f->arena, p->dependent, p->rank);
    f->rank = p->rank;
}

void ct_solver_destroy(struct ct_evaluator *m, struct ct_solver *f)
{
    if (f->kind->destroy)
        f->kind->destroy(f, m);
    ct_arena_destroy(f->arena);
}

static bool holds(const int *sorted_list, size_t n, const int *v)
{
    for (size_t i = 0; i < n; i++)
        if (!bsearch(&v[i], sorted_list, n, sizeof *v, ascending))
            return false;
    return true;
}

bool ct_solver_matches(const struct ct_solver *f, const struct ct_partition_sets *p)
{
    return f->rank == p->rank && holds(f->row, f->rank, p->row)
        && holds(f->dependent, f->rank, p->dependent);
}

double ct_solver_operations(const struct ct_program *p)
{
    const struct ct_tape_counts c = p->listing->counts;
    return (double)(c.multiplications + c.additions + c.divisions + c.functions);
}

double ct_solver_solve(struct ct_solver *f, struct ct_evaluator *m, double *a)
{
    return f->kind->solve(f, m, a);
}

void ct_solver_check(struct ct_solver *f, struct ct_evaluator *m)
{
    f->kind->check(f, m);
}

double ct_solver_close(struct ct_solver *f, struct ct_evaluator *m)
{
    return f->kind->close(f, m);
}
