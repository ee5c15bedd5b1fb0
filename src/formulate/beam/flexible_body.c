// See flexible_body.h.
#include "formulate/beam/beam_dynamics.h"
#include "formulate/beam/deformation_selection.h"
#include "formulate/beam/beam_field.h"

#include <math.h>
#include <string.h>

enum {
    U = CT_FREEDOM_U,
    V = CT_FREEDOM_V,
    W = CT_FREEDOM_W,
    RX = CT_FREEDOM_RX,
    RY = CT_FREEDOM_RY,
    RZ = CT_FREEDOM_RZ,
    RM = CT_FREEDOM_RM,
    UM = CT_FREEDOM_UM,
    NKIND = CT_NODE_FREEDOM
};
static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// ---- freedoms ---------------------------------------------------------------------------------------

unsigned ct_freedom_family(int kind)
{
    static const unsigned family[NKIND]
        = {CT_BEAM_AXIAL,     CT_BEAM_BENDING_Z, CT_BEAM_BENDING_Y, CT_BEAM_TORSION,
           CT_BEAM_BENDING_Y, CT_BEAM_BENDING_Z, CT_BEAM_TORSION,   CT_BEAM_AXIAL};
    return family[kind];
}

bool ct_freedom_is_fixed(const struct ct_flexible *f, int node, int kind)
{
    const bool is_end = node == f->beam->nelement;
    if (!(f->deformation & ct_freedom_family(kind)))
        return true;
    if (kind == RM)
        return node == 0 || !f->beam->has_quadratic_twist;
    if (kind == UM)
        return node == 0 || !f->beam->has_quadratic_stretch;
    if (!f->beam->is_chord)
        return node == 0;
    // the chord's frame: origin at the start, x towards the end, not twisted at the start
    const bool turns = kind == RY || kind == RZ;
    return (node == 0 && !turns) || (is_end && (kind == V || kind == W));
}

static void number_dofs(struct ct_flexible *f)
{
    static const int kinds[CT_DOF][2]
        = {{0, U},  {1, U}, {0, V},  {0, RZ}, {1, V},  {1, RZ}, {0, W},
           {0, RY}, {1, W}, {1, RY}, {1, UM}, {0, RX}, {1, RX}, {1, RM}};
    for (int e = 0; e < f->beam->nelement; e++)
        for (int j = 0; j < CT_DOF; j++) {
            const int node = e + kinds[j][0], kind = kinds[j][1];
            f->element[e].freedom[j]
                = ct_freedom_is_fixed(f, node, kind) ? -1 : NKIND * node + kind;
        }
}

const struct ct_freedom *ct_dof_freedom(const struct ct_flexible *f, int e, int j, int *sign)
{
    const int i = f->element[e].freedom[j];
    *sign = j == 7 || j == 9 ? -1 : 1; // dw/dx = -ry
    return i < 0 ? NULL : &f->freedom[i];
}

// ---- creation -----------------------------------------------------------------------------------------

// E(xi) = integral of slope_j slope_k, D = xi E(1) - E, and the integral of the sections' rotation gradients.
static void derive_shortening(struct ct_flexible *f)
{
    const struct ct_shape xi = {.c = {0, 1}};
    for (int j = 0; j < 4; j++)
        for (int k = 0; k < 4; k++) {
            const struct ct_shape both = ct_shape_mul(&f->shape.slope[j], &f->shape.slope[k]);
            const struct ct_shape E = ct_shape_primitive(&both);
            const struct ct_shape one = {.c = {ct_shape_end(&E)}, .power = E.power};
            struct ct_shape D = ct_shape_mul(&xi, &one);
            for (int i = 0; i < CT_SHAPE_SIZE; i++)
                D.c[i] -= E.c[i];
            const struct ct_shape bend[2] = {ct_shape_slope(&f->shape.rotation[j]),
                                             ct_shape_slope(&f->shape.rotation[k])};
            const struct ct_shape curved = ct_shape_mul(&bend[0], &bend[1]);
            f->curving[j][k] = ct_shape_primitive(&curved);
            f->shortening[j][k] = E;
            f->bubble[j][k] = D;
        }
}

