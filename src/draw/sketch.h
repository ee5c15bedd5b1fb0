// State of a picture while it is drawn, shared by its files.
//
//     sketch.c        scale, positions of symbols, outlines of bodies
//     sketch_body.c   paths, shapes, bodies, beams
//     sketch_joint.c  supports, joints, springs, loads
//     picture.c       names, axes, scale, and the drawing order
#ifndef CT_DRAW_SKETCH_H
#define CT_DRAW_SKETCH_H

#include "draw/picture.h"
#include "draw/placement.h"
#include "draw/symbol.h"

#include <math.h>

/// Distances below this fraction of the picture are invisible. Layout: a thousandth of a pixel.
#define CT_SKETCH_RESOLUTION 1e-6

// Layout: of the picture
enum { CT_STRIP = 84 }; // [px] below, for axes, gravity and the scale

struct ct_sketch {
    struct ct_arena *a;
    const struct ct_picture *picture;
    const struct ct_scene *s;
    const double *value;
    struct ct_view view;
    struct ct_canvas canvas;
    struct ct_pen pen;
    double size;          // of the scene [m]
    const double **block; // by body: position of the block of its telescope; NULL: none
    int *nseen;           // by body: number of visible ends of joints
    bool *is_on_block;    // by body: it is visible only as a slider's block
    struct ct_outline {   // by body: its outline if it has no shape
        struct ct_spot *p;
        size_t n;
        bool has_centre; // the outline includes the centre of mass
        struct ct_spot centre;
        double depth;
    } * outline;
    struct ct_label *label;
    size_t nlabel, label_cap;
    struct ct_spot (
        *edge)[4]; // by body with a shape: its uppermost, lowest, leftmost and rightmost spots
};

static inline const char *ct_sketch_color_of(int body)
{
    return body == 0 ? "#606060" : ct_palette[(body - 1) % CT_NPALETTE];
}

static inline struct ct_spot ct_sketch_spot(const struct ct_sketch *d, const double position[3])
{
    return ct_view_spot(&d->view, position);
}

static inline struct ct_spot ct_sketch_frame_spot(const struct ct_sketch *d, int frame)
{
    return ct_sketch_spot(d, ct_scene_position(d->value, frame));
}

static inline double ct_sketch_distance(struct ct_spot a, struct ct_spot b)
{
    return hypot(a.x - b.x, a.y - b.y);
}

static inline struct ct_spot ct_sketch_between(struct ct_spot a, struct ct_spot b, double s)
{
    return (struct ct_spot){a.x + s * (b.x - a.x), a.y + s * (b.y - a.y)};
}

static inline bool ct_sketch_has_shape(const struct ct_sketch *d, int body)
{
    return d->s->model->body[body].nsolid > 0;
}

static inline int ct_sketch_body_of(const struct ct_sketch *d, int frame)
{
    return d->s->model->frame[frame].body;
}

static inline bool ct_sketch_slides(enum ct_symbol s)
{
    return s == CT_SYMBOL_SLIDER || s == CT_SYMBOL_CYLINDRICAL || s == CT_SYMBOL_SCREW;
}

static inline double ct_sketch_body_width(const struct ct_sketch *d)
{
    return fmax(2, 0.62 * d->pen.size);
}

static inline bool ct_sketch_is_seen(const struct ct_scene_joint *j)
{
    return j->symbol != CT_SYMBOL_NONE;
}

static inline double ct_sketch_size_of(const double v[3])
{
    return sqrt(ct_dot3(v, v));
}

// ---- sketch.c ------------------------------------------------------------------------------

/// Scale and position of the view; width and height of the picture [px].
void ct_sketch_fit(struct ct_sketch *d, double *width, double *height);
/// The largest size of pins that fits between neighbours [px].
double ct_sketch_symbol_size(const struct ct_sketch *d);
/// Finds bodies visible as a slider's block, and the number of visible ends of joints on each.
void ct_sketch_find_blocks(struct ct_sketch *d);
void ct_sketch_find_outlines(struct ct_sketch *d);
/// Does joint i slide between two moving bodies, with its block half-way?
bool ct_sketch_is_telescope(const struct ct_sketch *d, size_t i);
/// Where the symbol of joint i is.
struct ct_spot ct_sketch_joint_spot(const struct ct_sketch *d, size_t i);
/// Unit vector from a position to the middle of what is drawn of a body; zero if both coincide.
struct ct_spot ct_sketch_direction(const struct ct_sketch *d, int body, struct ct_spot from);

// ---- sketch_body.c -------------------------------------------------------------------------

void ct_sketch_draw_paths(struct ct_sketch *d);
void ct_sketch_draw_shapes(struct ct_sketch *d);
void ct_sketch_draw_bodies(struct ct_sketch *d);

// ---- sketch_joint.c ------------------------------------------------------------------------

/// Grounds and guides, which lie behind bodies.
void ct_sketch_draw_supports(struct ct_sketch *d);
void ct_sketch_draw_joints(struct ct_sketch *d);
void ct_sketch_draw_forces(struct ct_sketch *d);
/// Is an arrow drawn for a load at this time?
bool ct_sketch_acts(const struct ct_sketch *d, const struct ct_scene_force *f);

#endif
