// Numerical values and factors of the sparse Newton matrix; see newton_sparse.h.
#include "integrate/implicit/newton_pattern.h"
#include "integrate/stepper.h"

#include <string.h>

struct ct_newton {
    const struct ct_newton_pattern *p;
    const struct ct_dae *dae;
    const int *active; // rows that count  (m)
    int m;
    double *v;     // K, C, M, R, D, J, with zeros in unused rows
    double *A;     // S, X, W
    double *G;     // the matrix, real or complex
    bool *counts;  // each row  (most_rows)
    int *rank_of;  // of rows that count  (most_rows)
    double *b;     // of all rows (n numbers or pairs)
    double *k;     // changes of auxiliary unknowns  (nauxiliary)
    double *x, *y; // of products  (nu)
    struct ct_factors *real, *pair, *slow;
};

struct ct_newton *ct_newton_create(struct ct_arena *a, const struct ct_dae *dae,
                                   const struct ct_newton_pattern *plan, bool is_complex)
{
    if (!plan)
        return NULL;
    struct ct_newton *s = CT_NEW(a, struct ct_newton);
    const int nz = plan->pattern->nz, numbers = is_complex ? 2 : 1;
    *s = (struct ct_newton){.p = plan, .dae = dae};
    s->v = CT_NEWN(a, double, plan->nvalue + 1);
    s->A = CT_NEWN(a, double, CT_NEWTON_PARTS *nz + 1);
    s->G = CT_NEWN(a, double, numbers *nz + 1);
    s->b = CT_NEWN(a, double, numbers * plan->n + 1);
    s->k = CT_NEWN(a, double, plan->nauxiliary + 1);
    s->x = CT_NEWN(a, double, plan->nu + 1);
    s->y = CT_NEWN(a, double, plan->nu + 1);
    s->counts = CT_NEWN(a, bool, plan->most_rows + 1);
    s->rank_of = CT_NEWN(a, int, plan->most_rows + 1);
    s->real = ct_factors_create(a, plan->pattern, false);
    if (is_complex) {
        s->slow = ct_factors_create(a, plan->pattern, false);
        s->pair = ct_factors_create(a, plan->pattern, true);
    }
    return s;
}

void ct_newton_retain_rows(struct ct_newton *s, const int *kept, int m)
{
    s->active = kept;
    s->m = m;
    memset(s->counts, 0, (size_t)s->p->most_rows * sizeof *s->counts);
    for (int i = 0; i < m; i++) {
        s->counts[kept[i]] = true;
        s->rank_of[kept[i]] = i;
    }
}

static void clear_rows(struct ct_newton *s, const struct ct_newton_list *A)
{
    for (int i = 0; i < A->n; i++)
        if (!s->counts[A->row[i]])
            s->v[A->first + i] = 0;
}

enum ct_eval ct_newton_evaluate(struct ct_newton *s, double t, const double *q, const double *u,
                                const double *a, const double *lam, const double *w)
{
    const struct ct_newton_pattern *p = s->p;
    const double *v;
    const enum ct_eval e = s->dae->evaluate_jacobian(s->dae->user, t, q, u, a, lam, &v);
    if (e != CT_EVAL_OK)
        return e;
    memcpy(s->v, v, (size_t)p->nvalue * sizeof *v);
    if (s->m < p->most_rows) {
        clear_rows(s, &p->J);
        clear_rows(s, &p->D);
    }
    ct_newton_pattern_assemble(p, s->A, s->v, w);
    for (int i = 0; i < p->first_auxiliary - p->nu; i++)
        if (!s->counts[i % p->most_rows])
            s->A[p->index[i]] = 1;
    return CT_EVAL_OK;
}

bool ct_newton_factor(struct ct_newton *s, double c, double e)
{
    ct_newton_pattern_form(s->p, s->G, s->A, c, e);
    return ct_factors_compute(s->real, s->G);
}

bool ct_newton_factor_slow(struct ct_newton *s, double c)
{
    ct_newton_pattern_form(s->p, s->G, s->A, c, c * c);
    return ct_factors_compute(s->slow, s->G);
}

