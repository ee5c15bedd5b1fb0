// Collecting the reduced equations; see reduced.h.
#include "report/reduced.h"

#include "expr/collect.h"
#include "report/page.h"
#include "base/sort.h"
#include "expr/share.h"

#include <stdint.h>

// Above this number of nodes an expanded expression is not collected: it is too long to read,
// and collecting takes seconds.
// Limit: of the time to collect; beyond it expressions stay as they are.
static const double largest_collected = 20000;

double ct_reduced_size(const struct ct_exs *x, ct_ex e, double most)
{
    const struct ct_exnode *n = ct_ex_node(x, e);
    const uint32_t arg[3] = {n->a, n->b, n->c};
    double size = 1;
    for (int i = 0; i < ct_op_info[n->op].narg && size < most; i++)
        size += ct_reduced_size(x, (ct_ex){arg[i]}, most - size);
    return size;
}

struct quaternions {
    ct_ex (*at)[4];
    size_t n;
};

static struct quaternions quaternions_of(struct ct_arena *a, const struct ct_equations *e)
{
    struct quaternions s = {ct_arena_calloc(a, e->nq + 1, sizeof *s.at), 0};
    for (size_t i = 0; i + 3 < e->nq; i++) {
        if (e->q[i].quaternion != 0)
            continue;
        for (size_t k = 0; k < 4; k++)
            s.at[s.n][k] = e->q[i + k].symbol;
        s.n++;
    }
    return s;
}

static ct_ex collect(struct ct_equations *e, ct_ex v)
{
    if (ct_ex_is_zero(v) || ct_ex_is_const(e->x, v, NULL) || ct_ex_symbol(e->x, v))
        return v;
    struct ct_arena *work = ct_arena_create_under(e->x->arena);
    const struct quaternions s = quaternions_of(work, e);
    const struct ct_collect_options o
        = {.scratch = work, .quaternion = s.at, .nquaternion = s.n};
    v = ct_ex_collect(e->x, v, &o);
    ct_arena_destroy(work);
    return v;
}

static double size(const struct ct_equations *e, ct_ex v)
{
    return ct_reduced_size(e->x, v, 2 * largest_collected);
}

// k (a + b) as k a + k b.
static ct_ex distribute(struct ct_equations *e, ct_ex k, ct_ex sum)
{
    struct ct_exs *x = e->x;
    const struct ct_exnode n = *ct_ex_node(x, sum);
    if (n.op == CT_OP_NEG)
        return ct_ex_neg(x, distribute(e, k, (ct_ex){n.a}));
    if (n.op != CT_OP_ADD && n.op != CT_OP_SUB)
        return ct_ex_mul(x, k, sum);
    const ct_ex a = distribute(e, k, (ct_ex){n.a}), b = distribute(e, k, (ct_ex){n.b});
    return n.op == CT_OP_ADD ? ct_ex_add(x, a, b) : ct_ex_sub(x, a, b);
}

// Terms of an equation stay separate if that is not much longer: -g*m1*l1*s1 - g*m2*l2*s2
// rather than -g*(m1*l1*s1 + m2*l2*s2).
static ct_ex keep_apart(struct ct_equations *e, ct_ex v)
{
    struct ct_exs *x = e->x;
    const struct ct_exnode n = *ct_ex_node(x, v);
    if (n.op == CT_OP_NEG)
        return ct_ex_neg(x, keep_apart(e, (ct_ex){n.a}));
    if (n.op != CT_OP_MUL)
        return v;
    for (int i = 0; i < 2; i++) {
        const ct_ex k = {i ? n.a : n.b}, sum = {i ? n.b : n.a};
        const enum ct_op op = ct_ex_node(x, sum)->op;
        const unsigned kinds = ct_ex_kinds(x, sum);
        if ((op != CT_OP_ADD && op != CT_OP_SUB) || !(kinds & ~(1u << CT_SYM_PARAM)))
            continue;
        const ct_ex apart = distribute(e, k, sum);
        if (size(e, apart) <= 1.3 * size(e, v))
            return apart;
    }
    return v;
}

