// See loops.h.
#include "analysis/loops.h"

#include "formulate/build.h"
#include "formulate/dynamics/reaction.h"
#include "formulate/kinematics/kinematics.h"
#include "numeric/dense.h"
#include "sim/summary.h"
#include "solve/run/run_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- the joint that closes a loop ----------------------------------------------------------

static bool closes(const struct ct_build *b, size_t edge)
{
    const struct ct_edge_info *e = &b->topology->edge[edge];
    return (!b->T.is_branch[edge] || (e->has_rotation && !b->R.is_branch[edge]));
}

static void add_member(struct ct_arena *a, struct ct_loop *l, const char *name)
{
    for (size_t i = 0; i < l->nmember; i++)
        if (!strcmp(l->member[i], name))
            return;
    CT_PUSH(a, l->member, l->nmember, l->member_cap, name);
}

// Lists the branches of the circuits that edge i closes, in the order of the circuits. branch,
// sign (nnode): workspace
static void add_members(struct ct_arena *a, const struct ct_build *b, size_t i, int *branch,
                        signed char *sign, struct ct_loop *l)
{
    for (int k = 0; k < 2 && closes(b, i); k++) {
        const struct ct_tree *t = k ? &b->R : &b->T;
        if (t->is_branch[i] || (k && !b->topology->edge[i].has_rotation))
            continue;
        const int m = ct_tree_circuit(&b->topology->graph, t, (int)i, branch, sign);
        for (int j = 0; j < m; j++)
            if (b->topology->edge[branch[j]].kind != CT_EDGE_ARM)
                add_member(a, l, b->topology->edge[branch[j]].name);
    }
}

// Groups the rows into loops: the rows of one joint form a loop, and a row without a joint is a
// loop of its own. loop_of (by joint): its loop plus one
static void list_loops(struct ct_arena *a, struct ct_loops *out)
{
    const struct ct_equations *e = &out->sim->system->equations;
    const struct ct_model *m = &out->sim->system->model;
    const struct ct_topology *t = e->build->topology;
    size_t cap = 0, *loop_of = CT_NEWN(a, size_t, m->njoint + 1);
    for (size_t i = 0; i < e->nrow; i++) {
        const int joint = e->row[i].joint;
        struct ct_loop l
            = {.name = joint >= 0 ? m->joint[joint].name : e->row[i].name, .joint = joint};
        if (joint < 0 || !loop_of[joint]) {
            add_member(a, &l, l.name);
            CT_PUSH(a, out->loop, out->nloop, cap, l);
        }
        struct ct_loop *of
            = &out->loop[joint < 0 || !loop_of[joint] ? out->nloop - 1 : loop_of[joint] - 1];
        CT_PUSH(a, of->row, of->nrow, of->row_cap, i);
        if (joint >= 0)
            loop_of[joint] = (size_t)(of - out->loop) + 1;
    }
    int *branch = CT_NEWN(a, int, t->nnode);
    signed char *sign = CT_NEWN(a, signed char, t->nnode);
    for (size_t i = 0; i < t->nedge; i++) {
        const struct ct_edge_info *edge = &t->edge[i];
        if ((edge->kind == CT_EDGE_JOINT || edge->kind == CT_EDGE_CLOSURE)
            && loop_of[edge->index])
            add_members(a, e->build, i, branch, sign, &out->loop[loop_of[edge->index] - 1]);
    }
}

// ---- singular values -----------------------------------------------------------------------

static double entry(const struct ct_loops *l, size_t k)
{
    const struct ct_entry *J = &l->sim->system->equations.J[k];
    return l->J.out[k] * l->speed_size[J->column] / l->row_size[J->row];
}

static int by_index(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

// The listed rows of K as columns of l->A (m x n), for the m speeds that have an entry in them.
// Returns m.
static size_t gather(const struct ct_loops *l, const size_t *row, size_t n)
{
    const struct ct_entry *J = l->sim->system->equations.J;
    size_t m = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t k = l->first[row[i]]; k < l->first[row[i] + 1]; k++)
            if (!l->place[J[k].column]++)
                l->speed[m++] = J[k].column;
    qsort(l->speed, m, sizeof *l->speed, by_index);
    for (size_t j = 0; j < m; j++)
        l->place[l->speed[j]] = j;
    memset(l->A, 0, m * n * sizeof *l->A);
    for (size_t i = 0; i < n; i++)
        for (size_t k = l->first[row[i]]; k < l->first[row[i] + 1]; k++)
            l->A[l->place[J[k].column] + m * i] = entry(l, k);
    for (size_t j = 0; j < m; j++)
        l->place[l->speed[j]] = 0;
    return m;
}

