// The named items of a system. See live.h.
#include "live/live.h"

#include "expr/unit.h"
#include "formulate/build.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

size_t ct_item_parameter(const struct ct_model *m, enum ct_kind kind, size_t i)
{
    for (size_t k = 0; k < m->nparameter; k++)
        if (m->parameter[k].is_input == (kind == CT_INPUT) && i-- == 0)
            return k;
    return m->nparameter;
}

// Has the value of parameter i determined the form of the equations? Reads the marks of all
// stores of expressions without changing them.
bool ct_item_has_decided(const struct ct_system *s, size_t i)
{
    const struct ct_model *m = &s->model;
    const uint32_t symbol = ct_ex_node(m->x, m->parameter[i].symbol)->a;
    const unsigned char *const decided[]
        = {m->decided, s->equations.x->decided, s->start_equations.x->decided,
           s->held_equations.x ? s->held_equations.x->decided : NULL,
           s->moving_equations.x ? s->moving_equations.x->decided : NULL};
    for (size_t k = 0; k < COUNT(decided); k++)
        if (decided[k] && decided[k][symbol])
            return true;
    return false;
}

static size_t count_parameters(const struct ct_model *m, bool inputs)
{
    size_t n = 0;
    for (size_t i = 0; i < m->nparameter; i++)
        n += m->parameter[i].is_input == inputs;
    return n;
}

size_t ct_system_count(const struct ct_system *sys, enum ct_kind kind)
{
    if (!sys)
        return 0;
    const struct ct_equations *e = &sys->equations;
    switch (kind) {
    case CT_PARAMETER:
    case CT_INPUT:
        return count_parameters(&sys->model, kind == CT_INPUT);
    case CT_COORDINATE:
        return e->nq;
    case CT_SPEED:
        return e->nmotion;
    case CT_STATE:
        return e->nstate;
    case CT_MULTIPLIER:
        return e->nrow;
    case CT_OUTPUT:
        return e->nresult;
    case CT_FRAME:
        return sys->model.nframe;
    case CT_COMPONENT: // the ground is not a component
        return sys->model.nbody - 1 + sys->model.njoint + sys->model.nforce;
    }
    return 0;
}

// ---- values at the start -------------------------------------------------------------------

// Values at the start, from a state that is created when first needed. If two threads create
// one, that of the first is kept.
static const double *find_start(const struct ct_system *sys)
{
    const struct ct_equations *e = &sys->equations;
    double *kept = atomic_load(&sys->published->start), *nothing = NULL;
    if (kept)
        return kept;
    const size_t n = e->nq + e->nu + e->nresult;
    double *value = malloc((n + 1) * sizeof *value);
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_data *d = value ? ct_data_create(ctx, sys, NULL) : NULL;
    for (size_t i = 0; value && i < n; i++)
        value[i] = i < e->nq              ? ct_data_value(d, CT_COORDINATE, i)
                 : i < e->nq + e->nmotion ? ct_data_value(d, CT_SPEED, i - e->nq)
                 : i < e->nq + e->nu      ? ct_data_value(d, CT_STATE, i - e->nq - e->nmotion)
                                          : ct_data_value(d, CT_OUTPUT, i - e->nq - e->nu);
    ct_data_destroy(d);
    ct_ctx_destroy(ctx);
    if (!value || atomic_compare_exchange_strong(&sys->published->start, &nothing, value))
        return value;
    free(value);
    return nothing;
}

static double start_of(const struct ct_system *sys, size_t i)
{
    const double *start = find_start(sys);
    return start ? start[i] : NAN;
}

// ---- items ---------------------------------------------------------------------------------

static void place(struct ct_item *item, struct ct_mark mark)
{
    item->line = mark.file ? (size_t)mark.line + 1 : 0;
    item->column = mark.file ? (size_t)mark.column + 1 : 0;
}

// SI unit of a value, whatever unit it was given in.
static const char *si_unit(const char *text)
{
    struct ct_unit u;
    size_t at;
    static const struct {
        int m, kg, s;
        const char *name;
    } names[]
        = {{1, 0, 0, "m"},          {0, 1, 0, "kg"},   {0, 0, 1, "s"},      {1, 1, -2, "N"},
           {2, 1, -2, "N*m"},       {-1, 1, -2, "Pa"}, {0, 1, -2, "N/m"},   {1, 0, -1, "m/s"},
           {1, 0, -2, "m/s^2"},     {0, 0, -1, "1/s"}, {0, 0, -2, "1/s^2"}, {2, 1, 0, "kg*m^2"},
           {-3, 1, 0, "kg/m^3"},    {2, 0, 0, "m^2"},  {4, 0, 0, "m^4"},    {0, 1, -1, "N*s/m"},
           {2, 1, -1, "N*m*s/rad"}, {2, 1, -3, "W"}};
    if (!text)
        return NULL;
    if (ct_unit_parse(text, strlen(text), &u, &at) != CT_UNIT_OK)
        return NULL;
    if (u.si == 1)
        return text;
    for (size_t i = 0; i < COUNT(names); i++)
        if (names[i].m == u.m && names[i].kg == u.kg && names[i].s == u.s)
            return names[i].name;
    return u.m || u.kg || u.s ? NULL : strstr(text, "deg") || strstr(text, "rev") ? "rad" : "";
}

