// src/beam_error estimates the error of linear beam models before and during a run. validity
// computes a static indicator, decides whether beams of formulation `automatic` stay linear, and
// records indicators in a run; bending_modes finds the first bending shapes; beam_error_modal
// integrates these shapes as oscillators with and without the neglected terms; beam_error_coupled
// does so together with a moving base.
//
// This file: the indicator  (formulation 5.4). The axial force of the beam's rigid motion stiffens
// or softens its bending. For the first bending shape phi,
//
//     eta = (w_y^2 + w_z^2) ka - a_x kb
//     ka = phi' Kg1 phi / phi' K phi,   kb = phi' Kg2 phi / phi' K phi
//     Kg1 = int P1 s s' dx,   P1(x) = int_x^L m x dx,   s: slopes of the shapes
//     Kg2 = int P2 s s' dx,   P2(x) = int_x^L m dx
//
// w: angular velocity of the base; a_x: its acceleration minus gravity, along the beam. eta is the
// ratio of motion-induced to elastic stiffness. For a beam at rest under its loads it is the
// relative error of the linear model. The error in a motion is estimated in beam_error_modal.h.
#ifndef CT_BEAM_ERROR_VALIDITY_H
#define CT_BEAM_ERROR_VALIDITY_H

#include "beam_error/beam_error_modal.h"
#include "formulate/beam/flexible_body.h"

/// Derive the indicator of a beam: the larger one of its two planes of bending. Masses welded to
/// its points are included. eta is an expression of time, state and accelerations. False where
/// nothing bends, or the first bending shape is not found.
bool ct_validity_derive(struct ct_build *b, const struct ct_flexible *f,
                        struct ct_validity *out);

/// Start the estimate of the error; start: x, x' of its shapes.
void ct_validity_begin(const struct ct_validity *v, const double *start,
                       struct ct_beam_error_modal *s);

/// Sampling interval of the base motion; closer samples are skipped. It is 1/32 of a period of the
/// first shape or 1/8 of a period of another one, whichever is less.
double ct_validity_interval(const struct ct_validity *v);

/// For beams of formulation `automatic`: do indicator and error of each stay below the limit during
/// the whole run? Result by body, in b->arena; the reasons are stored in the beams. NULL if there
/// is no such beam. Never true for a beam whose motion the drivers do not prescribe, or that
/// carries joints or loads. *is_driven: no other choice of trees would show that the motion of more
/// beams depends on time alone.
const bool *ct_validity_choose(struct ct_build *b, bool *is_driven);

/// Store the indicators of all linear beams in b->eqs->validity and the slopes of all beams in
/// b->eqs->bend.
void ct_validity_monitor(struct ct_build *b);

#endif
