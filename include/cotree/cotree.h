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
 * What always holds:
 *
 * - A function that fails returns NULL or false and has put at least one diagnostic into the
 *   context.
 * - A function that gets a NULL context, system, run or state fails without a diagnostic; it
 *   returns NaN for numbers and 0 for counts. A chain of calls needs only one check at its end.
 * - Options are structs in which zero selects the default. Words in them (methods, formats,
 *   trees) are those of the command line. Their first member is the size of the struct; 0
 *   stands for the size in this header. Programs therefore run with later libraries whose
 *   structs have more members.
 * - A loaded system does not change. Any number of threads may use it, each with its own
 *   context, runs and states. A system must live as long as everything that was created from
 *   it.
 * - The locale of the program has no effect on what is read or written.
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

/* ---- the context: where diagnostics go ------------------------------------------------------ */

struct ct_ctx;

/** Whose mistake an error was; the values are exit statuses. */
enum ct_fault {
    CT_FAULT_NONE = 0,  /* no error so far */
    CT_FAULT_MODEL = 1, /* the model or the run failed */
    CT_FAULT_OPTION = 2 /* an option has a value that cannot be used */
};

/** Creates a context. NULL if memory is exhausted. */
CT_API struct ct_ctx *ct_ctx_create(void);
/** Accepts NULL. Systems and runs stay valid without the context they were created with. */
CT_API void ct_ctx_destroy(struct ct_ctx *ctx);
/**
 * Prints all errors, warnings and notes as FILE:LINE:COLUMN: error: MESSAGE, with the source
 * line.
 */
CT_API void ct_ctx_print_diagnostics(const struct ct_ctx *ctx, FILE *out);
/** The same as a text, to be freed by ct_free. */
CT_API char *ct_ctx_diagnostics(const struct ct_ctx *ctx);
/** The most serious fault among the diagnostics. */
CT_API enum ct_fault ct_ctx_fault(const struct ct_ctx *ctx);

/**
 * Diagnostics one by one. Errors and warnings come in the order of their creation, notes after
 * the diagnostic they belong to. ct_ctx_diagnostic returns false for an index beyond the last
 * one.
 */
CT_API size_t ct_ctx_count(const struct ct_ctx *ctx);
CT_API bool ct_ctx_diagnostic(struct ct_ctx *ctx, size_t i, struct ct_diagnostic *diagnostic);
/** Removes all diagnostics and resets a cancellation. */
CT_API void ct_ctx_clear(struct ct_ctx *ctx);
/**
 * Calls back for each error and warning before the function that caused it returns; NULL: no
 * callback. Do not call this from the callback.
 */
CT_API void ct_ctx_on_diagnostic(struct ct_ctx *ctx,
                                 void (*callback)(void *user,
                                                  const struct ct_diagnostic *diagnostic),
                                 void *user);
/**
 * Cancels all work with this context; may be called from any thread or signal handler. A run
 * ends at its next accepted step and an analysis at its next part, with error E005. Work that
 * begins later ends in the same way until ct_ctx_clear. Complete rows stay in PATH.partial.
 */
CT_API void ct_ctx_cancel(struct ct_ctx *ctx);
/** True if work with this context was cancelled. */
CT_API bool ct_ctx_was_interrupted(const struct ct_ctx *ctx);

/** Frees a text that the library has returned. Accepts NULL. */
CT_API void ct_free(void *text);

/** Version of this header; ct_version returns that of the library, such as "0.1.0". */
#define CT_VERSION_MAJOR 0
#define CT_VERSION_MINOR 1
#define CT_VERSION_PATCH 0
CT_API const char *ct_version(void);
/**
 * Returns the one of n names that is most similar to a misspelt one, or NULL if none is
 * similar.
 */
CT_API const char *ct_did_you_mean(const char *name, const char *const *names, size_t n);

/* ---- files ---------------------------------------------------------------------------------- */

enum ct_contents {
    CT_CONTENTS_TABLE,   /* results: .csv, .csv.gz, .json, .npz (NumPy), .mat (version 4) */
    CT_CONTENTS_SUMMARY, /* .json */
    CT_CONTENTS_PLOT     /* .svg */
};
/**
 * True if a format belongs to the suffix of path. A path without a suffix gets the first
 * format. Errors: E007.
 */
CT_API bool ct_can_write(struct ct_ctx *ctx, enum ct_contents contents, const char *path);

/**
 * Opens a text file for printing to its stream. The file appears under its name when it is
 * complete.
 *
 * path    in    NULL or "-": standard output
 *
 * Errors  E002; E006 if another process is writing the file
 * Owner   the caller, until ct_output_close
 */
CT_API struct ct_output *ct_output_open(struct ct_ctx *ctx, const char *path);
CT_API FILE *ct_output_stream(const struct ct_output *o);
/**
 * Closes the file. ok: its contents are complete; otherwise it is deleted. Returns true if the
 * file exists under its name. Accepts NULL. Errors: E002.
 */
CT_API bool ct_output_close(struct ct_ctx *ctx, struct ct_output *o, bool ok);

/**
 * Converts a robot description (URDF) to the text of a model file. Links become bodies, joints
 * become joints, `mimic` becomes a gear, visuals become shapes. Each element that is not used
 * gives a warning (E574) with its line.
 *
 * model   in    path of the model file to be written; meshes are named relative to it. NULL: full
 *               paths
 *
 * Errors  E571 to E573, E002
 * Owner   the caller, until ct_free
 */
