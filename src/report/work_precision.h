// Work and precision: what settings of methods cost and how near they come, as a table and as a
// plot.
//
//     method,tolerance,elements,formulation,error,seconds,steps,evaluations
//     dopri5,0.0001,,,3.1e-05,0.00042,81,487
//
// What always holds: points of one method stand together, in the order of the ladder; a failed
// run has no error (NaN), is an empty field in CSV, null in JSON, and is not drawn.
#ifndef CT_REPORT_WORK_PRECISION_H
#define CT_REPORT_WORK_PRECISION_H

#include "base/ctx.h"

/// One setting.
struct ct_work_precision_point {
    const char *method;
    long elements;           // of beams; 0: none, or not all alike
    const char *formulation; // of beams; NULL: none, or not all alike
    double tolerance;        // the step [s] if has_step
    bool has_step;
    double error;   // relative, of the outputs; NaN: the run failed
    double seconds; // of the integration
    long steps, evaluations;
};

/// What the plot shows beside the points.
struct ct_work_precision_plot {
    const char *title;
    double wanted;      // error: a line is drawn there; 0: none
    double uncertainty; // of the reference: errors below mean nothing; 0: not known
    const struct ct_work_precision_point *best; // is marked; NULL: none
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
