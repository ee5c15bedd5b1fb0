// Accelerations and projections of an embedding in quadruple precision, for what goes on beside singular positions.
//
// There places that follow from the independent ones have an error of eps/sigma, speeds of eps/sigma^2 and accelerations of
// eps/sigma^3. Here all that follows is found anew with 33 digits from the independent coordinates and speeds as they are, of which
// it is a smooth function along the motion, and only then rounded. Some hundred times slower.  (8.34)
#ifndef CT_SOLVE_QUAD_EMBED_H
#define CT_SOLVE_QUAD_EMBED_H

#include "solve/embed.h"

/// NULL where equations cannot be evaluated so: without the library (libquadmath), with tables, and of systems where factors would
/// cost too much. Everything lives in a.
struct ct_quad_embed *ct_quad_embed_create(struct ct_arena *a, const struct ct_machine *m);

/// Move q, u in y onto the kept rows of s, independent coordinates and speeds held.
enum ct_eval ct_quad_embed_project(struct ct_quad_embed *x, const struct ct_embed *s, double t,
                                   double *y);
/// a (nu, out) = u', rate (nq, out) = q' at y, put onto them.
enum ct_eval ct_quad_embed_accelerate(struct ct_quad_embed *x, const struct ct_embed *s,
                                      double *a, double *rate);

#endif