CT_API char *ct_import_urdf(struct ct_ctx *ctx, const char *path, const char *model);

/* ---- systems: a model and its equations ----------------------------------------------------- */

struct ct_system;

/** Columns of results in addition to the model's outputs. */
enum ct_columns_more {
    CT_COLUMNS_OF_MODEL = 0,
    /* if the model lists no outputs: coordinates, speeds and accelerations of all joints */
    CT_COLUMNS_COORDINATES,
    CT_COLUMNS_EFFORTS /* efforts of drivers; forces and torques of all joints */
};

struct ct_system_options {
    size_t size;            /* 0, or sizeof (struct ct_system_options) */
    const char *const *set; /* "NAME=VALUE": values that replace those of parameters */
    size_t nset;
    const char *tree; /* "auto", "joints", "absolute", or a YAML file that names the branches */
    bool keep_all;    /* planar mechanisms keep their spatial equations */
    enum ct_columns_more columns;
    /** For modes, equilibria and buckling, not for runs. Beams keep all deformations of their
     *  sections, also those that no load excites, and large systems are derived faster. */
    bool for_analysis;
    long beam_elements; /* > 0: number of equal elements of every beam, instead of the file's */
    const char *
        beam_formulation; /* of every beam: "linear", "foreshortening" ...; NULL: as in the file */
    /** CSV file with the inputs of all runs as functions of time: a column `t` [s] and columns by
     *  name. NULL: inputs are constant. */
    const char *input;
    bool hold_input; /* values are held from each row to the next; else linear interpolation */
    const char *const *output; /* "NAME=EXPRESSION": outputs behind those of the file */
    size_t noutput;
};

/**
 * Reads a model file and derives its equations of motion.
 *
 * options  in   NULL: defaults
 *
 * Errors   E002, E003 and those of the file, E1xx and E2xx
 * Owner    the caller, until ct_system_destroy
 */
CT_API struct ct_system *ct_system_load(struct ct_ctx *ctx, const char *path,
                                        const struct ct_system_options *options);
/**
 * The same for n bytes of text. name stands for the file in diagnostics, and tables are
 * searched in its folder. NULL: "model".
 */
CT_API struct ct_system *ct_system_load_text(struct ct_ctx *ctx, const char *text, size_t n,
                                             const char *name,
                                             const struct ct_system_options *options);
/** Accepts NULL. Destroy its runs first. */
CT_API void ct_system_destroy(struct ct_system *sys);

/** Name of the model; names of the result columns without the first one, `t`. */
CT_API const char *ct_system_name(const struct ct_system *sys);
CT_API size_t ct_system_column_count(const struct ct_system *sys);
CT_API const char *ct_system_column(const struct ct_system *sys, size_t i);

/**
 * Prints the cheapest pairs of trees that were compared, at most ten, and the reason for the
 * choice. format: "text" or "json". Option `tree` "N" of ct_system_load selects pair N. Errors:
 * E003.
 */
CT_API bool ct_system_print_trees(struct ct_ctx *ctx, struct ct_system *sys, const char *format,
                                  FILE *out);

/** Prints the linear graph and its trees. format: "text", "dot" or "json". Errors: E003. */
CT_API bool ct_system_print_graph(struct ct_ctx *ctx, struct ct_system *sys, const char *format,
                                  FILE *out);

/**
 * Prints the derivation of the equations of motion.
 *
 * stages  in   a list of "terminal,graph,tree,cutset,circuit,reduced", or "all"; NULL: tree,reduced
 * format  in   "text", "latex", "html", "c" or "json"; NULL: text. "c" has only the reduced
 *              equations.
 *
 * Systems of more than 100 speeds are printed in recursive form, except in C
 * (docs/equations.md).
 *
 * Errors: E002 for the stream, E003.
 */
CT_API bool ct_system_print_equations(struct ct_ctx *ctx, struct ct_system *sys,
                                      const char *stages, const char *format, FILE *out);

/**
 * The same for reading: text, LaTeX and HTML show only the first and last lines of long lists
 * of recursive equations.
 */
CT_API bool ct_system_summarize_equations(struct ct_ctx *ctx, struct ct_system *sys,
                                          const char *stages, const char *format, FILE *out);

/** The same as texts, to be freed by ct_free; NULL on failure. */
CT_API char *ct_system_graph(struct ct_ctx *ctx, struct ct_system *sys, const char *format);
CT_API char *ct_system_equations(struct ct_ctx *ctx, struct ct_system *sys, const char *stages,
                                 const char *format);

/** Kinds of named items of a system. */
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
    /** Default of a parameter or input, value of a coordinate, speed or output at the start; else
     *  NaN. SI units. */
    double value;
    size_t line, column; /* where the file says it, from 1; 0: nowhere */
};

CT_API size_t ct_system_count(const struct ct_system *sys, enum ct_kind kind);
/** Describes item i of a kind. False if i is beyond the last one. */
CT_API bool ct_system_item(const struct ct_system *sys, enum ct_kind kind, size_t i,
                           struct ct_item *item);
/** Index of a name; -1 if it does not exist. */
CT_API long ct_system_find(const struct ct_system *sys, enum ct_kind kind, const char *name);

/* ---- runs ----------------------------------------------------------------------------------- */

