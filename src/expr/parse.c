// Recursive descent over one line of text; the grammar is in parse.h.
#include "expr/parse.h"
#include "base/pi.h"
#include "expr/character.h"
#include "expr/quantity.h"
#include "expr/unit.h"

#include <math.h>
#include <string.h>

// Limit: longer or deeper than anyone writes, short enough that walks over the result may recurse
enum { MAX_LENGTH = 16384, MAX_DEPTH = 100 };

static const struct {
    const char *name;
    enum ct_op op;
    int least, most; // arguments
} functions[] = {
    {"sin", CT_OP_SIN, 1, 1},     {"cos", CT_OP_COS, 1, 1},   {"tan", CT_OP_TAN, 1, 1},
    {"asin", CT_OP_ASIN, 1, 1},   {"acos", CT_OP_ACOS, 1, 1}, {"atan", CT_OP_ATAN, 1, 1},
    {"atan2", CT_OP_ATAN2, 2, 2}, {"sinh", CT_OP_SINH, 1, 1}, {"cosh", CT_OP_COSH, 1, 1},
    {"tanh", CT_OP_TANH, 1, 1},   {"exp", CT_OP_EXP, 1, 1},   {"log", CT_OP_LOG, 1, 1},
    {"sqrt", CT_OP_SQRT, 1, 1},   {"abs", CT_OP_ABS, 1, 1},   {"sign", CT_OP_SIGN, 1, 1},
    {"min", CT_OP_MIN, 2, 64},    {"max", CT_OP_MAX, 2, 64},  {"if", CT_OP_IF, 3, 3},
};

static const struct {
    const char *text;
    enum ct_op op;
} comparisons[] = {
    // the longer ones first
    {"<=", CT_OP_LE}, {">=", CT_OP_GE}, {"==", CT_OP_EQ}, {"<", CT_OP_LT}, {">", CT_OP_GT},
};

struct parser {
    struct ct_ctx *ctx;
    const struct ct_scope *scope;
    struct ct_text text;
    const char *p;
    int depth;
    bool names_ok; // false after an unknown name: parsing continues to find further errors
};

static void skip_blanks(struct parser *s)
{
    while (ct_is_blank(*s->p))
        s->p++;
}

// Columns count characters, not bytes.
static struct ct_mark mark_at(const struct parser *s, const char *p)
{
    struct ct_mark m = s->text.mark;
    if (!s->text.is_exact || !m.file)
        return m;
    m.column += s->text.offset;
    for (const char *c = s->text.text; c < p; c++)
        m.column += ((unsigned char)*c & 0xc0) != 0x80;
    return m;
}

// Bytes of the UTF-8 character at p.
static int character_length(const char *p)
{
    int n = *p != 0;
    while (n && ((unsigned char)p[n] & 0xc0) == 0x80)
        n++;
    return n;
}

static bool unexpected(struct parser *s, const char *wanted)
{
    if (!*s->p)
        return ct_error(s->ctx, mark_at(s, s->p), CT_E_SYNTAX,
                        "the expression ends where %s is wanted", wanted);
    const char *hint = "";
    if (*s->p == '*' && s->p > s->text.text && s->p[-1] == '*')
        hint = "; a power is written with ^";
    else if (*s->p == '=')
        hint = "; equality is written ==";
    else if (*s->p == '!' || *s->p == '&' || *s->p == '|')
        hint = "; use if(condition, a, b) and products of comparisons";
    return ct_error(s->ctx, mark_at(s, s->p), CT_E_SYNTAX, "found '%.*s' where %s is wanted%s",
                    character_length(s->p), s->p, wanted, hint);
}

static bool enter(struct parser *s)
{
    if (++s->depth <= MAX_DEPTH)
        return true;
    return ct_error(s->ctx, mark_at(s, s->p), CT_E_EXPRESSION_LIMIT,
                    "the expression nests deeper than %d", MAX_DEPTH);
}

static bool parse_comparison(struct parser *s, ct_ex *e);
static bool parse_unary(struct parser *s, ct_ex *e);

// ---- names -----------------------------------------------------------------------------------

// An identifier at p, copied; NULL if there is none.
static const char *scan_name(struct parser *s)
{
    if (!ct_is_letter(*s->p))
        return NULL;
    const char *start = s->p;
    while (ct_is_letter(*s->p) || ct_is_digit(*s->p))
        s->p++;
    return ct_arena_strndup(s->ctx->scratch, start, (size_t)(s->p - start));
}

