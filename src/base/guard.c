// See guard.h.
#include "base/guard.h"

#include <stdlib.h>

static _Thread_local struct ct_guard *innermost;
static _Thread_local long fail_after;

void ct_guard_push(struct ct_guard *g)
{
    g->outer = innermost;
    g->cancelled[0] = g->cancelled[1] = NULL;
    g->is_uninterrupted = false;
    innermost = g;
}

void ct_guard_pop(struct ct_guard *g)
{
    innermost = g->outer;
}

_Noreturn void ct_guard_raise(void)
{
    if (!innermost)
        abort();
    longjmp(innermost->env, 1);
}

static bool is_set(const atomic_bool *flag)
{
    return flag && atomic_load_explicit(flag, memory_order_relaxed);
}

bool ct_guard_is_interrupted(void)
{
    for (const struct ct_guard *g = innermost; g && !g->is_uninterrupted; g = g->outer)
        if (is_set(g->cancelled[0]) || is_set(g->cancelled[1]))
            return true;
    return false;
}

void ct_guard_poll(void)
{
    if (ct_guard_is_interrupted())
        ct_guard_raise();
}

void ct_guard_fail_after(long n)
{
    fail_after = n;
}

int ct_guard_must_fail(void)
{
    return fail_after > 0 && --fail_after == 0;
}
