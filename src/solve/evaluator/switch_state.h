// Switches of a run: the side of each comparison and the times of its changes.
#ifndef CT_SOLVE_EVALUATOR_SWITCH_STATE_H
#define CT_SOLVE_EVALUATOR_SWITCH_STATE_H

#include "solve/evaluator/evaluator.h"

/// Set the sides at t, y. Where g is zero it is the later side, found by following g along the
/// derivative dy (nq + nu; NULL: only time changes). A g of the state that stays zero along dy
/// is at rest: the side is that of g = 0, as with sign(0) = 0, until g leaves zero
/// (m->at_rest). crossed (nswitch, -1, 0 or 1; NULL: none): the sides of those that have just
/// changed.
void ct_switches_start(struct ct_evaluator *m, double t, const double *y, const double *dy,
                       const signed char *crossed);

/// The largest state in y (nq + nu): a g at rest is zero up to m->at_rest times that.
double ct_switches_size(const struct ct_evaluator *m, const double *y);

/// The sign of g for which switch i has this value, 0 or 1; 0 if g is at rest.
int ct_switches_side(const struct ct_evaluator *m, size_t i, double value);

/// Sets t and the switches of time at t in the input.
void ct_switches_of_time(struct ct_evaluator *m, double t);

/// A switch of the state whose g is zero here and whose side differs from that to which the
/// motion along dy leads. Its index, or -1.
int ct_switches_find_contradicted(struct ct_evaluator *m, double t, const double *y,
                                  const double *dy);
/// Directly after that: set the switches with the same g as switch i to the side to which the
/// motion leads.
void ct_switches_follow(struct ct_evaluator *m, size_t i);

/// Are the knots of a table kinks for methods of this order? Those of linear tables are, and of
/// cubic ones, whose third derivative jumps, for high orders.
bool ct_table_has_kinks(const struct ct_table *table, int order);
/// All time events in (t0, t1]: changes of switches of time, and knots of tables that are kinks for
/// methods of this order. Ascending; the list lives in a. Two changes closer to each other than (t1
/// - t0)/4096 may both be missed.
size_t ct_time_events(struct ct_arena *a, struct ct_evaluator *m, int order, double t0,
                      double t1, double **time);

/// t, or the last double before it if a time event is pending at t: the state before an event
/// holds up to and at it, since slopes of linear tables are no switches.
double ct_time_just_before(double t, double pending);

#endif
