// A system as C source in a folder, with values to compare with.
#include "sim/sim.h"

#include "codegen/export.h"
#include "expr/print.h"
#include "report/outfile.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

struct work {
    struct ct_ctx *ctx;
    struct ct_sim *sim;
    const char *folder;
    unsigned lanes;
    struct ct_export x;
    struct ct_export_state state[3];
};

// ---- recorded values ------------------------------------------------------------------------------

static const double *copy(struct ct_arena *a, const double *v, size_t n)
{
    double *c = CT_NEWN(a, double, n + 1);
    if (n)
        memcpy(c, v, n * sizeof *v);
    return c;
}

// All values at the state y; false if the equations are singular there, or rates break constraints: with
// redundant rows accelerations mean something only where they are met.
static bool record(struct work *w, const double *y)
{
    struct ct_arena *a = w->ctx->model;
    struct ct_evaluator *m = ct_run_evaluator(w->sim->run);
    struct ct_partition *s = ct_run_partition(w->sim->run);
    const double met = 1e-8; // assembled to about 1e-12, in metres and radians
    ct_evaluator_set(m, 0, y);
    ct_evaluator_constraint(m);
    for (size_t i = 0; i < 2 * m->nrow; i++)
        if (!(fabs(m->constraint.out[i]) <= met))
            return false;
    const double *constraint = copy(a, m->constraint.out, m->constraint.nout);
    ct_evaluator_dynamics(m);
    if (ct_partition_accelerate(s) != CT_EVAL_OK)
        return false;
    w->state[w->x.nstate++] = (struct ct_export_state){copy(a, m->input, m->ninput),
                                                       copy(a, m->motion.out, m->motion.nout),
                                                       constraint, copy(a, s->a, m->nu)};
    return true;
}

// The start; with its speeds doubled; in open systems somewhere else. Elastic coordinates stay: the accelerations of a bent
// stiff beam are so large that round-off alone makes them differ.
static bool record_states(struct work *w)
{
    const struct ct_evaluator *m = ct_run_evaluator(w->sim->run);
    const double *start = ct_run_state(w->sim->run);
    const size_t ny = m->nq + m->nu + 1;
    double *y = CT_NEWN(w->ctx->model, double, ny), *d = CT_NEWN(w->ctx->model, double, ny);
    if (!record(w, start))
        return ct_error(w->ctx, (struct ct_mark){.file = w->sim->system->model.file},
                        CT_E_SINGULAR, "the equations are singular at the start");
    memcpy(y, start, ny * sizeof *y);
    for (size_t i = 0; i < m->nu; i++) {
        y[m->nq + i] *= 2;
        d[i] = m->e->u[i].beam ? 0 : 0.1 + 0.01 * (double)(i % 10);
    }
    record(w, y);
    if (m->nrow == 0) {
        ct_evaluator_retract(m, y, d);
        for (size_t i = 0; i < m->nu; i++)
            y[m->nq + i] += d[i];
        record(w, y);
    }
    ct_evaluator_set(ct_run_evaluator(w->sim->run), 0, start);
    return true;
}

// ---- files ----------------------------------------------------------------------------------------

static bool write_file(struct work *w, const char *suffix, const char *text)
{
    struct ct_outfile file;
    const char *path = ct_arena_printf(w->ctx->model, "%s/%s%s", w->folder, w->x.name, suffix);
    if (!ct_outfile_open(w->ctx, &file, path))
        return false;
    fputs(text, file.stream);
    return ct_outfile_close(w->ctx, &file);
}

static bool make_folder(struct work *w)
{
    if (mkdir(w->folder, 0777) == 0 || errno == EEXIST)
        return true;
    return ct_error(w->ctx, (struct ct_mark){0}, CT_E_FILE, "cannot make the folder '%s': %s",
                    w->folder, strerror(errno));
}

// M and Q are what is exported; a run that had no use for them is made again.
static bool want_dynamics(struct ct_sim *sim)
{
    struct ct_system *s = sim->system;
    if (s->equations.has_dynamics)
        return true;
    ct_formulate_dynamics(&s->equations);
    sim->run = ct_run_create(&sim->own, sim->own.model, &s->model, &s->equations, &sim->start);
    return sim->run != NULL;
}

// Accelerations in closed form, where the run has them.
static void find_solution(struct work *w)
{
    const struct ct_partition *s = ct_run_partition(w->sim->run);
    const struct ct_evaluator *m = s->m;
    w->x.rank = (size_t)s->rank;
    w->x.weakest = ct_solver_least_strength;
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

static bool write_c(void *task)
{
    struct work *w = task;
    if (!want_dynamics(w->sim))
        return false;
    struct ct_arena *a = w->ctx->model;
    const struct ct_evaluator *m = ct_run_evaluator(w->sim->run);
    const char *title = w->sim->system->model.name;
    w->x = (struct ct_export){.name = ct_c_name(a, title),
                              .title = title,
                              .e = m->e,
                              .motion = m->motion.listing,
                              .constraint = m->constraint.listing,
                              .at_q = m->at_q,
                              .at_u = m->at_u,
                              .at_switch = m->at_switch,
                              .at_memory = m->at_memory,
                              .ninput = m->ninput,
                              .state = w->state,
                              .lanes = w->lanes};
    find_solution(w);
    return make_folder(w) && record_states(w) && write_file(w, ".h", ct_export_header(a, &w->x))
        && write_file(w, ".c", ct_export_source(a, &w->x))
        && write_file(w, "_test.c", ct_export_test(a, &w->x));
}

bool ct_sim_export(struct ct_ctx *ctx, struct ct_sim *sim, const char *format,
                   const char *folder)
{
    return ct_sim_export_lanes(ctx, sim, format, folder, 1);
}

bool ct_sim_export_lanes(struct ct_ctx *ctx, struct ct_sim *sim, const char *format,
                         const char *folder, long lanes)
{
    struct work w = {.ctx = ctx, .sim = sim, .folder = folder, .lanes = (unsigned)lanes};
    if (!ctx || !sim || !folder)
        return false;
    if (format && strcmp(format, "c") != 0)
        return ct_error(ctx, (struct ct_mark){0}, CT_E_USAGE,
                        "there is no export format '%s'; there is c", format);
    if (lanes != 0 && lanes != 1 && lanes != 4 && lanes != 8)
        return ct_error(ctx, (struct ct_mark){0}, CT_E_USAGE,
                        "there are no %ld lanes; there are 1, 4 and 8", lanes);
    return ct_enter(ctx, write_c, &w);
}
