// All component classes, by family and name; see class.h.
#include "component/class.h"

#include <string.h>

#define COMPONENT(name) extern const struct ct_component_class ct_component_##name;
#include "components.def"
#undef COMPONENT

const struct ct_component_class *const ct_component_classes[] = {
#define COMPONENT(name) &ct_component_##name,
#include "components.def"
#undef COMPONENT
};

const int ct_ncomponent_class = COUNT(ct_component_classes);

const struct ct_component_class *ct_component_find(enum ct_family family, const char *name)
{
    for (int i = 0; i < ct_ncomponent_class; i++)
        if (ct_component_classes[i]->family == family
            && strcmp(ct_component_classes[i]->name, name) == 0)
            return ct_component_classes[i];
    return NULL;
}

const struct ct_component_class *ct_component_standard(enum ct_family family)
{
    for (int i = 0; i < ct_ncomponent_class; i++)
        if (ct_component_classes[i]->family == family && ct_component_classes[i]->is_standard)
            return ct_component_classes[i];
    return NULL;
}
