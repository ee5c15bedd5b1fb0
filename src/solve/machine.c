// See machine.h.
#include "solve/machine.h"
#include "solve/tangent.h"

#include <math.h>
#include <string.h>

// ---- inputs ---------------------------------------------------------------------------------------

struct inputs {
    ct_ex *symbol;
    size_t *slot;
    size_t n;
};

// Where the value of a symbol stands; false for trial symbols and signals, which do not reach the equations.
static bool find_slot(const struct ct_machine *m, const struct ct_sym *s, size_t *slot)
{
    switch (s->kind) {
    case CT_SYM_TIME:
        *slot = 0;
        return true;
    case CT_SYM_PARAM:
        *slot = 1 + s->index;
        return true;
    case CT_SYM_Q:
        *slot = m->at_q + s->index;
        return true;
    case CT_SYM_U:
        *slot = m->at_u + s->index;
        return true;
    case CT_SYM_A:
        *slot = m->at_a + s->index;
        return true;
    case CT_SYM_LAM:
        *slot = m->at_lam + s->index;
        return true;
    case CT_SYM_MODE:
        *slot = m->at_mode + s->index;
        return true;
    case CT_SYM_MEMORY:
        *slot = m->at_memory + s->index;
        return true;
    case CT_SYM_WORK:
        *slot = m->at_work;
        return true;
    case CT_SYM_SEED: // behind the input: of tangents alone
        *slot = m->ninput + s->index;
        return true;
    case CT_SYM_LOCAL:
    case CT_SYM_SIGNAL:
        break;
    }
    return false;
}

void ct_machine_values(const struct ct_machine *m, const struct ct_exs *x, double *value)
{
    for (size_t k = 0; k < x->nsym; k++) {
        size_t slot;
        value[k] = find_slot(m, &x->sym[k], &slot) && slot < m->ninput ? m->input[slot] : NAN;
    }
}

// Every symbol of the store that a run gives a value, with its slot.
static struct inputs list_inputs(struct ct_arena *a, const struct ct_machine *m,
                                 const struct ct_exs *x)
{
    struct inputs in = {CT_NEWN(a, ct_ex, x->nsym + 1), CT_NEWN(a, size_t, x->nsym + 1), 0};
    for (uint32_t id = 0; id < x->nnode; id++) {
        size_t slot;
        if (x->node[id].op != CT_OP_SYM || !find_slot(m, &x->sym[x->node[id].a], &slot))
            continue;
        in.symbol[in.n] = (ct_ex){id};
        in.slot[in.n++] = slot;
    }
    return in;
}

static void compile_from(struct ct_arena *a, const struct ct_exs *x, const struct inputs *in,
                         const ct_ex *out, size_t n, enum ct_fuse fuse, struct ct_program *p)
{
    p->listing = ct_listing_create(a, x, out, n, in->symbol, in->slot, in->n, fuse);
    p->out = CT_NEWN(a, double, n + 1);
    p->nout = n;
}

static void compile(struct ct_arena *a, const struct ct_machine *m, const struct inputs *in,
                    const ct_ex *out, size_t n, struct ct_program *p)
{
    compile_from(a, m->e->x, in, out, n, CT_FUSE_NO, p);
}

static void prepare(struct ct_program *p, const double *input)
{
    if (p->native)
        ct_native_prepare(p->native, input, p->work);
    else if (p->tape)
        ct_tape_prepare(p->tape, input, p->work);
}

void ct_program_run(struct ct_program *p, const double *input)
{
    if (p->nout && p->native)
        ct_native_eval(p->native, input, p->out, p->work);
    else if (p->nout)
        ct_tape_eval(p->tape, input, p->out, p->work);
}

// The two ways keep different things in the work array. A tape is made only where it is run.
static void use(struct ct_arena *a, struct ct_program *p, struct ct_native *native)
{
    if (p->work && !p->native == !native)
        return;
    if (!native && !p->tape)
        p->tape = ct_tape_create(a, p->listing);
    p->native = native;
    const size_t n = native ? ct_native_work(native) : ct_tape_work(p->tape);
    p->work = ct_arena_line(a, (n + 1) * sizeof *p->work);
}

