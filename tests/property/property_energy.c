// Energies and momenta: T = u' M u / 2, dT/dt + dV/dt = power, what runs must keep.
#include "numeric/dense.h"
#include "tests/property/mechanism.h"
#include "tests/property/system.h"

// T is quadratic in the speeds, so that second differences with unit steps are exact to round-off.
static const double exact = 1e-12;

static double kinetic(struct variant *v, const double *u)
{
    struct ct_evaluator *m = v->m;
    memcpy(m->input + m->at_u, u, m->nu * sizeof *u);
    ct_program_run(&m->energy, m->input);
    return m->energy.out[0];
}

// M_kl = T(e_k + e_l) - T(e_k) - T(e_l) + T(0), drivers or not.
static bool mass_matrix_agrees(struct system *s, struct variant *v)
{
    struct ct_evaluator *m = v->m;
    const size_t n = m->nu;
    double *u = CT_NEWN(v->arena, double, n + 1), *own = CT_NEWN(v->arena, double, n + 1);
    double *kept = CT_NEWN(v->arena, double, n + 1), largest = 0;
    const double *M = ct_partition_mass(v->s);
    bool ok = true;
    memcpy(kept, m->input + m->at_u, n * sizeof *kept);
    const double rest = kinetic(v, u);
    for (size_t k = 0; k < n; k++) {
        u[k] = 1;
        own[k] = kinetic(v, u);
        u[k] = 0;
        largest = fmax(largest, fabs(M[k + n * k]));
    }
    for (size_t k = 0; k < n; k++)
        for (size_t l = 0; l <= k; l++) {
            u[k] += 1;
            u[l] += 1;
            const double both = kinetic(v, u);
            u[k] = u[l] = 0;
            ok &= agree(
                s->name, text_of(v->arena, "M of %s and %s", v->e.u[k].name, v->e.u[l].name),
                M[k + n * l], both - own[k] - own[l] + rest, largest + fabs(rest), exact);
        }
    memcpy(m->input + m->at_u, kept, n * sizeof *kept);
    return ok;
}

// M positive definite on the motions that the rows allow.
static bool mass_is_positive(struct system *s, struct variant *v)
{
    struct ct_evaluator *m = v->m;
    const size_t n = m->nu, r = m->nrow;
    double *A = CT_NEWN(v->arena, double, n *n + 1), *w = CT_NEWN(v->arena, double, n + 1);
    double *work = CT_NEWN(v->arena, double, ct_symmetric_eigenvalues_work((int)n + 1));
    const double *M = ct_partition_mass(v->s);
    double scale = 0;
    for (size_t k = 0; k < n; k++)
        scale = fmax(scale, M[k + n * k]);
    // M + scale J'J is positive definite iff M is so on null(J), M being at least semidefinite
    for (size_t k = 0; k < n; k++)
        for (size_t l = 0; l < n; l++) {
            A[k + n * l] = M[k + n * l] / scale;
            for (size_t i = 0; i < r; i++)
                A[k + n * l] += m->J[i + r * k] * m->J[i + r * l];
        }
    if (n)
        ct_symmetric_eigenvalues(w, A, (int)n, (int)n, work);
    if (n && !(w[0] > 1e-12)) {
        print_error("%s: smallest eigenvalue %g\n", s->name, w[0]);
        return false;
    }
    memcpy(A, M, n * n * sizeof *A);
    if (n)
        ct_symmetric_eigenvalues(w, A, (int)n, (int)n, work);
    return !n || w[0] > -1e-12 * scale;
}

