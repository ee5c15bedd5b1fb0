// A model that traces its numbers: each is multiplied by the mark of its component.
//
//     crank: {mass: m1, com: [r/2, 0, 0]}     mass m1*mark(crank), com [r/2*mark(crank), 0, 0]
//
// Marks are parameters of value 1, so that the equations of the marked model are those of the
// model.
#ifndef CT_REPORT_MARKED_MODEL_H
#define CT_REPORT_MARKED_MODEL_H

#include "component/model.h"

/// A body, joint, force, frame or parameter, or `gravity`.
struct ct_origin {
    const char *name;
    int line; // of its key in the model file, from 1; 0: it is not in the file
};

struct ct_marked_model {
    struct ct_model model;
    struct ct_origin *origin; // in the order of the file
    size_t norigin;
    ct_ex *mark; // by origin; CT_EX_ZERO for parameters, which are symbols themselves
    // numbers of origins; of bodies, frames, joints and parameters of the model
    uint32_t *of_body, *of_frame, *of_joint, *of_parameter;
};

/// A marked copy of `model` with expressions in x, a store that contains those of the model and
/// grows. Owned by a.
void ct_marked_model_create(struct ct_arena *a, const struct ct_model *model, struct ct_exs *x,
                            struct ct_marked_model *out);

#endif
