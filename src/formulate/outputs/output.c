// Columns of results: the outputs of a model and further requested ones.  (format, section 6)
#include "formulate/outputs/output.h"
#include "formulate/outputs/dynamic_signal.h"

#include <string.h>

static bool push_result(struct ct_build *b, const char *name, ct_ex value)
{
    const struct ct_result r
        = {.name = name, .value = value, .undetermined = b->signals.is_open};
    b->signals.is_open = false;
    CT_PUSH(b->arena, b->eqs->result, b->eqs->nresult, b->eqs->result_cap, r);
    return true;
}

static const char *with_component(struct ct_build *b, const char *name, const char *component)
{
    const char *axes = strstr(name, " in ");
    const int n = axes ? (int)(axes - name) : (int)strlen(name);
    return ct_arena_printf(b->arena, "%.*s%s%s", n, name, component, axes ? axes : "");
}

// Columns for "J.q" of a joint with several coordinates: all of them.
static bool numbered_columns(struct ct_build *b, const char *name, struct ct_mark mark,
                             bool *done)
{
    const char *dot = strrchr(name, '.');
    *done = false;
    if (!dot)
        return true;
    const int joint
        = ct_model_find_joint(b->model, ct_arena_strndup(b->arena, name, (size_t)(dot - name)));
    const bool stored = !strcmp(dot, ".q");
    if (joint < 0
        || (!stored && strcmp(dot, ".u") && strcmp(dot, ".a") && strcmp(dot, ".effort")))
        return true;
    const int n = stored ? b->model->joint[joint].ncoord : b->model->joint[joint].nfree;
    if (n < 2)
        return true;
    *done = true;
    for (int i = 1; i <= n; i++) {
        const char *column = ct_arena_printf(b->arena, "%s%d", name, i);
        ct_ex v;
        if (!ct_output_signal(b, column, mark, &v))
            return false;
        push_result(b, column, v);
    }
    return true;
}

static bool signal_columns(struct ct_build *b, const char *name, struct ct_mark mark)
{
    ct_ex v;
    bool done;
    if (!numbered_columns(b, name, mark, &done))
        return false;
    if (done)
        return true;
    const char *const *component = ct_signal_components(b, name);
    if (!component)
        return ct_output_signal(b, name, mark, &v) && push_result(b, name, v);
    for (; *component; component++) {
        const char *column = with_component(b, name, *component);
        if (!ct_output_signal(b, column, mark, &v))
            return false;
        push_result(b, column, v);
    }
    return true;
}

// Columns of an output with a user-defined name: a scalar gets that name, a vector that name with
// components.
static void named_columns(struct ct_build *b, const struct ct_output *o)
{
    const size_t first = b->eqs->nresult;
    const char *signal = ct_ex_symbol(b->x, o->value)->name;
    if (signal_columns(b, signal, o->mark) && strcmp(o->name, signal)
        && b->eqs->nresult == first + 1)
        b->eqs->result[first].name = o->name;
}

// Checks that the columns from `first` on, those of output i, do not exist already: "a.position"
// contains "a.position.x".
static void new_names(struct ct_build *b, struct ct_names *names, size_t first, size_t i)
{
    const struct ct_output *output = b->model->output;
    for (size_t k = first; k < b->eqs->nresult; k++) {
        const char *column = b->eqs->result[k].name;
        const int known = ct_names_get(names, column);
        if (known >= 0) {
            ct_error(b->ctx, output[i].mark, CT_E_NAME_TWICE, "the output '%s' is there twice",
                     column);
            ct_note(b->ctx, output[known].mark, "the first one is here");
            return;
        }
        ct_names_put(b->arena, names, column, (int)i);
    }
}

bool ct_outputs_derive(struct ct_build *b)
{
    const size_t before = b->ctx->nerror;
    struct ct_names names = {0};
    b->signals.in_outputs = true;
    for (size_t i = 0; i < b->model->noutput; i++) {
        const struct ct_output *o = &b->model->output[i];
        const size_t first = b->eqs->nresult;
        if (o->is_signal)
            named_columns(b, o);
        else
            push_result(b, o->name, ct_output_value(b, o->value));
        new_names(b, &names, first, i);
    }
    b->signals.in_outputs = false;
    return b->ctx->nerror == before;
}

