// See state_space.h.
//
//     y = T z + N2 y2,  z = (y_p, y_1)
//
// y_p are the coordinates with mass. N1 y_1 and N2 y2 are massless directions with and without
// dampers.
//
//     M_pp w_p' + C_pp w_p + C_p1 y_1' + K_p z = g_p      rows T' of the equations, after y2 is
//     C_1p w_p + C_11 y_1' + K_1 z = g_1                  eliminated by N2' K (T z + N2 y2) = N2' g
#include "analysis/state_space.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

static double *matrix(struct ct_arena *a, int n, int m)
{
    return CT_NEWN(a, double, (size_t)n *(size_t)m + 1);
}

struct split {
    struct ct_ctx *ctx;
    struct ct_arena *a;
    const struct ct_linear *l;
    int f, k, n0, n1, n2; // f = k + n0, n0 = n1 + n2
    int *heavy, *light;   // indices of the k coordinates with mass and the n0 without
    bool is_mixed;        // massless directions combine several coordinates
    double *error;        // f: error bounds of the entries of N
    double *N;            // f x n0: N1, then N2
    double *T;            // f x (k + n1): unit vectors of the coordinates with mass, then N1
};

// ---- directions -----------------------------------------------------------------------------

// N (f x n0): null space of Mr. Sets n0.
static void find_massless(struct split *s)
{
    const int f = s->f;
    double *M = matrix(s->a, f, f), *scale = CT_NEWN(s->a, double, f + 1),
           *value = CT_NEWN(s->a, double, f + 1),
           *work = CT_NEWN(s->a, double, ct_symmetric_eigenvalues_work(f));
    for (int i = 0; i < f; i++) {
        const double m = s->l->Mr[i + f * i];
        scale[i] = m > 0 ? 1 / sqrt(m) : 1;
    }
    for (int j = 0; j < f; j++)
        for (int i = 0; i < f; i++)
            M[i + f * j]
                = (s->l->Mr[i + f * j] + s->l->Mr[j + f * i]) / 2 * scale[i] * scale[j];
    ct_symmetric_eigen(value, M, f, f, work);
    while (s->n0 < f && !(value[s->n0] > ct_roundoff(f) * value[f - 1]))
        s->n0++;
    s->k = f - s->n0;
    s->N = matrix(s->a, f, s->n0);
    for (int j = 0; j < s->n0; j++)
        for (int i = 0; i < f; i++)
            s->N[i + f * j] = scale[i] * M[i + f * j];
    s->error = scale;
    // error of an eigenvector: round-off over the gap to other eigenvalues
    for (int i = 0; i < f && s->n0 < f; i++)
        s->error[i] *= ct_roundoff(f) * value[f - 1] / value[s->n0];
}

// Chooses one coordinate for each massless direction and makes the rows of N at these
// coordinates unit rows.
static void choose_light(struct split *s)
{
    const int f = s->f, n0 = s->n0;
    double *A = matrix(s->a, n0, f), *tau = CT_NEWN(s->a, double, f + 1),
           *P = matrix(s->a, n0, n0), *work = CT_NEWN(s->a, double, ct_qr_pivot_work(n0, f));
    int *column = CT_NEWN(s->a, int, f + 1), *pivot = CT_NEWN(s->a, int, n0 + 1);
    bool *taken = CT_NEWN(s->a, bool, f + 1);
    s->heavy = CT_NEWN(s->a, int, f + 1);
    s->light = CT_NEWN(s->a, int, f + 1);
    for (int j = 0; j < n0; j++)
        for (int i = 0; i < f; i++)
            A[j + n0 * i] = s->N[i + f * j];
    ct_qr_pivot(A, column, tau, n0, f, n0, 0, work);
    for (int j = 0; j < n0; j++)
        taken[column[j]] = true;
    int heavy = 0, light = 0;
    for (int i = 0; i < f; i++)
        *(taken[i] ? &s->light[light++] : &s->heavy[heavy++]) = i;
    // N' <- P^-T N', where P is the square block of rows `light` of N
    for (int j = 0; j < n0; j++)
        for (int i = 0; i < n0; i++)
            P[i + n0 * j] = s->N[s->light[i] + f * j];
    for (int j = 0; j < n0; j++)
        for (int i = 0; i < f; i++)
            A[j + n0 * i] = s->N[i + f * j];
    double own = 1; // smallest entry of a direction at its coordinate
    if (n0 && ct_lu(P, pivot, n0, n0)) {
        ct_lu_solve(A, P, pivot, n0, n0, f, n0, true);
        for (int i = 0; i < n0; i++)
            own = fmin(own, fabs(P[i + n0 * i]));
    }
    for (int j = 0; j < n0; j++)
        for (int i = 0; i < f; i++) {
            const bool is_zero = fabs(A[j + n0 * i]) < s->error[i] / own;
            s->N[i + f * j] = is_zero ? 0 : A[j + n0 * i];
            s->is_mixed |= !is_zero && !taken[i];
        }
}

