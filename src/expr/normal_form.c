// Polynomials in sines and cosines of single angles; see normal_form.h.
//
//     cos(a + b) = cos a cos b - sin a sin b,   sin^2 a = 1 - cos^2 a
//
// An angle is a linear combination of monomials. An integer multiple of one monomial is expanded to
// powers as well; other multiples are treated as separate angles.
#include "expr/normal_form.h"

#include "expr/collector.h"

#include <math.h>
#include <string.h>

// Limit: terms of a sum, which bounds time and memory; two forms of more terms are not compared.
enum { MOST_TERMS = 2000 };
// Limit: a multiple of an angle beyond this stays as it is: cos(8 a) has 8 terms.
enum { MOST_TURNS = 8 };

struct pair {
    bool is_made;
    struct ct_poly sine, cosine;
};

struct ct_normal_store {
    struct ct_collector c;
    struct pair *angle; // by angle of the collector
    size_t angle_cap;
};

struct ct_normal_store *ct_normal_store_create(struct ct_exs *x, struct ct_arena *arena,
                                               const ct_ex (*quaternion)[4], size_t nquaternion)
{
    struct ct_normal_store *s = CT_NEW(arena, struct ct_normal_store);
    ct_collector_init(&s->c, x, arena, MOST_TERMS, false);
    for (size_t k = 0; k < nquaternion; k++)
        ct_collector_add_quaternion(&s->c, quaternion[k]);
    return s;
}

static struct ct_poly times(struct ct_normal_store *s, struct ct_poly a, struct ct_poly b)
{
    return ct_poly_mul(&s->c.ps, a, b);
}

static struct pair add_angles(struct ct_normal_store *s, struct pair a, struct pair b)
{
    struct ct_polys *ps = &s->c.ps;
    return (struct pair){
        true, ct_poly_add(ps, times(s, a.sine, b.cosine), 1, times(s, a.cosine, b.sine)),
        ct_poly_add(ps, times(s, a.cosine, b.cosine), -1, times(s, a.sine, b.sine))};
}

// Sine and cosine of one term of an angle.
static struct pair of_term(struct ct_normal_store *s, const struct ct_term *t)
{
    struct ct_polys *ps = &s->c.ps;
    const double size = fabs(t->c);
    const bool is_whole = t->mono && size == floor(size) && size <= MOST_TURNS;
    const struct ct_poly argument = ct_poly_term(ps, is_whole ? 1 : size, t->mono);
    const struct pair one = {true, ct_collector_trig(&s->c, CT_OP_SIN, argument),
                             ct_collector_trig(&s->c, CT_OP_COS, argument)};
    struct pair sum = one;
    for (int k = 1; is_whole && k < (int)size; k++)
        sum = add_angles(s, sum, one);
    if (t->c < 0)
        sum.sine = ct_poly_add(ps, (struct ct_poly){0}, -1, sum.sine);
    return sum;
}

static bool is_single(const struct ct_angle *a)
{
    const double k = a->argument.t[0].c;
    return a->argument.n == 1 && (k == 1 || k != floor(k) || k > MOST_TURNS);
}

// Of angle number i, from 1.
static struct pair of_angle(struct ct_normal_store *s, uint32_t i)
{
    if (i < s->angle_cap && s->angle[i].is_made)
        return s->angle[i];
    const struct ct_angle a = s->c.angle[i - 1];
    struct pair sum = {true, ct_poly_term(&s->c.ps, 1, ct_mono_atom(&s->c.ps, a.sine, 1)),
                       ct_poly_term(&s->c.ps, 1, ct_mono_atom(&s->c.ps, a.cosine, 1))};
    if (!is_single(&a)) {
        sum = of_term(s, &a.argument.t[0]);
        for (size_t k = 1; k < a.argument.n; k++)
            sum = add_angles(s, sum, of_term(s, &a.argument.t[k]));
    }
    if (i >= s->angle_cap) {
        const size_t cap = 2 * (size_t)i + 16;
        struct pair *angle = CT_NEWN(s->c.arena, struct pair, cap);
        if (s->angle_cap)
            memcpy(angle, s->angle, s->angle_cap * sizeof *angle);
        s->angle = angle;
        s->angle_cap = cap;
    }
    return s->angle[i] = sum;
}