// Collects terms at rest and terms of the speeds separately: gravity stays apart from
// centrifugal terms, even with a common factor.
ct_ex ct_reduced_collect_force(struct ct_equations *e, struct ct_arena *a, ct_ex v)
{
    struct ct_exs *x = e->x;
    const ct_ex whole = keep_apart(e, collect(e, v));
    if (!(ct_ex_kinds(x, v) & 1u << CT_SYM_U))
        return whole;
    ct_ex *from = CT_NEWN(a, ct_ex, e->nu), *zero = CT_NEWN(a, ct_ex, e->nu);
    for (size_t i = 0; i < e->nu; i++)
        from[i] = e->u[i].symbol;
    const ct_ex rest = collect(e, ct_ex_subst(x, v, from, zero, e->nu));
    const ct_ex still = keep_apart(e, rest);
    const ct_ex moving = keep_apart(e, collect(e, ct_ex_sub(x, v, rest)));
    const ct_ex apart = ct_ex_add(x, moving, still);
    return size(e, apart) <= 1.5 * size(e, whole) + 8 ? apart : whole;
}

// Size of all expressions printed in full, up to the largest that is collected.
static double size_of_all(const struct ct_equations *e, const ct_ex *effort)
{
    const double most = largest_collected + 1;
    double size = 0;
    for (size_t i = 0; i < e->ndriver; i++)
        size += ct_reduced_size(e->x, effort[i], most - size);
    for (size_t i = 0; i < e->nM; i++)
        size += ct_reduced_size(e->x, e->M[i].value, most - size);
    for (size_t i = 0; i < e->nJ; i++)
        size += ct_reduced_size(e->x, e->J[i].value, most - size);
    for (size_t i = 0; i < e->nu; i++)
        size += ct_reduced_size(e->x, e->Q[i], most - size);
    for (size_t i = 0; i < e->nrow; i++) {
        size += ct_reduced_size(e->x, e->row[i].phi, most - size);
        size += ct_reduced_size(e->x, e->row[i].gam, most - size);
    }
    return size;
}

// Efforts of driven branch coordinates: their rows of the cutsets, minus the joint's own effort
// and those of gears.
static void find_efforts(struct ct_equations *e, ct_ex *effort)
{
    struct ct_build *b = e->build;
    for (size_t i = 0; i < e->ncoordinate; i++) {
        const struct ct_coordinate *c = &e->coordinate[i];
        if (c->driver >= 0)
            effort[c->driver] = ct_driver_effort(b, (int)i);
    }
}

static struct ct_reduced allocate(struct ct_arena *a, const struct ct_equations *e)
{
    return (struct ct_reduced){
        .M = CT_NEWN(a, ct_ex, e->nM + 1),
        .J = CT_NEWN(a, ct_ex, e->nJ + 1),
        .Q = CT_NEWN(a, ct_ex, e->nu + 1),
        .phi = CT_NEWN(a, ct_ex, e->nrow + 1),
        .gam = CT_NEWN(a, ct_ex, e->nrow + 1),
        .effort = CT_NEWN(a, ct_ex, e->ndriver + 1),
        .rate = CT_NEWN(a, ct_ex, e->nq + 1),
    };
}

void ct_reduced_prepare(struct ct_arena *a, struct ct_equations *e, bool may_collect,
                        struct ct_reduced *r)
{
    *r = allocate(a, e);
    find_efforts(e, r->effort);
    r->is_collected = may_collect && size_of_all(e, r->effort) <= largest_collected;
    for (size_t i = 0; i < e->nM; i++)
        r->M[i] = r->is_collected ? collect(e, e->M[i].value) : e->M[i].value;
    for (size_t i = 0; i < e->nJ; i++)
        r->J[i] = r->is_collected ? collect(e, e->J[i].value) : e->J[i].value;
    for (size_t i = 0; i < e->nu; i++)
        r->Q[i] = r->is_collected ? ct_reduced_collect_force(e, a, e->Q[i]) : e->Q[i];
    for (size_t i = 0; i < e->nrow; i++) {
        r->phi[i] = r->is_collected ? collect(e, e->row[i].phi) : e->row[i].phi;
        r->gam[i] = r->is_collected ? collect(e, e->row[i].gam) : e->row[i].gam;
    }
    for (size_t i = 0; i < e->ndriver && r->is_collected; i++)
        r->effort[i] = ct_reduced_collect_force(e, a, r->effort[i]);
    for (size_t i = 0; i < e->nq; i++)
        r->rate[i] = collect(e, e->q[i].rate);
}

