// See assembly.h.
//
// 1. Close the loops and meet demanded values by Levenberg-Marquardt steps. The damping handles
//    rows that become dependent at the solution.
// 2. Minimise the distance of all other coordinates to their guesses by Gauss-Newton steps in
//    the tangent space of the constraints. Close the loops after each step. This ends in a
//    local minimum.
// 3. Repeat 1 and 2 from other starting points in search of a nearer position.
#include "solve/initial/assembly_internal.h"
#include "formulate/beam/flexible_body.h"
#include "numeric/dense.h"
#include "solve/constraint/partition.h"
#include "solve/evaluator/switch_state.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

enum { MOST_ITERATIONS = 200 }; // Limit: of one iteration; the assembly fails with a message
// Starting points of the search for a closed position, and of that for a nearer one.
// Default: time against positions nearer to the guesses. Test: nearest.
enum { MOST_STARTS = 24 };
static const double pi = 3.14159265358979323846; // Definition: of mathematics

// ---- residuals ----------------------------------------------------------------------------------

static double measured(const struct ct_assembler *s, size_t i)
{
    return s->m->result.out[2 * i];
}

// Component k of the rotation vector from the target quaternion to the present one. The rate of
// half its square is its product with the angular velocity, exactly.
static double quaternion_error(const struct ct_assembler *s, size_t first, int k)
{
    double t[4], p[4], v[3], norm = 0;
    for (size_t i = 0; i < 4; i++) {
        t[i] = s->q[first + i].value;
        p[i] = measured(s, first + i);
    }
    for (int i = 0; i < 3; i++) {
        const int a = 1 + (i + 1) % 3, b = 1 + (i + 2) % 3;
        v[i] = t[0] * p[1 + i] - p[0] * t[1 + i] - (t[a] * p[b] - t[b] * p[a]);
        norm += v[i] * v[i];
    }
    norm = sqrt(norm);
    const double w = t[0] * p[0] + t[1] * p[1] + t[2] * p[2] + t[3] * p[3];
    const double factor = norm > 0 ? 2 * atan2(norm, fabs(w)) / norm : 2;
    return w < 0 ? -factor * v[k] : factor * v[k];
}

bool ct_assembler_deviation(const struct ct_assembler *s, size_t i, double *r)
{
    if (!s->q[i].in_quaternion) {
        *r = measured(s, i) - s->q[i].value;
        if (ct_assembler_is_turn(s, i))
            *r -= 2 * pi * round(*r / (2 * pi));
        return true;
    }
    const struct ct_coordinate *c = &s->e->coordinate[i];
    const int k = c->index - s->e->build->topology->edge[c->edge].trial->quaternion;
    if (k == 3)
        return false;
    *r = quaternion_error(s, i - (size_t)k, k);
    return true;
}

static void add_row(struct ct_assembler *s, const int *column, const double *coef, size_t n,
                    double weight, double r)
{
    s->r[s->A.n] = weight * r;
    ct_sparse_rows_add(&s->A, column, coef, n, weight);
}

// Row i of the constraints, r its residual. A row whose coefficients are round-off of its
// natural size (theory 6.5) gets weight zero: it repeats a constraint that the tree satisfies.
static void add_constraint(struct ct_assembler *s, size_t i, double r)
{
    const struct ct_evaluator *m = s->m;
    const size_t first = s->first_J[i], n = s->first_J[i + 1] - first;
    const int *column = s->J_column + first;
    const double *J = m->v + m->nrow + first;
    double largest = 0;
    for (size_t k = 0; k < n; k++)
        largest = fmax(largest, fabs(J[k]) * m->speed_size[column[k]]);
    add_row(s, column, J, n, largest <= ct_rank_tolerance * m->row_size[i] ? 0 : 1, r);
    s->r[s->A.n - 1] = r;
}

// The measured speed of coordinate i.
static void add_speed(struct ct_assembler *s, size_t i, double weight, double r)
{
    const size_t first = s->first_speed[i];
    add_row(s, s->speed_column + first, s->speeds->out + first, s->first_speed[i + 1] - first,
            weight, r);
}

// Elastic coordinate i, counted over all beams.
static const struct ct_elastic *elastic_of(const struct ct_assembler *s, size_t i)
{
    const struct ct_flexible *f = s->e->build->flexible;
    for (; i >= (size_t)f->nelastic; f++)
        i -= (size_t)f->nelastic;
    return &f->elastic[i];
}

