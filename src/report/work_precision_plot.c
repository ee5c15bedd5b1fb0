// The work-precision plot: error against seconds, both axes logarithmic, as SVG. Lengths in the
// file are tenths of a pixel, whole numbers: the same text in every locale.
#include "report/work_precision.h"

#include "report/outfile.h"
#include "report/suffix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Layout: of a page
enum { WIDTH = 8200, HEIGHT = 5400, LEFT = 900, RIGHT = 2300, TOP = 600, BOTTOM = 800 };
enum { FONT = 130, MARK = 42 };

// Colours that stay apart without colour vision: Okabe and Ito (2008), without the yellow.
static const char *const colours[]
    = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000", "#777777"};

// An axis from 10^low to 10^high, drawn from `from` to `to`.
struct axis {
    int low, high, from, to;
};

struct canvas {
    FILE *out;
    struct axis x, y; // seconds, error
};

static bool is_drawn(const struct ct_work_precision_point *p)
{
    return isfinite(p->error) && p->error > 0 && p->seconds > 0;
}

static void widen(struct axis *a, double v)
{
    const double exponent = log10(v);
    a->low = (int)fmin(a->low, floor(exponent));
    a->high = (int)fmax(a->high, ceil(exponent));
}

static struct axis axis_over(int from, int to)
{
    return (struct axis){.low = 400, .high = -400, .from = from, .to = to}; // no value yet
}

static int position(const struct axis *a, double v)
{
    const double part = (log10(v) - a->low) / (a->high - a->low);
    return (int)lround(a->from + part * (a->to - a->from));
}

static void print_escaped(FILE *out, const char *text)
{
    for (; *text; text++)
        switch (*text) {
        case '&':
            fputs("&amp;", out);
            break;
        case '<':
            fputs("&lt;", out);
            break;
        default:
            if ((unsigned char)*text >= ' ')
                fputc(*text, out);
        }
}

static void print_text(FILE *out, int x, int y, const char *anchor, const char *text)
{
    fprintf(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"%s\">", x, y, anchor);
    print_escaped(out, text);
    fputs("</text>\n", out);
}

static void print_line(FILE *out, int x0, int y0, int x1, int y1, const char *style)
{
    fprintf(out, "<line x1=\"%d\" y1=\"%d\" x2=\"%d\" y2=\"%d\" %s/>\n", x0, y0, x1, y1, style);
}

// A power of ten, its exponent raised by hand: not every viewer knows baseline-shift.
static void print_power(FILE *out, int x, int y, const char *anchor, int exponent)
{
    fprintf(out,
            "<text x=\"%d\" y=\"%d\" text-anchor=\"%s\">10<tspan dy=\"-50\" font-size=\"%d\">"
            "%s%d</tspan></text>\n",
            x, y, anchor, FONT * 3 / 4, exponent < 0 ? "\u2212" : "", abs(exponent));
}

// ---- the frame -----------------------------------------------------------------------------

static const char thin[] = "stroke=\"#f0f0f0\" stroke-width=\"8\"";
static const char strong[] = "stroke=\"#d0d0d0\" stroke-width=\"10\"";

// Number of decades per label, for at most `most` labels.
static int label_spacing(const struct axis *a, int most)
{
    return (a->high - a->low + most - 1) / most;
}

static void draw_grid(const struct canvas *c)
{
    // Layout: of a page
    const int most_labels = 9;
    const int every_x = label_spacing(&c->x, most_labels);
    const int every_y = label_spacing(&c->y, most_labels);
    for (int e = c->x.low; e <= c->x.high; e++) {
        const bool has_label = (e - c->x.low) % every_x == 0;
        for (int k = 2; every_x == 1 && e < c->x.high && k < 10; k++) {
            const int x = position(&c->x, k * pow(10, e));
            print_line(c->out, x, c->y.from, x, c->y.to, thin);
        }
        const int x = position(&c->x, pow(10, e));
        print_line(c->out, x, c->y.from, x, c->y.to, has_label ? strong : thin);
        if (has_label)
            print_power(c->out, x, c->y.from + 200, "middle", e);
    }
    for (int e = c->y.low; e <= c->y.high; e++) {
        const bool has_label = (e - c->y.low) % every_y == 0;
        const int y = position(&c->y, pow(10, e));
        print_line(c->out, c->x.from, y, c->x.to, y, has_label ? strong : thin);
        if (has_label)
            print_power(c->out, c->x.from - 60, y + FONT / 3, "end", e);
    }
}

static void draw_frame(const struct canvas *c, const char *title)
{
    draw_grid(c);
    fprintf(c->out,
            "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" "
            "stroke=\"#404040\" stroke-width=\"10\"/>\n",
            c->x.from, c->y.to, c->x.to - c->x.from, c->y.from - c->y.to);
    print_text(c->out, (c->x.from + c->x.to) / 2, TOP - 200, "middle", title);
    print_text(c->out, (c->x.from + c->x.to) / 2, HEIGHT - 250, "middle",
               "time of integration [s]");
    fprintf(c->out,
            "<text transform=\"translate(250 %d) rotate(-90)\" text-anchor=\"middle\">"
            "relative error of the outputs</text>\n",
            (c->y.from + c->y.to) / 2);
}

