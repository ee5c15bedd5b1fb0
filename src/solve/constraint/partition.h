// Accelerations, multipliers and projections of a system with loops by coordinate partitioning.  (formulation 6)
//
//     u = [ dependent | independent ],   u_d' = B u_i' + c,   (B' M B) u_i' = B' (Q - M c)     (6.2)
//
// Independent rows of J and dependent columns are chosen by pivoted QR and kept while J_d stays well
// conditioned; redundant rows take no part in the dynamics but are met by the projections.
#ifndef CT_SOLVE_CONSTRAINT_PARTITION_H
#define CT_SOLVE_CONSTRAINT_PARTITION_H

#include "integrate/problem.h"
#include "solve/constraint/partition_conditioning.h"

/// How accelerations were found, in evaluations, and how often a form was made after the first.
struct ct_solve_counts {
    long fixed;     // by a form, with the order of pivots it was made with
    long refined;   // of those, with a step of refinement
    long pivoted;   // by dense matrices, pivots sought anew
    long reordered; // forms made for other rows, columns or pivots
};

enum { CT_MOST_SOLVERS = 8 };

struct ct_partition {
    struct ct_evaluator *m;
    struct ct_ctx *ctx;
    struct ct_arena *arena;
    const double *pending; // time of the event ahead, the run's; NULL: there is no run
    int rank;
    int *row;                   // kept rows, rank of them, then the redundant ones
    int *dependent;             // rank columns
    int *independent;           // nu - rank columns
    double kappa, kappa_chosen; // largest |J_d^-1 J_i|, now and when chosen
    double sigma,
        sigma_chosen;  // smallest pivot of J_d against its largest: falls when kept rows depend
    double sigma_best; // largest sigma_chosen of the run
    double largest;    // pivot of J_d
    double
        scale; // what rows are measured by: below 1 for mechanisms of less than centimetres, (6.3c)
    double *unit;   // (nrow) what rows are measured by against each other, (8.42)
    bool has_units; // which differ
    double
        nearness; // how near J is to losing rank at the last accepted state, 1 at its farthest and where nobody looks
    const bool *
        prefers_independent; // (nu) speeds that choices leave independent where they can; NULL: none
    bool *is_unique;         // per row: its multiplier is determined
    long switches, factorizations;
    // closed forms, the latest used first
    struct ct_solver *solver[CT_MOST_SOLVERS];
    size_t nsolver;
    const struct ct_solver_kind *kind; // chosen for the first one
    bool is_requested;                 // for
    struct ct_solver_costs costs;      // of what could be chosen for the first one
    long nmade;
    bool has_solver;   // form[0] is for the rows and columns of now
    bool is_expensive; // matrices are cheaper
    bool
        is_near_singular; // near a singular configuration: pivots are sought at every evaluation
    bool is_crossing;     // stages are projected that steps do not end on: choices stay
    double
        least_cancellation; // of the inertia of a single freedom, of what cancels in it: less leaves accelerations too few digits. 0: any will do
    double left; // the least there has been where less than ten times as much was left  (8.39)
    bool needs_refinement; // the last check wanted a refinement
    bool is_renewed;       // a projection has looked after them since a step ended last
    long nweak; // checks in a row that found the form weak, or projections without one
    int nunchecked; // projections until the next check, as long as the strength stays near that of the last one
    double checked_at, correction_checked; // strength and answer at the last check
    double
        correction; // the largest correction of a coordinate in the last projection for what was open most; 0: nothing was
    struct ct_strength strength; // of the form
    struct ct_solve_counts solves;
    double *a, *lam; // results: u' (nu), lam (nrow)
    // workspace
    double *Jd, *B, *c, *r, *S, *MB, *A, *b, *work, *d, *q, *before;
    int *pivot, *iwork, *column;
};

struct ct_partition *ct_partition_create(struct ct_arena *arena, struct ct_ctx *ctx,
                                         struct ct_evaluator *m);

