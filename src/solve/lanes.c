// See lanes.h. The steps are those of integrate/driver.c, the accelerations and projections those of
// embed.c and simulate.c, formula by formula, so that a lane ends where a run alone ends, to rounding.
#include "solve/lanes.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { W = CT_LANES };

// One number of each lane; arenas align to 16 bytes only.
typedef double vec __attribute__((vector_size(W * sizeof(double)), aligned(8), may_alias));

typedef long long mask __attribute__((vector_size(W * sizeof(long long)), may_alias));

// Constants of step control, projection and choice of rows: those of driver.c, simulate.c, singular.c and embed.c.
static const double safety = 0.9, most_shrink = 0.2, most_growth = 5, remembered_error = 1e-4;
static const double stretch = 1.1, least_step = 16 * DBL_EPSILON, least_scale = 1e-6;
static const double singular_pivot = 0.25, singular_steps = 4;
static const double kappa_growth = 10, kappa_largest = 1e3, small_pivot = 0.1;
static const double position_tolerance = 1e-13, gained_below = 1e-10;
static const double least_change = 0.7, most_change = 1.5, weakest = 1e-3;
static const double left_plain = 1e-13, left_most = 1e-11;
// Where h times the rate of the fastest motions is beyond the first in so many steps, with fewer than so many others
// between, the run is stiff; values of the program DOPRI5 for the stage before the last.
static const double stiff_step = 3.25;
enum { MOST_STIFF = 15, FEW_OTHERS = 6 };
enum { MOST_NEWTON = 25, MOST_STEPS = 100000000 };

// A generated program for all lanes at once.
struct program {
    const struct ct_tape *tape;
    struct ct_native *native; // NULL: the tape is run
    vec *out;
    double *work;
    size_t nout;
};

// What belongs to one member and is not computed in lanes.
struct lane {
    enum ct_lane_state state;
    double t1; // end of the run
    double h;  // size the next step should have
    double error_before;
    bool was_refused;
    double end;   // time at the end of this try
    double error; // of it
    double kappa_chosen, sigma_chosen;
    double pivot_most, pivot_last, pivot_time; // see singular.h
    int *row, *dependent, *independent;        // as in embed.h
    long steps;
    bool is_watched; // for stiffness
    int nstiff, nother;
};

struct ct_lanes {
    const struct ct_equations *e;
    struct ct_run *run; // for what is done one by one
    struct ct_machine *m;
    struct ct_embed *embed;
    int nq, nu, nrow, ny, rank;
    bool is_solved, has_power, needs_lam, has_quaternion, is_used;
    bool
        is_uniform; // all lanes have chosen the same rows and columns: whole vectors move, not single numbers
    struct program motion, constraint, power, memory; // motion: u', q' themselves if is_solved
    struct lane lane[W];
    struct ct_lanes_count count;
    const struct ct_method *method;
    vec *input;
    // closed form for one choice of rows and columns (see form.h), or NULL
    const struct ct_form *form;
    struct ct_form_code code; // its programs
    struct program solved, checked, closing;
    bool fits[W];                    // the lane has made that choice
    bool is_rough[W];                // the last check found the form not good enough
    double strength[W], at_sigma[W]; // of the form, now and where sigma was found
    double t[W], h[W];               // of this try
    double kappa[W], sigma[W];       // of the factors, as in embed.h
    bool is_regular[W];              // the factors exist
    vec rtol, atol;                  // of the steps
    // states (ny), stages (ny x stages)
    vec *y, *dy, *y1, *dy1, *end, *dend, *stage, *point, *late, *third, *k;
    // matrices and vectors as in embed.h; Mp: M with rows and columns in the order dependent, independent
    vec *M, *Mp, *J, *Jd, *B, *MB, *S, *a, *c, *r, *b, *d, *lam;
    int *pivot;                              // (nrow x W)
    int *order, *from_row, *from_J, *from_M; // (nu, nrow, nrow nu, nu nu x W): see index_choice
    double *one_q; // a single lane's coordinates, step, state, derivative
    double *one_d, *one_y, *one_dy, *one_point;
};

// ---- programs ---------------------------------------------------------------------------------------

static bool is_native(const struct ct_lanes *s)
{
    return s->m->motion.native && ct_native_is_available(W);
}

static void make_program(struct ct_arena *a, const struct ct_lanes *s, struct program *p,
                         const struct ct_program *from)
{
    *p = (struct program){.nout = from->nout};
    if (!p->nout)
        return;
    const struct ct_listing *l = ct_listing_for_lanes(a, from->listing);
    p->tape = ct_tape_create(a, l);
    p->native = is_native(s) ? ct_native_create(a, l, W) : NULL;
    const size_t n = p->native ? ct_native_work(p->native) : W * ct_tape_work(p->tape);
    p->out = CT_NEWN(a, vec, p->nout);
    p->work = CT_NEWN(a, double, n + 1);
}

static void prepare(struct program *p, const vec *input)
{
    if (p->nout && p->native)
        ct_native_prepare(p->native, (const double *)input, p->work);
    else if (p->nout)
        ct_tape_prepare_lanes(p->tape, W, (const double *)input, p->work);
}

static void run_program(struct program *p, const vec *input)
{
    if (p->nout && p->native)
        ct_native_eval(p->native, (const double *)input, (double *)p->out, p->work);
    else if (p->nout)
        ct_tape_eval_lanes(p->tape, W, (const double *)input, (double *)p->out, p->work);
}

// ---- creation ---------------------------------------------------------------------------------------

const char *ct_lanes_refusal(const struct ct_equations *e, const struct ct_run_options *o)
{
    if (!o->method->tableau)
        return "the method is not an explicit one with step control";
    if (o->step > 0)
        return "the step is fixed";
    if (e->nmode)
        return "the model has switches";
    if (e->x->ntable)
        return "the model has tables";
    return NULL;
}

static void make_room(struct ct_arena *a, struct ct_lanes *s)
{
    const size_t n = (size_t)s->nu, r = (size_t)s->nrow, ny = (size_t)s->ny;
    const struct {
        vec **v;
        size_t n;
    } all[] = {{&s->input, s->m->ninput},
               {&s->y, ny},
               {&s->dy, ny},
               {&s->y1, ny},
               {&s->dy1, ny},
               {&s->end, ny},
               {&s->dend, ny},
               {&s->stage, ny},
               {&s->point, ny},
               {&s->late, ny},
               {&s->third, ny},
               {&s->M, n * n},
               {&s->Mp, n * n},
               {&s->J, r * n},
               {&s->Jd, r * r},
               {&s->B, r * n},
               {&s->MB, n * n},
               {&s->S, n * n},
               {&s->a, n},
               {&s->c, r},
               {&s->r, n},
               {&s->b, n},
               {&s->d, n + r},
               {&s->lam, n + r}};
    for (size_t i = 0; i < COUNT(all); i++)
        *all[i].v = CT_NEWN(a, vec, all[i].n + 1);
    s->k = CT_NEWN(a, vec, ny * CT_MOST_STAGES);
    s->pivot = CT_NEWN(a, int, W *(r + 1));
    s->order = CT_NEWN(a, int, W *(n + 1));
    s->from_row = CT_NEWN(a, int, W *(r + 1));
    s->from_J = CT_NEWN(a, int, W *(r * n + 1));
    s->from_M = CT_NEWN(a, int, W *(n * n + 1));
    double **const one[] = {&s->one_q, &s->one_d, &s->one_y, &s->one_dy, &s->one_point};
    for (size_t i = 0; i < COUNT(one); i++)
        *one[i] = CT_NEWN(a, double, ny + 1);
    for (int l = 0; l < W; l++) {
        s->lane[l].row = CT_NEWN(a, int, r + 1);
        s->lane[l].dependent = CT_NEWN(a, int, r + 1);
        s->lane[l].independent = CT_NEWN(a, int, n + 1);
    }
}

