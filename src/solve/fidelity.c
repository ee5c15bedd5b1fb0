// See fidelity.h.
#include "solve/fidelity.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Where outputs have at most this part of the error of states, that of so many further steps is not looked at.
static const double harmless = 0.25;
enum { STEPS_BETWEEN = 7 };
// State errors below this say nothing about the ratio of the two: steps are still growing.
static const double least_error = 0.02;
// Rounding is felt by a change of the states by such a part of themselves, far above it so that it can be measured.
static const double change = 0x1p-40;
// An output counts from so many roundings on, and need not be better than so many.
static const double least_size = 1e6, most_precise = 16;

struct ct_fidelity {
    struct ct_machine *m;
    struct ct_program program;
    size_t ny;
    struct ct_fidelity_record record;
    double *at, *probed; // (n) g there
    double *y;           // (ny) to spare
};

// A function of time and states, but not a single one of them, which is controlled as it is, nor the total energy, which is a
// check of the run: as a small difference of large terms it would ask for digits that nothing else needs.
static bool is_controlled(const struct ct_equations *e, ct_ex v)
{
    const struct ct_exs *x = e->x;
    const unsigned states = 1u << CT_SYM_Q | 1u << CT_SYM_U, kinds = ct_ex_kinds(x, v);
    const unsigned others
        = 1u << CT_SYM_TIME | 1u << CT_SYM_PARAM | 1u << CT_SYM_MODE | 1u << CT_SYM_MEMORY;
    return kinds & states && !(kinds & ~(states | others)) && x->node[v.id].op != CT_OP_SYM
        && v.id != e->total.id;
}

struct ct_fidelity *ct_fidelity_create(struct ct_arena *a, struct ct_machine *m)
{
    const struct ct_equations *e = m->e;
    ct_ex *g = CT_NEWN(a, ct_ex, e->nresult + 1);
    size_t n = 0;
    for (size_t i = 0; i < e->nresult; i++)
        if (is_controlled(e, e->result[i].value))
            g[n++] = e->result[i].value;
    if (!n)
        return NULL;
    struct ct_fidelity *p = CT_NEW(a, struct ct_fidelity);
    *p = (struct ct_fidelity){.m = m, .ny = m->nq + m->nu + 1};
    ct_machine_compile(a, m, e->x, g, n, &p->program);
    p->record = ct_fidelity_record(a, n);
    p->at = CT_NEWN(a, double, n);
    p->probed = CT_NEWN(a, double, n);
    p->y = CT_NEWN(a, double, p->ny);
    return p;
}

const struct ct_program *ct_fidelity_program(const struct ct_fidelity *p)
{
    return &p->program;
}

// ---- what is known --------------------------------------------------------------------------------

struct ct_fidelity_record ct_fidelity_record(struct ct_arena *a, size_t n)
{
    return (struct ct_fidelity_record){
        .n = n, .largest = CT_NEWN(a, double, n), .seen = CT_NEWN(a, double, n)};
}

void ct_fidelity_clear(struct ct_fidelity_record *r)
{
    if (r->n)
        memset(r->largest, 0, r->n * sizeof *r->largest);
    r->skip = 0;
    r->has_seen = false;
}

bool ct_fidelity_is_due(struct ct_fidelity_record *r)
{
    if (r->skip == 0)
        return true;
    r->skip--;
    return false;
}

// fmax without a call; b, if a is not a number.
static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

double ct_fidelity_judge(struct ct_fidelity_record *r, const double *at, const double *probed,
                         const double *off, const struct ct_tolerance *tolerance, double states)
{
    double sum = 0;
    size_t n = 0;
    r->has_seen = true;
    for (size_t i = 0; i < r->n; i++) {
        const double rounding = fabs(probed[i] - at[i]) * (DBL_EPSILON / change);
        r->seen[i] = fabs(at[i]);
        const double size = larger(r->seen[i], r->largest[i]);
        if (!(size >= least_size * rounding))
            continue;
        const double wanted = tolerance->rtol * size + tolerance->atol;
        const double part = (off[i] - at[i]) / larger(most_precise * rounding, wanted);
        sum += part * part;
        n++;
    }
    const double error = n && isfinite(sum) ? sqrt(sum / (double)n) : 0;
    r->skip = states >= least_error && error <= harmless * states ? STEPS_BETWEEN : 0;
    return error;
}

void ct_fidelity_keep(struct ct_fidelity_record *r)
{
    for (size_t i = 0; i < r->n && r->has_seen; i++)
        r->largest[i] = larger(r->seen[i], r->largest[i]);
    r->has_seen = false;
}

// ---- a run alone ------------------------------------------------------------------------------------

void ct_fidelity_start(struct ct_fidelity *p)
{
    ct_fidelity_clear(&p->record);
}

// g at p->y.
static const double *evaluate(struct ct_fidelity *p, double t)
{
    ct_machine_set(p->m, t, p->y);
    ct_program_run(&p->program, p->m->input);
    return p->program.out;
}

double ct_fidelity_error(struct ct_fidelity *p, double t, const double *y, const double *e,
                         const struct ct_tolerance *tolerance, double states)
{
    const size_t bytes = p->record.n * sizeof *p->at;
    if (!ct_fidelity_is_due(&p->record))
        return 0;
    memcpy(p->y, y, p->ny * sizeof *y);
    memcpy(p->at, evaluate(p, t), bytes);
    for (size_t i = 0; i < p->ny; i++)
        p->y[i] = y[i] + ct_fidelity_probe((int)i) * y[i];
    memcpy(p->probed, evaluate(p, t), bytes);
    for (size_t i = 0; i < p->ny; i++)
        p->y[i] = y[i] + e[i];
    return ct_fidelity_judge(&p->record, p->at, p->probed, evaluate(p, t), tolerance, states);
}

void ct_fidelity_accept(struct ct_fidelity *p)
{
    ct_fidelity_keep(&p->record);
}
