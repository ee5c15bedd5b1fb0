// See form.h.
#include "solve/form.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A call of a solver for dense matrices costs about as much as so many operations of straight-line code.
static const double call = 500;
// Making programs takes a microsecond and half a kilobyte a node.
static const double most_nodes = 2e6;
// Where somebody wants them whatever they cost.
static const double most_asked_nodes = 8e6;
// Checks and projections take up to so many times the nodes of the solution.
static const double programs = 4;
// Solving all equations as one system must promise so much to be tried.
static const double worth = 0.9;
// Beyond so many unknowns finding its order takes too long.
enum { MOST_WHOLE = 3000 };

const double ct_form_weakest = 1e-3;

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

// Of both, the cheaper one; the other is destroyed.
static struct ct_form *cheaper(struct ct_machine *m, struct ct_form *a, struct ct_form *b)
{
    if (!a || !b)
        return a ? a : b;
    const bool first = a->cost <= b->cost;
    ct_form_destroy(m, first ? b : a);
    return first ? a : b;
}

double ct_form_code_size(double operations)
{
    const double bytes = 11; // lattices and nets: 10 to 11.6
    return bytes * operations;
}

// Code is read once in an evaluation. The second of the caches, which it shares with data, keeps all of a program up to
// `near` and next to nothing of one beyond `far`; a byte from behind it takes as long as a third of an operation. Measured
// on lattices and nets of 110 to 2000 unknowns, processors with 2 MiB of that cache: docs/performance.md.
double ct_form_straight_cost(double operations, double bytes)
{
    const double near = 1 << 20, far = 3 << 20, per_byte = 0.33;
    const double missed = fmin(1, fmax(0, (bytes - near) / (far - near)));
    return operations + per_byte * missed * bytes;
}

// The most operations of straight-line code that cost no more.
static double longest(double cost)
{
    double low = 0, high = cost; // low costs less, high as much or more
    while (high - low > 1) {
        const double middle = (low + high) / 2;
        *(ct_form_straight_cost(middle, ct_form_code_size(middle)) < cost ? &low : &high)
            = middle;
    }
    return high;
}

static double cost_of(const struct ct_form *f)
{
    return f ? f->cost : INFINITY;
}

// Nodes that programs may take, where what they compete with costs so much.
static double allowed(double cost)
{
    return fmin(programs * longest(fmin(cost, most_nodes)), most_nodes);
}

const double *ct_form_values(struct ct_arena *a, const struct ct_machine *m)
{
    if (!m->e->carried)
        return NULL;
    double *value = CT_NEWN(a, double, m->e->x->nsym + 1);
    ct_machine_values(m, m->e->x, value);
    return value;
}

// The cheapest but dense matrices; costs are filled.
static struct ct_form *compare(struct ct_arena *a, struct ct_machine *m,
                               const struct ct_partition *partition, struct ct_form_costs *c)
{
    struct ct_arena *own = ct_arena_create_under(a);
    struct ct_partition p = *partition;
    struct ct_form *f = NULL;
    const bool is_small = m->nu + p.rank <= MOST_WHOLE;
    p.value = ct_form_values(own, m);
    if (p.nfree && is_small)
        p.pivots = ct_pivot_order_find(own, m->e, &p, m->motion.out, m->Q + m->nu);
    if (p.pivots) {
        const double operations = ct_form_operations(&m->motion) + p.pivots->operations;
        c->whole = ct_form_straight_cost(operations, ct_form_code_size(operations));
    }
    if (m->nu + p.rank >= CT_LEAST_SPARSE) {
        f = ct_form_sparse.create(a, m, &p, 0);
        c->sparse = cost_of(f);
    }
    const double others = fmin(c->dense, fmin(c->sparse, c->whole));
    struct ct_form *unrolled = ct_form_unrolled.create(a, m, &p, allowed(others));
    c->unrolled = cost_of(unrolled);
    f = cheaper(m, f, unrolled);
    if (c->whole < worth * (f ? f->cost : c->dense))
        f = cheaper(m, f, ct_form_whole.create(a, m, &p, allowed(c->whole)));
    ct_arena_destroy(own);
    return f;
}

struct ct_form *ct_form_create(struct ct_arena *a, struct ct_machine *m,
                               const struct ct_partition *p, double operations,
                               const struct ct_form_kind *kind, struct ct_form_costs *costs)
{
    struct ct_form_costs c = {.unrolled = NAN, .whole = NAN, .sparse = NAN};
    c.dense = ct_form_operations(&m->motion) + operations + call;
    struct ct_form *f = kind ? kind->create(a, m, p, most_nodes) : compare(a, m, p, &c);
    if (f && !kind && f->cost > c.dense) {
        ct_form_destroy(m, f);
        f = NULL;
    }
    if (costs)
        *costs = c;
    return f;
}

struct ct_form *ct_form_create_within(struct ct_arena *a, struct ct_machine *m,
                                      const struct ct_partition *p,
                                      const struct ct_form_kind *kind, double cost)
{
    return kind->create(a, m, p, allowed(cost));
}

struct ct_form *ct_form_ask(struct ct_arena *a, struct ct_machine *m,
                            const struct ct_partition *p, const struct ct_form_kind *kind)
{
    return kind->create(a, m, p, most_asked_nodes);
}

void ct_form_place(struct ct_form *f, const struct ct_partition *p)
{
    f->row = sorted(f->arena, p->row, p->rank);
    f->dependent = sorted(f->arena, p->dependent, p->rank);
    f->rank = p->rank;
}

void ct_form_destroy(struct ct_machine *m, struct ct_form *f)
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

bool ct_form_is_for(const struct ct_form *f, const struct ct_partition *p)
{
    return f->rank == p->rank && holds(f->row, f->rank, p->row)
        && holds(f->dependent, f->rank, p->dependent);
}

double ct_form_operations(const struct ct_program *p)
{
    const struct ct_tape_counts c = p->listing->counts;
    return (double)(c.multiplications + c.additions + c.divisions + c.functions);
}

double ct_form_solve(struct ct_form *f, struct ct_machine *m, double *a)
{
    return f->kind->solve(f, m, a);
}

void ct_form_check(struct ct_form *f, struct ct_machine *m)
{
    f->kind->check(f, m);
}

double ct_form_close(struct ct_form *f, struct ct_machine *m)
{
    return f->kind->close(f, m);
}
