// NAME.json: the layout of the arrays of exported code. See exported.h.
#include "export/exported.h"

#include "report/json.h"

static void put_item(struct ct_json *j, const struct ct_export_item *item, bool has_value)
{
    ct_json_object(j, NULL);
    ct_json_text(j, "name", item->name);
    ct_json_text(j, "unit", item->unit);
    if (has_value) {
        ct_json_number(j, "value", item->value);
        ct_json_integer(j, "index", (long long)item->index);
    }
}

static void put_list(struct ct_json *j, const char *key, const struct ct_export_items *list,
                     bool has_value)
{
    ct_json_array(j, key);
    for (size_t i = 0; i < list->n; i++) {
        put_item(j, &list->item[i], has_value);
        ct_json_end(j);
    }
    ct_json_end(j);
}

static void put_parameters(struct ct_json *j, const struct ct_export_items *list)
{
    ct_json_array(j, "parameters");
    for (size_t i = 0; i < list->n; i++) {
        put_item(j, &list->item[i], true);
        ct_json_bool(j, "derived", list->item[i].is_derived);
        ct_json_bool(j, "fixed", list->item[i].is_fixed);
        ct_json_end(j);
    }
    ct_json_end(j);
}

static void put_reactions(struct ct_json *j, const struct ct_export_items *list)
{
    ct_json_array(j, "reactions");
    for (size_t i = 0; i < list->n; i++) {
        put_item(j, &list->item[i], false);
        ct_json_bool(j, "determined", !list->item[i].is_open);
        ct_json_end(j);
    }
    ct_json_end(j);
}

static void put_sizes(struct ct_json *j, const struct ct_export *x)
{
    const struct ct_equations *e = x->e;
    const struct {
        const char *name;
        size_t n;
    } sizes[] = {{"NQ", e->nq},
                 {"NU", e->nu},
                 {"NSTATE", e->nstate},
                 {"NROW", e->nrow},
                 {"NM", e->nM},
                 {"NJ", e->nJ},
                 {"NPARAMETER", x->at_q - 1},
                 {"NOUTPUT", x->output->nout},
                 {"NROOT", e->nswitch},
                 {"NREACTION", x->reaction->nout},
                 {"NMEMORY", e->nmemory},
                 {"NINPUT", x->ninput},
                 {"NMOTION", x->motion->nout},
                 {"NCONSTRAINT", x->constraint->nout},
                 {"NWORK", ct_export_work(x)}};
    ct_json_object(j, "sizes");
    for (size_t i = 0; i < COUNT(sizes); i++)
        ct_json_integer(j, sizes[i].name, (long long)sizes[i].n);
    ct_json_end(j);
}

static void put_operations(struct ct_json *j, const char *key, const struct ct_listing *l)
{
    if (!l)
        return;
    ct_json_object(j, key);
    ct_json_integer(j, "multiplications", l->counts.multiplications);
    ct_json_integer(j, "additions", l->counts.additions);
    ct_json_integer(j, "divisions", l->counts.divisions);
    ct_json_integer(j, "functions", l->counts.functions);
    ct_json_end(j);
}

void ct_exported_write_json(struct ct_exported *w, FILE *out)
{
    const struct ct_export *x = &w->x;
    struct ct_json j;
    ct_json_init(&j, out);
    ct_json_object(&j, NULL);
    ct_json_text(&j, "name", x->name);
    ct_json_text(&j, "model", x->title);
    put_sizes(&j, x);
    put_parameters(&j, &x->parameters);
    put_list(&j, "inputs", &x->inputs, true);
    put_list(&j, "coordinates", &x->coordinates, true);
    put_list(&j, "speeds", &x->speeds, true);
    put_list(&j, "states", &x->states, true);
    put_list(&j, "outputs", &x->outputs, false);
    put_reactions(&j, &x->reactions);
    ct_json_object(&j, "operations");
    put_operations(&j, "motion", x->motion);
    put_operations(&j, "constraint", x->constraint);
    put_operations(&j, "accelerations", x->solved);
    put_operations(&j, "outputs", x->output);
    ct_json_end(&j);
    ct_json_end(&j);
}
