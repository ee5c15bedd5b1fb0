// One run of a work-precision study, and the distance of two runs.
#include "accuracy/accuracy.h"

#include "base/guard.h"

#include <math.h>

void ct_accuracy_end_run(struct ct_accuracy *a)
{
    const bool no_memory = a->said.no_memory;
    ct_sim_destroy(a->sim);
    a->sim = NULL;
    if (no_memory)
        ct_guard_raise();
}

bool ct_accuracy_start_run(struct ct_accuracy *a, const struct ct_setting *s)
{
    struct ct_sim_options o = a->o->run;
    o.method = s->method;
    o.tolerance = s->tolerance;
    o.absolute = 0;
    o.step = s->step;
    a->said.ndiagnostic = a->said.nerror = 0;
    a->sim = ct_sim_create(&a->said, a->system, &o);
    if (!a->sim)
        return false;
    a->sim->run_options.step = s->step; // overrides the step of the model
    if (s->rtol > 0) {
        a->sim->run_options.rtol = s->rtol;
        a->sim->run_options.atol = s->rtol / 100;
    }
    return true;
}

enum ct_ending ct_accuracy_start(struct ct_accuracy *a, const struct ct_setting *s,
                                 double limit,
                                 bool (*row)(void *, double, const double *, size_t),
                                 struct ct_work_precision_point *p)
{
    *p = (struct ct_work_precision_point){.method = s->method,
                                          .elements = a->variant ? a->variant->elements : 0,
                                          .formulation
                                          = a->variant ? a->variant->formulation : NULL,
                                          .tolerance = s->step > 0 ? s->step : s->tolerance,
                                          .has_step = s->step > 0,
                                          .error = NAN};
    if (!ct_accuracy_start_run(a, s))
        return ct_ctx_fault(&a->said) == CT_FAULT_OPTION ? CT_RUN_REFUSED : CT_RUN_FAILED;
    a->nrow = 0;
    a->worst = 0;
    a->sim->deadline = ct_monotonic_time() + limit;
    const struct ct_sim_results results = {.row = row, .user = a};
    const bool ok = ct_sim_run(&a->said, a->sim, &results);
    ct_guard_poll(); // an interrupted run is no result of its method
    p->seconds = a->sim->integrate;
    p->steps = a->sim->report.stats.steps;
    p->evaluations = a->sim->report.stats.evaluations;
    return !ok ? CT_RUN_FAILED : a->sim->is_late ? CT_RUN_LATE : CT_RUN_DONE;
}

bool ct_accuracy_repeat(struct ct_accuracy *a,
                        bool (*row)(void *, double, const double *, size_t), double *seconds)
{
    const struct ct_sim_results results = {.row = row, .user = a};
    a->nrow = 0;
    a->sim->deadline = 0;
    const bool ok = ct_sim_run_again(&a->said, a->sim, &results);
    ct_guard_poll();
    if (!ok)
        return false;
    *seconds = a->sim->integrate;
    return true;
}

enum ct_ending ct_accuracy_run(struct ct_accuracy *a, const struct ct_setting *s, double limit,
                               bool (*row)(void *, double, const double *, size_t),
                               struct ct_work_precision_point *p)
{
    const enum ct_ending ending = ct_accuracy_start(a, s, limit, row, p);
    ct_accuracy_end_run(a);
    return ending;
}

double ct_accuracy_compare(const struct ct_accuracy *a, const double *x, const double *y,
                           double *scale)
{
    const size_t n = a->nresult;
    struct ct_output_error_estimate *o = a->difference;
    double worst = 0;
    for (size_t i = 0; i < n; i++) {
        o[i] = (struct ct_output_error_estimate){0};
        for (size_t k = 0; k < a->nsample; k++) {
            if (isnan(x[k * n + i]))
                continue;
            o[i].scale = fmax(o[i].scale, fabs(x[k * n + i]));
            o[i].absolute = fmax(o[i].absolute, fabs(y[k * n + i] - x[k * n + i]));
        }
    }
    ct_output_errors_relate(o, n);
    for (size_t i = 0; i < n; i++) {
        scale[i] = isnan(o[i].relative) ? 0 : o[i].scale;
        worst = fmax(worst, o[i].relative); // ignores NaN
    }
    return worst;
}
