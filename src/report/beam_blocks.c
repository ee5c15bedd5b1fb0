// See beam_blocks.h.
#include "report/beam_blocks.h"

#include "formulate/beam_dynamics/beam_dynamics.h"

#include <string.h>

// Layout: with fewer coordinates a vector is not shorter.
enum { LEAST_COORDINATES = 2 };

static const char *const axis_name[] = {"x", "y", "z"};

// ---- symbols -------------------------------------------------------------------------------

static ct_ex symbol(struct ct_exs *x, enum ct_sym_kind kind, const char *name)
{
    static const uint32_t no_index = UINT32_MAX; // of a speed or multiplier of the system
    return ct_ex_sym(x, kind, ct_arena_strdup(x->arena, name), no_index);
}

// Symbols of rows by axis; zero for an axis along which no coordinate moves the beam.
static void name_axes(struct ct_arena *a, struct ct_exs *x, const char *letter,
                      const struct ct_flexible *f, const ct_ex3 *column, ct_ex *row,
                      ct_ex *transposed)
{
    for (int i = 0; i < 3; i++) {
        bool is_there = false;
        for (int k = 0; k < f->nelastic; k++)
            is_there |= !ct_ex_is_zero(column[k].e[i]);
        const char *name = ct_arena_printf(a, "%s_%s.%s", letter, f->name, axis_name[i]);
        row[i] = is_there ? symbol(x, CT_SYM_LOCAL, name) : CT_EX_ZERO;
        transposed[i]
            = is_there ? symbol(x, CT_SYM_LOCAL, ct_arena_printf(a, "%s'", name)) : CT_EX_ZERO;
    }
}

// Is V_q equal to K_f q_f with a constant K_f?
static bool is_linear(struct ct_exs *x, const struct ct_flexible *f, const ct_ex *q,
                      const ct_ex *zero, const ct_ex *elastic)
{
    const size_t n = (size_t)f->nelastic;
    const unsigned moving = 1u << CT_SYM_Q | 1u << CT_SYM_U;
    for (size_t k = 0; k < n; k++) {
        if (!ct_ex_is_zero(ct_ex_subst(x, elastic[k], q, zero, n)))
            return false;
        for (size_t l = 0; l < n; l++)
            if (ct_ex_kinds(x, ct_ex_diff(x, elastic[k], q[l])) & moving)
                return false;
    }
    return true;
}

static bool has_linear_stiffness(struct ct_arena *a, const struct ct_equations *e,
                                 const struct ct_flexible *f)
{
    const size_t n = (size_t)f->nelastic;
    ct_ex *q = CT_NEWN(a, ct_ex, n + 1), *zero = CT_NEWN(a, ct_ex, n + 1),
          *row = CT_NEWN(a, ct_ex, e->nu + 1), *elastic = CT_NEWN(a, ct_ex, n + 1);
    ct_flexible_stiffness_rows(e->build, f, row);
    for (size_t k = 0; k < n; k++) {
        q[k] = e->q[f->elastic[k].q].symbol;
        elastic[k] = row[f->elastic[k].u];
    }
    return is_linear(e->x, f, q, zero, elastic);
}

static void name_block(struct ct_arena *a, const struct ct_equations *e,
                       const struct ct_flexible *f, const struct ct_elastic_columns *columns,
                       struct ct_beam_block *s)
{
    struct ct_exs *x = e->x;
    s->f = f;
    name_axes(a, x, "m_rf", f, columns->m_rf, s->m_rf, s->m_rf_t);
    name_axes(a, x, "m_thetaf", f, columns->m_thetaf, s->m_thetaf, s->m_thetaf_t);
    s->acceleration = symbol(x, CT_SYM_A, ct_arena_printf(a, "q_%s''", f->name));
    s->inertia = symbol(x, CT_SYM_A, ct_arena_printf(a, "m_ff_%s*q_%s''", f->name, f->name));
    s->velocity = symbol(x, CT_SYM_LOCAL, ct_arena_printf(a, "Q_vf_%s", f->name));
    s->elastic = symbol(x, CT_SYM_LOCAL,
                        has_linear_stiffness(a, e, f)
                            ? ct_arena_printf(a, "K_f_%s*q_%s", f->name, f->name)
                            : ct_arena_printf(a, "V_q_%s", f->name));
    s->applied = symbol(x, CT_SYM_LOCAL, ct_arena_printf(a, "Q_%s", f->name));
}

