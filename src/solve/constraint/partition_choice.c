// Choice of independent rows and dependent columns; see partition_internal.h.
#include "solve/constraint/partition_internal.h"

#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Rows of J, the best first, into s->row; the number of independent ones.
static int order_rows(struct ct_partition *s)
{
    return ct_evaluator_order_rows(s->m, s->m->J, s->m->rank_tolerance, s->row, s->A, s->b,
                                   s->work);
}

// Columns count by what their speeds move, w (nu, out), where inertias are so different that a heavy dependent speed would
// leave round-off of its forces, eps M_heavy, in the equations of light ones; else all alike. Elastic coordinates are always
// light, and do not ask for it. Those to be kept independent count little.
static void weigh_columns(struct ct_partition *s, double *w)
{
    const double apart = 1e6,
                 little = 0.03; // leaves light ones ten digits; B is as much larger
    const size_t n = s->m->nu;
    double least = INFINITY, most = 0;
    for (size_t j = 0; j < n; j++) {
        const bool is_light = s->m->e->u[j].beam > 0 || ct_speed_is_state(s->m->e, j);
        const double inertia = is_light ? 0 : s->m->M[j + n * j];
        least = inertia > 0 ? fmin(least, inertia) : least;
        most = fmax(most, inertia);
        w[j] = 1;
    }
    for (size_t j = 0; j < n && most > apart * least; j++)
        w[j] = 1 / sqrt(fmax(s->m->M[j + n * j], least));
    for (size_t j = 0; j < n && s->prefers_independent; j++)
        w[j] *= s->prefers_independent[j] ? little : 1;
}

static void take_columns(struct ct_partition *s)
{
    const int n = (int)s->m->nu, r = s->rank;
    for (int j = 0; j < n; j++)
        *(j < r ? &s->dependent[j] : &s->independent[j - r]) = s->column[j];
}

static void choose_columns(struct ct_partition *s)
{
    const int n = (int)s->m->nu, r = s->rank;
    ct_evaluator_dynamics(s->m);
    weigh_columns(s, s->d);
    for (int i = 0; i < r; i++)
        for (int j = 0; j < n; j++)
            s->A[i + r * j] = s->d[j] * *ct_partition_J(s, s->row[i], j);
    ct_qr_pivot(s->A, s->column, s->b, r, n, r, 0, s->work);
    take_columns(s);
}

// The same of a large system, factored: rows and columns in an order in which factors of J_d fill little. False where J_d
// comes out badly conditioned.
static bool choose_sparse_columns(struct ct_partition *s)
{
    struct ct_arena *own = ct_arena_create_under(s->arena);
    double *is_kept = CT_NEWN(own, double, s->m->nrow + 1);
    bool is_clear;
    ct_evaluator_dynamics(s->m);
    weigh_columns(s, s->d);
    for (int i = 0; i < s->rank; i++)
        is_kept[s->row[i]] = 1;
    const struct ct_sparse_entries A = ct_evaluator_sparse_J(s->m, own, s->m->J, is_kept, s->d);
    const bool is_full
        = ct_sparse_pivots_find(own, &A, 0, s->row, s->column, &is_clear) == (size_t)s->rank;
    ct_arena_destroy(own);
    take_columns(s);
    return is_full && ct_partition_factor(s) && s->kappa <= ct_kappa_largest;
}

// The speed with the smallest diagonal entry of M; the first one where nothing has asked for M.
static size_t lightest(const struct ct_partition *s)
{
    const size_t n = s->m->nu;
    size_t least = 0;
    for (size_t i = 1; i < n && s->m->e->has_dynamics; i++)
        if (s->m->M[i + n * i] < s->m->M[least + n * least])
            least = i;
    return least;
}

// What gives all motions of a beam's sections an inertia.
static const char *rotary_of(const struct ct_beam *beam)
{
    if (beam->integration == CT_BEAM_ONE_POINT
        && (beam->has_rotary || beam->theory == CT_BEAM_EULER_BERNOULLI))
        return "'integration: reduced', as the mass at one point of an element leaves some of "
               "its motions none";
    return beam->is_lumped ? "values of 'rotary_inertia', as lumped mass gives sections none"
                           : "a 'rotary_inertia'";
}

