// Static condensation of massless rotations, at a cost proportional to the number of nodes; see
// static_condensation.h.
//
// The rotations r are in equilibrium, K_rr r + K_rt t = 0. Nodes are coupled with their neighbours
// only: K_rr = L D L' is banded, its inverse is full. With numbers A = D^-1 L D, G = -D^-1 K_rt,
//
//     A y = G t,  L' r = y        from the first to the last, and back
//
// and forces s on the rotations give forces on t by the transpose:  L p = s,  A' w = p,  G' w.
#include "formulate/beam/static_condensation.h"

struct entry {
    int at; // number of a condensed rotation, or a freedom
    double by;
};

// A condensed rotation: its row of G by freedoms, of A and of L below the diagonal.
struct condensed_rotation {
    int freedom, nheld, nbefore, nequilibrium;
    struct entry *held, *forth, *back;
    // its row of K divided by the diagonal entry, without that entry
    struct ct_condensation_term *equilibrium;
};

struct ct_condensation {
    int n;
    bool is_balanced;
    int *number; // by freedom: its row, or -1
    struct condensed_rotation *row;
};

// ---- creation -----------------------------------------------------------------------------------

static void fill_row(struct ct_condensation *out, const struct ct_condensation_numbers *c,
                     int k, struct condensed_rotation *row)
{
    const size_t n = (size_t)c->n, m = (size_t)(c->n - c->nkept);
    const double pivot = c->L[(size_t)k + m * (size_t)k];
    row->freedom = c->freedom[c->nkept + k];
    out->number[row->freedom] = k;
    const double own = c->K[(size_t)(c->nkept + k) * (n + 1)];
    for (int i = 0; i < c->n; i++) {
        const double v = c->K[(size_t)(c->nkept + k) + n * (size_t)i];
        if (v != 0 && i != c->nkept + k)
            row->equilibrium[row->nequilibrium++]
                = (struct ct_condensation_term){c->freedom[i], v / own};
    }
    for (int i = 0; i < c->nkept; i++) {
        const double v = c->K[(size_t)(c->nkept + k) + n * (size_t)i];
        if (v != 0)
            row->held[row->nheld++] = (struct entry){c->freedom[i], -v / (pivot * pivot)};
    }
    for (int j = 0; j < k; j++) {
        const double v = c->L[(size_t)k + m * (size_t)j],
                     before = c->L[(size_t)j + m * (size_t)j];
        if (v == 0)
            continue;
        row->forth[row->nbefore] = (struct entry){j, v * before / (pivot * pivot)};
        row->back[row->nbefore++] = (struct entry){j, v / before};
    }
}

static int count(const double *a, int n, size_t stride)
{
    int some = 0;
    for (int i = 0; i < n; i++)
        some += a[stride * (size_t)i] != 0;
    return some;
}

struct ct_condensation *ct_condensation_create(struct ct_build *b,
                                               const struct ct_condensation_numbers *c)
{
    const int m = c->n - c->nkept;
    struct ct_condensation *out = CT_NEW(b->arena, struct ct_condensation);
    *out = (struct ct_condensation){.n = m, .is_balanced = c->is_balanced};
    out->number = CT_NEWN(b->arena, int, c->nfreedom);
    for (int i = 0; i < c->nfreedom; i++)
        out->number[i] = -1;
    out->row = CT_NEWN(b->arena, struct condensed_rotation, m);
    for (int k = 0; k < m; k++) {
        struct condensed_rotation *row = &out->row[k];
        const int nheld = count(c->K + c->nkept + k, c->nkept, (size_t)c->n),
                  nbefore = count(c->L + k, k, (size_t)m);
        row->equilibrium = CT_NEWN(b->arena, struct ct_condensation_term,
                                   count(c->K + c->nkept + k, c->n, (size_t)c->n) + 1);
        row->held = CT_NEWN(b->arena, struct entry, nheld + 1);
        row->forth = CT_NEWN(b->arena, struct entry, nbefore + 1);
        row->back = CT_NEWN(b->arena, struct entry, nbefore + 1);
        fill_row(out, c, k, row);
    }
    return out;
}

