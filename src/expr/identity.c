// Identities of sines and cosines, applied where they make a polynomial shorter; see collect.h.
//
// Terms that differ only in sines and cosines form a group; parameters, speeds and the rest are its
// common factor. Each group is rewritten in three ways, and the shortest result is kept:
//
//     merged     cos^2 a + sin^2 a = 1, cos a cos b + sin a sin b = cos(a - b) and relatives,
//                on pairs of terms, until no pair is left
//     expanded   sines and cosines of sums are expanded first, then merged: finds cancellation
//                between products and functions of sums
//     harmonics  products as sums, cos a cos b = (cos(a - b) + cos(a + b)) / 2: a normal form, in
//                which all cancelling terms cancel; pairs 1 + cos 2a become squares again
#include "expr/collector.h"

#include "base/sort.h"

#include <math.h>
#include <stdlib.h>

// ---- length -----------------------------------------------------------------------------------

static const struct ct_atom *atom_at(const struct ct_collector *c, uint32_t mono, size_t k)
{
    return &c->atom[ct_mono_power(&c->ps, mono, k).atom];
}

// Measure of length: terms, coefficients, factors, powers, and sums inside functions.
static size_t length_of_term(const struct ct_collector *c, const struct ct_term *t)
{
    // fractions from product-to-sum formulas count twice: they pay only in a much shorter result
    size_t n = 2 + !ct_same_number(fabs(t->c), 1) + 2 * (t->c != floor(t->c));
    for (size_t k = 0; k < ct_mono_length(&c->ps, t->mono); k++) {
        const struct ct_atom *atom = atom_at(c, t->mono, k);
        n += ct_mono_power(&c->ps, t->mono, k).exponent == 1 ? 2 : 3;
        if (atom->angle) {
            const struct ct_poly *arg = &c->angle[atom->angle - 1].argument;
            n += 2 * (arg->n - 1) + !ct_same_number(fabs(arg->t[0].c), 1);
        }
    }
    return n;
}

static size_t length(const struct ct_collector *c, struct ct_poly p)
{
    size_t n = 0;
    for (size_t k = 0; k < p.n; k++)
        n += length_of_term(c, &p.t[k]);
    return n;
}

static struct ct_poly shorter(const struct ct_collector *c, struct ct_poly a, struct ct_poly b)
{
    return length(c, b) < length(c, a) ? b : a;
}

// ---- parts of polynomials ----------------------------------------------------------------------

// A term with a sort key; terms with equal keys are rewritten together.
struct keyed {
    uint32_t key;
    struct ct_term t;
};

static int by_key(const void *unused, const void *a, const void *b)
{
    const uint32_t m = ((const struct keyed *)a)->key, n = ((const struct keyed *)b)->key;
    (void)unused;
    return (m > n) - (m < n);
}

typedef struct ct_poly (*part_fn)(struct ct_collector *c, struct ct_poly part,
                                  const void *data);

// The sum of rewrite(part) over the parts of p with equal keys. k is sorted.
static struct ct_poly rewrite_parts(struct ct_collector *c, struct keyed *k, size_t n,
                                    part_fn rewrite, const void *data)
{
    struct ct_poly sum = {NULL, 0};
    size_t nsum = 0, cap = 0;
    ct_sort(c->arena, k, n, sizeof *k, by_key, NULL);
    for (size_t from = 0, to; from < n; from = to) {
        for (to = from; to < n && k[to].key == k[from].key;)
            to++;
        struct ct_poly part = {CT_NEWN(c->arena, struct ct_term, to - from), 0};
        for (size_t i = from; i < to; i++)
            part.t[part.n++] = k[i].t;
        part = rewrite(c, ct_poly_sum(&c->ps, part.t, part.n), data);
        for (size_t i = 0; i < part.n; i++)
            CT_PUSH(c->arena, sum.t, nsum, cap, part.t[i]);
    }
    return ct_poly_sum(&c->ps, sum.t, nsum);
}

static const struct ct_term *find_term(struct ct_poly p, uint32_t mono)
{
    size_t low = 0, high = p.n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (p.t[middle].mono < mono)
            low = middle + 1;
        else
            high = middle;
    }
    return low < p.n && p.t[low].mono == mono ? &p.t[low] : NULL;
}

