// Beams in motion: what runs must keep, and what must not change them.
#include "tests/property/system.h"

// ---- runs ---------------------------------------------------------------------------------------

struct ends {
    double *first, *last, *least, *most;
    size_t rows;
};

static bool at_row(void *user, double t, const double *value, size_t n)
{
    struct ends *e = user;
    (void)t;
    for (size_t k = 0; k < n; k++) {
        e->last[k] = value[k];
        if (!e->rows)
            e->first[k] = e->least[k] = e->most[k] = value[k];
        e->least[k] = fmin(e->least[k], value[k]);
        e->most[k] = fmax(e->most[k], value[k]);
    }
    e->rows++;
    return true;
}

// Results of a run: at its ends and their range over 51 samples.
static struct ends run(struct system *s, struct variant *v, double duration, double rtol)
{
    const size_t n = v->e.nresult;
    struct ends e = {.first = CT_NEWN(v->arena, double, n),
                     .last = CT_NEWN(v->arena, double, n),
                     .least = CT_NEWN(v->arena, double, n),
                     .most = CT_NEWN(v->arena, double, n)};
    struct ct_run_report report;
    const struct ct_run_options o = {.method = ct_method_find("dop853"),
                                     .duration = duration,
                                     .rtol = rtol,
                                     .atol = rtol / 100,
                                     .nsample = 51,
                                     .row = at_row,
                                     .user = &e};
    struct ct_run *r = ct_run_create(&v->ctx, v->arena, &s->model, &v->e, &s->start);
    if (!r || !ct_run_simulate(r, &o, &report)) {
        print_error("%s: no run\n", s->name);
        ct_ctx_print(&v->ctx, stderr);
        fail();
    }
    return e;
}

// The run keeps a result to tol of scale at all samples.
static bool is_kept(struct system *s, const struct variant *v, const struct ends *e,
                    const char *name, double scale, double tol)
{
    const size_t k = variant_result(v, name);
    return agree(s->name, name, e->most[k], e->first[k], scale, tol)
         & agree(s->name, name, e->least[k], e->first[k], scale, tol);
}

static double range(const struct variant *v, const struct ends *e, const char *name)
{
    const size_t k = variant_result(v, name);
    return e->most[k] - e->least[k];
}

// A beam that hardly bends would prove little.
static bool does_bend(struct system *s, const struct variant *v, const struct ends *e)
{
    const double strain = range(v, e, "energy.strain"),
                 kinetic = e->most[variant_result(v, "energy.kinetic")];
    if (strain > 3e-4 * kinetic) // a bend of centimetres
        return true;
    print_error("%s: the strain energy reaches %g of %g J\n", s->name, strain, kinetic);
    return false;
}

// ---- what is kept -------------------------------------------------------------------------------

// Keys that change the equations of a beam that has the section of `falling` or `floating`.
static const char *const kinds[] = {
    "formulation: linear",
    "formulation: foreshortening",
    "formulation: foreshortening\n    frame: chord",
    "formulation: foreshortening\n    rotary_inertia: true\n    elements: [0.3, 0.8]",
    "formulation: linear\n    mass: lumped\n    rotary_inertia: [1e-4, 1e-4, 1e-4]\n    "
    "elements: 3",
    "formulation: foreshortening\n    theory: timoshenko\n    shear_factor: [5/6, 0.3]\n    "
    "integration: reduced\n    elements: 3\n    rotary_inertia: true",
    "formulation: linear\n    frame: chord\n    elements: 2",
    "formulation: foreshortening\n    elements: 2\n    "
    "initial: {v: 0.1*x^2, rates: {v: 0.3*x^2, u: 0.01*x}}",
    "formulation: foreshortening\n    elements: 2\n    "
    "shapes: {v: [x^2, x^3], w: [x^2, x^3], u: x, rx: [x, x^2]}",
    "formulation: foreshortening\n    frame: chord\n    twist: quadratic\n    stretch: "
    "quadratic\n    rotary_inertia: "
    "true\n    "
    "elements: 2",
};

