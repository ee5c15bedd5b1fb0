// A progress bar for a terminal:
//
//     simulate [##########..........]  50 %
//
// What always holds: output is written only to a terminal and only after a visible change, so
// that updates are cheap and logs stay clean.
#ifndef CT_REPORT_PROGRESS_H
#define CT_REPORT_PROGRESS_H

#include <stdbool.h>
#include <stdio.h>

struct ct_progress {
    FILE *out;
    const char *label; // the caller's, kept
    bool is_visible;
    int percent; // as shown; -1: nothing yet
};

/// out is stderr except in tests.
void ct_progress_init(struct ct_progress *p, FILE *out, const char *label);
/// Shows the fraction done, 0 to 1; other values are clipped, NaN is ignored.
void ct_progress_update(struct ct_progress *p, double fraction);
/// Erases the bar. Accepts all zeros.
void ct_progress_finish(struct ct_progress *p);

#endif
