// Energies of all bodies.
#ifndef CT_FORMULATE_DYNAMICS_ENERGY_H
#define CT_FORMULATE_DYNAMICS_ENERGY_H

#include "formulate/dynamics/dynamics.h"
#include "formulate/kinematics/coordinate.h"

/// Adds kinetic energy, gravity potential, strain energy and power of drivers to b->eqs.
void ct_energies_derive(struct ct_build *b);

#endif
