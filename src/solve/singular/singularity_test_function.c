// Test function of singular configurations: does J lose rank between two configurations of a
// motion?  (8.40)
// With J T = 0 and N'J = 0, the bordered matrix [J N_0; T_0' 0], with T_0 and N_0 of another
// configuration, is regular as long as J keeps its rank and both null spaces turn by less than a
// right angle. With the retained rows and columns first, and signs of the permutations,
//
//     det [J N_0; T_0' 0] = +- det J_d det (T_0'T) det (N_0'N)
#include "solve/constraint/partition_internal.h"

#include "numeric/dense.h"

struct ct_tangent_basis *ct_tangent_basis_create(struct ct_arena *arena)
{
    return CT_NEW(arena, struct ct_tangent_basis);
}

static void reserve(struct ct_partition *s, double **a, size_t *room, size_t n)
{
    if (n <= *room)
        return;
    *a = CT_NEWN(s->arena, double, n);
    *room = n;
}

void ct_tangent_basis_reserve(struct ct_partition *s, struct ct_tangent_basis *v)
{
    const size_t n = s->m->nu, m = s->m->nrow, r = (size_t)s->rank;
    v->rank = 0;
    if (!r || ct_partition_is_large(s))
        return;
    reserve(s, &v->T, &v->room_T, n * (n - r));
    reserve(s, &v->N, &v->room_N, m * (m - r));
}

// After a loss of rank the bases need more memory than was reserved: there is nothing to
// compare with.
static bool has_room(const struct ct_partition *s, const struct ct_tangent_basis *v)
{
    const size_t n = s->m->nu, m = s->m->nrow, r = (size_t)s->rank;
    return r && n * (n - r) <= v->room_T && m * (m - r) <= v->room_N;
}

// Sign of the permutation (a, b) of 0 ... na + nb - 1. index (na + nb): workspace
static int parity_of(const int *a, int na, const int *b, int nb, int *index)
{
    int parity = 1;
    for (int i = 0; i < na + nb; i++)
        index[i] = i < na ? a[i] : b[i - na];
    for (int i = 0; i < na + nb; i++)
        while (index[i] != i) {
            const int k = index[i];
            index[i] = index[k];
            index[k] = k;
            parity = -parity;
        }
    return parity;
}

// The sign of a determinant from its LU factors.
static int sign_of(const double *LU, const int *pivot, int n)
{
    int sign = 1;
    for (int i = 0; i < n; i++)
        if ((LU[i + n * i] < 0) != (pivot[i] != i))
            sign = -sign;
    return sign;
}

static void find_tangents(const struct ct_partition *s, double *T)
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

// Redundant rows as combinations of the retained ones: N has 1 for the former and minus the
// coefficients of the latter.
static void find_left_null_space(const struct ct_partition *s, double *N)
{
    const int m = (int)s->m->nrow, r = s->rank;
    for (int j = r; j < m; j++, N += m) {
        memset(N, 0, (size_t)m * sizeof *N);
        for (int k = 0; k < r; k++)
            s->d[k] = -*ct_partition_J(s, s->row[j], s->dependent[k]);
        ct_lu_solve(s->d, s->Jd, s->pivot, r, r, 1, r, true);
        N[s->row[j]] = 1;
        for (int k = 0; k < r; k++)
            N[s->row[k]] = s->d[k];
    }
}

void ct_tangent_basis_find(struct ct_partition *s, struct ct_tangent_basis *v)
{
    const size_t n = s->m->nu, m = s->m->nrow, r = (size_t)s->rank;
    v->rank = 0;
    if (!has_room(s, v) || ct_partition_is_large(s)
        || (ct_partition_has_redundant_rows(s) && !ct_partition_factor_only(s)))
        return; // without redundant rows the pivot is that of the factors
    v->rank = s->rank;
    v->side = parity_of(s->row, s->rank, s->row + r, (int)(m - r), s->iwork)
            * parity_of(s->dependent, s->rank, s->independent, (int)(n - r), s->iwork)
            * sign_of(s->Jd, s->pivot, s->rank);
    find_tangents(s, v->T);
    find_left_null_space(s, v->N);
}

// The sign of det (A'B), A and B (m x n); 0 if it is singular.
static int sign_between(struct ct_partition *s, const double *A, const double *B, int m, int n)
{
    if (n == 0)
        return 1;
    if (n == 1) {
        const double d = ct_vector_dot(A, B, (size_t)m);
        return (d > 0) - (d < 0);
    }
    ct_matrix_multiply_transposed(s->S, A, B, n, m, n);
    return ct_lu(s->S, s->iwork, n, n) ? sign_of(s->S, s->iwork, n) : 0;
}

bool ct_singularity_test_sign_changed(struct ct_partition *s,
                                      const struct ct_tangent_basis *from,
                                      const struct ct_tangent_basis *to)
{
    const int n = (int)s->m->nu, m = (int)s->m->nrow, r = to->rank;
    return r && from->rank == r
        && from->side * to->side * sign_between(s, from->T, to->T, n, n - r)
                   * sign_between(s, from->N, to->N, m, m - r)
               < 0;
}
