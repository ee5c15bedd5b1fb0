// Where an analysis takes place: the start, an equilibrium, or the motion at a time.
#ifndef CT_ANALYSIS_CONFIGURATION_H
#define CT_ANALYSIS_CONFIGURATION_H

#include "analysis/equilibrium.h"
#include "analysis/sparse_modes.h"
#include "sim/sim.h"

struct ct_configuration {
    const char *about; // "initial", "equilibrium" or a time [s]
    /// With many speeds a start or an equilibrium is left without dense matrices: is_large.
    bool may_be_large;
    bool hold_drivers; // at an equilibrium motions stand still, even steady ones
    /// A variant and its equations on the trees of the system; NULL: those of the system itself.
    const struct ct_model *model;
    struct ct_equations *equations;
    // found
    const struct ct_equations *e;
    struct ct_linear *l; // linearised there
    struct ct_equilibrium_result equilibrium;
    bool is_large, is_equilibrium, are_drivers_held, are_drivers_steady;
    struct ct_sim *sim; // that led to a time
    struct ct_equations held;
};

/// Find and linearise it. Everything lives in own->model; motion of sys up to a time is
/// integrated as o says. Errors: CT_E_USAGE for `about`; those of assembly, of equilibria, of
/// runs.
bool ct_configuration_find(struct ct_ctx *own, struct ct_system *sys,
                           const struct ct_sim_options *o, struct ct_configuration *c);
/// Equations of a model on the trees of others, with rates of drivers taken for zero or not.
bool ct_equations_like(struct ct_ctx *own, const struct ct_model *model,
                       const struct ct_equations *like, bool drivers_held,
                       struct ct_equations *out);
/// An evaluator of e with its state at the start, linearisation prepared: l->y assembled, at
/// rest if asked for.
struct ct_linear *ct_configuration_start(struct ct_ctx *own, struct ct_system *sys,
                                         const struct ct_model *model,
                                         const struct ct_equations *e, bool at_rest);
/// ct_configuration_find with full matrices, after a find that was large. Warns that this takes
/// long. Errors: CT_E_FULL for what would take hours.
bool ct_configuration_find_full(struct ct_ctx *own, struct ct_system *sys,
                                const struct ct_sim_options *o, struct ct_configuration *c);
/// An analysis (from ct_own_alloc, with a context of its own and a configuration in it):
/// find(analysis) with a guard. Returns it, or NULL where that fails: then it is freed, and ctx
/// has the errors.
void *ct_analysis_find(struct ct_ctx *ctx, void *analysis, struct ct_ctx *own,
                       struct ct_configuration *at, bool (*find)(void *task));
void ct_analysis_free(void *analysis, struct ct_ctx *own, struct ct_configuration *at);
/// A line for people: where, and how near to equilibrium.
void ct_configuration_print(const struct ct_configuration *c, FILE *out);

#endif
