// What must not matter: where a mechanism stands, the order of its lines, whether it is taken as
// planar.
#include "tests/property/mechanism.h"
#include "tests/property/system.h"

static double largest(const double *v, size_t n)
{
    double max = 0;
    for (size_t i = 0; i < n; i++)
        max = fmax(max, fabs(v[i]));
    return max;
}

// Results of b under the names of a, where both know them.
static bool same_results(const char *name, const struct variant *a, const struct variant *b,
                         double tolerance)
{
    const double scale = 1 + largest(a->result, a->e.nresult);
    bool ok = true;
    for (size_t i = 0; i < a->e.nresult; i++) {
        const size_t k = variant_result(b, a->e.result[i].name);
        if (!a->e.result[i].undetermined && !b->e.result[k].undetermined)
            ok &= agree(name, a->e.result[i].name, b->result[k], a->result[i], scale,
                        tolerance);
    }
    return ok;
}

static void solve_at(struct variant *v, const struct ct_initial_state *state, double t)
{
    variant_set(v, state, t);
    assert_true(variant_solve(v));
}

// Relative motion and, in axes of the joints, reactions.
static void put_out_joints(struct system *s)
{
    struct ct_arena *a = s->ctx.model;
    system_no_outputs(s);
    for (size_t i = 0; i < s->model.njoint; i++) {
        const struct ct_instance *j = &s->model.joint[i];
        if (j->from >= 0 && j->nfree > 0) {
            system_output(s, text_of(a, "%s.q", j->name));
            system_output(s, text_of(a, "%s.u", j->name));
            system_output(s, text_of(a, "%s.a", j->name));
        }
        // axes of particles are those of ground, not of the mechanism
        if (j->from >= 0 && !s->model.body[s->model.frame[j->from].body].is_particle) {
            system_output(s, text_of(a, "%s.force", j->name));
            system_output(s, text_of(a, "%s.torque", j->name));
        }
    }
}

// ---- place and direction ------------------------------------------------------------------------

static struct rigid_motion random_motion(void)
{
    struct rigid_motion m = {.angle = 3 * chance()};
    double norm = 0;
    for (int i = 0; i < 3; i++) {
        m.p[i] = chance();
        m.axis[i] = chance();
        norm += m.axis[i] * m.axis[i];
    }
    for (int i = 0; i < 3; i++)
        m.axis[i] /= sqrt(norm);
    return m;
}

// Coordinates of joints carry over, those of bodies do not; joints come first.
static size_t count_joint_coordinates(const struct system *s)
{
    size_t n = 0;
    while (n < s->assembly.ncoordinate
           && s->assembly.build->topology->edge[s->assembly.coordinate[n].edge].kind
                  == CT_EDGE_JOINT)
        n++;
    return n;
}

// Bodies that no joint holds start at the ground's origin, in its axes, wherever the rest is.
static bool all_hang_on_joints(const struct system *s)
{
    for (size_t i = 0; i < s->assembly.ncoordinate; i++)
        if (s->assembly.build->topology->edge[s->assembly.coordinate[i].edge].kind
                == CT_EDGE_BODY
            && s->assembly.coordinate[i].q >= 0)
            return false;
    return true;
}

static bool motion_is_carried_along(const struct mechanism *mechanism, bool keep_all)
{
    struct ct_arena *a = ct_arena_create();
    struct system s[2];
    struct variant v[2];
    const struct rigid_motion move = random_motion();
    for (int k = 0; k < 2; k++) {
        system_open_text(&s[k], mechanism->name,
                         mechanism_text(a, mechanism, k ? &move : NULL, 0, false));
        if (keep_all)
            system_keep_all(&s[k]);
        put_out_joints(&s[k]);
        variant_open(&s[k], keep_all ? &by_joints_spatial : &by_joints, &v[k]);
    }
    bool ok = s[0].assembly.is_planar == s[1].assembly.is_planar;
    for (int random = 0; random < 2 && all_hang_on_joints(&s[0]); random++) {
        struct ct_initial_state state[2];
        const double t = 0.6 * random;
        for (int k = 0; k < 2; k++)
            state[k] = s[k].start;
        if (random) {
            assert_true(system_random_state(&s[0], t, 0.5, &state[0]));
            state[0].n = count_joint_coordinates(&s[0]);
            state[1] = state[0];
        }
        for (int k = 0; k < 2; k++)
            solve_at(&v[k], &state[k], t);
        // the start is assembled anew: to 1e-9, which loops amplify
        ok &= same_results(s[0].name, &v[0], &v[1], random ? 1e-10 : 1e-9);
    }
    for (int k = 0; k < 2; k++) {
        variant_close(&v[k]);
        system_close(&s[k]);
    }
    ct_arena_destroy(a);
    return ok;
}

