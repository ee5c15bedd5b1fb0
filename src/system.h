// A loaded model with its equations.
#ifndef CT_SYSTEM_H
#define CT_SYSTEM_H

#include "base/entry.h"
#include "formulate/formulate.h"
#include "solve/initial/assembly.h"

#include <cotree/cotree.h>

/// A model and its equations; constant once loaded, so that any number of threads may read it.
/// Everything lives in own.model.
struct ct_system {
    struct ct_ctx own;
    bool
        // of one run, analysis or worker: what is derived later goes into its own equations
        is_private;
    const struct ct_system *origin; // that it was borrowed from; NULL: it was loaded
    const char *text;               // of the model; NULL: it is in the file
    struct ct_model model;
    struct ct_equations equations;
    struct ct_tree_report tree;
    struct ct_equations start_equations; // on trees through joints, for assembling
    // where beams start in equilibrium, on trees through joints: with drivers that stand still,
    // and, in closed loops, with drivers that move
    struct ct_equations held_equations, moving_equations;
    double read, generate; // seconds
    struct ct_published {
        _Atomic(double *)
            start; // q, u, outputs at the start, once asked for; NaN where it cannot be assembled
    } * published;
};

/// What a run or an analysis may derive more in: the system itself if it is private, else a copy in
/// own->model that shares what is never written. `sys` must live as long. Raises the guard. Cost:
/// the stores of expressions.
struct ct_system *ct_system_borrow(struct ct_ctx *own, struct ct_system *sys);

/// The assembled initial state, with beams in equilibrium where requested. Errors: those of
/// ct_assembly_solve and ct_initial_equilibrium_solve.
bool ct_system_assemble(struct ct_ctx *own, struct ct_system *sys,
                        struct ct_initial_state *start);

#endif
