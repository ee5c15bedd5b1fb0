// What a loop of few unknowns answers to residuals: of (8.2), solved for all right-hand sides at once.
//
// With J P = 1 for P = J' (J J')^-1, the last row of (8.2) gives eta, and what is left is a system in d and lam,
//
//     [ (M + x C) Q + y K   -J' ] ( d     )     ( y r - z (M + x C) P v )
//     [ J                    0  ] ( y lam ) = - ( phi                   ),    Q = 1 - P (J + z D)       (8.2b)
//     speeds change by   c (d - J' eta) = c Q d - P v
//
// d, the change of speeds and lam are one product of a matrix, 2 nu + m by nu + 2 m, with r, phi, v: a correction of a four-bar
// is little more than that. What of it does not depend on c and e is made once for derivatives.
//
// What always holds: columns stand `rows` apart, a multiple of CT_RESPONSE_BLOCK, with zeros below.
#ifndef CT_INTEGRATE_RESPONSE_H
#define CT_INTEGRATE_RESPONSE_H

#include "base/arena.h"
#include "numeric/inverse.h"

#include <complex.h>
#include <stdbool.h>

enum { CT_RESPONSE_BLOCK = 4 };

static inline int ct_response_padded(int n)
{
    return (n + CT_RESPONSE_BLOCK - 1) / CT_RESPONSE_BLOCK * CT_RESPONSE_BLOCK;
}

struct ct_response {
    int nu, m;
    int in, out, rows; // nu + 2 m, 2 nu + m; the latter as padded
    bool is_regular;   // J J' has an inverse
    // of derivatives: M Q0, C Q0, -M P D, K - C P D, Q0 = 1 - P J, P D  (nu x nu);  M P, C P, P  (nu x m)
    double *MQ, *CQ, *MD, *KD, *Q, *PD, *MP, *CP, *P, *J;
    // of c and e: the real product (rows x in), the complex one, real and imaginary parts
    double *real, *re, *im;
    // workspace
    double *A, *E, *square; // the system and its inverse; z (M + x C) P; J J'
    int *pivot;
};

/// Room for nu speeds and up to most_rows rows with at most CT_MOST_INVERTED equations (8.2).
struct ct_response *ct_response_create(struct ct_arena *a, int nu, int most_rows,
                                       bool is_complex);

/// From now on there are m rows, and sizes are as that asks.
void ct_response_set_rows(struct ct_response *s, int m);
/// From derivatives M, C, K (nu x nu), J, D (m x nu).
void ct_response_assemble(struct ct_response *s, const double *M, const double *C,
                          const double *K, const double *J, const double *D);

/// The real product for c and e; false if it cannot be made.
bool ct_response_find(struct ct_response *s, double c, double e);
/// The complex one for c, e = c^2.
bool ct_response_find_complex(struct ct_response *s, double _Complex c);

#endif
