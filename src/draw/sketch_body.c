// See sketch.h: paths, shapes, bodies and beams.
#include "draw/sketch.h"

#include "draw/facet.h"

#include <stdlib.h>

// Layout: of the picture
enum { TRIAD = 46 }; // [px], axes of a free body

// ---- drawing: paths, bodies ----------------------------------------------------------------

// Points of two bodies that a joint holds together leave the same path.
static bool is_drawn_already(const struct ct_sketch *d, size_t i)
{
    const struct ct_picture *q = d->picture;
    // Layout: of the picture
    const double same = 0.5; // [px]
    for (size_t other = 0; other < i; other++) {
        size_t k = 0;
        while (k < q->nposition
               && ct_sketch_distance(ct_sketch_spot(d, q->path + 3 * (q->npath * k + i)),
                                     ct_sketch_spot(d, q->path + 3 * (q->npath * k + other)))
                      < same)
            k++;
        if (k == q->nposition)
            return true;
    }
    return false;
}

static void draw_path(struct ct_sketch *d, size_t i)
{
    const struct ct_picture *q = d->picture;
    // Layout: of the picture
    const double invisible = 0.15, still = 1; // [px]
    struct ct_spot *p = CT_NEWN(d->a, struct ct_spot, q->nposition);
    double moved = 0;
    for (size_t k = 0; k < q->nposition; k++) {
        p[k] = ct_sketch_spot(d, q->path + 3 * (q->npath * k + i));
        moved = fmax(moved, ct_sketch_distance(p[k], p[0]));
    }
    if (moved < still || is_drawn_already(d, i))
        return;
    const size_t n = ct_spots_thin(d->a, p, q->nposition, invisible);
    char style[128];
    snprintf(style, sizeof style,
             "stroke=\"%s\" stroke-width=\"9\" fill=\"none\" stroke-opacity=\"0.75\"",
             ct_sketch_color_of(q->path_body[i]));
    ct_canvas_lines(&d->canvas, p, n, false, style, 0.5);
}

void ct_sketch_draw_paths(struct ct_sketch *d)
{
    if (d->picture->nposition < 2)
        return;
    ct_canvas_open(&d->canvas, "traces", NULL, "stroke-linejoin=\"round\"");
    for (size_t i = 0; i < d->picture->npath; i++)
        draw_path(d, i);
    ct_canvas_close(&d->canvas);
}

static int channel(const char *color, int k)
{
    const char digits[3] = {color[1 + 2 * k], color[2 + 2 * k], 0};
    return (int)strtol(digits, NULL, 16);
}

// Mixed with white, then dimmed by the light.
static void tint(const char *color, double light, char out[8])
{
    // Layout: of the picture
    const double share = 0.42, dark = 0.68;
    int v[3];
    for (int k = 0; k < 3; k++)
        v[k] = (int)lround((255 - share * (255 - channel(color, k)))
                           * (dark + (1 - dark) * light));
    snprintf(out, 8, "#%02x%02x%02x", v[0] & 255, v[1] & 255, v[2] & 255);
}

static void draw_facet(struct ct_sketch *d, const struct ct_facet *f)
{
    char fill[8], style[96];
    // Layout: of the picture
    const double least = 0.3; // [px]
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < f->n; i++) {
        low[0] = fmin(low[0], f->p[i].x);
        high[0] = fmax(high[0], f->p[i].x);
        low[1] = fmin(low[1], f->p[i].y);
        high[1] = fmax(high[1], f->p[i].y);
    }
    if (high[0] - low[0] < least && high[1] - low[1] < least)
        return;
    if (f->is_open) {
        snprintf(style, sizeof style, "fill=\"none\" stroke=\"%s\" stroke-width=\"16\"",
                 f->color);
        ct_canvas_lines(&d->canvas, f->p, f->n, false, style, 2);
        return;
    }
    tint(f->color, f->light, fill);
    snprintf(style, sizeof style, "fill=\"%s\" stroke=\"%s\" stroke-width=\"3\"", fill, fill);
    ct_canvas_lines(&d->canvas, f->p, f->n, true, style, 0);
    ct_canvas_take_polygon(&d->canvas, f->p, f->n);
    for (size_t i = 0, end; i < f->n; i = end) { // runs of edges
        for (end = i; end < f->n && f->is_edge[end];)
            end++;
        if (end > i) {
            struct ct_spot *p = CT_NEWN(d->a, struct ct_spot, end - i + 1);
            for (size_t k = i; k <= end; k++)
                p[k - i] = f->p[k % f->n];
            ct_canvas_lines(&d->canvas, p, end - i + 1, false,
                            "fill=\"none\" stroke=\"#202020\" stroke-width=\"8\"", 1);
        }
        end += end == i;
    }
}

