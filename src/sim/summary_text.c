// The summary of a run and of a system as text.
#include "sim/summary.h"

#include "formulate/beam/flexible_body.h"
#include "report/stage_beam.h"
#include "solve/singular/singular.h"
#include "solve/evaluator/tangent.h"
#include "formulate/beam/section_properties.h"

#include <math.h>
#include <string.h>

// ---- lists ---------------------------------------------------------------------------------

// A list with a title, broken into lines of limited width.
struct list {
    FILE *out;
    const char *title;
    int column; // 0: nothing written yet
};

// Layout: of the summary
enum { TITLE_WIDTH = 13, LINE_WIDTH = 100 };

static void add(struct list *l, const char *entry)
{
    const int n = (int)strlen(entry);
    if (!l->column)
        l->column = fprintf(l->out, "%-*s", TITLE_WIDTH, l->title);
    else if (l->column + n + 2 > LINE_WIDTH)
        l->column = fprintf(l->out, ",\n%*s", TITLE_WIDTH, "") - 2;
    else
        l->column += fprintf(l->out, ", ");
    l->column += fprintf(l->out, "%s", entry);
}

static void end_list(struct list *l)
{
    if (l->column)
        fputc('\n', l->out);
}

// ---- what a run did ------------------------------------------------------------------------

static bool same_trees(const struct ct_equations *e)
{
    for (int i = 0; i < e->graph->nedge; i++)
        if (e->T->is_branch[i] != e->R->is_branch[i])
            return false;
    return true;
}

static void print_branches(FILE *out, const char *title, const struct ct_equations *e,
                           const struct ct_tree *t)
{
    struct list l = {out, title, 0};
    for (int i = 0; i < t->nbranch; i++)
        if (!ct_is_arm(e, t->branch[i]))
            add(&l, e->edge_name[t->branch[i]]);
    if (!l.column)
        add(&l, "none");
    end_list(&l);
}

static void print_trees(FILE *out, const struct ct_equations *e)
{
    if (same_trees(e)) {
        print_branches(out, "branches", e, e->T);
        return;
    }
    print_branches(out, "translation", e, e->T);
    print_branches(out, "rotation", e, e->R);
}

static void print_freedoms(FILE *out, const struct ct_sim *sim)
{
    const struct ct_equations *e = &sim->system->equations;
    fprintf(out, "coordinates  %zu, speeds %zu, constraints %zu, redundant %ld, freedoms %ld",
            e->nq, e->nmotion, e->nrow, ct_sim_redundant(sim), ct_sim_freedoms(sim));
    if (e->nstate)
        fprintf(out, ", states %zu", e->nstate);
    fputc('\n', out);
}

// Prints for each coordinate of a joint its guess and its initial value; prescribed and driven
// ones only by their value.
static void print_start(FILE *out, const struct ct_sim *sim)
{
    enum { MOST_SHOWN = 100 }; // Layout: the rest is in the summary file
    struct list l = {out, "start", 0};
    size_t n = 0;
    char text[CT_MOST_START_TEXT];
    for (size_t i = 0; i < ct_sim_start_count(sim); i++)
        if (ct_sim_start_text(sim, i, text, sizeof text) && n++ < MOST_SHOWN)
            add(&l, text);
    const struct ct_model *m = &sim->system->model;
    for (size_t i = 0; i < m->nstate; i++)
        if (n++ < MOST_SHOWN) {
            snprintf(text, sizeof text, "%.80s = %.6g", m->state[i].name,
                     ct_model_number(m, m->state[i].initial));
            add(&l, text);
        }
    if (n > MOST_SHOWN) {
        snprintf(text, sizeof text, "%zu more", n - MOST_SHOWN);
        add(&l, text);
    }
    end_list(&l);
}

static void print_names(FILE *out, const char *title, const bool *is, size_t n,
                        const char *(*name)(const struct ct_equations *e, size_t i),
                        const struct ct_equations *e)
{
    struct list l = {out, title, 0};
    for (size_t i = 0; i < n; i++)
        if (is[i])
            add(&l, name(e, i));
    end_list(&l);
}

