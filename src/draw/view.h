// The view of a scene: parallel projection along a ground axis, or isometric.
#ifndef CT_DRAW_VIEW_H
#define CT_DRAW_VIEW_H

#include "draw/canvas.h"
#include "draw/scene.h"

struct ct_view {
    const char *name;                  // "x", "y", "z", "iso"
    double right[3], up[3], toward[3]; // unit vectors; toward: to the eye
    double scale;                      // [px/m], of lengths across the view
    double shortening;                 // of lengths along ground axes in oblique views
    double low[2];                     // the point [m] that is at `origin`
    struct ct_spot origin;             // [px]
};

/// Chooses a view by name. NULL: along the normal of a planar mechanism if that is an axis,
/// else isometric. False: no such view.
bool ct_view_choose(struct ct_view *v, const struct ct_scene *s, const char *name);

struct ct_spot ct_view_spot(const struct ct_view *v, const double position[3]);
/// Projection of a direction onto the view, per unit of length; y downwards.
struct ct_spot ct_view_across(const struct ct_view *v, const double direction[3]);
double ct_view_depth(const struct ct_view *v, const double position[3]);

static inline double ct_dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

#endif
