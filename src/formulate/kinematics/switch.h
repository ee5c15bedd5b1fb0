// Switches: the result of a comparison stays constant between events. `t < 1`, `abs(u)` and `min(a,
// b)` become symbols of value 0 or 1, each with a function whose sign changes at its event.
#ifndef CT_FORMULATE_KINEMATICS_SWITCH_H
#define CT_FORMULATE_KINEMATICS_SWITCH_H

#include "formulate/build.h"

/// Replaces in e each comparison, abs, sign, min and max of variable arguments by a form that is
/// smooth between events. Adds the switches to b->eqs->switches. Adds functions of time alone to
/// b->eqs->time_function, except in outputs.
ct_ex ct_switch_hold(struct ct_build *b, ct_ex e);

#endif
