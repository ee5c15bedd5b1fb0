// List of instructions -> straight-line program of runs; see tape.h.
//
// The work array, in the order of allocation:
//
//     [ constants | parameters | results the prologue keeps | body: inputs and temporaries ]
//
// Compiling is three passes, each linear in the instructions: put them into an order, give every
// value a slot of the work array, write the code. The order is list scheduling: of all operators
// the one with most ready instructions is emitted until none of its kind is ready, so runs are
// long; one run is one loop without dispatch.
//
// Code: run after run as uint32: operator, count, then `count` records
//
//     one argument      d a          two arguments   d a b          if, fused    d a b c
//     sincos            d e a   (w[d] = sin, w[e] = cos)            table        d a table order
#include "expr/tape.h"
#include "expr/sincos.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static const uint32_t none = CT_VALUE_NONE;

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
    const struct ct_table *table;
    struct ct_tape_counts counts;
};

// ---- evaluation -------------------------------------------------------------------------------

static double sine(double a)
{
    double s, c;
    ct_sincos_many(&a, &s, &c, 1);
    return s;
}

static double cosine(double a)
{
    double s, c;
    ct_sincos_many(&a, &s, &c, 1);
    return c;
}

// Several lanes; aligned to a single number only.
#define SLOT(lanes) double __attribute__((vector_size(8 * (lanes)), aligned(8), may_alias))
typedef SLOT(4) slot4;
typedef SLOT(8) slot8;

#define LANES 1
#define V double
#define RUN run_1
#define TARGET
#include "expr/tape_run.def"
#define LANES 4 // Definition: runs in a slot
#define V slot4
#define RUN run_4
#define TARGET
#include "expr/tape_run.def"
#define LANES 8 // Definition: runs in a slot
#define V slot8
#define RUN run_8
#define TARGET
#include "expr/tape_run.def"
#ifdef __x86_64__ // the same operations, four lanes in one register
#define LANES 4   // Definition: runs in a slot
#define V slot4
#define RUN run_4_avx2
#define TARGET __attribute__((target("avx2")))
#include "expr/tape_run.def"
#define LANES 8 // Definition: runs in a slot
#define V slot8
#define RUN run_8_avx2
#define TARGET __attribute__((target("avx2")))
#include "expr/tape_run.def"
#endif

static void run(const struct ct_tape *t, const struct code *code, int lanes, double *w)
{
    assert(lanes == 1 || lanes == 4 || lanes == 8);
    if (lanes == 1)
        run_1(code, t->table, w);
#ifdef __x86_64__
    else if (__builtin_cpu_supports("avx2"))
        (lanes == 4 ? run_4_avx2 : run_8_avx2)(code, t->table, w);
#endif
    else
        (lanes == 4 ? run_4 : run_8)(code, t->table, w);
}

static void copy_in(const struct copy *c, size_t n, size_t lanes, const double *input,
                    double *w)
{
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < lanes; i++)
            w[lanes * c[k].to + i] = input[lanes * c[k].from + i];
}

void ct_tape_prepare_lanes(const struct ct_tape *t, int lanes, const double *input,
                           double *work)
{
    const size_t n = (size_t)lanes;
    for (size_t k = 0; k < t->nconstant; k++)
        for (size_t i = 0; i < n; i++)
            work[n * k + i] = t->constant[k];
    copy_in(t->param, t->nparam, n, input, work);
    run(t, &t->prologue, lanes, work);
}

void ct_tape_eval_lanes(const struct ct_tape *t, int lanes, const double *input, double *out,
                        double *work)
{
    const size_t n = (size_t)lanes;
    copy_in(t->input, t->ninput, n, input, work);
    run(t, &t->body, lanes, work);
    for (size_t k = 0; k < t->nout; k++)
        for (size_t i = 0; i < n; i++)
            out[n * k + i] = work[n * t->out[k] + i];
}

void ct_tape_prepare(const struct ct_tape *t, const double *input, double *work)
{
    ct_tape_prepare_lanes(t, 1, input, work);
}

