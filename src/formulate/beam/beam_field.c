// See beam_field.h.
#include "formulate/beam/beam_field.h"
#include "formulate/beam/modal_reduction.h"
#include "formulate/beam/degrees_of_freedom.h"

enum { NKIND = CT_NODE_FREEDOM };

// ---- fields at nodes ----------------------------------------------------------------------------

static ct_ex value_at(struct ct_build *b, const struct ct_flexible *f, ct_ex g, ct_ex place)
{
    return ct_ex_subst(b->x, g, &f->beam->x, &place, 1);
}

static ct_ex position_of(const struct ct_flexible *f, int node)
{
    return node ? f->beam->end[node - 1] : CT_EX_ZERO;
}

// Value of g in the middle of the element before the node, minus the mean of the values at its ends.
static ct_ex mid_element_excess(struct ct_build *b, const struct ct_flexible *f, ct_ex g,
                                int node)
{
    struct ct_exs *x = b->x;
    const ct_ex from = position_of(f, node - 1), to = position_of(f, node);
    const ct_ex ends = ct_ex_add(x, value_at(b, f, g, from), value_at(b, f, g, to));
    const ct_ex middle = value_at(b, f, g, ct_ex_scale(x, 0.5, ct_ex_add(x, from, to)));
    return ct_ex_sub(x, middle, ct_ex_scale(x, 0.5, ends));
}

ct_ex ct_field_freedom(struct ct_build *b, const struct ct_flexible *f, enum ct_beam_field kind,
                       ct_ex g, int node, int freedom)
{
    static const int slope[CT_BEAM_NFIELD] = {-1, CT_FREEDOM_RZ, CT_FREEDOM_RY, -1},
                     middle[CT_BEAM_NFIELD] = {CT_FREEDOM_UM, -1, -1, CT_FREEDOM_RM};
    if (freedom == (int)kind)
        return value_at(b, f, g, position_of(f, node));
    if (freedom == middle[kind] && node > 0)
        return mid_element_excess(b, f, g, node);
    if (freedom != slope[kind])
        return CT_EX_ZERO;
    const ct_ex v = value_at(b, f, ct_ex_diff(b->x, g, f->beam->x), position_of(f, node));
    return kind == CT_BEAM_FIELD_W ? ct_ex_neg(b->x, v) : v; // dw/dx = -ry
}

unsigned ct_fields_family(const struct ct_beam *beam)
{
    unsigned all = 0;
    for (int i = 0; i < beam->nshape; i++)
        all |= ct_freedom_family((int)beam->shape[i].kind);
    return all;
}

// ---- the start ----------------------------------------------------------------------------------

bool ct_fields_leave_plane(const struct ct_beam *beam, bool about_z)
{
    for (int i = 0; i < beam->nstart; i++) {
        const enum ct_beam_field kind = beam->start[i].kind;
        if (kind == CT_BEAM_FIELD_RX || kind == (about_z ? CT_BEAM_FIELD_W : CT_BEAM_FIELD_V))
            return true;
    }
    return false;
}

// In LOCAL coordinates the axial freedoms are positions, U = s - S, with the stretch s and the
// foreshortening S by bending: subtracts S from the given s, and S' from its rate.
static void subtract_foreshortening(struct ct_build *b, const struct ct_flexible *f,
                                    ct_ex *value, ct_ex *rate)
{
    struct ct_exs *x = b->x;
    ct_ex S = CT_EX_ZERO, dS = CT_EX_ZERO;
    for (int e = 0; e < f->beam->nelement; e++) {
        const struct ct_element *self = &f->element[e];
        for (int plane = 0; plane < 2; plane++)
            for (int j = 0; j < 4; j++)
                for (int k = 0; k < 4; k++) {
                    const int p = self->freedom[(plane ? 6 : 2) + j],
                              q = self->freedom[(plane ? 6 : 2) + k];
                    if (p < 0 || q < 0)
                        continue;
                    const bool opposed = plane && j % 2 != k % 2; // dw/dx = -ry
                    const ct_ex E = ct_ex_scale(
                        x, opposed ? -1 : 1,
                        ct_shape_at(x, &f->shortening[j][k], CT_EX_ONE, self->span.length));
                    const ct_ex Ea = ct_ex_mul(x, E, value[q]);
                    S = ct_ex_add(x, S, ct_ex_scale(x, 0.5, ct_ex_mul(x, Ea, value[p])));
                    dS = ct_ex_add(x, dS, ct_ex_mul(x, Ea, rate[p]));
                }
        const int u = NKIND * (e + 1) + CT_FREEDOM_U;
        value[u] = ct_ex_sub(x, value[u], S);
        rate[u] = ct_ex_sub(x, rate[u], dS);
    }
}

static bool has_deformation(struct ct_build *b, const struct ct_flexible *f,
                            const struct ct_beam_given *g)
{
    static const char *const what[CT_BEAM_NFIELD]
        = {"stretch", "bend in its x-y plane", "bend in its x-z plane", "twist"};
    if (f->deformation & ct_freedom_family((int)g->kind))
        return true;
    ct_error(b->ctx, g->mark, CT_E_INITIAL,
             "beam '%s' does not %s here, so it cannot start like this", f->name,
             what[g->kind]);
    return false;
}

void ct_fields_start(struct ct_build *b, struct ct_flexible *f)
{
    const struct ct_beam *beam = f->beam;
    const int nfreedom = NKIND * (beam->nelement + 1);
    if (!beam->nstart || b->options->is_rigid)
        return;
    ct_ex *of[2], *fitted = CT_NEWN(b->ctx->scratch, ct_ex, f->nelastic + 1);
    for (int k = 0; k < 2; k++)
        of[k] = CT_NEWN(b->ctx->scratch, ct_ex, nfreedom);
    for (int k = 0; k < beam->nstart; k++) {
        const struct ct_beam_given *g = &beam->start[k];
        if (!has_deformation(b, f, g))
            return;
        for (int i = 0; i < nfreedom; i++) {
            ct_ex *v = &of[g->is_rate][i];
            *v = ct_ex_add(b->x, *v,
                           ct_field_freedom(b, f, g->kind, g->value, i / NKIND, i % NKIND));
        }
    }
    if (f->axial == CT_AXIAL_LOCAL)
        subtract_foreshortening(b, f, of[0], of[1]);
    for (int k = 0; k < 2; k++) {
        const bool shares = f->nelastic && (beam->modes || beam->nshape)
                         && f->elastic[f->nelastic - 1].freedom < 0;
        if (shares && !ct_flexible_fit(b, f, of[k], fitted)) {
            ct_error(b->ctx, beam->start[0].mark, CT_E_INITIAL,
                     "beam '%s' has shapes that depend on each other, or move no mass: they "
                     "cannot be fitted to its start",
                     f->name);
            return;
        }
        for (int i = 0; i < f->nelastic; i++) {
            struct ct_elastic *e = &f->elastic[i];
            *(k ? &e->start_rate : &e->start) = shares ? fitted[i] : of[k][e->freedom];
        }
    }
}
