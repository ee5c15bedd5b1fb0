// Outputs with fewer digits than are asked for, whatever the steps: looked for at the end of a run.
//
// Some are functions of states that amplify their rounding (amplifier.h). Others feel it through the motion: stiff forces answer a
// rounding of places, eps q, by accelerations eps |f'(q) q|, and a speed keeps of that what its damping and its vibration leave,
//
//     eps |f'(q) q| / max(omega, |f'(u)|),   omega^2 = |f'(q) q|/|q|                                  (8.15)
//
// A body on a stiff damped spring that creeps along has as few digits in its speed as the spring in its force. Those of the steps of an
// explicit method add up where nothing damps them,
//
//     (omega/max omega) root(min(n, n/(f'(u) (t1 - t0))))  times a rounding                           (8.18)
#include "solve/run.h"

#include <float.h>
#include <string.h>

// Changes are so many roundings, far above them, and so little that the equations are linear in them.
static const double roundings = 0x1p12;
// An output need not be better than so many roundings.
static const double most_precise = 2;

static double part_of(size_t i)
{
    const double golden
        = 0.618033988749895; // different for each state, so that nothing cancels
    return 1 + fmod(golden * (double)i, 1);
}

struct noise {
    double *speed; // (nu) in so many roundings, after damping
    double *share; // (nu) omega/(the largest omega)
    double *
        sum; // (nu) root of the steps whose roundings are still there: of either sign, n add up to the root of n
    double place; // largest, in so many roundings
};

// Of speeds, at r->y. omega is the root of the answer to a change of places; noise is omega times places, and less where damping is
// more than omega.
static bool find_noise(struct ct_run *r, double t, struct noise *e)
{
    const size_t nq = r->m->nq, nu = r->m->nu;
    const double *f = r->dy + nq;
    double *f0 = r->scratch, most = 0;
    if (ct_run_rhs(r, t, r->y, r->dy) != CT_EVAL_OK)
        return false;
    memcpy(f0, f, nu * sizeof *f);
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    e->place = 0;
    for (size_t i = 0; i < nq; i++) {
        const double change = roundings * DBL_EPSILON / 2 * part_of(i) * fabs(r->y[i]);
        e->place = fmax(e->place, change);
        r->stage[i] += change;
    }
    if (!(e->place > 0) || ct_run_rhs(r, t, r->stage, r->dy) != CT_EVAL_OK)
        return false;
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    for (size_t k = 0; k < nu; k++) {
        e->speed[k] = sqrt(fabs(f[k] - f0[k]) * e->place);
        e->share[k] = e->speed[k] / e->place;
        most = fmax(most, e->share[k]);
        r->stage[nq + k] += e->speed[k];
    }
    if (ct_run_rhs(r, t, r->stage, r->dy) != CT_EVAL_OK)
        return false;
    for (size_t k = 0; k < nu; k++) {
        const double omega = e->share[k], damping = fabs(f[k] - f0[k]) / e->speed[k];
        e->share[k] = most > 0 ? omega / most : 0;
        e->speed[k] *= damping > omega ? omega / damping : 1;
    }
    return true;
}

// What is damped forgets the roundings of steps before 1/damping; each speed is changed alone, as what turns answers with the others,
// undamped. f (nu) at r->y is in r->scratch.
static bool remember(struct ct_run *r, double t, struct noise *e)
{
    const size_t nq = r->m->nq, nu = r->m->nu;
    const double steps = (double)r->report->followed;
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    for (size_t k = 0; k < nu; k++) {
        double remembered = steps;
        if (e->speed[k] > 0) {
            r->stage[nq + k] += e->speed[k];
            if (ct_run_rhs(r, t, r->stage, r->dy) != CT_EVAL_OK)
                return false;
            r->stage[nq + k] = r->y[nq + k];
            const double damping = (r->scratch[k] - r->dy[nq + k]) / e->speed[k];
            remembered /= fmax(1, damping * t);
        }
        e->sum[k] = sqrt(fmax(remembered, 1));
    }
    return true;
}

