// Sparse least squares and sparse pivots against dense QR.
#include "numeric/damped.h"
#include "numeric/dense.h"
#include "numeric/sparse_pivots.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

enum { MOST = 40 };

static uint64_t state = 20261124; // the seed; the same numbers in every run

static double uniform(void) // in [-1, 1)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(int64_t)(state >> 11) / 4503599627370496.0 - 1;
}

// A matrix (m x n) with a few entries in each row, the last `repeated` rows sums of two others.
struct sample {
    int m, n;
    double A[MOST * MOST]; // column-major
    int row[MOST * MOST], column[MOST * MOST];
    double value[MOST * MOST];
    size_t nentry;
};

static void draw(struct sample *s, int m, int n, int repeated)
{
    memset(s, 0, sizeof *s);
    s->m = m;
    s->n = n;
    for (int i = 0; i < m; i++)
        for (int j = 0; j < n; j++)
            if (i >= m - repeated)
                s->A[i + m * j] = s->A[i - repeated + m * j] - 2 * s->A[(i % 3) + m * j];
            else if (j == i % n || uniform() > 0.8)
                s->A[i + m * j] = 0.5 + fabs(uniform());
    for (int i = 0; i < m; i++)
        for (int j = 0; j < n; j++)
            if (s->A[i + m * j] != 0) {
                s->row[s->nentry] = i;
                s->column[s->nentry] = j;
                s->value[s->nentry++] = s->A[i + m * j];
            }
}

static struct ct_sparse_rows rows_of(struct ct_arena *a, const struct sample *s)
{
    struct ct_sparse_rows A = {.arena = a};
    for (int i = 0; i < s->m; i++) {
        double row[MOST];
        for (int j = 0; j < s->n; j++)
            row[j] = s->A[i + s->m * j];
        ct_sparse_rows_add(&A, NULL, row, (size_t)s->n, 1);
    }
    return A;
}

// Minimum-norm solution x (n) by dense QR; damping 0: of A alone.
static void solve_dense(const struct sample *s, const double *b, double damping, double *x)
{
    static double D[2 * MOST * MOST], y[2 * MOST], work[100 * MOST];
    int iwork[MOST];
    const int m = s->m, n = s->n, all = m + n;
    memset(D, 0, sizeof D);
    memset(y, 0, sizeof y);
    memcpy(y, b, (size_t)m * sizeof *y);
    for (int j = 0; j < n; j++) {
        memcpy(D + all * j, s->A + m * j, (size_t)m * sizeof *D);
        D[m + j + all * j] = damping;
    }
    assert_true(ct_lstsq_work(all, n) <= 100 * MOST);
    ct_lstsq(y, D, all, n, all, 1e-12, iwork, work);
    memcpy(x, y, (size_t)n * sizeof *x);
}

static void compare(const struct sample *s, double damping, double dense_damping, double most)
{
    struct ct_arena *a = ct_arena_create();
    struct ct_damped *d = ct_damped_create(a);
    const struct ct_sparse_rows A = rows_of(a, s);
    double b[MOST], x[MOST], want[MOST];
    for (int j = 0; j < s->n; j++)
        want[j] = uniform();
    for (int again = 0; again < 2; again++) {            // with the analysis of the first
        ct_sparse_rows_times(b, &A, (size_t)s->m, want); // in the range of A
        ct_damped_factor(d, &A, (size_t)s->m, (size_t)s->m, (size_t)s->n, damping);
        ct_damped_solve(d, x, b);
        solve_dense(s, b, dense_damping, want);
        for (int j = 0; j < s->n; j++)
            if (!(fabs(x[j] - want[j]) <= most))
                fail_msg("x[%d] = %.17g, want %.17g", j, x[j], want[j]);
    }
    ct_arena_destroy(a);
}

static void damped_solutions_are_those_of_dense_matrices(void **unused)
{
    (void)unused;
    struct sample s;
    for (int k = 0; k < 20; k++) {
        draw(&s, 5 + k, 4 + (7 * k) % 25, k % 3 ? 2 : 0);
        compare(&s, 0.1, 0.1, 1e-11);
    }
}

