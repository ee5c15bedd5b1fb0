// See provenance.h.
//
//     reduced.h        the printed equations
//     marked_model.h   the model with marks
//     normal_form.h    monomials of a sum
#include "report/provenance.h"

#include "base/sort.h"
#include "expr/normal_form.h"
#include "formulate/build.h"
#include "formulate/dynamics/dynamics.h"
#include "formulate/outputs/output.h"
#include "formulate/stage.h"

#include <math.h>
#include <string.h>

// Above this number of operators and operands a side is not expanded. If a side uses
// definitions, collected definitions have fewer than 1000 (reduced.c).
// Limit: of the time to expand; a longer side has no table of terms.
static const double longest = 20000;

// ---- sets of origins -----------------------------------------------------------------------

// Each set has a number; 0 is the empty one.
struct sets {
    struct ct_arena *a;
    size_t nword, n, cap;
    uint64_t *word; // by set (nword)
    uint32_t *hash; // open addressing, 0 is free, else set + 1
    size_t nhash;
    uint64_t *work; // (nword)
};

static uint64_t hash_of(const struct sets *s, const uint64_t *w)
{
    uint64_t h = 0;
    for (size_t k = 0; k < s->nword; k++) {
        h = (h ^ w[k]) * 0x9E3779B97F4A7C15u;
        h ^= h >> 29;
    }
    return h;
}

static void put_in_table(struct sets *s, uint32_t set)
{
    size_t i = hash_of(s, s->word + set * s->nword) & (s->nhash - 1);
    while (s->hash[i])
        i = (i + 1) & (s->nhash - 1);
    s->hash[i] = set + 1;
}

// The number of the set in s->work.
static uint32_t intern(struct sets *s)
{
    if (2 * (s->n + 1) > s->nhash) {
        s->nhash = s->nhash ? 2 * s->nhash : 64;
        s->hash = CT_NEWN(s->a, uint32_t, s->nhash);
        for (size_t i = 0; i < s->n; i++)
            put_in_table(s, (uint32_t)i);
    }
    for (size_t i = hash_of(s, s->work) & (s->nhash - 1); s->hash[i];
         i = (i + 1) & (s->nhash - 1))
        if (!memcmp(s->word + (s->hash[i] - 1) * s->nword, s->work, s->nword * sizeof *s->work))
            return s->hash[i] - 1;
    for (size_t k = 0; k < s->nword; k++) {
        size_t n = s->n * s->nword + k;
        CT_PUSH(s->a, s->word, n, s->cap, s->work[k]);
    }
    put_in_table(s, (uint32_t)s->n);
    return (uint32_t)s->n++;
}

static struct sets make_sets(struct ct_arena *a, size_t norigin)
{
    struct sets s = {.a = a, .nword = norigin / 64 + 1};
    s.work = CT_NEWN(a, uint64_t, s.nword);
    intern(&s);
    return s;
}

static uint32_t set_of(struct sets *s, uint32_t origin)
{
    memset(s->work, 0, s->nword * sizeof *s->work);
    s->work[origin / 64] = (uint64_t)1 << origin % 64;
    return intern(s);
}

static uint32_t unite(struct sets *s, uint32_t a, uint32_t b)
{
    if (a == b || !a || !b)
        return a | b;
    for (size_t k = 0; k < s->nword; k++)
        s->work[k] = s->word[a * s->nword + k] | s->word[b * s->nword + k];
    return intern(s);
}

// ---- the marked equations ------------------------------------------------------------------

struct finder {
    struct ct_derivation *d;
    const struct ct_reduced *r;
    struct ct_provenance *out;
    size_t term_cap;
    struct ct_arena *a; // of all this
    struct ct_marked_model marked;
    // store of the marked equations; contains the nodes of the printed ones
    struct ct_exs *x;
    struct ct_reduced m; // marked, with the symbols of the equations
    struct sets sets;
    uint32_t *set;   // by node of x: origins of its marks
    ct_ex *plain;    // by node: without marks
    ct_ex *labelled; // by node: marks replaced by labels, and definitions by their symbols
    ct_ex *label;    // by set, once needed
    size_t label_cap;
    ct_ex *definition;  // by node: the symbol that stands for it; 0: none
    double (*value)[2]; // by node: at two points
    uint32_t *shown;    // by node of the printed equations: origins of its symbols
    uint32_t *with; // by origin: the origin listed with it, for a frame its body; itself: none
};

