// Positions of the ends of elements; see beam.h.
#include "component/beam.h"
#include "expr/switches.h"

#include <math.h>

static void divide_evenly(struct ct_exs *x, struct ct_arena *a, struct ct_beam *beam, long n)
{
    ct_ex *end = CT_NEWN(a, ct_ex, n);
    for (long i = 0; i < n; i++)
        end[i] = ct_ex_scale(x, (double)(i + 1) / (double)n, beam->length);
    end[n - 1] = beam->length; // exact, without round-off
    beam->end = end;
    beam->nelement = (int)n;
}

void ct_beam_divide(struct ct_exs *x, struct ct_arena *a, struct ct_beam *beam, long n,
                    double length)
{
    long *share = CT_NEWN(a, long, beam->ncut + 1), sum = 0;
    bool is_even = true;
    for (int k = 0; k <= beam->ncut; k++) {
        const double from = k ? beam->cut[k - 1] : 0,
                     to = k < beam->ncut ? beam->cut[k] : length,
                     wanted = (to - from) / length * (double)n;
        share[k] = (long)fmax(ceil(wanted - CT_SAME_PLACE * (double)n), 1);
        sum += share[k];
        is_even &= fabs(to / length * (double)n - (double)sum) <= CT_SAME_PLACE * (double)n;
    }
    beam->is_even = is_even;
    if (is_even) {
        divide_evenly(x, a, beam, n);
        return;
    }
    ct_ex *end = CT_NEWN(a, ct_ex, sum);
    long at = 0;
    for (int k = 0; k <= beam->ncut; k++) {
        const double from = k ? beam->cut[k - 1] : 0,
                     to = k < beam->ncut ? beam->cut[k] : length;
        for (long i = 1; i < share[k]; i++)
            end[at++] = ct_ex_const(x, from + (to - from) * (double)i / (double)share[k]);
        end[at++] = ct_ex_const(x, to);
    }
    end[sum - 1] = beam->length;
    beam->end = end;
    beam->nelement = (int)sum;
}
