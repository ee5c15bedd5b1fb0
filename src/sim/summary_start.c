// Initial values of the joints' coordinates, requested and found; see summary.h.
#include "sim/summary.h"
#include "base/pi.h"

#include "formulate/build.h"

#include <math.h>

enum asked { NOTHING, GUESS, DEMAND, MOTION };

static enum asked asked_of(const struct ct_coordinate *c, const struct ct_target *t)
{
    return c->is_driven ? MOTION : t->is_given ? DEMAND : t->is_guessed ? GUESS : NOTHING;
}

static bool is_of_joint(const struct ct_initial_state *s, size_t i)
{
    const struct ct_coordinate *c = &s->e->coordinate[i];
    return s->e->build->topology->edge[c->edge].kind == CT_EDGE_JOINT
        && (c->in_translation || c->in_rotation);
}

size_t ct_sim_start_count(const struct ct_sim *sim)
{
    return sim->start.e ? sim->start.n : 0;
}

const char *ct_sim_start_text(const struct ct_sim *sim, size_t i, char *out, size_t size)
{
    const struct ct_initial_state *s = &sim->start;
    const struct ct_coordinate *c = &s->e->coordinate[i];
    const double q = ct_start_shown(s->q[i]);
    if (!is_of_joint(s, i))
        return NULL;
    switch (asked_of(c, &s->q_target[i])) {
    case NOTHING:
        snprintf(out, size, "%s free -> %.6g", c->name, q);
        break;
    case GUESS:
        snprintf(out, size, "%s %.6g -> %.6g", c->name, s->q_target[i].value, q);
        break;
    default:
        snprintf(out, size, "%s = %.6g", c->name, q);
    }
    return out;
}

void ct_sim_write_start(struct ct_json *j, const struct ct_sim *sim)
{
    static const char *const word[] = {"nothing", "guess", "demand", "motion"};
    const struct ct_initial_state *s = &sim->start;
    ct_json_array(j, "start");
    for (size_t i = 0; i < ct_sim_start_count(sim); i++) {
        const struct ct_coordinate *c = &s->e->coordinate[i];
        if (!is_of_joint(s, i))
            continue;
        for (int k = 0; k < 2; k++) {
            const struct ct_target *t = k ? &s->u_target[i] : &s->q_target[i];
            const enum asked asked = asked_of(c, t);
            if (k == 0) {
                ct_json_object(j, NULL);
                ct_json_text(j, "name", c->name);
            }
            ct_json_text(j, k ? "speed_asked" : "asked", word[asked]);
            ct_json_number(j, k ? "speed_wanted" : "wanted",
                           asked == GUESS || asked == DEMAND ? t->value : NAN);
            ct_json_number(j, k ? "speed" : "value", k ? s->u[i] : s->q[i]);
        }
        ct_json_end(j);
    }
    ct_json_end(j);
}

// Distance of coordinate i from its guess; 1 is a right angle or half the natural length. 0
// without a guess. An orientation has its distance at its first number.
static double moved(const struct ct_initial_state *s, size_t i)
{
    const struct ct_target *t = &s->q_target[i];
    if (!t->is_guessed)
        return 0;
    if (!t->in_quaternion)
        return fabs(s->q[i] - t->value) * t->weight
             / (ct_start_is_length(s, i) ? 0.5 : CT_PI / 2);
    const struct ct_coordinate *c = &s->e->coordinate[i];
    if (c->index != s->e->build->topology->edge[c->edge].trial->quaternion)
        return 0;
    double cosine = 0;
    for (size_t k = 0; k < 4; k++)
        cosine += t[k].value * s->q[i + k];
    return 2 * acos(fmin(1, fabs(cosine))) / (CT_PI / 2);
}

void ct_sim_warn_of_start(struct ct_sim *sim)
{
    // Layout: of messages
    enum { MOST_WARNINGS = 4 };
    const struct ct_initial_state *s = &sim->start;
    size_t n = 0, shown = 0;
    for (size_t i = 0; i < ct_sim_start_count(sim); i++)
        n += is_of_joint(s, i) && moved(s, i) > 1;
    for (size_t i = 0; i < s->n && shown < MOST_WARNINGS && n; i++) {
        if (!is_of_joint(s, i) || !(moved(s, i) > 1))
            continue;
        const struct ct_coordinate *c = &s->e->coordinate[i];
        const struct ct_instance *joint = s->e->build->topology->edge[c->edge].self;
        const bool is_last = ++shown == MOST_WARNINGS && n > MOST_WARNINGS;
        const char *more
            = is_last ? ct_arena_printf(sim->own.model, "; so do %zu more", n - MOST_WARNINGS)
                      : "";
        const struct ct_target *t = &s->q_target[i];
        if (t->in_quaternion)
            ct_warning(&sim->own, joint->mark, 0,
                       "the orientation of '%s' starts %.0f degrees from its guess%s",
                       joint->name, moved(s, i) * 90, more);
        else
            ct_warning(&sim->own, joint->initial.q.mark, 0,
                       "'%s' starts at %.6g, more than %s from its guess of %.6g%s", c->name,
                       ct_start_shown(s->q[i]),
                       ct_start_is_length(s, i) ? ct_arena_printf(
                           sim->own.model, "half the natural length of the mechanism (%.6g m)",
                           s->length)
                                                : "a right angle",
                       t->value, more);
    }
}
