// SIMD batches: several runs of a parameter study are integrated together, one in each lane of the
// vector registers, each with its own time and step size.
//
//     lane        0        1        2        3
//     y      [ y_0 ][ y_0 ][ y_0 ][ y_0 ]   [ y_1 ] ...      entry i of lane l is at LANES * i + l
//
// All lanes try a step at the same time: stages, accelerations, error and projection are computed
// for all of them at once, by generated programs in lanes and small solves whose innermost loop is
// over the lanes. What the error or a projection refuses is tried again shorter while the others go
// on, so that no lane waits for the worst; a lane that has arrived is given the next member.
// Choices that are rare and differ (rows, columns, the start, the results) are made one by one, by
// the run that the lanes are made for. So are events: a lane takes a step with one again until it
// ends there, while the others go on.
//
// What always holds: a member's numbers depend on nothing but the member, not on the lane, nor on
// what the other lanes do. A member that meets what lanes do not do (a singular configuration, a
// step that becomes too small) is given up: it has to be run alone, which says what is wrong, if
// anything is.
#ifndef CT_SOLVE_BATCH_BATCH_H
#define CT_SOLVE_BATCH_BATCH_H

#include "solve/run/run.h"

// Definition: doubles of a vector. Derived: two groups hide the latency of each other
enum { CT_LANES = 4, CT_BATCH_GROUPS = 2 }; // a worker has up to so many groups of lanes

enum ct_lane_state { CT_LANE_IDLE, CT_LANE_RUNNING, CT_LANE_ARRIVED, CT_LANE_GIVEN_UP };

struct ct_batch;

/// Why runs with these options cannot be in lanes, or NULL when they can.
const char *ct_batch_obstacle(const struct ct_run_options *o);
/// What is taken over runs is taken from the last ntake results. Programs compiled for lanes, by
/// the back end that the run uses. All in a; run must live as long, and from now on solves by
/// matrices, so that what it does for one member does not depend on the members before.
struct ct_batch *ct_batch_create(struct ct_arena *a, const struct ct_equations *e,
                                 struct ct_run *run, size_t ntake);

/// The run has just been started with the file's own values: closed forms get the order of their
/// pivots there, whoever needs them, so that a member gets the same bits after any others. Without
/// it closed systems cannot be in lanes.
void ct_batch_begin(struct ct_batch *s);

/// Put the run, which has just been started, into an idle lane; `o` with its end time and
/// tolerances. False: it has to be run alone.
bool ct_batch_load(struct ct_batch *s, int lane, const struct ct_run_options *o);
enum ct_lane_state ct_batch_state(const struct ct_batch *s, int lane);
/// One try in every running lane.
void ct_batch_step(struct ct_batch *s);
/// Results (nresult, out) of a lane that has arrived, as the last row of a run alone. False: it has
/// to be run alone.
bool ct_batch_results(struct ct_batch *s, int lane, double *out);
/// The lane is idle again.
void ct_batch_free(struct ct_batch *s, int lane);

/// Steps of all members so far, evaluations in lanes (each counts once for all lanes).
struct ct_batch_counts {
    long steps, rejected, evaluations;
} ct_batch_counts(const struct ct_batch *s);

#endif
