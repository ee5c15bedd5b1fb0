// Round-off of what a model computes.
#ifndef CT_COMPONENT_ROUNDOFF_H
#define CT_COMPONENT_ROUNDOFF_H

/// Relative error of a number that was computed from others, as 0.1 + 0.2. Derived: 4500 units of
/// round-off, as of a sum of 45 terms a hundred times as large as the result.
#define CT_DATA_ROUNDOFF 1e-12

#endif
