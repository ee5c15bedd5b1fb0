// See embed.h.
#include "solve/embed.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

// A row counts as dependent when what is left of it is this small against the largest: the
// constraints of a closed mechanism are known to about 1e-12 after projection.
static const double rank_tolerance = 1e-9;
// So many weak checks in a row ask for another order.
enum { MOST_WEAK = 3 };
// As long as the strength of the pivots is within this factor of what it was when they left a tenth of what is allowed, or less,
// they are checked after every fourth projection.
static const double same_strength = 1.25, well_below = 0.1;
enum { UNCHECKED = 3 };

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

static double largest(const double *v, size_t n)
{
    double max = 0;
    for (size_t i = 0; i < n; i++)
        max = fabs(v[i]) > max || isnan(v[i]) ? fabs(v[i]) : max;
    return max;
}

struct ct_embed *ct_embed_create(struct ct_arena *arena, struct ct_ctx *ctx,
                                 struct ct_machine *m)
{
    const size_t n = m->nu, r = m->nrow, k = larger(n, r) + 1;
    const size_t kk = m->e->has_dynamics || r ? k : 1; // else there is nothing to solve
    struct ct_embed *s = CT_NEW(arena, struct ct_embed);
    s->arena = arena;
    s->m = m;
    s->ctx = ctx;
    s->nearness = 1;
    s->row = CT_NEWN(arena, int, r + 1);
    s->dependent = CT_NEWN(arena, int, k);
    s->independent = CT_NEWN(arena, int, n + 1);
    s->is_unique = CT_NEWN(arena, bool, r + 1);
    s->a = CT_NEWN(arena, double, n + 1);
    s->lam = CT_NEWN(arena, double, r + 1);
    s->Jd = CT_NEWN(arena, double, r *r + 1);
    s->B = CT_NEWN(arena, double, r *kk + 1);
    s->S = CT_NEWN(arena, double, kk *kk);
    s->MB = CT_NEWN(arena, double, kk *kk);
    s->A = CT_NEWN(arena, double, r *kk + 1);
    s->q = CT_NEWN(arena, double, m->nq + 1);
    s->c = CT_NEWN(arena, double, k);
    s->r = CT_NEWN(arena, double, k);
    s->b = CT_NEWN(arena, double, k);
    s->d = CT_NEWN(arena, double, k);
    s->pivot = CT_NEWN(arena, int, k);
    s->iwork = CT_NEWN(arena, int, k);
    s->column = CT_NEWN(arena, int, k);
    const int size = (int)kk;
    const size_t for_qr = larger(ct_lstsq_work(size, size), ct_qr_pivot_work(size, size));
    s->work
        = CT_NEWN(arena, double, larger(for_qr, ct_symmetric_eigenvalues_work(size)) + 3 * k);
    return s;
}

// ---- closed forms ---------------------------------------------------------------------------------------

static struct ct_partition partition(const struct ct_embed *s)
{
    return (struct ct_partition){s->row, s->dependent, s->independent, (size_t)s->rank,
                                 s->m->nu - (size_t)s->rank};
}

// Operations of embedding by matrices, (6.2), for n speeds, r kept rows, f = n - r freedoms: LU of J_d, its
// solutions, products M B and B' M B, Cholesky of the reduced mass matrix.
double ct_embed_operations(const struct ct_embed *s)
{
    const double n = (double)s->m->nu, r = s->rank, f = n - r;
    const double lu = 2 * r * r * r / 3 + 2 * r * r * (f + 1);
    const double right = 2 * n * r + 2 * r * f;
    const double reduced = r > 0 ? 2 * n * r * f + r * f * (f + 1) : 0;
    return lu + right + reduced + f * f * f / 3 + 2 * f * f + 2 * r * f;
}

// form[i] comes first, the others move behind it.
static void put_first(struct ct_embed *s, size_t i)
{
    struct ct_form *f = s->form[i];
    memmove(s->form + 1, s->form, i * sizeof *s->form);
    s->form[0] = f;
}