// What outputs change by for a change of places, d (nu), and for one of speeds, u (nu): in roundings, of their largest values.
static bool feel(struct ct_run *r, double t, const double *d, const double *u, const double *at,
                 double *part)
{
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    if (d)
        ct_machine_retract(r->m, r->stage, d);
    for (size_t k = 0; u && k < r->m->nu; k++)
        r->stage[r->m->nq + k] += u[k];
    if (ct_run_results(r, t, r->stage, r->value) != CT_EVAL_OK)
        return false;
    for (size_t i = 0; i < r->e->nresult; i++)
        part[i] = fabs(r->value[i] - at[i]) / roundings / r->largest[i];
    return true;
}

// Sums of roundings, (8.18), that results feel as parts of their largest values (nresult, out).
static bool find_felt(struct ct_run *r, double t, const struct noise *e, const double *at,
                      double *felt)
{
    const size_t nu = r->m->nu, n = r->e->nresult;
    double *d = CT_NEWN(r->arena, double, nu + 1), *u = CT_NEWN(r->arena, double, nu + 1),
           *speeds = CT_NEWN(r->arena, double, n + 1);
    for (size_t k = 0; k < nu; k++) {
        d[k] = e->place * e->share[k] * e->sum[k];
        u[k] = e->speed[k] * e->share[k] * e->sum[k];
    }
    if (!feel(r, t, d, NULL, at, felt) || !feel(r, t, NULL, u, at, speeds))
        return false;
    for (size_t i = 0; i < n; i++)
        felt[i] = hypot(felt[i], speeds[i]);
    return true;
}

// The one of the results that feels most, more than *most (in, out); -1: none. One that is nothing but rounding is zero.
static int find_worst(const struct ct_run *r, const double *felt, double *most)
{
    int worst = -1;
    for (size_t i = 0; i < r->e->nresult; i++)
        if (felt[i] > *most && felt[i] < 1 && !ct_fidelity_is_demanding(r->e, i)) {
            *most = felt[i];
            worst = (int)i;
        }
    return worst;
}

// Where no single rounding is too much, those of all steps may be. First as if nothing damped them, which costs little.
static void add_up(struct ct_run *r, double t, struct noise *e, const double *at, double wanted,
                   struct ct_blunt *b)
{
    const double steps = (double)r->report->followed;
    double *felt = CT_NEWN(r->arena, double, r->e->nresult + 1), most = wanted;
    for (size_t k = 0; k < r->m->nu; k++)
        e->sum[k] = sqrt(steps);
    if (!find_felt(r, t, e, at, felt) || (b->output < 0 && find_worst(r, felt, &most) < 0)
        || !remember(r, r->report->stats.last_time, e) || !find_felt(r, t, e, at, felt))
        return;
    most = wanted;
    if (b->output < 0) {
        b->output = find_worst(r, felt, &most);
        b->one = most / sqrt(steps);
    }
    if (b->output >= 0 && felt[b->output] > b->one)
        b->sum = felt[b->output];
}

struct ct_blunt ct_run_find_blunt(struct ct_run *r, double held, double wanted)
{
    const double time = r->report->stats.last_time, t = ct_run_before(r, time);
    const size_t nu = r->m->nu, n = r->e->nresult;
    struct noise e = {CT_NEWN(r->arena, double, nu + 1), CT_NEWN(r->arena, double, nu + 1),
                      CT_NEWN(r->arena, double, nu + 1), 0};
    double *at = CT_NEWN(r->arena, double, n + 1), *felt = CT_NEWN(r->arena, double, n + 1);
    struct ct_blunt b = {.output = -1, .one = held / most_precise, .sum = NAN};
    if (r->fidelity)
        b.output = ct_fidelity_blunt(r->fidelity, t, r->y, held, &b.one);
    if (!find_noise(r, time, &e) || ct_run_results(r, t, r->y, at) != CT_EVAL_OK
        || !feel(r, t, NULL, e.speed, at, felt))
        return b;
    const int slow = find_worst(r, felt, &b.one);
    b.output = slow >= 0 ? slow : b.output;
    if (r->report->followed > 0)
        add_up(r, t, &e, at, wanted, &b);
    return b;
}
