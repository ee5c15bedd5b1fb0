// Section `graph`: the linear graph as a picture, a list of its edges, and the cutset or
// circuit equation of each edge in each tree.
#include "html/components.h"
#include "html/html.h"
#include "formulate/build.h"
#include "html/layout.h"
#include "report/derivation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double FEW = 16; // Layout: vertices: so many have room
// Layout: of the picture and the equations below it
enum {
    MOST_DRAWN = 400, // vertices: beyond, no picture can be read
    MOST_NAMED = 30, // edges: beyond, they have their numbers only, and names when they are lit
    MOST_TYPESET
    = 2000, // entries of the cutset and circuit matrices: beyond, equations are plain text
    LENGTH = 130, // [px] of an edge; arms are shorter
    ARM = 80,
    MARGIN = 60,
    RADIUS = 7,  // [px] of a vertex
    ARROW = 7,   // [px] from the middle of an arrow to its tip, and a gap
    SPREAD = 44, // [px] between the middles of edges that join the same vertices
    WIDE = 1500  // [px] beyond, names are too small on a page (1048 px): the picture scrolls
};

struct picture {
    struct ct_html *h;
    const struct ct_equations *e;
    struct ct_place *at;
    double left, top, width, height;
};

// ---- the picture ---------------------------------------------------------------------------

static void fit(struct picture *p)
{
    double right = -INFINITY, bottom = -INFINITY;
    p->left = p->top = INFINITY;
    for (int v = 0; v < p->e->graph->nnode; v++) {
        p->left = fmin(p->left, p->at[v].x);
        p->top = fmin(p->top, p->at[v].y);
        right = fmax(right, p->at[v].x);
        bottom = fmax(bottom, p->at[v].y);
    }
    p->left -= 2.0 * MARGIN; // names are next to the vertices
    p->top -= MARGIN;
    p->width = right - p->left + 2.0 * MARGIN;
    p->height = bottom - p->top + MARGIN;
}

static bool joins_same(const struct ct_edge *a, const struct ct_edge *b)
{
    return (a->tail == b->tail && a->head == b->head)
        || (a->tail == b->head && a->head == b->tail);
}

// Distance of the middle of an edge from the straight line, to its left in the direction from
// the smaller vertex number to the larger [px].
static double offset_of(const struct ct_graph *g, int edge)
{
    int before = 0, all = 0;
    for (int i = 0; i < g->nedge; i++)
        if (joins_same(&g->edge[i], &g->edge[edge])) {
            before += i < edge;
            all++;
        }
    const double offset = SPREAD * (before - (all - 1) / 2.0);
    return g->edge[edge].tail < g->edge[edge].head ? offset : -offset;
}

// A point of a quadratic curve.
static struct ct_place curve(struct ct_place a, struct ct_place c, struct ct_place b, double t)
{
    const double s = 1 - t;
    return (struct ct_place){s * s * a.x + 2 * s * t * c.x + t * t * b.x,
                             s * s * a.y + 2 * s * t * c.y + t * t * b.y};
}

static void put_edge_classes(struct picture *p, int i)
{
    const struct ct_equations *e = p->e;
    fprintf(p->h->out, "edge %s %s%s", e->T->is_branch[i] ? "branch-t" : "chord-t",
            e->R->is_branch[i] ? "branch-r" : "chord-r",
            e->build->topology->edge[i].kind == CT_EDGE_ARM ? " arm" : "");
}

static void put_description(struct picture *p, int i)
{
    const struct ct_equations *e = p->e;
    FILE *out = p->h->out;
    fprintf(out, "edge %d, ", i + 1);
    ct_html_put(out, e->edge_name[i]);
    fprintf(out, ", %s, from ", e->edge_kind[i]);
    ct_html_put(out, e->node_name[e->graph->edge[i].tail]);
    fputs(" to ", out);
    ct_html_put(out, e->node_name[e->graph->edge[i].head]);
    fprintf(out, "; %s of translation, %s of rotation", e->T->is_branch[i] ? "branch" : "chord",
            e->R->is_branch[i] ? "branch" : "chord");
}

