// See canvas.h.
#include "draw/canvas.h"
#include "base/pi.h"

#include <math.h>
#include <string.h>

const char *const ct_palette[]
    = {"#0072b2", "#d55e00", "#009e73", "#aa4499", "#56b4e9", "#c07800"};

// Layout: of the picture
static const double cell = 2; // [px]

// Clamps positions far outside the picture and those that are not finite.
static int tenths(double px)
{
    // Layout: of the picture
    const double far = 1e6; // [px]
    return isnan(px) ? 0 : (int)lround(10 * fmax(-far, fmin(far, px)));
}

// ---- text ----------------------------------------------------------------------------------

// Control characters are not allowed in XML.
void ct_canvas_escape(FILE *out, const char *text)
{
    for (; *text; text++)
        switch (*text) {
        case '&':
            fputs("&amp;", out);
            break;
        case '<':
            fputs("&lt;", out);
            break;
        case '>':
            fputs("&gt;", out);
            break;
        case '"':
            fputs("&quot;", out);
            break;
        default:
            if ((unsigned char)*text >= ' ' && *text != 127)
                fputc(*text, out);
            else
                fputs("\xef\xbf\xbd", out); // U+FFFD
        }
}

double ct_canvas_text_width(const char *text, double font)
{
    double em = 0;
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        if ((c & 0xc0) == 0x80) // within a character
            continue;
        em += c >= 0x80                     ? 1
            : strchr("mwMW@%", c)           ? 0.95
            : strchr("iljtfI.,:;'|!() ", c) ? 0.36
            : c >= 'A' && c <= 'Z'          ? 0.74
                                            : 0.6;
    }
    return em * font;
}

// ---- what is taken -------------------------------------------------------------------------

static void take(struct ct_canvas *c, int column, int row)
{
    if (column >= 0 && row >= 0 && column < c->ncolumn && row < c->nrow)
        c->taken[(size_t)row * (size_t)c->ncolumn + (size_t)column] = 1;
}

static int cell_of(double px)
{
    // Layout: of the picture
    const double far = 1e6;
    return (int)floor(fmax(-far, fmin(far, px)) / cell);
}

void ct_canvas_take_box(struct ct_canvas *c, struct ct_spot low, struct ct_spot high)
{
    const int x1 = cell_of(high.x), y1 = cell_of(high.y);
    for (int y = cell_of(low.y); y <= y1 && y < c->nrow; y++)
        for (int x = cell_of(low.x); x <= x1 && x < c->ncolumn; x++)
            take(c, x, y);
}

int ct_canvas_count_taken(const struct ct_canvas *c, struct ct_spot low, struct ct_spot high)
{
    int n = 0;
    if (!(low.x >= 0 && low.y >= 0 && high.x <= c->width && high.y <= c->height))
        return -1;
    for (int y = cell_of(low.y); y <= cell_of(high.y) && y < c->nrow; y++)
        for (int x = cell_of(low.x); x <= cell_of(high.x) && x < c->ncolumn; x++)
            n += c->taken[(size_t)y * (size_t)c->ncolumn + (size_t)x];
    return n;
}

static void take_line(struct ct_canvas *c, struct ct_spot a, struct ct_spot b, double halo)
{
    const double length = hypot(b.x - a.x, b.y - a.y);
    const int n = (int)fmin(ceil(length / cell), 10000) + 1;
    for (int i = 0; i <= n; i++) {
        const double s = (double)i / n;
        const struct ct_spot p = {a.x + s * (b.x - a.x), a.y + s * (b.y - a.y)};
        ct_canvas_take_box(c, (struct ct_spot){p.x - halo, p.y - halo},
                           (struct ct_spot){p.x + halo, p.y + halo});
    }
}

void ct_canvas_take_polygon(struct ct_canvas *c, const struct ct_spot *p, size_t n)
{
    double top = INFINITY, bottom = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        top = fmin(top, p[i].y);
        bottom = fmax(bottom, p[i].y);
    }
    for (int row = cell_of(fmax(top, 0)); n && row <= cell_of(bottom) && row < c->nrow; row++) {
        const double y = (row + 0.5) * cell;
        double left = INFINITY, right = -INFINITY;
        for (size_t i = 0; i < n; i++) {
            const struct ct_spot a = p[i], b = p[(i + 1) % n];
            if ((a.y <= y) == (b.y <= y))
                continue;
            const double x = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
            left = fmin(left, x);
            right = fmax(right, x);
        }
        if (left <= right)
            ct_canvas_take_box(c, (struct ct_spot){left, y}, (struct ct_spot){right, y});
    }
}

// ---- polylines -----------------------------------------------------------------------------

static double off_line(struct ct_spot a, struct ct_spot b, struct ct_spot p)
{
    const double x = b.x - a.x, y = b.y - a.y, length = hypot(x, y);
    if (length == 0)
        return hypot(p.x - a.x, p.y - a.y);
    const double across = ((p.y - a.y) * x - (p.x - a.x) * y) / length,
                 along = ((p.x - a.x) * x + (p.y - a.y) * y) / length,
                 beyond = fmax(0, fmax(-along, along - length));
    return hypot(across, beyond);
}

// The farthest point from a chord is kept, and both parts are simplified recursively. (Douglas
// and Peucker 1973)
static void keep_farthest(const struct ct_spot *p, size_t first, size_t last, double most,
                          bool *keep)
{
    double farthest = most;
    size_t at = 0;
    for (size_t i = first + 1; i < last; i++) {
        const double off = off_line(p[first], p[last], p[i]);
        if (off > farthest) {
            farthest = off;
            at = i;
        }
    }
    if (!at)
        return;
    keep[at] = true;
    keep_farthest(p, first, at, most, keep);
    keep_farthest(p, at, last, most, keep);
}