// singular values of 0.01 or more are damped by (1e-8 / 0.01)^2; round-off by the condition, 1e10
static void little_damping_gives_the_shortest_solution(void **unused)
{
    (void)unused;
    struct sample s;
    for (int k = 0; k < 20; k++) {
        draw(&s, 10 + k, 20, 3);
        compare(&s, 1e-8, 0, 1e-6);
    }
}

// x + y = 2 is met; of x = 0 and 2 y = 0 what it leaves. There x = 4 y.
static void further_rows_count_where_the_first_leave_freedom(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    struct ct_damped *d = ct_damped_create(a);
    struct ct_sparse_rows A = {.arena = a};
    const double row[][2] = {{1, 1}, {1, 1}, {1, 0}, {0, 2}}; // the first one twice
    double x[4], b[4] = {2, 2, 0, 0};
    for (int i = 0; i < 4; i++)
        ct_sparse_rows_add(&A, NULL, row[i], 2, 1);
    ct_damped_factor(d, &A, 2, 4, 2, 1e-12);
    ct_damped_solve(d, x, b);
    assert_true(fabs(x[0] - 1.6) < 1e-11 && fabs(x[1] - 0.4) < 1e-11);
    ct_arena_destroy(a);
}

static void no_rows_leave_nothing_to_do(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    struct ct_damped *d = ct_damped_create(a);
    const struct ct_sparse_rows A = {.arena = a};
    double x[2] = {1, 1};
    ct_damped_factor(d, &A, 0, 0, 2, 1e-8);
    ct_damped_solve(d, x, NULL);
    assert_true(x[0] == 0 && x[1] == 0);
    ct_arena_destroy(a);
}

// Rank by dense QR with pivoting.
static int dense_rank(const struct sample *s)
{
    static double D[MOST * MOST], work[100 * MOST];
    double tau[MOST];
    int column[MOST];
    memcpy(D, s->A, sizeof D);
    return ct_qr_pivot(D, column, tau, s->m, s->n, s->m, 1e-9, work);
}

static void pivots_show_the_rank(void **unused)
{
    (void)unused;
    struct sample s, kept;
    for (int k = 0; k < 40; k++) {
        struct ct_arena *a = ct_arena_create();
        int row[MOST], column[MOST];
        bool is_clear;
        draw(&s, 6 + k % 30, 4 + (11 * k) % 35, k % 4 ? 2 : 0);
        const struct ct_sparse_entries A
            = {(size_t)s.m, (size_t)s.n, s.nentry, s.row, s.column, s.value};
        const int rank = (int)ct_sparse_pivots_find(a, &A, 1e-9, row, column, &is_clear);
        assert_true(is_clear);
        assert_int_equal(rank, dense_rank(&s));
        memset(&kept, 0, sizeof kept); // rows and columns of the pivots are a regular matrix
        kept.m = kept.n = rank;
        for (int i = 0; i < rank; i++)
            for (int j = 0; j < rank; j++)
                kept.A[i + rank * j] = s.A[row[i] + s.m * column[j]];
        assert_int_equal(dense_rank(&kept), rank);
        for (int i = rank + 1; i < s.m; i++)
            assert_true(row[i] > row[i - 1]); // the rest ascends
        ct_arena_destroy(a);
    }
}

static void doubtful_rows_are_reported(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    const int at[] = {0, 0, 1, 1}, column[] = {0, 1, 0, 1};
    double value[] = {1, 1, 1, 1 + 3e-9};
    int row[2], pivot[2];
    bool is_clear;
    const struct ct_sparse_entries A = {2, 2, 4, at, column, value};
    ct_sparse_pivots_find(a, &A, 1e-9, row, pivot, &is_clear);
    assert_false(is_clear);
    value[3] = 1;
    assert_int_equal(ct_sparse_pivots_find(a, &A, 1e-9, row, pivot, &is_clear), 1);
    assert_true(is_clear);
    ct_arena_destroy(a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(damped_solutions_are_those_of_dense_matrices),
        cmocka_unit_test(little_damping_gives_the_shortest_solution),
        cmocka_unit_test(further_rows_count_where_the_first_leave_freedom),
        cmocka_unit_test(no_rows_leave_nothing_to_do),
        cmocka_unit_test(pivots_show_the_rank),
        cmocka_unit_test(doubtful_rows_are_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
