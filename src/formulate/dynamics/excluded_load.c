// Warns of excluded loads: a transverse force in a direction for which `deformation` excludes
// bending.
#include "formulate/dynamics/dynamics.h"
#include "formulate/beam/flexible_body.h"
#include "formulate/kinematics/kinematics.h"

#include <math.h>

// The value of an expression of parameters. The value is not recorded as a decision, because a
// warning changes no equation.
static double number(struct ct_exs *x, ct_ex e, const double *value)
{
    const size_t ndecided = x->ndecided;
    x->ndecided = 0;
    const double v = ct_ex_value(x, e, value);
    x->ndecided = ndecided;
    return v;
}

// Component of a force along axis i of the base of the beam, divided by its magnitude; 0 if either
// depends on more than parameters.
static double constant_part(struct ct_build *b, const struct ct_flexible *f, ct_ex3 force,
                            int i)
{
    const ct_ex3 own = ct_node_unturn(b, f->base, force);
    double square = 0, part = 0;
    for (int k = 0; k < 3; k++) {
        if (ct_ex_kinds(b->x, own.e[k]) & ~(1u << CT_SYM_PARAM)) {
            if (k == i)
                return 0;
            continue;
        }
        const double v = number(b->x, own.e[k], b->value);
        square += v * v;
        part = k == i ? v : part;
    }
    return square > 0 ? fabs(part) / sqrt(square) : 0;
}

static void warn_of_load(struct ct_ctx *ctx, struct ct_build *b, const struct ct_load *load,
                         const struct ct_flexible *f)
{
    static const struct {
        unsigned family;
        const char *axis, *name;
    } bending[]
        = {{CT_BEAM_BENDING_Z, "y", "bending-z"}, {CT_BEAM_BENDING_Y, "z", "bending-y"}};
    for (int i = 0; i < 2; i++)
        if (!(f->beam->deformation & bending[i].family)
            && constant_part(b, f, load->force, 1 + i) > CT_DATA_ROUNDOFF)
            ct_warning(ctx, load->self->mark, 0,
                       "force '%s' pushes beam '%s' along its %s axis, in which 'deformation' "
                       "does not let "
                       "it bend: there it acts as on a rigid body; add '%s' to 'deformation', "
                       "or leave "
                       "that key out",
                       load->self->name, f->name, bending[i].axis, bending[i].name);
}

void ct_warn_of_excluded_loads(struct ct_ctx *ctx, struct ct_build *b)
{
    for (size_t i = 0; i < b->loads->nload; i++) {
        const struct ct_load *load = &b->loads->load[i];
        const struct ct_flexible *f = ct_flexible_of(b, b->topology->node[load->head].body);
        if (f && f->beam->deformation_given && load->self->cls->family == CT_FAMILY_FORCE)
            warn_of_load(ctx, b, load, f);
    }
}
