// The motion that the page of a report shows: places and rotations against those of a state, loads
// and reactions against Newton's law, and what is written of them.
#include "tests/check.h"
#include "draw/animation.h"
#include "report/packed.h"
#include "sim/sim.h"
#include "solve/run/run_internal.h"

#include <stdlib.h>
#include <string.h>

static struct ct_ctx *ctx;

static struct run {
    struct ct_system *sys;
    struct ct_sim *sim;
    struct ct_animation animation;
    size_t most;
    char *text; // as written
} r;

static bool create(void *task)
{
    (void)task;
    ct_animation_create(r.sys->own.model, r.sys->equations.build, CT_ANIMATION_FORCES,
                        &r.animation);
    return true;
}

static bool compile(void *task)
{
    (void)task;
    ct_animation_compile(r.sim->own.model, &r.animation, ct_run_evaluator(r.sim->run));
    return true;
}

static bool at_row(void *user, double t, const double *value, size_t n)
{
    (void)user;
    (void)value;
    (void)n;
    if (r.animation.values.uses_multipliers)
        ct_run_find_multipliers(r.sim->run);
    ct_animation_keep(&r.animation, ct_run_evaluator(r.sim->run), t);
    return true;
}

static bool write_text(void *task)
{
    size_t n;
    FILE *out = open_memstream(&r.text, &n);
    struct ct_json j;
    (void)task;
    ct_json_init(&j, out);
    ct_json_object(&j, NULL);
    ct_animation_write(r.sys->own.scratch, &j, &r.animation, r.most);
    ct_json_end(&j);
    fclose(out);
    return true;
}

static void follow(struct ct_system *sys, double until, long samples)
{
    r = (struct run){.sys = sys, .most = 100};
    assert_non_null(sys);
    assert_true(ct_enter(ctx, create, NULL));
    r.sim
        = ct_sim_create(ctx, sys, &(struct ct_sim_options){.until = until, .samples = samples});
    assert_non_null(r.sim);
    assert_true(ct_enter(ctx, compile, NULL));
    assert_true(ct_sim_run(ctx, r.sim, &(struct ct_sim_results){.row = at_row}));
    assert_int_equal(r.animation.nrow, samples);
}

static void leave(void)
{
    free(r.text);
    ct_sim_destroy(r.sim);
    ct_system_destroy(r.sys);
}

static struct ct_system *load_shipped(const char *name)
{
    char path[1024];
    const char *tests = getenv("CT_TEST_DIR");
    snprintf(path, sizeof path, "%s/../systems/%s/model.yaml", tests ? tests : "tests", name);
    return ct_system_load(ctx, path, NULL);
}

static const double *last_row(void)
{
    return r.animation.row + (r.animation.nrow - 1) * r.animation.ncolumn;
}

// out = place + q v q*
static void place_by_quaternion(const double *pose, const double v[3], double out[3])
{
    const double w = pose[3], *u = pose + 4;
    double c[3], d[3];
    for (int i = 0; i < 3; i++)
        c[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3] + w * v[i];
    for (int i = 0; i < 3; i++)
        d[i] = u[(i + 1) % 3] * c[(i + 2) % 3] - u[(i + 2) % 3] * c[(i + 1) % 3];
    for (int i = 0; i < 3; i++)
        out[i] = pose[i] + v[i] + 2 * d[i];
}

// ---- places -----------------------------------------------------------------------------------

// A state that is stepped there by itself; both are held to errors of 1e-8 of places near 1 m.
static void frames_are_where_a_state_has_them(void **state)
{
    (void)state;
    static const char *const names[] = {"puma560", "stewart", "slider_crank_flexible"};
    for (size_t k = 0; k < COUNT(names); k++) {
        const double until = 0.1, ground[7] = {0, 0, 0, 1, 0, 0, 0}, accuracy = 1e-6;
        follow(load_shipped(names[k]), until, 5);
        struct ct_system *other = load_shipped(names[k]);
        struct ct_data *d = ct_data_create(ctx, other, NULL);
        assert_true(ct_data_step(ctx, d, until));
        const struct ct_animation *m = &r.animation;
        assert_true(m->scene.model->nframe > 3);
        for (size_t f = 0; f < m->scene.model->nframe; f++) {
            double R[9], p[3], got[3], ahead[3];
            const size_t pose = (size_t)m->pose_of[f];
            const double *q = pose ? last_row() + ct_animation_pose_column(m, pose) : ground;
            assert_true(ct_data_pose(ctx, d, f, R, p));
            place_by_quaternion(q, m->local[f], got);
            for (int i = 0; i < 3; i++)
                CHECK_CLOSE(got[i], p[i], 0, accuracy);
            for (int axis = 0; axis < 3; axis++) { // the end of a unit vector of the frame
                for (int i = 0; i < 3; i++)
                    ahead[i] = m->local[f][i] + m->turn[f][3 * axis + i];
                place_by_quaternion(q, ahead, got);
                for (int i = 0; i < 3; i++)
                    CHECK_CLOSE(got[i], p[i] + R[3 * i + axis], 0, accuracy);
            }
        }
        ct_data_destroy(d);
        ct_system_destroy(other);
        leave();
    }
}

