// Linear graphs: trees, cutsets, circuits, counting and enumerating; formulation sections
// 3.1-3.4.
#include "graph/graph.h"
#include "graph/reach.h"

#include "random_graph.h"

static struct ct_tree random_tree(const struct ct_graph *g)
{
    struct ct_tree t = {0};
    assert_true(ct_tree_kruskal(arena, g, random_weights(g->nedge, 1000), NULL, &t, NULL));
    return t;
}

// ---- dense matrices, for comparison only --------------------------------------------------

/// nrow x ncol, column-major, from compressed columns; also checks that rows are sorted.
static int *dense(const struct ct_incidence *S)
{
    int *A = CT_NEWN(arena, int, S->nrow * S->ncol);
    for (int e = 0; e < S->ncol; e++)
        for (int k = S->start[e]; k < S->start[e + 1]; k++) {
            assert_in_range(S->row[k], 0, S->nrow - 1);
            assert_true(k == S->start[e] || S->row[k - 1] < S->row[k]);
            assert_true(S->value[k] == 1 || S->value[k] == -1);
            // NOLINTNEXTLINE(bugprone-signed-char-misuse): 1 or -1, no character
            A[S->row[k] + S->nrow * e] = S->value[k];
        }
    return A;
}

/// Incidence matrix without the ground row, (nnode - 1) x nedge: +1 at the head, -1 at the
/// tail.
static int *reduced_incidence(const struct ct_graph *g)
{
    const int n = g->nnode - 1;
    int *A = CT_NEWN(arena, int, n * g->nedge);
    for (int e = 0; e < g->nedge; e++) {
        if (g->edge[e].head > 0)
            A[g->edge[e].head - 1 + n * e] += 1;
        if (g->edge[e].tail > 0)
            A[g->edge[e].tail - 1 + n * e] -= 1;
    }
    return A;
}

/// Row i -= factor * row p.
static void subtract_row(int *A, int nrow, int ncol, int i, int factor, int p)
{
    for (int j = 0; j < ncol; j++)
        A[i + nrow * j] -= factor * A[p + nrow * j];
}

/// Swap rows i and p, then multiply the new row i by factor.
static void move_pivot(int *A, int nrow, int ncol, int i, int p, int factor)
{
    for (int j = 0; j < ncol; j++) {
        const int pivot = A[p + nrow * j];
        A[p + nrow * j] = A[i + nrow * j];
        A[i + nrow * j] = factor * pivot;
    }
}

/// Gauss-Jordan on the listed columns, in integers: incidence matrices are totally unimodular,
/// so every pivot is -1 or +1. Row i ends with 1 in the i-th column that had a pivot. Returns
/// the rank.
static int eliminate(int *A, int nrow, int ncol, const int *column, int ncolumn)
{
    int rank = 0;
    for (int c = 0; c < ncolumn && rank < nrow; c++) {
        const int j = column[c];
        int p = rank;
        while (p < nrow && A[p + nrow * j] == 0)
            p++;
        if (p == nrow)
            continue;
        assert_int_equal(abs(A[p + nrow * j]), 1);
        move_pivot(A, nrow, ncol, rank, p, A[p + nrow * j]);
        for (int i = 0; i < nrow; i++)
            if (i != rank && A[i + nrow * j])
                subtract_row(A, nrow, ncol, i, A[i + nrow * j], rank);
        rank++;
    }
    return rank;
}

static int rank_of(const struct ct_incidence *S)
{
    int *column = CT_NEWN(arena, int, S->ncol);
    for (int j = 0; j < S->ncol; j++)
        column[j] = j;
    return eliminate(dense(S), S->nrow, S->ncol, column, S->ncol);
}

// ---- trees --------------------------------------------------------------------------------

