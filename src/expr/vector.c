// Three components and 3 x 3 matrices of expressions.
#include "expr/ex.h"

#include <float.h>
#include <math.h>

ct_ex3 ct_ex3_add(struct ct_exs *x, ct_ex3 a, ct_ex3 b)
{
    for (int i = 0; i < 3; i++)
        a.e[i] = ct_ex_add(x, a.e[i], b.e[i]);
    return a;
}

ct_ex3 ct_ex3_sub(struct ct_exs *x, ct_ex3 a, ct_ex3 b)
{
    for (int i = 0; i < 3; i++)
        a.e[i] = ct_ex_sub(x, a.e[i], b.e[i]);
    return a;
}

ct_ex3 ct_ex3_neg(struct ct_exs *x, ct_ex3 a)
{
    for (int i = 0; i < 3; i++)
        a.e[i] = ct_ex_neg(x, a.e[i]);
    return a;
}

ct_ex3 ct_ex3_scale(struct ct_exs *x, ct_ex c, ct_ex3 a)
{
    for (int i = 0; i < 3; i++)
        a.e[i] = ct_ex_mul(x, c, a.e[i]);
    return a;
}

ct_ex3 ct_ex3_cross(struct ct_exs *x, ct_ex3 a, ct_ex3 b)
{
    ct_ex3 c;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        c.e[i] = ct_ex_sub(x, ct_ex_mul(x, a.e[j], b.e[k]), ct_ex_mul(x, a.e[k], b.e[j]));
    }
    return c;
}

ct_ex ct_ex3_dot(struct ct_exs *x, ct_ex3 a, ct_ex3 b)
{
    ct_ex s = ct_ex_mul(x, a.e[0], b.e[0]);
    for (int i = 1; i < 3; i++)
        s = ct_ex_add(x, s, ct_ex_mul(x, a.e[i], b.e[i]));
    return s;
}

ct_ex3 ct_ex3_const(struct ct_exs *x, const double v[3])
{
    return (ct_ex3){{ct_ex_const(x, v[0]), ct_ex_const(x, v[1]), ct_ex_const(x, v[2])}};
}

bool ct_ex3_is_zero(ct_ex3 a)
{
    return ct_ex_is_zero(a.e[0]) && ct_ex_is_zero(a.e[1]) && ct_ex_is_zero(a.e[2]);
}

ct_ex3 ct_ex33_apply(struct ct_exs *x, const ct_ex33 *A, ct_ex3 b)
{
    ct_ex3 c;
    for (int i = 0; i < 3; i++)
        c.e[i] = ct_ex3_dot(x, (ct_ex3){{A->e[i], A->e[i + 3], A->e[i + 6]}}, b);
    return c;
}

ct_ex3 ct_ex33_apply_t(struct ct_exs *x, const ct_ex33 *A, ct_ex3 b)
{
    ct_ex3 c;
    for (int i = 0; i < 3; i++)
        c.e[i] = ct_ex3_dot(x, (ct_ex3){{A->e[3 * i], A->e[3 * i + 1], A->e[3 * i + 2]}}, b);
    return c;
}

ct_ex33 ct_ex33_mul(struct ct_exs *x, const ct_ex33 *A, const ct_ex33 *B)
{
    ct_ex33 C;
    for (int j = 0; j < 3; j++) {
        const ct_ex3 c
            = ct_ex33_apply(x, A, (ct_ex3){{B->e[3 * j], B->e[3 * j + 1], B->e[3 * j + 2]}});
        for (int i = 0; i < 3; i++)
            C.e[i + 3 * j] = c.e[i];
    }
    return C;
}

ct_ex33 ct_ex33_identity(void)
{
    ct_ex33 I = {{{0}}};
    I.e[0] = I.e[4] = I.e[8] = CT_EX_ONE;
    return I;
}

ct_ex33 ct_ex33_transpose(const ct_ex33 *A)
{
    ct_ex33 T;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            T.e[j + 3 * i] = A->e[i + 3 * j];
    return T;
}

// Round a sine or cosine of a quarter turn to the exact value: cos(pi/2) is 0, not 6e-17.
static ct_ex exact_quarter(struct ct_exs *x, ct_ex e)
{
    double v;
    // Derived: an angle of up to 8 quarter turns is below 16, so its round-off is at most 4 eps;
    // near its zeros a sine or cosine changes by as much
    const double roundoff = 4 * DBL_EPSILON;
    if (ct_ex_is_const(x, e, &v) && fabs(v - round(v)) < roundoff)
        return ct_ex_const(x, round(v));
    return e;
}

// R = c 1 + (1 - c) n n' + s n~  (Rodrigues); for a coordinate axis the zeros fold away.
ct_ex33 ct_ex33_axis_angle(struct ct_exs *x, ct_ex3 n, ct_ex a)
{
    const ct_ex c = exact_quarter(x, ct_ex_fun(x, CT_OP_COS, a));
    const ct_ex s = exact_quarter(x, ct_ex_fun(x, CT_OP_SIN, a));
    const ct_ex v = ct_ex_sub(x, CT_EX_ONE, c);
    ct_ex33 R;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        double one;
        const bool is_axis = ct_ex_is_const(x, n.e[i], &one) && (one == 1 || one == -1);
        R.e[i + 3 * i] = is_axis
                           ? CT_EX_ONE // c + (1 - c)
                           : ct_ex_add(x, c, ct_ex_mul(x, v, ct_ex_mul(x, n.e[i], n.e[i])));
        const ct_ex both = ct_ex_mul(x, v, ct_ex_mul(x, n.e[i], n.e[j]));
        const ct_ex turn = ct_ex_mul(x, s, n.e[k]);
        R.e[j + 3 * i] = ct_ex_add(x, both, turn);
        R.e[i + 3 * j] = ct_ex_sub(x, both, turn);
    }
    return R;
}
