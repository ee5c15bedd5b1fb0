// See beam_error_coupled.h.
#include "beam_error/beam_error_coupled.h"
#include "base/pi.h"
#include "expr/tape.h"
#include "formulate/dynamics/dynamics.h"
#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/stage.h"
#include "numeric/dense.h"

#include <math.h>
#include <string.h>

enum {
    MOST = CT_BEAM_ERROR_COUPLED_MOST,
    SIZE = MOST + CT_BENDING_SHAPES,
    MOST_BODIES = 40,   // Limit: of the time of an estimate; larger systems: beam alone
    MOST_SWITCHES = 16, // Limit: the same
    MOST_STEPS = 100,   // Limit: steps of one call of ct_beam_error_coupled_advance
    PASSES = 4,         // Limit: fixed-point iterations of the midpoint rule
    BASE = 9,  // Definition: angular velocity, velocity, weight per mass; axes of the beam
    MOTION = 6 // Definition: their rates
};

struct ct_beam_error_coupled {
    int nq, nu, nshape, nswitch, nentry;
    bool is_free;               // the motion of the base depends on more than time
    const struct ct_tape *tape; // M, Q, q', base, V' with u' = 0, B (6 x nu), g of the modes
    int nout;
    int row[MOST * (MOST + 1) / 2], column[MOST * (MOST + 1) / 2]; // of M
    double *value;                                                 // of symbols at the start
    size_t nvalue, time, *q_slot, *u_slot, switch_slot[MOST_SWITCHES];
    enum ct_op switch_op[MOST_SWITCHES];
    double *start; // q, u
};

struct ct_beam_error_coupled_run {
    const struct ct_beam_error_coupled *p;
    double *value, *work, *out, *q, *u; // q, u: of all beam models in turn
    double *rate, *du;                  // q', u' of their last steps
    double largest;                     // |eta|
    double frequency_factor; // factor on frequencies of clamped shapes for a base that yields
    bool has_failed;
};

// ---- the system with rigid beams ----------------------------------------------------------------

static struct ct_build *rigid_system(struct ct_build *b)
{
    const struct ct_formulate_options o = {.tree = CT_TREE_JOINTS, .rigid = true};
    struct ct_tree_report unused = {0};
    if (b->rigid || b->has_no_rigid || b->model->nbody > MOST_BODIES)
        return b->rigid;
    b->has_no_rigid = true;
    struct ct_build *r = ct_build_create(b->ctx, b->arena, b->model, &o, NULL);
    if (!ct_build_choose_trees(&r, &o, &unused) || !(r->is_derived || ct_build_derive(r, true)))
        return NULL;
    if (r->eqs->nrow || r->eqs->nstate || r->eqs->nu > MOST || r->eqs->nmemory
        || r->eqs->nswitch > MOST_SWITCHES)
        return NULL;
    ct_dynamics_derive(r);
    return b->rigid = r;
}

static bool is_smooth(const struct ct_build *r)
{
    for (size_t i = 0; i < r->eqs->nswitch; i++)
        if (!r->eqs->switches[i].is_time)
            return false;
    for (size_t i = 0; i < r->eqs->ndriver; i++)
        if (ct_ex_kinds(r->x, r->eqs->driver[i].value) & 1u << CT_SYM_SWITCH)
            return false;
    return !r->x->ntable;
}

static double initial(const struct ct_build *r, const struct ct_value *v, int place)
{
    const bool given = v->given && (size_t)place < v->n && !(v->hole && v->hole[place]);
    return given ? ct_model_number(r->model, v->e[place]) : 0;
}

// Find q and u at the start from the joints. False if a quaternion is given by rotations.
static bool find_start(const struct ct_build *r, double *start)
{
    const struct ct_equations *e = r->eqs;
    for (size_t i = 0; i < e->nq; i++)
        start[i] = e->q[i].quaternion == 0;
    for (size_t i = 0; i < r->topology->ncoordinate; i++) {
        const struct ct_coordinate *c = &r->kinematics->coordinate[i];
        const struct ct_edge_info *edge = &r->topology->edge[c->edge];
        if (edge->kind != CT_EDGE_JOINT)
            continue;
        const struct ct_initial *at = &edge->self->initial;
        const bool turns = c->q >= 0 && e->q[c->q].quaternion >= 0;
        if (at->rotate.given || (turns && at->q.given)
            || (c->q < 0 && !c->is_driven && (at->q.given || at->u.given)))
            return false;
        if (c->q >= 0 && !turns)
            start[c->q] = initial(r, &at->q, c->index);
        if (c->u >= 0)
            start[e->nq + (size_t)c->u] = initial(r, &at->u, c->index);
    }
    return true;
}

