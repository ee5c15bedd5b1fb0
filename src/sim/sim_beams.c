// Warnings of a run about its beams.
#include "sim/sim.h"
#include "beam_error/beam_error_modal.h"
#include "formulate/beam/flexible_body.h"

#include <math.h>

void ct_slope_warn(struct ct_ctx *ctx, const struct ct_equations *e,
                   const struct ct_slope_report *report)
{
    for (size_t i = 0; i < e->nbent_beam; i++) {
        if (report[i].passed_at < 0)
            continue;
        const char *since
            = report[i].passed_at > 0
                ? ct_arena_printf(ctx->scratch, ", more than %g from t = %.6g s on",
                                  CT_SLOPE_LIMIT, report[i].passed_at)
                : "";
        ct_warning(ctx, e->bent_beam[i].mark, 0,
                   "sections of beam '%s' turn by up to %.3g rad against its frame%s: one "
                   "frame is good for %g; cut the beam into several that are welded end to end",
                   e->bent_beam[i].beam, report[i].largest, since, CT_SLOPE_LIMIT);
    }
}

static void warn_of_starts(struct ct_sim *sim, const struct ct_build *b)
{
    // Derived: as CT_VALIDITY_LIMIT, for a deformation at the start that the shape functions
    // cannot represent.
    const double notable = 0.01; // relative limit, as that of the validity indicator
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        if (f->start_residual > notable)
            ct_warning(&sim->own, f->beam->start[0].mark, 0,
                       "beam '%s' starts with what its shapes have of this; they leave out "
                       "%.3g %%",
                       f->name, 100 * f->start_residual);
    }
}

// Warns of a linear beam by its validity indicator and the error estimated from it.
static void warn_of_linear(struct ct_sim *sim, const struct ct_validity *beam,
                           const struct ct_validity_report *v)
{
    struct ct_arena *a = sim->own.scratch;
    const double error = ct_beam_error_modal_error(&v->modal, CT_BEAM_MODEL_LINEAR),
                 other = ct_beam_error_modal_error(&v->modal, CT_BEAM_MODEL_FORESHORTENED);
    const char *size
        = isnan(error) && v->modal.n
            ? "its error is not estimated: it bends in more shapes than are followed"
        : isnan(error) ? "its error is not estimated: joints, loads or loops act on it besides "
                         "its base, or jumps and events of the state drive its base"
        : error > CT_ESTIMATED_ERROR_LIMIT
            ? "its error is beyond 1, as large as the deflections or larger"
            : ct_arena_printf(a, "its error is about %.2g of the largest deflection", error);
    const char *how
        = v->left_at >= 0
            ? ct_arena_printf(a,
                              "the validity indicator passes %.3g at t = %.6g s, "
                              "its mean over a period of the "
                              "beam reaches %.3g",
                              CT_VALIDITY_LIMIT, v->left_at, v->largest)
            : ct_arena_printf(a,
                              "the validity indicator reaches %.3g only, but from t = %.6g s "
                              "on the error that it causes has grown beyond %.3g",
                              v->largest, v->error_beyond_since, CT_VALIDITY_LIMIT);
    const char *cure
        = 3 * other > error
            ? "it bends too far for one frame: cut it into several foreshortened ones that are "
              "welded end to end"
            : "`formulation: foreshortening` has none of this";
    ct_warning(&sim->own, beam->mark, 0, "beam '%s' is linear and left its range: %s; %s; %s",
               beam->beam, how, size, cure);
}

void ct_sim_warn_of_beams(struct ct_sim *sim)
{
    const struct ct_equations *e = &sim->system->equations;
    warn_of_starts(sim, e->build);
    ct_slope_warn(&sim->own, e, sim->report.slopes);
    for (size_t i = 0; i < e->nvalidity; i++) {
        const struct ct_validity_report *v = &sim->report.validity[i];
        if (v->left_at >= 0 || v->error_beyond_since >= 0)
            warn_of_linear(sim, &e->validity[i], v);
    }
}
