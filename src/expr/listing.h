// Expressions as linear intermediate code: three-address code in single assignment form, the input
// of every back end.
//
//     values        v0  v1  v2 ...      one per live node, in the order of ids
//     instructions  [ prologue: parameters only | body: the rest ]     each in the order of ids
//
// The tape (tape.h), native code (codegen/native.h) and C source (codegen/c.h) are all made from
// one listing. They execute the same instructions on the same operands. Only the order of
// instructions differs, so their results agree to the bit. The sine and cosine of one argument are
// one instruction with two results.
//
// What always holds: the arguments of an instruction are leaves or results of earlier instructions.
// The listing contains only what the outputs need. The same expressions give the same listing.
#ifndef CT_EXPR_LISTING_H
#define CT_EXPR_LISTING_H

#include "expr/ex.h"

#define CT_VALUE_NONE UINT32_MAX

/// Operators of instructions that are no operators of nodes. w[res] are the results.
enum {
    CT_OP_SINCOS = CT_OP_COUNT, // res[0] = sin(a), res[1] = cos(a)
    // sine or cosine by ct_sincos (sincos.h), used where the body has several angles: a back end
    // evaluates many in one call
    CT_OP_ANGLE_SIN,
    CT_OP_ANGLE_COS,
    CT_OP_ANGLE_SINCOS,
    CT_OP_FMA,  // a b + c, rounded once
    CT_OP_FMS,  // a b - c
    CT_OP_FNMA, // c - a b
    CT_NKIND
};

/// How often a value changes: never, with the parameters, at each call. Constant operations that
/// construction did not fold (0/0) belong to the prologue.
enum ct_rate { CT_RATE_NEVER, CT_RATE_PARAM, CT_RATE_CALL };

struct ct_instruction {
    unsigned char op; // enum ct_op or one of the above
    unsigned char narg, nres;
    unsigned char order;     // of CT_OP_TABLE, and the table
    uint32_t arg[3], res[2]; // values
    uint32_t table;
};

struct ct_tape_counts {
    long multiplications, additions, divisions,
        functions; // of the body; functions: sin, cos, ...
};

/// Contraction of a product that is used once, in a sum, to a fused multiply-add. NO: never. YES:
/// in all back ends, with equal bits. NATIVE: in native code only, so that results of back ends
/// differ by round-off (native.h).
enum ct_fuse { CT_FUSE_NO, CT_FUSE_YES, CT_FUSE_NATIVE };

struct ct_listing {
    const struct ct_exs *x;
    enum ct_fuse fuse;
    size_t nvalue;
    uint32_t *node;         // by value: id of its node
    unsigned char *rate;    // by value: enum ct_rate
    unsigned char *is_leaf; // by value: a constant or a symbol
    uint32_t *input; // by value: index in the input vector if a symbol, else CT_VALUE_NONE
    struct ct_instruction *ins;
    size_t nins, nprologue;
    uint32_t *out; // value of each output
    size_t nout;
    const struct ct_table *table; // copied: remains valid when the store grows
    struct ct_tape_counts counts;
};

/// Make the listing of nout expressions. Inputs: in[k] is a symbol whose value is read from the
/// input vector at slot[k] (distinct). Symbols of kind PARAM among them are inputs of the prologue.
/// A symbol that is needed but not among the inputs is a program error (asserted). Cost: the nodes
/// below.
const struct ct_listing *ct_listing_create(struct ct_arena *a, const struct ct_exs *x,
                                           const ct_ex *out, size_t nout, const ct_ex *in,
                                           const size_t *slot, size_t nin, enum ct_fuse fuse);

/// A copy of the listing in which the products of the body are fused. Cost: instructions.
const struct ct_listing *ct_listing_fuse(struct ct_arena *a, const struct ct_listing *l);

/// A copy of the listing in which all sines and cosines use the SIMD kernel, for evaluation in SIMD
/// lanes. Results may differ from those of l in the last place.
const struct ct_listing *ct_listing_for_lanes(struct ct_arena *a, const struct ct_listing *l);

/// Instructions that read value v: use[start[v] ... start[v + 1]), ascending. An instruction that
/// reads v twice is listed twice.
struct ct_uses {
    uint32_t *start, *use;
};
struct ct_uses ct_listing_uses(struct ct_arena *a, const struct ct_listing *l);

/// Does the listing contain sines or cosines by ct_sincos?
bool ct_listing_has_angles(const struct ct_listing *l);

/// Apply one instruction to numbers; arg and res as in struct ct_instruction.
void ct_instruction_apply(const struct ct_listing *l, const struct ct_instruction *i,
                          const double arg[3], double res[2]);

/// Count the operations of a set of expressions without a listing: each node once, parameter-only
/// nodes not counted. Subtractions count as additions; negation is free. Cost: the nodes below.
struct ct_tape_counts ct_ex_count(struct ct_arena *scratch, const struct ct_exs *x,
                                  const ct_ex *e, size_t n);

#endif