static void tree_without_edges_is_ground_alone(void **state)
{
    (void)state;
    const struct ct_graph g = {1, 0, NULL};
    struct ct_tree t;
    struct ct_incidence Af, Bf;
    assert_true(ct_tree_kruskal(arena, &g, NULL, NULL, &t, NULL));
    assert_null(ct_tree_check(&g, &t));
    ct_cutsets_derive(arena, &g, &t, &Af);
    ct_circuits_derive(arena, &g, &t, &Bf);
    assert_int_equal(Af.start[0] + Bf.start[0], 0);
    assert_true(ct_tree_count(arena, &g, NULL, NULL) == 1);
}

static void kruskal_breaks_ties_by_rank_then_index(void **state)
{
    (void)state;
    const struct ct_edge edge[] = {{0, 1}, {1, 0}, {0, 1}};
    const struct ct_graph g = {2, 3, edge};
    struct ct_tree t;
    assert_true(ct_tree_kruskal(arena, &g, (int[]){1, 1, 1}, NULL, &t, NULL));
    assert_int_equal(t.branch[0], 0);
    assert_true(ct_tree_kruskal(arena, &g, (int[]){1, 1, 1}, (int[]){3, 2, 2}, &t, NULL));
    assert_int_equal(t.branch[0], 1);
    assert_int_equal(t.sign[1], -1); // edge 1 points at ground
    assert_true(ct_tree_kruskal(arena, &g, (int[]){1, 1, 0}, (int[]){3, 2, 9}, &t, NULL));
    assert_int_equal(t.branch[0], 2);
    assert_true(ct_tree_kruskal(arena, &g, (int[]){1, -1, -1}, (int[]){3, 2, 9}, &t, NULL));
    assert_int_equal(t.branch[0], 0);
}

static void pieces_of_a_disconnected_graph_are_numbered(void **state)
{
    (void)state;
    // 0-3, 1-4-5, 2; edge 3 would join the first two but is not allowed
    const struct ct_edge edge[] = {{3, 0}, {5, 4}, {1, 4}, {0, 1}, {4, 1}};
    const struct ct_graph g = {6, 5, edge};
    struct ct_tree t = {.nnode = -7};
    int component[6];
    assert_false(ct_tree_kruskal(arena, &g, (int[]){0, 0, 0, -1, 0}, NULL, &t, component));
    assert_int_equal(t.nnode, -7);
    const int want[] = {0, 1, 2, 0, 1, 1};
    assert_memory_equal(component, want, sizeof want);
    assert_true(ct_tree_count(arena, &g, NULL, NULL) == 0);
}

static void branches_with_a_circuit_or_too_few_are_no_tree(void **state)
{
    (void)state;
    const struct ct_edge edge[] = {{0, 1}, {1, 0}, {1, 2}, {2, 3}, {2, 2}};
    const struct ct_graph g = {4, 5, edge};
    struct ct_tree t = {.nnode = -7};
    assert_false(ct_tree_from_branches(arena, &g, (bool[]){1, 1, 1, 0, 0}, &t));
    assert_false(ct_tree_from_branches(arena, &g, (bool[]){1, 0, 1, 0, 0}, &t));
    assert_false(ct_tree_from_branches(arena, &g, (bool[]){1, 1, 1, 1, 0}, &t));
    assert_false(ct_tree_from_branches(arena, &g, (bool[]){1, 0, 0, 1, 1}, &t)); // a self-loop
    assert_int_equal(t.nnode, -7);
    assert_true(ct_tree_from_branches(arena, &g, (bool[]){0, 1, 1, 1, 0}, &t));
    assert_null(ct_tree_check(&g, &t));
}