// The mean strain of a section with rotations g is u' + (v'^2 + (I/A) g'^2)/2: with higher-order terms an axis that does
// not stretch is drawn in by both. I/A of a tapered element is its mean.
static void derive_radii(struct ct_build *b, struct ct_flexible *f, struct ct_element *e)
{
    const struct ct_beam *beam = f->beam;
    const struct ct_shape one = {.c = {1}};
    const ct_ex second[2] = {beam->Iz, beam->Iy};
    for (int plane = 0; plane < 2 && beam->higher_order && f->axial == CT_AXIAL_CHAIN;
         plane++) {
        const struct ct_profile radius = {beam->x, ct_ex_div(b->x, second[plane], beam->area)};
        const bool varies = ct_ex_kinds(b->x, radius.value) & 1u << CT_SYM_LOCAL;
        e->radius[plane]
            = !varies
                ? radius.value
                : ct_ex_div(b->x,
                            ct_shape_integral(b->x, &radius, &one, &e->span, CT_RULE_FULL),
                            e->span.length);
    }
}

// What deforms where the scene keeps to a plane: bending about the normal; a beam's y or z axis points along it.
static unsigned in_plane(const struct ct_build *b, const struct ct_flexible *f)
{
    if (!b->keeps_plane)
        return CT_BEAM_ALL;
    const ct_ex3 n = ct_ex33_apply_t(b->x, &b->upright[f->base], b->normal);
    const bool about_z = fabs(ct_ex_value(b->x, n.e[2], b->value)) > 0.5;
    return CT_BEAM_AXIAL | (about_z ? CT_BEAM_BENDING_Z : CT_BEAM_BENDING_Y);
}

// Modes and given shapes hold no room for the places of nodes that foreshortening moves; and it is the stretch that is small,
// not the places, which are of second order in the slopes.
static enum ct_axial axial_of(const struct ct_build *b, const struct ct_flexible *f)
{
    if (f->formulation == CT_BEAM_LINEAR)
        return CT_AXIAL_LINEAR;
    return f->deformation & CT_BEAM_AXIAL && f->formulation == CT_BEAM_FORESHORTENING
                && !f->beam->modes && !f->beam->nshape && !ct_build_is_small(b, f->name, NULL)
             ? CT_AXIAL_LOCAL
             : CT_AXIAL_CHAIN;
}

// Deformations without a stiffness would be free to go anywhere: where the scene does not excite them they are left out,
// else they are the model's fault.
static void need_stiffness(struct ct_build *b, struct ct_flexible *f)
{
    const struct {
        unsigned family;
        const char *what, *key;
    } all[] = {
        {CT_BEAM_AXIAL, "stretch", "area"},
        {CT_BEAM_BENDING_Y, "bend in its x-z plane", "Iy"},
        {CT_BEAM_BENDING_Z, "bend in its x-y plane", "Iz"},
        {CT_BEAM_TORSION, "twist", ct_ex_is_zero(f->beam->G) ? "G or nu" : "J, or Iy and Iz"}};
    for (size_t i = 0; i < COUNT(all); i++) {
        if (!(f->deformation & all[i].family & ~f->beam->known))
            continue;
        f->deformation &= ~all[i].family;
        if (b->keep_all || b->is_spatial_for_beams)
            ct_build_note_left_out(
                b, ct_arena_printf(b->arena, "that %s can %s", f->name, all[i].what),
                ct_arena_printf(b->arena, "%s is not given", all[i].key));
        else
            ct_error(b->ctx, b->model->body[f->body].instance.mark, CT_E_BEAM,
                     "beam '%s' can %s here, and nothing resists it: give %s, or say with "
                     "'deformation' what it may do",
                     f->name, all[i].what, all[i].key);
    }
}

// Left to the program: as in equations that were made before, else the one that holds further.
static void choose_formulation(const struct ct_build *b, struct ct_flexible *f)
{
    const struct ct_flexible *like = b->like ? ct_flexible_of(b->like->build, f->body) : NULL;
    f->formulation = like ? like->formulation : CT_BEAM_FORESHORTENING;
    if (b->is_linear)
        f->formulation = b->is_linear[f->body] ? CT_BEAM_LINEAR : CT_BEAM_FORESHORTENING;
}

