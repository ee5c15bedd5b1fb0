// What a run did, for people and for programs, and what a system is.
#include "api.h"

#include "report/json.h"
#include "formulate/flexible.h"
#include "solve/singular.h"
#include "solve/tangent.h"
#include "report/stage_beam.h"

#if defined(__unix__) || defined(__APPLE__)
#include <sys/resource.h>
#endif

#include <math.h>
#include <string.h>

// ---- numbers ---------------------------------------------------------------------------------------

static long count(const struct ct_tape_counts *c)
{
    return c->multiplications + c->additions + c->divisions + c->functions;
}

static long operations(const struct ct_sim *sim)
{
    const struct ct_machine *m = ct_run_machine(sim->run);
    if (m->solved.nout) {
        const struct ct_tape_counts all = m->solved.listing->counts;
        return count(&all);
    }
    const struct ct_embed *embed = ct_run_embed(sim->run);
    if (embed->nform)
        return (long)embed->form[0]->operations;
    const struct ct_tape_counts c = m->motion.listing->counts;
    return count(&c) + (long)ct_embed_operations(embed);
}

// What finds the accelerations.
static const char *solver(const struct ct_sim *sim)
{
    const struct ct_embed *embed = ct_run_embed(sim->run);
    return !embed->m->nu         ? "none"
         : embed->m->solved.nout ? "unrolled"
         : embed->nform          ? embed->form[0]->kind->name
                                 : "dense";
}

// The report has none before the run.
static const struct ct_method *last_method(const struct ct_sim *sim)
{
    return sim->report.method ? sim->report.method : sim->run_options.method;
}

static long freedoms(const struct ct_sim *sim)
{
    return (long)sim->system->equations.nu - sim->report.rank;
}

static long redundant(const struct ct_sim *sim)
{
    return (long)sim->system->equations.nrow - sim->report.rank;
}

static bool is_arm(const struct ct_equations *e, int edge)
{
    return e->build->edge[edge].kind == CT_EDGE_ARM;
}

static bool same_trees(const struct ct_equations *e)
{
    for (int i = 0; i < e->graph->nedge; i++)
        if (e->T->is_branch[i] != e->R->is_branch[i])
            return false;
    return true;
}

// Most memory the process has had [bytes]; 0 where the system does not say.
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

// ---- for programs ---------------------------------------------------------------------------------

// Edges that are branches (chords) of one of the two trees at least.
static void write_edges(struct ct_json *j, const struct ct_equations *e, const char *key,
                        bool branches)
{
    ct_json_array(j, key);
    for (int i = 0; i < e->graph->nedge; i++)
        if (e->T->is_branch[i] == branches || e->R->is_branch[i] == branches)
            ct_json_text(j, NULL, e->edge_name[i]);
    ct_json_end(j);
}

// As a tree file: branches that are not arms.
static void write_tree(struct ct_json *j, const struct ct_equations *e, const char *key,
                       const struct ct_tree *t)
{
    ct_json_array(j, key);
    for (int i = 0; i < t->nbranch; i++)
        if (!is_arm(e, t->branch[i]))
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

static void write_structure(struct ct_json *j, const struct ct_sim *sim)
{
    const struct ct_equations *e = &sim->system->equations;
    ct_json_integer(j, "coordinates", (long)e->nq);
    ct_json_integer(j, "speeds", (long)e->nu);
    ct_json_integer(j, "constraints", (long)e->nrow);
    ct_json_integer(j, "redundant", redundant(sim));
    ct_json_integer(j, "degrees_of_freedom", freedoms(sim));
    ct_json_bool(j, "planar", e->is_planar);
    write_edges(j, e, "tree", true);
    write_edges(j, e, "cotree", false);
    ct_json_object(j, "trees");
    write_tree(j, e, "translation", e->T);
    write_tree(j, e, "rotation", e->R);
    ct_json_end(j);
    ct_json_text(j, "tree_choice", sim->system->tree.how);
    write_left_out(j, e);
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

// Null without --verify, and where the second run failed.
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

// How accelerations are formulated, and the predicted cost of what it was chosen from.
static const struct {
    const char *key, *name;
} formulation[CT_NFORMULATION] = {{"embedding", "embedding of the constraints"},
                                  {"cutsets", "cutset sums"},
                                  {"composite", "composite bodies"},
                                  {"articulated", "articulated bodies"}};

static void write_formulation(struct ct_json *j, const struct ct_equations *e)
{
    ct_json_text(j, "formulation", formulation[e->formulation].key);
    ct_json_object(j, "formulation_costs");
    for (int k = CT_FORMULATION_CUTSETS; k < CT_NFORMULATION && e->formulation; k++)
        if (isfinite(e->formulation_cost[k]))
            ct_json_number(j, formulation[k].key, e->formulation_cost[k]);
    ct_json_end(j);
}

// Validity indicators of linear beams.
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
        ct_json_end(j);
    }
    ct_json_end(j);
}

