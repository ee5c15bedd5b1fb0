// src/expr builds, differentiates, simplifies, evaluates and prints symbolic expressions. It holds
// all expressions of a model as one directed acyclic graph. The store is hash-consed: each distinct
// subexpression is one node, so common subexpressions are found as they are built.
//
//     text -> graph      parse, unit, quantity
//     derivatives        diff (forward and reverse mode, symbolic), jacobian (sparse, symbolic),
//                        dual (sparse, numeric), pattern (sparsity), scarcity (vertex elimination)
//     simplification     collect, expand, identity, regroup; normal_form; fraction
//     printing           share (names for common subexpressions), print, term, notation
//     evaluation         listing (linear intermediate code), tape (interpreter), sincos, eval
//     along a symbol     quadrature, switches (jumps and kinks)
//
// The folder knows no mechanics: a symbol is a name, a kind and an index.
//
//     id   0    1     2      3        4          5
//          0    1    theta  sin(2)   m        mul(4,3)      children have smaller ids than parents
//
// What always holds: equal ids mean equal expressions (up to the local rules below). The operands
// of a node have smaller ids. Evaluation is therefore a loop over ascending ids, and reverse mode
// differentiation a loop over descending ids. Constants are compared by bit pattern, except that -0
// and 0 are the same node. A NaN is never stored as a constant; it can only be the result of an
// operation at run time.
//
// Local rules applied on construction: constants are folded, terms 0 and factors 1 are removed,
// signs are pulled out of products and quotients, commutative operands are ordered by id, x - x =
// 0, x + x = 2 x, c (d x) = (c d) x, sin(-x) = -sin(x), cos(-x) = cos(x), x - (-y) = x + y. Nothing
// is expanded.
#ifndef CT_EXPR_EX_H
#define CT_EXPR_EX_H

#include "base/ctx.h"

#include <stdint.h>

typedef struct {
    uint32_t id;
} ct_ex;

typedef struct {
    ct_ex e[3];
} ct_ex3; // three components in some frame

typedef struct {
    ct_ex e[9];
} ct_ex33; // column-major 3 x 3, e[row + 3 * column]

enum ct_op {
#define OP(op, narg, name, value) op,
#include "expr/ops.def"
#undef OP
    CT_OP_COUNT
};

extern const struct ct_op_info {
    const char *name;
    int narg;
} ct_op_info[CT_OP_COUNT];

/// What a symbol stands for. The kind decides who gives its value at run time.
enum ct_sym_kind {
    CT_SYM_TIME,   // t                                                     [s]
    CT_SYM_PARAM,  // a model parameter, constant during a run
    CT_SYM_Q,      // stored coordinate (quaternions have four)
    CT_SYM_U,      // speed
    CT_SYM_A,      // derivative of a speed
    CT_SYM_LAM,    // multiplier of a constraint row
    CT_SYM_SWITCH, // 0 or 1: which side of a comparison holds; constant between events
    CT_SYM_MEMORY, // value stored at the last accepted step (e.g. the angle of a chord)
    CT_SYM_WORK,   // energy.work: an integral computed along with the states
    CT_SYM_LOCAL,  // local variable: coordinate of a custom joint, position x along a beam
    CT_SYM_SEED,   // component of a direction along which derivatives are taken
    CT_SYM_SIGNAL, // name of a signal not yet resolved; src/formulate substitutes its expression
};

struct ct_sym {
    enum ct_sym_kind kind;
    const char *name; // as printed: "theta.q", "length"
    uint32_t index;   // index in the vector of its kind
    struct ct_mark mark;
};

/// 16 bytes. CONST: a and b hold the bits of the value. SYM: a indexes the symbols. TABLE: a is the
/// argument, b the table's number, c the order of its derivative.
struct ct_exnode {
    uint32_t op, a, b, c;
};

/// Linked lists for hash consing: each list holds the nodes that share their newest operand (the
/// operand with the largest id). first: head of the list of this node; next: the previous node in
/// the list that contains this node; 0: none.
struct ct_exlink {
    uint32_t first, next;
};

