// See configuration.h.
#include "analysis/configuration.h"

#include "formulate/build.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- equations ------------------------------------------------------------------------------

static const char **branches(struct ct_arena *a, const struct ct_equations *e,
                             const struct ct_tree *t, size_t *n)
{
    const char **name = CT_NEWN(a, const char *, e->graph->nedge + 1);
    *n = 0;
    for (int i = 0; i < e->graph->nedge; i++)
        if (t->is_branch[i] && !ct_edge_is_rigid_arm(&e->build->topology->edge[i]))
            name[(*n)++] = e->edge_name[i];
    return name;
}

bool ct_equations_like(struct ct_ctx *own, const struct ct_model *model,
                       const struct ct_equations *like, bool drivers_held,
                       struct ct_equations *out)
{
    struct ct_tree_report unused;
    struct ct_formulate_options o = {.tree = CT_TREE_GIVEN,
                                     .keep_all = !like->is_planar,
                                     .with_energy = true,
                                     .with_outputs = true,
                                     .more = like->more,
                                     .with_residual = !like->is_analysed,
                                     .for_analysis = like->is_analysed,
                                     .like = like,
                                     .held = drivers_held};
    o.trans = branches(own->model, like, like->T, &o.ntrans);
    o.rot = branches(own->model, like, like->R, &o.nrot);
    const bool ok = ct_formulate(own, own->model, model, &o, out, &unused);
    if (ok && out->is_analysed)
        ct_formulate_rows(out);
    else if (ok)
        ct_formulate_dynamics(out);
    ct_own_next_stage(own);
    return ok;
}

// ---- states ---------------------------------------------------------------------------------

// Does any joint have a driver, be it a branch or a chord?
static bool has_drivers(const struct ct_model *m)
{
    for (size_t i = 0; i < m->njoint; i++)
        if (m->joint[i].cls->motion && ct_instance_value(&m->joint[i], "motion")->given)
            return true;
    return false;
}

struct ct_linear *ct_configuration_start(struct ct_ctx *own, struct ct_system *sys,
                                         const struct ct_model *model,
                                         const struct ct_equations *e, bool at_rest)
{
    struct ct_initial_state start;
    if (!ct_system_assemble(own, sys, &start))
        return NULL;
    struct ct_evaluator *m = ct_evaluator_create(own->model, model, e);
    struct ct_linear *l = ct_linear_create(own, own->model, m);
    ct_initial_state_apply(&start, m, l->y);
    for (size_t k = 0; k < e->nmotion && at_rest; k++)
        l->y[m->nq + k] = 0;
    double *before = CT_NEWN(own->model, double, m->nq + m->nu + 1);
    memcpy(before, l->y, (m->nq + m->nu) * sizeof *before);
    if (ct_linear_close(l))
        return ct_start_is_kept(own, own->model, model, e, &start, before, l->y, false) ? l
                                                                                        : NULL;
    ct_error(own, (struct ct_mark){.file = model->file}, CT_E_ASSEMBLY,
             "the assembled start is singular: the loops cannot be held there");
    return NULL;
}

// Is the motion of a driver steady? So are a constant rate of rotation or translation, and a
// constant acceleration along a slide.
static bool is_steady(const struct ct_equations *e, const struct ct_linear *l, size_t i)
{
    const struct ct_driver *d = &e->driver[i];
    const unsigned in_time = 1u << CT_SYM_TIME | 1u << CT_SYM_SWITCH;
    if (ct_ex_is_zero(d->acceleration))
        return true;
    for (size_t k = 0; k < e->ncoordinate; k++)
        if (e->coordinate[k].driver == (int)i && e->coordinate[k].in_rotation)
            return false;
    return !(ct_ex_kinds(e->x, d->acceleration) & in_time) && l->m->driver.out[2 * i + 1] == 0;
}

// Do all drivers move the system as a whole, so that it can be at rest relative to the moving
// frame?
static bool are_steady(const struct ct_equations *e, const struct ct_linear *l)
{
    ct_program_run(&l->m->driver, l->m->input);
    for (size_t i = 0; i < e->ndriver; i++)
        if (!is_steady(e, l, i))
            return false;
    for (size_t k = 0; k < e->nmotion; k++)
        if (l->y[l->m->nq + k] != 0) // the constraint rows require a speed
            return false;
    return true;
}

static bool can_be_full(struct ct_ctx *own, const struct ct_system *sys,
                        const struct ct_configuration *c)
{
    return c->equations->nu <= CT_MOST_FULL
        || ct_error(
               own, (struct ct_mark){.file = sys->model.file}, CT_E_FULL,
               "%zu speeds are too many for full matrices, which this analysis needs here; "
               "%d are the most",
               c->equations->nu, CT_MOST_FULL);
}

static bool find_equilibrium(struct ct_ctx *own, struct ct_system *sys,
                             struct ct_configuration *c)
{
    const bool has = has_drivers(&sys->model);
    c->e = c->equations;
    c->l = ct_configuration_start(own, sys, c->model, c->e, true);
    if (!c->l)
        return false;
    c->are_drivers_steady = has && !c->hold_drivers && are_steady(c->e, c->l);
    c->are_drivers_held = has && !c->are_drivers_steady;
    if (c->are_drivers_held) {
        if (!ct_equations_like(own, c->model, c->e, true, &c->held))
            return false;
        c->e = &c->held;
        c->l = ct_configuration_start(own, sys, c->model, c->e, true);
    }
    c->is_equilibrium = true;
    if (c->is_large) {
        bool applies;
        if (!ct_equilibrium_find_sparse(c->l, &c->equilibrium, &applies))
            return false;
        if (applies)
            return true;
        c->is_large = c->may_be_large = false; // forces dense matrices
        if (!can_be_full(own, sys, c))
            return false;
        ct_formulate_dynamics(c->equations);
        ct_formulate_residual(c->equations);
        c->l = ct_configuration_start(own, sys, c->model, c->e, true);
    }
    return c->l && ct_equilibrium_find(c->l, &c->equilibrium);
}

