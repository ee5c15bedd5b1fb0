// Polynomials with double coefficients. Their indeterminates are called atoms and are plain numbers
// here.
//
//     3 a^2 b - c^-1      terms   { 3, mono of a^2 b }, { -1, mono of c^-1 }
//     monomial            powers  (a, 2), (b, 1)         sorted by atom, no exponent 0; interned
//
// What always holds: equal monomials have equal numbers; number 0 is the monomial without powers.
// The terms of a polynomial have distinct monomials in ascending order. No coefficient is round-off
// noise: each term records its largest contribution, and a sum that cancels to a few units in the
// last place of that is dropped.
#ifndef CT_EXPR_POLYNOMIAL_H
#define CT_EXPR_POLYNOMIAL_H

#include "base/arena.h"

#include <stdbool.h>
#include <stdint.h>

struct ct_power {
    uint32_t atom;
    int32_t exponent;
};

struct ct_mono {
    uint32_t first, n; // powers pool[first ... first + n)
};

struct ct_term {
    double c, size;
    uint32_t mono;
};

struct ct_poly {
    struct ct_term *t;
    size_t n;
};

struct ct_polys {
    struct ct_arena *arena;
    struct ct_power *pool;
    size_t npool, pool_cap;
    struct ct_mono *mono;
    size_t nmono, mono_cap;
    uint32_t *hash; // open addressing, 0 is free, else mono + 1
    size_t hash_size;
    uint32_t
        *place; // by mono: 1 + index of its term in the polynomial under construction, else 0
    size_t place_cap;
};

void ct_polys_init(struct ct_polys *ps, struct ct_arena *arena);

// ---- monomials ----------------------------------------------------------------------------------

static inline size_t ct_mono_length(const struct ct_polys *ps, uint32_t mono)
{
    return ps->mono[mono].n;
}
static inline struct ct_power ct_mono_power(const struct ct_polys *ps, uint32_t mono, size_t k)
{
    return ps->pool[ps->mono[mono].first + k];
}
/// Exponent of an atom, 0 if it is not there.
int32_t ct_mono_exponent(const struct ct_polys *ps, uint32_t mono, uint32_t atom);
uint32_t ct_mono_atom(struct ct_polys *ps, uint32_t atom, int32_t exponent);
uint32_t ct_mono_times(struct ct_polys *ps, uint32_t a, uint32_t b);
/// Each exponent times k.
uint32_t ct_mono_raise(struct ct_polys *ps, uint32_t a, int32_t k);

// ---- polynomials -------------------------------------------------------------------------------

struct ct_poly ct_poly_term(struct ct_polys *ps, double c, uint32_t mono);
/// The sum of n terms in any order; monomials may repeat. t is used as workspace and becomes part
/// of the result.
struct ct_poly ct_poly_sum(struct ct_polys *ps, struct ct_term *t, size_t n);
/// a + c b
struct ct_poly ct_poly_add(struct ct_polys *ps, struct ct_poly a, double c, struct ct_poly b);
/// Cost O(terms of a times terms of b).
struct ct_poly ct_poly_mul(struct ct_polys *ps, struct ct_poly a, struct ct_poly b);
/// a^k, k >= 0.
struct ct_poly ct_poly_pow(struct ct_polys *ps, struct ct_poly a, int32_t k);
bool ct_poly_is_const(struct ct_poly a, double *c);
/// Are a and b equal up to a few units in the last place of the larger?
bool ct_same_number(double a, double b);

#endif
