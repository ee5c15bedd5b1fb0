// Takahashi's recursion; see selected_inverse.h.
//
// Z(i, j) is stored at the index of entry (j, i) of L + U. With l in row i of U and k in column i
// of L,
//
//     Z(l, i) = - sum_k Z(l, k) L(k, i),   Z(i, k) = - sum_l U(i, l) Z(l, k) / U(i, i),
//     Z(i, i) = (1 - sum_l U(i, l) Z(l, i)) / U(i, i)
#include "numeric/selected_inverse.h"

struct ct_selected_inverse {
    const struct ct_lu_factors *t;
    int *row_start, *in_row; // U without its diagonal, by rows: row starts, indices of entries
    int *column_of;          // by entry of U
    // indices of Z(l, k), in the order of the recursion: i descending, each l, each k
    int *factor;
    double *Z; // entries on the pattern of U, then of L
};

// Index of entry (row, column) in sorted columns.
static int find_place(const int *start, const int *rows, int row, int column)
{
    int low = start[column], high = start[column + 1] - 1;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (rows[middle] < row)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

int ct_selected_inverse_index(const struct ct_selected_inverse *s, int i, int j)
{
    const struct ct_lu_factors *t = s->t;
    return j <= i ? find_place(t->U_start, t->U_row, j, i)
                  : t->U_start[t->n] + find_place(t->L_start, t->L_row, j, i);
}

static void list_rows(struct ct_arena *a, struct ct_selected_inverse *s)
{
    const struct ct_lu_factors *t = s->t;
    const int n = t->n;
    s->row_start = CT_NEWN(a, int, n + 2);
    s->in_row = CT_NEWN(a, int, t->U_start[n] + 1);
    s->column_of = CT_NEWN(a, int, t->U_start[n] + 1);
    for (int j = 0; j < n; j++)
        for (int k = t->U_start[j]; k < t->U_start[j + 1] - 1; k++)
            s->row_start[t->U_row[k] + 2]++;
    for (int i = 2; i < n + 2; i++)
        s->row_start[i] += s->row_start[i - 1];
    for (int j = 0; j < n; j++)
        for (int k = t->U_start[j]; k < t->U_start[j + 1] - 1; k++) {
            s->column_of[k] = j;
            s->in_row[s->row_start[t->U_row[k] + 1]++] = k;
        }
}

struct ct_selected_inverse *ct_selected_inverse_create(struct ct_arena *a,
                                                       const struct ct_lu_factors *t)
{
    struct ct_selected_inverse *s = CT_NEW(a, struct ct_selected_inverse);
    const int n = t->n;
    size_t nfactor = 0, at = 0;
    s->t = t;
    list_rows(a, s);
    for (int i = 0; i < n; i++)
        nfactor += (size_t)(s->row_start[i + 1] - s->row_start[i])
                 * (size_t)(t->L_start[i + 1] - t->L_start[i] - 1);
    s->factor = CT_NEWN(a, int, nfactor + 1);
    for (int i = n - 1; i >= 0; i--)
        for (int l = s->row_start[i]; l < s->row_start[i + 1]; l++)
            for (int k = t->L_start[i] + 1; k < t->L_start[i + 1]; k++)
                s->factor[at++]
                    = ct_selected_inverse_index(s, s->column_of[s->in_row[l]], t->L_row[k]);
    s->Z = CT_NEWN(a, double, t->U_start[n] + t->L_start[n] + 1);
    return s;
}

const double *ct_selected_inverse_compute(struct ct_selected_inverse *s)
{
    const struct ct_lu_factors *t = s->t;
    const int *place = s->factor;
    double *Z = s->Z, *of_L = Z + t->U_start[t->n];
    for (int i = t->n - 1; i >= 0; i--) {
        const int first = t->L_start[i] + 1, end = t->L_start[i + 1];
        const int diagonal = t->U_start[i + 1] - 1;
        double left = 1;
        for (int k = first; k < end; k++)
            of_L[k] = 0;
        for (int l = s->row_start[i]; l < s->row_start[i + 1]; l++) {
            const double u = t->U[s->in_row[l]];
            double z = 0;
            for (int k = first; k < end; k++, place++) {
                z -= Z[*place] * t->L[k];
                of_L[k] -= u * Z[*place];
            }
            Z[s->in_row[l]] = z;
            left -= u * z;
        }
        for (int k = first; k < end; k++)
            of_L[k] /= t->U[diagonal];
        Z[diagonal] = left / t->U[diagonal];
    }
    return Z;
}
