// The table of methods: one line for each file that defines one.
#include "integrate/problem.h"

#include <string.h>

extern const struct ct_method ct_method_dopri5, ct_method_dop853, ct_method_rk4,
    ct_method_radau5, ct_method_generalized_alpha, ct_method_generalized_alpha_index3,
    ct_method_hht, ct_method_newmark;

const struct ct_method *const ct_methods[] = {
    &ct_method_dopri5,
    &ct_method_dop853,
    &ct_method_rk4,
    &ct_method_radau5,
    &ct_method_generalized_alpha,
    &ct_method_generalized_alpha_index3,
    &ct_method_hht,
    &ct_method_newmark,
};
const int ct_nmethod = COUNT(ct_methods);

const struct ct_method *ct_method_find(const char *name)
{
    for (int i = 0; i < ct_nmethod; i++)
        if (strcmp(ct_methods[i]->name, name) == 0)
            return ct_methods[i];
    return NULL;
}
