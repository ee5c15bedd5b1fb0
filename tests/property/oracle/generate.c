// See generate.h.
#include "tests/property/oracle/generate.h"
#include "tests/property/oracle/oracle.h"
#include "tests/property/oracle/placing.h"

#include <string.h>

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

// Demand the start of joints, one after the other, as long as their speeds are independent of those
// before. Of a joint all coordinates are demanded or none.
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
    struct style style
        = {.size = pow(30, one_of(d, 8) == 0 ? one_of(d, 3) - 1 : 0), .tilt = orientation(d)};
    s->nbody = 1;
    s->njoint = 0;
    s->body[0] = (struct body){.pose = {{{0, 0, 0}}, same_axes()}};
    s->gravity = scaled(9.81, direction(d));
    if (happens(d, kind == KIND_PAIRS ? 0.1 : 0.2)) {
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
