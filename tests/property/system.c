// See system.h.
#include "tests/property/system.h"

#include <float.h>
#include "tests/property/mechanism.h"

#include <stdarg.h>

const char *const shipped[] = {"systems/andrews/model.yaml",
                               "systems/bricard/model.yaml",
                               "systems/cart_pole/model.yaml",
                               "systems/chain40/model.yaml",
                               "systems/double_pendulum/model.yaml",
                               "systems/four_bar/model.yaml",
                               "systems/four_bar_near_singular/model.yaml",
                               "systems/gimbal_top/model.yaml",
                               "systems/governor/model.yaml",
                               "systems/heavy_top/model.yaml",
                               "systems/light_cart/model.yaml",
                               "systems/n_four_bar/model.yaml",
                               "systems/pendulum/model.yaml",
                               "systems/puma560/model.yaml",
                               "systems/puma560_driven/model.yaml",
                               "systems/slider_crank/model.yaml",
                               "systems/spatial_four_bar/model.yaml",
                               "systems/spatial_slider_crank/model.yaml",
                               "systems/stewart/model.yaml",
                               "systems/stiff_spring_pendulum/model.yaml",
                               "systems/tumbling_body/model.yaml"};
const size_t nshipped = COUNT(shipped);

const struct ct_formulate_options by_joints
    = {.tree = CT_TREE_JOINTS, .with_energy = true, .with_outputs = true},
    by_bodies = {.tree = CT_TREE_ABSOLUTE, .with_energy = true, .with_outputs = true},
    by_choice = {.tree = CT_TREE_AUTO, .with_energy = true, .with_outputs = true},
    by_joints_spatial
    = {.tree = CT_TREE_JOINTS, .with_energy = true, .with_outputs = true, .keep_all = true},
    by_bodies_spatial
    = {.tree = CT_TREE_ABSOLUTE, .with_energy = true, .with_outputs = true, .keep_all = true};

// ---- chance and comparison ----------------------------------------------------------------------

static uint64_t seed = 20240611;

void chance_start(void)
{
    const char *given = getenv("CT_TEST_SEED");
    seed = given ? strtoull(given, NULL, 10) : 20240611;
    print_message("seed %llu (CT_TEST_SEED)\n", (unsigned long long)seed);
}

// 64-bit congruential generator, constants of Knuth (MMIX)
double chance(void)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) / 4503599627370496.0 - 1;
}

int chance_of(int n)
{
    return (int)floor((chance() + 1) / 2 * n);
}

bool agree(const char *system, const char *what, double got, double want, double scale,
           double tol)
{
    if (fabs(got - want) <= tol * scale) // false for NaN
        return true;
    print_error("%s: %s: got %.17g, wanted %.17g, difference %.3g of %.3g\n", system, what, got,
                want, got - want, scale);
    return false;
}

double largest_of(const double *v, size_t n)
{
    double max = 0;
    for (size_t i = 0; i < n; i++)
        max = fmax(max, fabs(v[i]));
    return max;
}

bool same(const char *name, const char *what, const double *got, const double *want, size_t n,
          double tol)
{
    const double scale = fmax(largest_of(want, n), DBL_MIN);
    bool ok = true;
    for (size_t i = 0; i < n; i++)
        ok &= agree(name, what, got[i], want[i], scale, tol);
    return ok;
}

char *text_of(struct ct_arena *a, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    char *text = ct_arena_vprintf(a, fmt, ap);
    va_end(ap);
    return text;
}

