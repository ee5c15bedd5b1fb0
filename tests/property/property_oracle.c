// The solver of the property tests itself: against accelerations by hand, against its own motion,
// and moved as a whole.
#include "tests/property/oracle/generate.h"
#include "tests/property/oracle/oracle.h"
#include "tests/check.h"

#include <stdlib.h>
#include <string.h>

static const double g = 9.81;

// ---- by hand ------------------------------------------------------------------------------------

// Ground with gravity along -y and bodies of mass 2, inertia (0.1, 0.2, 0.3), centre of mass at
// com, in ground's axes at the origin.
static struct scene start(int bodies, struct vector com)
{
    struct scene s = {.nbody = 1 + bodies, .digits = 17, .gravity = {{0, -g, 0}}};
    for (int i = 0; i <= bodies; i++) {
        s.body[i].pose.R = same_axes();
        s.body[i].mass = 2;
        s.body[i].com = com;
        s.body[i].inertia[0] = 0.1;
        s.body[i].inertia[1] = 0.2;
        s.body[i].inertia[2] = 0.3;
    }
    return s;
}

static struct joint *join(struct scene *s, enum joint_type type, int from, int to,
                          struct vector axis)
{
    struct joint *j = &s->joint[s->njoint++];
    *j = (struct joint){.type = type, .from = from, .to = to, .axis = axis};
    if (joint_has_quaternion(type))
        j->q[joint_coordinates(type) - 4] = 1;
    return j;
}

static struct motion solve(const struct scene *s, const struct motion *m, int freedoms)
{
    struct oracle o;
    struct motion a;
    double condition;
    oracle_open(&o, s, m);
    assert_int_equal(o.freedoms, freedoms);
    CHECK_CLOSE(o.position + o.velocity, 0, 0, 1e-14);
    assert_true(oracle_accelerations(&o, m, &a, &condition));
    oracle_close(&o);
    return a;
}

static const struct vector x = {{1, 0, 0}}, y = {{0, 1, 0}}, z = {{0, 0, 1}};

// alpha = -m g c / (I + m c^2), whether it hangs on one hinge, on two, or on two and a ball
static void pendulum(void **state)
{
    (void)state;
    struct scene s = start(1, scaled(0.5, x));
    for (int n = 1; n <= 3; n++) {
        join(&s, n < 3 ? REVOLUTE : SPHERICAL, 0, 1, z);
        const struct motion m = motion_of_scene(&s), a = solve(&s, &m, 1);
        CHECK_CLOSE(a.u[0][0], -2 * g * 0.5 / (0.3 + 2 * 0.25), 1e-13, 0);
        CHECK_CLOSE(a.w[1].e[2], a.u[0][0], 1e-13, 0);
    }
}

// (m + I (2 pi/p)^2) y'' = -m g along a screw's axis, with a cylinder on the same axis or without
static void screw_falls(void **state)
{
    (void)state;
    const double two_pi = 6.283185307179586476925286766559, pitch = 0.4;
    struct scene s = start(1, (struct vector){{0, 0, 0}});
    join(&s, SCREW, 0, 1, y)->pitch = pitch;
    for (int n = 1; n <= 2; n++) {
        const struct motion m = motion_of_scene(&s), a = solve(&s, &m, 1);
        CHECK_CLOSE(a.v[1].e[1], -2 * g / (2 + 0.2 * pow(two_pi / pitch, 2)), 1e-13, 0);
        join(&s, CYLINDRICAL, 0, 1, y);
    }
}

// On a bar that turns with w about z a slider at r flies out with r w^2; the bar, free to turn,
// slows with alpha = -2 m r' w r / (I_bar + I + m r^2).
static void slider_on_a_turning_bar(void **state)
{
    (void)state;
    const double w = 3, r = 0.7, rate = 0.5;
    struct scene s = start(2, (struct vector){{0, 0, 0}});
    s.gravity = (struct vector){{0, 0, 0}};
    s.body[2].pose.at = scaled(r, x);
    join(&s, REVOLUTE, 0, 1, z);
    join(&s, PRISMATIC, 1, 2, x)->q[0] = r;
    struct motion m = motion_of_scene(&s);
    m.w[1] = m.w[2] = scaled(w, z);
    m.v[2] = (struct vector){{rate, r * w, 0}};
    m.u[0][0] = w;
    m.u[1][0] = rate;
    const struct motion a = solve(&s, &m, 2);
    CHECK_CLOSE(a.u[1][0], r * w * w, 1e-13, 0);
    CHECK_CLOSE(a.u[0][0], -2 * 2 * rate * w * r / (0.3 + 0.3 + 2 * r * r), 1e-13, 0);
}

