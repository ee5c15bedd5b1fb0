// Bodies by chance, and joints put where they are wanted: what pairs.c and loops.c build from.
#ifndef CT_TEST_ORACLE_PLACING_H
#define CT_TEST_ORACLE_PLACING_H

#include "tests/property/oracle/draw.h"
#include "tests/property/oracle/scene.h"

/// What a whole mechanism shares.
struct style {
    bool
        // all in the x-y plane with axes of ground: the engine can see that the mechanism is planar
        is_flat;
    struct axes tilt; // of the plane, or of the common direction
    double size;      // [m]
};

/// Where a joint is wanted, in ground axes: a point, its axis, b of a universal joint; the pitch of
/// a screw.
struct spot {
    struct vector at, axis, second;
    double pitch;
};

/// One body more, by chance.
void add_body(struct scene *s, struct draw *d, const struct style *style);

/// One joint more, at a random position q: `from` meets the spot, and the frame of `to` lies where
/// the joint's motion takes it. A distance goes from the spot's point along `second`. Flat
/// mechanisms have no universal joint: it is a revolute.
struct joint *add_joint(struct scene *s, struct draw *d, enum joint_type type, int from, int to,
                        const struct spot *spot, const struct style *style);

/// pairs.c: two or three joints between two bodies, which all allow one motion, on top of each
/// other.
void draw_pairs(struct scene *s, struct draw *d, const struct style *style);
/// loops.c: loops whose joints share axes and places; trees and loops in general position.
void draw_loops(struct scene *s, struct draw *d, const struct style *style);
void draw_plain(struct scene *s, struct draw *d, const struct style *style);

#endif