char *coupler_text(struct ct_arena *a, int n, const char *keys, const char *bodies,
                   const char *joints)
{
    return text_of(
        a,
        "cotree: 1\ngravity: [0, 0, -9.81]\nbodies:\n  ground: {points: {foot: [0.4, 0.15, "
        "0]}}\n"
        "  crank: {mass: 0.3, inertia: [1e-4, 3e-4, 3e-4], com: [0.05, 0, 0], points: {pin: "
        "[0.1, 0, 0.02]}}\n"
        "  rocker: {mass: 0.5, inertia: [4e-4, 4e-3, 4e-3], com: [0, 0, 0.15], points: {pin: "
        "[0, 0, 0.25]}}\n"
        "  rod: {type: beam, length: 0.42, elements: %d, density: 2700, E: 7e10, nu: 0.346, "
        "area: 1e-4, J: 2e-9, Iy: 1e-9, Iz: 2e-9, formulation: foreshortening, "
        "deformation: [bending-y, bending-z], points: {mid: 0.14, tip: length}, %s}\n%s"
        "joints:\n"
        "  main: {type: revolute, from: ground, to: crank, axis: z, initial: {q: 0.5, u: 10}}\n"
        "  swing: {type: revolute, from: ground.foot, to: rocker, axis: y, initial: {q: 0.2, "
        "guess: true}}\n"
        "  big_end: {type: spherical, from: crank.pin, to: rod, initial: {rotate: [[z, 0.2], "
        "[y, -0.5]], guess: true}}\n"
        "  small_end: {type: spherical, from: rod.tip, to: rocker.pin}\n%s",
        n, keys, bodies, joints);
}

// ---- systems ------------------------------------------------------------------------------------

static void start(struct system *s, const char *name)
{
    *s = (struct system){.name = name};
    s->ctx.model = ct_arena_create();
    s->ctx.scratch = ct_arena_create();
    assert_non_null(s->ctx.model);
    assert_non_null(s->ctx.scratch);
}

static bool assemble(struct system *s, bool keep_all)
{
    const struct ct_formulate_options o
        = {.tree = CT_TREE_JOINTS, .measure_all = true, .keep_all = keep_all};
    struct ct_tree_report report;
    if (!ct_formulate(&s->ctx, s->ctx.model, &s->model, &o, &s->assembly, &report)
        || !ct_assembly_solve(&s->ctx, s->ctx.model, &s->model, &s->assembly, &s->start))
        return false;
    s->machine = ct_evaluator_create(s->ctx.model, &s->model, &s->assembly);
    s->embed = ct_partition_create(s->ctx.model, &s->ctx, s->machine);
    s->y = CT_NEWN(s->ctx.model, double, s->machine->nq + s->machine->nu + 1);
    ct_initial_state_apply(&s->start, s->machine, s->y);
    return true;
}

static void must(struct system *s, bool ok)
{
    if (ok)
        return;
    print_error("%s: cannot be set up\n", s->name);
    ct_ctx_print(&s->ctx, stderr);
    fail();
}

void system_open_file(struct system *s, const char *file)
{
    const char *root = getenv("CT_SOURCE_DIR");
    start(s, file);
    const char *path = text_of(s->ctx.model, "%s/%s", root ? root : ".", file);
    must(s, ct_model_read(&s->ctx, path, NULL, 0, &s->model) && assemble(s, false));
}

bool system_try_text(struct system *s, const char *name, const char *text)
{
    start(s, name);
    return ct_model_parse(&s->ctx, name, text, strlen(text), NULL, 0, &s->model)
        && assemble(s, false);
}

void system_open_text(struct system *s, const char *name, const char *text)
{
    const bool ok = system_try_text(s, name, text);
    if (!ok)
        print_error("%s\n", text);
    must(s, ok);
}

void system_keep_all(struct system *s)
{
    must(s, assemble(s, true));
}

void system_close(struct system *s)
{
    ct_arena_destroy(s->ctx.scratch);
    ct_arena_destroy(s->ctx.model);
}

bool holds_for_shipped(bool (*holds)(struct system *s), size_t most)
{
    bool ok = true;
    for (size_t i = 0; i < nshipped; i++) {
        struct system s;
        system_open_file(&s, shipped[i]);
        if (s.model.nbody < most)
            ok &= holds(&s);
        system_close(&s);
    }
    return ok;
}

