// Writes a system as C source in a folder. See exported.h.
#include "export/fmu.h"

#include "expr/print.h"
#include "formulate/dynamics/small_motion.h"
#include "formulate/outputs/output.h"
#include "report/outfile.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// ---- files ---------------------------------------------------------------------------------

static bool write_file(struct ct_exported *w, const char *suffix, const char *text)
{
    struct ct_outfile file;
    const char *path = ct_arena_printf(w->ctx->model, "%s/%s%s", w->place, w->x.name, suffix);
    if (!ct_outfile_open(w->ctx, &file, path))
        return false;
    fputs(text, file.stream);
    return ct_outfile_close(w->ctx, &file);
}

static bool make_folder(struct ct_exported *w)
{
    if (mkdir(w->place, 0777) == 0 || errno == EEXIST)
        return true;
    return ct_error(w->ctx, (struct ct_mark){0}, CT_E_FILE, "cannot make the folder '%s': %s",
                    w->place, strerror(errno));
}

// Makes M and Q available for export; a run without them is prepared again.
static bool want_dynamics(struct ct_sim *sim)
{
    struct ct_system *s = sim->system;
    if (s->equations.has_dynamics)
        return true;
    ct_formulate_dynamics(&s->equations);
    sim->run = ct_run_create(&sim->own, sim->own.model, &s->model, &s->equations, &sim->start);
    return sim->run != NULL;
}

// Finds the closed form of the accelerations, if the run has it.
static void find_solution(struct ct_exported *w)
{
    const struct ct_partition *s = ct_run_partition(w->sim->run);
    const struct ct_evaluator *m = s->m;
    w->x.rank = (size_t)s->rank;
    w->x.row = s->row;
    w->x.weakest = CT_LEAST_STRENGTH;
    if (m->solved.nout) {
        w->x.solved = m->solved.listing;
        w->x.nfree = m->nu;
    } else if (s->has_solver) {
        const struct ct_solver_code code = ct_solver_code(s->solver[0]);
        w->x.solved = code.listing;
        w->x.nfree = code.nfree;
        w->x.npivot = code.npivot;
        w->x.scale = code.scale;
    }
}

// ---- programs ------------------------------------------------------------------------------

static unsigned kinds_of_outputs(const struct ct_equations *e)
{
    unsigned kinds = 0;
    for (size_t i = 0; i < e->nresult; i++)
        kinds |= ct_ex_kinds(e->x, e->result[i].value);
    return kinds;
}

// Expressions of all parameters in terms of those that can be set.
static const struct ct_listing *list_parameters(struct ct_exported *w)
{
    struct ct_model *m = &w->sim->system->model;
    const size_t n = m->nparameter;
    ct_ex *symbol = CT_NEWN(w->sim->own.scratch, ct_ex, n + 1),
          *value = CT_NEWN(w->sim->own.scratch, ct_ex, n + 1);
    for (size_t i = 0; i < n; i++) {
        const struct ct_parameter *p = &m->parameter[i];
        symbol[i] = p->symbol;
        value[i] = ct_ex_is_const(m->x, p->definition, NULL)
                     ? p->symbol
                     : ct_ex_subst(m->x, p->definition, symbol, value, i);
    }
    return ct_evaluator_list(w->ctx->model, ct_run_evaluator(w->sim->run), m->x, value, n);
}

