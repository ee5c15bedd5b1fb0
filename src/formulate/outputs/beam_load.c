// See beam_load.h.
#include "formulate/outputs/beam_load.h"
#include "formulate/signals/beam_signal.h"
#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/dynamics/reaction.h"
#include "formulate/beam/section_rotation.h"

#include <math.h>
#include <string.h>

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// ---- the part beyond a section ------------------------------------------------------------------

// A cut at a section: force on the part beyond it, and torque about the origin of the section, in
// axes of the beam.
struct cut {
    const struct ct_flexible *f;
    struct ct_station s;
    double x, tolerance; // position of the section [m]
    bool is_start;       // x = 0: loads there act on the part before the section
    // a, w, al: of the base: acceleration minus gravity, angular velocity and acceleration
    ct_ex3 a, w, al;
    ct_ex3 force, torque;
};

static struct cut cut_at(struct ct_build *b, const struct ct_flexible *f, ct_ex x)
{
    struct cut c = {.f = f};
    const int frame = b->kinematics->placement[f->base].frame;
    ct_flexible_station(b, f, x, f->kinematics, &c.s);
    c.x = ct_ex_value(b->x, x, b->value);
    c.tolerance = CT_SAME_PLACE * ct_ex_value(b->x, f->beam->length, b->value);
    c.is_start = c.x < c.tolerance;
    c.a = ct_ex3_sub(b->x, ct_node_acceleration(b, f->base, CT_FULL), b->model->gravity);
    c.a = ct_node_unturn(b, f->base, c.a);
    c.w = ct_node_unturn(b, f->base, ct_cluster_velocity(b, frame));
    c.al = ct_node_unturn(b, f->base, ct_cluster_acceleration(b, frame, CT_FULL));
    return c;
}

static void add_wrench(struct ct_build *b, struct cut *c, ct_ex3 force, ct_ex3 torque,
                       ct_ex3 place)
{
    const ct_ex3 arm = ct_ex3_sub(b->x, place, c->s.position);
    c->force = ct_ex3_add(b->x, c->force, force);
    c->torque = ct_ex3_add(b->x, c->torque, torque);
    c->torque = ct_ex3_add(b->x, c->torque, ct_ex3_cross(b->x, arm, force));
}

// Twist, -dw/dx, dv/dx at a section, from the values, rates or accelerations of the dofs.
static ct_ex3 section_rate(struct ct_build *b, const struct ct_flexible *f,
                           const struct ct_element *e, const ct_ex *of, ct_ex xi)
{
    const ct_ex in_z = ct_element_field(b, e, f->shape.rotation, of, 6, 4, xi);
    return (ct_ex3){{ct_element_field(b, e, f->line, of, CT_AXIS_DOF, CT_LINE_DOF, xi),
                     ct_ex_neg(b->x, in_z),
                     ct_element_field(b, e, f->shape.rotation, of, 2, 4, xi)}};
}

// Adds the inertia force of mass m with rotary inertia j at xi of an element. chain: acceleration
// of the foreshortening at the start of the element.  (5.4)
static void add_mass(struct ct_build *b, struct cut *c, const struct ct_element *e, ct_ex xi,
                     ct_ex m, const ct_ex j[3], ct_ex chain)
{
    struct ct_exs *x = b->x;
    const struct ct_flexible *f = c->f;
    struct ct_axial_field u;
    ct_axial_field(b, f, (int)(e - f->element), xi, f->kinematics, &u);
    ct_ex3 r = {{ct_ex_add(x, ct_ex_add(x, e->span.start, ct_ex_mul(x, xi, e->span.length)),
                           u.value)}},
           v = {{u.rate}}, a = {{ct_ex_add(x, u.bias, chain)}};
    for (int k = 0; k < CT_AXIS_DOF; k++)
        a.e[0] = ct_ex_add(x, a.e[0], ct_ex_mul(x, u.slope[k], e->acceleration[k]));
    for (int plane = 0; plane < 2; plane++) {
        const int from = plane ? 6 : 2;
        r.e[1 + plane] = ct_element_field(b, e, f->shape.deflection, e->value, from, 4, xi);
        v.e[1 + plane] = ct_element_field(b, e, f->shape.deflection, e->rate, from, 4, xi);
        a.e[1 + plane]
            = ct_element_field(b, e, f->shape.deflection, e->acceleration, from, 4, xi);
    }
    a = ct_ex3_add(x, a, ct_ex3_add(x, c->a, ct_ex3_cross(x, c->al, r)));
    a = ct_ex3_add(x, a, ct_ex3_cross(x, c->w, ct_ex3_cross(x, c->w, r)));
    a = ct_ex3_add(x, a, ct_ex3_scale(x, ct_ex_const(x, 2), ct_ex3_cross(x, c->w, v)));
    struct ct_section s;
    const ct_ex3 second = section_rate(b, f, e, e->acceleration, xi);
    ct_section_motion(x, !ct_flexible_turns_inertia(b, f), j,
                      section_rate(b, f, e, e->value, xi), section_rate(b, f, e, e->rate, xi),
                      &s);
    const ct_ex3 momentum = ct_ex33_apply(x, &s.J, ct_ex3_add(x, c->w, s.relative_velocity));
    ct_ex3 moment = ct_section_own(x, &s, c->w, &second);
    moment = ct_ex3_add(x, moment, ct_ex33_apply(x, &s.J, c->al));
    moment = ct_ex3_add(x, moment, ct_ex3_cross(x, c->w, momentum));
    add_wrench(b, c, ct_ex3_scale(x, m, a), moment, r);
}

