// Rows of sparse matrices of expressions, each entry with its value at one state beside it, a numeric shadow.
#ifndef CT_FORMULATE_SHADOW_H
#define CT_FORMULATE_SHADOW_H

#include "expr/ex.h"

struct ct_shadow_entry {
    int column;
    ct_ex value;
    double number; // the value at the state of the shadow
};

struct ct_shadow_row { // columns ascending
    struct ct_shadow_entry *e;
    size_t n, cap;
};

/// Behind the others.
void ct_shadow_put(struct ct_arena *a, struct ct_shadow_row *l, int column, ct_ex value,
                   double number);
/// NULL: there is none.
const struct ct_shadow_entry *ct_shadow_find(const struct ct_shadow_row *l, int column);
/// The entries of n rows by column.
void ct_shadow_sort(struct ct_shadow_row *l, size_t n);

#endif
