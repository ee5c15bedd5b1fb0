// The motion of a scene, recorded sample by sample and written as JSON for the page of a
// report.
//
//     ct_animation_create     bodies, frames of beams, points of their axes, loads, reactions
//     ct_animation_compile    one program for all of them on an evaluator
//     ct_animation_keep       adds a row at the evaluator's state
//     ct_animation_write      geometry, and the rows as columns (report/packed.h)
//
//     row     pose (7) of each pose, points (3 x npoint) of each beam, force, torque (6) of each
//             load, force (3) of each joint
//     pose    position [m], unit quaternion w x y z (axes of the frame -> ground). The sign of the
//             quaternion is continuous from sample to sample.
//
// What always holds: points of beams are in the axes of their body's pose, everything else in
// ground axes; [m], [N], [N m]. Pose 0 is ground and has no columns; pose i < nbody is body i;
// later poses are frames of deformable bodies. Recording does not change the run.
#ifndef CT_DRAW_ANIMATION_H
#define CT_DRAW_ANIMATION_H

#include "draw/scene.h"
#include "report/json.h"

// CT_ANIMATION_FORCES includes positions
enum ct_animation_content { CT_ANIMATION_POSITIONS, CT_ANIMATION_FORCES };

struct ct_animation {
    struct ct_scene scene;
    enum ct_animation_content content;
    size_t npose;
    int *frame;      // by pose
    int *pose_of;    // by frame: the pose that carries it
    size_t reaction; // index of the first reaction among the values
    struct ct_animation_program {
        const ct_ex *expression;
        size_t n;
        bool uses_multipliers;
        struct ct_program program;
    } values;
    double (*local)[3]; // by frame: its position in the axes of its pose [m]
    double (*turn)[9];  // by frame: rotation from its axes to those of its pose
    size_t ncolumn, nrow, row_cap;
    double *row;            // ncolumn x nrow, row after row
    double *time;           // (nrow) [s]
    struct ct_arena *arena; // of the rows
};

/// Lists what moves, for the system of b; all of it lives in a. Before an evaluator of its
/// equations is created. Raises the guard.
void ct_animation_create(struct ct_arena *a, struct ct_build *b,
                         enum ct_animation_content content, struct ct_animation *m);
/// Compiles it for an evaluator. a must live as long as the evaluator; rows live there. Raises
/// the guard.
void ct_animation_compile(struct ct_arena *a, struct ct_animation *m,
                          struct ct_evaluator *evaluator);
/// Adds a row at t for the evaluator's present state, which must include accelerations and
/// multipliers if reactions are recorded. Returns the row, valid until the next one. Raises the
/// guard.
const double *ct_animation_keep(struct ct_animation *m, struct ct_evaluator *evaluator,
                                double t);
/// First column of pose p > 0, of beam i, of the load of a force, of the reaction of a joint.
size_t ct_animation_pose_column(const struct ct_animation *m, size_t pose);
size_t ct_animation_beam_column(const struct ct_animation *m, size_t beam);
size_t ct_animation_load_column(const struct ct_animation *m, size_t force);
size_t ct_animation_reaction_column(const struct ct_animation *m, size_t joint);

/// Writes members of an open object: the geometry and the order of columns.
void ct_animation_write_geometry(struct ct_arena *a, struct ct_json *j,
                                 const struct ct_animation *m);
/// The same with the samples: times and rows. Writes every k-th row and the last one, at most
/// `most` rows.
void ct_animation_write(struct ct_arena *a, struct ct_json *j, const struct ct_animation *m,
                        size_t most);

#endif
