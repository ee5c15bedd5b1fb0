// Singular configurations, in which the constraint Jacobian J loses rank: detection along a motion,
// data for crossing them, starts in or near them, and results within a crossing.
//
//     rank monitor    predicts singular configurations, and records those that were crossed
//     hooks           callbacks of the integrator during a crossing
//     start           tests of an initial state in or near one, and the first step from there
//     dense output    results at samples within a crossing
//
// At a singular configuration the accelerations have a limit along the motion, but the
// equations of motion do not determine it. The integrator crosses the configuration in one step
// (integrate/crossing.h). This folder finds where it is.  (section 6.8)
#ifndef CT_SOLVE_SINGULAR_SINGULAR_H
#define CT_SOLVE_SINGULAR_SINGULAR_H

#include "integrate/stepper.h"
#include "solve/constraint/partition.h"

enum { CT_MOST_SINGULAR = 100 }; // Limit: recorded for the report, which counts the rest

/// Smallest pivot, relative to its largest value so far, at which accelerations are computed
/// without a crossing. Derived: their error grows by 1/0.25^2 = 16 there, a decimal digit.
#define CT_SINGULAR_PIVOT 0.25
/// Steps within which a singular configuration is near. Default: rank tests against a configuration
/// that is seen late. Test: near_singular_slow
#define CT_STEPS_NEAR_SINGULAR 4

/// A singular configuration that was crossed.
struct ct_singular_configuration {
    double t;
    int rank_loss; // of J; 0: unknown, as the system is large
    bool *row;     // (nrow) rows that are dependent there
};

struct ct_rank_monitor {
    struct ct_evaluator *m;
    struct ct_partition *s;
    const double *pending; // time of the next event, owned by the run
    // time to the next singular configuration; INFINITY: none is predicted
    double time_to_singular;
    double output_rtol; // relative tolerance of outputs; 0: unknown
    int rank;           // the largest rank of J so far
    double reach; // time before the singular configuration in which f should not be computed
    double largest_pivot; // so far
    // last pivot / largest_pivot; time and step size of the last state
    double relative_pivot, t, dt;
    double pivot, pivot_rate; // last pivot, 0: unknown; its decrease per second
    bool solver_unchanged;    // at the last state the solver's pivots had not changed
    long switches, nmade;     // of the coordinate partitioning at the last rank test
    double weakest, volume;   // pivots of its solver at the last rank test
    struct ct_tangent_basis *there, *here; // at the last test, at the present one
    long ncrossed;             // singular configurations that fixed steps have crossed
    double t_crossed;          // time of the first of them
    double closest, t_closest; // smallest relative pivot at steps that do not cross; its time
    double pole; // time of the singular configuration on the last crossing; NaN: none
    long npassed;
    struct ct_singular_configuration *passed; // the first of them (CT_MOST_SINGULAR)
    double *last;                             // the last accepted state  (nq + nu)
    double *y, *d, *x;                        // workspace (ny), (nu), (nrow)
};

/// pending: time of the next event, owned by the run; INFINITY if there is none.
struct ct_rank_monitor *ct_rank_monitor_create(struct ct_arena *arena, struct ct_evaluator *m,
                                               struct ct_partition *s, const double *pending);
/// Callbacks for ct_problem.singular, with the monitor as their user data.
struct ct_singularities ct_singular_hooks(struct ct_rank_monitor *w);
/// Reset the monitor before a run.
void ct_rank_monitor_start(struct ct_rank_monitor *w);

/// The step that ended at an accepted state.
struct ct_rank_monitor_step {
    bool is_fixed, is_across; // of fixed size; crosses a singular configuration
};

/// Predict the next singular configuration from an accepted state, up to the next event. False
/// if the step has come near one or passed it without prediction and must be repeated. Fixed
/// steps are not repeated: the monitor only records whether they are near one and how many they
/// have passed.
bool ct_rank_monitor_predict(struct ct_rank_monitor *w, double t, const double *y,
                             const double *dy, const struct ct_rank_monitor_step *step);
/// After a jump of speeds at y, the last accepted state: predict again, as the motion has
/// changed.
void ct_rank_monitor_reset(struct ct_rank_monitor *w, double t, const double *y,
                           const double *dy);
/// Is y, the end of the run, near a singular configuration, predicted or not, or would a step
/// of this size (0 if it is not fixed) pass one? row (nrow, out): the rows that are dependent
/// there; none in a large system.
bool ct_rank_monitor_is_near_singular(struct ct_rank_monitor *w, double t, const double *y,
                                      double step, bool *row);
/// Does J have a lower rank at y, where rows and columns were chosen, than at nearby
/// configurations of the mechanism? y is accurate to the tolerance of closed loops. row (nrow,
/// out): rows that are dependent at y only. Large systems are not tested. The evaluator has its
/// constraints at y afterwards.
bool ct_singular_start_test(struct ct_arena *scratch, const struct ct_partition *s, double t,
                            const double *y, bool *row);
/// At a singular configuration y: the residual of (8.23) relative to the squares of the speeds.
/// freedoms (out): degrees of freedom at y.
double ct_singular_start_misfit(struct ct_arena *scratch, const struct ct_partition *s,
                                double t, const double *y, int *freedoms);
/// The callback set_crossing of struct ct_singularities.
void ct_rank_monitor_set_crossing(struct ct_rank_monitor *w, bool is_crossing);
/// Initial state from the assembly, with rows and columns chosen there.
struct ct_singular_start {
    struct ct_ctx *ctx;
    struct ct_arena *arena;
    const char *file; // of the model
    struct ct_rank_monitor *singular;
    struct ct_evaluator *m;
    struct ct_partition *s;
    const struct ct_problem *p;
    struct ct_integrate_stats *stats;
    const double
        *assembled;       // (ny) as demanded, before the projection onto nearly dependent rows
    const bool *is_given; // (nu) speeds of coordinates with demanded values
    const char *joints; // whose constraints are dependent at the initial state only; NULL: none
    double rtol, atol, output_rtol;
    bool is_fixed;           // steps of fixed size
    double *y, *dy;          // in: the initial state; y out: where steps begin
    double *stage, *scratch; // workspace (ny)
    double t0;               // out: where steps begin, 0 or before
};

/// Move the initial state, y at t0, from a singular configuration to a little before it, along
/// the motion that the speeds select. The same near a singular configuration if it can be
/// crossed; otherwise the state does not change. False with CT_E_STEP_OPEN if the speeds belong
/// to no motion.
bool ct_singular_initial_step(struct ct_singular_start *r);
/// Is the initial state, with its derivative dy, so near a singular configuration that its
/// first step must cross it?
bool ct_singular_starts_near(struct ct_rank_monitor *w, const double *y, const double *dy);
/// Does y equal the initial state, to the accuracy of states near a singular configuration?
bool ct_singular_meets_start(const double *assembled, const double *y, size_t ny);

struct ct_singular_dense_output;

/// For the results of the monitor's evaluator; owned by a.
struct ct_singular_dense_output *ct_singular_dense_output_create(struct ct_arena *a,
                                                                 struct ct_rank_monitor *w);
/// value (nresult, out): results at (t, y) within the crossing interpolated by b. False if they
/// cannot be computed at its stages.
bool ct_singular_dense_output(struct ct_singular_dense_output *s, double t, const double *y,
                              const struct ct_gap_interpolation *b, double *value);

#endif
