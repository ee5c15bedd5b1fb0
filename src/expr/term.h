// Sums split into terms and products split into factors, sorted for printing.
//
//     sum    term + term - term ...            sorted: accelerations, speeds, coordinates, ...
//     term   number pi^k above / (divisor below)   above, below: lists of factors in order
//
// What always holds: the order depends on the structure of the expressions, not on the order in
// which they were constructed.
#ifndef CT_EXPR_TERM_H
#define CT_EXPR_TERM_H

#include "expr/print.h"

/// An expression that is being printed.
struct ct_printer {
    struct ct_arena *arena;
    const struct ct_exs *x;
    struct ct_print p;
    uint32_t body; ///< printed in full although it has a name
    size_t left;   ///< items that may still be printed
    size_t depth;  ///< of nested groups
    char *s;       ///< the text so far
    size_t n, cap;
};

/// Classes of factors, in the order of printing.
enum ct_factor_class {
    CT_FACTOR_PARAM,
    CT_FACTOR_PARAM_SUM,
    CT_FACTOR_SYMBOL,
    CT_FACTOR_NAMED,
    CT_FACTOR_FUNCTION,
    CT_FACTOR_SUM,
    CT_FACTOR_SPEED,
    CT_FACTOR_ACCELERATION,
    CT_FACTOR_MULTIPLIER
};

/// e^exponent
struct ct_factor {
    ct_ex e;
    int exponent;
    enum ct_factor_class class;
};

struct ct_factors {
    struct ct_factor *at;
    size_t n, cap;
};

/// Classes of terms, in the order of printing.
enum ct_term_class {
    CT_TERM_ACCELERATION,
    CT_TERM_SPEED,
    CT_TERM_SYMBOL,
    CT_TERM_PARAM,
    CT_TERM_FUNCTION,
    CT_TERM_MULTIPLIER
};

/// number * above / (divisor * below)
struct ct_term {
    ct_ex e;            ///< the operand of the sum
    bool is_subtracted; ///< the term is -e
    bool negative;
    double number, divisor;
    int pi; ///< exponent of pi
    struct ct_factors above, below;
    enum ct_term_class class;
};

struct ct_terms {
    struct ct_term *at;
    size_t n, cap;
};

/// The name to print instead of e, or NULL.
const char *ct_printer_name(const struct ct_printer *pr, ct_ex e);

/// The integer exponent that e is, not 0 and at most 99 in size; 0 if e is none.
int ct_whole_exponent(const struct ct_exs *x, ct_ex e);

/// The terms of e in their present order; one term where e is no sum. Each item visited is counted
/// in pr->left.
struct ct_terms ct_terms_of_sum(struct ct_printer *pr, ct_ex e);

/// Split a power of pi from the number: 6.283185307179586 -> 2 pi. pi stays 0 if there is none.
void ct_term_split_pi(struct ct_term *t);

#endif
