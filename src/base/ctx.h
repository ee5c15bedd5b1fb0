// What every stage is given: two arenas and the place where diagnostics go.
//
// Every function that can fail returns bool and, when false, has put at least one diagnostic here;
// the caller only passes the false on. A stage reports all the errors it can see before it returns.
#ifndef CT_BASE_CTX_H
#define CT_BASE_CTX_H

#include "base/arena.h"
#include "base/guard.h"

#include <cotree/diagnostic.h>

#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>

/// A place in a text file. Counts from 0 as libyaml does; one is added where it is printed.
/// file == NULL: no place is known (command line, numerical trouble).
struct ct_mark {
    const char *file;
    int line, column;
    bool
        is_table; // of a file that a model names: its lines are not shown, since it may be any file
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
    size_t nerror;  // errors among them
    bool no_memory; // the guard was reached: E001, which needs no room of its own
    // of contexts that callers make
    atomic_bool is_cancelled;     // work that reports here ends: E005
    const atomic_bool *cancelled; // the same of the context that it is part of; NULL: of none
    void (*tell)(void *user, const struct ct_diagnostic *diagnostic); // NULL: nobody is told
    void *user;
    size_t ntold;         // diagnostics that have been
    bool was_interrupted; // work was cancelled: E005, if no diagnostic says more
    size_t nunseen;       // diagnostics that were not kept
};

/// Put an error into the context. Always returns false, so that `return ct_error(...)` reads well.
bool ct_error(struct ct_ctx *ctx, struct ct_mark mark, enum ct_code code, const char *fmt, ...)
    __attribute__((format(printf, 4, 5)));
void ct_warning(struct ct_ctx *ctx, struct ct_mark mark, enum ct_code code, const char *fmt,
                ...) __attribute__((format(printf, 4, 5)));
/// A further sentence to the diagnostic just made, with a mark of its own.
void ct_note(struct ct_ctx *ctx, struct ct_mark mark, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

/// Print all diagnostics as FILE:LINE:COLUMN: error: MESSAGE [Exxx], each with its source line and
/// a caret when the file can be read again.
void ct_ctx_print(const struct ct_ctx *ctx, FILE *out);

/// The name nearest to `name` by edit distance among n names, or NULL if none is close.
/// For "did you mean". Cost O(n |name| |names|).
const char *ct_nearest(const char *name, const char *const *names, size_t n);

#endif
