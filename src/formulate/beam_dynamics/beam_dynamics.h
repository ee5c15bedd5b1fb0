// Dynamics of beams: inertia, weight, stiffness and damping as forces on the base and on the
// elastic coordinates, and their part of the mass matrix. Everything is written in the axes of
// the beam; the motion of the base is turned into them once.
//
//     beam_dynamics.c                             what the sweep and the mass matrix ask for
//     base_motion.c                               how the base moves
//     inertia_exact.c, _legendre.c, _points.c     three ways to take the integrals of inertia over an element
//     inertia_modal.c                             mass matrix where coordinates are shapes of the whole beam
#ifndef CT_FORMULATE_BEAM_DYNAMICS_BEAM_DYNAMICS_H
#define CT_FORMULATE_BEAM_DYNAMICS_BEAM_DYNAMICS_H

#include "formulate/beam/legendre.h"
#include "formulate/beam/stiffness.h"
#include "formulate/beam/static_condensation.h"
#include "formulate/kinematics/kinematics.h"

/// How the base moves, in axes of the beam.
struct ct_base {
    ct_ex3 a, w, al; // acceleration less gravity, angular velocity and acceleration
};

/// Motion relative to the base: momentum, angular momentum about it, twice the kinetic energy.
struct ct_relative {
    ct_ex3 momentum, angular_momentum;
    ct_ex twice_kinetic;
};

/// A way to take the integrals over a beam. Vectors in axes of the beam.
struct ct_inertia_method {
    /// Mass, first moment, inertia about the base into f->inertia, and what the others need.
    void (*derive)(struct ct_build *b, struct ct_flexible *f);
    /// Generalised forces of inertia and weight, added to those on the freedoms.
    void (*rows)(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                 enum ct_level level, ct_ex *by_freedom);
    /// Force and torque of the motion relative to the base: m (2 w x r' + r''), and of the
    /// sections' rotation.
    void (*wrench)(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                   enum ct_level level, ct_ex3 *force, ct_ex3 *torque);
    void (*moving)(struct ct_build *b, const struct ct_flexible *f, struct ct_relative *out);
    /// What the columns of the elements need, in b->arena; NULL: mass finds them itself.
    struct ct_element_sums *(*sums)(struct ct_build *b, const struct ct_flexible *f);
    /// Entries between elastic coordinates, added to M; columns of the base's motion.
    void (*mass)(struct ct_build *b, const struct ct_flexible *f, struct ct_columns *out,
                 ct_ex *M);
};

/// Integrals that stand as symbols in equations for a reader (report/beam_parts.h).
struct ct_named_inertia {
    struct ct_columns columns; // of the base's motion, by elastic coordinate
    ct_ex *M;                  // between elastic coordinates (nelastic x nelastic)
    ct_ex *velocity,
        *elastic; // by elastic coordinate: quadratic velocity force; stiffness and damping
    ct_ex3 force, torque; // of the motion relative to the base with u' = 0
    ct_ex
        acceleration; // of all elastic coordinates, where their columns are all the same row vector; else zero
};

struct ct_inertia {
    const struct ct_inertia_method *method;
    const struct ct_named_inertia *named; // taken instead of what the method gives; NULL: none
    ct_ex mass;
    ct_ex3 moment;
    ct_ex33 inertia;        // about the base
    struct ct_point *point; // of the form that sums over points
    size_t npoint;
    struct ct_element_mass *element;    // of the exact form
    struct ct_legendre_element *series; // of the series, by element
};

/// Integrals over an element that its columns need; in a CHAIN without what the foreshortening at
/// its start does.
struct ct_element_sums {
    ct_ex M[CT_DOF][CT_DOF];
    ct_ex3 moved[CT_DOF],
        swept[CT_DOF]; // int mu dr, int mu r x dr (and of the sections' rotation)
    ct_ex m;
    ct_ex3 moment;
    int nsquare; // M has sum c p p' besides, p by dof: c in weight, p in square, c p in heavy
    ct_ex weight[CT_LEGENDRE_AXIAL], square[CT_LEGENDRE_AXIAL][CT_DOF],
        heavy[CT_LEGENDRE_AXIAL][CT_DOF];
};
/// These into M.
void ct_element_close(struct ct_exs *x, struct ct_element_sums *s);
/// Sums over points of the elements: any kinematics.
extern const struct ct_inertia_method ct_inertia_points;
/// Amplitudes of polynomials (inertia_legendre.c), exact: foreshortening with the same mass all
/// along the beam.
extern const struct ct_inertia_method ct_inertia_legendre;
bool ct_inertia_has_legendre(struct ct_build *b, const struct ct_flexible *f);
/// Integrals over the elements, constant: linear kinematics.
extern const struct ct_inertia_method ct_inertia_exact;

