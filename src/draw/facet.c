// See facet.h.
#include "draw/facet.h"
#include "base/pi.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Layout: of the picture
enum { ROUND = 48 }; // corners of round shapes

// ---- positions -----------------------------------------------------------------------------

static double number(const struct ct_model *m, ct_ex e)
{
    return ct_model_number(m, e);
}

// v turned by angle about the unit vector n
static void turn(const double n[3], double angle, double v[3])
{
    const double c = cos(angle), s = sin(angle), along = (1 - c) * ct_dot3(n, v);
    const double w[3]
        = {n[1] * v[2] - n[2] * v[1], n[2] * v[0] - n[0] * v[2], n[0] * v[1] - n[1] * v[0]};
    for (int i = 0; i < 3; i++)
        v[i] = c * v[i] + s * w[i] + along * n[i];
}

void ct_solid_position(const struct ct_scene *s, const double *value, int body,
                       const struct ct_solid *solid, const double local[3], double out[3])
{
    const struct ct_model *m = s->model;
    double v[3] = {local[0], local[1], local[2]};
    for (size_t k = solid->nturn; k-- > 0;) { // R = R1 R2 ...: the last one first
        const struct ct_turn *t = &solid->turn[k];
        double n[3];
        for (int i = 0; i < 3; i++)
            n[i] = number(m, t->axis.e[i]);
        turn(n, number(m, t->angle), v);
    }
    for (int i = 0; i < 3; i++)
        v[i] += number(m, solid->at.e[i]);
    ct_scene_point(value, m->body[body].frame, v, out);
}

// ---- corners -------------------------------------------------------------------------------

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void scale_to_one(double v[3])
{
    const double length = sqrt(ct_dot3(v, v));
    for (int i = 0; i < 3; i++)
        v[i] /= length;
}

// Two unit vectors perpendicular to n.
static void across(const double n[3], double a[3], double b[3])
{
    int k = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(n[i]) < fabs(n[k]))
            k = i;
    double e[3] = {0};
    e[k] = 1;
    cross(n, e, a);
    scale_to_one(a);
    cross(n, a, b);
}

// Corners 0 ... ROUND-1 at one end, then those at the other end.
static void cylinder_corners(const struct ct_model *m, const struct ct_solid *solid,
                             double (*p)[3])
{
    const double r = number(m, solid->size[0]), half = number(m, solid->size[1]) / 2;
    double n[3], a[3], b[3];
    for (int i = 0; i < 3; i++)
        n[i] = number(m, solid->axis.e[i]);
    across(n, a, b);
    for (int k = 0; k < 2 * ROUND; k++) {
        const double phi = 2 * CT_PI * (k % ROUND) / ROUND;
        for (int i = 0; i < 3; i++)
            p[k][i]
                = r * (cos(phi) * a[i] + sin(phi) * b[i]) + (k < ROUND ? -half : half) * n[i];
    }
}

size_t ct_solid_corners(struct ct_arena *a, const struct ct_model *m,
                        const struct ct_solid *solid, double (**corner)[3])
{
    const size_t count[CT_NSOLID] = {[CT_SOLID_BOX] = 8,
                                     [CT_SOLID_CYLINDER] = (size_t)2 * ROUND,
                                     [CT_SOLID_SPHERE] = 6,
                                     [CT_SOLID_LINES] = solid->npoint,
                                     [CT_SOLID_FILE] = 3 * solid->ntriangle};
    const size_t n = count[solid->kind];
    double(*p)[3] = ct_arena_calloc(a, n + 1, sizeof *p);
    if (solid->kind == CT_SOLID_CYLINDER)
        cylinder_corners(m, solid, p);
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < 3; i++)
            switch (solid->kind) {
            case CT_SOLID_BOX:
                p[k][i] = (k >> i & 1 ? 0.5 : -0.5) * number(m, solid->size[i]);
                break;
            case CT_SOLID_SPHERE:
                p[k][i] = (k / 2 == i) * (k % 2 ? 1 : -1) * number(m, solid->size[0]);
                break;
            case CT_SOLID_LINES:
                p[k][i] = number(m, solid->point[k].e[i]);
                break;
            case CT_SOLID_FILE:
                p[k][i] = number(m, solid->scale) * (double)solid->triangle[3 * k + i];
                break;
            case CT_SOLID_CYLINDER:
            case CT_NSOLID:
                break;
            }
    *corner = p;
    return n;
}

// ---- pieces --------------------------------------------------------------------------------

struct work {
    struct ct_facets *f;
    const struct ct_solid *solid;
    int body;
    const char *color;
    double (*position)[3]; // of the corners
};

static void find_normal(const double a[3], const double b[3], const double c[3], double n[3])
{
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
        u[i] = b[i] - a[i];
        v[i] = c[i] - a[i];
    }
    cross(u, v, n);
    const double length = sqrt(ct_dot3(n, n));
    for (int i = 0; i < 3 && length > 0; i++)
        n[i] /= length;
}

