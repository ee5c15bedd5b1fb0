// This folder draws mechanisms and plots: line drawings in SVG, animations for pages, and plots
// of outputs. This header is the geometry that all of them share: the objects of a system, and
// their positions at a state.
//
//     scene (made once)                        values at a state (scene.nvalue numbers)
//       frame[f]  name, body                     position (3) and rotation to ground (3 x 3)
//       body[i]   attached frames, shapes        --
//       joint[j]  symbol, ends, axes             --
//       force[k]  spring, force, torque, ends    force and torque (3 + 3) of external loads
//       beam[i]   body, points of its axis       points (3 x npoint)
//
// What always holds: lengths in m; ground axes unless a comment says otherwise. The values come
// from one program that reads the input of a run's evaluator, so that a scene does not change
// the motion. Beams are interpolated by the shape functions of their elements. Views of a scene
// do not depend on how the values are computed.
#ifndef CT_DRAW_SCENE_H
#define CT_DRAW_SCENE_H

#include "solve/evaluator/evaluator.h"
#include "system.h"

/// Symbol of a joint, by its freedoms.
enum ct_symbol {
    CT_SYMBOL_NONE,        // no symbol: a free joint, a gear
    CT_SYMBOL_PIN,         // one angle
    CT_SYMBOL_SLIDER,      // one length
    CT_SYMBOL_CYLINDRICAL, // a length and the angle about it
    CT_SYMBOL_SCREW,
    CT_SYMBOL_UNIVERSAL, // two angles
    CT_SYMBOL_BALL,
    CT_SYMBOL_PLANAR, // two lengths and an angle
    CT_SYMBOL_WELD,
    CT_SYMBOL_ROD,  // constant distance
    CT_SYMBOL_OTHER // any other motion
};

struct ct_scene_joint {
    const struct ct_instance *self;
    enum ct_symbol symbol;
    int from, to; // frames; -1: none
    int naxis;
    double axis[2][3]; // unit vectors: the first in axes of `from`, the second in axes of `to`
    bool has_spring, has_damper; // along a length
};

struct ct_scene_force {
    const struct ct_instance *self;
    int from, to; // frames; from -1: external
    bool has_spring, has_damper;
    size_t first; // index of its six values; SIZE_MAX: none
};

struct ct_scene_beam {
    int body;
    int npoint;   // along the axis, equally spaced where the beam is straight
    size_t first; // index of its values
};

struct ct_scene_body {
    double com[3]; // axes of the body [m]
    bool has_mass;
    int beam;  // -1: none
    int nheld; // number of frames to which joints, springs and forces are attached
    int *held;
};

struct ct_scene {
    const struct ct_model *model; // frames, bodies and their shapes by the model's numbers
    bool is_planar;
    double normal[3];  // of the plane
    double gravity[3]; // [m/s^2]
    struct ct_scene_body *body;
    struct ct_scene_joint *joint; // by the model's numbers
    struct ct_scene_force *force;
    struct ct_scene_beam *beam;
    size_t nbeam;
    size_t nvalue;
    const ct_ex *expression; // of the values
};

/// Makes the scene of a system; everything lives in a. Raises the guard.
void ct_scene_create(struct ct_arena *a, struct ct_build *b, struct ct_scene *s);

/// Compiles its values for a run's evaluator. a must live as long as the evaluator. Raises the
/// guard.
void ct_scene_compile(struct ct_arena *a, const struct ct_scene *s, struct ct_evaluator *m,
                      struct ct_program *p);

/// Position (3) and rotation (3 x 3, column-major, frame axes -> ground) of a frame.
static inline const double *ct_scene_position(const double *value, int frame)
{
    return value + (size_t)12 * (size_t)frame;
}
static inline const double *ct_scene_rotation(const double *value, int frame)
{
    return value + (size_t)12 * (size_t)frame + 3;
}
/// out (3) = ground coordinates of a point given in the axes of a frame.
void ct_scene_point(const double *value, int frame, const double local[3], double out[3]);
/// out (3) = ground components of a direction given in the axes of a frame.
void ct_scene_direction(const double *value, int frame, const double local[3], double out[3]);

#endif