// In the place of form[0], if that is for the rows and columns of now; the order of pivots is sought at the
// machine's input.
static void make_form(struct ct_embed *s)
{
    const struct ct_partition p = partition(s);
    if (s->has_form || s->nform == CT_MOST_FORMS) {
        put_first(s, s->has_form ? 0 : s->nform - 1);
        ct_form_destroy(s->m, s->form[0]);
        memmove(s->form, s->form + 1, --s->nform * sizeof *s->form);
    }
    ct_machine_motion(s->m);
    struct ct_form_costs costs = {0};
    struct ct_form *f = s->is_asked ? ct_form_ask(s->arena, s->m, &p, s->kind)
                                    : ct_form_create(s->arena, s->m, &p, ct_embed_operations(s),
                                                     s->kind, &costs);
    if (s->nmade == 0 && !s->is_asked)
        s->costs = costs;
    s->solves.reordered += s->nmade++ > 0;
    s->has_form = f != NULL;
    if (f) {
        s->kind = f->kind;
        s->form[s->nform] = f;
        put_first(s, s->nform++);
    }
}

// Projections to wait for with weak pivots, or without a form, until one is made: more and more, so that a motion
// that changes its rows and columns all the time does not spend its time on forms.
static long patience(const struct ct_embed *s)
{
    const long doublings = s->nmade / CT_MOST_FORMS;
    return 1L << (doublings < 16 ? doublings : 16);
}

static void forget_strength(struct ct_embed *s)
{
    s->nweak = s->nunchecked = 0;
    s->strength.at_sigma = 0;
    s->strength.is_alike = false;
}

// The form for the rows and columns of now: one from before, or a new one.
static void take_form(struct ct_embed *s)
{
    const struct ct_partition p = partition(s);
    size_t i = 0;
    s->has_form = s->is_rough = false;
    forget_strength(s);
    if (!s->m->nrow || s->is_dear)
        return;
    while (i < s->nform && !ct_form_is_for(s->form[i], &p))
        i++;
    if (i < s->nform) {
        s->has_form = true;
        put_first(s, i);
    } else if (patience(s) == 1) {
        make_form(s);
        s->is_dear = s->nmade == 1 && !s->has_form;
    }
}

void ct_embed_stay_dense(struct ct_embed *s)
{
    s->is_dear = true;
    s->has_form = false;
}

void ct_embed_use(struct ct_embed *s, const struct ct_form_kind *kind)
{
    s->kind = kind;
    s->is_asked = kind != NULL;
    if (!kind)
        ct_embed_stay_dense(s);
}

static bool is_sound(const struct ct_embed *s)
{
    double low, high;
    ct_strength_range(&s->strength, &low, &high);
    return s->strength.now > low && s->strength.now < high;
}

// Can the form of now be tried? Beside singular positions only where it tells how near they are.
static bool is_form_due(const struct ct_embed *s)
{
    return s->has_form && s->nweak == 0 && (s->strength.is_alike || !s->is_delicate);
}

static void follow_sigma(struct ct_embed *s)
{
    if (s->strength.is_alike)
        s->sigma = ct_strength_sigma(&s->strength);
}

// u' by the form of now; false if its pivots are not sound here.
static bool solve_form(struct ct_embed *s)
{
    struct ct_form *f = s->form[0];
    s->strength.now = ct_form_solve(f, s->m, s->a);
    if (!is_sound(s))
        return false;
    follow_sigma(s);
    s->solves.fixed++;
    if (!s->is_rough)
        return true;
    ct_form_check(f, s->m);
    s->solves.refined++;
    memcpy(s->a, f->a, s->m->nu * sizeof *s->a);
    return f->left_better <= ct_left_most;
}

enum ct_eval ct_embed_solve(struct ct_embed *s)
{
    struct ct_machine *m = s->m;
    if (ct_machine_solved(m, s->a))
        return CT_EVAL_OK;
    const bool is_tried = is_form_due(s);
    if (is_tried && solve_form(s))
        return CT_EVAL_OK;
    ct_machine_motion(m);
    s->solves.pivoted++;
    const enum ct_eval e = ct_embed_accelerate(s);
    if (s->has_form && !is_tried)
        s->strength.now = ct_form_close(s->form[0], m);
    if (s->has_form)
        ct_strength_compare(&s->strength, s->sigma);
    return e;
}

