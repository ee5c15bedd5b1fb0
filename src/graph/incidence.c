// Compressed columns of -1 and +1; see graph.h.
#include "graph/graph.h"

int *ct_incidence_create(struct ct_arena *a, int nrow, int ncol, int *start,
                         struct ct_incidence *S)
{
    int *next = CT_NEWN(a, int, ncol);
    for (int j = 0; j < ncol; j++) {
        next[j] = start[j];
        start[j + 1] += start[j];
    }
    *S = (struct ct_incidence){nrow, ncol, start, CT_NEWN(a, int, start[ncol]),
                               CT_NEWN(a, signed char, start[ncol])};
    return next;
}

void ct_incidence_transpose(struct ct_arena *a, const struct ct_incidence *S,
                            struct ct_incidence *St)
{
    const int nentry = S->start[S->ncol];
    // counts are stored two indices ahead: after summation and filling, start[] holds the column
    // starts
    int *start = CT_NEWN(a, int, S->nrow + 2);
    for (int k = 0; k < nentry; k++)
        start[S->row[k] + 2]++;
    for (int i = 0; i < S->nrow; i++)
        start[i + 2] += start[i + 1];
    *St = (struct ct_incidence){S->ncol, S->nrow, start, CT_NEWN(a, int, nentry),
                                CT_NEWN(a, signed char, nentry)};
    for (int j = 0; j < S->ncol; j++) // ascending: the rows of a column come out sorted
        for (int k = S->start[j]; k < S->start[j + 1]; k++) {
            const int place = start[S->row[k] + 1]++;
            St->row[place] = j;
            St->value[place] = S->value[k];
        }
}
