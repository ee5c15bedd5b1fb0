// The stage that turns a model into equations; tree selection by exact operation counts.
#include "formulate/formulate.h"
#include "base/sort.h"
#include "expr/tape.h"
#include "formulate/dynamics.h"
#include "formulate/open.h"
#include "formulate/residual.h"
#include "formulate/row.h"
#include "formulate/signal.h"
#include "formulate/small.h"
#include "formulate/topology.h"
#include "formulate/validity.h"
#include "graph/exchange.h"
#include "graph/reach.h"

#include <math.h>
#include <string.h>

// ---- one pair of trees ---------------------------------------------------------------------------

static double *start_values(struct ct_arena *a, const struct ct_model *m)
{
    double *v = CT_NEWN(a, double, m->x->nsym + 1);
    for (size_t i = 0; i < m->nparameter; i++)
        v[ct_ex_node(m->x, m->parameter[i].symbol)->a] = m->parameter[i].value;
    return v;
}

static bool starts_deformed(const struct ct_model *m)
{
    for (size_t i = 1; i < m->nbody; i++)
        if (m->body[i].beam && m->body[i].beam->nstart)
            return true;
    return false;
}

// Graph, nodes and edges of the model; trees are still open.
static struct ct_build *build_create(struct ct_ctx *ctx, struct ct_arena *a,
                                     const struct ct_model *m,
                                     const struct ct_formulate_options *o,
                                     const bool *is_linear)
{
    struct ct_build *b = CT_NEW(a, struct ct_build);
    *b = (struct ct_build){.ctx = ctx,
                           .arena = a,
                           .model = m,
                           .is_rigid = o->measure_all && !o->deformed && !starts_deformed(m),
                           .keep_all = o->keep_all,
                           .frees_beams
                           = o->frees_beams || (o->like && o->like->build->frees_beams),
                           .is_held = o->held,
                           .has_gaps = o->gaps,
                           .like = o->like,
                           .is_linear = is_linear};
    b->eqs = CT_NEW(a, struct ct_equations);
    b->x = b->eqs->x = ct_exs_clone(a, m->x);
    b->value = start_values(a, m);
    b->x->ndecided = m->x->nsym;
    b->x->decided = CT_NEWN(a, unsigned char, m->x->nsym + 1);
    ct_topology_derive(b, !o->keep_all);
    return b;
}

// What comes before M and Q: Phi, J, gam and, unless only places and speeds are wanted, the loads.
static bool derive(struct ct_build *b, bool with_dynamics)
{
    const size_t before = b->ctx->nerror;
    ct_unknowns_choose(b);
    b->eqs->Q = CT_NEWN(b->arena, ct_ex, b->eqs->nu + 1);
    ct_rotation_derive(b);
    ct_translation_derive(b);
    ct_rows_derive(b);
    if (with_dynamics)
        ct_loads_derive(b);
    return b->ctx->nerror == before;
}

// ---- cost of a pair ----------------------------------------------------------------------------------

// Graph of a symmetric matrix under elimination.
struct minor {
    size_t n;
    bool *near;     // n x n
    size_t *degree; // neighbours that are left; SIZE_MAX: eliminated
};

static void join(struct minor *g, size_t i, size_t j)
{
    if (i == j || g->near[i + g->n * j])
        return;
    g->near[i + g->n * j] = g->near[j + g->n * i] = true;
    g->degree[i]++;
    g->degree[j]++;
}

static struct minor minor_of(struct ct_arena *scratch, const struct ct_equations *e)
{
    const size_t n = e->nu + e->nrow;
    struct minor g = {n, CT_NEWN(scratch, bool, n *n + 1), CT_NEWN(scratch, size_t, n + 1)};
    for (size_t i = 0; i < e->nM; i++)
        join(&g, (size_t)e->M[i].row, (size_t)e->M[i].column);
    for (size_t i = 0; i < e->nJ; i++)
        join(&g, e->nu + (size_t)e->J[i].row, (size_t)e->J[i].column);
    return g;
}

static size_t least_degree(const struct minor *g)
{
    size_t best = 0;
    for (size_t i = 1; i < g->n; i++)
        if (g->degree[i] < g->degree[best])
            best = i;
    return best;
}