static uint32_t times_power(struct ct_collector *c, uint32_t mono, uint32_t atom,
                            int32_t exponent)
{
    return ct_mono_times(&c->ps, mono, ct_mono_atom(&c->ps, atom, exponent));
}

// ---- squares ----------------------------------------------------------------------------------

// from^2 -> 1 - to^2 in all terms.
static struct ct_poly replace_squares(struct ct_collector *c, struct ct_poly p, uint32_t from,
                                      uint32_t to)
{
    struct ct_poly sum = {NULL, 0}, one = ct_poly_term(&c->ps, 1, 0);
    const struct ct_poly square = ct_poly_term(&c->ps, 1, ct_mono_atom(&c->ps, to, 2));
    const struct ct_poly other = ct_poly_add(&c->ps, one, -1, square);
    for (size_t k = 0; k < p.n; k++) {
        const int32_t e = ct_mono_exponent(&c->ps, p.t[k].mono, from), half = e > 1 ? e / 2 : 0;
        struct ct_term t = p.t[k];
        t.mono = times_power(c, t.mono, from, -2 * half);
        const struct ct_poly rest = {&t, 1};
        sum = ct_poly_add(&c->ps, sum, 1,
                          ct_poly_mul(&c->ps, rest, ct_poly_pow(&c->ps, other, half)));
    }
    return sum;
}

// Merge one pair k R s^2 + k R c^2 -> k R; p itself if there is none.
static struct ct_poly merge_square(struct ct_collector *c, struct ct_poly p,
                                   const struct ct_angle *a)
{
    for (size_t k = 0; k < p.n; k++) {
        if (ct_mono_exponent(&c->ps, p.t[k].mono, a->sine) < 2)
            continue;
        struct ct_term one = p.t[k];
        one.mono = times_power(c, one.mono, a->sine, -2);
        const struct ct_term *other = find_term(p, times_power(c, one.mono, a->cosine, 2));
        if (!other || !ct_same_number(other->c, one.c))
            continue;
        struct ct_term *t = CT_NEWN(c->arena, struct ct_term, p.n + 1);
        size_t n = 0;
        for (size_t i = 0; i < p.n; i++)
            if (i != k && &p.t[i] != other)
                t[n++] = p.t[i];
        t[n++] = one;
        return ct_poly_sum(&c->ps, t, n);
    }
    return p;
}

static struct ct_poly shorten_squares(struct ct_collector *c, struct ct_poly p,
                                      const void *data)
{
    const struct ct_angle a = *(const struct ct_angle *)data;
    if (p.n < 2)
        return p;
    struct ct_poly merged = p, last;
    do {
        last = merged;
        merged = merge_square(c, last, &a);
    } while (merged.n < last.n);
    const struct ct_poly cosines = replace_squares(c, p, a.sine, a.cosine);
    const struct ct_poly sines = replace_squares(c, p, a.cosine, a.sine);
    return shorter(c, shorter(c, merged, cosines), sines);
}

// Merge squares among the terms that differ only in the powers of the sine and cosine of one angle.
static struct ct_poly squares_of_angle(struct ct_collector *c, struct ct_poly p, uint32_t angle)
{
    const struct ct_angle a = c->angle[angle];
    struct keyed *k = CT_NEWN(c->arena, struct keyed, p.n);
    bool any = false;
    for (size_t i = 0; i < p.n; i++) {
        const int32_t s = ct_mono_exponent(&c->ps, p.t[i].mono, a.sine);
        const int32_t t = ct_mono_exponent(&c->ps, p.t[i].mono, a.cosine);
        const uint32_t rest = times_power(c, p.t[i].mono, a.sine, -s);
        k[i] = (struct keyed){times_power(c, rest, a.cosine, -t), p.t[i]};
        any |= s > 1 || t > 1;
    }
    return any ? rewrite_parts(c, k, p.n, shorten_squares, &a) : p;
}

static struct ct_poly squares(struct ct_collector *c, struct ct_poly p)
{
    unsigned char *seen = CT_NEWN(c->arena, unsigned char, c->nangle);
    for (size_t k = 0; k < p.n; k++)
        for (size_t i = 0; i < ct_mono_length(&c->ps, p.t[k].mono); i++) {
            const struct ct_atom *atom = atom_at(c, p.t[k].mono, i);
            if (atom->angle && abs(ct_mono_power(&c->ps, p.t[k].mono, i).exponent) > 1)
                seen[atom->angle - 1] = 1;
        }
    for (uint32_t angle = 0; angle < c->nangle; angle++)
        if (seen[angle])
            p = squares_of_angle(c, p, angle);
    return p;
}

