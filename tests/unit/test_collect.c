// The readable form: exact text of textbook cases, equal values everywhere.
#include "expr/collect.h"
#include "expr/print.h"
#include "random_ex.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

struct fixture {
    struct ct_arena *arena;
    struct ct_exs x;
    ct_ex m1, m2, m3, l1, l2, l3, I1, g, q1, q2, q3, u1, u2, a1, a2, t;
};

static void start(struct fixture *f)
{
    f->arena = ct_arena_create();
    ct_exs_init(&f->x, f->arena);
    struct {
        ct_ex *e;
        enum ct_sym_kind kind;
        const char *name;
    } const list[] = {{&f->m1, CT_SYM_PARAM, "m1"}, {&f->m2, CT_SYM_PARAM, "m2"},
                      {&f->m3, CT_SYM_PARAM, "m3"}, {&f->l1, CT_SYM_PARAM, "l1"},
                      {&f->l2, CT_SYM_PARAM, "l2"}, {&f->l3, CT_SYM_PARAM, "l3"},
                      {&f->I1, CT_SYM_PARAM, "I1"}, {&f->g, CT_SYM_PARAM, "g"},
                      {&f->q1, CT_SYM_Q, "q1"},     {&f->q2, CT_SYM_Q, "q2"},
                      {&f->q3, CT_SYM_Q, "q3"},     {&f->u1, CT_SYM_U, "q1'"},
                      {&f->u2, CT_SYM_U, "q2'"},    {&f->a1, CT_SYM_A, "q1''"},
                      {&f->a2, CT_SYM_A, "q2''"},   {&f->t, CT_SYM_TIME, "t"}};
    for (size_t k = 0; k < COUNT(list); k++)
        *list[k].e = ct_ex_sym(&f->x, list[k].kind, list[k].name, (uint32_t)k);
}

static void finish(struct fixture *f)
{
    ct_arena_destroy(f->arena);
}

static void check(struct fixture *f, ct_ex e, const char *want)
{
    ct_ex r = ct_ex_collect(&f->x, e, NULL);
    const char *got = ct_ex_text(f->arena, &f->x, r, NULL);
    struct random random = {1};
    double value[32];
    if (strcmp(got, want))
        print_message("from %s\n", ct_ex_text(f->arena, &f->x, e, NULL));
    assert_string_equal(got, want);
    for (int round = 0; round < 5; round++) {
        for (size_t k = 0; k < f->x.nsym; k++)
            value[k] = 2.5 + random_double(&random);
        double a = ct_ex_value(&f->x, e, value), b = ct_ex_value(&f->x, r, value);
        if (!(fabs(a - b) <= 1e-12 * (fabs(a) + 1)))
            fail_msg("%s: got %.17g, wanted %.17g", got, b, a);
    }
}

static void evaluate_all(const struct ct_exs *x, const double *value, double *v)
{
    for (uint32_t id = 0; id < x->nnode; id++) {
        const struct ct_exnode *n = &x->node[id];
        const int narg = ct_op_info[n->op].narg;
        if (ct_ex_is_const(x, (ct_ex){id}, &v[id]))
            continue;
        v[id] = n->op == CT_OP_SYM
                  ? value[n->a]
                  : ct_op_apply((enum ct_op)n->op, v[n->a], narg > 1 ? v[n->b] : 0,
                                narg > 2 ? v[n->c] : 0);
    }
}

static void check_values(struct fixture *f, struct random *r, ct_ex e, ct_ex got)
{
    double value[32], *v = CT_NEWN(f->arena, double, f->x.nnode);
    for (int round = 0; round < 4; round++) {
        for (size_t k = 0; k < f->x.nsym; k++)
            value[k] = random_double(r);
        evaluate_all(&f->x, value, v);
        // round-off is relative to the largest number on the way, not to the result
        double scale = fabs(v[e.id]);
        for (size_t n = ct_ex_walk(&f->x, &e, 1); n-- > 0;)
            scale = fmax(scale, fabs(v[f->x.stack[n]]));
        if (fabs(v[e.id] - v[got.id]) > 1e-12 * scale)
            fail_msg("got %.17g, wanted %.17g: %s\n  from %s", v[got.id], v[e.id],
                     ct_ex_text(f->arena, &f->x, got, NULL),
                     ct_ex_text(f->arena, &f->x, e, NULL));
    }
}

