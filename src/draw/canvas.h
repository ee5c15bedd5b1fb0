// A picture in SVG, with a map of its occupied cells, so that labels find free areas.
//
// Positions are in pixels from the upper left corner. The file contains whole tenths of a
// pixel, so that its text does not depend on the locale. What always holds: text from a model
// is escaped and gives valid XML.
#ifndef CT_DRAW_CANVAS_H
#define CT_DRAW_CANVAS_H

#include "report/outfile.h"

// Layout: of the picture
enum { CT_FONT = 13 }; // [px]

/// Colours that stay apart without colour vision: Okabe and Ito (2008), without the yellow and
/// the black.
extern const char *const ct_palette[];
// Layout: of the picture
enum { CT_NPALETTE = 6 };

struct ct_spot { // [px]
    double x, y;
};

struct ct_canvas {
    FILE *out;
    double width, height;
    unsigned char *taken; // by cell, row by row: occupied
    int ncolumn, nrow;
};

/// Writes the head of the file. title: of the picture.
void ct_canvas_begin(struct ct_canvas *c, struct ct_arena *a, FILE *out, double width,
                     double height, const char *title);
void ct_canvas_end(struct ct_canvas *c);

/// <g class= data-component=> ... </g>; attributes are further ones, or "". component NULL: none.
void ct_canvas_open(struct ct_canvas *c, const char *kind, const char *component,
                    const char *attributes);
void ct_canvas_close(struct ct_canvas *c);

/// A polyline, or a polygon when closed. attributes: style that differs from the group's. halo
/// [px]: width of the occupied cells around it; 0: none.
void ct_canvas_lines(struct ct_canvas *c, const struct ct_spot *p, size_t n, bool closed,
                     const char *attributes, double halo);
void ct_canvas_line(struct ct_canvas *c, struct ct_spot a, struct ct_spot b,
                    const char *attributes, double halo);
void ct_canvas_circle(struct ct_canvas *c, struct ct_spot at, double radius,
                      const char *attributes, double halo);
/// An arc from angle a to b [rad], counterclockwise on the screen.
void ct_canvas_arc(struct ct_canvas *c, struct ct_spot at, double radius, double a, double b,
                   const char *attributes);
/// anchor: "start", "middle" or "end"
void ct_canvas_text(struct ct_canvas *c, struct ct_spot at, const char *anchor,
                    const char *attributes, const char *text);
void ct_canvas_escape(FILE *out, const char *text);

/// Marks as occupied the inside of a convex polygon; a rectangle.
void ct_canvas_take_polygon(struct ct_canvas *c, const struct ct_spot *p, size_t n);
void ct_canvas_take_box(struct ct_canvas *c, struct ct_spot low, struct ct_spot high);
/// Number of occupied cells in a rectangle; -1 if it extends beyond the picture.
int ct_canvas_count_taken(const struct ct_canvas *c, struct ct_spot low, struct ct_spot high);

/// Removes points of a polyline that are within `most` [px] of the lines between the remaining
/// ones; returns the number of points that remain, in place.
size_t ct_spots_thin(struct ct_arena *a, struct ct_spot *p, size_t n, double most);

/// Approximate width of a text [px]; not less than that of common sans-serif fonts.
double ct_canvas_text_width(const char *text, double font);

#endif
