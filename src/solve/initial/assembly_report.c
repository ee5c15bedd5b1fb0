// Error messages of an assembly that failed; see assembly_internal.h.
#include "solve/initial/assembly_internal.h"

#include <math.h>

// Error of a demanded value or speed; 0 where none is demanded.
static double demand_error(const struct ct_assembler *s, size_t i, bool is_speed)
{
    double r = 0;
    if (is_speed && s->u[i].is_given)
        r = s->m->result.out[2 * i + 1] - s->u[i].value;
    else if (!is_speed && s->q[i].is_given && !ct_assembler_deviation(s, i, &r))
        r = 0;
    return isnan(r) ? INFINITY : fabs(r);
}

static struct ct_mark initial_mark(const struct ct_assembler *s, size_t i, bool is_speed)
{
    const struct ct_edge_info *e = &s->e->build->topology->edge[s->e->coordinate[i].edge];
    const struct ct_value *turns = &e->self->initial.rotate;
    const bool is_turn = !is_speed && s->q[i].in_quaternion && turns->given;
    return is_turn ? turns->mark : ct_initial_value(e, is_speed)->mark;
}

// Report the demanded value with the largest error, and the others as notes; true if there is
// none.
static bool report_demand_errors(struct ct_assembler *s, bool is_speed)
{
    enum { MOST_NOTES = 4 }; // Limit: of notes; the last one counts the others
    size_t worst = 0, nmissed = 0;
    // of equal errors the first; differences by round-off do not count
    for (size_t i = 1; i < s->e->ncoordinate; i++)
        if (demand_error(s, i, is_speed)
            > (1 + ct_rank_tolerance) * demand_error(s, worst, is_speed))
            worst = i;
    const double most = s->e->ncoordinate ? demand_error(s, worst, is_speed) : 0;
    if (!(most > ct_rank_tolerance))
        return true;
    const struct ct_coordinate *c = s->e->coordinate;
    ct_error(s->ctx, initial_mark(s, worst, is_speed), CT_E_START,
             "initial %s contradict each other: %s'%s' of joint '%s' is missed by %.3g "
             "(demanded %.6g, found %.6g); mark what need not hold with 'guess: true'",
             is_speed ? "speeds" : "values", is_speed ? "the rate of " : "", c[worst].name,
             s->e->build->topology->edge[c[worst].edge].self->name, most,
             is_speed ? s->u[worst].value : s->q[worst].value,
             ct_start_shown(s->m->result.out[2 * worst + is_speed]));
    for (size_t i = 0; i < s->e->ncoordinate; i++)
        nmissed += i != worst && demand_error(s, i, is_speed) > ct_rank_tolerance;
    for (size_t i = 0, n = 0; i < s->e->ncoordinate && n < MOST_NOTES; i++) {
        if (i == worst || !(demand_error(s, i, is_speed) > ct_rank_tolerance))
            continue;
        const bool is_last = ++n == MOST_NOTES && nmissed > MOST_NOTES;
        ct_note(s->ctx, initial_mark(s, i, is_speed), "and %s'%s' of joint '%s', by %.3g%s",
                is_speed ? "the rate of " : "", c[i].name,
                s->e->build->topology->edge[c[i].edge].self->name, demand_error(s, i, is_speed),
                is_last
                    ? ct_arena_printf(s->e->build->arena, "; %zu more", nmissed - MOST_NOTES)
                    : "");
    }
    return false;
}

// The constraint row with the largest residual among those that count.
static size_t worst_row(const struct ct_assembler *s, const double *residual,
                        const bool *counts)
{
    size_t worst = 0;
    for (size_t i = 1; i < s->m->nrow; i++)
        if ((!counts || counts[i])
            && (fabs(residual[i]) > fabs(residual[worst]) || (counts && !counts[worst])))
            worst = i;
    return worst;
}

static struct ct_mark row_mark(const struct ct_assembler *s, size_t row)
{
    const int joint = s->e->row[row].joint;
    const struct ct_model *model = s->e->build->model;
    if (joint < 0)
        return (struct ct_mark){.file = model->file};
    return model->joint[joint].mark;
}

bool ct_assembler_report_positions(struct ct_assembler *s, bool closes)
{
    if (closes && !report_demand_errors(s, false))
        return false;
    bool any_given = false;
    for (size_t i = 0; i < s->e->ncoordinate; i++)
        any_given |= s->q[i].is_given;
    const size_t row = worst_row(s, s->m->phi, s->fixed_row);
    return ct_error(
        s->ctx, row_mark(s, row), CT_E_ASSEMBLY,
        "the mechanism cannot be assembled: '%s' stays open by %.3g; check lengths and "
        "places%s%s",
        s->e->row[row].name, fabs(s->m->phi[row]),
        closes      ? ", the given initial values"
        : any_given ? " (with the given initial values as guesses, too)"
                    : " and give guesses in `initial`",
        s->e->build->nflexible
            ? "; beams bend to close loops where they have `initial: equilibrium`"
            : "");
}

bool ct_assembler_report_speeds(struct ct_assembler *s)
{
    if (!report_demand_errors(s, true))
        return false;
    const size_t row = worst_row(s, s->m->v, NULL);
    const int joint = s->e->row[row].joint;
    return ct_error(
        s->ctx, row_mark(s, row), CT_E_START,
        "the drivers ask for speeds that the mechanism cannot have: '%s'%s%s%s is missed "
        "by %.3g; check the rates of the motions",
        s->e->row[row].name, joint < 0 ? "" : " of joint '",
        joint < 0 ? "" : s->e->build->model->joint[joint].name, joint < 0 ? "" : "'",
        fabs(s->m->v[row]));
}

bool ct_assembler_check_drivers(struct ct_assembler *s)
{
    const struct ct_build *b = s->e->build;
    bool ok = true;
    for (size_t i = 0; i < s->e->ncoordinate; i++) {
        const struct ct_coordinate *c = &s->e->coordinate[i];
        const struct ct_edge_info *e = &b->topology->edge[c->edge];
        if (!c->is_driven || e->self->initial.guess)
            continue;
        for (int k = 0; k < 2; k++) {
            const struct ct_value *v = ct_initial_value(e, k);
            double given;
            if (!ct_initial_number(b->model, v, c->index, &given))
                continue;
            const double real = s->m->result.out[2 * i + (size_t)k];
            if (fabs(given - real) > ct_rank_tolerance * fmax(1, fabs(real)))
                ok = ct_error(
                    s->ctx, v->mark, CT_E_START,
                    "joint '%s' starts on its motion with %s = %.17g, but initial says %.17g",
                    e->self->name, k ? "u" : "q", real, given);
        }
    }
    return ok;
}
