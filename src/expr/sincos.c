// Sine and cosine by argument reduction and polynomials; see sincos.h.
//
// Cody-Waite reduction by multiples of pi/2 in three parts, the first two of 33 bits, so that
// their products with up to 2^20 are exact; the remainder is y = p + v. Polynomials in y^2,
// interpolated at Chebyshev nodes of [0, (1.01 pi/4)^2] (relative error 2^-59), are summed by
// Estrin's scheme. Sources: reduction, Cody and Waite (1980), key cody1980; products in two parts,
// Dekker (1971), key dekker1971.
#include "expr/sincos.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

// Derived: n = 2 a/pi has at most 20 bits below 1.6e6; the reduction is exact for such n.
static const double largest = 1e6;

// Adding 1.5 * 2^52 rounds to an integer, which the last bits of the sum then hold.
//
//     sin y = y - y^3/6 + y^5 (S1 + S2 y^2 + ...)
//     cos y = 1 - y^2/2 + y^4/24 + y^6 (C1 + C2 y^2 + ...)
#define EACH_CONSTANT(X)                                                                       \
    X(ONE, 1)                                                                                  \
    X(HALF, 0.5)                                                                               \
    X(two_over_pi, 0x1.45f306dc9c883p-1)                                                       \
    X(to_integer, 0x1.8p52)                                                                    \
    X(Q0, 0x1.921fb544p+0)                                                                     \
    X(Q1, 0x1.0b4611a6p-34)                                                                    \
    X(Q2, 0x1.3198a2e037073p-69)                                                               \
    X(S0, -0x1.5555555555555p-3)                                                               \
    X(S1, 0x1.1111111111111p-7)                                                                \
    X(S2, -0x1.a01a01a019eb4p-13)                                                              \
    X(S3, 0x1.71de3a5504ca3p-19)                                                               \
    X(S4, -0x1.ae64551fcba13p-26)                                                              \
    X(S5, 0x1.6122463e0d6c2p-33)                                                               \
    X(S6, -0x1.ab8502e1e7377p-41)                                                              \
    X(C0, 0x1.5555555555555p-5)                                                                \
    X(C1, -0x1.6c16c16c16bedp-10)                                                              \
    X(C2, 0x1.a01a019fe58bap-16)                                                               \
    X(C3, -0x1.27e4fad0c2f58p-22)                                                              \
    X(C4, 0x1.1eec1bc32393ap-29)                                                               \
    X(C5, -0x1.90f4531a82130p-37)

#define ONE_NUMBER(name, value) static const double k1_##name = value;
EACH_CONSTANT(ONE_NUMBER)

static inline uint64_t bits_of(double v)
{
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    return bits;
}