static void put_edge(struct picture *p, int i)
{
    const struct ct_equations *e = p->e;
    const struct ct_edge w = e->graph->edge[i];
    FILE *out = p->h->out;
    const struct ct_place a = p->at[w.tail], b = p->at[w.head];
    // Layout: [px], against division by zero
    const double length = fmax(hypot(b.x - a.x, b.y - a.y), 1e-3);
    const double nx = -(b.y - a.y) / length, ny = (b.x - a.x) / length;
    const double off = offset_of(e->graph, i);
    const struct ct_place c = {(a.x + b.x) / 2 + 2 * off * nx, (a.y + b.y) / 2 + 2 * off * ny};
    // the arrow touches the vertex at its head, off the name in the middle
    const double at_head = fmax(1 - (RADIUS + ARROW) / length, 0.6);
    const struct ct_place middle = curve(a, c, b, 0.5), tip = curve(a, c, b, at_head),
                          before = curve(a, c, b, at_head - 0.02);
    const double turn = hypot(tip.x - before.x, tip.y - before.y);
    const double tx = (tip.x - before.x) / turn, ty = (tip.y - before.y) / turn;
    fputs("<g class=\"", out);
    put_edge_classes(p, i);
    fputs("\" data-edge=\"", out);
    ct_html_put(out, e->edge_name[i]);
    fputc('"', out);
    ct_html_put_components(out, ct_components_of_edge(p->h->a, p->h->sys, i));
    fputs(" tabindex=\"0\" role=\"button\" aria-label=\"", out);
    put_description(p, i);
    fputs("\"><title>", out);
    put_description(p, i);
    fprintf(out, "</title><path class=\"hit\" d=\"M%.1f %.1fQ%.1f %.1f %.1f %.1f\"/>", a.x, a.y,
            c.x, c.y, b.x, b.y);
    fprintf(out, "<path class=\"line\" d=\"M%.1f %.1fQ%.1f %.1f %.1f %.1f\"/>", a.x, a.y, c.x,
            c.y, b.x, b.y);
    fprintf(out, "<path class=\"arrow\" d=\"M%.1f %.1fL%.1f %.1fL%.1f %.1fZ\"/>",
            tip.x + 6 * tx, tip.y + 6 * ty, tip.x - 5 * tx - 5 * ty, tip.y - 5 * ty + 5 * tx,
            tip.x - 5 * tx + 5 * ty, tip.y - 5 * ty - 5 * tx);
    const bool is_arm = e->build->topology->edge[i].kind == CT_EDGE_ARM;
    fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%d", middle.x,
            middle.y + 4, i + 1);
    if (!is_arm) {
        fputs(e->graph->nedge <= MOST_NAMED ? "<tspan> " : "<tspan class=\"long\"> ", out);
        ct_html_put(out, e->edge_name[i]);
        fputs("</tspan>", out);
    }
    fputs("</text></g>\n", out);
}

// Writes a vertex. Its name stands on the side away from its neighbours, where there are no
// edges.
static void put_node(struct picture *p, int v)
{
    const struct ct_graph *g = p->e->graph;
    FILE *out = p->h->out;
    double dx = 0, dy = 0;
    for (int i = 0; i < g->nedge; i++) {
        const struct ct_edge w = g->edge[i];
        if (w.tail != v && w.head != v)
            continue;
        const struct ct_place other = p->at[w.tail == v ? w.head : w.tail];
        // Layout: [px], against division by zero
        const double r = fmax(hypot(other.x - p->at[v].x, other.y - p->at[v].y), 1e-3);
        dx -= (other.x - p->at[v].x) / r;
        dy -= (other.y - p->at[v].y) / r;
    }
    const double r = hypot(dx, dy);
    dx = r > 0.2 ? dx / r : 0;
    dy = r > 0.2 ? dy / r : -1;
    const char *anchor = dx > 0.4 ? "start" : dx < -0.4 ? "end" : "middle";
    fprintf(out, "<g class=\"node%s\"", v ? "" : " ground");
    ct_html_put_components(out, ct_components_of_node(p->h->a, p->h->sys, v));
    fprintf(out, "><circle cx=\"%.1f\" cy=\"%.1f\" r=\"%d\"/>", p->at[v].x, p->at[v].y, RADIUS);
    fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", p->at[v].x + 13 * dx,
            p->at[v].y + 14 * dy + 4, anchor);
    ct_html_put(out, p->e->node_name[v]);
    fputs("</text></g>\n", out);
}

