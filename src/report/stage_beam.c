// See stage_beam.h.
#include "report/stage_beam.h"

#include "expr/collect.h"
#include "formulate/beam_dynamics/beam_dynamics.h"
#include "report/same_page.h"

#include <string.h>

// Larger beams are counted, not printed.
// Layout: of a page
enum { MOST_ELEMENTS = 40, MOST_COORDINATES = 120, LARGEST_ARM = 300 };

// ---- what a beam is ------------------------------------------------------------------------

static const struct {
    unsigned bit;
    const char *name;
    int first, n; // its dofs
} families[] = {{CT_BEAM_AXIAL, "axial", 0, CT_LINE_DOF},
                {CT_BEAM_BENDING_Z, "bending-z", 2, 4},
                {CT_BEAM_BENDING_Y, "bending-y", 6, 4},
                {CT_BEAM_TORSION, "torsion", CT_AXIS_DOF, CT_LINE_DOF}};

// Dofs of family i that the beam's elements have.
static int ndof_of(const struct ct_beam *beam, size_t i)
{
    const bool is_linear = (families[i].bit == CT_BEAM_TORSION && !beam->has_quadratic_twist)
                        || (families[i].bit == CT_BEAM_AXIAL && !beam->has_quadratic_stretch);
    return families[i].n - is_linear;
}

// Number of the j-th dof of family i.
static int dof_of(size_t i, int j)
{
    return families[i].bit == CT_BEAM_AXIAL ? ct_stretch_dof(j) : families[i].first + j;
}

const char *ct_beam_dof_name(int j)
{
    static const char *const name[CT_DOF]
        = {"u1",    "u2", "v1",    "alpha1", "v2",   "alpha2", "w1",
           "beta1", "w2", "beta2", "u3",     "phi1", "phi2",   "phi3"};
    return name[j];
}

const char *ct_beam_formulation_name(enum ct_beam_formulation f)
{
    static const char *const name[]
        = {"auto", "linear", "foreshortening", "force-only", "stretch-linear"};
    return name[f];
}

const char *ct_beam_sentence(struct ct_arena *a, const struct ct_flexible *f)
{
    const struct ct_beam *beam = f->beam;
    const char *list = "";
    for (size_t i = 0; i < COUNT(families); i++)
        if (f->deformation & families[i].bit)
            list = ct_arena_printf(a, "%s%s%s", list, *list ? ", " : "", families[i].name);
    return ct_arena_printf(a, "%d element%s, %d elastic coordinate%s; %s%s; %s%s; frame %s%s",
                           beam->nelement, beam->nelement == 1 ? "" : "s", f->nelastic,
                           f->nelastic == 1 ? "" : "s",
                           *list ? "deforms by " : "keeps its shape", list,
                           ct_beam_formulation_name(f->formulation),
                           f->why ? ct_arena_printf(a, " (%s)", f->why)
                           : beam->formulation == CT_BEAM_AUTO ? " (auto)"
                                                               : "",
                           beam->is_chord ? "chord" : "clamped",
                           beam->theory == CT_BEAM_TIMOSHENKO ? "; timoshenko" : "");
}

// ---- the element ---------------------------------------------------------------------------

static bool varies(struct ct_build *b, ct_ex v)
{
    return ct_ex_kinds(b->x, v) & 1u << CT_SYM_LOCAL;
}

// int (v'^2 + w'^2)/2 dx; higher-order: with I/A times the squared rotation gradient.
static ct_ex shortening(struct ct_build *b, const struct ct_flexible *one, const ct_ex *dof)
{
    struct ct_exs *x = b->x;
    const struct ct_beam *beam = one->beam;
    ct_ex sum = CT_EX_ZERO;
    for (int plane = 0; plane < 2; plane++)
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++) {
                const int first = plane ? 6 : 2;
                ct_ex E = ct_shape_at(x, &one->shortening[j][k], CT_EX_ONE,
                                      one->element[0].span.length);
                if (beam->higher_order) {
                    const struct ct_shape bend[2] = {ct_shape_slope(&one->shape.rotation[j]),
                                                     ct_shape_slope(&one->shape.rotation[k])};
                    const ct_ex radius = ct_ex_div(x, plane ? beam->Iy : beam->Iz, beam->area);
                    E = ct_ex_add(x, E,
                                  ct_flexible_integral(b, one, 0, radius, &bend[0], &bend[1],
                                                       ct_flexible_stiffness_rule(beam)));
                }
                const ct_ex both = ct_ex_mul(x, dof[first + j], dof[first + k]);
                sum = ct_ex_add(x, sum, ct_ex_scale(x, 0.5, ct_ex_mul(x, E, both)));
            }
    return sum;
}

