// See marked_model.h. Marked are masses, inertias, positions of points, section and material of
// beams, expressions of joints and forces, and gravity. Not marked are directions, whose effect
// shows in the coordinates along or about them, and initial values, which are in no equation.
#include "report/marked_model.h"

#include "base/sort.h"

#include <string.h>

struct marker {
    struct ct_arena *a;
    struct ct_exs *x;
    struct ct_marked_model *out;
    struct ct_model *m;
};

static void *copy(struct ct_arena *a, const void *from, size_t n, size_t size)
{
    void *to = ct_arena_calloc(a, n + 1, size);
    if (n)
        memcpy(to, from, n * size);
    return to;
}

#define COPY(a, p, n) ((p) = copy((a), (p), (n), sizeof *(p)))

// ---- origins -------------------------------------------------------------------------------

// An origin while the list is sorted. at: destination of its number.
struct entry {
    struct ct_origin origin;
    size_t order;
    uint32_t *at;
    bool is_marked;
};

struct entries {
    struct entry *at;
    size_t n, cap;
};

static void add(struct ct_arena *a, struct entries *list, const char *name, struct ct_mark mark,
                uint32_t *at, bool is_marked)
{
    const struct entry e
        = {{name, mark.file && !mark.is_table ? mark.line + 1 : 0}, list->n, at, is_marked};
    CT_PUSH(a, list->at, list->n, list->cap, e);
}

static int by_line(const void *unused, const void *va, const void *vb)
{
    const struct entry *a = va, *b = vb;
    (void)unused;
    if (a->origin.line != b->origin.line)
        return a->origin.line < b->origin.line ? -1 : 1;
    return (a->order > b->order) - (a->order < b->order);
}

// force, gravity: numbers of their origins (out).
static void list_origins(struct marker *k, uint32_t *force, uint32_t *gravity)
{
    const struct ct_model *m = k->m;
    struct ct_marked_model *out = k->out;
    struct entries list = {0};
    out->of_body = CT_NEWN(k->a, uint32_t, m->nbody + 1);
    out->of_frame = CT_NEWN(k->a, uint32_t, m->nframe + 1);
    out->of_joint = CT_NEWN(k->a, uint32_t, m->njoint + 1);
    out->of_parameter = CT_NEWN(k->a, uint32_t, m->nparameter + 1);
    for (size_t i = 0; i < m->nparameter; i++)
        add(k->a, &list, m->parameter[i].name, m->parameter[i].mark, &out->of_parameter[i],
            false);
    // the position of the file if it is not given
    const struct ct_mark ground = m->body[0].instance.mark;
    add(k->a, &list, "ground", ground.line ? ground : (struct ct_mark){0}, &out->of_body[0],
        true);
    for (size_t i = 1; i < m->nbody; i++)
        add(k->a, &list, m->body[i].instance.name, m->body[i].instance.mark, &out->of_body[i],
            true);
    for (size_t i = 0; i < m->nframe; i++)
        if ((int)i != m->body[m->frame[i].body].frame)
            add(k->a, &list, m->frame[i].name, m->frame[i].mark, &out->of_frame[i], true);
    for (size_t i = 0; i < m->njoint; i++)
        add(k->a, &list, m->joint[i].name, m->joint[i].mark, &out->of_joint[i], true);
    for (size_t i = 0; i < m->nforce; i++)
        add(k->a, &list, m->force[i].name, m->force[i].mark, &force[i], true);
    add(k->a, &list, "gravity", m->gravity_mark, gravity, true);
    ct_sort(k->a, list.at, list.n, sizeof *list.at, by_line, NULL);
    out->norigin = list.n;
    out->origin = CT_NEWN(k->a, struct ct_origin, list.n + 1);
    out->mark = CT_NEWN(k->a, ct_ex, list.n + 1);
    for (size_t i = 0; i < list.n; i++) {
        out->origin[i] = list.at[i].origin;
        *list.at[i].at = (uint32_t)i;
        if (list.at[i].is_marked)
            out->mark[i] = ct_ex_sym(k->x, CT_SYM_PARAM,
                                     ct_arena_printf(k->a, "mark(%s)", list.at[i].origin.name),
                                     (uint32_t)(m->nparameter + i));
    }
    for (size_t i = 0; i < m->nframe; i++) // a body's own frame has no data
        if ((int)i == m->body[m->frame[i].body].frame)
            out->of_frame[i] = out->of_body[m->frame[i].body];
}