static bool ends_with(const char *name, const char *end)
{
    const size_t n = strlen(name), k = strlen(end);
    return n >= k && strcmp(name + n - k, end) == 0;
}

// Unit of a signal, from its property.
static const char *unit_of_signal(const struct ct_equations *e, const char *name)
{
    static const struct {
        const char *property, *unit;
    } units[] = {{".position", "m"},
                 {".deflection", "m"},
                 {".length", "m"},
                 {".distance", "m"},
                 {".velocity", "m/s"},
                 {".rate", "m/s"},
                 {".acceleration", "m/s^2"},
                 {".angular_velocity", "rad/s"},
                 {".angular_acceleration", "rad/s^2"},
                 {".rotation", "rad"},
                 {".force", "N"},
                 {".torque", "N*m"},
                 {".moment", "N*m"},
                 {".strain", "J"},
                 {".kinetic", "J"},
                 {".potential", "J"},
                 {".work", "J"},
                 {".total", "J"}};
    static const char *const levels[][3] = {{".q", "rad", "m"},
                                            {".u", "rad/s", "m/s"},
                                            {".a", "rad/s^2", "m/s^2"},
                                            {".effort", "N*m", "N"}};
    const char *dot = strrchr(name, '.');
    size_t n = strlen(name);
    if (!dot)
        return NULL;
    for (size_t k = 0; k < COUNT(levels); k++)
        for (size_t i = 0; i < e->ncoordinate; i++) {
            const char *q = e->coordinate[i].name; // "pivot.q", "ball.q2"
            const size_t owner = strcspn(q, ".");
            const size_t tail = strlen(levels[k][0]);
            if (strncmp(name, q, owner) == 0 && strncmp(name + owner, levels[k][0], tail) == 0
                && strcmp(name + owner + tail, q + owner + 2) == 0)
                return levels[k][e->coordinate[i].in_rotation ? 1 : 2];
        }
    if (strlen(dot) == 2 && strchr("xyz", dot[1]))
        n -= 2;
    for (size_t k = COUNT(units); k-- > 0;) {
        const size_t tail = strlen(units[k].property);
        if (n >= tail && strncmp(name + n - tail, units[k].property, tail) == 0)
            return units[k].unit;
    }
    return ends_with(name, "constraint.position") ? "m" : NULL;
}

static void describe_coordinate(const struct ct_system *sys, size_t i, struct ct_item *item)
{
    const struct ct_equations *e = &sys->equations;
    item->name = e->q[i].name;
    item->unit = e->q[i].quaternion >= 0 ? "" : "m";
    item->meaning = e->q[i].quaternion >= 0 ? "number of a unit quaternion" : "displacement";
    for (size_t k = 0; k < e->nu; k++)
        if (e->u[k].q == (int)i) {
            item->unit = e->u[k].kind == CT_ELASTIC_MODE ? ""
                       : e->u[k].is_rotation             ? "rad"
                                                         : "m";
            item->meaning = e->u[k].kind == CT_ELASTIC_MODE ? "share of a mode"
                          : e->u[k].is_rotation             ? "angle"
                                                            : "displacement";
            place(item, e->u[k].joint >= 0 ? sys->model.joint[e->u[k].joint].mark
                                           : sys->model.body[e->u[k].body].instance.mark);
        }
}

static void describe_speed(const struct ct_system *sys, size_t i, struct ct_item *item)
{
    const struct ct_equations *e = &sys->equations;
    const struct ct_u *u = &e->u[i];
    item->name = u->name;
    item->unit = u->kind == CT_ELASTIC_MODE ? "1/s"
               : u->is_rotation || u->q < 0 ? "rad/s"
                                            : "m/s";
    item->meaning = u->q < 0 ? "component of an angular velocity" : "rate of a coordinate";
    place(item, u->joint >= 0 ? sys->model.joint[u->joint].mark
                              : sys->model.body[u->body].instance.mark);
}

static void describe_state(const struct ct_system *sys, size_t i, struct ct_item *item)
{
    const struct ct_state *z = &sys->model.state[i];
    item->name = z->name;
    item->unit = si_unit(z->unit);
    item->meaning = "state";
    place(item, z->mark);
}

