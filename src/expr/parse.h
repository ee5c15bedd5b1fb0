// Expression text -> ct_ex.
//
//     comparison = sum [ (< | <= | > | >= | ==) sum ]
//     sum        = product { (+ | -) product }
//     product    = unary { (* | /) unary }
//     unary      = (+ | -) unary | power
//     power      = primary [ ^ unary ]              so -2^2 = -4, 2^3^2 = 2^9, 2^-1 = 0.5
//     primary    = number | name | name(arguments) | signal | ( comparison )
//     signal     = name . part { . part } [ in name { . part } ]
//
// A text may also be one quantity: a number with a unit. What always holds: the parser knows no
// model; names and signals are looked up by the caller's functions. Length and nesting are bounded,
// so that whoever walks the result may recurse.
#ifndef CT_EXPR_PARSE_H
#define CT_EXPR_PARSE_H

#include "expr/ex.h"

/// A text and its position in the file.
struct ct_text {
    const char *text;
    struct ct_mark mark; // position of the value, including its quote
    // character k at column mark.column + offset + k; else errors show mark
    bool is_exact;
    int offset; // 1 if the text follows a quote
};

enum ct_name_result {
    CT_NAME_OK,
    CT_NAME_UNKNOWN,   // the parser reports the error and suggests a similar name
    CT_NAME_FORBIDDEN, // exists, but not here: *why completes "'NAME' cannot be used here: ..."
    CT_NAME_REPORTED,  // the callback has reported the error
};

/// Resolution of names. Any function may be NULL: no names of that kind are known.
struct ct_scope {
    struct ct_exs *x;
    void *user;
    /// Resolve a plain name, including `t`.
    enum ct_name_result (*name)(void *user, const char *name, ct_ex *e, const char **why);
    /// Resolve a signal: find its symbol or make one. text: normal form ("F.velocity.x in B"). Its
    /// first part and the part after `in` (NULL if absent) are given separately, with their
    /// positions `where` and `where_in`.
    enum ct_name_result (*signal)(void *user, const char *text, const char *first,
                                  const char *in, struct ct_mark where, struct ct_mark where_in,
                                  ct_ex *e, const char **why);
    /// All plain names, for suggestions.
    const char *const *known;
    size_t nknown;
    /// Unit whose dimension a quantity must have; NULL: any.
    const char *unit;
};

/// Parse a whole text: an expression, a number or a quantity.
/// Errors: E113 to E120.
bool ct_parse(struct ct_ctx *ctx, const struct ct_scope *scope, struct ct_text text, ct_ex *e);

/// The unit of a text that is one quantity, a number with a unit; NULL if it is not.
const char *ct_parse_unit(const char *text);

/// Is it one signal and nothing else? Writes its normal form (arena a) and first part.
bool ct_parse_is_signal(struct ct_arena *a, const char *text, const char **normal);

/// Letters, digits and _, not starting with a digit.
bool ct_is_identifier(const char *name);
/// A reserved word of the grammar: t, pi, in, names of functions.
bool ct_is_reserved(const char *name);

#endif
