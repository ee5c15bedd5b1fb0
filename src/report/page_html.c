// Pages as one HTML document without scripts; see page.h.
//
// Mathematics arrives in the style of text and is set by its words: a name becomes an italic letter
// with subscripts, primes become dots, * a thin space, ^2 a superscript.
#include "report/page.h"

#include <ctype.h>
#include <stdint.h>
#include <string.h>

static void put_escaped(FILE *out, const char *s, size_t n)
{
    for (size_t i = 0; i < n && s[i]; i++) {
        if (s[i] == '<')
            fputs("&lt;", out);
        else if (s[i] == '>')
            fputs("&gt;", out);
        else if (s[i] == '&')
            fputs("&amp;", out);
        else if (s[i] == '"')
            fputs("&quot;", out);
        else
            fputc(s[i], out);
    }
}

// ---- names ------------------------------------------------------------------------------------

static bool is_word(const char *s, size_t n, const char *word)
{
    return strlen(word) == n && !memcmp(s, word, n);
}

static bool is_function(const char *s, size_t n)
{
    static const char *const name[]
        = {"sin",  "cos",  "tan", "asin", "acos",   "atan",  "atan2", "sinh",
           "cosh", "tanh", "exp", "log",  "sqrt",   "abs",   "sign",  "min",
           "max",  "if",   "Rot", "diag", "effort", "const", "int"};
    for (size_t i = 0; i < COUNT(name); i++)
        if (is_word(s, n, name[i]))
            return true;
    return false;
}

static bool is_vector(const char *s, size_t n)
{
    return (n == 1 && strchr("FTdSaIw", *s)) || is_word(s, n, "al");
}

// Greek letters by their names; the others as they are.
static void put_letter(FILE *out, const char *s, size_t n)
{
    static const char *const greek[][2]
        = {{"alpha", "&alpha;"}, {"al", "&alpha;"},      {"beta", "&beta;"},
           {"gamma", "&gamma;"}, {"delta", "&delta;"},   {"epsilon", "&epsilon;"},
           {"theta", "&theta;"}, {"lambda", "&lambda;"}, {"mu", "&mu;"},
           {"rho", "&rho;"},     {"phi", "&phi;"},       {"psi", "&psi;"},
           {"omega", "&omega;"}, {"w", "&omega;"},       {"tau", "&tau;"},
           {"pi", "&pi;"},       {"xi", "&xi;"}};
    for (size_t i = 0; i < COUNT(greek); i++)
        if (is_word(s, n, greek[i][0])) {
            fputs(greek[i][1], out);
            return;
        }
    put_escaped(out, s, n);
}

static bool is_name_character(char c)
{
    return isalnum((unsigned char)c) || c == '_' || c == '.';
}

// crank.q3'' -> q with two dots and the subscripts 3, crank; c_rod -> c with subscript rod.
static void put_name(FILE *out, const char *s, size_t n, size_t nprime)
{
    const char *dot = NULL, *bar = memchr(s, '_', n);
    for (size_t i = 0; i < n; i++)
        dot = s[i] == '.' ? s + i : dot;
    // a part behind the last dot that is a quantity stands first: a coordinate of a joint or of a beam's node
    const size_t behind = dot ? (size_t)(s + n - dot) - 2 : 0;
    const bool is_quantity = dot
                          && ((strchr("qua", dot[1]) && strspn(dot + 2, "0123456789") == behind)
                              || (strchr("vw", dot[1]) && behind == 0)
                              || (dot[1] == 'r' && behind == 1 && strchr("xyz", dot[2])));
    const char *base = is_quantity ? dot + 1 : s;
    const char *end = s + n;
    size_t length = (size_t)(is_quantity ? end - base : bar && bar > s ? bar - s : (long)n);
    size_t letters = length;
    while (letters > 1 && isdigit((unsigned char)base[letters - 1]))
        letters--;
    fputs("<i>", out);
    if (is_word(base, letters, "w") && !(bar && bar > s))
        fputc('w', out); // a displacement; w_rod and w(rod) are angular velocities
    else
        put_letter(out, base, letters);
    fputs(nprime == 1 ? "&#775;" : nprime >= 2 ? "&#776;" : "", out);
    fputs("</i>", out);
    const bool has_digits = letters < length, has_rest = is_quantity || (bar && bar > s);
    if (!has_digits && !has_rest)
        return;
    fputs("<sub>", out);
    put_escaped(out, base + letters, length - letters);
    fputs(has_digits && has_rest ? "," : "", out);
    if (is_quantity)
        put_escaped(out, s, (size_t)(dot - s));
    else if (has_rest)
        put_escaped(out, bar + 1, (size_t)(end - bar - 1));
    fputs("</sub>", out);
}

// A name with what belongs to it; returns the characters used.
static size_t put_word(FILE *out, const char *s)
{
    size_t n = 0, nprime = 0;
    while (is_name_character(s[n]))
        n++;
    while (s[n + nprime] == '\'')
        nprime++;
    const char *close = s[n] == '(' ? strchr(s + n, ')') : NULL;
    if (close && (is_vector(s, n) || is_word(s, n, "lambda"))) {
        const bool bold = is_vector(s, n);
        fputs(bold ? "<b>" : "<i>", out);
        put_letter(out, s, n);
        fputs(bold ? "</b><sub>" : "</i><sub>", out);
        put_escaped(out, s + n + 1, (size_t)(close - s) - n - 1);
        fputs("</sub>", out);
        return (size_t)(close - s) + 1;
    }
    if (is_function(s, n))
        put_escaped(out, s, n);
    else
        put_name(out, s, n, nprime);
    return n + nprime;
}

