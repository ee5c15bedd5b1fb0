/* Diagnostics: what the library has to say about a model, an option or a run. */
#ifndef COTREE_DIAGNOSTIC_H
#define COTREE_DIAGNOSTIC_H

#include <stddef.h>

enum ct_severity { CT_SEVERITY_ERROR, CT_SEVERITY_WARNING, CT_SEVERITY_NOTE };

/** An error or a warning with its notes. All texts belong to the context, until ct_ctx_clear or ct_ctx_destroy. */
struct ct_diagnostic {
    enum ct_severity severity;
    int code; /* 42 is E042 of docs/messages.md; 0: a warning without a code */
    const char *message;
    const char *file;    /* NULL: no place is known, as for an option */
    size_t line, column; /* of the file, from 1; 0: no place is known */
    const char *notes;   /* a line for each, "FILE:LINE:COLUMN: TEXT" or "TEXT"; "": none */
};

#endif
