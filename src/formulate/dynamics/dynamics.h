// Dynamics by cutset equations: mass matrix, forces, loads, reactions.  (formulation 5)
//
// Masses are lumped on the links that carry them: an augmented body is an anchor together with the
// cluster in which the vectors to its masses and next anchors are fixed. It has a first moment and
// adds to the cluster's augmented inertia; both are constant unless something slides.
#ifndef CT_FORMULATE_DYNAMICS_DYNAMICS_H
#define CT_FORMULATE_DYNAMICS_DYNAMICS_H

#include "formulate/kinematics/kinematics.h"
#include "formulate/mass_sums.h"

/// Forces along the tree, accumulated from the leaves: cutset sums.
struct ct_sweep {
    ct_ex3 *force;    // by anchor: what the link must carry, [N]
    ct_ex3 *rest;     // of that, what all outboard needs beyond mass * apparent
    ct_ex3 *apparent; // by anchor: acceleration less gravity [m/s^2]
    ct_ex3 *torque;   // by cluster: about its spins, clusters outboard included [N m]
    ct_ex3 *
        local; // by cluster: what is missing there, in axes of the cluster; zero but for the innermost
    ct_ex *row; // by speed: what the deformation of beams adds
};

/// Anchor masses, augmented bodies, augmented inertias; once.
void ct_augmented_bodies_lump(struct ct_build *b);
/// Augmented inertia of a cluster in ground components; planar: about the normal, in the last
/// entry.
ct_ex33 ct_cluster_inertia(struct ct_build *b, int c);
/// M, lower triangle.  (5.2)
void ct_mass_matrix_derive(struct ct_build *b);
/// Forward accelerations and reverse cutset sweep.  (5.3)  CT_BIAS: u' = 0 and no multipliers;
/// CT_FULL: with the symbols u' and lam, so that the rows vanish along a motion.
const struct ct_sweep *ct_sweep_run(struct ct_build *b, enum ct_level level);
/// Q from the bias sweep and the efforts of the joints.
void ct_forces_derive(struct ct_build *b);
/// M and Q, once. After ct_loads_derive.
void ct_dynamics_derive(struct ct_build *b);
/// Row of the full sweep, what the effort along a speed must supply: M u' - J' lam - (Q - effort). After
/// ct_loads_derive.
ct_ex ct_sweep_row(struct ct_build *b, int speed);
/// The same less that effort: M u' - Q - J' lam.
ct_ex ct_sweep_residual(struct ct_build *b, int speed);

// ---- loads --------------------------------------------------------------------------------------

/// Add a load; the struct is copied.
void ct_load_add(struct ct_build *b, const struct ct_load *load);
/// The key `value` of a force or torque in ground components, turned out of the frame under `in`.
ct_ex3 ct_load_vector(struct ct_build *b, const struct ct_instance *self);
/// Is `name` "PROPERTY.x", .y or .z? Then *out is that component of v.
bool ct_vector_signal(const char *name, const char *property, ct_ex3 v, ct_ex *out);
/// Effort of a driven coordinate's driver: its row of the full sweep less what the joint's spring,
/// damper and applied effort and gears give along it.
ct_ex ct_driver_effort(struct ct_build *b, int coordinate);
/// Efforts, springs and dampers of joints; forces.
bool ct_loads_derive(struct ct_build *b);
/// Warns of forces across a beam whose `deformation` leaves out the bending that they ask for.
/// After ct_loads_derive.
void ct_warn_of_excluded_loads(struct ct_ctx *ctx, struct ct_build *b);

#endif
