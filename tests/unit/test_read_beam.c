// Beams as read: defaults, what follows from other keys, sections along the axis, points.
// What is refused is in tests/broken.
#include "base/guard.h"
#include "component/model.h"
#include "tests/unit/read_state.h"

#include <stdlib.h>
#include <string.h>

// The model of one beam 'b' with these lines of keys, two blanks before each.
static const struct ct_beam *read_beam(struct bench *s, const char *top, const char *keys)
{
    const char *text = ct_arena_printf(
        s->ctx.model, "cotree: 1\n%sbodies:\n b:\n  type: beam\n%s", top, keys);
    const bool ok = ct_model_parse(&s->ctx, "m.yaml", text, strlen(text), NULL, 0, &s->m);
    if (!ok)
        ct_ctx_print(&s->ctx, stderr);
    assert_true(ok);
    assert_int_equal(s->ctx.ndiagnostic, 0);
    assert_non_null(s->m.body[1].beam);
    return s->m.body[1].beam;
}

static const char plain[]
    = "  length: 2\n  E: 8e10\n  density: 3000\n  area: 1e-3\n  Iz: 2e-7\n";

static const struct ct_beam *read_plain(struct bench *s, const char *more)
{
    return read_beam(s, "", ct_arena_printf(s->ctx.model, "%s%s", plain, more));
}

// Value of an expression at the place x of the beam.
static double at(struct bench *s, const struct ct_beam *beam, ct_ex e, double place)
{
    const ct_ex x = ct_ex_const(s->m.x, place);
    return ct_model_number(&s->m, ct_ex_subst(s->m.x, e, &beam->x, &x, 1));
}

// a few operations on numbers
static void check(double got, double want)
{
    CHECK_CLOSE(got, want, 4e-15, 0);
}

static double number(const struct bench *s, ct_ex e)
{
    return ct_model_number(&s->m, e);
}

static void a_beam_with_few_keys_has_the_defaults(void **state)
{
    struct bench *s = *state;
    const struct ct_beam *b = read_plain(s, "");
    check(number(s, b->length), 2);
    assert_int_equal(b->nelement, 1);
    check(number(s, b->end[0]), 2);
    check(number(s, b->E), 8e10);
    check(number(s, b->G), 0);
    check(number(s, b->area), 1e-3);
    check(number(s, b->Iy), 0);
    check(number(s, b->Iz), 2e-7);
    check(number(s, b->mass_per_length), 3);
    assert_false(b->has_rotary);
    check(number(s, b->twist_inertia), 3000 * 2e-7);
    assert_int_equal(b->theory, CT_BEAM_EULER_BERNOULLI);
    assert_int_equal(b->integration, CT_BEAM_FULL);
    assert_int_equal(b->formulation, CT_BEAM_AUTO);
    assert_int_equal(b->deformation, CT_BEAM_ALL);
    assert_int_equal(b->known, CT_BEAM_AXIAL | CT_BEAM_BENDING_Z);
    assert_false(b->deformation_given || b->is_lumped || b->higher_order || b->is_chord
                 || b->starts_in_equilibrium);
    assert_int_equal(b->modes, 0);
    check(number(s, b->damping_mass), 0);
    check(number(s, b->damping_stiffness), 0);
    check(number(s, s->m.body[1].mass), 6);
    assert_false(s->m.body[1].is_particle);
    for (int i = 0; i < 6; i++)
        check(number(s, s->m.body[1].inertia[i]), 0);
}

static void every_word_is_one_of_the_struct(void **state)
{
    struct bench *s = *state;
    const struct ct_beam *b = read_plain(
        s, "  nu: 0.25\n  Iy: 1e-7\n  theory: timoshenko\n  shear_factor: [5/6, 1/2]\n"
           "  geometric_stiffness: higher-order\n  integration: one-point\n  mass: lumped\n"
           "  formulation: stretch-linear\n  frame: chord\n"
           "  deformation: [torsion, bending-y]\n  modes: 7\n"
           "  damping: {beta: 1e-3}\n  initial: equilibrium\n");
    check(number(s, b->G), 3.2e10);
    check(number(s, b->shear_factor[0]), 5.0 / 6);
    check(number(s, b->shear_factor[1]), 0.5);
    check(number(s, b->J), 3e-7);
    assert_int_equal(b->theory, CT_BEAM_TIMOSHENKO);
    assert_int_equal(b->integration, CT_BEAM_ONE_POINT);
    assert_int_equal(b->formulation, CT_BEAM_STRETCH_LINEAR);
    assert_int_equal(b->deformation, CT_BEAM_TORSION | CT_BEAM_BENDING_Y);
    assert_int_equal(b->known, CT_BEAM_ALL);
    assert_true(b->deformation_given && b->is_lumped && b->higher_order && b->is_chord
                && b->starts_in_equilibrium);
    assert_int_equal(b->modes, 7);
    check(number(s, b->damping_mass), 0);
    check(number(s, b->damping_stiffness), 1e-3);
    check(number(s, b->twist_inertia), 0); // lumped
}

