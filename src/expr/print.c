// Printing of expressions; see print.h.
//
// A sum is flattened to terms, a term to a number, factors with exponents and a denominator
// (term.h). Both lists are sorted and printed. All other nodes are printed in their given
// structure.
#include "expr/print.h"

#include "expr/fraction.h"
#include "expr/term.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Precedence of the context: operators of lower precedence get parentheses.
enum level { LEVEL_ANY, LEVEL_SUM, LEVEL_FACTOR, LEVEL_BASE };

static void emit(struct ct_printer *pr, ct_ex e, enum level level);

// ---- pieces of text ---------------------------------------------------------------------------

static void put(struct ct_printer *pr, const char *s)
{
    for (; *s; s++)
        CT_PUSH(pr->arena, pr->s, pr->n, pr->cap, *s);
}

static bool is_latex(const struct ct_printer *pr)
{
    return pr->p.style == CT_PRINT_LATEX;
}

static void put_number(struct ct_printer *pr, double v)
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

static void open_group(struct ct_printer *pr, bool needed)
{
    if (needed)
        put(pr, is_latex(pr) ? "\\left(" : "(");
}

static void close_group(struct ct_printer *pr, bool needed)
{
    if (needed)
        put(pr, is_latex(pr) ? "\\right)" : ")");
}

// ---- products -----------------------------------------------------------------------------------

static bool is_trig(const struct ct_exnode *n)
{
    return n->op == CT_OP_SIN || n->op == CT_OP_COS || n->op == CT_OP_TAN;
}

static void emit_argument(struct ct_printer *pr, ct_ex e);

static void emit_factor(struct ct_printer *pr, const struct ct_factor *f)
{
    const struct ct_exnode *n = ct_ex_node(pr->x, f->e);
    if (f->exponent == 1) {
        emit(pr, f->e, LEVEL_FACTOR);
        return;
    }
    if (is_latex(pr) && is_trig(n) && !ct_printer_name(pr, f->e)) {
        put(pr, ct_arena_printf(pr->arena, "\\%s^{%d}", ct_op_info[n->op].name, f->exponent));
        emit_argument(pr, (ct_ex){n->a});
        return;
    }
    emit(pr, f->e, LEVEL_BASE);
    put(pr, ct_arena_printf(pr->arena, is_latex(pr) ? "^{%d}" : "^%d", f->exponent));
}

static void put_pi(struct ct_printer *pr, int exponent)
{
    put(pr, is_latex(pr) ? "\\pi" : "pi");
    if (exponent == 2)
        put(pr, "^2");
}

// pi: its exponent, 0 for none.
static void emit_factors(struct ct_printer *pr, double number, int pi,
                         const struct ct_factors *f)
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
        emit_factor(pr, &f->at[k]);
    }
}

static const char *take_factors(struct ct_printer *pr, double number, int pi,
                                const struct ct_factors *f)
{
    const size_t start = pr->n;
    emit_factors(pr, number, pi, f);
    const char *s = ct_arena_strndup(pr->arena, pr->s + start, pr->n - start);
    pr->n = start;
    return s;
}

// Remove the parentheses of a single factor: inside a \frac it needs none.
static const char *without_group(struct ct_arena *a, const char *s, const struct ct_factors *f)
{
    static const char open[] = "\\left(", close[] = "\\right)";
    const size_t n = strlen(s), first = sizeof open - 1, last = sizeof close - 1;
    const bool is_group = f->n == 1 && f->at[0].exponent == 1 && n >= first + last
                       && !strncmp(s, open, first) && !strcmp(s + n - last, close);
    return is_group ? ct_arena_strndup(a, s + first, n - first - last) : s;
}

// Is the text wider than an indented line?
static bool is_wide(const struct ct_printer *pr, const char *s)
{
    // Layout: [pt], about what stands left of a term
    const size_t indent = 40, line = pr->p.line ? pr->p.line : CT_LATEX_LINE;
    return ct_latex_width(s, strlen(s)) + indent > line;
}

