// Speed of generated programs and of generating them: a table of measured times beside their goals.
//
//     bench [--quick | --beams | --sweep [MEMBERS]]
//
// Models are read from YAML and go through the normal stages. A time is the median of 11 samples of
// the thread's processor time, each of many calls, and of three such medians the least; what a ratio compares is measured
// alternately in one run, so that a busy machine slows both sides. A loop whose work is always the same is timed along
// with every row: where it takes longer than it did before, the row is measured again (whatever slows everything at once,
// for a second or so, is not the program). At the end all quantities with a goal stand together. Goals are those of the project's feasibility study, measured there on
// one core of a server processor at 3.6 GHz; they include solving for the accelerations where the name
// says so.
#include "codegen/native.h"
#include "expr/tape.h"
#include "formulate/formulate.h"
#include "solve/simulate.h"

#include <cotree/cotree.h>

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

enum { NSAMPLE = 11, NREPEAT = 3 };

static double sample_seconds = 2e-3;

static double read_clock(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

// Of this thread: those of a library for matrices wait for work by running.
static double now(void)
{
    return read_clock(CLOCK_THREAD_CPUTIME_ID);
}

// Of all threads.
static double now_of_all(void)
{
    return read_clock(CLOCK_PROCESS_CPUTIME_ID);
}

// ---- table --------------------------------------------------------------------------------------

// What the lines below a title are about, for the table of goals.
static char context[96];

struct goal {
    char what[160], measured[32], goal[32];
    double ratio;
};
static struct goal goals[64];
static size_t ngoal;

static void keep_goal(const char *what, const char *measured, const char *goal, double ratio)
{
    if (ngoal == COUNT(goals))
        return;
    struct goal *g = &goals[ngoal++];
    while (*what == ' ')
        what++;
    snprintf(g->what, sizeof g->what, "%s%s%s", context, *context ? ": " : "", what);
    snprintf(g->measured, sizeof g->measured, "%s", measured);
    snprintf(g->goal, sizeof g->goal, "%s", goal);
    g->ratio = ratio;
}

static void show_goals(void)
{
    printf("\n| quantity | measured | goal | of goal |\n|---|---:|---:|---:|\n");
    for (size_t i = 0; i < ngoal; i++)
        printf("| %s | %s | %s | %.2f |\n", goals[i].what, goals[i].measured, goals[i].goal,
               goals[i].ratio);
}

static void set_context(const char *name)
{
    snprintf(context, sizeof context, "%s", name);
}

static void head(const char *name, const char *title)
{
    set_context(name);
    printf("\n%-58s %12s %12s %8s\n", title, "measured", "goal", "of goal");
}

// Above the lines of one model. name: what each of them is about; the title says more.
__attribute__((format(printf, 2, 3))) static void title(const char *name, const char *fmt, ...)
{
    va_list ap;
    set_context(name);
    putchar('\n');
    va_start(ap, fmt);
    vprintf(fmt, ap);
    va_end(ap);
    putchar('\n');
}

// A time [s], and what it should be at most; 0: no goal.
static void line(const char *what, double t, double goal)
{
    static const struct {
        double from, factor;
        const char *unit;
    } scale[] = {{1, 1, "s"}, {1e-3, 1e3, "ms"}, {1e-6, 1e6, "us"}, {0, 1e9, "ns"}};
    char text[2][32] = {"", "-"};
    const double value[2] = {t, goal};
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < COUNT(scale) && (k == 0 || goal > 0); i++)
            if (value[k] >= scale[i].from) {
                snprintf(text[k], sizeof text[k], "%.4g %s", scale[i].factor * value[k],
                         scale[i].unit);
                break;
            }
    printf("%-58s %12s %12s", what, text[0], text[1]);
    if (goal > 0) {
        printf(" %8.2f", t / goal);
        keep_goal(what, text[0], text[1], t / goal);
    }
    putchar('\n');
}

static void size(const char *what, size_t bytes)
{
    printf("%-58s %9.4g MB %12s\n", what, 1e-6 * (double)bytes, "-");
}

static void ratio(const char *what, double r, double goal)
{
    char text[2][32];
    snprintf(text[0], sizeof text[0], "%.3g", r);
    snprintf(text[1], sizeof text[1], "%.3g", goal);
    printf("%-58s %12s", what, text[0]);
    if (goal > 0) {
        printf(" %12s %8.2f", text[1], r / goal);
        keep_goal(what, text[0], text[1], r / goal);
    }
    putchar('\n');
}

// ---- timing -------------------------------------------------------------------------------------

typedef void (*call_fn)(void *data);

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double time_of_calls(call_fn f, void *data, long n)
{
    const double start = now();
    for (long i = 0; i < n; i++)
        f(data);
    return now() - start;
}

// Products that wait for each other: the same time whatever is measured beside it.
static void run_reference(void *data)
{
    volatile double *v = data;
    double x = 1 + 1e-9 * *v;
    for (int i = 0; i < 4000; i++)
        x *= 0.999999;
    *v = x;
}

enum { MOST_MEASURED = 8 };

static void measure_once(const call_fn *f, void *const *data, size_t n, double *t)
{
    double sample[MOST_MEASURED + 1][NSAMPLE];
    long calls[MOST_MEASURED + 1];
    for (size_t k = 0; k < n; k++) {
        double once;
        for (calls[k] = 1;
             (once = time_of_calls(f[k], data[k], calls[k])) < sample_seconds / 4;)
            calls[k] *= 2;
        calls[k] = (long)ceil((double)calls[k] * sample_seconds / once);
    }
    for (int repeat = 0; repeat < NREPEAT; repeat++) {
        for (int i = 0; i < NSAMPLE; i++)
            for (size_t k = 0; k < n; k++)
                sample[k][i] = time_of_calls(f[k], data[k], calls[k]) / (double)calls[k];
        for (size_t k = 0; k < n; k++) {
            qsort(sample[k], NSAMPLE, sizeof sample[k][0], compare_doubles);
            const double median = sample[k][NSAMPLE / 2];
            t[k] = repeat && t[k] < median ? t[k] : median;
        }
    }
}

