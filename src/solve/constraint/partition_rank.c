// Distance of J from loss of rank; see partition_internal.h.
#include "solve/constraint/partition_internal.h"

#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

bool ct_partition_is_large(const struct ct_partition *s)
{
    return s->rank >= CT_LARGE_SYSTEM;
}

static bool find_strength(struct ct_partition *s)
{
    if (!ct_partition_is_large(s) || !ct_partition_is_solver_due(s))
        return false;
    s->strength.now = ct_solver_close(s->solver[0], s->m);
    s->sigma = ct_strength_sigma(&s->strength);
    return ct_partition_is_sound(s);
}

// The largest lever arm [m] of a row of lengths: its largest coefficient of a rotation; 0:
// none.
static double lever_of(const struct ct_partition *s, size_t row)
{
    double lever = 0;
    for (size_t k = 0; k < s->m->nu && s->m->e->row[row].is_length; k++)
        if (s->m->e->u[k].is_rotation)
            lever = fmax(lever, fabs(*ct_partition_J(s, (int)row, (int)k)));
    return lever;
}

// Lever arms of all rows (nrow, out); all rows of a joint get the largest of them, as a row may
// have none where points are collinear. Returns the largest of all.
static double find_levers(const struct ct_partition *s, double *lever)
{
    const struct ct_row *row = s->m->e->row;
    double most = 0;
    for (size_t i = 0, first = 0; i < s->m->nrow; i++) {
        lever[i] = lever_of(s, i);
        most = fmax(most, lever[i]);
        if (!i || row[i].joint != row[i - 1].joint || row[i].is_length != row[i - 1].is_length)
            first = i;
        lever[first] = fmax(lever[first], lever[i]);
        for (size_t k = first; k <= i; k++)
            lever[k] = lever[first];
    }
    return most;
}

void ct_partition_find_units(struct ct_partition *s)
{
    // All rows have one unit while their lever arms differ by less than this factor.
    // Chosen: rows of one size against small and large loops in one mechanism.
    const double one_unit_ratio = 4;
    // Fraction of the largest lever arm below which a row has none, as its points coincide
    // initially.
    // Default: coincidence to the precision of the data against short links. Test: singular
    const double zero_lever = 1e-4;
    const double most = find_levers(s, s->unit);
    double largest = 0, least = INFINITY;
    for (size_t i = 0; i < s->m->nrow; i++) {
        if (s->unit[i] <= zero_lever * most)
            s->unit[i] = s->unit[i] > 0 ? most : 1;
        largest = fmax(largest, s->unit[i]);
        least = fmin(least, s->unit[i]);
    }
    s->has_units = largest > one_unit_ratio * least;
}

// A (nrow x nrow, out) = the lower triangle of J J', with rows of J divided by their units.
static void find_JJt(const struct ct_partition *s, double *A)
{
    const size_t n = s->m->nu, m = s->m->nrow;
    const double *J = s->m->J;
    memset(A, 0, m * m * sizeof *A);
    for (size_t k = 0; k < n; k++, J += m)
        for (size_t j = 0; j < m; j++)
            if (J[j] != 0)
                ct_vector_add(A + m * j + j, J[j], J + j, m - j);
    for (size_t j = 0; j < m && s->has_units; j++)
        for (size_t i = j; i < m; i++)
            A[i + m * j] /= s->unit[i] * s->unit[j];
}

// Squares of the largest `rank` singular values of J, ascending; NULL if the iteration fails.
// They are eigenvalues of J J', at a third of the cost of a singular value decomposition. Half
// the significant digits remain, which is enough.
static const double *squared_singular_values(struct ct_partition *s)
{
    const int m = (int)s->m->nrow;
    find_JJt(s, s->A);
    return ct_symmetric_eigenvalues(s->b, s->A, m, m, s->work) ? s->b + m - s->rank : NULL;
}

static double smallest_singular_value(struct ct_partition *s)
{
    const double *square = squared_singular_values(s);
    return square ? sqrt(fmax(0, *square)) : 0;
}

bool ct_partition_has_pivot(const struct ct_partition *s)
{
    return s->rank && !s->m->e->is_open
        && !(ct_partition_has_redundant_rows(s) && ct_partition_is_large(s));
}

// The smallest pivot of J_d, each divided by the unit of its row.
static double smallest_pivot(struct ct_partition *s)
{
    const int r = s->rank;
    double least = INFINITY;
    memcpy(s->iwork, s->row, (size_t)r * sizeof *s->row);
    for (int i = 0; i < r; i++) {
        const int k = s->pivot[i], row = s->iwork[k];
        s->iwork[k] = s->iwork[i];
        s->iwork[i] = row;
        least = fmin(least, fabs(s->Jd[i + r * i]) / s->unit[row]);
    }
    return least;
}

double ct_partition_pivot(struct ct_partition *s)
{
    if (ct_partition_has_redundant_rows(s))
        return smallest_singular_value(s);
    // at a trial configuration: sigma, kappa and strength of the motion are kept
    const double sigma = s->sigma, kappa = s->kappa, strength = s->strength.now;
    const bool is_strength = find_strength(s), is_known = is_strength || ct_partition_factor(s);
    const double least
        = s->has_units && !is_strength ? smallest_pivot(s) : s->sigma * s->largest;
    const double pivot = is_known ? least * fmax(1, s->kappa) : 0;
    s->sigma = sigma;
    s->kappa = kappa;
    s->strength.now = strength;
    return pivot;
}

// Logarithm of the product of the largest `rank` singular values of J. With redundant rows the
// retained ones may lose more rank than J.
static double log_volume(struct ct_partition *s)
{
    const double *square = squared_singular_values(s);
    double sum = 0;
    for (int i = 0; i < s->rank; i++)
        sum += square ? log(fmax(DBL_MIN, square[i])) / 2 : 0;
    return sum;
}

bool ct_partition_dependence(struct ct_partition *s, double *x, double *log_det)
{
    const int r = s->rank;
    const bool is_found = !ct_partition_is_large(s) && ct_partition_factor_only(s);
    *log_det = 0;
    for (int i = 0; i < r && is_found; i++) {
        x[i] = 1 + fmod(i * 0.6180339887498949, 1); // golden-ratio sequence: arbitrary values
        *log_det += log(fabs(s->Jd[i + r * i]));
    }
    if (is_found) {
        ct_lu_solve(x, s->Jd, s->pivot, r, r, 1, r, false);
        ct_lu_solve(x, s->Jd, s->pivot, r, r, 1, r, true);
    }
    if (is_found && ct_partition_has_redundant_rows(s))
        *log_det = log_volume(s);
    return is_found;
}
