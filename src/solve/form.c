// See form.h.
#include "solve/form.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A call of a solver for dense matrices costs about as much as so many operations of straight-line code.
static const double call = 500;
// Smaller systems are never cheaper as sparse matrices.
enum { LEAST_SPARSE = 100 };
// Beyond so many nodes code leaves the caches.
static const double most_nodes = 400000;
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

static double smaller(double a, double b)
{
    return a < b ? a : b;
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

struct ct_form *ct_form_create(struct ct_arena *a, struct ct_machine *m,
                               const struct ct_partition *p, double operations,
                               const struct ct_form_kind *kind)
{
    const double dense = ct_form_operations(&m->motion) + operations + call;
    if (kind)
        return kind->create(a, m, p, most_nodes);
    struct ct_form *sparse = NULL;
    if (m->nu + p->rank >= LEAST_SPARSE)
        sparse = ct_form_sparse.create(a, m, p, 0);
    const double predicted
        = p->nfree && m->nu + p->rank <= MOST_WHOLE ? ct_form_predict_whole(a, m, p) : INFINITY;
    const double most = smaller(predicted, sparse ? smaller(dense, sparse->cost) : dense);
    struct ct_form *f = cheaper(
        m, sparse, ct_form_unrolled.create(a, m, p, smaller(programs * most, most_nodes)));
    if (predicted < worth * (f ? f->cost : dense))
        f = cheaper(m, f,
                    ct_form_whole.create(a, m, p, smaller(programs * predicted, most_nodes)));
    if (!f || f->cost <= dense)
        return f;
    ct_form_destroy(m, f);
    return NULL;
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