// Seconds per call of each of n functions, sampled in turn.
static void measure(const call_fn *f, void *const *data, size_t n, double *t)
{
    enum { MOST_TRIES = 4 };
    static double reference = INFINITY; // the least so far
    const double slower = 1.15; // clocks that change speed, and samples that differ, stay below
    call_fn all[MOST_MEASURED + 1];
    void *of_all[MOST_MEASURED + 1];
    double time[MOST_MEASURED + 1] = {0}, one = 0;
    memcpy(all, f, n * sizeof *f);
    memcpy(of_all, data, n * sizeof *data);
    all[n] = run_reference;
    of_all[n] = &one;
    for (int i = 0; i < MOST_TRIES; i++) {
        measure_once(all, of_all, n + 1, time);
        for (size_t k = 0; k < n; k++)
            t[k] = i && t[k] < time[k] ? t[k] : time[k];
        reference = fmin(reference, time[n]);
        if (time[n] <= slower * reference)
            return;
    }
    printf("  (the machine was slow: the reference took %.2f of its time)\n",
           time[n] / reference);
}

// ---- models -------------------------------------------------------------------------------------

struct subject {
    const char *path;
    enum ct_tree_choice tree; // the cheapest unless it is set
    struct ct_ctx ctx;
    struct ct_model model;
    struct ct_equations equations, assembly;
    struct ct_start start;
    struct ct_run *run;
    struct ct_machine *machine;
    double *state;
    double generate,
        prepare; // seconds, from the file to equations; from there to the start of a run
};

static void give_up(const struct subject *s)
{
    ct_ctx_print(&s->ctx, stderr);
    fprintf(stderr, "bench: %s failed\n", s->path);
    exit(1);
}

static void open_arenas(struct ct_ctx *ctx)
{
    *ctx = (struct ct_ctx){.model = ct_arena_create(), .scratch = ct_arena_create()};
    if (!ctx->model || !ctx->scratch)
        abort();
}

static void close_arenas(struct ct_ctx *ctx)
{
    ct_arena_destroy(ctx->scratch);
    ct_arena_destroy(ctx->model);
}

static const struct ct_formulate_options motion_options
    = {.tree = CT_TREE_AUTO, .with_solution = true};

static bool generate(struct subject *s)
{
    struct ct_tree_report report;
    struct ct_formulate_options options = motion_options;
    options.tree = s->tree;
    return ct_model_read(&s->ctx, s->path, NULL, 0, &s->model)
        && ct_formulate(&s->ctx, s->ctx.model, &s->model, &options, &s->equations, &report);
}

// Everything up to a machine in a consistent state.
static void open_subject_on(struct subject *s, const char *path, enum ct_tree_choice tree)
{
    const struct ct_formulate_options assembly = {.tree = CT_TREE_JOINTS,
                                                  .measure_all = true,
                                                  .measured_for = &s->equations,
                                                  .without_dynamics = true};
    struct ct_tree_report report;
    *s = (struct subject){.path = path, .tree = tree};
    open_arenas(&s->ctx);
    const double start = now();
    if (!generate(s))
        give_up(s);
    s->generate = now() - start;
    const double generated = now();
    if (s->equations.nrow)
        ct_formulate_dynamics(&s->equations);
    if (!ct_formulate(&s->ctx, s->ctx.model, &s->model, &assembly, &s->assembly, &report)
        || !ct_assemble(&s->ctx, s->ctx.model, &s->model, &s->assembly, &s->start))
        give_up(s);
    s->run = ct_run_create(&s->ctx, s->ctx.model, &s->model, &s->equations, &s->start);
    if (!s->run)
        give_up(s);
    s->prepare = now() - generated;
    s->machine = ct_run_machine(s->run);
    ct_machine_set(s->machine, 0, ct_run_state(s->run));
}

static void open_subject(struct subject *s, const char *path)
{
    open_subject_on(s, path, CT_TREE_AUTO);
}

static void close_subject(struct subject *s)
{
    close_arenas(&s->ctx);
}

static const char *temporary(void)
{
    static char path[64];
    snprintf(path, sizeof path, "/tmp/ct_bench_%ld.yaml", (long)getpid());
    return path;
}

// The file that systems/NAME/generate.sh N writes.
static const char *generated(const char *name, int n)
{
    char command[512];
    snprintf(command, sizeof command, "sh '%s/systems/%s/generate.sh' %d > %s",
             getenv("CT_SOURCE_DIR") ? getenv("CT_SOURCE_DIR") : ".", name, n, temporary());
    if (system(command) != 0)
        exit(1);
    return temporary();
}

static FILE *open_model(const char *name, const char *gravity, const char *parameters)
{
    FILE *f = fopen(temporary(), "w");
    if (!f)
        exit(1);
    fprintf(f, "cotree: 1\nname: %s\ngravity: %s\nparameters: {g: 9.81%s}\n", name, gravity,
            parameters);
    return f;
}

static const char *close_model(FILE *f)
{
    fprintf(f, "simulation: {duration: 1}\n");
    fclose(f);
    return temporary();
}

// n bodies "b1", ... in a chain by joints of a type, from point `end` to the next.
static void put_joints(FILE *f, int n, const char *type)
{
    fprintf(f, "joints:\n");
    for (int i = 1; i <= n; i++) {
        fprintf(f, "  j%d: {type: %s, from: ", i, type);
        if (i == 1)
            fprintf(f, "ground, to: b1}\n");
        else
            fprintf(f, "b%d.end, to: b%d}\n", i - 1, i);
    }
}

static const char *spatial_chain(int n)
{
    FILE *f = open_model("balls", "[0, 0, -g]", "");
    fprintf(f, "bodies:\n");
    for (int i = 1; i <= n; i++)
        fprintf(f,
                "  b%d: {mass: 1.%d, com: [0.5, 0.01, 0.02], inertia: [0.1, 0.2, 0.25],\n"
                "    points: {end: [1, 0, 0]}}\n",
                i, i);
    put_joints(f, n, "spherical");
    return close_model(f);
}

static const char *planar_chain(int n)
{
    FILE *f = open_model("pins", "[0, -g, 0]", ", m: 1, l: 1, c: 0.5, J: 0.1");
    fprintf(f, "bodies:\n");
    for (int i = 1; i <= n; i++)
        fprintf(f, "  b%d: {mass: m, com: [c, 0, 0], inertia: J, points: {end: [l, 0, 0]}}\n",
                i);
    put_joints(f, n, "revolute");
    return close_model(f);
}

