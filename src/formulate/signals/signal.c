// See signal.h: parses names, derives kinematic signals, and replaces signals in expressions of the
// model.
#include "formulate/signals/signal.h"
#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/kinematics/constraint_row.h"
#include "formulate/signals/beam_signal.h"
#include "formulate/signals/momentum.h"

#include <stdlib.h>
#include <string.h>

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// ---- parsing names -----------------------------------------------------------------------------

static const char *const axis_names[] = {"x", "y", "z"};

static int index_of(const char *s, const char *const *names, int n)
{
    for (int i = 0; i < n; i++)
        if (s && !strcmp(s, names[i]))
            return i;
    return -1;
}

bool ct_signal_unknown(struct ct_build *b, const struct ct_signal *s, const char *why)
{
    return ct_error(b->ctx, s->mark, CT_E_SIGNAL, "there is no signal '%s': %s", s->name, why);
}

// Records that the signal needs the dynamics, its kind, and the number of its joint, coordinate,
// energy, frame or body.
static bool leave_to_dynamics(struct ct_signal *s, enum ct_dynamic_signal kind, int number)
{
    s->dynamic = kind;
    s->number = number;
    return true;
}

// ---- frames ------------------------------------------------------------------------------------

static const char *const vector_properties[]
    = {"position", "velocity", "acceleration", "angular_velocity", "angular_acceleration"};

static ct_ex3 frame_vector(struct ct_build *b, int node, int property)
{
    const int frame = b->kinematics->placement[node].frame;
    switch (property) {
    case 0:
        return ct_node_position(b, node);
    case 1:
        return ct_node_velocity(b, node);
    case 2:
        return ct_node_acceleration(b, node, CT_FULL);
    case 3:
        return ct_cluster_velocity(b, frame);
    default:
        return ct_cluster_acceleration(b, frame, CT_FULL);
    }
}

static bool in_axes(struct ct_build *b, const struct ct_signal *s, ct_ex3 *v)
{
    if (!s->axes)
        return true;
    const int f = ct_model_find_frame(b->model, s->axes);
    if (f < 0)
        return ct_signal_unknown(b, s, ct_arena_printf(b->arena, "no frame '%s'", s->axes));
    *v = ct_node_unturn(b, b->topology->node_of_frame[f], *v);
    return true;
}

// Rejects components and axes for a scalar signal: "j.q.x", "energy.total in b".
bool ct_signal_is_number(struct ct_build *b, const struct ct_signal *s)
{
    if (s->component)
        return ct_signal_unknown(
            b, s, ct_arena_printf(b->arena, "%s.%s has no components", s->owner, s->property));
    return !s->axes
        || ct_signal_unknown(b, s, "'in' gives the axes of a vector, and this is none");
}

int ct_signal_component_index(const struct ct_signal *s)
{
    return index_of(s->component, axis_names, 3);
}

bool ct_signal_component(struct ct_build *b, const struct ct_signal *s, ct_ex3 v, ct_ex *out)
{
    const int i = index_of(s->component, axis_names, 3);
    if (i < 0)
        return ct_signal_unknown(b, s, "a component is x, y or z");
    if (!in_axes(b, s, &v))
        return false;
    *out = v.e[i];
    return true;
}

// Parameter i of the quaternion of a frame. It is continuous in time, so that its four parameters
// are made together and stored.
static ct_ex frame_quaternion(struct ct_build *b, int node, int i)
{
    if (!b->signals.quaternion)
        b->signals.quaternion
            = CT_NEWN(b->arena, struct ct_kept_quaternion, b->topology->nnode);
    struct ct_kept_quaternion *q = &b->signals.quaternion[node];
    if (!q->made) {
        const ct_ex33 R = ct_node_rotation(b, node);
        ct_quaternion_follow(b, b->topology->node[node].name, &R, q->p);
        q->made = true;
    }
    return q->p[i];
}

