// See evaluator_programs.h: what is compiled.
#include "solve/evaluator/evaluator_programs.h"

#include "formulate/dynamics/small_motion.h"
#include "solve/evaluator/tangent.h"

#include <math.h>

// ---- inputs -------------------------------------------------------------------------------------

struct inputs {
    ct_ex *symbol;
    size_t *slot;
    size_t n;
};

bool ct_evaluator_slot(const struct ct_evaluator *m, const struct ct_sym *s, size_t *slot)
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
    case CT_SYM_SWITCH:
        *slot = m->at_switch + s->index;
        return true;
    case CT_SYM_MEMORY:
        *slot = m->at_memory + s->index;
        return true;
    case CT_SYM_WORK:
        *slot = m->at_work;
        return true;
    case CT_SYM_SEED: // after the input: of tangents alone
        *slot = m->ninput + s->index;
        return true;
    case CT_SYM_LOCAL:
    case CT_SYM_SIGNAL:
        break;
    }
    return false;
}

void ct_evaluator_values(const struct ct_evaluator *m, const struct ct_exs *x, double *value)
{
    for (size_t k = 0; k < x->nsym; k++) {
        size_t slot;
        value[k] = ct_evaluator_slot(m, &x->sym[k], &slot) && slot < m->ninput ? m->input[slot]
                                                                               : NAN;
    }
}

// All symbols of the store with a value in a run, and their slots.
static struct inputs list_inputs(struct ct_arena *a, const struct ct_evaluator *m,
                                 const struct ct_exs *x)
{
    struct inputs in = {CT_NEWN(a, ct_ex, x->nsym + 1), CT_NEWN(a, size_t, x->nsym + 1), 0};
    for (uint32_t id = 0; id < x->nnode; id++) {
        size_t slot;
        if (x->node[id].op != CT_OP_SYM || !ct_evaluator_slot(m, &x->sym[x->node[id].a], &slot))
            continue;
        in.symbol[in.n] = (ct_ex){id};
        in.slot[in.n++] = slot;
    }
    return in;
}

const struct ct_listing *ct_evaluator_list(struct ct_arena *a, const struct ct_evaluator *m,
                                           const struct ct_exs *x, const ct_ex *out, size_t n)
{
    const struct inputs in = list_inputs(a, m, x);
    return ct_listing_create(a, x, out, n, in.symbol, in.slot, in.n, CT_FUSE_NO);
}

static void compile_from(struct ct_arena *a, const struct ct_exs *x, const struct inputs *in,
                         const ct_ex *out, size_t n, enum ct_fuse fuse, struct ct_program *p)
{
    p->listing = ct_listing_create(a, x, out, n, in->symbol, in->slot, in->n, fuse);
    p->out = CT_NEWN(a, double, n + 1);
    p->nout = n;
}

static void compile(struct ct_arena *a, const struct ct_evaluator *m, const struct inputs *in,
                    const ct_ex *out, size_t n, struct ct_program *p)
{
    compile_from(a, m->e->x, in, out, n, CT_FUSE_NO, p);
}

// ---- outputs ------------------------------------------------------------------------------------

struct list {
    struct ct_arena *a;
    ct_ex *e;
    size_t n, cap;
};

static void push(struct list *l, ct_ex e)
{
    CT_PUSH(l->a, l->e, l->n, l->cap, e);
}

static void compile_motion(struct ct_arena *a, struct ct_evaluator *m, const struct inputs *in)
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

static void compile_solved(struct ct_arena *a, struct ct_evaluator *m, const struct inputs *in)
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