// Sum of polynomials in xi times the dofs, powers written out.
static ct_ex field(const struct ct_beam_element *e, const struct ct_shape *shape, int from,
                   int n)
{
    struct ct_exs *x = e->x;
    ct_ex sum = CT_EX_ZERO;
    for (int j = 0; j < n; j++) {
        ct_ex f = CT_EX_ZERO;
        for (int i = 0; i < CT_SHAPE_SIZE; i++)
            f = ct_ex_add(
                x, f, ct_ex_scale(x, shape[j].c[i], ct_ex_pow(x, e->xi, ct_ex_const(x, i))));
        if (shape[j].power)
            f = ct_ex_mul(x, e->h, f);
        sum = ct_ex_add(x, sum, ct_ex_mul(x, f, e->dof[from + j]));
    }
    return sum;
}

// Strain energies of the element `one`, family by family.
static void derive_energies(struct ct_build *b, struct ct_flexible *one,
                            struct ct_beam_element *out)
{
    const struct ct_span span = one->element[0].span;
    for (size_t i = 0; i < COUNT(families); i++) {
        const int n = ndof_of(one->beam, i);
        struct ct_element own = {.span = span};
        if (!(one->deformation & families[i].bit))
            continue;
        for (int j = 0; j < n; j++)
            own.value[dof_of(i, j)] = out->dof[dof_of(i, j)];
        if (families[i].bit == CT_BEAM_AXIAL) {
            own.value[0] = CT_EX_ZERO;
            own.value[1] = out->stretch;
        }
        one->element = &own;
        out->energy[i] = ct_flexible_strain(b, one);
    }
}

void ct_beam_element_derive(struct ct_build *b, const struct ct_flexible *f,
                            struct ct_beam_element *out)
{
    struct ct_exs *x = b->x;
    struct ct_beam beam = *f->beam;
    struct ct_flexible one = *f;
    struct ct_element e = {.span = {.start = CT_EX_ZERO}};
    *out = (struct ct_beam_element){
        .x = x,
        .xi = ct_ex_sym(x, CT_SYM_LOCAL, "xi", 0),
        .h = ct_ex_sym(x, CT_SYM_LOCAL, "h", 0),
        .stretch = ct_ex_sym(x, CT_SYM_LOCAL, "s", 0),
    };
    beam.nelement = 1;
    one.beam = &beam;
    one.element = &e;
    one.axial = CT_AXIAL_CHAIN; // the stretch is that of the axial dofs
    e.span.length = out->h;
    for (size_t i = 0; i < COUNT(families); i++)
        for (int k = 0; k < ndof_of(&beam, i); k++) {
            const int j = dof_of(i, k);
            if (f->deformation & families[i].bit)
                e.value[j] = out->dof[j]
                    = ct_ex_sym(x, CT_SYM_LOCAL, ct_beam_dof_name(j), (uint32_t)j);
        }
    out->axial
        = ct_ex_add(x, field(out, f->line, 0, 2), field(out, &f->line[2], CT_MIDDLE_DOF, 1));
    out->v = field(out, f->shape.deflection, 2, 4);
    out->w = field(out, f->shape.deflection, 6, 4);
    out->twist = field(out, f->line, CT_AXIS_DOF, CT_LINE_DOF);
    out->is_constant = !varies(b, beam.area) && !varies(b, beam.Iy) && !varies(b, beam.Iz)
                    && !varies(b, beam.J);
    if (!out->is_constant)
        return;
    out->shortening = shortening(b, &one, e.value);
    derive_energies(b, &one, out);
}

// ---- terminal equations --------------------------------------------------------------------

// A line in the page's look.
static void put(struct ct_derivation *d, const char *left, const char *text, const char *latex,
                const char *note)
{
    ct_page_equation(&d->page, NULL, left, ct_derivation_is_latex(d) ? latex : text, note);
}