// Derives the same equations from the marked model on the same trees.
static struct ct_build *derive_marked(struct finder *f)
{
    const struct ct_build *like = f->d->e->build;
    struct ct_ctx *quiet = CT_NEW(f->a, struct ct_ctx);
    const struct ct_formulate_options o = {.tree = CT_TREE_GIVEN,
                                           .keep_all = like->options->keep_all,
                                           .rigid = like->options->is_rigid,
                                           .held = like->options->drivers_are_held,
                                           .gaps = like->options->has_offsets,
                                           .like = f->d->e};
    quiet->model = quiet->scratch = f->a;
    struct ct_build *b
        = ct_build_create(quiet, f->a, &f->marked.model, &o, like->options->is_linear);
    if (quiet->nerror || b->topology->nedge != like->topology->nedge
        || b->topology->nnode != like->topology->nnode)
        return NULL;
    b->T = like->T;
    b->R = like->R;
    if (!ct_build_derive(b, true))
        return NULL;
    ct_dynamics_derive(b);
    if (f->r->output)
        ct_outputs_derive(b);
    const struct ct_equations *e = b->eqs, *want = f->d->e;
    bool is_same = e->nu == want->nu && e->nq == want->nq && e->nrow == want->nrow
                && e->ndriver == want->ndriver && e->nswitch <= want->nswitch
                && e->nmemory <= want->nmemory && e->nresult <= want->nresult;
    for (size_t i = 0; i < e->nmemory && is_same; i++)
        is_same = e->memory[i].kind == want->memory[i].kind
               && e->memory[i].joint == want->memory[i].joint;
    return is_same && !quiet->nerror ? b : NULL;
}

// Symbols of e, with at least as many switches and memories as `least`.
static size_t list_symbols(const struct ct_equations *e, const struct ct_equations *least,
                           ct_ex *s)
{
    size_t n = 0;
    for (size_t i = 0; i < e->nq; i++)
        s[n++] = e->q[i].symbol;
    for (size_t i = 0; i < e->nu; i++) {
        s[n++] = e->u[i].symbol;
        s[n++] = e->u[i].derivative;
    }
    for (size_t i = 0; i < e->nrow; i++)
        s[n++] = e->row[i].lam;
    for (size_t i = 0; i < least->nswitch; i++)
        s[n++] = e->switches[i].symbol;
    for (size_t i = 0; i < least->nmemory; i++)
        s[n++] = e->memory[i].symbol;
    return n;
}

// out = the values of `list` (n) at the entries of `want` (nwant). Both are in one order.
static void take_entries(ct_ex *out, const struct ct_entry *want, size_t nwant,
                         const struct ct_entry *list, size_t n)
{
    for (size_t i = 0, next = 0; i < nwant; i++)
        for (size_t k = 0; k < n; k++) {
            const struct ct_entry *at = &list[(next + k) % n];
            if (at->row != want[i].row || at->column != want[i].column)
                continue;
            out[i] = at->value;
            next = (next + k + 1) % n;
            break;
        }
}

// Expressions of the equations in one array: M, J, Q, phi, gam, effort, output.
static size_t count_expressions(const struct finder *f)
{
    const struct ct_equations *e = f->d->e;
    return e->nM + e->nJ + e->nu + 2 * e->nrow + e->ndriver + (f->r->output ? e->nresult : 0);
}

// The equations of the marked build in the order of the printed ones.
static void take_marked(struct finder *f, struct ct_build *b)
{
    const struct ct_equations *e = f->d->e, *own = b->eqs;
    struct ct_reduced *m = &f->m;
    const size_t n = count_expressions(f);
    ct_ex *all = CT_NEWN(f->a, ct_ex, n + 1);
    m->M = all;
    m->J = m->M + e->nM;
    m->Q = m->J + e->nJ;
    m->phi = m->Q + e->nu;
    m->gam = m->phi + e->nrow;
    m->effort = m->gam + e->nrow;
    m->output = m->effort + e->ndriver;
    take_entries(m->M, e->M, e->nM, own->M, own->nM);
    take_entries(m->J, e->J, e->nJ, own->J, own->nJ);
    for (size_t i = 0; i < e->nu; i++)
        m->Q[i] = own->Q[i];
    for (size_t i = 0; i < e->nrow; i++) {
        m->phi[i] = own->row[i].phi;
        m->gam[i] = own->row[i].gam;
    }
    for (size_t i = 0; i < b->topology->ncoordinate; i++)
        if (b->kinematics->coordinate[i].driver >= 0)
            m->effort[b->kinematics->coordinate[i].driver] = ct_driver_effort(b, (int)i);
    for (size_t i = 0; f->r->output && i < own->nresult; i++)
        m->output[i] = own->result[i].value;
    const size_t most = e->nq + 2 * e->nu + e->nrow + e->nswitch + e->nmemory;
    ct_ex *from = CT_NEWN(f->a, ct_ex, most + 1), *to = CT_NEWN(f->a, ct_ex, most + 1);
    list_symbols(own, own, from);
    ct_ex_subst_list(b->x, all, n, from, to, list_symbols(e, own, to));
    f->x = b->x;
}

// ---- marks of nodes ------------------------------------------------------------------------

static ct_ex label_of(struct finder *f, uint32_t set)
{
    if (set >= f->label_cap) {
        const size_t cap = 2 * (size_t)set + 64;
        ct_ex *label = CT_NEWN(f->a, ct_ex, cap);
        if (f->label_cap)
            memcpy(label, f->label, f->label_cap * sizeof *label);
        f->label = label;
        f->label_cap = cap;
    }
    if (ct_ex_is_zero(f->label[set]))
        f->label[set] = ct_ex_sym(f->x, CT_SYM_SEED, "origins", set);
    return f->label[set];
}

