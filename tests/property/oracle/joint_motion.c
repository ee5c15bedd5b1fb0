// See joint_motion.h.
#include "tests/property/oracle/joint_motion.h"

static const struct vector none = {{0, 0, 0}};

static void turn_about(struct joint_motion *m, int i, struct vector axis, double angle)
{
    m->pose.R = rotation(axis, angle);
    m->angular[i] = axis;
}

static void slide_along(struct joint_motion *m, int i, struct vector axis, double length)
{
    m->pose.at = plus(m->pose.at, length, axis);
    m->linear[i] = axis;
}

// R = Rot(a, q1) Rot(b, q2): w = a u1 + b' u2 with b' = Rot(a, q1) b, and b' turns with a u1.
static void turn_twice(struct joint_motion *m, struct vector a, struct vector b,
                       const double *q, const double *u)
{
    const struct axes first = rotation(a, q[0]);
    m->pose.R = product(first, rotation(b, q[1]));
    m->angular[0] = a;
    m->angular[1] = turned(first, b);
    m->angular_bias = scaled(u[0] * u[1], cross(a, m->angular[1]));
}

// Speeds are the angular velocity w in axes of `to`: R w', and the rate of R w is R w' + w x w.
static void turn_freely(struct joint_motion *m, int i, const double quaternion[4])
{
    m->pose.R = from_quaternion(quaternion);
    for (int k = 0; k < 3; k++)
        m->angular[i + k] = m->pose.R.column[k];
}

// place (0.3 c, 0.1 c^2, 0), axes Rz(c) Rx(c/2): w = (z + x'/2) u with x' = Rz(c) x
static void follow_curve(struct joint_motion *m, double c, double u)
{
    const struct vector x = {{1, 0, 0}}, z = {{0, 0, 1}};
    const struct axes first = rotation(z, c);
    m->pose.at = (struct vector){{0.3 * c, 0.1 * c * c, 0}};
    m->pose.R = product(first, rotation(x, c / 2));
    m->linear[0] = (struct vector){{0.3, 0.2 * c, 0}};
    m->linear_bias = (struct vector){{0, 0.2 * u * u, 0}};
    m->angular[0] = plus(z, 0.5, turned(first, x));
    m->angular_bias = scaled(u * u / 2, cross(z, turned(first, x)));
}

// Directions of the lengths: normal x: y, z; y: z, x; z: x, y.
static void move_in_plane(struct joint_motion *m, struct vector n, const double *q)
{
    const struct axes e = same_axes();
    int along = 0;
    while (along < 2 && fabs(n.e[along]) < 0.5)
        along++;
    slide_along(m, 0, e.column[(along + 1) % 3], q[0]);
    slide_along(m, 1, e.column[(along + 2) % 3], q[1]);
    turn_about(m, 2, n, q[2]);
}

struct joint_motion joint_motion(const struct joint *j, const double *q, const double *u)
{
    const double two_pi = 6.283185307179586476925286766559;
    const struct vector n = unit(j->axis);
    struct joint_motion m = {.pose = {none, same_axes()}};
    switch (j->type) {
    case REVOLUTE:
        turn_about(&m, 0, n, q[0]);
        break;
    case PRISMATIC:
        slide_along(&m, 0, n, q[0]);
        break;
    case CYLINDRICAL:
        slide_along(&m, 0, n, q[0]);
        turn_about(&m, 1, n, q[1]);
        break;
    case SCREW:
        turn_about(&m, 0, n, q[0]);
        m.pose.at = scaled(j->pitch / two_pi * q[0], n);
        m.linear[0] = scaled(j->pitch / two_pi, n);
        break;
    case UNIVERSAL:
        turn_twice(&m, n, unit(j->second), q, u);
        break;
    case SPHERICAL:
        turn_freely(&m, 0, q);
        break;
    case PLANAR:
        move_in_plane(&m, n, q);
        break;
    case FREE:
        for (int i = 0; i < 3; i++)
            slide_along(&m, i, same_axes().column[i], q[i]);
        turn_freely(&m, 3, q + 3);
        break;
    case CURVE:
        follow_curve(&m, q[0], u[0]);
        break;
    default: // a weld; distances and gears have no motion of their own
        break;
    }
    return m;
}
