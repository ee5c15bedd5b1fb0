// Beams: from the values of the class to struct ct_beam, with checks along the axis.
#include "component/read.h"

#include "base/sort.h"
#include "component/roundoff.h"
#include "expr/quadrature.h"
#include "expr/switches.h"

#include <math.h>
#include <string.h>

// ---- checks of single values -------------------------------------------------------------------

struct work {
    struct ct_reader *r;
    const struct ct_instance *self;
    struct ct_beam *beam;
    double *value; // of all symbols, x among them
    size_t x;      // index of x in them
};

static const struct ct_value *get(const struct work *w, const char *key)
{
    return ct_instance_value(w->self, key);
}

static bool has(const struct work *w, const char *key)
{
    return get(w, key)->given;
}

// Value of a scalar key; 0 if it is not given.
static ct_ex scalar(const struct work *w, const char *key)
{
    const struct ct_value *v = get(w, key);
    return v->given ? v->e[0] : CT_EX_ZERO;
}

static bool needs(const struct work *w, const char *what, const char *why)
{
    return ct_error(w->r->ctx, w->self->mark, CT_E_KEY_MISSING, "body '%s' needs %s: %s",
                    w->self->name, what, why);
}

static bool excludes(const struct work *w, const char *a, const char *b)
{
    if (!has(w, a) || !has(w, b))
        return true;
    const struct ct_mark p = get(w, a)->mark, q = get(w, b)->mark;
    const bool first = p.line != q.line ? p.line > q.line : p.column > q.column;
    return ct_error(w->r->ctx, first ? p : q, CT_E_CONFLICT,
                    "body '%s': give '%s' or '%s', not both", w->self->name, a, b);
}

// Does the value vary along the beam?
static bool is_along(const struct work *w, const struct ct_value *v, size_t i)
{
    return ct_ex_kinds(w->r->m->x, v->e[i]) & 1u << CT_SYM_LOCAL;
}

static bool check_above(const struct work *w, const char *key, double least, bool strict)
{
    const struct ct_value *v = get(w, key);
    bool ok = true;
    for (size_t i = 0; v->given && !v->is_wrong && i < v->n; i++) {
        double number;
        if (!is_along(w, v, i) && ct_read_number(w->r, v->e[i], &number) && !(number > least)
            && (strict || number != least))
            ok = ct_error(w->r->ctx, v->at[i], CT_E_RANGE,
                          "body '%s': '%s' is %g; it must be %s %g", w->self->name, key, number,
                          strict ? "greater than" : "at least", least);
    }
    return ok;
}

static bool check_density(const struct work *w)
{
    const struct ct_value *v = get(w, "density");
    double number;
    if (!v->given || v->is_wrong || is_along(w, v, 0) || !ct_read_number(w->r, v->e[0], &number)
        || number >= 0)
        return true;
    return ct_error(w->r->ctx, v->mark, CT_E_MASS,
                    "body '%s': the density is negative (%g kg/m^3)", w->self->name, number);
}

static bool check_nu(const struct work *w)
{
    const struct ct_value *v = get(w, "nu");
    double number;
    if (!v->given || v->is_wrong || is_along(w, v, 0) || !ct_read_number(w->r, v->e[0], &number)
        || (number > -1 && number <= 0.5))
        return true;
    return ct_error(w->r->ctx, v->mark, CT_E_RANGE,
                    "body '%s': 'nu' is %g; it must lie between -1 and 0.5", w->self->name,
                    number);
}

static bool check_scalars(const struct work *w)
{
    bool ok = check_above(w, "length", 0, true);
    ok &= check_above(w, "E", 0, true);
    ok &= check_above(w, "G", 0, true);
    ok &= check_above(w, "shear_factor", 0, true);
    ok &= check_nu(w);
    return check_density(w) && ok;
}

// ---- combinations of keys ----------------------------------------------------------------------