static bool is_state(const struct split *s, int i)
{
    return ct_speed_is_state(s->l->m->e, (size_t)s->l->independent[i]);
}

// The largest entry of A (f x n) outside the rows of model states and, if n = f, outside their
// columns. Model states may have any unit.
static double largest_of_motion(const struct split *s, const double *A, int n)
{
    double largest = 0;
    for (int j = 0; j < n; j++)
        for (int i = 0; i < s->f; i++)
            if (!is_state(s, i) && (n < s->f || !is_state(s, j)))
                largest = fmax(largest, fabs(A[i + s->f * j]));
    return largest;
}

// Moves the columns of N and the entries of `light` that are model states to the front, in
// their order. Returns their number. The row of a state contains its rate z', so that each of
// them has a rate.
static int put_states_first(struct split *s)
{
    const int f = s->f, n0 = s->n0;
    double *N = matrix(s->a, f, n0);
    int *light = CT_NEWN(s->a, int, n0 + 1), n = 0, nstate = 0;
    for (int of_states = 1; of_states >= 0; of_states--) {
        for (int j = 0; j < n0; j++) {
            if (is_state(s, s->light[j]) != of_states)
                continue;
            memcpy(N + (size_t)f * (size_t)n, s->N + (size_t)f * (size_t)j,
                   (size_t)f * sizeof *N);
            light[n++] = s->light[j];
        }
        nstate = of_states ? n : nstate;
    }
    s->N = N;
    s->light = light;
    return nstate;
}

// Rotates N so that model states and dampers act on its first n1 columns only.
static void split_by_damping(struct split *s)
{
    const int f = s->f, nstate = put_states_first(s), n = s->n0 - nstate;
    double *N = s->N + (size_t)f * (size_t)nstate;
    double *CN = matrix(s->a, f, n), *Cnn = matrix(s->a, n, n), *turned = matrix(s->a, f, n),
           *value = CT_NEWN(s->a, double, n + 1),
           *work = CT_NEWN(s->a, double, ct_symmetric_eigenvalues_work(n));
    ct_matrix_multiply(CN, s->l->Cr, N, f, f, n);
    ct_matrix_multiply_transposed(Cnn, N, CN, n, f, n);
    if (n)
        ct_symmetric_eigen(value, Cnn, n, n, work);
    const double least = ct_roundoff(f) * largest_of_motion(s, s->l->Cr, f);
    int damped = 0;
    for (int j = 0; j < n; j++)
        damped += fabs(value[j]) > least;
    s->n1 = nstate + damped;
    s->n2 = n - damped;
    if (!damped || !s->n2)
        return;
    ct_matrix_multiply(turned, N, Cnn, f, n, n);
    int first = 0, last = damped;
    for (int j = 0; j < n; j++)
        memcpy(N + (size_t)f * (size_t)(fabs(value[j]) > least ? first++ : last++),
               turned + (size_t)f * (size_t)j, (size_t)f * sizeof *turned);
    s->is_mixed = true;
}

