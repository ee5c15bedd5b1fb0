// Loops: what takes the redundancy of constraints away does so in the mechanism that has it;
// singular values are those of the matrix.
#include "analysis/loops.h"
#include "sim/summary.h"
#include "tests/check.h"

#include <stdlib.h>
#include <string.h>

// ---- mechanisms of hinges -----------------------------------------------------------------------

struct hinge {
    const char *name, *from, *to, *q; // q: of its start
    char axis;
};

struct hinges {
    const char *name, *bodies;
    struct hinge hinge[6];
    size_t n;
    size_t redundant;
};

static const struct hinges hinges[] = {
    {"four parallel hinges",
     "  ground: {points: {far: [0.5, 0, 0]}}\n"
     "  crank: {mass: 0.4, inertia: [4e-5, 1.4e-3, 1.4e-3], com: [0.1, 0, 0.01], "
     "points: {end: [0.2, 0, 0.02]}}\n"
     "  coupler: {mass: 1.0, inertia: [1e-4, 2.1e-2, 2.1e-2], com: [0.25, 0, 0.01], "
     "points: {end: [0.5, 0, 0]}}\n"
     "  rocker: {mass: 0.8, inertia: [8e-5, 1.1e-2, 1.1e-2], com: [0.2, 0, 0.01], "
     "points: {end: [0.4, 0, 0.02]}}\n",
     {{"crank_pin", "ground", "crank", "pi/2", 'z'},
      {"coupler_pin", "crank.end", "coupler", "-1.2", 'z'},
      {"rocker_pin", "ground.far", "rocker", "1.6", 'z'},
      {"top_pin", "coupler.end", "rocker.end", "1.2", 'z'}},
     4,
     3},
    {"Bricard",
     "  ground: {points: {end: [0, 0, 1]}}\n"
     "  rod1: {mass: 1, inertia: [1e-3, 0.08, 0.08], com: [0.5, 0, 0], points: {end: [1, 0, "
     "0]}}\n"
     "  rod2: {mass: 1, inertia: [0.08, 1e-3, 0.08], com: [0, -0.5, 0], points: {end: [0, -1, "
     "0]}}\n"
     "  rod3: {mass: 1, inertia: [0.08, 0.08, 1e-3], com: [0, 0, 0.5], points: {end: [0, 0, "
     "1]}}\n"
     "  rod4: {mass: 1, inertia: [1e-3, 0.08, 0.08], com: [-0.5, 0, 0], points: {end: [-1, 0, "
     "0]}}\n"
     "  rod5: {mass: 1, inertia: [0.08, 1e-3, 0.08], com: [0, 0.5, 0], points: {end: [0, 1, "
     "0]}}\n",
     {{"j0", "ground", "rod1", "0", 'y'},
      {"j1", "rod1.end", "rod2", "0", 'z'},
      {"j2", "rod2.end", "rod3", "0", 'x'},
      {"j3", "rod3.end", "rod4", "0", 'y'},
      {"j4", "rod4.end", "rod5", "0", 'z'},
      {"j5", "rod5.end", "ground.end", "0", 'x'}},
     6,
     1},
};

// Which freedoms a hinge has besides its own: turns about x, y, z, then slides along them.
typedef bool freedoms[6];

// The joint as a custom one. Its coordinates: the slides, the turns, the hinge's own.
static void put_released(FILE *out, const struct hinge *h, const freedoms loose)
{
    fprintf(out, "  %s: {type: custom, from: %s, to: %s, coordinates: [", h->name, h->from,
            h->to);
    for (int i = 0; i < 6; i++)
        if (loose[i])
            fprintf(out, "c%d, ", i);
    fprintf(out, "own], translate: [");
    for (int i = 3; i < 6; i++)
        fprintf(out, loose[i] ? "c%d%s" : "0%.0d%s", loose[i] ? i : 0,
                i < 5 ? ", " : "], rotate: [");
    for (int i = 0; i < 3; i++)
        if (loose[i])
            fprintf(out, "[%c, c%d], ", "xyz"[i], i);
    fprintf(out, "[%c, own]], initial: {q: [", h->axis);
    for (int i = 0; i < 6; i++)
        if (loose[i])
            fputs("0, ", out);
    fprintf(out, "%s], guess: true}}\n", h->q);
}

