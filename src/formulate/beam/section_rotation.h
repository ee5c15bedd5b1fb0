// Rotation of a beam section relative to the beam: Rz(g/2) Ry(b) Rz(g/2) Rx(p) with p twist, b =
// -dw/dx, g = dv/dx; in bending about one axis Rz(g) or Ry(b).  (1.7b)
#ifndef CT_FORMULATE_BEAM_SECTION_ROTATION_H
#define CT_FORMULATE_BEAM_SECTION_ROTATION_H

#include "formulate/build.h"

/// One of the turns, about a coordinate axis of the frame turned so far, by a share of the angle
/// about that axis.
struct ct_section_turn {
    int axis;
    double share;
};

/// The turns of a section with the angles p, b, g; those that are zero are left out. Returns how
/// many.
int ct_section_turns(const ct_ex angle[3], struct ct_section_turn turn[4]);
/// S, from components in the section to components in the beam.
ct_ex33 ct_section_axes(struct ct_exs *x, const ct_ex angle[3]);

/// Rotation of a section with rotary inertia relative to the frame of the beam, in its axes.
struct ct_section {
    bool is_small;            // to first order: its inertia stays along the axes of the beam
    ct_ex33 J;                // rotary inertia
    ct_ex3 rate_columns[3];   // columns of Y: angular velocity [rad/s] by the rates of p, b, g
    ct_ex3 relative_velocity; // Y (p' b' g') [rad/s]
    ct_ex3 bias;              // Y' (p' b' g') [rad/s^2]
};

/// Of a section with the principal inertias j.
void ct_section_motion(struct ct_exs *x, bool is_small, const ct_ex j[3], ct_ex3 angle,
                       ct_ex3 rate, struct ct_section *out);
/// Y rate
ct_ex3 ct_section_turned(struct ct_exs *x, const struct ct_section *s, ct_ex3 rate);
/// Inertia moment of the relative rotation of a section whose frame has angular velocity w, in
/// addition to J al + w x J (w + spin). second: p'', b'', g''; NULL: without them.
ct_ex3 ct_section_own(struct ct_exs *x, const struct ct_section *s, ct_ex3 w,
                      const ct_ex3 *second);
/// Generalised moments on p, b, g, if the frame also has the angular acceleration al.
ct_ex3 ct_section_on_angles(struct ct_exs *x, const struct ct_section *s, ct_ex3 w, ct_ex3 al,
                            const ct_ex3 *second);

#endif
