// See tree_selection.h: the search for the cheapest pair of trees.
#include "formulate/topology/tree_selection.h"

#include "formulate/beam/flexible_body.h"
#include "formulate/operation_count.h"
#include "graph/exchange.h"

#include <math.h>
#include <string.h>

// Is every chord of the least-weight trees a body edge, a force or a rod? Then the system has no
// loop of joints.
static bool is_open(const struct ct_build *b, const struct ct_tree_pair *p)
{
    for (size_t i = 0; i < b->topology->nedge; i++) {
        const enum ct_edge_kind kind = b->topology->edge[i].kind;
        if ((kind == CT_EDGE_JOINT || kind == CT_EDGE_CLOSURE)
            && !b->topology->edge[i].never_branch
            && (!p->trans[i] || (b->topology->edge[i].has_rotation && !p->rot[i]))
            && b->topology->edge[i].trial->quaternion != 3)
            return false;
    }
    return true;
}

// Number of constraint rows and of unknowns, by (2.1).
static void count_weights(const struct ct_build *b, const struct ct_tree_pair *p, int *nrow,
                          int *nu)
{
    const int directions[2] = {b->topology->is_planar ? 2 : 3, b->topology->is_planar ? 1 : 3};
    *nrow = *nu = 0;
    for (size_t i = 0; i < b->topology->nedge; i++) {
        const struct ct_edge_info *e = &b->topology->edge[i];
        const bool is_joint = e->kind == CT_EDGE_JOINT || e->kind == CT_EDGE_CLOSURE;
        const int weight[2] = {e->weight_t, e->weight_r};
        const bool branch[2] = {p->trans[i], p->rot[i] || !e->has_rotation};
        for (int k = 0; k < 2; k++) {
            *nu += branch[k] ? weight[k] : 0;
            *nrow += is_joint && !branch[k] ? directions[k] - weight[k] : 0;
        }
    }
}

// Is it a long open chain? In a plane absolute angles are chosen also in open chains, and joints
// are then chords without rows. A search gains nothing there, and its trials would derive the full
// mass matrix.
static bool is_long_chain(const struct ct_build *b, const struct ct_tree_pair *p)
{
    int nrow, nu;
    count_weights(b, p, &nrow, &nu);
    return nrow == 0 && nu > CT_SMALL_SYSTEM;
}

static bool least_weight(struct ct_build *b, const struct ct_pair_rules *r,
                         struct ct_tree_pair *p)
{
    int *w = CT_NEWN(b->arena, int, b->topology->nedge);
    struct ct_tree t;
    bool **out[] = {&p->trans, &p->rot};
    for (int k = 0; k < 2; k++) {
        const bool *forced = k ? r->forced_r : r->forced_t,
                   *banned = k ? r->banned_r : r->banned_t;
        const int *weight = k ? r->weight_r : r->weight_t;
        for (size_t i = 0; i < b->topology->nedge; i++)
            w[i] = banned[i] ? -1 : forced[i] ? 0 : weight[i] + 2;
        if (!ct_tree_kruskal(b->arena, &b->topology->graph, w, r->rank, &t, NULL))
            return ct_error(b->ctx, (struct ct_mark){0}, CT_E_TREE,
                            "the model's graph has no spanning tree");
        *out[k] = t.is_branch;
    }
    return true;
}

// The work of the search is bounded by the number of expression nodes, not by time, so that the
// result is deterministic. Limit: about a second.
static const double search_nodes = 600000;
// No search if the bound allows fewer pairs than this: few exchanges seldom find a cheaper pair.
// Limit: of the time to formulate large systems.
static const double fewest_pairs = 16;
// most_pairs: up to this number all pairs are tried. Otherwise a descent tries descent_pairs of
// them, with weights up to `excess` above the least. Limit: of the time of the search; the pairs
// found differ by some operations.
static const double most_pairs = 2000, descent_pairs = 400;
static const int excess = 2;

static void improve(struct ct_build *b, const struct ct_pair_rules *r,
                    const struct ct_pair_trials *trials, struct ct_tree_pair *p,
                    struct ct_tree_report *report)
{
    struct ct_search_stats stats;
    struct ct_tree T, R;
    ct_tree_from_branches(b->arena, &b->topology->graph, p->trans, &T);
    ct_tree_from_branches(b->arena, &b->topology->graph, p->rot, &R);
    const double first = trials->cost(trials->stage, &T, &R);
    const double pairs = floor(search_nodes / fmax(first, 100));
    const struct ct_search_options o
        = {.trans = {r->weight_t, r->rank, r->forced_t, r->banned_t},
           .rot = {r->weight_r, r->rank, r->forced_r, r->banned_r},
           .tied = r->tied,
           .limit = fmin(pairs, most_pairs),
           .budget = (int)fmin(pairs, descent_pairs),
           .excess = excess};
    if (pairs < fewest_pairs
        || !ct_tree_search(b->arena, &b->topology->graph, &o, trials->cost, trials->stage, p,
                           &stats)) {
        report->how = "least weight";
        report->cost = report->cost_least_weight = first;
        return;
    }
    report->cost = stats.cost;
    report->cost_least_weight = stats.cost_least_weight;
    report->how = stats.exhaustive
                    ? ct_arena_printf(b->arena, "cheapest of all %d pairs", stats.nevaluated)
                    : ct_arena_printf(b->arena, "cheapest of %d pairs tried by exchanges",
                                      stats.nevaluated);
}

