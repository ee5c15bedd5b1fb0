/* element_forces: generated equations of the beam of element.sh against printed vectors
 *
 *     linear|foreshortening       which of the two models; linked with the code `cotree equations --format c` writes, of
 *                                 loaded.yaml (with gravity) and light.yaml (without)
 *
 * The beam has two elements; q = (R, w, q_f), accelerations (R'' in ground axes, w' in body axes, q_f''), q_f = u v w ry rz of
 * both nodes, u the stretch of the axis. Q_v stands on the left: M a + Q_v = F_g - K q_f. The printed vectors are of a derivation
 * of Liang's formulas (2017, 3.2 and 3.3) in many-digit arithmetic that only differentiates positions in time.
 *
 * A foreshortened beam has the places U = u - S of its nodes for coordinates instead of u, with S = 1/2 int v'^2 + w'^2. With
 * q' = T q_f', forces on q_f are T' times those on q, and T' M (T q_f'' + T' q_f') is their inertia.
 *
 * Prints, as options `--set`, the loads on the hub and both nodes under which the printed accelerations come out. Exit status:
 * 0 all vectors are met, 1 not.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NODE = 5, BASE = 6, FLEX = 10, SIZE = 16, PLACES = 17 };

void loaded_equations(double t, const double *q, const double *u, const double *mode,
                      const double *kept, double *M, double *Q, double *J, double *Phi,
                      double *gam);
void light_equations(double t, const double *q, const double *u, const double *mode,
                     const double *kept, double *M, double *Q, double *J, double *Phi,
                     double *gam);

static const double h = 0.8; /* length of an element */

static const double flex[FLEX]
    = {0.001, 0.05, -0.04, 0.09, 0.11, 0.0025, 0.16, -0.13, 0.13, 0.15};
static const double speed[SIZE]
    = {0.4, -0.2, 0.9, 0.7, -1.1, 2.3, 0.003, 0.3, -0.2, 0.5, 0.7, 0.007, 0.9, -0.8, 0.6, 1.1};
static const double acceleration[SIZE]
    = {1.0, -2.0, 0.5, 3.0, -1.5, 2.5, 0.1, 2.0, -3.0, 1.0, -2.0, 0.2, 5.0, -1.0, 3.0, -4.0};

/* The printed vectors, without the entries of twist, which are zero. */
struct printed {
    const char *name;
    double inertia[SIZE], velocity[SIZE], gravity[SIZE]; /* M a, Q_v, F_g */
};
static const struct printed models[] = {
    {"linear",
     {-0.58010976901185, 0.5287743340971, -0.091222473331361, 0.092064065322054,
      -0.14030198963572, 1.0772205943847, -0.045408498544395, 0.36208341575832,
      -0.078161428479808, -0.009280738224, 0.039982827024, -0.024226631852197, 0.50427948401273,
      0.13255499786081, 0.013378601674203, -0.060683675764174},
     {-1.4845723780424, -1.5108628452163, -0.62812138260934, 0.042868968416559,
      -0.4766980188582, 0.042991437901795, -1.0577042608896, -0.080391579901457,
      0.28316546798889, -0.01695635089056, -0.002864962872, -0.9067645372752,
      -0.052575596493171, 0.25652575987226, 0.031875648479383, 0.0068543039242286},
     {0.0, -3.328038576, 0.0, -0.071200172365075, -0.59742138734994, -1.9284191278955,
      -0.97612550984643, -1.2766760424884, 0.43155238662203, 0.0, 0.0, -0.48806275492321,
      -0.63833802124421, 0.21577619331101, 0.028770159108135, 0.085111736165895}},
    {"foreshortening",
     {-0.62716933545936, 0.47739303284757, -0.13701703207972, 0.091428568850742,
      -0.12951102916931, 1.0711488895739, -0.088137793401538, 0.36138806566181,
      -0.07984581209533, -0.0081060547758209, 0.041094323696136, -0.059508590252197,
      0.51002053502983, 0.12447439192891, 0.012427150926028, -0.061379368865808},
     {-1.4710303931943, -1.6273317247826, -0.71042687785359, 0.030251741235914,
      -0.40721653656599, -0.052778236441463, -1.1001532467261, -0.11839609616636,
      0.26926707001312, 0.0020436415006616, 0.013971466273814, -0.96635435349214,
      0.029536936837629, 0.12162722561904, 0.016429990641011, -0.0026466085341968},
     {0.0, -3.328038576, 0.0, -0.071200172365075, -0.59316994901313, -1.9158419538629,
      -0.97612550984643, -1.254225155762, 0.41447019019971, 0.0092406548265462,
      0.011192905846239, -0.48806275492321, -0.57244954932958, 0.16257735302438,
      0.022197580675169, 0.076847206849195}},
};

