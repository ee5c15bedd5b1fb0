// See shape_function.h.
#include "formulate/beam/shape_function.h"
#include "expr/quadrature.h"

#include <float.h>
#include <math.h>

static const struct ct_shape one = {.c = {1}};

// ---- polynomials --------------------------------------------------------------------------------

struct ct_shape ct_shape_mul(const struct ct_shape *a, const struct ct_shape *b)
{
    struct ct_shape p = {.power = a->power + b->power};
    for (int i = 0; i < CT_SHAPE_SIZE; i++)
        for (int j = 0; i + j < CT_SHAPE_SIZE; j++)
            p.c[i + j] += a->c[i] * b->c[j];
    return p;
}

struct ct_shape ct_shape_slope(const struct ct_shape *a)
{
    struct ct_shape p = {.power = a->power - 1};
    for (int i = 1; i < CT_SHAPE_SIZE; i++)
        p.c[i - 1] = i * a->c[i];
    return p;
}

struct ct_shape ct_shape_primitive(const struct ct_shape *a)
{
    struct ct_shape p = {.power = a->power + 1};
    for (int i = 1; i < CT_SHAPE_SIZE; i++)
        p.c[i] = a->c[i - 1] / i;
    return p;
}

bool ct_shape_is_zero(const struct ct_shape *a)
{
    for (int i = 0; i < CT_SHAPE_SIZE; i++)
        if (a->c[i] != 0)
            return false;
    return true;
}

static const double common = 360360; // Definition: least common multiple of 1 ... 13

double ct_shape_end(const struct ct_shape *a)
{
    double sum = 0;
    for (int i = 0; i < CT_SHAPE_SIZE; i++) {
        const double n = a->c[i] * common, whole = rint(n);
        // coefficients are integers over 1 ... 13: n is an integer that may have been rounded twice
        sum += fabs(n - whole) <= 4 * DBL_EPSILON * fabs(n) ? whole : n;
    }
    return sum / common;
}

static double value_at(const struct ct_shape *a, double xi)
{
    double v = 0;
    if (xi == 1)
        return ct_shape_end(a);
    for (int i = CT_SHAPE_SIZE; i-- > 0;)
        v = v * xi + a->c[i];
    return v;
}

double ct_shape_value(const struct ct_shape *a, double xi, double length)
{
    double v = value_at(a, xi);
    for (int k = a->power; k > 0; k--)
        v *= length;
    for (int k = a->power; k < 0; k++)
        v /= length;
    return v;
}

static ct_ex with_power(struct ct_exs *x, ct_ex v, int power, ct_ex length)
{
    for (; power > 0; power--)
        v = ct_ex_mul(x, v, length);
    for (; power < 0; power++)
        v = ct_ex_div(x, v, length);
    return v;
}

ct_ex ct_shape_at(struct ct_exs *x, const struct ct_shape *a, ct_ex xi, ct_ex length)
{
    double v;
    if (ct_ex_is_const(x, xi, &v))
        return with_power(x, ct_ex_const(x, value_at(a, v)), a->power, length);
    ct_ex sum = CT_EX_ZERO;
    for (int i = CT_SHAPE_SIZE; i-- > 0;)
        sum = ct_ex_add(x, ct_ex_mul(x, sum, xi), ct_ex_const(x, a->c[i]));
    return with_power(x, sum, a->power, length);
}

// ---- shapes -------------------------------------------------------------------------------------

void ct_shape_line(struct ct_shape f[3])
{
    f[0] = (struct ct_shape){.c = {1, -1}};
    f[1] = (struct ct_shape){.c = {0, 1}};
    f[2] = (struct ct_shape){.c = {0, 4, -4}};
}

