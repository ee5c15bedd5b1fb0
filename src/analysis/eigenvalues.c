// See eigenvalues.h.
//
// Without damping, gyroscopic and circulatory forces the problem is symmetric and is solved by
// a symmetric eigensolver. Otherwise the equations are transformed to the modes of their
// symmetric part. There all coordinates have the same units of time and mass, and directions
// without stiffness are exact zeros. Coordinates without mass are eliminated by static
// condensation. If dampers act on them, they become additional states of the state-space form
// instead.
#include "analysis/eigenvalues.h"
#include "analysis/state_space.h"
#include "base/sort.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

// out (k x k) = V' A V, V (n x k)
static void congruence(double *out, const double *V, const double *A, double *work, int n,
                       int k)
{
    ct_matrix_multiply(work, A, V, n, n, k);
    ct_matrix_multiply_transposed(out, V, work, k, n, k);
}

static void symmetrise(double *A, int n)
{
    for (int j = 0; j < n; j++)
        for (int i = 0; i < j; i++)
            A[i + n * j] = A[j + n * i] = (A[i + n * j] + A[j + n * i]) / 2;
}

// ---- the symmetric problem ------------------------------------------------------------------

// Shapes V (n x k, out) with V' M V = 1 and V' K V = diag(w2); N (n x n0, out) spans the
// directions without mass.
struct basis {
    int n, k, n0;
    double *V, *w2, *N;
    double *S;     // n0 x k: motion along N that follows the shapes V
    double *error; // n: error bounds of the entries of N
    bool is_held;  // stiffness or damping determines the motion along N
};

// Splits the coordinates into mass-normalised directions V and massless directions N of Mr.
static void split_by_mass(struct ct_arena *a, const double *Mr, int n, struct basis *s)
{
    double *M = CT_NEWN(a, double, n *n + 1), *scale = CT_NEWN(a, double, n + 1);
    double *value = CT_NEWN(a, double, n + 1),
           *work = CT_NEWN(a, double, ct_symmetric_eigenvalues_work(n));
    for (int i = 0; i < n; i++)
        scale[i] = Mr[i + n * i] > 0 ? 1 / sqrt(Mr[i + n * i]) : 1;
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            M[i + n * j] = (Mr[i + n * j] + Mr[j + n * i]) / 2 * scale[i] * scale[j];
    ct_symmetric_eigen(value, M, n, n, work);
    s->V = CT_NEWN(a, double, n *n + 1);
    s->N = CT_NEWN(a, double, n *n + 1);
    for (int k = 0; k < n; k++) {
        const bool moves = value[k] > ct_roundoff(n) * value[n - 1];
        double *out = moves ? s->V + n * s->k++ : s->N + n * s->n0++;
        for (int i = 0; i < n; i++)
            out[i] = scale[i] * M[i + n * k] / (moves ? sqrt(value[k]) : 1);
    }
    s->error = scale;
    for (int i = 0; i < n && s->k; i++)
        s->error[i]
            // error of an eigenvector: round-off over the gap to other eigenvalues
            *= ct_roundoff(n) * value[n - 1] / value[s->n0];
}

// Bounds the errors of N' K B (n0 x m, with B n x m) that come from round-off, from the errors
// of N and, if B has them, from the same errors of B.
static void bound_errors(double *bound, const struct basis *s, const double *K, const double *B,
                         int m, bool is_same)
{
    const int n = s->n, n0 = s->n0;
    memset(bound, 0, (size_t)n0 * (size_t)m * sizeof *bound);
    for (int j = 0; j < m; j++)
        for (int p = 0; p < n; p++) {
            double exact = 0, off = 0;
            for (int q = 0; q < n; q++) {
                exact += fabs(K[p + n * q] * B[q + n * j]);
                off += is_same ? fabs(K[p + n * q]) * s->error[q] : 0;
            }
            for (int i = 0; i < n0; i++)
                bound[i + n0 * j] += fabs(s->N[p + n * i]) * (ct_roundoff(n) * exact + off)
                                   + s->error[p] * (exact + off);
        }
}