static void each_choice_has_its_own_place(void **state)
{
    static const struct {
        const char *key, *word;
        int want;
    } cases[] = {{"formulation", "auto", CT_BEAM_AUTO},
                 {"formulation", "linear", CT_BEAM_LINEAR},
                 {"formulation", "foreshortening", CT_BEAM_FORESHORTENING},
                 {"formulation", "force-only", CT_BEAM_FORCE_ONLY},
                 {"formulation", "stretch-linear", CT_BEAM_STRETCH_LINEAR},
                 {"integration", "full", CT_BEAM_FULL},
                 {"integration", "reduced", CT_BEAM_REDUCED},
                 {"deformation", "auto", CT_BEAM_ALL},
                 {"deformation", "[]", 0},
                 {"deformation", "[axial]", CT_BEAM_AXIAL},
                 {"deformation", "[bending-z]", CT_BEAM_BENDING_Z},
                 {"frame", "clamped", 0}};
    struct bench *s = *state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        const char *key = cases[i].key;
        const struct ct_beam *b
            = read_plain(s, ct_arena_printf(s->ctx.model, "  %s: %s\n", key, cases[i].word));
        const int got = strcmp(key, "formulation") == 0 ? (int)b->formulation
                      : strcmp(key, "integration") == 0 ? (int)b->integration
                      : strcmp(key, "deformation") == 0 ? (int)b->deformation
                                                        : (int)b->is_chord;
        assert_int_equal(got, cases[i].want);
    }
}

static void elements_are_a_count_or_their_ends(void **state)
{
    struct bench *s = *state;
    const struct ct_beam *b
        = read_beam(s, "parameters: {n: 3, l: 0.6}\n",
                    "  length: l\n  elements: n + 1\n  E: 1\n  mass_per_length: 1\n  Iz: 1\n");
    assert_int_equal(b->nelement, 4);
    check(number(s, b->end[0]), 0.15);
    assert_true(ct_ex_same(b->end[3], b->length));
    b = read_beam(s, "parameters: {n: 3, l: 0.6}\n",
                  "  length: l\n  elements: [0.2*length, 0.1 + 0.2, 0.6]\n"
                  "  E: 1\n  mass_per_length: 1\n  Iz: 1\n");
    assert_int_equal(b->nelement, 3);
    check(number(s, b->end[0]), 0.12);
    check(number(s, b->end[1]), 0.3);
    assert_true(ct_ex_same(b->end[2], b->length));
}

// A cone: area a (1 - x/(2 l))^2, mass rho a l (1 - 1/2 + 1/12).
static void a_tapered_section_is_a_function_of_x(void **state)
{
    struct bench *s = *state;
    const struct ct_beam *b
        = read_beam(s, "parameters: {a: 2e-3}\n",
                    "  length: 3\n  elements: 2\n  E: 1\n  density: 1000\n"
                    "  area: \"a*(1 - x/(2*length))^2\"\n  Iz: \"1e-6*(1 - x/6)^4\"\n"
                    "  Iy: \"1e-6*exp(-x)\"\n  rotary_inertia: true\n");
    check(at(s, b, b->area, 1.5), 2e-3 * 0.5625);
    check(at(s, b, b->mass_per_length, 3), 0.5);
    check(at(s, b, b->rotary[1], 2), 1e-3 * exp(-2));
    check(at(s, b, b->rotary[2], 1.5), 1e-3 * 0.31640625);
    check(at(s, b, b->rotary[0], 0), 2e-3);
    check(number(s, s->m.body[1].mass), 6 * (1 - 0.5 + 1.0 / 12));
}

// int_0^2 exp(x) dx by 8 points on each of two elements: the remainder is far below round-off.
static void the_mass_of_any_section_is_an_integral(void **state)
{
    struct bench *s = *state;
    read_beam(s, "",
              "  length: 2\n  elements: 2\n  E: 1\n  mass_per_length: exp(x)\n  Iz: 1\n");
    check(number(s, s->m.body[1].mass), exp(2) - 1);
    read_beam(s, "",
              "  length: 2\n  elements: [0.5, 2]\n  E: 1\n"
              "  mass_per_length: \"if(x < 0.5, 3, 1)\"\n  Iz: 1\n");
    check(number(s, s->m.body[1].mass), 3);
}

static void the_mass_stays_a_function_of_parameters(void **state)
{
    struct bench *s = *state;
    read_beam(s, "parameters: {w: 2}\n",
              "  length: w\n  E: 1\n  mass_per_length: \"w*(1 + x)\"\n  Iz: 1\n");
    const ct_ex mass = s->m.body[1].mass; // w (w + w^2/2)
    check(number(s, mass), 8);
    s->m.value[ct_ex_node(s->m.x, s->m.parameter[0].symbol)->a] = 4;
    check(number(s, mass), 48);
}