// ---- sums and differences of angles ------------------------------------------------------------

// The atom of the other function (sine or cosine) of the same angle.
static uint32_t turned(const struct ct_collector *c, uint32_t atom)
{
    const struct ct_angle *a = &c->angle[c->atom[atom].angle - 1];
    return c->atom[atom].is_sine ? a->cosine : a->sine;
}

// Merge k R f(a) g(b) with its partner, in which both functions are exchanged, if the coefficients
// match:
//
//     k cos a cos b + k sin a sin b = k cos(a - b)     k sin a cos b + k cos a sin b = k sin(a + b)
//     k cos a cos b - k sin a sin b = k cos(a + b)     k sin a cos b - k cos a sin b = k sin(a - b)
static bool merge_factors(struct ct_collector *c, struct ct_poly p, const struct ct_term *t,
                          uint32_t f, uint32_t g, const struct ct_term **partner,
                          struct ct_poly *merged)
{
    uint32_t rest = times_power(c, times_power(c, t->mono, f, -1), g, -1);
    const uint32_t other
        = times_power(c, times_power(c, rest, turned(c, f), 1), turned(c, g), 1);
    *partner = find_term(p, other);
    if (!*partner || !ct_same_number(fabs((*partner)->c), fabs(t->c)))
        return false;
    const bool same = ((*partner)->c < 0) == (t->c < 0), sine = c->atom[f].is_sine;
    const struct ct_poly a = c->angle[c->atom[f].angle - 1].argument;
    const struct ct_poly b = c->angle[c->atom[g].angle - 1].argument;
    const struct ct_poly arg = ct_poly_add(&c->ps, a, same == sine ? 1 : -1, b);
    const struct ct_poly harmonic = ct_collector_trig(c, sine ? CT_OP_SIN : CT_OP_COS, arg);
    const struct ct_term scale = {t->c, fmax(t->size, (*partner)->size), rest};
    struct ct_term room = scale;
    *merged = ct_poly_mul(&c->ps, (struct ct_poly){&room, 1}, harmonic);
    return true;
}

// Look for a pair that starts with cos a cos b or sin a cos b; the other two products are the
// partners.
static bool merge_term(struct ct_collector *c, struct ct_poly p, const struct ct_term *t,
                       const struct ct_term **partner, struct ct_poly *merged)
{
    const size_t n = ct_mono_length(&c->ps, t->mono);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            const struct ct_power f = ct_mono_power(&c->ps, t->mono, i);
            const struct ct_power g = ct_mono_power(&c->ps, t->mono, j);
            const struct ct_atom *fa = &c->atom[f.atom], *ga = &c->atom[g.atom];
            if (!fa->angle || !ga->angle || fa->angle == ga->angle || ga->is_sine
                || f.exponent < 1 || g.exponent < 1 || (!fa->is_sine && j < i))
                continue;
            if (merge_factors(c, p, t, f.atom, g.atom, partner, merged))
                return true;
        }
    return false;
}

// Each term takes part in at most one merge; p itself if there is none.
static struct ct_poly angles(struct ct_collector *c, struct ct_poly p)
{
    unsigned char *gone = CT_NEWN(c->arena, unsigned char, p.n);
    struct ct_poly sum = {NULL, 0}, merged;
    size_t cap = 0, nmerged = 0;
    const struct ct_term *partner;
    for (size_t k = 0; k < p.n; k++) {
        if (gone[k] || !merge_term(c, p, &p.t[k], &partner, &merged) || gone[partner - p.t])
            continue;
        gone[k] = gone[partner - p.t] = 1;
        nmerged++;
        for (size_t i = 0; i < merged.n; i++)
            CT_PUSH(c->arena, sum.t, sum.n, cap, merged.t[i]);
    }
    for (size_t k = 0; k < p.n && nmerged; k++)
        if (!gone[k])
            CT_PUSH(c->arena, sum.t, sum.n, cap, p.t[k]);
    return nmerged ? ct_poly_sum(&c->ps, sum.t, sum.n) : p;
}