// After a projection, at the machine's input: are the pivots still in a good order?
static void check_form(struct ct_embed *s)
{
    struct ct_form *f = s->form[0];
    if (s->nunchecked > 0 && ct_is_within(s->strength.now / s->checked_at, same_strength)) {
        s->nunchecked--;
        return;
    }
    ct_form_check(f, s->m);
    s->is_rough = f->left > ct_left_plain;
    s->nunchecked = f->left <= well_below * ct_left_plain ? UNCHECKED : 0;
    s->checked_at = s->strength.now;
    if (s->strength.now > ct_form_weakest && f->left_better <= ct_left_most) {
        s->kappa = isnan(f->kappa) ? s->kappa : f->kappa;
        s->nweak = 0;
    } else if (++s->nweak >= MOST_WEAK * patience(s)) {
        make_form(s);
        forget_strength(s);
    }
}

static void tend_form(struct ct_embed *s)
{
    if (!s->m->nrow || s->is_dear || (s->is_delicate && !s->strength.is_alike))
        return;
    if (s->has_form)
        check_form(s);
    else if (++s->nweak >= patience(s)) {
        make_form(s);
        forget_strength(s);
    }
}

// ---- choice of rows and columns -----------------------------------------------------------------------

static double *J_at(const struct ct_embed *s, int row, int column)
{
    return &s->m->J[(size_t)row + s->m->nrow * (size_t)column];
}

// Rows of J, the best first, into s->row; the number of independent ones.
static int order_rows(struct ct_embed *s)
{
    const int n = (int)s->m->nu, m = (int)s->m->nrow;
    for (int i = 0; i < m; i++) // A = J', n x m
        for (int j = 0; j < n; j++)
            s->A[j + n * i] = *J_at(s, i, j);
    return ct_qr_pivot(s->A, s->row, s->b, n, m, n, rank_tolerance, s->work);
}

// Columns count by what their speeds move, w (nu, out), where inertias are so different that a heavy dependent speed would
// leave rounding of its forces, eps M_heavy, in the equations of light ones; else all alike. Elastic coordinates are always
// light, and do not ask for it.
static void weigh_columns(struct ct_embed *s, double *w)
{
    const double apart = 1e6; // leaves light ones ten digits
    const size_t n = s->m->nu;
    double least = INFINITY, most = 0;
    for (size_t j = 0; j < n; j++) {
        const double inertia = s->m->e->u[j].beam > 0 ? 0 : s->m->M[j + n * j];
        least = inertia > 0 ? fmin(least, inertia) : least;
        most = fmax(most, inertia);
        w[j] = 1;
    }
    for (size_t j = 0; j < n && most > apart * least; j++)
        w[j] = 1 / sqrt(fmax(s->m->M[j + n * j], least));
}

static void choose_columns(struct ct_embed *s)
{
    const int n = (int)s->m->nu, r = s->rank;
    ct_machine_motion(s->m);
    weigh_columns(s, s->d);
    for (int i = 0; i < r; i++)
        for (int j = 0; j < n; j++)
            s->A[i + r * j] = s->d[j] * *J_at(s, s->row[i], j);
    ct_qr_pivot(s->A, s->column, s->b, r, n, r, 0, s->work);
    for (int j = 0; j < n; j++)
        *(j < r ? &s->dependent[j] : &s->independent[j - r]) = s->column[j];
}

// LU of J_d and B = -J_d^-1 J_i (rank x free); false if J_d is singular.
static bool factor(struct ct_embed *s)
{
    const int r = s->rank, f = (int)s->m->nu - r;
    s->factorizations++;
    for (int j = 0; j < r; j++)
        for (int i = 0; i < r; i++)
            s->Jd[i + r * j] = *J_at(s, s->row[i], s->dependent[j]);
    if (!ct_lu(s->Jd, s->pivot, r, r))
        return false;
    for (int j = 0; j < f; j++)
        for (int i = 0; i < r; i++)
            s->B[i + r * j] = -*J_at(s, s->row[i], s->independent[j]);
    if (f)
        ct_lu_solve(s->B, s->Jd, s->pivot, r, r, f, r, false);
    s->kappa = 0;
    for (int i = 0; i < r * f; i++)
        s->kappa = fmax(s->kappa, fabs(s->B[i]));
    double least = INFINITY, most = 0;
    for (int i = 0; i < r; i++) {
        least = fmin(least, fabs(s->Jd[i + r * i]));
        most = fmax(most, fabs(s->Jd[i + r * i]));
    }
    s->sigma = most > 0 ? least / most : 0;
    s->largest = most;
    return isfinite(s->kappa);
}

