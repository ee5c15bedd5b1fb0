// Switches: the outcome of a comparison is held between events. `t < 1`, `abs(u)` and `min(a, b)`
// become symbols of value 0 or 1, each with a function whose sign changes at its event.
#ifndef CT_FORMULATE_KINEMATICS_SWITCH_H
#define CT_FORMULATE_KINEMATICS_SWITCH_H

#include "formulate/build.h"

/// e with every comparison, abs, sign, min and max whose arguments change in time replaced by a
/// form that is smooth between events. The switches are added to b->eqs->switches. Functions of
/// time alone are added to b->eqs->time_function, unless the expression is one of outputs.
ct_ex ct_switch_hold(struct ct_build *b, ct_ex e);

#endif
