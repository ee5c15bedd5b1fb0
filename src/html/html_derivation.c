// Section `derivation`: the six stages from the terminal equations of the components to the
// reduced equations, folded.
#include "html/html.h"
#include "html/terms.h"

#include <string.h>

// Limit: characters of mathematics of a stage: typeset, and as plain text.
enum { MOST_TYPESET = 40000, MOST_PLAIN = 150000 };

static size_t length_of(const struct ct_page *p)
{
    size_t n = 0;
    for (size_t i = 0; i < p->nblock; i++) {
        const struct ct_page_block *b = &p->block[i];
        for (size_t k = 0; k < b->nequation; k++)
            n += strlen(b->equation[k].left)
               + (b->equation[k].right ? strlen(b->equation[k].right) : 0);
    }
    return n;
}

struct stage {
    const char *id, *title;
    void (*fill)(struct ct_derivation *d); // NULL: the reduced equations
};

static void fill_reduced(struct ct_derivation *d, const struct ct_reduced *r)
{
    ct_page_title(&d->page, "Equations of motion");
    ct_page_sentence(&d->page,
                     "each equation is the cutset of a branch, projected on its motion");
    if (!r->definitions.n)
        ct_derivation_put_matrices(d, r);
}

static void fill(struct ct_html *h, struct ct_derivation *d, const struct stage *s,
                 enum ct_look look)
{
    ct_derivation_init(d, h->a, &h->sys->equations, &h->sys->model, look);
    if (s->fill)
        s->fill(d);
    else
        fill_reduced(d, &h->terms->reduced);
}

static void put_plain(struct ct_html *h, const struct stage *stage)
{
    struct ct_derivation d;
    fill(h, &d, stage, CT_LOOK_TEXT);
    struct ct_text_stream *s = ct_html_open_text(h);
    ct_page_print_text(ct_html_text_stream(s), &d.page);
    fputs("<pre class=\"wide\">", h->out);
    ct_html_put(h->out, ct_html_close_text(s));
    fputs("</pre>\n", h->out);
}

static void put_stage(struct ct_html *h, const struct stage *stage)
{
    struct ct_derivation d;
    fill(h, &d, stage, CT_LOOK_HTML);
    const size_t length = length_of(&d.page);
    fprintf(h->out, "<details id=\"stage-%s\"><summary>%s</summary>\n", stage->id,
            stage->title);
    if (length <= MOST_TYPESET)
        ct_page_print_html_blocks(h->out, &d.page, 3);
    else if (length <= MOST_PLAIN)
        put_plain(h, stage);
    else
        fprintf(h->out,
                "<p>%zu characters, too many for a page: <code>cotree equations</code> prints "
                "them.</p>\n",
                length);
    if (!stage->fill)
        fputs("<p>The equations stand in <a href=\"#equations\">Equations</a>, each term with "
              "its "
              "value.</p>\n",
              h->out);
    fputs("</details>\n", h->out);
}

void ct_html_derivation(struct ct_html *h)
{
    static const struct stage stages[]
        = {{"terminal", "1 Terminal equations", ct_stage_terminal},
           {"incidence", "2 Linear graph", ct_stage_graph},
           {"tree", "3 Trees", ct_stage_tree},
           {"cutset", "4 Cutset equations", ct_stage_cutset},
           {"circuit", "5 Circuit equations", ct_stage_circuit},
           {"reduced", "6 Reduced equations", NULL}};
    ct_html_open_section(h, "derivation", "Derivation");
    fputs("<p>From what each component says on its own to the equations of motion, in six "
          "stages.</p>\n",
          h->out);
    for (size_t i = 0; i < COUNT(stages); i++)
        put_stage(h, &stages[i]);
    ct_html_close_section(h);
}
