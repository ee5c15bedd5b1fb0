// What the files of the bench share.
//
//     bench.c          what is measured
//     bench_table.c    lines with goals, and the table of all at the end
//     bench_timing.c   samples of processor time
//     bench_model.c    models, from their files to the start of a run
#ifndef CT_TESTS_BENCH_H
#define CT_TESTS_BENCH_H

#include "formulate/formulate.h"
#include "solve/run/run.h"

#include <cotree/cotree.h>

// ---- bench_table.c ------------------------------------------------------------------------------

void bench_show_goals(void);
void bench_head(const char *name, const char *title);
/// Above the lines of one model. name: what each of them is about; the title says more.
__attribute__((format(printf, 2, 3))) void bench_title(const char *name, const char *fmt, ...);
/// A time [s], and what it should be at most; 0: no goal.
void bench_line(const char *what, double t, double goal);
void bench_size(const char *what, size_t bytes);
void bench_ratio(const char *what, double r, double goal);

// ---- bench_timing.c -----------------------------------------------------------------------------

enum { NSAMPLE = 11, NREPEAT = 3 };

/// Of a sample, at least [s].
extern double bench_sample_seconds;

typedef void (*call_fn)(void *data);

/// Of this thread: those of a library for matrices wait for work by running.
double bench_now(void);
/// Of all threads.
double bench_now_of_all(void);
int bench_compare_doubles(const void *a, const void *b);
/// Seconds per call of each of n functions, sampled in turn.
void bench_measure(const call_fn *f, void *const *data, size_t n, double *t);

// ---- bench_model.c ------------------------------------------------------------------------------

struct subject {
    const char *path;
    enum ct_tree_choice tree; // the cheapest unless it is set
    struct ct_ctx ctx;
    struct ct_model model;
    struct ct_equations equations, assembly;
    struct ct_initial_state start;
    struct ct_run *run;
    struct ct_evaluator *machine;
    double *state;
    double generate,
        prepare; // seconds, from the file to equations; from there to the start of a run
};

// A beam of n elements on a body that turns freely: a pendulum in the plane, in space on a ball
// joint.
struct beam {
    const char *formulation;
    bool is_spatial, is_chain; // chain: n beams of two elements, welded end to end
};

void bench_give_up(const struct subject *s);
void bench_open_arenas(struct ct_ctx *ctx);
void bench_close_arenas(struct ct_ctx *ctx);
bool bench_generate(struct subject *s);
/// Everything up to a machine in a consistent state.
void bench_open_subject_on(struct subject *s, const char *path, enum ct_tree_choice tree);
void bench_open_subject(struct subject *s, const char *path);
void bench_close_subject(struct subject *s);
const char *bench_temporary(void);
/// The file that systems/NAME/generate.sh N writes.
const char *bench_generated(const char *name, int n);
const char *bench_spatial_chain(int n);
const char *bench_planar_chain(int n);
/// Arm of 6 or 7 turning axes with everything a parameter: masses, centres of mass, full inertias,
/// lengths.
const char *bench_arm(int n);
const char *bench_chain_of_beams(const struct beam *k, int n);
const char *bench_beam(const struct beam *k, int n);
const char *bench_shipped(const char *name);

#endif
