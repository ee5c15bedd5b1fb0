// Printing expressions; see print.h.
//
// A sum is flattened to terms, a term to a number, factors with exponents and a denominator; both
// lists are sorted and written. Everything else is written as it stands.
#include "expr/print.h"

#include "base/sort.h"
#include "expr/fraction.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct printer {
    struct ct_arena *arena;
    const struct ct_exs *x;
    struct ct_print p;
    uint32_t body; // printed although it has a name
    size_t left;   // items that may still be printed
    size_t depth;  // of nested groups
    char *s;
    size_t n, cap;
};

// How tightly the surroundings bind: parentheses go around what binds less.
enum level { LEVEL_ANY, LEVEL_SUM, LEVEL_FACTOR, LEVEL_BASE };

static void emit(struct printer *pr, ct_ex e, enum level level);

// ---- pieces of text ---------------------------------------------------------------------------

static void put(struct printer *pr, const char *s)
{
    for (; *s; s++)
        CT_PUSH(pr->arena, pr->s, pr->n, pr->cap, *s);
}

const char *ct_number_text(struct ct_arena *a, double v)
{
    char s[40];
    if (v == floor(v) && fabs(v) < 1e7) // 60, not 6e+01
        return ct_arena_printf(a, "%.0f", v);
    for (int digits = 1; digits <= 17; digits += digits < 15 ? 14 : 1) {
        snprintf(s, sizeof s, "%.*g", digits, v);
        if (strtod(s, NULL) == v)
            break;
    }
    return ct_arena_strdup(a, s);
}

const char *ct_number_c(struct ct_arena *a, double v)
{
    if (isnan(v))
        return "NAN";
    if (isinf(v))
        return v > 0 ? "INFINITY" : "(-INFINITY)";
    char s[40];
    snprintf(s, sizeof s, "%.17g", v);
    const char *point = strpbrk(s, ".e") ? "" : ".0";
    return ct_arena_printf(a, v < 0 ? "(%s%s)" : "%s%s", s, point);
}

static bool is_latex(const struct printer *pr)
{
    return pr->p.style == CT_PRINT_LATEX;
}

static void put_number(struct printer *pr, double v)
{
    const char *s = ct_number_text(pr->arena, v), *e = strchr(s, 'e');
    if (!is_latex(pr) || !e) {
        put(pr, s);
        return;
    }
    if (strncmp(s, "1e", 2)) {
        put(pr, ct_arena_strndup(pr->arena, s, (size_t)(e - s)));
        put(pr, " \\cdot ");
    }
    put(pr, ct_arena_printf(pr->arena, "10^{%d}", atoi(e + 1)));
}

static void open_group(struct printer *pr, bool needed)
{
    if (needed)
        put(pr, is_latex(pr) ? "\\left(" : "(");
}

static void close_group(struct printer *pr, bool needed)
{
    if (needed)
        put(pr, is_latex(pr) ? "\\right)" : ")");
}

static const char *name_of(const struct printer *pr, ct_ex e)
{
    return pr->p.node && e.id != pr->body ? pr->p.node(pr->p.data, e) : NULL;
}

// ---- the order of factors ------------------------------------------------------------------------

enum factor_class {
    FACTOR_PARAM,
    FACTOR_PARAM_SUM,
    FACTOR_SYMBOL,
    FACTOR_NAMED,
    FACTOR_FUNCTION,
    FACTOR_SUM,
    FACTOR_SPEED,
    FACTOR_ACCELERATION,
    FACTOR_MULTIPLIER
};

struct factor {
    ct_ex e;
    int exponent;
    enum factor_class class;
};

static enum factor_class class_of_symbol(enum ct_sym_kind kind)
{
    switch (kind) {
    case CT_SYM_PARAM:
        return FACTOR_PARAM;
    case CT_SYM_U:
        return FACTOR_SPEED;
    case CT_SYM_A:
        return FACTOR_ACCELERATION;
    case CT_SYM_LAM:
        return FACTOR_MULTIPLIER;
    default:
        return FACTOR_SYMBOL;
    }
}

