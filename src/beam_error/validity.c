// See validity.h.
#include "beam_error/validity.h"
#include "base/pi.h"
#include "expr/tape.h"
#include "beam_error/bending_modes.h"
#include "formulate/beam_dynamics/beam_dynamics.h"
#include "beam_error/beam_error_coupled.h"
#include "formulate/beam/attached_bodies.h"

#include <math.h>
#include <string.h>

// Limit: of the time of an estimate. Definition: a prime, so that other instants are met
enum { FEWEST_INSTANTS = 400, MOST_INSTANTS = 8000, OTHER_INSTANTS = 5003 };

// eta of one plane.
static ct_ex indicator(struct ct_exs *x, const struct ct_base *m, const struct ct_beam_mode *s)
{
    const ct_ex turning
        = ct_ex_add(x, ct_ex_mul(x, m->w.e[1], m->w.e[1]), ct_ex_mul(x, m->w.e[2], m->w.e[2]));
    return ct_ex_sub(x, ct_ex_scale(x, s->eta_by_rate, turning),
                     ct_ex_scale(x, s->eta_by_acceleration, m->a.e[0]));
}

static bool is_of_time(const struct ct_exs *x, ct_ex e)
{
    return !(ct_ex_kinds(x, e)
             & ~(1u << CT_SYM_TIME | 1u << CT_SYM_PARAM | 1u << CT_SYM_SWITCH));
}

bool ct_validity_derive(struct ct_build *b, const struct ct_flexible *f,
                        struct ct_validity *out)
{
    *out = (struct ct_validity){.beam = f->name,
                                .starts_static = f->beam->starts_in_equilibrium};
    const int ny = ct_bending_modes_find(b, f, 0, out->shape);
    out->nshape = ny + ct_bending_modes_find(b, f, 1, out->shape + ny);
    if (!out->nshape)
        return false;
    ct_bending_modes_couple(out->shape, out->nshape);
    const struct ct_beam_mode *first = &out->shape[0].mode, *other = &out->shape[ny].mode;
    if (out->nshape > ny && other->eta_by_rate > first->eta_by_rate)
        first = other;
    const struct ct_base m = ct_flexible_base(b, f, CT_FULL);
    out->omega = sqrt(first->omega2);
    out->mark = f->beam->formulation_mark.line ? f->beam->formulation_mark
                                               : b->model->body[f->body].instance.mark;
    out->eta = indicator(b->x, &m, first);
    const struct ct_element *last = &f->element[f->beam->nelement - 1];
    out->end[0] = last->value[4];
    out->end[1] = last->value[8];
    ct_flexible_base_motion(b, f, out->base_motion);
    const bool is_loaded = ct_attached_bodies_are_loaded(b, f);
    out->estimates_error = is_of_time(b->x, out->eta) && !is_loaded;
    for (int i = 0; i < 9; i++)
        out->estimates_error
            = out->estimates_error && is_of_time(b->x, out->base_motion[i / 3].e[i % 3]);
    if (!out->estimates_error && !is_loaded)
        out->coupled = ct_beam_error_coupled_create(b, f, out);
    out->estimates_error |= out->coupled != NULL;
    return true;
}

void ct_validity_begin(const struct ct_validity *v, const double *start,
                       struct ct_beam_error_modal *s)
{
    *s = (struct ct_beam_error_modal){.n = v->estimates_error ? v->nshape : 0};
    for (int i = 0; i < s->n; i++) {
        s->shape[i] = v->shape[i].mode;
        for (int m = 0; m < CT_BEAM_MODELS; m++)
            memcpy(s->x[m][i], start + 2 * i, sizeof s->x[m][i]);
    }
}

