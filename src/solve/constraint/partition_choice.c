// Choice of independent rows and dependent columns; see partition_internal.h.
#include "solve/constraint/partition_internal.h"

#include "numeric/dense.h"
#include "numeric/envelope.h"
#include "numeric/roundoff.h"

#include <float.h>
#include <math.h>
#include <string.h>

// s->row = rows of J in the order of their pivots. Returns the rank.
static int order_rows(struct ct_partition *s)
{
    return ct_evaluator_order_rows(s->m, s->m->J, s->m->rank_tolerance, s->row, s->A, s->b,
                                   s->work);
}

// Weights w (nu, out) of the columns in the choice of pivots. They are 1 unless inertias differ
// very much: then a column has the weight 1/sqrt(M_kk), so that speeds of small inertia become
// dependent. A dependent speed of large inertia would bring the round-off of its forces, eps
// M_large, into the equations of independent ones. Elastic coordinates always have small
// inertia and are not compared. Speeds preferred as independent have the smallest weight with
// which entries of B, at most 1 without it, remain below ct_kappa_largest.
static void find_column_weights(struct ct_partition *s, double *w)
{
    // Weights are used where the largest inertia is more than this many times the smallest.
    // Derived: the square of ct_kappa_largest; round-off of the heavy equations is 1e6 eps = 2e-10
    // of the light ones, which then have ten digits.
    const double inertia_ratio = 1e6;
    const size_t n = s->m->nu;
    double least = INFINITY, most = 0;
    for (size_t j = 0; j < n; j++) {
        const bool is_light = s->m->e->u[j].beam > 0 || ct_speed_is_state(s->m->e, j);
        const double inertia = is_light ? 0 : ct_evaluator_inertia(s->m, j);
        least = inertia > 0 ? fmin(least, inertia) : least;
        most = fmax(most, inertia);
        w[j] = 1;
    }
    for (size_t j = 0; j < n && most > inertia_ratio * least; j++)
        w[j] = 1 / sqrt(fmax(ct_evaluator_inertia(s->m, j), least));
    for (size_t j = 0; j < n && s->prefers_independent; j++)
        w[j] /= s->prefers_independent[j] ? ct_kappa_largest : 1;
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
    find_column_weights(s, s->d);
    for (int i = 0; i < r; i++)
        for (int j = 0; j < n; j++)
            s->A[i + r * j] = s->d[j] * *ct_partition_J(s, s->row[i], j);
    ct_qr_pivot(s->A, s->column, s->b, r, n, r, 0, s->work);
    take_columns(s);
}

// The same for a large system: rows and columns in an order that gives the factors of J_d
// little fill-in. J_d is factored at the end. False if it is ill-conditioned.
static bool choose_sparse_columns(struct ct_partition *s)
{
    struct ct_arena *own = ct_arena_create_under(s->arena);
    double *is_kept = CT_NEWN(own, double, s->m->nrow + 1);
    bool is_clear;
    ct_evaluator_dynamics(s->m);
    find_column_weights(s, s->d);
    for (int i = 0; i < s->rank; i++)
        is_kept[s->row[i]] = 1;
    const struct ct_sparse_entries A = ct_evaluator_sparse_J(s->m, own, s->m->J, is_kept, s->d);
    const bool is_full
        = ct_sparse_pivots_find(own, &A, 0, s->row, s->column, &is_clear) == (size_t)s->rank;
    ct_arena_destroy(own);
    take_columns(s);
    return is_full && ct_partition_factor(s) && s->kappa <= ct_kappa_largest;
}

// The speed with the smallest diagonal entry of M; the first one if the equations have no M.
static size_t lightest(const struct ct_partition *s)
{
    size_t least = 0;
    for (size_t i = 1; i < s->m->nu; i++)
        if (ct_evaluator_inertia(s->m, i) < ct_evaluator_inertia(s->m, least))
            least = i;
    return least;
}

// For a message: the key that gives all motions of a beam's sections an inertia.
static const char *missing_inertia_key(const struct ct_beam *beam)
{
    if (beam->integration == CT_BEAM_ONE_POINT
        && (beam->has_rotary || beam->theory == CT_BEAM_EULER_BERNOULLI))
        return "'integration: reduced', as the mass at one point of an element leaves some of "
               "its motions none";
    return beam->is_lumped ? "values of 'rotary_inertia', as lumped mass gives sections none"
                           : "a 'rotary_inertia'";
}