/* The places of node coordinates of one plane, by element: value, slope at the start, then at the end; w' = -ry. */
static const int planes[2][4] = {{1, 4, NODE + 1, NODE + 4}, {2, 3, NODE + 2, NODE + 3}};

/* [value slope value slope] (out) of element e and plane p of the coordinates x (FLEX). */
static void dofs(double *a, const double *x, int e, int p)
{
    for (int i = 0; i < 4; i++) {
        const int place = planes[p][i] - (e == 0 ? NODE : 0);
        a[i] = place < 0 ? 0 : place < FLEX ? x[place] : 0;
        if (p == 1 && i % 2 == 1)
            a[i] = -a[i];
    }
}

/* E a (4, out): the gradient of 1/2 int v'^2 dx over an element of cubic shapes. */
static void slopes(double *g, const double *a)
{
    const double d = a[2] - a[0];
    g[0] = -(36 * d - 3 * h * (a[1] + a[3])) / (30 * h);
    g[1] = (-3 * h * d + h * h * (4 * a[1] - a[3])) / (30 * h);
    g[2] = -g[0];
    g[3] = (-3 * h * d + h * h * (4 * a[3] - a[1])) / (30 * h);
}

/* K a (4, out): the same of 1/2 int EI v''^2 dx. */
static void bending(double *g, const double *a, double EI)
{
    const double d = a[2] - a[0], k = EI / (h * h * h);
    g[0] = k * (-12 * d + 6 * h * (a[1] + a[3]));
    g[1] = k * (-6 * h * d + h * h * (4 * a[1] + 2 * a[3]));
    g[2] = -g[0];
    g[3] = k * (-6 * h * d + h * h * (2 * a[1] + 4 * a[3]));
}

/* x (FLEX) += the entries g (4) of element e and plane p */
static void scatter(double *x, const double *g, int e, int p)
{
    for (int i = 0; i < 4; i++) {
        const int place = planes[p][i] - (e == 0 ? NODE : 0);
        if (place >= 0)
            x[place] += p == 1 && i % 2 == 1 ? -g[i] : g[i];
    }
}

/* grad (2 x FLEX, out): row k is dS/dx at node k, of the displacements x. */
static void shortening(double grad[2][FLEX], const double *x)
{
    memset(grad, 0, 2 * sizeof grad[0]);
    for (int e = 0; e < 2; e++)
        for (int p = 0; p < 2; p++) {
            double a[4], g[4];
            dofs(a, x, e, p);
            slopes(g, a);
            for (int k = e; k < 2; k++)
                scatter(grad[k], g, e, p);
        }
}

/* K q_f (FLEX, out) */
static void elastic(double *out)
{
    const double EA = 72e9 * 7.853e-5, EI = 72e9 * 4.909e-10;
    memset(out, 0, FLEX * sizeof *out);
    const double first = flex[0], second = flex[NODE] - flex[0];
    out[0] = EA / h * (first - second);
    out[NODE] = EA / h * second;
    for (int e = 0; e < 2; e++)
        for (int p = 0; p < 2; p++) {
            double a[4], g[4];
            dofs(a, flex, e, p);
            bending(g, a, EI);
            scatter(out, g, e, p);
        }
}