void ct_tape_eval(const struct ct_tape *t, const double *input, double *out, double *work)
{
    for (size_t k = 0; k < t->ninput; k++)
        work[t->input[k].to] = input[t->input[k].from];
    run_1(&t->body, t->table, work);
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

// ---- order ------------------------------------------------------------------------------------

struct queue {
    uint32_t head, tail;
    size_t n;
};

struct compiler {
    struct ct_arena *arena, *scratch;
    const struct ct_listing *l;
    struct ct_uses uses;
    uint32_t *waits; // by instruction: arguments not yet computed
    uint32_t *next;  // by instruction: in the queue of its operator
    uint32_t *order; // scheduled instructions, the prologue's first
    size_t norder;
    uint32_t *nuse;        // by value: reads still to come, while slots are given out
    unsigned char *keep;   // by value: its slot is never reused
    uint32_t *slot;        // by value
    uint32_t *free, nfree; // free slots, last in first out
    uint32_t nslot;
};

static void enqueue(struct compiler *c, struct queue *q, uint32_t i)
{
    q += c->l->ins[i].op;
    c->next[i] = none;
    if (q->n++)
        c->next[q->tail] = i;
    else
        q->head = i;
    q->tail = i;
}

// Emit instruction i. Later instructions (below `to`) whose last missing argument it was become
// ready.
static void emit(struct compiler *c, struct queue *q, uint32_t i, size_t to)
{
    const struct ct_instruction *ins = &c->l->ins[i];
    c->order[c->norder++] = i;
    for (uint32_t r = 0; r < ins->nres; r++) {
        const uint32_t v = ins->res[r];
        for (uint32_t u = c->uses.start[v]; u < c->uses.start[v + 1]; u++)
            if (c->uses.use[u] < to && --c->waits[c->uses.use[u]] == 0)
                enqueue(c, q, c->uses.use[u]);
    }
}

// Order the instructions [from, to), the prologue or the body. Ties go to the smaller operator,
// within an operator first come first served: nothing depends on addresses.
static void schedule(struct compiler *c, size_t from, size_t to, enum ct_rate rate)
{
    const struct ct_listing *l = c->l;
    struct queue q[CT_NKIND] = {{0}};
    for (size_t i = from; i < to; i++) {
        const struct ct_instruction *ins = &l->ins[i];
        for (uint32_t k = 0; k < ins->narg; k++)
            c->waits[i] += l->rate[ins->arg[k]] == rate && !l->is_leaf[ins->arg[k]];
        if (!c->waits[i])
            enqueue(c, q, (uint32_t)i);
    }
    for (;;) {
        struct queue *most = &q[0];
        for (struct queue *k = q; k < q + CT_NKIND; k++)
            most = k->n > most->n ? k : most;
        if (!most->n)
            return;
        while (most->n) {
            const uint32_t i = most->head;
            most->head = c->next[i];
            most->n--;
            emit(c, q, i, to);
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

// Mark the values whose slots are never reused: outputs, constants, parameters, and results of the
// prologue that the body reads.
static void mark_kept(struct compiler *c)
{
    const struct ct_listing *l = c->l;
    c->keep = CT_NEWN(c->scratch, unsigned char, l->nvalue);
    for (size_t k = 0; k < l->nout; k++)
        c->keep[l->out[k]] = 1;
    for (size_t v = 0; v < l->nvalue; v++)
        c->keep[v] |= l->is_leaf[v] && l->rate[v] != CT_RATE_CALL;
    for (size_t i = l->nprologue; i < l->nins; i++)
        for (uint32_t k = 0; k < l->ins[i].narg; k++)
            c->keep[l->ins[i].arg[k]] |= l->rate[l->ins[i].arg[k]] != CT_RATE_CALL;
}

static void take_constants(struct compiler *c, struct ct_tape *t)
{
    size_t n = 0;
    for (size_t v = 0; v < c->l->nvalue; v++)
        n += c->l->rate[v] == CT_RATE_NEVER;
    t->constant = CT_NEWN(c->arena, double, n);
    for (uint32_t v = 0; v < c->l->nvalue; v++)
        if (c->l->rate[v] == CT_RATE_NEVER) {
            give_slot(c, v);
            ct_ex_is_const(c->l->x, (ct_ex){c->l->node[v]}, &t->constant[t->nconstant++]);
        }
}

static struct copy *take_inputs(struct compiler *c, enum ct_rate rate, size_t *n)
{
    size_t ninput = 0;
    for (size_t v = 0; v < c->l->nvalue; v++)
        ninput += c->l->input[v] != none && c->l->rate[v] == rate;
    struct copy *copy = CT_NEWN(c->arena, struct copy, ninput);
    for (uint32_t v = 0; v < c->l->nvalue; v++) {
        if (c->l->input[v] == none || c->l->rate[v] != rate)
            continue;
        give_slot(c, v);
        copy[(*n)++] = (struct copy){c->l->input[v], c->slot[v]};
    }
    return copy;
}

// Assign slots. Those of arguments are freed before the result asks for one, so that a result may
// overwrite an argument. This is safe: each loop reads its arguments before it writes, and a run is
// executed in this order.
static void give_slots(struct compiler *c, size_t from, size_t to)
{
    for (size_t k = from; k < to; k++) {
        const struct ct_instruction *i = &c->l->ins[c->order[k]];
        for (uint32_t j = 0; j < i->narg; j++)
            if (--c->nuse[i->arg[j]] == 0)
                give_up_slot(c, i->arg[j]);
        for (uint32_t r = 0; r < i->nres; r++)
            give_slot(c, i->res[r]);
    }
}

static void allocate_slots(struct compiler *c, struct ct_tape *t)
{
    const size_t nvalue = c->l->nvalue;
    c->slot = CT_NEWN(c->scratch, uint32_t, nvalue);
    c->free = CT_NEWN(c->scratch, uint32_t, nvalue);
    c->nuse = CT_NEWN(c->scratch, uint32_t, nvalue);
    for (size_t v = 0; v < nvalue; v++) {
        c->slot[v] = none;
        c->nuse[v] = c->uses.start[v + 1] - c->uses.start[v];
    }
    take_constants(c, t);
    t->param = take_inputs(c, CT_RATE_PARAM, &t->nparam);
    give_slots(c, 0, c->l->nprologue);
    t->input = take_inputs(c, CT_RATE_CALL, &t->ninput);
    give_slots(c, c->l->nprologue, c->l->nins);
    t->nwork = c->nslot;
}

// ---- code -------------------------------------------------------------------------------------

static uint32_t *write_record(const struct compiler *c, const struct ct_instruction *i,
                              uint32_t *p)
{
    for (uint32_t r = 0; r < i->nres; r++)
        *p++ = c->slot[i->res[r]];
    for (uint32_t k = 0; k < i->narg; k++)
        *p++ = c->slot[i->arg[k]];
    if (i->op == CT_OP_TABLE) {
        *p++ = i->table;
        *p++ = i->order;
    }
    return p;
}

// Does the instruction at index k of the order start a run of the part that begins at `from`?
static bool starts_run(const struct compiler *c, size_t k, size_t from)
{
    return k == from || c->l->ins[c->order[k - 1]].op != c->l->ins[c->order[k]].op;
}

static size_t count_words(const struct compiler *c, size_t from, size_t to)
{
    size_t n = 0;
    for (size_t k = from; k < to; k++) {
        const struct ct_instruction *i = &c->l->ins[c->order[k]];
        n += (starts_run(c, k, from) ? 2 : 0) + i->nres + i->narg
           + (i->op == CT_OP_TABLE ? 2 : 0);
    }
    return n;
}

static struct code write_code(const struct compiler *c, size_t from, size_t to)
{
    struct code code = {.nword = count_words(c, from, to)};
    uint32_t *p = code.word = CT_NEWN(c->arena, uint32_t, code.nword);
    uint32_t *count = NULL;
    for (size_t k = from; k < to; k++) {
        const struct ct_instruction *i = &c->l->ins[c->order[k]];
        if (starts_run(c, k, from)) {
            *p++ = i->op;
            count = p++;
        }
        ++*count;
        p = write_record(c, i, p);
    }
    assert(p == code.word + code.nword);
    return code;
}

struct ct_tape *ct_tape_create(struct ct_arena *a, const struct ct_listing *l)
{
    struct ct_tape *t = CT_NEW(a, struct ct_tape);
    struct ct_arena *scratch = ct_arena_create_under(a);
    struct compiler c
        = {.arena = a, .scratch = scratch, .l = l, .uses = ct_listing_uses(scratch, l)};

    c.order = CT_NEWN(scratch, uint32_t, l->nins);
    c.waits = CT_NEWN(scratch, uint32_t, l->nins);
    c.next = CT_NEWN(scratch, uint32_t, l->nins);
    schedule(&c, 0, l->nprologue, CT_RATE_PARAM);
    schedule(&c, l->nprologue, l->nins, CT_RATE_CALL);
    assert(c.norder == l->nins);
    mark_kept(&c);
    allocate_slots(&c, t);

    t->prologue = write_code(&c, 0, l->nprologue);
    t->body = write_code(&c, l->nprologue, l->nins);
    t->counts = l->counts;
    t->table = l->table;
    t->nout = l->nout;
    t->out = CT_NEWN(a, uint32_t, l->nout);
    for (size_t k = 0; k < l->nout; k++)
        t->out[k] = c.slot[l->out[k]];
    ct_arena_destroy(scratch);
    return t;
}

struct ct_tape *ct_tape_compile(struct ct_arena *a, const struct ct_exs *x, const ct_ex *out,
                                size_t nout, const ct_ex *in, const size_t *slot, size_t nin)
{
    return ct_tape_create(a, ct_listing_create(a, x, out, nout, in, slot, nin, CT_FUSE_NO));
}