// Native code where it is wanted and available; false if it is not available.
static bool choose_backend(struct ct_arena *a, struct ct_machine *m, struct ct_program *p)
{
    struct ct_native *native = NULL;
    if (m->asked != CT_BACKEND_TAPE)
        native = p->native ? p->native : ct_native_create(a, p->listing, 1);
    use(a, p, native);
    prepare(p, m->input);
    return native != NULL;
}

bool ct_machine_use(struct ct_arena *a, struct ct_machine *m, enum ct_backend backend)
{
    struct ct_program *const all[] = {&m->motion, &m->constraint, &m->solved, &m->power,
                                      &m->memory, &m->residual,   &m->tangent};
    bool available = ct_native_is_available(1);
    m->asked = backend;
    for (size_t i = 0; i < COUNT(all); i++)
        if (all[i]->nout)
            available &= choose_backend(a, m, all[i]);
    for (struct ct_program *p = m->apart; p; p = p->next)
        available &= choose_backend(a, m, p);
    if (m->lanes)
        ct_tangent_lanes_use(a, m->lanes, m->asked != CT_BACKEND_TAPE, m->input);
    m->backend = m->asked != CT_BACKEND_TAPE && available ? "native" : "tape";
    return available || backend != CT_BACKEND_NATIVE;
}

static void compile_apart(struct ct_arena *a, struct ct_machine *m, const struct ct_exs *x,
                          const ct_ex *out, size_t n, enum ct_fuse fuse, struct ct_program *p)
{
    const struct inputs in = list_inputs(a, m, x);
    *p = (struct ct_program){.next = m->apart};
    compile_from(a, x, &in, out, n, fuse, p);
    choose_backend(a, m, p);
    m->apart = p;
}

void ct_machine_compile(struct ct_arena *a, struct ct_machine *m, const struct ct_exs *x,
                        const ct_ex *out, size_t n, struct ct_program *p)
{
    compile_apart(a, m, x, out, n, CT_FUSE_NO, p);
}

void ct_machine_compile_solution(struct ct_arena *a, struct ct_machine *m,
                                 const struct ct_exs *x, const ct_ex *out, size_t n,
                                 struct ct_program *p)
{
    compile_apart(a, m, x, out, n, CT_FUSE_NATIVE, p);
}

void ct_machine_forget(struct ct_machine *m, const struct ct_program *p)
{
    for (struct ct_program **at = &m->apart; *at; at = &(*at)->next)
        if (*at == p) {
            *at = p->next;
            return;
        }
}

// ---- programs ---------------------------------------------------------------------------------------

struct list {
    struct ct_arena *a;
    ct_ex *e;
    size_t n, cap;
};

static void push(struct list *l, ct_ex e)
{
    CT_PUSH(l->a, l->e, l->n, l->cap, e);
}

static void compile_motion(struct ct_arena *a, struct ct_machine *m, const struct inputs *in)
{
    const struct ct_equations *e = m->e;
    struct list l = {.a = a};
    for (size_t i = 0; i < e->nM; i++)
        push(&l, e->M[i].value);
    for (size_t i = 0; i < e->nu; i++)
        push(&l, e->has_dynamics ? e->Q[i] : CT_EX_ZERO);
    for (size_t i = 0; i < e->nJ; i++)
        push(&l, e->J[i].value);
    for (size_t i = 0; i < e->nrow; i++)
        push(&l, e->row[i].gam);
    for (size_t i = 0; i < e->nq; i++)
        push(&l, e->q[i].rate);
    compile(a, m, in, l.e, l.n, &m->motion);
}

static void compile_solved(struct ct_arena *a, struct ct_machine *m, const struct inputs *in)
{
    const struct ct_equations *e = m->e;
    struct list l = {.a = a};
    for (size_t i = 0; i < e->nu && e->solution; i++)
        push(&l, e->solution[i]);
    for (size_t i = 0; i < e->nq && e->solution; i++)
        push(&l, e->q[i].rate);
    for (size_t i = 0; i < e->nu && e->solution; i++)
        push(&l, e->pivot[i]);
    compile_from(a, m->e->x, in, l.e, l.n, CT_FUSE_NATIVE, &m->solved);
}

