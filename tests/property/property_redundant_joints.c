// Random mechanisms, most of them with redundant joints, against an independent solver (oracle/):
// freedoms, start values, closure and accelerations, on all trees, with and without what a planar
// mechanism leaves out, with data of 17, 10 and 6 digits.
//
//     property_redundant_joints                                 what the suite runs
//     property_redundant_joints KIND FIRST COUNT DIGITS [FOLDER]
//
// KIND is pairs, loops or plain; FIRST the first seed. Models that fail are written to FOLDER.
// DIGITS may be 17, 10, 6 or 0 for all of them.
#include "tests/property/oracle/engine.h"
#include "tests/property/oracle/generate.h"
#include "tests/check.h"

#include <stdlib.h>
#include <string.h>

static const char *const kind_name[KINDS] = {"pairs", "loops", "plain"};

static const struct way ways[] = {{"auto", "auto", false},
                                  {"joints", "joints", false},
                                  {"absolute", "absolute", false},
                                  {"auto --keep-all", "auto", true},
                                  {"joints --keep-all", "joints", true}};
enum { WAYS = sizeof ways / sizeof ways[0] };

// ---- one answer against the solver --------------------------------------------------------------

struct verdict {
    const char *what; // NULL: all agrees
    double found, allowed;
};

static void expect(struct verdict *v, const char *what, double found, double allowed)
{

    if (!v->what && !(found <= allowed)) // also if not a number
        *v = (struct verdict){what, found, allowed};
}

// The larger one; not a number if either is not.
static double larger(double a, double b)
{
    return a >= b || isnan(a) ? a : b;
}

static double difference(struct vector a, struct vector b)
{
    return norm(plus(a, -1, b));
}

// What was demanded is kept: these coordinates are independent. Lengths and angles alike, lengths
// over size. Where loops close in the least-squares sense, to `data`, so are demands.
static void check_start(const struct scene *s, const struct answer *a, double size, double data,
                        struct verdict *v)
{
    for (int i = 0; i < s->njoint; i++) {
        const struct joint *j = &s->joint[i];
        const int n = joint_speeds(j->type) - 3 * joint_has_quaternion(j->type);
        const double kept = (1e-9 + 10 * data) * fmax(size, 1);
        if (j->start != START_DEMAND)
            continue;
        for (int c = 0; c < n; c++)
            expect(v, "demanded q", fabs(a->at.q[i][c] - j->q[c]), kept);
        for (int c = 0; c < joint_speeds(j->type); c++)
            expect(v, "demanded u", fabs(a->at.u[i][c] - j->u[c]), kept);
        if (joint_has_quaternion(j->type)) {
            const struct axes want = from_angles(j->rotate),
                              got = from_quaternion(a->at.q[i] + n);
            expect(v, "demanded rotation", norm(small_rotation(relative(want, got))), kept);
        }
    }
}

// The largest difference of accelerations over the largest of them, of gravity, and of the squares
// of speeds; lengths over size.
static double compare(const struct oracle *o, const struct motion *got,
                      const struct motion *want, const struct motion *at)
{
    const struct scene *s = o->s;
    double worst = 0, scale = norm(s->gravity) / o->size;
    for (int b = 1; b < s->nbody; b++) {
        worst = larger(worst, difference(got->v[b], want->v[b]) / o->size);
        worst = larger(worst, difference(got->w[b], want->w[b]));
        scale = larger(scale, norm(want->v[b]) / o->size);
        scale = larger(scale, norm(want->w[b]));
        scale = larger(scale, dot(at->w[b], at->w[b]));
    }
    for (int j = 0; j < s->njoint; j++)
        for (int i = 0; i < joint_speeds(s->joint[j].type); i++) {
            const double unit = oracle_unit(o, j, i);
            worst = larger(worst, fabs(got->u[j][i] - want->u[j][i]) / unit);
            scale = larger(scale, fabs(want->u[j][i]) / unit);
        }
    return worst / scale;
}

// Where everything is demanded or guessed, the guesses say the position that the mechanism was made
// in: nothing is nearer.
static void check_nearest(const struct scene *s, const struct answer *a, double size,
                          double allowed, struct verdict *v)
{
    for (int j = 0; j < s->njoint; j++)
        if (joint_speeds(s->joint[j].type) > 0 && s->joint[j].start == START_NONE)
            return;
    for (int b = 1; b < s->nbody; b++) {
        const struct pose *at = &a->at.body[b], *want = &s->body[b].pose;
        expect(v, "place of a body", difference(at->at, want->at) / size, allowed);
        expect(v, "axes of a body", norm(small_rotation(relative(want->R, at->R))), allowed);
    }
    for (int j = 0; j < s->njoint; j++)
        for (int c = 0; c < joint_speeds(s->joint[j].type); c++)
            expect(v, "speed of a joint",
                   fabs(a->at.u[j][c] - s->joint[j].u[c]) / fmax(size, 1), 10 * allowed);
}

