// Mathematics as presentation MathML Core; see mathml.h.
//
// LaTeX is read item by item: a nucleus (a letter, a number, a command with its groups, a pair
// of delimiters with contents) and its scripts. An item becomes one element; a command for a
// sign becomes an operator.
#include "report/mathml.h"

#include "base/entry.h"
#include "expr/print.h"

#include <ctype.h>
#include <stdint.h>
#include <string.h>

const char ct_mathml_style[]
    = "math.equation, .side, .term.wide { display: flex; flex-wrap: wrap; "
      "align-items: baseline; row-gap: .3em }\n"
      "math.equation, .side, .term, .right { max-width: 100%; min-width: 0 }\n"
      ".right { display: flex; align-items: baseline; padding-left: 1.2em }\n"
      ".right > mo { margin-right: .28em }\n"
      ".aligned { display: grid; grid-template-columns: max-content minmax(0, 1fr); "
      "row-gap: .4em }\n"
      ".aligned > math.equation { display: grid; grid-column: 1 / -1; "
      "grid-template-columns: subgrid }\n"
      ".aligned .right { padding-left: .28em }\n"
      ".vector { font-weight: bold }\n"
      ".matrix { overflow-x: auto; max-width: 100% }\n"
      ".matrix mtd { text-align: right; padding: .15em .5em }\n"
      ".matrix mtd.name { opacity: .75 }\n"
      ".matrix mtr:first-child > mtd.name { border-bottom: 1px solid }\n"
      ".matrix mtd.name:first-child { border-right: 1px solid }\n";

// ---- text ----------------------------------------------------------------------------------

// Bytes of the character of UTF-8 at s, at most n, and its code; 0: no valid one.
static size_t decode(const char *s, size_t n, uint32_t *code)
{
    const unsigned char *u = (const unsigned char *)s;
    const size_t length = u[0] < 0x80           ? 1
                        : (u[0] & 0xE0) == 0xC0 ? 2
                        : (u[0] & 0xF0) == 0xE0 ? 3
                        : (u[0] & 0xF8) == 0xF0 ? 4
                                                : 0;
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000}; // shortest form only
    if (!length || length > n)
        return 0;
    *code = length == 1 ? u[0] : u[0] & (0x7Fu >> length);
    for (size_t i = 1; i < length; i++) {
        if ((u[i] & 0xC0) != 0x80)
            return 0;
        *code = *code << 6 | (u[i] & 0x3F);
    }
    return *code < least[length] ? 0 : length;
}

// Not allowed in XML 1.0, or a control of the direction of text (Unicode Standard Annex 9).
static bool is_refused(uint32_t c)
{
    return (c < 0x20 && c != '\t' && c != '\n' && c != '\r') || (c >= 0xD800 && c < 0xE000)
        || c == 0xFFFE || c == 0xFFFF || c > 0x10FFFF || c == 0x61C || c == 0x200E
        || c == 0x200F || (c >= 0x202A && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069);
}

// One character; returns its bytes.
static size_t put_character(FILE *out, const char *s, size_t n)
{
    uint32_t code = 0;
    const size_t length = decode(s, n, &code);
    if (!length || is_refused(code))
        fputs("\xEF\xBF\xBD", out);
    else if (code == '<')
        fputs("&lt;", out);
    else if (code == '>')
        fputs("&gt;", out);
    else if (code == '&')
        fputs("&amp;", out);
    else if (code == '"')
        fputs("&quot;", out);
    else
        fwrite(s, 1, length, out);
    return length ? length : 1;
}

void ct_html_text(FILE *out, const char *s, size_t n)
{
    n = strnlen(s, n);
    for (size_t i = 0; i < n;)
        i += put_character(out, s + i, n - i);
}

// ---- reading -------------------------------------------------------------------------------

// A piece of LaTeX.
struct span {
    const char *s, *end;
};

static bool is_named(const char *s, size_t n, const char *name)
{
    return strlen(name) == n && !memcmp(s, name, n);
}

// Letters of the command at s, which begins with a backslash; 0: a quoted sign or a space.
static size_t command_length(const char *s, const char *end)
{
    size_t n = 0;
    while (s + 1 + n < end && isalpha((unsigned char)s[1 + n]))
        n++;
    return n;
}

