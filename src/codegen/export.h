// Export of a model as self-contained C source.
//
//     NAME.h  NAME.c     programs, their layout, accelerations, projection, steps; C99 and libm
//                        (export.c, export_runtime.c)
//     NAME_test.c        compares with expected values and an expected motion; shows the calls
//                        (export_test.c)
//
// What always holds: the same equations give the same text. The code has no globals but constant
// tables, and no memory but that of the caller and automatic arrays. It compiles without warnings,
// and its functions are short enough for compilers (c.h).
#ifndef CT_CODEGEN_EXPORT_H
#define CT_CODEGEN_EXPORT_H

#include "expr/listing.h"
#include "formulate/equations.h"

/// A number of `in` or `out` by name.
struct ct_export_item {
    const char *name, *unit; // SI; NULL: not known
    size_t index;            // in its array
    double value;            // at the start
    bool is_derived;         // parameters: from others, by NAME_parameters
    bool is_fixed; // parameters: it determined the structure of the equations and cannot change
    bool is_open;  // reactions: indeterminate in the model
};

struct ct_export_items {
    struct ct_export_item *item;
    size_t n;
};

/// Expected values at one input, for the self-test.
struct ct_export_state {
    const double *input;
    const double *motion, *constraint, *a, *lam; // programs; u' (nu), multipliers (nrow)
    const double *output, *root, *reaction;
    const double *raw,
        *parameter; // values of parameters, and all of them where derived ones follow from these
};

/// Expected motion from the start: q, u and the switches at equally spaced times.
struct ct_export_motion {
    double duration;
    long nstep;     // calls of NAME_step between two samples
    size_t nsample; // 0: no motion is known
    double *y;      // (nsample x (nq + nu))
    // of each number, relative to the largest value of its coordinate or speed
    double tolerance;
};

struct ct_export {
    const char *name;  // C identifier, prefix of all that is public
    const char *title; // of the model
    const struct ct_equations *e;
    // motion: M, Q, J, gam, q'; constraint: phi, v, J; parameter: all parameters; root: switching
    // function g of each switch; memory: next values; power: power supplied, or none; jump: time
    // and rate of each driver, then dT/du, then T. All inputs have one layout.
    const struct ct_listing *motion, *constraint, *parameter, *output, *root, *memory, *power,
        *jump, *reaction;
    // u', q', nfree pivots that must be positive and npivot pivots with |pivot| scale > weakest.
    // Where these conditions fail, accelerations follow from the motion program. NULL: always
    const struct ct_listing *solved;
    size_t nfree, npivot;
    const double *scale;
    double weakest;
    size_t rank;    // of the constraints
    const int *row; // independent rows if some are redundant (rank)
    size_t at_q, at_u, at_a, at_lam, at_switch, at_memory, at_work, ninput;
    struct ct_export_items parameters, inputs, coordinates, speeds, states, outputs, reactions;
    bool needs_a, needs_lam; // outputs depend on u', on multipliers
    bool power_needs_lam;    // the power depends on multipliers
    const bool *left_out;    // inexact data: rows that are ignored; NULL: none
    const double *open;      // inexact data: residual of the rows at the start
    const double *knot;      // times where linear tables have kinks, ascending
    size_t nknot;
    const struct ct_export_state *state; // states to compare; the first is the start
    size_t nstate;
    struct ct_export_motion run;
    double closed;  // residual at which constraints count as satisfied
    unsigned lanes; // > 1: motion and constraint also for this number of inputs at once
};

/// Doubles of work that the functions need.
size_t ct_export_work(const struct ct_export *x);

/// The texts of the files; they live in a.
const char *ct_export_header(struct ct_arena *a, const struct ct_export *x);
const char *ct_export_source(struct ct_arena *a, const struct ct_export *x);
const char *ct_export_test(struct ct_arena *a, const struct ct_export *x);

/// Additional source of an FMU.
struct ct_export_fmu {
    int version;       // of FMI: 2 or 3
    const char *token; // guid of 2.0, instantiation token of 3.0
    double tolerance;  // default tolerance of co-simulation
    double share;      // part of the tolerance allowed per step
    // directional derivatives by a direction in seeds after the input, number i for input i: of M
    // u' - Q - J' lam, J u' + gam and q' with u', lam held, or of q' and u' themselves if
    // is_direct; of outputs, roots and the power
    bool is_direct;
    const struct ct_listing *along, *along_outputs;
};

/// fmu.c, which includes NAME.c.
const char *ct_export_fmu(struct ct_arena *a, const struct ct_export *x,
                          const struct ct_export_fmu *f);
/// Types, and functions, of a version of FMI, for fmu.c.
struct ct_export_text;

/// Must steps locate switches or kinks?
bool ct_export_has_events(const struct ct_export *x);
/// Does a parameter follow from others?
bool ct_export_has_derived(const struct ct_export *x);
struct ct_export_text;
/// Print the functions that depend on the model only through sizes: solving, projecting, stepping.
void ct_export_runtime(struct ct_export_text *t, const struct ct_export *x);
/// Print the function next_stop: time of the next of nknot kinks of tables, or the end.
void ct_export_put_next_stop(struct ct_export_text *t, size_t nknot);

#endif
