// Force and moment that a section of a beam transmits: what the part beyond the section exerts on
// the part before it, axes of the section.  (format, section 6)
//
// They follow from the cutset through the section: what the inertia and weight of the part beyond
// need, and what the arms beyond transmit. So they agree with the reactions of joints, whatever
// is held rigid. What acts at the section's own place belongs to the part beyond; at x = 0 to the
// part before, with the frame.
#ifndef CT_FORMULATE_OUTPUTS_BEAM_LOAD_H
#define CT_FORMULATE_OUTPUTS_BEAM_LOAD_H

#include "formulate/beam/flexible_body.h"

/// The force [N], or else the moment [N m], at a frame of a beam.
ct_ex3 ct_beam_load(struct ct_build *b, int frame, bool is_force);
/// Is component i, in axes of the section, of its force (moment) known?  See ct_reaction_is_known.
bool ct_beam_load_is_known(const struct ct_build *b, int frame, bool is_force, int i);

#endif
