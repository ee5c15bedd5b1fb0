// What hangs on a beam beyond its base.
#ifndef CT_FORMULATE_RIDERS_H
#define CT_FORMULATE_RIDERS_H

#include "formulate/flexible.h"

/// By body, in scratch: where along the beam it is held by welds, beyond the base, directly or by other bodies; NAN: it
/// is not.
double *ct_riders_find(const struct ct_build *b, const struct ct_flexible *f);
/// Does anything but such bodies hang on the beam beyond its base, or push it or them there?
bool ct_riders_are_loaded(const struct ct_build *b, const struct ct_flexible *f);

#endif