struct ct_lanes *ct_lanes_create(struct ct_arena *a, const struct ct_equations *e,
                                 struct ct_run *run)
{
    struct ct_lanes *s = CT_NEW(a, struct ct_lanes);
    struct ct_machine *m = ct_run_machine(run);
    *s = (struct ct_lanes){.e = e, .run = run, .m = m, .embed = ct_run_embed(run)};
    ct_embed_stay_dense(s->embed);
    s->nq = (int)m->nq;
    s->nu = (int)m->nu;
    s->nrow = (int)m->nrow;
    s->ny = s->nq + s->nu + 1;
    s->has_power = !ct_ex_is_zero(e->power);
    s->needs_lam = ct_ex_kinds(e->x, e->power) & 1u << CT_SYM_LAM;
    for (size_t i = 0; i < e->nq; i++)
        s->has_quaternion |= e->q[i].quaternion >= 0;
    s->is_solved = m->solved.nout > 0 && s->nrow == 0;
    make_program(a, s, &s->motion, s->is_solved ? &m->solved : &m->motion);
    make_program(a, s, &s->constraint, &m->constraint);
    make_program(a, s, &s->power, &m->power);
    make_program(a, s, &s->memory, &m->memory);
    make_room(a, s);
    return s;
}

void ct_lanes_unroll(struct ct_arena *a, struct ct_lanes *s)
{
    const struct ct_embed *embed = s->embed;
    const struct ct_partition p = {embed->row, embed->dependent, embed->independent,
                                   (size_t)embed->rank, s->m->nu - (size_t)embed->rank};
    if (!s->nrow || s->needs_lam)
        return; // multipliers come with the matrices
    ct_machine_set(s->m, 0, ct_run_state(s->run));
    ct_machine_motion(s->m);
    s->form = ct_form_create(a, s->m, &p, ct_embed_operations(embed), NULL);
    if (s->form)
        s->code = ct_form_code(s->form);
    if (!s->code.listing) { // a form of another kind is not for lanes
        s->form = NULL;
        return;
    }
    make_program(a, s, &s->solved, s->code.solved);
    make_program(a, s, &s->checked, s->code.checked);
    make_program(a, s, &s->closing, s->code.closing);
}

// ---- lanes and single numbers -----------------------------------------------------------------------

static void take_lane(double *out, const vec *v, int l, size_t n)
{
    for (size_t i = 0; i < n; i++)
        out[i] = v[i][l];
}

static void put_lane(vec *v, int l, const double *in, size_t n)
{
    for (size_t i = 0; i < n; i++)
        v[i][l] = in[i];
}

static bool any(const bool *is)
{
    bool found = false;
    for (int l = 0; l < W; l++)
        found |= is[l];
    return found;
}

static void give_up(struct ct_lanes *s, int l)
{
    s->lane[l].state = CT_LANE_GIVEN_UP;
}

// ---- small solves, all lanes at once ----------------------------------------------------------------

static void exchange(vec *a, vec *b, int l)
{
    const double keep = (*a)[l];
    (*a)[l] = (*b)[l];
    (*b)[l] = keep;
}

// LU with partial pivoting of A (n x n, in place); rows are exchanged lane by lane.
static void factor_lu(struct ct_lanes *s, vec *A, int n)
{
    for (int l = 0; l < W; l++)
        s->is_regular[l] = true;
    for (int k = 0; k < n; k++) {
        for (int l = 0; l < W; l++) {
            int p = k;
            for (int i = k + 1; i < n; i++)
                if (fabs(A[i + n * k][l]) > fabs(A[p + n * k][l]))
                    p = i;
            s->pivot[W * k + l] = p;
            for (int j = 0; j < n && p != k; j++)
                exchange(&A[k + n * j], &A[p + n * j], l);
            s->is_regular[l] &= A[k + n * k][l] != 0;
        }
        for (int i = k + 1; i < n; i++)
            A[i + n * k] /= A[k + n * k];
        for (int j = k + 1; j < n; j++)
            for (int i = k + 1; i < n; i++)
                A[i + n * j] -= A[i + n * k] * A[k + n * j];
    }
}

// x (n) <- A^-1 x with these factors.
static void solve_lu(const struct ct_lanes *s, vec *x, const vec *A, int n)
{
    for (int k = 0; k < n - 1; k++)
        for (int l = 0; l < W; l++)
            exchange(&x[k], &x[s->pivot[W * k + l]], l);
    for (int k = 0; k < n; k++)
        for (int i = k + 1; i < n; i++)
            x[i] -= A[i + n * k] * x[k];
    for (int k = n - 1; k >= 0; k--) {
        x[k] /= A[k + n * k];
        for (int i = 0; i < k; i++)
            x[i] -= A[i + n * k] * x[k];
    }
}

// x (n) <- A'^-1 x.
static void solve_lu_transposed(const struct ct_lanes *s, vec *x, const vec *A, int n)
{
    for (int k = 0; k < n; k++) {
        for (int i = 0; i < k; i++)
            x[k] -= A[i + n * k] * x[i];
        x[k] /= A[k + n * k];
    }
    for (int k = n - 1; k >= 0; k--)
        for (int i = k + 1; i < n; i++)
            x[k] -= A[i + n * k] * x[i];
    for (int k = n - 2; k >= 0; k--)
        for (int l = 0; l < W; l++)
            exchange(&x[k], &x[s->pivot[W * k + l]], l);
}

// x (n) <- S^-1 x by Cholesky, S (lower, in place). Where S is not positive definite x is not finite.
static void solve_cholesky(vec *x, vec *S, int n)
{
    for (int k = 0; k < n; k++) {
        for (int l = 0; l < W; l++)
            S[k + n * k][l] = sqrt(S[k + n * k][l]);
        for (int i = k + 1; i < n; i++)
            S[i + n * k] /= S[k + n * k];
        for (int j = k + 1; j < n; j++)
            for (int i = j; i < n; i++)
                S[i + n * j] -= S[i + n * k] * S[j + n * k];
    }
    for (int k = 0; k < n; k++) {
        x[k] /= S[k + n * k];
        for (int i = k + 1; i < n; i++)
            x[i] -= S[i + n * k] * x[k];
    }
    for (int k = n - 1; k >= 0; k--) {
        for (int i = k + 1; i < n; i++)
            x[k] -= S[i + n * k] * x[i];
        x[k] /= S[k + n * k];
    }
}

