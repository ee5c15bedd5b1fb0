// Estimated error of a linear beam from its modes. The first bending shapes are integrated as
// oscillators, with and without the terms that the linear model neglects.
//
// The deflection is x(t) phi for each of the first shapes in each plane of bending; phi has unit
// modal mass. The base moves with angular velocity w and velocity v in axes of the beam. Then
//
//     x'' + c x' + W x = F,    c = alpha + beta omega^2    (Rayleigh damping)
//     W = omega^2 - (w.w - w_n^2)     linear model; n: the normal of the plane of bending
//     F = - int phi (a + al x + w x (w x .)) m dx    inertia and weight, the same for all models
//
// The axial force adds omega^2 eta to W, with eta of validity.h. A large deflection has two more
// effects. Masses move along the beam, S = x^2/2 int phi'^2, which slows it down. Its curvature
// v''^2 (1 + v'^2) of an inextensible axis makes it stiffer:
//
//     (1 + b x^2) x'' + c x' + W x + b x x'^2 + 2 g x^3 = F
//     b = int (int_0^x phi'^2)^2 m dx,    g = int EI phi''^2 phi'^2
//
// A foreshortened beam in one frame has b but not g. The error of the linear beam is its difference
// to the model with both, relative to the largest deflection of the latter.
//
// Between two instants W and F are constant, at their means. F is computed from differences of
// velocities, so that even the shortest impulse on the base is included. The oscillators are then
// solved exactly, with nonlinear terms at the middle of each sixteenth of a period; small
// differences between models thus keep their digits.
//
// A base that rotates about the axis of the beam, or about an axis between its planes, couples the
// deflections of both planes by Coriolis, Euler and centrifugal acceleration, with C = int phi_y
// phi_z m dx for each pair of shapes:
//
//     F_y += C (2 w_x z' + (w_x' - w_y w_z) z),    F_z -= C (2 w_x y' + (w_x' + w_y w_z) y)
//
// Neglected: higher shapes, coupling between shapes of one plane, and coupling of planes at large
// deflections. For a base that is not driven see beam_error_coupled.h.
#ifndef CT_BEAM_ERROR_BEAM_ERROR_MODAL_H
#define CT_BEAM_ERROR_BEAM_ERROR_MODAL_H

#include "formulate/bending_mode.h"

/// Estimated errors above this are not printed: the linear model is useless. Definition: error
/// equal to the deflection
#define CT_ESTIMATED_ERROR_LIMIT 1.0

enum ct_beam_model {
    CT_BEAM_MODEL_LINEAR,
    CT_BEAM_MODEL_FORESHORTENED,
    CT_BEAM_MODEL_EXACT,
    CT_BEAM_MODELS
};

struct ct_beam_error_modal {
    int n;
    struct ct_beam_mode shape[CT_BENDING_SHAPES];
    double x[CT_BEAM_MODELS][CT_BENDING_SHAPES][2]; // x, x'
    bool has_begun;
    double t;
    double base[9]; // angular velocity, velocity, weight per mass; axes of the beam
    double error[CT_BEAM_MODELS], deflection; // largest so far
    // at the end of the beam: largest actual deflection; largest difference to that of the shapes
    double end_deflection, unexplained;
};

/// w_x, w_x' and w_y w_z, which couple the planes.
struct ct_beam_mode_base_rotation {
    double rate, change, across;
};

/// The part of F that does not jump with velocities: F without the momentum of the base.
double ct_beam_mode_steady_force(const struct ct_beam_mode *s, const double base[9]);
/// Momentum of the base in the direction of a shape; V: angular velocity, velocity.
double ct_beam_mode_base_momentum(const struct ct_beam_mode *s, const double V[6]);
/// Centrifugal softening: w^2 about axes normal to the displacement.
double ct_beam_mode_softening(bool is_z, const double base[9]);
/// Geometric stiffening omega^2 eta, without the part of v_x'.
double ct_beam_mode_stiffening(const struct ct_beam_mode *s, const double base[9]);
/// Force on shape i by the shapes of the other plane, at `other_plane`.
double ct_beam_mode_coupling(const struct ct_beam_error_modal *s, int i,
                             const struct ct_beam_mode_base_rotation *w,
                             const double other_plane[][2]);
/// Record the largest errors and deflections.
void ct_beam_error_modal_record(struct ct_beam_error_modal *s);

/// Advance to the time t, at which the base has this motion. A step of length zero is a jump of its
/// velocities.
void ct_beam_error_modal_advance(struct ct_beam_error_modal *s, double t, const double base[9]);
/// Set the motion of the base without an impulse on the beam.
void ct_beam_error_modal_reset_base(struct ct_beam_error_modal *s, const double base[9]);
/// Set every x to the static deflection under the initial F, at rest.
void ct_beam_error_modal_start_static(struct ct_beam_error_modal *s);
/// Compare with the actual deflection of the beam's end along y and z.
void ct_beam_error_modal_compare(struct ct_beam_error_modal *s, const double end[2]);
/// Largest error of a model relative to the largest deflection. NAN if there is no deflection, or
/// if the linear beam moves differently from these shapes by more than its estimated error.
double ct_beam_error_modal_error(const struct ct_beam_error_modal *s, enum ct_beam_model model);

#endif