bool holds_for_mechanisms(bool (*holds)(struct system *s), unsigned reversed)
{
    bool ok = true;
    for (size_t i = 0; i < nmechanism; i++)
        for (unsigned k = 0; k < (mechanisms[i].is_irreversible ? 1u : 2u); k++) {
            struct system s;
            struct ct_arena *a = ct_arena_create();
            system_open_text(&s, text_of(a, "%s%s", mechanisms[i].name, k ? ", reversed" : ""),
                             mechanism_text(a, &mechanisms[i], NULL, k * reversed, false));
            ok &= holds(&s);
            system_close(&s);
            ct_arena_destroy(a);
        }
    return ok;
}

void system_no_outputs(struct system *s)
{
    s->model.noutput = 0;
}

// "rod.position.x" is one of the columns of "rod.position", "pivot.u2" of "pivot.u".
static bool is_part_of(const char *signal, const char *whole)
{
    const size_t n = strlen(whole);
    return !strncmp(signal, whole, n)
        && (signal[n] == 0 || signal[n] == '.' || (signal[n] >= '1' && signal[n] <= '9'));
}

// A column that is there already is not there twice.
void system_output(struct system *s, const char *signal)
{
    size_t kept = 0;
    for (size_t i = 0; i < s->model.noutput; i++) {
        if (is_part_of(signal, s->model.output[i].name))
            return;
        if (!is_part_of(s->model.output[i].name, signal))
            s->model.output[kept++] = s->model.output[i];
    }
    s->model.noutput = kept;
    struct ct_model *m = &s->model;
    struct ct_output o = {.name = ct_arena_strdup(s->ctx.model, signal), .is_signal = true};
    o.value = ct_ex_sym(m->x, CT_SYM_SIGNAL, o.name, 0);
    CT_PUSH(s->ctx.model, m->output, m->noutput, m->output_cap, o);
}

void system_output_motion(struct system *s)
{
    struct ct_arena *a = s->ctx.model;
    for (size_t i = 1; i < s->model.nbody; i++) {
        const char *name = s->model.body[i].instance.name;
        system_output(s, text_of(a, "%s.position", name));
        system_output(s, text_of(a, "%s.velocity", name));
        system_output(s, text_of(a, "%s.acceleration", name));
        system_output(s, text_of(a, "%s.rotation", name));
        system_output(s, text_of(a, "%s.angular_velocity", name));
        system_output(s, text_of(a, "%s.angular_acceleration", name));
    }
    for (size_t i = 0; i < s->model.njoint; i++)
        if (s->model.joint[i].from >= 0 && s->model.joint[i].nfree > 0) {
            system_output(s, text_of(a, "%s.q", s->model.joint[i].name));
            system_output(s, text_of(a, "%s.u", s->model.joint[i].name));
            system_output(s, text_of(a, "%s.a", s->model.joint[i].name));
        }
}

void system_output_reactions(struct system *s)
{
    struct ct_arena *a = s->ctx.model;
    for (size_t i = 0; i < s->model.njoint; i++) {
        const struct ct_instance *j = &s->model.joint[i];
        if (j->from >= 0) {
            system_output(s, text_of(a, "%s.force", j->name));
            system_output(s, text_of(a, "%s.torque", j->name));
        }
        if (j->from < 0 || j->nfree > 0)
            system_output(s, text_of(a, "%s.effort", j->name));
    }
}

static bool meets_rows(const struct ct_evaluator *m)
{
    for (size_t i = 0; i < m->nrow; i++)
        if (!(fabs(m->phi[i]) < 1e-11 && fabs(m->v[i]) < 1e-10))
            return false;
    return true;
}

