// See amplifier.h.
#include "solve/amplifier.h"

#include "integrate/stepper.h"

#include <float.h>
#include <math.h>
#include <string.h>

// What is promised of outputs, in tolerances.
static const double promised = 10;
// States are changed by such parts of themselves: far above rounding, and so little that outputs are linear in it.
static const double change = 0x1p-40;
// An output need not be better than so many roundings of states.
static const double most_precise = 2;
enum { CALLS_BETWEEN = 7 };

struct ct_amplifier {
    struct ct_machine *m;
    struct ct_program *program;
    size_t n, ny;
    double *at, *largest,
        *way;  // (n) g; |g| over the looks so far; change of g for states changed by themselves
    bool *has; // (n)
    double *y; // (ny) to spare
    int skip;  // calls that do not look
};

struct ct_amplifier *ct_amplifier_create(struct ct_arena *a, struct ct_machine *m,
                                         struct ct_program *program, size_t n)
{
    struct ct_amplifier *p = CT_NEW(a, struct ct_amplifier);
    *p = (struct ct_amplifier){.m = m, .program = program, .n = n, .ny = m->nq + m->nu + 1};
    double **const vectors[] = {&p->at, &p->largest, &p->way};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, n);
    p->has = CT_NEWN(a, bool, n);
    p->y = CT_NEWN(a, double, p->ny);
    return p;
}

void ct_amplifier_start(struct ct_amplifier *p)
{
    memset(p->largest, 0, p->n * sizeof *p->largest);
    memset(p->has, 0, p->n * sizeof *p->has);
    p->skip = 0;
}

bool ct_amplifier_has(const struct ct_amplifier *p, size_t i)
{
    return p->has[i];
}

// g at p->y.
static const double *evaluate(struct ct_amplifier *p, double t)
{
    ct_machine_set(p->m, t, p->y);
    ct_program_run(p->program, p->m->input);
    return p->program->out;
}

// 1 to 2, in no simple relation.
static double part(size_t i)
{
    const double x = 0.618033988749895 * (double)i;
    return 1 + (x - (double)(size_t)x);
}

// Which outputs amplify at y? All states are changed by different parts of themselves, so that nothing cancels.
static bool find(struct ct_amplifier *p, double t, const double *y,
                 const struct ct_tolerance *tolerance)
{
    bool any = false;
    ct_machine_copy(p->y, y, p->ny);
    memcpy(p->at, evaluate(p, t), p->n * sizeof *p->at);
    for (size_t i = 0; i < p->ny; i++)
        p->y[i] += change * part(i) * y[i];
    const double *off = evaluate(p, t);
    for (size_t i = 0; i < p->n; i++) {
        p->way[i] = fabs(off[i] - p->at[i]) / change;
        p->largest[i] = ct_larger(p->largest[i], fabs(p->at[i]));
        const double wanted = tolerance->rtol * p->largest[i] + tolerance->atol;
        p->has[i] = tolerance->rtol * p->way[i] > promised * wanted;
        any |= p->has[i];
    }
    return any;
}

bool ct_amplifier_any(struct ct_amplifier *p, double t, const double *y,
                      const struct ct_tolerance *tolerance)
{
    const bool any = find(p, t, y, tolerance);
    ct_amplifier_start(p);
    return any;
}

int ct_amplifier_blunt(struct ct_amplifier *p, double t, const double *y, const double *largest,
                       double wanted, double *part)
{
    const struct ct_tolerance tolerance = {wanted, 0};
    int blunt = -1;
    find(p, t, y, &tolerance);
    *part = wanted / most_precise;
    for (size_t i = 0; i < p->n; i++) {
        const double size = ct_larger(largest[i], p->largest[i]),
                     rounding = DBL_EPSILON * p->way[i];
        // a residual is nothing but rounding
        if (p->has[i] && rounding < size && rounding > *part * size) {
            *part = rounding / size;
            blunt = (int)i;
        }
    }
    return blunt;
}

double ct_amplifier_error(struct ct_amplifier *p, double t, const double *y, const double *e,
                          const struct ct_tolerance *tolerance)
{
    double sum = 0;
    size_t n = 0;
    if (p->skip-- > 0)
        return 0;
    p->skip = 0;
    if (!find(p, t, y, tolerance)) {
        p->skip = CALLS_BETWEEN;
        return 0;
    }
    for (size_t i = 0; i < p->ny; i++)
        p->y[i] = y[i] + e[i];
    const double *off = evaluate(p, t);
    for (size_t i = 0; i < p->n; i++) {
        if (!p->has[i])
            continue;
        const double wanted = tolerance->rtol * p->largest[i] + tolerance->atol;
        const double rounding = DBL_EPSILON * p->way[i];
        const double part = (off[i] - p->at[i]) / ct_larger(most_precise * rounding, wanted);
        sum += part * part;
        n++;
    }
    return isfinite(sum) ? ct_larger(sqrt(sum / (double)n), DBL_MIN) : INFINITY;
}