// Marks are parameters of value 1.
static void add_parameters(struct marker *k)
{
    const struct ct_marked_model *out = k->out;
    struct ct_model *m = k->m;
    const size_t n = m->nparameter;
    struct ct_parameter *p = CT_NEWN(k->a, struct ct_parameter, n + out->norigin + 1);
    double *value = CT_NEWN(k->a, double, k->x->nsym + 1);
    memcpy(p, m->parameter, n * sizeof *p);
    memcpy(value, m->value, (n + 1) * sizeof *value);
    m->parameter = p;
    m->value = value;
    for (size_t i = 0; i < out->norigin; i++) {
        if (ct_ex_is_zero(out->mark[i]))
            continue;
        p[m->nparameter++]
            = (struct ct_parameter){.name = ct_ex_symbol(k->x, out->mark[i])->name,
                                    .symbol = out->mark[i],
                                    .definition = CT_EX_ONE,
                                    .value = 1};
        value[ct_ex_node(k->x, out->mark[i])->a] = 1;
    }
}

// ---- marks ---------------------------------------------------------------------------------

static ct_ex times(const struct marker *k, uint32_t origin, ct_ex v)
{
    return ct_ex_mul(k->x, v, k->out->mark[origin]);
}

static ct_ex3 times3(const struct marker *k, uint32_t origin, ct_ex3 v)
{
    return ct_ex3_scale(k->x, k->out->mark[origin], v);
}

static const struct ct_beam *mark_beam(struct marker *k, uint32_t origin,
                                       const struct ct_beam *from)
{
    struct ct_beam *beam = copy(k->a, from, 1, sizeof *beam);
    ct_ex *end = copy(k->a, from->end, (size_t)from->nelement, sizeof *end);
    for (int i = 0; i < from->nelement; i++)
        end[i] = times(k, origin, end[i]);
    beam->end = end;
    ct_ex *const value[]
        = {&beam->length,    &beam->E,         &beam->G,         &beam->mass_per_length,
           &beam->rotary[0], &beam->rotary[1], &beam->rotary[2], &beam->twist_inertia};
    for (size_t i = 0; i < COUNT(value); i++)
        *value[i] = times(k, origin, *value[i]);
    return beam;
}

static void mark_bodies(struct marker *k)
{
    struct ct_model *m = k->m;
    COPY(k->a, m->body, m->nbody);
    for (size_t i = 1; i < m->nbody; i++) {
        struct ct_body *body = &m->body[i];
        const uint32_t origin = k->out->of_body[i];
        body->mass = times(k, origin, body->mass);
        body->com = times3(k, origin, body->com);
        for (int j = 0; j < 6; j++)
            body->inertia[j] = times(k, origin, body->inertia[j]);
        if (body->beam)
            body->beam = mark_beam(k, origin, body->beam);
    }
}

// Points of a beam have the mark of the beam, as a point at its end is at its length.
static void mark_frames(struct marker *k)
{
    struct ct_model *m = k->m;
    COPY(k->a, m->frame, m->nframe);
    for (size_t i = 0; i < m->nframe; i++) {
        const int body = m->frame[i].body;
        if (ct_ex_is_zero(k->out->mark[k->out->of_frame[i]]))
            continue;
        m->frame[i].at
            = times3(k, m->body[body].beam ? k->out->of_body[body] : k->out->of_frame[i],
                     m->frame[i].at);
    }
}

static bool is_marked(enum ct_value_kind kind)
{
    return kind == CT_VALUE_SCALAR || kind == CT_VALUE_VEC3 || kind == CT_VALUE_LIST
        || kind == CT_VALUE_COORDS;
}

static void mark_value(struct marker *k, uint32_t origin, struct ct_value *v)
{
    COPY(k->a, v->e, v->n);
    for (size_t i = 0; i < v->n; i++)
        if (!v->hole || !v->hole[i])
            v->e[i] = times(k, origin, v->e[i]);
}

static void mark_instance(struct marker *k, uint32_t origin, struct ct_instance *self)
{
    int nfamily;
    const struct ct_key *family = ct_family_keys(self->cls->family, &nfamily);
    const int n = nfamily + self->cls->nkey;
    struct ct_value *value = copy(k->a, self->value, (size_t)n, sizeof *value);
    for (int i = 0; i < n; i++)
        if (value[i].given
            && is_marked(i < nfamily ? family[i].kind : self->cls->key[i - nfamily].kind))
            mark_value(k, origin, &value[i]);
    self->value = value;
}

void ct_marked_model_create(struct ct_arena *a, const struct ct_model *model, struct ct_exs *x,
                            struct ct_marked_model *out)
{
    *out = (struct ct_marked_model){.model = *model};
    struct marker k = {a, x, out, &out->model};
    uint32_t *force = CT_NEWN(a, uint32_t, model->nforce + 1), gravity;
    k.m->x = x;
    list_origins(&k, force, &gravity);
    add_parameters(&k);
    mark_bodies(&k);
    mark_frames(&k);
    k.m->gravity = times3(&k, gravity, k.m->gravity);
    COPY(a, k.m->joint, k.m->njoint);
    for (size_t i = 0; i < k.m->njoint; i++)
        mark_instance(&k, out->of_joint[i], &k.m->joint[i]);
    COPY(a, k.m->force, k.m->nforce);
    for (size_t i = 0; i < k.m->nforce; i++)
        mark_instance(&k, force[i], &k.m->force[i]);
}
