// Polynomials -> factored expressions for reading; see collect.h.
//
// The content common to all terms is pulled out first. In the rest, the atom that saves most
// factors is pulled out of the terms that contain it; quotient and remainder are then treated in
// the same way.
#include "expr/collector.h"
#include "expr/fraction.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// ---- content ----------------------------------------------------------------------------------

// Common exponent of two powers: the one nearer to zero if the signs agree.
static int32_t common_exponent(int32_t a, int32_t b)
{
    if ((a > 0) != (b > 0) || a == 0 || b == 0)
        return 0;
    return abs(a) < abs(b) ? a : b;
}

static uint32_t common_powers(struct ct_polys *ps, uint32_t a, uint32_t b)
{
    uint32_t mono = 0;
    for (size_t k = 0; k < ct_mono_length(ps, a); k++) {
        const struct ct_power p = ct_mono_power(ps, a, k);
        const int32_t e = common_exponent(p.exponent, ct_mono_exponent(ps, b, p.atom));
        if (e)
            mono = ct_mono_times(ps, mono, ct_mono_atom(ps, p.atom, e));
    }
    return mono;
}

static double common_number(struct ct_poly p)
{
    size_t negative = 0, same = 0;
    for (size_t k = 0; k < p.n; k++) {
        negative += p.t[k].c < 0;
        same += ct_same_number(fabs(p.t[k].c), fabs(p.t[0].c));
    }
    const double k = same == p.n ? fabs(p.t[0].c) : 1;
    return negative == p.n ? -k : k;
}

void ct_poly_content(struct ct_collector *c, struct ct_poly *p, double *k, uint32_t *mono)
{
    struct ct_poly q = {CT_NEWN(c->arena, struct ct_term, p->n), p->n};
    *mono = p->n ? p->t[0].mono : 0;
    *k = p->n ? common_number(*p) : 1;
    for (size_t i = 1; i < p->n && *mono; i++)
        *mono = common_powers(&c->ps, *mono, p->t[i].mono);
    const uint32_t out = ct_mono_raise(&c->ps, *mono, -1);
    for (size_t i = 0; i < p->n; i++) {
        const struct ct_term *t = &p->t[i];
        q.t[i] = (struct ct_term){t->c / *k, t->size / fabs(*k),
                                  ct_mono_times(&c->ps, t->mono, out)};
        // coefficients that were equal up to round-off become exactly 1
        if (ct_same_number(fabs(q.t[i].c), 1))
            q.t[i].c = q.t[i].c < 0 ? -1 : 1;
    }
    *p = ct_poly_sum(&c->ps, q.t, q.n);
}

// ---- products -----------------------------------------------------------------------------------

// 0.04409999999999999 becomes 0.0441: a decimal of 12 digits that differs by round-off only.
static double without_noise(double k)
{
    char s[32];
    snprintf(s, sizeof s, "%.12g", k);
    const double rounded = strtod(s, NULL);
    return ct_same_number(rounded, k) ? rounded : k;
}

// 0.3333333333333333 becomes 1/3: a fraction of small integers, if the decimal is long. Otherwise
// *divisor is 1.
static double as_fraction(double k, double *divisor)
{
    *divisor = 1;
    if (k * 1e6 == floor(k * 1e6)) // Layout: six decimals are short enough
        return k;
    // NOLINTNEXTLINE(clang-analyzer-security.FloatLoopCounter): small integers are exact
    for (double d = 3; d < 100; d++) {
        const double n = round(k * d);
        if (n != 0 && fabs(n) < 1000 && ct_same_number(n / d, k)) {
            *divisor = d;
            return n;
        }
    }
    return k;
}

// k mono body
static ct_ex product(struct ct_collector *c, double k, uint32_t mono, ct_ex body)
{
    ct_ex below = CT_EX_ONE;
    double divisor;
    k = as_fraction(without_noise(k), &divisor);
    if (divisor == 1)
        k = ct_fraction_snap(k);
    for (size_t i = 0; i < ct_mono_length(&c->ps, mono); i++) {
        const struct ct_power p = ct_mono_power(&c->ps, mono, i);
        const ct_ex whole = ct_ex_const(c->x, abs(p.exponent));
        const ct_ex factor = ct_ex_pow(c->x, c->atom[p.atom].e, whole);
        if (p.exponent > 0)
            body = ct_ex_mul(c->x, body, factor);
        else
            below = ct_ex_mul(c->x, below, factor);
    }
    below = ct_ex_scale(c->x, divisor, below);
    return ct_ex_div(c->x, ct_ex_scale(c->x, k, body), below);
}

// ---- choice of the atom to group by ------------------------------------------------------------

struct choice {
    bool worth; // it is worth pulling out
    uint32_t atom;
    int32_t sign;  // sign of its exponents
    bool forced;   // it is a leading atom of an equation
    bool uniform;  // the same power in all terms
    size_t saving; // number of factors saved
};

