// Speed of generated programs and of generating them: a table of measured times beside their goals.
//
//     bench [--quick | --beams | --sweep [MEMBERS]]
//
// Models are read from YAML and go through the normal stages. A time is the median of 11 samples of
// the thread's processor time, each of many calls, and of three such medians the least; what a
// ratio compares is measured alternately in one run, so that a busy machine slows both sides. A
// loop whose work is always the same is timed along with every row: where it takes longer than it
// did before, the row is measured again (whatever slows everything at once, for a second or so, is
// not the program). At the end all quantities with a goal stand together. Goals are those of the
// project's feasibility study, measured there on one core of a server processor at 3.6 GHz; they
// include solving for the accelerations where the name says so.
#include "codegen/native.h"
#include "expr/tape.h"
#include "tests/bench/bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

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
    const struct ct_evaluator *m = s->machine;
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
    bench_measure(f, data, n, t);
    const struct ct_tape_counts c = p->listing->counts;
    bench_title(name, "%s, %s: %ld mul, %ld add, %ld div, %ld functions, %zu outputs", name,
                what, c.multiplications, c.additions, c.divisions, c.functions, p->nout);
    for (size_t i = 0; i < n; i++) {
        char text[96];
        snprintf(text, sizeof text, "  %s", v[i].name);
        bench_line(text, t[i] / v[i].lanes, goal ? goal[i] : 0);
    }
    if (n == NBACKEND) {
        bench_ratio("  tape / native", t[0] / t[3], 0);
        bench_ratio("  native / native, 4 lanes, per lane", 4 * t[3] / t[4], 0);
    }
    struct times all_times = {{0}};
    for (size_t i = 0; i < n; i++)
        all_times.t[i] = t[i] / v[i].lanes;
    return all_times;
}

// Twelve chains of fused products and sums, which do not wait for each other: what the processor
// can do at most, in multiplications and additions a second.
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
        bench_measure(f, data, 1, &t);
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
    bench_ratio("  part of the peak of fused operations, at least", n / t->t[3] / peak(1),
                0.45);
    bench_ratio("  the same in 4 lanes, at least", n / t->t[4] / peak(4), 0.45);
}

// ---- accelerations ------------------------------------------------------------------------------

static void accelerate(void *data)
{
    struct subject *s = data;
    ct_partition_solve(ct_run_partition(s->run));
}

static void accelerate_by_matrices(void *data)
{
    struct subject *s = data;
    ct_evaluator_dynamics(s->machine);
    ct_partition_accelerate(ct_run_partition(s->run));
}

static void assemble(void *data)
{
    struct subject *s = data;
    ct_evaluator_dynamics(s->machine);
}

// M, Q, J, gam and the solve, with a goal for both together.
static void show_accelerations(struct subject *s, const char *what, double per, double goal)
{
    const call_fn f[] = {accelerate, assemble, accelerate_by_matrices};
    void *const data[] = {s, s, s};
    double t[3];
    char text[96];
    bench_measure(f, data, 3, t);
    bench_line(what, t[0] / per, goal);
    bench_line("  the same by matrices", t[2] / per, 0);
    snprintf(text, sizeof text, "  of that assembly (%s)", s->machine->backend);
    bench_line(text, t[1] / per, 0);
}

// One projection of the state at hand, which meets the constraints already: the least that a step
// pays.
static void project(void *data)
{
    struct subject *s = data;
    ct_partition_project(ct_run_partition(s->run), 0, s->state);
}

static void show_projection(struct subject *s, double per)
{
    const call_fn f[] = {project};
    void *const data[] = {s};
    double t;
    const size_t ny = s->machine->nq + s->machine->nu + 1;
    s->state = CT_NEWN(s->ctx.model, double, ny);
    memcpy(s->state, ct_run_state(s->run), ny * sizeof(double));
    bench_measure(f, data, 1, &t);
    bench_line("  projection, with the check of the pivots", t / per, 0);
}

// ---- generating ---------------------------------------------------------------------------------

