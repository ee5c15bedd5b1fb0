// Composite bodies; see composite_body.h.
//
//     Q   ground -> leaves   w, al, a at u' = 0;   f = m a + A h,  A = U + al~,
//                            n = J al + w x J w + h x a
//         leaves -> ground   f, n minus loads, rotated and shifted;   Q_k = effort - s_k . (n, f)
//     M   leaves -> ground   mass, first moment, inertia of everything outboard as one rigid body
//         column of s_k      (n, f) = I s_k, moved inwards;        M_kl = s_l . (n, f)
#include "formulate/recursive/composite_body.h"

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

struct wrench {
    ct_ex3 n, f;
};

static struct wrench transfer_inwards(struct ct_build *b, const struct ct_member *m,
                                      struct wrench w)
{
    struct ct_exs *x = b->x;
    w.n = m->is_absolute ? zero3 : ct_member_out(b, m, w.n);
    w.f = ct_member_out(b, m, w.f);
    w.n = ct_ex3_add(x, w.n, ct_ex3_cross(x, m->r, w.f));
    return w;
}

static ct_ex power(struct ct_build *b, const struct ct_screw *s, const struct wrench *w)
{
    return ct_ex_add(b->x, ct_ex3_dot(b->x, s->rotation, w->n),
                     ct_ex3_dot(b->x, s->translation, w->f));
}

// ---- forces ------------------------------------------------------------------------------------

struct forward { // by member, in its axes
    enum ct_level level;
    ct_ex3 *al, *a; // of the origin
    ct_ex33 *A;     // al x v + w x (w x v) = A v
};

// Adds the contribution of u' to the relative acceleration of a member.
static void add_rates(struct ct_build *b, const struct ct_member *m, ct_ex3 *al, ct_ex3 *a)
{
    struct ct_exs *x = b->x;
    for (int k = 0; k < m->nfree; k++) {
        const struct ct_screw *s = &m->screw[k];
        const ct_ex rate = b->eqs->u[s->speed].derivative;
        *al = ct_ex3_add(x, *al, ct_ex3_scale(x, rate, s->rotation));
        *a = ct_ex3_add(x, *a, ct_ex3_scale(x, rate, s->translation));
    }
}

// U + al~
static ct_ex33 acceleration_matrix(struct ct_exs *x, const ct_ex33 *U, ct_ex3 al)
{
    ct_ex33 A = *U;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        A.e[k + 3 * j] = ct_ex_add(x, U->e[k + 3 * j], al.e[i]);
        A.e[j + 3 * k] = ct_ex_sub(x, U->e[j + 3 * k], al.e[i]);
    }
    return A;
}

static void accelerate(struct ct_build *b, const struct ct_members *s, int i, struct forward *w)
{
    struct ct_exs *x = b->x;
    const struct ct_member *m = &s->member[i];
    const int p = m->parent;
    const ct_ex3 shift
        = ct_ex3_add(x, ct_ex33_apply(x, &w->A[p], m->r), ct_member_slide_bias(b, s, i));
    w->al[i] = m->is_absolute ? m->al_relative
                              : ct_ex3_add(x, ct_member_in(b, m, w->al[p]), m->al_relative);
    w->a[i] = ct_member_in(b, m, ct_ex3_add(x, w->a[p], shift));
    if (w->level == CT_FULL)
        add_rates(b, m, &w->al[i], &w->a[i]);
    w->A[i] = acceleration_matrix(x, &m->U, w->al[i]);
}

static struct wrench inertia_wrench(struct ct_build *b, const struct ct_member *m, ct_ex3 al,
                                    ct_ex3 a, const ct_ex33 *A)
{
    struct ct_exs *x = b->x;
    struct wrench w;
    w.f = ct_ex3_add(x, ct_ex3_scale(x, m->mass, a), ct_ex33_apply(x, A, m->moment));
    w.f = ct_ex3_sub(x, w.f, m->force);
    w.n = ct_ex3_add(x, ct_ex33_apply(x, &m->J, al), ct_member_gyroscopic(b, m));
    w.n = ct_ex3_sub(x, ct_ex3_add(x, w.n, ct_ex3_cross(x, m->moment, a)), m->torque);
    return w;
}

// Inverse dynamics: generalised forces by speed, with u' = 0 or with the symbols u'.
static void find_efforts(struct ct_build *b, const struct ct_members *s, enum ct_level level,
                         ct_ex *out)
{
    struct ct_exs *x = b->x;
    struct forward f = {.level = level,
                        .al = CT_NEWN(b->arena, ct_ex3, s->n),
                        .a = CT_NEWN(b->arena, ct_ex3, s->n),
                        .A = CT_NEWN(b->arena, ct_ex33, s->n)};
    struct wrench *w = CT_NEWN(b->arena, struct wrench, s->n);
    f.a[0] = ct_members_gravity_acceleration(b);
    for (size_t i = 1; i < s->n; i++)
        accelerate(b, s, (int)i, &f);
    for (size_t i = s->n; i-- > 1;) {
        const struct ct_member *m = &s->member[i];
        const struct wrench own = inertia_wrench(b, m, f.al[i], f.a[i], &f.A[i]);
        w[i].n = ct_ex3_add(x, w[i].n, own.n);
        w[i].f = ct_ex3_add(x, w[i].f, own.f);
        for (int k = 0; k < m->nfree; k++)
            out[m->screw[k].speed] = power(b, &m->screw[k], &w[i]);
        if (!m->parent)
            continue;
        const struct wrench up = transfer_inwards(b, m, w[i]);
        w[m->parent].n = ct_ex3_add(x, w[m->parent].n, up.n);
        w[m->parent].f = ct_ex3_add(x, w[m->parent].f, up.f);
    }
}

