// Deformation signals of beams at their points and at their own frame (x = 0).
// (format, section 6)
//
//   deflection         of the point from its undeformed position, axes of the beam              [m]
//   slope              rotation of its section: its axes are those of the beam rotated by
//                      Rz(slope.z/2) Ry(slope.y) Rz(slope.z/2) Rx(slope.x); small ones
//                      are twist, -dw/dx, dv/dx                                            [rad]
//   chord_deflection   deflection in axes whose x runs from the start
//                      to the end of the beam                                              [m]
//   strain             of the axis
//
// Force and moment of a section: outputs/beam_load.h.
#ifndef CT_FORMULATE_SIGNALS_BEAM_SIGNAL_H
#define CT_FORMULATE_SIGNALS_BEAM_SIGNAL_H

#include "formulate/beam/flexible_body.h"

/// Is this a signal that only frames of beams have? All but strain are vectors.
bool ct_beam_signal_exists(const char *property);
/// The beam of a frame, and the undeformed position of the frame on it, axes of the beam.
const struct ct_flexible *ct_beam_signal_beam(const struct ct_build *b, int frame);
ct_ex3 ct_beam_signal_place(const struct ct_build *b, int frame);
/// deflection, slope or chord_deflection of a frame of a beam.
ct_ex3 ct_beam_signal_vector(struct ct_build *b, int frame, const char *property);
/// Strain of the axis at a frame of a beam.
ct_ex ct_beam_signal_strain(struct ct_build *b, int frame);

#endif