static unsigned kind_of_atom(const struct ct_collector *c, uint32_t atom)
{
    const struct ct_sym *s = ct_ex_symbol(c->x, c->atom[atom].e);
    return s ? 1u << s->kind : 0;
}

// Leading atoms of an equation are accelerations and multipliers: it is printed as their
// coefficients.
static bool leads(const struct ct_collector *c, uint32_t atom)
{
    return kind_of_atom(c, atom) & (1u << CT_SYM_A | 1u << CT_SYM_LAM);
}

static bool has_lead(const struct ct_collector *c, uint32_t mono)
{
    for (size_t k = 0; k < ct_mono_length(&c->ps, mono); k++)
        if (leads(c, ct_mono_power(&c->ps, mono, k).atom))
            return true;
    return false;
}

static size_t weight(const struct ct_collector *c, uint32_t mono)
{
    size_t n = 0;
    for (size_t k = 0; k < ct_mono_length(&c->ps, mono); k++) {
        const struct ct_power p = ct_mono_power(&c->ps, mono, k);
        // a function or a sum counts as longer than a symbol
        n += (size_t)abs(p.exponent) + (kind_of_atom(c, p.atom) == 0);
    }
    return n;
}

static bool has_power(const struct ct_collector *c, uint32_t mono, uint32_t atom, int32_t sign)
{
    return ct_mono_exponent(&c->ps, mono, atom) * sign > 0;
}

static struct choice weigh(struct ct_collector *c, struct ct_poly p, struct ct_power by)
{
    struct choice ch = {.atom = by.atom, .sign = by.exponent > 0 ? 1 : -1, .uniform = true};
    uint32_t common = 0;
    size_t n = 0;
    for (size_t k = 0; k < p.n; k++) {
        const uint32_t mono = p.t[k].mono;
        if (!has_power(c, mono, by.atom, ch.sign))
            continue;
        common = n++ ? common_powers(&c->ps, common, mono) : mono;
        ch.uniform &= ct_mono_exponent(&c->ps, mono, by.atom) == by.exponent;
    }
    ch.saving = n > 1 ? (n - 1) * weight(c, common) : 0;
    ch.forced = leads(c, by.atom);
    // l1^2 + 2*l1*l2*c reads better than l1*(l1 + 2*l2*c): saving one symbol is not worth
    // parentheses
    ch.worth = ch.forced || ch.saving > 1 || (ch.saving == 1 && ch.uniform);
    return ch;
}

// Ties go to parameters, then to the older node.
static bool is_better(const struct ct_collector *c, const struct choice *a,
                      const struct choice *b)
{
    if (a->forced != b->forced)
        return a->forced;
    if (a->saving != b->saving)
        return a->saving > b->saving;
    if (a->uniform != b->uniform)
        return a->uniform;
    const unsigned param = 1u << CT_SYM_PARAM;
    const bool pa = kind_of_atom(c, a->atom) == param, pb = kind_of_atom(c, b->atom) == param;
    if (pa != pb)
        return pa;
    return c->atom[a->atom].e.id < c->atom[b->atom].e.id;
}

static struct choice choose(struct ct_collector *c, struct ct_poly p)
{
    struct choice best = {0};
    unsigned char *seen = CT_NEWN(c->arena, unsigned char, c->natom);
    for (size_t k = 0; k < p.n; k++)
        for (size_t i = 0; i < ct_mono_length(&c->ps, p.t[k].mono); i++) {
            const struct ct_power by = ct_mono_power(&c->ps, p.t[k].mono, i);
            const unsigned char mark = by.exponent > 0 ? 1 : 2;
            if (seen[by.atom] & mark)
                continue;
            seen[by.atom] |= mark;
            const struct choice ch = weigh(c, p, by);
            if (ch.worth && (!best.worth || is_better(c, &ch, &best)))
                best = ch;
        }
    return best;
}

// ---- shared sums --------------------------------------------------------------------------------

// Groups are made atom by atom, so the same sum can become a factor of several terms: l3*(m3 + m4)
// + l2*(m3 + m4)*cos(q3). Equal sums are one node, and that node is pulled out.

static bool has_factor(const struct ct_exs *x, ct_ex e, ct_ex f)
{
    const struct ct_exnode *n = ct_ex_node(x, e);
    if (ct_ex_same(e, f))
        return true;
    if (n->op == CT_OP_MUL)
        return has_factor(x, (ct_ex){n->a}, f) || has_factor(x, (ct_ex){n->b}, f);
    return n->op == CT_OP_NEG && has_factor(x, (ct_ex){n->a}, f);
}

// e / f for a factor f of e.
static ct_ex without_factor(struct ct_exs *x, ct_ex e, ct_ex f)
{
    const struct ct_exnode n = *ct_ex_node(x, e);
    if (ct_ex_same(e, f))
        return CT_EX_ONE;
    if (n.op == CT_OP_NEG)
        return ct_ex_neg(x, without_factor(x, (ct_ex){n.a}, f));
    if (has_factor(x, (ct_ex){n.a}, f))
        return ct_ex_mul(x, without_factor(x, (ct_ex){n.a}, f), (ct_ex){n.b});
    return ct_ex_mul(x, (ct_ex){n.a}, without_factor(x, (ct_ex){n.b}, f));
}

