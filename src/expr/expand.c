// Expressions -> polynomials over atoms, operands first; see collect.h.
//
// Products are distributed over sums, integer powers are multiplied out. A sum that would exceed
// the limit is simplified, regrouped and then treated as one atom.
//
// Identities can be applied at the end, or early, to each sum during expansion. Early, the
// components of a rotation about parallel axes become cos(a + b) before they are squared, and
// polynomials stay short. At the end, all cancelling terms are present in one form. Neither order
// is always shorter, so collect.c tries both.
#include "expr/collector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Limit: terms made before expansion stops; bounds time and memory. Beyond it, sums stay as they
// are.
static const size_t budget = 1000000;

void ct_collector_init(struct ct_collector *c, struct ct_exs *x, struct ct_arena *arena,
                       size_t limit, bool early)
{
    *c = (struct ct_collector){.x = x, .arena = arena, .limit = limit, .early = early};
    ct_polys_init(&c->ps, arena);
}

// ---- atoms ------------------------------------------------------------------------------------

static uint32_t new_atom(struct ct_collector *c, struct ct_atom atom)
{
    CT_PUSH(c->arena, c->atom, c->natom, c->atom_cap, atom);
    return (uint32_t)c->natom - 1;
}

uint32_t ct_collector_atom(struct ct_collector *c, ct_ex e)
{
    const int known = ct_pairs_get(&c->atom_of, (int)e.id, 0);
    if (known >= 0)
        return (uint32_t)known;
    const uint32_t atom = new_atom(c, (struct ct_atom){.e = e});
    ct_pairs_put(c->arena, &c->atom_of, (int)e.id, 0, (int)atom);
    return atom;
}

void ct_collector_add_quaternion(struct ct_collector *c, const ct_ex p[4])
{
    struct ct_poly *square = CT_NEW(c->arena, struct ct_poly);
    *square = ct_poly_term(&c->ps, 1, 0);
    for (int i = 1; i < 4; i++) {
        const uint32_t mono = ct_mono_atom(&c->ps, ct_collector_atom(c, p[i]), 2);
        *square = ct_poly_add(&c->ps, *square, -1, ct_poly_term(&c->ps, 1, mono));
    }
    c->atom[ct_collector_atom(c, p[0])].square = square;
    c->has_roots = true;
}

static struct ct_poly number(struct ct_collector *c, double v)
{
    return ct_poly_term(&c->ps, v, 0);
}

// k e as a polynomial with e as one atom, but for its sign.
static struct ct_poly opaque(struct ct_collector *c, ct_ex e)
{
    const struct ct_exnode n = *ct_ex_node(c->x, e);
    double v;
    if (ct_ex_is_const(c->x, e, &v))
        return number(c, v);
    const bool negative = n.op == CT_OP_NEG;
    const uint32_t atom = ct_collector_atom(c, !negative ? e : (ct_ex){n.a});
    return ct_poly_term(&c->ps, negative ? -1 : 1, ct_mono_atom(&c->ps, atom, 1));
}

// ---- angles -----------------------------------------------------------------------------------

// The smallest node among the atoms of a monomial. Symbols are created before the nodes made from
// them, so this is the first symbol if there is one.
static uint32_t oldest(const struct ct_collector *c, uint32_t mono)
{
    uint32_t id = UINT32_MAX;
    for (size_t k = 0; k < ct_mono_length(&c->ps, mono); k++) {
        const uint32_t other = c->atom[ct_mono_power(&c->ps, mono, k).atom].e.id;
        id = other < id ? other : id;
    }
    return id;
}

static double leading_coefficient(const struct ct_collector *c, struct ct_poly p)
{
    size_t lead = 0;
    for (size_t k = 1; k < p.n; k++)
        if (oldest(c, p.t[k].mono) < oldest(c, p.t[lead].mono))
            lead = k;
    return p.t[lead].c;
}

static const struct ct_angle *find_angle(struct ct_collector *c, struct ct_poly argument)
{
    const ct_ex e = ct_regroup(c, argument);
    const int known = ct_pairs_get(&c->angle_of, (int)e.id, 0);
    if (known >= 0)
        return &c->angle[known];
    const uint32_t number = (uint32_t)c->nangle + 1;
    struct ct_atom sine = {.angle = number, .is_sine = true}, cosine = {.angle = number};
    sine.e = ct_ex_fun(c->x, CT_OP_SIN, e);
    cosine.e = ct_ex_fun(c->x, CT_OP_COS, e);
    struct ct_angle a = {.argument = argument};
    a.sine = new_atom(c, sine);
    a.cosine = new_atom(c, cosine);
    ct_pairs_put(c->arena, &c->angle_of, (int)e.id, 0, (int)c->nangle);
    CT_PUSH(c->arena, c->angle, c->nangle, c->angle_cap, a);
    return &c->angle[c->nangle - 1];
}

