// Polynomials over atoms; see polynomial.h.
#include "expr/polynomial.h"

#include "base/sort.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

// Derived: a coefficient is the sum of up to 32 products, each rounded by half a unit in the last
// place: 16 units of the largest.
static const double noise = 16 * DBL_EPSILON;

static bool is_noise(const struct ct_term *t)
{
    return fabs(t->c) <= noise * t->size && isfinite(t->size);
}

bool ct_same_number(double a, double b)
{
    return fabs(a - b) <= noise * fmax(fabs(a), fabs(b));
}

void ct_polys_init(struct ct_polys *ps, struct ct_arena *arena)
{
    const struct ct_mono unit = {0, 0};
    *ps = (struct ct_polys){.arena = arena};
    CT_PUSH(arena, ps->mono, ps->nmono, ps->mono_cap, unit);
}

// ---- monomials ----------------------------------------------------------------------------------

static uint64_t hash_powers(const struct ct_power *p, size_t n)
{
    uint64_t h = n;
    for (size_t k = 0; k < n; k++)
        h = (h ^ p[k].atom ^ (uint64_t)(uint32_t)p[k].exponent << 32) * 0x9E3779B97F4A7C15u,
        h ^= h >> 29;
    return h;
}

static void rehash(struct ct_polys *ps)
{
    ps->hash_size = ps->hash_size ? 2 * ps->hash_size : 256;
    ps->hash = CT_NEWN(ps->arena, uint32_t, ps->hash_size);
    for (uint32_t m = 1; m < ps->nmono; m++) {
        size_t i
            = hash_powers(ps->pool + ps->mono[m].first, ps->mono[m].n) & (ps->hash_size - 1);
        while (ps->hash[i])
            i = (i + 1) & (ps->hash_size - 1);
        ps->hash[i] = m + 1;
    }
}

static uint32_t intern(struct ct_polys *ps, const struct ct_power *p, size_t n)
{
    if (n == 0)
        return 0;
    if (2 * (ps->nmono + 1) > ps->hash_size)
        rehash(ps);
    size_t i = hash_powers(p, n) & (ps->hash_size - 1);
    for (; ps->hash[i]; i = (i + 1) & (ps->hash_size - 1)) {
        const struct ct_mono *m = &ps->mono[ps->hash[i] - 1];
        if (m->n == n && !memcmp(ps->pool + m->first, p, n * sizeof *p))
            return ps->hash[i] - 1;
    }
    const struct ct_mono m = {(uint32_t)ps->npool, (uint32_t)n};
    for (size_t k = 0; k < n; k++)
        CT_PUSH(ps->arena, ps->pool, ps->npool, ps->pool_cap, p[k]);
    CT_PUSH(ps->arena, ps->mono, ps->nmono, ps->mono_cap, m);
    ps->hash[i] = (uint32_t)ps->nmono;
    return (uint32_t)ps->nmono - 1;
}

int32_t ct_mono_exponent(const struct ct_polys *ps, uint32_t mono, uint32_t atom)
{
    for (size_t k = 0; k < ct_mono_length(ps, mono); k++)
        if (ct_mono_power(ps, mono, k).atom == atom)
            return ct_mono_power(ps, mono, k).exponent;
    return 0;
}

uint32_t ct_mono_atom(struct ct_polys *ps, uint32_t atom, int32_t exponent)
{
    const struct ct_power p = {atom, exponent};
    return intern(ps, &p, exponent != 0);
}

// Limit: of the stack; longer monomials get their room from the arena.
enum { SHORT = 32 };

uint32_t ct_mono_times(struct ct_polys *ps, uint32_t a, uint32_t b)
{
    if (!a || !b)
        return a | b;
    const size_t na = ct_mono_length(ps, a), nb = ct_mono_length(ps, b);
    struct ct_power room[SHORT];
    struct ct_power *p = na + nb <= SHORT ? room : CT_NEWN(ps->arena, struct ct_power, na + nb);
    size_t n = 0, i = 0, j = 0;
    while (i < na || j < nb) {
        struct ct_power l = {UINT32_MAX, 0}, r = l;
        if (i < na)
            l = ct_mono_power(ps, a, i);
        if (j < nb)
            r = ct_mono_power(ps, b, j);
        p[n] = l.atom < r.atom ? l : r;
        if (l.atom == r.atom)
            p[n].exponent = l.exponent + r.exponent;
        i += l.atom <= r.atom;
        j += r.atom <= l.atom;
        n += p[n].exponent != 0;
    }
    return intern(ps, p, n);
}

