// The start is the position nearest to the guesses. Mechanisms are built from a known position,
// which is then hidden behind guesses that are off by up to 0.3: the start must meet what is
// demanded and be no farther from the guesses than the known position. The distance is computed
// here, with the weights that docs/format.md states.
//
// CT_TEST_COUNT: mechanisms of each kind; CT_TEST_SEED: seed.
#include "tests/property/system.h"

enum { MOST_BODIES = 16, MOST_JOINTS = 24 };

static const double pi = 3.14159265358979323846;

struct pose {
    double R[9], p[3]; // axes by columns, origin
};

enum type { REVOLUTE, PRISMATIC, SPHERICAL, CYLINDRICAL, UNIVERSAL, NTYPE };
static const char *const type_name[]
    = {"revolute", "prismatic", "spherical", "cylindrical", "universal"};
static const int freedoms[] = {1, 1, 3, 2, 2};

enum asked { DEMANDED, GUESSED, OPEN };

struct hidden_joint {
    enum type type;
    int from, to;
    double q[2], turn[3]; // known coordinates; of a spherical joint angles about z, y, x
    double guess[2], guess_turn[3];
    enum asked asked;
};

struct hidden {
    bool is_planar;
    int nbody, njoint;
    struct pose body[MOST_BODIES]; // 0: ground
    struct hidden_joint joint[MOST_JOINTS];
    char *text;
};

// ---- poses --------------------------------------------------------------------------------------

static struct pose about(int axis, double angle)
{
    struct pose x = {{0}, {0}};
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    x.R[axis + 3 * axis] = 1;
    x.R[a + 3 * a] = x.R[b + 3 * b] = cos(angle);
    x.R[b + 3 * a] = sin(angle);
    x.R[a + 3 * b] = -sin(angle);
    return x;
}

static struct pose product(struct pose x, struct pose y)
{
    struct pose z = {{0}, {x.p[0], x.p[1], x.p[2]}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            z.p[i] += x.R[i + 3 * k] * y.p[k];
            for (int j = 0; j < 3; j++)
                z.R[i + 3 * j] += x.R[i + 3 * k] * y.R[k + 3 * j];
        }
    return z;
}

static struct pose inverse(struct pose x)
{
    struct pose z = {{0}, {0}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            z.R[i + 3 * k] = x.R[k + 3 * i];
            z.p[i] -= x.R[k + 3 * i] * x.p[k];
        }
    return z;
}

// Rot(z) Rot(y) Rot(x)
static struct pose turned(const double a[3])
{
    return product(about(2, a[0]), product(about(1, a[1]), about(0, a[2])));
}

static void turns_of(struct pose x, double a[3])
{
    a[0] = atan2(x.R[1], x.R[0]);
    a[1] = atan2(-x.R[2], hypot(x.R[0], x.R[1]));
    a[2] = atan2(x.R[5], x.R[8]);
}

static struct pose random_pose(bool is_planar, double size)
{
    double a[3] = {pi * chance(), is_planar ? 0 : pi * chance(), is_planar ? 0 : pi * chance()};
    struct pose x = turned(a);
    for (int i = 0; i < (is_planar ? 2 : 3); i++)
        x.p[i] = size * chance();
    return x;
}

static struct pose joint_motion(enum type type, const double q[2], const double turn[3])
{
    struct pose x = about(2, 0);
    switch (type) {
    case REVOLUTE:
        return about(2, q[0]);
    case PRISMATIC:
        x.p[0] = q[0];
        return x;
    case SPHERICAL:
        return turned(turn);
    case CYLINDRICAL:
        x = about(2, q[1]);
        x.p[2] = q[0];
        return x;
    default:
        return product(about(0, q[0]), about(1, q[1]));
    }
}

static bool is_angle(enum type type, int place)
{
    return type == REVOLUTE || type == UNIVERSAL || (type == CYLINDRICAL && place == 1);
}

static int numbers(enum type type)
{
    return type == SPHERICAL ? 0 : freedoms[type];
}

// ---- mechanisms ---------------------------------------------------------------------------------

static int add_body(struct hidden *h)
{
    h->body[h->nbody] = h->nbody ? random_pose(h->is_planar, 0.5) : about(2, 0);
    return h->nbody++;
}

