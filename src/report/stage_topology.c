// The linear graph, its cutsets and its circuits as equations of forces, torques, displacements and
// rotations.
#include "report/stage_beam.h"

#include "expr/collect.h"
#include "formulate/kinematics.h"

#include <string.h>

// Of each kind; larger systems are counted, not printed.
enum { MOST_EQUATIONS = 120, LONGEST_VECTOR = 170 };

// ---- graph ----------------------------------------------------------------------------------------

static void put_incidence(struct ct_derivation *d)
{
    const struct ct_equations *e = d->e;
    const struct ct_graph *g = e->graph;
    size_t width = 12;
    for (int i = 0; i < g->nedge; i++)
        width += 2 + ct_text_width(ct_arena_printf(d->a, "%d", i + 1));
    ct_page_heading(&d->page,
                    "incidence: 1 at the head of an edge, -1 at its tail; without ground");
    if (width > CT_PAGE_WIDTH) {
        ct_page_sentence(&d->page, "too wide to print: %d edges", g->nedge);
        return;
    }
    char *align = CT_NEWN(d->a, char, g->nedge + 2);
    memset(align, 'r', (size_t)g->nedge + 1);
    align[0] = 'l';
    ct_page_table(&d->page, align);
    ct_page_cell(&d->page, "");
    for (int i = 0; i < g->nedge; i++)
        ct_page_cell(&d->page, ct_arena_printf(d->a, "%d", i + 1));
    for (int v = 1; v < g->nnode; v++) {
        ct_page_cell(&d->page, e->node_name[v]);
        for (int i = 0; i < g->nedge; i++)
            ct_page_cell(&d->page, g->edge[i].head == v   ? "1"
                                   : g->edge[i].tail == v ? "-1"
                                                          : ".");
    }
}

void ct_stage_graph(struct ct_derivation *d)
{
    const struct ct_equations *e = d->e;
    const struct ct_graph *g = e->graph;
    ct_page_title(&d->page, "Linear graph");
    ct_page_sentence(&d->page, "%d nodes (frames), %d edges (components)", g->nnode, g->nedge);
    ct_page_table(&d->page, "rllll");
    CT_PAGE_ROW(&d->page, "#", "edge", "type", "from", "to");
    for (int i = 0; i < g->nedge; i++)
        CT_PAGE_ROW(&d->page, ct_arena_printf(d->a, "%d", i + 1), e->edge_name[i],
                    e->edge_kind[i], e->node_name[g->edge[i].tail],
                    e->node_name[g->edge[i].head]);
    put_incidence(d);
}

// ---- cutsets --------------------------------------------------------------------------------------

// F(own) + F(...) - ... = 0 for row i of a cutset matrix.
static const char *cutset_text(struct ct_derivation *d, const struct ct_incidence *rows, int i,
                               int own, const char *letter, const bool *is_in)
{
    const char *s = ct_derivation_of(d, letter, d->e->edge_name[own]);
    for (int k = rows->start[i]; k < rows->start[i + 1]; k++)
        if (rows->row[k] != own && is_in[rows->row[k]])
            s = ct_arena_printf(d->a, "%s %s %s", s, rows->value[k] > 0 ? "+" : "-",
                                ct_derivation_of(d, letter, d->e->edge_name[rows->row[k]]));
    return s;
}

static void put_cutsets(struct ct_derivation *d, const struct ct_tree *t, const char *letter,
                        bool of_rotation)
{
    const struct ct_equations *e = d->e;
    const struct ct_build *b = e->build;
    struct ct_incidence Af, rows;
    ct_cutsets_derive(d->a, e->graph, t, &Af);
    ct_incidence_transpose(d->a, &Af, &rows);
    bool *is_in = CT_NEWN(d->a, bool, e->graph->nedge + 1);
    for (int i = 0; i < e->graph->nedge; i++)
        is_in[i] = !of_rotation || b->edge[i].has_rotation || b->edge[i].kind == CT_EDGE_FORCE;
    int n = 0;
    ct_page_equations(&d->page);
    for (int arms = 0; arms < 2; arms++) // joints and bodies first: these give the motion
        for (int i = 0; i < Af.nrow; i++) {
            const int own = t->branch[i];
            if ((b->edge[own].kind == CT_EDGE_ARM) != (arms == 1) || !is_in[own])
                continue;
            if (n++ < MOST_EQUATIONS)
                ct_page_equation(&d->page, NULL, cutset_text(d, &rows, i, own, letter, is_in),
                                 "0", NULL);
        }
    if (n > MOST_EQUATIONS)
        ct_page_sentence(&d->page, "... and %d more", n - MOST_EQUATIONS);
}

