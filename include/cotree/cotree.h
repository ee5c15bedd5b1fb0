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
 * or, step by step, as a simulation of a controller does:
 *
 *     struct ct_data *d = ct_data_create(ctx, sys, NULL);
 *     ct_data_set_one(ctx, d, CT_INPUT, "tau", 0.1);
 *     ct_data_step(ctx, d, 1e-3);
 *     printf("%g\n", ct_data_value(d, CT_COORDINATE, 0));
 *     ct_data_destroy(d);
 *
 * What always holds: a function that fails returns NULL or false and has put at least one diagnostic
 * into the context. Functions that take a NULL context, system, run or state fail quietly (numbers are
 * NaN, counts 0), so that a chain of calls needs one check at its end. Options are structs in which zero
 * means the default; words in them (methods, formats, trees) are those of the command line. They begin
 * with their size, 0 for that of this header, so that programs run with libraries whose structs have
 * grown. A system does not change once it is loaded: any number of threads may use it, each with a context,
 * runs and states of its own. A system must live as long as what was made from it. The locale of the
 * program has no effect on what is read or written.
 */
#ifndef COTREE_COTREE_H
#define COTREE_COTREE_H

#include <cotree/diagnostic.h>
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
/** The same as a text, which ct_free frees. */
CT_API char *ct_ctx_diagnostics(const struct ct_ctx *ctx);
/** The gravest fault among the diagnostics. */
CT_API enum ct_fault ct_ctx_fault(const struct ct_ctx *ctx);

/**
 * Diagnostics one by one: errors and warnings in the order in which they came, notes with what they belong to. False
 * beyond the last one.
 */
CT_API size_t ct_ctx_count(const struct ct_ctx *ctx);
CT_API bool ct_ctx_diagnostic(struct ct_ctx *ctx, size_t i, struct ct_diagnostic *diagnostic);
/** Forget all diagnostics, and that a cancellation was asked for. */
CT_API void ct_ctx_clear(struct ct_ctx *ctx);
/** Call back for each error and warning before the function that made it returns; NULL: no more. Not from within the callback. */
CT_API void ct_ctx_on_diagnostic(struct ct_ctx *ctx,
                                 void (*callback)(void *user,
                                                  const struct ct_diagnostic *diagnostic),
                                 void *user);
/**
 * From any thread or signal handler: all work with this context ends at its next accepted step, or between parts of an
 * analysis, with E005, and so does what begins after it, until ct_ctx_clear. Rows that are complete stay in PATH.partial.
 */
CT_API void ct_ctx_cancel(struct ct_ctx *ctx);
/** Has something been cancelled? */
CT_API bool ct_ctx_was_interrupted(const struct ct_ctx *ctx);

/** Free a text that the library has made. Accepts NULL. */
CT_API void ct_free(void *text);

/** The version of this header; of the library, as in "0.1.0". */
#define CT_VERSION_MAJOR 0
#define CT_VERSION_MINOR 1
#define CT_VERSION_PATCH 0
CT_API const char *ct_version(void);
/** The name of n that is nearest to a misspelt one, or NULL if none is near. */
CT_API const char *ct_did_you_mean(const char *name, const char *const *names, size_t n);

/* ---- files ------------------------------------------------------------------------------------- */

enum ct_contents {
    CT_CONTENTS_TABLE,   /* results: .csv, .csv.gz, .json, .npz (NumPy), .mat (version 4) */
    CT_CONTENTS_SUMMARY, /* .json */
    CT_CONTENTS_PLOT     /* .svg */
};
/** Is there a format for the suffix of path? Without a suffix it is the first one. Errors: E007. */
CT_API bool ct_can_write(struct ct_ctx *ctx, enum ct_contents contents, const char *path);

/**
 * A text file that appears under its name when it is complete, for what is printed to streams.
 *
 * path    in    NULL or "-": standard output
 *
 * Errors  E002; E006 while another process is writing it
 * Owner   the caller, until ct_output_close
 */
CT_API struct ct_output *ct_output_open(struct ct_ctx *ctx, const char *path);
CT_API FILE *ct_output_stream(const struct ct_output *o);
/** ok: what was written is whole; else nothing of it stays. True if it is there. Accepts NULL. Errors: E002. */
CT_API bool ct_output_close(struct ct_ctx *ctx, struct ct_output *o, bool ok);

/**
 * The text of a model file for a robot description (URDF): links are bodies, joints joints, mimic a gear, visuals shapes.
 * What is not used is a warning (E574) with its line.
 *
 * model   in    the file that the text is for, which decides how it names meshes; NULL: in full
 *
 * Errors  E571 to E573, E002
 * Owner   the caller, until ct_free
 */
CT_API char *ct_import_urdf(struct ct_ctx *ctx, const char *path, const char *model);

/* ---- systems: a model and its equations ------------------------------------------------------- */

struct ct_system;