static bool frame_signal(struct ct_build *b, int frame, const struct ct_signal *s, ct_ex *out)
{
    static const char *const entries[]
        = {"xx", "yx", "zx", "xy", "yy", "zy", "xz", "yz", "zz"}; // column-major
    static const char *const numbers[] = {"0", "1", "2", "3"};
    const int node = b->topology->node_of_frame[frame];
    const int property = index_of(s->property, vector_properties, COUNT(vector_properties));
    if (property >= 0)
        return ct_signal_component(b, s, frame_vector(b, node, property), out);
    if (s->axes && (!strcmp(s->property, "rotation") || !strcmp(s->property, "quaternion")))
        return ct_signal_unknown(b, s, "'in' gives the axes of a vector, and this is none");
    if (!strcmp(s->property, "rotation")) {
        const int i = index_of(s->component, entries, 9);
        if (i < 0)
            return ct_signal_unknown(b, s, "an entry of a rotation is xx, xy ... zz");
        *out = ct_node_rotation(b, node).e[i];
        return true;
    }
    if (!strcmp(s->property, "quaternion")) {
        const int i = index_of(s->component, numbers, 4);
        if (i < 0)
            return ct_signal_unknown(b, s, "a component of a quaternion is 0, 1, 2 or 3");
        *out = frame_quaternion(b, node, i);
        return true;
    }
    return ct_signal_unknown(
        b, s,
        b->model->body[b->model->frame[frame].body].beam
            ? "a frame of a beam has deflection, slope, chord_deflection, strain, "
              "force, moment, position, velocity, acceleration, angular_velocity, "
              "angular_acceleration, rotation and quaternion"
            : "a frame has position, velocity, acceleration, angular_velocity, "
              "angular_acceleration, rotation and quaternion");
}

// ---- joints ------------------------------------------------------------------------------------

// "joint 'pin' (cylindrical) has q1 and q2"
static const char *coordinates_of(struct ct_build *b, const struct ct_instance *self,
                                  const char *kind, bool is_stored)
{
    const int n = is_stored ? self->ncoord : self->nfree;
    const char *const head
        = ct_arena_printf(b->arena, "joint '%s' (%s) has", self->name, self->cls->name);
    if (self->from < 0 || n < 1)
        return ct_arena_printf(b->arena, "%s no coordinate of its own", head);
    if (n == 1)
        return ct_arena_printf(b->arena, "%s %s alone", head, kind);
    return ct_arena_printf(b->arena, "%s %s1 %s %s%d", head, kind, n == 2 ? "and" : "to", kind,
                           n);
}

static bool effort_signal(struct ct_build *b, int joint, int k, struct ct_signal *s, ct_ex *out)
{
    const struct ct_instance *self = &b->model->joint[joint];
    if (self->from < 0) {
        if (k > 0)
            return ct_signal_unknown(b, s, "the joint has no such coordinate");
        for (size_t i = 0; i < b->eqs->nrow; i++)
            if (b->eqs->row[i].joint == joint)
                *out = b->eqs->row[i].lam;
        return true;
    }
    if (k >= self->nfree)
        return ct_signal_unknown(b, s, coordinates_of(b, self, "effort", false));
    const int coordinate
        = b->topology->edge[b->topology->edge_of_joint[joint]].first_coordinate + k;
    if (b->kinematics->coordinate[coordinate].is_driven)
        return leave_to_dynamics(s, CT_DYNAMIC_DRIVER, coordinate);
    const struct ct_value *effort = ct_instance_value(self, "effort");
    const bool given = effort->given && (size_t)k < effort->n && !effort->hole[k];
    *out = given ? ct_build_value(b, effort->e[k]) : CT_EX_ZERO;
    return true;
}

// The number of "q2": 1 without digits; 0 if invalid, as in "q0", "q02", "q2x".
static int number_of(const char *digits)
{
    const size_t n = strspn(digits, "0123456789");
    if (!*digits)
        return 1;
    return digits[0] == '0' || digits[n] || n > 9 ? 0 : (int)strtol(digits, NULL, 10);
}

// q, u, a, effort with or without a number.
static bool coordinate_signal(struct ct_build *b, int joint, struct ct_signal *s, ct_ex *out)
{
    const struct ct_instance *self = &b->model->joint[joint];
    const size_t letters = strcspn(s->property, "0123456789");
    const int number = number_of(s->property + letters);
    const char *const kind = ct_arena_strndup(b->arena, s->property, letters);
    const bool stored = !strcmp(kind, "q");
    const int n = stored ? self->ncoord : self->nfree;
    if (!ct_signal_is_number(b, s))
        return false;
    if (number < 1)
        return ct_signal_unknown(b, s, coordinates_of(b, self, kind, stored));
    if (!s->property[letters] && n > 1)
        return ct_signal_unknown(
            b, s,
            ct_arena_printf(b->arena, "the joint has %d of them; name one, as in %s.%s2", n,
                            s->owner, kind));
    if (!strcmp(kind, "effort"))
        return effort_signal(b, joint, number - 1, s, out);
    if (self->from < 0 || number > n)
        return ct_signal_unknown(b, s, coordinates_of(b, self, kind, stored));
    const int coordinate
        = b->topology->edge[b->topology->edge_of_joint[joint]].first_coordinate + number - 1;
    if (stored)
        *out = ct_coordinate_value(b, coordinate);
    else if (!strcmp(kind, "u"))
        *out = ct_coordinate_speed(b, coordinate);
    else
        *out = ct_coordinate_acceleration(b, coordinate, CT_FULL);
    return true;
}