static void elastic_rows(struct ct_assembler *s, bool of_speeds)
{
    const double one = 1;
    for (size_t i = 0; i < s->nelastic; i++) {
        const struct ct_elastic *e = elastic_of(s, i);
        const double now = of_speeds ? s->y[s->m->nq + (size_t)e->u] : s->y[e->q];
        add_row(s, &e->u, &one, 1, 1,
                now - ct_ex_value(s->e->x, of_speeds ? e->start_rate : e->start, s->value));
    }
}

// Measured coordinates and their speeds, the coefficients of these, phi, v and J at s->y.
static void evaluate_rows(struct ct_assembler *s, bool with_memory)
{
    struct ct_evaluator *m = s->m;
    ct_evaluator_set(m, 0, s->y);
    if (with_memory)
        ct_memory_update(m);
    ct_evaluator_constraint(m);
    ct_program_run(&m->result, m->input);
    ct_program_run(s->speeds, m->input);
    ct_sparse_rows_clear(&s->A);
}

// Linearised position equations at s->y: A d + r = 0.
static void position_rows(struct ct_assembler *s)
{
    const size_t nc = s->e->ncoordinate;
    double r;
    evaluate_rows(s, true);
    for (size_t i = 0; i < s->m->nrow; i++)
        if (s->fixed_row[i])
            add_constraint(s, i, s->m->phi[i]);
    for (size_t i = 0; i < nc; i++)
        if (s->q[i].is_given && ct_assembler_deviation(s, i, &r))
            add_speed(s, i, 1, r);
    elastic_rows(s, false);
    s->nhard = s->A.n;
    ct_loop_filter_apply(s, s->fixed_row);
    for (size_t i = 0; i < nc; i++)
        if (!s->q[i].is_given && s->q[i].wanted && ct_assembler_deviation(s, i, &r))
            add_speed(s, i, s->q[i].weight, r);
}

// The same for speeds.
static void velocity_rows(struct ct_assembler *s)
{
    const size_t nc = s->e->ncoordinate;
    const double *out = s->m->result.out;
    evaluate_rows(s, false);
    for (size_t i = 0; i < s->m->nrow; i++)
        add_constraint(s, i, s->m->v[i]);
    for (size_t i = 0; i < nc; i++)
        if (s->u[i].is_given)
            add_speed(s, i, 1, out[2 * i + 1] - s->u[i].value);
    elastic_rows(s, true);
    s->nhard = s->A.n;
    ct_loop_filter_apply(s, NULL);
    for (size_t i = 0; i < nc; i++)
        if (!s->u[i].is_given && s->u[i].wanted)
            add_speed(s, i, s->u[i].weight, out[2 * i + 1] - s->u[i].value);
}

// Largest residual of the rows that must be met.
static double violation(const struct ct_assembler *s)
{
    double worst = 0;
    for (size_t i = 0; i < s->nhard; i++)
        worst = fabs(s->r[i]) > worst || isnan(s->r[i]) ? fabs(s->r[i]) : worst;
    return worst;
}

// Sum of squares of the weighted deviations from the targets.
static double square_distance(const struct ct_assembler *s)
{
    double sum = 0;
    for (size_t i = s->nhard; i < s->A.n; i++)
        sum += s->r[i] * s->r[i];
    return sum;
}

// The largest of these.
static double farthest_guess(const struct ct_assembler *s)
{
    return ct_vector_largest(s->r + s->nhard, s->A.n - s->nhard);
}

// ---- iterations ---------------------------------------------------------------------------------

// s->b = d that minimises |A d + r|^2 + damping^2 |d|^2 over the rows that must be met.
static void closing_step(struct ct_assembler *s, double damping)
{
    for (size_t i = 0; i < s->nhard; i++)
        s->b[i] = -s->r[i];
    ct_damped_factor(s->closing, &s->A, s->nhard, s->nhard, s->m->nu, damping);
    ct_damped_solve(s->closing, s->b, s->b);
}

