// Models as read: what ends up in struct ct_model. What is refused is in tests/broken.
#include "base/guard.h"
#include "component/model.h"
#include "integrate/problem.h"
#include "tests/unit/read_state.h"

#include <stdlib.h>
#include <string.h>

static void read_set(struct bench *s, const char *text, const struct ct_set *set, size_t nset)
{
    const bool ok = ct_model_parse(&s->ctx, "m.yaml", text, strlen(text), set, nset, &s->m);
    if (!ok)
        ct_ctx_print(&s->ctx, stderr);
    assert_true(ok);
    assert_int_equal(s->ctx.nerror, 0);
}

static void read_text(struct bench *s, const char *text)
{
    read_set(s, text, NULL, 0);
}

static double number(const struct bench *s, ct_ex e)
{
    return ct_model_number(&s->m, e);
}

static const struct ct_value *value(const struct bench *s, const char *joint, const char *key)
{
    return ct_instance_value(&s->m.joint[ct_model_find_joint(&s->m, joint)], key);
}

// values that are folded by one operation on numbers
static void check(double got, double want)
{
    CHECK_CLOSE(got, want, 1e-15, 0);
}

static const char header[] = "cotree: 1\n";

static void a_model_of_one_line_has_the_ground_and_defaults(void **state)
{
    struct bench *s = *state;
    read_text(s, header);
    assert_int_equal(s->m.nbody, 1);
    assert_int_equal(s->m.nframe, 1);
    assert_string_equal(s->m.frame[0].name, "ground");
    assert_string_equal(s->m.name, "m");
    assert_int_equal(s->m.simulation.samples, 1001);
    assert_false(s->m.simulation.has_duration);
    check(s->m.simulation.rtol, 1e-8);
    check(s->m.simulation.atol, 1e-10);
    assert_string_equal(s->m.simulation.method, "auto");
    assert_true(ct_ex3_is_zero(s->m.gravity));
}

static void parameters_are_ordered_for_computing(void **state)
{
    struct bench *s = *state;
    read_text(s, "cotree: 1\nparameters:\n  c: a*b\n  a: 304 mm\n  b: \"2*a + k\"\n  k: .5\n");
    assert_int_equal(s->m.nparameter, 4);
    for (size_t i = 0; i < 4; i++) {
        const struct ct_parameter *p = &s->m.parameter[i];
        assert_int_equal(ct_ex_symbol(s->m.x, p->symbol)->index, i);
        check(number(s, p->symbol), p->value);
        check(number(s, p->definition), p->value);
    }
    assert_string_equal(s->m.parameter[0].name, "a");
    assert_string_equal(s->m.parameter[3].name, "c");
    check(s->m.parameter[3].value, 0.304 * (2 * 0.304 + 0.5));
}

static void overrides_replace_definitions(void **state)
{
    struct bench *s = *state;
    const struct ct_set set[] = {{"a=20 mm"}, {"b=3*a"}};
    read_set(s, "cotree: 1\nparameters: {a: 1, b: 2, c: a + b}\nbodies: {p: {mass: c}}\n", set,
             2);
    check(number(s, s->m.body[1].mass), 0.08);
    double v;
    assert_false(ct_ex_is_const(s->m.x, s->m.body[1].mass, &v)); // stays a symbol
}

static void bodies_own_frames_for_their_points(void **state)
{
    struct bench *s = *state;
    read_text(s, "cotree: 1\n"
                 "gravity: [0, \"-9.81 m/s^2\", 0]\n"
                 "bodies:\n"
                 "  rod:\n"
                 "    mass: 2 kg\n"
                 "    inertia: [1, 2, 2.5, 0.1, 0.2, 0.3]\n"
                 "    com: [100 mm, 0, 0]\n"
                 "    points:\n"
                 "      tip: [1, 0, 0]\n"
                 "      eye: {at: [0, 2, 0], rotate: [[z, 90 deg], [[0, 3, 4], 0.1]]}\n"
                 "  ground: {points: {wall: {rotate: [[0, 0, 2], 1]}}}\n"
                 "  ball: {type: particle, mass: 1}\n"
                 "  disc: {inertia: 3}\n");
    check(number(s, s->m.gravity.e[1]), -9.81);
    assert_string_equal(s->m.frame[1].name, "ground.wall");
    assert_int_equal(s->m.frame[1].nturn, 1);
    const struct ct_body *rod = &s->m.body[ct_model_find_body(&s->m, "rod")];
    const double inertia[] = {1, 2, 2.5, 0.1, 0.2, 0.3};
    for (int i = 0; i < 6; i++)
        check(number(s, rod->inertia[i]), inertia[i]);
    check(number(s, rod->com.e[0]), 0.1);
    const struct ct_frame *eye = &s->m.frame[ct_model_find_frame(&s->m, "rod.eye")];
    assert_int_equal(eye->body, ct_model_find_body(&s->m, "rod"));
    assert_int_equal(eye->nturn, 2);
    check(number(s, eye->turn[0].angle), 1.5707963267948966);
    check(number(s, eye->turn[1].axis.e[2]), 0.8);
    assert_true(s->m.body[ct_model_find_body(&s->m, "ball")].is_particle);
    const struct ct_body *disc = &s->m.body[ct_model_find_body(&s->m, "disc")];
    check(number(s, disc->inertia[2]), 3);
    check(number(s, disc->inertia[3]), 0);
}