static void add_joint(struct hidden *h, enum type type, int from, int to)
{
    h->joint[h->njoint++] = (struct hidden_joint){.type = type, .from = from, .to = to};
}

// A loop of joints through the ground and a body between each two.
static void add_loop(struct hidden *h, const enum type *type, int n)
{
    int last = 0;
    for (int i = 0; i + 1 < n; i++) {
        const int next = add_body(h);
        add_joint(h, type[i], last, next);
        last = next;
    }
    add_joint(h, type[n - 1], last, 0);
}

static void planar_loop(struct hidden *h)
{
    enum type type[6];
    const int n = 4 + chance_of(2);
    for (int i = 0; i < n; i++)
        type[i] = i < 2 && chance_of(4) == 0 ? PRISMATIC : REVOLUTE;
    h->is_planar = true;
    add_body(h);
    add_loop(h, type, n);
}

static void spatial_loop(struct hidden *h)
{
    static const enum type rssr[] = {REVOLUTE, SPHERICAL, SPHERICAL, REVOLUTE};
    enum type type[8];
    int n = 0, total = 0;
    add_body(h);
    if (chance_of(3) == 0) {
        add_loop(h, rssr, 4);
        return;
    }
    for (; n < 7 && total < 7; n++) {
        type[n] = (enum type)chance_of(NTYPE);
        total += freedoms[type[n]];
    }
    add_loop(h, type, n);
}

// A plate on three or six legs, each a universal joint, a slide and a ball.
static void platform(struct hidden *h)
{
    const int nleg = chance_of(2) ? 3 : 6;
    add_body(h);
    const int plate = add_body(h);
    for (int i = 0; i < nleg; i++) {
        const int low = add_body(h), high = add_body(h);
        add_joint(h, UNIVERSAL, 0, low);
        add_joint(h, PRISMATIC, low, high);
        add_joint(h, SPHERICAL, high, plate);
    }
}

// ---- text ---------------------------------------------------------------------------------------

static char *turn_text(struct ct_arena *a, const double t[3])
{
    return text_of(a, "[[z, %.17g], [y, %.17g], [x, %.17g]]", t[0], t[1], t[2]);
}

static char *point_text(struct ct_arena *a, const char *name, struct pose x)
{
    double t[3];
    turns_of(x, t);
    return text_of(a, "%s: {at: [%.17g, %.17g, %.17g], rotate: %s}", name, x.p[0], x.p[1],
                   x.p[2], turn_text(a, t));
}

static char *initial_text(struct ct_arena *a, const struct hidden_joint *j)
{
    const char *guess = j->asked == GUESSED ? ", guess: true" : "";
    if (j->asked == OPEN)
        return text_of(a, " ");
    if (j->type == SPHERICAL)
        return text_of(a, ", initial: {rotate: %s%s}", turn_text(a, j->guess_turn), guess);
    if (numbers(j->type) == 1)
        return text_of(a, ", initial: {q: %.17g%s}", j->guess[0], guess);
    return text_of(a, ", initial: {q: [%.17g, %.17g]%s}", j->guess[0], j->guess[1], guess);
}

// What is asked of the joints; the first demand is one that the known position meets.
static void ask(struct hidden *h, double off)
{
    int motor = chance_of(2) ? chance_of(h->njoint) : -1;
    for (int i = 0; i < h->njoint; i++) {
        struct hidden_joint *j = &h->joint[i];
        j->asked = i == motor ? DEMANDED : chance_of(6) == 0 ? OPEN : GUESSED;
        const double by = j->asked == DEMANDED ? 0 : off;
        for (int k = 0; k < 2; k++)
            j->guess[k] = j->q[k] + by * chance();
        for (int k = 0; k < 3; k++)
            j->guess_turn[k] = j->turn[k] + by * chance();
        if (j->asked == GUESSED && is_angle(j->type, 0))
            j->guess[0] += 2 * pi * (chance_of(8) == 0);
    }
}

