// The search for a pair of trees (section 2.3) against brute force over all edge subsets.
#include "graph/exchange.h"

#include "random_graph.h"

#include <math.h>

// ---- a slider-crank, bodies as nodes: m inertia, h pin, s slider; weights of the joints ------

enum { m1, m2, m3, h1, h2, h3, s4 };
static const struct ct_edge crank_edge[]
    = {{0, 1}, {0, 2}, {0, 3}, {0, 1}, {1, 2}, {2, 3}, {3, 0}};
static const struct ct_graph crank = {4, 7, crank_edge};
static const int crank_trans[] = {2, 2, 2, 0, 0, 0, 1}, crank_rot[] = {1, 1, 1, 1, 1, 1, 0};

// ---- what the cost functions see ----------------------------------------------------------

enum cost_kind {
    COST_ONE,    // the same for all
    COST_HASH,   // no structure at all: only trying every pair finds the best
    COST_LINEAR, // a sum over branches: descent finds the best (graphic matroid)
    COST_PATHS,  // sum of depths of all nodes, and of weights
    COST_NEVER,  // INFINITY
    COST_NAN,
};

struct watch {
    enum cost_kind kind;
    const struct ct_search_options *o;
    const struct ct_graph *g;
    const int *price[2]; // of COST_LINEAR
    int ncall, weight_least, nleast;
};

static int side_weight(const struct ct_tree_rules *rules, const struct ct_tree *t)
{
    int sum = 0;
    for (int i = 0; i < t->nbranch; i++)
        sum += rules->weight[t->branch[i]];
    return sum;
}

static bool keeps_rules(const struct ct_tree_rules *rules, const struct ct_tree *t)
{
    for (int e = 0; e < t->nedge; e++) {
        if (t->is_branch[e] && (rules->weight[e] < 0 || (rules->banned && rules->banned[e])))
            return false;
        if (!t->is_branch[e] && rules->forced && rules->forced[e])
            return false;
    }
    return true;
}

static bool keeps_ties(const bool *tied, const struct ct_tree *T, const struct ct_tree *R)
{
    for (int e = 0; tied && e < T->nedge; e++)
        if (tied[e] && T->is_branch[e] != R->is_branch[e])
            return false;
    return true;
}

static double hash_cost(const struct ct_tree *T, const struct ct_tree *R)
{
    uint64_t h = 1469598103934665603u;
    for (int e = 0; e < T->nedge; e++)
        h = (h ^ (uint64_t)(T->is_branch[e] + 2 * R->is_branch[e])) * 1099511628211u;
    return (double)((h >> 32) % 1000);
}

static double price_of(const struct watch *w, const struct ct_tree *T, const struct ct_tree *R)
{
    double sum = 0;
    for (int i = 0; i < T->nbranch; i++)
        sum += w->price[0][T->branch[i]] + w->price[1][R->branch[i]];
    return sum;
}

static double path_cost(const struct watch *w, const struct ct_tree *T, const struct ct_tree *R)
{
    double sum = 10.0 * (side_weight(&w->o->trans, T) + side_weight(&w->o->rot, R));
    for (int v = 0; v < T->nnode; v++)
        sum += T->depth[v] + 2 * R->depth[v];
    return sum;
}

static double cost_of(const struct watch *w, const struct ct_tree *T, const struct ct_tree *R)
{
    switch (w->kind) {
    case COST_ONE:
        return 1;
    case COST_HASH:
        return hash_cost(T, R);
    case COST_LINEAR:
        return price_of(w, T, R);
    case COST_PATHS:
        return path_cost(w, T, R);
    case COST_NEVER:
        return INFINITY;
    case COST_NAN:
        return NAN;
    }
    return 0;
}

/// The callback: every pair tried must be a pair of trees that keeps all rules.
static double watched_cost(void *data, const struct ct_tree *T, const struct ct_tree *R)
{
    struct watch *w = data;
    assert_null(ct_tree_check(w->g, T));
    assert_null(ct_tree_check(w->g, R));
    assert_true(keeps_rules(&w->o->trans, T) && keeps_rules(&w->o->rot, R));
    assert_true(keeps_ties(w->o->tied, T, R));
    const int weight = side_weight(&w->o->trans, T) + side_weight(&w->o->rot, R);
    if (w->ncall++ == 0)
        w->weight_least = weight; // the least weight pair comes first
    w->nleast += weight == w->weight_least;
    assert_in_range(weight, w->weight_least,
                    w->weight_least + (w->o->excess ? w->o->excess : 3));
    return cost_of(w, T, R);
}

