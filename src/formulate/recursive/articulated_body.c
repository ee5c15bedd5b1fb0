// See articulated_body.h.
//
// A member and everything outboard of it, with free joints, form an articulated body:
//
//     [ n ]   [ J   B ] [ al ]   [ n0 ]
//     [ f ] = [ B'  M ] [ a  ] + [ f0 ]       at the member's origin, in its axes
//
// A joint coordinate along s transmits only its effort. With P = I s and D = s . P this gives u',
// and the reduced inertia is I - P P'/D. For s along a coordinate axis the row of that axis
// vanishes, and the result is the total acceleration along it instead of the relative u'.
//
// Elastic coordinates of beams: articulated_beam.h.
//
//     leaves -> ground   eliminate the joint coordinates, rotate and shift to the parent
//     ground -> leaves   a'' = acceleration due to the parent;  u' = (effort - s . f0 - P . a'')/D
#include "formulate/recursive/articulated_body.h"
#include "formulate/recursive/articulated_beam.h"

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// ---- the matrix of a body ----------------------------------------------------------------------

ct_ex ct_articulated_entry(const struct ct_articulated_body *k, int i, int j)
{
    if (i < 3)
        return j < 3 ? k->J.e[i + 3 * j] : k->B.e[i + 3 * (j - 3)];
    return j < 3 ? k->B.e[j + 3 * (i - 3)] : k->M.e[i - 3 + 3 * (j - 3)];
}

void ct_articulated_set(struct ct_articulated_body *k, int i, int j, ct_ex v)
{
    if (i < 3 && j < 3)
        k->J.e[i + 3 * j] = k->J.e[j + 3 * i] = v;
    else if (i >= 3 && j >= 3)
        k->M.e[i - 3 + 3 * (j - 3)] = k->M.e[j - 3 + 3 * (i - 3)] = v;
    else
        k->B.e[(i < 3 ? i : j) + 3 * ((i < 3 ? j : i) - 3)] = v;
}

ct_ex *ct_articulated_force(struct ct_articulated_body *k, int i)
{
    return i < 3 ? &k->n.e[i] : &k->f.e[i - 3];
}

ct_ex ct_screw_direction(const struct ct_screw *s, int i)
{
    return i < 3 ? s->rotation.e[i] : s->translation.e[i - 3];
}

// P = I s and D = s . P; axis: the coordinate axis of s, or -1.
ct_ex ct_articulated_project(struct ct_articulated *w, const struct ct_articulated_body *k,
                             const struct ct_screw *s, ct_ex P[CT_SPATIAL_SIZE])
{
    struct ct_exs *x = w->b->x;
    ct_ex D = CT_EX_ZERO;
    for (int i = 0; i < CT_SPATIAL_SIZE; i++) {
        P[i] = CT_EX_ZERO;
        for (int j = 0; j < CT_SPATIAL_SIZE; j++)
            P[i] = ct_ex_add(
                x, P[i], ct_ex_mul(x, ct_articulated_entry(k, i, j), ct_screw_direction(s, j)));
    }
    for (int i = 0; i < CT_SPATIAL_SIZE; i++)
        D = ct_ex_add(x, D, ct_ex_mul(x, P[i], ct_screw_direction(s, i)));
    return D;
}

// ---- leaves to ground --------------------------------------------------------------------------

// Adds the inertia of the member, n = J al + h x a, f = m a - h x al, its velocity-dependent forces
// and its loads.
static void add_own(struct ct_articulated *w, int i)
{
    struct ct_exs *x = w->b->x;
    const struct ct_member *m = &w->s->member[i];
    struct ct_articulated_body *k = &w->body[i];
    const ct_ex3 *h = &m->moment;
    for (int r = 0; r < 3; r++) {
        const int p = (r + 1) % 3, q = (r + 2) % 3;
        for (int c = 0; c <= r; c++)
            ct_articulated_set(k, r, c,
                               ct_ex_add(x, ct_articulated_entry(k, r, c), m->J.e[r + 3 * c]));
        if (!w->b->topology->is_planar || r < 2)
            ct_articulated_set(k, 3 + r, 3 + r,
                               ct_ex_add(x, ct_articulated_entry(k, 3 + r, 3 + r), m->mass));
        if (!w->b->topology->is_planar || r == 2) { // (h x a)_r = h_p a_q - h_q a_p
            ct_articulated_set(k, r, 3 + q,
                               ct_ex_add(x, ct_articulated_entry(k, r, 3 + q), h->e[p]));
            ct_articulated_set(k, r, 3 + p,
                               ct_ex_sub(x, ct_articulated_entry(k, r, 3 + p), h->e[q]));
        }
    }
    const ct_ex3 spin = ct_member_gyroscopic(w->b, m), pull = ct_ex33_apply(x, &m->U, *h);
    k->n = ct_ex3_add(x, k->n, ct_ex3_sub(x, spin, m->torque));
    k->f = ct_ex3_add(x, k->f, ct_ex3_sub(x, pull, m->force));
}

