// See sketch.h: size of the picture, positions of symbols, outlines of bodies without a shape.
#include "draw/sketch.h"

#include "component/roundoff.h"
#include "draw/facet.h"

#include <stdlib.h>
#include <string.h>

// Sizes [px]: largest of the geometry; margin; strip below; smallest of the whole
enum {
    // Layout: of the picture
    MOST_WIDTH = 640,
    MOST_HEIGHT = 460,
    MARGIN = 58,
    LEAST_WIDTH = 400,
    LEAST_HEIGHT = 60,
    ALONE = 120
};

// ---- how large it is -----------------------------------------------------------------------

struct extent {
    double low[3], high[3]; // along right, up; depth
};

static void extend_to(struct extent *r, const struct ct_view *v, const double position[3])
{
    const double at[3]
        = {ct_dot3(v->right, position), ct_dot3(v->up, position), ct_dot3(v->toward, position)};
    for (int i = 0; i < 3; i++) {
        r->low[i] = fmin(r->low[i], at[i]);
        r->high[i] = fmax(r->high[i], at[i]);
    }
}

// Does the body have mass and a centre of mass away from the origin of its frame?
static bool has_offset_centre(const struct ct_sketch *d, int body)
{
    const double *c = d->s->body[body].com;
    return d->s->body[body].has_mass && ct_dot3(c, c) > 0;
}

static void extend_to_body(const struct ct_sketch *d, int body, struct extent *r)
{
    const struct ct_scene_body *b = &d->s->body[body];
    const struct ct_body *m = &d->s->model->body[body];
    double position[3];
    for (int i = 0; i < b->nheld; i++)
        extend_to(r, &d->view, ct_scene_position(d->value, b->held[i]));
    if (body > 0)
        extend_to(r, &d->view, ct_scene_position(d->value, m->frame));
    if (has_offset_centre(d, body) && b->nheld < 3) {
        ct_scene_point(d->value, m->frame, b->com, position);
        extend_to(r, &d->view, position);
    }
    for (size_t i = 0; i < m->nsolid; i++) {
        double(*corner)[3];
        const struct ct_solid *solid = &m->solid[i];
        const size_t n = ct_solid_corners(d->a, d->s->model, solid, &corner);
        for (size_t k = 0; k < n; k++) {
            ct_solid_position(d->s, d->value, body, solid, corner[k], position);
            extend_to(r, &d->view, position);
        }
    }
}

static struct extent find_extent(const struct ct_sketch *d)
{
    struct extent r = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    const struct ct_picture *p = d->picture;
    for (size_t i = 0; i < d->s->model->nbody; i++)
        extend_to_body(d, (int)i, &r);
    for (size_t i = 0; i < d->s->nbeam; i++)
        for (int k = 0; k < d->s->beam[i].npoint; k++)
            extend_to(&r, &d->view, d->value + d->s->beam[i].first + (size_t)3 * (size_t)k);
    for (size_t k = 0; k < p->npath * p->nposition; k++)
        extend_to(&r, &d->view, p->path + 3 * k);
    for (int i = 0; i < 3; i++)
        if (!(r.low[i] <= r.high[i]))
            r.low[i] = r.high[i] = 0;
    return r;
}

// Scale and position of the view; width and height of the picture.
void ct_sketch_fit(struct ct_sketch *d, double *width, double *height)
{
    const struct extent r = find_extent(d);
    const double w = r.high[0] - r.low[0], h = r.high[1] - r.low[1];
    d->size = fmax(fmax(w, h), r.high[2] - r.low[2]);
    const double nothing = CT_DATA_ROUNDOFF * d->size;
    d->view.scale = fmin(w > nothing ? MOST_WIDTH / w : INFINITY,
                         h > nothing ? MOST_HEIGHT / h : INFINITY);
    if (!isfinite(d->view.scale))
        d->view.scale = d->size > 0 ? ALONE / d->size : ALONE;
    *width = fmax(w * d->view.scale + 2 * MARGIN, LEAST_WIDTH);
    *height = fmax(h * d->view.scale, LEAST_HEIGHT) + 2 * MARGIN + CT_STRIP;
    d->view.low[0] = r.low[0];
    d->view.low[1] = r.low[1];
    d->view.origin = (struct ct_spot){(*width - w * d->view.scale) / 2,
                                      (*height - CT_STRIP + h * d->view.scale) / 2};
}