static const char *of(struct ct_derivation *d, const char *letter, const struct ct_flexible *f)
{
    return ct_derivation_of(d, letter, f->name);
}

static const char *position_symbol(const struct ct_derivation *d)
{
    return ct_derivation_is_latex(d) ? "\\boldsymbol{r}" : "r";
}

// Rotation of the section at x, to first order.
static void put_rotation(struct ct_derivation *d, const struct ct_flexible *f)
{
    const bool has_shear = f->beam->theory == CT_BEAM_TIMOSHENKO;
    const struct {
        unsigned family;
        const char *text, *latex;
    } about[] = {
        {CT_BEAM_TORSION, "phi", "\\varphi"},
        {CT_BEAM_BENDING_Y, has_shear ? "-beta" : "-dw/dx", has_shear ? "-\\beta" : "-w_{,x}"},
        {CT_BEAM_BENDING_Z, has_shear ? "alpha" : "dv/dx", has_shear ? "\\alpha" : "v_{,x}"}};
    const char *part[3], *latex[3];
    for (int i = 0; i < 3; i++) {
        const bool is_free = f->deformation & about[i].family;
        part[i] = is_free ? about[i].text : "0";
        latex[i] = is_free ? about[i].latex : "0";
    }
    put(d, ct_derivation_is_latex(d) ? "\\boldsymbol{\\theta}" : "theta",
        ct_arena_printf(d->a, "[%s, %s, %s]", part[0], part[1], part[2]),
        ct_arena_printf(d->a, "(%s,\\; %s,\\; %s)", latex[0], latex[1], latex[2]),
        "rotation of the section at x");
}

// (5.4), (5.5): motion of the section at x in terms of the frame and the elastic coordinates.
static void put_body(struct ct_derivation *d, const struct ct_flexible *f)
{
    const bool latex = ct_derivation_is_latex(d);
    bool has_rotary = false;
    for (int i = 0; i < 3; i++)
        has_rotary |= !ct_ex_is_zero(ct_flexible_rotary(f, i).value);
    const char *frame = d->e->build->topology->node[f->base].name;
    ct_page_heading(&d->page, ct_arena_printf(d->a, "beam %s", f->name));
    ct_page_sentence(&d->page, "%s", ct_beam_sentence(d->a, f));
    ct_page_equations(&d->page);
    const char *v = f->deformation & CT_BEAM_BENDING_Z ? "v" : "0";
    const char *w = f->deformation & CT_BEAM_BENDING_Y ? "w" : "0";
    put(d, position_symbol(d), ct_arena_printf(d->a, "[x + u, %s, %s]", v, w),
        ct_arena_printf(d->a, "(x + u,\\; %s,\\; %s)", v, w),
        ct_arena_printf(d->a, "position of the section at x, axes of %s", frame));
    const char *const motion[]
        = {ct_derivation_of(d, "a", frame), ct_derivation_of(d, "al", frame),
           ct_derivation_of(d, "w", frame)};
    ct_page_equation(
        &d->page, NULL, latex ? "\\boldsymbol{c}" : "c",
        ct_arena_printf(
            d->a,
            latex ? "%s - \\boldsymbol{g} + %s \\times \\boldsymbol{r} + %s \\times (%s "
                    "\\times \\boldsymbol{r}) + 2 \\, %s \\times "
                    "\\dot{\\boldsymbol{r}} + "
                    "\\ddot{\\boldsymbol{r}}"
                  : "%s - g + %s x r + %s x (%s x r) + 2*%s x r' + r''",
            motion[0], motion[1], motion[2], motion[2], motion[2]),
        "its acceleration minus gravity");
    ct_page_equation(&d->page, NULL, latex ? "\\mu" : "mu",
                     ct_derivation_text(d, f->beam->mass_per_length), "mass per length");
    put(d, of(d, "F", f), "-int(mu*c)", "-\\int \\mu \\, \\boldsymbol{c} \\, dx", NULL);
    const char *turning = ct_arena_printf(
        d->a, latex ? "J \\, (%s + \\ddot{\\boldsymbol{\\theta}})" : "J*(%s + theta'')",
        motion[1]);
    const char *spin
        = ct_arena_printf(d->a,
                          latex ? " + %s \\times J \\, (%s + \\dot{\\boldsymbol{\\theta}})"
                                : " + %s x J*(%s + theta')",
                          motion[2], motion[2]);
    const char *const plus = has_rotary ? " + " : "";
    ct_page_equation(&d->page, NULL, of(d, "T", f),
                     ct_arena_printf(d->a,
                                     latex ? "-\\int \\left( \\mu \\, \\boldsymbol{r} \\times "
                                             "\\boldsymbol{c}%s%s%s \\right) dx"
                                           : "-int(mu*r x c%s%s%s)",
                                     plus, has_rotary ? turning : "", has_rotary ? spin : ""),
                     NULL);
    const bool is_damped
        = !ct_ex_is_zero(f->beam->damping_mass) || !ct_ex_is_zero(f->beam->damping_stiffness);
    const char *own = ct_arena_printf(
        d->a, latex ? "\\boldsymbol{\\theta}_{,q} \\cdot %s" : "theta_q . %s", turning);
    ct_page_equation(
        &d->page, NULL, ct_derivation_effort(d, "q"),
        ct_arena_printf(d->a,
                        latex ? "-\\int \\left( \\mu \\, \\boldsymbol{r}_{,q} \\cdot "
                                "\\boldsymbol{c}%s%s \\right) dx - V_{,q}%s"
                              : "-int(mu*r_q . c%s%s) - V_q%s",
                        plus, has_rotary ? own : "",
                        !is_damped ? ""
                        : latex    ? " - C_{,q}"
                                   : " - C_q"),
        "of each elastic coordinate q; _q: derivative by it; V: strain energy, below");
    if (is_damped)
        ct_page_sentence(
            &d->page,
            "C_q: alpha = %s times the mass of the elastic coordinates and beta = %s "
            "times their stiffness, on their rates",
            ct_derivation_text(d, f->beam->damping_mass),
            ct_derivation_text(d, f->beam->damping_stiffness));
    if (!has_rotary)
        return;
    put_rotation(d, f);
    const char *list = "";
    for (int i = 0; i < 3; i++)
        list = ct_arena_printf(d->a, "%s%s%s", list, *list ? ", " : "",
                               ct_derivation_text(d, ct_flexible_rotary(f, i).value));
    ct_page_equation(
        &d->page, NULL, "J",
        ct_arena_printf(d->a, latex ? "\\operatorname{diag}(%s)" : "diag[%s]", list),
        "rotary inertia per length");
}