// Operations of a sparse LDL' of [M J'; J 0] by minimum degree on its graph: sum of d^2 + 4 d + 3.
static double factor_cost(struct ct_arena *scratch, const struct ct_equations *e)
{
    const size_t n = e->nu + e->nrow;
    if (n > 4000) // the table would be larger than what it is for
        return (double)n * (double)n * (double)n / 3;
    struct minor g = minor_of(scratch, e);
    double cost = 0;
    size_t *list = CT_NEWN(scratch, size_t, n + 1);
    for (size_t step = 0; step < n; step++) {
        const size_t best = least_degree(&g);
        size_t d = 0;
        for (size_t j = 0; j < n; j++)
            if (g.near[j + n * best] && g.degree[j] != SIZE_MAX) {
                list[d++] = j;
                g.degree[j]--;
            }
        g.degree[best] = SIZE_MAX;
        for (size_t i = 0; i < d; i++)
            for (size_t j = 0; j < i; j++)
                join(&g, list[i], list[j]);
        cost += (double)(d * d + 4 * d + 3);
    }
    return cost;
}

static double equations_cost(struct ct_arena *scratch, const struct ct_equations *e)
{
    const size_t n = e->nM + e->nu + e->nJ + e->nrow;
    ct_ex *all = CT_NEWN(scratch, ct_ex, n + 1);
    size_t k = 0;
    for (size_t i = 0; i < e->nM; i++)
        all[k++] = e->M[i].value;
    for (size_t i = 0; i < e->nu; i++)
        all[k++] = e->Q[i];
    for (size_t i = 0; i < e->nJ; i++)
        all[k++] = e->J[i].value;
    for (size_t i = 0; i < e->nrow; i++)
        all[k++] = e->row[i].gam;
    const struct ct_tape_counts c = ct_ex_count(scratch, e->x, all, k);
    const double per_speed = 20; // in multiplications
    return ct_counted_cost(&c) + per_speed * (double)e->nu + factor_cost(scratch, e);
}

struct search {
    struct ct_ctx *ctx;
    const struct ct_model *model;
    const struct ct_formulate_options *options;
    struct ct_arena *owner; // of trial generations
    bool stays_open;        // there is a pair without rows, and none with rows is wanted
};

// The exact count of a trial generation; nothing of it is kept.
static double pair_cost(void *data, const struct ct_tree *T, const struct ct_tree *R)
{
    const struct search *s = data;
    struct ct_arena *scratch = ct_arena_create_under(s->owner);
    struct ct_ctx quiet
        = {.model = scratch, .scratch = scratch}; // errors are reported by the chosen pair
    struct ct_build *b = build_create(&quiet, scratch, s->model, s->options, NULL);
    b->T = *T;
    b->R = *R;
    double cost = INFINITY;
    if (derive(b, true) && !(s->stays_open && b->eqs->nrow)) {
        ct_dynamics_derive(b);
        cost = equations_cost(scratch, b->eqs);
    }
    ct_arena_destroy(scratch);
    return cost;
}

// ---- rules for trees -----------------------------------------------------------------------------------

struct rules {
    int *weight_t, *weight_r, *rank; // weight -1: before all others that are not forced
    bool *forced_t, *forced_r, *banned_t, *banned_r, *tied;
};

// Distance of each node from ground over edges that can be branches: in edges, or in rotational freedoms.
static int *node_depths(struct ct_build *b, bool by_rotation)
{
    int *depth = CT_NEWN(b->arena, int, b->nnode), *length = CT_NEWN(b->arena, int, b->nedge);
    bool *usable = CT_NEWN(b->arena, bool, b->nedge);
    for (size_t e = 0; e < b->nedge; e++) {
        usable[e] = b->edge[e].kind != CT_EDGE_BODY && !b->edge[e].never_branch;
        length[e] = by_rotation ? b->edge[e].weight_r : 1;
    }
    ct_graph_distances(b->arena, &b->graph, usable, length, (int)b->nnode * CT_MAX_COORD,
                       depth);
    return depth;
}

// A coordinate that carries an effort, a spring or a driver is best a branch of its own.
static bool is_active(const struct ct_instance *joint)
{
    static const char *const keys[] = {"stiffness", "damping", "effort", "motion"};
    for (size_t i = 0; i < COUNT(keys) && joint->cls->motion; i++)
        if (ct_instance_value(joint, keys[i])->given)
            return true;
    return false;
}