// One small step that the rows allow to first order, then onto them.
static bool wander(struct system *s, double t, double amplitude, const double *wish, double *y)
{
    struct ct_evaluator *m = s->machine;
    double *d = y + m->nq; // speeds are projected, so they serve as the direction
    for (size_t k = 0; k < m->nu; k++)
        d[k] = wish[k];
    if (ct_partition_project(s->embed, t, y) != CT_EVAL_OK)
        return false;
    double *step = CT_NEWN(s->ctx.scratch, double, m->nu + 1);
    for (size_t k = 0; k < m->nu; k++)
        step[k] = amplitude * d[k];
    ct_evaluator_retract(m, y, step);
    if (ct_partition_project(s->embed, t, y) != CT_EVAL_OK)
        return false;
    ct_memory_update(m);
    return meets_rows(m);
}

bool system_random_state(struct system *s, double t, double amplitude,
                         struct ct_initial_state *out)
{
    enum { STEPS = 5 };
    struct ct_evaluator *m = s->machine;
    const size_t n = m->nq + m->nu + 1, nmemory = s->assembly.nmemory;
    double *y = CT_NEWN(s->ctx.scratch, double, n),
           *wish = CT_NEWN(s->ctx.scratch, double, m->nu + 1);
    double *memory = CT_NEWN(s->ctx.scratch, double, nmemory + 1);
    memcpy(memory, m->input + m->at_memory, nmemory * sizeof *memory);
    bool ok = false;
    for (int try = 0; try < 12 && !ok; try++, amplitude *= 0.7) {
        memcpy(m->input + m->at_memory, memory, nmemory * sizeof *memory);
        memcpy(y, s->y, n * sizeof *y);
        for (size_t k = 0; k < m->nu; k++)
            wish[k] = chance();
        ct_evaluator_set(m, t, y);
        ct_switches_start(m, t, y, NULL, NULL);
        ct_evaluator_constraint(m);
        ct_evaluator_dynamics(m);
        ok = ct_partition_choose(s->embed);
        for (int k = 0; k < STEPS && ok; k++)
            ok = wander(s, t, amplitude / STEPS, wish, y);
        for (size_t k = 0; k < m->nu; k++)
            y[m->nq + k] = 2 * chance();
        ok = ok && ct_partition_project(s->embed, t, y) == CT_EVAL_OK && meets_rows(m)
          && (!s->embed->rank || s->embed->kappa < 30);
    }
    s->ctx.nerror = s->ctx.ndiagnostic = 0;
    ct_evaluator_set(m, t, y);
    ct_memory_update(m);
    ct_program_run(&m->result, m->input);
    *out = (struct ct_initial_state){.n = s->assembly.ncoordinate};
    out->q = CT_NEWN(s->ctx.model, double, out->n + 1);
    out->u = CT_NEWN(s->ctx.model, double, out->n + 1);
    for (size_t i = 0; i < out->n; i++) {
        out->q[i] = m->result.out[2 * i];
        out->u[i] = m->result.out[2 * i + 1];
    }
    memcpy(m->input + m->at_memory, memory, nmemory * sizeof *memory);
    return ok;
}

// ---- variants -----------------------------------------------------------------------------------

bool variant_try(struct system *s, const struct ct_formulate_options *o, struct variant *v)
{
    *v = (struct variant){.arena = ct_arena_create()};
    assert_non_null(v->arena);
    v->ctx = (struct ct_ctx){.model = v->arena, .scratch = v->arena};
    if (!ct_formulate(&v->ctx, v->arena, &s->model, o, &v->e, &v->report))
        return false;
    if (!o->without_dynamics)
        ct_formulate_dynamics(&v->e);
    v->m = ct_evaluator_create(v->arena, &s->model, &v->e);
    v->s = ct_partition_create(v->arena, &v->ctx, v->m);
    v->y = CT_NEWN(v->arena, double, v->m->nq + v->m->nu + 1);
    v->result = CT_NEWN(v->arena, double, v->e.nresult + 1);
    return true;
}

void variant_open(struct system *s, const struct ct_formulate_options *o, struct variant *v)
{
    if (variant_try(s, o, v))
        return;
    print_error("%s: cannot be formulated\n", s->name);
    ct_ctx_print(&v->ctx, stderr);
    fail();
}

