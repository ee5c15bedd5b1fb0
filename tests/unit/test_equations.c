// The printed equations: equal to the engine's, equal to the textbook's, and readable again.
#include "expr/parse.h"
#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/formulate.h"
#include "report/beam_blocks.h"
#include "report/derivation.h"
#include "report/equations_print.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

struct fixture {
    struct ct_ctx ctx;
    struct ct_model m;
    struct ct_equations e;
    struct ct_derivation d;
    struct ct_reduced r, plain; // plain: without names
    double *symbol;             // values by symbol
    size_t *definition;         // by symbol: number plus one of its definition, 0: none
    double *value;              // by node
};

static void formulate(struct fixture *f, const char *system)
{
    char path[500];
    struct ct_tree_report report;
    const struct ct_formulate_options o = {.tree = CT_TREE_AUTO};
    *f = (struct fixture){.ctx = {.model = ct_arena_create(), .scratch = ct_arena_create()}};
    snprintf(path, sizeof path, "%s/../systems/%s%s", getenv("CT_TEST_DIR"), system,
             strstr(system, ".yaml") ? "" : "/model.yaml");
    if (!ct_model_read(&f->ctx, path, NULL, 0, &f->m)
        || !ct_formulate(&f->ctx, f->ctx.model, &f->m, &o, &f->e, &report)) {
        ct_ctx_print(&f->ctx, stderr);
        fail();
    }
    ct_derivation_init(&f->d, f->ctx.scratch, &f->e, &f->m, CT_LOOK_TEXT);
}

static void reduce(struct fixture *f, const char *system)
{
    formulate(f, system);
    ct_derivation_reduce(&f->d, &f->r);
    f->symbol = CT_NEWN(f->ctx.scratch, double, f->e.x->nsym);
}

static void finish(struct fixture *f)
{
    ct_arena_destroy(f->ctx.scratch);
    ct_arena_destroy(f->ctx.model);
}

static double random_number(void)
{
    static uint64_t s = 88172645463325252u;
    s ^= s << 13;
    s ^= s >> 7;
    s ^= s << 17;
    return (double)(s >> 11) / 9007199254740992.0;
}

// Random values; parameters near 1, quaternions of length 1, comparisons either way.
static void choose_state(struct fixture *f)
{
    const struct ct_equations *e = &f->e;
    for (size_t i = 0; i < e->x->nsym; i++) {
        const enum ct_sym_kind kind = e->x->sym[i].kind;
        f->symbol[i] = kind == CT_SYM_PARAM  ? 0.5 + random_number()
                     : kind == CT_SYM_SWITCH ? (double)(random_number() < 0.5)
                                             : 2 * random_number() - 1;
    }
    for (size_t i = 0; i < e->nq; i++) {
        if (e->q[i].quaternion != 0)
            continue;
        double square = 0;
        for (size_t k = i; k < i + 4; k++) {
            const double v = f->symbol[ct_ex_node(e->x, e->q[k].symbol)->a];
            square += v * v;
        }
        for (size_t k = i; k < i + 4; k++)
            f->symbol[ct_ex_node(e->x, e->q[k].symbol)->a] /= sqrt(square);
    }
}

// All nodes in one sweep upwards: the symbol of a definition is younger than its value.
static void evaluate(struct fixture *f)
{
    const struct ct_exs *x = f->e.x;
    f->value = CT_NEWN(f->ctx.scratch, double, x->nnode);
    double *v = f->value;
    f->definition = CT_NEWN(f->ctx.scratch, size_t, x->nsym + 1);
    for (size_t k = 0; k < f->r.definitions.n; k++)
        f->definition[ct_ex_node(x, f->r.definitions.at[k].symbol)->a] = k + 1;
    for (uint32_t id = 0; id < x->nnode; id++) {
        const struct ct_exnode *n = &x->node[id];
        if (ct_ex_is_const(x, (ct_ex){id}, &v[id]))
            continue;
        if (n->op == CT_OP_SYM) {
            const size_t d = f->definition[n->a];
            v[id] = d ? v[f->r.definitions.at[d - 1].value.id] : f->symbol[n->a];
        } else if (n->op == CT_OP_TABLE) {
            v[id] = ct_table_value(&x->table[n->b], n->c, v[n->a]);
        } else {
            const int narg = ct_op_info[n->op].narg;
            v[id] = ct_op_apply((enum ct_op)n->op, v[n->a], narg > 1 ? v[n->b] : 0,
                                narg > 2 ? v[n->c] : 0);
        }
    }
}