static const char *skip_blanks(const char *s, const char *end)
{
    while (s < end && (*s == ' ' || *s == '&' || *s == '\n'))
        s++;
    return s;
}

// The position after the group that starts at s.
static const char *skip_group(const char *s, const char *end)
{
    int depth = 0;
    for (; s < end; s++) {
        if (*s == '\\' && s + 1 < end)
            s++;
        else
            depth += (*s == '{') - (*s == '}');
        if (depth == 0)
            return s + 1;
    }
    return end;
}

// The contents of the group at s, or one character; *s moves after it.
static struct span take_group(const char **s, const char *end)
{
    const char *at = skip_blanks(*s, end);
    if (at < end && *at == '{') {
        *s = skip_group(at, end);
        return (struct span){at + 1, *s > at + 1 ? *s - 1 : at + 1};
    }
    *s = at;
    if (at < end && *at == '\\') {
        const size_t n = command_length(at, end);
        *s = n || at + 2 > end ? at + 1 + n : at + 2;
    } else if (at < end) {
        *s = at + 1;
    }
    return (struct span){at, *s};
}

static bool starts(const char *s, const char *end, const char *word)
{
    const size_t n = strlen(word);
    return (size_t)(end - s) >= n && !memcmp(s, word, n);
}

// The position after the command `close` that matches `open` at s, at the same depth; *inner
// ends before it.
static const char *skip_pair(const char *s, const char *end, const char *open,
                             const char *close, const char **inner)
{
    int depth = 0;
    for (; s < end; s++) {
        if (*s != '\\')
            continue;
        if (starts(s, end, open))
            depth++;
        else if (starts(s, end, close) && --depth == 0) {
            *inner = s;
            return s + strlen(close);
        }
        s++; // a quoted sign
    }
    *inner = end;
    return end;
}

// Number of groups after a command.
static int count_groups(const char *name, size_t n)
{
    static const char *const one[] = {"mathrm", "boldsymbol", "operatorname", "text", "sqrt",
                                      "dot",    "ddot",       "dddot",        "bar",  "tilde"};
    if (is_named(name, n, "frac") || is_named(name, n, "tfrac"))
        return 2;
    for (size_t i = 0; i < COUNT(one); i++)
        if (is_named(name, n, one[i]))
            return 1;
    return 0;
}

static const char *skip_nucleus(const char *s, const char *end)
{
    const char *inner;
    if (*s == '{')
        return skip_group(s, end);
    if (isdigit((unsigned char)*s)) {
        while (s < end && (isdigit((unsigned char)*s) || *s == '.'))
            s++;
        return s;
    }
    if (*s != '\\') {
        uint32_t code;
        const size_t n = decode(s, (size_t)(end - s), &code);
        return s + (n ? n : 1);
    }
    const size_t n = command_length(s, end);
    const char *at = s + 1 + n;
    if (!n)
        return s + 2 > end ? end : s + 2;
    if (is_named(s + 1, n, "left")) {
        at = skip_pair(s, end, "\\left", "\\right", &inner);
        return at < end ? at + 1 : end; // the delimiter
    }
    if (is_named(s + 1, n, "begin"))
        return skip_group(skip_pair(s, end, "\\begin", "\\end", &inner), end);
    for (int i = count_groups(s + 1, n); i > 0; i--)
        take_group(&at, end);
    return at;
}

// A nucleus with its scripts, which may be empty.
struct item {
    struct span nucleus, below, above;
    const char *end;
};

static struct item read_item(const char *s, const char *end)
{
    struct item it = {.nucleus = {s, skip_nucleus(s, end)}};
    it.end = it.nucleus.end;
    while (it.end < end && (*it.end == '_' || *it.end == '^')) {
        const bool is_below = *it.end == '_';
        const char *at = it.end + 1;
        *(is_below ? &it.below : &it.above) = take_group(&at, end);
        it.end = at;
    }
    return it;
}

// ---- leaves --------------------------------------------------------------------------------

