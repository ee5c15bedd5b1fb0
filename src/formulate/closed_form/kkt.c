// See kkt.h.
#include "formulate/closed_form/kkt.h"

#include <math.h>
#include <string.h>

struct choice {
    int size, at[2];
    double cost; // products per row, or position
    int tie;
    double strength;
};

// The largest magnitudes in a row, descending, and their columns.
enum { LARGEST = 3 }; // Derived: without the two columns of a pivot one is left
struct largest {
    double size[LARGEST];
    int column[LARGEST];
};

struct work {
    struct ct_arena *a;
    struct ct_exs *x; // NULL: patterns and numbers only
    size_t n;
    const double *scale;       // by row
    const int *place;          // position that breaks ties; NULL: the smaller level wins
    double threshold;          // multipliers of an accepted pivot are at most 1/threshold
    struct ct_probed_row *row; // both triangles of the remaining matrix; scaled values
    struct largest *largest;   // of each row
    bool *is_done;
    int *level;          // number of pivots that must come before
    int *position;       // position for the order along the system; NULL: by degree
    int *near;           // neighbours of a pivot
    struct choice *best; // by row, if not stale
    bool *is_stale;
    struct ct_probed_row spare; // buffer for the next updated row
    struct ct_kkt *k;
};

// ---- the matrix ---------------------------------------------------------------------------------

// Scales unknowns without inertia (d[i] = 0), so that the largest entry of a column is as large as
// the other entries of its row.
static void scale_massless(const struct ct_probed_row *J, size_t m, size_t nu, double *d)
{
    double *row = d + nu;
    for (size_t i = 0; i < m; i++)
        for (size_t k = 0; k < J[i].n; k++) {
            const struct ct_probed_entry *e = &J[i].e[k];
            double *to = &d[e->column];
            if (*to <= 0) // negative while it is the largest entry
                *to = fmin(*to, -fabs(e->number) * row[i]);
        }
    for (size_t i = 0; i < nu; i++)
        if (d[i] <= 0)
            d[i] = d[i] < 0 ? -1 / d[i] : 1;
}

// Scale factors of the unknowns that give M a unit diagonal and rows of J of size one.
static double *find_scales(struct ct_arena *a, const struct ct_probed_row *M, size_t nu,
                           const struct ct_probed_row *J, size_t m)
{
    double *d = CT_NEWN(a, double, nu + m + 1);
    for (size_t i = 0; i < nu; i++) {
        const struct ct_probed_entry *e = ct_probed_row_find(&M[i], (int)i);
        d[i] = e && e->number > 0 ? 1 / sqrt(e->number) : 0;
    }
    for (size_t i = 0; i < m; i++) {
        double most = 0;
        for (size_t k = 0; k < J[i].n; k++)
            most = fmax(most, fabs(J[i].e[k].number) * d[J[i].e[k].column]);
        d[nu + i] = most > 0 ? 1 / most : 1;
    }
    scale_massless(J, m, nu, d);
    return d;
}

static void read_matrix(struct work *w, const struct ct_probed_row *M, size_t nu,
                        const struct ct_probed_row *J, size_t m)
{
    const double *d = w->scale = find_scales(w->a, M, nu, J, m);
    for (size_t i = 0; i < nu; i++)
        for (size_t k = 0; k < M[i].n; k++) {
            const struct ct_probed_entry *e = &M[i].e[k];
            if (!ct_ex_is_zero(e->value))
                ct_probed_row_append(w->a, &w->row[i], e->column, e->value,
                                     e->number * d[i] * d[e->column]);
        }
    for (size_t i = 0; i < m; i++)
        for (size_t k = 0; k < J[i].n; k++) {
            const struct ct_probed_entry *e = &J[i].e[k];
            const double number = e->number * d[nu + i] * d[e->column];
            if (ct_ex_is_zero(e->value))
                continue;
            ct_probed_row_append(w->a, &w->row[nu + i], e->column, e->value, number);
            ct_probed_row_append(w->a, &w->row[e->column], (int)(nu + i), e->value, number);
        }
}

// ---- choice of pivots ---------------------------------------------------------------------------

