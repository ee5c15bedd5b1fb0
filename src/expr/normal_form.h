// Monomials of expressions in one form: what two equal expressions have in common, however they are written.
//
//     m*l*(g + l*cos(a + b))^2     m l g^2, m l^2 g cos(a) cos(b), m l^2 g sin(a) sin(b), ...
//
// Sums are multiplied out, sines and cosines of sums too, and squares of sines are written with cosines. Symbols of
// kind SEED are labels: they are multiplied along, but do not count as factors.
//
// What always holds: within a store of monomials, equal monomials have equal numbers.
#ifndef CT_EXPR_NORMAL_FORM_H
#define CT_EXPR_NORMAL_FORM_H

#include "expr/ex.h"

struct ct_normal_store;

struct ct_normal_monomial {
    uint32_t monomial; // its number
    uint32_t label;    // index of a SEED symbol that multiplies it; UINT32_MAX: none
};

/// quaternion: by rows of four symbols whose squares sum to 1 (nquaternion).
struct ct_normal_store *ct_normal_store_create(struct ct_exs *x, struct ct_arena *arena,
                                               const ct_ex (*quaternion)[4],
                                               size_t nquaternion);

/// The monomials of e, once for each of their labels. *out lives in the arena of the store. False: e is too long to be
/// multiplied out.
bool ct_normal_monomials(struct ct_normal_store *s, ct_ex e, struct ct_normal_monomial **out,
                         size_t *n);

#endif