static void choose_deformation(struct ct_build *b, struct ct_flexible *f)
{
    const struct ct_beam *beam = f->beam;
    f->formulation = beam->formulation;
    if (beam->formulation == CT_BEAM_AUTO)
        choose_formulation(b, f);
    f->excited = in_plane(b, f);
    f->deformation = beam->deformation & (b->is_planar ? f->excited : CT_BEAM_ALL);
    // nor has it an inertia of its own then, so there is no coordinate to keep
    const char *untwisted = f->deformation & CT_BEAM_TORSION && !beam->deformation_given
                              ? ct_deformation_no_twist(b, f)
                              : NULL;
    if (untwisted) {
        f->deformation &= ~(unsigned)CT_BEAM_TORSION;
        ct_build_note_left_out(b, ct_arena_printf(b->arena, "torsion of %s", f->name),
                                      untwisted);
    }
    if (b->is_planar && beam->deformation & ~(unsigned)(CT_BEAM_AXIAL | f->deformation))
        ct_build_note_left_out(
            b,
            ct_arena_printf(b->arena, "bending of %s out of the plane, and its torsion",
                            f->name),
            "gravity, loads, masses and arms lie in the plane");
    if (beam->misses_rotary)
        ct_build_note_left_out(
            b, ct_arena_printf(b->arena, "rotary inertia of %s", f->name),
            "lumped mass has none unless 'rotary_inertia' gives values");
    if (beam->lacks_quadratic)
        ct_build_note_left_out(
            b, ct_arena_printf(b->arena, "quadratic velocity forces of %s", f->name),
            "'quadratic_velocity: false'; energy and momentum are not kept");
    if (beam->is_cut)
        ct_build_note_left_out(
            b, ct_arena_printf(b->arena, "the elements of %s as given", f->name),
            ct_arena_printf(b->arena,
                            "they also end where its values switch (x = %.6g m%s), %d in all",
                            beam->cut[0], beam->ncut > 1 ? ", ..." : "", beam->nelement));
    if (beam->nshape)
        f->deformation &= ct_fields_family(beam);
    need_stiffness(b, f);
    if (b->is_rigid)
        f->deformation = 0;
    f->axial = f->kinematics = axial_of(b, f);
    if (f->formulation == CT_BEAM_FORCE_ONLY)
        f->kinematics = CT_AXIAL_LINEAR;
    f->freedom = CT_NEWN(b->arena, struct ct_freedom, NKIND * (beam->nelement + 1));
    f->element = CT_NEWN(b->arena, struct ct_element, beam->nelement);
    ct_shape_bending(beam->theory, &f->shape);
    ct_shape_line(f->line);
    derive_shortening(f);
    number_dofs(f);
    for (int e = 0; e < beam->nelement; e++) {
        struct ct_span *s = &f->element[e].span;
        s->start = e ? beam->end[e - 1] : CT_EX_ZERO;
        // one and the same to the last bit, so that elements are one program
        s->length = beam->is_even ? ct_ex_scale(b->x, 1.0 / beam->nelement, beam->length)
                                  : ct_ex_sub(b->x, beam->end[e], s->start);
        derive_radii(b, f, &f->element[e]);
    }
}

void ct_flexible_create(struct ct_build *b)
{
    for (size_t i = 1; i < b->model->nbody; i++)
        b->nflexible += b->model->body[i].beam != NULL;
    b->flexible = CT_NEWN(b->arena, struct ct_flexible, b->nflexible + 1);
    size_t n = 0;
    for (size_t i = 1; i < b->model->nbody; i++) {
        const struct ct_body *body = &b->model->body[i];
        if (body->beam)
            b->flexible[n++] = (struct ct_flexible){
                .beam = body->beam, .body = (int)i, .name = body->instance.name};
    }
}

void ct_flexible_choose_deformation(struct ct_build *b)
{
    for (size_t i = 0; i < b->nflexible; i++)
        choose_deformation(b, &b->flexible[i]);
}