/// Ground components <-> axes of the beam.
ct_ex3 ct_base_into(struct ct_build *b, const struct ct_flexible *f, ct_ex3 v);
ct_ex3 ct_base_out_of(struct ct_build *b, const struct ct_flexible *f, ct_ex3 v);
/// How the base moves whose acceleration less gravity is `apparent` (ground components).
struct ct_base ct_base_motion(struct ct_build *b, const struct ct_flexible *f,
                              enum ct_level level, ct_ex3 apparent);
/// The same with its own acceleration.
struct ct_base ct_flexible_base(struct ct_build *b, const struct ct_flexible *f,
                                enum ct_level level);
/// With quadratic_velocity: false: m as if the base did not turn, and of inertia that is lumped
/// to the base the centrifugal force and gyroscopic torque, which are to be taken off (both zero
/// else).
struct ct_base ct_flexible_felt(struct ct_build *b, const struct ct_flexible *f,
                                const struct ct_base *m, ct_ex3 *force, ct_ex3 *torque);
/// Angular velocity, velocity and weight per mass of the base, in axes of the beam.
void ct_flexible_base_motion(struct ct_build *b, const struct ct_flexible *f, ct_ex3 out[3]);
/// al~ + w~ w~
ct_ex33 ct_base_turning(struct ct_build *b, const struct ct_base *m);
/// Entries between elastic coordinates, added to M; columns of the base's motion.
void ct_flexible_columns(struct ct_build *b, const struct ct_flexible *f,
                         struct ct_columns *out, ct_ex *M);
/// The same of forms with sums, where coordinates are shapes of the whole beam.
void ct_flexible_modal_mass(struct ct_build *b, const struct ct_flexible *f,
                            struct ct_columns *out, ct_ex *M);
/// 2 w x v
ct_ex3 ct_twice_cross(struct ct_build *b, ct_ex3 w, ct_ex3 v);

/// Inertia, weight, stiffness and damping of the beam, added to the rows (by speed) of its
/// elastic coordinates.
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

// ---- for the equations of the whole system
// -------------------------------------------------------

/// f->inertia, once: mass, first moment, inertia about the base. After the unknowns of beams.
void ct_flexible_inertia_derive(struct ct_build *b, struct ct_flexible *f);
/// Mass, first moment and inertia of the beams, added to anchors and clusters; before augmented
/// bodies are linked.
void ct_flexible_lump(struct ct_build *b);
/// Rows and columns of the elastic coordinates, added to the lower triangle M (nu x nu).
void ct_flexible_mass(struct ct_build *b, ct_ex *M);
/// What the beams' deformation adds to the sweep: force at the base's anchor, torque on its
/// cluster, rows of the elastic coordinates. apparent: by anchor, acceleration less gravity.
void ct_flexible_sweep(struct ct_build *b, enum ct_level level, const ct_ex3 *apparent,
                       ct_ex3 *rest, ct_ex3 *torque, ct_ex *row);
/// Mass, com (less the base's place), momentum, angular momentum about the base's origin, kinetic
/// energy; ground axes.
struct ct_flexible_state {
    ct_ex mass;
    ct_ex3 moment; // mass (com - base)
    ct_ex3 momentum, angular_momentum;
    ct_ex twice_kinetic;
};
struct ct_flexible_state ct_flexible_moving(struct ct_build *b, const struct ct_flexible *f);
/// Force and torque about the base that the beam's inertia and weight need, with the symbols u';
/// ground axes.
void ct_flexible_wrench(struct ct_build *b, const struct ct_flexible *f, ct_ex3 *force,
                        ct_ex3 *torque);

#endif
