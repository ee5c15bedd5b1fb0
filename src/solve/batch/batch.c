// Creation of a batch, and start and end of its members; see batch.h and batch_internal.h.
#include "solve/batch/batch_internal.h"
#include "integrate/stepper.h"
#include "numeric/dense.h"
#include "solve/evaluator/switch_state.h"
#include "solve/singular/singular.h"

#include <math.h>
#include <string.h>

// ---- programs -----------------------------------------------------------------------------------

static bool is_native(const struct ct_batch *s)
{
    return s->m->motion.native && ct_native_is_available(W);
}

static void make_program(struct ct_batch *s, struct ct_lane_program *p,
                         const struct ct_program *from)
{
    struct ct_arena *a = s->arena;
    *p = (struct ct_lane_program){.nout = from->nout};
    if (!p->nout)
        return;
    const struct ct_listing *l = ct_listing_for_lanes(a, from->listing);
    p->tape = ct_tape_create(a, l);
    p->native = is_native(s) ? ct_native_create(a, l, W) : NULL;
    const size_t n = p->native ? ct_native_work(p->native) : W * ct_tape_work(p->tape);
    p->out = CT_NEWN(a, vec, p->nout);
    p->work = ct_arena_alloc_cache_line(a, (n + 1) * sizeof *p->work);
}

static void prepare(struct ct_lane_program *p, const vec *input)
{
    if (p->nout && p->native)
        ct_native_prepare(p->native, (const double *)input, p->work);
    else if (p->nout)
        ct_tape_prepare_lanes(p->tape, W, (const double *)input, p->work);
}

static void prepare_solver(struct ct_lane_solver *f, const vec *input)
{
    prepare(&f->solved, input);
    prepare(&f->checked, input);
    prepare(&f->closing, input);
}

static void prepare_all(struct ct_batch *s)
{
    prepare(&s->motion, s->input);
    prepare(&s->power, s->input);
    prepare(&s->memory, s->input);
    for (int kind = 0; kind < CT_OUTPUT_KINDS; kind++)
        prepare(&s->output[kind].program, s->input);
    prepare(&s->root, s->input);
    prepare(&s->take.program, s->input);
    for (size_t i = 0; i < s->nsolver; i++)
        prepare_solver(s->solver[i], s->input);
}

// ---- creation -----------------------------------------------------------------------------------

const char *ct_batch_obstacle(const struct ct_run_options *o)
{
    if (!o->method->tableau)
        return "the method is not an explicit one with step control";
    if (o->step > 0)
        return "the step is fixed";
    return NULL;
}

// Do all tables reach to the end of the run? If not, a run alone reports the error.
static bool tables_reach(const struct ct_exs *x, double end)
{
    for (size_t i = 0; i < x->ntable; i++)
        if (!x->table[i].holds && x->table[i].x[x->table[i].n - 1] < end)
            return false;
    return true;
}

static void make_room(struct ct_arena *a, struct ct_batch *s)
{
    const size_t n = (size_t)s->nu, r = (size_t)s->nrow, ny = (size_t)s->ny;
    vec **const states[] = {&s->start, &s->y,    &s->dy,    &s->y1,   &s->dy1,
                            &s->end,   &s->dend, &s->point, &s->late, &s->weight};
    double **const one[] = {&s->one_y, &s->one_dy, &s->one_point, &s->one_end};
    for (size_t i = 0; i < COUNT(states); i++)
        *states[i] = CT_NEWN(a, vec, ny);
    for (size_t i = 0; i < COUNT(one); i++)
        *one[i] = CT_NEWN(a, double, ny);
    s->input = CT_NEWN(a, vec, s->m->ninput);
    s->k = CT_NEWN(a, vec, ny * CT_MOST_DENSE_STAGES);
    s->group_size = CT_NEWN(a, vec, (size_t)(s->groups ? s->groups->n : 0) + 1);
    s->stage = CT_NEWN(a, struct ct_lane_sum, CT_MOST_STAGES);
    s->coordinate_of = CT_NEWN(a, int, n + 1);
    for (size_t i = 0; i < n; i++)
        s->coordinate_of[i] = s->e->u[i].q;
    for (int l = 0; l < W; l++) {
        s->lane[l].row = CT_NEWN(a, int, r + 1);
        s->lane[l].unit = CT_NEWN(a, double, r + 1);
        s->lane[l].dependent = CT_NEWN(a, int, r + 1);
        s->lane[l].independent = CT_NEWN(a, int, n + 1);
    }
}