// Diagonalises the stiffness of the massless directions, K_nn = Q diag(held) Q', and replaces N
// by N Q. held is 0 for a direction whose stiffness is round-off. False if the eigensolver
// fails.
static bool turn_massless(struct ct_arena *a, const double *K, struct basis *s, double *held)
{
    const int n = s->n, n0 = s->n0;
    double *Q = CT_NEWN(a, double, n0 *n0 + 1), *KN = CT_NEWN(a, double, n *n0 + 1),
           *N = CT_NEWN(a, double, n *n0 + 1), *bound = CT_NEWN(a, double, n0 *n0 + 1),
           *work = CT_NEWN(a, double, ct_symmetric_eigenvalues_work(n0));
    congruence(Q, s->N, K, KN, n, n0);
    symmetrise(Q, n0);
    if (!ct_symmetric_eigen(held, Q, n0, n0, work))
        return false;
    ct_matrix_multiply(N, s->N, Q, n, n0, n0);
    s->N = N;
    bound_errors(bound, s, K, N, n0, true);
    for (int i = 0; i < n0; i++)
        if (fabs(held[i]) <= bound[i + n0 * i])
            held[i] = 0;
    return true;
}

// Eliminates the massless directions by static condensation, K_nn s = -K_nv. Directions without
// stiffness stay at rest. False if a force acts along one of these: then its motion is not
// determined.
static bool condense(struct ct_arena *a, const double *K, struct basis *s)
{
    const int n = s->n, k = s->k, n0 = s->n0;
    double *KV = CT_NEWN(a, double, n *n + 1), *held = CT_NEWN(a, double, n0 + 1),
           *bound = CT_NEWN(a, double, n0 *k + 1);
    s->S = CT_NEWN(a, double, n0 *k + 1);
    if (!turn_massless(a, K, s, held))
        return false;
    ct_matrix_multiply(KV, K, s->V, n, n, k);
    ct_matrix_multiply_transposed(s->S, s->N, KV, n0, n, k);
    bound_errors(bound, s, K, s->V, k, false);
    for (int j = 0; j < k; j++)
        for (int i = 0; i < n0; i++) {
            double *x = &s->S[i + n0 * j];
            if (held[i] == 0 && fabs(*x) > bound[i + n0 * j])
                return false;
            *x = held[i] == 0 ? 0 : -*x / held[i];
        }
    for (int j = 0; j < k; j++)
        for (int i = 0; i < n0; i++)
            for (int p = 0; p < n; p++)
                s->V[p + n * j] += s->N[p + n * i] * s->S[i + n0 * j];
    s->is_held = true;
    return true;
}

// Shapes of the symmetric parts of K and M, without massless directions that have no stiffness.
static void solve_symmetric(struct ct_arena *a, const double *Mr, const double *Kr, int n,
                            struct basis *s)
{
    *s = (struct basis){.n = n};
    split_by_mass(a, Mr, n, s);
    const int k = s->k;
    double *K = CT_NEWN(a, double, n *n + 1), *H = CT_NEWN(a, double, n *n + 1),
           *work = CT_NEWN(a, double, n *n + ct_symmetric_eigenvalues_work(n));
    memcpy(K, Kr, (size_t)n * (size_t)n * sizeof *K);
    symmetrise(K, n);
    if (s->n0)
        condense(a, K, s);
    else
        s->is_held = true;
    s->w2 = CT_NEWN(a, double, k + 1);
    congruence(H, s->V, K, work, n, k);
    symmetrise(H, k);
    ct_symmetric_eigen(s->w2, H, k, k, work);
    double *V = CT_NEWN(a, double, n *n + 1);
    ct_matrix_multiply(V, s->V, H, n, k, k);
    s->V = V;
}

// Sets eigenvalues below their own round-off to zero.
static void clear_zeros(struct basis *s)
{
    const double zero
        = ct_roundoff(s->n) * fmax(fabs(s->w2[s->k ? s->k - 1 : 0]), fabs(s->w2[0]));
    for (int j = 0; j < s->k; j++)
        if (fabs(s->w2[j]) <= zero)
            s->w2[j] = 0;
}

