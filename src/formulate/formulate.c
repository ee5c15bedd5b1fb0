// Formulation: turns a model into the reduced equations of motion. ct_formulate calls the steps in
// order: linear graph, spanning trees, kinematics, constraint rows, dynamics, outputs.
#include "formulate/formulate.h"
#include "formulate/closed_form/beam_augmented.h"
#include "formulate/dynamics/dynamics.h"
#include "formulate/recursive/open_chain.h"
#include "formulate/residual/residual.h"
#include "formulate/kinematics/constraint_row.h"
#include "formulate/outputs/output.h"
#include "formulate/dynamics/small_motion.h"
#include "formulate/dynamics/energy.h"
#include "formulate/topology/linear_graph.h"
#include "formulate/stage.h"
#include "beam_error/validity.h"

#include <string.h>

// ---- the stage ----------------------------------------------------------------------------------

static const char *kind_name(const struct ct_build *b, size_t i)
{
    const struct ct_edge_info *e = &b->topology->edge[i];
    static const char *const plain[] = {"body", "arm", "joint", "closure", "force"};
    return e->self                                      ? e->self->cls->name
         : b->topology->edge[i].kind == CT_EDGE_CLOSURE ? "weld"
         : b->topology->edge[i].beam >= 0               ? "flexible arm"
                                                        : plain[e->kind];
}

static void describe_graph(struct ct_build *b)
{
    struct ct_equations *e = b->eqs;
    const char **node = CT_NEWN(b->arena, const char *, b->topology->nnode);
    const char **edge = CT_NEWN(b->arena, const char *, b->topology->nedge + 1);
    const char **kind = CT_NEWN(b->arena, const char *, b->topology->nedge + 1);
    int *wt = CT_NEWN(b->arena, int, b->topology->nedge + 1),
        *wr = CT_NEWN(b->arena, int, b->topology->nedge + 1);
    for (size_t i = 0; i < b->topology->nnode; i++)
        node[i] = b->topology->node[i].name;
    for (size_t i = 0; i < b->topology->nedge; i++) {
        edge[i] = b->topology->edge[i].name;
        kind[i] = kind_name(b, i);
        wt[i] = b->topology->edge[i].weight_t;
        wr[i] = b->topology->edge[i].weight_r;
    }
    e->graph = &b->topology->graph;
    e->T = &b->T;
    e->R = &b->R;
    e->node_name = node;
    e->edge_name = edge;
    e->edge_kind = kind;
    e->weight_t = wt;
    e->weight_r = wr;
}

// Makes the coordinates and speeds of all joints and bodies the results, in a fixed order.
static void measure_all(struct ct_build *b, const struct ct_equations *needed_by)
{
    for (size_t i = 0; i < b->topology->ncoordinate; i++) {
        const struct ct_coordinate *c = &b->kinematics->coordinate[i];
        struct ct_result q = {c->name, CT_EX_ZERO, false}, u = q;
        if (!needed_by || b->topology->edge[c->edge].kind != CT_EDGE_BODY || c->q >= 0
            || needed_by->coordinate[i].q >= 0) {
            q.value = ct_coordinate_value(b, (int)i);
            u.value = ct_coordinate_speed(b, (int)i);
        }
        CT_PUSH(b->arena, b->eqs->result, b->eqs->nresult, b->eqs->result_cap, q);
        CT_PUSH(b->arena, b->eqs->result, b->eqs->nresult, b->eqs->result_cap, u);
    }
}

static void derive_dynamics(struct ct_build *b, const struct ct_formulate_options *o)
{
    b->eqs->is_analysed
        = o->for_analysis && b->eqs->nu > CT_MOST_DENSE && !ct_small_motion_is_wanted(b);
    if (b->eqs->is_analysed) {
        ct_augmented_bodies_lump(b); // energies and rows need them
        return;
    }
    if (o->with_solution && !b->eqs->nrow && b->eqs->nu) {
        ct_open_solve(b, o->formulation);
        return;
    }
    ct_dynamics_derive(b);
    if (o->with_solution && b->eqs->nrow)
        b->eqs->augmented = ct_beam_augmented_derive(b);
}

// Chooses which beams are linear. The choice must not depend on the trees. If the chosen trees do
// not show the prescribed motion of a beam, the choice is made on trees through joints.
static const bool *choose_linear(struct ct_ctx *ctx, struct ct_arena *a,
                                 const struct ct_model *m, const struct ct_formulate_options *o,
                                 struct ct_build *b)
{
    bool is_driven;
    const bool *linear = ct_validity_choose(b, &is_driven);
    if (!linear || is_driven || o->tree == CT_TREE_JOINTS)
        return linear;
    struct ct_formulate_options through = *o;
    struct ct_tree_report unused = {0};
    through.tree = CT_TREE_JOINTS;
    struct ct_build *other = ct_build_create(ctx, a, m, &through, NULL);
    if (!ct_build_choose_trees(&other, &through, &unused)
        || !(other->is_derived || ct_build_derive(other, false)))
        return NULL;
    linear = ct_validity_choose(other, &is_driven);
    for (size_t i = 0; i < b->nflexible; i++)
        b->flexible[i].why = other->flexible[i].why;
    return linear;
}

