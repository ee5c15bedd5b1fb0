// What is said of runs that end before their time: which constraints, and where.
#include "solve/run.h"

#include <string.h>

// Of the first row that is marked.
static struct ct_mark mark_of_row(const struct ct_run *r, size_t row)
{
    const int joint = r->e->row[row].joint;
    if (joint < 0)
        return (struct ct_mark){.file = r->model->file};
    return r->model->joint[joint].mark;
}

// Where steps ended as they became too short: beside a singular position?
static void name_singular(struct ct_run *r, const char *advice)
{
    enum { MOST_NAMES = 5 };
    bool *row = CT_NEWN(r->arena, bool, r->m->nrow + 1);
    const double t = r->stats.last_time;
    if (!ct_singular_is_beside(r->singular, ct_run_before(r, t), r->y, row))
        return;
    const char *names = "";
    int first = -1, n = 0;
    for (size_t i = 0; i < r->m->nrow; i++) {
        if (!row[i] || n++ >= MOST_NAMES)
            continue;
        first = first < 0 ? (int)i : first;
        names
            = ct_arena_printf(r->arena, "%s%s%s", names, *names ? ", " : "", r->e->row[i].name);
    }
    ct_note(
        r->ctx, mark_of_row(r, first < 0 ? 0 : (size_t)first),
        "the constraints come to depend on each other there (%s%s): the mechanism is at the "
        "end of its reach or in a singular position%s",
        names, n > MOST_NAMES ? ", ..." : "", advice);
}

// Where steps ended as the constraints could not be met: the row that stays open farthest a little later.
static void name_open_row(struct ct_run *r)
{
    const double later
        = 1e-3; // of the run: far enough for a contradiction to be more than rounding
    if (ct_run_rhs(r, r->stats.last_time, r->y, r->dy))
        return;
    const double dt = later * r->o->duration, t = r->stats.last_time + dt;
    for (size_t i = 0; i < r->m->nu; i++)
        r->scratch[i] = dt * r->y[r->m->nq + i];
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    ct_machine_retract(r->m, r->stage, r->scratch);
    if (ct_embed_project(r->s, t, r->stage) == CT_EVAL_OK)
        return;
    ct_machine_constraint(r->m);
    size_t worst = 0;
    for (size_t i = 1; i < r->m->nrow; i++)
        if (fabs(r->m->phi[i]) > fabs(r->m->phi[worst]))
            worst = i;
    ct_note(r->ctx, mark_of_row(r, worst), "'%s' stays open by %.3g at t = %.9g",
            r->e->row[worst].name, fabs(r->m->phi[worst]), t);
}

void ct_run_explain_end(struct ct_run *r)
{
    const size_t n = r->ctx->ndiagnostic;
    const enum ct_code code = n ? r->ctx->diagnostic[n - 1].code : 0;
    const bool is_stuck
        = code == CT_E_STEP_COUNT || code == CT_E_STEP_SMALL || code == CT_E_STEP_SINGULAR;
    if (is_stuck && r->e->is_truncated)
        ct_note(
            r->ctx, (struct ct_mark){0},
            "the equations are cut to first order, by 'stretch-linear' or 'small'; where what "
            "carries the small coordinates, or is hinged to them, is free to move, masses can "
            "vanish as these grow: 'foreshortening' has all terms");
    else if (code == CT_E_STEP_COUNT)
        ct_run_explain_count(r);
    if (!r->m->nrow)
        return;
    if (code == CT_E_STEP_OPEN)
        name_open_row(r);
    else if (code == CT_E_STEP_SMALL || code == CT_E_STEP_SINGULAR)
        name_singular(r, "");
    else if (code == CT_E_STEP_REFUSED)
        name_singular(r, ", which steps are not fitted to: leave out 'step'");
}