// Body i, if that is a beam not all of whose sections' motions have inertia; else NULL.
static const struct ct_body *bare_beam(const struct ct_model *m, size_t i)
{
    const struct ct_beam *beam = m->body[i].beam;
    const bool is_bare = beam && (!beam->has_rotary || beam->integration == CT_BEAM_ONE_POINT);
    return is_bare ? &m->body[i] : NULL;
}

// The beam of that kind that a coordinate moves, of a joint one of the two at its ends; else NULL.
static const struct ct_body *bare_beam_of(const struct ct_model *m, const struct ct_u *u)
{
    if (u->beam <= 0 && u->joint < 0 && u->body < 0) // a state of the model
        return NULL;
    if (u->beam > 0 || u->joint < 0)
        return bare_beam(m, (size_t)(u->beam > 0 ? u->beam : u->body));
    const struct ct_instance *joint = &m->joint[u->joint];
    const struct ct_body *head = bare_beam(m, (size_t)m->frame[joint->to].body);
    return head ? head : bare_beam(m, (size_t)m->frame[joint->from].body);
}

// The key that leaves sections of a beam without inertia; the beam itself where none is given.
static struct ct_mark mark_of_lack(const struct ct_body *body)
{
    const char *const key[]
        = {body->beam->integration == CT_BEAM_ONE_POINT ? "integration" : "rotary_inertia",
           "mass"};
    for (size_t i = 0; i < 2; i++) {
        const struct ct_value *v = ct_instance_value(&body->instance, key[i]);
        if (v->given)
            return v->mark;
    }
    return body->instance.mark;
}

static bool is_held(const struct ct_model *m, int body)
{
    for (size_t i = 0; i < m->njoint; i++) {
        const struct ct_instance *j = &m->joint[i];
        if (j->from >= 0 && (m->frame[j->from].body == body || m->frame[j->to].body == body))
            return true;
    }
    return false;
}

// Of a model without a beam that could lack it.
static bool report_massless(struct ct_partition *s, const struct ct_u *u, const char *name,
                            struct ct_mark mark)
{
    const struct ct_model *m = s->m->model;
    const int b = u->joint >= 0 ? m->frame[m->joint[u->joint].to].body : u->body;
    const char *body = m->body[b].instance.name;
    if (u->joint < 0 && !is_held(m, b))
        return ct_error(
            s->ctx, mark, CT_E_MASSLESS,
            "no joint holds body '%s', and its '%s' moves no mass: give it a joint, "
            "or %s",
            body, name,
            u->is_rotation ? "an 'inertia', or make it 'type: particle'" : "a 'mass'");
    if (!b) // the joint points at the ground
        return ct_error(s->ctx, mark, CT_E_MASSLESS,
                        "coordinate '%s' moves no mass: give %s to what it moves", name,
                        u->is_rotation ? "an 'inertia'" : "a 'mass'");
    return ct_error(s->ctx, mark, CT_E_MASSLESS,
                    "coordinate '%s' moves no mass: give body '%s' %s, or let it carry a body "
                    "that has one",
                    name, body,
                    u->is_rotation
                        ? "an 'inertia' (a mass on the axis itself has none about it)"
                        : "a 'mass'");
}

