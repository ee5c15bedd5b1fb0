// The number pi, which C11 does not name.
#ifndef CT_BASE_PI_H
#define CT_BASE_PI_H

/// Definition: circumference of a circle of diameter 1.
#define CT_PI 3.14159265358979323846

#endif