// ---- models built from ground components, nothing simplified ------------------------------------

static ct_ex mul3(struct ct_exs *x, ct_ex a, ct_ex b, ct_ex c)
{
    return ct_ex_mul(x, ct_ex_mul(x, a, b), c);
}

static ct_ex trig(struct fixture *f, enum ct_op op, ct_ex q)
{
    return ct_ex_fun(&f->x, op, q);
}

struct point {
    ct_ex x, y;
};

// Hanging rods: x = l sin, y = -l cos added up along the chain.
static struct point hang(struct fixture *f, struct point from, ct_ex l, ct_ex angle)
{
    struct ct_exs *x = &f->x;
    return (struct point){ct_ex_add(x, from.x, ct_ex_mul(x, l, trig(f, CT_OP_SIN, angle))),
                          ct_ex_sub(x, from.y, ct_ex_mul(x, l, trig(f, CT_OP_COS, angle)))};
}

// dp/da . dp/db
static ct_ex metric(struct fixture *f, struct point p, ct_ex a, ct_ex b)
{
    struct ct_exs *x = &f->x;
    return ct_ex_add(x, ct_ex_mul(x, ct_ex_diff(x, p.x, a), ct_ex_diff(x, p.x, b)),
                     ct_ex_mul(x, ct_ex_diff(x, p.y, a), ct_ex_diff(x, p.y, b)));
}

static const struct point origin = {{0}, {0}};

static void simple_pendulum_has_inertia_m_l_squared(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    ct_ex lc = ct_ex_mul(x, f.l1, trig(&f, CT_OP_COS, f.q1));
    ct_ex ls = ct_ex_mul(x, f.l1, trig(&f, CT_OP_SIN, f.q1));
    check(&f,
          ct_ex_mul(x, f.m1,
                    ct_ex_add(x, mul3(x, f.l1, trig(&f, CT_OP_COS, f.q1), lc),
                              mul3(x, f.l1, trig(&f, CT_OP_SIN, f.q1), ls))),
          "m1*l1^2");
    finish(&f);
}

static void double_pendulum_with_absolute_angles(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    struct point p1 = hang(&f, origin, f.l1, f.q1), p2 = hang(&f, p1, f.l2, f.q2);
    check(&f, ct_ex_mul(x, f.m2, metric(&f, p2, f.q1, f.q2)), "m2*l1*l2*cos(q1 - q2)");
    ct_ex M11 = ct_ex_add(x, ct_ex_mul(x, f.m1, metric(&f, p1, f.q1, f.q1)),
                          ct_ex_mul(x, f.m2, metric(&f, p2, f.q1, f.q1)));
    check(&f, M11, "l1^2*(m1 + m2)");
    check(&f, ct_ex_mul(x, f.m2, metric(&f, p2, f.q2, f.q2)), "m2*l2^2");
    finish(&f);
}

static void double_pendulum_with_relative_angles(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    struct point p1 = hang(&f, origin, f.l1, f.q1);
    struct point p2 = hang(&f, p1, f.l2, ct_ex_add(x, f.q1, f.q2));
    ct_ex M11 = ct_ex_add(x, ct_ex_mul(x, f.m1, metric(&f, p1, f.q1, f.q1)),
                          ct_ex_mul(x, f.m2, metric(&f, p2, f.q1, f.q1)));
    check(&f, M11, "m1*l1^2 + m2*(l1^2 + l2^2 + 2*l1*l2*cos(q2))");
    check(&f, ct_ex_mul(x, f.m2, metric(&f, p2, f.q1, f.q2)), "m2*l2*(l2 + l1*cos(q2))");
    finish(&f);
}