static void beams_end_at_their_last_frames(void **state)
{
    (void)state;
    follow(load_shipped("slider_crank_flexible"), 0.1, 5);
    const struct ct_animation *m = &r.animation;
    assert_int_equal(m->scene.nbeam, 2);
    for (size_t i = 0; i < m->scene.nbeam; i++) {
        const struct ct_scene_beam *beam = &m->scene.beam[i];
        const double *point = last_row() + ct_animation_beam_column(m, i);
        const double *base = last_row() + ct_animation_pose_column(m, (size_t)beam->body);
        double end[3], nearest = INFINITY;
        place_by_quaternion(base, point + 3 * (beam->npoint - 1), end);
        for (size_t p = m->scene.model->nbody; p < m->npose; p++) { // frames of beams
            const double *at = last_row() + ct_animation_pose_column(m, p);
            nearest
                = fmin(nearest, hypot(hypot(at[0] - end[0], at[1] - end[1]), at[2] - end[2]));
        }
        CHECK_CLOSE(nearest, 0, 0, 1e-12); // round-off
    }
    leave();
}

// Of a body that tumbles many times q and -q are the same rotation; between samples only one way is
// short.
static void quaternions_keep_their_sign(void **state)
{
    (void)state;
    follow(load_shipped("tumbling_body"), 10, 501);
    const struct ct_animation *m = &r.animation;
    for (size_t i = 1; i < m->nrow; i++) {
        const double *q = m->row + i * m->ncolumn + 3, *before = q - m->ncolumn;
        double along = 0, size = 0;
        for (int k = 0; k < 4; k++) {
            along += q[k] * before[k];
            size += q[k] * q[k];
        }
        assert_true(along > 0.9);
        CHECK_CLOSE(size, 1, 0, 1e-14);
    }
    leave();
}

// ---- forces -----------------------------------------------------------------------------------

static const char pendulum[]
    = "cotree: 1\n"
      "gravity: [0, -10, 0]\n"
      "bodies:\n"
      "  bob: {mass: 2, com: [0.5, 0, 0], inertia: [0.01, 0.1, 0.1]}\n"
      "joints:\n"
      "  pivot: {type: revolute, from: ground, to: bob, initial: {q: 0, u: 3}}\n"
      "forces:\n"
      "  push: {type: force, at: bob, value: [7, 0, 0]}\n"
      "simulation: {duration: 1, samples: 11}\n";

// At q = 0, u = 3: the centre is accelerated by -u^2 c along x, by alpha c along y; alpha = -m g c
// / (I + m c^2).
static void joints_carry_what_bodies_need(void **state)
{
    (void)state;
    follow(ct_system_load_text(ctx, pendulum, strlen(pendulum), "pendulum.yaml", NULL), 1, 11);
    const struct ct_animation *m = &r.animation;
    const double *load = m->row + ct_animation_load_column(m, 0),
                 *reaction = m->row + ct_animation_reaction_column(m, 0);
    const double mass = 2, c = 0.5, g = 10, u = 3, alpha = -mass * g * c / (0.1 + mass * c * c);
    const double roundoff = 1e-12;
    CHECK_CLOSE(load[0], 7, 0, 0);
    CHECK_CLOSE(reaction[0], -mass * u * u * c - 7, roundoff, 0);
    CHECK_CLOSE(reaction[1], mass * (alpha * c + g), roundoff, 0);
    CHECK_CLOSE(reaction[2], 0, 0, 0);
    leave();
}

// ---- what is written --------------------------------------------------------------------------

static void long_runs_are_thinned(void **state)
{
    (void)state;
    follow(ct_system_load_text(ctx, pendulum, strlen(pendulum), "pendulum.yaml", NULL), 1, 11);
    static const struct {
        size_t most;
        const char *thinned, *count;
    } cases[] = {{11, "\"thinned\": 1", "\"count\": 11"},
                 {10, "\"thinned\": 2", "\"count\": 6"},
                 {4, "\"thinned\": 4", "\"count\": 4"}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        r.most = cases[i].most;
        assert_true(ct_enter(ctx, write_text, NULL));
        assert_non_null(strstr(r.text, cases[i].thinned));
        assert_non_null(strstr(r.text, cases[i].count));
        free(r.text);
        r.text = NULL;
    }
    leave();
}

static void geometry_has_bodies_joints_and_views(void **state)
{
    (void)state;
    follow(load_shipped("heavy_top"), 0.1, 3);
    assert_true(ct_enter(ctx, write_text, NULL));
    static const char *const wanted[]
        = {"\"view\": \"iso\"",         "\"normal\": null",    "\"name\": \"top\"",
           "\"kind\": \"cylinder\"",    "\"kind\": \"lines\"", "\"symbol\": \"ball\"",
           "\"gravity\": [0, 0, -9.81]"};
    for (size_t i = 0; i < COUNT(wanted); i++)
        if (!strstr(r.text, wanted[i]))
            fail_msg("no %s", wanted[i]);
    leave();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_are_where_a_state_has_them),
        cmocka_unit_test(beams_end_at_their_last_frames),
        cmocka_unit_test(quaternions_keep_their_sign),
        cmocka_unit_test(joints_carry_what_bodies_need),
        cmocka_unit_test(long_runs_are_thinned),
        cmocka_unit_test(geometry_has_bodies_joints_and_views),
    };
    ctx = ct_ctx_create();
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    ct_ctx_destroy(ctx);
    return failed;
}
