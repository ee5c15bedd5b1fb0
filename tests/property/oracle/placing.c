// See placing.h.
#include "tests/property/oracle/placing.h"
#include "tests/property/oracle/joint_motion.h"

#include <string.h>

void add_body(struct scene *s, struct draw *d, const struct style *style)
{
    struct body *b = &s->body[s->nbody++];
    const struct vector z = {{0, 0, 1}};
    *b = (struct body){.mass = between(d, 0.5, 3)};
    b->pose.at = somewhere(d, style->size);
    b->com = somewhere(d, 0.4 * style->size);
    b->pose.R = orientation(d);
    if (style->is_flat) {
        b->pose.at.e[2] = b->com.e[2] = 0;
        b->pose.R = rotation(z, between(d, -3, 3));
    }
    for (int i = 0; i < 4; i++) { // of four points: as real bodies have it
        const struct vector r = somewhere(d, 0.4 * style->size);
        const double m = b->mass / 4;
        for (int k = 0; k < 3; k++)
            b->inertia[k]
                += m * (dot(r, r) - r.e[k] * r.e[k] + 0.01 * style->size * style->size);
        if (style->is_flat)
            continue;
        b->inertia[3] -= m * r.e[0] * r.e[1];
        b->inertia[4] -= m * r.e[0] * r.e[2];
        b->inertia[5] -= m * r.e[1] * r.e[2];
    }
}

// ---- joints -------------------------------------------------------------------------------------

static double small_angle(struct draw *d)
{
    return between(d, 0.2, 1.2) * (happens(d, 0.5) ? 1 : -1);
}

static void draw_position(struct joint *j, struct draw *d, const struct style *style,
                          bool may_be_zero)
{
    const double scale = may_be_zero ? 0 : 1;
    const double angle = scale * small_angle(d);
    double length[3];
    for (int i = 0; i < 3; i++)
        length[i] = scale * style->size * between(d, -0.5, 0.5);
    const struct vector phi = scaled(scale * between(d, 0.3, 1.2), direction(d));
    const double half = norm(phi) / 2, f = half > 0 ? sin(half) / (2 * half) : 0.5;
    const double p[4] = {cos(half), f * phi.e[0], f * phi.e[1], f * phi.e[2]};
    memset(j->q, 0, sizeof j->q);
    switch (j->type) {
    case PRISMATIC:
        j->q[0] = length[0];
        break;
    case CYLINDRICAL:
        j->q[0] = length[0], j->q[1] = angle;
        break;
    case UNIVERSAL:
        j->q[0] = angle, j->q[1] = scale * between(d, -1, 1);
        break;
    case PLANAR:
        j->q[0] = length[0], j->q[1] = length[1], j->q[2] = angle;
        break;
    case FREE:
        memcpy(j->q, length, sizeof length);
        memcpy(j->q + 3, p, sizeof p);
        break;
    case SPHERICAL:
        memcpy(j->q, p, sizeof p);
        break;
    case CURVE:
        j->q[0] = 0.2 + fabs(angle);
        break;
    default:
        j->q[0] = angle;
        break;
    }
    if (joint_has_quaternion(j->type))
        to_angles(from_quaternion(p), j->rotate);
}

// Axes whose column `along` is `axis`, turned about it by chance.
static struct axes axes_with(struct draw *d, int along, struct vector axis)
{
    struct axes R;
    R.column[along] = axis;
    R.column[(along + 1) % 3] = across(d, axis);
    R.column[(along + 2) % 3] = cross(axis, R.column[(along + 1) % 3]);
    return R;
}

static void place_end(struct joint *j, int k, const struct pose *body, struct pose world)
{
    const struct pose at = seen_from(*body, world);
    j->end[k].at = at.at;
    to_angles(at.R, j->end[k].angle);
}

// The frame `from` in ground axes: its axis, given in its own axes, points along the spot's.
static struct pose frame_at(struct joint *j, struct draw *d, const struct spot *spot,
                            const struct style *style)
{
    struct pose at = {spot->at, same_axes()};
    const int along = j->type == PRISMATIC ? 0 : 2;
    const struct axes one = same_axes();
    if (style->is_flat) { // axes stay those of ground
        j->axis = spot->axis;
        j->second = spot->second;
    } else if (j->type != PLANAR && happens(d, 0.4)) { // an axis in general position
        at.R = orientation(d);
        j->axis = turned_back(at.R, spot->axis);
        j->second = direction(d);
    } else {
        j->axis = one.column[along];
        at.R = axes_with(d, along, spot->axis);
        j->second = one.column[(along + 1) % 3];
    }
    // b of a universal joint is where the spot wants it after the first angle, and clear of a
    if (j->type == UNIVERSAL) {
        const struct axes first = product(at.R, rotation(j->axis, j->q[0]));
        j->second = turned_back(first, spot->second);
    }
    return at;
}

struct joint *add_joint(struct scene *s, struct draw *d, enum joint_type type, int from, int to,
                        const struct spot *spot, const struct style *style)
{
    struct joint *j = &s->joint[s->njoint++];
    *j = (struct joint){.type = type, .from = from, .to = to};
    j->axis = (struct vector){{0, 0, 1}};
    j->second = (struct vector){{0, 1, 0}};
    j->start = START_GUESS;
    j->pitch = spot->pitch;
    draw_position(j, d, style, happens(d, 0.1));
    if (type == UNIVERSAL && style->is_flat)
        j->type = type = REVOLUTE;
    const struct pose at = frame_at(j, d, spot, style);
    const struct joint_motion m = joint_motion(j, j->q, j->u);
    place_end(j, 0, &s->body[from].pose, at);
    place_end(j, 1, &s->body[to].pose, composed(at, m.pose));
    if (type == DISTANCE) {
        const struct vector b = plus(spot->at, style->size * between(d, 0.3, 1), spot->second);
        place_end(j, 0, &s->body[from].pose, (struct pose){spot->at, s->body[from].pose.R});
        place_end(j, 1, &s->body[to].pose, (struct pose){b, s->body[to].pose.R});
        j->length = norm(plus(b, -1, spot->at));
        for (int k = 0; k < 2; k++)
            memset(j->end[k].angle, 0, sizeof j->end[k].angle);
    }
    if (joint_speeds(type) == 1 && happens(d, 0.5)) {
        j->effort = between(d, -2, 2);
        j->stiffness = between(d, 0, 3);
        j->damping = between(d, 0, 0.5);
        j->rest = between(d, -0.3, 0.3);
    }
    return j;
}
