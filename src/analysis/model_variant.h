// Models with further parameters: inputs that add to efforts and loads, factors that scale a load.
//
// What always holds: the model it was made from stays as it is; a variant shares its store of
// expressions and formulates to the same unknowns on the same trees.
#ifndef CT_ANALYSIS_MODEL_VARIANT_H
#define CT_ANALYSIS_MODEL_VARIANT_H

#include "system.h"

/// A copy of m with room for `most` parameters more. Lives in own->model.
struct ct_model *ct_variant_create(struct ct_ctx *own, const struct ct_model *m, size_t most);

/// The parameter that stands for an input: "J.effort", "J.effort2", "F.force.x", "T.torque.z"
/// are added to what the model says there; else a parameter of the model. Errors: CT_E_INPUT.
bool ct_variant_input(struct ct_ctx *own, struct ct_model *v, const char *name,
                      size_t *parameter);
/// Names of the inputs that the model has by itself: efforts that it gives, components of
/// forces and torques.
size_t ct_variant_standard_inputs(struct ct_ctx *own, const struct ct_model *m,
                                  const char ***name);

/// The parameter, 1, that multiplies a load: a force or torque, the effort of a joint, or
/// "gravity". Errors: CT_E_LOAD.
bool ct_variant_load(struct ct_ctx *own, struct ct_model *v, const char *name,
                     size_t *parameter);

#endif