struct ct_sim;

/** Options of runs. Zero selects what the model's `simulation` says. */
struct ct_sim_options {
    size_t size;        /* 0, or sizeof (struct ct_sim_options) */
    const char *method; /* a name that ct_methods_print lists, or "auto" */
    double tolerance;   /* wanted relative accuracy of the outputs */
    double absolute; /* of quantities near zero; tolerance / 100 when only the other is given */
    double step;     /* fixed step [s] */
    double until;    /* end time [s]; the spacing of samples stays that of the model */
    long samples;    /* number of samples, both ends included */
    bool verify;     /* a second run estimates the global error of each output */
    const char *
        backend; /* what evaluates the equations: "auto", "native" or "tape"; same to round-off */
    const char *solver; /* what finds the accelerations of closed loops: "auto", "unrolled",
                           "one-system", "sparse" or "dense"; not of studies */
};

/** Where results go. Each member may be zero. */
struct ct_sim_results {
    size_t size; /* 0, or sizeof (struct ct_sim_results) */
    const char
        *path; /* a table, see ct_contents; "-" is standard output as CSV; NULL: no file */
    FILE *bar; /* progress is shown there if it is a terminal */
    /** Called at each accepted step. Return false to stop the run there; this is no failure. */
    bool (*progress)(void *user, double t, double end);
    /**
     * Called for each sample, with n values. Return false to stop the run there; this is no
     * failure.
     */
    bool (*row)(void *user, double t, const double *value, size_t n);
    void *user;
};

/**
 * Creates a run of a system, assembled at t = 0.
 *
 * Errors   E003 for options; E4xx if the mechanism cannot be assembled
 * Owner    the caller, until ct_sim_destroy
 */
CT_API struct ct_sim *ct_sim_create(struct ct_ctx *ctx, struct ct_system *sys,
                                    const struct ct_sim_options *options);
/** Accepts NULL. */
CT_API void ct_sim_destroy(struct ct_sim *sim);

/**
 * Integrates to the end time; once per run. results may be NULL.
 *
 * The results file appears under its name when it is complete. If the run fails, the rows so
 * far stay in PATH.partial.
 *
 * Errors: E002 for the file, E003 if there is no end time, E3xx and E4xx with the time reached.
 */
CT_API bool ct_sim_run(struct ct_ctx *ctx, struct ct_sim *sim,
                       const struct ct_sim_results *results);

/**
 * Kinematic analysis and inverse dynamics: computes the samples of a run in which drivers
 * prescribe all freedoms, without integration. Otherwise as ct_sim_run.
 *
 * Errors: those of ct_sim_run; E411 if a freedom has no driver.
 */
CT_API bool ct_sim_follow(struct ct_ctx *ctx, struct ct_sim *sim,
                          const struct ct_sim_results *results);

/**
 * Time of the last sample [s], and the value of a column at that time; NaN for a column that
 * does not exist.
 */
CT_API double ct_sim_time(const struct ct_sim *sim);
CT_API double ct_sim_value(const struct ct_sim *sim, const char *column);
/**
 * The global error of a column relative to its largest value, estimated by a run with `verify`;
 * NaN if it is not known.
 */
CT_API double ct_sim_error(const struct ct_sim *sim, const char *column);

/**
 * The output of ct_sim_print_summary, ct_sim_print_check and ct_sim_write_summary as texts, to
 * be freed by ct_free.
 */
CT_API char *ct_sim_summary(const struct ct_sim *sim);
CT_API char *ct_sim_check(const struct ct_sim *sim);
CT_API char *ct_sim_summary_json(const struct ct_sim *sim);
/** Prints what the run did and how well it conserved energy and satisfied the constraints. */
CT_API void ct_sim_print_summary(const struct ct_sim *sim, FILE *out);
/** The same as a JSON object in a file. Errors: E002. */
CT_API bool ct_sim_write_summary(struct ct_ctx *ctx, const struct ct_sim *sim,
                                 const char *path);
/**
 * Prints the properties of the system: freedoms, trees and the reason for their choice,
 * redundant constraints, costs.
 */
CT_API void ct_sim_print_check(const struct ct_sim *sim, FILE *out);
/**
 * Surveys the loops of the mechanism, before the run: the joint that closes each loop, the rank
 * of its constraints, which constraints are redundant and which reactions are not unique, the
 * distance from a singular configuration, and the joint freedoms that would remove the
 * redundancy.
 *
 * out      in  text is printed there; NULL: no text
 * summary  in  path of a JSON file as ct_sim_write_summary writes it, with the loops; NULL: no
 *              file
 *
 * Errors: E002.
 */
CT_API bool ct_sim_print_loops(struct ct_ctx *ctx, struct ct_sim *sim, FILE *out,
                               const char *summary);
/**
 * Exports the model as source code in a folder, which is created if needed, or as an FMU.
 * Before the run.
 *
 * format "c" or NULL writes NAME.h, NAME.c, NAME_test.c and NAME.json, where NAME is that of
 * the model. NAME_test.c compares results with values computed here. format "fmu2" or "fmu3"
 * writes one file, `place`. Errors: E002, E003, E405, E560. Warning: E561 without a compiler.
 */
CT_API bool ct_sim_export(struct ct_ctx *ctx, struct ct_sim *sim, const char *format,
                          const char *place);
