// Construction of expression nodes: hash-consing and the local rules listed in ex.h.
#include "expr/ex.h"

#include <assert.h>
#include <math.h>
#include <string.h>

const struct ct_op_info ct_op_info[CT_OP_COUNT] = {
#define OP(op, narg, name, value) {name, narg},
#include "expr/ops.def"
#undef OP
};

// ---- the store ------------------------------------------------------------------------------

// Limit: length of the list of nodes with one newest operand, which bounds the time to search it.
// Further nodes go to the hash table, of this initial size.
enum { MOST_LISTED = 8, LEAST_TABLE = 256 };

static bool is_node(const struct ct_exnode *m, const struct ct_exnode *n)
{
    return ((m->op ^ n->op) | (m->a ^ n->a) | (m->b ^ n->b) | (m->c ^ n->c)) == 0;
}

static size_t hash_node(const struct ct_exnode *n)
{
    uint64_t h = n->op * 0x9E3779B97F4A7C15u;
    h = (h ^ n->a) * 0xD6E8FEB86659FD93u;
    h = (h ^ (h >> 32) ^ n->b) * 0xD6E8FEB86659FD93u;
    h = (h ^ (h >> 32) ^ n->c) * 0xD6E8FEB86659FD93u;
    return (size_t)(h ^ (h >> 32));
}

// The slot of n in the table, or the free one where it belongs.
static uint32_t *slot_of(const struct ct_exs *x, const struct ct_exnode *n)
{
    size_t i = hash_node(n) & (x->hash_size - 1);
    while (x->hash[i] && !is_node(&x->node[x->hash[i] - 1], n))
        i = (i + 1) & (x->hash_size - 1);
    return &x->hash[i];
}

static void rehash(struct ct_exs *x)
{
    const uint32_t *old = x->hash;
    const size_t nold = x->hash_size;
    x->hash_size = nold ? 2 * nold : LEAST_TABLE;
    x->hash = CT_NEWN(x->arena, uint32_t, x->hash_size);
    for (size_t i = 0; i < nold; i++)
        if (old[i])
            *slot_of(x, &x->node[old[i] - 1]) = old[i];
}

static unsigned kinds_of(const struct ct_exs *x, const struct ct_exnode *n)
{
    if (n->op == CT_OP_SYM)
        return 1u << x->sym[n->a].kind;
    const int narg = ct_op_info[n->op].narg;
    unsigned k = narg > 0 ? x->kinds[n->a] : 0;
    if (narg > 1)
        k |= x->kinds[n->b];
    if (narg > 2)
        k |= x->kinds[n->c];
    return k;
}

// Make room for one more node. The arrays node, kinds and link grow together. While node_cap is 0
// they, and the table, are shared with the store that this one was cloned from.
static void reserve_node(struct ct_exs *x)
{
    struct ct_arena *a = x->arena;
    const size_t n = x->nnode, cap = x->node_cap;
    if (!cap && n) {
        const uint32_t *hash = x->hash;
        x->hash = CT_NEWN(a, uint32_t, x->hash_size);
        memcpy(x->hash, hash, x->hash_size * sizeof *hash);
    }
    x->node = ct_arena_grow(a, x->node, n, &x->node_cap, sizeof *x->node);
    x->kinds = ct_arena_resize(a, x->kinds, n, cap, x->node_cap, sizeof *x->kinds);
    x->link = ct_arena_resize(a, x->link, n, cap, x->node_cap, sizeof *x->link);
}

static ct_ex append(struct ct_exs *x, const struct ct_exnode *n)
{
    if (x->nnode >= x->node_cap)
        reserve_node(x);
    x->node[x->nnode] = *n;
    x->kinds[x->nnode] = (uint16_t)kinds_of(x, n);
    return (ct_ex){(uint32_t)x->nnode++};
}

static ct_ex intern_in_table(struct ct_exs *x, const struct ct_exnode *n)
{
    if (2 * (x->nhash + 1) > x->hash_size)
        rehash(x);
    uint32_t *slot = slot_of(x, n);
    if (*slot)
        return (ct_ex){*slot - 1};
    const uint32_t *hash = x->hash;
    const ct_ex e = append(x, n);
    if (x->hash != hash)
        slot = slot_of(x, n);
    *slot = e.id + 1;
    x->nhash++;
    return e;
}

