// See step_control.h.
#include "integrate/step_control.h"
#include "integrate/stepper.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

// PI control of step sizes, as in the codes DOPRI5 and RADAU5 of Hairer and Wanner (1996), key
// hairer1996, IV.2 and IV.8: h_new = h safety error_before^beta / error^alpha.
//
// Safety factors. Explicit: over the reference problems an error is reached with 5 % fewer
// evaluations at 0.8 than at 0.9, as fewer steps are refused; implicit: that of RADAU5.
// Default: long steps against refused ones. Test: integrate.
static const double safety = 0.8, implicit_safety = 0.9;
// Derived: FAC1 of DOPRI5, the least factor from one step to the next.
static const double most_shrink = 0.2;
// The largest one, unless the method names its own.
// Default: steps that grow in time against refused ones. Test: integrate.
static const double most_growth = 5;
// Derived: FACOLD of DOPRI5, the least error that the controller remembers; smaller ones would make
// it shrink the next step.
static const double least_previous_error = 1e-4;

// Powers of errors need four digits: the exponent of a number and a polynomial of its mantissa take
// a tenth of the time of log and exp. Derived: the coefficients are those of least largest error.
enum { EXPONENT_AT = 52, BIAS = 1023 };

// log2(x), x >= 0 finite, to 2e-4, continuous; of zero -1023.
static double near_log2(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    const double exponent = (double)(int64_t)(bits >> EXPONENT_AT) - BIAS;
    bits = (bits & ((UINT64_C(1) << EXPONENT_AT) - 1)) | (uint64_t)BIAS << EXPONENT_AT;
    memcpy(&x, &bits, sizeof x); // 1 <= x < 2
    const double d = x - 1;
    return exponent + d * ((1.43895 + d * -0.67715) + d * d * (0.31821 + d * -0.08001));
}

// 2^x, |x| < 1000, to 1e-4.
static double near_exp2(double x)
{
    const int64_t whole = (int64_t)(x + BIAS + 0.5) - BIAS; // rounded: the sum is positive
    const double d = x - (double)whole;
    const uint64_t bits = (uint64_t)(whole + BIAS) << EXPONENT_AT;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power * ((1 + d * 0.693147) + d * d * (0.240227 + d * (0.055504 + d * 0.009618)));
}

struct ct_step_control ct_step_control_start(void)
{
    const double least = near_log2(least_previous_error);
    return (struct ct_step_control){.log_before = least, .log_least = least};
}

// A run ends early if the end would take `most_times_allowed` times the steps allowed, and steps do
// not grow any more: by less than the factor `least_growth` from one window to the next, each a
// thousandth of the steps allowed. Default: runs ended early against time lost on runs that cannot
// end. Test: failed_runs.
static const double most_times_allowed = 3, least_growth = 1.1;
// Default: how often that is asked. Test: failed_runs.
enum { WINDOWS = 1000 };

bool ct_step_control_exceeds_limit(struct ct_step_progress *p, long steps, long most, double t,
                                   double rest)
{
    const long window = most / WINDOWS;
    if (steps < p->next || window == 0)
        return false;
    const bool is_whole = p->next > 0;
    p->next = steps - steps % window + window;
    if (!is_whole)
        return false;
    const double before = p->gain;
    p->gain = t - p->t;
    p->t = t;
    const bool has_grown = !(before > 0 && p->gain <= least_growth * before);
    p->step = p->gain / (double)window;
    p->to_come = has_grown ? 0 : rest / p->step;
    return p->to_come > most_times_allowed * (double)most;
}

static double safety_of(const struct ct_method *m)
{
    return m->is_implicit ? implicit_safety : safety;
}

// Sets the parameters of the controller for method m.
static void set_method(struct ct_step_control *c, const struct ct_method *m)
{
    const double power = 1.0 / (m->error_order + 1);
    c->method = m;
    c->beta = 0.2 * power; // Derived: DOPRI5 has 0.04 = 0.2/5 and alpha = 1/5 - 0.75 beta
    c->alpha = power - 0.75 * c->beta;
    c->log_safety = log2(safety_of(m));
    for (int i = 0; i < 2; i++)
        c->log_kept_range[i] = m->kept_range[i] > 0 ? log2(m->kept_range[i]) : -INFINITY;
}

void ct_step_control_accept(struct ct_step_control *c, const struct ct_method *m, double h,
                            double error)
{
    if (c->method != m)
        set_method(c, m);
    c->is_starting = c->is_starting && error < least_previous_error;
    const double log_error = near_log2(error);
    // log2 of safety error_before^beta / error^alpha, the next step over this one, without limits
    const double power = c->log_safety + c->beta * c->log_before - c->alpha * log_error;
    c->log_before = ct_larger(log_error, c->log_least);
    if (power > c->log_kept_range[0] && power < c->log_kept_range[1]) {
        // no store where h stays the same: so the next step does not wait for the error of this one
        if (c->was_refused || h > c->h)
            c->h = h;
        c->was_refused = false;
        return;
    }
    const bool has_own_growth = m->most_growth > 0 && !c->is_starting;
    const double growth = has_own_growth ? m->most_growth : most_growth;
    const double factor = ct_smaller(ct_larger(near_exp2(power), most_shrink), growth);
    if (c->was_refused) // after a refusal the step may not grow
        c->h = ct_smaller(factor, 1) * h;
    else // a step that is not c->h was cut for a stop, not for its error
        c->h = h < c->h ? ct_larger(factor * h, c->h) : factor * h;
    c->was_refused = false;
}

void ct_step_control_refuse(struct ct_step_control *c, const struct ct_method *m, double h,
                            double error)
{
    const double alpha = 1.0 / (m->error_order + 1);
    c->h = error > 1 ? h * fmax(most_shrink, safety_of(m) * pow(error, -alpha)) : h / 2;
    c->was_refused = true;
}

// Derived: the numbers here and in ct_step_control_first are those of the starting step size of
// Hairer, Norsett and Wanner (1993), key hairer1993, II.4; a hundredth of the tolerance in
// ct_step_control_first_at_rate is the same aim.
double ct_step_control_euler_step(double d0, double d1, double limit)
{
    const double small = 1e-5, least = 1e-6; // Derived: II.4, see above
    return fmin(d0 < small || d1 < small ? least : 0.01 * d0 / d1, limit);
}

double ct_step_control_first(const struct ct_method *m, double h, double d1, double d2,
                             double limit)
{
    const double d = fmax(d1, d2);
    const double small = 1e-15, least = 1e-6, part = 1e-3; // Derived: II.4, see above
    const double by_error
        = d <= small ? fmax(least, part * h) : pow(0.01 / d, 1.0 / (m->error_order + 1));
    return fmin(fmin(100 * h, by_error), limit);
}

double ct_step_control_first_at_rate(const struct ct_method *m, double rate, double rtol)
{
    const double part = 0.01; // Derived: as in ct_step_control_first
    double term = part * rtol;
    for (int i = 2; i <= m->error_order + 1; i++)
        term *= i;
    return pow(term, 1.0 / (m->error_order + 1)) / rate;
}
