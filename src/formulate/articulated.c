// See articulated.h.
//
// What hangs on a member, its joints free to move, acts on it like one body that has no single mass:
//
//     [ n ]   [ J   B ] [ al ]   [ n0 ]
//     [ f ] = [ B'  M ] [ a  ] + [ f0 ]       at the member's origin, in its axes
//
// A freedom along s transmits its effort only: with P = I s, D = s . P this is solved for its u', and what is left
// of I is I - P P'/D. Of a freedom along one coordinate axis the row of that axis vanishes, and its result is the
// acceleration itself instead of the difference u'.
//
// Elastic coordinates e of a beam move several members. Those that lie outboard of the base, and the base, are summed first:
// on the way inwards what hangs on a member also feels their accelerations, n, f += C e'', and its forces act on their rows,
//
//     M e'' + C' (al, a) + row = effort,    at a member they move by s:  M += s' I s + s' C + C' s,  row += s . f0,  C += I s
//
// and at the innermost of these members they are eliminated one by one, from the tip of the beam inwards.
//
//     leaves -> ground   eliminate the freedoms, turn and shift to the parent
//     ground -> leaves   a'' = what the parent hands on;  u' = (effort - s . f0 - P . a'')/D
#include "formulate/articulated.h"
#include "formulate/elastic.h"

enum { N = 6 }; // al, a or n, f

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// A wrench n, f or a motion al, a.
struct six {
    ct_ex e[N];
};

struct body {
    ct_ex33 J, B, M;
    ct_ex3 n, f;
    // of each freedom of a joint, in the order of elimination
    ct_ex G[CT_MAX_COORD][N]; // P/D
    ct_ex u0[CT_MAX_COORD];   // (effort - s . f0)/D
    ct_ex3 al, a;             // accelerations
    struct six *C;            // of a beam's member, by elastic coordinate
};

// Elastic coordinates of a beam (n).
struct elastic {
    const struct ct_flexible *f;
    int n;
    int *number;   // by speed: its place, or -1
    ct_ex *M;      // n x n, lower triangle; eliminated: entries over the pivot
    ct_ex *row;    // then what is left of the effort, over the pivot
    struct six *G; // C over the pivot
    ct_ex *a;      // e''
};

struct sweep {
    struct ct_build *b;
    const struct ct_members *s;
    const ct_ex *effort;
    ct_ex *pivot;
    struct body *body;
    struct elastic *elastic; // by beam
    ct_ex *M, *row;          // of all beams alone, by speed: lower triangle (nu x nu), (nu)
};

// ---- entries of the matrix ------------------------------------------------------------------------------

static ct_ex entry(const struct body *k, int i, int j)
{
    if (i < 3)
        return j < 3 ? k->J.e[i + 3 * j] : k->B.e[i + 3 * (j - 3)];
    return j < 3 ? k->B.e[j + 3 * (i - 3)] : k->M.e[i - 3 + 3 * (j - 3)];
}

static void set_entry(struct body *k, int i, int j, ct_ex v)
{
    if (i < 3 && j < 3)
        k->J.e[i + 3 * j] = k->J.e[j + 3 * i] = v;
    else if (i >= 3 && j >= 3)
        k->M.e[i - 3 + 3 * (j - 3)] = k->M.e[j - 3 + 3 * (i - 3)] = v;
    else
        k->B.e[(i < 3 ? i : j) + 3 * ((i < 3 ? j : i) - 3)] = v;
}

static ct_ex *force(struct body *k, int i)
{
    return i < 3 ? &k->n.e[i] : &k->f.e[i - 3];
}

static ct_ex force_of(const struct body *k, int i)
{
    return i < 3 ? k->n.e[i] : k->f.e[i - 3];
}

static ct_ex direction(const struct ct_screw *s, int i)
{
    return i < 3 ? s->turn.e[i] : s->slide.e[i - 3];
}

