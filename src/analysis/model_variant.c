// See model_variant.h.
#include "analysis/model_variant.h"

#include <stdlib.h>
#include <string.h>

static const char axes[] = "xyz";

// ---- copies ---------------------------------------------------------------------------------

struct ct_model *ct_variant_create(struct ct_ctx *own, const struct ct_model *m, size_t most)
{
    struct ct_arena *a = own->model;
    struct ct_model *v = CT_NEW(a, struct ct_model);
    *v = *m;
    v->parameter_cap = m->nparameter + most;
    v->parameter = CT_NEWN(a, struct ct_parameter, v->parameter_cap + 1);
    if (m->nparameter)
        memcpy(v->parameter, m->parameter, m->nparameter * sizeof *v->parameter);
    v->joint = CT_NEWN(a, struct ct_instance, m->njoint + 1);
    if (m->njoint)
        memcpy(v->joint, m->joint, m->njoint * sizeof *v->joint);
    v->force = CT_NEWN(a, struct ct_instance, m->nforce + 1);
    if (m->nforce)
        memcpy(v->force, m->force, m->nforce * sizeof *v->force);
    return v;
}

static ct_ex add_parameter(struct ct_ctx *own, struct ct_model *v, const char *name,
                           double value)
{
    struct ct_parameter *p = &v->parameter[v->nparameter];
    *p = (struct ct_parameter){.name = ct_arena_strdup(v->x->arena, name), .value = value};
    p->symbol = ct_ex_sym(v->x, CT_SYM_PARAM, p->name, (uint32_t)v->nparameter);
    p->definition = ct_ex_const(v->x, value);
    v->nparameter++;
    double *all = CT_NEWN(own->model, double, v->x->nsym + 1);
    for (size_t i = 0; i < v->nparameter; i++)
        all[ct_ex_node(v->x, v->parameter[i].symbol)->a] = v->parameter[i].value;
    v->value = all;
    return p->symbol;
}

// A value of an instance for modification. The instance gets its own copy of its values.
static struct ct_value *own_value(struct ct_ctx *own, struct ct_instance *self, const char *key,
                                  size_t room)
{
    int family;
    ct_family_keys(self->cls->family, &family);
    const size_t n = (size_t)family + (size_t)self->cls->nkey;
    const size_t at = (size_t)(ct_instance_value(self, key) - self->value);
    struct ct_value *value = CT_NEWN(own->model, struct ct_value, n);
    memcpy(value, self->value, n * sizeof *value);
    self->value = value;
    struct ct_value *v = &value[at];
    ct_ex *e = CT_NEWN(own->model, ct_ex, room + 1);
    struct ct_mark *mark = CT_NEWN(own->model, struct ct_mark, room + 1);
    bool *hole = CT_NEWN(own->model, bool, room + 1);
    for (size_t i = 0; i < room; i++) {
        const bool is_there = v->given && i < v->n;
        e[i] = is_there ? v->e[i] : CT_EX_ZERO;
        mark[i] = is_there && v->at ? v->at[i] : self->mark;
        hole[i] = !is_there || (v->hole && v->hole[i]);
    }
    v->given = true;
    v->n = room;
    v->e = e;
    v->at = mark;
    v->hole = hole;
    return v;
}

// ---- names ----------------------------------------------------------------------------------

// If the name is "OWNER.PROPERTY" with the given property at `dot`, returns the owner's name;
// else NULL.
static const char *owner_of(struct ct_arena *a, const char *name, const char *property)
{
    const size_t n = strlen(name), k = strlen(property);
    if (n <= k + 1 || strcmp(name + n - k, property) != 0 || name[n - k - 1] != '.')
        return NULL;
    return ct_arena_strndup(a, name, n - k - 1);
}

// For "J.effort" or "J.effort3" returns the joint and sets the index of the effort; -1 for
// other names.
static int find_effort(struct ct_ctx *own, const struct ct_model *m, const char *name,
                       int *place)
{
    char *text = ct_arena_strdup(own->model, name);
    size_t n = strlen(text);
    while (n && text[n - 1] >= '0' && text[n - 1] <= '9')
        n--;
    *place = text[n] ? atoi(text + n) - 1 : 0;
    const bool is_numbered = text[n] != 0;
    text[n] = 0;
    const char *owner = owner_of(own->model, text, "effort");
    const int joint = owner ? ct_model_find_joint(m, owner) : -1;
    if (joint < 0 || !m->joint[joint].cls->motion)
        return -1;
    const int nfree = m->joint[joint].nfree;
    return *place >= 0 && *place < nfree && (is_numbered || nfree == 1) ? joint : -1;
}

