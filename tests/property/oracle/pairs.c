// See placing.h: joints between the same two bodies.
//
// A motion is chosen first, then joint types that all allow it, placed so that they do.
#include "tests/property/oracle/placing.h"

enum shared {
    TURN,        // about a line
    SLIDE,       // along a direction
    SCREW_ALONG, // along a line with one pitch
    TURN_SLIDE,  // about and along a line
    BALL,        // about a point
    IN_PLANE,    // all motion of a plane
    COPY,        // whatever a joint allows: the second is the first once more
    SHARED
};

// About one line: revolutes and cylinders on it, balls and universal joints with their centre on
// it, planes across it, rods that begin on it.
static enum joint_type place_turn(struct draw *d, struct spot *spot, const struct style *style)
{
    static const enum joint_type types[]
        = {REVOLUTE, REVOLUTE, CYLINDRICAL, SPHERICAL, UNIVERSAL, UNIVERSAL, PLANAR, DISTANCE};
    const enum joint_type type = types[one_of(d, style->is_flat ? 2 : 8)];
    const struct vector n = spot->axis;
    if (type == PLANAR)
        spot->at = plus(spot->at, style->size * between(d, 0.1, 0.6), across(d, n));
    if (type == DISTANCE)
        spot->second = direction(d);
    if (type == UNIVERSAL && happens(d, 0.5)) { // b on the line, a anywhere
        spot->second = n;
        do
            spot->axis = direction(d);
        while (fabs(dot(spot->axis, n)) > 0.8);
    } else if (type == UNIVERSAL && happens(d, 0.5)) { // axes not at right angles
        spot->second = unit(plus(spot->second, 0.5, n));
    }
    return type;
}

// Along one direction: wherever the joints are; planes contain it.
static enum joint_type place_slide(struct draw *d, struct spot *spot, const struct style *style)
{
    static const enum joint_type types[] = {PRISMATIC, PRISMATIC, PLANAR, CYLINDRICAL};
    const enum joint_type type = types[one_of(d, style->is_flat ? 3 : 4)];
    spot->at = plus(spot->at, 1, somewhere(d, style->size));
    if (type == PLANAR)
        spot->axis = style->is_flat ? style->tilt.column[2] : across(d, spot->axis);
    return type;
}

static enum joint_type place(struct draw *d, enum shared shared, struct spot *spot,
                             const struct style *style)
{
    switch (shared) {
    case TURN:
        return place_turn(d, spot, style);
    case SLIDE:
        return place_slide(d, spot, style);
    case SCREW_ALONG:
        return happens(d, 0.6) ? SCREW : CYLINDRICAL;
    case TURN_SLIDE:
        return CYLINDRICAL;
    case BALL:
        spot->axis = direction(d);
        spot->second = across(d, spot->axis);
        return happens(d, 0.5) ? SPHERICAL : UNIVERSAL;
    default:
        spot->at = plus(spot->at, 1, somewhere(d, style->size));
        return PLANAR;
    }
}

static void add_copies(struct scene *s, struct draw *d, int from, int to, int n,
                       const struct style *style)
{
    static const enum joint_type types[]
        = {REVOLUTE, PRISMATIC, WELD,      DISTANCE, CYLINDRICAL,
           SCREW,    UNIVERSAL, SPHERICAL, PLANAR,   CURVE};
    const struct vector axis = direction(d);
    const struct spot spot = {somewhere(d, style->size), axis, across(d, axis), style->size};
    const enum joint_type type = types[one_of(d, 10)];
    if (type == DISTANCE || type == WELD) { // else much is left free, or too little
        const struct spot pin = {spot.at, axis, axis, 0};
        add_joint(s, d, type == WELD ? WELD : SPHERICAL, from, to, &pin, style);
    }
    const struct joint first = *add_joint(s, d, type, from, to, &spot, style);
    for (int i = 1; i < n; i++)
        s->joint[s->njoint++] = first;
}

static enum shared draw_shared(struct draw *d, const struct style *style)
{
    static const enum shared often[]
        = {TURN,  TURN,        TURN,       TURN, TURN,     TURN, SLIDE,
           SLIDE, SCREW_ALONG, TURN_SLIDE, BALL, IN_PLANE, COPY};
    return style->is_flat ? (enum shared)one_of(d, 2) : often[one_of(d, 13)];
}

static void add_pair(struct scene *s, struct draw *d, int from, int to, int n,
                     const struct style *style)
{
    const enum shared shared = draw_shared(d, style);
    struct vector p = somewhere(d, 0.6 * style->size), axis = direction(d);
    const double pitch = style->size * between(d, 0.3, 1);
    const bool is_on_line = shared == TURN || shared == SCREW_ALONG || shared == TURN_SLIDE;
    if (shared == COPY) {
        add_copies(s, d, from, to, n, style);
        return;
    }
    if (style->is_flat) {
        const double angle = between(d, -3, 3);
        p.e[2] = 0;
        axis = shared == SLIDE ? (struct vector){{cos(angle), sin(angle), 0}}
                               : style->tilt.column[2];
    }
    for (int i = 0; i < n; i++) {
        struct spot spot = {p, axis, across(d, axis), pitch};
        if (is_on_line && !style->is_flat)
            spot.at = plus(p, style->size * between(d, -0.6, 0.6), axis);
        const enum joint_type type = place(d, shared, &spot, style);
        if (style->is_flat)
            spot.at.e[2] = 0;
        add_joint(s, d, type, from, to, &spot, style);
    }
}

void draw_pairs(struct scene *s, struct draw *d, const struct style *style)
{
    const int n = happens(d, 0.6) ? 2 : 2 + one_of(d, 3);
    for (int b = 1; b < n; b++) {
        add_body(s, d, style);
        if (b == 1 && n == 3 && !style->is_flat) { // a post that the pair stands on
            const struct spot spot
                = {somewhere(d, style->size), direction(d), direction(d), style->size};
            add_joint(s, d, happens(d, 0.5) ? WELD : REVOLUTE, 0, 1, &spot, style);
        } else {
            add_pair(s, d, b == 1 || happens(d, 0.7) ? b - 1 : 0, b, happens(d, 0.8) ? 2 : 3,
                     style);
        }
    }
}
