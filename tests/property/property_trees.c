// Whatever the trees: accelerations and reactions are the same, and the reactions balance every
// body.
#include "tests/property/mechanism.h"
#include "tests/property/system.h"

// Solutions of well conditioned linear systems of a few dozen unknowns, from states that meet the
// rows to 1e-12.
static const double tolerance = 1e-9;

static double largest(const double *v, size_t n)
{
    double max = 0;
    for (size_t i = 0; i < n; i++)
        max = fmax(max, fabs(v[i]));
    return max;
}

// A reaction of a joint counts where its three components do not hang on multipliers that are not
// unique.
static bool is_determined(const struct variant *v, size_t i)
{
    struct ct_exs *x = v->e.x;
    if (v->e.result[i].undetermined)
        return false;
    const size_t n = ct_ex_walk(x, &v->e.result[i].value, 1);
    for (size_t k = 0; k < n; k++) {
        const struct ct_sym *s = ct_ex_symbol(x, (ct_ex){x->stack[k]});
        if (s && s->kind == CT_SYM_LAM && !v->s->is_unique[s->index])
            return false;
    }
    return true;
}

// Results of two variants at one state; those that either finds undetermined are left out.
static bool results_agree(struct system *s, const struct variant *a, const struct variant *b,
                          const char *how)
{
    const double scale = 1 + largest(a->result, a->e.nresult);
    bool ok = true;
    assert_int_equal(a->e.nresult, b->e.nresult);
    for (size_t i = 0; i < a->e.nresult; i++)
        if (is_determined(a, i) && is_determined(b, i))
            ok &= agree(s->name, text_of(b->arena, "%s, %s", a->e.result[i].name, how),
                        b->result[i], a->result[i], scale, tolerance);
    return ok;
}

static void solve_at(struct system *s, struct variant *v, const struct ct_initial_state *state,
                     double t)
{
    variant_set(v, state, t);
    if (!variant_solve(v)) {
        print_error("%s: no accelerations\n", s->name);
        ct_ctx_print(&v->ctx, stderr);
        fail();
    }
    ct_partition_uniqueness(v->s, ct_null_space_create(v->arena, v->s));
}

// ---- three choices on everything ----------------------------------------------------------------

static bool choices_agree(struct system *s, bool keep_all)
{
    const struct ct_formulate_options *how[]
        = {keep_all ? &by_joints_spatial : &by_joints,
           keep_all ? &by_bodies_spatial : &by_bodies, &by_choice};
    static const char *const name[] = {"joints", "bodies", "choice"};
    const size_t n = keep_all ? 2 : 3;
    struct variant v[3];
    bool ok = true;
    for (size_t i = 0; i < n; i++)
        variant_open(s, how[i], &v[i]);
    for (int k = 0; k < 3; k++) {
        const double t = 0.31 * k;
        struct ct_initial_state state;
        assert_true(system_random_state(s, t, 0.6, &state));
        for (size_t i = 0; i < n; i++) {
            solve_at(s, &v[i], &state, t);
            if (i)
                ok &= results_agree(s, &v[0], &v[i], name[i]);
        }
    }
    for (size_t i = 0; i < n; i++)
        variant_close(&v[i]);
    return ok;
}

static void outputs_of_all(struct system *s)
{
    system_no_outputs(s);
    system_output_motion(s);
    system_output_reactions(s);
}

static void shipped_systems_move_alike_on_three_choices_of_trees(void **state)
{
    (void)state;
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < nshipped; i++) {
        struct system s;
        system_open_file(&s, shipped[i]);
        if (s.model.nbody > 20) { // reactions of the chain cost minutes: its motion alone
            system_no_outputs(&s);
            system_output_motion(&s);
        } else {
            outputs_of_all(&s);
        }
        ok &= choices_agree(&s, false);
        if (s.assembly.is_planar && s.model.nbody < 10) {
            system_keep_all(&s);
            ok &= choices_agree(&s, true);
        }
        system_close(&s);
    }
    assert_true(ok);
}