// ---- leaves to ground -----------------------------------------------------------------------------------

// The member's own inertia: n = J al + h x a, f = m a - h x al, and what its velocity and loads need.
static void add_own(struct sweep *w, int i)
{
    struct ct_exs *x = w->b->x;
    const struct ct_member *m = &w->s->member[i];
    struct body *k = &w->body[i];
    const ct_ex3 *h = &m->moment;
    for (int r = 0; r < 3; r++) {
        const int p = (r + 1) % 3, q = (r + 2) % 3;
        for (int c = 0; c <= r; c++)
            set_entry(k, r, c, ct_ex_add(x, entry(k, r, c), m->J.e[r + 3 * c]));
        if (!w->b->is_planar || r < 2)
            set_entry(k, 3 + r, 3 + r, ct_ex_add(x, entry(k, 3 + r, 3 + r), m->mass));
        if (!w->b->is_planar || r == 2) { // (h x a)_r = h_p a_q - h_q a_p
            set_entry(k, r, 3 + q, ct_ex_add(x, entry(k, r, 3 + q), h->e[p]));
            set_entry(k, r, 3 + p, ct_ex_sub(x, entry(k, r, 3 + p), h->e[q]));
        }
    }
    const ct_ex3 spin = ct_member_gyroscopic(w->b, m), pull = ct_ex33_apply(x, &m->U, *h);
    k->n = ct_ex3_add(x, k->n, ct_ex3_sub(x, spin, m->torque));
    k->f = ct_ex3_add(x, k->f, ct_ex3_sub(x, pull, m->force));
}

// P = I s and D = s . P; axis: the one s points along, or -1.
static ct_ex project(struct sweep *w, const struct body *k, const struct ct_screw *s,
                     ct_ex P[N])
{
    struct ct_exs *x = w->b->x;
    ct_ex D = CT_EX_ZERO;
    for (int i = 0; i < N; i++) {
        P[i] = CT_EX_ZERO;
        for (int j = 0; j < N; j++)
            P[i] = ct_ex_add(x, P[i], ct_ex_mul(x, entry(k, i, j), direction(s, j)));
    }
    for (int i = 0; i < N; i++)
        D = ct_ex_add(x, D, ct_ex_mul(x, P[i], direction(s, i)));
    return D;
}

static void eliminate(struct sweep *w, struct body *k, int i, const struct ct_screw *s)
{
    struct ct_exs *x = w->b->x;
    ct_ex P[N], *G = k->G[i], rest = w->effort[s->speed];
    const ct_ex D = w->pivot[s->speed] = project(w, k, s, P), g = ct_ex_div(x, CT_EX_ONE, D);
    for (int r = 0; r < N; r++) {
        G[r] = r == s->axis ? CT_EX_ONE : ct_ex_mul(x, P[r], g);
        rest = ct_ex_sub(x, rest, ct_ex_mul(x, direction(s, r), *force(k, r)));
    }
    k->u0[i] = ct_ex_mul(x, rest, g);
    for (int r = 0; r < N; r++) {
        const bool own = r == s->axis;
        for (int c = 0; c <= r; c++)
            set_entry(k, r, c,
                      own || c == s->axis
                          ? CT_EX_ZERO
                          : ct_ex_sub(x, entry(k, r, c), ct_ex_mul(x, G[r], P[c])));
        *force(k, r) = own ? ct_ex_mul(x, w->effort[s->speed], direction(s, r))
                           : ct_ex_add(x, *force(k, r), ct_ex_mul(x, P[r], k->u0[i]));
    }
}

static void add_tensor(struct ct_exs *x, ct_ex33 *sum, const ct_ex33 *A)
{
    for (int i = 0; i < 9; i++)
        sum->e[i] = ct_ex_add(x, sum->e[i], A->e[i]);
}

// ---- beams ----------------------------------------------------------------------------------------------