static void tree_check_finds_each_damage(void **state)
{
    (void)state;
    const struct ct_edge edge[] = {{0, 1}, {1, 2}, {0, 2}, {3, 2}};
    const struct ct_graph g = {4, 4, edge};
    struct ct_tree t;
    assert_true(ct_tree_from_branches(arena, &g, (bool[]){1, 1, 0, 1}, &t));
    assert_null(ct_tree_check(&g, &t));
    struct {
        int *place;
        int damage;
    } damages[] = {
        {&t.nbranch, 2},   {&t.parent[0], 1},      {&t.parent[2], 0}, {&t.parent[3], -1},
        {&t.sign[1], -1},  {&t.sign[3], 0},        {&t.depth[2], 1},  {&t.order[0], 1},
        {&t.order[3], 2},  {&t.order[1], 9},       {&t.branch[1], 2}, {&t.chord[0], 1},
        {&t.nchord, 0},    {&t.parent_edge[1], 2}, {&t.nedge, 3},     {&t.parent_edge[3], -1},
        {&t.parent[1], 3}, {&t.depth[0], 1},
    };
    for (size_t i = 0; i < COUNT(damages); i++) {
        const int was = *damages[i].place;
        *damages[i].place = damages[i].damage;
        if (!ct_tree_check(&g, &t))
            fail_msg("damage %zu not found", i);
        *damages[i].place = was;
    }
    t.is_branch[2] = true;
    assert_non_null(ct_tree_check(&g, &t));
}

// ---- the worked example, formulation 3.4 --------------------------------------------------

enum { m1, r3, m2, h4, w5 };
static const struct ct_edge beam_edge[] = {{0, 1}, {1, 2}, {0, 3}, {0, 1}, {2, 3}};
static const struct ct_graph beam = {4, 5, beam_edge};

static void assert_matrix(const struct ct_incidence *S, const int *want_by_rows)
{
    const int *got = dense(S);
    for (int i = 0; i < S->nrow; i++)
        for (int j = 0; j < S->ncol; j++)
            if (got[i + S->nrow * j] != want_by_rows[i * S->ncol + j])
                fail_msg("entry (%d, %d): got %d, want %d", i, j, got[i + S->nrow * j],
                         want_by_rows[i * S->ncol + j]);
}

static void worked_example_tree_A(void **state)
{
    (void)state;
    struct ct_tree A;
    struct ct_incidence Af, Bf;
    assert_true(ct_tree_from_branches(arena, &beam, (bool[]){1, 1, 1, 0, 0}, &A));
    ct_cutsets_derive(arena, &beam, &A, &Af);
    ct_circuits_derive(arena, &beam, &A, &Bf);
    //                             m1 r3 m2 h4  w5
    assert_matrix(&Af, (const int[]){1, 0, 0, 1, -1,   // m1 + h4 - w5 = 0
                                     0, 1, 0, 0, -1,   // r3 - w5 = 0
                                     0, 0, 1, 0, 1});  // m2 + w5 = 0
    assert_matrix(&Bf, (const int[]){-1, 0, 0, 1, 0,   // h4 - m1 = 0
                                     1, 1, -1, 0, 1}); // w5 + m1 + r3 - m2 = 0      (3.4)
}

static void worked_example_tree_B(void **state)
{
    (void)state;
    struct ct_tree B;
    struct ct_incidence Af, Bf;
    assert_true(ct_tree_from_branches(arena, &beam, (bool[]){0, 1, 0, 1, 1}, &B));
    ct_cutsets_derive(arena, &beam, &B, &Af);
    ct_circuits_derive(arena, &beam, &B, &Bf);
    //                             m1 r3 m2 h4 w5
    assert_matrix(&Af, (const int[]){0, 1, 1, 0, 0,      // r3 + m2 = 0
                                     1, 0, 1, 1, 0,      // h4 + m1 + m2 = 0
                                     0, 0, 1, 0, 1});    // w5 + m2 = 0
    assert_matrix(&Bf, (const int[]){1, 0, 0, -1, 0,     // m1 - h4 = 0
                                     0, -1, 1, -1, -1}); // m2 - h4 - r3 - w5 = 0    (3.4)
}

static void worked_example_circuit_is_walked_from_the_head(void **state)
{
    (void)state;
    struct ct_tree A;
    int branch[3];
    signed char sign[3];
    assert_true(ct_tree_from_branches(arena, &beam, (bool[]){1, 1, 1, 0, 0}, &A));
    assert_int_equal(ct_tree_circuit(&beam, &A, w5, branch, sign), 3);
    const int want[] = {m2, m1, r3}; // 3 -> 0 -> 1 -> 2
    assert_memory_equal(branch, want, sizeof want);
    assert_true(sign[0] == -1 && sign[1] == 1 && sign[2] == 1);
}