// ---- numbers ------------------------------------------------------------------------------------

struct outputs {
    ct_ex *e;
    int n;
};

static void add_output(struct outputs *o, ct_ex e)
{
    o->e[o->n++] = e;
}

static void add_base_outputs(struct ct_build *r, const struct ct_flexible *f, struct outputs *o)
{
    struct ct_exs *x = r->x;
    ct_ex3 base[3];
    ct_flexible_base_motion(r, f, base);
    for (int k = 0; k < BASE; k++)
        add_output(o, base[k / 3].e[k % 3]);
    for (int k = 0; k < MOTION; k++)
        add_output(o, ct_build_rate(r, base[k / 3].e[k % 3]));
    for (size_t j = 0; j < r->eqs->nu; j++)
        for (int k = 0; k < MOTION; k++)
            add_output(o, ct_ex_diff(x, base[k / 3].e[k % 3], r->eqs->u[j].symbol));
}

static void compile(struct ct_build *r, const struct outputs *o,
                    struct ct_beam_error_coupled *p)
{
    struct ct_arena *a = r->arena;
    const struct ct_exs *x = r->x;
    ct_ex *in = CT_NEWN(a, ct_ex, x->nsym + 1);
    size_t n = 0, *slot = CT_NEWN(a, size_t, x->nsym + 1);
    for (uint32_t id = 0; id < x->nnode; id++)
        if (x->node[id].op == CT_OP_SYM) {
            slot[n] = x->node[id].a;
            in[n++] = (ct_ex){id};
        }
    p->nout = o->n;
    p->tape = ct_tape_compile(a, x, o->e, (size_t)o->n, in, slot, n);
    p->nvalue = x->nsym + 1;
    p->value = CT_NEWN(a, double, p->nvalue);
    memcpy(p->value, r->value, r->model->x->nsym * sizeof *p->value);
}

const struct ct_beam_error_coupled *ct_beam_error_coupled_create(struct ct_build *b,
                                                                 const struct ct_flexible *f,
                                                                 const struct ct_validity *v)
{
    const unsigned known = 1u << CT_SYM_TIME | 1u << CT_SYM_PARAM | 1u << CT_SYM_Q
                         | 1u << CT_SYM_U | 1u << CT_SYM_SWITCH;
    struct ct_build *r = rigid_system(b);
    if (!r || !is_smooth(r))
        return NULL;
    const struct ct_equations *e = r->eqs;
    struct ct_beam_error_coupled *p = CT_NEW(b->arena, struct ct_beam_error_coupled);
    *p = (struct ct_beam_error_coupled){
        .nq = (int)e->nq, .nu = (int)e->nu, .nshape = v->nshape};
    p->start = CT_NEWN(b->arena, double, e->nq + e->nu + 1);
    if (!find_start(r, p->start))
        return NULL;
    struct outputs o
        = {CT_NEWN(b->arena, ct_ex,
                   e->nM + e->nu + e->nq + BASE + MOTION * (1 + e->nu) + e->nswitch),
           0};
    p->nentry = (int)e->nM;
    for (size_t i = 0; i < e->nM; i++) {
        p->row[i] = e->M[i].row;
        p->column[i] = e->M[i].column;
        add_output(&o, e->M[i].value);
    }
    for (size_t i = 0; i < e->nu; i++)
        add_output(&o, e->Q[i]);
    for (size_t i = 0; i < e->nq; i++)
        add_output(&o, e->q[i].rate);
    const int base = o.n;
    add_base_outputs(r, ct_flexible_of(r, f->body), &o);
    for (int k = 0; k < BASE; k++)
        p->is_free
            |= (ct_ex_kinds(r->x, o.e[base + k]) & (1u << CT_SYM_Q | 1u << CT_SYM_U)) != 0;
    p->nswitch = (int)e->nswitch;
    for (size_t i = 0; i < e->nswitch; i++)
        add_output(&o, e->switches[i].g);
    for (int i = 0; i < o.n; i++)
        if (ct_ex_kinds(r->x, o.e[i]) & ~known)
            return NULL;
    compile(r, &o, p);
    p->time = ct_ex_node(r->x, r->model->time)->a;
    p->q_slot = CT_NEWN(b->arena, size_t, e->nq + 1);
    p->u_slot = CT_NEWN(b->arena, size_t, e->nu + 1);
    for (size_t i = 0; i < e->nq; i++)
        p->q_slot[i] = ct_ex_node(r->x, e->q[i].symbol)->a;
    for (size_t i = 0; i < e->nu; i++)
        p->u_slot[i] = ct_ex_node(r->x, e->u[i].symbol)->a;
    for (size_t i = 0; i < e->nswitch; i++) {
        p->switch_slot[i] = ct_ex_node(r->x, e->switches[i].symbol)->a;
        p->switch_op[i] = e->switches[i].op;
    }
    return p;
}