// Displacement along the axis: that of the axial dofs minus foreshortening.
static const char *axial_text(struct ct_derivation *d, const struct ct_flexible *f,
                              const char *plain)
{
    const bool latex = ct_derivation_is_latex(d);
    const unsigned bending = CT_BEAM_BENDING_Y | CT_BEAM_BENDING_Z;
    const bool is_linear = f->kinematics == CT_AXIAL_LINEAR || !(f->deformation & bending);
    const char *more = is_linear ? ""
                     : f->kinematics == CT_AXIAL_LOCAL
                         ? latex ? " + \\xi \\, S(1) - S(\\xi)" : " + xi*S(1) - S(xi)"
                     : latex ? " - S_0 - S(\\xi)"
                             : " - S0 - S(xi)";
    if (!strcmp(plain, "0") && *more)
        return more + 1; // starts with its sign: " - S0 ..." becomes "- S0 ..."
    return ct_arena_printf(d->a, "%s%s", plain, more);
}

static void put_shortening(struct ct_derivation *d, const struct ct_flexible *f,
                           const struct ct_beam_element *e)
{
    if (f->axial == CT_AXIAL_LINEAR)
        return;
    put(d, ct_derivation_is_latex(d) ? "S(\\xi)" : "S(xi)", "int((dv/dx)^2/2 + (dw/dx)^2/2)",
        "\\tfrac{1}{2} \\int_0^{\\xi} \\left( v_{,x}^{2} + w_{,x}^{2} \\right) h \\, d\\xi",
        "foreshortening: shortening of the axis by bending");
    if (e->is_constant && !ct_ex_is_zero(e->shortening))
        ct_page_equation(&d->page, NULL, "S(1)", ct_derivation_collected(d, e->shortening),
                         NULL);
    if (f->axial == CT_AXIAL_CHAIN)
        ct_page_sentence(
            &d->page, "S0 is the sum of S(1) over the elements before%s",
            f->kinematics == CT_AXIAL_LINEAR
                ? "; positions are those of a linear beam, forces those of a foreshortened one"
                : "");
}

