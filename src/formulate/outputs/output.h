// Columns of results.
#ifndef CT_FORMULATE_OUTPUTS_OUTPUT_H
#define CT_FORMULATE_OUTPUTS_OUTPUT_H

#include "formulate/build.h"

/// The columns of all outputs; fills b->eqs->result.
bool ct_outputs_derive(struct ct_build *b);
/// Further columns, those left out that are there already.
bool ct_outputs_add(struct ct_build *b, enum ct_more_outputs more);
/// The wrenches of all joints as columns of a list of their own, in the arena of b.
bool ct_outputs_list_reactions(struct ct_build *b, struct ct_result **list, size_t *n);

#endif
