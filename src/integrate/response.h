// What loops of few unknowns answer to residuals: (8.2) solved for all right-hand sides at once.
//
// Motions are split along the rows and across them, d = Z w - P phi with J Z = 0, Z' Z = 1 and P = J' (J J')^-1. Then
// eta drops out of (8.2), and lam follows from w:
//
//     B = (M + x C) (1 - P J) + y K - z (M + x C) P D,   F = z (M + x C) P
//     w     = (Z' B Z)^-1 Z' (B P phi - y r + F v)
//     y lam = P' (B d + y r - F v)                                                                 (8.2b)
//     speeds change by   c (d - J' eta) = c Z w - P D d - P v
//
// so that only as many equations are left as there are freedoms. d, the change of speeds and lam are one product of a matrix,
// 2 nu + m by nu + 2 m, with r, phi, v: a correction of a four-bar is little more than that.
//
// What always holds: columns of the products stand `rows` apart, a multiple of CT_RESPONSE_BLOCK, with zeros below.
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
    int nu, m, free;   // nu - m
    int in, out, rows; // nu + 2 m, 2 nu + m; the latter as padded
    bool is_regular;   // J has a right inverse
    // of derivatives, T = [Z P]
    double *T;           // (nu x nu)
    double *M, *C, *K;   // T' M T, T' C T, T' K T less the part of D in C, (nu x nu)
    double *D, *MD, *PD; // D T (m x nu); T' M P D T, P D T (nu x nu)
    // of c and e: the real product (rows x in), and that with the complex one in fours  (4 x rows x in)
    double *real;
    double *straight; // of the real one, real parts twice, zero
    double *crossed;  // zero, minus the imaginary part, that, zero
    // workspace: T' B T (nu x nu), T' F (nu x m), (Z' B Z)^-1
    double *G, *F, *R;
    double _Complex *Gc, *Fc, *Rc;
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
/// The complex one for c, e = c^2, after the real one, with which it is put into fours.
bool ct_response_find_complex(struct ct_response *s, double _Complex c);

#endif
