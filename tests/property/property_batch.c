// Members side by side: every shipped system that lanes can take ends in a lane where it ends
// alone, and a lane's bits do not depend on what the other lanes do.
#include "solve/batch/batch.h"
#include "tests/property/system.h"

static const struct ct_formulate_options options
    = {.with_energy = true, .with_outputs = true, .with_solution = true};

static double unit; // of end times [s]

// End times and tolerances differ from lane to lane.
static struct ct_run_options member_options(const char *method, int i)
{
    return (struct ct_run_options){.method = ct_method_find(method),
                                   .duration = unit * (1 + i % 3),
                                   .rtol = i % 2 ? 1e-10 : 1e-11,
                                   .atol = 1e-12,
                                   .nsample = 2};
}

// Returns the steps.
static long run_alone(struct variant *v, struct system *s, const char *method, int i,
                      double *out)
{
    struct ct_run *run = ct_run_create(&v->ctx, v->arena, &s->model, &v->e, &s->start);
    const struct ct_run_options o = member_options(method, i);
    struct ct_run_report report;
    assert_non_null(run);
    assert_true(ct_run_simulate(run, &o, &report));
    memcpy(out, report.final, v->e.nresult * sizeof *out);
    return report.stats.steps;
}

// Members first, first + 1, ... of n from lane `lane` on; out: n x nresult. Returns how many lanes
// gave up.
static int run_lanes(struct variant *v, struct system *s, const char *method, int first, int n,
                     int lane, enum ct_backend backend, double *out)
{
    struct ct_run *run = ct_run_create(&v->ctx, v->arena, &s->model, &v->e, &s->start);
    assert_non_null(run);
    ct_evaluator_use(v->arena, ct_run_evaluator(run), backend);
    struct ct_batch *lanes = ct_batch_create(v->arena, &v->e, run, 0);
    int given_up = 0;
    assert_true(ct_run_restart(run, &s->start));
    ct_batch_begin(lanes);
    for (int i = 0; i < n; i++) {
        const struct ct_run_options o = member_options(method, first + i);
        assert_true(ct_run_restart(run, &s->start));
        if (!ct_batch_load(lanes, lane + i, &o))
            return n;
    }
    for (bool is_running = true; is_running;) {
        ct_batch_step(lanes);
        is_running = false;
        for (int l = 0; l < CT_LANES; l++)
            is_running |= ct_batch_state(lanes, l) == CT_LANE_RUNNING;
    }
    for (int i = 0; i < n; i++)
        given_up += ct_batch_state(lanes, lane + i) != CT_LANE_ARRIVED
                 || !ct_batch_results(lanes, lane + i, out + (size_t)i * v->e.nresult);
    return given_up;
}

// Not more steps than are needed to meet all that lanes do.
static void choose_unit(struct variant *v, struct system *s, const char *method)
{
    const double most = 100;
    double *out = CT_NEWN(v->arena, double, v->e.nresult + 1);
    unit = 0.05;
    unit *= fmin(1, most / (double)run_alone(v, s, method, 0, out));
    print_message("%s: members end at %.2g s and later\n", s->name, unit);
}

static bool check_members(struct system *s, struct variant *v, const char *method)
{
    const size_t n = v->e.nresult;
    choose_unit(v, s, method);
    double *lanes = CT_NEWN(v->arena, double, CT_LANES *n + 1);
    double *other = CT_NEWN(v->arena, double, CT_LANES *n + 1);
    double *alone = CT_NEWN(v->arena, double, n + 1);
    bool ok = true;
    if (run_lanes(v, s, method, 0, CT_LANES, 0, CT_BACKEND_BEST, lanes))
        return false;             // alone, all of them
    for (int i = 1; i < 3; i++) { // both tolerances, two of the end times
        run_alone(v, s, method, i, alone);
        for (size_t k = 0; k < n; k++) // both follow the motion to about 1e-9
            ok &= agree(s->name, v->e.result[k].name, lanes[(size_t)i * n + k], alone[k],
                        fmax(1, fabs(alone[k])), 1e-7);
    }
    assert_int_equal(run_lanes(v, s, method, 0, CT_LANES, 0, CT_BACKEND_TAPE, other), 0);
    for (size_t k = 0; k < CT_LANES * n; k++) // native code may fuse products
        ok &= agree(s->name, v->e.result[k % n].name, other[k], lanes[k],
                    fmax(1, fabs(lanes[k])), 1e-8);
    assert_int_equal(run_lanes(v, s, method, 1, 1, 3, CT_BACKEND_BEST, other), 0);
    assert_memory_equal(lanes + n, other, n * sizeof *lanes);
    assert_true(ok);
    return true;
}

static void lanes_end_where_runs_alone_end(void **state)
{
    (void)state;
    enum { LARGE = 20 }; // speeds
    size_t in_lanes = 0;
    for (size_t i = 0; i < nshipped; i++) {
        struct system s;
        struct variant v;
        system_open_file(&s, shipped[i]);
        variant_open(&s, &options, &v);
        if (v.e.nresult) {
            in_lanes += check_members(&s, &v, "dopri5");
            if (v.e.nrow == 0 && v.e.nu < LARGE)
                check_members(&s, &v, "dop853");
        }
        variant_close(&v);
        system_close(&s);
    }
    print_message("%zu of %zu systems in lanes\n", in_lanes, nshipped);
    assert_true(in_lanes >= 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(lanes_end_where_runs_alone_end)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
