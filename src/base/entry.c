// Public contexts, and the guards of entry points; see entry.h.
#include "base/entry.h"

#include "base/guard.h"
#include "base/names.h"

#include <cotree/cotree.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct ct_ctx *ct_ctx_create(void)
{
    struct ct_ctx *ctx = calloc(1, sizeof *ctx);
    if (ctx)
        ctx->model = ct_arena_create();
    if (ctx && !ctx->model) {
        free(ctx);
        return NULL;
    }
    return ctx;
}

void ct_ctx_destroy(struct ct_ctx *ctx)
{
    if (ctx)
        ct_arena_destroy(ctx->model);
    free(ctx);
}

static void print_diagnostics(const void *ctx, FILE *out)
{
    ct_ctx_print(ctx, out);
}

void ct_ctx_print_diagnostics(const struct ct_ctx *ctx, FILE *out)
{
    ct_print_to(out, print_diagnostics, ctx);
}

char *ct_ctx_diagnostics(const struct ct_ctx *ctx)
{
    return ct_print_text(print_diagnostics, ctx);
}

// ---- access to diagnostics ---------------------------------------------------------------------

// Was the work interrupted, without a diagnostic that says how far it came?
static bool is_silently_interrupted(const struct ct_ctx *ctx)
{
    bool is_silent = ctx->was_interrupted;
    for (size_t i = 0; i < ctx->ndiagnostic; i++)
        is_silent &= ctx->diagnostic[i].code != CT_E_INTERRUPTED;
    return is_silent;
}

size_t ct_ctx_count(const struct ct_ctx *ctx)
{
    size_t n = ctx ? ctx->no_memory + is_silently_interrupted(ctx) : 0;
    for (size_t i = 0; ctx && i < ctx->ndiagnostic; i++)
        n += ctx->diagnostic[i].severity != CT_SEVERITY_NOTE;
    return n;
}

// The notes after diagnostic i, one per line.
static const char *notes_after(struct ct_ctx *ctx, size_t i)
{
    const char *text = "";
    for (size_t k = i + 1;
         k < ctx->ndiagnostic && ctx->diagnostic[k].severity == CT_SEVERITY_NOTE; k++) {
        const struct ct_finding *note = &ctx->diagnostic[k];
        const char *end = *text ? "\n" : "";
        text = note->mark.file
                 ? ct_arena_printf(ctx->model, "%s%s%s:%d:%d: %s", text, end, note->mark.file,
                                   note->mark.line + 1, note->mark.column + 1, note->text)
                 : ct_arena_printf(ctx->model, "%s%s%s", text, end, note->text);
    }
    return text;
}

static struct ct_diagnostic describe(struct ct_ctx *ctx, size_t i)
{
    const struct ct_finding *d = &ctx->diagnostic[i];
    const bool is_placed = d->mark.file != NULL;
    return (struct ct_diagnostic){.severity = d->severity,
                                  .code = (int)d->code,
                                  .message = d->text,
                                  .file = d->mark.file,
                                  .line = is_placed ? (size_t)d->mark.line + 1 : 0,
                                  .column = is_placed ? (size_t)d->mark.column + 1 : 0,
                                  .notes = notes_after(ctx, i)};
}

struct question {
    struct ct_ctx *ctx;
    size_t i;
    struct ct_diagnostic *out;
};

static bool find_diagnostic(void *task)
{
    const struct question *q = task;
    size_t n = 0;
    for (size_t k = 0; k < q->ctx->ndiagnostic; k++)
        if (q->ctx->diagnostic[k].severity != CT_SEVERITY_NOTE && n++ == q->i) {
            *q->out = describe(q->ctx, k);
            return true;
        }
    return false;
}

bool ct_ctx_diagnostic(struct ct_ctx *ctx, size_t i, struct ct_diagnostic *diagnostic)
{
    struct question q = {ctx, i, diagnostic};
    if (!ctx || !diagnostic || i >= ct_ctx_count(ctx))
        return false;
    if (ct_enter_uninterrupted(ctx, find_diagnostic, &q))
        return true;
    // insert behind the diagnostics that are kept
    const bool is_interrupt
        = is_silently_interrupted(ctx) && !(ctx->no_memory && i + 1 == ct_ctx_count(ctx));
    *diagnostic
        = (struct ct_diagnostic){.severity = CT_SEVERITY_ERROR,
                                 .code = is_interrupt ? CT_E_INTERRUPTED : CT_E_MEMORY,
                                 .message = is_interrupt ? "interrupted" : "out of memory",
                                 .notes = ""};
    return true;
}

