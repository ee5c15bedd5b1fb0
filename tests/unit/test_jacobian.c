// Sparse Jacobians against one derivative at a time: the same expressions, none missing, in order.
#include "random_ex.h"
#include "tests/check.h"

#include "expr/scarcity.h"

#include <string.h>

enum { NSYM = 6, NNODE = 120, NF = 9 };

struct fixture {
    struct ct_arena *a, *scratch;
    struct ct_exs x;
    ct_ex sym[NSYM];
};

static void begin(struct fixture *f)
{
    f->a = ct_arena_create();
    f->scratch = ct_arena_create();
    ct_exs_init(&f->x, f->a);
    for (int i = 0; i < NSYM; i++) // of two kinds: one derivative walks those of its kind alone
        f->sym[i] = ct_ex_sym(&f->x, i % 2 ? CT_SYM_U : CT_SYM_Q, "q", (uint32_t)i);
}

static void end(struct fixture *f)
{
    ct_arena_destroy(f->a);
    ct_arena_destroy(f->scratch);
}

// Every operator, shared nodes: entry by entry the expression that ct_ex_diff gives, zeros left
// out.
static void entries_are_single_derivatives(void **unused)
{
    (void)unused;
    struct random r = random_start("jacobian");
    for (int trial = 0; trial < 100; trial++) {
        struct fixture f;
        begin(&f);
        ct_ex node[NSYM + NNODE], out[NF];
        for (int i = 0; i < NSYM; i++)
            node[i] = f.sym[i];
        for (size_t i = NSYM; i < NSYM + NNODE; i++)
            node[i] = random_node(&r, &f.x, node, i);
        for (int i = 0; i < NF; i++)
            out[i] = node[random_below(&r, NSYM + NNODE)];
        struct ct_seed seed[NSYM];
        for (int i = 0; i < NSYM; i++) // in any order
            seed[i]
                = (struct ct_seed){f.sym[NSYM - 1 - i], (uint32_t)(NSYM - 1 - i), CT_EX_ONE};
        struct ct_slope *s;
        const size_t n = ct_ex_jacobian(&f.x, f.scratch, f.a, out, NF, seed, NSYM, &s);
        const double value[NSYM] = {0.3, -0.7, 1.1, 0.9, -1.3, 0.5};
        size_t next = 0;
        for (uint32_t row = 0; row < NF; row++)
            for (uint32_t k = 0; k < NSYM; k++) {
                const ct_ex want = ct_ex_diff(&f.x, out[row], f.sym[k]);
                const size_t nwalk
                    = ct_ex_walk_kinds(&f.x, &out[row], 1, ct_ex_kinds(&f.x, f.sym[k]));
                for (int i = 0; i < 2; i++) // the walk stays
                    assert_true(
                        ct_ex_same(ct_ex_diff_walked(&f.x, nwalk, out[row], f.sym[k]), want));
                if (ct_ex_is_zero(want))
                    continue;
                if (next == n || s[next].row != row || s[next].direction != k) {
                    // a quotient 0/0 that does not depend on the symbol is left out here
                    assert_true(isnan(ct_ex_value(&f.x, want, value)));
                    continue;
                }
                assert_int_equal(s[next].value.id, want.id);
                next++;
            }
        assert_int_equal(next, n);
        end(&f);
    }
}

// As numbers: the values of the expressions, those that vanish left out; every operator.
static void numbers_are_values_of_derivatives(void **unused)
{
    (void)unused;
    struct random r = random_start("numbers");
    const double value[NSYM] = {0.3, -0.7, 1.1, 0.9, -1.3, 0.5};
    int ncompared = 0;
    for (int trial = 0; trial < 200; trial++) {
        enum { NSMALL = 30 };
        struct fixture f;
        begin(&f);
        ct_ex node[NSYM + NSMALL], out[NF];
        memcpy(node, f.sym, sizeof f.sym);
        for (size_t i = NSYM; i < NSYM + NSMALL; i++)
            node[i] = random_node(&r, &f.x, node, i);
        for (int i = 0; i < NF; i++)
            out[i] = node[random_below(&r, NSYM + NSMALL)];
        struct ct_seed seed[NSYM];
        for (int i = 0; i < NSYM; i++)
            seed[i] = (struct ct_seed){f.sym[i], (uint32_t)i, CT_EX_ONE};
        struct ct_number *s;
        double at[NF], got[NF][NSYM] = {{0}};
        const size_t n
            = ct_ex_jacobian_at(&f.x, f.scratch, f.a, out, NF, seed, NSYM, value, at, &s);
        for (size_t i = 0; i < n; i++) {
            assert_true(s[i].value != 0);
            assert_true(i == 0 || s[i].row > s[i - 1].row
                        || (s[i].row == s[i - 1].row && s[i].direction > s[i - 1].direction));
            got[s[i].row][s[i].direction] = s[i].value;
        }
        for (int row = 0; row < NF; row++) {
            const double here = ct_ex_value(&f.x, out[row], value);
            assert_true(at[row] == here || (isnan(at[row]) && isnan(here)));
            for (int k = 0; k < NSYM; k++) {
                const double want
                    = ct_ex_value(&f.x, ct_ex_diff(&f.x, out[row], f.sym[k]), value);
                if (!isfinite(want) || fabs(want) > 1e6 || !isfinite(got[row][k]))
                    continue;                               // 0 times infinity on the way
                CHECK_CLOSE(got[row][k], want, 1e-9, 1e-9); // sums in another order
                ncompared++;
            }
        }
        end(&f);
    }
    assert_true(ncompared > 3000);
}

