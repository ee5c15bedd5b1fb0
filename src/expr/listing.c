// Expressions -> list of instructions; see listing.h.
//
// Passes, each linear in the live nodes: number the live nodes (values), turn them into
// instructions (sin and cos of one argument become one), fuse products with sums if asked to, put
// the prologue first.
#include "expr/listing.h"
#include "expr/sincos.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static const uint32_t none = CT_VALUE_NONE;

// ---- counts of operations ----------------------------------------------------------------------

// Comparison and selection (if, min, abs ...) are not counted: they cost no more than a negation.
static void count_op(struct ct_tape_counts *n, uint32_t op)
{
    switch (op) {
    case CT_OP_MUL:
        n->multiplications++;
        break;
    case CT_OP_ADD:
    case CT_OP_SUB:
        n->additions++;
        break;
    case CT_OP_DIV:
        n->divisions++;
        break;
    case CT_OP_FMA:
    case CT_OP_FMS:
    case CT_OP_FNMA:
        n->multiplications++;
        n->additions++;
        break;
    case CT_OP_SINCOS:
    case CT_OP_ANGLE_SINCOS:
        n->functions += 2;
        break;
    case CT_OP_CONST:
    case CT_OP_SYM:
    case CT_OP_NEG:
    case CT_OP_ABS:
    case CT_OP_SIGN:
    case CT_OP_MIN:
    case CT_OP_MAX:
    case CT_OP_LT:
    case CT_OP_LE:
    case CT_OP_GT:
    case CT_OP_GE:
    case CT_OP_EQ:
    case CT_OP_IF:
        break;
    default:
        n->functions++;
    }
}

// ---- live nodes -------------------------------------------------------------------------------

static int arguments(const struct ct_exnode *n, uint32_t arg[3])
{
    const int narg = ct_op_info[n->op].narg;
    arg[0] = n->a;
    arg[1] = n->b;
    arg[2] = n->c;
    return narg;
}

// live[id] = 1 for the nodes below e[0 ... n); returns the number of ids looked at.
static uint32_t mark_live(unsigned char **live, struct ct_arena *a, const struct ct_exs *x,
                          const ct_ex *e, size_t n)
{
    uint32_t end = 0;
    for (size_t k = 0; k < n; k++)
        end = e[k].id >= end ? e[k].id + 1 : end;
    *live = CT_NEWN(a, unsigned char, end);
    for (size_t k = 0; k < n; k++)
        (*live)[e[k].id] = 1;
    // children have smaller ids, so one sweep downwards reaches everything
    for (uint32_t id = end; id-- > 0;) {
        if (!(*live)[id])
            continue;
        const struct ct_exnode *node = &x->node[id];
        const int narg = ct_op_info[node->op].narg;
        if (narg > 0)
            (*live)[node->a] = 1;
        if (narg > 1)
            (*live)[node->b] = 1;
        if (narg > 2)
            (*live)[node->c] = 1;
    }
    return end;
}

static enum ct_rate node_rate(const struct ct_exs *x, const struct ct_exnode *n,
                              const unsigned char *rate)
{
    if (n->op == CT_OP_CONST)
        return CT_RATE_NEVER;
    if (n->op == CT_OP_SYM)
        return x->sym[n->a].kind == CT_SYM_PARAM ? CT_RATE_PARAM : CT_RATE_CALL;
    const int narg = ct_op_info[n->op].narg;
    unsigned r = rate[n->a] > CT_RATE_PARAM ? rate[n->a] : CT_RATE_PARAM;
    if (narg > 1 && rate[n->b] > r)
        r = rate[n->b];
    if (narg > 2 && rate[n->c] > r)
        r = rate[n->c];
    return (enum ct_rate)r;
}

struct ct_tape_counts ct_ex_count(struct ct_arena *scratch, const struct ct_exs *x,
                                  const ct_ex *e, size_t n)
{
    struct ct_tape_counts counts = {0};
    unsigned char *live, *rate;
    const uint32_t end = mark_live(&live, scratch, x, e, n);
    rate = CT_NEWN(scratch, unsigned char, end);
    for (uint32_t id = 0; id < end; id++) {
        if (!live[id])
            continue;
        rate[id] = (unsigned char)node_rate(x, &x->node[id], rate);
        if (rate[id] == CT_RATE_CALL)
            count_op(&counts, x->node[id].op);
    }
    return counts;
}

// ---- values -----------------------------------------------------------------------------------

struct lister {
    struct ct_arena *arena, *scratch;
    const struct ct_exs *x;
    struct ct_listing *l;
    uint32_t nid;
    uint32_t *value; // by id
};

