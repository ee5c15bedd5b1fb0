// Consistent initial conditions: positions and speeds that satisfy all constraints and demanded
// values and are nearest to the guesses.  (formulation 9.1)
//
// Assembly uses equations with trees through joints, in which all joints are measured, whatever
// trees the equations of motion use. So the start does not depend on the choice of trees.
#ifndef CT_SOLVE_INITIAL_ASSEMBLY_H
#define CT_SOLVE_INITIAL_ASSEMBLY_H

#include "solve/evaluator/evaluator.h"

/// What the model asks of a coordinate's value or speed.
struct ct_target {
    bool is_given;   // a demand: must be met
    bool is_guessed; // a guess
    bool wanted;  // counts in the distance: guesses, and with little weight values without one
    double value; // demanded or guessed, else 0
    // weight of a deviation [1/rad or 1/m]: for a guess 1 rad or one natural length counts 1
    double weight;
    bool in_quaternion;
};

/// Start values of every coordinate of joints and bodies, by number of coordinate
/// (eqs->coordinate).
struct ct_initial_state {
    double *q, *u;
    const bool *is_given; // (n) the value is demanded, not guessed or open
    const struct ct_target *q_target, *u_target; // (n) what was asked of q and u
    double length;                               // natural length of the mechanism [m]
    const struct ct_equations *e;                // of the assembly
    size_t n;
    double residual;      // largest |phi|
    bool is_inexact;      // loops close only to the tolerance of the data, by least squares
    size_t freedoms;      // then: degrees of freedom of the loops, without those of beams
    bool is_open;         // loops do not close: values are as wanted
    double *elastic;      // elastic coordinates of all beams, beam by beam; NULL: undeformed
    double *elastic_rate; // their rates; NULL: as `initial` of the beams says
    size_t nelastic;
};

/// Find the start at t = 0. e: equations made with measure_all for trees through joints.
/// Errors: CT_E_ASSEMBLY when the loops do not close, CT_E_START when given values contradict.
bool ct_assembly_solve(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
                       const struct ct_equations *e, struct ct_initial_state *out);

/// The same, but loops need not close. Then the start is open, and at rest but for given speeds;
/// beams are bent later to close them.
bool ct_assembly_solve_open(struct ct_ctx *ctx, struct ct_arena *a,
                            const struct ct_model *model, const struct ct_equations *e,
                            struct ct_initial_state *out);

/// The same in two parts, for one start after another while the values of the model's parameters
/// change. The arrays of `out` are the assembly's and good until the next start.
struct ct_assembly;
struct ct_assembly *ct_assembly_create(struct ct_ctx *ctx, struct ct_arena *a,
                                       const struct ct_model *model,
                                       const struct ct_equations *e);
bool ct_assembly_find(struct ct_assembly *s, struct ct_initial_state *out);

/// Elastic coordinates q and speeds u (NULL: not wanted) of the beams whose `initial` gives a
/// shape, with the values of the model's parameters.
void ct_initial_state_of_beams(const struct ct_equations *e, const double *value, double *q,
                               double *u);

/// Does the start have the demanded values and speeds? Initial equilibrium of beams may have moved
/// joints.
/// Errors: CT_E_START.
bool ct_start_meets_demands(struct ct_ctx *ctx, const struct ct_initial_state *start);

/// Has the start's state (nq + nu) of equations of motion e changed by more than a demand may?
bool ct_start_has_moved(const struct ct_equations *e, const struct ct_initial_state *start,
                        const double *before, const double *after);
/// Does the state `after` keep what is demanded? before (nq + nu): the start in the state of
/// equations of motion e; after: the same on their constraints. Speeds count where with_speeds.
/// Costs nothing where the two are the same but for round-off. Errors: CT_E_START.
bool ct_start_is_kept(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
                      const struct ct_equations *e, const struct ct_initial_state *start,
                      const double *before, const double *after, bool with_speeds);

/// Is coordinate i of the start a length? Else it is an angle or part of an orientation.
bool ct_start_is_length(const struct ct_initial_state *start, size_t i);
/// A value as messages show it: round-off is 0.
double ct_start_shown(double value);

/// Put a start into the state y (q, u, work) of an evaluator; memories of angles start at the
/// values.
void ct_initial_state_apply(const struct ct_initial_state *s, struct ct_evaluator *m,
                            double *y);

/// After the mechanism did not assemble: a note that names the one joint whose axis keeps it from
/// moving in a plane, if there is one.  (misaligned_joint.c)
void ct_note_misaligned_joint(struct ct_ctx *ctx, struct ct_arena *a,
                              const struct ct_model *model);

#endif