// Euler's equations of a body on a ball: I1 w1' = (I2 - I3) w2 w3
static void body_on_a_ball(void **state)
{
    (void)state;
    struct scene s = start(1, (struct vector){{0, 0, 0}});
    join(&s, SPHERICAL, 0, 1, z);
    struct motion m = motion_of_scene(&s);
    const double w[3] = {1, 2, 3};
    for (int i = 0; i < 3; i++)
        m.w[1].e[i] = m.u[0][i] = w[i];
    const struct motion a = solve(&s, &m, 3);
    CHECK_CLOSE(a.u[0][0], (0.2 - 0.3) * 6 / 0.1, 1e-13, 0);
    CHECK_CLOSE(a.u[0][1], (0.3 - 0.1) * 3 / 0.2, 1e-13, 0);
    CHECK_CLOSE(a.u[0][2], (0.1 - 0.2) * 2 / 0.3, 1e-13, 0);
}

// A body on a rod of length l along x, hung at its centre of mass: x'' = -v^2/l, y'' = -g
static void body_on_a_rod(void **state)
{
    (void)state;
    struct scene s = start(1, (struct vector){{0, 0, 0}});
    s.body[1].pose.at = scaled(0.8, x);
    join(&s, DISTANCE, 0, 1, z)->length = 0.8;
    struct motion m = motion_of_scene(&s);
    m.v[1] = scaled(2, y);
    const struct motion a = solve(&s, &m, 5);
    CHECK_CLOSE(a.v[1].e[0], -4 / 0.8, 1e-13, 0);
    CHECK_CLOSE(a.v[1].e[1], -g, 1e-13, 0);
}

// ---- against its own motion ---------------------------------------------------------------------

enum { RANDOM = 60 };

// Mechanisms of every kind at their start, with the speeds that the generator gave their joints.
static void random_state(int i, struct scene *s, struct motion *m)
{
    int freedoms;
    struct oracle o;
    scene_generate(s, (enum kind)(i % KINDS), (uint64_t)(1000 + i), 17, &freedoms);
    *m = motion_of_scene(s);
    oracle_open(&o, s, m);
    for (int k = 0; k < o.freedoms; k++) {
        struct motion along;
        oracle_freedom(&o, k, &along);
        const double f = cos(2.0 * k + i);
        for (int b = 0; b < s->nbody; b++) {
            m->v[b] = plus(m->v[b], f, along.v[b]);
            m->w[b] = plus(m->w[b], f, along.w[b]);
        }
        for (int j = 0; j < s->njoint; j++)
            for (int c = 0; c < joint_speeds(s->joint[j].type); c++)
                m->u[j][c] += f * along.u[j][c];
    }
    oracle_close(&o);
}

static struct motion accelerate(const struct scene *s, const struct motion *m)
{
    struct oracle o;
    struct motion a;
    double condition;
    oracle_open(&o, s, m);
    assert_true(oracle_accelerations(&o, m, &a, &condition));
    oracle_close(&o);
    return a;
}

// h along the speeds and back onto the joints; speeds grow by h times the accelerations.
static struct motion step(const struct scene *s, const struct motion *m, const struct motion *a,
                          double h)
{
    struct motion next = *m, mean = *m;
    for (int b = 0; b < s->nbody; b++) {
        mean.v[b] = plus(m->v[b], h / 2, a->v[b]);
        mean.w[b] = plus(m->w[b], h / 2, a->w[b]);
        next.v[b] = plus(m->v[b], h, a->v[b]);
        next.w[b] = plus(m->w[b], h, a->w[b]);
    }
    for (int j = 0; j < s->njoint; j++)
        for (int c = 0; c < 6; c++) {
            mean.u[j][c] += h / 2 * a->u[j][c];
            next.u[j][c] += h * a->u[j][c];
        }
    assert_true(oracle_move(s, &next, &mean, h));
    return next;
}

// With the right accelerations the joints' speeds fit after a step but for its square: a wrong term
// would leave its first power.
static void accelerations_keep_to_the_joints(void **state)
{
    (void)state;
    for (int i = 0; i < RANDOM; i++) {
        struct scene s;
        struct motion m;
        double left[2];
        random_state(i, &s, &m);
        const struct motion a = accelerate(&s, &m);
        for (int k = 0; k < 2; k++) {
            struct oracle o;
            const struct motion next = step(&s, &m, &a, k ? 5e-5 : 1e-4);
            oracle_open(&o, &s, &next);
            left[k] = o.velocity;
            oracle_close(&o);
        }
        if (!(left[1] < 0.3 * left[0] + 1e-12)) // a quarter
            print_error("%s: %g, then %g with half the step\n", s.name, left[0], left[1]);
        assert_true(left[1] < 0.3 * left[0] + 1e-12);
    }
}

static struct vector inertia_times(const struct body *b, struct axes R, struct vector w)
{
    const double *J = b->inertia;
    const struct vector p = turned_back(R, w);
    return turned(R, (struct vector){{J[0] * p.e[0] + J[3] * p.e[1] + J[4] * p.e[2],
                                      J[3] * p.e[0] + J[1] * p.e[1] + J[5] * p.e[2],
                                      J[4] * p.e[0] + J[5] * p.e[1] + J[2] * p.e[2]}});
}

