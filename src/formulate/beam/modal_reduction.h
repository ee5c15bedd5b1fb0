// Shapes of a whole beam as elastic coordinates: modes, static shapes, and shapes after
// condensation.
#ifndef CT_FORMULATE_BEAM_MODAL_REDUCTION_H
#define CT_FORMULATE_BEAM_MODAL_REDUCTION_H

#include "formulate/beam/degrees_of_freedom.h"

/// Shapes that replace the nodal freedoms of a beam.
struct ct_shapes {
    // freedoms; shapes, the static ones (of freedom[0], freedom[1] ...) first
    int n, nshape, nstatic;
    int *freedom;
    double *shape; // n x nshape
};
/// Does `modes: n` request all modes or more? Then nodal coordinates are equivalent and cheaper.
bool ct_flexible_keeps_all_modes(struct ct_build *b, struct ct_flexible *f);
/// Shapes of `modes: n` (modal_reduction.c); f->cut is set if modes of the same frequency are
/// omitted.  Errors: CT_E_BEAM.
bool ct_flexible_reduce(struct ct_build *b, struct ct_flexible *f, struct ct_shapes *out);
/// Static condensation: shapes of the remaining freedoms, each with the others fixed and the
/// condensed rotations in equilibrium. False if nothing is condensed or the stiffness of the
/// condensed rotations is not positive.
bool ct_flexible_condense(struct ct_build *b, struct ct_flexible *f, struct ct_shapes *out);
/// Projects values g of the freedoms on the shapes P of the coordinates, in the norm of the mass
/// matrix: (P' M P)^-1 P' M g, with P and M at the parameter values of the file. f->start_residual
/// is the relative part of g that remains. False: the shapes are linearly dependent or have no mass.
bool ct_flexible_fit(struct ct_build *b, struct ct_flexible *f, const ct_ex *by_freedom,
                     ct_ex *out);

#endif
