// Shape functions of beam elements: polynomials of xi in [0, 1] and their integrals over an
// element.
#ifndef CT_FORMULATE_BEAM_SHAPE_FUNCTION_H
#define CT_FORMULATE_BEAM_SHAPE_FUNCTION_H

#include "component/beam.h"

/// Definition: coefficients up to degree 12, that of products of two shape functions.
enum { CT_SHAPE_SIZE = 13, CT_MAX_GAUSS = CT_ELEMENT_POINTS };

/// (c[0] + c[1] xi + ...) h^power, h the element's length.
struct ct_shape {
    double c[CT_SHAPE_SIZE];
    int power;
};

/// Integration rules: FULL exact, MIDDLE one point, ENDS half at each end.
enum ct_rule { CT_RULE_FULL, CT_RULE_MIDDLE, CT_RULE_ENDS };

struct ct_span { // an element on the axis
    ct_ex start, length;
};

/// A function along the beam; contains the symbol x where it is not constant.
struct ct_profile {
    ct_ex x, value;
};

/// Shapes of the four freedoms (displacement and rotation at either end) of one plane of bending.
struct ct_bending {
    struct ct_shape deflection[4]; // displacement
    struct ct_shape slope[4];      // of the axis
    struct ct_shape rotation[4];   // of the section
};

/// Cubic (Euler-Bernoulli: the section follows the axis) or linear (Timoshenko).
void ct_shape_bending(enum ct_beam_theory theory, struct ct_bending *s);
/// Stretch and twist: 1 - xi, xi, 4 xi (1 - xi).
void ct_shape_line(struct ct_shape f[3]);

struct ct_shape ct_shape_mul(const struct ct_shape *a, const struct ct_shape *b);
/// d/dx
struct ct_shape ct_shape_slope(const struct ct_shape *a);
/// Integral over x from the start of the element to xi.
struct ct_shape ct_shape_primitive(const struct ct_shape *a);
/// Value at xi = 1 for h = 1, rounded once, so that exact cancellation gives zero.
double ct_shape_end(const struct ct_shape *a);
bool ct_shape_is_zero(const struct ct_shape *a);
ct_ex ct_shape_at(struct ct_exs *x, const struct ct_shape *a, ct_ex xi, ct_ex length);
double ct_shape_value(const struct ct_shape *a, double xi, double length);

/// Integral of g p over the element. FULL is exact for a constant g (fractions correctly rounded)
/// and for a polynomial g p up to degree 15; ENDS takes half of the integral of g at each end.
ct_ex ct_shape_integral(struct ct_exs *x, const struct ct_profile *g, const struct ct_shape *p,
                        const struct ct_span *e, enum ct_rule rule);
/// Points of a rule and the weight of g at each; returns their number. FULL: n
/// Gauss points.
int ct_shape_points(struct ct_exs *x, const struct ct_profile *g, const struct ct_span *e,
                    enum ct_rule rule, int n, double xi[CT_MAX_GAUSS],
                    ct_ex weight[CT_MAX_GAUSS]);
/// Value at xi.
ct_ex ct_profile_at(struct ct_exs *x, const struct ct_profile *g, const struct ct_span *e,
                    double xi);

#endif
