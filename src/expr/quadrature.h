// Integrals of expressions over one symbol by Gauss-Legendre quadrature.
#ifndef CT_EXPR_QUADRATURE_H
#define CT_EXPR_QUADRATURE_H

#include "expr/ex.h"

/// Limit: points of a rule, by the size of local arrays.
enum { CT_GAUSS_MOST = 32 };

/// n points and weights on (0, 1), ascending; exact for polynomials of degree 2 n - 1. 1 <= n <=
/// CT_GAUSS_MOST. Source: roots of the Legendre polynomial by Newton's method from Tricomi's
/// estimate.
void ct_gauss(int n, double point[], double weight[]);

/// Degree of f as a polynomial in the symbol s; -1 if f is not written as a polynomial. Cost: nodes
/// below f.
int ct_ex_degree(struct ct_exs *x, ct_ex f, ct_ex s);

/// Integral of f over s from a to b with n points; exact if the degree of f is below 2 n.
ct_ex ct_ex_integral(struct ct_exs *x, ct_ex f, ct_ex s, ct_ex a, ct_ex b, int n);

#endif