// The largest size of pins that fits between neighbours.
double ct_sketch_symbol_size(const struct ct_sketch *d)
{
    // Layout: of the picture
    const double largest = 7, least = 2.2, share = 0.3, same = 3; // [px]; of the distance
    double nearest = INFINITY;
    const size_t n = d->s->model->njoint;
    for (size_t i = 0; i < n && i < 500; i++)
        for (size_t k = 0; k < i; k++)
            if (d->s->joint[i].to >= 0 && d->s->joint[k].to >= 0) {
                const double x = ct_sketch_distance(ct_sketch_frame_spot(d, d->s->joint[i].to),
                                                    ct_sketch_frame_spot(d, d->s->joint[k].to));
                if (x > same)
                    nearest = fmin(nearest, x);
            }
    return fmax(least, fmin(largest, share * nearest));
}

// ---- joints: where their symbols are -------------------------------------------------------

// Is the position of a frame also held by something other than joint i?
static bool is_shared(const struct ct_sketch *d, size_t i, int frame)
{
    const double same = 1; // [px]
    for (size_t k = 0; k < d->s->model->njoint; k++)
        for (int end = 0; end < 2; end++) {
            const struct ct_scene_joint *j = &d->s->joint[k];
            const int f = end ? j->to : j->from;
            if (k != i && f >= 0 && ct_sketch_body_of(d, f) == ct_sketch_body_of(d, frame)
                && ct_sketch_distance(ct_sketch_frame_spot(d, f),
                                      ct_sketch_frame_spot(d, frame))
                       < same)
                return true;
        }
    return false;
}

bool ct_sketch_is_telescope(const struct ct_sketch *d, size_t i)
{
    const struct ct_scene_joint *j = &d->s->joint[i];
    const double least = 6 * d->pen.size;
    return ct_sketch_slides(j->symbol) && ct_sketch_body_of(d, j->from) > 0
        && ct_sketch_body_of(d, j->to) > 0 && is_shared(d, i, j->to)
        && ct_sketch_distance(ct_sketch_frame_spot(d, j->from), ct_sketch_frame_spot(d, j->to))
               > least;
}

// Position of a slider's block: a body that slides on ground has it at its own end; a telescope
// between two moving bodies half-way.
struct ct_spot ct_sketch_joint_spot(const struct ct_sketch *d, size_t i)
{
    const struct ct_scene_joint *j = &d->s->joint[i];
    const struct ct_spot from = ct_sketch_frame_spot(d, j->from),
                         to = ct_sketch_frame_spot(d, j->to);
    if (!ct_sketch_slides(j->symbol))
        return j->symbol == CT_SYMBOL_ROD ? ct_sketch_between(from, to, 0.5) : to;
    if (ct_sketch_body_of(d, j->to) == 0)
        return from;
    return ct_sketch_is_telescope(d, i) ? ct_sketch_between(from, to, 0.5) : to;
}

// Bodies that are visible only as a slider's block.
void ct_sketch_find_blocks(struct ct_sketch *d)
{
    d->is_on_block = CT_NEWN(d->a, bool, d->s->model->nbody);
    d->nseen = CT_NEWN(d->a, int, d->s->model->nbody);
    for (size_t i = 0; i < d->s->model->njoint; i++) {
        const struct ct_scene_joint *j = &d->s->joint[i];
        if (j->symbol == CT_SYMBOL_NONE)
            continue;
        d->nseen[ct_sketch_body_of(d, j->from)]++;
        d->nseen[ct_sketch_body_of(d, j->to)]++;
        if (ct_sketch_slides(j->symbol) || j->symbol == CT_SYMBOL_PLANAR)
            d->is_on_block[ct_sketch_body_of(d, ct_sketch_body_of(d, j->to) == 0 ? j->from
                                                                                 : j->to)]
                = true;
    }
}

// ---- what bodies are drawn as --------------------------------------------------------------

