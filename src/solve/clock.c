// See clock.h.
#include "solve/clock.h"

#include "solve/mode.h"

#include <math.h>

// Times in a step near which methods have stages, those of order 2 the first one only: dop853, dopri5 and radau5 leave no
// wider gaps.
static const double seen_at[] = {1, 0.25, 0.65, 0.85};
// Between these a smooth change that they follow is hardly larger than at one of them; a pulse that they miss is.
static const double missed = 2;
// Steps of fewer pieces are as fine as what is known.
static const double fine = 4;

static void find_range(struct ct_clock *c, size_t i)
{
    const double *v = c->value + i * (CT_CLOCK_PIECES + 1);
    double least = v[0], most = v[0];
    for (size_t k = 1; k <= CT_CLOCK_PIECES; k++) {
        least = fmin(least, v[k]);
        most = fmax(most, v[k]);
    }
    c->range[i] = most - least;
}

void ct_clock_look(struct ct_arena *a, struct ct_machine *m, double end, struct ct_clock *c)
{
    const size_t n = m->e->nclock, many = CT_CLOCK_PIECES + 1;
    c->n = end > 0 ? n : 0;
    c->piece = end / CT_CLOCK_PIECES;
    if (c->n == 0)
        return;
    if (!c->value) {
        c->value = CT_NEWN(a, double, n *many);
        c->range = CT_NEWN(a, double, n);
    }
    for (size_t k = 0; k < many; k++) {
        const double t = c->piece * (double)k;
        if (m->e->nmode)
            ct_modes_of_time(m, t);
        m->input[0] = t;
        ct_program_run(&m->clock, m->input);
        for (size_t i = 0; i < n; i++)
            c->value[i * many + k] = m->clock.out[i];
    }
    m->input[0] = 0;
    for (size_t i = 0; i < n; i++)
        find_range(c, i);
}

// Between the values; place in pieces.
static double at(const double *value, double place)
{
    const double k = fmin(floor(place), CT_CLOCK_PIECES - 1);
    const double *v = value + (size_t)k;
    return v[0] + (place - k) * (v[1] - v[0]);
}

// Does a step over these places pass over a change? Of what is not finite nothing is known.
static bool passes_over(const double *value, double from, double to, size_t nseen,
                        double unfelt)
{
    const double start = at(value, from);
    double seen = 0, change = 0;
    for (size_t i = 0; i < nseen; i++)
        seen = fmax(seen, fabs(at(value, from + seen_at[i] * (to - from)) - start));
    for (size_t k = (size_t)from + 1; (double)k < to; k++)
        change = fmax(change, fabs(value[k] - start));
    return change > missed * seen + unfelt;
}

double ct_clock_fit(const struct ct_clock *c, const struct ct_method *method, double t,
                    double h, double unfelt)
{
    t = fmax(
        t,
        0); // a start in a singular position is led in to from before: nothing is known of that
    const size_t nseen = method->order > 2 ? COUNT(seen_at) : 1;
    for (size_t i = 0; i < c->n; i++) {
        const double *value = c->value + i * (CT_CLOCK_PIECES + 1);
        while (h > fine * c->piece
               && passes_over(value, t / c->piece, fmin((t + h) / c->piece, CT_CLOCK_PIECES),
                              nseen, unfelt * c->range[i]))
            h /= 2;
    }
    return h;
}