// A soft pendulum that bends by a tenth of its length; a body at its tip.
static const char falling[]
    = "cotree: 1\n"
      "gravity: [0, -9.81, 0]\n"
      "bodies:\n"
      "  rod:\n"
      "    type: beam\n"
      "    length: 0.8\n"
      "    E: 1e8\n"
      "    G: 4e7\n"
      "    area: 1e-4*(1.5 - x)\n"
      "    Iy: 2e-8\n"
      "    Iz: 2e-8*(1 - x/2)\n"
      "    density: 3000\n"
      "    %s\n"
      "    points: {tip: length}\n"
      "  bob: {mass: 0.1, inertia: 1e-3, com: [0.02, 0.01, 0]}\n"
      "joints:\n"
      "  pin: {type: %s, from: ground, to: rod, initial: {q: 0.3, u: 1}}\n"
      "  tip: {type: weld, from: rod.tip, to: bob}\n"
      "outputs: [energy.total, energy.kinetic, energy.strain]\n";

static void energy_of_a_falling_pendulum_is_kept(void **state)
{
    (void)state;
    bool ok = true;
    for (size_t i = 0; i < COUNT(kinds); i++)
        for (int spatial = 0; spatial < 2; spatial++) {
            struct system s;
            struct variant v;
            struct ct_arena *a = ct_arena_create();
            const char *pin = spatial ? "universal, axes: [z, y]" : "revolute, axis: z";
            char *text = text_of(a, falling, kinds[i], pin);
            if (spatial) {
                char *q = strstr(text, "q: 0.3, u: 1");
                text = text_of(a, "%.*sq: [0.3, 0.2], u: [1, 3]%s", (int)(q - text), text,
                               q + strlen("q: 0.3, u: 1"));
            }
            system_open_text(&s, kinds[i], text);
            variant_open(&s, &by_joints, &v);
            const struct ends e = run(&s, &v, spatial ? 0.2 : 0.4, 1e-10);
            const double scale = range(&v, &e, "energy.kinetic");
            ok &= is_kept(&s, &v, &e, "energy.total", scale, 1e-9);
            ok &= does_bend(&s, &v, &e);
            variant_close(&v);
            system_close(&s);
            ct_arena_destroy(a);
        }
    assert_true(ok);
}

// Nothing acts on it: momenta and energy stay. It starts straight, turning about all axes.
static const char floating[]
    = "cotree: 1\n"
      "bodies:\n"
      "  rod:\n"
      "    type: beam\n"
      "    length: 0.8\n"
      "    E: 1e8\n"
      "    G: 4e7\n"
      "    area: 1e-4*(1.5 - x)\n"
      "    Iy: 2e-8\n"
      "    Iz: 2e-8*(1 - x/2)\n"
      "    density: 3000\n"
      "    %s\n"
      "    points: {arm: [length/2, 0.1, 0]}\n"
      "  bob: {mass: 0.05, inertia: 1e-3}\n"
      "joints:\n"
      "  place: {type: free, from: ground, to: rod, initial: {q: [1, 2, 3], rotate: [x, 0.4], "
      "u: [1, -1, 0.5, 6, 8, 16]}}\n"
      "  arm: {type: weld, from: rod.arm, to: bob}\n"
      "outputs: [system.momentum, system.angular_momentum, energy.total, energy.kinetic, "
      "energy.strain]\n";

static void momenta_of_a_free_beam_are_kept(void **state)
{
    (void)state;
    bool ok = true;
    for (size_t i = 0; i < COUNT(kinds); i++) {
        struct system s;
        struct variant v;
        struct ct_arena *a = ct_arena_create();
        system_open_text(&s, kinds[i], text_of(a, floating, kinds[i]));
        variant_open(&s, &by_choice, &v);
        const struct ends e = run(&s, &v, 0.2, 1e-10);
        for (int k = 0; k < 3; k++) {
            const char c = "xyz"[k];
            ok &= is_kept(&s, &v, &e, text_of(a, "system.momentum.%c", c), 1, 1e-9);
            ok &= is_kept(&s, &v, &e, text_of(a, "system.angular_momentum.%c", c), 1, 1e-9);
        }
        ok &= is_kept(&s, &v, &e, "energy.total", e.first[variant_result(&v, "energy.kinetic")],
                      1e-9);
        ok &= does_bend(&s, &v, &e);
        variant_close(&v);
        system_close(&s);
        ct_arena_destroy(a);
    }
    assert_true(ok);
}