static void eliminate(struct ct_articulated *w, struct ct_articulated_body *k, int i,
                      const struct ct_screw *s)
{
    struct ct_exs *x = w->b->x;
    ct_ex P[CT_SPATIAL_SIZE], *G = k->G[i], rest = w->effort[s->speed];
    const ct_ex D = w->pivot[s->speed] = ct_articulated_project(w, k, s, P),
                g = ct_ex_div(x, CT_EX_ONE, D);
    for (int r = 0; r < CT_SPATIAL_SIZE; r++) {
        G[r] = r == s->axis ? CT_EX_ONE : ct_ex_mul(x, P[r], g);
        rest = ct_ex_sub(x, rest,
                         ct_ex_mul(x, ct_screw_direction(s, r), *ct_articulated_force(k, r)));
    }
    k->u0[i] = ct_ex_mul(x, rest, g);
    for (int r = 0; r < CT_SPATIAL_SIZE; r++) {
        const bool own = r == s->axis;
        for (int c = 0; c <= r; c++)
            ct_articulated_set(k, r, c,
                               own || c == s->axis ? CT_EX_ZERO
                                                   : ct_ex_sub(x, ct_articulated_entry(k, r, c),
                                                               ct_ex_mul(x, G[r], P[c])));
        *ct_articulated_force(k, r)
            = own ? ct_ex_mul(x, w->effort[s->speed], ct_screw_direction(s, r))
                  : ct_ex_add(x, *ct_articulated_force(k, r), ct_ex_mul(x, P[r], k->u0[i]));
    }
}

static void add_tensor(struct ct_exs *x, ct_ex33 *sum, const ct_ex33 *A)
{
    for (int i = 0; i < 9; i++)
        sum->e[i] = ct_ex_add(x, sum->e[i], A->e[i]);
}

// Adds the wrench of known accelerations: n += J al + B a, f += B' al + M a.
static void add_bias(struct ct_exs *x, struct ct_articulated_body *k, ct_ex3 al, ct_ex3 a)
{
    k->n = ct_ex3_add(x, k->n,
                      ct_ex3_add(x, ct_ex33_apply(x, &k->J, al), ct_ex33_apply(x, &k->B, a)));
    k->f = ct_ex3_add(x, k->f,
                      ct_ex3_add(x, ct_ex33_apply_t(x, &k->B, al), ct_ex33_apply(x, &k->M, a)));
}

static void turn(struct ct_articulated *w, const struct ct_member *m,
                 struct ct_articulated_body *k)
{
    ct_member_turn_tensor(w->b, m, &k->J);
    ct_member_turn_tensor(w->b, m, &k->B);
    ct_member_turn_tensor(w->b, m, &k->M);
    k->n = ct_member_out(w->b, m, k->n);
    k->f = ct_member_out(w->b, m, k->f);
}

// Shifts to a new origin; r is the vector from it to the present one:  C = B + r~ M,  J + r~ B' +
// (r~ C')',  n + r x f.
static void shift(struct ct_articulated *w, struct ct_articulated_body *k, ct_ex3 r)
{
    struct ct_exs *x = w->b->x;
    ct_ex33 C = k->B;
    k->n = ct_ex3_add(x, k->n, ct_ex3_cross(x, r, k->f));
    for (int c = 0; c < 3; c++) {
        const ct_ex3 column = {{k->M.e[3 * c], k->M.e[3 * c + 1], k->M.e[3 * c + 2]}},
                     moved = ct_ex3_cross(x, r, column);
        for (int i = 0; i < 3; i++)
            C.e[i + 3 * c] = ct_ex_add(x, C.e[i + 3 * c], moved.e[i]);
    }
    for (int j = 0; j < 3; j++) {
        const ct_ex3 row = {{k->B.e[j], k->B.e[j + 3], k->B.e[j + 6]}},
                     new_row = {{C.e[j], C.e[j + 3], C.e[j + 6]}};
        const ct_ex3 of_row = ct_ex3_cross(x, r, row), of_new = ct_ex3_cross(x, r, new_row);
        // entry (i, j) gets (r~ B')_ij and (r~ C')_ji: both columns j, into the lower triangle
        for (int i = 0; i < 3; i++) {
            if (i >= j)
                k->J.e[i + 3 * j] = ct_ex_add(x, k->J.e[i + 3 * j], of_row.e[i]);
            if (i <= j)
                k->J.e[j + 3 * i] = ct_ex_add(x, k->J.e[j + 3 * i], of_new.e[i]);
        }
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < i; j++)
            k->J.e[j + 3 * i] = k->J.e[i + 3 * j];
    k->B = C;
}

