// See sincos.h.
//
// Reduction by multiples of pi/2 in three parts (Cody and Waite), the first two of 33 bits, so that their products with
// up to 2^20 are exact; what is left is y + tail. Then polynomials of degree 13 and 14, interpolated in y^2 at
// the zeros of Chebyshev's polynomial in [0, (1.01 pi/4)^2]: relative errors 2^-55 and 2^-60.
// Source: Cody and Waite (1980), key cody1980.
#include "expr/sincos.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

// Beyond this n has more bits than the parts of pi/2 leave free.
static const double largest = 1e6;

// Adding 1.5 * 2^52 rounds to an integer, which the last bits of the sum then hold.
//
//     sin y = y + y^3 (S0 + S1 y^2 + ...),   cos y = 1 - y^2/2 + y^4 (C0 + C1 y^2 + ...)
#define EACH_CONSTANT(X)                                                                       \
    X(ONE, 1)                                                                                  \
    X(HALF, 0.5)                                                                               \
    X(two_over_pi, 0x1.45f306dc9c883p-1)                                                       \
    X(to_integer, 0x1.8p52)                                                                    \
    X(Q0, 0x1.921fb544p+0)                                                                     \
    X(Q1, 0x1.0b4611a6p-34)                                                                    \
    X(Q2, 0x1.3198a2e037073p-69)                                                               \
    X(S0, -0x1.5555555555555p-3)                                                               \
    X(S1, 0x1.1111111110b23p-7)                                                                \
    X(S2, -0x1.a01a019e620eep-13)                                                              \
    X(S3, 0x1.71de376b644ccp-19)                                                               \
    X(S4, -0x1.ae5fde7f12068p-26)                                                              \
    X(S5, 0x1.5dfb39c3139b6p-33)                                                               \
    X(C0, 0x1.5555555555555p-5)                                                                \
    X(C1, -0x1.6c16c16c1691fp-10)                                                              \
    X(C2, 0x1.a01a019f3dde1p-16)                                                               \
    X(C3, -0x1.27e4fa0241f7cp-22)                                                              \
    X(C4, 0x1.1eeb52a201da3p-29)                                                               \
    X(C5, -0x1.906dbf4fda044p-37)

#define ONE_NUMBER(name, value) static const double k1_##name = value;
EACH_CONSTANT(ONE_NUMBER)

static inline int64_t bits_of(double v)
{
    int64_t bits;
    memcpy(&bits, &v, sizeof bits);
    return bits;
}

static inline double number_of(int64_t bits)
{
    double v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

#define V double
#define I int64_t
#define BITS(v) bits_of(v)
#define NUMBER(b) number_of(b)
#define K(name) k1_##name
#define KERNEL kernel_1
#define TARGET
#include "expr/sincos_kernel.def"

void ct_sincos(double a, double *s, double *c)
{
    if (fabs(a) <= largest) {
        kernel_1(a, s, c);
        return;
    }
    *s = sin(a);
    *c = cos(a);
}

static void one_by_one(const double *a, double *s, double *c, size_t n)
{
    for (size_t i = 0; i < n; i++)
        ct_sincos(a[i], &s[i], &c[i]);
}

#if defined(__x86_64__) && defined(__GNUC__)

#include <immintrin.h>

enum { LANES = 4 };
typedef double four __attribute__((vector_size(32)));
typedef int64_t four_integers __attribute__((vector_size(32)));

#define FOUR_NUMBERS(name, value) static const four k4_##name = {value, value, value, value};
EACH_CONSTANT(FOUR_NUMBERS)

#define V four
#define I four_integers
#define BITS(v) ((four_integers)(v))
#define NUMBER(b) ((four)(b))
#define K(name) k4_##name
#define KERNEL kernel_4
#define TARGET __attribute__((target("avx2")))
#include "expr/sincos_kernel.def"

#define WIDE __attribute__((target("avx2")))

WIDE static inline bool has_large(four angle)
{
    const four_integers outside = ~((angle <= largest) & (angle >= -largest));
    return _mm256_movemask_pd((four)outside);
}

// Angles beyond the range are done again.
WIDE static void four_by_four(const double *a, double *s, double *c, size_t n)
{
    const size_t most = n / LANES * LANES;
    four sine, cosine;
    for (size_t i = 0; i < most; i += LANES) {
        const four angle = _mm256_loadu_pd(a + i);
        kernel_4(angle, &sine, &cosine);
        _mm256_storeu_pd(s + i, sine);
        _mm256_storeu_pd(c + i, cosine);
        if (has_large(angle))
            one_by_one(a + i, s + i, c + i, LANES);
    }
    if (most == n)
        return;
    static const int64_t on[2 * LANES - 1] = {-1, -1, -1};
    const __m256i used = _mm256_loadu_si256((const __m256i *)(on + LANES - 1 - (n - most)));
    const four angle = _mm256_maskload_pd(a + most, used);
    kernel_4(angle, &sine, &cosine);
    _mm256_maskstore_pd(s + most, used, sine);
    _mm256_maskstore_pd(c + most, used, cosine);
    if (has_large(angle))
        one_by_one(a + most, s + most, c + most, n - most);
}

void ct_sincos_many(const double *a, double *s, double *c, size_t n)
{
    if (n > 1 && __builtin_cpu_supports("avx2"))
        four_by_four(a, s, c, n);
    else
        one_by_one(a, s, c, n);
}

#else

void ct_sincos_many(const double *a, double *s, double *c, size_t n)
{
    one_by_one(a, s, c, n);
}

#endif
