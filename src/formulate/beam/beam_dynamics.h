// Between the files of flexible bodies; see flexible_body.h and beam_dynamics.c.
#ifndef CT_FORMULATE_BEAM_BEAM_DYNAMICS_H
#define CT_FORMULATE_BEAM_BEAM_DYNAMICS_H

#include "formulate/beam/legendre.h"
#include "formulate/beam/flexible_body.h"

/// How the base moves, in axes of the beam.
struct ct_base {
    ct_ex3 a, w, al; // acceleration less gravity, angular velocity and acceleration
};

/// Columns of the base's motion: p . moved + s . swept for a velocity p and an angular velocity s of the base.
struct ct_columns {
    ct_ex3 *moved, *swept; // by elastic coordinate, axes of the beam
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
    /// Force and torque of the motion relative to the base: m (2 w x r' + r''), and of the sections' rotation.
    void (*wrench)(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                   enum ct_level level, ct_ex3 *force, ct_ex3 *torque);
    void (*moving)(struct ct_build *b, const struct ct_flexible *f, struct ct_relative *out);
    /// What the columns of the elements need, in b->arena; NULL: mass finds them itself.
    struct ct_element_sums *(*sums)(struct ct_build *b, const struct ct_flexible *f);
    /// Entries between elastic coordinates, added to M; columns of the base's motion.
    void (*mass)(struct ct_build *b, const struct ct_flexible *f, struct ct_columns *out,
                 ct_ex *M);
};

struct ct_inertia {
    const struct ct_inertia_method *method;
    ct_ex mass;
    ct_ex3 moment;
    ct_ex33 inertia;        // about the base
    struct ct_point *point; // of the form that sums over points
    size_t npoint;
    struct ct_element_mass *element;    // of the exact form
    struct ct_legendre_element *series; // of the series, by element
};

/// Integrals over an element that its columns need; in a CHAIN without what the foreshortening at its start does.
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
/// Amplitudes of polynomials (inertia_legendre.c), exact: foreshortening with the same mass all along the beam.
extern const struct ct_inertia_method ct_inertia_legendre;
bool ct_inertia_has_legendre(struct ct_build *b, const struct ct_flexible *f);
/// Integrals over the elements, constant: linear kinematics.
extern const struct ct_inertia_method ct_inertia_exact;

/// Rules of integration of the beam's mass and stiffness.
enum ct_rule ct_flexible_mass_rule(const struct ct_beam *beam);
enum ct_rule ct_flexible_stiffness_rule(const struct ct_beam *beam);
/// Does the rotary inertia of the sections turn with them? Where bending shortens the axis; else to first order, along the axes
/// of the beam.
bool ct_flexible_turns_inertia(const struct ct_build *b, const struct ct_flexible *f);
/// Inertia per length of the section about an axis.
struct ct_profile ct_flexible_rotary(const struct ct_flexible *f, int axis);
/// Shear stiffness k G area of Timoshenko's sections, plane 0 along y, 1 along z; 0 without shear.
ct_ex ct_flexible_shear(struct ct_build *b, const struct ct_flexible *f, int plane);
/// Integral of g p q over element e.
ct_ex ct_flexible_integral(struct ct_build *b, const struct ct_flexible *f, int e, ct_ex g,
                           const struct ct_shape *p, const struct ct_shape *q,
                           enum ct_rule rule);

/// How the base moves.
struct ct_base ct_flexible_base(struct ct_build *b, const struct ct_flexible *f,
                                enum ct_level level);
/// With quadratic_velocity: false: m as if the base did not turn, and of inertia that is lumped to the base the centrifugal force
/// and gyroscopic torque, which are to be taken off (both zero else).
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
/// Second derivatives of the foreshortening at the start of each element of a CHAIN with the symbols u', less the bias.
ct_ex *ct_chain_accelerations(struct ct_build *b, const struct ct_flexible *f);
/// 2 w x v
ct_ex3 ct_twice_cross(struct ct_build *b, ct_ex3 w, ct_ex3 v);

/// Generalised force on a dof, added to that on its freedom.
void ct_dof_push(struct ct_build *b, const struct ct_flexible *f, int e, int j, ct_ex value,
                 ct_ex *by_freedom);
/// Inertia, weight, stiffness and damping of the beam, added to the rows (by speed) of its elastic coordinates.
void ct_flexible_rows(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                      enum ct_level level, ct_ex *row);
/// Entry of the mass matrix between dof j of element e and dof k of element g; the transposed pair is pushed by itself.
void ct_dof_push_pair(struct ct_build *b, const struct ct_flexible *f, int e, int j, int g,
                      int k, ct_ex value, ct_ex *M);
void ct_dof_push_column(struct ct_build *b, const struct ct_flexible *f, int e, int j,
                        ct_ex3 moved, ct_ex3 swept, struct ct_columns *out);