// s->b = Gauss-Newton step: minimises the distance to first order, with the constraints
// satisfied to first order. Returns the decrease of the squared distance to first order.
static double nearest_step(struct ct_assembler *s)
{
    // Derived: 1e-6 of the smallest weight squared. Steps are too short by 1e-6 of themselves.
    // The damping is 1e4 times the round-off that dependent rows leave.
    const double damping = 1e-6 * ct_assembly_open_weight * ct_assembly_open_weight;
    const size_t n = s->A.n;
    double after = 0;
    memset(s->work, 0, n * sizeof *s->work);
    ct_damped_factor(s->nearest, &s->A, s->nhard, n, s->m->nu, damping);
    // The first solution misses the constraints by the damping times their multipliers. The
    // second solution corrects that. Near a singular configuration the error would be taken for
    // a decrease.
    for (int solution = 0; solution < 2; solution++) {
        for (size_t i = 0; i < n; i++)
            s->b[i] = -s->r[i] - (i < s->nhard ? s->work[i] : 0);
        ct_damped_solve(s->nearest, s->b, s->b);
        ct_sparse_rows_times(s->work, &s->A, n, s->b);
        ct_vector_add(s->work, 1, s->r, n);
    }
    for (size_t i = s->nhard; i < n; i++)
        after += s->work[i] * s->work[i];
    return square_distance(s) - after;
}

// Does the step s->b reduce the sum of squares of what must be met, to first order, at a rate that
// would meet it within the iterations allowed? Else it goes to a place where the sum is least.
static bool is_promising(struct ct_assembler *s)
{
    const size_t n = s->nhard;
    ct_sparse_rows_times(s->work, &s->A, n, s->b);
    ct_vector_add(s->work, 1, s->r, n);
    return ct_vector_dot(s->work, s->work, n)
         < (1 - 1.0 / MOST_ITERATIONS) * ct_vector_dot(s->r, s->r, n);
}

// Close the loops from s->y by Levenberg-Marquardt steps; returns the largest residual.
static double close_loops(struct ct_assembler *s)
{
    double before = INFINITY;
    for (int i = 0;; i++) {
        position_rows(s);
        const double worst = violation(s);
        // convergence is quadratic: below the tolerance, a residual that is not halved is
        // round-off
        if (!isfinite(worst) || worst <= 4 * DBL_EPSILON || i == MOST_ITERATIONS
            || (worst < ct_rank_tolerance && worst > before / 2))
            return worst;
        closing_step(s, fmax(fmin(1, worst), ct_assembly_least_damping));
        if (worst > ct_rank_tolerance && !is_promising(s))
            return worst;
        ct_evaluator_retract(s->m, s->y, s->b);
        before = worst;
    }
}

// Copy coordinates and memory to k, or back.
static void save(struct ct_assembler *s, struct ct_saved_position *k, bool back)
{
    double *memory = s->m->input + s->m->at_memory;
    const size_t nm = s->e->nmemory;
    memcpy(back ? s->y : k->y, back ? k->y : s->y, s->m->nq * sizeof *s->y);
    memcpy(back ? memory : k->memory, back ? k->memory : memory, nm * sizeof *memory);
}

// Relative round-off of the squared distance, a sum of that many terms.
static double distance_roundoff(const struct ct_assembler *s)
{
    return DBL_EPSILON * (double)(s->A.n - s->nhard);
}

// Take the step s->b or a fraction of it such that, with loops closed, the distance falls.
// False if the decrease would be below round-off. gain: decrease for the whole step to first
// order.
static bool take_step(struct ct_assembler *s, double gain)
{
    const size_t nu = s->m->nu;
    const double before = square_distance(s), least = distance_roundoff(s) * before;
    double *d = s->step;
    memcpy(d, s->b, nu * sizeof *d);
    save(s, &s->before, false);
    for (double part = 1; part * gain > least; part /= 2) {
        for (size_t k = 0; k < nu; k++)
            s->b[k] = part * d[k];
        ct_evaluator_retract(s->m, s->y, s->b);
        if (close_loops(s) < ct_rank_tolerance && square_distance(s) < before)
            return true;
        save(s, &s->before, true);
    }
    return false;
}

// Close the loops from s->y, then move along them to the position nearest to the guesses. Returns
// the largest residual.
static double find_positions(struct ct_assembler *s)
{
    double worst = close_loops(s), before = INFINITY;
    for (int i = 0; i < MOST_ITERATIONS && worst < ct_rank_tolerance; i++) {
        const double gain = nearest_step(s), size = ct_vector_max_norm(s->b, s->m->nu);
        // the position can still be improved when the squared distance is stationary to
        // round-off
        const bool is_last = gain <= distance_roundoff(s) * square_distance(s);
        if (size <= 4 * DBL_EPSILON || (is_last ? !(size < before) : !take_step(s, gain)))
            break;
        if (is_last) {
            ct_evaluator_retract(s->m, s->y, s->b);
            worst = close_loops(s);
        }
        before = size;
    }
    return worst < ct_rank_tolerance ? close_loops(s) : worst;
}