static const char two_bodies[] = "cotree: 1\n"
                                 "parameters: {k: 2}\n"
                                 "bodies: {a: {mass: 1}, b: {mass: 1}, p: {type: particle}}\n"
                                 "joints:\n";

static void read_joints(struct bench *s, const char *joints)
{
    read_text(s, ct_arena_printf(s->ctx.model, "%s%s", two_bodies, joints));
}

static void joints_have_one_entry_per_speed(void **state)
{
    struct bench *s = *state;
    read_joints(
        s, "  c: {type: cylindrical, from: ground, to: a, axis: [0, 0, 5], "
           "stiffness: [k, 3 N*m/rad], motion: [~, 2*t], initial: {q: [1 mm, ~], u: [~, 2]}}\n"
           "  f: {type: free, from: a, to: b, damping: [1, 1, 1, 2, 2, 2], "
           "initial: {q: [1, 2, 3], rotate: [z, 0.4], guess: true}}\n"
           "  s: {type: spherical, from: a, to: b, initial: {q: [1, 0, 0, 0], u: [1, 2, 3]}}\n"
           "  r: {type: revolute, from: a, to: b, effort: \"-3*r.u + sin(t)\"}\n");
    const struct ct_value *motion = value(s, "c", "motion"),
                          *stiffness = value(s, "c", "stiffness");
    assert_int_equal(motion->n, 2);
    assert_true(motion->hole[0] && !motion->hole[1]);
    check(number(s, stiffness->e[0]), 2);
    check(number(s, value(s, "c", "axis")->e[2]), 1);
    const struct ct_instance *c = &s->m.joint[0], *f = &s->m.joint[1], *r = &s->m.joint[3];
    check(number(s, c->initial.q.e[0]), 1e-3);
    assert_true(c->initial.q.hole[1] && c->initial.u.hole[0]);
    assert_int_equal(f->ncoord, 7);
    assert_int_equal(f->nfree, 6);
    assert_int_equal(f->initial.q.n, 3);
    assert_int_equal(f->initial.rotate.nturn, 1);
    assert_true(f->initial.guess && !c->initial.guess);
    assert_int_equal(s->m.joint[2].initial.q.n, 4);
    const unsigned kinds = ct_ex_kinds(s->m.x, ct_instance_value(r, "effort")->e[0]);
    assert_int_equal(kinds, 1u << CT_SYM_TIME | 1u << CT_SYM_SIGNAL);
    assert_false(ct_instance_value(r, "rest")->given);
}

static void beside_a_particle_only_lengths_remain(void **state)
{
    struct bench *s = *state;
    read_joints(s, "  r: {type: revolute, from: ground, to: p}\n"
                   "  c: {type: cylindrical, from: ground, to: p, initial: {q: 1}}\n"
                   "  f: {type: free, from: p, to: a, initial: {q: [1, 2, 3]}}\n"
                   "  n: {type: planar, from: p, to: a, stiffness: [1 N/m, 2 N/m]}\n");
    const int want[] = {0, 1, 3, 2};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(s->m.joint[i].ncoord, want[i]);
        assert_int_equal(s->m.joint[i].nfree, want[i]);
    }
}

