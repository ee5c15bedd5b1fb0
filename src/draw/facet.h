// Shapes of bodies as flat pieces, farthest first, so that nearer ones cover what is behind them.
#ifndef CT_DRAW_FACET_H
#define CT_DRAW_FACET_H

#include "draw/view.h"

struct ct_facet {
    size_t n;
    struct ct_spot *p;   // corners
    const bool *is_edge; // from corner i to the next: a line is drawn
    bool is_open;        // a polyline, not filled
    double depth, light; // mean depth [m]; 0 dark to 1
    int body;
    const char *color;
};

struct ct_facets {
    struct ct_arena *arena;
    const struct ct_scene *scene;
    const struct ct_view *view;
    const double *value;
    struct ct_facet *facet;
    size_t n, cap;
};

/// The pieces of a body's shapes that may be seen; color: of those without one.
void ct_facets_add_body(struct ct_facets *f, int body, const char *color);
/// Farthest first.
void ct_facets_sort(struct ct_facets *f);

/// Where a point of a shape is: axes of the shape -> ground [m].
void ct_solid_place(const struct ct_scene *s, const double *value, int body,
                    const struct ct_solid *solid, const double local[3], double out[3]);
/// Corners of a shape's outline, in its axes [m]: enough to find how far it reaches. Returns
/// their number.
size_t ct_solid_corners(struct ct_arena *a, const struct ct_model *m,
                        const struct ct_solid *solid, double (**corner)[3]);

#endif
