// The linear graph, its cutsets and its circuits as equations of forces, torques, displacements and
// rotations.
#include "report/stage_beam.h"

#include "expr/collect.h"
#include "formulate/kinematics/kinematics.h"

#include <limits.h>
#include <string.h>

// Limits of lists; longer ones are only counted unless all are requested.
static int most_equations(const struct ct_derivation *d)
{
    return d->page.is_full ? INT_MAX : 120;
}

// ---- matrices ------------------------------------------------------------------------------

static const char *number_text(struct ct_derivation *d, int edge)
{
    return ct_arena_printf(d->a, "%d", edge + 1);
}

// A name as the header of a row.
static const char *word(struct ct_derivation *d, const char *name)
{
    return ct_derivation_is_latex(d)
             ? ct_arena_printf(d->a, "\\mathrm{%s}", ct_latex_quoted(d->a, name))
             : name;
}

// S (compressed columns, one per edge): a row for each `name`, columns in the given order of edges.
static void put_matrix(struct ct_derivation *d, const struct ct_incidence *S,
                       const char *const *name, const int *order)
{
    const struct ct_graph *g = d->e->graph;
    struct ct_incidence rows;
    ct_incidence_transpose(d->a, S, &rows);
    signed char *value = CT_NEWN(d->a, signed char, g->nedge + 1);
    ct_page_matrix(&d->page, (size_t)g->nedge + 1);
    ct_page_cell(&d->page, "");
    for (int k = 0; k < g->nedge; k++)
        ct_page_cell(&d->page, number_text(d, order[k]));
    for (int i = 0; i < S->nrow; i++) {
        for (int k = rows.start[i]; k < rows.start[i + 1]; k++)
            value[rows.row[k]] = rows.value[k];
        ct_page_cell(&d->page, word(d, name[i]));
        for (int k = 0; k < g->nedge; k++)
            ct_page_cell(&d->page, value[order[k]] > 0   ? "1"
                                   : value[order[k]] < 0 ? "-1"
                                                         : ".");
        for (int k = rows.start[i]; k < rows.start[i + 1]; k++)
            value[rows.row[k]] = 0;
    }
    if (!ct_page_matrix_end(&d->page))
        ct_page_sentence(&d->page, "%d x %d, too wide to print; it is in --format json",
                         S->nrow, g->nedge);
}

// ---- graph ---------------------------------------------------------------------------------

