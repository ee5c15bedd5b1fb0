// Check the structure, keys, words and names of YAML nodes, each with a message; see read.h.
#include "component/read.h"

#include "expr/parse.h"

#include <string.h>

bool ct_read_wants_suggestions(const struct ct_reader *r)
{
    enum { MOST = 200 }; // Limit: number of errors with suggestions
    return r->ctx->nerror < MOST;
}

const char *ct_read_suggestion(struct ct_reader *r, const char *name, const char *const *names,
                               size_t n)
{
    const char *near = ct_read_wants_suggestions(r) ? ct_nearest(name, names, n) : NULL;
    return near ? ct_arena_printf(r->ctx->scratch, "; did you mean '%s'?", near) : "";
}

bool ct_read_shape(struct ct_reader *r, const struct ct_node *node, enum ct_node_kind kind,
                   const char *wanted)
{
    if (node->kind == kind && !(kind == CT_NODE_SCALAR && ct_node_is_null(node)))
        return true;
    return ct_error(r->ctx, node->mark, CT_E_SHAPE, "found %s where %s is wanted",
                    ct_node_what(node), wanted);
}

bool ct_read_keys(struct ct_reader *r, const struct ct_node *node, const char *what,
                  const char *const *names, size_t n)
{
    if (!ct_read_shape(r, node, CT_NODE_MAP, "a map of keys"))
        return false;
    bool ok = true;
    for (size_t i = 0; i < node->n; i++) {
        bool known = false;
        for (size_t k = 0; k < n && !known; k++)
            known = strcmp(node->pair[i].key, names[k]) == 0;
        if (!known)
            ok = ct_error(r->ctx, node->pair[i].mark, CT_E_KEY_UNKNOWN, "%s has no key '%s'%s",
                          what, node->pair[i].key,
                          ct_read_suggestion(r, node->pair[i].key, names, n));
    }
    return ok;
}

bool ct_read_list(struct ct_reader *r, const struct ct_node *node, size_t least, size_t most,
                  const char *wanted)
{
    if (!ct_read_shape(r, node, CT_NODE_LIST, wanted))
        return false;
    if (node->n >= least && node->n <= most)
        return true;
    return ct_error(r->ctx, node->mark, CT_E_LENGTH, "the list has %zu value%s; %s is wanted",
                    node->n, node->n == 1 ? "" : "s", wanted);
}

int ct_read_word(struct ct_reader *r, const struct ct_node *node, const char *what,
                 const char *const *names, size_t n)
{
    const char *wanted = ct_arena_printf(r->ctx->scratch, "a word (%s, ...)", names[0]);
    if (!ct_read_shape(r, node, CT_NODE_SCALAR, wanted))
        return -1;
    for (size_t i = 0; i < n; i++)
        if (strcmp(names[i], node->text) == 0)
            return (int)i;
    const char *list = names[0];
    for (size_t i = 1; i < n; i++)
        list = ct_arena_printf(r->ctx->scratch, "%s, %s", list, names[i]);
    ct_error(r->ctx, node->mark, CT_E_WORD, "unknown %s '%s'%s (known: %s)", what, node->text,
             ct_read_suggestion(r, node->text, names, n), list);
    return -1;
}

bool ct_read_boolean(struct ct_reader *r, const struct ct_node *node, bool *value)
{
    static const char *const names[] = {"false", "true"};
    const int i = ct_read_word(r, node, "truth value", names, COUNT(names));
    *value = i == 1;
    return i >= 0;
}

bool ct_read_text(struct ct_reader *r, const struct ct_node *node, const char **text)
{
    if (!ct_read_shape(r, node, CT_NODE_SCALAR, "a text"))
        return false;
    *text = node->text;
    return true;
}

bool ct_read_name(struct ct_reader *r, const char *name, struct ct_mark at, const char *sort)
{
    if (ct_is_identifier(name))
        return true;
    return ct_error(r->ctx, at, CT_E_NAME,
                    "'%s' cannot name a %s: names are letters, digits and _, not first a digit",
                    name, sort);
}
