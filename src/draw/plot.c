// Outputs over time as a picture: a panel for each unit, one axis of time.
#include "component/roundoff.h"
#include "draw/canvas.h"
#include "draw/dimension.h"
#include "system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// [px]
// Layout: of the picture
enum { LEFT = 78, TOP = 36, WIDTH = 600, HEIGHT = 190, GAP = 26, BOTTOM = 52, LEGEND = 30 };
enum { MOST_NAME = 220, SMALL = 12, LINE = 17 };

struct ct_plot {
    struct ct_ctx own;
    const struct ct_system *system;
    const char *columns; // as requested
    size_t *column;      // indices of results
    size_t ncolumn;
    double *row; // t, then the columns
    size_t nrow, row_cap;
};

// ---- columns -------------------------------------------------------------------------------

// The column named at the beginning of text, up to a comma or its end: names may contain
// commas.
static bool match(const struct ct_equations *e, const char *text, size_t *column,
                  size_t *length)
{
    *length = 0;
    for (size_t i = 0; i < e->nresult; i++) {
        const size_t n = strlen(e->result[i].name);
        if (n > *length && strncmp(text, e->result[i].name, n) == 0
            && (!text[n] || text[n] == ',')) {
            *column = i;
            *length = n;
        }
    }
    return *length > 0;
}

static bool unknown_column(struct ct_plot *p, const char *text)
{
    const struct ct_equations *e = &p->system->equations;
    const char **names = CT_NEWN(p->own.scratch, const char *, e->nresult + 1);
    for (size_t i = 0; i < e->nresult; i++)
        names[i] = e->result[i].name;
    const char *name = ct_arena_strndup(p->own.scratch, text, strcspn(text, ","));
    return ct_error(&p->own, (struct ct_mark){0}, CT_E_USAGE, "there is no column '%s'%s", name,
                    ct_suggest_or_list(p->own.scratch, name, names, e->nresult));
}

static bool find_columns(void *task)
{
    struct ct_plot *p = task;
    const struct ct_equations *e = &p->system->equations;
    size_t cap = 0;
    if (!e->nresult)
        return ct_error(&p->own, (struct ct_mark){.file = p->system->model.file}, CT_E_USAGE,
                        "there is nothing to plot: the model lists no 'outputs'");
    for (size_t i = 0; i < e->nresult && !p->columns; i++)
        CT_PUSH(p->own.model, p->column, p->ncolumn, cap, i);
    for (const char *text = p->columns; text;) {
        size_t i = 0, n;
        text += strspn(text, " ");
        if (!match(e, text, &i, &n))
            return unknown_column(p, text);
        CT_PUSH(p->own.model, p->column, p->ncolumn, cap, i);
        text = text[n] ? text + n + 1 : NULL;
    }
    return true;
}

struct ct_plot *ct_plot_create(struct ct_ctx *ctx, struct ct_system *sys, const char *columns)
{
    struct ct_plot *p = sys ? ct_own_alloc(ctx, sizeof *p) : NULL;
    if (!p)
        return NULL;
    p->system = sys;
    p->columns = columns;
    if (ct_own_enter(ctx, &p->own, find_columns, p))
        return p;
    ct_plot_destroy(p);
    return NULL;
}

void ct_plot_destroy(struct ct_plot *plot)
{
    if (plot)
        ct_own_finish(&plot->own);
    free(plot);
}

bool ct_plot_row(void *plot, double t, const double *value, size_t n)
{
    struct ct_plot *p = plot;
    (void)n;
    if (!p || !value)
        return true;
    CT_PUSH(p->own.model, p->row, p->nrow, p->row_cap, t);
    for (size_t k = 0; k < p->ncolumn; k++)
        CT_PUSH(p->own.model, p->row, p->nrow, p->row_cap, value[p->column[k]]);
    return true;
}

// ---- axes ----------------------------------------------------------------------------------

// Values from low to high, ticks at whole multiples of `step`, labels in units of 10^exponent.
struct axis {
    double low, high, step;
    int exponent;
    double from, to; // [px]
};