// Order among equal weights. In a plane the angle of a body weighs as much as that of a joint and gives
// shorter expressions; a passive joint on a body that turns yields to it.  (2.3)
static int tie_rank(const struct ct_build *b, size_t i, const int *depth, const int *turned,
                    enum ct_tree_choice choice)
{
    const struct ct_edge_info *e = &b->edge[i];
    const int tail = b->wiring[i].tail, head = b->wiring[i].head, last = 2 * (int)b->nedge;
    if (e->kind == CT_EDGE_ARM)
        return -1;
    if (e->kind == CT_EDGE_BODY)
        return b->is_planar && choice == CT_TREE_AUTO ? 1 : last;
    const bool is_first_turn = turned[tail] == 0 || turned[head] == 0;
    if (is_first_turn || (e->kind == CT_EDGE_JOINT && is_active(e->self)))
        return 0;
    return 2 + (depth[tail] < depth[head] ? depth[tail] : depth[head]);
}

static int order_names(const void *build, const void *left, const void *right)
{
    const struct ct_build *b = build;
    const int *i = left, *k = right;
    return strcmp(b->edge[*i].name, b->edge[*k].name);
}

// Equal ranks in the order of names: the trees of assembly, and with them the assembly found where there
// are several, do not depend on the order of the file.
static void rank_by_name(const struct ct_build *b, int *rank)
{
    const int n = (int)b->nedge;
    int *sorted = CT_NEWN(b->arena, int, n + 1), place = 0;
    for (int i = 0; i < n; i++)
        sorted[i] = i;
    ct_sort(b->arena, sorted, b->nedge, sizeof *sorted, order_names, b);
    for (int k = 0; k < n; k++) { // place: how many names come before
        if (k && order_names(b, &sorted[k - 1], &sorted[k]) != 0)
            place = k;
        rank[sorted[k]] = n * (rank[sorted[k]] + 1) + place;
    }
}

// Arms are branches, force drivers chords (R1, R2); shared coordinates tie a joint (R3). Ties go to
// joints nearer to ground.
static struct rules make_rules(struct ct_build *b, const struct ct_formulate_options *o)
{
    const enum ct_tree_choice choice = o->tree;
    const size_t n = b->nedge;
    struct rules r = {.weight_t = CT_NEWN(b->arena, int, n),
                      .weight_r = CT_NEWN(b->arena, int, n),
                      .rank = CT_NEWN(b->arena, int, n),
                      .forced_t = CT_NEWN(b->arena, bool, n),
                      .forced_r = CT_NEWN(b->arena, bool, n),
                      .banned_t = CT_NEWN(b->arena, bool, n),
                      .banned_r = CT_NEWN(b->arena, bool, n),
                      .tied = CT_NEWN(b->arena, bool, n)};
    const int *depth = node_depths(b, false), *turned = node_depths(b, true);
    for (size_t i = 0; i < n; i++) {
        const struct ct_edge_info *e = &b->edge[i];
        const bool is_body = e->kind == CT_EDGE_BODY;
        const bool is_particle = is_body && b->model->body[e->index].is_particle;
        const bool dear = choice == CT_TREE_ABSOLUTE ? !is_body : is_body;
        const int extra = choice != CT_TREE_AUTO && dear && !e->must_be_branch ? 100 : 0;
        r.weight_t[i] = e->weight_t + extra;
        r.weight_r[i] = e->weight_r + extra;
        if (o->first && e->kind == CT_EDGE_JOINT && o->first[e->index])
            r.weight_t[i] = r.weight_r[i] = -1;
        r.rank[i] = tie_rank(b, i, depth, turned, choice);
        const bool is_small = e->kind == CT_EDGE_JOINT && ct_small_joint(b, e->index);
        r.forced_t[i] = e->must_be_branch || is_small;
        r.forced_r[i] = e->must_be_branch || is_particle || (is_small && e->has_rotation);
        r.banned_t[i] = e->never_branch;
        r.banned_r[i] = e->never_branch || !e->has_rotation;
        r.tied[i] = e->must_be_branch;
        if (is_particle)
            r.weight_r[i] = 0;
    }
    if (choice == CT_TREE_JOINTS)
        rank_by_name(b, r.rank);
    return r;
}

