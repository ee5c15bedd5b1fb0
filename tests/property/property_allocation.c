// Nothing is allocated between the first and the last step of a run, neither from the system nor
// from an arena.
//
// The linker sends malloc, calloc, realloc and ct_pages_create of the library to the functions
// below (-Wl,--wrap).
#include "tests/property/system.h"

#include <cotree/cotree.h>

// NOLINTBEGIN(bugprone-reserved-identifier): the linker names them
void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *p, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *p, size_t size);
void *__real_ct_pages_create(size_t size);
void *__wrap_ct_pages_create(size_t size);

static long nallocation;

void *__wrap_malloc(size_t size)
{
    nallocation++;
    return __real_malloc(size);
}

void *__wrap_calloc(size_t n, size_t size)
{
    nallocation++;
    return __real_calloc(n, size);
}

void *__wrap_realloc(void *p, size_t size)
{
    nallocation++;
    return __real_realloc(p, size);
}

void *__wrap_ct_pages_create(size_t size)
{
    nallocation++;
    return __real_ct_pages_create(size);
}
// NOLINTEND(bugprone-reserved-identifier)

// What had been taken at the first step and at the last one so far.
struct steps {
    const struct ct_arena *arena;
    long n, first, last;
    size_t first_used, last_used;
};

static bool at_step(void *user, double t, double end)
{
    struct steps *s = user;
    (void)t;
    (void)end;
    s->last = nallocation;
    s->last_used = ct_arena_used(s->arena);
    if (s->n++ == 0) {
        s->first = s->last;
        s->first_used = s->last_used;
    }
    return s->n < 2000;
}

// A run from the start; forms made for other rows or columns on the way are no part of a step.
static bool steps_allocate_nothing(struct system *s, const struct ct_formulate_options *o,
                                   const char *method, size_t *n)
{
    struct variant v;
    struct steps steps = {0};
    struct ct_run_report report;
    variant_open(s, o, &v);
    struct ct_run *run = ct_run_create(&v.ctx, v.arena, &s->model, &v.e, &s->start);
    assert_non_null(run);
    steps.arena = v.arena;
    const struct ct_run_options options = {.method = ct_method_find(method),
                                           .duration = 0.2,
                                           .rtol = 1e-6,
                                           .atol = 1e-8,
                                           .nsample = 5,
                                           .progress = at_step,
                                           .user = &steps};
    ct_run_simulate(run, &options, &report);
    bool ok = true;
    if (report.solves.reordered == 0 && steps.n > 1) {
        ++*n;
        ok = steps.last == steps.first && steps.last_used == steps.first_used;
    }
    if (!ok)
        print_error("%s, %s: %ld allocations and %zu bytes of the arena in %ld steps\n",
                    s->name, method, steps.last - steps.first,
                    steps.last_used - steps.first_used, steps.n);
    variant_close(&v);
    return ok;
}

static void no_step_allocates(void **state)
{
    (void)state;
    static const struct ct_formulate_options options = {.tree = CT_TREE_JOINTS,
                                                        .with_energy = true,
                                                        .with_solution = true,
                                                        .with_outputs = true,
                                                        .with_residual = true};
    static const char *const methods[] = {"dopri5", "dop853", "generalized-alpha", "radau5"};
    // matrices of implicit methods are lists of entries there
    static const char *const beams[]
        = {"systems/spin_up_beam/model.yaml", "systems/slider_crank_flexible/model.yaml"};
    bool ok = true;
    size_t n = 0;
    for (size_t i = 0; i < nshipped + COUNT(beams); i++) {
        struct system s;
        system_open_file(&s, i < nshipped ? shipped[i] : beams[i - nshipped]);
        for (size_t k = 0; k < COUNT(methods); k++)
            ok &= steps_allocate_nothing(&s, &options, methods[k], &n);
        system_close(&s);
    }
    assert_true(ok);
    assert_true(n > 3 * nshipped);
}

// Setting, stepping and asking, as a controller does, once each has been done.
static void states_allocate_nothing_once_warm(void **state)
{
    (void)state;
    static const char *const names[]
        = {"puma560", "double_pendulum", "slider_crank", "cart_pole"};
    const char *root = getenv("CT_SOURCE_DIR");
    for (size_t i = 0; i < COUNT(names); i++) {
        char path[1024];
        snprintf(path, sizeof path, "%s/systems/%s/model.yaml", root ? root : ".", names[i]);
        struct ct_ctx *ctx = ct_ctx_create();
        struct ct_system *sys = ct_system_load(ctx, path, NULL);
        struct ct_data *d = ct_data_create(ctx, sys, NULL);
        assert_non_null(d);
        double R[9], p[3], value[32];
        const size_t nu = ct_system_count(sys, CT_SPEED);
        assert_true(nu <= COUNT(value));
        long before = 0;
        for (int k = 0; k < 100; k++) {
            if (k == 20)
                before = nallocation;
            assert_true(ct_data_step(ctx, d, 1e-3));
            for (enum ct_quantity q = CT_Q_M; q <= CT_Q_PHI_RATE; q++)
                assert_non_null(ct_data_get(ctx, d, q, NULL, NULL));
            for (size_t j = 0; j < nu; j++)
                value[j] = ct_data_value(d, CT_SPEED, j);
            assert_true(ct_data_set(ctx, d, CT_SPEED, value, nu));
            if (ct_system_count(sys, CT_PARAMETER))
                assert_true(ct_data_pose(ctx, d, 1, R, p));
            assert_true(isfinite(ct_data_value(d, CT_OUTPUT, 0)));
        }
        if (nallocation != before)
            print_error("%s: %ld allocations\n", names[i], nallocation - before);
        assert_int_equal(nallocation, before);
        ct_data_destroy(d);
        ct_system_destroy(sys);
        ct_ctx_destroy(ctx);
    }
}

// The count sees what the library takes.
static void allocations_are_counted(void **state)
{
    (void)state;
    const long before = nallocation;
    ct_arena_destroy(ct_arena_create());
    assert_true(nallocation > before);
}

int main(void)
{
    const struct CMUnitTest tests[]
        = {cmocka_unit_test(allocations_are_counted), cmocka_unit_test(no_step_allocates),
           cmocka_unit_test(states_allocate_nothing_once_warm)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
