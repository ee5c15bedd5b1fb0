// The locale of the program changes nothing in what is written: every writer and every printer,
// with a comma as the decimal point and with a point.
#include <cotree/cotree.h>

#include <locale.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static const char model[]
    = "cotree: 1\n"
      "name: locale\n"
      "gravity: [0, -9.81, 0]\n"
      "parameters: {l: 0.75, k: 2.5}\n"
      "bodies:\n"
      "  rod: {mass: 1.25, com: [0, -l, 0], inertia: 0.125, points: {tip: [0.05, -1.5*l, 0]}}\n"
      "joints:\n"
      "  pivot: {type: revolute, from: ground, to: rod, initial: {q: 0.5}, effort: "
      "-k*pivot.q}\n"
      "forces:\n"
      "  push: {type: force, at: rod.tip, value: [0.5, 0, 0]}\n"
      "outputs: [pivot.q, rod.tip.position.x, energy.total]\n"
      "simulation: {duration: 0.5, samples: 6}\n";
static const char driven[]
    = "cotree: 1\n"
      "name: driven\n"
      "parameters: {w: 1.5}\n"
      "bodies: {arm: {mass: 0.5, com: [0.25, 0, 0], inertia: 0.0625}}\n"
      "joints: {j: {type: revolute, from: ground, to: arm, motion: 0.5*sin(w*t)}}\n"
      "outputs: [j.q, j.effort]\n"
      "simulation: {duration: 0.5, samples: 6}\n";
static const char column[] = "cotree: 1\n"
                             "name: column\n"
                             "bodies:\n"
                             "  c: {type: beam, length: 1.5, E: 2.1e11, nu: 0.3, area: 1.5e-4, "
                             "Iy: 2.5e-10, Iz: 2.5e-10,\n"
                             "      density: 7850.5, elements: 4, formulation: foreshortening, "
                             "deformation: [bending-z],\n"
                             "      points: {tip: length}}\n"
                             "joints: {foot: {type: weld, from: ground, to: c}}\n"
                             "forces: {load: {type: force, at: c.tip, value: [-1.5, 0, 0]}}\n"
                             "simulation: {duration: 0.5}\n";

static char folder[] = "/tmp/cotree-locale-XXXXXX";

static void put_file(const char *name, const char *text)
{
    FILE *f = fopen(name, "w");
    assert_non_null(f);
    assert_true(fputs(text, f) >= 0 && fclose(f) == 0);
}

// Lines of times and memory are those of the machine.
static void keep(const char *name, char *text)
{
    static const char *const measured[]
        = {"seconds",     "\"read\"",      "\"generate\"", "\"run\": 0",
           "\"compile\"", "\"integrate\"", "\"write\"",    "\"peak\""};
    assert_non_null(text);
    FILE *f = fopen(name, "w");
    assert_non_null(f);
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
        bool is_kept = true;
        for (size_t i = 0; i < sizeof measured / sizeof *measured; i++)
            is_kept &= !strstr(line, measured[i]);
        if (is_kept)
            fprintf(f, "%s\n", line);
    }
    assert_int_equal(fclose(f), 0);
    ct_free(text);
}

// What a failure says, before it is a failed assertion.
static bool done(struct ct_ctx *ctx, bool ok)
{
    if (!ok)
        ct_ctx_print_diagnostics(ctx, stderr);
    return ok;
}

