// The start: given values are met, contradictions are named, half-turns are not taken for
// solutions.
#include "tests/property/mechanism.h"
#include "tests/property/system.h"

static const double met = 2e-9; // assembly promises 1e-9, the comparison may add round-off

static size_t coordinate_named(const struct system *s, const char *name)
{
    for (size_t i = 0; i < s->assembly.ncoordinate; i++)
        if (!strcmp(s->assembly.coordinate[i].name, name))
            return i;
    print_error("no coordinate '%s'\n", name);
    fail();
    return 0;
}

static void expect_start(const struct system *s, const char *name, double q, double u)
{
    const size_t i = coordinate_named(s, name);
    assert_true(agree(s->name, text_of(s->ctx.model, "%s", name), s->start.q[i], q, 1, met));
    assert_true(
        agree(s->name, text_of(s->ctx.model, "rate of %s", name), s->start.u[i], u, 1, met));
}

// The first diagnostic has this code and names this.
static void expect_failure(struct system *s, const char *text, enum ct_code code,
                           const char *named)
{
    assert_false(system_try_text(s, "model.yaml", text));
    assert_true(s->ctx.ndiagnostic > 0);
    const struct ct_finding *d = &s->ctx.diagnostic[0];
    if (d->code != code || !strstr(d->text, named)) {
        print_error("got: %s\nwanted code %d and '%s'\n", d->text, code, named);
        fail();
    }
    if (!d->mark.file)
        print_error("no place: %s\n", d->text);
    assert_non_null(d->mark.file);
    system_close(s);
}

// ---- values taken from states that exist --------------------------------------------------------

static bool takes_values(const struct ct_instance *j)
{
    return j->from >= 0 && j->nfree > 0 && j->nfree == j->ncoord && j->nfree <= 3
        && !j->initial.q.given;
}

// The mechanism with values of joint k's coordinates out of a state, which lies on its motion where
// it is driven.
static const char *text_with_values(struct ct_arena *a, const struct mechanism *m, size_t k,
                                    const struct system *s,
                                    const struct ct_initial_state *state, size_t n)
{
    struct mechanism given = *m;
    const size_t first
        = coordinate_named(s, text_of(a, n == 1 ? "%s.q" : "%s.q1", m->joint[k].name));
    char *q = text_of(a, "%.17g", state->q[first]), *u = text_of(a, "%.17g", state->u[first]);
    for (size_t i = 1; i < n; i++) {
        q = text_of(a, "%s, %.17g", q, state->q[first + i]);
        u = text_of(a, "%s, %.17g", u, state->u[first + i]);
    }
    given.joint[k].rest = text_of(a, "%s, initial: {q: [%s], u: [%s]}", m->joint[k].rest, q, u);
    return mechanism_text(a, &given, NULL, 0, false);
}

static void values_given_on_any_joint_are_met(void **state)
{
    (void)state;
    size_t tried = 0;
    chance_start();
    for (size_t i = 0; i < nmechanism; i++) {
        struct ct_arena *a = ct_arena_create();
        struct system s;
        struct ct_initial_state want;
        system_open_text(&s, mechanisms[i].name,
                         mechanism_text(a, &mechanisms[i], NULL, 0, false));
        assert_true(system_random_state(&s, 0, 0.6, &want));
        for (size_t k = 0; k < s.model.njoint; k++) {
            struct system given;
            const struct ct_instance *j = &s.model.joint[k];
            const size_t n = (size_t)j->nfree;
            if (!takes_values(j))
                continue;
            system_open_text(&given, mechanisms[i].name,
                             text_with_values(a, &mechanisms[i], k, &s, &want, n));
            for (size_t c = 0; c < n; c++) {
                const char *name = n == 1 ? text_of(a, "%s.q", j->name)
                                          : text_of(a, "%s.q%zu", j->name, c + 1);
                const size_t at = coordinate_named(&s, name);
                expect_start(&given, name, want.q[at], want.u[at]);
            }
            system_close(&given);
            tried++;
        }
        system_close(&s);
        ct_arena_destroy(a);
    }
    print_message("%zu joints\n", tried);
    assert_true(tried > 60);
}

// ---- a four-bar ---------------------------------------------------------------------------------

