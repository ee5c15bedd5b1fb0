// Answers to residuals against the system (8.2) written out and solved.
#include "integrate/response.h"
#include "numeric/dense.h"
#include "numeric/four.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

enum { MOST = CT_MOST_INVERTED, MOST_OUT = 24 };

// n terms of order 1, growing with the condition of matrices that are random: a hundred times over
static const double close_enough = 1e4 * DBL_EPSILON;

static uint64_t state = 20240229; // the seed; the same numbers in every run

static double uniform(void) // in [-1, 1)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(int64_t)(state >> 11) / 4503599627370496.0 - 1;
}

struct problem {
    int nu, m;
    double M[MOST * MOST], C[MOST * MOST], K[MOST * MOST], J[MOST * MOST], D[MOST * MOST];
};

static void make(struct problem *p, int nu, int m)
{
    *p = (struct problem){.nu = nu, .m = m};
    for (int i = 0; i < nu * nu; i++) {
        p->M[i] = uniform() / 2;
        p->C[i] = uniform();
        p->K[i] = uniform();
    }
    for (int i = 0; i < nu; i++)
        p->M[i + nu * i] += 3;
    for (int i = 0; i < nu * m; i++) {
        p->J[i] = uniform();
        p->D[i] = uniform();
    }
    for (int i = 0; i < m; i++)
        p->J[i + m * i] += 2;
}

// A (n x n, out): the matrix of (8.2).
static void write_out(double _Complex *A, const struct problem *p, double _Complex c,
                      double _Complex e)
{
    const int nu = p->nu, m = p->m, n = nu + 2 * m;
    double _Complex B[MOST * MOST] = {0};
    memset(A, 0, (size_t)(n * n) * sizeof *A);
    for (int i = 0; i < nu * nu; i++) {
        B[i] = p->M[i] + c / e * p->C[i];
        A[i % nu + n * (i / nu)] = B[i] + p->K[i] / e;
    }
    for (int i = 0; i < m; i++)
        for (int k = 0; k < nu; k++) {
            const double push = p->J[i + m * k];
            A[nu + i + n * k] = push;
            A[nu + m + i + n * k] = push + p->D[i + m * k] / c;
            A[k + n * (nu + m + i)] = -push;
            for (int l = 0; l < nu; l++)
                A[l + n * (nu + i)] -= B[l + nu * k] * push;
            for (int l = 0; l < m; l++)
                A[nu + m + l + n * (nu + i)] -= p->J[l + m * k] * push;
        }
}

// x (2 nu + m, out): d, the change of speeds and lam for r, phi, v (b).
static void solve(double _Complex *x, const struct problem *p, const double _Complex *b,
                  double _Complex c, double _Complex e)
{
    const int nu = p->nu, m = p->m, n = nu + 2 * m;
    double _Complex A[MOST * MOST], right[MOST];
    int pivot[MOST];
    write_out(A, p, c, e);
    for (int i = 0; i < n; i++)
        right[i] = -b[i] / (i < nu ? e : i < nu + m ? 1 : c);
    assert_true(ct_lu_complex(A, pivot, n, n));
    ct_lu_complex_solve(right, A, pivot, n, n, 1, n);
    for (int k = 0; k < nu; k++) {
        x[k] = x[nu + k] = right[k];
        for (int i = 0; i < m; i++)
            x[nu + k] -= p->J[i + m * k] * right[nu + i];
        x[nu + k] *= c;
    }
    for (int i = 0; i < m; i++)
        x[2 * nu + i] = e * right[nu + m + i];
}

static void check_real(const struct problem *p, const struct ct_response *s, double c, double e)
{
    double _Complex b[MOST], x[MOST_OUT];
    for (int i = 0; i < s->in; i++)
        b[i] = uniform();
    solve(x, p, b, c, e);
    for (int k = 0; k < s->rows; k++) {
        double sum = 0;
        for (int j = 0; j < s->in; j++)
            sum += s->real[k + s->rows * j] * creal(b[j]);
        const double want = k < s->out ? creal(x[k]) : 0;
        assert_true(fabs(sum - want) <= close_enough * (1 + fabs(want)));
    }
}

static void check_complex(const struct problem *p, const struct ct_response *s,
                          double _Complex c)
{
    double _Complex b[MOST], x[MOST_OUT];
    for (int i = 0; i < s->in; i++)
        b[i] = uniform() + uniform() * I;
    solve(x, p, b, c, c * c);
    for (int k = 0; k < s->out; k++) {
        double _Complex sum = 0;
        for (int j = 0; j < s->in; j++) {
            const double *re = s->straight + CT_FOUR * (k + s->rows * j),
                         *im = s->crossed + CT_FOUR * (k + s->rows * j);
            assert_true(re[0] == s->real[k + s->rows * j] && re[1] == re[2] && re[3] == 0);
            assert_true(im[0] == 0 && im[1] == -im[2] && im[3] == 0);
            sum += (re[1] + im[2] * I) * b[j];
        }
        assert_true(cabs(sum - x[k]) <= close_enough * (1 + cabs(x[k])));
    }
}

static void answers_solve_the_system_written_out(void **unused)
{
    (void)unused;
    static const int size[][2]
        = {{2, 1}, {3, 1}, {3, 2}, {3, 3}, {4, 4}, {6, 3}, {5, 1}, {10, 1}};
    for (size_t i = 0; i < COUNT(size); i++) {
        const int nu = size[i][0], m = size[i][1];
        struct ct_arena *a = ct_arena_create();
        struct ct_response *s = ct_response_create(a, nu, m, true);
        struct problem p;
        make(&p, nu, m);
        ct_response_set_rows(s, m);
        ct_response_assemble(s, p.M, p.C, p.K, p.J, p.D);
        const double _Complex c = 1.34 + 1.53 * I;
        assert_true(ct_response_find(s, 7, 30) && ct_response_find_complex(s, c));
        check_real(&p, s, 7, 30);
        check_complex(&p, s, c);
        ct_arena_destroy(a);
    }
}

static void rows_that_are_nothing_have_no_answer(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    struct ct_response *s = ct_response_create(a, 3, 2, true);
    struct problem p;
    make(&p, 3, 2);
    for (int k = 0; k < 3; k++)
        p.J[1 + 2 * k] = 0;
    ct_response_set_rows(s, 2);
    ct_response_assemble(s, p.M, p.C, p.K, p.J, p.D);
    assert_false(ct_response_find(s, 7, 30));
    assert_false(ct_response_find_complex(s, 2 + 3 * I));
    ct_arena_destroy(a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(answers_solve_the_system_written_out),
        cmocka_unit_test(rows_that_are_nothing_have_no_answer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
