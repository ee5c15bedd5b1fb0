// Fundamental cutsets A_f = [1 A_cut] from the circuits: A_cut = -B_t' (3.2), so (3.3) holds by
// construction. Row i is the cutset of branch i, oriented along it: +1 for the edges that cross
// in its direction.
#include "graph/graph.h"

/// Entries in each column of A_f, counted into start[e + 1]: a chord has as many as its row of
/// B_t, a branch has one.
static void count_columns(const struct ct_tree *t, const struct ct_incidence *Bf, int *start)
{
    for (int i = 0; i < t->nbranch; i++) {
        const int e = t->branch[i];
        start[e + 1]++;
        for (int k = Bf->start[e]; k < Bf->start[e + 1]; k++)
            start[t->chord[Bf->row[k]] + 1]++;
    }
}

void ct_cutsets_derive(struct ct_arena *a, const struct ct_graph *g, const struct ct_tree *t,
                       struct ct_incidence *Af)
{
    struct ct_incidence Bf;
    ct_circuits_derive(a, g, t, &Bf);
    int *start = CT_NEWN(a, int, g->nedge + 1);
    count_columns(t, &Bf, start);

    int *next = ct_incidence_create(a, t->nbranch, g->nedge, start, Af);
    for (int i = 0; i < t->nbranch; i++) { // ascending: the rows of a column come out sorted
        const int e = t->branch[i];
        Af->row[next[e]] = i;
        Af->value[next[e]++] = 1;
        for (int k = Bf.start[e]; k < Bf.start[e + 1]; k++) {
            const int c = t->chord[Bf.row[k]];
            Af->row[next[c]] = i;
            Af->value[next[c]++] = (signed char)-Bf.value[k];
        }
    }
}
