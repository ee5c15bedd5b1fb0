// Search for the cheapest pair of spanning trees; see exchange.h and formulation 2.3.
#include "graph/exchange.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TRANS, ROT, NTREE };

struct pair {
    struct ct_tree tree[NTREE];
    int weight;
    double cost;
};

struct search {
    struct ct_arena *a;
    const struct ct_graph *g;
    const int *weight[NTREE], *rank[NTREE];
    bool *forced[NTREE],
        *banned[NTREE]; // own copies: tied edges agree; edges of negative weight are banned
    const bool *tied;   // may be NULL
    int heaviest;       // least weight + excess
    ct_tree_cost cost;
    void *data;
    struct pair best; // cost INFINITY: none yet
    struct ct_search_stats *stats;
};

static bool is_tied(const struct search *s, int e)
{
    return s->tied && s->tied[e];
}

/// Call the cost function and keep the pair if it is the best so far.
static void evaluate(struct search *s, struct pair *p)
{
    p->cost = s->cost(s->data, &p->tree[TRANS], &p->tree[ROT]);
    s->stats->nevaluated++;
    if (p->cost < s->best.cost
        || (p->cost == s->best.cost && p->cost < INFINITY && p->weight < s->best.weight))
        s->best = *p;
}

static bool same_branches(const struct pair *p, const struct pair *q)
{
    const size_t size = (size_t)p->tree[TRANS].nedge * sizeof(bool);
    return memcmp(p->tree[TRANS].is_branch, q->tree[TRANS].is_branch, size) == 0
        && memcmp(p->tree[ROT].is_branch, q->tree[ROT].is_branch, size) == 0;
}

// ---- the least weight pair ----------------------------------------------------------------

/// Copy the rules of tree k.
static void set_rules(struct search *s, int k, const struct ct_tree_rules *rules)
{
    s->weight[k] = rules->weight;
    s->rank[k] = rules->rank;
    s->forced[k] = CT_NEWN(s->a, bool, s->g->nedge);
    s->banned[k] = CT_NEWN(s->a, bool, s->g->nedge);
    for (int e = 0; e < s->g->nedge; e++) {
        s->forced[k][e] = rules->forced && rules->forced[e];
        s->banned[k][e] = rules->weight[e] < 0 || (rules->banned && rules->banned[e]);
    }
}

/// An edge that is tied and forced (or banned) in one tree becomes so in the other.
static void share_rules_of_tied(struct search *s)
{
    for (int e = 0; e < s->g->nedge; e++) {
        if (!is_tied(s, e))
            continue;
        const bool forced = s->forced[TRANS][e] || s->forced[ROT][e];
        const bool banned = s->banned[TRANS][e] || s->banned[ROT][e];
        s->forced[TRANS][e] = s->forced[ROT][e] = forced;
        s->banned[TRANS][e] = s->banned[ROT][e] = banned;
    }
}

static int weight_of(const struct search *s, int k, const bool *is_branch)
{
    int sum = 0;
    for (int e = 0; e < s->g->nedge; e++)
        sum += is_branch[e] ? s->weight[k][e] : 0;
    return sum;
}

/// Least weight tree k with all forced edges and no banned one; false if there is none.
static bool least_tree(struct search *s, int k, struct ct_tree *t)
{
    const int nedge = s->g->nedge;
    int *weight = CT_NEWN(s->a, int, nedge);
    for (int e = 0; e < nedge; e++) // forced edges before all others
        weight[e] = s->banned[k][e] ? -1 : s->forced[k][e] ? 0 : s->weight[k][e] + 1;
    if (!ct_tree_kruskal(s->a, s->g, weight, s->rank[k], t, NULL))
        return false;
    for (int e = 0; e < nedge; e++)
        if (s->forced[k][e] && !t->is_branch[e])
            return false; // forced edges close a circuit, or one is banned too
    return true;
}

/// The first tied edge that is a branch of one tree and a chord of the other, or -1.
static int first_disagreement(const struct search *s, const struct ct_tree *T,
                              const struct ct_tree *R)
{
    for (int e = 0; e < s->g->nedge; e++)
        if (is_tied(s, e) && T->is_branch[e] != R->is_branch[e])
            return e;
    return -1;
}