static void check_close(double got, double want, double tolerance)
{
    if (fabs(got - want) <= tolerance)
        return;
    print_error("got %.17g, wanted %.17g\n", got, want);
    fail();
}

// ---- equal to the engine's ----------------------------------------------------------------------

static void check_equal(const struct fixture *f, const char *system, const char *what, size_t i,
                        ct_ex got, ct_ex want, double scale)
{
    const double g = f->value[got.id], w = f->value[want.id];
    // sums of some hundred terms, taken in another order
    if (fabs(g - w) <= 1e-12 * fmax(scale, fabs(w)) || (isnan(g) && isnan(w)))
        return;
    print_error("%s: %s[%zu] is %.17g, the engine has %.17g\n", system, what, i, g, w);
    fail();
}

static double scale_of(const struct fixture *f, const ct_ex *e, size_t n)
{
    double scale = 1;
    for (size_t i = 0; i < n; i++)
        scale = fmax(scale, fabs(f->value[e[i].id]));
    return scale;
}

static void check_all(struct fixture *f, const char *system)
{
    const struct ct_equations *e = &f->e;
    const double Q = scale_of(f, e->Q, e->nu);
    double M = 1, gam = 1;
    for (size_t i = 0; i < e->nM; i++)
        M = fmax(M, fabs(f->value[e->M[i].value.id]));
    for (size_t i = 0; i < e->nrow; i++)
        gam = fmax(gam, fabs(f->value[e->row[i].gam.id]));
    for (size_t i = 0; i < e->nM; i++)
        check_equal(f, system, "M", i, f->r.M[i], e->M[i].value, M);
    for (size_t i = 0; i < e->nu; i++)
        check_equal(f, system, "Q", i, f->r.Q[i], e->Q[i], Q);
    for (size_t i = 0; i < e->nJ; i++)
        check_equal(f, system, "J", i, f->r.J[i], e->J[i].value, 1);
    for (size_t i = 0; i < e->nrow; i++) {
        check_equal(f, system, "phi", i, f->r.phi[i], e->row[i].phi, 1);
        check_equal(f, system, "gam", i, f->r.gam[i], e->row[i].gam, gam);
    }
    for (size_t i = 0; i < e->nq; i++)
        check_equal(f, system, "rate", i, f->r.rate[i], e->q[i].rate, 1);
}

static const char *const systems[] = {"andrews",
                                      "bricard",
                                      "cart_pole",
                                      "chain40",
                                      "double_pendulum",
                                      "flexible_manipulator",
                                      "four_bar",
                                      "gimbal_top",
                                      "governor",
                                      "heavy_top",
                                      "light_cart",
                                      "n_four_bar",
                                      "pendulum",
                                      "pendulum_beam_tip_mass",
                                      "puma560",
                                      "puma560_driven",
                                      "slider_crank",
                                      "slider_crank_flexible",
                                      "spatial_four_bar",
                                      "spatial_slider_crank",
                                      "stewart",
                                      "stiff_spring_pendulum",
                                      "two_boom_satellite",
                                      "spin_up_beam",
                                      "tapered_cantilever",
                                      "tumbling_body"};

static void what_is_printed_equals_the_engine(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(systems); i++) {
        struct fixture f;
        reduce(&f, systems[i]);
        for (int k = 0; k < 5; k++) {
            choose_state(&f);
            evaluate(&f);
            check_all(&f, systems[i]);
        }
        finish(&f);
    }
}