static struct largest largest_of(const struct ct_probed_row *l)
{
    struct largest t = {{0}, {-1, -1, -1}};
    for (size_t k = 0; k < l->n; k++) {
        const double size = fabs(l->e[k].number);
        int at = LARGEST;
        for (; at > 0 && size > t.size[at - 1]; at--)
            if (at < LARGEST) {
                t.size[at] = t.size[at - 1];
                t.column[at] = t.column[at - 1];
            }
        if (at < LARGEST) {
            t.size[at] = size;
            t.column[at] = l->e[k].column;
        }
    }
    return t;
}

// The largest magnitude in row r outside columns i and j.
static double largest_outside(const struct work *w, int r, int i, int j)
{
    const struct largest *t = &w->largest[r];
    int at = 0;
    while (at < LARGEST - 1 && (t->column[at] == i || t->column[at] == j))
        at++;
    return t->size[at];
}

static double number_at(const struct ct_probed_row *l, int column)
{
    const struct ct_probed_entry *e = ct_probed_row_find(l, column);
    return e ? e->number : 0;
}

static ct_ex value_at(const struct ct_probed_row *l, int column)
{
    const struct ct_probed_entry *e = ct_probed_row_find(l, column);
    return e ? e->value : CT_EX_ZERO;
}

static double at_most_one(double strength)
{
    return strength > 1 ? 1 : strength; // no neighbours: infinite
}

static double per_row(double degree)
{
    return degree * (degree + 4);
}

static bool is_better(const struct work *w, const struct choice *a, const struct choice *b)
{
    if (!(a->strength >= w->threshold))
        return b->strength < w->threshold && a->strength > b->strength;
    if (!b->size || b->strength < w->threshold)
        return true;
    if (a->cost < b->cost || a->cost > b->cost)
        return a->cost < b->cost;
    return a->tie < b->tie;
}

static int later(const int *of, int i, int j)
{
    return of[i] > of[j] ? of[i] : of[j];
}

// Number of columns of two rows without i and j.
static double united_degree(const struct ct_probed_row *l, const struct ct_probed_row *k, int i,
                            int j)
{
    double n = 0;
    for (size_t p = 0, q = 0; p < l->n || q < k->n; n++) {
        const int c = p < l->n ? l->e[p].column : INT32_MAX,
                  d = q < k->n ? k->e[q].column : INT32_MAX, least = c < d ? c : d;
        p += c == least;
        q += d == least;
        n -= least == i || least == j;
    }
    return n;
}

static void try_pair(const struct work *w, int i, int j, struct choice *best)
{
    const struct ct_probed_row *l = &w->row[i], *k = &w->row[j];
    const double a = number_at(l, i), b = number_at(l, j), c = number_at(k, j);
    const double det = fabs(a * c - b * b), mi = largest_outside(w, i, i, j),
                 mj = largest_outside(w, j, i, j);
    const double growth = fmax(fabs(c) * mi + fabs(b) * mj, fabs(b) * mi + fabs(a) * mj);
    struct choice t = {.size = 2, .at = {i, j}, .strength = at_most_one(det / growth)};
    t.tie = later(w->place ? w->place : w->level, i, j);
    // the nearest partner of the first row
    t.cost = w->position ? w->position[i] + w->position[j] / (1. + (double)w->n)
                         : per_row(united_degree(l, k, i, j));
    if (det > 0 && is_better(w, &t, best))
        *best = t;
}

// The best pivot with row i alone or as its first row.
static struct choice best_of_row(const struct work *w, int i)
{
    struct choice best = {0};
    const struct ct_probed_row *l = &w->row[i];
    const double d = fabs(number_at(l, i));
    const struct choice one = {.size = 1,
                               .at = {i, i},
                               .cost = w->position ? w->position[i] : per_row((double)l->n - 1),
                               .tie = (w->place ? w->place : w->level)[i],
                               .strength = at_most_one(d / largest_outside(w, i, i, i))};
    if (d > 0 && is_better(w, &one, &best))
        best = one;
    for (size_t k = 0; k < l->n && !(one.strength >= w->threshold && d > 0); k++)
        if (l->e[k].column != i)
            try_pair(w, i, l->e[k].column, &best);
    return best;
}

static struct choice choose(const struct work *w)
{
    struct choice best = {0};
    for (int i = 0; i < (int)w->n; i++) {
        if (w->is_done[i])
            continue;
        if (w->is_stale[i])
            w->best[i] = best_of_row(w, i);
        w->is_stale[i] = false;
        if (w->best[i].size && is_better(w, &w->best[i], &best))
            best = w->best[i];
    }
    return best;
}

