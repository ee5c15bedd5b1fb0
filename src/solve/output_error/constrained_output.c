// See constrained_output.h.
#include "solve/output_error/constrained_output.h"

#include "integrate/stepper.h"
#include "numeric/dense.h"
#include "numeric/roundoff.h"
#include "solve/output_error/output_error.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Displacement h of the states in the test (8.41) [m, rad, m/s, rad/s]. Derived: an output that
// changes by c h^5, as at a dead centre (h^2) or on the straight line of Watt's linkage, exceeds
// the first bound of (8.41), 1e6 eps, if c > 1e6 eps/h^5 = 2e-4. The displacement is squared, to
// 2^-8 and 2^-16, if loops cannot be closed there.
static const double first_displacement = 0x1p-4;

struct ct_constrained_output {
    struct ct_controlled_outputs *outputs;
    size_t n, ny;
    double *at, *along; // (n) g at `closed`, and at a state displaced along the constraints
    double *y, *closed; // (ny) workspace; y with loops closed
    double *d;          // (nu) workspace
    int *all;           // (nu) 0, 1, 2 ...
    unsigned *kinds;    // (n) of symbols of g
};

// Can the set of constrained outputs change? A test uses one side of comparisons and one time;
// events and time-dependent loads change them.
static bool may_change(const struct ct_equations *e, enum ct_output_kind kind)
{
    unsigned kinds = 0;
    for (size_t i = 0; i < e->nrow; i++)
        kinds |= ct_ex_kinds(e->x, e->row[i].phi);
    return kinds & 1u << CT_SYM_SWITCH
        || (kind == CT_OUTPUTS_OF_SOLUTIONS && (e->nswitch > 0 || e->ntime_function > 0));
}

struct ct_constrained_output *
ct_constrained_output_create(struct ct_arena *a, struct ct_controlled_outputs *outputs,
                             const ct_ex *g)
{
    const struct ct_evaluator *m = outputs->s->m;
    const size_t n = outputs->n;
    if (!m->nrow || may_change(m->e, outputs->kind))
        return NULL;
    struct ct_constrained_output *p = CT_NEW(a, struct ct_constrained_output);
    *p = (struct ct_constrained_output){.outputs = outputs, .n = n, .ny = m->nq + m->nu + 1};
    double **const vectors[] = {&p->at, &p->along};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, n);
    p->y = CT_NEWN(a, double, p->ny);
    p->closed = CT_NEWN(a, double, p->ny);
    p->d = CT_NEWN(a, double, m->nu + 1);
    p->all = CT_NEWN(a, int, m->nu + 1);
    for (size_t k = 0; k < m->nu; k++)
        p->all[k] = (int)k;
    p->kinds = CT_NEWN(a, unsigned, n);
    for (size_t i = 0; i < n; i++)
        p->kinds[i] = ct_ex_kinds(m->e->x, g[i]);
    return p;
}

struct ct_constrained_output_record ct_constrained_output_record(struct ct_arena *a, size_t n)
{
    return (struct ct_constrained_output_record){
        .n = n, .is_found = CT_NEWN(a, bool, n + 1), .is_settled = CT_NEWN(a, bool, n + 1)};
}

void ct_constrained_output_clear(const struct ct_constrained_output *p,
                                 struct ct_constrained_output_record *r,
                                 bool violates_velocity_constraints)
{
    const unsigned others
        = 1u << CT_SYM_SWITCH
        | (violates_velocity_constraints ? 1u << CT_SYM_U : 0); // not covered by the test
    for (size_t i = 0; i < r->n; i++) {
        r->is_found[i] = false;
        r->is_settled[i] = !p || p->kinds[i] & others;
    }
}

// p->y = p->closed, with the coordinates and speeds `which` (n) displaced by `distance`.
static void move_states(struct ct_constrained_output *p, const int *which, size_t n,
                        double distance)
{
    const struct ct_evaluator *m = p->outputs->s->m;
    memset(p->d, 0, m->nu * sizeof *p->d);
    ct_evaluator_copy(p->y, p->closed, p->ny);
    for (size_t i = 0; i < n; i++) {
        const size_t k = (size_t)which[i];
        p->d[k] = distance * ct_perturbation_part(k);
        p->y[m->nq + k] += distance * ct_perturbation_part(m->nu + k);
    }
    ct_evaluator_retract(m, p->y, p->d);
}

// p->y = state with closed loops, displaced from p->closed along the constraints as far as the
// loops can be closed. Returns the displacement, 0 if there is none.
static double displace_along_constraints(struct ct_constrained_output *p, double t)
{
    struct ct_partition *s = p->outputs->s;
    const size_t nfree = s->m->nu - (size_t)s->rank;
    for (double distance = first_displacement; distance > CT_HALF_DIGITS;
         distance *= distance) {
        move_states(p, s->independent, nfree, distance);
        if (ct_partition_close_loops(s, t, p->y))
            return distance;
    }
    return 0;
}

// Evaluate outputs at y with loops closed and at a displaced state. Returns the displacement, 0
// if there is none.
static double evaluate_both(struct ct_constrained_output *p, double t, const double *y)
{
    ct_evaluator_copy(p->closed, y, p->ny);
    if (!ct_partition_close_loops(p->outputs->s, t, p->closed))
        return 0;
    memcpy(p->at, ct_controlled_outputs_at(p->outputs, t, p->closed), p->n * sizeof *p->at);
    const double distance = displace_along_constraints(p, t);
    if (distance > 0)
        memcpy(p->along, ct_controlled_outputs_at(p->outputs, t, p->y),
               p->n * sizeof *p->along);
    return distance;
}

// distance: relative to the size of the states.
static bool is_constrained(double at, double along, double across, double distance,
                           double small)
{
    const double change = fabs(along - at),
                 roundoff = DBL_EPSILON * fabs(across - at) / distance;
    return change <= ct_output_error_least_size * roundoff
        && change <= CT_NEGLIGIBLE_RATIO * distance * (fabs(at) + small);
}

static void test_outputs(struct ct_constrained_output *p,
                         struct ct_constrained_output_record *r, double t, const double *y,
                         double small)
{
    const size_t nstate = p->ny - 1;
    const double distance = evaluate_both(p, t, y), size = ct_vector_largest(p->closed, nstate);
    if (!(distance > 0)) {
        memset(r->is_found, 0, r->n * sizeof *r->is_found);
        return;
    }
    move_states(p, p->all, p->outputs->s->m->nu, distance);
    const double *across = ct_controlled_outputs_at(p->outputs, t, p->y);
    for (size_t i = 0; i < r->n; i++) {
        r->is_found[i] = !r->is_settled[i]
                      && is_constrained(p->at[i], p->along[i], across[i],
                                        distance / ct_larger(1, size + small), small);
        r->is_settled[i] = !r->is_found[i];
    }
}

bool ct_constrained_output_find(struct ct_constrained_output *p,
                                struct ct_constrained_output_record *r, double t,
                                const double *y, const struct ct_tolerance *tolerance)
{
    if (!p || !(tolerance->rtol > 0 && tolerance->atol > 0) || p->outputs->s->is_crossing)
        return false;
    test_outputs(p, r, t, y, tolerance->atol / tolerance->rtol);
    if (p->outputs->kind == CT_OUTPUTS_OF_SOLUTIONS)
        ct_controlled_outputs_at(p->outputs, t,
                                 y); // restore the solution at y
    return true;
}
