// Dynamics of beams. This folder derives the inertia, weight, stiffness and damping forces on the
// base and on the elastic coordinates of a beam, and its part of the mass matrix. All vectors are
// in axes of the beam; the motion of the base is transformed once.
//
//     beam_dynamics.c                             contributions to the sweep and the mass matrix
//     base_motion.c                               motion of the base
//     inertia_exact.c, _legendre.c, _points.c  three methods for integrals of inertia over an
//     element
//     inertia_modal.c                             mass matrix for shapes of the whole beam
#ifndef CT_FORMULATE_BEAM_DYNAMICS_BEAM_DYNAMICS_H
#define CT_FORMULATE_BEAM_DYNAMICS_BEAM_DYNAMICS_H

#include "formulate/beam/legendre.h"
#include "formulate/beam/stiffness.h"
#include "formulate/beam/static_condensation.h"
#include "formulate/kinematics/kinematics.h"

/// Motion of the base, in axes of the beam.
struct ct_base {
    ct_ex3 a, w, al; // acceleration minus gravity, angular velocity and acceleration
};

/// Motion relative to the base: momentum, angular momentum about it, twice the kinetic energy.
struct ct_relative {
    ct_ex3 momentum, angular_momentum;
    ct_ex twice_kinetic;
};

/// A method for the integrals of inertia over a beam. Vectors are in axes of the beam.
struct ct_inertia_method {
    /// Sets mass, first moment and inertia about the base in f->inertia, and data of the other
    /// functions.
    void (*derive)(struct ct_build *b, struct ct_flexible *f);
    /// Adds the generalised forces of inertia and weight on the nodal freedoms.
    void (*rows)(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                 enum ct_level level, ct_ex *by_freedom);
    /// Force and torque of the motion relative to the base: m (2 w x r' + r''), and of the rotation
    /// of the sections.
    void (*wrench)(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                   enum ct_level level, ct_ex3 *force, ct_ex3 *torque);
    void (*relative_momentum)(struct ct_build *b, const struct ct_flexible *f,
                              struct ct_relative *out);
    /// The sums for the columns of the elements, in b->arena; NULL: mass computes them itself.
    struct ct_element_sums *(*sums)(struct ct_build *b, const struct ct_flexible *f);
    /// Entries between elastic coordinates, added to M; columns of the base's motion.
    void (*mass)(struct ct_build *b, const struct ct_flexible *f,
                 struct ct_elastic_columns *out, struct ct_symmetric *M);
};

/// Integrals that appear as symbols in printed equations (report/beam_parts.h).
struct ct_named_inertia {
    struct ct_elastic_columns columns; // of the base's motion, by elastic coordinate
    ct_ex *M;                          // between elastic coordinates (nelastic x nelastic)
    // by elastic coordinate: quadratic velocity force; stiffness and damping
    ct_ex *velocity, *elastic;
    ct_ex3 force, torque; // of the motion relative to the base with u' = 0
    // acceleration: sum for all elastic coordinates, if their columns are one row vector; else zero
    ct_ex acceleration;
};

struct ct_inertia {
    const struct ct_inertia_method *method;
    const struct ct_named_inertia *named; // replaces the results of the method; NULL: none
    ct_ex mass;
    ct_ex3 moment;
    ct_ex33 inertia;        // about the base
    struct ct_point *point; // of inertia_points.c
    size_t npoint;
    struct ct_element_mass *element;    // of inertia_exact.c
    struct ct_legendre_element *series; // of inertia_legendre.c, by element
};

/// Integrals over an element for its columns; in a CHAIN without the effect of the foreshortening
/// at its start.
struct ct_element_sums {
    ct_ex M[CT_DOF][CT_DOF];
    // int mu dr, int mu r x dr (and of the sections' rotation)
    ct_ex3 m_rf[CT_DOF], m_thetaf[CT_DOF];
    ct_ex m;
    ct_ex3 moment;
    int nsquare; // M also contains sum c p p', p by dof: c in weight, p in square, c p in heavy
    ct_ex weight[CT_LEGENDRE_AXIAL], square[CT_LEGENDRE_AXIAL][CT_DOF],
        heavy[CT_LEGENDRE_AXIAL][CT_DOF];
};
/// Adds these terms to M.
void ct_element_close(struct ct_exs *x, struct ct_element_sums *s);
/// Sums over points of the elements: any kinematics.
extern const struct ct_inertia_method ct_inertia_points;
/// Legendre coefficients (inertia_legendre.c), exact: for foreshortening with constant mass per
/// length.
extern const struct ct_inertia_method ct_inertia_legendre;
bool ct_inertia_has_legendre(struct ct_build *b, const struct ct_flexible *f);
/// Constant element matrices: for linear kinematics.
extern const struct ct_inertia_method ct_inertia_exact;

