// Natural sizes of constraint rows for the rank test: the size of the terms of which the
// coefficients are sums.  (6.5a)
//
// A coefficient of a row of lengths is  p . (axis x sum d),  with the sum over the vectors d
// along the path between two frames. A coefficient of a row of angles is a product of unit
// vectors. In a redundant constraint these terms cancel down to round-off or to the accuracy of
// the data. The remainder is compared with
//
//     L_i = sum |d|   for rows of lengths [m],   1 for rows of angles and rows without lever arms
//     S_k = max L_i   over the rows of lengths of a translation k [m],   1 for rotations
//     N_i = max(L_i, S_k)
//
// Entries J_ik S_k / N_i are at most of order 1 and have no unit.
#include "solve/evaluator/evaluator.h"

#include "formulate/build.h"
#include "numeric/dense.h"

#include <math.h>
#include <string.h>

// Sum of the row's lever arms |d|; 1 where there are none.
static double lever_sum(const struct ct_evaluator *m, const struct ct_row *row,
                        const double *value)
{
    double sum = 0;
    for (size_t i = 0; i < row->nlever; i++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            const double d = ct_ex_value(m->e->x, row->lever[i].e[k], value);
            square += d * d;
        }
        sum += sqrt(square);
    }
    return sum > 0 && isfinite(sum) ? sum : 1;
}

void ct_evaluator_measure_rows(struct ct_evaluator *m)
{
    const struct ct_equations *e = m->e;
    ct_evaluator_values(m, e->x, m->symbol_value);
    for (size_t i = 0; i < m->nrow; i++)
        m->row_size[i] = lever_sum(m, &e->row[i], m->symbol_value);
    for (size_t k = 0; k < m->nu; k++)
        m->speed_size[k] = 0;
    for (size_t i = 0; i < e->nJ; i++) {
        const struct ct_entry *J = &e->J[i];
        if (e->row[J->row].is_length && !e->u[J->column].is_rotation)
            m->speed_size[J->column] = fmax(m->speed_size[J->column], m->row_size[J->row]);
    }
    for (size_t k = 0; k < m->nu; k++)
        m->speed_size[k] = m->speed_size[k] > 0 ? m->speed_size[k] : 1;
    for (size_t i = 0; i < e->nJ; i++) {
        const struct ct_entry *J = &e->J[i];
        if (e->row[J->row].is_length && !e->u[J->column].is_rotation)
            m->row_size[J->row] = fmax(m->row_size[J->row], m->speed_size[J->column]);
    }
}

// The same for a large system by sparse elimination. -1 if a remaining row is too close to the
// tolerance `least` to decide its rank.
static int order_sparse(const struct ct_evaluator *m, const double *J, double least, int most,
                        int *row)
{
    struct ct_arena *own = ct_arena_create_under(m->arena);
    double *inverse = CT_NEWN(own, double, m->nrow);
    bool is_clear;
    for (size_t i = 0; i < m->nrow; i++)
        inverse[i] = 1 / m->row_size[i];
    const struct ct_sparse_entries A = ct_evaluator_sparse_J(m, own, J, inverse, m->speed_size);
    const size_t rank
        = ct_sparse_pivots_find(own, &A, least, row, CT_NEWN(own, int, m->nu + 1), &is_clear);
    ct_arena_destroy(own);
    return is_clear && rank <= (size_t)most ? (int)rank : -1;
}

int ct_evaluator_order_rows(const struct ct_evaluator *m, const double *J, double least,
                            int *row, double *A, double *tau, double *work)
{
    const int n = (int)m->nu, nrow = (int)m->nrow;
    int rank = 0, most = n < nrow ? n : nrow;
    if (most > (int)m->most_rank)
        most = (int)m->most_rank;
    if (nrow >= CT_LARGE_SYSTEM && (rank = order_sparse(m, J, least, most, row)) >= 0)
        return rank;
    rank = 0;
    for (int i = 0; i < nrow; i++)
        for (int k = 0; k < n; k++)
            A[k + n * i] = J[i + nrow * k] * m->speed_size[k] / m->row_size[i];
    ct_qr_pivot(A, row, tau, n, nrow, n, 0, work);
    while (rank < most && fabs(A[rank + n * rank]) > least)
        rank++;
    return rank;
}

struct ct_sparse_entries ct_evaluator_sparse_J(const struct ct_evaluator *m,
                                               struct ct_arena *scratch, const double *J,
                                               const double *scale_row,
                                               const double *scale_column)
{
    const struct ct_entry *e = m->e->J;
    const size_t n = m->e->nJ;
    int *row = CT_NEWN(scratch, int, n + 1), *column = CT_NEWN(scratch, int, n + 1);
    double *value = CT_NEWN(scratch, double, n + 1);
    for (size_t k = 0; k < n; k++) {
        row[k] = e[k].row;
        column[k] = e[k].column;
        value[k] = J[(size_t)row[k] + m->nrow * (size_t)column[k]];
        value[k] *= scale_row ? scale_row[row[k]] : 1;
        value[k] *= scale_column ? scale_column[column[k]] : 1;
    }
    return (struct ct_sparse_entries){m->nrow, m->nu, n, row, column, value};
}

void ct_evaluator_set_inexact(struct ct_evaluator *m, size_t freedoms)
{
    m->is_inexact = true;
    if (m->e->build->nflexible) // beams may deform where the rigid loops cannot move
        m->rank_tolerance = ct_data_tolerance;
    else
        m->most_rank = m->nu - freedoms;
    memset(m->open, 0, m->nrow * sizeof *m->open);
    memset(m->left_out, 0, m->nrow * sizeof *m->left_out);
    ct_evaluator_constraint(m);
    memcpy(m->open, m->phi, m->nrow * sizeof *m->open);
}

void ct_evaluator_leave_out(struct ct_evaluator *m, const int *row, int rank)
{
    for (int i = 0; i < (int)m->nrow && m->is_inexact; i++)
        m->left_out[row[i]] = i >= rank;
}
