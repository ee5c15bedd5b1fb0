// STL files, text and binary.
#ifndef CT_COMPONENT_READ_STL_H
#define CT_COMPONENT_READ_STL_H

#include "base/ctx.h"

/// The triangles of a file, 9 numbers each (corners x y z), in arena a; normals are those of the
/// corners' order and are not read. used: where the model names the file. Errors: E520 for the
/// file, E521 for what it contains.
bool ct_stl_read(struct ct_ctx *ctx, struct ct_arena *a, const char *path, struct ct_mark used,
                 const float **triangle, size_t *n);

#endif