// Number of Gauss points to integrate mu r x c, exact for constant sections.
static int points_of(const struct ct_build *b, const struct ct_flexible *f)
{
    unsigned kinds = ct_ex_kinds(b->x, f->beam->mass_per_length);
    for (int k = 0; k < 3; k++)
        kinds |= ct_ex_kinds(b->x, ct_flexible_rotary(f, k).value);
    if (kinds & 1u << CT_SYM_LOCAL)
        return CT_MAX_GAUSS;
    return f->kinematics == CT_AXIAL_LINEAR ? 4 : 6; // r and c are of degree 3 or 5
}

// Adds the part of an element beyond xi = from. Lumped masses are at its ends; a mass at the
// section itself is included.
static void add_element(struct ct_build *b, struct cut *c, int number, ct_ex from, ct_ex chain)
{
    struct ct_exs *x = b->x;
    const struct ct_beam *beam = c->f->beam;
    const struct ct_element *e = &c->f->element[number];
    const enum ct_rule rule = ct_flexible_mass_rule(beam);
    const bool is_whole = ct_ex_is_zero(from);
    const ct_ex rest = ct_ex_sub(x, CT_EX_ONE, from);
    if (ct_ex_is_zero(rest) && rule != CT_RULE_ENDS)
        return;
    struct ct_span part = e->span;
    if (rule != CT_RULE_ENDS)
        part = (struct ct_span){ct_ex_add(x, e->span.start, ct_ex_mul(x, from, e->span.length)),
                                ct_ex_mul(x, rest, e->span.length)};
    const struct ct_profile mass = {beam->x, beam->mass_per_length};
    double at[CT_MAX_GAUSS];
    ct_ex m[CT_MAX_GAUSS], j[3][CT_MAX_GAUSS];
    const int wanted = points_of(b, c->f);
    const int n = ct_shape_points(x, &mass, &part, rule, wanted, at, m);
    for (int k = 0; k < 3; k++) {
        const struct ct_profile rotary = ct_flexible_rotary(c->f, k);
        ct_shape_points(x, &rotary, &part, rule, wanted, at, j[k]);
    }
    for (int i = rule == CT_RULE_ENDS && !is_whole ? 1 : 0; i < n; i++) {
        const ct_ex xi = rule == CT_RULE_ENDS
                           ? ct_ex_const(x, at[i])
                           : ct_ex_add(x, from, ct_ex_mul(x, rest, ct_ex_const(x, at[i])));
        const ct_ex own[3] = {j[0][i], j[1][i], j[2][i]};
        add_mass(b, c, e, xi, m[i], own, chain);
    }
}

static void add_inertia(struct ct_build *b, struct cut *c)
{
    struct ct_exs *x = b->x;
    const struct ct_flexible *f = c->f;
    if (c->is_start) {
        ct_ex3 force, torque;
        ct_flexible_wrench(b, f, &force, &torque);
        add_wrench(b, c, ct_node_unturn(b, f->base, force), ct_node_unturn(b, f->base, torque),
                   zero3);
        return;
    }
    ct_ex chain = CT_EX_ZERO;
    for (int e = 0; e < f->beam->nelement; e++) {
        if (e >= c->s.element)
            add_element(b, c, e, e == c->s.element ? c->s.xi : CT_EX_ZERO, chain);
        for (int j = 2; j < CT_BENT_DOF && f->kinematics == CT_AXIAL_CHAIN; j++)
            chain = ct_ex_add(x, chain,
                              ct_ex_mul(x, f->element[e].g[j], f->element[e].acceleration[j]));
    }
}

static bool is_beyond(const struct ct_build *b, const struct cut *c, int edge)
{
    const struct ct_edge_info *e = &b->topology->edge[edge];
    if (ct_flexible_of_edge(b, e) != c->f)
        return false;
    const double x = ct_ex_value(b->x, e->along, b->value);
    return x >= c->x + (c->is_start ? c->tolerance : -c->tolerance);
}

static void add_arms(struct ct_build *b, struct cut *c)
{
    for (size_t i = 0; i < b->topology->nedge; i++) {
        ct_ex3 force, torque;
        if (!is_beyond(b, c, (int)i))
            continue;
        ct_reaction_of_edge(b, (int)i, &force, &torque);
        add_wrench(b, c, ct_node_unturn(b, c->f->base, force),
                   ct_node_unturn(b, c->f->base, torque), b->kinematics->edge[i].d);
    }
}

ct_ex3 ct_beam_load(struct ct_build *b, int frame, bool is_force)
{
    struct cut c
        = cut_at(b, ct_beam_signal_beam(b, frame), ct_beam_signal_place(b, frame).e[0]);
    add_inertia(b, &c);
    add_arms(b, &c);
    const ct_ex33 S = ct_section_axes(b->x, c.s.angle);
    return ct_ex3_neg(b->x, ct_ex33_apply_t(b->x, &S, is_force ? c.force : c.torque));
}

bool ct_beam_load_is_known(const struct ct_build *b, int frame, bool is_force, int i)
{
    const struct ct_flexible *f = ct_beam_signal_beam(b, frame);
    struct cut c
        = {.f = f, .x = ct_ex_value(b->x, ct_beam_signal_place(b, frame).e[0], b->value)};
    c.tolerance = CT_SAME_PLACE * ct_ex_value(b->x, f->beam->length, b->value);
    c.is_start = c.x < c.tolerance;
    for (size_t e = 0; e < b->topology->nedge; e++)
        if (is_beyond(b, &c, (int)e) && !ct_reaction_of_edge_is_known(b, (int)e, is_force, i))
            return false;
    return true;
}
