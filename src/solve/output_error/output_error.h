// Local error estimate of outputs, from that of states: an output that is a small difference of
// large states needs better ones.
//
//     error of output g   |g(y1 + e) - g(y1)|,   e the error of the states      (8.6)
//
// Controlled are outputs that are functions of time and states, accelerations and reactions among
// them, other than states themselves. Those that are round-off beside what they are made of, such
// as residuals of constraints, are not.
#ifndef CT_SOLVE_OUTPUT_ERROR_OUTPUT_ERROR_H
#define CT_SOLVE_OUTPUT_ERROR_OUTPUT_ERROR_H

#include "solve/output_error/output_sensitivity.h"

struct ct_output_error;

/// Outputs of fewer round-off errors than these do not count.
extern const double ct_output_error_least_size;

/// NULL if there is no output to control. Everything lives in a, the evaluator's arena. shown (of
/// each result): its largest value at samples so far. Evaluations of the equations that outputs
/// take are added to *evaluations. Both must live as long.
struct ct_output_error *ct_output_error_create(struct ct_arena *a, struct ct_partition *s,
                                               const double *shown, long *evaluations);
/// Is output i the total energy, a check of the run?
bool ct_output_error_is_check(const struct ct_equations *e, size_t i);
/// Is output i made of more than time, states and the work put in?
bool ct_output_error_needs_accelerations(const struct ct_equations *e, size_t i);
/// Per speed (nu, arena a): is it an output, and is the coordinate that moves with it? False, all
/// count, where an output is demanding: accelerations and reactions feel every vibration.
bool ct_output_error_find_requested(struct ct_arena *a, const struct ct_equations *e,
                                    const bool **speeds, const bool **places);
/// A new run begins, by this method: nothing is known of the sizes of outputs.
void ct_output_error_start(struct ct_output_error *p, const struct ct_method *method);
/// Root mean square over the outputs of their errors at y (ny) for errors e (ny), where 1 is the
/// tolerance; `states` is the same of the states. As long as outputs are not nearly as bad as
/// those, or the ratio of both is steady, only every eighth or sixteenth step is looked at; else
/// that ratio tells, or 0. Where the method is implicit those that amplify are left to
/// ct_output_error_of_sensitive.
double ct_output_error_of_step(struct ct_output_error *p, double t, const double *y,
                               const double *e, const struct ct_tolerance *tolerance,
                               double states, bool is_implicit);
/// The most that an output, of those that are controlled, changes by for a change e (ny) of y (ny),
/// over its largest value so far. With least > 0 over that if it is more, or over what is expected,
/// and of those that do not amplify errors of states.
double ct_output_error_of_change(struct ct_output_error *p, double t, const double *y,
                                 const double *e, double least);
/// Outputs are expected to become as large as so many `times` what they change by for a change way
/// (ny) of y, until told otherwise.
void ct_output_error_expect_size(struct ct_output_error *p, double t, const double *y,
                                 const double *way, double times);
/// The last step that was looked at is accepted.
void ct_output_error_accept(struct ct_output_error *p);

/// As ct_output_sensitivity_error and ct_output_sensitivity_any, of all outputs that are
/// controlled; states: norm of their error, where 1 is the tolerance.
double ct_output_error_of_sensitive(struct ct_output_error *p, double t, const double *y,
                                    const double *e, const struct ct_tolerance *tolerance,
                                    double states);
bool ct_output_error_has_sensitive(struct ct_output_error *p, double t, const double *y,
                                   const struct ct_tolerance *tolerance);

/// The result, of those that are controlled, with the fewest digits: one round-off of states is
/// *part (out) of its largest value so far; -1, and *part as it was, where steps can be held to
/// `wanted` of all that are larger than `small`.
int ct_output_error_roundoff_limit(struct ct_output_error *p, double t, const double *y,
                                   double wanted, double small, double *part);

// ---- for runs side by side, which evaluate outputs themselves -----------------------------------

/// The outputs of a kind; NULL if there are none, or p is NULL.
const struct ct_controlled_outputs *ct_output_error_outputs(const struct ct_output_error *p,
                                                            enum ct_output_kind kind);

/// Those of them that constraints determine; NULL if they determine none.
struct ct_constrained_output *ct_output_error_constrained(const struct ct_output_error *p,
                                                          enum ct_output_kind kind);

/// What is known of the outputs of a run.
struct ct_output_error_record {
    size_t n;
    enum ct_output_kind kind;
    double *largest,
        *last;     // (n) |g| over the steps that were accepted, at the last one looked at
    bool has_last; // since the last acceptance
    int skip;      // steps that are not looked at
    int between;   // of them, planned at the last look
    int unprobed;  // looks at which round-off is not measured
    const struct ct_output_sensitivity
        *sensitive; // those that amplify do not count; NULL: all do
    struct ct_constrained_output_record
        constrained; // those that constraints determine do not, either
    double ratio;    // of the error of outputs to that of states at the last look; 0: not known
};
/// Of n outputs of this kind; all zero.
struct ct_output_error_record ct_output_error_record(struct ct_arena *a,
                                                     enum ct_output_kind kind, size_t n);
void ct_output_error_clear(struct ct_output_error_record *r);
/// Is this step looked at?
bool ct_output_error_is_due(struct ct_output_error_record *r);
/// If not: their error, as far as it is more than that of the states.
double ct_output_error_extrapolated(const struct ct_output_error_record *r, double states);
/// The error from outputs (n each) at y, at y as ct_output_error_perturbation changes it, and at y
/// + e. probed == at: round-off is not looked at.
double ct_output_error_evaluate(struct ct_output_error_record *r, const double *at,
                                const double *probed, const double *off,
                                const struct ct_tolerance *tolerance, double states);
/// Is there an output that counts, of those at y and at y + e (n each), unless constraints
/// determine it? states: as above.
bool ct_output_error_limits_step(const struct ct_output_error_record *r, const double *at,
                                 const double *off, const struct ct_tolerance *tolerance,
                                 double states);
void ct_output_error_accept_sizes(struct ct_output_error_record *r);
/// State i changed so little that outputs change by round-off only, enlarged by a factor.
static inline double ct_output_error_perturbation(int i)
{
    return i % 2 ? -0x1p-40 : 0x1p-40;
}

#endif