static void put_picture(struct ct_html *h)
{
    const struct ct_equations *e = &h->sys->equations;
    const struct ct_graph *g = e->graph;
    struct picture p = {.h = h, .e = e, .at = CT_NEWN(h->a, struct ct_place, g->nnode + 1)};
    double *length = CT_NEWN(h->a, double, g->nedge + 1);
    // names need room: the area grows with their number
    const double scale = fmin(fmax(sqrt(g->nnode / FEW), 1), 2);
    for (int i = 0; i < g->nedge; i++)
        length[i] = scale * (e->build->topology->edge[i].kind == CT_EDGE_ARM ? ARM : LENGTH);
    ct_layout_find(h->a, g, length, p.at);
    fit(&p);
    fprintf(h->out,
            "<div class=\"picture\"><svg xmlns=\"http://www.w3.org/2000/svg\" role=\"group\" "
            "aria-label=\"linear graph\" data-tree=\"both\" class=\"%s\" width=\"%.0f\" "
            "height=\"%.0f\" viewBox=\"%.1f %.1f %.1f %.1f\">\n",
            p.width > WIDE ? "large" : "small", p.width, p.height, p.left, p.top, p.width,
            p.height);
    for (int i = 0; i < g->nedge; i++)
        put_edge(&p, i);
    for (int v = 0; v < g->nnode; v++)
        put_node(&p, v);
    fputs("</svg></div>\n", h->out);
}

// ---- equations -----------------------------------------------------------------------------

static void put_sides(FILE *out, const struct ct_derivation *d, const char *left,
                      const char *right)
{
    if (d->page.look == CT_LOOK_HTML) {
        ct_html_put_equation(out, left, right);
        return;
    }
    fputs("<math><mtext>", out);
    ct_html_put(out, left);
    fputs(" = ", out);
    ct_html_put(out, right);
    fputs("</mtext></math>", out);
}

static void put_equation(struct ct_html *h, struct ct_derivation *d, const struct ct_tree *t,
                         const struct ct_incidence *cutsets, int edge, int row,
                         bool of_rotation)
{
    const bool is_branch = t->is_branch[edge];
    const char *name = h->sys->equations.edge_name[edge];
    FILE *out = h->out;
    fputs("<div class=\"equation\" data-edge=\"", out);
    ct_html_put(out, name);
    fprintf(out, "\" data-tree=\"%s\"><span class=\"label\">%s %d, %s: </span> ",
            of_rotation ? "rotation" : "translation",
            is_branch ? "cutset of branch" : "circuit of chord", edge + 1,
            is_branch     ? of_rotation ? "torques" : "forces"
            : of_rotation ? "rotations"
                          : "displacements");
    if (of_rotation && !h->sys->equations.build->topology->edge[edge].has_rotation)
        fputs("none of its own: it does not turn", out); // a particle, a force
    else if (is_branch)
        put_sides(out, d, ct_derivation_cutset(d, cutsets, row, edge, of_rotation ? "T" : "F"),
                  "0");
    else
        put_sides(out, d, ct_derivation_of(d, of_rotation ? "S" : "d", name),
                  ct_derivation_circuit(d, t, edge, of_rotation));
    fputs("</div>\n", out);
}

static void put_equations(struct ct_html *h)
{
    struct ct_equations *e = &h->sys->equations;
    const struct ct_tree *const tree[] = {e->T, e->R};
    struct ct_incidence cutsets[2];
    int row[2] = {0, 0};
    struct ct_derivation d;
    // circuits have as many entries without their chords as cutsets without their branches
    int nentry = 0;
    for (int k = 0; k < 2; k++) {
        struct ct_incidence Af;
        ct_cutsets_derive(h->a, e->graph, tree[k], &Af);
        ct_incidence_transpose(h->a, &Af, &cutsets[k]);
        nentry += 2 * Af.start[Af.ncol];
    }
    ct_derivation_init(&d, h->a, e, &h->sys->model,
                       nentry <= MOST_TYPESET ? CT_LOOK_HTML : CT_LOOK_TEXT);
    for (int i = 0; i < e->graph->nedge; i++)
        for (int k = 0; k < 2; k++) {
            put_equation(h, &d, tree[k], &cutsets[k], i, row[k], k == 1);
            row[k] += tree[k]->is_branch[i];
        }
}

// ---- data ----------------------------------------------------------------------------------

// Rows of cutsets are those of branches in ascending order, and so those of circuits.
static void put_members(struct ct_html *h, struct ct_json *j, const char *key,
                        const struct ct_tree *t, const struct ct_incidence *cutsets,
                        const struct ct_incidence *circuits, int edge, int *row)
{
    const bool is_branch = t->is_branch[edge];
    const struct ct_incidence *S = is_branch ? cutsets : circuits;
    const int i = row[is_branch]++;
    const size_t n = (size_t)(S->start[i + 1] - S->start[i]);
    double *number = CT_NEWN(h->a, double, n + 1);
    for (size_t k = 0; k < n; k++) {
        const int at = S->start[i] + (int)k;
        number[k] = S->value[at] * (S->row[at] + 1);
    }
    ct_json_numbers(j, key, number, n);
}