static char *model_text(const struct hinges *h, freedoms *loose)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    fprintf(out, "cotree: 1\ngravity: [0.3, -9.81, 0.2]\nbodies:\n%sjoints:\n", h->bodies);
    for (size_t i = 0; i < h->n; i++) {
        const struct hinge *j = &h->hinge[i];
        bool is_free = false;
        for (int k = 0; k < 6 && loose; k++)
            is_free |= loose[i][k];
        if (is_free)
            put_released(out, j, loose[i]);
        else
            fprintf(
                out,
                "  %s: {type: revolute, from: %s, to: %s, axis: %c, initial: {q: %s, guess: "
                "true}}\n",
                j->name, j->from, j->to, j->axis, j->q);
    }
    fclose(out);
    return text;
}

struct opened {
    struct ct_ctx *ctx;
    struct ct_system *system;
    struct ct_sim *sim;
};

static struct opened open_hinges(const struct hinges *h, freedoms *loose)
{
    const struct ct_system_options o = {.keep_all = true};
    char *text = model_text(h, loose);
    struct opened s = {.ctx = ct_ctx_create()};
    s.system = ct_system_load_text(s.ctx, text, strlen(text), h->name, &o);
    s.sim = s.system ? ct_sim_create(s.ctx, s.system, NULL) : NULL;
    if (!s.sim) {
        print_error("%s\n", text);
        ct_ctx_print(s.ctx, stderr);
    }
    assert_non_null(s.sim);
    free(text);
    return s;
}

static void close_opened(struct opened *s)
{
    ct_sim_destroy(s->sim);
    ct_system_destroy(s->system);
    ct_ctx_destroy(s->ctx);
}

struct counts {
    long redundant, freedoms;
};

static struct counts counts_with(const struct hinges *h, freedoms *loose)
{
    struct opened s = open_hinges(h, loose);
    const struct counts c = {ct_sim_redundant(s.sim), ct_sim_freedoms(s.sim)};
    close_opened(&s);
    return c;
}

static size_t place(const struct ct_release *r)
{
    return (size_t)(r->axis + (r->kind == CT_RELEASE_SLIDE ? 3 : 0));
}

// Every freedom that is listed takes one redundant constraint away and leaves the mechanism as free
// as it was, every other one frees it by one; those that are chosen leave no redundant constraint.
static void releases_take_redundancy_away(void **state)
{
    (void)state;
    for (size_t m = 0; m < COUNT(hinges); m++) {
        const struct hinges *h = &hinges[m];
        struct opened s = open_hinges(h, NULL);
        struct ct_arena *a = ct_arena_create();
        struct ct_loops l;
        ct_loops_create(a, s.sim, &l);
        freedoms listed[6] = {0}, chosen[6] = {0};
        size_t nchosen = 0;
        for (size_t i = 0; i < l.nrelease; i++) {
            const struct ct_release *r = &l.release[i];
            listed[r->joint][place(r)] = true;
            chosen[r->joint][place(r)] = r->is_chosen;
            nchosen += r->is_chosen;
        }
        assert_int_equal(ct_sim_redundant(s.sim), h->redundant);
        assert_int_equal(nchosen, h->redundant);
        const struct counts all = counts_with(h, chosen);
        assert_int_equal(all.redundant, 0);
        assert_int_equal(all.freedoms, 1);
        for (size_t i = 0; i < h->n; i++)
            for (int k = 0; k < 6; k++) {
                freedoms one[6] = {0};
                if (k == h->hinge[i].axis - 'x')
                    continue; // its own
                one[i][k] = true;
                const struct counts c = counts_with(h, one);
                assert_int_equal(c.redundant, (long)h->redundant - listed[i][k]);
                assert_int_equal(c.freedoms, 1 + !listed[i][k]);
            }
        ct_loops_forget(&l);
        ct_arena_destroy(a);
        close_opened(&s);
    }
}

// ---- singular values ----------------------------------------------------------------------------

// Singular values of A (m x n), m >= n, descending, by rotations of its columns until these are at
// right angles (Hestenes).
static void singular_values(double *A, size_t m, size_t n, double *w)
{
    for (int sweep = 0; sweep < 40; sweep++)
        for (size_t p = 0; p < n; p++)
            for (size_t q = p + 1; q < n; q++) {
                double a = 0, b = 0, c = 0;
                for (size_t i = 0; i < m; i++) {
                    a += A[i + m * p] * A[i + m * p];
                    b += A[i + m * q] * A[i + m * q];
                    c += A[i + m * p] * A[i + m * q];
                }
                if (c == 0)
                    continue;
                const double zeta = (b - a) / (2 * c);
                const double t = copysign(1, zeta) / (fabs(zeta) + sqrt(1 + zeta * zeta));
                const double cs = 1 / sqrt(1 + t * t), sn = cs * t;
                for (size_t i = 0; i < m; i++) {
                    const double x = A[i + m * p], y = A[i + m * q];
                    A[i + m * p] = cs * x - sn * y;
                    A[i + m * q] = sn * x + cs * y;
                }
            }
    for (size_t k = 0; k < n; k++) {
        w[k] = 0;
        for (size_t i = 0; i < m; i++)
            w[k] += A[i + m * k] * A[i + m * k];
        w[k] = sqrt(w[k]);
    }
    for (size_t k = 0; k < n; k++)
        for (size_t i = k + 1; i < n; i++)
            if (w[i] > w[k]) {
                const double v = w[i];
                w[i] = w[k];
                w[k] = v;
            }
}

