// Expressions -> straight-line program of runs; see tape.h.
//
// The work array, in the order of allocation:
//
//     [ constants | parameters | results the prologue keeps | body: inputs and temporaries ]
//
// Compiling is five passes, each linear in the live nodes: number the live nodes (values), turn them
// into instructions (sin and cos of one argument become one), put those into an order, give every
// value a slot of the work array, write the code. The order is list scheduling: of all operators the
// one with most ready instructions is emitted until none of its kind is ready, so runs are long; one
// run is one loop without dispatch. Products are not fused with sums: generated C shall agree to the
// bit.
//
// Code: run after run as uint32: operator, count, then `count` records
//
//     one argument      d a          two arguments   d a b          if      d a b c
//     sincos            d e a   (w[d] = sin, w[e] = cos)            table   d a table order
#include "expr/tape.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { OP_SINCOS = CT_NOP, NKIND };

static const uint32_t none = UINT32_MAX;

struct code {
    uint32_t *word;
    size_t nword;
};

struct copy {
    uint32_t from, to;
};

struct ct_tape {
    size_t nwork, nout;
    double *constant; // to w[0 ... nconstant)
    size_t nconstant;
    struct copy *param, *input; // input slot -> w
    size_t nparam, ninput;
    struct code prologue, body;
    uint32_t *out; // w -> out[k]
    struct ct_table *table;
    struct ct_tape_counts counts;
};

// ---- evaluation -------------------------------------------------------------------------------

// The frequent operators have a loop each. The rest spend their time in a library function anyway
// and go through ct_op_apply, which also makes them agree with every other evaluator.
#define EACH(stride) for (; n; n--, p += (stride))

static const uint32_t *run_any(enum ct_op op, uint32_t n, const uint32_t *p, double *w)
{
    if (ct_op_info[op].narg == 1)
        EACH(2) w[p[0]] = ct_op_apply(op, w[p[1]], 0, 0);
    else
        EACH(3) w[p[0]] = ct_op_apply(op, w[p[1]], w[p[2]], 0);
    return p;
}

static void run(const struct code *code, const struct ct_table *table, double *w)
{
    const uint32_t *p = code->word, *end = p + code->nword;

    while (p < end) {
        uint32_t op = *p++, n = *p++;
        switch (op) {
        case CT_OP_ADD:
            EACH(3) w[p[0]] = w[p[1]] + w[p[2]];
            break;
        case CT_OP_SUB:
            EACH(3) w[p[0]] = w[p[1]] - w[p[2]];
            break;
        case CT_OP_MUL:
            EACH(3) w[p[0]] = w[p[1]] * w[p[2]];
            break;
        case CT_OP_DIV:
            EACH(3) w[p[0]] = w[p[1]] / w[p[2]];
            break;
        case CT_OP_NEG:
            EACH(2) w[p[0]] = -w[p[1]];
            break;
        case CT_OP_SQRT:
            EACH(2) w[p[0]] = sqrt(w[p[1]]);
            break;
        case CT_OP_IF:
            EACH(4) w[p[0]] = w[p[1]] != 0 ? w[p[2]] : w[p[3]];
            break;
        case OP_SINCOS:
            EACH(3)
            {
                double angle = w[p[2]]; // read first: its slot may be one of the results
                w[p[0]] = sin(angle);
                w[p[1]] = cos(angle);
            }
            break;
        case CT_OP_TABLE:
            EACH(4) w[p[0]] = ct_table_value(&table[p[2]], p[3], w[p[1]]);
            break;
        default:
            p = run_any((enum ct_op)op, n, p, w);
        }
    }
}

void ct_tape_prepare(const struct ct_tape *t, const double *input, double *work)
{
    if (t->nconstant)
        memcpy(work, t->constant, t->nconstant * sizeof *work);
    for (size_t k = 0; k < t->nparam; k++)
        work[t->param[k].to] = input[t->param[k].from];
    run(&t->prologue, t->table, work);
}

void ct_tape_eval(const struct ct_tape *t, const double *input, double *out, double *work)
{
    for (size_t k = 0; k < t->ninput; k++)
        work[t->input[k].to] = input[t->input[k].from];
    run(&t->body, t->table, work);
    for (size_t k = 0; k < t->nout; k++)
        out[k] = work[t->out[k]];
}