static bool joint_signal(struct ct_build *b, int joint, struct ct_signal *s, ct_ex *out)
{
    static const char *const kinds[] = {"q", "u", "a", "effort"};
    if ((!strcmp(s->property, "force") || !strcmp(s->property, "torque"))
        && b->topology->edge_of_joint[joint] >= 0)
        return leave_to_dynamics(s, CT_DYNAMIC_REACTION, joint);
    const size_t letters = strcspn(s->property, "0123456789");
    for (size_t i = 0; i < COUNT(kinds); i++)
        if (strlen(kinds[i]) == letters && !strncmp(s->property, kinds[i], letters))
            return coordinate_signal(b, joint, s, out);
    return ct_signal_unknown(b, s, "a joint has q, u, a, effort, force and torque");
}

// ---- forces ------------------------------------------------------------------------------------

static bool force_signal(struct ct_build *b, const struct ct_instance *self,
                         const struct ct_signal *s, ct_ex *out)
{
    const char *component = s->component ? s->component : "";
    const char *dot = s->component ? "." : "";
    ct_ex3 v = zero3;
    bool has = self->cls->signal
            && self->cls->signal(
                b, self, ct_arena_printf(b->arena, "%s%s%s", s->property, dot, component), out);
    for (int i = 0; i < 3 && has && s->axes; i++)
        has = self->cls->signal(
            b, self, ct_arena_printf(b->arena, "%s.%s", s->property, axis_names[i]), &v.e[i]);
    if (!has)
        return ct_signal_unknown(b, s,
                                 ct_arena_printf(b->arena, "force '%s' (%s) has %s", self->name,
                                                 self->cls->name, self->cls->signals));
    return !s->axes || ct_signal_component(b, s, v, out);
}

// ---- the whole system --------------------------------------------------------------------------

static ct_ex largest(struct ct_build *b, bool position)
{
    ct_ex max = CT_EX_ZERO;
    for (size_t i = 0; i < b->eqs->nrow; i++) {
        const ct_ex r = position ? b->eqs->row[i].phi : b->eqs->row[i].v;
        max = ct_ex_fun2(b->x, CT_OP_MAX, max, ct_ex_fun(b->x, CT_OP_ABS, r));
    }
    return max;
}

static bool global_signal(struct ct_build *b, struct ct_signal *s, ct_ex *out)
{
    static const char *const sums[] = {"com", "momentum", "angular_momentum"};
    static const char *const energies[] = {"kinetic", "potential", "strain", "work", "total"};
    struct ct_equations *e = b->eqs;
    if (!strcmp(s->owner, "system")) {
        const int i = index_of(s->property, sums, 3);
        return i < 0
                 ? ct_signal_unknown(b, s, "the system has com, momentum and angular_momentum")
                 : ct_signal_component(b, s, ct_system_total_vector(b, (enum ct_system_total)i),
                                       out);
    }
    if (!strcmp(s->owner, "constraint")) {
        const bool position = !strcmp(s->property, "position");
        if (!ct_signal_is_number(b, s))
            return false;
        if (!position && strcmp(s->property, "velocity"))
            return ct_signal_unknown(b, s, "constraint has position and velocity");
        *out = e->closure_error[!position] = largest(b, position);
        return true;
    }
    const int i = index_of(s->property, energies, 5);
    if (!ct_signal_is_number(b, s))
        return false;
    if (i < 0)
        return ct_signal_unknown(b, s, "energy has kinetic, potential, strain, work and total");
    return leave_to_dynamics(s, CT_DYNAMIC_ENERGY, i);
}