static ct_ex product(struct ct_exs *x, const ct_ex *v, const ct_ex *w)
{
    ct_ex sum = CT_EX_ZERO;
    for (int r = 0; r < N; r++)
        sum = ct_ex_add(x, sum, ct_ex_mul(x, v[r], w[r]));
    return sum;
}

static bool is_zero(const ct_ex *v)
{
    for (int r = 0; r < N; r++)
        if (!ct_ex_is_zero(v[r]))
            return false;
    return true;
}

static ct_ex *entry_of(struct elastic *e, int k, int l)
{
    return k > l ? &e->M[k + e->n * l] : &e->M[l + e->n * k];
}

static void start_beam(struct sweep *w, size_t i)
{
    struct ct_build *b = w->b;
    struct elastic *e = &w->elastic[i];
    const struct ct_flexible *f = e->f = &b->flexible[i];
    const size_t n = (size_t)f->nelastic;
    e->n = f->nelastic;
    e->number = CT_NEWN(b->arena, int, b->eqs->nu + 1);
    for (size_t k = 0; k < b->eqs->nu; k++)
        e->number[k] = -1;
    for (int k = 0; k < e->n; k++)
        e->number[f->elastic[k].u] = k;
    e->M = CT_NEWN(b->arena, ct_ex, n * n + 1);
    e->row = CT_NEWN(b->arena, ct_ex, n + 1);
    e->a = CT_NEWN(b->arena, ct_ex, n + 1);
    e->G = CT_NEWN(b->arena, struct six, n + 1);
}

// The beam's own inertia, stiffness and damping at its base, and what its velocity needs; in the member's axes.
static void add_beam(struct sweep *w, int i, struct elastic *e, const ct_ex33 *A)
{
    struct ct_build *b = w->b;
    struct ct_exs *x = b->x;
    const struct ct_flexible *f = e->f;
    const struct ct_inertia *I = f->inertia;
    struct body *k = &w->body[i];
    const size_t nu = b->eqs->nu;
    struct ct_columns c = {CT_NEWN(b->ctx->scratch, ct_ex3, e->n + 1),
                           CT_NEWN(b->ctx->scratch, ct_ex3, e->n + 1)};
    const struct ct_base motion = {.w = ct_ex33_apply_t(x, A, w->s->member[i].w)};
    ct_ex3 F, T;
    I->form->wrench(b, f, &motion, CT_BIAS, &F, &T);
    I->form->rows(b, f, &motion, CT_BIAS, w->row);
    ct_stiffness_rows(b, f, w->row);
    I->form->mass(b, f, &c, w->M);
    k->n = ct_ex3_add(x, k->n, ct_ex33_apply(x, A, T));
    k->f = ct_ex3_add(x, k->f, ct_ex33_apply(x, A, F));
    for (int j = 0; j < e->n; j++) {
        const size_t u = (size_t)f->elastic[j].u;
        const ct_ex3 swept = ct_ex33_apply(x, A, c.swept[j]),
                     moved = ct_ex33_apply(x, A, c.moved[j]);
        for (int r = 0; r < N; r++)
            k->C[j].e[r] = ct_ex_add(x, k->C[j].e[r], r < 3 ? swept.e[r] : moved.e[r - 3]);
        e->row[j] = ct_ex_add(x, e->row[j], w->row[u]);
        for (int l = 0; l <= j; l++) {
            const size_t v = (size_t)f->elastic[l].u;
            ct_ex *to = entry_of(e, j, l);
            *to = ct_ex_add(x, *to, w->M[u > v ? u + nu * v : v + nu * u]);
        }
    }
}