static void compile_constraint(struct ct_arena *a, struct ct_machine *m,
                               const struct inputs *in)
{
    const struct ct_equations *e = m->e;
    struct list l = {.a = a};
    for (size_t i = 0; i < e->nrow; i++)
        push(&l, e->row[i].phi);
    for (size_t i = 0; i < e->nrow; i++)
        push(&l, e->row[i].v);
    for (size_t i = 0; i < e->nJ; i++)
        push(&l, e->J[i].value);
    compile(a, m, in, l.e, l.n, &m->constraint);
}

static void compile_rest(struct ct_arena *a, struct ct_machine *m, const struct inputs *in)
{
    const struct ct_equations *e = m->e;
    struct list result = {.a = a}, root = {.a = a}, memory = {.a = a}, momentum = {.a = a},
                driver = {.a = a}, wanted = {.a = a}, turns = {.a = a};
    for (size_t i = 0; i < e->nresult; i++)
        push(&result, e->result[i].value);
    for (size_t i = 0; i < e->nmode; i++)
        push(&root, e->mode[i].g);
    for (size_t i = 0; i < e->nmemory; i++)
        if (e->memory[i].kind == CT_MEMORY_TURNS) {
            push(&memory, e->memory[i].symbol);
            push(&turns, e->memory[i].update);
        } else {
            push(&memory, e->memory[i].update);
        }
    for (size_t i = 0; i < e->nmemory; i++) // rotations from which quaternions start
        for (int k = 0; k < 9 && e->memory[i].kind == CT_MEMORY_QUATERNION; k++)
            push(&memory, e->memory[i].R.e[k]);
    if (e->nmode || e->x->ntable) { // rates can jump
        ct_ex *u = CT_NEWN(a, ct_ex, e->nu + 1);
        for (size_t i = 0; i < e->nu; i++)
            u[i] = e->u[i].symbol;
        momentum.e = CT_NEWN(a, ct_ex, 2 * e->nu + 1);
        ct_ex_gradient(e->x, a, e->kinetic, u, e->nu, momentum.e);
        momentum.n = e->nu;
        if (!ct_ex_is_zero(e->kept)) {
            ct_ex_gradient(e->x, a, e->kept, u, e->nu, momentum.e + e->nu);
            momentum.n += e->nu;
        }
    }
    for (size_t i = 0; i < e->ndriver; i++) {
        push(&driver, e->driver[i].value);
        push(&driver, e->driver[i].rate);
    }
    for (size_t i = 0; i < e->nrow; i++)
        push(&wanted, e->row[i].wanted);
    const ct_ex energies[] = {e->kinetic, ct_ex_add(e->x, e->potential, e->strain)};
    compile(a, m, in, result.e, result.n, &m->result);
    compile(a, m, in, root.e, root.n, &m->root);
    compile(a, m, in, memory.e, memory.n, &m->memory);
    compile(a, m, in, turns.e, turns.n, &m->turns);
    compile(a, m, in, momentum.e, momentum.n, &m->momentum);
    compile(a, m, in, driver.e, driver.n, &m->driver);
    compile(a, m, in, wanted.e, wanted.n, &m->wanted);
    struct list validity = {.a = a};
    for (size_t i = 0; i < e->nvalidity; i++)
        push(&validity, e->validity[i].eta);
    for (size_t i = 0; i < e->nbend; i++)
        for (size_t k = 0; k < e->bend[i].n; k++)
            push(&validity, e->bend[i].square[k]);
    compile(a, m, in, validity.e, validity.n, &m->validity);
    compile(a, m, in, energies, 2, &m->energy);
    compile(a, m, in, &e->power, ct_ex_is_zero(e->power) ? 0 : 1, &m->power);
    // seldom run: not worth native code
    struct ct_program *const all[] = {&m->result, &m->root,   &m->turns,  &m->momentum,
                                      &m->driver, &m->wanted, &m->energy, &m->validity};
    for (size_t i = 0; i < COUNT(all); i++)
        if (all[i]->nout)
            use(a, all[i], NULL);
}

