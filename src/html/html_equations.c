// Section `equations`: the equations of motion and of the constraints, a row per term with its
// value, the components that each term comes from, and the named expressions that they use.
#include "html/components.h"
#include "html/html.h"
#include "html/terms.h"
#include "report/deflate.h"
#include "report/mathml.h"
#include "report/packed.h"

#include <string.h>

// Limit: of the section; of what a script of the page unpacks, of which browsers read some 20 MB
// a second. Beyond, plain text, then a note.
enum { MOST_BYTES = 600000, MOST_TYPESET = 6000000 };

static const char *origins_of(struct ct_html *h, const struct ct_equation_term *t)
{
    const char *names = "";
    for (size_t i = 0; i < t->norigin; i++)
        names = ct_arena_printf(h->a, "%s%s%s", names, *names ? " " : "",
                                h->terms->provenance.origin[t->origin[i]].name);
    return *names ? names : "system";
}

// ---- equations -----------------------------------------------------------------------------

// An equation: terms first to middle - 1 are its left side, terms middle to last - 1 its right
// side.
struct range {
    size_t first, middle, last;
};

struct writer {
    struct ct_html *h;
    FILE *out;
    struct ct_derivation *plain; // terms are plain text; NULL: they are typeset
    bool is_folded;              // each equation
};

static const char *value_of(const struct writer *w, size_t column)
{
    const struct ct_terms_recording *t = w->h->terms;
    return t->nvalue && t->nrow ? ct_arena_printf(w->h->a, "%.5g", t->value[column]) : NULL;
}

// A side without terms is 0.
static struct ct_mathml_side side_of(const struct writer *w, size_t first, size_t last)
{
    const struct ct_terms_recording *t = w->h->terms;
    struct ct_mathml_term *term = CT_NEWN(w->h->a, struct ct_mathml_term, last - first + 1);
    if (first == last) {
        term[0].latex = "0";
        return (struct ct_mathml_side){term, 1};
    }
    for (size_t i = first; i < last; i++) {
        const struct ct_equation_term *e = &t->provenance.term[i];
        term[i - first] = (struct ct_mathml_term){
            .latex = e->text,
            .plain = w->plain ? ct_derivation_text(w->plain, e->e) : NULL,
            .components = origins_of(w->h, e),
            .value = value_of(w, t->column[i])};
    }
    return (struct ct_mathml_side){term, last - first};
}

// The left side of an output whose first term has the number `first`: its name.
static struct ct_mathml_side output_of(const struct writer *w, size_t first, const char *name)
{
    const struct ct_terms_recording *t = w->h->terms;
    struct ct_mathml_term *term = CT_NEW(w->h->a, struct ct_mathml_term);
    *term = (struct ct_mathml_term){.plain = name,
                                    .components = ct_components_of_result(
                                        w->h->a, w->h->sys, t->provenance.term[first].equation),
                                    .value = value_of(w, t->column[first] - 1)};
    return (struct ct_mathml_side){term, 1};
}

// Writes the equation whose first term has the number `first`; returns the number after its
// last term.
static size_t put_equation(const struct writer *w, size_t first)
{
    struct ct_html *h = w->h;
    const struct ct_provenance *p = &h->terms->provenance;
    const struct ct_equation_term *t = &p->term[first];
    struct range r = {first, first, 0};
    while (r.middle < p->nterm && p->term[r.middle].kind == t->kind
           && p->term[r.middle].equation == t->equation && !p->term[r.middle].is_right)
        r.middle++;
    for (r.last = r.middle; r.last < p->nterm && p->term[r.last].kind == t->kind
                            && p->term[r.last].equation == t->equation;)
        r.last++;
    struct ct_mathml_equation e = {.name = ct_provenance_equation(h->terms->derivation.e, t)};
    const bool has_label = t->kind != CT_EQUATION_OUTPUT, is_folded = w->is_folded && has_label;
    fputs(is_folded ? "<details class=\"labelled\">" : "<div class=\"labelled\">", w->out);
    if (!has_label) {
        e.left = output_of(w, r.first, e.name);
        e.right = side_of(w, r.first, r.last);
    } else {
        e.left = side_of(w, r.first, r.middle);
        e.right = side_of(w, r.middle, r.last);
        fputs(is_folded ? "<summary class=\"label\">" : "<span class=\"label\">", w->out);
        ct_html_put(w->out, e.name);
        fputs(is_folded ? "</summary>\n" : "</span>\n", w->out);
    }
    ct_mathml_equation(w->out, &e);
    fputs(is_folded ? "</details>\n" : "</div>\n", w->out);
    return r.last;
}

static void put_kind(const struct writer *w, enum ct_equation_kind kind, const char *title)
{
    struct ct_html *h = w->h;
    const struct ct_provenance *p = &h->terms->provenance;
    size_t i = 0;
    while (i < p->nterm && p->term[i].kind != kind)
        i++;
    if (i == p->nterm)
        return;
    fprintf(w->out, "<h3>%s</h3>\n<div class=\"equations\">\n", title);
    while (i < p->nterm && p->term[i].kind == kind)
        i = put_equation(w, i);
    fputs("</div>\n", w->out);
}

static void put_definition(const struct writer *w, const struct ct_reduced_definition *e)
{
    struct ct_derivation *d = w->plain ? w->plain : &w->h->terms->derivation;
    const char *name = ct_derivation_text(d, e->symbol),
               *value = ct_derivation_text(d, e->value);
    const struct ct_mathml_term left = {.latex = name}, right = {.latex = value};
    if (!w->plain) {
        ct_mathml_equation(
            w->out, &(struct ct_mathml_equation){.left = {&left, 1}, .right = {&right, 1}});
        return;
    }
    ct_html_put(w->out, name);
    fputs(" = ", w->out);
    ct_html_put(w->out, value);
    fputc('\n', w->out);
}