// A symbol that moves in several directions, and a direction in which several move.
static void seeds_form_directions(void **unused)
{
    (void)unused;
    struct fixture f;
    begin(&f);
    struct ct_exs *x = &f.x;
    const ct_ex p = f.sym[0], q = f.sym[1], f0 = ct_ex_mul(x, p, q),
                f1 = ct_ex_fun(x, CT_OP_SIN, q);
    const ct_ex out[] = {f0, f1, f.sym[2]};
    const struct ct_seed seed[] = {{p, 7, q}, {q, 7, ct_ex_neg(x, p)}, {q, 3, CT_EX_ONE}};
    struct ct_slope *s;
    // f0 by 3: p; by 7: q q - p p; f1 by 3: cos q; by 7: -p cos q; the last depends on neither
    const ct_ex c = ct_ex_fun(x, CT_OP_COS, q);
    const struct ct_slope want[]
        = {{0, 3, p},
           {0, 7, ct_ex_sub(x, ct_ex_mul(x, q, q), ct_ex_mul(x, p, p))},
           {1, 3, c},
           {1, 7, ct_ex_neg(x, ct_ex_mul(x, p, c))}};
    assert_int_equal(ct_ex_jacobian(x, f.scratch, f.a, out, 3, seed, 3, &s), COUNT(want));
    for (size_t i = 0; i < COUNT(want); i++) {
        assert_int_equal(s[i].row, want[i].row);
        assert_int_equal(s[i].direction, want[i].direction);
        assert_int_equal(s[i].value.id, want[i].value.id);
    }
    end(&f);
}

// Backwards the same numbers as one derivative at a time.
static void gradients_are_single_derivatives(void **unused)
{
    (void)unused;
    struct random r = random_start("gradient");
    const double value[NSYM] = {0.3, -0.7, 1.1, 0.9, -1.3, 0.5};
    int ncompared = 0;
    for (int trial = 0; trial < 300; trial++) {
        enum { NSMALL = 20 };
        struct fixture f;
        begin(&f);
        ct_ex node[NSYM + NSMALL], got[NSYM];
        memcpy(node, f.sym, sizeof f.sym);
        for (size_t i = NSYM; i < NSYM + NSMALL; i++)
            node[i] = random_node(&r, &f.x, node, i);
        const ct_ex top = node[NSYM + NSMALL - 1];
        ct_ex_gradient(&f.x, f.scratch, top, f.sym, NSYM, got);
        for (size_t k = 0; k < NSYM; k++) {
            const double want = ct_ex_value(&f.x, ct_ex_diff(&f.x, top, f.sym[k]), value);
            if (!isfinite(want) || fabs(want) > 1e6)
                continue;
            const double is = ct_ex_value(&f.x, got[k], value);
            if (!isnan(is)) // 0 times infinity where forwards there is no such product
                assert_true(fabs(is - want) <= 1e-9 * (1 + fabs(want)));
            ncompared += !isnan(is) && want != 0;
        }
        end(&f);
    }
    assert_true(ncompared > 100);
}

