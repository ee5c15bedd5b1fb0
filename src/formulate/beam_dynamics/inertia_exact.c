// Integrals over a beam with linear kinematics: constant element matrices; see beam_dynamics.h.
//
// A dof j moves the axis along one direction d(j) by its shape f_j. With
//
//     S_jk = int m f_j f_k,  F_j = int m f_j,  X_j = int m x f_j,
//     R_jk and G_j the same for the rotary inertia
//
// and z_a,k = Om_ab q_k + 2 w~_ab q'_k (+ q''_k where a = b), b = d(k), the row of dof j with a =
// d(j) is
//
//     F_j a_a + X_j Om_ax + sum_k S_jk z_a,k        (5.4), (5.5)
#include "formulate/beam_dynamics/beam_dynamics.h"

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// Mass integrals of one element; S also between dofs of different directions.
struct ct_element_mass {
    ct_ex S[CT_AXIS_DOF][CT_AXIS_DOF], F[CT_AXIS_DOF], X[CT_AXIS_DOF];
    ct_ex m, mx, mxx;
    // between dofs that rotate the section about the same axis
    ct_ex R[CT_DOF][CT_DOF], G[CT_DOF];
    ct_ex j[3];
};

// ---- dofs ---------------------------------------------------------------------------------------

static int direction(int dof)
{
    return dof < 2 || dof == CT_MIDDLE_DOF ? 0 : dof < 6 ? 1 : 2;
}

// Axis about which a dof rotates the section; -1: none.
static int axis(int dof)
{
    return dof < 2 || dof == CT_MIDDLE_DOF ? -1 : dof < 6 ? 2 : dof < CT_BENT_DOF ? 1 : 0;
}

static const struct ct_shape *place_shape(const struct ct_flexible *f, int dof)
{
    if (dof == CT_MIDDLE_DOF)
        return &f->line[2];
    return dof < 2 ? &f->line[dof] : &f->shape.deflection[(dof - 2) % 4];
}

// Right-handed: a slope dw/dx is a rotation about -y.
static struct ct_shape turn_shape(const struct ct_flexible *f, int dof)
{
    struct ct_shape s
        = dof >= CT_AXIS_DOF ? f->line[dof - CT_AXIS_DOF] : f->shape.rotation[(dof - 2) % 4];
    for (int i = 0; i < CT_SHAPE_SIZE && axis(dof) == 1; i++)
        s.c[i] = -s.c[i];
    return s;
}

static bool is_free(const struct ct_flexible *f, int e, int dof)
{
    return f->element[e].freedom[dof] >= 0;
}

// ---- element matrices ---------------------------------------------------------------------------

static void place_integrals(struct ct_build *b, const struct ct_flexible *f, int e,
                            struct ct_element_mass *s)
{
    static const struct ct_shape one = {.c = {1}}, xi = {.c = {0, 1}, .power = 1};
    struct ct_exs *x = b->x;
    const enum ct_rule rule = ct_flexible_mass_rule(f->beam);
    const ct_ex g = f->beam->mass_per_length, start = f->element[e].span.start;
    const ct_ex m1 = ct_flexible_integral(b, f, e, g, &one, &xi, rule);
    const ct_ex m2 = ct_flexible_integral(b, f, e, g, &xi, &xi, rule);
    s->m = ct_flexible_integral(b, f, e, g, &one, &one, rule);
    s->mx = ct_ex_add(x, ct_ex_mul(x, start, s->m), m1);
    const ct_ex inner = ct_ex_add(x, ct_ex_mul(x, start, s->m), ct_ex_scale(x, 2, m1));
    s->mxx = ct_ex_add(x, ct_ex_mul(x, start, inner), m2);
    for (int j = 0; j < CT_AXIS_DOF; j++) {
        const struct ct_shape *p = place_shape(f, j);
        if (!is_free(f, e, j))
            continue;
        s->F[j] = ct_flexible_integral(b, f, e, g, &one, p, rule);
        s->X[j] = ct_ex_add(x, ct_ex_mul(x, start, s->F[j]),
                            ct_flexible_integral(b, f, e, g, &xi, p, rule));
        for (int k = 0; k <= j; k++)
            if (is_free(f, e, k))
                s->S[j][k] = s->S[k][j]
                    = ct_flexible_integral(b, f, e, g, p, place_shape(f, k), rule);
    }
}