static inline double number_of(uint64_t bits)
{
    double v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

// a b - p for the rounded product p, without a fused operation (Dekker): both halves of a number
// have 26 bits.
static inline double product_remainder(double a, double b, double p)
{
    // Definition: Veltkamp's splitting of 53 bits into halves, key dekker1971
    const double split = 0x1p27 + 1, x = split * a, y = split * b;
    const double ah = x - (x - a), al = a - ah, bh = y - (y - b), bl = b - bh;
    return ((ah * bh - p) + ah * bl + al * bh) + al * bl;
}

#define V double
#define I uint64_t
#define BITS(v) bits_of(v)
#define NUMBER(b) number_of(b)
#define K(name) k1_##name
#define PRODUCT_REMAINDER(a, b, p) product_remainder(a, b, p)
#define MADD(a, b, c) ((a) * (b) + (c))
#define REST(a, n, q) ((a) - (n) * (q))
#define KERNEL kernel_1
#define TARGET
#include "expr/sincos_kernel.def"

typedef void (*kernel_fn)(double a, double *s, double *c);
static kernel_fn choose_kernel(void);

static inline void one_angle(kernel_fn kernel, double a, double *s, double *c)
{
    if (fabs(a) <= largest) {
        kernel(a, s, c);
        return;
    }
    *s = sin(a);
    *c = cos(a);
}

void ct_sincos(double a, double *s, double *c)
{
    one_angle(choose_kernel(), a, s, c);
}

static void one_by_one(const double *a, double *s, double *c, size_t n)
{
    const kernel_fn kernel = choose_kernel();
    for (size_t i = 0; i < n; i++)
        one_angle(kernel, a[i], &s[i], &c[i]);
}

#if defined(__x86_64__) && defined(__GNUC__)

#include <immintrin.h>

enum { LANES = 4 }; // Definition: doubles of a 256-bit register
typedef double four __attribute__((vector_size(32)));
typedef uint64_t four_integers __attribute__((vector_size(32)));

#define FOUR_NUMBERS(name, value) static const four k4_##name = {value, value, value, value};
EACH_CONSTANT(FOUR_NUMBERS)

#define WIDE __attribute__((target("avx2,fma")))

#define V double
#define I uint64_t
#define BITS(v) bits_of(v)
#define NUMBER(b) number_of(b)
#define K(name) k1_##name
#define PRODUCT_REMAINDER(a, b, p) __builtin_fma(a, b, -(p))
#define MADD(a, b, c) __builtin_fma(a, b, c)
#define REST(a, n, q) __builtin_fma(-(n), q, a)
#define KERNEL kernel_1_fused
#define TARGET WIDE
#include "expr/sincos_kernel.def"

static bool is_wide(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}

static kernel_fn choose_kernel(void)
{
    return is_wide() ? kernel_1_fused : kernel_1;
}

#define V four
#define I four_integers
#define BITS(v) ((four_integers)(v))
#define NUMBER(b) ((four)(b))
#define K(name) k4_##name
#define PRODUCT_REMAINDER(a, b, p) _mm256_fmsub_pd(a, b, p)
#define MADD(a, b, c) _mm256_fmadd_pd(a, b, c)
#define REST(a, n, q) _mm256_fnmadd_pd(n, q, a)
#define KERNEL kernel_4
#define TARGET WIDE
#include "expr/sincos_kernel.def"

WIDE static inline bool has_large(four angle)
{
    enum { ALL = (1 << LANES) - 1 };
    return _mm256_movemask_pd((four)((angle <= largest) & (angle >= -largest))) != ALL;
}

// Load element by element: callers have just stored single doubles, and a vector load that spans
// several stores cannot be forwarded from the store buffer.
WIDE static inline four gather(const double *a, size_t n)
{
    return (four){a[0], a[n > 1 ? 1 : 0], a[n > 2 ? 2 : 0], a[n > 3 ? 3 : 0]};
}

WIDE static inline void scatter(double *v, four lanes, size_t n)
{
    if (n == LANES)
        _mm256_storeu_pd(v, lanes);
    for (size_t i = 0; i < n && n < LANES; i++)
        v[i] = lanes[i];
}

// At most LANES angles. Returns true if some are beyond the range.
WIDE static inline bool few(const double *a, double *s, double *c, size_t n)
{
    const four angle = gather(a, n);
    four sine, cosine;
    kernel_4(angle, &sine, &cosine);
    scatter(s, sine, n);
    scatter(c, cosine, n);
    return has_large(angle);
}

WIDE static bool four_by_four(const double *a, double *s, double *c, size_t n)
{
    bool has = false;
    for (; n > LANES; n -= LANES, a += LANES, s += LANES, c += LANES)
        has |= few(a, s, c, LANES);
    if (n == 4)
        has |= few(a, s, c, 4);
    else if (n == 3)
        has |= few(a, s, c, 3);
    else if (n == 2)
        has |= few(a, s, c, 2);
    else if (n == 1)
        has |= few(a, s, c, 1);
    return has;
}

void ct_sincos_many(const double *a, double *s, double *c, size_t n)
{
    if (!is_wide() || four_by_four(a, s, c, n)) // angles beyond the range are computed again
        one_by_one(a, s, c, n);
}

#else

static kernel_fn choose_kernel(void)
{
    return kernel_1;
}

void ct_sincos_many(const double *a, double *s, double *c, size_t n)
{
    one_by_one(a, s, c, n);
}

#endif