/// A sampled function of one variable, for CT_OP_TABLE (drivers from files).
struct ct_table {
    const char *file, *column;
    size_t n;
    const double *x, *y; // x strictly increasing
    const double *m; // slopes at the points (cubic Hermite of the natural spline), NULL: linear
    // piecewise constant: y[i] from x[i] to x[i + 1]; y[0] before, the last after all
    bool holds;
};

struct ct_exs {
    struct ct_arena *arena;
    struct ct_exnode *node;
    size_t nnode, node_cap;
    struct ct_sym *sym;
    size_t nsym, sym_cap;
    const struct ct_table *table;
    size_t ntable, table_cap;
    uint16_t *kinds;        // per node: bit set of the kinds of symbols below it
    struct ct_exlink *link; // per node
    // constants, and nodes in no list; open addressing: 0 free, else id + 1
    uint32_t *hash;
    size_t hash_size, nhash;
    const char **label; // optional name by node id, for printing; NULL where none
    size_t label_cap;
    unsigned char
        *decided;    // by symbol: ct_ex_value has read its value; NULL: reads are not recorded
    size_t ndecided; // number of symbols when recording began; later ones are not recorded
    // workspace of graph walks: a generation stamp and a result per node, and a stack
    uint32_t *stamp, generation;
    ct_ex *memo;
    uint32_t *stack;
    size_t walk_cap;
};

void ct_exs_init(struct ct_exs *x, struct ct_arena *arena);
/// A copy of the store in a; it can grow, and ids are the same. Labels are not copied. Until it has
/// a node of its own it shares the nodes of `from`, which must live as long and get none before.
struct ct_exs *ct_exs_clone(struct ct_arena *a, const struct ct_exs *from);

// ---- leaves ---------------------------------------------------------------------------------

ct_ex ct_ex_const(struct ct_exs *x, double v);
/// A new symbol at each call, even for an equal name: the caller keeps the handle.
ct_ex ct_ex_sym(struct ct_exs *x, enum ct_sym_kind kind, const char *name, uint32_t index);
#define CT_EX_ZERO ((ct_ex){0})
#define CT_EX_ONE ((ct_ex){1})

// ---- nodes ----------------------------------------------------------------------------------

ct_ex ct_ex_add(struct ct_exs *x, ct_ex a, ct_ex b);
ct_ex ct_ex_sub(struct ct_exs *x, ct_ex a, ct_ex b);
ct_ex ct_ex_mul(struct ct_exs *x, ct_ex a, ct_ex b);
ct_ex ct_ex_div(struct ct_exs *x, ct_ex a, ct_ex b);
ct_ex ct_ex_neg(struct ct_exs *x, ct_ex a);
ct_ex ct_ex_pow(struct ct_exs *x, ct_ex a, ct_ex b);
/// Any operator with one argument (SQRT, SIN, ...).
ct_ex ct_ex_fun(struct ct_exs *x, enum ct_op op, ct_ex a);
/// Any operator with two arguments, ADD and so on included.
ct_ex ct_ex_fun2(struct ct_exs *x, enum ct_op op, ct_ex a, ct_ex b);
/// c != 0 ? a : b
ct_ex ct_ex_if(struct ct_exs *x, ct_ex c, ct_ex a, ct_ex b);
ct_ex ct_ex_table(struct ct_exs *x, uint32_t table, uint32_t order, ct_ex a);
ct_ex ct_ex_scale(struct ct_exs *x, double c, ct_ex a);
/// a + b c and a - b c
ct_ex ct_ex_add_product(struct ct_exs *x, ct_ex a, ct_ex b, ct_ex c);
ct_ex ct_ex_sub_product(struct ct_exs *x, ct_ex a, ct_ex b, ct_ex c);
/// Label a node with a meaningful name ("rod.position.x"). The first label of a node is kept.
void ct_ex_label(struct ct_exs *x, ct_ex a, const char *name);

// ---- questions ------------------------------------------------------------------------------

