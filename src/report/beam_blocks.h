// Equations of motion with the elastic coordinates of each beam as one vector, in the form of
// liang2017 (4.11).
//
//     rod.x:  m*rod.x'' - ... + (m_rf_rod.x*cos(a) - m_rf_rod.y*sin(a))*q_rod'' = ...
//     q_rod:  m_rf_rod.x'*(rod.x''*cos(a) + ...) + m_thetaf_rod.z'*a'' + m_ff_rod*q_rod''
//             = Q_vf_rod - V_q_rod + Q_rod
//             Q_rod.2.u = sin(a)*lambda(guide.across)
//
// q_rod is a column; m_rf_rod.x is the row whose entries beam_parts.h calls m_rf_rod.1.u.x and
// so on. Q_rod contains the generalised forces of joints, loads and outboard bodies; entries
// that are not listed are zero. What always holds: after substitution of the entries, row k of
// q_rod is the equation of coordinate k.
#ifndef CT_REPORT_BEAM_BLOCKS_H
#define CT_REPORT_BEAM_BLOCKS_H

#include "report/beam_parts.h"

/// Vectors and matrices of one beam, as symbols.
struct ct_beam_block {
    const struct ct_flexible *f;    // NULL: its coordinates are listed one by one
    ct_ex m_rf[3], m_thetaf[3];     // rows m_rf, m_thetaf by axis of the beam
    ct_ex m_rf_t[3], m_thetaf_t[3]; // their transposes
    ct_ex acceleration;             // q''
    ct_ex inertia;                  // m_ff*q''
    ct_ex velocity, elastic;        // Q_vf; V_q, or K_f*q where that is linear
    ct_ex applied;                  // Q; zero if no force acts
};

/// A coefficient times an acceleration or a multiplier.
struct ct_block_term {
    ct_ex coef, of;
};

/// An equation: sum of left terms = right + sum of right terms.
struct ct_block_row {
    const char *label; // NULL: a line below a block
    ct_ex symbol;      // its left side in that case
    int beam;          // beam of a block and of the lines below it; -1: none
    int coordinate;    // of such a line: index among the coordinates of the beam; -1: none
    struct ct_block_term *left, *right_term;
    size_t nleft, left_cap, nright, right_cap;
    ct_ex right;
};

struct ct_beam_blocks {
    const struct ct_beam_parts *parts;
    struct ct_beam_block *block; // by beam
    struct ct_block_row *row;
    size_t n, cap;
    struct ct_definitions definitions;
};

/// Derives the equations with blocks for the beams whose parts are known. False: there is none.
bool ct_beam_blocks_derive(struct ct_arena *a, struct ct_equations *e,
                           const struct ct_beam_parts *parts, struct ct_reduced *r,
                           struct ct_beam_blocks *out);
/// Left and right side of an equation.
ct_ex ct_block_left(struct ct_exs *x, const struct ct_block_row *r);
ct_ex ct_block_right(struct ct_exs *x, const struct ct_block_row *r);

#endif
