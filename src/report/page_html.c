// Pages as one HTML document without scripts; see page.h.
#include "report/page.h"

#include "report/mathml.h"

#include <ctype.h>
#include <stdint.h>
#include <string.h>

// Style sheet: readable in print, in dark mode and at 390 px; only tables and matrices scroll,
// each by itself.
const char ct_page_style[]
    // wide elements scroll, with a shadow at the end if there is more
    = ".table, .matrix, div.wide, pre.wide { overflow-x: auto; "
      "background: linear-gradient(to right, var(--paper, Canvas) 40%, transparent) 0 0 / 3em "
      "100% "
      "local, linear-gradient(to left, var(--paper, Canvas) 40%, transparent) 100% 0 / 3em "
      "100% "
      "local, linear-gradient(to right, #8886, transparent) 0 0 / 1em 100%, "
      "linear-gradient(to left, #8886, transparent) 100% 0 / 1em 100%; "
      "background-repeat: no-repeat }\n"
      "table { border-collapse: collapse }\n"
      "td, th { padding: 0 1em 0 0; text-align: left; vertical-align: top }\n"
      "th, td { white-space: nowrap }\n"
      "th { font-weight: normal; opacity: .75 }\n"
      "td.words { white-space: normal; min-width: 12em }\n"
      "th.number, td.number { text-align: right }\n"
      ".equations { margin: .5em 0 1em 0 }\n"
      ".label, .note { opacity: .75 }\n"
      ".equations > * { margin-top: .3em }\n"
      ".labelled { margin-bottom: .6em }\n"
      ".labelled > math.equation { margin-left: 1.2em }\n"
      "mtext.note { margin-left: .3em }\n"
      "summary { cursor: pointer }\n"
      "@media (max-width: 40rem) { th, td { font-size: .875em; padding-right: .7em } "
      "th { white-space: normal } td.words { min-width: 8em } }\n"
      "@media print { details::details-content { content-visibility: visible; block-size: auto "
      "} }\n";

static void put_text(FILE *out, const char *s)
{
    ct_html_text(out, s, SIZE_MAX);
}

// ---- equations -----------------------------------------------------------------------------

static struct ct_mathml_side split_terms(struct ct_arena *a, const char *s,
                                         const char *const *components)
{
    struct ct_mathml_term *term = NULL;
    size_t n = 0, cap = 0;
    for (; s && *s; n++) {
        const size_t length = ct_page_first_term(s);
        const struct ct_mathml_term t = {.latex = ct_arena_strndup(a, s, length),
                                         .components = components ? components[n] : NULL};
        size_t count = n;
        CT_PUSH(a, term, count, cap, t);
        s += length;
    }
    return (struct ct_mathml_side){term, n};
}

// The words of a note are items of the last side, so that they wrap with its terms.
static struct ct_mathml_side add_note(struct ct_arena *a, struct ct_mathml_side side,
                                      const char *note)
{
    if (!note || !side.n)
        return side;
    struct ct_mathml_term *term = CT_NEWN(a, struct ct_mathml_term, side.n);
    memcpy(term, side.term, side.n * sizeof *term);
    term[side.n - 1].note = ct_arena_printf(a, "(%s)", note);
    return (struct ct_mathml_side){term, side.n};
}

static void put_equation(FILE *out, struct ct_arena *a, const struct ct_page_equation *e)
{
    struct ct_mathml_equation m = {.name = e->name,
                                   .left = split_terms(a, e->left, e->left_components),
                                   .right = split_terms(a, e->right, e->right_components)};
    struct ct_mathml_side *last = m.right.n ? &m.right : &m.left;
    *last = add_note(a, *last, e->note);
    if (e->label) {
        fputs("<div class=\"labelled\"><span class=\"label\">", out);
        put_text(out, e->label);
        fputs("</span>\n", out);
    }
    ct_mathml_equation(out, &m);
    fputs(e->label ? "</div>\n" : "", out);
}

// Equal signs are aligned if left sides leave enough width for the right sides, a third of a
// phone's line.
static bool is_aligned(const struct ct_page_block *b)
{
    for (size_t i = 0; i < b->nequation; i++) {
        const struct ct_page_equation *e = &b->equation[i];
        if (e->label || !e->right
            || ct_latex_width(e->left, strlen(e->left)) > CT_PAGE_PHONE / 3)
            return false;
    }
    return true;
}