// What each joint branch must carry: bodies are replaced by inertia and weight, arms do not occur.
static void put_carried(struct ct_derivation *d)
{
    const struct ct_equations *e = d->e;
    const struct ct_build *b = e->build;
    const bool latex = ct_derivation_is_latex(d);
    struct ct_incidence Af, rows;
    int n = 0;
    ct_cutsets_derive(d->a, e->graph, e->T, &Af);
    ct_incidence_transpose(d->a, &Af, &rows);
    ct_page_heading(&d->page, "forces, with the terminal equations of the bodies");
    ct_page_equations(&d->page);
    for (int i = 0; i < Af.nrow; i++) {
        const int own = e->T->branch[i];
        const char *s = "";
        if (b->edge[own].kind == CT_EDGE_ARM || n >= MOST_EQUATIONS)
            continue;
        n++;
        for (int k = rows.start[i]; k < rows.start[i + 1]; k++) {
            const int edge = rows.row[k];
            const struct ct_edge_info *info = &b->edge[edge];
            const bool plus = rows.value[k] < 0; // moved to the other side
            if (edge == own)
                continue;
            const char *term = ct_derivation_of(d, "F", e->edge_name[edge]);
            bool positive = plus;
            if (info->kind == CT_EDGE_BODY && !d->m->body[info->index].beam) {
                const struct ct_body *body = &d->m->body[info->index];
                if (ct_ex_is_zero(body->mass))
                    continue;
                const char *mass = ct_derivation_text(d, body->mass);
                term = ct_arena_printf(
                    d->a, latex ? "%s \\, (%s - \\boldsymbol{g})" : "%s*(%s - g)",
                    strchr(mass, ' ') ? ct_arena_printf(d->a, "(%s)", mass) : mass,
                    ct_derivation_of(d, "a", b->node[b->node_of_com[info->index]].name));
                positive = !plus;
            }
            s = *s ? ct_arena_printf(d->a, "%s %s %s", s, positive ? "+" : "-", term)
                   : ct_arena_printf(d->a, "%s%s", positive ? "" : "-", term);
        }
        ct_page_equation(&d->page, NULL, ct_derivation_of(d, "F", e->edge_name[own]),
                         *s ? s : "0", NULL);
    }
}

void ct_stage_cutset(struct ct_derivation *d)
{
    ct_page_title(&d->page, "Cutset equations");
    ct_page_sentence(&d->page,
                     "one per branch: what crosses the cut that the branch makes in its tree");
    ct_page_heading(&d->page, "forces, tree of translation");
    put_cutsets(d, d->e->T, "F", false);
    put_carried(d);
    ct_beams_put_cutsets(d);
    ct_page_heading(&d->page,
                    "torques, tree of rotation (each with the moment of its force about one "
                    "common point)");
    put_cutsets(d, d->e->R, "T", true);
}

// ---- circuits -------------------------------------------------------------------------------------

// The chord from the branches on the way from its tail to its head.
static const char *circuit_text(struct ct_derivation *d, const struct ct_tree *t, int chord,
                                bool of_rotation)
{
    const struct ct_equations *e = d->e;
    const bool latex = ct_derivation_is_latex(d);
    int *branch = CT_NEWN(d->a, int, t->nbranch + 1);
    signed char *sign = CT_NEWN(d->a, signed char, t->nbranch + 1);
    const int n = ct_tree_circuit(e->graph, t, chord, branch, sign);
    const char *s = "";
    for (int k = n - 1; k >= 0; k--) { // the circuit runs from head to tail
        const bool forward = sign[k] < 0;
        const char *name = e->edge_name[branch[k]];
        if (of_rotation) {
            const char *S = ct_derivation_of(d, "S", name);
            if (e->build->edge[branch[k]].kind == CT_EDGE_BODY
                && e->build->node[e->graph->edge[branch[k]].head].is_particle)
                continue; // its axes stay parallel to ground
            s = ct_arena_printf(d->a, "%s%s%s%s", s, *s ? latex ? " \\, " : "*" : "", S,
                                forward ? ""
                                : latex ? "^{T}"
                                        : "'");
        } else {
            s = ct_arena_printf(d->a, *s ? "%s %s %s" : "%s%s%s", s,
                                forward ? *s ? "+" : "" : "-", ct_derivation_of(d, "d", name));
        }
    }
    return *s ? s : of_rotation ? "1" : "0";
}

