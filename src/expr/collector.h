// What the steps of collecting share: expand.c, identity.c, regroup.c; see collect.h.
//
// What always holds: an angle is a polynomial whose leading coefficient is positive; its sine and
// its cosine are atoms, sine(-a) and cosine(-a) are written with them.
#ifndef CT_EXPR_COLLECTOR_H
#define CT_EXPR_COLLECTOR_H

#include "base/pairs.h"
#include "expr/ex.h"
#include "expr/polynomial.h"

struct ct_atom {
    ct_ex e;
    uint32_t angle; // 1 + the angle whose sine or cosine this is, 0 for other atoms
    bool is_sine;
    const struct ct_poly
        *square; // of a square root or the first number of a quaternion: its square
};

struct ct_angle {
    struct ct_poly argument;
    uint32_t sine, cosine; // atoms
};

struct ct_collector {
    struct ct_exs *x;
    struct ct_arena *arena;
    struct ct_polys ps;
    size_t limit; // terms of a polynomial
    size_t spent; // terms made so far
    struct ct_atom *atom;
    size_t natom, atom_cap;
    struct ct_angle *angle;
    size_t nangle, angle_cap;
    struct ct_poly *expanded; // of the nodes below the one expanded last
    size_t nexpanded, expanded_cap;
    // what a node has: its atom, the angle with this argument, its place in `expanded`
    struct ct_pairs atom_of, angle_of, place_of;
    bool early; // merge the pairs of each sum on the way up, see expand.c
    bool has_roots;
    bool bundled; // a sum was too long and became an atom
};

void ct_collector_init(struct ct_collector *c, struct ct_exs *x, struct ct_arena *arena,
                       size_t limit, bool early);
/// The atom of a node that is not a sine or cosine.
uint32_t ct_collector_atom(struct ct_collector *c, ct_ex e);
/// p0^2 = 1 - p1^2 - p2^2 - p3^2: p0 is expanded as the square root of that.
void ct_collector_add_quaternion(struct ct_collector *c, const ct_ex p[4]);
/// CT_OP_SIN or CT_OP_COS of a polynomial: a number, an atom or minus an atom.
struct ct_poly ct_collector_trig(struct ct_collector *c, enum ct_op op,
                                 struct ct_poly argument);

/// e as a polynomial. Cost: what is expanded; nothing of the size of the store.
struct ct_poly ct_expand(struct ct_collector *c, ct_ex e);
/// The same of a node below the one expanded last.
struct ct_poly ct_expanded(const struct ct_collector *c, uint32_t node);
/// p by the identities of sines and cosines, where that is shorter.
struct ct_poly ct_identity_apply(struct ct_collector *c, struct ct_poly p);
/// The same with pairs of terms only, which costs little.
struct ct_poly ct_identity_merge(struct ct_collector *c, struct ct_poly p);
/// p as an expression with common factors pulled out.
ct_ex ct_regroup(struct ct_collector *c, struct ct_poly p);
/// p = k mono (what is left): the number and the powers common to all terms. p is overwritten.
void ct_poly_content(struct ct_collector *c, struct ct_poly *p, double *k, uint32_t *mono);

#endif