static void put_equations(FILE *out, struct ct_arena *a, const struct ct_page_block *b)
{
    fputs(is_aligned(b) ? "<div class=\"equations aligned\">\n" : "<div class=\"equations\">\n",
          out);
    for (size_t i = 0; i < b->nequation; i++)
        put_equation(out, a, &b->equation[i]);
    fputs("</div>\n", out);
}

// ---- tables and matrices -------------------------------------------------------------------

// Columns with more than names or numbers wrap.
static bool *find_words(struct ct_arena *a, const struct ct_page_block *b, size_t n)
{
    // Layout: a longer text wraps
    enum { LONGEST_NAME = 24 };
    bool *has_words = CT_NEWN(a, bool, n + 1);
    for (size_t i = n; i < b->ncell; i++)
        has_words[i % n] |= b->align[i % n] == 'l' && ct_text_width(b->cell[i]) > LONGEST_NAME;
    return has_words;
}

static void put_table(FILE *out, struct ct_arena *a, const struct ct_page_block *b)
{
    const size_t n = strlen(b->align);
    const bool *has_words = find_words(a, b, n);
    fputs("<div class=\"table\"><table>\n", out);
    for (size_t i = 0; i < b->ncell; i++) {
        const char letter = b->align[i % n];
        const char *tag = i < n ? "th" : "td";
        fputs(i % n ? "" : "<tr>", out);
        fprintf(out, "<%s%s>", tag,
                tolower((unsigned char)letter) == 'r' ? " class=\"number\""
                : i >= n && has_words[i % n]          ? " class=\"words\""
                                                      : "");
        if (isupper((unsigned char)letter) && i >= n && *b->cell[i])
            ct_mathml_inline(out, b->cell[i]);
        else
            put_text(out, b->cell[i]);
        fprintf(out, "</%s>%s", tag, (i + 1) % n ? "" : "</tr>\n");
    }
    fputs("</table></div>\n", out);
}

// ---- blocks --------------------------------------------------------------------------------

static void put_heading(FILE *out, const struct ct_page_block *b, int level)
{
    fprintf(out, "<h%d>", level);
    put_text(out, b->text);
    fprintf(out, "</h%d>", level);
}

void ct_page_print_html_blocks(FILE *out, const struct ct_page *p, int level)
{
    bool is_folded = false;
    for (size_t i = 0; i < p->nblock; i++) {
        const struct ct_page_block *b = &p->block[i];
        const bool ends_fold = is_folded;
        is_folded = b->kind == CT_PAGE_HEADING && b->is_folded;
        switch (b->kind) {
        case CT_PAGE_TITLE:
        case CT_PAGE_HEADING:
            fputs(is_folded ? "<details><summary>" : "", out);
            put_heading(out, b, level + (b->kind == CT_PAGE_HEADING));
            fputs(is_folded ? "</summary>\n" : "\n", out);
            break;
        case CT_PAGE_SENTENCE:
            fputs("<p>", out);
            put_text(out, b->text);
            fputs("</p>\n", out);
            break;
        case CT_PAGE_TABLE:
            put_table(out, p->arena, b);
            break;
        case CT_PAGE_EQUATIONS:
            put_equations(out, p->arena, b);
            break;
        case CT_PAGE_MATRIX:
            ct_mathml_matrix(out, b->cell, b->ncell / b->ncolumn, b->ncolumn, true);
            break;
        }
        fputs(ends_fold ? "</details>\n" : "", out);
    }
}

void ct_page_print_html(FILE *out, const struct ct_page *p, const char *title)
{
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>",
          out);
    put_text(out, title);
    fputs("</title>\n<style>\n"
          ":root { color-scheme: light dark }\n"
          "body { font: 16px/1.5 serif; max-width: 70em; margin: 2em auto; padding: 0 1em; "
          "overflow-wrap: break-word }\n"
          "h1 { font-size: 1.4em; border-bottom: 1px solid }\n"
          "h2 { font-size: 1.1em }\nsummary h2 { display: inline }\n",
          out);
    fputs(ct_page_style, out);
    fputs(ct_mathml_style, out);
    fputs("</style>\n</head>\n<body>\n", out);
    ct_page_print_html_blocks(out, p, 1);
    fputs("</body>\n</html>\n", out);
}
