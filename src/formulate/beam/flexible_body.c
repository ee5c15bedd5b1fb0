// See flexible_body.h.
#include "formulate/beam/deformation_selection.h"
#include "formulate/beam/beam_field.h"
#include "formulate/beam/static_condensation.h"
#include "formulate/beam/degrees_of_freedom.h"

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

// ---- freedoms -----------------------------------------------------------------------------------

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

// ---- creation -----------------------------------------------------------------------------------

// E(xi) = integral of slope_j slope_k, D = xi E(1) - E, and the integral of the rotation gradients
// of the sections.
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

// The mean strain of a section with rotations g is u' + (v'^2 + (I/A) g'^2)/2: with higher-order
// terms both shorten an inextensible axis. I/A of a tapered element is its mean.
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

// Deformations in a planar mechanism: bending about the normal, which is the y or z axis of the
// beam.
static unsigned in_plane(const struct ct_build *b, const struct ct_flexible *f)
{
    if (!b->topology->keeps_plane)
        return CT_BEAM_ALL;
    const ct_ex3 n
        = ct_ex33_apply_t(b->x, &b->topology->reference_axes[f->base], b->topology->normal);
    const bool about_z = fabs(ct_ex_value(b->x, n.e[2], b->value)) > 0.5;
    return CT_BEAM_AXIAL | (about_z ? CT_BEAM_BENDING_Z : CT_BEAM_BENDING_Y);
}

// Axial kinematics of a beam. Modes and given shapes cannot represent node positions that move by
// foreshortening. Also the stretch is small, but these positions are of second order in the slopes.
static enum ct_axial axial_of(const struct ct_build *b, const struct ct_flexible *f)
{
    if (f->formulation == CT_BEAM_LINEAR)
        return CT_AXIAL_LINEAR;
    return f->deformation & CT_BEAM_AXIAL && f->formulation == CT_BEAM_FORESHORTENING
                && !f->beam->modes && !f->beam->nshape && !ct_build_is_small(b, f->name, NULL)
             ? CT_AXIAL_LOCAL
             : CT_AXIAL_CHAIN;
}

// Deformations without stiffness are undetermined. They are excluded if the model does not excite
// them; otherwise they are an error in the model.
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
        if (b->options->keep_all || b->topology->is_spatial_for_beams)
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

// Automatic choice of formulation: as in earlier equations, else the one with the wider range of
// validity.
static void choose_formulation(const struct ct_build *b, struct ct_flexible *f)
{
    const struct ct_flexible *like
        = b->options->like ? ct_flexible_of(b->options->like->build, f->body) : NULL;
    f->formulation = like ? like->formulation : CT_BEAM_FORESHORTENING;
    if (b->options->is_linear)
        f->formulation
            = b->options->is_linear[f->body] ? CT_BEAM_LINEAR : CT_BEAM_FORESHORTENING;
}

static void choose_deformation(struct ct_build *b, struct ct_flexible *f)
{
    const struct ct_beam *beam = f->beam;
    f->formulation = beam->formulation;
    if (beam->formulation == CT_BEAM_AUTO)
        choose_formulation(b, f);
    f->excited = in_plane(b, f);
    f->deformation = beam->deformation & (b->topology->is_planar ? f->excited : CT_BEAM_ALL);
    // then it has no inertia either, so that it needs no coordinate
    const char *untwisted = f->deformation & CT_BEAM_TORSION && !beam->deformation_given
                              ? ct_deformation_no_twist(b, f)
                              : NULL;
    if (untwisted) {
        f->deformation &= ~(unsigned)CT_BEAM_TORSION;
        ct_build_note_left_out(b, ct_arena_printf(b->arena, "torsion of %s", f->name),
                               untwisted);
    }
    if (b->topology->is_planar
        && beam->deformation & ~(unsigned)(CT_BEAM_AXIAL | f->deformation))
        ct_build_note_left_out(
            b,
            ct_arena_printf(b->arena, "bending of %s out of the plane, and its torsion",
                            f->name),
            "gravity, loads, masses and arms lie in the plane");
    if (beam->misses_rotary)
        ct_build_note_left_out(b, ct_arena_printf(b->arena, "rotary inertia of %s", f->name),
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
    if (b->options->is_rigid)
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
        // equal lengths to the last bit, so that all elements share one program
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

struct ct_flexible *ct_flexible_of_edge(const struct ct_build *b, const struct ct_edge_info *e)
{
    return e->beam < 0 ? NULL : &b->flexible[e->beam];
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