static double find_velocities(struct ct_assembler *s)
{
    double *u = s->y + s->m->nq, before = INFINITY;
    for (bool is_met = false; !is_met;) { // linear: iterate until steps are round-off
        velocity_rows(s);
        nearest_step(s);
        const double size = ct_vector_max_norm(s->b, s->m->nu);
        is_met = !(size < before);
        if (is_met) { // correct the error that the damping leaves
            velocity_rows(s);
            closing_step(s, ct_assembly_least_damping);
        }
        ct_vector_add(u, 1, s->b, s->m->nu);
        before = size;
    }
    velocity_rows(s);
    return fmax(violation(s), ct_loop_filter_missed(s, true))
         / fmax(1, ct_vector_largest(u, s->m->nu));
}

// ---- the stage ----------------------------------------------------------------------------------

// Rows whose constant is taken from the initial state (gears, rods of the initial length) hold
// at any position.
static void find_fixed_rows(struct ct_assembler *s, struct ct_arena *a)
{
    struct ct_exs *x = s->e->x;
    s->fixed_row = CT_NEWN(a, bool, s->m->nrow + 1);
    for (size_t i = 0; i < s->m->nrow; i++) {
        s->fixed_row[i] = true;
        const size_t n = ct_ex_walk(x, &s->e->row[i].phi, 1);
        for (size_t k = 0; k < n; k++) {
            const struct ct_sym *sym = ct_ex_symbol(x, (ct_ex){x->stack[k]});
            if (sym && sym->kind == CT_SYM_MEMORY
                && s->e->memory[sym->index].kind == CT_MEMORY_OFFSET)
                s->fixed_row[i] = false;
        }
    }
}

// Pseudo-random numbers in [-1, 1) from a fixed seed: the same model gives the same result.
static double random_number(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 4503599627370496.0 - 1;
}

// s->b = random increments that grow with the try. Joints come first, then bodies. Elastic
// coordinates stay, so that the numbers do not depend on how many there are.
static void random_step(struct ct_assembler *s, int try)
{
    uint64_t state = (uint64_t)try;
    const struct ct_u *u = s->e->u;
    memset(s->b, 0, s->m->nu * sizeof *s->b);
    for (int of_bodies = 0; of_bodies < 2; of_bodies++)
        for (size_t k = 0; k < s->m->nu; k++)
            if (!u[k].beam && (u[k].joint < 0) == of_bodies)
                s->b[k] = 0.15 * try * random_number(&state);
}

// Set s->y to the targets; from the second try on, moved by a random step that grows.
static void start_near_targets(struct ct_assembler *s, int try)
{
    double *memory = s->m->input + s->m->at_memory;
    memset(s->y, 0, (s->m->nq + s->m->nu + 1) * sizeof *s->y);
    for (size_t i = 0; i < s->e->ncoordinate; i++) {
        const struct ct_coordinate *c = &s->e->coordinate[i];
        if (c->q >= 0)
            s->y[c->q] = s->q[i].value;
    }
    ct_initial_state_of_beams(s->e, s->value, s->y, NULL);
    ct_evaluator_normalise(s->m, s->y);
    random_step(s, try);
    ct_evaluator_retract(s->m, s->y, s->b);
    const struct ct_topology *t = s->e->build->topology;
    for (size_t i = 0; i < s->e->nmemory; i++) {
        const struct ct_memory *angle = &s->e->memory[i];
        const int joint = angle->kind == CT_MEMORY_ANGLE ? angle->joint : -1,
                  edge = joint >= 0 ? t->edge_of_joint[joint] : -1;
        if (edge >= 0 && angle->index < t->edge[edge].ncoordinate)
            memory[i] = s->q[t->edge[edge].first_coordinate + angle->index].value;
    }
    ct_evaluator_set(s->m, 0, s->y);
    ct_switches_start(s->m, 0, s->y, NULL, NULL);
    ct_memory_start(s->m);
    ct_evaluator_measure_rows(s->m);
}

// The first joint that closes with its axes antiparallel instead of parallel; -1 if there is
// none.
static int antiparallel_joint(struct ct_assembler *s)
{
    struct ct_evaluator *m = s->m;
    ct_evaluator_set(m, 0, s->y);
    ct_program_run(&m->assembly_sign, m->input);
    for (size_t i = 0; i < m->nrow; i++)
        if (m->assembly_sign.out[i] < 0)
            return s->e->row[i].joint;
    return -1;
}