double ct_validity_interval(const struct ct_validity *v)
{
    // Derived: sampling a sine at 32 and at 8 instants per period misses its largest value by at
    // most 0.5 % and 8 % (1 - cos(pi/32), 1 - cos(pi/8))
    const double of_first = 1.0 / 32, of_each = 1.0 / 8;
    double shortest = of_first * 2 * CT_PI / v->omega;
    for (int i = 0; i < v->nshape; i++)
        shortest = fmin(shortest, of_each * 2 * CT_PI / sqrt(v->shape[i].mode.omega2));
    return shortest;
}

// ---- choice -------------------------------------------------------------------------------------

// Set the switches that depend on time alone to their values at the time in value.
static bool set_switches(struct ct_build *b, double *value)
{
    for (size_t i = 0; i < b->eqs->nswitch; i++) {
        const struct ct_switch *m = &b->eqs->switches[i];
        if (!m->is_time)
            return false;
        value[ct_ex_node(b->x, m->symbol)->a]
            = ct_op_apply(m->op, ct_ex_value(b->x, m->g, value), 0, 0);
    }
    return true;
}

struct prospect {
    double eta;                   // largest |eta|
    double error[CT_BEAM_MODELS]; // of linear and foreshortened beams; NAN: no deflection
};

enum { ETA, BASE, NOUT = BASE + 9 };

struct prediction { // simulation of the modes before the run
    struct ct_build *b;
    const struct ct_tape *tape; // eta and the base's motion
    double *value, *work;       // of symbols
    double out[NOUT];
    struct ct_beam_error_modal swings;
};

static void prepare(struct prediction *p, const struct ct_validity *v)
{
    struct ct_arena *a = p->b->ctx->scratch;
    const struct ct_exs *x = p->b->x;
    ct_ex out[NOUT] = {v->eta}, *in = CT_NEWN(a, ct_ex, x->nsym + 1);
    size_t n = 0, *slot = CT_NEWN(a, size_t, x->nsym + 1);
    for (int k = 0; k < 9; k++)
        out[BASE + k] = v->base_motion[k / 3].e[k % 3];
    p->value = CT_NEWN(a, double, x->nsym + 1);
    memcpy(p->value, p->b->value, p->b->model->x->nsym * sizeof *p->value);
    for (uint32_t id = 0; id < x->nnode; id++)
        if (x->node[id].op == CT_OP_SYM && is_of_time(x, (ct_ex){id})) {
            slot[n] = x->node[id].a;
            in[n++] = (ct_ex){id};
        }
    p->tape = ct_tape_compile(a, x, out, NOUT, in, slot, n);
    p->work = CT_NEWN(a, double, ct_tape_work(p->tape) + 1);
    ct_tape_prepare(p->tape, p->value, p->work);
    for (int k = 0; k < NOUT; k++) // the parameters in them have decided about the equations
        (void)ct_ex_value(x, out[k], p->value);
}

// Advance to the time t, with the switches as they are there and the jumps of rates that come with
// them. False if the switches are not known.
static bool advance_modes(struct prediction *p, double t)
{
    struct ct_beam_error_modal *s = &p->swings;
    const bool is_kept
        = p->b->model->simulation.rate_jumps == CT_RATE_CONTINUOUS && s->has_begun;
    p->value[ct_ex_node(p->b->x, p->b->model->time)->a] = t;
    if (is_kept) {
        ct_tape_eval(p->tape, p->value, p->out, p->work);
        ct_beam_error_modal_advance(s, t, p->out + BASE);
    }
    if (!set_switches(p->b, p->value))
        return false;
    ct_tape_eval(p->tape, p->value, p->out, p->work);
    if (is_kept)
        ct_beam_error_modal_reset_base(s, p->out + BASE);
    else
        ct_beam_error_modal_advance(s, t, p->out + BASE);
    return true;
}

