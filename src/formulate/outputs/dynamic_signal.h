// Signals that need the dynamics (reactions, energies), and expressions of outputs, which may use
// all signals.
#ifndef CT_FORMULATE_OUTPUTS_DYNAMIC_SIGNAL_H
#define CT_FORMULATE_OUTPUTS_DYNAMIC_SIGNAL_H

#include "formulate/signals/signal.h"

/// Any scalar signal. Sets b->signals.is_open if it is a reaction that a planar model does not
/// determine. False with a diagnostic at mark if it does not exist.
bool ct_output_signal(struct ct_build *b, const char *name, struct ct_mark mark, ct_ex *out);
/// An expression of the model with all its signals replaced.
ct_ex ct_output_value(struct ct_build *b, ct_ex e);

#endif