static const char *row_name(const struct ct_equations *e, size_t i)
{
    return e->row[i].name;
}

static const char *result_name(const struct ct_equations *e, size_t i)
{
    return e->result[i].name;
}

static void print_open_outputs(FILE *out, const char *title, const struct ct_sim *sim,
                               bool across_plane)
{
    const struct ct_equations *e = &sim->system->equations;
    struct list l = {out, title, 0};
    for (size_t i = 0; i < e->nresult; i++)
        if (sim->open.result[i] && e->result[i].undetermined == across_plane)
            add(&l, e->result[i].name);
    end_list(&l);
}

// Prints which forces are not unique. Redundant constraints share a load in many ways, and a
// planar model has no equations perpendicular to its plane.
static void print_open(FILE *out, const struct ct_sim *sim)
{
    const struct ct_equations *e = &sim->system->equations;
    print_names(out, "undetermined", sim->open.row, e->nrow, row_name, e);
    print_open_outputs(out, "note: redundant constraints do not determine the outputs ", sim,
                       false);
    print_open_outputs(
        out, "note: planar loops do not determine the outputs out of their plane ", sim, true);
}

// Prints the outputs with their errors, as many to a line as fit.
static void print_output_errors(FILE *out, const struct ct_sim *sim)
{
    const struct ct_equations *e = &sim->system->equations;
    const size_t most_shown = 24; // Layout: the rest is in the summary file
    // Layout: columns
    const int width = 88;
    const char *separator = "";
    int column = 0;
    for (size_t i = 0; i < e->nresult && i < most_shown; i++) {
        const struct ct_output_error_estimate *o = &sim->estimate.output[i];
        char text[24] = "zero";
        if (!isnan(o->relative))
            snprintf(text, sizeof text, "%.1e", o->relative);
        const int n = (int)(strlen(e->result[i].name) + strlen(text)) + 3;
        if (column && column + n > width) {
            fputs(",\n", out);
            separator = "";
            column = 0;
        }
        column += n;
        fprintf(out, "%s%s %s", *separator || column > n ? separator : "             ",
                e->result[i].name, text);
        separator = ", ";
    }
    if (e->nresult > most_shown)
        fprintf(out, ", %zu more", e->nresult - most_shown);
    fputc('\n', out);
}

static void print_estimate(FILE *out, const struct ct_sim *sim)
{
    const struct ct_estimate *e = &sim->estimate;
    const struct ct_equations *equations = &sim->system->equations;
    if (!e->how)
        return;
    if (!e->output) {
        fprintf(out, "global error not known: the second run, %s, failed: %s\n", e->how,
                e->why_not);
        return;
    }
    if (e->which < equations->nresult)
        fprintf(out, "global error %.1e in %s", e->worst, equations->result[e->which].name);
    else
        fputs("global error that of round-off, as all outputs are zero but for it", out);
    fprintf(out, ", estimated from a second run (%s, %.3g s)\n", e->how, sim->verify_seconds);
    print_output_errors(out, sim);
    if (e->holds_until < sim->time && sim->run_options.step == 0)
        fprintf(out, "note: more than ten times the tolerance after t = %.9g s\n",
                e->holds_until);
}

// Prints how an implicit method gets its derivatives, if the run used one.
static void print_derivatives(FILE *out, const struct ct_sim *sim)
{
    const struct ct_evaluator *m = ct_run_evaluator(sim->run);
    if (!m->nslope)
        return;
    if (m->lanes)
        fprintf(out, "derivatives  along %u directions, %d at a time\n",
                m->e->residual->along->ncolour, CT_TANGENT_LANES);
    else
        fprintf(out, "derivatives  table of %zu entries\n", m->nslope);
}