// A fraction in LaTeX. If a part is wider than a line it is printed as a product, which can be
// broken.
static void emit_fraction(struct ct_printer *pr, const struct ct_term *t)
{
    static const struct ct_factors none;
    const char *above = take_factors(pr, t->number, t->pi, &t->above),
               *below = without_group(
                   pr->arena, take_factors(pr, t->divisor, -t->pi, &t->below), &t->below);
    const bool is_wide_below = is_wide(pr, below);
    if (!is_wide_below && !is_wide(pr, above)) {
        above = without_group(pr->arena, above, &t->above);
        put(pr, ct_arena_printf(pr->arena, "\\frac{%s}{%s}", above, below));
    } else if (is_wide_below) {
        put(pr, ct_arena_printf(pr->arena, "%s%s\\left(%s\\right)^{-1}",
                                strcmp(above, "1") ? above : "",
                                strcmp(above, "1") ? " \\, " : "", below));
    } else {
        const bool has_number = t->number != 1 || t->pi > 0;
        const char *number = take_factors(pr, t->number, t->pi, &none);
        put(pr, ct_arena_printf(pr->arena, "\\frac{%s}{%s} \\, %s", number, below,
                                above + (has_number ? strlen(number) + 1 : 0)));
    }
}

static void emit_term(struct ct_printer *pr, const struct ct_term *t)
{
    const size_t below = t->below.n + (t->divisor != 1) + (t->pi < 0);
    if (!below) {
        emit_factors(pr, t->number, t->pi, &t->above);
    } else if (is_latex(pr)) {
        emit_fraction(pr, t);
    } else {
        emit_factors(pr, t->number, t->pi, &t->above);
        put(pr, below > 1 ? "/(" : "/");
        emit_factors(pr, t->divisor, -t->pi, &t->below);
        put(pr, below > 1 ? ")" : "");
    }
}

static void emit_signed(struct ct_printer *pr, const struct ct_term *t, bool is_first)
{
    put(pr, is_first ? t->negative ? "-" : "" : t->negative ? " - " : " + ");
    emit_term(pr, t);
}

static void emit_sum(struct ct_printer *pr, ct_ex e, enum level level)
{
    const struct ct_terms t = ct_terms_of_sum(pr, e);
    const bool group
        = (t.n > 1 || t.at[0].negative) ? level >= LEVEL_FACTOR : level >= LEVEL_BASE;
    open_group(pr, group);
    for (size_t k = 0; k < t.n; k++)
        emit_signed(pr, &t.at[k], k == 0);
    close_group(pr, group);
}

// ---- everything else ---------------------------------------------------------------------------

// In LaTeX a symbol needs no parentheses after a function.
static void emit_argument(struct ct_printer *pr, ct_ex e)
{
    const bool bare = is_latex(pr) && ct_ex_node(pr->x, e)->op == CT_OP_SYM;
    put(pr, bare ? " " : "");
    open_group(pr, !bare);
    emit(pr, e, LEVEL_ANY);
    close_group(pr, !bare);
}

static void emit_call(struct ct_printer *pr, const char *name, const struct ct_exnode *n)
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

static const char *table_name(const struct ct_printer *pr, const struct ct_exnode *n)
{
    const char *column = pr->x->table[n->b].column;
    char *s = column ? ct_arena_strdup(pr->arena, column)
                     : ct_arena_printf(pr->arena, "table%u", n->b + 1);
    if (is_latex(pr))
        s = ct_arena_printf(pr->arena, "\\mathrm{%s}", ct_latex_quoted(pr->arena, s));
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
        return NULL; // the name with a backslash is printed
    }
}

static void emit_wrapped(struct ct_printer *pr, const char *before, uint32_t id,
                         const char *after)
{
    put(pr, before);
    emit(pr, (ct_ex){id}, LEVEL_ANY);
    put(pr, after);
}

