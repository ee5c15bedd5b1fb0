// See oracle.h.
#include "tests/property/oracle/oracle.h"
#include "tests/property/oracle/joint_motion.h"

#include <stdlib.h>
#include <string.h>

extern void dgesdd_(const char *job, const int *m, const int *n, double *a, const int *lda,
                    double *s, double *u, const int *ldu, double *vt, const int *ldvt,
                    double *work, const int *lwork, int *iwork, int *info, size_t);
extern void dsyev_(const char *job, const char *uplo, const int *n, double *a, const int *lda,
                   double *w, double *work, const int *lwork, int *info, size_t, size_t);

// Generators leave no singular value between their gap's ends (generate.c: 0.01 and, with data of
// six digits, 1e-4), and this is in between.
static const double rank_limit = 1e-3;

static const struct vector none = {{0, 0, 0}};

static double *numbers(int n)
{
    return calloc((size_t)n + 1, sizeof(double));
}

// ---- kinematics of two frames on bodies ---------------------------------------------------------

// How frame `to` stands and moves as seen in frame `from`: rates in axes of `from`.
struct view {
    struct pose from, pose; // `from` in ground, `to` in `from`
    struct vector r[2], d; // arms from the bodies' origins, from frame to frame, in ground axes
    struct vector v, w, v_bias,
        w_bias; // rates and what of their rates does not hang on accelerations
};

static struct view view_joint(const struct scene *s, const struct joint *j,
                              const struct motion *m)
{
    struct view k;
    struct vector at[2], v[2], bias[2];
    struct pose end[2];
    (void)s;
    for (int i = 0; i < 2; i++) {
        const int b = i ? j->to : j->from;
        end[i] = composed(m->body[b], (struct pose){j->end[i].at, axes_of(&j->end[i])});
        at[i] = end[i].at;
        k.r[i] = plus(at[i], -1, m->body[b].at);
        v[i] = plus(m->v[b], 1, cross(m->w[b], k.r[i]));
        bias[i] = cross(m->w[b], cross(m->w[b], k.r[i]));
    }
    const struct vector wi = m->w[j->from], relative_w = plus(m->w[j->to], -1, wi);
    k.from = end[0];
    k.pose = seen_from(end[0], end[1]);
    k.d = plus(at[1], -1, at[0]);
    // d/dt of A' d = A' (d' - wi x d); once more gives the relative acceleration with its Coriolis
    // part
    const struct vector rate = plus(plus(v[1], -1, v[0]), -1, cross(wi, k.d));
    struct vector b = plus(bias[1], -1, bias[0]);
    b = plus(b, -1, cross(wi, cross(wi, k.d)));
    b = plus(b, -2, cross(wi, rate));
    k.v = turned_back(end[0].R, rate);
    k.v_bias = turned_back(end[0].R, b);
    k.w = turned_back(end[0].R, relative_w);
    k.w_bias = turned_back(end[0].R, scaled(-1, cross(wi, relative_w)));
    return k;
}

// ---- rows ---------------------------------------------------------------------------------------

// Columns 6 (b - 1) ... of body b: acceleration of its frame over size, angular acceleration, in
// ground axes.
static double *entry(struct oracle *o, int row, int column)
{
    return &o->G[row + o->nrow * column];
}

// row += f . (acceleration of a point with arm r on body b) / size
static void add_point(struct oracle *o, int row, int b, struct vector f, struct vector r)
{
    const struct vector moment = cross(r, f);
    if (b == 0)
        return;
    for (int i = 0; i < 3; i++) {
        *entry(o, row, 6 * (b - 1) + i) += f.e[i];
        *entry(o, row, 6 * (b - 1) + 3 + i) += moment.e[i] / o->size;
    }
}

// row += t . (angular acceleration of body b)
static void add_turn(struct oracle *o, int row, int b, struct vector t)
{
    if (b == 0)
        return;
    for (int i = 0; i < 3; i++)
        *entry(o, row, 6 * (b - 1) + 3 + i) += t.e[i];
}

static bool is_length(const struct joint *j, int i)
{
    return j->type == PRISMATIC || (j->type == CYLINDRICAL && i == 0)
        || (j->type == PLANAR && i < 2) || (j->type == FREE && i < 3);
}

double oracle_unit(const struct oracle *o, int joint, int i)
{
    return is_length(&o->s->joint[joint], i) ? o->size : 1;
}

