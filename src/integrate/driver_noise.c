// See driver.h: rounding in f.
//
// Stiff forces answer a rounding of places by accelerations: eps omega^2 |q|, where a step errs by h times as much, however short
// it is. Control that takes this for an error of its order shortens steps a hundredfold in vain. So f is asked now and then what it
// makes of a change of places far above rounding.
#include "integrate/driver.h"

#include <float.h>
#include <math.h>

// Places are changed by this part of the largest of them, and what f changes by is taken for that of a rounding.
static const double change = 0x1p-40;
// The first look is after so many steps, before anybody asks whether the method is held up; then they cost a thousandth of an
// evaluation a step.
enum { FIRST_STEPS = 100, STEPS_BETWEEN = 1000 };

static void measure(struct ct_driver *r)
{
    const struct ct_problem *p = r->p;
    const double golden = 0.618033988749895;
    double largest = 0;
    r->unmeasured = 0;
    for (int i = 0; i < p->nq; i++)
        largest = fmax(largest, fabs(r->y[i]));
    for (int i = 0; i < p->ny; i++) // all by different parts, so that nothing cancels
        r->point[i] = r->y[i] + (i < p->nq ? change * (1 + fmod(golden * i, 1)) * largest : 0);
    if (!(largest > 0) || ct_stepper_rhs(p, r->t, r->point, r->noise, r->stats) != CT_EVAL_OK)
        return;
    for (int i = 0; i < p->ny; i++)
        r->noise[i] = i < p->nq ? 0 : fabs(r->noise[i] - r->dy[i]) * (DBL_EPSILON / change);
    r->problem.noise = r->noise;
}

void ct_driver_note_step(struct ct_driver *r)
{
    const int wanted = r->problem.noise ? STEPS_BETWEEN : FIRST_STEPS;
    if (!r->method->is_implicit && r->o->step == 0 && ++r->unmeasured >= wanted)
        measure(r);
}