// Sections that vary along the beam.
static void put_varying_energy(struct ct_derivation *d, const struct ct_flexible *f)
{
    const struct ct_beam *beam = f->beam;
    const bool latex = ct_derivation_is_latex(d);
    const struct {
        unsigned bit;
        const char *text, *latex, *name;
        ct_ex section;
    } part[]
        = {{CT_BEAM_AXIAL, "E*area*(s/h)^2", "E \\, \\mathrm{area} \\, (s/h)^{2}", "area",
            beam->area},
           {CT_BEAM_BENDING_Z, "E*Iz*(d2v/dx2)^2", "E \\, I_z \\, v_{,xx}^{2}", "Iz", beam->Iz},
           {CT_BEAM_BENDING_Y, "E*Iy*(d2w/dx2)^2", "E \\, I_y \\, w_{,xx}^{2}", "Iy", beam->Iy},
           {CT_BEAM_TORSION, "G*J*(dphi/dx)^2", "G \\, J \\, \\varphi_{,x}^{2}", "J", beam->J}};
    const char *sum = "";
    for (size_t i = 0; i < COUNT(part); i++)
        if (f->deformation & part[i].bit)
            sum = ct_arena_printf(d->a, "%s%s%s", sum, *sum ? " + " : "",
                                  latex ? part[i].latex : part[i].text);
    ct_page_equation(
        &d->page, NULL, "V",
        ct_arena_printf(
            d->a, latex ? "\\tfrac{1}{2} \\int \\left( %s \\right) dx" : "int(%s)/2", sum),
        "strain energy");
    for (size_t i = 0; i < COUNT(part); i++)
        if (f->deformation & part[i].bit)
            ct_page_equation(&d->page, NULL, ct_derivation_name(d, part[i].name),
                             ct_derivation_text(d, part[i].section), NULL);
}

static void put_energy(struct ct_derivation *d, const struct ct_flexible *f,
                       const struct ct_beam_element *e)
{
    if (f->deformation & CT_BEAM_AXIAL) {
        const bool local = f->axial == CT_AXIAL_LOCAL;
        put(d, "s", local ? "u2 - u1 + S(1)" : "u2 - u1",
            local ? "u_{2} - u_{1} + S(1)" : "u_{2} - u_{1}", "stretch");
    }
    const char *sum = "";
    for (size_t i = 0; i < COUNT(families); i++)
        if (!ct_ex_is_zero(e->energy[i]))
            sum = ct_arena_printf(d->a, "%s%s%s", sum, *sum ? " + " : "",
                                  ct_derivation_collected(d, e->energy[i]));
    if (e->is_constant)
        ct_page_equation(&d->page, NULL, "V", sum, "strain energy");
    else
        put_varying_energy(d, f);
}

static void put_element(struct ct_derivation *d, const struct ct_flexible *f)
{
    struct ct_beam_element e;
    ct_beam_element_derive(d->e->build, f, &e);
    const struct {
        const char *left, *latex;
        ct_ex value;
        unsigned family;
    } fields[] = {{"v", "v", e.v, CT_BEAM_BENDING_Z},
                  {"w", "w", e.w, CT_BEAM_BENDING_Y},
                  {"phi", "\\varphi", e.twist, CT_BEAM_TORSION}};
    ct_page_heading(&d->page, ct_arena_printf(d->a, "element of %s", f->name));
    ct_page_sentence(
        &d->page,
        "xi = 0 ... 1 along its length h; dofs at its ends 1 and 2: u, v, w, %s, twist phi%s%s",
        f->beam->theory == CT_BEAM_TIMOSHENKO
            ? "alpha and beta (rotations of the sections, as dv/dx and dw/dx)"
            : "alpha = dv/dx, beta = dw/dx",
        f->beam->has_quadratic_twist ? ", phi3 in the middle beyond the mean of its ends" : "",
        f->beam->has_quadratic_stretch ? ", u3 in the middle beyond the mean of its ends" : "");
    ct_page_equations(&d->page);
    ct_page_equation(&d->page, NULL, "u", axial_text(d, f, ct_derivation_text(d, e.axial)),
                     NULL);
    for (size_t i = 0; i < COUNT(fields); i++)
        if (f->deformation & fields[i].family)
            ct_page_equation(&d->page, NULL,
                             ct_derivation_is_latex(d) ? fields[i].latex : fields[i].left,
                             ct_derivation_text(d, fields[i].value), NULL);
    put_shortening(d, f, &e);
    put_energy(d, f, &e);
}