// ---- embedding, as in embed.c -----------------------------------------------------------------------

static void scatter_J(struct ct_lanes *s, const vec *value)
{
    const struct ct_equations *e = s->e;
    for (size_t i = 0; i < e->nJ; i++)
        s->J[e->J[i].row + s->nrow * e->J[i].column] = value[i];
}

// to (n) = from, each lane from places of its own: index (n x W).
static void pick(const struct ct_lanes *s, vec *to, const vec *from, const int *index, int n)
{
    for (int i = 0; i < n; i++, index += W) {
        to[i] = from[index[0]];
        for (int l = 1; l < W && !s->is_uniform; l++)
            to[i][l] = from[index[l]][l];
    }
}

// a = max(a, |v|), number by number; what is no number in v does not count.
static void raise(vec *a, const vec *v)
{
    const mask is_negative = *v < 0;
    const vec size = (vec)(((mask) - *v & is_negative) | ((mask)*v & ~is_negative));
    const mask is = size > *a;
    *a = (vec)(((mask)size & is) | ((mask)*a & ~is));
}

// a = min(a, |v|).
static void lower(vec *a, const vec *v)
{
    vec size = {0};
    raise(&size, v);
    const mask is = size < *a;
    *a = (vec)(((mask)size & is) | ((mask)*a & ~is));
}

// LU of J_d and B = -J_d^-1 J_i; kappa and sigma of the lanes asked for.
static void factor(struct ct_lanes *s, const bool *wanted)
{
    const int r = s->rank, f = s->nu - r;
    if (!r)
        return;
    pick(s, s->Jd, s->J, s->from_J, r * r);
    pick(s, s->B, s->J, s->from_J + W * r * r, r * f);
    for (int i = 0; i < r * f; i++)
        s->B[i] = -s->B[i];
    factor_lu(s, s->Jd, r);
    for (int j = 0; j < f; j++)
        solve_lu(s, s->B + r * j, s->Jd, r);
    vec kappa = {0}, most = {0}, least;
    for (int i = 0; i < r * f; i++)
        raise(&kappa, &s->B[i]);
    for (int i = 0; i < r; i++)
        raise(&most, &s->Jd[i + r * i]);
    least = most;
    for (int i = 0; i < r; i++)
        lower(&least, &s->Jd[i + r * i]);
    for (int l = 0; l < W; l++)
        if (wanted[l]) {
            s->kappa[l] = kappa[l];
            s->sigma[l] = most[l] > 0 ? least[l] / most[l] : 0;
            s->is_regular[l] &= isfinite(kappa[l]) != 0;
        }
}

// S (free x free, lower) = [B; 1]' Mp [B; 1], b (free) = [B; 1]' r.
static void reduce(struct ct_lanes *s)
{
    const int n = s->nu, r = s->rank, f = n - r;
    const vec *M = s->Mp;
    for (int j = 0; j < f; j++)
        for (int i = 0; i < n; i++) {
            vec sum = M[i + n * (r + j)];
            for (int k = 0; k < r; k++)
                sum += M[i + n * k] * s->B[k + r * j];
            s->MB[i + n * j] = sum;
        }
    for (int j = 0; j < f; j++) {
        for (int i = j; i < f; i++) {
            vec sum = s->MB[r + i + n * j];
            for (int k = 0; k < r; k++)
                sum += s->B[k + r * i] * s->MB[k + n * j];
            s->S[i + f * j] = sum;
        }
        s->b[j] = s->r[r + j];
        for (int k = 0; k < r; k++)
            s->b[j] += s->B[k + r * j] * s->r[k];
    }
}

// M, Q (into r), -gam (into c) in the order dependent, independent.
static void permute(struct ct_lanes *s, const vec *Q, const vec *gam)
{
    pick(s, s->Mp, s->M, s->from_M, s->nu * s->nu);
    pick(s, s->r, Q, s->order, s->nu);
    pick(s, s->c, gam, s->from_row, s->rank);
    for (int k = 0; k < s->rank; k++)
        s->c[k] = -s->c[k];
}

// u' into a from M, J and the program's Q, gam: (6.2). Where it does not exist it is not finite.
static void accelerate(struct ct_lanes *s, const vec *Q, const vec *gam, const bool *wanted)
{
    const int n = s->nu, r = s->rank, f = n - r;
    factor(s, wanted);
    permute(s, Q, gam);
    if (r)
        solve_lu(s, s->c, s->Jd, r);
    for (int i = 0; i < n; i++)
        for (int k = 0; k < r; k++)
            s->r[i] -= s->Mp[i + n * k] * s->c[k];
    reduce(s);
    solve_cholesky(s->b, s->S, f);
    for (int k = 0; k < r; k++) {
        s->d[k] = s->c[k];
        for (int i = 0; i < f; i++)
            s->d[k] += s->B[k + r * i] * s->b[i];
    }
    for (int i = 0; i < f; i++)
        s->d[r + i] = s->b[i];
    for (int i = 0; i < n; i++)
        if (s->is_uniform)
            s->a[s->order[W * i]] = s->d[i];
        else
            for (int l = 0; l < W; l++)
                s->a[s->order[W * i + l]][l] = s->d[i][l];
}

// Multipliers of the kept rows into the input: J_d' lam = (M u' - Q)_d. All rows are kept (see ct_lanes_load).
static void multipliers(struct ct_lanes *s, const vec *Q)
{
    const int n = s->nu, r = s->rank;
    pick(s, s->lam, Q, s->order, r);
    for (int i = 0; i < r; i++) {
        s->lam[i] = -s->lam[i];
        for (int j = 0; j < n; j++)
            s->lam[i] += s->Mp[i + n * j] * s->d[j];
    }
    solve_lu_transposed(s, s->lam, s->Jd, r);
    for (int i = 0; i < r; i++)
        for (int l = 0; l < W; l++)
            s->input[s->m->at_lam + (size_t)s->lane[l].row[i]][l] = s->lam[i][l];
}

// ---- one lane as a run alone ------------------------------------------------------------------------

// The run takes parameters, memories and choices of a lane, and its state y at t.
static void become(struct ct_lanes *s, int l, double t, const vec *y)
{
    const struct lane *lane = &s->lane[l];
    struct ct_embed *embed = s->embed;
    take_lane(s->m->input, s->input, l, s->m->ninput);
    ct_machine_prepare(s->m);
    take_lane(s->one_y, y, l, (size_t)s->ny);
    ct_machine_set(s->m, t, s->one_y);
    embed->rank = s->rank;
    memcpy(embed->row, lane->row, (size_t)s->nrow * sizeof *embed->row);
    memcpy(embed->dependent, lane->dependent, (size_t)s->rank * sizeof *embed->dependent);
    memcpy(embed->independent, lane->independent,
           (size_t)(s->nu - s->rank) * sizeof *embed->independent);
}