static ct_ex with_label(struct finder *f, ct_ex e, uint32_t set)
{
    return set ? ct_ex_mul(f->x, e, label_of(f, set)) : e;
}

// Products and sums are multiplied out; of other functions and denominators marks are factored
// out.
static ct_ex labelled(struct finder *f, uint32_t id, const struct ct_exnode *n)
{
    struct ct_exs *x = f->x;
    double v;
    switch (n->op) {
    case CT_OP_ADD:
    case CT_OP_SUB:
    case CT_OP_MUL:
    case CT_OP_NEG:
        return ct_ex_rebuild(x, *n, f->labelled);
    case CT_OP_DIV: {
        const ct_ex below = ct_ex_div(x, CT_EX_ONE, f->labelled[n->b]);
        const ct_ex plain = ct_ex_div(x, CT_EX_ONE, f->plain[n->b]);
        return ct_ex_mul(x, f->labelled[n->a],
                         f->set[n->b] ? with_label(f, plain, f->set[n->b]) : below);
    }
    case CT_OP_POW:
        if (ct_ex_is_const(x, (ct_ex){n->b}, &v) && v > 0 && v == floor(v))
            return ct_ex_rebuild(x, *n, f->labelled);
        break;
    default:
        break;
    }
    return with_label(f, f->plain[id], f->set[id]);
}

static uint32_t *origin_of_symbols(struct finder *f)
{
    uint32_t *origin = CT_NEWN(f->a, uint32_t, f->x->nsym + 1); // plus one
    for (size_t i = 0; i < f->marked.norigin; i++)
        if (!ct_ex_is_zero(f->marked.mark[i]))
            origin[ct_ex_node(f->x, f->marked.mark[i])->a] = (uint32_t)i + 1;
    return origin;
}

// ---- definitions ---------------------------------------------------------------------------

// A definition found by the values of its expression.
struct named {
    double value[2];
    ct_ex symbol;
};

static int by_size(const void *unused, const void *va, const void *vb)
{
    const struct named *a = va, *b = vb;
    (void)unused;
    return (fabs(a->value[0]) > fabs(b->value[0])) - (fabs(a->value[0]) < fabs(b->value[0]));
}

// Symbols are given numbers between 1/2 and 3/2, the marks 1.
static double number_for(const struct finder *f, uint32_t symbol, int point)
{
    const uint32_t h = (symbol * 2 + (uint32_t)point + 1) * 0x9E3779B1u;
    const struct ct_sym *s = &f->x->sym[symbol];
    const bool is_mark = s->kind == CT_SYM_PARAM && s->index >= f->d->m->nparameter;
    return is_mark ? 1 : 0.5 + (h ^ h >> 15) % 100003 / 100003.;
}

static double value_of(const struct finder *f, uint32_t id, int point)
{
    const struct ct_exnode n = *ct_ex_node(f->x, (ct_ex){id});
    double v;
    if (ct_ex_is_const(f->x, (ct_ex){id}, &v))
        return v;
    if (n.op == CT_OP_SYM)
        return number_for(f, n.a, point);
    if (n.op == CT_OP_TABLE)
        return ct_table_value(&f->x->table[n.b], n.c, f->value[n.a][point]);
    const int narg = ct_op_info[n.op].narg;
    return ct_op_apply((enum ct_op)n.op, f->value[n.a][point],
                       narg > 1 ? f->value[n.b][point] : 0,
                       narg > 2 ? f->value[n.c][point] : 0);
}

// Two values are equal if their relative difference is below this. Sums of some hundred
// products in a different order differ by less; different expressions are not expected to agree
// at two points.
// Derived: n eps, n of some hundred, of products of some factors.
static const double same_value = 1e-10;

static bool is_same(double a, double b)
{
    return fabs(a - b) <= same_value * fabs(b);
}

// The definition with these values, up to a sign (out); 0: there is none.
static ct_ex definition_with(struct finder *f, const struct named *list, size_t n,
                             const double value[2])
{
    size_t low = 0, high = n;
    const double least = fabs(value[0]) * (1 - same_value);
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (fabs(list[middle].value[0]) < least)
            low = middle + 1;
        else
            high = middle;
    }
    for (; low < n && is_same(fabs(list[low].value[0]), fabs(value[0])); low++) {
        const double sign = signbit(list[low].value[0]) == signbit(value[0]) ? 1 : -1;
        if (is_same(sign * list[low].value[1], value[1]))
            return sign > 0 ? list[low].symbol : ct_ex_neg(f->x, list[low].symbol);
    }
    return CT_EX_ZERO;
}