static bool find_start(struct ct_ctx *own, struct ct_system *sys, struct ct_configuration *c)
{
    c->e = c->equations;
    c->l = ct_configuration_start(own, sys, c->model, c->e, false);
    return c->l && (c->is_large || ct_linear_move(c->l));
}

static bool find_time(struct ct_ctx *own, struct ct_system *sys, const struct ct_sim_options *o,
                      double time, struct ct_configuration *c)
{
    struct ct_sim_options options = *o;
    options.until = time;
    options.samples = 2;
    c->e = c->equations;
    c->sim = ct_sim_create(own, sys, &options);
    if (!c->sim || !ct_sim_run(own, c->sim, NULL))
        return false;
    struct ct_evaluator *m = ct_run_evaluator(c->sim->run);
    // both have the same unknowns: rotation angles continue from their present values
    if (c->e != &sys->equations) {
        const struct ct_evaluator *from = m;
        m = ct_evaluator_create(own->model, c->model, c->e);
        for (size_t i = 0; i < c->e->nmemory && i < from->e->nmemory; i++)
            m->input[m->at_memory + i] = from->input[from->at_memory + i];
    }
    c->l = ct_linear_create(own, own->model, m);
    c->l->t = time;
    memcpy(c->l->y, c->sim->report.y, (c->e->nq + c->e->nu + 1) * sizeof *c->l->y);
    return ct_linear_move(c->l);
}

static void formulate_for(struct ct_equations *e, bool is_large)
{
    if (!is_large || !e->is_analysed)
        ct_formulate_dynamics(e);
    if (is_large)
        ct_formulate_rows(e);
    else
        ct_formulate_residual(e);
}

bool ct_configuration_find(struct ct_ctx *own, struct ct_system *sys,
                           const struct ct_sim_options *o, struct ct_configuration *c)
{
    static const char *const words[] = {"initial", "equilibrium"};
    static const struct ct_sim_options standard;
    if (!c->equations) {
        c->model = &sys->model;
        c->equations = &sys->equations;
    }
    if (!c->about)
        c->about = words[0];
    c->is_large = c->may_be_large && !c->equations->nstate && c->equations->nu > CT_MOST_DENSE
               && (strcmp(c->about, words[0]) == 0
                   || (strcmp(c->about, words[1]) == 0 && !has_drivers(&sys->model)));
    if (!c->is_large && !can_be_full(own, sys, c))
        return false;
    formulate_for(&sys->equations, c->is_large);
    if (c->equations != &sys->equations)
        formulate_for(c->equations, c->is_large);
    if (strcmp(c->about, words[0]) == 0)
        return find_start(own, sys, c);
    if (strcmp(c->about, words[1]) == 0)
        return find_equilibrium(own, sys, c);
    char *end;
    const double time = strtod(c->about, &end);
    if (end == c->about || *end || !isfinite(time) || time < 0)
        return ct_error(own, (struct ct_mark){0}, CT_E_USAGE,
                        "there is no configuration '%s': initial, equilibrium or a time in "
                        "seconds%s",
                        c->about, ct_suggest(own->model, c->about, words, COUNT(words)));
    return time == 0 ? find_start(own, sys, c)
                     : find_time(own, sys, o ? o : &standard, time, c);
}

bool ct_configuration_find_full(struct ct_ctx *own, struct ct_system *sys,
                                const struct ct_sim_options *o, struct ct_configuration *c)
{
    if (c->equations->nu <= CT_MOST_FULL)
        ct_warning(own, (struct ct_mark){.file = sys->model.file}, 0,
                   "%zu speeds with dampers, moving drivers, redundant constraints or loads "
                   "without potential: dense matrices, which takes long",
                   c->equations->nu);
    c->may_be_large = false;
    return ct_configuration_find(own, sys, o, c);
}

void ct_analysis_free(void *analysis, struct ct_ctx *own, struct ct_configuration *at)
{
    ct_sim_destroy(at->sim);
    ct_own_finish(own);
    free(analysis);
}

void *ct_analysis_find(struct ct_ctx *ctx, void *analysis, struct ct_ctx *own,
                       struct ct_configuration *at, bool (*find)(void *task))
{
    if (ct_own_enter(ctx, own, find, analysis))
        return analysis;
    ct_analysis_free(analysis, own, at);
    return NULL;
}

void ct_configuration_print(const struct ct_configuration *c, FILE *out)
{
    // Layout: smaller accelerations are not printed.
    const double noticeable = 1e-6; // [m/s^2 or rad/s^2]
    if (c->is_equilibrium) {
        fprintf(out, "about         equilibrium, found in %d steps", c->equilibrium.iterations);
        if (c->are_drivers_steady)
            fputs("; the motions go on", out);
        if (c->are_drivers_held)
            fputs("; the motions are held", out);
        fputc('\n', out);
        return;
    }
    if (c->l->t > 0)
        fprintf(out, "about         the motion at t = %.9g", c->l->t);
    else
        fputs("about         the start", out);
    if (c->l->acceleration > noticeable)
        fprintf(out,
                "; not an equilibrium: accelerations%s up to %.3g, what follows holds for this "
                "instant",
                c->e->nstate ? " and rates of states" : "", c->l->acceleration);
    fputc('\n', out);
}