static void print_method(FILE *out, const struct ct_sim *sim)
{
    const struct ct_run_report *r = &sim->report;
    fprintf(out, "method       %s (%s), ", sim->run_options.method->name, sim->method_why);
    if (sim->run_options.step > 0)
        fprintf(out, "step %g s\n", sim->run_options.step);
    else
        fprintf(out, "tolerance %g\n", sim->tolerance);
    fprintf(
        out,
        "work         %ld steps, %ld rejected (%ld for their error), %ld evaluations of %ld "
        "operations (%s)\n",
        r->stats.steps, r->stats.rejected_steps, r->stats.inaccurate_steps,
        r->stats.evaluations, ct_sim_operations(sim), ct_run_evaluator(sim->run)->backend);
    if (r->stats.jacobians > 0)
        print_derivatives(out, sim);
}

static void print_position(FILE *out, const struct ct_sim *sim,
                           const struct ct_singular_configuration *at)
{
    // Layout: of the summary
    enum { MOST_NAMES = 8 };
    const struct ct_equations *e = &sim->system->equations;
    int nname = 0;
    fprintf(out, "%*st = %.6g s", TITLE_WIDTH, "", at->t);
    if (at->rank_loss)
        fprintf(out, ", rank less by %d at", at->rank_loss);
    for (size_t i = 0; i < e->nrow && at->rank_loss; i++)
        if (ct_is_first_of_joint(e, at->row, i) && nname++ < MOST_NAMES)
            fprintf(out, "%s%s", nname > 1 ? ", " : " ", ct_row_owner(sim, i));
    if (nname > MOST_NAMES)
        fprintf(out, " and %d more", nname - MOST_NAMES);
    fputc('\n', out);
}

static void print_singular(FILE *out, const struct ct_sim *sim)
{
    // Layout: of the summary
    enum { MOST_SHOWN = 5 };
    const struct ct_rank_monitor *w = sim->report.singular;
    if (!w || !w->npassed)
        return;
    fprintf(out, "singular     %ld position%s passed%s\n", w->npassed,
            w->npassed == 1 ? "" : "s", w->npassed > MOST_SHOWN ? "; the first:" : ":");
    for (long i = 0; i < w->npassed && i < MOST_SHOWN; i++)
        print_position(out, sim, &w->passed[i]);
}

// Prints the formulations that the program chose, with the reasons.
static void print_choices(FILE *out, const struct ct_equations *e)
{
    for (size_t i = 0; i < e->build->nflexible; i++) {
        const struct ct_flexible *f = &e->build->flexible[i];
        if (f->why)
            fprintf(out, "beam         %s: %s (%s)\n", f->name,
                    ct_beam_formulation_name(f->formulation), f->why);
    }
}

static void print_roundoff(FILE *out, const struct ct_sim *sim)
{
    const struct ct_run_report *r = &sim->report;
    if (sim->is_followed || r->roundoff_limited < 0)
        return;
    if (isnan(r->roundoff)) {
        fprintf(out,
                "round-off    inertias that are small differences of larger ones lose digits: "
                "the error comes to some %.1e of the largest %s\n",
                r->roundoff_sum, sim->system->equations.result[r->roundoff_limited].name);
        return;
    }
    fprintf(out,
            "round-off    a round-off error of the coordinates causes an error of %.1e of the "
            "largest "
            "%s: smaller steps do not help",
            r->roundoff, sim->system->equations.result[r->roundoff_limited].name);
    if (!isnan(r->roundoff_sum))
        fprintf(out, ", and those of %ld steps add up to some %.1e", r->explicit_steps,
                r->roundoff_sum);
    fputc('\n', out);
}

static void print_file(FILE *out, const struct ct_sim *sim)
{
    const char *path = ct_sim_results_path(sim, false);
    if (path)
        fprintf(out, "results      %ld samples in %s\n", sim->nwritten, path);
}

