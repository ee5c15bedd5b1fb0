// See bench.h.
#include "tests/bench/bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void bench_give_up(const struct subject *s)
{
    ct_ctx_print(&s->ctx, stderr);
    fprintf(stderr, "bench: %s failed\n", s->path);
    exit(1);
}

void bench_open_arenas(struct ct_ctx *ctx)
{
    *ctx = (struct ct_ctx){.model = ct_arena_create(), .scratch = ct_arena_create()};
    if (!ctx->model || !ctx->scratch)
        abort();
}

void bench_close_arenas(struct ct_ctx *ctx)
{
    ct_arena_destroy(ctx->scratch);
    ct_arena_destroy(ctx->model);
}

static const struct ct_formulate_options motion_options
    = {.tree = CT_TREE_AUTO, .with_solution = true};

bool bench_generate(struct subject *s)
{
    struct ct_tree_report report;
    struct ct_formulate_options options = motion_options;
    options.tree = s->tree;
    return ct_model_read(&s->ctx, s->path, NULL, 0, &s->model)
        && ct_formulate(&s->ctx, s->ctx.model, &s->model, &options, &s->equations, &report);
}

// Everything up to a machine in a consistent state.
void bench_open_subject_on(struct subject *s, const char *path, enum ct_tree_choice tree)
{
    const struct ct_formulate_options assembly = {.tree = CT_TREE_JOINTS,
                                                  .measure_all = true,
                                                  .measured_for = &s->equations,
                                                  .without_dynamics = true};
    struct ct_tree_report report;
    *s = (struct subject){.path = path, .tree = tree};
    bench_open_arenas(&s->ctx);
    const double start = bench_now();
    if (!bench_generate(s))
        bench_give_up(s);
    s->generate = bench_now() - start;
    const double generated = bench_now();
    if (s->equations.nrow)
        ct_formulate_dynamics(&s->equations);
    if (!ct_formulate(&s->ctx, s->ctx.model, &s->model, &assembly, &s->assembly, &report)
        || !ct_assembly_solve(&s->ctx, s->ctx.model, &s->model, &s->assembly, &s->start))
        bench_give_up(s);
    s->run = ct_run_create(&s->ctx, s->ctx.model, &s->model, &s->equations, &s->start);
    if (!s->run)
        bench_give_up(s);
    s->prepare = bench_now() - generated;
    s->machine = ct_run_evaluator(s->run);
    ct_evaluator_set(s->machine, 0, ct_run_state(s->run));
}

void bench_open_subject(struct subject *s, const char *path)
{
    bench_open_subject_on(s, path, CT_TREE_AUTO);
}

void bench_close_subject(struct subject *s)
{
    bench_close_arenas(&s->ctx);
}

const char *bench_temporary(void)
{
    static char path[64];
    snprintf(path, sizeof path, "/tmp/ct_bench_%ld.yaml", (long)getpid());
    return path;
}

// The file that systems/NAME/generate.sh N writes.
const char *bench_generated(const char *name, int n)
{
    char command[512];
    snprintf(command, sizeof command, "sh '%s/systems/%s/generate.sh' %d > %s",
             getenv("CT_SOURCE_DIR") ? getenv("CT_SOURCE_DIR") : ".", name, n,
             bench_temporary());
    if (system(command) != 0)
        exit(1);
    return bench_temporary();
}

static FILE *open_model(const char *name, const char *gravity, const char *parameters)
{
    FILE *f = fopen(bench_temporary(), "w");
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
    return bench_temporary();
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

const char *bench_spatial_chain(int n)
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

const char *bench_planar_chain(int n)
{
    FILE *f = open_model("pins", "[0, -g, 0]", ", m: 1, l: 1, c: 0.5, J: 0.1");
    fprintf(f, "bodies:\n");
    for (int i = 1; i <= n; i++)
        fprintf(f, "  b%d: {mass: m, com: [c, 0, 0], inertia: J, points: {end: [l, 0, 0]}}\n",
                i);
    put_joints(f, n, "revolute");
    return close_model(f);
}

// Arm of 6 or 7 turning axes with everything a parameter: masses, centres of mass, full inertias,
// lengths.
const char *bench_arm(int n)
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

const char *bench_chain_of_beams(const struct beam *k, int n)
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

const char *bench_beam(const struct beam *k, int n)
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

const char *bench_shipped(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/systems/%s/model.yaml",
             getenv("CT_SOURCE_DIR") ? getenv("CT_SOURCE_DIR") : ".", name);
    return path;
}
