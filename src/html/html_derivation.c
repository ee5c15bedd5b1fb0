// Section `derivation`: the six stages from the terminal equations of the components to the reduced equations, folded.
#include "html/html.h"
#include "html/terms.h"

#include <string.h>

enum { MOST_TEXT = 60000 }; // characters of mathematics of a stage that are typeset

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

static void put_stage(struct ct_html *h, const char *id, const char *title,
                      const struct ct_page *p)
{
    const size_t length = length_of(p);
    fprintf(h->out, "<details id=\"stage-%s\"><summary>%s</summary>\n", id, title);
    if (length <= MOST_TEXT)
        ct_page_print_html_blocks(h->out, p, 3);
    else
        fprintf(h->out,
                "<p>%zu characters, too many for a page: <code>cotree equations</code> prints "
                "them.</p>\n",
                length);
    if (strcmp(id, "reduced") == 0)
        fputs("<p>The equations stand in <a href=\"#equations\">Equations</a>, each term with "
              "its "
              "value.</p>\n",
              h->out);
    fputs("</details>\n", h->out);
}

static void fill_reduced(struct ct_derivation *d, const struct ct_reduced *r)
{
    ct_page_title(&d->page, "Equations of motion");
    ct_page_sentence(&d->page,
                     "each equation is the cutset of a branch, projected on its motion");
    if (!r->definitions.n)
        ct_derivation_put_matrices(d, r);
}

void ct_html_derivation(struct ct_html *h)
{
    static const struct {
        const char *id, *title;
        void (*fill)(struct ct_derivation *d); // NULL: the reduced equations
    } stages[] = {{"terminal", "1 Terminal equations", ct_stage_terminal},
                  {"incidence", "2 Linear graph", ct_stage_graph},
                  {"tree", "3 Trees", ct_stage_tree},
                  {"cutset", "4 Cutset equations", ct_stage_cutset},
                  {"circuit", "5 Circuit equations", ct_stage_circuit},
                  {"reduced", "6 Reduced equations", NULL}};
    ct_html_open_section(h, "derivation", "Derivation");
    fputs("<p>From what each component says on its own to the equations of motion, in six "
          "stages.</p>\n",
          h->out);
    for (size_t i = 0; i < COUNT(stages); i++) {
        struct ct_derivation d;
        ct_derivation_init(&d, h->a, &h->sys->equations, &h->sys->model, CT_LOOK_HTML);
        if (stages[i].fill)
            stages[i].fill(&d);
        else
            fill_reduced(&d, &h->terms->reduced);
        put_stage(h, stages[i].id, stages[i].title, &d.page);
    }
    ct_html_close_section(h);
}