// Substitution within the nodes of a kind: the values of the other one; what lacks the kind is the
// same node.
static void substitution_within_a_kind(void **unused)
{
    (void)unused;
    struct random r = random_start("within");
    const double value[NSYM] = {0.3, -0.7, 1.1, 0.9, -1.3, 0.5};
    int ncompared = 0, nother = 0;
    for (int trial = 0; trial < 100; trial++) {
        struct fixture f;
        begin(&f);
        ct_ex node[NSYM + NNODE];
        memcpy(node, f.sym, sizeof f.sym);
        for (size_t i = NSYM; i < NSYM + NNODE; i++) {
            node[i] = random_node(&r, &f.x, node, i);
            const ct_ex got = ct_ex_subst_within(&f.x, node[i], &f.sym[0], &f.sym[2], 1);
            const double is = ct_ex_value(&f.x, got, value),
                         want = ct_ex_value(
                             &f.x, ct_ex_subst(&f.x, node[i], &f.sym[0], &f.sym[2], 1), value);
            if (!(ct_ex_kinds(&f.x, node[i]) & 1u << CT_SYM_Q)) {
                assert_true(ct_ex_same(got, node[i]));
                nother++;
            } else if (isfinite(want) && fabs(want) < 1e6) {
                assert_true(fabs(is - want) <= 1e-9 * (1 + fabs(want)));
                ncompared += !ct_ex_same(got, node[i]);
            }
        }
        end(&f);
    }
    assert_true(ncompared > 100 && nother > 100);
}

// ---- inner values -------------------------------------------------------------------------------

enum { NSMALL_GRAPH = 40, MOST_INNER = NSMALL_GRAPH, MOST_ROWS = NF + MOST_INNER };

// Entries of a Jacobian with n inner values, directions NSYM and up: each is among those that the
// graph has, and in the pattern.
static void check_places(struct fixture *f, const struct ct_scarcity *g, const ct_ex *row,
                         size_t n, const struct ct_seed *seed, const struct ct_slope *s,
                         size_t ns)
{
    bool in_graph[MOST_ROWS][NSYM + MOST_INNER] = {{false}};
    bool in_pattern[MOST_ROWS][NSYM + MOST_INNER] = {{false}};
    int *r, *c;
    struct ct_slope *p;
    double operations;
    const size_t nentry = ct_scarcity_entries(g, f->a, &r, &c),
                 np = ct_ex_pattern(&f->x, f->scratch, f->a, row, NF + n, seed, NSYM + n,
                                    (uint32_t)(NSYM + n), &p, &operations);
    for (size_t i = 0; i < nentry; i++) {
        assert_false(in_graph[r[i]][c[i]]);
        in_graph[r[i]][c[i]] = true;
    }
    for (size_t i = 0; i < np; i++)
        in_pattern[p[i].row][p[i].direction] = true;
    for (size_t i = 0; i < ns; i++) {
        bool is_inner = false; // a row that is one itself depends on itself alone in the graph
        for (size_t k = NF; k < NF + n && s[i].row < NF; k++)
            is_inner = is_inner || ct_ex_same(row[k], row[s[i].row]);
        assert_true(is_inner || in_graph[s[i].row][s[i].direction]);
        assert_true(in_pattern[s[i].row][s[i].direction]);
        if (s[i].row >= NF && s[i].direction >= NSYM) // of earlier ones
            assert_true(s[i].direction - NSYM < s[i].row - NF);
    }
}

// The derivative of each f by symbol k, over those of inner values: `sum` of them, one after the
// other.
static void sum_up(double sum[MOST_ROWS], const struct ct_exs *x, const struct ct_slope *s,
                   size_t ns, uint32_t k, const double *value)
{
    memset(sum, 0, MOST_ROWS * sizeof *sum);
    for (int pass = 0; pass < 2; pass++) // inner values, which come behind the rows of f, first
        for (size_t i = 0; i < ns; i++) {
            if ((s[i].row < NF) == (pass == 0))
                continue;
            const double v = ct_ex_value(x, s[i].value, value);
            if (s[i].direction == k)
                sum[s[i].row] += v;
            else if (s[i].direction >= NSYM)
                sum[s[i].row] += v * sum[NF + s[i].direction - NSYM];
        }
}

