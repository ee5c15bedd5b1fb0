// See scene.h.
#include "draw/scene.h"

#include "formulate/beam/flexible_body.h"
#include "formulate/kinematics/kinematics.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

// ---- joints --------------------------------------------------------------------------------

static void number3(const struct ct_model *m, ct_ex3 e, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = ct_model_number(m, e.e[i]);
}

static int count_lengths(const struct ct_motion *m)
{
    int n = 0;
    for (int i = 0; i < m->nmeasure; i++)
        n += m->measure[i].kind == CT_MEASURE_LENGTH;
    return n;
}

// The symbol of a joint from its numbers of lengths and rotations; a joint that slides without
// a measured length is a screw.
static enum ct_symbol symbol_of(const struct ct_motion *m, int nlength)
{
    const int nangle = m->quaternion >= 0 ? 3 : m->nturn;
    if (nlength == 0 && !ct_ex3_is_zero(m->d))
        return m->nfree == 1 && nangle == 1 ? CT_SYMBOL_SCREW : CT_SYMBOL_OTHER;
    static const enum ct_symbol symbols[4][4]
        = {{CT_SYMBOL_WELD, CT_SYMBOL_PIN, CT_SYMBOL_UNIVERSAL, CT_SYMBOL_BALL},
           {CT_SYMBOL_SLIDER, CT_SYMBOL_CYLINDRICAL, CT_SYMBOL_OTHER, CT_SYMBOL_OTHER},
           {CT_SYMBOL_OTHER, CT_SYMBOL_PLANAR, CT_SYMBOL_OTHER, CT_SYMBOL_OTHER},
           {CT_SYMBOL_NONE, CT_SYMBOL_NONE, CT_SYMBOL_NONE, CT_SYMBOL_NONE}};
    return nlength <= 3 && nangle <= 3 ? symbols[nlength][nangle] : CT_SYMBOL_OTHER;
}

static bool is_given(const struct ct_instance *self, const char *key)
{
    return ct_instance_value(self, key)->given;
}

// The axis of a length or of a rotation; of two rotations the second axis is fixed in `to`.
static void find_axes(const struct ct_model *model, const struct ct_motion *m,
                      struct ct_scene_joint *j)
{
    for (int i = 0; i < m->nturn && j->naxis < 2; i++)
        number3(model, m->turn[i].axis, j->axis[j->naxis++]);
    if (j->symbol == CT_SYMBOL_PLANAR) // the normal of the plane is the axis it turns about
        return;
    for (int i = 0; i < m->nmeasure && j->naxis == 0; i++)
        if (m->measure[i].kind == CT_MEASURE_LENGTH)
            number3(model, m->measure[i].along, j->axis[j->naxis++]);
}

static void create_joint(struct ct_build *b, size_t i, struct ct_scene_joint *j)
{
    const struct ct_instance *self = &b->model->joint[i];
    *j = (struct ct_scene_joint){.self = self, .from = self->from, .to = self->to};
    if (self->from < 0 || self->to < 0)
        return;
    if (!self->cls->motion) {
        j->symbol = CT_SYMBOL_ROD;
        return;
    }
    const struct ct_motion *m = b->topology->edge[b->topology->edge_of_joint[i]].trial;
    const int nlength = count_lengths(m);
    j->symbol = symbol_of(m, nlength);
    find_axes(b->model, m, j);
    j->has_spring = nlength == 1 && is_given(self, "stiffness");
    j->has_damper = nlength == 1 && is_given(self, "damping");
}

// ---- bodies --------------------------------------------------------------------------------

static void mark_attached(bool *held, int frame)
{
    if (frame >= 0)
        held[frame] = true;
}

// The frames to which joints, springs and forces are attached, body by body in one list.
static void list_held(struct ct_arena *a, struct ct_scene *s, const bool *held)
{
    const struct ct_model *m = s->model;
    int *list = CT_NEWN(a, int, m->nframe + 1);
    for (size_t f = 0; f < m->nframe; f++)
        s->body[m->frame[f].body].nheld += held[f];
    for (size_t i = 0; i < m->nbody; i++) {
        s->body[i].held = list;
        list += s->body[i].nheld;
        s->body[i].nheld = 0;
    }
    for (size_t f = 0; f < m->nframe; f++)
        if (held[f]) {
            struct ct_scene_body *b = &s->body[m->frame[f].body];
            b->held[b->nheld++] = (int)f;
        }
}

static void create_bodies(struct ct_arena *a, struct ct_scene *s)
{
    const struct ct_model *m = s->model;
    bool *held = CT_NEWN(a, bool, m->nframe);
    for (size_t i = 0; i < m->njoint; i++) {
        mark_attached(held, s->joint[i].from);
        mark_attached(held, s->joint[i].to);
    }
    for (size_t i = 0; i < m->nforce; i++) {
        mark_attached(held, s->force[i].from);
        mark_attached(held, s->force[i].to);
    }
    s->body = CT_NEWN(a, struct ct_scene_body, m->nbody);
    for (size_t i = 0; i < m->nbody; i++) {
        struct ct_scene_body *body = &s->body[i];
        const struct ct_body *from = &m->body[i];
        body->beam = -1;
        body->has_mass = i > 0 && !ct_ex_is_zero(from->mass);
        number3(m, from->com, body->com);
    }
    list_held(a, s, held);
}