static void push_slopes(struct list *l, const struct ct_slope *s, size_t n)
{
    for (size_t i = 0; i < n; i++)
        push(l, s[i].value);
}

static void compile_residual(struct ct_arena *a, struct ct_machine *m, const struct inputs *in)
{
    const struct ct_equations *e = m->e;
    const struct ct_residual *f = e->residual && e->residual->has_slopes ? e->residual : NULL;
    struct list residual = {.a = a}, tangent = {.a = a};
    for (size_t i = 0; i < e->nu && f; i++)
        push(&residual, f->r[i]);
    for (size_t i = 0; i < e->nrow && f; i++)
        push(&residual, e->row[i].phi);
    for (size_t i = 0; i < e->nrow && f; i++)
        push(&residual, e->row[i].v);
    if (f && !f->along) {
        push_slopes(&tangent, f->dq, f->ndq);
        push_slopes(&tangent, f->du, f->ndu);
        push_slopes(&tangent, f->da, f->nda);
        push_slopes(&tangent, f->dv, f->ndv);
    }
    for (size_t i = 0; i < e->nJ && f; i++)
        push(&tangent, e->J[i].value);
    compile(a, m, in, residual.e, residual.n, &m->residual);
    compile(a, m, in, tangent.e, tangent.n, &m->tangent);
    m->slopes = m->tangent.out;
    m->nslope = tangent.n;
    if (!f || !f->along)
        return;
    const size_t own = f->ndq + f->ndu + f->nda + f->ndv;
    const struct ct_listing *l = ct_listing_create(a, e->x, f->along->rate, e->nu + e->nrow,
                                                   in->symbol, in->slot, in->n, CT_FUSE_NO);
    m->nslope = own + e->nJ;
    m->slopes = CT_NEWN(a, double, m->nslope + 1);
    m->lanes = ct_tangent_lanes_create(a, f, l, e->nu, m->ninput);
}

static void start_input(struct ct_machine *m)
{
    const struct ct_equations *e = m->e;
    memset(m->input, 0, m->ninput * sizeof *m->input);
    for (size_t i = 0; i < m->model->nparameter; i++)
        m->input[1 + i] = m->model->parameter[i].value;
    for (size_t i = 0; i < e->nmemory; i++)
        if (e->memory[i].kind == CT_MEMORY_QUATERNION && e->memory[i].place == 0)
            m->input[m->at_memory + i] = 1;
}

struct ct_machine *ct_machine_create(struct ct_arena *a, const struct ct_model *model,
                                     const struct ct_equations *e)
{
    struct ct_machine *m = CT_NEW(a, struct ct_machine);
    *m = (struct ct_machine){.e = e, .model = model, .nq = e->nq, .nu = e->nu, .nrow = e->nrow};
    m->at_q = 1 + model->nparameter;
    m->at_u = m->at_q + e->nq;
    m->at_a = m->at_u + e->nu;
    m->at_lam = m->at_a + e->nu;
    m->at_mode = m->at_lam + e->nrow;
    m->at_memory = m->at_mode + e->nmode;
    m->at_work = m->at_memory + e->nmemory;
    m->ninput = m->at_work + 1;
    m->input = CT_NEWN(a, double, m->ninput);
    start_input(m);

    const struct inputs in = list_inputs(a, m, m->e->x);
    compile_solved(a, m, &in);
    compile_motion(a, m, &in);
    compile_constraint(a, m, &in);
    compile_rest(a, m, &in);
    compile_residual(a, m, &in);
    m->M = CT_NEWN(a, double, (e->has_dynamics ? m->nu * m->nu : 0) + 1);
    m->J = CT_NEWN(a, double, m->nrow * m->nu + 1);
    m->g[0] = CT_NEWN(a, double, e->nmode + 1);
    m->g[1] = CT_NEWN(a, double, e->nmode + 1);
    m->turned = CT_NEWN(a, double, e->nmemory + 1);
    m->ahead = CT_NEWN(a, double, e->nq + e->nu + 1);
    m->moved = CT_NEWN(a, double, e->nu + 1);
    m->Q = m->motion.out + e->nM;
    m->gam = m->Q + e->nu + e->nJ;
    m->rate = m->gam + e->nrow;
    m->phi = m->constraint.out;
    m->v = m->phi + e->nrow;
    ct_machine_use(a, m, e->is_analysed ? CT_BACKEND_TAPE : CT_BACKEND_BEST);
    ct_machine_prepare(m);
    return m;
}