static const char *near_edge(struct ct_build *b, const char *name)
{
    const char **names = CT_NEWN(b->arena, const char *, b->topology->nedge);
    size_t n = 0;
    for (size_t i = 0; i < b->topology->nedge; i++)
        if (b->topology->edge[i].kind != CT_EDGE_ARM)
            names[n++] = b->topology->edge[i].name;
    const char *near = ct_nearest(name, names, n);
    return near ? ct_arena_printf(b->arena, "; did you mean '%s'?", near) : "";
}

static bool mark_named(struct ct_build *b, const char *const *names, const struct ct_mark *mark,
                       size_t n, const bool *forced, bool *branch)
{
    memcpy(branch, forced, b->topology->nedge * sizeof *branch);
    bool ok = true;
    for (size_t k = 0; k < n; k++) {
        size_t i = 0;
        while (i < b->topology->nedge && strcmp(b->topology->edge[i].name, names[k]) != 0)
            i++;
        if (i == b->topology->nedge)
            ok = ct_error(b->ctx, mark ? mark[k] : (struct ct_mark){0}, CT_E_TREE,
                          "tree: there is no edge '%s'%s", names[k], near_edge(b, names[k]));
        else
            branch[i] = true;
    }
    return ok;
}

static bool given_trees(struct ct_build *b, const struct ct_formulate_options *o,
                        const struct ct_pair_rules *r, struct ct_tree_pair *p)
{
    p->trans = CT_NEWN(b->arena, bool, b->topology->nedge);
    p->rot = CT_NEWN(b->arena, bool, b->topology->nedge);
    if (!mark_named(b, o->trans, o->trans_mark, o->ntrans, r->forced_t, p->trans)
        || !mark_named(b, o->rot, o->rot_mark, o->nrot, r->forced_r, p->rot))
        return false;
    bool ok = true;
    for (size_t i = 0; i < b->topology->nedge; i++)
        if ((p->trans[i] && r->banned_t[i]) || (p->rot[i] && r->banned_r[i]))
            ok = ct_error(b->ctx, (struct ct_mark){0}, CT_E_TREE,
                          "tree: '%s' cannot be a branch", b->topology->edge[i].name);
    return ok;
}

// Estimated number of unknowns of a body: one for its joint, and the coordinates of its beam
// elements.
static double own_unknowns(const struct ct_build *b, size_t body)
{
    const struct ct_beam *beam = b->model->body[body].beam;
    return 1 + (beam ? 6. * beam->nelement : 0);
}

// Estimated number of entries of the mass matrix between different bodies: each body with all its
// inboard bodies.
static double coupling(struct ct_build *b, const bool *branch)
{
    struct ct_tree t;
    ct_tree_from_branches(b->arena, &b->topology->graph, branch, &t);
    double *inboard = CT_NEWN(b->ctx->scratch, double, b->topology->nnode), sum = 0;
    for (size_t k = 0; k < b->topology->nnode; k++) { // from ground outwards
        const int v = t.order[k], from = t.parent[v];
        if (from < 0)
            continue;
        const int body = b->topology->node[v].body;
        const bool enters = body > 0 && b->topology->node[from].body != body;
        const double own = enters ? own_unknowns(b, (size_t)body) : 0;
        sum += own * inboard[from];
        inboard[v] = inboard[from] + own;
    }
    return sum;
}

// Choice of trees for the analysis of large systems. With relative coordinates the mass matrix of a
// long chain is full; with absolute coordinates it is sparse. The rows of the joints are
// sparse in both.
static enum ct_tree_choice choose_for_analysis(struct ct_build *b,
                                               const struct ct_formulate_options *o,
                                               const struct ct_tree_pair *p)
{
    // Entries per unknown above which absolute coordinates are chosen. Chosen: sparsity against the
    // number of unknowns.
    const double most = 400;
    double n = 0;
    for (size_t i = 1; i < b->model->nbody; i++)
        n += own_unknowns(b, i);
    if (!o->for_analysis || o->tree != CT_TREE_AUTO || n <= CT_MOST_DENSE
        || (coupling(b, p->trans) <= most * n && coupling(b, p->rot) <= most * n))
        return o->tree;
    return CT_TREE_ABSOLUTE;
}