bool ct_beam_error_coupled_is_free(const struct ct_beam_error_coupled *p)
{
    return p->is_free;
}

struct ct_beam_error_coupled_run *
ct_beam_error_coupled_run_create(struct ct_arena *a, const struct ct_beam_error_coupled *p)
{
    struct ct_beam_error_coupled_run *r = CT_NEW(a, struct ct_beam_error_coupled_run);
    *r = (struct ct_beam_error_coupled_run){.p = p};
    r->value = CT_NEWN(a, double, p->nvalue);
    r->work = CT_NEWN(a, double, ct_tape_work(p->tape) + 1);
    r->out = CT_NEWN(a, double, p->nout);
    r->q = CT_NEWN(a, double, CT_BEAM_MODELS * p->nq + 1);
    r->u = CT_NEWN(a, double, CT_BEAM_MODELS * p->nu + 1);
    r->rate = CT_NEWN(a, double, CT_BEAM_MODELS * p->nq + 1);
    r->du = CT_NEWN(a, double, CT_BEAM_MODELS * p->nu + 1);
    return r;
}

// ---- a step -------------------------------------------------------------------------------------

struct system_state { // the multibody system of one beam model at one instant
    const double *Q, *rate, *base, *bias, *B;
};

// Evaluate the system; switches have their values at time t.
static struct system_state evaluate_system(struct ct_beam_error_coupled_run *r, double t,
                                           const double *q, const double *u)
{
    const struct ct_beam_error_coupled *p = r->p;
    const double *g = r->out + p->nout - p->nswitch;
    r->value[p->time] = t;
    for (int i = 0; i < p->nq; i++)
        r->value[p->q_slot[i]] = q[i];
    for (int i = 0; i < p->nu; i++)
        r->value[p->u_slot[i]] = u[i];
    bool again = true;
    for (int pass = 0; again && pass <= p->nswitch; pass++) {
        again = false;
        ct_tape_eval(p->tape, r->value, r->out, r->work);
        for (int i = 0; i < p->nswitch && !again; i++) {
            const double now = ct_op_apply(p->switch_op[i], g[i], 0, 0);
            again = now != r->value[p->switch_slot[i]];
            r->value[p->switch_slot[i]] = now;
        }
    }
    struct system_state s = {.Q = r->out + p->nentry};
    s.rate = s.Q + p->nu;
    s.base = s.rate + p->nq;
    s.bias = s.base + BASE;
    s.B = s.bias + MOTION;
    return s;
}

static void cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

// w x (w x v)
static void cross_twice(double out[3], const double w[3], const double v[3])
{
    double once[3];
    cross(once, w, v);
    cross(out, w, once);
}