void ct_reduced_recur(struct ct_arena *a, struct ct_equations *e, struct ct_reduced *r)
{
    struct ct_build *b = e->build;
    *r = allocate(a, e);
    r->is_recursive = true;
    r->cutset = CT_NEWN(a, ct_ex, e->nu + 1);
    for (size_t i = 0; i < e->nu; i++) {
        r->cutset[i] = ct_sweep_row(b, (int)i);
        r->Q[i] = b->loads->effort[i];
    }
    for (size_t i = 0; i < e->nJ; i++)
        r->J[i] = e->J[i].value;
    for (size_t i = 0; i < e->nrow; i++) {
        r->phi[i] = e->row[i].phi;
        r->gam[i] = e->row[i].gam;
    }
    for (size_t i = 0; i < e->nq; i++)
        r->rate[i] = collect(e, e->q[i].rate);
    find_efforts(e, r->effort);
    ct_reduced_label(e, CT_FULL);
    ct_reduced_share(a, e, r);
}

// ---- sharing -------------------------------------------------------------------------------

// Lists all expressions; where NULL: returns only their number.
static size_t list_all(const struct ct_equations *e, const struct ct_reduced *r, ct_ex **where)
{
    const bool is_recursive = r->is_recursive;
    const struct {
        ct_ex *at;
        size_t n;
    } part[] = {{r->cutset, is_recursive ? e->nu : 0},
                {r->M, is_recursive ? 0 : e->nM},
                {r->Q, e->nu},
                {r->J, e->nJ},
                {r->phi, e->nrow},
                {r->gam, e->nrow},
                {r->effort, e->ndriver}};
    size_t n = 0;
    for (size_t k = 0; k < COUNT(part); k++)
        for (size_t i = 0; i < part[k].n; i++, n++)
            if (where)
                // cppcheck-suppress autoVariables ; the address is inside the array that at points
                // to
                where[n] = &part[k].at[i];
    return n;
}

// Definitions are short now: collects like terms that appear with the new names.
static ct_ex tidy(struct ct_equations *e, ct_ex v)
{
    return ct_reduced_size(e->x, v, 1000) < 1000 ? collect(e, v) : v;
}

static int by_id(const void *unused, const void *a, const void *b)
{
    const uint32_t m = *(const uint32_t *)a, n = *(const uint32_t *)b;
    (void)unused;
    return (m > n) - (m < n);
}

// Each named node becomes a symbol, in one loop over ascending ids.
static void replace_named(struct ct_arena *a, struct ct_arena *work, struct ct_equations *e,
                          struct ct_definitions *list, struct ct_share *share,
                          const ct_ex *root, size_t nroot, ct_ex *map)
{
    struct ct_exs *x = e->x;
    const size_t n = ct_ex_walk(x, root, nroot);
    uint32_t *id = CT_NEWN(work, uint32_t, n + 1);
    for (size_t k = 0; k < n; k++)
        id[k] = x->stack[k];
    ct_sort(work, id, n, sizeof *id, by_id, NULL);
    *list = (struct ct_definitions){CT_NEWN(a, struct ct_reduced_definition, share->n + 1), 0};
    for (size_t k = 0; k < n; k++) {
        const ct_ex old = {id[k]};
        const char *name = ct_share_name(share, old);
        const struct ct_exnode node = *ct_ex_node(x, old);
        map[old.id] = ct_op_info[node.op].narg ? ct_ex_rebuild(x, node, map) : old;
        if (!name)
            continue;
        const uint32_t number = (uint32_t)list->n;
        const bool is_negative = name[0] == '-';
        struct ct_reduced_definition *d = &list->at[list->n++];
        d->full = is_negative ? ct_ex_neg(x, old) : old;
        d->value = is_negative ? ct_ex_neg(x, map[old.id]) : map[old.id];
        d->value = tidy(e, d->value);
        d->symbol = ct_ex_sym(x, CT_SYM_LOCAL, name + is_negative, number);
        map[old.id] = is_negative ? ct_ex_neg(x, d->symbol) : d->symbol;
    }
}