static unsigned find_known(const struct work *w)
{
    const bool has_G = has(w, "G") || has(w, "nu");
    const bool bends = get(w, "theory")->count == CT_BEAM_EULER_BERNOULLI || has_G;
    const bool has_Iy = has(w, "Iy"), has_Iz = has(w, "Iz");
    return (has(w, "area") ? CT_BEAM_AXIAL : 0u) | (bends && has_Iy ? CT_BEAM_BENDING_Y : 0u)
         | (bends && has_Iz ? CT_BEAM_BENDING_Z : 0u)
         | (has_G && (has(w, "J") || (has_Iy && has_Iz)) ? CT_BEAM_TORSION : 0u);
}

static bool check_mass_keys(const struct work *w)
{
    bool ok = excludes(w, "density", "mass_per_length");
    if (!has(w, "density") && !has(w, "mass_per_length"))
        ok = needs(w, "'density'", "the mass is density*area; or give 'mass_per_length'");
    if (has(w, "density") && !has(w, "area"))
        ok = needs(w, "'area'", "the mass is density*area");
    else if (get(w, "rotary_inertia")->count == 1 && !has(w, "area"))
        ok = needs(w, "'area'", "the density of 'rotary_inertia' is mass_per_length/area");
    else if (get(w, "geometric_stiffness")->count == 1 && !has(w, "area"))
        ok = needs(w, "'area'", "'geometric_stiffness: higher-order' contains I/area");
    return ok;
}

static bool check_theory(const struct work *w)
{
    bool ok = excludes(w, "G", "nu");
    if (get(w, "theory")->count != CT_BEAM_TIMOSHENKO) {
        if (has(w, "shear_factor"))
            ct_warning(w->r->ctx, get(w, "shear_factor")->mark, 0,
                       "body '%s': 'shear_factor' changes nothing, as beams of Euler and "
                       "Bernoulli do not shear; leave it out, or give 'theory: timoshenko'",
                       w->self->name);
        return ok;
    }
    const char *why = "Timoshenko's theory has the shear stiffness shear_factor*G*area";
    if (!has(w, "shear_factor"))
        ok = needs(w, "'shear_factor'", why);
    if (!has(w, "G") && !has(w, "nu"))
        ok = needs(w, "'G' or 'nu'", why);
    if (!has(w, "area") && !has(w, "density")) // otherwise the missing key has been reported
        ok = needs(w, "'area'", why);
    return ok;
}

// Quadratic twist and stretch are internal freedoms of an element. Reduced integration gives them
// no stiffness and lumped mass no inertia, so these combinations are errors.
static bool check_quadratic(const struct work *w, const char *key)
{
    const char *rule = get(w, "mass")->count ? "mass" : "integration";
    if (!get(w, key)->count || !get(w, rule)->count)
        return true;
    return ct_error(w->r->ctx, get(w, key)->mark, CT_E_CONFLICT,
                    "body '%s': '%s: quadratic' needs 'integration: full' and 'mass: "
                    "consistent'; leave '%s' out",
                    w->self->name, key, rule);
}

// Foreshortening gives forces that are quadratic in the velocities of deflection. Without them the
// model would be inconsistent, so this combination is an error.
static bool check_quadratic_velocity(const struct work *w)
{
    if (!get(w, "quadratic_velocity")->count || get(w, "formulation")->count == CT_BEAM_LINEAR)
        return true;
    return ct_error(w->r->ctx, get(w, "quadratic_velocity")->mark, CT_E_CONFLICT,
                    "body '%s': 'quadratic_velocity: false' needs 'formulation: linear'",
                    w->self->name);
}

