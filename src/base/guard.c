// See guard.h.
#include "base/guard.h"

#include <stdlib.h>

static _Thread_local struct ct_guard *innermost;
static _Thread_local long fail_after;

void ct_guard_push(struct ct_guard *g)
{
    g->outer = innermost;
    g->interrupt = ct_guard_interrupt();
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

struct ct_interrupt ct_guard_interrupt(void)
{
    return innermost ? innermost->interrupt : (struct ct_interrupt){0};
}

bool ct_guard_is_interrupted(void)
{
    const struct ct_interrupt i = ct_guard_interrupt();
    return i.is_wanted && i.is_wanted(i.user);
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
