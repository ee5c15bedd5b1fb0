// Motion of the base of a beam, in axes of the beam; see beam_dynamics.h.
#include "formulate/beam_dynamics/beam_dynamics.h"

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

ct_ex3 ct_base_into(struct ct_build *b, const struct ct_flexible *f, ct_ex3 v)
{
    return ct_node_unturn(b, f->base, v);
}

ct_ex3 ct_base_out_of(struct ct_build *b, const struct ct_flexible *f, ct_ex3 v)
{
    return ct_node_turn(b, f->base, v);
}

// Angular velocity and acceleration in axes of the cluster. Possible if its parent is ground and
// its rotation axes are fixed in it; in a plane they are along the normal.
static bool plain_rates(struct ct_build *b, const struct ct_node_placement *p,
                        enum ct_level level, struct ct_base *out)
{
    struct ct_exs *x = b->x;
    ct_ex3 w, al;
    if (b->topology->is_planar) {
        out->w = ct_ex33_apply_t(x, &p->S, ct_cluster_velocity(b, p->frame));
        out->al = ct_ex33_apply_t(x, &p->S, ct_cluster_acceleration(b, p->frame, level));
        return true;
    }
    if (!ct_cluster_own_rates(b, p->frame, level, &w, &al))
        return false;
    out->w = ct_ex33_apply_t(x, &p->S, w);
    out->al = ct_ex33_apply_t(x, &p->S, al);
    return true;
}

struct ct_base ct_base_motion(struct ct_build *b, const struct ct_flexible *f,
                              enum ct_level level, ct_ex3 apparent)
{
    const struct ct_node_placement *p = &b->kinematics->placement[f->base];
    struct ct_base m = {.a = ct_base_into(b, f, apparent)};
    if (!plain_rates(b, p, level, &m)) {
        m.w = ct_base_into(b, f, ct_cluster_velocity(b, p->frame));
        m.al = ct_base_into(b, f, ct_cluster_acceleration(b, p->frame, level));
    }
    return m;
}

struct ct_base ct_flexible_base(struct ct_build *b, const struct ct_flexible *f,
                                enum ct_level level)
{
    const ct_ex3 a = ct_node_acceleration(b, f->base, level);
    return ct_base_motion(b, f, level, ct_ex3_sub(b->x, a, b->model->gravity));
}

void ct_flexible_base_motion(struct ct_build *b, const struct ct_flexible *f, ct_ex3 out[3])
{
    out[0] = ct_base_motion(b, f, CT_FULL, zero3).w;
    out[1] = ct_base_into(b, f, ct_node_velocity(b, f->base));
    out[2] = ct_base_into(b, f, b->model->gravity);
}

// al~ + w~ w~
ct_ex33 ct_base_acceleration_matrix(struct ct_build *b, const struct ct_base *m)
{
    struct ct_exs *x = b->x;
    ct_ex33 Om;
    ct_ex square[3];
    for (int i = 0; i < 3; i++)
        square[i] = ct_ex_mul(x, m->w.e[i], m->w.e[i]);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const ct_ex both = ct_ex_mul(x, m->w.e[i], m->w.e[j]);
        Om.e[4 * i] = ct_ex_neg(x, ct_ex_add(x, square[j], square[k]));
        Om.e[i + 3 * j] = ct_ex_sub(x, both, m->al.e[k]);
        Om.e[j + 3 * i] = ct_ex_add(x, both, m->al.e[k]);
    }
    return Om;
}

ct_ex3 ct_twice_cross(struct ct_build *b, ct_ex3 w, ct_ex3 v)
{
    return ct_ex3_scale(b->x, ct_ex_const(b->x, 2), ct_ex3_cross(b->x, w, v));
}

struct ct_base ct_flexible_effective_base(struct ct_build *b, const struct ct_flexible *f,
                                          const struct ct_base *m, ct_ex3 *force,
                                          ct_ex3 *torque)
{
    struct ct_base effective = *m;
    *force = *torque = zero3;
    if (!f->beam->lacks_quadratic)
        return effective;
    struct ct_exs *x = b->x;
    *force = ct_ex3_cross(x, m->w, ct_ex3_cross(x, m->w, f->inertia->moment));
    *torque = ct_ex3_cross(x, m->w, ct_ex33_apply(x, &f->inertia->inertia, m->w));
    effective.w = zero3;
    return effective;
}