// residuals: position, velocity, acceleration (the right-hand side), one number each for a row
struct residual {
    double *position, *velocity;
};

static void add_joint(struct oracle *o, int joint, int row, const struct motion *m,
                      struct residual *r)
{
    const struct joint *j = &o->s->joint[joint];
    const struct view k = view_joint(o->s, j, m);
    const struct joint_motion p = joint_motion(j, m->q[joint], m->u[joint]);
    const int nu = joint_speeds(j->type);
    const struct vector gap = plus(k.pose.at, -1, p.pose.at);
    struct axes across; // k.R p.R', from the columns of their transposes
    {
        const struct axes kt = relative(k.pose.R, same_axes()),
                          pt = relative(p.pose.R, same_axes());
        across = relative(kt, pt);
    }
    const struct vector turn = small_rotation(across);
    struct vector v = k.v, w = k.w;
    for (int i = 0; i < nu; i++) {
        v = plus(v, -m->u[joint][i], p.linear[i]);
        w = plus(w, -m->u[joint][i], p.angular[i]);
    }
    for (int i = 0; i < 3; i++) {
        const struct vector e = k.from.R.column[i];
        // relative acceleration e . (a_j + alpha_j x r_j - a_i - alpha_i x (r_i + d)), the frame's
        // own rotation included
        add_point(o, row + i, j->to, e, k.r[1]);
        add_point(o, row + i, j->from, scaled(-1, e), plus(k.r[0], 1, k.d));
        add_turn(o, row + 3 + i, j->to, e);
        add_turn(o, row + 3 + i, j->from, scaled(-1, e));
        for (int c = 0; c < nu; c++) {
            const double scale = oracle_unit(o, joint, c);
            *entry(o, row + i, o->column[joint] + c) = -p.linear[c].e[i] * scale / o->size;
            *entry(o, row + 3 + i, o->column[joint] + c) = -p.angular[c].e[i] * scale;
        }
        o->c[row + i] = (p.linear_bias.e[i] - k.v_bias.e[i]) / o->size;
        o->c[row + 3 + i] = p.angular_bias.e[i] - k.w_bias.e[i];
        r->position[row + i] = gap.e[i] / o->size;
        r->position[row + 3 + i] = turn.e[i];
        r->velocity[row + i] = v.e[i] / o->size;
        r->velocity[row + 3 + i] = w.e[i];
    }
}

// |d| = length: with n = d/|d|, n . (a_2 - a_1) = -(|d'|^2 - (n . d')^2)/|d| - n . (centripetal
// parts)
static void add_distance(struct oracle *o, int joint, int row, const struct motion *m,
                         struct residual *r)
{
    const struct joint *j = &o->s->joint[joint];
    struct vector arm[2], v[2], bias[2], at[2];
    for (int i = 0; i < 2; i++) {
        const int b = i ? j->to : j->from;
        arm[i] = turned(m->body[b].R, j->end[i].at);
        at[i] = plus(m->body[b].at, 1, arm[i]);
        v[i] = plus(m->v[b], 1, cross(m->w[b], arm[i]));
        bias[i] = cross(m->w[b], cross(m->w[b], arm[i]));
    }
    const struct vector d = plus(at[1], -1, at[0]), rate = plus(v[1], -1, v[0]);
    const double length = norm(d);
    const struct vector n = scaled(1 / length, d);
    const double along = dot(n, rate);
    add_point(o, row, j->to, n, arm[1]);
    add_point(o, row, j->from, scaled(-1, n), arm[0]);
    o->c[row]
        = -((dot(rate, rate) - along * along) / length + dot(n, plus(bias[1], -1, bias[0])))
        / o->size;
    r->position[row] = (length - j->length) / o->size;
    r->velocity[row] = along / o->size;
}

static void add_gear(struct oracle *o, int joint, int row, const struct motion *m,
                     struct residual *r)
{
    const struct joint *g = &o->s->joint[joint];
    *entry(o, row, o->column[g->from]) = 1;
    *entry(o, row, o->column[g->to]) = -g->ratio;
    r->velocity[row] = m->u[g->from][0] - g->ratio * m->u[g->to][0];
}

static int rows_of(enum joint_type type)
{
    return type == DISTANCE || type == GEAR ? 1 : 6;
}

