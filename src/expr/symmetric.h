// Symmetric sparse matrices of expressions: mass matrices and their elimination.
//
//     row i   [ column, value ] [ column, value ] ...     by column; (i, j) and (j, i) share a value
//
// What always holds: an entry that was never asked for is zero and takes no memory.
#ifndef CT_EXPR_SYMMETRIC_H
#define CT_EXPR_SYMMETRIC_H

#include "expr/ex.h"

struct ct_symmetric {
    struct ct_arena *arena;
    size_t n;
    struct ct_symmetric_row {
        struct ct_symmetric_place {
            size_t column, value; // index among the values
        } * place;
        size_t n, cap;
    } * row;
    ct_ex *value;
    size_t nvalue, cap;
};

/// The zero matrix (n x n) in an arena.
struct ct_symmetric ct_symmetric_create(struct ct_arena *arena, size_t n);
/// Entry (i, j), to be read and written until the next call. Cost: the logarithm of the length of
/// a row; for a new entry that length at most.
ct_ex *ct_symmetric_at(struct ct_symmetric *s, size_t i, size_t j);
/// The same to be read only: no entry is made.
ct_ex ct_symmetric_get(const struct ct_symmetric *s, size_t i, size_t j);
void ct_symmetric_add(struct ct_exs *x, struct ct_symmetric *s, size_t i, size_t j, ct_ex v);
void ct_symmetric_subtract(struct ct_exs *x, struct ct_symmetric *s, size_t i, size_t j,
                           ct_ex v);

#endif