static void print_summary(const void *object, FILE *out)
{
    const struct ct_sim *sim = object;
    const struct ct_run_report *r = &sim->report;
    fprintf(out, "%s: t = %.9g s\n", sim->system->model.name, sim->time);
    print_freedoms(out, sim);
    print_start(out, sim);
    fprintf(out, "tree         %s\n", sim->system->tree.how);
    print_trees(out, &sim->system->equations);
    print_choices(out, &sim->system->equations);
    if (sim->is_followed)
        fputs("method       motions followed, nothing integrated\n", out);
    else
        print_method(out, sim);
    fprintf(out, "error        energy drift %.2g, constraints %.2g, their rates %.2g\n",
            r->energy_drift, r->position_constraint, r->velocity_constraint);
    print_roundoff(out, sim);
    print_singular(out, sim);
    print_estimate(out, sim);
    fprintf(out,
            "seconds      read %.3g, generate %.3g, compile %.3g, integrate %.3g, write %.3g\n",
            sim->system->read, sim->system->generate, sim->compile, sim->integrate, sim->write);
    print_open(out, sim);
    print_file(out, sim);
}

void ct_sim_print_summary(const struct ct_sim *sim, FILE *out)
{
    ct_print_to(out, print_summary, sim);
}

char *ct_sim_summary(const struct ct_sim *sim)
{
    return ct_print_text(print_summary, sim);
}

// ---- what a system is ----------------------------------------------------------------------

struct part {
    long n;
    const char *one, *many;
};

static void print_parts(FILE *out, const char *title, const struct part *part, size_t n)
{
    fprintf(out, "%-*s", TITLE_WIDTH, title);
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%s%ld %s", i ? ", " : "", part[i].n,
                part[i].n == 1 ? part[i].one : part[i].many);
    fputc('\n', out);
}

static void print_counts(FILE *out, const char *title, const struct ct_program *p)
{
    const struct ct_tape_counts c = p->listing->counts;
    const struct part parts[] = {{c.multiplications, "multiplication", "multiplications"},
                                 {c.additions, "addition", "additions"},
                                 {c.divisions, "division", "divisions"},
                                 {c.functions, "function", "functions"}};
    print_parts(out, title, parts, COUNT(parts));
}

static void print_formulation(FILE *out, const struct ct_equations *e)
{
    fprintf(out, "formulation  %s", ct_formulation_names[e->formulation].name);
    if (e->formulation && !e->solution)
        fputs(", solved as a dense matrix", out);
    for (int i = 0; i < CT_NFORMULATION && e->formulation; i++) { // the chosen one first
        const int k = i == 0 ? (int)e->formulation : i;
        if ((i > 0 && k == (int)e->formulation) || !isfinite(e->formulation_cost[k]))
            continue;
        if (i == 0)
            fprintf(out, ", predicted cost %.0f", e->formulation_cost[k]);
        else
            fprintf(out, "; %s %.0f", ct_formulation_names[k].name, e->formulation_cost[k]);
    }
    fputc('\n', out);
}

// Prints the redundant rows by joint.
static void print_redundant(FILE *out, const struct ct_sim *sim)
{
    const struct ct_partition *s = ct_run_partition(sim->run);
    const struct ct_equations *e = &sim->system->equations;
    if (s->rank == (int)e->nrow)
        return;
    struct list l = {out, "redundant", 0};
    for (int i = s->rank; i < (int)e->nrow; i++) {
        const struct ct_row *row = &e->row[s->row[i]];
        const char *joint = row->joint < 0 ? NULL : sim->system->model.joint[row->joint].name;
        // rows are named after their joint: "pin.z"
        const bool is_told = !joint || strncmp(joint, row->name, strlen(joint)) == 0;
        add(&l, is_told
                    ? row->name
                    : ct_arena_printf(e->build->arena, "%s (of joint %s)", row->name, joint));
    }
    end_list(&l);
}

// Prints the solver, with the reason if the program chose it.
static void print_solver(FILE *out, const struct ct_sim *sim)
{
    const struct ct_partition *s = ct_run_partition(sim->run);
    const struct ct_solver_costs *c = &s->costs;
    const double cost[] = {c->symbolic, c->symbolic_kkt, c->sparse, c->dense};
    static const char *const name[] = {"unrolled", "as one system", "sparse", "dense"};
    fprintf(out, "solver       %s", ct_sim_solver(sim));
    if (sim->solver)
        fputs(", as requested", out);
    else if (c->dense > 0) {
        fputs("; predicted costs in operations:", out);
        for (size_t i = 0; i < COUNT(cost); i++) {
            const char *separator = i ? "," : "";
            if (isfinite(cost[i]))
                fprintf(out, "%s %s %.0f", separator, name[i], cost[i]);
            else
                fprintf(out, "%s %s %s", separator, name[i],
                        isnan(cost[i]) ? "not tried" : "given up");
        }
    }
    fputc('\n', out);
}

