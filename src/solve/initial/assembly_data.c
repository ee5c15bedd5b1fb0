// Assembly with constraints that are redundant within the tolerance of the data; see
// assembly_internal.h.
//
// Example: a door on two coaxial hinges whose positions have few digits. Rows that should be
// redundant have singular values of the size delta of the data errors, and residuals of that
// size. To close the loops exactly the door would have to turn by residual/delta, which is
// arbitrary. So the component of these rows that is independent of the others is left out. Let
// Q be an orthonormal basis of the columns of A, without those whose remainder in pivoted
// Gram-Schmidt orthogonalisation is below the tolerance of the data:
//
//     A = [ N^-1 J S ]  loops, by natural sizes (6.5a)       A' = Q Q' A,   r' = Q Q' r
//         [ w G S    ]  demanded values, w large: they are kept
//
// Newton's iteration on A', r' ends where the sum of squares of the residuals is least.
#include "solve/initial/assembly_internal.h"

#include "numeric/dense.h"

#include <math.h>
#include <string.h>

// Weight of demanded values against rows of loops that do not close exactly.
// Derived: demanded values are missed by the inverse square, 1e-6, of the residuals, which are
// 3e-5 at most: 3e-11, within the tolerance of the assembly.
static const double given_weight = 1e3;

struct ct_loop_filter *ct_loop_filter_create(struct ct_arena *a, const struct ct_assembler *s)
{
    struct ct_loop_filter *f = CT_NEW(a, struct ct_loop_filter);
    const size_t nu = s->m->nu, nrow = s->m->nrow, ny = s->m->nq + nu;
    const size_t most = nrow > nu ? nrow : nu;
    f->arena = a;
    f->A = CT_NEWN(a, double, most *(nu + 1));
    f->size = CT_NEWN(a, double, s->most);
    f->r = CT_NEWN(a, double, s->most);
    f->kept_y = CT_NEWN(a, double, ny + 1);
    f->tau = CT_NEWN(a, double, most + 1);
    f->work = CT_NEWN(a, double, ct_qr_pivot_work((int)nu, (int)nrow) + most);
    f->row = CT_NEWN(a, int, most + 1);
    return f;
}

// ---- the projection -----------------------------------------------------------------------------

// v (n) -= its projection on the columns first to last - 1 of Q.
static void orthogonalise(double *v, const double *Q, size_t first, size_t last, size_t n)
{
    for (size_t k = first; k < last; k++)
        ct_vector_add(v, -ct_vector_dot(Q + n * k, v, n), Q + n * k, n);
}

// Q (n x nu, out) = orthonormal basis of the columns of B (n x nu, destroyed) by Gram-Schmidt
// with pivoting; columns with a remainder below the tolerance are left out. Returns the rank.
static size_t find_basis(double *Q, double *B, size_t n, size_t nu)
{
    size_t rank = 0;
    for (;; rank++) {
        size_t best = 0;
        double most = 0;
        for (size_t k = 0; k < nu; k++) {
            orthogonalise(B + n * k, Q, rank - (rank > 0), rank, n);
            const double left = sqrt(ct_vector_dot(B + n * k, B + n * k, n));
            best = left > most ? k : best;
            most = fmax(most, left);
        }
        if (rank == nu || rank == n || !(most > ct_data_tolerance))
            return rank;
        double *b = B + n * best;
        orthogonalise(b, Q, 0, rank, n); // again, against round-off
        most = sqrt(ct_vector_dot(b, b, n));
        for (size_t i = 0; i < n; i++)
            Q[i + n * rank] = b[i] / most;
    }
}

// x (n) = Q Q' x
static void project(double *x, double *image, const double *Q, size_t rank, size_t n)
{
    memset(image, 0, n * sizeof *image);
    for (size_t k = 0; k < rank; k++)
        ct_vector_add(image, ct_vector_dot(Q + n * k, x, n), Q + n * k, n);
    memcpy(x, image, n * sizeof *x);
}

// f->size = natural sizes of the first nhard rows.
static void find_sizes(const struct ct_assembler *s, const bool *is_loop)
{
    const double *size = s->m->row_size;
    size_t n = 0;
    for (size_t i = 0; i < s->m->nrow; i++)
        if (!is_loop || is_loop[i])
            s->filter->size[n++] = size[i];
    for (; n < s->nhard; n++)
        s->filter->size[n] = 1 / given_weight;
}

// Allocate n entries when rows are first filtered: few models need it.
static void reserve(struct ct_loop_filter *f, size_t n)
{
    if (f->Q)
        return;
    f->Q = CT_NEWN(f->arena, double, n);
    f->B = CT_NEWN(f->arena, double, n);
    f->whole = CT_NEWN(f->arena, double, n);
}

