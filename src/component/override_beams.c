// Overrides of the discretisation and formulation of beams from options.
#include "base/names.h"
#include "component/model.h"

#include <string.h>

static const char *const formulations[] = {"auto", "linear", "foreshortening", "force-only",
                                           "stretch-linear"}; // indexed by ct_beam_formulation

bool ct_model_change_beams(struct ct_ctx *ctx, struct ct_model *m, long elements,
                           const char *formulation)
{
    size_t which = 0;
    while (formulation && which < COUNT(formulations)
           && strcmp(formulations[which], formulation) != 0)
        which++;
    if (which == COUNT(formulations))
        return ct_error(
            ctx, (struct ct_mark){0}, CT_E_USAGE,
            "there is no formulation '%s' of beams; there are %s, %s, %s, %s and %s",
            formulation, formulations[0], formulations[1], formulations[2], formulations[3],
            formulations[4]);
    size_t nbeam = 0;
    for (size_t i = 1; i < m->nbody; i++) {
        if (!m->body[i].beam)
            continue;
        nbeam++;
        struct ct_beam *beam = CT_NEW(ctx->model, struct ct_beam);
        *beam = *m->body[i].beam;
        if (formulation)
            beam->formulation = (enum ct_beam_formulation)which;
        if (elements > 0)
            ct_beam_divide(m->x, ctx->model, beam, elements, ct_model_number(m, beam->length));
        m->body[i].beam = beam;
    }
    if (!nbeam && (elements > 0 || formulation))
        return ct_error(ctx, (struct ct_mark){0}, CT_E_USAGE,
                        "the model has no beams that could have other %s",
                        elements > 0 ? "elements" : "formulations");
    return true;
}