static enum factor_class class_of(const struct printer *pr, ct_ex e)
{
    const struct ct_exnode *n = ct_ex_node(pr->x, e);
    if (n->op == CT_OP_SYM)
        return class_of_symbol(pr->x->sym[n->a].kind);
    if (name_of(pr, e))
        return FACTOR_NAMED;
    if (n->op != CT_OP_ADD && n->op != CT_OP_SUB)
        return FACTOR_FUNCTION;
    return ct_ex_kinds(pr->x, e) & ~(1u << CT_SYM_PARAM) ? FACTOR_SUM : FACTOR_PARAM_SUM;
}

static int compare_number(long a, long b)
{
    return (a > b) - (a < b);
}

static int compare_symbols(const struct printer *pr, uint32_t a, uint32_t b)
{
    int r = 0;
    if (pr->p.rank)
        r = compare_number(pr->p.rank(pr->p.data, &pr->x->sym[a]),
                           pr->p.rank(pr->p.data, &pr->x->sym[b]));
    return r ? r : compare_number(a, b);
}

// By structure, so that the order does not follow the accidents of construction; by id where nothing
// near the top decides.
static int compare_nodes(const struct printer *pr, ct_ex a, ct_ex b, int depth)
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

static int compare_bases(const struct printer *pr, const struct factor *a,
                         const struct factor *b)
{
    int r = compare_number(a->class, b->class);
    return r ? r : compare_nodes(pr, a->e, b->e, 8);
}

// Of parameters the linear ones come first: m*l^2, not l^2*m.
static int compare_factors(const void *context, const void *va, const void *vb)
{
    const struct factor *a = va, *b = vb;
    if (a->class == FACTOR_PARAM && b->class == FACTOR_PARAM && a->exponent != b->exponent)
        return compare_number(a->exponent, b->exponent);
    return compare_bases(context, a, b);
}

// ---- terms ------------------------------------------------------------------------------------

struct factors {
    struct factor *at;
    size_t n, cap;
};

// number * above / (divisor * below)
struct term {
    bool negative;
    double number, divisor;
    int pi; // its exponent
    struct factors above, below;
    int class;
};

static void push_factor(struct printer *pr, struct factors *f, ct_ex e, int exponent)
{
    for (size_t k = 0; k < f->n; k++)
        if (ct_ex_same(f->at[k].e, e)) {
            f->at[k].exponent += exponent;
            return;
        }
    const struct factor one = {e, exponent, class_of(pr, e)};
    CT_PUSH(pr->arena, f->at, f->n, f->cap, one);
}

// A whole number between 2 and 99 as exponent, or 0.
static int whole_exponent(const struct ct_exs *x, ct_ex e)
{
    double v;
    if (!ct_ex_is_const(x, e, &v) || v != floor(v) || fabs(v) > 99)
        return 0;
    return (int)v;
}

// t *= e^exponent
static void flatten_product(struct printer *pr, struct term *t, ct_ex e, int exponent)
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
    if (!name_of(pr, e) && pr->left) {
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
            if (whole_exponent(pr->x, (ct_ex){n->b}) && abs(exponent) < 100) {
                flatten_product(pr, t, (ct_ex){n->a},
                                exponent * whole_exponent(pr->x, (ct_ex){n->b}));
                return;
            }
            break;
        default:
            break;
        }
    }
    push_factor(pr, exponent > 0 ? &t->above : &t->below, e, abs(exponent));
}

enum { TERM_ACCELERATION, TERM_SPEED, TERM_SYMBOL, TERM_PARAM, TERM_FUNCTION, TERM_MULTIPLIER };

static int class_of_term(const struct printer *pr, const struct term *t)
{
    unsigned kinds = 0;
    bool symbol = false;
    for (size_t k = 0; k < t->above.n + t->below.n; k++) {
        const struct factor *f
            = k < t->above.n ? &t->above.at[k] : &t->below.at[k - t->above.n];
        kinds |= ct_ex_kinds(pr->x, f->e);
        symbol |= f->class == FACTOR_SYMBOL;
    }
    if (kinds & 1u << CT_SYM_A)
        return TERM_ACCELERATION;
    if (kinds & 1u << CT_SYM_LAM)
        return TERM_MULTIPLIER;
    if (kinds & 1u << CT_SYM_U)
        return TERM_SPEED;
    if (symbol)
        return TERM_SYMBOL;
    return kinds & ~(1u << CT_SYM_PARAM) ? TERM_FUNCTION : TERM_PARAM;
}

