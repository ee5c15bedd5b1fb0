// Random numbers of the generator: the same on every machine.
#ifndef CT_TEST_ORACLE_DRAW_H
#define CT_TEST_ORACLE_DRAW_H

#include "tests/property/oracle/pose.h"

#include <stdbool.h>
#include <stdint.h>

struct draw {
    uint64_t state;
};

/// Uniform in [low, high).
double between(struct draw *d, double low, double high);
/// 0 .. n - 1
int one_of(struct draw *d, int n);
bool happens(struct draw *d, double probability);

/// In a cube from -r to r.
struct vector somewhere(struct draw *d, double r);
/// Unit vectors: any, and one across the unit vector n.
struct vector direction(struct draw *d);
struct vector across(struct draw *d, struct vector n);
struct axes orientation(struct draw *d);

#endif
