// A square sparse matrix of expressions, factored in blocks of one or two rows: J_d = L U of
// elimination.h.
//
//     left   what elimination has left of J: in the rows of block k its pivots, and in the columns of later
//            blocks U; columns that are not eliminated are carried along
//     step   L: row -= factor * rows of a block
//
// Pivots are taken where they cost least among those that are large enough at the state of the
// probe.
//
// What always holds: the columns of a block are in no row that is still to be done.
#ifndef CT_FORMULATE_CLOSED_FORM_BLOCK_ELIMINATION_H
#define CT_FORMULATE_CLOSED_FORM_BLOCK_ELIMINATION_H

#include "formulate/closed_form/numeric_probe.h"

/// Pivots P of one or two rows, by their numbers: P^-1 is the adjoint divided by the determinant.
/// The quotient is taken last, so that a row that repeats the pivot's gives 1 exactly: mechanisms
/// of equal parts stay symmetric to the last bit.
struct ct_block {
    int size, row[2], column[2];
    ct_ex adjoint[4], pivot;                  // by rows; the determinant
    double number[4], pivot_number, strength; // at the state of the probe
};

/// row -= factor * rows of the block
struct ct_block_step {
    int row, block;
    ct_ex factor[2];
};

/// What block_of says of a column without a block.
/// Part of the largest entries of its rows from which a pivot is large enough. Definition: as of
/// sparse solvers (numeric/klu_include.h), with sums of large forces along beams in the rows.
#define CT_TIGHT_PIVOT 0.1

enum { CT_BLOCK_NEVER = -1, CT_BLOCK_OPEN = -2 }; // Definition: no index of a block

struct ct_blocks {
    struct ct_arena *a;
    struct ct_exs *x;
    size_t rank, nu;            // rows; columns
    int *group;                 // (rank) two rows of one group (>= 0) may be one block
    struct ct_probed_row *left; // (rank)
    bool *is_done;              // (rank)
    int *block_of;              // (nu)
    int *level, *count; // (rank) steps that must come before; (nu) open rows with that column
    struct ct_block *block;
    size_t nblock;
    struct ct_block_step *step;
    size_t nstep, step_cap;
};

/// Nothing is factored; the caller fills left, group and block_of, of whose columns `rank` are
/// open. Lives in a.
struct ct_blocks ct_blocks_create(struct ct_arena *a, struct ct_exs *x, size_t rank, size_t nu);
/// Factor; false if the matrix is singular at the probe, or x grows beyond most_nodes.
bool ct_blocks_factor(struct ct_blocks *s, size_t most_nodes);
/// x (nu, out in the dependent places) = J_d^-1 r; r (rank) is lost.
void ct_blocks_solve(struct ct_blocks *s, ct_ex *r, ct_ex *x);
/// lam (rank, out) = J_d^-T w (nu).
void ct_blocks_solve_transposed(struct ct_blocks *s, const ct_ex *w, ct_ex *lam);
/// x (nu, out in the dependent places) = -J_d^-1 j, j a column that is not eliminated.
void ct_blocks_solve_column(struct ct_blocks *s, int column, ct_ex *x);
/// Does v depend on more than parameters?
bool ct_blocks_moves(const struct ct_blocks *s, ct_ex v);

#endif