// The smallest of the first `rank` singular values of the listed rows, from the eigenvalues of
// K K'. This has half the digits.
static double smallest(const struct ct_loops *l, const size_t *row, size_t n, int rank)
{
    if (rank < 1 || n > CT_MOST_MEASURED_ROWS)
        return rank < 1 ? 0 : NAN;
    const size_t m = gather(l, row, n);
    double *K = l->A, *S = l->A + m * n;
    ct_matrix_multiply_transposed(S, K, K, (int)n, (int)m, (int)n);
    if (!ct_symmetric_eigenvalues(l->w, S, (int)n, (int)n, l->work))
        return NAN;
    return sqrt(fmax(0, l->w[n - (size_t)rank]));
}

static int rank_of(struct ct_arena *a, const struct ct_loops *l, const size_t *row, size_t n)
{
    const size_t m = gather(l, row, n), most = m < n ? m : n;
    const double least = ct_run_evaluator(l->sim->run)->rank_tolerance;
    double *tau = CT_NEWN(a, double, most + 1);
    int *column = CT_NEWN(a, int, n + 1), rank = 0;
    double *work = CT_NEWN(a, double, ct_qr_pivot_work((int)m, (int)n) + 1);
    if (most)
        ct_qr_pivot(l->A, column, tau, (int)m, (int)n, (int)m, 0, work);
    while (rank < (int)most && fabs(l->A[(size_t)rank + m * (size_t)rank]) > least)
        rank++;
    return rank;
}

void ct_loops_measure(struct ct_loops *l, double *near)
{
    const struct ct_sim *sim = l->sim;
    const size_t nrow = sim->system->equations.nrow;
    size_t all[CT_MOST_MEASURED_ROWS];
    for (size_t i = 0; i < nrow && i < CT_MOST_MEASURED_ROWS; i++)
        all[i] = i;
    ct_program_run(&l->J, ct_run_evaluator(sim->run)->input);
    near[0] = smallest(l, all, nrow, l->rank);
    for (size_t i = 0; i < l->nloop; i++)
        near[1 + i] = smallest(l, l->loop[i].row, l->loop[i].nrow, l->loop[i].rank);
}

static void prepare_measure(struct ct_arena *a, struct ct_loops *l)
{
    struct ct_evaluator *m = ct_run_evaluator(l->sim->run);
    const struct ct_equations *e = m->e;
    const size_t n = e->nrow < CT_MOST_MEASURED_ROWS ? e->nrow : CT_MOST_MEASURED_ROWS;
    size_t most = n; // rows that are gathered at once
    for (size_t i = 0; i < l->nloop; i++)
        most = l->loop[i].nrow > most ? l->loop[i].nrow : most;
    ct_ex *J = CT_NEWN(a, ct_ex, e->nJ + 1);
    for (size_t k = 0; k < e->nJ; k++)
        J[k] = e->J[k].value;
    ct_evaluator_add_program(a, m, e->x, J, e->nJ, &l->J);
    l->row_size = CT_NEWN(a, double, e->nrow + 1);
    l->speed_size = CT_NEWN(a, double, e->nu + 1);
    memcpy(l->row_size, m->row_size, e->nrow * sizeof *l->row_size);
    memcpy(l->speed_size, m->speed_size, e->nu * sizeof *l->speed_size);
    l->first = CT_NEWN(a, size_t, e->nrow + 1);
    for (size_t k = 0; k < e->nJ; k++)
        l->first[e->J[k].row + 1] = k + 1;
    for (size_t i = 0; i < e->nrow;
         i++) // a row without entries begins where the one before ends
        l->first[i + 1] = l->first[i + 1] ? l->first[i + 1] : l->first[i];
    l->speed = CT_NEWN(a, int, e->nu + 1);
    l->place = CT_NEWN(a, size_t, e->nu + 1);
    l->A = CT_NEWN(a, double, e->nu *most + n * n + 1);
    l->w = CT_NEWN(a, double, n + 1);
    l->work = CT_NEWN(a, double, ct_symmetric_eigenvalues_work((int)n) + 1);
}