// Each listed deformation needs a stiffness; a beam with free choice needs at least bending
// stiffness.
static bool check_deformation(const struct work *w, unsigned known)
{
    static const struct {
        unsigned bit;
        const char *what, *why;
    } wanted[] = {
        {CT_BEAM_AXIAL, "'area'", "'deformation' lists axial"},
        {CT_BEAM_BENDING_Y, "'Iy'", "'deformation' lists bending-y, in the x-z plane"},
        {CT_BEAM_BENDING_Z, "'Iz'", "'deformation' lists bending-z, in the x-y plane"},
        {CT_BEAM_TORSION, "'G' or 'nu', and 'J' or 'Iy' and 'Iz'",
         "'deformation' lists torsion"},
    };
    const struct ct_value *v = get(w, "deformation");
    const bool timoshenko = get(w, "theory")->count == CT_BEAM_TIMOSHENKO;
    bool ok = true;
    if (!v->given)
        return has(w, "Iy") || has(w, "Iz")
            || needs(w, "'Iz' or 'Iy'", "second moment of the section for bending");
    for (size_t i = 0; i < COUNT(wanted); i++) {
        const bool asked = // a missing G has been reported
            timoshenko
            && ((wanted[i].bit == CT_BEAM_BENDING_Y && has(w, "Iy"))
                || (wanted[i].bit == CT_BEAM_BENDING_Z && has(w, "Iz")));
        if ((unsigned)v->count & wanted[i].bit & ~known && !asked)
            ok = needs(w, wanted[i].what, wanted[i].why);
    }
    return ok;
}

// ---- elements ----------------------------------------------------------------------------------

static bool check_ends(const struct work *w, const struct ct_value *v, double length)
{
    const double roundoff = CT_DATA_ROUNDOFF * length;
    double last = 0, end;
    bool ok = true;
    for (size_t i = 0; i < v->n; i++) {
        if (!ct_read_number(w->r, v->e[i], &end))
            return true;
        if (!(end > last))
            ok = ct_error(w->r->ctx, v->at[i], CT_E_RANGE,
                          "body '%s': element %zu ends at %g m, where it begins is %g m; the "
                          "ends must increase from 0 to the length",
                          w->self->name, i + 1, end, last);
        else if (i + 1 == v->n && !(fabs(end - length) <= roundoff))
            ok = ct_error(w->r->ctx, v->at[i], CT_E_RANGE,
                          "body '%s': the last element ends at %g m, the length is %g m",
                          w->self->name, end, length);
        last = end;
    }
    return ok;
}

// Add ends of elements at the cuts that the list does not contain.
static void cut_list(const struct work *w)
{
    struct ct_beam *beam = w->beam;
    ct_ex *end = CT_NEWN(w->r->a, ct_ex, beam->nelement + beam->ncut);
    const double close = CT_SAME_PLACE * ct_model_number(w->r->m, beam->length);
    int n = 0, k = 0;
    for (int i = 0; i < beam->nelement; i++) {
        const double to = ct_model_number(w->r->m, beam->end[i]);
        for (; k < beam->ncut && beam->cut[k] < to - close; k++)
            end[n++] = ct_ex_const(w->r->m->x, beam->cut[k]);
        for (; k < beam->ncut && beam->cut[k] <= to + close; k++)
            ;
        end[n++] = beam->end[i];
    }
    beam->end = end;
    beam->nelement = n;
}

static bool fill_elements(const struct work *w)
{
    struct ct_exs *x = w->r->m->x;
    struct ct_beam *beam = w->beam;
    const struct ct_value *v = get(w, "elements");
    const double length = ct_model_number(w->r->m, beam->length);
    const bool ok = !v->is_wrong && (!v->n || check_ends(w, v, length));
    if (!v->n || !ok) {
        ct_beam_divide(x, w->r->a, beam, v->given && ok ? v->count : 1, length);
        return ok;
    }
    const int n = beam->nelement = (int)v->count;
    ct_ex *end = CT_NEWN(w->r->a, ct_ex, n);
    memcpy(end, v->e, (size_t)n * sizeof *end);
    end[n - 1] = beam->length; // exact, without round-off
    beam->end = end;
    beam->is_even = false;
    return ok;
}

