// The context that every stage gets: two arenas and the list of diagnostics.
//
// Every function that can fail returns bool. When it returns false, it has put at least one
// diagnostic here; the caller only returns false too. A stage reports all the errors it can detect
// before it returns.
#ifndef CT_BASE_CTX_H
#define CT_BASE_CTX_H

#include "base/arena.h"
#include "base/guard.h"

#include <cotree/diagnostic.h>

#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>

/// A position in a text file. Counts start at 0 as in libyaml; one is added when it is printed.
/// file == NULL: no position is known (command line, numerical failure).
struct ct_mark {
    const char *file;
    int line, column;
    // in a table file of a model, which may be any file: its lines are not shown
    bool is_table;
};

enum ct_code {
#define MESSAGE(code, number, text) code = number,
#include "base/messages.def"
#undef MESSAGE
};

struct ct_finding {
    enum ct_severity severity;
    enum ct_code code; // 0 for notes
    struct ct_mark mark;
    const char *text;
};

struct ct_ctx {
    struct ct_arena *model;   // load until the model is destroyed
    struct ct_arena *scratch; // one stage; reset by the stage driver
    struct ct_finding *diagnostic;
    size_t ndiagnostic, diagnostic_cap;
    size_t nerror;  // number of errors among them
    bool no_memory; // out of memory: E001, which is reported without allocating
    // of contexts that callers create
    atomic_bool is_cancelled;     // set to cancel the work that reports here: E005
    const atomic_bool *cancelled; // is_cancelled of the enclosing context; NULL: there is none
    void (*tell)(
        void *user,
        const struct ct_diagnostic *diagnostic); // callback for diagnostics; NULL: none
    void *user;
    size_t ntold;         // diagnostics already passed to it
    bool was_interrupted; // work was cancelled: E005, unless a diagnostic says more
    size_t nunseen;       // diagnostics beyond the limit, counted only
};

/// Report an error in the context. Always returns false, for use as `return ct_error(...)`.
bool ct_error(struct ct_ctx *ctx, struct ct_mark mark, enum ct_code code, const char *fmt, ...)
    __attribute__((format(printf, 4, 5)));
void ct_warning(struct ct_ctx *ctx, struct ct_mark mark, enum ct_code code, const char *fmt,
                ...) __attribute__((format(printf, 4, 5)));
/// Add a note to the last diagnostic, with a position of its own.
void ct_note(struct ct_ctx *ctx, struct ct_mark mark, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

/// Print all diagnostics as FILE:LINE:COLUMN: error: MESSAGE [Exxx], each with its source line and
/// a caret when the file can be read again.
void ct_ctx_print(const struct ct_ctx *ctx, FILE *out);

/// The name nearest to `name` by edit distance among n names, or NULL if none is close.
/// For "did you mean". Cost O(n |name| |names|).
const char *ct_nearest(const char *name, const char *const *names, size_t n);

#endif