static bool massless(struct ct_partition *s, size_t speed)
{
    const struct ct_u *u = &s->m->e->u[speed];
    const struct ct_model *model = s->m->model;
    const char *name = u->q >= 0 ? s->m->e->q[u->q].name : u->name;
    const int bare = s->m->e->bare_beam;
    if (bare)
        return ct_error(
            s->ctx, mark_of_lack(&model->body[bare]), CT_E_MASSLESS,
            "coordinate '%s' moves no mass: the first section of beam '%s' has no inertia; "
            "give the beam %s, or, if no moment acts on that section, 'frame: chord'",
            name, model->body[bare].instance.name, rotary_of(model->body[bare].beam));
    if (u->beam > 0 && !(ct_model_number(model, model->body[u->beam].mass) > 0))
        return ct_error(s->ctx, model->body[u->beam].instance.mark, CT_E_MASSLESS,
                        "coordinate '%s' moves no mass: beam '%s' has none; give it a density, "
                        "a mass_per_length, or 'deformation: []'",
                        name, model->body[u->beam].instance.name);
    const struct ct_body *beam = bare_beam_of(model, u);
    if (u->beam > 0 && beam)
        return ct_error(s->ctx, mark_of_lack(beam), CT_E_MASSLESS,
                        "coordinate '%s' moves no mass: give the beam %s%s", name,
                        rotary_of(model->body[u->beam].beam),
                        model->body[u->beam].beam->theory == CT_BEAM_EULER_BERNOULLI
                                && model->body[u->beam].beam->is_lumped
                            ? ", or consistent mass"
                            : "");
    const struct ct_mark mark = u->joint >= 0
                                  ? model->joint[u->joint].mark
                                  : model->body[u->beam > 0 ? u->beam : u->body].instance.mark;
    for (size_t i = 1; i < model->nbody && u->beam > 0 && !beam; i++)
        beam = bare_beam(model, i);
    if (beam)
        return ct_error(s->ctx, mark_of_lack(beam), CT_E_MASSLESS,
                        "coordinate '%s' moves no mass: give beam '%s' %s, or a mass or an "
                        "inertia to what else it moves",
                        name, beam->instance.name, rotary_of(beam->beam));
    return report_massless(s, u, name, mark);
}

// The speed of the joint that turns a beam's first section where that has no inertia: an axis that bends leaves it next to
// none, with which no step is right.
static size_t bare_speed(const struct ct_partition *s)
{
    const struct ct_equations *e = s->m->e;
    for (size_t k = 0; k < e->nu; k++)
        if (e->u[k].joint == e->bare_joint)
            return k;
    return lightest(s);
}

// Pivots that are left of the entries of M are below this of them where they are round-off.
static const double rounding_pivot = 16 * DBL_EPSILON;
// Above this of them no round-off of others hides them.
static const double hidden_pivot = 1e-8;

// Speed k, or the coordinate of a beam that moves the same as it: sections without inertia are what it lacks.
static size_t elastic_beside(const struct ct_partition *s, size_t k)
{
    const size_t n = s->m->nu;
    const double *M = s->m->M;
    if (!s->m->e->has_dynamics)
        return k;
    ct_evaluator_dynamics(s->m);
    for (size_t i = 0; i < n && !s->m->e->u[k].beam; i++) {
        const double both = M[i + n * k] * M[i + n * k], each = M[i + n * i] * M[k + n * k];
        if (s->m->e->u[i].beam > 0 && each > 0 && both > (1 - 1e-12) * each)
            return i;
    }
    return k;
}

// Do coordinates of beams, together, move the same as speed k of a joint or body? What of M_kk they leave is then
// round-off.
static bool is_elastic_motion(struct ct_partition *s, size_t k)
{
    const size_t n = s->m->nu;
    const double *M = s->m->M;
    const struct ct_u *u = s->m->e->u;
    int ne = 0;
    if (u[k].beam > 0)
        return false;
    for (size_t i = 0; i < n; i++)
        if (u[i].beam > 0)
            s->iwork[ne++] = (int)i;
    for (int j = 0; j < ne; j++) {
        const size_t row = (size_t)s->iwork[j];
        for (int i = j; i < ne; i++)
            s->S[i + ne * j] = M[(size_t)s->iwork[i] + n * row];
        s->b[j] = s->r[j] = M[row > k ? row + n * k : k + n * row];
    }
    if (!ne || !ct_cholesky(s->S, ne, ne))
        return false;
    ct_cholesky_solve(s->r, s->S, ne, ne, 1, ne);
    double left = M[k + n * k];
    for (int i = 0; i < ne; i++)
        left -= s->b[i] * s->r[i];
    return left <= rounding_pivot * M[k + n * k];
}

// ---- what elimination leaves of a motion that moves no mass ----------------------------------------------------

// motion (nu, in/out) += |x| times that of independent speed j and those that depend on it, without signs.
static void add_motion(const struct ct_partition *s, int j, double x, double *motion)
{
    motion[s->independent[j]] += fabs(x);
    for (int k = 0; k < s->rank; k++)
        motion[s->dependent[k]] += fabs(s->B[k + s->rank * j] * x);
}