static void make_outputs(struct ct_batch *s, enum ct_output_kind kind)
{
    const struct ct_controlled_outputs *from
        = ct_output_error_outputs(ct_run_output_error(s->run), kind);
    struct ct_lane_outputs *o = &s->output[kind];
    double **const one[] = {&o->one_at, &o->one_probed, &o->one_off};
    const size_t n = from ? from->n : 0;
    if (from) {
        make_program(s, &o->program, &from->program);
        o->needs_lam = from->needs_lam;
    }
    o->at = CT_NEWN(s->arena, vec, n + 1);
    o->probed = CT_NEWN(s->arena, vec, n + 1);
    for (size_t i = 0; i < COUNT(one); i++)
        *one[i] = CT_NEWN(s->arena, double, n + 1);
    for (int l = 0; l < W; l++)
        s->lane[l].outputs[kind] = ct_output_error_record(s->arena, kind, n);
}

static void make_takes(struct ct_batch *s, size_t n)
{
    struct ct_lane_takes *k = &s->take;
    struct ct_arena *a = s->arena;
    ct_ex *function = CT_NEWN(a, ct_ex, n + 1);
    struct ct_program program;
    k->n = n;
    if (!n)
        return;
    for (size_t i = 0; i < n; i++) {
        const size_t result = s->e->nresult - n + i;
        function[i] = s->e->result[result].value;
        k->needs_accelerations |= ct_output_error_needs_accelerations(s->e, result);
        k->needs_lam |= ct_ex_kinds(s->e->x, function[i]) & 1u << CT_SYM_LAM;
    }
    ct_evaluator_add_program(a, s->m, s->e->x, function, n, &program);
    make_program(s, &k->program, &program);
    ct_evaluator_remove_program(s->m, &program);
    k->F = CT_NEWN(a, vec, s->ny * CT_DENSE_CORRECTIONS);
    k->dy = CT_NEWN(a, vec, s->ny);
    k->one = CT_NEWN(a, double, n);
}

struct ct_batch *ct_batch_create(struct ct_arena *a, const struct ct_equations *e,
                                 struct ct_run *run, size_t ntake)
{
    struct ct_batch *s = CT_NEW(a, struct ct_batch);
    struct ct_evaluator *m = ct_run_evaluator(run);
    *s = (struct ct_batch){
        .e = e, .run = run, .m = m, .arena = a, .partition = ct_run_partition(run)};
    ct_partition_use_dense_only(s->partition);
    s->nq = (int)m->nq;
    s->nu = (int)m->nu;
    s->nrow = (int)m->nrow;
    s->ny = s->nq + s->nu + 1;
    s->has_power = !ct_ex_is_zero(e->power);
    s->needs_lam = ct_ex_kinds(e->x, e->power) & 1u << CT_SYM_LAM;
    for (size_t i = 0; i < e->nq; i++)
        s->has_quaternion |= e->q[i].quaternion >= 0;
    s->is_solved = m->solved.nout > 0 && s->nrow == 0;
    s->groups = ct_run_groups(run);
    if (s->is_solved)
        make_program(s, &s->motion, &m->solved);
    make_program(s, &s->power, &m->power);
    make_program(s, &s->memory, &m->memory);
    for (int kind = 0; kind < CT_OUTPUT_KINDS; kind++)
        make_outputs(s, kind);
    make_program(s, &s->root, &m->root);
    make_room(a, s);
    make_takes(s, ntake);
    ct_lane_make_events(s);
    return s;
}

// ---- lanes and single numbers -------------------------------------------------------------------

void ct_lane_take(double *out, const vec *v, int l, size_t n)
{
    for (size_t i = 0; i < n; i++)
        out[i] = v[i][l];
}

void ct_lane_put(vec *v, int l, const double *in, size_t n)
{
    for (size_t i = 0; i < n; i++)
        v[i][l] = in[i];
}

// ---- forms --------------------------------------------------------------------------------------

// Large systems have very many choices of rows and columns, and a solver takes long to compile:
// only the choice of the start gets one.
static bool is_allowed(const struct ct_batch *s)
{
    // Limit: of the time to make solvers, 0.04 s each (docs/performance.md, Solvers). Beyond it the
    // others are dense matrices, which give the same accelerations.
    enum { LARGE_PROGRAM = 20000 }; // operations
    return s->origin
        && (!s->nsolver
            || (s->solver[0]->code.listing
                && s->solver[0]->solver->operations < LARGE_PROGRAM));
}

