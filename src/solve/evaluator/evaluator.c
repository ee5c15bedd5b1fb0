// See evaluator.h.
#include "solve/evaluator/evaluator.h"

#include "solve/evaluator/evaluator_programs.h"
#include "solve/evaluator/tangent.h"

#include <string.h>

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

void ct_program_use(struct ct_arena *a, struct ct_program *p, struct ct_native *native)
{
    if (p->work && !p->native == !native)
        return;
    if (!native && !p->tape)
        p->tape = ct_tape_create(a, p->listing);
    p->native = native;
    const size_t n = native ? ct_native_work(native) : ct_tape_work(p->tape);
    p->work = ct_arena_alloc_cache_line(a, (n + 1) * sizeof *p->work);
}

bool ct_program_choose(struct ct_arena *a, struct ct_evaluator *m, struct ct_program *p)
{
    struct ct_native *native = NULL;
    if (m->requested_backend != CT_BACKEND_TAPE)
        native = p->native ? p->native : ct_native_create(a, p->listing, 1);
    ct_program_use(a, p, native);
    prepare(p, m->input);
    return native != NULL;
}

bool ct_evaluator_use(struct ct_arena *a, struct ct_evaluator *m, enum ct_backend backend)
{
    struct ct_program *const all[] = {&m->motion, &m->constraint, &m->solved, &m->power,
                                      &m->memory, &m->residual,   &m->tangent};
    bool available = ct_native_is_available(1);
    m->requested_backend = backend;
    for (size_t i = 0; i < COUNT(all); i++)
        if (all[i]->nout)
            available &= ct_program_choose(a, m, all[i]);
    for (struct ct_program *p = m->added; p; p = p->next)
        available &= ct_program_choose(a, m, p);
    if (m->lanes)
        ct_tangent_lanes_use(a, m->lanes, m->requested_backend != CT_BACKEND_TAPE, m->input);
    m->backend = m->requested_backend != CT_BACKEND_TAPE && available ? "native" : "tape";
    return available || backend != CT_BACKEND_NATIVE;
}

// ---- creation -----------------------------------------------------------------------------------

static void start_input(struct ct_evaluator *m)
{
    const struct ct_equations *e = m->e;
    memset(m->input, 0, m->ninput * sizeof *m->input);
    for (size_t i = 0; i < m->model->nparameter; i++)
        m->input[1 + i] = m->model->parameter[i].value;
    for (size_t i = 0; i < e->nmemory; i++)
        if (e->memory[i].kind == CT_MEMORY_QUATERNION && e->memory[i].index == 0)
            m->input[m->at_memory + i] = 1;
}

struct ct_evaluator *ct_evaluator_create(struct ct_arena *a, const struct ct_model *model,
                                         const struct ct_equations *e)
{
    struct ct_evaluator *m = CT_NEW(a, struct ct_evaluator);
    *m = (struct ct_evaluator){
        .e = e, .model = model, .arena = a, .nq = e->nq, .nu = e->nu, .nrow = e->nrow};
    m->at_q = 1 + model->nparameter;
    m->at_u = m->at_q + e->nq;
    m->at_a = m->at_u + e->nu;
    m->at_lam = m->at_a + e->nu;
    m->at_switch = m->at_lam + e->nrow;
    m->at_memory = m->at_switch + e->nswitch;
    m->at_work = m->at_memory + e->nmemory;
    m->ninput = m->at_work + 1;
    m->input = CT_NEWN(a, double, m->ninput);
    start_input(m);

    ct_programs_compile(a, m);
    m->mass_row = CT_NEWN(a, int, m->nu + 1);
    for (size_t i = 0; i < e->nM; i++)
        m->mass_row[e->M[i].row + 1] = (int)i + 1;
    for (size_t k = 0; k < m->nu; k++) // of an empty row, the end of the one before
        if (!m->mass_row[k + 1])
            m->mass_row[k + 1] = m->mass_row[k];
    m->J = CT_NEWN(a, double, m->nrow * m->nu + 1);
    m->row_size = CT_NEWN(a, double, m->nrow + 1);
    m->speed_size = CT_NEWN(a, double, m->nu + 1);
    m->symbol_value = CT_NEWN(a, double, e->x->nsym + 1);
    for (size_t i = 0; i < m->nrow; i++)
        m->row_size[i] = 1;
    for (size_t k = 0; k < m->nu; k++)
        m->speed_size[k] = 1;
    m->rank_tolerance = ct_rank_tolerance;
    m->most_rank = m->nrow;
    m->left_out = CT_NEWN(a, bool, m->nrow + 1);
    m->open = CT_NEWN(a, double, m->nrow + 1);
    m->g[0] = CT_NEWN(a, double, e->nswitch + 1);
    m->g[1] = CT_NEWN(a, double, e->nswitch + 1);
    m->at_rest = CT_NEWN(a, double, e->nswitch + 1);
    m->turned = CT_NEWN(a, double, e->nmemory + 1);
    m->ahead = CT_NEWN(a, double, e->nq + e->nu + 1);
    m->moved = CT_NEWN(a, double, e->nu + 1);
    m->M = m->motion.out;
    m->Q = m->M + e->nM;
    m->gam = m->Q + e->nu + e->nJ;
    m->rate = m->gam + e->nrow;
    m->phi = m->constraint.out;
    m->v = m->phi + e->nrow;
    ct_evaluator_use(a, m, e->is_analysed ? CT_BACKEND_TAPE : CT_BACKEND_BEST);
    ct_evaluator_prepare(m);
    return m;
}