static void a_custom_joint_knows_its_own_coordinates(void **state)
{
    struct bench *s = *state;
    read_joints(s, "  j: {type: custom, from: ground, to: a, coordinates: [r, phi], "
                   "translate: [r*cos(phi), k*r, 0], rotate: [z, phi], effort: [-3*r, t]}\n"
                   "  g: {type: gear, joints: [j.q1, j.q2], ratio: 2}\n");
    const struct ct_instance *j = &s->m.joint[0];
    assert_int_equal(j->ncoord, 2);
    assert_true(ct_ex_same(ct_instance_value(j, "rotate")->turn[0].angle, j->local[1]));
    const ct_ex effort = ct_instance_value(j, "effort")->e[0];
    assert_int_equal(ct_ex_kinds(s->m.x, effort), 1u << CT_SYM_SIGNAL);
    bool found = false;
    for (size_t i = 0; i < s->m.x->nsym; i++)
        found |= strcmp(s->m.x->sym[i].name, "j.q1") == 0;
    assert_true(found);
    assert_int_equal(s->m.joint[1].from, -1);
    assert_string_equal(value(s, "g", "joints")->name[1], "j.q2");
}

static void forces_end_at_the_frame_they_act_on(void **state)
{
    struct bench *s = *state;
    read_joints(s, "  r: {type: revolute, from: a, to: b}\n"
                   "forces:\n"
                   "  f: {type: force, at: b, value: [0, r.q, 0], in: a}\n"
                   "  s: {type: spring, from: a, to: b, stiffness: 3}\n"
                   "  q: {type: torque, on: a, value: [0, 0, t]}\n");
    const int a = ct_model_find_frame(&s->m, "a"), b = ct_model_find_frame(&s->m, "b");
    assert_int_equal(s->m.force[0].from, -1);
    assert_int_equal(s->m.force[0].to, b);
    assert_int_equal(ct_instance_value(&s->m.force[0], "in")->frame, a);
    assert_int_equal(s->m.force[1].from, a);
    assert_int_equal(s->m.force[1].to, b);
    assert_int_equal(s->m.force[2].to, a);
    assert_int_equal(ct_instance_value(&s->m.force[2], "in")->frame, -1);
}

static void a_signal_has_one_symbol(void **state)
{
    struct bench *s = *state;
    read_joints(s, "  r: {type: revolute, from: a, to: b, effort: r.u}\n"
                   "outputs:\n"
                   "  - r.u\n"
                   "  - b.position\n"
                   "  - a.velocity.x in b\n"
                   "  - {name: \"twice, the rate\", value: 2*r.u + k}\n");
    assert_int_equal(s->m.noutput, 4);
    assert_true(s->m.output[0].is_signal);
    assert_true(ct_ex_same(s->m.output[0].value, value(s, "r", "effort")->e[0]));
    assert_string_equal(s->m.output[2].name, "a.velocity.x in b");
    assert_false(s->m.output[3].is_signal);
    assert_int_equal(s->m.output[0].mark.line, 6);
    assert_int_equal(s->m.output[0].mark.column, 4);
}

static void an_interval_gives_samples_with_both_ends(void **state)
{
    struct bench *s = *state;
    read_text(s, "cotree: 1\nsimulation: {duration: 10, interval: 0.01, step: 1 ms, "
                 "method: rk4, rate_jumps: continuous, tolerance: 1e-6}\n");
    assert_int_equal(s->m.simulation.samples, 1001);
    check(s->m.simulation.step, 1e-3);
    check(s->m.simulation.atol, 1e-8);
    assert_string_equal(s->m.simulation.method, "rk4");
    assert_int_equal(s->m.simulation.rate_jumps, CT_RATE_CONTINUOUS);
}

static void every_method_can_be_named(void **state)
{
    struct bench *s = *state;
    for (int i = 0; i < ct_nmethod; i++) {
        read_text(s, ct_arena_printf(s->ctx.model, "cotree: 1\nsimulation: {method: %s}\n",
                                     ct_methods[i]->name));
        assert_string_equal(s->m.simulation.method, ct_methods[i]->name);
    }
}

