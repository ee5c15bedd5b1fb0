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
// A text may also be one quantity, a number with a unit. What always holds: the parser knows no
// model; names and signals are looked up by the caller's functions. Length and nesting are bounded,
// so that whoever walks the result may recurse.
#ifndef CT_EXPR_PARSE_H
#define CT_EXPR_PARSE_H

#include "expr/ex.h"

/// A piece of text and where it stands.
struct ct_text {
    const char *text;
    struct ct_mark mark; // of the value, its quote included
    bool
        is_exact; // character k stands at column mark.column + offset + k; else errors show mark
    int offset;   // 1 after a quote
};

enum ct_name_result {
    CT_NAME_OK,
    CT_NAME_UNKNOWN,   // the parser says so and suggests a near one
    CT_NAME_FORBIDDEN, // exists, but not here: *why completes "'NAME' cannot be used here: ..."
    CT_NAME_REPORTED,  // the callback has put an error into the context
};

/// What names mean. All functions may be NULL (no such names).
struct ct_scope {
    struct ct_exs *x;
    void *user;
    /// A plain name; `t` comes here too.
    enum ct_name_result (*name)(void *user, const char *name, ct_ex *e, const char **why);
    /// A signal, text in normal form ("F.velocity.x in B"), its first part and the part after `in`
    /// (NULL without): make or find its symbol. `where` gives the mark of the first part,
    /// `where_in` of the other.
    enum ct_name_result (*signal)(void *user, const char *text, const char *first,
                                  const char *in, struct ct_mark where, struct ct_mark where_in,
                                  ct_ex *e, const char **why);
    /// All plain names, for suggestions.
    const char *const *known;
    size_t nknown;
    /// Dimension wanted of a quantity, as a unit; NULL: any.
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
/// A word the grammar has taken: t, pi, in, function names.
bool ct_is_reserved(const char *name);

#endif