static void put_data(struct ct_html *h)
{
    const struct ct_equations *e = &h->sys->equations;
    const struct ct_tree *const tree[] = {e->T, e->R};
    static const char *const key[] = {"translation", "rotation"};
    struct ct_incidence S, rows[2][2]; // by tree: cutsets, circuits
    int row[2][2] = {{0}};
    for (int k = 0; k < 2; k++) {
        ct_cutsets_derive(h->a, e->graph, tree[k], &S);
        ct_incidence_transpose(h->a, &S, &rows[k][0]);
        ct_circuits_derive(h->a, e->graph, tree[k], &S);
        ct_incidence_transpose(h->a, &S, &rows[k][1]);
    }
    struct ct_html_data d;
    ct_html_open_data(h, &d, "data-graph");
    ct_json_array(&d.json, "edges");
    for (int i = 0; i < e->graph->nedge; i++) {
        ct_json_object(&d.json, NULL);
        ct_json_text(&d.json, "name", e->edge_name[i]);
        for (int k = 0; k < 2; k++)
            put_members(h, &d.json, key[k], tree[k], &rows[k][0], &rows[k][1], i, row[k]);
        ct_json_end(&d.json);
    }
    ct_json_end(&d.json);
    ct_html_close_data(&d);
}

// ---- the list of edges ---------------------------------------------------------------------

static void put_list(struct ct_html *h)
{
    const struct ct_equations *e = &h->sys->equations;
    FILE *out = h->out;
    fputs("<details class=\"wide\"><summary>All edges</summary>\n<table>\n<thead><tr><th "
          "class=\"number\">#</th><th>edge</th><th>type</th><th>from</th><th>to</th>"
          "<th>translation</th><th>rotation</th></tr></thead>\n<tbody>\n",
          out);
    for (int i = 0; i < e->graph->nedge; i++) {
        fputs("<tr", out);
        ct_html_put_components(out, ct_components_of_edge(h->a, h->sys, i));
        fprintf(out, "><td class=\"number\">%d</td><td>", i + 1);
        ct_html_put(out, e->edge_name[i]);
        fprintf(out, "</td><td>%s</td><td>", e->edge_kind[i]);
        ct_html_put(out, e->node_name[e->graph->edge[i].tail]);
        fputs("</td><td>", out);
        ct_html_put(out, e->node_name[e->graph->edge[i].head]);
        fprintf(out, "</td><td>%s</td><td>%s</td></tr>\n",
                e->T->is_branch[i] ? "branch" : "chord",
                e->R->is_branch[i] ? "branch" : "chord");
    }
    fputs("</tbody></table></details>\n", out);
}

static void put_legend(struct ct_html *h)
{
    fputs("<div class=\"tools\" hidden><fieldset class=\"choice\"><legend>tree</legend>"
          "<label><input type=\"radio\" name=\"tree\" value=\"translation\">translation</label>"
          "<label><input type=\"radio\" name=\"tree\" value=\"rotation\">rotation</label>"
          "<label><input type=\"radio\" name=\"tree\" value=\"both\" checked>both</label>"
          "</fieldset></div>\n"
          "<p class=\"note\">Vertices are frames, edges are components, and arms from a body's "
          "frame to its points. "
          "Branches are drawn solid and thick, chords dashed; a branch of the tree of "
          "translation alone is blue, of "
          "rotation alone orange, of both black.</p>\n",
          h->out);
}

void ct_html_graph(struct ct_html *h)
{
    const struct ct_graph *g = h->sys->equations.graph;
    ct_html_open_section(h, "graph", "Linear graph");
    fprintf(h->out,
            "<p>%d vertices and %d edges; each tree has %d branches and %d chords.</p>\n",
            g->nnode, g->nedge, h->sys->equations.T->nbranch, h->sys->equations.T->nchord);
    put_legend(h);
    if (g->nnode <= MOST_DRAWN)
        put_picture(h);
    else
        fprintf(h->out, "<p>More than %d vertices are not drawn.</p>\n", MOST_DRAWN);
    fputs("<div class=\"equations\" aria-live=\"polite\"><p class=\"hint\">Select a branch for "
          "its cutset, a chord for its circuit.</p>\n",
          h->out);
    put_equations(h);
    fputs("</div>\n", h->out);
    put_list(h);
    put_data(h);
    ct_html_close_section(h);
}