static double median_of(double (*f)(const char *path), const char *path, int n)
{
    double t[NSAMPLE] = {0}, least = 0;
    for (int repeat = 0; repeat < NREPEAT; repeat++) {
        for (int i = 0; i < n; i++)
            t[i] = f(path);
        qsort(t, (size_t)n, sizeof t[0], bench_compare_doubles);
        least = repeat && least < t[n / 2] ? least : t[n / 2];
    }
    return least;
}

// From the file to machine code of the motion program.
static double model_to_native(const char *path)
{
    struct subject s = {.path = path};
    bench_open_arenas(&s.ctx);
    const double start = bench_now();
    if (!bench_generate(&s))
        bench_give_up(&s);
    ct_evaluator_create(s.ctx.model, &s.model, &s.equations);
    const double t = bench_now() - start;
    bench_close_subject(&s);
    return t;
}

static double model_to_equations(const char *path)
{
    struct subject s = {.path = path};
    bench_open_arenas(&s.ctx);
    const double start = bench_now();
    if (!bench_generate(&s))
        bench_give_up(&s);
    const double t = bench_now() - start;
    bench_close_subject(&s);
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
    bench_measure(f, data, 4, t);
    const double nnode = (double)s->equations.x->nnode, nins = (double)l->nins;
    bench_title(what, "%s: %zu nodes in the store, %zu instructions", what,
                s->equations.x->nnode, l->nins);
    bench_line("  graph construction, per node", t[0] / nnode, 40e-9);
    bench_line("  listing, per instruction", t[1] / nins, 0);
    bench_line("  tape from the listing, per instruction", t[2] / nins, 0);
    bench_line("  native code from the listing, per instruction", t[3] / nins, 0);
    bench_line("  order and emit (listing + native), per instruction", (t[1] + t[3]) / nins,
               250e-9);
}

// ---- what is measured ---------------------------------------------------------------------------

static void run_solved(void *data)
{
    struct subject *s = data;
    ct_program_run(&s->machine->solved, s->machine->input);
}

// Speeds by chance. Of a straight chain at rest accelerations fall from ball to ball until they are
// smaller than normal numbers, which take much longer (500 balls: 45.8 instead of 34.7 us); no
// motion stays there.
static void set_in_motion(struct subject *s)
{
    struct ct_evaluator *m = s->machine;
    uint64_t chance = 1;
    for (size_t i = m->at_u; i < m->at_u + m->nu; i++) {
        chance = chance * 6364136223846793005u + 1442695040888963407u;
        m->input[i] = (double)(chance >> 11) / (double)(1ll << 52) - 1;
    }
}

// An open chain: u' and q' by the formulation that was chosen. goal: as compare_back_ends, then of
// the way from the model to native code. is_throughput: show which part of the processor's peak it
// reaches. Returns the time from the model to native code.
static double open_chain(const char *what, const char *path, const double goal[NBACKEND],
                         double generation_goal, bool is_throughput)
{
    static const char *const name[]
        = {"", "cutset sums", "composite bodies", "articulated bodies"};
    struct subject s;
    char text[128];
    bench_open_subject(&s, path);
    snprintf(text, sizeof text, "u' by %s", name[s.equations.formulation]);
    const call_fn f[] = {run_solved};
    void *const data[] = {&s};
    double rest;
    bench_measure(f, data, 1, &rest);
    set_in_motion(&s);
    const struct times t = compare_back_ends(&s, &s.machine->solved, what, text, goal);
    if (is_throughput)
        show_use(&s.machine->solved, &t);
    bench_line("  native, at rest", rest, 0);
    bench_line("  model to equations", median_of(model_to_equations, s.path, 5), 0);
    const double generation = median_of(model_to_native, s.path, 5);
    bench_line("  model to native code", generation, generation_goal);
    show_generation(&s, what);
    printf("  %-56s %9zu KiB\n", "machine code",
           s.machine->solved.native ? ct_native_code_size(s.machine->solved.native) / 1024 : 0);
    bench_close_subject(&s);
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
    bench_open_subject(&s, path);
    ct_formulate_residual(&s.equations);
    ct_evaluator_add_residual(s.ctx.model, s.machine);
    bench_measure(f, data, 1, &t);
    bench_title(name, "%s, forces for given motion", name);
    bench_line("  inverse dynamics, native", t, goal);
    bench_close_subject(&s);
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
    } list[]
        = {{r->dq, r->ndq}, {r->du, r->ndu}, {r->da, r->nda}, {r->dk, r->ndk}, {r->dv, r->ndv}};
    ct_ex *out = CT_NEWN(
        a, ct_ex, e->nu + 2 * e->nrow + e->nJ + r->ndq + r->ndu + r->nda + r->ndk + r->ndv + 1);
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
    ct_evaluator_add_program(a, s->machine, e->x, out, n, &p.program);
    const call_fn f[] = {run_apart};
    void *const data[] = {&p};
    double t;
    bench_measure(f, data, 1, &t);
    bench_line(what, t, goal);
    ct_evaluator_remove_program(s->machine, &p.program);
}

