// Rows of constraints against differences: J and v of phi, gam of v.  (formulation 4.3)
#include "numeric/dense.h"
#include "tests/property/system.h"

// Central differences with step h err by h^2/6 of the third derivative and eps/h: 1e-9 at 1e-5 and
// order one; rows grow with lengths and speeds of a few.
static const double step = 1e-5, tolerance = 2e-7;

static void constraints_at(struct variant *v, double t, const double *y, double *phi,
                           double *rate)
{
    ct_evaluator_set(v->m, t, y);
    ct_evaluator_constraint(v->m);
    memcpy(phi, v->m->phi, v->m->nrow * sizeof *phi);
    memcpy(rate, v->m->v, v->m->nrow * sizeof *rate);
}

struct difference {
    double *phi[2], *rate[2], *y;
};

// Constraints at both ends of a small motion: q moves along d, time by dt.
static void differences(struct variant *v, double t, const double *d, double dt,
                        struct difference *out)
{
    struct ct_evaluator *m = v->m;
    double *small = CT_NEWN(v->arena, double, m->nu + 1);
    for (int k = 0; k < 2; k++) {
        const double h = k ? step : -step;
        memcpy(out->y, v->y, (m->nq + m->nu + 1) * sizeof *v->y);
        for (size_t i = 0; i < m->nu; i++)
            small[i] = h * d[i];
        ct_evaluator_retract(m, out->y, small);
        constraints_at(v, t + h * dt, out->y, out->phi[k], out->rate[k]);
    }
}

// Measured coordinates are those of a joint only while its own rows are met.
static bool is_measured(const struct ct_row *row)
{
    return strstr(row->name, ".motion") || !strchr(row->name, '.');
}

// d less its part that violates rows other than measured ones.
static void keep_to_rows(struct variant *v, const double *J, double *d)
{
    const size_t n = v->m->nu, r = v->m->nrow, most = n > r ? n : r;
    double *A = CT_NEWN(v->arena, double, r *n + 1), *b = CT_NEWN(v->arena, double, most + 1);
    double *work = CT_NEWN(v->arena, double, ct_lstsq_work((int)r, (int)n) + 1);
    int *iwork = CT_NEWN(v->arena, int, most + 1);
    int m = 0;
    for (size_t i = 0; i < r; i++) {
        if (is_measured(&v->e.row[i]))
            continue;
        for (size_t k = 0; k < n; k++) {
            A[(size_t)m + r * k] = J[i + r * k];
            b[m] += J[i + r * k] * d[k];
        }
        m++;
    }
    if (m)
        ct_lstsq(b, A, m, (int)n, (int)r, 1e-10, iwork, work);
    for (size_t k = 0; m && k < n; k++)
        d[k] -= b[k];
}

// Measured rows along random motions that their joints allow.
static bool measured_rows_agree(struct system *s, struct variant *v, double t, const double *J,
                                struct difference *x)
{
    const size_t n = v->m->nu, r = v->m->nrow;
    double *d = CT_NEWN(v->arena, double, n + 1);
    bool ok = true;
    for (size_t repeat = 0; repeat < n; repeat++) {
        for (size_t k = 0; k < n; k++)
            d[k] = chance();
        keep_to_rows(v, J, d);
        differences(v, t, d, 0, x);
        for (size_t i = 0; i < r; i++) {
            double along = 0;
            for (size_t k = 0; k < n; k++)
                along += J[i + r * k] * d[k];
            ok &= !is_measured(&v->e.row[i])
               || agree(s->name, text_of(v->arena, "J of '%s'", v->e.row[i].name), along,
                        (x->phi[1][i] - x->phi[0][i]) / (2 * step), 1, tolerance);
        }
    }
    return ok;
}