/**
 * The same; lanes = 4 or 8 adds functions that evaluate M, Q, J, gam, phi and v for that many
 * inputs at once (SIMD). 1 or 0: without.
 */
CT_API bool ct_sim_export_lanes(struct ct_ctx *ctx, struct ct_sim *sim, const char *format,
                                const char *place, long lanes);

/* ---- one state of a system, step by step ---------------------------------------------------- */

/**
 * A state: time, coordinates q, speeds u, inputs, parameters, and the quantities that follow
 * from them:
 *
 *     M u' = Q + J' lambda,    J u' + gamma = 0,    phi = 0
 *
 * Only one thread may use a state at a time. After the first call of each, get, value, set and
 * step do not allocate memory.
 */
struct ct_data;

/**
 * Quantities at a state, for nu speeds, nq coordinates and m constraints. Matrices are stored
 * row by row; a vector has one column.
 */
enum ct_quantity {
    CT_Q_M,            /* nu x nu, mass matrix */
    CT_Q_FORCE,        /* nu, Q: applied forces minus inertia forces of the speeds */
    CT_Q_J,            /* m x nu */
    CT_Q_GAMMA,        /* m */
    CT_Q_PHI,          /* m, position constraints: 0 for closed loops */
    CT_Q_ACCELERATION, /* nu, u' */
    CT_Q_MULTIPLIERS,  /* m, of least norm where constraints are redundant */
    CT_Q_OUTPUTS,      /* as CT_OUTPUT */
    /* 5 [J]: kinetic, potential, strain, external work, kinetic + potential + strain - work */
    CT_Q_ENERGY,
    CT_Q_COORDINATES, /* nq */
    CT_Q_SPEEDS,      /* nu */
    CT_Q_RATE,        /* nq, q' */
    CT_Q_PHI_RATE,    /* m, d phi/dt = J u + partial derivative by time */
    CT_Q_STATES,      /* as CT_STATE */
    CT_Q_STATE_RATES  /* rates of CT_Q_STATES */
};

/**
 * Creates a state at t = 0, assembled as a run is at its start. The options `method`,
 * `tolerance`, `absolute`, `step`, `backend` and `solver` are used. Method "auto" is "dopri5",
 * or the method of the model; use "radau5" for stiff systems. options may be NULL.
 *
 * Errors   E003 for options; E4xx if the mechanism cannot be assembled
 * Owner    the caller, until ct_data_destroy; the system must live as long
 */
CT_API struct ct_data *ct_data_create(struct ct_ctx *ctx, const struct ct_system *sys,
                                      const struct ct_sim_options *options);
/** Creates a copy of a state with the same values. */
CT_API struct ct_data *ct_data_clone(struct ct_ctx *ctx, const struct ct_data *data);
/** Accepts NULL. */
CT_API void ct_data_destroy(struct ct_data *data);

/**
 * Returns to the start, with the present parameters and inputs. Errors: E4xx; then the state
 * does not change.
 */
CT_API bool ct_data_reset(struct ct_ctx *ctx, struct ct_data *data);
/**
 * Sets all n values of a kind in its order: parameters, inputs, coordinates or speeds.
 * Parameters defined by others are updated. A defined parameter that is set to a value other
 * than its present one no longer follows its definition. The state is not assembled.
 *
 * Errors   E500 for a wrong number of values or a value that is not finite; E501 for a kind that
 *          cannot be set; E502 for a parameter whose value has determined the form of the
 *          equations. On an error the state does not change.
 */
CT_API bool ct_data_set(struct ct_ctx *ctx, struct ct_data *data, enum ct_kind kind,
                        const double *value, size_t n);
/** Sets one value. Errors: those of ct_data_set; E503 for a name that does not exist. */
CT_API bool ct_data_set_one(struct ct_ctx *ctx, struct ct_data *data, enum ct_kind kind,
                            const char *name, double value);
CT_API bool ct_data_set_time(struct ct_ctx *ctx, struct ct_data *data, double t);
/**
 * Moves the state to the nearest coordinates and speeds that satisfy the constraints. Errors:
 * E504 names the constraints that cannot be satisfied.
 */
CT_API bool ct_data_assemble(struct ct_ctx *ctx, struct ct_data *data);

/**
 * Returns a quantity and its size. It is computed on demand and valid until the next set or
 * step. NULL on failure. Errors: E405. rows and columns may be NULL.
 */
CT_API const double *ct_data_get(struct ct_ctx *ctx, struct ct_data *data,
                                 enum ct_quantity quantity, size_t *rows, size_t *columns);
/**
 * Value of a parameter, input, coordinate, speed, multiplier or output; NaN if it does not
 * exist or cannot be computed.
 */
CT_API double ct_data_value(const struct ct_data *data, enum ct_kind kind, size_t i);
CT_API double ct_data_time(const struct ct_data *data);
/**
 * Integrates to exactly t + dt [s] within the tolerance, with constant inputs; events are
 * located on the way. A state that violates the constraints is assembled first.
 *
 * Errors   E3xx, E4xx, E504; the state is then at the time reached. E500 unless dt >= 0.
 */
CT_API bool ct_data_step(struct ct_ctx *ctx, struct ct_data *data, double dt);
/**
 * Inverse dynamics: efforts (nu, out) that give the accelerations u' (nu). In a system without
 * loops they are M u' - Q. In a system with loops, efforts act at the joints that have an
 * effort in the model, or at all joints if none has; other entries are 0. The efforts are the
 * least-squares solution of least norm. A warning tells if they are not unique. Errors: E405;
 * E505 if they cannot give these accelerations.
 */
