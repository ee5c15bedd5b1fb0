// Results as comma-separated values (RFC 4180), row by row; as FILE.csv.gz compressed.
//
//     t,crank.q,"atan2(y, x)"         header: quoted if it contains a comma, quote or line end
//     0,0.5,1.25                      numbers: fewest digits that read back to the same bits
//
// What always holds: each row has as many fields as the header (asserted); the data passed to
// the system ends with a whole row; the file gets its name only when it is complete
// (outfile.h).
#ifndef CT_REPORT_CSV_H
#define CT_REPORT_CSV_H

#include "report/outfile.h"
#include "report/suffix.h"

struct ct_csv {
    struct ct_outfile file;
    struct ct_gzip *gzip; // NULL: not compressed
    struct ct_arena *arena;
    size_t ncolumn;
    size_t nfield; // in the current row
    char *text;    // buffered rows, and the current one  (n used, cap)
    size_t n, cap;
};

/// Opens path (NULL: standard output) and writes the header. Errors: E002, E006.
bool ct_csv_open(struct ct_ctx *ctx, struct ct_csv *w, const char *path, enum ct_suffix suffix,
                 const char *const *column, size_t ncolumn);

/// Writes a row field by field, numbers and texts ("" for an empty field), and its end.
void ct_csv_number(struct ct_csv *w, double value);
void ct_csv_text(struct ct_csv *w, const char *text);
bool ct_csv_end_row(struct ct_ctx *ctx, struct ct_csv *w);

/// Passes the rows so far to the system, except those that the compressor holds. Errors: E002.
bool ct_csv_flush(struct ct_ctx *ctx, struct ct_csv *w);

/// Completes the file under its own name. Errors: E002.
bool ct_csv_close(struct ct_ctx *ctx, struct ct_csv *w);

/// Closes the file unfinished: the rows so far stay in PATH.partial. Accepts all zeros and a
/// closed writer.
void ct_csv_abandon(struct ct_csv *w);

#endif