// The recursive form, which long systems get: cutset - effort = M u' - Q - J' lam for any u' and
// lam.
static void the_recursive_form_equals_the_matrix_form(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(systems); i++) {
        struct fixture f;
        formulate(&f, systems[i]);
        const struct ct_equations *e = &f.e;
        f.d.is_recursive = true;
        ct_derivation_reduce(&f.d, &f.r);
        ct_formulate_dynamics(&f.e);
        ct_ex *residual = CT_NEWN(f.ctx.scratch, ct_ex, e->nu + 1),
              *want = CT_NEWN(f.ctx.scratch, ct_ex, e->nu + 1);
        for (size_t k = 0; k < e->nu; k++) {
            residual[k] = ct_ex_sub(e->x, f.r.cutset[k], f.r.Q[k]);
            want[k] = ct_ex_neg(e->x, e->Q[k]);
        }
        for (size_t k = 0; k < e->nM; k++) {
            const int row = e->M[k].row, column = e->M[k].column;
            const ct_ex m = e->M[k].value;
            want[row] = ct_ex_add(e->x, want[row], ct_ex_mul(e->x, m, e->u[column].derivative));
            if (row != column)
                want[column]
                    = ct_ex_add(e->x, want[column], ct_ex_mul(e->x, m, e->u[row].derivative));
        }
        for (size_t k = 0; k < e->nJ; k++) {
            ct_ex *w = &want[e->J[k].column];
            *w = ct_ex_sub(e->x, *w, ct_ex_mul(e->x, e->J[k].value, e->row[e->J[k].row].lam));
        }
        f.symbol = CT_NEWN(f.ctx.scratch, double, e->x->nsym);
        for (int k = 0; k < 5; k++) {
            choose_state(&f);
            evaluate(&f);
            const double scale = scale_of(&f, want, e->nu);
            for (size_t n = 0; n < e->nu; n++)
                check_equal(&f, systems[i], "row", n, residual[n], want[n], scale);
        }
        finish(&f);
    }
}

// ---- blocks of beams ----------------------------------------------------------------------------

// Entries of the matrices of a beam as the engine has them, and the lines below its block.
struct engine_beam {
    struct ct_elastic_columns columns;
    struct ct_symmetric M; // nu x nu
    ct_ex *velocity, *elastic;
    double *applied;
};

static void find_entries(struct fixture *f, const struct ct_flexible *self,
                         struct engine_beam *s)
{
    struct ct_build *b = f->e.build;
    struct ct_arena *a = f->ctx.scratch;
    const size_t n = (size_t)self->nelastic, nu = f->e.nu;
    ct_ex3 less[2];
    const struct ct_base m = ct_flexible_base(b, self, CT_BIAS),
                         effective
                         = ct_flexible_effective_base(b, self, &m, &less[0], &less[1]),
                         turned = {.w = effective.w};
    s->columns
        = (struct ct_elastic_columns){CT_NEWN(a, ct_ex3, n + 1), CT_NEWN(a, ct_ex3, n + 1)};
    s->M = ct_symmetric_create(a, nu);
    s->velocity = CT_NEWN(a, ct_ex, nu + 1);
    s->elastic = CT_NEWN(a, ct_ex, nu + 1);
    s->applied = CT_NEWN(a, double, n + 1);
    ct_flexible_columns(b, self, &s->columns, &s->M);
    ct_flexible_inertia_rows(b, self, &turned, CT_BIAS, s->velocity);
    ct_flexible_stiffness_rows(b, self, s->elastic);
}

static void set_symbol(struct fixture *f, ct_ex symbol, double v)
{
    if (!ct_ex_is_zero(symbol))
        f->symbol[ct_ex_node(f->e.x, symbol)->a] = v;
}

// engine: values of its nodes in this state. k: the coordinate for which the vectors stand; -1: all
// zero.
static void set_block(struct fixture *f, const struct ct_beam_block *s,
                      const struct engine_beam *of, const double *engine, int k)
{
    const struct ct_equations *e = &f->e;
    for (int i = 0; i < 3; i++) {
        const double m_rf = k < 0 ? 0 : engine[of->columns.m_rf[k].e[i].id],
                     m_thetaf = k < 0 ? 0 : engine[of->columns.m_thetaf[k].e[i].id];
        set_symbol(f, s->m_rf[i], m_rf);
        set_symbol(f, s->m_rf_t[i], m_rf);
        set_symbol(f, s->m_thetaf[i], m_thetaf);
        set_symbol(f, s->m_thetaf_t[i], m_thetaf);
    }
    double inertia = 0;
    for (int l = 0; l < s->f->nelastic && k >= 0; l++) {
        const size_t i = (size_t)s->f->elastic[k].u, j = (size_t)s->f->elastic[l].u;
        inertia += engine[ct_symmetric_get(&of->M, i, j).id] * engine[e->u[j].derivative.id];
    }
    const int u = k < 0 ? 0 : s->f->elastic[k].u;
    set_symbol(f, s->inertia, inertia);
    set_symbol(f, s->acceleration, k < 0 ? 0 : engine[e->u[u].derivative.id]);
    set_symbol(f, s->velocity, k < 0 ? 0 : -engine[of->velocity[u].id]);
    set_symbol(f, s->elastic, k < 0 ? 0 : engine[of->elastic[u].id]);
    set_symbol(f, s->applied, k < 0 ? 0 : of->applied[k]);
}

