// Runtime functions of exported C; see export.h.
//
//     accelerations   [M -J'; J 0] [u'; lam] = [Q; -gam], by the pivots of the start or by
//                     elimination with complete pivoting
//     multipliers     least norm of J' lam = M u' - Q, by QR with column pivoting
//     projection      Newton's method with corrections of least norm, J d = -phi, then J du = -v
//     step            classical Runge-Kutta, then projection; a step in which a switch changes
//                     ends just after the change, and another step follows
#include "codegen/export.h"
#include "codegen/export_text.h"
#include "codegen/export_runtime_text.h"

#include "expr/print.h"

static void put(struct ct_export_text *t, const char *const *line)
{
    ct_export_put_lines(t, line);
}

static void put_numbers(struct ct_export_text *t, const char *declaration, const double *v,
                        size_t n)
{
    ct_export_putf(t, "static const double %s[] = ", declaration);
    ct_export_put_numbers(t, v, n);
    ct_export_put(t, ";\n");
}

static void put_integers(struct ct_export_text *t, const char *declaration, const int *v,
                         size_t n)
{
    ct_export_putf(t, "static const int %s[] = ", declaration);
    ct_export_put_integers(t, v, n);
    ct_export_put(t, ";\n");
}

bool ct_export_has_events(const struct ct_export *x)
{
    return x->e->nswitch || x->nknot;
}

static void put_fixed(struct ct_export_text *t, const struct ct_export *x)
{
    if (!x->solved || !x->e->nu) {
        put(t, text_no_fixed_pivots);
        return;
    }
    ct_export_putf(t, "enum { n_free = %zu, n_pivot = %zu, rank_fixed = %zu };\n", x->nfree,
                   x->npivot, x->e->nu + x->rank);
    put_numbers(t, "scale", x->scale, x->npivot);
    ct_export_putf(t, "static const double weakest = %s;\n\n",
                   ct_number_c(t->arena, x->weakest));
    put(t, text_fixed_pivots);
}

static void put_data(struct ct_export_text *t, const struct ct_export *x)
{
    const size_t n = x->e->nrow;
    int *out = CT_NEWN(t->arena, int, n + 1);
    for (size_t i = 0; i < n && x->left_out; i++)
        out[i] = x->left_out[i];
    if (x->left_out) {
        put_integers(t, "left_out", out, n);
        put_numbers(t, "open", x->open, n);
    }
    put(t, x->left_out ? text_inexact_data : text_exact_data);
    int *kept = CT_NEWN(t->arena, int, n + 1);
    for (size_t i = 0; i < x->rank; i++)
        kept[x->row[i]] = 1;
    put_integers(t, "is_kept", kept, n);
    ct_export_putf(t, "enum { n_kept = %zu };\n\n", x->rank);
}

// Print for each speed its coordinate; for one of the three speeds of a quaternion, -1 minus the
// index of its first number.
static void put_places(struct ct_export_text *t, const struct ct_equations *e)
{
    int *place = CT_NEWN(t->arena, int, e->nu + 1), next = 0;
    bool has_quaternions = false;
    for (size_t k = 0; k < e->nmotion; k++) {
        place[k] = e->u[k].q;
        if (e->u[k].q >= 0)
            continue;
        while (e->q[next].quaternion != 0)
            next++;
        place[k] = place[k + 1] = place[k + 2] = -1 - next++;
        has_quaternions = true;
        k += 2;
    }
    put_integers(t, "place", place, e->nmotion);
    ct_export_putf(t, "enum { n_motion = %zu }; /* speeds; states have no coordinate */\n\n",
                   e->nmotion);
    put(t, has_quaternions ? text_quaternions : text_no_quaternions);
}

static void put_switches(struct ct_export_text *t, const struct ct_equations *e,
                         bool has_events)
{
    int *sense = CT_NEWN(t->arena, int, e->nswitch + 1),
        *at_zero = CT_NEWN(t->arena, int, e->nswitch + 1);
    for (size_t i = 0; i < e->nswitch; i++) {
        const enum ct_op op = e->switches[i].op;
        sense[i] = op == CT_OP_GT || op == CT_OP_GE ? 1 : -1;
        at_zero[i] = op == CT_OP_LE || op == CT_OP_GE;
    }
    if (!has_events) {
        put(t, text_no_switch);
        return;
    }
    put_integers(t, "sense", sense, e->nswitch);
    put_integers(t, "at_zero", at_zero, e->nswitch);
    put(t, text_switch);
}