// 0.3714285714285714 -> 13/35.
static void split_small_fraction(struct term *t)
{
    double n, d;
    if (ct_fraction_find(t->number, &n, &d)) {
        t->number = n;
        t->divisor = d;
    }
}

// 6.283185307179586 -> 2 pi.
static void split_pi(struct term *t)
{
    double n, d;
    t->pi = ct_fraction_of_pi(t->number / t->divisor, &n, &d);
    if (t->pi) {
        t->number = n;
        t->divisor = d;
    }
}

// 0.75 -> 3/4: powers of two do not round.
static void split_fraction(struct term *t)
{
    double divisor = 1;
    while (divisor < 16 && t->number * divisor != floor(t->number * divisor))
        divisor *= 2;
    if (divisor == 16 || t->number * divisor > 99)
        return;
    t->number *= divisor;
    t->divisor *= divisor;
}

static struct term make_term(struct printer *pr, ct_ex e, bool negative)
{
    struct term t = {.negative = negative, .number = 1, .divisor = 1};
    flatten_product(pr, &t, e, 1);
    if (pr->p.fractions) {
        t.number = ct_fraction_tidy(t.number);
        split_pi(&t);
    }
    // a number alone stays a short decimal
    if (pr->p.fractions && t.above.n && t.divisor == 1 && !t.pi)
        split_fraction(&t);
    if (pr->p.fractions && t.divisor == 1 && !t.pi)
        split_small_fraction(&t);
    ct_sort(pr->arena, t.above.at, t.above.n, sizeof *t.above.at, compare_factors, pr);
    ct_sort(pr->arena, t.below.at, t.below.n, sizeof *t.below.at, compare_factors, pr);
    t.class = class_of_term(pr, &t);
    return t;
}

// Terms of one class by their factors: from the last one, where the speed or acceleration stands,
// and from the first one in the other classes. Numbers alone come last.
static int compare_terms(const void *context, const void *va, const void *vb)
{
    const struct printer *pr = context;
    const struct term *a = va, *b = vb;
    const struct factors *f = &a->above, *g = &b->above;
    if (a->class != b->class)
        return compare_number(a->class, b->class);
    if (!f->n != !g->n)
        return f->n ? -1 : 1;
    const bool backwards = a->class == TERM_ACCELERATION || a->class == TERM_SPEED
                        || a->class == TERM_MULTIPLIER;
    for (size_t k = 0; k < f->n && k < g->n; k++) {
        const struct factor *p = &f->at[backwards ? f->n - 1 - k : k];
        const struct factor *q = &g->at[backwards ? g->n - 1 - k : k];
        int r = compare_bases(pr, p, q);
        if (!r)
            r = compare_number(q->exponent, p->exponent);
        if (r)
            return r;
    }
    return compare_number((long)f->n, (long)g->n);
}

// ---- products -----------------------------------------------------------------------------------

static bool is_trig(const struct ct_exnode *n)
{
    return n->op == CT_OP_SIN || n->op == CT_OP_COS || n->op == CT_OP_TAN;
}

static void emit_argument(struct printer *pr, ct_ex e);

static void emit_factor(struct printer *pr, const struct factor *f, bool alone)
{
    const struct ct_exnode *n = ct_ex_node(pr->x, f->e);
    if (f->exponent == 1) {
        emit(pr, f->e, alone ? LEVEL_ANY : LEVEL_FACTOR);
        return;
    }
    if (is_latex(pr) && is_trig(n) && !name_of(pr, f->e)) {
        put(pr, ct_arena_printf(pr->arena, "\\%s^{%d}", ct_op_info[n->op].name, f->exponent));
        emit_argument(pr, (ct_ex){n->a});
        return;
    }
    emit(pr, f->e, LEVEL_BASE);
    put(pr, ct_arena_printf(pr->arena, is_latex(pr) ? "^{%d}" : "^%d", f->exponent));
}