static const struct sign {
    const char *name, *text;
} letters[] = {
    {"alpha", "\u03B1"},  {"beta", "\u03B2"},    {"gamma", "\u03B3"},  {"delta", "\u03B4"},
    {"epsilon", "\u03B5"}, {"zeta", "\u03B6"},   {"eta", "\u03B7"},    {"theta", "\u03B8"},
    {"iota", "\u03B9"},   {"kappa", "\u03BA"},   {"lambda", "\u03BB"}, {"mu", "\u03BC"},
    {"nu", "\u03BD"},     {"xi", "\u03BE"},      {"pi", "\u03C0"},     {"rho", "\u03C1"},
    {"sigma", "\u03C3"},  {"tau", "\u03C4"},     {"upsilon", "\u03C5"}, {"phi", "\u03D5"},
    {"varphi", "\u03C6"}, {"chi", "\u03C7"},     {"psi", "\u03C8"},    {"omega", "\u03C9"},
    {"Gamma", "\u0393"},  {"Delta", "\u0394"},   {"Theta", "\u0398"},  {"Lambda", "\u039B"},
    {"Xi", "\u039E"},     {"Pi", "\u03A0"},      {"Sigma", "\u03A3"},  {"Upsilon", "\u03A5"},
    {"Phi", "\u03A6"},    {"Psi", "\u03A8"},     {"Omega", "\u03A9"},
}, operators[] = {
    {"cdot", "\u22C5"}, {"times", "\u00D7"}, {"neq", "\u2260"},   {"leq", "\u2264"},
    {"geq", "\u2265"},  {"int", "\u222B"},   {"ldots", "\u2026"}, {"sum", "\u2211"},
    {"partial", "\u2202"},
}, functions[] = {
    {"sin", "sin"},       {"cos", "cos"},       {"tan", "tan"},   {"sinh", "sinh"},
    {"cosh", "cosh"},     {"tanh", "tanh"},     {"exp", "exp"},   {"ln", "ln"},
    {"min", "min"},       {"max", "max"},       {"arcsin", "arcsin"}, {"arccos", "arccos"},
    {"arctan", "arctan"},
}, accents[] = {{"dot", "\u02D9"}, {"ddot", "\u00A8"}, {"dddot", "\u22EF"}, {"bar", "\u00AF"}, {"tilde", "~"}};

static const char *find_sign(const struct sign *list, size_t count, const char *name, size_t n)
{
    for (size_t i = 0; i < count; i++)
        if (is_named(name, n, list[i].name))
            return list[i].text;
    return NULL;
}
#define FIND_SIGN(list, name, n) find_sign((list), COUNT(list), (name), (n))

// Text with the characters that ct_latex_quoted escapes.
static void put_unquoted(FILE *out, struct span t)
{
    static const struct sign quoted[]
        = {{"\\backslash ", "\\"}, {"\\wedge ", "^"}, {"\\sim ", "~"}};
    while (t.s < t.end) {
        size_t k = 0;
        while (k < COUNT(quoted) && !starts(t.s, t.end, quoted[k].name))
            k++;
        if (k < COUNT(quoted)) {
            fputs(quoted[k].text, out);
            t.s += strlen(quoted[k].name);
            continue;
        }
        t.s += *t.s == '\\' && t.s + 1 < t.end;
        t.s += put_character(out, t.s, (size_t)(t.end - t.s));
    }
}

static void put_row(FILE *out, struct span t);

// Is t one item, which becomes one element?
static bool is_element(struct span t)
{
    const char *s = skip_blanks(t.s, t.end);
    return s < t.end && skip_blanks(read_item(s, t.end).end, t.end) == t.end;
}

// A row as one element.
static void put_element_row(FILE *out, struct span t)
{
    if (is_element(t)) {
        put_row(out, t);
        return;
    }
    fputs("<mrow>", out);
    put_row(out, t);
    fputs("</mrow>", out);
}

// Upright words; a single letter is italic by default.
static void put_words(FILE *out, struct span t)
{
    fputs(t.end - t.s == 1 ? "<mi mathvariant=\"normal\">" : "<mi>", out);
    put_unquoted(out, t);
    fputs("</mi>", out);
}