static bool add_position(const struct ct_sketch *d, struct ct_outline *o,
                         const double position[3], const double **known, size_t *n)
{
    const double same = CT_SKETCH_RESOLUTION * d->size; // [m]
    for (size_t i = 0; i < *n; i++) {
        double across[3];
        for (int k = 0; k < 3; k++)
            across[k] = position[k] - known[i][k];
        if (sqrt(ct_dot3(across, across)) <= same)
            return false;
    }
    known[(*n)++] = position;
    o->p[o->n++] = ct_sketch_spot(d, position);
    o->depth += ct_view_depth(&d->view, position);
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

// Does the line from a to b, or from b to a, extend to c?
static bool extends(const double a[3], const double b[3], const double c[3])
{
    // Layout: of the picture
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

static void find_outline(struct ct_sketch *d, int body)
{
    const struct ct_scene_body *b = &d->s->body[body];
    struct ct_outline *o = &d->outline[body];
    const double **known = CT_NEWN(d->a, const double *, b->nheld + 2);
    size_t n = 0;
    o->p = CT_NEWN(d->a, struct ct_spot, b->nheld + 2);
    for (int i = 0; i < b->nheld; i++)
        add_position(d, o, ct_scene_position(d->value, b->held[i]), known, &n);
    if (d->block[body])
        add_position(d, o, d->block[body], known, &n);
    if (body > 0 && o->n == 0)
        add_position(d, o, ct_scene_position(d->value, d->s->model->body[body].frame), known,
                     &n);
    if (body > 0 && has_offset_centre(d, body)) {
        double *position = CT_NEWN(d->a, double, 3);
        ct_scene_point(d->value, d->s->model->body[body].frame, b->com, position);
        if (n < 2 || (n == 2 && extends(known[0], known[1], position)))
            o->has_centre = add_position(d, o, position, known, &n);
        o->centre = ct_sketch_spot(d, position);
    }
    if (o->n)
        o->depth /= (double)o->n;
    if (o->n > 2)
        o->n = hull(d->a, o->p, o->n);
}

// Both bodies of a telescope extend to its block.
static void find_blocks_of_telescopes(struct ct_sketch *d)
{
    for (size_t i = 0; i < d->s->model->njoint; i++) {
        const struct ct_scene_joint *j = &d->s->joint[i];
        if (!ct_sketch_is_telescope(d, i))
            continue;
        double *middle = CT_NEWN(d->a, double, 3);
        for (int k = 0; k < 3; k++)
            middle[k] = (ct_scene_position(d->value, j->from)[k]
                         + ct_scene_position(d->value, j->to)[k])
                      / 2;
        d->block[ct_sketch_body_of(d, j->from)] = d->block[ct_sketch_body_of(d, j->to)]
            = middle;
    }
}

void ct_sketch_find_outlines(struct ct_sketch *d)
{
    d->block = CT_NEWN(d->a, const double *, d->s->model->nbody);
    find_blocks_of_telescopes(d);
    d->outline = CT_NEWN(d->a, struct ct_outline, d->s->model->nbody);
    for (size_t i = 0; i < d->s->model->nbody; i++)
        find_outline(d, (int)i);
}

// Direction of a body from a position: to the middle of what is drawn of it.
struct ct_spot ct_sketch_direction(const struct ct_sketch *d, int body, struct ct_spot from)
{
    struct ct_spot middle = {0, 0};
    const struct ct_outline *o = &d->outline[body];
    const int beam = d->s->body[body].beam;
    if (beam >= 0) {
        const struct ct_scene_beam *b = &d->s->beam[beam];
        middle = ct_sketch_spot(d, d->value + b->first + (size_t)3 * (size_t)(b->npoint / 2));
    } else if (o->n) {
        for (size_t i = 0; i < o->n; i++) {
            middle.x += o->p[i].x / (double)o->n;
            middle.y += o->p[i].y / (double)o->n;
        }
    } else {
        return (struct ct_spot){0, 0};
    }
    const double x = ct_sketch_distance(from, middle);
    return x > 1 ? (struct ct_spot){(middle.x - from.x) / x, (middle.y - from.y) / x}
                 : (struct ct_spot){0, 0};
}
