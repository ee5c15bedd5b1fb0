// Coordinate partitioning of a system with loops (Wehage and Haug): accelerations, multipliers,
// impulses and the projection onto the constraints. A partitioning is a choice of independent
// constraint rows and of as many dependent speeds.  (formulation 6)
//
//     u = [ dependent | independent ]
//     u_d' = B u_i' + c,   (B' M B) u_i' = B' (Q - M c)     (6.2)
//
// Rows and columns of J are chosen by pivoted QR, and kept while J_d stays well conditioned.
// Redundant rows do not enter the dynamics; the projection satisfies them too.
#ifndef CT_SOLVE_CONSTRAINT_PARTITION_H
#define CT_SOLVE_CONSTRAINT_PARTITION_H

#include "integrate/problem.h"
#include "solve/constraint/partition_conditioning.h"

/// Numbers of evaluations by the method that gave the accelerations, and of solvers made.
struct ct_solve_counts {
    long fixed;     // by a solver with a fixed order of pivots (solver.h)
    long refined;   // of those, with iterative refinement
    long pivoted;   // by dense matrices, with new pivots
    long reordered; // solvers made after the first: for other rows, columns or pivots
};

// Limit: solvers that are stored for earlier choices of rows and columns. Beyond it the one
// used least recently is destroyed, and made again when it is needed.
enum { CT_MOST_SOLVERS = 8 };

struct ct_partition {
    struct ct_evaluator *m;
    struct ct_ctx *ctx;
    struct ct_arena *arena;
    const double *pending; // time of the next event, owned by the run; NULL: there is no run
    int rank;
    int *row;                   // the retained rows (rank), then the redundant ones
    int *dependent;             // (rank) columns
    int *independent;           // (nu - rank) columns
    double kappa, kappa_chosen; // largest |J_d^-1 J_i|, now and at the last choice
    // smallest over largest pivot of J_d, now and at the last choice; it falls when retained
    // rows become dependent
    double sigma, sigma_chosen;
    double sigma_best; // largest sigma_chosen of the run
    double largest;    // largest pivot of J_d
    double scale; // unit of residuals; below 1 for mechanisms of less than a centimetre, (6.3c)
    double *unit; // units of rows for the rank test, (8.42)
    bool has_units; // not all are equal
    // distance of J from loss of rank at the last accepted state, relative to its largest value so
    // far; 1 where it is not monitored
    double nearness;
    // speeds preferred as independent; NULL: none
    const bool *prefers_independent;
    bool *is_unique;               // (nrow) the multiplier of the row is unique
    long switches, factorizations; // choices, factorizations of J_d
    // solvers for earlier choices, the most recently used one first
    struct ct_solver *solver[CT_MOST_SOLVERS];
    size_t nsolver;
    const struct ct_solver_kind *kind; // of all solvers; chosen with the first one
    bool is_requested;                 // the caller chose the kind
    struct ct_solver_costs costs;      // predictions when the first one was chosen
    long nmade;                        // solvers made
    bool has_solver;                   // solver[0] is for the present rows and columns
    bool is_expensive;                 // dense matrices are cheaper than any solver
    bool is_near_singular;             // new pivots at every evaluation
    bool is_crossing; // a singular configuration is crossed: the choice must not change
    // For one degree of freedom: smallest ratio of B' M B to the sum of its terms at which
    // accelerations are accurate enough; 0: no requirement.  (8.39)
    double least_cancellation;
    double smallest_cancellation; // smallest such ratio so far, from dense matrices  (8.39)
    bool needs_refinement;        // according to the last check
    bool is_renewed; // a projection has checked the choice since the last step ended
    long nweak;      // consecutive failed checks, or projections without a solver
    int nunchecked; // projections until the next check, while strength and corrections are alike
    double checked_at, correction_checked; // strength and `correction` at the last check
    // largest correction of a coordinate over the residual, last projection; 0: no correction
    double correction;
    struct ct_strength strength; // of solver[0]
    struct ct_solve_counts solves;
    double *a, *lam; // results: u' (nu), lam (nrow)
    // workspace
    double *M, *Jd, *B, *c, *r, *S, *MB, *A, *b, *work, *d, *q, *before;
    int *pivot, *iwork, *column;
};

struct ct_partition *ct_partition_create(struct ct_arena *arena, struct ct_ctx *ctx,
                                         struct ct_evaluator *m);

