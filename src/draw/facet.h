// Shapes of bodies as flat facets, farthest first, so that nearer ones cover those behind them.
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

/// Adds the visible facets of a body's shapes; color: for shapes without one.
void ct_facets_add_body(struct ct_facets *f, int body, const char *color);
/// Sorts the facets, farthest first.
void ct_facets_sort(struct ct_facets *f);

/// Position in ground axes of a point of a shape [m].
void ct_solid_position(const struct ct_scene *s, const double *value, int body,
                       const struct ct_solid *solid, const double local[3], double out[3]);
/// Corners of the outline of a shape in its axes [m], sufficient for its extent. Returns their
/// number.
size_t ct_solid_corners(struct ct_arena *a, const struct ct_model *m,
                        const struct ct_solid *solid, double (**corner)[3]);

#endif
