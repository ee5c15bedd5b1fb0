// The matrix of the Newton iteration (8.2) as a sparse matrix, for large models such as long chains
// and beams of many elements.
//
//     plan     symbolic analysis: sparsity pattern, products in each entry, elimination order. One for a problem.
//     newton   numerical values and factors, and the lists M, C, K, J, D. One for a run.
//
// Along chains, auxiliary unknowns (8.19) keep the matrix sparse. They are eliminated inside: for
// the caller M, C and K are the derivatives without them.
//
// What always holds: unused constraint rows keep their entries, with a one on the diagonal, so that
// the pattern does not depend on the selection of rows. There is no plan where dense matrices take
// less time.
#ifndef CT_INTEGRATE_IMPLICIT_NEWTON_SPARSE_H
#define CT_INTEGRATE_IMPLICIT_NEWTON_SPARSE_H

#include "integrate/problem.h"

#include <complex.h>

struct ct_newton_pattern;
struct ct_newton;

/// Estimated operations with the matrix of a problem, in multiplications and additions of dense
/// matrices.
struct ct_newton_work {
    double assembly, factorization, solution; // of one real matrix
};
/// plan == NULL: of a dense matrix of n equations.
struct ct_newton_work ct_newton_work(const struct ct_newton_pattern *plan, int n);

/// NULL if dae has no sparsity patterns or dense matrices take less time.
struct ct_newton_pattern *ct_newton_pattern_create(struct ct_arena *a, const struct ct_dae *dae,
                                                   bool is_stabilised);
/// The same without the comparison to dense matrices; NULL if the sparse solver is not available.
struct ct_newton_pattern *ct_newton_pattern_create_always(struct ct_arena *a,
                                                          const struct ct_dae *dae,
                                                          bool is_stabilised);
/// plan: NULL gives NULL.
struct ct_newton *ct_newton_create(struct ct_arena *a, const struct ct_dae *dae,
                                   const struct ct_newton_pattern *plan, bool is_complex);

/// Selects the constraint rows `kept` (m) of all rows.
void ct_newton_retain_rows(struct ct_newton *s, const int *kept, int m);
/// Evaluates M, C, K, J, D at a point, and with w (nu; or NULL) their products with N.
enum ct_eval ct_newton_evaluate(struct ct_newton *s, double t, const double *q, const double *u,
                                const double *a, const double *lam, const double *w);

/// Factors of the matrix for c and e; for a complex c and e = c^2; and, stored separately, for the
/// low-pass filter with c and e = c^2. False if singular.
bool ct_newton_factor(struct ct_newton *s, double c, double e);
bool ct_newton_factor_complex(struct ct_newton *s, double _Complex one_over_c);
bool ct_newton_factor_slow(struct ct_newton *s, double c);
/// b (n, with the selected rows; complex: imaginary parts follow), in: right-hand side, out:
/// solution.
void ct_newton_solve(struct ct_newton *s, double *b);
void ct_newton_solve_complex(struct ct_newton *s, double *b, int n);
void ct_newton_solve_slow(struct ct_newton *s, double *b);
/// part (nu, out): the part of a unit change of each speed that passes the low-pass filter.
void ct_newton_slow_parts(struct ct_newton *s, double *part);

/// y (nu) += c A x (nu)
void ct_newton_add_mass(const struct ct_newton *s, double *y, double c, const double *x);
void ct_newton_add_stiffness(const struct ct_newton *s, double *y, double c, const double *x);
/// y (nu) += M (a F + b G) + C F, for F and G (nu); G may be NULL.
void ct_newton_add_motion(const struct ct_newton *s, double *y, double a, const double *F,
                          double b, const double *G);
/// y (m) += c J x; y (nu) += c J' x (m)
void ct_newton_add_rows(const struct ct_newton *s, double *y, double c, const double *x);
void ct_newton_add_constraint_force(const struct ct_newton *s, double *y, double c,
                                    const double *x);
/// x' M x, x' K x
double ct_newton_mass_form(const struct ct_newton *s, const double *x);
double ct_newton_stiffness_form(const struct ct_newton *s, const double *x);
/// The diagonal of M (nu, out).
void ct_newton_masses(const struct ct_newton *s, double *mass);

#endif