/// Ground components <-> axes of the beam.
ct_ex3 ct_base_into(struct ct_build *b, const struct ct_flexible *f, ct_ex3 v);
ct_ex3 ct_base_out_of(struct ct_build *b, const struct ct_flexible *f, ct_ex3 v);
/// Motion of a base with acceleration minus gravity `apparent` (ground components).
struct ct_base ct_base_motion(struct ct_build *b, const struct ct_flexible *f,
                              enum ct_level level, ct_ex3 apparent);
/// The same with the acceleration of the base itself.
struct ct_base ct_flexible_base(struct ct_build *b, const struct ct_flexible *f,
                                enum ct_level level);
/// With `quadratic_velocity: false`: m without the rotation of the base; also the centrifugal force
/// and gyroscopic torque of the inertia lumped at the base, which the caller subtracts. Otherwise m
/// itself and zero.
struct ct_base ct_flexible_effective_base(struct ct_build *b, const struct ct_flexible *f,
                                          const struct ct_base *m, ct_ex3 *force,
                                          ct_ex3 *torque);
/// Angular velocity and velocity of the base, and gravity, in axes of the beam.
void ct_flexible_base_motion(struct ct_build *b, const struct ct_flexible *f, ct_ex3 out[3]);
/// al~ + w~ w~
ct_ex33 ct_base_acceleration_matrix(struct ct_build *b, const struct ct_base *m);
/// Entries between elastic coordinates, added to M; columns of the base's motion.
void ct_flexible_columns(struct ct_build *b, const struct ct_flexible *f,
                         struct ct_elastic_columns *out, struct ct_symmetric *M);
/// The same for shapes of the whole beam as coordinates, for methods with sums.
void ct_flexible_modal_mass(struct ct_build *b, const struct ct_flexible *f,
                            struct ct_elastic_columns *out, struct ct_symmetric *M);
/// 2 w x v
ct_ex3 ct_twice_cross(struct ct_build *b, ct_ex3 w, ct_ex3 v);

/// Adds inertia, weight, stiffness and damping of the beam to the rows (by speed) of its elastic
/// coordinates.
void ct_flexible_rows(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                      enum ct_level level, ct_ex *row);
/// Force and torque of the motion relative to the base, in its axes.
void ct_flexible_relative_wrench(struct ct_build *b, const struct ct_flexible *f,
                                 const struct ct_base *m, enum ct_level level, ct_ex3 *force,
                                 ct_ex3 *torque);
/// The same of inertia and weight alone; of stiffness and damping alone.
void ct_flexible_inertia_rows(struct ct_build *b, const struct ct_flexible *f,
                              const struct ct_base *m, enum ct_level level, ct_ex *row);
void ct_flexible_stiffness_rows(struct ct_build *b, const struct ct_flexible *f, ct_ex *row);

// ---- for the equations of the whole system -----------------------------------------------------

/// Derives f->inertia, if not done yet: mass, first moment, inertia about the base. After the
/// unknowns of beams.
void ct_flexible_inertia_derive(struct ct_build *b, struct ct_flexible *f);
/// Adds mass, first moment and inertia of the beams to anchors and clusters; before augmented
/// bodies are linked.
void ct_flexible_lump(struct ct_build *b);
/// Adds rows and columns of the elastic coordinates to the M (nu x nu).
void ct_flexible_mass(struct ct_build *b, struct ct_symmetric *M);
/// Adds the contribution of deformation to the sweep: force at the anchor of the base, torque on
/// its cluster, rows of the elastic coordinates. apparent: by anchor, acceleration minus gravity.
void ct_flexible_sweep(struct ct_build *b, enum ct_level level, const ct_ex3 *apparent,
                       ct_ex3 *rest, ct_ex3 *torque, ct_ex *row);
/// Mass, centre of mass relative to the base, momentum, angular momentum about the base, kinetic
/// energy; ground axes.
struct ct_flexible_state {
    ct_ex mass;
    ct_ex3 moment; // mass (com - base)
    ct_ex3 momentum, angular_momentum;
    ct_ex twice_kinetic;
};
struct ct_flexible_state ct_flexible_momentum(struct ct_build *b, const struct ct_flexible *f);
/// Force and torque about the base for the inertia and weight of the beam, with the symbols u';
/// ground axes.
void ct_flexible_wrench(struct ct_build *b, const struct ct_flexible *f, ct_ex3 *force,
                        ct_ex3 *torque);

#endif