static void number_values(struct lister *s, const ct_ex *out, size_t nout)
{
    struct ct_listing *l = s->l;
    unsigned char *live;
    s->nid = mark_live(&live, s->scratch, s->x, out, nout);
    s->value = CT_NEWN(s->scratch, uint32_t, s->nid);
    for (uint32_t id = 0; id < s->nid; id++)
        s->value[id] = live[id] ? (uint32_t)l->nvalue++ : none;
    l->node = CT_NEWN(s->arena, uint32_t, l->nvalue);
    l->rate = CT_NEWN(s->arena, unsigned char, l->nvalue);
    l->is_leaf = CT_NEWN(s->arena, unsigned char, l->nvalue);
    l->input = CT_NEWN(s->arena, uint32_t, l->nvalue);
    // `live` is no longer needed and is reused for the rates by id
    for (uint32_t id = 0; id < s->nid; id++) {
        const uint32_t v = s->value[id], op = s->x->node[id].op;
        if (v == none)
            continue;
        live[id] = (unsigned char)node_rate(s->x, &s->x->node[id], live);
        l->node[v] = id;
        l->rate[v] = live[id];
        l->is_leaf[v] = op == CT_OP_CONST || op == CT_OP_SYM;
        l->input[v] = none;
    }
}

static void place_inputs(struct lister *s, const ct_ex *in, const size_t *slot, size_t nin)
{
    for (size_t k = 0; k < nin; k++) {
        assert(ct_ex_symbol(s->x, in[k]));
        const uint32_t v = in[k].id < s->nid ? s->value[in[k].id] : none;
        if (v == none)
            continue;
        assert(s->l->input[v] == none && "a symbol is listed twice");
        s->l->input[v] = (uint32_t)slot[k];
    }
    for (size_t v = 0; v < s->l->nvalue; v++)
        assert((s->x->node[s->l->node[v]].op != CT_OP_SYM || s->l->input[v] != none)
               && "a symbol that is needed is not an input");
}

// ---- instructions -----------------------------------------------------------------------------

static void make_instruction(struct lister *s, uint32_t v, const struct ct_exnode *n)
{
    struct ct_instruction *i = &s->l->ins[s->l->nins++];
    i->op = n->op;
    i->narg = (uint32_t)arguments(n, i->arg);
    for (uint32_t k = 0; k < 3; k++)
        i->arg[k] = k < i->narg ? s->value[i->arg[k]] : none;
    i->nres = 1;
    i->res[0] = v;
    i->res[1] = none;
    if (n->op == CT_OP_TABLE) {
        i->table = n->b;
        i->order = n->c;
    }
}

// Result 0 is the sine, result 1 the cosine, whichever came first.
static void make_sincos(struct ct_instruction *i, uint32_t v)
{
    const uint32_t first = i->res[0];
    i->res[0] = i->op == CT_OP_SIN ? first : v;
    i->res[1] = i->op == CT_OP_SIN ? v : first;
    i->nres = 2;
    i->op = CT_OP_SINCOS;
}

static void make_instructions(struct lister *s)
{
    struct ct_listing *l = s->l;
    uint32_t *turned
        = CT_NEWN(s->scratch, uint32_t, l->nvalue); // 1 + first sin or cos of a value
    l->ins = CT_NEWN(s->arena, struct ct_instruction, l->nvalue);
    for (uint32_t v = 0; v < l->nvalue; v++) {
        const struct ct_exnode *n = &s->x->node[l->node[v]];
        if (l->is_leaf[v])
            continue;
        const bool trig = n->op == CT_OP_SIN || n->op == CT_OP_COS;
        uint32_t *first = trig ? &turned[s->value[n->a]] : NULL;
        if (first && *first) {
            make_sincos(&l->ins[*first - 1], v);
            continue;
        }
        make_instruction(s, v, n);
        if (first)
            *first = (uint32_t)l->nins;
    }
}

// ---- fused multiply-add -----------------------------------------------------------------------

// Replace i = x + p, x - p or p - x, with the product p, by one fused instruction. which: operand
// of i that is p.
static void fuse(struct ct_instruction *i, struct ct_instruction *product, uint32_t which)
{
    const uint32_t other = i->arg[1 - which];
    i->op = i->op == CT_OP_ADD ? CT_OP_FMA : which == 0 ? CT_OP_FMS : CT_OP_FNMA;
    i->narg = 3;
    i->arg[0] = product->arg[0];
    i->arg[1] = product->arg[1];
    i->arg[2] = other;
    product->nres = 0; // to be removed
}