// Body i if it is a beam with a motion of its sections that has no inertia; else NULL.
static const struct ct_body *beam_without_inertia(const struct ct_model *m, size_t i)
{
    const struct ct_beam *beam = m->body[i].beam;
    const bool is_bare = beam && (!beam->has_rotary || beam->integration == CT_BEAM_ONE_POINT);
    return is_bare ? &m->body[i] : NULL;
}

// The beam of that kind that a coordinate moves, for a joint one of its two bodies; NULL if
// there is none.
static const struct ct_body *beam_without_inertia_of(const struct ct_model *m,
                                                     const struct ct_u *u)
{
    if (u->beam <= 0 && u->joint < 0 && u->body < 0) // a state of the model
        return NULL;
    if (u->beam > 0 || u->joint < 0)
        return beam_without_inertia(m, (size_t)(u->beam > 0 ? u->beam : u->body));
    const struct ct_instance *joint = &m->joint[u->joint];
    const struct ct_body *head = beam_without_inertia(m, (size_t)m->frame[joint->to].body);
    return head ? head : beam_without_inertia(m, (size_t)m->frame[joint->from].body);
}

// Position of the key that leaves sections of a beam without inertia; that of the beam if none
// is given.
static struct ct_mark inertia_key_mark(const struct ct_body *body)
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

static bool has_joint(const struct ct_model *m, int body)
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
    if (u->joint < 0 && !has_joint(m, b))
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

static bool report_no_inertia(struct ct_partition *s, size_t speed)
{
    const struct ct_u *u = &s->m->e->u[speed];
    const struct ct_model *model = s->m->model;
    const char *name = u->q >= 0 ? s->m->e->q[u->q].name : u->name;
    const int bare = s->m->e->bare_beam;
    if (bare)
        return ct_error(
            s->ctx, inertia_key_mark(&model->body[bare]), CT_E_MASSLESS,
            "coordinate '%s' moves no mass: the first section of beam '%s' has no inertia; "
            "give the beam %s, or, if no moment acts on that section, 'frame: chord'",
            name, model->body[bare].instance.name, missing_inertia_key(model->body[bare].beam));
    if (u->beam > 0 && !(ct_model_number(model, model->body[u->beam].mass) > 0))
        return ct_error(s->ctx, model->body[u->beam].instance.mark, CT_E_MASSLESS,
                        "coordinate '%s' moves no mass: beam '%s' has none; give it a density, "
                        "a mass_per_length, or 'deformation: []'",
                        name, model->body[u->beam].instance.name);
    const struct ct_body *beam = beam_without_inertia_of(model, u);
    if (u->beam > 0 && beam)
        return ct_error(s->ctx, inertia_key_mark(beam), CT_E_MASSLESS,
                        "coordinate '%s' moves no mass: give the beam %s%s", name,
                        missing_inertia_key(model->body[u->beam].beam),
                        model->body[u->beam].beam->theory == CT_BEAM_EULER_BERNOULLI
                                && model->body[u->beam].beam->is_lumped
                            ? ", or consistent mass"
                            : "");
    const struct ct_mark mark = u->joint >= 0
                                  ? model->joint[u->joint].mark
                                  : model->body[u->beam > 0 ? u->beam : u->body].instance.mark;
    for (size_t i = 1; i < model->nbody && u->beam > 0 && !beam; i++)
        beam = beam_without_inertia(model, i);
    if (beam)
        return ct_error(s->ctx, inertia_key_mark(beam), CT_E_MASSLESS,
                        "coordinate '%s' moves no mass: give beam '%s' %s, or a mass or an "
                        "inertia to what else it moves",
                        name, beam->instance.name, missing_inertia_key(beam->beam));
    return report_massless(s, u, name, mark);
}

// The speed of the joint that rotates the first section of a beam whose sections have no
// inertia. A bent axis gives that rotation a tiny inertia, with which no step would be
// accurate.
static size_t first_section_speed(const struct ct_partition *s)
{
    const struct ct_equations *e = s->m->e;
    for (size_t k = 0; k < e->nu; k++)
        if (e->u[k].joint == e->bare_joint)
            return k;
    return lightest(s);
}

// A pivot of M or B' M B of at most this fraction of its terms is round-off: the motion has no
// inertia. Default: round-off of a sum of several terms against small inertias that are intended.
// Test: massless_beams
static const double roundoff_pivot = 16 * DBL_EPSILON;

