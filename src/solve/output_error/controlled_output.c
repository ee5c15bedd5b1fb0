// See controlled_output.h.
#include "solve/output_error/controlled_output.h"

#include <math.h>

bool ct_controlled_outputs_is_check(const struct ct_equations *e, ct_ex v)
{
    return v.id == e->total.id || v.id == e->closure_error[0].id
        || v.id == e->closure_error[1].id;
}

enum ct_output_kind ct_controlled_outputs_kind(const struct ct_equations *e, ct_ex v)
{
    const unsigned kinds = ct_ex_kinds(e->x, v), states = 1u << CT_SYM_Q | 1u << CT_SYM_U;
    const unsigned solved = 1u << CT_SYM_A | 1u << CT_SYM_LAM;
    const unsigned others
        = 1u << CT_SYM_TIME | 1u << CT_SYM_PARAM | 1u << CT_SYM_SWITCH | 1u << CT_SYM_MEMORY;
    const bool is_state = kinds & states && e->x->node[v.id].op == CT_OP_SYM;
    if (!(kinds & (states | solved)) || kinds & ~(states | solved | others) || is_state
        || ct_controlled_outputs_is_check(e, v))
        return CT_OUTPUT_KINDS;
    return kinds & solved ? CT_OUTPUTS_OF_SOLUTIONS : CT_OUTPUTS_OF_STATES;
}

void ct_controlled_outputs_create(struct ct_arena *a, struct ct_partition *s,
                                  enum ct_output_kind kind, const ct_ex *g, size_t n,
                                  long *evaluations, struct ct_controlled_outputs *o)
{
    struct ct_evaluator *m = s->m;
    *o = (struct ct_controlled_outputs){
        .s = s, .n = n, .kind = kind, .evaluations = evaluations};
    for (size_t i = 0; i < n; i++)
        o->needs_lam |= ct_ex_kinds(m->e->x, g[i]) & 1u << CT_SYM_LAM;
    ct_evaluator_add_program(a, m, m->e->x, g, n, &o->program);
}

// u' and lam into the evaluator's input; NaN if the equations cannot be solved.
static void solve(struct ct_controlled_outputs *o)
{
    struct ct_evaluator *m = o->s->m;
    double *a = m->input + m->at_a, *lam = m->input + m->at_lam;
    ++*o->evaluations;
    const bool is_found = ct_partition_solve(o->s) == CT_EVAL_OK;
    for (size_t k = 0; k < m->nu; k++)
        a[k] = is_found ? o->s->a[k] : NAN;
    if (is_found && o->needs_lam)
        ct_partition_multipliers(o->s);
    for (size_t i = 0; i < m->nrow && o->needs_lam; i++)
        lam[i] = is_found ? o->s->lam[i] : NAN;
}

const double *ct_controlled_outputs_at(struct ct_controlled_outputs *o, double t,
                                       const double *y)
{
    ct_evaluator_set(o->s->m, t, y);
    if (o->kind == CT_OUTPUTS_OF_SOLUTIONS)
        solve(o);
    ct_program_run(&o->program, o->s->m->input);
    return o->program.out;
}

struct ct_tolerance ct_controlled_outputs_tolerance(enum ct_output_kind kind,
                                                    const struct ct_tolerance *states)
{
    const double part = kind == CT_OUTPUTS_OF_SOLUTIONS ? CT_PROMISED_ERROR : 1;
    return (struct ct_tolerance){part * states->rtol, part * states->atol};
}
