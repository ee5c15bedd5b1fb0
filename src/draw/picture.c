// See picture.h. Order from back to front: paths, ground, shapes, bodies, springs and loads,
// joints, names. Axes, gravity and the scale are in the strip below.
#include "draw/sketch.h"

#include <string.h>

// ---- names ---------------------------------------------------------------------------------

static void add_label(struct ct_sketch *d, const char *name, const char *attributes,
                      double font, double away, const struct ct_spot *position, size_t n)
{
    struct ct_label l = {.text = name,
                         .component = name,
                         .attributes = attributes,
                         .font = font,
                         .away = away,
                         .n = n};
    struct ct_spot *copy = CT_NEWN(d->a, struct ct_spot, n);
    memcpy(copy, position, n * sizeof *position);
    l.position = copy;
    CT_PUSH(d->a, d->label, d->nlabel, d->label_cap, l);
}

static void label_body(struct ct_sketch *d, int body)
{
    static const double share[] = {0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8};
    const struct ct_outline *o = &d->outline[body];
    const struct ct_body *m = &d->s->model->body[body];
    const int beam = d->s->body[body].beam;
    struct ct_spot position[COUNT(share)];
    size_t n = 0;
    double away = ct_sketch_body_width(d) / 2 + 3;
    if (ct_sketch_has_shape(d, body)) {
        for (; n < COUNT(d->edge[body]); n++)
            position[n] = d->edge[body][n];
    } else if (beam >= 0) {
        const struct ct_scene_beam *b = &d->s->beam[beam];
        for (; n < COUNT(share); n++)
            position[n] = ct_sketch_spot(d, d->value + b->first
                                                + 3 * (size_t)(share[n] * (b->npoint - 1)));
    } else if (o->n > 1) {
        for (; n < COUNT(share); n++)
            position[n] = ct_sketch_between(o->p[0], o->p[1], share[n]);
    } else {
        position[n++] = ct_sketch_frame_spot(d, m->frame);
        away = 2 * d->pen.size;
    }
    const char *attributes
        = ct_arena_printf(d->a, "class=\"name\" fill=\"%s\" font-size=\"%d\"",
                          ct_sketch_color_of(body), 10 * CT_FONT);
    add_label(d, m->instance.name, attributes, CT_FONT, away, position, n);
}

// Names: bodies first, then joints, springs and loads.
static void write_names(struct ct_sketch *d)
{
    // Layout: of the picture
    enum { SMALL = 11 };
    const struct ct_model *m = d->s->model;
    const char *attributes = ct_arena_printf(
        d->a, "class=\"name\" fill=\"#404040\" font-style=\"italic\" font-size=\"%d\"",
        10 * SMALL);
    for (size_t i = 1; i < m->nbody; i++)
        label_body(d, (int)i);
    for (size_t i = 0; i < m->njoint; i++)
        if (ct_sketch_is_seen(&d->s->joint[i])) {
            const struct ct_spot at = ct_sketch_joint_spot(d, i);
            add_label(d, m->joint[i].name, attributes, SMALL, 1.6 * d->pen.size + 2, &at, 1);
        }
    for (size_t i = 0; i < m->nforce; i++) {
        const struct ct_scene_force *f = &d->s->force[i];
        const struct ct_spot to = ct_sketch_frame_spot(d, f->to);
        if (f->from < 0 && !ct_sketch_acts(d, f))
            continue;
        const struct ct_spot at
            = f->from < 0 ? to : ct_sketch_between(ct_sketch_frame_spot(d, f->from), to, 0.5);
        add_label(d, m->force[i].name, attributes, SMALL, 2 * d->pen.size, &at, 1);
    }
    ct_canvas_open(&d->canvas, "names", NULL, "");
    ct_labels_write(&d->canvas, d->label, d->nlabel);
    ct_canvas_close(&d->canvas);
}

// ---- below: axes, gravity, scale -----------------------------------------------------------

static void draw_axes(struct ct_sketch *d, struct ct_spot at)
{
    static const char *const names[] = {"x", "y", "z"};
    // Layout: of the picture
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

static void draw_gravity(struct ct_sketch *d, struct ct_spot at)
{
    const double *g = d->s->gravity, size = ct_sketch_size_of(g), half = 18, seen = 0.05;
    if (size == 0)
        return;
    const struct ct_spot p = ct_view_across(&d->view, g);
    const double length = hypot(p.x, p.y) / size;
    ct_canvas_open(&d->canvas, "gravity", "gravity", "font-style=\"italic\"");
    if (length > seen) {
        const struct ct_spot v = {p.x / (size * length), p.y / (size * length)};
        ct_draw_arrow(&d->pen, (struct ct_spot){at.x - half * v.x, at.y - half * v.y},
                      (struct ct_spot){at.x + half * v.x, at.y + half * v.y}, "#000000", 1.6);
    } else { // along the viewing direction: a dot towards the viewer, a cross away
        // Layout: of the picture
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

// The longest round length of at most this width.
static void draw_scale(struct ct_sketch *d, double right, double y)
{
    static const double mantissas[] = {5, 2, 1};
    // Layout: of the picture
    const double most = 110, scale = d->view.scale * d->view.shortening; // [px], [px/m]
    const int exponent = (int)floor(log10(most / scale));
    double mantissa = 1;
    for (size_t i = COUNT(mantissas); i-- > 0;)
        if (mantissas[i] * pow(10, exponent) * scale <= most)
            mantissa = mantissas[i];
    // Layout: of the picture
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

static void draw_strip(struct ct_sketch *d)
{
    const double y = d->canvas.height - CT_STRIP;
    draw_axes(d, (struct ct_spot){46, y + 44});
    draw_gravity(d, (struct ct_spot){118, y + 38});
    draw_scale(d, d->canvas.width - 24, y + 44);
}

// ---- all of it -----------------------------------------------------------------------------

static void draw_all(struct ct_sketch *d)
{
    ct_sketch_draw_paths(d);
    ct_sketch_draw_supports(d);
    ct_sketch_draw_shapes(d);
    ct_sketch_draw_bodies(d);
    ct_sketch_draw_forces(d);
    ct_sketch_draw_joints(d);
    ct_canvas_take_box(&d->canvas, (struct ct_spot){0, d->canvas.height - CT_STRIP},
                       (struct ct_spot){d->canvas.width, d->canvas.height});
    write_names(d);
    draw_strip(d);
}

void ct_picture_print(FILE *out, struct ct_arena *a, const struct ct_picture *p)
{
    struct ct_sketch d
        = {.a = a, .picture = p, .s = p->scene, .value = p->value, .view = p->view};
    double width, height;
    ct_sketch_fit(&d, &width, &height);
    ct_canvas_begin(&d.canvas, a, out, width, height, p->title);
    d.pen = (struct ct_pen){&d.canvas, &d.view, ct_sketch_symbol_size(&d)};
    ct_sketch_find_blocks(&d);
    ct_sketch_find_outlines(&d);
    draw_all(&d);
    ct_canvas_end(&d.canvas);
}

bool ct_picture_write(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_picture *p,
                      const char *path)
{
    struct ct_outfile file;
    if (!ct_outfile_open(ctx, &file, path))
        return false;
    ct_picture_print(file.stream, a, p);
    return ct_outfile_close(ctx, &file);
}