// Is every chord of the least-weight trees a body edge, a force or a rod? Then there is no loop to cut.
static bool is_open(const struct ct_build *b, const struct ct_tree_pair *p)
{
    for (size_t i = 0; i < b->nedge; i++) {
        const enum ct_edge_kind kind = b->edge[i].kind;
        if ((kind == CT_EDGE_JOINT || kind == CT_EDGE_CLOSURE) && !b->edge[i].never_branch
            && (!p->trans[i] || (b->edge[i].has_rotation && !p->rot[i]))
            && b->edge[i].trial.quaternion != 3)
            return false;
    }
    return true;
}

// Rows that the chords leave, and unknowns, by (2.1).
static void count_weights(const struct ct_build *b, const struct ct_tree_pair *p, int *nrow,
                          int *nu)
{
    const int directions[2] = {b->is_planar ? 2 : 3, b->is_planar ? 1 : 3};
    *nrow = *nu = 0;
    for (size_t i = 0; i < b->nedge; i++) {
        const struct ct_edge_info *e = &b->edge[i];
        const bool is_joint = e->kind == CT_EDGE_JOINT || e->kind == CT_EDGE_CLOSURE;
        const int weight[2] = {e->weight_t, e->weight_r};
        const bool branch[2] = {p->trans[i], p->rot[i] || !e->has_rotation};
        for (int k = 0; k < 2; k++) {
            *nu += branch[k] ? weight[k] : 0;
            *nrow += is_joint && !branch[k] ? directions[k] - weight[k] : 0;
        }
    }
}

// In a plane angles are chosen from ground even in open chains, and joints are then chords without rows. For a long
// chain there is nothing to gain by a search, whose trials would need its mass matrix.
static bool is_long_chain(const struct ct_build *b, const struct ct_tree_pair *p)
{
    int nrow, nu;
    count_weights(b, p, &nrow, &nu);
    return nrow == 0 && nu > CT_SMALL_SYSTEM;
}

static bool least_weight(struct ct_build *b, const struct rules *r, struct ct_tree_pair *p)
{
    int *w = CT_NEWN(b->arena, int, b->nedge);
    struct ct_tree t;
    bool **out[] = {&p->trans, &p->rot};
    for (int k = 0; k < 2; k++) {
        const bool *forced = k ? r->forced_r : r->forced_t,
                   *banned = k ? r->banned_r : r->banned_t;
        const int *weight = k ? r->weight_r : r->weight_t;
        for (size_t i = 0; i < b->nedge; i++)
            w[i] = banned[i] ? -1 : forced[i] ? 0 : weight[i] + 2;
        if (!ct_tree_kruskal(b->arena, &b->graph, w, r->rank, &t, NULL))
            return ct_error(b->ctx, (struct ct_mark){0}, CT_E_TREE,
                            "the model's graph has no spanning tree");
        *out[k] = t.is_branch;
    }
    return true;
}

// Work of the search is bounded by nodes generated, not by time: same model, same tree.
static const double search_nodes = 600000;
// Fewer pairs than these are not worth their time: exchanges seldom find a cheaper one among so few.
static const double fewest_pairs = 16;

