// Model -> trees -> reduced equations of motion.
#ifndef CT_FORMULATE_FORMULATE_H
#define CT_FORMULATE_FORMULATE_H

#include "formulate/equations.h"

enum ct_tree_choice {
    CT_TREE_AUTO, // least weight, then improved by the exact operation count (formulation 2.3)
    CT_TREE_JOINTS,   // through joints only
    CT_TREE_ABSOLUTE, // every body's own coordinates
    CT_TREE_GIVEN     // branches by name
};

struct ct_formulate_options {
    enum ct_tree_choice tree;
    const char *const *trans, *const *rot; // GIVEN: names of the branches that are not arms
    const struct ct_mark *trans_mark, *rot_mark; // of each name; NULL: nowhere
    size_t ntrans, nrot;
    bool keep_all;     // leave nothing out: spatial rows for planar mechanisms
    bool with_energy;  // kinetic and potential energy and the power are wanted
    bool with_outputs; // the outputs of the model are wanted
    enum ct_more_outputs more;
    bool with_solution; // u' in closed form where that is cheap
    bool with_residual; // an implicit method will ask for the residual and its derivatives
    bool
        measure_all; // results are the coordinates of all joints and bodies instead (for assembly)
    bool drivers_held; // motions keep their values; their rates are taken for zero (statics)
    bool without_dynamics; // neither M nor Q: places and speeds are all that is wanted
};

/// What tree selection found, for the report.
struct ct_tree_report {
    const char *how; // "exhaustive search of 441 pairs", "given", ...
    double cost, cost_least_weight;
};

/// Equations of the model for the trees that the options ask for. Everything lives in a.
/// Errors: E2xx.
bool ct_formulate(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *m,
                  const struct ct_formulate_options *options, struct ct_equations *out,
                  struct ct_tree_report *report);

/// The residual form, if the equations do not have it yet: for an implicit method chosen after they were made.
void ct_formulate_residual(struct ct_equations *e);

#endif
