// Estimated error of a linear beam on a base that is not driven. The base, as a rigid body of the
// multibody system, and the first bending shapes of the beam move each other.
//
// The system with rigid beams has the state q, u, the mass matrix M and the forces Q. The base has
// the velocity V = B u + V_t in axes of the beam. With the shapes of beam_error_modal.h, to first
// order in their amplitudes x,
//
//     M u' + G x'' = Q - B' r(x, x'),        G = B' p
//     (1 + b x^2) x'' + c x' + W x + b x x'^2 + 2 g x^3 + G' u' = F
//
// for the linear, the foreshortened and the exact beam. p: momentum of the base's six motions in a
// shape; r: reaction on the base by inertia and
// weight of the deflection, without the part of x''. Each beam model has a base of its own, because
// the neglected terms change its motion too. The implicit midpoint rule is used with the same steps
// for all three, so that their differences are those of the models.
#ifndef CT_BEAM_ERROR_BEAM_ERROR_COUPLED_H
#define CT_BEAM_ERROR_BEAM_ERROR_COUPLED_H

#include "beam_error/beam_error_modal.h"
#include "formulate/beam/flexible_body.h"

// Limit: of the time of an estimate; for larger systems the beam alone is simulated
enum { CT_BEAM_ERROR_COUPLED_MOST = 12 }; // speeds of the system with rigid beams

struct ct_beam_error_coupled;
/// State of a simulation.
struct ct_beam_error_coupled_run;

/// NULL if the method does not apply: loops, more speeds, drivers whose rates can jump, or events
/// that depend on the state.
const struct ct_beam_error_coupled *ct_beam_error_coupled_create(struct ct_build *b,
                                                                 const struct ct_flexible *f,
                                                                 const struct ct_validity *v);
/// Does the motion of the base depend on more than time, as far as the trees show?
bool ct_beam_error_coupled_is_free(const struct ct_beam_error_coupled *p);
struct ct_beam_error_coupled_run *
ct_beam_error_coupled_run_create(struct ct_arena *a, const struct ct_beam_error_coupled *p);
/// Set base and shapes to their start; x, x' are those in s.
void ct_beam_error_coupled_begin(struct ct_beam_error_coupled_run *r,
                                 struct ct_beam_error_modal *s);
/// Advance to the time t in steps of `interval`, or shorter ones for a light base, but not more
/// than 100 steps. Errors are NAN once the base is too stiff for such steps.
void ct_beam_error_coupled_advance(struct ct_beam_error_coupled_run *r,
                                   struct ct_beam_error_modal *s, double t, double interval);
/// Largest |eta| of the first shapes so far.
double ct_beam_error_coupled_indicator(const struct ct_beam_error_coupled_run *r);

#endif