// Arm of 6 or 7 turning axes with everything a parameter: masses, centres of mass, full inertias, lengths.
static const char *arm(int n)
{
    static const char *const end[2][7]
        = {{"{at: [0, 0, 0], rotate: [x, -pi/2]}", "[a2, 0, d3]",
            "{at: [a3, d4, 0], rotate: [x, -pi/2]}", "{at: [0, 0, 0], rotate: [x, pi/2]}",
            "{at: [0, 0, 0], rotate: [x, -pi/2]}", "[0, 0, 0]"},
           {"{at: [0, 0, d3], rotate: [x, -pi/2]}", "{at: [0, a2, 0], rotate: [x, pi/2]}",
            "{at: [a3, 0, 0], rotate: [x, pi/2]}", "{at: [0, d4, 0], rotate: [x, -pi/2]}",
            "{at: [0, 0, 0], rotate: [x, -pi/2]}", "{at: [a3, 0, 0], rotate: [x, pi/2]}",
            "[0, 0, 0]"}};
    char parameters[2048] = ", a2: 0.43, a3: 0.02, d3: 0.15, d4: 0.43";
    size_t used = strlen(parameters);
    for (int i = 1; i <= n; i++)
        used += (size_t)snprintf(
            parameters + used, sizeof parameters - used,
            ", m%d: %d, x%d: 0.1, y%d: 0.05, z%d: 0.02, A%d: 1, B%d: 1.1, C%d: 1.2, D%d: 0.1, "
            "E%d: 0.02, F%d: 0.05",
            i, 8 - i, i, i, i, i, i, i, i, i, i);
    FILE *f = open_model("arm", "[0, 0, -g]", parameters);
    fprintf(f, "bodies:\n");
    for (int i = 1; i <= n; i++)
        fprintf(f,
                "  b%d: {mass: m%d, com: [x%d, y%d, z%d], inertia: [A%d, B%d, C%d, D%d, E%d, "
                "F%d], points: {end: %s}}\n",
                i, i, i, i, i, i, i, i, i, i, i, end[n == 7][i - 1]);
    put_joints(f, n, "revolute");
    return close_model(f);
}

// A beam of n elements on a body that turns freely: a pendulum in the plane, in space on a ball joint.
struct beam {
    const char *formulation;
    bool is_spatial, is_chain; // chain: n beams of two elements, welded end to end
};

static const char *chain_of_beams(const struct beam *k, int n)
{
    FILE *f = open_model("beam", k->is_spatial ? "[1, -g, 2]" : "[0, -g, 0]", "");
    fprintf(f, "bodies:\n");
    for (int i = 1; i <= n; i++)
        fprintf(f,
                "  b%d: {type: beam, length: 10/%d, elements: 2, density: 3000, E: 7e10, area: "
                "4e-4, Iy: 3e-7, Iz: 2e-7, G: 2.7e10, J: 4e-7, formulation: %s, points: {end: "
                "length}}\n",
                i, n, k->formulation);
    fprintf(f, "joints:\n  hub: {type: %s, from: ground, to: b1}\n",
            k->is_spatial ? "spherical" : "revolute");
    for (int i = 2; i <= n; i++)
        fprintf(f, "  w%d: {type: weld, from: b%d.end, to: b%d}\n", i, i - 1, i);
    return close_model(f);
}

static const char *beam(const struct beam *k, int n)
{
    FILE *f = open_model("beam", k->is_spatial ? "[1, -g, 2]" : "[0, -g, 0]", "");
    fprintf(f,
            "bodies:\n  base: {mass: 2, inertia: 0.5, points: {seat: [0.1, 0, 0]}}\n  beam: "
            "{type: beam, length: 10, elements: %d, density: 3000, E: 7e10, "
            "area: 4e-4,\n    Iy: 3e-7, Iz: 2e-7, G: 2.7e10, J: 4e-7, formulation: %s,\n"
            "    points: {tip: length}}\n",
            n, k->formulation);
    fprintf(f,
            "joints:\n  hub: {type: %s, from: ground, to: base}\n"
            "  clamp: {type: weld, from: base.seat, to: beam}\n",
            k->is_spatial ? "spherical" : "revolute");
    return close_model(f);
}

static const char *shipped(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/systems/%s/model.yaml",
             getenv("CT_SOURCE_DIR") ? getenv("CT_SOURCE_DIR") : ".", name);
    return path;
}

// ---- back ends ----------------------------------------------------------------------------------

struct evaluator {
    const struct ct_program *program;
    const char *name;
    int lanes;
    const struct ct_tape *tape;
    const struct ct_native *native;
    double *input, *out, *work;
};

static void evaluate(void *data)
{
    const struct evaluator *v = data;
    if (v->native)
        ct_native_eval(v->native, v->input, v->out, v->work);
    else if (v->lanes == 1)
        ct_tape_eval(v->tape, v->input, v->out, v->work);
    else
        ct_tape_eval_lanes(v->tape, v->lanes, v->input, v->out, v->work);
}

static bool open_evaluator(struct evaluator *v, struct subject *s, const struct ct_program *p,
                           const char *name, int lanes, bool native)
{
    struct ct_arena *a = s->ctx.model;
    const struct ct_machine *m = s->machine;
    const size_t n = (size_t)lanes;
    *v = (struct evaluator){
        .name = name, .lanes = lanes, .tape = native ? NULL : ct_tape_create(a, p->listing)};
    if (native && !(v->native = ct_native_create(a, p->listing, lanes)))
        return false;
    v->input = CT_NEWN(a, double, n * m->ninput);
    v->out = CT_NEWN(a, double, n * p->nout + 1);
    v->work = CT_NEWN(a, double,
                      v->native ? ct_native_work(v->native) : n *ct_tape_work(v->tape) + 1);
    for (size_t k = 0; k < m->ninput; k++) // lanes differ a little, as in a study
        for (size_t i = 0; i < n; i++)
            v->input[n * k + i] = m->input[k] + 1e-3 * (double)i;
    if (v->native)
        ct_native_prepare(v->native, v->input, v->work);
    else
        ct_tape_prepare_lanes(v->tape, lanes, v->input, v->work);
    return true;
}

// Seconds a call, in the order of the back ends.
enum { NBACKEND = 6 };

struct times {
    double t[NBACKEND];
};

// One line per back end; goals [s] in the same order. name: of the model; what: the program does.
static struct times compare_back_ends(struct subject *s, const struct ct_program *p,
                                      const char *name, const char *what,
                                      const double goal[NBACKEND])
{
    static const struct {
        const char *name;
        int lanes;
        bool native;
    } all[] = {{"tape", 1, false},
               {"tape, 4 lanes, per lane", 4, false},
               {"tape, 8 lanes, per lane", 8, false},
               {"native", 1, true},
               {"native, 4 lanes, per lane", 4, true},
               {"native, 8 lanes, per lane", 8, true}};
    struct evaluator v[NBACKEND];
    call_fn f[NBACKEND] = {0};
    void *data[NBACKEND] = {0};
    double t[NBACKEND];
    size_t n = 0;
    for (size_t i = 0; i < COUNT(all); i++)
        n += open_evaluator(&v[n], s, p, all[i].name, all[i].lanes, all[i].native);
    for (size_t i = 0; i < n; i++) {
        f[i] = evaluate;
        data[i] = &v[i];
    }
    measure(f, data, n, t);
    const struct ct_tape_counts c = p->listing->counts;
    title(name, "%s, %s: %ld mul, %ld add, %ld div, %ld functions, %zu outputs", name, what,
          c.multiplications, c.additions, c.divisions, c.functions, p->nout);
    for (size_t i = 0; i < n; i++) {
        char text[96];
        snprintf(text, sizeof text, "  %s", v[i].name);
        line(text, t[i] / v[i].lanes, goal ? goal[i] : 0);
    }
    if (n == NBACKEND) {
        ratio("  tape / native", t[0] / t[3], 0);
        ratio("  native / native, 4 lanes, per lane", 4 * t[3] / t[4], 0);
    }
    struct times all_times = {{0}};
    for (size_t i = 0; i < n; i++)
        all_times.t[i] = t[i] / v[i].lanes;
    return all_times;
}