// L (n x n, out) = Cholesky factor of the symmetric part of K. False if K is not positive
// definite by more than its round-off.
static bool factor_stiffness(double *L, const double *K, int n)
{
    memcpy(L, K, (size_t)n * (size_t)n * sizeof *L);
    symmetrise(L, n);
    if (!ct_cholesky(L, n, n))
        return false;
    for (int i = 0; i < n; i++)
        if (!(L[i + n * i] * L[i + n * i] > ct_roundoff(n) * K[i + n * i]))
            return false;
    return true;
}

// Recomputes the slow modes from M y = K y / w2, where their eigenvalues are the largest, so
// that their round-off is relative to themselves and not to the fastest mode. Does so for the
// modes below the geometric mean of the slowest and the fastest frequency. L: Cholesky factor
// of K; M (n x n).
static void refine_slow(struct ct_arena *a, const double *M, const double *L, struct basis *s)
{
    const int n = s->n;
    double *H = CT_NEWN(a, double, n *n + 1), *value = CT_NEWN(a, double, n + 1),
           *work = CT_NEWN(a, double, ct_symmetric_eigenvalues_work(n));
    memcpy(H, M, (size_t)n * (size_t)n * sizeof *H);
    symmetrise(H, n);
    ct_cholesky_congruence(H, L, n, n);
    if (!s->k || !ct_symmetric_eigen(value, H, n, n, work))
        return;
    const double middle = sqrt(1 / value[n - 1]) * sqrt(s->w2[s->k - 1]);
    for (int j = 0; j < s->k && s->w2[j] < middle; j++) {
        const int from = n - 1 - j; // index: the eigenvalues 1/w2 ascend
        double *y = s->V + (size_t)n * (size_t)j;
        memcpy(y, H + (size_t)n * (size_t)from, (size_t)n * sizeof *y);
        ct_cholesky_solve_transposed(y, L, n, n);
        s->w2[j] = 1 / value[from];
        for (int i = 0; i < n; i++)
            y[i] *= sqrt(s->w2[j]);
    }
}

double ct_stiffness_least(struct ct_arena *a, const struct ct_linear *l, double *y)
{
    struct basis s;
    memset(y, 0, (size_t)l->nfree * sizeof *y);
    if (!l->nfree)
        return INFINITY;
    solve_symmetric(a, l->Mr, l->Kr, l->nfree, &s);
    if (!s.k)
        return INFINITY;
    double *L = CT_NEWN(a, double, (size_t)s.n *(size_t)s.n + 1);
    if (factor_stiffness(L, l->Kr, s.n))
        refine_slow(a, l->Mr, L, &s);
    else
        clear_zeros(&s);
    memcpy(y, s.V, (size_t)s.n * sizeof *y);
    return s.w2[0];
}

// ---- lists of modes -------------------------------------------------------------------------

struct list {
    struct ct_arena *a;
    const struct ct_linear *l;
    struct ct_motion_mode *mode;
    size_t n, cap;
};

// Scales a shape so that its largest entry is 1.
static void normalise(double *shape, int nu)
{
    const int most = ct_linear_largest_entry(shape, shape + nu, nu);
    const double re = shape[most], im = shape[most + nu], size = hypot(re, im);
    for (int i = 0; i < nu && size > 0; i++) {
        const double x = shape[i], y = shape[i + nu];
        shape[i] = (x * re + y * im) / (size * size);
        shape[i + nu] = (y * re - x * im) / (size * size);
    }
}

// Adds a mode with the shape yr + i yi in the reduced coordinates (yi NULL: real).
static void add_mode(struct list *list, double re, double im, const double *yr,
                     const double *yi)
{
    const int nu = list->l->nu;
    struct ct_motion_mode mode = {.re = re, .im = im, .is_rigid = re == 0 && im == 0};
    mode.shape = CT_NEWN(list->a, double, 2 * nu + 1);
    ct_linear_expand(list->l, mode.shape, yr);
    if (yi)
        ct_linear_expand(list->l, mode.shape + nu, yi);
    normalise(mode.shape, nu);
    CT_PUSH(list->a, list->mode, list->n, list->cap, mode);
}

static int by_size(const void *context, const void *x, const void *y)
{
    (void)context;
    const struct ct_motion_mode *a = x, *b = y;
    const double sa = hypot(a->re, a->im), sb = hypot(b->re, b->im);
    return sa != sb ? (sa > sb) - (sa < sb) : (a->re < b->re) - (a->re > b->re);
}

