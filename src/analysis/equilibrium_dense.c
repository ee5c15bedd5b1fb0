// Steps towards an equilibrium with dense matrices, in the independent speeds.
//
// The generalised eigenvectors V satisfy V' Kr V = diag(value) and V' W V = 1 with the mass
// matrix W. Along a direction of positive stiffness the step is Newton's; along one of negative
// stiffness it has the opposite sign. Along a direction without stiffness it is as long as the
// limits allow if a force acts there, and zero otherwise.
#include "analysis/equilibrium_step.h"
#include "formulate/build.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

static void reserve(struct ct_equilibrium_search *s)
{
    struct ct_arena *a = s->l->arena;
    const size_t n = (size_t)s->l->nu + 1;
    double **const squares[] = {&s->H, &s->V, &s->A};
    for (size_t i = 0; i < COUNT(squares); i++)
        *squares[i] = CT_NEWN(a, double, n *n);
    double **const vectors[] = {&s->scale, &s->gross, &s->value, &s->x};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, n);
    s->work = CT_NEWN(a, double, n + ct_symmetric_eigenvalues_work((int)n));
    s->pivot = CT_NEWN(a, int, n);
}

static bool evaluate(struct ct_equilibrium_search *s)
{
    return ct_linear_rest(s->l);
}

// A <- the symmetric part of A (nfree x nfree).
static void symmetric_part(const struct ct_equilibrium_search *s, double *out, const double *A)
{
    const int n = s->l->nfree;
    memcpy(out, A, (size_t)n * (size_t)n * sizeof *out);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < j; i++)
            out[i + n * j] = out[j + n * i] = (out[i + n * j] + out[j + n * i]) / 2;
}

static void find_stiffness(struct ct_equilibrium_search *s)
{
    const int n = s->l->nfree;
    // Relative to the mass matrix: added to it so that massless directions have some mass.
    // Derived: the square root of eps. The step of directions with mass changes by `little`, that
    // of massless ones has a round-off of eps/`little`.
    const double little = 1.5e-8;
    double *W = s->A, mean = 0;
    symmetric_part(s, W, s->l->Mr);
    for (int i = 0; i < n; i++)
        mean += W[i + n * i] / n;
    for (int i = 0; i < n; i++)
        W[i + n * i] += little * fmax(W[i + n * i], mean > 0 ? mean : 1 / little);
    symmetric_part(s, s->H, s->l->Kr);
    ct_cholesky(W, n, n);
    ct_cholesky_congruence(s->H, W, n, n);
    ct_symmetric_eigen(s->value, s->H, n, n, s->work);
    memcpy(s->V, s->H, (size_t)n * (size_t)n * sizeof *s->V);
    for (int j = 0; j < n; j++)
        ct_cholesky_solve_transposed(s->V + (size_t)n * (size_t)j, W, n, n);
}

// Magnitudes of the terms that each force sums: constraint forces, weights, and the stiffness
// times one unit of displacement.
static void find_scale(struct ct_equilibrium_search *s)
{
    const struct ct_linear *l = s->l;
    const int nu = l->nu;
    double weight = 0;
    for (int k = 0; k < 3; k++)
        weight = fmax(weight, fabs(ct_model_number(l->m->model, l->m->model->gravity.e[k])));
    for (int j = 0; j < nu; j++) {
        s->gross[j] = l->scale[j];
        for (int i = 0; i < nu; i++)
            s->gross[j] += fabs(l->M[j + nu * i]) * weight + fabs(l->K[j + nu * i]);
    }
    for (int k = 0; k < l->nfree; k++) {
        s->scale[k] = 0;
        for (int j = 0; j < nu; j++)
            s->scale[k] += fabs(l->Z[j + nu * k]) * s->gross[j];
    }
}

// Is the stiffness positive definite by more than its round-off? Each pivot is compared with
// its own diagonal entry. A structure of many elements, whose softest direction is far below
// its stiffest, is then not taken for a mechanism.
static bool is_positive(struct ct_equilibrium_search *s)
{
    const int n = s->l->nfree;
    double *L = s->A, *diagonal = s->x;
    symmetric_part(s, L, s->l->Kr);
    for (int i = 0; i < n; i++)
        diagonal[i] = L[i + n * i];
    if (!ct_cholesky(L, n, n))
        return false;
    for (int i = 0; i < n; i++)
        if (!(L[i + n * i] * L[i + n * i] > ct_roundoff(n) * diagonal[i]))
            return false;
    return true;
}

// Uses the unsymmetric stiffness, so that forces without a potential count.
static bool find_newton_step(struct ct_equilibrium_search *s)
{
    const struct ct_linear *l = s->l;
    const int n = l->nfree;
    if (n) {
        memcpy(s->A, l->Kr, (size_t)n * (size_t)n * sizeof *s->A);
        if (!ct_lu(s->A, s->pivot, n, n))
            return false;
        for (int i = 0; i < n; i++)
            s->x[i] = -l->force[i];
        ct_lu_solve(s->x, s->A, s->pivot, n, n, 1, n, false);
    }
    ct_linear_expand(l, s->dq, s->x);
    return true;
}

static bool find_step(struct ct_equilibrium_search *s)
{
    const struct ct_linear *l = s->l;
    const int n = l->nfree;
    double *y = s->x;
    memset(s->dq, 0, (size_t)l->nu * sizeof *s->dq);
    if (!n)
        return true;
    find_scale(s);
    find_stiffness(s);
    const double stiffest = fmax(fabs(s->value[0]), fabs(s->value[n - 1]));
    s->is_newton = s->value[0] > ct_roundoff(n) * stiffest || is_positive(s);
    if (s->is_newton && find_newton_step(s))
        return true;
    memset(y, 0, (size_t)n * sizeof *y);
    for (int k = 0; k < n; k++) {
        // Limit: longer than any step length, to which the step is cut later.
        const double *v = s->V + (size_t)n * (size_t)k, far = 1e30;
        double g = 0, size = 0;
        for (int i = 0; i < n; i++) {
            g += v[i] * l->force[i];
            size += fabs(v[i]) * s->scale[i];
        }
        const bool is_flat = fabs(s->value[k]) <= ct_roundoff(n) * stiffest;
        const double along = !is_flat                             ? -g / fabs(s->value[k])
                           : fabs(g) <= ct_roundoff(l->nu) * size ? 0
                                                                  : copysign(far, -g);
        for (int i = 0; i < n; i++)
            y[i] += along * v[i];
    }
    ct_linear_expand(l, s->dq, y);
    return true;
}

static double slope(const struct ct_equilibrium_search *s)
{
    double sum = 0;
    for (int i = 0; i < s->l->nfree; i++)
        sum += s->l->force[i] * s->dq[s->l->independent[i]];
    return sum;
}

static bool is_balanced(struct ct_equilibrium_search *s)
{
    find_scale(s);
    for (int k = 0; k < s->l->nfree; k++)
        if (fabs(s->l->force[k]) > 8 * DBL_EPSILON * s->scale[k])
            return false;
    return true;
}

const struct ct_equilibrium_method ct_equilibrium_dense
    = {reserve, evaluate, find_step, find_newton_step, slope, is_balanced};
