// When is the linear model of a beam good enough?  (formulation 5.4)
//
// The axial force of the beam's rigid motion stiffens or softens its bending. Per unit of the first
// bending shape phi,
//
//     eta = (w_y^2 + w_z^2) ka - a_x kb,   ka = phi' Kg1 phi / phi' K phi,  kb = phi' Kg2 phi / phi' K phi
//     Kg1 = int P1 s s' dx, P1(x) = int_x^L m x dx,   Kg2 the same with P2(x) = int_x^L m dx,   s: slopes of the shapes
//
// with the acceleration a_x of the base less gravity along the beam. eta is the ratio of
// motion-induced to elastic stiffness, and with it the relative error of a linear beam at rest
// under its loads. What comes of it in a motion is in beam_error_modal.h.
#ifndef CT_BEAM_ERROR_VALIDITY_H
#define CT_BEAM_ERROR_VALIDITY_H

#include "beam_error/beam_error_modal.h"
#include "formulate/beam/flexible_body.h"

/// The indicator of a beam, the larger one of its planes of bending; masses welded to its points
/// count. eta in terms of time, state and accelerations. False where nothing bends, or the first
/// bending shape cannot be found.
bool ct_validity_derive(struct ct_build *b, const struct ct_flexible *f,
                        struct ct_validity *out);

/// What estimates its error, at the start with x, x' of its shapes.
void ct_validity_begin(const struct ct_validity *v, const double *start,
                       struct ct_beam_error_modal *s);

/// Looks at the base that are nearer in time are passed over: 1/32 of a period of the first shape,
/// 1/8 of those of others.
double ct_validity_interval(const struct ct_validity *v);

/// Beams that leave the choice to the program: does each stay below the limit all along, and its
/// error, too? By body, in b->arena; reasons into the beams. NULL if there is no such beam. A beam
/// whose motion the drivers do not prescribe, or that carries joints or loads, does not.
/// *is_driven: other trees would not
/// show more of them to move as time alone tells.
const bool *ct_validity_choose(struct ct_build *b, bool *is_driven);

/// Indicators of all linear beams into b->eqs->validity, slopes of all beams into b->eqs->bend.
void ct_validity_monitor(struct ct_build *b);

#endif