// Table of the coordinates for the dofs of each element, family by family.
static void put_index(struct ct_derivation *d, const struct ct_flexible *f)
{
    const int n = f->beam->nelement;
    bool is_first = true;
    ct_page_heading(&d->page, ct_arena_printf(d->a, "dofs of the elements of %s", f->name));
    for (size_t i = 0; i < COUNT(families); i++) {
        if (!(f->deformation & families[i].bit))
            continue;
        const int first = families[i].first, ndof = ndof_of(f->beam, i);
        static const char align[] = "rLLLLLL"; // places of the first table, dofs
        const int ncolumn = 1 + (is_first ? 2 : 0) + ndof;
        ct_page_table(&d->page, ct_arena_printf(d->a, "%.*s", ncolumn, align));
        ct_page_cell(&d->page, "element");
        if (is_first) {
            ct_page_cell(&d->page, "from x");
            ct_page_cell(&d->page, "to");
        }
        for (int j = first; j < first + ndof; j++)
            ct_page_cell(&d->page, ct_beam_dof_name(j));
        for (int k = 0; k < n && k < MOST_ELEMENTS; k++) {
            const struct ct_element *e = &f->element[k];
            ct_page_cell(&d->page, ct_arena_printf(d->a, "%d", k + 1));
            if (is_first) {
                ct_page_cell(&d->page, ct_derivation_text(d, e->span.start));
                ct_page_cell(&d->page, ct_derivation_text(d, f->beam->end[k]));
            }
            for (int j = first; j < first + ndof; j++)
                ct_page_cell(&d->page, ct_derivation_text(d, e->value[j]));
        }
        is_first = false;
    }
    if (n > MOST_ELEMENTS)
        ct_page_sentence(&d->page, "... and %d elements more", n - MOST_ELEMENTS);
}

static void put_whole(struct ct_derivation *d, size_t i)
{
    const struct ct_flexible *f = &d->e->build->flexible[i];
    put_body(d, f);
    if (!f->nelastic)
        return;
    put_element(d, f);
    put_index(d, f);
    ct_beam_matrices_put_element(d, f);
    ct_beam_matrices_put(d, i);
}

// In text format, the description of a beam is not repeated for one that differs by its name
// alone.
void ct_beams_put_terminal(struct ct_derivation *d)
{
    const struct ct_build *b = d->e->build;
    uint64_t *meaning = CT_NEWN(d->a, uint64_t, b->nflexible + 1);
    for (size_t i = 0; i < b->nflexible; i++) {
        const char *name = b->flexible[i].name;
        const size_t from = d->page.nblock;
        size_t same = 0;
        d->page.about = name;
        put_whole(d, i);
        if (d->page.look == CT_LOOK_TEXT && b->flexible[i].nelastic) {
            meaning[i] = ct_page_meaning(&d->page, from, name);
            while (same < i && meaning[same] != meaning[i])
                same++;
            if (same < i) {
                d->page.nblock = from;
                ct_page_heading(&d->page, ct_arena_printf(d->a, "beam %s", name));
                ct_page_sentence(&d->page, "as beam %s, with %s for %s in all names",
                                 b->flexible[same].name, name, b->flexible[same].name);
            }
        }
        if (b->flexible[i].nelastic)
            ct_beam_matrices_put_angular_velocity(d, i);
    }
}

// ---- arms ----------------------------------------------------------------------------------

static const char *position_text(struct ct_derivation *d, const struct ct_edge_info *e)
{
    struct ct_exs *x = d->e->x;
    const struct ct_collect_options o = {.scratch = d->a};
    ct_ex3 at = ct_edge_kinematics(d->e->build, e)->d;
    double size = 0;
    for (int k = 0; k < 3; k++)
        size += ct_reduced_size(x, at.e[k], LARGEST_ARM + 1);
    if (size > LARGEST_ARM)
        return ct_arena_printf(
            d->a, ct_derivation_is_latex(d) ? "\\boldsymbol{r}(%s)" : "r at x = %s",
            ct_derivation_text(d, e->along));
    for (int k = 0; k < 3; k++)
        at.e[k] = ct_ex_collect(x, at.e[k], &o);
    return ct_derivation_vector(d, at);
}

