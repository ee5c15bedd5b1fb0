// See embedding.h: how near J is to losing rank.
#include "solve/embedding.h"

#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

bool ct_embed_is_large(const struct ct_embed *s)
{
    enum { LARGE = 200 };
    return s->rank >= LARGE;
}

static bool find_strength(struct ct_embed *s)
{
    if (!ct_embed_is_large(s) || !ct_embed_is_form_due(s))
        return false;
    s->strength.now = ct_form_close(s->form[0], s->m);
    s->sigma = ct_strength_sigma(&s->strength);
    return ct_embed_is_sound(s);
}

// A (nrow x nrow, out) = J J', its lower triangle.
static void square(const struct ct_embed *s, double *A)
{
    const size_t n = s->m->nu, m = s->m->nrow;
    const double *J = s->m->J;
    memset(A, 0, m * m * sizeof *A);
    for (size_t k = 0; k < n; k++, J += m)
        for (size_t j = 0; j < m; j++)
            if (J[j] != 0)
                ct_vector_add(A + m * j + j, J[j], J + j, m - j);
}

// The squares of the first `rank` singular values of J, ascending; NULL if they are not found. Eigenvalues of J J' cost a
// third of a decomposition; half the digits are enough.
static const double *squared_singular_values(struct ct_embed *s)
{
    const int m = (int)s->m->nrow;
    square(s, s->A);
    return ct_symmetric_eigenvalues(s->b, s->A, m, m, s->work) ? s->b + m - s->rank : NULL;
}

static double smallest_singular_value(struct ct_embed *s)
{
    const double *square = squared_singular_values(s);
    return square ? sqrt(fmax(0, *square)) : 0;
}

bool ct_embed_has_pivot(const struct ct_embed *s)
{
    return s->rank && !(ct_embed_has_redundant_rows(s) && ct_embed_is_large(s));
}

bool ct_embed_pivot_is_between(struct ct_embed *s, double low, double high)
{
    const int m = (int)s->m->nrow, nzero = m - s->rank;
    if (!ct_embed_has_redundant_rows(s))
        return false;
    square(s, s->A);
    memcpy(s->MB, s->A, (size_t)(m * m) * sizeof *s->A);
    return ct_symmetric_count_below(s->A, m, m, low * low) == nzero
        && ct_symmetric_count_below(s->MB, m, m, high * high) > nzero;
}

double ct_embed_pivot(struct ct_embed *s)
{
    if (ct_embed_has_redundant_rows(s))
        return smallest_singular_value(s);
    // the place need not be one of the motion: what is known of the motion stays
    const double sigma = s->sigma, kappa = s->kappa, strength = s->strength.now;
    const bool is_known = find_strength(s) || ct_embed_factor(s);
    const double pivot = is_known ? s->sigma * s->largest * fmax(1, s->kappa) : 0;
    s->sigma = sigma;
    s->kappa = kappa;
    s->strength.now = strength;
    return pivot;
}

// log of the product of the first `rank` singular values: kept rows may lose more rank than all do.
static double log_volume(struct ct_embed *s)
{
    const double *square = squared_singular_values(s);
    double sum = 0;
    for (int i = 0; i < s->rank; i++)
        sum += square ? log(fmax(DBL_MIN, square[i])) / 2 : 0;
    return sum;
}

bool ct_embed_dependence(struct ct_embed *s, double *x, double *log_det)
{
    const int r = s->rank;
    const double sigma = s->sigma, kappa = s->kappa;
    const bool is_found = !ct_embed_is_large(s) && ct_embed_factor(s);
    s->sigma = sigma;
    s->kappa = kappa;
    *log_det = 0;
    for (int i = 0; i < r && is_found; i++) {
        x[i] = 1 + fmod(i * 0.6180339887498949, 1); // in no simple relation
        *log_det += log(fabs(s->Jd[i + r * i]));
    }
    if (is_found) {
        ct_lu_solve(x, s->Jd, s->pivot, r, r, 1, r, false);
        ct_lu_solve(x, s->Jd, s->pivot, r, r, 1, r, true);
    }
    if (is_found && ct_embed_has_redundant_rows(s))
        *log_det = log_volume(s);
    return is_found;
}
