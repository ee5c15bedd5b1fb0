// Choice of independent rows and dependent columns; see partition_internal.h.
#include "solve/constraint/partition_internal.h"

#include "numeric/dense.h"
#include "numeric/roundoff.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Rows of J into s->row in the order of their pivots; returns how many are independent.
static int order_rows(struct ct_partition *s)
{
    return ct_evaluator_order_rows(s->m, s->m->J, s->m->rank_tolerance, s->row, s->A, s->b,
                                   s->work);
}

// Weights w (nu, out) of the columns in the choice of pivots. All are 1 unless inertias differ very
// much: then a column has the weight 1/sqrt(M_kk), so that light speeds become dependent. A heavy
// dependent speed would bring the round-off of its forces, eps M_heavy, into the equations of light
// independent ones. Elastic coordinates are always light and are not compared. Speeds that are
// preferred as independent have a small weight.
static void weigh_columns(struct ct_partition *s, double *w)
{
    // inertia_ratio: ratio of the largest to the smallest inertia from which weights are used.
    // Round-off of the heavy equations is 1e6 eps = 2e-10 of the light ones, which then have ten
    // digits.
    // preferred_weight: weight of preferred speeds; entries of B may become 1/preferred_weight = 33
    // times larger.
    // Chosen: the wishes for independent speeds against the conditioning of J_d.
    const double inertia_ratio = 1e6, preferred_weight = 0.03;
    const size_t n = s->m->nu;
    double least = INFINITY, most = 0;
    for (size_t j = 0; j < n; j++) {
        const bool is_light = s->m->e->u[j].beam > 0 || ct_speed_is_state(s->m->e, j);
        const double inertia = is_light ? 0 : s->m->M[j + n * j];
        least = inertia > 0 ? fmin(least, inertia) : least;
        most = fmax(most, inertia);
        w[j] = 1;
    }
    for (size_t j = 0; j < n && most > inertia_ratio * least; j++)
        w[j] = 1 / sqrt(fmax(s->m->M[j + n * j], least));
    for (size_t j = 0; j < n && s->prefers_independent; j++)
        w[j] *= s->prefers_independent[j] ? preferred_weight : 1;
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

// The same for a large system: rows and columns in an order in which the factors of J_d have little
// fill. J_d is factored at the end. False if it is badly conditioned.
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

// For a message: what would give all motions of a beam's sections an inertia.
static const char *rotary_of(const struct ct_beam *beam)
{
    if (beam->integration == CT_BEAM_ONE_POINT
        && (beam->has_rotary || beam->theory == CT_BEAM_EULER_BERNOULLI))
        return "'integration: reduced', as the mass at one point of an element leaves some of "
               "its motions none";
    return beam->is_lumped ? "values of 'rotary_inertia', as lumped mass gives sections none"
                           : "a 'rotary_inertia'";
}

// Body i if it is a beam in which some motion of a section has no inertia; else NULL.
static const struct ct_body *bare_beam(const struct ct_model *m, size_t i)
{
    const struct ct_beam *beam = m->body[i].beam;
    const bool is_bare = beam && (!beam->has_rotary || beam->integration == CT_BEAM_ONE_POINT);
    return is_bare ? &m->body[i] : NULL;
}

// The beam of that kind that a coordinate moves, for a joint one at its ends; NULL if there is
// none.
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

// The error for a model in which no beam lacks inertia.
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

// The speed of the joint that turns the first section of a beam, where sections have no inertia. A
// bent axis gives that rotation a tiny inertia, with which no step would be accurate.
static size_t bare_speed(const struct ct_partition *s)
{
    const struct ct_equations *e = s->m->e;
    for (size_t k = 0; k < e->nu; k++)
        if (e->u[k].joint == e->bare_joint)
            return k;
    return lightest(s);
}

// A pivot of M or B' M B that is at most this part of the terms it is the sum of is round-off, and
// the motion has no inertia.
// Chosen: round-off of a sum of several terms against small inertias that are meant.
static const double roundoff_pivot = 16 * DBL_EPSILON;

// The elastic coordinate that moves the same masses as speed k, if there is one; else k. A message
// names it, as the beam whose sections have no inertia is the cause.
static size_t elastic_beside(const struct ct_partition *s, size_t k)
{
    const size_t n = s->m->nu;
    const double *M = s->m->M;
    if (!s->m->e->has_dynamics)
        return k;
    ct_evaluator_dynamics(s->m);
    for (size_t i = 0; i < n && !s->m->e->u[k].beam; i++) {
        const double both = M[i + n * k] * M[i + n * k], each = M[i + n * i] * M[k + n * k];
        // Chosen: motions that agree to 1e-6, the root, count as one; only a message depends on it
        if (s->m->e->u[i].beam > 0 && each > 0 && both > (1 - 1e-12) * each)
            return i;
    }
    return k;
}

// Is the motion of speed k, of a joint or body, a sum of elastic motions of beams? Then elimination
// of the elastic coordinates leaves only round-off of M_kk.
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
    return left <= roundoff_pivot * M[k + n * k];
}

// ---- what elimination leaves of a motion that moves no mass -------------------------------------

// motion (nu, in/out) += |x| times the absolute values of column j of [B; 1]: independent speed j
// with the dependent speeds that follow from it.
static void add_motion(const struct ct_partition *s, int j, double x, double *motion)
{
    motion[s->independent[j]] += fabs(x);
    for (int k = 0; k < s->rank; k++)
        motion[s->dependent[k]] += fabs(s->B[k + s->rank * j] * x);
}