static bool is_comparison(uint32_t op)
{
    return op >= CT_OP_LT && op <= CT_OP_EQ;
}

static const char *take(struct ct_printer *pr, uint32_t id)
{
    const size_t start = pr->n;
    emit(pr, (ct_ex){id}, LEVEL_ANY);
    const char *s = ct_arena_strndup(pr->arena, pr->s + start, pr->n - start);
    pr->n = start;
    return s;
}

// An `if` in LaTeX. Cases cannot be broken, so those wider than a line are printed as in a model
// file, if(a, b, c).
static void emit_cases(struct ct_printer *pr, const struct ct_exnode *n)
{
    const bool comparison = is_comparison(ct_ex_node(pr->x, (ct_ex){n->a})->op);
    const char *then = take(pr, n->b), *is_true = take(pr, n->a), *otherwise = take(pr, n->c);
    const char *s = ct_arena_printf(
        pr->arena, "\\begin{cases} %s & %s%s \\\\ %s & \\text{otherwise} \\end{cases}", then,
        is_true, comparison ? "" : " \\neq 0", otherwise);
    put(pr,
        !is_wide(pr, s)
            ? s
            : ct_arena_printf(pr->arena, "\\operatorname{if}\\left(%s%s,\\; %s,\\; %s\\right)",
                              is_true, comparison ? "" : " \\neq 0", then, otherwise));
}

// A root in LaTeX. It cannot be broken, so one wider than a line is printed as a power.
static void emit_root(struct ct_printer *pr, uint32_t id)
{
    const char *s = take(pr, id);
    put(pr, ct_arena_printf(pr->arena,
                            is_wide(pr, s) ? "\\left(%s\\right)^{1/2}" : "\\sqrt{%s}", s));
}

static void emit_function(struct ct_printer *pr, const struct ct_exnode *n)
{
    const char *name = ct_op_info[n->op].name;
    if (n->op == CT_OP_TABLE) {
        emit_call(pr, table_name(pr, n), n);
    } else if (!is_latex(pr)) {
        emit_call(pr, name, n);
    } else if (n->op == CT_OP_SQRT) {
        emit_root(pr, n->a);
    } else if (n->op == CT_OP_ABS) {
        emit_wrapped(pr, "\\left|", n->a, "\\right|");
    } else if (n->op == CT_OP_IF) {
        emit_cases(pr, n);
    } else {
        const char *special = latex_function(n->op);
        emit_call(pr, special ? special : ct_arena_printf(pr->arena, "\\%s", name), n);
    }
}

static const char *comparison_sign(const struct ct_printer *pr, uint32_t op)
{
    if (is_latex(pr) && op != CT_OP_LT && op != CT_OP_GT)
        return op == CT_OP_LE ? "\\leq" : op == CT_OP_GE ? "\\geq" : "=";
    return ct_op_info[op].name;
}

static void emit_comparison(struct ct_printer *pr, const struct ct_exnode *n, enum level level)
{
    open_group(pr, level > LEVEL_ANY);
    emit(pr, (ct_ex){n->a}, LEVEL_SUM);
    put(pr, ct_arena_printf(pr->arena, " %s ", comparison_sign(pr, n->op)));
    emit(pr, (ct_ex){n->b}, LEVEL_SUM);
    close_group(pr, level > LEVEL_ANY);
}

static void emit_power(struct ct_printer *pr, const struct ct_exnode *n, enum level level)
{
    open_group(pr, level == LEVEL_BASE);
    emit(pr, (ct_ex){n->a}, LEVEL_BASE);
    put(pr, is_latex(pr) ? "^{" : "^");
    emit(pr, (ct_ex){n->b}, is_latex(pr) ? LEVEL_ANY : LEVEL_BASE);
    put(pr, is_latex(pr) ? "}" : "");
    close_group(pr, level == LEVEL_BASE);
}

