// The motion of a scene, kept sample by sample, and written as JSON for the page of a report.
//
//     ct_animation_create     what moves: bodies, frames of beams, points of their axes, loads, reactions
//     ct_animation_compile    one program for all of it on an evaluator
//     ct_animation_keep       a row where the evaluator stands
//     ct_animation_write      geometry, and the rows as columns (report/packed.h)
//
//     row     pose (7) of each pose | points (3 x npoint) of each beam | force, torque (6) of each load
//             | force (3) of each joint
//     pose    place [m], unit quaternion w x y z (axes of the frame -> ground's); its sign keeps
//             the direction it had at the sample before
//
// What always holds: points of beams are in axes of their body's pose, all else in axes of ground;
// [m], [N], [N m]. Pose 0 is ground and has no columns; pose i < nbody is body i; those behind are frames of
// bodies that bend. A motion does not change the run.
#ifndef CT_DRAW_ANIMATION_H
#define CT_DRAW_ANIMATION_H

#include "draw/scene.h"
#include "report/json.h"

enum ct_animation_content { CT_ANIMATION_PLACES, CT_ANIMATION_FORCES }; // these: places, too

struct ct_animation {
    struct ct_scene scene;
    enum ct_animation_content content;
    size_t npose;
    int *frame;      // by pose
    int *pose_of;    // by frame: the pose it moves with
    size_t reaction; // of the first reaction among the values
    struct ct_animation_program {
        const ct_ex *expression;
        size_t n;
        bool uses_multipliers;
        struct ct_program program;
    } values;
    double (*local)[3]; // by frame: its place in axes of its pose [m]
    double (*turn)[9];  // by frame: its axes -> those of its pose
    size_t ncolumn, nrow, row_cap;
    double *row;            // ncolumn x nrow, a row after the other
    double *time;           // (nrow) [s]
    struct ct_arena *arena; // of the rows
};

/// What moves in the system that equations were derived from; all of it lives in a. Before an evaluator is made of
/// them. Raises the guard.
void ct_animation_create(struct ct_arena *a, struct ct_build *b,
                         enum ct_animation_content content, struct ct_animation *m);
/// On an evaluator. a: as long as that lives; rows live there. Raises the guard.
void ct_animation_compile(struct ct_arena *a, struct ct_animation *m,
                          struct ct_evaluator *evaluator);
/// A row at t, where the evaluator stands: with accelerations for reactions, and multipliers, where these are used.
/// Returns it, until the next one comes. Raises the guard.
const double *ct_animation_keep(struct ct_animation *m, struct ct_evaluator *evaluator,
                                double t);
/// Column of pose p > 0, of beam i, of the load of a force, of the reaction of a joint.
size_t ct_animation_pose_column(const struct ct_animation *m, size_t pose);
size_t ct_animation_beam_column(const struct ct_animation *m, size_t beam);
size_t ct_animation_load_column(const struct ct_animation *m, size_t force);
size_t ct_animation_reaction_column(const struct ct_animation *m, size_t joint);

/// Members of an object that is open: geometry, and how columns lie.
void ct_animation_write_geometry(struct ct_arena *a, struct ct_json *j,
                                 const struct ct_animation *m);
/// The same, and samples: times and rows. At most `most` rows are written: every k-th, and the last one.
void ct_animation_write(struct ct_arena *a, struct ct_json *j, const struct ct_animation *m,
                        size_t most);

#endif