#define FOUR_BAR(crank, coupler, rocker, top)                                                  \
    "cotree: 1\nbodies:\n  ground: {points: {far: [0.5, 0, 0]}}\n"                             \
    "  a: {mass: 1, inertia: 1, points: {end: [0.2, 0, 0]}}\n"                                 \
    "  b: {mass: 1, inertia: 1, points: {end: [0.5, 0, 0]}}\n"                                 \
    "  c: {mass: 1, inertia: 1, points: {end: [0.4, 0, 0]}}\n"                                 \
    "joints:\n"                                                                                \
    "  crank: {type: revolute, from: ground, to: a, initial: {" crank "}}\n"                   \
    "  coupler: {type: revolute, from: a.end, to: b, initial: {" coupler "}}\n"                \
    "  rocker: {type: revolute, from: ground.far, to: c, initial: {" rocker "}}\n"             \
    "  top: {type: revolute, from: b.end, to: c.end, initial: {" top "}}\n"

static void several_turns_are_kept(void **state)
{
    (void)state;
    struct system s;
    // three turns of the crank, two of the chord and one back of the coupler
    system_open_text(&s, "four-bar",
                     FOUR_BAR("q: 20, u: 3", "q: -8, guess: true", "q: 1.6, guess: true",
                              "q: 1.2 + 4*pi, guess: true"));
    expect_start(&s, "crank.q", 20, 3);
    const double top = s.start.q[coordinate_named(&s, "top.q")],
                 coupler = s.start.q[coordinate_named(&s, "coupler.q")];
    assert_true(fabs(top - (1.2 + 4 * 3.14159)) < 1.2);
    assert_true(fabs(coupler + 8) < 1.2);
    system_close(&s);
    // the chord's angle may be the one that is given
    system_open_text(&s, "four-bar",
                     FOUR_BAR("q: 1, guess: true", "q: -1, guess: true", "q: 1.6, guess: true",
                              "q: 1.3 - 2*pi, u: 0.7"));
    expect_start(&s, "top.q", 1.3 - 2 * acos(-1), 0.7);
    system_close(&s);
}

// A Bennett linkage, whose last angle is found the long way round: what nobody gave is within half
// a turn of its guess, and theta4 = -theta2, theta3 = -theta1 with tan(theta1/2) tan(theta2/2) =
// sin((be + al)/2)/sin((be - al)/2).
#define BENNETT(last)                                                                          \
    "cotree: 1\nparameters: {a: 0.4, b: 0.6, al: 0.5, be: asin(b/a*sin(al))}\nbodies:\n"       \
    "  ground: {points: {d: {at: [-b, 0, 0], rotate: [x, -be]}}}\n"                            \
    "  l1: {mass: 1, inertia: 1, points: {e: {at: [a, 0, 0], rotate: [x, al]}}}\n"             \
    "  l2: {mass: 1, inertia: 1, points: {e: {at: [b, 0, 0], rotate: [x, be]}}}\n"             \
    "  l3: {mass: 1, inertia: 1, points: {e: {at: [a, 0, 0], rotate: [x, al]}}}\n"             \
    "joints:\n"                                                                                \
    "  j1: {type: revolute, from: ground, to: l1, initial: {q: 1.1, u: 3}}\n"                  \
    "  j2: {type: revolute, from: l1.e, to: l2, initial: {q: 2.8, guess: true}}\n"             \
    "  j3: {type: revolute, from: l2.e, to: l3, initial: {q: -1.1, guess: true}}\n"            \
    "  j4: {type: revolute, from: l3.e, to: ground.d, initial: {" last "}}\n"

static void angles_start_near_their_guesses(void **state)
{
    (void)state;
    static const char *const last[] = {BENNETT("guess: true"), BENNETT("q: 3.3, guess: true"),
                                       BENNETT("q: 10, guess: true")};
    const double al = 0.5, be = asin(1.5 * sin(al)), pi = acos(-1);
    const double second
        = 2 * atan(sin((be + al) / 2) / sin((be - al) / 2) / tan(0.55)); // 2.839
    const double fourth[] = {-second, 2 * pi - second, 4 * pi - second};
    for (size_t i = 0; i < COUNT(last); i++) {
        struct system s;
        system_open_text(&s, "Bennett", last[i]);
        expect_start(&s, "j1.q", 1.1, 3);
        expect_start(&s, "j3.q", -1.1, -3);
        assert_true(agree("Bennett", "j4.q", s.start.q[coordinate_named(&s, "j4.q")], fourth[i],
                          1, 1e-8));
        system_close(&s);
    }
}

