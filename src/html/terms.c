// See terms.h.
#include "html/terms.h"

#include "solve/run/run_internal.h"

#include <string.h>

// Limit: a fifth of a megabyte of the page, at some three bytes for each number.
enum { MOST_NUMBERS = 60000, LEAST_ROWS = 21 };

static void list_expressions(struct ct_terms_recording *t, struct ct_arena *a,
                             const struct ct_equations *e)
{
    const struct ct_provenance *p = &t->provenance;
    size_t cap = 0;
    t->column = CT_NEWN(a, size_t, p->nterm + 1);
    for (size_t i = 0; i < p->nterm; i++) {
        const struct ct_equation_term *term = &p->term[i];
        if (term->kind == CT_EQUATION_OUTPUT
            && (i == 0 || term[-1].kind != term->kind || term[-1].equation != term->equation))
            CT_PUSH(a, t->expression, t->nexpression, cap, e->result[term->equation].value);
        t->column[i] = t->nexpression;
        CT_PUSH(a, t->expression, t->nexpression, cap, term->full);
    }
}

void ct_terms_create(struct ct_terms_recording *t, struct ct_arena *a, struct ct_system *sys)
{
    struct ct_equations *e = &sys->equations;
    *t = (struct ct_terms_recording){.stride = 1};
    ct_derivation_init(&t->derivation, a, e, &sys->model, CT_LOOK_HTML);
    t->derivation.is_recursive = false; // the page shows terms of M u' = Q + J' lambda
    ct_derivation_reduce(&t->derivation, &t->reduced);
    ct_provenance_derive(&t->derivation, &t->reduced, &t->provenance);
    list_expressions(t, a, e);
    if (t->nexpression * LEAST_ROWS <= MOST_NUMBERS)
        t->nvalue = t->nexpression;
    for (size_t i = 0; i < t->nvalue; i++)
        t->uses_multipliers |= (ct_ex_kinds(e->x, t->expression[i]) & 1u << CT_SYM_LAM) != 0;
}

void ct_terms_compile(struct ct_arena *a, struct ct_terms_recording *t, struct ct_run *run,
                      size_t nrow)
{
    if (!t->nvalue)
        return;
    const size_t most = MOST_NUMBERS / t->nvalue;
    if (nrow > most)
        t->stride = (nrow + most - 3) / (most - 1);
    ct_evaluator_add_program(a, ct_run_evaluator(run), t->derivation.e->x, t->expression,
                             t->nvalue, &t->program);
}

void ct_terms_keep(struct ct_arena *a, struct ct_terms_recording *t, struct ct_run *run,
                   size_t i, bool is_last)
{
    if (!t->nvalue || (i % t->stride && !is_last))
        return;
    if (t->uses_multipliers)
        ct_run_find_multipliers(run);
    ct_program_run(&t->program, ct_run_evaluator(run)->input);
    size_t n = t->nrow++ * t->nvalue;
    for (size_t k = 0; k < t->nvalue; k++)
        CT_PUSH(a, t->value, n, t->cap, t->program.out[k]);
}