// Print a lone number that is a fraction of a power of pi.
static bool emit_pi(struct ct_printer *pr, double v, enum level level)
{
    struct ct_term t = {.negative = v < 0, .number = fabs(v), .divisor = 1};
    ct_term_split_pi(&t);
    if (!t.pi)
        return false;
    open_group(pr, level >= LEVEL_FACTOR);
    put(pr, t.negative ? "-" : "");
    emit_term(pr, &t);
    close_group(pr, level >= LEVEL_FACTOR);
    return true;
}

static void emit_const(struct ct_printer *pr, double v, enum level level)
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

static const char *symbol_text(const struct ct_printer *pr, const struct ct_sym *s)
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

// Limit: of the stack, for parentheses within parentheses; deeper ones are printed as "...".
enum { DEEPEST = 500 };

// Is e printed as a sum of products, or as a single product?
static bool has_terms(const struct ct_printer *pr, ct_ex e)
{
    const struct ct_exnode *n = ct_ex_node(pr->x, e);
    return n->op == CT_OP_ADD || n->op == CT_OP_SUB || n->op == CT_OP_NEG || n->op == CT_OP_MUL
        || n->op == CT_OP_DIV
        || (n->op == CT_OP_POW && ct_whole_exponent(pr->x, (ct_ex){n->b}));
}

static void emit(struct ct_printer *pr, ct_ex e, enum level level)
{
    const struct ct_exnode *n = ct_ex_node(pr->x, e);
    const char *name = ct_printer_name(pr, e);
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
    else if (has_terms(pr, e))
        emit_sum(pr, e, level);
    else if (n->op == CT_OP_POW)
        emit_power(pr, n, level);
    else if (is_comparison(n->op))
        emit_comparison(pr, n, level);
    else
        emit_function(pr, n);
    pr->depth--;
}

// ---- C ----------------------------------------------------------------------------------------

// C text. Operands get parentheses unless they are names, calls or numbers, so that precedence
// plays no part.
static const char *c_text(struct ct_printer *pr, ct_ex e, bool operand)
{
    const struct ct_exnode *n = ct_ex_node(pr->x, e);
    const char *name = ct_printer_name(pr, e), *arg[3] = {"", "", ""};
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

static struct ct_printer create(struct ct_arena *a, const struct ct_exs *x,
                                const struct ct_print *p, uint32_t body)
{
    struct ct_printer pr = {.arena = a, .x = x, .body = body};
    if (p)
        pr.p = *p;
    pr.left = pr.p.limit ? pr.p.limit : 20000;
    return pr;
}

static const char *print(struct ct_arena *a, const struct ct_exs *x, ct_ex e,
                         const struct ct_print *p, uint32_t body)
{
    struct ct_printer pr = create(a, x, p, body);
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

size_t ct_ex_terms(struct ct_arena *a, const struct ct_exs *x, ct_ex e,
                   const struct ct_print *p, struct ct_print_term **term)
{
    struct ct_printer pr = create(a, x, p, UINT32_MAX);
    if (ct_printer_name(&pr, e) || ct_ex_is_const(x, e, NULL) || !has_terms(&pr, e)) {
        *term = CT_NEW(a, struct ct_print_term);
        **term = (struct ct_print_term){e, false, ct_ex_text(a, x, e, p)};
        return 1;
    }
    pr.left--; // e itself
    pr.depth++;
    const struct ct_terms t = ct_terms_of_sum(&pr, e);
    *term = CT_NEWN(a, struct ct_print_term, t.n);
    for (size_t k = 0; k < t.n; k++) {
        pr.n = 0;
        emit_signed(&pr, &t.at[k], k == 0);
        (*term)[k] = (struct ct_print_term){t.at[k].e, t.at[k].is_subtracted,
                                            ct_arena_strndup(a, pr.s, pr.n)};
    }
    return t.n;
}
