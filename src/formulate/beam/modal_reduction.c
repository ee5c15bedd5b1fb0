// Reduction of a beam to shapes, a superelement; see modal_reduction.h.
//
// Condensed: rotations without inertia depend statically on the other freedoms.
//
// Modal: the nodal freedoms become  q = Psi eta_c + Phi eta_m.  The boundary freedoms are those
// that joints or loads act on. Psi: static shapes of a unit displacement of each boundary freedom
// with the other ones fixed. Phi: the lowest modes with all boundary freedoms fixed. A beam without
// joints and loads beyond its base has modes only.
// Source: Craig & Bampton (1968), key craig1968.
#include "formulate/beam/modal_reduction.h"
#include "numeric/dense.h"
#include "formulate/beam/static_condensation.h"
#include "formulate/beam/massless_rotations.h"
#include "formulate/beam/stiffness.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { NKIND = CT_NODE_FREEDOM };

struct reduction {
    struct ct_build *b;
    struct ct_flexible *f;
    int n, nkept;  // freedoms that are not fixed; of these with a static shape of their own
    int *freedom;  // by number: those with a static shape come first
    int *number;   // by freedom; -1: fixed
    double *K, *M; // n x n
    double *L;     // factor of K between the freedoms without a static shape
    int nshape;
    double *shape; // n x nshape
};

// ---- freedoms -----------------------------------------------------------------------------------

// Does a joint or a load act on the beam at this frame?
static bool is_used(const struct ct_model *m, size_t frame)
{
    for (size_t i = 0; i < m->njoint; i++)
        if (m->joint[i].from == (int)frame || m->joint[i].to == (int)frame)
            return true;
    for (size_t i = 0; i < m->nforce; i++)
        if (m->force[i].from == (int)frame || m->force[i].to == (int)frame)
            return true;
    return false;
}

// Marks the nodes whose freedoms move a point with a joint or a load.
static void mark_nodes(const struct reduction *r, bool *held)
{
    const struct ct_model *m = r->b->model;
    for (size_t i = 0; i < m->nframe; i++) {
        struct ct_station s;
        if (m->frame[i].body != r->f->body || !is_used(m, i))
            continue;
        if ((int)i == m->body[r->f->body].frame) {
            held[0] = true; // only with a frame on the chord are there freedoms
            continue;
        }
        ct_flexible_station(r->b, r->f, m->frame[i].at.e[0], CT_AXIAL_LINEAR, &s);
        held[s.element] = held[s.element] || !ct_ex_same(s.xi, CT_EX_ONE);
        held[s.element + 1] = held[s.element + 1] || !ct_ex_is_zero(s.xi);
    }
}

// kept: by freedom, those with a static shape.
static void number_freedoms(struct reduction *r, const bool *kept)
{
    const int nnode = r->f->beam->nelement + 1;
    bool *exists = CT_NEWN(r->b->ctx->scratch, bool, NKIND *nnode);
    r->freedom = CT_NEWN(r->b->ctx->scratch, int, NKIND *nnode);
    r->number = CT_NEWN(r->b->ctx->scratch, int, NKIND *nnode);
    for (int e = 0; e + 1 < nnode; e++)
        for (int j = 0; j < CT_DOF; j++)
            if (r->f->element[e].freedom[j] >= 0)
                exists[r->f->element[e].freedom[j]] = true;
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < NKIND * nnode; i++)
            if (exists[i] && kept[i] == !pass) {
                r->number[i] = r->n;
                r->freedom[r->n++] = i;
            }
        r->nkept = pass ? r->nkept : r->n;
    }
    for (int i = 0; i < NKIND * nnode; i++)
        if (!exists[i])
            r->number[i] = -1;
}

static void assemble(struct reduction *r)
{
    ct_ex K[CT_DOF][CT_DOF], M[CT_DOF][CT_DOF];
    const struct ct_build *b = r->b;
    const size_t n = (size_t)r->n;
    r->K = CT_NEWN(b->ctx->scratch, double, n *n);
    r->M = CT_NEWN(b->ctx->scratch, double, n *n);
    for (int e = 0; e < r->f->beam->nelement; e++) {
        ct_element_matrices(r->b, r->f, e, K, M);
        for (int j = 0; j < CT_DOF; j++)
            for (int k = 0; k < CT_DOF; k++) {
                int sj, sk;
                if (!ct_dof_freedom(r->f, e, j, &sj) || !ct_dof_freedom(r->f, e, k, &sk))
                    continue;
                const size_t at = (size_t)r->number[r->f->element[e].freedom[j]]
                                + n * (size_t)r->number[r->f->element[e].freedom[k]];
                r->K[at] += sj * sk * ct_ex_value(b->x, K[j][k], b->value);
                r->M[at] += sj * sk * ct_ex_value(b->x, M[j][k], b->value);
            }
    }
}

