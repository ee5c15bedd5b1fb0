// Work-precision diagrams: time and error of settings of methods, as a table and as a plot.
//
//     method,tolerance,elements,formulation,error,seconds,steps,evaluations
//     dopri5,0.0001,,,3.1e-05,0.00042,81,487
//
// What always holds: points of one method are adjacent, in the order of the tolerances; a
// failed run has no error (NaN): an empty field in CSV, null in JSON, no point in the plot.
#ifndef CT_REPORT_WORK_PRECISION_H
#define CT_REPORT_WORK_PRECISION_H

#include "base/ctx.h"

/// One setting.
struct ct_work_precision_point {
    const char *method;
    long elements;           // of beams; 0: none, or not all equal
    const char *formulation; // of beams; NULL: none, or not all equal
    double tolerance;        // the step [s] if has_step
    bool has_step;
    double error;   // relative, of the outputs; NaN: the run failed
    double seconds; // of the integration
    long steps, evaluations;
};

/// Further contents of the plot.
struct ct_work_precision_plot {
    const char *title;
    double wanted;      // error: a line is drawn there; 0: none
    double uncertainty; // of the reference: smaller errors are not meaningful; 0: unknown
    const struct ct_work_precision_point *best; // point to be marked; NULL: none
};

/// Do both belong to one line of the plot: the same method and the same beams?
bool ct_work_precision_is_alike(const struct ct_work_precision_point *p,
                                const struct ct_work_precision_point *q);
/// "radau5, N = 5, linear"
void ct_work_precision_name(char *text, size_t size, const struct ct_work_precision_point *p);

/// The table: JSON (an object of columns) if path ends with .json, else CSV; path NULL or "-":
/// CSV on standard output. Errors: E002.
bool ct_work_precision_write(struct ct_ctx *ctx, const char *path,
                             const struct ct_work_precision_point *point, size_t n);

/// Error against seconds, both logarithmic, one line for each method, as SVG: <svg> ... </svg>.
void ct_work_precision_print(FILE *out, const struct ct_work_precision_point *point, size_t n,
                             const struct ct_work_precision_plot *plot);
/// The same as a file. Errors: E002.
bool ct_work_precision_draw(struct ct_ctx *ctx, const char *path,
                            const struct ct_work_precision_point *point, size_t n,
                            const struct ct_work_precision_plot *plot);

#endif