static void write_runs(struct ct_ctx *ctx)
{
    static const char *const tables[]
        = {"run.csv", "run.csv.gz", "run.json", "run.npz", "run.mat"};
    struct ct_system *sys = ct_system_load(ctx, "../model.yaml", NULL);
    assert_true(done(ctx, sys));
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
        struct ct_sim *sim = ct_sim_create(ctx, sys, NULL);
        struct ct_plot *plot = ct_plot_create(ctx, sys, NULL);
        assert_true(ct_sim_run(
            ctx, sim,
            &(struct ct_sim_results){.path = tables[i], .row = ct_plot_row, .user = plot}));
        assert_true(ct_plot_write(ctx, plot, "plot.svg"));
        assert_true(ct_sim_export(ctx, sim, "c", "exported"));
        keep("summary.txt", ct_sim_summary(sim));
        keep("summary.json", ct_sim_summary_json(sim));
        keep("check.txt", ct_sim_check(sim));
        ct_plot_destroy(plot);
        ct_sim_destroy(sim);
    }
    static const char *const formats[] = {"text", "latex", "html", "c", "json"};
    for (size_t i = 0; i < 5; i++)
        keep(formats[i], ct_system_equations(ctx, sys, i == 3 ? NULL : "all", formats[i]));
    keep("graph.txt", ct_system_graph(ctx, sys, "text"));
    keep("graph.dot", ct_system_graph(ctx, sys, "dot"));
    keep("graph.json", ct_system_graph(ctx, sys, "json"));
    assert_true(ct_system_draw(ctx, sys,
                               &(struct ct_draw_options){.size = sizeof(struct ct_draw_options),
                                                         .path = "draw.svg",
                                                         .bar = stderr}));
    struct ct_accuracy *a = ct_accuracy_create(
        ctx, sys,
        &(struct ct_accuracy_options){.run = {.method = "dopri5", .tolerance = 1e-5}});
    assert_true(done(ctx, a));
    assert_true(ct_accuracy_write(ctx, a, "accuracy.json"));
    assert_true(ct_accuracy_draw(ctx, a, "accuracy_plot.svg"));
    char *text = ct_accuracy_summary(a); // with times in every line
    assert_non_null(text);
    for (const char *comma = text; (comma = strchr(comma, ',')); comma++)
        assert_false(comma[1] >= '0' && comma[1] <= '9');
    ct_free(text);
    ct_accuracy_destroy(a);
    ct_system_destroy(sys);
    assert_true(remove("accuracy.json") == 0 && remove("accuracy_plot.svg") == 0); // times
}

static void write_analyses(struct ct_ctx *ctx)
{
    const struct ct_system_options o = {.for_analysis = true};
    struct ct_system *sys = ct_system_load(ctx, "../model.yaml", &o);
    struct ct_equilibrium *q = ct_equilibrium_create(ctx, sys, NULL);
    struct ct_modes *modes
        = ct_modes_create(ctx, sys, &(struct ct_modes_options){.about = "equilibrium"});
    struct ct_linearization *l
        = ct_linearize(ctx, sys, &(struct ct_linearize_options){.about = "equilibrium"});
    assert_true(done(ctx, q && modes && l));
    assert_true(
        ct_equilibrium_write(ctx, q, "rest.csv") && ct_modes_write(ctx, modes, "modes.csv")
        && ct_modes_write(ctx, modes, "modes.json") && ct_modes_draw(ctx, modes, "modes.svg")
        && ct_linearization_write(ctx, l, "linear.csv")
        && ct_linearization_write(ctx, l, "linear.json"));
    keep("rest.txt", ct_equilibrium_summary(q));
    keep("modes.txt", ct_modes_summary(modes));
    keep("linear.txt", ct_linearization_summary(l));
    ct_linearization_destroy(l);
    ct_modes_destroy(modes);
    ct_equilibrium_destroy(q);
    ct_system_destroy(sys);
    sys = ct_system_load(ctx, "../column.yaml", &o);
    struct ct_buckling *b = ct_buckling_create(
        ctx, sys, &(struct ct_buckling_options){.load = "load", .count = 2});
    assert_true(done(ctx, b));
    assert_true(ct_buckling_write(ctx, b, "buckling.csv")
                && ct_buckling_write_curve(ctx, b, "curve.json", 1));
    keep("buckling.txt", ct_buckling_summary(b));
    ct_buckling_destroy(b);
    ct_system_destroy(sys);
    sys = ct_system_load(ctx, "../driven.yaml", NULL);
    struct ct_sim *sim = ct_sim_create(ctx, sys, NULL);
    assert_true(ct_sim_follow(ctx, sim, &(struct ct_sim_results){.path = "driven.csv"}));
    ct_sim_destroy(sim);
    ct_system_destroy(sys);
}