// A power of a sine or cosine, written without sines of sums and without squared sines.
static struct ct_poly power_of(struct ct_normal_store *s, struct ct_power p)
{
    struct ct_polys *ps = &s->c.ps;
    const struct ct_atom atom = s->c.atom[p.atom];
    const struct ct_poly as_it_is = ct_poly_term(ps, 1, ct_mono_atom(ps, p.atom, p.exponent));
    if (!atom.angle || p.exponent < 0)
        return as_it_is;
    const struct ct_angle a = s->c.angle[atom.angle - 1];
    if (!is_single(&a)) {
        const struct pair sum = of_angle(s, atom.angle);
        return ct_poly_pow(ps, atom.is_sine ? sum.sine : sum.cosine, p.exponent);
    }
    if (!atom.is_sine || p.exponent < 2)
        return as_it_is;
    const struct ct_poly square = ct_poly_add(
        ps, ct_poly_term(ps, 1, 0), -1, ct_poly_term(ps, 1, ct_mono_atom(ps, a.cosine, 2)));
    return times(s, ct_poly_pow(ps, square, p.exponent / 2),
                 ct_poly_term(ps, 1, ct_mono_atom(ps, p.atom, p.exponent % 2)));
}

static bool is_label(const struct ct_normal_store *s, uint32_t atom)
{
    const struct ct_sym *symbol = ct_ex_symbol(s->c.x, s->c.atom[atom].e);
    return symbol && symbol->kind == CT_SYM_SEED;
}

static bool is_normal(const struct ct_normal_store *s, struct ct_poly p)
{
    for (size_t i = 0; i < p.n; i++)
        for (size_t k = 0; k < ct_mono_length(&s->c.ps, p.t[i].mono); k++) {
            const struct ct_power power = ct_mono_power(&s->c.ps, p.t[i].mono, k);
            const struct ct_atom *atom = &s->c.atom[power.atom];
            if (atom->angle && power.exponent > 0
                && (!is_single(&s->c.angle[atom->angle - 1])
                    || (atom->is_sine && power.exponent > 1)))
                return false;
        }
    return true;
}

// Expanding a sum of angles can give new squared sines, so the rewriting is repeated.
static bool normalise(struct ct_normal_store *s, struct ct_poly *p)
{
    struct ct_polys *ps = &s->c.ps;
    while (!is_normal(s, *p)) {
        struct ct_term *t = NULL;
        size_t n = 0, cap = 0;
        for (size_t i = 0; i < p->n; i++) {
            struct ct_poly q = {&p->t[i], 1};
            const uint32_t mono = p->t[i].mono;
            struct ct_poly product = ct_poly_term(ps, p->t[i].c, 0);
            for (size_t k = 0; k < ct_mono_length(ps, mono); k++)
                product = times(s, product, power_of(s, ct_mono_power(ps, mono, k)));
            q = product;
            for (size_t k = 0; k < q.n; k++)
                CT_PUSH(s->c.arena, t, n, cap, q.t[k]);
            if (n > 4 * MOST_TERMS)
                return false;
        }
        *p = ct_poly_sum(ps, t, n);
    }
    return p->n <= MOST_TERMS;
}

static void put(struct ct_normal_store *s, uint32_t mono, struct ct_normal_monomial **list,
                size_t *n, size_t *cap)
{
    struct ct_polys *ps = &s->c.ps;
    uint32_t rest = mono;
    for (size_t k = 0; k < ct_mono_length(ps, mono); k++) {
        const struct ct_power p = ct_mono_power(ps, mono, k);
        if (is_label(s, p.atom))
            rest = ct_mono_times(ps, rest, ct_mono_atom(ps, p.atom, -p.exponent));
    }
    struct ct_normal_monomial out = {rest, UINT32_MAX};
    for (size_t k = 0; k < ct_mono_length(ps, mono); k++) {
        const struct ct_power p = ct_mono_power(ps, mono, k);
        if (!is_label(s, p.atom))
            continue;
        out.label = ct_ex_symbol(s->c.x, s->c.atom[p.atom].e)->index;
        CT_PUSH(s->c.arena, *list, *n, *cap, out);
    }
    if (out.label == UINT32_MAX)
        CT_PUSH(s->c.arena, *list, *n, *cap, out);
}

bool ct_normal_monomials(struct ct_normal_store *s, ct_ex e, struct ct_normal_monomial **out,
                         size_t *n)
{
    size_t cap = 0;
    *out = NULL;
    *n = 0;
    s->c.bundled = false;
    s->c.spent = 0;
    struct ct_poly p = ct_expand(&s->c, e);
    if (s->c.bundled || !normalise(s, &p))
        return false;
    for (size_t i = 0; i < p.n; i++)
        put(s, p.t[i].mono, out, n, &cap);
    return true;
}