// Split a sum by a factor: sum = f part + rest, term by term.
static void split_sum(struct ct_exs *x, ct_ex sum, bool negative, ct_ex f, ct_ex *part,
                      ct_ex *rest)
{
    const struct ct_exnode n = *ct_ex_node(x, sum);
    if (n.op == CT_OP_ADD || n.op == CT_OP_SUB) {
        split_sum(x, (ct_ex){n.a}, negative, f, part, rest);
        split_sum(x, (ct_ex){n.b}, negative ^ (n.op == CT_OP_SUB), f, part, rest);
        return;
    }
    const bool shared = has_factor(x, sum, f);
    ct_ex *to = shared ? part : rest, term = shared ? without_factor(x, sum, f) : sum;
    *to = negative ? ct_ex_sub(x, *to, term) : ct_ex_add(x, *to, term);
}

// `left` bounds the search: a bundled sum can be a graph with more paths than nodes.
static bool is_factor_of_term(const struct ct_exs *x, ct_ex sum, ct_ex f, size_t *left)
{
    const struct ct_exnode *n = ct_ex_node(x, sum);
    if (!*left)
        return false;
    --*left;
    if (n->op == CT_OP_ADD || n->op == CT_OP_SUB)
        return is_factor_of_term(x, (ct_ex){n->a}, f, left)
            || is_factor_of_term(x, (ct_ex){n->b}, f, left);
    return has_factor(x, sum, f);
}

// Find a factor of the product e that is a sum and also a factor of a term of `sum`; false if none.
static bool find_shared(const struct ct_exs *x, ct_ex e, ct_ex sum, ct_ex *f, size_t *left)
{
    const struct ct_exnode *n = ct_ex_node(x, e);
    *f = e;
    if (n->op == CT_OP_ADD || n->op == CT_OP_SUB)
        return is_factor_of_term(x, sum, e, left);
    if (n->op == CT_OP_MUL)
        return find_shared(x, (ct_ex){n->a}, sum, f, left)
            || find_shared(x, (ct_ex){n->b}, sum, f, left);
    return n->op == CT_OP_NEG && find_shared(x, (ct_ex){n->a}, sum, f, left);
}

// first + sum
static ct_ex join(struct ct_exs *x, ct_ex first, ct_ex sum)
{
    ct_ex f, part = CT_EX_ZERO, rest = CT_EX_ZERO;
    size_t left = 1000;
    if (!find_shared(x, first, sum, &f, &left))
        return ct_ex_add(x, first, sum);
    split_sum(x, sum, false, f, &part, &rest);
    const ct_ex inner = join(x, without_factor(x, first, f), part);
    return ct_ex_add(x, ct_ex_mul(x, f, inner), rest);
}

// ---- sums -------------------------------------------------------------------------------------

static ct_ex sum_of_terms(struct ct_collector *c, struct ct_poly p)
{
    ct_ex e = CT_EX_ZERO;
    for (size_t k = 0; k < p.n; k++)
        e = ct_ex_add(c->x, e, product(c, p.t[k].c, p.t[k].mono, CT_EX_ONE));
    return e;
}

// Limit: choosing costs the square of the terms; longer sums are printed without groups.
enum { LARGEST_GROUPED = 1000 };

static ct_ex grouped(struct ct_collector *c, struct ct_poly p)
{
    const struct choice by = p.n <= LARGEST_GROUPED ? choose(c, p) : (struct choice){0};
    if (!by.worth)
        return sum_of_terms(c, p);
    struct ct_poly with = {CT_NEWN(c->arena, struct ct_term, p.n), 0};
    struct ct_poly rest = {CT_NEWN(c->arena, struct ct_term, p.n), 0};
    for (size_t k = 0; k < p.n; k++) {
        struct ct_poly *to = has_power(c, p.t[k].mono, by.atom, by.sign) ? &with : &rest;
        to->t[to->n++] = p.t[k];
    }
    const ct_ex first = ct_regroup(c, with);
    const ct_ex second = ct_regroup(c, rest);
    return by.forced ? ct_ex_add(c->x, first, second) : join(c->x, first, second);
}

ct_ex ct_regroup(struct ct_collector *c, struct ct_poly p)
{
    double k;
    uint32_t mono;
    if (!p.n)
        return CT_EX_ZERO;
    if (p.n == 1)
        return product(c, p.t[0].c, p.t[0].mono, CT_EX_ONE);
    const struct ct_poly all = p;
    ct_poly_content(c, &p, &k, &mono);
    // an equation keeps its terms apart: m*l^2*q'' + m*g*l*sin(q), not m*l*(l*q'' + g*sin(q))
    for (size_t i = 0; i < all.n && !has_lead(c, mono); i++)
        if (has_lead(c, all.t[i].mono))
            return grouped(c, all);
    return product(c, k, mono, grouped(c, p));
}
