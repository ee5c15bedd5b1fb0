// Switches, comparisons held between events: `t < 1`, `abs(u)`, `min(a, b)` become 0/1 symbols with a root function.
#ifndef CT_FORMULATE_KINEMATICS_SWITCH_H
#define CT_FORMULATE_KINEMATICS_SWITCH_H

#include "formulate/build.h"

/// e with every comparison, abs, sign, min and max whose arguments change in time replaced by a form
/// that is smooth between events; the events are added to b->eqs->mode, and what
/// depends on time alone, unless b->in_outputs, to b->eqs->clock.
ct_ex ct_switch_hold(struct ct_build *b, ct_ex e);

#endif
