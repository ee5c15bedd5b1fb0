// Steps towards an equilibrium of large systems, for positions and multipliers together:
//
//     [ K  J' ] [  dq   ]     [ r   ]
//     [ J  0  ] [ -dlam ] = - [ phi ]
//
// If the forces would do negative work along the step, as near a saddle or along a direction
// without stiffness, K is replaced by K + s M. The shift s is increased until the step descends
// the potential.
#include "analysis/equilibrium_step.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Shifts s, relative to the largest stiffness over the largest mass: from round-off to beyond
// the stiffest direction.
// Limit: of the search, twelve factorisations.
static const double first_shift = 1e-12, next_shift = 30;
enum { MOST_SHIFTS = 12 };

static void reserve(struct ct_equilibrium_search *s)
{
    const size_t n = (size_t)s->l->nu + (size_t)s->l->nrow + 1;
    s->p = ct_point_here(s->l);
    s->b = CT_NEWN(s->l->arena, double, n);
    s->x = CT_NEWN(s->l->arena, double, n);
}

static bool evaluate(struct ct_equilibrium_search *s)
{
    return ct_point_evaluate(s->p);
}

static double slope(const struct ct_equilibrium_search *s)
{
    return ct_vector_dot(s->p->r, s->dq, (size_t)s->l->nu);
}

// The step with K + shift M. False if that matrix is singular.
static bool solve(struct ct_equilibrium_search *s, double shift)
{
    const size_t nu = (size_t)s->l->nu, nrow = (size_t)s->l->nrow;
    struct ct_sparse *matrix = ct_point_factor(s->p, 1, shift);
    if (!matrix)
        return false;
    for (size_t i = 0; i < nu; i++)
        s->b[i] = -s->p->r[i];
    for (size_t i = 0; i < nrow; i++)
        s->b[nu + i] = -s->p->phi[i];
    ct_sparse_solve_extended(matrix, s->x, s->b);
    for (size_t i = 0; i < nu + nrow; i++)
        if (!isfinite(s->x[i]))
            return false;
    memcpy(s->dq, s->x, nu * sizeof *s->dq);
    for (size_t i = 0; i < nrow; i++) // r contains -J' lam
        s->dlam[i] = -s->x[nu + i];
    return true;
}

static bool find_newton_step(struct ct_equilibrium_search *s)
{
    return solve(s, 0);
}

static bool find_step(struct ct_equilibrium_search *s)
{
    const double ratio = ct_point_largest(s->p->K, s->p->nK)
                       / fmax(ct_point_largest(s->p->M, s->p->nM), DBL_MIN);
    double shift = first_shift * fmax(ratio, 1);
    s->is_newton
        = solve(s, 0)
       && (slope(s) < 0 || ct_vector_largest(s->dq, (size_t)s->l->nu) < CT_EQUILIBRIUM_FINE);
    for (int i = 0; i < MOST_SHIFTS && !s->is_newton; i++, shift *= next_shift)
        if (solve(s, shift) && slope(s) <= 0)
            return true;
    return s->is_newton;
}

static bool is_balanced(struct ct_equilibrium_search *s)
{
    const struct ct_linear *l = s->l;
    const size_t nu = (size_t)l->nu;
    double *meet = s->b;
    memset(meet, 0, nu * sizeof *meet);
    for (size_t i = 0; i < s->p->nK; i++) {
        const int q = l->m->e->u[s->p->K[i].direction].q;
        if (q >= 0)
            meet[s->p->K[i].row] += fabs(s->p->K[i].value * l->y[q]);
    }
    return ct_vector_largest(s->p->r, nu) <= 8 * DBL_EPSILON * ct_vector_largest(meet, nu);
}

const struct ct_equilibrium_method ct_equilibrium_sparse
    = {reserve, evaluate, find_step, find_newton_step, slope, is_balanced};
