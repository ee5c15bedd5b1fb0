// Small mechanisms for property tests, with every type of joint and force, written as model text.
//
// Ground is reached through ground's points only and forces act in axes that move along, so that a
// whole mechanism can be moved and turned; its lines can be written in any order, its joints in
// either sense.
#ifndef CT_TEST_PROPERTY_MECHANISM_H
#define CT_TEST_PROPERTY_MECHANISM_H

#include "base/arena.h"

#include <stdbool.h>
#include <stddef.h>

enum { MOST_LINES = 10 };

struct ground_point {
    const char *name;
    double at[3], axis[3], angle;
};

struct joint_line {
    const char *name, *from, *to, *rest;
};

struct mechanism {
    const char *name;
    double gravity[3];
    struct ground_point point[4];
    const char *body[MOST_LINES];
    struct joint_line joint[MOST_LINES];
    const char *force[MOST_LINES];
    bool is_driven;       // has motion drivers
    bool is_planar;       // shall be recognised as planar
    bool is_irreversible; // a joint swapped is another mechanism
};

/// x -> R x + p with R = Rot(axis, angle).
struct rigid_motion {
    double p[3], axis[3], angle;
};

extern const struct mechanism mechanisms[];
extern const size_t nmechanism;

/// Model text. move: may be NULL; reversed: bit set of joints with from and to exchanged; shuffle:
/// lines in random order.
const char *mechanism_text(struct ct_arena *a, const struct mechanism *m,
                           const struct rigid_motion *move, unsigned reversed, bool shuffle);
/// Rot(axis, angle) v for a unit vector axis.
void rigid_turn(const struct rigid_motion *move, const double v[3], double out[3]);

#endif