static void put_vector(FILE *out, struct span t)
{
    const size_t n = t.s < t.end && *t.s == '\\' ? command_length(t.s, t.end) : 0;
    const char *letter = n ? FIND_SIGN(letters, t.s + 1, n) : NULL;
    fputs("<mi class=\"vector\">", out);
    if (letter)
        fputs(letter, out);
    else
        put_unquoted(out, t);
    fputs("</mi>", out);
}

// ---- commands ------------------------------------------------------------------------------

static void put_delimiter(FILE *out, char c, const char *form, bool is_tall)
{
    if (c != '.')
        fprintf(out, "<mo form=\"%s\" stretchy=\"%s\">%c</mo>", form,
                is_tall ? "true" : "false", c);
}

// Does it contain anything taller than a letter, which needs tall delimiters?
static bool is_tall(struct span t)
{
    static const char *const tall[] = {"\\frac", "\\begin", "\\sqrt", "\\int"};
    for (; t.s < t.end; t.s++)
        for (size_t i = 0; *t.s == '\\' && i < COUNT(tall); i++)
            if (starts(t.s, t.end, tall[i]))
                return true;
    return false;
}

// \left( ... \right)
static struct span fenced(struct span t, char *open, char *close)
{
    const char *inner;
    const char *s = t.s + strlen("\\left");
    skip_pair(t.s, t.end, "\\left", "\\right", &inner);
    *open = s < t.end ? *s : '.';
    *close = inner < t.end ? t.end[-1] : '.';
    return (struct span){s < inner ? s + 1 : inner, inner};
}

static void put_fenced(FILE *out, struct span t)
{
    char open, close;
    const struct span inner = fenced(t, &open, &close);
    fputs("<mrow>", out);
    put_delimiter(out, open, "prefix", is_tall(inner));
    put_element_row(out, inner);
    put_delimiter(out, close, "postfix", is_tall(inner));
    fputs("</mrow>", out);
}

// \begin{cases} a & b \\ c & d \end{cases}
static void put_cases(FILE *out, struct span t)
{
    const char *inner, *s = skip_group(t.s + strlen("\\begin"), t.end);
    int depth = 0;
    skip_pair(t.s, t.end, "\\begin", "\\end", &inner);
    fputs("<mrow><mo form=\"prefix\" stretchy=\"true\">{</mo><mtable><mtr><mtd>", out);
    for (const char *from = s;; s++) {
        const bool is_row = s + 1 < inner && depth == 0 && s[0] == '\\' && s[1] == '\\';
        const bool is_cell = s < inner && depth == 0 && *s == '&';
        if (s >= inner || is_row || is_cell) {
            put_row(out, (struct span){from, s < inner ? s : inner});
            if (s >= inner)
                break;
            fputs(is_row ? "</mtd></mtr><mtr><mtd>" : "</mtd><mtd>", out);
            s += is_row;
            from = s + 1;
        } else if (*s == '\\') {
            depth += starts(s, inner, "\\begin") - starts(s, inner, "\\end");
            s++;
        } else {
            depth += (*s == '{') - (*s == '}');
        }
    }
    fputs("</mtd></mtr></mtable></mrow>", out);
}

static void put_groups(FILE *out, const char *name, size_t n, struct span t)
{
    const char *s = t.s, *accent = FIND_SIGN(accents, name, n);
    const struct span first = take_group(&s, t.end);
    if (is_named(name, n, "frac") || is_named(name, n, "tfrac")) {
        fputs(*name == 't' ? "<mfrac displaystyle=\"false\">" : "<mfrac>", out);
        put_element_row(out, first);
        put_element_row(out, take_group(&s, t.end));
        fputs("</mfrac>", out);
    } else if (accent) {
        fputs("<mover accent=\"true\">", out);
        put_element_row(out, first);
        fprintf(out, "<mo stretchy=\"false\">%s</mo></mover>", accent);
    } else if (is_named(name, n, "sqrt")) {
        fputs("<msqrt>", out);
        put_element_row(out, first);
        fputs("</msqrt>", out);
    } else if (is_named(name, n, "boldsymbol")) {
        put_vector(out, first);
    } else if (is_named(name, n, "text")) {
        fputs("<mtext>", out);
        put_unquoted(out, first);
        fputs("</mtext>", out);
    } else { // mathrm, operatorname
        put_words(out, first);
    }
}

