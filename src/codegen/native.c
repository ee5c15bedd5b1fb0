// Executable memory, prologue and calls of native code; see native.h.
#define _DEFAULT_SOURCE // MAP_ANONYMOUS; NOLINT(bugprone-reserved-identifier): the C library names it
#include "codegen/native.h"
#include "codegen/native_wide.h"

#include "codegen/x86.h"
#include "expr/sincos.h"

#if defined(__x86_64__) && (defined(__unix__) || defined(__APPLE__))
#define HAS_X86 1
#include <sys/mman.h>
#else
#define HAS_X86 0
#endif

#include <math.h>
#include <string.h>

// Number of instructions from which native code fuses products with sums. Shorter programs keep the
// bits of the tape. Default: speed against equal bits. Test: native.
static const size_t least_fused = 256;

typedef void (*body_fn)(const double *input, double *out, double *work);

struct ct_native {
    const struct ct_listing *l;
    size_t lanes, nwork;         // nwork: slots
    uint32_t *slot;              // slots of values that prepare computes
    const struct ct_copy *table; // copies of these values
    size_t ntable;
    void *memory;
    size_t nmemory, ncode;
    body_fn body;
    struct ct_native *four;            // of eight lanes, which have no code of their own
    const struct ct_native_wide *pair; // runs the code of four lanes on both halves
};

// ---- functions that code calls ----------------------------------------------------------------

// Functions of one number and of four: f(res, arg) and so on, see x86.h.
#define ONE_ARGUMENT(f)                                                                        \
    static void f##_1(double *res, const double *a)                                            \
    {                                                                                          \
        *res = f(*a);                                                                          \
    }                                                                                          \
    static void f##_4(double *res, const double *a)                                            \
    {                                                                                          \
        for (int i = 0; i < 4; i++)                                                            \
            res[i] = f(a[i]);                                                                  \
    }
#define TWO_ARGUMENTS(f)                                                                       \
    static void f##_1(double *res, const double *a, const double *b)                           \
    {                                                                                          \
        *res = f(*a, *b);                                                                      \
    }                                                                                          \
    static void f##_4(double *res, const double *a, const double *b)                           \
    {                                                                                          \
        for (int i = 0; i < 4; i++)                                                            \
            res[i] = f(a[i], b[i]);                                                            \
    }

#define EACH_FUNCTION(ONE, TWO)                                                                \
    ONE(CT_OP_SIN, sin)                                                                        \
    ONE(CT_OP_COS, cos)                                                                        \
    ONE(CT_OP_ANGLE_SIN, sine)                                                                 \
    ONE(CT_OP_ANGLE_COS, cosine)                                                               \
    ONE(CT_OP_TAN, tan)                                                                        \
    ONE(CT_OP_ASIN, asin)                                                                      \
    ONE(CT_OP_ACOS, acos)                                                                      \
    ONE(CT_OP_ATAN, atan)                                                                      \
    ONE(CT_OP_SINH, sinh)                                                                      \
    ONE(CT_OP_COSH, cosh)                                                                      \
    ONE(CT_OP_TANH, tanh)                                                                      \
    ONE(CT_OP_EXP, exp)                                                                        \
    ONE(CT_OP_LOG, log)                                                                        \
    TWO(CT_OP_POW, pow)                                                                        \
    TWO(CT_OP_ATAN2, atan2)

#if HAS_X86

static double sine(double a)
{
    double s, c;
    ct_sincos(a, &s, &c);
    return s;
}

static double cosine(double a)
{
    double s, c;
    ct_sincos(a, &s, &c);
    return c;
}

#define DEFINE_ONE(op, f) ONE_ARGUMENT(f)
#define DEFINE_TWO(op, f) TWO_ARGUMENTS(f)
EACH_FUNCTION(DEFINE_ONE, DEFINE_TWO)

static void sincos_1(double *s, const double *a, double *c)
{
    const double angle = *a;
    *s = sin(angle);
    *c = cos(angle);
}

static void sincos_4(double *s, const double *a, double *c)
{
    for (int i = 0; i < 4; i++)
        sincos_1(s + i, a + i, c + i);
}

