// Handles Ctrl-C and SIGTERM: work is cancelled and keeps its results so far.
//
//     signal --> thread: cancels the context, which ends at its next step --> files are closed
//                  `-- after 0.8 s (a long factorization, say) --> the process ends
//
// Both signals are blocked in all threads but one, which waits for them; there is no signal
// handler. A signal that the parent process has set to be ignored, as nohup does, stays
// ignored.
#include "cli/cli.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static atomic_int signal_seen;
static _Atomic(const char *) explanation;
static sigset_t waited_for, outside;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; // guards `cancelled`
static struct ct_ctx *cancelled;                         // the context that a signal cancels

static void write_text(const char *text)
{
    if (write(STDERR_FILENO, text, strlen(text)) < 0)
        return; // standard error is closed
}

// Ends the process; the main thread does so if it is done first.
static void end_process(int number)
{
    const char *what_stays = atomic_load(&explanation);
    if (isatty(STDERR_FILENO))
        write_text("\r\033[K"); // erases the progress bar
    write_text("cotree: error: interrupted");
    write_text(what_stays ? what_stays
                          : " before there were results; the same command begins anew");
    write_text(" [E005]\n");
    _exit(128 + number);
}

static void *wait_for_signal(void *unused)
{
    const struct timespec patience = {.tv_nsec = 800000000}; // of the promised second
    int number = 0;
    (void)unused;
    if (sigwait(&waited_for, &number) != 0)
        return NULL;
    atomic_store(&signal_seen, number);
    pthread_mutex_lock(&lock);
    ct_ctx_cancel(cancelled);
    pthread_mutex_unlock(&lock);
    struct timespec left = patience;
    while (nanosleep(&left, &left) != 0 && errno == EINTR)
        ;
    end_process(number);
    return NULL;
}

static void want(int number)
{
    struct sigaction before;
    if (sigaction(number, NULL, &before) == 0 && before.sa_handler != SIG_IGN)
        sigaddset(&waited_for, number);
}

void cli_interrupt_begin(void)
{
    pthread_t thread;
    sigemptyset(&waited_for);
    want(SIGINT);
    want(SIGTERM);
    pthread_sigmask(SIG_BLOCK, &waited_for, &outside);
    if (pthread_create(&thread, NULL, wait_for_signal, NULL) == 0)
        pthread_detach(thread);
    else
        // from now on they end the process at once
        pthread_sigmask(SIG_SETMASK, &outside, NULL);
}

void cli_interrupt_end(void)
{
    pthread_sigmask(SIG_SETMASK, &outside, NULL);
}

void cli_interrupt_cancels(struct ct_ctx *ctx)
{
    pthread_mutex_lock(&lock);
    cancelled = ctx;
    if (cli_is_interrupted())
        ct_ctx_cancel(ctx);
    pthread_mutex_unlock(&lock);
}

bool cli_is_interrupted(void)
{
    return atomic_load_explicit(&signal_seen, memory_order_relaxed) != 0;
}

void cli_interrupt_explain(const char *what_stays)
{
    atomic_store(&explanation, what_stays);
}

int cli_interrupt_status(int status)
{
    const int number = atomic_load(&signal_seen);
    return status && number ? 128 + number : status;
}
