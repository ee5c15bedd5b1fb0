// See animation.h.
#include "draw/animation.h"

#include "draw/view.h"
#include "formulate/dynamics/reaction.h"

#include <math.h>
#include <string.h>

// ---- what moves ----------------------------------------------------------------------------

// Lists the poses: each body, then the frames of beams, which move relative to their bodies.
static void find_poses(struct ct_arena *a, struct ct_animation *m)
{
    const struct ct_model *model = m->scene.model;
    m->frame = CT_NEWN(a, int, model->nbody + model->nframe);
    m->pose_of = CT_NEWN(a, int, model->nframe + 1);
    m->local = ct_arena_calloc(a, model->nframe + 1, sizeof *m->local);
    m->turn = ct_arena_calloc(a, model->nframe + 1, sizeof *m->turn);
    for (size_t i = 0; i < model->nbody; i++)
        m->frame[m->npose++] = model->body[i].frame;
    for (size_t f = 0; f < model->nframe; f++) {
        const int body = model->frame[f].body;
        m->pose_of[f] = body;
        if (m->scene.body[body].beam < 0 || (int)f == model->body[body].frame)
            continue;
        m->pose_of[f] = (int)m->npose;
        m->frame[m->npose++] = (int)f;
    }
}

// Force of body `from` on `to` in ground axes. Components perpendicular to a planar mechanism
// are not known and set to 0.
static ct_ex3 reaction(struct ct_build *b, size_t joint)
{
    ct_ex3 force, torque;
    ct_reaction_derive(b, (int)joint, &force, &torque);
    if (!b->topology->keeps_plane)
        return force;
    const ct_ex out = ct_ex3_dot(b->x, force, b->topology->normal);
    return ct_ex3_sub(b->x, force, ct_ex3_scale(b->x, out, b->topology->normal));
}

static bool has_reaction(const struct ct_build *b, const struct ct_scene *s, size_t joint)
{
    return s->joint[joint].symbol != CT_SYMBOL_NONE && b->topology->edge_of_joint[joint] >= 0;
}

static void list_values(struct ct_build *b, struct ct_arena *a, struct ct_animation *m)
{
    const struct ct_model *model = m->scene.model;
    ct_ex *e = CT_NEWN(a, ct_ex, m->scene.nvalue + 3 * model->njoint + 1);
    size_t n = m->scene.nvalue;
    memcpy(e, m->scene.expression, n * sizeof *e);
    m->reaction = n;
    for (size_t i = 0; i < model->njoint && m->content == CT_ANIMATION_FORCES; i++) {
        const ct_ex3 f
            = has_reaction(b, &m->scene, i) ? reaction(b, i) : (ct_ex3){{CT_EX_ZERO}};
        for (int k = 0; k < 3; k++)
            e[n++] = f.e[k];
    }
    m->values.expression = e;
    m->values.n = n;
    for (size_t i = m->reaction; i < n; i++)
        m->values.uses_multipliers |= (ct_ex_kinds(b->x, e[i]) & 1u << CT_SYM_LAM) != 0;
}

void ct_animation_create(struct ct_arena *a, struct ct_build *b,
                         enum ct_animation_content content, struct ct_animation *m)
{
    *m = (struct ct_animation){.content = content};
    ct_scene_create(a, b, &m->scene);
    find_poses(a, m);
    list_values(b, a, m);
    m->ncolumn = content == CT_ANIMATION_FORCES
                   ? ct_animation_reaction_column(m, m->scene.model->njoint)
                   : ct_animation_load_column(m, 0);
}

// ---- columns -------------------------------------------------------------------------------

size_t ct_animation_pose_column(const struct ct_animation *m, size_t pose)
{
    (void)m;
    return 7 * (pose - 1);
}

size_t ct_animation_beam_column(const struct ct_animation *m, size_t beam)
{
    size_t column = 7 * (m->npose - 1);
    for (size_t i = 0; i < beam; i++)
        column += 3 * (size_t)m->scene.beam[i].npoint;
    return column;
}

// Only loads have columns: a spring between two frames is visible by its length.
size_t ct_animation_load_column(const struct ct_animation *m, size_t force)
{
    size_t column = ct_animation_beam_column(m, m->scene.nbeam);
    for (size_t i = 0; i < force; i++)
        column += m->scene.force[i].first == SIZE_MAX ? 0 : 6;
    return column;
}

size_t ct_animation_reaction_column(const struct ct_animation *m, size_t joint)
{
    return ct_animation_load_column(m, m->scene.model->nforce) + 3 * joint;
}

// ---- rows ----------------------------------------------------------------------------------

void ct_animation_compile(struct ct_arena *a, struct ct_animation *m,
                          struct ct_evaluator *evaluator)
{
    m->arena = a;
    ct_evaluator_add_program(a, evaluator, evaluator->e->build->x, m->values.expression,
                             m->values.n, &m->values.program);
}