// ---- values --------------------------------------------------------------------------------

struct values {
    struct ct_arena *a;
    ct_ex *e;
    size_t n, cap;
};

static void push(struct values *v, ct_ex e)
{
    CT_PUSH(v->a, v->e, v->n, v->cap, e);
}

static void push3(struct values *v, ct_ex3 e)
{
    for (int i = 0; i < 3; i++)
        push(v, e.e[i]);
}

// Axes of a particle stay parallel to ground.
static void push_frame(struct ct_build *b, struct values *v, int node)
{
    push3(v, ct_node_position(b, node));
    const bool is_turned = !b->topology->node[node].is_particle;
    const ct_ex33 R = is_turned ? ct_node_rotation(b, node) : (ct_ex33){{CT_EX_ZERO}};
    for (int i = 0; i < 9; i++)
        push(v, is_turned ? R.e[i] : i % 4 == 0 ? CT_EX_ONE : CT_EX_ZERO);
}

// Number of points such that a polyline looks smooth even if every element bends in a full
// wave.
static int points_of_beam(const struct ct_flexible *f)
{
    // Layout: of the picture
    enum { FEWEST = 40, MOST = 400 };
    const int n = f->beam->nelement;
    return 1 + (n >= MOST ? MOST : n * (n >= FEWEST ? 1 : (FEWEST + n - 1) / n));
}

static void push_beam(struct ct_build *b, struct values *v, const struct ct_flexible *f,
                      struct ct_scene_beam *beam)
{
    *beam = (struct ct_scene_beam){.body = f->body, .npoint = points_of_beam(f), .first = v->n};
    const ct_ex3 base = ct_node_position(b, f->base);
    for (int i = 0; i < beam->npoint; i++) {
        struct ct_station s;
        const double share = (double)i / (beam->npoint - 1);
        ct_flexible_station(b, f, ct_ex_scale(b->x, share, f->beam->length), f->kinematics, &s);
        push3(v, ct_ex3_add(b->x, base, ct_node_turn(b, f->base, s.position)));
    }
}

static void push_load(struct ct_build *b, struct values *v, struct ct_scene_force *force)
{
    force->first = SIZE_MAX;
    for (size_t i = 0; i < b->loads->nload && force->from < 0; i++)
        if (b->loads->load[i].self == force->self) {
            force->first = v->n;
            push3(v, b->loads->load[i].force);
            push3(v, b->loads->load[i].torque);
            return;
        }
}

// Springs and bushings have two ends; their keys show which parts they have.
static void create_force(const struct ct_instance *self, struct ct_scene_force *force)
{
    *force = (struct ct_scene_force){.self = self, .from = self->from, .to = self->to};
    for (int k = 0; self->from >= 0 && k < self->cls->nkey; k++) {
        const char *name = self->cls->key[k].name;
        force->has_spring |= strcmp(name, "stiffness") == 0 && is_given(self, name);
        force->has_damper |= strcmp(name, "damping") == 0 && is_given(self, name);
    }
}

void ct_scene_create(struct ct_arena *a, struct ct_build *b, struct ct_scene *s)
{
    const struct ct_model *m = b->model;
    struct values v = {.a = a};
    *s = (struct ct_scene){
        .model = m, .is_planar = b->topology->keeps_plane, .nbeam = b->nflexible};
    number3(m, m->gravity, s->gravity);
    if (s->is_planar)
        number3(m, b->topology->normal, s->normal);
    s->joint = CT_NEWN(a, struct ct_scene_joint, m->njoint + 1);
    s->force = CT_NEWN(a, struct ct_scene_force, m->nforce + 1);
    s->beam = CT_NEWN(a, struct ct_scene_beam, s->nbeam + 1);
    for (size_t i = 0; i < m->njoint; i++)
        create_joint(b, i, &s->joint[i]);
    for (size_t i = 0; i < m->nforce; i++)
        create_force(&m->force[i], &s->force[i]);
    create_bodies(a, s);
    for (size_t f = 0; f < m->nframe; f++)
        push_frame(b, &v, b->topology->node_of_frame[f]);
    for (size_t i = 0; i < s->nbeam; i++) {
        push_beam(b, &v, &b->flexible[i], &s->beam[i]);
        s->body[b->flexible[i].body].beam = (int)i;
    }
    for (size_t i = 0; i < m->nforce; i++)
        push_load(b, &v, &s->force[i]);
    s->expression = v.e;
    s->nvalue = v.n;
}

void ct_scene_compile(struct ct_arena *a, const struct ct_scene *s, struct ct_evaluator *m,
                      struct ct_program *p)
{
    ct_evaluator_add_program(a, m, m->e->build->x, s->expression, s->nvalue, p);
}

// ---- questions -----------------------------------------------------------------------------

void ct_scene_direction(const double *value, int frame, const double local[3], double out[3])
{
    const double *R = ct_scene_rotation(value, frame);
    for (int i = 0; i < 3; i++)
        out[i] = R[i] * local[0] + R[3 + i] * local[1] + R[6 + i] * local[2];
}

void ct_scene_point(const double *value, int frame, const double local[3], double out[3])
{
    const double *r = ct_scene_position(value, frame);
    ct_scene_direction(value, frame, local, out);
    for (int i = 0; i < 3; i++)
        out[i] += r[i];
}