// Row r or its level has changed: marks its pivot and those of its neighbours as stale.
static void mark_stale(const struct work *w, int r)
{
    w->is_stale[r] = true;
    for (size_t k = 0; k < w->row[r].n; k++)
        w->is_stale[w->row[r].e[k].column] = true;
}

// ---- along the system ---------------------------------------------------------------------------

// Breadth-first order of the unplaced rows from `first`, neighbours of low degree first: order[n
// ...]. Returns the new number of rows.
static size_t walk(const struct work *w, int first, int *order, size_t n, int *position)
{
    size_t end = n;
    order[end] = first;
    position[first] = (int)end++;
    for (size_t at = n; at < end; at++) {
        const struct ct_probed_row *l = &w->row[order[at]];
        const size_t begin = end;
        for (size_t k = 0; k < l->n; k++) {
            const int c = l->e[k].column;
            if (position[c] >= 0)
                continue;
            size_t to = end++; // few, so that insertion sort is enough
            for (; to > begin && w->row[order[to - 1]].n > w->row[c].n; to--)
                order[to] = order[to - 1];
            order[to] = c;
            position[c] = 0;
        }
        for (size_t k = begin; k < end; k++)
            position[order[k]] = (int)k;
    }
    return end;
}

// Positions along the system with small bandwidth, from a peripheral row of each connected part.
// Source: Cuthill and McKee (1969), key cuthill1969.
static int *positions_along(const struct work *w)
{
    int *position = CT_NEWN(w->a, int, w->n + 1), *order = CT_NEWN(w->a, int, w->n + 1);
    size_t n = 0;
    for (size_t i = 0; i < w->n; i++)
        position[i] = -1;
    for (size_t i = 0; i < w->n; i++) {
        if (position[i] >= 0)
            continue;
        const size_t end = walk(w, (int)i, order, n, position);
        const int far = order[end - 1];
        for (size_t k = n; k < end; k++)
            position[order[k]] = -1;
        n = walk(w, far, order, n, position);
    }
    return position;
}

// ---- elimination --------------------------------------------------------------------------------

// Without a store (counting only) each entry is 1.
static ct_ex product(struct ct_exs *x, ct_ex a, ct_ex b)
{
    if (!x)
        return ct_ex_is_zero(a) ? a : ct_ex_is_zero(b) ? b : CT_EX_ONE;
    return ct_ex_mul(x, a, b);
}

static ct_ex difference(struct ct_exs *x, ct_ex a, ct_ex b)
{
    if (!x)
        return ct_ex_is_zero(a) && ct_ex_is_zero(b) ? a : CT_EX_ONE;
    return ct_ex_sub(x, a, b);
}

static ct_ex over(struct ct_exs *x, ct_ex a, const struct ct_kkt_pivot *p)
{
    if (!x || ct_ex_is_zero(a))
        return ct_ex_is_zero(a) ? a : CT_EX_ONE;
    return ct_ex_is_zero(p->reciprocal) ? ct_ex_div(x, a, p->value)
                                        : ct_ex_mul(x, a, p->reciprocal);
}

// The second diagonal entry of a block of two is 0.
static bool is_simple(const struct ct_kkt_pivot *p)
{
    return p->size == 2 && ct_ex_is_zero(p->P[2]);
}

// f P = r, or P f = r: P is symmetric.
static void divide(struct ct_exs *x, const struct ct_kkt_pivot *p, const ct_ex *r, ct_ex *f)
{
    if (p->size == 1) {
        f[0] = over(x, r[0], p);
    } else if (is_simple(p)) {
        f[0] = over(x, r[1], p);
        f[1] = over(x, difference(x, r[0], product(x, p->P[0], f[0])), p);
    } else {
        f[0] = over(x, difference(x, product(x, p->P[2], r[0]), product(x, p->P[1], r[1])), p);
        f[1] = over(x, difference(x, product(x, p->P[0], r[1]), product(x, p->P[1], r[0])), p);
    }
}

static void divide_numbers(const double P[3], double det, int size, const double *r, double *f)
{
    if (size == 1) {
        f[0] = r[0] / P[0];
        return;
    }
    f[0] = (P[2] * r[0] - P[1] * r[1]) / det;
    f[1] = (P[0] * r[1] - P[1] * r[0]) / det;
}

