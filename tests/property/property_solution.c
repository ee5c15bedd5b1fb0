// Accelerations in closed form are those of the numerical solution, for every open shipped system.
#include "tests/property/system.h"

static const struct ct_formulate_options with_solution
    = {.tree = CT_TREE_JOINTS, .with_energy = true, .with_solution = true};

// u' by the closed form and by Cholesky of M at a random state; M may be ill-conditioned, so that the
// residual M u' - Q is what is compared.
static bool same_accelerations(struct system *s, struct variant *v)
{
    struct ct_start state;
    struct ct_machine *m = v->m;
    double a[64], scale = 1, worst = 0;
    assert_true(m->nu <= COUNT(a));
    if (!system_random_state(s, 0, 0.5, &state))
        return true;
    variant_set(v, &state, 0);
    ct_machine_motion(m);
    assert_true(ct_machine_solved(m, a));
    for (size_t i = 0; i < m->nu; i++) {
        double r = -m->Q[i];
        for (size_t k = 0; k < m->nu; k++) {
            r += m->M[i + m->nu * k] * a[k];
            scale = fmax(scale, fabs(m->M[i + m->nu * k] * a[k]));
        }
        worst = fmax(worst, fabs(r));
    }
    return agree(s->name, "M u' - Q", worst, 0, scale, 1e-12);
}

static void closed_form_solves_the_equations(void **state)
{
    (void)state;
    size_t solved = 0;
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < nshipped; i++) {
        struct system s;
        struct variant v;
        system_open_file(&s, shipped[i]);
        system_no_outputs(&s);
        variant_open(&s, &with_solution, &v);
        assert_true(!v.e.solution || v.e.nrow == 0);
        solved += v.e.solution != NULL;
        for (int k = 0; k < 5 && v.e.solution; k++)
            ok &= same_accelerations(&s, &v);
        variant_close(&v);
        system_close(&s);
    }
    assert_true(ok);
    assert_true(solved >= 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(closed_form_solves_the_equations)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