static void angle_1(double *s, const double *a, double *c)
{
    ct_sincos_many(a, s, c, 1);
}

static void angle_4(double *s, const double *a, double *c)
{
    ct_sincos_many(a, s, c, 4);
}

static void sincos_many(double *s, const double *a, double *c, uint64_t n)
{
    ct_sincos_many(a, s, c, n);
}

static void table_1(double *res, const double *a, const struct ct_table *t, uint64_t order)
{
    *res = ct_table_value(t, (uint32_t)order, *a);
}

static void table_4(double *res, const double *a, const struct ct_table *t, uint64_t order)
{
    for (int i = 0; i < 4; i++)
        table_1(res + i, a + i, t, order);
}

static struct ct_x86_calls list_calls(int lanes)
{
    struct ct_x86_calls c = {{0}};
#define LIST(op, f) c.by_op[op] = lanes == 1 ? (uintptr_t)f##_1 : (uintptr_t)f##_4;
    EACH_FUNCTION(LIST, LIST)
    LIST(CT_OP_SINCOS, sincos)
    LIST(CT_OP_ANGLE_SINCOS, angle)
    LIST(CT_OP_TABLE, table)
    c.sincos_many = (uintptr_t)sincos_many;
    c.rows_together = ct_native_is_available(4);
    return c;
}

// ---- executable memory ------------------------------------------------------------------------

static void unmap(void *native)
{
    struct ct_native *f = native;
    if (f->memory)
        munmap(f->memory, f->nmemory);
    f->memory = NULL;
}