// ---- freedoms that could be released -------------------------------------------------------

// A freedom that may be released, and the reaction along it for each null vector of J'.
struct candidate {
    struct ct_release release;
    size_t at;     // index of its expression, or of the constraint row that it removes
    double *share; // reaction for each null vector (nz)
};

struct releases {
    struct ct_arena *a;
    struct ct_loops *l;
    struct candidate *candidate;
    size_t n, cap;
    ct_ex *reaction;
    size_t nreaction, reaction_cap;
    size_t nz;
    double *z; // (nrow x nz): null vectors, z' J = 0
};

static void add_candidate(struct releases *r, int joint, enum ct_release_kind kind, int axis,
                          size_t at)
{
    const struct candidate c = {{joint, kind, axis, false}, at, CT_NEWN(r->a, double, r->nz)};
    CT_PUSH(r->a, r->candidate, r->n, r->cap, c);
}

// Adds rotations and translations along the axes of frame `from`. For a planar model only those
// in its plane.
static void add_freedoms(struct releases *r, struct ct_build *b, int joint)
{
    const int tail = b->topology->wiring[b->topology->edge_of_joint[joint]].tail;
    ct_ex3 force, torque;
    ct_reaction_derive(b, joint, &force, &torque);
    for (int turns = 1; turns >= 0; turns--) {
        const ct_ex3 v = ct_node_unturn(b, tail, turns ? torque : force);
        for (int i = 0; i < 3; i++) {
            if (!ct_reaction_is_known(b, joint, !turns, i)
                || !(ct_ex_kinds(b->x, v.e[i]) & 1u << CT_SYM_LAM))
                continue;
            add_candidate(r, joint, turns ? CT_RELEASE_TURN : CT_RELEASE_SLIDE, i,
                          r->nreaction);
            CT_PUSH(r->a, r->reaction, r->nreaction, r->reaction_cap, v.e[i]);
        }
    }
}

// Marks the joints of loops with a multiplier that is not unique.
static bool *joints_concerned(const struct releases *r)
{
    const struct ct_loops *l = r->l;
    const struct ct_model *m = &l->sim->system->model;
    bool *is = CT_NEWN(r->a, bool, m->njoint + 1);
    for (size_t i = 0; i < l->nloop; i++) {
        const struct ct_loop *loop = &l->loop[i];
        bool is_open = false;
        for (size_t k = 0; k < loop->nrow; k++)
            is_open |= l->is_open[loop->row[k]];
        for (size_t k = 0; k < loop->nmember && is_open; k++) {
            const int joint = ct_model_find_joint(m, loop->member[k]);
            if (joint >= 0)
                is[joint] = true;
        }
    }
    return is;
}

static void list_candidates(struct releases *r)
{
    struct ct_equations *e = &r->l->sim->system->equations;
    const struct ct_model *m = &r->l->sim->system->model;
    const bool *is_concerned = joints_concerned(r);
    for (size_t j = 0; j < m->njoint; j++) {
        if (is_concerned[j] && m->joint[j].cls->motion)
            add_freedoms(r, e->build, (int)j);
        for (size_t i = 0; i < e->nrow && !m->joint[j].cls->motion; i++)
            if (e->row[i].joint == (int)j)
                add_candidate(r, (int)j, CT_RELEASE_REMOVE, 0, i);
    }
}

static void find_null_vectors(struct releases *r)
{
    struct ct_partition *s = ct_run_partition(r->l->sim->run);
    const size_t nrow = s->m->nrow;
    r->z = CT_NEWN(r->a, double, nrow * r->nz + 1);
    struct ct_null_space *null_space = ct_null_space_create(r->a, s);
    for (size_t k = 0; k < r->nz; k++)
        ct_null_space_vector(null_space, s->row[(size_t)s->rank + k], r->z + nrow * k);
}