void ct_composite_residual(struct ct_build *b, const struct ct_members *s, const ct_ex *effort,
                           ct_ex *r)
{
    find_efforts(b, s, CT_FULL, r);
    for (size_t k = b->eqs->nmotion; k < b->eqs->nu; k++)
        r[k] = b->eqs->u[k].derivative;
    for (size_t k = 0; k < b->eqs->nu; k++)
        r[k] = ct_ex_sub(b->x, r[k], effort[k]);
}

// ---- mass matrix -------------------------------------------------------------------------------

struct composite {
    ct_ex mass;
    ct_ex3 h;
    ct_ex33 J;
};

static void add(struct ct_build *b, struct composite *sum, ct_ex mass, ct_ex3 h,
                const ct_ex33 *J)
{
    sum->mass = ct_ex_add(b->x, sum->mass, mass);
    sum->h = ct_ex3_add(b->x, sum->h, h);
    for (int i = 0; i < 9; i++)
        sum->J.e[i] = ct_ex_add(b->x, sum->J.e[i], J->e[i]);
}

// J += 2 (r.h) 1 - r h' - h r', with h the mean of the first moments about both origins.
static void shift_inertia(struct ct_build *b, ct_ex33 *J, ct_ex3 r, ct_ex3 h)
{
    struct ct_exs *x = b->x;
    const ct_ex along[3] = {ct_ex_mul(x, r.e[0], h.e[0]), ct_ex_mul(x, r.e[1], h.e[1]),
                            ct_ex_mul(x, r.e[2], h.e[2])};
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const ct_ex other = ct_ex_scale(x, 2, ct_ex_add(x, along[j], along[k]));
        const ct_ex cross
            = ct_ex_add(x, ct_ex_mul(x, r.e[i], h.e[j]), ct_ex_mul(x, h.e[i], r.e[j]));
        J->e[i + 3 * i] = ct_ex_add(x, J->e[i + 3 * i], other);
        J->e[i + 3 * j] = J->e[j + 3 * i] = ct_ex_sub(x, J->e[i + 3 * j], cross);
    }
}

// Adds the composite inertia of a member to its parent.
static void add_to_parent(struct ct_build *b, const struct ct_member *m,
                          const struct composite *own, struct composite *parent)
{
    struct ct_exs *x = b->x;
    ct_ex33 J = {{{0}}};
    ct_ex3 h = zero3;
    const ct_ex3 carried = ct_ex3_scale(x, own->mass, m->r),
                 half = ct_ex3_scale(x, ct_ex_const(x, 0.5), carried);
    if (!m->is_absolute) { // otherwise it does not rotate with the parent: only its mass counts
        J = own->J;
        h = ct_member_out(b, m, own->h);
        ct_member_turn_tensor(b, m, &J);
    }
    shift_inertia(b, &J, m->r, ct_ex3_add(x, h, half));
    add(b, parent, own->mass, ct_ex3_add(x, h, carried), &J);
}

static void column(struct ct_build *b, const struct ct_members *s, const struct composite *own,
                   int i, const struct ct_screw *f, struct ct_symmetric *M)
{
    struct ct_exs *x = b->x;
    struct wrench w;
    w.n = ct_ex3_add(x, ct_ex33_apply(x, &own->J, f->rotation),
                     ct_ex3_cross(x, own->h, f->translation));
    w.f = ct_ex3_add(x, ct_ex3_scale(x, own->mass, f->translation),
                     ct_ex3_cross(x, f->rotation, own->h));
    for (; i; i = s->member[i].parent) {
        const struct ct_member *m = &s->member[i];
        for (int k = 0; k < m->nfree; k++) {
            *ct_symmetric_at(M, (size_t)f->speed, (size_t)m->screw[k].speed)
                = power(b, &m->screw[k], &w);
        }
        w = transfer_inwards(b, m, w);
    }
}

static void find_masses(struct ct_build *b, const struct ct_members *s, struct ct_symmetric *M)
{
    struct composite *body = CT_NEWN(b->arena, struct composite, s->n);
    for (size_t i = s->n; i-- > 1;) {
        const struct ct_member *m = &s->member[i];
        add(b, &body[i], m->mass, m->moment, &m->J);
        if (m->parent)
            add_to_parent(b, m, &body[i], &body[m->parent]);
    }
    for (size_t i = 1; i < s->n; i++)
        for (int k = 0; k < s->member[i].nfree; k++)
            column(b, s, &body[i], (int)i, &s->member[i].screw[k], M);
}

void ct_composite_derive(struct ct_build *b, const struct ct_members *s, const ct_ex *effort,
                         struct ct_symmetric *M, ct_ex *Q)
{
    find_masses(b, s, M);
    find_efforts(b, s, CT_BIAS, Q);
    for (size_t k = 0; k < b->eqs->nu; k++)
        Q[k] = ct_ex_sub(b->x, effort[k], Q[k]);
    for (size_t k = b->eqs->nmotion; k < b->eqs->nu; k++)
        *ct_symmetric_at(M, k, k) = CT_EX_ONE;
}