void ct_loop_filter_apply(struct ct_assembler *s, const bool *is_loop)
{
    struct ct_loop_filter *f = s->filter;
    const size_t n = s->nhard, nu = s->m->nu;
    if (!f->is_on || !n)
        return;
    reserve(f, s->most * (nu + 1));
    find_sizes(s, is_loop);
    memset(f->B, 0, n * nu * sizeof *f->B);
    for (size_t i = 0; i < n; i++)
        for (size_t k = s->A.start[i]; k < s->A.start[i + 1]; k++)
            f->B[i + n * (size_t)s->A.column[k]] += s->A.value[k] / f->size[i];
    memcpy(f->whole, f->B, n * nu * sizeof *f->B);
    for (size_t k = 0; k < nu; k++)
        for (size_t i = 0; i < n; i++)
            f->B[i + n * k] *= s->m->speed_size[k];
    const size_t rank = find_basis(f->Q, f->B, n, nu);
    for (size_t i = 0; i < n; i++)
        s->r[i] /= f->size[i];
    project(s->r, f->B, f->Q, rank, n);
    for (size_t k = 0; k < nu; k++)
        project(f->whole + n * k, f->B, f->Q, rank, n);
    ct_sparse_rows_clear(&s->A);
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < nu; k++)
            f->r[k] = f->whole[i + n * k];
        ct_sparse_rows_add(&s->A, NULL, f->r, nu, f->size[i]);
        s->r[i] *= f->size[i];
    }
}

// ---- when it is due -----------------------------------------------------------------------------

static void evaluate(struct ct_assembler *s)
{
    ct_evaluator_set(s->m, 0, s->y);
    ct_evaluator_constraint(s->m);
}

// Rank of the loops at s->y by a tolerance.
static int loop_rank(struct ct_assembler *s, double tolerance)
{
    struct ct_loop_filter *f = s->filter;
    return ct_evaluator_order_rows(s->m, s->m->J, tolerance, f->row, f->A, f->tau, f->work);
}

// Largest residual of the loops at s->y, relative to the natural sizes of the rows.
static double largest_residual(struct ct_assembler *s)
{
    double open = 0;
    evaluate(s);
    for (size_t i = 0; i < s->m->nrow; i++)
        if (s->fixed_row[i])
            open = fmax(open, fabs(s->m->phi[i]) / s->m->row_size[i]);
    return open;
}

// Residuals and singular values below this have no effect.
// Derived: with the damping d = 1e-8 a singular value s counts by s^2/(s^2 + d^2) = 1e-6.
static const double negligible = 1e-11;

bool ct_loop_filter_may_hold(struct ct_assembler *s)
{
    return largest_residual(s) <= ct_data_tolerance;
}

bool ct_loop_filter_is_due(struct ct_assembler *s)
{
    if (!s->m->nrow || !s->m->nu)
        return false;
    return largest_residual(s) > negligible
        || loop_rank(s, negligible) > loop_rank(s, ct_data_tolerance);
}

// The loops alone, filtered, into s->A (nrow x nu) and s->r.
static void loop_rows(struct ct_assembler *s)
{
    struct ct_evaluator *m = s->m;
    evaluate(s);
    ct_sparse_rows_clear(&s->A);
    for (size_t i = 0; i < m->nrow; i++) {
        const size_t at = s->first_J[i];
        ct_sparse_rows_add(&s->A, s->J_column + at, m->v + m->nrow + at, s->first_J[i + 1] - at,
                           1);
        s->r[i] = m->phi[i];
    }
    s->nhard = m->nrow;
    ct_loop_filter_apply(s, NULL);
}

// s->b (nu) = minimum-norm solution of A b = -r. Filtered rows have no singular values between
// round-off and the tolerance of the data.
static void minimum_norm_step(struct ct_assembler *s)
{
    for (size_t i = 0; i < s->nhard; i++)
        s->b[i] = -s->r[i];
    ct_damped_factor(s->closing, &s->A, s->nhard, s->nhard, s->m->nu,
                     ct_assembly_least_damping);
    ct_damped_solve(s->closing, s->b, s->b);
}