static void contradictions_are_named(void **state)
{
    (void)state;
    struct system s;
    expect_failure(&s, FOUR_BAR("q: 1", "q: -1, guess: true", "q: 0.2", "guess: true"),
                   CT_E_START, "contradict");
    expect_failure(
        &s, FOUR_BAR("q: 1, u: 2", "q: -1, guess: true", "q: 1.6, u: 7, guess: true", "u: 40"),
        CT_E_START, "top.q");
    // the bars cannot meet at all
    expect_failure(&s,
                   "cotree: 1\nbodies:\n  ground: {points: {far: [5, 0, 0]}}\n"
                   "  a: {mass: 1, inertia: 1, points: {end: [0.2, 0, 0]}}\n"
                   "  b: {mass: 1, inertia: 1, points: {end: [0.5, 0, 0]}}\n"
                   "joints:\n"
                   "  one: {type: revolute, from: ground, to: a}\n"
                   "  two: {type: revolute, from: ground.far, to: b}\n"
                   "  three: {type: revolute, from: a.end, to: b.end}\n",
                   CT_E_ASSEMBLY, "stays open");
}

// ---- half-turns ---------------------------------------------------------------------------------

// A body held by a ball and by `joint`, whose rotational rows also hold half a turn away.
#define TURNED(joint, start)                                                                   \
    "cotree: 1\nbodies: {a: {mass: 1, inertia: [1, 2, 2.5]}, b: {mass: 1, inertia: [1, 2, "    \
    "2.5]}}\n"                                                                                 \
    "joints:\n"                                                                                \
    "  ball: {type: spherical, from: ground, to: a, initial: {rotate: " start "}}\n"           \
    "  link: {type: spherical, from: a, to: b, initial: {rotate: [x, 0.1], guess: true}}\n"    \
    "  hold: {" joint ", from: ground, to: a}\n"                                               \
    "  rest: {" joint ", from: a, to: b}\n"

static void half_turns_are_no_solutions(void **state)
{
    (void)state;
    static const char *const near[]
        = {TURNED("type: prismatic", "[y, 2.9], guess: true"),
           TURNED("type: weld", "[[x, 2.5], [z, 0.3]], guess: true"),
           TURNED("type: revolute", "[x, 3.0], guess: true"),
           TURNED("type: cylindrical", "[[x, 2.8], [z, 1]], guess: true")};
    for (size_t i = 0; i < COUNT(near); i++) {
        struct system s;
        system_open_text(&s, "half-turn", near[i]);
        for (size_t k = 0; k < s.machine->nrow; k++) {
            ct_evaluator_set(s.machine, 0, s.y);
            ct_program_run(&s.machine->assembly_sign, s.machine->input);
            assert_true(s.machine->assembly_sign.out[k] >= 0);
        }
        // axes along each other: the z axis of `a` for turns about z, all of them otherwise
        const double *q = &s.start.q[coordinate_named(&s, "ball.q1")];
        const double zz = 1 - 2 * (q[1] * q[1] + q[2] * q[2]);
        assert_true(agree("half-turn", "z axes", zz, 1, 1, 1e-8));
        system_close(&s);
    }
}

static void closing_by_a_half_turn_alone_is_an_error(void **state)
{
    (void)state;
    struct system s;
    expect_failure(
        &s,
        "cotree: 1\nbodies:\n  ground: {points: {over: {at: [0, 0, 0], rotate: [x, pi]}}}\n"
        "  a: {mass: 1, inertia: [1, 2, 2.5]}\n  b: {mass: 1, inertia: 1}\n"
        "joints:\n"
        "  arm: {type: spherical, from: a, to: b}\n"
        "  hold: {type: weld, from: ground, to: a}\n"
        "  rest: {type: weld, from: ground.over, to: a}\n",
        CT_E_ASSEMBLY, "'rest' turned");
    // a given value leaves no choice either
    expect_failure(&s, TURNED("type: weld", "[y, pi]"), CT_E_START, "ball.q");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_given_on_any_joint_are_met),
        cmocka_unit_test(several_turns_are_kept),
        cmocka_unit_test(angles_start_near_their_guesses),
        cmocka_unit_test(contradictions_are_named),
        cmocka_unit_test(half_turns_are_no_solutions),
        cmocka_unit_test(closing_by_a_half_turn_alone_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