static void describe_output(const struct ct_system *sys, size_t i, struct ct_item *item)
{
    const struct ct_equations *e = &sys->equations;
    const struct ct_model *m = &sys->model;
    item->name = e->result[i].name;
    item->unit = unit_of_signal(e, item->name);
    const struct ct_sym *symbol = ct_ex_symbol(e->x, e->result[i].value);
    if (symbol && symbol->kind == CT_SYM_PARAM)
        item->unit = si_unit(m->parameter[symbol->index].unit);
    else if (symbol && symbol->kind == CT_SYM_U && ct_speed_is_state(e, symbol->index))
        item->unit = si_unit(m->state[symbol->index - e->nmotion].unit);
    item->meaning = "output";
    for (size_t k = 0; k < m->noutput; k++) // the columns of a vector begin with its name
        if (strncmp(m->output[k].name, item->name, strlen(m->output[k].name)) == 0)
            place(item, m->output[k].mark);
}

static void describe_component(const struct ct_system *sys, size_t i, struct ct_item *item)
{
    const struct ct_model *m = &sys->model;
    const size_t nbody = m->nbody - 1;
    const struct ct_instance *self = i < nbody             ? &m->body[i + 1].instance
                                   : i < nbody + m->njoint ? &m->joint[i - nbody]
                                                           : &m->force[i - nbody - m->njoint];
    item->name = self->name;
    item->meaning = self->cls ? self->cls->name : "body";
    place(item, self->mark);
}

bool ct_item_describe(const struct ct_system *sys, enum ct_kind kind, size_t i,
                      struct ct_item *item)
{
    if (!item || i >= ct_system_count(sys, kind))
        return false;
    const struct ct_model *m = &sys->model;
    const struct ct_equations *e = &sys->equations;
    *item = (struct ct_item){.meaning = "", .value = NAN};
    switch (kind) {
    case CT_PARAMETER:
    case CT_INPUT: {
        const struct ct_parameter *p = &m->parameter[ct_item_parameter(m, kind, i)];
        item->name = p->name;
        item->unit = si_unit(p->unit);
        item->meaning = kind == CT_INPUT                          ? "input"
                      : ct_ex_is_const(m->x, p->definition, NULL) ? "parameter"
                                                                  : "derived parameter";
        item->value = p->value;
        place(item, p->mark);
        return true;
    }
    case CT_COORDINATE:
        describe_coordinate(sys, i, item);
        return true;
    case CT_SPEED:
        describe_speed(sys, i, item);
        return true;
    case CT_STATE:
        describe_state(sys, i, item);
        return true;
    case CT_MULTIPLIER:
        item->name = e->row[i].name;
        item->unit = e->row[i].is_length ? "N" : "N*m";
        item->meaning = "force of a constraint";
        if (e->row[i].joint >= 0)
            place(item, m->joint[e->row[i].joint].mark);
        return true;
    case CT_OUTPUT:
        describe_output(sys, i, item);
        return true;
    case CT_FRAME:
        item->name = m->frame[i].name;
        item->meaning = i == 0                                    ? "ground"
                      : m->body[m->frame[i].body].frame == (int)i ? "body"
                                                                  : "point of a body";
        place(item, m->frame[i].mark);
        return true;
    case CT_COMPONENT:
        describe_component(sys, i, item);
        return true;
    }
    return false;
}

bool ct_system_item(const struct ct_system *sys, enum ct_kind kind, size_t i,
                    struct ct_item *item)
{
    if (!ct_item_describe(sys, kind, i, item))
        return false;
    const struct ct_equations *e = &sys->equations;
    const size_t first = kind == CT_SPEED  ? e->nq
                       : kind == CT_STATE  ? e->nq + e->nmotion
                       : kind == CT_OUTPUT ? e->nq + e->nu
                                           : 0;
    if (kind == CT_COORDINATE || kind == CT_SPEED || kind == CT_STATE || kind == CT_OUTPUT)
        item->value = start_of(sys, first + i);
    return true;
}

static const char *name_of(const struct ct_system *sys, enum ct_kind kind, size_t i)
{
    struct ct_item item;
    switch (kind) { // kinds whose values need a start
    case CT_COORDINATE:
        return sys->equations.q[i].name;
    case CT_SPEED:
        return sys->equations.u[i].name;
    case CT_OUTPUT:
        return sys->equations.result[i].name;
    default:
        return ct_system_item(sys, kind, i, &item) ? item.name : NULL;
    }
}

long ct_system_find(const struct ct_system *sys, enum ct_kind kind, const char *name)
{
    const size_t n = name ? ct_system_count(sys, kind) : 0;
    for (size_t i = 0; i < n; i++)
        if (strcmp(name_of(sys, kind, i), name) == 0)
            return (long)i;
    return -1;
}