bool ct_newton_factor_complex(struct ct_newton *s, double _Complex w)
{
    const struct ct_newton_pattern *p = s->p;
    const double *A = s->A, *B = A + p->pattern->nz, *D = B + p->pattern->nz;
    const double _Complex ww = w * w;
    for (int i = 0; i < p->pattern->nz; i++) {
        const double _Complex by = ct_newton_pattern_is_force(p, p->pattern->row[i]) ? ww : w;
        s->G[2 * i] = A[i] + creal(w) * B[i] + creal(by) * D[i];
        s->G[2 * i + 1] = cimag(w) * B[i] + cimag(by) * D[i];
    }
    return ct_factors_compute(s->pair, s->G);
}

// Scatters the selected rows into all rows, with values `stride` apart, and gathers them again.
static void scatter(const struct ct_newton *s, double *all, const double *b, int stride)
{
    const struct ct_newton_pattern *p = s->p;
    for (int k = 0; k < p->nu; k++)
        all[stride * k] = b[k];
    for (int k = p->first_auxiliary; k < p->n; k++)
        all[stride * k] = 0;
    for (int first = p->nu, of = p->nu; first < p->first_auxiliary;
         first += p->most_rows, of += s->m) {
        for (int i = 0; i < p->most_rows; i++)
            all[stride * (first + i)] = 0;
        for (int i = 0; i < s->m; i++)
            all[stride * (first + s->active[i])] = b[of + i];
    }
}

static void gather(const struct ct_newton *s, double *b, const double *all, int stride)
{
    const struct ct_newton_pattern *p = s->p;
    for (int k = 0; k < p->nu; k++)
        b[k] = all[stride * k];
    for (int first = p->nu, of = p->nu; first < p->first_auxiliary;
         first += p->most_rows, of += s->m)
        for (int i = 0; i < s->m; i++)
            b[of + i] = all[stride * (first + s->active[i])];
}

static void solve(struct ct_newton *s, struct ct_factors *f, double *b)
{
    scatter(s, s->b, b, 1);
    ct_factors_solve(f, s->b);
    gather(s, b, s->b, 1);
}

void ct_newton_solve(struct ct_newton *s, double *b)
{
    solve(s, s->real, b);
}

void ct_newton_solve_slow(struct ct_newton *s, double *b)
{
    solve(s, s->slow, b);
}

void ct_newton_slow_parts(struct ct_newton *s, double *part)
{
    const struct ct_newton_list *M = &s->p->M;
    const double *v = s->v + M->first;
    ct_factors_inverse(s->slow, s->G); // whose numbers are no longer needed
    memset(part, 0, (size_t)s->p->nu * sizeof *part);
    for (int i = 0; i < M->n; i++)
        part[M->column[i]] += s->G[s->p->copy[i].target] * v[i];
}

void ct_newton_solve_complex(struct ct_newton *s, double *b, int n)
{
    scatter(s, s->b, b, 2);
    scatter(s, s->b + 1, b + n, 2);
    ct_factors_solve(s->pair, s->b);
    gather(s, b, s->b, 2);
    gather(s, b + n, s->b + 1, 2);
}

// ---- products -----------------------------------------------------------------------------------

// Row `row` of A times x.
static inline double row_times(const struct ct_newton_list *A, const double *value, int row,
                               const double *x)
{
    const double *v = value + A->first;
    double sum = 0;
    for (int i = A->start[row]; i < A->start[row + 1]; i++)
        sum += v[i] * x[A->column[i]];
    return sum;
}

// y += c (A + R_r (1 - R_k)^-1 A_k) x. The auxiliary unknowns k follow by forward substitution.
static void add_product(const struct ct_newton *s, const struct ct_newton_list *A, double *y,
                        double c, const double *x)
{
    const struct ct_newton_pattern *p = s->p;
    const int nu = p->nu;
    for (int i = 0; i < p->nauxiliary; i++)
        s->k[i] = row_times(A, s->v, nu + i, x) + row_times(&p->R, s->v, nu + i, s->k);
    for (int row = 0; row < nu; row++) {
        const double by_auxiliary = p->nauxiliary ? row_times(&p->R, s->v, row, s->k) : 0;
        y[row] += c * (row_times(A, s->v, row, x) + by_auxiliary);
    }
}