// About `count` ticks at 1, 2 or 5 times a power of ten; both ends are ticks if `is_whole`.
static struct axis choose_axis(double low, double high, int count, bool is_whole)
{
    static const double mantissas[] = {1, 2, 5, 10};
    const double most = fmax(fabs(low), fabs(high));
    // Layout: a smaller range would need labels of more than six digits
    const double constant = 1e-6;
    if (!(high - low > constant * most)) {
        const double margin = most > 0 ? 0.5 * most : 1;
        low -= margin;
        high += margin;
    }
    struct axis a = {.low = low, .high = high};
    const double rough = (high - low) / count, power = pow(10, floor(log10(rough)));
    size_t i = 0;
    while (i + 1 < COUNT(mantissas) && mantissas[i] * power < rough * (1 - CT_DATA_ROUNDOFF))
        i++;
    a.step = mantissas[i] * power;
    if (is_whole) {
        a.low = floor(low / a.step + CT_DATA_ROUNDOFF) * a.step;
        a.high = ceil(high / a.step - CT_DATA_ROUNDOFF) * a.step;
    }
    const double largest = fmax(fabs(a.low), fabs(a.high));
    const int digits = (int)floor(log10(largest));
    if (digits >= 4 || digits < -2)
        a.exponent = 3 * (int)floor(digits / 3.0);
    return a;
}

static double position(const struct axis *a, double v)
{
    return a->from + (v - a->low) / (a->high - a->low) * (a->to - a->from);
}

static const char *tick_name(struct ct_arena *a, const struct axis *axis, double v)
{
    const double unit = pow(10, axis->exponent), step = axis->step / unit;
    // step is 1, 2 or 5 times a power of ten: 1.5, 3 or 7.5 times it has the same whole exponent
    const int decimals = (int)fmax(0, -floor(log10(1.5 * step)));
    if (fabs(v) < axis->step / 2)
        return "0";
    const char *text = ct_arena_printf(a, "%.*f", decimals, fabs(v) / unit);
    return v < 0 ? ct_arena_printf(a, "\xe2\x88\x92%s", text) : text;
}

// "[10^-3 J]", the exponent raised.
static const char *unit_name(struct ct_arena *a, const char *unit, int exponent)
{
    static const char *const digits[]
        = {"\xe2\x81\xb0", "\xc2\xb9",     "\xc2\xb2",     "\xc2\xb3",     "\xe2\x81\xb4",
           "\xe2\x81\xb5", "\xe2\x81\xb6", "\xe2\x81\xb7", "\xe2\x81\xb8", "\xe2\x81\xb9"};
    if (!unit)
        unit = "SI";
    if (!exponent)
        return ct_arena_printf(a, "[%s]", *unit ? unit : "1");
    const char *power = "";
    for (int n = abs(exponent); n; n /= 10)
        power = ct_arena_printf(a, "%s%s", digits[n % 10], power);
    return ct_arena_printf(a, "[10%s%s%s%s]", exponent < 0 ? "\xe2\x81\xbb" : "", power,
                           *unit ? " " : "", unit);
}

// ---- panels --------------------------------------------------------------------------------

struct panel {
    const char *unit; // NULL: not known
    size_t *line;     // numbers of columns
    size_t n;
    struct axis y;
};

struct work {
    struct ct_plot *p;
    struct ct_arena *a;
    struct ct_canvas canvas;
    struct panel *panel;
    size_t npanel, nsample, width; // numbers in a row
    struct axis x;
};

static bool is_same_unit(const char *a, const char *b)
{
    return a && b ? strcmp(a, b) == 0 : a == b;
}

static void find_panels(struct work *w)
{
    const struct ct_plot *p = w->p;
    w->panel = CT_NEWN(w->a, struct panel, p->ncolumn);
    for (size_t k = 0; k < p->ncolumn; k++) {
        const char *unit = ct_result_unit(&p->system->equations, p->column[k]);
        size_t i = 0;
        while (i < w->npanel && !is_same_unit(w->panel[i].unit, unit))
            i++;
        struct panel *panel = &w->panel[i];
        if (i == w->npanel) {
            *panel = (struct panel){.unit = unit, .line = CT_NEWN(w->a, size_t, p->ncolumn)};
            w->npanel++;
        }
        panel->line[panel->n++] = k;
    }
}

