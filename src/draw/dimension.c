// See dimension.h. Signals have the unit of their quantity; sums keep units, and so do products
// with a number.
#include "draw/dimension.h"

#include "formulate/build.h"

#include <math.h>
#include <string.h>

// ---- signals -------------------------------------------------------------------------------

static const struct {
    const char *property, *unit;
} properties[] = {{"position", "m"},
                  {"com", "m"},
                  {"velocity", "m/s"},
                  {"acceleration", "m/s\xc2\xb2"},
                  {"angular_velocity", "rad/s"},
                  {"angular_acceleration", "rad/s\xc2\xb2"},
                  {"rotation", ""},
                  {"quaternion", ""},
                  {"deflection", "m"},
                  {"chord_deflection", "m"},
                  {"slope", "rad"},
                  {"strain", ""},
                  {"validity", ""},
                  {"force", "N"},
                  {"torque", "N\xc2\xb7m"},
                  {"moment", "N\xc2\xb7m"},
                  {"length", "m"},
                  {"rate", "m/s"},
                  {"momentum", "kg\xc2\xb7m/s"},
                  {"angular_momentum", "kg\xc2\xb7m\xc2\xb2/s"},
                  {"kinetic", "J"},
                  {"potential", "J"},
                  {"work", "J"},
                  {"total", "J"}};

// Unit of "q2", "u", "a", "effort1" of a joint, from the quantity that its coordinate measures.
static const char *unit_of_coordinate(const struct ct_build *b, int joint, const char *property)
{
    static const char *const kinds[] = {"q", "u", "a", "effort"};
    static const char *const of_length[] = {"m", "m/s", "m/s\xc2\xb2", "N"};
    static const char *const of_angle[] = {"rad", "rad/s", "rad/s\xc2\xb2", "N\xc2\xb7m"};
    const size_t letters = strcspn(property, "0123456789");
    size_t k = 0, position = 0;
    while (k < COUNT(kinds)
           && (strlen(kinds[k]) != letters || strncmp(property, kinds[k], letters) != 0))
        k++;
    if (k == COUNT(kinds) || b->topology->edge_of_joint[joint] < 0)
        return NULL;
    for (const char *p = property + letters; *p && position < 100; p++)
        position = 10 * position + (size_t)(*p - '0');
    position -= position > 0;
    const struct ct_motion *m = b->topology->edge[b->topology->edge_of_joint[joint]].trial;
    if (m->quaternion >= 0 && position >= (size_t)m->quaternion)
        return k == 0 ? "" : of_angle[k];
    if (position >= (size_t)m->nmeasure)
        return NULL;
    return m->measure[position].kind == CT_MEASURE_LENGTH ? of_length[k] : of_angle[k];
}

// OWNER.PROPERTY or OWNER.PROPERTY.x, optionally with " in AXES"; an owner may contain a dot.
static const char *unit_of_signal(const struct ct_build *b, const char *name)
{
    char text[200];
    const char *axes = strstr(name, " in ");
    const size_t n = axes ? (size_t)(axes - name) : strlen(name);
    if (n >= sizeof text)
        return NULL;
    memcpy(text, name, n);
    text[n] = 0;
    if (strncmp(text, "energy.", 7) == 0)
        return "J";
    char *dot = strchr(text, '.');
    if (dot) {
        *dot = 0;
        const int joint = ct_model_find_joint(b->model, text);
        const char *unit = joint >= 0 ? unit_of_coordinate(b, joint, dot + 1) : NULL;
        *dot = '.';
        if (unit)
            return unit;
    }
    for (int k = 0; k < 2 && (dot = strrchr(text, '.')) && strncmp(text, "constraint", 10);
         k++) {
        for (size_t i = 0; i < COUNT(properties); i++)
            if (strcmp(dot + 1, properties[i].property) == 0)
                return properties[i].unit;
        *dot = 0; // a component
    }
    return NULL;
}

// ---- expressions ---------------------------------------------------------------------------

static const char *unit_of(const struct ct_build *b, ct_ex e, int depth);

// Unit of a sum and similar operators: that of both operands, or of one if the other is a
// number.
static const char *shared_unit(const struct ct_build *b, uint32_t first, uint32_t second,
                               int depth)
{
    const char *p = unit_of(b, (ct_ex){first}, depth), *q = unit_of(b, (ct_ex){second}, depth);
    double v;
    if (p && q && strcmp(p, q) == 0)
        return p;
    if (ct_ex_is_const(b->model->x, (ct_ex){first}, &v))
        return q;
    return ct_ex_is_const(b->model->x, (ct_ex){second}, &v) ? p : NULL;
}

static const char *unit_of(const struct ct_build *b, ct_ex e, int depth)
{
    // Limit: of the stack
    enum { DEEPEST = 50 };
    const struct ct_exs *x = b->model->x;
    const struct ct_exnode n = *ct_ex_node(x, e);
    double v;
    if (depth > DEEPEST)
        return NULL;
    switch ((enum ct_op)n.op) {
    case CT_OP_CONST:
        return "";
    case CT_OP_SYM: {
        const struct ct_sym *s = ct_ex_symbol(x, e);
        return s->kind == CT_SYM_SIGNAL ? unit_of_signal(b, s->name)
             : s->kind == CT_SYM_TIME   ? "s"
                                        : NULL;
    }
    case CT_OP_ADD:
    case CT_OP_SUB:
    case CT_OP_MIN:
    case CT_OP_MAX:
        return shared_unit(b, n.a, n.b, depth + 1);
    case CT_OP_IF:
        return shared_unit(b, n.b, n.c, depth + 1);
    case CT_OP_NEG:
    case CT_OP_ABS:
        return unit_of(b, (ct_ex){n.a}, depth + 1);
    case CT_OP_MUL:
        return ct_ex_is_const(x, (ct_ex){n.a}, &v) ? unit_of(b, (ct_ex){n.b}, depth + 1)
             : ct_ex_is_const(x, (ct_ex){n.b}, &v) ? unit_of(b, (ct_ex){n.a}, depth + 1)
                                                   : NULL;
    case CT_OP_DIV: {
        const char *p = unit_of(b, (ct_ex){n.a}, depth + 1);
        const char *q = unit_of(b, (ct_ex){n.b}, depth + 1);
        return ct_ex_is_const(x, (ct_ex){n.b}, &v) ? p
             : p && q && strcmp(p, q) == 0         ? ""
                                                   : NULL;
    }
    case CT_OP_ASIN:
    case CT_OP_ACOS:
    case CT_OP_ATAN:
    case CT_OP_ATAN2:
        return "rad";
    case CT_OP_SIN:
    case CT_OP_COS:
    case CT_OP_TAN:
    case CT_OP_SINH:
    case CT_OP_COSH:
    case CT_OP_TANH:
    case CT_OP_EXP:
    case CT_OP_LOG:
    case CT_OP_SIGN:
    case CT_OP_LT:
    case CT_OP_LE:
    case CT_OP_GT:
    case CT_OP_GE:
    case CT_OP_EQ:
        return "";
    case CT_OP_POW:
    case CT_OP_SQRT:
    case CT_OP_TABLE:
    case CT_OP_COUNT:
        break;
    }
    return NULL;
}

const char *ct_result_unit(const struct ct_equations *e, size_t result)
{
    const struct ct_build *b = e->build;
    const char *name = e->result[result].name;
    for (size_t i = 0; i < b->model->noutput; i++)
        if (strcmp(b->model->output[i].name, name) == 0)
            return unit_of(b, b->model->output[i].value, 0);
    return unit_of_signal(b, name);
}