/// Use only solvers of this kind, whatever their cost; NULL: dense matrices only. Call it
/// before the first choice of rows and columns.
void ct_partition_use_solver(struct ct_partition *s, const struct ct_solver_kind *kind);
/// Find units of rows from their lever arms at the last ct_evaluator_constraint.  (8.42)
void ct_partition_find_units(struct ct_partition *s);
/// Use dense matrices only: accelerations then do not depend on earlier evaluations.
void ct_partition_use_dense_only(struct ct_partition *s);
/// Operations of one ct_partition_accelerate.
double ct_partition_operations(const struct ct_partition *s);
/// Choose rows and columns at the evaluator's input. False with a diagnostic if some free
/// motion has no inertia.
bool ct_partition_choose(struct ct_partition *s);
/// u' into s->a and q' at the evaluator's input, by a solver with fixed pivots where these are
/// accurate.
enum ct_eval ct_partition_solve(struct ct_partition *s);
/// The same at t, y; u' goes into the evaluator's input too. CT_EVAL_RETRY if it is not finite.
enum ct_eval ct_partition_accelerate_at(struct ct_partition *s, double t, const double *y);
/// M (nu x nu) of the last ct_evaluator_dynamics.
const double *ct_partition_mass(struct ct_partition *s);
/// u' into s->a from M, Q, J, gam of the last ct_evaluator_dynamics, by dense matrices.
enum ct_eval ct_partition_accelerate(struct ct_partition *s);
/// Pivots of B' M B when the speeds in `follows` (nu) are eliminated first: inertia (nu, out)
/// of each other independent speed, while those in `follows` are free. From the last
/// ct_evaluator_dynamics. Elimination ends at the first pivot that is not positive. NaN for all
/// others. False if J_d is singular.
bool ct_partition_inertias(struct ct_partition *s, const bool *follows, double *inertia);
/// Minimum-norm multipliers into s->lam at the evaluator's input; s->a holds its u'.  (section 6.5)
void ct_partition_multipliers(struct ct_partition *s);
/// Multipliers lam (rank, out) of the retained rows alone, after ct_partition_accelerate: J_d'
/// lam = (M u' - Q)_d.
void ct_partition_retained_multipliers(struct ct_partition *s, double *lam);
/// Make a new choice if the conditioning of J_d, as factored last, has degraded. For runs
/// without projection; J is that of the evaluator's input.
void ct_partition_renew(struct ct_partition *s);
/// The same at the end of a step to y at t, directly after its accelerations. Does nothing if
/// the step ended with a projection.
void ct_partition_renew_after_step(struct ct_partition *s, double t, const double *y);
/// Project q, u in y onto the constraints. Independent coordinates are unchanged where J_d is
/// well conditioned.  (6.3)
enum ct_eval ct_partition_project(struct ct_partition *s, double t, double *y);
/// The same for a trial state: only the evaluator's input and last values change, the choice
/// does not. False if the iteration fails, and for large systems, whose dense factors cost more
/// than steps.
bool ct_partition_close_loops(struct ct_partition *s, double t, double *y);
/// Is ct_partition_pivot available? Not if no joint closes a loop, as the rank of J is then
/// constant, and not for large systems with redundant rows, where it costs more than steps.
bool ct_partition_has_pivot(const struct ct_partition *s);
/// Distance of J from loss of rank at the last ct_evaluator_constraint, to be compared with values
/// at other states of the motion. It is the smallest pivot of J_d times max(1, kappa): small where
/// J loses rank, but not where only the choice of columns is bad. With redundant rows it is the
/// smallest of the largest `rank` singular values of J, as the retained rows may lose rank where J
/// does not.
double ct_partition_pivot(struct ct_partition *s);
/// Bases of the null space and the left null space of J at one state, to compare the signs of
/// the test function (8.40) at two states.
struct ct_tangent_basis {
    int rank;              // 0: unknown
    int side;              // sign of det [J N; T' 0] with T and N of this state
    double *T;             // (nu x free) basis of the null space, J T = 0
    double *N;             // (nrow x redundant) basis of the left null space, N'J = 0
    size_t room_T, room_N; // allocated entries
};
struct ct_tangent_basis *ct_tangent_basis_create(struct ct_arena *arena);
/// After a choice of rows and columns: allocate for this rank of J or more; the basis is not
/// yet found.
void ct_tangent_basis_reserve(struct ct_partition *s, struct ct_tangent_basis *v);
/// The basis at the last ct_evaluator_constraint, after ct_partition_pivot. Not for large systems.
void ct_tangent_basis_find(struct ct_partition *s, struct ct_tangent_basis *v);
/// Has the sign of the test function changed between the two states, so that J has lost rank an
/// odd number of times? The sign does not depend on choices of rows and columns. False if a
/// basis is unknown.  (8.40)
bool ct_singularity_test_sign_changed(struct ct_partition *s,
                                      const struct ct_tangent_basis *from,
                                      const struct ct_tangent_basis *to);
/// One step of inverse iteration near a configuration where J loses rank, at the last
/// ct_evaluator_constraint: x (rank, out) = (J_d J_d')^-1 v with an arbitrary v. x is nearly in
/// null(J') of that configuration. log_det (out): log |det J_d|, or with redundant rows the
/// logarithm of the product of the singular values. False for large systems.
bool ct_partition_dependence(struct ct_partition *s, double *x, double *log_det);
/// Factors for null(J') at the last ct_evaluator_constraint, valid until the next; in a.
/// (section 6.5)
struct ct_null_space *ct_null_space_create(struct ct_arena *a, struct ct_partition *s);
/// z (nrow, out) = projection of the unit vector of `row` onto null(J'): lam + z satisfies the
/// equations if lam does. Zero (to round-off) if the multiplier of the row is unique.
void ct_null_space_vector(struct ct_null_space *v, int row, double *z);
/// Which multipliers are unique, into s->is_unique: rows of null(J') that vanish.  (section 6.5)
void ct_partition_uniqueness(struct ct_partition *s, struct ct_null_space *v);
/// Speeds after an impulse: u (nu, out) with W u = w + J' Lam, J u + Phi_t = 0 at the evaluator's
/// input. W (nu x nu)  (8.5)
enum ct_eval ct_partition_impulse(struct ct_partition *s, const double *W, const double *w,
                                  double *u);

#endif