void ct_ctx_clear(struct ct_ctx *ctx)
{
    if (!ctx)
        return;
    ct_arena_clear(ctx->model);
    ctx->diagnostic = NULL;
    ctx->ndiagnostic = ctx->diagnostic_cap = ctx->nerror = ctx->ntold = 0;
    ctx->no_memory = ctx->was_interrupted = false;
    atomic_store(&ctx->is_cancelled, false);
}

void ct_ctx_on_diagnostic(struct ct_ctx *ctx,
                          void (*callback)(void *user, const struct ct_diagnostic *diagnostic),
                          void *user)
{
    if (!ctx)
        return;
    ctx->tell = callback;
    ctx->user = user;
    ctx->ntold = ctx->ndiagnostic;
}

void ct_ctx_cancel(struct ct_ctx *ctx)
{
    if (ctx)
        atomic_store(&ctx->is_cancelled, true);
}

// Pass new diagnostics to the callback.
static void tell(struct ct_ctx *ctx)
{
    if (!ctx->tell)
        return;
    for (; ctx->ntold < ctx->ndiagnostic; ctx->ntold++) {
        if (ctx->diagnostic[ctx->ntold].severity == CT_SEVERITY_NOTE)
            continue;
        const struct ct_diagnostic d = describe(ctx, ctx->ntold);
        ctx->tell(ctx->user, &d);
    }
}

void ct_free(void *text)
{
    free(text);
}

// Is it a code that only concerns options?
static bool is_option(int code)
{
    return code == CT_E_USAGE || code == CT_E_SUFFIX || code == CT_E_INPUT || code == CT_E_LOAD;
}

enum ct_fault ct_ctx_fault(const struct ct_ctx *ctx)
{
    if (!ctx)
        return CT_FAULT_NONE;
    if (ctx->no_memory || ctx->was_interrupted) // whatever was reported before
        return CT_FAULT_MODEL;
    enum ct_fault fault = ctx->nerror ? CT_FAULT_MODEL : CT_FAULT_NONE;
    for (size_t i = 0; i < ctx->ndiagnostic; i++)
        if (ctx->diagnostic[i].severity == CT_SEVERITY_ERROR
            && is_option(ctx->diagnostic[i].code))
            fault = CT_FAULT_OPTION;
    return fault;
}

const char *ct_version(void)
{
    return CT_VERSION;
}

const char *ct_did_you_mean(const char *name, const char *const *names, size_t n)
{
    return name && names ? ct_nearest(name, names, n) : NULL;
}

locale_t ct_locale_enter(void)
{
    return uselocale(newlocale(LC_ALL_MASK, "C", (locale_t)0)); // created once
}

void ct_locale_leave(locale_t before)
{
    uselocale(before);
}

char *ct_text_of(struct ct_ctx *ctx, bool (*print)(void *task, FILE *out), void *task)
{
    char *text = NULL;
    size_t n;
    FILE *out = open_memstream(&text, &n);
    bool ok = out && print(task, out);
    const bool is_whole = out && !ferror(out);
    if (out)
        ok &= fclose(out) == 0 && is_whole;
    if (ctx && (!out || !is_whole))
        ctx->no_memory = true;
    if (ok)
        return text;
    free(text);
    return NULL;
}

void ct_print_to(FILE *out, ct_printer *print, const void *object)
{
    if (!object || !out)
        return;
    const locale_t before = ct_locale_enter();
    print(object, out);
    ct_locale_leave(before);
}

struct print {
    ct_printer *print;
    const void *object;
};

static bool print_object(void *task, FILE *out)
{
    const struct print *p = task;
    ct_print_to(out, p->print, p->object);
    return true;
}

char *ct_print_text(ct_printer *print, const void *object)
{
    struct print p = {print, object};
    return object ? ct_text_of(NULL, print_object, &p) : NULL;
}

void ct_options_take(void *to, const void *from, size_t size)
{
    size_t given = 0;
    memset(to, 0, size);
    if (from)
        memcpy(&given, from, sizeof given);
    if (from)
        memcpy(to, from, given > 0 && given < size ? given : size);
}