void ct_newton_add_mass(const struct ct_newton *s, double *y, double c, const double *x)
{
    add_product(s, &s->p->M, y, c, x);
}

void ct_newton_add_stiffness(const struct ct_newton *s, double *y, double c, const double *x)
{
    add_product(s, &s->p->K, y, c, x);
}

void ct_newton_add_motion(const struct ct_newton *s, double *y, double a, const double *F,
                          double b, const double *G)
{
    const struct ct_newton_pattern *p = s->p;
    const struct ct_newton_list *M = &p->M, *C = &p->C, *R = &p->R;
    const int nu = p->nu;
    double *x = s->x;
    for (int k = 0; k < nu; k++)
        x[k] = a * F[k] + (G ? b * G[k] : 0);
    for (int i = 0; i < p->nauxiliary; i++)
        s->k[i] = row_times(M, s->v, nu + i, x) + row_times(C, s->v, nu + i, F)
                + row_times(R, s->v, nu + i, s->k);
    for (int row = 0; row < nu; row++) {
        const double by_auxiliary = p->nauxiliary ? row_times(R, s->v, row, s->k) : 0;
        y[row] += row_times(M, s->v, row, x) + row_times(C, s->v, row, F) + by_auxiliary;
    }
}

void ct_newton_add_rows(const struct ct_newton *s, double *y, double c, const double *x)
{
    const struct ct_newton_list *J = &s->p->J;
    const double *v = s->v + J->first;
    for (int i = 0; i < J->n; i++)
        if (s->counts[J->row[i]])
            y[s->rank_of[J->row[i]]] += c * v[i] * x[J->column[i]];
}

void ct_newton_add_constraint_force(const struct ct_newton *s, double *y, double c,
                                    const double *x)
{
    const struct ct_newton_list *J = &s->p->J;
    const double *v = s->v + J->first;
    for (int i = 0; i < J->n; i++)
        if (s->counts[J->row[i]])
            y[J->column[i]] += c * v[i] * x[s->rank_of[J->row[i]]];
}

static double form_of(const struct ct_newton *s, const struct ct_newton_list *A,
                      const double *x)
{
    const int nu = s->p->nu;
    double sum = 0;
    memset(s->y, 0, (size_t)nu * sizeof *s->y);
    add_product(s, A, s->y, 1, x);
    for (int k = 0; k < nu; k++)
        sum += x[k] * s->y[k];
    return sum;
}

double ct_newton_mass_form(const struct ct_newton *s, const double *x)
{
    return form_of(s, &s->p->M, x);
}

double ct_newton_stiffness_form(const struct ct_newton *s, const double *x)
{
    return form_of(s, &s->p->K, x);
}

// The part of the diagonal entry k of M that comes from auxiliary unknowns.
static double mass_by_auxiliary(const struct ct_newton *s, int k)
{
    const struct ct_newton_pattern *p = s->p;
    const struct ct_newton_list *M = &p->M, *R = &p->R;
    const int nu = p->nu, end = R->start[k + 1];
    const int last = end > R->start[k] ? R->column[end - 1] : -1;
    memset(s->k, 0, (size_t)p->nauxiliary * sizeof *s->k);
    for (int i = p->M_start[k]; i < p->M_start[k + 1]; i++)
        if (M->row[p->M_entry[i]] >= nu)
            s->k[M->row[p->M_entry[i]] - nu] = s->v[M->first + p->M_entry[i]];
    for (int i = 0; i <= last; i++)
        s->k[i] += row_times(R, s->v, nu + i, s->k);
    return row_times(R, s->v, k, s->k);
}

void ct_newton_masses(const struct ct_newton *s, double *mass)
{
    const struct ct_newton_list *M = &s->p->M;
    memset(mass, 0, (size_t)s->p->nu * sizeof *mass);
    for (int i = 0; i < M->n; i++)
        if (M->row[i] == M->column[i])
            mass[M->row[i]] += s->v[M->first + i];
    for (int k = 0; k < s->p->nu && s->p->nauxiliary; k++)
        mass[k] += mass_by_auxiliary(s, k);
}