static void write_studies(struct ct_ctx *ctx)
{
    static const char *const vary[] = {"l=0.5:1.5:5"}, *const take[] = {"m=max(pivot.q)"},
                             *const parts[] = {"1.csv", "2.csv"};
    const char *const results[] = {"study.csv", "study.json", "1.csv", "2.csv"};
    put_file("members.csv", "l,k\n0.5,2.5\n\"750 mm\",1.5\n");
    for (long i = 0; i < 5; i++) {
        const struct ct_study_options o = {.vary = vary,
                                           .nvary = i < 4,
                                           .take = take,
                                           .ntake = 1,
                                           .threads = 1,
                                           .members = i < 4 ? NULL : "members.csv",
                                           .shard = i == 2 ? 1
                                                  : i == 3 ? 2
                                                           : 0,
                                           .shards = i == 2 || i == 3 ? 2 : 0};
        struct ct_study *s = ct_study_create(ctx, "../model.yaml", NULL, &o);
        assert_true(ct_study_run(
            ctx, s, &(struct ct_study_results){.path = i < 4 ? results[i] : "listed.csv"}));
        keep("study.txt", ct_study_summary(s));
        keep("study_summary.json", ct_study_summary_json(s));
        ct_study_destroy(s);
    }
    assert_true(ct_study_merge(ctx, "merged.csv", parts, 2));
    const struct ct_vary_options modes = {.analysis = CT_VARY_MODES, .vary = vary, .nvary = 1};
    assert_true(ct_vary(ctx, "../model.yaml", NULL, &modes, "varied.csv"));
}

static void write_lists(struct ct_ctx *ctx)
{
    static const char wrong[] = "cotree: 1\nbodies: {b: {mass: -1.5}}\n";
    keep("components.txt", ct_components_text());
    keep("methods.txt", ct_methods_text());
    keep("schema.json", ct_schema_text());
    assert_null(ct_system_load_text(ctx, wrong, sizeof wrong - 1, "wrong.yaml", NULL));
    keep("diagnostics.txt", ct_ctx_diagnostics(ctx));
}

static void write_all(const char *where)
{
    struct ct_ctx *ctx = ct_ctx_create();
    assert_int_equal(mkdir(where, 0777), 0);
    assert_int_equal(chdir(where), 0);
    write_runs(ctx);
    write_analyses(ctx);
    write_studies(ctx);
    write_lists(ctx);
    assert_int_equal(chdir(".."), 0);
    ct_ctx_destroy(ctx);
}

static const char *comma_locale(void)
{
    char command[256];
    snprintf(command, sizeof command,
             "localedef -i de_DE -f UTF-8 %s/de_DE.UTF-8 >/dev/null 2>&1", folder);
    if (system(command) == 0)
        setenv("LOCPATH", folder, 1);
    return setlocale(LC_ALL, "de_DE.UTF-8");
}

static void nothing_that_is_written_follows_the_locale(void **state)
{
    (void)state;
    assert_true(mkdtemp(folder) && chdir(folder) == 0);
    put_file("model.yaml", model);
    put_file("driven.yaml", driven);
    put_file("column.yaml", column);
    write_all("point");
    const bool has_comma = comma_locale();
    char number[16] = "";
    if (has_comma) {
        snprintf(number, sizeof number, "%g", 0.5);
        write_all("comma");
        setlocale(LC_ALL, "C");
    }
    const int differs = has_comma ? system("diff -r point comma") : 0;
    char command[64];
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_true(chdir("/") == 0 && system(command) == 0);
    if (!has_comma)
        skip();
    assert_string_equal(number, "0,5");
    assert_int_equal(differs, 0);
}

int main(void)
{
    const struct CMUnitTest tests[]
        = {cmocka_unit_test(nothing_that_is_written_follows_the_locale)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