static const char *turns_text(struct ct_derivation *d, const struct ct_motion *m)
{
    const bool latex = ct_derivation_is_latex(d);
    const char *s = "";
    for (int i = 0; i < m->nturn; i++)
        s = ct_arena_printf(d->a, latex ? "%s%s\\operatorname{Rot}(%s, %s)" : "%s%sRot(%s, %s)",
                            s, *s ? latex ? " \\, " : "*" : "",
                            ct_derivation_axis(d, m->turn[i].axis),
                            ct_derivation_exact(d, m->turn[i].angle));
    return *s ? s : "1";
}

void ct_beams_put_arms(struct ct_derivation *d)
{
    const struct ct_build *b = d->e->build;
    bool any = false;
    for (size_t i = 0; i < b->topology->nedge; i++) {
        const struct ct_edge_info *e = &b->topology->edge[i];
        if (e->beam < 0)
            continue;
        if (!any) {
            ct_page_heading(&d->page,
                            "flexible arms: from the frame of a beam to its sections");
            ct_page_equations(&d->page);
        }
        any = true;
        d->page.about = e->name;
        ct_page_equation(&d->page, NULL, ct_derivation_of(d, "d", e->name), position_text(d, e),
                         ct_arena_printf(d->a, "axes of %s",
                                         b->topology->node[b->topology->wiring[i].tail].name));
        ct_page_equation(&d->page, NULL, ct_derivation_of(d, "S", e->name),
                         turns_text(d, ct_edge_motion(b, e)), NULL);
    }
}

// ---- cutsets of the elastic coordinates ----------------------------------------------------

static const char *partial(struct ct_derivation *d, const char *letter, const char *arm,
                           const char *through)
{
    // one group of subscripts: LaTeX refuses a second one
    return ct_derivation_is_latex(d)
             ? ct_arena_printf(d->a, "\\boldsymbol{%s}_{\\mathrm{%s},q} \\cdot %s", letter,
                               ct_latex_quoted(d->a, arm), ct_derivation_of(d, through, arm))
             : ct_arena_printf(d->a, "%s_q(%s) . %s", letter, arm,
                               ct_derivation_of(d, through, arm));
}

static const char *into_arms(struct ct_derivation *d, const struct ct_flexible *f, int k)
{
    const struct ct_build *b = d->e->build;
    const char *s = "";
    for (size_t i = 0; i < b->topology->nedge; i++) {
        const struct ct_edge_info *e = &b->topology->edge[i];
        if (ct_flexible_of_edge(b, e) != f)
            continue;
        if (!ct_ex3_is_zero(ct_edge_kinematics(b, e)->translation[k]))
            s = ct_arena_printf(d->a, "%s%s%s", s, *s ? " + " : "",
                                partial(d, "d", e->name, "F"));
        if (!ct_ex3_is_zero(ct_edge_kinematics(b, e)->rotation[k]))
            s = ct_arena_printf(d->a, "%s%s%s", s, *s ? " + " : "",
                                partial(d, "Y", e->name, "T"));
    }
    return *s ? s : "0";
}

void ct_beams_put_cutsets(struct ct_derivation *d)
{
    const struct ct_build *b = d->e->build;
    int n = 0;
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        for (int k = 0; k < f->nelastic; k++, n++) {
            if (n == 0) {
                ct_page_heading(&d->page, "elastic coordinates");
                ct_page_sentence(&d->page,
                                 "the generalised force of the beam is that of its arms; d_q, "
                                 "Y_q: velocity and "
                                 "angular velocity of an arm's head for a unit rate of q");
                ct_page_equations(&d->page);
            }
            if (n < MOST_COORDINATES)
                ct_page_equation(&d->page, NULL, ct_derivation_effort(d, f->elastic[k].name),
                                 into_arms(d, f, k), NULL);
        }
    }
    if (n > MOST_COORDINATES)
        ct_page_sentence(&d->page, "... and %d more", n - MOST_COORDINATES);
}