static bool is_same_choice(const struct ct_lanes *s, const struct lane *a, const struct lane *b)
{
    const size_t r = (size_t)s->rank, f = (size_t)s->nu - r, row = (size_t)s->nrow;
    return memcmp(a->row, b->row, row * sizeof *a->row) == 0
        && memcmp(a->dependent, b->dependent, r * sizeof *a->dependent) == 0
        && memcmp(a->independent, b->independent, f * sizeof *a->independent) == 0;
}

// Where a lane's rows and columns are, for `pick`.
static void index_choice(struct ct_lanes *s, int l)
{
    const struct lane *lane = &s->lane[l];
    const int n = s->nu, r = s->rank;
    for (int j = 0; j < n; j++)
        s->order[W * j + l] = j < r ? lane->dependent[j] : lane->independent[j - r];
    for (int i = 0; i < r; i++)
        s->from_row[W * i + l] = lane->row[i];
    for (int j = 0; j < n; j++) {
        const int column = s->order[W * j + l];
        for (int i = 0; i < r; i++)
            s->from_J[W * (i + r * j) + l] = lane->row[i] + s->nrow * column;
        for (int i = 0; i < n; i++)
            s->from_M[W * (i + n * j) + l] = s->order[W * i + l] + n * column;
    }
}

static void take_choice(struct ct_lanes *s, int l)
{
    struct lane *lane = &s->lane[l];
    const struct ct_embed *embed = s->embed;
    memcpy(lane->row, embed->row, (size_t)s->nrow * sizeof *embed->row);
    memcpy(lane->dependent, embed->dependent, (size_t)s->rank * sizeof *embed->dependent);
    memcpy(lane->independent, embed->independent,
           (size_t)(s->nu - s->rank) * sizeof *embed->independent);
    index_choice(s, l);
    s->is_uniform = true;
    for (int i = 1; i < W; i++)
        s->is_uniform &= is_same_choice(s, &s->lane[0], &s->lane[i]);
    const struct ct_partition p = {lane->row, lane->dependent, lane->independent,
                                   (size_t)s->rank, (size_t)(s->nu - s->rank)};
    s->fits[l] = s->form && ct_form_is_for(s->form, &p);
    s->is_rough[l] = false;
    s->at_sigma[l]
        = 0; // sigma comes from matrices, the form is compared at the next evaluation
    lane->kappa_chosen = embed->kappa_chosen;
    lane->sigma_chosen = embed->sigma_chosen;
    s->kappa[l] = embed->kappa;
    s->sigma[l] = embed->sigma;
}

// Rows and columns anew where J_d has worn; y as just projected.
static void renew(struct ct_lanes *s, int l, const vec *y)
{
    const struct lane *lane = &s->lane[l];
    const bool has_worn = s->kappa[l] > kappa_growth * lane->kappa_chosen + 1
                       || s->kappa[l] > kappa_largest
                       || s->sigma[l] * kappa_growth < lane->sigma_chosen;
    if (!s->rank || !has_worn)
        return;
    become(s, l, s->input[0][l], y);
    ct_machine_constraint(s->m);
    if (ct_embed_choose(s->embed) && s->embed->rank == s->rank)
        take_choice(s, l);
    else
        give_up(s, l);
}

// ---- closed form, as in embed.c ---------------------------------------------------------------------

static bool is_near_singular(const struct ct_lanes *s, int l)
{
    return s->rank && s->sigma[l] < singular_pivot * s->lane[l].pivot_most;
}

// Lanes of `wanted` that may use the form.
static void find_formed(const struct ct_lanes *s, const bool *wanted, bool *formed)
{
    for (int l = 0; l < W; l++)
        formed[l] = wanted[l] && s->fits[l] && !s->is_rough[l] && !is_near_singular(s, l);
}

// Strengths from pivots; lanes that are not sound are taken out.
static void weigh(struct ct_lanes *s, const vec *pivot, bool *formed)
{
    vec least;
    for (int l = 0; l < W; l++)
        least[l] = 1;
    for (size_t i = 0; i < s->code.npivot; i++) {
        const vec scaled = pivot[i] * s->code.scale[i];
        lower(&least, &scaled);
    }
    for (int l = 0; l < W; l++) {
        if (!formed[l])
            continue;
        s->strength[l] = least[l];
        formed[l] = least[l] > weakest && least[l] > least_change * s->at_sigma[l]
                 && least[l] < most_change * s->at_sigma[l];
    }
}

// u', q' by the form at the input; lanes for which it is not sound are taken out.
static void solve_form(struct ct_lanes *s, bool *formed)
{
    const struct ct_form_code *c = &s->code;
    run_program(&s->solved, s->input);
    const vec *out = s->solved.out, *inertia = out + s->nu + s->nq;
    for (int l = 0; l < W; l++)
        for (size_t i = 0; i < c->nfree; i++)
            formed[l] &= inertia[i][l] > 0;
    weigh(s, inertia + c->nfree, formed);
}

// Largest of r (nu + rank) against the largest terms of the equations; NaN counts as infinite.
static void weigh_left(const struct ct_lanes *s, const vec *r, double *left)
{
    const int nu = s->nu, rank = s->rank;
    const vec *Q = s->checked.out + nu + rank + 2 * (nu + rank), *gam = Q + nu;
    vec a = {0}, forces = {0}, rates = {0}, r0 = {0}, r1 = {0}, zero = {0};
    for (int i = 0; i < nu; i++) {
        raise(&a, &s->checked.out[i]);
        raise(&forces, &Q[i]);
        raise(&r0, &r[i]);
        zero += 0 * r[i];
    }
    for (int i = 0; i < rank; i++) {
        raise(&rates, &gam[i]);
        raise(&r1, &r[nu + i]);
        zero += 0 * r[nu + i];
    }
    const vec accelerations[] = {s->code.M_size * a, s->code.J_size * a};
    raise(&forces, &accelerations[0]);
    raise(&rates, &accelerations[1]);
    for (int l = 0; l < W; l++) {
        const double x = r0[l] > 0 ? r0[l] / forces[l] : 0,
                     y = r1[l] > 0 ? r1[l] / rates[l] : 0;
        left[l] = zero[l] == 0 ? fmax(x, y) : INFINITY;
    }
}

// After a projection, at the input: is the form still good in lanes that have it?
static void check_form(struct ct_lanes *s, const bool *wanted)
{
    double left[W], better[W];
    const int n = s->nu + s->rank;
    bool is_due = false;
    for (int l = 0; l < W; l++)
        is_due |= wanted[l] && s->fits[l] && !is_near_singular(s, l);
    if (!is_due)
        return;
    run_program(&s->checked, s->input);
    weigh_left(s, s->checked.out + n, left);
    weigh_left(s, s->checked.out + 2 * n, better);
    vec kappa = {0};
    for (size_t i = 0; i < s->code.nB; i++)
        raise(&kappa, &s->checked.out[4 * n + (int)i]);
    for (int l = 0; l < W; l++) {
        if (!wanted[l] || !s->fits[l] || is_near_singular(s, l))
            continue;
        s->is_rough[l] = !(left[l] <= left_plain && s->strength[l] > weakest);
        if (s->strength[l] > weakest && better[l] <= left_most)
            s->kappa[l] = kappa[l];
    }
}

