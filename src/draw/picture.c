// See picture.h. From the back to the front: paths, ground, bodies, springs, joints, loads, names; below all of it the axes,
// gravity and the scale.
#include "draw/picture.h"

#include "draw/facet.h"
#include "draw/placement.h"
#include "draw/symbol.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// [px]: of the geometry at most; around it; the strip below; the whole at least
enum { MOST_WIDTH = 640, MOST_HEIGHT = 460, MARGIN = 58, STRIP = 84, LEAST_WIDTH = 400 };
enum { LEAST_HEIGHT = 60, ALONE = 120, TRIAD = 46 };

struct drawing {
    struct ct_arena *a;
    const struct ct_picture *picture;
    const struct ct_scene *s;
    const double *value;
    struct ct_view view;
    struct ct_canvas canvas;
    struct ct_pen pen;
    double size;          // of the scene [m]
    const double **block; // by body: place of the block of its telescope; NULL: it has none
    int *nseen;           // by body: ends of joints that are seen
    bool *is_on_block;    // by body: a slider's block is what is seen of it
    struct outline {      // by body: what it is drawn as where it has no shape
        struct ct_spot *p;
        size_t n;
        bool has_centre; // the body ends there
        struct ct_spot centre;
        double depth;
    } * outline;
    struct ct_label *label;
    size_t nlabel, label_cap;
    struct ct_spot (
        *edge)[4]; // by body with a shape: its uppermost, lowest, leftmost and rightmost spots
};

static const char *color_of(int body)
{
    return body == 0 ? "#606060" : ct_palette[(body - 1) % CT_NPALETTE];
}

static struct ct_spot spot(const struct drawing *d, const double place[3])
{
    return ct_view_spot(&d->view, place);
}

static struct ct_spot frame_spot(const struct drawing *d, int frame)
{
    return spot(d, ct_scene_place(d->value, frame));
}

static double distance(struct ct_spot a, struct ct_spot b)
{
    return hypot(a.x - b.x, a.y - b.y);
}

static struct ct_spot between(struct ct_spot a, struct ct_spot b, double s)
{
    return (struct ct_spot){a.x + s * (b.x - a.x), a.y + s * (b.y - a.y)};
}

// ---- how large it is --------------------------------------------------------------------------------------

struct reach {
    double low[3], high[3]; // along right, up; depth
};

static void reach_out(struct reach *r, const struct ct_view *v, const double place[3])
{
    const double at[3]
        = {ct_dot3(v->right, place), ct_dot3(v->up, place), ct_dot3(v->toward, place)};
    for (int i = 0; i < 3; i++) {
        r->low[i] = fmin(r->low[i], at[i]);
        r->high[i] = fmax(r->high[i], at[i]);
    }
}

static bool has_shape(const struct drawing *d, int body)
{
    return d->s->model->body[body].nsolid > 0;
}

// Shown where less than two places of a body are held.
static bool shows_centre(const struct drawing *d, int body)
{
    const double *c = d->s->body[body].com;
    return d->s->body[body].has_mass && ct_dot3(c, c) > 0;
}

static void reach_body(const struct drawing *d, int body, struct reach *r)
{
    const struct ct_scene_body *b = &d->s->body[body];
    const struct ct_body *m = &d->s->model->body[body];
    double place[3];
    for (int i = 0; i < b->nheld; i++)
        reach_out(r, &d->view, ct_scene_place(d->value, b->held[i]));
    if (body > 0)
        reach_out(r, &d->view, ct_scene_place(d->value, m->frame));
    if (shows_centre(d, body) && b->nheld < 3) {
        ct_scene_point(d->value, m->frame, b->com, place);
        reach_out(r, &d->view, place);
    }
    for (size_t i = 0; i < m->nsolid; i++) {
        double(*corner)[3];
        const struct ct_solid *solid = &m->solid[i];
        const size_t n = ct_solid_corners(d->a, d->s->model, solid, &corner);
        for (size_t k = 0; k < n; k++) {
            ct_solid_place(d->s, d->value, body, solid, corner[k], place);
            reach_out(r, &d->view, place);
        }
    }
}

static struct reach find_reach(const struct drawing *d)
{
    struct reach r = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    const struct ct_picture *p = d->picture;
    for (size_t i = 0; i < d->s->model->nbody; i++)
        reach_body(d, (int)i, &r);
    for (size_t i = 0; i < d->s->nbeam; i++)
        for (int k = 0; k < d->s->beam[i].npoint; k++)
            reach_out(&r, &d->view, d->value + d->s->beam[i].first + (size_t)3 * (size_t)k);
    for (size_t k = 0; k < p->npath * p->nplace; k++)
        reach_out(&r, &d->view, p->path + 3 * k);
    for (int i = 0; i < 3; i++)
        if (!(r.low[i] <= r.high[i]))
            r.low[i] = r.high[i] = 0;
    return r;
}

// Scale and place of the view; width and height of the picture.
static void fit(struct drawing *d, double *width, double *height)
{
    const struct reach r = find_reach(d);
    const double w = r.high[0] - r.low[0], h = r.high[1] - r.low[1];
    d->size = fmax(fmax(w, h), r.high[2] - r.low[2]);
    const double nothing = 1e-9 * d->size; // rounding
    d->view.scale = fmin(w > nothing ? MOST_WIDTH / w : INFINITY,
                         h > nothing ? MOST_HEIGHT / h : INFINITY);
    if (!isfinite(d->view.scale))
        d->view.scale = d->size > 0 ? ALONE / d->size : ALONE;
    *width = fmax(w * d->view.scale + 2 * MARGIN, LEAST_WIDTH);
    *height = fmax(h * d->view.scale, LEAST_HEIGHT) + 2 * MARGIN + STRIP;
    d->view.low[0] = r.low[0];
    d->view.low[1] = r.low[1];
    d->view.origin = (struct ct_spot){(*width - w * d->view.scale) / 2,
                                      (*height - STRIP + h * d->view.scale) / 2};
}

