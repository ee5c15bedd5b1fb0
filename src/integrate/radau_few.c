// Stages of Radau IIA for loops of few unknowns in plain coordinates, abreast.
//
// d' = u + J' eta is linear in plain coordinates: stages that meet it, with eta zero, go on to, as J' is that of the derivatives, and
// neither it nor eta is looked at again. Their motion is the collocated sum of speeds, predicted as for others. Residuals of
// all stages are one evaluation, and corrections one product with the response, (8.2b), between two changes of basis.
//
// Numbers of stages stand in fours, a last one that repeats the third; in the basis of eigenvectors the real component, the real and the
// imaginary part of the complex one, and zero.
#include "integrate/radau.h"
#include "numeric/four.h"

#include <math.h>

struct ct_radau_few {
    double *z, *x; // stages d, u, lam, and their corrections  (4 x (2 nu + m), as padded)
    double *b,
        *swapped; // residuals r, phi, v in the basis of eigenvectors; complex parts exchanged  (4 x (nu + 2 m))
    // columns of A^-1/h, of T^-1, of that with complex parts exchanged, of T  (4 x 3)
    double *slope, *to_basis, *to_swapped, *from_basis;
    double h; // of the first
};

struct ct_radau_few *ct_radau_few_create(struct ct_arena *a, int nu, int most_rows)
{
    struct ct_radau_few *f = CT_NEW(a, struct ct_radau_few);
    const size_t four = CT_FOUR * sizeof(double), in = (size_t)nu + 2 * (size_t)most_rows;
    const int padded = ct_response_padded(2 * nu + most_rows);
    const size_t out = (size_t)padded;
    f->z = ct_arena_line(a, four * out);
    f->x = ct_arena_line(a, four * out);
    f->b = ct_arena_line(a, four * in);
    f->swapped = ct_arena_line(a, four * in);
    double **const turn[] = {&f->slope, &f->to_basis, &f->to_swapped, &f->from_basis};
    for (size_t i = 0; i < COUNT(turn); i++)
        *turn[i] = ct_arena_line(a, four * STAGES);
    for (int j = 0; j < STAGES; j++) {
        double *to = f->to_basis + CT_FOUR * j, *swapped = f->to_swapped + CT_FOUR * j,
               *from = f->from_basis + CT_FOUR * j;
        for (int i = 0; i < STAGES; i++) {
            to[i] = T_INVERSE[i][j];
            from[i] = T[i][j];
        }
        from[STAGES] = from[STAGES - 1];
        swapped[1] = to[2];
        swapped[2] = to[1];
    }
    return f;
}

// ---- before and after an iteration ------------------------------------------------------------------

static void find_slopes(struct ct_radau *s)
{
    struct ct_radau_few *f = s->few;
    for (int j = 0; j < STAGES && f->h != s->h; j++)
        for (int i = 0; i < CT_FOUR; i++)
            f->slope[i + CT_FOUR * j] = s->slope[i < STAGES ? i : STAGES - 1][j];
    f->h = s->h;
}

// z (4, out): a number of the stages from those of the step before, as weighted, or what it is at first.
static inline void predict_one(double *z, double (*w)[STAGES], const double *before, int n,
                               bool is_known, double first, double slope)
{
    for (int i = 0; i < STAGES; i++)
        z[i] = is_known ? w[i][0] * before[0] + w[i][1] * before[n] + w[i][2] * before[2 * n]
                        : first + C[i] * slope;
    z[STAGES] = z[STAGES - 1];
}

void ct_radau_few_predict(struct ct_radau *s, double h, const double *u0, const double *u_dot0)
{
    const int nu = s->it->nu, m = s->it->m;
    double *d = s->few->z, *u = d + CT_FOUR * nu, *lam = u + CT_FOUR * nu;
    const struct ct_dae_abreast *at = s->dae->abreast;
    s->now.h = h;
    find_slopes(s);
    for (int k = 0; k < nu; k++, d += CT_FOUR, u += CT_FOUR) {
        predict_one(u, s->further, s->before.u + k, nu, !s->is_fresh, 0, h * u_dot0[k]);
        for (int i = 0; i < CT_FOUR; i++) {
            const double *a = A[i < STAGES ? i : STAGES - 1];
            const double c = C[i < STAGES ? i : STAGES - 1];
            d[i] = h * (c * u0[k] + a[0] * u[0] + a[1] * u[1] + a[2] * u[2]);
        }
    }
    for (int i = 0; i < m; i++, lam += CT_FOUR)
        predict_one(lam, s->further_lam, s->before.lam + i, m, s->knows_multipliers, s->lam[i],
                    0);
    for (int i = 0; i < CT_FOUR * s->dae->most_rows && m < s->dae->most_rows; i++)
        at->lam[i] = 0; // of rows that do not count
}

