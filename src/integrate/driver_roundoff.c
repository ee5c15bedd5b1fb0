// Round-off errors in f, which step size control must not take for truncation errors; see driver.h.
//
// A stiff force of frequency omega turns the round-off of positions into an acceleration error of
// eps omega^2 |q|. It adds h times as much to the error of a step, however short the step is. Step
// size control that assumes the order of the method would shorten steps a hundredfold in vain.
//
// Round-off is suspected where a refused step is repeated with a shorter one and the error falls
// more slowly than any truncation error would. Then positions are changed by far more than
// round-off and the change of f is measured. Scaled down to round-off, it is subtracted from error
// estimates as long as steps stay as short.
#include "integrate/driver.h"
#include "numeric/roundoff.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Derived: truncation errors of methods of order 4 or more fall with the fifth power of the step or
// faster, those of round-off with the first one, and 3 lies between. This holds for steps shorter
// than 1 over the fastest frequency; longer ones are held by stability, and their errors have no
// order.
static const double order_between = 3;
// Round-off is measured after each of so many steps, too, since it may keep steps short without a
// refusal. Default: round-off found late against seven evaluations. Test: far_from_origin.
enum { STEPS_BETWEEN = 1000 };

// dy (ny, out) = f where position i is changed by `part` times a factor in [1, 2). The factors
// differ between positions and with k.
static enum ct_eval perturb_positions(struct ct_driver *r, double part, int k, double *dy)
{
    const struct ct_problem *p = r->p;
    for (int i = 0; i < p->ny; i++)
        r->point[i] = r->y[i] + (i < p->nq ? part * ct_perturbation_part((size_t)(i + k)) : 0);
    return ct_stepper_rhs(p, r->t, r->point, dy, r->stats);
}

// Round-off from the arithmetic of f itself, as with a nearly singular mass matrix. Positions are
// changed in both directions, so that the linear part of f cancels. The largest of several
// measurements counts, as a single one may be zero by chance.
static void find_arithmetic_roundoff(struct ct_driver *r, double part)
{
    // Default: evaluations against a round-off that is missed by chance. Test: far_from_origin
    enum { MEASUREMENTS = 3 };
    const struct ct_problem *p = r->p;
    memset(r->arithmetic_roundoff, 0, (size_t)p->ny * sizeof *r->arithmetic_roundoff);
    for (int k = 0; k < MEASUREMENTS; k++) {
        if (perturb_positions(r, part, k, r->dmoved) != CT_EVAL_OK
            || perturb_positions(r, -part, k, r->dpoint) != CT_EVAL_OK)
            return;
        for (int i = p->nq; i < p->nq + p->nu; i++)
            r->arithmetic_roundoff[i]
                = fmax(r->arithmetic_roundoff[i],
                       fabs(r->dmoved[i] - r->dy[i] + (r->dpoint[i] - r->dy[i])) / 2);
    }
}

static void measure_roundoff(struct ct_driver *r, double h)
{
    const struct ct_problem *p = r->p;
    r->problem.roundoff = NULL;
    r->roundoff_steps = 0;
    double largest = 0, most = 0;
    for (int i = 0; i < p->nq; i++)
        largest = fmax(largest, fabs(r->y[i]));
    if (!(largest > 0)
        || perturb_positions(r, CT_PERTURBATION * largest, 0, r->roundoff) != CT_EVAL_OK)
        return;
    for (int i = 0; i < p->ny; i++) {
        const bool is_speed = i >= p->nq && i < p->nq + p->nu;
        const double response = is_speed ? fabs(r->roundoff[i] - r->dy[i]) : 0;
        most = fmax(most, response);
        r->roundoff[i] = response;
    }
    r->problem.roundoff_step = sqrt(CT_PERTURBATION * largest / most);
    if (h > r->problem.roundoff_step)
        return;
    find_arithmetic_roundoff(r, CT_PERTURBATION * largest);
    for (int i = p->nq; i < p->nq + p->nu; i++)
        r->roundoff[i] = r->roundoff[i] > 0
                           ? fmax(r->roundoff[i] * DBL_EPSILON / CT_PERTURBATION,
                                  r->arithmetic_roundoff[i])
                           : 0;
    r->problem.roundoff = r->roundoff;
}

// Does the error of this step, after a longer one was refused at the same state, indicate
// round-off?
static bool shows_roundoff(const struct ct_driver *r, double h, double error)
{
    const struct ct_refusal *last = &r->refusal;
    return !r->method->is_implicit && !r->problem.roundoff && last->error > 1 && h < last->h
        && error > last->error * pow(h / last->h, order_between);
}

bool ct_driver_is_roundoff(struct ct_driver *r, double h, double error)
{
    const bool shows = shows_roundoff(r, h, error);
    r->refusal.longest = fmax(h, r->refusal.longest);
    r->refusal.h = h;
    r->refusal.error = error;
    if (shows)
        measure_roundoff(r, h);
    return shows && r->problem.roundoff;
}

void ct_driver_note_step(struct ct_driver *r, double h, double error)
{
    const bool is_controlled = r->o->step == 0 && !r->method->is_implicit;
    if ((is_controlled && ++r->roundoff_steps == STEPS_BETWEEN) || shows_roundoff(r, h, error))
        measure_roundoff(r, h);
    r->refusal = (struct ct_refusal){0};
}
