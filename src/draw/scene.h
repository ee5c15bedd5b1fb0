// A scene: what there is to see of a system, and where it is at a state.
//
//     scene (made once)                        values at a state (scene.nvalue numbers)
//       frame[f]  name, body                     place (3) and rotation to ground (3 x 3) of each frame
//       body[i]   frames held, shapes            --
//       joint[j]  symbol, ends, axes             --
//       force[k]  spring, force, torque, ends    force and torque (3 + 3) of those from outside
//       beam[i]   body, points of its axis       points (3 x npoint)
//
// What always holds: lengths in m, axes of ground unless a comment says otherwise; the values
// come from one program on the input of a run's evaluator, so that a scene does not change the
// motion. Beams bend by their elements' own interpolation. Drawing (svg) and other views know
// nothing of how the values are found.
#ifndef CT_DRAW_SCENE_H
#define CT_DRAW_SCENE_H

#include "solve/evaluator/evaluator.h"
#include "system.h"

/// How a joint is drawn, by what it lets move.
enum ct_symbol {
    CT_SYMBOL_NONE,        // nothing to see: a free joint, a gear
    CT_SYMBOL_PIN,         // one angle
    CT_SYMBOL_SLIDER,      // one length
    CT_SYMBOL_CYLINDRICAL, // a length and the angle about it
    CT_SYMBOL_SCREW,
    CT_SYMBOL_UNIVERSAL, // two angles
    CT_SYMBOL_BALL,
    CT_SYMBOL_PLANAR, // two lengths and an angle
    CT_SYMBOL_WELD,
    CT_SYMBOL_ROD,  // a distance that is kept
    CT_SYMBOL_OTHER // any other motion
};

struct ct_scene_joint {
    const struct ct_instance *self;
    enum ct_symbol symbol;
    int from, to; // frames; -1: none
    int naxis;
    double axis[2][3];           // unit vectors, axes of `from`; the second one axes of `to`
    bool has_spring, has_damper; // along a length
};

struct ct_scene_force {
    const struct ct_instance *self;
    int from, to; // frames; from -1: from outside
    bool has_spring, has_damper;
    size_t first; // of its six values; SIZE_MAX: it has none
};

struct ct_scene_beam {
    int body;
    int npoint;   // along the axis, equally spaced where the beam is straight
    size_t first; // of its values
};

struct ct_scene_body {
    double com[3]; // axes of the body [m]
    bool has_mass;
    int beam;  // -1: none
    int nheld; // frames that joints, springs and forces hold
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

/// The scene of the system that equations were derived from; all of it lives in a. Raises the guard.
void ct_scene_create(struct ct_arena *a, struct ct_build *b, struct ct_scene *s);

/// The program of its values on a run's evaluator. a: lives as long as that. Raises the guard.
void ct_scene_compile(struct ct_arena *a, const struct ct_scene *s, struct ct_evaluator *m,
                      struct ct_program *p);

/// Place (3) and rotation (3 x 3, column-major, its axes -> ground's) of a frame.
static inline const double *ct_scene_place(const double *value, int frame)
{
    return value + (size_t)12 * (size_t)frame;
}
static inline const double *ct_scene_rotation(const double *value, int frame)
{
    return value + (size_t)12 * (size_t)frame + 3;
}
/// out (3) = place of a point given in axes of a frame.
void ct_scene_point(const double *value, int frame, const double local[3], double out[3]);
/// out (3) = a direction given in axes of a frame.
void ct_scene_direction(const double *value, int frame, const double local[3], double out[3]);

#endif
