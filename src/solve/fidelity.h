// The error of a step as outputs feel it: an output that is a small difference of large states needs better ones.
//
//     error of output g   |g(y1 + e) - g(y1)|,   e the error of the states      (8.6)
//
// Controlled are outputs that are functions of time and states, accelerations and reactions among them, other than states themselves.
// Those that are rounding beside what they are made of, such as residuals of constraints, are not.
#ifndef CT_SOLVE_FIDELITY_H
#define CT_SOLVE_FIDELITY_H

#include "solve/amplifier.h"

struct ct_fidelity;

/// Outputs of fewer roundings than these do not count.
extern const double ct_fidelity_least_size;

/// NULL if there is no output to control. Everything lives in a, the machine's arena. shown (of each result): its largest value at
/// samples so far. Evaluations of the equations that outputs take are added to *evaluations. Both must live as long.
struct ct_fidelity *ct_fidelity_create(struct ct_arena *a, struct ct_embed *s,
                                       const double *shown, long *evaluations);
/// Is output i the total energy, a check of the run?
bool ct_fidelity_is_check(const struct ct_equations *e, size_t i);
/// Is it another one that is made of more than time and states?
bool ct_fidelity_is_demanding(const struct ct_equations *e, size_t i);
/// Per speed (nu, arena a): is it an output, and is the coordinate that moves with it? False, all count, where an output is
/// demanding: accelerations and reactions feel every vibration.
bool ct_fidelity_find_asked(struct ct_arena *a, const struct ct_equations *e,
                            const bool **speeds, const bool **places);
/// A new run begins, by this method: nothing is known of the sizes of outputs.
void ct_fidelity_start(struct ct_fidelity *p, const struct ct_method *method);
/// Root mean square over the outputs of their errors at y (ny) for errors e (ny), where 1 is the tolerance; `states` is the
/// same of the states. As long as outputs are not nearly as bad as those, or the ratio of both is steady, only every eighth or
/// sixteenth step is looked at; else that ratio tells, or 0. Where the method is implicit those that amplify are left to
/// ct_fidelity_amplified.
double ct_fidelity_error(struct ct_fidelity *p, double t, const double *y, const double *e,
                         const struct ct_tolerance *tolerance, double states, bool is_implicit);
/// The most that an output, of those that are controlled, changes by for a change e (ny) of y (ny), over its largest value so far. With
/// least > 0 over that if it is more, or over what is expected, and of those that do not amplify errors of states.
double ct_fidelity_felt(struct ct_fidelity *p, double t, const double *y, const double *e,
                        double least);
/// Outputs are expected to become as large as so many `times` what they change by for a change way (ny) of y, until told otherwise.
void ct_fidelity_expect(struct ct_fidelity *p, double t, const double *y, const double *way,
                        double times);
/// The last step that was looked at is accepted.
void ct_fidelity_accept(struct ct_fidelity *p);

/// As ct_amplifier_error and ct_amplifier_any, of all outputs that are controlled; states: norm of their error, where 1 is the tolerance.
double ct_fidelity_amplified(struct ct_fidelity *p, double t, const double *y, const double *e,
                             const struct ct_tolerance *tolerance, double states);
bool ct_fidelity_amplifies(struct ct_fidelity *p, double t, const double *y,
                           const struct ct_tolerance *tolerance);

/// The result, of those that are controlled, with the fewest digits: one rounding of states is *part (out) of its largest value so
/// far; -1, and *part as it was, where steps can be held to `wanted` of all that are larger than `small`.
int ct_fidelity_blunt(struct ct_fidelity *p, double t, const double *y, double wanted,
                      double small, double *part);

// ---- for runs side by side, which evaluate outputs themselves --------------------------------------

/// The outputs of a kind; NULL if there are none, or p is NULL.
const struct ct_outputs *ct_fidelity_outputs(const struct ct_fidelity *p,
                                             enum ct_output_kind kind);

/// Those of them that constraints determine; NULL if they determine none.
struct ct_invariant *ct_fidelity_invariant(const struct ct_fidelity *p,
                                           enum ct_output_kind kind);

/// What is known of the outputs of a run.
struct ct_fidelity_record {
    size_t n;
    enum ct_output_kind kind;
    double *largest,
        *seen;     // (n) |g| over the steps that were accepted, at the last one looked at
    bool has_seen; // since the last acceptance
    int skip;      // steps that are not looked at
    int between;   // of them, planned at the last look
    int unprobed;  // looks at which rounding is not measured
    const struct ct_amplifier *apart;     // those that amplify do not count; NULL: all do
    struct ct_invariant_record invariant; // those that constraints determine do not, either
    double ratio; // of the error of outputs to that of states at the last look; 0: not known
};
/// Of n outputs of this kind; all zero.
struct ct_fidelity_record ct_fidelity_record(struct ct_arena *a, enum ct_output_kind kind,
                                             size_t n);
void ct_fidelity_clear(struct ct_fidelity_record *r);
/// Is this step looked at?
bool ct_fidelity_is_due(struct ct_fidelity_record *r);
/// If not: their error, as far as it is more than that of the states.
double ct_fidelity_foreseen(const struct ct_fidelity_record *r, double states);
/// The error from outputs (n each) at y, at y as ct_fidelity_probe changes it, and at y + e. probed == at: rounding is not
/// looked at.
double ct_fidelity_judge(struct ct_fidelity_record *r, const double *at, const double *probed,
                         const double *off, const struct ct_tolerance *tolerance,
                         double states);
/// Is there an output that counts, of those at y and at y + e (n each), unless constraints determine it? states: as above.
bool ct_fidelity_asks(const struct ct_fidelity_record *r, const double *at, const double *off,
                      const struct ct_tolerance *tolerance, double states);
void ct_fidelity_keep(struct ct_fidelity_record *r);
/// State i changed so little that outputs change by rounding only, enlarged by a factor.
static inline double ct_fidelity_probe(int i)
{
    return i % 2 ? -0x1p-40 : 0x1p-40;
}

#endif