// Definition: of the list below
enum { NPROGRAM = 18 };

static void list_programs(struct ct_evaluator *m, struct ct_program *list[NPROGRAM])
{
    struct ct_program *const all[NPROGRAM]
        = {&m->solved,          &m->motion,        &m->constraint,    &m->result,
           &m->power,           &m->energy,        &m->root,          &m->memory,
           &m->momentum,        &m->driver,        &m->assembly_sign, &m->residual,
           &m->tangent,         &m->validity,      &m->whole_turns,   &m->base_motion,
           &m->beam_mode_state, &m->time_functions};
    memcpy(list, all, sizeof all);
}

void ct_evaluator_prepare(struct ct_evaluator *m)
{
    struct ct_program *all[NPROGRAM];
    list_programs(m, all);
    for (size_t i = 0; i < COUNT(all); i++)
        prepare(all[i], m->input);
    for (struct ct_program *p = m->added; p; p = p->next)
        prepare(p, m->input);
    if (m->lanes)
        ct_tangent_lanes_prepare(m->lanes, m->input);
}

void ct_evaluator_prepare_dynamics(struct ct_evaluator *m)
{
    prepare(&m->motion, m->input);
    prepare(&m->constraint, m->input);
    prepare(&m->power, m->input);
}

static size_t code_size(const struct ct_program *p)
{
    return p->native ? ct_native_code_size(p->native) : 0;
}

size_t ct_evaluator_code_size(struct ct_evaluator *m)
{
    struct ct_program *all[NPROGRAM];
    size_t n = 0;
    list_programs(m, all);
    for (size_t i = 0; i < COUNT(all); i++)
        n += code_size(all[i]);
    for (const struct ct_program *p = m->added; p; p = p->next)
        n += code_size(p);
    return n + (m->lanes ? ct_tangent_lanes_code_size(m->lanes) : 0);
}

void ct_evaluator_reset(struct ct_evaluator *m)
{
    m->is_inexact = false;
    m->most_rank = m->nrow;
    m->rank_tolerance = ct_rank_tolerance;
    start_input(m);
    ct_evaluator_prepare(m);
}

// ---- evaluation ---------------------------------------------------------------------------------

void ct_evaluator_set(struct ct_evaluator *m, double t, const double *y)
{
    m->input[0] = t;
    ct_evaluator_copy(m->input + m->at_q, y, m->nq + m->nu);
    m->input[m->at_work] = y[m->nq + m->nu];
}

static void scatter_J(struct ct_evaluator *m, const double *value)
{
    const struct ct_equations *e = m->e;
    for (size_t i = 0; i < e->nJ; i++)
        m->J[(size_t)e->J[i].row + m->nrow * (size_t)e->J[i].column] = value[i];
}

