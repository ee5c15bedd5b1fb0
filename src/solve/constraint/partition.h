// Coordinate partitioning of a system with loops: accelerations, multipliers, impulses and the
// projection onto the constraints. A partitioning is a choice of independent constraint rows and of
// as many dependent speeds.  (formulation 6)
//
//     u = [ dependent | independent ]
//     u_d' = B u_i' + c,   (B' M B) u_i' = B' (Q - M c)     (6.2)
//
// Rows and columns of J are chosen by pivoted QR and kept while J_d stays well conditioned.
// Redundant rows take no part in the dynamics; the projection meets them too.
#ifndef CT_SOLVE_CONSTRAINT_PARTITION_H
#define CT_SOLVE_CONSTRAINT_PARTITION_H

#include "integrate/problem.h"
#include "solve/constraint/partition_conditioning.h"

/// Numbers of evaluations by the way in which accelerations were found, and of solvers made.
struct ct_solve_counts {
    long fixed;     // by a solver with a fixed order of pivots (solver.h)
    long refined;   // of those, with iterative refinement
    long pivoted;   // by dense matrices, with pivots sought anew
    long reordered; // solvers made after the first: for other rows, columns or pivots
};

// Limit: solvers that are kept for choices of rows and columns made before. Beyond it the one that
// was used least recently is given up, and made again when it is needed.
enum { CT_MOST_SOLVERS = 8 };

struct ct_partition {
    struct ct_evaluator *m;
    struct ct_ctx *ctx;
    struct ct_arena *arena;
    const double *pending; // time of the next event, owned by the run; NULL: there is no run
    int rank;
    int *row;                   // (nrow) the kept rows (rank), then the redundant ones
    int *dependent;             // (rank) columns
    int *independent;           // (nu - rank) columns
    double kappa, kappa_chosen; // largest |J_d^-1 J_i|, now and at the last choice
    // smallest pivot of J_d over the largest, now and at the last choice; it falls when kept rows
    // become dependent
    double sigma, sigma_chosen;
    double sigma_best; // largest sigma_chosen of the run
    double largest;    // largest pivot of J_d
    double scale; // unit of residuals; below 1 for mechanisms of less than a centimetre, (6.3c)
    double *unit; // (nrow) units of rows for the test of rank, (8.42)
    bool has_units; // they differ
    // measure of how near J is to losing rank at the last accepted state; 1 where it is farthest,
    // and where it is not monitored
    double nearness;
    // (nu) speeds that are to be independent if possible; NULL: none
    const bool *prefers_independent;
    bool *is_unique;               // (nrow) the multiplier of the row is unique
    long switches, factorizations; // choices, factorizations of J_d
    // solvers for choices made so far, the one used last first
    struct ct_solver *solver[CT_MOST_SOLVERS];
    size_t nsolver;
    const struct ct_solver_kind *kind; // of all solvers, chosen with the first one
    bool is_requested;                 // the caller chose the kind
    struct ct_solver_costs costs;      // predictions when the first one was chosen
    long nmade;                        // solvers made
    bool has_solver;                   // solver[0] is for the present rows and columns
    bool is_expensive;                 // dense matrices are cheaper than any solver
    bool is_near_singular;             // pivots are sought at every evaluation
    bool is_crossing; // a singular configuration is crossed: the choice must not change
    // For one degree of freedom: the least ratio of B' M B to its terms with which accelerations
    // have enough digits; 0: there is no demand.  (8.39)
    double least_cancellation;
    double left; // the least ratio so far, of those that dense matrices have given  (8.39)
    bool needs_refinement; // the last check found that solutions need refinement
    bool is_renewed;       // a projection has checked the choice since the last step ended
    long nweak;            // failed checks in a row, or projections without a solver
    int nunchecked; // projections until the next check, while the strength stays the same
    double checked_at, correction_checked; // strength and `correction` at the last check
    // largest correction of a coordinate over the residual in the last projection; 0: none was made
    double correction;
    struct ct_strength strength; // of solver[0]
    struct ct_solve_counts solves;
    double *a, *lam; // results: u' (nu), lam (nrow)
    // workspace
    double *Jd, *B, *c, *r, *S, *MB, *A, *b, *work, *d, *q, *before;
    int *pivot, *iwork, *column;
};

struct ct_partition *ct_partition_create(struct ct_arena *arena, struct ct_ctx *ctx,
                                         struct ct_evaluator *m);

