// Sums over all bodies: centre of mass and momenta.
#ifndef CT_FORMULATE_SIGNALS_MOMENTUM_H
#define CT_FORMULATE_SIGNALS_MOMENTUM_H

#include "formulate/beam/flexible_body.h"

enum ct_system_total { CT_SUM_CENTRE, CT_SUM_MOMENTUM, CT_SUM_ANGULAR_MOMENTUM };

/// In axes of ground: the centre of mass [m], the momentum [N s], or the angular momentum about
/// the origin of ground [N m s].
ct_ex3 ct_system_total_vector(struct ct_build *b, enum ct_system_total property);
/// Of one beam: mass times centre of mass [kg m], momentum, angular momentum.
ct_ex3 ct_beam_total_vector(struct ct_build *b, struct ct_flexible *f,
                            enum ct_system_total property);
/// Of a rigid body about its centre of mass [N m s].
ct_ex3 ct_body_angular_momentum(struct ct_build *b, size_t body);

#endif