static void open_mechanism(struct system *s, struct ct_arena *a, const struct mechanism *m,
                           unsigned reversed)
{
    system_open_text(s, text_of(a, "%s%s", m->name, reversed ? ", reversed" : ""),
                     mechanism_text(a, m, NULL, reversed, false));
    assert_int_equal(s->assembly.is_planar, m->is_planar);
    outputs_of_all(s);
}

static void mechanisms_move_alike_on_three_choices_of_trees(void **state)
{
    (void)state;
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < nmechanism; i++)
        for (unsigned reversed = 0; reversed < (mechanisms[i].is_irreversible ? 1u : 2u);
             reversed++) {
            struct system s;
            struct ct_arena *a = ct_arena_create();
            open_mechanism(&s, a, &mechanisms[i], reversed * 0xff);
            ok &= choices_agree(&s, false);
            if (s.assembly.is_planar) {
                system_keep_all(&s);
                ok &= choices_agree(&s, true);
            }
            system_close(&s);
            ct_arena_destroy(a);
        }
    assert_true(ok);
}

// ---- pairs of trees by name ---------------------------------------------------------------------

// Every step-th pair against the trees through joints. Screws and custom joints must agree in both.
static bool pairs_agree(struct system *s, size_t pairs, size_t *tried)
{
    const struct tree_list T = system_trees(s, false, false), R = system_trees(s, false, true);
    const size_t all = T.n * R.n, step = pairs && all > pairs ? all / pairs : 1;
    struct variant first;
    struct ct_initial_state state;
    bool ok = true;
    variant_open(s, &by_joints, &first);
    assert_true(system_random_state(s, 0.2, 0.6, &state));
    solve_at(s, &first, &state, 0.2);
    for (size_t k = 0; k < all; k += step) {
        const struct tree_names *t = &T.tree[k / R.n], *r = &R.tree[k % R.n];
        struct ct_formulate_options o = trees_given(t, r);
        o.with_energy = o.with_outputs = true;
        struct variant v;
        char *how = text_of(first.arena, "T =");
        for (size_t i = 0; i < t->n; i++)
            how = text_of(first.arena, "%s %s", how, t->name[i]);
        how = text_of(first.arena, "%s, R =", how);
        for (size_t i = 0; i < r->n; i++)
            how = text_of(first.arena, "%s %s", how, r->name[i]);
        variant_open(s, &o, &v);
        solve_at(s, &v, &state, 0.2);
        ok &= results_agree(s, &first, &v, how);
        variant_close(&v);
        (*tried)++;
        if (!ok)
            break;
    }
    variant_close(&first);
    return ok;
}

static void all_pairs_of_trees_agree_on_small_systems(void **state)
{
    (void)state;
    static const char *const small[]
        = {"systems/slider_crank/model.yaml", "systems/four_bar/model.yaml",
           "systems/spatial_slider_crank/model.yaml"};
    size_t tried = 0;
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < COUNT(small); i++) {
        struct system s;
        system_open_file(&s, small[i]);
        outputs_of_all(&s);
        ok &= pairs_agree(&s, 0, &tried);
        system_close(&s);
    }
    print_message("%zu pairs\n", tried);
    assert_true(ok);
    assert_true(tried > 1000);
}

static void some_pairs_of_trees_agree_on_every_mechanism(void **state)
{
    (void)state;
    size_t tried = 0;
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < nmechanism; i++) {
        struct system s;
        struct ct_arena *a = ct_arena_create();
        open_mechanism(&s, a, &mechanisms[i],
                       mechanisms[i].is_irreversible ? 0 : (unsigned)chance_of(256));
        ok &= pairs_agree(&s, 23, &tried);
        system_close(&s);
        ct_arena_destroy(a);
    }
    print_message("%zu pairs\n", tried);
    assert_true(ok);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shipped_systems_move_alike_on_three_choices_of_trees),
        cmocka_unit_test(mechanisms_move_alike_on_three_choices_of_trees),
        cmocka_unit_test(all_pairs_of_trees_agree_on_small_systems),
        cmocka_unit_test(some_pairs_of_trees_agree_on_every_mechanism),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
