// Switches of a run: which side each comparison is on, when it changes.
#ifndef CT_SOLVE_EVALUATOR_SWITCH_STATE_H
#define CT_SOLVE_EVALUATOR_SWITCH_STATE_H

#include "solve/evaluator/evaluator.h"

/// Sides at t, y; where g is zero the later side counts, found by following g along the derivative
/// dy (nq + nu; NULL: time alone moves).
void ct_switches_start(struct ct_evaluator *m, double t, const double *y, const double *dy);

/// t into the input, and the modes of time as they are then.
void ct_switches_of_time(struct ct_evaluator *m, double t);

/// A state mode whose root function is zero here and that the motion along dy leaves to the side
/// where the mode is wrong: forces on both sides lead back. Its index, or -1.
int ct_switches_find_sticking(struct ct_evaluator *m, double t, const double *y,
                              const double *dy);

/// Are the knots of a table kinks for methods of this order? Those of linear tables are, and of
/// cubic ones, whose third derivative jumps, for high orders.
bool ct_table_has_kinks(const struct ct_table *table, int order);
/// All times in (t0, t1] at which something changes by time alone: modes of time, knots of tables
/// that are kinks for methods of this order. Ascending; the list lives in a. Changes closer than
/// (t1 - t0)/4096 to each other may be missed in pairs.
size_t ct_time_events(struct ct_arena *a, struct ct_evaluator *m, int order, double t0,
                      double t1, double **time);

/// t, but before an event that is pending what holds before it counts, also at its very instant:
/// the knots of linear tables have no modes that could hold their slopes.
double ct_time_just_before(double t, double pending);

#endif