size_t ct_tape_work(const struct ct_tape *t)
{
    return t->nwork;
}

struct ct_tape_counts ct_tape_counts(const struct ct_tape *t)
{
    return t->counts;
}

// ---- what is counted --------------------------------------------------------------------------

// Comparing and selecting (if, min, abs ...) cost no more than the negation, which is free.
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
    case OP_SINCOS:
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
    int narg = ct_op_info[n->op].narg;
    arg[0] = n->a;
    arg[1] = n->b;
    arg[2] = n->c;
    return narg;
}

// live[id] = 1 for the nodes below e[0 ... n); returns the number of ids looked at.
static uint32_t mark_live(unsigned char **live, struct ct_arena *a, const struct ct_exs *x,
                          const ct_ex *e, size_t n)
{
    uint32_t end = 0, arg[3];
    for (size_t k = 0; k < n; k++)
        end = e[k].id >= end ? e[k].id + 1 : end;
    *live = CT_NEWN(a, unsigned char, end);
    for (size_t k = 0; k < n; k++)
        (*live)[e[k].id] = 1;
    // children have smaller ids, so one sweep downwards reaches everything
    for (uint32_t id = end; id-- > 0;) {
        if (!(*live)[id])
            continue;
        for (int i = arguments(&x->node[id], arg); i-- > 0;)
            (*live)[arg[i]] = 1;
    }
    return end;
}

// What a value changes with. Numbers that construction did not fold (0/0) belong to the prologue.
enum rate { RATE_NEVER, RATE_PARAM, RATE_CALL };

static enum rate node_rate(const struct ct_exs *x, const struct ct_exnode *n,
                           const unsigned char *rate)
{
    if (n->op == CT_OP_CONST)
        return RATE_NEVER;
    if (n->op == CT_OP_SYM)
        return x->sym[n->a].kind == CT_SYM_PARAM ? RATE_PARAM : RATE_CALL;
    enum rate r = RATE_PARAM;
    uint32_t arg[3];
    for (int i = arguments(n, arg); i-- > 0;)
        r = rate[arg[i]] > r ? rate[arg[i]] : r;
    return r;
}

struct ct_tape_counts ct_ex_count(struct ct_arena *scratch, const struct ct_exs *x,
                                  const ct_ex *e, size_t n)
{
    struct ct_tape_counts counts = {0};
    unsigned char *live, *rate;
    uint32_t end = mark_live(&live, scratch, x, e, n);
    rate = CT_NEWN(scratch, unsigned char, end);
    for (uint32_t id = 0; id < end; id++) {
        if (!live[id])
            continue;
        rate[id] = (unsigned char)node_rate(x, &x->node[id], rate);
        if (rate[id] == RATE_CALL)
            count_op(&counts, x->node[id].op);
    }
    return counts;
}

// ---- compiling --------------------------------------------------------------------------------

struct instruction {
    uint32_t op;
    uint32_t narg, nres;
    uint32_t arg[3], res[2]; // values
    uint32_t table, order;   // of CT_OP_TABLE
    uint32_t waits;          // arguments not yet computed
    uint32_t next;           // in the queue of its operator
};

struct queue {
    uint32_t head, tail;
    size_t n;
};

// A value is a live node, numbered in the order of ids.
struct compiler {
    struct ct_arena *arena;
    const struct ct_exs *x;
    uint32_t nid;
    uint32_t *value; // by id
    size_t nvalue;
    uint32_t *node;      // by value: its id
    unsigned char *rate; // by value
    struct instruction *ins;
    size_t nins;
    uint32_t *use_start, *use; // instructions that read a value, compressed rows
    uint32_t *order;           // scheduled instructions, the prologue's first
    size_t norder, nprologue;
    uint32_t *nuse;        // by value: reads still to come, while slots are given out
    unsigned char *keep;   // by value: its slot is never given to another
    uint32_t *slot;        // by value
    uint32_t *free, nfree; // slots to be used again, last in first out
    uint32_t nslot;
};

