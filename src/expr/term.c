// Sums as terms, products as factors, both in order; see term.h.
#include "expr/term.h"

#include "base/sort.h"
#include "expr/fraction.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *ct_printer_name(const struct ct_printer *pr, ct_ex e)
{
    return pr->p.node && e.id != pr->body ? pr->p.node(pr->p.data, e) : NULL;
}

// ---- the order of factors ----------------------------------------------------------------------

static enum ct_factor_class class_of_symbol(enum ct_sym_kind kind)
{
    switch (kind) {
    case CT_SYM_PARAM:
        return CT_FACTOR_PARAM;
    case CT_SYM_U:
        return CT_FACTOR_SPEED;
    case CT_SYM_A:
        return CT_FACTOR_ACCELERATION;
    case CT_SYM_LAM:
        return CT_FACTOR_MULTIPLIER;
    default:
        return CT_FACTOR_SYMBOL;
    }
}

static enum ct_factor_class class_of(const struct ct_printer *pr, ct_ex e)
{
    const struct ct_exnode *n = ct_ex_node(pr->x, e);
    if (n->op == CT_OP_SYM)
        return class_of_symbol(pr->x->sym[n->a].kind);
    if (ct_printer_name(pr, e))
        return CT_FACTOR_NAMED;
    if (n->op != CT_OP_ADD && n->op != CT_OP_SUB)
        return CT_FACTOR_FUNCTION;
    return ct_ex_kinds(pr->x, e) & ~(1u << CT_SYM_PARAM) ? CT_FACTOR_SUM : CT_FACTOR_PARAM_SUM;
}

static int compare_number(long a, long b)
{
    return (a > b) - (a < b);
}

static int compare_symbols(const struct ct_printer *pr, uint32_t a, uint32_t b)
{
    int r = 0;
    if (pr->p.rank)
        r = compare_number(pr->p.rank(pr->p.data, &pr->x->sym[a]),
                           pr->p.rank(pr->p.data, &pr->x->sym[b]));
    return r ? r : compare_number(a, b);
}

// Compare by structure, so that the order does not depend on the order of construction. By id if
// the nodes near the top are equal.
static int compare_nodes(const struct ct_printer *pr, ct_ex a, ct_ex b, int depth)
{
    const struct ct_exnode *m = ct_ex_node(pr->x, a), *n = ct_ex_node(pr->x, b);
    if (ct_ex_same(a, b))
        return 0;
    if (m->op == CT_OP_SYM && n->op == CT_OP_SYM) {
        int r = compare_number(class_of(pr, a), class_of(pr, b));
        return r ? r : compare_symbols(pr, m->a, n->a);
    }
    const int narg = ct_op_info[m->op].narg;
    if (narg != ct_op_info[n->op].narg)
        return compare_number(narg, ct_op_info[n->op].narg);
    if (narg > 0 && depth > 0) {
        int r = compare_nodes(pr, (ct_ex){m->a}, (ct_ex){n->a}, depth - 1);
        if (!r && narg > 1)
            r = compare_nodes(pr, (ct_ex){m->b}, (ct_ex){n->b}, depth - 1);
        if (r)
            return r;
    }
    return m->op != n->op ? compare_number(m->op, n->op) : compare_number(a.id, b.id);
}

static int compare_bases(const struct ct_printer *pr, const struct ct_factor *a,
                         const struct ct_factor *b)
{
    int r = compare_number(a->class, b->class);
    return r ? r : compare_nodes(pr, a->e, b->e, 8);
}

// Parameters with exponent 1 come first: m*l^2, not l^2*m.
static int compare_factors(const void *context, const void *va, const void *vb)
{
    const struct ct_factor *a = va, *b = vb;
    if (a->class == CT_FACTOR_PARAM && b->class == CT_FACTOR_PARAM
        && a->exponent != b->exponent)
        return compare_number(a->exponent, b->exponent);
    return compare_bases(context, a, b);
}

// ---- terms ------------------------------------------------------------------------------------

static void push_factor(struct ct_printer *pr, struct ct_factors *f, ct_ex e, int exponent)
{
    for (size_t k = 0; k < f->n; k++)
        if (ct_ex_same(f->at[k].e, e)) {
            f->at[k].exponent += exponent;
            return;
        }
    const struct ct_factor one = {e, exponent, class_of(pr, e)};
    CT_PUSH(pr->arena, f->at, f->n, f->cap, one);
}

