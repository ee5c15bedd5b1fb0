// See arpack.h. Implicitly restarted Lanczos in shift-invert mode (3), driven by reverse
// communication.
#include "numeric/arpack.h"

#if CT_HAS_ARPACK

#include <string.h>

// Fortran passes the length of each character argument behind the others.
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

enum { FEWEST_VECTORS = 20, MOST_RESTARTS = 300 };

struct run {
    const struct ct_operator *op;
    int n, nconverged;
    const double *converged; // n x nknown
    double *Mconverged;      // M known
};

// x <- x - known known' M x
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

// y = (K - shift M)^-1 f, without what is known
static void apply(const struct run *s, double *y, const double *f)
{
    s->op->solve(s->op->data, y, f);
    deflate(s, y);
}

static void serve_request(const struct run *s, int ido, const int *ipntr, double *workd,
                          double *work)
{
    double *x = workd + ipntr[0] - 1, *y = workd + ipntr[1] - 1;
    if (ido == 2) {
        s->op->masses(s->op->data, y, x);
    } else if (ido == 1) { // M x is there already
        apply(s, y, workd + ipntr[2] - 1);
    } else {
        s->op->masses(s->op->data, work, x);
        apply(s, y, work);
    }
}

int ct_arpack_largest(struct ct_arena *a, const struct ct_operator *op, int n, int nev,
                      const double *converged, int nconverged, const double *start,
                      double *theta, double *V)
{
    struct run s = {.op = op, .n = n, .nconverged = nconverged, .converged = converged};
    const size_t size = (size_t)n;
    int ncv = 2 * nev + 1 > FEWEST_VECTORS ? 2 * nev + 1 : FEWEST_VECTORS;
    ncv = ncv < n ? ncv : n;
    const int lworkl = ncv * (ncv + 8), rvec = 1;
    int ido = 0, info = 1, iparam[11] = {1, 0, MOST_RESTARTS, 1, 0, 0, 3}, ipntr[11];
    const double tolerance = 0,
                 zero = 0; // to round-off; no shift: eigenvalues of OP are wanted
    double *resid = CT_NEWN(a, double, n), *basis = CT_NEWN(a, double, size *(size_t)ncv),
           *workd = CT_NEWN(a, double, 3 * size), *workl = CT_NEWN(a, double, lworkl),
           *work = CT_NEWN(a, double, n), *d = CT_NEWN(a, double, nev + 1);
    int *select = CT_NEWN(a, int, ncv);
    s.Mconverged = CT_NEWN(a, double, size *(size_t)nconverged + 1);
    for (int j = 0; j < nconverged; j++)
        op->masses(op->data, s.Mconverged + size * (size_t)j, converged + size * (size_t)j);
    memcpy(resid, start, size * sizeof *resid);
    for (;;) {
        dsaupd_(&ido, "G", &n, "LM", &nev, &tolerance, resid, &ncv, basis, &n, iparam, ipntr,
                workd, workl, &lworkl, &info, 1, 2);
        if (ido != -1 && ido != 1 && ido != 2)
            break;
        serve_request(&s, ido, ipntr, workd, work);
    }
    if (info < 0)
        return -1;
    const int found = iparam[4] < nev ? iparam[4] : nev;
    dseupd_(&rvec, "A", select, d, basis, &n, &zero, "G", &n, "LM", &nev, &tolerance, resid,
            &ncv, basis, &n, iparam, ipntr, workd, workl, &lworkl, &info, 1, 1, 2);
    if (info != 0)
        return -1;
    for (int j = 0; j < found; j++) // with shift 0 they come as 1/theta
        theta[j] = 1 / d[j];
    memcpy(V, basis, size * (size_t)found * sizeof *V);
    return found;
}

#else

int ct_arpack_largest(struct ct_arena *a, const struct ct_operator *op, int n, int nev,
                      const double *converged, int nconverged, const double *start,
                      double *theta, double *V)
{
    (void)a, (void)op, (void)n, (void)nev, (void)converged, (void)nconverged, (void)start;
    (void)theta, (void)V;
    return -1;
}

#endif