/// Stiffness and mass of an element at rest by its dofs; those between stretch and bending are zero.
void ct_element_matrices(struct ct_build *b, const struct ct_flexible *f, int e,
                         ct_ex K[CT_DOF][CT_DOF], ct_ex M[CT_DOF][CT_DOF]);
/// Shapes that stand for the nodal freedoms of a beam.
struct ct_shapes {
    int n, nshape,
        nstatic; // freedoms; shapes, the static ones (of freedom[0], freedom[1] ...) first
    int *freedom;
    double *shape; // n x nshape
};
/// Does `modes: n` ask for as many as there are, or more? The nodes' own coordinates then do the same for less.
bool ct_flexible_keeps_all_modes(struct ct_build *b, struct ct_flexible *f);
/// Shapes of `modes: n` (modal_reduction.c); f->cut tells if others of the same frequency are left out.  Errors: CT_E_BEAM.
bool ct_flexible_reduce(struct ct_build *b, struct ct_flexible *f, struct ct_shapes *out);
/// Rotations of nodes without inertia and moment (massless_rotations.c). follows (6 per node, out): by freedom, fixed ones
/// included. False if there are none.
bool ct_flexible_find_massless_rotations(struct ct_build *b, const struct ct_flexible *f,
                                         bool *follows);
/// Coordinates whose shapes come nearest to freedoms' values, by the mass between: (P' M P)^-1 P' M g, with numbers of the
/// file for P and M; f->start_missed tells what they leave out. False: the shapes depend on each other, or move no mass.
bool ct_flexible_fit(struct ct_build *b, struct ct_flexible *f, const ct_ex *by_freedom,
                     ct_ex *out);
/// The joint about whose axis nothing but the section at the beam's start turns, without inertia, where the other nodes stay:
/// exactly where the axis is straight, nearly where foreshortening moves nodes of a bent one. -1: none.
int ct_flexible_bare_joint(struct ct_build *b, const struct ct_flexible *f);
/// Numbers of freedoms that follow (static_condensation.c).
struct ct_condensation_numbers {
    int nfreedom, n, nkept; // 8 per node; not fixed; of these those that do not follow, first
    const int *freedom;     // by number
    const double *K, *L;    // n x n; Cholesky factor of the block of those that follow
    bool
        is_balanced; // nothing but linear elements acts on them, now and whatever parameters are
};
/// One that follows satisfies r + sum by v = 0, v of other freedoms, whether these follow or not.
struct ct_condensation_term {
    int freedom;
    double by;
};
/// How many follow; the number of one, -1: it does not; the sum of number k.
int ct_condensation_count(const struct ct_flexible *f);
int ct_condensation_number(const struct ct_flexible *f, int freedom);
const struct ct_condensation_term *ct_condensation_law(const struct ct_flexible *f, int k,
                                                       int *n);
struct ct_condensation *ct_condensation_create(struct ct_build *b,
                                               const struct ct_condensation_numbers *c);
/// Values, rates and accelerations of the freedoms that follow.
void ct_condensation_values(struct ct_build *b, struct ct_flexible *f);
/// What they do while the freedoms, or their rates, are v (by freedom; in: zero where one follows).
void ct_condensation_extend(struct ct_exs *x, const struct ct_condensation *s, ct_ex *v);
/// Forces on them, handed to the others (force: by freedom; out: zero where one follows).
void ct_condensation_forces(struct ct_exs *x, const struct ct_condensation *s, ct_ex *force);
/// Products that this takes.
size_t ct_condensation_products(const struct ct_condensation *s);
/// Do stiffness and damping leave no force on a freedom, since it follows?
bool ct_freedom_is_balanced(const struct ct_flexible *f, int freedom);
/// Shapes of the freedoms that do not follow, each with the others of them held and those that follow in equilibrium, and
/// f->follow. False if all are coordinates, or the stiffness of those that follow is not positive.
bool ct_flexible_condense(struct ct_build *b, struct ct_flexible *f, struct ct_shapes *out);
/// What the stiffness of one element adds: rows of its dofs, strain energy, twice the power its damping takes.
struct ct_element_force {
    ct_ex row[CT_DOF];
    ct_ex energy, drag;
};
/// I - other where it is positive, else 0: of the axis about which a section is stiffer.  (5.6b)
ct_ex ct_stiffer(struct ct_exs *x, ct_ex I, ct_ex other);
/// By amplitudes (stiffness_legendre.c): foreshortened cubic elements of constant sections.
bool ct_stiffness_has_legendre(struct ct_build *b, const struct ct_flexible *f);
struct ct_element_force ct_element_force_legendre(struct ct_build *b,
                                                  const struct ct_flexible *f, int e);
/// The beam's own stiffness and damping, added to the forces on the freedoms.
void ct_stiffness_rows(struct ct_build *b, const struct ct_flexible *f, ct_ex *by_freedom);

#endif