// ---- projection, as in embed.c ----------------------------------------------------------------------

static void set_input(struct ct_lanes *s, const double *t, const vec *y)
{
    for (int l = 0; l < W; l++)
        s->input[0][l] = t[l];
    memcpy(s->input + s->m->at_q, y, (size_t)(s->nq + s->nu) * sizeof *y);
    s->input[s->m->at_work] = y[s->nq + s->nu];
}

static void evaluate_constraint(struct ct_lanes *s, const double *t, const vec *y)
{
    set_input(s, t, y);
    run_program(&s->constraint, s->input);
    scatter_J(s, s->constraint.out + 2 * s->nrow);
}

// d = correction of the dependent speeds by rows r, in every lane; a lane whose J_d is no good is given up.
static void correction(struct ct_lanes *s, const vec *r, bool *active)
{
    const int n = s->rank;
    pick(s, s->c, r, s->from_row, n);
    for (int k = 0; k < n; k++)
        s->c[k] = -s->c[k];
    for (int l = 0; l < W; l++) {
        if (active[l] && !(s->is_regular[l] && s->kappa[l] <= kappa_largest)) {
            give_up(s, l);
            active[l] = false;
        }
    }
    solve_lu(s, s->c, s->Jd, n);
}

static void normalise(struct ct_lanes *s, vec *y, const bool *wanted)
{
    for (int l = 0; l < W && s->has_quaternion; l++)
        if (wanted[l]) {
            take_lane(s->one_q, y, l, (size_t)s->nq);
            ct_machine_normalise(s->m, s->one_q);
            put_lane(y, l, s->one_q, (size_t)s->nq);
        }
}

// q (+) d where d = c in the dependent speeds.
static void move(struct ct_lanes *s, vec *y, int l)
{
    const struct lane *lane = &s->lane[l];
    if (!s->has_quaternion) {
        for (int k = 0; k < s->rank; k++)
            y[s->e->u[lane->dependent[k]].q][l] += s->c[k][l];
        return;
    }
    memset(s->one_d, 0, (size_t)s->nu * sizeof *s->one_d);
    for (int k = 0; k < s->rank; k++)
        s->one_d[lane->dependent[k]] = s->c[k][l];
    take_lane(s->one_q, y, l, (size_t)s->nq);
    ct_machine_retract(s->m, s->one_q, s->one_d);
    put_lane(y, l, s->one_q, (size_t)s->nq);
}

// What a Newton iteration does next in each active lane: arrived, lost (also taken out of `wanted`), or another step.
static void judge(struct ct_lanes *s, const vec *phi, int i, double *before, bool *active,
                  bool *wanted)
{
    vec size = {0}, zero = {0};
    for (int k = 0; k < s->nrow; k++) {
        raise(&size, &phi[k]);
        zero += 0 * phi[k];
    }
    for (int l = 0; l < W; l++) {
        if (!active[l])
            continue;
        const double now = zero[l] == 0 ? size[l] : INFINITY, sigma = s->sigma[l];
        const double enough
            = sigma < small_pivot ? position_tolerance * sigma : position_tolerance;
        if (now <= enough || (now < gained_below && now > before[l] / 4))
            active[l] = false;
        else if (i == MOST_NEWTON || !isfinite(now) || now > 1e3 * before[l])
            active[l] = wanted[l] = false;
        before[l] = now;
    }
}

// Positions of the wanted lanes onto their constraints; what cannot be is taken out of `wanted`. J is that of the end.
static void close_by_matrices(struct ct_lanes *s, const double *t, vec *y, bool *wanted)
{
    bool active[W];
    double before[W] = {INFINITY, INFINITY, INFINITY, INFINITY};
    memcpy(active, wanted, sizeof active);
    for (int i = 0;; i++) {
        evaluate_constraint(s, t, y);
        judge(s, s->constraint.out, i, before, active, wanted);
        if (!any(active))
            return;
        factor(s, active);
        correction(s, s->constraint.out, active);
        for (int l = 0; l < W; l++)
            if (active[l])
                move(s, y, l);
    }
}

static void project_by_matrices(struct ct_lanes *s, const double *t, vec *y, bool *wanted)
{
    close_by_matrices(s, t, y, wanted);
    factor(s, wanted);
    for (int i = 0; i < 2; i++) { // linear; the second step takes off rounding
        correction(s, s->constraint.out + s->nrow, wanted);
        for (int l = 0; l < W; l++)
            for (int k = 0; k < s->rank && wanted[l]; k++)
                y[s->nq + s->lane[l].dependent[k]][l] += s->c[k][l];
        if (i == 0)
            evaluate_constraint(s, t, y);
    }
}

// Phi, v and corrections by the form; lanes for which it is not sound are taken out.
static void close_form(struct ct_lanes *s, const double *t, const vec *y, bool *formed)
{
    set_input(s, t, y);
    run_program(&s->closing, s->input);
    weigh(s, s->closing.out + 2 * s->nrow + 2 * s->nu, formed);
}

// y (+) what the form says, in the lanes asked for: dq for positions, du for speeds.
static void add_positions(struct ct_lanes *s, vec *y, const bool *wanted)
{
    const vec *dq = s->closing.out + 2 * s->nrow;
    for (int l = 0; l < W; l++) {
        if (!wanted[l])
            continue;
        for (int k = 0; k < s->nu && !s->has_quaternion; k++)
            y[s->e->u[k].q][l] += dq[k][l];
        if (!s->has_quaternion)
            continue;
        take_lane(s->one_d, dq, l, (size_t)s->nu);
        take_lane(s->one_q, y, l, (size_t)s->nq);
        ct_machine_retract(s->m, s->one_q, s->one_d);
        put_lane(y, l, s->one_q, (size_t)s->nq);
    }
}

static void add_speeds(struct ct_lanes *s, vec *y, const bool *wanted)
{
    const vec *du = s->closing.out + 2 * s->nrow + s->nu;
    for (int l = 0; l < W; l++)
        for (int k = 0; k < s->nu && wanted[l]; k++)
            y[s->nq + k][l] += du[k][l];
}

// Lanes of `formed` onto the constraints by the form. Those it is not sound for are taken out and go on by matrices;
// those that are lost are taken out of `wanted`, too.
static void project_by_form(struct ct_lanes *s, const double *t, vec *y, bool *formed,
                            bool *wanted)
{
    double before[W] = {INFINITY, INFINITY, INFINITY, INFINITY};
    bool active[W], arrived[W] = {false};
    memcpy(active, formed, sizeof active);
    for (int i = 0; any(active); i++) {
        bool now[W];
        close_form(s, t, y, active);
        memcpy(now, active, sizeof now);
        judge(s, s->closing.out, i, before, active, wanted);
        for (int l = 0; l < W; l++) { // sound, but no step is left to take
            now[l] &= !active[l] && wanted[l];
            arrived[l] |= now[l];
        }
        add_positions(s, y, active);
        add_speeds(s, y, now);
    }
    memcpy(formed, arrived, sizeof arrived);
    if (!any(formed))
        return;
    close_form(s, t, y, formed); // once more, to take off rounding
    add_speeds(s, y, formed);
}