double ct_modes_roundoff(const struct ct_motion_mode *mode, size_t nmode, double *fastest)
{
    *fastest = 0;
    for (size_t i = 0; i < nmode; i++)
        *fastest = fmax(*fastest, hypot(mode[i].re, mode[i].im));
    return ct_roundoff(2 * (int)nmode) * *fastest; // as for zeros of 2 nmode states
}

void ct_modes_sort(struct ct_arena *a, struct ct_motion_mode *mode, size_t nmode)
{
    ct_sort(a, mode, nmode, sizeof *mode, by_size, NULL);
}

void ct_mode_add_undamped(struct ct_motion_mode *mode, size_t *nmode, double w2, double *shape,
                          int nu)
{
    const double w = sqrt(fabs(w2));
    normalise(shape, nu);
    if (w2 >= 0) {
        mode[(*nmode)++]
            = (struct ct_motion_mode){.im = w, .is_rigid = w2 == 0, .shape = shape};
        return;
    }
    // an unstable mode: the pair exp(w t) and exp(-w t)
    mode[(*nmode)++] = (struct ct_motion_mode){.re = w, .shape = shape};
    mode[(*nmode)++] = (struct ct_motion_mode){.re = -w, .shape = shape};
}

static void add_symmetric(struct list *list, const struct basis *s)
{
    const int nu = list->l->nu;
    list->mode = CT_NEWN(list->a, struct ct_motion_mode, 2 * s->k + 1);
    for (int j = 0; j < s->k; j++) {
        double *shape = CT_NEWN(list->a, double, 2 * nu + 1);
        ct_linear_expand(list->l, shape, s->V + (size_t)s->n * (size_t)j);
        ct_mode_add_undamped(list->mode, &list->n, s->w2[j], shape, nu);
    }
}

// A free coordinate has a double zero eigenvalue with one eigenvector. Round-off splits it into
// a pair of the order of the square root of round-off. Sets eigenvalues not larger than `small`
// to zero until there are `most` zeros. Returns the number of zeros.
static int take_split_zeros(double *re, double *im, int n, int nzero, int most, double small)
{
    while (nzero < most) {
        int least = -1;
        for (int k = 0; k < n; k++) {
            const double s = hypot(re[k], im[k]);
            if (s > 0 && s <= small && (least < 0 || s < hypot(re[least], im[least])))
                least = k;
        }
        if (least < 0)
            break;
        const bool is_pair = im[least] != 0;
        for (int k = least; k <= least + is_pair; k++, nzero++)
            re[k] = im[k] = 0;
    }
    return nzero;
}

// Adds the eigenvalues of x' = A x (n x n, destroyed); y = T x (nfree x n) gives the shape.
// Eigenvalues up to `zero` in size are zero. The number of rigid-body modes is `rigid`, or half
// the number of zeros if that is more.
static bool add_general(struct list *list, double *A, const double *T, int n, double zero,
                        int rigid)
{
    const int f = list->l->nfree;
    double *re = CT_NEWN(list->a, double, n + 1), *im = CT_NEWN(list->a, double, n + 1),
           *V = CT_NEWN(list->a, double, n *n + 1), *y = CT_NEWN(list->a, double, 2 * f + 1),
           *work = CT_NEWN(list->a, double, ct_eigen_work(n));
    const double size = ct_vector_largest(A, (size_t)n * (size_t)n);
    if (!ct_eigen(re, im, V, A, n, n, work))
        return false;
    int nzero = 0;
    for (int k = 0; k < n; k++)
        if (hypot(re[k], im[k]) <= zero) {
            re[k] = im[k] = 0;
            nzero++;
        }
    nzero = take_split_zeros(re, im, n, nzero, 2 * rigid, sqrt(zero * size));
    const int wanted = rigid > (nzero + 1) / 2 ? rigid : (nzero + 1) / 2;
    for (int k = 0, found = 0; k < n; k++) {
        if (im[k] < 0 || (re[k] == 0 && im[k] == 0 && found++ >= wanted))
            continue;
        memset(y, 0, 2 * (size_t)f * sizeof *y);
        for (int p = 0; p < n; p++)
            for (int i = 0; i < f; i++) {
                y[i] += T[i + f * p] * V[p + (size_t)n * (size_t)k];
                if (im[k] > 0)
                    y[f + i] += T[i + f * p] * V[p + (size_t)n * (size_t)(k + 1)];
            }
        // a real part this small is round-off of a mode without damping
        const double small = 64 * DBL_EPSILON * fabs(im[k]);
        add_mode(list, fabs(re[k]) <= small ? 0 : re[k], im[k], y, im[k] > 0 ? y + f : NULL);
    }
    return true;
}