// The elastic coordinate that moves the same masses as speed k, if there is one; else k. A
// message names it, as the beam whose sections have no inertia is the cause.
static size_t equivalent_elastic_speed(const struct ct_partition *s, size_t k)
{
    const struct ct_equations *e = s->m->e;
    const double own = ct_evaluator_inertia(s->m, k);
    size_t found = k;
    if (!e->has_dynamics)
        return k;
    ct_evaluator_dynamics(s->m);
    for (size_t l = 0; l < e->nM && !e->u[k].beam; l++) {
        const size_t row = (size_t)e->M[l].row, column = (size_t)e->M[l].column;
        const size_t i = row == k ? column : row;
        const double both = s->m->M[l] * s->m->M[l], each = ct_evaluator_inertia(s->m, i) * own;
        // the cosine of both motions is one to half of its digits
        if ((row == k || column == k) && e->u[i].beam > 0 && each > 0
            && both > (1 - CT_HALF_DIGITS) * each && (found == k || i < found))
            found = i;
    }
    return found;
}

// M of the n speeds in `speed`, factored in that order up to the first pivot that is not positive:
// the number of pivots before it. The factor lives in scratch.
static int factor_in_order(struct ct_partition *s, struct ct_arena *scratch, const int *speed,
                           int n, struct ct_envelope *L)
{
    const struct ct_equations *e = s->m->e;
    int *place = CT_NEWN(scratch, int, e->nu + 1), *first = CT_NEWN(scratch, int, n + 1);
    for (size_t k = 0; k < e->nu; k++)
        place[k] = -1;
    for (int i = 0; i < n; i++)
        place[speed[i]] = first[i] = i;
    for (int again = 0; again < 2; again++) {
        for (size_t l = 0; l < e->nM; l++) {
            const int r = place[e->M[l].row], c = place[e->M[l].column];
            const int i = r > c ? r : c, j = r > c ? c : r;
            if (j >= 0 && again)
                *ct_envelope_at(L, i, j) = s->m->M[l];
            else if (j >= 0 && j < first[i])
                first[i] = j;
        }
        if (!again)
            *L = ct_envelope_create(scratch, first, n);
    }
    return ct_envelope_cholesky(L);
}

// Is the motion of speed k, of a joint or body, a sum of elastic motions of beams? Then only
// round-off of M_kk remains after elimination of the elastic coordinates.
static bool is_elastic_motion(struct ct_partition *s, size_t k)
{
    const struct ct_u *u = s->m->e->u;
    int ne = 0, *speed = s->column;
    for (size_t i = s->m->nu; i-- > 0;)
        if (u[i].beam > 0)
            speed[ne++] = (int)i;
    speed[ne] = (int)k;
    if (u[k].beam > 0 || !ne)
        return false;
    struct ct_arena *scratch = ct_arena_create_under(s->arena);
    struct ct_envelope L;
    const int npivot = factor_in_order(s, scratch, speed, ne + 1, &L);
    const double last = *ct_envelope_at(&L, ne, ne), pivot = last > 0 ? last * last : 0;
    ct_arena_destroy(scratch);
    return npivot >= ne && pivot <= roundoff_pivot * ct_evaluator_inertia(s->m, k);
}

// ---- motions without inertia --------------------------------------------------------------------

// motion (nu, in/out) += |x| times the absolute values of column j of [B; 1].
static void add_motion(const struct ct_partition *s, int j, double x, double *motion)
{
    motion[s->independent[j]] += fabs(x);
    for (int k = 0; k < s->rank; k++)
        motion[s->dependent[k]] += fabs(s->B[k + s->rank * j] * x);
}

// The motion (nu, out) whose inertia is pivot i of B' M B = L L'. Independent speed i is 1, later
// ones are at rest, and earlier ones follow from L' x = L_ii e_i. x (i + 1, out)
static void find_pivot_motion(const struct ct_partition *s, const struct ct_envelope *L, int i,
                              double *x, double *motion)
{
    memset(x, 0, (size_t)i * sizeof *x);
    x[i] = 1;
    for (int k = i; k >= 0; k--) {
        x[k] /= k < i ? *ct_envelope_at(L, k, k) : 1;
        for (int j = L->first[k]; j < k; j++)
            x[j] -= *ct_envelope_at(L, k, j) * x[k];
    }
    memset(motion, 0, s->m->nu * sizeof *motion);
    for (int j = 0; j <= i; j++)
        add_motion(s, j, x[j], motion);
}