// ---- shapes -------------------------------------------------------------------------------------

// Freedoms of these families without a static shape, by number (out). Returns how many.
static int inner_freedoms(const struct reduction *r, unsigned families, int *out)
{
    int m = 0;
    for (int i = r->nkept; i < r->n; i++)
        if (ct_freedom_family(r->freedom[i] % NKIND) & families)
            out[m++] = i;
    return m;
}

// Rows and columns `at` (m) of A.
static double *block(const struct reduction *r, const double *A, const int *at, int m)
{
    double *out = CT_NEWN(r->b->ctx->scratch, double, (size_t)m *(size_t)m + 1);
    for (int j = 0; j < m; j++)
        for (int i = 0; i < m; i++)
            out[i + (size_t)m * (size_t)j] = A[at[i] + (size_t)r->n * (size_t)at[j]];
    return out;
}

// Psi = [1; -K_ii^-1 K_ic]
static bool static_shapes(struct reduction *r)
{
    int *at = CT_NEWN(r->b->ctx->scratch, int, r->n + 1);
    const int m = inner_freedoms(r, CT_BEAM_ALL, at);
    r->L = block(r, r->K, at, m);
    if (m && !ct_cholesky(r->L, m, m))
        return false;
    for (int c = 0; c < r->nkept; c++) {
        double *v = r->shape + (size_t)r->n * (size_t)r->nshape++;
        v[c] = 1;
        for (int i = 0; i < m; i++)
            v[r->nkept + i] = -r->K[r->nkept + i + (size_t)r->n * (size_t)c];
        if (m)
            ct_cholesky_solve(v + r->nkept, r->L, m, m, 1, m);
    }
    return true;
}

// Removes round-off from a shape. For a straight axis with principal axes, stretch, twist and both
// bendings are decoupled. Components of other families are round-off of the largest component, 1.
static void drop_roundoff(const struct reduction *r, double *v)
{
    unsigned moves = 0;
    for (int i = 0; i < r->n; i++)
        if (fabs(v[i]) > CT_DATA_ROUNDOFF) // n eps of the eigenvectors, n up to some thousand
            moves |= ct_freedom_family(r->freedom[i] % NKIND);
    for (int i = 0; i < r->n; i++)
        if (!(moves & ct_freedom_family(r->freedom[i] % NKIND)))
            v[i] = 0;
}

// Does the cut separate modes of equal frequency? The first `wanted` of w (m, ascending, 1/omega^2)
// from its end are kept. Frequencies are equal if they differ by less than the round-off of the
// eigenvalues: m eps of the largest, a hundred times for the steps of the solution.
static void find_cut(const struct reduction *r, const double *w, int m, int wanted)
{
    const double roundoff = 100 * m * DBL_EPSILON * w[m - 1], at = w[m - wanted];
    int below = wanted, above = wanted;
    while (below > 0 && w[m - below] - at <= roundoff)
        below--;
    while (above < m && at - w[m - 1 - above] <= roundoff)
        above++;
    if (above == wanted || at <= roundoff)
        return;
    r->f->cut = 1 / sqrt(at);
    r->f->uncut[0] = below;
    r->f->uncut[1] = above;
}

// Relative difference below which entries count as equal by symmetry. The first of them is then
// taken as the largest, so that round-off does not decide. Derived: far above n eps, and far below
// differences of unequal entries.
static const double equality_tolerance = 1e-6;

