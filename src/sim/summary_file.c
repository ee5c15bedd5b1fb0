// The summary of a run or of a system as one JSON object.
#include "sim/summary.h"

#include "formulate/beam/flexible_body.h"
#include "report/json.h"
#include "report/suffix.h"
#include "report/outfile.h"
#include "report/stage_beam.h"
#include "solve/singular/singular.h"

#if defined(__unix__) || defined(__APPLE__)
#include <sys/resource.h>
#endif

#include <math.h>
#include <string.h>

// The method of the run; the options' method before the run, when there is no report.
static const struct ct_method *last_method(const struct ct_sim *sim)
{
    return sim->report.method ? sim->report.method : sim->run_options.method;
}

// Peak memory of the process [bytes]; 0 if the system does not tell.
static long peak_memory(void)
{
#if defined(__unix__) || defined(__APPLE__)
    struct rusage use;
    if (getrusage(RUSAGE_SELF, &use))
        return 0;
#ifdef __APPLE__
    return use.ru_maxrss;
#else
    return use.ru_maxrss * 1024;
#endif
#else
    return 0;
#endif
}

// Lists the edges that are branches (or chords) of at least one of the two trees.
static void write_edges(struct ct_json *j, const struct ct_equations *e, const char *key,
                        bool branches)
{
    ct_json_array(j, key);
    for (int i = 0; i < e->graph->nedge; i++)
        if (e->T->is_branch[i] == branches || e->R->is_branch[i] == branches)
            ct_json_text(j, NULL, e->edge_name[i]);
    ct_json_end(j);
}

// Writes the branches except arms, in the format of a tree file.
static void write_tree(struct ct_json *j, const struct ct_equations *e, const char *key,
                       const struct ct_tree *t)
{
    ct_json_array(j, key);
    for (int i = 0; i < t->nbranch; i++)
        if (!ct_is_arm(e, t->branch[i]))
            ct_json_text(j, NULL, e->edge_name[t->branch[i]]);
    ct_json_end(j);
}

static void write_left_out(struct ct_json *j, const struct ct_equations *e)
{
    ct_json_array(j, "left_out");
    for (size_t i = 0; i < e->nleft_out; i++) {
        ct_json_object(j, NULL);
        ct_json_text(j, "what", e->left_out[i].what);
        ct_json_text(j, "why", e->left_out[i].why);
        ct_json_end(j);
    }
    ct_json_end(j);
}

static void write_beams(struct ct_json *j, const struct ct_equations *e)
{
    if (!e->build->nflexible)
        return;
    ct_json_array(j, "beams");
    for (size_t i = 0; i < e->build->nflexible; i++) {
        const struct ct_flexible *f = &e->build->flexible[i];
        ct_json_object(j, NULL);
        ct_json_text(j, "name", f->name);
        ct_json_integer(j, "elements", f->beam->nelement);
        ct_json_integer(j, "elastic_coordinates", f->nelastic);
        ct_json_text(j, "formulation", ct_beam_formulation_name(f->formulation));
        if (f->why)
            ct_json_text(j, "why", f->why);
        ct_json_end(j);
    }
    ct_json_end(j);
}

static void write_structure(struct ct_json *j, const struct ct_sim *sim)
{
    const struct ct_equations *e = &sim->system->equations;
    ct_json_integer(j, "coordinates", (long)e->nq);
    ct_json_integer(j, "speeds", (long)e->nmotion);
    if (e->nstate)
        ct_json_integer(j, "states", (long)e->nstate);
    ct_json_integer(j, "constraints", (long)e->nrow);
    ct_json_integer(j, "redundant", ct_sim_redundant(sim));
    ct_json_integer(j, "degrees_of_freedom", ct_sim_freedoms(sim));
    ct_json_bool(j, "planar", e->is_planar);
    write_edges(j, e, "tree", true);
    write_edges(j, e, "cotree", false);
    ct_json_object(j, "trees");
    write_tree(j, e, "translation", e->T);
    write_tree(j, e, "rotation", e->R);
    ct_json_end(j);
    ct_json_text(j, "tree_choice", sim->system->tree.how);
    write_left_out(j, e);
    write_beams(j, e);
    ct_sim_write_start(j, sim);
}

static void write_open(struct ct_json *j, const struct ct_sim *sim)
{
    const struct ct_equations *e = &sim->system->equations;
    ct_json_array(j, "undetermined");
    for (size_t i = 0; i < e->nresult; i++)
        if (sim->open.result[i])
            ct_json_text(j, NULL, e->result[i].name);
    ct_json_end(j);
    ct_json_array(j, "undetermined_constraints");
    for (size_t i = 0; i < e->nrow; i++)
        if (sim->open.row[i])
            ct_json_text(j, NULL, e->row[i].name);
    ct_json_end(j);
}