struct ct_poly ct_collector_trig(struct ct_collector *c, enum ct_op op, struct ct_poly argument)
{
    double v, sign = 1;
    if (ct_poly_is_const(argument, &v))
        return number(c, op == CT_OP_SIN ? sin(v) : cos(v));
    if (leading_coefficient(c, argument) < 0) {
        argument = ct_poly_add(&c->ps, (struct ct_poly){0}, -1, argument);
        sign = op == CT_OP_SIN ? -1 : 1;
    }
    const struct ct_angle *a = find_angle(c, argument);
    const uint32_t atom = op == CT_OP_SIN ? a->sine : a->cosine;
    return ct_poly_term(&c->ps, sign, ct_mono_atom(&c->ps, atom, 1));
}

// ---- sums, products, quotients ------------------------------------------------------------------

// Replace the sum p by one atom. Its content stays a factor, so that it can still cancel.
static struct ct_poly bundle(struct ct_collector *c, struct ct_poly p)
{
    double k;
    uint32_t mono;
    p = ct_identity_apply(c, p);
    if (p.n < 2)
        return p;
    ct_poly_content(c, &p, &k, &mono);
    const struct ct_poly sum = opaque(c, ct_regroup(c, p));
    return ct_poly_mul(&c->ps, ct_poly_term(&c->ps, k, mono), sum);
}

static size_t room(const struct ct_collector *c)
{
    return c->spent < budget ? c->limit : 1;
}

static struct ct_poly bounded(struct ct_collector *c, struct ct_poly p)
{
    c->spent += p.n;
    if (c->early)
        p = ct_identity_merge(c, p);
    c->bundled |= p.n > room(c);
    return p.n > room(c) ? bundle(c, p) : p;
}

// sqrt(a)^2 = a: expand a term with such a power again.
static struct ct_poly reduce_root(struct ct_collector *c, const struct ct_term *t)
{
    struct ct_poly p = {NULL, 0};
    for (size_t k = 0; k < ct_mono_length(&c->ps, t->mono); k++) {
        const struct ct_power power = ct_mono_power(&c->ps, t->mono, k);
        if (!c->atom[power.atom].square || power.exponent < 2)
            continue;
        const int32_t half = power.exponent / 2;
        const uint32_t out = ct_mono_atom(&c->ps, power.atom, -2 * half);
        p = ct_poly_term(&c->ps, t->c, ct_mono_times(&c->ps, t->mono, out));
        return ct_poly_mul(&c->ps, p, ct_poly_pow(&c->ps, *c->atom[power.atom].square, half));
    }
    return p;
}

static struct ct_poly reduce_roots(struct ct_collector *c, struct ct_poly p)
{
    for (size_t k = 0; c->has_roots && k < p.n; k++) {
        const struct ct_term t = p.t[k];
        const struct ct_poly reduced = reduce_root(c, &t);
        if (!reduced.n)
            continue;
        const struct ct_poly old = {(struct ct_term[]){t}, 1};
        p = ct_poly_add(&c->ps, ct_poly_add(&c->ps, p, -1, old), 1, reduced);
        k = (size_t)-1; // terms have moved: start again; each step removes a root
    }
    return p;
}

// Limit: powers beyond this stay as they are; sums of exponents stay far from the range of int32_t.
enum { LARGEST_EXPONENT = 100 };

static int32_t largest_exponent(const struct ct_collector *c, struct ct_poly p)
{
    int32_t largest = 0;
    for (size_t k = 0; k < p.n; k++)
        for (size_t i = 0; i < ct_mono_length(&c->ps, p.t[k].mono); i++) {
            const int32_t e = abs(ct_mono_power(&c->ps, p.t[k].mono, i).exponent);
            largest = e > largest ? e : largest;
        }
    return largest;
}

static bool is_finite(struct ct_poly p)
{
    for (size_t k = 0; k < p.n; k++)
        if (!isfinite(p.t[k].c))
            return false;
    return true;
}

static struct ct_poly product_as_it_is(struct ct_collector *c, struct ct_poly a,
                                       struct ct_poly b)
{
    const ct_ex first = ct_regroup(c, a);
    return opaque(c, ct_ex_mul(c->x, first, ct_regroup(c, b)));
}

static struct ct_poly multiply(struct ct_collector *c, struct ct_poly a, struct ct_poly b)
{
    if (largest_exponent(c, a) + largest_exponent(c, b) > LARGEST_EXPONENT)
        return product_as_it_is(c, a, b);
    // a product may collapse later, so it may exceed the limit for a while
    if (a.n * b.n > 16 * room(c)) {
        c->bundled = true;
        a = a.n >= b.n ? bundle(c, a) : a;
        b = a.n * b.n > 16 * room(c) ? bundle(c, b) : b;
    }
    const struct ct_poly p = reduce_roots(c, ct_poly_mul(&c->ps, a, b));
    c->spent += a.n * b.n;
    if (!is_finite(p))
        return product_as_it_is(c, a, b);
    if (p.n <= room(c))
        return p;
    c->bundled = true;
    return ct_poly_mul(&c->ps, bundle(c, a), bundle(c, b));
}

