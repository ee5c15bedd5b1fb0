// See animation.h: what the page of a report reads.
//
//     view     "z": the view that `draw` chooses; views: {NAME: {right, up}}
//     normal   of the plane of a planar mechanism, or null
//     bodies   [{name, color, com, held: [[pose, x, y, z]], solids, beam: {column, points, length}}]; number i moves with pose i
//     joints   [{name, symbol, from, to: {body, at: [pose, x, y, z]}, axes, spring, damper, reaction: column}]
//     forces   [{name, from, to, spring, damper, load: column}]
//     traces   [{body, at: [pose, x, y, z]}], and ends of beams
//     times, samples: packed
//
// Axes are unit vectors: the first one moves with the pose of `from`, the second one with that
// of `to`.
#include "draw/animation.h"

#include "component/roundoff.h"
#include "draw/view.h"
#include "report/packed.h"

#include <math.h>
#include <string.h>

struct work {
    struct ct_arena *a;
    struct ct_json *j;
    const struct ct_animation *m;
    const struct ct_model *model;
};

static double number(const struct work *w, ct_ex e)
{
    return ct_model_number(w->model, e);
}

static void write3(const struct work *w, const char *key, ct_ex3 v)
{
    double n[3];
    for (int i = 0; i < 3; i++)
        n[i] = number(w, v.e[i]);
    ct_json_numbers(w->j, key, n, 3);
}

// Writes [pose, x, y, z]; a coordinate that is round-off of the others is 0.
static void write_position(const struct work *w, const char *key, int pose, const double at[3])
{
    const double size = fabs(at[0]) + fabs(at[1]) + fabs(at[2]);
    double v[4] = {pose};
    for (int i = 0; i < 3; i++)
        v[i + 1] = fabs(at[i]) > CT_DATA_ROUNDOFF * size ? at[i] : 0;
    ct_json_numbers(w->j, key, v, 4);
}

static void write_frame(const struct work *w, const char *key, int frame)
{
    write_position(w, key, w->m->pose_of[frame], w->m->local[frame]);
}

// ---- views ---------------------------------------------------------------------------------

static void write_views(const struct work *w)
{
    static const char *const names[] = {"x", "y", "z", "iso"};
    const struct ct_scene *s = &w->m->scene;
    struct ct_view view;
    ct_view_choose(&view, s, NULL);
    ct_json_text(w->j, "view", view.name);
    ct_json_object(w->j, "views");
    for (size_t i = 0; i < COUNT(names); i++) {
        ct_view_choose(&view, s, names[i]);
        ct_json_object(w->j, names[i]);
        ct_json_numbers(w->j, "right", view.right, 3);
        ct_json_numbers(w->j, "up", view.up, 3);
        ct_json_end(w->j);
    }
    ct_json_end(w->j);
    if (s->is_planar)
        ct_json_numbers(w->j, "normal", s->normal, 3);
    else
        ct_json_text(w->j, "normal", NULL);
    ct_json_numbers(w->j, "gravity", s->gravity, 3);
}

// ---- bodies --------------------------------------------------------------------------------

static void write_turns(const struct work *w, const struct ct_solid *solid)
{
    ct_json_array(w->j, "turns");
    for (size_t i = 0; i < solid->nturn; i++) {
        double v[4] = {number(w, solid->turn[i].angle)};
        for (int k = 0; k < 3; k++)
            v[k + 1] = number(w, solid->turn[i].axis.e[k]);
        ct_json_numbers(w->j, NULL, v, 4);
    }
    ct_json_end(w->j);
}

static void write_triangles(const struct work *w, const struct ct_solid *solid)
{
    const size_t n = 3 * solid->ntriangle;
    double *v = CT_NEWN(w->a, double, 3 * n + 1);
    for (size_t i = 0; i < 3 * n; i++)
        v[i] = number(w, solid->scale) * (double)solid->triangle[i];
    ct_pack_write(w->j, w->a, "corners", v, n, 3);
}

static void write_solid(const struct work *w, const struct ct_solid *solid)
{
    static const char *const kinds[] = {[CT_SOLID_BOX] = "box",
                                        [CT_SOLID_CYLINDER] = "cylinder",
                                        [CT_SOLID_SPHERE] = "sphere",
                                        [CT_SOLID_LINES] = "lines",
                                        [CT_SOLID_FILE] = "file"};
    static const size_t sizes[CT_NSOLID]
        = {[CT_SOLID_BOX] = 3, [CT_SOLID_CYLINDER] = 2, [CT_SOLID_SPHERE] = 1};
    double size[3];
    for (size_t i = 0; i < sizes[solid->kind]; i++)
        size[i] = number(w, solid->size[i]);
    ct_json_object(w->j, NULL);
    ct_json_text(w->j, "kind", kinds[solid->kind]);
    ct_json_numbers(w->j, "size", size, sizes[solid->kind]);
    if (solid->kind == CT_SOLID_CYLINDER)
        write3(w, "axis", solid->axis);
    if (solid->kind == CT_SOLID_LINES) {
        ct_json_array(w->j, "points");
        for (size_t i = 0; i < solid->npoint; i++)
            write3(w, NULL, solid->point[i]);
        ct_json_end(w->j);
    }
    if (solid->kind == CT_SOLID_FILE)
        write_triangles(w, solid);
    write3(w, "at", solid->at);
    write_turns(w, solid);
    if (solid->color)
        ct_json_text(w->j, "color", solid->color);
    ct_json_end(w->j);
}