// Lanes of y in `wanted` onto the constraints at t; those that cannot be are taken out.
static void project(struct ct_lanes *s, const double *t, vec *y, bool *wanted)
{
    bool formed[W], rest[W];
    normalise(s, y, wanted);
    if (!s->nrow || !any(wanted))
        return;
    find_formed(s, wanted, formed);
    for (int l = 0; l < W; l++)
        formed[l] &= s->kappa[l] <= kappa_largest;
    if (any(formed))
        project_by_form(s, t, y, formed, wanted);
    for (int l = 0; l < W; l++)
        rest[l] = wanted[l] && !formed[l];
    if (any(rest)) {
        bool lost[W];
        memcpy(lost, rest, sizeof lost);
        project_by_matrices(s, t, y, rest);
        for (int l = 0; l < W; l++) {
            wanted[l] &= !lost[l] || rest[l];
            rest[l] &= s->fits[l];
        }
        if (any(rest)) { // sigma has just been found
            bool ignored[W];
            memcpy(ignored, rest, sizeof ignored);
            close_form(s, t, y, ignored);
            for (int l = 0; l < W; l++)
                s->at_sigma[l] = rest[l] ? s->strength[l] : s->at_sigma[l];
        }
    }
    set_input(s, t, y);
    if (s->form)
        check_form(s, wanted);
    for (int l = 0; l < W; l++)
        if (wanted[l])
            renew(s, l, y);
}

// ---- the derivative, as in simulate.c -----------------------------------------------------------------

// y as it is, or with the wanted lanes beside a singular position put onto the constraints.
static const vec *put_stages(struct ct_lanes *s, const double *t, const vec *y, bool *wanted)
{
    bool near[W], still[W];
    for (int l = 0; l < W; l++)
        near[l] = wanted[l] && is_near_singular(s, l);
    if (!any(near))
        return y;
    memcpy(s->stage, y, (size_t)s->ny * sizeof *y);
    memcpy(still, near, sizeof still);
    project(s, t, s->stage, still);
    for (int l = 0; l < W; l++)
        wanted[l] &= !near[l] || still[l];
    return s->stage;
}

// u' into a and q' into dy by matrices, in the lanes asked for.
static void solve_matrices(struct ct_lanes *s, vec *dy, const bool *wanted)
{
    const struct ct_equations *e = s->e;
    const vec *out = s->motion.out, *Q = out + e->nM, *J = Q + s->nu, *gam = J + e->nJ;
    run_program(&s->motion, s->input);
    for (size_t i = 0; i < e->nM; i++) {
        const int r = e->M[i].row, c = e->M[i].column;
        s->M[r + s->nu * c] = s->M[c + s->nu * r] = out[i];
    }
    scatter_J(s, J);
    accelerate(s, Q, gam, wanted);
    memcpy(dy, gam + s->nrow, (size_t)s->nq * sizeof *dy);
}

// u' into a, q' into dy, by the form where it is sound, else by matrices. Returns Q, as the latter have it.
static const vec *solve(struct ct_lanes *s, vec *dy, const bool *wanted)
{
    bool formed[W], tried[W], rest[W];
    find_formed(s, wanted, formed);
    memcpy(tried, formed, sizeof tried);
    if (any(formed))
        solve_form(s, formed);
    for (int l = 0; l < W; l++)
        rest[l] = wanted[l] && !formed[l];
    const bool is_mixed = any(rest);
    if (is_mixed || !any(formed))
        solve_matrices(s, dy, rest);
    for (int l = 0; l < W; l++)
        if (rest[l]) // the strength belongs to sigma, as it is found now
            s->at_sigma[l] = tried[l] ? s->strength[l] : 0;
    const vec *out = s->solved.out;
    if (!is_mixed && any(formed)) {
        memcpy(s->a, out, (size_t)s->nu * sizeof *out);
        memcpy(dy, out + s->nu, (size_t)s->nq * sizeof *out);
    }
    for (int l = 0; l < W && is_mixed; l++) {
        for (int i = 0; i < s->nu && formed[l]; i++)
            s->a[i][l] = out[i][l];
        for (int i = 0; i < s->nq && formed[l]; i++)
            dy[i][l] = out[s->nu + i][l];
    }
    return s->motion.out + s->e->nM;
}

// dy = f(t, y); lanes without one are taken out of `wanted`.
static void derive(struct ct_lanes *s, const double *t, const vec *y, vec *dy, bool *wanted)
{
    const int nu = s->nu;
    const vec *Q = NULL;
    set_input(s, t, put_stages(s, t, y, wanted));
    s->count.evaluations++;
    if (s->is_solved) {
        run_program(&s->motion, s->input);
        memcpy(s->a, s->motion.out, (size_t)nu * sizeof *s->a);
        memcpy(dy, s->motion.out + nu, (size_t)s->nq * sizeof *dy);
    } else {
        Q = solve(s, dy, wanted);
    }
    memcpy(dy + s->nq, s->a, (size_t)nu * sizeof *dy);
    dy[s->ny - 1] = (vec){0};
    if (s->has_power) {
        memcpy(s->input + s->m->at_a, s->a, (size_t)nu * sizeof *s->a);
        if (s->needs_lam && Q)
            multipliers(s, Q);
        run_program(&s->power, s->input);
        dy[s->ny - 1] = s->power.out[0];
    }
    vec zero = {0}; // 0 * inf is NaN
    for (int i = 0; i < s->ny; i++)
        zero += 0 * dy[i];
    for (int l = 0; l < W; l++)
        wanted[l] &= zero[l] == 0;
}

// ---- a try ------------------------------------------------------------------------------------------

// out = y + h (a_0 k_0 + ...); y NULL: without.
static void combine(const struct ct_lanes *s, vec *out, const vec *y, const double *a, int n)
{
    vec h;
    for (int l = 0; l < W; l++)
        h[l] = s->h[l];
    for (int i = 0; i < s->ny; i++) {
        vec sum = {0};
        for (int j = 0; j < n; j++)
            if (a[j] != 0) // tables have many zeros
                sum += a[j] * s->k[i + s->ny * j];
        out[i] = y ? y[i] + h * sum : h * sum;
    }
}

// Root mean square of e against the tolerance, as ct_stepper_norm.
static void norm(const struct ct_lanes *s, double *out, const vec *e)
{
    const int n = s->has_power ? s->ny : s->ny - 1; // the work is as good as the states
    vec sum = {0};
    for (int i = 0; i < n; i++) {
        vec size = {0};
        raise(&size, &s->y[i]);
        raise(&size, &s->y1[i]);
        const vec part = e[i] / (s->rtol * size + s->atol);
        sum += part * part;
    }
    for (int l = 0; l < W; l++)
        out[l] = n ? sqrt(sum[l] / n) : 0;
}