// |z|' |M| |z|, over all speeds or without elastic coordinates.
static double sum_of_inertia_terms(const struct ct_partition *s, const double *z,
                                   bool with_beams)
{
    const struct ct_equations *e = s->m->e;
    double sum = 0;
    for (size_t i = 0; i < e->nu; i++)
        for (int k = s->m->mass_row[i]; z[i] > 0 && k < s->m->mass_row[i + 1]; k++) {
            const size_t j = (size_t)e->M[k].column;
            if (with_beams || !(e->u[i].beam > 0 || e->u[j].beam > 0))
                sum += (i > j ? 2 : 1) * z[i] * z[j] * fabs(s->m->M[k]);
        }
    return sum;
}

// The speed that a message names for a motion z (nu) without inertia: the largest rotation of a
// beam section without inertia. k if there is none, or if k is one itself.
static int largest_section_rotation(const struct ct_partition *s, const double *z, int k)
{
    const size_t n = s->m->nu;
    const struct ct_u *u = s->m->e->u;
    double most = 0;
    int named = k;
    for (size_t i = 0; i < n && !beam_without_inertia_of(s->m->model, &u[k]); i++)
        if (u[i].beam > 0 && beam_without_inertia_of(s->m->model, &u[i])
            && !(ct_evaluator_inertia(s->m, i) > 0) && z[i] > most) {
            most = z[i];
            named = (int)i;
        }
    return named;
}

// The speed that a message names for the motion z (nu): k, or the speed of a beam without rotary
// inertia that has the largest kinetic energy in it.
static int speed_without_inertia(const struct ct_partition *s, const double *z, int k)
{
    const size_t n = s->m->nu;
    const struct ct_u *u = s->m->e->u;
    double most = CT_HALF_DIGITS * sum_of_inertia_terms(s, z, true);
    int named = k;
    for (size_t i = 0; i < n && !beam_without_inertia_of(s->m->model, &u[k]); i++) {
        const double moved = z[i] * z[i] * ct_evaluator_inertia(s->m, i);
        if (beam_without_inertia_of(s->m->model, &u[i]) && moved > most) {
            most = moved;
            named = (int)i;
        }
    }
    return named != k ? named : largest_section_rotation(s, z, k);
}

// The largest inertia among the axes of the free rotation that speed k belongs to; 0 if it
// belongs to none. A thin rod has about its own axis, instead of 0, the round-off of its
// inertia about others.
static double rotation_inertia(const struct ct_partition *s, size_t k)
{
    const size_t n = s->m->nu;
    const struct ct_u *u = s->m->e->u;
    double most = 0;
    for (size_t i = 0; i < n && u[k].q < 0; i++)
        if (u[i].q < 0 && u[i].joint == u[k].joint && u[i].body == u[k].body)
            most = fmax(most, ct_evaluator_inertia(s->m, i));
    return most;
}

// The first independent speed whose pivot of B' M B is round-off of the terms that cancel in
// it; -1: none. L: the Cholesky factor, up to the first pivot that is not positive.
// of_beams: only motions in which elastic coordinates contribute at least half of the terms.
static int roundoff_pivot_speed(struct ct_partition *s, const struct ct_envelope *L,
                                bool of_beams)
{
    double *const x = s->work, *const motion = x + L->n;
    for (int i = 0; i < L->n; i++) {
        const double root = *ct_envelope_at(L, i, i), pivot = root > 0 ? root * root : 0;
        memset(motion, 0, s->m->nu * sizeof *motion);
        add_motion(s, i, 1, motion);
        const double turned = rotation_inertia(s, (size_t)s->independent[i]);
        if (pivot > CT_HALF_DIGITS * fmax(sum_of_inertia_terms(s, motion, true), turned))
            continue;
        find_pivot_motion(s, L, i, x, motion);
        const double rigid = sum_of_inertia_terms(s, motion, false),
                     gross = sum_of_inertia_terms(s, motion, true);
        if (pivot <= roundoff_pivot * turned
            && beam_without_inertia_of(s->m->model, &s->m->e->u[s->independent[i]]))
            return s->independent[i];
        if (pivot <= roundoff_pivot * gross && !(of_beams && 2 * rigid > gross))
            return speed_without_inertia(s, motion, s->independent[i]);
        if (!(root > 0))
            break;
    }
    return -1;
}