static bool report_antiparallel(struct ct_assembler *s, int joint)
{
    const struct ct_instance *self = &s->e->build->model->joint[joint];
    return ct_error(
        s->ctx, self->mark, CT_E_ASSEMBLY,
        "the mechanism cannot be assembled: it closes only with the axes of '%s' turned to "
        "their opposite; give guesses in `initial`",
        self->name);
}

// ---- the nearest position -----------------------------------------------------------------------

static bool is_without_guess(const struct ct_assembler *s, size_t i)
{
    const struct ct_target *t = &s->q[i];
    return t->wanted && !t->is_given && !t->is_guessed && s->e->coordinate[i].u >= 0
        && s->e->build->topology->edge[s->e->coordinate[i].edge].kind == CT_EDGE_JOINT;
}

// s->b = random increments from the targets to a starting point of the search. Coordinates
// without a guess move within half a turn or the natural length, guesses by at most `reach`
// [rad or natural lengths]. Demanded coordinates stay.
static void random_start(struct ct_assembler *s, int search, double reach)
{
    uint64_t state = (uint64_t)search;
    memset(s->b, 0, s->m->nu * sizeof *s->b);
    for (size_t i = 0; i < s->e->ncoordinate; i++) {
        const struct ct_coordinate *c = &s->e->coordinate[i];
        const struct ct_target *t = &s->q[i];
        if (is_without_guess(s, i)) {
            const double unit = ct_assembly_open_weight / t->weight;
            const bool is_rotation = t->in_quaternion || ct_assembler_is_turn(s, i);
            s->b[c->u] = unit * (is_rotation ? pi : 1) * random_number(&state);
        } else if (t->is_guessed && c->u >= 0) {
            s->b[c->u] = reach / t->weight * random_number(&state);
        }
    }
}

// Can a nearer position matter? A coordinate without a guess is always searched for. `nearest` is
// the square of the distance, `farthest` its largest term.
static bool may_be_nearer(const struct ct_assembler *s, double nearest, double farthest)
{
    // Definition: docs/format.md. In 1800 random loops every nearer position that existed was
    // nearer by 0.5 or more, of six joints at most: one of them is off by 0.2 or more.
    const double near = 0.1;
    for (size_t i = 0; i < s->e->ncoordinate; i++)
        if (is_without_guess(s, i))
            return nearest > ct_rank_tolerance * ct_rank_tolerance;
    return farthest > near;
}

static bool is_closed(struct ct_assembler *s, double residual)
{
    if (s->filter->is_on)
        residual = fmax(residual, ct_loop_filter_missed(s, false));
    return residual < ct_rank_tolerance && antiparallel_joint(s) < 0
        && (!s->filter->is_on || ct_loop_filter_holds(s));
}

// s->y is a closed position. Replace it by a nearer one if the search finds one; of equally
// near positions the first is kept.
static void search_nearer(struct ct_assembler *s)
{
    double nearest = square_distance(s), farthest = farthest_guess(s);
    save(s, &s->best, false);
    for (int search = 0; search < MOST_STARTS && may_be_nearer(s, nearest, farthest);
         search++) {
        start_near_targets(s, 0);
        if (search > 0) { // every second one leaves guesses unchanged
            random_start(s, search, search % 2 ? 0 : sqrt(nearest));
            ct_evaluator_retract(s->m, s->y, s->b);
        }
        if (!is_closed(s, find_positions(s))
            || !(sqrt(square_distance(s)) < sqrt(nearest) - ct_rank_tolerance))
            continue;
        nearest = square_distance(s);
        farthest = farthest_guess(s);
        save(s, &s->best, false);
    }
    save(s, &s->best, true);
    position_rows(s);
}

// After try_exact: the same with rows filtered to the tolerance of the data, if that applies.
static bool try_inexact(struct ct_assembler *s, int try, double *residual)
{
    if (!ct_loop_filter_may_hold(s))
        return false;
    s->filter->is_on = true;
    start_near_targets(s, try);
    *residual = find_positions(s);
    s->filter->is_on = is_closed(s, *residual);
    return s->filter->is_on;
}

static bool try_exact(struct ct_assembler *s, int try, double *residual)
{
    start_near_targets(s, try);
    *residual = find_positions(s);
    return is_closed(s, *residual);
}

// Close the loops from starting points at growing distance until one succeeds; then search for
// a nearer position.
static bool try_positions(struct ct_assembler *s, double *residual)
{
    for (int try = 0; try < MOST_STARTS; try++) {
        const bool is_exact = try_exact(s, try, residual);
        if (!(is_exact && !ct_loop_filter_is_due(s)) && !try_inexact(s, try, residual)
            && !(is_exact && try_exact(s, try, residual)))
            continue;
        search_nearer(s);
        *residual = violation(s);
        return true;
    }
    return false;
}