static void put_definitions(const struct writer *w)
{
    const struct ct_definitions *list = &w->h->terms->reduced.definitions;
    FILE *out = w->out;
    if (!list->n)
        return;
    fprintf(out, "<details><summary>%zu named expressions</summary>\n%s\n", list->n,
            w->plain ? "<pre class=\"wide\">" : "<div class=\"equations\">");
    for (size_t i = 0; i < list->n; i++)
        put_definition(w, &list->at[i]);
    fprintf(out, "%s</details>\n", w->plain ? "</pre>" : "</div>");
}

// ---- all of it -----------------------------------------------------------------------------

static void put_data(struct ct_html *h)
{
    const struct ct_terms_recording *t = h->terms;
    const struct ct_recording *r = h->recording;
    struct ct_html_data d;
    double *time = CT_NEWN(h->a, double, t->nrow + 1);
    for (size_t i = 0, n = 0; i < r->nrow && n < t->nrow; i++)
        if (i % t->stride == 0 || i + 1 == r->nrow)
            time[n++] = r->time[i];
    ct_html_open_data(h, &d, "data-terms");
    ct_pack_write(&d.json, h->a, "times", time, t->nrow, 1);
    ct_pack_write(&d.json, h->a, "samples", t->value, t->nrow, t->nvalue);
    ct_html_close_data(&d);
}

static void put_note(struct ct_html *h)
{
    const struct ct_terms_recording *t = h->terms;
    fputs("<p class=\"note\">The number next to a term is its value at <span "
          "class=\"clock\">t = 0 s</span>.",
          h->out);
    if (t->stride > 1)
        fprintf(h->out, " Values are kept at one of %zu samples and interpolated between.",
                t->stride * h->recording->stride);
    if (!t->nvalue && t->provenance.nterm)
        fputs(" There are too many terms to carry their values.", h->out);
    fputs("</p>\n", h->out);
}

static const char *write_all(struct ct_html *h, struct ct_derivation *plain, bool is_folded)
{
    struct ct_text_stream *s = ct_html_open_text(h);
    const struct writer w = {h, ct_html_text_stream(s), plain, is_folded};
    put_definitions(&w);
    put_kind(&w, CT_EQUATION_MOTION, "Equations of motion");
    put_kind(&w, CT_EQUATION_POSITION, "Constraints");
    put_kind(&w, CT_EQUATION_ACCELERATION, "Constraints, differentiated twice");
    put_kind(&w, CT_EQUATION_EFFORT, "Efforts of the drivers");
    put_kind(&w, CT_EQUATION_OUTPUT, "Outputs that are reactions or accelerations");
    return ct_html_close_text(s);
}

// The text of `cotree equations`, in a folded block.
static void put_text(struct ct_html *h, struct ct_derivation *plain)
{
    struct ct_text_stream *s = ct_html_open_text(h);
    ct_stage_reduced(plain);
    ct_page_print_text(ct_html_text_stream(s), &plain->page);
    const char *text = ct_html_close_text(s);
    if (strlen(text) > MOST_BYTES) {
        fprintf(
            h->out,
            "<p>They have %zu characters, too many for a page: <code>cotree equations</code> "
            "prints them.</p>\n",
            strlen(text));
        return;
    }
    fprintf(h->out,
            "<details><summary>%zu characters, as plain text</summary>\n<pre class=\"wide\">",
            strlen(text));
    ct_html_put(h->out, text);
    fputs("</pre></details>\n", h->out);
}

// Plain text for readers without scripts; a script replaces it by the same typeset, equation by
// equation (web/equations.js). False: too long for that.
static bool put_packed(struct ct_html *h, struct ct_derivation *plain)
{
    const char *text = write_all(h, NULL, true);
    struct ct_html_data d;
    size_t n;
    if (strlen(text) > MOST_TYPESET)
        return false;
    const unsigned char *deflated
        = ct_deflate(h->a, (const unsigned char *)text, strlen(text), &n);
    put_note(h);
    fputs("<div id=\"equations-text\">\n", h->out);
    put_text(h, plain);
    fputs("</div>\n", h->out);
    ct_html_open_data(h, &d, "data-equations");
    ct_json_text(&d.json, "data", ct_base64(h->a, deflated, n));
    ct_html_close_data(&d);
    return true;
}

void ct_html_equations(struct ct_html *h)
{
    const struct ct_equations *e = &h->sys->equations;
    const struct ct_terms_recording *t = h->terms;
    struct ct_derivation plain;
    bool has_terms = true;
    ct_html_open_section(h, "equations", "Equations");
    fprintf(h->out, "<p>%zu unknown %s, %zu %s.</p>\n", e->nu, e->nu == 1 ? "speed" : "speeds",
            e->nrow, e->nrow == 1 ? "constraint" : "constraints");
    ct_derivation_init(&plain, h->a, t->derivation.e, &h->sys->model, CT_LOOK_TEXT);
    const char *text = write_all(h, NULL, false);
    if (strlen(text) > MOST_BYTES)
        text = write_all(h, &plain, false);
    if (strlen(text) <= MOST_BYTES) {
        put_note(h);
        fputs(text, h->out);
    } else if (!put_packed(h, &plain)) {
        put_text(h, &plain);
        has_terms = false;
    }
    if (has_terms && t->nvalue && t->nrow)
        put_data(h);
    ct_html_close_section(h);
}