// M u' - Q - J' lam of the engine, and how large its terms are.
static double residual(const struct fixture *f, const double *v, size_t i, double *scale)
{
    const struct ct_equations *e = &f->e;
    double sum = -v[e->Q[i].id];
    *scale = fmax(1, fabs(sum));
    for (size_t k = 0; k < e->nM; k++) {
        const size_t row = (size_t)e->M[k].row, column = (size_t)e->M[k].column;
        if (row != i && column != i)
            continue;
        const double t = v[e->M[k].value.id] * v[e->u[row == i ? column : row].derivative.id];
        sum += t;
        *scale = fmax(*scale, fabs(t));
    }
    for (size_t k = 0; k < e->nJ; k++)
        if ((size_t)e->J[k].column == i) {
            const double t = v[e->J[k].value.id] * v[e->row[e->J[k].row].lam.id];
            sum -= t;
            *scale = fmax(*scale, fabs(t));
        }
    return sum;
}

// left - right of all rows, then the efforts of drivers.
static double *row_values(struct fixture *f, const struct ct_beam_blocks *s, const ct_ex *side)
{
    double *v = CT_NEWN(f->ctx.scratch, double, s->n + f->e.ndriver + 1);
    evaluate(f);
    for (size_t i = 0; i < s->n; i++)
        v[i] = f->value[side[2 * i].id] - f->value[side[2 * i + 1].id];
    for (size_t i = 0; i < f->e.ndriver; i++)
        v[s->n + i] = f->value[f->r.effort[i].id];
    return v;
}

static void check_row(const char *system, const char *row, double got, double want,
                      double scale)
{
    if (fabs(got - want) <= 1e-11 * scale)
        return;
    print_error("%s: equation of %s is off by %.17g, the engine's by %.17g\n", system, row, got,
                want);
    fail();
}

