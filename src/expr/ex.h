// The expression graph: one hash-consed store of nodes (value numbering: common subexpressions are
// one node).
//
// src/expr builds, differentiates, simplifies and evaluates expressions:
//
//     text -> graph      parse, unit, quantity
//     derivatives        diff (symbolic forward, reverse gradient), jacobian (sparse,
//                        symbolic), dual (sparse, numeric), pattern (sparsity), scarcity (vertex elimination)
//     for reading        collect, expand, identity, regroup; fraction; share (names for common
//                        subexpressions); print, term, notation
//     for evaluation     listing (linear intermediate code), tape (interpreter), sincos
//     along a symbol     quadrature, switches (jumps and kinks)
//
// It knows no mechanics: a symbol is a name, a kind and an index.
//
//     id   0    1     2      3        4          5
//          0    1    theta  sin(2)   m        mul(4,3)      children have smaller ids than parents
//
// What always holds: equal ids mean equal expressions (up to the local rules below), a node's
// children have smaller ids, so evaluating is a loop upwards and a reverse derivative the same loop
// downwards. Constants are told apart by bit pattern, -0 and 0 are the same node; a NaN is never
// stored as a constant except as the value of an explicit NaN operation at run time.
//
// Local rules applied on construction: constants are folded, 0 and 1 vanish, signs are pulled out
// of products and quotients, commutative operands are ordered by id, x - x = 0, x + x = 2 x, c (d
// x) = (c d) x, sin(-x) = -sin(x), cos(-x) = cos(x), x - (-y) = x + y. Nothing is expanded.
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
    CT_SYM_SWITCH, // 0 or 1: the side of a comparison, constant between events
    CT_SYM_MEMORY, // value kept from the last accepted step (angle of a chord)
    CT_SYM_WORK,   // energy.work: a quadrature beside the states
    CT_SYM_LOCAL, // argument of an expression of its own: coordinate of a custom joint, x of a beam
    CT_SYM_SEED,   // one number of a direction along which derivatives are taken
    CT_SYM_SIGNAL, // a signal name not yet resolved; formulate substitutes it
};

struct ct_sym {
    enum ct_sym_kind kind;
    const char *name; // as printed: "theta.q", "length"
    uint32_t index;   // its place in the vector of its kind
    struct ct_mark mark;
};

/// 16 bytes. CONST: a and b hold the bits of the value. SYM: a indexes the symbols. TABLE: a is the
/// argument, b the table's number, c the order of its derivative.
struct ct_exnode {
    uint32_t op, a, b, c;
};

/// Linked lists of the nodes that share their newest operand (the one with the largest id), for
/// hash consing. first: head of this node's list; next: the node before in its own list; 0: none.
struct ct_exlink {
    uint32_t first, next;
};

/// A sampled function of one variable, for CT_OP_TABLE (drivers from files).
struct ct_table {
    const char *file, *column;
    size_t n;
    const double *x, *y; // x strictly increasing
    const double *m; // slopes at the points (cubic Hermite of the natural spline), NULL: linear
    bool
        holds; // y[i] counts from x[i] on, up to the next one; y[0] before, the last one after all
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
    uint32_t
        *hash; // of constants and what is not linked; open addressing, 0 is free, else id + 1
    size_t hash_size, nhash;
    const char **label; // optional name by node id, for printing; NULL where none
    size_t label_cap;
    unsigned char *decided; // by symbol: ct_ex_value has read its value; NULL: not recorded
    size_t ndecided; // number of symbols when recording began; later ones are not recorded
    // workspace of walks over the graph: a generation stamp and a result per node, a stack
    uint32_t *stamp, generation;
    ct_ex *memo;
    uint32_t *stack;
    size_t walk_cap;
};

void ct_exs_init(struct ct_exs *x, struct ct_arena *arena);
/// A copy that lives and grows in a; ids are the same. Labels stay behind.
struct ct_exs *ct_exs_clone(struct ct_arena *a, const struct ct_exs *from);

// ---- leaves ---------------------------------------------------------------------------------

ct_ex ct_ex_const(struct ct_exs *x, double v);
/// A new symbol each time; keep the handle.
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
/// Give a node a name by meaning ("rod.position.x"); the first name stays.
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

/// Nodes below the n roots (each once, children before parents) written to x->stack; returns their
/// number. The list holds until the next walk. Cost: the nodes below.
size_t ct_ex_walk(struct ct_exs *x, const ct_ex *root, size_t n);
/// The same, of those nodes alone that have symbols of some of these kinds (ct_ex_kinds) below them.
size_t ct_ex_walk_kinds(struct ct_exs *x, const ct_ex *root, size_t n, unsigned kinds);