// The speed with the smallest diagonal entry of M.
static size_t lightest(const struct ct_embed *s)
{
    const size_t n = s->m->nu;
    size_t least = 0;
    for (size_t i = 1; i < n; i++)
        if (s->m->M[i + n * i] < s->m->M[least + n * least])
            least = i;
    return least;
}

// What gives sections an inertia.
static const char *rotary_of(const struct ct_beam *beam)
{
    return beam->is_lumped ? "values of 'rotary_inertia', which lumped mass has not by itself"
                           : "a 'rotary_inertia'";
}

static bool massless(struct ct_embed *s, size_t speed)
{
    const struct ct_u *u = &s->m->e->u[speed];
    const struct ct_model *model = s->m->model;
    const char *name = u->q >= 0 ? s->m->e->q[u->q].name : u->name;
    const int bare = s->m->e->bare_beam;
    if (bare)
        return ct_error(
            s->ctx, model->body[bare].instance.mark, CT_E_MASSLESS,
            "coordinate '%s' moves no mass: the first section of beam '%s' has no inertia; "
            "give the beam %s, or, if no moment acts on that section, 'frame: chord'",
            name, model->body[bare].instance.name, rotary_of(model->body[bare].beam));
    if (u->beam > 0 && !(ct_model_number(model, model->body[u->beam].mass) > 0))
        return ct_error(s->ctx, model->body[u->beam].instance.mark, CT_E_MASSLESS,
                        "coordinate '%s' moves no mass: beam '%s' has none; give it a density, "
                        "a mass_per_length, or 'deformation: []'",
                        name, model->body[u->beam].instance.name);
    if (u->beam > 0)
        return ct_error(s->ctx, model->body[u->beam].instance.mark, CT_E_MASSLESS,
                        "coordinate '%s' moves no mass: give the beam %s, or consistent mass",
                        name, rotary_of(model->body[u->beam].beam));
    const struct ct_mark mark
        = u->joint >= 0 ? model->joint[u->joint].mark : model->body[u->body].instance.mark;
    return ct_error(s->ctx, mark, CT_E_MASSLESS,
                    "coordinate '%s' moves no mass: give a mass or an inertia to what it moves",
                    name);
}

// The speed of the joint that turns a beam's first section where that has no inertia: an axis that bends leaves it next to
// none, with which no step is right.
static size_t bare_speed(const struct ct_embed *s)
{
    const struct ct_equations *e = s->m->e;
    for (size_t k = 0; k < e->nu; k++)
        if (e->u[k].joint == e->bare_joint)
            return k;
    return lightest(s);
}

// The pivots of a solution in closed form must be positive. Behind one that is not, others are no numbers.
static bool has_inertia(struct ct_embed *s)
{
    const size_t n = s->m->nu;
    const double *pivot = s->m->solved.out + n + s->m->nq;
    size_t least = 0;
    ct_program_run(&s->m->solved, s->m->input);
    for (size_t i = 1; i < n; i++)
        if (isnan(pivot[least]) || fabs(pivot[i]) < fabs(pivot[least]))
            least = i;
    for (size_t i = 0; i < n; i++)
        if (!(pivot[i] > 0))
            return massless(s, pivot[least] > 0 ? i : least);
    return true;
}

// Dense factors of larger systems cost more than a step does.
static bool is_large(const struct ct_embed *s)
{
    enum { LARGE = 200 };
    return s->rank >= LARGE;
}

// Time in which a coordinate has moved by `way` along the motion of now, the first one; 0 at rest.
static double time_ahead(const struct ct_embed *s, double way)
{
    const double u = largest(s->m->input + s->m->at_u, s->m->nu), a = largest(s->a, s->m->nu);
    return u > 0 || a > 0 ? 2 * way / (u + sqrt(u * u + 2 * way * a)) : 0;
}