// Only the outermost call passes diagnostics to the callback, after they were copied to the
// caller's context.
static bool enter(struct ct_ctx *ctx, bool is_uninterrupted, bool (*work)(void *task),
                  void *task)
{
    struct ct_guard g;
    ct_guard_push(&g);
    g.cancelled[0] = &ctx->is_cancelled;
    g.cancelled[1] = ctx->cancelled;
    g.is_uninterrupted = is_uninterrupted;
    if (setjmp(g.env)) {
        if (ct_guard_is_interrupted())
            ctx->was_interrupted = true;
        else
            ctx->no_memory = true;
        ct_guard_pop(&g);
        return false;
    }
    const bool ok = work(task);
    tell(ctx);
    ctx->was_interrupted |= !ok && ct_guard_is_interrupted();
    ct_guard_pop(&g);
    return ok;
}

bool ct_enter(struct ct_ctx *ctx, bool (*work)(void *task), void *task)
{
    const locale_t before = ct_locale_enter();
    const bool ok = ct_enter_plainly(ctx, work, task);
    ct_locale_leave(before);
    return ok;
}

bool ct_enter_plainly(struct ct_ctx *ctx, bool (*work)(void *task), void *task)
{
    return enter(ctx, false, work, task);
}

bool ct_enter_uninterrupted(struct ct_ctx *ctx, bool (*work)(void *task), void *task)
{
    return enter(ctx, true, work, task);
}

bool ct_ctx_was_interrupted(const struct ct_ctx *ctx)
{
    return ctx && ctx->was_interrupted;
}

void ct_own_init(struct ct_ctx *own)
{
    own->model = ct_arena_create();
    own->scratch = ct_arena_create();
    if (!own->model || !own->scratch)
        ct_guard_raise();
}

void ct_own_finish(struct ct_ctx *own)
{
    ct_arena_destroy(own->scratch);
    ct_arena_destroy(own->model);
}

void *ct_own_alloc(struct ct_ctx *ctx, size_t size)
{
    void *object = calloc(1, size);
    ctx->no_memory |= !object;
    return object;
}

struct owner {
    struct ct_ctx *ctx, *own;
    bool (*work)(void *task);
    void *task;
};

static bool work_in_own(void *task)
{
    const struct owner *o = task;
    ct_own_init(o->own);
    const bool ok = o->work(o->task);
    o->ctx->no_memory |= o->own->no_memory;
    ct_ctx_hand_over(o->ctx, o->own);
    return ok;
}

bool ct_own_enter(struct ct_ctx *ctx, struct ct_ctx *own, bool (*work)(void *task), void *task)
{
    struct owner o = {ctx, own, work, task};
    return ct_enter(ctx, work_in_own, &o);
}

void ct_own_next_stage(struct ct_ctx *own)
{
    struct ct_arena *fresh = ct_arena_create();
    if (!fresh)
        ct_guard_raise();
    ct_arena_destroy(own->scratch);
    own->scratch = fresh;
}

void ct_ctx_hand_over(struct ct_ctx *to, struct ct_ctx *from)
{
    to->nunseen += from->nunseen;
    to->was_interrupted |= from->was_interrupted;
    const char *file = NULL, *copy = NULL; // most diagnostics concern the same file
    for (size_t i = 0; i < from->ndiagnostic; i++) {
        struct ct_finding d = from->diagnostic[i];
        d.text = ct_arena_strdup(to->model, d.text);
        if (d.mark.file && d.mark.file != file) {
            file = d.mark.file;
            copy = ct_arena_strdup(to->model, file);
        }
        d.mark.file = d.mark.file ? copy : NULL;
        CT_PUSH(to->model, to->diagnostic, to->ndiagnostic, to->diagnostic_cap, d);
        to->nerror += d.severity == CT_SEVERITY_ERROR;
    }
    from->ndiagnostic = from->nerror = from->nunseen = 0;
}

const char *ct_suggest(struct ct_arena *a, const char *name, const char *const *names, size_t n)
{
    const char *near = ct_nearest(name, names, n);
    return near ? ct_arena_printf(a, "; did you mean '%s'?", near) : "";
}

const char *ct_suggest_or_list(struct ct_arena *a, const char *name, const char *const *names,
                               size_t n)
{
    const char *text = ct_suggest(a, name, names, n);
    for (size_t i = 0; i < n && (i || !*text); i++)
        text = ct_arena_printf(a, "%s%s%s", text, i ? ", " : "; there are ", names[i]);
    return text;
}

double ct_monotonic_time(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec; // Definition: nanoseconds
}