static void number_values(struct compiler *c, const ct_ex *out, size_t nout)
{
    unsigned char *live;
    c->nid = mark_live(&live, c->arena, c->x, out, nout);
    c->value = CT_NEWN(c->arena, uint32_t, c->nid);
    for (uint32_t id = 0; id < c->nid; id++)
        c->value[id] = live[id] ? (uint32_t)c->nvalue++ : none;
    c->node = CT_NEWN(c->arena, uint32_t, c->nvalue);
    c->rate = CT_NEWN(c->arena, unsigned char, c->nvalue);
    // rates by id reuse the marks, which have done their work
    for (uint32_t id = 0; id < c->nid; id++) {
        if (c->value[id] == none)
            continue;
        live[id] = (unsigned char)node_rate(c->x, &c->x->node[id], live);
        c->node[c->value[id]] = id;
        c->rate[c->value[id]] = live[id];
    }
}

static void make_instruction(struct compiler *c, uint32_t v, const struct ct_exnode *n)
{
    struct instruction *i = &c->ins[c->nins++];
    i->op = n->op;
    i->narg = (uint32_t)arguments(n, i->arg);
    for (uint32_t k = 0; k < i->narg; k++)
        i->arg[k] = c->value[i->arg[k]];
    i->nres = 1;
    i->res[0] = v;
    if (n->op == CT_OP_TABLE) {
        i->table = n->b;
        i->order = n->c;
    }
}

// Result 0 is the sine, result 1 the cosine, whichever came first.
static void make_sincos(struct instruction *i, uint32_t v)
{
    uint32_t first = i->res[0];
    i->res[0] = i->op == CT_OP_SIN ? first : v;
    i->res[1] = i->op == CT_OP_SIN ? v : first;
    i->nres = 2;
    i->op = OP_SINCOS;
}

static void make_instructions(struct compiler *c)
{
    uint32_t *turned
        = CT_NEWN(c->arena, uint32_t, c->nvalue); // 1 + first sin or cos of a value
    c->ins = CT_NEWN(c->arena, struct instruction, c->nvalue);
    for (uint32_t v = 0; v < c->nvalue; v++) {
        const struct ct_exnode *n = &c->x->node[c->node[v]];
        if (n->op == CT_OP_CONST || n->op == CT_OP_SYM)
            continue;
        bool trig = n->op == CT_OP_SIN || n->op == CT_OP_COS;
        uint32_t *first = trig ? &turned[c->value[n->a]] : NULL;
        if (first && *first) {
            make_sincos(&c->ins[*first - 1], v);
            continue;
        }
        make_instruction(c, v, n);
        if (first)
            *first = (uint32_t)c->nins;
    }
}

// use[use_start[v] ... use_start[v + 1]): readers of v; an instruction reading v twice is twice in.
static void list_uses(struct compiler *c)
{
    size_t nuse = 0;
    c->use_start = CT_NEWN(c->arena, uint32_t, c->nvalue + 2);
    for (size_t i = 0; i < c->nins; i++)
        for (uint32_t k = 0; k < c->ins[i].narg; k++, nuse++)
            c->use_start[c->ins[i].arg[k] + 2]++;
    for (size_t v = 1; v <= c->nvalue; v++)
        c->use_start[v + 1] += c->use_start[v];
    c->use = CT_NEWN(c->arena, uint32_t, nuse);
    for (size_t i = 0; i < c->nins; i++)
        for (uint32_t k = 0; k < c->ins[i].narg; k++)
            c->use[c->use_start[c->ins[i].arg[k] + 1]++] = (uint32_t)i;
}

static void enqueue(struct compiler *c, struct queue *q, uint32_t i)
{
    q += c->ins[i].op;
    c->ins[i].next = none;
    if (q->n++)
        c->ins[q->tail].next = i;
    else
        q->head = i;
    q->tail = i;
}

// Emit instruction i; readers in the same part that were waiting only for it become ready.
static void emit(struct compiler *c, struct queue *q, uint32_t i, enum rate rate)
{
    c->order[c->norder++] = i;
    for (uint32_t r = 0; r < c->ins[i].nres; r++) {
        uint32_t v = c->ins[i].res[r];
        for (uint32_t u = c->use_start[v]; u < c->use_start[v + 1]; u++)
            if (c->rate[c->ins[c->use[u]].res[0]] == rate && --c->ins[c->use[u]].waits == 0)
                enqueue(c, q, c->use[u]);
    }
}

