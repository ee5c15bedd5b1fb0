// Numerical data of the bending modes of a linear beam. The error estimate of the beam uses them
// (beam_error/beam_error_modal.h).
#ifndef CT_FORMULATE_BENDING_MODE_H
#define CT_FORMULATE_BENDING_MODE_H

#include <stdbool.h>

/// Number of bending modes in each plane. Default: more modes resolve finer motion and cost more
/// time. Test: beam_error_modal.
enum { CT_PLANE_SHAPES = 3 };
enum { CT_BENDING_SHAPES = 2 * CT_PLANE_SHAPES }; // Definition: the modes of both planes
/// Number of stations where the deflection is evaluated: the quarter points, and the end last.
/// Derived: the highest of three modes has three half waves.
enum { CT_BEAM_MODE_STATIONS = 4 };

/// A bending mode with shape phi, normalised to unit modal mass.
struct ct_beam_mode {
    bool is_z;              // the deflection is along z; else along y
    double omega2, damping; // [1/s^2], [1/s]
    double eta_by_rate,
        eta_by_acceleration;      // eta per w^2, per acceleration along x  [s^2], [s^2/m]
    double mass[2];               // int phi m dx, int phi m x dx
    double shortening, curvature; // b, g
    double deflection[CT_BEAM_MODE_STATIONS]; // phi at the stations
    double coupling[CT_BENDING_SHAPES];       // C with the modes of the other plane
};

#endif