static void put_circuits(struct ct_derivation *d, const struct ct_tree *t, bool of_rotation)
{
    const struct ct_equations *e = d->e;
    int n = 0;
    ct_page_equations(&d->page);
    for (int i = 0; i < t->nchord; i++) {
        const struct ct_edge_info *info = &e->build->edge[t->chord[i]];
        if (of_rotation && !info->has_rotation)
            continue;
        if (n++ < MOST_EQUATIONS)
            ct_page_equation(
                &d->page, NULL,
                ct_derivation_of(d, of_rotation ? "S" : "d", e->edge_name[t->chord[i]]),
                circuit_text(d, t, t->chord[i], of_rotation), NULL);
    }
    if (n > MOST_EQUATIONS)
        ct_page_sentence(&d->page, "... and %d more", n - MOST_EQUATIONS);
}

// Places of the centres of mass that are chords, in the unknowns; those too long to read are left out.
static void put_places(struct ct_derivation *d)
{
    const struct ct_equations *e = d->e;
    struct ct_build *b = e->build;
    bool any = false;
    for (int i = 0; i < e->T->nchord && i < MOST_EQUATIONS; i++) {
        const int edge = e->T->chord[i];
        if (b->edge[edge].kind != CT_EDGE_BODY)
            continue;
        ct_ex3 r = ct_node_position(b, b->wiring[edge].head);
        double size = 0;
        for (int k = 0; k < 3; k++)
            size += ct_reduced_size(b->x, r.e[k], 301);
        if (size > 300)
            continue;
        for (int k = 0; k < 3; k++)
            r.e[k] = ct_ex_collect(b->x, r.e[k], &(struct ct_collect_options){.scratch = d->a});
        const char *text = ct_derivation_vector(d, r);
        if (strlen(text) > LONGEST_VECTOR)
            continue;
        if (!any) {
            ct_page_heading(&d->page,
                            "circuits of the bodies, with the terminal equations of the "
                            "branches (ground axes)");
            ct_page_equations(&d->page);
        }
        any = true;
        ct_page_equation(&d->page, NULL, ct_derivation_of(d, "d", e->edge_name[edge]), text,
                         NULL);
    }
}

static void put_closures(struct ct_derivation *d)
{
    const struct ct_equations *e = d->e;
    bool any = false;
    for (size_t i = 0; i < e->nrow; i++) {
        if (ct_reduced_size(e->x, e->row[i].phi, 1001) > 1000)
            continue;
        if (!any) {
            ct_page_heading(&d->page,
                            "circuits of the joints, with the terminal equations of all");
            ct_page_equations(&d->page);
        }
        any = true;
        ct_page_equation(&d->page, e->row[i].name, ct_derivation_collected(d, e->row[i].phi),
                         "0", NULL);
    }
}

void ct_stage_circuit(struct ct_derivation *d)
{
    ct_page_title(&d->page, "Circuit equations");
    ct_page_sentence(&d->page,
                     "one per chord: the way through the tree from its tail to its head");
    ct_page_heading(&d->page, "displacements, tree of translation (ground axes)");
    put_circuits(d, d->e->T, false);
    ct_page_heading(&d->page, ct_derivation_is_latex(d)
                                  ? "rotations, tree of rotation"
                                  : "rotations, tree of rotation (S' is the inverse of S)");
    put_circuits(d, d->e->R, true);
    put_places(d);
    put_closures(d);
}
