// See symbol.h.
#include "draw/symbol.h"
#include "base/pi.h"

#include <math.h>
#include <stdlib.h>

// of outlines: lines, white inside
static const char outline[] = "stroke=\"#000000\" fill=\"#ffffff\"";
static const char thin[] = "stroke=\"#000000\" fill=\"none\"";

static struct ct_spot at_plus(struct ct_spot p, double s, struct ct_spot d)
{
    return (struct ct_spot){p.x + s * d.x, p.y + s * d.y};
}

static struct ct_spot at_plus2(struct ct_spot p, double s, struct ct_spot d, double t,
                               struct ct_spot e)
{
    return at_plus(at_plus(p, s, d), t, e);
}

static double length_of(struct ct_spot d)
{
    return hypot(d.x, d.y);
}

static struct ct_spot unit(struct ct_spot d, struct ct_spot standard)
{
    // Layout: of the picture
    // below it the vector is along the viewing direction
    const double length = length_of(d), smallest = 1e-3;
    return length > smallest ? (struct ct_spot){d.x / length, d.y / length} : standard;
}

static struct ct_spot left_of(struct ct_spot d)
{
    return (struct ct_spot){d.y, -d.x};
}

// ---- joints --------------------------------------------------------------------------------

// Half an ellipse about `at`: half axes `minor` along g, `major` along f; from angle a to a + pi.
static size_t half_ellipse(struct ct_spot *p, struct ct_spot at, struct ct_spot g, double minor,
                           struct ct_spot f, double major, double a)
{
    // Layout: of the picture
    enum { N = 12 };
    for (int k = 0; k <= N; k++) {
        const double t = a + CT_PI * k / N;
        p[k] = at_plus2(at, minor * cos(t), g, major * sin(t), f);
    }
    return N + 1;
}

void ct_draw_cylinder(struct ct_pen *pen, struct ct_spot at, const double axis[3],
                      double stretch)
{
    // Layout: of the picture
    const double facing = ct_dot3(axis, pen->view->toward), r = pen->size,
                 from_end = 0.999; // a cylinder seen from its end is a circle
    if (fabs(facing) > from_end) {
        ct_canvas_circle(pen->canvas, at, r, outline, 2);
        return;
    }
    const struct ct_spot a = ct_view_across(pen->view, axis);
    const double half = (facing > 0 ? -1 : 1) * stretch * r, minor = r * fabs(facing);
    const struct ct_spot far = at_plus(at, half, a), near = at_plus(at, -half, a);
    const struct ct_spot g = unit((struct ct_spot){half * a.x, half * a.y}, a), f = left_of(g);
    struct ct_spot p[40];
    size_t n = half_ellipse(p, far, g, minor, f, r, -CT_PI / 2);
    n += half_ellipse(p + n, near, g, minor, f, r, CT_PI / 2);
    ct_canvas_lines(pen->canvas, p, n, true, outline, 2);
    ct_canvas_take_polygon(pen->canvas, p, n);
    n = half_ellipse(p, near, g, minor, f, r, -CT_PI / 2);
    n += half_ellipse(p + n, near, g, minor, f, r, CT_PI / 2);
    ct_canvas_lines(pen->canvas, p, n, true, outline, 0);
}

