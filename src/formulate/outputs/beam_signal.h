// Signals of beams at their points and at their own frame (x = 0).  (format, section 6)
//
//   deflection         of the point from its undeformed place, axes of the beam              [m]
//   slope              rotation of its section: the axes of the section are those of the beam turned by
//                      Rz(slope.z/2) Ry(slope.y) Rz(slope.z/2) Rx(slope.x); small ones are twist, -dw/dx,
//                      dv/dx                                                                  [rad]
//   chord_deflection   of the point from its undeformed place, seen from axes whose x runs from the start to
//                      the end of the beam                                                    [m]
//   strain             of the axis
//   force, moment      what the part beyond the section exerts on the part before it, axes of the section
//
// Force and moment follow from the cutset through the section: what the inertia and weight of the part beyond need,
// and what the arms beyond transmit. So they agree with the reactions of joints, whatever is held rigid. What acts
// at the section's own place belongs to the part beyond; at x = 0 to the part before, with the frame.
#ifndef CT_FORMULATE_OUTPUTS_BEAM_SIGNAL_H
#define CT_FORMULATE_OUTPUTS_BEAM_SIGNAL_H

#include "formulate/beam/flexible_body.h"

/// Is this a signal that frames of beams have besides those of all frames? All but strain are vectors.
bool ct_beam_signal_exists(const char *property);
/// deflection, slope, chord_deflection, force or moment of a frame of a beam.
ct_ex3 ct_beam_signal_vector(struct ct_build *b, int frame, const char *property);
/// Strain of the axis at a frame of a beam.
ct_ex ct_beam_signal_strain(struct ct_build *b, int frame);
/// Is component i, in axes of the section, of its force (moment) known?  See ct_reaction_is_known.
bool ct_beam_signal_is_known(const struct ct_build *b, int frame, bool is_force, int i);

#endif