// The neighbours of a pivot, ascending.
static size_t list_near(struct work *w, const struct ct_kkt_pivot *p)
{
    const struct ct_probed_row *l = &w->row[p->at[0]], *k = &w->row[p->at[p->size - 1]];
    size_t n = 0;
    for (size_t i = 0, j = 0; i < l->n || j < k->n;) {
        const int c = i < l->n ? l->e[i].column : INT32_MAX,
                  d = j < k->n ? k->e[j].column : INT32_MAX, least = c < d ? c : d;
        i += c == least;
        j += d == least;
        if (least != p->at[0] && least != p->at[p->size - 1])
            w->near[n++] = least;
    }
    return n;
}

// Entry (r, c), c >= r, after elimination of pivot p.
static struct ct_probed_entry updated(struct work *w, const struct ct_kkt_pivot *p,
                                      const struct ct_probed_entry *old, int c, const ct_ex *f,
                                      const double *number)
{
    struct ct_probed_entry e = {c, old ? old->value : CT_EX_ZERO, old ? old->number : 0};
    for (int q = 0; q < p->size; q++) {
        const struct ct_probed_entry *s = ct_probed_row_find(&w->row[p->at[q]], c);
        if (!s || ct_ex_is_zero(f[q]))
            continue;
        e.value = difference(w->x, e.value, product(w->x, f[q], s->value));
        e.number -= number[q] * s->number;
        w->k->operations += 2;
    }
    return e;
}

// Updates row r: removes the pivot columns and updates entries in neighbour columns. Entries left
// of the diagonal are already updated.
static void update_row(struct work *w, const struct ct_kkt_pivot *p, size_t nnear, int r,
                       const ct_ex *f, const double *number)
{
    const struct ct_probed_row *old = &w->row[r];
    struct ct_probed_row sum = w->spare;
    sum.n = 0;
    size_t i = 0, k = 0;
    while (i < old->n || k < nnear) {
        const int c = i < old->n ? old->e[i].column : INT32_MAX,
                  d = k < nnear ? w->near[k] : INT32_MAX, least = c < d ? c : d;
        const struct ct_probed_entry *was = c == least ? &old->e[i] : NULL;
        i += c == least;
        k += d == least;
        if (least == p->at[0] || least == p->at[p->size - 1])
            continue;
        struct ct_probed_entry e = {0};
        if (was && d != least) {
            e = *was;
        } else if (least < r) {
            const struct ct_probed_entry *other = ct_probed_row_find(&w->row[least], r);
            e = other ? *other : e;
            e.column = least;
        } else {
            e = updated(w, p, was, least, f, number);
        }
        if (!ct_ex_is_zero(e.value))
            ct_probed_row_append(w->a, &sum, e.column, e.value, e.number);
    }
    w->spare = *old;
    w->row[r] = sum;
    w->largest[r] = largest_of(&sum);
}

// Takes the values of the pivot, and its reciprocal if it divides more than two numbers.
static void take_pivot(struct work *w, struct ct_kkt_pivot *p, double P[3], size_t nnear)
{
    const int i = p->at[0], j = p->at[p->size - 1];
    p->P[0] = value_at(&w->row[i], i);
    P[0] = number_at(&w->row[i], i);
    p->value = p->P[0];
    p->number = P[0];
    if (p->size == 2) {
        p->P[1] = value_at(&w->row[i], j);
        p->P[2] = value_at(&w->row[j], j);
        P[1] = number_at(&w->row[i], j);
        P[2] = number_at(&w->row[j], j);
        p->number = P[0] * P[2] - P[1] * P[1];
        p->value = is_simple(p) ? p->P[1]
                                : difference(w->x, product(w->x, p->P[0], p->P[2]),
                                             product(w->x, p->P[1], p->P[1]));
    }
    if (w->x && nnear > 1)
        p->reciprocal = ct_ex_div(w->x, CT_EX_ONE, p->value);
}

