// Consistent initial conditions: positions and speeds that satisfy all constraints and demanded
// values and are nearest to the guesses.  (formulation 9.1)
//
// Assembly uses equations with trees through joints, in which all joints are measured, whatever
// trees the equations of motion use. So the start does not depend on the choice of trees.
#ifndef CT_SOLVE_INITIAL_ASSEMBLY_H
#define CT_SOLVE_INITIAL_ASSEMBLY_H

#include "solve/evaluator/evaluator.h"

/// Demand on, or guess of, the value or the speed of a coordinate.
struct ct_target {
    bool is_given;   // a demand: must be met
    bool is_guessed; // a guess
    // counts in the distance to be minimised: guesses, and with a small weight coordinates without
    bool wanted;
    double value;  // demanded or guessed, else 0
    double weight; // of a deviation [1/rad or 1/m]: 1 per rad or natural length for a guess
    bool in_quaternion;
};

/// Start values of every coordinate of joints and bodies, by number of coordinate
/// (eqs->coordinate).
struct ct_initial_state {
    double *q, *u;
    const bool *is_given;                        // (n) the value is demanded
    const struct ct_target *q_target, *u_target; // (n) demands and guesses
    double length;                               // natural length of the mechanism [m]
    const struct ct_equations *e;                // the assembly's
    size_t n;
    double residual;      // largest |phi|
    bool is_inexact;      // loops close only to the tolerance of the data, by least squares
    size_t freedoms;      // degrees of freedom, without those of beams, if is_inexact
    bool is_open;         // loops do not close: q and u are the targets
    double *elastic;      // elastic coordinates of all beams, beam by beam; NULL: undeformed
    double *elastic_rate; // their rates; NULL: those of the beams' `initial`
    size_t nelastic;
};

/// Find the initial conditions at t = 0. e: equations made with measure_all for trees through
/// joints.
/// Errors: CT_E_ASSEMBLY when the loops do not close, CT_E_START when demanded values
/// contradict.
bool ct_assembly_solve(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
                       const struct ct_equations *e, struct ct_initial_state *out);

/// The same, but loops need not close. If they do not, the state is open and all speeds are
/// zero but demanded ones; the initial equilibrium of beams closes the loops.
bool ct_assembly_solve_open(struct ct_ctx *ctx, struct ct_arena *a,
                            const struct ct_model *model, const struct ct_equations *e,
                            struct ct_initial_state *out);

/// The same in two parts, for repeated assembly with other values of the model's parameters.
/// `out` points to arrays of the assembly, valid until the next call.
struct ct_assembly;
struct ct_assembly *ct_assembly_create(struct ct_ctx *ctx, struct ct_arena *a,
                                       const struct ct_model *model,
                                       const struct ct_equations *e);
bool ct_assembly_find(struct ct_assembly *s, struct ct_initial_state *out);

/// Elastic coordinates q and speeds u (NULL: not wanted) of the beams whose `initial` gives a
/// shape, for the present values of the model's parameters.
void ct_initial_state_of_beams(const struct ct_equations *e, const double *value, double *q,
                               double *u);

/// Do the initial conditions have the demanded values and speeds? The initial equilibrium of
/// beams may have moved joints.
/// Errors: CT_E_START.
bool ct_start_meets_demands(struct ct_ctx *ctx, const struct ct_initial_state *start);

/// Has the initial state (nq + nu) of equations of motion e changed by more than the tolerance
/// of demanded values?
bool ct_start_has_moved(const struct ct_equations *e, const struct ct_initial_state *start,
                        const double *before, const double *after);
/// Does the state `after` keep the demanded values? before (nq + nu): initial state for the
/// equations of motion e; after: the same projected onto their constraints. Speeds count where
/// with_speeds. Returns at once where both are equal to round-off. Errors: CT_E_START.
bool ct_start_is_kept(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
                      const struct ct_equations *e, const struct ct_initial_state *start,
                      const double *before, const double *after, bool with_speeds);

/// Is coordinate i a length? Otherwise it is an angle or part of a quaternion.
bool ct_start_is_length(const struct ct_initial_state *start, size_t i);
/// A value as shown in messages: round-off is shown as 0.
double ct_start_shown(double value);

/// Set the state y (q, u, work) of an evaluator and its memory of angles from the initial
/// conditions.
void ct_initial_state_apply(const struct ct_initial_state *s, struct ct_evaluator *m,
                            double *y);

/// After an assembly that failed: a note that names the joint whose axis is not normal to the
/// plane in which all other joints move, if there is exactly one.  (misaligned_joint.c)
void ct_note_misaligned_joint(struct ct_ctx *ctx, struct ct_arena *a,
                              const struct ct_model *model);

#endif