CT_API bool ct_data_inverse(struct ct_ctx *ctx, struct ct_data *data,
                            const double *acceleration, double *effort);
/**
 * Rotation matrix R (3 x 3, row by row) and origin p [m] of a frame. R v has ground components
 * if v has components in the frame. Errors: E500.
 */
CT_API bool ct_data_pose(struct ct_ctx *ctx, struct ct_data *data, size_t frame, double R[9],
                         double p[3]);

/* ---- speed against error -------------------------------------------------------------------- */

struct ct_accuracy;

/** Zero selects defaults. */
struct ct_accuracy_options {
    size_t size; /* 0, or sizeof (struct ct_accuracy_options) */
    /**
     * Options of all runs. method: names separated by commas; NULL or "auto": a standard list.
     * If tolerance or step is given, only this value is tried.
     */
    struct ct_sim_options run;
    double error; /* relative error that is wanted; 0: 1e-6 */
    /**
     * Systems to compare: the same model with different beams in each. NULL: only the system
     * itself. With variants the system itself is the reference.
     */
    const struct ct_accuracy_variant {
        struct ct_system *system;
        long elements;           /* for the table; 0: none */
        const char *formulation; /* NULL: none */
    } * variant;
    size_t nvariant;
    const char *reference; /* CSV as simulate writes it; NULL: found by tight runs that agree */
    /** How many tolerances, or steps beginning with run.step, are tried in each decade; at most 10.
     *  0: powers of ten. If it is given, the tolerances begin at 1e-2. */
    int per_decade;
    FILE *bar; /* progress is shown there if it is a terminal */
};

/**
 * Runs a system with several methods and tolerances and compares each run with a converged
 * reference.
 *
 * The error of a run is the largest of |difference from the reference| / largest |reference
 * output| over outputs and samples. Each run is timed three times, short ones up to 101 times.
 * Each method gets about a minute.
 *
 * Errors   E003 for options; E134, E135 for the reference; E309 if none is found; those of runs
 * Owner    the caller, until ct_accuracy_destroy
 */
CT_API struct ct_accuracy *ct_accuracy_create(struct ct_ctx *ctx, struct ct_system *sys,
                                              const struct ct_accuracy_options *options);
/** Accepts NULL. */
CT_API void ct_accuracy_destroy(struct ct_accuracy *a);

/** Writes the table (ct_contents); NULL or "-": CSV on standard output. Errors: E002. */
CT_API bool ct_accuracy_write(struct ct_ctx *ctx, const struct ct_accuracy *a,
                              const char *path);
/** Draws the work-precision plot as SVG. Errors: E002. */
CT_API bool ct_accuracy_draw(struct ct_ctx *ctx, const struct ct_accuracy *a, const char *path);
/** Prints the error of the reference and the cheapest setting with the wanted error. */
CT_API void ct_accuracy_print_summary(const struct ct_accuracy *a, FILE *out);
/** The same as a text, to be freed by ct_free. */
CT_API char *ct_accuracy_summary(const struct ct_accuracy *a);

/* ---- parameter studies ---------------------------------------------------------------------- */

struct ct_study;

/** Zero selects defaults. */
struct ct_study_options {
    size_t size;               /* 0, or sizeof (struct ct_study_options) */
    struct ct_sim_options run; /* of all members */
    /**
     * "NAME=FROM:TO:N" each: a grid whose last axis varies fastest. With `sample` also
     * "NAME=FROM:TO" (uniform) and "NAME=normal:MEAN:DEVIATION"; then N is ignored.
     */
    const char *const *vary;
    size_t nvary;
    long sample;             /* > 0: number of random members instead of the grid */
    unsigned long long seed; /* of the random numbers: same seed, same members */
    long threads;            /* at most; 0: all cores. 1 without OpenMP. */
    long lanes;              /* members in a SIMD batch: 1, 4, or 8; 0: 4 if possible */
    const char
        *members; /* a CSV file of members instead of `vary`: its columns are parameters */
    /**
     * Runs only shard number `shard` (from 1) of `shards`: every shards-th member, beginning
     * with member `shard`. Rows and run numbers are those of the whole sweep. 0: all members.
     */
    long shard, shards;
    /**
     * "NAME=FUNCTION(EXPRESSION)" each: a column after the outputs that evaluates an expression
     * of outputs over the run. FUNCTION is max, min, mean, rms, final, or time: the time [s] at
     * which the expression first rises through zero (NaN if it does not).
     */
    const char *const *take;
    size_t ntake;
    const char
        *text; /* ntext bytes of a model instead of the file at path, which names it then */
    size_t ntext;
};

/** Where rows go. Each member may be zero. */
struct ct_study_results {
    size_t size; /* 0, or sizeof (struct ct_study_results) */
    const char
        *path;   /* a table, see ct_contents; "-" is standard output as CSV; NULL: no file */
    bool resume; /* continues an interrupted sweep, whose rows are in PATH.partial */
    FILE *bar;   /* progress is shown there if it is a terminal */
    /**
     * Called after each member, from any thread but not concurrently, with the number of
     * finished members. Return false to stop.
     */
    bool (*progress)(void *user, double done, double all);
    /**
     * Called for each member in order, from any thread but not concurrently: run number from 1,
     * values of the varied parameters, outputs at the end time. If the run failed, value is
     * NULL and message says why. Return false to stop; this is no failure.
     */
    bool (*row)(void *user, long run, const double *varied, const double *value,
                const char *message);
    void *user;
};

