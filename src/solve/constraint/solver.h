// Solvers: ways to solve the linear equations of a closed system for one choice of rows and columns
// without seeking pivots again.
//
//     unrolled   programs made by elimination on the expressions               (formulate/closed_form/elimination.h)
//     unrolled as one system   the same of [M J'; J 0]                         (formulate/closed_form/kkt.h)
//     sparse     [M J'; J 0] and J_d as sparse matrices, factored with the pivots of before
//
// The order of pivots is fixed, so it is watched: the strength of a form is that of its weakest
// pivot against the others or the entries around it, and what is left of the equations is measured.
#ifndef CT_SOLVE_CONSTRAINT_SOLVER_H
#define CT_SOLVE_CONSTRAINT_SOLVER_H

#include "formulate/closed_form/elimination.h"
#include "solve/evaluator/evaluator.h"

struct ct_solver {
    const struct ct_solver_kind *kind;
    struct ct_arena *arena; // its own
    int *row, *dependent;   // kept rows (rank), dependent columns, ascending: what it is for
    size_t rank;
    double operations; // of one solution, M, Q, J and gam included
    double cost; // the same weighed by what an operation takes, in those of straight-line code
    double
        weakest; // of its pivots, at the last solution or close: what strength is, also above 1
    double
        least_part; // of the largest that an inertia of B' M B has been: below it `has_fallen`, at the last solution
    bool has_fallen;
    double volume; // their product, det J_d but for a factor; NAN: not found
    // results of check
    const double *a, *lam; // u' (nu), multipliers of the kept rows (rank)
    double remainder,
        // residual against the terms of the equations, before and after refinement
        refined_remainder;
    double kappa; // largest entry of B; NAN: not found
    // results of close
    const double *phi, *v, *dq,
        *du; // (nrow), (nrow); corrections of the dependent places (nu), else 0
    const double *
        shift; // to be added to du where dq leads, (6.3b); NULL: not found, as where rows are redundant
};

struct ct_solver_kind {
    const char *name;
    /// NULL if a pivot is missing, it takes too many nodes or a library is missing.
    struct ct_solver *(*create)(struct ct_arena *a, struct ct_evaluator *m,
                                const struct ct_partition_sets *p, double most_nodes);
    double (*solve)(struct ct_solver *f, struct ct_evaluator *m, double *a);
    void (*check)(struct ct_solver *f, struct ct_evaluator *m);
    double (*close)(struct ct_solver *f, struct ct_evaluator *m);
    void (*destroy)(struct ct_solver *f, struct ct_evaluator *m); // may be NULL
};

/// Smaller systems are never cheaper as sparse matrices: unknowns.
enum { CT_LEAST_SPARSE = 100 };
extern const struct ct_solver_kind ct_solver_symbolic, ct_solver_symbolic_kkt, ct_solver_sparse;

/// What solving is predicted to cost in each way, M, Q, J and gam included [operations of
/// straight-line code]; NAN: it was not looked at, INFINITY: it is not possible, or `symbolic` was
/// given up as longer than the others.
struct ct_solver_costs {
    double symbolic, symbolic_kkt, sparse, dense;
};

/// The cheapest form of a partition by counts of operations, its order of pivots sought at the
/// evaluator's input, after ct_evaluator_dynamics. NULL if the solve by dense matrices is cheaper:
/// operations [multiplications or additions]. kind: of the form to make, whatever it costs; NULL:
/// the cheapest. costs (out) may be NULL. Owned by a until destroyed.
struct ct_solver *ct_solver_create(struct ct_arena *a, struct ct_evaluator *m,
                                   const struct ct_partition_sets *p, double operations,
                                   const struct ct_solver_kind *kind,
                                   struct ct_solver_costs *costs);
/// One of this kind if it costs no more than so much, or little more: it is given up while it is
/// made.
struct ct_solver *ct_solver_create_within(struct ct_arena *a, struct ct_evaluator *m,
                                          const struct ct_partition_sets *p,
                                          const struct ct_solver_kind *kind, double cost);
/// One of this kind however long its programs are, up to some millions of nodes.
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

/// Below this strength a form is of no use: one in so many digits is lost.
extern const double ct_solver_least_strength;

/// The programs of an unrolled form.
///
///     solved    u', q', pivots of B' M B (nfree, positive), of J_d (npivot), whose sizes times scale are strengths; the
///               power if it depends on neither u' nor multipliers
///     checked   refined u' (nu) and lam (rank), residuals before and after (nu + rank each), Q, gam (rank), B (nB)
///     closing   Phi, v (nrow each), corrections dq, du (nu each), shift (nshift), pivots of J_d
struct ct_solver_code {
    const struct ct_listing *listing; // NULL: a form of another kind
    size_t nfree, npivot;
    const double *scale;
    const struct ct_program *solved, *checked, *closing;
    size_t nB, nshift;
    double M_size, J_size; // largest entries where the form was made
    bool has_power;        // behind the pivots of `solved`
};
struct ct_solver_code ct_solver_code(const struct ct_solver *f);

// ---- for the kinds ------------------------------------------------------------------------------

/// Fill row, dependent, rank.
void ct_solver_set_partition(struct ct_solver *f, const struct ct_partition_sets *p);
/// Values by symbol at the evaluator's input, for partitions; NULL where no beam is carried.
const double *ct_solver_values(struct ct_arena *a, const struct ct_evaluator *m);
/// Operations of a program, one each.
double ct_solver_operations(const struct ct_program *p);
/// Machine code of so many operations without loops [bytes].
double ct_solver_code_size(double operations);
/// What so many operations of straight-line code take, in operations whose code is in the nearest
/// caches.
double ct_solver_straight_cost(double operations, double bytes);

#endif
