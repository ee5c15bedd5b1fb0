// See input_sampling.h.
#include "solve/evaluator/input_sampling.h"

#include "solve/evaluator/switch_state.h"

#include <math.h>

// Times in a step near which methods have stages, those of order 2 the first one only: dop853,
// dopri5 and radau5 leave no wider gaps.
static const double stage_times[] = {1, 0.25, 0.65, 0.85};
// Bound for a polynomial of degree four: its largest distance from its initial value in the step,
// over that at these points. Methods resolve such a polynomial; a pulse that they miss exceeds it.
// Derived: 2.36, the Lebesgue constant of these points and the start.
static const double pulse_ratio = 2.4;

static void find_range(struct ct_input_sampling *c, size_t i)
{
    const double *v = c->value + i * (CT_INPUT_SAMPLES + 1);
    double least = v[0], most = v[0];
    for (size_t k = 1; k <= CT_INPUT_SAMPLES; k++) {
        least = fmin(least, v[k]);
        most = fmax(most, v[k]);
    }
    c->range[i] = most - least;
}

void ct_input_sampling_sample(struct ct_arena *a, struct ct_evaluator *m, double end,
                              struct ct_input_sampling *c)
{
    const size_t n = m->e->ntime_function, many = CT_INPUT_SAMPLES + 1;
    c->n = end > 0 ? n : 0;
    c->piece = end / CT_INPUT_SAMPLES;
    if (c->n == 0)
        return;
    if (!c->value) {
        c->value = CT_NEWN(a, double, n *many);
        c->range = CT_NEWN(a, double, n);
    }
    for (size_t k = 0; k < many; k++) {
        const double t = c->piece * (double)k;
        if (m->e->nswitch)
            ct_switches_of_time(m, t);
        m->input[0] = t;
        ct_program_run(&m->time_functions, m->input);
        for (size_t i = 0; i < n; i++)
            c->value[i * many + k] = m->time_functions.out[i];
    }
    m->input[0] = 0;
    for (size_t i = 0; i < n; i++)
        find_range(c, i);
}

// Linear interpolation between the values; `place` in pieces.
static double at(const double *value, double place)
{
    const double k = fmin(floor(place), CT_INPUT_SAMPLES - 1);
    const double *v = value + (size_t)k;
    return v[0] + (place - k) * (v[1] - v[0]);
}

// Does a step between these positions pass over a change? False if values are not finite.
static bool passes_over(const double *value, double from, double to, size_t nseen,
                        double negligible_change)
{
    const double start = at(value, from);
    double seen = 0, change = 0;
    for (size_t i = 0; i < nseen; i++)
        seen = fmax(seen, fabs(at(value, from + stage_times[i] * (to - from)) - start));
    for (size_t k = (size_t)from + 1; (double)k < to; k++)
        change = fmax(change, fabs(value[k] - start));
    return change > pulse_ratio * seen + negligible_change;
}

double ct_input_sampling_limit_step(const struct ct_input_sampling *c,
                                    const struct ct_method *method, double t, double h,
                                    double negligible_change)
{
    t = fmax(t,
             // steps from a singular start begin before t = 0, where there are no values
             0);
    const size_t nseen = method->order > 2 ? COUNT(stage_times) : 1;
    for (size_t i = 0; i < c->n; i++) {
        const double *value = c->value + i * (CT_INPUT_SAMPLES + 1);
        // shorter steps have as many stages as there are values
        while (h > COUNT(stage_times) * c->piece
               && passes_over(value, t / c->piece, fmin((t + h) / c->piece, CT_INPUT_SAMPLES),
                              nseen, negligible_change * c->range[i]))
            h /= 2;
    }
    return h;
}