// Twelve chains of fused products and sums, which do not wait for each other: what the processor can do at most, in
// multiplications and additions a second.
static double peak(int lanes)
{
    enum { NCHAIN = 12, LENGTH = 200 };
    struct ct_arena *a = ct_arena_create();
    struct ct_exs x;
    ct_exs_init(&x, a);
    ct_ex in[2 + NCHAIN], sum[NCHAIN];
    size_t slot[2 + NCHAIN];
    for (uint32_t k = 0; k < 2 + NCHAIN; k++) {
        in[k] = ct_ex_sym(&x, CT_SYM_Q, "x", k);
        slot[k] = k;
    }
    memcpy(sum, in + 2, sizeof sum);
    for (int i = 0; i < LENGTH; i++)
        for (int k = 0; k < NCHAIN; k++)
            sum[k] = ct_ex_add(&x, ct_ex_mul(&x, sum[k], in[0]), in[1]);
    const struct ct_listing *l
        = ct_listing_create(a, &x, sum, NCHAIN, in, slot, 2 + NCHAIN, CT_FUSE_YES);
    double input[4 * (2 + NCHAIN)], out[4 * NCHAIN], t = INFINITY;
    for (size_t k = 0; k < COUNT(input); k++)
        input[k] = 0.5;
    struct evaluator v = {.lanes = lanes, .input = input, .out = out};
    v.native = ct_native_create(a, l, lanes);
    const call_fn f[] = {evaluate};
    void *const data[] = {&v};
    if (v.native) {
        v.work = CT_NEWN(a, double, ct_native_work(v.native) + 1);
        ct_native_prepare(v.native, input, v.work);
        measure(f, data, 1, &t);
    }
    ct_arena_destroy(a);
    return 2. * lanes * NCHAIN * LENGTH / t;
}

// How much of that a program uses.
static void show_use(const struct ct_program *p, const struct times *t)
{
    const struct ct_tape_counts c = p->listing->counts;
    const double n = (double)(c.multiplications + c.additions + c.divisions);
    if (!(t->t[4] > 0))
        return;
    ratio("  part of the peak of fused operations, at least", n / t->t[3] / peak(1), 0.45);
    ratio("  the same in 4 lanes, at least", n / t->t[4] / peak(4), 0.45);
}

// ---- accelerations ------------------------------------------------------------------------------

static void accelerate(void *data)
{
    struct subject *s = data;
    ct_embed_solve(ct_run_embed(s->run));
}

static void accelerate_by_matrices(void *data)
{
    struct subject *s = data;
    ct_machine_motion(s->machine);
    ct_embed_accelerate(ct_run_embed(s->run));
}

static void assemble(void *data)
{
    struct subject *s = data;
    ct_machine_motion(s->machine);
}

// M, Q, J, gam and the solve, with a goal for both together.
static void show_accelerations(struct subject *s, const char *what, double per, double goal)
{
    const call_fn f[] = {accelerate, assemble, accelerate_by_matrices};
    void *const data[] = {s, s, s};
    double t[3];
    char text[96];
    measure(f, data, 3, t);
    line(what, t[0] / per, goal);
    line("  the same by matrices", t[2] / per, 0);
    snprintf(text, sizeof text, "  of that assembly (%s)", s->machine->backend);
    line(text, t[1] / per, 0);
}

// One projection of the state at hand, which meets the constraints already: the least that a step pays.
static void project(void *data)
{
    struct subject *s = data;
    ct_embed_project(ct_run_embed(s->run), 0, s->state);
}

static void show_projection(struct subject *s, double per)
{
    const call_fn f[] = {project};
    void *const data[] = {s};
    double t;
    const size_t ny = s->machine->nq + s->machine->nu + 1;
    s->state = CT_NEWN(s->ctx.model, double, ny);
    memcpy(s->state, ct_run_state(s->run), ny * sizeof(double));
    measure(f, data, 1, &t);
    line("  projection, with the check of the pivots", t / per, 0);
}

// ---- generating ---------------------------------------------------------------------------------

static double median_of(double (*f)(const char *path), const char *path, int n)
{
    double t[NSAMPLE] = {0}, least = 0;
    for (int repeat = 0; repeat < NREPEAT; repeat++) {
        for (int i = 0; i < n; i++)
            t[i] = f(path);
        qsort(t, (size_t)n, sizeof t[0], compare_doubles);
        least = repeat && least < t[n / 2] ? least : t[n / 2];
    }
    return least;
}

// From the file to machine code of the motion program.
static double model_to_native(const char *path)
{
    struct subject s = {.path = path};
    open_arenas(&s.ctx);
    const double start = now();
    if (!generate(&s))
        give_up(&s);
    ct_machine_create(s.ctx.model, &s.model, &s.equations);
    const double t = now() - start;
    close_subject(&s);
    return t;
}

static double model_to_equations(const char *path)
{
    struct subject s = {.path = path};
    open_arenas(&s.ctx);
    const double start = now();
    if (!generate(&s))
        give_up(&s);
    const double t = now() - start;
    close_subject(&s);
    return t;
}

// All nodes of a store made again in a new one.
struct nodes {
    const struct ct_exs *x;
};