// A product goes into the sum that is its only reader. Both belong to the same part.
static void fuse_products(struct lister *s)
{
    struct ct_listing *l = s->l;
    uint32_t *nuse = CT_NEWN(s->scratch, uint32_t, l->nvalue);
    uint32_t *made = CT_NEWN(s->scratch, uint32_t, l->nvalue); // 1 + instruction
    for (size_t i = l->nprologue; i < l->nins; i++) {
        for (uint32_t k = 0; k < l->ins[i].narg; k++)
            nuse[l->ins[i].arg[k]]++;
        for (uint32_t k = 0; k < l->ins[i].nres; k++)
            made[l->ins[i].res[k]] = (uint32_t)i + 1;
    }
    for (size_t k = 0; k < l->nout; k++)
        nuse[l->out[k]] += 2;
    for (size_t i = l->nprologue; i < l->nins; i++) {
        if (l->ins[i].op != CT_OP_ADD && l->ins[i].op != CT_OP_SUB)
            continue;
        for (uint32_t k = 0; k < 2; k++) {
            const uint32_t v = l->ins[i].arg[k];
            struct ct_instruction *p = made[v] ? &l->ins[made[v] - 1] : NULL;
            if (p && p->op == CT_OP_MUL && nuse[v] == 1
                && l->rate[v] == l->rate[l->ins[i].res[0]]) {
                fuse(&l->ins[i], p, k);
                break;
            }
        }
    }
    size_t n = 0;
    for (size_t i = 0; i < l->nins; i++)
        if (l->ins[i].nres)
            l->ins[n++] = l->ins[i];
    l->nins = n;
}

// ---- entries ----------------------------------------------------------------------------------

static void put_prologue_first(struct lister *s)
{
    struct ct_listing *l = s->l;
    size_t n = 0, nbody = 0;
    for (size_t i = 0; i < l->nins; i++)
        n += l->rate[l->ins[i].res[0]] != CT_RATE_CALL;
    if (n == 0)
        return;
    struct ct_instruction *body = CT_NEWN(s->scratch, struct ct_instruction, l->nins - n + 1);
    l->nprologue = n;
    n = 0;
    for (size_t i = 0; i < l->nins; i++)
        if (l->rate[l->ins[i].res[0]] != CT_RATE_CALL)
            l->ins[n++] = l->ins[i];
        else
            body[nbody++] = l->ins[i];
    memcpy(l->ins + n, body, nbody * sizeof *body);
}

// Number of angles from which the SIMD kernel is used. Derived: measured time relative to single
// calls: 1 for two angles, 0.6 for three, 0.4 for four (tests/bench/kernels).
static const size_t several_angles = 3;

// Sines whose argument depends on another sine of the body are found here. They remain single
// calls, because back ends read all angles of a SIMD call before they write its results.
static bool *find_separate_angles(struct ct_arena *scratch, const struct ct_listing *l,
                                  size_t *n)
{
    bool *is_wave = CT_NEWN(scratch, bool, l->nvalue + 1); // by value: a sine or a cosine
    bool *is_separate = CT_NEWN(scratch, bool, l->nins + 1);
    for (size_t i = l->nprologue; i < l->nins; i++) {
        const struct ct_instruction *ins = &l->ins[i];
        if (ins->op != CT_OP_SIN && ins->op != CT_OP_COS && ins->op != CT_OP_SINCOS
            && (ins->op < CT_OP_ANGLE_SIN || ins->op > CT_OP_ANGLE_SINCOS))
            continue;
        is_separate[i] = !is_wave[ins->arg[0]];
        *n += is_separate[i];
        for (uint32_t k = 0; k < ins->nres; k++)
            is_wave[ins->res[k]] = true;
    }
    return is_separate;
}

static void name_angles(struct ct_arena *scratch, struct ct_listing *l, size_t several)
{
    size_t n = 0;
    const bool *is_separate = find_separate_angles(scratch, l, &n);
    for (size_t i = l->nprologue; i < l->nins && n >= several; i++) {
        unsigned char *op = &l->ins[i].op;
        if (is_separate[i])
            *op = *op == CT_OP_SIN    ? CT_OP_ANGLE_SIN
                : *op == CT_OP_COS    ? CT_OP_ANGLE_COS
                : *op == CT_OP_SINCOS ? CT_OP_ANGLE_SINCOS
                                      : *op;
    }
}

const struct ct_listing *ct_listing_for_lanes(struct ct_arena *a, const struct ct_listing *l)
{
    struct ct_listing *copy = CT_NEW(a, struct ct_listing);
    *copy = *l;
    copy->ins = CT_NEWN(a, struct ct_instruction, l->nins + 1);
    memcpy(copy->ins, l->ins, l->nins * sizeof *l->ins);
    struct ct_arena *scratch = ct_arena_create_under(a);
    name_angles(scratch, copy, 1);
    ct_arena_destroy(scratch);
    return copy;
}

