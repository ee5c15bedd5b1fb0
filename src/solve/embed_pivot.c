// See embedding.h: how near J is to losing rank.
#include "solve/embedding.h"

#include "numeric/dense.h"

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

static bool has_redundant_rows(const struct ct_embed *s)
{
    return s->rank < (int)s->m->nrow;
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

static double smallest_singular_value(struct ct_embed *s)
{
    // from the eigenvalues of J J', which cost a third of a decomposition; half the digits are enough
    const int m = (int)s->m->nrow;
    square(s, s->A);
    if (!ct_symmetric_eigenvalues(s->b, s->A, m, m, s->work))
        return 0;
    return sqrt(fmax(0, s->b[m - s->rank]));
}

bool ct_embed_has_pivot(const struct ct_embed *s)
{
    return s->rank && !(has_redundant_rows(s) && ct_embed_is_large(s));
}

bool ct_embed_pivot_is_between(struct ct_embed *s, double low, double high)
{
    const int m = (int)s->m->nrow, nzero = m - s->rank;
    if (!has_redundant_rows(s))
        return false;
    square(s, s->A);
    memcpy(s->MB, s->A, (size_t)(m * m) * sizeof *s->A);
    return ct_symmetric_count_below(s->A, m, m, low * low) == nzero
        && ct_symmetric_count_below(s->MB, m, m, high * high) > nzero;
}

double ct_embed_pivot(struct ct_embed *s)
{
    if (has_redundant_rows(s))
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

// 1, or -1 if an odd number of exchanges sorts a and b, which together are 0 ... na + nb - 1. place (na + nb)
static int parity_of(const int *a, int na, const int *b, int nb, int *place)
{
    int parity = 1;
    for (int i = 0; i < na + nb; i++)
        place[i] = i < na ? a[i] : b[i - na];
    for (int i = 0; i < na + nb; i++)
        while (place[i] != i) {
            const int k = place[i];
            place[i] = place[k];
            place[k] = k;
            parity = -parity;
        }
    return parity;
}

int ct_embed_side(const struct ct_embed *s)
{
    if (has_redundant_rows(s) || ct_embed_is_large(s))
        return 0;
    const int r = s->rank;
    int side = parity_of(s->row, r, s->row, 0, s->iwork)
             * parity_of(s->dependent, r, s->independent, (int)s->m->nu - r, s->iwork);
    for (int i = 0; i < r; i++)
        if ((s->Jd[i + r * i] < 0) != (s->pivot[i] != i))
            side = -side;
    return side;
}

void ct_embed_tangents(const struct ct_embed *s, double *T)
{
    const size_t n = s->m->nu;
    const int r = s->rank;
    for (int j = 0; j < (int)n - r; j++, T += n) {
        memset(T, 0, n * sizeof *T);
        T[s->independent[j]] = 1;
        for (int k = 0; k < r; k++)
            T[s->dependent[k]] = s->B[k + r * j];
    }
}

// The rows of J with the tangents of the other place, [J; T'], are as large a system as there are speeds, which is regular as long as
// tangents turn by less than a right angle and J has its rank. det [J; T'] = det J_d det (T' [B; 1]_now), of which the
// second factor is positive at the other place.
int ct_embed_side_against(struct ct_embed *s, const double *T)
{
    const int n = (int)s->m->nu, r = s->rank, f = n - r;
    int side = ct_embed_side(s);
    for (int j = 0; j < f; j++)
        for (int i = 0; i < f; i++) {
            s->S[i + f * j] = T[s->independent[j] + n * i];
            for (int k = 0; k < r; k++)
                s->S[i + f * j] += T[s->dependent[k] + n * i] * s->B[k + r * j];
        }
    if (f && !ct_lu(s->S, s->iwork, f, f))
        return 0;
    for (int i = 0; i < f; i++)
        if ((s->S[i + f * i] < 0) != (s->iwork[i] != i))
            side = -side;
    return side;
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
    return is_found;
}
