// See sketch.h: supports, joints, springs and loads.
#include "draw/sketch.h"

#include "component/roundoff.h"

// ---- drawing: joints and forces ------------------------------------------------------------

static void joint_axis(const struct ct_sketch *d, const struct ct_scene_joint *j, int k,
                       double out[3])
{
    ct_scene_direction(d->value, k ? j->to : j->from, j->axis[k], out);
}

// Orients a guide's direction so that its larger component is downwards or to the right.
static struct ct_spot below(struct ct_spot along)
{
    const struct ct_spot side = {-along.y, along.x};
    const bool turned
        = side.y < -CT_DATA_ROUNDOFF || (fabs(side.y) <= CT_DATA_ROUNDOFF && side.x < 0);
    return turned ? (struct ct_spot){-side.x, -side.y} : side;
}

// Are the bodies attached to a slider's block on this side of it?
static bool is_crowded(const struct ct_sketch *d, size_t i, struct ct_spot at,
                       struct ct_spot side)
{
    const struct ct_scene_joint *j = &d->s->joint[i];
    const int block = ct_sketch_body_of(d, ct_sketch_body_of(d, j->to) == 0 ? j->from : j->to);
    // Layout: of the picture
    const double clearly = 0.1;
    double most = 0, least = 0;
    for (size_t k = 0; k < d->s->model->njoint; k++) {
        const struct ct_scene_joint *other = &d->s->joint[k];
        if (k == i || other->symbol == CT_SYMBOL_NONE)
            continue;
        const int a = ct_sketch_body_of(d, other->from), b = ct_sketch_body_of(d, other->to);
        if (a != block && b != block)
            continue;
        const struct ct_spot to = ct_sketch_direction(d, a == block ? b : a, at);
        most = fmax(most, to.x * side.x + to.y * side.y);
        least = fmin(least, to.x * side.x + to.y * side.y);
    }
    return most > clearly && most > -least;
}

// The guide of a slider: hatched ground next to it, or a line of the guiding body.
static void draw_guide(struct ct_sketch *d, size_t i, struct ct_spot at)
{
    const struct ct_scene_joint *j = &d->s->joint[i];
    // Layout: of the picture
    const double s = d->pen.size, smallest = 0.05;
    double axis[3];
    joint_axis(d, j, 0, axis);
    const struct ct_spot a = ct_view_across(&d->view, axis);
    const double length = hypot(a.x, a.y);
    const bool on_ground
        = ct_sketch_body_of(d, j->from) == 0 || ct_sketch_body_of(d, j->to) == 0;
    if (length < smallest) {
        if (on_ground)
            ct_draw_ground(&d->pen, at, 1);
        return;
    }
    const struct ct_spot along = {a.x / length, a.y / length};
    struct ct_spot side = below(along);
    if (is_crowded(d, i, at, side))
        side = (struct ct_spot){-side.x, -side.y};
    if (on_ground) {
        // offset by half the block's thickness, as seen from the side
        const double off = (d->view.shortening < 1 ? 1.9 : 1.35) * s;
        const struct ct_spot foot = {at.x + off * side.x, at.y + off * side.y};
        ct_draw_wall(&d->pen, foot, (struct ct_spot){-side.x, -side.y}, 6 * s);
        return;
    }
    const int guide = ct_sketch_body_of(d, j->from);
    const struct ct_spot from = ct_sketch_frame_spot(d, j->from);
    const double over = ((at.x - from.x) * along.x + (at.y - from.y) * along.y) > 0 ? 4 : -4;
    if (ct_sketch_is_telescope(d, i)) // both bodies extend to the block
        return;
    char style[96];
    snprintf(style, sizeof style, "stroke=\"%s\" stroke-width=\"%d\" fill=\"none\"",
             ct_sketch_color_of(guide), (int)lround(10 * ct_sketch_body_width(d)));
    ct_canvas_line(&d->canvas, from,
                   (struct ct_spot){at.x + over * s * along.x, at.y + over * s * along.y},
                   style, 2);
}