// ---- in the modes of the symmetric part -----------------------------------------------------

static void clear_roundoff(double *A, int n, double size)
{
    for (int i = 0; i < n * n; i++)
        if (fabs(A[i]) <= ct_roundoff(n) * size)
            A[i] = 0;
}

// Number of coordinates on which no force depends.
static int count_free(const struct ct_linear *l, int f)
{
    const double size = ct_vector_largest(l->Kr, (size_t)f * (size_t)f);
    int n = 0;
    for (int i = 0; i < f; i++)
        n += ct_vector_largest(l->Kr + f * i, (size_t)f) <= ct_roundoff(f) * size
          && ct_vector_largest(l->G + f * i, (size_t)f) == 0;
    return n;
}

// Number of motions of constant rate: the dimension of the null space of A (n x n).
static int count_steady(struct ct_arena *a, const double *A, int n)
{
    double *R = CT_NEWN(a, double, n *n + 1), *tau = CT_NEWN(a, double, n + 1),
           *work = CT_NEWN(a, double, ct_qr_pivot_work(n, n));
    int *column = CT_NEWN(a, int, n + 1);
    memcpy(R, A, (size_t)n * (size_t)n * sizeof *R);
    return n - ct_qr_pivot(R, column, tau, n, n, n, ct_roundoff(n), work);
}

// y = V e1/s, w = V e2:  e1' = s e2 + (s g /s) e1,  e2' = -(k/s) e1 - c e2
static bool solve_modal(struct list *list, const struct basis *s)
{
    const struct ct_linear *l = list->l;
    struct ct_arena *a = list->a;
    const int f = s->n, n = 2 * f;
    double *work = CT_NEWN(a, double, f *f + 1), *K = CT_NEWN(a, double, f *f + 1),
           *C = CT_NEWN(a, double, f *f + 1), *G = CT_NEWN(a, double, f *f + 1),
           *MV = CT_NEWN(a, double, f *f + 1), *A = CT_NEWN(a, double, n *n + 1),
           *T = CT_NEWN(a, double, f *n + 1), *rate = CT_NEWN(a, double, f + 1);
    congruence(K, s->V, l->Kr, work, f, f);
    congruence(C, s->V, l->Cr, work, f, f);
    ct_matrix_multiply(work, l->G, s->V, f, f, f); // V^-1 G V = V' M G V
    ct_matrix_multiply(MV, l->Mr, work, f, f, f);
    ct_matrix_multiply_transposed(G, s->V, MV, f, f, f);
    const double size = ct_vector_largest(K, (size_t)f * (size_t)f);
    clear_roundoff(K, f, size);
    clear_roundoff(C, f, ct_vector_largest(C, (size_t)f * (size_t)f));
    clear_roundoff(G, f, ct_vector_largest(G, (size_t)f * (size_t)f));
    double least = sqrt(size);
    for (int i = 0; i < f; i++)
        if (s->w2[i] != 0)
            least = fmin(least, sqrt(fabs(s->w2[i])));
    for (int i = 0; i < f; i++)
        rate[i] = s->w2[i] != 0 ? sqrt(fabs(s->w2[i])) : least > 0 ? least : 1;
    for (int j = 0; j < f; j++) {
        A[j + n * (f + j)] = rate[j];
        for (int i = 0; i < f; i++) {
            A[i + n * j] = G[i + f * j] * rate[i] / rate[j];
            A[f + i + n * j] = -K[i + f * j] / rate[j];
            A[f + i + n * (f + j)] = -C[i + f * j];
            T[i + f * j] = s->V[i + f * j] / rate[j];
        }
    }
    const double zero = ct_roundoff(n) * ct_vector_largest(A, (size_t)n * (size_t)n);
    const int free = count_free(l, f), steady = count_steady(a, A, n);
    return add_general(list, A, T, n, zero, steady > free ? steady : free);
}

