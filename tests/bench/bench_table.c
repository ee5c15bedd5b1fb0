// See bench.h.
#include "tests/bench/bench.h"

#include <stdarg.h>
#include <stdio.h>

// What the lines below a title are about, for the table of goals.
static char context[96];

struct goal {
    char what[160], measured[32], goal[32];
    double ratio;
};
static struct goal goals[64];
static size_t ngoal;

static void keep_goal(const char *what, const char *measured, const char *goal, double ratio)
{
    if (ngoal == COUNT(goals))
        return;
    struct goal *g = &goals[ngoal++];
    while (*what == ' ')
        what++;
    snprintf(g->what, sizeof g->what, "%s%s%s", context, *context ? ": " : "", what);
    snprintf(g->measured, sizeof g->measured, "%s", measured);
    snprintf(g->goal, sizeof g->goal, "%s", goal);
    g->ratio = ratio;
}

void bench_show_goals(void)
{
    printf("\n| quantity | measured | goal | of goal |\n|---|---:|---:|---:|\n");
    for (size_t i = 0; i < ngoal; i++)
        printf("| %s | %s | %s | %.2f |\n", goals[i].what, goals[i].measured, goals[i].goal,
               goals[i].ratio);
}

static void set_context(const char *name)
{
    snprintf(context, sizeof context, "%s", name);
}

void bench_head(const char *name, const char *title)
{
    set_context(name);
    printf("\n%-58s %12s %12s %8s\n", title, "measured", "goal", "of goal");
}

// Above the lines of one model. name: what each of them is about; the title says more.
__attribute__((format(printf, 2, 3))) void bench_title(const char *name, const char *fmt, ...)
{
    va_list ap;
    set_context(name);
    putchar('\n');
    va_start(ap, fmt);
    vprintf(fmt, ap);
    va_end(ap);
    putchar('\n');
}

// A time [s], and what it should be at most; 0: no goal.
void bench_line(const char *what, double t, double goal)
{
    static const struct {
        double from, factor;
        const char *unit;
    } scale[] = {{1, 1, "s"}, {1e-3, 1e3, "ms"}, {1e-6, 1e6, "us"}, {0, 1e9, "ns"}};
    char text[2][32] = {"", "-"};
    const double value[2] = {t, goal};
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < COUNT(scale) && (k == 0 || goal > 0); i++)
            if (value[k] >= scale[i].from) {
                snprintf(text[k], sizeof text[k], "%.4g %s", scale[i].factor * value[k],
                         scale[i].unit);
                break;
            }
    printf("%-58s %12s %12s", what, text[0], text[1]);
    if (goal > 0) {
        printf(" %8.2f", t / goal);
        keep_goal(what, text[0], text[1], t / goal);
    }
    putchar('\n');
}

void bench_size(const char *what, size_t bytes)
{
    printf("%-58s %9.4g MB %12s\n", what, 1e-6 * (double)bytes, "-");
}

void bench_ratio(const char *what, double r, double goal)
{
    char text[2][32];
    snprintf(text[0], sizeof text[0], "%.3g", r);
    snprintf(text[1], sizeof text[1], "%.3g", goal);
    printf("%-58s %12s", what, text[0]);
    if (goal > 0) {
        printf(" %12s %8.2f", text[1], r / goal);
        keep_goal(what, text[0], text[1], r / goal);
    }
    putchar('\n');
}