// Pins as large as fits between neighbours.
static double symbol_size(const struct drawing *d)
{
    const double largest = 7, least = 2.2, share = 0.3, same = 3; // [px]; of the distance
    double nearest = INFINITY;
    const size_t n = d->s->model->njoint;
    for (size_t i = 0; i < n && i < 500; i++)
        for (size_t k = 0; k < i; k++)
            if (d->s->joint[i].to >= 0 && d->s->joint[k].to >= 0) {
                const double x = distance(frame_spot(d, d->s->joint[i].to),
                                          frame_spot(d, d->s->joint[k].to));
                if (x > same)
                    nearest = fmin(nearest, x);
            }
    return fmax(least, fmin(largest, share * nearest));
}

// ---- joints: where their symbols are ------------------------------------------------------------------------

static int body_of(const struct drawing *d, int frame)
{
    return d->s->model->frame[frame].body;
}

static bool slides(enum ct_symbol s)
{
    return s == CT_SYMBOL_SLIDER || s == CT_SYMBOL_CYLINDRICAL || s == CT_SYMBOL_SCREW;
}

// Where something else than joint i holds a frame's place, too.
static bool is_shared(const struct drawing *d, size_t i, int frame)
{
    const double same = 1; // [px]
    for (size_t k = 0; k < d->s->model->njoint; k++)
        for (int end = 0; end < 2; end++) {
            const struct ct_scene_joint *j = &d->s->joint[k];
            const int f = end ? j->to : j->from;
            if (k != i && f >= 0 && body_of(d, f) == body_of(d, frame)
                && distance(frame_spot(d, f), frame_spot(d, frame)) < same)
                return true;
        }
    return false;
}

static bool is_telescope(const struct drawing *d, size_t i)
{
    const struct ct_scene_joint *j = &d->s->joint[i];
    const double least = 6 * d->pen.size;
    return slides(j->symbol) && body_of(d, j->from) > 0 && body_of(d, j->to) > 0
        && is_shared(d, i, j->to)
        && distance(frame_spot(d, j->from), frame_spot(d, j->to)) > least;
}

// What slides on ground is a block where it is; a telescope between two moving bodies has its block half-way.
static struct ct_spot joint_spot(const struct drawing *d, size_t i)
{
    const struct ct_scene_joint *j = &d->s->joint[i];
    const struct ct_spot from = frame_spot(d, j->from), to = frame_spot(d, j->to);
    if (!slides(j->symbol))
        return j->symbol == CT_SYMBOL_ROD ? between(from, to, 0.5) : to;
    if (body_of(d, j->to) == 0)
        return from;
    return is_telescope(d, i) ? between(from, to, 0.5) : to;
}

// Bodies of which nothing but a slider's block is seen.
static void find_blocks(struct drawing *d)
{
    d->is_on_block = CT_NEWN(d->a, bool, d->s->model->nbody);
    d->nseen = CT_NEWN(d->a, int, d->s->model->nbody);
    for (size_t i = 0; i < d->s->model->njoint; i++) {
        const struct ct_scene_joint *j = &d->s->joint[i];
        if (j->symbol == CT_SYMBOL_NONE)
            continue;
        d->nseen[body_of(d, j->from)]++;
        d->nseen[body_of(d, j->to)]++;
        if (slides(j->symbol) || j->symbol == CT_SYMBOL_PLANAR)
            d->is_on_block[body_of(d, body_of(d, j->to) == 0 ? j->from : j->to)] = true;
    }
}

// ---- what bodies are drawn as -----------------------------------------------------------------------------

static bool add_place(const struct drawing *d, struct outline *o, const double place[3],
                      const double **known, size_t *n)
{
    const double same = 1e-6 * d->size; // [m]
    for (size_t i = 0; i < *n; i++) {
        double across[3];
        for (int k = 0; k < 3; k++)
            across[k] = place[k] - known[i][k];
        if (sqrt(ct_dot3(across, across)) <= same)
            return false;
    }
    known[(*n)++] = place;
    o->p[o->n++] = spot(d, place);
    o->depth += ct_view_depth(&d->view, place);
    return true;
}

static int compare_spots(const void *p, const void *q)
{
    const struct ct_spot *a = p, *b = q;
    if (a->x != b->x)
        return a->x < b->x ? -1 : 1;
    return a->y < b->y ? -1 : a->y > b->y;
}

