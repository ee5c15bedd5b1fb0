// Copies of a model with additional parameters: inputs that are added to efforts and loads, and
// factors that multiply a load.
//
// What always holds: the original model does not change. A variant shares its store of
// expressions, and its equations have the same unknowns on the same trees.
#ifndef CT_ANALYSIS_MODEL_VARIANT_H
#define CT_ANALYSIS_MODEL_VARIANT_H

#include "system.h"

/// Creates a copy of m with room for `most` more parameters. Lives in own->model.
struct ct_model *ct_variant_create(struct ct_ctx *own, const struct ct_model *m, size_t most);

/// Returns the parameter that stands for an input. "J.effort", "J.effort2", "F.force.x" and
/// "T.torque.z" are added to the value in the model; other names are parameters of the model.
/// Errors: CT_E_INPUT.
bool ct_variant_input(struct ct_ctx *own, struct ct_model *v, const char *name,
                      size_t *parameter);
/// Lists the standard inputs of the model: the efforts that it gives, and the components of its
/// forces and torques.
size_t ct_variant_standard_inputs(struct ct_ctx *own, const struct ct_model *m,
                                  const char ***name);

/// Returns the parameter, with value 1, that multiplies a load: a force or torque, the effort
/// of a joint, or "gravity". Errors: CT_E_LOAD.
bool ct_variant_load(struct ct_ctx *own, struct ct_model *v, const char *name,
                     size_t *parameter);

#endif
