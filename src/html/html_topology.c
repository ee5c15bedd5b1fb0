// Sections `trees` and `loops`: how unknowns were chosen, and what closed loops make of them.
#include "html/html.h"
#include "report/derivation.h"
#include "sim/summary.h"

void ct_html_trees(struct ct_html *h)
{
    struct ct_derivation d;
    ct_derivation_init(&d, h->a, &h->sys->equations, &h->sys->model, CT_LOOK_HTML);
    ct_stage_tree(&d);
    ct_html_open_section(h, "trees", "Trees");
    ct_page_print_html_blocks(h->out, &d.page, 3);
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