static struct verdict judge(const struct scene *s, const struct answer *a, int freedoms)
{
    struct verdict v = {0};
    struct oracle o;
    struct motion want;
    double condition;
    if (!a->ok) {
        v.what = a->message;
        return v;
    }
    if (a->freedoms != freedoms)
        v = (struct verdict){"freedoms", (double)a->freedoms, freedoms};
    oracle_open(&o, s, &a->at);
    // Digits of the data leave gaps of this size between joints that repeat each other: angles, and
    // lengths over size.
    const double data = s->digits > 15 ? 0 : pow(10, 1 - s->digits), spread = 1 / o.smallest;
    const double gap = o.rank < o.nrow ? data : 0;
    check_start(s, a, o.size, gap, &v);
    expect(&v, "freedoms where it starts", o.freedoms != freedoms, 0);
    expect(&v, "closure", o.position, 1e-11 + 10 * gap * spread);
    expect(&v, "speeds", o.velocity, 1e-11 + 30 * gap * spread);
    check_nearest(s, a, o.size, (1e-9 + 10 * data) * spread, &v);
    if (!v.what) {
        expect(&v, "solver", !oracle_accelerations(&o, &a->at, &want, &condition), 0);
        // round-off and the closure to 1e-12, each amplified by the inverse of G and of the mass
        // matrix
        expect(&v, "accelerations", compare(&o, &a->a, &want, &a->at),
               (1e-11 + 100 * gap) * spread * spread * sqrt(condition));
    }
    if (strstr(a->message, "singular"))
        expect(&v, a->message, 1, 0);
    oracle_close(&o);
    return v;
}

// ---- many of them -------------------------------------------------------------------------------

static struct {
    const char *folder; // models that fail go there; NULL: to the output
    int mechanisms, failures, refused;
    int of_type[JOINT_TYPES];
} run;

// As in "revolute 0-1, planar 1-0": types and bodies.
static void print_joints(const struct scene *s)
{
    for (int j = 0; j < s->njoint; j++)
        print_error("%s%s %d-%d", j ? ", " : "", joint_type_name[s->joint[j].type],
                    s->joint[j].from, s->joint[j].to);
}

static void report(const struct scene *s, const struct way *way, const struct verdict *v)
{
    char path[400];
    print_error("%s, tree %s: %s", s->name, way->name, v->what);
    if (v->found != v->allowed)
        print_error(": %.3g for %.3g", v->found, v->allowed);
    print_error(" (");
    print_joints(s);
    print_error(")\n");
    if (run.folder)
        snprintf(path, sizeof path, "%s/%s.yaml", run.folder, s->name);
    FILE *f = run.folder ? fopen(path, "w") : stderr;
    if (f)
        scene_write(s, f);
    if (f && f != stderr)
        fclose(f);
}

static bool agrees(enum kind kind, uint64_t seed, int digits)
{
    struct scene s;
    int freedoms;
    int refused = 0, wrong = 0;
    scene_generate(&s, kind, seed, digits, &freedoms);
    for (int j = 0; j < s.njoint; j++)
        run.of_type[s.joint[j].type]++;
    run.mechanisms++;
    for (int k = 0; k < WAYS; k++) {
        struct answer a;
        engine_ask(&s, &ways[k], &a);
        const struct verdict v = judge(&s, &a, freedoms);
        const bool is_refused = digits == 6 && !a.ok && strstr(a.message, "E402");
        if (v.what && !is_refused)
            report(&s, &ways[k], &v);
        refused += is_refused;
        wrong += v.what && !is_refused;
    }
    // redundant joints of long chains may add up more than six digits are off: on every tree, and
    // with its message
    const bool ok = !wrong && (refused == 0 || refused == WAYS);
    run.refused += ok && refused;
    run.failures += !ok;
    return ok;
}

// digits 0: each seed takes its own
static bool all_agree(enum kind kind, uint64_t first, int count, int digits)
{
    static const int several[] = {17, 10, 6};
    const int failures = run.failures, refused = run.refused;
    print_message("%s: seeds %llu to %llu\n", kind_name[kind], (unsigned long long)first,
                  (unsigned long long)first + (unsigned long long)count - 1);
    for (int i = 0; i < count; i++)
        agrees(kind, first + (uint64_t)i, digits ? digits : several[(first + (uint64_t)i) % 3]);
    print_message("%d of %d fail, %d of 6 digits are refused\n", run.failures - failures, count,
                  run.refused - refused);
    return run.failures == failures && 100 * (run.refused - refused) <= count;
}

static void pairs_of_joints_agree_with_the_solver(void **state)
{
    (void)state;
    assert_true(all_agree(KIND_PAIRS, 1, 300, 0));
}

static void redundant_loops_agree_with_the_solver(void **state)
{
    (void)state;
    assert_true(all_agree(KIND_LOOPS, 1, 150, 0));
}

static void plain_mechanisms_agree_with_the_solver(void **state)
{
    (void)state;
    assert_true(all_agree(KIND_PLAIN, 1, 150, 0));
}

static void all_types_of_joints_came(void **state)
{
    (void)state;
    for (int i = 0; i < JOINT_TYPES; i++)
        assert_true(run.of_type[i] > 10);
}

static int run_by_hand(int argc, char **argv)
{
    int kind = 0;
    while (kind < KINDS && strcmp(argv[1], kind_name[kind]) != 0)
        kind++;
    if (kind == KINDS || argc < 5) {
        fputs(
            "usage: property_redundant_joints pairs|loops|plain FIRST COUNT DIGITS [FOLDER]\n",
            stderr);
        return 2;
    }
    run.folder = argc > 5 ? argv[5] : NULL;
    return !all_agree((enum kind)kind, strtoull(argv[2], NULL, 10), atoi(argv[3]),
                      atoi(argv[4]));
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pairs_of_joints_agree_with_the_solver),
        cmocka_unit_test(redundant_loops_agree_with_the_solver),
        cmocka_unit_test(plain_mechanisms_agree_with_the_solver),
        cmocka_unit_test(all_types_of_joints_came),
    };
    return argc > 1 ? run_by_hand(argc, argv) : cmocka_run_group_tests(tests, NULL, NULL);
}