struct ct_flexible *ct_flexible_of(const struct ct_build *b, int body)
{
    for (size_t i = 0; i < b->nflexible; i++)
        if (b->flexible[i].body == body)
            return &b->flexible[i];
    return NULL;
}

bool ct_flexible_is_nodal(const struct ct_flexible *f)
{
    bool is_nodal = !f->beam->modes && !f->beam->nshape;
    for (int i = 0; i < NKIND * (f->beam->nelement + 1); i++)
        is_nodal = is_nodal && (f->freedom[i].npart <= 1 || ct_condensation_number(f, i) >= 0);
    return is_nodal;
}

bool ct_flexible_is_augmented(const struct ct_flexible *f)
{
    return f->kinematics == CT_AXIAL_CHAIN && ct_flexible_is_nodal(f);
}

// ---- stations -----------------------------------------------------------------------------------------------

ct_ex ct_element_field(struct ct_build *b, const struct ct_element *e,
                       const struct ct_shape *shape, const ct_ex *of, int from, int n, ct_ex xi)
{
    ct_ex sum = CT_EX_ZERO;
    for (int j = 0; j < n; j++)
        if (!ct_ex_is_zero(of[from + j]))
            sum = ct_ex_add(b->x, sum,
                            ct_ex_mul(b->x, ct_shape_at(b->x, &shape[j], xi, e->span.length),
                                      of[from + j]));
    return sum;
}

static ct_ex stretch_field(struct ct_build *b, const struct ct_flexible *f,
                           const struct ct_element *e, const ct_ex *of, ct_ex xi)
{
    return ct_ex_add(b->x, ct_element_field(b, e, f->line, of, 0, 2, xi),
                     ct_element_field(b, e, &f->line[2], of, CT_MIDDLE_DOF, 1, xi));
}

// (M a)_j of the matrix of shapes that the axial displacement is quadratic in, with its sign.
static ct_ex quadratic_slope(struct ct_build *b, const struct ct_flexible *f, int e, int plane,
                             int j, const ct_ex *of, enum ct_axial axial, ct_ex xi)
{
    const struct ct_element *self = &f->element[e];
    const bool local = axial == CT_AXIAL_LOCAL;
    const struct ct_shape *row = local ? f->bubble[j] : f->shortening[j];
    ct_ex v = ct_element_field(b, self, row, of, plane ? 6 : 2, 4, xi);
    if (!ct_ex_is_zero(self->radius[plane]))
        v = ct_ex_add(
            b->x, v,
            ct_ex_mul(b->x, self->radius[plane],
                      ct_element_field(b, self, f->curving[j], of, plane ? 6 : 2, 4, xi)));
    return local ? v : ct_ex_neg(b->x, v);
}

void ct_axial_field(struct ct_build *b, const struct ct_flexible *f, int e, ct_ex xi,
                    enum ct_axial axial, struct ct_axial_field *a)
{
    struct ct_exs *x = b->x;
    const struct ct_element *self = &f->element[e];
    memset(a, 0, sizeof *a);
    a->value = stretch_field(b, f, self, self->value, xi);
    a->rate = stretch_field(b, f, self, self->rate, xi);
    if (axial == CT_AXIAL_CHAIN) {
        a->value = ct_ex_add(x, a->value, self->c);
        a->rate = ct_ex_add(x, a->rate, self->c_rate);
        a->bias = self->c_bias;
    }
    for (int i = 0; i < CT_LINE_DOF; i++)
        a->slope[ct_stretch_dof(i)] = ct_shape_at(x, &f->line[i], xi, self->span.length);
    for (int plane = 0; plane < 2 && axial != CT_AXIAL_LINEAR; plane++)
        for (int j = 0; j < 4; j++) {
            const int dof = (plane ? 6 : 2) + j;
            const ct_ex s = quadratic_slope(b, f, e, plane, j, self->value, axial, xi);
            const ct_ex r = quadratic_slope(b, f, e, plane, j, self->rate, axial, xi);
            a->slope[dof] = s;
            a->value = ct_ex_add(x, a->value,
                                 ct_ex_scale(x, 0.5, ct_ex_mul(x, s, self->value[dof])));
            a->rate = ct_ex_add(x, a->rate, ct_ex_mul(x, s, self->rate[dof]));
            a->bias = ct_ex_add(x, a->bias, ct_ex_mul(x, r, self->rate[dof]));
        }
}