size_t ct_spots_thin(struct ct_arena *a, struct ct_spot *p, size_t n, double most)
{
    // Limit: of the stack
    enum { PIECE = 500 }; // bounds the depth of the recursion, and its cost for rough lines
    bool *keep = CT_NEWN(a, bool, n + 1);
    size_t kept = 0;
    for (size_t first = 0; first < n; first += PIECE) {
        const size_t last = first + PIECE < n ? first + PIECE : n - 1;
        keep[first] = keep[last] = true;
        keep_farthest(p, first, last, most, keep);
    }
    for (size_t i = 0; i < n; i++)
        if (keep[i])
            p[kept++] = p[i];
    return kept;
}

// ---- the file ------------------------------------------------------------------------------

void ct_canvas_begin(struct ct_canvas *c, struct ct_arena *a, FILE *out, double width,
                     double height, const char *title)
{
    *c = (struct ct_canvas){.out = out, .width = width, .height = height};
    c->ncolumn = cell_of(width) + 1;
    c->nrow = cell_of(height) + 1;
    c->taken = CT_NEWN(a, unsigned char, (size_t)c->ncolumn *(size_t)c->nrow);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
            "viewBox=\"0 0 %d %d\" font-family=\"Helvetica, Arial, 'Liberation Sans', "
            "sans-serif\" font-size=\"%d\">\n<title>",
            tenths(width) / 10, tenths(height) / 10, tenths(width), tenths(height),
            10 * CT_FONT);
    ct_canvas_escape(out, title);
    fputs("</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n", out);
}

void ct_canvas_end(struct ct_canvas *c)
{
    fputs("</svg>\n", c->out);
}

void ct_canvas_open(struct ct_canvas *c, const char *kind, const char *component,
                    const char *attributes)
{
    fprintf(c->out, "<g class=\"%s\"", kind);
    if (component) {
        fputs(" data-component=\"", c->out);
        ct_canvas_escape(c->out, component);
        fputc('"', c->out);
    }
    fprintf(c->out, "%s%s>\n", *attributes ? " " : "", attributes);
    if (component) {
        fputs("<title>", c->out);
        ct_canvas_escape(c->out, component);
        fputs("</title>\n", c->out);
    }
}

void ct_canvas_close(struct ct_canvas *c)
{
    fputs("</g>\n", c->out);
}

// Relative steps in whole tenths of a pixel: short, and errors do not accumulate.
void ct_canvas_lines(struct ct_canvas *c, const struct ct_spot *p, size_t n, bool closed,
                     const char *attributes, double halo)
{
    if (n < 2)
        return;
    int x = tenths(p[0].x), y = tenths(p[0].y);
    fprintf(c->out, "<path d=\"M%d %dl", x, y);
    const char *separator = "";
    for (size_t i = 1; i < n; i++) {
        const int dx = tenths(p[i].x) - x, dy = tenths(p[i].y) - y;
        if (dx == 0 && dy == 0 && (i + 1 < n || *separator))
            continue;
        fprintf(c->out, "%s%d %d", separator, dx, dy);
        separator = " ";
        x += dx;
        y += dy;
    }
    fprintf(c->out, "%s\"%s%s/>\n", closed ? "z" : "", *attributes ? " " : "", attributes);
    for (size_t i = 0; i + !closed < n && halo > 0; i++)
        take_line(c, p[i], p[(i + 1) % n], halo);
}

void ct_canvas_line(struct ct_canvas *c, struct ct_spot a, struct ct_spot b,
                    const char *attributes, double halo)
{
    ct_canvas_lines(c, (struct ct_spot[]){a, b}, 2, false, attributes, halo);
}

void ct_canvas_circle(struct ct_canvas *c, struct ct_spot at, double radius,
                      const char *attributes, double halo)
{
    fprintf(c->out, "<circle cx=\"%d\" cy=\"%d\" r=\"%d\"%s%s/>\n", tenths(at.x), tenths(at.y),
            tenths(radius), *attributes ? " " : "", attributes);
    const double r = radius + halo;
    if (halo > 0)
        ct_canvas_take_box(c, (struct ct_spot){at.x - r, at.y - r},
                           (struct ct_spot){at.x + r, at.y + r});
}

void ct_canvas_arc(struct ct_canvas *c, struct ct_spot at, double radius, double a, double b,
                   const char *attributes)
{
    const int r = tenths(radius);
    fprintf(c->out, "<path d=\"M%d %dA%d %d 0 %d 0 %d %d\"%s%s/>\n",
            tenths(at.x + radius * cos(a)), tenths(at.y - radius * sin(a)), r, r, b - a > CT_PI,
            tenths(at.x + radius * cos(b)), tenths(at.y - radius * sin(b)),
            *attributes ? " " : "", attributes);
}

void ct_canvas_text(struct ct_canvas *c, struct ct_spot at, const char *anchor,
                    const char *attributes, const char *text)
{
    fprintf(c->out, "<text x=\"%d\" y=\"%d\" text-anchor=\"%s\"%s%s>", tenths(at.x),
            tenths(at.y), anchor, *attributes ? " " : "", attributes);
    ct_canvas_escape(c->out, text);
    fputs("</text>\n", c->out);
}