static double value_at(const struct work *w, size_t sample, size_t column)
{
    return w->p->row[sample * w->width + 1 + column];
}

static void find_axes(struct work *w)
{
    const double first = w->p->row[0], last = w->p->row[(w->nsample - 1) * w->width];
    double y = TOP;
    w->x = choose_axis(first, last, 6, false);
    w->x.from = LEFT;
    w->x.to = LEFT + WIDTH;
    for (size_t i = 0; i < w->npanel; i++) {
        struct panel *panel = &w->panel[i];
        double low = INFINITY, high = -INFINITY;
        for (size_t s = 0; s < w->nsample; s++)
            for (size_t k = 0; k < panel->n; k++) {
                low = fmin(low, value_at(w, s, panel->line[k]));
                high = fmax(high, value_at(w, s, panel->line[k]));
            }
        const double height = fmax(HEIGHT, LINE * (double)panel->n + 8);
        panel->y = choose_axis(low, high, 5, true);
        panel->y.from = y + height;
        panel->y.to = y;
        y += height + GAP;
    }
}

// ---- drawing -------------------------------------------------------------------------------

static const char grid[] = "stroke=\"#dcdcdc\" stroke-width=\"8\"";

static void draw_ticks(struct work *w, const struct panel *panel, bool is_last)
{
    const struct axis *x = &w->x, *y = &panel->y;
    // Derived: eps times some million steps, relative to a step.
    const double roundoff = 1e-9;
    for (double n = ceil(x->low / x->step - roundoff);
         n * x->step <= x->high + roundoff * x->step; n++) {
        const double at = position(x, n * x->step);
        ct_canvas_line(&w->canvas, (struct ct_spot){at, y->from}, (struct ct_spot){at, y->to},
                       grid, 0);
        if (is_last)
            ct_canvas_text(&w->canvas, (struct ct_spot){at, y->from + 17}, "middle", "",
                           tick_name(w->a, x, n * x->step));
    }
    for (double n = ceil(y->low / y->step - roundoff);
         n * y->step <= y->high + roundoff * y->step; n++) {
        const double at = position(y, n * y->step);
        ct_canvas_line(&w->canvas, (struct ct_spot){x->from, at}, (struct ct_spot){x->to, at},
                       grid, 0);
        ct_canvas_text(&w->canvas, (struct ct_spot){x->from - 7, at + 4}, "end", "",
                       tick_name(w->a, y, n * y->step));
    }
}

static const char *column_name(const struct work *w, size_t column)
{
    return w->p->system->equations.result[w->p->column[column]].name;
}

// A name shortened to fit into the legend.
static const char *short_name(struct ct_arena *a, const char *name)
{
    size_t n = strlen(name);
    if (ct_canvas_text_width(name, SMALL) <= MOST_NAME)
        return name;
    for (; n > 0; n--) {
        if (((unsigned char)name[n] & 0xc0) == 0x80) // within a character
            continue;
        const char *text = ct_arena_printf(a, "%.*s\xe2\x80\xa6", (int)n, name);
        if (ct_canvas_text_width(text, SMALL) <= MOST_NAME)
            return text;
    }
    return "";
}

static void line_style(char *style, size_t size, size_t k)
{
    static const char *const dashes[]
        = {"", " stroke-dasharray=\"80 40\"", " stroke-dasharray=\"20 30\"",
           " stroke-dasharray=\"90 30 20 30\""};
    snprintf(style, size, "stroke=\"%s\" stroke-width=\"15\" fill=\"none\"%s",
             ct_palette[k % CT_NPALETTE], dashes[k / CT_NPALETTE % COUNT(dashes)]);
}