// The motion (nu, out) with one unit of independent speed i whose inertia is pivot i of the factor L of B' M B (f x f), speeds
// behind i at rest: L' x = L_ii e_i. x (f, out)
static void find_pivot_motion(const struct ct_partition *s, int f, int i, double *x,
                              double *motion)
{
    x[i] = 1;
    for (int j = i - 1; j >= 0; j--) {
        x[j] = 0;
        for (int k = j + 1; k <= i; k++)
            x[j] -= s->S[k + f * j] * x[k] / s->S[j + f * j];
    }
    memset(motion, 0, s->m->nu * sizeof *motion);
    for (int j = 0; j <= i; j++)
        add_motion(s, j, x[j], motion);
}

// |z|' |M| |z| over all speeds, or without coordinates of beams
static double gross_inertia(const struct ct_partition *s, const double *z, bool with_beams)
{
    const size_t n = s->m->nu;
    const struct ct_u *u = s->m->e->u;
    double sum = 0;
    for (size_t j = 0; j < n; j++)
        for (size_t i = j; i < n && z[j] > 0; i++)
            if (with_beams || !(u[i].beam > 0 || u[j].beam > 0))
                sum += (i > j ? 2 : 1) * z[i] * z[j] * fabs(s->m->M[i + n * j]);
    return sum;
}

// In the motion z (nu), none of which moves mass: the rotation of a section without inertia that turns most; k where there is none
// or k is one.
static int turned_speed(const struct ct_partition *s, const double *z, int k)
{
    const size_t n = s->m->nu;
    const struct ct_u *u = s->m->e->u;
    double most = 0;
    int named = k;
    for (size_t i = 0; i < n && !bare_beam_of(s->m->model, &u[k]); i++)
        if (u[i].beam > 0 && bare_beam_of(s->m->model, &u[i]) && !(s->m->M[i + n * i] > 0)
            && z[i] > most) {
            most = z[i];
            named = (int)i;
        }
    return named;
}

// The speed of the motion z (nu) to be named: k, or the one of a beam that lacks inertia which moves most of it.
static int lacking_speed(const struct ct_partition *s, const double *z, int k)
{
    const size_t n = s->m->nu;
    const struct ct_u *u = s->m->e->u;
    double most = hidden_pivot * gross_inertia(s, z, true);
    int named = k;
    for (size_t i = 0; i < n && !bare_beam_of(s->m->model, &u[k]); i++) {
        const double moved = z[i] * z[i] * s->m->M[i + n * i];
        if (bare_beam_of(s->m->model, &u[i]) && moved > most) {
            most = moved;
            named = (int)i;
        }
    }
    return named != k ? named : turned_speed(s, z, k);
}

// The largest inertia about an axis of the free rotation that speed k belongs to; 0 if it belongs to none. Axes are known to
// round-off, so that a rod without inertia about its own has what these leave of the others.
static double turned_inertia(const struct ct_partition *s, size_t k)
{
    const size_t n = s->m->nu;
    const struct ct_u *u = s->m->e->u;
    double most = 0;
    for (size_t i = 0; i < n && u[k].q < 0; i++)
        if (u[i].q < 0 && u[i].joint == u[k].joint && u[i].body == u[k].body)
            most = fmax(most, s->m->M[i + n * i]);
    return most;
}

// The first independent speed whose pivot of B' M B is round-off of the inertias that its motion cancels; -1: none. s->S: the
// factor, up to a pivot that is not positive. Of beams: theirs must be half of these inertias at least.
static int rounded_pivot(struct ct_partition *s, int f, bool of_beams)
{
    double *const x = s->work, *const motion = x + f;
    for (int i = 0; i < f; i++) {
        const double root = s->S[i + f * i], pivot = root > 0 ? root * root : 0;
        memset(motion, 0, s->m->nu * sizeof *motion);
        add_motion(s, i, 1, motion);
        const double turned = turned_inertia(s, (size_t)s->independent[i]);
        if (pivot > hidden_pivot * fmax(gross_inertia(s, motion, true), turned))
            continue;
        find_pivot_motion(s, f, i, x, motion);
        const double rigid = gross_inertia(s, motion, false),
                     gross = gross_inertia(s, motion, true);
        if (pivot <= rounding_pivot * turned
            && bare_beam_of(s->m->model, &s->m->e->u[s->independent[i]]))
            return s->independent[i];
        if (pivot <= rounding_pivot * gross && !(of_beams && 2 * rigid > gross))
            return lacking_speed(s, motion, s->independent[i]);
        if (!(root > 0))
            break;
    }
    return -1;
}