static const struct ct_listing *list_memory(struct ct_exported *w)
{
    const struct ct_equations *e = w->x.e;
    ct_ex *next = CT_NEWN(w->sim->own.scratch, ct_ex, e->nmemory + 1);
    for (size_t i = 0; i < e->nmemory; i++)
        next[i] = e->memory[i].update;
    return ct_evaluator_list(w->ctx->model, ct_run_evaluator(w->sim->run), e->x, next,
                             e->nmemory);
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// Lists the points of linear tables, where the method must begin a new step. Points of cubic
// tables are not listed: only their third derivatives are discontinuous there, which does not
// affect a method of order 4.
static void find_knots(struct ct_exported *w)
{
    const struct ct_exs *x = w->x.e->x;
    double *knot = NULL;
    size_t n = 0, cap = 0, kept = 0;
    for (size_t k = 0; k < x->ntable; k++)
        for (size_t i = 0; i < x->table[k].n && !x->table[k].m; i++)
            CT_PUSH(w->ctx->model, knot, n, cap, x->table[k].x[i]);
    if (n)
        qsort(knot, n, sizeof *knot, ascending);
    for (size_t i = 0; i < n; i++)
        if (kept == 0 || knot[i] > knot[kept - 1])
            knot[kept++] = knot[i];
    w->x.knot = knot;
    w->x.nknot = kept;
}

static bool is_driven(const struct ct_equations *e)
{
    for (size_t i = 0; i < e->nrow; i++)
        if (ct_ex_kinds(e->x, e->row[i].phi) & 1u << CT_SYM_TIME)
            return true;
    return e->ndriver > 0;
}

// Lists the data that determine the velocities after a jump in the rates of drivers. Errors:
// E560.
static bool list_jump(struct ct_exported *w)
{
    const struct ct_equations *e = w->x.e;
    struct ct_arena *a = w->ctx->model;
    if ((!e->nswitch && !w->x.nknot) || !is_driven(e))
        return true;
    if (!ct_ex_is_zero(e->continuity))
        return ct_error(
            w->ctx, w->sim->system->model.simulation.mark, CT_E_EXPORT,
            "'rate_jumps: continuous' cannot be exported where motions have switches "
            "or tables; leave it out, and rates jump by impulses");
    const size_t first = 2 * e->ndriver;
    ct_ex *out = CT_NEWN(a, ct_ex, first + e->nu + 1), *u = CT_NEWN(a, ct_ex, e->nu + 1);
    for (size_t i = 0; i < e->ndriver; i++) {
        out[2 * i] = e->driver[i].value;
        out[2 * i + 1] = e->driver[i].rate;
    }
    for (size_t i = 0; i < e->nu; i++)
        u[i] = e->u[i].symbol;
    ct_ex_gradient(e->x, a, e->kinetic, u, e->nu, out + first);
    if (e->is_small)
        ct_small_motion_momenta(e->build, out + first);
    out[first + e->nu] = e->kinetic;
    w->x.jump
        = ct_evaluator_list(a, ct_run_evaluator(w->sim->run), e->x, out, first + e->nu + 1);
    return true;
}

static bool list_reactions(struct ct_exported *w, struct ct_result **list)
{
    struct ct_build *b = w->sim->system->equations.build;
    struct ct_arena *a = w->sim->own.model; // as long as the run
    size_t n;
    if (!ct_outputs_list_reactions(b, list, &n))
        return false;
    ct_ex *value = CT_NEWN(a, ct_ex, n + 1);
    for (size_t i = 0; i < n; i++)
        value[i] = (*list)[i].value;
    ct_evaluator_add_program(a, ct_run_evaluator(w->sim->run), b->x, value, n, &w->reaction);
    w->x.reaction = w->reaction.listing;
    return true;
}

// Collects everything except the values for comparison.
static bool gather(struct ct_exported *w)
{
    struct ct_arena *a = w->ctx->model;
    const struct ct_evaluator *m = ct_run_evaluator(w->sim->run);
    const char *title = w->sim->system->model.name;
    const unsigned kinds = kinds_of_outputs(m->e), lam = 1u << CT_SYM_LAM;
    struct ct_result *reaction;
    w->x = (struct ct_export){.name = ct_c_name(a, title),
                              .title = title,
                              .e = m->e,
                              .motion = m->motion.listing,
                              .constraint = m->constraint.listing,
                              .output = m->result.listing,
                              .root = m->root.listing,
                              .power = m->power.nout ? m->power.listing : NULL,
                              .power_needs_lam = ct_ex_kinds(m->e->x, m->e->power) & lam,
                              .needs_a = kinds & (1u << CT_SYM_A | lam),
                              .needs_lam = kinds & lam,
                              .left_out = m->is_inexact ? m->left_out : NULL,
                              .open = m->open,
                              .at_q = m->at_q,
                              .at_u = m->at_u,
                              .at_a = m->at_a,
                              .at_lam = m->at_lam,
                              .at_switch = m->at_switch,
                              .at_memory = m->at_memory,
                              .at_work = m->at_work,
                              .ninput = m->ninput,
                              .state = w->state,
                              // Definition: the tolerance of assembly.
                              .closed = 1e-9,
                              .lanes = w->lanes};
    w->x.parameter = list_parameters(w);
    w->x.memory = list_memory(w);
    find_knots(w);
    find_solution(w);
    if (!list_reactions(w, &reaction) || !list_jump(w))
        return false;
    ct_exported_list_items(w, reaction);
    return true;
}

static bool write_json(struct ct_exported *w)
{
    struct ct_outfile file;
    if (!ct_outfile_open(w->ctx, &file,
                         ct_arena_printf(w->ctx->model, "%s/%s.json", w->place, w->x.name)))
        return false;
    ct_exported_write_json(w, file.stream);
    return ct_outfile_close(w->ctx, &file);
}

static bool export_c(struct ct_exported *w)
{
    struct ct_arena *a = w->ctx->model;
    ct_exported_record_motion(w);
    return make_folder(w) && write_file(w, ".h", ct_export_header(a, &w->x))
        && write_file(w, ".c", ct_export_source(a, &w->x))
        && write_file(w, "_test.c", ct_export_test(a, &w->x)) && write_json(w);
}

static bool export_as(struct ct_exported *w, const char *format)
{
    if (!want_dynamics(w->sim) || !gather(w) || !ct_exported_record_states(w))
        return false;
    return strcmp(format, "c") == 0
             ? export_c(w)
             : ct_fmu_write(w, strcmp(format, "fmu3") == 0 ? 3 : 2, w->place);
}

struct task {
    struct ct_ctx *ctx;
    struct ct_exported *w;
    const char *format;
};

static bool export_task(void *task)
{
    const struct task *t = task;
    struct ct_exported *w = t->w;
    const bool ok = export_as(w, t->format);
    if (w->reaction.listing) // it is on the caller's stack
        ct_evaluator_remove_program(ct_run_evaluator(w->sim->run), &w->reaction);
    ct_ctx_hand_over(t->ctx, w->ctx);
    return ok;
}

bool ct_sim_export(struct ct_ctx *ctx, struct ct_sim *sim, const char *format,
                   const char *place)
{
    return ct_sim_export_lanes(ctx, sim, format, place, 1);
}

bool ct_sim_export_lanes(struct ct_ctx *ctx, struct ct_sim *sim, const char *format,
                         const char *place, long lanes)
{
    if (!ctx || !sim || !place)
        return false;
    struct ct_exported w
        = {.ctx = &sim->own, .sim = sim, .place = place, .lanes = (unsigned)lanes};
    struct task task = {ctx, &w, format ? format : "c"};
    static const char *const formats[] = {"c", "fmu2", "fmu3"};
    bool is_known = !format;
    for (size_t i = 0; i < COUNT(formats) && !is_known; i++)
        is_known = strcmp(format, formats[i]) == 0;
    if (!is_known)
        return ct_error(ctx, (struct ct_mark){0}, CT_E_USAGE,
                        "there is no export format '%s'%s", format,
                        ct_suggest_or_list(ctx->model, format, formats, COUNT(formats)));
    if (lanes != 0 && lanes != 1 && lanes != 4 && lanes != 8)
        return ct_error(ctx, (struct ct_mark){0}, CT_E_USAGE,
                        "there are no %ld lanes; there are 1, 4 and 8", lanes);
    return ct_enter(ctx, export_task, &task);
}