/**
 * Reads a model and derives its equations once for all members of a study.
 *
 * The results of a member do not depend on threads or on other members. If the value of a
 * varied parameter determines the form of the equations (whether a mechanism is planar), the
 * equations are derived for each member.
 *
 * system  in   NULL: defaults. Varied parameters replace values that are set here.
 *
 * Errors   those of ct_system_load and of the options of runs; E003 for the varied parameters
 * Owner    the caller, until ct_study_destroy
 */
CT_API struct ct_study *ct_study_create(struct ct_ctx *ctx, const char *path,
                                        const struct ct_system_options *system,
                                        const struct ct_study_options *options);
/** Accepts NULL. */
CT_API void ct_study_destroy(struct ct_study *study);
/**
 * Runs all members; once for each study. results may be NULL.
 *
 * A member that fails still has a row. The sweep fails if rows cannot be written. The file
 * appears under its name when it is complete. Until then the rows are in PATH.partial in order,
 * and the settings they depend on in PATH.partial.settings. With `resume` the settings file
 * stays as PATH.settings.
 *
 * Errors: E002 for the file; E003 if it cannot be resumed, for example because settings or the
 * model have changed.
 */
CT_API bool ct_study_run(struct ct_ctx *ctx, struct ct_study *study,
                         const struct ct_study_results *results);
/** Number of members; number of finished members that failed. */
CT_API long ct_study_count(const struct ct_study *study);
CT_API long ct_study_failed(const struct ct_study *study);
/** Columns of a row: `run`, the varied parameters, then the outputs at the end time. */
CT_API size_t ct_study_column_count(const struct ct_study *study);
CT_API const char *ct_study_column(const struct ct_study *study, size_t i);
/** Prints what was done and which members failed. */
CT_API void ct_study_print_summary(const struct ct_study *study, FILE *out);
/** The same as a text, to be freed by ct_free. */
CT_API char *ct_study_summary(const struct ct_study *study);
/** The same as a JSON object in a file. Errors: E002. */
CT_API bool ct_study_write_summary(struct ct_ctx *ctx, const struct ct_study *study,
                                   const char *path);
CT_API char *ct_study_summary_json(const struct ct_study *study);

/**
 * Joins the shards of a sweep, in any order, to the file that the whole sweep would have
 * written, byte for byte.
 *
 * path  in   FILE.csv; NULL or "-": standard output
 * part  in   (n) the files of all shards; PART.settings must be beside each
 *
 * On an error nothing is written. Errors: E002, E003, E006; E580 to E582.
 */
CT_API bool ct_study_merge(struct ct_ctx *ctx, const char *path, const char *const *part,
                           size_t n);

/* ---- analyses about a configuration --------------------------------------------------------- */

struct ct_equilibrium;

/** Zero selects defaults. */
struct ct_equilibrium_options {
    size_t size; /* 0, or sizeof (struct ct_equilibrium_options) */
    /**
     * True: all drivers are held at their values at t = 0. False: drivers of constant rate that
     * turn the system as a whole continue, and the equilibrium is one in the turning frame;
     * other drivers are held.
     */
    bool hold_drivers;
};

/**
 * Finds the static equilibrium that is reached from the assembled start at t = 0 by descending
 * the potential, with zero speeds.
 *
 * Errors   E401, E405, E410; those of assembly
 * Owner    the caller, until ct_equilibrium_destroy
 */
CT_API struct ct_equilibrium *
ct_equilibrium_create(struct ct_ctx *ctx, struct ct_system *sys,
                      const struct ct_equilibrium_options *options);
/** Accepts NULL. */
CT_API void ct_equilibrium_destroy(struct ct_equilibrium *q);
/** Value of a column; NaN if it does not exist. */
CT_API double ct_equilibrium_value(const struct ct_equilibrium *q, const char *column);
/** True if no small motion about the equilibrium grows. */
CT_API bool ct_equilibrium_is_stable(const struct ct_equilibrium *q);
/**
 * Writes one row of outputs, t = 0, as a table (ct_contents); NULL or "-": standard output.
 * Errors: E002.
 */
CT_API bool ct_equilibrium_write(struct ct_ctx *ctx, const struct ct_equilibrium *q,
                                 const char *path);
/** Prints the residual of the equilibrium and its stability. */
CT_API void ct_equilibrium_print_summary(const struct ct_equilibrium *q, FILE *out);
/** The same as a text, to be freed by ct_free. */
CT_API char *ct_equilibrium_summary(const struct ct_equilibrium *q);

struct ct_modes;

/** Zero selects defaults. */
struct ct_modes_options {
    size_t size;       /* 0, or sizeof (struct ct_modes_options) */
    const char *about; /* "initial" (NULL), "equilibrium", or a time [s] of the motion */
    long count;        /* of rows; 10 */
    bool hold_drivers; /* as for equilibria */
    struct ct_sim_options run; /* of the motion up to a time */
};

