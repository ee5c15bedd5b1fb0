// See output_sensitivity.h.
#include "solve/output_error/output_sensitivity.h"

#include "integrate/stepper.h"
#include "numeric/roundoff.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Sensitivities change slowly. Those of accelerations are used at this number of further states.
// Default: two evaluations for each of them against late detection. Test: output_sensitivity
enum { STATES_BETWEEN = 7 };

struct ct_output_sensitivity {
    struct ct_controlled_outputs *outputs;
    struct ct_constrained_output *constrained;
    struct ct_constrained_output_record *record;
    size_t n, ny;
    double *at, *largest; // (n) g; its largest absolute value so far
    double *sensitivity;  // (n) |change of g| for a relative change 1 of all states
    // (n) the same for changes |y_i| + atol/rtol, of outputs of accelerations
    double *scaled_sensitivity;
    bool *is_sensitive; // (n)
    double *y;          // (ny) workspace
    double t_at, *y_at; // time and state of `at`, (ny)
    int between;        // states left at which the last sensitivities are used
    bool has_sensitive; // at the last test
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
    double **const vectors[] = {&p->at, &p->largest, &p->sensitivity};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, n);
    p->scaled_sensitivity
        = outputs->kind == CT_OUTPUTS_OF_SOLUTIONS ? CT_NEWN(a, double, n) : p->sensitivity;
    p->is_sensitive = CT_NEWN(a, bool, n);
    p->y = CT_NEWN(a, double, p->ny);
    p->y_at = CT_NEWN(a, double, p->ny);
    p->t_at = NAN;
    return p;
}

void ct_output_sensitivity_start(struct ct_output_sensitivity *p)
{
    memset(p->largest, 0, p->n * sizeof *p->largest);
    memset(p->is_sensitive, 0, p->n * sizeof *p->is_sensitive);
    p->t_at = NAN;
    p->between = 0;
}

bool ct_output_sensitivity_is_sensitive(const struct ct_output_sensitivity *p, size_t i)
{
    return p->is_sensitive[i];
}

// Change of the outputs over CT_PERTURBATION, for states changed by CT_PERTURBATION (|y_i| +
// small), with different factors so that changes do not cancel.
static void find_sensitivity(struct ct_output_sensitivity *p, double t, const double *y,
                             double small, double *sensitivity)
{
    for (size_t i = 0; i < p->ny; i++)
        p->y[i]
            = y[i] + CT_PERTURBATION * ct_perturbation_part(i) * (y[i] + copysign(small, y[i]));
    const double *off = ct_controlled_outputs_at(p->outputs, t, p->y);
    for (size_t i = 0; i < p->n; i++)
        sensitivity[i] = fabs(off[i] - p->at[i]) / CT_PERTURBATION;
}

// Evaluate outputs and sensitivities at y.
static void evaluate(struct ct_output_sensitivity *p, double t, const double *y,
                     const struct ct_tolerance *tolerance)
{
    const bool is_solved = p->outputs->kind == CT_OUTPUTS_OF_SOLUTIONS;
    memcpy(p->at, ct_controlled_outputs_at(p->outputs, t, y), p->n * sizeof *p->at);
    for (size_t i = 0; i < p->n; i++)
        p->largest[i] = ct_larger(fabs(p->at[i]), p->largest[i]);
    p->t_at = t;
    ct_evaluator_copy(p->y_at, y, p->ny);
    if (p->between-- > 0)
        return;
    p->between = is_solved ? STATES_BETWEEN : 0;
    find_sensitivity(p, t, y, 0, p->sensitivity);
    if (is_solved && tolerance->rtol > 0)
        find_sensitivity(p, t, y, tolerance->atol / tolerance->rtol, p->scaled_sensitivity);
}

// Select sensitive outputs that are not known to be constrained. is_new (out): some sensitive
// output has not been tested for that.
static bool select_sensitive(struct ct_output_sensitivity *p, const double *sensitivity,
                             const struct ct_tolerance *tolerance, bool *is_new)
{
    bool any = *is_new = false;
    for (size_t i = 0; i < p->n; i++) {
        const double wanted = tolerance->rtol * p->largest[i] + tolerance->atol;
        const bool is_candidate = tolerance->rtol * sensitivity[i] > CT_PROMISED_ERROR * wanted;
        p->is_sensitive[i] = is_candidate && !p->record->is_found[i];
        any |= p->is_sensitive[i];
        *is_new |= is_candidate && !p->record->is_settled[i];
    }
    return any;
}

// Find the sensitive outputs at y, by one of the two sensitivities.
static bool find_sensitive(struct ct_output_sensitivity *p, double t, const double *y,
                           const double *sensitivity, const struct ct_tolerance *tolerance)
{
    bool is_new;
    if (t != p->t_at || memcmp(y, p->y_at, p->ny * sizeof *y) != 0)
        evaluate(p, t, y, tolerance);
    const bool any = select_sensitive(p, sensitivity, tolerance, &is_new);
    if (!is_new || !ct_constrained_output_find(p->constrained, p->record, t, y, tolerance))
        return any;
    return select_sensitive(p, sensitivity, tolerance, &is_new);
}

static void update_largest(struct ct_output_sensitivity *p, const double *largest)
{
    for (size_t i = 0; i < p->n; i++)
        p->largest[i] = ct_larger(largest[i], p->largest[i]);
}

bool ct_output_sensitivity_any(struct ct_output_sensitivity *p, double t, const double *y,
                               const struct ct_tolerance *tolerance)
{
    const bool any = find_sensitive(p, t, y, p->sensitivity, tolerance);
    ct_output_sensitivity_start(p);
    return any;
}

int ct_output_sensitivity_roundoff_limit(struct ct_output_sensitivity *p, double t,
                                         const double *y, const double *largest, double wanted,
                                         double small, double *part)
{
    const struct ct_tolerance tolerance = {wanted, 0};
    int limited = -1;
    update_largest(p, largest);
    find_sensitive(p, t, y, p->sensitivity, &tolerance);
    *part = wanted / CT_FEWEST_ROUNDOFF_ERRORS;
    for (size_t i = 0; i < p->n; i++) {
        const double size = p->largest[i], roundoff = DBL_EPSILON * p->sensitivity[i];
        // a residual consists of round-off
        if (p->is_sensitive[i] && size > small && roundoff < size && roundoff > *part * size) {
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
    update_largest(p, largest);
    if (p->between > 0
        && !p->has_sensitive) { // sensitivities are the same, and sizes only grow
        p->between--;
        return 0;
    }
    p->has_sensitive = find_sensitive(p, t, y, p->scaled_sensitivity, tolerance);
    if (!p->has_sensitive)
        return 0;
    for (size_t i = 0; i < p->ny; i++)
        p->y[i] = y[i] + e[i];
    const double *off = ct_controlled_outputs_at(p->outputs, t, p->y);
    for (size_t i = 0; i < p->n; i++) {
        if (!p->is_sensitive[i])
            continue;
        const double wanted = tolerance->rtol * p->largest[i] + tolerance->atol;
        const double roundoff = DBL_EPSILON * p->sensitivity[i];
        const double part
            = (off[i] - p->at[i]) / ct_larger(CT_FEWEST_ROUNDOFF_ERRORS * roundoff, wanted);
        sum += part * part;
        n++;
    }
    return isfinite(sum) ? ct_larger(sqrt(sum / (double)n), DBL_MIN) : INFINITY;
}