// Computes the shares. Reactions are linear in the multipliers, so a share is the difference
// between the reaction with z and that without.
static void find_shares(struct releases *r)
{
    struct ct_evaluator *m = ct_run_evaluator(r->l->sim->run);
    double *lam = m->input + m->at_lam, *before = CT_NEWN(r->a, double, m->nrow + 1);
    double *without = CT_NEWN(r->a, double, r->nreaction + 1);
    struct ct_program p = {0};
    ct_evaluator_add_program(r->a, m, m->e->build->x, r->reaction, r->nreaction, &p);
    memcpy(before, lam, m->nrow * sizeof *lam);
    memset(lam, 0, m->nrow * sizeof *lam);
    ct_program_run(&p, m->input);
    memcpy(without, p.out, r->nreaction * sizeof *without);
    const double scale = 1 + ct_vector_largest(without, r->nreaction);
    for (size_t k = 0; k < r->nz; k++) {
        for (size_t i = 0; i < m->nrow; i++)
            lam[i] = scale * r->z[i + m->nrow * k];
        ct_program_run(&p, m->input);
        for (size_t i = 0; i < r->n; i++) {
            struct candidate *c = &r->candidate[i];
            c->share[k] = c->release.kind == CT_RELEASE_REMOVE
                            ? r->z[c->at + m->nrow * k]
                            : (p.out[c->at] - without[c->at]) / scale;
        }
    }
    memcpy(lam, before, m->nrow * sizeof *lam);
    ct_evaluator_remove_program(m, &p);
}

static double norm(const double *v, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += v[i] * v[i];
    return sqrt(sum);
}

// Divides torques by the size of the mechanism, so that they compare with forces.
static void make_comparable(struct releases *r)
{
    const struct ct_equations *e = &r->l->sim->system->equations;
    double length = 0;
    for (size_t i = 0; i < e->nrow; i++)
        length = e->row[i].is_length ? fmax(length, r->l->row_size[i]) : length;
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < r->nz && length > 0; k++)
            if (r->candidate[i].release.kind == CT_RELEASE_TURN)
                r->candidate[i].share[k] /= length;
}

// A share below this, relative to the largest reaction of the null vectors, is zero.
// Derived: null vectors have errors of 1e-12, and some hundred to a thousand terms are added.
static const double nothing = 1e-9;

// Returns the first candidate with the largest share. Shares that agree in half of all digits are
// equal, so that round-off does not choose between them.
static struct candidate *next(struct releases *r, double least)
{
    double most = 0;
    for (size_t i = 0; i < r->n; i++)
        most = fmax(most, norm(r->candidate[i].share, r->nz));
    for (size_t i = 0; i < r->n && most > least; i++)
        if (norm(r->candidate[i].share, r->nz) >= (1 - sqrt(DBL_EPSILON)) * most)
            return &r->candidate[i];
    return NULL;
}

// Chooses releases one by one. After each choice its contribution is subtracted from the shares
// of all candidates.
static void choose(struct releases *r, double least)
{
    double *v = CT_NEWN(r->a, double, r->nz);
    for (size_t n = 0; n < r->nz; n++) {
        struct candidate *c = next(r, least);
        if (!c)
            return;
        c->release.is_chosen = true;
        const double size = norm(c->share, r->nz);
        for (size_t k = 0; k < r->nz; k++)
            v[k] = c->share[k] / size;
        for (size_t i = 0; i < r->n; i++) {
            const double along = ct_vector_dot(r->candidate[i].share, v, r->nz);
            for (size_t k = 0; k < r->nz; k++)
                r->candidate[i].share[k] -= along * v[k];
        }
    }
}

static void find_releases(struct ct_arena *a, struct ct_loops *l)
{
    struct releases r
        = {.a = a, .l = l, .nz = l->sim->system->equations.nrow - (size_t)l->rank};
    double most = 0;
    if (!r.nz || ct_run_singular_joints(l->sim->run))
        return;
    find_null_vectors(&r);
    list_candidates(&r);
    find_shares(&r);
    make_comparable(&r);
    for (size_t i = 0; i < r.n; i++)
        most = fmax(most, norm(r.candidate[i].share, r.nz));
    size_t n = 0;
    for (size_t i = 0; i < r.n; i++)
        if (norm(r.candidate[i].share, r.nz) > nothing * most)
            r.candidate[n++] = r.candidate[i];
    r.n = n;
    choose(&r, nothing * most);
    l->release = CT_NEWN(a, struct ct_release, r.n + 1);
    for (size_t i = 0; i < r.n; i++)
        l->release[l->nrelease++] = r.candidate[i].release;
}

