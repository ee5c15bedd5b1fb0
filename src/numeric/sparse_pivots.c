// See sparse_pivots.h.
#include "numeric/sparse_pivots.h"

#include <math.h>

// Pivots relative to the largest remaining entry in the row. Derived: entries grow by at most 1 +
// 1/0.5 = 3 per step.
static const double threshold = 0.5;
// Number of rows searched for a pivot. Definition: of the method (Zlatev: three or four).
enum { MOST_ROWS = 4 };

struct line {
    int *at;       // columns of a row, or rows of a column
    double *value; // of a row
    size_t n, cap, value_cap;
    bool is_done;
};

struct elimination {
    struct ct_arena *a;
    size_t m, n;
    struct line *row, *column; // eliminated rows stay in the lists of columns
    size_t *count;             // by column: number of rows left
    int *head, *next,
        *before; // doubly linked lists of the rows left, by number of entries; -1 at the ends
    int *place;  // by column: 1 + its index in the current row
    double least;
    bool is_clear;
};

struct pivot {
    int row;
    size_t k; // index among the row's entries
    double cost, size;
};

// ---- rows by length -----------------------------------------------------------------------------

static void unlink_row(struct elimination *s, int i)
{
    if (s->before[i] >= 0)
        s->next[s->before[i]] = s->next[i];
    else
        s->head[s->row[i].n] = s->next[i];
    if (s->next[i] >= 0)
        s->before[s->next[i]] = s->before[i];
}

static void link_row(struct elimination *s, int i)
{
    int *head = &s->head[s->row[i].n];
    s->before[i] = -1;
    s->next[i] = *head;
    if (*head >= 0)
        s->before[*head] = i;
    *head = i;
}

// ---- the matrix ---------------------------------------------------------------------------------

static void append(struct elimination *s, int i, int j, double value)
{
    struct line *row = &s->row[i], *column = &s->column[j];
    size_t n = row->n;
    CT_PUSH(s->a, row->value, n, row->value_cap, value);
    CT_PUSH(s->a, row->at, row->n, row->cap, j);
    CT_PUSH(s->a, column->at, column->n, column->cap, i);
    s->count[j]++;
}

static struct elimination begin(struct ct_arena *a, const struct ct_sparse_entries *A,
                                double least)
{
    struct elimination s = {.a = a, .m = A->m, .n = A->n, .least = least, .is_clear = true};
    s.row = CT_NEWN(a, struct line, A->m + 1);
    s.column = CT_NEWN(a, struct line, A->n + 1);
    s.count = CT_NEWN(a, size_t, A->n + 1);
    s.head = CT_NEWN(a, int, A->n + 1);
    s.next = CT_NEWN(a, int, A->m + 1);
    s.before = CT_NEWN(a, int, A->m + 1);
    s.place = CT_NEWN(a, int, A->n + 1);
    for (size_t k = 0; k < A->nentry; k++)
        append(&s, A->row[k], A->column[k], A->value[k]);
    for (size_t k = 0; k <= A->n; k++)
        s.head[k] = -1;
    for (size_t i = A->m; i-- > 0;) // descending, so that the first row is at the head
        link_row(&s, (int)i);
    return s;
}

// Remove row i from the lists.
static void finish_row(struct elimination *s, int i)
{
    const struct line *row = &s->row[i];
    unlink_row(s, i);
    s->row[i].is_done = true;
    for (size_t k = 0; k < row->n; k++)
        s->count[row->at[k]]--;
}