static void rotary_inertia_is_given_or_that_of_the_section(void **state)
{
    struct bench *s = *state;
    const struct ct_beam *b = read_plain(s, "  Iy: 1e-7\n  rotary_inertia: true\n");
    assert_true(b->has_rotary);
    check(number(s, b->rotary[0]), 9e-4);
    check(number(s, b->rotary[1]), 3e-4);
    check(number(s, b->rotary[2]), 6e-4);
    b = read_plain(s, "  rotary_inertia: [1, \"2*x\", 0]\n  mass: lumped\n");
    assert_true(b->has_rotary);
    check(at(s, b, b->rotary[1], 0.5), 1);
    b = read_plain(s, "  rotary_inertia: true\n  mass: lumped\n");
    assert_false(b->has_rotary);
    b = read_beam(s, "",
                  "  length: 1\n  E: 1\n  mass_per_length: 4\n  area: 2\n  Iz: 3\n  Iy: 5\n"
                  "  rotary_inertia: false\n");
    assert_false(b->has_rotary);
    check(number(s, b->rotary[0]), 0);
    check(number(s, b->twist_inertia), 16);
}

// A parameter called `length` is the one of the model in `length`, the beam's in sections and
// points.
static void points_lie_along_the_axis_or_beside_it(void **state)
{
    struct bench *s = *state;
    read_beam(
        s, "parameters: {length: 5, c: 0.25}\n",
        "  length: length - 1\n  E: 1\n  mass_per_length: \"x/length\"\n  Iz: 1\n"
        "  points:\n   tip: {at: length}\n   mid: 0.5*length\n   quarter: \"1000 mm\"\n"
        "   side: [c*length, 0.1, -c]\n   last: {at: [length, 0, 0.2], rotate: [z, c]}\n");
    static const struct {
        const char *name;
        double at[3];
    } want[] = {{"b.tip", {4, 0, 0}},
                {"b.mid", {2, 0, 0}},
                {"b.quarter", {1, 0, 0}},
                {"b.side", {1, 0.1, -0.25}},
                {"b.last", {4, 0, 0.2}}};
    for (size_t i = 0; i < COUNT(want); i++) {
        const int f = ct_model_find_frame(&s->m, want[i].name);
        assert_true(f > 0);
        for (int k = 0; k < 3; k++)
            check(number(s, s->m.frame[f].at.e[k]), want[i].at[k]);
    }
    assert_int_equal(s->m.frame[ct_model_find_frame(&s->m, "b.last")].nturn, 1);
    check(number(s, s->m.body[1].mass), 2);
}

// Outside the keys that know the beam's x, a parameter of that name keeps its meaning.
static void a_parameter_may_be_called_x(void **state)
{
    struct bench *s = *state;
    const struct ct_beam *b
        = read_beam(s, "parameters: {x: 3}\n",
                    "  length: x\n  E: 1\n  damping: {alpha: 2*x}\n"
                    "  mass_per_length: \"1 + x\"\n  Iz: 1\n  points: {p: x/2}\n");
    check(number(s, b->damping_mass), 6);
    check(number(s, s->m.body[1].mass), 7.5);
    check(number(s, s->m.frame[ct_model_find_frame(&s->m, "b.p")].at.e[0]), 1.5);
}

static void two_beams_have_their_own_x(void **state)
{
    struct bench *s = *state;
    const struct ct_beam *b = read_plain(
        s,
        " c:\n  {type: beam, length: 1, E: 1, mass_per_length: 1 + x, Iz: 1, elements: 2}\n");
    const struct ct_beam *c = s->m.body[2].beam;
    assert_false(ct_ex_same(b->x, c->x));
    check(number(s, s->m.body[2].mass), 1.5);
    assert_int_equal(c->nelement, 2);
}

static void beams_may_be_small(void **state)
{
    struct bench *s = *state;
    const struct ct_beam *b = read_plain(
        s, "joints: {j: {type: revolute, from: ground, to: b}}\nsimulation: {small: [b, j]}\n");
    assert_non_null(b);
    assert_int_equal(s->m.simulation.small.n, 2);
    assert_string_equal(s->m.simulation.small.name[0], "b");
}

#define TEST(f) cmocka_unit_test_setup_teardown(f, create, destroy)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_beam_with_few_keys_has_the_defaults),
        TEST(every_word_is_one_of_the_struct),
        TEST(each_choice_has_its_own_place),
        TEST(elements_are_a_count_or_their_ends),
        TEST(a_tapered_section_is_a_function_of_x),
        TEST(the_mass_of_any_section_is_an_integral),
        TEST(the_mass_stays_a_function_of_parameters),
        TEST(rotary_inertia_is_given_or_that_of_the_section),
        TEST(points_lie_along_the_axis_or_beside_it),
        TEST(a_parameter_may_be_called_x),
        TEST(two_beams_have_their_own_x),
        TEST(beams_may_be_small),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
