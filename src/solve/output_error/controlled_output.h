// Evaluation of controlled outputs g. There are two kinds: functions of time and states, and
// functions that also contain accelerations or multipliers, which must be solved for first.
//
//     g(t, q, u)   or   g(t, q, u, u', lam) with u', lam of (6.1) at (t, q, u)     (8.36)
#ifndef CT_SOLVE_OUTPUT_ERROR_CONTROLLED_OUTPUT_H
#define CT_SOLVE_OUTPUT_ERROR_CONTROLLED_OUTPUT_H

#include "integrate/problem.h"
#include "solve/constraint/partition.h"

enum ct_output_kind { CT_OUTPUTS_OF_STATES, CT_OUTPUTS_OF_SOLUTIONS, CT_OUTPUT_KINDS };

/// Error of outputs at the end of a run, in tolerances.
/// Definition: of what docs/accuracy.md promises.
#define CT_PROMISED_ERROR 10

/// The error of an output does not matter if, in tolerances, it is at most this part of that of the
/// states. Default: time of estimates and tests against errors of outputs. Test: output_error
#define CT_NEGLIGIBLE_RATIO 0.25

/// An output need not be more accurate than this many round-off errors. Derived: the difference
/// of two values, which its error is, has the round-off of both.
#define CT_FEWEST_ROUNDOFF_ERRORS 2

/// The outputs of one kind.
struct ct_controlled_outputs {
    struct ct_partition *s;
    struct ct_program program; // g of the evaluator's input
    size_t n;                  // of them
    enum ct_output_kind kind;
    bool needs_lam;
    long *evaluations; // counter of evaluations of the equations
};

/// Is an output a check of the run, the total energy or a residual of the constraints? Checks are
/// not controlled: as small differences of large terms they would need very short steps.
bool ct_controlled_outputs_is_check(const struct ct_equations *e, ct_ex v);
/// The kind of an output; CT_OUTPUT_KINDS if it is not controlled. These are single states, whose
/// error is controlled anyway, outputs that depend on no state, work, and checks.
enum ct_output_kind ct_controlled_outputs_kind(const struct ct_equations *e, ct_ex v);
/// Of the values g (n) of the equations, all of this kind. Everything lives in a, the evaluator's
/// arena; evaluations must live as long.
void ct_controlled_outputs_create(struct ct_arena *a, struct ct_partition *s,
                                  enum ct_output_kind kind, const ct_ex *g, size_t n,
                                  long *evaluations, struct ct_controlled_outputs *o);
/// g (n), good until the next call; the evaluator's input is t, y (ny) then. NaN where
/// accelerations cannot be found.
const double *ct_controlled_outputs_at(struct ct_controlled_outputs *o, double t,
                                       const double *y);
/// The tolerance of these outputs in a step, from that of the states: for accelerations and
/// reactions the promised error, as their errors do not accumulate over the steps.
struct ct_tolerance ct_controlled_outputs_tolerance(enum ct_output_kind kind,
                                                    const struct ct_tolerance *states);

#endif