// Rows and columns chosen by what they are ahead on the motion, with u' as found last; the machine's input stays.
static void choose_there(struct ct_embed *s)
{
    const double way
        = 0.3; // [rad or m]: far enough to tell them apart, near enough to be known
    struct ct_machine *m = s->m;
    double *q = m->input + m->at_q;
    const double *u = m->input + m->at_u, h = time_ahead(s, way);
    for (size_t k = 0; k < m->nu; k++)
        s->r[k] = h * (u[k] + h / 2 * s->a[k]);
    memcpy(s->q, q, m->nq * sizeof *q);
    ct_machine_retract(m, q, s->r);
    ct_machine_constraint(m);
    order_rows(s);
    choose_columns(s);
    memcpy(q, s->q, m->nq * sizeof *q);
    ct_machine_constraint(m);
}

static bool choose_here(struct ct_embed *s)
{
    s->rank = order_rows(s);
    choose_columns(s);
    return factor(s);
}

// In a symmetric position, where many motions begin, several choices are equally good, and only further on some of them
// fail. Where the choice ahead is nearly as good here it is taken: another one costs more than many steps.
static bool choose_ahead(struct ct_embed *s)
{
    const double nearly = 0.5;
    if (!choose_here(s) || is_large(s) || s->rank == (int)s->m->nu || s->m->e->solution)
        return true;
    const double sigma = s->sigma, kappa = s->kappa;
    ct_machine_motion(s->m);
    if (ct_embed_accelerate(s) != CT_EVAL_OK)
        return false;
    choose_there(s);
    return (factor(s) && s->sigma >= nearly * sigma && nearly * s->kappa <= kappa)
        || choose_here(s);
}

// After ct_embed_accelerate: the first independent speed whose pivot of B' M B is rounding of what it is left of; -1: none.
static int rounded_pivot(const struct ct_embed *s)
{
    const int n = (int)s->m->nu, r = s->rank, f = n - r;
    for (int i = 0; i < f; i++) {
        double gross = fabs(s->MB[s->independent[i] + n * i]);
        for (int k = 0; k < r; k++)
            gross += fabs(s->B[k + r * i] * s->MB[s->dependent[k] + n * i]);
        const double pivot = s->S[i + f * i] * s->S[i + f * i];
        if (pivot <= 16 * DBL_EPSILON * gross)
            return s->independent[i];
    }
    return -1;
}

bool ct_embed_choose(struct ct_embed *s)
{
    s->switches++;
    s->rank = 0;
    for (int j = 0; j < (int)s->m->nu; j++)
        s->independent[j] = j;
    if (!s->m->nrow)
        factor(s);
    else if (!choose_ahead(s))
        return massless(s, lightest(s));
    s->kappa_chosen = s->kappa;
    s->sigma_chosen = s->sigma;
    if (s->m->e->bare_beam)
        return massless(s, bare_speed(s));
    if (s->m->e->solution)
        return has_inertia(s);
    ct_machine_motion(s->m);
    if (ct_embed_accelerate(s) != CT_EVAL_OK)
        return massless(s, lightest(s));
    const int rounded = rounded_pivot(s);
    if (rounded >= 0)
        return massless(s, (size_t)rounded);
    take_form(s);
    return true;
}

// ---- accelerations --------------------------------------------------------------------------------------

// S (free x free) = B' M B with the unit columns of the independent speeds.
static void reduce_mass(struct ct_embed *s, const double *M)
{
    const int n = (int)s->m->nu, r = s->rank, f = n - r;
    for (int j = 0; j < f; j++) // MB = M [B; 1], n x f
        for (int i = 0; i < n; i++) {
            double sum = M[i + n * s->independent[j]];
            for (int k = 0; k < r; k++)
                sum += M[i + n * s->dependent[k]] * s->B[k + r * j];
            s->MB[i + n * j] = sum;
        }
    for (int j = 0; j < f; j++)
        for (int i = j; i < f; i++) {
            double sum = s->MB[s->independent[i] + n * j];
            for (int k = 0; k < r; k++)
                sum += s->B[k + r * i] * s->MB[s->dependent[k] + n * j];
            s->S[i + f * j] = sum;
        }
}

// b (free) = B' v for v (nu).
static void reduce_force(struct ct_embed *s, double *b, const double *v)
{
    const int r = s->rank, f = (int)s->m->nu - r;
    for (int i = 0; i < f; i++) {
        b[i] = v[s->independent[i]];
        for (int k = 0; k < r; k++)
            b[i] += s->B[k + r * i] * v[s->dependent[k]];
    }
}

