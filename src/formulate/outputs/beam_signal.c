// See beam_signal.h.
#include "formulate/outputs/beam_signal.h"
#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/dynamics/reaction.h"
#include "formulate/beam/section_rotation.h"

#include <math.h>
#include <string.h>

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

bool ct_beam_signal_exists(const char *property)
{
    static const char *const names[]
        = {"deflection", "slope", "chord_deflection", "strain", "force", "moment"};
    for (size_t i = 0; i < COUNT(names); i++)
        if (!strcmp(property, names[i]))
            return true;
    return false;
}

// ---- places -------------------------------------------------------------------------------------------

static const struct ct_flexible *beam_of(const struct ct_build *b, int frame)
{
    return ct_flexible_of(b, b->model->frame[frame].body);
}

// Undeformed place of a frame, axes of the beam.
static ct_ex3 rest_place(const struct ct_build *b, int frame)
{
    const struct ct_frame *p = &b->model->frame[frame];
    return frame == b->model->body[p->body].frame ? zero3 : p->at;
}

// Place of a frame on the deformed beam, axes of the beam; a frame off the axis turns with its section. The axis is
// foreshortened where its forces are, also if the kinematics leaves that out.
static ct_ex3 deformed_place(struct ct_build *b, const struct ct_flexible *f, ct_ex3 rest)
{
    const ct_ex3 across = {{CT_EX_ZERO, rest.e[1], rest.e[2]}};
    struct ct_station s;
    ct_flexible_station(b, f, rest.e[0], f->axial, &s);
    const ct_ex33 S = ct_section_axes(b->x, s.angle);
    return ct_ex3_add(b->x, s.position, ct_ex33_apply(b->x, &S, across));
}

// R' v, R the smallest rotation that turns x into the unit vector n.
static ct_ex3 seen_along(struct ct_build *b, ct_ex3 n, ct_ex3 v)
{
    struct ct_exs *x = b->x;
    const ct_ex across
        = ct_ex_add(x, ct_ex_mul(x, n.e[1], v.e[1]), ct_ex_mul(x, n.e[2], v.e[2]));
    const ct_ex share = ct_ex_div(x, across, ct_ex_add(x, CT_EX_ONE, n.e[0]));
    ct_ex3 out = {{ct_ex3_dot(x, n, v)}};
    for (int i = 1; i < 3; i++)
        out.e[i] = ct_ex_sub(x, v.e[i], ct_ex_mul(x, n.e[i], ct_ex_add(x, v.e[0], share)));
    return out;
}

static ct_ex3 chord_deflection(struct ct_build *b, const struct ct_flexible *f, ct_ex3 rest)
{
    struct ct_exs *x = b->x;
    const ct_ex3 end = {{f->beam->length, CT_EX_ZERO, CT_EX_ZERO}};
    const ct_ex3 start = deformed_place(b, f, zero3);
    const ct_ex3 chord = ct_ex3_sub(x, deformed_place(b, f, end), start);
    const ct_ex length = ct_ex_fun(x, CT_OP_SQRT, ct_ex3_dot(x, chord, chord));
    const ct_ex3 n = ct_ex3_scale(x, ct_ex_div(x, CT_EX_ONE, length), chord);
    const ct_ex3 from_start = ct_ex3_sub(x, deformed_place(b, f, rest), start);
    return ct_ex3_sub(x, seen_along(b, n, from_start), rest);
}

// Stretch of the element by its length; LOCAL coordinates are places, so that bending adds to it.
ct_ex ct_beam_signal_strain(struct ct_build *b, int frame)
{
    struct ct_exs *x = b->x;
    const struct ct_flexible *f = beam_of(b, frame);
    struct ct_station s;
    ct_flexible_station(b, f, rest_place(b, frame).e[0], f->kinematics, &s);
    const struct ct_element *e = &f->element[s.element];
    const ct_ex h = e->span.length;
    ct_ex stretch = ct_ex_sub(x, e->value[1], e->value[0]);
    for (int dof = 2; dof < CT_BENT_DOF && f->axial == CT_AXIAL_LOCAL; dof++) {
        const int plane = dof >= 6, first = plane ? 6 : 2, j = dof - first;
        ct_ex Ea = CT_EX_ZERO;
        for (int k = 0; k < 4; k++)
            Ea = ct_ex_add(x, Ea,
                           ct_ex_mul(x, ct_shape_at(x, &f->shortening[j][k], CT_EX_ONE, h),
                                     e->value[first + k]));
        stretch = ct_ex_add(x, stretch, ct_ex_scale(x, 0.5, ct_ex_mul(x, Ea, e->value[dof])));
    }
    const struct ct_shape rise = ct_shape_slope(&f->line[2]);
    return ct_ex_add(x, ct_ex_div(x, stretch, h),
                     ct_element_field(b, e, &rise, e->value, CT_MIDDLE_DOF, 1, s.xi));
}

// ---- the part beyond a section --------------------------------------------------------------------------