static void write_beam(const struct work *w, int i)
{
    const struct ct_scene_beam *beam = &w->m->scene.beam[i];
    ct_json_object(w->j, "beam");
    ct_json_integer(w->j, "column", (long long)ct_animation_beam_column(w->m, (size_t)i));
    ct_json_integer(w->j, "points", beam->npoint);
    ct_json_number(w->j, "length", number(w, w->model->body[beam->body].beam->length));
    ct_json_end(w->j);
}

static void write_body(const struct work *w, size_t i)
{
    const struct ct_body *b = &w->model->body[i];
    const struct ct_scene_body *s = &w->m->scene.body[i];
    ct_json_object(w->j, NULL);
    ct_json_text(w->j, "name", i ? b->instance.name : "ground");
    ct_json_bool(w->j, "particle", b->is_particle);
    if (s->has_mass)
        ct_json_numbers(w->j, "com", s->com, 3);
    ct_json_array(w->j, "held");
    for (int k = 0; k < s->nheld; k++)
        write_frame(w, NULL, s->held[k]);
    ct_json_end(w->j);
    ct_json_array(w->j, "solids");
    for (size_t k = 0; k < b->nsolid; k++)
        write_solid(w, &b->solid[k]);
    ct_json_end(w->j);
    if (s->beam >= 0)
        write_beam(w, s->beam);
    ct_json_end(w->j);
}

// ---- joints and forces ---------------------------------------------------------------------

static void write_end(const struct work *w, const char *key, int frame)
{
    ct_json_object(w->j, key);
    ct_json_integer(w->j, "body", w->model->frame[frame].body);
    write_frame(w, "at", frame);
    ct_json_end(w->j);
}

// A direction that moves with a frame, in axes of the pose that carries it.
static void turn_to_pose(const struct work *w, int frame, const double v[3], double out[3])
{
    const struct ct_animation *m = w->m;
    const double *R = m->turn[frame];
    for (int i = 0; i < 3; i++)
        out[i] = R[i] * v[0] + R[3 + i] * v[1] + R[6 + i] * v[2];
}

static void write_joint(const struct work *w, size_t i)
{
    static const char *const symbols[] = {[CT_SYMBOL_PIN] = "pin",
                                          [CT_SYMBOL_SLIDER] = "slider",
                                          [CT_SYMBOL_CYLINDRICAL] = "cylindrical",
                                          [CT_SYMBOL_SCREW] = "screw",
                                          [CT_SYMBOL_UNIVERSAL] = "universal",
                                          [CT_SYMBOL_BALL] = "ball",
                                          [CT_SYMBOL_PLANAR] = "planar",
                                          [CT_SYMBOL_WELD] = "weld",
                                          [CT_SYMBOL_ROD] = "rod",
                                          [CT_SYMBOL_OTHER] = "other"};
    const struct ct_scene_joint *s = &w->m->scene.joint[i];
    ct_json_object(w->j, NULL);
    ct_json_text(w->j, "name", s->self->name);
    ct_json_text(w->j, "class", s->self->cls->name);
    ct_json_text(w->j, "symbol", symbols[s->symbol]);
    write_end(w, "from", s->from);
    write_end(w, "to", s->to);
    ct_json_array(w->j, "axes");
    for (int k = 0; k < s->naxis; k++) {
        double v[3];
        turn_to_pose(w, k ? s->to : s->from, s->axis[k], v);
        ct_json_numbers(w->j, NULL, v, 3);
    }
    ct_json_end(w->j);
    ct_json_bool(w->j, "spring", s->has_spring);
    ct_json_bool(w->j, "damper", s->has_damper);
    if (w->m->content == CT_ANIMATION_FORCES)
        ct_json_integer(w->j, "reaction", (long long)ct_animation_reaction_column(w->m, i));
    ct_json_end(w->j);
}

static void write_force(const struct work *w, size_t i)
{
    const struct ct_scene_force *s = &w->m->scene.force[i];
    ct_json_object(w->j, NULL);
    ct_json_text(w->j, "name", s->self->name);
    if (s->from >= 0)
        write_end(w, "from", s->from);
    write_end(w, "to", s->to);
    ct_json_bool(w->j, "spring", s->has_spring);
    ct_json_bool(w->j, "damper", s->has_damper);
    if (s->first != SIZE_MAX && w->m->content == CT_ANIMATION_FORCES)
        ct_json_integer(w->j, "load", (long long)ct_animation_load_column(w->m, i));
    ct_json_end(w->j);
}