static int find_function(const char *name)
{
    for (size_t i = 0; i < COUNT(functions); i++)
        if (strcmp(functions[i].name, name) == 0)
            return (int)i;
    return -1;
}

static bool is_known(const struct ct_scope *s, const char *name)
{
    for (size_t i = 0; i < s->nknown; i++)
        if (strcmp(s->known[i], name) == 0)
            return true;
    return false;
}

static void report_unknown_name(struct parser *s, const char *name, const char *start)
{
    // Limit: a search compares all names each time; after so many errors suggestions are omitted
    enum { MOST_SUGGESTIONS = 200 };
    const char *near = s->ctx->nerror < MOST_SUGGESTIONS
                         ? ct_nearest(name, s->scope->known, s->scope->nknown)
                         : NULL;
    if (find_function(name) >= 0)
        ct_error(s->ctx, mark_at(s, start), CT_E_FUNCTION, "'%s' is a function: write %s(...)",
                 name, name);
    else if (near)
        ct_error(s->ctx, mark_at(s, start), CT_E_NAME_UNKNOWN,
                 "unknown name '%s'; did you mean '%s'?", name, near);
    else
        ct_error(s->ctx, mark_at(s, start), CT_E_NAME_UNKNOWN, "unknown name '%s'", name);
}

static void settle_name(struct parser *s, enum ct_name_result result, const char *name,
                        const char *start, const char *why)
{
    if (result == CT_NAME_OK)
        return;
    s->names_ok = false;
    if (result == CT_NAME_UNKNOWN)
        report_unknown_name(s, name, start);
    else if (result == CT_NAME_FORBIDDEN)
        ct_error(s->ctx, mark_at(s, start), CT_E_NOT_HERE, "'%s' cannot be used here: %s", name,
                 why);
}

static bool parse_plain_name(struct parser *s, const char *name, const char *start, ct_ex *e)
{
    const char *why = "";
    *e = CT_EX_ZERO;
    if (strcmp(name, "pi") == 0) {
        *e = ct_ex_const(s->scope->x, CT_PI);
        return true;
    }
    enum ct_name_result result = CT_NAME_UNKNOWN;
    if (s->scope->name)
        result = s->scope->name(s->scope->user, name, e, &why);
    settle_name(s, result, name, start, why);
    return true;
}

// name { . part }: the dotted text from start; p behind it
static bool scan_parts(struct parser *s, const char *start, const char **dotted)
{
    while (*s->p == '.') {
        s->p++;
        if (!ct_is_letter(*s->p) && !ct_is_digit(*s->p))
            return unexpected(s, "a name after the point");
        while (ct_is_letter(*s->p) || ct_is_digit(*s->p))
            s->p++;
    }
    *dotted = ct_arena_strndup(s->ctx->scratch, start, (size_t)(s->p - start));
    return true;
}

// [ in FRAME ] after a signal; leaves p alone if it is not there
static bool scan_in(struct parser *s, const char **in, const char **at)
{
    *in = NULL;
    const char *back = s->p;
    skip_blanks(s);
    if (strncmp(s->p, "in", 2) != 0 || ct_is_letter(s->p[2]) || ct_is_digit(s->p[2])) {
        s->p = back;
        return true;
    }
    s->p += 2;
    skip_blanks(s);
    *at = s->p;
    if (!scan_name(s))
        return unexpected(s, "the name of a frame after 'in'");
    return scan_parts(s, *at, in);
}

static bool parse_signal(struct parser *s, const char *first, const char *start, ct_ex *e)
{
    const char *dotted = NULL, *in = NULL, *in_at = NULL, *why = "";
    if (!scan_parts(s, start, &dotted) || !scan_in(s, &in, &in_at))
        return false;
    const char *text = in ? ct_arena_printf(s->ctx->scratch, "%s in %s", dotted, in) : dotted;
    *e = CT_EX_ZERO;
    enum ct_name_result result = CT_NAME_FORBIDDEN;
    why = "signals are known in forces, drivers and outputs only";
    if (s->scope->signal)
        result = s->scope->signal(s->scope->user, text, first, in, mark_at(s, start),
                                  mark_at(s, in ? in_at : start), e, &why);
    settle_name(s, result, text, start, why);
    return true;
}

