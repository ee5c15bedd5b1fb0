// The matrix of the iteration, (8.2), as a list of its entries: what beams of many elements and
// long chains have, of whose parts each meets its neighbours or sums over them.
//
//     plan     which entries there are, which products they are sums of, the order they are factored in. One for a problem.
//     newton   their numbers and factors, and the lists M, C, K, J, D they are made of. One for a run.
//
// Where parts meet in sums along a chain, inner values are further unknowns (8.19): they do not
// show, M, C and K are what they lead to.
//
// What always holds: rows that do not count have a place, too, with a one on the diagonal, so that
// the pattern stays when they change. There is no plan where full matrices take less time.
#ifndef CT_INTEGRATE_IMPLICIT_NEWTON_SPARSE_H
#define CT_INTEGRATE_IMPLICIT_NEWTON_SPARSE_H

#include "integrate/problem.h"

#include <complex.h>

struct ct_newton_pattern;
struct ct_newton;

/// What is to be expected of the matrices of a problem, in multiplications and additions of full
/// matrices.
struct ct_newton_work {
    double assembly, factorization, solution; // of one real matrix
};
/// plan: NULL of full ones, of n equations.
struct ct_newton_work ct_newton_work(const struct ct_newton_pattern *plan, int n);

/// dae must know its lists of entries; else, and where it does not pay, NULL.
struct ct_newton_pattern *ct_newton_pattern_create(struct ct_arena *a, const struct ct_dae *dae,
                                                   bool is_stabilised);
/// The same whether it pays or not, where the library is available.
struct ct_newton_pattern *ct_newton_pattern_create_always(struct ct_arena *a,
                                                          const struct ct_dae *dae,
                                                          bool is_stabilised);
/// plan: NULL gives NULL.
struct ct_newton *ct_newton_create(struct ct_arena *a, const struct ct_dae *dae,
                                   const struct ct_newton_pattern *plan, bool is_complex);

/// Rows have changed: of all that there can be, `kept` (m) count.
void ct_newton_retain_rows(struct ct_newton *s, const int *kept, int m);
/// M, C, K, J, D at a point, and with w (nu; or NULL) what N has of them.
enum ct_eval ct_newton_evaluate(struct ct_newton *s, double t, const double *q, const double *u,
                                const double *a, const double *lam, const double *w);

/// Factors for c and e, for c and e = c^2 that are complex, and others for c and e = c^2 that are
/// kept beside them. False if singular.
bool ct_newton_factor(struct ct_newton *s, double c, double e);
bool ct_newton_factor_complex(struct ct_newton *s, double _Complex one_over_c);
bool ct_newton_factor_slow(struct ct_newton *s, double c);
/// b (n, of rows those that count; complex: imaginary parts n behind) in: right-hand side, out:
/// solution.
void ct_newton_solve(struct ct_newton *s, double *b);
void ct_newton_solve_complex(struct ct_newton *s, double *b, int n);
void ct_newton_solve_slow(struct ct_newton *s, double *b);
/// part (nu, out): how much of each speed is left where ct_newton_solve_slow has answered M times
/// that speed alone.
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
