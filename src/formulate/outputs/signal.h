// Signals: names of the format (section 6) turned into expressions.
#ifndef CT_FORMULATE_OUTPUTS_SIGNAL_H
#define CT_FORMULATE_OUTPUTS_SIGNAL_H

#include "formulate/dynamics/dynamics.h"
#include "formulate/kinematics/constraint_row.h"

/// The columns of all outputs; fills b->eqs->result.
bool ct_outputs_derive(struct ct_build *b);
/// Further columns, those left out that are there already.
bool ct_outputs_add(struct ct_build *b, enum ct_more_outputs more);
/// Components a name without one stands for (".x", ".y", ".z"); NULL-terminated, or NULL for a scalar signal.
const char *const *ct_signal_components(struct ct_build *b, const char *name);
/// One scalar signal; false with a diagnostic at mark if it does not exist.
bool ct_signal_resolve(struct ct_build *b, const char *name, struct ct_mark mark, ct_ex *out);

#endif