static void improve(struct ct_build *b, const struct search *s, const struct rules *r,
                    struct ct_tree_pair *p, struct ct_tree_report *report)
{
    struct ct_tree T, R;
    struct ct_search_stats stats;
    ct_tree_from_branches(b->arena, &b->graph, p->trans, &T);
    ct_tree_from_branches(b->arena, &b->graph, p->rot, &R);
    const double cost = pair_cost((void *)(uintptr_t)s, &T, &R);
    const double pairs = floor(search_nodes / fmax(cost, 100));
    const struct ct_search_options o
        = {.trans = {r->weight_t, r->rank, r->forced_t, r->banned_t},
           .rot = {r->weight_r, r->rank, r->forced_r, r->banned_r},
           .tied = r->tied,
           .limit = pairs < 1 ? -1 : fmin(pairs, 2000),
           .budget = (int)fmax(1, fmin(pairs, 400)),
           .excess = 2};
    if (pairs < fewest_pairs
        || !ct_tree_search(b->arena, &b->graph, &o, pair_cost, (void *)(uintptr_t)s, p,
                           &stats)) {
        report->how = "least weight";
        report->cost = report->cost_least_weight = cost;
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
    const char **names = CT_NEWN(b->arena, const char *, b->nedge);
    size_t n = 0;
    for (size_t i = 0; i < b->nedge; i++)
        if (b->edge[i].kind != CT_EDGE_ARM)
            names[n++] = b->edge[i].name;
    const char *near = ct_nearest(name, names, n);
    return near ? ct_arena_printf(b->arena, "; did you mean '%s'?", near) : "";
}

static bool mark_named(struct ct_build *b, const char *const *names, const struct ct_mark *mark,
                       size_t n, const bool *forced, bool *branch)
{
    memcpy(branch, forced, b->nedge * sizeof *branch);
    bool ok = true;
    for (size_t k = 0; k < n; k++) {
        size_t i = 0;
        while (i < b->nedge && strcmp(b->edge[i].name, names[k]) != 0)
            i++;
        if (i == b->nedge)
            ok = ct_error(b->ctx, mark ? mark[k] : (struct ct_mark){0}, CT_E_TREE,
                          "tree: there is no edge '%s'%s", names[k], near_edge(b, names[k]));
        else
            branch[i] = true;
    }
    return ok;
}

static bool given_trees(struct ct_build *b, const struct ct_formulate_options *o,
                        const struct rules *r, struct ct_tree_pair *p)
{
    p->trans = CT_NEWN(b->arena, bool, b->nedge);
    p->rot = CT_NEWN(b->arena, bool, b->nedge);
    if (!mark_named(b, o->trans, o->trans_mark, o->ntrans, r->forced_t, p->trans)
        || !mark_named(b, o->rot, o->rot_mark, o->nrot, r->forced_r, p->rot))
        return false;
    bool ok = true;
    for (size_t i = 0; i < b->nedge; i++)
        if ((p->trans[i] && r->banned_t[i]) || (p->rot[i] && r->banned_r[i]))
            ok = ct_error(b->ctx, (struct ct_mark){0}, CT_E_TREE,
                          "tree: '%s' cannot be a branch", b->edge[i].name);
    return ok;
}

// Unknowns of a body: those of its joint are as many at least.
static double own_unknowns(const struct ct_build *b, size_t body)
{
    const struct ct_beam *beam = b->model->body[body].beam;
    return 1 + (beam ? 6. * beam->nelement : 0);
}

// Entries of the mass matrix between different bodies, roughly: each body against all that carry it in the tree.
static double coupling(struct ct_build *b, const bool *branch)
{
    struct ct_tree t;
    ct_tree_from_branches(b->arena, &b->graph, branch, &t);
    double *inboard = CT_NEWN(b->ctx->scratch, double, b->nnode), sum = 0;
    for (size_t k = 0; k < b->nnode; k++) { // in the order from ground
        const int v = t.order[k], from = t.parent[v];
        if (from < 0)
            continue;
        const int body = b->node[v].body;
        const bool enters = body > 0 && b->node[from].body != body;
        const double own = enters ? own_unknowns(b, (size_t)body) : 0;
        sum += own * inboard[from];
        inboard[v] = inboard[from] + own;
    }
    return sum;
}

// Long chains of many unknowns: with each body counted from its neighbour the mass matrix is full, with each counted from
// ground it is not. The rows of the joints are sparse either way.
static enum ct_tree_choice choose_for_analysis(struct ct_build *b,
                                               const struct ct_formulate_options *o,
                                               const struct ct_tree_pair *p)
{
    const double most = 400; // for each unknown
    double n = 0;
    for (size_t i = 1; i < b->model->nbody; i++)
        n += own_unknowns(b, i);
    if (!o->for_analysis || o->tree != CT_TREE_AUTO || n <= CT_MOST_DENSE
        || (coupling(b, p->trans) <= most * n && coupling(b, p->rot) <= most * n))
        return o->tree;
    return CT_TREE_ABSOLUTE;
}

// Trees in which each body is counted from ground.
static bool absolute_trees(struct ct_build *b, const struct ct_formulate_options *o,
                           struct ct_tree_pair *p)
{
    struct ct_formulate_options from_ground = *o;
    from_ground.tree = CT_TREE_ABSOLUTE;
    const struct rules absolute = make_rules(b, &from_ground);
    return least_weight(b, &absolute, p);
}

// Has it loops of several beams whose motion does not depend on the trees?
static bool has_loops_of_beams(const struct ct_build *b)
{
    for (size_t i = 0; i < b->nflexible; i++) {
        const enum ct_beam_formulation f = b->flexible[i].beam->formulation;
        if (f == CT_BEAM_FORCE_ONLY || f == CT_BEAM_STRETCH_LINEAR)
            return false;
    }
    return b->nflexible > 1;
}

// Through joints, what beams in loops move fills the mass matrix, and their rows it reaches; counted from ground there are
// more unknowns and rows, which all stay sparse. That is taken where it promises a tenth less by its count.
static void count_from_ground(struct ct_build *b, const struct search *s,
                              struct ct_tree_pair *p, struct ct_tree_report *report)
{
    const double clearly = 0.9;
    struct ct_tree_pair q;
    struct ct_tree T, R;
    if (!has_loops_of_beams(b) || !absolute_trees(b, s->options, &q))
        return;
    ct_tree_from_branches(b->arena, &b->graph, q.trans, &T);
    ct_tree_from_branches(b->arena, &b->graph, q.rot, &R);
    const double cost = pair_cost((void *)(uintptr_t)s, &T, &R);
    if (!(cost < clearly * report->cost))
        return;
    *p = q;
    report->cost = cost;
    report->how
        = "absolute coordinates: through the joints the beams would fill the mass matrix";
}

static bool choose_trees(struct ct_build *b, const struct search *s,
                         struct ct_tree_report *report)
{
    const struct ct_formulate_options *o = s->options;
    const struct rules r = make_rules(b, o);
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
        struct search of_trees = *s;
        int nrow, nu;
        count_weights(b, &p, &nrow, &nu);
        of_trees.stays_open = nrow == 0;
        improve(b, &of_trees, &r, &p, report);
        count_from_ground(b, &of_trees, &p, report);
    }
    if (!ct_tree_from_branches(b->arena, &b->graph, p.trans, &b->T))
        return ct_error(b->ctx, (struct ct_mark){0}, CT_E_TREE,
                        "tree: the translational branches are no spanning tree");
    if (!ct_tree_from_branches(b->arena, &b->graph, p.rot, &b->R))
        return ct_error(b->ctx, (struct ct_mark){0}, CT_E_TREE,
                        "tree: the rotational branches are no spanning tree");
    return true;
}