static ct_ex3 body_com(struct ct_build *b, int body)
{
    struct ct_flexible *f = ct_flexible_of(b, body);
    const ct_ex3 r = ct_node_position(b, b->topology->node_of_com[body]);
    if (!f)
        return r;
    ct_flexible_inertia_derive(b, f);
    const struct ct_flexible_state s = ct_flexible_momentum(b, f);
    return ct_ex3_add(b->x, r,
                      ct_ex3_scale(b->x, ct_ex_div(b->x, CT_EX_ONE, s.mass), s.moment));
}

// ---- beams -------------------------------------------------------------------------------------

static bool beam_signal(struct ct_build *b, int frame, struct ct_signal *s, ct_ex *out)
{
    if (!strcmp(s->property, "strain")) {
        *out = ct_beam_signal_strain(b, frame);
        return ct_signal_is_number(b, s);
    }
    if (s->axes)
        return ct_signal_unknown(
            b, s, "it is in axes of the beam; 'in' is for vectors of the ground's");
    if (!strcmp(s->property, "force") || !strcmp(s->property, "moment"))
        return leave_to_dynamics(s, CT_DYNAMIC_BEAM_LOAD, frame);
    return ct_signal_component(b, s, ct_beam_signal_vector(b, frame, s->property), out);
}

// ---- any signal --------------------------------------------------------------------------------

// Split at dots after the longest prefix that names something; removes " in AXES" from the end
// first.
static bool split(struct ct_build *b, const char *name, struct ct_signal *s, int *frame)
{
    char *text = ct_arena_strdup(b->arena, name);
    char *axes = strstr(text, " in ");
    if (axes) {
        *axes = 0;
        for (axes += 4; *axes == ' ';)
            axes++;
        s->axes = axes;
    }
    *frame = -1;
    char *cut = NULL;
    for (char *dot = strchr(text, '.'); dot; dot = strchr(dot + 1, '.')) {
        *dot = 0;
        const int f = ct_model_find_frame(b->model, text);
        if (f >= 0)
            *frame = f;
        if (f >= 0 || !cut)
            cut = dot;
        *dot = '.';
    }
    if (!cut)
        return false;
    *cut = 0;
    s->owner = text;
    s->property = cut + 1;
    char *dot = strchr(cut + 1, '.');
    if (dot) {
        *dot = 0;
        s->component = dot + 1;
    }
    return true;
}

bool ct_signal_resolve(struct ct_build *b, const char *name, struct ct_mark mark,
                       struct ct_signal *s, ct_ex *out)
{
    int frame;
    *out = CT_EX_ZERO;
    *s = (struct ct_signal){.name = name, .mark = mark};
    const int state = ct_names_get(&b->model->state_index, name);
    if (state >= 0) {
        *out = b->eqs->u[b->eqs->nmotion + (size_t)state].symbol;
        return true;
    }
    if (!split(b, name, s, &frame))
        return ct_signal_unknown(b, s, "a signal is written OWNER.PROPERTY");
    if (!strcmp(s->owner, "system") || !strcmp(s->owner, "energy")
        || !strcmp(s->owner, "constraint"))
        return global_signal(b, s, out);
    const int joint = ct_model_find_joint(b->model, s->owner);
    if (joint >= 0)
        return joint_signal(b, joint, s, out);
    const int force = ct_model_find_force(b->model, s->owner);
    if (force >= 0)
        return force_signal(b, &b->model->force[force], s, out);
    if (frame < 0)
        return ct_signal_unknown(b, s, "nothing has this name");
    const int body = b->model->frame[frame].body;
    if (!strcmp(s->property, "validity") && frame == b->model->body[body].frame
        && ct_flexible_of(b, body))
        return ct_signal_is_number(b, s) && leave_to_dynamics(s, CT_DYNAMIC_VALIDITY, body);
    if (!strcmp(s->property, "com") && body > 0)
        return ct_signal_component(b, s, body_com(b, body), out);
    if (b->model->body[body].beam && ct_beam_signal_exists(s->property))
        return beam_signal(b, frame, s, out);
    return frame_signal(b, frame, s, out);
}