// d(T + V)/dt along the motion by central differences against the power.
static bool power_agrees(struct system *s, struct variant *v, double t)
{
    const double tolerance = 2e-6; // of energies and of what flows between them
    struct ct_evaluator *m = v->m;
    const size_t n = m->nq + m->nu;
    double *dy = CT_NEWN(v->arena, double, n + 1), *d = CT_NEWN(v->arena, double, m->nu + 1);
    double *y = CT_NEWN(v->arena, double, n + 1), total[2], largest = 0;
    if (!variant_solve(v))
        return false;
    double power = 0;
    if (!ct_ex_is_zero(v->e.power)) {
        ct_program_run(&m->power, m->input);
        power = m->power.out[0];
    }
    memcpy(dy, v->s->a, m->nu * sizeof *dy);
    const double *M = ct_partition_mass(v->s);
    double most = 0, flow = 0;
    for (size_t k = 0; k < m->nu; k++) {
        double inertia = 0;
        for (size_t l = 0; l < m->nu; l++)
            inertia += M[k + m->nu * l] * dy[l];
        flow += fabs(inertia * v->y[m->nq + k]);
        most = fmax(most, fabs(dy[k]));
    }
    const double h = 1e-5 / (1 + most / 100); // stiff springs push hard at random states
    for (int side = 0; side < 2; side++) {
        const double e = side ? h : -h;
        memcpy(y, v->y, (n + 1) * sizeof *y);
        // q to second order: its own acceleration counts in differences of V at h^2 only
        for (size_t k = 0; k < m->nu; k++) {
            d[k] = e * (v->y[m->nq + k] + e / 2 * dy[k]);
            y[m->nq + k] += e * dy[k];
        }
        ct_evaluator_retract(m, y, d);
        ct_evaluator_set(m, t + e, y);
        ct_program_run(&m->energy, m->input);
        total[side] = m->energy.out[0] + m->energy.out[1];
        largest = fmax(largest, fabs(m->energy.out[0]) + fabs(m->energy.out[1]));
    }
    ct_evaluator_set(m, t, v->y);
    return agree(s->name, "power", power, (total[1] - total[0]) / (2 * h), 1 + largest + flow,
                 tolerance);
}

static bool energies_agree(struct system *s)
{
    static const struct ct_formulate_options *const how[]
        = {&by_joints, &by_bodies, &by_choice};
    bool ok = true;
    system_no_outputs(s);
    for (size_t i = 0; i < COUNT(how); i++) {
        struct variant v;
        variant_open(s, how[i], &v);
        for (int k = 0; k < 2; k++) {
            const double t = k ? 0.43 : 0.01;
            struct ct_initial_state state;
            assert_true(system_random_state(s, t, 0.5, &state));
            variant_set(&v, &state, t);
            ok &= mass_matrix_agrees(s, &v);
            ok &= mass_is_positive(s, &v);
            ok &= power_agrees(s, &v, t);
        }
        if (!ok)
            print_error("  choice %zu\n", i);
        variant_close(&v);
    }
    return ok;
}

static void energies_of_shipped_systems_agree_with_the_equations(void **state)
{
    (void)state;
    chance_start();
    assert_true(holds_for_shipped(energies_agree, SIZE_MAX));
}

static void energies_of_every_mechanism_agree_with_the_equations(void **state)
{
    (void)state;
    chance_start();
    assert_true(holds_for_mechanisms(energies_agree, 0x55));
}

// ---- what a run keeps ---------------------------------------------------------------------------

static void keep_first_and_last(double *store, size_t n, const double *value, bool first)
{
    memcpy(store + (first ? 0 : n), value, n * sizeof *value);
}

struct ends {
    double *value;
    size_t rows;
};

static bool at_row(void *user, double t, const double *value, size_t n)
{
    struct ends *e = user;
    (void)t;
    keep_first_and_last(e->value, n, value, e->rows++ == 0);
    return true;
}

// First and last row of a run over `duration`; value holds 2 nresult entries.
static double *run_ends(struct system *s, struct variant *v, double duration)
{
    struct ends e = {CT_NEWN(v->arena, double, 2 * v->e.nresult + 1), 0};
    struct ct_run_report report;
    const struct ct_run_options o = {.method = ct_method_find("dop853"),
                                     .duration = duration,
                                     .rtol = 1e-11,
                                     .atol = 1e-12,
                                     .nsample = 2,
                                     .row = at_row,
                                     .user = &e};
    struct ct_run *run = ct_run_create(&v->ctx, v->arena, &s->model, &v->e, &s->start);
    if (!run || !ct_run_simulate(run, &o, &report)) {
        print_error("%s: no run\n", s->name);
        ct_ctx_print(&v->ctx, stderr);
        fail();
    }
    return e.value;
}

