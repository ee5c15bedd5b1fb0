// Shortest decimal text of a double that reads back to the same bits; independent of the locale.
//
//     0.1  ->  0.1        1/3  ->  0.3333333333333333        2^60  ->  1.152921504606847e+18
//
// What always holds: among the shortest decimals that read back to the number, the result is the
// closest one. The format is that of %.17g: with an exponent below 1e-4 and from 1e17 on.
#ifndef CT_BASE_DECIMAL_H
#define CT_BASE_DECIMAL_H

#include <stddef.h>
#include <stdint.h>

enum { CT_DECIMAL_SIZE = 32 }; // Limit: of a text; the longest has 24 characters

/// The number digits 10^exponent; the last digit is not 0, unless it is the only one.
struct ct_decimal {
    uint64_t digits;
    int exponent;
};

/**
 * The shortest decimal that reads back to a number.
 *
 * v       in    finite, not negative
 *
 * Cost    some 30 ns
 * Source  Giulietti (2021), The Schubfach way to render doubles; key giulietti2021
 */
struct ct_decimal ct_decimal_shortest(double v);

/// Write v to text; non-finite values become nan, inf or -inf. Returns the length without the NUL.
size_t ct_decimal_format(char text[CT_DECIMAL_SIZE], double v);

/// 10^k = g 2^(floor(log2(10^k)) - 127), g rounded upwards to 128 bits, the high word first; k
/// from -292 to 324.
const uint64_t *ct_decimal_power(int k);

#endif