void ct_radau_few_keep(struct ct_radau *s)
{
    const int nu = s->it->nu, m = s->it->m;
    const double *d = s->few->z, *u = d + CT_FOUR * nu, *lam = u + CT_FOUR * nu;
    for (int i = 0; i < STAGES; i++) {
        for (int k = 0; k < nu; k++) {
            s->now.d[k + i * nu] = d[i + CT_FOUR * k];
            s->now.u[k + i * nu] = u[i + CT_FOUR * k];
        }
        for (int k = 0; k < m; k++)
            s->now.lam[k + i * m] = lam[i + CT_FOUR * k];
    }
}

void ct_radau_few_finish(struct ct_radau *s)
{
    const int lam = CT_FOUR * 2 * s->it->nu;
    ct_radau_few_keep(s);
    ct_iteration_note_multipliers(s->it, s->few->z + lam, s->few->x + lam, CT_FOUR * s->it->m);
}

// ---- a correction -----------------------------------------------------------------------------------

// x (out) = columns of a turn (4 x 3), weighted with the numbers of three stages.
CT_FOUR_INLINE void weigh(ct_four *x, const double *turn, const double *w)
{
    ct_four_fill(x, 0);
    for (int j = 0; j < STAGES; j++)
        ct_four_add_times(x, w[j], turn + CT_FOUR * j);
}

// The stages as points to evaluate.
CT_FOUR_INLINE void place(const struct ct_radau *s, double t, const double *y, const int nu)
{
    const struct ct_dae_abreast *at = s->dae->abreast;
    const struct ct_radau_few *f = s->few;
    const double *d = f->z, *u = d + CT_FOUR * nu, *lam = u + CT_FOUR * nu;
    ct_four x;
    for (int i = 0; i < CT_FOUR; i++)
        at->t[i] = t + C[i < STAGES ? i : STAGES - 1] * s->now.h;
    for (int k = 0; k < nu; k++) {
        ct_four_fill(&x, y[k]);
        ct_four_add(&x, d + CT_FOUR * k);
        ct_four_put(at->q + CT_FOUR * k, &x);
        ct_four_fill(&x, y[k + nu]);
        ct_four_add(&x, u + CT_FOUR * k);
        ct_four_put(at->u + CT_FOUR * k, &x);
        weigh(&x, f->slope, u + CT_FOUR * k);
        ct_four_put(at->a + CT_FOUR * k, &x);
    }
    for (int i = 0; i < s->it->m; i++) {
        ct_four_fill(&x, 0);
        ct_four_add(&x, lam + CT_FOUR * i);
        ct_four_put(at->lam + CT_FOUR * at->row[i], &x);
    }
}

// One of the residuals into the basis of eigenvectors. `bad` (in, out) stays zero where it is finite.
CT_FOUR_INLINE void take_residual(const struct ct_radau_few *f, int j, const double *r,
                                  ct_four *bad)
{
    static const double zero[CT_FOUR] = {0};
    ct_four x;
    ct_four_add_product(bad, zero, r);
    weigh(&x, f->to_basis, r);
    ct_four_put(f->b + CT_FOUR * j, &x);
    weigh(&x, f->to_swapped, r);
    ct_four_put(f->swapped + CT_FOUR * j, &x);
}

CT_FOUR_INLINE bool take_residuals(const struct ct_radau *s, const int nu)
{
    const struct ct_dae_abreast *at = s->dae->abreast;
    const struct ct_radau_few *f = s->few;
    const int m = s->it->m;
    double sum[CT_FOUR];
    ct_four bad;
    ct_four_fill(&bad, 0);
    for (int k = 0; k < nu; k++)
        take_residual(f, k, at->r + CT_FOUR * k, &bad);
    for (int i = 0; i < m; i++) {
        take_residual(f, nu + i, at->phi + CT_FOUR * at->row[i], &bad);
        take_residual(f, nu + m + i, at->v + CT_FOUR * at->row[i], &bad);
    }
    ct_four_put(sum, &bad);
    return sum[0] + sum[1] + sum[2] + sum[3] == 0;
}

