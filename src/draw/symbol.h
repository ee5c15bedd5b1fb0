// Symbols of joints, ground, springs, dampers and arrows. All sizes are multiples of the size
// of a pin.
#ifndef CT_DRAW_SYMBOL_H
#define CT_DRAW_SYMBOL_H

#include "draw/view.h"

struct ct_pen {
    struct ct_canvas *canvas;
    const struct ct_view *view;
    double size; // radius of a pin [px]
};

/// A pin about an axis (ground axes): a circle seen from its end, otherwise a short cylinder;
/// stretch: half its length, in multiples of the size.
void ct_draw_cylinder(struct ct_pen *pen, struct ct_spot at, const double axis[3],
                      double stretch);
/// The block of a slider along an axis.
void ct_draw_block(struct ct_pen *pen, struct ct_spot at, const double axis[3]);
void ct_draw_thread(struct ct_pen *pen, struct ct_spot at, const double axis[3]);
/// Two axes that cross.
void ct_draw_cross(struct ct_pen *pen, struct ct_spot at, const double a[3], const double b[3]);
/// A ball in a socket, which opens towards a direction.
void ct_draw_ball(struct ct_pen *pen, struct ct_spot at, struct ct_spot open);
void ct_draw_weld(struct ct_pen *pen, struct ct_spot at);
/// A square in the plane with this normal.
void ct_draw_plate(struct ct_pen *pen, struct ct_spot at, const double normal[3]);
void ct_draw_other(struct ct_pen *pen, struct ct_spot at);

/// Bearing on hatched ground below (down 1) or above (-1).
void ct_draw_ground(struct ct_pen *pen, struct ct_spot at, int down);
/// A hatched wall at a position; along: unit vector out of the wall.
void ct_draw_wall(struct ct_pen *pen, struct ct_spot at, struct ct_spot along, double half);

void ct_draw_spring(struct ct_pen *pen, struct ct_spot a, struct ct_spot b, double offset);
void ct_draw_damper(struct ct_pen *pen, struct ct_spot a, struct ct_spot b, double offset);
/// Centre of mass.
void ct_draw_centre(struct ct_pen *pen, struct ct_spot at, const char *color);
void ct_draw_arrow(struct ct_pen *pen, struct ct_spot from, struct ct_spot to,
                   const char *color, double width);

#endif