/** A natural motion exp(s t): a pair of complex eigenvalues, or one real eigenvalue. */
struct ct_mode_info {
    double frequency_hz; /* |s| / (2 pi) */
    double omega;        /* |s| [rad/s] */
    double damping;      /* -Re(s) / |s|; -1: grows without oscillating; 0 where s = 0 */
    double re, im;       /* s [1/s], im >= 0 */
};

/**
 * Computes the natural modes of a system linearised about a configuration.
 *
 * Errors   E003 for options; E401, E405, E410; those of assembly and of runs
 * Owner    the caller, until ct_modes_destroy
 */
CT_API struct ct_modes *ct_modes_create(struct ct_ctx *ctx, struct ct_system *sys,
                                        const struct ct_modes_options *options);
/** Accepts NULL. */
CT_API void ct_modes_destroy(struct ct_modes *modes);
/**
 * Number of modes: as many as requested, or all if there are fewer. Modes ascend
 * with |s|; ct_modes_info returns mode i, or zeros if it does not exist.
 */
CT_API size_t ct_modes_count(const struct ct_modes *modes);
CT_API struct ct_mode_info ct_modes_info(const struct ct_modes *modes, size_t i);
/**
 * Entry of a mode's shape: complex amplitude of the named coordinate; the largest entry is 1.
 * False: no such name.
 */
CT_API bool ct_modes_shape(const struct ct_modes *modes, size_t i, const char *coordinate,
                           double *re, double *im);
/**
 * Writes the table (ct_contents); formats other than CSV also contain the shapes. NULL or "-":
 * standard output. Errors: E002.
 */
CT_API bool ct_modes_write(struct ct_ctx *ctx, const struct ct_modes *modes, const char *path);
/**
 * Draws the shapes of the first modes as SVG: frames and the lines between them, at rest and
 * displaced. Errors: E002.
 */
CT_API bool ct_modes_draw(struct ct_ctx *ctx, struct ct_modes *modes, const char *path);
/**
 * Writes the modes as an animation: one HTML file without external resources. path NULL:
 * standard output. Errors: E002; E530 if the library was built without pages.
 */
CT_API bool ct_modes_report(struct ct_ctx *ctx, struct ct_modes *modes, const char *path);
/** Prints the configuration and the modes. */
CT_API void ct_modes_print_summary(const struct ct_modes *modes, FILE *out);
/** The same as a text, to be freed by ct_free. */
CT_API char *ct_modes_summary(const struct ct_modes *modes);

struct ct_linearization;

/** Zero selects defaults. */
struct ct_linearize_options {
    size_t size;       /* 0, or sizeof (struct ct_linearize_options) */
    const char *about; /* as for modes */
    /**
     * Names separated by commas. "J.effort", "F.force.x" and "T.torque.z" are added to the
     * values in the model; other names are parameters. NULL: the efforts that the model gives
     * and the components of its forces and torques.
     */
    const char *inputs;
    bool hold_drivers;         /* as for equilibria */
    struct ct_sim_options run; /* of the motion up to a time */
};

/**
 * Linearises a system: x' = A x + B u, y = C x + D u for small deviations from a configuration.
 * y are the outputs of the model.
 *
 * Errors   E003 for options; E401, E405, E410, E412; those of assembly and of runs
 * Owner    the caller, until ct_linearization_destroy
 */
CT_API struct ct_linearization *ct_linearize(struct ct_ctx *ctx, struct ct_system *sys,
                                             const struct ct_linearize_options *options);
/** Accepts NULL. */
CT_API void ct_linearization_destroy(struct ct_linearization *s);
/**
 * Matrices 'A', 'B', 'C', 'D' (column-major) and vectors at the configuration: 'x' states, 'y'
 * outputs, 'r' rates of the states. NULL for other names.
 */
CT_API const double *ct_linearization_matrix(const struct ct_linearization *s, char name,
                                             size_t *rows, size_t *columns);
/** Name of state ('x'), input ('u') or output ('y') i; NULL beyond the last one. */
CT_API const char *ct_linearization_name(const struct ct_linearization *s, char what, size_t i);
/**
 * Writes the matrices (ct_contents); CSV contains [A B; C D]. NULL or "-": CSV on standard
 * output. Errors: E002.
 */
CT_API bool ct_linearization_write(struct ct_ctx *ctx, const struct ct_linearization *s,
                                   const char *path);
/** Prints the configuration and the names. */
CT_API void ct_linearization_print_summary(const struct ct_linearization *s, FILE *out);
/** The same as a text, to be freed by ct_free. */
CT_API char *ct_linearization_summary(const struct ct_linearization *s);

struct ct_buckling;

struct ct_buckling_options {
    size_t size;       /* 0, or sizeof (struct ct_buckling_options) */
    const char *load;  /* a force, a torque, a joint with an effort, or "gravity" */
    long count;        /* of factors; 10 */
    bool hold_drivers; /* as for equilibria */
};

/**
 * Finds the factors of a load at which the stiffness of the equilibrium becomes singular, while
 * all other loads stay constant (static buckling).
 *
 * Errors   E003 without a load; E405, E410, E413, E414; those of assembly
 * Owner    the caller, until ct_buckling_destroy
 */
CT_API struct ct_buckling *ct_buckling_create(struct ct_ctx *ctx, struct ct_system *sys,
                                              const struct ct_buckling_options *options);