// Inertia integrals of a beam with one symbol for all its coordinates, except m_ff.
static struct ct_inertia *block_inertia(struct ct_arena *a, const struct ct_inertia *parts,
                                        const struct ct_beam_block *s)
{
    struct ct_inertia *I = CT_NEW(a, struct ct_inertia);
    struct ct_named_inertia *named = ct_named_inertia_create(a, (size_t)s->f->nelastic);
    *I = *parts;
    I->named = named;
    named->force = parts->named->force;
    named->torque = parts->named->torque;
    named->acceleration = s->acceleration;
    for (int k = 0; k < s->f->nelastic; k++) {
        memcpy(named->columns.m_rf[k].e, s->m_rf, sizeof s->m_rf);
        memcpy(named->columns.m_thetaf[k].e, s->m_thetaf, sizeof s->m_thetaf);
        named->velocity[k] = s->velocity;
        named->elastic[k] = s->elastic;
    }
    return I;
}

// ---- parts of an expression ----------------------------------------------------------------

struct finder {
    struct ct_arena *a;
    struct ct_equations *e;
    struct ct_beam_blocks *out;
    int *beam;      // by speed: its block, -1: none
    int *row;       // by speed: its row; in a block: the line below it, -1: none yet
    int *block_row; // by beam
    bool is_same;   // rows of a block are equal so far
};

enum { NSYMBOL = 8 }; // Definition: symbols of a block in own[] and as_column[]

static void symbols_of(const struct ct_beam_block *s, ct_ex own[NSYMBOL],
                       ct_ex as_column[NSYMBOL])
{
    for (int i = 0; i < 3; i++) {
        own[i] = s->m_rf[i];
        own[3 + i] = s->m_thetaf[i];
        as_column[i] = s->m_rf_t[i];
        as_column[3 + i] = s->m_thetaf_t[i];
    }
    own[6] = as_column[6] = s->velocity;
    own[7] = as_column[7] = s->elastic;
}

// Which of the symbols are among the n nodes of the last walk? False: none.
static bool find_symbols(const struct ct_exs *x, size_t n, const ct_ex symbol[NSYMBOL],
                         bool found[NSYMBOL])
{
    bool any = false;
    for (size_t k = 0; k < n; k++)
        for (int i = 0; i < NSYMBOL && x->node[x->stack[k]].op == CT_OP_SYM; i++)
            if (x->stack[k] == symbol[i].id)
                any = found[i] = true;
    return any;
}

// Splits v into own + rest, where own is linear in the symbols of a block. transposed: own
// becomes a column.
static void split(struct finder *f, const struct ct_beam_block *s, ct_ex v, bool transposed,
                  ct_ex *own, ct_ex *rest)
{
    struct ct_exs *x = f->e->x;
    ct_ex symbol[NSYMBOL], as_column[NSYMBOL], from[NSYMBOL], to[NSYMBOL] = {{0}};
    bool found[NSYMBOL] = {false};
    size_t n = 0;
    *own = CT_EX_ZERO;
    *rest = v;
    symbols_of(s, symbol, as_column);
    // one walk serves the derivatives by all symbols
    const size_t nwalk = ct_ex_walk_kinds(x, &v, 1, 1u << CT_SYM_LOCAL);
    if (!find_symbols(x, nwalk, symbol, found))
        return;
    for (int i = 0; i < NSYMBOL; i++) {
        if (!found[i])
            continue;
        from[n++] = symbol[i];
        *own = ct_ex_add_product(x, *own, ct_ex_diff_walked(x, nwalk, v, symbol[i]),
                                 transposed ? as_column[i] : symbol[i]);
    }
    *rest = ct_ex_subst_within(x, v, from, to, n);
}

// ---- rows ----------------------------------------------------------------------------------

static size_t add_row(struct finder *f, const char *label, int beam, int coordinate, ct_ex left)
{
    const struct ct_block_row r
        = {.label = label, .symbol = left, .beam = beam, .coordinate = coordinate};
    CT_PUSH(f->a, f->out->row, f->out->n, f->out->cap, r);
    return f->out->n - 1;
}

static void add_left(struct finder *f, int row, ct_ex coef, ct_ex of)
{
    struct ct_block_row *r = &f->out->row[row];
    const struct ct_block_term t = {coef, of};
    if (ct_ex_is_zero(coef))
        return;
    for (size_t i = 0; i < r->nleft; i++)
        if (ct_ex_same(r->left[i].of, of)) { // of another coordinate of the same block
            f->is_same &= ct_ex_same(r->left[i].coef, coef);
            return;
        }
    CT_PUSH(f->a, r->left, r->nleft, r->left_cap, t);
}