static void put_command(FILE *out, struct span t)
{
    const char *name = t.s + 1, *text;
    const size_t n = command_length(t.s, t.end);
    if (!n && t.s + 1 < t.end && *name == ',') // a product
        fputs("<mo rspace=\".17em\">\u2062</mo>", out);
    else if (!n && t.s + 1 < t.end && *name == ';')
        fputs("<mspace width=\"0.28em\"></mspace>", out);
    else if (!n)
        put_words(out, t);
    else if (is_named(name, n, "left"))
        put_fenced(out, t);
    else if (is_named(name, n, "begin"))
        put_cases(out, t);
    else if (is_named(name, n, "quad") || is_named(name, n, "qquad"))
        fprintf(out, "<mspace width=\"%dem\"></mspace>", *(name + 1) == 'q' ? 2 : 1);
    else if (count_groups(name, n))
        put_groups(out, name, n, (struct span){name + n, t.end});
    else if ((text = FIND_SIGN(letters, name, n)))
        fprintf(out, "<mi>%s</mi>", text);
    else if ((text = FIND_SIGN(operators, name, n)))
        fprintf(out, "<mo>%s</mo>", text);
    else if ((text = FIND_SIGN(functions, name, n)))
        fprintf(out, "<mi>%s</mi>", text);
    else
        put_words(out, (struct span){name, name + n});
}

// ---- rows ----------------------------------------------------------------------------------

// A sign with nothing before it belongs to a number or to the first term.
static void put_operator(FILE *out, char c, bool is_first)
{
    const char *text = c == '-' ? "\u2212" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : NULL;
    const char one[2] = {c, '\0'};
    if (strchr("+-", c))
        fprintf(out, "<mo form=\"%s\">%s</mo>", is_first ? "prefix" : "infix",
                text ? text : one);
    else if (strchr("()[]|", c))
        fprintf(out, "<mo form=\"%s\" stretchy=\"false\">%c</mo>",
                strchr("([", c) ? "prefix" : "postfix", c);
    else
        fprintf(out, "<mo>%s</mo>", text ? text : one);
}

static bool is_operator(char c)
{
    return strchr("+-=<>()[]|,.;:!/*", c);
}

// Does a sign after this item belong to the next item?
static bool leads(struct span nucleus)
{
    static const char *const before[] = {"\\neq", "\\leq", "\\geq", "\\times", "\\cdot"};
    for (size_t i = 0; i < COUNT(before); i++)
        if (starts(nucleus.s, nucleus.end, before[i]))
            return true;
    return nucleus.end - nucleus.s == 1 && strchr("=<>([,;", *nucleus.s);
}

static void put_nucleus(FILE *out, struct span t, bool is_first)
{
    if (t.s >= t.end || (t.end - t.s == 2 && t.s[0] == '{'))
        fputs("<mrow></mrow>", out);
    else if (*t.s == '{')
        put_element_row(out, (struct span){t.s + 1, t.end - 1});
    else if (*t.s == '\\')
        put_command(out, t);
    else if (isdigit((unsigned char)*t.s))
        fprintf(out, "<mn>%.*s</mn>", (int)(t.end - t.s), t.s);
    else if (*t.s == '\'')
        fputs("<mo>\u2032</mo>", out);
    else if (is_operator(*t.s))
        put_operator(out, *t.s, is_first);
    else {
        fputs("<mi>", out);
        put_character(out, t.s, (size_t)(t.end - t.s));
        fputs("</mi>", out);
    }
}

static bool is_function(struct span nucleus)
{
    const size_t n = *nucleus.s == '\\' ? command_length(nucleus.s, nucleus.end) : 0;
    return n
        && (FIND_SIGN(functions, nucleus.s + 1, n)
            || is_named(nucleus.s + 1, n, "operatorname"));
}

// The argument of a function without parentheses is separated by a space.
static void put_application(FILE *out, const struct item *it, const char *end)
{
    const char *next = skip_blanks(it->end, end);
    if (!is_function(it->nucleus) || next >= end)
        return;
    const bool is_fenced = *next == '(' || starts(next, end, "\\left(");
    fprintf(out, "<mo rspace=\"%s\">\u2061</mo>", is_fenced ? "0" : ".17em");
}