static bool not_held(struct split *s)
{
    const struct ct_equations *e = s->l->m->e;
    const struct ct_u *u = &e->u[s->l->independent[s->light[0]]];
    const struct ct_model *model = s->l->m->model;
    const struct ct_mark mark = u->joint >= 0 ? model->joint[u->joint].mark
                              : u->body >= 0  ? model->body[u->body].instance.mark
                                              : (struct ct_mark){.file = model->file};
    return ct_error(s->ctx, mark, CT_E_MASSLESS,
                    "coordinate '%s' moves no mass, and nothing holds it: give a mass, or a "
                    "stiffness to follow",
                    ct_linear_coordinate(e, s->a, s->l->independent[s->light[0]]));
}

// ---- the equations in z ---------------------------------------------------------------------

struct reduced {
    int m;                 // m = k + n1
    double *That, *y_g;    // y = That z + y_g g
    double *M, *C, *K, *g; // m x m; g (m x f): coefficients of the forces
};

// Eliminates y2 = -K22^-1 (N2' K T z - N2' g).
static bool follow(struct split *s, struct reduced *r)
{
    const int f = s->f, m = r->m, n2 = s->n2;
    const double *N2 = s->N + (size_t)f * (size_t)s->n1, *K = s->l->Kr, *C = s->l->Cr;
    double *KN = matrix(s->a, f, n2), *K22 = matrix(s->a, n2, n2), *KT = matrix(s->a, f, m),
           *W = matrix(s->a, n2, m), *Y = matrix(s->a, n2, f), *CN = matrix(s->a, f, n2);
    int *pivot = CT_NEWN(s->a, int, n2 + 1);
    memcpy(r->That, s->T, (size_t)f * (size_t)m * sizeof *s->T);
    if (!n2)
        return true;
    ct_matrix_multiply(CN, C, N2, f, f, n2);
    if (largest_of_motion(s, CN, n2) > ct_roundoff(f) * largest_of_motion(s, C, f))
        return not_held(s);
    ct_matrix_multiply(KN, K, N2, f, f, n2);
    ct_matrix_multiply_transposed(K22, N2, KN, n2, f, n2);
    ct_matrix_multiply(KT, K, s->T, f, f, m);
    ct_matrix_multiply_transposed(W, N2, KT, n2, f, m);
    for (int i = 0; i < f; i++)
        for (int j = 0; j < n2; j++)
            Y[j + n2 * i] = N2[i + f * j];
    const double size = ct_vector_largest(K22, (size_t)n2 * (size_t)n2);
    if (!ct_lu(K22, pivot, n2, n2))
        return not_held(s);
    for (int i = 0; i < n2; i++)
        if (!(fabs(K22[i + n2 * i]) > ct_roundoff(n2) * size))
            return not_held(s);
    ct_lu_solve(W, K22, pivot, n2, n2, m, n2, false);
    ct_lu_solve(Y, K22, pivot, n2, n2, f, n2, false);
    for (int j = 0; j < m; j++)
        for (int p = 0; p < n2; p++)
            for (int i = 0; i < f; i++)
                r->That[i + f * j] -= N2[i + f * p] * W[p + n2 * j];
    ct_matrix_multiply(r->y_g, N2, Y, f, n2, f);
    return true;
}

static bool reduce(struct split *s, struct reduced *r)
{
    const int f = s->f, m = r->m = s->k + s->n1;
    double *work = matrix(s->a, f, f), *left = matrix(s->a, m, f);
    double **const all[] = {&r->M, &r->C, &r->K};
    const double *const from[] = {s->l->Mr, s->l->Cr, s->l->Kr};
    r->That = matrix(s->a, f, m);
    r->y_g = matrix(s->a, f, f);
    r->g = matrix(s->a, m, f);
    if (!follow(s, r))
        return false;
    for (size_t i = 0; i < COUNT(all); i++) {
        *all[i] = matrix(s->a, m, m);
        ct_matrix_multiply(work, from[i], r->That, f, f, m);
        ct_matrix_multiply_transposed(*all[i], s->T, work, m, f, m);
    }
    ct_matrix_multiply(work, s->l->Kr, r->y_g, f, f, f); // T' (1 - K y_g) g
    ct_matrix_multiply_transposed(left, s->T, work, m, f, f);
    for (int j = 0; j < f; j++)
        for (int i = 0; i < m; i++)
            r->g[i + m * j] = s->T[j + f * i] - left[i + m * j];
    return true;
}