// ---- the lines -----------------------------------------------------------------------------

// Shapes distinguish methods in black and white.
static void draw_mark(FILE *out, int x, int y, size_t method)
{
    // Layout: of a page
    const int r = MARK, d = MARK * 5 / 4;
    switch (method % 4) {
    case 0:
        fprintf(out, "<circle cx=\"%d\" cy=\"%d\" r=\"%d\"/>\n", x, y, r);
        return;
    case 1:
        fprintf(out, "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\"/>\n", x - r, y - r,
                2 * r, 2 * r);
        return;
    case 2:
        fprintf(out, "<path d=\"M%d %dl%d %dh%dz\"/>\n", x, y - d, d, 2 * d - r / 4, -2 * d);
        return;
    default:
        fprintf(out, "<path d=\"M%d %dl%d %dl%d %dl%d %dz\"/>\n", x, y - d, d, d, -d, d, -d,
                -d);
    }
}

static void draw_method(const struct canvas *c, const struct ct_work_precision_point *point,
                        size_t n, size_t method)
{
    const char *colour = colours[method % COUNT(colours)];
    const int y = TOP + 150 + (int)method * 220, x = c->x.to + 200;
    fprintf(c->out, "<g stroke=\"%s\" fill=\"%s\" stroke-width=\"16\">\n", colour, colour);
    fputs("<polyline fill=\"none\" points=\"", c->out);
    for (size_t i = 0; i < n; i++)
        if (is_drawn(&point[i]))
            fprintf(c->out, "%d,%d ", position(&c->x, point[i].seconds),
                    position(&c->y, point[i].error));
    fputs("\"/>\n", c->out);
    for (size_t i = 0; i < n; i++)
        if (is_drawn(&point[i]))
            draw_mark(c->out, position(&c->x, point[i].seconds),
                      position(&c->y, point[i].error), method);
    print_line(c->out, x, y, x + 300, y, "");
    draw_mark(c->out, x + 150, y, method);
    fputs("</g>\n", c->out);
    char name[80];
    ct_work_precision_name(name, sizeof name, point);
    print_text(c->out, x + 380, y + FONT / 3, "start", name);
}

// A line at an error, labelled at its end.
static void draw_level(const struct canvas *c, double error, const char *name)
{
    const int y = position(&c->y, error);
    if (!(error > 0) || y > c->y.from || y < c->y.to)
        return;
    print_line(c->out, c->x.from, y, c->x.to, y,
               "stroke=\"#404040\" stroke-width=\"10\" stroke-dasharray=\"60 40\"");
    print_text(c->out, c->x.to + 60, y + FONT / 3, "start", name);
}

static void draw_all(const struct canvas *c, const struct ct_work_precision_point *point,
                     size_t n, const struct ct_work_precision_plot *plot)
{
    draw_frame(c, plot->title);
    draw_level(c, plot->wanted, "wanted");
    draw_level(c, plot->uncertainty, "uncertainty of the reference");
    size_t method = 0;
    for (size_t i = 0, end; i < n; i = end, method++) {
        for (end = i + 1; end < n && ct_work_precision_is_alike(&point[end], &point[i]);
             end++) {
        }
        draw_method(c, point + i, end - i, method);
    }
    if (plot->best && is_drawn(plot->best))
        fprintf(c->out,
                "<circle cx=\"%d\" cy=\"%d\" r=\"%d\" fill=\"none\" stroke=\"#000000\" "
                "stroke-width=\"14\"/>\n",
                position(&c->x, plot->best->seconds), position(&c->y, plot->best->error),
                2 * MARK);
}

void ct_work_precision_print(FILE *out, const struct ct_work_precision_point *point, size_t n,
                             const struct ct_work_precision_plot *plot)
{
    struct canvas c = {
        .out = out, .x = axis_over(LEFT, WIDTH - RIGHT), .y = axis_over(HEIGHT - BOTTOM, TOP)};
    for (size_t i = 0; i < n; i++)
        if (is_drawn(&point[i])) {
            widen(&c.x, point[i].seconds);
            widen(&c.y, point[i].error);
        }
    if (c.x.low > c.x.high) { // no run came to its end: an empty frame
        widen(&c.x, 1);
        widen(&c.y, 1);
    }
    if (plot->wanted > 0)
        widen(&c.y, plot->wanted);
    c.x.high += c.x.high == c.x.low;
    c.y.high += c.y.high == c.y.low;
    fprintf(c.out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
            "viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" font-size=\"%d\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#ffffff\"/>\n",
            WIDTH / 10, HEIGHT / 10, WIDTH, HEIGHT, FONT);
    draw_all(&c, point, n, plot);
    fputs("</svg>\n", c.out);
}

bool ct_work_precision_draw(struct ct_ctx *ctx, const char *path,
                            const struct ct_work_precision_point *point, size_t n,
                            const struct ct_work_precision_plot *plot)
{
    struct ct_outfile file;
    enum ct_suffix unused;
    if (!ct_suffix_read(ctx, path, CT_SUFFIX_SVG, &unused)
        || !ct_outfile_open(ctx, &file, path))
        return false;
    ct_work_precision_print(file.stream, point, n, plot);
    return ct_outfile_close(ctx, &file);
}
