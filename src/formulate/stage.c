// See stage.h.
#include "formulate/stage.h"
#include "formulate/beam/flexible_body.h"
#include "formulate/dynamics/dynamics.h"
#include "formulate/kinematics/constraint_row.h"
#include "formulate/recursive/open_chain.h"
#include "formulate/topology/linear_graph.h"
#include "formulate/topology/tree_selection.h"

#include <math.h>
#include <string.h>

// ---- equations of one pair of trees ------------------------------------------------------------

static double *start_values(struct ct_arena *a, const struct ct_model *m)
{
    double *v = CT_NEWN(a, double, m->x->nsym + 1);
    for (size_t i = 0; i < m->nparameter; i++)
        v[ct_ex_node(m->x, m->parameter[i].symbol)->a] = m->parameter[i].value;
    return v;
}

static bool starts_deformed(const struct ct_model *m)
{
    for (size_t i = 1; i < m->nbody; i++)
        if (m->body[i].beam && m->body[i].beam->nstart)
            return true;
    return false;
}

struct ct_build *ct_build_create(struct ct_ctx *ctx, struct ct_arena *a,
                                 const struct ct_model *m, const struct ct_formulate_options *o,
                                 const bool *is_linear)
{
    struct ct_build *b = CT_NEW(a, struct ct_build);
    struct ct_build_options *options = CT_NEW(a, struct ct_build_options);
    *options = (struct ct_build_options){
        .is_rigid = o->rigid || (o->measure_all && !o->deformed && !starts_deformed(m)),
        .keep_all = o->keep_all,
        .keeps_all_deformations
        = o->frees_beams || (o->like && o->like->build->options->keeps_all_deformations),
        .drivers_are_held = o->held,
        .has_offsets = o->gaps,
        .like = o->like,
        .is_linear = is_linear};
    static const struct ct_row_wrenches no_rows; // for stages that precede the constraint rows
    static const struct ct_loads no_loads;
    *b = (struct ct_build){.ctx = ctx,
                           .arena = a,
                           .model = m,
                           .options = options,
                           .rows = &no_rows,
                           .loads = &no_loads};
    b->eqs = CT_NEW(a, struct ct_equations);
    b->x = b->eqs->x = ct_exs_clone(a, m->x);
    b->value = start_values(a, m);
    b->x->ndecided = m->x->nsym;
    b->x->decided = CT_NEWN(a, unsigned char, m->x->nsym + 1);
    ct_linear_graph_derive(b, !o->keep_all);
    return b;
}

static void *copy(struct ct_arena *a, const void *from, size_t n, size_t cap, size_t size)
{
    void *to = ct_arena_calloc(a, cap, size);
    if (n)
        memcpy(to, from, n * size);
    return to;
}

struct ct_build *ct_build_clone(struct ct_ctx *ctx, struct ct_arena *a,
                                const struct ct_build *from)
{
    struct ct_build *b = copy(a, from, 1, 1, sizeof *b);
    b->ctx = ctx;
    b->arena = a;
    b->eqs = copy(a, from->eqs, 1, 1, sizeof *b->eqs);
    b->x = b->eqs->x = ct_exs_clone(a, from->x);
    const size_t ndecided = b->x->ndecided;
    b->x->decided = copy(a, from->x->decided, ndecided, ndecided + 1, 1);
    return b;
}

bool ct_build_derive(struct ct_build *b, bool with_dynamics)
{
    const size_t before = b->ctx->nerror;
    struct ct_kinematics *kinematics = CT_NEW(b->arena, struct ct_kinematics);
    b->kinematics = kinematics;
    ct_unknowns_choose(b, kinematics);
    b->eqs->Q = CT_NEWN(b->arena, ct_ex, b->eqs->nu + 1);
    ct_rotation_derive(b, kinematics);
    ct_translation_derive(b, kinematics);
    ct_rows_derive(b);
    if (with_dynamics)
        ct_loads_derive(b);
    return b->ctx->nerror == before;
}

// ---- the choice of trees -----------------------------------------------------------------------

struct trials {
    struct ct_ctx *ctx;
    const struct ct_build *open; // the formulation that needs the trees
    const struct ct_formulate_options *options;
    // arena: memory of one trial, cleared for the next; NULL: no trial yet
    struct ct_arena *arena;
    bool stays_open;     // reject pairs with constraint rows
    struct ct_tree T, R; // of the first pair
    double cost;         // cost of the first pair; 0: not counted yet
    size_t nu, nrow;     // of the pair that was derived last
    struct ct_tree_report *report;
    // first: equations of the first pair in their own arena, if they may be kept; else NULL
    struct ct_build *first;
};

static void begin(void *data, bool stays_open)
{
    struct trials *s = data;
    s->arena = ct_arena_create_under(s->open->arena);
    s->stays_open = stays_open;
}

// Does a beam fill the mass matrix? Articulated bodies need no mass matrix (6.9).
static bool has_chain(const struct ct_build *b)
{
    for (size_t i = 0; i < b->nflexible; i++)
        if (b->flexible[i].kinematics == CT_AXIAL_CHAIN)
            return true;
    return false;
}