static void build_nodes(void *data)
{
    const struct ct_exs *from = ((const struct nodes *)data)->x;
    struct ct_arena *a = ct_arena_create();
    struct ct_exs x;
    ct_exs_init(&x, a);
    ct_ex *copy = CT_NEWN(a, ct_ex, from->nnode);
    for (uint32_t id = 0; id < from->nnode; id++) {
        const struct ct_exnode *n = &from->node[id];
        double value;
        if (ct_ex_is_const(from, (ct_ex){id}, &value))
            copy[id] = ct_ex_const(&x, value);
        else if (n->op == CT_OP_SYM)
            copy[id] = ct_ex_sym(&x, from->sym[n->a].kind, from->sym[n->a].name, n->a);
        else if (n->op == CT_OP_IF)
            copy[id] = ct_ex_if(&x, copy[n->a], copy[n->b], copy[n->c]);
        else if (n->op != CT_OP_TABLE && ct_op_info[n->op].narg == 1)
            copy[id] = ct_ex_fun(&x, (enum ct_op)n->op, copy[n->a]);
        else if (n->op != CT_OP_TABLE)
            copy[id] = ct_ex_fun2(&x, (enum ct_op)n->op, copy[n->a], copy[n->b]);
    }
    ct_arena_destroy(a);
}

static void emit_native(void *data)
{
    struct ct_arena *a = ct_arena_create();
    ct_native_create(a, data, 1);
    ct_arena_destroy(a);
}

static void make_tape(void *data)
{
    struct ct_arena *a = ct_arena_create();
    ct_tape_create(a, data);
    ct_arena_destroy(a);
}

struct listing_task {
    struct subject *s;
    ct_ex *out, *in;
    size_t *slot, nout, nin;
};

static void make_listing(void *data)
{
    const struct listing_task *k = data;
    struct ct_arena *a = ct_arena_create();
    ct_listing_create(a, k->s->equations.x, k->out, k->nout, k->in, k->slot, k->nin,
                      CT_FUSE_NO);
    ct_arena_destroy(a);
}

// The outputs and inputs of a program, read off its listing.
static struct listing_task listing_task(struct subject *s, const struct ct_listing *l)
{
    struct ct_arena *a = s->ctx.model;
    struct listing_task k = {s,
                             CT_NEWN(a, ct_ex, l->nout),
                             CT_NEWN(a, ct_ex, l->nvalue),
                             CT_NEWN(a, size_t, l->nvalue),
                             l->nout,
                             0};
    for (size_t i = 0; i < l->nout; i++)
        k.out[i] = (ct_ex){l->node[l->out[i]]};
    for (size_t v = 0; v < l->nvalue; v++)
        if (l->input[v] != CT_VALUE_NONE) {
            k.in[k.nin] = (ct_ex){l->node[v]};
            k.slot[k.nin++] = l->input[v];
        }
    return k;
}

static void show_generation(struct subject *s, const char *what)
{
    const struct ct_listing *l = s->machine->solved.listing;
    struct nodes nodes = {s->equations.x};
    struct listing_task task = listing_task(s, l);
    const call_fn f[] = {build_nodes, make_listing, make_tape, emit_native};
    union {
        const struct ct_listing *l;
        void *p;
    } listing = {.l = l};
    void *const data[] = {&nodes, &task, listing.p, listing.p};
    double t[4];
    measure(f, data, 4, t);
    const double nnode = (double)s->equations.x->nnode, nins = (double)l->nins;
    title(what, "%s: %zu nodes in the store, %zu instructions", what, s->equations.x->nnode,
          l->nins);
    line("  graph construction, per node", t[0] / nnode, 40e-9);
    line("  listing, per instruction", t[1] / nins, 0);
    line("  tape from the listing, per instruction", t[2] / nins, 0);
    line("  native code from the listing, per instruction", t[3] / nins, 0);
    line("  order and emit (listing + native), per instruction", (t[1] + t[3]) / nins, 250e-9);
}

// ---- what is measured ---------------------------------------------------------------------------

static void run_solved(void *data)
{
    struct subject *s = data;
    ct_program_run(&s->machine->solved, s->machine->input);
}

// Speeds by chance. Of a straight chain at rest accelerations fall from ball to ball until they are smaller than normal numbers,
// which take much longer (500 balls: 45.8 instead of 34.7 us); no motion stays there.
static void set_in_motion(struct subject *s)
{
    struct ct_machine *m = s->machine;
    uint64_t chance = 1;
    for (size_t i = m->at_u; i < m->at_u + m->nu; i++) {
        chance = chance * 6364136223846793005u + 1442695040888963407u;
        m->input[i] = (double)(chance >> 11) / (double)(1ll << 52) - 1;
    }
}

// An open chain: u' and q' by the formulation that was chosen. goal: as compare_back_ends, then of the way from the model
// to native code. is_throughput: show which part of the processor's peak it reaches. Returns the time from the model to
// native code.
static double open_chain(const char *what, const char *path, const double goal[NBACKEND],
                         double generation_goal, bool is_throughput)
{
    static const char *const name[]
        = {"", "cutset sums", "composite bodies", "articulated bodies"};
    struct subject s;
    char text[128];
    open_subject(&s, path);
    snprintf(text, sizeof text, "u' by %s", name[s.equations.formulation]);
    const call_fn f[] = {run_solved};
    void *const data[] = {&s};
    double rest;
    measure(f, data, 1, &rest);
    set_in_motion(&s);
    const struct times t = compare_back_ends(&s, &s.machine->solved, what, text, goal);
    if (is_throughput)
        show_use(&s.machine->solved, &t);
    line("  native, at rest", rest, 0);
    line("  model to equations", median_of(model_to_equations, s.path, 5), 0);
    const double generation = median_of(model_to_native, s.path, 5);
    line("  model to native code", generation, generation_goal);
    show_generation(&s, what);
    printf("  %-56s %9zu KiB\n", "machine code",
           s.machine->solved.native ? ct_native_code_size(s.machine->solved.native) / 1024 : 0);
    close_subject(&s);
    return generation;
}

static void run_residual(void *data)
{
    struct subject *s = data;
    ct_program_run(&s->machine->residual, s->machine->input);
}

// Forces for given motion.
static void inverse_dynamics(const char *name, const char *path, double goal)
{
    struct subject s;
    const call_fn f[] = {run_residual};
    void *const data[] = {&s};
    double t;
    open_subject(&s, path);
    ct_formulate_residual(&s.equations);
    ct_machine_add_residual(s.ctx.model, s.machine);
    measure(f, data, 1, &t);
    title(name, "%s, forces for given motion", name);
    line("  inverse dynamics, native", t, goal);
    close_subject(&s);
}

struct apart {
    struct ct_program program;
    const double *input;
};

static void run_apart(void *data)
{
    struct apart *p = data;
    ct_program_run(&p->program, p->input);
}