// Add the torque and force on the base by the deflection of a shape, without the part of x''. V:
// velocity of the base; A: its angular acceleration, and the acceleration of its origin less
// gravity, in full although axes turn.
static void add_reaction(double out[MOTION], const struct ct_beam_mode *s, const double x[2],
                         const double *V, const double A[MOTION])
{
    const double along[3] = {1, 0, 0}, d[3] = {0, s->is_z ? 0 : x[0], s->is_z ? x[0] : 0},
                 v[3] = {0, s->is_z ? 0 : x[1], s->is_z ? x[1] : 0};
    double euler[3], coriolis[3], radial[3], c[3], turned[3], spread[3], moment[3];
    cross(euler, A, d);
    cross(coriolis, V, v);
    cross_twice(radial, V, d);
    for (int k = 0; k < 3; k++)
        c[k] = euler[k] + 2 * coriolis[k] + radial[k];
    cross(moment, along, c); // moment of the deflection's inertia along x
    cross(turned, A, along);
    cross_twice(spread, V, along);
    for (int k = 0; k < 3; k++) {
        out[k] += s->mass[1] * moment[k];
        out[3 + k] += s->mass[0] * c[k];
        turned[k] = s->mass[0] * A[3 + k] + s->mass[1] * (turned[k] + spread[k]);
    }
    cross(moment, d, turned); // moment of the force that acts on the section
    for (int k = 0; k < 3; k++)
        out[k] += moment[k];
}

struct middle { // midpoint of a step
    double u[MOST], du[MOST];
    double x[CT_BENDING_SHAPES][2], dv[CT_BENDING_SHAPES];
};

// Accelerations at the midpoint m of a step h from u, x: m->du, m->dv.
static bool accelerate(struct ct_beam_error_coupled_run *r, const struct ct_beam_error_modal *s,
                       int model, double h, const struct system_state *now, const double x[][2],
                       struct middle *m)
{
    const struct ct_beam_error_coupled *p = r->p;
    const int nu = p->nu, n = nu + s->n;
    double S[SIZE * SIZE] = {0}, b[SIZE], A[MOTION], reaction[MOTION] = {0};
    int pivot[SIZE];
    memcpy(A, now->bias, sizeof A);
    for (int j = 0; j < nu; j++)
        for (int k = 0; k < MOTION; k++)
            A[k] += now->B[k + MOTION * j] * m->du[j];
    const double along = A[3];
    double whole[MOTION]; // accelerations of the origin, less weight
    memcpy(whole, A, sizeof A);
    cross(whole + 3, now->base, now->base + 3);
    for (int k = 3; k < MOTION; k++)
        whole[k] += A[k] - now->base[3 + k];
    for (int i = 0; i < s->n; i++)
        add_reaction(reaction, &s->shape[i], m->x[i], now->base, whole);
    for (int i = 0; i < p->nentry; i++)
        S[p->row[i] + n * p->column[i]] = S[p->column[i] + n * p->row[i]] = r->out[i];
    for (int j = 0; j < nu; j++) {
        b[j] = now->Q[j];
        for (int k = 0; k < MOTION; k++)
            b[j] -= now->B[k + MOTION * j] * reaction[k];
    }
    const struct ct_beam_mode_base_rotation turn
        = {now->base[0], A[0], now->base[1] * now->base[2]};
    for (int i = 0; i < s->n; i++) {
        const struct ct_beam_mode *shape = &s->shape[i];
        const double more = ct_beam_mode_stiffening(shape, now->base)
                          - shape->omega2 * shape->eta_by_acceleration * along,
                     drawn = model == CT_BEAM_MODEL_LINEAR ? 0 : shape->shortening,
                     curved = model == CT_BEAM_MODEL_EXACT ? shape->curvature : 0,
                     q2 = m->x[i][0] * m->x[i][0],
                     W = shape->omega2 - ct_beam_mode_softening(shape->is_z, now->base)
                       + (model == CT_BEAM_MODEL_LINEAR ? 0 : more)
                       + drawn * m->x[i][1] * m->x[i][1] + 2 * curved * q2;
        if (model == CT_BEAM_MODEL_LINEAR)
            r->largest = fmax(r->largest, fabs(more) / shape->omega2);
        for (int j = 0; j < nu; j++)
            S[j + n * (nu + i)] = S[nu + i + n * j]
                = ct_beam_mode_base_momentum(shape, now->B + MOTION * j);
        S[(n + 1) * (nu + i)] = 1 + drawn * q2 + 0.5 * h * (shape->damping + 0.5 * h * W);
        b[nu + i] = ct_beam_mode_steady_force(shape, now->base)
                  - ct_beam_mode_base_momentum(shape, now->bias)
                  + ct_beam_mode_coupling(s, i, &turn, (const double(*)[2])m->x)
                  - shape->damping * x[i][1] - W * (x[i][0] + 0.5 * h * x[i][1]);
    }
    if (!ct_lu(S, pivot, n, n))
        return false;
    ct_lu_solve(b, S, pivot, n, n, 1, n, false);
    memcpy(m->du, b, (size_t)nu * sizeof *b);
    memcpy(m->dv, b + nu, (size_t)s->n * sizeof *b);
    return true;
}

