// A square sparse matrix of expressions, factored in blocks of one or two rows: J_d = L U of
// elimination.h.
//
//     left   J after elimination: the rows of block k hold its pivots and, in columns of later
//            blocks, U; columns that are not eliminated are updated too
//     step   L: row -= factor * rows of a block
//
// The next pivot is the cheapest one that is large enough at the state of the probe.
//
// What always holds: a row that is not yet eliminated has no entry in the columns of a block.
#ifndef CT_FORMULATE_CLOSED_FORM_BLOCK_ELIMINATION_H
#define CT_FORMULATE_CLOSED_FORM_BLOCK_ELIMINATION_H

#include "formulate/closed_form/numeric_probe.h"

/// A pivot block P of one or two rows: P^-1 is the adjoint divided by the determinant. The division
/// comes last, so that a row equal to the pivot row gives exactly 1. Symmetric mechanisms then stay
/// symmetric to the last bit.
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

/// A pivot is large enough if it exceeds this fraction of the largest entries of its rows.
/// Definition: threshold of sparse solvers (numeric/klu_include.h) for rows with sums of large
/// forces along beams.
#define CT_TIGHT_PIVOT 0.1

/// Values of block_of for a column without a block: it is never eliminated, not yet eliminated.
enum { CT_BLOCK_NEVER = -1, CT_BLOCK_OPEN = -2 }; // Definition: no index of a block

/// A pivot that may come next.
struct ct_block_choice {
    int size, row[2], column[2];
    bool is_loose; // a single variable entry: it may vanish in some configuration
    double cost;   // number of products per row
    int level;
    double strength;
};

struct ct_blocks {
    struct ct_arena *a;
    struct ct_exs *x;
    size_t rank, nu;            // rows; columns
    int *group;                 // (rank) two rows of one group (>= 0) may form a block
    struct ct_probed_row *left; // (rank)
    bool *is_done;              // (rank)
    int *block_of;              // (nu)
    int *level;                 // (rank) number of steps that must come before
    struct ct_block_rows {
        int nopen; // open rows with an entry in the column
        int *row;  // rows that have or had one
        size_t n, cap;
    } * in;                       // (nu)
    struct ct_block_choice *best; // (rank) the best pivot of each row
    bool *is_stale;               // (rank) `best` is out of date
    struct ct_block *block;
    size_t nblock;
    struct ct_block_step *step;
    size_t nstep, step_cap;
};

/// Creates the struct without factoring. The caller fills left, group and block_of, which must have
/// `rank` open columns. Lives in a.
struct ct_blocks ct_blocks_create(struct ct_arena *a, struct ct_exs *x, size_t rank, size_t nu);
/// Factors the matrix. False if it is singular at the probe or x grows beyond most_nodes.
bool ct_blocks_factor(struct ct_blocks *s, size_t most_nodes);
/// x (nu, out, entries of dependent columns) = J_d^-1 r; r (rank) is overwritten.
void ct_blocks_solve(struct ct_blocks *s, ct_ex *r, ct_ex *x);
/// lam (rank, out) = J_d^-T w (nu).
void ct_blocks_solve_transposed(struct ct_blocks *s, const ct_ex *w, ct_ex *lam);
/// x (nu, out, entries of dependent columns) = -J_d^-1 j, j a column that is not eliminated.
void ct_blocks_solve_column(struct ct_blocks *s, int column, ct_ex *x);
/// Does v depend on more than parameters?
bool ct_blocks_moves(const struct ct_blocks *s, ct_ex v);

#endif