// Accelerations with the order of pivots made at the start against pivots sought anew, at positions
// and speeds around it: the relative difference that one state in a hundred exceeds.
static void fixed_against_pivoted(struct subject *s)
{
    enum { NSTATE = 1000 };
    static double difference[NSTATE];
    struct ct_evaluator *m = s->machine;
    struct ct_partition *e = ct_run_partition(s->run);
    double *kept = CT_NEWN(s->ctx.model, double, m->ninput),
           *a = CT_NEWN(s->ctx.model, double, m->nu + 1);
    uint64_t chance = 1;
    memcpy(kept, m->input, m->ninput * sizeof *kept);
    for (int k = 0; k < NSTATE && e->nsolver; k++) {
        double most = 0, worst = 0;
        for (size_t i = m->at_q; i < m->at_u + m->nu; i++) {
            chance = chance * 6364136223846793005u + 1442695040888963407u;
            m->input[i] = kept[i] + 0.5 * ((double)(chance >> 11) / (double)(1ll << 52) - 1);
        }
        ct_evaluator_dynamics(m);
        ct_partition_accelerate(e);
        const bool ok = ct_solver_solve(e->solver[0], m, a) > 0;
        for (size_t i = 0; i < m->nu; i++) {
            most = fmax(most, fabs(e->a[i]));
            worst = fmax(worst, fabs(a[i] - e->a[i]));
        }
        difference[k] = ok ? worst / most : INFINITY;
    }
    memcpy(m->input, kept, m->ninput * sizeof *kept);
    qsort(difference, NSTATE, sizeof difference[0], bench_compare_doubles);
    bench_ratio("  fixed against sought pivots, 99 % of random states",
                difference[NSTATE / 100 * 99], 1e-9);
}

// The first step of an implicit method: what it needs beside the equations, and its derivatives.
static void run_tangent(void *data)
{
    ct_evaluator_tangent(data);
}

static void implicit_chain(int n)
{
    struct subject s;
    char text[96];
    bench_open_subject(&s, bench_spatial_chain(n));
    const double start = bench_now();
    ct_formulate_residual(&s.equations);
    ct_evaluator_add_residual(s.ctx.model, s.machine);
    const double made = bench_now() - start;
    const call_fn f[] = {run_tangent};
    void *const data[] = {s.machine};
    double t;
    bench_measure(f, data, 1, &t);
    const struct ct_directional *along = s.equations.residual->along;
    bench_title("", "chain of %d balls, derivatives for implicit methods %s", n,
                along ? "along directions" : "entry by entry");
    bench_line("  residual and derivatives, from equations to native code", made, 0);
    snprintf(text, sizeof text, "  all derivatives (%zu x %zu)", s.machine->nu,
             3 * s.machine->nu);
    bench_line(text, t, 0);
    bench_close_subject(&s);
}

