// A copy of equations to which expressions can be added: the copy has its own expression store and
// its own lists of derived results.
//
// An expression is an index in a store, so that it stays valid in a copy of the store. Data that
// later derivations write is copied. Data that they only read (trees, names, lists of terms) is
// shared.
#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/beam/flexible_body.h"
#include "formulate/formulate.h"
#include "formulate/kinematics/constraint_row.h"
#include "formulate/mass_sums.h"

#include <string.h>

static void *copy(struct ct_arena *a, const void *from, size_t n, size_t size)
{
    void *to = ct_arena_calloc(a, n + 1, size);
    if (from && n)
        memcpy(to, from, n * size);
    return to;
}

#define COPY(a, p, n) ((p) = copy((a), (p), (n), sizeof *(p)))

static struct ct_exs *fork_store(struct ct_arena *a, const struct ct_exs *from)
{
    struct ct_exs *x = ct_exs_clone(a, from);
    x->table_cap = 0; // a new entry copies the list
    x->label = from->label;
    x->label_cap = from->label_cap;
    if (x->label)
        COPY(a, x->label, x->label_cap);
    if (x->decided)
        COPY(a, x->decided, x->ndecided);
    x->stamp = NULL;
    x->memo = NULL;
    x->stack = NULL;
    return x;
}

static void fork_flexible(struct ct_arena *a, struct ct_flexible *f)
{
    const size_t nelement = (size_t)f->beam->nelement;
    if (f->elastic)
        COPY(a, f->elastic, (size_t)f->nelastic);
    if (f->freedom)
        COPY(a, f->freedom, CT_NODE_FREEDOM * (nelement + 1));
    if (f->element)
        COPY(a, f->element, nelement);
    if (f->inertia)
        COPY(a, f->inertia, 1);
}

static struct ct_build *fork_build(struct ct_ctx *ctx, struct ct_arena *a,
                                   const struct ct_build *from)
{
    struct ct_build *b = copy(a, from, 1, sizeof *b);
    b->ctx = ctx;
    b->arena = a;
    COPY(a, b->cache.cluster, b->kinematics->ncluster);
    COPY(a, b->cache.anchor, b->kinematics->nanchor);
    COPY(a, b->cache.measured, b->topology->ncoordinate);
    if (b->flexible)
        COPY(a, b->flexible, b->nflexible);
    for (size_t i = 0; i < b->nflexible; i++)
        fork_flexible(a, &b->flexible[i]);
    COPY(a, b->dynamics.masses.augmented_body, b->dynamics.masses.naugmented_body);
    b->dynamics.masses.augmented_body_cap = 0;
    b->dynamics.masses.of = (struct ct_pairs){0}; // rebuilt when a pair is added
    b->dynamics.speed_axis_cap = 0;
    if (b->signals.quaternion)
        COPY(a, b->signals.quaternion, b->topology->nnode);
    // workspace
    if (b->cache.piece)
        COPY(a, b->cache.piece, b->kinematics->nanchor + 2);
    if (b->cache.marked)
        COPY(a, b->cache.marked, b->kinematics->ncluster);
    if (b->cache.coefficient)
        COPY(a, b->cache.coefficient, b->eqs->nu);
    return b;
}

void ct_equations_fork(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
                       const struct ct_equations *from, struct ct_equations *to)
{
    *to = *from;
    if (!from->build)
        return;
    to->x = fork_store(a, from->x);
    COPY(a, to->Q, to->nu);
    COPY(a, to->row, to->nrow);
    COPY(a, to->memory, to->nmemory);
    COPY(a, to->switches, to->nswitch);
    COPY(a, to->result, to->nresult);
    if (to->residual)
        COPY(a, to->residual, 1);
    // a new entry copies the list
    to->q_cap = 0;
    to->u_cap = 0;
    to->M_cap = 0;
    to->J_cap = 0;
    to->row_cap = 0;
    to->switch_cap = 0;
    to->time_function_cap = 0;
    to->memory_cap = 0;
    to->offset_cap = 0;
    to->driver_cap = 0;
    to->result_cap = 0;
    to->validity_cap = 0;
    to->bent_beam_cap = 0;
    to->left_out_cap = 0;
    to->build = fork_build(ctx, a, from->build);
    to->build->model = model;
    to->build->x = to->x;
    to->build->eqs = copy(a, to, 1, sizeof *to);
}

struct ct_model *ct_model_fork(struct ct_arena *a, const struct ct_model *from)
{
    struct ct_model *m = copy(a, from, 1, sizeof *m);
    m->x = fork_store(a, from->x);
    COPY(a, m->parameter, m->nparameter);
    m->parameter_cap = 0;
    COPY(a, m->value, m->nparameter + 1);
    return m;
}