// Through three points the natural spline follows from one equation; through a line it is that
// line.
static void tables_are_natural_splines(void **state)
{
    struct bench *s = *state;
    FILE *f = fopen("read_test.csv", "wb");
    assert_non_null(f);
    fputs("\xef\xbb\xbft,\"a \"\"b\"\"\",line\r\n0,0,1\r\n1,1,3\r\n3,0,7\r\n", f);
    fclose(f);
    read_joints(s, "  r: {type: revolute, from: a, to: b, "
                   "motion: {table: read_test.csv, column: 'a \"b\"'}}\n"
                   "  q: {type: revolute, from: a, to: b, motion: {table: read_test.csv, "
                   "column: line}}\n"
                   "  v: {type: revolute, from: a, to: b, effort: {table: read_test.csv, "
                   "column: line, interpolate: linear}}\n"
                   "  o: {type: revolute, from: a, to: b, effort: {table: read_test.csv, "
                   "column: line, interpolate: linear}}\n");
    assert_int_equal(s->m.x->ntable, 3); // the last one is shared
    const struct ct_table *t = &s->m.x->table[0];
    assert_int_equal(t->n, 3);
    // one inner point: 2 (h0 + h1) y'' = 6 (d1 - d0), h = 1, 2, d = 1, -1/2
    const double curvature = -1.5;
    check(ct_table_value(t, 2, 1), curvature);
    CHECK_CLOSE(ct_table_value(t, 2, 0), 0, 0, 1e-15);
    CHECK_CLOSE(ct_table_value(t, 2, 3), 0, 0, 1e-15);
    check(ct_table_value(t, 1, 0), 1 - curvature / 6);
    // NOLINTNEXTLINE(clang-analyzer-security.FloatLoopCounter): quarters are exact
    for (double at = 0; at <= 3; at += 0.25)
        check(ct_table_value(&s->m.x->table[1], 0, at), 1 + 2 * at);
    assert_null(s->m.x->table[2].m);
    remove("read_test.csv");
}

static void anchors_share_values(void **state)
{
    struct bench *s = *state;
    read_text(s,
              "cotree: 1\nbodies:\n  a: &body {mass: 2, points: {p: [1, 0, 0]}}\n  b: *body\n");
    check(number(s, s->m.body[2].mass), 2);
    assert_true(ct_model_find_frame(&s->m, "b.p") > 0);
}

// Reads a model while the n-th allocation fails; true if it came to the end.
static bool read_with_failure(const char *path, long n)
{
    static struct ct_model m;
    static bool survived;
    struct ct_ctx ctx = {.model = ct_arena_create(), .scratch = ct_arena_create()};
    struct ct_guard g;
    survived = false;
    ct_guard_push(&g);
    if (!setjmp(g.env)) {
        ct_guard_fail_after(n);
        assert_false(ct_model_read(&ctx, path, NULL, 0, &m));
        assert_int_equal(ctx.nerror, 1); // k.q
        survived = true;
    }
    ct_guard_fail_after(0);
    ct_guard_pop(&g);
    ct_arena_destroy(ctx.model);
    ct_arena_destroy(ctx.scratch);
    return survived;
}

// No crash and, with a leak checker, no leak.
static void without_memory_nothing_leaks(void **state)
{
    (void)state;
    static const char path[] = "read_test_memory.yaml";
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    fputs("cotree: 1\n"
          "parameters: {a: b, b: 2}\n"
          "joints: {j: {type: revolute, from: ground, to: x.p, effort: j.u}}\n"
          "outputs: [j.q, {name: n, value: 2*j.u}, k.q]\n"
          "bodies:\n  x: {mass: a, points: {p: [1, a, 0]}}\n",
          f);
    for (int i = 0; i < 200; i++) // so that memory is asked for several times
        fprintf(f, "  x%d: {mass: a, points: {p: [1, a, 0]}}\n", i);
    fclose(f);
    long n = 1;
    while (!read_with_failure(path, n))
        assert_true(++n < 10000);
    assert_true(n > 5); // some did fail
    remove(path);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, create, destroy)
    const struct CMUnitTest tests[] = {
        CASE(a_model_of_one_line_has_the_ground_and_defaults),
        CASE(parameters_are_ordered_for_computing),
        CASE(overrides_replace_definitions),
        CASE(bodies_own_frames_for_their_points),
        CASE(joints_have_one_entry_per_speed),
        CASE(beside_a_particle_only_lengths_remain),
        CASE(a_custom_joint_knows_its_own_coordinates),
        CASE(forces_end_at_the_frame_they_act_on),
        CASE(a_signal_has_one_symbol),
        CASE(an_interval_gives_samples_with_both_ends),
        CASE(every_method_can_be_named),
        CASE(tables_are_natural_splines),
        CASE(anchors_share_values),
        CASE(without_memory_nothing_leaks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