// The same for a base that moves with the beam.
static bool simulate_coupled(struct ct_build *b, const struct ct_validity *v,
                             const double *start, int n, struct prospect *out)
{
    struct ct_beam_error_modal s;
    struct ct_beam_error_coupled_run *r
        = ct_beam_error_coupled_run_create(b->ctx->scratch, v->coupled);
    const double end = b->model->simulation.duration;
    ct_validity_begin(v, start, &s);
    ct_beam_error_coupled_begin(r, &s);
    if (v->starts_static)
        ct_beam_error_modal_start_static(&s);
    for (int i = 1; i <= n; i++)
        ct_beam_error_coupled_advance(r, &s, end * i / n, end / n);
    out->eta = ct_beam_error_coupled_indicator(r);
    for (int m = 0; m < CT_BEAM_MODEL_EXACT; m++)
        out->error[m] = ct_beam_error_modal_error(&s, m);
    return !isnan(out->eta) && !isnan(s.deflection);
}

// Simulate from 0 to the end of the run in n steps. False if the switches are not known.
static bool simulate_modes(struct ct_build *b, const struct ct_validity *v, int n,
                           struct prospect *out)
{
    struct prediction p = {.b = b};
    double start[2 * CT_BENDING_SHAPES] = {0};
    for (int i = 0; i < 2 * v->nshape; i++)
        start[i] = v->shape[i / 2].start[i % 2];
    if (v->coupled)
        return simulate_coupled(b, v, start, n, out);
    const double end = b->model->simulation.duration;
    prepare(&p, v);
    ct_validity_begin(v, start, &p.swings);
    *out = (struct prospect){0};
    for (int i = 0; i <= n; i++) {
        if (!advance_modes(&p, end * i / n))
            return false;
        const double eta = fabs(p.out[ETA]);
        out->eta = eta > out->eta || isnan(eta) ? eta : out->eta;
        if (i == 0 && v->starts_static)
            ct_beam_error_modal_start_static(&p.swings);
    }
    for (int m = 0; m < CT_BEAM_MODEL_EXACT; m++)
        out->error[m] = ct_beam_error_modal_error(&p.swings, m);
    return !isnan(out->eta);
}

static bool is_alike(double a, double b)
{
    // Default: estimates of long runs against those whose instants miss peaks.
    // Test: beam_error_estimate
    const double factor = 1.5;
    return (isnan(a) && isnan(b)) || (a <= factor * b && b <= factor * a)
        || (a > CT_ESTIMATED_ERROR_LIMIT && b > CT_ESTIMATED_ERROR_LIMIT);
}

// Predict indicator and error for the whole run. NULL, or a text that says why they are unknown. If
// the run is too long for the sampling interval, two simulations with different instants must
// agree.
static const char *predict_error(struct ct_build *b, const struct ct_validity *v,
                                 struct prospect *out)
{
    const double wanted = b->model->simulation.duration / ct_validity_interval(v);
    struct prospect other;
    if (!v->estimates_error
        || !simulate_modes(b, v, (int)fmin(fmax(FEWEST_INSTANTS, wanted), MOST_INSTANTS), out))
        return "automatic: its motion is not known beforehand";
    if (wanted <= MOST_INSTANTS
        || (simulate_modes(b, v, OTHER_INSTANTS, &other)
            && is_alike(out->error[CT_BEAM_MODEL_LINEAR], other.error[CT_BEAM_MODEL_LINEAR])))
        return NULL;
    return "automatic: its motion is too fast to be simulated beforehand in so long a run";
}

static const char *error_text(struct ct_arena *a, double error)
{
    return error > CT_ESTIMATED_ERROR_LIMIT ? "beyond 1" : ct_arena_printf(a, "%.3g", error);
}

static const char *estimated_error(struct ct_build *b, const struct prospect *p)
{
    const double linear = p->error[CT_BEAM_MODEL_LINEAR],
                 other = p->error[CT_BEAM_MODEL_FORESHORTENED];
    if (isnan(linear))
        return "";
    const char *one_frame
        = other > CT_VALIDITY_LIMIT ? ct_arena_printf(
              b->arena, "; a foreshortened one's in one frame: %s", error_text(b->arena, other))
                                    : "";
    return ct_arena_printf(b->arena, "; a linear beam's error: %s%s",
                           error_text(b->arena, linear), one_frame);
}

