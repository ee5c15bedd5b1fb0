// Common subexpressions for printing: shared subexpressions get names, so that a large graph fits a
// screen.
//
//     t1 = l1*cos(q1) + l2*cos(q1 + q2)            definitions, each using earlier ones only
//     t2 = t1^2 + m1*l2
//     M11 = m2*t2 + I1                             the expressions
//
// The subexpression whose name saves most text is named first, then the next with that one in
// place, until everything together is short enough or nothing worth a name is left. Symbols,
// constants, their products with a number and functions of one symbol never get a name.
#ifndef CT_EXPR_SHARE_H
#define CT_EXPR_SHARE_H

#include "expr/ex.h"

/// All zero: the defaults.
struct ct_share_options {
    size_t most;   // definitions; 0: 40
    double enough; // characters of the whole print at which naming stops; 0: 1500
    double least;  // characters a definition must save; 0: 20
    // What has a name by meaning gets it wherever two expressions use it. A name that begins with a minus sign is that
    // of the negative: what is defined is the name without the sign, as -e.
    bool names_first;
    /// The name of a node by its meaning, or NULL; NULL: the labels of the store.
    const char *(*name)(void *data, const struct ct_exs *x, ct_ex e);
    void *data;
};

struct ct_definition {
    ct_ex e;
    const char *name; // given by meaning, else t1, t2, ... in the order of the list
    double saving;    // characters saved when it was chosen
};

struct ct_share {
    struct ct_definition *at; // operands before what uses them
    size_t n;
    double size; // characters of the whole print, about
};

/// Definitions for a print of e[0 ... n). The list lives in a. Cost: nodes below e for each
/// definition.
struct ct_share ct_ex_share(struct ct_arena *a, struct ct_exs *x, const ct_ex *e, size_t n,
                            const struct ct_share_options *options);

/// The name of e or NULL, with data = struct ct_share: what struct ct_print asks for as `node`.
const char *ct_share_name(void *data, ct_ex e);

#endif