// The first speed in the order of s->independent (nu) whose pivot of M is round-off; -1: none.
static int roundoff_pivot_in_order(struct ct_partition *s, bool of_beams)
{
    struct ct_arena *scratch = ct_arena_create_under(s->arena);
    struct ct_envelope L;
    factor_in_order(s, scratch, s->independent, (int)s->m->nu, &L);
    const int speed = roundoff_pivot_speed(s, &L, of_beams);
    ct_arena_destroy(scratch);
    return speed;
}

// The same for the Cholesky factor of B' M B in s->S.
static int roundoff_pivot_of_reduced(struct ct_partition *s)
{
    const int f = (int)s->m->nu - s->rank;
    struct ct_arena *scratch = ct_arena_create_under(s->arena);
    memset(s->iwork, 0, (size_t)f * sizeof *s->iwork);
    const struct ct_envelope L = ct_envelope_create(scratch, s->iwork, f);
    for (int j = 0; j < f; j++)
        for (int i = j; i < f; i++)
            *ct_envelope_at(&L, i, j) = s->S[i + f * j];
    const int speed = roundoff_pivot_speed(s, &L, false);
    ct_arena_destroy(scratch);
    return speed;
}

static void reverse(int *list, int n)
{
    for (int i = 0, j = n - 1; i < j; i++, j--) {
        const int first = list[i];
        list[i] = list[j];
        list[j] = first;
    }
}

// The first speed whose pivot of M is round-off; -1: none. The articulated-body method may be
// accurate where M is not: with it a pivot counts only where an elastic motion is equivalent.
// Speeds are numbered from the base outwards, so elimination from the last to the first has
// almost no fill-in. It decides whether there is such a pivot. Only then is the speed named in
// a message found by elimination in the order of speeds, which is slower.
static int roundoff_pivot_of_solution(struct ct_partition *s, const double *pivot)
{
    const size_t n = s->m->nu;
    const bool is_exact = s->m->e->formulation == CT_FORMULATION_ARTICULATED;
    if (!s->m->e->has_dynamics) // articulated bodies without M
        return -1;
    ct_evaluator_dynamics(s->m);
    bool is_doubtful = false;
    for (size_t i = 0; i < n; i++) {
        if (beam_without_inertia_of(s->m->model, &s->m->e->u[i])
            && pivot[i] <= roundoff_pivot * rotation_inertia(s, i))
            return (int)i;
        is_doubtful |= pivot[i] <= CT_HALF_DIGITS * ct_evaluator_inertia(s->m, i);
        if (pivot[i] <= roundoff_pivot * ct_evaluator_inertia(s->m, i)
            && !(is_exact && equivalent_elastic_speed(s, i) == i && !is_elastic_motion(s, i)))
            return (int)i;
    }
    if (!is_doubtful)
        return -1;
    reverse(s->independent, (int)n);
    const bool is_rounded = roundoff_pivot_in_order(s, is_exact) >= 0;
    reverse(s->independent, (int)n);
    return is_rounded ? roundoff_pivot_in_order(s, is_exact) : -1;
}

// The beam of an elastic coordinate whose mass is at one point of each element; else NULL.
static const struct ct_body *one_point_beam(const struct ct_partition *s, size_t k)
{
    const struct ct_u *u = &s->m->e->u[k];
    const struct ct_body *body = u->beam > 0 ? &s->m->model->body[u->beam] : NULL;
    return body && body->beam->integration == CT_BEAM_ONE_POINT ? body : NULL;
}