// Is row i the first of its joint among those that depend there? Rows of no joint count for themselves.
static bool is_first_of_joint(const struct ct_equations *e, const bool *row, size_t i)
{
    for (size_t k = 0; k < i && e->row[i].joint >= 0; k++)
        if (row[k] && e->row[k].joint == e->row[i].joint)
            return false;
    return row[i];
}

static const char *owner(const struct ct_sim *sim, size_t row)
{
    const struct ct_row *r = &sim->system->equations.row[row];
    return r->joint < 0 ? r->name : sim->system->model.joint[r->joint].name;
}

static void write_position(struct ct_json *j, const struct ct_sim *sim,
                           const struct ct_singular_position *at)
{
    const struct ct_equations *e = &sim->system->equations;
    ct_json_object(j, NULL);
    ct_json_number(j, "time", at->t);
    if (at->rank_loss) {
        ct_json_integer(j, "rank_loss", at->rank_loss);
        ct_json_array(j, "joints");
        for (size_t i = 0; i < e->nrow; i++)
            if (is_first_of_joint(e, at->row, i))
                ct_json_text(j, NULL, owner(sim, i));
        ct_json_end(j);
    }
    ct_json_end(j);
}

static long kept_positions(const struct ct_singular *w)
{
    return w->npassed < CT_MOST_SINGULAR ? w->npassed : CT_MOST_SINGULAR;
}

static void write_singular(struct ct_json *j, const struct ct_sim *sim)
{
    const struct ct_singular *w = sim->report.singular;
    ct_json_integer(j, "singular_positions_passed", w ? w->npassed : 0);
    ct_json_array(j, "singular_positions");
    for (long i = 0; w && i < kept_positions(w); i++)
        write_position(j, sim, &w->passed[i]);
    ct_json_end(j);
}

static void write_work(struct ct_json *j, const struct ct_sim *sim)
{
    const struct ct_run_report *r = &sim->report;
    ct_json_text(j, "method", last_method(sim)->name);
    ct_json_text(j, "method_why", sim->method_why);
    ct_json_number(j, "tolerance", sim->tolerance);
    ct_json_text(j, "backend", ct_run_machine(sim->run)->backend);
    ct_json_text(j, "solver", solver(sim));
    write_formulation(j, &sim->system->equations);
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
    ct_json_integer(j, "operations", operations(sim));
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
    ct_json_integer(j, "code", (long)ct_machine_code_size(ct_run_machine(sim->run)));
    ct_json_integer(j, "peak", peak_memory());
    ct_json_end(j);
    ct_json_object(j, "error");
    ct_json_number(j, "energy_drift", r->energy_drift);
    ct_json_number(j, "position_constraint", r->position_constraint);
    ct_json_number(j, "velocity_constraint", r->velocity_constraint);
    write_estimate(j, sim);
    ct_json_end(j);
}

static void write_summary(FILE *out, const struct ct_sim *sim)
{
    const struct ct_equations *e = &sim->system->equations;
    struct ct_json j;
    ct_json_init(&j, out);
    ct_json_object(&j, NULL);
    ct_json_text(&j, "model", sim->system->model.name);
    write_structure(&j, sim);
    write_work(&j, sim);
    write_open(&j, sim);
    ct_json_object(&j, "final");
    for (size_t i = 0; i < e->nresult; i++)
        ct_json_number(&j, e->result[i].name, sim->report.final[i]);
    ct_json_end(&j);
    ct_json_end(&j);
}

struct work {
    struct ct_ctx *ctx;
    const struct ct_sim *sim;
    const char *path;
};

static bool write_file(void *task)
{
    const struct work *w = task;
    struct ct_outfile file;
    if (!ct_outfile_open(w->ctx, &file, strcmp(w->path, "-") == 0 ? NULL : w->path))
        return false;
    write_summary(file.stream, w->sim);
    return ct_outfile_close(w->ctx, &file);
}