// ---- functions ----------------------------------------------------------------------------------

static ct_ex apply(struct ct_exs *x, int f, const ct_ex *arg, int n)
{
    const enum ct_op op = functions[f].op;
    if (op == CT_OP_IF)
        return ct_ex_if(x, arg[0], arg[1], arg[2]);
    if (functions[f].most == 1)
        return ct_ex_fun(x, op, arg[0]);
    ct_ex e = arg[0];
    for (int i = 1; i < n; i++)
        e = ct_ex_fun2(x, op, e, arg[i]);
    return e;
}

static bool report_unknown_function(struct parser *s, const char *name, const char *start)
{
    if (strcmp(name, "t") == 0 || strcmp(name, "pi") == 0 || is_known(s->scope, name))
        return ct_error(s->ctx, mark_at(s, start), CT_E_FUNCTION,
                        "'%s' is not a function; a product is written %s*(...)", name, name);
    const char *names[COUNT(functions)];
    for (size_t i = 0; i < COUNT(functions); i++)
        names[i] = functions[i].name;
    const char *near = ct_nearest(name, names, COUNT(functions));
    if (near)
        return ct_error(s->ctx, mark_at(s, start), CT_E_FUNCTION,
                        "unknown function '%s'; did you mean '%s'?", name, near);
    return ct_error(s->ctx, mark_at(s, start), CT_E_FUNCTION, "unknown function '%s'", name);
}

// p stands behind the opening parenthesis
static bool parse_call(struct parser *s, const char *name, const char *start, ct_ex *e)
{
    enum { MOST = 64 }; // Limit: arguments of a call
    ct_ex arg[MOST];
    const int f = find_function(name);
    if (f < 0)
        return report_unknown_function(s, name, start);
    int n = 0;
    skip_blanks(s);
    if (*s->p != ')')
        for (;;) {
            if (n == MOST)
                return ct_error(s->ctx, mark_at(s, s->p), CT_E_EXPRESSION_LIMIT,
                                "'%s' has more than %d arguments", name, MOST);
            if (!parse_comparison(s, &arg[n++]))
                return false;
            skip_blanks(s);
            if (*s->p != ',')
                break;
            s->p++;
        }
    if (*s->p != ')')
        return unexpected(s, "',' or ')'");
    s->p++;
    if (n < functions[f].least || n > functions[f].most)
        return ct_error(s->ctx, mark_at(s, start), CT_E_FUNCTION,
                        "'%s' takes %d argument%s, not %d", name, functions[f].least,
                        functions[f].least == 1 ? "" : "s", n);
    *e = apply(s->scope->x, f, arg, n);
    return true;
}

// ---- the grammar -------------------------------------------------------------------------------

static bool parse_number(struct parser *s, ct_ex *e)
{
    double value;
    const char *start = s->p;
    s->p += ct_number_parse(s->p, &value);
    if (!isfinite(value))
        return ct_error(s->ctx, mark_at(s, start), CT_E_NUMBER, "the number is too large");
    *e = ct_ex_const(s->scope->x, value);
    const char *after = s->p;
    skip_blanks(s);
    if (ct_is_letter(*s->p))
        return ct_error(s->ctx, mark_at(s, after), CT_E_SYNTAX,
                        "an operator is missing after the number; a number with a unit stands "
                        "alone, in an expression numbers are SI");
    if (ct_is_digit(*s->p) || *s->p == '.' || *s->p == '(')
        return ct_error(s->ctx, mark_at(s, s->p), CT_E_SYNTAX,
                        "an operator is missing after the number");
    return true;
}

static bool parse_primary(struct parser *s, ct_ex *e)
{
    skip_blanks(s);
    const char *start = s->p;
    if (*s->p == '(') {
        s->p++;
        if (!parse_comparison(s, e))
            return false;
        skip_blanks(s);
        if (*s->p != ')')
            return unexpected(s, "an operator or ')'");
        s->p++;
        return true;
    }
    if (ct_is_digit(*s->p) || (*s->p == '.' && ct_is_digit(s->p[1])))
        return parse_number(s, e);
    const char *name = scan_name(s);
    if (!name)
        return unexpected(s, "a number, a name or '('");
    if (*s->p == '.')
        return parse_signal(s, name, start, e);
    const char *after = s->p;
    skip_blanks(s);
    if (*s->p == '(') {
        s->p++;
        return parse_call(s, name, start, e);
    }
    s->p = after;
    return parse_plain_name(s, name, start, e);
}

