// Mode shapes as a picture: the skeleton of a system, at rest and displaced, a panel for each mode.
#ifndef CT_REPORT_MODE_SHAPE_PLOT_H
#define CT_REPORT_MODE_SHAPE_PLOT_H

#include "base/ctx.h"

/// A line between two points of the skeleton.
struct ct_bone {
    int from, to;
    enum ct_bone_kind { CT_BONE_BODY, CT_BONE_JOINT, CT_BONE_FORCE } kind;
};

struct ct_shape_panel {
    const char *title;
    const double *point; // 2 x npoint: displaced
};

/// Draw panels, equal scales. rest (2 x npoint): the points at rest. Errors: E002.
bool ct_shapes_draw(struct ct_ctx *ctx, const char *path, const char *title,
                    const struct ct_shape_panel *panel, size_t npanel, const double *rest,
                    size_t npoint, const struct ct_bone *bone, size_t nbone);

#endif