static void put_memory(struct ct_export_text *t, const struct ct_equations *e)
{
    int *is_updated = CT_NEWN(t->arena, int, e->nmemory + 1);
    for (size_t i = 0; i < e->nmemory; i++) {
        const struct ct_memory *m = &e->memory[i];
        is_updated[i] = m->kind == CT_MEMORY_TURNS                       ? 3
                      : !ct_memory_is_updated(m)                         ? 0
                      : m->kind == CT_MEMORY_QUATERNION && m->index == 0 ? 2
                                                                         : 1;
    }
    if (e->nmemory)
        put_integers(t, "is_updated", is_updated, e->nmemory);
    put(t, e->nmemory ? text_memory : text_no_memory);
}

void ct_export_put_next_stop(struct ct_export_text *t, size_t nknot)
{
    put(t, nknot ? text_knots : text_no_knots);
}

static void put_changes(struct ct_export_text *t, const struct ct_export *x)
{
    put(t, x->nknot ? text_before_knot : text_no_knot_before);
    if (!ct_export_has_events(x))
        return;
    if (x->nknot) {
        ct_export_putf(t, "enum { n_knot = %zu };\n", x->nknot);
        put_numbers(t, "knot", x->knot, x->nknot);
    }
    ct_export_put_next_stop(t, x->nknot);
    put(t, x->jump ? text_impulse : text_no_impulse);
}

static void put_step(struct ct_export_text *t, const struct ct_export *x)
{
    put(t, !x->power            ? text_no_power
           : x->power_needs_lam ? text_power_of_multipliers
                                : text_power);
    put(t, text_step);
    if (ct_export_has_events(x))
        put(t, text_locate);
    put(t, ct_export_has_events(x) ? text_step_with_events : text_step_without_events);
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

// Doubles of workspace for accelerations, without the rates after them.
static size_t work_of_accelerate(const struct ct_export *x)
{
    const size_t n = x->e->nu + x->e->nrow;
    return larger(x->motion->nout + n * (n + 2), x->solved ? x->solved->nout : 0);
}

size_t ct_export_work(const struct ct_export *x)
{
    const struct ct_equations *e = x->e;
    const size_t nu = e->nu, nrow = e->nrow, n = nu + nrow, nstate = e->nq + nu + 1,
                 njump = x->jump ? x->jump->nout : 0,
                 accelerate = work_of_accelerate(x) + e->nq,
                 multipliers = x->motion->nout + nu + nrow * nu + 2 * nu,
                 project = e->nq + nu + x->constraint->nout + nu + nu * nrow + 3 * nrow,
                 strike = 2 * njump + x->constraint->nout + x->motion->nout + n * (n + 2),
                 advance = 3 * nstate + larger(accelerate, multipliers),
                 try_step = larger(advance, project);
    const size_t step = 2 * x->ninput + e->nswitch + larger(try_step, x->jump ? strike : 0);
    return larger(step, x->ninput + larger(accelerate, multipliers));
}

bool ct_export_has_derived(const struct ct_export *x)
{
    for (size_t i = 0; i < x->parameters.n; i++)
        if (x->parameters.item[i].is_derived)
            return true;
    return false;
}

void ct_export_runtime(struct ct_export_text *t, const struct ct_export *x)
{
    put(t, text_helpers);
    put_data(t, x);
    ct_export_putf(t, "enum { n_accelerate = %zu };\n\n", work_of_accelerate(x));
    put_fixed(t, x);
    put(t, text_solver);
    put(t, text_least_norm);
    put(t, text_multipliers);
    put_places(t, x->e);
    put(t, text_project);
    put_switches(t, x->e, ct_export_has_events(x));
    put_memory(t, x->e);
    put_changes(t, x);
    put_step(t, x);
    put(t, ct_export_has_derived(x) ? text_parameters : text_no_parameters);
    put(t, x->needs_lam ? text_outputs_of_multipliers
           : x->needs_a ? text_outputs_of_accelerations
                        : text_outputs_of_state);
    put(t, text_multipliers_of_loops);
    put(t, text_reactions);
}
