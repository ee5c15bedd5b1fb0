// Stiffness detection: is the step size of an explicit method limited by stability? The test
// compares the fastest mode of the equations with the motion.
//     fast    |J^2 v|^(1/2), J = df/dy, v from the last test: one iteration of the power method
//     slow    |change of the accelerations| / (h |accelerations|) over one step
//     stiff   step * fast is near the limit of stability though fast is much more than slow, or
//             step * slow is very small, and round-off of positions times fast^2 exceeds the
//             tolerance of the accelerations
// What always holds: a test takes four evaluations, is made every hundred steps, and changes
// nothing in the problem. Positive tests only suggest stiffness: a trial measures whether an
// implicit method is faster.
#ifndef CT_INTEGRATE_STIFFNESS_H
#define CT_INTEGRATE_STIFFNESS_H

#include "integrate/problem.h"

struct ct_stiffness {
    const struct ct_problem *p;
    double rtol;                                        // of outputs
    int first, last;                                    // of y: the accelerations in f
    double *v, *w, *f, *f0, *point, *y0, *quarter, *Jx; // (ny)
    double t0;                                          // time of y0
    long count, next_trial; // steps so far; the number of steps before the next trial
    // results of the last test
    bool
        is_far; // the fastest mode is much faster than the motion, and its speeds are no outputs
    bool is_resolved; // steps resolve the fastest mode, whose rate has stayed about the same
    bool has_decayed; // the fastest mode has decayed below the tolerance
    int in_a_row;     // positive tests in a row
    bool
        is_unstable; // steps are limited by stability, at a rate that has stayed about the same

    int similar_rates; // tests in a row with about the same rate
    double window_t;   // time of the last test, with its counts
    long window_steps;
    const struct ct_integrate_stats *stats; // of the run, current
    long window_evaluations;
    double fast, slow;          // [1/s]
    double decay;               // decay rate of the fastest mode [1/s]
    double integrated_decay;    // integral of the decay rate since `excited`
    double excited;             // time of the last event, set by the caller
    double step;                // mean step since the test before [s]
    double evaluations;         // mean number for a step since then
    double other_time_per_work; // of the implicit method, for the work of an evaluation  [s]
};

/// The work of operations, in common units.
struct ct_cost {
    double evaluation;    // of f
    double residual;      // of r, phi, v, with its share of the solution for corrections
    double tangent;       // of the derivatives
    double factorization; // of the matrix of an iteration
};

/// The least work of a step of the implicit method with new derivatives and factors.
double ct_cost_step(const struct ct_cost *cost);

/// A trial: a few steps of an implicit method, to measure the time gained for its work.
struct ct_trial {
    struct ct_cost cost;
    const struct ct_integrate_stats *stats; // of the trial, while it runs
    bool must_damp; // the steps before counting damp vibrations that the explicit method kept
    int nstep;
    double start, end;    // from where on, and the end of the run
    double t0, t, spent0; // where counting began, where it is, the work before
    double time_per_work; // of all steps, where a trial does not end
    struct {
        double t, spent; // where it begins, the work before
    } window;            // of the last steps
};

/// rtol: the tolerance of outputs; first, last: the range of speeds in y, after the coordinates.
struct ct_stiffness *ct_stiffness_create(struct ct_arena *a, const struct ct_problem *p,
                                         const struct ct_integrate_stats *stats, double rtol,
                                         int first, int last);

/// The index of the largest speed in the fastest mode at t, y, whose rate is in `fast`. -1: not
/// found.
int ct_stiffness_fastest(struct ct_stiffness *s, double t, const double *y);
/// After each accepted step to t, y; end: of the run. True if a trial is worth its work now: tests
/// were positive and many steps are to come.
bool ct_stiffness_detect(struct ct_stiffness *s, double t, const double *y, double end);
/// Before the first step from t, y of an explicit method: would it take many steps to resolve, to
/// rtol, vibrations that are much faster than the motion? ct_stiffness_time_per_work then refers to
/// such steps.
bool ct_stiffness_predict(struct ct_stiffness *s, double t, const double *y, double end,
                          const struct ct_method *method, double rtol);
/// Was there a test in the last call of ct_stiffness_detect?
bool ct_stiffness_has_tested(const struct ct_stiffness *s);
/// After a test, where steps resolve the fastest mode: the vibration in y (ny), and the same a
/// quarter of a period later. They are J^(p-1) y''/fast^(p+1), with p the order of the method, so
/// that slower modes count in proportion to their error. It takes p + 1 evaluations. False if not
/// found.
bool ct_stiffness_find_vibration(struct ct_stiffness *s, double t, const double *y, int order,
                                 const double **e, const double **later);
/// At the last test, were steps limited by stability, at a rate that has stayed about the same?
bool ct_stiffness_is_unstable(const struct ct_stiffness *s);
/// The longest step that does not amplify errors in the fastest mode; INFINITY where its rate
/// changes between tests.
double ct_stiffness_stable_step(const struct ct_stiffness *s, const struct ct_method *m);
/// The longest step with which an explicit method integrates a vibration of frequency `fast` over
/// `time` with an error rtol of phase and amplitude at the end.  (8.14)
double ct_stiffness_accurate_step(const struct ct_method *method, double fast, double time,
                                  double rtol);
/// After a trial in which the implicit method was slower, at time t, with the work `spent`: no
/// trial before the number of steps has doubled and their work is many times that of the trial.
void ct_stiffness_postpone(struct ct_stiffness *s, double t, double spent,
                           const struct ct_cost *cost);
/// After the implicit method, which advanced by `time_per_work`, has been left: a trial is
/// due as soon as explicit steps gain less.
void ct_stiffness_compare_with(struct ct_stiffness *s, double time_per_work,
                               const struct ct_cost *cost);

/// Time gained for the work of an explicit run between its last two tests.
double ct_stiffness_time_per_work(const struct ct_stiffness *s, const struct ct_cost *cost);

/// After each step of a trial; false: it has come far enough.
bool ct_trial_step(struct ct_trial *r, double t);
/// The work of the whole trial.
double ct_trial_work(const struct ct_trial *r);
/// Time gained for the work of the steps that counted, 0 if there were none.
double ct_trial_time_per_work(const struct ct_trial *r);
/// Called after each step with the implicit method; the run continues the trial. True if the time
/// gained for its work since the last event has fallen below `time_per_work`, that of the explicit
/// method, and the last hundred steps gain no more than the average since the event. Events reset
/// the count, because they may excite vibrations. While these decay the last steps gain more than
/// the average, and the implicit method is kept.
bool ct_trial_is_slower(struct ct_trial *r, double t, double event, double time_per_work);

#endif