static void open_chains(bool quick)
{
    static const double six_folded[NBACKEND]
        = {0.8e-6, 0, 0, 120e-9, 42e-9},
        six[NBACKEND] = {0.8e-6, 0, 0, 150e-9, 42e-9}, seven[NBACKEND] = {0, 0, 0, 190e-9, 0},
        planar[NBACKEND] = {0, 0, 0, 1.5e-6, 0}, spatial[NBACKEND] = {0, 0, 0, 4e-6, 0},
        long_spatial[NBACKEND] = {0, 0, 0, 40e-6, 0};
    open_chain("6R arm (puma560, numbers folded)", bench_shipped("puma560"), six_folded, 0.5e-3,
               false);
    open_chain("6R arm, parameters", bench_arm(6), six, 0.5e-3, false);
    inverse_dynamics("6R arm, parameters", bench_arm(6), 140e-9);
    open_chain("7-dof arm, parameters", bench_arm(7), seven, 0, false);
    implicit_chain(quick ? 5 : 50);
    if (quick)
        return;
    open_chain("planar chain of 50 pins", bench_planar_chain(50), planar, 0, false);
    const double t50 = open_chain("chain of 50 balls (150 freedoms)", bench_spatial_chain(50),
                                  spatial, 5e-3, true);
    const double t500 = open_chain("chain of 500 balls (1500 freedoms)",
                                   bench_spatial_chain(500), long_spatial, 2, false);
    bench_title("", "chains of balls");
    bench_ratio("  model to native code, 500 balls / 50 balls", t500 / t50, 15);
    unlink(bench_temporary());
}

static void andrews(void)
{
    struct subject s;
    bench_open_subject(&s, bench_shipped("andrews"));
    compare_back_ends(&s, &s.machine->motion, "Andrews' mechanism", "M, Q, J, gam", NULL);
    show_accelerations(&s, "  accelerations, solve included, native", 1, 160e-9);
    residual_and_slopes(&s, "  residual and its sparse Jacobian", 160e-9);
    fixed_against_pivoted(&s);
    ct_evaluator_use(s.ctx.model, s.machine, CT_BACKEND_TAPE);
    show_accelerations(&s, "  accelerations, solve included, tape", 1, 0.6e-6);
    bench_close_subject(&s);
}

static void four_bars(int n)
{
    struct subject s;
    char what[64];
    bench_open_subject(&s, bench_generated("n_four_bar", n));
    snprintf(what, sizeof what, "%d four-bar%s", n, n > 1 ? "s" : "");
    compare_back_ends(&s, &s.machine->motion, what, "M, Q, J, gam", NULL);
    show_accelerations(&s, "  accelerations, solve included, per loop", n, 60e-9);
    show_projection(&s, n);
    bench_close_subject(&s);
    unlink(s.path);
}

static const char *solver(const struct subject *s)
{
    const struct ct_partition *e = ct_run_partition(s->run);
    return e->nsolver ? e->solver[0]->kind->name : "dense";
}

// A coordinate for each place and angle: many freedoms, all of them coupled, and sparse matrices.
static void links_by_bodies(int n)
{
    struct subject s;
    bench_open_subject_on(&s, bench_generated("chain40", n), CT_TREE_ABSOLUTE);
    bench_title("", "chain of %d links on trees of bodies: %zu speeds, %zu rows, solved by %s",
                n, s.machine->nu, s.machine->nrow, solver(&s));
    show_accelerations(&s, "  accelerations, solve included, per link", n, 0);
    show_projection(&s, n);
    bench_close_subject(&s);
    unlink(s.path);
}

// Cost per loop must not grow with the number of loops: 3 n + 1 bodies and joints, ground included.
static void many_four_bars(int n)
{
    struct subject s;
    bench_open_subject(&s, bench_generated("n_four_bar", n));
    char what[64];
    snprintf(what, sizeof what, "%d four-bars", n);
    bench_title(what, "%s in a row: %zu bodies, %zu joints, solved by %s", what,
                s.model.nbody - 1, s.model.njoint, solver(&s));
    bench_line("  model to equations", s.generate, 2);
    bench_line("  equations to the start of a run", s.prepare, 0);
    bench_size("  memory of model, equations and run", ct_arena_used(s.ctx.model));
    show_accelerations(&s, "  accelerations, solve included, per loop", n, 60e-9);
    show_projection(&s, n);
    bench_close_subject(&s);
    unlink(s.path);
}

// ---- parameter studies --------------------------------------------------------------------------