// Warn once of a motion with very little inertia. Mass at one point of an element gives some
// motions of the element none. In coordinates of `modes` they may have a little, and are then
// much faster than all others.
static void warn_of_one_point_mass(struct ct_partition *s)
{
    const size_t n = s->m->nu;
    const struct ct_body *found = NULL;
    // Fraction of the coordinate's own inertia that remains while the others are free; the motion
    // is faster by its root. Default: advice against motions as fast as intended.
    // Test: massless_beams
    const double little = 1e-6;
    double part = little;
    for (size_t k = 0; k < n; k++)
        found = found ? found : one_point_beam(s, k);
    if (!found || s->switches != 1 || !s->m->e->has_dynamics)
        return;
    bool *follows = CT_NEWN(s->arena, bool, n + 1);
    double *inertia = CT_NEWN(s->arena, double, n + 1);
    for (size_t k = 0; k < n; k++)
        follows[k] = !one_point_beam(s, k);
    ct_evaluator_dynamics(s->m);
    found = NULL;
    if (!ct_partition_inertias(s, follows, inertia))
        return;
    for (size_t k = 0; k < n; k++)
        if (inertia[k] <= part * ct_evaluator_inertia(s->m, k)) {
            part = inertia[k] / ct_evaluator_inertia(s->m, k);
            found = one_point_beam(s, k);
        }
    if (found)
        ct_warning(s->ctx, inertia_key_mark(found), 0,
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
            return report_no_inertia(s,
                                     equivalent_elastic_speed(s, pivot[least] > 0 ? i : least));
    const int massless_speed = roundoff_pivot_of_solution(s, pivot);
    if (massless_speed < 0)
        warn_of_one_point_mass(s);
    return massless_speed < 0
        || report_no_inertia(s, equivalent_elastic_speed(s, (size_t)massless_speed));
}

// The time in which the fastest coordinate moves by `distance`, with the speeds and
// accelerations at the evaluator's input; 0 at rest.
static double time_to_move(const struct ct_partition *s, double distance)
{
    const size_t n = s->m->e->nmotion;
    const double u = ct_vector_max_norm(s->m->input + s->m->at_u, n),
                 a = ct_vector_max_norm(s->a, n);
    return u > 0 || a > 0 ? 2 * distance / (u + sqrt(u * u + 2 * distance * a)) : 0;
}

// Choose rows and columns by their coefficients at a later state, extrapolated with the present
// accelerations. The evaluator's input is restored.
static void choose_at_later_state(struct ct_partition *s)
{
    // Default: far enough for the choices to differ, near enough for the extrapolation to hold.
    // Test: solvers
    const double distance = 0.3; // [rad or m]
    struct ct_evaluator *m = s->m;
    double *q = m->input + m->at_q;
    const double *u = m->input + m->at_u, h = time_to_move(s, distance);
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

static bool choose_at_present_state(struct ct_partition *s)
{
    s->rank = order_rows(s);
    ct_evaluator_leave_out(s->m, s->row, s->rank);
    if (ct_partition_is_large(s) && choose_sparse_columns(s))
        return true;
    choose_columns(s);
    return ct_partition_factor(s);
}

// Many motions begin in a symmetric configuration, where several choices are equally good and
// some soon degrade. The best choice at a later state is taken if it is nearly as good at the
// present one: this avoids a second choice, which costs more than many steps.
static bool choose_with_preview(struct ct_partition *s)
{
    if (!choose_at_present_state(s) || ct_partition_is_large(s) || s->rank == (int)s->m->nu
        || s->m->e->solution)
        return true;
    const double sigma = s->sigma, kappa = s->kappa;
    ct_evaluator_dynamics(s->m);
    if (ct_partition_accelerate(s) != CT_EVAL_OK)
        return false;
    choose_at_later_state(s);
    return (ct_partition_factor(s) && s->sigma >= ct_small_pivot * sigma
            && ct_small_pivot * s->kappa <= kappa)
        || choose_at_present_state(s);
}

bool ct_partition_choose(struct ct_partition *s)
{
    s->switches++;
    s->rank = 0;
    for (int j = 0; j < (int)s->m->nu; j++)
        s->independent[j] = j;
    if (!s->m->nrow)
        ct_partition_factor(s);
    else if (!choose_with_preview(s) && !choose_at_present_state(s))
        return report_no_inertia(s, lightest(s));
    s->kappa_chosen = s->kappa;
    s->sigma_chosen = s->sigma;
    s->sigma_best = fmax(s->sigma_best, s->sigma);
    if (s->m->e->bare_beam)
        return report_no_inertia(s, first_section_speed(s));
    if (s->m->e->solution)
        return has_inertia(s);
    ct_evaluator_dynamics(s->m);
    const bool is_regular = ct_partition_accelerate(s) == CT_EVAL_OK;
    const int massless_speed = roundoff_pivot_of_reduced(s);
    if (massless_speed >= 0 || !is_regular)
        return report_no_inertia(s, massless_speed >= 0 ? (size_t)massless_speed : lightest(s));
    warn_of_one_point_mass(s);
    ct_partition_select_solver(s);
    return true;
}