// Relative change of the velocities of a step h in the last iteration.
static double relative_change(const struct ct_beam_error_coupled *p, int n,
                              const struct middle *m, const struct middle *before,
                              const double *u, double h)
{
    double change = 0, size = 0;
    for (int i = 0; i < p->nu; i++) {
        change = fmax(change, h * fabs(m->du[i] - before->du[i]));
        size = fmax(size, fmax(fabs(u[i]), h * fabs(m->du[i])));
    }
    const double of_base = size > 0 ? change / size : 0;
    change = size = 0;
    for (int i = 0; i < n; i++) {
        change = fmax(change, h * fabs(m->dv[i] - before->dv[i]));
        size = fmax(size, fmax(fabs(m->x[i][1]), h * fabs(m->dv[i])));
    }
    return fmax(of_base, size > 0 ? change / size : 0);
}

// One step of one beam model from t. False if the iteration does not converge.
static bool step(struct ct_beam_error_coupled_run *r, struct ct_beam_error_modal *s, int model,
                 double t, double h)
{
    // Default: a tenth of the error from which a linear beam is not valid, against further passes.
    // Test: beam_error_coupled
    const double converged = 1e-3;
    const struct ct_beam_error_coupled *p = r->p;
    double *q = r->q + model * p->nq, *u = r->u + model * p->nu, q_mid[2 * MOST],
           left = INFINITY;
    double(*x)[2] = s->x[model];
    struct middle m = {{0}};
    double *rate = r->rate + model * p->nq, *du = r->du + model * p->nu;
    for (int i = 0; i < p->nq; i++)
        q_mid[i] = q[i] + 0.5 * h * rate[i];
    for (int i = 0; i < p->nu; i++) {
        m.du[i] = du[i];
        m.u[i] = u[i] + 0.5 * h * du[i];
    }
    for (int i = 0; i < s->n; i++) {
        m.x[i][0] = x[i][0] + 0.5 * h * x[i][1];
        m.x[i][1] = x[i][1];
    }
    for (int pass = 0; pass < PASSES && !(left <= converged); pass++) {
        const struct system_state now = evaluate_system(r, t + 0.5 * h, q_mid, m.u);
        const struct middle before = m;
        if (!accelerate(r, s, model, h, &now, (const double(*)[2])x, &m))
            return false;
        for (int i = 0; i < p->nq; i++) {
            rate[i] = now.rate[i];
            q_mid[i] = q[i] + 0.5 * h * rate[i];
        }
        for (int i = 0; i < p->nu; i++)
            m.u[i] = u[i] + 0.5 * h * m.du[i];
        for (int i = 0; i < s->n; i++) {
            m.x[i][1] = x[i][1] + 0.5 * h * m.dv[i];
            m.x[i][0] = x[i][0] + 0.5 * h * m.x[i][1];
        }
        left = relative_change(p, s->n, &m, &before, u, h);
    }
    for (int i = 0; i < p->nu; i++) {
        du[i] = m.du[i];
        u[i] += h * du[i];
    }
    for (int i = 0; i < p->nq; i++)
        q[i] = 2 * q_mid[i] - q[i];
    for (int i = 0; i < s->n; i++) {
        x[i][0] += h * m.x[i][1];
        x[i][1] += h * m.dv[i];
    }
    return left <= converged;
}

