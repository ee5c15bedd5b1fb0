// Choice of shared subexpressions; see share.h.
//
// Two sweeps per definition. The upward sweep finds the length of each node's text, where a named
// node counts as the length of its name. The downward sweep finds how often the text is printed,
// where the text below a named node is printed once.
#include "expr/share.h"

#include "base/names.h"
#include "base/sort.h"

#include <math.h>
#include <string.h>

struct sharing {
    struct ct_arena *arena; // of the list
    struct ct_arena *work;
    struct ct_exs *x;
    struct ct_share_options o;
    uint32_t *id; // nodes below the roots, ascending; what follows is by place in this list
    uint32_t (*arg)[3]; // places of the operands
    size_t n;
    uint32_t *root; // places (nroot)
    size_t nroot;
    double *own;          // characters of the operator
    double *size, *times; // length of the text, occurrences in the print
    const char **meaning; // a name by meaning, NULL
    double *saving;       // of chosen nodes, else 0
    double total;
};

static const char *label_of(void *unused, const struct ct_exs *x, ct_ex e)
{
    (void)unused;
    return e.id < x->label_cap ? x->label[e.id] : NULL;
}

static int noperand(const struct sharing *s, size_t k)
{
    return ct_op_info[s->x->node[s->id[k]].op].narg;
}

// ---- lengths ----------------------------------------------------------------------------------

// Characters that an operator adds to those of its operands; parentheses of products are estimated.
static double own_length(const struct sharing *s, uint32_t id)
{
    const struct ct_exnode *n = &s->x->node[id];
    double v;
    switch (n->op) {
    case CT_OP_CONST:
        ct_ex_is_const(s->x, (ct_ex){id}, &v);
        return v == floor(v) ? 1 : 6;
    case CT_OP_SYM:
        return (double)strlen(s->x->sym[n->a].name);
    case CT_OP_ADD:
    case CT_OP_SUB:
        return 3;
    case CT_OP_MUL:
    case CT_OP_DIV:
    case CT_OP_POW:
    case CT_OP_NEG:
        return 1.5;
    default:
        return (double)strlen(ct_op_info[n->op].name) + 2;
    }
}

static double name_length(const struct sharing *s, size_t k)
{
    return s->meaning[k] ? (double)strlen(s->meaning[k]) : 2;
}

static double shown_length(const struct sharing *s, size_t k)
{
    return s->saving[k] > 0 ? name_length(s, k) : s->size[k];
}

static void measure(struct sharing *s)
{
    for (size_t k = 0; k < s->n; k++) {
        s->times[k] = 0;
        s->size[k] = s->own[k];
        for (int i = noperand(s, k); i-- > 0;)
            s->size[k] += shown_length(s, s->arg[k][i]);
    }
    s->total = 0;
    for (size_t k = 0; k < s->nroot; k++) {
        s->times[s->root[k]]++;
        s->total += shown_length(s, s->root[k]);
    }
    for (size_t k = s->n; k-- > 0;) {
        const double bodies = s->saving[k] > 0 ? 1 : s->times[k];
        for (int i = noperand(s, k); i-- > 0;)
            s->times[s->arg[k][i]] += bodies;
        if (s->saving[k] > 0)
            s->total += s->size[k] + name_length(s, k) + 4;
    }
}

// ---- choice -----------------------------------------------------------------------------------

static bool is_leaf(const struct ct_exs *x, uint32_t id)
{
    return x->node[id].op == CT_OP_CONST || x->node[id].op == CT_OP_SYM;
}

static bool is_trivial(const struct ct_exs *x, uint32_t id)
{
    const struct ct_exnode *n = &x->node[id];
    if (is_leaf(x, id) || n->op == CT_OP_NEG)
        return true;
    if (ct_op_info[n->op].narg == 1)
        return is_leaf(x, n->a);
    return n->op == CT_OP_MUL && ct_ex_is_const(x, (ct_ex){n->a}, NULL) && is_leaf(x, n->b);
}

// What naming a node saves: all prints but one become the name, and there is a line `name = `.
static double saving_of(const struct sharing *s, size_t k)
{
    const double name = name_length(s, k), times = s->times[k];
    return (times - 1) * s->size[k] - (times + 1) * name - 4;
}

// A name by meaning counts twice: it explains.
static double worth_of(const struct sharing *s, size_t k)
{
    if (s->saving[k] > 0 || is_trivial(s->x, s->id[k]))
        return 0;
    return saving_of(s, k) * (s->meaning[k] ? 2 : 1);
}

// In graphs of more nodes than this several names are chosen per sweep: all that save at least half
// as much as the best. Names that others make useless are removed at the end. Limit: one name at a
// time costs the square of the nodes.
enum { LARGE_GRAPH = 1000 };

// Names the node that saves most; ties go to the older one. Returns how many were named.
static size_t choose(struct sharing *s, size_t most)
{
    double best = s->o.least;
    size_t chosen = s->n;
    for (size_t k = 0; k < s->n; k++) {
        const double worth = worth_of(s, k);
        if (worth > best) {
            best = worth;
            chosen = k;
        }
    }
    if (chosen == s->n)
        return 0;
    size_t n = 0;
    const double enough = s->n > LARGE_GRAPH ? fmax(best / 2, s->o.least) : best;
    for (size_t k = 0; k < s->n && n < most; k++) {
        if (worth_of(s, k) < enough || (s->n <= LARGE_GRAPH && k != chosen))
            continue;
        s->saving[k] = saving_of(s, k);
        n++;
    }
    return n;
}

