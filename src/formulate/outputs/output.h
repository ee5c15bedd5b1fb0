// Outputs. This folder derives the expressions of the output columns: signals that need the
// dynamics, loads in beams, and their names.
#ifndef CT_FORMULATE_OUTPUTS_OUTPUT_H
#define CT_FORMULATE_OUTPUTS_OUTPUT_H

#include "formulate/build.h"

/// Derives the columns of all outputs of the model into b->eqs->result.
bool ct_outputs_derive(struct ct_build *b);
/// Adds further columns, except existing ones.
bool ct_outputs_add(struct ct_build *b, enum ct_more_outputs more);
/// The wrenches of all joints as columns of a separate list, in the arena of b.
bool ct_outputs_list_reactions(struct ct_build *b, struct ct_result **list, size_t *n);

#endif
