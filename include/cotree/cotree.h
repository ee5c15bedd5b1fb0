/*
 * cotree: mechanism -> linear graph -> symbolic equations of motion -> motion.
 *
 *     struct ct_ctx *ctx = ct_ctx_create();
 *     struct ct_system *sys = ct_system_load(ctx, "pendulum.yaml", NULL);
 *     struct ct_sim *sim = ct_sim_create(ctx, sys, &(struct ct_sim_options){.tolerance = 1e-9});
 *     if (ct_sim_run(ctx, sim, &(struct ct_sim_results){.path = "pendulum.csv"}))
 *         ct_sim_print_summary(sim, stdout);
 *     ct_ctx_print_diagnostics(ctx, stderr);
 *     ct_sim_destroy(sim);
 *     ct_system_destroy(sys);
 *     ct_ctx_destroy(ctx);
 *
 * What always holds: a function that fails returns NULL or false and has put at least one diagnostic
 * into the context. Functions that take a NULL system or run fail quietly, so that a chain of calls
 * needs one check at its end. Options are structs in which zero means the default; words in them
 * (methods, formats, trees) are those of the command line. A system does not change once it is loaded
 * and may have any number of runs; all of them belong to one thread at a time.
 */
#ifndef COTREE_COTREE_H
#define COTREE_COTREE_H

#include <cotree/export.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- the context: where diagnostics go ------------------------------------------------------- */

struct ct_ctx;

/** Whose mistake it was, in the numbers of exit statuses. */
enum ct_fault {
    CT_FAULT_NONE = 0,  /* no error so far */
    CT_FAULT_MODEL = 1, /* the model or the run failed */
    CT_FAULT_OPTION = 2 /* an option has a value that cannot be used */
};

/** A new context, or NULL without memory. */
CT_API struct ct_ctx *ct_ctx_create(void);
/** Accepts NULL. Systems and runs do not need the context they were made with any more. */
CT_API void ct_ctx_destroy(struct ct_ctx *ctx);
/** Errors, warnings and notes so far, as FILE:LINE:COLUMN: error: MESSAGE with the source line. */
CT_API void ct_ctx_print_diagnostics(const struct ct_ctx *ctx, FILE *out);
/** The gravest fault among the diagnostics. */
CT_API enum ct_fault ct_ctx_fault(const struct ct_ctx *ctx);

/** The version of the library, as in "0.1.0". */
CT_API const char *ct_version(void);
/** The name of n that is nearest to a misspelt one, or NULL if none is near. */
CT_API const char *ct_did_you_mean(const char *name, const char *const *names, size_t n);

/* ---- systems: a model and its equations ------------------------------------------------------- */

struct ct_system;

struct ct_system_options {
    const char *const *set; /* "NAME=VALUE": values that replace those of parameters */
    size_t nset;
    const char *tree; /* "auto", "joints", "absolute", or a YAML file that names the branches */
    bool keep_all;    /* leave nothing out: planar mechanisms keep their spatial rows */
};

/**
 * Read a model file and derive its equations of motion.
 *
 * options  in   NULL: all defaults
 *
 * Errors   E002, E003 and those of the file, E1xx and E2xx
 * Owner    the caller, until ct_system_destroy
 */
CT_API struct ct_system *ct_system_load(struct ct_ctx *ctx, const char *path,
                                        const struct ct_system_options *options);
/** Accepts NULL. Its runs must be destroyed before. */
CT_API void ct_system_destroy(struct ct_system *sys);

/** Name of the model; columns of results without the first one, `t`. */
CT_API const char *ct_system_name(const struct ct_system *sys);
CT_API size_t ct_system_column_count(const struct ct_system *sys);
CT_API const char *ct_system_column(const struct ct_system *sys, size_t i);

/** The linear graph and its trees. format: "text", "dot" or "json". Errors: E003. */
CT_API bool ct_system_print_graph(struct ct_ctx *ctx, struct ct_system *sys, const char *format,
                                  FILE *out);

/**
 * The derivation of the equations of motion.
 *
 * stages  in   "terminal,graph,tree,cutset,circuit,reduced", some of them, or "all"; NULL: tree,reduced
 * format  in   "text", "latex", "html", "c" or "json"; NULL: text. C has the reduced equations only.
 *
 * Errors: E002 for the stream, E003.
 */
CT_API bool ct_system_print_equations(struct ct_ctx *ctx, struct ct_system *sys,
                                      const char *stages, const char *format, FILE *out);

/* ---- runs -------------------------------------------------------------------------------------- */

struct ct_sim;

/** Zero: what the model's `simulation` says. */
struct ct_sim_options {
    const char *method; /* a name that ct_methods_print lists, or "auto" */
    double tolerance;   /* wanted relative accuracy of the outputs */
    double absolute; /* of quantities near zero; tolerance / 100 when only the other is given */
    double step;     /* fixed step [s] */
    double until;    /* end time [s]; the spacing of samples stays that of the model */
    long samples;    /* number of samples, both ends included */
    bool verify; /* after the run another one, and from both the global error of each output */
    const char
        *backend; /* what evaluates the equations: "auto", "native" or "tape"; same bits */
};