// ---- section and material along the axis -------------------------------------------------------

// Sample points inside an element for checks of the section; its ends may be jumps or cusps. Limit:
// number of points; a product of four linear functions is determined by them.
enum { NSAMPLE = 5 };

static double value_at(const struct work *w, const struct ct_value *v, size_t i, double place)
{
    w->value[w->x] = place;
    return ct_ex_value(w->r->m->x, v->e[i], w->value);
}

static bool wrong_along(const struct work *w, const char *key, size_t i, double place,
                        double value, const char *wanted)
{
    const struct ct_value *v = get(w, key);
    struct ct_arena *a = w->r->ctx->scratch;
    const char *where = is_along(w, v, i) ? ct_arena_printf(a, " at x = %g m", place) : "";
    const char *what = isnan(value) ? "not a number" : ct_arena_printf(a, "%g", value);
    return ct_error(w->r->ctx, v->at[i], CT_E_RANGE, "body '%s': '%s' is %s%s; it must be %s",
                    w->self->name, key, what, where, wanted);
}

// Check that expression i of a key is finite and positive (strict) or nonnegative along the beam.
static bool check_along(const struct work *w, const char *key, size_t i, bool strict)
{
    const struct ct_value *v = get(w, key);
    const char *wanted = strict ? "greater than 0" : "at least 0";
    double point[NSAMPLE], weight[NSAMPLE];
    if (!v->given || v->is_wrong || v->n <= i)
        return true;
    const bool varies = is_along(w, v, i);
    ct_gauss(NSAMPLE, point, weight);
    double from = 0;
    for (int k = 0; k < (varies ? w->beam->nelement : 1); k++) {
        const double to = ct_model_number(w->r->m, w->beam->end[k]);
        const double ends[] = {from, to};
        for (int p = 0; p < (varies ? NSAMPLE : 1); p++) {
            const double at = from + point[p] * (to - from), value = value_at(w, v, i, at);
            if (!(value > 0 || (!strict && value == 0)))
                return wrong_along(w, key, i, at, value, wanted);
        }
        for (int p = 0; p < 2; p++)
            if (isinf(value_at(w, v, i, ends[p])))
                return wrong_along(w, key, i, ends[p], INFINITY, "finite");
        from = to;
    }
    return true;
}

// Relative error of element-wise quadrature of value i of the key, compared with a finer
// quadrature.
static double quadrature_error(const struct work *w, const struct ct_value *v, size_t i)
{
    // Derived: a jump within one of 256 parts has an error of 0.4 % of its height (1/256), so the
    // two printed digits are right.
    enum { POINTS = CT_ELEMENT_POINTS, PARTS = 256 };
    double point[POINTS], weight[POINTS], coarse = 0, fine = 0, size = 0, from = 0;
    ct_gauss(POINTS, point, weight);
    for (int k = 0; k < w->beam->nelement; k++) {
        const double to = ct_model_number(w->r->m, w->beam->end[k]), h = to - from;
        for (int p = 0; p < POINTS; p++) {
            coarse += weight[p] * h * value_at(w, v, i, from + point[p] * h);
            for (int part = 0; part < PARTS; part++) {
                const double at = from + (part + point[p]) / PARTS * h,
                             value = value_at(w, v, i, at);
                fine += weight[p] * h / PARTS * value;
                size += weight[p] * h / PARTS * fabs(value);
            }
        }
        from = to;
    }
    return size > 0 ? fabs(coarse - fine) / size : 0;
}