static struct ct_poly merge(struct ct_collector *c, struct ct_poly p)
{
    for (size_t before = SIZE_MAX; length(c, p) < before;) {
        before = length(c, p);
        p = squares(c, p);
        p = shorter(c, p, angles(c, p));
    }
    return p;
}

// ---- sums inside functions, multiplied out -----------------------------------------------------

struct turn {
    struct ct_poly sine, cosine;
};

static struct turn add_turns(struct ct_polys *ps, struct turn a, struct turn b, double sign)
{
    const struct ct_poly cc = ct_poly_mul(ps, a.cosine, b.cosine);
    const struct ct_poly ss = ct_poly_mul(ps, a.sine, b.sine);
    const struct ct_poly sc = ct_poly_mul(ps, a.sine, b.cosine);
    const struct ct_poly cs = ct_poly_mul(ps, a.cosine, b.sine);
    return (struct turn){ct_poly_add(ps, sc, sign, cs), ct_poly_add(ps, cc, -sign, ss)};
}

// Largest multiple that is expanded: cos(2 q) = cos^2 q - sin^2 q. Limit: of the terms; cos(4 q)
// has three.
enum { LARGEST_MULTIPLE = 4 };

static struct turn expand_angle(struct ct_collector *c, struct ct_poly argument)
{
    struct turn sum = {{NULL, 0}, ct_poly_term(&c->ps, 1, 0)};
    for (size_t k = 0; k < argument.n; k++) {
        const struct ct_term *t = &argument.t[k];
        const bool whole = t->c == floor(t->c) && fabs(t->c) <= LARGEST_MULTIPLE && t->mono;
        const int times = whole ? (int)fabs(t->c) : 1;
        const struct ct_poly base = ct_poly_term(&c->ps, whole ? 1 : fabs(t->c), t->mono);
        const struct turn one
            = {ct_collector_trig(c, CT_OP_SIN, base), ct_collector_trig(c, CT_OP_COS, base)};
        for (int i = 0; i < times; i++)
            sum = add_turns(&c->ps, sum, one, t->c < 0 ? -1 : 1);
    }
    return sum;
}

static bool is_compound(const struct ct_collector *c, const struct ct_atom *atom)
{
    if (!atom->angle)
        return false;
    const struct ct_poly *arg = &c->angle[atom->angle - 1].argument;
    return arg->n > 1 || (arg->t[0].c != 1 && arg->t[0].c == floor(arg->t[0].c));
}

// The product of the expanded factors of one term; no terms if it becomes too large.
static struct ct_poly expand_term(struct ct_collector *c, const struct ct_term *t)
{
    struct ct_poly p = ct_poly_term(&c->ps, t->c, 0);
    p.t[0].size = t->size;
    for (size_t k = 0; k < ct_mono_length(&c->ps, t->mono); k++) {
        const struct ct_power power = ct_mono_power(&c->ps, t->mono, k);
        const struct ct_atom atom = c->atom[power.atom];
        if (power.exponent < 0 || !is_compound(c, &atom)) {
            const uint32_t mono = ct_mono_atom(&c->ps, power.atom, power.exponent);
            p = ct_poly_mul(&c->ps, p, ct_poly_term(&c->ps, 1, mono));
            continue;
        }
        const struct turn turn = expand_angle(c, c->angle[atom.angle - 1].argument);
        for (int32_t i = 0; i < power.exponent; i++) {
            p = ct_poly_mul(&c->ps, p, atom.is_sine ? turn.sine : turn.cosine);
            if (p.n > c->limit / 4)
                return (struct ct_poly){NULL, 0};
        }
    }
    return p;
}

// p itself if there is nothing to expand or the result is too long.
static struct ct_poly expand_angles(struct ct_collector *c, struct ct_poly p)
{
    struct ct_poly sum = {NULL, 0};
    bool any = false;
    for (size_t k = 0; k < p.n && !any; k++)
        for (size_t i = 0; i < ct_mono_length(&c->ps, p.t[k].mono); i++)
            any |= is_compound(c, atom_at(c, p.t[k].mono, i));
    for (size_t k = 0; k < p.n && any; k++) {
        const struct ct_poly q = expand_term(c, &p.t[k]);
        sum = ct_poly_add(&c->ps, sum, 1, q);
        if (!q.n || sum.n > c->limit)
            return p;
    }
    return any ? sum : p;
}

// ---- products as sums of harmonics -------------------------------------------------------------