static void write_text(struct ct_arena *a, struct hidden *h)
{
    char *points[MOST_BODIES], *joints = text_of(a, "joints:\n"), *text;
    for (int b = 0; b < h->nbody; b++)
        points[b] = text_of(a, "own: [0, 0, 0]");
    for (int i = 0; i < h->njoint; i++) {
        struct hidden_joint *j = &h->joint[i];
        struct pose at = random_pose(h->is_planar, 0.5);
        for (int k = 0; k < 2; k++)
            j->q[k] = is_angle(j->type, k) ? pi * chance() : 0.3 * chance();
        for (int k = 0; k < 3; k++)
            j->turn[k] = pi * chance();
        const struct pose end = product(at, joint_motion(j->type, j->q, j->turn));
        points[j->from] = text_of(
            a, "%s, %s", points[j->from],
            point_text(a, text_of(a, "f%d", i), product(inverse(h->body[j->from]), at)));
        points[j->to] = text_of(
            a, "%s, %s", points[j->to],
            point_text(a, text_of(a, "t%d", i), product(inverse(h->body[j->to]), end)));
    }
    ask(h, (double[]){0.01, 0.03, 0.1, 0.3}[chance_of(4)]);
    for (int i = 0; i < h->njoint; i++) {
        const struct hidden_joint *j = &h->joint[i];
        const char *axis = j->type == PRISMATIC ? ", axis: x" : "";
        joints
            = text_of(a, "%s  j%d: {type: %s%s, from: %s.f%d, to: %s.t%d%s}\n", joints, i,
                      type_name[j->type], axis, j->from ? text_of(a, "b%d", j->from) : "ground",
                      i, j->to ? text_of(a, "b%d", j->to) : "ground", i, initial_text(a, j));
    }
    text = text_of(a, "cotree: 1\nbodies:\n  ground: {points: {%s}}\n", points[0]);
    for (int b = 1; b < h->nbody; b++)
        text = text_of(a, "%s  b%d: {mass: 1, inertia: [1, 1.1, 1.2], points: {%s}}\n", text, b,
                       points[b]);
    h->text = text_of(a, "%s%s", text, joints);
}

// ---- distance -----------------------------------------------------------------------------------

static double between(double x, double y)
{
    return x - y - 2 * pi * round((x - y) / (2 * pi));
}

// Angle between the orientations of a spherical joint.
static double angle_between(struct pose x, struct pose y)
{
    const struct pose d = product(inverse(x), y);
    const double sine[3] = {d.R[5] - d.R[7], d.R[6] - d.R[2], d.R[1] - d.R[3]};
    return atan2(sqrt(sine[0] * sine[0] + sine[1] * sine[1] + sine[2] * sine[2]),
                 d.R[0] + d.R[4] + d.R[8] - 1);
}

static struct pose of_quaternion(const double *p)
{
    struct pose x;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        x.R[4 * i] = 1 - 2 * (p[1 + j] * p[1 + j] + p[1 + k] * p[1 + k]);
        x.R[j + 3 * i] = 2 * (p[1 + i] * p[1 + j] + p[0] * p[1 + k]);
        x.R[i + 3 * j] = 2 * (p[1 + i] * p[1 + j] - p[0] * p[1 + k]);
    }
    memset(x.p, 0, sizeof x.p);
    return x;
}

// Squared distance from the guesses: of the known position (q NULL), or of coordinates by joint.
static double distance(const struct hidden *h, const double *const *q, double length)
{
    double sum = 0;
    for (int i = 0; i < h->njoint; i++) {
        const struct hidden_joint *j = &h->joint[i];
        const double weight = j->asked == DEMANDED ? 0 : j->asked == GUESSED ? 1 : 1e-6;
        for (int k = 0; k < numbers(j->type); k++) {
            const double x = q ? q[i][k] : j->q[k], want = j->asked == OPEN ? 0 : j->guess[k];
            const double r = is_angle(j->type, k) ? between(x, want) : (x - want) / length;
            sum += weight * r * r;
        }
        if (j->type == SPHERICAL) {
            static const double none[3];
            const struct pose x = q ? of_quaternion(q[i]) : turned(j->turn);
            const double r = angle_between(x, turned(j->asked == OPEN ? none : j->guess_turn));
            sum += weight * r * r;
        }
    }
    return sum;
}

static void find_coordinates(const struct hidden *h, const struct system *s, const double **q)
{
    for (int i = 0; i < h->njoint; i++)
        q[i] = NULL;
    for (size_t c = 0; c < s->assembly.ncoordinate; c++) {
        const struct ct_coordinate *at = &s->assembly.coordinate[c];
        const struct ct_edge_info *e = &s->assembly.build->topology->edge[at->edge];
        if (e->kind == CT_EDGE_JOINT && at->index == 0)
            q[e->index] = &s->start.q[c];
    }
}