/** Columns beside the model's outputs. */
enum ct_columns_more {
    CT_COLUMNS_OF_MODEL = 0,
    CT_COLUMNS_COORDINATES, /* if it lists none: coordinates, speeds and accelerations of all joints */
    CT_COLUMNS_EFFORTS /* efforts of motions, forces and torques of all joints */
};

struct ct_system_options {
    size_t size;            /* 0, or sizeof (struct ct_system_options) */
    const char *const *set; /* "NAME=VALUE": values that replace those of parameters */
    size_t nset;
    const char *tree; /* "auto", "joints", "absolute", or a YAML file that names the branches */
    bool keep_all;    /* leave nothing out: planar mechanisms keep their spatial rows */
    enum ct_columns_more columns;
    bool
        for_analysis; /* modes, equilibria, buckling, no runs: beams keep all that their sections allow, also what the
                         scene does not excite, and large systems are made in less time */
    long beam_elements; /* > 0: of every beam, equally long, whatever the file says */
    const char *
        beam_formulation; /* of every beam: "linear", "foreshortening" ...; NULL: as in the file */
    const char *
        input; /* a CSV file that plays inputs in all runs, columns by name and `t`; NULL: they are constant */
    bool hold_input; /* a row of it counts from its t on; else it is linear between rows */
    const char *const *output; /* "NAME=EXPRESSION": outputs behind those of the file */
    size_t noutput;
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
/**
 * The same for n bytes of text. name stands for the file in diagnostics; tables are sought beside it. NULL: "model".
 */
CT_API struct ct_system *ct_system_load_text(struct ct_ctx *ctx, const char *text, size_t n,
                                             const char *name,
                                             const struct ct_system_options *options);
/** Accepts NULL. Its runs must be destroyed before. */
CT_API void ct_system_destroy(struct ct_system *sys);

/** Name of the model; columns of results without the first one, `t`. */
CT_API const char *ct_system_name(const struct ct_system *sys);
CT_API size_t ct_system_column_count(const struct ct_system *sys);
CT_API const char *ct_system_column(const struct ct_system *sys, size_t i);

/**
 * The cheapest pairs of trees that were weighed, ten at most, and why one was chosen. format: "text" or "json".
 * Number N is chosen by the option `tree` "N". Errors: E003.
 */
CT_API bool ct_system_print_trees(struct ct_ctx *ctx, struct ct_system *sys, const char *format,
                                  FILE *out);

/** The linear graph and its trees. format: "text", "dot" or "json". Errors: E003. */
CT_API bool ct_system_print_graph(struct ct_ctx *ctx, struct ct_system *sys, const char *format,
                                  FILE *out);

/**
 * The derivation of the equations of motion.
 *
 * stages  in   "terminal,graph,tree,cutset,circuit,reduced", some of them, or "all"; NULL: tree,reduced
 * format  in   "text", "latex", "html", "c" or "json"; NULL: text. C has the reduced equations only.
 *
 * Systems of more than 100 speeds are in recursive form but in C (docs/equations.md).
 *
 * Errors: E002 for the stream, E003.
 */
CT_API bool ct_system_print_equations(struct ct_ctx *ctx, struct ct_system *sys,
                                      const char *stages, const char *format, FILE *out);

/** The same for reading: of such systems lists in text, LaTeX and HTML show their first and last lines. */
CT_API bool ct_system_summarize_equations(struct ct_ctx *ctx, struct ct_system *sys,
                                          const char *stages, const char *format, FILE *out);

/** The same as texts, which ct_free frees; NULL where they fail. */
CT_API char *ct_system_graph(struct ct_ctx *ctx, struct ct_system *sys, const char *format);
CT_API char *ct_system_equations(struct ct_ctx *ctx, struct ct_system *sys, const char *stages,
                                 const char *format);

/** What a system has names for. */
enum ct_kind {
    CT_PARAMETER,
    CT_INPUT,      /* set from outside, held in between */
    CT_COORDINATE, /* q: of the chosen trees, so others for other trees */
    CT_SPEED,      /* u; q' = u but for rotations with quaternions */
    CT_MULTIPLIER, /* lambda, one for each constraint */
    CT_STATE,      /* of first-order equations of the model's own */
    CT_OUTPUT,     /* columns of results, without t */
    CT_FRAME,      /* "ground", BODY or BODY.POINT */
    CT_COMPONENT   /* bodies, joints, forces */
};

struct ct_item {
    const char *name;    /* belongs to the system, as the other texts */
    const char *unit;    /* "rad", "N*m", "" for a pure number; NULL: not known */
    const char *meaning; /* a few words */
    double
        value; /* default of a parameter or input, start of a coordinate, speed or output; else NaN */
    size_t line, column; /* where the file says it, from 1; 0: nowhere */
};

CT_API size_t ct_system_count(const struct ct_system *sys, enum ct_kind kind);
/** False beyond the last one. */
CT_API bool ct_system_item(const struct ct_system *sys, enum ct_kind kind, size_t i,
                           struct ct_item *item);
/** The number of a name; -1: there is none. */
CT_API long ct_system_find(const struct ct_system *sys, enum ct_kind kind, const char *name);

/* ---- runs -------------------------------------------------------------------------------------- */

struct ct_sim;

/** Zero: what the model's `simulation` says. */
struct ct_sim_options {
    size_t size;        /* 0, or sizeof (struct ct_sim_options) */
    const char *method; /* a name that ct_methods_print lists, or "auto" */
    double tolerance;   /* wanted relative accuracy of the outputs */
    double absolute; /* of quantities near zero; tolerance / 100 when only the other is given */
    double step;     /* fixed step [s] */
    double until;    /* end time [s]; the spacing of samples stays that of the model */
    long samples;    /* number of samples, both ends included */
    bool verify; /* after the run another one, and from both the global error of each output */
    const char *
        backend; /* what evaluates the equations: "auto", "native" or "tape"; same to round-off */
    const char *solver; /* what finds the accelerations of closed loops: "auto", "unrolled",
                           "one-system", "sparse" or "dense"; not of studies */
};

/** Where results go. All of it may be zero. */
struct ct_sim_results {
    size_t size; /* 0, or sizeof (struct ct_sim_results) */
    const char
        *path; /* a table, see ct_contents; "-" is standard output as CSV; NULL: no file */
    FILE *bar; /* progress is shown there if it is a terminal */
    /** Called at each accepted step; return false to stop the run there, which is no failure. */
    bool (*progress)(void *user, double t, double end);
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

/**
 * The samples of a run whose freedoms are all driven, without integration: kinematics and inverse dynamics. Otherwise as
 * ct_sim_run.
 *
 * Errors: as there; E411 when a freedom has no driver.
 */
CT_API bool ct_sim_follow(struct ct_ctx *ctx, struct ct_sim *sim,
                          const struct ct_sim_results *results);

/** Time of the last sample, and the value of a column there; NaN for a column that does not exist. */
CT_API double ct_sim_time(const struct ct_sim *sim);
CT_API double ct_sim_value(const struct ct_sim *sim, const char *column);
/** The global error of a column against its largest value, estimated by a run with `verify`; NaN where it is not known. */
CT_API double ct_sim_error(const struct ct_sim *sim, const char *column);

/** The texts of ct_sim_print_summary and ct_sim_print_check, and that of ct_sim_write_summary; ct_free frees them. */
CT_API char *ct_sim_summary(const struct ct_sim *sim);
CT_API char *ct_sim_check(const struct ct_sim *sim);
CT_API char *ct_sim_summary_json(const struct ct_sim *sim);
/** What the run did and how well it kept energy and constraints, for people. */
CT_API void ct_sim_print_summary(const struct ct_sim *sim, FILE *out);
/** The same for programs: a JSON object. Errors: E002. */
CT_API bool ct_sim_write_summary(struct ct_ctx *ctx, const struct ct_sim *sim,
                                 const char *path);
/** What the system is: freedoms, trees and how they were chosen, redundant constraints, costs. */
CT_API void ct_sim_print_check(const struct ct_sim *sim, FILE *out);
/**
 * Its loops, before the run: what closes each, the rank of its constraints, which of them are redundant and what they
 * leave open, how near it is to a singular configuration, and which freedoms take the redundancy away.
 *
 * out      in  for people; NULL: no text
 * summary  in  path of a file as that of ct_sim_write_summary, with the loops for programs; NULL: no file
 *
 * Errors: E002.
 */
CT_API bool ct_sim_print_loops(struct ct_ctx *ctx, struct ct_sim *sim, FILE *out,
                               const char *summary);
/**
 * The model as source code in a folder, which is made if need be, or as an FMU. Before the run.
 *
 * format: "c" or NULL: NAME.h, NAME.c, NAME_test.c, which compares with values computed here, and NAME.json; NAME is
 * that of the model. "fmu2", "fmu3": one file, `place`. Errors: E002, E003, E405, E560. Warning: E561 without a compiler.
 */
CT_API bool ct_sim_export(struct ct_ctx *ctx, struct ct_sim *sim, const char *format,
                          const char *place);
/** The same, with M, Q, J, gam and phi, v for 4 or 8 inputs side by side, too; 1 or 0: without. */
CT_API bool ct_sim_export_lanes(struct ct_ctx *ctx, struct ct_sim *sim, const char *format,
                                const char *place, long lanes);

/* ---- one state of a system, step by step ------------------------------------------------------------ */

/**
 * A state: time, coordinates q, speeds u, inputs, parameters, and all that follows from them:
 *
 *     M u' = Q + J' lambda,    J u' + gamma = 0,    phi = 0
 *
 * It belongs to one thread at a time. Nothing allocates memory once each call has been made: get, value, set, step.
 */
struct ct_data;

/** Quantities at the state; nu speeds, nq coordinates, m constraints. Matrices row by row, a vector has one column. */
enum ct_quantity {
    CT_Q_M,            /* nu x nu, mass matrix */
    CT_Q_FORCE,        /* nu, Q: applied forces less what depends on speeds */
    CT_Q_J,            /* m x nu */
    CT_Q_GAMMA,        /* m */
    CT_Q_PHI,          /* m: how far loops are open */
    CT_Q_ACCELERATION, /* nu, u' */
    CT_Q_MULTIPLIERS,  /* m, of least norm where constraints are redundant */
    CT_Q_OUTPUTS,      /* as CT_OUTPUT */
    CT_Q_ENERGY, /* 5: kinetic, potential, strain, work put in, total = kinetic + potential + strain - work */
    CT_Q_COORDINATES, /* nq */
    CT_Q_SPEEDS,      /* nu */
    CT_Q_RATE,        /* nq, q' */
    CT_Q_PHI_RATE,    /* m, d phi/dt = J u + the part by time */
    CT_Q_STATES,      /* as CT_STATE */
    CT_Q_STATE_RATES  /* their rates */
};

/**
 * A state at t = 0, assembled as a run starts. Of the options `method`, `tolerance`, `absolute`, `step`, `backend` and `solver` count;
 * method "auto" is "dopri5", or what the model says. Stiff systems want "radau5". options may be NULL.
 *
 * Errors   E003 for options; E4xx when the mechanism cannot be assembled
 * Owner    the caller, until ct_data_destroy; the system must live as long
 */
CT_API struct ct_data *ct_data_create(struct ct_ctx *ctx, const struct ct_system *sys,
                                      const struct ct_sim_options *options);
/** Another one in the same state, with the same values. */
CT_API struct ct_data *ct_data_clone(struct ct_ctx *ctx, const struct ct_data *data);
/** Accepts NULL. */
CT_API void ct_data_destroy(struct ct_data *data);

/** The start again, with parameters and inputs as they are now. Errors: E4xx, and the state is not changed. */
CT_API bool ct_data_reset(struct ct_ctx *ctx, struct ct_data *data);
/**
 * All n values of a kind in its order: parameters, inputs, coordinates, speeds. What parameters are derived from others follows; one whose
 * value differs from the one it has is independent from then on. Nothing is assembled.
 *
 * Errors   E500 for a wrong number or a value that is not finite; E501 for a kind that cannot be set; E502 for a parameter whose value
 *          has decided about the equations. The state is not changed then.
 */
CT_API bool ct_data_set(struct ct_ctx *ctx, struct ct_data *data, enum ct_kind kind,
                        const double *value, size_t n);
/** One of them. Errors: the same; E503 for a name that there is not. */
CT_API bool ct_data_set_one(struct ct_ctx *ctx, struct ct_data *data, enum ct_kind kind,
                            const char *name, double value);
CT_API bool ct_data_set_time(struct ct_ctx *ctx, struct ct_data *data, double t);
/** The nearest coordinates and speeds that meet the constraints. Errors: E504 names those that cannot be met. */
CT_API bool ct_data_assemble(struct ct_ctx *ctx, struct ct_data *data);

/** Computed on demand, valid until the next set or step. NULL where that fails. Errors: E405. rows, columns may be NULL. */
CT_API const double *ct_data_get(struct ct_ctx *ctx, struct ct_data *data,
                                 enum ct_quantity quantity, size_t *rows, size_t *columns);
/** A parameter, input, coordinate, speed, multiplier or output; NaN where there is none, or it cannot be computed. */
CT_API double ct_data_value(const struct ct_data *data, enum ct_kind kind, size_t i);
CT_API double ct_data_time(const struct ct_data *data);
/**
 * To t + dt exactly, within the tolerance, events on the way, inputs held. A state that is off the constraints is assembled before.
 *
 * Errors   E3xx, E4xx, E504; the state is then where it got to. E500 unless dt >= 0.
 */
CT_API bool ct_data_step(struct ct_ctx *ctx, struct ct_data *data, double dt);
/**
 * Efforts (nu, out) that give the accelerations u' (nu): M u' - Q in open systems. In loops those of the joints that have an effort in
 * the model, of all joints if none has, in the sense of least squares and of least size; others are 0. A warning says where they are
 * not unique. Errors: E405; E505 where they do not give these accelerations.
 */
CT_API bool ct_data_inverse(struct ct_ctx *ctx, struct ct_data *data,
                            const double *acceleration, double *effort);
/** Axes R (row by row: R v is in ground axes for v in axes of the frame) and origin p [m] of a frame. Errors: E500. */
CT_API bool ct_data_pose(struct ct_ctx *ctx, struct ct_data *data, size_t frame, double R[9],
                         double p[3]);

/* ---- speed against error ------------------------------------------------------------------------- */

struct ct_accuracy;

/** Zero: the default. */
struct ct_accuracy_options {
    size_t size; /* 0, or sizeof (struct ct_accuracy_options) */
    /** Of all runs. method: names separated by commas, NULL or "auto" for the usual ones; tolerance and
     *  step, where they are given, are the only ones tried. */
    struct ct_sim_options run;
    double error; /* wanted; 1e-6 */
    /** Systems to run, the same model with other beams each; NULL: the system itself. It is the reference then. */
    const struct ct_accuracy_variant {
        struct ct_system *system;
        long elements;           /* for the table; 0: none */
        const char *formulation; /* NULL: none */
    } * variant;
    size_t nvariant;
    const char *reference; /* CSV as simulate writes it; NULL: found by tight runs that agree */
    int per_decade; /* tolerances, or steps from run.step on, in a power of ten, at most 10; 0: powers of ten, the other tolerances begin at 1e-2 */
    FILE *bar;      /* progress is shown there if it is a terminal */
};

/**
 * Run a system with methods x tolerances and compare each run with a converged reference.
 *
 * The error of a run is the largest over outputs and samples of |difference to the reference| / largest
 * |reference output|. Runs are timed three times in place, short ones up to 101 times; methods get a share of about a minute each.
 *
 * Errors   E003 for options; E134, E135 for the reference; E309 when none is found; those of runs
 * Owner    the caller, until ct_accuracy_destroy
 */
CT_API struct ct_accuracy *ct_accuracy_create(struct ct_ctx *ctx, struct ct_system *sys,
                                              const struct ct_accuracy_options *options);
/** Accepts NULL. */
CT_API void ct_accuracy_destroy(struct ct_accuracy *a);

/** The table (ct_contents); NULL or "-": CSV on standard output. Errors: E002. */
CT_API bool ct_accuracy_write(struct ct_ctx *ctx, const struct ct_accuracy *a,
                              const char *path);
/** The work-precision plot as SVG. Errors: E002. */
CT_API bool ct_accuracy_draw(struct ct_ctx *ctx, const struct ct_accuracy *a, const char *path);
/** How good the reference is, and the cheapest setting that meets the wanted error, for people. */
CT_API void ct_accuracy_print_summary(const struct ct_accuracy *a, FILE *out);
/** The same as a text, which ct_free frees. */
CT_API char *ct_accuracy_summary(const struct ct_accuracy *a);

/* ---- parameter studies ---------------------------------------------------------------------------- */

struct ct_study;

/** Zero: the default. */
struct ct_study_options {
    size_t size;               /* 0, or sizeof (struct ct_study_options) */
    struct ct_sim_options run; /* of all members */
    /** "NAME=FROM:TO:N" each: a grid whose last axis runs fastest. With sample also "NAME=FROM:TO" (uniform) and
     *  "NAME=normal:MEAN:DEVIATION"; N is of no use then. */
    const char *const *vary;
    size_t nvary;
    long sample;             /* > 0: so many random members instead of the grid */
    unsigned long long seed; /* of the random numbers: same seed, same members */
    long threads;            /* at most; 0: all cores. One without OpenMP. */
    long lanes; /* members side by side in a core: 1, 4, or 8; 0: 4 where possible */
    const char
        *members; /* a CSV file of members instead of `vary`: its columns are parameters */
    /** Of so many shards this one, from 1: every shards-th member from it on, with the rows and run numbers that it has in
     *  the whole sweep. 0: all of it. */
    long shard, shards;
    /** "NAME=FUNCTION(EXPRESSION)" each: a column behind the outputs, of what the expression, one of outputs, does over the
     *  run: max, min, mean, rms, final, or time [s], when it first rises through zero (NaN: it does not). */
    const char *const *take;
    size_t ntake;
    const char
        *text; /* ntext bytes of a model instead of the file at path, which names it then */
    size_t ntext;
};

/** Where rows go. All of it may be zero. */
struct ct_study_results {
    size_t size; /* 0, or sizeof (struct ct_study_results) */
    const char
        *path;   /* a table, see ct_contents; "-" is standard output as CSV; NULL: no file */
    bool resume; /* go on with the rows of an interrupted sweep, which are in PATH.partial */
    FILE *bar;   /* progress is shown there if it is a terminal */
    /** Called after each member, one at a time but from any thread: so many of all are over. Return false to stop. */
    bool (*progress)(void *user, double done, double all);
    /** Called for each member in order, one at a time but from any thread: run from 1, what varies, the outputs at the
     *  end time, or value NULL and why it failed. Return false to stop, which is no failure. */
    bool (*row)(void *user, long run, const double *varied, const double *value,
                const char *message);
    void *user;
};

/**
 * Read a model and derive its equations once, for all members of a study.
 *
 * What a member gives depends neither on threads nor on other members. Where the value of a parameter decides about the
 * equations (whether a mechanism is planar), members that vary it are derived one by one.
 *
 * system  in   NULL: all defaults. What varies replaces values that are set here.
 *
 * Errors   those of ct_system_load and of the options of runs; E003 for what varies
 * Owner    the caller, until ct_study_destroy
 */
CT_API struct ct_study *ct_study_create(struct ct_ctx *ctx, const char *path,
                                        const struct ct_system_options *system,
                                        const struct ct_study_options *options);
/** Accepts NULL. */
CT_API void ct_study_destroy(struct ct_study *study);
/**
 * Run all members, once per sweep. results may be NULL.
 *
 * A member that fails is a row; the sweep fails when rows cannot be written. The file appears under its name when
 * it is complete; until then rows are in PATH.partial, in order, and what they depend on in PATH.partial.settings. With
 * `resume` the latter stays as PATH.settings.
 *
 * Errors: E002 for the file, E003 when it cannot be resumed, as when settings or the model are others.
 */
CT_API bool ct_study_run(struct ct_ctx *ctx, struct ct_study *study,
                         const struct ct_study_results *results);
/** Members in all, and of those that are over, the failed ones. */
CT_API long ct_study_count(const struct ct_study *study);
CT_API long ct_study_failed(const struct ct_study *study);
/** Columns of rows: `run`, what varies, then outputs at the end time. */
CT_API size_t ct_study_column_count(const struct ct_study *study);
CT_API const char *ct_study_column(const struct ct_study *study, size_t i);
/** What was done and which members failed, for people. */
CT_API void ct_study_print_summary(const struct ct_study *study, FILE *out);
/** The same as a text, which ct_free frees. */
CT_API char *ct_study_summary(const struct ct_study *study);
/** The same for programs: a JSON object. Errors: E002. */
CT_API bool ct_study_write_summary(struct ct_ctx *ctx, const struct ct_study *study,
                                   const char *path);
CT_API char *ct_study_summary_json(const struct ct_study *study);

/**
 * Join the shards of a sweep, in any order, to the file that the whole sweep would have written, byte by byte.
 *
 * path  in   FILE.csv; NULL or "-": standard output
 * part  in   (n) the files of all shards; beside each is PART.settings
 *
 * Nothing is written where it fails. Errors: E002, E003, E006; E580 to E582.
 */
CT_API bool ct_study_merge(struct ct_ctx *ctx, const char *path, const char *const *part,
                           size_t n);

/* ---- analyses about a configuration ------------------------------------------------------------------ */

struct ct_equilibrium;

/** Zero: the default. */
struct ct_equilibrium_options {
    size_t size; /* 0, or sizeof (struct ct_equilibrium_options) */
    /** Motions stand still where they are at t = 0. Else those with a constant rate that turn the system as a whole go
     *  on, and the equilibrium is one in the turning frame; others stand still in any case. */
    bool hold_drivers;
};

/**
 * The equilibrium that a system comes to from its assembled start, without inertia: at t = 0, speeds zero.
 *
 * Errors   E401, E405, E410; those of assembly
 * Owner    the caller, until ct_equilibrium_destroy
 */
CT_API struct ct_equilibrium *
ct_equilibrium_create(struct ct_ctx *ctx, struct ct_system *sys,
                      const struct ct_equilibrium_options *options);
/** Accepts NULL. */
CT_API void ct_equilibrium_destroy(struct ct_equilibrium *q);
/** Value of a column; NaN for one that does not exist. */
CT_API double ct_equilibrium_value(const struct ct_equilibrium *q, const char *column);
/** Does no small motion about it grow? */
CT_API bool ct_equilibrium_is_stable(const struct ct_equilibrium *q);
/** One row of outputs, t = 0, as a table (ct_contents); NULL or "-": standard output. Errors: E002. */
CT_API bool ct_equilibrium_write(struct ct_ctx *ctx, const struct ct_equilibrium *q,
                                 const char *path);
/** How good it is and whether it is stable, for people. */
CT_API void ct_equilibrium_print_summary(const struct ct_equilibrium *q, FILE *out);
/** The same as a text, which ct_free frees. */
CT_API char *ct_equilibrium_summary(const struct ct_equilibrium *q);

struct ct_modes;

/** Zero: the default. */
struct ct_modes_options {
    size_t size;       /* 0, or sizeof (struct ct_modes_options) */
    const char *about; /* "initial" (NULL), "equilibrium", or a time [s] of the motion */
    long count;        /* of rows; 10 */
    bool hold_drivers; /* as for equilibria */
    struct ct_sim_options run; /* of the motion up to a time */
};

/** A natural motion exp(s t): a pair of complex eigenvalues, or a real one. */
struct ct_mode_info {
    double frequency_hz; /* |s| / (2 pi) */
    double omega;        /* |s| [rad/s] */
    double damping;      /* -Re(s) / |s|; -1: grows without oscillating; 0 where s = 0 */
    double re, im;       /* s [1/s], im >= 0 */
};

/**
 * Natural motions of a system linearised about a configuration.
 *
 * Errors   E003 for options; E401, E405, E410; those of assembly and of runs
 * Owner    the caller, until ct_modes_destroy
 */
CT_API struct ct_modes *ct_modes_create(struct ct_ctx *ctx, struct ct_system *sys,
                                        const struct ct_modes_options *options);
/** Accepts NULL. */
CT_API void ct_modes_destroy(struct ct_modes *modes);
/** Modes by |s|, as many as asked for or as there are; mode i, or all zeros. */
CT_API size_t ct_modes_count(const struct ct_modes *modes);
CT_API struct ct_mode_info ct_modes_info(const struct ct_modes *modes, size_t i);
/** Entry of a mode's shape: how the coordinate of that name moves; the largest entry is 1. False: no such name. */
CT_API bool ct_modes_shape(const struct ct_modes *modes, size_t i, const char *coordinate,
                           double *re, double *im);
/** The table (ct_contents), but for CSV with shapes; NULL or "-": standard output. Errors: E002. */
CT_API bool ct_modes_write(struct ct_ctx *ctx, const struct ct_modes *modes, const char *path);
/** The shapes of the first modes as SVG: frames and the lines between them, at rest and displaced. Errors: E002. */
CT_API bool ct_modes_draw(struct ct_ctx *ctx, struct ct_modes *modes, const char *path);
/** The modes animated, as one HTML file that needs nothing else; path NULL: standard output. Errors: E002; E530 where the
 *  library was built without pages. */
CT_API bool ct_modes_report(struct ct_ctx *ctx, struct ct_modes *modes, const char *path);
/** What the modes are about, for people. */
CT_API void ct_modes_print_summary(const struct ct_modes *modes, FILE *out);
/** The same as a text, which ct_free frees. */
CT_API char *ct_modes_summary(const struct ct_modes *modes);

struct ct_linearization;

/** Zero: the default. */
struct ct_linearize_options {
    size_t size;       /* 0, or sizeof (struct ct_linearize_options) */
    const char *about; /* as for modes */
    /** Names separated by commas: "J.effort", "F.force.x", "T.torque.z" add to what the model says, others are its
     *  parameters. NULL: the efforts that the model gives and the components of its forces and torques. */
    const char *inputs;
    bool hold_drivers;         /* as for equilibria */
    struct ct_sim_options run; /* of the motion up to a time */
};

/**
 * x' = A x + B u, y = C x + D u for small deviations from a configuration; y are the outputs of the model.
 *
 * Errors   E003 for options; E401, E405, E410, E412; those of assembly and of runs
 * Owner    the caller, until ct_linearization_destroy
 */
CT_API struct ct_linearization *ct_linearize(struct ct_ctx *ctx, struct ct_system *sys,
                                             const struct ct_linearize_options *options);
/** Accepts NULL. */
CT_API void ct_linearization_destroy(struct ct_linearization *s);
/** 'A', 'B', 'C', 'D' (column-major), 'x', 'y', 'r': states, outputs and rates of the states at the configuration.
 *  NULL for other names. */
CT_API const double *ct_linearization_matrix(const struct ct_linearization *s, char name,
                                             size_t *rows, size_t *columns);
/** Name of state ('x'), input ('u') or output ('y') i; NULL beyond the last one. */
CT_API const char *ct_linearization_name(const struct ct_linearization *s, char what, size_t i);
/** The matrices (ct_contents), CSV of [A B; C D]; NULL or "-": CSV on standard output. Errors: E002. */
CT_API bool ct_linearization_write(struct ct_ctx *ctx, const struct ct_linearization *s,
                                   const char *path);
/** Where, and the names, for people. */
CT_API void ct_linearization_print_summary(const struct ct_linearization *s, FILE *out);
/** The same as a text, which ct_free frees. */
CT_API char *ct_linearization_summary(const struct ct_linearization *s);

struct ct_buckling;

struct ct_buckling_options {
    size_t size;       /* 0, or sizeof (struct ct_buckling_options) */
    const char *load;  /* a force, a torque, a joint with an effort, or "gravity" */
    long count;        /* of factors; 10 */
    bool hold_drivers; /* as for equilibria */
};

/**
 * Factors by which a load must be multiplied until the stiffness of the equilibrium vanishes, all other loads constant.
 *
 * Errors   E003 without a load; E405, E410, E413, E414; those of assembly
 * Owner    the caller, until ct_buckling_destroy
 */
CT_API struct ct_buckling *ct_buckling_create(struct ct_ctx *ctx, struct ct_system *sys,
                                              const struct ct_buckling_options *options);
/** Accepts NULL. */
CT_API void ct_buckling_destroy(struct ct_buckling *s);
/** Positive factors, ascending; NaN beyond the last one. */
CT_API size_t ct_buckling_count(const struct ct_buckling *s);
CT_API double ct_buckling_factor(const struct ct_buckling *s, size_t i);
/** The table (ct_contents); NULL or "-": standard output. Errors: E002. */
CT_API bool ct_buckling_write(struct ct_ctx *ctx, struct ct_buckling *s, const char *path);
/** The lowest frequencies (count of them; 3) at 21 factors from 0 to the first one; negative where a motion grows
 *  without oscillating. Files as above. */
CT_API bool ct_buckling_write_curve(struct ct_ctx *ctx, struct ct_buckling *s, const char *path,
                                    long count);
/** How the factors were found, for people. */
CT_API void ct_buckling_print_summary(const struct ct_buckling *s, FILE *out);
/** The same as a text, which ct_free frees. */
CT_API char *ct_buckling_summary(const struct ct_buckling *s);

/* ---- analyses that vary --------------------------------------------------------------------------------- */

/** Zero: the default. */
struct ct_vary_options {
    size_t size; /* 0, or sizeof (struct ct_vary_options) */
    enum ct_vary_analysis {
        CT_VARY_MODES,       /* by `modes` */
        CT_VARY_EQUILIBRIUM, /* by `equilibrium` */
        CT_VARY_DRIVEN       /* ct_sim_follow, by `run`: kinematics and inverse dynamics */
    } analysis;
    /** Members as those of a study. */
    const char *const *vary;
    size_t nvary;
    long sample;
    unsigned long long seed;
    const char *members;
    struct ct_modes_options modes;
    struct ct_equilibrium_options equilibrium;
    struct ct_sim_options run;
    FILE *bar; /* progress is shown there if it is a terminal */
};

/**
 * An analysis of each member of a plan as one table: `run`, what varies, then the columns of the analysis.
 *
 * Each member is a system of its own. One that fails is a row without results, and a warning (E583).
 *
 * out  in   a table (ct_contents); NULL or "-": CSV on standard output
 *
 * Errors   those of ct_system_load and of the options; E583 where all members fail
 */
CT_API bool ct_vary(struct ct_ctx *ctx, const char *path,
                    const struct ct_system_options *system,
                    const struct ct_vary_options *options, const char *out);

/* ---- pictures -------------------------------------------------------------------------------------- */

/** Zero: the start, as it suits the system. */
struct ct_draw_options {
    size_t size; /* 0, or sizeof (struct ct_draw_options) */
    const char *
        view; /* "x", "y", "z" (along an axis) or "iso"; NULL: along the normal of a planar mechanism, else iso */
    double time; /* [s]; > 0: the motion is followed up to there first */
    bool trace;  /* the start, with the paths of points and of beams' ends over the run */
    struct ct_sim_options run;
    const char *path; /* FILE.svg; NULL: standard output */
    FILE *bar;        /* progress is shown there if it is a terminal */
};

/**
 * A mechanism as a line drawing, SVG: bodies by their shapes, or by what holds them, joints by symbols, beams as they bend.
 *
 * The same system and options give the same bytes. Errors: E002, E003; those of assembly and of runs.
 */
CT_API bool ct_system_draw(struct ct_ctx *ctx, struct ct_system *sys,
                           const struct ct_draw_options *options);

/** Zero: the run that the model asks for. */
struct ct_report_options {
    size_t size; /* 0, or sizeof (struct ct_report_options) */
    struct ct_sim_options run;
    const char *path; /* FILE.html; NULL: standard output */
    FILE *bar;        /* progress is shown there if it is a terminal */
    /** The words of a command that makes the page again, without its file; it is shown on the page. NULL: none. */
    const char *const *command;
    size_t ncommand;
    const struct ct_accuracy *accuracy; /* its work-precision plot is shown; NULL: none */
};

/**
 * A system, its equations and its motion as one HTML file that needs nothing else. docs/report.md says what is on it.
 *
 * The run is always verified. Without an end time the page shows the start. The same system and options give the same
 * bytes, but for the times in a work-precision plot.
 *
 * Errors: E002; E530 where the library was built without the page; those of assembly and of runs.
 */
CT_API bool ct_system_report(struct ct_ctx *ctx, struct ct_system *sys,
                             const struct ct_report_options *options);

struct ct_plot;

/**
 * Outputs over time as a picture: pass ct_plot_row and the plot as `row` and `user` of a run's results, then write it.
 *
 * columns  in   names of columns, separated by commas; NULL: all
 *
 * Errors   E003 for a column that does not exist
 * Owner    the caller, until ct_plot_destroy
 */
CT_API struct ct_plot *ct_plot_create(struct ct_ctx *ctx, struct ct_system *sys,
                                      const char *columns);
/** Accepts NULL. */
CT_API void ct_plot_destroy(struct ct_plot *plot);
/** A sample; value as a run gives it. Always true. */
CT_API bool ct_plot_row(void *plot, double t, const double *value, size_t n);
/** As SVG; a panel for each unit. Errors: E002. */
CT_API bool ct_plot_write(struct ct_ctx *ctx, struct ct_plot *plot, const char *path);

/* ---- what there is ------------------------------------------------------------------------------- */

/** Component types with their terminal equations and keys. */
CT_API void ct_components_print(FILE *out);
/** Methods of integration. */
CT_API void ct_methods_print(FILE *out);
/** JSON Schema (draft 2020-12) of the model file. */
CT_API void ct_schema_print(FILE *out);
/** The same as texts, which ct_free frees. */
CT_API char *ct_components_text(void);
CT_API char *ct_methods_text(void);
CT_API char *ct_schema_text(void);

#ifdef __cplusplus
}
#endif

#endif