/// Branch and bound on the tied edges: the least weight pair without (R3) is a lower bound; if
/// it disagrees on a tied edge, that edge is put into both trees, then into neither.
/// least->weight is INT_MAX until a pair is found.
static void settle_tied(struct search *s, struct pair *least)
{
    struct pair p;
    if (!least_tree(s, TRANS, &p.tree[TRANS]) || !least_tree(s, ROT, &p.tree[ROT]))
        return;
    p.weight = weight_of(s, TRANS, p.tree[TRANS].is_branch)
             + weight_of(s, ROT, p.tree[ROT].is_branch);
    if (p.weight >= least->weight)
        return;
    const int e = first_disagreement(s, &p.tree[TRANS], &p.tree[ROT]);
    if (e < 0) {
        *least = p;
        return;
    }
    bool **const rule[] = {s->forced, s->banned};
    for (int i = 0; i < 2; i++) {
        rule[i][TRANS][e] = rule[i][ROT][e] = true;
        settle_tied(s, least);
        rule[i][TRANS][e] = rule[i][ROT][e] = false;
    }
}

// ---- all pairs ----------------------------------------------------------------------------

struct tree_list {
    const struct search *s;
    struct ct_tree *tree;
    size_t n, cap;
};

static bool append_tree(void *data, const bool *is_branch)
{
    struct tree_list *list = data;
    struct ct_tree t;
    if (ct_tree_from_branches(list->s->a, list->s->g, is_branch, &t))
        CT_PUSH(list->s->a, list->tree, list->n, list->cap, t);
    return true;
}

static struct tree_list list_trees(const struct search *s, int k)
{
    struct tree_list list = {.s = s};
    ct_tree_enumerate(s->a, s->g, s->forced[k], s->banned[k], append_tree, &list);
    return list;
}

static void try_all(struct search *s, const struct pair *start)
{
    const struct tree_list T = list_trees(s, TRANS), R = list_trees(s, ROT);
    for (size_t i = 0; i < T.n; i++)
        for (size_t j = 0; j < R.n; j++) {
            struct pair p = {.tree = {T.tree[i], R.tree[j]}};
            p.weight = weight_of(s, TRANS, p.tree[TRANS].is_branch)
                     + weight_of(s, ROT, p.tree[ROT].is_branch);
            if (p.weight <= s->heaviest && !same_branches(&p, start)
                && first_disagreement(s, &p.tree[TRANS], &p.tree[ROT]) < 0)
                evaluate(s, &p);
        }
}

// ---- descent ------------------------------------------------------------------------------

// An exchange in one tree or in both; in[k] = -1: tree k stays.
struct move {
    int in[NTREE], out[NTREE];
    int weight; // of the pair it leads to
    int number; // in the order found
};

struct neighbours {
    struct search *s;
    const struct pair *p;
    struct move *move;
    size_t n, cap;
};

static void add_move(struct neighbours *near, int in_T, int out_T, int in_R, int out_R)
{
    const int *const *w = near->s->weight;
    struct move m = {{in_T, in_R}, {out_T, out_R}, near->p->weight, (int)near->n};
    for (int k = 0; k < NTREE; k++)
        if (m.in[k] >= 0)
            m.weight += w[k][m.in[k]] - w[k][m.out[k]];
    if (m.weight <= near->s->heaviest)
        CT_PUSH(near->s->a, near->move, near->n, near->cap, m);
}

/// Exchanges in R that move the same tied edges as the exchange of chord c for branch b in T: a
/// tied c comes in and a tied b goes out; an untied partner may be any that the circuit offers.
static void add_moves_of_tied(struct neighbours *near, int c, int b)
{
    const struct search *s = near->s;
    const struct ct_tree *R = &near->p->tree[ROT];
    int *branch = CT_NEWN(s->a, int, R->nbranch);
    signed char *sign = CT_NEWN(s->a, signed char, R->nbranch);
    for (int k = 0; k < R->nchord; k++) {
        const int in = R->chord[k];
        if (s->banned[ROT][in] || (is_tied(s, c) ? in != c : is_tied(s, in)))
            continue;
        const int n = ct_tree_circuit(s->g, R, in, branch, sign);
        for (int i = 0; i < n; i++) {
            const int out = branch[i];
            if (!s->forced[ROT][out] && (is_tied(s, b) ? out == b : !is_tied(s, out)))
                add_move(near, c, b, in, out);
        }
    }
}

/// All exchanges of chord c for a branch of its circuit in tree k. Moves of tied edges concern
/// both trees and are found from the first.
static void add_moves_of_chord(struct neighbours *near, int k, int c)
{
    const struct search *s = near->s;
    const struct ct_tree *t = &near->p->tree[k];
    int *branch = CT_NEWN(s->a, int, t->nbranch);
    signed char *sign = CT_NEWN(s->a, signed char, t->nbranch);
    const int n = ct_tree_circuit(s->g, t, c, branch, sign);
    for (int i = 0; i < n; i++) {
        const int b = branch[i];
        if (s->forced[k][b])
            continue;
        if (!is_tied(s, c) && !is_tied(s, b))
            add_move(near, k == TRANS ? c : -1, b, k == ROT ? c : -1, b);
        else if (k == TRANS)
            add_moves_of_tied(near, c, b);
    }
}