// Residual and all its derivatives, as one program.
static void residual_and_slopes(struct subject *s, const char *what, double goal)
{
    struct ct_arena *a = s->ctx.model;
    ct_formulate_residual(&s->equations);
    const struct ct_equations *e = &s->equations;
    const struct ct_residual *r = e->residual;
    const struct {
        const struct ct_slope *s;
        size_t n;
    } list[] = {{r->dq, r->ndq}, {r->du, r->ndu}, {r->da, r->nda}, {r->dv, r->ndv}};
    ct_ex *out = CT_NEWN(a, ct_ex,
                         e->nu + 2 * e->nrow + e->nJ + r->ndq + r->ndu + r->nda + r->ndv + 1);
    size_t n = 0;
    for (size_t i = 0; i < e->nu; i++)
        out[n++] = r->r[i];
    for (size_t i = 0; i < e->nrow; i++) {
        out[n++] = e->row[i].phi;
        out[n++] = e->row[i].v;
    }
    for (size_t k = 0; k < COUNT(list); k++)
        for (size_t i = 0; i < list[k].n; i++)
            out[n++] = list[k].s[i].value;
    for (size_t i = 0; i < e->nJ; i++)
        out[n++] = e->J[i].value;
    struct apart p = {.input = s->machine->input};
    ct_machine_compile(a, s->machine, e->x, out, n, &p.program);
    const call_fn f[] = {run_apart};
    void *const data[] = {&p};
    double t;
    measure(f, data, 1, &t);
    line(what, t, goal);
    ct_machine_forget(s->machine, &p.program);
}

// Accelerations with the order of pivots made at the start against pivots sought anew, at places and speeds around it:
// the relative difference that one state in a hundred exceeds.
static void fixed_against_pivoted(struct subject *s)
{
    enum { NSTATE = 1000 };
    static double difference[NSTATE];
    struct ct_machine *m = s->machine;
    struct ct_embed *e = ct_run_embed(s->run);
    double *kept = CT_NEWN(s->ctx.model, double, m->ninput),
           *a = CT_NEWN(s->ctx.model, double, m->nu + 1);
    uint64_t chance = 1;
    memcpy(kept, m->input, m->ninput * sizeof *kept);
    for (int k = 0; k < NSTATE && e->nform; k++) {
        double most = 0, worst = 0;
        for (size_t i = m->at_q; i < m->at_u + m->nu; i++) {
            chance = chance * 6364136223846793005u + 1442695040888963407u;
            m->input[i] = kept[i] + 0.5 * ((double)(chance >> 11) / (double)(1ll << 52) - 1);
        }
        ct_machine_motion(m);
        ct_embed_accelerate(e);
        const bool ok = ct_form_solve(e->form[0], m, a) > 0;
        for (size_t i = 0; i < m->nu; i++) {
            most = fmax(most, fabs(e->a[i]));
            worst = fmax(worst, fabs(a[i] - e->a[i]));
        }
        difference[k] = ok ? worst / most : INFINITY;
    }
    memcpy(m->input, kept, m->ninput * sizeof *kept);
    qsort(difference, NSTATE, sizeof difference[0], compare_doubles);
    ratio("  fixed against sought pivots, 99 % of random states", difference[NSTATE / 100 * 99],
          1e-9);
}

// The first step of an implicit method: what it needs beside the equations, and its derivatives.
static void run_tangent(void *data)
{
    ct_machine_tangent(data);
}

static void implicit_chain(int n)
{
    struct subject s;
    char text[96];
    open_subject(&s, spatial_chain(n));
    const double start = now();
    ct_formulate_residual(&s.equations);
    ct_machine_add_residual(s.ctx.model, s.machine);
    const double made = now() - start;
    const call_fn f[] = {run_tangent};
    void *const data[] = {s.machine};
    double t;
    measure(f, data, 1, &t);
    const struct ct_directional *along = s.equations.residual->along;
    title("", "chain of %d balls, derivatives for implicit methods %s", n,
          along ? "along directions" : "entry by entry");
    line("  residual and derivatives, from equations to native code", made, 0);
    snprintf(text, sizeof text, "  all derivatives (%zu x %zu)", s.machine->nu,
             3 * s.machine->nu);
    line(text, t, 0);
    close_subject(&s);
}

static void open_chains(bool quick)
{
    static const double six_folded[NBACKEND]
        = {0.8e-6, 0, 0, 120e-9, 42e-9},
        six[NBACKEND] = {0.8e-6, 0, 0, 150e-9, 42e-9}, seven[NBACKEND] = {0, 0, 0, 190e-9, 0},
        planar[NBACKEND] = {0, 0, 0, 1.5e-6, 0}, spatial[NBACKEND] = {0, 0, 0, 4e-6, 0},
        long_spatial[NBACKEND] = {0, 0, 0, 40e-6, 0};
    open_chain("6R arm (puma560, numbers folded)", shipped("puma560"), six_folded, 0.5e-3,
               false);
    open_chain("6R arm, parameters", arm(6), six, 0.5e-3, false);
    inverse_dynamics("6R arm, parameters", arm(6), 140e-9);
    open_chain("7-dof arm, parameters", arm(7), seven, 0, false);
    implicit_chain(quick ? 5 : 50);
    if (quick)
        return;
    open_chain("planar chain of 50 pins", planar_chain(50), planar, 0, false);
    const double t50 = open_chain("chain of 50 balls (150 freedoms)", spatial_chain(50),
                                  spatial, 5e-3, true);
    const double t500 = open_chain("chain of 500 balls (1500 freedoms)", spatial_chain(500),
                                   long_spatial, 2, false);
    title("", "chains of balls");
    ratio("  model to native code, 500 balls / 50 balls", t500 / t50, 15);
    unlink(temporary());
}

static void andrews(void)
{
    struct subject s;
    open_subject(&s, shipped("andrews"));
    compare_back_ends(&s, &s.machine->motion, "Andrews' mechanism", "M, Q, J, gam", NULL);
    show_accelerations(&s, "  accelerations, solve included, native", 1, 160e-9);
    residual_and_slopes(&s, "  residual and its sparse Jacobian", 160e-9);
    fixed_against_pivoted(&s);
    ct_machine_use(s.ctx.model, s.machine, CT_BACKEND_TAPE);
    show_accelerations(&s, "  accelerations, solve included, tape", 1, 0.6e-6);
    close_subject(&s);
}

static void four_bars(int n)
{
    struct subject s;
    char what[64];
    open_subject(&s, generated("n_four_bar", n));
    snprintf(what, sizeof what, "%d four-bar%s", n, n > 1 ? "s" : "");
    compare_back_ends(&s, &s.machine->motion, what, "M, Q, J, gam", NULL);
    show_accelerations(&s, "  accelerations, solve included, per loop", n, 60e-9);
    show_projection(&s, n);
    close_subject(&s);
    unlink(s.path);
}