static void compile_constraint(struct ct_arena *a, struct ct_evaluator *m,
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

static void compile_rest(struct ct_arena *a, struct ct_evaluator *m, const struct inputs *in)
{
    const struct ct_equations *e = m->e;
    struct list result = {.a = a}, root = {.a = a}, memory = {.a = a}, momentum = {.a = a},
                driver = {.a = a}, wanted = {.a = a}, turns = {.a = a};
    for (size_t i = 0; i < e->nresult; i++)
        push(&result, e->result[i].value);
    for (size_t i = 0; i < e->nswitch; i++)
        push(&root, e->switches[i].g);
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
    if (e->nswitch || e->x->ntable) { // rates can jump
        ct_ex *u = CT_NEWN(a, ct_ex, e->nu + 1);
        for (size_t i = 0; i < e->nu; i++)
            u[i] = e->u[i].symbol;
        momentum.e = CT_NEWN(a, ct_ex, 2 * e->nu + 1);
        ct_ex_gradient(e->x, a, e->kinetic, u, e->nu, momentum.e);
        momentum.n = e->nu;
        if (e->is_small)
            ct_small_motion_momenta(e->build, momentum.e);
        if (!ct_ex_is_zero(e->continuity)) {
            ct_ex_gradient(e->x, a, e->continuity, u, e->nu, momentum.e + e->nu);
            momentum.n += e->nu;
        }
        for (size_t k = e->nmotion; k < e->nu; k++) // states of the model stay as they are
            momentum.e[k] = momentum.e[e->nu + k] = u[k];
    }
    for (size_t i = 0; i < e->ndriver; i++) {
        push(&driver, e->driver[i].value);
        push(&driver, e->driver[i].rate);
    }
    for (size_t i = 0; i < e->nrow; i++)
        push(&wanted, e->row[i].assembly_sign);
    const ct_ex energies[] = {e->kinetic, ct_ex_add(e->x, e->potential, e->strain)};
    compile(a, m, in, result.e, result.n, &m->result);
    compile(a, m, in, root.e, root.n, &m->root);
    compile(a, m, in, e->time_function, e->ntime_function, &m->time_functions);
    compile(a, m, in, memory.e, memory.n, &m->memory);
    compile(a, m, in, turns.e, turns.n, &m->whole_turns);
    compile(a, m, in, momentum.e, momentum.n, &m->momentum);
    compile(a, m, in, driver.e, driver.n, &m->driver);
    compile(a, m, in, wanted.e, wanted.n, &m->assembly_sign);
    struct list validity = {.a = a}, base_motion = {.a = a}, mode_state = {.a = a};
    for (size_t i = 0; i < e->nvalidity; i++) {
        const struct ct_validity *v = &e->validity[i];
        push(&validity, v->eta);
        for (int k = 0; k < 9 && v->estimates_error; k++)
            push(&base_motion, v->base_motion[k / 3].e[k % 3]);
        for (int k = 0; k < 2 * v->nshape && v->estimates_error; k++)
            push(&mode_state, v->shape[k / 2].state[k % 2]);
        for (int k = 0; k < 2 && v->estimates_error; k++)
            push(&base_motion, v->end[k]);
    }
    for (size_t i = 0; i < e->nbent_beam; i++)
        for (size_t k = 0; k < e->bent_beam[i].n; k++)
            push(&validity, e->bent_beam[i].square[k]);
    compile(a, m, in, validity.e, validity.n, &m->validity);
    compile(a, m, in, base_motion.e, base_motion.n, &m->base_motion);
    compile(a, m, in, mode_state.e, mode_state.n, &m->beam_mode_state);
    compile(a, m, in, energies, 2, &m->energy);
    compile(a, m, in, &e->power, ct_ex_is_zero(e->power) ? 0 : 1, &m->power);
    // rarely run: no native code
    struct ct_program *const all[]
        = {&m->result,        &m->root,   &m->whole_turns, &m->momentum,    &m->driver,
           &m->assembly_sign, &m->energy, &m->validity,    &m->base_motion, &m->beam_mode_state,
           &m->time_functions};
    for (size_t i = 0; i < COUNT(all); i++)
        if (all[i]->nout)
            ct_program_use(a, all[i], NULL);
}

static void push_slopes(struct list *l, const struct ct_slope *s, size_t n)
{
    for (size_t i = 0; i < n; i++)
        push(l, s[i].value);
}

static void compile_residual(struct ct_arena *a, struct ct_evaluator *m,
                             const struct inputs *in)
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
        push_slopes(&tangent, f->dk, f->ndk);
        push_slopes(&tangent, f->dv, f->ndv);
    }
    for (size_t i = 0; i < e->nJ && f; i++)
        push(&tangent, e->J[i].value);
    compile(a, m, in, residual.e, residual.n, &m->residual);
    compile(a, m, in, tangent.e, tangent.n, &m->tangent);
    m->slopes = m->tangent.out;
    m->nslope = tangent.n;
    if (f && f->nauxiliary)
        m->auxiliary = CT_NEWN(a, double, f->nauxiliary * e->nu);
    if (!f || !f->along)
        return;
    const size_t own = f->ndq + f->ndu + f->nda + f->ndk + f->ndv;
    const struct ct_listing *l
        = ct_listing_create(a, e->x, f->along->rate, e->nu + f->nauxiliary + e->nrow,
                            in->symbol, in->slot, in->n, CT_FUSE_NO);
    m->nslope = own + e->nJ;
    m->slopes = CT_NEWN(a, double, m->nslope + 1);
    m->lanes = ct_tangent_lanes_create(a, f, l, e->nu, m->ninput);
}

void ct_programs_compile(struct ct_arena *a, struct ct_evaluator *m)
{
    const struct inputs in = list_inputs(a, m, m->e->x);
    compile_solved(a, m, &in);
    compile_motion(a, m, &in);
    compile_constraint(a, m, &in);
    compile_rest(a, m, &in);
    compile_residual(a, m, &in);
}

static void compile_apart(struct ct_arena *a, struct ct_evaluator *m, const struct ct_exs *x,
                          const ct_ex *out, size_t n, enum ct_fuse fuse, struct ct_program *p)
{
    const struct inputs in = list_inputs(a, m, x);
    *p = (struct ct_program){.next = m->added};
    compile_from(a, x, &in, out, n, fuse, p);
    ct_program_choose(a, m, p);
    m->added = p;
}

void ct_evaluator_add_program(struct ct_arena *a, struct ct_evaluator *m,
                              const struct ct_exs *x, const ct_ex *out, size_t n,
                              struct ct_program *p)
{
    compile_apart(a, m, x, out, n, CT_FUSE_NO, p);
}

void ct_evaluator_add_solution(struct ct_arena *a, struct ct_evaluator *m,
                               const struct ct_exs *x, const ct_ex *out, size_t n,
                               struct ct_program *p)
{
    compile_apart(a, m, x, out, n, CT_FUSE_NATIVE, p);
}

void ct_evaluator_remove_program(struct ct_evaluator *m, const struct ct_program *p)
{
    for (struct ct_program **at = &m->added; *at; at = &(*at)->next)
        if (*at == p) {
            *at = p->next;
            return;
        }
}

void ct_evaluator_add_residual(struct ct_arena *a, struct ct_evaluator *m)
{
    if (m->residual.nout)
        return;
    const struct inputs in = list_inputs(a, m, m->e->x);
    compile_residual(a, m, &in);
    ct_evaluator_use(a, m, m->requested_backend);
}