// Find positions, or speeds, with demanded values as the only guesses; true if the constraints
// are met. The errors of demanded values then show what contradicts. A least-squares compromise
// of both would show smaller errors.
static bool is_met_with_guesses(struct ct_assembler *s, bool of_speeds)
{
    const size_t n = s->e->ncoordinate;
    struct ct_target *target = of_speeds ? s->u : s->q;
    double residual;
    struct ct_target *kept = s->kept_targets;
    bool is_any_given = false;
    memcpy(kept, target, n * sizeof *kept);
    for (size_t i = 0; i < n; i++) {
        is_any_given |= target[i].is_given;
        target[i].wanted = target[i].is_given;
        target[i].is_given = false;
    }
    const bool is_met
        = is_any_given
       && (of_speeds ? find_velocities(s) < ct_rank_tolerance : try_positions(s, &residual));
    memcpy(target, kept, n * sizeof *kept);
    return is_met;
}

// On failure, errors are reported for the first starting point.
static bool assemble_positions(struct ct_assembler *s, double *residual, bool *is_open)
{
    if (try_positions(s, residual))
        return true;
    start_near_targets(s, 0);
    *is_open = s->may_stay_open;
    if (s->may_stay_open)
        return true;
    *residual = find_positions(s);
    if (*residual < ct_rank_tolerance)
        return report_antiparallel(s, antiparallel_joint(s));
    const bool closes = is_met_with_guesses(s, false);
    if (!closes) {
        start_near_targets(s, 0);
        find_positions(s);
    }
    return ct_assembler_report_positions(s, closes);
}

// Report speeds that cannot be met.
static bool report_speeds(struct ct_assembler *s)
{
    if (!is_met_with_guesses(s, true))
        find_velocities(s);
    ct_evaluator_set(s->m, 0, s->y);
    ct_program_run(&s->m->result, s->m->input);
    return ct_assembler_report_speeds(s);
}

// Without constraints, and with all targets among the unknowns, the targets are the solution.
static bool is_direct(const struct ct_assembler *s)
{
    for (size_t i = 0; i < s->e->ncoordinate; i++) {
        const struct ct_coordinate *c = &s->e->coordinate[i];
        if ((s->q[i].wanted && c->q < 0) || (s->u[i].wanted && c->u < 0))
            return false;
    }
    return s->m->nrow == 0;
}

static void take_targets(struct ct_assembler *s)
{
    start_near_targets(s, 0);
    for (size_t i = 0; i < s->e->ncoordinate; i++)
        if (s->u[i].wanted && s->e->coordinate[i].u >= 0)
            s->y[s->m->nq + (size_t)s->e->coordinate[i].u] = s->u[i].value;
    ct_initial_state_of_beams(s->e, s->value, NULL, s->y + s->m->nq);
}

// Compressed rows of entries that are listed row by row: first (nrow + 1, out), column (n,
// out).
static void list_entries(struct ct_arena *a, const struct ct_entry *entry, size_t n,
                         size_t nrow, size_t **first, int **column)
{
    *first = CT_NEWN(a, size_t, nrow + 1);
    *column = CT_NEWN(a, int, n + 1);
    for (size_t k = 0; k < n; k++) {
        (*first)[entry[k].row + 1]++;
        (*column)[k] = entry[k].column;
    }
    for (size_t i = 0; i < nrow; i++)
        (*first)[i + 1] += (*first)[i];
}

// Coefficients of the measured speeds, which are linear in u. They are not part of the
// equations, as a chain of n bodies has n^2 of them.
static void derive_speeds(struct ct_arena *a, struct ct_assembler *s)
{
    const struct ct_equations *e = s->e;
    struct ct_seed *seed = CT_NEWN(a, struct ct_seed, e->nu + 1);
    ct_ex *speed = CT_NEWN(a, ct_ex, e->ncoordinate + 1);
    struct ct_slope *slope;
    for (size_t k = 0; k < e->nu; k++)
        seed[k] = (struct ct_seed){e->u[k].symbol, (uint32_t)k, CT_EX_ONE};
    for (size_t i = 0; i < e->ncoordinate; i++)
        speed[i] = e->result[2 * i + 1].value;
    const size_t n = ct_ex_jacobian(e->x, a, a, speed, e->ncoordinate, seed, e->nu, &slope);
    struct ct_entry *entry = CT_NEWN(a, struct ct_entry, n + 1);
    ct_ex *value = CT_NEWN(a, ct_ex, n + 1);
    for (size_t k = 0; k < n; k++) {
        entry[k]
            = (struct ct_entry){(int)slope[k].row, (int)slope[k].direction, slope[k].value};
        value[k] = slope[k].value;
    }
    list_entries(a, entry, n, e->ncoordinate, &s->first_speed, &s->speed_column);
    s->speeds = CT_NEW(a, struct ct_program);
    ct_evaluator_add_program(a, s->m, e->x, value, n, s->speeds);
}

