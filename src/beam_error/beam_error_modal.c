// See beam_error_modal.h.
#include "beam_error/beam_error_modal.h"
#include "base/pi.h"

#include <float.h>
#include <math.h>
#include <string.h>

// C = exp(-c h/2) cos(r h), S = exp(-c h/2) sin(r h)/r, r^2 = W - c^2/4, of any sign.
static void kernel(double h, double W, double c, double *C, double *S)
{
    const double r2 = W - 0.25 * c * c, r = sqrt(fabs(r2)),
                 decay = c != 0 ? exp(-0.5 * c * h) : 1;
    *C = decay * (r2 > 0 ? cos(r * h) : cosh(r * h));
    // Derived: (1e-8)^2 is below the unit round-off
    *S = decay * (r * h < 1e-8 ? h : (r2 > 0 ? sin(r * h) : sinh(r * h)) / r);
}

// int_0^h S from C and S at h. The closed form (1 - C - c S/2)/W cancels for short steps.
static double kernel_sum(double h, double W, double c, double C, double S)
{
    double C_half, S_half;
    // Derived: the first neglected term of the series is of order (W h^2)^2 = 1e-8
    if (fabs(W) * h * h > 1e-4)
        return (1 - C - 0.5 * c * S) / W;
    kernel(0.5 * h, W, c, &C_half, &S_half);
    return h / 6 * (4 * S_half + S);
}

// Exact solution of x'' + c x' + W x = F over h. x: x, x'.
static void step_linear(double x[2], double h, double W, double c, double F)
{
    double C, S;
    kernel(h, W, c, &C, &S);
    const double place = x[0], rate = x[1], sum = kernel_sum(h, W, c, C, S);
    x[0] = (C + 0.5 * c * S) * place + S * rate + sum * F;
    x[1] = -W * S * place + (C - 0.5 * c * S) * rate + S * F;
}

// x^2, bounded so that a diverging amplitude stays finite.
static double square(double x)
{
    // Limit: of a number whose square is finite
    const double most = 1e200;
    return fmin(x * x, most);
}

// Solve (1 + b x^2) x'' + c x' + W x + b x x'^2 + 2 g x^3 = F over h in pieces with nonlinear terms
// at their midpoints (second order). For small amplitudes and h of more than one piece, their mean
// over a period is used (averaging).
static void step_nonlinear(double x[2], double h, double W, double c, double F, double b,
                           double g)
{
    // Pieces per period, and in all. Derived: the midpoint rule errs by (2 pi/16)^2/24 = 0.6 % of
    // the nonlinear part. Limit: of time; four periods, where callers advance by an eighth of one.
    enum { PIECES = 16, MOST_PIECES = 64 };
    const int n = 1 + (int)fmin(MOST_PIECES - 1, h * sqrt(fabs(W)) * PIECES / (2 * CT_PI));
    // Derived: averaging neglects the square of the relative nonlinear part, 1e-6
    const double small = 1e-3, half = 0.5 * h / n,
                 amplitude2 = square(x[0]) + square(x[1]) / fmax(W, DBL_MIN);
    if (n > 1 && W > 0 && (b + 2 * g / W) * amplitude2 < small) {
        step_linear(x, h, W + (1.5 * g - 0.5 * b * W) * amplitude2, c, F);
        return;
    }
    for (int i = 0; i < n; i++) {
        const double q2 = square(x[0]), rising = F - c * x[1] - (W + 2 * g * q2) * x[0],
                     a = (rising - b * x[0] * square(x[1])) / (1 + b * q2),
                     rate = x[1] + half * a, m2 = square(x[0] + half * (x[1] + 0.5 * half * a)),
                     slow = 1 / (1 + b * m2);
        step_linear(x, 2 * half, slow * (W + b * square(rate) + 2 * g * m2), slow * c,
                    slow * F);
    }
}

double ct_beam_mode_steady_force(const struct ct_beam_mode *s, const double b[9])
{
    const bool is_z = s->is_z;
    const double *w = b, *v = b + 3;
    const double turned = is_z ? w[0] * v[1] - w[1] * v[0] : w[2] * v[0] - w[0] * v[2];
    const double weight = b[6 + (is_z ? 2 : 1)], centripetal = w[0] * w[is_z ? 2 : 1];
    return s->mass[0] * (weight - turned) - s->mass[1] * centripetal;
}

