// Section `equations`: the equations of motion and of the constraints, a row per term with its value, the components that each
// term comes from, and the named expressions that they use.
#include "html/html.h"
#include "html/terms.h"
#include "report/mathml.h"
#include "report/packed.h"

#include <string.h>

// Characters of mathematics that a page can hold, typeset: a browser lays them out in less than a second.
enum { MOST_TEXT = 60000 };

static const char *origins_of(struct ct_html *h, const struct ct_equation_term *t)
{
    const char *names = "";
    for (size_t i = 0; i < t->norigin; i++)
        names = ct_arena_printf(h->a, "%s%s%s", names, *names ? " " : "",
                                h->terms->provenance.origin[t->origin[i]].name);
    return *names ? names : "system";
}

// ---- equations ----------------------------------------------------------------------------------

// Terms first .. last - 1; a side without terms is zero.
static struct ct_mathml_side side_of(struct ct_html *h, size_t first, size_t last)
{
    const struct ct_terms_recording *t = h->terms;
    struct ct_mathml_term *term = CT_NEWN(h->a, struct ct_mathml_term, last - first + 1);
    if (first == last) {
        term[0].latex = "0";
        return (struct ct_mathml_side){term, 1};
    }
    for (size_t i = first; i < last; i++)
        term[i - first] = (struct ct_mathml_term){
            .latex = t->provenance.term[i].text,
            .components = origins_of(h, &t->provenance.term[i]),
            .value = t->nvalue && t->nrow ? ct_arena_printf(h->a, "%.5g", t->value[i]) : NULL};
    return (struct ct_mathml_side){term, last - first};
}

// The equation whose terms begin with number `first`; returns the number behind them.
static size_t put_equation(struct ct_html *h, size_t first)
{
    const struct ct_provenance *p = &h->terms->provenance;
    const struct ct_equation_term *t = &p->term[first];
    size_t middle = first, last;
    while (middle < p->nterm && p->term[middle].kind == t->kind
           && p->term[middle].equation == t->equation && !p->term[middle].is_right)
        middle++;
    for (last = middle; last < p->nterm && p->term[last].kind == t->kind
                        && p->term[last].equation == t->equation;)
        last++;
    const char *name = ct_provenance_equation(h->terms->derivation.e, t);
    const struct ct_mathml_equation e
        = {.name = name, .left = side_of(h, first, middle), .right = side_of(h, middle, last)};
    fputs("<div class=\"labelled\"><span class=\"label\">", h->out);
    ct_html_put(h->out, name);
    fputs("</span>\n", h->out);
    ct_mathml_equation(h->out, &e);
    fputs("</div>\n", h->out);
    return last;
}

static void put_kind(struct ct_html *h, enum ct_equation_kind kind, const char *title)
{
    const struct ct_provenance *p = &h->terms->provenance;
    size_t i = 0;
    while (i < p->nterm && p->term[i].kind != kind)
        i++;
    if (i == p->nterm)
        return;
    fprintf(h->out, "<h3>%s</h3>\n<div class=\"equations\">\n", title);
    while (i < p->nterm && p->term[i].kind == kind)
        i = put_equation(h, i);
    fputs("</div>\n", h->out);
}

static void put_definitions(struct ct_html *h)
{
    struct ct_derivation *d = &h->terms->derivation;
    const struct ct_definitions *list = &h->terms->reduced.definitions;
    if (!list->n)
        return;
    fprintf(h->out,
            "<details><summary>%zu named expressions</summary>\n<div class=\"equations\">\n",
            list->n);
    for (size_t i = 0; i < list->n; i++) {
        const struct ct_mathml_term left = {.latex = ct_derivation_text(d, list->at[i].symbol)},
                                    right = {.latex = ct_derivation_text(d, list->at[i].value)};
        ct_mathml_equation(
            h->out, &(struct ct_mathml_equation){.left = {&left, 1}, .right = {&right, 1}});
    }
    fputs("</div></details>\n", h->out);
}

// ---- all of it ----------------------------------------------------------------------------------

static size_t length_of_all(const struct ct_html *h)
{
    const struct ct_terms_recording *t = h->terms;
    size_t n = 0;
    for (size_t i = 0; i < t->provenance.nterm; i++)
        n += strlen(t->provenance.term[i].text);
    for (size_t i = 0; i < t->reduced.definitions.n; i++)
        n += strlen(
            ct_derivation_text(&h->terms->derivation, t->reduced.definitions.at[i].value));
    return n;
}

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

static void put_all(struct ct_html *h)
{
    const struct ct_terms_recording *t = h->terms;
    fputs("<p class=\"note\">Each term has the value that it takes at the time of the page "
          "beside it.",
          h->out);
    if (t->stride > 1)
        fprintf(h->out, " Values between every %zuth row of the outputs are interpolated.",
                t->stride);
    if (!t->nvalue && t->provenance.nterm)
        fputs(" There are too many terms to carry their values.", h->out);
    fputs("</p>\n", h->out);
    put_definitions(h);
    put_kind(h, CT_EQUATION_MOTION, "Equations of motion");
    put_kind(h, CT_EQUATION_POSITION, "Constraints");
    put_kind(h, CT_EQUATION_ACCELERATION, "Constraints, differentiated twice");
    put_kind(h, CT_EQUATION_EFFORT, "Efforts of the drivers");
    if (t->nvalue && t->nrow)
        put_data(h);
}

void ct_html_equations(struct ct_html *h)
{
    const struct ct_equations *e = &h->sys->equations;
    const size_t length = length_of_all(h);
    ct_html_open_section(h, "equations", "Equations");
    fprintf(h->out, "<p>%zu unknown %s, %zu %s.</p>\n", e->nu, e->nu == 1 ? "speed" : "speeds",
            e->nrow, e->nrow == 1 ? "constraint" : "constraints");
    if (length <= MOST_TEXT)
        put_all(h);
    else
        fprintf(h->out,
                "<p>They have %zu characters, too many for a page: "
                "<code>cotree equations</code> prints them.</p>\n",
                length);
    ct_html_close_section(h);
}