bool ct_sim_write_summary(struct ct_ctx *ctx, const struct ct_sim *sim, const char *path)
{
    struct work w = {ctx, sim, path};
    return sim && ct_enter(ctx, write_file, &w);
}

// ---- for people ---------------------------------------------------------------------------------------

// A titled list, broken into lines that fit.
struct list {
    FILE *out;
    const char *title;
    int column; // 0: nothing is written yet
};

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

static void print_branches(FILE *out, const char *title, const struct ct_equations *e,
                           const struct ct_tree *t)
{
    struct list l = {out, title, 0};
    for (int i = 0; i < t->nbranch; i++)
        if (!is_arm(e, t->branch[i]))
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
    fprintf(out, "coordinates  %zu, speeds %zu, constraints %zu, redundant %ld, freedoms %ld\n",
            e->nq, e->nu, e->nrow, redundant(sim), freedoms(sim));
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

// Redundant constraints leave some forces open: which.
static void print_open(FILE *out, const struct ct_sim *sim)
{
    const struct ct_equations *e = &sim->system->equations;
    print_names(out, "undetermined", sim->open.row, e->nrow, row_name, e);
    print_names(out, "note: redundant constraints do not determine the outputs ",
                sim->open.result, e->nresult, result_name, e);
}

// The outputs with their errors, so many to a line as fit.
static void print_output_errors(FILE *out, const struct ct_sim *sim)
{
    const struct ct_equations *e = &sim->system->equations;
    const size_t most_shown = 24; // the rest is in the summary file
    const int width = 88;
    const char *separator = "";
    int column = 0;
    for (size_t i = 0; i < e->nresult && i < most_shown; i++) {
        const struct ct_output_error *o = &sim->estimate.output[i];
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
    fprintf(out, "global error %.1e", e->worst);
    if (e->which < equations->nresult)
        fprintf(out, " in %s", equations->result[e->which].name);
    fprintf(out, ", estimated from a second run (%s, %.3g s)\n", e->how, sim->verify_seconds);
    print_output_errors(out, sim);
    if (e->holds_until < sim->time && sim->run_options.step == 0)
        fprintf(out, "note: more than ten times the tolerance after t = %.9g s\n",
                e->holds_until);
}

// How implicit methods get their derivatives, where one runs.
static void print_derivatives(FILE *out, const struct ct_sim *sim)
{
    const struct ct_machine *m = ct_run_machine(sim->run);
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
        r->stats.evaluations, operations(sim), ct_run_machine(sim->run)->backend);
    if (r->stats.jacobians > 0)
        print_derivatives(out, sim);
}

static void print_position(FILE *out, const struct ct_sim *sim,
                           const struct ct_singular_position *at)
{
    enum { MOST_NAMES = 8 };
    const struct ct_equations *e = &sim->system->equations;
    int nname = 0;
    fprintf(out, "%*st = %.6g s", TITLE_WIDTH, "", at->t);
    if (at->rank_loss)
        fprintf(out, ", rank less by %d at", at->rank_loss);
    for (size_t i = 0; i < e->nrow && at->rank_loss; i++)
        if (is_first_of_joint(e, at->row, i) && nname++ < MOST_NAMES)
            fprintf(out, "%s%s", nname > 1 ? ", " : " ", owner(sim, i));
    if (nname > MOST_NAMES)
        fprintf(out, " and %d more", nname - MOST_NAMES);
    fputc('\n', out);
}

static void print_singular(FILE *out, const struct ct_sim *sim)
{
    enum { MOST_SHOWN = 5 };
    const struct ct_singular *w = sim->report.singular;
    if (!w || !w->npassed)
        return;
    fprintf(out, "singular     %ld position%s passed%s\n", w->npassed,
            w->npassed == 1 ? "" : "s", w->npassed > MOST_SHOWN ? "; the first:" : ":");
    for (long i = 0; i < w->npassed && i < MOST_SHOWN; i++)
        print_position(out, sim, &w->passed[i]);
}

void ct_sim_print_summary(const struct ct_sim *sim, FILE *out)
{
    const struct ct_run_report *r = &sim->report;
    fprintf(out, "%s: t = %.9g s\n", sim->system->model.name, sim->time);
    print_freedoms(out, sim);
    fprintf(out, "tree         %s\n", sim->system->tree.how);
    print_trees(out, &sim->system->equations);
    if (sim->is_followed)
        fputs("method       motions followed, nothing integrated\n", out);
    else
        print_method(out, sim);
    fprintf(out, "error        energy drift %.2g, constraints %.2g, their rates %.2g\n",
            r->energy_drift, r->position_constraint, r->velocity_constraint);
    print_singular(out, sim);
    print_estimate(out, sim);
    fprintf(out,
            "seconds      read %.3g, generate %.3g, compile %.3g, integrate %.3g, write %.3g\n",
            sim->system->read, sim->system->generate, sim->compile, sim->integrate, sim->write);
    print_open(out, sim);
}

// ---- what a system is ----------------------------------------------------------------------------------

static void print_counts(FILE *out, const char *title, const struct ct_program *p)
{
    const struct ct_tape_counts c = p->listing->counts;
    fprintf(out, "%-13s%ld multiplications, %ld additions, %ld divisions, %ld functions\n",
            title, c.multiplications, c.additions, c.divisions, c.functions);
}

static void print_formulation(FILE *out, const struct ct_equations *e)
{
    fprintf(out, "formulation  %s", formulation[e->formulation].name);
    if (e->formulation && !e->solution)
        fputs(", solved as a dense matrix", out);
    for (int i = 0; i < CT_NFORMULATION && e->formulation; i++) { // the chosen one first
        const int k = i == 0 ? (int)e->formulation : i;
        if ((i > 0 && k == (int)e->formulation) || !isfinite(e->formulation_cost[k]))
            continue;
        if (i == 0)
            fprintf(out, ", predicted cost %.0f", e->formulation_cost[k]);
        else
            fprintf(out, "; %s %.0f", formulation[k].name, e->formulation_cost[k]);
    }
    fputc('\n', out);
}

// The rows that take no part in the dynamics, by joint.
static void print_redundant(FILE *out, const struct ct_sim *sim)
{
    const struct ct_embed *s = ct_run_embed(sim->run);
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

// The solver, chosen by what it is predicted to cost, and what dense matrices would.
static void print_solver(FILE *out, const struct ct_sim *sim)
{
    const struct ct_machine *m = ct_run_machine(sim->run);
    const struct ct_tape_counts motion = m->motion.listing->counts;
    const long matrices = count(&motion) + (long)ct_embed_operations(ct_run_embed(sim->run));
    fprintf(out, "solver       %s", solver(sim));
    if (m->nrow && strcmp(solver(sim), "dense") != 0)
        fprintf(out, "; with dense matrices an evaluation would be %ld operations", matrices);
    fputc('\n', out);
}

static void print_beams(FILE *out, const struct ct_equations *e)
{
    for (size_t i = 0; i < e->build->nflexible; i++) {
        const struct ct_flexible *f = &e->build->flexible[i];
        fprintf(out, "beam         %s: %s\n", f->name, ct_beam_sentence(e->build->arena, f));
    }
}

void ct_sim_print_check(const struct ct_sim *sim, FILE *out)
{
    const struct ct_system *s = sim->system;
    const struct ct_model *m = &s->model;
    const struct ct_equations *e = &s->equations;
    const struct ct_machine *machine = ct_run_machine(sim->run);
    fprintf(out, "%s\n", m->name);
    if (*m->description)
        fprintf(out, "%s\n", m->description);
    const struct {
        size_t n;
        const char *one, *many;
    } parts[] = {{m->nbody - 1, "body", "bodies"},
                 {m->njoint, "joint", "joints"},
                 {m->nforce, "force", "forces"},
                 {m->nparameter, "parameter", "parameters"},
                 {m->noutput, "output", "outputs"}};
    for (size_t i = 0; i < COUNT(parts); i++)
        fprintf(out, "%s%zu %s", i ? ", " : "model        ", parts[i].n,
                parts[i].n == 1 ? parts[i].one : parts[i].many);
    fputc('\n', out);
    print_freedoms(out, sim);
    fprintf(out, "freedoms     %ld = %zu speeds - rank %d of the constraints\n", freedoms(sim),
            e->nu, sim->report.rank);
    print_redundant(out, sim);
    print_names(out, "undetermined", sim->open.row, e->nrow, row_name, e);
    print_names(out, "undetermined outputs: ", sim->open.result, e->nresult, result_name, e);
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
            operations(sim));
}
