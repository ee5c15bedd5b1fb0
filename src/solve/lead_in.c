// A run that starts in a singular position, with speeds: from a little before it.
//
// Rows depend there and accelerations cannot be found, but speeds that belong to one of the motions through the position,
//
//     J u = -Phi_t,   w' (J' u + ...) = 0  for w' J = 0                                              (8.23)
//
// tell which one it is. Collocation centred on the position finds the state half a step before the start; from there the run goes on
// as any that comes to such a position, and crosses it.
#include "solve/run.h"

#include "integrate/crossing.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Largest change of a coordinate from the start to either end of the step that is centred there [rad, m], at first; halved where the
// step errs.
static const double longest_way = 0.4;
enum { LOOKS = 8 };

// The step may err by so much of the largest state, or of what is asked by more: rounding next to the position is what is left.
static const double exact = 1e-12, unfelt = 0.1;

// How far the ends of the step may lie off the constraints [m, rad]: speeds that belong to no motion leave much more.
static double off_constraints(struct ct_run *r, double t, const double *y)
{
    ct_machine_set(r->m, t, y);
    ct_machine_constraint(r->m);
    return ct_vector_largest(r->m->phi, r->m->nrow);
}

// Rows and columns of the embedding, for the motion from y with derivative dy, at h after it.
static bool choose_beside(struct ct_run *r, double h, const double *y)
{
    const size_t n = r->ctx->ndiagnostic, nerror = r->ctx->nerror;
    memcpy(r->stage, y, r->ny * sizeof *y);
    for (size_t k = 0; k < r->m->nu; k++)
        r->scratch[k] = h * y[r->m->nq + k];
    ct_machine_retract(r->m, r->stage, r->scratch);
    ct_machine_set(r->m, h, r->stage);
    ct_machine_constraint(r->m);
    r->s->sigma_best = 0;
    if (ct_embed_choose(r->s))
        return true;
    r->ctx->ndiagnostic = n; // another place may do
    r->ctx->nerror = nerror;
    return false;
}

// The state half a step h before the start into r->stage; what the step errs by, of `exact`, or INFINITY.
static double look_back(struct ct_run *r, const struct ct_problem *p, double h, void *work,
                        double *before)
{
    const double *y = r->assembled;
    double error;
    if (!choose_beside(r, h / 2, y))
        return INFINITY;
    ct_machine_set(r->m, 0, y);
    ct_machine_motion(r->m);
    memset(r->dy, 0, r->ny * sizeof *r->dy);
    ct_machine_copy(r->dy, r->m->rate, r->m->nq);
    const struct ct_tolerance tolerance = {exact, exact * ct_vector_largest(y, r->ny)};
    if (ct_crossing_lead_in(p, 0, h, y, r->dy, &tolerance, before, &error, work, &r->stats)
            != CT_EVAL_OK
        || !(off_constraints(r, -h / 2, before) <= ct_crossing_held)
        || p->project(r, -h / 2, before) != CT_EVAL_OK)
        return INFINITY;
    return error;
}

// Do root functions keep their signs? What switches on the way is another motion.
static bool keeps_sides(struct ct_run *r, double h, const double *before)
{
    double *now = CT_NEWN(r->arena, double, 2 * (size_t)r->nroot + 1), *then = now + r->nroot;
    ct_run_root(r, 0, r->assembled, now);
    ct_run_root(r, -h / 2, before, then);
    for (int i = 0; i < r->nroot; i++)
        if (!(now[i] * then[i] > 0))
            return false;
    return true;
}

// The step h that errs least, of those that are halves of each other; 0: there is no motion with these speeds.
static double find_step(struct ct_run *r, const struct ct_problem *p, void *work,
                        double *before)
{
    double h = 2 * longest_way / ct_vector_size(r->assembled + r->m->nq, r->m->nu), best = 0;
    double least = fmax(1, unfelt * r->o->rtol / exact) * (1 + DBL_EPSILON);
    for (int i = 0; i < LOOKS && least > 1; i++, h /= 2) {
        const double error = look_back(r, p, h, work, before);
        if (error < least && keeps_sides(r, h, before)) {
            least = error;
            best = h;
        }
    }
    return best;
}

// Speeds that miss (8.23) by more, of their squares, belong to no motion: what rounding of them leaves is far below.
static const double belongs = 1e-7;

static bool refuse_speeds(struct ct_run *r, double misfit, int freedoms)
{
    ct_error(r->ctx, (struct ct_mark){0}, CT_E_STEP_OPEN,
             "the constraints cannot be met beyond t = 0: the run starts in a singular "
             "position, where constraints of %s do not count "
             "and several motions go on, and %s",
             r->singular_joints,
             misfit > belongs ? "the speeds belong to none of them"
                              : "none is found that has these speeds");
    if (misfit > belongs)
        ct_note(r->ctx, (struct ct_mark){0},
                "give the rates of %d joints there, as one motion through the position has "
                "them together: those of now miss that by "
                "%.2g of their squares; or start a little beside it, a joint off by 1e-3, on "
                "the motion that is meant",
                freedoms, misfit);
    return false;
}

// As if nothing had been tried.
static void return_to_start(struct ct_run *r)
{
    ct_machine_set(r->m, 0, r->y);
    ct_machine_constraint(r->m);
    r->s->sigma_best = 0;
    ct_embed_choose(r->s);
}

bool ct_run_lead_in(struct ct_run *r, const struct ct_problem *p)
{
    const double speed = ct_vector_size(r->assembled + r->m->nq, r->m->nu);
    if (!r->singular_joints || !(speed > 0))
        return true;
    if (r->o->step > 0)
        return ct_error(r->ctx, (struct ct_mark){0}, CT_E_STEP_REFUSED,
                        "the run starts in a singular position, where constraints of %s do not "
                        "count: steps of fixed size do not lead "
                        "away from it; leave out 'step'",
                        r->singular_joints);
    double *before = CT_NEWN(r->arena, double, r->ny);
    void *work = ct_crossing.create(r->arena, &ct_crossing, p);
    int freedoms;
    const double misfit = ct_singular_misfit(r->arena, r->s, 0, r->assembled, &freedoms);
    const double h = misfit <= belongs ? find_step(r, p, work, before) : 0;
    if (h == 0 || !(look_back(r, p, h, work, before) < INFINITY)) {
        return_to_start(r);
        return refuse_speeds(r, misfit, freedoms);
    }
    r->t0 = -h / 2;
    memcpy(r->y, before, r->ny * sizeof *before);
    r->singular->keeps_rows = r->method->is_implicit && (size_t)r->s->rank < r->m->nrow;
    ct_singular_expect(r->singular, r->t0, r->y, h / 2);
    return true;
}