// ---- entry points --------------------------------------------------------------------------

void ct_loops_create(struct ct_arena *a, struct ct_sim *sim, struct ct_loops *out)
{
    struct ct_run *run = sim->run;
    const struct ct_partition *s = ct_run_partition(run);
    const size_t nrow = sim->system->equations.nrow;
    *out = (struct ct_loops){.sim = sim, .is_open = sim->open.row, .rank = s->rank};
    list_loops(a, out);
    out->is_redundant = CT_NEWN(a, bool, nrow + 1);
    for (size_t i = (size_t)s->rank; i < nrow; i++)
        out->is_redundant[s->row[i]] = true;
    if (!nrow)
        return;
    prepare_measure(a, out);
    // evaluates at the start, with multipliers
    bool *unused = CT_NEWN(a, bool, nrow + sim->system->equations.nresult + 1);
    ct_run_find_undetermined(run, 0, ct_run_state(run), unused, unused + nrow);
    ct_evaluator_set(run->m, 0, ct_run_state(run));
    ct_program_run(&out->J, run->m->input);
    double *near = CT_NEWN(a, double, out->nloop + 1);
    for (size_t i = 0; i < out->nloop; i++)
        out->loop[i].rank = rank_of(a, out, out->loop[i].row, out->loop[i].nrow);
    ct_loops_measure(out, near);
    out->near = near[0];
    for (size_t i = 0; i < out->nloop; i++)
        out->loop[i].near = near[1 + i];
    find_releases(a, out);
}

void ct_loops_forget(struct ct_loops *l)
{
    if (l->J.nout)
        ct_evaluator_remove_program(ct_run_evaluator(l->sim->run), &l->J);
}

const char *ct_release_text(struct ct_arena *a, const struct ct_loops *l,
                            const struct ct_release *r)
{
    const char *name = l->sim->system->model.joint[r->joint].name;
    switch (r->kind) {
    case CT_RELEASE_TURN:
        return ct_arena_printf(a, "let %s turn about %c", name, "xyz"[r->axis]);
    case CT_RELEASE_SLIDE:
        return ct_arena_printf(a, "let %s slide along %c", name, "xyz"[r->axis]);
    case CT_RELEASE_REMOVE:
        return ct_arena_printf(a, "take out %s", name);
    }
    return name;
}

// ---- output --------------------------------------------------------------------------------

struct printing {
    struct ct_ctx *own;
    struct ct_sim *sim;
    FILE *out;
    const char *summary; // path of the summary file; NULL: none
};

static const char *list_names(struct ct_arena *a, const struct ct_loop *l,
                              const struct ct_equations *e, const bool *is)
{
    const char *text = "";
    for (size_t i = 0; i < l->nrow; i++)
        if (is[l->row[i]])
            text
                = ct_arena_printf(a, "%s%s%s", text, *text ? ", " : "", e->row[l->row[i]].name);
    return text;
}

static void print_loop(const struct printing *p, const struct ct_loops *loops,
                       const struct ct_loop *l)
{
    const struct ct_equations *e = &p->sim->system->equations;
    struct ct_arena *a = p->own->scratch;
    fprintf(p->out, "loop         %s", l->name);
    for (size_t i = 1; i < l->nmember; i++)
        fprintf(p->out, "%s%s", i == 1 ? " closes " : " - ", l->member[i]);
    fprintf(p->out, ": %zu row%s, rank %d", l->nrow, l->nrow == 1 ? "" : "s", l->rank);
    if (isfinite(l->near))
        fprintf(p->out, ", smallest singular value %.3g", l->near);
    const char *redundant = list_names(a, l, e, loops->is_redundant);
    const char *open = list_names(a, l, e, loops->is_open);
    if (*redundant)
        fprintf(p->out, "; redundant %s", redundant);
    if (*open)
        fprintf(p->out, "; undetermined %s", open);
    fputc('\n', p->out);
}