struct followed {
    struct ct_sim *sim;
    struct ct_loops loops;
    size_t n;      // samples
    double *value; // of the outputs at all of them, without loops
    bool is_first; // they are being found
    bool is_slider_crank;
};

static bool at_row(void *user, double t, const double *value, size_t n)
{
    struct followed *f = user;
    const struct ct_equations *e = &f->sim->system->equations;
    const struct ct_evaluator *m = ct_run_evaluator(f->sim->run);
    double near[32], A[4096] = {0}, w[64];
    (void)t;
    assert_true(e->nu * e->nrow < COUNT(A) && f->loops.nloop < COUNT(near));
    if (f->is_first) {
        f->value = realloc(f->value, (f->n + 1) * n * sizeof *value);
        memcpy(f->value + f->n++ * n, value, n * sizeof *value);
        return true;
    }
    ct_loops_measure(&f->loops, near);
    assert_memory_equal(value, f->value + f->n++ * n, n * sizeof *value);
    if (f->is_slider_crank) { // one row: r cos(q1), -l cos(q2) of lengths r and l
        const double r = 0.152, l = 0.304, q1 = value[0], s2 = r * sin(q1) / l;
        const double want = sqrt(pow(r * cos(q1), 2) + l * l * (1 - s2 * s2)) / (r + l);
        CHECK_CLOSE(near[0], want, 1e-8,
                    0); // the loop is closed to 1e-13, eigenvalues of squares
        CHECK_CLOSE(near[1], want, 1e-8, 0);
        return true;
    }
    double *symbol = calloc(e->x->nsym, sizeof *symbol);
    ct_evaluator_values(m, e->x, symbol);
    for (size_t k = 0; k < e->nJ; k++) { // rows as columns
        const struct ct_entry *J = &e->J[k];
        A[(size_t)J->column + e->nu * (size_t)J->row] = ct_ex_value(e->x, J->value, symbol)
                                                      * m->speed_size[J->column]
                                                      / m->row_size[J->row];
    }
    free(symbol);
    singular_values(A, e->nu, e->nrow, w);
    CHECK_CLOSE(near[0], w[f->loops.rank - 1], 1e-6, 1e-8); // of squares: half the digits
    return true;
}

static void follow(const char *file, bool keep_all, bool is_slider_crank)
{
    const struct ct_system_options o = {.keep_all = keep_all};
    const struct ct_sim_options run = {.until = 0.5, .samples = 101, .tolerance = 1e-9};
    struct ct_ctx *ctx = ct_ctx_create();
    char path[1024];
    snprintf(path, sizeof path, "%s/../%s", getenv("CT_TEST_DIR"), file);
    struct ct_system *system = ct_system_load(ctx, path, &o);
    struct followed f = {.is_slider_crank = is_slider_crank};
    for (int i = 0; i < 2; i++) {
        struct ct_arena *a = ct_arena_create();
        f.sim = ct_sim_create(ctx, system, &run);
        f.is_first = i == 0;
        f.n = 0;
        assert_non_null(f.sim);
        if (!f.is_first)
            ct_loops_create(a, f.sim, &f.loops);
        const struct ct_sim_results results = {.row = at_row, .user = &f};
        assert_true(ct_sim_run(ctx, f.sim, &results));
        assert_int_equal(f.n, 101);
        ct_sim_destroy(f.sim);
        ct_arena_destroy(a);
    }
    free(f.value);
    ct_system_destroy(system);
    ct_ctx_destroy(ctx);
}

// And measuring them changes no bit of the run.
static void singular_values_are_those_of_the_rows(void **state)
{
    (void)state;
    follow("systems/slider_crank/model.yaml", false, true);
    follow("systems/four_bar_near_singular/model.yaml", false, false);
    follow("systems/spatial_four_bar/model.yaml", true, false);
    follow("systems/bricard/model.yaml", false, false);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(releases_take_redundancy_away),
        cmocka_unit_test(singular_values_are_those_of_the_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
