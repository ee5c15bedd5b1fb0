// Sums over all bodies: centre of mass, momenta, energies.
#ifndef CT_FORMULATE_SYSTEM_SUM_H
#define CT_FORMULATE_SYSTEM_SUM_H

#include "formulate/dynamics.h"
#include "formulate/row.h"

enum ct_system_sum { CT_SUM_CENTRE, CT_SUM_MOMENTUM, CT_SUM_ANGULAR_MOMENTUM };

/// In ground's axes: the centre of mass [m], the momentum [N s], or the angular momentum about ground's origin [N m s].
ct_ex3 ct_system_vector(struct ct_build *b, enum ct_system_sum property);
/// Kinetic energy, potential of gravity and power of drivers, added to b->eqs.
void ct_energies_derive(struct ct_build *b);

#endif