// The exact operation count of a trial; INFINITY if it fails or is rejected.
static double derive_and_count(struct trials *s, struct ct_build *b, const struct ct_tree *T,
                               const struct ct_tree *R)
{
    b->T = *T;
    b->R = *R;
    if (!ct_build_derive(b, true) || (s->stays_open && b->eqs->nrow))
        return INFINITY;
    ct_dynamics_derive(b);
    s->nu = b->eqs->nu;
    s->nrow = b->eqs->nrow;
    const double cost = ct_equations_cost(b->ctx->scratch, b->eqs);
    return has_chain(b) ? ct_open_cost(b, cost) : cost;
}

static bool is_same(const struct ct_tree *t, const struct ct_tree *other)
{
    return other->is_branch
        && memcmp(t->is_branch, other->is_branch, (size_t)t->nedge * sizeof *t->is_branch) == 0;
}

// May the equations of a trial be kept as the result? Only for closed systems without beams: beams
// need a later choice of formulation, open systems have other solutions, analyses need fewer
// results.
static bool may_keep(const struct ct_build *b, const struct ct_formulate_options *o)
{
    return !b->nflexible && !o->for_analysis && !o->without_dynamics;
}

// Cost of a pair, derived in the trial arena and discarded. The chosen pair reports errors later.
static double trial_cost(struct trials *s, const struct ct_tree *T, const struct ct_tree *R)
{
    ct_arena_clear(s->arena);
    struct ct_ctx quiet = {.model = s->arena, .scratch = s->arena};
    struct ct_build *b = s->open->nflexible
                           ? ct_build_create(&quiet, s->arena, s->open->model, s->options, NULL)
                           : ct_build_clone(&quiet, s->arena, s->open);
    return derive_and_count(s, b, T, R);
}

// Cost of the first pair, derived in its own arena, which is kept if its equations may be the
// result.
static double kept_cost(struct trials *s, const struct ct_tree *T, const struct ct_tree *R)
{
    struct ct_ctx quiet
        = {.model = ct_arena_create_under(s->open->arena), .scratch = s->ctx->scratch};
    struct ct_build *b = ct_build_create(&quiet, quiet.model, s->open->model, s->options, NULL);
    const double cost = derive_and_count(s, b, T, R);
    if (isfinite(cost) && b->eqs->nrow && !quiet.ndiagnostic)
        s->first = b;
    else
        ct_arena_destroy(quiet.model);
    return cost;
}

// Inserts a pair into the sorted list of the cheapest pairs, unless it is listed already.
static void list_pair(struct trials *s, const struct ct_tree *T, const struct ct_tree *R,
                      double cost)
{
    struct ct_tree_report *r = s->report;
    const size_t size = (size_t)T->nedge * sizeof(bool);
    int at = r->ncandidate;
    for (int i = 0; i < r->ncandidate; i++)
        if (!memcmp(r->candidate[i].trans, T->is_branch, size)
            && !memcmp(r->candidate[i].rot, R->is_branch, size))
            return;
    while (at > 0
           && (cost < r->candidate[at - 1].cost
               || (cost == r->candidate[at - 1].cost && s->nu < r->candidate[at - 1].nu)))
        at--;
    if (at == CT_MOST_CANDIDATES || !isfinite(cost))
        return;
    r->ncandidate += r->ncandidate < CT_MOST_CANDIDATES;
    for (int i = r->ncandidate - 1; i > at; i--)
        r->candidate[i] = r->candidate[i - 1];
    struct ct_arena *a = s->open->arena;
    r->candidate[at] = (struct ct_tree_candidate){copy(a, T->is_branch, size, size + 1, 1),
                                                  copy(a, R->is_branch, size, size + 1, 1),
                                                  s->nu, s->nrow, cost};
}

static double pair_cost(void *data, const struct ct_tree *T, const struct ct_tree *R)
{
    struct trials *s = data;
    if (s->cost > 0 && is_same(&s->T, T) && is_same(&s->R, R))
        return s->cost;
    const bool is_first = !s->T.is_branch;
    if (is_first) {
        s->T = *T;
        s->R = *R;
    }
    const double cost
        = is_first && may_keep(s->open, s->options) ? kept_cost(s, T, R) : trial_cost(s, T, R);
    if (is_first)
        s->cost = cost;
    list_pair(s, T, R, cost);
    return cost;
}

// If the first pair was chosen, its equations replace *b; else they are freed.
static void take_first(struct trials *s, struct ct_build **b)
{
    struct ct_build *first = s->first;
    if (!first)
        return;
    if (!is_same(&s->T, &(*b)->T) || !is_same(&s->R, &(*b)->R)) {
        ct_arena_destroy(first->arena);
        return;
    }
    struct ct_arena *owner = (*b)->arena;
    ct_arena_merge(owner, first->arena);
    first->ctx = s->ctx;
    first->arena = first->x->arena = owner;
    first->is_derived = true;
    *b = first;
}

bool ct_build_choose_trees(struct ct_build **b, const struct ct_formulate_options *o,
                           struct ct_tree_report *report)
{
    struct trials s = {.ctx = (*b)->ctx, .open = *b, .options = o, .report = report};
    const struct ct_pair_trials trials = {&s, begin, pair_cost};
    const bool ok = ct_tree_selection_run(*b, o, &trials, report);
    if (s.arena)
        ct_arena_destroy(s.arena);
    take_first(&s, b);
    return ok;
}