// x (nu) = [B; 1] z + [c; 0].
static void expand(const struct ct_embed *s, double *x, const double *z, const double *c)
{
    const int r = s->rank, f = (int)s->m->nu - r;
    for (int i = 0; i < f; i++)
        x[s->independent[i]] = z[i];
    for (int k = 0; k < r; k++) {
        double sum = c[k];
        for (int i = 0; i < f; i++)
            sum += s->B[k + r * i] * z[i];
        x[s->dependent[k]] = sum;
    }
}

// x (nu) = [B; 1] (B' M B)^-1 B' r + [c; 0] by the numbers of now.
static enum ct_eval reduce_and_expand(struct ct_embed *s, const double *M, double *x)
{
    const int f = (int)s->m->nu - s->rank;
    reduce_mass(s, M);
    reduce_force(s, s->b, s->r);
    if (f && !ct_cholesky(s->S, f, f))
        return CT_EVAL_RETRY;
    if (f)
        ct_cholesky_solve(s->b, s->S, f, f, 1, f);
    expand(s, x, s->b, s->c);
    return CT_EVAL_OK;
}

enum ct_eval ct_embed_accelerate(struct ct_embed *s)
{
    const int n = (int)s->m->nu, r = s->rank;
    if (r && !factor(s))
        return CT_EVAL_RETRY;
    for (int k = 0; k < r; k++)
        s->c[k] = -s->m->gam[s->row[k]];
    if (r)
        ct_lu_solve(s->c, s->Jd, s->pivot, r, r, 1, r, false);
    for (int i = 0; i < n; i++) { // Q - M c
        s->r[i] = s->m->Q[i];
        for (int k = 0; k < r; k++)
            s->r[i] -= s->m->M[i + n * s->dependent[k]] * s->c[k];
    }
    return reduce_and_expand(s, s->m->M, s->a);
}

// Multipliers of all rows by the form of now, where they are unique.
static bool form_multipliers(struct ct_embed *s)
{
    struct ct_form *f = s->form[0];
    if (!is_form_due(s) || s->rank < (int)s->m->nrow || !is_sound(s))
        return false;
    ct_form_check(f, s->m);
    memcpy(s->lam, f->lam, s->m->nrow * sizeof *s->lam); // all rows are kept, in their order
    return f->left_better <= ct_left_most;
}

void ct_embed_multipliers(struct ct_embed *s)
{
    const int n = (int)s->m->nu, m = (int)s->m->nrow, ld = n > m ? n : m;
    if (!m || form_multipliers(s))
        return;
    ct_machine_motion(s->m);
    for (int i = 0; i < m; i++)
        for (int j = 0; j < n; j++)
            s->A[j + n * i] = *J_at(s, i, j);
    memset(s->d, 0, (size_t)ld * sizeof *s->d);
    for (int i = 0; i < n; i++) {
        s->d[i] = -s->m->Q[i];
        for (int j = 0; j < n; j++)
            s->d[i] += s->m->M[i + n * j] * s->a[j];
    }
    ct_lstsq(s->d, s->A, n, m, n, rank_tolerance, s->iwork, s->work);
    memcpy(s->lam, s->d, (size_t)m * sizeof *s->lam);
}

void ct_embed_kept_multipliers(struct ct_embed *s, double *lam)
{
    const int n = (int)s->m->nu, r = s->rank;
    for (int i = 0; i < r; i++) {
        const int d = s->dependent[i];
        lam[i] = -s->m->Q[d];
        for (int j = 0; j < n; j++)
            lam[i] += s->m->M[d + n * j] * s->a[j];
    }
    if (r)
        ct_lu_solve(lam, s->Jd, s->pivot, r, r, 1, r, true);
}

void ct_embed_null_vector(struct ct_embed *s, int row, double *z)
{
    // the least-squares solution of J' x = J' e_row is e_row without its part in null(J')
    const int n = (int)s->m->nu, m = (int)s->m->nrow, ld = n > m ? n : m;
    for (int i = 0; i < m; i++)
        for (int j = 0; j < n; j++)
            s->A[j + n * i] = *J_at(s, i, j);
    memset(s->d, 0, (size_t)ld * sizeof *s->d);
    for (int j = 0; j < n; j++)
        s->d[j] = *J_at(s, row, j);
    ct_lstsq(s->d, s->A, n, m, n, rank_tolerance, s->iwork, s->work);
    for (int i = 0; i < m; i++)
        z[i] = (i == row) - s->d[i];
}