// Adds the terms of a coordinate that moves the frame of its own beam, such as the rotation at
// the start of a beam whose frame is the chord. For coordinates k and l of the beam, M[k][l]
// contains c_k m_l + m_k c_l, where c_k is the motion of the frame. With one symbol for m_k and
// m_l, c_k is half the derivative of M[k][k] by it.
static void add_own_motion(struct finder *f, size_t k, ct_ex v)
{
    struct ct_exs *x = f->e->x;
    const struct ct_beam_block *s = &f->out->block[f->beam[k]];
    ct_ex column, row, rest;
    split(f, s, v, true, &column, &rest);
    split(f, s, v, false, &row, &rest);
    add_left(f, f->block_row[f->beam[k]], ct_ex_scale(x, 0.5, column), f->e->u[k].derivative);
    add_left(f, f->row[k], ct_ex_scale(x, 0.5, row), s->acceleration);
}

// Adds M[i][j] u_j' to the left side of row i.
static void add_entry(struct finder *f, size_t i, size_t j, ct_ex v)
{
    const struct ct_beam_block *row = f->beam[i] < 0 ? NULL : &f->out->block[f->beam[i]],
                               *column = f->beam[j] < 0 ? NULL : &f->out->block[f->beam[j]];
    const ct_ex u = f->e->u[j].derivative;
    ct_ex own, rest = v, all = v;
    if (i == j && row)
        add_own_motion(f, i, v);
    if (row) {
        split(f, row, all, true, &own, &rest);
        if (row != column)
            add_left(f, f->block_row[f->beam[i]], own, u);
    }
    if (column && column != row) {
        all = rest;
        split(f, column, all, false, &own, &rest);
        add_left(f, f->row[i], own, column->acceleration);
    }
    add_left(f, f->row[i], rest, u);
}

// Orders the rows by speeds. A block takes the place of its first coordinate; the lines of all
// its coordinates come below it.
static void lay_out(struct finder *f)
{
    struct ct_equations *e = f->e;
    for (size_t i = 0; i < e->nmotion; i++) {
        const int beam = f->beam[i];
        const struct ct_u *u = &e->u[i];
        if (beam < 0) {
            f->row[i]
                = (int)add_row(f, u->q >= 0 ? e->q[u->q].name : u->name, -1, -1, CT_EX_ZERO);
            continue;
        }
        const struct ct_beam_block *s = &f->out->block[beam];
        if (f->block_row[beam] >= 0)
            continue;
        const char *name = s->f->name;
        f->block_row[beam]
            = (int)add_row(f, ct_arena_printf(f->a, "q_%s", name), beam, -1, CT_EX_ZERO);
        for (int k = 0; k < s->f->nelastic; k++)
            f->row[s->f->elastic[k].u]
                = (int)add_row(f, NULL, beam, k,
                               symbol(e->x, CT_SYM_LOCAL,
                                      ct_arena_printf(f->a, "Q_%s", s->f->elastic[k].name)));
    }
}

static void add_forces(struct finder *f, const struct ct_named_dynamics *named)
{
    struct ct_equations *e = f->e;
    for (size_t i = 0; i < e->nmotion; i++) {
        struct ct_block_row *line = &f->out->row[f->row[i]];
        line->right = named->Q[i];
        if (f->beam[i] < 0)
            continue;
        struct ct_block_row *block = &f->out->row[f->block_row[f->beam[i]]];
        ct_ex own;
        split(f, &f->out->block[f->beam[i]], named->Q[i], true, &own, &line->right);
        f->is_same &= ct_ex_is_zero(block->right) || ct_ex_same(block->right, own);
        block->right = own;
    }
    for (size_t k = 0; k < e->nJ; k++) {
        if ((size_t)e->J[k].column >= e->nmotion)
            continue;
        struct ct_block_row *r = &f->out->row[f->row[e->J[k].column]];
        const struct ct_block_term t = {e->J[k].value, e->row[e->J[k].row].lam};
        CT_PUSH(f->a, r->right_term, r->nright, r->right_cap, t);
    }
}

// On the lines below a block, moves accelerations to the right side. Removes empty lines.
static void close_lines(struct finder *f)
{
    struct ct_block_row *row = f->out->row, *block = NULL;
    size_t kept = 0;
    for (size_t i = 0; i < f->out->n; i++) {
        struct ct_block_row r = row[i];
        const bool is_line = r.coordinate >= 0;
        if (is_line && !r.nleft && !r.nright && ct_ex_is_zero(r.right))
            continue;
        for (size_t k = 0; k < r.nleft && is_line; k++) {
            const struct ct_block_term t = {ct_ex_neg(f->e->x, r.left[k].coef), r.left[k].of};
            CT_PUSH(f->a, r.right_term, r.nright, r.right_cap, t);
        }
        if (is_line)
            r.nleft = 0;
        row[kept] = r;
        if (r.beam >= 0 && !is_line) {
            block = &row[kept];
            add_left(f, (int)kept, CT_EX_ONE, f->out->block[r.beam].inertia);
        } else if (is_line && !block->nright) {
            const struct ct_block_term t = {CT_EX_ONE, f->out->block[r.beam].applied};
            CT_PUSH(f->a, block->right_term, block->nright, block->right_cap, t);
        }
        kept++;
    }
    f->out->n = kept;
}

