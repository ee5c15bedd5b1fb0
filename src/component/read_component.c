// Common parts of bodies, joints and forces: names, types, and keys checked by the class tables.
#include "component/read.h"

#include <string.h>

// All components are edges of one linear graph and are identified by their names in signals, trees
// and summaries, so all names must differ, across bodies, joints and forces.
bool ct_read_component_name(struct ct_reader *r, const struct ct_node_pair *p, const char *sort)
{
    static const char *const taken[] = {"ground", "system", "energy", "constraint"};
    if (!ct_read_name(r, p->key, p->mark, sort))
        return false;
    for (size_t i = 0; i < COUNT(taken); i++)
        if (strcmp(taken[i], p->key) == 0)
            return ct_error(
                r->ctx, p->mark, CT_E_NAME,
                "'%s' cannot name a %s: signals of this name have a meaning of their own",
                p->key, sort);
    const int known = ct_names_get(&r->component, p->key);
    if (known >= 0) {
        const struct ct_read_place *c = &r->place[known];
        if (strcmp(c->sort, sort) == 0)
            return false; // a duplicate key has been reported
        ct_error(r->ctx, p->mark, CT_E_NAME_TWICE,
                 "the %s '%s' has the name of a %s; all components must differ in name", sort,
                 p->key, c->sort);
        ct_note(r->ctx, c->mark, "the %s is here", c->sort);
        return false;
    }
    ct_names_put(r->ctx->scratch, &r->component, p->key, (int)r->ncomponent);
    const struct ct_read_place place = {sort, p->mark};
    CT_PUSH(r->ctx->scratch, r->place, r->ncomponent, r->place_cap, place);
    return true;
}

const struct ct_component_class *ct_read_class(struct ct_reader *r, enum ct_family family,
                                               const struct ct_node_pair *p, const char *sort)
{
    if (!ct_read_shape(r, p->value, CT_NODE_MAP, "a map of keys"))
        return NULL;
    const struct ct_node *type = ct_node_get(p->value, "type");
    if (!type && ct_component_standard(family))
        return ct_component_standard(family);
    if (!type) {
        ct_error(r->ctx, p->mark, CT_E_KEY_MISSING, "%s '%s' needs a 'type'", sort, p->key);
        return NULL;
    }
    if (!ct_read_shape(r, type, CT_NODE_SCALAR, "the name of a type"))
        return NULL;
    const struct ct_component_class *cls = ct_component_find(family, type->text);
    if (cls)
        return cls;
    const char **names = CT_NEWN(r->ctx->scratch, const char *, ct_ncomponent_class);
    size_t n = 0;
    for (int i = 0; i < ct_ncomponent_class; i++)
        if (ct_component_classes[i]->family == family)
            names[n++] = ct_component_classes[i]->name;
    ct_error(r->ctx, type->mark, CT_E_TYPE, "there is no %s of type '%s'%s", sort, type->text,
             ct_read_suggestion(r, type->text, names, n));
    return NULL;
}

void ct_read_alloc_values(struct ct_reader *r, struct ct_instance *self)
{
    int nfamily;
    ct_family_keys(self->cls->family, &nfamily);
    const int n = nfamily + self->cls->nkey;
    struct ct_value *value = CT_NEWN(r->a, struct ct_value, n);
    for (int i = 0; i < n; i++)
        value[i].frame = -1;
    self->value = value;
}

static bool check_required(struct ct_reader *r, const struct ct_instance *self,
                           const struct ct_node *node, const char *sort,
                           const struct ct_key *key, int nkey)
{
    bool ok = true;
    for (int i = 0; i < nkey; i++)
        if ((key[i].flags & CT_KEY_REQUIRED) && !ct_node_find(node, key[i].name))
            ok = ct_error(r->ctx, self->mark, CT_E_KEY_MISSING, "%s '%s' needs '%s': %s", sort,
                          self->name, key[i].name, key[i].doc);
    return ok;
}

bool ct_read_component_keys(struct ct_reader *r, const struct ct_instance *self,
                            const struct ct_node *node, const char *sort, bool use_family)
{
    int nfamily;
    const struct ct_key *family = ct_family_keys(self->cls->family, &nfamily);
    if (!use_family)
        nfamily = 0;
    const size_t n = 1 + (size_t)nfamily + (size_t)self->cls->nkey;
    const char **names = CT_NEWN(r->ctx->scratch, const char *, n);
    size_t k = 0;
    names[k++] = "type";
    for (int i = 0; i < nfamily; i++)
        names[k++] = family[i].name;
    for (int i = 0; i < self->cls->nkey; i++)
        names[k++] = self->cls->key[i].name;
    const char *what
        = ct_arena_printf(r->ctx->scratch, "%s '%s' (%s)", sort, self->name, self->cls->name);
    bool ok = ct_read_keys(r, node, what, names, n);
    ok &= check_required(r, self, node, sort, family, nfamily);
    return check_required(r, self, node, sort, self->cls->key, self->cls->nkey) && ok;
}

bool ct_read_own_values(struct ct_reader *r, struct ct_instance *self,
                        const struct ct_node *node)
{
    int nfamily;
    ct_family_keys(self->cls->family, &nfamily);
    struct ct_value *value
        = (struct ct_value *)(uintptr_t)self->value; // allocated by ct_read_alloc_values
    bool ok = true;
    for (int i = 0; i < self->cls->nkey; i++) {
        const struct ct_key *key = &self->cls->key[i];
        const struct ct_node *v = ct_node_get(node, key->name);
        if (v && key->kind == CT_VALUE_NAMES) {
            ok &= ct_read_value(r, v, key, &value[nfamily + i]);
            // from here on the joint's own expressions may use these names
            const struct ct_value *names = &value[nfamily + i];
            ct_ex *local = CT_NEWN(r->a, ct_ex, names->n);
            for (size_t k = 0; k < names->n; k++)
                local[k] = ct_ex_sym(r->m->x, CT_SYM_LOCAL, names->name[k], (uint32_t)k);
            self->local = local;
            self->ncoord = self->nfree = (int)names->n;
            r->local_of = self;
            r->local_name = names->name;
        } else if (v) {
            value[nfamily + i].is_wrong = !ct_read_value(r, v, key, &value[nfamily + i]);
            ok &= !value[nfamily + i].is_wrong;
        }
    }
    return ok;
}
