// See swing.h.
#include "formulate/swing.h"

#include <math.h>
#include <string.h>

// int_0^h of C and S, and their values: C = exp(-c h/2) cos(r h), S = exp(-c h/2) sin(r h)/r, r^2 = W - c^2/4, of any sign.
static void kernel(double h, double W, double c, double *C, double *S)
{
    const double r2 = W - 0.25 * c * c, r = sqrt(fabs(r2)), decay = exp(-0.5 * c * h);
    *C = decay * (r2 > 0 ? cos(r * h) : cosh(r * h));
    *S = decay * (r * h < 1e-8 ? h : (r2 > 0 ? sin(r * h) : sinh(r * h)) / r);
}

// x'' + c x' + W x = F over h, exactly. x: x, x'
static void swing(double x[2], double h, double W, double c, double F)
{
    double C, S, C_half, S_half;
    kernel(h, W, c, &C, &S);
    kernel(0.5 * h, W, c, &C_half, &S_half);
    // int_0^h S: (1 - C - c S/2)/W, which cancels where the step is short
    const double sum
        = fabs(W) * h * h > 1e-4 ? (1 - C - 0.5 * c * S) / W : h / 6 * (4 * S_half + S);
    const double place = x[0], rate = x[1];
    x[0] = (C + 0.5 * c * S) * place + S * rate + sum * F;
    x[1] = -W * S * place + (C - 0.5 * c * S) * rate + S * F;
}

// What drives x, in terms that do not jump with velocities: F less the push of the base's momentum.
static double steady_force(const struct ct_swing *s, bool is_z, const double b[9])
{
    const double *w = b, *v = b + 3;
    const double turned = is_z ? w[0] * v[1] - w[1] * v[0] : w[2] * v[0] - w[0] * v[2];
    const double weight = b[6 + (is_z ? 2 : 1)], swept = w[0] * w[is_z ? 2 : 1];
    return s->mass[0] * (weight - turned) - s->mass[1] * swept;
}

// The momentum that the base gives the shape.
static double push(const struct ct_swing *s, bool is_z, const double b[9])
{
    return is_z ? s->mass[0] * b[5] - s->mass[1] * b[1] : s->mass[0] * b[4] + s->mass[1] * b[2];
}

// w^2 about axes across the displacement.
static double softening(bool is_z, const double b[9])
{
    const double w = b[is_z ? 1 : 2];
    return b[0] * b[0] + w * w;
}

// omega^2 eta, without the part of v_x'.
static double stiffening(const struct ct_swing *s, const double b[9])
{
    const double *w = b, *v = b + 3;
    const double pull = w[1] * v[2] - w[2] * v[1] - b[6];
    return s->omega2 * (s->turning * (w[1] * w[1] + w[2] * w[2]) - s->axial * pull);
}

static void note(struct ct_swings *s)
{
    double error = 0, deflection = 0;
    for (int i = 0; i < s->n; i++) {
        error = hypot(error, s->linear[i][0] - s->stiffened[i][0]);
        deflection = hypot(deflection, s->stiffened[i][0]);
    }
    s->error = fmax(s->error, error);
    s->deflection = fmax(s->deflection, deflection);
}

static void move_plane(struct ct_swings *s, int i, double h, const double to[9])
{
    const struct ct_swing *shape = &s->shape[i];
    const bool is_z = s->is_z[i];
    const double given = push(shape, is_z, s->base) - push(shape, is_z, to);
    if (h <= 0) {
        s->linear[i][1] += given;
        s->stiffened[i][1] += given;
        return;
    }
    const double F = given / h
                   + 0.5 * (steady_force(shape, is_z, s->base) + steady_force(shape, is_z, to)),
                 W = shape->omega2 - 0.5 * (softening(is_z, s->base) + softening(is_z, to)),
                 more = 0.5 * (stiffening(shape, s->base) + stiffening(shape, to))
                      - shape->omega2 * shape->axial * (to[3] - s->base[3]) / h;
    swing(s->linear[i], h, W, shape->damping, F);
    swing(s->stiffened[i], h, W + more, shape->damping, F);
}

void ct_swings_follow(struct ct_swings *s, double t, const double base[9])
{
    for (int i = 0; i < s->n && s->has_begun; i++)
        move_plane(s, i, t - s->t, base);
    s->has_begun = true;
    s->t = t;
    memcpy(s->base, base, sizeof s->base);
    note(s);
}

void ct_swings_regrip(struct ct_swings *s, const double base[9])
{
    memcpy(s->base, base, sizeof s->base);
}

void ct_swings_settle(struct ct_swings *s)
{
    for (int i = 0; i < s->n; i++) {
        const double F = steady_force(&s->shape[i], s->is_z[i], s->base),
                     W = s->shape[i].omega2 - softening(s->is_z[i], s->base);
        s->linear[i][0] = F / W;
        s->stiffened[i][0] = F / (W + stiffening(&s->shape[i], s->base));
        s->linear[i][1] = s->stiffened[i][1] = 0;
    }
    note(s);
}

double ct_swings_error(const struct ct_swings *s)
{
    return s->deflection > 0 ? s->error / s->deflection : NAN;
}