static double dot(const double *a, const double *b, int n)
{
    double s = 0;
    for (int i = 0; i < n; i++)
        s += a[i] * b[i];
    return s;
}

/* The program's coordinates of the state, the slopes of S in it, and the speeds of the program for the speeds v. */
struct state {
    double q[PLACES], grad[2][FLEX];
    int foreshortened;
};

static void speeds_of(const struct state *s, double *out, const double *v)
{
    memcpy(out, v, SIZE * sizeof *out);
    for (int k = 0; k < 2 && s->foreshortened; k++)
        out[BASE + k * NODE] -= dot(s->grad[k], v + BASE, FLEX);
}

/* in place: forces f (SIZE) on the program's coordinates become those on q_f */
static void forces_of(const struct state *s, double *f)
{
    for (int k = 0; k < 2 && s->foreshortened; k++)
        for (int i = 0; i < FLEX; i++)
            f[BASE + i] -= f[BASE + k * NODE] * s->grad[k][i];
}

static void take_state(struct state *s, int foreshortened)
{
    /* angles 0.3, -0.5, 0.8 about x, y, z of the body in turn */
    const double c[3] = {cos(0.15), cos(-0.25), cos(0.4)},
                 n[3] = {sin(0.15), sin(-0.25), sin(0.4)};
    memset(s, 0, sizeof *s);
    s->foreshortened = foreshortened;
    const double a[4] = {c[0] * c[1], n[0] * c[1], c[0] * n[1], n[0] * n[1]};
    s->q[3] = a[0] * c[2] - a[3] * n[2];
    s->q[4] = a[1] * c[2] + a[2] * n[2];
    s->q[5] = a[2] * c[2] - a[1] * n[2];
    s->q[6] = a[3] * c[2] + a[0] * n[2];
    memcpy(s->q + 7, flex, sizeof flex);
    shortening(s->grad, flex);
    for (int k = 0; k < 2 && foreshortened; k++)
        s->q[7 + k * NODE] -= dot(s->grad[k], flex, FLEX) / 2;
}

/* What the program says: M times the printed accelerations, Q_v and F_g, forces on q_f (SIZE each). */
static void program(const struct state *s, double *inertia, double *velocity, double *gravity)
{
    static double M[SIZE * SIZE];
    double Q[SIZE], still[SIZE], heavy[SIZE], nothing[64] = {0}, rest[SIZE] = {0}, u[SIZE],
                                              a[SIZE], turn[2][FLEX];
    speeds_of(s, u, speed);
    speeds_of(s, a, acceleration);
    light_equations(0, s->q, u, nothing, nothing, M, Q, NULL, NULL, NULL);
    light_equations(0, s->q, rest, nothing, nothing, M, still, NULL, NULL, NULL);
    loaded_equations(0, s->q, rest, nothing, nothing, M, heavy, NULL, NULL, NULL);
    shortening(turn, speed + BASE);
    for (int i = 0; i < SIZE; i++) {
        inertia[i] = dot(M + SIZE * i, a, SIZE);
        velocity[i] = still[i] - Q[i];
        for (int k = 0; k < 2 && s->foreshortened; k++)
            velocity[i] -= M[SIZE * i + BASE + k * NODE] * dot(turn[k], speed + BASE, FLEX);
        gravity[i] = heavy[i] - still[i];
    }
    forces_of(s, inertia);
    forces_of(s, velocity);
    forces_of(s, gravity);
}

/* Whether `got` is `want`: 14 digits are printed; velocity and gravity are differences beside the axial force, 8.8e3 N. */
static int meets(const char *what, const double *got, const double *want)
{
    int good = 1;
    for (int i = 0; i < SIZE; i++)
        if (!(fabs(got[i] - want[i]) <= 1e-10)) {
            fprintf(stderr, "%s, row %d: %.14g for %.14g\n", what, i + 1, got[i], want[i]);
            good = 0;
        }
    return good;
}