// The same with the second rod turned by a product of two rotations: cos(q1 + q2) never appears.
static void relative_angles_by_products_of_rotations(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    ct_ex c1 = trig(&f, CT_OP_COS, f.q1), s1 = trig(&f, CT_OP_SIN, f.q1);
    ct_ex c2 = trig(&f, CT_OP_COS, f.q2), s2 = trig(&f, CT_OP_SIN, f.q2);
    ct_ex c12 = ct_ex_sub(x, ct_ex_mul(x, c1, c2), ct_ex_mul(x, s1, s2));
    ct_ex s12 = ct_ex_add(x, ct_ex_mul(x, s1, c2), ct_ex_mul(x, c1, s2));
    struct point p1 = hang(&f, origin, f.l1, f.q1);
    struct point p2 = {ct_ex_add(x, p1.x, ct_ex_mul(x, f.l2, s12)),
                       ct_ex_sub(x, p1.y, ct_ex_mul(x, f.l2, c12))};
    check(&f, ct_ex_mul(x, f.m2, metric(&f, p2, f.q1, f.q1)),
          "m2*(l1^2 + l2^2 + 2*l1*l2*cos(q2))");
    check(&f, c12, "cos(q1 + q2)");
    check(&f, p2.x, "l1*sin(q1) + l2*sin(q1 + q2)");
    // mixed with the function of the sum the same terms still cancel
    check(&f, ct_ex_sub(x, c12, trig(&f, CT_OP_COS, ct_ex_add(x, f.q1, f.q2))), "0");
    finish(&f);
}

static void triple_chain_by_products_of_rotations(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    const ct_ex q[] = {f.q1, f.q2, f.q3}, l[] = {f.l1, f.l2, f.l3};
    ct_ex c = CT_EX_ONE, s = CT_EX_ZERO;
    struct point p = origin;
    for (int k = 0; k < 3; k++) {
        ct_ex ck = trig(&f, CT_OP_COS, q[k]), sk = trig(&f, CT_OP_SIN, q[k]);
        ct_ex next = ct_ex_sub(x, ct_ex_mul(x, c, ck), ct_ex_mul(x, s, sk));
        s = ct_ex_add(x, ct_ex_mul(x, s, ck), ct_ex_mul(x, c, sk));
        c = next;
        p.x = ct_ex_add(x, p.x, ct_ex_mul(x, l[k], c));
        p.y = ct_ex_add(x, p.y, ct_ex_mul(x, l[k], s));
    }
    check(&f, p.x, "l1*cos(q1) + l2*cos(q1 + q2) + l3*cos(q1 + q2 + q3)");
    check(&f, metric(&f, p, f.q3, f.q3), "l3^2");
    check(&f, metric(&f, p, f.q1, f.q3), "l3*(l3 + l1*cos(q2 + q3) + l2*cos(q3))");
    finish(&f);
}

// Lagrange's equation of the double pendulum, as linear form in the accelerations.
static void equation_of_motion_is_a_linear_form(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    struct point p1 = hang(&f, origin, f.l1, f.q1), p2 = hang(&f, p1, f.l2, f.q2);
    const ct_ex q[] = {f.q1, f.q2, f.u1, f.u2}, d[] = {f.u1, f.u2, f.a1, f.a2};
    ct_ex residual = ct_ex_mul(x, f.I1, f.a1);
    const struct point p[] = {p1, p2};
    const ct_ex m[] = {f.m1, f.m2};
    for (int k = 0; k < 2; k++) {
        ct_ex vx = ct_ex_diff_along(x, p[k].x, q, d, 2),
              vy = ct_ex_diff_along(x, p[k].y, q, d, 2);
        ct_ex ax = ct_ex_diff_along(x, vx, q, d, 4), ay = ct_ex_diff_along(x, vy, q, d, 4);
        ay = ct_ex_add(x, ay, f.g);
        ct_ex along = ct_ex_add(x, ct_ex_mul(x, ax, ct_ex_diff(x, p[k].x, f.q1)),
                                ct_ex_mul(x, ay, ct_ex_diff(x, p[k].y, f.q1)));
        residual = ct_ex_add(x, residual, ct_ex_mul(x, m[k], along));
    }
    check(&f, residual,
          "(l1^2*(m1 + m2) + I1)*q1'' + m2*l1*l2*cos(q1 - q2)*q2'' + "
          "l1*(m2*l2*sin(q1 - q2)*q2'^2 + g*(m1 + m2)*sin(q1))");
    finish(&f);
}