static void turn_integrals(struct ct_build *b, const struct ct_flexible *f, int e,
                           struct ct_element_mass *s)
{
    static const struct ct_shape one = {.c = {1}};
    const enum ct_rule rule = ct_flexible_mass_rule(f->beam);
    for (int a = 0; a < 3; a++) {
        const ct_ex g = ct_flexible_rotary(f, a).value;
        s->j[a] = ct_flexible_integral(b, f, e, g, &one, &one, rule);
        for (int j = 2; j < CT_DOF; j++) {
            if (axis(j) != a || !is_free(f, e, j))
                continue;
            const struct ct_shape p = turn_shape(f, j);
            s->G[j] = ct_flexible_integral(b, f, e, g, &one, &p, rule);
            for (int k = 2; k <= j; k++) {
                if (axis(k) != a || !is_free(f, e, k))
                    continue;
                const struct ct_shape q = turn_shape(f, k);
                s->R[j][k] = s->R[k][j] = ct_flexible_integral(b, f, e, g, &p, &q, rule);
            }
        }
    }
}

// ---- sums over a beam ---------------------------------------------------------------------------

// sum_k S_jk v_k
static ct_ex row_times(struct ct_build *b, const ct_ex *row, const ct_ex *v, int n)
{
    ct_ex sum = CT_EX_ZERO;
    for (int k = 0; k < n; k++)
        sum = ct_ex_add(b->x, sum, ct_ex_mul(b->x, row[k], v[k]));
    return sum;
}

// v for dofs along direction a, zero for others.
static void along(const ct_ex *v, int a, ct_ex out[CT_AXIS_DOF])
{
    for (int j = 0; j < CT_AXIS_DOF; j++)
        out[j] = direction(j) == a ? v[j] : CT_EX_ZERO;
}

// u' S v
static ct_ex product(struct ct_build *b, const struct ct_element_mass *s, const ct_ex *u,
                     const ct_ex *v)
{
    ct_ex sum = CT_EX_ZERO;
    for (int j = 0; j < CT_AXIS_DOF; j++)
        if (!ct_ex_is_zero(u[j]))
            sum = ct_ex_add(b->x, sum,
                            ct_ex_mul(b->x, u[j], row_times(b, s->S[j], v, CT_AXIS_DOF)));
    return sum;
}

// int m (displacement) of dof values v: sum F_j v_j along each direction.
static ct_ex3 first_integral(struct ct_build *b, const struct ct_element_mass *s,
                             const ct_ex *v)
{
    ct_ex3 sum = zero3;
    for (int j = 0; j < CT_AXIS_DOF; j++) {
        ct_ex *a = &sum.e[direction(j)];
        *a = ct_ex_add(b->x, *a, ct_ex_mul(b->x, s->F[j], v[j]));
    }
    return sum;
}

// int m r x d of the field d = (sum f_k D[0][k], sum f_k D[1][k], sum f_k D[2][k]).
static ct_ex3 moment_of_field(struct ct_build *b, const struct ct_element *e,
                              const struct ct_element_mass *s, ct_ex D[3][CT_AXIS_DOF])
{
    struct ct_exs *x = b->x;
    ct_ex N[3][3];
    for (int a = 0; a < 3; a++) {
        ct_ex u[CT_AXIS_DOF];
        along(e->value, a, u);
        for (int c = 0; c < 3; c++) {
            N[a][c] = a == c ? CT_EX_ZERO : product(b, s, u, D[c]);
            if (a == 0 && c)
                N[a][c] = ct_ex_add(x, N[a][c], row_times(b, s->X, D[c], CT_AXIS_DOF));
        }
    }
    return (ct_ex3){{ct_ex_sub(x, N[1][2], N[2][1]), ct_ex_sub(x, N[2][0], N[0][2]),
                     ct_ex_sub(x, N[0][1], N[1][0])}};
}

static ct_ex3 turned(struct ct_build *b, const struct ct_element_mass *s, const ct_ex *v)
{
    ct_ex3 sum = zero3;
    for (int j = 2; j < CT_DOF; j++) {
        if (axis(j) < 0)
            continue;
        ct_ex *a = &sum.e[axis(j)];
        *a = ct_ex_add(b->x, *a, ct_ex_mul(b->x, s->G[j], v[j]));
    }
    return sum;
}

// w~_ab
static ct_ex cross_entry(struct ct_build *b, ct_ex3 w, int a, int c)
{
    if (a == c)
        return CT_EX_ZERO;
    const ct_ex v = w.e[3 - a - c];
    return (a + 1) % 3 == c ? ct_ex_neg(b->x, v) : v;
}

