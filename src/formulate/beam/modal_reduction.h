// Shapes of a whole beam as its elastic coordinates: modes, static shapes, and those that
// condensation leaves.
#ifndef CT_FORMULATE_BEAM_MODAL_REDUCTION_H
#define CT_FORMULATE_BEAM_MODAL_REDUCTION_H

#include "formulate/beam/degrees_of_freedom.h"

/// Shapes that stand for the nodal freedoms of a beam.
struct ct_shapes {
    int n, nshape,
        nstatic; // freedoms; shapes, the static ones (of freedom[0], freedom[1] ...) first
    int *freedom;
    double *shape; // n x nshape
};
/// Does `modes: n` ask for as many as there are, or more? The nodes' own coordinates then do the
/// same for less.
bool ct_flexible_keeps_all_modes(struct ct_build *b, struct ct_flexible *f);
/// Shapes of `modes: n` (modal_reduction.c); f->cut tells if others of the same frequency are
/// left out.  Errors: CT_E_BEAM.
bool ct_flexible_reduce(struct ct_build *b, struct ct_flexible *f, struct ct_shapes *out);
/// Shapes of the freedoms that do not follow, each with the others of them held and those that
/// follow in equilibrium, and f->follow. False if all are coordinates, or the stiffness of those
/// that follow is not positive.
bool ct_flexible_condense(struct ct_build *b, struct ct_flexible *f, struct ct_shapes *out);
/// Coordinates whose shapes come nearest to freedoms' values, by the mass between: (P' M P)^-1 P'
/// M g, with numbers of the file for P and M; f->start_missed tells what they leave out. False:
/// the shapes depend on each other, or move no mass.
bool ct_flexible_fit(struct ct_build *b, struct ct_flexible *f, const ct_ex *by_freedom,
                     ct_ex *out);

#endif