// Sums over coordinates of products with q'' are taken one by one; what is left counts once.
static void check_blocks(struct fixture *f, const char *system, const struct ct_beam_blocks *s,
                         const ct_ex *side, struct engine_beam *of)
{
    const struct ct_equations *e = &f->e;
    const size_t nbeam = e->build->nflexible;
    choose_state(f);
    evaluate(f);
    const double *engine = f->value;
    for (size_t k = 0; k < s->parts->definitions.n; k++)
        set_symbol(f, s->parts->definitions.at[k].symbol,
                   engine[s->parts->definitions.at[k].full.id]);
    for (size_t b = 0; b < nbeam; b++)
        if (s->block[b].f)
            set_block(f, &s->block[b], &of[b], engine, -1);
    const double *plain = row_values(f, s, side);
    const size_t nall = s->n + e->ndriver;
    double *sum = CT_NEWN(f->ctx.scratch, double, nall + 1);
    for (size_t i = 0; i < e->ndriver; i++)
        sum[s->n + i] = plain[s->n + i];
    for (size_t i = 0; i < s->n; i++) {
        sum[i] = plain[i];
        const struct ct_block_row *r = &s->row[i];
        if (r->coordinate >= 0) // value of the line's right side
            sum[i] = f->value[side[2 * i].id] - plain[i];
    }
    for (size_t b = 0; b < nbeam; b++)
        for (int k = 0; s->block[b].f && k < s->block[b].f->nelastic; k++) {
            set_block(f, &s->block[b], &of[b], engine, k);
            const double *with = row_values(f, s, side);
            set_block(f, &s->block[b], &of[b], engine, -1);
            for (size_t i = 0; i < s->n; i++)
                if (s->row[i].beam < 0)
                    sum[i] += with[i] - plain[i];
                else if (s->row[i].coordinate >= 0)
                    sum[i] -= with[i] - plain[i];
            for (size_t i = s->n; i < nall; i++)
                sum[i] += with[i] - plain[i];
        }
    for (size_t i = 0; i < e->ndriver; i++) {
        const double want = engine[f->plain.effort[i].id];
        check_row(system, e->driver[i].name, sum[s->n + i], want, fmax(1, fabs(want)));
    }
    for (size_t i = 0; i < s->n; i++)
        if (s->row[i].coordinate >= 0)
            of[s->row[i].beam].applied[s->row[i].coordinate] = sum[i];
    double scale;
    for (size_t i = 0, speed = 0; i < s->n; i++) {
        const struct ct_block_row *r = &s->row[i];
        if (r->coordinate >= 0)
            continue;
        if (r->beam >= 0) {
            const struct ct_flexible *self = s->block[r->beam].f;
            for (int k = 0; k < self->nelastic; k++) {
                set_block(f, &s->block[r->beam], &of[r->beam], engine, k);
                const double got = row_values(f, s, side)[i];
                const double want = residual(f, engine, (size_t)self->elastic[k].u, &scale);
                check_row(system, self->elastic[k].name, got, want, scale);
            }
            set_block(f, &s->block[r->beam], &of[r->beam], engine, -1);
            continue;
        }
        for (bool is_elastic = true; is_elastic; speed += is_elastic) {
            is_elastic = false;
            for (size_t b = 0; b < nbeam; b++)
                for (int k = 0; s->block[b].f && k < s->block[b].f->nelastic; k++)
                    is_elastic |= (size_t)s->block[b].f->elastic[k].u == speed;
        }
        const double want = residual(f, engine, speed, &scale);
        check_row(system, r->label, sum[i], want, scale);
        speed++;
    }
}

// The last two: coordinates that move the frame of their own beam.
static const char *const with_blocks[] = {"slider_crank_flexible",
                                          "two_boom_satellite",
                                          "two_boom_satellite/space.yaml",
                                          "right_angle_frame",
                                          "spin_up_welded",
                                          "../tests/reference/B06_linear_tc.yaml",
                                          "../tests/reference/B06_tt.yaml"};

static void blocks_of_beams_equal_the_engine(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(with_blocks); i++) {
        struct fixture f;
        struct ct_beam_blocks s;
        formulate(&f, with_blocks[i]);
        ct_reduced_prepare(f.ctx.scratch, &f.e, false, &f.plain);
        assert_true(ct_derivation_blocks(&f.d, &f.r, &s));
        f.r.definitions = s.definitions;
        ct_ex *side = CT_NEWN(f.ctx.scratch, ct_ex, 2 * s.n + 1);
        struct engine_beam *of
            = CT_NEWN(f.ctx.scratch, struct engine_beam, f.e.build->nflexible + 1);
        for (size_t k = 0; k < s.n; k++) {
            side[2 * k] = ct_block_left(f.e.x, &s.row[k]);
            side[2 * k + 1] = ct_block_right(f.e.x, &s.row[k]);
        }
        for (size_t b = 0; b < f.e.build->nflexible; b++)
            if (s.block[b].f)
                find_entries(&f, s.block[b].f, &of[b]);
        f.symbol = CT_NEWN(f.ctx.scratch, double, f.e.x->nsym);
        for (int k = 0; k < 3; k++)
            check_blocks(&f, with_blocks[i], &s, side, of);
        finish(&f);
    }
}

// ---- readable again -----------------------------------------------------------------------------

// Outputs of the model leave signals of the same name behind.
static enum ct_name_result find_symbol(const struct fixture *f, const char *name, ct_ex *e)
{
    const struct ct_exs *x = f->e.x;
    for (uint32_t id = 0; id < x->nnode; id++) {
        const struct ct_sym *s = ct_ex_symbol(x, (ct_ex){id});
        if (s && s->kind != CT_SYM_SIGNAL && !strcmp(s->name, name)) {
            *e = (ct_ex){id};
            return CT_NAME_OK;
        }
    }
    return CT_NAME_UNKNOWN;
}