// ---- the method --------------------------------------------------------------------------------

static void add_moments(struct ct_build *b, const struct ct_element *e,
                        const struct ct_element_mass *s, struct ct_inertia *I,
                        ct_ex second[3][3])
{
    struct ct_exs *x = b->x;
    I->moment = ct_ex3_add(x, I->moment, first_integral(b, s, e->value));
    I->moment.e[0] = ct_ex_add(x, I->moment.e[0], s->mx);
    for (int a = 0; a < 3; a++) {
        ct_ex u[CT_AXIS_DOF];
        along(e->value, a, u);
        for (int c = 0; c <= a; c++) {
            ct_ex v[CT_AXIS_DOF];
            along(e->value, c, v);
            ct_ex sum = product(b, s, u, v);
            const ct_ex Xu = row_times(b, s->X, u, CT_AXIS_DOF);
            if (a == 0)
                sum = ct_ex_add(x, sum, ct_ex_add(x, s->mxx, ct_ex_scale(x, 2, Xu)));
            else if (c == 0)
                sum = ct_ex_add(x, sum, Xu);
            second[a][c] = ct_ex_add(x, second[a][c], sum);
        }
    }
}

static void derive(struct ct_build *b, struct ct_flexible *f)
{
    struct ct_exs *x = b->x;
    struct ct_inertia *I = f->inertia;
    ct_ex second[3][3] = {{{0}}};
    I->element = CT_NEWN(b->arena, struct ct_element_mass, f->beam->nelement);
    for (int e = 0; e < f->beam->nelement; e++) {
        struct ct_element_mass *s = &I->element[e];
        place_integrals(b, f, e, s);
        turn_integrals(b, f, e, s);
        add_moments(b, &f->element[e], s, I, second);
        for (int a = 0; a < 3; a++)
            I->inertia.e[4 * a] = ct_ex_add(x, I->inertia.e[4 * a], s->j[a]);
    }
    for (int a = 0; a < 3; a++) {
        const int c = (a + 1) % 3, d = (a + 2) % 3;
        const ct_ex both = ct_ex_add(x, second[c][c], second[d][d]);
        const ct_ex cross = ct_ex_neg(x, a > c ? second[a][c] : second[c][a]);
        I->inertia.e[4 * a] = ct_ex_add(x, I->inertia.e[4 * a], both);
        I->inertia.e[a + 3 * c] = I->inertia.e[c + 3 * a] = cross;
    }
}

// z_a,k of all dofs of an element for direction a.
static void combine(struct ct_build *b, const struct ct_element *e, const struct ct_base *m,
                    const ct_ex33 *Om, enum ct_level level, int a, ct_ex z[CT_AXIS_DOF])
{
    struct ct_exs *x = b->x;
    for (int k = 0; k < CT_AXIS_DOF; k++) {
        const int c = direction(k);
        const ct_ex w = ct_ex_scale(x, 2, cross_entry(b, m->w, a, c));
        z[k] = ct_ex_mul(x, w, e->rate[k]);
        if (Om)
            z[k] = ct_ex_add(x, z[k], ct_ex_mul(x, Om->e[a + 3 * c], e->value[k]));
        if (level == CT_FULL && a == c)
            z[k] = ct_ex_add(x, z[k], e->acceleration[k]);
    }
}

static void rows(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                 enum ct_level level, ct_ex *by_freedom)
{
    struct ct_exs *x = b->x;
    const ct_ex33 Om = ct_base_acceleration_matrix(b, m);
    for (int i = 0; i < f->beam->nelement; i++) {
        const struct ct_element *e = &f->element[i];
        const struct ct_element_mass *s = &f->inertia->element[i];
        for (int j = 0; j < CT_DOF; j++) {
            if (!is_free(f, i, j))
                continue;
            ct_ex sum = CT_EX_ZERO, z[CT_AXIS_DOF];
            if (j < CT_AXIS_DOF) {
                const int a = direction(j);
                combine(b, e, m, &Om, level, a, z);
                sum = ct_ex_add(x, ct_ex_mul(x, s->F[j], m->a.e[a]),
                                ct_ex_mul(x, s->X[j], Om.e[a]));
                sum = ct_ex_add(x, sum, row_times(b, s->S[j], z, CT_AXIS_DOF));
            }
            if (axis(j) >= 0)
                sum = ct_ex_add(x, sum, ct_ex_mul(x, s->G[j], m->al.e[axis(j)]));
            if (level == CT_FULL)
                sum = ct_ex_add(x, sum, row_times(b, s->R[j], e->acceleration, CT_DOF));
            ct_dof_push(b, f, i, j, sum, by_freedom);
        }
    }
}

