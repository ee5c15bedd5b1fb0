// Outputs with fewer digits than are asked for, whatever the steps: looked for at the end of a run.
//
// Some are functions of states that amplify their rounding (amplifier.h). Others feel it through the motion: stiff forces answer a
// rounding of places, eps q, by accelerations eps |f'(q) q|, and a speed keeps of that what its damping and its vibration leave,
//
//     eps |f'(q) q| / max(omega, |f'(u)|),   omega^2 = |f'(q) q|/|q|                                  (8.15)
//
// A body on a stiff damped spring that creeps along has as few digits in its speed as the spring in its force.
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

// noise (nu, out) of speeds, in so many roundings.
static bool find_noise(struct ct_run *r, double t, double *noise)
{
    const size_t nq = r->m->nq, nu = r->m->nu;
    const double *f = r->dy + nq;
    double *f0 = r->scratch, largest = 0;
    if (ct_run_rhs(r, t, r->y, r->dy) != CT_EVAL_OK)
        return false;
    memcpy(f0, f, nu * sizeof *f);
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    for (size_t i = 0; i < nq; i++) {
        const double change = roundings * DBL_EPSILON / 2 * part_of(i) * fabs(r->y[i]);
        largest = fmax(largest, change);
        r->stage[i] += change;
    }
    if (!(largest > 0) || ct_run_rhs(r, t, r->stage, r->dy) != CT_EVAL_OK)
        return false;
    for (size_t k = 0; k < nu; k++)
        noise[k] = sqrt(fabs(f[k] - f0[k]) * largest);
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    for (size_t k = 0; k < nu; k++)
        r->stage[nq + k] += noise[k];
    if (ct_run_rhs(r, t, r->stage, r->dy) != CT_EVAL_OK)
        return false;
    for (size_t k = 0; k < nu;
         k++) { // noise is omega times places, and less where damping is more than omega
        const double omega = noise[k] / largest, damping = fabs(f[k] - f0[k]) / noise[k];
        noise[k] *= damping > omega ? omega / damping : 1;
    }
    return true;
}

int ct_run_find_blunt(struct ct_run *r, double wanted, double *part)
{
    const double time = r->report->stats.last_time, t = ct_run_before(r, time);
    double *noise = CT_NEWN(r->arena, double, r->m->nu + 1),
           *at = CT_NEWN(r->arena, double, r->e->nresult + 1);
    int blunt = -1;
    *part = wanted / most_precise;
    if (r->fidelity)
        blunt = ct_fidelity_blunt(r->fidelity, t, r->y, wanted, part);
    if (!find_noise(r, time, noise) || ct_run_results(r, t, r->y, at) != CT_EVAL_OK)
        return blunt;
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    for (size_t k = 0; k < r->m->nu; k++)
        r->stage[r->m->nq + k] += noise[k];
    if (ct_run_results(r, t, r->stage, r->value) != CT_EVAL_OK)
        return blunt;
    for (size_t i = 0; i < r->e->nresult; i++) {
        const double rounding = fabs(r->value[i] - at[i]) / roundings;
        // one that is nothing but rounding is zero
        if (!ct_fidelity_is_demanding(r->e, i) && rounding < r->largest[i]
            && rounding > *part * r->largest[i]) {
            *part = rounding / r->largest[i];
            blunt = (int)i;
        }
    }
    return blunt;
}
