// Estimated error of a linear beam on a base that is not driven: the base, as a rigid body in the
// scene, and the beam's first shapes move each other.
//
// With q, u of the scene whose beams are rigid, M and Q of it, the base's velocity V = B u + V_t in
// axes of the beam and the shapes of beam_error_modal.h, to first order in their amplitudes x,
//
//     M u' + G x'' = Q - B' r(x, x'),        G = B' p, p: momentum of the base's six motions in a shape
//     (1 + b x^2) x'' + c x' + W x + b x x'^2 + 2 g x^3 + G' u' = F    for the linear, the foreshortened and the true beam
//
// r: what inertia and weight of the deflection do to the base, but for x''. Each beam has its own
// base here: what it leaves out changes the motion of that, too. By the implicit midpoint rule,
// with the same steps for all three, so that their differences are those of the beams.
#ifndef CT_BEAM_ERROR_BEAM_ERROR_COUPLED_H
#define CT_BEAM_ERROR_BEAM_ERROR_COUPLED_H

#include "beam_error/beam_error_modal.h"
#include "formulate/beam/flexible_body.h"

// Limit: of the time of an estimate; systems beyond have that of the beam alone
enum { CT_BEAM_ERROR_COUPLED_MOST = 12 }; // speeds of the scene, beams rigid

struct ct_beam_error_coupled;
/// State of a run.
struct ct_beam_error_coupled_run;

/// NULL where it does not apply: loops, more speeds, drivers whose rates can jump, or events by the
/// state.
const struct ct_beam_error_coupled *ct_beam_error_coupled_create(struct ct_build *b,
                                                                 const struct ct_flexible *f,
                                                                 const struct ct_validity *v);
/// Does the base move by more than time, as trees through joints see it?
bool ct_beam_error_coupled_is_free(const struct ct_beam_error_coupled *p);
struct ct_beam_error_coupled_run *
ct_beam_error_coupled_run_create(struct ct_arena *a, const struct ct_beam_error_coupled *p);
/// Set base and shapes to their start, x, x' of s as given.
void ct_beam_error_coupled_begin(struct ct_beam_error_coupled_run *r,
                                 struct ct_beam_error_modal *s);
/// Move on to the time t in steps of `glance`, shorter ones where the base yields, but not more
/// than 100 of them. Errors are NAN from where the base is too stiff for such steps.
void ct_beam_error_coupled_advance(struct ct_beam_error_coupled_run *r,
                                   struct ct_beam_error_modal *s, double t, double glance);
/// Largest |eta| of the first shapes so far.
double ct_beam_error_coupled_indicator(const struct ct_beam_error_coupled_run *r);

#endif
