// Sections `trees` and `loops`: the choice of unknowns, and the closed loops.
#include "formulate/build.h"
#include "html/components.h"
#include "html/html.h"
#include "html/recording.h"
#include "report/derivation.h"
#include "report/packed.h"
#include "report/tree_pairs.h"
#include "sim/summary.h"

#include <math.h>
#include <string.h>

// ---- trees ---------------------------------------------------------------------------------

static void put_branches(struct ct_html *h, const bool *is_branch)
{
    const struct ct_equations *e = &h->sys->equations;
    bool has_any = false;
    fputs("<td class=\"members\">", h->out);
    for (int i = 0; i < e->graph->nedge; i++) {
        if (!is_branch[i] || e->build->topology->edge[i].kind == CT_EDGE_ARM)
            continue;
        fputs(has_any ? ", <span" : "<span", h->out);
        ct_html_put_components(h->out, ct_components_of_edge(h->a, h->sys, i));
        fputc('>', h->out);
        ct_html_put(h->out, e->edge_name[i]);
        fputs("</span>", h->out);
        has_any = true;
    }
    fputs("</td>", h->out);
}

static void put_pair(struct ct_html *h, int number, const struct ct_tree_candidate *c,
                     bool is_chosen)
{
    fprintf(h->out,
            "<tr%s><td class=\"number\">%s%d</td><td class=\"number\">%zu</td><td "
            "class=\"number\">%zu</td><td class=\"number\">%.0f</td>",
            is_chosen ? " class=\"chosen\"" : "", is_chosen ? "chosen: " : "", number, c->nu,
            c->nrow, c->cost);
    put_branches(h, c->trans);
    put_branches(h, c->rot);
    fputs("</tr>\n", h->out);
}

static void put_pairs(struct ct_html *h)
{
    const struct ct_equations *e = &h->sys->equations;
    const struct ct_tree_report *r = &h->sys->tree;
    const int chosen = ct_tree_pairs_chosen(e, r);
    fputs("<p>Chosen: ", h->out);
    ct_html_put(h->out, ct_tree_pairs_reason(h->a, e, r));
    fputs(".</p>\n", h->out);
    if (!r->ncandidate)
        return;
    fputs("<p class=\"note\">The cheapest pairs of trees; arms are branches of both trees. "
          "<code>--tree 2</code> chooses number 2.</p>\n"
          "<div class=\"wide\"><table>\n<thead><tr><th class=\"number\">pair</th><th "
          "class=\"number\">unknowns</th><th class=\"number\">rows</th><th "
          "class=\"number\">operations</th><th>branches of translation</th><th>branches of "
          "rotation</th></tr></thead>\n<tbody>\n",
          h->out);
    for (int i = 0; i < r->ncandidate; i++)
        put_pair(h, i + 1, &r->candidate[i], i == chosen);
    fputs("</tbody></table></div>\n", h->out);
}

void ct_html_trees(struct ct_html *h)
{
    struct ct_derivation d;
    ct_derivation_init(&d, h->a, &h->sys->equations, &h->sys->model, CT_LOOK_HTML);
    ct_stage_tree(&d);
    ct_html_open_section(h, "trees", "Trees");
    put_pairs(h);
    fputs("<details><summary>Branches, chords and what they make unknown</summary>\n", h->out);
    ct_page_print_html_blocks(h->out, &d.page, 3);
    fputs("</details>\n", h->out);
    ct_html_close_section(h);
}

// ---- loops ---------------------------------------------------------------------------------

static const char *edge_components(struct ct_html *h, const char *name)
{
    const struct ct_equations *e = &h->sys->equations;
    for (int i = 0; i < e->graph->nedge; i++)
        if (strcmp(e->edge_name[i], name) == 0)
            return ct_components_of_edge(h->a, h->sys, i);
    return "";
}

// The least of column c of the measurements; *at (out): its row.
static double find_nearest(const struct ct_recording *r, size_t c, size_t *at)
{
    const size_t n = 1 + r->loops.nloop;
    double least = NAN;
    for (size_t i = 0; i < r->nnear; i++)
        if (!(r->near[i * n + c] >= least) && isfinite(r->near[i * n + c])) {
            least = r->near[i * n + c];
            *at = i;
        }
    return least;
}

static void put_nearest(struct ct_html *h, size_t c)
{
    const struct ct_recording *r = h->recording;
    size_t at = 0;
    const double least = find_nearest(r, c, &at);
    fputs("<td class=\"number\">", h->out);
    if (isfinite(least))
        ct_html_put_number(h->out, least);
    else
        fputs("not measured", h->out);
    fputs("</td><td class=\"number\">", h->out);
    if (isfinite(least))
        fprintf(h->out, "%.6g s", r->near_time[at]);
    fputs("</td>", h->out);
}