// Definitions of nodes: by node where the marked equations contain it except for marks; the
// others by value, in *out.
static size_t list_named(struct finder *f, const uint32_t *id, size_t nid, struct named **out)
{
    const struct ct_definitions *list = &f->r->definitions;
    bool *is_there = CT_NEWN(f->a, bool, f->x->nnode);
    size_t n = 0;
    for (size_t k = 0; k < nid; k++)
        is_there[f->plain[id[k]].id] |= f->set[id[k]] != 0;
    *out = CT_NEWN(f->a, struct named, list->n + 1);
    f->definition = CT_NEWN(f->a, ct_ex, f->x->nnode);
    for (size_t i = 0; !f->r->is_collected && i < list->n; i++) {
        const double *v = f->value[list->at[i].full.id];
        f->definition[list->at[i].full.id] = list->at[i].symbol;
        if (!is_there[list->at[i].full.id] && isfinite(v[0]) && isfinite(v[1]) && v[0] != 0)
            (*out)[n++] = (struct named){{v[0], v[1]}, list->at[i].symbol};
    }
    ct_sort(f->a, *out, n, sizeof **out, by_size, NULL);
    return n;
}

// Nodes of the marked equations and of the definitions, children before parents.
static size_t list_nodes(struct finder *f, uint32_t **id)
{
    const size_t nroot = count_expressions(f);
    const struct ct_definitions *list = &f->r->definitions;
    ct_ex *root = CT_NEWN(f->a, ct_ex, nroot + list->n + 1);
    memcpy(root, f->m.M, nroot * sizeof *root); // one array (take_marked)
    for (size_t i = 0; i < list->n; i++)
        root[nroot + i] = list->at[i].full;
    const size_t n = ct_ex_walk(f->x, root, nroot + list->n);
    *id = CT_NEWN(f->a, uint32_t, n + 1);
    memcpy(*id, f->x->stack, n * sizeof **id);
    return n;
}

static void mark_nodes(struct finder *f)
{
    uint32_t *id;
    const size_t n = list_nodes(f, &id), before = f->x->nnode;
    const uint32_t *origin = origin_of_symbols(f);
    struct named *named;
    f->set = CT_NEWN(f->a, uint32_t, before);
    f->plain = CT_NEWN(f->a, ct_ex, before);
    f->labelled = CT_NEWN(f->a, ct_ex, before);
    f->value = ct_arena_calloc(f->a, before, sizeof *f->value);
    for (size_t k = 0; k < n; k++) {
        const struct ct_exnode node = *ct_ex_node(f->x, (ct_ex){id[k]});
        const uint32_t arg[3] = {node.a, node.b, node.c};
        f->plain[id[k]] = (ct_ex){id[k]};
        for (int i = 0; i < 2; i++)
            f->value[id[k]][i] = value_of(f, id[k], i);
        if (node.op == CT_OP_SYM && origin[node.a]) {
            f->set[id[k]] = set_of(&f->sets, origin[node.a] - 1);
            f->plain[id[k]] = CT_EX_ONE;
        }
        for (int i = 0; i < ct_op_info[node.op].narg; i++)
            f->set[id[k]] = unite(&f->sets, f->set[id[k]], f->set[arg[i]]);
        if (f->set[id[k]] && ct_op_info[node.op].narg)
            f->plain[id[k]] = ct_ex_rebuild(f->x, node, f->plain);
    }
    const size_t nnamed = list_named(f, id, n, &named);
    for (size_t k = 0; k < n; k++) {
        const struct ct_exnode node = *ct_ex_node(f->x, (ct_ex){id[k]});
        ct_ex definition = f->definition[f->plain[id[k]].id];
        if (ct_ex_is_zero(definition) && ct_op_info[node.op].narg)
            definition = definition_with(f, named, nnamed, f->value[id[k]]);
        f->labelled[id[k]] = ct_ex_is_zero(definition)
                               ? labelled(f, id[k], &node)
                               : with_label(f, definition, f->set[id[k]]);
    }
}

// ---- origins of terms ----------------------------------------------------------------------

// A side of an equation as printed, and the same side of the marked equations.
struct side {
    enum ct_equation_kind kind;
    size_t equation;
    bool is_right;
    size_t nterm; // of the printed side
    ct_ex marked; // of the marked equations, with labels
    uint32_t set; // of all its marks
};

// An expression of f->x copied to its own store, so that the cost of operations does not depend
// on the size of f->x.
struct small {
    struct ct_exs x;
    struct ct_exs *from;
    ct_ex *image; // by node of `from`
};

static ct_ex copy_into(struct small *s, struct ct_arena *a, ct_ex e)
{
    struct ct_exs *from = s->from;
    const size_t n = ct_ex_walk(from, &e, 1);
    uint32_t *id = CT_NEWN(a, uint32_t, n + 1);
    memcpy(id, from->stack, n * sizeof *id);
    for (size_t k = 0; k < n; k++) {
        const struct ct_exnode node = *ct_ex_node(from, (ct_ex){id[k]});
        double v;
        if (s->image[id[k]].id || id[k] == 0)
            continue;
        if (ct_ex_is_const(from, (ct_ex){id[k]}, &v)) {
            s->image[id[k]] = ct_ex_const(&s->x, v);
        } else if (node.op == CT_OP_SYM) {
            const struct ct_sym *symbol = &from->sym[node.a];
            s->image[id[k]] = ct_ex_sym(&s->x, symbol->kind, symbol->name, symbol->index);
        } else {
            s->image[id[k]] = ct_ex_rebuild(&s->x, node, s->image);
        }
    }
    return s->image[e.id];
}

