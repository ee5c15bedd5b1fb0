// Force and moment that a section of a beam transmits: what the part beyond the section exerts on
// the part before it, axes of the section.  (format, section 6)
//
// They follow from the cutset equation at the section: inertia and weight of the part beyond, and
// the loads that the arms beyond transmit. They therefore agree with the reactions of joints, also
// if deformations are excluded. A load at the section itself acts on the part beyond; at x = 0 it
// acts on the part before.
#ifndef CT_FORMULATE_OUTPUTS_BEAM_LOAD_H
#define CT_FORMULATE_OUTPUTS_BEAM_LOAD_H

#include "formulate/beam/flexible_body.h"

/// The force [N], or else the moment [N m], at a frame of a beam.
ct_ex3 ct_beam_load(struct ct_build *b, int frame, bool is_force);
/// Is component i, in axes of the section, of its force (moment) determined?  See
/// ct_reaction_is_known.
bool ct_beam_load_is_known(const struct ct_build *b, int frame, bool is_force, int i);

#endif