// So long for its limit that it is not expanded: the coefficients of accelerations come from
// derivatives.
static void long_equation_is_a_linear_form(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    ct_ex sum = ct_ex_add(x, ct_ex_add(x, f.m1, f.m2), ct_ex_add(x, f.l1, f.l2));
    ct_ex wave = ct_ex_add(x, trig(&f, CT_OP_COS, f.q1), trig(&f, CT_OP_SIN, f.q2));
    ct_ex twice = ct_ex_add(x, ct_ex_mul(x, wave, f.a1), ct_ex_mul(x, sum, f.a1));
    ct_ex a = ct_ex_add(x, twice, ct_ex_mul(x, f.u1, f.u2));
    ct_ex e = ct_ex_mul(x, ct_ex_add(x, sum, wave), a);
    const struct ct_collect_options few = {.limit = 10};
    ct_ex got = ct_ex_collect(x, e, &few);
    size_t accelerations = 0;
    const char *text = ct_ex_text(f.arena, x, got, NULL);
    for (const char *at = text; (at = strstr(at, "q1''")); at++)
        accelerations++;
    assert_int_equal(accelerations, 1);
    struct random r = {1};
    check_values(&f, &r, e, got);
    finish(&f);
}

// ---- identities and numbers ---------------------------------------------------------------------

static void identities_only_where_shorter(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    ct_ex c1 = trig(&f, CT_OP_COS, f.q1), s1 = trig(&f, CT_OP_SIN, f.q1);
    ct_ex c2 = trig(&f, CT_OP_COS, f.q2), s2 = trig(&f, CT_OP_SIN, f.q2);
    ct_ex cc = ct_ex_mul(x, c1, c1), ss = ct_ex_mul(x, s1, s1), one = CT_EX_ONE;
    check(&f, ct_ex_sub(x, one, cc), "sin(q1)^2");
    check(&f, ct_ex_add(x, f.m1, ct_ex_mul(x, f.m2, cc)), "m1 + m2*cos(q1)^2");
    check(&f, ct_ex_add(x, ct_ex_mul(x, f.m1, cc), ct_ex_mul(x, f.m2, ss)),
          "m1*cos(q1)^2 + m2*sin(q1)^2");
    check(&f, ct_ex_mul(x, c1, c2), "cos(q1)*cos(q2)");
    check(&f, ct_ex_sub(x, ct_ex_mul(x, c1, s2), ct_ex_mul(x, s1, c2)), "-sin(q1 - q2)");
    // a turn about two parallel axes, squared
    ct_ex turn = ct_ex_sub(x, ct_ex_mul(x, c1, c2), ct_ex_mul(x, s1, s2));
    check(&f, ct_ex_mul(x, f.m1, ct_ex_mul(x, turn, turn)), "m1*cos(q1 + q2)^2");
    // (s^2 + c^2)^2, multiplied out
    ct_ex whole = ct_ex_add(x, cc, ss);
    check(&f, ct_ex_mul(x, whole, whole), "1");
    // a rotation about two axes keeps lengths
    ct_ex rx = c1, ry = ct_ex_mul(x, s1, c2), rz = ct_ex_mul(x, s1, s2);
    check(&f,
          ct_ex_add(x, ct_ex_mul(x, rx, rx),
                    ct_ex_add(x, ct_ex_mul(x, ry, ry), ct_ex_mul(x, rz, rz))),
          "1");
    finish(&f);
}

