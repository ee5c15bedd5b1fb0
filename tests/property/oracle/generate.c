// See generate.h.
#include "tests/property/oracle/generate.h"
#include "tests/property/oracle/joint_motion.h"
#include "tests/property/oracle/oracle.h"

#include <string.h>

// ---- chance -------------------------------------------------------------------------------------------------------

struct draw {
    uint64_t state;
};

// splitmix64 (Steele, Lea, Flood 2014)
static uint64_t next(struct draw *d)
{
    uint64_t z = (d->state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

// uniform in [low, high)
static double between(struct draw *d, double low, double high)
{
    return low + (high - low) * (double)(next(d) >> 11) / 9007199254740992.0;
}

static int one_of(struct draw *d, int n)
{
    return (int)(next(d) % (uint64_t)n);
}

static bool happens(struct draw *d, double probability)
{
    return between(d, 0, 1) < probability;
}

static struct vector somewhere(struct draw *d, double r)
{
    struct vector v;
    for (int i = 0; i < 3; i++)
        v.e[i] = between(d, -r, r);
    return v;
}

static struct vector direction(struct draw *d)
{
    struct vector v;
    do
        v = somewhere(d, 1);
    while (norm(v) < 0.3 || norm(v) > 1);
    return unit(v);
}

static struct axes orientation(struct draw *d)
{
    return rotation(direction(d), between(d, -3, 3));
}

// A unit vector across n.
static struct vector across(struct draw *d, struct vector n)
{
    struct vector v;
    do
        v = cross(n, direction(d));
    while (norm(v) < 0.3);
    return unit(v);
}

// ---- bodies -------------------------------------------------------------------------------------------------------

// A plane in which everything lies keeps ground's axes: then the engine can see that the mechanism is planar.
struct style {
    bool is_flat;     // all in the x-y plane, axes along z
    struct axes tilt; // of what the joints share
    double size;
};

static void add_body(struct scene *s, struct draw *d, const struct style *style)
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

// ---- joints -------------------------------------------------------------------------------------------------------

// Where a joint is wanted, in ground axes.
struct spot {
    struct vector at, axis, second;
};

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

static struct joint *add_joint(struct scene *s, struct draw *d, enum joint_type type, int from,
                               int to, const struct spot *spot, const struct style *style)
{
    struct joint *j = &s->joint[s->njoint++];
    *j = (struct joint){.type = type, .from = from, .to = to};
    j->axis = (struct vector){{0, 0, 1}};
    j->second = (struct vector){{0, 1, 0}};
    j->start = START_GUESS;
    j->pitch = style->size * between(d, 0.3, 1);
    draw_position(j, d, style, happens(d, 0.1));
    if (type == UNIVERSAL && style->is_flat)
        j->type = type = REVOLUTE;
    if (style->is_flat && type == PLANAR)
        j->q[0] += 0;
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

// ---- pairs: what two joints between the same bodies both allow --------------------------------------------------------

enum shared { TURN, SLIDE, SCREW_MOTION, TURN_AND_SLIDE, BALL, PLANE, SHARED };

// A joint type that allows the shared motion about or along the line through p with direction n.
static void add_sharing(struct scene *s, struct draw *d, enum shared shared, int from, int to,
                        struct vector p, struct vector n, double pitch,
                        const struct style *style)
{
    static const enum joint_type turns[]
        = {REVOLUTE, REVOLUTE, CYLINDRICAL, SPHERICAL, UNIVERSAL, UNIVERSAL, PLANAR},
        slides[] = {PRISMATIC, PRISMATIC, CYLINDRICAL, PLANAR}, screws[] = {SCREW, CYLINDRICAL};
    struct spot spot = {plus(p, style->size * between(d, -0.6, 0.6), n), n, across(d, n)};
    enum joint_type type = REVOLUTE;
    switch (shared) {
    case TURN:
        type = turns[one_of(d, 7)];
        if (type == PLANAR)
            spot.at = plus(spot.at, style->size * between(d, 0.1, 0.6), across(d, n));
        if (type == UNIVERSAL && happens(d, 0.5)) { // b on the line, a anywhere
            spot.second = n;
            do
                spot.axis = direction(d);
            while (fabs(dot(spot.axis, n)) > 0.8);
        } else if (type == UNIVERSAL && happens(d, 0.5)) // axes not at right angles
            spot.second = unit(plus(spot.second, 0.5, n));
        break;
    case SLIDE:
        type = slides[one_of(d, 4)];
        spot.at = plus(p, 1, somewhere(d, style->size));
        if (type == PLANAR)
            spot.axis = across(d, n);
        break;
    case SCREW_MOTION:
        type = screws[one_of(d, 2)];
        break;
    case TURN_AND_SLIDE:
        type = CYLINDRICAL;
        break;
    case BALL:
        type = happens(d, 0.5) ? SPHERICAL : UNIVERSAL;
        spot.at = p;
        spot.axis = direction(d);
        spot.second = across(d, spot.axis);
        break;
    default:
        type = PLANAR;
        spot.at = plus(p, 1, somewhere(d, style->size));
        break;
    }
    struct joint *j = add_joint(s, d, type, from, to, &spot, style);
    if (type == SCREW)
        j->pitch = pitch;
}

static void add_pair(struct scene *s, struct draw *d, int from, int to, int n,
                     const struct style *style)
{
    const enum shared shared = (enum shared)one_of(d, SHARED);
    const struct vector p = somewhere(d, 0.6 * style->size),
                        axis
                        = happens(d, 0.2) ? style->tilt.column[one_of(d, 3)] : direction(d);
    const double pitch = style->size * between(d, 0.3, 1);
    for (int i = 0; i < n; i++)
        add_sharing(s, d, shared, from, to, p, axis, pitch, style);
}

static void draw_pairs(struct scene *s, struct draw *d, const struct style *style)
{
    const int n = happens(d, 0.6) ? 2 : 2 + one_of(d, 3);
    for (int b = 1; b < n; b++) {
        add_body(s, d, style);
        if (b == 1 && n == 3) { // a post that the pair stands on
            const struct spot spot = {somewhere(d, style->size), direction(d), direction(d)};
            add_joint(s, d, happens(d, 0.5) ? WELD : REVOLUTE, 0, 1, &spot, style);
        } else {
            add_pair(s, d, b == 1 || happens(d, 0.7) ? b - 1 : 0, b, happens(d, 0.8) ? 2 : 3,
                     style);
        }
    }
}

// ---- loops ------------------------------------------------------------------------------------------------------------

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
    struct spot spot = {at, n, across(d, n)};
    switch (g->family) {
    case PARALLEL_AXES:
        if (type == PRISMATIC)
            spot.axis = across(d, n);
        break;
    case ONE_POINT:
        spot = (struct spot){p, direction(d), direction(d)};
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
        struct spot spot = {somewhere(d, style->size), n, arm};
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

static void draw_loops(struct scene *s, struct draw *d, const struct style *style)
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

// A gear between two joints with one angle each.
static void add_gear(struct scene *s, struct draw *d)
{
    int pin[MOST_JOINTS], n = 0;
    for (int i = 0; i < s->njoint; i++)
        if (s->joint[i].type == REVOLUTE)
            pin[n++] = i;
    if (n < 2)
        return;
    const int a = one_of(d, n), b = (a + 1 + one_of(d, n - 1)) % n;
    s->joint[s->njoint++] = (struct joint){
        .type = GEAR, .from = pin[a], .to = pin[b], .ratio = between(d, 0.5, 2)};
}

static void draw_plain(struct scene *s, struct draw *d, const struct style *style)
{
    const int n = 2 + one_of(d, 5);
    add_cluster(s, d, style->is_flat ? PARALLEL_AXES : GENERAL, 0, n, one_of(d, 3), style);
}

// ---- what is kept ------------------------------------------------------------------------------------------------------

// The smallest singular value that counts; those that do not are zero but for round-off.
static const double gap_low = 0.02, gap_round_off = 1e-11;

static bool is_clear(const struct oracle *o)
{
    return o->smallest > gap_low && o->largest_out < gap_round_off;
}

static void random_speeds(const struct oracle *o, struct draw *d, struct motion *out)
{
    memset(out, 0, sizeof *out);
    for (int k = 0; k < o->freedoms; k++) {
        struct motion along;
        const double f = between(d, -1, 1);
        oracle_freedom(o, k, &along);
        for (int b = 0; b < o->s->nbody; b++) {
            out->v[b] = plus(out->v[b], f, along.v[b]);
            out->w[b] = plus(out->w[b], f, along.w[b]);
        }
        for (int j = 0; j < o->s->njoint; j++)
            for (int i = 0; i < 6; i++)
                out->u[j][i] += f * along.u[j][i];
    }
}

// Does it move on, with the rank that it has here?
static bool is_regular(const struct scene *s, const struct motion *at, const struct oracle *o,
                       struct draw *d)
{
    for (int k = 0; k < 2; k++) {
        struct motion m = *at, speeds;
        struct oracle there;
        random_speeds(o, d, &speeds);
        if (!oracle_move(s, &m, &speeds, 0.05))
            return false;
        oracle_open(&there, s, &m);
        const bool same
            = there.rank == o->rank && there.largest_out < 1e-9 && there.smallest > gap_low / 2;
        oracle_close(&there);
        if (!same)
            return false;
    }
    return true;
}

// Demand the start of joints, one after the other, as long as their speeds are independent of those before. Of a
// joint all coordinates are demanded or none.
static int demand_starts(struct scene *s, const struct oracle *o, struct draw *d)
{
    double row[MOST_COLUMNS][MOST_COLUMNS]; // orthonormal, in the freedoms
    const int n = o->freedoms, first = s->njoint ? one_of(d, s->njoint) : 0;
    int count = 0;
    for (int i = 0; i < s->njoint && count < n; i++) {
        struct joint *j = &s->joint[(first + i) % s->njoint];
        const int nu = joint_speeds(j->type), before = count;
        bool is_free = nu > 0 && count + nu <= n && happens(d, 0.9);
        for (int c = 0; c < nu && is_free; c++) {
            double *v = row[count], all = 0, left = 0;
            for (int k = 0; k < n; k++) {
                struct motion along;
                oracle_freedom(o, k, &along);
                v[k] = along.u[j - s->joint][c];
                all += v[k] * v[k];
            }
            for (int pass = 0; pass < 2; pass++)
                for (int r = 0; r < count; r++) {
                    double f = 0;
                    for (int k = 0; k < n; k++)
                        f += row[r][k] * v[k];
                    for (int k = 0; k < n; k++)
                        v[k] -= f * row[r][k];
                }
            for (int k = 0; k < n; k++)
                left += v[k] * v[k];
            is_free = left > 0.05 * all && sqrt(left) > 0.1;
            for (int k = 0; k < n && is_free; k++)
                v[k] /= sqrt(left);
            count += is_free;
        }
        if (is_free)
            j->start = START_DEMAND;
        else
            count = before;
    }
    return count;
}

static void draw_scene(struct scene *s, enum kind kind, struct draw *d)
{
    struct style style = {.size = 1, .tilt = orientation(d)};
    s->nbody = 1;
    s->njoint = 0;
    s->body[0] = (struct body){.pose = {{{0, 0, 0}}, same_axes()}};
    s->gravity = scaled(9.81, direction(d));
    if (kind != KIND_PAIRS && happens(d, 0.2)) {
        style.is_flat = true;
        style.tilt = same_axes();
        s->gravity = (struct vector){{0, -9.81, 0}};
    }
    if (kind == KIND_PAIRS)
        draw_pairs(s, d, &style);
    else if (kind == KIND_LOOPS)
        draw_loops(s, d, &style);
    else
        draw_plain(s, d, &style);
    if (kind != KIND_PAIRS && happens(d, 0.1))
        add_gear(s, d);
}

static bool has_redundant_joints(const struct oracle *o)
{
    return o->rank < o->nrow;
}

// Speeds of the start; what is given of them; the numbers as written.
static void finish(struct scene *s, const struct oracle *o, enum kind kind, struct draw *d)
{
    struct motion speeds;
    random_speeds(o, d, &speeds);
    for (int i = 0; i < s->njoint; i++)
        memcpy(s->joint[i].u, speeds.u[i], sizeof s->joint[i].u);
    const int given = demand_starts(s, o, d);
    // between two bodies the demanded joint says all: the others may say nothing
    if (kind == KIND_PAIRS && given == o->freedoms && happens(d, 0.5))
        for (int i = 0; i < s->njoint; i++)
            if (s->joint[i].start == START_GUESS && s->joint[i].type != UNIVERSAL)
                s->joint[i].start = START_NONE;
    scene_round(s);
}

void scene_generate(struct scene *s, enum kind kind, uint64_t seed, int digits, int *freedoms)
{
    struct draw d = {seed * 0x2545f4914f6cdd1du + (uint64_t)kind};
    for (bool is_kept = false; !is_kept;) {
        struct oracle o;
        memset(s, 0, sizeof *s);
        s->digits = digits;
        draw_scene(s, kind, &d);
        const struct motion at = motion_of_scene(s);
        oracle_open(&o, s, &at);
        is_kept = o.position < 1e-13 && is_clear(&o) && (o.freedoms > 0 || happens(&d, 0.05))
               && has_redundant_joints(&o) == (kind != KIND_PLAIN)
               && is_regular(s, &at, &o, &d);
        if (is_kept) {
            *freedoms = o.freedoms;
            finish(s, &o, kind, &d);
        }
        oracle_close(&o);
    }
    static const char *const name[KINDS] = {"pairs", "loops", "plain"};
    snprintf(s->name, sizeof s->name, "%s-%llu-%d", name[kind], (unsigned long long)seed,
             digits);
}