static void put_incidence(struct ct_derivation *d)
{
    const struct ct_equations *e = d->e;
    const struct ct_graph *g = e->graph;
    ct_page_heading(&d->page,
                    "incidence: 1 at the head of an edge, -1 at its tail; without ground");
    struct ct_incidence A;
    ct_incidence_derive(d->a, g, &A);
    int *order = CT_NEWN(d->a, int, g->nedge + 1);
    for (int i = 0; i < g->nedge; i++)
        order[i] = i;
    put_matrix(d, &A, (const char *const *)e->node_name + 1, order);
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

// ---- trees ---------------------------------------------------------------------------------

// The f-cutset or f-circuit matrix of a tree: branches first, then chords, so that one block is
// a unit matrix.
static void put_tree_matrix(struct ct_derivation *d, const struct ct_tree *t, bool cutsets)
{
    const struct ct_equations *e = d->e;
    struct ct_incidence S;
    if (cutsets)
        ct_cutsets_derive(d->a, e->graph, t, &S);
    else
        ct_circuits_derive(d->a, e->graph, t, &S);
    const int *own = cutsets ? t->branch : t->chord;
    const char **name = CT_NEWN(d->a, const char *, S.nrow + 1);
    int *order = CT_NEWN(d->a, int, e->graph->nedge + 1), n = 0;
    for (int i = 0; i < S.nrow; i++)
        name[i] = e->edge_name[own[i]];
    for (int i = 0; i < t->nbranch; i++)
        order[n++] = t->branch[i];
    for (int i = 0; i < t->nchord; i++)
        order[n++] = t->chord[i];
    put_matrix(d, &S, name, order);
}

static void put_tree_matrices(struct ct_derivation *d, bool cutsets)
{
    const struct ct_equations *e = d->e;
    const size_t size = (size_t)e->graph->nedge * sizeof *e->T->is_branch;
    const bool is_same = !size || !memcmp(e->T->is_branch, e->R->is_branch, size);
    const char *what = cutsets ? "f-cutset matrix" : "f-circuit matrix";
    const char *rows = cutsets ? "a row per branch" : "a row per chord";
    ct_page_heading(
        &d->page, ct_arena_printf(d->a, "%s of %s: %s; columns are edges, branches first", what,
                                  is_same ? "both trees" : "the tree of translation", rows));
    put_tree_matrix(d, e->T, cutsets);
    if (is_same)
        return;
    ct_page_heading(&d->page, ct_arena_printf(d->a, "%s of the tree of rotation", what));
    put_tree_matrix(d, e->R, cutsets);
}

// ---- cutsets -------------------------------------------------------------------------------

static void add_term(struct ct_derivation *d, struct ct_growing_text *sum, bool negative,
                     const char *term)
{
    ct_derivation_append(d, sum, !sum->n ? negative ? "-" : "" : negative ? " - " : " + ");
    ct_derivation_append(d, sum, term);
}

const char *ct_derivation_cutset(struct ct_derivation *d, const struct ct_incidence *rows,
                                 int i, int own, const char *letter)
{
    struct ct_growing_text s = {0};
    ct_derivation_append(d, &s, ct_derivation_of(d, letter, d->e->edge_name[own]));
    for (int k = rows->start[i]; k < rows->start[i + 1]; k++)
        if (rows->row[k] != own)
            add_term(d, &s, rows->value[k] < 0,
                     ct_derivation_of(d, letter, d->e->edge_name[rows->row[k]]));
    return s.at;
}

static void put_more(struct ct_derivation *d, int n)
{
    if (n > most_equations(d))
        ct_page_sentence(&d->page, "... and %d more", n - most_equations(d));
}

// A particle has no balance of torques.
static bool has_balance(const struct ct_derivation *d, int edge, bool of_rotation)
{
    return !of_rotation || d->e->build->topology->edge[edge].has_rotation;
}

static void put_cutsets(struct ct_derivation *d, const struct ct_tree *t, bool of_rotation)
{
    const struct ct_equations *e = d->e;
    const struct ct_build *b = e->build;
    struct ct_incidence Af, rows;
    ct_cutsets_derive(d->a, e->graph, t, &Af);
    ct_incidence_transpose(d->a, &Af, &rows);
    int n = 0;
    ct_page_equations(&d->page);
    for (int arms = 0; arms < 2; arms++) // joints and bodies first: these give the motion
        for (int i = 0; i < Af.nrow; i++) {
            const int own = t->branch[i];
            if ((b->topology->edge[own].kind == CT_EDGE_ARM) != (arms == 1)
                || !has_balance(d, own, of_rotation))
                continue;
            if (n++ < most_equations(d))
                ct_page_equation(
                    &d->page, NULL,
                    ct_derivation_cutset(d, &rows, i, own, of_rotation ? "T" : "F"), "0", NULL);
        }
    put_more(d, n);
}

// ---- cutsets with the terminal equations of the bodies -------------------------------------

static const struct ct_body *body_of(const struct ct_derivation *d, int edge)
{
    const struct ct_edge_info *e = &d->e->build->topology->edge[edge];
    return e->kind == CT_EDGE_BODY && !d->m->body[e->index].beam ? &d->m->body[e->index] : NULL;
}

// The force of an edge; for a body, inertia minus weight, which is the negative of its force. NULL:
// zero.
static const char *force_text(struct ct_derivation *d, int edge)
{
    const struct ct_body *body = body_of(d, edge);
    return body ? ct_derivation_inertia_force(d, body)
                : ct_derivation_of(d, "F", d->e->edge_name[edge]);
}

static const char *torque_text(struct ct_derivation *d, int edge)
{
    const struct ct_body *body = body_of(d, edge);
    const struct ct_edge_info *e = &d->e->build->topology->edge[edge];
    if (body)
        return ct_derivation_inertia_torque(d, body);
    return e->has_rotation || e->kind == CT_EDGE_FORCE
             ? ct_derivation_of(d, "T", d->e->edge_name[edge])
             : NULL;
}

// r(head) x force, about the head of the branch `own`; NULL: the force acts there.
static const char *moment_text(struct ct_derivation *d, int edge, int own)
{
    const struct ct_edge *w = d->e->graph->edge;
    const char *force = force_text(d, edge);
    if (!force || w[edge].head == w[own].head)
        return NULL;
    return ct_arena_printf(d->a, ct_derivation_is_latex(d) ? "%s \\times %s" : "%s x %s",
                           ct_derivation_of(d, "r", d->e->node_name[w[edge].head]), force);
}

// Row i of a cutset matrix: the branch itself on the left, for a body its inertia; the rest on
// the right.
static void put_balance(struct ct_derivation *d, const struct ct_incidence *rows, int i,
                        int own, bool of_rotation)
{
    const bool is_inertia = body_of(d, own) != NULL;
    const char *left = of_rotation ? torque_text(d, own) : force_text(d, own);
    struct ct_growing_text right = {0};
    for (int k = rows->start[i]; k < rows->start[i + 1]; k++) {
        const int edge = rows->row[k];
        // with the branch's own sign reversed
        const bool negative
            = ((rows->value[k] < 0) != (body_of(d, edge) != NULL)) == is_inertia;
        const char *const term[] = {of_rotation ? torque_text(d, edge) : force_text(d, edge),
                                    of_rotation ? moment_text(d, edge, own) : NULL};
        for (int j = 0; j < 2 && edge != own; j++)
            if (term[j])
                add_term(d, &right, negative, term[j]);
    }
    ct_page_equation(&d->page, NULL, left ? left : "0", right.n ? right.at : "0", NULL);
}

static void put_balances(struct ct_derivation *d, const struct ct_tree *t, bool of_rotation)
{
    const struct ct_build *b = d->e->build;
    struct ct_incidence Af, rows;
    int n = 0;
    ct_cutsets_derive(d->a, d->e->graph, t, &Af);
    ct_incidence_transpose(d->a, &Af, &rows);
    ct_page_heading(&d->page, of_rotation
                                  ? "torques, with the terminal equations of the bodies"
                                  : "forces, with the terminal equations of the bodies");
    if (of_rotation)
        ct_page_sentence(&d->page,
                         "about the head of the branch; r: from there to the head of an edge, "
                         "where its force acts");
    ct_page_equations(&d->page);
    for (int i = 0; i < Af.nrow; i++) {
        const int own = t->branch[i];
        if (b->topology->edge[own].kind == CT_EDGE_ARM || !has_balance(d, own, of_rotation))
            continue;
        if (n++ < most_equations(d))
            put_balance(d, &rows, i, own, of_rotation);
    }
    put_more(d, n);
}

void ct_stage_cutset(struct ct_derivation *d)
{
    ct_page_title(&d->page, "Cutset equations");
    ct_page_sentence(&d->page,
                     "one per branch: the balance of the edges in its fundamental cutset");
    put_tree_matrices(d, true);
    ct_page_heading(&d->page, "forces, tree of translation");
    put_cutsets(d, d->e->T, false);
    put_balances(d, d->e->T, false);
    ct_beams_put_cutsets(d);
    ct_page_heading(&d->page,
                    "torques, tree of rotation (each with the moment of its force about one "
                    "common point)");
    put_cutsets(d, d->e->R, true);
    put_balances(d, d->e->R, true);
}

// ---- circuits ------------------------------------------------------------------------------

const char *ct_derivation_circuit(struct ct_derivation *d, const struct ct_tree *t, int chord,
                                  bool of_rotation)
{
    const struct ct_equations *e = d->e;
    const bool latex = ct_derivation_is_latex(d);
    int *branch = CT_NEWN(d->a, int, t->nbranch + 1);
    signed char *sign = CT_NEWN(d->a, signed char, t->nbranch + 1);
    const int n = ct_tree_circuit(e->graph, t, chord, branch, sign);
    struct ct_growing_text s = {0};
    for (int k = n - 1; k >= 0; k--) { // the circuit runs from head to tail
        const bool forward = sign[k] < 0;
        const char *name = e->edge_name[branch[k]];
        if (of_rotation) {
            const char *S = ct_derivation_of(d, "S", name);
            if (e->build->topology->edge[branch[k]].kind == CT_EDGE_BODY
                && e->build->topology->node[e->graph->edge[branch[k]].head].is_particle)
                continue; // its axes stay parallel to ground
            ct_derivation_append(d, &s, !s.n ? "" : latex ? " \\, " : "*");
            ct_derivation_append(d, &s, S);
            ct_derivation_append(d, &s, forward ? "" : latex ? "^{T}" : "'");
        } else {
            add_term(d, &s, !forward, ct_derivation_of(d, "d", name));
        }
    }
    return s.n ? s.at : of_rotation ? "1" : "0";
}

static void put_circuits(struct ct_derivation *d, const struct ct_tree *t, bool of_rotation)
{
    const struct ct_equations *e = d->e;
    int n = 0;
    ct_page_equations(&d->page);
    for (int i = 0; i < t->nchord; i++) {
        const struct ct_edge_info *info = &e->build->topology->edge[t->chord[i]];
        if (of_rotation && !info->has_rotation)
            continue;
        if (n++ < most_equations(d))
            ct_page_equation(
                &d->page, NULL,
                ct_derivation_of(d, of_rotation ? "S" : "d", e->edge_name[t->chord[i]]),
                ct_derivation_circuit(d, t, t->chord[i], of_rotation), NULL);
    }
    put_more(d, n);
}

// Number of nodes above which collecting takes seconds and the result is too long to read.
// Limit: of the time to collect; longer expressions are printed as they are
static const double largest_collected = 5000;

// Collects an expression that is small enough; false: it is too large.
static bool collect(struct ct_derivation *d, ct_ex *const *where, size_t n)
{
    const struct ct_collect_options o = {.scratch = d->a};
    double size = 0;
    for (size_t i = 0; i < n && size <= largest_collected; i++)
        size += ct_reduced_size(d->e->x, *where[i], largest_collected + 1 - size);
    for (size_t i = 0; i < n && size <= largest_collected; i++)
        *where[i] = ct_ex_collect(d->e->x, *where[i], &o);
    return size <= largest_collected;
}

static bool is_long(struct ct_derivation *d, ct_ex *const *where, size_t n)
{
    size_t lines = 0;
    for (size_t i = 0; i < n; i++) {
        lines += ct_derivation_lines(d, *where[i]);
        if (lines > 2 * CT_MOST_LINES) // three components of a position share a line
            return true;
    }
    return false;
}

void ct_derivation_substitute(struct ct_derivation *d, struct ct_substituted *s)
{
    struct ct_equations *e = d->e;
    struct ct_build *b = e->build;
    ct_ex **where = CT_NEWN(d->a, ct_ex *, 3 * (size_t)e->T->nchord + e->nrow + 1);
    size_t n = 0;
    *s = (struct ct_substituted){.edge = CT_NEWN(d->a, int, e->T->nchord + 1),
                                 .at = CT_NEWN(d->a, ct_ex3, e->T->nchord + 1),
                                 .phi = CT_NEWN(d->a, ct_ex, e->nrow + 1)};
    for (int i = 0; i < e->T->nchord; i++) {
        const int edge = e->T->chord[i];
        if (b->topology->edge[edge].kind != CT_EDGE_BODY)
            continue;
        ct_ex3 *at = &s->at[s->n];
        *at = ct_node_position(b, b->topology->wiring[edge].head);
        s->edge[s->n++] = edge;
        for (int k = 0; k < 3; k++)
            where[n++] = &at->e[k];
    }
    for (size_t i = 0; i < e->nrow; i++) {
        s->phi[i] = e->row[i].phi;
        where[n++] = &s->phi[i];
    }
    double size;
    if (!collect(d, where, n) || is_long(d, where, n)) {
        ct_reduced_label(e, d->is_recursive ? CT_FULL : CT_BIAS);
        s->definitions = ct_definitions_find(d->a, e, where, n, d->is_recursive, &size);
    }
}

static void put_substituted(struct ct_derivation *d)
{
    const struct ct_equations *e = d->e;
    struct ct_substituted s;
    ct_derivation_substitute(d, &s);
    ct_derivation_put_definitions(d, "with, for the circuits below", &s.definitions);
    if (s.n) {
        ct_page_heading(&d->page, "circuits of the bodies, with the terminal equations of the "
                                  "branches (ground axes)");
        ct_page_equations(&d->page);
    }
    for (size_t i = 0; i < s.n; i++)
        ct_page_equation(&d->page, NULL, ct_derivation_of(d, "d", e->edge_name[s.edge[i]]),
                         ct_derivation_vector(d, s.at[i]), NULL);
    if (e->nrow) {
        ct_page_heading(&d->page,
                        "circuits of the joints, with the terminal equations of all edges");
        ct_page_equations(&d->page);
    }
    for (size_t i = 0; i < e->nrow; i++)
        ct_page_equation(&d->page, e->row[i].name, ct_derivation_text(d, s.phi[i]), "0", NULL);
}

void ct_stage_circuit(struct ct_derivation *d)
{
    ct_page_title(&d->page, "Circuit equations");
    ct_page_sentence(&d->page, "one per chord: the path in the tree from its tail to its head");
    put_tree_matrices(d, false);
    ct_page_heading(&d->page, "displacements, tree of translation (ground axes)");
    put_circuits(d, d->e->T, false);
    ct_page_heading(&d->page, ct_derivation_is_latex(d)
                                  ? "rotations, tree of rotation"
                                  : "rotations, tree of rotation (S' is the inverse of S)");
    put_circuits(d, d->e->R, true);
    put_substituted(d);
}