// Computes the largest of the four numbers first, to avoid a division by a small one (Shepperd
// 1978).
static void quaternion_of(const double *R, const double before[4], double q[4])
{
    const double trace = R[0] + R[4] + R[8];
    const double square[4]
        = {1 + trace, 1 + 2 * R[0] - trace, 1 + 2 * R[4] - trace, 1 + 2 * R[8] - trace};
    const double product[4][4] = {{0, R[5] - R[7], R[6] - R[2], R[1] - R[3]},
                                  {R[5] - R[7], 0, R[1] + R[3], R[2] + R[6]},
                                  {R[6] - R[2], R[1] + R[3], 0, R[5] + R[7]},
                                  {R[1] - R[3], R[2] + R[6], R[5] + R[7], 0}};
    int largest = 0;
    for (int i = 1; i < 4; i++)
        largest = square[i] > square[largest] ? i : largest;
    double along = 0;
    for (int i = 0; i < 4; i++) {
        const double root = sqrt(square[largest]);
        q[i] = (i == largest ? root : product[largest][i] / root) / 2;
        along += q[i] * (before ? before[i] : i == 0);
    }
    for (int i = 0; i < 4 && along < 0; i++)
        q[i] = -q[i];
}

// out = R' (point - origin)
static void to_axes(const double *R, const double origin[3], const double position[3],
                    double out[3])
{
    double d[3];
    for (int i = 0; i < 3; i++)
        d[i] = position[i] - origin[i];
    for (int i = 0; i < 3; i++)
        out[i] = ct_dot3(R + 3 * (size_t)i, d);
}

static void keep_poses(struct ct_animation *m, const double *value, const double *before,
                       double *row)
{
    for (size_t p = 1; p < m->npose; p++) {
        const size_t at = ct_animation_pose_column(m, p);
        memcpy(row + at, ct_scene_position(value, m->frame[p]), 3 * sizeof *row);
        quaternion_of(ct_scene_rotation(value, m->frame[p]), before ? before + at + 3 : NULL,
                      row + at + 3);
    }
}

static void keep_beams(struct ct_animation *m, const double *value, double *row)
{
    for (size_t i = 0; i < m->scene.nbeam; i++) {
        const struct ct_scene_beam *beam = &m->scene.beam[i];
        const int frame = m->scene.model->body[beam->body].frame;
        double *out = row + ct_animation_beam_column(m, i);
        for (size_t k = 0; k < (size_t)beam->npoint; k++)
            to_axes(ct_scene_rotation(value, frame), ct_scene_position(value, frame),
                    value + beam->first + 3 * k, out + 3 * k);
    }
}

// Finds the constant positions of frames relative to their poses.
static void find_local(struct ct_animation *m, const double *value)
{
    for (size_t f = 0; f < m->scene.model->nframe; f++) {
        const int carrier = m->frame[m->pose_of[f]];
        to_axes(ct_scene_rotation(value, carrier), ct_scene_position(value, carrier),
                ct_scene_position(value, (int)f), m->local[f]);
        for (int k = 0; k < 3; k++)
            to_axes(ct_scene_rotation(value, carrier), (double[3]){0},
                    ct_scene_rotation(value, (int)f) + 3 * (size_t)k,
                    m->turn[f] + 3 * (size_t)k);
    }
}

static double *add_row(struct ct_animation *m, double t)
{
    if (m->nrow == m->row_cap) {
        const size_t cap = m->row_cap ? 2 * m->row_cap : 256;
        double *row = CT_NEWN(m->arena, double, cap * m->ncolumn + 1),
               *time = CT_NEWN(m->arena, double, cap);
        if (m->nrow) {
            memcpy(row, m->row, m->nrow * m->ncolumn * sizeof *row);
            memcpy(time, m->time, m->nrow * sizeof *time);
        }
        m->row = row;
        m->time = time;
        m->row_cap = cap;
    }
    m->time[m->nrow] = t;
    return m->row + m->nrow++ * m->ncolumn;
}

static void keep_forces(struct ct_animation *m, const double *value, double *row)
{
    for (size_t i = 0; i < m->scene.model->nforce; i++)
        if (m->scene.force[i].first != SIZE_MAX)
            memcpy(row + ct_animation_load_column(m, i), value + m->scene.force[i].first,
                   6 * sizeof *row);
    memcpy(row + ct_animation_reaction_column(m, 0), value + m->reaction,
           3 * m->scene.model->njoint * sizeof *row);
}

const double *ct_animation_keep(struct ct_animation *m, struct ct_evaluator *evaluator,
                                double t)
{
    ct_program_run(&m->values.program, evaluator->input);
    const double *value = m->values.program.out;
    double *row = add_row(m, t);
    if (m->nrow == 1)
        find_local(m, value);
    keep_poses(m, value, m->nrow > 1 ? row - m->ncolumn : NULL, row);
    keep_beams(m, value, row);
    if (m->content == CT_ANIMATION_FORCES)
        keep_forces(m, value, row);
    return row;
}