// ---- for reading ---------------------------------------------------------------------------

// Collects all terms and introduces shared definitions.
struct list {
    ct_ex **at;
    size_t n, cap;
};

static void list(struct ct_arena *a, struct list *l, ct_ex *e)
{
    CT_PUSH(a, l->at, l->n, l->cap, e);
}

static void list_all(struct ct_arena *a, struct ct_beam_blocks *s, const struct ct_equations *e,
                     struct ct_reduced *r, struct list *l)
{
    for (size_t i = 0; i < s->n; i++) {
        for (size_t k = 0; k < s->row[i].nleft; k++)
            list(a, l, &s->row[i].left[k].coef);
        for (size_t k = 0; k < s->row[i].nright; k++)
            list(a, l, &s->row[i].right_term[k].coef);
        list(a, l, &s->row[i].right);
    }
    for (size_t i = 0; i < e->nJ; i++)
        list(a, l, &r->J[i]);
    for (size_t i = 0; i < e->nrow; i++) {
        list(a, l, &r->phi[i]);
        list(a, l, &r->gam[i]);
    }
    for (size_t i = 0; i < e->ndriver; i++)
        list(a, l, &r->effort[i]);
}

// Collects terms where the result is shorter, with definitions for repeated expressions.
static void make_readable(struct ct_arena *a, struct ct_equations *e, struct ct_reduced *r,
                          const ct_ex *effort, struct ct_beam_blocks *s)
{
    struct list all = {0};
    double size;
    ct_reduced_prepare(a, e, false, r);
    for (size_t i = 0; i < e->ndriver; i++)
        r->effort[i] = effort[i];
    list_all(a, s, e, r, &all);
    r->is_collected = ct_reduced_collect(a, e, all.at, all.n);
    s->definitions = ct_definitions_find(a, e, all.at, all.n, false, &size);
}

bool ct_beam_blocks_derive(struct ct_arena *a, struct ct_equations *e,
                           const struct ct_beam_parts *parts, struct ct_reduced *r,
                           struct ct_beam_blocks *out)
{
    const size_t n = e->build->nflexible;
    struct finder f = {.a = a, .e = e, .out = out, .is_same = true};
    struct ct_inertia **inertia = CT_NEWN(a, struct ct_inertia *, n + 1);
    struct ct_named_dynamics named;
    bool any = false;
    *out = (struct ct_beam_blocks){.parts = parts,
                                   .block = CT_NEWN(a, struct ct_beam_block, n + 1)};
    f.beam = CT_NEWN(a, int, e->nu + 1);
    f.row = CT_NEWN(a, int, e->nu + 1);
    f.block_row = CT_NEWN(a, int, n + 1);
    for (size_t i = 0; i < e->nu; i++)
        f.beam[i] = f.row[i] = -1;
    for (size_t i = 0; i < n; i++) {
        const struct ct_flexible *self = &e->build->flexible[i];
        f.block_row[i] = -1;
        inertia[i] = parts->inertia[i];
        if (!inertia[i] || self->nelastic < LEAST_COORDINATES)
            continue;
        any = true;
        name_block(a, e, self, &inertia[i]->named->columns, &out->block[i]);
        inertia[i] = block_inertia(a, inertia[i], &out->block[i]);
        for (int k = 0; k < self->nelastic; k++)
            f.beam[self->elastic[k].u] = (int)i;
    }
    if (!any)
        return false;
    ct_named_dynamics_derive(a, e, inertia, &named);
    lay_out(&f);
    for (size_t k = 0; k < named.nM; k++) {
        const size_t i = (size_t)named.M[k].row, j = (size_t)named.M[k].column;
        if (i >= e->nmotion)
            continue;
        add_entry(&f, i, j, named.M[k].value);
        if (i != j)
            add_entry(&f, j, i, named.M[k].value);
    }
    add_forces(&f, &named);
    close_lines(&f);
    if (f.is_same)
        make_readable(a, e, r, named.effort, out);
    return f.is_same;
}

ct_ex ct_block_left(struct ct_exs *x, const struct ct_block_row *r)
{
    ct_ex sum = CT_EX_ZERO;
    for (size_t k = 0; k < r->nleft; k++)
        sum = ct_ex_add_product(x, sum, r->left[k].coef, r->left[k].of);
    return r->label ? sum : r->symbol;
}

ct_ex ct_block_right(struct ct_exs *x, const struct ct_block_row *r)
{
    ct_ex sum = r->right;
    for (size_t k = 0; k < r->nright; k++)
        sum = ct_ex_add_product(x, sum, r->right_term[k].coef, r->right_term[k].of);
    return sum;
}
