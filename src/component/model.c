// Values and names in a model; see model.h.
#include "component/model.h"

#include <math.h>

double ct_model_number(const struct ct_model *m, ct_ex e)
{
    double v;
    if (ct_ex_is_const(m->x, e, &v))
        return v;
    if (ct_ex_kinds(m->x, e) & ~(1u << CT_SYM_PARAM))
        return NAN;
    return ct_ex_value(m->x, e, m->value);
}

int ct_model_find_joint(const struct ct_model *m, const char *name)
{
    return ct_names_get(&m->joint_index, name);
}

int ct_model_find_frame(const struct ct_model *m, const char *name)
{
    return ct_names_get(&m->frame_index, name);
}

int ct_model_find_body(const struct ct_model *m, const char *name)
{
    return ct_names_get(&m->body_index, name);
}

int ct_model_find_force(const struct ct_model *m, const char *name)
{
    return ct_names_get(&m->force_index, name);
}