/// Use solvers of this kind only, whatever they cost; NULL: dense matrices only. To be called
/// before the first choice of rows and columns.
void ct_partition_use_solver(struct ct_partition *s, const struct ct_solver_kind *kind);
/// Find units of rows from their levers at the last ct_evaluator_constraint.  (8.42)
void ct_partition_find_units(struct ct_partition *s);
/// Use dense matrices only: accelerations then do not depend on what was computed before.
void ct_partition_use_dense_only(struct ct_partition *s);
/// Operations of one ct_partition_accelerate.
double ct_partition_operations(const struct ct_partition *s);
/// Choose rows and columns anew at the evaluator's input. False with a diagnostic if some free
/// motion has no inertia.
bool ct_partition_choose(struct ct_partition *s);
/// u' into s->a and q' at the evaluator's input, by a solver with fixed pivots if that is sound.
enum ct_eval ct_partition_solve(struct ct_partition *s);
/// The same at t, y; u' goes into the evaluator's input too. CT_EVAL_RETRY if it is not finite.
enum ct_eval ct_partition_accelerate_at(struct ct_partition *s, double t, const double *y);
/// u' into s->a from M, Q, J, gam of the last ct_evaluator_dynamics, by dense matrices.
enum ct_eval ct_partition_accelerate(struct ct_partition *s);
/// left (nu, out): the inertia of each independent speed while those in `follows` (nu) are free to
/// follow it, at the last ct_evaluator_dynamics. These are pivots of B' M B if speeds in `follows`
/// are eliminated first; elimination ends at the first pivot that is not positive. NaN for other
/// speeds. False if J_d is singular.
bool ct_partition_inertias(struct ct_partition *s, const bool *follows, double *left);
/// Minimum-norm multipliers into s->lam at the evaluator's input; s->a holds its u'.  (section 6.5)
void ct_partition_multipliers(struct ct_partition *s);
/// Multipliers lam (rank, out) of the kept rows alone, after ct_partition_accelerate:
/// J_d' lam = (M u' - Q)_d.
void ct_partition_retained_multipliers(struct ct_partition *s, double *lam);
/// Choose anew if the conditioning of J_d, as factored last, has degraded. For runs that do not
/// project; J is that of the evaluator's input.
void ct_partition_renew(struct ct_partition *s);
/// The same at the end of a step to y at t, right after accelerations were found. Does nothing if
/// the step ended with a projection.
void ct_partition_renew_after_step(struct ct_partition *s, double t, const double *y);
/// Project q, u in y onto the constraints; independent coordinates stay if J_d allows.  (6.3)
enum ct_eval ct_partition_project(struct ct_partition *s, double t, double *y);
/// The same for a state that is not on the motion: only the evaluator's input and last values
/// change, the choice does not. False if the iteration fails, and for large systems, whose dense
/// factors cost more than steps.
bool ct_partition_close_loops(struct ct_partition *s, double t, double *y);
/// Is ct_partition_pivot available? Not if no joint closes a loop, as J then keeps its rank, and
/// not for large systems with redundant rows, where it would cost more than the steps.
bool ct_partition_has_pivot(const struct ct_partition *s);
/// A measure of how near J is to losing rank at the last ct_evaluator_constraint, to be compared
/// with its values elsewhere on the motion. It is the smallest pivot of J_d times max(1, kappa):
/// small if J loses rank, but not if only the choice of columns is bad. With redundant rows it is
/// the smallest of the largest `rank` singular values of J, as kept rows may lose rank where all
/// rows do not.
double ct_partition_pivot(struct ct_partition *s);
/// The smallest pivot of J_d alone, with all its digits; infinite for large systems.
double ct_partition_retained_pivot(struct ct_partition *s);
/// Is ct_partition_pivot between the two values? With redundant rows this is cheaper than to
/// compute it. False if that is not certain, and without redundant rows.
bool ct_partition_pivot_is_between(struct ct_partition *s, double low, double high);
/// Tangent and null-space basis of J at one state, to compare orientations at two states.
struct ct_tangent_basis {
    int rank;              // 0: not known
    int side;              // sign of det [J N; T' 0] with T and N of this state
    double *T;             // (nu x free) tangents, J T = 0
    double *N;             // (nrow x redundant) left null vectors, N'J = 0
    size_t room_T, room_N; // entries that are allocated
};
struct ct_tangent_basis *ct_tangent_basis_create(struct ct_arena *arena);
/// After a choice of rows and columns: allocate for this rank of J or more; the basis is not known
/// yet.
void ct_tangent_basis_reserve(struct ct_partition *s, struct ct_tangent_basis *v);
/// The basis at the last ct_evaluator_constraint, after ct_partition_pivot. Not for large systems.
void ct_tangent_basis_find(struct ct_partition *s, struct ct_tangent_basis *v);
/// Has the sign of the test function changed between the two states, so that J has lost rank an odd
/// number of times? It does not depend on choices of rows and columns. False if a basis is not
/// known.  (8.40)
bool ct_singularity_test_sign_changed(struct ct_partition *s,
                                      const struct ct_tangent_basis *from,
                                      const struct ct_tangent_basis *to);
/// Inverse iteration at the last ct_evaluator_constraint, near a configuration where J loses rank:
/// x (rank, out) = (J_d J_d')^-1 v with an arbitrary v, which is nearly in null(J') of that
/// configuration. log_det (out): log |det J_d|, or with redundant rows the logarithm of the product
/// of the singular values. False for large systems.
bool ct_partition_dependence(struct ct_partition *s, double *x, double *log_det);
/// Factors for null(J') at the last ct_evaluator_constraint, which must not be repeated until all
/// vectors are found; in a.  (section 6.5)
struct ct_null_space *ct_null_space_create(struct ct_arena *a, struct ct_partition *s);
/// z (nrow, out) = the projection of the unit vector of `row` onto null(J'): lam + z satisfies the
/// equations as well as lam. Zero (to round-off) if the multiplier of the row is unique.
void ct_null_space_vector(struct ct_null_space *v, int row, double *z);
/// Which multipliers are unique, into s->is_unique: rows of null(J') that vanish.  (section 6.5)
void ct_partition_uniqueness(struct ct_partition *s, struct ct_null_space *v);
/// Speeds after an impulse: u (nu, out) with W u = w + J' Lam, J u + Phi_t = 0 at the evaluator's
/// input. W (nu x nu)  (8.5)
enum ct_eval ct_partition_impulse(struct ct_partition *s, const double *W, const double *w,
                                  double *u);

#endif
