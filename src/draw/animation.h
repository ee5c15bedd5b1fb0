// The motion of a scene, kept sample by sample, and written as JSON for the page of a report.
//
//     ct_animation_create     what moves: bodies, frames of beams, points of their axes, loads, reactions
//     ct_animation_compile    one program for all of it on the evaluator of a run
//     ct_animation_keep       a row at a sample
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
#include "solve/run/run.h"

struct ct_animation {
    struct ct_scene scene;
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

/// What moves in a system; all of it lives in the system's arena. Before a run of it is made. Raises the guard.
void ct_animation_create(struct ct_system *sys, struct ct_animation *m);
/// On the evaluator of a run. a: the arena of the run. Raises the guard.
void ct_animation_compile(struct ct_arena *a, struct ct_animation *m, struct ct_run *run);
/// A row, where the run has just given the results at t. Raises the guard.
void ct_animation_keep(struct ct_animation *m, struct ct_run *run, double t);
/// Column of pose p > 0, of beam i, of the load of a force, of the reaction of a joint.
size_t ct_animation_pose_column(const struct ct_animation *m, size_t pose);
size_t ct_animation_beam_column(const struct ct_animation *m, size_t beam);
size_t ct_animation_load_column(const struct ct_animation *m, size_t force);
size_t ct_animation_reaction_column(const struct ct_animation *m, size_t joint);

/// Members of an object that is open. At most `most` rows are written: every k-th, and the last one.
void ct_animation_write(struct ct_arena *a, struct ct_json *j, const struct ct_animation *m,
                        size_t most);

#endif
