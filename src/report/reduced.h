// The reduced equations prepared for reading: collected where that pays, shared where it must be.
//
//     matrix form      sum over j of M[i][j] u'[j]  =  Q[i] + sum over r of J[r][i] lam[r]
//     recursive form   cutset[i]  =  effort[i]
//
// The recursive form has the cutset of each branch projected on its motion, with all accelerations and multipliers in
// it, as the full sweep of the dynamics makes it (formulation 5.3). Its definitions are the recursion: accelerations
// from ground outwards, forces and torques from the leaves inwards. Their number grows as that of the bodies, where M
// has entries for all pairs of speeds along a chain.
//
// What always holds: each expression equals its namesake in struct ct_equations up to round-off.
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
    ct_ex *
        output; // nresult: outputs whose terms are listed, 0 for others (provenance.h); else NULL
    bool is_collected;
    struct ct_definitions definitions; // none if everything is short
    size_t npart;                      // of these, the first: parts of beams (beam_parts.h)
    double size; // of the whole print in characters, about; known once there are definitions
};

/// The recursive form with its definitions.
void ct_reduced_recur(struct ct_arena *a, struct ct_equations *e, struct ct_reduced *r);

/// The matrix form: collect if allowed and the system is small enough. No definitions yet.
void ct_reduced_prepare(struct ct_arena *a, struct ct_equations *e, bool may_collect,
                        struct ct_reduced *r);
/// Collects what it holds (ct_reduced_collect).
void ct_reduced_collect_all(struct ct_arena *a, struct ct_equations *e, struct ct_reduced *r);

/// A force collected, as Q is: what is there at rest stays apart from what the speeds add.
ct_ex ct_reduced_collect_force(struct ct_equations *e, struct ct_arena *a, ct_ex v);
/// Collects n expressions in place, forces and others, if they are small enough together and no rotation is a
/// quaternion: that would be multiplied out. false: they stay.
bool ct_reduced_collect(struct ct_arena *a, struct ct_equations *e, ct_ex *const *where,
                        size_t n);

/// Names for what is written more than once: the expressions then use the symbols of definitions.
void ct_reduced_share(struct ct_arena *a, struct ct_equations *e, struct ct_reduced *r);

/// The same for n expressions, which are replaced in place; size: of the whole print in characters, about.
/// names_first: what has a name by meaning is defined wherever it is used twice.
struct ct_definitions ct_definitions_find(struct ct_arena *a, struct ct_equations *e,
                                          ct_ex *const *where, size_t n, bool names_first,
                                          double *size);

/// Operators and operands that a full print of e shows, counted up to `most`. Cost O(most).
double ct_reduced_size(const struct ct_exs *x, ct_ex e, double most);

/// Left and right side of the equation of speed i; of row r: J u' and -gam.
ct_ex ct_reduced_left(struct ct_equations *e, const struct ct_reduced *r, size_t i);
ct_ex ct_reduced_right(struct ct_equations *e, const struct ct_reduced *r, size_t i);
ct_ex ct_reduced_row_left(struct ct_equations *e, const struct ct_reduced *r, size_t row);

/// Names for what the recursion computes, by the frames it belongs to, as labels of the store:
///
///     phi_rod, c_rod, s_rod   angle of rod about a fixed axis, its cosine and sine
///     R_rod.xy                rotation of rod
///     w_rod.z, al_rod.z       angular velocity; angular acceleration with all u' = 0
///     d_pin.x, v_pin.x, a_pin.x   vector from the previous joint to pin; its rates with all u' = 0
///     F_pin.x, T_rod.x        force and torque that the branch must supply, with all u' = 0
///
/// At CT_FULL these are those of the recursive form, with the symbols u'. There a is less gravity, and F is the force
/// that all outboard of pin needs beyond m*a. What is lumped has names, too:
///
///     m_pin, h_rod.x, I_rod.zz    mass outboard of pin; first moment and inertia of rod with what hangs on it
void ct_reduced_label(struct ct_equations *e, enum ct_level level);

#endif
