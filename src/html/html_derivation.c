// Sections `trees`, `derivation`, `equations` and `loops`: the stages of the derivation and what they give.
#include "html/html.h"
#include "report/derivation.h"
#include "sim/summary.h"
#include "solve/singular/singular.h"

typedef void stage_fill(struct ct_derivation *d);

static void put_stage(struct ct_html *h, stage_fill *fill)
{
    struct ct_derivation d;
    ct_derivation_init(&d, h->a, &h->sys->equations, &h->sys->model, CT_LOOK_TEXT);
    fill(&d);
    struct ct_text_stream *s = ct_html_open_text(h);
    ct_page_print_text(ct_html_text_stream(s), &d.page);
    fputs("<pre class=\"wide\">", h->out);
    ct_html_put(h->out, ct_html_close_text(s));
    fputs("</pre>\n", h->out);
}

void ct_html_trees(struct ct_html *h)
{
    ct_html_open_section(h, "trees", "Trees");
    put_stage(h, ct_stage_tree);
    ct_html_close_section(h);
}

void ct_html_derivation(struct ct_html *h)
{
    static const struct {
        const char *name, *title;
        stage_fill *fill;
    } stages[] = {{"terminal", "1 Terminal equations", ct_stage_terminal},
                  {"incidence", "2 Linear graph", ct_stage_graph},
                  {"tree", "3 Trees", ct_stage_tree},
                  {"cutset", "4 Cutset equations", ct_stage_cutset},
                  {"circuit", "5 Circuit equations", ct_stage_circuit},
                  {"reduced", "6 Reduced equations", ct_stage_reduced}};
    ct_html_open_section(h, "derivation", "Derivation");
    fputs("<p>From what each component says on its own to the equations of motion, in six "
          "stages.</p>\n",
          h->out);
    for (size_t i = 0; i < COUNT(stages); i++) {
        fprintf(h->out, "<details id=\"stage-%s\"><summary>%s</summary>\n", stages[i].name,
                stages[i].title);
        put_stage(h, stages[i].fill);
        fputs("</details>\n", h->out);
    }
    ct_html_close_section(h);
}

void ct_html_equations(struct ct_html *h)
{
    ct_html_open_section(h, "equations", "Equations of motion");
    put_stage(h, ct_stage_reduced);
    ct_html_close_section(h);
}

void ct_html_loops(struct ct_html *h)
{
    const struct ct_equations *e = &h->sys->equations;
    ct_html_open_section(h, "loops", "Loops");
    if (!e->nrow)
        fputs("<p>The joints close no loop: there are no constraint rows.</p>\n", h->out);
    else
        fprintf(h->out, "<p>%zu constraint rows, %ld of them redundant.</p>\n", e->nrow,
                ct_sim_redundant(h->sim));
    ct_html_close_section(h);
}