static void put_item(FILE *out, const struct item *it, bool is_first, const char *end)
{
    const bool has_below = it->below.s, has_above = it->above.s;
    static const char *const tag[] = {"msub", "msup", "msubsup"};
    if (has_below || has_above)
        fprintf(out, "<%s>", tag[has_below && has_above ? 2 : has_above]);
    put_nucleus(out, it->nucleus, is_first);
    if (has_below)
        put_element_row(out, it->below);
    if (has_above)
        put_element_row(out, it->above);
    if (has_below || has_above)
        fprintf(out, "</%s>", tag[has_below && has_above ? 2 : has_above]);
    put_application(out, it, end);
}

static void put_row(FILE *out, struct span t)
{
    bool is_first = true;
    for (const char *s = skip_blanks(t.s, t.end); s < t.end; s = skip_blanks(s, t.end)) {
        const struct item it = read_item(s, t.end);
        put_item(out, &it, is_first, t.end);
        is_first = leads(it.nucleus);
        s = it.end;
    }
}

void ct_mathml_row(FILE *out, const char *latex)
{
    put_row(out, (struct span){latex, latex + strlen(latex)});
}

void ct_mathml_inline(FILE *out, const char *latex)
{
    fputs("<math>", out);
    ct_mathml_row(out, latex);
    fputs("</math>", out);
}

// ---- terms ---------------------------------------------------------------------------------

// Layout: widths in LaTeX at 10 pt [pt]: 10 are 1 em. A phone is 390 px wide, 22 em within margins
// of 1 em. A term wider than an indented line there may be broken; a piece may end before a factor
// when it has half that width.
enum { PHONE_LINE = 180, LONG_PIECE = PHONE_LINE / 2 };

static size_t width_of(struct span t)
{
    return ct_latex_width(t.s, (size_t)(t.end - t.s));
}

// A term written in pieces; lines may end between them.
struct pieces {
    FILE *out;
    bool is_open;
    size_t width; // of the piece so far [pt]
};

static void open_piece(struct pieces *p)
{
    if (!p->is_open)
        fputs("<mrow>", p->out);
    p->is_open = true;
}

static void end_piece(struct pieces *p)
{
    if (p->is_open)
        fputs("</mrow>", p->out);
    p->is_open = false;
    p->width = 0;
}

static void put_pieces(struct pieces *p, struct span t, bool is_first);

// Parentheses that do not fit a line: opened in the first piece, closed in the last.
static void put_wide_fenced(struct pieces *p, const struct item *it)
{
    char open, close;
    const struct span inner = fenced(it->nucleus, &open, &close);
    struct item last = {.nucleus = {&close, &close + 1},
                        .below = it->below,
                        .above = it->above,
                        .end = it->end};
    open_piece(p);
    put_delimiter(p->out, open, "prefix", false);
    put_pieces(p, inner, true);
    open_piece(p);
    if (close != '.')
        put_item(p->out, &last, false, it->end);
}

// Does an item begin a factor, so that a long piece may end before it?
static bool begins_factor(struct span nucleus)
{
    const bool is_space = *nucleus.s == '\\' && !command_length(nucleus.s, nucleus.end);
    return !is_space && !is_operator(*nucleus.s) && !leads(nucleus);
}

static void put_pieces(struct pieces *p, struct span t, bool is_first)
{
    bool is_argument = false;
    for (const char *s = skip_blanks(t.s, t.end); s < t.end; s = skip_blanks(s, t.end)) {
        const struct item it = read_item(s, t.end);
        const struct span whole = {s, it.end};
        const bool is_long = p->width > LONG_PIECE && begins_factor(it.nucleus) && !is_argument;
        if (is_long || (!is_first && it.end - s == 1 && strchr("+-<>", *s)))
            end_piece(p);
        open_piece(p);
        if (starts(s, t.end, "\\left(") && width_of(whole) > LONG_PIECE) {
            put_wide_fenced(p, &it);
        } else {
            put_item(p->out, &it, is_first, t.end);
            p->width += width_of(whole);
        }
        if (*s == ',')
            end_piece(p);
        is_first = leads(it.nucleus);
        is_argument = is_function(it.nucleus);
        s = it.end;
    }
}