static bool search(struct watch *w, struct ct_tree_pair *best, struct ct_search_stats *stats)
{
    const bool found = ct_tree_search(arena, w->g, w->o, watched_cost, w, best, stats);
    assert_int_equal(stats->nevaluated, w->ncall);
    if (w->ncall)
        assert_int_equal(stats->weight_least, w->weight_least);
    return found;
}

// ---- brute force: every subset of edges ---------------------------------------------------

struct reference {
    int ntree[2];
    struct ct_tree *tree[2];
    int least;   // total weight, INT_MAX if there is no pair
    double cost; // best within the excess
    int weight;  // least weight of the pairs of best cost
};

static int list_all(const struct watch *w, const struct ct_tree_rules *rules,
                    struct ct_tree *list)
{
    bool *in = CT_NEWN(arena, bool, w->g->nedge);
    int n = 0;
    for (unsigned set = 0; set < 1u << w->g->nedge; set++) {
        for (int e = 0; e < w->g->nedge; e++)
            in[e] = set >> e & 1;
        n += ct_tree_from_branches(arena, w->g, in, &list[n]) && keeps_rules(rules, &list[n]);
    }
    return n;
}

static struct reference brute_force(const struct watch *w)
{
    struct reference r = {.least = INT32_MAX, .cost = INFINITY};
    const struct ct_tree_rules *rules[] = {&w->o->trans, &w->o->rot};
    for (int k = 0; k < 2; k++) {
        r.tree[k] = CT_NEWN(arena, struct ct_tree, 1u << w->g->nedge);
        r.ntree[k] = list_all(w, rules[k], r.tree[k]);
    }
    for (int pass = 0; pass < 2; pass++) // first the least weight, then the cost
        for (int i = 0; i < r.ntree[0]; i++)
            for (int j = 0; j < r.ntree[1]; j++) {
                const struct ct_tree *T = &r.tree[0][i], *R = &r.tree[1][j];
                const int weight = side_weight(rules[0], T) + side_weight(rules[1], R);
                if (!keeps_ties(w->o->tied, T, R))
                    continue;
                if (pass == 0) {
                    r.least = weight < r.least ? weight : r.least;
                } else if (weight <= r.least + (w->o->excess ? w->o->excess : 3)) {
                    const double c = cost_of(w, T, R);
                    if (c < r.cost || (c == r.cost && weight < r.weight)) {
                        r.cost = c;
                        r.weight = weight;
                    }
                }
            }
    return r;
}

static bool *random_flags(int n, int one_in)
{
    bool *b = CT_NEWN(arena, bool, n);
    for (int i = 0; i < n; i++)
        b[i] = draw(one_in) == 0;
    return b;
}

// ---- tests --------------------------------------------------------------------------------

static void slider_crank_has_441_pairs_8_of_least_weight(void **state)
{
    (void)state;
    const struct ct_search_options o = {.trans = {.weight = crank_trans},
                                        .rot = {.weight = crank_rot},
                                        .limit = 500,
                                        .budget = 200,
                                        .excess = 3};
    struct watch w = {.kind = COST_ONE, .o = &o, .g = &crank};
    struct ct_tree_pair best;
    struct ct_search_stats stats;
    assert_true(search(&w, &best, &stats));
    assert_true(stats.exhaustive && stats.npair == 441);
    assert_int_equal(stats.weight_least, 2);
    assert_int_equal(w.nleast, 8);
    assert_int_equal(stats.weight, 2); // all cost the same: the least weight pair stays
}

