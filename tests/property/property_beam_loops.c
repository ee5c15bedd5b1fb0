// Beams with lumped masses in closed loops in space: what runs must keep, and what must not change
// them.
#include "tests/property/system.h"

enum { NSAMPLE = 11 };

struct motion {
    double value[NSAMPLE][8];
    size_t n, row;
};

static bool at_row(void *user, double t, const double *value, size_t n)
{
    struct motion *m = user;
    (void)t;
    assert_true(n <= COUNT(m->value[0]) && m->row < NSAMPLE);
    memcpy(m->value[m->row++], value, n * sizeof *value);
    m->n = n;
    return true;
}

static const char body[] = "  lump: {mass: 0.02, inertia: 1e-5, com: [0, 0.01, 0]}\n",
                  joints[]
                  = "  seat: {type: weld, from: %s, to: lump}\n"
                    "outputs: [main.q, swing.q, rod.mid.deflection.y, rod.mid.deflection.z, "
                    "energy.total, energy.strain, energy.kinetic]\n";
enum { ANGLE, SWING, DEFLECTION_Y, DEFLECTION_Z, TOTAL, STRAIN, KINETIC };

struct coupler {
    const char *keys, *seat;
};

// 0.03 s of the crank with 10 rad/s.
static struct motion run(const struct coupler *c, const char *mass, int n,
                         const struct ct_formulate_options *o, double rtol)
{
    struct system s;
    struct variant v;
    struct motion m = {0};
    struct ct_arena *a = ct_arena_create();
    const char *keys = text_of(a, "%s, %s", mass, c->keys);
    system_open_text(&s, keys, coupler_text(a, n, keys, body, text_of(a, joints, c->seat)));
    variant_open(&s, o, &v);
    struct ct_run_report report;
    const struct ct_run_options options = {.method = ct_method_find("dop853"),
                                           .duration = 0.03,
                                           .rtol = rtol,
                                           .atol = rtol / 100,
                                           .nsample = NSAMPLE,
                                           .row = at_row,
                                           .user = &m};
    struct ct_run *r = ct_run_create(&v.ctx, v.arena, &s.model, &v.e, &s.start);
    if (!r || !ct_run_simulate(r, &options, &report)) {
        print_error("%s: no run\n", keys);
        ct_ctx_print(&v.ctx, stderr);
        fail();
    }
    variant_close(&v);
    system_close(&s);
    ct_arena_destroy(a);
    return m;
}

// The largest difference over the samples.
static double apart(const struct motion *a, const struct motion *b, int k)
{
    double most = 0;
    for (size_t i = 0; i < NSAMPLE; i++)
        most = fmax(most, fabs(a->value[i][k] - b->value[i][k]));
    return most;
}

static double most(const struct motion *a, int k)
{
    double most = 0;
    for (size_t i = 0; i < NSAMPLE; i++)
        most = fmax(most, fabs(a->value[i][k]));
    return most;
}

static const struct coupler couplers[] = {
    {"frame: chord", "rod.mid"},
    {"frame: clamped, rotary_inertia: [8e-6, 3e-6, 5e-6]", "rod.mid"},
    {"frame: chord, theory: timoshenko, shear_factor: 0.85, integration: reduced", "rod.mid"},
    {"frame: clamped, theory: timoshenko, shear_factor: 0.85, integration: reduced", "rod"},
};

static void trees_do_not_change_lumped_couplers(void **state)
{
    (void)state;
    bool ok = true;
    for (size_t i = 0; i < COUNT(couplers); i++) {
        const struct coupler *c = &couplers[i];
        const struct motion m = run(c, "mass: lumped", 3, &by_choice, 1e-10),
                            joints_first = run(c, "mass: lumped", 3, &by_joints, 1e-10),
                            bodies_first = run(c, "mass: lumped", 3, &by_bodies, 1e-10);
        assert_true(most(&m, STRAIN) > 1e-6 * most(&m, KINETIC)); // it bends
        for (int k = ANGLE; k <= DEFLECTION_Z; k++) {
            const double scale = fmax(most(&m, k), 1e-4); // runs keep 1e-12 of their own
            ok &= agree(c->keys, "by joints", apart(&m, &joints_first, k), 0, scale, 1e-8);
            ok &= agree(c->keys, "by bodies", apart(&m, &bodies_first, k), 0, scale, 1e-8);
        }
        for (size_t k = 0; k < NSAMPLE; k++)
            ok &= agree(c->keys, "energy", m.value[k][TOTAL], m.value[0][TOTAL],
                        most(&m, KINETIC), 1e-9);
    }
    assert_true(ok);
}

// Half of each element's mass at its ends moves the beam as if its mass were spread, but for the
// square of the elements' length.
static void lumped_couplers_tend_to_consistent_ones(void **state)
{
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        const struct coupler *c = &couplers[i];
        const struct motion exact = run(c, "mass: consistent", 6, &by_choice, 1e-7),
                            few = run(c, "mass: lumped", 3, &by_choice, 1e-7),
                            more = run(c, "mass: lumped", 6, &by_choice, 1e-7);
        for (int k = ANGLE; k <= SWING; k++) {
            const double order = log2(apart(&few, &exact, k) / apart(&more, &exact, k));
            print_message("%s: order %.3f\n", c->keys, order);
            assert_in_range((long)lround(10 * order), 19, 21);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_do_not_change_lumped_couplers),
        cmocka_unit_test(lumped_couplers_tend_to_consistent_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