static bool parse_power(struct parser *s, ct_ex *e)
{
    if (!parse_primary(s, e))
        return false;
    skip_blanks(s);
    if (*s->p != '^')
        return true;
    s->p++;
    ct_ex power;
    if (!parse_unary(s, &power))
        return false;
    *e = ct_ex_pow(s->scope->x, *e, power);
    return true;
}

// Every deeper level of the grammar passes through here: the depth is counted.
static bool parse_unary(struct parser *s, ct_ex *e)
{
    if (!enter(s))
        return false;
    skip_blanks(s);
    const char sign = *s->p;
    bool ok;
    if (sign == '-' || sign == '+') {
        s->p++;
        ok = parse_unary(s, e);
        if (ok && sign == '-')
            *e = ct_ex_neg(s->scope->x, *e);
    } else {
        ok = parse_power(s, e);
    }
    s->depth--;
    return ok;
}

// Result of a chain of operators. A chain of n terms is summed in parts of PART terms. The nesting
// depth is then at most PART + n / PART in place of n, because walks over the result recurse.
// Limit: of that depth; MAX_LENGTH allows n = 8192, thus 528 levels.
enum { PART = 16 };
struct row {
    ct_ex whole, part; // whole: sum of the completed parts
    int npart, nterm;  // nterm: terms of the current part
};

static ct_ex join(struct ct_exs *x, char sign, ct_ex a, ct_ex b)
{
    return sign == '+' ? ct_ex_add(x, a, b)
         : sign == '-' ? ct_ex_sub(x, a, b)
         : sign == '*' ? ct_ex_mul(x, a, b)
                       : ct_ex_div(x, a, b);
}

// Add the current part to the whole. neutral: '+' or '*', the operator that joins parts.
static void end_part(struct ct_exs *x, struct row *r, char neutral)
{
    r->whole = r->npart++ ? join(x, neutral, r->whole, r->part) : r->part;
    r->nterm = 0;
}

static void add_term(struct ct_exs *x, struct row *r, char neutral, char sign, ct_ex term)
{
    if (r->nterm)
        r->part = join(x, sign, r->part, term);
    else if (sign == neutral)
        r->part = term;
    else
        r->part = neutral == '+' ? ct_ex_neg(x, term) : ct_ex_div(x, CT_EX_ONE, term);
    if (++r->nterm == PART)
        end_part(x, r, neutral);
}

static ct_ex end_row(struct ct_exs *x, struct row *r, char neutral)
{
    if (r->nterm)
        end_part(x, r, neutral);
    return r->whole;
}

static bool parse_product(struct parser *s, ct_ex *e)
{
    struct row r = {0};
    for (char sign = '*';;) {
        ct_ex b;
        if (!parse_unary(s, &b))
            return false;
        add_term(s->scope->x, &r, '*', sign, b);
        skip_blanks(s);
        if (*s->p != '*' && *s->p != '/') {
            *e = end_row(s->scope->x, &r, '*');
            return true;
        }
        sign = *s->p++;
        if (*s->p == '*')
            return unexpected(s, "a number, a name or '('");
    }
}

static bool parse_sum(struct parser *s, ct_ex *e)
{
    struct row r = {0};
    for (char sign = '+';;) {
        ct_ex b;
        if (!parse_product(s, &b))
            return false;
        add_term(s->scope->x, &r, '+', sign, b);
        skip_blanks(s);
        if (*s->p != '+' && *s->p != '-') {
            *e = end_row(s->scope->x, &r, '+');
            return true;
        }
        sign = *s->p++;
    }
}

static int scan_comparison(struct parser *s)
{
    skip_blanks(s);
    for (size_t i = 0; i < COUNT(comparisons); i++)
        if (strncmp(s->p, comparisons[i].text, strlen(comparisons[i].text)) == 0)
            return (int)i;
    return -1;
}

