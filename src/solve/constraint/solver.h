// Solvers of the linear equations of a system with loops, for one choice of independent rows and
// dependent columns, with a fixed order of pivots.
//
//     symbolic       compiled elimination of (6.2)          (formulate/closed_form/elimination.h)
//     symbolic KKT   the same of the matrix [M J'; J 0]     (formulate/closed_form/kkt.h)
//     sparse         [M J'; J 0] and J_d as sparse matrices, factored in the order found at first
//
// A fixed order of pivots can become inaccurate as the mechanism moves. Two measures show it:
// the strength, which is the smallest pivot relative to the entries of its row or to its size
// when the order was chosen, and the residual of the equations.
#ifndef CT_SOLVE_CONSTRAINT_SOLVER_H
#define CT_SOLVE_CONSTRAINT_SOLVER_H

#include "formulate/closed_form/elimination.h"
#include "solve/evaluator/evaluator.h"

struct ct_solver {
    const struct ct_solver_kind *kind;
    struct ct_arena *arena; // its own
    int *row, *dependent;   // the retained rows and dependent columns, ascending
    size_t rank;
    double operations; // of one solution, evaluation of M, Q, J and gam included
    double cost;       // its time, in operations of straight-line code in the cache
    double weakest; // smallest relative pivot at the last solve or close; strength is at most 1
    double least_part; // limit of an inertia of B' M B relative to its largest value so far
    bool has_fallen;   // some inertia was below it at the last solve
    double volume;     // product of the pivots, proportional to det J_d; NAN: not computed
    // results of check
    const double *a, *lam; // u' (nu), multipliers of the retained rows (rank)
    // residual relative to the terms of the equations, before and after refinement
    double remainder, refined_remainder;
    double kappa; // largest entry of B; NAN: not computed
    // results of close: residuals (nrow each), corrections (nu each; 0 for independent ones)
    const double *phi, *v, *dq, *du;
    // correction of du for the change of J along dq, (6.3b); NULL: unknown, as with redundant
    // rows
    const double *shift;
};

struct ct_solver_kind {
    const char *name;
    /// NULL if a pivot is zero, there are more than most_nodes nodes, or a library is missing.
    struct ct_solver *(*create)(struct ct_arena *a, struct ct_evaluator *m,
                                const struct ct_partition_sets *p, double most_nodes);
    double (*solve)(struct ct_solver *f, struct ct_evaluator *m, double *a);
    void (*check)(struct ct_solver *f, struct ct_evaluator *m);
    double (*close)(struct ct_solver *f, struct ct_evaluator *m);
    void (*destroy)(struct ct_solver *f, struct ct_evaluator *m); // may be NULL
};

/// Smallest number of unknowns of [M J'; J 0] for sparse matrices.
/// Default: the time of the analysis; smaller systems are not cheaper as sparse matrices.
/// Test: solvers
enum { CT_FEWEST_SPARSE_UNKNOWNS = 100 };
extern const struct ct_solver_kind ct_solver_symbolic, ct_solver_symbolic_kkt, ct_solver_sparse;

/// Predicted cost of each solver, evaluation of M, Q, J and gam included [operations of
/// straight-line code]. NAN: not considered; INFINITY: not possible, or `symbolic` was given up as
/// longer than the others.
struct ct_solver_costs {
    double symbolic, symbolic_kkt, sparse, dense;
};

/// The solver of a partitioning with the lowest predicted cost. Its order of pivots is found at
/// the evaluator's input, after ct_evaluator_dynamics. NULL if dense matrices, which take
/// `operations` multiplications and additions, are cheaper. kind: use this kind, whatever its
/// cost; NULL: the cheapest. costs (out) may be NULL. Owned by a until destroyed.
struct ct_solver *ct_solver_create(struct ct_arena *a, struct ct_evaluator *m,
                                   const struct ct_partition_sets *p, double operations,
                                   const struct ct_solver_kind *kind,
                                   struct ct_solver_costs *costs);
/// A solver of this kind that costs about `cost` at most; NULL if its creation shows that it
/// costs more.
struct ct_solver *ct_solver_create_within(struct ct_arena *a, struct ct_evaluator *m,
                                          const struct ct_partition_sets *p,
                                          const struct ct_solver_kind *kind, double cost);
/// A solver of this kind whatever its cost, up to some millions of nodes.
struct ct_solver *ct_solver_create_any_length(struct ct_arena *a, struct ct_evaluator *m,
                                              const struct ct_partition_sets *p,
                                              const struct ct_solver_kind *kind);
void ct_solver_destroy(struct ct_evaluator *m, struct ct_solver *f);
bool ct_solver_matches(const struct ct_solver *f, const struct ct_partition_sets *p);

/// u' (nu, out) and q' at the evaluator's input. Returns the strength, 0 if there is no finite
/// result.
double ct_solver_solve(struct ct_solver *f, struct ct_evaluator *m, double *a);
/// Fill the results of check at the evaluator's input.
void ct_solver_check(struct ct_solver *f, struct ct_evaluator *m);
/// Fill the results of close at the evaluator's input. Returns the strength.
double ct_solver_close(struct ct_solver *f, struct ct_evaluator *m);

/// The programs of a symbolic solver.
///
///     solved    u' (nu), q' (nq), pivots of B' M B (nfree, positive) and of J_d (npivot); sizes of
///               the latter times `scale` are strengths; the power, if has_power
///     checked   refined u' (nu) and lam (rank), residuals before and after (nu + rank each), Q,
///               gam (rank), B (nB)
///     closing   Phi, v (nrow each), corrections dq, du (nu each), shift (nshift), pivots of J_d
struct ct_solver_code {
    const struct ct_listing *listing; // NULL: the solver is not symbolic
    size_t nfree, npivot;
    const double *scale;
    const struct ct_program *solved, *checked, *closing;
    size_t nB, nshift;
    double M_size, J_size; // largest entries when the solver was made
    bool has_power;        // the power follows the pivots of `solved`
};
struct ct_solver_code ct_solver_code(const struct ct_solver *f);

// ---- for the kinds ------------------------------------------------------------------------------

/// Fill row, dependent, rank.
void ct_solver_set_partition(struct ct_solver *f, const struct ct_partition_sets *p);
/// Values of all symbols at the evaluator's input; NULL if the equations have no augmented beams.
const double *ct_solver_values(struct ct_arena *a, const struct ct_evaluator *m);
/// Operations of a program, each counted as one.
double ct_solver_operations(const struct ct_program *p);
/// Machine code of so many operations without loops [bytes].
double ct_solver_code_size(double operations);
/// The time of so many operations of straight-line code of this size [bytes], in operations whose
/// code is in the nearest cache.
double ct_solver_straight_cost(double operations, double bytes);

#endif