// Modes of these families, K v = w^2 M v with the other freedoms fixed. Solved as M v = (1/w^2) K v,
// because M may be singular. Scaled to a largest component of 1.
static bool modes(struct reduction *r, unsigned families, int wanted)
{
    struct ct_arena *scratch = r->b->ctx->scratch;
    int *at = CT_NEWN(scratch, int, r->n + 1);
    const int m = inner_freedoms(r, families, at);
    double *A = block(r, r->M, at, m), *B = block(r, r->K, at, m),
           *w = CT_NEWN(scratch, double, m + 1);
    double *work = CT_NEWN(scratch, double, ct_pencil_eigen_work(m));
    if (m && !ct_pencil_eigen(w, A, B, m, m, work))
        return false;
    for (int k = 0; k < wanted && k < m; k++) {
        const double *v = A + (size_t)m * (size_t)(m - 1 - k);
        double most = 0, *out = r->shape + (size_t)r->n * (size_t)r->nshape++;
        for (int i = 0; i < m; i++)
            most = fabs(v[i]) > (1 + equality_tolerance) * fabs(most) ? v[i] : most;
        for (int i = 0; i < m; i++)
            out[at[i]] = v[i] / most;
        drop_roundoff(r, out);
    }
    if (wanted > 0 && wanted < m)
        find_cut(r, w, m, wanted);
    return true;
}

static void hand_over(const struct reduction *r, struct ct_shapes *out)
{
    out->n = r->n;
    out->nshape = r->nshape;
    out->nstatic = r->nkept;
    out->freedom = CT_NEWN(r->b->arena, int, r->n + 1);
    memcpy(out->freedom, r->freedom, (size_t)r->n * sizeof *out->freedom);
    out->shape = r->shape;
}

static bool *new_marks(const struct ct_build *b, const struct ct_flexible *f)
{
    return CT_NEWN(b->ctx->scratch, bool, NKIND *(f->beam->nelement + 1));
}

// Freedoms by number, those first that keep a static shape.
static void number_modal(struct reduction *r)
{
    bool *node = new_marks(r->b, r->f), *kept = new_marks(r->b, r->f);
    mark_nodes(r, node);
    for (int i = 0; i < NKIND * (r->f->beam->nelement + 1); i++)
        kept[i] = node[i / NKIND] && i % NKIND < CT_FREEDOM_RM;
    number_freedoms(r, kept);
}

bool ct_flexible_keeps_all_modes(struct ct_build *b, struct ct_flexible *f)
{
    struct reduction r = {.b = b, .f = f};
    number_modal(&r);
    f->most_modes = inner_freedoms(&r, f->excited, CT_NEWN(b->ctx->scratch, int, r.n + 1));
    return f->beam->modes >= f->most_modes;
}

bool ct_flexible_reduce(struct ct_build *b, struct ct_flexible *f, struct ct_shapes *out)
{
    struct reduction r = {.b = b, .f = f};
    number_modal(&r);
    assemble(&r);
    r.shape = CT_NEWN(b->arena, double, (size_t)r.n *(size_t)(r.n + 1) + 1);
    // deformations that the model cannot excite do not count in the number of modes
    if (!static_shapes(&r) || !modes(&r, f->excited, f->beam->modes)
        || !modes(&r, ~f->excited, f->beam->modes))
        return ct_error(b->ctx, f->beam->modes_mark, CT_E_BEAM,
                        "beam '%s': its modes cannot be found; is every stiffness positive?",
                        f->name);
    hand_over(&r, out);
    return true;
}

// v' M v for values v of the freedoms.
static double weight_of(const struct reduction *r, const double *v)
{
    double sum = 0;
    for (size_t j = 0; j < (size_t)r->n; j++)
        for (size_t i = 0; i < (size_t)r->n && v[j] != 0; i++)
            sum += v[i] * r->M[i + (size_t)r->n * j] * v[j];
    return sum;
}

// Relative part of the values g that P c cannot represent.
static double relative_residual(const struct reduction *r, const double *P,
                                const ct_ex *by_freedom, const ct_ex *c)
{
    const struct ct_build *b = r->b;
    const size_t n = (size_t)r->n;
    double *g = CT_NEWN(b->ctx->scratch, double, n + 1);
    for (size_t i = 0; i < n; i++)
        g[i] = ct_ex_value(b->x, by_freedom[r->freedom[i]], b->value);
    const double all = weight_of(r, g);
    for (int k = 0; k < r->f->nelastic; k++)
        for (size_t i = 0; i < n; i++)
            g[i] -= P[i + n * (size_t)k] * ct_ex_value(b->x, c[k], b->value);
    return all > 0 ? sqrt(fmax(0, weight_of(r, g)) / all) : 0;
}

