// Shapes for drawing bodies: `shape:` of the model file. They do not affect the motion.
//
// What always holds after reading: lengths depend on parameters only and are positive; triangles
// are finite. A solid is centred at `at` in axes of its body and rotated by `turn`; lines and files
// keep their own origin there.
#ifndef CT_COMPONENT_SOLID_H
#define CT_COMPONENT_SOLID_H

#include "component/class.h"

enum ct_solid_kind {
    CT_SOLID_BOX,      // edges along x, y, z
    CT_SOLID_CYLINDER, // radius, length
    CT_SOLID_SPHERE,   // radius
    CT_SOLID_LINES,    // a polyline
    CT_SOLID_FILE,     // triangles of an STL file
    CT_NSOLID
};

struct ct_solid {
    enum ct_solid_kind kind;
    struct ct_mark mark;
    ct_ex size[3];         // [m], as many as the kind needs
    ct_ex3 axis;           // CYLINDER: unit vector
    size_t npoint;         // LINES
    ct_ex3 *point;         // [m]
    size_t ntriangle;      // FILE
    const float *triangle; // 9 x ntriangle: three corners each, before `scale`
    ct_ex scale;           // FILE: length of one unit of the file [m]
    ct_ex3 at;             // [m]
    size_t nturn;
    struct ct_turn *turn;
    const char *color; // "#rrggbb"; NULL: none is given
};

#endif