// Remove a definition that, after later choices, is used only once.
static bool drop_useless(struct sharing *s)
{
    bool any = false;
    for (size_t k = 0; k < s->n; k++)
        if (s->saving[k] > 0 && s->times[k] < 1.5) {
            s->saving[k] = 0;
            any = true;
        }
    return any;
}

// ---- names ------------------------------------------------------------------------------------

static bool is_taken(const struct ct_names *taken, const char *name)
{
    return ct_names_get(taken, name + (name[0] == '-')) >= 0;
}

static const char *free_name(const struct sharing *s, const struct ct_names *taken,
                             size_t *number)
{
    const char *name;
    do
        name = ct_arena_printf(s->arena, "t%zu", ++*number);
    while (is_taken(taken, name));
    return name;
}

static struct ct_share list_definitions(struct sharing *s)
{
    struct ct_share list = {.size = s->total};
    struct ct_names taken = {0};
    size_t cap = 0, number = 0;
    for (size_t k = 0; k < s->x->nsym; k++)
        ct_names_put(s->work, &taken, s->x->sym[k].name, 0);
    for (size_t k = 0; k < s->n; k++) {
        if (!(s->saving[k] > 0))
            continue;
        struct ct_definition d = {{s->id[k]}, s->meaning[k], s->saving[k]};
        if (!d.name || is_taken(&taken, d.name))
            d.name = free_name(s, &taken, &number);
        ct_names_put(s->work, &taken, d.name + (d.name[0] == '-'), 0);
        CT_PUSH(s->arena, list.at, list.n, cap, d);
    }
    return list;
}

// ---- entries ----------------------------------------------------------------------------------

static int by_id(const void *unused, const void *a, const void *b)
{
    const uint32_t m = *(const uint32_t *)a, n = *(const uint32_t *)b;
    (void)unused;
    return (m > n) - (m < n);
}

static void list_nodes(struct sharing *s, const ct_ex *root)
{
    struct ct_exs *x = s->x;
    const char *(*name)(void *, const struct ct_exs *, ct_ex)
        = s->o.name ? s->o.name : label_of;
    s->n = ct_ex_walk(x, root, s->nroot);
    s->id = CT_NEWN(s->work, uint32_t, s->n + 1);
    memcpy(s->id, x->stack, s->n * sizeof *s->id);
    // children have smaller ids, so this is an order for both sweeps
    ct_sort(s->work, s->id, s->n, sizeof *s->id, by_id, NULL);
    ct_ex *place = x->memo; // by id; no further walk starts in this loop
    s->arg = ct_arena_calloc(s->work, s->n + 1, sizeof *s->arg);
    s->root = CT_NEWN(s->work, uint32_t, s->nroot + 1);
    s->own = CT_NEWN(s->work, double, s->n + 1);
    s->size = CT_NEWN(s->work, double, s->n + 1);
    s->times = CT_NEWN(s->work, double, s->n + 1);
    s->saving = CT_NEWN(s->work, double, s->n + 1);
    s->meaning = CT_NEWN(s->work, const char *, s->n + 1);
    for (size_t k = 0; k < s->n; k++) {
        const struct ct_exnode *n = &x->node[s->id[k]];
        const uint32_t arg[3] = {n->a, n->b, n->c};
        place[s->id[k]].id = (uint32_t)k;
        for (int i = 0; i < noperand(s, k); i++)
            s->arg[k][i] = place[arg[i]].id;
    }
    for (size_t k = 0; k < s->nroot; k++)
        s->root[k] = place[root[k].id].id;
    for (size_t k = 0; k < s->n; k++) {
        s->own[k] = own_length(s, s->id[k]);
        s->meaning[k] = name(s->o.data, x, (ct_ex){s->id[k]});
    }
}

// Name all labelled nodes with two users. This keeps the lengths finite: the unfolded text of a
// recursion can exceed the range of double.
static void choose_names(struct sharing *s)
{
    unsigned char *users = CT_NEWN(s->work, unsigned char, s->n + 1);
    for (size_t k = 0; k < s->nroot; k++)
        users[s->root[k]] += users[s->root[k]] < 2;
    for (size_t k = 0; k < s->n; k++)
        for (int i = noperand(s, k); i-- > 0;)
            users[s->arg[k][i]] += users[s->arg[k][i]] < 2;
    for (size_t k = 0; k < s->n; k++)
        if (s->meaning[k] && users[k] > 1 && !is_trivial(s->x, s->id[k]))
            s->saving[k] = 1;
}

struct ct_share ct_ex_share(struct ct_arena *a, struct ct_exs *x, const ct_ex *e, size_t n,
                            const struct ct_share_options *options)
{
    struct sharing s = {.arena = a, .work = ct_arena_create_under(a), .x = x, .nroot = n};
    if (options)
        s.o = *options;
    s.o.most = s.o.most ? s.o.most : 40;
    s.o.enough = s.o.enough > 0 ? s.o.enough : 1500;
    s.o.least = s.o.least > 0 ? s.o.least : 20;
    list_nodes(&s, e);
    if (s.o.names_first)
        choose_names(&s);
    measure(&s);
    for (size_t k = 0, named; k < s.o.most && s.total > s.o.enough; k += named) {
        named = choose(&s, s.o.most - k);
        if (!named)
            break;
        measure(&s);
    }
    while (drop_useless(&s))
        measure(&s);
    const struct ct_share list = list_definitions(&s);
    ct_arena_destroy(s.work);
    return list;
}

const char *ct_share_name(void *data, ct_ex e)
{
    const struct ct_share *s = data;
    size_t low = 0, high = s->n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (s->at[middle].e.id < e.id)
            low = middle + 1;
        else
            high = middle;
    }
    return low < s->n && s->at[low].e.id == e.id ? s->at[low].name : NULL;
}
