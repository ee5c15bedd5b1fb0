// One state of a system, from inside: what its files share.
//
//     data.c     creation, values, time, steps
//     get.c      what follows from the state
//     inverse.c  efforts for accelerations
//     item.c     what a system has names for
//
// What always holds: a state has a copy of the system in which it may derive more, and a run that is kept from step to step; its values of
// parameters are those of the copy. y is the state as the caller has it; what is computed from it is computed when it is asked for.
#ifndef CT_LIVE_H
#define CT_LIVE_H

#include "sim/sim.h"
#include "solve/run/advance.h"

struct ct_linear;

enum {
    CT_KNOWS_MOTION = 1,       // M, Q, J, gam of the machine
    CT_KNOWS_CONSTRAINT = 2,   // phi, v
    CT_KNOWS_ACCELERATION = 4, // u'
    CT_KNOWS_MULTIPLIERS = 8,
    CT_KNOWS_OUTPUTS = 16,
    CT_KNOWS_ENERGY = 32,
    CT_KNOWS_FRAMES = 64
};

struct ct_data {
    struct ct_sim sim;             // its context, its copy of the system, its run
    struct ct_system *origin;      // whose names are used
    struct ct_sim_options options; // with strings in the context
    struct ct_assembly *assembly;  // NULL: beams start in equilibrium
    struct ct_advance *advance;
    struct ct_linear *linear; // for ct_data_assemble
    size_t nq, nu, nrow,
        ny; // nu: speeds without the model's states, which stand behind them in y
    double t, *y;
    bool *is_own;    // by parameter: it has been set, whatever its definition says
    bool is_moved;   // the state is not where steps have come to
    bool is_changed; // values of parameters are others than in the last step
    bool is_start;   // it is as it was assembled at t = 0
    unsigned known;  // of what follows from the state
    double *M, *J;   // row by row
    double *value;   // outputs (nresult)
    double energy[5];
    struct ct_program strain, frames; // compiled when first asked for
    bool has_strain, has_frames;
};

/// Make the machine's input that of the state, memories and sides of switches included. False with a diagnostic.
bool ct_data_enter(struct ct_data *d);
/// u' at the state, in the coordinate partitioning and the machine's input. False with a diagnostic.
bool ct_data_accelerate(struct ct_data *d);
/// phi and v at the state.
void ct_data_constrain(struct ct_data *d);
bool ct_data_find_outputs(struct ct_data *d);

/// ct_system_item without the values of coordinates, speeds and outputs, which need a start.
bool ct_item_describe(const struct ct_system *sys, enum ct_kind kind, size_t i,
                      struct ct_item *item);
/// Has the value of parameter i of the model decided about the equations?
bool ct_item_has_decided(const struct ct_system *sys, size_t i);
/// Parameters of the model that are inputs, or those that are not, in order: number i of them; nparameter: there is none.
size_t ct_item_parameter(const struct ct_model *m, enum ct_kind kind, size_t i);

#endif
