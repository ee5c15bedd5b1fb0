// Places labels in a picture: each next to the object it names, in a free area. A label without
// a free area is omitted.
#ifndef CT_DRAW_PLACEMENT_H
#define CT_DRAW_PLACEMENT_H

#include "draw/canvas.h"

struct ct_label {
    const char *text;
    const char *component; // whose name it is
    const char *attributes;
    double font; // [px]
    double away; // [px] from the anchor points to the nearest edge of the text
    size_t n;
    const struct ct_spot *position; // anchor points, best first
};

/// Writes the labels in their order and marks their areas as occupied. Cost: labels x anchor
/// points x 48.
void ct_labels_write(struct ct_canvas *c, const struct ct_label *label, size_t n);

#endif
