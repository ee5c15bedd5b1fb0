// Names and units of the numbers of exported code. See exported.h.
#include "export/exported.h"

#include <math.h>
#include <string.h>

static struct ct_export_items make_list(struct ct_arena *a, size_t n)
{
    return (struct ct_export_items){CT_NEWN(a, struct ct_export_item, n + 1), n};
}

// Lists all items of a kind; item i has the index first + i.
static struct ct_export_items list_kind(struct ct_exported *w, enum ct_kind kind, size_t first)
{
    const struct ct_system *s = w->sim->system;
    struct ct_export_items list = make_list(w->ctx->model, ct_system_count(s, kind));
    for (size_t i = 0; i < list.n; i++) {
        struct ct_item item;
        ct_item_describe(s, kind, i, &item);
        list.item[i] = (struct ct_export_item){
            .name = item.name, .unit = item.unit, .index = first + i, .value = item.value};
    }
    return list;
}

static void mark_inputs(bool *used, const struct ct_listing *l)
{
    for (size_t v = 0; l && v < l->nvalue; v++)
        if (l->input[v] != CT_VALUE_NONE)
            used[l->input[v]] = true;
}

// Marks the indices of `in` that are used, also through other parameters. An unused parameter
// affects only the start.
static const bool *find_used(struct ct_exported *w)
{
    struct ct_export *x = &w->x;
    struct ct_model *m = &w->sim->system->model;
    bool *used = CT_NEWN(w->ctx->model, bool, x->ninput + 1);
    const struct ct_listing *const all[] = {x->motion, x->constraint, x->output, x->root,
                                            x->memory, x->power,      x->jump,   x->reaction};
    for (size_t i = 0; i < COUNT(all); i++)
        mark_inputs(used, all[i]);
    for (size_t i = m->nparameter; i-- > 0;) {
        const struct ct_parameter *p = &m->parameter[i];
        const size_t n = used[1 + i] ? ct_ex_walk(m->x, &p->definition, 1) : 0;
        for (size_t k = 0; k < n; k++) {
            const struct ct_sym *s = ct_ex_symbol(m->x, (ct_ex){m->x->stack[k]});
            if (s && s->kind == CT_SYM_PARAM)
                used[1 + s->index] = true;
        }
    }
    return used;
}

static struct ct_export_items list_parameters(struct ct_exported *w, enum ct_kind kind)
{
    const struct ct_model *m = &w->sim->system->model;
    const bool *used = find_used(w);
    struct ct_export_items list = list_kind(w, kind, 0);
    for (size_t i = 0; i < list.n; i++) {
        const size_t k = ct_item_parameter(m, kind, i);
        list.item[i].index = 1 + k;
        list.item[i].is_derived = !ct_ex_is_const(m->x, m->parameter[k].definition, NULL);
        list.item[i].is_fixed = kind == CT_PARAMETER
                             && (ct_item_has_decided(w->sim->system->origin, k)
                                 || (!list.item[i].is_derived && !used[1 + k]));
    }
    return list;
}

static void take_values(const struct ct_exported *w, struct ct_export_items *list)
{
    const double *input = ct_run_evaluator(w->sim->run)->input;
    for (size_t i = 0; i < list->n; i++)
        list->item[i].value = input[list->item[i].index];
}

static const char *unit_of_reaction(const char *name)
{
    const char *dot = strrchr(name, '.');
    if (dot && strlen(dot) == 2 && dot > name + 6 && !strncmp(dot - 6, ".force", 6))
        return "N";
    return dot && strncmp(dot, ".effort", 7) == 0 ? NULL : "N*m";
}

void ct_exported_list_items(struct ct_exported *w, const struct ct_result *reaction)
{
    struct ct_export *x = &w->x;
    x->parameters = list_parameters(w, CT_PARAMETER);
    x->inputs = list_parameters(w, CT_INPUT);
    x->coordinates = list_kind(w, CT_COORDINATE, x->at_q);
    x->speeds = list_kind(w, CT_SPEED, x->at_u);
    x->states = list_kind(w, CT_STATE, x->at_u + x->e->nmotion);
    x->outputs = list_kind(w, CT_OUTPUT, 0);
    take_values(w, &x->coordinates);
    take_values(w, &x->speeds);
    take_values(w, &x->states);
    x->reactions = make_list(w->ctx->model, x->reaction->nout);
    for (size_t i = 0; i < x->reactions.n; i++)
        x->reactions.item[i]
            = (struct ct_export_item){.name = reaction[i].name,
                                      .unit = unit_of_reaction(reaction[i].name),
                                      .index = i,
                                      .value = NAN,
                                      .is_open = reaction[i].undetermined};
}