// x (4 x BLOCK, out): so many corrections from number i on, in the basis of eigenvectors.
CT_FOUR_INLINE void answer(double *x, const struct ct_radau *s, int i, const int rows)
{
    enum { BLOCK = CT_RESPONSE_BLOCK };
    const struct ct_response *a = s->it->response;
    const double *S = a->straight + CT_FOUR * i, *X = a->crossed + CT_FOUR * i, *b = s->few->b,
                 *swapped = s->few->swapped;
    ct_four straight[BLOCK] = {{0}}, crossed[BLOCK] = {{0}};
    for (int j = 0; j < a->in; j++) {
        for (int k = 0; k < BLOCK; k++) {
            ct_four_add_product(&straight[k], S + CT_FOUR * k, b);
            ct_four_add_product(&crossed[k], X + CT_FOUR * k, swapped);
        }
        S += CT_FOUR * rows;
        X += CT_FOUR * rows;
        b += CT_FOUR;
        swapped += CT_FOUR;
    }
    for (int k = 0; k < BLOCK; k++) {
        ct_four_put(x + CT_FOUR * k, &crossed[k]);
        ct_four_add(&straight[k], x + CT_FOUR * k);
        ct_four_put(x + CT_FOUR * k, &straight[k]);
    }
}

// Corrections, added to the stages; their size.
CT_FOUR_INLINE double change(const struct ct_radau *s, const int rows)
{
    const struct ct_radau_few *f = s->few;
    double *z = f->z, *x = f->x, sum[CT_FOUR];
    ct_four square, y, weighted;
    ct_four_fill(&square, 0);
    for (int i = 0; i < rows; i += CT_RESPONSE_BLOCK)
        answer(x + CT_FOUR * i, s, i, rows);
    for (int k = 0; k < rows; k++, z += CT_FOUR, x += CT_FOUR) {
        weigh(&y, f->from_basis, x);
        ct_four_put(x, &y);
        ct_four_add(&y, z);
        ct_four_put(z, &y);
        ct_four_fill(&weighted, 0);
        ct_four_add_times(&weighted, s->it->share[k], x);
        ct_four_put(sum, &weighted);
        ct_four_add_product(&square, sum, sum);
    }
    ct_four_put(sum, &square);
    return sqrt((sum[0] + sum[1] + sum[2]) * (s->it->per_speed / (2 * STAGES)));
}

// Planar loops of three coordinates have code of their own: its loops are known to be so long.
CT_FOUR_INLINE void place_stages(const struct ct_radau *s, double t, const double *y)
{
    if (s->it->nu == 3)
        place(s, t, y, 3);
    else
        place(s, t, y, s->it->nu);
}

// False where residuals are not finite.
CT_FOUR_INLINE bool change_stages(const struct ct_radau *s, double *size)
{
    const int rows = s->it->response->rows;
    if (!take_residuals(s, s->it->nu))
        return false;
    *size = rows == 8 ? change(s, 8) : change(s, rows);
    return true;
}

static void place_narrow(const struct ct_radau *s, double t, const double *y)
{
    place_stages(s, t, y);
}

static bool change_narrow(const struct ct_radau *s, double *size)
{
    return change_stages(s, size);
}

#if defined(__GNUC__) && defined(__x86_64__)

__attribute__((target("avx2"))) static void place_wide(const struct ct_radau *s, double t,
                                                       const double *y)
{
    place_stages(s, t, y);
}

__attribute__((target("avx2"))) static bool change_wide(const struct ct_radau *s, double *size)
{
    return change_stages(s, size);
}

static bool is_wide(void)
{
    return __builtin_cpu_supports("avx2");
}

#else

static bool is_wide(void)
{
    return false;
}
#define place_wide place_narrow
#define change_wide change_narrow

#endif

enum ct_eval ct_radau_few_correct(struct ct_radau *s, double t, const double *y,
                                  enum ct_verdict *verdict, struct ct_integrate_stats *stats)
{
    const struct ct_dae *dae = s->dae;
    const double *x = s->few->x;
    double size = INFINITY;
    (is_wide() ? place_wide : place_narrow)(s, t, y);
    dae->abreast->evaluate(dae->user);
    stats->evaluations += STAGES;
    if (!(is_wide() ? change_wide : change_narrow)(s, &size))
        return CT_EVAL_RETRY;
    *verdict = ct_iteration_judge(s->it, size, x, x + CT_FOUR * s->it->nu, CT_FOUR);
    return CT_EVAL_OK;
}