static const char *solver(const struct subject *s)
{
    const struct ct_embed *e = ct_run_embed(s->run);
    return e->nform ? e->form[0]->kind->name : "dense";
}

// A coordinate for each place and angle: many freedoms, all of them coupled, and sparse matrices.
static void links_by_bodies(int n)
{
    struct subject s;
    open_subject_on(&s, generated("chain40", n), CT_TREE_ABSOLUTE);
    title("", "chain of %d links on trees of bodies: %zu speeds, %zu rows, solved by %s", n,
          s.machine->nu, s.machine->nrow, solver(&s));
    show_accelerations(&s, "  accelerations, solve included, per link", n, 0);
    show_projection(&s, n);
    close_subject(&s);
    unlink(s.path);
}

// Cost per loop must not grow with the number of loops: 3 n + 1 bodies and joints, ground included.
static void many_four_bars(int n)
{
    struct subject s;
    open_subject(&s, generated("n_four_bar", n));
    char what[64];
    snprintf(what, sizeof what, "%d four-bars", n);
    title(what, "%s in a row: %zu bodies, %zu joints, solved by %s", what, s.model.nbody - 1,
          s.model.njoint, solver(&s));
    line("  model to equations", s.generate, 2);
    line("  equations to the start of a run", s.prepare, 0);
    size("  memory of model, equations and run", ct_arena_used(s.ctx.model));
    show_accelerations(&s, "  accelerations, solve included, per loop", n, 60e-9);
    show_projection(&s, n);
    close_subject(&s);
    unlink(s.path);
}

// ---- parameter studies --------------------------------------------------------------------------

// What a member costs where one run follows another, at values of the sweep's own, between its rows.
struct singles {
    const char *path;
    long every;   // members between two of them
    long n;       // of them so far
    double spent; // on all this [s]
    double prepare,
        run; // of these: a run made ready of a system that is there, and its integration [s]
    double difference; // largest |row - run| / max(|run|, 1)
};

// The last row of a run stays.
static bool keep_row(void *user, double t, const double *value, size_t n)
{
    (void)t;
    memcpy(user, value, n * sizeof *value);
    return true;
}

static bool run_single(void *user, long member, const double *varied, const double *value,
                       const char *message)
{
    struct singles *s = user;
    if (message)
        exit(1);
    if (member % s->every)
        return true;
    enum { MOST_COLUMNS = 64 };
    double last[MOST_COLUMNS] = {0};
    const double before = now();
    char torque[40];
    snprintf(torque, sizeof torque, "torque=%.17g", varied[0]);
    const char *const set[] = {torque};
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *system
        = ct_system_load(ctx, s->path, &(struct ct_system_options){.set = set, .nset = 1});
    const double start = now();
    struct ct_sim *sim = ct_sim_create(ctx, system, &(struct ct_sim_options){.samples = 2});
    const double ready = now();
    if (!ct_sim_run(ctx, sim, &(struct ct_sim_results){.row = keep_row, .user = last}))
        exit(1);
    s->run += now() - ready;
    s->prepare += ready - start;
    for (size_t i = 0; i + 1 < ct_system_column_count(system); i++)
        s->difference = fmax(s->difference, fabs(value[i] - last[i]) / fmax(fabs(last[i]), 1));
    s->n++;
    ct_sim_destroy(sim);
    ct_system_destroy(system);
    ct_ctx_destroy(ctx);
    s->spent += now() - before;
    return true;
}

// Members in lanes on one core, everything included, against single runs in between.
static void sweep(int members)
{
    struct singles s = {.path = shipped("slider_crank"), .every = members < 1000 ? 2 : 50};
    char vary[64];
    snprintf(vary, sizeof vary, "torque=0.4:0.6:%d", members);
    const char *const list[] = {vary};
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_study *study = ct_study_create(
        ctx, s.path, NULL, &(struct ct_study_options){.vary = list, .nvary = 1, .threads = 1});
    const double start = now();
    if (!ct_study_run(ctx, study, &(struct ct_study_results){.row = run_single, .user = &s}))
        exit(1);
    const double lanes = (now() - start - s.spent) / members;
    ct_study_destroy(study);
    ct_ctx_destroy(ctx);
    title("sweep of the slider-crank", "slider-crank, 2 s: sweep of %d members", members);
    line("  per member, all included", lanes, 0);
    line("  single run: integration only, the system ready", s.run / (double)s.n, 0);
    line("  single run: made ready of a system that is there", s.prepare / (double)s.n, 0);
    ratio("  integration only / member, at least", s.run / (double)s.n / lanes, 3);
    ratio("  made ready and integrated / member", (s.prepare + s.run) / (double)s.n / lanes, 0);
    printf("%-58s %12.1e\n", "  largest difference of a row from its single run", s.difference);
}

// ---- beams --------------------------------------------------------------------------------------

static double accelerations(struct subject *s)
{
    const call_fn f[] = {accelerate};
    void *const data[] = {s};
    double t;
    measure(f, data, 1, &t);
    return t;
}

static double operations(const struct subject *s)
{
    const struct ct_machine *m = s->machine;
    const struct ct_tape_counts c = (m->solved.nout ? &m->solved : &m->motion)->listing->counts;
    return (double)(c.multiplications + c.additions + c.divisions + c.functions)
         + (m->solved.nout ? 0 : ct_embed_operations(ct_run_embed(s->run)));
}

// Cost against the number of elements, or of beams in a chain; it should be in proportion.
static void beams(const char *what, const struct beam *kind, bool quick)
{
    static const int element[] = {5, 10, 20, 50, 100}, link[] = {4, 8, 16, 32, 64};
    const int *all = kind->is_chain ? link : element;
    const char *of = kind->is_chain ? "beam" : "element";
    double first = 0, first_generation = 0;
    title(what,
          "%s, u' with the solve: per evaluation, per %s, ratio to %d | model to native, per "
          "%s, ratio | operations per %s",
          what, of, all[0], of, of);
    for (size_t i = 0; i < (quick ? 2 : COUNT(element)); i++) {
        struct subject s;
        const int n = all[i];
        const char *path = kind->is_chain ? chain_of_beams(kind, n) : beam(kind, n);
        const double generation = median_of(model_to_native, path, quick ? 1 : 3) / n;
        open_subject(&s, path);
        const double t = accelerations(&s) / n;
        first = i ? first : t;
        first_generation = i ? first_generation : generation;
        printf("  N = %3d %22.3f us %10.1f ns %8.2f | %8.3f ms %8.1f us %8.2f | %8.0f\n", n,
               1e6 * n * t, 1e9 * t, t / first, 1e3 * n * generation, 1e6 * generation,
               generation / first_generation, operations(&s) / n);
        close_subject(&s);
    }
}