// ---- the stage -------------------------------------------------------------------------------------------

static const char *kind_name(const struct ct_build *b, size_t i)
{
    const struct ct_edge_info *e = &b->edge[i];
    static const char *const plain[] = {"body", "arm", "joint", "closure", "force"};
    return e->self                            ? e->self->cls->name
         : b->edge[i].kind == CT_EDGE_CLOSURE ? "weld"
         : b->edge[i].flexible                ? "flexible arm"
                                              : plain[e->kind];
}

static void describe_graph(struct ct_build *b)
{
    struct ct_equations *e = b->eqs;
    const char **node = CT_NEWN(b->arena, const char *, b->nnode);
    const char **edge = CT_NEWN(b->arena, const char *, b->nedge + 1);
    const char **kind = CT_NEWN(b->arena, const char *, b->nedge + 1);
    int *wt = CT_NEWN(b->arena, int, b->nedge + 1), *wr = CT_NEWN(b->arena, int, b->nedge + 1);
    for (size_t i = 0; i < b->nnode; i++)
        node[i] = b->node[i].name;
    for (size_t i = 0; i < b->nedge; i++) {
        edge[i] = b->edge[i].name;
        kind[i] = kind_name(b, i);
        wt[i] = b->edge[i].weight_t;
        wr[i] = b->edge[i].weight_r;
    }
    e->graph = &b->graph;
    e->T = &b->T;
    e->R = &b->R;
    e->node_name = node;
    e->edge_name = edge;
    e->edge_kind = kind;
    e->weight_t = wt;
    e->weight_r = wr;
}