struct harmonic {
    double c;
    bool is_sine;
    struct ct_poly argument;
};

// Product of w with the sine or cosine `by`: two harmonics of half the amplitude.
static void split_wave(struct ct_polys *ps, struct harmonic w, const struct ct_atom *f,
                       struct ct_poly by, struct harmonic out[2])
{
    const bool sine = w.is_sine != f->is_sine;
    const double half = w.c / 2;
    out[0] = (struct harmonic){half, sine, ct_poly_add(ps, w.argument, 1, by)};
    out[1] = (struct harmonic){half, sine, ct_poly_add(ps, w.argument, -1, by)};
    if (w.is_sine && f->is_sine) // sin a sin b = (cos(a - b) - cos(a + b)) / 2
        out[0].c = -half;
    else if (f->is_sine) // cos a sin b = (sin(a + b) - sin(a - b)) / 2
        out[1].c = -half;
}

// Limit: factors of a product and harmonics of a polynomial, for readable results. Beyond, products
// stay.
enum { LARGEST_DEGREE = 6, LARGEST_WAVES = 256 };

// Degree in sines and cosines; LARGEST_DEGREE + 1 if the product-to-sum form does not apply.
static int degree(const struct ct_collector *c, uint32_t mono)
{
    int n = 0;
    for (size_t k = 0; k < ct_mono_length(&c->ps, mono); k++) {
        const struct ct_power power = ct_mono_power(&c->ps, mono, k);
        if (!c->atom[power.atom].angle || power.exponent < 0 || power.exponent > LARGEST_DEGREE)
            return LARGEST_DEGREE + 1;
        n += power.exponent;
    }
    return n <= LARGEST_DEGREE ? n : LARGEST_DEGREE + 1;
}

static struct ct_poly waves_of_term(struct ct_collector *c, const struct ct_term *t)
{
    struct harmonic w[2 << LARGEST_DEGREE], split[2];
    size_t n = 1;
    w[0] = (struct harmonic){t->c, false, {NULL, 0}};
    for (size_t k = 0; k < ct_mono_length(&c->ps, t->mono); k++) {
        const struct ct_power power = ct_mono_power(&c->ps, t->mono, k);
        const struct ct_atom f = c->atom[power.atom];
        for (int32_t i = 0; i < power.exponent; i++)
            for (size_t j = n; j-- > 0;) {
                split_wave(&c->ps, w[j], &f, c->angle[f.angle - 1].argument, split);
                w[j] = split[0];
                w[n++] = split[1];
            }
    }
    struct ct_poly sum = {NULL, 0};
    for (size_t k = 0; k < n; k++)
        sum = ct_poly_add(
            &c->ps, sum, w[k].c,
            ct_collector_trig(c, w[k].is_sine ? CT_OP_SIN : CT_OP_COS, w[k].argument));
    return sum;
}

// Product-to-sum form; p itself if it has too many terms.
static struct ct_poly harmonics(struct ct_collector *c, struct ct_poly p)
{
    size_t n = 0;
    for (size_t k = 0; k < p.n; k++) {
        const int d = degree(c, p.t[k].mono);
        n += (size_t)1 << d;
        if (d > LARGEST_DEGREE || n > LARGEST_WAVES)
            return p;
    }
    struct ct_poly sum = {NULL, 0};
    for (size_t k = 0; k < p.n; k++)
        sum = ct_poly_add(&c->ps, sum, 1, waves_of_term(c, &p.t[k]));
    return sum;
}

