// Random expression graphs for tests: one seed, one graph.
#ifndef CT_TEST_RANDOM_EX_H
#define CT_TEST_RANDOM_EX_H

#include "expr/ex.h"

#include <stdio.h>
#include <stdlib.h>

struct random {
    uint64_t state;
};

static inline uint32_t random_next(struct random *r)
{
    r->state = r->state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(r->state >> 33);
}

static inline size_t random_below(struct random *r, size_t n)
{
    return random_next(r) % n;
}

/// In [-2, 2].
static inline double random_double(struct random *r)
{
    return 4.0 * random_next(r) / 2147483647.0 - 2;
}

/// CT_SEED of the environment, else a fixed one; printed, so that a failure can be run again.
static inline struct random random_start(const char *test)
{
    const char *text = getenv("CT_SEED");
    uint64_t seed = text ? strtoull(text, NULL, 10) : 20240217;
    printf("%s: CT_SEED=%llu\n", test, (unsigned long long)seed);
    return (struct random){seed * 0x9E3779B97F4A7C15u + 1};
}

/// One more node over the n nodes of e, from all operators; may be an existing one.
static inline ct_ex random_node(struct random *r, struct ct_exs *x, const ct_ex *e, size_t n)
{
    ct_ex a = e[random_below(r, n)], b = e[random_below(r, n)], c = e[random_below(r, n)];
    // most nodes are products and sums, as in equations of motion
    static const enum ct_op often[] = {CT_OP_ADD, CT_OP_SUB, CT_OP_MUL, CT_OP_MUL, CT_OP_ADD};
    enum ct_op op = random_below(r, 2) ? often[random_below(r, COUNT(often))]
                                       : (enum ct_op)random_below(r, CT_OP_COUNT);
    if (op == CT_OP_CONST || op == CT_OP_SYM)
        return ct_ex_const(x, random_double(r));
    if (op == CT_OP_TABLE)
        return x->ntable ? ct_ex_table(x, (uint32_t)random_below(r, x->ntable),
                                       (uint32_t)random_below(r, 3), a)
                         : a;
    if (op == CT_OP_IF)
        return ct_ex_if(x, a, b, c);
    return ct_op_info[op].narg == 1 ? ct_ex_fun(x, op, a) : ct_ex_fun2(x, op, a, b);
}

#endif
