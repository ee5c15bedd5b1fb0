// See mode_shape_plot.h. Lengths in the file are tenths of a pixel, whole numbers: the same
// text in every locale.
#include "report/mode_shape_plot.h"

#include "report/outfile.h"
#include "report/suffix.h"

#include <math.h>

enum {
    // Layout: [0.1 px] of the picture
    COLUMNS = 3,
    SIDE = 2600,
    LEAST_HEIGHT = 700,
    GAP = 200,
    TITLE = 400,
    HEAD = 260,
    FONT = 130,
    DOT = 45
};

struct view {
    FILE *out;
    double low[2], scale; // of the points; tenths of a pixel for a metre
    double extent[2];
    int x, y, height; // of the panel
};

static void include(struct view *v, double high[2], const double *p, size_t n)
{
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 2; k++) {
            v->low[k] = fmin(v->low[k], p[2 * i + (size_t)k]);
            high[k] = fmax(high[k], p[2 * i + (size_t)k]);
        }
}

static int across(const struct view *v, const double *p)
{
    return v->x + (int)lround(SIDE / 2.0 + (p[0] - v->low[0] - v->extent[0] / 2) * v->scale);
}

static int down(const struct view *v, const double *p)
{
    return v->y
         + (int)lround(v->height / 2.0 - (p[1] - v->low[1] - v->extent[1] / 2) * v->scale);
}

static void print_escaped(FILE *out, const char *text)
{
    for (; *text; text++)
        if (*text == '&')
            fputs("&amp;", out);
        else if (*text == '<')
            fputs("&lt;", out);
        else if ((unsigned char)*text >= ' ')
            fputc(*text, out);
}

static void draw_skeleton(const struct view *v, const double *p, const struct ct_bone *bone,
                          size_t nbone, const char *colour)
{
    static const int width[]
        = {[CT_BONE_BODY] = 36, [CT_BONE_JOINT] = 14, [CT_BONE_FORCE] = 12};
    fprintf(v->out, "<g stroke=\"%s\" fill=\"%s\" stroke-linecap=\"round\">\n", colour, colour);
    for (size_t i = 0; i < nbone; i++) {
        const double *a = p + 2 * bone[i].from, *b = p + 2 * bone[i].to;
        const int x0 = across(v, a), y0 = down(v, a), x1 = across(v, b), y1 = down(v, b);
        if (x0 != x1 || y0 != y1)
            fprintf(v->out,
                    "<line x1=\"%d\" y1=\"%d\" x2=\"%d\" y2=\"%d\" stroke-width=\"%d\"%s/>\n",
                    x0, y0, x1, y1, width[bone[i].kind],
                    bone[i].kind == CT_BONE_FORCE ? " stroke-dasharray=\"40 40\"" : "");
        if (bone[i].kind == CT_BONE_JOINT)
            fprintf(v->out, "<circle cx=\"%d\" cy=\"%d\" r=\"%d\" stroke=\"none\"/>\n", x1, y1,
                    DOT);
    }
    fputs("</g>\n", v->out);
}

static void print_title(const struct view *v, int x, int y, const char *text)
{
    fprintf(v->out, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">", x, y);
    print_escaped(v->out, text);
    fputs("</text>\n", v->out);
}

bool ct_shapes_draw(struct ct_ctx *ctx, const char *path, const char *title,
                    const struct ct_shape_panel *panel, size_t npanel, const double *rest,
                    size_t npoint, const struct ct_bone *bone, size_t nbone)
{
    struct ct_outfile file;
    enum ct_suffix unused;
    if (!ct_suffix_read(ctx, path, CT_SUFFIX_SVG, &unused)
        || !ct_outfile_open(ctx, &file, path))
        return false;
    struct view v = {.out = file.stream, .low = {INFINITY, INFINITY}};
    double high[2] = {-INFINITY, -INFINITY};
    include(&v, high, rest, npoint);
    for (size_t i = 0; i < npanel; i++)
        include(&v, high, panel[i].point, npoint);
    double size = 0;
    for (int k = 0; k < 2; k++) {
        v.extent[k] = high[k] - v.low[k];
        size = fmax(size, v.extent[k]);
    }
    v.scale = size > 0 ? (SIDE - 2 * GAP) / size : 1;
    v.height = (int)fmax(LEAST_HEIGHT, ceil(v.extent[1] * v.scale) + 2 * GAP);
    const int columns = npanel < COLUMNS ? (int)npanel : COLUMNS;
    const int rows = columns ? ((int)npanel + columns - 1) / columns : 0;
    const int width = columns * SIDE + 2 * GAP,
              height = TITLE + rows * (v.height + HEAD) + TITLE;
    fprintf(v.out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
            "viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" font-size=\"%d\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#ffffff\"/>\n",
            width / 10, height / 10, width, height, FONT);
    print_title(&v, width / 2, TITLE / 2, title);
    for (size_t i = 0; i < npanel; i++) {
        const int row = (int)i / columns, column = (int)i % columns;
        v.x = GAP + column * SIDE;
        v.y = TITLE + row * (v.height + HEAD) + HEAD;
        print_title(&v, v.x + SIDE / 2, v.y - FONT / 2, panel[i].title);
        draw_skeleton(&v, rest, bone, nbone, "#c0c0c0");
        draw_skeleton(&v, panel[i].point, bone, nbone, "#0072b2");
    }
    print_title(&v, width / 2, height - TITLE / 2, "grey: at rest; blue: the mode, enlarged");
    fputs("</svg>\n", v.out);
    return ct_outfile_close(ctx, &file);
}