static bool rows_agree(struct system *s, struct variant *v, double t, bool on_rows)
{
    struct ct_evaluator *m = v->m;
    const size_t n = m->nu, r = m->nrow;
    bool ok = true;
    double *d = CT_NEWN(v->arena, double, n + 1), *u = v->y + m->nq;
    double *J = CT_NEWN(v->arena, double, r *n + 1), *gam = CT_NEWN(v->arena, double, r + 1),
           *rate = CT_NEWN(v->arena, double, r + 1);
    memcpy(J, m->J, r * n * sizeof *J);
    memcpy(gam, m->gam, r * sizeof *gam);
    memcpy(rate, m->v, r * sizeof *rate);
    struct difference x = {.y = CT_NEWN(v->arena, double, m->nq + n + 1)};
    for (int k = 0; k < 2; k++) {
        x.phi[k] = CT_NEWN(v->arena, double, r + 1);
        x.rate[k] = CT_NEWN(v->arena, double, r + 1);
    }
    for (size_t k = 0; k < n; k++) {
        memset(d, 0, n * sizeof *d);
        d[k] = 1;
        differences(v, t, d, 0, &x);
        for (size_t i = 0; i < r; i++)
            ok &= is_measured(&v->e.row[i])
               || agree(s->name,
                        text_of(v->arena, "J of '%s' by %s", v->e.row[i].name, v->e.u[k].name),
                        J[i + r * k], (x.phi[1][i] - x.phi[0][i]) / (2 * step), 1, tolerance);
    }
    if (on_rows)
        ok &= measured_rows_agree(s, v, t, J, &x);
    differences(v, t, u, 1, &x);
    for (size_t i = 0; i < r; i++) {
        const double scale = 1 + fabs(gam[i]);
        if (!on_rows && is_measured(&v->e.row[i]))
            continue;
        ok &= agree(s->name, text_of(v->arena, "v of '%s'", v->e.row[i].name), rate[i],
                    (x.phi[1][i] - x.phi[0][i]) / (2 * step), 1 + fabs(rate[i]), tolerance);
        ok &= agree(s->name, text_of(v->arena, "gam of '%s'", v->e.row[i].name), gam[i],
                    (x.rate[1][i] - x.rate[0][i]) / (2 * step), scale, 10 * tolerance);
    }
    return ok;
}

// Rates of the stored coordinates against the retraction.
static bool rates_agree(struct system *s, struct variant *v)
{
    struct ct_evaluator *m = v->m;
    double *y[2], *d = CT_NEWN(v->arena, double, m->nu + 1);
    bool ok = true;
    for (int k = 0; k < 2; k++) {
        y[k] = CT_NEWN(v->arena, double, m->nq + m->nu + 1);
        memcpy(y[k], v->y, (m->nq + m->nu) * sizeof *d);
        for (size_t i = 0; i < m->nu; i++)
            d[i] = (k ? step : -step) * v->y[m->nq + i];
        ct_evaluator_retract(m, y[k], d);
    }
    for (size_t i = 0; i < m->nq; i++)
        ok &= agree(s->name, text_of(v->arena, "rate of %s", v->e.q[i].name), m->rate[i],
                    (y[1][i] - y[0][i]) / (2 * step), 1 + fabs(m->rate[i]), tolerance);
    return ok;
}

static bool system_agrees(struct system *s)
{
    static const struct {
        const char *name;
        const struct ct_formulate_options *o;
    } how[] = {{"joints", &by_joints},
               {"bodies", &by_bodies},
               {"joints, spatial", &by_joints_spatial},
               {"bodies, spatial", &by_bodies_spatial}};
    bool ok = true;
    system_no_outputs(s);
    for (size_t i = 0; i < COUNT(how); i++) {
        struct variant v;
        if (how[i].o->keep_all && !how[i - 1].o->keep_all)
            system_keep_all(s);
        variant_open(s, how[i].o, &v);
        if (v.m->nrow * v.m->nu > 20000) { // the differences of long chains say nothing new
            variant_close(&v);
            continue;
        }
        for (int k = 0; k < 2; k++) {
            const double t = k ? 0.37 : 0;
            struct ct_initial_state state;
            assert_true(system_random_state(s, t, 0.5, &state));
            variant_set(&v, &state, t);
            // off the constraints, too: the derivatives hold anywhere
            for (size_t q = 0; k && q < v.m->nq; q++)
                v.y[q] += 0.01 * chance();
            ct_evaluator_normalise(v.m, v.y);
            ct_evaluator_set(v.m, t, v.y);
            ct_evaluator_dynamics(v.m);
            ct_evaluator_constraint(v.m);
            const bool same = rates_agree(s, &v) & rows_agree(s, &v, t, k == 0);
            if (!same)
                print_error("  with trees through %s\n", how[i].name);
            ok = ok && same;
        }
        variant_close(&v);
    }
    return ok;
}

static void rows_of_shipped_systems_agree_with_differences(void **state)
{
    (void)state;
    chance_start();
    assert_true(holds_for_shipped(system_agrees, SIZE_MAX));
}

static void rows_of_every_joint_agree_with_differences(void **state)
{
    (void)state;
    chance_start();
    assert_true(holds_for_mechanisms(system_agrees, 0xff));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_of_shipped_systems_agree_with_differences),
        cmocka_unit_test(rows_of_every_joint_agree_with_differences),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