void ct_machine_add_residual(struct ct_arena *a, struct ct_machine *m)
{
    if (m->residual.nout)
        return;
    const struct inputs in = list_inputs(a, m, m->e->x);
    compile_residual(a, m, &in);
    ct_machine_use(a, m, m->asked);
}

enum { NPROGRAM = 15 };

static void list_programs(struct ct_machine *m, struct ct_program *list[NPROGRAM])
{
    struct ct_program *const all[NPROGRAM]
        = {&m->solved, &m->motion,   &m->constraint, &m->result,   &m->power,
           &m->energy, &m->root,     &m->memory,     &m->momentum, &m->driver,
           &m->wanted, &m->residual, &m->tangent,    &m->validity, &m->turns};
    memcpy(list, all, sizeof all);
}

void ct_machine_prepare(struct ct_machine *m)
{
    struct ct_program *all[NPROGRAM];
    list_programs(m, all);
    for (size_t i = 0; i < COUNT(all); i++)
        prepare(all[i], m->input);
    for (struct ct_program *p = m->apart; p; p = p->next)
        prepare(p, m->input);
    if (m->lanes)
        ct_tangent_lanes_prepare(m->lanes, m->input);
}

void ct_machine_prepare_motion(struct ct_machine *m)
{
    prepare(&m->motion, m->input);
    prepare(&m->constraint, m->input);
    prepare(&m->power, m->input);
}

static size_t code_size(const struct ct_program *p)
{
    return p->native ? ct_native_code_size(p->native) : 0;
}

size_t ct_machine_code_size(struct ct_machine *m)
{
    struct ct_program *all[NPROGRAM];
    size_t n = 0;
    list_programs(m, all);
    for (size_t i = 0; i < COUNT(all); i++)
        n += code_size(all[i]);
    for (const struct ct_program *p = m->apart; p; p = p->next)
        n += code_size(p);
    return n + (m->lanes ? ct_tangent_lanes_code_size(m->lanes) : 0);
}

void ct_machine_reset(struct ct_machine *m)
{
    start_input(m);
    ct_machine_prepare(m);
}

// ---- evaluation -------------------------------------------------------------------------------------

void ct_machine_set(struct ct_machine *m, double t, const double *y)
{
    m->input[0] = t;
    ct_machine_copy(m->input + m->at_q, y, m->nq + m->nu);
    m->input[m->at_work] = y[m->nq + m->nu];
}

static void scatter_J(struct ct_machine *m, const double *value)
{
    const struct ct_equations *e = m->e;
    for (size_t i = 0; i < e->nJ; i++)
        m->J[(size_t)e->J[i].row + m->nrow * (size_t)e->J[i].column] = value[i];
}

void ct_machine_motion(struct ct_machine *m)
{
    const struct ct_equations *e = m->e;
    m->evaluations++;
    ct_program_run(&m->motion, m->input);
    for (size_t i = 0; i < e->nM; i++) {
        const size_t r = (size_t)e->M[i].row, c = (size_t)e->M[i].column;
        m->M[r + m->nu * c] = m->M[c + m->nu * r] = m->motion.out[i];
    }
    scatter_J(m, m->Q + e->nu);
}

