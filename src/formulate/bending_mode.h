// Bending modes of a linear beam, as numbers: for the estimate of its error
// (beam_error/beam_error_modal.h).
#ifndef CT_FORMULATE_BENDING_MODE_H
#define CT_FORMULATE_BENDING_MODE_H

#include <stdbool.h>

/// Modes of a plane. Default: more see finer motion, and cost. Test: beam_error_modal.
enum { CT_PLANE_SHAPES = 3 };
enum { CT_BENDING_SHAPES = 2 * CT_PLANE_SHAPES }; // Definition: those of both planes
/// Places where deflections are looked at, quarters of the beam, the end last. Derived: the highest
/// of three modes has three half waves.
enum { CT_BEAM_MODE_STATIONS = 4 };

/// A bending shape phi of unit mass.
struct ct_beam_mode {
    bool is_z;                    // it moves along z
    double omega2, damping;       // [1/s^2], [1/s]
    double turning, axial;        // eta per w^2, and per acceleration along x  [s^2], [s^2/m]
    double mass[2];               // int phi m dx, int phi m x dx
    double shortening, curvature; // b, g
    double deflection[CT_BEAM_MODE_STATIONS]; // phi there
    double coupling[CT_BENDING_SHAPES];       // C with the shapes of the other plane, by number
};

#endif
