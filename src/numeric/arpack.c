// See arpack.h.
//
// ARPACK's implicitly restarted Lanczos iteration, driven by reverse communication: ARPACK returns
// to the caller for each product with OP or M. Mode 3 with shift 0 is used, so that it returns
// 1/theta.
#include "numeric/arpack.h"

#include <math.h>
#include <string.h>

// Fortran passes the length of each character argument after all other arguments.
extern void dsaupd_(int *ido, const char *bmat, const int *n, const char *which, const int *nev,
                    const double *tol, double *resid, const int *ncv, double *v, const int *ldv,
                    int *iparam, int *ipntr, double *workd, double *workl, const int *lworkl,
                    int *info, size_t, size_t);
extern void dseupd_(const int *rvec, const char *howmny, const int *select, double *d,
                    double *z, const int *ldz, const double *sigma, const char *bmat,
                    const int *n, const char *which, const int *nev, const double *tol,
                    double *resid, const int *ncv, double *v, const int *ldv, int *iparam,
                    int *ipntr, double *workd, double *workl, const int *lworkl, int *info,
                    size_t, size_t, size_t);

// Limit: restarts, after which fewer vectors are returned. Definition: a status code of dsaupd.
enum { MOST_RESTARTS = 300, NO_LARGER_BASIS = -9999 };
// Vectors of the basis. Definition: max(2 nev + 1, 20), as in SciPy's eigsh.
enum { FEWEST_VECTORS = 20 };

struct run {
    const struct ct_operator *op;
    int n, nconverged;
    const double *converged; // n x nconverged
    double *Mconverged;      // M converged
    double *work, *image;    // n each
};

// Project on the M-orthogonal complement of the converged vectors: x <- x - converged converged' M
// x.
static void deflate(const struct run *s, double *x)
{
    for (int j = 0; j < s->nconverged; j++) {
        const double *v = s->converged + (size_t)s->n * (size_t)j,
                     *Mv = s->Mconverged + (size_t)s->n * (size_t)j;
        double along = 0;
        for (int i = 0; i < s->n; i++)
            along += Mv[i] * x[i];
        for (int i = 0; i < s->n; i++)
            x[i] -= along * v[i];
    }
}

// y = OP x, projected on the complement of the converged vectors.
static void apply(const struct run *s, double *y, const double *x, const double *Mx)
{
    s->op->apply(s->op->data, y, x, Mx);
    deflate(s, y);
}

static void serve_request(const struct run *s, int ido, const int *ipntr, double *workd)
{
    double *x = workd + ipntr[0] - 1, *y = workd + ipntr[1] - 1;
    if (ido == 2) {
        s->op->metric(s->op->data, y, x);
    } else if (ido == 1) { // ARPACK supplies M x
        apply(s, y, x, workd + ipntr[2] - 1);
    } else {
        s->op->metric(s->op->data, s->work, x);
        apply(s, y, x, s->work);
    }
}

// Case of a one-dimensional complement: OP x is then an eigenvector for any x.
static int find_single(const struct run *s, const double *start, double *theta, double *v)
{
    const int n = s->n;
    const struct ct_operator *op = s->op;
    double squared = 0, *Mv = s->work;
    op->metric(op->data, Mv, start);
    apply(s, v, start, Mv);
    op->metric(op->data, Mv, v);
    for (int i = 0; i < n; i++)
        squared += v[i] * Mv[i];
    if (!(squared > 0))
        return 0;
    for (int i = 0; i < n; i++)
        v[i] /= sqrt(squared);
    op->metric(op->data, Mv, v);
    double *y = s->image;
    op->apply(op->data, y, v, Mv);
    *theta = 0;
    for (int i = 0; i < n; i++)
        *theta += Mv[i] * y[i];
    return 1;
}

// Run the iteration with a basis of ncv vectors. Returns how many eigenvalues have converged, -1
// where ARPACK fails. If the range of OP has fewer dimensions than the basis, *dimension (out) is
// their number, else 0.
static int iterate(struct ct_arena *a, const struct run *s, int nev, int ncv,
                   const double *start, int *dimension, double *theta, double *V)
{
    const int n = s->n, lworkl = ncv * (ncv + 8), rvec = 1;
    const double to_roundoff = 0, shift = 0;
    int ido = 0, info = 1, iparam[11] = {1, 0, MOST_RESTARTS, 1, 0, 0, 3}, ipntr[11];
    double *resid = CT_NEWN(a, double, n), *basis = CT_NEWN(a, double, (size_t)n *(size_t)ncv),
           *workd = CT_NEWN(a, double, 3 * (size_t)n), *workl = CT_NEWN(a, double, lworkl),
           *d = CT_NEWN(a, double, nev + 1);
    int *select = CT_NEWN(a, int, ncv);
    *dimension = 0;
    memcpy(resid, start, (size_t)n * sizeof *resid);
    for (;;) {
        dsaupd_(&ido, "G", &n, "LM", &nev, &to_roundoff, resid, &ncv, basis, &n, iparam, ipntr,
                workd, workl, &lworkl, &info, 1, 2);
        if (ido != -1 && ido != 1 && ido != 2)
            break;
        serve_request(s, ido, ipntr, workd);
    }
    if (info == NO_LARGER_BASIS)
        *dimension = iparam[4];
    if (info < 0)
        return -1;
    const int found = iparam[4] < nev ? iparam[4] : nev;
    dseupd_(&rvec, "A", select, d, basis, &n, &shift, "G", &n, "LM", &nev, &to_roundoff, resid,
            &ncv, basis, &n, iparam, ipntr, workd, workl, &lworkl, &info, 1, 1, 2);
    if (info != 0)
        return -1;
    for (int j = 0; j < found; j++)
        theta[j] = 1 / d[j];
    memcpy(V, basis, (size_t)n * (size_t)found * sizeof *V);
    return found;
}

int ct_arpack_largest(struct ct_arena *a, const struct ct_operator *op, int n, int nev,
                      int room, const double *converged, int nconverged, const double *start,
                      double *theta, double *V)
{
    struct run s = {.op = op, .n = n, .nconverged = nconverged, .converged = converged};
    const size_t size = (size_t)n;
    s.work = CT_NEWN(a, double, size);
    s.image = CT_NEWN(a, double, size);
    s.Mconverged = CT_NEWN(a, double, size *(size_t)nconverged + 1);
    for (int j = 0; j < nconverged; j++)
        op->metric(op->data, s.Mconverged + size * (size_t)j, converged + size * (size_t)j);
    while (room > 1) { // ARPACK demands a basis larger than the number of vectors it returns
        const int wanted = nev < room ? nev : room - 1;
        const int ncv = 2 * wanted + 1 > FEWEST_VECTORS ? 2 * wanted + 1 : FEWEST_VECTORS;
        int dimension;
        const int found
            = iterate(a, &s, wanted, ncv < room ? ncv : room, start, &dimension, theta, V);
        if (found >= 0 || dimension <= 0 || dimension >= room)
            return found;
        room = dimension;
    }
    return find_single(&s, start, theta, V);
}