// Hash consing: the id of an equal node, or of a new one. Most nodes are found through the short
// list of their newest operand, which is local in memory; the hash table holds the rest.
static ct_ex intern(struct ct_exs *x, uint32_t op, uint32_t a, uint32_t b, uint32_t c)
{
    const struct ct_exnode n = {op, a, b, c};
    const uint32_t newest = ct_op_info[op].narg > 1 && b > a ? b : a;
    int nlisted = 0;
    for (uint32_t id = x->link[newest].first; id; id = x->link[id].next, nlisted++)
        if (is_node(&x->node[id], &n))
            return (ct_ex){id};
    if (nlisted == MOST_LISTED)
        return intern_in_table(x, &n);
    const ct_ex e = append(x, &n);
    x->link[e.id].next = x->link[newest].first;
    x->link[newest].first = e.id;
    return e;
}

void ct_exs_init(struct ct_exs *x, struct ct_arena *arena)
{
    *x = (struct ct_exs){.arena = arena};
    ct_ex_const(x, 0);
    ct_ex_const(x, 1);
    assert(x->nnode == 2);
}

struct ct_exs *ct_exs_clone(struct ct_arena *a, const struct ct_exs *from)
{
    struct ct_exs *x = CT_NEW(a, struct ct_exs);
    *x = *from;
    x->arena = a;
    x->node_cap = x->sym_cap = 0; // the first new node, or symbol, copies
    x->label = NULL;
    x->label_cap = x->walk_cap = 0;
    x->generation = 0;
    return x;
}

// ---- leaves and questions -----------------------------------------------------------------------

ct_ex ct_ex_const(struct ct_exs *x, double v)
{
    v += 0.0; // -0 becomes 0
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    const struct ct_exnode n = {CT_OP_CONST, (uint32_t)bits, (uint32_t)(bits >> 32), 0};
    return intern_in_table(x, &n);
}

ct_ex ct_ex_sym(struct ct_exs *x, enum ct_sym_kind kind, const char *name, uint32_t index)
{
    const struct ct_sym s = {.kind = kind, .name = name, .index = index};
    CT_PUSH(x->arena, x->sym, x->nsym, x->sym_cap, s);
    const struct ct_exnode n = {CT_OP_SYM, (uint32_t)x->nsym - 1, 0, 0};
    return append(x, &n); // no equal node exists
}

bool ct_ex_is_const(const struct ct_exs *x, ct_ex a, double *v)
{
    const struct ct_exnode *n = &x->node[a.id];
    if (n->op != CT_OP_CONST)
        return false;
    const uint64_t bits = n->a | (uint64_t)n->b << 32;
    if (v)
        memcpy(v, &bits, sizeof bits);
    return true;
}

const struct ct_sym *ct_ex_symbol(const struct ct_exs *x, ct_ex a)
{
    const struct ct_exnode *n = &x->node[a.id];
    return n->op == CT_OP_SYM ? &x->sym[n->a] : NULL;
}

unsigned ct_ex_kinds(const struct ct_exs *x, ct_ex a)
{
    return x->kinds[a.id];
}

void ct_ex_label(struct ct_exs *x, ct_ex a, const char *name)
{
    if (a.id >= x->label_cap) {
        const size_t cap = 2 * (size_t)a.id + 64;
        const char **label = CT_NEWN(x->arena, const char *, cap);
        if (x->label_cap)
            memcpy(label, x->label, x->label_cap * sizeof *label);
        x->label = label;
        x->label_cap = cap;
    }
    if (!x->label[a.id])
        x->label[a.id] = name;
}

static bool is_neg(const struct ct_exs *x, ct_ex a, ct_ex *positive)
{
    if (x->node[a.id].op != CT_OP_NEG)
        return false;
    *positive = (ct_ex){x->node[a.id].a};
    return true;
}

static bool fold(struct ct_exs *x, enum ct_op op, ct_ex a, ct_ex b, ct_ex *out)
{
    double va, vb = 0;
    if (!ct_ex_is_const(x, a, &va) || (ct_op_info[op].narg == 2 && !ct_ex_is_const(x, b, &vb)))
        return false;
    const double v = ct_op_apply(op, va, vb, 0);
    if (!isfinite(v))
        return false; // not folded: the run reports the operation as the user wrote it
    *out = ct_ex_const(x, v);
    return true;
}

// ---- sums -------------------------------------------------------------------------------------

static ct_ex sum(struct ct_exs *x, ct_ex a, ct_ex b)
{
    return a.id < b.id ? intern(x, CT_OP_ADD, a.id, b.id, 0)
                       : intern(x, CT_OP_ADD, b.id, a.id, 0);
}

ct_ex ct_ex_add(struct ct_exs *x, ct_ex a, ct_ex b)
{
    ct_ex r, p, q;
    if (ct_ex_is_zero(a))
        return b;
    if (ct_ex_is_zero(b))
        return a;
    if (fold(x, CT_OP_ADD, a, b, &r))
        return r;
    if (is_neg(x, b, &q))
        return is_neg(x, a, &p) ? ct_ex_neg(x, sum(x, p, q)) : ct_ex_sub(x, a, q);
    if (is_neg(x, a, &p))
        return ct_ex_sub(x, b, p);
    if (ct_ex_same(a, b))
        return ct_ex_scale(x, 2, a);
    return sum(x, a, b);
}

