// See beam_signal.h.
#include "formulate/signals/beam_signal.h"
#include "formulate/beam/section_rotation.h"

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

const struct ct_flexible *ct_beam_signal_beam(const struct ct_build *b, int frame)
{
    return ct_flexible_of(b, b->model->frame[frame].body);
}

// Undeformed position of a frame, axes of the beam.
ct_ex3 ct_beam_signal_place(const struct ct_build *b, int frame)
{
    const struct ct_frame *p = &b->model->frame[frame];
    return frame == b->model->body[p->body].frame ? zero3 : p->at;
}

// Position of a frame on the deformed beam, axes of the beam. A frame off the axis rotates with its
// section. Foreshortening is included if the forces include it, also if the kinematics neglects it.
static ct_ex3 deformed_place(struct ct_build *b, const struct ct_flexible *f, ct_ex3 rest)
{
    const ct_ex3 across = {{CT_EX_ZERO, rest.e[1], rest.e[2]}};
    struct ct_station s;
    ct_flexible_station(b, f, rest.e[0], f->axial, &s);
    const ct_ex33 S = ct_section_axes(b->x, s.angle);
    return ct_ex3_add(b->x, s.position, ct_ex33_apply(b->x, &S, across));
}

// R' v, R the smallest rotation from x to the unit vector n.
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

// Axial elongation of the element over its length. LOCAL coordinates are positions, so that the
// foreshortening by bending is added.
ct_ex ct_beam_signal_strain(struct ct_build *b, int frame)
{
    struct ct_exs *x = b->x;
    const struct ct_flexible *f = ct_beam_signal_beam(b, frame);
    struct ct_station s;
    ct_flexible_station(b, f, ct_beam_signal_place(b, frame).e[0], f->kinematics, &s);
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

ct_ex3 ct_beam_signal_vector(struct ct_build *b, int frame, const char *property)
{
    const struct ct_flexible *f = ct_beam_signal_beam(b, frame);
    const ct_ex3 rest = ct_beam_signal_place(b, frame);
    struct ct_station s;
    if (!strcmp(property, "deflection"))
        return ct_ex3_sub(b->x, deformed_place(b, f, rest), rest);
    if (!strcmp(property, "chord_deflection"))
        return chord_deflection(b, f, rest);
    ct_flexible_station(b, f, rest.e[0], f->kinematics, &s);
    return (ct_ex3){{s.angle[0], s.angle[1], s.angle[2]}};
}
