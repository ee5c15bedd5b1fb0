// Targets of coordinates and speeds from `initial`; see assembly_internal.h.
#include "solve/initial/assembly_internal.h"

#include <math.h>

const struct ct_value *ct_initial_value(const struct ct_edge_info *e, bool is_speed)
{
    return is_speed ? &e->self->initial.u : &e->self->initial.q;
}

// Quaternion p of the successive rotations of `rotate`.
static void rotation_quaternion(const struct ct_model *model, const struct ct_value *v,
                                double p[4])
{
    p[0] = 1;
    p[1] = p[2] = p[3] = 0;
    for (size_t i = 0; i < v->nturn; i++) {
        const double angle = ct_model_number(model, v->turn[i].angle), c = cos(angle / 2);
        double n[3], w[4] = {p[0], p[1], p[2], p[3]};
        for (int k = 0; k < 3; k++)
            n[k] = sin(angle / 2) * ct_model_number(model, v->turn[i].axis.e[k]);
        p[0] = w[0] * c - w[1] * n[0] - w[2] * n[1] - w[3] * n[2];
        p[1] = w[1] * c + w[0] * n[0] + w[2] * n[2] - w[3] * n[1];
        p[2] = w[2] * c + w[0] * n[1] + w[3] * n[0] - w[1] * n[2];
        p[3] = w[3] * c + w[0] * n[2] + w[1] * n[1] - w[2] * n[0];
    }
}

bool ct_initial_number(const struct ct_model *model, const struct ct_value *v, int index,
                       double *out)
{
    if (!v->given || (size_t)index >= v->n || (v->hole && v->hole[index]))
        return false;
    *out = ct_model_number(model, v->e[index]);
    return true;
}

// ---- natural scales -----------------------------------------------------------------------------

static double square_distance(const double a[3], const double b[3])
{
    double square = 0;
    for (int k = 0; k < 3; k++)
        square += (a[k] - b[k]) * (a[k] - b[k]);
    return square;
}

// Natural length: the largest distance between two points of one body, the ground included, at
// which joints act; 1 m if there is none. It is invariant under rigid motion of the whole
// mechanism.
static double natural_length(const struct ct_assembler *s, const struct ct_model *model)
{
    double largest = 0;
    // linked list of the frames of each body; frame index plus one, 0 ends it
    size_t *last = CT_NEWN(s->ctx->scratch, size_t, model->nbody + 1),
           *before = CT_NEWN(s->ctx->scratch, size_t, s->nframe + 1);
    for (size_t i = 0; i < s->nframe; i++) {
        const int body = model->frame[s->frame[i]].body;
        for (int k = 0; k < 3; k++)
            s->point[3 * i + (size_t)k]
                = ct_model_number(model, model->frame[s->frame[i]].at.e[k]);
        before[i] = last[body];
        last[body] = i + 1;
        for (size_t j = before[i]; j > 0; j = before[j - 1])
            largest = fmax(largest, square_distance(s->point + 3 * i, s->point + 3 * (j - 1)));
    }
    return largest > 0 ? sqrt(largest) : 1;
}

void ct_assembler_list_frames(struct ct_assembler *s, struct ct_arena *a,
                              const struct ct_model *model)
{
    bool *is_listed = CT_NEWN(a, bool, model->nframe + 1);
    s->frame = CT_NEWN(a, int, 2 * model->njoint + 1);
    for (size_t i = 0; i < 2 * model->njoint; i++) {
        const struct ct_instance *j = &model->joint[i / 2];
        const int f = i % 2 ? j->to : j->from;
        if (f >= 0 && !is_listed[f])
            s->frame[s->nframe++] = f;
        if (f >= 0)
            is_listed[f] = true;
    }
    s->point = CT_NEWN(a, double, 3 * s->nframe + 1);
}

bool ct_assembler_is_turn(const struct ct_assembler *s, size_t i)
{
    const struct ct_coordinate *c = &s->e->coordinate[i];
    const struct ct_edge_info *e = &s->e->build->topology->edge[c->edge];
    return e->kind == CT_EDGE_JOINT && !c->in_translation && c->index < e->trial->nmeasure
        && e->trial->measure[c->index].kind == CT_MEASURE_ANGLE;
}

// For coordinates that are not part of a quaternion.
static bool is_length(const struct ct_equations *eqs, size_t i)
{
    const struct ct_coordinate *c = &eqs->coordinate[i];
    const struct ct_edge_info *e = &eqs->build->topology->edge[c->edge];
    if (e->kind == CT_EDGE_BODY)
        return c->index < (eqs->build->topology->is_planar ? 2 : 3);
    if (c->index < e->trial->nmeasure)
        return e->trial->measure[c->index].kind == CT_MEASURE_LENGTH;
    return !c->in_rotation;
}