void ct_embed_uniqueness(struct ct_embed *s)
{
    const double unique_tolerance = 1e-6; // the entry is 0 to rounding or of order one
    for (int k = 0; k < (int)s->m->nrow; k++) {
        ct_embed_null_vector(s, k, s->r);
        s->is_unique[k] = fabs(s->r[k]) < unique_tolerance;
    }
}

enum ct_eval ct_embed_land(struct ct_embed *s, const double *W, const double *w, double *u)
{
    // with u+ = [B; 1] z + [c; 0]: B' W B z = B' (w - W c)
    const int n = (int)s->m->nu, r = s->rank;
    ct_machine_constraint(s->m);
    if (r && !factor(s))
        return CT_EVAL_RETRY;
    for (int k = 0; k < r; k++) { // J_d c = -Phi_t = -(v - J u), u as the machine has it
        double driven = s->m->v[s->row[k]];
        for (int j = 0; j < n; j++)
            driven -= *J_at(s, s->row[k], j) * s->m->input[s->m->at_u + j];
        s->c[k] = -driven;
    }
    if (r)
        ct_lu_solve(s->c, s->Jd, s->pivot, r, r, 1, r, false);
    for (int i = 0; i < n; i++) {
        s->r[i] = w[i];
        for (int k = 0; k < r; k++)
            s->r[i] -= W[i + n * s->dependent[k]] * s->c[k];
    }
    return reduce_and_expand(s, W, u);
}

// ---- projection -------------------------------------------------------------------------------------------

// d (nu) = -J+ r: least norm, all rows.
static void least_norm_step(struct ct_embed *s, const double *r, double *d)
{
    const int n = (int)s->m->nu, m = (int)s->m->nrow;
    memcpy(s->A, s->m->J, (size_t)(n * m) * sizeof *s->A);
    memset(s->d, 0, larger((size_t)n, (size_t)m) * sizeof *s->d);
    for (int i = 0; i < m; i++)
        s->d[i] = -r[i];
    ct_lstsq(s->d, s->A, m, n, m, rank_tolerance, s->iwork, s->work);
    memcpy(d, s->d, (size_t)n * sizeof *d);
}

// d (nu) = correction of the dependent part alone, J_d as factored last.
static void partitioned_step(struct ct_embed *s, const double *r, double *d)
{
    const int k = s->rank;
    memset(d, 0, s->m->nu * sizeof *d);
    for (int i = 0; i < k; i++)
        s->c[i] = -r[s->row[i]];
    ct_lu_solve(s->c, s->Jd, s->pivot, k, k, 1, k, false);
    for (int i = 0; i < k; i++)
        d[s->dependent[i]] = s->c[i];
}

// False if J_d is too close to singular for partitioned steps.
static bool is_partitioned(struct ct_embed *s)
{
    return factor(s) && s->kappa <= ct_kappa_largest;
}

// r (nrow) += J d.
static void add_change(const struct ct_embed *s, double *r, const double *d)
{
    for (size_t j = 0; j < s->m->nu; j++)
        for (size_t i = 0; i < s->m->nrow && d[j] != 0; i++)
            r[i] += s->m->J[i + s->m->nrow * j] * d[j];
}

// Is another choice of rows or columns due?
static bool has_worn(const struct ct_embed *s)
{
    if (!s->rank)
        return false;
    return ct_has_worn(s->kappa, s->kappa_chosen, s->sigma, s->sigma_chosen,
                       s->rank < (int)s->m->nrow);
}

// With a single row sigma is 1 everywhere.
static double nearness(const struct ct_embed *s)
{
    return fmin(s->sigma, s->nearness);
}

static enum ct_eval project_by_matrices(struct ct_embed *s, double t, double *y)
{
    struct ct_machine *m = s->m;
    double before = INFINITY;
    for (int i = 0;; i++) {
        ct_machine_set(m, t, y);
        ct_machine_constraint(m);
        const double size = largest(m->phi, m->nrow);
        if (ct_is_closed(nearness(s), size, before))
            break;
        if (ct_is_stray(i, size, before))
            return CT_EVAL_RETRY;
        before = size;
        (is_partitioned(s) ? partitioned_step : least_norm_step)(s, m->phi, s->r);
        ct_machine_retract(m, y, s->r);
    }
    const bool is_regular = is_partitioned(s);
    for (int i = 0; i < 2; i++) { // v is linear in u; the second step takes off rounding
        (is_regular ? partitioned_step : least_norm_step)(s, m->v, s->r);
        for (size_t k = 0; k < m->nu; k++)
            y[m->nq + k] += s->r[k];
        add_change(s, m->v, s->r);
    }
    ct_machine_set(m, t, y);
    return CT_EVAL_OK;
}

