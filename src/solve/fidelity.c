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
// Rounding is felt by a change of the states by this part of themselves, far above it so that it can be measured.
static const double change = 0x1p-40;
// An output counts from so many roundings on, and need not be better than so many.
static const double least_size = 1e6, most_precise = 16;

struct ct_fidelity {
    struct ct_machine *m;
    struct ct_program program;
    size_t n, ny;
    double *largest,
        *seen;        // (n) |g| over the steps that were accepted, at the last one looked at
    double *at;       // (n) g there
    double *rounding; // (n)
    double *y;        // (ny) to spare
    int skip;         // steps that are not looked at
    bool has_seen;    // since the last acceptance
};

// A function of time and states, but not a single one of them, which is controlled as it is.
static bool is_controlled(const struct ct_exs *x, ct_ex v)
{
    const unsigned states = 1u << CT_SYM_Q | 1u << CT_SYM_U, kinds = ct_ex_kinds(x, v);
    const unsigned others
        = 1u << CT_SYM_TIME | 1u << CT_SYM_PARAM | 1u << CT_SYM_MODE | 1u << CT_SYM_MEMORY;
    return kinds & states && !(kinds & ~(states | others)) && x->node[v.id].op != CT_OP_SYM;
}

struct ct_fidelity *ct_fidelity_create(struct ct_arena *a, struct ct_machine *m)
{
    const struct ct_equations *e = m->e;
    ct_ex *g = CT_NEWN(a, ct_ex, e->nresult + 1);
    size_t n = 0;
    for (size_t i = 0; i < e->nresult; i++)
        if (is_controlled(e->x, e->result[i].value))
            g[n++] = e->result[i].value;
    if (!n)
        return NULL;
    struct ct_fidelity *p = CT_NEW(a, struct ct_fidelity);
    *p = (struct ct_fidelity){.m = m, .n = n, .ny = m->nq + m->nu + 1};
    ct_machine_compile(a, m, e->x, g, n, &p->program);
    double **const vectors[] = {&p->largest, &p->seen, &p->at, &p->rounding};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, n);
    p->y = CT_NEWN(a, double, p->ny);
    return p;
}

void ct_fidelity_start(struct ct_fidelity *p)
{
    memset(p->largest, 0, p->n * sizeof *p->largest);
    p->skip = 0;
    p->has_seen = false;
}

// g at y + s e; e == NULL: at y with changes of both signs by the part s.
static const double *evaluate(struct ct_fidelity *p, double t, const double *y, const double *e,
                              double s)
{
    for (size_t i = 0; i < p->ny; i++)
        p->y[i] = y[i] + s * (e ? e[i] : i % 2 ? -y[i] : y[i]);
    ct_machine_set(p->m, t, p->y);
    ct_program_run(&p->program, p->m->input);
    return p->program.out;
}

static void measure_rounding(struct ct_fidelity *p, double t, const double *y)
{
    const double *g = evaluate(p, t, y, NULL, change);
    for (size_t i = 0; i < p->n; i++)
        p->rounding[i] = fabs(g[i] - p->at[i]) * (DBL_EPSILON / change);
}

static double error_of_outputs(struct ct_fidelity *p, double t, const double *y,
                               const double *e, const struct ct_tolerance *tolerance)
{
    const double *g = evaluate(p, t, y, e, 1);
    double sum = 0;
    size_t n = 0;
    for (size_t i = 0; i < p->n; i++) {
        const double size = fmax(p->largest[i], p->seen[i]);
        if (!(size >= least_size * p->rounding[i]))
            continue;
        const double wanted = tolerance->rtol * size + tolerance->atol;
        const double part = (g[i] - p->at[i]) / fmax(wanted, most_precise * p->rounding[i]);
        sum += part * part;
        n++;
    }
    return n && isfinite(sum) ? sqrt(sum / (double)n) : 0;
}

double ct_fidelity_error(struct ct_fidelity *p, double t, const double *y, const double *e,
                         const struct ct_tolerance *tolerance, double states)
{
    if (p->skip > 0) {
        p->skip--;
        return 0;
    }
    memcpy(p->at, evaluate(p, t, y, e, 0), p->n * sizeof *p->at);
    for (size_t i = 0; i < p->n; i++)
        p->seen[i] = fabs(p->at[i]);
    p->has_seen = true;
    measure_rounding(p, t, y);
    const double error = error_of_outputs(p, t, y, e, tolerance);
    p->skip = states >= least_error && error <= harmless * states ? STEPS_BETWEEN : 0;
    return error;
}

void ct_fidelity_accept(struct ct_fidelity *p)
{
    for (size_t i = 0; i < p->n && p->has_seen; i++)
        p->largest[i] = fmax(p->largest[i], p->seen[i]);
    p->has_seen = false;
}