static void rounding_leaves_no_residues(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    ct_ex a = ct_ex_scale(x, 0.1, f.q1), b = ct_ex_scale(x, 0.2, f.q1);
    ct_ex c = ct_ex_scale(x, 0.3, f.q1);
    check(&f, ct_ex_sub(x, ct_ex_add(x, f.q2, ct_ex_add(x, a, b)), c), "q2");
    check(&f, ct_ex_mul(x, ct_ex_scale(x, 0.5, f.q1), ct_ex_scale(x, 0.304, f.q2)),
          "0.152*q1*q2");
    check(&f, ct_ex_div(x, ct_ex_mul(x, f.m1, f.q1), ct_ex_const(x, 3)), "m1*q1/3");
    check(&f, ct_ex_add(x, a, ct_ex_scale(x, 0.2, ct_ex_add(x, f.q1, f.q2))),
          "0.3*q1 + 0.2*q2");
    ct_ex tiny = ct_ex_scale(x, 1e-17, f.q2);
    check(&f, ct_ex_add(x, f.q1, tiny), "q1 + 1e-17*q2"); // small is not noise
    finish(&f);
}

static void quotients_and_roots(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    ct_ex sum = ct_ex_add(x, ct_ex_mul(x, f.q1, f.q1), ct_ex_mul(x, f.q2, f.q2));
    ct_ex length = ct_ex_fun(x, CT_OP_SQRT, sum);
    check(&f, ct_ex_mul(x, f.m1, ct_ex_mul(x, length, length)), "m1*(q1^2 + q2^2)");
    ct_ex force = ct_ex_mul(x, f.m1, ct_ex_sub(x, length, f.l1));
    check(&f, ct_ex_div(x, ct_ex_mul(x, force, f.q1), length),
          "m1*q1*(1 - l1/sqrt(q1^2 + q2^2))");
    ct_ex xy = ct_ex_mul(x, f.q1, f.q2);
    check(&f, ct_ex_div(x, ct_ex_add(x, xy, ct_ex_mul(x, xy, f.m1)), f.q1), "(m1 + 1)*q2");
    finish(&f);
}

static void equal_sums_are_pulled_out(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    ct_ex arm = ct_ex_add(x, f.l1, ct_ex_mul(x, f.l2, trig(&f, CT_OP_COS, f.q1)));
    ct_ex both = mul3(x, f.l1, ct_ex_add(x, f.m1, f.m2), arm);
    ct_ex third = mul3(x, f.m3, f.l3, trig(&f, CT_OP_SIN, f.q2));
    check(&f, ct_ex_add(x, both, third), "m3*l3*sin(q2) + l1*(m1 + m2)*(l1 + l2*cos(q1))");
    finish(&f);
}

// ---- properties -------------------------------------------------------------------------------

// Sums and products of symbols, sines and cosines; everything stays of order one, so that the
// tolerance on the result can follow from the magnitudes of the nodes below.
static ct_ex random_mechanics(struct random *r, struct fixture *f, ct_ex *e, size_t n)
{
    const ct_ex sym[] = {f->m1, f->l1, f->l2, f->q1, f->q2, f->u1};
    const ct_ex angle[]
        = {f->q1, f->q2, ct_ex_add(&f->x, f->q1, f->q2), ct_ex_sub(&f->x, f->q3, f->q1)};
    for (size_t k = 0; k < n; k++) {
        const size_t kind = k < 2 ? random_below(r, 4) : random_below(r, 14);
        // of recent nodes: the last one has most of the others below it
        const size_t back = k < 5 ? k : 5;
        const ct_ex a = k ? e[k - 1 - random_below(r, back)] : f->m1;
        const ct_ex b = k ? e[k - 1 - random_below(r, back)] : f->l1;
        if (kind < 2)
            e[k] = sym[random_below(r, COUNT(sym))];
        else if (kind < 4)
            e[k] = ct_ex_fun(&f->x, random_below(r, 2) ? CT_OP_SIN : CT_OP_COS,
                             angle[random_below(r, COUNT(angle))]);
        else if (kind < 7) // degrees grow slowly
            e[k] = ct_ex_mul(&f->x, a, sym[random_below(r, COUNT(sym))]);
        else if (kind < 9)
            e[k] = ct_ex_mul(&f->x, a, e[random_below(r, k < 5 ? k : 5)]);
        else if (kind < 11)
            e[k] = ct_ex_sub(&f->x, a, b);
        else
            e[k] = ct_ex_add(&f->x, a, ct_ex_scale(&f->x, random_below(r, 2) ? 1 : 0.3, b));
    }
    return e[n - 1];
}

