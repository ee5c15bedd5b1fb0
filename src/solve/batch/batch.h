// SIMD batches: several runs of a parameter study are integrated together, one in each lane of the
// vector registers, each with its own time and step size.
//
//     lane        0        1        2        3
//     y      [ y_0 ][ y_0 ][ y_0 ][ y_0 ]   [ y_1 ] ...      entry i of lane l is at LANES * i + l
//
// All lanes try a step at the same time. Stages, accelerations, error and projection are computed
// for all lanes at once, by generated programs and by small solvers whose innermost loop is over
// the lanes. A step that is rejected in one lane is tried again with a shorter step size while the
// other lanes go on, so no lane waits for the slowest. A lane that has reached the end gets the
// next run. What is rare is done lane by lane with the functions of a single run: the choice of
// rows and columns, the start, the results, and events.
//
// What always holds: the numbers of a member, one run of the study, depend neither on the lane nor
// on the other lanes. Lanes do not handle singular configurations and very small steps: such a
// member is given up and has to be run alone, which reports errors if there are any.
#ifndef CT_SOLVE_BATCH_BATCH_H
#define CT_SOLVE_BATCH_BATCH_H

#include "solve/run/run.h"

// Definition: doubles of a vector. Derived: two groups hide the latency of each other
enum { CT_LANES = 4, CT_BATCH_GROUPS = 2 }; // a worker has up to so many groups of lanes

enum ct_lane_state { CT_LANE_IDLE, CT_LANE_RUNNING, CT_LANE_ARRIVED, CT_LANE_GIVEN_UP };

struct ct_batch;

/// The reason why runs with these options cannot use lanes; NULL: they can.
const char *ct_batch_obstacle(const struct ct_run_options *o);
/// Creates the programs of all lanes, with the back end of the run. Functions over runs are
/// those of the last ntake results. All in a; run must live as long, and from now on uses dense
/// matrices, so that its results for a member do not depend on earlier members.
struct ct_batch *ct_batch_create(struct ct_arena *a, const struct ct_equations *e,
                                 struct ct_run *run, size_t ntake);

/// Called after the run was started with the file's own values: symbolic solvers find their
/// order of pivots there, so that the results of a member do not depend on other members.
/// Without it closed systems cannot use lanes.
void ct_batch_begin(struct ct_batch *s);

/// Put the run, which has just been started, into an idle lane; `o` has its end time and
/// tolerances. False: it has to be run alone.
bool ct_batch_load(struct ct_batch *s, int lane, const struct ct_run_options *o);
enum ct_lane_state ct_batch_state(const struct ct_batch *s, int lane);
/// Try one step in every running lane.
void ct_batch_step(struct ct_batch *s);
/// Results (nresult, out) of a lane at its end time, as the last row of a run alone. False: it
/// has to be run alone.
bool ct_batch_results(struct ct_batch *s, int lane, double *out);
/// Make the lane idle again.
void ct_batch_free(struct ct_batch *s, int lane);

/// Steps of all members so far, evaluations in lanes (each counts once for all lanes).
struct ct_batch_counts {
    long steps, rejected, evaluations;
} ct_batch_counts(const struct ct_batch *s);

#endif
