// What the tests of reading models start with: a context and an empty model.
#ifndef CT_TEST_UNIT_READ_STATE_H
#define CT_TEST_UNIT_READ_STATE_H

#include "component/model.h"
#include "tests/check.h"

#include <stdlib.h>

struct bench {
    struct ct_ctx ctx;
    struct ct_model m;
};

static inline int create(void **state)
{
    struct bench *s = calloc(1, sizeof *s);
    *state = s;
    return s && (s->ctx.model = ct_arena_create()) && (s->ctx.scratch = ct_arena_create()) ? 0
                                                                                           : -1;
}

static inline int destroy(void **state)
{
    struct bench *s = *state;
    ct_arena_destroy(s->ctx.model);
    ct_arena_destroy(s->ctx.scratch);
    free(s);
    return 0;
}

#endif