// ---- what must not change a motion --------------------------------------------------------------

// Crank and rod bend; %s: keys of both.
static const char slider_crank[]
    = "cotree: 1\n"
      "bodies:\n"
      "  crank:\n"
      "    {type: beam, length: 0.152, density: 2770, E: 1e9, nu: 0.3, area: 7.854e-5, Iy: "
      "4.909e-10, Iz: 4.909e-10, %s, points: {pin: length}}\n"
      "  rod:\n"
      "    {type: beam, length: 0.304, density: 2770, E: 5e7, nu: 0.3, area: 7.854e-5, Iy: "
      "4.909e-10, Iz: 4.909e-10, %s, elements: 2, points: {mid: length/2, pin: length}}\n"
      "  slider: {mass: 0.01, inertia: 1e-5}\n"
      "joints:\n"
      "  main: {type: revolute, from: ground, to: crank, effort: 0.02, initial: {q: 0.4, u: "
      "2}}\n"
      "  big_end: {type: revolute, from: crank.pin, to: rod, initial: {q: -0.6, guess: true}}\n"
      "  small_end: {type: revolute, from: rod.pin, to: slider, initial: {q: 0.2, guess: "
      "true}}\n"
      "  guide: {type: prismatic, from: ground, to: slider, axis: x, initial: {q: 0.4, guess: "
      "true}}\n"
      "outputs: [main.q, main.u, guide.q, guide.u, rod.mid.position, rod.pin.velocity, "
      "rod.mid.chord_deflection.y, guide.force.y, big_end.force, energy.total]\n";

static bool ends_agree(struct system *s, const struct variant *v, const struct ends *a,
                       const struct ends *b, const char *how, double tol)
{
    bool ok = true;
    for (size_t k = 0; k < v->e.nresult; k++) {
        const double scale
            = fmax(1e-3, fmax(fabs(a->most[k]), fabs(a->least[k]))); // deflections: 1e-3 m
        ok &= agree(s->name, text_of(v->arena, "%s, %s", v->e.result[k].name, how), b->last[k],
                    a->last[k], scale, tol);
    }
    return ok;
}

// Other trees: other coordinates, other rows, the same mechanism. In space: out-of-plane bending
// and twist, too.
static void trees_and_space_do_not_change_a_slider_crank(void **state)
{
    (void)state;
    static const struct {
        const struct ct_formulate_options *o;
        const char *how;
    } ways[] = {{&by_joints, "joints"},
                {&by_bodies, "bodies"},
                {&by_choice, "choice"},
                {&by_joints_spatial, "in space"}};
    static const char *const keys[] = {"formulation: linear", "formulation: foreshortening",
                                       "formulation: foreshortening, frame: chord"};
    bool ok = true;
    for (size_t i = 0; i < COUNT(keys); i++) {
        struct system s[COUNT(ways)];
        struct variant v[COUNT(ways)];
        struct ends e[COUNT(ways)];
        struct ct_arena *a = ct_arena_create();
        const char *text = text_of(a, slider_crank, keys[i], keys[i]);
        for (size_t k = 0; k < COUNT(ways); k++) {
            system_open_text(&s[k], keys[i], text);
            if (ways[k].o->keep_all)
                system_keep_all(&s[k]);
            variant_open(&s[k], ways[k].o, &v[k]);
            e[k] = run(&s[k], &v[k], 0.03, 1e-10);
            if (k)
                ok &= ends_agree(&s[k], &v[k], &e[0], &e[k], ways[k].how, 1e-8);
        }
        for (size_t k = 0; k < COUNT(ways); k++) {
            variant_close(&v[k]);
            system_close(&s[k]);
        }
        ct_arena_destroy(a);
    }
    assert_true(ok);
}

// ---- a beam and links with springs --------------------------------------------------------------