static void put_loop(struct ct_html *h, const struct ct_loop *l, size_t number)
{
    fputs("<tr", h->out);
    ct_html_put_components(h->out, edge_components(h, l->name));
    fputs("><td>", h->out);
    ct_html_put(h->out, l->name);
    fputs("</td><td class=\"members\">", h->out);
    for (size_t i = 0; i < l->nmember; i++) {
        fputs(i ? ", <span" : "<span", h->out);
        ct_html_put_components(h->out, edge_components(h, l->member[i]));
        fputc('>', h->out);
        ct_html_put(h->out, l->member[i]);
        fputs("</span>", h->out);
    }
    fprintf(h->out, "</td><td class=\"number\">%zu</td><td class=\"number\">%d</td>", l->nrow,
            l->rank);
    put_nearest(h, 1 + number);
    fputs("</tr>\n", h->out);
}

static void put_table(struct ct_html *h)
{
    const struct ct_loops *l = &h->recording->loops;
    fputs("<div class=\"wide\"><table>\n<thead><tr><th>closed by</th><th>circuit</th><th "
          "class=\"number\">rows</th><th class=\"number\">rank</th><th "
          "class=\"number\">nearest to "
          "singular</th><th class=\"number\">at</th></tr></thead>\n<tbody>\n",
          h->out);
    for (size_t i = 0; i < l->nloop; i++)
        put_loop(h, &l->loop[i], i);
    fprintf(h->out,
            "<tr><td>all loops</td><td></td><td class=\"number\">%zu</td><td "
            "class=\"number\">%d</td>",
            h->sys->equations.nrow, l->rank);
    put_nearest(h, 0);
    fputs("</tr>\n</tbody></table></div>\n", h->out);
}

static void put_rows(struct ct_html *h, const char *title, const bool *is)
{
    const struct ct_equations *e = &h->sys->equations;
    bool has_any = false;
    for (size_t i = 0; i < e->nrow; i++) {
        if (!is[i])
            continue;
        fprintf(h->out, has_any ? ", " : "<p>%s: ", title);
        fputs("<span", h->out);
        if (e->row[i].joint >= 0)
            ct_html_put_components(h->out, h->sys->model.joint[e->row[i].joint].name);
        fputc('>', h->out);
        ct_html_put(h->out, e->row[i].name);
        fputs("</span>", h->out);
        has_any = true;
    }
    if (has_any)
        fputs("</p>\n", h->out);
}

static void put_releases(struct ct_html *h)
{
    const struct ct_loops *l = &h->recording->loops;
    if (!l->nrelease)
        return;
    fputs("<h3>What to release</h3>\n<p>Each of these makes one row less redundant; those in "
          "bold together remove all redundancy.</p>\n<ul class=\"releases\">\n",
          h->out);
    for (size_t i = 0; i < l->nrelease; i++) {
        fputs("<li", h->out);
        ct_html_put_components(h->out, h->sys->model.joint[l->release[i].joint].name);
        fputs(l->release[i].is_chosen ? "><b>" : ">", h->out);
        ct_html_put(h->out, ct_release_text(h->a, l, &l->release[i]));
        fputs(l->release[i].is_chosen ? "</b></li>\n" : "</li>\n", h->out);
    }
    fputs("</ul>\n", h->out);
}

// Distance of all rows from a singular configuration over time, as a figure.
static void put_figure(struct ct_html *h)
{
    const struct ct_recording *r = h->recording;
    const size_t n = 1 + r->loops.nloop;
    size_t unused;
    struct ct_html_data d;
    if (r->nnear < 2 || !isfinite(find_nearest(r, 0, &unused)))
        return;
    fputs("<figure data-columns=\"0\">\n<ul class=\"columns\"><li data-column=\"0\" "
          "data-component=\"system\"><span class=\"swatch\"></span>smallest singular value of "
          "all rows <span class=\"unit\">[1]</span> <span class=\"value\"></span></li></ul>\n"
          "<div class=\"chart\"></div></figure>\n",
          h->out);
    double *near = CT_NEWN(h->a, double, r->nnear);
    for (size_t i = 0; i < r->nnear; i++)
        near[i] = r->near[i * n];
    ct_html_open_data(h, &d, "data-loops");
    ct_pack_write(&d.json, h->a, "times", r->near_time, r->nnear, 1);
    ct_pack_write(&d.json, h->a, "samples", near, r->nnear, 1);
    ct_html_close_data(&d);
}

void ct_html_loops(struct ct_html *h)
{
    const struct ct_equations *e = &h->sys->equations;
    const struct ct_loops *l = &h->recording->loops;
    const long redundant = ct_sim_redundant(h->sim);
    ct_html_open_section(h, "loops", "Loops");
    if (!e->nrow) {
        fputs("<p>The joints close no loop: there are no constraint rows.</p>\n", h->out);
        ct_html_close_section(h);
        return;
    }
    fprintf(h->out, "<p>%zu constraint %s, %ld redundant.", e->nrow,
            e->nrow == 1 ? "row" : "rows", redundant);
    fputs(
        " Near 0 the smallest singular value of the rows, scaled to be without a unit, tells a "
        "singular configuration.</p>\n",
        h->out);
    put_table(h);
    put_rows(h, "Redundant rows", l->is_redundant);
    put_rows(h, "Rows whose reactions are undetermined", l->is_open);
    put_releases(h);
    put_figure(h);
    ct_html_close_section(h);
}