static size_t copy_quaternions(struct finder *f, struct small *s, struct ct_arena *a,
                               ct_ex (**out)[4])
{
    const struct ct_equations *e = f->d->e;
    size_t n = 0;
    *out = ct_arena_calloc(a, e->nq + 1, sizeof **out);
    for (size_t i = 0; i + 3 < e->nq; i++) {
        if (e->q[i].quaternion != 0)
            continue;
        for (size_t k = 0; k < 4; k++)
            (*out)[n][k] = copy_into(s, a, e->q[i + k].symbol);
        n++;
    }
    return n;
}

// Marks of the coefficient if a term is a coefficient times an acceleration or multiplier;
// otherwise those of the whole side.
static uint32_t marks_of_coefficient(const struct finder *f, const struct side *side,
                                     ct_ex term)
{
    const struct ct_equations *e = f->d->e;
    struct ct_exs *x = e->x;
    const size_t n = ct_ex_walk(x, &term, 1);
    const struct ct_sym *factor = NULL;
    for (size_t k = 0; k < n; k++) {
        const struct ct_sym *s = ct_ex_symbol(x, (ct_ex){x->stack[k]});
        if (!s || (s->kind != CT_SYM_A && s->kind != CT_SYM_LAM))
            continue;
        if (factor)
            return side->set;
        factor = s;
    }
    if (!factor || side->kind == CT_EQUATION_EFFORT || side->kind == CT_EQUATION_OUTPUT)
        return side->set;
    const int i = (int)side->equation, k = (int)factor->index;
    if (side->kind == CT_EQUATION_MOTION && factor->kind == CT_SYM_A) {
        for (size_t j = 0; j < e->nM; j++)
            if ((e->M[j].row == i && e->M[j].column == k)
                || (e->M[j].row == k && e->M[j].column == i))
                return f->set[f->m.M[j].id];
    } else {
        const int row = factor->kind == CT_SYM_LAM ? k : i, column = row == k ? i : k;
        for (size_t j = 0; j < e->nJ; j++)
            if (e->J[j].row == row && e->J[j].column == column)
                return f->set[f->m.J[j].id];
    }
    return side->set;
}

// By monomial: its origins in the marked equation; UINT32_MAX: it does not occur.
static uint32_t *sets_of_monomials(struct finder *f, struct ct_arena *a,
                                   const struct ct_normal_monomial *list, size_t n, size_t *cap)
{
    *cap = 0;
    for (size_t i = 0; i < n; i++)
        *cap = list[i].monomial >= *cap ? (size_t)list[i].monomial + 1 : *cap;
    uint32_t *set = CT_NEWN(a, uint32_t, *cap + 1);
    memset(set, 0xFF, *cap * sizeof *set);
    for (size_t i = 0; i < n; i++) {
        uint32_t *at = &set[list[i].monomial];
        *at = unite(&f->sets, *at == UINT32_MAX ? 0 : *at,
                    list[i].label == UINT32_MAX ? 0 : list[i].label);
    }
    return set;
}

// Origins of the terms of a side, matched one by one: set (nterm, out).
static void match(struct finder *f, const struct side *side, const ct_ex *term, size_t nterm,
                  uint32_t *set)
{
    struct ct_arena *a = ct_arena_create_under(f->a);
    struct small s = {.from = f->x, .image = CT_NEWN(a, ct_ex, f->x->nnode)};
    struct ct_normal_monomial *list;
    ct_ex(*quaternion)[4];
    size_t n = 0, cap = 0;
    bool ok = ct_reduced_size(f->x, side->marked, longest) < longest;
    for (size_t i = 0; i < nterm; i++)
        set[i] = UINT32_MAX;
    if (ok) {
        ct_exs_init(&s.x, a);
        s.x.table = f->x->table;
        s.x.ntable = f->x->ntable;
        const size_t nquaternion = copy_quaternions(f, &s, a, &quaternion);
        struct ct_normal_store *store
            = ct_normal_store_create(&s.x, a, (const ct_ex(*)[4])quaternion, nquaternion);
        ok = ct_normal_monomials(store, copy_into(&s, a, side->marked), &list, &n);
        const uint32_t *of = ok ? sets_of_monomials(f, a, list, n, &cap) : NULL;
        for (size_t i = 0; ok && i < nterm; i++) {
            if (!ct_normal_monomials(store, copy_into(&s, a, term[i]), &list, &n))
                continue;
            for (size_t k = 0; k < n; k++)
                if (list[k].monomial < cap && of[list[k].monomial] != UINT32_MAX)
                    set[i] = unite(&f->sets, set[i] == UINT32_MAX ? 0 : set[i],
                                   of[list[k].monomial]);
        }
    }
    for (size_t i = 0; i < nterm; i++)
        if (set[i] == UINT32_MAX)
            set[i] = marks_of_coefficient(f, side, term[i]);
    ct_arena_destroy(a);
}