static struct ct_saved_position saved_position(struct ct_arena *a, const struct ct_equations *e)
{
    return (struct ct_saved_position){CT_NEWN(a, double, e->nq + 1),
                                      CT_NEWN(a, double, e->nmemory + 1)};
}

static struct ct_assembler assembly_create(struct ct_ctx *ctx, struct ct_arena *a,
                                           const struct ct_model *model,
                                           const struct ct_equations *e, bool is_iterated)
{
    struct ct_assembler s = {.ctx = ctx, .e = e, .m = ct_evaluator_create(a, model, e)};
    const size_t nc = e->ncoordinate, nu = s.m->nu;
    for (size_t i = 0; i < e->build->nflexible; i++)
        s.nelastic += (size_t)e->build->flexible[i].nelastic;
    s.value = model->value;
    s.q = CT_NEWN(a, struct ct_target, nc + 1);
    s.u = CT_NEWN(a, struct ct_target, nc + 1);
    s.y = CT_NEWN(a, double, s.m->nq + nu + 1);
    s.before = saved_position(a, e);
    s.best = saved_position(a, e);
    s.b = CT_NEWN(a, double, s.m->nrow + nc + s.nelastic + nu + 1);
    s.kept_targets = CT_NEWN(a, struct ct_target, nc + 1);
    ct_assembler_list_frames(&s, a, model);
    ct_assembler_find_targets(&s, model);
    if (!is_iterated && is_direct(&s))
        return s;
    s.most = s.m->nrow + nc + s.nelastic + nu + 1;
    s.A.arena = a;
    s.closing = ct_damped_create(a);
    s.nearest = ct_damped_create(a);
    s.step = CT_NEWN(a, double, nu + 1);
    s.r = CT_NEWN(a, double, s.most);
    s.work = CT_NEWN(a, double, s.most);
    list_entries(a, e->J, e->nJ, e->nrow, &s.first_J, &s.J_column);
    derive_speeds(a, &s);
    find_fixed_rows(&s, a);
    s.filter = ct_loop_filter_create(a, &s);
    return s;
}

// Iterations may have added whole turns: bring angles within half a turn of their targets.
static void drop_whole_turns(const struct ct_assembler *s, double *q)
{
    for (size_t i = 0; i < s->e->ncoordinate; i++) {
        const double away = q[i] - s->q[i].value;
        if (s->q[i].wanted && fabs(away) > pi + ct_rank_tolerance && ct_assembler_is_turn(s, i))
            q[i] -= 2 * pi * round(away / (2 * pi));
    }
}

// From targets to values and speeds of all coordinates.
static bool find_start(struct ct_assembler *s, struct ct_initial_state *out)
{
    struct ct_evaluator *m = s->m;
    const size_t nc = s->e->ncoordinate;
    double left = 0;
    if (!is_direct(s) && !assemble_positions(s, &out->residual, &out->is_open))
        return false;
    if (is_direct(s) || out->is_open)
        take_targets(s);
    ct_evaluator_set(m, 0, s->y);
    ct_memory_start(m);
    if (!is_direct(s) && !out->is_open)
        left = find_velocities(s);
    ct_evaluator_set(m, 0, s->y);
    ct_program_run(&m->result, m->input);
    if (!(left < ct_rank_tolerance))
        return report_speeds(s);
    if (!ct_assembler_check_drivers(s))
        return false;
    for (size_t i = 0; i < nc; i++) {
        out->q[i] = m->result.out[2 * i];
        out->u[i] = m->result.out[2 * i + 1];
    }
    if (!is_direct(s))
        drop_whole_turns(s, out->q);
    out->is_inexact = s->filter && s->filter->is_on;
    if (out->is_inexact) {
        out->freedoms = ct_loop_filter_freedoms(s);
        ct_loop_filter_warn(s);
    }
    return true;
}