// Copy code to its own memory and make that executable.
static bool map(struct ct_native *f, const unsigned char *byte, size_t n)
{
    // Definition: bytes of the smallest pages
    const size_t page = 4096; // mmap rounds up where pages are larger
    f->nmemory = (n + page - 1) / page * page;
    f->memory
        = mmap(NULL, f->nmemory, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (f->memory == MAP_FAILED) {
        f->memory = NULL;
        return false;
    }
    memcpy(f->memory, byte, n);
    if (mprotect(f->memory, f->nmemory, PROT_READ | PROT_EXEC)) {
        unmap(f);
        return false;
    }
    f->ncode = n;
    memcpy(&f->body, &f->memory, sizeof f->body); // C has no cast from an object to a function
    return true;
}

static const struct ct_copy *copy_table(struct ct_arena *a, const struct ct_x86_code *code)
{
    struct ct_copy *table = CT_NEWN(a, struct ct_copy, code->ntable + 1);
    if (code->ntable)
        memcpy(table, code->table, code->ntable * sizeof *table);
    return table;
}

#endif

// ---- prologue ---------------------------------------------------------------------------------

static void place_prologue(struct ct_arena *a, struct ct_native *f)
{
    const struct ct_listing *l = f->l;
    f->slot = CT_NEWN(a, uint32_t, l->nvalue);
    for (size_t v = 0; v < l->nvalue; v++)
        if (l->rate[v] != CT_RATE_CALL)
            f->slot[v] = (uint32_t)f->nwork++;
}

static void take_leaf(const struct ct_native *f, size_t v, const double *input, double *work)
{
    double *w = work + f->lanes * f->slot[v];
    ct_ex_is_const(f->l->x, (ct_ex){f->l->node[v]}, w);
    for (size_t i = 0; i < f->lanes; i++)
        w[i] = f->l->input[v] == CT_VALUE_NONE ? w[0] : input[f->lanes * f->l->input[v] + i];
}

static void run_instruction(const struct ct_native *f, const struct ct_instruction *i,
                            double *work)
{
    for (size_t lane = 0; lane < f->lanes; lane++) {
        double arg[3] = {0}, res[2];
        for (uint32_t k = 0; k < i->narg; k++)
            arg[k] = work[f->lanes * f->slot[i->arg[k]] + lane];
        ct_instruction_apply(f->l, i, arg, res);
        for (uint32_t k = 0; k < i->nres; k++)
            work[f->lanes * f->slot[i->res[k]] + lane] = res[k];
    }
}

void ct_native_prepare(const struct ct_native *f, const double *input, double *work)
{
    if (f->pair) {
        ct_native_wide_prepare(f->pair, input, work);
        return;
    }
    for (size_t v = 0; v < f->l->nvalue; v++)
        if (f->l->is_leaf[v] && f->l->rate[v] != CT_RATE_CALL)
            take_leaf(f, v, input, work);
    for (size_t i = 0; i < f->l->nprologue; i++)
        run_instruction(f, &f->l->ins[i], work);
    for (size_t i = 0; i < f->ntable; i++) {
        const struct ct_copy *c = &f->table[i];
        const size_t n = c->is_number ? 1 : f->lanes;
        memcpy(work + n * c->slot, work + f->lanes * f->slot[c->value], n * sizeof *work);
    }
}

// ---- entries ----------------------------------------------------------------------------------

// The compiler's check includes the operating system: it must save registers of 256 bits.
bool ct_native_is_available(int lanes)
{
#if HAS_X86
    return lanes == 1 ? __builtin_cpu_supports("avx") : __builtin_cpu_supports("avx2");
#else
    (void)lanes;
    return false;
#endif
}

static bool has_fused(const struct ct_listing *l)
{
    for (size_t i = l->nprologue; i < l->nins; i++)
        if (l->ins[i].op >= CT_OP_FMA && l->ins[i].op <= CT_OP_FNMA)
            return true;
    return false;
}

static struct ct_native *create_pair(struct ct_arena *a, const struct ct_listing *l)
{
    struct ct_native *four = ct_native_create(a, l, CT_NATIVE_WIDE_LANES / 2), *f;
    if (!four)
        return NULL;
    f = CT_NEW(a, struct ct_native);
    *f = (struct ct_native){.l = four->l,
                            .lanes = CT_NATIVE_WIDE_LANES,
                            .four = four,
                            .pair = ct_native_wide_create(a, four, four->l)};
    return f;
}

struct ct_native *ct_native_create(struct ct_arena *a, const struct ct_listing *l, int lanes)
{
    if (lanes == CT_NATIVE_WIDE_LANES)
        return create_pair(a, l);
#if HAS_X86
    if (!ct_native_is_available(lanes) || (has_fused(l) && !__builtin_cpu_supports("fma")))
        return NULL;
    if (l->fuse == CT_FUSE_NATIVE && l->nins - l->nprologue >= least_fused
        && __builtin_cpu_supports("fma"))
        l = ct_listing_fuse(a, l);
    struct ct_native *f = CT_NEW(a, struct ct_native);
    const struct ct_x86_calls calls = list_calls(lanes);
    *f = (struct ct_native){.l = l, .lanes = (size_t)lanes};
    place_prologue(a, f);
    struct ct_arena *scratch
        = ct_arena_create_under(a); // temporary data are several times the result
    const struct ct_x86_code code = ct_x86_emit(scratch, l, lanes, f->slot, f->nwork, &calls);
    f->nwork = code.nwork;
    f->ntable = code.ntable;
    f->table = copy_table(a, &code);
    ct_arena_on_destroy(a, unmap, f); // before the mapping: it may run out of memory
    const bool ok = map(f, code.byte, code.nbyte);
    ct_arena_destroy(scratch);
    return ok ? f : NULL;
#else
    (void)a;
    (void)l;
    (void)lanes;
    (void)place_prologue;
    (void)has_fused;
    return NULL;
#endif
}

size_t ct_native_work(const struct ct_native *f)
{
    return f->pair ? ct_native_wide_work(f->pair) : f->nwork * f->lanes;
}

size_t ct_native_code_size(const struct ct_native *f)
{
    return f->four ? f->four->ncode : f->ncode;
}

const unsigned char *ct_native_code(const struct ct_native *f)
{
    return f->four ? f->four->memory : f->memory;
}

void ct_native_eval(const struct ct_native *f, const double *input, double *out, double *work)
{
    if (f->pair)
        ct_native_wide_eval(f->pair, input, out, work);
    else
        f->body(input, out, work);
}
