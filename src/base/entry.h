// What public entry points share: guards, contexts of objects, diagnostics, suggestions, a clock.
//
// What always holds: an object made by an entry point owns a context with its own arenas. Its
// diagnostics are copied to the caller's context before the entry point returns.
#ifndef CT_BASE_ENTRY_H
#define CT_BASE_ENTRY_H

#include "base/ctx.h"

#include <locale.h>

/// The locale "C" for this thread, whatever that of the program is; returns what ct_locale_leave sets again. ct_enter does both.
locale_t ct_locale_enter(void);
void ct_locale_leave(locale_t before);
/// What print writes to a stream, as a text for ct_free; NULL where it fails or there is no memory, which ctx, unless NULL, notes.
char *ct_text_of(struct ct_ctx *ctx, bool (*print)(void *task, FILE *out), void *task);
/// What print writes of an object, which it knows, in the locale "C": to a stream, or as such a text. Of NULL, and to NULL, nothing.
typedef void ct_printer(const void *object, FILE *out);
void ct_print_to(FILE *out, ct_printer *print, const void *object);
char *ct_print_text(ct_printer *print, const void *object);
/// Copy a caller's options of `size` bytes, whose first member is the size they had there (0: as here), into `to`.
void ct_options_take(void *to, const void *from, size_t size);

/// Run work(task) with a guard: without memory false, and E001 in ctx.
bool ct_enter(struct ct_ctx *ctx, bool (*work)(void *task), void *task);
/// The same for what reads and prints nothing but diagnostics: the locale stays. Some ten nanoseconds.
bool ct_enter_plainly(struct ct_ctx *ctx, bool (*work)(void *task), void *task);
/// The same without interrupts, for reporting and saving after one.
bool ct_enter_uninterrupted(struct ct_ctx *ctx, bool (*work)(void *task), void *task);
/// Two arenas for a context that a system or a run owns. Raises the guard.
void ct_own_init(struct ct_ctx *own);
void ct_own_finish(struct ct_ctx *own);
/// A new stage starts: nothing in the scratch arena is needed any more.
void ct_own_next_stage(struct ct_ctx *own);
/// Zeroed memory for an object that owns a context, released by free. NULL, with E001 in ctx, when
/// there is no memory.
void *ct_own_alloc(struct ct_ctx *ctx, size_t size);
/// Initialise the context of a new object, run work(task) with a guard and copy its diagnostics to
/// ctx. True if work succeeded.
bool ct_own_enter(struct ct_ctx *ctx, struct ct_ctx *own, bool (*work)(void *task), void *task);
/// Diagnostics of `from` go to `to`, as copies.
void ct_ctx_hand_over(struct ct_ctx *to, struct ct_ctx *from);
/// "; did you mean 'x'?" for the nearest of n names, else ""; in arena a.
const char *ct_suggest(struct ct_arena *a, const char *name, const char *const *names,
                       size_t n);
/// The same; else "; there are x, y, z".
const char *ct_suggest_or_list(struct ct_arena *a, const char *name, const char *const *names,
                               size_t n);
/// Monotonic time [s].
double ct_monotonic_time(void);

#endif