// What a member costs where one run follows another, at values of the sweep's own, between its
// rows.
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
    const double before = bench_now();
    char torque[40];
    snprintf(torque, sizeof torque, "torque=%.17g", varied[0]);
    const char *const set[] = {torque};
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *system
        = ct_system_load(ctx, s->path, &(struct ct_system_options){.set = set, .nset = 1});
    const double start = bench_now();
    struct ct_sim *sim = ct_sim_create(ctx, system, &(struct ct_sim_options){.samples = 2});
    const double ready = bench_now();
    if (!ct_sim_run(ctx, sim, &(struct ct_sim_results){.row = keep_row, .user = last}))
        exit(1);
    s->run += bench_now() - ready;
    s->prepare += ready - start;
    for (size_t i = 0; i + 1 < ct_system_column_count(system); i++)
        s->difference = fmax(s->difference, fabs(value[i] - last[i]) / fmax(fabs(last[i]), 1));
    s->n++;
    ct_sim_destroy(sim);
    ct_system_destroy(system);
    ct_ctx_destroy(ctx);
    s->spent += bench_now() - before;
    return true;
}

// Members in lanes on one core, everything included, against single runs in between.
static void sweep(int members)
{
    struct singles s
        = {.path = bench_shipped("slider_crank"), .every = members < 1000 ? 2 : 50};
    char vary[64];
    snprintf(vary, sizeof vary, "torque=0.4:0.6:%d", members);
    const char *const list[] = {vary};
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_study *study = ct_study_create(
        ctx, s.path, NULL, &(struct ct_study_options){.vary = list, .nvary = 1, .threads = 1});
    const double start = bench_now();
    if (!ct_study_run(ctx, study, &(struct ct_study_results){.row = run_single, .user = &s}))
        exit(1);
    const double lanes = (bench_now() - start - s.spent) / members;
    ct_study_destroy(study);
    ct_ctx_destroy(ctx);
    bench_title("sweep of the slider-crank", "slider-crank, 2 s: sweep of %d members", members);
    bench_line("  per member, all included", lanes, 0);
    bench_line("  single run: integration only, the system ready", s.run / (double)s.n, 0);
    bench_line("  single run: made ready of a system that is there", s.prepare / (double)s.n,
               0);
    bench_ratio("  integration only / member, at least", s.run / (double)s.n / lanes, 3);
    bench_ratio("  made ready and integrated / member",
                (s.prepare + s.run) / (double)s.n / lanes, 0);
    printf("%-58s %12.1e\n", "  largest difference of a row from its single run", s.difference);
}

// ---- beams --------------------------------------------------------------------------------------

static double accelerations(struct subject *s)
{
    const call_fn f[] = {accelerate};
    void *const data[] = {s};
    double t;
    bench_measure(f, data, 1, &t);
    return t;
}

static double operations(const struct subject *s)
{
    const struct ct_evaluator *m = s->machine;
    const struct ct_tape_counts c = (m->solved.nout ? &m->solved : &m->motion)->listing->counts;
    return (double)(c.multiplications + c.additions + c.divisions + c.functions)
         + (m->solved.nout ? 0 : ct_partition_operations(ct_run_partition(s->run)));
}

// Cost against the number of elements, or of beams in a chain; it should be in proportion.
static void beams(const char *what, const struct beam *kind, bool quick)
{
    static const int element[] = {5, 10, 20, 50, 100}, link[] = {4, 8, 16, 32, 64};
    const int *all = kind->is_chain ? link : element;
    const char *of = kind->is_chain ? "beam" : "element";
    double first = 0, first_generation = 0;
    bench_title(
        what,
        "%s, u' with the solve: per evaluation, per %s, ratio to %d | model to native, per "
        "%s, ratio | operations per %s",
        what, of, all[0], of, of);
    for (size_t i = 0; i < (quick ? 2 : COUNT(element)); i++) {
        struct subject s;
        const int n = all[i];
        const char *path = kind->is_chain ? bench_chain_of_beams(kind, n) : bench_beam(kind, n);
        const double generation = median_of(model_to_native, path, quick ? 1 : 3) / n;
        bench_open_subject(&s, path);
        const double t = accelerations(&s) / n;
        first = i ? first : t;
        first_generation = i ? first_generation : generation;
        printf("  N = %3d %22.3f us %10.1f ns %8.2f | %8.3f ms %8.1f us %8.2f | %8.0f\n", n,
               1e6 * n * t, 1e9 * t, t / first, 1e3 * n * generation, 1e6 * generation,
               generation / first_generation, operations(&s) / n);
        bench_close_subject(&s);
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
        bench_open_subject(&s[i], bench_beam(kind, n[i]));
        f[i] = accelerate;
        data[i] = &s[i];
    }
    bench_measure(f, data, COUNT(n), t);
    snprintf(text, sizeof text, "%s: u' per element, %d / %d elements", what, n[1], n[0]);
    bench_ratio(text, t[1] / n[1] / (t[0] / n[0]), 1.2);
    for (size_t i = 0; i < COUNT(n); i++)
        bench_close_subject(&s[i]);
}