static void put_pi(struct printer *pr, int exponent)
{
    put(pr, is_latex(pr) ? "\\pi" : "pi");
    if (exponent == 2)
        put(pr, "^2");
}

// In LaTeX \frac groups, so a single factor needs no parentheses. pi: its exponent, 0 for none.
static void emit_factors(struct printer *pr, double number, int pi, const struct factors *f,
                         bool grouped)
{
    const char *times = is_latex(pr) ? " \\, " : "*";
    const bool show = number != 1 || (f->n == 0 && pi < 1);
    if (show)
        put_number(pr, number);
    if (show && pi > 0)
        put(pr, is_latex(pr) ? " " : times);
    if (pi > 0)
        put_pi(pr, pi);
    for (size_t k = 0; k < f->n; k++) {
        if (k > 0 || show || pi > 0)
            put(pr, k == 0 && is_latex(pr) ? " " : times);
        emit_factor(pr, &f->at[k], grouped && f->n == 1 && !show && pi < 1);
    }
}

static void emit_term(struct printer *pr, const struct term *t)
{
    const size_t below = t->below.n + (t->divisor != 1) + (t->pi < 0);
    if (!below) {
        emit_factors(pr, t->number, t->pi, &t->above, false);
    } else if (is_latex(pr)) {
        put(pr, "\\frac{");
        emit_factors(pr, t->number, t->pi, &t->above, true);
        put(pr, "}{");
        emit_factors(pr, t->divisor, -t->pi, &t->below, true);
        put(pr, "}");
    } else {
        emit_factors(pr, t->number, t->pi, &t->above, false);
        put(pr, below > 1 ? "/(" : "/");
        emit_factors(pr, t->divisor, -t->pi, &t->below, false);
        put(pr, below > 1 ? ")" : "");
    }
}

// ---- sums -------------------------------------------------------------------------------------

struct terms {
    struct term *at;
    size_t n, cap;
};

struct summand {
    ct_ex e;
    bool negative;
};