bool ct_flexible_fit(struct ct_build *b, struct ct_flexible *f, const ct_ex *by_freedom,
                     ct_ex *out)
{
    struct reduction r = {.b = b, .f = f};
    const int m = f->nelastic;
    number_freedoms(&r, new_marks(b, f));
    assemble(&r);
    const size_t n = (size_t)r.n;
    double *P = CT_NEWN(b->ctx->scratch, double, n *(size_t)m + 1),
           *MP = CT_NEWN(b->ctx->scratch, double, n *(size_t)m + 1),
           *A = CT_NEWN(b->ctx->scratch, double, (size_t)m *(size_t)m + 1),
           *v = CT_NEWN(b->ctx->scratch, double, m + 1);
    for (size_t i = 0; i < n; i++) {
        const struct ct_freedom *d = &f->freedom[r.freedom[i]];
        for (int p = 0; p < d->npart; p++)
            P[i + n * (size_t)d->part[p].k] = ct_ex_value(b->x, d->part[p].coef, b->value);
    }
    for (size_t k = 0; k < (size_t)m; k++)
        for (size_t j = 0; j < n; j++)
            for (size_t i = 0; i < n && P[j + n * k] != 0; i++)
                MP[i + n * k] += r.M[i + n * j] * P[j + n * k];
    for (size_t k = 0; k < (size_t)m; k++)
        for (size_t l = 0; l < (size_t)m; l++)
            for (size_t i = 0; i < n; i++)
                A[k + (size_t)m * l] += P[i + n * k] * MP[i + n * l];
    if (!ct_cholesky(A, m, m))
        return false;
    for (int k = 0; k < m; k++)
        out[k] = CT_EX_ZERO;
    for (size_t i = 0; i < n; i++) {
        if (ct_ex_is_zero(by_freedom[r.freedom[i]]))
            continue;
        for (int k = 0; k < m; k++)
            v[k] = MP[i + n * (size_t)k];
        ct_cholesky_solve(v, A, m, m, 1, m);
        for (int k = 0; k < m; k++)
            out[k] = ct_ex_add(b->x, out[k], ct_ex_scale(b->x, v[k], by_freedom[r.freedom[i]]));
    }
    f->start_residual = fmax(f->start_residual, relative_residual(&r, P, by_freedom, out));
    return true;
}

// Are the rows of the freedoms without a static shape constant in K and zero in M, for any values
// of the parameters?
static bool is_balanced(const struct reduction *r)
{
    ct_ex K[CT_DOF][CT_DOF], M[CT_DOF][CT_DOF];
    for (int e = 0; e < r->f->beam->nelement; e++) {
        ct_element_matrices(r->b, r->f, e, K, M);
        for (int j = 0; j < CT_DOF; j++) {
            const int i = r->f->element[e].freedom[j];
            for (int k = 0; k < CT_DOF && i >= 0 && r->number[i] >= r->nkept; k++)
                if (!ct_ex_is_const(r->b->x, K[j][k], NULL) || !ct_ex_is_zero(M[j][k]))
                    return false;
        }
    }
    return true;
}

bool ct_flexible_condense(struct ct_build *b, struct ct_flexible *f, struct ct_shapes *out)
{
    struct reduction r = {.b = b, .f = f};
    bool *kept = new_marks(b, f);
    if (!ct_flexible_find_massless_rotations(b, f, kept))
        return false;
    for (int i = 0; i < NKIND * (f->beam->nelement + 1); i++)
        kept[i] = !kept[i];
    number_freedoms(&r, kept);
    if (r.nkept == r.n)
        return false;
    assemble(&r);
    r.shape = CT_NEWN(b->arena, double, (size_t)r.n *(size_t)(r.nkept + 1) + 1);
    if (!static_shapes(&r))
        return false;
    f->condensation = ct_condensation_create(
        b, &(struct ct_condensation_numbers){.nfreedom = NKIND * (f->beam->nelement + 1),
                                             .n = r.n,
                                             .nkept = r.nkept,
                                             .freedom = r.freedom,
                                             .K = r.K,
                                             .L = r.L,
                                             .is_balanced = is_balanced(&r)});
    hand_over(&r, out);
    return true;
}