static enum ct_name_result find_name(void *user, const char *name, ct_ex *e, const char **why)
{
    (void)why;
    return find_symbol(user, name, e);
}

static enum ct_name_result find_signal(void *user, const char *text, const char *first,
                                       const char *in, struct ct_mark where,
                                       struct ct_mark where_in, ct_ex *e, const char **why)
{
    (void)first, (void)in, (void)where, (void)where_in, (void)why;
    return find_symbol(user, text, e);
}

static void check_reads_back(struct fixture *f, ct_ex e)
{
    const struct ct_print plain = {.limit = 1000000};
    const struct ct_scope scope
        = {.x = f->e.x, .user = f, .name = find_name, .signal = find_signal};
    const struct ct_text text = {.text = ct_ex_text(f->ctx.scratch, f->e.x, e, &plain)};
    ct_ex back;
    if (!ct_parse(&f->ctx, &scope, text, &back)) {
        ct_ctx_print(&f->ctx, stderr);
        fail();
    }
    choose_state(f);
    evaluate(f);
    check_close(f->value[back.id], f->value[e.id], 1e-13 * fmax(1, fabs(f->value[e.id])));
}

static void text_for_programs_reads_back(void **state)
{
    (void)state;
    static const char *const small[] = {"pendulum",     "cart_pole", "double_pendulum",
                                        "slider_crank", "four_bar",  "pendulum_beam_tip_mass"};
    for (size_t i = 0; i < COUNT(small); i++) {
        struct fixture f;
        reduce(&f, small[i]);
        for (size_t k = 0; k < f.e.nM; k++)
            check_reads_back(&f, f.r.M[k]);
        for (size_t k = 0; k < f.e.nu; k++)
            check_reads_back(&f, f.r.Q[k]);
        for (size_t k = 0; k < f.e.nJ; k++)
            check_reads_back(&f, f.r.J[k]);
        for (size_t k = 0; k < f.e.nrow; k++)
            check_reads_back(&f, f.r.gam[k]);
        finish(&f);
    }
}

// ---- equal to the textbook's --------------------------------------------------------------------

static double *symbol_of(const struct fixture *f, const char *name)
{
    ct_ex e = CT_EX_ZERO;
    if (find_symbol(f, name, &e) != CT_NAME_OK)
        fail_msg("no symbol %s", name);
    return &f->symbol[ct_ex_node(f->e.x, e)->a];
}

static double of(const struct fixture *f, const char *name)
{
    return *symbol_of(f, name);
}

static void set(struct fixture *f, const char *name, double v)
{
    *symbol_of(f, name) = v;
}

// Accelerations and multipliers of the printed equations: [M -J'; J 0] [u'; lam] = [Q; -gam].
static void solve(const struct fixture *f, double *x)
{
    const struct ct_equations *e = &f->e;
    const size_t n = e->nu + e->nrow;
    double A[8][9] = {{0}};
    for (size_t k = 0; k < e->nM; k++)
        A[e->M[k].row][e->M[k].column] = A[e->M[k].column][e->M[k].row]
            = f->value[f->r.M[k].id];
    for (size_t k = 0; k < e->nJ; k++) {
        const size_t row = e->nu + (size_t)e->J[k].row;
        A[row][e->J[k].column] = f->value[f->r.J[k].id];
        A[e->J[k].column][row] = -f->value[f->r.J[k].id];
    }
    for (size_t i = 0; i < n; i++)
        A[i][n] = i < e->nu ? f->value[f->r.Q[i].id] : -f->value[f->r.gam[i - e->nu].id];
    for (size_t i = 0; i < n; i++) { // Gauss with row exchange
        size_t pivot = i;
        for (size_t k = i; k < n; k++)
            pivot = fabs(A[k][i]) > fabs(A[pivot][i]) ? k : pivot;
        for (size_t j = 0; j <= n; j++) {
            const double swap = A[i][j];
            A[i][j] = A[pivot][j];
            A[pivot][j] = swap;
        }
        for (size_t k = 0; k < n; k++)
            for (size_t j = n + 1; k != i && j-- > i;)
                A[k][j] -= A[k][i] / A[i][i] * A[i][j];
    }
    for (size_t i = 0; i < n; i++)
        x[i] = A[i][n] / A[i][i];
}