static void change_speeds(const struct ct_machine *m, double *y, const double *du)
{
    for (size_t k = 0; k < m->nu; k++)
        y[m->nq + k] += du[k];
}

static bool close_form(struct ct_embed *s, double t, const double *y)
{
    ct_machine_set(s->m, t, y);
    s->strength.now = ct_form_close(s->form[0], s->m);
    if (!is_sound(s))
        return false;
    follow_sigma(s);
    return true;
}

// The same by the form of now; *is_done is false where its pivots are not sound.
static enum ct_eval project_by_form(struct ct_embed *s, double t, double *y, bool *is_done)
{
    struct ct_machine *m = s->m;
    const struct ct_form *f = s->form[0];
    double before = INFINITY;
    *is_done = false;
    if (s->kappa > ct_kappa_largest)
        return CT_EVAL_OK;
    for (int i = 0; close_form(s, t, y); i++) {
        const double size = largest(f->phi, m->nrow);
        if (!ct_is_closed(nearness(s), size, before)) {
            if (ct_is_stray(i, size, before))
                return CT_EVAL_RETRY;
            before = size;
            ct_machine_retract(m, y, f->dq);
            continue;
        }
        const bool is_rough = largest(f->du, m->nu) > ct_small_change;
        change_speeds(m, y, f->du);
        *is_done = !is_rough || close_form(s, t, y);
        if (is_rough)
            change_speeds(m, y, f->du);
        ct_machine_set(m, t, y);
        return CT_EVAL_OK;
    }
    return CT_EVAL_OK;
}

enum ct_eval ct_embed_project(struct ct_embed *s, double t, double *y)
{
    bool is_done = false;
    ct_machine_normalise(s->m, y);
    if (!s->m->nrow)
        return CT_EVAL_OK;
    enum ct_eval e = is_form_due(s) ? project_by_form(s, t, y, &is_done) : CT_EVAL_OK;
    if (e == CT_EVAL_OK && !is_done) {
        e = project_by_matrices(s, t, y);
        if (s->has_form) { // sigma has just been found
            s->strength.now = ct_form_close(s->form[0], s->m);
            ct_strength_compare(&s->strength, s->sigma);
        }
    }
    if (e != CT_EVAL_OK || s->is_crossing)
        return e;
    tend_form(s);
    if (has_worn(s)) {
        ct_machine_constraint(s->m); // forms leave J as it was
        ct_embed_choose(s);
    }
    return CT_EVAL_OK;
}

static bool find_strength(struct ct_embed *s)
{
    if (!is_large(s) || !is_form_due(s))
        return false;
    s->strength.now = ct_form_close(s->form[0], s->m);
    s->sigma = ct_strength_sigma(&s->strength);
    return is_sound(s);
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
            for (size_t i = j; i < m && J[j] != 0; i++)
                A[i + m * j] += J[i] * J[j];
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
    return s->rank && !(has_redundant_rows(s) && is_large(s));
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
    const bool is_known = find_strength(s) || factor(s);
    const double pivot = is_known ? s->sigma * s->largest * fmax(1, s->kappa) : 0;
    s->sigma = sigma;
    s->kappa = kappa;
    s->strength.now = strength;
    return pivot;
}

bool ct_embed_dependence(struct ct_embed *s, double *x, double *log_det)
{
    const int r = s->rank;
    const double sigma = s->sigma, kappa = s->kappa;
    const bool is_found = !is_large(s) && factor(s);
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

void ct_embed_renew(struct ct_embed *s)
{
    if (is_form_due(s)) {
        s->strength.now = ct_form_close(s->form[0], s->m);
        tend_form(s);
    }
    if (!s->rank || !has_worn(s))
        return;
    ct_machine_constraint(s->m); // forms leave J as it was
    ct_embed_choose(s);
}