// ---- entry point ---------------------------------------------------------------------------

// Balances A (n x n): A <- D^-1 A D, T (f x n) <- T D with powers of two D that make each row
// as large as its column. The units of model states then do not affect which eigenvalues count
// as zero. Source: Osborne (1960), as in LAPACK's dgebal.
static void balance(double *A, double *T, int n, int f)
{
    // Limit: number of passes; balancing changes no eigenvalue.
    enum { MOST_PASSES = 20 };
    bool is_changed = true;
    for (int pass = 0; pass < MOST_PASSES && is_changed; pass++) {
        is_changed = false;
        for (int k = 0; k < n; k++) {
            double row = 0, column = 0;
            for (int i = 0; i < n; i++) {
                row += i == k ? 0 : fabs(A[k + n * i]);
                column += i == k ? 0 : fabs(A[i + n * k]);
            }
            if (!(row > 0 && column > 0) || (row < 4 * column && column < 4 * row))
                continue;
            const double d = ldexp(1, (int)lround(log2(row / column) / 2));
            for (int i = 0; i < n; i++) {
                A[i + n * k] *= d;
                A[k + n * i] /= d;
            }
            for (int i = 0; i < f; i++)
                T[i + f * k] *= d;
            is_changed = true;
        }
    }
}

// For massless coordinates with dampers, and for model states, which are first-order states.
static bool solve_state_space(struct list *list, int rigid)
{
    struct ct_state_space s;
    if (!ct_state_space_create(list->l->ctx, list->a, list->l, &s))
        return false;
    if (list->l->m->e->nstate) {
        balance(s.A, s.y_x, s.n, list->l->nfree);
        rigid = count_steady(list->a, s.A, s.n);
    }
    const double zero = ct_roundoff(s.n) * ct_vector_largest(s.A, (size_t)s.n * (size_t)s.n);
    return add_general(list, s.A, s.y_x, s.n, zero, rigid);
}

bool ct_modes_solve(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_linear *l,
                    struct ct_motion_mode **mode, size_t *nmode, const char **how)
{
    struct list list = {.a = a, .l = l};
    struct basis s;
    const int f = l->nfree;
    const size_t ff = (size_t)f * (size_t)f;
    bool ok = true;
    *how = "no freedoms";
    if (f && l->m->e->nstate) {
        *how = ct_arena_printf(a, "general (%zu states of the model)", l->m->e->nstate);
        ok = solve_state_space(&list, 0);
    } else if (f) {
        solve_symmetric(a, l->Mr, l->Kr, f, &s);
        const double rate = s.k ? sqrt(fmax(fabs(s.w2[s.k - 1]), fabs(s.w2[0]))) : 0;
        const bool has_speeds
            = ct_vector_largest(l->Cr, ff) > DBL_EPSILON * rate * ct_vector_largest(l->Mr, ff);
        double *L = CT_NEWN(a, double, ff + 1);
        const bool is_positive = factor_stiffness(L, l->Kr, f);
        int rigid = 0;
        if (!is_positive)
            clear_zeros(&s);
        for (int j = 0; j < s.k; j++)
            rigid += s.w2[j] == 0;
        if (!has_speeds && !l->is_moving && s.is_held && ct_linear_is_symmetric(a, l->Kr, f)) {
            *how = "symmetric";
            if (is_positive)
                refine_slow(a, l->Mr, L, &s);
            add_symmetric(&list, &s);
        } else if (!s.n0) {
            *how = "general";
            ok = solve_modal(&list, &s);
        } else {
            *how = "general, with massless coordinates";
            ok = solve_state_space(&list, rigid);
        }
    }
    if (!ok && !ctx->nerror)
        ct_error(ctx, (struct ct_mark){.file = l->m->model->file}, CT_E_SINGULAR,
                 "the eigenvalues cannot be found");
    ct_modes_sort(a, list.mode, list.n);
    *mode = list.mode;
    *nmode = list.n;
    return ok;
}