/// da/ds for a symbol s; comparisons and sign have derivative 0, `if` differentiates its branches.
/// Cost: nodes below a that have symbols of the kind of s below them, each once.
ct_ex ct_ex_diff(struct ct_exs *x, ct_ex a, ct_ex s);
/// The same where the last walk was ct_ex_walk_kinds(x, &a, 1, kind of s) = n: one walk for all symbols of a kind.
ct_ex ct_ex_diff_walked(struct ct_exs *x, size_t n, ct_ex a, ct_ex s);
/// Sum over i of da/ds[i] * ds[i]: the directional (or total time) derivative. Same cost.
ct_ex ct_ex_diff_along(struct ct_exs *x, ct_ex a, const ct_ex *s, const ct_ex *ds, size_t n);
/// Gradient out[i] = da/ds[i] by n symbols in reverse mode. Cost: nodes below a, whatever n.
void ct_ex_gradient(struct ct_exs *x, struct ct_arena *scratch, ct_ex a, const ct_ex *s,
                    size_t n, ct_ex *out);
/// Derivative of node id by its i-th argument, as an expression of the node and its arguments.
ct_ex ct_ex_partial(struct ct_exs *x, uint32_t id, int i);

/// Seed of forward differentiation: d(symbol)/d(direction) = value. A symbol may have several. An
/// inner node may be seeded too: nodes above it then see these directions only, and as a row of f
/// it has the derivatives that follow from its arguments.
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
/// Directions count from 0 to ndirection. Cost: nodes below f for every 64 directions.
size_t ct_ex_pattern(struct ct_exs *x, struct ct_arena *scratch, struct ct_arena *a,
                     const ct_ex *f, size_t nf, const struct ct_seed *seed, size_t nseed,
                     uint32_t ndirection, struct ct_slope **out, double *operations);

/// Entry of a sparse Jacobian at a point.
struct ct_number {
    uint32_t row, direction;
    double value;
};
/// The Jacobian as numbers at value[k] for symbol k, without new nodes: fvalue (nf, out) and the
/// nonzero derivatives, by row, then direction. *out lives in a.
size_t ct_ex_jacobian_at(struct ct_exs *x, struct ct_arena *scratch, struct ct_arena *a,
                         const ct_ex *f, size_t nf, const struct ct_seed *seeds, size_t nseed,
                         const double *value, double *fvalue, struct ct_number **out);

/// a with each symbol from[i] replaced by to[i].
ct_ex ct_ex_subst(struct ct_exs *x, ct_ex a, const ct_ex *from, const ct_ex *to, size_t n);
/// The same for all of a (na) in one walk.
void ct_ex_subst_list(struct ct_exs *x, ct_ex *a, size_t na, const ct_ex *from, const ct_ex *to,
                      size_t n);
/// The same, but nodes without symbols of the kinds of from stay as they are, while the functions above
/// make all nodes anew, which may simplify them. Cost: nodes below a that have such symbols below them.
ct_ex ct_ex_subst_within(struct ct_exs *x, ct_ex a, const ct_ex *from, const ct_ex *to,
                         size_t n);
/// A node that has operands, made in x from image[id] of each operand.
ct_ex ct_ex_rebuild(struct ct_exs *x, struct ct_exnode n, const ct_ex *image);
/// Copy a from store `from` into x; leaf(data, x, from, symbol) gives the node for a symbol.
typedef ct_ex (*ct_ex_leaf_fn)(void *data, struct ct_exs *x, const struct ct_exs *from,
                               ct_ex s);
ct_ex ct_ex_import(struct ct_exs *x, const struct ct_exs *from, ct_ex a, ct_ex_leaf_fn leaf,
                   void *data);
/// Value with value[k] for symbol k (index into x->sym). Slow; for checks, defaults and tests.
double ct_ex_value(const struct ct_exs *x, ct_ex a, const double *value);
/// out (n) = the values of many that share nodes, each node once.
void ct_ex_values(struct ct_exs *x, struct ct_arena *scratch, const ct_ex *a, size_t n,
                  const double *value, double *out);
/// One operator on numbers: what every evaluator must agree with.
double ct_op_apply(enum ct_op op, double a, double b, double c);
/// Its derivative by the i-th argument, where its value is v; of all but CT_OP_TABLE.
double ct_op_partial(enum ct_op op, int i, double a, double b, double v);
/// Value of the order-th derivative of a table at x; NaN outside its range, which one that holds does not have.
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
/// Rotation about the unit vector n by the angle a (right-handed): columns are the turned axes.
ct_ex33 ct_ex33_axis_angle(struct ct_exs *x, ct_ex3 n, ct_ex a);

#endif