// The error of the linear beam is below the limit, or less than that of a foreshortened beam.
static bool is_better_linear(const struct prospect *p)
{
    const double linear = p->error[CT_BEAM_MODEL_LINEAR];
    const bool is_near = !(linear > CT_VALIDITY_LIMIT),
               is_nearer = linear <= CT_ESTIMATED_ERROR_LIMIT
                        && linear < p->error[CT_BEAM_MODEL_FORESHORTENED];
    return p->eta <= CT_VALIDITY_LIMIT && (is_near || is_nearer);
}

// *is_driven becomes false if another choice of trees may show that the motion of the base depends
// on time alone.
static bool stays_linear(struct ct_build *b, struct ct_flexible *f, bool *is_driven)
{
    struct ct_validity v;
    struct prospect p;
    if (ct_attached_bodies_are_loaded(b, f)) {
        f->why = "automatic: joints or loads beyond its base can stretch or press it";
        return false;
    }
    if (!ct_validity_derive(b, f, &v)) {
        f->why = "automatic: it does not bend";
        return true;
    }
    *is_driven &= v.estimates_error && (!v.coupled || ct_beam_error_coupled_is_free(v.coupled));
    f->why = predict_error(b, &v, &p);
    if (f->why)
        return false;
    f->why = ct_arena_printf(b->arena, "automatic: validity indicator %.3g, limit %.3g%s",
                             p.eta, CT_VALIDITY_LIMIT, estimated_error(b, &p));
    if (v.coupled)
        f->why = ct_arena_printf(b->arena, "automatic: its base is not driven; %s",
                                 f->why + strlen("automatic: "));
    return !v.coupled && is_better_linear(&p);
}

const bool *ct_validity_choose(struct ct_build *b, bool *is_driven)
{
    bool *linear = NULL;
    *is_driven = true;
    for (size_t i = 0; i < b->nflexible; i++) {
        struct ct_flexible *f = &b->flexible[i];
        if (f->beam->formulation != CT_BEAM_AUTO || !f->nelastic)
            continue;
        if (!linear)
            linear = CT_NEWN(b->arena, bool, b->model->nbody);
        linear[f->body] = stays_linear(b, f, is_driven);
    }
    return linear;
}

static ct_ex squared_slope(struct ct_build *b, const struct ct_element *e, int end)
{
    struct ct_exs *x = b->x;
    const ct_ex v = e->value[3 + 2 * end], w = e->value[7 + 2 * end];
    return ct_ex_add(x, ct_ex_mul(x, v, v), ct_ex_mul(x, w, w));
}

static void monitor_bending(struct ct_build *b, const struct ct_flexible *f)
{
    const int n = f->beam->nelement;
    struct ct_bent_beam bend = {.beam = f->name,
                                .mark = b->model->body[f->body].instance.mark,
                                .square = CT_NEWN(b->arena, ct_ex, n + 1)};
    for (int k = 0; k <= n; k++) {
        const ct_ex square = squared_slope(b, &f->element[k ? k - 1 : 0], k > 0);
        if (!ct_ex_is_zero(square))
            bend.square[bend.n++] = square;
    }
    if (bend.n)
        CT_PUSH(b->arena, b->eqs->bent_beam, b->eqs->nbent_beam, b->eqs->bent_beam_cap, bend);
}

void ct_validity_monitor(struct ct_build *b)
{
    for (size_t i = 0; i < b->nflexible; i++)
        monitor_bending(b, &b->flexible[i]);
    for (size_t i = 0; i < b->nflexible; i++) {
        struct ct_validity v;
        if (b->flexible[i].formulation == CT_BEAM_LINEAR
            && ct_validity_derive(b, &b->flexible[i], &v))
            CT_PUSH(b->arena, b->eqs->validity, b->eqs->nvalidity, b->eqs->validity_cap, v);
    }
}
