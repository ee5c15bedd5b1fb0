// Loops that beams must be bent to close.  (formulation 9.1)
#ifndef CT_SOLVE_BEND_H
#define CT_SOLVE_BEND_H

#include "solve/balance.h"

/// What is open now becomes the gaps of s.
void ct_gaps_keep(struct ct_balance *s);
/// A part of them is open; of turns the same axis and a part of the angle.
void ct_gaps_set(struct ct_balance *s, double part);
/// Largest |phi| of all rows, those that depend on others included; its row.
double ct_gaps_left(struct ct_balance *s, size_t *row);
/// From the open start to closed loops, in equilibrium with what is still open all the way: part by part, by Newton's
/// method, and where that finds nothing stable even for a small part, down the energy. False if it gets stuck.
bool ct_gaps_close(struct ct_balance *s, struct ct_arena *a);

#endif