// Random graphs, thinned out by and by: over what is left the same derivatives.
static void inner_values_lead_to_the_same_derivatives(void **unused)
{
    (void)unused;
    struct random r = random_start("inner");
    const double value[NSYM] = {0.3, -0.7, 1.1, 0.9, -1.3, 0.5};
    int ncompared = 0;
    size_t ninner = 0;
    for (int trial = 0; trial < 200; trial++) {
        struct fixture f;
        begin(&f);
        ct_ex node[NSYM + NSMALL_GRAPH], row[MOST_ROWS], *inner;
        memcpy(node, f.sym, sizeof f.sym);
        for (size_t i = NSYM; i < NSYM + NSMALL_GRAPH; i++)
            node[i] = random_node(&r, &f.x, node, i);
        for (int i = 0; i < NF; i++)
            row[i] = node[random_below(&r, NSYM + NSMALL_GRAPH)];
        struct ct_seed seed[NSYM + MOST_INNER];
        for (uint32_t i = 0; i < NSYM; i++)
            seed[i] = (struct ct_seed){f.sym[i], i, CT_EX_ONE};
        struct ct_scarcity *g = ct_scarcity_create(&f.x, f.a, row, NF, seed, NSYM, NSYM);
        for (long most = -2; most <= 8; most += 2) {
            ct_scarcity_thin(g, most);
            const size_t n = ct_scarcity_nodes(g, f.a, &inner);
            if (n > MOST_INNER)
                continue;
            for (size_t i = 0; i < n; i++) {
                row[NF + i] = inner[i];
                seed[NSYM + i] = (struct ct_seed){inner[i], (uint32_t)(NSYM + i), CT_EX_ONE};
            }
            struct ct_slope *s;
            const size_t ns
                = ct_ex_jacobian(&f.x, f.scratch, f.a, row, NF + n, seed, NSYM + n, &s);
            check_places(&f, g, row, n, seed, s, ns);
            ninner += n;
            for (uint32_t k = 0; k < NSYM; k++) {
                double got[MOST_ROWS];
                sum_up(got, &f.x, s, ns, k, value);
                for (int i = 0; i < NF; i++) {
                    const double want
                        = ct_ex_value(&f.x, ct_ex_diff(&f.x, row[i], f.sym[k]), value);
                    if (!isfinite(want) || fabs(want) > 1e6 || !isfinite(got[i]))
                        continue; // 0 times infinity on the way
                    CHECK_CLOSE(got[i], want, 1e-9, 1e-9);
                    ncompared++;
                }
            }
        }
        end(&f);
    }
    printf("%zu inner values, %d derivatives compared\n", ninner, ncompared);
    assert_true(ncompared > 10000 && ninner > 1000);
}

// Sums along a chain that each reach all rows: n entries for n values, and no nodes where rows see
// their neighbours alone.
static void chains_keep_their_sums(void **unused)
{
    (void)unused;
    enum { N = 40 };
    struct fixture f;
    begin(&f);
    ct_ex sym[N], sum[N], near[N];
    struct ct_seed seed[N];
    for (uint32_t i = 0; i < N; i++) {
        sym[i] = ct_ex_sym(&f.x, CT_SYM_Q, "s", i);
        seed[i] = (struct ct_seed){sym[i], i, CT_EX_ONE};
        const ct_ex square = ct_ex_mul(&f.x, sym[i], sym[i]);
        sum[i] = i ? ct_ex_add(&f.x, sum[i - 1], square) : square;
        near[i] = i ? ct_ex_fun(&f.x, CT_OP_SIN, ct_ex_mul(&f.x, sym[i], sym[i - 1])) : sym[i];
    }
    ct_ex rows[N], *node;
    for (int i = 0; i < N; i++)
        rows[i] = ct_ex_fun(&f.x, CT_OP_SIN, sum[i]);
    int *r, *c;
    struct ct_scarcity *g = ct_scarcity_create(&f.x, f.a, rows, N, seed, N, N);
    ct_scarcity_thin(g, 0);
    assert_true(ct_scarcity_entries(g, f.a, &r, &c) <= 3 * N);
    assert_in_range(ct_scarcity_nodes(g, f.a, &node), N / 4, N);
    g = ct_scarcity_create(&f.x, f.a, near, N, seed, N, N);
    ct_scarcity_thin(g, 0);
    assert_int_equal(ct_scarcity_nodes(g, f.a, &node), 0);
    assert_int_equal(ct_scarcity_entries(g, f.a, &r, &c), 2 * N - 1);
    end(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(entries_are_single_derivatives),
        cmocka_unit_test(numbers_are_values_of_derivatives),
        cmocka_unit_test(gradients_are_single_derivatives),
        cmocka_unit_test(seeds_form_directions),
        cmocka_unit_test(substitution_within_a_kind),
        cmocka_unit_test(inner_values_lead_to_the_same_derivatives),
        cmocka_unit_test(chains_keep_their_sums),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