// Adds the columns of a signal, unless its first column exists.
static bool new_columns(struct ct_build *b, const char *name, struct ct_mark mark)
{
    const size_t first = b->eqs->nresult;
    if (!signal_columns(b, name, mark))
        return false;
    size_t kept = first; // drop columns that the model already has
    for (size_t i = first; i < b->eqs->nresult; i++) {
        bool is_new = true;
        for (size_t k = 0; k < first && is_new; k++)
            is_new = strcmp(b->eqs->result[k].name, b->eqs->result[i].name) != 0;
        if (is_new)
            b->eqs->result[kept++] = b->eqs->result[i];
    }
    b->eqs->nresult = kept;
    return true;
}

static bool coordinate_columns(struct ct_build *b, const struct ct_instance *joint)
{
    static const char *const properties[] = {"q", "u", "a"};
    bool ok = true;
    for (size_t i = 0; i < COUNT(properties) && joint->cls->motion && joint->nfree; i++)
        ok &= new_columns(b, ct_arena_printf(b->arena, "%s.%s", joint->name, properties[i]),
                          joint->mark);
    return ok;
}

static bool effort_columns(struct ct_build *b, size_t j)
{
    const struct ct_instance *joint = &b->model->joint[j];
    const int edge = b->topology->edge_of_joint[j];
    bool ok = true;
    for (int k = 0; edge >= 0 && joint->cls->motion && k < joint->nfree; k++)
        if (b->kinematics->coordinate[b->topology->edge[edge].first_coordinate + k].is_driven) {
            const char *number
                = joint->nfree == 1 ? "" : ct_arena_printf(b->arena, "%d", k + 1);
            ok &= new_columns(b, ct_arena_printf(b->arena, "%s.effort%s", joint->name, number),
                              joint->mark);
        }
    return ok;
}

static bool reaction_columns(struct ct_build *b, size_t j)
{
    const struct ct_instance *joint = &b->model->joint[j];
    const int edge = b->topology->edge_of_joint[j];
    if (edge < 0) // a gear: its effort on its first joint
        return new_columns(b, ct_arena_printf(b->arena, "%s.effort", joint->name), joint->mark);
    return new_columns(b, ct_arena_printf(b->arena, "%s.force", joint->name), joint->mark)
        && (!b->topology->edge[edge].has_rotation
            || new_columns(b, ct_arena_printf(b->arena, "%s.torque", joint->name),
                           joint->mark));
}

bool ct_outputs_add(struct ct_build *b, enum ct_more_outputs more)
{
    const size_t n = b->model->njoint;
    bool ok = true;
    b->eqs->more = more;
    b->signals.in_outputs = true;
    for (size_t j = 0; j < n && more == CT_MORE_COORDINATES && b->model->noutput == 0; j++)
        ok &= coordinate_columns(b, &b->model->joint[j]);
    for (size_t i = 0;
         i < b->model->nstate && more == CT_MORE_COORDINATES && b->model->noutput == 0; i++)
        ok &= new_columns(b, b->model->state[i].name, b->model->state[i].mark);
    for (size_t j = 0; j < n && more == CT_MORE_EFFORTS; j++)
        ok &= effort_columns(b, j);
    for (size_t j = 0; j < n && more == CT_MORE_EFFORTS; j++)
        ok &= reaction_columns(b, j);
    b->signals.in_outputs = false;
    return ok;
}

bool ct_outputs_list_reactions(struct ct_build *b, struct ct_result **list, size_t *n)
{
    struct ct_equations *e = b->eqs;
    struct ct_result *const before = e->result;
    const size_t nbefore = e->nresult, cap = e->result_cap;
    bool ok = true;
    e->result = NULL;
    e->nresult = e->result_cap = 0;
    b->signals.in_outputs = true;
    for (size_t j = 0; j < b->model->njoint; j++)
        ok &= reaction_columns(b, j);
    b->signals.in_outputs = false;
    *list = e->result;
    *n = e->nresult;
    e->result = before;
    e->nresult = nbefore;
    e->result_cap = cap;
    return ok;
}