// How far the base yields to the shapes: sum of p' B M^-1 B' p, which is near 1 for a light base.
static double base_compliance(const struct ct_beam_error_coupled_run *r,
                              const struct ct_beam_error_modal *s,
                              const struct system_state *now)
{
    const int n = r->p->nu;
    double M[MOST * MOST] = {0}, G[MOST], x[MOST], sum = 0;
    int pivot[MOST];
    for (int i = 0; i < r->p->nentry; i++)
        M[r->p->row[i] + n * r->p->column[i]] = M[r->p->column[i] + n * r->p->row[i]]
            = r->out[i];
    if (!ct_lu(M, pivot, n, n))
        return 1;
    for (int i = 0; i < s->n; i++) {
        for (int j = 0; j < n; j++)
            G[j] = x[j] = ct_beam_mode_base_momentum(&s->shape[i], now->B + MOTION * j);
        ct_lu_solve(x, M, pivot, n, n, 1, n, false);
        for (int j = 0; j < n; j++)
            sum += G[j] * x[j];
    }
    return sum;
}

void ct_beam_error_coupled_begin(struct ct_beam_error_coupled_run *r,
                                 struct ct_beam_error_modal *s)
{
    // Limit: of the number of steps: at most seven times as many
    const double most = 0.98; // 1/sqrt(1 - 0.98) = 7
    const struct ct_beam_error_coupled *p = r->p;
    memcpy(r->value, p->value, p->nvalue * sizeof *r->value);
    ct_tape_prepare(p->tape, r->value, r->work);
    for (int m = 0; m < CT_BEAM_MODELS; m++) {
        memcpy(r->q + m * p->nq, p->start, (size_t)p->nq * sizeof *r->q);
        memcpy(r->u + m * p->nu, p->start + p->nq, (size_t)p->nu * sizeof *r->u);
    }
    const struct system_state now = evaluate_system(r, 0, r->q, r->u);
    memcpy(s->base, now.base, sizeof s->base);
    memset(r->rate, 0, (size_t)(CT_BEAM_MODELS * p->nq) * sizeof *r->rate);
    memset(r->du, 0, (size_t)(CT_BEAM_MODELS * p->nu) * sizeof *r->du);
    r->largest = 0;
    r->has_failed = false;
    r->frequency_factor = 1 / sqrt(1 - fmin(most, base_compliance(r, s, &now)));
    s->t = 0;
    s->has_begun = true;
    ct_beam_error_modal_record(s);
}

// Shortest useful step: faster motion need not be resolved.
static double shortest_step(const struct ct_beam_error_modal *s)
{
    // Derived: the midpoint rule lowers a frequency by the part (2 pi/256)^2/12 = 5e-5
    const double per_period = 256;
    double slowest = INFINITY;
    for (int i = 0; i < s->n; i++)
        slowest = fmin(slowest, s->shape[i].omega2);
    return 2 * CT_PI / sqrt(slowest) / per_period;
}

void ct_beam_error_coupled_advance(struct ct_beam_error_coupled_run *r,
                                   struct ct_beam_error_modal *s, double t, double interval)
{
    const double from
        = s->t,
        // Derived: 1e-9 exceeds the round-off of times: a whole number of steps stays it
        asked = ceil((t - from) / fmax(interval / r->frequency_factor, shortest_step(s))
                     * (1 - 1e-9)),
        n = fmin(asked, MOST_STEPS);
    for (double i = 0; i < n && !r->has_failed; i++) {
        for (int m = 0; m < CT_BEAM_MODELS; m++)
            r->has_failed |= !step(r, s, m, from + i / n * (t - from), (t - from) / n);
        ct_beam_error_modal_record(s);
    }
    s->t = t;
    if (r->has_failed
        && !(s->error[CT_BEAM_MODEL_LINEAR] > CT_ESTIMATED_ERROR_LIMIT * s->deflection))
        s->deflection = NAN;
}

double ct_beam_error_coupled_indicator(const struct ct_beam_error_coupled_run *r)
{
    return r->largest;
}
