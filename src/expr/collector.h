// State shared by the steps of simplification: expand.c, identity.c, regroup.c; see collect.h.
//
// What always holds: an angle is a polynomial with a positive leading coefficient. Its sine and
// cosine are atoms; sin(-a) and cos(-a) are expressed by them.
#ifndef CT_EXPR_COLLECTOR_H
#define CT_EXPR_COLLECTOR_H

#include "base/pairs.h"
#include "expr/ex.h"
#include "expr/polynomial.h"

struct ct_atom {
    ct_ex e;
    uint32_t angle; // 1 + the angle whose sine or cosine this is, 0 for other atoms
    bool is_sine;
    // polynomial of its square, for a square root or the first symbol of a quaternion
    const struct ct_poly *square;
};

struct ct_angle {
    struct ct_poly argument;
    uint32_t sine, cosine; // numbers of atoms
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
    struct ct_poly *expanded; // polynomials of the nodes below the root of the last ct_expand
    size_t nexpanded, expanded_cap;
    // by node: its atom, the angle with this node as argument, its index in `expanded`
    struct ct_pairs atom_of, angle_of, place_of;
    bool early; // apply identities to each sum during expansion, see expand.c
    bool has_roots;
    bool bundled; // whether a sum exceeded the limit and became an atom
};

void ct_collector_init(struct ct_collector *c, struct ct_exs *x, struct ct_arena *arena,
                       size_t limit, bool early);
/// The atom of a node that is not a sine or cosine.
uint32_t ct_collector_atom(struct ct_collector *c, ct_ex e);
/// p0^2 = 1 - p1^2 - p2^2 - p3^2: p0 is expanded as the square root of that.
void ct_collector_add_quaternion(struct ct_collector *c, const ct_ex p[4]);
/// Sine or cosine (op CT_OP_SIN or CT_OP_COS) of a polynomial: a number, an atom or minus an atom.
struct ct_poly ct_collector_trig(struct ct_collector *c, enum ct_op op,
                                 struct ct_poly argument);

/// e as a polynomial. Cost: that of the expanded terms, independent of the size of the store.
struct ct_poly ct_expand(struct ct_collector *c, ct_ex e);
/// The polynomial of a node below the root of the last ct_expand.
struct ct_poly ct_expanded(const struct ct_collector *c, uint32_t node);
/// p rewritten by trigonometric identities where that makes it shorter.
struct ct_poly ct_identity_apply(struct ct_collector *c, struct ct_poly p);
/// The same with identities between two terms only: cheaper.
struct ct_poly ct_identity_merge(struct ct_collector *c, struct ct_poly p);
/// p as an expression with common factors pulled out.
ct_ex ct_regroup(struct ct_collector *c, struct ct_poly p);
/// Split p into content and rest, p = k mono rest: k is the common number, mono the powers common
/// to all terms. p is overwritten by the rest.
void ct_poly_content(struct ct_collector *c, struct ct_poly *p, double *k, uint32_t *mono);

#endif