static double turn_of(struct ct_spot a, struct ct_spot b, struct ct_spot c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Convex hull, in place, by Andrew's monotone chain; n >= 3.
static size_t hull(struct ct_arena *a, struct ct_spot *p, size_t n)
{
    struct ct_spot *h = CT_NEWN(a, struct ct_spot, 2 * n);
    const double flat = 1; // [px^2]
    size_t k = 0;
    qsort(p, n, sizeof *p, compare_spots);
    for (size_t i = 0; i < n; h[k++] = p[i++])
        while (k >= 2 && turn_of(h[k - 2], h[k - 1], p[i]) <= flat)
            k--;
    const size_t lower = k + 1;
    for (size_t i = n - 1; i-- > 0; h[k++] = p[i])
        while (k >= lower && turn_of(h[k - 2], h[k - 1], p[i]) <= flat)
            k--;
    k -= k > 1;
    memcpy(p, h, k * sizeof *p);
    return k;
}

// Does the line from a to b, or from b to a, lead on to c?
static bool extends(const double a[3], const double b[3], const double c[3])
{
    const double straight = 0.02, beyond = 0.1; // of the distance from a to b
    double d[3], e[3], across[3];
    for (int i = 0; i < 3; i++) {
        d[i] = b[i] - a[i];
        e[i] = c[i] - a[i];
    }
    const double square = ct_dot3(d, d), part = ct_dot3(d, e) / square;
    for (int i = 0; i < 3; i++)
        across[i] = e[i] - part * d[i];
    return ct_dot3(across, across) < straight * straight * square
        && (part < -beyond || part > 1 + beyond);
}

static void find_outline(struct drawing *d, int body)
{
    const struct ct_scene_body *b = &d->s->body[body];
    struct outline *o = &d->outline[body];
    const double **known = CT_NEWN(d->a, const double *, b->nheld + 2);
    size_t n = 0;
    o->p = CT_NEWN(d->a, struct ct_spot, b->nheld + 2);
    for (int i = 0; i < b->nheld; i++)
        add_place(d, o, ct_scene_place(d->value, b->held[i]), known, &n);
    if (d->block[body])
        add_place(d, o, d->block[body], known, &n);
    if (body > 0 && o->n == 0)
        add_place(d, o, ct_scene_place(d->value, d->s->model->body[body].frame), known, &n);
    if (body > 0 && shows_centre(d, body)) {
        double *place = CT_NEWN(d->a, double, 3);
        ct_scene_point(d->value, d->s->model->body[body].frame, b->com, place);
        if (n < 2 || (n == 2 && extends(known[0], known[1], place)))
            o->has_centre = add_place(d, o, place, known, &n);
        o->centre = spot(d, place);
    }
    if (o->n)
        o->depth /= (double)o->n;
    if (o->n > 2)
        o->n = hull(d->a, o->p, o->n);
}

// Both bodies of a telescope reach to its block.
static void reach_blocks(struct drawing *d)
{
    for (size_t i = 0; i < d->s->model->njoint; i++) {
        const struct ct_scene_joint *j = &d->s->joint[i];
        if (!is_telescope(d, i))
            continue;
        double *middle = CT_NEWN(d->a, double, 3);
        for (int k = 0; k < 3; k++)
            middle[k]
                = (ct_scene_place(d->value, j->from)[k] + ct_scene_place(d->value, j->to)[k])
                / 2;
        d->block[body_of(d, j->from)] = d->block[body_of(d, j->to)] = middle;
    }
}

static void find_outlines(struct drawing *d)
{
    d->block = CT_NEWN(d->a, const double *, d->s->model->nbody);
    reach_blocks(d);
    d->outline = CT_NEWN(d->a, struct outline, d->s->model->nbody);
    for (size_t i = 0; i < d->s->model->nbody; i++)
        find_outline(d, (int)i);
}

// Direction in which a body lies as seen from a place: to the middle of what is drawn of it.
static struct ct_spot direction_to(const struct drawing *d, int body, struct ct_spot from)
{
    struct ct_spot middle = {0, 0};
    const struct outline *o = &d->outline[body];
    const int beam = d->s->body[body].beam;
    if (beam >= 0) {
        const struct ct_scene_beam *b = &d->s->beam[beam];
        middle = spot(d, d->value + b->first + (size_t)3 * (size_t)(b->npoint / 2));
    } else if (o->n) {
        for (size_t i = 0; i < o->n; i++) {
            middle.x += o->p[i].x / (double)o->n;
            middle.y += o->p[i].y / (double)o->n;
        }
    } else {
        return (struct ct_spot){0, 0};
    }
    const double x = distance(from, middle);
    return x > 1 ? (struct ct_spot){(middle.x - from.x) / x, (middle.y - from.y) / x}
                 : (struct ct_spot){0, 0};
}

// ---- drawing: paths, bodies -----------------------------------------------------------------------------------

// Points of two bodies that a joint holds together leave the same path.
static bool is_drawn_already(const struct drawing *d, size_t i)
{
    const struct ct_picture *q = d->picture;
    const double same = 0.5; // [px]
    for (size_t other = 0; other < i; other++) {
        size_t k = 0;
        while (k < q->nplace
               && distance(spot(d, q->path + 3 * (q->npath * k + i)),
                           spot(d, q->path + 3 * (q->npath * k + other)))
                      < same)
            k++;
        if (k == q->nplace)
            return true;
    }
    return false;
}

static void draw_path(struct drawing *d, size_t i)
{
    const struct ct_picture *q = d->picture;
    const double invisible = 0.15, still = 1; // [px]
    struct ct_spot *p = CT_NEWN(d->a, struct ct_spot, q->nplace);
    double moved = 0;
    for (size_t k = 0; k < q->nplace; k++) {
        p[k] = spot(d, q->path + 3 * (q->npath * k + i));
        moved = fmax(moved, distance(p[k], p[0]));
    }
    if (moved < still || is_drawn_already(d, i))
        return;
    const size_t n = ct_spots_thin(d->a, p, q->nplace, invisible);
    char style[128];
    snprintf(style, sizeof style,
             "stroke=\"%s\" stroke-width=\"9\" fill=\"none\" stroke-opacity=\"0.75\"",
             color_of(q->path_body[i]));
    ct_canvas_lines(&d->canvas, p, n, false, style, 0.5);
}

static void draw_paths(struct drawing *d)
{
    if (d->picture->nplace < 2)
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
    const double share = 0.42, dark = 0.68;
    int v[3];
    for (int k = 0; k < 3; k++)
        v[k] = (int)lround((255 - share * (255 - channel(color, k)))
                           * (dark + (1 - dark) * light));
    snprintf(out, 8, "#%02x%02x%02x", v[0] & 255, v[1] & 255, v[2] & 255);
}

static void draw_facet(struct drawing *d, const struct ct_facet *f)
{
    char fill[8], style[96];
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

static void find_edges(struct drawing *d, const struct ct_facets *f)
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

static void draw_shapes(struct drawing *d)
{
    struct ct_facets f = {.arena = d->a, .scene = d->s, .view = &d->view, .value = d->value};
    for (size_t i = 0; i < d->s->model->nbody; i++)
        ct_facets_add_body(&f, (int)i, color_of((int)i));
    if (!f.n)
        return;
    ct_facets_sort(&f);
    d->edge = ct_arena_calloc(d->a, d->s->model->nbody, sizeof *d->edge);
    find_edges(d, &f);
    for (size_t i = 0, end; i < f.n; i = end) { // a group for each run of one body's
        ct_canvas_open(&d->canvas, "body", d->s->model->body[f.facet[i].body].instance.name,
                       "stroke-linejoin=\"round\"");
        for (end = i; end < f.n && f.facet[end].body == f.facet[i].body; end++)
            draw_facet(d, &f.facet[end]);
        ct_canvas_close(&d->canvas);
    }
}

static double body_width(const struct drawing *d)
{
    return fmax(2, 0.62 * d->pen.size);
}

// A white rim tells which of two crossing lines is in front.
static void draw_body_line(struct drawing *d, const struct ct_spot *p, size_t n, bool closed,
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

// The axes of a body that nothing holds.
static void draw_triad(struct drawing *d, int frame, double length)
{
    for (int i = 0; i < 3; i++) {
        double axis[3], e[3] = {0};
        e[i] = 1;
        ct_scene_direction(d->value, frame, e, axis);
        const struct ct_spot p = ct_view_across(&d->view, axis), o = frame_spot(d, frame);
        if (hypot(p.x, p.y) > 0.1)
            ct_draw_arrow(&d->pen, o, (struct ct_spot){o.x + length * p.x, o.y + length * p.y},
                          "#404040", 1);
    }
}

static void draw_lump(struct drawing *d, int body)
{
    const struct ct_scene_body *b = &d->s->body[body];
    const struct ct_spot at = d->outline[body].p[0];
    char style[64];
    if (d->is_on_block[body])
        return;
    if (d->s->model->body[body].is_particle) {
        snprintf(style, sizeof style, "fill=\"%s\" stroke=\"#000000\"", color_of(body));
        ct_canvas_circle(&d->canvas, at, 1.5 * d->pen.size, style, 2);
        return;
    }
    if (d->nseen[body] == 0)
        draw_triad(d, d->s->model->body[body].frame, TRIAD);
    if (b->has_mass && d->nseen[body] < 2) // else it is hidden by what holds it
        ct_draw_centre(&d->pen, at, color_of(body));
}

static void draw_body(struct drawing *d, int body)
{
    const struct outline *o = &d->outline[body];
    if (o->n == 0)
        return;
    ct_canvas_open(&d->canvas, "body", d->s->model->body[body].instance.name,
                   "stroke-linejoin=\"round\" stroke-linecap=\"round\"");
    if (o->n == 1)
        draw_lump(d, body);
    else
        draw_body_line(d, o->p, o->n, o->n > 2, color_of(body), body_width(d));
    if (o->has_centre)
        ct_draw_centre(&d->pen, o->centre, color_of(body));
    ct_canvas_close(&d->canvas);
}

// A tube along the axis; what is held beside the axis hangs on a line from there.
static void draw_beam(struct drawing *d, const struct ct_scene_beam *beam)
{
    const struct ct_scene_body *b = &d->s->body[beam->body];
    const char *color = color_of(beam->body);
    const double width = body_width(d) + 2, wall = 1;
    struct ct_spot *p = CT_NEWN(d->a, struct ct_spot, beam->npoint);
    const size_t n = (size_t)beam->npoint;
    char style[96];
    for (size_t i = 0; i < n; i++)
        p[i] = spot(d, d->value + beam->first + 3 * i);
    ct_canvas_open(&d->canvas, "body beam", d->s->model->body[beam->body].instance.name,
                   "stroke-linejoin=\"round\"");
    for (int i = 0; i < b->nheld; i++) {
        const struct ct_spot at = frame_spot(d, b->held[i]);
        struct ct_spot near = p[0];
        for (size_t k = 1; k < n; k++)
            near = distance(p[k], at) < distance(near, at) ? p[k] : near;
        if (distance(near, at) > width)
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

static void draw_bodies(struct drawing *d)
{
    const size_t n = d->s->model->nbody;
    struct by_depth *o = CT_NEWN(d->a, struct by_depth, n);
    for (size_t i = 1; i < n; i++) {
        o[i] = (struct by_depth){d->outline[i].depth, (int)i};
        // those in a plane keep their order, whatever rounding says of their depths
        const double apart = 1e-6 * (d->size > 0 ? d->size : 1);
        o[i].depth = round(o[i].depth / apart);
    }
    qsort(o + 1, n - 1, sizeof *o, compare_depths);
    for (size_t i = 1; i < n; i++) {
        const int beam = d->s->body[o[i].body].beam;
        if (has_shape(d, o[i].body))
            continue;
        if (beam >= 0)
            draw_beam(d, &d->s->beam[beam]);
        else
            draw_body(d, o[i].body);
    }
}

// ---- drawing: joints and forces ----------------------------------------------------------------------------------

static void joint_axis(const struct drawing *d, const struct ct_scene_joint *j, int k,
                       double out[3])
{
    ct_scene_direction(d->value, k ? j->to : j->from, j->axis[k], out);
}

// The longer part of a guide's direction is downwards, or to the right.
static struct ct_spot below(struct ct_spot along)
{
    const struct ct_spot side = {-along.y, along.x};
    const bool turned = side.y < -1e-9 || (fabs(side.y) <= 1e-9 && side.x < 0);
    return turned ? (struct ct_spot){-side.x, -side.y} : side;
}

// Do the bodies that are jointed to a slider's block lie on this side of it?
static bool is_crowded(const struct drawing *d, size_t i, struct ct_spot at,
                       struct ct_spot side)
{
    const struct ct_scene_joint *j = &d->s->joint[i];
    const int block = body_of(d, body_of(d, j->to) == 0 ? j->from : j->to);
    const double clearly = 0.1;
    double most = 0, least = 0;
    for (size_t k = 0; k < d->s->model->njoint; k++) {
        const struct ct_scene_joint *other = &d->s->joint[k];
        if (k == i || other->symbol == CT_SYMBOL_NONE)
            continue;
        const int a = body_of(d, other->from), b = body_of(d, other->to);
        if (a != block && b != block)
            continue;
        const struct ct_spot to = direction_to(d, a == block ? b : a, at);
        most = fmax(most, to.x * side.x + to.y * side.y);
        least = fmin(least, to.x * side.x + to.y * side.y);
    }
    return most > clearly && most > -least;
}

// What a slider slides on: hatched ground beside it, or a line of the body that guides it.
static void draw_guide(struct drawing *d, size_t i, struct ct_spot at)
{
    const struct ct_scene_joint *j = &d->s->joint[i];
    const double s = d->pen.size, seen = 0.05;
    double axis[3];
    joint_axis(d, j, 0, axis);
    const struct ct_spot a = ct_view_across(&d->view, axis);
    const double length = hypot(a.x, a.y);
    const bool on_ground = body_of(d, j->from) == 0 || body_of(d, j->to) == 0;
    if (length < seen) {
        if (on_ground)
            ct_draw_ground(&d->pen, at, 1);
        return;
    }
    const struct ct_spot along = {a.x / length, a.y / length};
    struct ct_spot side = below(along);
    if (is_crowded(d, i, at, side))
        side = (struct ct_spot){-side.x, -side.y};
    if (on_ground) {
        // it lies beside the block by half the block's thickness, seen from the side
        const double off = (d->view.shortening < 1 ? 1.9 : 1.35) * s;
        const struct ct_spot foot = {at.x + off * side.x, at.y + off * side.y};
        ct_draw_wall(&d->pen, foot, (struct ct_spot){-side.x, -side.y}, 6 * s);
        return;
    }
    const int guide = body_of(d, j->from);
    const struct ct_spot from = frame_spot(d, j->from);
    const double over = ((at.x - from.x) * along.x + (at.y - from.y) * along.y) > 0 ? 4 : -4;
    if (is_telescope(d, i)) // both bodies reach to the block
        return;
    char style[96];
    snprintf(style, sizeof style, "stroke=\"%s\" stroke-width=\"%d\" fill=\"none\"",
             color_of(guide), (int)lround(10 * body_width(d)));
    ct_canvas_line(&d->canvas, from,
                   (struct ct_spot){at.x + over * s * along.x, at.y + over * s * along.y},
                   style, 2);
}

static void draw_springs(struct drawing *d, struct ct_spot a, struct ct_spot b, bool spring,
                         bool damper)
{
    const double least = 3 * d->pen.size, apart = spring && damper ? 1.4 * d->pen.size : 0;
    if (distance(a, b) < least)
        return;
    if (apart > 0)
        for (int end = 0; end < 2; end++) {
            const struct ct_spot p = end ? b : a;
            const double length = distance(a, b);
            const struct ct_spot side = {(b.y - a.y) / length, -(b.x - a.x) / length};
            ct_canvas_line(&d->canvas,
                           (struct ct_spot){p.x + apart * side.x, p.y + apart * side.y},
                           (struct ct_spot){p.x - apart * side.x, p.y - apart * side.y},
                           "stroke=\"#000000\" stroke-width=\"13\"", 1);
        }
    if (spring)
        ct_draw_spring(&d->pen, a, b, apart);
    if (damper)
        ct_draw_damper(&d->pen, a, b, -apart);
}

static void draw_joint_ground(struct drawing *d, size_t i, struct ct_spot at)
{
    const struct ct_scene_joint *j = &d->s->joint[i];
    const bool at_from = body_of(d, j->from) == 0;
    const int body = body_of(d, at_from ? j->to : j->from);
    if ((!at_from && body_of(d, j->to) != 0) || slides(j->symbol))
        return;
    const struct ct_spot to_body = direction_to(d, body, at);
    if (j->symbol == CT_SYMBOL_WELD) {
        const bool known = to_body.x != 0 || to_body.y != 0;
        ct_draw_wall(&d->pen, at, known ? to_body : (struct ct_spot){0, -1}, 4 * d->pen.size);
        return;
    }
    if (j->symbol == CT_SYMBOL_ROD)
        at = frame_spot(d, at_from ? j->from : j->to);
    if (j->symbol != CT_SYMBOL_PLANAR && j->symbol != CT_SYMBOL_OTHER)
        ct_draw_ground(&d->pen, at, to_body.y > 0.5 ? -1 : 1);
}

static void draw_symbol(struct drawing *d, size_t i, struct ct_spot at)
{
    const struct ct_scene_joint *j = &d->s->joint[i];
    double a[3] = {0, 0, 1}, b[3] = {0, 0, 1};
    if (j->naxis > 0)
        joint_axis(d, j, 0, a);
    if (j->naxis > 1)
        joint_axis(d, j, 1, b);
    switch (j->symbol) {
    case CT_SYMBOL_PIN:
        ct_draw_cylinder(&d->pen, at, a, 1.3);
        break;
    case CT_SYMBOL_SLIDER:
        ct_draw_block(&d->pen, at, a);
        break;
    case CT_SYMBOL_CYLINDRICAL:
        ct_draw_cylinder(&d->pen, at, a, 2.4);
        break;
    case CT_SYMBOL_SCREW:
        ct_draw_thread(&d->pen, at, a);
        break;
    case CT_SYMBOL_UNIVERSAL:
        ct_draw_cross(&d->pen, at, a, b);
        break;
    case CT_SYMBOL_BALL:
        ct_draw_ball(&d->pen, at,
                     direction_to(d, body_of(d, body_of(d, j->to) == 0 ? j->from : j->to), at));
        break;
    case CT_SYMBOL_PLANAR:
        ct_draw_plate(&d->pen, at, a);
        break;
    case CT_SYMBOL_WELD:
        if (body_of(d, j->from) != 0 && body_of(d, j->to) != 0)
            ct_draw_weld(&d->pen, at);
        break;
    case CT_SYMBOL_OTHER:
        ct_draw_other(&d->pen, at);
        break;
    case CT_SYMBOL_ROD:
    case CT_SYMBOL_NONE:
        break;
    }
}

static void draw_rod(struct drawing *d, struct ct_spot a, struct ct_spot b)
{
    const double r = 0.6 * d->pen.size;
    ct_canvas_line(&d->canvas, a, b, "stroke=\"#000000\" stroke-width=\"16\"", 2);
    ct_canvas_circle(&d->canvas, a, r, "stroke=\"#000000\" fill=\"#ffffff\"", 2);
    ct_canvas_circle(&d->canvas, b, r, "stroke=\"#000000\" fill=\"#ffffff\"", 2);
}

static bool is_seen(const struct ct_scene_joint *j)
{
    return j->symbol != CT_SYMBOL_NONE;
}

static void open_joint(struct drawing *d, size_t i, const char *kind)
{
    ct_canvas_open(&d->canvas, kind, d->s->joint[i].self->name,
                   "stroke-width=\"12\" stroke-linejoin=\"round\"");
}

// Grounds, guides and springs lie behind bodies, symbols before them.
static void draw_joints_behind(struct drawing *d)
{
    for (size_t i = 0; i < d->s->model->njoint; i++) {
        const struct ct_scene_joint *j = &d->s->joint[i];
        if (!is_seen(j)
            || (!slides(j->symbol) && body_of(d, j->from) != 0 && body_of(d, j->to) != 0))
            continue;
        const struct ct_spot at = joint_spot(d, i);
        open_joint(d, i, "support");
        draw_joint_ground(d, i, at);
        if (slides(j->symbol))
            draw_guide(d, i, at);
        ct_canvas_close(&d->canvas);
    }
}

static void draw_joints(struct drawing *d)
{
    static const char *const kinds[] = {[CT_SYMBOL_PIN] = "joint pin",
                                        [CT_SYMBOL_SLIDER] = "joint slider",
                                        [CT_SYMBOL_CYLINDRICAL] = "joint cylindrical",
                                        [CT_SYMBOL_SCREW] = "joint screw",
                                        [CT_SYMBOL_UNIVERSAL] = "joint universal",
                                        [CT_SYMBOL_BALL] = "joint ball",
                                        [CT_SYMBOL_PLANAR] = "joint planar",
                                        [CT_SYMBOL_WELD] = "joint weld",
                                        [CT_SYMBOL_ROD] = "joint rod",
                                        [CT_SYMBOL_OTHER] = "joint other"};
    // blocks first: what turns on a slider is seen on it
    for (int is_late = 0; is_late < 2; is_late++)
        for (size_t i = 0; i < d->s->model->njoint; i++) {
            const struct ct_scene_joint *j = &d->s->joint[i];
            if (!is_seen(j) || slides(j->symbol) == (is_late == 1))
                continue;
            open_joint(d, i, kinds[j->symbol]);
            if (j->has_spring || j->has_damper) // a coil goes around what slides in it
                draw_springs(d, frame_spot(d, j->from), frame_spot(d, j->to), j->has_spring,
                             j->has_damper && !j->has_spring);
            if (j->symbol == CT_SYMBOL_ROD)
                draw_rod(d, frame_spot(d, j->from), frame_spot(d, j->to));
            draw_symbol(d, i, joint_spot(d, i));
            ct_canvas_close(&d->canvas);
        }
}

static double size_of(const double v[3])
{
    return sqrt(ct_dot3(v, v));
}

static const char load_color[] = "#b00020";

// Is there an arrow?
static bool acts(const struct drawing *d, const struct ct_scene_force *f)
{
    return f->first != SIZE_MAX
        && (size_of(d->value + f->first) > 0 || size_of(d->value + f->first + 3) > 0);
}

static void draw_load(struct drawing *d, const struct ct_scene_force *f)
{
    const double *force = d->value + f->first, *torque = force + 3;
    const struct ct_spot at = frame_spot(d, f->to);
    const double arm = 44, seen = 0.05, r = 3 * d->pen.size; // [px]
    if (size_of(force) > 0) {
        const struct ct_spot p = ct_view_across(&d->view, force);
        const double length = hypot(p.x, p.y);
        if (length > seen * size_of(force)) {
            const struct ct_spot along = {p.x / length, p.y / length};
            const struct ct_spot to_body = direction_to(d, body_of(d, f->to), at);
            const bool pushes = along.x * to_body.x + along.y * to_body.y > 0.5;
            const double start = pushes ? -arm : 0;
            ct_draw_arrow(&d->pen,
                          (struct ct_spot){at.x + start * along.x, at.y + start * along.y},
                          (struct ct_spot){at.x + (start + arm) * along.x,
                                           at.y + (start + arm) * along.y},
                          load_color, 1.8);
        }
    }
    if (size_of(torque) > 0) {
        // counterclockwise where its vector points to the eye
        const bool ccw = ct_dot3(torque, d->view.toward) >= 0;
        const double from = -2.2, to = 2.2;
        char style[64];
        snprintf(style, sizeof style, "stroke=\"%s\" stroke-width=\"18\" fill=\"none\"",
                 load_color);
        ct_canvas_arc(&d->canvas, at, r, from, to, style);
        const double end = ccw ? to : from, back = ccw ? -0.35 : 0.35;
        ct_draw_arrow(
            &d->pen, (struct ct_spot){at.x + r * cos(end + back), at.y - r * sin(end + back)},
            (struct ct_spot){at.x + r * cos(end), at.y - r * sin(end)}, load_color, 1.8);
        ct_canvas_take_box(&d->canvas, (struct ct_spot){at.x - r, at.y - r},
                           (struct ct_spot){at.x + r, at.y + r});
    }
}

static void draw_forces(struct drawing *d)
{
    for (size_t i = 0; i < d->s->model->nforce; i++) {
        const struct ct_scene_force *f = &d->s->force[i];
        ct_canvas_open(&d->canvas, f->from < 0 ? "force" : "force spring", f->self->name, "");
        if (f->from >= 0) {
            const struct ct_spot a = frame_spot(d, f->from), b = frame_spot(d, f->to);
            const double length = distance(a, b);
            for (int end = 0; end < 2 && length > 1; end++)
                if (body_of(d, end ? f->to : f->from) == 0) {
                    const struct ct_spot p = end ? b : a, q = end ? a : b;
                    const struct ct_spot out = {(q.x - p.x) / length, (q.y - p.y) / length};
                    ct_draw_wall(&d->pen, p, out, 2.2 * d->pen.size);
                }
            draw_springs(d, a, b, f->has_spring, f->has_damper);
        } else if (acts(d, f)) {
            draw_load(d, f);
        }
        ct_canvas_close(&d->canvas);
    }
}

// ---- names -----------------------------------------------------------------------------------------------------

static void add_label(struct drawing *d, const char *name, const char *attributes, double font,
                      double away, const struct ct_spot *place, size_t n)
{
    struct ct_label l = {.text = name,
                         .component = name,
                         .attributes = attributes,
                         .font = font,
                         .away = away,
                         .n = n};
    struct ct_spot *copy = CT_NEWN(d->a, struct ct_spot, n);
    memcpy(copy, place, n * sizeof *place);
    l.place = copy;
    CT_PUSH(d->a, d->label, d->nlabel, d->label_cap, l);
}

static void label_body(struct drawing *d, int body)
{
    static const double share[] = {0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8};
    const struct outline *o = &d->outline[body];
    const struct ct_body *m = &d->s->model->body[body];
    const int beam = d->s->body[body].beam;
    struct ct_spot place[COUNT(share)];
    size_t n = 0;
    double away = body_width(d) / 2 + 3;
    if (has_shape(d, body)) {
        for (; n < COUNT(d->edge[body]); n++)
            place[n] = d->edge[body][n];
    } else if (beam >= 0) {
        const struct ct_scene_beam *b = &d->s->beam[beam];
        for (; n < COUNT(share); n++)
            place[n] = spot(d, d->value + b->first + 3 * (size_t)(share[n] * (b->npoint - 1)));
    } else if (o->n > 1) {
        for (; n < COUNT(share); n++)
            place[n] = between(o->p[0], o->p[1], share[n]);
    } else {
        place[n++] = frame_spot(d, m->frame);
        away = 2 * d->pen.size;
    }
    const char *attributes = ct_arena_printf(
        d->a, "class=\"name\" fill=\"%s\" font-size=\"%d\"", color_of(body), 10 * CT_FONT);
    add_label(d, m->instance.name, attributes, CT_FONT, away, place, n);
}

// Bodies' names first, then those of joints, springs and loads.
static void write_names(struct drawing *d)
{
    enum { SMALL = 11 };
    const struct ct_model *m = d->s->model;
    const char *attributes = ct_arena_printf(
        d->a, "class=\"name\" fill=\"#404040\" font-style=\"italic\" font-size=\"%d\"",
        10 * SMALL);
    for (size_t i = 1; i < m->nbody; i++)
        label_body(d, (int)i);
    for (size_t i = 0; i < m->njoint; i++)
        if (is_seen(&d->s->joint[i])) {
            const struct ct_spot at = joint_spot(d, i);
            add_label(d, m->joint[i].name, attributes, SMALL, 1.6 * d->pen.size + 2, &at, 1);
        }
    for (size_t i = 0; i < m->nforce; i++) {
        const struct ct_scene_force *f = &d->s->force[i];
        const struct ct_spot to = frame_spot(d, f->to);
        if (f->from < 0 && !acts(d, f))
            continue;
        const struct ct_spot at = f->from < 0 ? to : between(frame_spot(d, f->from), to, 0.5);
        add_label(d, m->force[i].name, attributes, SMALL, 2 * d->pen.size, &at, 1);
    }
    ct_canvas_open(&d->canvas, "names", NULL, "");
    ct_labels_write(&d->canvas, d->label, d->nlabel);
    ct_canvas_close(&d->canvas);
}

// ---- below: axes, gravity, scale -----------------------------------------------------------------------------------

static void draw_axes(struct drawing *d, struct ct_spot at)
{
    static const char *const names[] = {"x", "y", "z"};
    const double length = 30, beyond = 9, seen = 0.1;
    ct_canvas_open(&d->canvas, "axes", "ground", "font-size=\"120\" font-style=\"italic\"");
    for (int i = 0; i < 3; i++) {
        double e[3] = {0};
        e[i] = 1;
        const struct ct_spot p = ct_view_across(&d->view, e);
        const double size = hypot(p.x, p.y);
        if (size < seen)
            continue;
        ct_draw_arrow(&d->pen, at, (struct ct_spot){at.x + length * p.x, at.y + length * p.y},
                      "#404040", 1.1);
        ct_canvas_text(&d->canvas,
                       (struct ct_spot){at.x + length * p.x + beyond * p.x / size,
                                        at.y + length * p.y + beyond * p.y / size + 4},
                       "middle", "fill=\"#404040\"", names[i]);
    }
    ct_canvas_close(&d->canvas);
}

static void draw_gravity(struct drawing *d, struct ct_spot at)
{
    const double *g = d->s->gravity, size = size_of(g), half = 18, seen = 0.05;
    if (size == 0)
        return;
    const struct ct_spot p = ct_view_across(&d->view, g);
    const double length = hypot(p.x, p.y) / size;
    ct_canvas_open(&d->canvas, "gravity", "gravity", "font-style=\"italic\"");
    if (length > seen) {
        const struct ct_spot v = {p.x / (size * length), p.y / (size * length)};
        ct_draw_arrow(&d->pen, (struct ct_spot){at.x - half * v.x, at.y - half * v.y},
                      (struct ct_spot){at.x + half * v.x, at.y + half * v.y}, "#000000", 1.6);
    } else { // along the line of sight: a dot to the eye, a cross away from it
        const double r = 7, c = 0.7071 * r;
        ct_canvas_circle(&d->canvas, at, r,
                         "fill=\"none\" stroke=\"#000000\" stroke-width=\"12\"", 0);
        if (ct_dot3(g, d->view.toward) > 0)
            ct_canvas_circle(&d->canvas, at, 2, "fill=\"#000000\"", 0);
        for (int k = -1; k <= 1 && ct_dot3(g, d->view.toward) < 0; k += 2)
            ct_canvas_line(&d->canvas, (struct ct_spot){at.x - c, at.y - k * c},
                           (struct ct_spot){at.x + c, at.y + k * c},
                           "stroke=\"#000000\" stroke-width=\"12\"", 0);
    }
    ct_canvas_text(&d->canvas, (struct ct_spot){at.x + 10, at.y + 4}, "start", "", "g");
    ct_canvas_close(&d->canvas);
}

// "50 mm", "2 m": 1, 2 or 5 times a power of ten.
static const char *length_name(struct ct_arena *a, double mantissa, int exponent)
{
    const double micro = mantissa * pow(10, exponent + 6),
                 milli = mantissa * pow(10, exponent + 3);
    if (exponent < -3)
        return ct_arena_printf(a, "%.4g \xc2\xb5m", micro);
    if (exponent < 0)
        return ct_arena_printf(a, "%.4g mm", milli);
    if (exponent < 3)
        return ct_arena_printf(a, "%.4g m", mantissa * pow(10, exponent));
    return ct_arena_printf(a, "%.4g km", mantissa * pow(10, exponent - 3));
}

// The longest round length that is at most so wide.
static void draw_scale(struct drawing *d, double right, double y)
{
    static const double mantissas[] = {5, 2, 1};
    const double most = 110, scale = d->view.scale * d->view.shortening; // [px], [px/m]
    const int exponent = (int)floor(log10(most / scale));
    double mantissa = 1;
    for (size_t i = COUNT(mantissas); i-- > 0;)
        if (mantissas[i] * pow(10, exponent) * scale <= most)
            mantissa = mantissas[i];
    const double width = mantissa * pow(10, exponent) * scale, tick = 4;
    const struct ct_spot a = {right - width, y}, b = {right, y};
    ct_canvas_open(&d->canvas, "scale", NULL, "stroke=\"#000000\" stroke-width=\"14\"");
    ct_canvas_line(&d->canvas, a, b, "", 0);
    ct_canvas_line(&d->canvas, (struct ct_spot){a.x, y - tick}, (struct ct_spot){a.x, y + tick},
                   "", 0);
    ct_canvas_line(&d->canvas, (struct ct_spot){b.x, y - tick}, (struct ct_spot){b.x, y + tick},
                   "", 0);
    const char *name = length_name(d->a, mantissa, exponent);
    if (d->view.shortening < 1)
        name = ct_arena_printf(d->a, "%s along axes", name);
    ct_canvas_text(&d->canvas, (struct ct_spot){right, y - 10}, "end",
                   "stroke=\"none\" font-size=\"120\"", name);
    if (d->picture->caption)
        ct_canvas_text(&d->canvas, (struct ct_spot){right, y + 20}, "end",
                       "stroke=\"none\" font-size=\"120\"", d->picture->caption);
    ct_canvas_close(&d->canvas);
}

static void draw_strip(struct drawing *d)
{
    const double y = d->canvas.height - STRIP;
    draw_axes(d, (struct ct_spot){46, y + 44});
    draw_gravity(d, (struct ct_spot){118, y + 38});
    draw_scale(d, d->canvas.width - 24, y + 44);
}

// ---- all of it -------------------------------------------------------------------------------------------------------

static void draw_all(struct drawing *d)
{
    draw_paths(d);
    draw_joints_behind(d);
    draw_shapes(d);
    draw_bodies(d);
    draw_forces(d);
    draw_joints(d);
    ct_canvas_take_box(&d->canvas, (struct ct_spot){0, d->canvas.height - STRIP},
                       (struct ct_spot){d->canvas.width, d->canvas.height});
    write_names(d);
    draw_strip(d);
}

bool ct_picture_write(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_picture *p,
                      const char *path)
{
    struct drawing d = {.a = a, .picture = p, .s = p->scene, .value = p->value};
    static const char *const views[] = {"x", "y", "z", "iso"};
    if (!ct_view_choose(&d.view, p->scene, p->view))
        return ct_error(ctx, (struct ct_mark){0}, CT_E_USAGE,
                        "there is no view '%s': %s, %s, %s or %s", p->view, views[0], views[1],
                        views[2], views[3]);
    struct ct_outfile file;
    double width, height;
    fit(&d, &width, &height);
    if (!ct_outfile_open(ctx, &file, path))
        return false;
    ct_canvas_begin(&d.canvas, a, file.stream, width, height, p->title);
    d.pen = (struct ct_pen){&d.canvas, &d.view, symbol_size(&d)};
    find_blocks(&d);
    find_outlines(&d);
    draw_all(&d);
    ct_canvas_end(&d.canvas);
    return ct_outfile_close(ctx, &file);
}
