// Read user-defined states: names first; rates and initial values when all signals have names.
#include "component/read.h"

#include "expr/parse.h"
#include "expr/quantity.h"

#include <string.h>

static const char *const keys[] = {"rate", "initial", "unit"};

static bool add_state(struct ct_reader *r, const struct ct_node_pair *p)
{
    struct ct_model *m = r->m;
    if (!ct_read_name(r, p->key, p->mark, "state"))
        return false;
    if (ct_is_reserved(p->key))
        return ct_error(r->ctx, p->mark, CT_E_NAME,
                        "'%s' cannot name a state: it has a meaning in expressions", p->key);
    if (ct_names_get(&m->state_index, p->key) >= 0)
        return false; // a duplicate key has been reported
    const struct ct_state new = {.name = p->key, .mark = p->mark, .rate_mark = p->mark};
    ct_names_put(r->a, &m->state_index, p->key, (int)m->nstate);
    CT_PUSH(r->a, m->state, m->nstate, m->state_cap, new);
    CT_PUSH(r->ctx->scratch, r->state_node, r->nstate_node, r->state_node_cap, p->value);
    return true;
}

void ct_read_states_declare(struct ct_reader *r)
{
    const struct ct_node *node = ct_node_get(r->root, "states");
    if (!node || ct_node_is_null(node)
        || !ct_read_shape(r, node, CT_NODE_MAP, "a map of states"))
        return;
    for (size_t i = 0; i < node->n; i++)
        add_state(r, &node->pair[i]);
}

static bool is_no_name(const void *user, const char *word)
{
    (void)user;
    (void)word;
    return false;
}

static bool read_unit(struct ct_reader *r, const struct ct_node *node, struct ct_state *z)
{
    double factor = 1;
    if (!node)
        return true;
    if (!ct_read_text(r, node, &z->unit))
        return false;
    const struct ct_quantity q
        = {.text = z->name, .unit = z->unit, .mark = node->mark, .is_name = is_no_name};
    return ct_quantity_read(r->ctx, &q, &factor);
}

static void fill_state(struct ct_reader *r, struct ct_state *z, const struct ct_node *node)
{
    z->rate = z->initial = CT_EX_ZERO;
    if (!ct_read_keys(r, node, ct_arena_printf(r->a, "state '%s'", z->name), keys, COUNT(keys)))
        return;
    const struct ct_node *rate = ct_node_get(node, "rate"), *unit = ct_node_get(node, "unit"),
                         *initial = ct_node_get(node, "initial");
    if (!read_unit(r, unit, z))
        z->unit = NULL;
    if (rate) {
        z->rate_mark = rate->mark;
        ct_read_expr(r, rate, CT_KEY_STATE,
                     z->unit ? ct_arena_printf(r->a, "%s/s", *z->unit ? z->unit : "1") : NULL,
                     &z->rate);
    } else {
        ct_error(r->ctx, z->mark, CT_E_KEY_MISSING, "state '%s' needs 'rate'", z->name);
    }
    if (initial)
        ct_read_expr(r, ct_read_with_unit(r, initial, z->unit ? unit : NULL), 0, z->unit,
                     &z->initial);
}

void ct_read_states_fill(struct ct_reader *r)
{
    for (size_t i = 0; i < r->m->nstate; i++)
        fill_state(r, &r->m->state[i], r->state_node[i]);
}