static bool is_computed(const struct compiler *c, uint32_t v)
{
    uint32_t op = c->x->node[c->node[v]].op;
    return op != CT_OP_CONST && op != CT_OP_SYM;
}

// Order the instructions whose result has the given rate. Ties go to the smaller operator, within an
// operator first come first served: nothing depends on addresses.
static void schedule(struct compiler *c, enum rate rate)
{
    struct queue q[NKIND] = {{0}};
    for (uint32_t i = 0; i < c->nins; i++) {
        struct instruction *ins = &c->ins[i];
        if (c->rate[ins->res[0]] != rate)
            continue;
        for (uint32_t k = 0; k < ins->narg; k++)
            ins->waits += c->rate[ins->arg[k]] == rate && is_computed(c, ins->arg[k]);
        if (!ins->waits)
            enqueue(c, q, i);
    }
    for (;;) {
        struct queue *most = &q[0];
        for (struct queue *k = q; k < q + NKIND; k++)
            most = k->n > most->n ? k : most;
        if (!most->n)
            return;
        while (most->n) {
            uint32_t i = most->head;
            most->head = c->ins[i].next;
            most->n--;
            emit(c, q, i, rate);
        }
    }
}

// ---- slots ------------------------------------------------------------------------------------

static void give_slot(struct compiler *c, uint32_t v)
{
    c->slot[v] = c->nfree ? c->free[--c->nfree] : c->nslot++;
}

static void give_up_slot(struct compiler *c, uint32_t v)
{
    if (!c->keep[v])
        c->free[c->nfree++] = c->slot[v];
}

// Outputs last to the end, constants and parameters from prepare on, and so do results of the
// prologue that the body reads.
static void mark_kept(struct compiler *c, const ct_ex *out, size_t nout)
{
    c->keep = CT_NEWN(c->arena, unsigned char, c->nvalue);
    for (size_t k = 0; k < nout; k++)
        c->keep[c->value[out[k].id]] = 1;
    for (uint32_t v = 0; v < c->nvalue; v++)
        c->keep[v] |= !is_computed(c, v) && c->rate[v] != RATE_CALL;
    for (size_t i = 0; i < c->nins; i++)
        for (uint32_t k = 0; k < c->ins[i].narg; k++)
            c->keep[c->ins[i].arg[k]] |= c->rate[c->ins[i].res[0]] == RATE_CALL
                                      && c->rate[c->ins[i].arg[k]] != RATE_CALL;
}

static void take_constants(struct compiler *c, struct ct_tape *t)
{
    t->constant = CT_NEWN(c->arena, double, c->nvalue);
    for (uint32_t v = 0; v < c->nvalue; v++)
        if (c->rate[v] == RATE_NEVER) {
            give_slot(c, v);
            ct_ex_is_const(c->x, (ct_ex){c->node[v]}, &t->constant[t->nconstant++]);
        }
}

static struct copy *take_inputs(struct compiler *c, enum rate rate, const ct_ex *in,
                                const size_t *slot, size_t nin, size_t *n)
{
    struct copy *copy = CT_NEWN(c->arena, struct copy, nin);
    for (size_t k = 0; k < nin; k++) {
        assert(ct_ex_symbol(c->x, in[k]));
        uint32_t v = in[k].id < c->nid ? c->value[in[k].id] : none;
        if (v == none || c->rate[v] != rate)
            continue;
        assert(c->slot[v] == none && "a symbol is listed twice");
        give_slot(c, v);
        copy[(*n)++] = (struct copy){(uint32_t)slot[k], c->slot[v]};
    }
    return copy;
}

// Arguments are given up before the results ask, so that a result may overwrite an argument: each
// loop reads what it needs before it writes, and a run is executed in this order.
static void give_slots(struct compiler *c, size_t from, size_t to)
{
    for (size_t k = from; k < to; k++) {
        const struct instruction *i = &c->ins[c->order[k]];
        for (uint32_t j = 0; j < i->narg; j++)
            if (--c->nuse[i->arg[j]] == 0)
                give_up_slot(c, i->arg[j]);
        for (uint32_t r = 0; r < i->nres; r++)
            give_slot(c, i->res[r]);
    }
}

