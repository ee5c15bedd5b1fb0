// Estimated error of a linear beam, by modes: its first bending shapes as oscillators, with and
// without what it leaves out.
//
// With x(t) phi for each of the first shapes in each plane of bending, phi of unit mass, on a base
// that moves with w and v in axes of the beam,
//
//     x'' + c x' + W x = F,    c = alpha + beta omega^2    (Rayleigh damping)
//     W = omega^2 - (w.w - w_n^2)                    linear; n: across x and the plane's direction
//     F = - int phi (a + al x + w x (w x .)) m dx    the same for all: inertia and weight
//
// The axial force adds omega^2 eta to W, eta of validity.h. A beam that swings far is moreover
// slowed down by masses that move along it, S = x^2/2 int phi'^2, and stiffened by its curvature,
// which is v''^2 (1 + v'^2) if the axis does not stretch:
//
//     (1 + b x^2) x'' + c x' + W x + b x x'^2 + 2 g x^3 = F,    b = int (int_0^x phi'^2)^2 m dx,    g = int EI phi''^2 phi'^2
//
// One foreshortened beam in one frame has b but not g. The error of the linear beam is the
// difference to that with both, relative to the largest deflection of that. Between two instants W
// and F are constant, their means; F comes from velocities, so that no push on the base is missed,
// however short; oscillators are then solved exactly, with amplitudes as they are in the middle of
// a sixteenth of a period, so that differences keep their digits however small they are. A base
// that turns about the beam's axis or about one between its planes moves the deflections of one
// plane into the other, as Coriolis', Euler's and the centrifugal acceleration say, with C = int
// phi_y phi_z m dx for each pair of shapes:
//
//     F_y += C (2 w_x z' + (w_x' - w_y w_z) z),    F_z -= C (2 w_x y' + (w_x' + w_y w_z) y)
//
// Left out: higher shapes, what shapes of a plane do to one another, and planes where they swing
// far. A base that is not driven swings along: beam_error_coupled.h.
#ifndef CT_BEAM_ERROR_BEAM_ERROR_MODAL_H
#define CT_BEAM_ERROR_BEAM_ERROR_MODAL_H

#include "formulate/bending_mode.h"

/// Beyond it the linear beam is wrong altogether, and no figure is given.
/// Definition: the whole deflection
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
    double end_deflection,
        unexplained; // of the end, by the linear beam itself; by more or less than the shapes say
};

/// w_x, w_x' and w_y w_z, by which planes meet.
struct ct_beam_mode_base_rotation {
    double rate, change, across;
};

/// What drives x, in terms that do not jump with velocities: F less the push of the base's
/// momentum.
double ct_beam_mode_steady_force(const struct ct_beam_mode *s, const double base[9]);
/// The momentum that the base gives the shape; V: angular velocity, velocity.
double ct_beam_mode_base_momentum(const struct ct_beam_mode *s, const double V[6]);
/// w^2 about axes across the displacement.
double ct_beam_mode_softening(bool is_z, const double base[9]);
/// omega^2 eta, without the part of v_x'.
double ct_beam_mode_stiffening(const struct ct_beam_mode *s, const double base[9]);
/// What the other plane, at `beside`, does to shape i.
double ct_beam_mode_coupling(const struct ct_beam_error_modal *s, int i,
                             const struct ct_beam_mode_base_rotation *w,
                             const double beside[][2]);
/// Keep what is largest, of errors and deflections.
void ct_beam_error_modal_record(struct ct_beam_error_modal *s);

/// Move on to the time t, where the base moves like that. A step of no time is a jump of its
/// velocities.
void ct_beam_error_modal_advance(struct ct_beam_error_modal *s, double t, const double base[9]);
/// The base moves like that from now on, without a push on the beam.
void ct_beam_error_modal_reset_base(struct ct_beam_error_modal *s, const double base[9]);
/// Set every x to rest in the static deflection under F as it is at the first instant.
void ct_beam_error_modal_start_static(struct ct_beam_error_modal *s);
/// The end of the linear beam itself is here now, along y and z.
void ct_beam_error_modal_compare(struct ct_beam_error_modal *s, const double end[2]);
/// Largest error of a model over the largest deflection; NAN if nothing deflects, or the linear
/// beam did what these shapes do not, and more of that than its error.
double ct_beam_error_modal_error(const struct ct_beam_error_modal *s, enum ct_beam_model model);

#endif
