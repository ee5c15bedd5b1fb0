// The linear solver that finds the accelerations of closed loops.
#include "sim/summary.h"

#include "solve/constraint/solver.h"

#include <string.h>

static const struct {
    const char *name;
    const struct ct_solver_kind *kind; // NULL: dense matrices, or the cheapest
} solvers[] = {{"auto", NULL},
               {"unrolled", &ct_solver_symbolic},
               {"one-system", &ct_solver_symbolic_kkt},
               {"sparse", &ct_solver_sparse},
               {"dense", NULL}};

bool ct_sim_choose_solver(struct ct_sim *sim, const char *name)
{
    size_t i = 0;
    while (name && i < COUNT(solvers) && strcmp(name, solvers[i].name) != 0)
        i++;
    if (i == COUNT(solvers))
        return ct_error(&sim->own, (struct ct_mark){0}, CT_E_USAGE,
                        "there is no solver '%s'; there are auto, unrolled, one-system, "
                        "sparse, dense",
                        name);
    if (i == 0) {
        // Implicit methods solve for accelerations only a few times per step, in addition to their
        // own systems: generating a symbolic solver takes longer than it saves; the sparse solver
        // needs no generation.
        struct ct_partition *s = ct_run_partition(sim->run);
        if (sim->run_options.method->is_implicit
            && s->m->nu + s->m->nrow >= CT_FEWEST_SPARSE_UNKNOWNS)
            ct_partition_use_solver(s, &ct_solver_sparse);
        return true;
    }
    sim->solver = solvers[i].name;
    ct_partition_use_solver(ct_run_partition(sim->run), solvers[i].kind);
    return true;
}

bool ct_sim_has_solver(struct ct_sim *sim)
{
    const struct ct_partition *s = ct_run_partition(sim->run);
    if (!sim->solver)
        return true;
    if (!s->m->nrow)
        return strcmp(sim->solver, ct_sim_solver(sim)) == 0
            || ct_error(&sim->own, (struct ct_mark){.file = sim->system->model.file},
                        CT_E_USAGE,
                        "there are no closed loops to solve by '%s'; the accelerations of this "
                        "system are found by '%s'",
                        sim->solver, ct_sim_solver(sim));
    for (size_t i = 0; i < COUNT(solvers); i++)
        if (strcmp(solvers[i].name, sim->solver) == 0 && (!solvers[i].kind || s->has_solver))
            return true;
    return ct_error(&sim->own, (struct ct_mark){.file = sim->system->model.file}, CT_E_USAGE,
                    "the accelerations cannot be found by '%s' here: the program would be too "
                    "long, nothing is free to move, or cotree was built without KLU; leave "
                    "'--solver' out",
                    sim->solver);
}