// f->symbol is set; accelerations by name of the joint.
static double acceleration(struct fixture *f, const char *name)
{
    double x[8] = {0};
    evaluate(f);
    solve(f, x);
    for (size_t i = 0; i < f->e.nu; i++)
        if (!strcmp(f->e.u[i].name, name))
            return x[i];
    fail();
    return 0;
}

enum { STATES = 20 };

// m l^2 q'' = -m g l sin q
static void pendulum_is_that_of_the_textbook(void **state)
{
    (void)state;
    struct fixture f;
    reduce(&f, "pendulum");
    for (int k = 0; k < STATES; k++) {
        choose_state(&f);
        const double want = -of(&f, "g") / of(&f, "l") * sin(of(&f, "pivot.q"));
        check_close(acceleration(&f, "pivot.u"), want, 1e-12);
    }
    finish(&f);
}

// (M + m) x'' - m l th'' cos th + m l th'^2 sin th = F
// l th'' - g sin th = x'' cos th               e.g. Cannon, Dynamics of Physical Systems, 1967
static void cart_pole_is_that_of_the_textbook(void **state)
{
    (void)state;
    struct fixture f;
    reduce(&f, "cart_pole");
    for (int i = 0; i < STATES; i++) {
        choose_state(&f);
        const double M = of(&f, "M"), m = of(&f, "m"), l = of(&f, "l"), g = of(&f, "g");
        const double s = sin(of(&f, "pin.q")), c = cos(of(&f, "pin.q")), w = of(&f, "pin.u");
        const double x
            = (of(&f, "F") - m * l * w * w * s + m * g * s * c) / (M + m - m * c * c);
        check_close(acceleration(&f, "rail.u"), x, 1e-12 * fmax(1, fabs(x)));
        check_close(acceleration(&f, "pin.u"), (g * s + x * c) / l, 1e-11);
    }
    finish(&f);
}

// In the angles from the vertical:
// (m1 + m2) l1^2 th1'' + m2 l1 l2 cos(th1 - th2) th2'' + m2 l1 l2 sin(th1 - th2) th2'^2
//     + (m1 + m2) g l1 sin th1 = 0
// m2 l2^2 th2'' + m2 l1 l2 cos(th1 - th2) th1'' - m2 l1 l2 sin(th1 - th2) th1'^2
//     + m2 g l2 sin th2 = 0                     Landau and Lifshitz, Mechanics, section 5
static void double_pendulum_is_that_of_the_textbook(void **state)
{
    (void)state;
    struct fixture f;
    reduce(&f, "double_pendulum");
    for (int i = 0; i < STATES; i++) {
        choose_state(&f);
        const double m1 = of(&f, "m1"), m2 = of(&f, "m2"), l1 = of(&f, "l1"), l2 = of(&f, "l2");
        const double g = of(&f, "g"), a = of(&f, "shoulder.q"), b = of(&f, "lower.angle");
        const double wa = of(&f, "shoulder.u"), wb = of(&f, "lower.u3");
        const double A = (m1 + m2) * l1 * l1, B = m2 * l1 * l2 * cos(a - b), C = m2 * l2 * l2;
        const double p = -m2 * l1 * l2 * sin(a - b) * wb * wb - (m1 + m2) * g * l1 * sin(a);
        const double r = m2 * l1 * l2 * sin(a - b) * wa * wa - m2 * g * l2 * sin(b);
        const double D = A * C - B * B;
        const double first = (C * p - B * r) / D, second = (A * r - B * p) / D;
        const double tolerance = 1e-12 * fmax(1, fmax(fabs(first), fabs(second)) * A * C / D);
        check_close(acceleration(&f, "shoulder.u"), first, tolerance);
        check_close(acceleration(&f, "lower.u3"), second, tolerance);
    }
    finish(&f);
}