// n links with springs EI/h beside a beam, both swung by the same torque, which is smooth: high
// modes, in which a chain and a beam differ, stay at rest.
static const char *chain_text(struct ct_arena *a, int n)
{
    static const char top[]
        = "cotree: 1\n"
          "parameters: {mu: 0.27, EI: 20, n: %d, h: 1/n}\n"
          "bodies:\n"
          "  beam: {type: beam, length: 1, elements: 4, mass_per_length: mu, E: EI, Iz: 1, "
          "formulation: foreshortening, deformation: [bending-z], points: {tip: length}}\n";
    static const char effort[] = "effort: 2*sin(pi*t/0.2)^2, initial: {q: 0, u: 0}}\n";
    char *text = text_of(a, top, n);
    for (int i = 1; i <= n; i++)
        text = text_of(a,
                       "%s  l%d: {mass: mu*h, inertia: mu*h^3/12, com: [h/2, 0, 0], points: "
                       "{end: [h, 0, 0]}}\n",
                       text, i);
    text = text_of(a,
                   "%sjoints:\n  pin: {type: revolute, from: ground, to: beam, %s  h1: {type: "
                   "revolute, from: ground, to: l1, %s",
                   text, effort, effort);
    for (int i = 2; i <= n; i++)
        text = text_of(a,
                       "%s  h%d: {type: revolute, from: l%d.end, to: l%d, stiffness: EI/h, "
                       "initial: {q: 0, u: 0}}\n",
                       text, i, i - 1, i);
    return text_of(a,
                   "%soutputs: [beam.tip.position.x, beam.tip.position.y, l%d.end.position.x, "
                   "l%d.end.position.y, beam.tip.deflection.y]\n",
                   text, n, n);
}

// Distance of the tips after a while.
static double chain_distance(int n, double *bend)
{
    struct system s;
    struct variant v;
    struct ct_arena *a = ct_arena_create();
    system_open_text(&s, "chain", chain_text(a, n));
    variant_open(&s, &by_joints, &v);
    const struct ends e = run(&s, &v, 0.15, 1e-9);
    const double d = hypot(e.last[0] - e.last[2], e.last[1] - e.last[3]);
    *bend = e.most[4] - e.least[4];
    variant_close(&v);
    system_close(&s);
    ct_arena_destroy(a);
    return d;
}

static void links_with_springs_tend_to_the_beam(void **state)
{
    (void)state;
    double bend, d[3];
    for (int i = 0; i < 3; i++)
        d[i] = chain_distance(4 << i, &bend);
    print_message(
        "distance of the tips with 4, 8, 16 links: %.3g %.3g %.3g m, bent by %.3g m\n", d[0],
        d[1], d[2], bend);
    assert_true(bend > 5e-3);
    assert_true(d[1] < d[0] / 3 && d[2] < d[1] / 3); // links are of second order
    assert_true(d[2] < 1e-3 * bend);
}

// ---- ways to take the integrals -----------------------------------------------------------------

// A beam with something to carry. %s: more keys; the mass per length, Iz.
static const char carrying[]
    = "cotree: 1\n"
      "gravity: [0.3, -1, %s]\n"
      "bodies:\n"
      "  rod: {type: beam, length: 1.3, elements: 3, E: 3e4, G: 1e4, area: 1e-2, Iy: 2e-4, J: "
      "3e-4,\n"
      "    %s, mass_per_length: %s, Iz: %s,\n"
      "    points: {mid: 0.4*length, tip: {at: length, rotate: [z, 0.3]}}}\n"
      "  knob: {mass: 0.4, inertia: [0.01, 0.02, 0.015], com: [0.05, 0, %s]}\n"
      "joints:\n"
      "  base: {type: %s, from: ground, to: rod}\n"
      "  end: {type: weld, from: rod.tip, to: knob}\n";

static const struct {
    const char *keys;
    bool is_spatial,
        is_stiffness_same; // the shapes of modes are numbers found from the stiffness
} carriers[] = {
    {"formulation: foreshortening", true},
    {"formulation: foreshortening", false},
    {"formulation: foreshortening, frame: chord", true},
    {"formulation: foreshortening, damping: {beta: 0.01}", true},
    {"formulation: foreshortening, damping: {alpha: 0.1, beta: 0.01}", true},
    {"formulation: foreshortening, rotary_inertia: true", false},
    {"formulation: foreshortening, theory: timoshenko, shear_factor: 0.8, rotary_inertia: true",
     false},
    {"formulation: foreshortening, deformation: [bending-y, bending-z]", true},
    {"formulation: foreshortening, deformation: [bending-z, torsion, bending-y]", true},
    {"formulation: foreshortening, modes: 3", true, true},
    {"formulation: foreshortening, stretch: quadratic, damping: {alpha: 0.1, beta: 0.01}",
     true},
    {"formulation: stretch-linear", false},
};

