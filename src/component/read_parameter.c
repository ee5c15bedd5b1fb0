// Read parameters: names first, then definitions, then values in an order in which each can be
// computed.
#include "component/read.h"

#include "expr/parse.h"
#include "expr/unit.h"

#include <math.h>
#include <string.h>

enum dfs_state { UNVISITED, ON_PATH, DONE };

// Parameters in the order of the file, before topological sorting.
struct work {
    size_t n;
    const struct ct_node **node; // definition; NULL when overridden
    bool *is_wrong;              // has no value, and this has been reported
    int **use;                   // parameters that each definition uses
    size_t *nuse;
    enum dfs_state *dfs_state;
    int *order; // topological order
    size_t norder;
};

static bool add_parameter(struct ct_reader *r, const struct ct_node_pair *p, bool is_input)
{
    struct ct_model *m = r->m;
    const char *sort = is_input ? "input" : "parameter";
    if (!ct_read_name(r, p->key, p->mark, sort))
        return false;
    if (ct_is_reserved(p->key))
        return ct_error(r->ctx, p->mark, CT_E_NAME,
                        "'%s' cannot name %s %s: it has a meaning in expressions", p->key,
                        is_input ? "an" : "a", sort);
    const int other = ct_names_get(&m->parameter_index, p->key);
    if (other >= 0 && m->parameter[other].is_input != is_input)
        return ct_error(r->ctx, p->mark, CT_E_NAME,
                        "'%s' is a parameter already: give the "
                        "input another name",
                        p->key);
    if (other >= 0)
        return false; // a duplicate key has been reported
    if (ct_names_get(&m->state_index, p->key) >= 0)
        return ct_error(r->ctx, p->mark, CT_E_NAME,
                        "'%s' is a state already: give the %s another name", p->key, sort);
    const int i = (int)m->nparameter;
    const ct_ex s = ct_ex_sym(m->x, CT_SYM_PARAM, p->key, (uint32_t)i);
    m->x->sym[ct_ex_node(m->x, s)->a].mark = p->mark;
    const struct ct_parameter new
        = {.name = p->key, .mark = p->mark, .symbol = s, .is_input = is_input};
    CT_PUSH(r->a, m->parameter, m->nparameter, m->parameter_cap, new);
    ct_names_put(r->a, &m->parameter_index, p->key, i);
    CT_PUSH(r->a, r->known, r->nknown, r->known_cap, p->key);
    return true;
}

static const char *const input_keys[] = {"value", "unit"};

const struct ct_node *ct_read_with_unit(struct ct_reader *r, const struct ct_node *number,
                                        const struct ct_node *unit)
{
    const char *name = NULL;
    double value;
    if (!unit || number->kind != CT_NODE_SCALAR || !ct_read_text(r, unit, &name))
        return number;
    const size_t sign = number->text[0] == '-';
    if (number->text[sign + ct_number_parse(number->text + sign, &value)] != 0)
        return number;
    struct ct_node *both = CT_NEW(r->a, struct ct_node);
    *both = *number;
    both->text = ct_arena_printf(r->a, "%s %s", number->text, name);
    both->is_exact = false;
    both->mark = unit->mark;
    return both;
}

// The value of an input, `{value: V, unit: U}` or V itself; the unit applies if V has none of its
// own.
static const struct ct_node *input_value(struct ct_reader *r, const struct ct_node_pair *p)
{
    const struct ct_node *node = p->value;
    if (node->kind != CT_NODE_MAP)
        return node;
    ct_read_keys(r, node, ct_arena_printf(r->a, "input '%s'", p->key), input_keys,
                 COUNT(input_keys));
    const struct ct_node *value = ct_node_get(node, "value"), *unit = ct_node_get(node, "unit");
    struct ct_node *zero = CT_NEW(r->a, struct ct_node);
    *zero = (struct ct_node){
        .kind = CT_NODE_SCALAR, .mark = node->mark, .text = "0", .is_plain = true};
    return ct_read_with_unit(r, value ? value : zero, unit);
}

// Assign the errors since number `first` to the command line.
static void move_errors_to_command_line(struct ct_reader *r, size_t first, const char *text)
{
    for (size_t i = first; i < r->ctx->ndiagnostic; i++) {
        struct ct_finding *d = &r->ctx->diagnostic[i];
        d->mark = (struct ct_mark){0};
        d->code = d->severity == CT_SEVERITY_NOTE ? 0 : CT_E_USAGE;
        d->text = ct_arena_printf(r->a, "--set '%s': %s", text, d->text);
    }
}