static bool parse_comparison(struct parser *s, ct_ex *e)
{
    if (!parse_sum(s, e))
        return false;
    const int c = scan_comparison(s);
    if (c < 0)
        return true;
    s->p += strlen(comparisons[c].text);
    ct_ex b;
    if (!parse_sum(s, &b))
        return false;
    *e = ct_ex_fun2(s->scope->x, comparisons[c].op, *e, b);
    // (1 < x) < 3 is always true; the user means a chain of comparisons, so it is an error
    if (scan_comparison(s) >= 0)
        return ct_error(
            s->ctx, mark_at(s, s->p), CT_E_SYNTAX,
            "comparisons cannot be chained; multiply two of them, or use parentheses");
    return true;
}

// ---- a whole text ------------------------------------------------------------------------------

// Words of YAML for infinity and not-a-number.
static bool is_infinite_word(const char *text)
{
    static const char *const word[] = {".inf", ".Inf", ".INF", ".nan", ".NaN", ".NAN"};
    text += *text == '-' || *text == '+';
    for (size_t i = 0; i < COUNT(word); i++)
        if (strcmp(text, word[i]) == 0)
            return true;
    return false;
}

static bool is_name(const void *scope, const char *word)
{
    return is_known(scope, word) || find_function(word) >= 0;
}

static bool parse_quantity(struct parser *s, double value, const char *unit, ct_ex *e)
{
    const struct ct_quantity q = {.text = s->text.text,
                                  .unit = unit,
                                  .mark = s->text.mark,
                                  .wanted = s->scope->unit,
                                  .is_name = is_name,
                                  .user = s->scope};
    if (!ct_quantity_read(s->ctx, &q, &value))
        return false;
    *e = ct_ex_const(s->scope->x, value);
    return true;
}

const char *ct_parse_unit(const char *text)
{
    double value;
    const char *unit;
    return ct_quantity_split(text, &value, &unit) ? unit : NULL;
}

bool ct_parse(struct ct_ctx *ctx, const struct ct_scope *scope, struct ct_text text, ct_ex *e)
{
    struct parser s
        = {.ctx = ctx, .scope = scope, .text = text, .p = text.text, .names_ok = true};
    *e = CT_EX_ZERO;
    if (strlen(text.text) > MAX_LENGTH)
        return ct_error(ctx, text.mark, CT_E_EXPRESSION_LIMIT,
                        "the expression is longer than %d characters", MAX_LENGTH);
    if (is_infinite_word(text.text))
        return ct_error(ctx, text.mark, CT_E_NUMBER, "'%s': a finite number is wanted",
                        text.text);
    double value;
    const char *unit;
    if (ct_quantity_split(text.text, &value, &unit))
        return parse_quantity(&s, value, unit, e);
    if (ct_is_digit(*text.text) && !*unit
        && isfinite(value)) { // a plain number, the usual case
        *e = ct_ex_const(scope->x, value);
        return true;
    }
    if (!parse_comparison(&s, e))
        return false;
    skip_blanks(&s);
    if (*s.p)
        return unexpected(&s, "an operator");
    return s.names_ok;
}

static size_t scan_dotted(const char *p)
{
    size_t n = 0;
    if (!ct_is_letter(p[0]))
        return 0;
    while (ct_is_letter(p[n]) || ct_is_digit(p[n]) || p[n] == '.')
        n++;
    return n;
}

bool ct_parse_is_signal(struct ct_arena *a, const char *text, const char **normal)
{
    while (ct_is_blank(*text))
        text++;
    size_t n = scan_dotted(text);
    if (!n || !memchr(text, '.', n))
        return false;
    const char *p = text + n, *in = NULL;
    size_t nin = 0;
    while (ct_is_blank(*p))
        p++;
    if (strncmp(p, "in", 2) == 0 && ct_is_blank(p[2])) {
        in = p + 2;
        while (ct_is_blank(*in))
            in++;
        nin = scan_dotted(in);
        p = in + nin;
        while (ct_is_blank(*p))
            p++;
    }
    if (*p || (in && !nin))
        return false;
    *normal = in ? ct_arena_printf(a, "%.*s in %.*s", (int)n, text, (int)nin, in)
                 : ct_arena_strndup(a, text, n);
    return true;
}

bool ct_is_identifier(const char *name)
{
    if (!ct_is_letter(*name))
        return false;
    while (ct_is_letter(*name) || ct_is_digit(*name))
        name++;
    return !*name;
}

bool ct_is_reserved(const char *name)
{
    return strcmp(name, "t") == 0 || strcmp(name, "pi") == 0 || strcmp(name, "in") == 0
        || find_function(name) >= 0;
}
