// Contexts from outside, and what guards the entry points; see entry.h.
#include "base/entry.h"

#include "base/guard.h"
#include "base/names.h"

#include <cotree/cotree.h>

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

void ct_ctx_print_diagnostics(const struct ct_ctx *ctx, FILE *out)
{
    ct_ctx_print(ctx, out);
}

// Codes of what only options name.
static bool is_option(int code)
{
    return code == CT_E_USAGE || code == CT_E_SUFFIX || code == CT_E_INPUT || code == CT_E_LOAD;
}

enum ct_fault ct_ctx_fault(const struct ct_ctx *ctx)
{
    if (ctx->no_memory || ctx->was_interrupted) // whatever was said before
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
    return ct_nearest(name, names, n);
}

static bool enter(struct ct_ctx *ctx, struct ct_interrupt interrupt, bool (*work)(void *task),
                  void *task)
{
    struct ct_guard g;
    ct_guard_push(&g);
    g.interrupt = interrupt;
    if (setjmp(g.env)) {
        if (ct_guard_is_interrupted())
            ctx->was_interrupted = true;
        else
            ctx->no_memory = true;
        ct_guard_pop(&g);
        return false;
    }
    const bool ok = work(task);
    ctx->was_interrupted |= !ok && ct_guard_is_interrupted();
    ct_guard_pop(&g);
    return ok;
}

bool ct_enter(struct ct_ctx *ctx, bool (*work)(void *task), void *task)
{
    return enter(ctx, ctx->interrupt.is_wanted ? ctx->interrupt : ct_guard_interrupt(), work,
                 task);
}

bool ct_enter_uninterrupted(struct ct_ctx *ctx, bool (*work)(void *task), void *task)
{
    return enter(ctx, (struct ct_interrupt){0}, work, task);
}

void ct_ctx_set_interrupt(struct ct_ctx *ctx, bool (*is_wanted)(void *user), void *user)
{
    ctx->interrupt = (struct ct_interrupt){is_wanted, user};
}

bool ct_ctx_was_interrupted(const struct ct_ctx *ctx)
{
    return ctx->was_interrupted;
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
    const char *file = NULL, *copy = NULL; // most diagnostics are about the same file
    for (size_t i = 0; i < from->ndiagnostic; i++) {
        struct ct_diagnostic d = from->diagnostic[i];
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
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