// Light falls from above left, from behind the viewer.
static double light_on(const struct ct_view *v, const double n[3])
{
    const double l
        = -0.3 * ct_dot3(v->right, n) + 0.55 * ct_dot3(v->up, n) + 0.78 * ct_dot3(v->toward, n);
    return fmax(0, fmin(1, l));
}

static struct ct_facet *add(struct work *w, const int *corner, size_t n, const bool *is_edge)
{
    struct ct_facets *f = w->f;
    struct ct_facet one = {.n = n,
                           .p = CT_NEWN(f->arena, struct ct_spot, n),
                           .is_edge = is_edge,
                           .light = 1,
                           .body = w->body,
                           .color = w->color};
    for (size_t k = 0; k < n; k++) {
        const double *position = w->position[corner ? corner[k] : (int)k];
        one.p[k] = ct_view_spot(f->view, position);
        one.depth += ct_view_depth(f->view, position) / (double)n;
    }
    CT_PUSH(f->arena, f->facet, f->n, f->cap, one);
    return &f->facet[f->n - 1];
}

// Adds a facet whose corners are counterclockwise seen from outside; nothing if it faces away.
static void add_outside(struct work *w, const int *corner, size_t n, const bool *is_edge)
{
    double normal[3];
    find_normal(w->position[corner[0]], w->position[corner[1]], w->position[corner[2]], normal);
    if (ct_dot3(normal, w->f->view->toward) > 0)
        add(w, corner, n, is_edge)->light = light_on(w->f->view, normal);
}

static const bool *all_edges(struct ct_arena *a, size_t n)
{
    bool *edge = CT_NEWN(a, bool, n);
    memset(edge, true, n);
    return edge;
}

static void add_box(struct work *w)
{
    static const int side[6][4]
        = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    const bool *edge = all_edges(w->f->arena, 4);
    for (int k = 0; k < 6; k++)
        add_outside(w, side[k], 4, edge);
}

static bool faces_viewer(const struct work *w, int k)
{
    double normal[3];
    const int next = (k + 1) % ROUND;
    find_normal(w->position[k], w->position[next], w->position[ROUND + next], normal);
    return ct_dot3(normal, w->f->view->toward) > 0;
}

static void add_cylinder(struct work *w)
{
    int end[ROUND];
    const bool *edge = all_edges(w->f->arena, ROUND);
    for (int k = 0; k < ROUND; k++) {
        const int next = (k + 1) % ROUND;
        const int corner[4] = {k, next, ROUND + next, ROUND + k};
        bool *lines = CT_NEWN(w->f->arena, bool, 4);
        lines[0] = lines[2] = true;
        lines[1] = !faces_viewer(w, next);
        lines[3] = !faces_viewer(w, (k + ROUND - 1) % ROUND);
        add_outside(w, corner, 4, lines);
    }
    for (int k = 0; k < ROUND; k++)
        end[k] = ROUND - 1 - k;
    add_outside(w, end, ROUND, edge);
    for (int k = 0; k < ROUND; k++)
        end[k] = ROUND + k;
    add_outside(w, end, ROUND, edge);
}

static void add_sphere(struct work *w, const double centre[3])
{
    // Layout: of the picture
    const double lit = 0.9;
    const struct ct_view *v = w->f->view;
    const double r = number(w->f->scene->model, w->solid->size[0]);
    // Layout: of the picture
    enum { FINE = 2 * ROUND };
    double(*p)[3] = ct_arena_calloc(w->f->arena, FINE, sizeof *p);
    for (int k = 0; k < FINE; k++)
        for (int i = 0; i < 3; i++)
            p[k][i] = centre[i]
                    + r
                          * (cos(2 * CT_PI * k / FINE) * v->right[i]
                             + sin(2 * CT_PI * k / FINE) * v->up[i]);
    w->position = p;
    add(w, NULL, FINE, all_edges(w->f->arena, FINE))->light = lit;
}

// ---- triangles -----------------------------------------------------------------------------

// A side of a triangle, with its ends in a fixed order.
struct side {
    const float *a, *b;
    size_t triangle;
    int k;
};

static int compare_positions(const float *a, const float *b)
{
    for (int i = 0; i < 3; i++)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}

static int compare_sides(const void *p, const void *q)
{
    const struct side *s = p, *t = q;
    int order = compare_positions(s->a, t->a);
    order = order ? order : compare_positions(s->b, t->b);
    if (order)
        return order;
    return s->triangle != t->triangle ? (s->triangle < t->triangle ? -1 : 1) : s->k - t->k;
}

