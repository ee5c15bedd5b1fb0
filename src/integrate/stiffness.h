// Stiffness detection: is an explicit run held up by stability? The fastest motion the equations
// are capable of against the motion there is.
//
//     fast    |J^2 v|^(1/2), J = df/dy, v the result of the last test: the power method, one round each test
//     slow    |change of the accelerations| / (h |accelerations|) over one step
//     stiff   step * fast is near the limit of stability though fast is much more than slow, or
//             step * slow is next to nothing and round-off errors of places, times fast^2, are felt in the accelerations
//
// What always holds: a test costs four evaluations and is made every hundred steps; it changes
// nothing in the problem. Suspicion is no proof: a trial finds out whether an implicit method is
// faster.
#ifndef CT_INTEGRATE_STIFFNESS_H
#define CT_INTEGRATE_STIFFNESS_H

#include "integrate/problem.h"

struct ct_stiffness {
    const struct ct_problem *p;
    double rtol;                                          // of outputs
    int first, last;                                      // of y: the accelerations in f
    double *v, *w, *f, *f0, *point, *y0, *quarter, *once; // (ny)
    double t0;                                            // time of y0
    long count, next_trial; // steps; when suspicion is next listened to
    bool
        is_far; // vibrations of that rate need not be followed for their speeds, at the last test
    bool
        is_followed; // steps follow vibrations of that rate, which has lasted, at the last test
    bool is_dead;    // less than the tolerance is left of that motion since it was excited
    int in_a_row;    // tests that were suspicious
    bool
        is_unstable; // steps are held up by stability, at the last test, and that rate has lasted
    int alike;       // tests with about the rate of the one before
    long test_at;    // step after which the rate is looked at again between tests; 0: none
    double window_t; // where the last test was
    long window_steps;
    const struct ct_integrate_stats *stats; // of the run, live
    long window_evaluations;
    double fast, slow;  // of the last test [1/s]
    double decay;       // rate at which the fastest motion dies, at the last test [1/s]
    double died;        // its integral since `excited`
    double excited;     // time of the last event, given
    double step;        // mean step since the test before [s]
    double evaluations; // for a step, since then
    double other_pace;  // time for as much work as an evaluation, by the other method  [s]
};

/// What the parts of a run cost, in common units.
struct ct_cost {
    double evaluation;    // of f
    double residual;      // of r, phi, v, with its share of the solution for corrections
    double tangent;       // of the derivatives
    double factorization; // of the matrix of an iteration
};

/// What a usual step of the implicit method costs, with derivatives and factors of its own.
double ct_cost_step(const struct ct_cost *cost);

/// A few steps of an implicit method, to see how far it gets for its work.
struct ct_trial {
    struct ct_cost cost;
    const struct ct_integrate_stats *stats; // of the trial, while it runs
    bool has_to_damp; // vibrations that the other method has kept, before steps get long
    int nstep;
    double start, end;    // from where on, and the end of the run
    double t0, t, spent0; // where counting began, where it is, the work before
    double pace;          // of all steps, where a trial does not end
    struct {
        double t, spent; // where it begins, the work before
    } window;            // of the last steps
};

/// rtol: what is asked of outputs; first, last: the range of y whose rates are accelerations,
/// behind coordinates.
struct ct_stiffness *ct_stiffness_create(struct ct_arena *a, const struct ct_problem *p,
                                         const struct ct_integrate_stats *stats, double rtol,
                                         int first, int last);

/// The speed, first to last - 1, that moves most in the fastest motion at t, y; its rate is `fast`
/// then. -1: cannot be told.
int ct_stiffness_fastest(struct ct_stiffness *s, double t, const double *y);
/// After each accepted step to t, y; end: of the run. True if a trial is worth its work now: tests
/// were suspicious and there are many steps to come.
bool ct_stiffness_detect(struct ct_stiffness *s, double t, const double *y, double end);
/// Before the first step from t, y of an explicit method: would it make many steps because of
/// vibrations that are far from the motion, if it follows them to rtol? Their pace is that of
/// ct_stiffness_pace then.
bool ct_stiffness_predict(struct ct_stiffness *s, double t, const double *y, double end,
                          const struct ct_method *method, double rtol);
/// Was the step that ct_stiffness_detect saw last one with a test?
bool ct_stiffness_has_tested(const struct ct_stiffness *s);
/// After a test, where such vibrations are followed: what is vibration of y (ny), and what it is a
/// quarter of a period later. From y'', by J^(p-1)/fast^(p+1), p the order of the method: what is
/// slower counts by as much less as it errs less. p + 1 evaluations.
bool ct_stiffness_find_vibration(struct ct_stiffness *s, double t, const double *y, int order,
                                 const double **e, const double **later);
/// Are steps, at the last test, held by the stability of the method alone, with a rate that lasts?
bool ct_stiffness_is_unstable(const struct ct_stiffness *s);
/// The longest step that does not make errors in the fastest motion larger; INFINITY where its rate
/// does not last.
double ct_stiffness_stable_step(const struct ct_stiffness *s, const struct ct_method *m);
/// The longest step with which an explicit method follows a vibration of `fast` for a time so that
/// its phase and size err by rtol at the end, when the errors of all steps have added up.  (8.14)
double ct_stiffness_accurate_step(const struct ct_method *method, double fast, double time,
                                  double rtol);
/// After a trial that was lost, at time t for the work `spent`: not again before the number of
/// steps has doubled, nor before steps have cost many times as much.
void ct_stiffness_postpone(struct ct_stiffness *s, double t, double spent,
                           const struct ct_cost *cost);
/// When the implicit method has been left, which gained as much time for its work: a trial as soon
/// as steps gain less.
void ct_stiffness_compare_with(struct ct_stiffness *s, double pace, const struct ct_cost *cost);

/// Time gained for the work of an explicit run between its last two tests.
double ct_stiffness_pace(const struct ct_stiffness *s, const struct ct_cost *cost);

/// After each step of a trial; false: it has come far enough.
bool ct_trial_step(struct ct_trial *r, double t);
/// All it has cost.
double ct_trial_work(const struct ct_trial *r);
/// Time gained for the work of the steps that counted, 0 if there were none.
double ct_trial_pace(const struct ct_trial *r);
/// After each step of a run that went over to the implicit method, begun as a trial that does not
/// end: true if all of it since the last event has gained less than `pace`. A hard stretch, as
/// where an iteration fails for a while, does not outweigh what was gained before, and no more is
/// spent than the other method would have. An event may excite vibrations: what was gained before
/// tells nothing then, and as long as they die out, so that the last hundred steps gain more than
/// those since the event on average, nothing is lost.
bool ct_trial_has_lost(struct ct_trial *r, double t, double event, double pace);

#endif