static void random_expressions_keep_their_values(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    for (int round = 0; round < 3000; round++) {
        struct fixture f;
        start(&f);
        ct_ex e[60] = {0}, from = random_mechanics(&r, &f, e, 4 + random_below(&r, 50));
        ct_ex got = ct_ex_collect(&f.x, from, NULL);
        check_values(&f, &r, from, got);
        assert_true(ct_ex_tree_size(&f.x, f.arena, got)
                    <= ct_ex_tree_size(&f.x, f.arena, from));
        finish(&f);
    }
}

// With a small limit everything is bundled sooner or later; the values stay.
static void bundled_sums_keep_their_values(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    for (int round = 0; round < 300; round++) {
        struct fixture f;
        start(&f);
        ct_ex e[200] = {0}, from = random_mechanics(&r, &f, e, 20 + random_below(&r, 100));
        const struct ct_collect_options few = {.limit = 1 + random_below(&r, 12)};
        check_values(&f, &r, from, ct_ex_collect(&f.x, from, &few));
        finish(&f);
    }
}

static void what_is_zero_becomes_zero(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    for (int round = 0; round < 300; round++) {
        struct fixture f;
        start(&f);
        struct ct_exs *x = &f.x;
        ct_ex e[20] = {0}, a = random_mechanics(&r, &f, e, 12), b = e[10], d = e[8];
        // (a + b) d - a d - b d, where the store itself sees nothing to cancel
        ct_ex zero = ct_ex_sub(x, ct_ex_mul(x, ct_ex_add(x, a, b), d),
                               ct_ex_add(x, ct_ex_mul(x, a, d), ct_ex_mul(x, b, d)));
        assert_string_equal(ct_ex_text(f.arena, x, ct_ex_collect(x, zero, NULL), NULL), "0");
        finish(&f);
    }
}

static void collecting_twice_rarely_changes_anything(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    size_t changed = 0;
    for (int round = 0; round < 300; round++) {
        struct fixture f;
        start(&f);
        ct_ex e[60] = {0}, from = random_mechanics(&r, &f, e, 4 + random_below(&r, 16));
        ct_ex once = ct_ex_collect(&f.x, from, NULL), twice = ct_ex_collect(&f.x, once, NULL);
        const char *s = ct_ex_text(f.arena, &f.x, once, NULL);
        changed += strcmp(s, ct_ex_text(f.arena, &f.x, twice, NULL)) != 0;
        finish(&f);
    }
    // the second time other sums are below the operators that were kept
    print_message("%zu of 300 changed again\n", changed);
    assert_true(changed < 15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(simple_pendulum_has_inertia_m_l_squared),
        cmocka_unit_test(double_pendulum_with_absolute_angles),
        cmocka_unit_test(double_pendulum_with_relative_angles),
        cmocka_unit_test(relative_angles_by_products_of_rotations),
        cmocka_unit_test(triple_chain_by_products_of_rotations),
        cmocka_unit_test(equation_of_motion_is_a_linear_form),
        cmocka_unit_test(long_equation_is_a_linear_form),
        cmocka_unit_test(identities_only_where_shorter),
        cmocka_unit_test(rounding_leaves_no_residues),
        cmocka_unit_test(quotients_and_roots),
        cmocka_unit_test(equal_sums_are_pulled_out),
        cmocka_unit_test(random_expressions_keep_their_values),
        cmocka_unit_test(bundled_sums_keep_their_values),
        cmocka_unit_test(what_is_zero_becomes_zero),
        cmocka_unit_test(collecting_twice_rarely_changes_anything),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