ct_ex ct_ex_sub(struct ct_exs *x, ct_ex a, ct_ex b)
{
    ct_ex r, p, q;
    if (ct_ex_is_zero(b))
        return a;
    if (ct_ex_is_zero(a))
        return ct_ex_neg(x, b);
    if (ct_ex_same(a, b))
        return CT_EX_ZERO;
    if (fold(x, CT_OP_SUB, a, b, &r))
        return r;
    if (is_neg(x, b, &q))
        return ct_ex_add(x, a, q);
    if (is_neg(x, a, &p))
        return ct_ex_neg(x, ct_ex_add(x, p, b));
    return intern(x, CT_OP_SUB, a.id, b.id, 0);
}

ct_ex ct_ex_neg(struct ct_exs *x, ct_ex a)
{
    ct_ex r;
    if (is_neg(x, a, &r) || fold(x, CT_OP_NEG, a, a, &r))
        return r;
    const struct ct_exnode n = x->node[a.id];
    if (n.op == CT_OP_SUB)
        return intern(x, CT_OP_SUB, n.b, n.a, 0);
    return intern(x, CT_OP_NEG, a.id, 0, 0);
}

// ---- products -----------------------------------------------------------------------------------

ct_ex ct_ex_scale(struct ct_exs *x, double c, ct_ex a)
{
    return ct_ex_mul(x, ct_ex_const(x, c), a);
}

ct_ex ct_ex_add_product(struct ct_exs *x, ct_ex a, ct_ex b, ct_ex c)
{
    return ct_ex_add(x, a, ct_ex_mul(x, b, c));
}

ct_ex ct_ex_sub_product(struct ct_exs *x, ct_ex a, ct_ex b, ct_ex c)
{
    return ct_ex_sub(x, a, ct_ex_mul(x, b, c));
}

// c * b with a constant c: pull out signs, merge constants, put the constant first. k: node of c,
// or 0.
static ct_ex scaled(struct ct_exs *x, double c, ct_ex k, ct_ex b)
{
    if (c < 0)
        return ct_ex_neg(x, scaled(x, -c, CT_EX_ZERO, b));
    if (c == 1)
        return b;
    const struct ct_exnode n = x->node[b.id];
    double d;
    if (n.op == CT_OP_MUL && ct_ex_is_const(x, (ct_ex){n.a}, &d) && isfinite(c * d)
        && c * d != 0)
        return scaled(x, c * d, CT_EX_ZERO, (ct_ex){n.b});
    if (ct_ex_is_zero(k))
        k = ct_ex_const(x, c);
    return intern(x, CT_OP_MUL, k.id, b.id, 0);
}

ct_ex ct_ex_mul(struct ct_exs *x, ct_ex a, ct_ex b)
{
    ct_ex r, p;
    double c;
    if (ct_ex_is_zero(a) || ct_ex_is_zero(b))
        return CT_EX_ZERO;
    if (fold(x, CT_OP_MUL, a, b, &r))
        return r;
    if (is_neg(x, a, &p))
        return ct_ex_neg(x, ct_ex_mul(x, p, b));
    if (is_neg(x, b, &p))
        return ct_ex_neg(x, ct_ex_mul(x, a, p));
    if (ct_ex_is_const(x, a, &c))
        return scaled(x, c, a, b);
    if (ct_ex_is_const(x, b, &c))
        return scaled(x, c, b, a);
    // pull constants out: (c x) y = c (x y)
    struct ct_exnode n = x->node[a.id];
    if (n.op == CT_OP_MUL && ct_ex_is_const(x, (ct_ex){n.a}, &c))
        return scaled(x, c, (ct_ex){n.a}, ct_ex_mul(x, (ct_ex){n.b}, b));
    n = x->node[b.id];
    if (n.op == CT_OP_MUL && ct_ex_is_const(x, (ct_ex){n.a}, &c))
        return scaled(x, c, (ct_ex){n.a}, ct_ex_mul(x, a, (ct_ex){n.b}));
    return a.id < b.id ? intern(x, CT_OP_MUL, a.id, b.id, 0)
                       : intern(x, CT_OP_MUL, b.id, a.id, 0);
}