static void find_edges(struct ct_sketch *d, const struct ct_facets *f)
{
    bool *is_known = CT_NEWN(d->a, bool, d->s->model->nbody);
    for (size_t i = 0; i < f->n; i++)
        for (size_t k = 0; k < f->facet[i].n; k++) {
            const struct ct_spot p = f->facet[i].p[k];
            struct ct_spot *e = d->edge[f->facet[i].body];
            const bool is_first = !is_known[f->facet[i].body];
            is_known[f->facet[i].body] = true;
            if (is_first || p.y < e[0].y)
                e[0] = p;
            if (is_first || p.y > e[1].y)
                e[1] = p;
            if (is_first || p.x < e[2].x)
                e[2] = p;
            if (is_first || p.x > e[3].x)
                e[3] = p;
        }
}

void ct_sketch_draw_shapes(struct ct_sketch *d)
{
    struct ct_facets f = {.arena = d->a, .scene = d->s, .view = &d->view, .value = d->value};
    for (size_t i = 0; i < d->s->model->nbody; i++)
        ct_facets_add_body(&f, (int)i, ct_sketch_color_of((int)i));
    if (!f.n)
        return;
    ct_facets_sort(&f);
    d->edge = ct_arena_calloc(d->a, d->s->model->nbody, sizeof *d->edge);
    find_edges(d, &f);
    for (size_t i = 0, end; i < f.n; i = end) { // one group for consecutive facets of a body
        ct_canvas_open(&d->canvas, "body", d->s->model->body[f.facet[i].body].instance.name,
                       "stroke-linejoin=\"round\"");
        for (end = i; end < f.n && f.facet[end].body == f.facet[i].body; end++)
            draw_facet(d, &f.facet[end]);
        ct_canvas_close(&d->canvas);
    }
}

// A white rim shows which of two crossing lines is in front.
static void draw_body_line(struct ct_sketch *d, const struct ct_spot *p, size_t n, bool closed,
                           const char *color, double width)
{
    char style[128];
    snprintf(style, sizeof style, "stroke=\"#ffffff\" stroke-width=\"%d\" fill=\"none\"",
             (int)lround(10 * (width + 2.4)));
    ct_canvas_lines(&d->canvas, p, n, closed, style, 0);
    snprintf(style, sizeof style,
             closed ? "stroke=\"%s\" stroke-width=\"%d\" fill=\"%s\" fill-opacity=\"0.16\""
                    : "stroke=\"%s\" stroke-width=\"%d\" fill=\"none\"",
             color, (int)lround(10 * width), color);
    ct_canvas_lines(&d->canvas, p, n, closed, style, width / 2 + 1.5);
}

// The axes of a free body.
static void draw_triad(struct ct_sketch *d, int frame, double length)
{
    for (int i = 0; i < 3; i++) {
        double axis[3], e[3] = {0};
        e[i] = 1;
        ct_scene_direction(d->value, frame, e, axis);
        const struct ct_spot p = ct_view_across(&d->view, axis),
                             o = ct_sketch_frame_spot(d, frame);
        if (hypot(p.x, p.y) > 0.1)
            ct_draw_arrow(&d->pen, o, (struct ct_spot){o.x + length * p.x, o.y + length * p.y},
                          "#404040", 1);
    }
}

static void draw_lump(struct ct_sketch *d, int body)
{
    const struct ct_scene_body *b = &d->s->body[body];
    const struct ct_spot at = d->outline[body].p[0];
    char style[64];
    if (d->is_on_block[body])
        return;
    if (d->s->model->body[body].is_particle) {
        snprintf(style, sizeof style, "fill=\"%s\" stroke=\"#000000\"",
                 ct_sketch_color_of(body));
        ct_canvas_circle(&d->canvas, at, 1.5 * d->pen.size, style, 2);
        return;
    }
    if (d->nseen[body] == 0)
        draw_triad(d, d->s->model->body[body].frame, TRIAD);
    if (b->has_mass && d->nseen[body] < 2) // otherwise symbols of joints hide it
        ct_draw_centre(&d->pen, at, ct_sketch_color_of(body));
}