// Trees of absolute coordinates.
static bool absolute_trees(struct ct_build *b, const struct ct_formulate_options *o,
                           struct ct_tree_pair *p)
{
    struct ct_formulate_options from_ground = *o;
    from_ground.tree = CT_TREE_ABSOLUTE;
    const struct ct_pair_rules absolute = ct_pair_rules_make(b, &from_ground);
    return least_weight(b, &absolute, p);
}

// Does it have several beams, none of a formulation that depends on the trees?
static bool has_loops_of_beams(const struct ct_build *b)
{
    for (size_t i = 0; i < b->nflexible; i++) {
        const enum ct_beam_formulation f = b->flexible[i].beam->formulation;
        if (f == CT_BEAM_FORCE_ONLY || f == CT_BEAM_STRETCH_LINEAR)
            return false;
    }
    return b->nflexible > 1;
}

// Tries absolute coordinates for loops of beams. With relative coordinates such beams fill the mass
// matrix and the constraint rows. Absolute coordinates give more unknowns and rows, but sparse
// ones. They are taken if their operation count is a tenth smaller.
static void count_from_ground(struct ct_build *b, const struct ct_formulate_options *o,
                              const struct ct_pair_trials *trials, struct ct_tree_pair *p,
                              struct ct_tree_report *report)
{
    struct ct_tree_pair q;
    struct ct_tree T, R;
    if (!has_loops_of_beams(b) || !absolute_trees(b, o, &q))
        return;
    ct_tree_from_branches(b->arena, &b->topology->graph, q.trans, &T);
    ct_tree_from_branches(b->arena, &b->topology->graph, q.rot, &R);
    const double cost = trials->cost(trials->stage, &T, &R);
    if (!(cost < CT_CLEARLY_CHEAPER * report->cost))
        return;
    *p = q;
    report->cost = cost;
    report->how
        = "absolute coordinates: through the joints the beams would fill the mass matrix";
}

// Takes the pair that the user gives by its number in the list.
static bool pick(struct ct_build *b, int number, struct ct_tree_pair *p,
                 struct ct_tree_report *report)
{
    const size_t size = b->topology->nedge * sizeof(bool);
    if (number > report->ncandidate && report->ncandidate)
        return ct_error(b->ctx, (struct ct_mark){0}, CT_E_TREE,
                        "tree: there is no pair %d, %d are listed by 'cotree graph --trees'",
                        number, report->ncandidate);
    if (number > report->ncandidate)
        return ct_error(b->ctx, (struct ct_mark){0}, CT_E_TREE,
                        "tree: there is no pair %d, as none was searched (%s)", number,
                        report->how);
    const struct ct_tree_candidate *c = &report->candidate[number - 1];
    memcpy(p->trans, c->trans, size);
    memcpy(p->rot, c->rot, size);
    report->cost = c->cost;
    report->how = ct_arena_printf(b->arena, "number %d of the pairs weighed", number);
    return true;
}

bool ct_tree_selection_run(struct ct_build *b, const struct ct_formulate_options *o,
                           const struct ct_pair_trials *trials, struct ct_tree_report *report)
{
    const struct ct_pair_rules r = ct_pair_rules_make(b, o);
    struct ct_tree_pair p;
    static const char *const how[]
        = {"least weight", "through joints", "absolute coordinates", "given"};
    report->how = how[o->tree];
    if (o->tree == CT_TREE_GIVEN ? !given_trees(b, o, &r, &p) : !least_weight(b, &r, &p))
        return false;
    if (choose_for_analysis(b, o, &p) != o->tree) {
        report->how = "absolute coordinates: through the joints the mass matrix would be full";
        if (!absolute_trees(b, o, &p))
            return false;
    } else if (o->tree == CT_TREE_AUTO && (is_open(b, &p) || is_long_chain(b, &p))) {
        report->how = "least weight; there are no loops to cut";
    } else if (o->tree == CT_TREE_AUTO && !o->measure_all) {
        int nrow, nu;
        count_weights(b, &p, &nrow, &nu);
        trials->begin(trials->stage, nrow == 0);
        improve(b, &r, trials, &p, report);
        count_from_ground(b, o, trials, &p, report);
    }
    if (o->tree == CT_TREE_AUTO && o->pick && !pick(b, o->pick, &p, report))
        return false;
    if (!ct_tree_from_branches(b->arena, &b->topology->graph, p.trans, &b->T))
        return ct_error(b->ctx, (struct ct_mark){0}, CT_E_TREE,
                        "tree: the translational branches are no spanning tree");
    if (!ct_tree_from_branches(b->arena, &b->topology->graph, p.rot, &b->R))
        return ct_error(b->ctx, (struct ct_mark){0}, CT_E_TREE,
                        "tree: the rotational branches are no spanning tree");
    return true;
}
