// Common subexpressions for printing: shared subexpressions get names, so that a large graph fits a
// screen.
//
//     t1 = l1*cos(q1) + l2*cos(q1 + q2)            definitions, each using earlier ones only
//     t2 = t1^2 + m1*l2
//     M11 = m2*t2 + I1                             the expressions
//
// The choice is greedy: the subexpression whose name saves most text is named first, then lengths
// are updated and the next one is chosen. It ends when the whole print is short enough or no name
// saves enough. Symbols, constants, products of these with a number, and functions of one symbol
// never get a name.
#ifndef CT_EXPR_SHARE_H
#define CT_EXPR_SHARE_H

#include "expr/ex.h"

/// All zero: the defaults.
struct ct_share_options {
    size_t most;   // definitions; 0: 40
    double enough; // characters of the whole print at which naming stops; 0: 1500
    double least;  // characters a definition must save; 0: 20
    // Name every labelled subexpression that two expressions share. A label that begins with a
    // minus sign names the negative of the node: the definition is then that of -e, under the label
    // without its sign.
    bool names_first;
    /// The label of a node, or NULL if it has none; a NULL function: the labels of the store.
    const char *(*name)(void *data, const struct ct_exs *x, ct_ex e);
    void *data;
};

struct ct_definition {
    ct_ex e;
    const char *name; // the label, else t1, t2, ... in the order of the list
    double saving;    // characters saved when it was chosen
};

struct ct_share {
    struct ct_definition *at; // sorted: operands before the definitions that use them
    size_t n;
    double size; // estimated characters of the whole print
};

/// Definitions for a print of e[0 ... n). The list lives in a. Cost: nodes below e for each
/// definition.
struct ct_share ct_ex_share(struct ct_arena *a, struct ct_exs *x, const ct_ex *e, size_t n,
                            const struct ct_share_options *options);

/// The name of e or NULL, with data = struct ct_share: a value for the member `node` of struct
/// ct_print.
const char *ct_share_name(void *data, ct_ex e);

#endif