void variant_close(struct variant *v)
{
    ct_arena_destroy(v->arena);
}

void variant_renew(struct variant *v, double t)
{
    ct_evaluator_set(v->m, t, v->y);
    ct_switches_start(v->m, t, v->y, NULL, NULL);
    ct_evaluator_set(v->m, t, v->y);
    ct_memory_start(v->m);
    ct_evaluator_dynamics(v->m);
    ct_evaluator_constraint(v->m);
}

void variant_set(struct variant *v, const struct ct_initial_state *state, double t)
{
    ct_initial_state_apply(state, v->m, v->y);
    variant_renew(v, t);
}

bool variant_solve(struct variant *v)
{
    struct ct_evaluator *m = v->m;
    ct_evaluator_constraint(m);
    ct_evaluator_dynamics(m);
    if (!ct_partition_choose(v->s) || ct_partition_accelerate(v->s) != CT_EVAL_OK)
        return false;
    memcpy(m->input + m->at_a, v->s->a, m->nu * sizeof(double));
    ct_partition_multipliers(v->s);
    memcpy(m->input + m->at_lam, v->s->lam, m->nrow * sizeof(double));
    ct_program_run(&m->result, m->input);
    memcpy(v->result, m->result.out, v->e.nresult * sizeof(double));
    return true;
}

size_t variant_result(const struct variant *v, const char *name)
{
    for (size_t i = 0; i < v->e.nresult; i++)
        if (!strcmp(v->e.result[i].name, name))
            return i;
    print_error("there is no result '%s'\n", name);
    fail();
    return 0;
}

// ---- trees --------------------------------------------------------------------------------------

struct collecting {
    struct system *s;
    const struct ct_build *b;
    struct tree_list *list;
};

static bool collect(void *data, const bool *is_branch)
{
    struct collecting *c = data;
    struct tree_names t
        = {CT_NEWN(c->s->ctx.model, const char *, c->b->topology->nedge + 1), 0};
    for (size_t i = 0; i < c->b->topology->nedge; i++)
        if (is_branch[i] && c->b->topology->edge[i].kind != CT_EDGE_ARM)
            t.name[t.n++] = c->b->topology->edge[i].name;
    CT_PUSH(c->s->ctx.model, c->list->tree, c->list->n, c->list->cap, t);
    return true;
}

struct tree_list system_trees(struct system *s, bool keep_all, bool rotation)
{
    const struct ct_formulate_options o = {.tree = CT_TREE_JOINTS, .keep_all = keep_all};
    struct ct_equations *e = CT_NEW(s->ctx.model, struct ct_equations);
    struct ct_tree_report report;
    struct tree_list list = {0};
    assert_true(ct_formulate(&s->ctx, s->ctx.model, &s->model, &o, e, &report));
    const struct ct_build *b = e->build;
    bool *forced = CT_NEWN(s->ctx.model, bool, b->topology->nedge + 1);
    bool *banned = CT_NEWN(s->ctx.model, bool, b->topology->nedge + 1);
    for (size_t i = 0; i < b->topology->nedge; i++) {
        const struct ct_edge_info *k = &b->topology->edge[i];
        const bool is_particle = k->kind == CT_EDGE_BODY && s->model.body[k->index].is_particle;
        forced[i] = k->must_be_branch || (rotation && is_particle);
        banned[i] = k->never_branch || (rotation && !k->has_rotation && !is_particle);
        if (banned[i])
            forced[i] = false;
    }
    struct collecting c = {s, b, &list};
    ct_tree_enumerate(s->ctx.model, e->graph, forced, banned, collect, &c);
    return list;
}

struct ct_formulate_options trees_given(const struct tree_names *trans,
                                        const struct tree_names *rot)
{
    return (struct ct_formulate_options){.tree = CT_TREE_GIVEN,
                                         .trans = trans->name,
                                         .ntrans = trans->n,
                                         .rot = rot->name,
                                         .nrot = rot->n};
}