double ct_beam_mode_base_momentum(const struct ct_beam_mode *s, const double V[6])
{
    return s->is_z ? s->mass[0] * V[5] - s->mass[1] * V[1]
                   : s->mass[0] * V[4] + s->mass[1] * V[2];
}

double ct_beam_mode_softening(bool is_z, const double b[9])
{
    const double w = b[is_z ? 1 : 2];
    return b[0] * b[0] + w * w;
}

double ct_beam_mode_stiffening(const struct ct_beam_mode *s, const double b[9])
{
    const double *w = b, *v = b + 3;
    const double pull = w[1] * v[2] - w[2] * v[1] - b[6];
    return s->omega2
         * (s->eta_by_rate * (w[1] * w[1] + w[2] * w[2]) - s->eta_by_acceleration * pull);
}

// off (2) += deflection of a model at a place along the beam, by plane.
static void add_deflection(double off[2], const struct ct_beam_error_modal *s, int model,
                           int place)
{
    for (int i = 0; i < s->n; i++)
        off[s->shape[i].is_z] += s->shape[i].deflection[place] * s->x[model][i][0];
}

void ct_beam_error_modal_record(struct ct_beam_error_modal *s)
{
    for (int k = 0; k < CT_BEAM_MODE_STATIONS; k++) {
        double truth[2] = {0};
        add_deflection(truth, s, CT_BEAM_MODEL_EXACT, k);
        s->deflection = fmax(s->deflection, hypot(truth[0], truth[1]));
        for (int m = 0; m < CT_BEAM_MODEL_EXACT; m++) {
            double off[2] = {-truth[0], -truth[1]};
            add_deflection(off, s, m, k);
            s->error[m] = fmax(s->error[m], hypot(off[0], off[1]));
        }
    }
}

// Mean rotation of the base over a step h; for h = 0, w_x' is the jump of w_x.
static struct ct_beam_mode_base_rotation turn_of(const double from[9], const double to[9],
                                                 double h)
{
    const double jump = to[0] - from[0];
    return h > 0
             ? (struct ct_beam_mode_base_rotation){0.5 * (from[0] + to[0]), jump / h,
                                                   0.5 * (from[1] * from[2] + to[1] * to[2])}
             : (struct ct_beam_mode_base_rotation){.change = jump};
}

double ct_beam_mode_coupling(const struct ct_beam_error_modal *s, int i,
                             const struct ct_beam_mode_base_rotation *w,
                             const double other_plane[][2])
{
    const struct ct_beam_mode *shape = &s->shape[i];
    const double sign = shape->is_z ? -1 : 1;
    double F = 0;
    for (int j = 0; j < s->n; j++)
        F += shape->coupling[j]
           * (sign * (2 * w->rate * other_plane[j][1] + w->change * other_plane[j][0])
              - w->across * other_plane[j][0]);
    return F;
}

// Advance shape i of a model; other_plane: all shapes of each model.
static void move_shape(struct ct_beam_error_modal *s, int i, double h, const double to[9],
                       const struct ct_beam_mode_base_rotation *w,
                       double other_plane[][CT_BENDING_SHAPES][2])
{
    const struct ct_beam_mode *shape = &s->shape[i];
    const double given
        = ct_beam_mode_base_momentum(shape, s->base) - ct_beam_mode_base_momentum(shape, to);
    double joined[CT_BEAM_MODELS];
    for (int m = 0; m < CT_BEAM_MODELS; m++)
        joined[m] = ct_beam_mode_coupling(s, i, w, (const double(*)[2])other_plane[m]);
    if (h <= 0) {
        for (int m = 0; m < CT_BEAM_MODELS; m++)
            s->x[m][i][1] += given + joined[m];
        return;
    }
    const double F
        = given / h
        + 0.5
              * (ct_beam_mode_steady_force(shape, s->base)
                 + ct_beam_mode_steady_force(shape, to)),
        W = shape->omega2
          - 0.5
                * (ct_beam_mode_softening(shape->is_z, s->base)
                   + ct_beam_mode_softening(shape->is_z, to)),
        more
        = 0.5 * (ct_beam_mode_stiffening(shape, s->base) + ct_beam_mode_stiffening(shape, to))
        - shape->omega2 * shape->eta_by_acceleration * (to[3] - s->base[3]) / h;
    for (int m = 0; m < CT_BEAM_MODELS; m++)
        step_nonlinear(s->x[m][i], h, m == CT_BEAM_MODEL_LINEAR ? W : W + more, shape->damping,
                       F + joined[m], m == CT_BEAM_MODEL_LINEAR ? 0 : shape->shortening,
                       m == CT_BEAM_MODEL_EXACT ? shape->curvature : 0);
}

