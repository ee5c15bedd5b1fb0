// See dynamic_signal.h.
#include "formulate/outputs/dynamic_signal.h"
#include "beam_error/validity.h"
#include "formulate/dynamics/dynamics.h"
#include "formulate/dynamics/reaction.h"
#include "formulate/outputs/beam_load.h"

#include <string.h>

static bool reaction(struct ct_build *b, const struct ct_signal *s, ct_ex *out)
{
    const bool is_force = !strcmp(s->property, "force");
    const int tail = b->topology->wiring[b->topology->edge_of_joint[s->number]].tail,
              i = ct_signal_component_index(s);
    ct_ex3 force, torque;
    ct_reaction_derive(b, s->number, &force, &torque);
    b->signals.is_open
        = b->signals.is_open || (i >= 0 && !ct_reaction_is_known(b, s->number, is_force, i));
    const ct_ex3 v = is_force ? force : torque;
    return ct_signal_component(b, s, s->axes ? v : ct_node_unturn(b, tail, v), out);
}

static bool beam_load(struct ct_build *b, const struct ct_signal *s, ct_ex *out)
{
    const bool is_force = !strcmp(s->property, "force");
    const int i = ct_signal_component_index(s);
    b->signals.is_open
        = b->signals.is_open || (i >= 0 && !ct_beam_load_is_known(b, s->number, is_force, i));
    return ct_signal_component(b, s, ct_beam_load(b, s->number, is_force), out);
}

static ct_ex energy(const struct ct_equations *e, int which)
{
    const ct_ex values[] = {e->kinetic, e->potential, e->strain, e->work_symbol, e->total};
    return values[which];
}

static bool validity(struct ct_build *b, const struct ct_signal *s, ct_ex *out)
{
    struct ct_validity v;
    if (!ct_validity_derive(b, ct_flexible_of(b, s->number), &v))
        return ct_signal_unknown(b, s, "the beam does not bend");
    *out = v.eta;
    return true;
}

bool ct_output_signal(struct ct_build *b, const char *name, struct ct_mark mark, ct_ex *out)
{
    struct ct_signal s;
    if (!ct_signal_resolve(b, name, mark, &s, out))
        return false;
    switch (s.dynamic) {
    case CT_DYNAMIC_NONE:
        break;
    case CT_DYNAMIC_DRIVER:
        *out = ct_driver_effort(b, s.number);
        break;
    case CT_DYNAMIC_REACTION:
        return reaction(b, &s, out);
    case CT_DYNAMIC_ENERGY:
        *out = energy(b->eqs, s.number);
        break;
    case CT_DYNAMIC_BEAM_LOAD:
        return beam_load(b, &s, out);
    case CT_DYNAMIC_VALIDITY:
        return validity(b, &s, out);
    }
    return true;
}

ct_ex ct_output_value(struct ct_build *b, ct_ex e)
{
    ct_ex from[CT_MOST_SIGNALS], to[CT_MOST_SIGNALS];
    const size_t n = ct_signals_list(b, e, from);
    if (!n)
        return ct_switch_hold(b, e);
    for (size_t i = 0; i < n; i++) {
        const struct ct_sym s = *ct_ex_symbol(b->x, from[i]);
        ct_output_signal(b, s.name, s.mark, &to[i]);
    }
    const ct_ex replaced = ct_ex_subst(b->x, e, from, to, n);
    const bool more = ct_ex_kinds(b->x, replaced) & 1u << CT_SYM_SIGNAL; // than CT_MOST_SIGNALS
    return more ? ct_output_value(b, replaced) : replaced;
}