/** Where results go. All of it may be zero. */
struct ct_sim_results {
    const char *path; /* FILE.csv or FILE.json; "-" is standard output as CSV; NULL: no file */
    FILE *progress;   /* a bar is shown there if it is a terminal */
    /** Called for each sample; return false to stop the run there, which is no failure. */
    bool (*row)(void *user, double t, const double *value, size_t n);
    void *user;
};

/**
 * A run of a system, assembled at t = 0 and ready to go.
 *
 * Errors   E003 for options; E4xx when the mechanism cannot be assembled
 * Owner    the caller, until ct_sim_destroy
 */
CT_API struct ct_sim *ct_sim_create(struct ct_ctx *ctx, struct ct_system *sys,
                                    const struct ct_sim_options *options);
/** Accepts NULL. */
CT_API void ct_sim_destroy(struct ct_sim *sim);

/**
 * Integrate to the end, once per run. results may be NULL.
 *
 * The file appears under its name when it is complete. When the run fails, the rows so far stay in
 * PATH.partial.
 *
 * Errors: E002 for the file, E003 when there is no end time, E3xx and E4xx with the time reached.
 */
CT_API bool ct_sim_run(struct ct_ctx *ctx, struct ct_sim *sim,
                       const struct ct_sim_results *results);

/** Time of the last sample, and the value of a column there; NaN for a column that does not exist. */
CT_API double ct_sim_time(const struct ct_sim *sim);
CT_API double ct_sim_value(const struct ct_sim *sim, const char *column);
/** The global error of a column against its largest value, estimated by a run with `verify`; NaN where it is not known. */
CT_API double ct_sim_error(const struct ct_sim *sim, const char *column);

/** What the run did and how well it kept energy and constraints, for people. */
CT_API void ct_sim_print_summary(const struct ct_sim *sim, FILE *out);
/** The same for programs: a JSON object. Errors: E002. */
CT_API bool ct_sim_write_summary(struct ct_ctx *ctx, const struct ct_sim *sim,
                                 const char *path);
/** What the system is: freedoms, trees and how they were chosen, redundant constraints, costs. */
CT_API void ct_sim_print_check(const struct ct_sim *sim, FILE *out);
/**
 * The equations of motion as source code in a folder, which is made if need be. Before the run.
 *
 * format: "c" or NULL: NAME.h, NAME.c and NAME_test.c, which compares with values computed here; NAME is
 * that of the model. Errors: E002, E003.
 */
CT_API bool ct_sim_export(struct ct_ctx *ctx, struct ct_sim *sim, const char *format,
                          const char *folder);

/* ---- speed against error ------------------------------------------------------------------------- */

struct ct_accuracy;

/** Zero: the default. */
struct ct_accuracy_options {
    /** Of all runs. method: names separated by commas, NULL or "auto" for the usual ones; tolerance and
     *  step, where they are given, are the only ones tried. */
    struct ct_sim_options run;
    double error;          /* wanted; 1e-6 */
    const char *reference; /* CSV as simulate writes it; NULL: found by tight runs that agree */
    FILE *progress;        /* a bar is shown there if it is a terminal */
};

/**
 * Run a system with methods x tolerances and compare each run with a converged reference.
 *
 * The error of a run is the largest over outputs and samples of |difference to the reference| / largest
 * |reference output|. Runs are timed three times; methods get a share of about a minute each.
 *
 * Errors   E003 for options; E134, E135 for the reference; E309 when none is found; those of runs
 * Owner    the caller, until ct_accuracy_destroy
 */
CT_API struct ct_accuracy *ct_accuracy_create(struct ct_ctx *ctx, struct ct_system *sys,
                                              const struct ct_accuracy_options *options);
/** Accepts NULL. */
CT_API void ct_accuracy_destroy(struct ct_accuracy *a);

/** The table; FILE.json: an object of columns, else CSV; NULL or "-": CSV on standard output. Errors: E002. */
CT_API bool ct_accuracy_write(struct ct_ctx *ctx, const struct ct_accuracy *a,
                              const char *path);
/** The work-precision plot as SVG. Errors: E002. */
CT_API bool ct_accuracy_draw(struct ct_ctx *ctx, const struct ct_accuracy *a, const char *path);
/** How good the reference is, and the cheapest setting that meets the wanted error, for people. */
CT_API void ct_accuracy_print_summary(const struct ct_accuracy *a, FILE *out);

/* ---- what there is ------------------------------------------------------------------------------- */

/** Component types with their terminal equations and keys. */
CT_API void ct_components_print(FILE *out);
/** Methods of integration. */
CT_API void ct_methods_print(FILE *out);
/** JSON Schema (draft 2020-12) of the model file. */
CT_API void ct_schema_print(FILE *out);

#ifdef __cplusplus
}
#endif

#endif
