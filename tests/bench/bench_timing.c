// See bench.h.
#include "tests/bench/bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

double bench_sample_seconds = 2e-3;

static double read_clock(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

// Of this thread: those of a library for matrices wait for work by running.
double bench_now(void)
{
    return read_clock(CLOCK_THREAD_CPUTIME_ID);
}

// Of all threads.
double bench_now_of_all(void)
{
    return read_clock(CLOCK_PROCESS_CPUTIME_ID);
}

int bench_compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double time_of_calls(call_fn f, void *data, long n)
{
    const double start = bench_now();
    for (long i = 0; i < n; i++)
        f(data);
    return bench_now() - start;
}

// Products that wait for each other: the same time whatever is measured beside it.
static void run_reference(void *data)
{
    volatile double *v = data;
    double x = 1 + 1e-9 * *v;
    for (int i = 0; i < 4000; i++)
        x *= 0.999999;
    *v = x;
}

enum { MOST_MEASURED = 8 };

static void measure_once(const call_fn *f, void *const *data, size_t n, double *t)
{
    double sample[MOST_MEASURED + 1][NSAMPLE];
    long calls[MOST_MEASURED + 1];
    for (size_t k = 0; k < n; k++) {
        double once;
        for (calls[k] = 1;
             (once = time_of_calls(f[k], data[k], calls[k])) < bench_sample_seconds / 4;)
            calls[k] *= 2;
        calls[k] = (long)ceil((double)calls[k] * bench_sample_seconds / once);
    }
    for (int repeat = 0; repeat < NREPEAT; repeat++) {
        for (int i = 0; i < NSAMPLE; i++)
            for (size_t k = 0; k < n; k++)
                sample[k][i] = time_of_calls(f[k], data[k], calls[k]) / (double)calls[k];
        for (size_t k = 0; k < n; k++) {
            qsort(sample[k], NSAMPLE, sizeof sample[k][0], bench_compare_doubles);
            const double median = sample[k][NSAMPLE / 2];
            t[k] = repeat && t[k] < median ? t[k] : median;
        }
    }
}

// Seconds per call of each of n functions, sampled in turn.
void bench_measure(const call_fn *f, void *const *data, size_t n, double *t)
{
    enum { MOST_TRIES = 4 };
    static double reference = INFINITY; // the least so far
    const double slower = 1.15; // clocks that change speed, and samples that differ, stay below
    call_fn all[MOST_MEASURED + 1];
    void *of_all[MOST_MEASURED + 1];
    double time[MOST_MEASURED + 1] = {0}, one = 0;
    memcpy(all, f, n * sizeof *f);
    memcpy(of_all, data, n * sizeof *data);
    all[n] = run_reference;
    of_all[n] = &one;
    for (int i = 0; i < MOST_TRIES; i++) {
        measure_once(all, of_all, n + 1, time);
        for (size_t k = 0; k < n; k++)
            t[k] = i && t[k] < time[k] ? t[k] : time[k];
        reference = fmin(reference, time[n]);
        if (time[n] <= slower * reference)
            return;
    }
    printf("  (the machine was slow: the reference took %.2f of its time)\n",
           time[n] / reference);
}
