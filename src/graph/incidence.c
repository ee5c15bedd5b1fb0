// Compressed columns of -1, +1; see graph.h.
#include "graph/graph.h"

void ct_incidence_transpose(struct ct_arena *a, const struct ct_incidence *S,
                            struct ct_incidence *St)
{
    const int nentry = S->start[S->ncol];
    // counted two places ahead and summed, so that filling leaves start[] right
    int *start = CT_NEWN(a, int, S->nrow + 2);
    for (int k = 0; k < nentry; k++)
        start[S->row[k] + 2]++;
    for (int i = 0; i < S->nrow; i++)
        start[i + 2] += start[i + 1];
    *St = (struct ct_incidence){S->ncol, S->nrow, start, CT_NEWN(a, int, nentry),
                                CT_NEWN(a, signed char, nentry)};
    for (int j = 0; j < S->ncol; j++) // ascending, so the rows of a column come out sorted
        for (int k = S->start[j]; k < S->start[j + 1]; k++) {
            const int place = start[S->row[k] + 1]++;
            St->row[place] = j;
            St->value[place] = S->value[k];
        }
}