static inline const struct ct_exnode *ct_ex_node(const struct ct_exs *x, ct_ex a)
{
    return &x->node[a.id];
}
static inline bool ct_ex_same(ct_ex a, ct_ex b)
{
    return a.id == b.id;
}
static inline bool ct_ex_is_zero(ct_ex a)
{
    return a.id == 0;
}
bool ct_ex_is_const(const struct ct_exs *x, ct_ex a, double *v);
/// The symbol a node stands for, or NULL.
const struct ct_sym *ct_ex_symbol(const struct ct_exs *x, ct_ex a);
/// Bit set (1u << kind) of the kinds of symbols below a.
unsigned ct_ex_kinds(const struct ct_exs *x, ct_ex a);

// ---- derivatives, substitution, values ----------------------------------------------------------

/// Write the nodes below the n roots to x->stack, each once, operands before the nodes that use
/// them. Returns their number. The list is valid until the next walk. Cost: the nodes below.
size_t ct_ex_walk(struct ct_exs *x, const ct_ex *root, size_t n);
/// The same, of those nodes alone that have symbols of some of these kinds (ct_ex_kinds) below
/// them.
size_t ct_ex_walk_kinds(struct ct_exs *x, const ct_ex *root, size_t n, unsigned kinds);

/// da/ds for a symbol s; comparisons and sign have derivative 0, `if` differentiates its branches.
/// Cost: nodes below a that have symbols of the kind of s below them, each once.
ct_ex ct_ex_diff(struct ct_exs *x, ct_ex a, ct_ex s);
/// The same where the last walk was ct_ex_walk_kinds(x, &a, 1, kind of s) = n: one walk for all
/// symbols of a kind.
ct_ex ct_ex_diff_walked(struct ct_exs *x, size_t n, ct_ex a, ct_ex s);
/// Sum over i of da/ds[i] * ds[i]: the directional (or total time) derivative. Same cost.
ct_ex ct_ex_diff_along(struct ct_exs *x, ct_ex a, const ct_ex *s, const ct_ex *ds, size_t n);
/// Gradient out[i] = da/ds[i] for n symbols in reverse mode. Cost: nodes below a, whatever n is.
void ct_ex_gradient(struct ct_exs *x, struct ct_arena *scratch, ct_ex a, const ct_ex *s,
                    size_t n, ct_ex *out);
/// Derivative of node id by its i-th argument, as an expression of the node and its arguments.
ct_ex ct_ex_partial(struct ct_exs *x, uint32_t id, int i);

/// Seed of forward differentiation: d(symbol)/d(direction) = value. A symbol may have several. An
/// inner node may be seeded too. Nodes above it then use these derivatives in place of those of its
/// arguments; if the node is itself an entry of f, its row holds the derivatives that follow from
/// its arguments.
struct ct_seed {
    ct_ex symbol;
    uint32_t direction;
    ct_ex value;
};
/// Entry of a sparse Jacobian: d f[row] / d(direction).
struct ct_slope {
    uint32_t row, direction;
    ct_ex value;
};
/// Sparse Jacobian of f (nf) in all directions of the seeds, nonzeros only, by row, then direction.
/// *out lives in a. Cost: nodes below f times the directions each depends on.
size_t ct_ex_jacobian(struct ct_exs *x, struct ct_arena *scratch, struct ct_arena *a,
                      const ct_ex *f, size_t nf, const struct ct_seed *seeds, size_t nseed,
                      struct ct_slope **out);
/// Sparsity pattern of that Jacobian (values 0, *out lives in a) and an estimate of its operations.
/// Directions are numbered from 0 to ndirection - 1. Cost: nodes below f for every 64 directions.
size_t ct_ex_pattern(struct ct_exs *x, struct ct_arena *scratch, struct ct_arena *a,
                     const ct_ex *f, size_t nf, const struct ct_seed *seed, size_t nseed,
                     uint32_t ndirection, struct ct_slope **out, double *operations);

