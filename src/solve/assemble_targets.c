// What `initial` asks of coordinates: see assembler.h.
#include "solve/assembler.h"

#include <math.h>

const struct ct_value *ct_initial_value(const struct ct_edge_info *e, bool is_speed)
{
    return is_speed ? &e->self->initial.u : &e->self->initial.q;
}

// Quaternion of successive turns given beside q.
static void initial_turns(const struct ct_model *model, const struct ct_value *v, double p[4])
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

bool ct_initial_number(const struct ct_model *model, const struct ct_value *v, int place,
                       double *out)
{
    if (!v->given || (size_t)place >= v->n || (v->hole && v->hole[place]))
        return false;
    *out = ct_model_number(model, v->e[place]);
    return true;
}

static void joint_target(struct ct_assembler *s, size_t i, const struct ct_model *model)
{
    const struct ct_coordinate *c = &s->e->coordinate[i];
    const struct ct_edge_info *e = &s->e->build->edge[c->edge];
    const struct ct_initial *initial = &e->self->initial;
    const int k = e->trial.quaternion;
    struct ct_target *q = &s->q[i], *u = &s->u[i];
    q->in_quaternion = k >= 0 && c->place >= k;
    q->value = q->in_quaternion && c->place == k;
    bool given = ct_initial_number(model, &initial->q, c->place, &q->value);
    if (q->in_quaternion && initial->rotate.given) {
        double p[4];
        initial_turns(model, &initial->rotate, p);
        q->value = p[c->place - k];
        given = true;
    }
    q->wanted = true;
    q->is_given = given && !initial->guess;
    u->wanted = c->place < e->self->nfree;
    u->is_given = ct_initial_number(model, &initial->u, c->place, &u->value) && !initial->guess
               && u->wanted;
    if (c->is_driven) // the motion itself holds the value
        q->wanted = q->is_given = u->wanted = u->is_given = false;
    if (!c->in_translation && !c->in_rotation)
        q->wanted = q->is_given = u->wanted = u->is_given = false;
}

// A body that hangs on no joint starts with its frame at the origin: its centre of mass at com.
static void body_target(struct ct_assembler *s, size_t i, const struct ct_model *model)
{
    const struct ct_coordinate *c = &s->e->coordinate[i];
    const struct ct_build *b = s->e->build;
    const struct ct_edge_info *e = &b->edge[c->edge];
    const int k = e->trial.quaternion;
    struct ct_target *q = &s->q[i], *u = &s->u[i];
    if (c->q < 0)
        return; // held by joints
    q->in_quaternion = k >= 0 && c->place >= k;
    q->wanted = true;
    u->wanted = c->u >= 0;
    const int lengths = b->is_planar ? 2 : 3;
    if (q->in_quaternion)
        q->value = c->place == k;
    else if (c->place < lengths)
        for (int j = 0; j < 3; j++)
            q->value
                += ct_model_number(model, model->body[e->index].com.e[j])
                 * ct_model_number(model, b->is_planar ? b->plane[c->place].e[j]
                                                       : (ct_ex){(uint32_t)(j == c->place)});
}

// Quaternions need not be given with length one.
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
        const struct ct_edge_info *e = &s->e->build->edge[s->e->coordinate[i].edge];
        if (e->kind == CT_EDGE_JOINT)
            joint_target(s, i, model);
        else if (e->kind == CT_EDGE_BODY)
            body_target(s, i, model);
    }
    for (size_t i = 0; i < s->e->ncoordinate; i++) {
        const struct ct_coordinate *c = &s->e->coordinate[i];
        if (s->q[i].in_quaternion && c->place == s->e->build->edge[c->edge].trial.quaternion)
            normalise_target(&s->q[i]);
    }
}