ct_ex ct_ex_div(struct ct_exs *x, ct_ex a, ct_ex b)
{
    ct_ex r, p;
    double c;
    int exponent;
    if (ct_ex_is_zero(b))
        return intern(x, CT_OP_DIV, a.id, b.id, 0);
    if (ct_ex_is_zero(a))
        return a;
    if (ct_ex_same(a, b))
        return CT_EX_ONE;
    if (fold(x, CT_OP_DIV, a, b, &r))
        return r;
    if (is_neg(x, a, &p))
        return ct_ex_neg(x, ct_ex_div(x, p, b));
    if (is_neg(x, b, &p))
        return ct_ex_neg(x, ct_ex_div(x, a, p));
    if (ct_ex_is_const(x, b, &c)) {
        if (c < 0)
            return ct_ex_neg(x, ct_ex_div(x, a, ct_ex_const(x, -c)));
        if (frexp(c, &exponent) == 0.5 && isnormal(1 / c))
            return scaled(x, 1 / c, CT_EX_ZERO, a); // a power of two: exact
    }
    return intern(x, CT_OP_DIV, a.id, b.id, 0);
}

ct_ex ct_ex_pow(struct ct_exs *x, ct_ex a, ct_ex b)
{
    ct_ex r;
    double c;
    if (fold(x, CT_OP_POW, a, b, &r))
        return r;
    if (ct_ex_is_const(x, b, &c)) {
        if (c == 0)
            return CT_EX_ONE;
        if (c == 1)
            return a;
        if (c == 2)
            return ct_ex_mul(x, a, a);
        if (c == 3)
            return ct_ex_mul(x, a, ct_ex_mul(x, a, a));
        if (c == 4)
            return ct_ex_pow(x, ct_ex_mul(x, a, a), ct_ex_const(x, 2));
        if (c == 0.5)
            return ct_ex_fun(x, CT_OP_SQRT, a);
        if (c == -1 || c == -2 || c == -3 || c == -4)
            return ct_ex_div(x, CT_EX_ONE, ct_ex_pow(x, a, ct_ex_const(x, -c)));
    }
    return intern(x, CT_OP_POW, a.id, b.id, 0);
}

// ---- functions ----------------------------------------------------------------------------------

ct_ex ct_ex_fun(struct ct_exs *x, enum ct_op op, ct_ex a)
{
    ct_ex r, p;
    assert(ct_op_info[op].narg == 1 && op != CT_OP_TABLE);
    if (op == CT_OP_NEG)
        return ct_ex_neg(x, a);
    if (fold(x, op, a, a, &r))
        return r;
    const bool negative = is_neg(x, a, &p);
    switch (op) {
    case CT_OP_SIN:
    case CT_OP_TAN:
    case CT_OP_ASIN:
    case CT_OP_ATAN:
    case CT_OP_SINH:
    case CT_OP_TANH:
    case CT_OP_SIGN:
        if (negative)
            return ct_ex_neg(x, ct_ex_fun(x, op, p));
        break;
    case CT_OP_COS:
    case CT_OP_COSH:
    case CT_OP_ABS:
        if (negative)
            a = p;
        break;
    default:
        break;
    }
    // sin(b - a) and sin(a - b) share one node: the difference with the smaller id first
    const struct ct_exnode n = x->node[a.id];
    if (n.op == CT_OP_SUB && n.a > n.b && (op == CT_OP_SIN || op == CT_OP_COS)) {
        const ct_ex turned = intern(x, CT_OP_SUB, n.b, n.a, 0);
        r = intern(x, op, turned.id, 0, 0);
        return op == CT_OP_SIN ? ct_ex_neg(x, r) : r;
    }
    return intern(x, op, a.id, 0, 0);
}

ct_ex ct_ex_fun2(struct ct_exs *x, enum ct_op op, ct_ex a, ct_ex b)
{
    ct_ex r;
    switch (op) {
    case CT_OP_ADD:
        return ct_ex_add(x, a, b);
    case CT_OP_SUB:
        return ct_ex_sub(x, a, b);
    case CT_OP_MUL:
        return ct_ex_mul(x, a, b);
    case CT_OP_DIV:
        return ct_ex_div(x, a, b);
    case CT_OP_POW:
        return ct_ex_pow(x, a, b);
    default:
        assert(ct_op_info[op].narg == 2);
        return fold(x, op, a, b, &r) ? r : intern(x, op, a.id, b.id, 0);
    }
}

ct_ex ct_ex_if(struct ct_exs *x, ct_ex c, ct_ex a, ct_ex b)
{
    double v;
    if (ct_ex_same(a, b))
        return a;
    if (ct_ex_is_const(x, c, &v))
        return v != 0 ? a : b;
    return intern(x, CT_OP_IF, c.id, a.id, b.id);
}

ct_ex ct_ex_table(struct ct_exs *x, uint32_t table, uint32_t order, ct_ex a)
{
    return intern(x, CT_OP_TABLE, a.id, table, order);
}