// Kinetic energy, that of weights and of joint springs less the work of constant efforts.
static double energy(const struct scene *s, const struct motion *m)
{
    double e = 0;
    for (int b = 1; b < s->nbody; b++) {
        const struct body *p = &s->body[b];
        const struct vector c = turned(m->body[b].R, p->com);
        const struct vector v = plus(m->v[b], 1, cross(m->w[b], c));
        e += p->mass * (dot(v, v) / 2 - dot(s->gravity, plus(m->body[b].at, 1, c)));
        e += dot(m->w[b], inertia_times(p, m->body[b].R, m->w[b])) / 2;
    }
    for (int j = 0; j < s->njoint; j++) {
        const struct joint *p = &s->joint[j];
        const double stretch = m->q[j][0] - p->rest;
        if (joint_speeds(p->type) == 1)
            e += p->stiffness * stretch * stretch / 2 - p->effort * m->q[j][0];
    }
    return e;
}

static double damping_power(const struct scene *s, const struct motion *m)
{
    double power = 0;
    for (int j = 0; j < s->njoint; j++)
        if (joint_speeds(s->joint[j].type) == 1)
            power -= s->joint[j].damping * m->u[j][0] * m->u[j][0];
    return power;
}

// d/dt of the energy is what dampers take: central difference over steps along the motion.
static void energy_goes_into_dampers_only(void **state)
{
    (void)state;
    const double h = 1e-5;
    for (int i = 0; i < RANDOM; i++) {
        struct scene s;
        struct motion m;
        random_state(i, &s, &m);
        const struct motion a = accelerate(&s, &m), after = step(&s, &m, &a, h),
                            before = step(&s, &m, &a, -h);
        const double rate = (energy(&s, &after) - energy(&s, &before)) / (2 * h);
        double scale = fabs(energy(&s, &m)) + fabs(damping_power(&s, &m));
        for (int b = 1; b < s.nbody; b++)
            scale += s.body[b].mass * (norm(a.v[b]) + g) * norm(m.v[b]);
        // round-off of the energy over h, and h^2 times its third derivative
        if (!(fabs(rate - damping_power(&s, &m)) < 1e-7 * scale))
            print_error("%s: %.12g, dampers %.12g\n", s.name, rate, damping_power(&s, &m));
        assert_true(fabs(rate - damping_power(&s, &m)) < 1e-7 * scale);
    }
}

// ---- moved as a whole ---------------------------------------------------------------------------

// Ground's points move along with everything else; joint accelerations are scalars.
static void place_does_not_matter(void **state)
{
    (void)state;
    const struct pose move = {{{3, -1, 2}}, rotation(unit((struct vector){{1, -2, 0.5}}), 2.2)};
    for (int i = 0; i < RANDOM; i++) {
        struct scene s[2];
        struct motion m[2], a[2];
        random_state(i, &s[0], &m[0]);
        s[1] = s[0];
        m[1] = m[0];
        s[1].gravity = turned(move.R, s[0].gravity);
        for (int b = 1; b < s[0].nbody; b++) {
            m[1].body[b] = composed(move, m[0].body[b]);
            m[1].v[b] = turned(move.R, m[0].v[b]);
            m[1].w[b] = turned(move.R, m[0].w[b]);
        }
        for (int j = 0; j < s[0].njoint; j++)
            for (int k = 0; k < 2; k++) {
                const struct joint *from = &s[0].joint[j];
                struct frame *end = &s[1].joint[j].end[k];
                if (from->type == GEAR || (k ? from->to : from->from) != 0)
                    continue;
                const struct pose at
                    = composed(move, (struct pose){end->at, axes_of(&from->end[k])});
                end->at = at.at;
                to_angles(at.R, end->angle);
            }
        for (int k = 0; k < 2; k++)
            a[k] = accelerate(&s[k], &m[k]);
        double scale = g, worst = 0;
        for (int j = 0; j < s[0].njoint; j++)
            for (int c = 0; c < joint_speeds(s[0].joint[j].type); c++) {
                scale = fmax(scale, fabs(a[0].u[j][c]));
                worst = fmax(worst, fabs(a[0].u[j][c] - a[1].u[j][c]));
            }
        if (!(worst < 1e-9 * scale))
            print_error("%s: %g of %g\n", s[0].name, worst, scale);
        assert_true(worst < 1e-9 * scale);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pendulum),
        cmocka_unit_test(screw_falls),
        cmocka_unit_test(slider_on_a_turning_bar),
        cmocka_unit_test(body_on_a_ball),
        cmocka_unit_test(body_on_a_rod),
        cmocka_unit_test(accelerations_keep_to_the_joints),
        cmocka_unit_test(energy_goes_into_dampers_only),
        cmocka_unit_test(place_does_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