bool ct_listing_has_angles(const struct ct_listing *l)
{
    for (size_t i = l->nprologue; i < l->nins; i++)
        if (l->ins[i].op >= CT_OP_ANGLE_SIN && l->ins[i].op <= CT_OP_ANGLE_SINCOS)
            return true;
    return false;
}

const struct ct_listing *ct_listing_create(struct ct_arena *a, const struct ct_exs *x,
                                           const ct_ex *out, size_t nout, const ct_ex *in,
                                           const size_t *slot, size_t nin, enum ct_fuse fuse)
{
    struct ct_listing *l = CT_NEW(a, struct ct_listing);
    struct ct_arena *scratch = ct_arena_create_under(a);
    struct lister s = {.arena = a, .scratch = scratch, .x = x, .l = l};
    l->x = x;
    l->fuse = fuse;
    number_values(&s, out, nout);
    place_inputs(&s, in, slot, nin);
    l->nout = nout;
    l->out = CT_NEWN(a, uint32_t, nout);
    for (size_t k = 0; k < nout; k++)
        l->out[k] = s.value[out[k].id];
    make_instructions(&s);
    if (fuse == CT_FUSE_YES)
        fuse_products(&s);
    put_prologue_first(&s);
    name_angles(scratch, l, several_angles);
    ct_arena_destroy(scratch);
    for (size_t i = l->nprologue; i < l->nins; i++)
        count_op(&l->counts, l->ins[i].op);
    // the points of a table never move in memory; the list of tables may, so it is copied
    struct ct_table *table = CT_NEWN(a, struct ct_table, x->ntable);
    if (x->ntable)
        memcpy(table, x->table, x->ntable * sizeof *table);
    l->table = table;
    return l;
}

const struct ct_listing *ct_listing_fuse(struct ct_arena *a, const struct ct_listing *l)
{
    struct ct_listing *fused = CT_NEW(a, struct ct_listing);
    *fused = *l;
    fused->fuse = CT_FUSE_YES;
    fused->ins = CT_NEWN(a, struct ct_instruction, l->nins);
    if (l->nins)
        memcpy(fused->ins, l->ins, l->nins * sizeof *l->ins);
    struct ct_arena *scratch = ct_arena_create_under(a);
    fuse_products(&(struct lister){.scratch = scratch, .l = fused});
    ct_arena_destroy(scratch);
    return fused;
}

struct ct_uses ct_listing_uses(struct ct_arena *a, const struct ct_listing *l)
{
    size_t nuse = 0;
    struct ct_uses u = {.start = CT_NEWN(a, uint32_t, l->nvalue + 2)};
    for (size_t i = 0; i < l->nins; i++)
        for (uint32_t k = 0; k < l->ins[i].narg; k++, nuse++)
            u.start[l->ins[i].arg[k] + 2]++;
    for (size_t v = 1; v <= l->nvalue; v++)
        u.start[v + 1] += u.start[v];
    u.use = CT_NEWN(a, uint32_t, nuse);
    for (size_t i = 0; i < l->nins; i++)
        for (uint32_t k = 0; k < l->ins[i].narg; k++)
            u.use[u.start[l->ins[i].arg[k] + 1]++] = (uint32_t)i;
    return u;
}

void ct_instruction_apply(const struct ct_listing *l, const struct ct_instruction *i,
                          const double arg[3], double res[2])
{
    switch (i->op) {
    case CT_OP_SINCOS:
        res[0] = sin(arg[0]);
        res[1] = cos(arg[0]);
        break;
    case CT_OP_ANGLE_SINCOS:
    case CT_OP_ANGLE_SIN:
        ct_sincos(arg[0], &res[0], &res[1]);
        break;
    case CT_OP_ANGLE_COS:
        ct_sincos(arg[0], &res[1], &res[0]);
        break;
    case CT_OP_FMA:
        res[0] = fma(arg[0], arg[1], arg[2]);
        break;
    case CT_OP_FMS:
        res[0] = fma(arg[0], arg[1], -arg[2]);
        break;
    case CT_OP_FNMA:
        res[0] = fma(-arg[0], arg[1], arg[2]);
        break;
    case CT_OP_TABLE:
        res[0] = ct_table_value(&l->table[i->table], i->order, arg[0]);
        break;
    default:
        res[0] = ct_op_apply((enum ct_op)i->op, arg[0], arg[1], arg[2]);
    }
}