// Places of joints and masses, at the start: the largest extent over the origin of ground and all
// ends.
static double size_of(const struct scene *s)
{
    double size = 0;
    struct vector low = none, high = none;
    for (int i = 0; i < s->njoint; i++)
        for (int k = 0; k < 2 && s->joint[i].type != GEAR; k++) {
            const struct joint *j = &s->joint[i];
            const struct pose *b = &s->body[k ? j->to : j->from].pose;
            const struct vector p = plus(b->at, 1, turned(b->R, j->end[k].at));
            for (int c = 0; c < 3; c++) {
                low.e[c] = fmin(low.e[c], p.e[c]);
                high.e[c] = fmax(high.e[c], p.e[c]);
            }
        }
    for (int c = 0; c < 3; c++)
        size = fmax(size, high.e[c] - low.e[c]);
    return size > 0 ? size : 1;
}

struct motion motion_of_scene(const struct scene *s)
{
    struct motion m;
    memset(&m, 0, sizeof m);
    for (int i = 0; i < s->nbody; i++)
        m.body[i] = s->body[i].pose;
    for (int i = 0; i < s->njoint; i++)
        memcpy(m.q[i], s->joint[i].q, sizeof m.q[i]);
    return m;
}

// ---- singular values ----------------------------------------------------------------------------

static void decompose(struct oracle *o)
{
    const int m = o->nrow, n = o->ncol, least = m < n ? m : n, most = m < n ? n : m;
    const int lwork = 4 * least * least + 7 * least + most + 64 * most;
    double *A = numbers(m * n), *work = numbers(lwork);
    int *iwork = calloc(8 * (size_t)least + 1, sizeof(int)), info;
    memcpy(A, o->G, sizeof(double) * (size_t)(m * n));
    dgesdd_("A", &m, &n, A, &m, o->sigma, o->U, &m, o->V, &n, work, &lwork, iwork, &info, 1);
    if (info)
        abort();
    while (o->rank < least && o->sigma[o->rank] > rank_limit)
        o->rank++;
    o->smallest = o->rank ? o->sigma[o->rank - 1] : 1;
    o->largest_out = o->rank < least ? o->sigma[o->rank] : 0;
    o->freedoms = n - o->rank;
    free(A);
    free(work);
    free(iwork);
}

static double largest(const double *v, int n)
{
    double max = 0;
    for (int i = 0; i < n; i++)
        max = fmax(max, fabs(v[i]));
    return max;
}

static void open_with(struct oracle *o, const struct scene *s, const struct motion *m,
                      struct residual *r)
{
    *o = (struct oracle){.s = s, .size = size_of(s), .ncol = 6 * (s->nbody - 1)};
    for (int i = 0; i < s->njoint; i++) {
        o->column[i] = o->ncol;
        o->ncol += joint_speeds(s->joint[i].type);
        o->nrow += rows_of(s->joint[i].type);
    }
    o->G = numbers(o->nrow * o->ncol);
    o->c = numbers(o->nrow);
    o->U = numbers(o->nrow * o->nrow);
    o->V = numbers(o->ncol * o->ncol);
    o->sigma = numbers(o->nrow + o->ncol);
    r->position = numbers(o->nrow);
    r->velocity = numbers(o->nrow);
    for (int i = 0, row = 0; i < s->njoint; i++) {
        const enum joint_type type = s->joint[i].type;
        (type == DISTANCE ? add_distance
         : type == GEAR   ? add_gear
                          : add_joint)(o, i, row, m, r);
        row += rows_of(type);
    }
    decompose(o);
    o->position = largest(r->position, o->nrow);
    o->velocity = largest(r->velocity, o->nrow);
}

static void close_residual(struct residual *r)
{
    free(r->position);
    free(r->velocity);
}

void oracle_open(struct oracle *o, const struct scene *s, const struct motion *m)
{
    struct residual r;
    open_with(o, s, m, &r);
    close_residual(&r);
}

void oracle_close(struct oracle *o)
{
    free(o->G);
    free(o->c);
    free(o->U);
    free(o->V);
    free(o->sigma);
}