// ---- states ---------------------------------------------------------------------------------

// X (n x k) <- A^-1 X, where A is the n x n block of P (leading dimension ld) from row and
// column `at`.
static bool divide(struct split *s, double *X, const double *P, int at, int n, int ld, int k)
{
    double *A = matrix(s->a, n, n);
    int *pivot = CT_NEWN(s->a, int, n + 1);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            A[i + n * j] = P[at + i + ld * (at + j)];
    if (!n)
        return true;
    if (!ct_lu(A, pivot, n, n))
        return not_held(s);
    ct_lu_solve(X, A, pivot, n, n, k, n, false);
    return true;
}

// Copies a block (rows x cols) into out (leading dimension ld) from row `at`.
static void put(double *out, int ld, int at, const double *block, int n, int columns)
{
    for (int j = 0; j < columns; j++)
        memcpy(out + at + (size_t)ld * (size_t)j, block + (size_t)n * (size_t)j,
               (size_t)n * sizeof *out);
}

// Rates of z and w_p as functions of x = (z, w_p) and g: x' = A x + B g.
static bool rates(struct split *s, const struct reduced *r, struct ct_state_space *out)
{
    const int f = s->f, k = s->k, n1 = s->n1, m = r->m, n = out->n;
    double *slow = matrix(s->a, n1, n), *slow_g = matrix(s->a, n1, f), // y_1'
                                            *fast = matrix(s->a, k, n),
           *fast_g = matrix(s->a, k, f), // w_p'
               *turn = matrix(s->a, k, n), *GT = matrix(s->a, f, m), *none = matrix(s->a, k, f);
    for (int i = 0; i < n1; i++) {
        for (int j = 0; j < m; j++)
            slow[i + n1 * j] = -r->K[k + i + m * j];
        for (int j = 0; j < k; j++)
            slow[i + n1 * (m + j)] = -r->C[k + i + m * j];
        for (int j = 0; j < f; j++)
            slow_g[i + n1 * j] = r->g[k + i + m * j];
    }
    if (!divide(s, slow, r->C, k, n1, m, n) || !divide(s, slow_g, r->C, k, n1, m, f))
        return false;
    for (int i = 0; i < k; i++) {
        for (int j = 0; j < m; j++)
            fast[i + k * j] = -r->K[i + m * j];
        for (int j = 0; j < k; j++)
            fast[i + k * (m + j)] = -r->C[i + m * j];
        for (int j = 0; j < f; j++)
            fast_g[i + k * j] = r->g[i + m * j];
        for (int p = 0; p < n1; p++) {
            for (int j = 0; j < n; j++)
                fast[i + k * j] -= r->C[i + m * (k + p)] * slow[p + n1 * j];
            for (int j = 0; j < f; j++)
                fast_g[i + k * j] -= r->C[i + m * (k + p)] * slow_g[p + n1 * j];
        }
    }
    if (!divide(s, fast, r->M, 0, k, m, n) || !divide(s, fast_g, r->M, 0, k, m, f))
        return false;
    ct_matrix_multiply(GT, s->l->G, r->That, f, f, m);
    for (int i = 0; i < k; i++) {
        for (int j = 0; j < m; j++)
            turn[i + k * j] = GT[s->heavy[i] + f * j];
        turn[i + k * (m + i)] = 1;
    }
    put(out->A, n, 0, turn, k, n);
    put(out->A, n, k, slow, n1, n);
    put(out->A, n, m, fast, k, n);
    put(out->B, n, 0, none, k, f);
    put(out->B, n, k, slow_g, n1, f);
    put(out->B, n, m, fast_g, k, f);
    return true;
}