static void draw_body(struct ct_sketch *d, int body)
{
    const struct ct_outline *o = &d->outline[body];
    if (o->n == 0)
        return;
    ct_canvas_open(&d->canvas, "body", d->s->model->body[body].instance.name,
                   "stroke-linejoin=\"round\" stroke-linecap=\"round\"");
    if (o->n == 1)
        draw_lump(d, body);
    else
        draw_body_line(d, o->p, o->n, o->n > 2, ct_sketch_color_of(body),
                       ct_sketch_body_width(d));
    if (o->has_centre)
        ct_draw_centre(&d->pen, o->centre, ct_sketch_color_of(body));
    ct_canvas_close(&d->canvas);
}

// A tube along the axis of a beam, with lines to joints off the axis.
static void draw_beam(struct ct_sketch *d, const struct ct_scene_beam *beam)
{
    const struct ct_scene_body *b = &d->s->body[beam->body];
    const char *color = ct_sketch_color_of(beam->body);
    const double width = ct_sketch_body_width(d) + 2, wall = 1;
    struct ct_spot *p = CT_NEWN(d->a, struct ct_spot, beam->npoint);
    const size_t n = (size_t)beam->npoint;
    char style[96];
    for (size_t i = 0; i < n; i++)
        p[i] = ct_sketch_spot(d, d->value + beam->first + 3 * i);
    ct_canvas_open(&d->canvas, "body beam", d->s->model->body[beam->body].instance.name,
                   "stroke-linejoin=\"round\"");
    for (int i = 0; i < b->nheld; i++) {
        const struct ct_spot at = ct_sketch_frame_spot(d, b->held[i]);
        struct ct_spot near = p[0];
        for (size_t k = 1; k < n; k++)
            near = ct_sketch_distance(p[k], at) < ct_sketch_distance(near, at) ? p[k] : near;
        if (ct_sketch_distance(near, at) > width)
            draw_body_line(d, (struct ct_spot[]){near, at}, 2, false, color, wall);
    }
    draw_body_line(d, p, n, false, color, width);
    snprintf(style, sizeof style, "stroke=\"#ffffff\" stroke-width=\"%d\" fill=\"none\"",
             (int)lround(10 * (width - 2 * wall)));
    ct_canvas_lines(&d->canvas, p, n, false, style, 0);
    snprintf(style, sizeof style,
             "stroke=\"%s\" stroke-opacity=\"0.28\" stroke-width=\"%d\" fill=\"none\"", color,
             (int)lround(10 * (width - 2 * wall)));
    ct_canvas_lines(&d->canvas, p, n, false, style, 0);
    ct_canvas_close(&d->canvas);
}

struct by_depth {
    double depth;
    int body;
};

static int compare_depths(const void *p, const void *q)
{
    const struct by_depth *a = p, *b = q;
    if (a->depth != b->depth)
        return a->depth < b->depth ? -1 : 1;
    return a->body - b->body;
}

void ct_sketch_draw_bodies(struct ct_sketch *d)
{
    const size_t n = d->s->model->nbody;
    struct by_depth *o = CT_NEWN(d->a, struct by_depth, n);
    for (size_t i = 1; i < n; i++) {
        o[i] = (struct by_depth){d->outline[i].depth, (int)i};
        // at almost equal depth the order of the lines is kept, so that round-off does not
        // decide
        const double apart = CT_SKETCH_RESOLUTION * (d->size > 0 ? d->size : 1);
        o[i].depth = round(o[i].depth / apart);
    }
    qsort(o + 1, n - 1, sizeof *o, compare_depths);
    for (size_t i = 1; i < n; i++) {
        const int beam = d->s->body[o[i].body].beam;
        if (ct_sketch_has_shape(d, o[i].body))
            continue;
        if (beam >= 0)
            draw_beam(d, &d->s->beam[beam]);
        else
            draw_body(d, o[i].body);
    }
}