static void worked_example_has_7_trees_5_with_the_arm(void **state)
{
    (void)state;
    const bool arm[] = {[r3] = true, [w5] = false}, no_inertia[] = {1, 0, 1, 0, 0};
    assert_true(ct_tree_count(arena, &beam, NULL, NULL) == 7);
    assert_true(ct_tree_count(arena, &beam, arm, NULL) == 5);
    assert_true(ct_tree_count(arena, &beam, arm, no_inertia) == 1);
    assert_true(ct_tree_count(arena, &beam, arm, arm) == 0);
}

// ---- properties of random graphs ----------------------------------------------------------

enum { nrandom = 200 };

static void cutsets_are_orthogonal_to_circuits(void **state)
{
    (void)state;
    start_random();
    for (int n = 0; n < nrandom; n++) {
        const struct ct_graph g = random_graph(30, 30);
        const struct ct_tree t = random_tree(&g);
        assert_null(ct_tree_check(&g, &t));
        struct ct_incidence Af, Bf;
        ct_cutsets_derive(arena, &g, &t, &Af);
        ct_circuits_derive(arena, &g, &t, &Bf);
        const int *A = dense(&Af), *B = dense(&Bf);
        for (int i = 0; i < Af.nrow; i++)
            for (int k = 0; k < Bf.nrow; k++) {
                int sum = 0;
                for (int e = 0; e < g.nedge; e++)
                    sum += A[i + Af.nrow * e] * B[k + Bf.nrow * e];
                assert_int_equal(sum, 0); // (3.3)
            }
        assert_int_equal(rank_of(&Af), g.nnode - 1);
        assert_int_equal(rank_of(&Bf), g.nedge - g.nnode + 1);
    }
}

static void cutsets_by_elimination_equal_the_path_method(void **state)
{
    (void)state;
    start_random();
    for (int n = 0; n < nrandom; n++) {
        const struct ct_graph g = random_graph(30, 30);
        const struct ct_tree t = random_tree(&g);
        struct ct_incidence Af;
        ct_cutsets_derive(arena, &g, &t, &Af);
        int *A = reduced_incidence(&g); // (3.1): [1 A_cut] = A_t^-1 [A_t A_c]
        assert_int_equal(eliminate(A, g.nnode - 1, g.nedge, t.branch, t.nbranch), g.nnode - 1);
        assert_memory_equal(A, dense(&Af), sizeof *A * (size_t)(Af.nrow * Af.ncol));
    }
}

static void rank_of_the_incidence_matrix_is_nodes_less_pieces(void **state)
{
    (void)state;
    start_random();
    for (int n = 0; n < nrandom; n++) {
        const struct ct_graph whole = random_graph(20, 10);
        int *weight = random_weights(whole.nedge, 3),
            *component = CT_NEWN(arena, int, whole.nnode);
        int *kept = CT_NEWN(arena, int, whole.nedge), nkept = 0, npiece = 0;
        for (int e = 0; e < whole.nedge; e++)
            if (--weight[e] >= 0)
                kept[nkept++] = e;
        struct ct_tree t;
        const bool connected = ct_tree_kruskal(arena, &whole, weight, NULL, &t, component);
        for (int v = 0; v < whole.nnode; v++)
            npiece = component[v] >= npiece ? component[v] + 1 : npiece;
        assert_int_equal(connected, npiece == 1);
        const int rank
            = eliminate(reduced_incidence(&whole), whole.nnode - 1, whole.nedge, kept, nkept);
        assert_int_equal(rank, whole.nnode - npiece); // so e - v + c circuits are independent
    }
}

struct census {
    const struct ct_graph *g;
    const int *weight;
    const bool *forced, *banned;
    int ntree, least, stop_after;
    bool *last; // branches of the tree before
};