static void open_carrier(struct system *s, struct variant *v, size_t i, const char *mass,
                         const char *Iz)
{
    static const char *const result[] = {"energy.kinetic", "energy.strain", "energy.potential",
                                         "base.force.x",   "base.force.y",  "base.torque.z"};
    struct ct_arena *a = ct_arena_create();
    const bool is_spatial = carriers[i].is_spatial;
    system_open_text(s, carriers[i].keys,
                     text_of(a, carrying, is_spatial ? "-9.81" : "0", carriers[i].keys, mass,
                             Iz, is_spatial ? "0.02" : "0",
                             is_spatial ? "spherical" : "revolute"));
    for (size_t k = 0; k < COUNT(result); k++)
        system_output(s, result[k]);
    variant_open(s, &by_joints, v);
    ct_arena_destroy(a);
}

static bool forms_agree(size_t i, double tol)
{
    struct system s[2];
    struct variant v[2];
    bool ok = true;
    open_carrier(&s[0], &v[0], i, "0.7", "1e-4");
    open_carrier(&s[1], &v[1], i, "0.7*(1 + 1e-30*x)",
                 carriers[i].is_stiffness_same ? "1e-4" : "1e-4*(1 + 1e-30*x)");
    const size_t nu = v[0].e.nu, ny = v[0].e.nq + nu;
    assert_int_equal(nu, v[1].e.nu);
    for (size_t k = 0; k < ny; k++)
        v[0].y[k] += 0.05 * chance();
    double *acceleration = CT_NEWN(v[0].arena, double, nu);
    for (size_t k = 0; k < nu; k++)
        acceleration[k] = chance();
    for (int k = 0; k < 2; k++) {
        struct ct_evaluator *m = v[k].m;
        ct_evaluator_set(m, 0, v[0].y);
        ct_evaluator_dynamics(m);
        memcpy(m->input + m->at_a, acceleration, nu * sizeof(double));
        ct_program_run(&m->result, m->input);
    }
    const struct ct_evaluator *m = v[0].m, *w = v[1].m;
    const double *M = ct_partition_mass(v[0].s), *other = ct_partition_mass(v[1].s);
    double force = 1e-3;
    for (size_t k = 0; k < nu; k++)
        force = fmax(force, fabs(m->Q[k]));
    for (size_t k = 0; k < nu; k++) {
        ok &= agree(s[0].name, v[0].e.u[k].name, m->Q[k], w->Q[k], force, tol);
        for (size_t l = 0; l <= k; l++)
            ok &= agree(s[0].name, "M", M[k + nu * l], other[k + nu * l],
                        sqrt(M[k + nu * k] * M[l + nu * l]), tol);
    }
    for (size_t k = 0; k < v[0].e.nresult; k++)
        ok &= agree(s[0].name, v[0].e.result[k].name, m->result.out[k], w->result.out[k],
                    fmax(force, fabs(m->result.out[k])), tol);
    for (int k = 0; k < 2; k++) {
        variant_close(&v[k]);
        system_close(&s[k]);
    }
    return ok;
}

// Constant sections are integrated by amplitudes, sections that vary over points; those of the
// second beam vary by less than numbers can tell.
static void integrals_agree_with_sums_over_points(void **state)
{
    (void)state;
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < COUNT(carriers); i++)
        ok &= forms_agree(i, 1e-13);
    assert_true(ok);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(integrals_agree_with_sums_over_points),
        cmocka_unit_test(energy_of_a_falling_pendulum_is_kept),
        cmocka_unit_test(momenta_of_a_free_beam_are_kept),
        cmocka_unit_test(trees_and_space_do_not_change_a_slider_crank),
        cmocka_unit_test(links_with_springs_tend_to_the_beam),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