// J(th) th'' + J'(th) th'^2/2 = torque with the kinetic coefficients of all bodies, eliminated by
// hand: Eksergian's equation, Paul, Kinematics and Dynamics of Planar Machinery, 1979, chapter 12
static void slider_crank_is_that_of_the_textbook(void **state)
{
    (void)state;
    struct fixture f;
    reduce(&f, "slider_crank");
    for (int i = 0; i < STATES; i++) {
        choose_state(&f);
        const double r = of(&f, "r"), l = 2 * r + of(&f, "l"), w = of(&f, "main.u");
        const double th = of(&f, "main.q"), phi = asin(r / l * sin(th));
        const double s = sin(th), c = cos(th), sp = sin(phi), cp = cos(phi);
        // first and second derivatives by th of: rod angle, its centre of mass, slider
        const double k = r * c / (l * cp), k2 = (l * sp * k * k - r * s) / (l * cp);
        const double x = -r * s - l / 2 * sp * k, x2 = -r * c - l / 2 * (cp * k * k + sp * k2);
        const double y = r * c - l / 2 * cp * k, y2 = -r * s + l / 2 * (sp * k * k - cp * k2);
        const double z = -r * s - l * sp * k, z2 = -r * c - l * (cp * k * k + sp * k2);
        const double m1 = of(&f, "m1"), m2 = of(&f, "m2"), m3 = of(&f, "m3");
        const double J1 = of(&f, "J1"), J2 = of(&f, "J2");
        const double J = J1 + m1 * r * r / 4 + m2 * (x * x + y * y) + J2 * k * k + m3 * z * z;
        const double half = m2 * (x * x2 + y * y2) + J2 * k * k2 + m3 * z * z2;
        const double want = (of(&f, "torque") - half * w * w) / J;
        set(&f, "l", l);
        set(&f, "small_end.q", phi);
        set(&f, "small_end.u", k * w);
        check_close(acceleration(&f, "main.u"), want, 1e-12 * fmax(1, fabs(want)));
        check_close(f.value[f.r.phi[0].id], 0, 1e-15);
    }
    finish(&f);
}

// ---- the formats --------------------------------------------------------------------------------

static char *print(const char *system, unsigned stages, enum ct_equations_format format)
{
    struct fixture f;
    char *text = NULL;
    size_t n;
    formulate(&f, system);
    FILE *out = open_memstream(&text, &n);
    assert_true(ct_equations_print(out, f.ctx.scratch, &f.e, &f.m, stages, format, false));
    fclose(out);
    finish(&f);
    return text;
}

static void all_formats_print_all_systems(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(systems); i++)
        for (int format = CT_FORMAT_TEXT; format <= CT_FORMAT_JSON; format++) {
            // one look at the longest is enough
            if (!strcmp(systems[i], "chain40") && format != CT_FORMAT_TEXT)
                continue;
            char *text = print(systems[i], CT_STAGE_ALL, (enum ct_equations_format)format);
            assert_true(strlen(text) > 300);
            assert_null(strstr(text, "...\""));
            free(text);
        }
}

static void small_systems_fit_a_screen(void **state)
{
    (void)state;
    static const char *const small[] = {"pendulum",     "cart_pole", "double_pendulum",
                                        "slider_crank", "four_bar",  "pendulum_beam_tip_mass"};
    for (size_t i = 0; i < COUNT(small); i++) {
        char *text = print(small[i], CT_STAGE_REDUCED, CT_FORMAT_TEXT);
        int lines = 0;
        for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n"), lines++)
            assert_true(strlen(line) <= 100);
        assert_true(lines <= 60);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_printed_equals_the_engine),
        cmocka_unit_test(the_recursive_form_equals_the_matrix_form),
        cmocka_unit_test(blocks_of_beams_equal_the_engine),
        cmocka_unit_test(text_for_programs_reads_back),
        cmocka_unit_test(pendulum_is_that_of_the_textbook),
        cmocka_unit_test(cart_pole_is_that_of_the_textbook),
        cmocka_unit_test(double_pendulum_is_that_of_the_textbook),
        cmocka_unit_test(slider_crank_is_that_of_the_textbook),
        cmocka_unit_test(all_formats_print_all_systems),
        cmocka_unit_test(small_systems_fit_a_screen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