/// Each tree is a tree, keeps to forced and banned, and comes after the one before.
static bool count_tree(void *data, const bool *is_branch)
{
    struct census *c = data;
    struct ct_tree t;
    int weight = 0, differs = 0;
    assert_true(ct_tree_from_branches(arena, c->g, is_branch, &t));
    for (int e = 0; e < c->g->nedge; e++) {
        assert_false(is_branch[e] && c->banned && c->banned[e]);
        assert_false(!is_branch[e] && c->forced && c->forced[e]);
        weight += is_branch[e] ? c->weight[e] : 0;
        if (c->ntree > 0 && !differs && is_branch[e] != c->last[e]) {
            differs = 1;
            assert_true(c->last[e]); // lexicographic: the edge taken first, then left out
        }
        c->last[e] = is_branch[e];
    }
    assert_true(differs || c->ntree == 0 || c->g->nedge == 0);
    c->least = c->ntree == 0 || weight < c->least ? weight : c->least;
    return ++c->ntree != c->stop_after;
}

static void kruskal_and_the_count_agree_with_enumeration(void **state)
{
    (void)state;
    start_random();
    for (int n = 0; n < nrandom; n++) {
        const struct ct_graph g = random_graph(6, 5);
        const int *weight = random_weights(g.nedge, 6);
        struct census c = {.g = &g, .weight = weight, .last = CT_NEWN(arena, bool, g.nedge)};
        assert_true(ct_tree_enumerate(arena, &g, NULL, NULL, count_tree, &c));
        assert_true(ct_tree_count(arena, &g, NULL, NULL) == c.ntree);

        struct ct_tree t;
        int got = 0;
        assert_true(ct_tree_kruskal(arena, &g, weight, NULL, &t, NULL));
        for (int i = 0; i < t.nbranch; i++)
            got += weight[t.branch[i]];
        assert_int_equal(got, c.least);
    }
}

static void forced_and_banned_edges_are_respected(void **state)
{
    (void)state;
    start_random();
    for (int n = 0; n < nrandom; n++) {
        const struct ct_graph g = random_graph(6, 5);
        bool *forced = CT_NEWN(arena, bool, g.nedge), *banned = CT_NEWN(arena, bool, g.nedge);
        for (int e = 0; e < g.nedge; e++) {
            forced[e] = draw(5) == 0;
            banned[e] = draw(5) == 0;
        }
        struct census c = {.g = &g,
                           .weight = random_weights(g.nedge, 6),
                           .forced = forced,
                           .banned = banned,
                           .last = CT_NEWN(arena, bool, g.nedge)};
        assert_true(ct_tree_enumerate(arena, &g, forced, banned, count_tree, &c));
        assert_true(ct_tree_count(arena, &g, forced, banned) == c.ntree);
    }
}

/// Complete graph on n nodes.
static struct ct_graph complete(int n)
{
    struct ct_edge *edge = CT_NEWN(arena, struct ct_edge, n * n);
    int nedge = 0;
    for (int i = 0; i < n; i++)
        for (int j = i + 1; j < n; j++)
            edge[nedge++] = (struct ct_edge){i, j};
    return (struct ct_graph){n, nedge, edge};
}

// ---- reaching --------------------------------------------------------------------------------

static bool *random_choice(int n)
{
    bool *chosen = CT_NEWN(arena, bool, n + 1);
    for (int i = 0; i < n; i++)
        chosen[i] = draw(4) > 0;
    return chosen;
}

/// What ct_graph_spread is to give, sweep by sweep.
static int sweep_edges(const struct ct_graph *g, const bool *usable, bool *is_known, int *order)
{
    int n = 0;
    for (bool grew = true; grew;) {
        grew = false;
        for (int e = 0; e < g->nedge; e++) {
            bool *tail = &is_known[g->edge[e].tail], *head = &is_known[g->edge[e].head];
            if (!usable[e] || *tail == *head)
                continue;
            *tail = *head = grew = true;
            order[n++] = e;
        }
    }
    return n;
}