static void print_load(const char *name, const double *value)
{
    for (int i = 0; i < 3; i++)
        printf("--set %s%c=%.17g\n", name, "xyz"[i], value[i]);
}

/* Moments on ry and rz of node k as a torque across the axis: the section turns by Rz(g/2) Ry(b) Rz(g/2). */
static void node_torque(double *torque, const double *moment, int k)
{
    const double b = flex[k * NODE + 3], g = flex[k * NODE + 4];
    /* rates: b' about Rz(g/2) e_y, g' about (e_z + Rz(g/2) Ry(b) e_z)/2; no x component */
    const double across = cos(g / 2), y = sin(g / 2) * sin(b) / 2, z = (1 + cos(b)) / 2;
    torque[0] = 0;
    torque[1] = moment[0] / across;
    torque[2] = (moment[1] - y * torque[1]) / z;
}

static void cross(double *out, const double *a, const double *b)
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* The loads on the hub and both nodes, in body axes, that the printed motion needs. */
static void print_loads(const struct state *s, const struct printed *printed)
{
    double need[SIZE], force[3], torque[3], stiff[FLEX];
    const double *q = s->q + 3;
    for (int i = 0; i < SIZE; i++)
        need[i] = printed->inertia[i] + printed->velocity[i] - printed->gravity[i];
    elastic(stiff);
    for (int i = 0; i < FLEX; i++)
        need[BASE + i] += stiff[i];
    /* on the program's coordinates */
    for (int k = 0; k < 2 && s->foreshortened; k++)
        for (int i = 0; i < FLEX; i++)
            need[BASE + i] += need[BASE + k * NODE] * s->grad[k][i];
    const double R[3][3]
        = {{1 - 2 * (q[2] * q[2] + q[3] * q[3]), 2 * (q[1] * q[2] - q[0] * q[3]),
            2 * (q[1] * q[3] + q[0] * q[2])},
           {2 * (q[1] * q[2] + q[0] * q[3]), 1 - 2 * (q[1] * q[1] + q[3] * q[3]),
            2 * (q[2] * q[3] - q[0] * q[1])},
           {2 * (q[1] * q[3] - q[0] * q[2]), 2 * (q[2] * q[3] + q[0] * q[1]),
            1 - 2 * (q[1] * q[1] + q[2] * q[2])}};
    for (int i = 0; i < 3; i++) {
        force[i] = R[0][i] * need[0] + R[1][i] * need[1] + R[2][i] * need[2];
        torque[i]
            = need[3 + i] + acceleration[3 + i]; /* the hub's inertia is 1 about each axis */
    }
    for (int k = 0; k < 2; k++) {
        const double *f = need + BASE + k * NODE;
        double m[3], moment[3], place[3];
        memcpy(place, s->q + 7 + k * NODE, sizeof place);
        place[0] += (k + 1) * h;
        node_torque(m, f + 3, k);
        cross(moment, place, f);
        for (int i = 0; i < 3; i++) {
            force[i] -= f[i];
            torque[i] -= m[i] + moment[i];
        }
        print_load(k == 0 ? "mid_f" : "tip_f", f);
        print_load(k == 0 ? "mid_t" : "tip_t", m);
    }
    print_load("hub_f", force);
    print_load("hub_t", torque);
}

int main(int argc, char **argv)
{
    const struct printed *printed = &models[argc == 2 && strcmp(argv[1], models[1].name) == 0];
    struct state s;
    double inertia[SIZE], velocity[SIZE], gravity[SIZE];
    take_state(&s, printed == &models[1]);
    program(&s, inertia, velocity, gravity);
    print_loads(&s, printed);
    const int good = meets("M a", inertia, printed->inertia)
                   & meets("Q_v", velocity, printed->velocity)
                   & meets("F_g", gravity, printed->gravity);
    return good ? 0 : 1;
}