// x = least solution of G x = b in the least-squares sense: V sigma^-1 U' b over the singular
// values that count
static void least_solution(const struct oracle *o, const double *b, double *x)
{
    memset(x, 0, sizeof(double) * (size_t)o->ncol);
    for (int k = 0; k < o->rank; k++) {
        double f = 0;
        for (int i = 0; i < o->nrow; i++)
            f += o->U[i + o->nrow * k] * b[i];
        for (int i = 0; i < o->ncol; i++)
            x[i] += f / o->sigma[k] * o->V[k + o->ncol * i];
    }
}

// ---- unknowns <-> bodies and joints -------------------------------------------------------------

static void unpack(const struct oracle *o, const double *x, struct motion *out)
{
    const struct scene *s = o->s;
    memset(out, 0, sizeof *out);
    for (int b = 1; b < s->nbody; b++)
        for (int i = 0; i < 3; i++) {
            out->v[b].e[i] = x[6 * (b - 1) + i] * o->size;
            out->w[b].e[i] = x[6 * (b - 1) + 3 + i];
        }
    for (int j = 0; j < s->njoint; j++)
        for (int i = 0; i < joint_speeds(s->joint[j].type); i++)
            out->u[j][i] = x[o->column[j] + i] * oracle_unit(o, j, i);
}

void oracle_freedom(const struct oracle *o, int k, struct motion *speeds)
{
    double x[MOST_COLUMNS];
    for (int i = 0; i < o->ncol; i++)
        x[i] = o->V[o->rank + k + o->ncol * i];
    unpack(o, x, speeds);
}

// ---- bodies -------------------------------------------------------------------------------------

// I v for the inertia of body b in axes that are turned by R
static struct vector inertia_times(const struct body *b, struct axes R, struct vector v)
{
    const double *J = b->inertia;
    const struct vector p = turned_back(R, v);
    const struct vector h = {{J[0] * p.e[0] + J[3] * p.e[1] + J[4] * p.e[2],
                              J[3] * p.e[0] + J[1] * p.e[1] + J[5] * p.e[2],
                              J[4] * p.e[0] + J[5] * p.e[1] + J[2] * p.e[2]}};
    return turned(R, h);
}

// Force and moment about the frame's origin that give body b the acceleration a, alpha: Newton and
// Euler, with what gravity gives taken off.
static void wrench(const struct scene *s, int b, const struct motion *m, struct vector a,
                   struct vector alpha, struct vector *force, struct vector *moment)
{
    const struct body *p = &s->body[b];
    const struct vector c = turned(m->body[b].R, p->com), w = m->w[b];
    struct vector ac = plus(a, 1, cross(alpha, c));
    ac = plus(ac, 1, cross(w, cross(w, c)));
    *force = scaled(p->mass, plus(ac, -1, s->gravity));
    *moment = plus(cross(c, *force), 1, inertia_times(p, m->body[b].R, alpha));
    *moment = plus(*moment, 1, cross(w, inertia_times(p, m->body[b].R, w)));
}

// r = M x - f for unknowns x, in the units of the columns
static void balance(const struct oracle *o, const struct motion *m, const double *x, double *r)
{
    const struct scene *s = o->s;
    struct motion a;
    unpack(o, x, &a);
    for (int b = 1; b < s->nbody; b++) {
        struct vector force, moment;
        wrench(s, b, m, a.v[b], a.w[b], &force, &moment);
        for (int i = 0; i < 3; i++) {
            r[6 * (b - 1) + i] = force.e[i] * o->size;
            r[6 * (b - 1) + 3 + i] = moment.e[i];
        }
    }
    for (int j = 0; j < s->njoint; j++) {
        const struct joint *p = &s->joint[j];
        const int n = joint_speeds(p->type);
        for (int i = 0; i < n; i++)
            r[o->column[j] + i] = 0;
        if (n == 1)
            r[o->column[j]]
                = -(p->effort - p->stiffness * (m->q[j][0] - p->rest) - p->damping * m->u[j][0])
                * oracle_unit(o, j, 0);
    }
}

// Z' (M x - f)
static void balance_freedoms(const struct oracle *o, const struct motion *m, const double *x,
                             double *out)
{
    double r[MOST_COLUMNS];
    balance(o, m, x, r);
    for (int k = 0; k < o->freedoms; k++) {
        out[k] = 0;
        for (int i = 0; i < o->ncol; i++)
            out[k] += o->V[o->rank + k + o->ncol * i] * r[i];
    }
}