static void estimate(struct ct_lanes *s)
{
    const struct ct_tableau *b = s->method->tableau;
    double e[W], e3[W] = {0};
    combine(s, s->point, NULL, b->E, b->nerror);
    norm(s, e, s->point);
    if (b->B3) {
        combine(s, s->third, s->y, b->B3, b->nerror);
        for (int i = 0; i < s->ny; i++)
            s->third[i] = s->y1[i] - s->third[i];
        norm(s, e3, s->third);
    }
    for (int l = 0; l < W; l++)
        s->lane[l].error = !b->B3 || e[l] == 0 ? e[l] : e[l] / hypot(1, 0.1 * (e3[l] / e[l]));
}

// Ends of the stages at t + C h; the last one is the end of the step, y1 with dy1.
static void take_stages(struct ct_lanes *s, bool *wanted)
{
    const struct ct_tableau *b = s->method->tableau;
    const size_t n = (size_t)s->ny;
    double t[W];
    memcpy(s->k, s->dy, n * sizeof *s->k);
    for (int stage = 1; stage < b->stages && any(wanted); stage++) {
        vec *to = stage + 1 == b->stages ? s->y1 : stage + 2 == b->stages ? s->late : s->point;
        combine(s, to, s->y, b->A + b->stride * stage, stage);
        for (int l = 0; l < W; l++)
            t[l] = s->t[l] + b->C[stage] * s->h[l];
        derive(s, t, to, s->k + n * (size_t)stage, wanted);
    }
    memcpy(s->dy1, s->k + n * (size_t)(b->stages - 1), n * sizeof *s->dy1);
}

// end, dend = y1, dy1 on the constraints.
static void project_end(struct ct_lanes *s, bool *wanted)
{
    const size_t n = (size_t)s->ny;
    double t[W];
    bool moved[W];
    memcpy(s->end, s->y1, n * sizeof *s->end);
    memcpy(s->dend, s->dy1, n * sizeof *s->dend);
    if (!s->nrow && !s->has_quaternion)
        return;
    for (int l = 0; l < W; l++)
        t[l] = s->lane[l].end;
    project(s, t, s->end, wanted);
    for (int l = 0; l < W; l++) {
        moved[l] = false;
        for (int i = 0; i < s->ny && wanted[l]; i++)
            moved[l] |= s->end[i][l] != s->y1[i][l];
    }
    if (!any(moved))
        return;
    bool known[W];
    memcpy(known, moved, sizeof known);
    derive(s, t, s->end, s->dend, known);
    for (int l = 0; l < W; l++)
        if (!moved[l])
            for (size_t i = 0; i < n; i++)
                s->dend[i][l] = s->dy1[i][l];
        else
            wanted[l] &= known[l];
}

// ---- step control, as in driver.c -------------------------------------------------------------------

static void plan(struct ct_lanes *s, int l)
{
    struct lane *lane = &s->lane[l];
    const double rest = lane->t1 - s->t[l], wanted = fmin(lane->h, lane->t1);
    const double h = rest <= stretch * wanted ? rest : rest < 2 * wanted ? rest / 2 : wanted;
    const bool is_landing = h >= rest;
    const double scale = fmax(fabs(s->t[l]), least_scale * lane->t1);
    s->h[l] = h;
    lane->end = is_landing ? lane->t1 : s->t[l] + h;
    if ((!is_landing && h <= least_step * scale) || lane->steps >= MOST_STEPS)
        give_up(s, l);
}

static void adapt_after_success(struct ct_lanes *s, int l)
{
    struct lane *lane = &s->lane[l];
    const double beta = 0.2 / (s->method->error_order + 1);
    const double alpha = 1.0 / (s->method->error_order + 1) - 0.75 * beta;
    const double h = s->h[l],
                 growth = s->method->most_growth > 0 ? s->method->most_growth : most_growth;
    const double factor = pow(lane->error, alpha) / pow(lane->error_before, beta) / safety;
    const double *steady = s->method->steady;
    double next = h / fmin(fmax(factor, 1 / growth), 1 / most_shrink);
    if (next > steady[0] * h && next < steady[1] * h)
        next = h;
    if (lane->was_refused)
        next = fmin(next, h);
    else if (h < lane->h)
        next = fmax(next, lane->h);
    lane->h = next;
    lane->error_before = fmax(lane->error, remembered_error);
    lane->was_refused = false;
}

static void adapt_after_refusal(struct ct_lanes *s, int l)
{
    struct lane *lane = &s->lane[l];
    const double alpha = 1.0 / (s->method->error_order + 1), error = lane->error;
    lane->h
        = error > 1 ? s->h[l] * fmax(most_shrink, safety * pow(error, -alpha)) : s->h[l] / 2;
    lane->was_refused = true;
    s->count.rejected++;
}

// The last two stages are both at the end of the step: their difference shows the fastest motions, as in DOPRI5
// by Hairer, Norsett and Wanner (1993), IV.2 of the second volume, key hairer1996. A stiff run is one for a run alone,
// which can change its method.
static void watch_stiffness(struct ct_lanes *s, const bool *wanted)
{
    const size_t n = (size_t)s->ny - 1; // the work feeds nothing back
    const int last = s->method->tableau->stages - 1;
    const vec *k1 = s->k + (size_t)(last * s->ny), *k0 = k1 - s->ny;
    vec rates = {0}, states = {0};
    for (size_t i = 0; i < n; i++) {
        rates += (k1[i] - k0[i]) * (k1[i] - k0[i]);
        states += (s->y1[i] - s->late[i]) * (s->y1[i] - s->late[i]);
    }
    for (int l = 0; l < W; l++) {
        struct lane *lane = &s->lane[l];
        if (!wanted[l] || !lane->is_watched)
            continue;
        if (states[l] > 0 && s->h[l] * sqrt(rates[l] / states[l]) > stiff_step) {
            lane->nother = 0;
            if (++lane->nstiff >= MOST_STIFF)
                give_up(s, l);
        } else if (lane->nstiff && ++lane->nother >= FEW_OTHERS) {
            lane->nstiff = lane->nother = 0;
        }
    }
}

// ---- after a try ------------------------------------------------------------------------------------

// Memories follow the motion to y at t where wanted.
static void follow(struct ct_lanes *s, const double *t, const vec *y, const bool *wanted)
{
    const struct ct_equations *e = s->e;
    vec *memory = s->input + s->m->at_memory;
    if (!e->nmemory)
        return;
    set_input(s, t, y);
    run_program(&s->memory, s->input);
    for (int l = 0; l < W; l++)
        for (size_t i = 0; i < e->nmemory && wanted[l]; i++) {
            if (e->memory[i].kind != CT_MEMORY_OFFSET)
                memory[i][l] = s->memory.out[i][l];
            if (e->memory[i].kind == CT_MEMORY_QUATERNION && e->memory[i].place == 3) {
                double square = 0;
                for (int k = -3; k <= 0; k++)
                    square += memory[(int)i + k][l] * memory[(int)i + k][l];
                const double length = sqrt(square);
                for (int k = -3; k <= 0 && length > 0; k++)
                    memory[(int)i + k][l] /= length;
            }
        }
}