// ---- sides ---------------------------------------------------------------------------------

static ct_ex expression_of(struct ct_equations *e, const struct ct_reduced *r,
                           enum ct_equation_kind kind, size_t i, bool is_right)
{
    switch (kind) {
    case CT_EQUATION_MOTION:
        return is_right ? ct_reduced_right(e, r, i) : ct_reduced_left(e, r, i);
    case CT_EQUATION_POSITION:
        return r->phi[i];
    case CT_EQUATION_ACCELERATION:
        return is_right ? ct_ex_neg(e->x, r->gam[i]) : ct_reduced_row_left(e, r, i);
    case CT_EQUATION_EFFORT:
        return r->effort[i];
    case CT_EQUATION_OUTPUT:
        return r->output[i];
    }
    return CT_EX_ZERO;
}

static void list_terms(struct finder *f, struct side *side)
{
    struct ct_provenance *p = f->out;
    struct ct_equations *e = f->d->e;
    const size_t before = p->nterm;
    struct ct_print_term *term;
    const ct_ex sum = expression_of(e, f->r, side->kind, side->equation, side->is_right);
    const size_t n = ct_ex_terms(f->d->a, e->x, sum, &f->d->print, &term);
    for (size_t i = 0; i < n; i++) {
        const struct ct_equation_term t
            = {.kind = side->kind,
               .equation = side->equation,
               .is_right = side->is_right,
               .e = term[i].is_subtracted ? ct_ex_neg(e->x, term[i].value) : term[i].value,
               .text = term[i].text};
        if (!ct_ex_is_zero(t.e))
            CT_PUSH(f->d->a, p->term, p->nterm, f->term_cap, t);
    }
    side->nterm = p->nterm - before;
}

static size_t list_sides(struct finder *f, struct side **out)
{
    static const struct {
        enum ct_equation_kind kind;
        bool has_right;
    } kinds[] = {{CT_EQUATION_MOTION, true},
                 {CT_EQUATION_POSITION, false},
                 {CT_EQUATION_ACCELERATION, true},
                 {CT_EQUATION_EFFORT, false},
                 {CT_EQUATION_OUTPUT, false}};
    const struct ct_equations *e = f->d->e;
    const size_t count[] = {e->nu, e->nrow, e->nrow, e->ndriver, f->r->output ? e->nresult : 0};
    size_t n = 0, cap = 0;
    *out = NULL;
    for (size_t k = 0; k < COUNT(kinds); k++)
        for (size_t i = 0; i < count[k]; i++)
            for (int right = 0; right <= kinds[k].has_right; right++) {
                const struct side s = {.kind = kinds[k].kind, .equation = i, .is_right = right};
                CT_PUSH(f->a, *out, n, cap, s);
            }
    return n;
}

// The full expressions of all terms: with definitions substituted.
static void find_full(struct finder *f)
{
    struct ct_provenance *p = f->out;
    const struct ct_definitions *list = &f->r->definitions;
    ct_ex *full = CT_NEWN(f->a, ct_ex, p->nterm + 1), *from = CT_NEWN(f->a, ct_ex, list->n + 1);
    ct_ex *to = CT_NEWN(f->a, ct_ex, list->n + 1);
    for (size_t i = 0; i < list->n; i++) {
        from[i] = list->at[i].symbol;
        to[i] = list->at[i].full;
    }
    for (size_t i = 0; i < p->nterm; i++)
        full[i] = p->term[i].e;
    ct_ex_subst_list(f->d->e->x, full, p->nterm, from, to, list->n);
    for (size_t i = 0; i < p->nterm; i++)
        p->term[i].full = full[i];
}

// ---- symbols -------------------------------------------------------------------------------

static void name_symbol(uint32_t *of, const struct ct_exs *x, ct_ex symbol, uint32_t origin)
{
    of[ct_ex_node(x, symbol)->a] = origin + 1;
}

static uint32_t owner_of_edge(const struct finder *f, int edge, bool *is_known)
{
    const struct ct_edge_info *e = &f->d->e->build->topology->edge[edge];
    *is_known
        = e->kind == CT_EDGE_BODY || e->kind == CT_EDGE_JOINT || e->kind == CT_EDGE_CLOSURE;
    return e->kind == CT_EDGE_BODY ? f->marked.of_body[e->index]
         : *is_known               ? f->marked.of_joint[e->index]
                                   : 0;
}

