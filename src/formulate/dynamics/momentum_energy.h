// Sums over all bodies: centre of mass, momenta, energies.
#ifndef CT_FORMULATE_DYNAMICS_MOMENTUM_ENERGY_H
#define CT_FORMULATE_DYNAMICS_MOMENTUM_ENERGY_H

#include "formulate/dynamics/dynamics.h"
#include "formulate/kinematics/constraint_row.h"

enum ct_system_total { CT_SUM_CENTRE, CT_SUM_MOMENTUM, CT_SUM_ANGULAR_MOMENTUM };

/// In ground's axes: the centre of mass [m], the momentum [N s], or the angular momentum about ground's origin [N m s].
ct_ex3 ct_system_total_vector(struct ct_build *b, enum ct_system_total property);
/// Kinetic energy, potential of gravity and power of drivers, added to b->eqs.
void ct_energies_derive(struct ct_build *b);

#endif
