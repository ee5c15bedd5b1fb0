// Analyses about a configuration: equilibrium, linearisation to state-space matrices,
// natural modes, static buckling, and a survey of loops. Files command_*.c implement the
// commands of the public interface; the others are the numerical methods below them.
//
// This header finds the configuration about which an analysis linearises: the assembled start,
// an equilibrium, or the state at a given time of a run.
#ifndef CT_ANALYSIS_CONFIGURATION_H
#define CT_ANALYSIS_CONFIGURATION_H

#include "analysis/equilibrium.h"
#include "analysis/sparse_modes.h"
#include "sim/sim.h"

struct ct_configuration {
    const char *about; // "initial", "equilibrium", or a time [s] as text
    /// With many speeds the configuration is left without dense matrices, and is_large is set.
    bool may_be_large;
    bool hold_drivers; // at an equilibrium all drivers are held, also those of constant rate
    /// A model variant, whose equations are made on the trees of the system. NULL: the system's
    /// own.
    const struct ct_model *model;
    struct ct_equations *equations;
    // results
    const struct ct_equations *e;
    struct ct_linear *l; // linearised at the configuration
    struct ct_equilibrium_result equilibrium;
    bool is_large, is_equilibrium, are_drivers_held, are_drivers_steady;
    struct ct_sim *sim; // the run that led to a given time; else NULL
    struct ct_equations held;
};

/// Finds the configuration and linearises there. Everything lives in own->model. A run up to a
/// time is integrated with the options o. Errors: CT_E_USAGE for `about`; those of assembly, of
/// equilibria and of runs.
bool ct_configuration_find(struct ct_ctx *own, struct ct_system *sys,
                           const struct ct_sim_options *o, struct ct_configuration *c);
/// Makes equations of a model on the trees of another system, with the rates of drivers set to
/// zero or not.
bool ct_equations_like(struct ct_ctx *own, const struct ct_model *model,
                       const struct ct_equations *like, bool drivers_held,
                       struct ct_equations *out);
/// Creates an evaluator of e with its state at the start and prepares the linearisation. l->y
/// is assembled, and at rest if requested.
struct ct_linear *ct_configuration_start(struct ct_ctx *own, struct ct_system *sys,
                                         const struct ct_model *model,
                                         const struct ct_equations *e, bool at_rest);
/// Repeats ct_configuration_find with dense matrices, after a call that set is_large. Warns
/// that this takes long. Errors: CT_E_FULL for a system that would take hours.
bool ct_configuration_find_full(struct ct_ctx *own, struct ct_system *sys,
                                const struct ct_sim_options *o, struct ct_configuration *c);
/// Runs an analysis inside an error guard. `analysis` comes from ct_own_alloc and holds its own
/// context and a configuration; the guard calls find(analysis). Returns the analysis. If it
/// fails, frees it, copies its errors into ctx and returns NULL.
void *ct_analysis_find(struct ct_ctx *ctx, void *analysis, struct ct_ctx *own,
                       struct ct_configuration *at, bool (*find)(void *task));
void ct_analysis_free(void *analysis, struct ct_ctx *own, struct ct_configuration *at);
/// Prints one line: the configuration and how near it is to equilibrium.
void ct_configuration_print(const struct ct_configuration *c, FILE *out);

#endif