static bool parse_override(struct ct_reader *r, const char *text, struct work *w)
{
    const struct ct_mark none = {0};
    const char *equals = strchr(text, '=');
    if (!equals || equals == text)
        return ct_error(r->ctx, none, CT_E_USAGE, "NAME=VALUE is wanted");
    const char *name = ct_arena_strndup(r->a, text, (size_t)(equals - text));
    const int i = ct_names_get(&r->m->parameter_index, name);
    if (i < 0)
        return ct_error(r->ctx, none, CT_E_USAGE, "the model has no parameter '%s'%s", name,
                        ct_read_suggestion(r, name, r->known + 1, r->nknown - 1));
    if (r->m->parameter[i].is_played)
        return ct_error(r->ctx, none, CT_E_USAGE, "a file plays the input '%s'", name);
    const struct ct_node value
        = {.kind = CT_NODE_SCALAR, .text = ct_arena_strdup(r->a, equals + 1), .is_plain = true};
    w->node[i] = NULL;
    struct ct_parameter *p = &r->m->parameter[i];
    w->is_wrong[i] = !ct_read_expr(r, &value, 0, p->unit, &p->definition);
    p->unit = ct_parse_unit(value.text) ? ct_parse_unit(value.text) : p->unit;
    return !w->is_wrong[i];
}

static bool apply_overrides(struct ct_reader *r, const struct ct_set *set, size_t nset,
                            struct work *w)
{
    bool ok = true;
    for (size_t k = 0; k < nset; k++) {
        if (set[k].kind != CT_SET_VALUE)
            continue;
        const size_t first = r->ctx->ndiagnostic;
        ok &= parse_override(r, set[k].text, w);
        move_errors_to_command_line(r, first, set[k].text);
    }
    return ok;
}

static void find_uses(struct ct_reader *r, size_t i, struct work *w)
{
    struct ct_exs *x = r->m->x;
    const size_t n = ct_ex_walk(x, &r->m->parameter[i].definition, 1);
    w->use[i] = CT_NEWN(r->ctx->scratch, int, n);
    for (size_t k = 0; k < n; k++) {
        const struct ct_sym *s = ct_ex_symbol(x, (ct_ex){x->stack[k]});
        if (s && s->kind == CT_SYM_PARAM)
            w->use[i][w->nuse[i]++] = (int)s->index;
    }
}

static bool report_cycle(struct ct_reader *r, const struct work *w, const int *path, size_t n)
{
    const struct ct_model *m = r->m;
    const char *text = m->parameter[path[0]].name;
    for (size_t k = 1; k < n; k++)
        text = ct_arena_printf(r->ctx->scratch, "%s -> %s", text, m->parameter[path[k]].name);
    const struct ct_node *node = w->node[path[0]];
    return ct_error(r->ctx, node ? node->mark : (struct ct_mark){0},
                    node ? CT_E_CYCLE : CT_E_USAGE, "the parameter depends on itself: %s -> %s",
                    text, m->parameter[path[0]].name);
}

// Depth-first search from `start` with an explicit stack: a chain may be as long as the file.
static bool visit(struct ct_reader *r, struct work *w, int start, int *path, size_t *next)
{
    bool ok = true;
    size_t depth = 0;
    path[depth++] = start;
    w->dfs_state[start] = ON_PATH;
    while (depth) {
        const int i = path[depth - 1];
        if (next[i] == w->nuse[i]) {
            w->dfs_state[i] = DONE;
            w->order[w->norder++] = i;
            depth--;
            continue;
        }
        const int j = w->use[i][next[i]++];
        if (w->dfs_state[j] == ON_PATH) {
            size_t k = depth - 1;
            while (path[k] != j)
                k--;
            ok = report_cycle(r, w, path + k, depth - k);
        } else if (w->dfs_state[j] == UNVISITED) {
            w->dfs_state[j] = ON_PATH;
            path[depth++] = j;
        }
    }
    return ok;
}

static bool order_parameters(struct ct_reader *r, struct work *w)
{
    int *path = CT_NEWN(r->ctx->scratch, int, w->n);
    size_t *next = CT_NEWN(r->ctx->scratch, size_t, w->n);
    bool ok = true;
    for (size_t i = 0; i < w->n; i++)
        find_uses(r, i, w);
    for (size_t i = 0; i < w->n; i++)
        if (w->dfs_state[i] == UNVISITED)
            ok &= visit(r, w, (int)i, path, next);
    return ok;
}

