// Bodies attached to a beam beyond its base.
#ifndef CT_FORMULATE_BEAM_ATTACHED_BODIES_H
#define CT_FORMULATE_BEAM_ATTACHED_BODIES_H

#include "formulate/beam/flexible_body.h"

/// By body, in scratch: where along the beam it is held by welds, beyond the base, directly or by
/// other bodies; NAN: it is not.
double *ct_attached_bodies_find(const struct ct_build *b, const struct ct_flexible *f);
/// Does anything but such bodies hang on the beam beyond its base, or push it or them there?
bool ct_attached_bodies_are_loaded(const struct ct_build *b, const struct ct_flexible *f);

#endif