static bool demands_are_kept(const struct hidden *h, const double *const *q)
{
    const double kept = 1e-8;
    bool ok = true;
    for (int i = 0; i < h->njoint; i++) {
        const struct hidden_joint *j = &h->joint[i];
        if (j->asked != DEMANDED)
            continue;
        for (int k = 0; k < numbers(j->type); k++)
            ok &= agree("demanded", type_name[j->type], q[i][k], j->guess[k], 1, kept);
        if (j->type == SPHERICAL)
            ok &= angle_between(of_quaternion(q[i]), turned(j->guess_turn)) < kept;
    }
    return ok;
}

// ---- properties ---------------------------------------------------------------------------------

static int count_asked(int standard)
{
    const char *given = getenv("CT_TEST_COUNT");
    return given ? atoi(given) : standard;
}

// How many starts are farther from the guesses than the known position, or farther than with
// spatial rows by more than round-off.
static int count_farther(const char *name, void (*make)(struct hidden *h), int n)
{
    int farther = 0, unlike = 0, failed = 0;
    for (int i = 0; i < n; i++) {
        struct ct_arena *a = ct_arena_create();
        struct hidden h = {0};
        struct system s;
        const double *q[MOST_JOINTS];
        make(&h);
        write_text(a, &h);
        if (!system_try_text(&s, name, h.text)) {
            failed++;
            if (getenv("CT_TEST_COUNT"))
                print_message("%s\n%s", s.ctx.ndiagnostic ? s.ctx.diagnostic[0].text : "?",
                              h.text);
            system_close(&s);
            ct_arena_destroy(a);
            continue;
        }
        find_coordinates(&h, &s, q);
        const double found = distance(&h, q, s.start.length),
                     known = distance(&h, NULL, s.start.length);
        failed += !demands_are_kept(&h, q);
        if (!(found <= known * (1 + 1e-6) + 1e-14)) {
            farther++;
            if (getenv("CT_TEST_SHOW"))
                print_message("%d: found %.9g, known %.9g\n%s", i, found, known,
                              atoi(getenv("CT_TEST_SHOW")) == i ? h.text : "");
        }
        if (h.is_planar) {
            system_keep_all(&s);
            find_coordinates(&h, &s, q);
            const double spatial = distance(&h, q, s.start.length);
            if (fabs(spatial - found) > 1e-6 * found + 1e-14)
                unlike++;
        }
        system_close(&s);
        ct_arena_destroy(a);
    }
    print_message(
        "%s: %d mechanisms, %d farther than known, %d unlike with spatial rows, %d failed\n",
        name, n, farther, unlike, failed);
    return farther + unlike + failed;
}

static void planar_loops_start_nearest(void **state)
{
    (void)state;
    chance_start();
    assert_int_equal(count_farther("planar loop", planar_loop, count_asked(150)), 0);
}

static void spatial_loops_start_nearest(void **state)
{
    (void)state;
    chance_start();
    assert_int_equal(count_farther("spatial loop", spatial_loop, count_asked(150)), 0);
}

static void platforms_start_nearest(void **state)
{
    (void)state;
    chance_start();
    assert_int_equal(count_farther("platform", platform, count_asked(20)), 0);
}

// The first of several closings is not the nearest: the arm of a press whose plate is given.
static void given_plate_keeps_the_side_of_the_arm(void **state)
{
    (void)state;
    struct system s;
    system_open_text(
        &s, "arm",
        "cotree: 1\n"
        "bodies: {arm: {mass: 1, inertia: 1, points: {end: [0.3, 0, 0]}}, fore: {mass: 1, "
        "inertia: 1, points: {end: [0.35, 0, 0]}}, plate: {mass: 1, inertia: 1}}\n"
        "joints:\n"
        "  motor: {type: revolute, from: ground, to: arm, initial: {q: 1.0578, guess: true}}\n"
        "  knee: {type: revolute, from: arm.end, to: fore, initial: {q: -1.898, guess: true}}\n"
        "  wrist: {type: revolute, from: fore.end, to: plate}\n"
        "  pose: {type: planar, from: ground, to: plate, initial: {q: [0.38, 0, 1.67], u: [0, "
        "0, "
        "0]}}\n");
    for (size_t i = 0; i < s.assembly.ncoordinate; i++) {
        const char *name = s.assembly.coordinate[i].name;
        if (!strcmp(name, "motor.q"))
            assert_true(agree("arm", name, s.start.q[i], 1.0578, 1, 1e-4));
        if (!strcmp(name, "knee.q"))
            assert_true(agree("arm", name, s.start.q[i], -1.9011, 1, 1e-4));
    }
    system_close(&s);
}

