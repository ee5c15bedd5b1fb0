// See quad_run.h. Extrapolation of the modified midpoint rule with 2, 4, 6, ... substeps; columns
// are added until the error is below the tolerance. Source: Hairer, Norsett and Wanner (1993),
// II.9, key hairer1993.
#include "solve/run/quad_run.h"
#include "solve/evaluator/quad_program.h"

#ifdef CT_HAVE_QUADMATH

#include <math.h>
#include <string.h>

typedef ct_quad quad;

// Limit: columns of the extrapolation, of order 28 at most; a step that needs more is shortened.
enum { COLUMNS = 14 };

static quad larger(quad a, quad b)
{
    return b > a ? b : a;
}

static quad magnitude(quad a)
{
    return a < 0 ? -a : a;
}

// ---- the system ---------------------------------------------------------------------------------

struct run {
    const struct ct_evaluator *m;
    size_t ny;
    struct ct_quad_program solved, power, result, memory;
    quad *input, *out;                    // of the evaluator's layout; of the largest program
    quad *y, *dy, *end, *before, *at, *f; // (ny) each
    quad *table[COLUMNS];                 // a row of the extrapolation  (ny) each
};

static void set(struct run *r, quad t, const quad *y)
{
    const struct ct_evaluator *m = r->m;
    r->input[0] = t;
    for (size_t i = 0; i < m->nq + m->nu; i++)
        r->input[m->at_q + i] = y[i];
    r->input[m->at_work] = y[r->ny - 1];
    ct_quad_evaluate(&r->solved, r->input, r->out); // u', q'
    for (size_t i = 0; i < m->nu; i++)
        r->input[m->at_a + i] = r->out[i];
}

static void rhs(struct run *r, quad t, const quad *y, quad *dy)
{
    const struct ct_evaluator *m = r->m;
    set(r, t, y);
    for (size_t i = 0; i < m->nq; i++)
        dy[i] = r->out[m->nu + i];
    for (size_t i = 0; i < m->nu; i++)
        dy[m->nq + i] = r->out[i];
    dy[r->ny - 1] = 0;
    if (r->power.value) {
        ct_quad_evaluate(&r->power, r->input, r->out);
        dy[r->ny - 1] = r->out[0];
    }
}

static struct run create(struct ct_arena *a, const struct ct_evaluator *m, const double *y)
{
    struct run r = {.m = m, .ny = m->nq + m->nu + 1};
    const size_t most = m->solved.nout + m->result.nout + m->memory.nout + 1;
    r.solved = ct_quad_load(a, &m->solved);
    r.power = ct_quad_load(a, &m->power);
    r.result = ct_quad_load(a, &m->result);
    r.memory = ct_quad_load(a, &m->memory);
    r.input = CT_NEWN(a, quad, m->ninput);
    r.out = CT_NEWN(a, quad, most);
    quad **const vectors[] = {&r.y, &r.dy, &r.end, &r.before, &r.at, &r.f};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, quad, r.ny);
    for (int k = 0; k < COLUMNS; k++)
        r.table[k] = CT_NEWN(a, quad, r.ny);
    for (size_t i = 0; i < m->ninput; i++)
        r.input[i] = m->input[i];
    for (size_t i = 0; i < r.ny; i++)
        r.y[i] = y[i];
    return r;
}

// ---- a step -------------------------------------------------------------------------------------

// end = the state at t + h by the midpoint rule in n parts.
static void midpoint(struct run *r, quad t, quad h, int n)
{
    const size_t bytes = r->ny * sizeof *r->y;
    const quad part = h / n;
    memcpy(r->before, r->y, bytes);
    for (size_t i = 0; i < r->ny; i++)
        r->at[i] = r->y[i] + part * r->dy[i];
    for (int k = 1; k < n; k++) {
        rhs(r, t + k * part, r->at, r->f);
        for (size_t i = 0; i < r->ny; i++) {
            const quad next = r->before[i] + 2 * part * r->f[i];
            r->before[i] = r->at[i];
            r->at[i] = next;
        }
    }
    memcpy(r->end, r->at, bytes);
}

