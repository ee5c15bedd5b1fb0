// Error control of outputs. The local error of an output in a step follows from the estimated error
// of the states; it can be larger in its tolerance, for example if the output is a small difference
// of large states. Then it limits the step.
//
//     error of output g   |g(y1 + e) - g(y1)|,   e the error of the states      (8.6)
//
// Controlled outputs are functions of time and states, including accelerations and reactions, but
// not single states. Outputs that consist of round-off only, such as residuals of constraints, do
// not count.
#ifndef CT_SOLVE_OUTPUT_ERROR_OUTPUT_ERROR_H
#define CT_SOLVE_OUTPUT_ERROR_OUTPUT_ERROR_H

#include "numeric/roundoff.h"
#include "solve/output_error/output_sensitivity.h"

struct ct_output_error;

/// An output counts only if it is larger than this many of its round-off errors.
extern const double ct_output_error_least_size;

/// NULL if there is no output to control. Everything lives in a, the evaluator's arena. shown
/// (by result): its largest value at samples so far. Evaluations of the equations for outputs
/// are added to *evaluations. Both must live as long.
struct ct_output_error *ct_output_error_create(struct ct_arena *a, struct ct_partition *s,
                                               const double *shown, long *evaluations);
/// Is output i the total energy, a check of the run?
bool ct_output_error_is_check(const struct ct_equations *e, size_t i);
/// Does output i depend on more than time, states and work?
bool ct_output_error_needs_accelerations(const struct ct_equations *e, size_t i);
/// For each speed (nu, arena a): is it an output (speeds), is its coordinate one (places)? False,
/// and all count, if an output contains accelerations or reactions, which depend on every
/// vibration.
bool ct_output_error_find_requested(struct ct_arena *a, const struct ct_equations *e,
                                    const bool **speeds, const bool **places);
/// Reset before a run with this method.
void ct_output_error_start(struct ct_output_error *p, const struct ct_method *method);
/// Root mean square of the errors of the outputs at y (ny) for errors e (ny) of the states, where 1
/// is the tolerance; `states` is the same norm of the states. If outputs err much less than states,
/// or the ratio of both errors is steady, it is computed only in every eighth or sixteenth step; in
/// between the ratio times `states` is returned, or 0. With an implicit method, sensitive outputs
/// are left to ct_output_error_of_sensitive.
double ct_output_error_of_step(struct ct_output_error *p, double t, const double *y,
                               const double *e, const struct ct_tolerance *tolerance,
                               double states, bool is_implicit);
/// The largest relative change of a controlled output for a change e (ny) of y (ny), in parts of
/// the output's largest value so far. With least > 0 the unit is at least `least` and at least the
/// expected size, and sensitive outputs are left out.
double ct_output_error_of_change(struct ct_output_error *p, double t, const double *y,
                                 const double *e, double least);
/// Set the expected size of outputs: `times` their change for the change `change` (ny) of y.
void ct_output_error_expect_size(struct ct_output_error *p, double t, const double *y,
                                 const double *change, double times);
/// The last step whose error was computed is accepted.
void ct_output_error_accept(struct ct_output_error *p);

/// As ct_output_sensitivity_error and ct_output_sensitivity_any, of all outputs that are
/// controlled; states: norm of their error, where 1 is the tolerance.
double ct_output_error_of_sensitive(struct ct_output_error *p, double t, const double *y,
                                    const double *e, const struct ct_tolerance *tolerance,
                                    double states);
bool ct_output_error_has_sensitive(struct ct_output_error *p, double t, const double *y,
                                   const struct ct_tolerance *tolerance);

/// The controlled result with the lowest accuracy: one unit of round-off of states changes it
/// by *part (out) of its largest value so far. -1, and *part unchanged, if all results larger
/// than `small` can be accurate to `wanted`.
int ct_output_error_roundoff_limit(struct ct_output_error *p, double t, const double *y,
                                   double wanted, double small, double *part);

// ---- for batches, which evaluate outputs themselves ---------------------------------------------

/// The outputs of a kind; NULL if there are none, or p is NULL.
const struct ct_controlled_outputs *ct_output_error_outputs(const struct ct_output_error *p,
                                                            enum ct_output_kind kind);

/// Those of them that may be determined by the constraints; NULL if none can.
struct ct_constrained_output *ct_output_error_constrained(const struct ct_output_error *p,
                                                          enum ct_output_kind kind);

/// Record of the outputs of a run.
struct ct_output_error_record {
    size_t n;
    enum ct_output_kind kind;
    double *largest,
        *last;               // (n) largest |g| over accepted steps; |g| at the last evaluation
    bool has_last;           // `last` is newer than the last accepted step
    int skip;                // steps left without an estimate
    int between;             // such steps planned at the last estimate
    int without_measurement; // estimates left without a measurement of round-off
    const struct ct_output_sensitivity
        *sensitive; // its sensitive outputs are not controlled; NULL: all are
    struct ct_constrained_output_record constrained; // constrained outputs are not controlled
    double ratio; // error of outputs over that of states at the last estimate; 0: unknown
};
/// Of n outputs of this kind; all zero.
struct ct_output_error_record ct_output_error_record(struct ct_arena *a,
                                                     enum ct_output_kind kind, size_t n);
void ct_output_error_clear(struct ct_output_error_record *r);
/// Must the error of outputs be estimated in this step?
bool ct_output_error_is_due(struct ct_output_error_record *r);
/// If not: the error of outputs extrapolated from that of the states, 0 if it does not matter.
double ct_output_error_extrapolated(const struct ct_output_error_record *r, double states);
/// The error from the values of outputs (n each) at y, at y with ct_output_error_perturbation, and
/// at y + e. probed == at: round-off is not measured.
double ct_output_error_evaluate(struct ct_output_error_record *r, const double *at,
                                const double *probed, const double *off,
                                const struct ct_tolerance *tolerance, double states);
/// Does an output, with values at y and at y + e (n each), limit the step, unless the constraints
/// determine it? states: as above.
bool ct_output_error_limits_step(const struct ct_output_error_record *r, const double *at,
                                 const double *off, const struct ct_tolerance *tolerance,
                                 double states);
void ct_output_error_accept_sizes(struct ct_output_error_record *r);
/// Relative change of state i by which the round-off of outputs is measured.
static inline double ct_output_error_perturbation(int i)
{
    return i % 2 ? -CT_PERTURBATION : CT_PERTURBATION;
}

#endif
