// See tangent.h.
//
//     r'(e_1 + e_5 + ...) = column 1 + column 5 + ...      no two of them with an entry in one row
#include "solve/evaluator/tangent.h"
#include "formulate/operation_count.h"

#include "codegen/native.h"
#include "expr/tape.h"

#include <string.h>

enum { LANES = CT_TANGENT_LANES };

// Entry `slope` of the result is output `row` of its colour.
struct reading {
    uint32_t slope, row;
};

struct ct_tangent_lanes {
    const struct ct_listing *l;
    const struct ct_tape *tape;
    struct ct_native *native; // NULL: the tape is run
    double *input, *out, *work;
    size_t nwork;
    size_t ninput; // without the seeds
    uint32_t ncolour;
    size_t *first_seed, *first_reading; // by colour, and the end
    uint32_t *seed;                     // by colour
    struct reading *reading;            // by colour
};

// ---- creation -----------------------------------------------------------------------------------

// start[c] ... start[c + 1]: from numbers of members in count[c + 1].
static void accumulate(size_t *start, uint32_t n)
{
    for (uint32_t c = 0; c < n; c++)
        start[c + 1] += start[c];
}

static void list_seeds(struct ct_arena *a, struct ct_tangent_lanes *t,
                       const struct ct_directional *along)
{
    size_t *next = CT_NEWN(a, size_t, t->ncolour + 1);
    t->first_seed = CT_NEWN(a, size_t, t->ncolour + 1);
    t->seed = CT_NEWN(a, uint32_t, along->nseed + 1);
    for (size_t d = 0; d < along->nseed && t->ncolour; d++)
        t->first_seed[along->colour[d] + 1]++;
    accumulate(t->first_seed, t->ncolour);
    memcpy(next, t->first_seed, t->ncolour * sizeof *next);
    for (uint32_t d = 0; d < along->nseed && t->ncolour; d++)
        t->seed[next[along->colour[d]]++] = d;
}

static void list_readings(struct ct_arena *a, struct ct_tangent_lanes *t,
                          const struct ct_residual *f, size_t nu)
{
    const struct {
        const struct ct_slope *s;
        size_t n, direction, row;
    } list[] = {{f->dq, f->ndq, 0, 0},
                {f->du, f->ndu, nu, 0},
                {f->da, f->nda, 2 * nu, 0},
                {f->dk, f->ndk, 3 * nu, 0},
                {f->dv, f->ndv, 0, nu + f->nauxiliary}};
    size_t *next = CT_NEWN(a, size_t, t->ncolour + 1);
    t->first_reading = CT_NEWN(a, size_t, t->ncolour + 1);
    t->reading = CT_NEWN(a, struct reading, f->ndq + f->ndu + f->nda + f->ndk + f->ndv + 1);
    for (size_t k = 0; k < COUNT(list); k++)
        for (size_t i = 0; i < list[k].n; i++)
            t->first_reading[f->along->colour[list[k].direction + list[k].s[i].direction]
                             + 1]++;
    accumulate(t->first_reading, t->ncolour);
    memcpy(next, t->first_reading, t->ncolour * sizeof *next);
    uint32_t slope = 0;
    for (size_t k = 0; k < COUNT(list); k++)
        for (size_t i = 0; i < list[k].n; i++) {
            const struct ct_slope *s = &list[k].s[i];
            const uint32_t c = f->along->colour[list[k].direction + s->direction];
            t->reading[next[c]++] = (struct reading){slope++, (uint32_t)list[k].row + s->row};
        }
}

struct ct_tangent_lanes *ct_tangent_lanes_create(struct ct_arena *a,
                                                 const struct ct_residual *f,
                                                 const struct ct_listing *l, size_t nu,
                                                 size_t ninput)
{
    struct ct_tangent_lanes *t = CT_NEW(a, struct ct_tangent_lanes);
    t->l = l;
    t->ninput = ninput;
    t->ncolour = f->along->ncolour;
    t->input = CT_NEWN(a, double, LANES *(ninput + f->along->nseed) + 1);
    t->out = CT_NEWN(a, double, LANES * l->nout + 1);
    list_seeds(a, t, f->along);
    list_readings(a, t, f, nu);
    return t;
}

void ct_tangent_lanes_use(struct ct_arena *a, struct ct_tangent_lanes *t, bool native,
                          const double *input)
{
    if (!native)
        t->native = NULL;
    else if (!t->native)
        t->native = ct_native_create(a, t->l, LANES);
    if (!t->native && !t->tape)
        t->tape = ct_tape_create(a, t->l);
    const size_t most = t->native ? ct_native_work(t->native) : LANES * ct_tape_work(t->tape);
    if (most >= t->nwork) {
        t->nwork = most + 1;
        t->work = ct_arena_alloc_cache_line(a, t->nwork * sizeof *t->work);
    }
    ct_tangent_lanes_prepare(t, input);
}

// ---- evaluation ---------------------------------------------------------------------------------

static void set_values(struct ct_tangent_lanes *t, const double *input)
{
    for (size_t i = 0; i < t->ninput; i++)
        for (size_t lane = 0; lane < LANES; lane++)
            t->input[LANES * i + lane] = input[i];
}

void ct_tangent_lanes_prepare(struct ct_tangent_lanes *t, const double *input)
{
    set_values(t, input);
    if (t->native)
        ct_native_prepare(t->native, t->input, t->work);
    else
        ct_tape_prepare_lanes(t->tape, LANES, t->input, t->work);
}

static void set_seed(struct ct_tangent_lanes *t, uint32_t colour, size_t lane, double value)
{
    for (size_t i = t->first_seed[colour]; i < t->first_seed[colour + 1]; i++)
        t->input[LANES * (t->ninput + t->seed[i]) + lane] = value;
}

void ct_tangent_lanes_run(struct ct_tangent_lanes *t, const double *input, double *slope)
{
    set_values(t, input);
    for (uint32_t first = 0; first < t->ncolour; first += LANES) {
        const uint32_t n = t->ncolour - first < LANES ? t->ncolour - first : LANES;
        for (uint32_t lane = 0; lane < n; lane++)
            set_seed(t, first + lane, lane, 1);
        if (t->native)
            ct_native_eval(t->native, t->input, t->out, t->work);
        else
            ct_tape_eval_lanes(t->tape, LANES, t->input, t->out, t->work);
        for (uint32_t lane = 0; lane < n; lane++) {
            set_seed(t, first + lane, lane, 0);
            for (size_t i = t->first_reading[first + lane];
                 i < t->first_reading[first + lane + 1]; i++)
                slope[t->reading[i].slope] = t->out[LANES * t->reading[i].row + lane];
        }
    }
}

double ct_tangent_lanes_operations(const struct ct_tangent_lanes *t)
{
    const struct ct_tape_counts c = t->l->counts;
    return CT_LANE_COST * (double)t->ncolour
         * (double)(c.multiplications + c.additions + c.divisions + c.functions);
}

size_t ct_tangent_lanes_code_size(const struct ct_tangent_lanes *t)
{
    return t->native ? ct_native_code_size(t->native) : 0;
}