// Lines are drawn where the surface has a kink or an edge, or turns away from the viewer.
static bool is_line(const double (*normal)[3], const struct side *s, size_t n,
                    const struct ct_view *v)
{
    // Layout: of the picture
    const double kink = 0.87; // cosine of 30 degrees
    if (n != 2)
        return true;
    const double *a = normal[s[0].triangle], *b = normal[s[1].triangle];
    return ct_dot3(a, b) < kink || (ct_dot3(a, v->toward) > 0) != (ct_dot3(b, v->toward) > 0);
}

// Cost: sorting the sides.
static void add_triangles(struct work *w)
{
    struct ct_arena *a = w->f->arena;
    const size_t n = w->solid->ntriangle;
    struct side *side = CT_NEWN(a, struct side, 3 * n);
    double(*normal)[3] = ct_arena_calloc(a, n, sizeof *normal);
    bool(*edge)[3] = ct_arena_calloc(a, n, sizeof *edge);
    bool is_closed = true;
    for (size_t i = 0; i < n; i++) {
        find_normal(w->position[3 * i], w->position[3 * i + 1], w->position[3 * i + 2],
                    normal[i]);
        for (int k = 0; k < 3; k++) {
            const float *p = w->solid->triangle + 9 * i + 3 * k,
                        *q = w->solid->triangle + 9 * i + 3 * ((k + 1) % 3);
            const bool in_order = compare_positions(p, q) <= 0;
            side[3 * i + (size_t)k] = (struct side){in_order ? p : q, in_order ? q : p, i, k};
        }
    }
    qsort(side, 3 * n, sizeof *side, compare_sides);
    for (size_t i = 0, end; i < 3 * n; i = end) {
        for (end = i + 1; end < 3 * n && !compare_positions(side[i].a, side[end].a)
                          && !compare_positions(side[i].b, side[end].b);)
            end++;
        is_closed &= end - i == 2;
        const bool line = is_line((const double(*)[3])normal, side + i, end - i, w->f->view);
        for (size_t k = i; k < end; k++)
            edge[side[k].triangle][side[k].k] = line;
    }
    for (size_t i = 0; i < n; i++) {
        const int corner[3] = {(int)(3 * i), (int)(3 * i + 1), (int)(3 * i + 2)};
        const double facing = ct_dot3(normal[i], w->f->view->toward);
        if (is_closed && facing <= 0)
            continue;
        for (int k = 0; k < 3 && facing < 0; k++)
            normal[i][k] = -normal[i][k];
        add(w, corner, 3, edge[i])->light = light_on(w->f->view, normal[i]);
    }
}

// ---- all of a body -------------------------------------------------------------------------

static void add_solid(struct work *w)
{
    struct ct_facets *f = w->f;
    double(*local)[3];
    const size_t n = ct_solid_corners(f->arena, f->scene->model, w->solid, &local);
    w->position = ct_arena_calloc(f->arena, n + 1, sizeof *w->position);
    for (size_t k = 0; k < n; k++)
        ct_solid_position(f->scene, f->value, w->body, w->solid, local[k], w->position[k]);
    double centre[3];
    ct_solid_position(f->scene, f->value, w->body, w->solid, (double[3]){0}, centre);
    switch (w->solid->kind) {
    case CT_SOLID_BOX:
        add_box(w);
        break;
    case CT_SOLID_CYLINDER:
        add_cylinder(w);
        break;
    case CT_SOLID_SPHERE:
        add_sphere(w, centre);
        break;
    case CT_SOLID_LINES:
        add(w, NULL, n, NULL)->is_open = true;
        break;
    case CT_SOLID_FILE:
        add_triangles(w);
        break;
    case CT_NSOLID:
        break;
    }
}

void ct_facets_add_body(struct ct_facets *f, int body, const char *color)
{
    const struct ct_body *b = &f->scene->model->body[body];
    for (size_t i = 0; i < b->nsolid; i++) {
        struct work w = {.f = f,
                         .solid = &b->solid[i],
                         .body = body,
                         .color = b->solid[i].color ? b->solid[i].color : color};
        add_solid(&w);
    }
}

struct ordered {
    double depth;
    size_t i;
};

static int compare_depth(const void *p, const void *q)
{
    const struct ordered *a = p, *b = q;
    if (a->depth != b->depth)
        return a->depth < b->depth ? -1 : 1;
    return a->i < b->i ? -1 : a->i > b->i;
}

void ct_facets_sort(struct ct_facets *f)
{
    struct ordered *o = CT_NEWN(f->arena, struct ordered, f->n + 1);
    struct ct_facet *sorted = CT_NEWN(f->arena, struct ct_facet, f->n + 1);
    for (size_t i = 0; i < f->n; i++)
        o[i] = (struct ordered){f->facet[i].depth, i};
    qsort(o, f->n, sizeof *o, compare_depth);
    for (size_t i = 0; i < f->n; i++)
        sorted[i] = f->facet[o[i].i];
    f->facet = sorted;
}
