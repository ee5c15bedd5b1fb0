// Names and units of the numbers of exported code. See exported.h.
#include "export/exported.h"

#include <math.h>
#include <string.h>

static struct ct_export_items make_list(struct ct_arena *a, size_t n)
{
    return (struct ct_export_items){CT_NEWN(a, struct ct_export_item, n + 1), n};
}

// All of a kind; number i of it is at first + i.
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

static struct ct_export_items list_parameters(struct ct_exported *w, enum ct_kind kind)
{
    const struct ct_model *m = &w->sim->system->model;
    struct ct_export_items list = list_kind(w, kind, 0);
    for (size_t i = 0; i < list.n; i++) {
        const size_t k = ct_item_parameter(m, kind, i);
        list.item[i].index = 1 + k;
        list.item[i].is_derived = !ct_ex_is_const(m->x, m->parameter[k].definition, NULL);
        list.item[i].is_fixed = ct_item_has_decided(w->sim->system->origin, k);
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
    x->states = list_kind(w, CT_STATE, x->at_u + x->speeds.n); // behind the speeds
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
