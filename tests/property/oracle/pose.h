// Rotations and poses of rigid bodies, on top of vector.h.
//
// A rotation matrix is stored by columns: column i is axis i of the turned frame in axes of the
// reference frame.
#ifndef CT_TEST_ORACLE_POSE_H
#define CT_TEST_ORACLE_POSE_H

#include "tests/property/vector.h"

struct axes {
    struct vector column[3];
};

/// Where a frame stands and how it is turned.
struct pose {
    struct vector at;
    struct axes R;
};

static inline struct vector scaled(double f, struct vector a)
{
    return plus((struct vector){{0, 0, 0}}, f, a);
}

static inline struct vector unit(struct vector a)
{
    return scaled(1 / norm(a), a);
}

/// R v: components in the turned frame -> in the reference frame.
static inline struct vector turned(struct axes R, struct vector v)
{
    struct vector out = {{0, 0, 0}};
    for (int i = 0; i < 3; i++)
        out = plus(out, v.e[i], R.column[i]);
    return out;
}

/// R' v
static inline struct vector turned_back(struct axes R, struct vector v)
{
    return (struct vector){{dot(R.column[0], v), dot(R.column[1], v), dot(R.column[2], v)}};
}

/// A B
static inline struct axes product(struct axes A, struct axes B)
{
    struct axes out;
    for (int i = 0; i < 3; i++)
        out.column[i] = turned(A, B.column[i]);
    return out;
}

/// A' B
static inline struct axes relative(struct axes A, struct axes B)
{
    struct axes out;
    for (int i = 0; i < 3; i++)
        out.column[i] = turned_back(A, B.column[i]);
    return out;
}

static inline struct axes same_axes(void)
{
    return (struct axes){{{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}}};
}

/// Rotation about a unit vector (Rodrigues): v cos + (n x v) sin + n (n . v) (1 - cos).
static inline struct axes rotation(struct vector n, double angle)
{
    struct axes out;
    const struct axes one = same_axes();
    for (int i = 0; i < 3; i++) {
        const struct vector v = one.column[i];
        out.column[i] = plus(plus(scaled(cos(angle), v), sin(angle), cross(n, v)),
                             dot(n, v) * (1 - cos(angle)), n);
    }
    return out;
}

/// Rotation by a rotation vector: about its direction by its length.
static inline struct axes rotation_by(struct vector phi)
{
    const double angle = norm(phi);
    return angle > 0 ? rotation(scaled(1 / angle, phi), angle) : same_axes();
}

/// The rotation vector of a small rotation, from the antisymmetric part of R: right to first order.
static inline struct vector small_rotation(struct axes R)
{
    const struct vector *c = R.column;
    return (struct vector){{(c[1].e[2] - c[2].e[1]) / 2, (c[2].e[0] - c[0].e[2]) / 2,
                            (c[0].e[1] - c[1].e[0]) / 2}};
}

/// Rz(angle[0]) Ry(angle[1]) Rx(angle[2]), as `rotate: [[z, a], [y, b], [x, c]]` of a model file.
static inline struct axes from_angles(const double angle[3])
{
    const struct axes one = same_axes();
    return product(
        rotation(one.column[2], angle[0]),
        product(rotation(one.column[1], angle[1]), rotation(one.column[0], angle[2])));
}

static inline void to_angles(struct axes R, double angle[3])
{
    const struct vector *c = R.column;
    angle[0] = atan2(c[0].e[1], c[0].e[0]);
    angle[1] = atan2(-c[0].e[2], hypot(c[0].e[0], c[0].e[1]));
    angle[2] = atan2(c[1].e[2], c[2].e[2]);
}

/// Rotation matrix of a unit quaternion, scalar first.
static inline struct axes from_quaternion(const double p[4])
{
    const double w = p[0], x = p[1], y = p[2], z = p[3];
    return (struct axes){
        {{{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)}},
         {{2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)}},
         {{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}}}};
}

/// Frame b, given in a, in the frame that a is given in.
static inline struct pose composed(struct pose a, struct pose b)
{
    return (struct pose){plus(a.at, 1, turned(a.R, b.at)), product(a.R, b.R)};
}

/// Frame b in frame a, both given in the same frame.
static inline struct pose seen_from(struct pose a, struct pose b)
{
    return (struct pose){turned_back(a.R, plus(b.at, -1, a.at)), relative(a.R, b.R)};
}

#endif