// Elastic coordinates that move this member.
static void add_screws(struct sweep *w, int i, struct elastic *e)
{
    struct ct_exs *x = w->b->x;
    const struct ct_member *m = &w->s->member[i];
    struct body *k = &w->body[i];
    struct six *P = CT_NEWN(w->b->ctx->scratch, struct six, m->nfree + 1),
               *S = CT_NEWN(w->b->ctx->scratch, struct six, m->nfree + 1);
    for (int j = 0; j < m->nfree; j++) {
        const int own = e->number[m->screw[j].speed];
        project(w, k, &m->screw[j], P[j].e);
        for (int r = 0; r < N; r++) {
            S[j].e[r] = direction(&m->screw[j], r);
            e->row[own] = ct_ex_add(x, e->row[own], ct_ex_mul(x, S[j].e[r], force_of(k, r)));
        }
        for (int l = 0; l < e->n; l++) {
            const ct_ex v = product(x, S[j].e, k->C[l].e);
            ct_ex *to = entry_of(e, own, l);
            *to = ct_ex_add(x, *to, l == own ? ct_ex_scale(x, 2, v) : v);
        }
        for (int l = 0; l <= j; l++) {
            ct_ex *to = entry_of(e, own, e->number[m->screw[l].speed]);
            *to = ct_ex_add(x, *to, product(x, S[l].e, P[j].e));
        }
    }
    for (int j = 0; j < m->nfree; j++) {
        ct_ex *C = k->C[e->number[m->screw[j].speed]].e;
        for (int r = 0; r < N; r++)
            C[r] = ct_ex_add(x, C[r], P[j].e[r]);
    }
}

// What is left of the member's matrix when e'' number j is free to be what it likes.
static void free_coordinate(struct sweep *w, struct body *k, struct elastic *e, int j)
{
    struct ct_exs *x = w->b->x;
    const int speed = e->f->elastic[j].u;
    const ct_ex D = w->pivot[speed] = e->M[j + e->n * j], g = ct_ex_div(x, CT_EX_ONE, D);
    const ct_ex rest = e->row[j];
    e->row[j] = ct_ex_mul(x, rest, g);
    for (int r = 0; r < N; r++)
        e->G[j].e[r] = ct_ex_mul(x, k->C[j].e[r], g);
    for (int l = j; l-- > 0;) {
        ct_ex *at = &e->M[j + e->n * l];
        if (ct_ex_is_zero(*at))
            continue;
        const ct_ex a = ct_ex_mul(x, *at, g);
        for (int i = 0; i <= l; i++)
            e->M[l + e->n * i]
                = ct_ex_sub(x, e->M[l + e->n * i], ct_ex_mul(x, a, e->M[j + e->n * i]));
        for (int r = 0; r < N; r++)
            k->C[l].e[r] = ct_ex_sub(x, k->C[l].e[r], ct_ex_mul(x, a, k->C[j].e[r]));
        e->row[l] = ct_ex_sub(x, e->row[l], ct_ex_mul(x, a, rest));
        *at = a;
    }
    for (int r = 0; r < N; r++) {
        for (int c = 0; c <= r; c++)
            set_entry(k, r, c,
                      ct_ex_sub(x, entry(k, r, c), ct_ex_mul(x, e->G[j].e[r], k->C[j].e[c])));
        *force(k, r) = ct_ex_add(x, *force(k, r), ct_ex_mul(x, k->C[j].e[r], e->row[j]));
    }
}

static void eliminate_beam(struct sweep *w, int i, struct elastic *e)
{
    struct ct_exs *x = w->b->x;
    for (int j = 0; j < e->n; j++)
        e->row[j] = ct_ex_sub(x, w->effort[e->f->elastic[j].u], e->row[j]);
    for (int j = e->n; j-- > 0;)
        free_coordinate(w, &w->body[i], e, j);
}

static void sum_beam(struct sweep *w, int i)
{
    const int number = w->s->member[i].beam - 1;
    const struct ct_member_beam *at = &w->s->beam[number];
    struct elastic *e = &w->elastic[number];
    struct body *k = &w->body[i];
    if (!k->C)
        k->C = CT_NEWN(w->b->arena, struct six, e->n + 1);
    if (i == at->base)
        add_beam(w, i, e, &at->A);
    add_screws(w, i, e);
    if (i == at->root)
        eliminate_beam(w, i, e);
}