/// Entry of a sparse Jacobian at a point.
struct ct_number {
    uint32_t row, direction;
    double value;
};
/// The Jacobian as numbers where symbol k has the value value[k]; no new nodes. fvalue (nf, out):
/// values of f. *out (lives in a): nonzero derivatives, by row, then by direction.
size_t ct_ex_jacobian_at(struct ct_exs *x, struct ct_arena *scratch, struct ct_arena *a,
                         const ct_ex *f, size_t nf, const struct ct_seed *seeds, size_t nseed,
                         const double *value, double *fvalue, struct ct_number **out);

/// a with each symbol from[i] replaced by to[i].
ct_ex ct_ex_subst(struct ct_exs *x, ct_ex a, const ct_ex *from, const ct_ex *to, size_t n);
/// The same for all of a (na) in one walk.
void ct_ex_subst_list(struct ct_exs *x, ct_ex *a, size_t na, const ct_ex *from, const ct_ex *to,
                      size_t n);
/// The same, but nodes without symbols of the kinds of from stay as they are. The functions above
/// rebuild all nodes, which may simplify them. Cost: nodes below a that have such symbols below
/// them.
ct_ex ct_ex_subst_within(struct ct_exs *x, ct_ex a, const ct_ex *from, const ct_ex *to,
                         size_t n);
/// A node that has operands, made in x from image[id] of each operand.
ct_ex ct_ex_rebuild(struct ct_exs *x, struct ct_exnode n, const ct_ex *image);
/// Value of a, where value[k] is that of symbol k (index into x->sym). Slow: for checks, defaults
/// and tests.
double ct_ex_value(const struct ct_exs *x, ct_ex a, const double *value);
/// out (n) = values of n expressions that share nodes; each node is evaluated once.
void ct_ex_values(struct ct_exs *x, struct ct_arena *scratch, const ct_ex *a, size_t n,
                  const double *value, double *out);
/// Apply one operator to numbers. Every evaluator must give the same value.
double ct_op_apply(enum ct_op op, double a, double b, double c);
/// Partial derivative of an operator by its i-th argument, where v is the operator's value. All
/// operators but CT_OP_TABLE.
double ct_op_partial(enum ct_op op, int i, double a, double b, double v);
/// Value of the order-th derivative of a table at x. Outside its range: NaN, or the end value of a
/// piecewise constant table.
double ct_table_value(const struct ct_table *t, uint32_t order, double x);

// ---- three components --------------------------------------------------------------------------

ct_ex3 ct_ex3_add(struct ct_exs *x, ct_ex3 a, ct_ex3 b);
ct_ex3 ct_ex3_sub(struct ct_exs *x, ct_ex3 a, ct_ex3 b);
ct_ex3 ct_ex3_neg(struct ct_exs *x, ct_ex3 a);
ct_ex3 ct_ex3_scale(struct ct_exs *x, ct_ex c, ct_ex3 a);
ct_ex3 ct_ex3_cross(struct ct_exs *x, ct_ex3 a, ct_ex3 b);
ct_ex ct_ex3_dot(struct ct_exs *x, ct_ex3 a, ct_ex3 b);
ct_ex3 ct_ex3_const(struct ct_exs *x, const double v[3]);
bool ct_ex3_is_zero(ct_ex3 a);
/// A b, A' b
ct_ex3 ct_ex33_apply(struct ct_exs *x, const ct_ex33 *A, ct_ex3 b);
ct_ex3 ct_ex33_apply_t(struct ct_exs *x, const ct_ex33 *A, ct_ex3 b);
/// A B
ct_ex33 ct_ex33_mul(struct ct_exs *x, const ct_ex33 *A, const ct_ex33 *B);
ct_ex33 ct_ex33_identity(void);
ct_ex33 ct_ex33_transpose(const ct_ex33 *A);
/// Rotation about the unit vector n by the angle a (right-handed): columns are the rotated axes.
ct_ex33 ct_ex33_axis_angle(struct ct_exs *x, ct_ex3 n, ct_ex a);

#endif
