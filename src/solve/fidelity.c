// See fidelity.h.
#include "solve/fidelity.h"

#include "integrate/stepper.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Where outputs have at most this part of the error of states, that of so many further steps is not looked at.
static const double harmless = 0.25;
enum { STEPS_BETWEEN = 7 };
// Where the ratio of the two is the same to this part at two looks in a row, it is taken for that of more and more steps.
static const double steady = 0.02;
enum { MOST_BETWEEN = 15 };
// Rounding is measured again after so many looks where it counts for nothing, and at once where an error would refuse a step.
enum { LOOKS_BETWEEN = 15 };
// State errors below this say nothing about the ratio of the two: steps are still growing.
static const double least_error = 0.02;
// Rounding is felt by a change of the states by such a part of themselves, far above it so that it can be measured.
static const double change = 0x1p-40;
// An output counts from so many roundings on, with six digits and more, and need not be better than so many.
const double ct_fidelity_least_size = 1e6;
static const double most_precise = 16;

struct ct_fidelity {
    struct ct_machine *m;
    struct ct_program program;
    struct ct_amplifier *amplifier;
    int *result; // (n) of the equations
    size_t ny;
    struct ct_fidelity_record record;
    double *at, *probed; // (n) g there
    double *expected;    // (n) as large they are expected to become
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

bool ct_fidelity_is_check(const struct ct_equations *e, size_t i)
{
    return e->result[i].value.id == e->total.id;
}

bool ct_fidelity_is_demanding(const struct ct_equations *e, size_t i)
{
    const ct_ex v = e->result[i].value;
    const unsigned known
        = 1u << CT_SYM_TIME | 1u << CT_SYM_PARAM | 1u << CT_SYM_Q | 1u << CT_SYM_U;
    return !ct_fidelity_is_check(e, i) && ct_ex_kinds(e->x, v) & ~known;
}

bool ct_fidelity_find_asked(struct ct_arena *a, const struct ct_equations *e,
                            const bool **speeds, const bool **places)
{
    bool *u = CT_NEWN(a, bool, e->nu + 1), *q = CT_NEWN(a, bool, e->nu + 1);
    for (size_t k = 0; k < e->nu; k++) // a rotation has no coordinate of its own
        q[k] = e->u[k].q < 0;
    for (size_t i = 0; i < e->nresult; i++) {
        const unsigned id = e->result[i].value.id;
        if (ct_fidelity_is_demanding(e, i))
            return false;
        for (size_t k = 0; k < e->nu; k++) {
            u[k] |= id == e->u[k].symbol.id;
            q[k] |= e->u[k].q >= 0 && id == e->q[e->u[k].q].symbol.id;
        }
    }
    *speeds = u;
    *places = q;
    return true;
}

struct ct_fidelity *ct_fidelity_create(struct ct_arena *a, struct ct_machine *m)
{
    const struct ct_equations *e = m->e;
    ct_ex *g = CT_NEWN(a, ct_ex, e->nresult + 1);
    int *result = CT_NEWN(a, int, e->nresult + 1);
    size_t n = 0;
    for (size_t i = 0; i < e->nresult; i++)
        if (is_controlled(e, e->result[i].value)) {
            result[n] = (int)i;
            g[n++] = e->result[i].value;
        }
    if (!n)
        return NULL;
    struct ct_fidelity *p = CT_NEW(a, struct ct_fidelity);
    *p = (struct ct_fidelity){.m = m, .ny = m->nq + m->nu + 1, .result = result};
    ct_machine_compile(a, m, e->x, g, n, &p->program);
    p->record = ct_fidelity_record(a, n);
    p->at = CT_NEWN(a, double, n);
    p->probed = CT_NEWN(a, double, n);
    p->expected = CT_NEWN(a, double, n);
    p->y = CT_NEWN(a, double, p->ny);
    p->amplifier = ct_amplifier_create(a, m, &p->program, n);
    return p;
}

struct ct_amplifier *ct_fidelity_amplifier(struct ct_fidelity *p)
{
    return p->amplifier;
}

int ct_fidelity_blunt(struct ct_fidelity *p, double t, const double *y, double wanted,
                      double *part)
{
    const int i = ct_amplifier_blunt(p->amplifier, t, y, p->record.largest, wanted, part);
    return i < 0 ? -1 : p->result[i];
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
    r->skip = r->between = r->unprobed = 0;
    r->ratio = 0;
    r->has_seen = false;
}

bool ct_fidelity_is_due(struct ct_fidelity_record *r)
{
    if (r->skip == 0)
        return true;
    r->skip--;
    return false;
}

double ct_fidelity_foreseen(const struct ct_fidelity_record *r, double states)
{
    return r->ratio > harmless ? r->ratio * states : 0;
}

// After a look: how many steps the ratio of both errors is to hold for.
static void plan_looks(struct ct_fidelity_record *r, double error, double states)
{
    const double before = r->ratio, ratio = states >= least_error ? error / states : 0;
    const bool is_steady = fabs(ratio - before) <= steady * before;
    r->ratio = ratio;
    if (states >= least_error && ratio <= harmless)
        r->between = STEPS_BETWEEN;
    else
        r->between = is_steady && ratio > 0 ? 2 * r->between + 1 : 0;
    r->between = r->between < MOST_BETWEEN ? r->between : MOST_BETWEEN;
    r->skip = r->between;
}

// One of an output, from what ct_fidelity_probe changes it by.
static double rounding_of(double at, double probed)
{
    return fabs(probed - at) * (DBL_EPSILON / change);
}

double ct_fidelity_judge(struct ct_fidelity_record *r, const double *at, const double *probed,
                         const double *off, const struct ct_tolerance *tolerance, double states)
{
    double sum = 0;
    size_t n = 0;
    bool is_felt = false;
    r->has_seen = true;
    for (size_t i = 0; i < r->n; i++) {
        const double rounding = rounding_of(at[i], probed[i]);
        r->seen[i] = fabs(at[i]);
        const double size = ct_larger(r->seen[i], r->largest[i]);
        const double wanted = tolerance->rtol * size + tolerance->atol;
        is_felt |= !(size >= ct_fidelity_least_size * rounding)
                || !(wanted >= most_precise * rounding);
        if (!(size >= ct_fidelity_least_size * rounding)
            || (r->apart && ct_amplifier_has(r->apart, i)))
            continue;
        const double part = (off[i] - at[i]) / ct_larger(most_precise * rounding, wanted);
        sum += part * part;
        n++;
    }
    const double error = n && isfinite(sum) ? sqrt(sum / (double)n) : 0;
    if (probed != at)
        r->unprobed = is_felt ? 0 : LOOKS_BETWEEN;
    plan_looks(r, error, states);
    return error;
}

void ct_fidelity_keep(struct ct_fidelity_record *r)
{
    if (!r->has_seen)
        return;
    for (size_t i = 0; i < r->n; i++)
        r->largest[i] = ct_larger(r->seen[i], r->largest[i]);
    r->has_seen = false;
}

// ---- a run alone ------------------------------------------------------------------------------------

void ct_fidelity_start(struct ct_fidelity *p)
{
    ct_fidelity_clear(&p->record);
    ct_amplifier_start(p->amplifier);
}

// g at p->y.
static const double *evaluate(struct ct_fidelity *p, double t)
{
    ct_machine_set(p->m, t, p->y);
    ct_program_run(&p->program, p->m->input);
    return p->program.out;
}

// Leaves in p->probed what outputs are where states differ by little more than rounding.
static void probe(struct ct_fidelity *p, double t, const double *y)
{
    for (size_t i = 0; i < p->ny; i++)
        p->y[i] = y[i] + ct_fidelity_probe((int)i) * y[i];
    memcpy(p->probed, evaluate(p, t), p->record.n * sizeof *p->probed);
}

static double look(struct ct_fidelity *p, double t, const double *y, const double *e,
                   const struct ct_tolerance *tolerance, double states)
{
    struct ct_fidelity_record *r = &p->record;
    ct_machine_copy(p->y, y, p->ny);
    memcpy(p->at, evaluate(p, t), r->n * sizeof *p->at);
    const bool is_probed = r->unprobed == 0;
    if (is_probed)
        probe(p, t, y);
    else
        r->unprobed--;
    for (size_t i = 0; i < p->ny; i++)
        p->y[i] = y[i] + e[i];
    const double *off = evaluate(p, t);
    const double *probed = is_probed ? p->probed : p->at;
    const double error = ct_fidelity_judge(r, p->at, probed, off, tolerance, states);
    if (is_probed || error <= 1)
        return error;
    r->skip = r->unprobed = 0; // no step is refused for its rounding
    return look(p, t, y, e, tolerance, states);
}

double ct_fidelity_error(struct ct_fidelity *p, double t, const double *y, const double *e,
                         const struct ct_tolerance *tolerance, double states, bool is_implicit)
{
    p->record.apart = is_implicit ? p->amplifier : NULL;
    if (!ct_fidelity_is_due(&p->record))
        return ct_fidelity_foreseen(&p->record, states);
    return look(p, t, y, e, tolerance, states);
}

double ct_fidelity_felt(struct ct_fidelity *p, double t, const double *y, const double *e,
                        double least)
{
    double most = 0;
    ct_machine_copy(p->y, y, p->ny);
    memcpy(p->at, evaluate(p, t), p->record.n * sizeof *p->at);
    probe(p, t, y);
    for (size_t i = 0; i < p->ny; i++)
        p->y[i] = y[i] + e[i];
    const double *off = evaluate(p, t);
    for (size_t i = 0; i < p->record.n; i++) {
        const double way = fabs(off[i] - p->at[i]),
                     size = ct_larger(fabs(p->at[i]), p->record.largest[i]),
                     to_come = least > 0 ? ct_larger(p->expected[i], least) : 0;
        if (least > 0 && ct_amplifier_has(p->amplifier, i))
            continue;
        if (way > 0 && size >= ct_fidelity_least_size * rounding_of(p->at[i], p->probed[i]))
            most = ct_larger(most, way / ct_larger(size, to_come));
    }
    return most;
}

void ct_fidelity_expect(struct ct_fidelity *p, double t, const double *y, const double *way,
                        double times)
{
    ct_machine_copy(p->y, y, p->ny);
    memcpy(p->at, evaluate(p, t), p->record.n * sizeof *p->at);
    for (size_t i = 0; i < p->ny; i++)
        p->y[i] = y[i] + way[i];
    const double *off = evaluate(p, t);
    for (size_t i = 0; i < p->record.n; i++)
        p->expected[i] = times * fabs(off[i] - p->at[i]);
}

void ct_fidelity_accept(struct ct_fidelity *p)
{
    ct_fidelity_keep(&p->record);
}