static void wrench(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                   enum ct_level level, ct_ex3 *force, ct_ex3 *torque)
{
    struct ct_exs *x = b->x;
    ct_ex3 spin = zero3, rate = zero3;
    *force = *torque = zero3;
    for (int i = 0; i < f->beam->nelement; i++) {
        const struct ct_element *e = &f->element[i];
        const struct ct_element_mass *s = &f->inertia->element[i];
        ct_ex D[3][CT_AXIS_DOF];
        for (int a = 0; a < 3; a++)
            combine(b, e, m, NULL, level, a, D[a]);
        rate = ct_ex3_add(x, rate, first_integral(b, s, e->rate));
        spin = ct_ex3_add(x, spin, turned(b, s, e->rate));
        *torque = ct_ex3_add(x, *torque, moment_of_field(b, e, s, D));
        if (level == CT_FULL) {
            *force = ct_ex3_add(x, *force, first_integral(b, s, e->acceleration));
            *torque = ct_ex3_add(x, *torque, turned(b, s, e->acceleration));
        }
    }
    *force = ct_ex3_add(x, *force, ct_twice_cross(b, m->w, rate));
    *torque = ct_ex3_add(x, *torque, ct_ex3_cross(x, m->w, spin));
}

static void relative_momentum(struct ct_build *b, const struct ct_flexible *f,
                              struct ct_relative *out)
{
    struct ct_exs *x = b->x;
    for (int i = 0; i < f->beam->nelement; i++) {
        const struct ct_element *e = &f->element[i];
        const struct ct_element_mass *s = &f->inertia->element[i];
        ct_ex D[3][CT_AXIS_DOF];
        for (int a = 0; a < 3; a++) {
            along(e->rate, a, D[a]);
            out->twice_kinetic = ct_ex_add(x, out->twice_kinetic, product(b, s, D[a], D[a]));
        }
        for (int j = 2; j < CT_DOF; j++)
            out->twice_kinetic
                = ct_ex_add(x, out->twice_kinetic,
                            ct_ex_mul(x, e->rate[j], row_times(b, s->R[j], e->rate, CT_DOF)));
        out->momentum = ct_ex3_add(x, out->momentum, first_integral(b, s, e->rate));
        out->angular_momentum
            = ct_ex3_add(x, out->angular_momentum, moment_of_field(b, e, s, D));
        out->angular_momentum = ct_ex3_add(x, out->angular_momentum, turned(b, s, e->rate));
    }
}

static void mass(struct ct_build *b, const struct ct_flexible *f,
                 struct ct_elastic_columns *out, struct ct_symmetric *M)
{
    struct ct_exs *x = b->x;
    for (int i = 0; i < f->beam->nelement; i++) {
        const struct ct_element *e = &f->element[i];
        const struct ct_element_mass *s = &f->inertia->element[i];
        for (int j = 0; j < CT_DOF; j++) {
            if (!is_free(f, i, j))
                continue;
            ct_ex3 m_rf = zero3, m_thetaf = zero3;
            if (j < CT_AXIS_DOF) {
                ct_ex D[3][CT_AXIS_DOF] = {{{0}}};
                D[direction(j)][j] = CT_EX_ONE;
                m_rf.e[direction(j)] = s->F[j];
                m_thetaf = moment_of_field(b, e, s, D);
            }
            if (axis(j) >= 0)
                m_thetaf.e[axis(j)] = ct_ex_add(x, m_thetaf.e[axis(j)], s->G[j]);
            ct_dof_push_column(b, f, i, j, m_rf, m_thetaf, out);
            for (int k = 0; k < CT_DOF; k++) {
                const bool same
                    = j < CT_AXIS_DOF && k < CT_AXIS_DOF && direction(j) == direction(k);
                const ct_ex S = same ? s->S[j][k] : CT_EX_ZERO;
                ct_dof_push_pair(b, f, i, j, i, k, ct_ex_add(x, S, s->R[j][k]), M);
            }
        }
    }
}

const struct ct_inertia_method ct_inertia_exact = {.derive = derive,
                                                   .rows = rows,
                                                   .wrench = wrench,
                                                   .relative_momentum = relative_momentum,
                                                   .mass = mass};