// The order of pivots is chosen at the start with the file's own values, so that the solver does
// not depend on the member that needs it first.
static struct ct_lane_solver *make_solver(struct ct_batch *s, const struct ct_partition_sets *p)
{
    struct ct_evaluator *m = s->m;
    const size_t size = m->ninput * sizeof *m->input;
    if (!is_allowed(s))
        return NULL;
    double *now = CT_NEWN(s->arena, double, m->ninput);
    memcpy(now, m->input, size);
    memcpy(m->input, s->origin, size);
    s->whose = -1;
    ct_evaluator_prepare(m);
    ct_evaluator_dynamics(m);
    struct ct_lane_solver *f = CT_NEW(s->arena, struct ct_lane_solver);
    f->solver
        = ct_solver_create(s->arena, m, p, ct_partition_operations(s->partition), NULL, NULL);
    if (f->solver
        && f->solver->kind == &ct_solver_symbolic_kkt) { // lanes need B and its pivots
        const double cost = f->solver->cost;
        ct_solver_destroy(m, f->solver);
        f->solver
            = ct_solver_create_within(s->arena, m, p, &ct_solver_symbolic, CT_LANES * cost);
    }
    memcpy(m->input, now, size);
    ct_evaluator_prepare(m);
    if (f->solver)
        f->code = ct_solver_code(f->solver);
    if (f->code.listing) {
        make_program(s, &f->solved, f->code.solved);
        make_program(s, &f->checked, f->code.checked);
        make_program(s, &f->closing, f->code.closing);
        prepare_solver(f, s->input);
        s->solver_has_power = f->code.has_power; // depends on the equations only
    } else {                                     // no symbolic solver: not tried again
        f->solver = CT_NEW(s->arena, struct ct_solver);
        f->solver->arena = s->arena;
        ct_solver_set_partition(f->solver, p);
    }
    CT_PUSH(s->arena, s->solver, s->nsolver, s->solver_cap, f);
    return f;
}

static struct ct_lane_solver *find_solver(struct ct_batch *s, const struct ct_partition_sets *p)
{
    for (size_t i = 0; i < s->nsolver; i++)
        if (ct_solver_matches(s->solver[i]->solver, p))
            return s->solver[i];
    return make_solver(s, p);
}

void ct_batch_begin(struct ct_batch *s)
{
    const struct ct_partition *partition = s->partition;
    const size_t rank = (size_t)partition->rank, n = (size_t)s->nu;
    const struct ct_partition_sets p
        = {partition->row, partition->dependent, partition->independent, rank, n - rank};
    s->origin = CT_NEWN(s->arena, double, s->m->ninput);
    ct_evaluator_set(s->m, 0, ct_run_state(s->run));
    memcpy(s->origin, s->m->input, s->m->ninput * sizeof *s->origin);
    if (s->nrow)
        find_solver(s, &p);
}

bool ct_lane_choose(struct ct_batch *s, int l)
{
    struct ct_lane *lane = &s->lane[l];
    const struct ct_partition *partition = s->partition;
    const size_t rank = (size_t)s->rank, n = (size_t)s->nu;
    if (partition->rank != s->rank)
        return false;
    memcpy(lane->row, partition->row, (size_t)s->nrow * sizeof *partition->row);
    memcpy(lane->dependent, partition->dependent, rank * sizeof *partition->dependent);
    memcpy(lane->independent, partition->independent,
           (n - rank) * sizeof *partition->independent);
    lane->kappa_chosen = partition->kappa_chosen;
    lane->sigma_chosen = partition->sigma_chosen;
    lane->sigma_best = partition->sigma_best;
    lane->strength = (struct ct_strength){0};
    s->kappa[l] = partition->kappa;
    s->sigma[l] = partition->sigma;
    s->low[l] = s->high[l] = s->slope[l] = 0;
    s->needs_refinement &= ~(1u << l);
    s->alike &= ~(1u << l);
    for (size_t i = 0; i < s->nsolver; i++)
        s->solver[i]->lanes &= ~(1u << l);
    if (!s->nrow)
        return true;
    const struct ct_partition_sets p
        = {lane->row, lane->dependent, lane->independent, rank, n - rank};
    struct ct_lane_solver *f = find_solver(s, &p);
    if (!f || !f->code.listing)
        return false;
    f->lanes |= 1u << l;
    return true;
}

// Choice of rows and columns of the member with which the run was started.
static void compare_at_start(struct ct_batch *s, int l)
{
    for (size_t i = 0; i < s->nsolver; i++)
        if (ct_has_lane(s->solver[i]->lanes, l)) {
            s->strength[l] = ct_solver_close(s->solver[i]->solver, s->m);
            ct_lane_compare(s, l);
        }
}