// Sums may be nested deeper than calls can be.
static void flatten_sum(struct printer *pr, struct terms *t, ct_ex e)
{
    struct summand *wait = NULL, next = {e, false};
    size_t n = 0, cap = 0;
    CT_PUSH(pr->arena, wait, n, cap, next);
    while (n) {
        const struct summand s = wait[--n];
        const struct ct_exnode *node = ct_ex_node(pr->x, s.e);
        const bool is_whole = name_of(pr, s.e) || !pr->left;
        const bool is_sum = node->op == CT_OP_ADD || node->op == CT_OP_SUB;
        pr->left -= !is_whole;
        if (is_whole || !(is_sum || node->op == CT_OP_NEG)) {
            const struct term one = make_term(pr, s.e, s.negative);
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

static size_t count_class(const struct terms *t, int class)
{
    size_t n = 0;
    for (size_t k = 0; k < t->n; k++)
        n += t->at[k].class == class;
    return n;
}

// x - x0 rather than -x0 + x; but it does not leave others of its kind behind speeds, and forces of
// constraint stay last.
static void lead_with_positive(struct terms *t)
{
    size_t k = 0;
    while (k < t->n && t->at[k].negative)
        k++;
    if (k == 0 || k == t->n)
        return;
    const int from = t->at[0].class, to = t->at[k].class;
    if (from != to && (to == TERM_MULTIPLIER || (from <= TERM_SPEED && count_class(t, to) > 1)))
        return;
    const struct term first = t->at[k];
    memmove(t->at + 1, t->at, k * sizeof *t->at);
    t->at[0] = first;
}

static void emit_sum(struct printer *pr, ct_ex e, enum level level)
{
    struct terms t = {0};
    flatten_sum(pr, &t, e);
    ct_sort(pr->arena, t.at, t.n, sizeof *t.at, compare_terms, pr);
    lead_with_positive(&t);
    const bool group
        = (t.n > 1 || t.at[0].negative) ? level >= LEVEL_FACTOR : level >= LEVEL_BASE;
    open_group(pr, group);
    for (size_t k = 0; k < t.n; k++) {
        if (k == 0)
            put(pr, t.at[k].negative ? "-" : "");
        else
            put(pr, t.at[k].negative ? " - " : " + ");
        emit_term(pr, &t.at[k]);
    }
    close_group(pr, group);
}

// ---- everything else ------------------------------------------------------------------------------

// In LaTeX a symbol needs no parentheses after a function.
static void emit_argument(struct printer *pr, ct_ex e)
{
    const bool bare = is_latex(pr) && ct_ex_node(pr->x, e)->op == CT_OP_SYM;
    put(pr, bare ? " " : "");
    open_group(pr, !bare);
    emit(pr, e, LEVEL_ANY);
    close_group(pr, !bare);
}

static void emit_call(struct printer *pr, const char *name, const struct ct_exnode *n)
{
    const ct_ex arg[3] = {{n->a}, {n->b}, {n->c}};
    put(pr, name);
    if (ct_op_info[n->op].narg == 1) {
        emit_argument(pr, arg[0]);
        return;
    }
    open_group(pr, true);
    for (int k = 0; k < ct_op_info[n->op].narg; k++) {
        put(pr, k ? ", " : "");
        emit(pr, arg[k], LEVEL_ANY);
    }
    close_group(pr, true);
}

static const char *table_name(const struct printer *pr, const struct ct_exnode *n)
{
    const char *column = pr->x->table[n->b].column;
    char *s = column ? ct_arena_strdup(pr->arena, column)
                     : ct_arena_printf(pr->arena, "table%u", n->b + 1);
    if (is_latex(pr))
        s = ct_arena_printf(pr->arena, "\\mathrm{%s}", s);
    for (uint32_t k = 0; k < n->c; k++)
        s = ct_arena_printf(pr->arena, "%s'", s);
    return s;
}

static const char *latex_function(uint32_t op)
{
    switch (op) {
    case CT_OP_ASIN:
        return "\\arcsin";
    case CT_OP_ACOS:
        return "\\arccos";
    case CT_OP_ATAN:
        return "\\arctan";
    case CT_OP_ATAN2:
        return "\\operatorname{atan2}";
    case CT_OP_SIGN:
        return "\\operatorname{sign}";
    case CT_OP_LOG:
        return "\\ln";
    default:
        return NULL; // the name with a backslash
    }
}

static void emit_wrapped(struct printer *pr, const char *before, uint32_t id, const char *after)
{
    put(pr, before);
    emit(pr, (ct_ex){id}, LEVEL_ANY);
    put(pr, after);
}

static bool is_comparison(uint32_t op)
{
    return op >= CT_OP_LT && op <= CT_OP_EQ;
}

static void emit_cases(struct printer *pr, const struct ct_exnode *n)
{
    const bool comparison = is_comparison(ct_ex_node(pr->x, (ct_ex){n->a})->op);
    emit_wrapped(pr, "\\begin{cases} ", n->b, " & ");
    emit_wrapped(pr, "", n->a, comparison ? " \\\\ " : " \\neq 0 \\\\ ");
    emit_wrapped(pr, "", n->c, " & \\text{otherwise} \\end{cases}");
}

static void emit_function(struct printer *pr, const struct ct_exnode *n)
{
    const char *name = ct_op_info[n->op].name;
    if (n->op == CT_OP_TABLE) {
        emit_call(pr, table_name(pr, n), n);
    } else if (!is_latex(pr)) {
        emit_call(pr, name, n);
    } else if (n->op == CT_OP_SQRT) {
        emit_wrapped(pr, "\\sqrt{", n->a, "}");
    } else if (n->op == CT_OP_ABS) {
        emit_wrapped(pr, "\\left|", n->a, "\\right|");
    } else if (n->op == CT_OP_IF) {
        emit_cases(pr, n);
    } else {
        const char *special = latex_function(n->op);
        emit_call(pr, special ? special : ct_arena_printf(pr->arena, "\\%s", name), n);
    }
}

static const char *comparison_sign(const struct printer *pr, uint32_t op)
{
    if (is_latex(pr) && op != CT_OP_LT && op != CT_OP_GT)
        return op == CT_OP_LE ? "\\leq" : op == CT_OP_GE ? "\\geq" : "=";
    return ct_op_info[op].name;
}

static void emit_comparison(struct printer *pr, const struct ct_exnode *n, enum level level)
{
    open_group(pr, level > LEVEL_ANY);
    emit(pr, (ct_ex){n->a}, LEVEL_SUM);
    put(pr, ct_arena_printf(pr->arena, " %s ", comparison_sign(pr, n->op)));
    emit(pr, (ct_ex){n->b}, LEVEL_SUM);
    close_group(pr, level > LEVEL_ANY);
}

static void emit_power(struct printer *pr, const struct ct_exnode *n, enum level level)
{
    open_group(pr, level == LEVEL_BASE);
    emit(pr, (ct_ex){n->a}, LEVEL_BASE);
    put(pr, is_latex(pr) ? "^{" : "^");
    emit(pr, (ct_ex){n->b}, is_latex(pr) ? LEVEL_ANY : LEVEL_BASE);
    put(pr, is_latex(pr) ? "}" : "");
    close_group(pr, level == LEVEL_BASE);
}

// Where a fraction of a power of pi stands alone it is a term.
static bool emit_pi(struct printer *pr, double v, enum level level)
{
    struct term t = {.negative = v < 0, .number = fabs(v), .divisor = 1};
    split_pi(&t);
    if (!t.pi)
        return false;
    open_group(pr, level >= LEVEL_FACTOR);
    put(pr, t.negative ? "-" : "");
    emit_term(pr, &t);
    close_group(pr, level >= LEVEL_FACTOR);
    return true;
}

static void emit_const(struct printer *pr, double v, enum level level)
{
    double n, d;
    if (pr->p.fractions)
        v = ct_fraction_tidy(v);
    if (pr->p.fractions && emit_pi(pr, v, level))
        return;
    if (pr->p.fractions && ct_fraction_find(v, &n, &d)) {
        open_group(pr, level >= LEVEL_FACTOR);
        put(pr,
            ct_arena_printf(pr->arena, is_latex(pr) ? "%s\\frac{%.0f}{%.0f}" : "%s%.0f/%.0f",
                            n < 0 ? "-" : "", fabs(n), d));
        close_group(pr, level >= LEVEL_FACTOR);
        return;
    }
    const bool group
        = (v < 0 && level >= LEVEL_FACTOR)
       || (is_latex(pr) && level == LEVEL_BASE && strchr(ct_number_text(pr->arena, v), 'e'));
    open_group(pr, group);
    put_number(pr, v);
    close_group(pr, group);
}

static const char *symbol_text(const struct printer *pr, const struct ct_sym *s)
{
    if (pr->p.symbol)
        return pr->p.symbol(pr->p.data, pr->arena, s);
    switch (pr->p.style) {
    case CT_PRINT_LATEX:
        return ct_latex_name(pr->arena, s->name);
    case CT_PRINT_C:
        return ct_c_name(pr->arena, s->name);
    default:
        return s->name;
    }
}

// Parentheses within parentheses: far beyond reading, well within the stack.
enum { DEEPEST = 500 };

static void emit(struct printer *pr, ct_ex e, enum level level)
{
    const struct ct_exnode *n = ct_ex_node(pr->x, e);
    const char *name = name_of(pr, e);
    double v;
    if (name) {
        put(pr, name);
        return;
    }
    if (!pr->left || pr->depth == DEEPEST) {
        put(pr, "...");
        return;
    }
    pr->left--;
    pr->depth++;
    if (ct_ex_is_const(pr->x, e, &v))
        emit_const(pr, v, level);
    else if (n->op == CT_OP_SYM)
        put(pr, symbol_text(pr, &pr->x->sym[n->a]));
    else if (n->op == CT_OP_ADD || n->op == CT_OP_SUB || n->op == CT_OP_NEG
             || n->op == CT_OP_MUL || n->op == CT_OP_DIV
             || (n->op == CT_OP_POW && whole_exponent(pr->x, (ct_ex){n->b})))
        emit_sum(pr, e, level);
    else if (n->op == CT_OP_POW)
        emit_power(pr, n, level);
    else if (is_comparison(n->op))
        emit_comparison(pr, n, level);
    else
        emit_function(pr, n);
    pr->depth--;
}

// ---- names ------------------------------------------------------------------------------------

static bool is_greek(const char *s, size_t n)
{
    static const char *const greek[]
        = {"alpha", "beta",   "gamma", "delta", "epsilon", "zeta",  "eta",    "theta", "iota",
           "kappa", "lambda", "mu",    "nu",    "xi",      "pi",    "rho",    "sigma", "tau",
           "phi",   "chi",    "psi",   "omega", "upsilon", "Gamma", "Delta",  "Theta", "Lambda",
           "Xi",    "Pi",     "Sigma", "Phi",   "Psi",     "Omega", "Upsilon"};
    for (size_t k = 0; k < COUNT(greek); k++)
        if (strlen(greek[k]) == n && !memcmp(greek[k], s, n))
            return true;
    return false;
}

const char *ct_latex_quoted(struct ct_arena *a, const char *name)
{
    char *quoted = ct_arena_alloc(a, 2 * strlen(name) + 1), *q = quoted;
    for (; *name; name++) {
        if (strchr("_#$%&{}", *name))
            *q++ = '\\';
        *q++ = *name;
    }
    return quoted;
}

// A word: one letter and Greek as mathematics, the rest upright.
static const char *latex_word(struct ct_arena *a, const char *s, size_t n)
{
    const char *word = ct_arena_strndup(a, s, n);
    if (is_greek(s, n))
        return ct_arena_printf(a, "\\%s", word);
    if (n == 1 || strspn(word, "0123456789,") == n)
        return word;
    return ct_arena_printf(a, "\\mathrm{%s}", ct_latex_quoted(a, word));
}

static const char *join_subscript(struct ct_arena *a, const char *first, const char *second)
{
    return *first ? ct_arena_printf(a, "%s,%s", first, second) : second;
}

// The part after the last dot is the quantity, with trailing digits and what follows an underscore
// as subscripts; what stands before the dot is a further subscript; primes are time derivatives.
const char *ct_latex_name(struct ct_arena *a, const char *name)
{
    size_t n = strlen(name), nprime = 0;
    while (n > 1 && name[n - 1] == '\'' && nprime < 3) {
        n--;
        nprime++;
    }
    size_t start = n;
    while (start > 0 && name[start - 1] != '.')
        start--;
    const char *s = name + start, *subscript = "";
    size_t length = n - start, digits = length, underscore = 1;
    while (digits > 1 && isdigit((unsigned char)s[digits - 1]))
        digits--;
    while (underscore < digits && s[underscore] != '_')
        underscore++;
    const size_t word = underscore < digits ? underscore : digits;
    if (underscore < digits && underscore + 1 < length)
        subscript = latex_word(a, s + underscore + 1, length - underscore - 1);
    else if (digits < length)
        subscript = latex_word(a, s + digits, length - digits);
    if (start > 1)
        subscript = join_subscript(a, subscript, latex_word(a, name, start - 1));
    const char *base = latex_word(a, s, word);
    static const char *const accent[] = {"", "dot", "ddot", "dddot"};
    const char *dotted = nprime ? ct_arena_printf(a, "\\%s{%s}", accent[nprime], base) : base;
    return *subscript ? ct_arena_printf(a, "%s_{%s}", dotted, subscript) : dotted;
}

const char *ct_c_name(struct ct_arena *a, const char *name)
{
    char *s = ct_arena_alloc(a, strlen(name) + 2), *p = s;
    if (!isalpha((unsigned char)name[0]) && name[0] != '_')
        *p++ = '_';
    for (const char *c = name; *c; c++)
        *p++ = *c == '\'' ? 'd' : isalnum((unsigned char)*c) ? *c : '_';
    return s;
}

// ---- C ----------------------------------------------------------------------------------------

const char *ct_c_operation(struct ct_arena *a, enum ct_op op, const char *const arg[3])
{
    const char *name = ct_op_info[op].name;
    switch (op) {
    case CT_OP_ADD:
    case CT_OP_SUB:
    case CT_OP_MUL:
    case CT_OP_DIV:
        return ct_arena_printf(a, "%s %s %s", arg[0], name, arg[1]);
    case CT_OP_LT:
    case CT_OP_LE:
    case CT_OP_GT:
    case CT_OP_GE:
    case CT_OP_EQ:
        return ct_arena_printf(a, "(double)(%s %s %s)", arg[0], name, arg[1]);
    case CT_OP_NEG:
        return ct_arena_printf(a, "-%s", arg[0]);
    case CT_OP_ABS:
        return ct_arena_printf(a, "fabs(%s)", arg[0]);
    case CT_OP_SIGN:
        return ct_arena_printf(a, "(double)((%s > 0) - (%s < 0))", arg[0], arg[0]);
    case CT_OP_MIN:
        return ct_arena_printf(a, "%s < %s ? %s : %s", arg[0], arg[1], arg[0], arg[1]);
    case CT_OP_MAX:
        return ct_arena_printf(a, "%s > %s ? %s : %s", arg[0], arg[1], arg[0], arg[1]);
    case CT_OP_IF:
        return ct_arena_printf(a, "%s != 0 ? %s : %s", arg[0], arg[1], arg[2]);
    case CT_OP_POW:
        return ct_arena_printf(a, "pow(%s, %s)", arg[0], arg[1]);
    default:
        break;
    }
    return ct_op_info[op].narg == 1 ? ct_arena_printf(a, "%s(%s)", name, arg[0])
                                    : ct_arena_printf(a, "%s(%s, %s)", name, arg[0], arg[1]);
}

// Operands in parentheses unless they are names, calls or numbers: no rule of precedence to know.
static const char *c_text(struct printer *pr, ct_ex e, bool operand)
{
    const struct ct_exnode *n = ct_ex_node(pr->x, e);
    const char *name = name_of(pr, e), *arg[3] = {"", "", ""};
    double v;
    if (name)
        return name;
    if (!pr->left || pr->depth == DEEPEST)
        return "...";
    pr->left--;
    if (ct_ex_is_const(pr->x, e, &v))
        return ct_number_c(pr->arena, v);
    if (n->op == CT_OP_SYM)
        return symbol_text(pr, &pr->x->sym[n->a]);
    const uint32_t id[3] = {n->a, n->b, n->c};
    pr->depth++;
    for (int k = 0; k < ct_op_info[n->op].narg; k++)
        arg[k] = c_text(pr, (ct_ex){id[k]}, true);
    pr->depth--;
    if (n->op == CT_OP_TABLE)
        return ct_arena_printf(pr->arena, "table(%u, %u, %s)", n->b, n->c, arg[0]);
    const char *s = ct_c_operation(pr->arena, (enum ct_op)n->op, arg);
    const bool call = n->op >= CT_OP_SQRT && n->op <= CT_OP_ABS;
    return operand && !call ? ct_arena_printf(pr->arena, "(%s)", s) : s;
}

// ---- entries ----------------------------------------------------------------------------------

static const char *print(struct ct_arena *a, const struct ct_exs *x, ct_ex e,
                         const struct ct_print *p, uint32_t body)
{
    struct printer pr = {.arena = a, .x = x, .body = body};
    if (p)
        pr.p = *p;
    pr.left = pr.p.limit ? pr.p.limit : 20000;
    if (pr.p.style == CT_PRINT_C)
        return c_text(&pr, e, false);
    emit(&pr, e, LEVEL_ANY);
    CT_PUSH(a, pr.s, pr.n, pr.cap, '\0');
    return pr.s;
}

const char *ct_ex_text(struct ct_arena *a, const struct ct_exs *x, ct_ex e,
                       const struct ct_print *p)
{
    return print(a, x, e, p, UINT32_MAX);
}

const char *ct_ex_text_body(struct ct_arena *a, const struct ct_exs *x, ct_ex e,
                            const struct ct_print *p)
{
    return print(a, x, e, p, e.id);
}