static void transfer_inwards(struct ct_articulated *w, int i)
{
    struct ct_exs *x = w->b->x;
    const struct ct_member *m = &w->s->member[i];
    struct ct_articulated_body k = w->body[i], *p = &w->body[m->parent];
    if (m->beam && i != w->s->beam[m->beam - 1].root)
        ct_articulated_beam_transfer(w, i);
    add_bias(x, &k, m->al_relative, zero3);
    if (m->is_absolute) { // the torque acts on ground
        k.n = zero3;
        k.J = k.B = (ct_ex33){{{0}}};
    }
    turn(w, m, &k);
    add_bias(x, &k, zero3, ct_member_shift_bias(w->b, w->s, i));
    shift(w, &k, m->r);
    add_tensor(x, &p->J, &k.J);
    add_tensor(x, &p->B, &k.B);
    add_tensor(x, &p->M, &k.M);
    p->n = ct_ex3_add(x, p->n, k.n);
    p->f = ct_ex3_add(x, p->f, k.f);
}

// ---- ground to leaves --------------------------------------------------------------------------

static void accelerate(struct ct_articulated *w, int i, ct_ex *out)
{
    struct ct_exs *x = w->b->x;
    const struct ct_member *m = &w->s->member[i];
    struct ct_articulated_body *k = &w->body[i];
    const struct ct_articulated_body *p = &w->body[m->parent];
    const ct_ex3 shifted
        = ct_ex3_add(x, ct_ex3_cross(x, p->al, m->r), ct_member_shift_bias(w->b, w->s, i));
    k->al = m->is_absolute ? m->al_relative
                           : ct_ex3_add(x, ct_member_in(w->b, m, p->al), m->al_relative);
    k->a = ct_member_in(w->b, m, ct_ex3_add(x, p->a, shifted));
    if (m->beam) {
        ct_articulated_beam_accelerate(w, i, out);
        return;
    }
    for (int j = m->nfree; j-- > 0;) {
        const struct ct_screw *s = &m->screw[j];
        ct_ex v[CT_SPATIAL_SIZE], u = k->u0[j];
        for (int r = 0; r < CT_SPATIAL_SIZE; r++) {
            v[r] = r < 3 ? k->al.e[r] : k->a.e[r - 3];
            if (r != s->axis)
                u = ct_ex_sub(x, u, ct_ex_mul(x, k->G[j][r], v[r]));
        }
        if (s->axis >= 0) {
            ct_ex *now = s->axis < 3 ? &k->al.e[s->axis] : &k->a.e[s->axis - 3];
            const ct_ex along = ct_screw_direction(s, s->axis); // 1 or -1
            *now = ct_ex_mul(x, along, u);
            out[s->speed] = ct_ex_mul(x, along, ct_ex_sub(x, *now, v[s->axis]));
            continue;
        }
        out[s->speed] = u;
        k->al = ct_ex3_add(x, k->al, ct_ex3_scale(x, u, s->rotation));
        k->a = ct_ex3_add(x, k->a, ct_ex3_scale(x, u, s->translation));
    }
}

ct_ex *ct_articulated_solve(struct ct_build *b, const struct ct_members *s, const ct_ex *effort,
                            ct_ex *pivot)
{
    struct ct_arena *work = ct_arena_create_under(b->ctx->scratch);
    struct ct_articulated w = {.b = b, .work = work, .s = s, .effort = effort, .pivot = pivot};
    ct_ex *out = CT_NEWN(b->arena, ct_ex, b->eqs->nu + 1);
    w.body = CT_NEWN(work, struct ct_articulated_body, s->n);
    w.elastic = CT_NEWN(work, struct ct_articulated_beam, s->nbeam + 1);
    for (size_t i = 0; i < s->nbeam; i++)
        ct_articulated_beam_start(&w, i);
    w.row = CT_NEWN(work, ct_ex, b->eqs->nu + 1);
    for (size_t i = s->n; i-- > 1;) {
        const struct ct_member *m = &s->member[i];
        add_own(&w, (int)i);
        if (m->beam)
            ct_articulated_beam_sum(&w, (int)i);
        for (int k = 0; k < m->nfree && !m->beam; k++)
            eliminate(&w, &w.body[i], k, &m->screw[k]);
        if (m->parent)
            transfer_inwards(&w, (int)i);
    }
    w.body[0].a = ct_members_gravity_acceleration(b);
    for (size_t i = 1; i < s->n; i++)
        accelerate(&w, (int)i, out);
    for (size_t k = b->eqs->nmotion; k < b->eqs->nu; k++) {
        out[k] = effort[k];
        pivot[k] = CT_EX_ONE;
    }
    ct_arena_destroy(work);
    return out;
}
