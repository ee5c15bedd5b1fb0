// Common code of public entry points: guards, contexts of objects, diagnostics, suggestions, time.
//
// What always holds: an object made by an entry point owns a context with its own arenas. Its
// diagnostics are copied to the caller's context before the entry point returns.
#ifndef CT_BASE_ENTRY_H
#define CT_BASE_ENTRY_H

#include "base/ctx.h"

#include <locale.h>

/// Set the locale of this thread to "C"; returns the old one for ct_locale_leave. ct_enter does
/// both.
locale_t ct_locale_enter(void);
void ct_locale_leave(locale_t before);
/// The text that print writes to a stream, to be freed by ct_free. NULL if it fails or there is no
/// memory; ctx, unless NULL, then has a diagnostic.
char *ct_text_of(struct ct_ctx *ctx, bool (*print)(void *task, FILE *out), void *task);
/// Print an object in the locale "C" to a stream, or to such a text. Does nothing if either is
/// NULL.
typedef void ct_printer(const void *object, FILE *out);
void ct_print_to(FILE *out, ct_printer *print, const void *object);
char *ct_print_text(ct_printer *print, const void *object);
/// Copy a caller's options of `size` bytes into `to`. Their first member is their size when the
/// caller was compiled (0: the present size).
void ct_options_take(void *to, const void *from, size_t size);

/// Run work(task) under a guard. Out of memory: false, with E001 in ctx.
bool ct_enter(struct ct_ctx *ctx, bool (*work)(void *task), void *task);
/// As ct_enter without a change of locale, for functions that read and print nothing but
/// diagnostics. Costs about ten nanoseconds.
bool ct_enter_plainly(struct ct_ctx *ctx, bool (*work)(void *task), void *task);
/// As ct_enter without interrupts, for reporting and saving after an interrupt.
bool ct_enter_uninterrupted(struct ct_ctx *ctx, bool (*work)(void *task), void *task);
/// Create the two arenas of a context that a system or a run owns. Jumps to the guard without
/// memory.
void ct_own_init(struct ct_ctx *own);
void ct_own_finish(struct ct_ctx *own);
/// Begin a new stage: clear the scratch arena.
void ct_own_next_stage(struct ct_ctx *own);
/// Allocate zeroed memory for an object that owns a context, to be released by free. NULL, with
/// E001 in ctx, when there is no memory.
void *ct_own_alloc(struct ct_ctx *ctx, size_t size);
/// Initialise the context of a new object, run work(task) under a guard and copy its diagnostics to
/// ctx. True if work succeeded.
bool ct_own_enter(struct ct_ctx *ctx, struct ct_ctx *own, bool (*work)(void *task), void *task);
/// Copy the diagnostics of `from` to `to`.
void ct_ctx_hand_over(struct ct_ctx *to, struct ct_ctx *from);
/// "; did you mean 'x'?" for the nearest of n names, else ""; in arena a.
const char *ct_suggest(struct ct_arena *a, const char *name, const char *const *names,
                       size_t n);
/// As ct_suggest; if no name is near, "; there are x, y, z".
const char *ct_suggest_or_list(struct ct_arena *a, const char *name, const char *const *names,
                               size_t n);
/// Monotonic time [s].
double ct_monotonic_time(void);

#endif