// Chooses the formulation of beams for which the model gives none. If some are linear, the
// equations are derived again on the same trees.
static bool choose_beams(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *m,
                         const struct ct_formulate_options *o, struct ct_build **b)
{
    struct ct_build *old = *b;
    const size_t before = ctx->nerror;
    const bool *linear = o->like || o->measure_all ? NULL : choose_linear(ctx, a, m, o, old);
    if (ctx->nerror > before)
        return false;
    bool any = false;
    for (size_t i = 0; linear && i < m->nbody; i++)
        any = any || linear[i];
    if (!any)
        return true;
    *b = ct_build_create(ctx, a, m, o, linear);
    (*b)->T = old->T;
    (*b)->R = old->R;
    for (size_t i = 0; i < old->nflexible; i++) {
        struct ct_flexible *f = &(*b)->flexible[i];
        f->why = old->flexible[i].why;
        if (f->beam->formulation == CT_BEAM_AUTO && f->formulation == CT_BEAM_LINEAR)
            ct_build_note_left_out(*b, ct_arena_printf(a, "foreshortening of %s", f->name),
                                   f->why);
    }
    return ct_build_derive(*b, !o->without_dynamics);
}

// Warns if `modes` splits a group of equal frequencies or exceeds the number of modes.
static void warn_of_cuts(struct ct_ctx *ctx, const struct ct_build *b)
{
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        if (f->cut > 0)
            ct_warning(ctx, f->beam->modes_mark, 0,
                       "beam '%s' has several modes of %.6g rad/s, and `modes` keeps only some "
                       "of them, an arbitrary choice; take %s%d",
                       f->name, f->cut,
                       f->uncut[0] ? ct_arena_printf(ctx->scratch, "%d or ", f->uncut[0]) : "",
                       f->uncut[1]);
        if (f->most_modes < f->beam->modes && f->deformation)
            ct_warning(ctx, f->beam->modes_mark, 0,
                       "beam '%s' has %d mode%s besides the motions of its points: all its "
                       "coordinates are kept, as without `modes`",
                       f->name, f->most_modes, f->most_modes == 1 ? "" : "s");
    }
}

// Derives the residual form, the energies and the outputs.
static bool derive_results(struct ct_build *b, const struct ct_formulate_options *o)
{
    if (o->with_residual)
        ct_residual_derive(b, CT_SLOPES_AUTO);
    if (o->with_energy)
        ct_energies_derive(b);
    if (o->measure_all)
        measure_all(b, o->measured_for);
    else if (o->with_outputs && (!ct_outputs_derive(b) || !ct_outputs_add(b, o->more)))
        return false;
    if (o->with_energy)
        ct_validity_monitor(b);
    return true;
}

static void hand_over(struct ct_build *b, const char *how, struct ct_equations *out)
{
    describe_graph(b);
    b->eqs->coordinate = b->kinematics->coordinate;
    b->eqs->ncoordinate = b->topology->ncoordinate;
    b->eqs->build = b;
    b->eqs->how = how;
    *out = *b->eqs;
}

bool ct_formulate(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *m,
                  const struct ct_formulate_options *options, struct ct_equations *out,
                  struct ct_tree_report *report)
{
    const size_t before = ctx->nerror;
    *report = (struct ct_tree_report){0};
    struct ct_build *b = ct_build_create(ctx, a, m, options, NULL); // linear graph and plane
    if (ctx->nerror > before
        || !ct_build_choose_trees(&b, options, report) // translational and rotational tree
        || !(b->is_derived                             // kinematics, constraint rows and loads
             || ct_build_derive(b, !options->without_dynamics))
        || !choose_beams(ctx, a, m, options, &b)) // linear, or with foreshortening
        return false;
    if (!options->without_dynamics && !b->is_derived)
        derive_dynamics(b, options); // mass matrix and forces, or accelerations in closed form
    if (ctx->nerror > before || !derive_results(b, options))
        return false;
    hand_over(b, report->how, out);
    if (!options->like) {
        warn_of_cuts(ctx, b);
        ct_warn_of_excluded_loads(ctx, b);
    }
    return true;
}

void ct_formulate_dynamics(struct ct_equations *e)
{
    if (e->has_dynamics)
        return;
    ct_dynamics_derive(e->build);
    const struct ct_equations *made = e->build->eqs;
    e->M = made->M;
    e->nM = made->nM;
    e->M_cap = made->M_cap;
    e->has_dynamics = true;
    e->is_analysed = e->build->eqs->is_analysed = false;
}

void ct_formulate_residual(struct ct_equations *e)
{
    if (!e->residual || !e->residual->has_slopes)
        ct_residual_derive(e->build, CT_SLOPES_AUTO);
    e->residual = e->build->eqs->residual;
}

void ct_formulate_rows(struct ct_equations *e)
{
    ct_residual_rows(e->build);
    e->residual = e->build->eqs->residual;
}
