// Numbers and quantities as written: "152", "152 mm", "7e10 Pa", "0.4 N*m*s/rad".
//
//     quantity = number unit
//     unit     = factor { (* | /) factor }
//     factor   = name [^ integer] | 1
//
// What always holds: a parsed value is finite and in SI units; rad has dimension one, so N*m/rad
// and N*m are the same. Locale plays no part.
#ifndef CT_EXPR_UNIT_H
#define CT_EXPR_UNIT_H

#include <stdbool.h>
#include <stddef.h>

struct ct_unit {
    double si;    // one unit in SI units
    int m, kg, s; // exponents of m, kg and s
};

enum ct_unit_result {
    CT_UNIT_OK,
    CT_UNIT_SYNTAX,   // not a product of units; *at is the offending character
    CT_UNIT_UNKNOWN,  // no unit of that name; it starts at *at
    CT_UNIT_EXPONENT, // an exponent that is not a small integer, at *at
};

/// A unit expression: all n characters of text. "" is the number one.
enum ct_unit_result ct_unit_parse(const char *text, size_t n, struct ct_unit *unit, size_t *at);

bool ct_unit_same(const struct ct_unit *a, const struct ct_unit *b);
/// Nearest known unit to a misspelt one at the start of text, or NULL.
const char *ct_unit_nearest(const char *text);

/// Length of the decimal number at the start of text (digits with an optional point and exponent,
/// no sign); 0 if there is none. *value is infinite if it overflows.
size_t ct_number_parse(const char *text, double *value);

#endif