// ---- the method ---------------------------------------------------------------------------------

// a (n), those that are not zero.
static struct ct_lane_sum sum_of(const struct ct_batch *s, const double *a, int n)
{
    struct ct_lane_sum sum = {0};
    for (int i = 0; i < n; i++)
        if (a[i] != 0) {
            sum.at[sum.n] = W * (size_t)i * (size_t)s->ny;
            sum.a[sum.n++] = a[i];
        }
    return sum;
}

static void take_method(struct ct_batch *s, const struct ct_method *method)
{
    const struct ct_tableau *b = method->tableau;
    s->method = method;
    for (int i = 1; i < b->stages; i++)
        s->stage[i] = sum_of(s, b->A + b->stride * i, i);
    s->error = sum_of(s, b->E, b->nerror);
    s->third = b->B3 ? sum_of(s, b->B3, b->nerror) : (struct ct_lane_sum){0};
    const struct ct_dense_tableau *d = method->dense_tableau;
    for (int i = b->stages; i < d->stages; i++)
        s->take.stage[i] = sum_of(s, d->A + d->stride * (i - b->stages), i);
    for (int j = 0; j < CT_DENSE_CORRECTIONS; j++)
        s->take.correction[j] = j < d->corrections ? sum_of(s, d->D + d->stride * j, d->stages)
                                                   : (struct ct_lane_sum){0};
}

// ---- members come and go ------------------------------------------------------------------------

// First step size, from y and its derivative in one_dy.
static bool first_step(struct ct_batch *s, int l, const double *y)
{
    struct ct_lane *lane = &s->lane[l];
    const struct ct_problem p = {.ny = s->has_power ? s->ny : s->ny - 1, .groups = s->groups};
    const struct ct_tolerance tolerance = {s->rtol[l], s->atol[l]};
    const double d0 = ct_stepper_norm(&p, &tolerance, y, y, y);
    const double d1 = ct_stepper_norm(&p, &tolerance, y, y, s->one_dy);
    const double limit = fmin(lane->longest, ct_lane_stop(lane));
    const double h = lane->control.h = ct_step_control_euler_step(d0, d1, limit);
    for (int i = 0; i < s->ny; i++)
        s->one_point[i] = y[i] + h * s->one_dy[i];
    if (ct_run_rhs(s->run, h, s->one_point, s->one_end) != CT_EVAL_OK)
        return true; // step control will find a smaller one
    for (int i = 0; i < s->ny; i++)
        s->one_point[i] = (s->one_end[i] - s->one_dy[i]) / h;
    const double d2 = ct_stepper_norm(&p, &tolerance, y, y, s->one_point);
    lane->control.h = ct_step_control_first(s->method, h, d1, d2, limit);
    return isfinite(lane->control.h);
}

void ct_lane_limit_turn(struct ct_batch *s, int l, double t, const double *y)
{
    struct ct_lane *lane = &s->lane[l];
    // Derived: the root of the unit round-off, and more
    const double small_part = 1e-6; // of the run, or [s]
    const double angle_rate = ct_memory_angle_rate(
        s->m, ct_time_just_before(t, lane->events.pending), y, small_part * fmin(1, lane->t1));
    ct_evaluator_set(s->m, t, y);
    if (angle_rate > 0)
        lane->control.h = fmin(lane->control.h, ct_lane_most_turn / angle_rate / 2);
}

static void start_take(struct ct_batch *s, int l, const struct ct_run_options *o)
{
    if (!s->take.n)
        return;
    if (!s->take.scan[l])
        s->take.scan[l] = ct_run_take_create(s->arena, o);
    ct_run_take_begin(s->take.scan[l], o);
}

static void start_lane(struct ct_batch *s, struct ct_lane *lane, const struct ct_run_options *o)
{
    lane->t1 = o->duration;
    lane->control = ct_step_control_start();
    lane->control.is_starting = true;
    for (int kind = 0; kind < CT_OUTPUT_KINDS; kind++) {
        ct_output_error_clear(&lane->outputs[kind]);
        ct_constrained_output_clear(
            ct_output_error_constrained(ct_run_output_error(s->run), kind),
            &lane->outputs[kind].constrained, false);
    }
    lane->tolerance = (struct ct_tolerance){o->rtol, o->atol};
    lane->periodic = ct_periodic_tolerance_start(0, o->duration, &lane->tolerance);
    lane->least_rtol = o->least_rtol;
    lane->pivot_last = INFINITY;
    lane->pivot_time = 0;
    lane->steps = 0;
    lane->is_watched = o->stiff_method != NULL;
    lane->nstiff = lane->nother = 0;
}

