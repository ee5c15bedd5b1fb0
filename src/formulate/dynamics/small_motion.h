// Equations of motion to first order in chosen coordinates.  (format, section 7: `small`)
#ifndef CT_FORMULATE_DYNAMICS_SMALL_MOTION_H
#define CT_FORMULATE_DYNAMICS_SMALL_MOTION_H

#include "formulate/build.h"

/// Does the model list small coordinates?
bool ct_small_motion_is_wanted(const struct ct_build *b);
/// M and Q to first order in the coordinates of all joints and beams that are small, and in their
/// rates, about zero; constraint rows stay exact. In M the entries between two small coordinates
/// are constant: their accelerations are small, too. Those between a small and another coordinate
/// keep the first order in both rows, so that M stays symmetric; in the row of the other coordinate
/// this includes a second-order term. After M and Q, before the solution. Errors: E204 for a
/// coordinate that is not on a branch.
bool ct_small_motion_derive(struct ct_build *b);
/// Truncates the momenta p (nu) to first order in the same coordinates and rates. A jump of driven
/// rates uses these momenta, consistent with the truncated forces. After ct_small_motion_derive().
void ct_small_motion_momenta(struct ct_build *b, ct_ex *p);

#endif
