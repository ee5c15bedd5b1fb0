// Sparse rows of expressions. Each entry also has its value at one state, the numeric probe.
#ifndef CT_FORMULATE_CLOSED_FORM_NUMERIC_PROBE_H
#define CT_FORMULATE_CLOSED_FORM_NUMERIC_PROBE_H

#include "expr/ex.h"

struct ct_probed_entry {
    int column;
    ct_ex value;
    double number; // the value at the state of the probe
};

struct ct_probed_row { // columns ascending
    struct ct_probed_entry *e;
    size_t n, cap;
};

/// Appends an entry.
void ct_probed_row_append(struct ct_arena *a, struct ct_probed_row *l, int column, ct_ex value,
                          double number);
/// Finds the entry of a column; NULL: none.
const struct ct_probed_entry *ct_probed_row_find(const struct ct_probed_row *l, int column);
/// Sorts the entries of n rows by column.
void ct_probed_rows_sort(struct ct_probed_row *l, size_t n);

#endif
