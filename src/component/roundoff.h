// Round-off in values computed from model data.
#ifndef CT_COMPONENT_ROUNDOFF_H
#define CT_COMPONENT_ROUNDOFF_H

/// Relative round-off of a number computed from others, such as 0.1 + 0.2. Derived: a sum of 45
/// terms, each a hundred times as large as the result, has a relative error of 4500 eps = 1e-12.
#define CT_DATA_ROUNDOFF 1e-12

#endif