// y, w = That (w_p, y_1') and w' = That (w_p', y_1'') as functions of states and forces.
static void measures(struct split *s, const struct reduced *r, struct ct_state_space *out)
{
    const int f = s->f, k = s->k, n1 = s->n1, m = r->m, n = out->n;
    double *v = matrix(s->a, m, n), *v_g = matrix(s->a, m, f), *dv = matrix(s->a, m, n),
           *dv_g = matrix(s->a, m, f), *AA = matrix(s->a, n, n), *AB = matrix(s->a, n, f);
    ct_matrix_multiply(AA, out->A, out->A, n, n, n);
    ct_matrix_multiply(AB, out->A, out->B, n, n, f);
    for (int i = 0; i < k; i++) {
        v[i + m * (m + i)] = 1;
        for (int j = 0; j < n; j++)
            dv[i + m * j] = out->A[m + i + n * j];
        for (int j = 0; j < f; j++)
            dv_g[i + m * j] = out->B[m + i + n * j];
    }
    for (int i = k; i < k + n1; i++) {
        for (int j = 0; j < n; j++) {
            v[i + m * j] = out->A[i + n * j];
            dv[i + m * j] = AA[i + n * j];
        }
        for (int j = 0; j < f; j++) {
            v_g[i + m * j] = out->B[i + n * j];
            dv_g[i + m * j] = AB[i + n * j];
        }
    }
    put(out->y_x, f, 0, r->That, f, m);
    memcpy(out->y_g, r->y_g, (size_t)f * (size_t)f * sizeof *out->y_g);
    ct_matrix_multiply(out->w_x, r->That, v, f, m, n);
    ct_matrix_multiply(out->w_g, r->That, v_g, f, m, f);
    ct_matrix_multiply(out->dw_x, r->That, dv, f, m, n);
    ct_matrix_multiply(out->dw_g, r->That, dv_g, f, m, f);
}

static void name_states(struct split *s, struct ct_state_space *out)
{
    int *place = CT_NEWN(s->a, int, out->nplace + 1),
        *speed = CT_NEWN(s->a, int, out->nspeed + 1);
    for (int i = 0; i < out->nplace; i++)
        place[i] = s->is_mixed ? -1 : i < s->k ? s->heavy[i] : s->light[i - s->k];
    for (int i = 0; i < out->nspeed; i++)
        speed[i] = s->is_mixed ? -1 : s->heavy[i];
    out->place = place;
    out->speed = speed;
}

bool ct_state_space_create(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_linear *l,
                           struct ct_state_space *out)
{
    struct split s = {.ctx = ctx, .a = a, .l = l, .f = l->nfree};
    struct reduced r;
    const int f = s.f;
    *out = (struct ct_state_space){0};
    if (f) {
        find_massless(&s);
        choose_light(&s);
        split_by_damping(&s);
    }
    s.T = matrix(a, f, s.k + s.n1);
    for (int i = 0; i < s.k; i++)
        s.T[s.heavy[i] + f * i] = 1;
    if (s.n1)
        memcpy(s.T + (size_t)f * (size_t)s.k, s.N, (size_t)f * (size_t)s.n1 * sizeof *s.N);
    if (!reduce(&s, &r))
        return false;
    out->nplace = s.k + s.n1;
    out->nspeed = s.k;
    const int n = out->n = out->nplace + out->nspeed;
    double **const by_state[] = {&out->y_x, &out->w_x, &out->dw_x};
    double **const by_force[] = {&out->y_g, &out->w_g, &out->dw_g};
    for (size_t i = 0; i < COUNT(by_state); i++) {
        *by_state[i] = matrix(a, f, n);
        *by_force[i] = matrix(a, f, f);
    }
    out->A = matrix(a, n, n);
    out->B = matrix(a, n, f);
    if (!rates(&s, &r, out))
        return false;
    measures(&s, &r, out);
    name_states(&s, out);
    return true;
}