// For "F.force.x" or "T.torque.x" returns the load and sets its component; -1 for other names.
static int find_component(struct ct_ctx *own, const struct ct_model *m, const char *name,
                          int *component)
{
    const size_t n = strlen(name);
    const char *axis = n ? strchr(axes, name[n - 1]) : NULL;
    if (!axis || n < 3 || name[n - 2] != '.')
        return -1;
    *component = (int)(axis - axes);
    const char *vector = ct_arena_strndup(own->model, name, n - 2);
    static const enum ct_applied_load loads[] = {CT_APPLIED_FORCE, CT_APPLIED_TORQUE};
    for (size_t i = 0; i < COUNT(loads); i++) {
        const char *owner = owner_of(own->model, vector, ct_applied_load_name(loads[i]));
        const int force = owner ? ct_model_find_force(m, owner) : -1;
        if (force >= 0 && m->force[force].cls->applied == loads[i])
            return force;
    }
    return -1;
}

static bool effort_is_given(const struct ct_instance *joint, int place)
{
    const struct ct_value *v = ct_instance_value(joint, "effort");
    return v->given && (size_t)place < v->n && !(v->hole && v->hole[place]);
}

static bool motion_is_given(const struct ct_instance *joint, int place)
{
    const struct ct_value *v = ct_instance_value(joint, "motion");
    return v->given && (size_t)place < v->n && !(v->hole && v->hole[place]);
}

static const char *effort_name(struct ct_arena *a, const struct ct_instance *joint, int place)
{
    return joint->nfree == 1 ? ct_arena_printf(a, "%s.effort", joint->name)
                             : ct_arena_printf(a, "%s.effort%d", joint->name, place + 1);
}

struct names {
    struct ct_arena *a;
    const char **name;
    size_t n, cap;
};

static void push(struct names *l, const char *name)
{
    CT_PUSH(l->a, l->name, l->n, l->cap, name);
}

// Lists the efforts (all, or those that the model gives) and the components of loads.
static struct names list_inputs(struct ct_arena *a, const struct ct_model *m, bool all)
{
    struct names l = {.a = a};
    for (size_t i = 0; i < m->njoint; i++) {
        const struct ct_instance *joint = &m->joint[i];
        for (int k = 0; joint->cls->motion && k < joint->nfree; k++)
            if (!motion_is_given(joint, k) && (all || effort_is_given(joint, k)))
                push(&l, effort_name(a, joint, k));
    }
    for (size_t i = 0; i < m->nforce; i++) {
        const char *what = ct_applied_load_name(m->force[i].cls->applied);
        for (int k = 0; k < 3 && what; k++)
            push(&l, ct_arena_printf(a, "%s.%s.%c", m->force[i].name, what, axes[k]));
    }
    return l;
}

size_t ct_variant_standard_inputs(struct ct_ctx *own, const struct ct_model *m,
                                  const char ***name)
{
    struct names l = {.a = own->model};
    for (size_t i = 0; i < m->nparameter; i++)
        if (m->parameter[i].is_input && !m->parameter[i].is_played)
            push(&l, m->parameter[i].name);
    if (!l.n)
        l = list_inputs(own->model, m, false);
    *name = l.name;
    return l.n;
}

// ---- inputs ---------------------------------------------------------------------------------

static bool no_input(struct ct_ctx *own, const struct ct_model *m, const char *name)
{
    struct names l = list_inputs(own->model, m, true);
    for (size_t i = 0; i < m->nparameter; i++)
        push(&l, m->parameter[i].name);
    return ct_error(
        own, (struct ct_mark){.file = NULL}, CT_E_INPUT,
        "there is no input '%s': an effort of a joint without a motion "
        "(J.effort), a component of a force or torque (F.force.x), or a parameter%s",
        name, ct_suggest(own->model, name, l.name, l.n));
}