static void cross3(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static bool normalise(double v[3])
{
    // Layout: of the picture
    const double length = sqrt(ct_dot3(v, v)), least = 1e-3;
    for (int i = 0; i < 3 && length > least; i++)
        v[i] /= length;
    return length > least;
}

// Two unit vectors perpendicular to a unit vector n, one of them as close as possible to the
// viewing direction, or upright.
static void across(const struct ct_view *v, const double n[3], double a[3], double b[3])
{
    cross3(n, v->toward, a);
    if (!normalise(a)) {
        cross3(n, v->up, a);
        normalise(a);
    }
    cross3(n, a, b);
}

// A box of half edges h along n, a, b: the visible faces.
static void draw_box(struct ct_pen *pen, struct ct_spot at, const double n[3],
                     const double a[3], const double b[3], const double h[3])
{
    const double *axis[3] = {n, a, b};
    for (int k = 0; k < 3; k++) {
        // Layout: of the picture
        const double facing = ct_dot3(axis[k], pen->view->toward), smallest = 1e-3;
        if (fabs(facing) < smallest)
            continue;
        const double sign = facing > 0 ? 1 : -1;
        const struct ct_spot c = at_plus(at, sign * h[k], ct_view_across(pen->view, axis[k]));
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        struct ct_spot p[4];
        for (int q = 0; q < 4; q++)
            p[q] = at_plus2(c, (q == 0 || q == 3 ? -1 : 1) * h[i],
                            ct_view_across(pen->view, axis[i]), (q < 2 ? -1 : 1) * h[j],
                            ct_view_across(pen->view, axis[j]));
        ct_canvas_lines(pen->canvas, p, 4, true, outline, 2);
        ct_canvas_take_polygon(pen->canvas, p, 4);
    }
}

// Two axes of a box perpendicular to n: a is horizontal, b as close to the vertical of the view as
// possible. If n is vertical: as `across`.
static void box_axes(const struct ct_view *v, const double n[3], double a[3], double b[3])
{
    cross3(v->up, n, a);
    if (normalise(a)) {
        cross3(n, a, b);
        return;
    }
    across(v, n, a, b);
}

void ct_draw_block(struct ct_pen *pen, struct ct_spot at, const double axis[3])
{
    double a[3], b[3];
    const double s = pen->size, half[3] = {2 * s, 1.35 * s, 1.35 * s};
    if (pen->view->shortening < 1)
        box_axes(pen->view, axis, a, b);
    else
        across(pen->view, axis, a, b);
    draw_box(pen, at, axis, a, b, half);
}

void ct_draw_plate(struct ct_pen *pen, struct ct_spot at, const double normal[3])
{
    double a[3], b[3];
    const double s = pen->size, half[3] = {0.4 * s, 2 * s, 2 * s};
    box_axes(pen->view, normal, a, b);
    draw_box(pen, at, normal, a, b, half);
}

void ct_draw_thread(struct ct_pen *pen, struct ct_spot at, const double axis[3])
{
    const double s = pen->size;
    ct_draw_cylinder(pen, at, axis, 2);
    const struct ct_spot along = ct_view_across(pen->view, axis),
                         side = left_of(unit(along, (struct ct_spot){1, 0}));
    for (int k = -1; k <= 1; k++)
        ct_canvas_line(pen->canvas, at_plus2(at, (k - 0.35) * s, along, -s, side),
                       at_plus2(at, (k + 0.35) * s, along, s, side), thin, 0);
}

void ct_draw_cross(struct ct_pen *pen, struct ct_spot at, const double a[3], const double b[3])
{
    const double s = pen->size, *axis[2] = {a, b};
    ct_canvas_circle(pen->canvas, at, 1.5 * s, outline, 2);
    for (int k = 0; k < 2; k++) {
        const struct ct_spot d = ct_view_across(pen->view, axis[k]);
        ct_canvas_line(pen->canvas, at_plus(at, -1.5 * s, d), at_plus(at, 1.5 * s, d),
                       "stroke=\"#000000\" stroke-width=\"24\"", 0);
    }
}

void ct_draw_ball(struct ct_pen *pen, struct ct_spot at, struct ct_spot open)
{
    // Layout: of the picture
    const double s = pen->size, away = CT_PI + atan2(-open.y, open.x), reach = 1.9;
    ct_canvas_circle(pen->canvas, at, 1.45 * s, "fill=\"#ffffff\" stroke=\"none\"", 2);
    ct_canvas_arc(pen->canvas, at, 1.45 * s, away - reach, away + reach,
                  "stroke=\"#000000\" fill=\"none\"");
    ct_canvas_circle(pen->canvas, at, 0.85 * s, "fill=\"#000000\" stroke=\"none\"", 0);
}

void ct_draw_weld(struct ct_pen *pen, struct ct_spot at)
{
    const double h = 0.75 * pen->size;
    const struct ct_spot p[4] = {
        {at.x - h, at.y - h}, {at.x + h, at.y - h}, {at.x + h, at.y + h}, {at.x - h, at.y + h}};
    ct_canvas_lines(pen->canvas, p, 4, true, "fill=\"#000000\" stroke=\"none\"", 2);
}

void ct_draw_other(struct ct_pen *pen, struct ct_spot at)
{
    const double h = 1.5 * pen->size;
    const struct ct_spot p[4]
        = {{at.x - h, at.y}, {at.x, at.y - h}, {at.x + h, at.y}, {at.x, at.y + h}};
    ct_canvas_lines(pen->canvas, p, 4, true, outline, 2);
    ct_canvas_circle(pen->canvas, at, 0.4 * pen->size, "fill=\"#000000\" stroke=\"none\"", 0);
}

// ---- ground --------------------------------------------------------------------------------

// Hatching of a line from a to b, on the side of `behind`.
static void hatch(struct ct_pen *pen, struct ct_spot a, struct ct_spot b, struct ct_spot behind)
{
    const double gap = fmax(0.75 * pen->size, 3), depth = fmax(0.85 * pen->size, 3);
    const struct ct_spot d = {b.x - a.x, b.y - a.y};
    const double length = length_of(d);
    const struct ct_spot along = unit(d, (struct ct_spot){1, 0});
    const int n = (int)fmax(1, floor(length / gap));
    struct ct_spot box[4] = {a, b, at_plus(b, depth, behind), at_plus(a, depth, behind)};
    ct_canvas_line(pen->canvas, a, b, "stroke=\"#000000\" stroke-width=\"16\"", 2);
    for (int k = 0; k < n; k++) {
        const struct ct_spot p = at_plus(a, (k + 0.9) * length / n, along);
        ct_canvas_line(pen->canvas, p, at_plus2(p, -0.8 * depth, along, depth, behind),
                       "stroke=\"#404040\" stroke-width=\"8\"", 0);
    }
    ct_canvas_take_polygon(pen->canvas, box, 4);
    for (int k = 0; k < 4; k++) // also if it is thin
        ct_canvas_take_box(pen->canvas, box[k], box[k]);
}

void ct_draw_ground(struct ct_pen *pen, struct ct_spot at, int down)
{
    const double s = pen->size;
    const struct ct_spot foot[3] = {
        at, {at.x - 1.5 * s, at.y + 2.6 * s * down}, {at.x + 1.5 * s, at.y + 2.6 * s * down}};
    ct_canvas_lines(pen->canvas, foot, 3, true, outline, 2);
    ct_canvas_take_polygon(pen->canvas, foot, 3);
    hatch(pen, (struct ct_spot){at.x - 2.6 * s, foot[1].y},
          (struct ct_spot){at.x + 2.6 * s, foot[1].y}, (struct ct_spot){0, down});
}

void ct_draw_wall(struct ct_pen *pen, struct ct_spot at, struct ct_spot along, double half)
{
    const struct ct_spot side = left_of(along);
    hatch(pen, at_plus(at, -half, side), at_plus(at, half, side),
          (struct ct_spot){-along.x, -along.y});
}

// ---- springs and dampers -------------------------------------------------------------------

void ct_draw_spring(struct ct_pen *pen, struct ct_spot a, struct ct_spot b, double offset)
{
    // Layout: of the picture
    enum { FEWEST = 4, MOST = 16 }; // turns
    const struct ct_spot d = {b.x - a.x, b.y - a.y};
    // Layout: of the picture
    const double length = length_of(d), wide = 1.1 * pen->size, lead = 0.14, pitch = 1.7;
    const double turns = (1 - 2 * lead) * length / (pitch * wide);
    const int n = 2 * (int)fmax(FEWEST, fmin(MOST, round(turns)));
    const struct ct_spot along = unit(d, (struct ct_spot){1, 0}), side = left_of(along);
    struct ct_spot p[2 * MOST + 4];
    size_t k = 0;
    a = at_plus(a, offset, side);
    p[k++] = a;
    p[k++] = at_plus(a, lead * length, along);
    for (int i = 0; i < n; i++)
        p[k++] = at_plus2(a, (lead + (1 - 2 * lead) * (i + 0.5) / n) * length, along,
                          i % 2 ? -wide : wide, side);
    p[k++] = at_plus(a, (1 - lead) * length, along);
    p[k++] = at_plus(a, length, along);
    ct_canvas_lines(pen->canvas, p, k, false,
                    "stroke=\"#000000\" stroke-width=\"12\" fill=\"none\" "
                    "stroke-linejoin=\"round\"",
                    2);
}

void ct_draw_damper(struct ct_pen *pen, struct ct_spot a, struct ct_spot b, double offset)
{
    const struct ct_spot d = {b.x - a.x, b.y - a.y};
    const double length = length_of(d), wide = pen->size, half = fmin(1.6 * wide, 0.3 * length);
    const struct ct_spot along = unit(d, (struct ct_spot){1, 0}), side = left_of(along);
    const char *style = "stroke=\"#000000\" stroke-width=\"13\" fill=\"none\"";
    a = at_plus(a, offset, side);
    const struct ct_spot middle = at_plus(a, length / 2, along);
    const struct ct_spot cup[4] = {at_plus2(middle, half, along, wide, side),
                                   at_plus2(middle, -half, along, wide, side),
                                   at_plus2(middle, -half, along, -wide, side),
                                   at_plus2(middle, half, along, -wide, side)};
    ct_canvas_line(pen->canvas, a, at_plus(middle, -half, along), style, 2);
    ct_canvas_lines(pen->canvas, cup, 4, false, style, 2);
    ct_canvas_line(pen->canvas, at_plus2(middle, 0.3 * half, along, 0.75 * wide, side),
                   at_plus2(middle, 0.3 * half, along, -0.75 * wide, side),
                   "stroke=\"#000000\" stroke-width=\"22\"", 0);
    ct_canvas_line(pen->canvas, at_plus(middle, 0.3 * half, along), at_plus(a, length, along),
                   style, 2);
}

// ---- marks ---------------------------------------------------------------------------------

void ct_draw_centre(struct ct_pen *pen, struct ct_spot at, const char *color)
{
    const double r = 1.1 * pen->size;
    char style[64];
    snprintf(style, sizeof style, "stroke=\"%s\" stroke-width=\"12\" fill=\"#ffffff\"", color);
    ct_canvas_circle(pen->canvas, at, r, style, 2);
    for (int k = 0; k < 2; k++) {
        const int x = (int)lround(10 * at.x), y = (int)lround(10 * at.y),
                  t = (int)lround(10 * r), sign = k ? -1 : 1;
        fprintf(pen->canvas->out, "<path d=\"M%d %dh%dA%d %d 0 0 1 %d %dz\" fill=\"%s\"/>\n", x,
                y, sign * t, t, t, x, y + sign * t, color);
    }
}

void ct_draw_arrow(struct ct_pen *pen, struct ct_spot from, struct ct_spot to,
                   const char *color, double width)
{
    const struct ct_spot d
        = unit((struct ct_spot){to.x - from.x, to.y - from.y}, (struct ct_spot){0, 1}),
        side = left_of(d);
    const double head = 4 * width + 4;
    char style[96];
    snprintf(style, sizeof style, "stroke=\"%s\" stroke-width=\"%d\" fill=\"none\"", color,
             (int)lround(10 * width));
    ct_canvas_line(pen->canvas, from, at_plus(to, -0.8 * head, d), style, 2);
    const struct ct_spot p[3] = {to, at_plus2(to, -head, d, 0.38 * head, side),
                                 at_plus2(to, -head, d, -0.38 * head, side)};
    snprintf(style, sizeof style, "fill=\"%s\" stroke=\"none\"", color);
    ct_canvas_lines(pen->canvas, p, 3, true, style, 2);
}
