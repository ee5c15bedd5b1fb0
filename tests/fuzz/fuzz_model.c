// Whatever bytes a model file has, it is read or refused with at least one error, every error has a
// code and a place inside the file, and a model that was read has values for all its parameters.
#include "base/guard.h"
#include "component/model.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <stdlib.h>

static void require(bool holds)
{
    if (!holds)
        abort();
}

static void check_diagnostics(const struct ct_ctx *ctx, size_t size)
{
    for (size_t i = 0; i < ctx->ndiagnostic; i++) {
        const struct ct_finding *d = &ctx->diagnostic[i];
        require(d->text && (d->severity != CT_SEVERITY_ERROR || d->code != 0));
        require(d->code != CT_E_INTERNAL);
        require(d->mark.file && d->mark.line >= 0 && d->mark.column >= 0);
        require((size_t)d->mark.line <= size && (size_t)d->mark.column <= size);
    }
}

static void check_model(const struct ct_model *m)
{
    require(m->nframe >= m->nbody && m->nbody >= 1);
    for (size_t i = 0; i < m->nparameter; i++)
        require(isfinite(m->parameter[i].value));
    for (size_t i = 1; i < m->nbody; i++)
        require(m->body[i].instance.cls && ct_model_number(m, m->body[i].mass) >= 0);
    for (size_t i = 0; i < m->njoint; i++)
        require(m->joint[i].cls && m->joint[i].ncoord >= m->joint[i].nfree);
    for (size_t i = 0; i < m->nforce; i++)
        require(m->force[i].cls && m->force[i].to >= 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct ct_ctx ctx = {.model = ct_arena_create(), .scratch = ct_arena_create()};
    struct ct_model *model = malloc(sizeof *model);
    require(model && ctx.model && ctx.scratch);
    struct ct_guard g;
    ct_guard_push(&g);
    if (setjmp(g.env))
        abort(); // no input is worth all the memory there is
    const bool ok = ct_model_parse(&ctx, "fuzz.yaml", (const char *)data, size, NULL, 0, model);
    ct_guard_pop(&g);
    require(ok == (ctx.nerror == 0));
    check_diagnostics(&ctx, size);
    if (ok)
        check_model(model);
    free(model);
    ct_arena_destroy(ctx.model);
    ct_arena_destroy(ctx.scratch);
    return 0;
}
