// Bodies attached to a beam beyond its base.
#ifndef CT_FORMULATE_BEAM_ATTACHED_BODIES_H
#define CT_FORMULATE_BEAM_ATTACHED_BODIES_H

#include "formulate/beam/flexible_body.h"

/// By body, in scratch: position along the beam at which welds attach it, directly or through other
/// bodies, beyond the base; NAN: not attached.
double *ct_attached_bodies_find(const struct ct_build *b, const struct ct_flexible *f);
/// Does anything other than such bodies load or join the beam or these bodies beyond its base?
bool ct_attached_bodies_are_loaded(const struct ct_build *b, const struct ct_flexible *f);

#endif