// Accelerations of the elastic coordinates from that of the root, its own motion by them left out.
static void accelerate_beam(struct sweep *w, const struct body *root, struct elastic *e,
                            ct_ex *out)
{
    struct ct_exs *x = w->b->x;
    ct_ex A[N];
    for (int r = 0; r < N; r++)
        A[r] = r < 3 ? root->al.e[r] : root->a.e[r - 3];
    for (int j = 0; j < e->n; j++) {
        e->a[j] = ct_ex_sub(x, e->row[j], product(x, e->G[j].e, A));
        for (int l = 0; l < j; l++)
            e->a[j] = ct_ex_sub(x, e->a[j], ct_ex_mul(x, e->M[j + e->n * l], e->a[l]));
        out[e->f->elastic[j].u] = e->a[j];
    }
}

// f and n that accelerations known beforehand take: n += J al + B a, f += B' al + M a.
static void add_bias(struct ct_exs *x, struct body *k, ct_ex3 al, ct_ex3 a)
{
    k->n = ct_ex3_add(x, k->n,
                      ct_ex3_add(x, ct_ex33_apply(x, &k->J, al), ct_ex33_apply(x, &k->B, a)));
    k->f = ct_ex3_add(x, k->f,
                      ct_ex3_add(x, ct_ex33_apply_t(x, &k->B, al), ct_ex33_apply(x, &k->M, a)));
}

static void turn(struct sweep *w, const struct ct_member *m, struct body *k)
{
    ct_member_turn_tensor(w->b, m, &k->J);
    ct_member_turn_tensor(w->b, m, &k->B);
    ct_member_turn_tensor(w->b, m, &k->M);
    k->n = ct_member_out(w->b, m, k->n);
    k->f = ct_member_out(w->b, m, k->f);
}

// To an origin from which the present one is at r:  C = B + r~ M,  J + r~ B' + (r~ C')',  n + r x f.
static void shift(struct sweep *w, struct body *k, ct_ex3 r)
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

// C on its way to the parent, with the rows of what is known of the accelerations.
static void hand_columns(struct sweep *w, int i, const struct elastic *e)
{
    struct ct_exs *x = w->b->x;
    const struct ct_member *m = &w->s->member[i];
    const ct_ex3 bias = ct_member_shift_bias(w->b, w->s, i);
    struct body *p = &w->body[m->parent];
    if (!p->C)
        p->C = CT_NEWN(w->b->arena, struct six, e->n + 1);
    for (int j = 0; j < e->n; j++) {
        const ct_ex *C = w->body[i].C[j].e;
        ct_ex3 n = {{C[0], C[1], C[2]}}, f = {{C[3], C[4], C[5]}};
        if (is_zero(C))
            continue;
        e->row[j] = ct_ex_add(x, e->row[j], ct_ex3_dot(x, n, m->al_relative));
        n = ct_member_out(w->b, m, n);
        f = ct_member_out(w->b, m, f);
        e->row[j] = ct_ex_add(x, e->row[j], ct_ex3_dot(x, f, bias));
        n = ct_ex3_add(x, n, ct_ex3_cross(x, m->r, f));
        for (int r = 0; r < N; r++)
            p->C[j].e[r] = ct_ex_add(x, p->C[j].e[r], r < 3 ? n.e[r] : f.e[r - 3]);
    }
}

