// See output_sensitivity.h.
#include "solve/output_error/output_sensitivity.h"

#include "integrate/stepper.h"
#include "numeric/roundoff.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Calls without a test after one that found no sensitive output. Chosen: time against a late start.
enum { CALLS_BETWEEN = 7 };
// Derivatives of outputs change slowly. Those of accelerations are used at so many further states.
// Chosen: as above.
static const int states_between[CT_OUTPUT_KINDS] = {0, 7};

struct ct_output_sensitivity {
    struct ct_controlled_outputs *outputs;
    struct ct_constrained_output *constrained;
    struct ct_constrained_output_record *record;
    size_t n, ny;
    double *at, *largest,
        *way, // (n) g; |g| over the looks so far; change of g for states changed by themselves
        // (n) and, of solutions, by what their tolerance takes for small; else the same place
        *reach;
    bool *has;            // (n)
    double *y;            // (ny) to spare
    double t_seen, *seen; // the place of `at`, (ny)
    int skip;             // calls that do not look
    int between;          // places at which `way` is that of before
};

struct ct_output_sensitivity *
ct_output_sensitivity_create(struct ct_arena *a, struct ct_controlled_outputs *outputs,
                             struct ct_constrained_output *constrained_output,
                             struct ct_constrained_output_record *record)
{
    const struct ct_evaluator *m = outputs->s->m;
    const size_t n = outputs->n;
    struct ct_output_sensitivity *p = CT_NEW(a, struct ct_output_sensitivity);
    *p = (struct ct_output_sensitivity){.outputs = outputs,
                                        .constrained = constrained_output,
                                        .record = record,
                                        .n = n,
                                        .ny = m->nq + m->nu + 1};
    double **const vectors[] = {&p->at, &p->largest, &p->way};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, n);
    p->reach = outputs->kind == CT_OUTPUTS_OF_SOLUTIONS ? CT_NEWN(a, double, n) : p->way;
    p->has = CT_NEWN(a, bool, n);
    p->y = CT_NEWN(a, double, p->ny);
    p->seen = CT_NEWN(a, double, p->ny);
    p->t_seen = NAN;
    return p;
}

void ct_output_sensitivity_start(struct ct_output_sensitivity *p)
{
    memset(p->largest, 0, p->n * sizeof *p->largest);
    memset(p->has, 0, p->n * sizeof *p->has);
    p->skip = p->between = 0;
    p->t_seen = NAN;
}

bool ct_output_sensitivity_is_sensitive(const struct ct_output_sensitivity *p, size_t i)
{
    return p->has[i];
}

// What outputs change by, over CT_PERTURBATION, where states are changed by it in different parts of
// themselves, so that nothing cancels; of themselves and of `small`.
static void find_way(struct ct_output_sensitivity *p, double t, const double *y, double small,
                     double *way)
{
    for (size_t i = 0; i < p->ny; i++)
        p->y[i]
            = y[i] + CT_PERTURBATION * ct_perturbation_part(i) * (y[i] + copysign(small, y[i]));
    const double *off = ct_controlled_outputs_at(p->outputs, t, p->y);
    for (size_t i = 0; i < p->n; i++)
        way[i] = fabs(off[i] - p->at[i]) / CT_PERTURBATION;
}

// Fills `at`, `largest`, `way`, `reach` at y.
static void look(struct ct_output_sensitivity *p, double t, const double *y,
                 const struct ct_tolerance *tolerance)
{
    const bool is_solved = p->outputs->kind == CT_OUTPUTS_OF_SOLUTIONS;
    memcpy(p->at, ct_controlled_outputs_at(p->outputs, t, y), p->n * sizeof *p->at);
    for (size_t i = 0; i < p->n; i++)
        p->largest[i] = ct_larger(fabs(p->at[i]), p->largest[i]);
    p->t_seen = t;
    ct_evaluator_copy(p->seen, y, p->ny);
    if (p->between-- > 0)
        return;
    p->between = states_between[p->outputs->kind];
    find_way(p, t, y, 0, p->way);
    if (is_solved && tolerance->rtol > 0)
        find_way(p, t, y, tolerance->atol / tolerance->rtol, p->reach);
}