static int compare_moves(const void *a, const void *b)
{
    const struct move *x = a, *y = b;
    if (x->weight != y->weight)
        return x->weight < y->weight ? -1 : 1;
    return (x->number > y->number) - (x->number < y->number);
}

/// Moves from p that keep the rules, lightest first, then translation before rotation and by
/// index.
static struct neighbours list_moves(struct search *s, const struct pair *p)
{
    struct neighbours near = {.s = s, .p = p};
    for (int k = 0; k < NTREE; k++)
        for (int i = 0; i < p->tree[k].nchord; i++)
            if (!s->banned[k][p->tree[k].chord[i]])
                add_moves_of_chord(&near, k, p->tree[k].chord[i]);
    if (near.n > 1)
        qsort(near.move, near.n, sizeof *near.move, compare_moves);
    return near;
}

static struct pair moved(const struct search *s, const struct pair *p, const struct move *m)
{
    struct pair q = {.tree = {p->tree[TRANS], p->tree[ROT]}, .weight = m->weight};
    bool *is_branch = CT_NEWN(s->a, bool, s->g->nedge);
    for (int k = 0; k < NTREE; k++) {
        if (m->in[k] < 0)
            continue;
        memcpy(is_branch, p->tree[k].is_branch, (size_t)s->g->nedge * sizeof *is_branch);
        is_branch[m->in[k]] = true;
        is_branch[m->out[k]] = false;
        ct_tree_from_branches(s->a, s->g, is_branch, &q.tree[k]); // an exchange keeps it a tree
    }
    return q;
}

// The pairs evaluated, so that none is evaluated twice.
struct visited {
    struct pair *pair;
    size_t n, cap;
};

static bool was_visited(const struct visited *v, const struct pair *p)
{
    for (size_t i = 0; i < v->n; i++)
        if (same_branches(&v->pair[i], p))
            return true;
    return false;
}

/// Steepest descent: each round evaluates all neighbours of the best pair and goes to a better
/// one.
static void descend(struct search *s, struct pair start, int budget)
{
    struct visited seen = {0};
    CT_PUSH(s->a, seen.pair, seen.n, seen.cap, start);
    for (struct pair here = start;;) {
        const struct neighbours near = list_moves(s, &here);
        for (size_t i = 0; i < near.n; i++) {
            struct pair p = moved(s, &here, &near.move[i]);
            if (was_visited(&seen, &p))
                continue;
            if (s->stats->nevaluated >= budget) {
                s->stats->out_of_budget = true;
                return;
            }
            evaluate(s, &p);
            CT_PUSH(s->a, seen.pair, seen.n, seen.cap, p);
        }
        if (s->best.cost == INFINITY || same_branches(&s->best, &here))
            return;
        here = s->best;
    }
}

// ---- the search ---------------------------------------------------------------------------

static void run(struct search *s, struct pair start, const struct ct_search_options *o)
{
    evaluate(s, &start);
    s->stats->cost_least_weight = start.cost;
    s->stats->exhaustive = s->stats->npair <= o->limit;
    if (s->stats->exhaustive)
        try_all(s, &start);
    else
        descend(s, start, o->budget);
}

bool ct_tree_search(struct ct_arena *a, const struct ct_graph *g,
                    const struct ct_search_options *options, ct_tree_cost cost, void *data,
                    struct ct_tree_pair *best, struct ct_search_stats *stats)
{
    *stats = (struct ct_search_stats){.cost_least_weight = INFINITY, .cost = INFINITY};
    struct search s = {.a = a,
                       .g = g,
                       .tied = options->tied,
                       .cost = cost,
                       .data = data,
                       .best = {.cost = INFINITY},
                       .stats = stats};
    set_rules(&s, TRANS, &options->trans);
    set_rules(&s, ROT, &options->rot);
    share_rules_of_tied(&s);
    stats->npair = ct_tree_count(a, g, s.forced[TRANS], s.banned[TRANS])
                 * ct_tree_count(a, g, s.forced[ROT], s.banned[ROT]);

    struct pair least = {.weight = INT_MAX};
    settle_tied(&s, &least);
    if (least.weight == INT_MAX)
        return false;
    s.heaviest = least.weight + options->excess;
    stats->weight_least = least.weight;
    run(&s, least, options);

    if (s.best.cost == INFINITY)
        return false;
    stats->weight = s.best.weight;
    stats->cost = s.best.cost;
    *best = (struct ct_tree_pair){s.best.tree[TRANS].is_branch, s.best.tree[ROT].is_branch};
    return true;
}