static void edges_spread_in_the_order_of_sweeps(void **state)
{
    (void)state;
    start_random();
    for (int trial = 0; trial < 300; trial++) {
        const struct ct_graph g = random_graph(20, 12);
        const bool *usable = random_choice(g.nedge);
        bool *want_known = CT_NEWN(arena, bool, g.nnode),
             *known = CT_NEWN(arena, bool, g.nnode);
        int *want = CT_NEWN(arena, int, g.nnode), *got = CT_NEWN(arena, int, g.nnode);
        want_known[0] = known[0] = true;
        for (int k = draw(3); k > 0; k--) {
            const int v = draw(g.nnode);
            want_known[v] = known[v] = true;
        }
        const int n = sweep_edges(&g, usable, want_known, want);
        assert_int_equal(ct_graph_spread(arena, &g, usable, known, got), n);
        assert_memory_equal(got, want, (size_t)n * sizeof *got);
        assert_memory_equal(known, want_known, (size_t)g.nnode);
    }
}

static void distances_are_those_of_all_ways(void **state)
{
    (void)state;
    start_random();
    for (int trial = 0; trial < 300; trial++) {
        const struct ct_graph g = random_graph(20, 12);
        const bool *usable = random_choice(g.nedge);
        const int *length = random_weights(g.nedge, 4), far = 1000;
        int *want = CT_NEWN(arena, int, g.nnode), *got = CT_NEWN(arena, int, g.nnode);
        for (int v = 1; v < g.nnode; v++)
            want[v] = far;
        for (int k = 0; k < g.nnode; k++) // ways of one more edge each time
            for (int e = 0; e < g.nedge; e++) {
                int *t = &want[g.edge[e].tail], *h = &want[g.edge[e].head];
                if (usable[e] && *t + length[e] < *h)
                    *h = *t + length[e];
                if (usable[e] && *h + length[e] < *t)
                    *t = *h + length[e];
            }
        ct_graph_distances(arena, &g, usable, length, far, got);
        assert_memory_equal(got, want, (size_t)g.nnode * sizeof *got);
    }
}

static void count_of_a_complete_graph_is_cayleys(void **state)
{
    (void)state;
    double cayley = 1; // n^(n - 2)
    const struct ct_graph g = complete(12);
    for (int i = 0; i < 10; i++)
        cayley *= 12;
    assert_true(ct_tree_count(arena, &g, NULL, NULL) == cayley); // 6.2e10
}

static void enumeration_stops_when_told(void **state)
{
    (void)state;
    const struct ct_graph g = complete(30); // 30^28 trees
    struct census c = {.g = &g,
                       .weight = random_weights(g.nedge, 6),
                       .stop_after = 5,
                       .last = CT_NEWN(arena, bool, g.nedge)};
    assert_false(ct_tree_enumerate(arena, &g, NULL, NULL, count_tree, &c));
    assert_int_equal(c.ntree, 5);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(tree_without_edges_is_ground_alone),
        TEST(kruskal_breaks_ties_by_rank_then_index),
        TEST(pieces_of_a_disconnected_graph_are_numbered),
        TEST(branches_with_a_circuit_or_too_few_are_no_tree),
        TEST(tree_check_finds_each_damage),
        TEST(worked_example_tree_A),
        TEST(worked_example_tree_B),
        TEST(worked_example_circuit_is_walked_from_the_head),
        TEST(worked_example_has_7_trees_5_with_the_arm),
        TEST(cutsets_are_orthogonal_to_circuits),
        TEST(cutsets_by_elimination_equal_the_path_method),
        TEST(rank_of_the_incidence_matrix_is_nodes_less_pieces),
        TEST(kruskal_and_the_count_agree_with_enumeration),
        TEST(forced_and_banned_edges_are_respected),
        TEST(edges_spread_in_the_order_of_sweeps),
        TEST(distances_are_those_of_all_ways),
        TEST(count_of_a_complete_graph_is_cayleys),
        TEST(enumeration_stops_when_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