static void draw_springs(struct ct_sketch *d, struct ct_spot a, struct ct_spot b, bool spring,
                         bool damper)
{
    const double least = 3 * d->pen.size, apart = spring && damper ? 1.4 * d->pen.size : 0;
    if (ct_sketch_distance(a, b) < least)
        return;
    if (apart > 0)
        for (int end = 0; end < 2; end++) {
            const struct ct_spot p = end ? b : a;
            const double length = ct_sketch_distance(a, b);
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

static void draw_joint_ground(struct ct_sketch *d, size_t i, struct ct_spot at)
{
    const struct ct_scene_joint *j = &d->s->joint[i];
    const bool at_from = ct_sketch_body_of(d, j->from) == 0;
    const int body = ct_sketch_body_of(d, at_from ? j->to : j->from);
    if ((!at_from && ct_sketch_body_of(d, j->to) != 0) || ct_sketch_slides(j->symbol))
        return;
    const struct ct_spot to_body = ct_sketch_direction(d, body, at);
    if (j->symbol == CT_SYMBOL_WELD) {
        const bool known = to_body.x != 0 || to_body.y != 0;
        ct_draw_wall(&d->pen, at, known ? to_body : (struct ct_spot){0, -1}, 4 * d->pen.size);
        return;
    }
    if (j->symbol == CT_SYMBOL_ROD)
        at = ct_sketch_frame_spot(d, at_from ? j->from : j->to);
    if (j->symbol != CT_SYMBOL_PLANAR && j->symbol != CT_SYMBOL_OTHER)
        ct_draw_ground(&d->pen, at, to_body.y > 0.5 ? -1 : 1);
}

static void draw_symbol(struct ct_sketch *d, size_t i, struct ct_spot at)
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
        ct_draw_ball(
            &d->pen, at,
            ct_sketch_direction(
                d, ct_sketch_body_of(d, ct_sketch_body_of(d, j->to) == 0 ? j->from : j->to),
                at));
        break;
    case CT_SYMBOL_PLANAR:
        ct_draw_plate(&d->pen, at, a);
        break;
    case CT_SYMBOL_WELD:
        if (ct_sketch_body_of(d, j->from) != 0 && ct_sketch_body_of(d, j->to) != 0)
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

static void draw_rod(struct ct_sketch *d, struct ct_spot a, struct ct_spot b)
{
    const double r = 0.6 * d->pen.size;
    ct_canvas_line(&d->canvas, a, b, "stroke=\"#000000\" stroke-width=\"16\"", 2);
    ct_canvas_circle(&d->canvas, a, r, "stroke=\"#000000\" fill=\"#ffffff\"", 2);
    ct_canvas_circle(&d->canvas, b, r, "stroke=\"#000000\" fill=\"#ffffff\"", 2);
}

static void open_joint(struct ct_sketch *d, size_t i, const char *kind)
{
    ct_canvas_open(&d->canvas, kind, d->s->joint[i].self->name,
                   "stroke-width=\"12\" stroke-linejoin=\"round\"");
}

// Grounds, guides and springs lie behind bodies, symbols before them.
void ct_sketch_draw_supports(struct ct_sketch *d)
{
    for (size_t i = 0; i < d->s->model->njoint; i++) {
        const struct ct_scene_joint *j = &d->s->joint[i];
        if (!ct_sketch_is_seen(j)
            || (!ct_sketch_slides(j->symbol) && ct_sketch_body_of(d, j->from) != 0
                && ct_sketch_body_of(d, j->to) != 0))
            continue;
        const struct ct_spot at = ct_sketch_joint_spot(d, i);
        open_joint(d, i, "support");
        draw_joint_ground(d, i, at);
        if (ct_sketch_slides(j->symbol))
            draw_guide(d, i, at);
        ct_canvas_close(&d->canvas);
    }
}

void ct_sketch_draw_joints(struct ct_sketch *d)
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
    // blocks first, so that pins on a slider are visible
    for (int is_late = 0; is_late < 2; is_late++)
        for (size_t i = 0; i < d->s->model->njoint; i++) {
            const struct ct_scene_joint *j = &d->s->joint[i];
            if (!ct_sketch_is_seen(j) || ct_sketch_slides(j->symbol) == (is_late == 1))
                continue;
            open_joint(d, i, kinds[j->symbol]);
            if (j->has_spring || j->has_damper) // a coil is drawn around the slider
                draw_springs(d, ct_sketch_frame_spot(d, j->from),
                             ct_sketch_frame_spot(d, j->to), j->has_spring,
                             j->has_damper && !j->has_spring);
            if (j->symbol == CT_SYMBOL_ROD)
                draw_rod(d, ct_sketch_frame_spot(d, j->from), ct_sketch_frame_spot(d, j->to));
            draw_symbol(d, i, ct_sketch_joint_spot(d, i));
            ct_canvas_close(&d->canvas);
        }
}

static const char load_color[] = "#b00020";

bool ct_sketch_acts(const struct ct_sketch *d, const struct ct_scene_force *f)
{
    return f->first != SIZE_MAX
        && (ct_sketch_size_of(d->value + f->first) > 0
            || ct_sketch_size_of(d->value + f->first + 3) > 0);
}

static void draw_load(struct ct_sketch *d, const struct ct_scene_force *f)
{
    const double *force = d->value + f->first, *torque = force + 3;
    const struct ct_spot at = ct_sketch_frame_spot(d, f->to);
    // Layout: of the picture
    const double arm = 44, smallest = 0.05, r = 3 * d->pen.size; // [px]
    if (ct_sketch_size_of(force) > 0) {
        const struct ct_spot p = ct_view_across(&d->view, force);
        const double length = hypot(p.x, p.y);
        if (length > smallest * ct_sketch_size_of(force)) {
            const struct ct_spot along = {p.x / length, p.y / length};
            const struct ct_spot to_body
                = ct_sketch_direction(d, ct_sketch_body_of(d, f->to), at);
            const bool pushes = along.x * to_body.x + along.y * to_body.y > 0.5;
            const double start = pushes ? -arm : 0;
            ct_draw_arrow(&d->pen,
                          (struct ct_spot){at.x + start * along.x, at.y + start * along.y},
                          (struct ct_spot){at.x + (start + arm) * along.x,
                                           at.y + (start + arm) * along.y},
                          load_color, 1.8);
        }
    }
    if (ct_sketch_size_of(torque) > 0) {
        // counterclockwise if its vector points to the viewer
        const bool ccw = ct_dot3(torque, d->view.toward) >= 0;
        // Layout: of the picture
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

void ct_sketch_draw_forces(struct ct_sketch *d)
{
    for (size_t i = 0; i < d->s->model->nforce; i++) {
        const struct ct_scene_force *f = &d->s->force[i];
        ct_canvas_open(&d->canvas, f->from < 0 ? "force" : "force spring", f->self->name, "");
        if (f->from >= 0) {
            const struct ct_spot a = ct_sketch_frame_spot(d, f->from),
                                 b = ct_sketch_frame_spot(d, f->to);
            const double length = ct_sketch_distance(a, b);
            for (int end = 0; end < 2 && length > 1; end++)
                if (ct_sketch_body_of(d, end ? f->to : f->from) == 0) {
                    const struct ct_spot p = end ? b : a, q = end ? a : b;
                    const struct ct_spot out = {(q.x - p.x) / length, (q.y - p.y) / length};
                    ct_draw_wall(&d->pen, p, out, 2.2 * d->pen.size);
                }
            draw_springs(d, a, b, f->has_spring, f->has_damper);
        } else if (ct_sketch_acts(d, f)) {
            draw_load(d, f);
        }
        ct_canvas_close(&d->canvas);
    }
}
