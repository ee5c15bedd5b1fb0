// The one non-local exit: out of memory, or interrupted.
//
// A public entry point that allocates opens a guard. Arenas jump to it when the system refuses
// memory. Guards nest; each thread has its own. Only arena.c and guard.c use longjmp.
//
// A guard also holds the flags that cancel its work: those of its context and of the enclosing
// guards. They are polled when arenas grow and once per iteration of long loops. Writers of results
// poll at accepted steps and stop without a jump.
#ifndef CT_BASE_GUARD_H
#define CT_BASE_GUARD_H

#include <setjmp.h>

#include <stdatomic.h>
#include <stdbool.h>

struct ct_guard {
    jmp_buf env;
    struct ct_guard *outer;
    const atomic_bool *cancelled[2]; // flags that cancel the work; NULL: none
    bool is_uninterrupted;           // nothing cancels it
};

void ct_guard_push(struct ct_guard *g);
void ct_guard_pop(struct ct_guard *g);
/// Jump to the innermost guard; aborts if there is none.
_Noreturn void ct_guard_raise(void);

/// Has the work been cancelled?
bool ct_guard_is_interrupted(void);
/// If the work has been cancelled, jump to the innermost guard.
void ct_guard_poll(void);

/// for (struct ct_guard g; ...) would hide the setjmp; use it as
///     struct ct_guard g;
///     ct_guard_push(&g);
///     if (setjmp(g.env)) { ct_guard_pop(&g); return report_no_memory(ctx); }
///     ... work ...
///     ct_guard_pop(&g);

/// For tests: let the n-th allocation from now fail (0: never).
void ct_guard_fail_after(long n);
/// Count one allocation; true if it is the one that must fail.
int ct_guard_must_fail(void);

#endif
