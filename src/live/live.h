// This folder provides a state of a system that the caller sets, queries and steps, as a
// controller or optimiser does. This header is what its files share.
//
//     data.c     creation, values, time, steps
//     get.c      quantities at the state
//     inverse.c  inverse dynamics
//     item.c     named items of a system
//
// What always holds: a state has a copy of the system, in which it may derive more, and one run
// for all its steps. Its parameter values are those of the copy. y is the state as the caller
// has set it; other quantities are computed on demand.
#ifndef CT_LIVE_H
#define CT_LIVE_H

#include "sim/sim.h"
#include "solve/run/advance.h"

struct ct_linear;

enum {
    CT_KNOWS_MOTION = 1,       // M, Q, J, gam of the evaluator
    CT_KNOWS_CONSTRAINT = 2,   // phi, v
    CT_KNOWS_ACCELERATION = 4, // u'
    CT_KNOWS_MULTIPLIERS = 8,
    CT_KNOWS_OUTPUTS = 16,
    CT_KNOWS_ENERGY = 32,
    CT_KNOWS_FRAMES = 64
};

struct ct_data {
    struct ct_sim sim;             // context, copy of the system and run of the state
    struct ct_system *origin;      // owner of the names
    struct ct_sim_options options; // strings are in the context
    struct ct_assembly *assembly;  // NULL: beams start in equilibrium
    struct ct_advance *advance;
    struct ct_linear *linear; // for ct_data_assemble
    size_t nq, nu, nrow,
        ny; // nu: number of speeds without model states, which follow them in y
    double t, *y;
    bool *is_own;    // by parameter: it has been set and no longer follows its definition
    bool is_moved;   // the state differs from that of the run
    bool is_changed; // parameters have changed since the last step
    bool is_start;   // the state is as assembled at t = 0
    unsigned known;  // bits of enum: quantities that are up to date
    double *M, *J;   // row by row
    double *value;   // outputs (nresult)
    double energy[5];
    struct ct_program strain, frames; // compiled at the first request
    bool has_strain, has_frames;
};

/// Sets the evaluator's input to the state, memories and switches included. False with a
/// diagnostic.
bool ct_data_enter(struct ct_data *d);
/// Computes u' at the state into the coordinate partitioning and the evaluator's input. False
/// with a diagnostic.
bool ct_data_accelerate(struct ct_data *d);
/// Computes phi and v at the state.
void ct_data_constrain(struct ct_data *d);
bool ct_data_find_outputs(struct ct_data *d);

/// As ct_system_item, but without the values of coordinates, speeds and outputs, which need a
/// start.
bool ct_item_describe(const struct ct_system *sys, enum ct_kind kind, size_t i,
                      struct ct_item *item);
/// Has the value of parameter i of the model determined the form of the equations?
bool ct_item_has_decided(const struct ct_system *sys, size_t i);
/// Index of parameter number i among those that are inputs, or among those that are not;
/// nparameter if it does not exist.
size_t ct_item_parameter(const struct ct_model *m, enum ct_kind kind, size_t i);

#endif
