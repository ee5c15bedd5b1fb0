// Fields of a beam element as coefficients of Legendre polynomials P_k(2 xi - 1) instead of values
// at points. Integrals over the element are sums of a few products then: int P_j P_k dx = h/(2k +
// 1) if j = k, else 0.
//
//     v  = v_0 + v_1 P_1 + v_2 (h/12) P_2 + v_3 (h/20) P_3
//     dv/dx = s_0/h + s_1 P_1/2 + s_2 P_2/2
//     u  = u_0 + u_1 P_1 + u_2 (h/12) P_2 + u_3 (h/20) P_3 + u_4 (3h/280) P_4 + u_5 (h/140) P_5
//
// with, for four dofs (v1, alpha1, v2, alpha2) of a cubic element,
//
//     s_0 = v2 - v1                   s_1 = v_2 = alpha2 - alpha1
//     s_2 = v_3 = alpha1 + alpha2 - 2 s_0/h
//     v_0 = (v1 + v2)/2 - h s_1/12    v_1 = s_0/2 - h s_2/20
//
// (a linear one: s_1 = s_2 = 0). By the products D_ij = s_i s_j, D_ii = s_i^2/2, summed over both
// planes, the foreshortening by bending is
//
//     S(xi) = 1/2 int (v'^2 + w'^2) dx,   S(1) = D_00/h + h (D_11/12 + D_22/20)
//
// LOCAL positions contain xi S(1) - S(xi), whose coefficients are
//
//     0: D_01/12 + h/60 D_12        1: D_02/20 + h/60 D_11 + h/140 D_22
//     2: -D_01/h - D_12/14          3: -D_02/h - D_11/3            4: -D_12      5: -D_22
//
// CHAIN subtracts S(1)/2 from 0 and 1.
#ifndef CT_FORMULATE_BEAM_LEGENDRE_H
#define CT_FORMULATE_BEAM_LEGENDRE_H

#include "formulate/beam/flexible_body.h"

/// Definition: polynomials of the slope, the deflection and the axial displacement.
enum { CT_LEGENDRE_SLOPES = 3, CT_LEGENDRE_DEFLECTIONS = 4, CT_LEGENDRE_AXIAL = 6 };

/// One plane of bending: displacements, rates or accelerations, or forces that do work on them.
struct ct_legendre_bending {
    ct_ex slope[CT_LEGENDRE_SLOPES], deflection[CT_LEGENDRE_DEFLECTIONS];
    // of the section: turn_0 + turn_1 P_1/2 + turn_2 P_2/2; the slope in a cubic element
    ct_ex rotation[CT_LEGENDRE_SLOPES];
};

/// The coefficients for four dofs.
struct ct_legendre_bending ct_legendre_bending_of(struct ct_exs *x, enum ct_beam_theory theory,
                                                  ct_ex h, const ct_ex *dof);
/// Forces on the four dofs from forces on the coefficients: the transpose.
void ct_legendre_bending_add_forces(struct ct_exs *x, enum ct_beam_theory theory, ct_ex h,
                                    const struct ct_legendre_bending *force, ct_ex *dof);

/// Products over both planes.
struct ct_foreshortening_products {
    ct_ex s00, s11, s22, s01, s02, s12;
};
/// D of the slopes s; its rates with t = s', and second derivatives with t = s''.
struct ct_foreshortening_products
ct_foreshortening_products_of(struct ct_exs *x, const struct ct_legendre_bending s[2]);
struct ct_foreshortening_products
ct_foreshortening_products_rate(struct ct_exs *x, const struct ct_legendre_bending s[2],
                                const struct ct_legendre_bending t[2]);
/// Adds the forces on s from forces on D.
void ct_foreshortening_products_add_forces(struct ct_exs *x,
                                           const struct ct_legendre_bending *s,
                                           const struct ct_foreshortening_products *force,
                                           struct ct_legendre_bending *out);

/// S(1)
ct_ex ct_foreshortening_total(struct ct_exs *x, ct_ex h,
                              const struct ct_foreshortening_products *d);
/// Forces on D from a force on S(1).
struct ct_foreshortening_products ct_foreshortening_total_forces(struct ct_exs *x, ct_ex h,
                                                                 ct_ex force);
/// Adds the coefficients (CT_LEGENDRE_AXIAL) of xi S(1) - S(xi); with is_chain minus S(1)/2 in the
/// first two.
void ct_foreshortening_axial(struct ct_exs *x, ct_ex h,
                             const struct ct_foreshortening_products *d, bool is_chain,
                             ct_ex *u);
/// Forces on D from forces on those coefficients.
struct ct_foreshortening_products
ct_foreshortening_axial_forces(struct ct_exs *x, ct_ex h, const ct_ex *force, bool is_chain);

#endif