static void add_to(struct ct_ctx *own, struct ct_model *v, struct ct_value *value, int place,
                   const char *name)
{
    const ct_ex p = add_parameter(own, v, name, 0);
    value->e[place] = ct_ex_add(v->x, value->e[place], p);
    value->hole[place] = false;
}

bool ct_variant_input(struct ct_ctx *own, struct ct_model *v, const char *name,
                      size_t *parameter)
{
    int place;
    const int joint = find_effort(own, v, name, &place);
    *parameter = v->nparameter;
    if (joint >= 0 && !motion_is_given(&v->joint[joint], place)) {
        struct ct_instance *self = &v->joint[joint];
        add_to(own, v, own_value(own, self, "effort", (size_t)self->nfree), place, name);
        return true;
    }
    const int force = find_component(own, v, name, &place);
    if (force >= 0) {
        add_to(own, v, own_value(own, &v->force[force], "value", 3), place, name);
        return true;
    }
    for (size_t i = 0; i < v->nparameter; i++)
        if (strcmp(v->parameter[i].name, name) == 0) {
            if (v->parameter[i].is_played)
                return ct_error(
                    own, (struct ct_mark){.file = NULL}, CT_E_INPUT,
                    "a file plays the input '%s', which is a function of time then: take the "
                    "effort or force that it drives, or no file",
                    name);
            *parameter = i;
            return true;
        }
    return no_input(own, v, name);
}

// ---- loads ----------------------------------------------------------------------------------

static void scale(struct ct_model *v, struct ct_value *value, ct_ex factor)
{
    for (size_t i = 0; i < value->n; i++)
        value->e[i] = ct_ex_mul(v->x, factor, value->e[i]);
}

static bool no_load(struct ct_ctx *own, const struct ct_model *m, const char *name)
{
    struct names l = {.a = own->model};
    push(&l, "gravity");
    for (size_t i = 0; i < m->nforce; i++)
        if (m->force[i].cls->applied)
            push(&l, m->force[i].name);
    for (size_t i = 0; i < m->njoint; i++)
        if (m->joint[i].cls->motion && ct_instance_value(&m->joint[i], "effort")->given)
            push(&l, m->joint[i].name);
    return ct_error(own, (struct ct_mark){.file = NULL}, CT_E_LOAD,
                    "there is no load '%s': a force, a torque, a joint with an effort, or "
                    "gravity%s",
                    name, ct_suggest_or_list(own->model, name, l.name, l.n));
}

// A linear beam cannot buckle. Beams whose formulation the program chooses get the one with
// foreshortening.
static void foreshorten(struct ct_ctx *own, struct ct_model *v)
{
    struct ct_body *body = CT_NEWN(own->model, struct ct_body, v->nbody + 1);
    memcpy(body, v->body, v->nbody * sizeof *body);
    for (size_t b = 1; b < v->nbody; b++) {
        if (!body[b].beam || body[b].beam->formulation != CT_BEAM_AUTO)
            continue;
        struct ct_beam *beam = CT_NEW(own->model, struct ct_beam);
        *beam = *body[b].beam;
        beam->formulation = CT_BEAM_FORESHORTENING;
        body[b].beam = beam;
    }
    v->body = body;
}

bool ct_variant_load(struct ct_ctx *own, struct ct_model *v, const char *name,
                     size_t *parameter)
{
    *parameter = v->nparameter;
    const int force = ct_model_find_force(v, name), joint = ct_model_find_joint(v, name);
    foreshorten(own, v);
    if (force >= 0 && v->force[force].cls->applied) {
        const ct_ex factor = add_parameter(own, v, "load factor", 1);
        scale(v, own_value(own, &v->force[force], "value", 3), factor);
        return true;
    }
    if (joint >= 0 && v->joint[joint].cls->motion
        && ct_instance_value(&v->joint[joint], "effort")->given) {
        const ct_ex factor = add_parameter(own, v, "load factor", 1);
        struct ct_instance *self = &v->joint[joint];
        scale(v, own_value(own, self, "effort", (size_t)self->nfree), factor);
        return true;
    }
    if (strcmp(name, "gravity") == 0) {
        const ct_ex factor = add_parameter(own, v, "load factor", 1);
        v->gravity = ct_ex3_scale(v->x, factor, v->gravity);
        return true;
    }
    return no_load(own, v, name);
}