// By symbol of the equations: the component whose coordinate, speed or multiplier it is, or the
// parameter; plus one.
static uint32_t *owners_of_symbols(const struct finder *f)
{
    const struct ct_equations *e = f->d->e;
    const struct ct_exs *x = e->x;
    uint32_t *of = CT_NEWN(f->a, uint32_t, x->nsym + 1);
    for (size_t i = 0; i < f->d->m->nparameter; i++)
        name_symbol(of, x, f->d->m->parameter[i].symbol, f->marked.of_parameter[i]);
    for (size_t i = 0; i < e->ncoordinate; i++) {
        bool is_known;
        const uint32_t owner = owner_of_edge(f, e->coordinate[i].edge, &is_known);
        if (e->coordinate[i].q >= 0 && is_known)
            name_symbol(of, x, e->q[e->coordinate[i].q].symbol, owner);
    }
    for (size_t i = 0; i < e->nu; i++) {
        const struct ct_u *u = &e->u[i];
        const int body = u->beam ? u->beam : u->body;
        if (u->joint < 0 && body < 0)
            continue;
        const uint32_t owner
            = u->joint >= 0 ? f->marked.of_joint[u->joint] : f->marked.of_body[body];
        name_symbol(of, x, u->symbol, owner);
        name_symbol(of, x, u->derivative, owner);
        if (u->q >= 0)
            name_symbol(of, x, e->q[u->q].symbol, owner);
    }
    for (size_t i = 0; i < e->nrow; i++)
        if (e->row[i].joint >= 0)
            name_symbol(of, x, e->row[i].lam, f->marked.of_joint[e->row[i].joint]);
    for (size_t i = 0; i < e->nmemory; i++)
        if (e->memory[i].joint >= 0)
            name_symbol(of, x, e->memory[i].symbol, f->marked.of_joint[e->memory[i].joint]);
    return of;
}

static void find_shown(struct finder *f)
{
    struct ct_exs *x = f->d->e->x;
    const ct_ex *root = ct_provenance_values(f->a, f->out);
    const size_t n = ct_ex_walk(x, root, f->out->nterm);
    uint32_t *id = CT_NEWN(f->a, uint32_t, n + 1);
    const uint32_t *owner = owners_of_symbols(f);
    memcpy(id, x->stack, n * sizeof *id);
    f->shown = CT_NEWN(f->a, uint32_t, x->nnode);
    for (size_t k = 0; k < n; k++) { // children before parents
        const struct ct_exnode node = *ct_ex_node(x, (ct_ex){id[k]});
        const uint32_t arg[3] = {node.a, node.b, node.c};
        if (node.op == CT_OP_SYM && owner[node.a])
            f->shown[id[k]] = set_of(&f->sets, owner[node.a] - 1);
        for (int i = 0; i < ct_op_info[node.op].narg; i++)
            f->shown[id[k]] = unite(&f->sets, f->shown[id[k]], f->shown[arg[i]]);
    }
}

// Adds the bodies of frames.
static void find_bodies_of_frames(struct finder *f)
{
    const struct ct_model *m = f->d->m;
    f->with = CT_NEWN(f->a, uint32_t, f->marked.norigin + 1);
    for (size_t i = 0; i < f->marked.norigin; i++)
        f->with[i] = (uint32_t)i;
    for (size_t i = 0; i < m->nframe; i++)
        f->with[f->marked.of_frame[i]] = f->marked.of_body[m->frame[i].body];
}

// ---- the entry -----------------------------------------------------------------------------

static bool has(const struct sets *s, uint32_t set, uint32_t origin)
{
    return s->word[set * s->nword + origin / 64] >> origin % 64 & 1;
}

static void put_origins(struct finder *f, struct ct_equation_term *t, uint32_t set)
{
    set = unite(&f->sets, set, f->shown[t->full.id]);
    for (uint32_t i = 0; i < f->marked.norigin; i++)
        if (has(&f->sets, set, i) && f->with[i] != i)
            set = unite(&f->sets, set, set_of(&f->sets, f->with[i]));
    size_t cap = 0;
    uint32_t *list = NULL;
    for (uint32_t i = 0; i < f->marked.norigin; i++)
        if (has(&f->sets, set, i))
            CT_PUSH(f->d->a, list, t->norigin, cap, i);
    t->origin = list;
}

static uint32_t set_of_side(struct finder *f, const struct side *s)
{
    const struct ct_equations *e = f->d->e;
    const int i = (int)s->equation;
    uint32_t set = 0;
    switch (s->kind) {
    case CT_EQUATION_MOTION:
        for (size_t k = 0; !s->is_right && k < e->nM; k++)
            if (e->M[k].row == i || e->M[k].column == i)
                set = unite(&f->sets, set, f->set[f->m.M[k].id]);
        if (s->is_right)
            set = f->set[f->m.Q[i].id];
        for (size_t k = 0; s->is_right && k < e->nJ; k++)
            if (e->J[k].column == i)
                set = unite(&f->sets, set, f->set[f->m.J[k].id]);
        return set;
    case CT_EQUATION_POSITION:
        return f->set[f->m.phi[i].id];
    case CT_EQUATION_ACCELERATION:
        for (size_t k = 0; !s->is_right && k < e->nJ; k++)
            if (e->J[k].row == i)
                set = unite(&f->sets, set, f->set[f->m.J[k].id]);
        return s->is_right ? f->set[f->m.gam[i].id] : set;
    case CT_EQUATION_EFFORT:
        return f->set[f->m.effort[i].id];
    case CT_EQUATION_OUTPUT:
        return f->set[f->m.output[i].id];
    }
    return set;
}

