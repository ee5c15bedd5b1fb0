// Keys shared by a family, and values of instances by key; see class.h.
#include "component/class.h"

#include <assert.h>
#include <string.h>

// COORDS take their units from the coordinates: N/m or N*m/rad and so on
static const struct ct_key joint_keys[] = {
    {"from", CT_VALUE_FRAME, CT_KEY_REQUIRED, NULL, 1, 1, "frame the motion is relative to"},
    {"to", CT_VALUE_FRAME, CT_KEY_REQUIRED, NULL, 1, 1, "frame that moves"},
    {"initial", CT_VALUE_INITIAL, 0, NULL, 1, 1,
     "start: {q: values, u: values, rotate: [axis, angle], guess: true}"},
    {"stiffness", CT_VALUE_COORDS, 0, NULL, 1, CT_MAX_COORD, "spring along the coordinate (0)"},
    {"damping", CT_VALUE_COORDS, 0, NULL, 1, CT_MAX_COORD, "damper along the coordinate (0)"},
    {"rest", CT_VALUE_COORDS, 0, NULL, 1, CT_MAX_COORD,
     "coordinate at which the spring is free (0)"},
    {"effort", CT_VALUE_COORDS, CT_KEY_STATE, NULL, 1, CT_MAX_COORD,
     "force or torque along the coordinate, positive along q (0)"},
    {"motion", CT_VALUE_COORDS, CT_KEY_TIME, NULL, 1, CT_MAX_COORD,
     "prescribed q(t); `~` leaves a coordinate free"},
};

const struct ct_key *ct_family_keys(enum ct_family family, int *nkey)
{
    *nkey = family == CT_FAMILY_JOINT ? (int)COUNT(joint_keys) : 0;
    return joint_keys;
}

const char *const *ct_key_choices(struct ct_arena *a, const struct ct_key *key, size_t *n)
{
    const char **word = CT_NEWN(a, const char *, strlen(key->unit)); // an upper bound
    *n = 0;
    for (const char *p = key->unit; *p; p += *p == '|') {
        const size_t length = strcspn(p, "|");
        word[(*n)++] = ct_arena_strndup(a, p, length);
        p += length;
    }
    return word;
}

const char *ct_applied_load_name(enum ct_applied_load applied)
{
    static const char *const name[] = {NULL, "force", "torque"};
    return name[applied];
}

const struct ct_value *ct_instance_value(const struct ct_instance *self, const char *key)
{
    int nfamily;
    const struct ct_key *family = ct_family_keys(self->cls->family, &nfamily);
    for (int i = 0; i < nfamily; i++)
        if (strcmp(family[i].name, key) == 0)
            return &self->value[i];
    for (int i = 0; i < self->cls->nkey; i++)
        if (strcmp(self->cls->key[i].name, key) == 0)
            return &self->value[nfamily + i];
    assert(!"a key of this class");
    return NULL;
}
