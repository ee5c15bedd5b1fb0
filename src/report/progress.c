// See progress.h.
#include "report/progress.h"

#include <unistd.h>

void ct_progress_init(struct ct_progress *p, FILE *out, const char *label)
{
    const int fd = fileno(out); // -1 for a stream in memory
    *p = (struct ct_progress){out, label, fd >= 0 && isatty(fd), -1};
}

void ct_progress_update(struct ct_progress *p, double fraction)
{
    if (!p->is_visible || fraction != fraction)
        return;
    const double f = fraction < 0 ? 0 : fraction > 1 ? 1 : fraction;
    const int percent = (int)(100 * f);
    if (percent == p->percent)
        return;
    p->percent = percent;
    fprintf(p->out, "\r%s [", p->label);
    for (int i = 0; i < 20; i++)
        fputc(5 * (i + 1) <= percent ? '#' : '.', p->out);
    fprintf(p->out, "] %3d %%", percent);
    fflush(p->out);
}

void ct_progress_finish(struct ct_progress *p)
{
    if (!p->is_visible || p->percent < 0)
        return;
    fputs("\r\033[K", p->out); // back to the first column, erase to the end of the line
    fflush(p->out);
    p->percent = -1;
}