int ct_whole_exponent(const struct ct_exs *x, ct_ex e)
{
    double v;
    if (!ct_ex_is_const(x, e, &v) || v != floor(v) || fabs(v) > 99)
        return 0;
    return (int)v;
}

// t *= e^exponent
static void flatten_product(struct ct_printer *pr, struct ct_term *t, ct_ex e, int exponent)
{
    const struct ct_exnode *n = ct_ex_node(pr->x, e);
    double v;
    if (pr->left)
        pr->left--;
    if (ct_ex_is_const(pr->x, e, &v) && abs(exponent) == 1) {
        t->negative ^= v < 0;
        *(exponent > 0 ? &t->number : &t->divisor) *= fabs(v);
        return;
    }
    if (!ct_printer_name(pr, e) && pr->left) {
        switch (n->op) {
        case CT_OP_MUL:
            flatten_product(pr, t, (ct_ex){n->a}, exponent);
            flatten_product(pr, t, (ct_ex){n->b}, exponent);
            return;
        case CT_OP_DIV:
            flatten_product(pr, t, (ct_ex){n->a}, exponent);
            flatten_product(pr, t, (ct_ex){n->b}, -exponent);
            return;
        case CT_OP_NEG:
            t->negative ^= exponent & 1;
            flatten_product(pr, t, (ct_ex){n->a}, exponent);
            return;
        case CT_OP_POW:
            if (ct_whole_exponent(pr->x, (ct_ex){n->b}) && abs(exponent) < 100) {
                flatten_product(pr, t, (ct_ex){n->a},
                                exponent * ct_whole_exponent(pr->x, (ct_ex){n->b}));
                return;
            }
            break;
        default:
            break;
        }
    }
    push_factor(pr, exponent > 0 ? &t->above : &t->below, e, abs(exponent));
}

static int class_of_term(const struct ct_printer *pr, const struct ct_term *t)
{
    unsigned kinds = 0;
    bool symbol = false;
    for (size_t k = 0; k < t->above.n + t->below.n; k++) {
        const struct ct_factor *f
            = k < t->above.n ? &t->above.at[k] : &t->below.at[k - t->above.n];
        kinds |= ct_ex_kinds(pr->x, f->e);
        symbol |= f->class == CT_FACTOR_SYMBOL;
    }
    if (kinds & 1u << CT_SYM_A)
        return CT_TERM_ACCELERATION;
    if (kinds & 1u << CT_SYM_LAM)
        return CT_TERM_MULTIPLIER;
    if (kinds & 1u << CT_SYM_U)
        return CT_TERM_SPEED;
    if (symbol)
        return CT_TERM_SYMBOL;
    return kinds & ~(1u << CT_SYM_PARAM) ? CT_TERM_FUNCTION : CT_TERM_PARAM;
}

// 0.3714285714285714 -> 13/35.
static void split_small_fraction(struct ct_term *t)
{
    double n, d;
    if (ct_fraction_find(t->number, &n, &d)) {
        t->number = n;
        t->divisor = d;
    }
}

void ct_term_split_pi(struct ct_term *t)
{
    double n, d;
    t->pi = ct_fraction_of_pi(t->number / t->divisor, &n, &d);
    if (t->pi) {
        t->number = n;
        t->divisor = d;
    }
}

// 0.75 -> 3/4: exact, since the divisor is a power of two.
static void split_fraction(struct ct_term *t)
{
    double divisor = 1;
    while (divisor < 16 && t->number * divisor != floor(t->number * divisor))
        divisor *= 2;
    if (divisor == 16 || t->number * divisor > 99)
        return;
    t->number *= divisor;
    t->divisor *= divisor;
}

// Does the term contain a parameter? If not, its number comes from data and keeps its digits.
static bool has_parameter(const struct ct_printer *pr, const struct ct_term *t)
{
    unsigned kinds = 0;
    for (size_t k = 0; k < t->above.n; k++)
        kinds |= ct_ex_kinds(pr->x, t->above.at[k].e);
    for (size_t k = 0; k < t->below.n; k++)
        kinds |= ct_ex_kinds(pr->x, t->below.at[k].e);
    return kinds & 1u << CT_SYM_PARAM;
}

