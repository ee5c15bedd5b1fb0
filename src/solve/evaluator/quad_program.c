// See quad_program.h.
#include "solve/evaluator/quad_program.h"

#ifdef CT_HAVE_QUADMATH

#include <quadmath.h>

static ct_quad apply(uint32_t op, ct_quad a, ct_quad b, ct_quad c)
{
    switch (op) {
#define FN(function) function##q
#define NO_VALUE nanq("") // tables are not offered
#define OP(op, narg, name, value)                                                              \
    case op:                                                                                   \
        return value;
#include "expr/ops.def"
#undef OP
#undef NO_VALUE
#undef FN
    case CT_OP_ANGLE_SIN:
        return sinq(a);
    case CT_OP_ANGLE_COS:
        return cosq(a);
    case CT_OP_FMA:
        return a * b + c;
    case CT_OP_FMS:
        return a * b - c;
    case CT_OP_FNMA:
        return c - a * b;
    default:
        return nanq("");
    }
}

struct ct_quad_program ct_quad_load(struct ct_arena *a, const struct ct_program *p)
{
    struct ct_quad_program o = {0};
    if (!p->nout)
        return o;
    o.l = p->listing;
    o.value = CT_NEWN(a, ct_quad, o.l->nvalue + 1);
    for (size_t v = 0; v < o.l->nvalue; v++) {
        double number;
        if (o.l->is_leaf[v] && ct_ex_is_const(o.l->x, (ct_ex){o.l->node[v]}, &number))
            o.value[v] = number;
    }
    return o;
}

void ct_quad_evaluate(const struct ct_quad_program *p, const ct_quad *input, ct_quad *out)
{
    const struct ct_listing *l = p->l;
    for (size_t v = 0; v < l->nvalue; v++)
        if (l->is_leaf[v] && l->input[v] != CT_VALUE_NONE)
            p->value[v] = input[l->input[v]];
    for (size_t k = 0; k < l->nins; k++) {
        const struct ct_instruction *i = &l->ins[k];
        ct_quad arg[3] = {0, 0, 0};
        for (uint32_t j = 0; j < i->narg; j++)
            arg[j] = p->value[i->arg[j]];
        if (i->op == CT_OP_SINCOS || i->op == CT_OP_ANGLE_SINCOS)
            sincosq(arg[0], &p->value[i->res[0]], &p->value[i->res[1]]);
        else
            p->value[i->res[0]] = apply(i->op, arg[0], arg[1], arg[2]);
    }
    for (size_t k = 0; k < l->nout; k++)
        out[k] = p->value[l->out[k]];
}

#endif
