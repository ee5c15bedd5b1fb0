// A result file that is either complete or absent.
//
//     open: FILE.partial  -- writing -->  FILE.partial  -- close -->  FILE
//                                               `-- abandon, crash -->  FILE.partial stays
//
// What always holds: FILE is unchanged until close has succeeded. FILE.partial is written by
// one process at a time (it is locked), is never a link, and is on the disk before it becomes
// FILE. Only a file that is not a regular one, such as /dev/null, is written directly. On a
// file system without locks the last of two simultaneous writers wins.
#ifndef CT_REPORT_OUTFILE_H
#define CT_REPORT_OUTFILE_H

#include "base/ctx.h"

struct ct_outfile {
    FILE *stream;        // NULL when not open
    const char *path;    // as given; "standard output" if that is meant
    const char *partial; // where it is written; NULL: straight to path
};

/// Opens path for writing; NULL is standard output. Strings live in ctx->model. Errors: E002;
/// E006 if another process is writing it.
bool ct_outfile_open(struct ct_ctx *ctx, struct ct_outfile *o, const char *path);

/// Opens the partial file of an earlier writer with its contents, for reading and writing from
/// its start.
bool ct_outfile_reopen(struct ct_ctx *ctx, struct ct_outfile *o, const char *path);

/// Passes everything written so far to the system. Errors: E002.
bool ct_outfile_flush(struct ct_ctx *ctx, struct ct_outfile *o);

/// Completes the file and gives it its final name. On failure the partial file stays. Errors:
/// E002.
bool ct_outfile_close(struct ct_ctx *ctx, struct ct_outfile *o);

/// Closes the file unfinished; the partial file stays. Accepts all zeros and a closed file.
void ct_outfile_abandon(struct ct_outfile *o);

/// Closes the file unfinished and deletes the partial file.
void ct_outfile_discard(struct ct_outfile *o);

#endif