// The time per element at 100 elements over that at 5, both measured alternately.
static void beam_growth(const char *what, const struct beam *kind)
{
    static const int n[] = {5, 100};
    struct subject s[COUNT(n)];
    call_fn f[COUNT(n)];
    void *data[COUNT(n)];
    double t[COUNT(n)] = {0};
    char text[128];
    for (size_t i = 0; i < COUNT(n); i++) {
        open_subject(&s[i], beam(kind, n[i]));
        f[i] = accelerate;
        data[i] = &s[i];
    }
    measure(f, data, COUNT(n), t);
    snprintf(text, sizeof text, "%s: u' per element, %d / %d elements", what, n[1], n[0]);
    ratio(text, t[1] / n[1] / (t[0] / n[0]), 1.2);
    for (size_t i = 0; i < COUNT(n); i++)
        close_subject(&s[i]);
}

// Forces of inertia, stiffness and weight for given accelerations: what the feasibility study calls inertia forces, here
// with the stiffness and all of the base's motion.
static void beam_forces(const char *what, const struct beam *kind)
{
    struct subject s;
    const call_fn f[] = {run_residual};
    void *const data[] = {&s};
    double t;
    open_subject(&s, beam(kind, 10));
    ct_formulate_residual(&s.equations);
    ct_machine_add_residual(s.ctx.model, s.machine);
    measure(f, data, 1, &t);
    line(what, t, 1.2e-6);
    close_subject(&s);
}

static void all_beams(bool quick)
{
    static const struct {
        const char *what;
        struct beam kind;
    } all[] = {{"foreshortened beam in a plane", {"foreshortening", false, false}},
               {"foreshortened beam in space", {"foreshortening", true, false}},
               {"linear beam in a plane", {"linear", false, false}},
               {"linear beam in space", {"linear", true, false}},
               {"beam in a plane that does not stretch",
                {"foreshortening, deformation: [bending-z]", false, false}},
               {"beam in space that does not stretch",
                {"foreshortening, deformation: [bending-y, bending-z]", true, false}},
               {"beams welded end to end in a plane", {"foreshortening", false, true}},
               {"beams welded end to end in space", {"foreshortening", true, true}}};
    for (size_t i = 0; i < COUNT(all); i++)
        beams(all[i].what, &all[i].kind, quick);
    title("", "time per element of the accelerations, solution included, at 100 elements over "
              "that at 5");
    for (size_t i = 0; i < COUNT(all) && !quick; i++)
        if (!all[i].kind.is_chain)
            beam_growth(all[i].what, &all[i].kind);
    title("", "forces of inertia, stiffness and weight");
    beam_forces("foreshortened beam in space, 10 elements: forces", &all[1].kind);
    beam_forces("linear beam in space, 10 elements: forces", &all[3].kind);
    unlink(temporary());
}

// ---- modes of large systems --------------------------------------------------------------------------

// A cantilever of 10 m, cut into nbeam beams of nelement elements each that are welded end to end.
static void write_cantilever(FILE *f, int nbeam, int nelement)
{
    fprintf(f, "cotree: 1\nbodies:\n");
    for (int i = 0; i < nbeam; i++)
        fprintf(f,
                "  b%d: {type: beam, length: 10/%d, elements: %d, mass_per_length: 1, E: 1e7, "
                "nu: 0.3, "
                "area: 1, Iy: 1/12, Iz: 1/10, J: 1/6, points: {tip: length}, "
                "deformation: [axial, bending-y, bending-z, torsion]}\n",
                i, nbeam, nelement);
    fprintf(f, "joints:\n  j0: {type: weld, from: ground, to: b0}\n");
    for (int i = 1; i < nbeam; i++)
        fprintf(f, "  j%d: {type: weld, from: b%d.tip, to: b%d}\n", i, i - 1, i);
}

// The first ten modes, from the file to the table. exact: the first frequency of the continuous beam [rad/s].
static void modes_of(const char *what, int nbeam, int nelement, double goal)
{
    const double exact = 32.096681251501935;
    char text[96];
    FILE *f = fopen(temporary(), "w");
    if (!f)
        return;
    write_cantilever(f, nbeam, nelement);
    fclose(f);
    const double start = now_of_all();
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys
        = ct_system_load(ctx, temporary(), &(struct ct_system_options){.for_analysis = true});
    struct ct_modes *modes = ct_modes_create(ctx, sys, NULL);
    const double t = now_of_all() - start;
    if (modes) {
        struct rusage use;
        getrusage(RUSAGE_SELF, &use);
        snprintf(text, sizeof text, "%s, %d dof", what, 6 * nbeam * nelement);
        line(text, t, goal);
        printf("  %-56s %9.1f MB\n", "memory, the most so far", 1e-3 * (double)use.ru_maxrss);
        printf("  %-56s %12.1e\n", "first frequency against the continuous beam",
               fabs(ct_modes_info(modes, 0).omega / exact - 1));
    }
    ct_modes_destroy(modes);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

static void large_modes(bool quick)
{
    static const int n[] = {17, 50, 167}; // tens of elements: 1000, 3000, 10 000 dof
    head("first 10 modes", "first 10 modes, from the file to the table");
    for (int i = 0; i < (quick ? 1 : 3); i++)
        modes_of("one beam", 1, 10 * n[i], i == 2 ? 5 : 0);
    for (int i = 0; i < (quick ? 1 : 3); i++)
        modes_of("chain of beams of 10 elements", n[i], 10, i == 2 ? 5 : 0);
}

int main(int argc, char **argv)
{
    const bool quick = argc > 1 && strcmp(argv[1], "--quick") == 0;
    if (quick)
        sample_seconds = 5e-5;
    printf("native code: %s\n", ct_native_is_available(1) ? "available" : "not available");
    head("", "one core, warm");
    if (argc > 1 && strcmp(argv[1], "--sweep") == 0) {
        sweep(argc > 2 ? atoi(argv[2]) : 10000);
        return 0;
    }
    if (argc > 1 && strcmp(argv[1], "--beams") == 0) {
        all_beams(false);
        show_goals();
        return 0;
    }
    open_chains(quick);
    andrews();
    four_bars(1);
    four_bars(10);
    sweep(quick ? 8 : 10000);
    if (!quick) {
        four_bars(40);
        many_four_bars(100);
        many_four_bars(333);
        links_by_bodies(20);
        links_by_bodies(80);
    }
    large_modes(quick);
    all_beams(quick);
    show_goals();
    return 0;
}