/** Accepts NULL. */
CT_API void ct_buckling_destroy(struct ct_buckling *s);
/** Number of positive factors, and factor i in ascending order; NaN beyond the last one. */
CT_API size_t ct_buckling_count(const struct ct_buckling *s);
CT_API double ct_buckling_factor(const struct ct_buckling *s, size_t i);
/** Writes the table (ct_contents); NULL or "-": standard output. Errors: E002. */
CT_API bool ct_buckling_write(struct ct_ctx *ctx, struct ct_buckling *s, const char *path);
/**
 * Writes the lowest frequencies (`count` of them; 0: 3) at 21 load factors from 0 to the first
 * critical one. A frequency is negative if the motion grows without oscillating. Files as
 * above.
 */
CT_API bool ct_buckling_write_curve(struct ct_ctx *ctx, struct ct_buckling *s, const char *path,
                                    long count);
/** Prints how the factors were found. */
CT_API void ct_buckling_print_summary(const struct ct_buckling *s, FILE *out);
/** The same as a text, to be freed by ct_free. */
CT_API char *ct_buckling_summary(const struct ct_buckling *s);

/* ---- parameter variation of analyses -------------------------------------------------------- */

/** Zero selects defaults. */
struct ct_vary_options {
    size_t size; /* 0, or sizeof (struct ct_vary_options) */
    enum ct_vary_analysis {
        CT_VARY_MODES,       /* by `modes` */
        CT_VARY_EQUILIBRIUM, /* by `equilibrium` */
        CT_VARY_DRIVEN       /* ct_sim_follow, by `run`: kinematics and inverse dynamics */
    } analysis;
    /** The members, as for a study. */
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
 * Repeats an analysis for each member of a plan and writes one table: `run`, the varied
 * parameters, then the columns of the analysis.
 *
 * Each member is a system of its own. A member that fails has a row without results and a
 * warning (E583).
 *
 * out  in   a table (ct_contents); NULL or "-": CSV on standard output
 *
 * Errors   those of ct_system_load and of the options; E583 if all members fail
 */
CT_API bool ct_vary(struct ct_ctx *ctx, const char *path,
                    const struct ct_system_options *system,
                    const struct ct_vary_options *options, const char *out);

/* ---- pictures ------------------------------------------------------------------------------- */

/** Zero draws the start in the default view. */
struct ct_draw_options {
    size_t size; /* 0, or sizeof (struct ct_draw_options) */
    /** "x", "y", "z" (along an axis) or "iso"; NULL: along the normal of a planar mechanism,
     *  otherwise "iso". */
    const char *view;
    double time; /* [s]; > 0: the configuration at this time of a run is drawn */
    bool trace;  /* draws the start and the paths of points and beam ends over the run */
    struct ct_sim_options run;
    const char *path; /* FILE.svg; NULL: standard output */
    FILE *bar;        /* progress is shown there if it is a terminal */
};

/**
 * Draws a mechanism as a line drawing in SVG: bodies by their shapes, or by lines between their
 * joints, joints by symbols, beams deformed.
 *
 * The same system and options give the same bytes. Errors: E002, E003; those of assembly and of
 * runs.
 */
CT_API bool ct_system_draw(struct ct_ctx *ctx, struct ct_system *sys,
                           const struct ct_draw_options *options);

/** Zero selects the run of the model. */
struct ct_report_options {
    size_t size; /* 0, or sizeof (struct ct_report_options) */
    struct ct_sim_options run;
    const char *path; /* FILE.html; NULL: standard output */
    FILE *bar;        /* progress is shown there if it is a terminal */
    /**
     * The words of the command that makes the page again, without the output file; shown on the
     * page. NULL: none.
     */
    const char *const *command;
    size_t ncommand;
    const struct ct_accuracy *accuracy; /* its work-precision plot is shown; NULL: none */
};

/**
 * Writes a report: a system, its equations and its motion as one HTML file without external
 * resources. docs/report.md describes its contents.
 *
 * The run is always verified. Without an end time the report shows the start. The same system
 * and options give the same bytes, except for the times in a work-precision plot.
 *
 * Errors: E002; E530 if the library was built without pages; those of assembly and of runs.
 */
CT_API bool ct_system_report(struct ct_ctx *ctx, struct ct_system *sys,
                             const struct ct_report_options *options);

struct ct_plot;

/**
 * Creates a plot of outputs over time. Pass ct_plot_row and the plot as `row` and `user` of a run's
 * results, then call ct_plot_write.
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
/** Adds a sample; value as a run passes it. Returns true. */
CT_API bool ct_plot_row(void *plot, double t, const double *value, size_t n);
/** Writes the plot as SVG with one panel for each unit. Errors: E002. */
CT_API bool ct_plot_write(struct ct_ctx *ctx, struct ct_plot *plot, const char *path);

/* ---- what there is -------------------------------------------------------------------------- */

/** Prints the component types with their terminal equations and keys. */
CT_API void ct_components_print(FILE *out);
/** Prints the methods of integration. */
CT_API void ct_methods_print(FILE *out);
/** Prints the JSON Schema (draft 2020-12) of the model file. */
CT_API void ct_schema_print(FILE *out);
/** The same as texts, to be freed by ct_free. */
CT_API char *ct_components_text(void);
CT_API char *ct_methods_text(void);
CT_API char *ct_schema_text(void);

#ifdef __cplusplus
}
#endif

#endif