void ct_shape_bending(enum ct_beam_theory theory, struct ct_bending *s)
{
    const struct ct_shape cubic[4] = {{.c = {1, 0, -3, 2}},
                                      {.c = {0, 1, -2, 1}, .power = 1},
                                      {.c = {0, 0, 3, -2}},
                                      {.c = {0, 0, -1, 1}, .power = 1}};
    struct ct_shape linear[3];
    ct_shape_line(linear);
    for (int i = 0; i < 4; i++) {
        const bool turns = i % 2;
        if (theory == CT_BEAM_EULER_BERNOULLI) {
            s->deflection[i] = cubic[i];
            s->rotation[i] = ct_shape_slope(&cubic[i]);
        } else {
            const struct ct_shape none = {0};
            s->deflection[i] = turns ? none : linear[i / 2];
            s->rotation[i] = turns ? linear[i / 2] : none;
        }
        s->slope[i] = ct_shape_slope(&s->deflection[i]);
    }
}

// ---- integrals ----------------------------------------------------------------------------------

static ct_ex place_at(struct ct_exs *x, const struct ct_span *e, double xi)
{
    return ct_ex_add(x, e->start, ct_ex_scale(x, xi, e->length));
}

ct_ex ct_profile_at(struct ct_exs *x, const struct ct_profile *g, const struct ct_span *e,
                    double xi)
{
    const ct_ex at = place_at(x, e, xi);
    return ct_ex_subst(x, g->value, &g->x, &at, 1);
}

static bool is_constant(struct ct_exs *x, const struct ct_profile *g)
{
    return !(ct_ex_kinds(x, g->value) & 1u << CT_SYM_LOCAL);
}

// Sum of c_i/(i+1): over a common denominator, so that integer coefficients give the fraction
// rounded once.
static double unit_integral(const struct ct_shape *p)
{
    double sum = 0;
    for (int i = 0; i < CT_SHAPE_SIZE; i++)
        sum += p->c[i] * (common / (i + 1));
    return sum / common;
}

static ct_ex gauss_integral(struct ct_exs *x, const struct ct_profile *g,
                            const struct ct_shape *p, const struct ct_span *e)
{
    double xi[CT_MAX_GAUSS], w[CT_MAX_GAUSS];
    ct_ex sum = CT_EX_ZERO;
    ct_gauss(CT_MAX_GAUSS, xi, w);
    for (int i = 0; i < CT_MAX_GAUSS; i++)
        sum = ct_ex_add(
            x, sum, ct_ex_scale(x, w[i] * value_at(p, xi[i]), ct_profile_at(x, g, e, xi[i])));
    return sum;
}

ct_ex ct_shape_integral(struct ct_exs *x, const struct ct_profile *g, const struct ct_shape *p,
                        const struct ct_span *e, enum ct_rule rule)
{
    ct_ex sum;
    if (rule == CT_RULE_ENDS) {
        const double ends = 0.5 * (value_at(p, 0) + value_at(p, 1));
        return with_power(x,
                          ct_ex_scale(x, ends, ct_shape_integral(x, g, &one, e, CT_RULE_FULL)),
                          p->power, e->length);
    }
    if (rule == CT_RULE_MIDDLE)
        sum = ct_ex_scale(x, value_at(p, 0.5), ct_profile_at(x, g, e, 0.5));
    else if (is_constant(x, g))
        sum = ct_ex_scale(x, unit_integral(p), g->value);
    else
        sum = gauss_integral(x, g, p, e);
    return with_power(x, sum, p->power + 1, e->length);
}

int ct_shape_points(struct ct_exs *x, const struct ct_profile *g, const struct ct_span *e,
                    enum ct_rule rule, int n, double xi[CT_MAX_GAUSS],
                    ct_ex weight[CT_MAX_GAUSS])
{
    double w[CT_MAX_GAUSS] = {1};
    if (rule == CT_RULE_ENDS) {
        xi[0] = 0;
        xi[1] = 1;
        weight[0] = weight[1]
            = ct_ex_scale(x, 0.5, ct_shape_integral(x, g, &one, e, CT_RULE_FULL));
        return 2;
    }
    if (rule == CT_RULE_MIDDLE) {
        n = 1;
        xi[0] = 0.5;
    } else {
        ct_gauss(n, xi, w);
    }
    for (int i = 0; i < n; i++)
        weight[i]
            = ct_ex_mul(x, ct_ex_scale(x, w[i], ct_profile_at(x, g, e, xi[i])), e->length);
    return n;
}
