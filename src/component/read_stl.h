// STL files, text and binary.
#ifndef CT_COMPONENT_READ_STL_H
#define CT_COMPONENT_READ_STL_H

#include "base/ctx.h"

/// Read the triangles of a file, 9 numbers each (corners x y z), into arena a. Normals follow from
/// the order of the corners and are not read. used: position where the model names the file.
/// Errors: E520 for the file, E521 for its contents.
bool ct_stl_read(struct ct_ctx *ctx, struct ct_arena *a, const char *path, struct ct_mark used,
                 const float **triangle, size_t *n);

#endif