bool ct_machine_solved(struct ct_machine *m, double *a)
{
    if (!m->solved.nout)
        return false;
    m->evaluations++;
    ct_program_run(&m->solved, m->input);
    ct_machine_copy(a, m->solved.out, m->nu);
    ct_machine_copy(m->rate, m->solved.out + m->nu, m->nq);
    return true;
}

void ct_machine_constraint(struct ct_machine *m)
{
    ct_program_run(&m->constraint, m->input);
    scatter_J(m, m->v + m->nrow);
}

void ct_machine_tangent(struct ct_machine *m)
{
    const size_t nJ = m->tangent.nout;
    ct_program_run(&m->tangent, m->input);
    if (!m->lanes)
        return;
    ct_tangent_lanes_run(m->lanes, m->input, m->slopes);
    memcpy(m->slopes + m->nslope - nJ, m->tangent.out, nJ * sizeof *m->slopes);
}

double ct_machine_tangent_operations(const struct ct_machine *m)
{
    const struct ct_tape_counts c = m->tangent.listing->counts;
    return (double)(c.multiplications + c.additions + c.divisions + c.functions)
         + (m->lanes ? ct_tangent_lanes_operations(m->lanes) : 0);
}

// ---- retraction -------------------------------------------------------------------------------------

static void normalise4(double *p)
{
    const double norm = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
    for (int i = 0; i < 4 && norm > 0; i++)
        p[i] /= norm;
}

void ct_machine_normalise(const struct ct_machine *m, double *q)
{
    for (size_t i = 0; i < m->nq; i++)
        if (m->e->q[i].quaternion == 0)
            normalise4(q + i);
}

// p <- p o exp(d/2)
static void turn_quaternion(double *p, const double *d)
{
    const double angle = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    const double c = cos(angle / 2), s = angle > 0 ? sin(angle / 2) / angle : 0.5;
    const double v[3] = {s * d[0], s * d[1], s * d[2]}, w[4] = {p[0], p[1], p[2], p[3]};
    p[0] = w[0] * c - w[1] * v[0] - w[2] * v[1] - w[3] * v[2];
    p[1] = w[1] * c + w[0] * v[0] + w[2] * v[2] - w[3] * v[1];
    p[2] = w[2] * c + w[0] * v[1] + w[3] * v[0] - w[1] * v[2];
    p[3] = w[3] * c + w[0] * v[2] + w[1] * v[1] - w[2] * v[0];
    normalise4(p);
}

void ct_machine_retract(const struct ct_machine *m, double *q, const double *d)
{
    // quaternions and angular velocities follow each other in the same order
    size_t next = 0;
    for (size_t k = 0; k < m->nu; k++) {
        if (m->e->u[k].q >= 0) {
            q[m->e->u[k].q] += d[k];
            continue;
        }
        while (m->e->q[next].quaternion != 0)
            next++;
        turn_quaternion(q + next, d + k);
        next++;
        k += 2;
    }
}

// T^-1 = 1 + th~/2 + (1 - (t/2) cot(t/2))/t^2 th~^2, t = |th|
static void chart_rate3(double *rate, const double *th, const double *w)
{
    const double square = th[0] * th[0] + th[1] * th[1] + th[2] * th[2],
                 half = sqrt(square) / 2;
    // below a hundredth the series is right to rounding: its next term is t^4 / 30240
    const double c = half < 0.005 ? 1. / 12 + square / 720 : (1 - half / tan(half)) / square;
    const double x[3] = {th[1] * w[2] - th[2] * w[1], th[2] * w[0] - th[0] * w[2],
                         th[0] * w[1] - th[1] * w[0]};
    const double xx[3] = {th[1] * x[2] - th[2] * x[1], th[2] * x[0] - th[0] * x[2],
                          th[0] * x[1] - th[1] * x[0]};
    for (int i = 0; i < 3; i++)
        rate[i] = w[i] + x[i] / 2 + c * xx[i];
}

void ct_machine_chart_rate(const struct ct_machine *m, const double *d, const double *w,
                           double *rate)
{
    for (size_t k = 0; k < m->nu; k++) {
        if (m->e->u[k].q >= 0) {
            rate[k] = w[k];
            continue;
        }
        chart_rate3(rate + k, d + k, w + k);
        k += 2;
    }
}

