// Places labels in a picture: each beside the object it names, where the picture is free. A
// label without a free place is left out.
#ifndef CT_DRAW_PLACEMENT_H
#define CT_DRAW_PLACEMENT_H

#include "draw/canvas.h"

struct ct_label {
    const char *text;
    const char *component; // whose name it is
    const char *attributes;
    double font; // [px]
    double away; // [px] from the places to the nearest edge of the text
    size_t n;
    const struct ct_spot *place; // that it may stand beside, best first
};

/// Writes the labels in their order and marks their places as occupied. Cost: labels x places x
/// 48.
void ct_labels_write(struct ct_canvas *c, const struct ct_label *label, size_t n);

#endif
