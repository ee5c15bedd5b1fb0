// Custom joint: the user defines the motion by expressions of named coordinates.
//
//   across   d = translate(q), S = Rot(axis1, e1(q)) Rot(axis2, e2(q)) ...
//   through  efforts along the coordinates; everything else is a reaction
//
// It is always a branch of both trees, because its constraint rows are not known in closed form.
#include "component/class.h"

static const struct ct_key keys[] = {
    {"coordinates", CT_VALUE_NAMES, CT_KEY_REQUIRED, NULL, 1, 6, "names of the coordinates"},
    {"translate", CT_VALUE_VEC3, CT_KEY_LOCAL, NULL, 3, 3,
     "position of `to` in axes of `from` as expressions of the coordinates (0)"},
    {"rotate", CT_VALUE_TURNS, CT_KEY_LOCAL, NULL, 0, CT_MAX_COORD,
     "successive rotations [axis, expression] (none)"},
};

static void motion(struct ct_exs *x, const struct ct_instance *self, struct ct_motion *m)
{
    const struct ct_value *d = ct_instance_value(self, "translate");
    const struct ct_value *turns = ct_instance_value(self, "rotate");
    const size_t n = (size_t)self->ncoord;
    for (int i = 0; i < 3 && d->given; i++)
        m->d.e[i] = ct_ex_subst(x, d->e[i], self->local, m->coord, n);
    for (size_t k = 0; turns->given && k < turns->nturn; k++)
        ct_motion_add_rotation(m, turns->turn[k].axis,
                               ct_ex_subst(x, turns->turn[k].angle, self->local, m->coord, n));
}

const struct ct_component_class ct_component_custom = {
    .name = "custom",
    .summary = "motion given by expressions of the user's own coordinates",
    .family = CT_FAMILY_JOINT,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "d = translate(q), S = Rot(axis1, e1(q)) Rot(axis2, e2(q)) ...",
    .through = "efforts along the coordinates; the rest are reactions",
    .ncoord = -1,
    .nfree = -1,
    .always_branch = true,
    .motion = motion,
};