// A guessed speed is nearest, a demanded one is kept; what has no guess gives way.
static void speeds_are_nearest_too(void **state)
{
    (void)state;
    struct system s;
    system_open_text(
        &s, "two slides and a turn",
        "cotree: 1\nbodies: {a: {mass: 1, inertia: 1}, b: {mass: 1, inertia: 1}}\n"
        "joints:\n"
        "  one: {type: prismatic, axis: x, from: ground, to: a, initial: {u: 3, "
        "guess: true}}\n"
        "  two: {type: prismatic, axis: x, from: a, to: b}\n"
        "  both: {type: planar, from: ground, to: b, initial: {u: [2, null, null]}}\n");
    for (size_t i = 0; i < s.assembly.ncoordinate; i++) {
        const char *name = s.assembly.coordinate[i].name;
        if (!strcmp(name, "one.q"))
            assert_true(agree("slides", name, s.start.u[i], 3, 1, 1e-5));
        if (!strcmp(name, "two.q"))
            assert_true(agree("slides", name, s.start.u[i], -1, 1, 1e-5));
    }
    system_close(&s);
}

#define CRANK(angle)                                                                           \
    "cotree: 1\n"                                                                              \
    "bodies: {a: {mass: 1, inertia: 1, points: {e: [0.4, 0, 0]}}, b: {mass: 1, inertia: 1}}\n" \
    "joints:\n"                                                                                \
    "  hinge: {type: revolute, from: ground, to: a, initial: {q: " angle ", u: 1}}\n"          \
    "  next: {type: revolute, from: a.e, to: b}\n"

// A demand that is lost on the way to the equations of motion is told on every tree, also where the
// joint is measured.
static void lost_demands_are_errors(void **state)
{
    (void)state;
    const struct ct_formulate_options *const trees[] = {&by_joints, &by_bodies};
    for (size_t t = 0; t < COUNT(trees); t++)
        for (int of_speeds = 0; of_speeds < 2; of_speeds++) {
            struct system s;
            struct variant v;
            system_open_text(&s, "crank", CRANK("0.3"));
            variant_open(&s, trees[t], &v);
            const size_t nq = v.e.nq, nu = v.e.nu;
            double *before = CT_NEWN(s.ctx.model, double, nq + nu + 1),
                   *after = CT_NEWN(s.ctx.model, double, nq + nu + 1);
            variant_set(&v, &s.start, 0);
            memcpy(before, v.y, (nq + nu) * sizeof *before);
            memcpy(after, v.y, (nq + nu) * sizeof *after);
            assert_true(ct_start_is_kept(&s.ctx, s.ctx.model, &s.model, &v.e, &s.start, before,
                                         after, true));
            if (of_speeds) {
                memset(after + nq, 0, nu * sizeof *after);
            } else {
                struct system other; // the same, turned a little further
                system_open_text(&other, "crank", CRANK("0.31"));
                variant_set(&v, &other.start, 0);
                memcpy(after, v.y, nq * sizeof *after);
                system_close(&other);
            }
            assert_false(ct_start_is_kept(&s.ctx, s.ctx.model, &s.model, &v.e, &s.start, before,
                                          after, true));
            assert_int_equal(s.ctx.diagnostic[0].code, CT_E_START);
            assert_non_null(strstr(s.ctx.diagnostic[0].text, "'hinge'"));
            assert_int_equal(s.ctx.diagnostic[0].mark.line, 3); // counted from 0
            variant_close(&v);
            system_close(&s);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(given_plate_keeps_the_side_of_the_arm),
        cmocka_unit_test(speeds_are_nearest_too),
        cmocka_unit_test(lost_demands_are_errors),
        cmocka_unit_test(planar_loops_start_nearest),
        cmocka_unit_test(spatial_loops_start_nearest),
        cmocka_unit_test(platforms_start_nearest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