// ---- memories ---------------------------------------------------------------------------------------

void ct_quaternion_of(const double *R, double *p)
{
    const double square[4] = {1 + R[0] + R[4] + R[8], 1 + R[0] - R[4] - R[8],
                              1 - R[0] + R[4] - R[8], 1 - R[0] - R[4] + R[8]};
    int k = 0;
    for (int i = 1; i < 4; i++)
        if (square[i] > square[k])
            k = i;
    const double s = 0.5 / sqrt(square[k]);
    const double skew[3] = {R[5] - R[7], R[6] - R[2], R[1] - R[3]};
    const double sum[3] = {R[5] + R[7], R[6] + R[2], R[1] + R[3]}; // yz, zx, xy
    p[k] = square[k] * s;
    if (k == 0) {
        for (int i = 0; i < 3; i++)
            p[1 + i] = skew[i] * s;
    } else {
        p[0] = skew[k - 1] * s;
        for (int i = 0; i < 3; i++)
            if (i != k - 1)
                p[1 + i] = sum[3 - (k - 1) - i] * s;
    }
    if (p[0] < 0)
        for (int i = 0; i < 4; i++)
            p[i] = -p[i];
}

void ct_memory_start(struct ct_machine *m)
{
    double *memory = m->input + m->at_memory;
    if (m->turns.nout)
        ct_program_run(&m->turns, m->input);
    for (size_t i = 0, k = 0; i < m->e->nmemory; i++)
        if (m->e->memory[i].kind == CT_MEMORY_TURNS)
            memory[i] = m->turns.out[k++];
    ct_program_run(&m->memory, m->input);
    const double *R = m->memory.out + m->e->nmemory;
    for (size_t i = 0; i < m->e->nmemory; i++) {
        if (m->e->memory[i].kind != CT_MEMORY_QUATERNION) {
            memory[i] = m->memory.out[i];
        } else {
            if (m->e->memory[i].place == 0)
                ct_quaternion_of(R, memory + i);
            R += 9;
        }
    }
}

void ct_memory_follow(struct ct_machine *m)
{
    double *memory = m->input + m->at_memory;
    if (!m->e->nmemory)
        return;
    ct_program_run(&m->memory, m->input);
    for (size_t i = 0; i < m->e->nmemory; i++) {
        if (ct_memory_is_followed(&m->e->memory[i]))
            memory[i] = m->memory.out[i];
        if (m->e->memory[i].kind == CT_MEMORY_QUATERNION && m->e->memory[i].place == 3)
            normalise4(memory + i - 3);
    }
}

static bool turns(const struct ct_machine *m)
{
    for (size_t i = 0; i < m->e->nmemory; i++)
        if (ct_memory_is_followed(&m->e->memory[i]))
            return true;
    return false;
}

double ct_memory_turning(struct ct_machine *m, double t, const double *y, double dt)
{
    const size_t n = m->e->nmemory;
    double most = 0, *now = m->turned;
    if (!turns(m))
        return 0;
    memcpy(m->ahead, y, (m->nq + m->nu) * sizeof *y);
    ct_machine_set(m, t, m->ahead);
    ct_program_run(&m->memory, m->input);
    memcpy(now, m->memory.out, n * sizeof *now);
    for (size_t i = 0; i < m->nu; i++)
        m->moved[i] = dt * y[m->nq + i];
    ct_machine_retract(m, m->ahead, m->moved);
    ct_machine_set(m, t + dt, m->ahead);
    ct_program_run(&m->memory, m->input);
    for (size_t i = 0; i < n; i++) {
        const bool is_half = m->e->memory[i].kind == CT_MEMORY_QUATERNION;
        if (ct_memory_is_followed(&m->e->memory[i]))
            most = fmax(most, (is_half ? 2 : 1) * fabs(m->memory.out[i] - now[i]) / dt);
    }
    return most;
}
