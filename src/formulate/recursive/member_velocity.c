// Kinematics of members: transformations, angular velocities, biases; see member.h.
#include "formulate/recursive/member_internal.h"

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// ---- axes ---------------------------------------------------------------------------------------

ct_ex3 ct_member_out(struct ct_build *b, const struct ct_member *m, ct_ex3 v)
{
    return m->has_axes ? ct_ex33_apply(b->x, &m->R, v) : v;
}

ct_ex3 ct_member_in(struct ct_build *b, const struct ct_member *m, ct_ex3 v)
{
    return m->has_axes ? ct_ex33_apply_t(b->x, &m->R, v) : v;
}

static bool is_symmetric(const ct_ex33 *A)
{
    return ct_ex_same(A->e[1], A->e[3]) && ct_ex_same(A->e[2], A->e[6])
        && ct_ex_same(A->e[5], A->e[7]);
}

// Rotates a tensor A about a coordinate axis. Its symmetric trace-free part normal to the axis
// rotates by twice the angle: with D = A_jj - A_kk, T = A_jk + A_kj, y = c D - s T these change by
// c y, -c y and s y.
static void turn_about(struct ct_build *b, const struct ct_member *m, ct_ex33 *A)
{
    struct ct_exs *x = b->x;
    const int i = m->axis, j = (i + 1) % 3, k = (i + 2) % 3;
    const ct_ex c = m->R.e[j + 3 * j], s = m->R.e[k + 3 * j];
    const ct_ex33 a = *A;
    const ct_ex jj = a.e[j + 3 * j], kk = a.e[k + 3 * k], jk = a.e[j + 3 * k],
                kj = a.e[k + 3 * j];
    const ct_ex y = ct_ex_sub(x, ct_ex_mul(x, c, ct_ex_sub(x, jj, kk)),
                              ct_ex_mul(x, s, ct_ex_add(x, jk, kj)));
    const ct_ex along = ct_ex_mul(x, c, y), across = ct_ex_mul(x, s, y);
    A->e[j + 3 * j] = ct_ex_add(x, kk, along);
    A->e[k + 3 * k] = ct_ex_sub(x, jj, along);
    A->e[j + 3 * k] = ct_ex_add(x, jk, across);
    A->e[k + 3 * j] = ct_ex_add(x, kj, across);
    const ct_ex ij = a.e[i + 3 * j], ik = a.e[i + 3 * k], ji = a.e[j + 3 * i],
                ki = a.e[k + 3 * i];
    A->e[i + 3 * j] = ct_ex_sub(x, ct_ex_mul(x, c, ij), ct_ex_mul(x, s, ik));
    A->e[i + 3 * k] = ct_ex_add(x, ct_ex_mul(x, s, ij), ct_ex_mul(x, c, ik));
    A->e[j + 3 * i] = ct_ex_sub(x, ct_ex_mul(x, c, ji), ct_ex_mul(x, s, ki));
    A->e[k + 3 * i] = ct_ex_add(x, ct_ex_mul(x, s, ji), ct_ex_mul(x, c, ki));
}

void ct_member_turn_tensor(struct ct_build *b, const struct ct_member *m, ct_ex33 *A)
{
    struct ct_exs *x = b->x;
    if (!m->has_axes)
        return;
    if (m->axis >= 0) {
        turn_about(b, m, A);
        return;
    }
    const bool symmetric = is_symmetric(A);
    const ct_ex33 half = ct_ex33_mul(x, &m->R, A);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const ct_ex3 row = {{half.e[i], half.e[i + 3], half.e[i + 6]}},
                         column = {{m->R.e[j], m->R.e[j + 3], m->R.e[j + 6]}};
            A->e[i + 3 * j] = symmetric && j > i ? CT_EX_ZERO : ct_ex3_dot(x, row, column);
        }
    for (int i = 0; i < 3 && symmetric; i++)
        for (int j = i + 1; j < 3; j++)
            A->e[i + 3 * j] = A->e[j + 3 * i];
}

// ---- velocities ---------------------------------------------------------------------------------

// w w' - (w . w) 1
static ct_ex33 centripetal_matrix(struct ct_exs *x, ct_ex3 w)
{
    ct_ex33 U;
    ct_ex square[3];
    for (int i = 0; i < 3; i++)
        square[i] = ct_ex_mul(x, w.e[i], w.e[i]);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        U.e[i + 3 * i] = ct_ex_neg(x, ct_ex_add(x, square[j], square[k]));
        U.e[i + 3 * j] = U.e[j + 3 * i] = ct_ex_mul(x, w.e[i], w.e[j]);
    }
    return U;
}

ct_ex3 ct_member_slide_bias(struct ct_build *b, const struct ct_members *s, int i)
{
    struct ct_exs *x = b->x;
    const struct ct_member *m = &s->member[i], *p = &s->member[m->parent];
    if (!m->translates)
        return zero3;
    const ct_ex3 coriolis = ct_ex3_scale(x, ct_ex_const(x, 2), ct_ex3_cross(x, p->w, m->drift));
    return ct_ex3_add(x, coriolis, m->drift_bias);
}

ct_ex3 ct_member_shift_bias(struct ct_build *b, const struct ct_members *s, int i)
{
    const struct ct_member *m = &s->member[i];
    const ct_ex3 carried = ct_ex33_apply(b->x, &s->member[m->parent].U, m->r);
    return ct_ex3_add(b->x, carried, ct_member_slide_bias(b, s, i));
}

// (w x J w)_i = (J_kk - J_jj) w_j w_k + J_jk (w_j^2 - w_k^2) + J_ik w_i w_j - J_ij w_i w_k
ct_ex3 ct_member_gyroscopic(struct ct_build *b, const struct ct_member *m)
{
    struct ct_exs *x = b->x;
    ct_ex3 out;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const ct_ex33 *U = &m->U, *J = &m->J;
        ct_ex sum
            = ct_ex_mul(x, ct_ex_sub(x, J->e[k + 3 * k], J->e[j + 3 * j]), U->e[j + 3 * k]);
        sum = ct_ex_add(
            x, sum,
            ct_ex_mul(x, J->e[j + 3 * k], ct_ex_sub(x, U->e[j + 3 * j], U->e[k + 3 * k])));
        sum = ct_ex_add(x, sum, ct_ex_mul(x, J->e[i + 3 * k], U->e[i + 3 * j]));
        out.e[i] = ct_ex_sub(x, sum, ct_ex_mul(x, J->e[i + 3 * j], U->e[i + 3 * k]));
    }
    return out;
}

void ct_members_turn(struct ct_build *b, struct ct_members *s)
{
    for (size_t i = 1; i < s->n; i++) {
        struct ct_member *m = &s->member[i];
        const struct ct_member *p = &s->member[m->parent];
        const ct_ex3 carried = m->is_absolute ? zero3 : ct_member_in(b, m, p->w);
        m->w = ct_ex3_add(b->x, carried, m->w_relative);
        m->al_relative
            = ct_ex3_add(b->x, m->al_relative, ct_ex3_cross(b->x, carried, m->w_relative));
        m->U = centripetal_matrix(b->x, m->w);
    }
}
