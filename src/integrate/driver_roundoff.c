// See driver.h: round-off in f.
//
// Stiff forces answer a round-off of places by accelerations: eps omega^2 |q|, where a step errs by
// h times as much, however short it is. Control that takes this for an error of its order shortens
// steps a hundredfold in vain. Round-off shows where a step that was refused and then shortened
// errs by more than any truncation would: then f is asked what it makes of a change of places far
// above round-off, and that is no error as long as steps are as short.
#include "integrate/driver.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Places are changed by this part of the largest of them, and what f changes by is taken for that
// of a round-off.
static const double change = 0x1p-40;
// Derived: truncation errors of methods of order 4 or more fall with the fifth power of the step or
// faster, those of round-off with the first one, and 3 lies between. This holds for steps shorter
// than 1 over the fastest frequency; longer ones are held by stability, and their errors have no
// order.
static const double between = 3;
// Positions are changed by different parts, so that nothing cancels. Derived: multiples of the
// golden section are spread most evenly.
static const double golden = 0.618033988749895;
// After so many steps it is measured anew, or for the first time, as steps that round-off keeps
// short may not be refused: as many thousandths of an evaluation a step as there are speeds.
enum { STEPS_BETWEEN = 1000 };

// What is damped forgets errors of steps, whatever makes them, but for the last ones: there they
// count. A vibration of omega answers a change of speeds by omega times one of places with 2 zeta
// of the answer to that. Each speed is changed alone: what turns answers with the others, undamped.
// du: the change.
static void leave_out_damped(struct ct_driver *r, double du)
{
    const struct ct_problem *p = r->p;
    const double damped = 0.02; // zeta of 0.01: half is left after 11 periods
    ct_stepper_copy(r->point, r->y, p->ny);
    for (int i = p->nq; i < p->nq + p->nu; i++) {
        r->point[i] += du;
        const enum ct_eval e = ct_stepper_rhs(p, r->t, r->point, r->dmoved, r->stats);
        r->point[i] = r->y[i];
        if (e == CT_EVAL_OK && r->dy[i] - r->dmoved[i] > damped * r->roundoff[i])
            r->roundoff[i] = 0;
    }
}

// Places by `part` of the largest, each by a share of its own in [1, 2): by another one with each
// k.
static enum ct_eval move_places(struct ct_driver *r, double part, int k, double *dy)
{
    const struct ct_problem *p = r->p;
    for (int i = 0; i < p->ny; i++)
        r->point[i] = r->y[i] + (i < p->nq ? part * (1 + fmod(golden * (i + k), 1)) : 0);
    return ct_stepper_rhs(p, r->t, r->point, dy, r->stats);
}

// What the arithmetic of f leaves by itself, as where a mass matrix is next to singular: with
// places changed to both sides what is linear in them cancels. The largest of a few looks, as one
// may be zero by chance.
static void find_arithmetic_roundoff(struct ct_driver *r, double part)
{
    enum { LOOKS = 3 };
    const struct ct_problem *p = r->p;
    memset(r->arithmetic_roundoff, 0, (size_t)p->ny * sizeof *r->arithmetic_roundoff);
    for (int k = 0; k < LOOKS; k++) {
        if (move_places(r, part, k, r->dmoved) != CT_EVAL_OK
            || move_places(r, -part, k, r->other) != CT_EVAL_OK)
            return;
        for (int i = p->nq; i < p->nq + p->nu; i++)
            r->arithmetic_roundoff[i]
                = fmax(r->arithmetic_roundoff[i],
                       fabs(r->dmoved[i] - r->dy[i] + (r->other[i] - r->dy[i])) / 2);
    }
}

static void measure(struct ct_driver *r, double h)
{
    const struct ct_problem *p = r->p;
    r->problem.roundoff = NULL;
    r->roundoff_steps = 0;
    double largest = 0, most = 0;
    for (int i = 0; i < p->nq; i++)
        largest = fmax(largest, fabs(r->y[i]));
    if (!(largest > 0) || move_places(r, change * largest, 0, r->roundoff) != CT_EVAL_OK)
        return;
    for (int i = 0; i < p->ny; i++) {
        const bool is_speed = i >= p->nq && i < p->nq + p->nu;
        const double answer = is_speed ? fabs(r->roundoff[i] - r->dy[i]) : 0;
        most = fmax(most, answer);
        r->roundoff[i] = answer;
    }
    r->problem.roundoff_step = sqrt(change * largest / most);
    if (h > r->problem.roundoff_step)
        return;
    leave_out_damped(r, change * largest / r->problem.roundoff_step);
    find_arithmetic_roundoff(r, change * largest);
    for (int i = p->nq; i < p->nq + p->nu; i++)
        r->roundoff[i] = r->roundoff[i] > 0 ? fmax(r->roundoff[i] * DBL_EPSILON / change,
                                                   r->arithmetic_roundoff[i])
                                            : 0;
    r->problem.roundoff = r->roundoff;
}

// A step of this length and error, after one that was refused at the same place.
static bool shows_roundoff(const struct ct_driver *r, double h, double error)
{
    const struct ct_refusal *last = &r->refusal;
    return !r->method->is_implicit && !r->problem.roundoff && last->error > 1 && h < last->h
        && error > last->error * pow(h / last->h, between);
}

bool ct_driver_is_roundoff(struct ct_driver *r, double h, double error)
{
    const bool shows = shows_roundoff(r, h, error);
    r->refusal.longest = fmax(h, r->refusal.longest);
    r->refusal.h = h;
    r->refusal.error = error;
    if (shows)
        measure(r, h);
    return shows && r->problem.roundoff;
}

void ct_driver_note_step(struct ct_driver *r, double h, double error)
{
    const bool is_held = r->o->step == 0 && !r->method->is_implicit;
    if ((is_held && ++r->roundoff_steps == STEPS_BETWEEN) || shows_roundoff(r, h, error))
        measure(r, h);
    r->refusal = (struct ct_refusal){0};
}