static void moving_and_turning_the_whole_leaves_relative_motion_unchanged(void **state)
{
    (void)state;
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < nmechanism; i++)
        for (int k = 0; k < 1 + mechanisms[i].is_planar; k++)
            ok &= motion_is_carried_along(&mechanisms[i], k);
    assert_true(ok);
}

// ---- order of lines -----------------------------------------------------------------------------

static bool order_does_not_matter(const struct mechanism *mechanism)
{
    struct ct_arena *a = ct_arena_create();
    struct system s[2];
    struct variant v[2];
    for (int k = 0; k < 2; k++) {
        system_open_text(&s[k], mechanism->name, mechanism_text(a, mechanism, NULL, 0, k));
        put_out_joints(&s[k]);
        variant_open(&s[k], k ? &by_choice : &by_joints, &v[k]);
        solve_at(&v[k], &s[k].start, 0);
    }
    bool ok = s[0].assembly.is_planar == s[1].assembly.is_planar;
    ok &= same_results(s[0].name, &v[0], &v[1], 1e-11);
    for (int k = 0; k < 2; k++) {
        variant_close(&v[k]);
        system_close(&s[k]);
    }
    ct_arena_destroy(a);
    return ok;
}

static void order_of_lines_leaves_the_motion_unchanged(void **state)
{
    (void)state;
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < nmechanism; i++)
        for (int k = 0; k < 3; k++)
            ok &= order_does_not_matter(&mechanisms[i]);
    assert_true(ok);
}

// ---- plane and space ----------------------------------------------------------------------------

static bool plane_is_as_space(struct system *s)
{
    struct variant plane, space;
    struct ct_initial_state state;
    system_no_outputs(s);
    system_output_motion(s);
    system_output_reactions(s);
    variant_open(s, &by_joints, &plane);
    assert_true(plane.e.is_planar);
    system_keep_all(s);
    variant_open(s, &by_joints_spatial, &space);
    assert_false(space.e.is_planar);
    assert_true(system_random_state(s, 0.1, 0.5, &state));
    state.n = count_joint_coordinates(s);
    solve_at(&plane, &state, 0.1);
    solve_at(&space, &state, 0.1);
    const bool ok = same_results(s->name, &plane, &space, 1e-9);
    variant_close(&space);
    variant_close(&plane);
    return ok;
}

static void planar_models_move_as_spatial_ones(void **state)
{
    (void)state;
    bool ok = true;
    size_t tried = 0;
    chance_start();
    for (size_t i = 0; i < nshipped + nmechanism; i++) {
        struct system s;
        struct ct_arena *a = ct_arena_create();
        if (i < nshipped)
            system_open_file(&s, shipped[i]);
        else
            system_open_text(&s, mechanisms[i - nshipped].name,
                             mechanism_text(a, &mechanisms[i - nshipped], NULL, 0, false));
        if (s.assembly.is_planar && s.model.nbody < 10) {
            ok &= plane_is_as_space(&s);
            tried++;
        }
        system_close(&s);
        ct_arena_destroy(a);
    }
    assert_true(ok);
    assert_true(tried > 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moving_and_turning_the_whole_leaves_relative_motion_unchanged),
        cmocka_unit_test(order_of_lines_leaves_the_motion_unchanged),
        cmocka_unit_test(planar_models_move_as_spatial_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
