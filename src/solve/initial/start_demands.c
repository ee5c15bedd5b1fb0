// Do the initial conditions still have the values demanded by `initial`? See assembly.h.
//
// The assembly meets demands or fails. Later the initial equilibrium of beams may move joints.
// The equations of motion, on other trees, may also find another rank of the constraints. A
// degree of freedom removed by that loses its demanded speed.
#include "solve/initial/assembly_internal.h"

#include <math.h>

// Tolerance of a demanded value, relative to the larger of the value and 1 rad or the natural
// length. Where its degree of freedom is removed, the error is the whole value.
// Derived: thirty times 3e-6, the effect of round-off in constraints on speeds 1e-5 rad from a
// singular configuration.
static const double demand_tolerance = 1e-4;

double ct_start_shown(double value)
{
    return fabs(value) < ct_rank_tolerance ? 0 : value;
}

static double unit_of(const struct ct_initial_state *s, const struct ct_target *t, double value)
{
    const double scale = t->is_given && t->weight > 0 ? 1 / t->weight : s->length;
    return fmax(scale, fabs(value));
}

// Does coordinate i, or its speed, have its demanded value?
static bool is_met(const struct ct_initial_state *s, size_t i, bool is_speed, double found)
{
    const struct ct_target *t = is_speed ? &s->u_target[i] : &s->q_target[i];
    double away = fabs(found - t->value);
    if (!is_speed && t->in_quaternion) // p and -p are one orientation
        away = fmin(away, fabs(found + t->value));
    return !t->is_given || away <= demand_tolerance * unit_of(s, t, t->value);
}

static bool report(struct ct_ctx *ctx, const struct ct_initial_state *s, size_t i,
                   bool is_speed, double found)
{
    const struct ct_coordinate *c = &s->e->coordinate[i];
    const struct ct_instance *joint = s->e->build->topology->edge[c->edge].self;
    const struct ct_target *t = is_speed ? &s->u_target[i] : &s->q_target[i];
    const struct ct_value *v = is_speed ? &joint->initial.u : &joint->initial.q;
    const bool is_turn = !is_speed && t->in_quaternion && joint->initial.rotate.given;
    return ct_error(ctx, is_turn ? joint->initial.rotate.mark : v->mark, CT_E_START,
                    "joint '%s': initial demands %.10g as %s'%s', the constraints leave "
                    "%.10g; correct the joints that repeat each other, or mark what need not "
                    "hold with 'guess: true'",
                    joint->name, t->value, is_speed ? "rate of " : "", c->name,
                    ct_start_shown(found));
}

// Report the first demand of each joint that is not met.
static bool compare(struct ct_ctx *ctx, const struct ct_initial_state *s, const double *q,
                    const double *u)
{
    int reported = -1;
    for (size_t i = 0; i < s->n; i++) {
        const int edge = s->e->coordinate[i].edge;
        for (int is_speed = 0; is_speed < (u ? 2 : 1) && edge != reported; is_speed++) {
            const double found = is_speed ? u[i] : q[i];
            if (is_met(s, i, is_speed, found))
                continue;
            report(ctx, s, i, is_speed, found);
            reported = edge;
        }
    }
    return reported < 0;
}

bool ct_start_meets_demands(struct ct_ctx *ctx, const struct ct_initial_state *start)
{
    return compare(ctx, start, start->q, start->u);
}

// Do unknowns differ by more than the tolerance of demands? Each is compared with the larger of
// itself and 1, as its unit is not known here.
static bool differs(const double *x, const double *y, size_t n, double scale)
{
    for (size_t i = 0; i < n; i++)
        if (!(fabs(x[i] - y[i]) <= demand_tolerance * scale * fmax(1, fabs(x[i]))))
            return true;
    return false;
}

bool ct_start_has_moved(const struct ct_equations *e, const struct ct_initial_state *start,
                        const double *before, const double *after)
{
    if (!start->e) // not from an assembly: nothing is demanded
        return false;
    const double scale = fmin(1, start->length);
    return differs(before, after, e->nq, scale)
        || differs(before + e->nq, after + e->nq, e->nu, scale);
}

bool ct_start_is_kept(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
                      const struct ct_equations *e, const struct ct_initial_state *start,
                      const double *before, const double *after, bool with_speeds)
{
    if (!ct_start_has_moved(e, start, before, after))
        return true;
    struct ct_arena *own = ct_arena_create_under(a);
    double *q = CT_NEWN(own, double, start->n + 1), *u = CT_NEWN(own, double, start->n + 1);
    // the assembly's equations do not have the shape of beams in equilibrium: compare unknowns
    // alone
    if (!start->elastic)
        ct_start_read_back(ctx, own, model, e, start, after, q, u);
    for (size_t i = 0; i < start->n && start->elastic; i++) {
        const struct ct_coordinate *c = &e->coordinate[i];
        q[i] = c->q >= 0 ? after[c->q] : start->q[i];
        u[i] = c->u >= 0 ? after[e->nq + (size_t)c->u] : start->u[i];
    }
    const bool ok = compare(ctx, start, q, with_speeds ? u : NULL);
    ct_arena_destroy(own);
    return ok;
}
