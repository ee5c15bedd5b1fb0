// Numbers, names and single operators as text, LaTeX and C; see print.h.
#include "expr/print.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- numbers ----------------------------------------------------------------------------------

const char *ct_number_text(struct ct_arena *a, double v)
{
    char s[40];
    // Layout: whole numbers of up to seven digits are written out: 60, not 6e+01
    if (v == floor(v) && fabs(v) < 1e7)
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
    static const char *const sign[][2]
        = {{"\\", "\\backslash "}, {"^", "\\wedge "}, {"~", "\\sim "}};
    char *quoted = ct_arena_alloc(a, 11 * strlen(name) + 1), *q = quoted;
    for (; *name; name++) {
        size_t k = 0;
        while (k < COUNT(sign) && *name != *sign[k][0])
            k++;
        if (k < COUNT(sign)) {
            memcpy(q, sign[k][1], strlen(sign[k][1]));
            q += strlen(sign[k][1]);
            continue;
        }
        if (strchr("_#$%&{}", *name))
            *q++ = '\\';
        *q++ = *name;
    }
    *q = '\0';
    return quoted;
}

// A word in LaTeX: a single letter or Greek name as a symbol, any other word upright.
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

// The part after the last dot is the symbol; its trailing digits and the text after an underscore
// become subscripts. The part before the dot is a further subscript. Primes are time derivatives.
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

// ---- operators --------------------------------------------------------------------------------

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

// ---- widths -----------------------------------------------------------------------------------

// Letters and signs of Computer Modern at 10 pt [pt], rounded up.
static double character_width(char c)
{
    if (strchr("il,.:;'|", c))
        return 3.5;
    if (strchr("fjrt()[]", c))
        return 4.6;
    if (strchr("mwMW", c))
        return 9;
    if (strchr("+-=<>", c)) // with the space around it
        return 12.5;
    return c >= 'A' && c <= 'Z' ? 8 : 5.6;
}

static bool is_command(const char *s, size_t n, const char *name)
{
    return strlen(name) == n && !strncmp(s, name, n);
}

// Width of the command of n letters after the backslash at s, without its arguments.
static double command_width(const char *s, size_t n)
{
    static const char *const no_width[]
        = {"mathrm", "boldsymbol", "frac", "dot",   "ddot", "dddot",        "tfrac",
           "begin",  "end",        "text", "hline", "sqrt", "operatorname", "cases"};
    static const char *const spelled[]
        = {"sin",    "cos",    "tan", "sinh", "cosh", "tanh", "arcsin",
           "arccos", "arctan", "exp", "ln",   "min",  "max"};
    if (!isalpha((unsigned char)s[0])) // a space or an escaped character
        return strchr(",;", s[0]) ? 2.8 : strchr("_#$%&{}", s[0]) ? 5.6 : 0;
    for (size_t i = 0; i < COUNT(no_width); i++)
        if (is_command(s, n, no_width[i]))
            return is_command(s, n, "sqrt") ? 10 : is_command(s, n, "begin") ? 15 : 0;
    for (size_t i = 0; i < COUNT(spelled); i++)
        if (is_command(s, n, spelled[i]))
            return 5 * (double)n + 1.7;
    if (is_command(s, n, "left") || is_command(s, n, "right"))
        return 3; // a delimiter larger than its character, and a thin space
    if (is_command(s, n, "qquad") || is_command(s, n, "quad"))
        return n == 5 ? 20 : 10;
    return is_command(s, n, "cdot") || is_command(s, n, "times") ? 12.3 : 6.5; // Greek letters
}

static double width_of(const char **at, const char *end, double size, bool is_one);

static double fraction_width(const char **at, const char *end, double size)
{
    const double above = width_of(at, end, size, true), below = width_of(at, end, size, true);
    return 2.4 + (above > below ? above : below);
}

// Width up to the end or to the closing brace; is_one: of one item only (character, command or
// group).
static double width_of(const char **at, const char *end, double size, bool is_one)
{
    const double script
        = 0.8; // Layout: letters of 7 pt, which are relatively wider than those of 10
    double width = 0;
    while (*at < end && **at != '}') {
        const char c = *(*at)++;
        if (c == ' ' || c == '&')
            continue;
        if (c == '{') {
            width += width_of(at, end, size, false);
            *at += *at < end;
        } else if (c == '_' || c == '^') {
            width += width_of(at, end, size * script, true) + 0.5;
        } else if (c == '\\') {
            const char *name = *at;
            while (*at < end && isalpha((unsigned char)**at))
                (*at)++;
            *at += *at == name && *at < end;
            width += size * command_width(name, (size_t)(*at - name));
            if (is_command(name, (size_t)(*at - name), "frac"))
                width += fraction_width(at, end, size);
            if (is_command(name, (size_t)(*at - name), "begin")
                || is_command(name, (size_t)(*at - name), "end"))
                while (*at < end && *(*at)++ != '}') // the name of the environment
                    ;
        } else {
            width += (c & 0xC0) == 0x80 ? 0 : size * character_width(c);
        }
        if (is_one)
            break;
    }
    return width;
}

size_t ct_latex_width(const char *s, size_t length)
{
    const char *at = s, *end = s + length;
    double width = 0;
    while (at < end) {
        width += width_of(&at, end, 1, false);
        at += at < end; // an unmatched brace
    }
    return (size_t)(width + 0.5);
}
