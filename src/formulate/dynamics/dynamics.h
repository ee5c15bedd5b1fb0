// Dynamics by cutset equations. This folder derives the mass matrix, the generalised forces, the
// applied loads, the energies and the reactions of joints.  (formulation 5)
//
// Masses are lumped on links: an augmented body is an anchor together with the
// cluster in which the vectors to its masses and next anchors are fixed. It has a first moment and
// adds to the cluster's augmented inertia; both are constant unless a translation changes the
// vectors.
#ifndef CT_FORMULATE_DYNAMICS_DYNAMICS_H
#define CT_FORMULATE_DYNAMICS_DYNAMICS_H

#include "formulate/kinematics/kinematics.h"
#include "formulate/mass_sums.h"

/// Results of the reverse sweep: forces accumulated from the leaves to ground (cutset sums).
struct ct_sweep {
    ct_ex3 *force;    // by anchor: force that its link transmits [N]
    ct_ex3 *rest;     // its part beyond outboard mass * apparent acceleration
    ct_ex3 *apparent; // by anchor: acceleration minus gravity [m/s^2]
    ct_ex3 *torque;   // by cluster: torque on it and its outboard clusters [N m]
    // local: by cluster, a part of torque that is not in `torque`, in axes of the cluster; zero
    // except for innermost clusters
    ct_ex3 *local;
    ct_ex *row; // by speed: contribution of the deformation of beams
};

/// Derives anchor masses, augmented bodies and augmented inertias, if not done yet.
void ct_augmented_bodies_lump(struct ct_build *b);
/// Augmented inertia of a cluster in ground components; planar: about the normal, in the last
/// entry.
ct_ex33 ct_cluster_inertia(struct ct_build *b, int c);
/// M, lower triangle.  (5.2)
void ct_mass_matrix_derive(struct ct_build *b);
/// Forward sweep of accelerations and reverse sweep of forces.  (5.3)  CT_BIAS: u' = 0 and no
/// multipliers; CT_FULL: with the symbols u' and lam, so that the rows are zero for a solution.
const struct ct_sweep *ct_sweep_run(struct ct_build *b, enum ct_level level);
/// Q from the bias sweep and the joint efforts.
void ct_forces_derive(struct ct_build *b);
/// Derives M and Q, if not done yet. After ct_loads_derive.
void ct_dynamics_derive(struct ct_build *b);
/// Row of the full sweep: the generalised force that the effort along a speed must supply, M u' -
/// J' lam - (Q - effort). After ct_loads_derive.
ct_ex ct_sweep_row(struct ct_build *b, int speed);
/// The same minus that effort: M u' - Q - J' lam.
ct_ex ct_sweep_residual(struct ct_build *b, int speed);

// ---- loads --------------------------------------------------------------------------------------

/// Add a load; the struct is copied.
void ct_load_add(struct ct_build *b, const struct ct_load *load);
/// The key `value` of a force or torque, transformed from the frame under `in` to ground
/// components.
ct_ex3 ct_load_vector(struct ct_build *b, const struct ct_instance *self);
/// Is `name` "PROPERTY.x", .y or .z? Then *out is that component of v.
bool ct_vector_signal(const char *name, const char *property, ct_ex3 v, ct_ex *out);
/// Effort of the driver of a coordinate: its row of the full sweep minus the contributions of the
/// spring, damper, applied effort and gears.
ct_ex ct_driver_effort(struct ct_build *b, int coordinate);
/// Derives the efforts, springs and dampers of joints, and the forces.
bool ct_loads_derive(struct ct_build *b);
/// Warns of transverse forces on a beam whose `deformation` excludes the bending that they cause.
/// After ct_loads_derive.
void ct_warn_of_excluded_loads(struct ct_ctx *ctx, struct ct_build *b);

#endif
