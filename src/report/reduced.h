// Prepares the reduced equations for reading: collects short expressions and introduces
// definitions for repeated ones.
//
//     matrix form      sum over j of M[i][j] u'[j]  =  Q[i] + sum over r of J[r][i] lam[r]
//     recursive form   cutset[i]  =  effort[i]
//
// In the recursive form the cutset of each branch is projected on its motion and contains all
// accelerations and multipliers (formulation 5.3). Its definitions are the recursion:
// accelerations from the ground outwards, forces and torques from the leaves inwards. The
// number of definitions grows linearly with the number of bodies, while M has entries for all
// pairs of speeds along a chain.
//
// What always holds: each expression equals the member of the same name in struct ct_equations
// up to round-off.
#ifndef CT_REPORT_REDUCED_H
#define CT_REPORT_REDUCED_H

#include "formulate/dynamics/dynamics.h"

struct ct_reduced_definition {
    ct_ex symbol; // of kind LOCAL
    ct_ex value;  // may use symbols of earlier definitions
    ct_ex full;   // the expression that it names, without definitions
};

struct ct_definitions {
    struct ct_reduced_definition *at;
    size_t n;
};

struct ct_reduced {
    bool is_recursive;
    ct_ex *M;         // matrix form: nM values in the order of ct_equations.M
    ct_ex *cutset;    // recursive form: nu
    ct_ex *J;         // nJ
    ct_ex *Q;         // nu; recursive form: the efforts
    ct_ex *phi, *gam; // nrow
    ct_ex *effort;    // ndriver: of the drivers of branches, in terms of u' and lam
    ct_ex *rate;      // nq: q' in terms of u
    // nresult: outputs whose terms are listed, 0 for others (provenance.h); NULL: none is listed
    ct_ex *output;
    bool is_collected;
    struct ct_definitions definitions; // none if everything is short
    size_t npart;                      // of these, the first: parts of beams (beam_parts.h)
    double size; // approximate size of the print in characters; set with the definitions
};

/// Derives the recursive form with its definitions.
void ct_reduced_recur(struct ct_arena *a, struct ct_equations *e, struct ct_reduced *r);

/// Derives the matrix form; collects it if allowed and the system is small enough. Without
/// definitions.
void ct_reduced_prepare(struct ct_arena *a, struct ct_equations *e, bool may_collect,
                        struct ct_reduced *r);
/// Collects all its expressions (ct_reduced_collect).
void ct_reduced_collect_all(struct ct_arena *a, struct ct_equations *e, struct ct_reduced *r);

/// Collects a force such as Q: terms at rest stay apart from terms of the speeds.
ct_ex ct_reduced_collect_force(struct ct_equations *e, struct ct_arena *a, ct_ex v);
/// Collects n expressions in place. False, without a change, if they are too large together or
/// a rotation is a quaternion, which would be expanded.
bool ct_reduced_collect(struct ct_arena *a, struct ct_equations *e, ct_ex *const *where,
                        size_t n);

/// Introduces definitions for repeated subexpressions; the expressions then use their symbols.
void ct_reduced_share(struct ct_arena *a, struct ct_equations *e, struct ct_reduced *r);

/// The same for n expressions, replaced in place. size: approximate size of the print in
/// characters. names_first: a labelled expression gets a definition wherever it is used twice.
struct ct_definitions ct_definitions_find(struct ct_arena *a, struct ct_equations *e,
                                          ct_ex *const *where, size_t n, bool names_first,
                                          double *size);

/// Number of operators and operands in a full print of e, counted up to `most`. Cost O(most).
double ct_reduced_size(const struct ct_exs *x, ct_ex e, double most);

/// Left and right side of the equation of speed i; of constraint row r: J u' and -gam.
ct_ex ct_reduced_left(struct ct_equations *e, const struct ct_reduced *r, size_t i);
ct_ex ct_reduced_right(struct ct_equations *e, const struct ct_reduced *r, size_t i);
ct_ex ct_reduced_row_left(struct ct_equations *e, const struct ct_reduced *r, size_t row);

/// Names for the quantities of the recursion, by their frames, as labels of the store:
///
///     phi_rod, c_rod, s_rod   angle of rod about a fixed axis, its cosine and sine
///     R_rod.xy                rotation of rod
///     w_rod.z, al_rod.z       angular velocity; angular acceleration with all u' = 0
///     d_pin.x, v_pin.x, a_pin.x   vector from the previous joint to pin; its rates with all u' = 0
///     F_pin.x, T_rod.x        force and torque that the branch must supply, with all u' = 0
///
/// At CT_FULL they are those of the recursive form, with the symbols u'. There a is the
/// acceleration minus gravity, and F is the force on everything outboard of pin except m*a. Lumped
/// quantities have names, too:
///
///     m_pin, h_rod.x, I_rod.zz    mass outboard of pin; first moment, inertia of the augmented body
void ct_reduced_label(struct ct_equations *e, enum ct_level level);

#endif
