// Read forces: their class tables contain everything about them.
#include "component/read.h"

#include <string.h>

void ct_read_forces_declare(struct ct_reader *r)
{
    struct ct_model *m = r->m;
    const struct ct_node *node = ct_node_get(r->root, "forces");
    if (!node || ct_node_is_null(node)
        || !ct_read_shape(r, node, CT_NODE_MAP, "a map of forces"))
        return;
    for (size_t i = 0; i < node->n; i++) {
        const struct ct_node_pair *p = &node->pair[i];
        if (!ct_read_component_name(r, p, "force"))
            continue;
        const struct ct_instance new = {.name = p->key, .mark = p->mark, .from = -1, .to = -1};
        ct_names_put(r->a, &m->force_index, p->key, (int)m->nforce);
        CT_PUSH(r->a, m->force, m->nforce, m->force_cap, new);
        CT_PUSH(r->ctx->scratch, r->force_node, r->nforce_node, r->force_node_cap, p->value);
    }
}

// Name of the frame on which a force acts, the end of its edge: `to`, or its only frame (`at`,
// `on`).
static const char *name_of_end(const struct ct_component_class *cls)
{
    const char *name = "to";
    for (int i = cls->nkey; i-- > 0;)
        if (cls->key[i].kind == CT_VALUE_FRAME && (cls->key[i].flags & CT_KEY_REQUIRED))
            name = cls->key[i].name;
    for (int i = 0; i < cls->nkey; i++)
        if (strcmp(cls->key[i].name, "to") == 0)
            return "to";
    return name;
}

// The frame under a key of kind FRAME; -1 if the class has no such key or it is not given.
static int frame_under(const struct ct_instance *self, const char *name, struct ct_mark *at)
{
    for (int i = 0; i < self->cls->nkey; i++)
        if (self->cls->key[i].kind == CT_VALUE_FRAME
            && strcmp(self->cls->key[i].name, name) == 0) {
            *at = self->value[i]
                      .mark; // forces have no keys of the family, so key and value indices agree
            return self->value[i].frame;
        }
    return -1;
}

static bool read_force(struct ct_reader *r, struct ct_instance *self,
                       const struct ct_node *node)
{
    const struct ct_node_pair p = {self->name, self->mark, node};
    self->cls = ct_read_class(r, CT_FAMILY_FORCE, &p, "force");
    if (!self->cls)
        return false;
    ct_read_alloc_values(r, self);
    bool ok = ct_read_component_keys(r, self, node, "force", false);
    ok &= ct_read_own_values(r, self, node);
    struct ct_mark at = self->mark;
    self->from = frame_under(self, "from", &at);
    self->to = frame_under(self, name_of_end(self->cls), &at);
    if (self->from >= 0 && self->from == self->to)
        ok = ct_error(r->ctx, at, CT_E_SAME_FRAME,
                      "force '%s': 'from' and 'to' are the same frame '%s'", self->name,
                      r->m->frame[self->to].name);
    return ok;
}

void ct_read_forces_fill(struct ct_reader *r)
{
    for (size_t i = 0; i < r->m->nforce; i++)
        read_force(r, &r->m->force[i], r->force_node[i]);
}