/// Forms of this kind only, whatever they cost; NULL: matrices only. Before rows and columns are chosen.
void ct_partition_use_solver(struct ct_partition *s, const struct ct_solver_kind *kind);
/// Units of rows, from the levers that they have at the last ct_evaluator_constraint.  (8.42)
void ct_partition_find_units(struct ct_partition *s);
/// Matrices only: accelerations then depend on nothing that was done before.
void ct_partition_use_dense_only(struct ct_partition *s);
/// Operations of one ct_partition_accelerate.
double ct_partition_operations(const struct ct_partition *s);
/// Choose rows and columns anew at the evaluator's input. False with a diagnostic if the mass matrix
/// leaves a freedom without inertia.
bool ct_partition_choose(struct ct_partition *s);
/// u' into s->a and q' at the evaluator's input, in closed form where that is sound.
enum ct_eval ct_partition_solve(struct ct_partition *s);
/// The same at t, y, into the evaluator's input, too. CT_EVAL_RETRY if they are not finite.
enum ct_eval ct_partition_accelerate_at(struct ct_partition *s, double t, const double *y);
/// u' into s->a from M, Q, J, gam of the last ct_evaluator_dynamics.
enum ct_eval ct_partition_accelerate(struct ct_partition *s);
/// left (nu, out): the inertia against each independent speed that `follows` (nu) does not name, while those that it names are
/// free to follow, at the last ct_evaluator_dynamics: pivots of B' M B where the latter are eliminated first, as far as they are
/// positive, and the first that is not. NaN for other speeds. False if J_d is singular.
bool ct_partition_inertias(struct ct_partition *s, const bool *follows, double *left);
/// Minimum-norm multipliers into s->lam at the evaluator's input; s->a holds its u'.  (section 6.5)
void ct_partition_multipliers(struct ct_partition *s);
/// Multipliers lam (rank, out) of the kept rows alone, after ct_partition_accelerate: J_d' lam = (M u' - Q)_d.
void ct_partition_retained_multipliers(struct ct_partition *s, double *lam);
/// Choose anew if J_d, as last factored, has worn. For runs that do not project; J is that of the evaluator's input.
void ct_partition_renew(struct ct_partition *s);
/// The same at the end of a step to y at t, where accelerations have just been found. Where a projection ended it there is nothing
/// to do.
void ct_partition_renew_after_step(struct ct_partition *s, double t, const double *y);
/// Move q, u in y onto the constraints, independent coordinates held where J_d allows.  (6.3)
enum ct_eval ct_partition_project(struct ct_partition *s, double t, double *y);
/// The same for a look at another state, which leaves nothing behind but the evaluator's input and last values: choices stay. False if it
/// comes to no place where loops are closed, or where dense factors cost more than steps do.
bool ct_partition_close_loops(struct ct_partition *s, double t, double *y);
/// Is there a measure of how near J is to losing rank? Not where joints close no loop, as it keeps its rank there on any trees; not of large systems with redundant rows, where it would cost more
/// than the steps.
bool ct_partition_has_pivot(const struct ct_partition *s);
/// How near J is to losing rank at the last ct_evaluator_constraint: the smallest pivot of J_d, times the largest entry of B
/// where that is above 1, small where J loses rank, not where another choice of columns would do. With redundant rows, of
/// which the kept ones may lose rank where the others do not, the smallest of the first `rank` singular values of J. To be
/// compared with what it is elsewhere on the motion.
double ct_partition_pivot(struct ct_partition *s);
/// The smallest pivot of J_d alone there, to all digits; infinite of large systems.
double ct_partition_retained_pivot(struct ct_partition *s);
/// Is it between the two? Cheaper than to find it where rows are redundant, false where that is not certain or where they
/// are not.
bool ct_partition_pivot_is_between(struct ct_partition *s, double low, double high);
/// J as it is seen from other places of the motion.
struct ct_tangent_basis {
    int rank;              // 0: nothing is known
    int side;              // the sign of det [J N; T' 0] with the T and N of the same place
    double *T;             // (nu x free) tangents, J T = 0
    double *N;             // (nrow x redundant) what annihilates J, N'J = 0
    size_t room_T, room_N; // entries there is room for
};
struct ct_tangent_basis *ct_tangent_basis_create(struct ct_arena *arena);
/// Where rows and columns have been chosen: room for as much as J has rank, or more; nothing is known as yet.
void ct_tangent_basis_reserve(struct ct_partition *s, struct ct_tangent_basis *v);
/// The view from the last ct_evaluator_constraint, after ct_partition_pivot. Nothing of a large system.
void ct_tangent_basis_find(struct ct_partition *s, struct ct_tangent_basis *v);
/// Has J lost rank, by an odd number in all, on the way from one to the other, whatever rows and columns have been chosen in
/// the meantime? False if either is not known.  (8.40)
bool ct_singularity_test_sign_changed(struct ct_partition *s,
                                      const struct ct_tangent_basis *from,
                                      const struct ct_tangent_basis *to);
/// At the last ct_evaluator_constraint, beside a place where J loses rank: x (rank, out) = (J_d J_d')^-1 v for a v without
/// meaning, which has come into null(J') of that place, and log |det J_d|, or with redundant rows of the product of the singular values. False where that costs too much.
bool ct_partition_dependence(struct ct_partition *s, double *x, double *log_det);
/// null(J') at the last ct_evaluator_constraint, which must be the last until vectors are found; in a.  (section 6.5)
struct ct_null_space *ct_null_space_create(struct ct_arena *a, struct ct_partition *s);
/// z (nrow, out) = the unit vector of `row` less its part in the range of J: a vector of null(J'), so that
/// lam + z holds as well as lam. Zero (to round-off) where the multiplier is unique.
void ct_null_space_vector(struct ct_null_space *v, int row, double *z);
/// Which multipliers are unique, into s->is_unique: rows of null(J') that vanish.  (section 6.5)
void ct_partition_uniqueness(struct ct_partition *s, struct ct_null_space *v);
/// Speeds after a jump: u (nu, out) of W u = w + J' Lam, J u + Phi_t = 0 where the evaluator is. W (nu x nu)  (8.5)
enum ct_eval ct_partition_impulse(struct ct_partition *s, const double *W, const double *w,
                                  double *u);

#endif
