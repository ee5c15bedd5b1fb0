// Values of kinds that only beams have: elements, rotary inertia, Rayleigh damping.
#include "component/read.h"

static bool read_elements(struct ct_reader *r, const struct ct_node *node,
                          const struct ct_key *key, struct ct_value *v)
{
    enum { MOST = 10000 }; // Limit: with a message
    if (node->kind != CT_NODE_LIST)
        return ct_read_count(r, node, key->name, 1, &v->count);
    if (!ct_read_list(r, node, 1, MOST, "a list of the places where elements end"))
        return false;
    v->count = (long)node->n;
    return ct_read_items(r, node, key, v);
}

static bool read_rotary(struct ct_reader *r, const struct ct_node *node,
                        const struct ct_key *key, struct ct_value *v)
{
    static const char *const words[] = {"false", "true"};
    if (node->kind != CT_NODE_LIST) {
        v->count = ct_read_word(r, node, key->name, words, COUNT(words));
        return v->count >= 0;
    }
    v->count = 3;
    return ct_read_list(r, node, 3, 3, "true, false or a list of 3")
        && ct_read_items(r, node, key, v);
}

static bool read_rayleigh(struct ct_reader *r, const struct ct_node *node,
                          const struct ct_key *key, struct ct_value *v)
{
    static const char *const names[] = {"alpha", "beta"}, *const units[] = {"1/s", "s"};
    if (!ct_read_shape(r, node, CT_NODE_MAP, "{alpha: a, beta: b}"))
        return false;
    bool ok = ct_read_keys(r, node, "'damping' of a beam", names, COUNT(names));
    ct_read_alloc(r, v, COUNT(names));
    for (size_t i = 0; i < COUNT(names); i++) {
        const struct ct_node *item = ct_node_get(node, names[i]);
        double value;
        v->at[i] = item ? item->mark : node->mark;
        if (!item)
            continue;
        ok &= ct_read_expr(r, item, key->flags, units[i], &v->e[i]);
        if (ct_read_number(r, v->e[i], &value) && !(value >= 0))
            ok = ct_error(r->ctx, item->mark, CT_E_RANGE, "'%s' is %g; it must be at least 0",
                          names[i], value);
    }
    return ok;
}

bool ct_read_beam_value(struct ct_reader *r, const struct ct_node *node,
                        const struct ct_key *key, struct ct_value *v)
{
    if (key->kind == CT_VALUE_ELEMENTS)
        return read_elements(r, node, key, v);
    if (key->kind == CT_VALUE_SHAPES || key->kind == CT_VALUE_FIELDS)
        return ct_read_fields(r, node, key, v);
    return key->kind == CT_VALUE_ROTARY ? read_rotary(r, node, key, v)
                                        : read_rayleigh(r, node, key, v);
}
