// Round-off of double precision: what counts as zero, and changes of states that measure it.
#ifndef CT_NUMERIC_ROUNDOFF_H
#define CT_NUMERIC_ROUNDOFF_H

#include <float.h>
#include <stddef.h>

/// Half of the digits. Of numbers that are either zero but for round-off or of order one, the
/// latter are larger. Derived: the geometric mean of DBL_EPSILON and 1.
#define CT_HALF_DIGITS 0x1p-26

/// A change of states in difference quotients, relative to the state, in units of round-off and as
/// it is. Derived: with 2^12 units the quotients have twelve bits, and terms of second order,
/// 2^-80, are far below round-off.
#define CT_PERTURBATION_UNITS 0x1p12
#define CT_PERTURBATION (CT_PERTURBATION_UNITS * DBL_EPSILON)

/// States change by different multiples of it, from 1 to 2, so that changes do not cancel.
static inline double ct_perturbation_part(size_t i)
{
    // Definition: the golden section, whose multiples are spread most evenly
    const double golden = 0.618033988749895, x = golden * (double)i;
    return 1 + (x - (double)(size_t)x);
}

#endif