static void allocate_slots(struct compiler *c, struct ct_tape *t, const ct_ex *in,
                           const size_t *slot, size_t nin)
{
    c->slot = CT_NEWN(c->arena, uint32_t, c->nvalue);
    c->free = CT_NEWN(c->arena, uint32_t, c->nvalue);
    c->nuse = CT_NEWN(c->arena, uint32_t, c->nvalue);
    for (size_t v = 0; v < c->nvalue; v++) {
        c->slot[v] = none;
        c->nuse[v] = c->use_start[v + 1] - c->use_start[v];
    }
    take_constants(c, t);
    t->param = take_inputs(c, RATE_PARAM, in, slot, nin, &t->nparam);
    give_slots(c, 0, c->nprologue);
    t->input = take_inputs(c, RATE_CALL, in, slot, nin, &t->ninput);
    give_slots(c, c->nprologue, c->norder);
    t->nwork = c->nslot;
}

// ---- code -------------------------------------------------------------------------------------

static uint32_t *write_record(const struct compiler *c, const struct instruction *i,
                              uint32_t *p)
{
    for (uint32_t r = 0; r < i->nres; r++)
        *p++ = c->slot[i->res[r]];
    for (uint32_t k = 0; k < i->narg; k++) {
        assert(c->slot[i->arg[k]] != none && "a symbol that is needed is not an input");
        *p++ = c->slot[i->arg[k]];
    }
    if (i->op == CT_OP_TABLE) {
        *p++ = i->table;
        *p++ = i->order;
    }
    return p;
}

// Words of the instructions order[from ... to) if each were a run of its own.
static size_t code_bound(const struct compiler *c, size_t from, size_t to)
{
    size_t n = 0;
    for (size_t k = from; k < to; k++) {
        const struct instruction *i = &c->ins[c->order[k]];
        bool starts = k == from || c->ins[c->order[k - 1]].op != i->op;
        n += (starts ? 2 : 0) + i->nres + i->narg + (i->op == CT_OP_TABLE ? 2 : 0);
    }
    return n;
}

static struct code write_code(const struct compiler *c, size_t from, size_t to)
{
    struct code code = {.nword = code_bound(c, from, to)};
    uint32_t *p = code.word = CT_NEWN(c->arena, uint32_t, code.nword);
    uint32_t *count = NULL;
    for (size_t k = from; k < to; k++) {
        const struct instruction *i = &c->ins[c->order[k]];
        if (k == from || c->ins[c->order[k - 1]].op != i->op) {
            *p++ = i->op;
            count = p++;
        }
        ++*count;
        p = write_record(c, i, p);
    }
    assert(p == code.word + code.nword);
    return code;
}

struct ct_tape *ct_tape_compile(struct ct_arena *a, const struct ct_exs *x, const ct_ex *out,
                                size_t nout, const ct_ex *in, const size_t *slot, size_t nin)
{
    struct ct_tape *t = CT_NEW(a, struct ct_tape);
    struct compiler c = {.arena = a, .x = x};

    number_values(&c, out, nout);
    make_instructions(&c);
    list_uses(&c);
    c.order = CT_NEWN(a, uint32_t, c.nins);
    schedule(&c, RATE_PARAM);
    c.nprologue = c.norder;
    schedule(&c, RATE_CALL);
    assert(c.norder == c.nins);
    mark_kept(&c, out, nout);
    allocate_slots(&c, t, in, slot, nin);

    t->prologue = write_code(&c, 0, c.nprologue);
    t->body = write_code(&c, c.nprologue, c.norder);
    for (size_t k = c.nprologue; k < c.norder; k++)
        count_op(&t->counts, c.ins[c.order[k]].op);
    t->nout = nout;
    t->out = CT_NEWN(a, uint32_t, nout);
    for (size_t k = 0; k < nout; k++) {
        t->out[k] = c.slot[c.value[out[k].id]];
        assert(t->out[k] != none && "an output is a symbol that is not an input");
    }
    // the points of a table stay where they are, the list of tables may move
    t->table = CT_NEWN(a, struct ct_table, x->ntable);
    if (x->ntable)
        memcpy(t->table, x->table, x->ntable * sizeof *t->table);
    return t;
}