void ct_evaluator_dynamics(struct ct_evaluator *m)
{
    m->evaluations++;
    ct_program_run(&m->motion, m->input);
    scatter_J(m, m->Q + m->nu);
}

void ct_evaluator_fill_mass(const struct ct_evaluator *m, double *M, size_t n)
{
    for (size_t i = 0; i < m->e->nM; i++) {
        const size_t r = (size_t)m->e->M[i].row, c = (size_t)m->e->M[i].column;
        if (r < n && c < n)
            M[r + n * c] = M[c + n * r] = m->M[i];
    }
}

bool ct_evaluator_solved(struct ct_evaluator *m, double *a)
{
    if (!m->solved.nout)
        return false;
    m->evaluations++;
    ct_program_run(&m->solved, m->input);
    ct_evaluator_copy(a, m->solved.out, m->nu);
    ct_evaluator_copy(m->rate, m->solved.out + m->nu, m->nq);
    return true;
}

void ct_evaluator_constraint(struct ct_evaluator *m)
{
    ct_program_run(&m->constraint, m->input);
    scatter_J(m, m->v + m->nrow);
    for (size_t i = 0; i < m->nrow && m->is_inexact; i++) {
        m->phi[i] = m->left_out[i] ? 0 : m->phi[i] - m->open[i];
        m->v[i] = m->left_out[i] ? 0 : m->v[i];
    }
}

void ct_evaluator_tangent(struct ct_evaluator *m)
{
    const size_t nJ = m->tangent.nout;
    ct_program_run(&m->tangent, m->input);
    if (!m->lanes)
        return;
    ct_tangent_lanes_run(m->lanes, m->input, m->slopes);
    memcpy(m->slopes + m->nslope - nJ, m->tangent.out, nJ * sizeof *m->slopes);
}

// y (n) += c x
static void add_row(double *y, double c, const double *x, size_t n)
{
    for (size_t k = 0; k < n; k++)
        y[k] += c * x[k];
}

// A (nu x nu, out) from slopes of r, and by r_k (1 - k_k)^-1 those of auxiliary unknowns; R: the
// values of dk.
static void scatter_slopes(const struct ct_evaluator *m, double *A, const struct ct_slope *s,
                           size_t n, const double *value, const double *R)
{
    const struct ct_residual *f = m->e->residual;
    const size_t nu = m->nu;
    memset(A, 0, nu * nu * sizeof *A);
    if (f->nauxiliary)
        memset(m->auxiliary, 0, f->nauxiliary * nu * sizeof *m->auxiliary);
    for (size_t i = 0; i < n; i++)
        if (s[i].row < nu)
            A[s[i].row + nu * s[i].direction] = value[i];
        else
            m->auxiliary[nu * (s[i].row - nu) + s[i].direction] = value[i];
    size_t first = 0; // row of the auxiliary unknowns
    while (first < f->ndk && f->dk[first].row < nu)
        first++;
    for (size_t i = first; i < f->ndk; i++)
        add_row(m->auxiliary + nu * (f->dk[i].row - nu), R[i],
                m->auxiliary + nu * f->dk[i].direction, nu);
    for (size_t i = 0; i < first; i++)
        for (size_t k = 0; k < nu; k++)
            A[f->dk[i].row + nu * k] += R[i] * m->auxiliary[nu * f->dk[i].direction + k];
}

const double *ct_evaluator_scatter(const struct ct_evaluator *m, double *K, double *C,
                                   double *M)
{
    const struct ct_residual *f = m->e->residual;
    const double *dq = m->slopes, *du = dq + f->ndq, *da = du + f->ndu, *dk = da + f->nda;
    scatter_slopes(m, K, f->dq, f->ndq, dq, dk);
    scatter_slopes(m, C, f->du, f->ndu, du, dk);
    scatter_slopes(m, M, f->da, f->nda, da, dk);
    return dk + f->ndk;
}

double ct_evaluator_tangent_operations(const struct ct_evaluator *m)
{
    const struct ct_tape_counts c = m->tangent.listing->counts;
    return (double)(c.multiplications + c.additions + c.divisions + c.functions)
         + (m->lanes ? ct_tangent_lanes_operations(m->lanes) : 0);
}