static void eliminate(struct work *w, const struct choice *c)
{
    struct ct_kkt_pivot *p = &w->k->pivot[w->k->npivot++];
    double P[3] = {0};
    *p = (struct ct_kkt_pivot){
        .size = c->size, .at = {c->at[0], c->at[1]}, .strength = c->strength};
    // the row without a diagonal entry second
    if (p->size == 2 && ct_ex_is_zero(value_at(&w->row[p->at[0]], p->at[0]))) {
        p->at[0] = c->at[1];
        p->at[1] = c->at[0];
    }
    const size_t nnear = list_near(w, p);
    take_pivot(w, p, P, nnear);
    const double det = p->number;
    const int level = later(w->level, c->at[0], c->at[1]);
    if (is_simple(p))
        p->number = P[1];
    for (size_t i = 0; i < nnear; i++) {
        const struct ct_probed_row *l = &w->row[w->near[i]];
        struct ct_kkt_factor t = {.row = w->near[i]};
        const ct_ex r[2] = {value_at(l, p->at[0]), value_at(l, p->at[p->size - 1])};
        const double rn[2] = {number_at(l, p->at[0]), number_at(l, p->at[p->size - 1])};
        double number[2];
        divide(w->x, p, r, t.f);
        divide_numbers(P, det, p->size, rn, number);
        CT_PUSH(w->a, p->factor, p->nfactor, p->factor_cap, t);
        update_row(w, p, nnear, t.row, t.f, number);
        if (w->level[t.row] <= level)
            w->level[t.row] = level + 1;
        w->k->operations += p->size == 1 ? 1 : 4;
    }
    for (size_t i = 0; i < nnear; i++)
        mark_stale(w, w->near[i]);
    for (int q = 0; q < p->size; q++) {
        w->is_done[p->at[q]] = true;
        // undo the scaling; a determinant contains each row and column scale twice
        p->number
            /= w->scale[p->at[q]] * (p->size == 1 || !is_simple(p) ? w->scale[p->at[q]] : 1);
    }
    // forward and back substitution use each factor twice; then the diagonal
    w->k->operations += 4. * p->size * (double)nnear + (p->size == 1 ? 4 : 12);
}

struct ct_kkt *ct_kkt_factor(struct ct_arena *a, struct ct_exs *x,
                             const struct ct_kkt_system *system, enum ct_kkt_order order,
                             double most)
{
    const size_t n = system->n + system->m;
    struct work w = {
        .a = a, .x = x, .n = n, .threshold = system->threshold, .k = CT_NEW(a, struct ct_kkt)};
    if (order == CT_KKT_POSITIONS && !system->position_along)
        return NULL;
    w.row = CT_NEWN(a, struct ct_probed_row, n + 1);
    w.is_done = CT_NEWN(a, bool, n + 1);
    w.level = CT_NEWN(a, int, n + 1);
    w.near = CT_NEWN(a, int, n + 1);
    w.best = CT_NEWN(a, struct choice, n + 1);
    w.is_stale = CT_NEWN(a, bool, n + 1);
    memset(w.is_stale, true, n * sizeof *w.is_stale);
    w.k->n = n;
    w.k->pivot = CT_NEWN(a, struct ct_kkt_pivot, n + 1);
    read_matrix(&w, system->M, system->n, system->J, system->m);
    w.largest = CT_NEWN(a, struct largest, n + 1);
    for (size_t i = 0; i < n; i++)
        w.largest[i] = largest_of(&w.row[i]);
    w.place = order == CT_KKT_POSITIONS ? system->position_along : NULL;
    if (order == CT_KKT_ALONG)
        w.position = positions_along(&w);
    for (size_t done = 0; done < n;) {
        const struct choice c = choose(&w);
        if (!c.size || (x ? (double)x->nnode : w.k->operations) >= most)
            return NULL;
        eliminate(&w, &c);
        done += (size_t)c.size;
    }
    return w.k;
}

void ct_kkt_solve(const struct ct_kkt *k, struct ct_exs *x, ct_ex *b, ct_ex *y)
{
    for (size_t i = 0; i < k->npivot; i++) {
        const struct ct_kkt_pivot *p = &k->pivot[i];
        for (size_t r = 0; r < p->nfactor; r++)
            for (int q = 0; q < p->size; q++) {
                ct_ex *to = &b[p->factor[r].row];
                *to = ct_ex_sub(x, *to, ct_ex_mul(x, p->factor[r].f[q], b[p->at[q]]));
            }
    }
    for (size_t i = k->npivot; i-- > 0;) {
        const struct ct_kkt_pivot *p = &k->pivot[i];
        const ct_ex r[2] = {b[p->at[0]], b[p->at[p->size - 1]]};
        ct_ex f[2];
        divide(x, p, r, f);
        for (int q = 0; q < p->size; q++) {
            for (size_t t = 0; t < p->nfactor; t++)
                f[q] = ct_ex_sub(x, f[q], ct_ex_mul(x, p->factor[t].f[q], y[p->factor[t].row]));
            y[p->at[q]] = f[q];
        }
    }
}
