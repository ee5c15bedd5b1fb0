// See switch.h.
#include "formulate/kinematics/switch.h"

static bool changes_in_time(const struct ct_build *b, ct_ex e)
{
    const unsigned still = 1u << CT_SYM_PARAM | 1u << CT_SYM_SWITCH;
    return ct_ex_kinds(b->x, e) & ~still;
}

// The quantity g that an expression node compares with 0; the node itself if it is not a
// comparison.
static ct_ex compared(struct ct_exs *x, ct_ex e)
{
    const struct ct_exnode n = *ct_ex_node(x, e);
    const ct_ex p = {n.a}, q = {n.b};
    switch (n.op) {
    case CT_OP_LT:
    case CT_OP_LE:
    case CT_OP_GT:
    case CT_OP_GE:
    case CT_OP_MIN:
    case CT_OP_MAX:
        return ct_ex_sub(x, p, q);
    case CT_OP_ABS:
    case CT_OP_SIGN:
        return p;
    default:
        return e;
    }
}

// g as written in the model, with its signals instead of their replacements.
static ct_ex as_written(struct ct_build *b, ct_ex g)
{
    struct ct_exs *x = b->x;
    if (!b->signals.nreplaced)
        return g;
    const size_t n = ct_ex_walk(x, &b->signals.written, 1);
    ct_ex *node = CT_NEWN(b->arena, ct_ex, n + 1);
    for (size_t i = 0; i < n; i++)
        node[i] = (ct_ex){x->stack[i]};
    for (size_t i = 0; i < n; i++) {
        const ct_ex own = compared(x, node[i]);
        if (ct_ex_same(own, node[i]))
            continue;
        const ct_ex here
            = ct_ex_subst(x, own, b->signals.from, b->signals.to, b->signals.nreplaced);
        if (ct_ex_same(here, g) || ct_ex_same(ct_ex_neg(x, here), g)) // sign(-u) is -sign(u)
            return own;
    }
    return g;
}

// The 0/1 symbol of `g op 0`; equal comparisons share one. own: g before comparisons in it were
// replaced.
static ct_ex switch_symbol(struct ct_build *b, enum ct_op op, ct_ex g, ct_ex own)
{
    struct ct_equations *s = b->eqs;
    for (size_t i = 0; i < s->nswitch; i++)
        if (s->switches[i].op == op && ct_ex_same(s->switches[i].g, g))
            return s->switches[i].symbol;
    struct ct_switch m
        = {.op = op, .g = g, .written = as_written(b, own), .mark = b->signals.holding};
    const unsigned of_time = 1u << CT_SYM_PARAM | 1u << CT_SYM_SWITCH | 1u << CT_SYM_TIME;
    m.is_time = !(ct_ex_kinds(b->x, g) & ~of_time);
    m.symbol
        = ct_ex_sym(b->x, CT_SYM_SWITCH, ct_arena_printf(b->arena, "mode%zu", s->nswitch + 1),
                    (uint32_t)s->nswitch);
    CT_PUSH(b->arena, s->switches, s->nswitch, s->switch_cap, m);
    return m.symbol;
}

// The replacement of a node whose arguments are replaced already. own: its comparison before that.
static ct_ex hold_node(struct ct_build *b, enum ct_op op, ct_ex e, ct_ex p, ct_ex q, ct_ex own)
{
    struct ct_exs *x = b->x;
    switch (op) {
    case CT_OP_LT:
    case CT_OP_LE:
    case CT_OP_GT:
    case CT_OP_GE:
        return switch_symbol(b, op, ct_ex_sub(x, p, q), own);
    case CT_OP_ABS:
        return ct_ex_if(x, switch_symbol(b, CT_OP_LT, p, own), ct_ex_neg(x, p), p);
    case CT_OP_SIGN:
        return ct_ex_sub(x, switch_symbol(b, CT_OP_GT, p, own),
                         switch_symbol(b, CT_OP_LT, p, own));
    case CT_OP_MIN:
        return ct_ex_if(x, switch_symbol(b, CT_OP_LT, ct_ex_sub(x, p, q), own), p, q);
    case CT_OP_MAX:
        return ct_ex_if(x, switch_symbol(b, CT_OP_GT, ct_ex_sub(x, p, q), own), p, q);
    default:
        return e;
    }
}

static bool is_time_function(const struct ct_build *b, ct_ex e)
{
    const unsigned kinds = ct_ex_kinds(b->x, e), time = 1u << CT_SYM_TIME;
    return !b->signals.in_outputs && !ct_ex_symbol(b->x, e) && kinds & time
        && !(kinds & ~(time | 1u << CT_SYM_PARAM));
}

static void note_time_function(struct ct_build *b, ct_ex e)
{
    struct ct_equations *s = b->eqs;
    for (size_t i = 0; i < s->ntime_function; i++)
        if (ct_ex_same(s->time_function[i], e))
            return;
    CT_PUSH(b->arena, s->time_function, s->ntime_function, s->time_function_cap, e);
}

// Replaces all comparisons in e. is_within: e is part of a function of time alone.
static ct_ex hold(struct ct_build *b, ct_ex e, bool is_within)
{
    struct ct_exs *x = b->x;
    const struct ct_exnode n = *ct_ex_node(x, e);
    const int narg = ct_op_info[n.op].narg;
    if (narg == 0 || !changes_in_time(b, e))
        return e;
    const bool is_first = !is_within && is_time_function(b, e);
    is_within |= is_first;
    // expressions of a model are small, so that recursion is safe
    const ct_ex p = hold(b, (ct_ex){n.a}, is_within);
    ct_ex held;
    if (n.op == CT_OP_TABLE) {
        held = ct_ex_table(x, n.b, n.c, p);
    } else {
        const ct_ex q = narg > 1 ? hold(b, (ct_ex){n.b}, is_within) : CT_EX_ZERO;
        if (n.op == CT_OP_IF)
            held = ct_ex_if(x, p, q, hold(b, (ct_ex){n.c}, is_within));
        else
            held = hold_node(b, (enum ct_op)n.op,
                             narg == 1 ? ct_ex_fun(x, (enum ct_op)n.op, p)
                                       : ct_ex_fun2(x, (enum ct_op)n.op, p, q),
                             p, q, compared(x, e));
    }
    if (is_first)
        note_time_function(b, held);
    return held;
}

ct_ex ct_switch_hold(struct ct_build *b, ct_ex e)
{
    return hold(b, e, false);
}