// Forces of inertia, stiffness and weight for given accelerations: what the feasibility study calls
// inertia forces, here with the stiffness and all of the base's motion.
static void beam_forces(const char *what, const struct beam *kind)
{
    struct subject s;
    const call_fn f[] = {run_residual};
    void *const data[] = {&s};
    double t;
    bench_open_subject(&s, bench_beam(kind, 10));
    ct_formulate_residual(&s.equations);
    ct_evaluator_add_residual(s.ctx.model, s.machine);
    bench_measure(f, data, 1, &t);
    bench_line(what, t, 1.2e-6);
    bench_close_subject(&s);
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
    bench_title(
        "", "time per element of the accelerations, solution included, at 100 elements over "
            "that at 5");
    for (size_t i = 0; i < COUNT(all) && !quick; i++)
        if (!all[i].kind.is_chain)
            beam_growth(all[i].what, &all[i].kind);
    bench_title("", "forces of inertia, stiffness and weight");
    beam_forces("foreshortened beam in space, 10 elements: forces", &all[1].kind);
    beam_forces("linear beam in space, 10 elements: forces", &all[3].kind);
    unlink(bench_temporary());
}

// ---- modes of large systems ---------------------------------------------------------------------

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

// The first ten modes, from the file to the table. exact: the first frequency of the continuous
// beam [rad/s].
static void modes_of(const char *what, int nbeam, int nelement, double goal)
{
    const double exact = 32.096681251501935;
    char text[96];
    FILE *f = fopen(bench_temporary(), "w");
    if (!f)
        return;
    write_cantilever(f, nbeam, nelement);
    fclose(f);
    const double start = bench_now_of_all();
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = ct_system_load(ctx, bench_temporary(),
                                           &(struct ct_system_options){.for_analysis = true});
    struct ct_modes *modes = ct_modes_create(ctx, sys, NULL);
    const double t = bench_now_of_all() - start;
    if (modes) {
        struct rusage use;
        getrusage(RUSAGE_SELF, &use);
        snprintf(text, sizeof text, "%s, %d dof", what, 6 * nbeam * nelement);
        bench_line(text, t, goal);
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
    bench_head("first 10 modes", "first 10 modes, from the file to the table");
    for (int i = 0; i < (quick ? 1 : 3); i++)
        modes_of("one beam", 1, 10 * n[i], i == 2 ? 5 : 0);
    for (int i = 0; i < (quick ? 1 : 3); i++)
        modes_of("chain of beams of 10 elements", n[i], 10, i == 2 ? 5 : 0);
}

int main(int argc, char **argv)
{
    const bool quick = argc > 1 && strcmp(argv[1], "--quick") == 0;
    if (quick)
        bench_sample_seconds = 5e-5;
    printf("native code: %s\n", ct_native_is_available(1) ? "available" : "not available");
    bench_head("", "one core, warm");
    if (argc > 1 && strcmp(argv[1], "--sweep") == 0) {
        sweep(argc > 2 ? atoi(argv[2]) : 10000);
        return 0;
    }
    if (argc > 1 && strcmp(argv[1], "--beams") == 0) {
        all_beams(false);
        bench_show_goals();
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
    bench_show_goals();
    return 0;
}