// ---- samples -------------------------------------------------------------------------------

// The largest extent of a range of columns over all rows.
static double extent(const struct ct_animation *m, size_t first, size_t step, size_t n)
{
    double most = 0;
    for (size_t c = first; n-- > 0; c += step) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < m->nrow; i++) {
            low = fmin(low, m->row[m->ncolumn * i + c]);
            high = fmax(high, m->row[m->ncolumn * i + c]);
        }
        most = fmax(most, high - low);
    }
    return most;
}

// Largest distance between positions, on bodies and over the motion [m].
static double size_of(const struct ct_animation *m)
{
    double size = 0;
    for (size_t k = 0; k < 3 && m->npose > 1; k++)
        size = fmax(size, extent(m, k, 7, m->npose - 1));
    for (size_t f = 0; f < m->scene.model->nframe; f++)
        size = fmax(size, sqrt(ct_dot3(m->local[f], m->local[f])));
    return size;
}

// Resolution of each column: smaller differences are not visible, even if deflections of beams
// are enlarged a hundred times.
static double *find_resolution(const struct work *w)
{
    // Layout: of the picture
    const double smallest = 1e-6; // relative to the picture, which can be enlarged 1000 times
    const double enlarged = 100;
    const double smallest_force = 1e-4; // relative to the largest force
    const struct ct_animation *m = w->m;
    const size_t beams = ct_animation_beam_column(m, 0),
                 loads = ct_animation_beam_column(m, m->scene.nbeam);
    const double position = smallest * size_of(m),
                 force = smallest_force * extent(m, loads, 1, m->ncolumn - loads);
    double *resolution = CT_NEWN(w->a, double, m->ncolumn + 1);
    for (size_t c = 0; c < m->ncolumn; c++)
        resolution[c] = c >= loads ? force
                      : c >= beams ? position / enlarged
                      : c % 7 < 3  ? position
                                   : smallest;
    return resolution;
}

// Writes every k-th row, with the smallest k that `most` allows, and the last row.
static void write_samples(const struct work *w, size_t most)
{
    const struct ct_animation *m = w->m;
    size_t k = 1;
    while (m->nrow > 1 && (m->nrow - 2) / k + 2 > most && k < m->nrow)
        k++;
    const size_t n = m->nrow > 1 ? (m->nrow - 2) / k + 2 : m->nrow;
    double *v = CT_NEWN(w->a, double, n * m->ncolumn + 1), *t = CT_NEWN(w->a, double, n + 1);
    for (size_t i = 0; i < n; i++) {
        const size_t row = i + 1 == n ? m->nrow - 1 : k * i;
        t[i] = m->time[row];
        memcpy(v + m->ncolumn * i, m->row + m->ncolumn * row, m->ncolumn * sizeof *v);
    }
    ct_json_integer(w->j, "thinned", (long long)k);
    ct_pack_write(w->j, w->a, "times", t, n, 1);
    ct_pack_write_rounded(w->j, w->a, "samples", v, n, m->ncolumn, find_resolution(w));
}

// Writes the traced points, as `draw --trace`: points of moving bodies, the body frame if it
// has none, and both ends of beams.
static void write_traces(const struct work *w)
{
    bool *has_points = CT_NEWN(w->a, bool, w->model->nbody);
    for (size_t f = 0; f < w->model->nframe; f++)
        has_points[w->model->frame[f].body]
            |= (int)f != w->model->body[w->model->frame[f].body].frame;
    ct_json_array(w->j, "traces");
    for (size_t f = 0; f < w->model->nframe; f++) {
        const int body = w->model->frame[f].body;
        if (body == 0 || ((int)f == w->model->body[body].frame && has_points[body]))
            continue;
        ct_json_object(w->j, NULL);
        ct_json_integer(w->j, "body", body);
        write_frame(w, "at", (int)f);
        ct_json_end(w->j);
    }
    ct_json_end(w->j);
}

void ct_animation_write_geometry(struct ct_arena *a, struct ct_json *j,
                                 const struct ct_animation *m)
{
    const struct work w = {a, j, m, m->scene.model};
    write_views(&w);
    ct_json_integer(j, "poses", (long long)m->npose);
    ct_json_array(j, "bodies");
    for (size_t i = 0; i < w.model->nbody; i++)
        write_body(&w, i);
    ct_json_end(j);
    ct_json_array(j, "joints");
    for (size_t i = 0; i < w.model->njoint; i++)
        if (m->scene.joint[i].symbol != CT_SYMBOL_NONE)
            write_joint(&w, i);
    ct_json_end(j);
    ct_json_array(j, "forces");
    for (size_t i = 0; i < w.model->nforce; i++)
        write_force(&w, i);
    ct_json_end(j);
    write_traces(&w);
}

void ct_animation_write(struct ct_arena *a, struct ct_json *j, const struct ct_animation *m,
                        size_t most)
{
    const struct work w = {a, j, m, m->scene.model};
    ct_animation_write_geometry(a, j, m);
    write_samples(&w, most);
}