// Move s->y by `distance` [m or rad] in an arbitrary direction of the tangent space of the loops,
// and close the loops again. False if that fails.
static bool move_along_tangent(struct ct_assembler *s, double distance)
{
    enum { MOST = 20 }; // Limit: of iterations; the data then count as not closing
    // Derived: 1e-4 of the tolerance of the data.
    const double closed = 1e-9;
    const size_t nu = s->m->nu;
    double *d = s->step;
    loop_rows(s);
    for (size_t k = 0; k < nu; k++)
        // golden-ratio sequence: an arbitrary direction
        d[k] = fmod(1 + (double)k * 0.6180339887498949, 1) - 0.4;
    ct_sparse_rows_times(s->r, &s->A, s->nhard, d);
    minimum_norm_step(s);
    ct_vector_add(s->b, 1, d, nu);
    const double size = ct_vector_largest(s->b, nu);
    for (size_t k = 0; k < nu && size > 0; k++)
        s->b[k] *= distance / size;
    for (int i = 0; i < MOST; i++) {
        ct_evaluator_retract(s->m, s->y, s->b);
        loop_rows(s);
        minimum_norm_step(s);
        const double step = ct_vector_largest(s->b, nu);
        if (!(step < distance))
            return false;
        if (step < closed)
            return true;
    }
    return false;
}

// At a singular configuration rows are dependent at that configuration alone. Does the rank, to
// the tolerance of the data, not rise at other configurations?
static bool is_rank_constant(struct ct_assembler *s)
{
    const double distances[] = {0.1, 0.3};
    const size_t ny = s->m->nq + s->m->nu;
    evaluate(s);
    const int here = loop_rank(s, ct_data_tolerance);
    bool is_same = true;
    memcpy(s->filter->kept_y, s->y, ny * sizeof *s->y);
    for (size_t i = 0; i < COUNT(distances) && is_same && here < (int)s->m->nu; i++) {
        const bool is_moved = move_along_tangent(s, distances[i]);
        evaluate(s);
        is_same = is_moved && loop_rank(s, ct_data_tolerance) <= here;
        memcpy(s->y, s->filter->kept_y, ny * sizeof *s->y);
    }
    evaluate(s);
    return is_same;
}

double ct_loop_filter_missed(const struct ct_assembler *s, bool of_speeds)
{
    double most = 0, r;
    for (size_t i = 0; i < s->e->ncoordinate && s->filter->is_on; i++) {
        if (of_speeds && s->u[i].is_given)
            most = fmax(most, fabs(s->m->result.out[2 * i + 1] - s->u[i].value));
        else if (!of_speeds && s->q[i].is_given && ct_assembler_deviation(s, i, &r))
            most = fmax(most, fabs(r));
    }
    return most;
}

// Are the residuals a minimum? Near a singular configuration the iteration may have stopped
// earlier, at demanded values.
static bool is_least(struct ct_assembler *s, double residual)
{
    // Fraction of the residual that may lie in the range of the loops' filtered rows. Their
    // basis differs from that with demanded values by an angle: the part left out, up to the
    // tolerance, over the norm of the columns kept.
    // Derived: columns kept have norms between the tolerance and 1; the geometric mean.
    const double basis_angle = sqrt(ct_data_tolerance);
    loop_rows(s);
    double left = 0;
    for (size_t i = 0; i < s->m->nrow; i++)
        if (s->fixed_row[i])
            left = fmax(left, fabs(s->r[i]) / s->m->row_size[i]);
    return left <= fmax(negligible, basis_angle * residual);
}

bool ct_loop_filter_holds(struct ct_assembler *s)
{
    // A residual that is only round-off: the data close exactly. Derived: 45 units of
    // round-off.
    const double closed = 1e-14;
    const double residual = largest_residual(s);
    return residual > closed && residual <= ct_data_tolerance && is_least(s, residual)
        && is_rank_constant(s);
}

size_t ct_loop_filter_freedoms(struct ct_assembler *s)
{
    evaluate(s);
    return s->m->nu - (size_t)loop_rank(s, ct_data_tolerance);
}

void ct_loop_filter_warn(struct ct_assembler *s)
{
    const struct ct_evaluator *m = s->m;
    size_t worst = 0;
    evaluate(s);
    for (size_t i = 1; i < m->nrow; i++)
        if (s->fixed_row[i]
            && (!s->fixed_row[worst]
                || fabs(m->phi[i]) / m->row_size[i] > fabs(m->phi[worst]) / m->row_size[worst]))
            worst = i;
    const struct ct_row *row = &s->e->row[worst];
    const struct ct_model *model = s->e->build->model;
    ct_warning(
        s->ctx,
        row->joint < 0 ? (struct ct_mark){.file = model->file} : model->joint[row->joint].mark,
        0,
        "joints are redundant only within the digits of their positions: the loops are closed "
        "in the least-squares sense, and '%s' stays open by %.2g%s; the component of the "
        "constraints that is independent of the others is left out",
        row->name, fabs(m->phi[worst]), row->is_length ? " m" : "");
}