// Writes null without --verify, and if the second run failed.
static void write_estimate(struct ct_json *j, const struct ct_sim *sim)
{
    const struct ct_estimate *e = &sim->estimate;
    const struct ct_equations *equations = &sim->system->equations;
    ct_json_number(j, "global", e->output ? e->worst : NAN);
    ct_json_text(j, "compared_with", e->how);
    if (!e->output)
        return;
    ct_json_number(j, "holds_until", e->holds_until);
    ct_json_object(j, "outputs");
    for (size_t i = 0; i < equations->nresult; i++) {
        ct_json_object(j, equations->result[i].name);
        ct_json_number(j, "absolute", e->output[i].absolute);
        ct_json_number(j, "relative", e->output[i].relative);
        ct_json_end(j);
    }
    ct_json_end(j);
}

static void write_formulation(struct ct_json *j, const struct ct_equations *e)
{
    ct_json_text(j, "formulation", ct_formulation_names[e->formulation].key);
    ct_json_object(j, "formulation_costs");
    for (int k = CT_FORMULATION_CUTSETS; k < CT_NFORMULATION && e->formulation; k++)
        if (isfinite(e->formulation_cost[k]))
            ct_json_number(j, ct_formulation_names[k].key, e->formulation_cost[k]);
    ct_json_end(j);
}

// Writes the validity indicators of linear beams.
static void write_validity(struct ct_json *j, const struct ct_sim *sim)
{
    const struct ct_equations *e = &sim->system->equations;
    if (!e->nvalidity || !sim->report.validity)
        return;
    ct_json_object(j, "validity");
    for (size_t i = 0; i < e->nvalidity; i++) {
        const struct ct_validity_report *v = &sim->report.validity[i];
        ct_json_object(j, e->validity[i].beam);
        ct_json_number(j, "largest", v->largest);
        ct_json_number(j, "limit", CT_VALIDITY_LIMIT);
        if (v->left_at >= 0)
            ct_json_number(j, "left_at", v->left_at);
        const double error = ct_beam_error_modal_error(&v->modal, CT_BEAM_MODEL_LINEAR);
        if (error > CT_ESTIMATED_ERROR_LIMIT)
            ct_json_text(j, "error", "beyond 1");
        else if (isnan(error))
            ct_json_text(j, "error", "not estimated");
        else
            ct_json_number(j, "error", error);
        if (v->error_beyond_since >= 0)
            ct_json_number(j, "off_since", v->error_beyond_since);
        ct_json_end(j);
    }
    ct_json_end(j);
}

static void write_position(struct ct_json *j, const struct ct_sim *sim,
                           const struct ct_singular_configuration *at)
{
    const struct ct_equations *e = &sim->system->equations;
    ct_json_object(j, NULL);
    ct_json_number(j, "time", at->t);
    if (at->rank_loss) {
        ct_json_integer(j, "rank_loss", at->rank_loss);
        ct_json_array(j, "joints");
        for (size_t i = 0; i < e->nrow; i++)
            if (ct_is_first_of_joint(e, at->row, i))
                ct_json_text(j, NULL, ct_row_owner(sim, i));
        ct_json_end(j);
    }
    ct_json_end(j);
}

static long kept_positions(const struct ct_rank_monitor *w)
{
    return w->npassed < CT_MOST_SINGULAR ? w->npassed : CT_MOST_SINGULAR;
}

static void write_singular(struct ct_json *j, const struct ct_sim *sim)
{
    const struct ct_rank_monitor *w = sim->report.singular;
    ct_json_integer(j, "singular_positions_passed", w ? w->npassed : 0);
    ct_json_array(j, "singular_positions");
    for (long i = 0; w && i < kept_positions(w); i++)
        write_position(j, sim, &w->passed[i]);
    ct_json_end(j);
}

static void write_solver(struct ct_json *j, const struct ct_sim *sim)
{
    const struct ct_solver_costs *c = &ct_run_partition(sim->run)->costs;
    ct_json_text(j, "solver", ct_sim_solver(sim));
    ct_json_object(j, "solver_costs");
    if (c->dense > 0) {
        ct_json_number(j, "unrolled", c->symbolic);
        ct_json_number(j, "one_system", c->symbolic_kkt);
        ct_json_number(j, "sparse", c->sparse);
        ct_json_number(j, "dense", c->dense);
    }
    ct_json_end(j);
}

