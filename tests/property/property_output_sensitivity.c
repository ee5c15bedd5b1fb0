// Which outputs errors of states amplify, and which the constraints determine.  (8.11), (8.41)
#include "solve/output_error/output_sensitivity.h"
#include "tests/property/system.h"

#include <float.h>

// The outputs of a kind of a system in its initial state.
struct observed {
    struct system s;
    struct variant v;
    struct ct_controlled_outputs outputs;
    struct ct_constrained_output *constrained;
    struct ct_constrained_output_record record;
    struct ct_output_sensitivity *sensitivity;
    long evaluations;
};

static void open_outputs(struct observed *o, const char *text, enum ct_output_kind kind)
{
    *o = (struct observed){0};
    system_open_text(&o->s, "outputs", text);
    variant_open(&o->s, &by_joints, &o->v);
    variant_set(&o->v, &o->s.start, 0);
    assert_true(ct_partition_choose(o->v.s));
    const struct ct_equations *e = &o->v.e;
    struct ct_arena *a = o->v.arena;
    ct_ex *g = CT_NEWN(a, ct_ex, e->nresult + 1);
    size_t n = 0;
    for (size_t i = 0; i < e->nresult; i++)
        if (ct_controlled_outputs_kind(e, e->result[i].value) == kind)
            g[n++] = e->result[i].value;
    ct_controlled_outputs_create(a, o->v.s, kind, g, n, &o->evaluations, &o->outputs);
    o->constrained = ct_constrained_output_create(a, &o->outputs, g);
    o->record = ct_constrained_output_record(a, n);
    ct_constrained_output_clear(o->constrained, &o->record, false);
    o->sensitivity = ct_output_sensitivity_create(a, &o->outputs, o->constrained, &o->record);
    ct_output_sensitivity_start(o->sensitivity);
}

static void close_outputs(struct observed *o)
{
    variant_close(&o->v);
    system_close(&o->s);
}

// A pendulum of 1 m on a spring of stiffness k along it, and the force on its axis.
static const char *pendulum_text(struct ct_arena *a, const char *k)
{
    return text_of(a,
                   "cotree: 1\ngravity: [0, -9.81, 0]\nbodies:\n"
                   "  arm: {mass: 1, inertia: 0.1}\n  bob: {mass: 1}\n"
                   "joints:\n"
                   "  pin: {type: revolute, from: ground, to: arm, initial: {q: 0.5}}\n"
                   "  slide: {type: prismatic, axis: x, from: arm, to: bob, initial: {q: 1}}\n"
                   "forces:\n"
                   "  spring: {type: spring, from: arm, to: bob, stiffness: %s, length: 1}\n"
                   "outputs: [{name: pull, value: pin.force.x}]\n",
                   k);
}

// Evaluations in 80 steps whose states differ by a little, and whether the force is sensitive.
static long evaluations_of_steps(const char *k, bool *is_sensitive)
{
    struct observed o;
    struct ct_arena *a = ct_arena_create();
    open_outputs(&o, pendulum_text(a, k), CT_OUTPUTS_OF_SOLUTIONS);
    const size_t ny = o.v.m->nq + o.v.m->nu + 1;
    const struct ct_tolerance tolerance = {1e-6, 1e-6};
    double *e = CT_NEWN(a, double, ny), *largest = CT_NEWN(a, double, o.outputs.n);
    assert_int_equal(o.outputs.n, 1);
    for (int i = 0; i < 80; i++) {
        o.v.y[0] += 1e-3;
        ct_output_sensitivity_error(o.sensitivity, 0, o.v.y, e, largest, &tolerance);
    }
    *is_sensitive = ct_output_sensitivity_is_sensitive(o.sensitivity, 0);
    const long n = o.evaluations;
    close_outputs(&o);
    ct_arena_destroy(a);
    return n;
}

// Sensitivities of accelerations take two evaluations. In 80 steps they are found five to fifteen
// times, and nothing is evaluated in between where no output is sensitive.
static void sensitivities_are_found_in_some_steps(void **state)
{
    (void)state;
    bool is_sensitive;
    const long soft = evaluations_of_steps("1", &is_sensitive);
    assert_false(is_sensitive);
    assert_in_range(soft, 3 * 5, 3 * 15);
    const long stiff = evaluations_of_steps("1e9", &is_sensitive);
    assert_true(is_sensitive);
    assert_in_range(stiff, 160 + 2 * 5, 160 + 2 * 15);
}

// Watt's linkage: two cranks of 1 m, whose coupler of 0.5 m has its middle on a nearly straight
// line; half-way the coupler is upright.
static const char *watt_text(struct ct_arena *a, const char *value)
{
    return text_of(
        a,
        "cotree: 1\ngravity: [0, -9.81, 0]\nbodies:\n"
        "  ground: {points: {far: [2, 0.5, 0]}}\n"
        "  left: {mass: 1, inertia: 0.1, points: {end: [1, 0, 0]}}\n"
        "  coupler: {mass: 1, inertia: 0.1, points: {mid: [0, 0.25, 0], end: [0, 0.5, 0]}}\n"
        "  right: {mass: 1, inertia: 0.1, points: {end: [-1, 0, 0]}}\n"
        "joints:\n"
        "  a: {type: revolute, from: ground, to: left, initial: {q: 0}}\n"
        "  b: {type: revolute, from: left.end, to: coupler, initial: {q: 0, guess: true}}\n"
        "  d: {type: revolute, from: ground.far, to: right, initial: {q: 0, guess: true}}\n"
        "  c: {type: revolute, from: coupler.end, to: right.end, initial: {q: 0, guess: "
        "true}}\n"
        "outputs: [{name: g, value: \"%s\"}]\n",
        value);
}

static bool is_constrained(const char *value)
{
    struct observed o;
    struct ct_arena *a = ct_arena_create();
    open_outputs(&o, watt_text(a, value), CT_OUTPUTS_OF_STATES);
    assert_int_equal(o.outputs.n, 1);
    const struct ct_tolerance tolerance = {1e-3, 1e-3};
    assert_true(ct_constrained_output_find(o.constrained, &o.record, 0, o.v.y, &tolerance));
    const bool is_found = o.record.is_found[0];
    close_outputs(&o);
    ct_arena_destroy(a);
    return is_found;
}

// The sum of the angles about the loop does not change. The middle of the coupler leaves its line
// only by a power of the displacement, and the line itself is not fixed.
static void a_straight_line_is_no_constraint(void **state)
{
    (void)state;
    assert_true(is_constrained("1 + a.q + b.q + c.q - d.q"));
    assert_false(is_constrained("coupler.mid.position.x"));
    assert_false(is_constrained("1 + coupler.mid.position.y"));
}

int main(void)
{
    chance_start();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sensitivities_are_found_in_some_steps),
        cmocka_unit_test(a_straight_line_is_no_constraint),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