// A singular position that comes within reach is for a run alone.
static void foresee_singular(struct ct_lanes *s, const double *t, const vec *y,
                             const bool *wanted)
{
    bool near[W];
    for (int l = 0; l < W; l++) {
        struct lane *lane = &s->lane[l];
        if (wanted[l])
            lane->pivot_most = fmax(lane->pivot_most, s->sigma[l]);
        near[l] = wanted[l] && is_near_singular(s, l);
        if (wanted[l] && !near[l])
            lane->pivot_last = INFINITY;
    }
    if (!any(near))
        return;
    evaluate_constraint(s, t, y);
    factor(s, near);
    for (int l = 0; l < W; l++) {
        struct lane *lane = &s->lane[l];
        if (!near[l])
            continue;
        const double before = lane->pivot_last, now = s->sigma[l], dt = t[l] - lane->pivot_time;
        lane->pivot_last = now;
        lane->pivot_time = t[l];
        if (isfinite(before) && before > now && dt > 0
            && dt * now / (before - now) <= singular_steps * lane->h)
            give_up(s, l);
    }
}

static void commit(struct ct_lanes *s, const bool *wanted)
{
    for (int l = 0; l < W; l++) {
        struct lane *lane = &s->lane[l];
        if (!wanted[l] || lane->state != CT_LANE_RUNNING)
            continue;
        for (int i = 0; i < s->ny; i++) {
            s->y[i][l] = s->end[i][l];
            s->dy[i][l] = s->dend[i][l];
        }
        s->t[l] = lane->end;
        lane->steps++;
        s->count.steps++;
        if (lane->end >= lane->t1)
            lane->state = CT_LANE_ARRIVED;
    }
}

#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
__attribute__((target_clones("avx2", "default"), flatten))
#endif
void ct_lanes_step(struct ct_lanes *s)
{
    bool wanted[W], tried[W];
    double t[W];
    for (int l = 0; l < W; l++) {
        if (s->lane[l].state == CT_LANE_RUNNING)
            plan(s, l);
        tried[l] = wanted[l] = s->lane[l].state == CT_LANE_RUNNING;
        s->lane[l].error = 0;
    }
    take_stages(s, wanted);
    estimate(s);
    for (int l = 0; l < W; l++) {
        bool is_finite = isfinite(s->lane[l].error);
        for (int i = 0; i < s->ny; i++)
            is_finite &= isfinite(s->y1[i][l]) != 0;
        if (!wanted[l] || !is_finite)
            s->lane[l].error = 0; // not the error is why
        wanted[l] &= is_finite && s->lane[l].error <= 1;
    }
    project_end(s, wanted);
    for (int l = 0; l < W; l++)
        t[l] = s->lane[l].end;
    follow(s, t, s->end, wanted);
    for (int l = 0; l < W; l++)
        if (wanted[l])
            adapt_after_success(s, l);
        else if (tried[l])
            adapt_after_refusal(s, l);
    foresee_singular(s, t, s->end, wanted);
    watch_stiffness(s, wanted);
    commit(s, wanted);
}

// ---- members come and go ----------------------------------------------------------------------------

static double weight(const struct ct_lanes *s, int l, double y)
{
    return s->rtol[l] * fabs(y) + s->atol[l];
}

// A first step whose error should be near a hundredth of the tolerance; constants as in driver.c.
static bool first_step(struct ct_lanes *s, int l, const double *y, const double *dy)
{
    struct lane *lane = &s->lane[l];
    const int n = s->has_power ? s->ny : s->ny - 1;
    double d0 = 0, d1 = 0, d2 = 0;
    for (int i = 0; i < n; i++) {
        const double w = weight(s, l, y[i]);
        d0 += y[i] / w * (y[i] / w);
        d1 += dy[i] / w * (dy[i] / w);
    }
    d0 = n ? sqrt(d0 / n) : 0;
    d1 = n ? sqrt(d1 / n) : 0;
    double h = fmin(d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * d0 / d1, lane->t1);
    for (int i = 0; i < s->ny; i++)
        s->one_point[i] = y[i] + h * dy[i];
    lane->h = h; // step control will find a smaller one
    if (ct_run_rhs(s->run, h, s->one_point, s->one_d) != CT_EVAL_OK)
        return true;
    for (int i = 0; i < n; i++) {
        const double bend = (s->one_d[i] - dy[i]) / h / weight(s, l, y[i]);
        d2 += bend * bend;
    }
    const double d = fmax(d1, n ? sqrt(d2 / n) : 0);
    if (!isfinite(d))
        return false;
    const double by_error
        = d <= 1e-15 ? fmax(1e-6, 1e-3 * h) : pow(0.01 / d, 1.0 / (s->method->error_order + 1));
    lane->h = fmin(fmin(100 * h, by_error), lane->t1);
    return true;
}

bool ct_lanes_load(struct ct_lanes *s, int l, const struct ct_run_options *o)
{
    struct lane *lane = &s->lane[l];
    const int rank = s->embed->rank;
    const double *y = ct_run_state(s->run);
    if (!(o->duration > 0) || ct_lanes_refusal(s->e, o)
        || (s->is_used && o->method != s->method) || (s->is_used && rank != s->rank)
        || (s->needs_lam && rank != s->nrow))
        return false;
    s->method = o->method;
    s->rank = rank;
    lane->t1 = o->duration;
    s->rtol[l] = o->rtol;
    s->atol[l] = o->atol;
    lane->error_before = remembered_error;
    lane->was_refused = false;
    lane->pivot_most = 0;
    lane->pivot_last = INFINITY;
    lane->pivot_time = 0;
    lane->steps = 0;
    lane->is_watched = o->stiff_method != NULL;
    lane->nstiff = lane->nother = 0;
    if (ct_run_rhs(s->run, 0, y, s->one_dy) != CT_EVAL_OK || !first_step(s, l, y, s->one_dy))
        return false;
    for (int i = 0; i < W;
         i++) // lanes that never had a member follow the first, for finite numbers
        if (i == l || !s->is_used) {
            take_choice(s, i);
            put_lane(s->input, i, s->m->input, s->m->ninput);
            put_lane(s->y, i, y, (size_t)s->ny);
            put_lane(s->dy, i, s->one_dy, (size_t)s->ny);
            s->t[i] = 0;
        }
    struct program *const all[] = {&s->motion, &s->constraint, &s->power,  &s->memory,
                                   &s->solved, &s->checked,    &s->closing};
    for (size_t i = 0; i < COUNT(all); i++)
        prepare(all[i], s->input);
    s->is_used = true;
    lane->state = CT_LANE_RUNNING;
    return true;
}

enum ct_lane_state ct_lanes_state(const struct ct_lanes *s, int lane)
{
    return s->lane[lane].state;
}

bool ct_lanes_results(struct ct_lanes *s, int l, double *out)
{
    become(s, l, s->lane[l].t1, s->y);
    if (ct_run_results(s->run, s->lane[l].t1, s->one_y, out) != CT_EVAL_OK)
        return false;
    for (size_t i = 0; i < s->e->nresult; i++)
        if (!isfinite(out[i]))
            return false;
    return true;
}

void ct_lanes_free(struct ct_lanes *s, int lane)
{
    s->lane[lane].state = CT_LANE_IDLE;
}

struct ct_lanes_count ct_lanes_count(const struct ct_lanes *s)
{
    return s->count;
}