// Coordinates of all joints and bodies and their speeds, measured or not, in a fixed order.
static void measure_all(struct ct_build *b, const struct ct_equations *needed_by)
{
    for (size_t i = 0; i < b->ncoordinate; i++) {
        const struct ct_coordinate *c = &b->coordinate[i];
        struct ct_result q = {c->name, CT_EX_ZERO, false}, u = q;
        if (!needed_by || b->edge[c->edge].kind != CT_EDGE_BODY || c->q >= 0
            || needed_by->coordinate[i].q >= 0) {
            q.value = ct_coordinate_value(b, (int)i);
            u.value = ct_coordinate_speed(b, (int)i);
        }
        CT_PUSH(b->arena, b->eqs->result, b->eqs->nresult, b->eqs->result_cap, q);
        CT_PUSH(b->arena, b->eqs->result, b->eqs->nresult, b->eqs->result_cap, u);
    }
}

static void derive_dynamics(struct ct_build *b, const struct ct_formulate_options *o)
{
    b->eqs->is_analysed
        = o->for_analysis && b->eqs->nu > CT_MOST_DENSE && !ct_small_is_wanted(b);
    if (b->eqs->is_analysed) {
        ct_masses_lump(b); // for energies and rows
        return;
    }
    if (o->with_solution && !b->eqs->nrow && b->eqs->nu) {
        ct_open_solve(b, o->formulation);
        return;
    }
    ct_dynamics_derive(b);
}

// Beams that leave their formulation to the program: what is known of their motion decides, and those that stay linear
// make a new build on the same trees.
static bool choose_beams(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *m,
                         const struct ct_formulate_options *o, struct ct_build **b)
{
    struct ct_build *old = *b;
    const bool *linear = o->like || o->measure_all ? NULL : ct_validity_choose(old);
    bool any = false;
    for (size_t i = 0; linear && i < m->nbody; i++)
        any = any || linear[i];
    if (!any)
        return true;
    *b = build_create(ctx, a, m, o, linear);
    (*b)->T = old->T;
    (*b)->R = old->R;
    for (size_t i = 0; i < old->nflexible; i++) {
        struct ct_flexible *f = &(*b)->flexible[i];
        f->why = old->flexible[i].why;
        if (f->beam->formulation == CT_BEAM_AUTO && f->formulation == CT_BEAM_LINEAR)
            ct_topology_left_out(*b, ct_arena_printf(a, "foreshortening of %s", f->name),
                                 f->why);
    }
    return derive(*b, !o->without_dynamics);
}

bool ct_formulate(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *m,
                  const struct ct_formulate_options *options, struct ct_equations *out,
                  struct ct_tree_report *report)
{
    const size_t before = ctx->nerror;
    struct ct_build *b = build_create(ctx, a, m, options, NULL);
    struct search s = {ctx, m, options, a};
    *report = (struct ct_tree_report){0};
    if (ctx->nerror > before || !choose_trees(b, &s, report)
        || !derive(b, !options->without_dynamics) || !choose_beams(ctx, a, m, options, &b))
        return false;
    if (!options->without_dynamics)
        derive_dynamics(b, options);
    if (ctx->nerror > before)
        return false;
    if (options->with_residual)
        ct_residual_derive(b, CT_SLOPES_AUTO);
    if (options->with_energy)
        ct_energies_derive(b);
    if (options->measure_all)
        measure_all(b, options->measured_for);
    else if (options->with_outputs
             && (!ct_outputs_derive(b) || !ct_outputs_add(b, options->more)))
        return false;
    if (options->with_energy)
        ct_validity_monitor(b);
    describe_graph(b);
    b->eqs->coordinate = b->coordinate;
    b->eqs->ncoordinate = b->ncoordinate;
    b->eqs->build = b;
    b->eqs->how = report->how;
    *out = *b->eqs;
    return true;
}

void ct_formulate_dynamics(struct ct_equations *e)
{
    if (e->has_dynamics)
        return;
    ct_dynamics_derive(e->build);
    const struct ct_equations *made = e->build->eqs;
    e->M = made->M;
    e->nM = made->nM;
    e->M_cap = made->M_cap;
    e->has_dynamics = true;
    e->is_analysed = e->build->eqs->is_analysed = false;
}

void ct_formulate_residual(struct ct_equations *e)
{
    if (!e->residual || !e->residual->has_slopes)
        ct_residual_derive(e->build, CT_SLOPES_AUTO);
    e->residual = e->build->eqs->residual;
}

void ct_formulate_rows(struct ct_equations *e)
{
    ct_residual_rows(e->build);
    e->residual = e->build->eqs->residual;
}
