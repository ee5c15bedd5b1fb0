// See placing.h: mechanisms with loops.
#include "tests/property/oracle/placing.h"

enum family {
    PARALLEL_AXES, // a planar mechanism somewhere in space, with cylinders and balls among its pins
    ONE_POINT,     // axes through one point
    ONE_LINE,      // everything on one axis
    SLIDES_ONLY,    // nothing turns
    SAME_DIRECTION, // parallel pins and screws, slides in any direction
    FEW_SHARED,     // two directions, two places
    GENERAL,        // all in general position
    FAMILIES
};

struct shared_geometry {
    enum family family;
    struct vector direction[2], place[2];
};

static enum joint_type type_of(struct draw *d, enum family family)
{
    static const enum joint_type parallel[]
        = {REVOLUTE, REVOLUTE, REVOLUTE, REVOLUTE, PRISMATIC, PLANAR, CYLINDRICAL, SPHERICAL},
        point[] = {REVOLUTE, REVOLUTE, REVOLUTE, UNIVERSAL, SPHERICAL},
        line[] = {REVOLUTE, PRISMATIC, CYLINDRICAL, SCREW, CYLINDRICAL},
        slide[] = {PRISMATIC, PRISMATIC, PRISMATIC, PLANAR, CYLINDRICAL},
        same[] = {REVOLUTE, REVOLUTE, SCREW, PRISMATIC, CYLINDRICAL, PLANAR},
        all[] = {REVOLUTE,  REVOLUTE,  PRISMATIC, CYLINDRICAL, SCREW,
                 UNIVERSAL, SPHERICAL, PLANAR,    CURVE,       FREE};
    switch (family) {
    case PARALLEL_AXES:
        return parallel[one_of(d, 8)];
    case ONE_POINT:
        return point[one_of(d, 5)];
    case ONE_LINE:
        return line[one_of(d, 5)];
    case SLIDES_ONLY:
        return slide[one_of(d, 5)];
    case SAME_DIRECTION:
        return same[one_of(d, 6)];
    default:
        return all[one_of(d, 10)];
    }
}

static struct spot spot_of(struct draw *d, const struct shared_geometry *g,
                           enum joint_type type, const struct style *style)
{
    const struct vector n = g->direction[0], p = g->place[0], at = somewhere(d, style->size);
    struct spot spot = {at, n, across(d, n), style->size * between(d, 0.3, 1)};
    switch (g->family) {
    case PARALLEL_AXES:
        if (type == PRISMATIC)
            spot.axis = across(d, n);
        break;
    case ONE_POINT:
        spot.at = p;
        spot.axis = direction(d);
        spot.second = direction(d);
        break;
    case ONE_LINE:
        spot.at = plus(p, style->size * between(d, -1, 1), n);
        break;
    case SLIDES_ONLY:
        spot.axis = direction(d);
        break;
    case SAME_DIRECTION:
        if (type == PRISMATIC)
            spot.axis = direction(d);
        break;
    case FEW_SHARED:
        spot.at = g->place[one_of(d, 2)];
        spot.axis = g->direction[one_of(d, 2)];
        spot.second = happens(d, 0.5) ? direction(d) : across(d, spot.axis);
        if (type == PLANAR && happens(d, 0.5))
            spot.axis = across(d, spot.axis);
        break;
    default:
        spot.axis = direction(d);
        spot.second = direction(d);
        break;
    }
    if (style->is_flat) {
        spot.at.e[2] = 0;
        if (type == PRISMATIC) {
            const double angle = between(d, -3, 3);
            spot.axis = (struct vector){{cos(angle), sin(angle), 0}};
        }
    }
    if (type == UNIVERSAL && fabs(dot(spot.axis, spot.second)) > 0.8)
        spot.second = across(d, spot.axis);
    return spot;
}

// `n` bodies on body `root`: a tree of joints, and `chords` joints more.
static void add_cluster(struct scene *s, struct draw *d, enum family family, int root, int n,
                        int chords, const struct style *style)
{
    struct shared_geometry g = {.family = family};
    const int first = s->nbody;
    for (int i = 0; i < 2; i++) {
        g.direction[i] = style->is_flat || i == 0 ? style->tilt.column[2] : direction(d);
        g.place[i] = somewhere(d, 0.6 * style->size);
    }
    for (int i = 0; i < n + chords; i++) {
        const bool is_chord = i >= n;
        int from, to;
        if (!is_chord) {
            from = i == 0 || happens(d, 0.3) ? root : s->nbody - 1 - one_of(d, i < 2 ? 1 : 2);
            to = s->nbody;
            add_body(s, d, style);
        } else {
            to = first + one_of(d, n);
            do
                from = happens(d, 0.4) ? root : first + one_of(d, n);
            while (from == to);
        }
        if (is_chord && happens(d, 0.5)) {
            const int k = from;
            from = to;
            to = k;
        }
        enum joint_type type = type_of(d, family);
        if (is_chord && !style->is_flat && happens(d, 0.1))
            type = DISTANCE;
        if (happens(d, 0.04))
            type = WELD;
        if (style->is_flat && type != PRISMATIC && type != PLANAR && type != WELD)
            type = REVOLUTE;
        const struct spot spot = spot_of(d, &g, type, style);
        add_joint(s, d, type, from, to, &spot, style);
    }
}

// k equal cranks between `root` and one new body.
static void add_parallelogram(struct scene *s, struct draw *d, int root, int k,
                              const struct style *style)
{
    const struct vector n = style->tilt.column[2];
    struct vector arm = cross(n, direction(d));
    arm = scaled(style->size * between(d, 0.3, 0.8), unit(arm));
    const int coupler = s->nbody;
    add_body(s, d, style);
    for (int i = 0; i < k; i++) {
        struct spot spot = {somewhere(d, style->size), n, arm, 0};
        if (style->is_flat)
            spot.at.e[2] = 0;
        const int crank = s->nbody;
        add_body(s, d, style);
        const bool is_ball = !style->is_flat && happens(d, 0.1);
        add_joint(s, d, REVOLUTE, root, crank, &spot, style);
        spot.at = plus(spot.at, 1, arm);
        add_joint(s, d, is_ball ? SPHERICAL : REVOLUTE, crank, coupler, &spot, style);
    }
}

void draw_loops(struct scene *s, struct draw *d, const struct style *style)
{
    const int clusters = 1 + one_of(d, 3);
    for (int c = 0; c < clusters && s->nbody < 8; c++) {
        const int root = one_of(d, s->nbody);
        if (happens(d, 0.15)) {
            add_parallelogram(s, d, root, 2 + one_of(d, 3), style);
        } else {
            const int n = 2 + one_of(d, 3);
            const enum family family
                = style->is_flat ? PARALLEL_AXES : (enum family)one_of(d, FAMILIES);
            add_cluster(s, d, family, root, n, 1 + one_of(d, n > 2 ? 2 : 1), style);
        }
    }
}

void draw_plain(struct scene *s, struct draw *d, const struct style *style)
{
    const int n = 2 + one_of(d, 5);
    add_cluster(s, d, style->is_flat ? PARALLEL_AXES : GENERAL, 0, n, one_of(d, 3), style);
}
