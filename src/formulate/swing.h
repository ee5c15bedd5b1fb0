// What a linear beam will be wrong by: its first bending shapes as oscillators, with and without the axial force.
//
// With x(t) phi in each plane of bending, phi of unit mass, on a base that moves with w and v in axes of the beam,
//
//     x'' + c x' + W x = F,    c = alpha + beta omega^2    (Rayleigh damping)
//     W = omega^2 - (w.w - w_n^2)                    linear; n: across x and the plane's direction
//     W = omega^2 - (w.w - w_n^2) + omega^2 eta      with the axial force, eta of validity.h
//     F = - int phi (a + al x + w x (w x .)) m dx    the same for both: inertia and weight
//
// The error of the linear beam is the difference of the two, relative to the largest deflection with the axial force.
// Between two instants W and F are constant, their means; F comes from velocities, so that no push on the base is missed,
// however short; the oscillators are then solved exactly, so that the difference keeps its digits however small it is.
// Left out: higher shapes, and what the planes do to one another when the beam turns about its axis. A base that is not driven
// would swing along: shapes are others then.
#ifndef CT_FORMULATE_SWING_H
#define CT_FORMULATE_SWING_H

#include <stdbool.h>

/// Beyond it the linear beam is wrong altogether, and no figure is given.
#define CT_FORETOLD_MOST 1.0

/// The first bending shape phi of one plane, of unit mass.
struct ct_swing {
    double omega2, damping; // [1/s^2], [1/s]
    double turning, axial;  // eta per w^2, and per acceleration along x  [s^2], [s^2/m]
    double mass[2];         // int phi m dx, int phi m x dx
};

enum { CT_BENDING_PLANES = 2 };

struct ct_swings {
    int n;
    struct ct_swing shape[CT_BENDING_PLANES];
    bool is_z[CT_BENDING_PLANES];                                         // it moves along z
    double linear[CT_BENDING_PLANES][2], stiffened[CT_BENDING_PLANES][2]; // x, x'
    bool has_begun;
    double t;
    double base[9];           // angular velocity, velocity, weight per mass; axes of the beam
    double error, deflection; // largest so far
};

/// Move on to the time t, where the base moves like that. A step of no time is a jump of its velocities.
void ct_swings_follow(struct ct_swings *s, double t, const double base[9]);
/// The base moves like that from now on, without a push on the beam.
void ct_swings_regrip(struct ct_swings *s, const double base[9]);
/// Set every x to rest in the static deflection under F as it is at the first instant.
void ct_swings_settle(struct ct_swings *s);
/// Largest error over largest deflection; NAN if nothing deflects.
double ct_swings_error(const struct ct_swings *s);

#endif