// Advance all shapes. If planes are coupled, twice: with the other plane at the start of the step,
// then with its mean over the step.
static void move_shapes(struct ct_beam_error_modal *s, double h, const double to[9])
{
    const struct ct_beam_mode_base_rotation w = turn_of(s->base, to, h);
    const bool meet = w.rate != 0 || w.change != 0 || w.across != 0;
    double other_plane[CT_BEAM_MODELS][CT_BENDING_SHAPES][2],
        start[CT_BEAM_MODELS][CT_BENDING_SHAPES][2];
    memcpy(start, s->x, sizeof start);
    memcpy(other_plane, s->x, sizeof other_plane);
    for (int pass = meet && h > 0 ? 0 : 1; pass < 2; pass++) {
        for (int i = 0; i < s->n; i++)
            move_shape(s, i, h, to, &w, other_plane);
        if (pass)
            continue;
        for (int m = 0; m < CT_BEAM_MODELS; m++)
            for (int i = 0; i < 2 * s->n; i++)
                other_plane[m][i / 2][i % 2]
                    = 0.5 * (start[m][i / 2][i % 2] + s->x[m][i / 2][i % 2]);
        memcpy(s->x, start, sizeof start);
    }
}

void ct_beam_error_modal_advance(struct ct_beam_error_modal *s, double t, const double base[9])
{
    if (s->has_begun)
        move_shapes(s, t - s->t, base);
    s->has_begun = true;
    s->t = t;
    memcpy(s->base, base, sizeof s->base);
    ct_beam_error_modal_record(s);
}

void ct_beam_error_modal_reset_base(struct ct_beam_error_modal *s, const double base[9])
{
    memcpy(s->base, base, sizeof s->base);
}

// Solve W x + 2 g x^3 = F by Newton's method from the start W x = F, which is too large: the
// iteration decreases monotonically.
static double static_amplitude(double W, double g, double F)
{
    // Limit: of the iterations of Newton's method
    enum { MOST = 60 };
    double x = F / W;
    for (int i = 0; i < MOST && g > 0 && W > 0; i++)
        x -= (W * x + 2 * g * x * x * x - F) / (W + 6 * g * x * x);
    return x;
}

void ct_beam_error_modal_start_static(struct ct_beam_error_modal *s)
{
    for (int i = 0; i < s->n; i++) {
        const struct ct_beam_mode *shape = &s->shape[i];
        const double F = ct_beam_mode_steady_force(shape, s->base),
                     W = shape->omega2 - ct_beam_mode_softening(shape->is_z, s->base),
                     more = ct_beam_mode_stiffening(shape, s->base);
        s->x[CT_BEAM_MODEL_LINEAR][i][0] = F / W;
        s->x[CT_BEAM_MODEL_FORESHORTENED][i][0] = F / (W + more);
        s->x[CT_BEAM_MODEL_EXACT][i][0] = static_amplitude(W + more, shape->curvature, F);
        for (int m = 0; m < CT_BEAM_MODELS; m++)
            s->x[m][i][1] = 0;
    }
    ct_beam_error_modal_record(s);
}

void ct_beam_error_modal_compare(struct ct_beam_error_modal *s, const double end[2])
{
    double off[2] = {-end[0], -end[1]};
    add_deflection(off, s, CT_BEAM_MODEL_LINEAR, CT_BEAM_MODE_STATIONS - 1);
    s->unexplained = fmax(s->unexplained, hypot(off[0], off[1]));
    s->end_deflection = fmax(s->end_deflection, hypot(end[0], end[1]));
}

double ct_beam_error_modal_error(const struct ct_beam_error_modal *s, enum ct_beam_model model)
{
    // The error of the part that the modes do not explain is at most that part, relative to the
    // largest deflection. Default: estimates against their accuracy. Test: beam_error_modal
    const double tolerated = 0.05;
    const bool is_followed
        = s->unexplained <= fmax(tolerated * s->end_deflection, s->error[CT_BEAM_MODEL_LINEAR]);
    return s->deflection > 0 && is_followed ? s->error[model] / s->deflection : NAN;
}