// Without those that constraints determine, as far as that is known.
static bool find_known(struct ct_output_sensitivity *p, const double *way,
                       const struct ct_tolerance *tolerance, bool *is_new)
{
    bool any = *is_new = false;
    for (size_t i = 0; i < p->n; i++) {
        const double wanted = tolerance->rtol * p->largest[i] + tolerance->atol;
        const bool amplifies = tolerance->rtol * way[i] > CT_PROMISED_ERROR * wanted;
        p->has[i] = amplifies && !p->record->is_found[i];
        any |= p->has[i];
        *is_new |= amplifies && !p->record->is_settled[i];
    }
    return any;
}

// Which outputs amplify at y, by `way` or `reach`?
static bool find(struct ct_output_sensitivity *p, double t, const double *y, const double *way,
                 const struct ct_tolerance *tolerance)
{
    bool is_new;
    if (t != p->t_seen || memcmp(y, p->seen, p->ny * sizeof *y) != 0)
        look(p, t, y, tolerance);
    const bool any = find_known(p, way, tolerance, &is_new);
    if (!is_new || !ct_constrained_output_find(p->constrained, p->record, t, y, tolerance))
        return any;
    return find_known(p, way, tolerance, &is_new);
}

static void note_sizes(struct ct_output_sensitivity *p, const double *largest)
{
    for (size_t i = 0; i < p->n; i++)
        p->largest[i] = ct_larger(largest[i], p->largest[i]);
}

bool ct_output_sensitivity_any(struct ct_output_sensitivity *p, double t, const double *y,
                               const struct ct_tolerance *tolerance)
{
    const bool any = find(p, t, y, p->way, tolerance);
    ct_output_sensitivity_start(p);
    return any;
}

int ct_output_sensitivity_roundoff_limit(struct ct_output_sensitivity *p, double t,
                                         const double *y, const double *largest, double wanted,
                                         double small, double *part)
{
    const struct ct_tolerance tolerance = {wanted, 0};
    int limited = -1;
    note_sizes(p, largest);
    find(p, t, y, p->way, &tolerance);
    *part = wanted / CT_FEWEST_ROUNDOFF_ERRORS;
    for (size_t i = 0; i < p->n; i++) {
        const double size = p->largest[i], roundoff = DBL_EPSILON * p->way[i];
        // a residual is nothing but round-off
        if (p->has[i] && size > small && roundoff < size && roundoff > *part * size) {
            *part = roundoff / size;
            limited = (int)i;
        }
    }
    return limited;
}

double ct_output_sensitivity_error(struct ct_output_sensitivity *p, double t, const double *y,
                                   const double *e, const double *largest,
                                   const struct ct_tolerance *tolerance)
{
    double sum = 0;
    size_t n = 0;
    if (p->skip-- > 0)
        return 0;
    p->skip = 0;
    note_sizes(p, largest);
    if (!find(p, t, y, p->reach, tolerance)) {
        p->skip = CALLS_BETWEEN;
        return 0;
    }
    for (size_t i = 0; i < p->ny; i++)
        p->y[i] = y[i] + e[i];
    const double *off = ct_controlled_outputs_at(p->outputs, t, p->y);
    for (size_t i = 0; i < p->n; i++) {
        if (!p->has[i])
            continue;
        const double wanted = tolerance->rtol * p->largest[i] + tolerance->atol;
        const double roundoff = DBL_EPSILON * p->way[i];
        const double part
            = (off[i] - p->at[i]) / ct_larger(CT_FEWEST_ROUNDOFF_ERRORS * roundoff, wanted);
        sum += part * part;
        n++;
    }
    return isfinite(sum) ? ct_larger(sqrt(sum / (double)n), DBL_MIN) : INFINITY;
}
