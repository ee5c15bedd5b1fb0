// Canonical monomials of expressions: equal expressions have the same monomials, however they are
// written.
//
//     m*l*(g + l*cos(a + b))^2     m l g^2, m l^2 g cos(a) cos(b), m l^2 g sin(a) sin(b), ...
//
// Products of sums are multiplied out, sines and cosines of sums are expanded, and squared sines
// are replaced by cosines. Symbols of kind SEED are labels: each monomial carries the label that
// multiplies it, but the label is not one of its factors.
//
// What always holds: within one store, equal monomials have equal numbers.
#ifndef CT_EXPR_NORMAL_FORM_H
#define CT_EXPR_NORMAL_FORM_H

#include "expr/ex.h"

struct ct_normal_store;

struct ct_normal_monomial {
    uint32_t monomial; // its number
    uint32_t label;    // index of a SEED symbol that multiplies it; UINT32_MAX: none
};

/// quaternion: nquaternion groups of four symbols whose squares sum to 1.
struct ct_normal_store *ct_normal_store_create(struct ct_exs *x, struct ct_arena *arena,
                                               const ct_ex (*quaternion)[4],
                                               size_t nquaternion);

/// The monomials of e; a monomial with several labels appears once for each. *out lives in the
/// arena of the store. False if e has too many terms to be multiplied out.
bool ct_normal_monomials(struct ct_normal_store *s, ct_ex e, struct ct_normal_monomial **out,
                         size_t *n);

#endif