static size_t put_number(FILE *out, const char *s)
{
    size_t n = strspn(s, "0123456789.");
    put_escaped(out, s, n);
    if (s[n] == 'e'
        && (s[n + 1] == '-' || s[n + 1] == '+' || isdigit((unsigned char)s[n + 1]))) {
        const size_t digits = 1 + (s[n + 1] == '-' || s[n + 1] == '+');
        const size_t k = digits + strspn(s + n + digits, "0123456789");
        fputs("&middot;10<sup>", out);
        fputs(s[n + 1] == '-' ? "&minus;" : "", out);
        put_escaped(out, s + n + digits, k - digits);
        fputs("</sup>", out);
        n += k;
    }
    return n;
}

// The x of a cross product stands between blanks and operands.
static bool is_cross(const char *s, const char *start)
{
    return *s == 'x' && s > start + 1 && s[-1] == ' ' && !strchr("+-=,", s[-2]) && s[1] == ' '
        && !strchr("+-=", s[2]);
}

static void put_math(FILE *out, const char *s)
{
    const char *const start = s;
    while (*s) {
        if (is_cross(s, start)) {
            fputs("&times;", out);
            s++;
        } else if (isalpha((unsigned char)*s)) {
            s += put_word(out, s);
        } else if (isdigit((unsigned char)*s)) {
            s += put_number(out, s);
        } else if (*s == '^') {
            size_t n = 1 + strspn(s + 1, "0123456789");
            fputs("<sup>", out);
            put_escaped(out, s + 1, n - 1);
            fputs("</sup>", out);
            s += n;
        } else {
            if (*s == '*')
                fputs("&#8201;", out);
            else if (*s == '-')
                fputs("&minus;", out);
            else
                put_escaped(out, s, 1);
            s++;
        }
    }
}

// ---- blocks -----------------------------------------------------------------------------------

static void put_equations(FILE *out, const struct ct_page_block *b)
{
    fputs("<table class=\"equations\">\n", out);
    for (size_t i = 0; i < b->nequation; i++) {
        const struct ct_page_equation *e = &b->equation[i];
        fputs("<tr><td class=\"label\">", out);
        put_escaped(out, e->label ? e->label : "", SIZE_MAX);
        fputs("</td><td class=\"left\">", out);
        put_math(out, e->left);
        fputs("</td><td>", out);
        if (e->right) {
            fputs("= ", out);
            put_math(out, e->right);
        }
        if (e->note) {
            fputs(" <span class=\"note\">", out);
            put_escaped(out, e->note, SIZE_MAX);
            fputs("</span>", out);
        }
        fputs("</td></tr>\n", out);
    }
    fputs("</table>\n", out);
}

static void put_table(FILE *out, const struct ct_page_block *b)
{
    const size_t n = strlen(b->align);
    fputs("<table>\n", out);
    for (size_t i = 0; i < b->ncell; i++) {
        const char letter = b->align[i % n];
        const char *tag = i < n ? "th" : "td";
        fputs(i % n ? "" : "<tr>", out);
        fprintf(out, "<%s%s>", tag,
                tolower((unsigned char)letter) == 'r' ? " class=\"right\"" : "");
        if (isupper((unsigned char)letter) && i >= n)
            put_math(out, b->cell[i]);
        else
            put_escaped(out, b->cell[i], SIZE_MAX);
        fprintf(out, "</%s>%s", tag, (i + 1) % n ? "" : "</tr>\n");
    }
    fputs("</table>\n", out);
}

static void put_matrix(FILE *out, const struct ct_page_block *b)
{
    fputs("<table class=\"matrix\">\n", out);
    for (size_t i = 0; i < b->ncell; i++) {
        const size_t k = i % b->ncolumn;
        const bool is_name = i < b->ncolumn || k == 0;
        fputs(k ? "" : "<tr>", out);
        fputs(is_name ? "<th>" : "<td>", out);
        if (is_name)
            put_escaped(out, b->cell[i], SIZE_MAX);
        else
            put_math(out, b->cell[i]);
        fprintf(out, "</%s>%s", is_name ? "th" : "td", k + 1 == b->ncolumn ? "</tr>\n" : "");
    }
    fputs("</table>\n", out);
}

void ct_page_print_html(FILE *out, const struct ct_page *p, const char *title)
{
    static const char *const tag[] = {"h1", "h2", "p"};
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>",
          out);
    put_escaped(out, title, SIZE_MAX);
    fputs("</title>\n<style>\n"
          "body { font: 16px/1.5 serif; max-width: 70em; margin: 2em auto; padding: 0 1em }\n"
          "h1 { font-size: 1.4em; border-bottom: 1px solid #888 }\nh2 { font-size: 1.1em }\n"
          "td, th { padding: 0 1em 0 0; text-align: left; vertical-align: top }\n"
          "th { font-weight: normal; color: #666 }\n"
          ".right { text-align: right }\n.equations td { padding: .2em .6em .2em 0 }\n"
          ".matrix td { text-align: center; border-left: 1px solid #ccc; padding: 0 .6em }\n"
          ".left { white-space: nowrap }\n.label, .note { color: #666 }\n"
          "</style>\n</head>\n<body>\n",
          out);
    for (size_t i = 0; i < p->nblock; i++) {
        const struct ct_page_block *b = &p->block[i];
        if (b->kind == CT_PAGE_TABLE) {
            put_table(out, b);
        } else if (b->kind == CT_PAGE_MATRIX) {
            put_matrix(out, b);
        } else if (b->kind == CT_PAGE_EQUATIONS) {
            put_equations(out, b);
        } else {
            fprintf(out, "<%s>", tag[b->kind]);
            put_escaped(out, b->text, SIZE_MAX);
            fprintf(out, "</%s>\n", tag[b->kind]);
        }
    }
    fputs("</body>\n</html>\n", out);
}