bool ct_freedom_is_balanced(const struct ct_flexible *f, int freedom)
{
    return f->condensation && f->condensation->is_balanced
        && f->condensation->number[freedom] >= 0;
}

int ct_condensation_count(const struct ct_flexible *f)
{
    return f->condensation ? f->condensation->n : 0;
}

int ct_condensation_number(const struct ct_flexible *f, int freedom)
{
    return f->condensation ? f->condensation->number[freedom] : -1;
}

const struct ct_condensation_term *ct_condensation_equilibrium(const struct ct_flexible *f,
                                                               int k, int *n)
{
    *n = f->condensation->row[k].nequilibrium;
    return f->condensation->row[k].equilibrium;
}

// ---- values, forces -----------------------------------------------------------------------------

static void add(struct ct_exs *x, ct_ex *sum, double by, ct_ex v)
{
    *sum = ct_ex_add(x, *sum, ct_ex_scale(x, by, v));
}

void ct_condensation_extend(struct ct_exs *x, const struct ct_condensation *s, ct_ex *v)
{
    for (int k = 0; k < s->n; k++) {
        const struct condensed_rotation *row = &s->row[k];
        for (int i = 0; i < row->nheld; i++)
            add(x, &v[row->freedom], row->held[i].by, v[row->held[i].at]);
        for (int i = 0; i < row->nbefore; i++)
            add(x, &v[row->freedom], -row->forth[i].by, v[s->row[row->forth[i].at].freedom]);
    }
    for (int k = s->n; k-- > 0;) {
        const struct condensed_rotation *row = &s->row[k];
        for (int i = 0; i < row->nbefore; i++)
            add(x, &v[s->row[row->back[i].at].freedom], -row->back[i].by, v[row->freedom]);
    }
}

void ct_condensation_values(struct ct_build *b, struct ct_flexible *f)
{
    const int n = CT_NODE_FREEDOM * (f->beam->nelement + 1);
    ct_ex *v = CT_NEWN(b->ctx->scratch, ct_ex, n);
    for (int level = 0; level < 3; level++) {
        for (int i = 0; i < n; i++) {
            const struct ct_freedom *d = &f->freedom[i];
            v[i] = level == 0 ? d->value : level == 1 ? d->rate : d->acceleration;
        }
        ct_condensation_extend(b->x, f->condensation, v);
        for (int k = 0; k < f->condensation->n; k++) {
            const int i = f->condensation->row[k].freedom;
            struct ct_freedom *d = &f->freedom[i];
            *(level == 0 ? &d->value : level == 1 ? &d->rate : &d->acceleration) = v[i];
        }
    }
}

void ct_condensation_forces(struct ct_exs *x, const struct ct_condensation *s, ct_ex *force)
{
    for (int k = 0; k < s->n; k++) {
        const struct condensed_rotation *row = &s->row[k];
        for (int i = 0; i < row->nbefore; i++)
            add(x, &force[row->freedom], -row->back[i].by,
                force[s->row[row->back[i].at].freedom]);
    }
    for (int k = s->n; k-- > 0;) {
        const struct condensed_rotation *row = &s->row[k];
        const ct_ex w = force[row->freedom];
        for (int i = 0; i < row->nbefore; i++)
            add(x, &force[s->row[row->forth[i].at].freedom], -row->forth[i].by, w);
        for (int i = 0; i < row->nheld; i++)
            add(x, &force[row->held[i].at], row->held[i].by, w);
        force[row->freedom] = CT_EX_ZERO;
    }
}

size_t ct_condensation_products(const struct ct_condensation *s)
{
    size_t n = 0;
    for (int k = 0; k < s->n; k++)
        n += (size_t)(2 * s->row[k].nbefore + s->row[k].nheld);
    return n;
}