// Subtract a multiple of the pivot row from row i, so that its entry in the pivot column vanishes.
// s->place: of the pivot row.
static void eliminate(struct elimination *s, const struct pivot *p, int i)
{
    struct line *row = &s->row[i];
    const struct line *from = &s->row[p->row];
    const int j = from->at[p->k];
    size_t k = 0;
    while (row->at[k] != j)
        k++;
    const double f = row->value[k] / from->value[p->k];
    unlink_row(s, i);
    row->at[k] = row->at[--row->n];
    row->value[k] = row->value[row->n];
    for (k = 0; k < row->n; k++) {
        int *place = &s->place[row->at[k]];
        if (*place > 0) {
            row->value[k] -= f * from->value[*place - 1];
            *place = -*place; // not a fill entry
        }
    }
    for (k = 0; k < from->n; k++) {
        int *place = &s->place[from->at[k]];
        if (*place > 0 && k != p->k)
            append(s, i, from->at[k], -f * from->value[k]);
        *place = (int)k + 1;
    }
    link_row(s, i);
}

static void eliminate_all(struct elimination *s, const struct pivot *p)
{
    struct line *row = &s->row[p->row];
    const struct line *column = &s->column[row->at[p->k]];
    finish_row(s, p->row);
    for (size_t k = 0; k < row->n; k++)
        s->place[row->at[k]] = (int)k + 1;
    for (size_t k = 0; k < column->n; k++)
        if (!s->row[column->at[k]].is_done)
            eliminate(s, p, column->at[k]);
    for (size_t k = 0; k < row->n; k++)
        s->place[row->at[k]] = 0;
}

// ---- choice -------------------------------------------------------------------------------------

static double largest_of(const struct line *row)
{
    double most = 0;
    for (size_t k = 0; k < row->n; k++)
        most = fabs(row->value[k]) > most ? fabs(row->value[k]) : most;
    return most;
}

// Update the best pivot p by the entries of row i, whose largest is `most`.
static void look_at_row(const struct elimination *s, int i, double most, struct pivot *p)
{
    const struct line *row = &s->row[i];
    for (size_t k = 0; k < row->n; k++) {
        const double size = fabs(row->value[k]);
        const double cost = (double)(row->n - 1) * (double)(s->count[row->at[k]] - 1);
        if (size >= threshold * most
            && (p->row < 0 || cost < p->cost || (cost <= p->cost && size > p->size)))
            *p = (struct pivot){i, k, cost, size};
    }
}

// Choose a pivot. False if no row has entries left.
static bool choose(struct elimination *s, struct pivot *p)
{
    const double near = 100; // Limit: rows nearer to the least size are left to the dense QR
    *p = (struct pivot){.row = -1};
    for (size_t length = 0, nrow = 0; length <= s->n && nrow < MOST_ROWS; length++)
        for (int i = s->head[length], next; i >= 0 && nrow < MOST_ROWS; i = next) {
            const double most = largest_of(&s->row[i]);
            next = s->next[i];
            s->is_clear = s->is_clear && !(most < near * s->least && most > s->least / near);
            if (!(most > s->least)) {
                finish_row(s, i);
                continue;
            }
            look_at_row(s, i, most, p);
            nrow++;
        }
    return p->row >= 0;
}

// Append the rows (columns) that are no pivots.
static void list_rest(const bool *is_pivot, size_t n, size_t rank, int *list)
{
    for (size_t i = 0; i < n; i++)
        if (!is_pivot[i])
            list[rank++] = (int)i;
}

size_t ct_sparse_pivots_find(struct ct_arena *scratch, const struct ct_sparse_entries *A,
                             double least, int *row, int *column, bool *is_clear)
{
    struct elimination s = begin(scratch, A, least);
    bool *is_row = CT_NEWN(scratch, bool, A->m + 1),
         *is_column = CT_NEWN(scratch, bool, A->n + 1);
    struct pivot p;
    size_t rank = 0;
    for (; choose(&s, &p); rank++) {
        row[rank] = p.row;
        column[rank] = s.row[p.row].at[p.k];
        is_row[row[rank]] = is_column[column[rank]] = true;
        eliminate_all(&s, &p);
    }
    list_rest(is_row, A->m, rank, row);
    list_rest(is_column, A->n, rank, column);
    *is_clear = s.is_clear;
    return rank;
}
