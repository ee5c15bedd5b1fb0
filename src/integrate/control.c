// See control.h.
#include "integrate/control.h"

#include <float.h>
#include <math.h>

// Steps aim at this part of what the error would allow. Over the reference problems explicit methods reach an error with
// 5 % fewer evaluations at 0.8 than at 0.9: fewer steps are made in vain.
static const double safety = 0.8, implicit_safety = 0.9;
static const double most_shrink = 0.2; // an error estimate is not trusted further than this
static const double most_growth
    = 5; // nor this, nor what a method says once it has found its pace
static const double remembered_error
    = 1e-4;                        // least error the controller remembers: smaller ones
                                   // are luck and would make it shrink the next step
static const double stretch = 1.1; // a step may be this much longer to end on a stop: no crumbs

// A step must change t by more than its rounding: 16 * eps leaves room for the stage times. Near
// t = 0 the scale is a millionth of the run, below which no motion of interest begins.
static const double least_step = 16 * DBL_EPSILON, least_scale = 1e-6;

struct ct_control ct_control_start(void)
{
    return (struct ct_control){.log_before = log(remembered_error)};
}

double ct_control_fit(double rest, double wanted)
{
    if (rest <= stretch * wanted)
        return rest;
    return rest < 2 * wanted ? rest / 2 : wanted;
}

bool ct_control_is_lost(double h, double t, double run)
{
    return h <= least_step * fmax(fabs(t), least_scale * run);
}

// Runs whose steps have stopped to grow are not begun in earnest if they would take so many times the steps allowed.
static const double endless = 3, growing = 1.1;
enum { WINDOWS = 1000 };

bool ct_control_is_endless(struct ct_pace *p, long steps, long most, double t, double rest)
{
    const long window = most / WINDOWS;
    if (window == 0 || steps % window != 0)
        return false;
    const double before = p->gain;
    p->gain = t - p->t;
    p->t = t;
    return before > 0 && p->gain <= growing * before
        && rest / p->gain * (double)window > endless * (double)most;
}

static double safety_of(const struct ct_method *m)
{
    return m->is_implicit ? implicit_safety : safety;
}

// What the error says about the next step: h / factor, without limits. error^alpha / error_before^beta by logarithms.
static double pi_factor(const struct ct_control *c, const struct ct_method *m, double log_error)
{
    const double beta = 0.2 / (m->error_order + 1);
    const double alpha = 1.0 / (m->error_order + 1) - 0.75 * beta;
    return exp(alpha * log_error - beta * c->log_before) / safety_of(m);
}

void ct_control_accept(struct ct_control *c, const struct ct_method *m, double h, double error)
{
    c->is_starting = c->is_starting && error < remembered_error;
    const bool has_own = m->most_growth > 0 && !c->is_starting;
    const double growth = has_own ? m->most_growth : most_growth;
    const double log_error = log(error);
    const double factor = fmin(fmax(pi_factor(c, m, log_error), 1 / growth), 1 / most_shrink);
    double next = h / factor;
    if (next > m->steady[0] * h && next < m->steady[1] * h)
        next = h;
    if (c->was_refused)
        next = fmin(next, h); // not at once back to what has just failed
    else if (h < c->h)
        next = fmax(next, c->h); // the step was cut for a stop, not for its error
    c->h = next;
    c->log_before = error > remembered_error ? log_error : log(remembered_error);
    c->was_refused = false;
}

void ct_control_refuse(struct ct_control *c, const struct ct_method *m, double h, double error)
{
    const double alpha = 1.0 / (m->error_order + 1);
    c->h = error > 1 ? h * fmax(most_shrink, safety_of(m) * pow(error, -alpha)) : h / 2;
    c->was_refused = true;
}

double ct_control_glance(double d0, double d1, double limit)
{
    return fmin(d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * d0 / d1, limit);
}

double ct_control_first(const struct ct_method *m, double h, double d1, double d2, double limit)
{
    const double d = fmax(d1, d2);
    const double by_error
        = d <= 1e-15 ? fmax(1e-6, 1e-3 * h) : pow(0.01 / d, 1.0 / (m->error_order + 1));
    return fmin(fmin(100 * h, by_error), limit);
}