// Copies the member with which the run was started into lane l, and into lanes that have had no
// member, so that their numbers are finite.
static void fill(struct ct_batch *s, int l, const double *y)
{
    for (int i = 0; i < W; i++)
        if (i == l || !s->is_used) {
            ct_lane_put(s->input, i, s->m->input, s->m->ninput);
            ct_lane_put(s->y, i, y, (size_t)s->ny);
            ct_lane_put(s->start, i, y, (size_t)s->ny);
            ct_lane_put(s->dy, i, s->one_dy, (size_t)s->ny);
            s->t[i] = 0;
        }
    s->is_used = true;
    prepare_all(s);
}

// Are rows dependent in the initial configuration only? Such a member is run alone.
static bool is_singular_start(const struct ct_batch *s)
{
    // Derived: half the digits
    const double changed = 1e-6; // below this a projection changes speeds by round-off
    const struct ct_partition *partition = ct_run_partition(s->run);
    const double *u = ct_run_assembled(s->run) + s->nq, *now = ct_run_state(s->run) + s->nq;
    const double largest = ct_vector_largest(u, s->m->nu);
    for (size_t k = 0; k < s->m->nu; k++)
        if (fabs(now[k] - u[k]) > changed * largest)
            return true;
    if (partition->rank == s->nrow)
        return false;
    struct ct_arena *own = ct_arena_create_under(s->arena);
    bool *row = CT_NEWN(own, bool, (size_t)s->nrow + 1);
    const bool is_singular
        = ct_singular_start_test(own, partition, 0, ct_run_assembled(s->run), row);
    ct_arena_destroy(own);
    return is_singular;
}

bool ct_batch_load(struct ct_batch *s, int l, const struct ct_run_options *o)
{
    const double *y = ct_run_state(s->run);
    const int rank = s->partition->rank;
    if (!(o->duration > 0) || s->m->is_inexact || ct_batch_obstacle(o)
        || !tables_reach(s->e->x, o->duration)
        || (s->is_used && (o->method != s->method || rank != s->rank))
        || (s->needs_lam && rank != s->nrow))
        return false;
    if (is_singular_start(s) || ct_run_starts_near_singular(s->run)
        || ct_run_begins_implicit(s->run, o))
        return false;
    s->rank = rank;
    if (o->method != s->method)
        take_method(s, o->method);
    s->rtol[l] = o->rtol;
    s->lane[l].scale = ct_run_partition(s->run)->scale;
    s->lane[l].has_units = s->partition->has_units;
    memcpy(s->lane[l].unit, s->partition->unit, (size_t)s->nrow * sizeof *s->partition->unit);
    s->atol[l] = o->atol;
    s->pivot_most[l] = 0;
    s->near_singular &= ~(1u << l);
    start_lane(s, &s->lane[l], o);
    start_take(s, l, o);
    ct_evaluator_set(s->m, 0, y);
    if (!ct_lane_begin_events(s, l, o) || !ct_lane_choose(s, l)
        || ct_run_rhs(s->run, 0, y, s->one_dy) != CT_EVAL_OK)
        return false;
    s->sigma[l] = s->partition->sigma; // of y now
    compare_at_start(s, l);
    if (!first_step(s, l, y))
        return false;
    ct_lane_limit_turn(s, l, 0, y);
    fill(s, l, y);
    if (!ct_lane_reinitialize(s, l, 0, y, s->one_dy))
        return false;
    s->lane[l].state = CT_LANE_RUNNING;
    return true;
}

enum ct_lane_state ct_batch_state(const struct ct_batch *s, int lane)
{
    return s->lane[lane].state;
}

bool ct_batch_results(struct ct_batch *s, int l, double *out)
{
    ct_lane_load_run_whole(s, l, s->lane[l].t1, s->y);
    if (ct_run_results(s->run, s->lane[l].t1, s->one_y, out) != CT_EVAL_OK)
        return false;
    for (size_t i = 0; i < s->e->nresult; i++)
        if (!isfinite(out[i]))
            return false;
    if (s->take.n)
        ct_take_scan_results(s->take.scan[l], out + s->e->nresult - s->take.n);
    return true;
}

void ct_batch_free(struct ct_batch *s, int lane)
{
    s->lane[lane].state = CT_LANE_IDLE;
}

struct ct_batch_counts ct_batch_counts(const struct ct_batch *s)
{
    return s->count;
}