const char *const *ct_signal_components(struct ct_build *b, const char *name)
{
    static const char *const xyz[] = {".x", ".y", ".z", NULL};
    static const char *const matrix[]
        = {".xx", ".xy", ".xz", ".yx", ".yy", ".yz", ".zx", ".zy", ".zz", NULL};
    static const char *const four[] = {".0", ".1", ".2", ".3", NULL};
    static const char *const vectors[] = {"position",
                                          "velocity",
                                          "acceleration",
                                          "angular_velocity",
                                          "angular_acceleration",
                                          "com",
                                          "momentum",
                                          "angular_momentum",
                                          "force",
                                          "torque",
                                          "moment",
                                          "deflection",
                                          "slope",
                                          "chord_deflection"};
    struct ct_signal s = {0};
    int frame;
    if (!split(b, name, &s, &frame) || s.component)
        return NULL;
    const int force = ct_model_find_force(b->model, s.owner);
    if (force >= 0 && b->model->force[force].cls->signal) {
        ct_ex scalar; // S.force of a spring is its tension
        if (b->model->force[force].cls->signal(b, &b->model->force[force], s.property, &scalar))
            return NULL;
    }
    if (index_of(s.property, vectors, COUNT(vectors)) >= 0 && strcmp(s.owner, "constraint"))
        return xyz;
    if (!strcmp(s.property, "rotation"))
        return matrix;
    return !strcmp(s.property, "quaternion") ? four : NULL;
}

// ---- expressions of the model ------------------------------------------------------------------

static const int deepest_signal
    = 64; // Limit: with a message; a force that depends on a force that depends on ... itself

// Error: a force or the rate of a state depends on a signal that needs the dynamics.
static void refuse(struct ct_build *b, const struct ct_signal *s)
{
    ct_error(b->ctx, s->mark, CT_E_SIGNAL_USE,
             "a %s cannot depend on '%s': accelerations, reactions, energies and work %s",
             b->signals.is_rate ? "rate" : "force", s->name,
             b->signals.is_rate
                 ? "are found after it; use positions, speeds, applied forces, states"
                 : "follow from it");
}

// The value of signal e in an expression of a force.
static ct_ex signal_value(struct ct_build *b, ct_ex e)
{
    const struct ct_sym symbol = *ct_ex_symbol(b->x, e);
    const unsigned late = 1u << CT_SYM_A | 1u << CT_SYM_LAM | 1u << CT_SYM_WORK;
    struct ct_signal s;
    ct_ex out;
    if (ct_signal_resolve(b, symbol.name, symbol.mark, &s, &out)
        && (s.dynamic || (!b->signals.in_outputs && ct_ex_kinds(b->x, out) & late)))
        refuse(b, &s);
    return out;
}

size_t ct_signals_list(struct ct_build *b, ct_ex e, ct_ex signal[CT_MOST_SIGNALS])
{
    size_t n = 0;
    const size_t nwalk = ct_ex_walk(b->x, &e, 1);
    for (size_t i = 0; i < nwalk && n < CT_MOST_SIGNALS; i++) {
        const ct_ex node = {b->x->stack[i]};
        const struct ct_sym *symbol = ct_ex_symbol(b->x, node);
        if (symbol && symbol->kind == CT_SYM_SIGNAL)
            signal[n++] = node;
    }
    return n;
}

ct_ex ct_build_value(struct ct_build *b, ct_ex e)
{
    ct_ex from[CT_MOST_SIGNALS], to[CT_MOST_SIGNALS];
    const size_t n = ct_signals_list(b, e, from);
    if (!n)
        return ct_switch_hold(b, e);
    if (b->signals.resolving > deepest_signal) {
        ct_error(b->ctx, ct_ex_symbol(b->x, from[0])->mark, CT_E_SIGNAL_USE,
                 "signal '%s' depends on itself", ct_ex_symbol(b->x, from[0])->name);
        return CT_EX_ZERO;
    }
    b->signals.resolving++;
    for (size_t i = 0; i < n; i++)
        to[i] = signal_value(b, from[i]);
    b->signals.resolving--;
    const ct_ex replaced = ct_ex_subst(b->x, e, from, to, n);
    if (ct_ex_kinds(b->x, replaced) & 1u << CT_SYM_SIGNAL) // more than CT_MOST_SIGNALS
        return ct_build_value(b, replaced);
    if (b->signals.in_outputs)
        return replaced;
    b->signals.written = e;
    b->signals.from = from;
    b->signals.to = to;
    b->signals.nreplaced = n;
    const ct_ex held = ct_switch_hold(b, replaced);
    b->signals.nreplaced = 0;
    return held;
}
