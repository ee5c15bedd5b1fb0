// Variables of an FMU. See fmu.h.
#include "export/fmu.h"

#include <math.h>
#include <string.h>

static void add(struct ct_fmu *f, struct ct_fmu_variable v)
{
    CT_PUSH(f->w->ctx->model, f->variable, f->nvariable, f->cap, v);
}

static void add_parameters(struct ct_fmu *f)
{
    const struct ct_export *x = &f->w->x;
    for (size_t i = 0; i < x->parameters.n; i++) {
        const struct ct_export_item *p = &x->parameters.item[i];
        add(f, (struct ct_fmu_variable){.name = p->name,
                                        .unit = p->unit,
                                        .role = p->is_derived ? CT_FMU_DERIVED
                                              : p->is_fixed   ? CT_FMU_CONSTANT
                                                              : CT_FMU_PARAMETER,
                                        .reference = p->index,
                                        .start = p->value});
    }
    for (size_t i = 0; i < x->inputs.n; i++) {
        const struct ct_export_item *p = &x->inputs.item[i];
        add(f, (struct ct_fmu_variable){.name = p->name,
                                        .unit = p->unit,
                                        .role = CT_FMU_INPUT,
                                        .reference = p->index,
                                        .start = p->value});
    }
}

static void add_states(struct ct_fmu *f, const struct ct_export_items *list)
{
    for (size_t i = 0; i < list->n; i++)
        add(f, (struct ct_fmu_variable){.name = list->item[i].name,
                                        .unit = list->item[i].unit,
                                        .role = CT_FMU_STATE,
                                        .reference = list->item[i].index,
                                        .start = list->item[i].value});
}

static const char *unit_of_rate(struct ct_arena *a, const char *unit)
{
    const size_t n = unit ? strlen(unit) : 0;
    if (!unit)
        return NULL;
    if (n == 0)
        return "1/s";
    if (n > 2 && !strcmp(unit + n - 2, "/s"))
        return ct_arena_printf(a, "%s^2", unit);
    return !strcmp(unit, "J") ? "W" : ct_arena_printf(a, "%s/s", unit);
}

static void add_derivatives(struct ct_fmu *f, size_t first_state)
{
    struct ct_arena *a = f->w->ctx->model;
    for (size_t k = 0; k < f->nstate; k++) {
        const struct ct_fmu_variable state = f->variable[first_state + k];
        add(f, (struct ct_fmu_variable){.name = ct_arena_printf(a, "der(%s)", state.name),
                                        .unit = unit_of_rate(a, state.unit),
                                        .role = CT_FMU_DERIVATIVE,
                                        .reference = f->first_derivative + k,
                                        .state = first_state + k});
    }
}

// Is this output, which has a state's name, that state? Then both are one variable.
static bool is_state(struct ct_fmu *f, const struct ct_result *r, size_t first_state)
{
    const struct ct_equations *e = f->w->x.e;
    for (size_t k = 0; k < f->nstate; k++) {
        const ct_ex symbol = k < e->nq         ? e->q[k].symbol
                           : k < e->nq + e->nu ? e->u[k - e->nq].symbol
                                               : e->work_symbol;
        struct ct_fmu_variable *v = &f->variable[first_state + k];
        if (ct_ex_same(symbol, r->value) && !v->is_output && !strcmp(v->name, r->name))
            return v->is_output = true;
    }
    return false;
}

static void add_outputs(struct ct_fmu *f, size_t first_state)
{
    const struct ct_export *x = &f->w->x;
    for (size_t i = 0; i < x->outputs.n; i++)
        if (!is_state(f, &x->e->result[i], first_state))
            add(f, (struct ct_fmu_variable){.name = x->outputs.item[i].name,
                                            .unit = x->outputs.item[i].unit,
                                            .role = CT_FMU_OUTPUT,
                                            .reference = f->first_output + i});
    for (size_t i = 0; i < x->e->nswitch; i++)
        add(f, (struct ct_fmu_variable){
                   .name = ct_arena_printf(f->w->ctx->model, "switch %zu", i + 1),
                   .role = CT_FMU_ROOT,
                   .reference = f->first_root + i});
}

// Makes names unique. Outputs keep theirs; other variables of the same name get a suffix that
// tells their kind.
static void separate_names(struct ct_fmu *f)
{
    struct ct_arena *a = f->w->ctx->model;
    static const char *const kind[]
        = {"time", "parameter", "parameter", "parameter", "input", "state", "rate", "", "root"};
    struct ct_names taken = {0};
    for (int outputs = 1; outputs >= 0; outputs--)
        for (size_t i = 0; i < f->nvariable; i++) {
            struct ct_fmu_variable *v = &f->variable[i];
            if ((v->role == CT_FMU_OUTPUT || v->is_output) != outputs)
                continue;
            while (ct_names_get(&taken, v->name) >= 0)
                v->name = ct_arena_printf(a, "%s.%s", kind[v->role], v->name);
            ct_names_put(a, &taken, v->name, (int)i);
        }
}

void ct_fmu_list_variables(struct ct_fmu *f)
{
    const struct ct_export *x = &f->w->x;
    f->nstate = x->e->nq + x->e->nu + (x->power != NULL);
    f->first_derivative = x->ninput;
    f->first_output = f->first_derivative + f->nstate;
    f->first_root = f->first_output + x->outputs.n;
    add(f, (struct ct_fmu_variable){.name = "time", .unit = "s", .role = CT_FMU_TIME});
    add_parameters(f);
    const size_t first_state = f->nvariable;
    add_states(f, &x->coordinates);
    add_states(f, &x->speeds);
    add_states(f, &x->states);
    if (x->power)
        add(f, (struct ct_fmu_variable){.name = "energy.work",
                                        .unit = "J",
                                        .role = CT_FMU_STATE,
                                        .reference = x->at_work,
                                        .start = x->state[0].input[x->at_work]});
    add_outputs(f, first_state);
    separate_names(f);
    add_derivatives(f, first_state);
}
