// See decimal.h.
//
//     v = c 2^q            interval: all reals that read back as v
//     k = floor(log10(2^q))  so that 10^k <= 2^q: the interval holds one or more multiples of 10^k,
//                          and at most one multiple of 10^(k+1)
//
// The number 4 v 10^-k is computed from 128 bits of 10^-k as an integer whose last bit is set if
// anything was cut off ("rounded to odd"). This is enough to compare it exactly with the ends of
// the interval (section 9 of the source). The result is the multiple of 10^(k+1) in the interval,
// else the closest multiple of 10^k.
#include "base/decimal.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

// Definition: range of the powers of ten in the table
enum { LEAST = -292, MOST = 324 };

static const uint64_t power[MOST - LEAST + 1][2] = {
#include "base/powers_of_ten.def"
};

const uint64_t *ct_decimal_power(int k)
{
    return power[k - LEAST];
}

// floor(log10(2^e)), floor(log10(3/4 2^e)) and floor(log2(10^e)), exact for the exponents of
// doubles.
static int log10_pow2(int e)
{
    return (e * 1262611) >> 22;
}

static int log10_three_quarters_pow2(int e)
{
    return (e * 1262611 - 524031) >> 22;
}

static int log2_pow10(int e)
{
    return (e * 1741647) >> 19;
}

// a b = high 2^64 + low
static uint64_t multiply(uint64_t a, uint64_t b, uint64_t *low)
{
    const uint64_t half = UINT32_MAX;
    const uint64_t ll = (a & half) * (b & half), lh = (a & half) * (b >> 32),
                   hl = (a >> 32) * (b & half), hh = (a >> 32) * (b >> 32);
    const uint64_t middle = (ll >> 32) + (lh & half) + (hl & half);
    *low = a * b;
    return hh + (lh >> 32) + (hl >> 32) + (middle >> 32);
}

// floor(g c 2^-128), with the last bit set if anything was cut off
static uint64_t round_to_odd(const uint64_t g[2], uint64_t c)
{
    uint64_t unused, low;
    const uint64_t below = multiply(g[1], c, &unused);
    uint64_t high = multiply(g[0], c, &low);
    low += below;
    high += low < below;
    return high
         | (low > 1); // g was rounded upwards, so a last bit of 1 in `low` may be round-off
}

static struct ct_decimal without_zeros(uint64_t digits, int exponent)
{
    while (digits && digits % 10 == 0) {
        digits /= 10;
        exponent++;
    }
    return (struct ct_decimal){digits, digits ? exponent : 0};
}

static struct ct_decimal shortest(uint64_t c, int q, bool is_power_of_two)
{
    const uint64_t open = c & 1; // the ends of the interval belong to it if c is even
    const int k = is_power_of_two ? log10_three_quarters_pow2(q) : log10_pow2(q);
    const int h = q + log2_pow10(-k) + 1;
    const uint64_t *g = ct_decimal_power(-k);
    const uint64_t lower = round_to_odd(g, (4 * c - 2 + is_power_of_two) << h) + open;
    const uint64_t four = round_to_odd(g, (4 * c) << h);
    const uint64_t upper = round_to_odd(g, (4 * c + 2) << h) - open;
    const uint64_t s = four / 4;
    if (s >= 10) {
        const uint64_t ten = s / 10;
        const bool below = lower <= 40 * ten, above = 40 * ten + 40 <= upper;
        if (below != above)
            return without_zeros(ten + above, k + 1);
    }
    const bool below = lower <= 4 * s, above = 4 * s + 4 <= upper;
    if (below != above)
        return without_zeros(s + above, k);
    const uint64_t middle = 4 * s + 2;
    return without_zeros(s + (four > middle || (four == middle && s & 1)), k);
}

struct ct_decimal ct_decimal_shortest(double v)
{
    enum { STORED = 52, BIAS = 1075 }; // Definition: of IEEE doubles
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    const uint64_t hidden = UINT64_C(1) << STORED, fraction = bits & (hidden - 1);
    const int exponent = (int)(bits >> STORED) & 0x7ff;
    if (!exponent)
        return fraction ? shortest(fraction, 1 - BIAS, false) : (struct ct_decimal){0};
    const uint64_t c = hidden | fraction;
    const int q = exponent - BIAS;
    if (q <= 0 && q >= -STORED && !(c & ((UINT64_C(1) << -q) - 1)))
        return without_zeros(c >> -q, 0); // an integer below 2^53
    return shortest(c, q, !fraction && exponent > 1);
}

// Write the decimal digits of n, most significant first; returns their number.
static int write_digits(char *text, uint64_t n)
{
    char reversed[20];
    int count = 0;
    do
        reversed[count++] = (char)('0' + n % 10);
    while (n /= 10);
    for (int i = 0; i < count; i++)
        text[i] = reversed[count - 1 - i];
    return count;
}

// d.ddde-05
static size_t format_scientific(char *text, const char *digit, int n, int exponent)
{
    char *p = text;
    *p++ = digit[0];
    if (n > 1) {
        *p++ = '.';
        memcpy(p, digit + 1, (size_t)n - 1);
        p += n - 1;
    }
    *p++ = 'e';
    *p++ = exponent < 0 ? '-' : '+';
    const int size = exponent < 0 ? -exponent : exponent;
    if (size < 10)
        *p++ = '0';
    p += write_digits(p, (uint64_t)size);
    return (size_t)(p - text);
}

// Format ddd000, ddd.ddd or 0.00ddd; point: digits before the decimal point, perhaps negative.
static size_t format_plain(char *text, const char *digit, int n, int point)
{
    char *p = text;
    for (int i = point < 1 ? point - 1 : 0; i < n || i < point; i++) {
        if (i == point)
            *p++ = '.';
        *p++ = i < 0 || i >= n ? '0' : digit[i];
    }
    return (size_t)(p - text);
}

static size_t copy_word(char *text, const char *word)
{
    strcpy(text, word);
    return strlen(word);
}

size_t ct_decimal_format(char text[CT_DECIMAL_SIZE], double v)
{
    enum { LEAST_PLAIN = -4, MOST_PLAIN = 16 }; // Definition: exponents, as of %.17g
    if (isnan(v))                               // the sign of a NaN differs between machines
        return copy_word(text, "nan");
    if (isinf(v))
        return copy_word(text, v < 0 ? "-inf" : "inf");
    const struct ct_decimal d = ct_decimal_shortest(fabs(v));
    char digit[20], *p = text;
    const int n = write_digits(digit, d.digits), exponent = d.exponent + n - 1;
    if (signbit(v))
        *p++ = '-';
    p += exponent < LEAST_PLAIN || exponent > MOST_PLAIN
           ? format_scientific(p, digit, n, exponent)
           : format_plain(p, digit, n, exponent + 1);
    *p = 0;
    return (size_t)(p - text);
}