static void slider_crank_descent_finds_the_best_of_all(void **state)
{
    (void)state;
    struct ct_search_options o = {.trans = {.weight = crank_trans},
                                  .rot = {.weight = crank_rot},
                                  .limit = 500,
                                  .budget = 200,
                                  .excess = 3};
    struct watch all = {.kind = COST_PATHS, .o = &o, .g = &crank}, some = all;
    struct ct_tree_pair best;
    struct ct_search_stats stats, descent;
    assert_true(search(&all, &best, &stats));
    o.limit = 0;
    assert_true(search(&some, &best, &descent));
    assert_false(descent.exhaustive);
    assert_true(descent.cost == stats.cost && descent.weight == stats.weight);
    assert_true(descent.nevaluated < stats.nevaluated);
}

static void exhaustive_search_finds_the_optimum(void **state)
{
    (void)state;
    start_random();
    for (int n = 0; n < 200; n++) {
        const struct ct_graph g = random_graph(5, 4);
        const struct ct_search_options o = {
            .trans = {.weight = random_weights(g.nedge, 4), .banned = random_flags(g.nedge, 9)},
            .rot = {.weight = random_weights(g.nedge, 4), .forced = random_flags(g.nedge, 7)},
            .tied = random_flags(g.nedge, 4),
            .limit = 1e9,
            .excess = 1 + draw(6),
        };
        struct watch w = {.kind = COST_HASH, .o = &o, .g = &g};
        const struct reference want = brute_force(&w);
        struct ct_tree_pair best;
        struct ct_search_stats stats;
        assert_int_equal(search(&w, &best, &stats), want.least < INT32_MAX);
        if (want.least == INT32_MAX) {
            assert_int_equal(stats.nevaluated, 0);
            continue;
        }
        assert_int_equal(stats.weight_least, want.least);
        assert_true(stats.cost == want.cost);
        assert_int_equal(stats.weight, want.weight);
    }
}

static void descent_finds_the_optimum_of_a_sum(void **state)
{
    (void)state;
    start_random();
    for (int n = 0; n < 100; n++) {
        const struct ct_graph g = random_graph(6, 4);
        const struct ct_search_options o = {
            .trans = {.weight = random_weights(g.nedge, 4)},
            .rot = {.weight = random_weights(g.nedge, 4)},
            .limit = 0,
            .budget = 100000,
            .excess = 1000,
        };
        struct watch w = {.kind = COST_LINEAR,
                          .o = &o,
                          .g = &g,
                          .price = {random_weights(g.nedge, 50), random_weights(g.nedge, 50)}};
        const struct reference want = brute_force(&w);
        struct ct_tree_pair best;
        struct ct_search_stats stats;
        assert_true(search(&w, &best, &stats));
        assert_true(stats.cost == want.cost);
        assert_false(stats.out_of_budget);
    }
}

static void descent_keeps_the_rules(void **state)
{
    (void)state;
    start_random();
    int nmoved = 0; // searches that left the first pair by an exchange of tied edges
    for (int n = 0; n < 200; n++) {
        const struct ct_graph g = random_graph(8, 8);
        const struct ct_search_options o = {
            .trans = {.weight = random_weights(g.nedge, 4), .banned = random_flags(g.nedge, 9)},
            .rot = {.weight = random_weights(g.nedge, 4), .forced = random_flags(g.nedge, 9)},
            .tied = random_flags(g.nedge, 3),
            .limit = 0,
            .budget = 200,
            .excess = 5,
        };
        struct watch w = {.kind = COST_HASH, .o = &o, .g = &g};
        struct ct_tree_pair best;
        struct ct_search_stats stats;
        if (!search(&w, &best, &stats))
            continue;
        struct ct_search_options only = o; // a budget of one stays at the first pair
        only.budget = 1;
        struct watch first = {.kind = COST_HASH, .o = &only, .g = &g};
        struct ct_tree_pair start;
        assert_true(search(&first, &start, &stats));
        for (int e = 0; e < g.nedge; e++)
            if (o.tied[e] && best.trans[e] != start.trans[e]) {
                nmoved++;
                break;
            }
    }
    assert_true(nmoved > 10);
}