// The first speed in the order of s->independent (nu) whose pivot of M is round-off; -1: none.
static int rounded_in_order(struct ct_partition *s, bool of_beams)
{
    const int f = (int)s->m->nu, *speed = s->independent;
    for (int j = 0; j < f; j++)
        for (int i = j; i < f; i++)
            s->S[i + f * j] = s->m->M[speed[i] + f * speed[j]];
    ct_cholesky(s->S, f, f); // as far as it goes
    return rounded_pivot(s, f, of_beams);
}

static void reverse(int *list, int n)
{
    for (int i = 0, j = n - 1; i < j; i++, j--) {
        const int first = list[i];
        list[i] = list[j];
        list[j] = first;
    }
}

// The first speed whose pivot of M is round-off; -1: none. Articulated bodies may keep digits that M loses: there it
// counts where coordinates of beams move the same. Speeds are numbered outwards: from the last to the first next to
// nothing fills, which tells whether there is such a pivot. Only then the slower order of speeds tells which to name.
static int rounded_closed_pivot(struct ct_partition *s, const double *pivot)
{
    const size_t n = s->m->nu;
    const bool is_exact = s->m->e->formulation == CT_FORMULATION_ARTICULATED;
    if (!s->m->e->has_dynamics) // articulated bodies without M
        return -1;
    ct_evaluator_dynamics(s->m);
    bool is_doubtful = false;
    for (size_t i = 0; i < n; i++) {
        if (bare_beam_of(s->m->model, &s->m->e->u[i])
            && pivot[i] <= rounding_pivot * turned_inertia(s, i))
            return (int)i;
        is_doubtful |= pivot[i] <= hidden_pivot * s->m->M[i + n * i];
        if (pivot[i] <= rounding_pivot * s->m->M[i + n * i]
            && !(is_exact && elastic_beside(s, i) == i && !is_elastic_motion(s, i)))
            return (int)i;
    }
    if (!is_doubtful)
        return -1;
    reverse(s->independent, (int)n);
    const bool is_rounded = rounded_in_order(s, is_exact) >= 0;
    reverse(s->independent, (int)n);
    return is_rounded ? rounded_in_order(s, is_exact) : -1;
}

// The beam of an elastic coordinate whose mass is at one point of each element; else NULL.
static const struct ct_body *pointed_beam(const struct ct_partition *s, size_t k)
{
    const struct ct_u *u = &s->m->e->u[k];
    const struct ct_body *body = u->beam > 0 ? &s->m->model->body[u->beam] : NULL;
    return body && body->beam->integration == CT_BEAM_ONE_POINT ? body : NULL;
}

// What one point of an element leaves no mass may have a little with `modes`: such motions are much faster than all others. Once.
static void warn_of_points(struct ct_partition *s)
{
    const size_t n = s->m->nu;
    const struct ct_body *found = NULL;
    double part
        = 1e-6; // of the coordinate's own inertia: a thousand times as fast as that would let it be
    for (size_t k = 0; k < n; k++)
        found = found ? found : pointed_beam(s, k);
    if (!found || s->switches != 1 || !s->m->e->has_dynamics)
        return;
    bool *follows = CT_NEWN(s->arena, bool, n + 1);
    double *left = CT_NEWN(s->arena, double, n + 1);
    for (size_t k = 0; k < n; k++)
        follows[k] = !pointed_beam(s, k);
    ct_evaluator_dynamics(s->m);
    found = NULL;
    if (!ct_partition_inertias(s, follows, left))
        return;
    for (size_t k = 0; k < n; k++)
        if (left[k] <= part * s->m->M[k + n * k]) {
            part = left[k] / s->m->M[k + n * k];
            found = pointed_beam(s, k);
        }
    if (found)
        ct_warning(s->ctx, mark_of_lack(found), 0,
                   "the mass at one point of an element leaves a motion of beam '%s' next to "
                   "none of its "
                   "inertia: it is much faster than all others; take 'integration: reduced'",
                   found->instance.name);
}