// A section and the sums of what the part beyond it needs: force, and torque about the section's origin; axes of the
// beam.
struct cut {
    const struct ct_flexible *f;
    struct ct_station s;
    double x, tolerance; // where it is [m]
    bool is_start;       // x = 0: what acts there belongs to the part before
    ct_ex3 a, w,
        al; // of the base: acceleration less gravity, angular velocity and acceleration
    ct_ex3 force, torque;
};

static const double same_place = 1e-9; // of the beam's length

static struct cut cut_at(struct ct_build *b, const struct ct_flexible *f, ct_ex x)
{
    struct cut c = {.f = f};
    const int frame = b->placement[f->base].frame;
    ct_flexible_station(b, f, x, f->kinematics, &c.s);
    c.x = ct_ex_value(b->x, x, b->value);
    c.tolerance = same_place * ct_ex_value(b->x, f->beam->length, b->value);
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

// Twist, -dw/dx, dv/dx of the dofs' values, rates or accelerations.
static ct_ex3 section_rate(struct ct_build *b, const struct ct_flexible *f,
                           const struct ct_element *e, const ct_ex *of, ct_ex xi)
{
    const ct_ex in_z = ct_element_field(b, e, f->shape.rotation, of, 6, 4, xi);
    return (ct_ex3){{ct_element_field(b, e, f->line, of, CT_AXIS_DOF, CT_LINE_DOF, xi),
                     ct_ex_neg(b->x, in_z),
                     ct_element_field(b, e, f->shape.rotation, of, 2, 4, xi)}};
}

// Mass m with the rotary inertia j at xi of an element. chain: acceleration of the foreshortening at its start.  (5.4)
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

// Gauss points that integrate mu r x c: exact where sections are constant.
static int points_of(const struct ct_build *b, const struct ct_flexible *f)
{
    unsigned kinds = ct_ex_kinds(b->x, f->beam->mass_per_length);
    for (int k = 0; k < 3; k++)
        kinds |= ct_ex_kinds(b->x, ct_flexible_rotary(f, k).value);
    if (kinds & 1u << CT_SYM_LOCAL)
        return CT_MAX_GAUSS;
    return f->kinematics == CT_AXIAL_LINEAR ? 4 : 6; // r and c are of degree 3 or 5
}

// The element beyond xi = from. Lumped masses sit at its ends; that at the section's own place counts.
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
    const struct ct_edge_info *e = &b->edge[edge];
    if (e->flexible != c->f)
        return false;
    const double x = ct_ex_value(b->x, e->along, b->value);
    return x >= c->x + (c->is_start ? c->tolerance : -c->tolerance);
}

static void add_arms(struct ct_build *b, struct cut *c)
{
    for (size_t i = 0; i < b->nedge; i++) {
        ct_ex3 force, torque;
        if (!is_beyond(b, c, (int)i))
            continue;
        ct_reaction_of_edge(b, (int)i, &force, &torque);
        add_wrench(b, c, ct_node_unturn(b, c->f->base, force),
                   ct_node_unturn(b, c->f->base, torque), b->edge[i].at);
    }
}

static ct_ex3 resultant(struct ct_build *b, int frame, bool is_force)
{
    struct cut c = cut_at(b, beam_of(b, frame), rest_place(b, frame).e[0]);
    add_inertia(b, &c);
    add_arms(b, &c);
    const ct_ex33 S = ct_section_axes(b->x, c.s.angle);
    return ct_ex3_neg(b->x, ct_ex33_apply_t(b->x, &S, is_force ? c.force : c.torque));
}

bool ct_beam_signal_is_known(const struct ct_build *b, int frame, bool is_force, int i)
{
    const struct ct_flexible *f = beam_of(b, frame);
    struct cut c = {.f = f, .x = ct_ex_value(b->x, rest_place(b, frame).e[0], b->value)};
    c.tolerance = same_place * ct_ex_value(b->x, f->beam->length, b->value);
    c.is_start = c.x < c.tolerance;
    for (size_t e = 0; e < b->nedge; e++)
        if (is_beyond(b, &c, (int)e) && !ct_reaction_of_edge_is_known(b, (int)e, is_force, i))
            return false;
    return true;
}

// ---- any of them ------------------------------------------------------------------------------------------

ct_ex3 ct_beam_signal_vector(struct ct_build *b, int frame, const char *property)
{
    const struct ct_flexible *f = beam_of(b, frame);
    const ct_ex3 rest = rest_place(b, frame);
    struct ct_station s;
    if (!strcmp(property, "deflection"))
        return ct_ex3_sub(b->x, deformed_place(b, f, rest), rest);
    if (!strcmp(property, "chord_deflection"))
        return chord_deflection(b, f, rest);
    if (strcmp(property, "slope"))
        return resultant(b, frame, !strcmp(property, "force"));
    ct_flexible_station(b, f, rest.e[0], f->kinematics, &s);
    return (ct_ex3){{s.angle[0], s.angle[1], s.angle[2]}};
}