// Order of definitions: those that a definition uses come before it.
struct ct_definitions ct_definitions_find(struct ct_arena *a, struct ct_equations *e,
                                          ct_ex *const *where, size_t n, bool names_first,
                                          double *size)
{
    const struct ct_share_options o = {
        .most = names_first ? SIZE_MAX : 20000,
        .enough = 2000,
        .least = names_first ? CT_PAGE_WIDTH : 0, // a definition takes a line and must save one
        .names_first = names_first};
    struct ct_arena *work = ct_arena_create_under(a); // for tables of the size of the store
    ct_ex *root = CT_NEWN(work, ct_ex, n + 1);
    struct ct_definitions list;
    for (size_t i = 0; i < n; i++)
        root[i] = *where[i];
    struct ct_share share = ct_ex_share(a, e->x, root, n, &o);
    ct_ex *map = CT_NEWN(work, ct_ex, e->x->nnode);
    replace_named(a, work, e, &list, &share, root, n, map);
    for (size_t i = 0; i < n; i++)
        *where[i] = tidy(e, map[root[i].id]);
    *size = share.size;
    ct_arena_destroy(work);
    return list;
}

void ct_reduced_share(struct ct_arena *a, struct ct_equations *e, struct ct_reduced *r)
{
    const size_t n = list_all(e, r, NULL);
    ct_ex **where = CT_NEWN(a, ct_ex *, n + 1);
    list_all(e, r, where);
    r->definitions = ct_definitions_find(a, e, where, n, r->is_recursive, &r->size);
}

bool ct_reduced_collect(struct ct_arena *a, struct ct_equations *e, ct_ex *const *where,
                        size_t n)
{
    double size = 0;
    for (size_t i = 0; i < n; i++)
        size += ct_reduced_size(e->x, *where[i], largest_collected - size + 1);
    for (size_t i = 0; i < e->nq; i++)
        if (e->q[i].quaternion >= 0)
            return false;
    for (size_t i = 0; i < n && size <= largest_collected; i++)
        *where[i] = ct_reduced_collect_force(e, a, *where[i]);
    return size <= largest_collected;
}

void ct_reduced_collect_all(struct ct_arena *a, struct ct_equations *e, struct ct_reduced *r)
{
    const size_t n = list_all(e, r, NULL);
    ct_ex **where = CT_NEWN(a, ct_ex *, n + 1);
    list_all(e, r, where);
    r->is_collected = ct_reduced_collect(a, e, where, n);
}

// ---- equations -----------------------------------------------------------------------------

// M is symmetric and holds its lower triangle.
ct_ex ct_reduced_left(struct ct_equations *e, const struct ct_reduced *r, size_t i)
{
    ct_ex sum = CT_EX_ZERO;
    if (r->is_recursive)
        return r->cutset[i];
    for (size_t k = 0; k < e->nM; k++) {
        const int row = e->M[k].row, column = e->M[k].column;
        if (row != (int)i && column != (int)i)
            continue;
        const ct_ex acceleration = e->u[row == (int)i ? column : row].derivative;
        sum = ct_ex_add(e->x, sum, ct_ex_mul(e->x, r->M[k], acceleration));
    }
    return sum;
}

ct_ex ct_reduced_right(struct ct_equations *e, const struct ct_reduced *r, size_t i)
{
    ct_ex sum = r->Q[i];
    if (r->is_recursive)
        return sum;
    for (size_t k = 0; k < e->nJ; k++)
        if (e->J[k].column == (int)i)
            sum = ct_ex_add(e->x, sum, ct_ex_mul(e->x, r->J[k], e->row[e->J[k].row].lam));
    return sum;
}

ct_ex ct_reduced_row_left(struct ct_equations *e, const struct ct_reduced *r, size_t row)
{
    ct_ex sum = CT_EX_ZERO;
    for (size_t k = 0; k < e->nJ; k++)
        if (e->J[k].row == (int)row)
            sum = ct_ex_add(e->x, sum,
                            ct_ex_mul(e->x, r->J[k], e->u[e->J[k].column].derivative));
    return sum;
}