// The pivots of a solution in closed form must be positive. Behind one that is not, others are no numbers.
static bool has_inertia(struct ct_partition *s)
{
    const size_t n = s->m->nu;
    const double *pivot = s->m->solved.out + n + s->m->nq;
    size_t least = 0;
    ct_program_run(&s->m->solved, s->m->input);
    for (size_t i = 1; i < n; i++)
        if (isnan(pivot[least]) || fabs(pivot[i]) < fabs(pivot[least]))
            least = i;
    for (size_t i = 0; i < n; i++)
        if (!(pivot[i] > 0))
            return massless(s, elastic_beside(s, pivot[least] > 0 ? i : least));
    const int rounded = rounded_closed_pivot(s, pivot);
    if (rounded < 0)
        warn_of_points(s);
    return rounded < 0 || massless(s, elastic_beside(s, (size_t)rounded));
}

// Time in which a coordinate has moved by `way` along the motion of now, the first one; 0 at rest.
static double time_ahead(const struct ct_partition *s, double way)
{
    const size_t n = s->m->e->nmotion;
    const double u = ct_vector_max_norm(s->m->input + s->m->at_u, n),
                 a = ct_vector_max_norm(s->a, n);
    return u > 0 || a > 0 ? 2 * way / (u + sqrt(u * u + 2 * way * a)) : 0;
}

// Rows and columns chosen by what they are ahead on the motion, with u' as found last; the evaluator's input stays.
static void choose_there(struct ct_partition *s)
{
    const double way
        = 0.3; // [rad or m]: far enough to tell them apart, near enough to be known
    struct ct_evaluator *m = s->m;
    double *q = m->input + m->at_q;
    const double *u = m->input + m->at_u, h = time_ahead(s, way);
    for (size_t k = 0; k < m->nu; k++)
        s->r[k] = h * (u[k] + h / 2 * s->a[k]);
    memcpy(s->q, q, m->nq * sizeof *q);
    ct_evaluator_retract(m, q, s->r);
    ct_evaluator_constraint(m);
    order_rows(s);
    ct_evaluator_leave_out(s->m, s->row, s->rank);
    choose_columns(s);
    memcpy(q, s->q, m->nq * sizeof *q);
    ct_evaluator_constraint(m);
}

static bool choose_here(struct ct_partition *s)
{
    s->rank = order_rows(s);
    ct_evaluator_leave_out(s->m, s->row, s->rank);
    if (ct_partition_is_large(s) && choose_sparse_columns(s))
        return true;
    choose_columns(s);
    return ct_partition_factor(s);
}

// In a symmetric position, where many motions begin, several choices are equally good, and only further on some of them
// fail. Where the choice ahead is nearly as good here it is taken: another one costs more than many steps.
static bool choose_ahead(struct ct_partition *s)
{
    const double nearly = 0.5;
    if (!choose_here(s) || ct_partition_is_large(s) || s->rank == (int)s->m->nu
        || s->m->e->solution)
        return true;
    const double sigma = s->sigma, kappa = s->kappa;
    ct_evaluator_dynamics(s->m);
    if (ct_partition_accelerate(s) != CT_EVAL_OK)
        return false;
    choose_there(s);
    return (ct_partition_factor(s) && s->sigma >= nearly * sigma && nearly * s->kappa <= kappa)
        || choose_here(s);
}

bool ct_partition_choose(struct ct_partition *s)
{
    s->switches++;
    s->rank = 0;
    for (int j = 0; j < (int)s->m->nu; j++)
        s->independent[j] = j;
    if (!s->m->nrow)
        ct_partition_factor(s);
    else if (!choose_ahead(s) && !choose_here(s))
        return massless(s, lightest(s));
    s->kappa_chosen = s->kappa;
    s->sigma_chosen = s->sigma;
    s->sigma_best = fmax(s->sigma_best, s->sigma);
    if (s->m->e->bare_beam)
        return massless(s, bare_speed(s));
    if (s->m->e->solution)
        return has_inertia(s);
    ct_evaluator_dynamics(s->m);
    const bool is_regular = ct_partition_accelerate(s) == CT_EVAL_OK;
    const int rounded = rounded_pivot(s, (int)s->m->nu - s->rank, false);
    if (rounded >= 0 || !is_regular)
        return massless(s, rounded >= 0 ? (size_t)rounded : lightest(s));
    warn_of_points(s);
    ct_partition_select_solver(s);
    return true;
}