static void hand_inwards(struct sweep *w, int i)
{
    struct ct_exs *x = w->b->x;
    const struct ct_member *m = &w->s->member[i];
    struct body k = w->body[i], *p = &w->body[m->parent];
    if (m->beam && i != w->s->beam[m->beam - 1].root)
        hand_columns(w, i, &w->elastic[m->beam - 1]);
    add_bias(x, &k, m->al_relative, zero3);
    if (m->is_absolute) { // torques go to ground
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

// ---- ground to leaves -----------------------------------------------------------------------------------

static void accelerate(struct sweep *w, int i, ct_ex *out)
{
    struct ct_exs *x = w->b->x;
    const struct ct_member *m = &w->s->member[i];
    struct body *k = &w->body[i];
    const struct body *p = &w->body[m->parent];
    const ct_ex3 shifted
        = ct_ex3_add(x, ct_ex3_cross(x, p->al, m->r), ct_member_shift_bias(w->b, w->s, i));
    k->al = m->is_absolute ? m->al_relative
                           : ct_ex3_add(x, ct_member_in(w->b, m, p->al), m->al_relative);
    k->a = ct_member_in(w->b, m, ct_ex3_add(x, p->a, shifted));
    if (m->beam) {
        struct elastic *e = &w->elastic[m->beam - 1];
        if (i == w->s->beam[m->beam - 1].root)
            accelerate_beam(w, k, e, out);
        for (int j = 0; j < m->nfree; j++) {
            const ct_ex u = e->a[e->number[m->screw[j].speed]];
            k->al = ct_ex3_add(x, k->al, ct_ex3_scale(x, u, m->screw[j].turn));
            k->a = ct_ex3_add(x, k->a, ct_ex3_scale(x, u, m->screw[j].slide));
        }
        return;
    }
    for (int j = m->nfree; j-- > 0;) {
        const struct ct_screw *s = &m->screw[j];
        ct_ex v[N], u = k->u0[j];
        for (int r = 0; r < N; r++) {
            v[r] = r < 3 ? k->al.e[r] : k->a.e[r - 3];
            if (r != s->axis)
                u = ct_ex_sub(x, u, ct_ex_mul(x, k->G[j][r], v[r]));
        }
        if (s->axis >= 0) {
            ct_ex *now = s->axis < 3 ? &k->al.e[s->axis] : &k->a.e[s->axis - 3];
            const ct_ex along = direction(s, s->axis); // 1 or -1
            *now = ct_ex_mul(x, along, u);
            out[s->speed] = ct_ex_mul(x, along, ct_ex_sub(x, *now, v[s->axis]));
            continue;
        }
        out[s->speed] = u;
        k->al = ct_ex3_add(x, k->al, ct_ex3_scale(x, u, s->turn));
        k->a = ct_ex3_add(x, k->a, ct_ex3_scale(x, u, s->slide));
    }
}

ct_ex *ct_articulated_solve(struct ct_build *b, const struct ct_members *s, const ct_ex *effort,
                            ct_ex *pivot)
{
    struct sweep w = {.b = b, .s = s, .effort = effort, .pivot = pivot};
    ct_ex *out = CT_NEWN(b->arena, ct_ex, b->eqs->nu + 1);
    w.body = CT_NEWN(b->arena, struct body, s->n);
    w.elastic = CT_NEWN(b->arena, struct elastic, s->nbeam + 1);
    for (size_t i = 0; i < s->nbeam; i++)
        start_beam(&w, i);
    if (s->nbeam) {
        w.M = CT_NEWN(b->ctx->scratch, ct_ex, b->eqs->nu * b->eqs->nu + 1);
        w.row = CT_NEWN(b->ctx->scratch, ct_ex, b->eqs->nu + 1);
    }
    for (size_t i = s->n; i-- > 1;) {
        const struct ct_member *m = &s->member[i];
        add_own(&w, (int)i);
        if (m->beam)
            sum_beam(&w, (int)i);
        for (int k = 0; k < m->nfree && !m->beam; k++)
            eliminate(&w, &w.body[i], k, &m->screw[k]);
        if (m->parent)
            hand_inwards(&w, (int)i);
    }
    w.body[0].a = ct_members_fall(b);
    for (size_t i = 1; i < s->n; i++)
        accelerate(&w, (int)i, out);
    return out;
}