static int element_at(const struct ct_build *b, const struct ct_flexible *f, double x)
{
    int e = 0;
    while (e + 1 < f->beam->nelement && x > ct_ex_value(b->x, f->beam->end[e], b->value))
        e++;
    return e;
}

static const double at_node = 1e-9; // of the element's length: the place is that of the node

void ct_flexible_station(struct ct_build *b, const struct ct_flexible *f, ct_ex place,
                         enum ct_axial axial, struct ct_station *s)
{
    struct ct_exs *x = b->x;
    const double at = ct_ex_value(x, place, b->value);
    const int e = s->element = element_at(b, f, at);
    const struct ct_element *self = &f->element[e];
    const ct_ex xi = ct_ex_div(x, ct_ex_sub(x, place, self->span.start), self->span.length);
    const double where = ct_ex_value(x, xi, b->value);
    s->xi = fabs(where) < at_node ? CT_EX_ZERO : fabs(where - 1) < at_node ? CT_EX_ONE : xi;
    struct ct_axial_field a;
    s->axial = axial;
    ct_axial_field(b, f, e, s->xi, axial, &a);
    s->position.e[0] = ct_ex_add(x, place, a.value);
    s->position.e[1] = ct_element_field(b, self, f->shape.deflection, self->value, 2, 4, s->xi);
    s->position.e[2] = ct_element_field(b, self, f->shape.deflection, self->value, 6, 4, s->xi);
    s->angle[0]
        = ct_element_field(b, self, f->line, self->value, CT_AXIS_DOF, CT_LINE_DOF, s->xi);
    s->angle[1]
        = ct_ex_neg(x, ct_element_field(b, self, f->shape.rotation, self->value, 6, 4, s->xi));
    s->angle[2] = ct_element_field(b, self, f->shape.rotation, self->value, 2, 4, s->xi);
}

// apart: freedoms that follow behind the coordinates, not as sums of these.
static void add_partial(struct ct_build *b, const struct ct_flexible *f, int e, int j,
                        ct_ex3 value, ct_ex3 *by_coordinate, bool apart)
{
    int sign;
    const struct ct_freedom *d = ct_dof_freedom(f, e, j, &sign);
    const int follower = d && apart ? ct_condensation_number(f, (int)(d - f->freedom)) : -1;
    if (follower >= 0) {
        ct_ex3 *sum = &by_coordinate[f->nelastic + follower];
        *sum = ct_ex3_add(b->x, *sum, ct_ex3_scale(b->x, ct_ex_const(b->x, sign), value));
        return;
    }
    for (int p = 0; d && p < d->npart; p++) {
        const ct_ex c = sign > 0 ? d->part[p].coef : ct_ex_neg(b->x, d->part[p].coef);
        ct_ex3 *sum = &by_coordinate[d->part[p].k];
        *sum = ct_ex3_add(b->x, *sum, ct_ex3_scale(b->x, c, value));
    }
}

// What the dofs of the station's element do.
static void own_partials(struct ct_build *b, const struct ct_flexible *f,
                         const struct ct_station *s, ct_ex3 *slide, ct_ex3 *turn, bool apart)
{
    struct ct_exs *x = b->x;
    const struct ct_element *self = &f->element[s->element];
    const ct_ex h = self->span.length;
    struct ct_axial_field a;
    ct_axial_field(b, f, s->element, s->xi, s->axial, &a);
    for (int j = 0; j < CT_DOF; j++) {
        ct_ex3 d = zero3, t = zero3;
        const int plane = j >= 6, i = plane ? j - 6 : j - 2;
        if (j < CT_AXIS_DOF)
            d.e[0] = a.slope[j];
        if (j >= 2 && j < CT_BENT_DOF) {
            const ct_ex r = ct_shape_at(x, &f->shape.rotation[i], s->xi, h);
            d.e[1 + plane] = ct_shape_at(x, &f->shape.deflection[i], s->xi, h);
            t.e[plane ? 1 : 2] = plane ? ct_ex_neg(x, r) : r;
        } else if (j >= CT_AXIS_DOF) {
            t.e[0] = ct_shape_at(x, &f->line[j - CT_AXIS_DOF], s->xi, h);
        }
        add_partial(b, f, s->element, j, d, slide, apart);
        add_partial(b, f, s->element, j, t, turn, apart);
    }
}