static void write_work(struct ct_json *j, const struct ct_sim *sim)
{
    const struct ct_run_report *r = &sim->report;
    ct_json_text(j, "method", last_method(sim)->name);
    ct_json_text(j, "method_why", sim->method_why);
    ct_json_number(j, "tolerance", sim->tolerance);
    ct_json_text(j, "backend", ct_run_evaluator(sim->run)->backend);
    write_solver(j, sim);
    write_formulation(j, &sim->system->equations);
    ct_json_text(j, "results", ct_sim_results_path(sim, false));
    ct_json_text(j, "sweeps_alone_because", ct_sim_refuses_batch(sim));
    ct_json_integer(j, "steps", r->stats.steps);
    ct_json_integer(j, "rejected_steps", r->stats.rejected_steps);
    ct_json_integer(j, "inaccurate_steps", r->stats.inaccurate_steps);
    ct_json_integer(j, "evaluations", r->stats.evaluations);
    ct_json_integer(j, "jacobians", r->stats.jacobians);
    ct_json_integer(j, "factorizations", r->factorizations);
    ct_json_object(j, "solves");
    ct_json_integer(j, "fixed", r->solves.fixed);
    ct_json_integer(j, "refined", r->solves.refined);
    ct_json_integer(j, "pivoted", r->solves.pivoted);
    ct_json_integer(j, "reordered", r->solves.reordered);
    ct_json_end(j);
    ct_json_integer(j, "events", r->stats.events);
    write_singular(j, sim);
    ct_json_integer(j, "operations", ct_sim_operations(sim));
    ct_json_object(j, "seconds");
    ct_json_number(j, "read", sim->system->read);
    ct_json_number(j, "generate", sim->system->generate);
    ct_json_number(j, "compile", sim->compile);
    ct_json_number(j, "integrate", sim->integrate);
    ct_json_number(j, "write", sim->write);
    ct_json_number(j, "verify", sim->verify_seconds);
    ct_json_end(j);
    write_validity(j, sim);
    ct_json_object(j, "memory");
    ct_json_integer(j, "code", (long)ct_evaluator_code_size(ct_run_evaluator(sim->run)));
    ct_json_integer(j, "peak", peak_memory());
    ct_json_end(j);
    ct_json_object(j, "error");
    ct_json_number(j, "energy_drift", r->energy_drift);
    ct_json_number(j, "position_constraint", r->position_constraint);
    ct_json_number(j, "velocity_constraint", r->velocity_constraint);
    const bool is_roundoff_limited = !sim->is_followed && r->roundoff_limited >= 0;
    ct_json_number(j, "rounding", is_roundoff_limited ? r->roundoff : NAN);
    ct_json_number(j, "rounding_sum", is_roundoff_limited ? r->roundoff_sum : NAN);
    ct_json_text(j, "rounding_of",
                 is_roundoff_limited ? sim->system->equations.result[r->roundoff_limited].name
                                     : NULL);
    write_estimate(j, sim);
    ct_json_end(j);
}

struct work {
    struct ct_ctx *ctx;
    const struct ct_sim *sim;
    const char *path;
    ct_summary_more_fn more;
    const void *user;
};

static void write_object(const struct work *w, FILE *out)
{
    const struct ct_sim *sim = w->sim;
    const struct ct_equations *e = &sim->system->equations;
    struct ct_json j;
    ct_json_init(&j, out);
    ct_json_object(&j, NULL);
    ct_json_text(&j, "model", sim->system->model.name);
    write_structure(&j, sim);
    write_work(&j, sim);
    write_open(&j, sim);
    if (w->more)
        w->more(&j, w->user);
    ct_json_object(&j, "final");
    for (size_t i = 0; i < e->nresult; i++)
        ct_json_number(&j, e->result[i].name, sim->report.final[i]);
    ct_json_end(&j);
    ct_json_end(&j);
}

static void write_summary(const void *sim, FILE *out)
{
    write_object(&(struct work){.sim = sim}, out);
}

static bool write_file(void *task)
{
    const struct work *w = task;
    struct ct_outfile file;
    enum ct_suffix unused;
    if (!ct_suffix_read(w->ctx, w->path, CT_SUFFIX_JSON, &unused)
        || !ct_outfile_open(w->ctx, &file, strcmp(w->path, "-") == 0 ? NULL : w->path))
        return false;
    write_object(w, file.stream);
    return ct_outfile_close(w->ctx, &file);
}

bool ct_summary_write(struct ct_ctx *ctx, const struct ct_sim *sim, const char *path,
                      ct_summary_more_fn more, const void *user)
{
    return write_file(&(struct work){ctx, sim, path, more, user});
}

bool ct_sim_write_summary(struct ct_ctx *ctx, const struct ct_sim *sim, const char *path)
{
    struct work w = {.ctx = ctx, .sim = sim, .path = path};
    return ctx && sim && path && ct_enter(ctx, write_file, &w);
}

char *ct_sim_summary_json(const struct ct_sim *sim)
{
    return ct_print_text(write_summary, sim);
}