// z = A^-1 b for a symmetric matrix by its eigenvectors, which overwrite A
static bool solve_symmetric(double *A, int n, const double *b, double *z, double *condition)
{
    double w[MOST_COLUMNS];
    const int lwork = 34 * n + 10, lda = n > 0 ? n : 1;
    double *work = numbers(lwork);
    int info;
    dsyev_("V", "U", &n, A, &lda, w, work, &lwork, &info, 1, 1);
    free(work);
    *condition = n ? w[n - 1] / w[0] : 1;
    if (info || (n && !(w[0] > 0)))
        return false;
    memset(z, 0, sizeof(double) * (size_t)n);
    for (int k = 0; k < n; k++) {
        double f = 0;
        for (int i = 0; i < n; i++)
            f += A[i + n * k] * b[i];
        for (int i = 0; i < n; i++)
            z[i] += f / w[k] * A[i + n * k];
    }
    return true;
}

bool oracle_accelerations(const struct oracle *o, const struct motion *m, struct motion *a,
                          double *condition)
{
    const int n = o->freedoms;
    double x[MOST_COLUMNS], at[MOST_COLUMNS], b[MOST_COLUMNS], z[MOST_COLUMNS],
        moved[MOST_COLUMNS];
    double *A = numbers(n * n);
    least_solution(o, o->c, x);
    balance_freedoms(o, m, x, b);
    for (int k = 0; k < n;
         k++) { // the balance is linear in x: column k of Z' M Z by a step along Z
        for (int i = 0; i < o->ncol; i++)
            moved[i] = x[i] + o->V[o->rank + k + o->ncol * i];
        balance_freedoms(o, m, moved, at);
        for (int i = 0; i < n; i++)
            A[i + n * k] = at[i] - b[i];
    }
    for (int i = 0; i < n; i++)
        b[i] = -b[i];
    const bool ok = solve_symmetric(A, n, b, z, condition);
    for (int k = 0; k < n && ok; k++)
        for (int i = 0; i < o->ncol; i++)
            x[i] += z[k] * o->V[o->rank + k + o->ncol * i];
    unpack(o, x, a);
    free(A);
    return ok;
}

// ---- finite motion ------------------------------------------------------------------------------

// q <- q Rot(w) for a rotation vector w in axes of the turned frame
static void turn_quaternion(double q[4], const double w[3])
{
    const double angle = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    const double f = angle > 0 ? sin(angle / 2) / angle : 0.5, c = cos(angle / 2);
    const double x = f * w[0], y = f * w[1], z = f * w[2];
    const double p[4] = {q[0], q[1], q[2], q[3]};
    q[0] = p[0] * c - p[1] * x - p[2] * y - p[3] * z;
    q[1] = p[0] * x + p[1] * c + p[2] * z - p[3] * y;
    q[2] = p[0] * y + p[2] * c + p[3] * x - p[1] * z;
    q[3] = p[0] * z + p[3] * c + p[1] * y - p[2] * x;
}

static void advance(const struct scene *s, struct motion *m, const struct motion *speeds,
                    double h)
{
    for (int b = 1; b < s->nbody; b++) {
        m->body[b].at = plus(m->body[b].at, h, speeds->v[b]);
        m->body[b].R = product(rotation_by(scaled(h, speeds->w[b])), m->body[b].R);
    }
    for (int j = 0; j < s->njoint; j++) {
        const enum joint_type type = s->joint[j].type;
        const int n = joint_speeds(type) - 3 * joint_has_quaternion(type);
        double w[3];
        for (int i = 0; i < n; i++)
            m->q[j][i] += h * speeds->u[j][i];
        for (int i = 0; i < 3 && joint_has_quaternion(type); i++)
            w[i] = h * speeds->u[j][n + i];
        if (joint_has_quaternion(type))
            turn_quaternion(m->q[j] + n, w);
    }
}

bool oracle_move(const struct scene *s, struct motion *m, const struct motion *speeds, double h)
{
    advance(s, m, speeds, h);
    for (int k = 0; k < 12; k++) {
        struct oracle o;
        struct residual r;
        struct motion step;
        double x[MOST_COLUMNS];
        open_with(&o, s, m, &r);
        least_solution(&o, r.position, x);
        unpack(&o, x, &step);
        const bool is_closed = o.position < 1e-12;
        close_residual(&r);
        oracle_close(&o);
        if (is_closed)
            return true;
        advance(s, m, &step, -1);
    }
    return false;
}