static void print_releases(const struct printing *p, const struct ct_loops *loops)
{
    struct ct_arena *a = p->own->scratch;
    size_t nchosen = 0;
    for (size_t i = 0; i < loops->nrelease; i++) {
        const struct ct_release *r = &loops->release[i];
        if (r->is_chosen)
            fprintf(p->out, "%s%s", nchosen++ ? ", " : "release      ",
                    ct_release_text(a, loops, r));
    }
    if (!nchosen)
        return;
    fprintf(p->out, ": then no constraint is redundant");
    if (loops->nrelease > nchosen)
        fprintf(p->out, " (%zu other freedoms would take away one each)",
                loops->nrelease - nchosen);
    fputc('\n', p->out);
}

static void print_loops(const struct printing *p, const struct ct_loops *l)
{
    // Layout: of the list
    enum { MOST_SHOWN = 100 };
    for (size_t i = 0; i < l->nloop && i < MOST_SHOWN; i++)
        print_loop(p, l, &l->loop[i]);
    if (l->nloop > MOST_SHOWN)
        fprintf(p->out, "             %zu more\n", l->nloop - MOST_SHOWN);
    if (l->nloop > 1 && isfinite(l->near))
        fprintf(p->out, "all loops    %zu rows, rank %d, smallest singular value %.3g\n",
                p->sim->system->equations.nrow, l->rank, l->near);
    print_releases(p, l);
}

static void write_rows(struct ct_json *j, const char *key, const struct ct_loop *l,
                       const struct ct_equations *e, const bool *is)
{
    ct_json_array(j, key);
    for (size_t i = 0; i < l->nrow; i++)
        if (!is || is[l->row[i]])
            ct_json_text(j, NULL, e->row[l->row[i]].name);
    ct_json_end(j);
}

static void write_loop(struct ct_json *j, const struct ct_loops *loops, const struct ct_loop *l)
{
    const struct ct_equations *e = &loops->sim->system->equations;
    ct_json_object(j, NULL);
    ct_json_text(j, "joint", l->name);
    ct_json_array(j, "closes");
    for (size_t i = 1; i < l->nmember; i++)
        ct_json_text(j, NULL, l->member[i]);
    ct_json_end(j);
    write_rows(j, "rows", l, e, NULL);
    ct_json_integer(j, "rank", l->rank);
    ct_json_number(j, "smallest_singular_value", l->near);
    write_rows(j, "redundant", l, e, loops->is_redundant);
    write_rows(j, "undetermined", l, e, loops->is_open);
    ct_json_end(j);
}

static void write_release(struct ct_json *j, const struct ct_loops *l,
                          const struct ct_release *r)
{
    static const char *const motion[] = {"turn", "slide", "remove"};
    ct_json_object(j, NULL);
    ct_json_text(j, "joint", l->sim->system->model.joint[r->joint].name);
    ct_json_text(j, "motion", motion[r->kind]);
    ct_json_text(j, "axis", r->kind == CT_RELEASE_REMOVE ? NULL : &"x\0y\0z"[2 * r->axis]);
    ct_json_bool(j, "chosen", r->is_chosen);
    ct_json_end(j);
}

static void write_loops(struct ct_json *j, const void *loops)
{
    const struct ct_loops *l = loops;
    ct_json_array(j, "loops");
    for (size_t i = 0; i < l->nloop; i++)
        write_loop(j, l, &l->loop[i]);
    ct_json_end(j);
    ct_json_number(j, "smallest_singular_value", l->near);
    ct_json_array(j, "releases");
    for (size_t i = 0; i < l->nrelease; i++)
        write_release(j, l, &l->release[i]);
    ct_json_end(j);
}

static bool show_loops(void *task)
{
    const struct printing *p = task;
    struct ct_loops l;
    ct_loops_create(p->own->model, p->sim, &l);
    if (p->out)
        print_loops(p, &l);
    const bool ok
        = !p->summary || ct_summary_write(p->own, p->sim, p->summary, write_loops, &l);
    ct_loops_forget(&l);
    return ok;
}

bool ct_sim_print_loops(struct ct_ctx *ctx, struct ct_sim *sim, FILE *out, const char *summary)
{
    struct ct_ctx own = {0};
    struct printing p = {&own, sim, out, summary};
    const bool ok = ctx && sim && ct_own_enter(ctx, &own, show_loops, &p);
    ct_own_finish(&own);
    return ok;
}