bool ct_start_is_length(const struct ct_initial_state *start, size_t i)
{
    return !start->q_target[i].in_quaternion && is_length(start->e, i);
}

static double weight_of(const struct ct_target *t, double unit)
{
    return (t->is_given || t->is_guessed ? 1 : ct_assembly_open_weight) / unit;
}

// ---- values -------------------------------------------------------------------------------------

static void joint_target(struct ct_assembler *s, size_t i, const struct ct_model *model)
{
    const struct ct_coordinate *c = &s->e->coordinate[i];
    const struct ct_edge_info *e = &s->e->build->topology->edge[c->edge];
    const struct ct_initial *initial = &e->self->initial;
    const int k = e->trial->quaternion;
    struct ct_target *q = &s->q[i], *u = &s->u[i];
    q->in_quaternion = k >= 0 && c->index >= k;
    q->value = q->in_quaternion && c->index == k;
    bool given = ct_initial_number(model, &initial->q, c->index, &q->value);
    if (q->in_quaternion && initial->rotate.given) {
        double p[4];
        rotation_quaternion(model, &initial->rotate, p);
        q->value = p[c->index - k];
        given = true;
    }
    q->wanted = true;
    q->is_given = given && !initial->guess;
    q->is_guessed = given && initial->guess;
    u->wanted = c->index < e->self->nfree;
    given = ct_initial_number(model, &initial->u, c->index, &u->value) && u->wanted;
    u->is_given = given && !initial->guess;
    u->is_guessed = given && initial->guess;
    if (c->is_driven
        || (!c->in_translation && !c->in_rotation)) // driven, or no degree of freedom
        *q = *u = (struct ct_target){.in_quaternion = q->in_quaternion};
}

// A body without joints starts with its frame at the origin, its centre of mass at com.
static void body_target(struct ct_assembler *s, size_t i, const struct ct_model *model)
{
    const struct ct_coordinate *c = &s->e->coordinate[i];
    const struct ct_build *b = s->e->build;
    const struct ct_edge_info *e = &b->topology->edge[c->edge];
    const int k = e->trial->quaternion;
    struct ct_target *q = &s->q[i], *u = &s->u[i];
    if (c->q < 0)
        return; // held by joints
    q->in_quaternion = k >= 0 && c->index >= k;
    q->wanted = true;
    u->wanted = c->u >= 0;
    const int lengths = b->topology->is_planar ? 2 : 3;
    if (q->in_quaternion)
        q->value = c->index == k;
    else if (c->index < lengths)
        for (int j = 0; j < 3; j++)
            q->value += ct_model_number(model, model->body[e->index].com.e[j])
                      * ct_model_number(model, b->topology->is_planar
                                                   ? b->topology->plane[c->index].e[j]
                                                   : (ct_ex){(uint32_t)(j == c->index)});
}

// Given quaternions need not have unit norm.
static void normalise_target(struct ct_target *q)
{
    double norm = 0;
    for (int i = 0; i < 4; i++)
        norm += q[i].value * q[i].value;
    for (int i = 0; i < 4 && norm > 0; i++)
        q[i].value /= sqrt(norm);
}

void ct_assembler_find_targets(struct ct_assembler *s, const struct ct_model *model)
{
    for (size_t i = 0; i < s->e->ncoordinate; i++) {
        const struct ct_edge_info *e = &s->e->build->topology->edge[s->e->coordinate[i].edge];
        if (e->kind == CT_EDGE_JOINT)
            joint_target(s, i, model);
        else if (e->kind == CT_EDGE_BODY)
            body_target(s, i, model);
    }
    for (size_t i = 0; i < s->e->ncoordinate; i++) {
        const struct ct_coordinate *c = &s->e->coordinate[i];
        if (s->q[i].in_quaternion
            && c->index == s->e->build->topology->edge[c->edge].trial->quaternion)
            normalise_target(&s->q[i]);
    }
    s->length = natural_length(s, model);
    for (size_t i = 0; i < s->e->ncoordinate; i++) {
        const double unit = !s->q[i].in_quaternion && is_length(s->e, i) ? s->length : 1;
        s->q[i].weight = weight_of(&s->q[i], unit);
        s->u[i].weight = weight_of(&s->u[i], unit);
    }
}
