// See guard.h.
#include "base/guard.h"

#include <stdlib.h>

static _Thread_local struct ct_guard *innermost;
static _Thread_local long fail_after;

void ct_guard_push(struct ct_guard *g)
{
    g->outer = innermost;
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

void ct_guard_fail_after(long n)
{
    fail_after = n;
}

int ct_guard_must_fail(void)
{
    return fail_after > 0 && --fail_after == 0;
}