// The marked equations with labels, as printed.
static struct ct_reduced with_labels(struct finder *f)
{
    struct ct_reduced r = f->m;
    const size_t n = count_expressions(f);
    ct_ex *all = CT_NEWN(f->a, ct_ex, n + 1);
    for (size_t i = 0; i < n; i++)
        all[i] = f->labelled[f->m.M[i].id]; // one array (take_marked)
    r.M = all;
    r.J = all + (f->m.J - f->m.M);
    r.Q = all + (f->m.Q - f->m.M);
    r.phi = all + (f->m.phi - f->m.M);
    r.gam = all + (f->m.gam - f->m.M);
    r.effort = all + (f->m.effort - f->m.M);
    r.output = all + (f->m.output - f->m.M);
    return r;
}

static void find_marks(struct finder *f, struct side *side, size_t nside, uint32_t *set)
{
    const struct ct_provenance *p = f->out;
    struct ct_equations there = *f->d->e; // in the store of the marked equations
    there.x = f->x;
    mark_nodes(f);
    const struct ct_reduced r = with_labels(f);
    ct_ex *term = CT_NEWN(f->a, ct_ex, p->nterm + 1);
    for (size_t i = 0; i < p->nterm; i++)
        term[i] = f->r->is_collected ? p->term[i].full : p->term[i].e;
    size_t first = 0;
    for (size_t k = 0; k < nside; k++) {
        struct side *s = &side[k];
        s->set = set_of_side(f, s);
        s->marked = expression_of(&there, &r, s->kind, s->equation, s->is_right);
        match(f, s, term + first, s->nterm, set + first);
        first += s->nterm;
    }
}

// Outputs that are reactions or accelerations, collected like the equations; others have no
// list of terms. NULL: none.
static ct_ex *list_outputs(struct ct_derivation *d, const struct ct_reduced *r)
{
    const unsigned wanted = 1u << CT_SYM_A | 1u << CT_SYM_LAM;
    struct ct_equations *e = d->e;
    ct_ex *output = CT_NEWN(d->a, ct_ex, e->nresult + 1);
    bool any = false;
    for (size_t i = 0; i < e->nresult && r->is_collected; i++)
        if (ct_ex_kinds(e->x, e->result[i].value) & wanted
            && ct_reduced_size(e->x, e->result[i].value, longest) < longest) {
            output[i] = ct_reduced_collect_force(e, d->a, e->result[i].value);
            any = true;
        }
    return any ? output : NULL;
}

void ct_provenance_derive(struct ct_derivation *d, const struct ct_reduced *r,
                          struct ct_provenance *p)
{
    *p = (struct ct_provenance){0};
    struct ct_arena *work = ct_arena_create_under(d->a);
    struct ct_reduced all = *r;
    struct finder f = {.d = d, .r = &all, .out = p, .a = work};
    all.output = list_outputs(d, r);
    struct side *side;
    const size_t nside = list_sides(&f, &side);
    for (size_t i = 0; i < nside; i++)
        list_terms(&f, &side[i]);
    find_full(&f);
    // the following uses a copy of the store, which contains all these expressions
    ct_marked_model_create(work, d->m, ct_exs_clone(work, d->e->x), &f.marked);
    f.sets = make_sets(work, f.marked.norigin);
    find_shown(&f);
    find_bodies_of_frames(&f);
    uint32_t *set = CT_NEWN(work, uint32_t, p->nterm + 1);
    struct ct_build *b = derive_marked(&f);
    if (b) {
        take_marked(&f, b);
        find_marks(&f, side, nside, set);
    }
    for (size_t i = 0; i < p->nterm; i++)
        put_origins(&f, &p->term[i], set[i]);
    p->norigin = f.marked.norigin;
    p->origin = CT_NEWN(d->a, struct ct_origin, p->norigin + 1);
    memcpy(p->origin, f.marked.origin, p->norigin * sizeof *p->origin);
    ct_arena_destroy(work);
}

const char *ct_provenance_equation(const struct ct_equations *e,
                                   const struct ct_equation_term *t)
{
    switch (t->kind) {
    case CT_EQUATION_MOTION:
        return e->u[t->equation].name;
    case CT_EQUATION_EFFORT:
        return e->driver[t->equation].name;
    case CT_EQUATION_OUTPUT:
        return e->result[t->equation].name;
    default:
        return e->row[t->equation].name;
    }
}

ct_ex *ct_provenance_values(struct ct_arena *a, const struct ct_provenance *p)
{
    ct_ex *value = CT_NEWN(a, ct_ex, p->nterm + 1);
    for (size_t i = 0; i < p->nterm; i++)
        value[i] = p->term[i].full;
    return value;
}