static void budget_is_respected(void **state)
{
    (void)state;
    start_random();
    for (int budget = 1; budget < 40; budget++) {
        struct ct_graph g = random_graph(30, 20);
        while (ct_tree_count(arena, &g, NULL, NULL) < 1000)
            g = random_graph(30, 20);
        const struct ct_search_options o = {
            .trans = {.weight = random_weights(g.nedge, 2)},
            .rot = {.weight = random_weights(g.nedge, 2)},
            .budget = budget,
        };
        struct watch w = {.kind = COST_HASH, .o = &o, .g = &g};
        struct ct_tree_pair best;
        struct ct_search_stats stats;
        assert_true(search(&w, &best, &stats));
        assert_in_range(w.ncall, 1, budget);
        assert_true(!stats.out_of_budget || w.ncall == budget);
        assert_true(stats.cost <= stats.cost_least_weight);
    }
}

static void same_input_gives_the_same_pair(void **state)
{
    (void)state;
    start_random();
    const struct ct_graph g = random_graph(30, 20);
    const struct ct_search_options o = {.trans = {.weight = random_weights(g.nedge, 2)},
                                        .rot = {.weight = random_weights(g.nedge, 2)}};
    struct ct_tree_pair first, second;
    struct ct_search_stats stats;
    struct watch w = {.kind = COST_HASH, .o = &o, .g = &g}, again = w;
    assert_true(search(&w, &first, &stats) && search(&again, &second, &stats));
    assert_memory_equal(first.trans, second.trans, sizeof(bool) * (size_t)g.nedge);
    assert_memory_equal(first.rot, second.rot, sizeof(bool) * (size_t)g.nedge);
}

static void screw_is_in_both_trees_or_in_neither(void **state)
{
    (void)state;
    // ground, one body: inertia and a screw of translation weight 0, rotation weight 5
    const struct ct_edge edge[] = {{0, 1}, {0, 1}};
    const struct ct_graph g = {2, 2, edge};
    const struct ct_search_options o = {.trans = {.weight = (int[]){3, 0}},
                                        .rot = {.weight = (int[]){3, 5}},
                                        .tied = (bool[]){false, true}};
    struct watch w = {.kind = COST_ONE, .o = &o, .g = &g};
    struct ct_tree_pair best;
    struct ct_search_stats stats;
    assert_true(search(&w, &best, &stats));
    assert_true(best.trans[1] && best.rot[1]); // 0 + 5 < 3 + 3
    assert_int_equal(stats.weight_least, 5);
}

static void contradicting_rules_leave_no_pair(void **state)
{
    (void)state;
    const bool h1_only[] = {0, 0, 0, 1, 0, 0, 0};
    const struct ct_search_options o = {.trans = {.weight = crank_trans, .forced = h1_only},
                                        .rot = {.weight = crank_rot, .banned = h1_only},
                                        .tied = h1_only};
    struct watch w = {.kind = COST_ONE, .o = &o, .g = &crank};
    struct ct_tree_pair best = {0};
    struct ct_search_stats stats;
    assert_false(search(&w, &best, &stats));
    assert_true(stats.nevaluated == 0 && !best.trans);
}

static void inadmissible_everywhere_is_no_success(void **state)
{
    (void)state;
    for (int limit = 0; limit <= 500; limit += 500)
        for (enum cost_kind kind = COST_NEVER; kind <= COST_NAN; kind++) {
            const struct ct_search_options o = {.trans = {.weight = crank_trans},
                                                .rot = {.weight = crank_rot},
                                                .limit = limit,
                                                .budget = 200,
                                                .excess = 3};
            struct watch w = {.kind = kind, .o = &o, .g = &crank};
            struct ct_tree_pair best = {0};
            struct ct_search_stats stats;
            assert_false(search(&w, &best, &stats));
            assert_true(stats.nevaluated > 1 && !best.trans && isinf(stats.cost));
        }
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(slider_crank_has_441_pairs_8_of_least_weight),
        TEST(slider_crank_descent_finds_the_best_of_all),
        TEST(exhaustive_search_finds_the_optimum),
        TEST(descent_finds_the_optimum_of_a_sum),
        TEST(descent_keeps_the_rules),
        TEST(budget_is_respected),
        TEST(same_input_gives_the_same_pair),
        TEST(screw_is_in_both_trees_or_in_neither),
        TEST(contradicting_rules_leave_no_pair),
        TEST(inadmissible_everywhere_is_no_success),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