static int ascending(const void *context, const void *a, const void *b)
{
    (void)context;
    const double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

// Make positions where a value jumps or has a kink ends of elements.
static void cut_elements(const struct work *w)
{
    static const char *const keys[]
        = {"E",           "G",  "nu", "density",         "area",
           "Iy",          "Iz", "J",  "mass_per_length", "rotary_inertia",
           "shear_factor"};
    enum { MOST = 100 }; // Limit: jumps of one value, with a warning
    struct ct_beam *beam = w->beam;
    const double length = ct_model_number(w->r->m, beam->length);
    double place[MOST], *cut = NULL;
    size_t ncut = 0, cap = 0;
    for (size_t k = 0; k < COUNT(keys); k++) {
        const struct ct_value *v = get(w, keys[k]);
        for (size_t i = 0; v->given && !v->is_wrong && i < v->n; i++) {
            if (!is_along(w, v, i))
                continue;
            const int n = ct_ex_switches(w->r->m->x, w->r->ctx->scratch, v->e[i], beam->x, 0,
                                         length, w->value, place, MOST);
            if (n < 0)
                ct_warning(w->r->ctx, v->at[i], 0,
                           "body '%s': where '%s' switches along the beam cannot be told, so "
                           "elements do not end there; its integral over the elements is off "
                           "by %.2g %%",
                           w->self->name, keys[k], 100 * quadrature_error(w, v, i));
            for (int p = 0; p < n; p++)
                CT_PUSH(w->r->a, cut, ncut, cap, place[p]);
        }
    }
    ct_sort(w->r->ctx->scratch, cut, ncut, sizeof *cut, ascending, NULL);
    size_t kept = 0;
    for (size_t i = 0; i < ncut; i++)
        if (!kept || cut[i] - cut[kept - 1] > CT_SAME_PLACE * length)
            cut[kept++] = cut[i];
    beam->cut = cut;
    beam->ncut = (int)kept;
    if (!kept)
        return;
    const int before = beam->nelement;
    if (get(w, "elements")->n)
        cut_list(w);
    else
        ct_beam_divide(w->r->m->x, w->r->a, beam, beam->nelement, length);
    beam->is_cut = beam->nelement > before;
}

// Does the value of the key vanish on a whole element?
static bool vanishes(const struct work *w, const char *key)
{
    const struct ct_value *v = get(w, key);
    double point[NSAMPLE], weight[NSAMPLE];
    if (!v->given || v->is_wrong)
        return false;
    ct_gauss(NSAMPLE, point, weight);
    double from = 0;
    for (int k = 0; k < (is_along(w, v, 0) ? w->beam->nelement : 1); k++) {
        const double to = ct_model_number(w->r->m, w->beam->end[k]);
        int nzero = 0;
        for (int p = 0; p < NSAMPLE; p++)
            nzero += value_at(w, v, 0, from + point[p] * (to - from)) == 0;
        if (nzero == NSAMPLE)
            return true;
        from = to;
    }
    return false;
}

// Deformations with stiffness; a value of 0 means not given.
static unsigned find_stiff(const struct work *w)
{
    return w->beam->known
         & ~((vanishes(w, "Iy") ? CT_BEAM_BENDING_Y : 0u)
             | (vanishes(w, "Iz") ? CT_BEAM_BENDING_Z : 0u)
             | (vanishes(w, "J") ? CT_BEAM_TORSION : 0u));
}

static bool check_nu_along(const struct work *w)
{
    const struct ct_value *v = get(w, "nu");
    double point[NSAMPLE], weight[NSAMPLE], from = 0;
    if (!v->given || v->is_wrong || !is_along(w, v, 0))
        return true;
    ct_gauss(NSAMPLE, point, weight);
    for (int k = 0; k < w->beam->nelement; k++) {
        const double to = ct_model_number(w->r->m, w->beam->end[k]);
        for (int p = 0; p < NSAMPLE; p++) {
            const double at = from + point[p] * (to - from), nu = value_at(w, v, 0, at);
            if (!(nu > -1 && nu <= 0.5))
                return wrong_along(w, "nu", 0, at, nu, "between -1 and 0.5");
        }
        from = to;
    }
    return true;
}

// Check material values that vary; constants have been checked.
static bool check_material(const struct work *w)
{
    static const char *const keys[] = {"E", "G", "shear_factor", "density"};
    bool ok = check_nu_along(w);
    for (size_t k = 0; k < COUNT(keys); k++)
        for (size_t i = 0; i < get(w, keys[k])->n; i++)
            if (is_along(w, get(w, keys[k]), i))
                ok &= check_along(w, keys[k], i, k < 3);
    return ok;
}

static bool check_section(const struct work *w)
{
    bool ok = check_material(w);
    ok &= check_along(w, "area", 0, true);
    ok &= check_along(w, "Iy", 0, false);
    ok &= check_along(w, "Iz", 0, false);
    ok &= check_along(w, "J", 0, false);
    ok &= check_along(w, "mass_per_length", 0, false);
    for (size_t i = 0; i < 3; i++)
        ok &= check_along(w, "rotary_inertia", i, false);
    return ok;
}

// Mass of the beam: exact if the mass per length is a polynomial; else by quadrature per element,
// as jumps are at ends of elements.
static ct_ex integrate_mass(const struct work *w)
{
    struct ct_exs *x = w->r->m->x;
    const struct ct_beam *beam = w->beam;
    const ct_ex m = beam->mass_per_length;
    const int degree = ct_ex_degree(x, m, beam->x);
    if (degree == 0)
        return ct_ex_mul(x, m, beam->length);
    if (degree > 0 && degree < 2 * CT_GAUSS_MOST)
        return ct_ex_integral(x, m, beam->x, CT_EX_ZERO, beam->length, degree / 2 + 1);
    ct_ex sum = CT_EX_ZERO, from = CT_EX_ZERO;
    for (int i = 0; i < beam->nelement; i++) {
        sum = ct_ex_add(x, sum,
                        ct_ex_integral(x, m, beam->x, from, beam->end[i], CT_ELEMENT_POINTS));
        from = beam->end[i];
    }
    return sum;
}

// ---- filling -----------------------------------------------------------------------------------

static void fill_material(const struct work *w)
{
    struct ct_exs *x = w->r->m->x;
    struct ct_beam *beam = w->beam;
    const bool has_area = has(w, "area");
    beam->E = scalar(w, "E");
    beam->G = scalar(w, "G");
    if (has(w, "nu")) // E/(2 (1 + nu))
        beam->G = ct_ex_div(x, beam->E,
                            ct_ex_scale(x, 2, ct_ex_add(x, CT_EX_ONE, scalar(w, "nu"))));
    beam->area = scalar(w, "area");
    beam->Iy = scalar(w, "Iy");
    beam->Iz = scalar(w, "Iz");
    const ct_ex polar = ct_ex_add(x, beam->Iy, beam->Iz);
    beam->J = has(w, "J") ? scalar(w, "J") : polar;
    ct_ex density = scalar(w, "density");
    beam->mass_per_length
        = has(w, "density") ? ct_ex_mul(x, density, beam->area) : scalar(w, "mass_per_length");
    if (!has(w, "density") && has_area)
        density = ct_ex_div(x, beam->mass_per_length, beam->area);

    const struct ct_value *rotary = get(w, "rotary_inertia");
    const ct_ex of_section[] = {polar, beam->Iy, beam->Iz};
    beam->misses_rotary = rotary->count == 1 && beam->is_lumped;
    beam->has_rotary = rotary->count == 3 || (rotary->count == 1 && !beam->is_lumped);
    for (int i = 0; i < 3; i++)
        beam->rotary[i] = !beam->has_rotary  ? CT_EX_ZERO
                        : rotary->count == 3 ? rotary->e[i]
                                             : ct_ex_mul(x, density, of_section[i]);
    beam->twist_inertia = beam->is_lumped ? CT_EX_ZERO : ct_ex_mul(x, density, polar);
}

static void fill_choices(const struct work *w)
{
    struct ct_beam *beam = w->beam;
    beam->theory = (enum ct_beam_theory)get(w, "theory")->count;
    beam->integration = (enum ct_beam_integration)get(w, "integration")->count;
    beam->formulation = (enum ct_beam_formulation)get(w, "formulation")->count;
    beam->formulation_mark = get(w, "formulation")->mark;
    beam->is_lumped = get(w, "mass")->count == 1;
    beam->higher_order = get(w, "geometric_stiffness")->count == 1;
    beam->lacks_quadratic = get(w, "quadratic_velocity")->count == 1;
    beam->is_chord = get(w, "frame")->count == 1;
    beam->has_quadratic_twist = get(w, "twist")->count == 1;
    beam->has_quadratic_stretch = get(w, "stretch")->count == 1;
    beam->starts_in_equilibrium = get(w, "initial")->count == 1;
    const struct ct_value *deformation = get(w, "deformation");
    beam->deformation_given = deformation->given;
    beam->deformation = deformation->given ? (unsigned)deformation->count : CT_BEAM_ALL;
    beam->modes = (int)get(w, "modes")->count;
    beam->modes_mark = get(w, "modes")->mark;
    const struct ct_value *shear = get(w, "shear_factor");
    for (size_t i = 0; i < 2 && shear->given; i++)
        beam->shear_factor[i] = shear->e[i < shear->n ? i : 0];
    const struct ct_value *damping = get(w, "damping");
    beam->damping_mass = damping->given ? damping->e[0] : CT_EX_ZERO;
    beam->damping_stiffness = damping->given ? damping->e[1] : CT_EX_ZERO;
}

// Fill the beam even if some values are wrong, to find further errors.
static bool fill(struct work *w, struct ct_body *b, bool values_ok)
{
    struct ct_exs *x = w->r->m->x;
    struct ct_beam *beam = w->beam;
    bool ok = check_scalars(w);
    beam->known = find_known(w);
    ok &= check_mass_keys(w);
    ok &= check_theory(w);
    ok &= check_quadratic(w, "twist");
    ok &= check_quadratic(w, "stretch");
    ok &= check_quadratic_velocity(w);
    ok &= check_deformation(w, beam->known);
    double length;
    beam->length = scalar(w, "length");
    if (!ct_read_number(w->r, beam->length, &length) || !(length > 0))
        return false;
    ok &= fill_elements(w);
    w->x = ct_ex_node(x, beam->x)->a;
    w->value = CT_NEWN(w->r->ctx->scratch, double, x->nsym);
    if (w->r->parameters_ok) {
        memcpy(w->value, w->r->m->value, (1 + w->r->m->nparameter) * sizeof *w->value);
        if (ok && values_ok)
            cut_elements(w);
        ok &= check_section(w);
        beam->known = find_stiff(w);
        ok = ok && check_deformation(w, beam->known);
    }
    if (!ok || !values_ok)
        return false;
    fill_choices(w);
    fill_material(w);
    if (!ct_fill_fields(w->r, w->self, beam))
        return false;
    b->mass = integrate_mass(w);
    b->beam = beam;
    return true;
}

bool ct_read_beam(struct ct_reader *r, struct ct_body *b, const struct ct_node *node)
{
    struct ct_instance *self = &b->instance;
    struct ct_beam *beam = CT_NEW(r->a, struct ct_beam);
    struct work w = {.r = r, .self = self, .beam = beam};
    const size_t nknown = r->nknown;
    r->beam_x = beam->x = ct_ex_sym(r->m->x, CT_SYM_LOCAL, "x", 0);
    r->beam = self;
    CT_PUSH(r->a, r->known, r->nknown, r->known_cap, "length");
    CT_PUSH(r->a, r->known, r->nknown, r->known_cap, "x");
    const bool keys = ct_read_component_keys(r, self, node, "body", false);
    const bool values = ct_read_own_values(r, self, node);
    const bool points = ct_read_points(r, b, node);
    r->nknown = nknown;
    r->beam = NULL;
    return fill(&w, b, values) && keys && points;
}