// The row of n = 2 (k + 1) parts from the row before; the error: the largest difference of its last
// two entries.
static double extrapolate(struct run *r, int k)
{
    double error = 0;
    for (size_t i = 0; i < r->ny; i++) {
        quad better = r->end[i];
        for (int j = 1; j <= k; j++) { // table[j - 1]: T of the row before
            const quad ratio = (quad)(k + 1) / (k + 1 - j);
            const quad old = r->table[j - 1][i];
            r->table[j - 1][i] = better;
            better += (better - old) / (ratio * ratio - 1);
        }
        r->table[k][i] = better;
        const quad size = larger(1, magnitude(r->y[i]));
        const quad change = k > 0 ? better - r->table[k - 1][i] : size;
        const double part = (double)(magnitude(change) / size);
        error
            = isfinite(part) ? fmax(error, part) : INFINITY; // what has overflown is no number
    }
    return error;
}

// Memories follow the motion, as ct_memory_update has them.
static void advance_to(struct run *r, quad t)
{
    const struct ct_evaluator *m = r->m;
    quad *memory = r->input + m->at_memory;
    if (!r->memory.value)
        return;
    set(r, t, r->y);
    ct_quad_evaluate(&r->memory, r->input, r->out);
    for (size_t i = 0; i < m->e->nmemory; i++)
        if (ct_memory_is_updated(&m->e->memory[i]))
            memory[i] = r->out[i];
}

// True: y has gone on by h. *factor: what the next step should be, over h. A step that needs at
// most half of the columns is doubled, one that all of them do not make accurate is halved.
static bool step(struct run *r, quad t, quad h, double tolerance, double *factor)
{
    rhs(r, t, r->y, r->dy);
    for (int k = 0; k < COLUMNS; k++) {
        midpoint(r, t, h, 2 * (k + 1));
        const double error = extrapolate(r, k);
        if (error > tolerance)
            continue;
        memcpy(r->y, r->table[k], r->ny * sizeof *r->y);
        *factor = 2 * k < COLUMNS ? 2 : 1;
        return true;
    }
    *factor = 0.5;
    return false;
}

// ---- the run ------------------------------------------------------------------------------------

bool ct_quad_can_run(const struct ct_evaluator *m)
{
    const struct ct_equations *e = m->e;
    for (size_t i = 0; i < e->nmemory; i++)
        if (ct_memory_is_updated(
                &e->memory[i])) // steps are too long to follow angles past half a turn
            return false;
    return m->solved.nout && !e->nrow && !e->nswitch && !e->x->ntable;
}

static void keep_results(struct run *r, quad t, double *out)
{
    set(r, t, r->y);
    ct_quad_evaluate(&r->result, r->input, r->out);
    for (size_t i = 0; i < r->m->result.nout; i++)
        out[i] = (double)r->out[i];
}

bool ct_quad_run(struct ct_arena *a, const struct ct_evaluator *m, const double *y,
                 double duration, size_t nsample, double tolerance, bool (*go_on)(void *user),
                 void *user, double *out)
{
    const double least = 1e-12; // Limit: part of the duration; the run fails with shorter steps
    struct run r = create(a, m, y);
    quad t = 0, h = (quad)duration / 1000;
    if (m->result.nout)
        keep_results(&r, t, out);
    for (size_t k = 1; k < nsample; k++) {
        // the time of the sample as runs in double precision have it
        const quad sample
            = k + 1 == nsample ? duration : duration * (double)k / (double)(nsample - 1);
        while (t < sample) {
            const bool is_last = h >= sample - t;
            const quad now = is_last ? sample - t : h;
            double factor;
            if (!go_on(user) || (!is_last && now < least * duration))
                return false;
            if (step(&r, t, now, tolerance, &factor)) {
                t = is_last ? sample : t + now;
                advance_to(&r, t);
                h = larger(is_last ? h : 0, factor * now);
            } else {
                h = factor * now;
            }
        }
        if (m->result.nout)
            keep_results(&r, t, out + k * m->result.nout);
    }
    return true;
}

#else

bool ct_quad_can_run(const struct ct_evaluator *m)
{
    (void)m;
    return false;
}

bool ct_quad_run(struct ct_arena *a, const struct ct_evaluator *m, const double *y,
                 double duration, size_t nsample, double tolerance, bool (*go_on)(void *user),
                 void *user, double *out)
{
    (void)a, (void)m, (void)y, (void)duration, (void)nsample, (void)tolerance, (void)go_on;
    (void)user, (void)out;
    return false;
}

#endif