// The motion (nu, out) whose inertia is pivot i of B' M B = L L' (f x f). Independent speed i is 1,
// later ones are at rest, and earlier ones follow from L' x = L_ii e_i. x (f, out)
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

// |z|' |M| |z|, over all speeds or without the elastic coordinates of beams.
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

// The speed that a message names for a motion z (nu) without inertia: among the rotations of beam
// sections without inertia the one that turns most. k if there is none, or if k is one itself.
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

// The speed that a message names for the motion z (nu): k, or the speed of a beam without rotary
// inertia that has the largest kinetic energy in it.
static int lacking_speed(const struct ct_partition *s, const double *z, int k)
{
    const size_t n = s->m->nu;
    const struct ct_u *u = s->m->e->u;
    double most = CT_HALF_DIGITS * gross_inertia(s, z, true);
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

// The largest inertia about an axis of the free rotation that speed k belongs to; 0 if it belongs
// to none. The directions of axes have round-off: a thin rod has about its own axis, instead of 0,
// a round-off of its inertia about the others.
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

// The first independent speed whose pivot of B' M B is only round-off of the terms that cancel in
// it; -1: none. s->S is the Cholesky factor, up to the first pivot that is not positive. of_beams:
// only motions count in which elastic coordinates have at least half of these terms.
static int rounded_pivot(struct ct_partition *s, int f, bool of_beams)
{
    double *const x = s->work, *const motion = x + f;
    for (int i = 0; i < f; i++) {
        const double root = s->S[i + f * i], pivot = root > 0 ? root * root : 0;
        memset(motion, 0, s->m->nu * sizeof *motion);
        add_motion(s, i, 1, motion);
        const double turned = turned_inertia(s, (size_t)s->independent[i]);
        if (pivot > CT_HALF_DIGITS * fmax(gross_inertia(s, motion, true), turned))
            continue;
        find_pivot_motion(s, f, i, x, motion);
        const double rigid = gross_inertia(s, motion, false),
                     gross = gross_inertia(s, motion, true);
        if (pivot <= roundoff_pivot * turned
            && bare_beam_of(s->m->model, &s->m->e->u[s->independent[i]]))
            return s->independent[i];
        if (pivot <= roundoff_pivot * gross && !(of_beams && 2 * rigid > gross))
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

// The first speed whose pivot of M is round-off; -1: none. The articulated-body method may keep
// digits that M loses: with it a pivot counts only where an elastic motion is the same. Speeds are
// numbered from the base outwards, so elimination from the last to the first has next to no fill.
// It tells whether there is such a pivot. Only then elimination in the order of speeds, which is
// slower, tells which speed a message names.
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
            && pivot[i] <= roundoff_pivot * turned_inertia(s, i))
            return (int)i;
        is_doubtful |= pivot[i] <= CT_HALF_DIGITS * s->m->M[i + n * i];
        if (pivot[i] <= roundoff_pivot * s->m->M[i + n * i]
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

// Warn once of a motion with very little inertia. Mass at one point of an element gives some
// motions of the element none; in coordinates of `modes` they may have a little, and are then much
// faster than all others.
static void warn_of_points(struct ct_partition *s)
{
    const size_t n = s->m->nu;
    const struct ct_body *found = NULL;
    // The part of the coordinate's own inertia that is left while the others are free to follow.
    // Chosen: at 1e-6 the motion is a thousand times, the root, as fast as with all of it.
    double part = 1e-6;
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

// The pivots of a solution in closed form must be positive. After one that is not, the next ones
// may be NaN.
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

// The time in which the first coordinate has moved by `way`, with speeds and accelerations as they
// are at the evaluator's input; 0 at rest.
static double time_ahead(const struct ct_partition *s, double way)
{
    const size_t n = s->m->e->nmotion;
    const double u = ct_vector_max_norm(s->m->input + s->m->at_u, n),
                 a = ct_vector_max_norm(s->a, n);
    return u > 0 || a > 0 ? 2 * way / (u + sqrt(u * u + 2 * way * a)) : 0;
}

// Choose rows and columns by their coefficients a little later on the motion, extrapolated with the
// accelerations found last. The evaluator's input is unchanged at the end.
static void choose_there(struct ct_partition *s)
{
    // Default: far enough for the choices to differ, near enough for the extrapolation to hold.
    // Test: solvers
    const double way = 0.3; // [rad or m]
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

// Many motions begin in a symmetric configuration, where several choices are equally good and some
// fail soon after. The choice that is best a little later is taken if it is nearly as good here: it
// spares a second choice, which costs more than many steps.
static bool choose_ahead(struct ct_partition *s)
{
    // Chosen: conditioning here against a choice that lasts.
    const double nearly_as_good = 0.5;
    if (!choose_here(s) || ct_partition_is_large(s) || s->rank == (int)s->m->nu
        || s->m->e->solution)
        return true;
    const double sigma = s->sigma, kappa = s->kappa;
    ct_evaluator_dynamics(s->m);
    if (ct_partition_accelerate(s) != CT_EVAL_OK)
        return false;
    choose_there(s);
    return (ct_partition_factor(s) && s->sigma >= nearly_as_good * sigma
            && nearly_as_good * s->kappa <= kappa)
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