static void print_beams(FILE *out, const struct ct_equations *e)
{
    for (size_t i = 0; i < e->build->nflexible; i++) {
        const struct ct_flexible *f = &e->build->flexible[i];
        fprintf(out, "beam         %s: %s\n", f->name, ct_beam_sentence(e->build->arena, f));
        // Layout: a contribution of a tenth of the stiffness is printed.
        const double locking = ct_flexible_locking(e->build, f), notable = 0.1;
        if (locking > notable)
            fprintf(out,
                    "             its elements lock: shear makes them %.3g times as stiff in "
                    "bending as they are; take `integration: reduced` or more elements\n",
                    1 + locking);
    }
}

static void print_check(const void *object, FILE *out)
{
    const struct ct_sim *sim = object;
    const struct ct_system *s = sim->system;
    const struct ct_model *m = &s->model;
    const struct ct_equations *e = &s->equations;
    const struct ct_evaluator *machine = ct_run_evaluator(sim->run);
    size_t ninput = 0;
    for (size_t i = 0; i < m->nparameter; i++)
        ninput += m->parameter[i].is_input;
    fprintf(out, "%s\n", m->name);
    if (*m->description)
        fprintf(out, "%s\n", m->description);
    const struct part parts[] = {{(long)m->nbody - 1, "body", "bodies"},
                                 {(long)m->njoint, "joint", "joints"},
                                 {(long)m->nforce, "force", "forces"},
                                 {(long)(m->nparameter - ninput), "parameter", "parameters"},
                                 {(long)m->noutput, "output", "outputs"},
                                 {(long)ninput, "input", "inputs"},
                                 {(long)m->nstate, "state", "states"}};
    print_parts(out, "model", parts, m->nstate ? 7 : ninput ? 6 : 5);
    print_freedoms(out, sim);
    fprintf(out, "freedoms     %ld = %zu speeds - rank %d of the constraints\n",
            ct_sim_freedoms(sim), e->nmotion, sim->report.rank);
    print_redundant(out, sim);
    print_names(out, "undetermined", sim->open.row, e->nrow, row_name, e);
    print_names(out, "undetermined outputs: ", sim->open.result, e->nresult, result_name, e);
    print_start(out, sim);
    fprintf(out, "tree         %s", s->tree.how);
    if (s->tree.cost > 0)
        fprintf(out, ", cost %.0f (least weight: %.0f)", s->tree.cost,
                s->tree.cost_least_weight);
    fputc('\n', out);
    print_trees(out, e);
    print_beams(out, e);
    for (size_t i = 0; i < e->nleft_out; i++)
        fprintf(out, "left out     %s: %s\n", e->left_out[i].what, e->left_out[i].why);
    print_formulation(out, e);
    if (machine->solved.nout)
        print_counts(out, "solution", &machine->solved);
    if (e->has_dynamics)
        print_counts(out, "motion", &machine->motion);
    print_counts(out, "constraints", &machine->constraint);
    print_solver(out, sim);
    print_derivatives(out, sim);
    fprintf(out, "evaluation   %ld operations, solving for accelerations included\n",
            ct_sim_operations(sim));
    if (ct_sim_refuses_batch(sim))
        fprintf(out, "sweeps       one by one: %s\n", ct_sim_refuses_batch(sim));
}

void ct_sim_print_check(const struct ct_sim *sim, FILE *out)
{
    ct_print_to(out, print_check, sim);
}

char *ct_sim_check(const struct ct_sim *sim)
{
    return ct_print_text(print_check, sim);
}