// Each word is an element, so that lines can end between words.
static void put_note(FILE *out, const char *note)
{
    for (size_t n; *note; note += n + strspn(note + n, " ")) {
        n = strcspn(note, " ");
        fputs("<mtext class=\"note\">", out);
        ct_html_text(out, note, n);
        fputs("</mtext>", out);
    }
}

static void open_term(FILE *out, const struct ct_mathml_term *t, const char *classes)
{
    fprintf(out, "<mrow class=\"%s\"", classes);
    if (t->components) {
        fputs(" data-component=\"", out);
        ct_html_text(out, t->components, SIZE_MAX);
        fputc('"', out);
    }
    fputc('>', out);
}

static void put_plain(FILE *out, const struct ct_mathml_term *t, bool is_first)
{
    const char *s = t->plain;
    open_term(out, t, "term plain");
    fputs("<mtext>", out);
    if (!is_first) {
        fputs(*s == '-' ? "- " : "+ ", out);
        s += *s == '-';
    }
    ct_html_text(out, s, SIZE_MAX);
    fputs("</mtext></mrow>", out);
}

static void put_typeset(FILE *out, const struct ct_mathml_term *t, bool is_first)
{
    const struct span all = {t->latex, t->latex + strlen(t->latex)};
    const bool is_wide = width_of(all) > PHONE_LINE;
    open_term(out, t, is_wide ? "term wide" : "term");
    const char *s = skip_blanks(all.s, all.end);
    struct pieces p = {.out = out};
    if (is_wide)
        open_piece(&p);
    if (!is_first && s < all.end && strchr("+-", *s)) {
        fprintf(out, "<mo form=\"infix\" lspace=\"0.22em\" rspace=\"0.22em\">%s</mo>",
                *s == '-' ? "\u2212" : "+");
        s++;
    }
    if (is_wide) {
        put_pieces(&p, (struct span){s, all.end}, true);
        end_piece(&p);
    } else {
        put_row(out, (struct span){s, all.end});
    }
    fputs("</mrow>", out);
}

// is_first: the first term of a side; the sign of a later one is an operator between terms.
static void put_term(FILE *out, const struct ct_mathml_term *t, bool is_first)
{
    if (t->plain)
        put_plain(out, t, is_first);
    else
        put_typeset(out, t, is_first);
    if (t->value) {
        fputs("<mtext class=\"value\">", out);
        ct_html_text(out, t->value, SIZE_MAX);
        fputs("</mtext>", out);
    }
    put_note(out, t->note ? t->note : "");
}

static void put_side(FILE *out, const struct ct_mathml_side *side)
{
    fputs("<mrow class=\"side\">", out);
    for (size_t i = 0; i < side->n; i++)
        put_term(out, &side->term[i], i == 0);
    fputs("</mrow>", out);
}

void ct_mathml_equation(FILE *out, const struct ct_mathml_equation *e)
{
    fputs("<math class=\"equation\" display=\"block\"", out);
    if (e->name) {
        fputs(" data-equation=\"", out);
        ct_html_text(out, e->name, SIZE_MAX);
        fputc('"', out);
    }
    fputc('>', out);
    put_side(out, &e->left);
    if (e->right.n) {
        fputs("<mrow class=\"right\"><mo>=</mo>", out);
        put_side(out, &e->right);
        fputs("</mrow>", out);
    }
    fputs("</math>\n", out);
}

// ---- matrices ------------------------------------------------------------------------------

void ct_mathml_matrix(FILE *out, const char *const *cell, size_t nrow, size_t ncolumn,
                      bool has_names)
{
    fputs("<div class=\"matrix\"><math><mtable>\n", out);
    for (size_t i = 0; i < nrow; i++) {
        fputs("<mtr>", out);
        for (size_t j = 0; j < ncolumn; j++) {
            const char *s = cell[i * ncolumn + j];
            fputs(has_names && (i == 0 || j == 0) ? "<mtd class=\"name\">" : "<mtd>", out);
            ct_mathml_row(out, strcmp(s, ".") ? s : "\\cdot");
            fputs("</mtd>", out);
        }
        fputs("</mtr>\n", out);
    }
    fputs("</mtable></math></div>\n", out);
}