static void energy_less_work_is_kept_by_every_mechanism(void **state)
{
    (void)state;
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < nmechanism; i++)
        for (int bodies = 0; bodies < 2; bodies++) {
            struct system s;
            struct variant v;
            struct ct_arena *a = ct_arena_create();
            system_open_text(
                &s, mechanisms[i].name,
                mechanism_text(a, &mechanisms[i], NULL,
                               (unsigned)chance_of(256) * !mechanisms[i].is_irreversible,
                               false));
            system_no_outputs(&s);
            system_output(&s, "energy.total");
            system_output(&s, "energy.kinetic");
            system_output(&s, "energy.potential");
            variant_open(&s, bodies ? &by_bodies : &by_joints, &v);
            const double *e = run_ends(&s, &v, 0.3);
            ok &= agree(s.name, "energy.total", e[3], e[0],
                        1 + fabs(e[1]) + fabs(e[2]) + fabs(e[4]) + fabs(e[5]), 1e-8);
            variant_close(&v);
            system_close(&s);
            ct_arena_destroy(a);
        }
    assert_true(ok);
}

// Two bodies afloat, joined and sprung to each other, no gravity: momenta stay what they are.
static void momenta_of_a_floating_system_are_kept(void **state)
{
    (void)state;
    static const char text[]
        = "cotree: 1\n"
          "bodies:\n"
          "  A: {mass: 1, inertia: [0.1, 0.2, 0.15], com: [0.1, 0, 0.2], points: {p: [0.3, "
          "0.1, 0]}}\n"
          "  B: {mass: 2, inertia: [0.2, 0.1, 0.15, 0.01, 0, 0.02], points: {p: [0, 0.3, "
          "0.1]}}\n"
          "  C: {mass: 1, inertia: 0.1}\n"
          "  P: {type: particle, mass: 0.5}\n"
          "joints:\n"
          "  place: {type: free, from: ground, to: A, initial: {q: [1, 2, 3], rotate: [x, "
          "0.4], u: [1, -1, 0.5, 2, 1, -3]}}\n"
          "  y: {type: universal, from: A.p, to: B, stiffness: [1, 2], damping: [0.1, 0.2], "
          "initial: {q: [0.2, 0.3], u: [1, -2]}}\n"
          "  z: {type: cylindrical, from: B.p, to: C, axis: [1, 1, 0], stiffness: [10, 1], "
          "initial: {u: [0.5, 1]}}\n"
          "  rod: {type: distance, from: C, to: P, length: 0.4}\n"
          "forces:\n"
          "  line: {type: spring, from: A, to: P, stiffness: 10, length: 0.2, damping: 1}\n"
          "  soft: {type: bushing, from: A, to: C, stiffness: [1, 2, 3, 0.1, 0.1, 0.2], "
          "damping: [0.1, 0.1, 0.2, 0.1, 0.1, 0.1]}\n"
          "outputs: [system.momentum, system.angular_momentum, energy.total, system.com]\n";
    for (int i = 0; i < 3; i++) {
        struct system s;
        struct variant v;
        system_open_text(&s, "floating", text);
        variant_open(&s, i == 0 ? &by_joints : i == 1 ? &by_bodies : &by_choice, &v);
        const double *e = run_ends(&s, &v, 0.5);
        const size_t n = v.e.nresult;
        bool ok = true;
        for (size_t k = 0; k < 7; k++)
            ok &= agree(s.name, v.e.result[k].name, e[k + n], e[k], 10, 1e-9);
        for (size_t k = 0; k < 3; k++) // the centre of mass moves evenly: 4.5 kg
            ok &= agree(s.name, v.e.result[k + 7].name, e[k + 7 + n],
                        e[k + 7] + 0.5 * e[k] / 4.5, 1, 1e-9);
        assert_true(ok);
        assert_true(fabs(e[0]) > 0.1 && fabs(e[3]) > 0.1);
        variant_close(&v);
        system_close(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(energies_of_shipped_systems_agree_with_the_equations),
        cmocka_unit_test(energies_of_every_mechanism_agree_with_the_equations),
        cmocka_unit_test(energy_less_work_is_kept_by_every_mechanism),
        cmocka_unit_test(momenta_of_a_floating_system_are_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