static void draw_line(struct work *w, const struct panel *panel, size_t k)
{
    // Layout: of the picture
    const double invisible = 0.1; // [px]
    const size_t column = panel->line[k];
    struct ct_spot *p = CT_NEWN(w->a, struct ct_spot, w->nsample);
    char style[128];
    for (size_t s = 0; s < w->nsample; s++)
        p[s] = (struct ct_spot){position(&w->x, w->p->row[s * w->width]),
                                position(&panel->y, value_at(w, s, column))};
    const size_t n = ct_spots_thin(w->a, p, w->nsample, invisible);
    const double y = panel->y.to + LINE * ((double)k + 0.5), x = w->x.to + 14;
    line_style(style, sizeof style, k);
    ct_canvas_open(&w->canvas, "line", column_name(w, column), "stroke-linejoin=\"round\"");
    ct_canvas_lines(&w->canvas, p, n, false, style, 0);
    ct_canvas_line(&w->canvas, (struct ct_spot){x, y}, (struct ct_spot){x + LEGEND - 6, y},
                   style, 0);
    ct_canvas_text(&w->canvas, (struct ct_spot){x + LEGEND, y + 4}, "start", "",
                   short_name(w->a, column_name(w, column)));
    ct_canvas_close(&w->canvas);
}

static void draw_panel(struct work *w, const struct panel *panel, bool is_last)
{
    const double middle = (panel->y.from + panel->y.to) / 2;
    const struct ct_spot frame[4] = {{w->x.from, panel->y.from},
                                     {w->x.to, panel->y.from},
                                     {w->x.to, panel->y.to},
                                     {w->x.from, panel->y.to}};
    const char *unit = unit_name(w->a, panel->unit, panel->y.exponent);
    if (panel->n == 1)
        unit = ct_arena_printf(w->a, "%s %s", short_name(w->a, column_name(w, panel->line[0])),
                               unit);
    draw_ticks(w, panel, is_last);
    fprintf(w->canvas.out,
            "<text transform=\"translate(%d %d) rotate(-90)\" text-anchor=\"middle\">", 190,
            (int)lround(10 * middle));
    ct_canvas_escape(w->canvas.out, unit);
    fputs("</text>\n", w->canvas.out);
    for (size_t k = 0; k < panel->n; k++)
        draw_line(w, panel, k);
    ct_canvas_lines(&w->canvas, frame, 4, true,
                    "stroke=\"#000000\" stroke-width=\"10\" fill=\"none\"", 0);
}

static double legend_width(const struct work *w)
{
    double width = 0;
    for (size_t k = 0; k < w->p->ncolumn; k++)
        width = fmax(width, ct_canvas_text_width(short_name(w->a, column_name(w, k)), SMALL));
    return width + LEGEND + 24;
}

struct writing {
    struct ct_ctx *ctx;
    struct ct_plot *p;
    const char *path;
};

static bool write_plot(void *task)
{
    const struct writing *job = task;
    struct ct_plot *p = job->p;
    struct work w = {.p = p, .a = p->own.scratch, .width = p->ncolumn + 1};
    struct ct_outfile file;
    w.nsample = p->nrow / w.width;
    if (!w.nsample)
        return ct_error(job->ctx, (struct ct_mark){0}, CT_E_USAGE,
                        "there is no sample to plot");
    find_panels(&w);
    find_axes(&w);
    if (!ct_outfile_open(job->ctx, &file, job->path))
        return false;
    const double bottom = w.panel[w.npanel - 1].y.from;
    ct_canvas_begin(&w.canvas, w.a, file.stream, LEFT + WIDTH + legend_width(&w),
                    bottom + BOTTOM, p->system->model.name);
    fprintf(file.stream, "<g font-size=\"%d\">\n", 10 * SMALL);
    ct_canvas_text(&w.canvas, (struct ct_spot){LEFT + WIDTH / 2.0, TOP - 14.0}, "middle",
                   "font-size=\"140\"", p->system->model.name);
    for (size_t i = 0; i < w.npanel; i++)
        draw_panel(&w, &w.panel[i], i + 1 == w.npanel);
    ct_canvas_text(&w.canvas, (struct ct_spot){LEFT + WIDTH / 2.0, bottom + 38}, "middle", "",
                   ct_arena_printf(w.a, "time %s", unit_name(w.a, "s", w.x.exponent)));
    fputs("</g>\n", file.stream);
    ct_canvas_end(&w.canvas);
    ct_own_next_stage(&p->own);
    return ct_outfile_close(job->ctx, &file);
}

bool ct_plot_write(struct ct_ctx *ctx, struct ct_plot *plot, const char *path)
{
    struct writing job = {ctx, plot, path};
    return plot && ct_enter(ctx, write_plot, &job);
}
