// A scene at a state as a line drawing.
#ifndef CT_DRAW_PICTURE_H
#define CT_DRAW_PICTURE_H

#include "draw/view.h"

/// What to draw. Everything must live as long as the call.
struct ct_picture {
    const struct ct_scene *scene;
    const double *value; // of the scene (nvalue)
    const char *title;
    struct ct_view view; // as ct_view_choose gives it
    const char *caption; // "t = 1.5 s"; NULL: none
    // paths of points over the run: position k of path i is at path[3 (npath k + i)]
    const double *path;
    size_t npath, nposition;
    const int *path_body; // by path: body of the point, for its colour
};

/// Prints the picture as SVG, <svg> ... </svg>. a: workspace. Raises the guard.
void ct_picture_print(FILE *out, struct ct_arena *a, const struct ct_picture *p);
/// Writes it to a file. a: workspace. Errors: E002. Raises the guard.
bool ct_picture_write(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_picture *p,
                      const char *path);

#endif