// Permute the parameters to the topological order, with their symbols and the map of names.
static void permute(struct ct_reader *r, struct work *w)
{
    struct ct_model *m = r->m;
    struct ct_parameter *sorted = CT_NEWN(r->a, struct ct_parameter, w->n);
    const struct ct_node **node = CT_NEWN(r->ctx->scratch, const struct ct_node *, w->n);
    bool *is_wrong = CT_NEWN(r->ctx->scratch, bool, w->n);
    m->parameter_index = (struct ct_names){0};
    for (size_t k = 0; k < w->n; k++) {
        sorted[k] = m->parameter[w->order[k]];
        node[k] = w->node[w->order[k]];
        is_wrong[k] = w->is_wrong[w->order[k]];
        m->x->sym[ct_ex_node(m->x, sorted[k].symbol)->a].index = (uint32_t)k;
        ct_names_put(r->a, &m->parameter_index, sorted[k].name, (int)k);
    }
    m->parameter = sorted;
    m->parameter_cap = w->n;
    w->node = node;
    w->is_wrong = is_wrong;
}

// Is a value not finite only because another parameter is not?
static bool is_passed_on(struct ct_model *m, ct_ex definition)
{
    for (size_t k = ct_ex_walk(m->x, &definition, 1); k-- > 0;) {
        const struct ct_sym *s = ct_ex_symbol(m->x, (ct_ex){m->x->stack[k]});
        if (s && !isfinite(m->parameter[s->index].value))
            return true;
    }
    return false;
}

static bool evaluate(struct ct_reader *r, const struct work *w, size_t i)
{
    struct ct_model *m = r->m;
    struct ct_parameter *p = &m->parameter[i];
    if (w->is_wrong[i])
        return false;
    const double v = ct_ex_value(m->x, p->definition, m->value);
    if (isfinite(v)) {
        p->value = m->value[ct_ex_node(m->x, p->symbol)->a] = v;
        return true;
    }
    if (is_passed_on(m, p->definition))
        return false;
    if (w->node[i])
        return ct_error(r->ctx, w->node[i]->mark, CT_E_NUMBER,
                        "the parameter '%s' is not a finite number", p->name);
    return ct_error(r->ctx, (struct ct_mark){0}, CT_E_USAGE,
                    "--set: the parameter '%s' is not a finite number", p->name);
}

void ct_read_parameters(struct ct_reader *r, const struct ct_set *set, size_t nset)
{
    const struct ct_node *node = ct_node_get(r->root, "parameters");
    const struct ct_node *inputs = ct_node_get(r->root, "inputs");
    bool ok = true;
    CT_PUSH(r->a, r->known, r->nknown, r->known_cap, "t");
    if (node && ct_node_is_null(node))
        node = NULL;
    if (node && !ct_read_shape(r, node, CT_NODE_MAP, "a map of parameters"))
        return;
    if (inputs && ct_node_is_null(inputs))
        inputs = NULL;
    if (inputs && !ct_read_shape(r, inputs, CT_NODE_MAP, "a map of inputs"))
        return;
    const size_t nparameter = node ? node->n : 0, n = nparameter + (inputs ? inputs->n : 0);
    struct ct_arena *scratch = r->ctx->scratch;
    struct work w = {.node = CT_NEWN(scratch, const struct ct_node *, n)};
    for (size_t i = 0; i < n; i++) {
        const bool is_input = i >= nparameter;
        const struct ct_node_pair *p
            = is_input ? &inputs->pair[i - nparameter] : &node->pair[i];
        if (add_parameter(r, p, is_input))
            w.node[w.n++] = is_input ? input_value(r, p) : p->value;
        else
            ok = false;
    }
    w.use = CT_NEWN(scratch, int *, w.n);
    w.nuse = CT_NEWN(scratch, size_t, w.n);
    w.dfs_state = CT_NEWN(scratch, enum dfs_state, w.n);
    w.order = CT_NEWN(scratch, int, w.n);
    w.is_wrong = CT_NEWN(scratch, bool, w.n);
    r->m->value = CT_NEWN(r->a, double, r->m->x->nsym);
    for (size_t i = 0; i < w.n; i++)
        if (w.node[i]->kind == CT_NODE_SCALAR)
            r->m->parameter[i].unit = ct_parse_unit(w.node[i]->text);
    for (size_t k = 0; k < nset; k++)
        if (set[k].kind == CT_SET_INPUTS || set[k].kind == CT_SET_INPUTS_HELD)
            ok &= ct_read_played_inputs(r, set[k].text, set[k].kind == CT_SET_INPUTS_HELD);
    for (size_t i = 0; i < w.n; i++) {
        w.is_wrong[i] = !ct_read_expr(r, w.node[i], 0, NULL, &r->m->parameter[i].definition);
        r->m->parameter[i].value = NAN; // until it is computed
        r->m->value[1 + i] = NAN;
    }
    ok &= apply_overrides(r, set, nset, &w);
    ok &= order_parameters(r, &w);
    permute(r, &w);
    for (size_t i = 0; i < w.n; i++)
        ok &= evaluate(r, &w, i);
    r->parameters_ok = ok;
}