uint32_t ct_mono_raise(struct ct_polys *ps, uint32_t a, int32_t k)
{
    const size_t n = ct_mono_length(ps, a);
    struct ct_power room[SHORT];
    struct ct_power *p = n <= SHORT ? room : CT_NEWN(ps->arena, struct ct_power, n);
    if (k == 0)
        return 0;
    for (size_t i = 0; i < n; i++) {
        p[i] = ct_mono_power(ps, a, i);
        p[i].exponent *= k;
    }
    return intern(ps, p, n);
}

// ---- polynomials -------------------------------------------------------------------------------

struct ct_poly ct_poly_term(struct ct_polys *ps, double c, uint32_t mono)
{
    struct ct_poly p = {0};
    if (c == 0)
        return p;
    p.t = CT_NEW(ps->arena, struct ct_term);
    p.t[p.n++] = (struct ct_term){c, fabs(c), mono};
    return p;
}

static int by_mono(const void *unused, const void *a, const void *b)
{
    const uint32_t m = ((const struct ct_term *)a)->mono, n = ((const struct ct_term *)b)->mono;
    (void)unused;
    return (m > n) - (m < n);
}

static void make_places(struct ct_polys *ps)
{
    if (ps->place_cap >= ps->nmono)
        return;
    ps->place_cap = 2 * ps->nmono;
    ps->place = CT_NEWN(ps->arena, uint32_t, ps->place_cap); // all 0 between calls
}

struct ct_poly ct_poly_sum(struct ct_polys *ps, struct ct_term *t, size_t n)
{
    size_t m = 0, kept = 0;
    make_places(ps);
    for (size_t k = 0; k < n; k++) {
        uint32_t *place = &ps->place[t[k].mono];
        if (!*place) {
            t[m++] = t[k];
            *place = (uint32_t)m;
            continue;
        }
        struct ct_term *to = &t[*place - 1];
        to->c += t[k].c;
        to->size = fmax(to->size, t[k].size);
    }
    for (size_t k = 0; k < m; k++) {
        ps->place[t[k].mono] = 0;
        if (!is_noise(&t[k]))
            t[kept++] = t[k];
    }
    ct_sort(ps->arena, t, kept, sizeof *t, by_mono, NULL);
    return (struct ct_poly){t, kept};
}

// Merge of the two sorted lists, with the rule of cancellation of ct_poly_sum.
struct ct_poly ct_poly_add(struct ct_polys *ps, struct ct_poly a, double c, struct ct_poly b)
{
    if (!b.n || c == 0)
        return a;
    struct ct_poly p = {CT_NEWN(ps->arena, struct ct_term, a.n + b.n), 0};
    size_t i = 0, j = 0;
    while (i < a.n || j < b.n) {
        struct ct_term t;
        const bool left = j == b.n || (i < a.n && a.t[i].mono <= b.t[j].mono);
        const bool both = left && j < b.n && a.t[i].mono == b.t[j].mono;
        if (left) {
            t = a.t[i++];
        } else {
            t = b.t[j++];
            t.c *= c;
            t.size *= fabs(c);
        }
        if (both) {
            t.c += c * b.t[j].c;
            t.size = fmax(t.size, fabs(c) * b.t[j].size);
            j++;
        }
        if (!is_noise(&t))
            p.t[p.n++] = t;
    }
    return p;
}

struct ct_poly ct_poly_mul(struct ct_polys *ps, struct ct_poly a, struct ct_poly b)
{
    struct ct_term *t = CT_NEWN(ps->arena, struct ct_term, a.n * b.n);
    size_t n = 0;
    for (size_t i = 0; i < a.n; i++)
        for (size_t j = 0; j < b.n; j++) {
            const struct ct_term *p = &a.t[i], *q = &b.t[j];
            t[n++] = (struct ct_term){p->c * q->c,
                                      fmax(p->size * fabs(q->c), fabs(p->c) * q->size),
                                      ct_mono_times(ps, p->mono, q->mono)};
        }
    return ct_poly_sum(ps, t, n);
}

struct ct_poly ct_poly_pow(struct ct_polys *ps, struct ct_poly a, int32_t k)
{
    assert(k >= 0);
    struct ct_poly p = ct_poly_term(ps, 1, 0);
    for (; k > 0; k--)
        p = ct_poly_mul(ps, p, a);
    return p;
}

bool ct_poly_is_const(struct ct_poly a, double *c)
{
    if (a.n > 1 || (a.n == 1 && a.t[0].mono != 0))
        return false;
    *c = a.n ? a.t[0].c : 0;
    return true;
}