// k R + k R cos 2a = 2 k R cos^2 a, with a minus sign 2 k R sin^2 a: the product-to-sum form leaves
// such pairs.
static struct ct_poly halve(struct ct_collector *c, struct ct_poly p, const struct ct_term *t)
{
    for (size_t i = 0; i < ct_mono_length(&c->ps, t->mono); i++) {
        const struct ct_power power = ct_mono_power(&c->ps, t->mono, i);
        const struct ct_atom f = c->atom[power.atom];
        if (!f.angle || f.is_sine || power.exponent != 1)
            continue;
        struct ct_poly arg = c->angle[f.angle - 1].argument, one;
        bool even = true;
        for (size_t k = 0; k < arg.n; k++)
            even &= arg.t[k].mono && fmod(arg.t[k].c, 2) == 0;
        const uint32_t rest = times_power(c, t->mono, power.atom, -1);
        const struct ct_term *other = even ? find_term(p, rest) : NULL;
        if (!other || !ct_same_number(fabs(other->c), fabs(t->c)))
            continue;
        arg = ct_poly_add(&c->ps, (struct ct_poly){NULL, 0}, 0.5, arg);
        one = ct_collector_trig(c, (other->c < 0) == (t->c < 0) ? CT_OP_COS : CT_OP_SIN, arg);
        const struct ct_poly square = ct_poly_mul(&c->ps, one, one);
        const struct ct_poly folded
            = ct_poly_mul(&c->ps, ct_poly_term(&c->ps, 2 * other->c, rest), square);
        struct ct_term pair[2] = {*t, *other};
        p = ct_poly_add(&c->ps, p, -1, (struct ct_poly){&pair[0], 1});
        p = ct_poly_add(&c->ps, p, -1, (struct ct_poly){&pair[1], 1});
        return ct_poly_add(&c->ps, p, 1, folded);
    }
    return p;
}

static struct ct_poly halves(struct ct_collector *c, struct ct_poly p)
{
    for (size_t k = 0; k < p.n;) {
        const struct ct_poly q = halve(c, p, &p.t[k]);
        k = q.t == p.t ? k + 1 : 0; // each step removes a term, so this ends
        p = q;
    }
    return p;
}

// ---- groups -----------------------------------------------------------------------------------

// Which forms are tried. Merging pairs costs little; the other two forms are for printed results
// only.
enum effort { EFFORT_MERGE, EFFORT_ALL };

static struct ct_poly shorten(struct ct_collector *c, struct ct_poly p, enum effort effort)
{
    struct ct_poly best = shorter(c, p, merge(c, p));
    if (effort == EFFORT_MERGE || best.n < 2)
        return best;
    const struct ct_poly expanded = expand_angles(c, p);
    if (expanded.t != p.t)
        best = shorter(c, best, merge(c, expanded));
    // also the harmonics of the merged form: it has fewer terms and may be within the limit
    best = shorter(c, best, halves(c, harmonics(c, p)));
    return shorter(c, best, halves(c, harmonics(c, best)));
}

// Shorten a group of terms: its common factor is divided out and multiplied back.
static struct ct_poly shorten_group(struct ct_collector *c, struct ct_poly p,
                                    const void *effort)
{
    uint32_t rest = 0;
    if (p.n < 2)
        return p;
    for (size_t k = 0; k < ct_mono_length(&c->ps, p.t[0].mono); k++) {
        const struct ct_power power = ct_mono_power(&c->ps, p.t[0].mono, k);
        if (!c->atom[power.atom].angle)
            rest = times_power(c, rest, power.atom, power.exponent);
    }
    const uint32_t out = ct_mono_raise(&c->ps, rest, -1);
    for (size_t k = 0; k < p.n; k++)
        p.t[k].mono = ct_mono_times(&c->ps, p.t[k].mono, out);
    p = ct_poly_sum(&c->ps, p.t, p.n);
    p = shorten(c, p, *(const enum effort *)effort);
    return ct_poly_mul(&c->ps, p, ct_poly_term(&c->ps, 1, rest));
}

static struct ct_poly shorten_groups(struct ct_collector *c, struct ct_poly p,
                                     enum effort effort)
{
    struct keyed *k = CT_NEWN(c->arena, struct keyed, p.n);
    bool any = false;
    for (size_t i = 0; i < p.n; i++) {
        uint32_t rest = p.t[i].mono;
        for (size_t j = 0; j < ct_mono_length(&c->ps, p.t[i].mono); j++) {
            const struct ct_power power = ct_mono_power(&c->ps, p.t[i].mono, j);
            if (c->atom[power.atom].angle)
                rest = times_power(c, rest, power.atom, -power.exponent);
        }
        any |= rest != p.t[i].mono;
        k[i] = (struct keyed){rest, p.t[i]};
    }
    return any ? rewrite_parts(c, k, p.n, shorten_group, &effort) : p;
}

struct ct_poly ct_identity_merge(struct ct_collector *c, struct ct_poly p)
{
    return shorten_groups(c, p, EFFORT_MERGE);
}

struct ct_poly ct_identity_apply(struct ct_collector *c, struct ct_poly p)
{
    return shorten_groups(c, p, EFFORT_ALL);
}