// 1 / b
static struct ct_poly invert(struct ct_collector *c, struct ct_poly b)
{
    if (b.n > 1)
        b = bundle(c, b);
    if (!b.n || !isfinite(1 / b.t[0].c))
        return opaque(c, ct_ex_div(c->x, CT_EX_ONE, ct_regroup(c, b)));
    return ct_poly_term(&c->ps, 1 / b.t[0].c, ct_mono_raise(&c->ps, b.t[0].mono, -1));
}

// ---- the other operators ------------------------------------------------------------------------

static ct_ex simplified(struct ct_collector *c, struct ct_poly p)
{
    return ct_regroup(c, ct_identity_apply(c, p));
}

static struct ct_poly root(struct ct_collector *c, struct ct_poly a)
{
    a = ct_identity_apply(c, a);
    const ct_ex e = ct_ex_fun(c->x, CT_OP_SQRT, ct_regroup(c, a));
    const struct ct_poly p = opaque(c, e);
    if (ct_ex_node(c->x, e)->op == CT_OP_SQRT) {
        struct ct_poly *square = CT_NEW(c->arena, struct ct_poly);
        *square = a;
        c->atom[ct_collector_atom(c, e)].square = square;
        c->has_roots = true;
    }
    return p;
}

static struct ct_poly power(struct ct_collector *c, struct ct_poly a, struct ct_poly b)
{
    double k;
    if (!ct_poly_is_const(b, &k) || k != floor(k) || fabs(k) > 16)
        return opaque(c, ct_ex_pow(c->x, simplified(c, a), simplified(c, b)));
    if (k < 0)
        a = invert(c, a);
    struct ct_poly p = number(c, 1);
    for (int i = 0; i < (int)fabs(k); i++)
        p = multiply(c, p, a);
    return p;
}

static struct ct_poly function(struct ct_collector *c, const struct ct_exnode *n,
                               const struct ct_poly p[3])
{
    ct_ex e[3] = {{0}};
    const int narg = ct_op_info[n->op].narg;
    for (int k = 0; k < narg; k++)
        e[k] = simplified(c, p[k]);
    if (n->op == CT_OP_TABLE)
        return opaque(c, ct_ex_table(c->x, n->b, n->c, e[0]));
    if (n->op == CT_OP_IF)
        return opaque(c, ct_ex_if(c->x, e[0], e[1], e[2]));
    return opaque(c, narg == 1 ? ct_ex_fun(c->x, (enum ct_op)n->op, e[0])
                               : ct_ex_fun2(c->x, (enum ct_op)n->op, e[0], e[1]));
}

struct ct_poly ct_expanded(const struct ct_collector *c, uint32_t node)
{
    return c->expanded[ct_pairs_get(&c->place_of, (int)node, 0)];
}

static struct ct_poly expand_node(struct ct_collector *c, ct_ex e)
{
    const struct ct_exnode n = *ct_ex_node(c->x, e);
    const uint32_t arg[3] = {n.a, n.b, n.c};
    struct ct_poly p[3] = {{0}};
    for (int k = 0; k < ct_op_info[n.op].narg; k++)
        p[k] = ct_expanded(c, arg[k]);
    switch (n.op) {
    case CT_OP_CONST:
    case CT_OP_SYM:
        return opaque(c, e);
    case CT_OP_ADD:
        return bounded(c, ct_poly_add(&c->ps, p[0], 1, p[1]));
    case CT_OP_SUB:
        return bounded(c, ct_poly_add(&c->ps, p[0], -1, p[1]));
    case CT_OP_NEG:
        return ct_poly_add(&c->ps, (struct ct_poly){0}, -1, p[0]);
    case CT_OP_MUL:
        return multiply(c, p[0], p[1]);
    case CT_OP_DIV:
        return multiply(c, p[0], invert(c, p[1]));
    case CT_OP_POW:
        return power(c, p[0], p[1]);
    case CT_OP_SQRT:
        return root(c, p[0]);
    case CT_OP_SIN:
    case CT_OP_COS:
        return ct_collector_trig(c, (enum ct_op)n.op, p[0]);
    default:
        return function(c, &n, p);
    }
}

struct ct_poly ct_expand(struct ct_collector *c, ct_ex e)
{
    const size_t n = ct_ex_walk(c->x, &e, 1);
    uint32_t *id = CT_NEWN(c->arena, uint32_t,
                           n); // a copy: the list of a walk is valid until the next walk
    memcpy(id, c->x->stack, n * sizeof *id);
    c->place_of = (struct ct_pairs){0};
    c->nexpanded = 0;
    for (size_t k = 0; k < n; k++) {
        const struct ct_poly p = expand_node(c, (ct_ex){id[k]});
        ct_pairs_put(c->arena, &c->place_of, (int)id[k], 0, (int)c->nexpanded);
        CT_PUSH(c->arena, c->expanded, c->nexpanded, c->expanded_cap, p);
    }
    return ct_expanded(c, e.id);
}