struct ct_assembly {
    struct ct_assembler s;
    const struct ct_model *model;
    double *q, *u;
    bool *is_given;
};

struct ct_assembly *ct_assembly_create(struct ct_ctx *ctx, struct ct_arena *a,
                                       const struct ct_model *model,
                                       const struct ct_equations *e)
{
    struct ct_assembly *s = CT_NEW(a, struct ct_assembly);
    s->model = model;
    s->s = assembly_create(ctx, a, model, e, false);
    s->q = CT_NEWN(a, double, e->ncoordinate + 1);
    s->u = CT_NEWN(a, double, e->ncoordinate + 1);
    s->is_given = CT_NEWN(a, bool, e->ncoordinate + 1);
    return s;
}

bool ct_assembly_find(struct ct_assembly *s, struct ct_initial_state *out)
{
    const size_t n = s->s.e->ncoordinate;
    *out = (struct ct_initial_state){.q = s->q, .u = s->u, .is_given = s->is_given, .n = n};
    memset(s->s.q, 0, n * sizeof *s->s.q);
    memset(s->s.u, 0, n * sizeof *s->s.u);
    ct_evaluator_reset(s->s.m);
    ct_assembler_find_targets(&s->s, s->model);
    if (s->s.filter)
        s->s.filter->is_on = false;
    for (size_t i = 0; i < n; i++)
        s->is_given[i] = s->s.q[i].is_given;
    out->length = s->s.length;
    out->e = s->s.e;
    out->q_target = s->s.q;
    out->u_target = s->s.u;
    return find_start(&s->s, out);
}

static bool assemble(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
                     const struct ct_equations *e, bool may_stay_open,
                     struct ct_initial_state *out)
{
    *out = (struct ct_initial_state){0};
    struct ct_arena *own = ct_arena_create_under(a); // freed after the assembly
    struct ct_assembly *s = ct_assembly_create(ctx, own, model, e);
    s->s.may_stay_open = may_stay_open;
    s->q = CT_NEWN(a, double, e->ncoordinate + 1);
    s->u = CT_NEWN(a, double, e->ncoordinate + 1);
    s->is_given = CT_NEWN(a, bool, e->ncoordinate + 1);
    const bool ok = ct_assembly_find(s, out);
    struct ct_target *target = CT_NEWN(a, struct ct_target, 2 * e->ncoordinate + 1);
    memcpy(target, out->q_target, e->ncoordinate * sizeof *target);
    memcpy(target + e->ncoordinate, out->u_target, e->ncoordinate * sizeof *target);
    out->q_target = target;
    out->u_target = target + e->ncoordinate;
    ct_arena_destroy(own);
    return ok;
}

bool ct_assembly_solve(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
                       const struct ct_equations *e, struct ct_initial_state *out)
{
    return assemble(ctx, a, model, e, false, out);
}

bool ct_assembly_solve_open(struct ct_ctx *ctx, struct ct_arena *a,
                            const struct ct_model *model, const struct ct_equations *e,
                            struct ct_initial_state *out)
{
    return assemble(ctx, a, model, e, true, out);
}

void ct_start_read_back(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
                        const struct ct_equations *e, const struct ct_initial_state *start,
                        const double *y, double *q, double *u)
{
    struct ct_assembler s = assembly_create(ctx, a, model, start->e, true);
    s.filter->is_on = start->is_inexact;
    for (size_t i = 0; i < start->n; i++) {
        const bool in_quaternion = s.q[i].in_quaternion;
        s.q[i] = (struct ct_target){
            .value = start->q[i], .weight = s.q[i].weight, .in_quaternion = in_quaternion};
        s.u[i] = (struct ct_target){.value = start->u[i], .weight = s.u[i].weight};
    }
    start_near_targets(&s, 0);
    for (size_t i = 0; i < start->n; i++) {
        const struct ct_coordinate *c = &e->coordinate[i];
        s.q[i].wanted = c->q >= 0;
        if (c->q >= 0)
            s.q[i].value = y[c->q];
        s.u[i].wanted = c->u >= 0;
        if (c->u >= 0)
            s.u[i].value = y[e->nq + (size_t)c->u];
    }
    find_positions(&s);
    find_velocities(&s);
    ct_evaluator_set(s.m, 0, s.y);
    ct_program_run(&s.m->result, s.m->input);
    for (size_t i = 0; i < start->n; i++) {
        q[i] = measured(&s, i);
        u[i] = s.m->result.out[2 * i + 1];
    }
}
