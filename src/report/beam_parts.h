// Named parts of the matrices of beams, so that equations of motion are printed as sums of
// them.
//
//     s_rod.x             first moment of rod in its own axes                          (A.3)
//     i_rod.zz            entry of m_thetatheta                                        (A.8)
//     m_rf_rod.1.u.x      of the coordinate rod.1.u: row of A'*m_rf, of m_thetaf       (A.7), (A.15)
//     m_ff_rod.1.v.1.u    entry of m_ff                                                (A.17)
//     Q_vf_rod.1.u        quadratic velocity force                                     (3.87)
//     F_v_rod.x, T_v_rod.z    force and torque of the motion relative to the frame, u' = 0;
//                         with w x (w x s) and w x i w: minus Q_vr and Q_vtheta        (3.87)
//     om_rod.x            angular velocity of the frame in its own axes, as are forces and torques
//     V_q_rod.1.u         derivative of the strain energy, and damping; K_f q_f if linear  (4.11)
//
// stage_beam_matrices.c prints them with the equation numbers of liang2017. What always holds:
// with the definitions of the parts substituted an equation equals the one without them, up to
// round-off.
#ifndef CT_REPORT_BEAM_PARTS_H
#define CT_REPORT_BEAM_PARTS_H

#include "report/reduced.h"

struct ct_inertia;

struct ct_beam_parts {
    struct ct_definitions definitions;
    ct_ex *node, *symbol; // named nodes of the equations and their symbols
    size_t n, node_cap, symbol_cap, definition_cap;
    ct_ex angular_velocity[3],
        angular_velocity_full[3]; // symbols om of the current beam, and their values
    int nangular_velocity;
    // by beam: its named inertia integrals, NULL if it has none; NULL: not requested
    struct ct_inertia **inertia;
};

/// Whether to include parts that are too long to print without definitions.
enum ct_long_parts { CT_LONG_PARTS_NONE, CT_LONG_PARTS_TOO };

/// Derives the parts of all beams, except those with more than 12 elastic coordinates or with
/// varying sections. Nodes live in e->x, lists in a.
void ct_beam_parts_derive(struct ct_arena *a, struct ct_equations *e, enum ct_long_parts which,
                          struct ct_beam_parts *p);
/// Adds the parts of beam number i; false if it has none.
bool ct_beam_parts_add(struct ct_arena *a, struct ct_equations *e, size_t i,
                       enum ct_long_parts which, struct ct_beam_parts *p);
/// Does a beam have parts that are not too long?
bool ct_beam_parts_exist(const struct ct_equations *e);
/// Are definitions too long to print without further definitions?
bool ct_beam_parts_are_long(const struct ct_exs *x, const struct ct_definitions *list);
/// The name of a node; the node itself if it has no name.
ct_ex ct_beam_parts_name(const struct ct_beam_parts *p, ct_ex node);

/// Mass matrix (lower triangle), forces, and efforts of drivers of branches, with the integrals
/// of beams by name.
struct ct_named_dynamics {
    struct ct_entry *M;
    size_t nM;
    ct_ex *Q;      // nu
    ct_ex *effort; // ndriver
};
/// Derives them from the kinematics of e; inertia: by beam, NULL for the engine's own
/// integrals.
void ct_named_dynamics_derive(struct ct_arena *a, const struct ct_equations *e,
                              struct ct_inertia *const *inertia, struct ct_named_dynamics *out);
/// Creates integrals for n elastic coordinates, all zero.
struct ct_named_inertia *ct_named_inertia_create(struct ct_arena *a, size_t n);

#endif