void ct_station_own_partials(struct ct_build *b, const struct ct_flexible *f,
                             const struct ct_station *s, ct_ex3 *slide, ct_ex3 *turn)
{
    own_partials(b, f, s, slide, turn, true);
}

// Are slides of sections less work by forces that what follows hands on? These are summed for each section anew; sums freedom
// by freedom go on from one section to the next.
static bool is_handed(const struct ct_build *b, const struct ct_flexible *f)
{
    size_t nsection = 0, nproduct = 0;
    for (size_t i = 0; i < b->nedge; i++)
        nsection += b->edge[i].flexible == f;
    for (int e = 0; f->condensation && e < f->beam->nelement; e++)
        for (int j = 2; j < CT_BENT_DOF; j++) {
            int sign;
            const struct ct_freedom *d = ct_dof_freedom(f, e, j, &sign);
            if (d && ct_condensation_number(f, (int)(d - f->freedom)) >= 0
                && !ct_ex_is_zero(f->element[e].g[j]))
                nproduct += (size_t)d->npart;
        }
    return f->condensation
        && (nsection + 1) * ct_condensation_products(f->condensation) < nproduct;
}

// What the elements before do along the axis.
static void chain_partials(struct ct_build *b, const struct ct_flexible *f, int element,
                           ct_ex3 *slide)
{
    for (int e = 0; e < element; e++)
        for (int j = 2; j < CT_BENT_DOF; j++)
            add_partial(b, f, e, j, (ct_ex3){{f->element[e].g[j], CT_EX_ZERO, CT_EX_ZERO}},
                        slide, false);
}

// The same as forces on freedoms, those that follow handed on from node to node.
static void handed_partials(struct ct_build *b, const struct ct_flexible *f, int element,
                            ct_ex3 *slide)
{
    const int n = NKIND * (f->beam->nelement + 1);
    ct_ex *force = CT_NEWN(b->ctx->scratch, ct_ex, n);
    for (int e = 0; e < element; e++)
        for (int j = 2; j < CT_BENT_DOF; j++)
            ct_dof_push(b, f, e, j, f->element[e].g[j], force);
    ct_condensation_forces(b->x, f->condensation, force);
    for (int i = 0; i < n; i++)
        for (int p = 0; p < f->freedom[i].npart && !ct_ex_is_zero(force[i]); p++) {
            ct_ex *sum = &slide[f->freedom[i].part[p].k].e[0];
            *sum = ct_ex_add_product(b->x, *sum, f->freedom[i].part[p].coef, force[i]);
        }
}

void ct_station_partials(struct ct_build *b, const struct ct_flexible *f,
                         const struct ct_station *s, ct_ex3 *slide, ct_ex3 *turn)
{
    own_partials(b, f, s, slide, turn, false);
    if (s->axial == CT_AXIAL_CHAIN)
        (is_handed(b, f) ? handed_partials : chain_partials)(b, f, s->element, slide);
}

bool ct_flexible_is_small(const struct ct_build *b, const struct ct_flexible *f)
{
    return f->formulation == CT_BEAM_STRETCH_LINEAR || ct_build_is_small(b, f->name, NULL);
}

bool ct_flexible_may_be_articulated(const struct ct_build *b)
{
    if (b->model->simulation.small.given)
        return false;
    for (size_t i = 0; i < b->nflexible; i++)
        if (b->flexible[i].kinematics != b->flexible[i].axial
            || b->flexible[i].formulation == CT_BEAM_STRETCH_LINEAR)
            return false;
    return true;
}