static struct ct_term make_term(struct ct_printer *pr, ct_ex e, bool negative)
{
    struct ct_term t
        = {.e = e, .is_subtracted = negative, .negative = negative, .number = 1, .divisor = 1};
    flatten_product(pr, &t, e, 1);
    if (pr->p.fractions) {
        t.number = ct_fraction_tidy(t.number);
        ct_term_split_pi(&t);
    }
    // a term that is only a number stays a short decimal
    if (pr->p.fractions && t.above.n && t.divisor == 1 && !t.pi
        && (pr->p.no_data || has_parameter(pr, &t)))
        split_fraction(&t);
    if (pr->p.fractions && t.divisor == 1 && !t.pi)
        split_small_fraction(&t);
    ct_sort(pr->arena, t.above.at, t.above.n, sizeof *t.above.at, compare_factors, pr);
    ct_sort(pr->arena, t.below.at, t.below.n, sizeof *t.below.at, compare_factors, pr);
    t.class = class_of_term(pr, &t);
    return t;
}

// Compare terms of one class by their factors: from the last factor, which is the speed or
// acceleration; in other classes from the first. Plain numbers come last.
static int compare_terms(const void *context, const void *va, const void *vb)
{
    const struct ct_printer *pr = context;
    const struct ct_term *a = va, *b = vb;
    const struct ct_factors *f = &a->above, *g = &b->above;
    if (a->class != b->class)
        return compare_number(a->class, b->class);
    if (!f->n != !g->n)
        return f->n ? -1 : 1;
    const bool backwards = a->class == CT_TERM_ACCELERATION || a->class == CT_TERM_SPEED
                        || a->class == CT_TERM_MULTIPLIER;
    for (size_t k = 0; k < f->n && k < g->n; k++) {
        const struct ct_factor *p = &f->at[backwards ? f->n - 1 - k : k];
        const struct ct_factor *q = &g->at[backwards ? g->n - 1 - k : k];
        int r = compare_bases(pr, p, q);
        if (!r)
            r = compare_number(q->exponent, p->exponent);
        if (r)
            return r;
    }
    return compare_number((long)f->n, (long)g->n);
}

// ---- sums -------------------------------------------------------------------------------------

struct summand {
    ct_ex e;
    bool negative;
};

// With an explicit stack: sums may be nested deeper than the call stack allows.
static void flatten_sum(struct ct_printer *pr, struct ct_terms *t, ct_ex e)
{
    struct summand *wait = NULL, next = {e, false};
    size_t n = 0, cap = 0;
    CT_PUSH(pr->arena, wait, n, cap, next);
    while (n) {
        const struct summand s = wait[--n];
        const struct ct_exnode *node = ct_ex_node(pr->x, s.e);
        const bool is_whole = ct_printer_name(pr, s.e) || !pr->left;
        const bool is_sum = node->op == CT_OP_ADD || node->op == CT_OP_SUB;
        pr->left -= !is_whole;
        if (is_whole || !(is_sum || node->op == CT_OP_NEG)) {
            struct ct_term one = make_term(pr, s.e, s.negative);
            CT_PUSH(pr->arena, t->at, t->n, t->cap, one);
            continue;
        }
        if (is_sum) {
            next = (struct summand){{node->b}, s.negative ^ (node->op == CT_OP_SUB)};
            CT_PUSH(pr->arena, wait, n, cap, next);
        }
        next = (struct summand){{node->a}, s.negative ^ (node->op == CT_OP_NEG)};
        CT_PUSH(pr->arena, wait, n, cap, next);
    }
}

static size_t count_class(const struct ct_terms *t, enum ct_term_class class)
{
    size_t n = 0;
    for (size_t k = 0; k < t->n; k++)
        n += t->at[k].class == class;
    return n;
}

// Move a positive term to the front: x - x0 in place of -x0 + x. Terms of its class stay before
// those with speeds, and constraint forces stay last.
static void lead_with_positive(struct ct_terms *t)
{
    size_t k = 0;
    while (k < t->n && t->at[k].negative)
        k++;
    if (k == 0 || k == t->n)
        return;
    const enum ct_term_class from = t->at[0].class, to = t->at[k].class;
    if (from != to
        && (to == CT_TERM_MULTIPLIER || (from <= CT_TERM_SPEED && count_class(t, to) > 1)))
        return;
    const struct ct_term first = t->at[k];
    memmove(t->at + 1, t->at, k * sizeof *t->at);
    t->at[0] = first;
}

struct ct_terms ct_terms_of_sum(struct ct_printer *pr, ct_ex e)
{
    struct ct_terms t = {0};
    flatten_sum(pr, &t, e);
    ct_sort(pr->arena, t.at, t.n, sizeof *t.at, compare_terms, pr);
    lead_with_positive(&t);
    return t;
}
