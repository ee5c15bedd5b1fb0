// See packed.h.
#include "report/packed.h"

#include "report/deflate.h"

#include <math.h>
#include <string.h>

// Definition: k has 24 bits; ABSENT stands for a value that is not finite
enum { MOST = 0xfffffe, ABSENT = 0xffffff };

char *ct_base64(struct ct_arena *a, const unsigned char *b, size_t n)
{
    static const char digit[]
        = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *text = CT_NEWN(a, char, 4 * ((n + 2) / 3) + 1), *to = text;
    for (size_t i = 0; i < n; i += 3) {
        const size_t left = n - i;
        const uint32_t bits = (uint32_t)b[i] << 16 | (left > 1 ? (uint32_t)b[i + 1] << 8 : 0)
                            | (left > 2 ? b[i + 2] : 0);
        *to++ = digit[bits >> 18];
        *to++ = digit[bits >> 12 & 63];
        *to++ = left > 1 ? digit[bits >> 6 & 63] : '=';
        *to++ = left > 2 ? digit[bits & 63] : '=';
    }
    return text;
}

// low + step k, k = 0 .. MOST, spans the finite values of a column.
static void find_scale(const double *value, size_t nrow, size_t ncolumn, double *low,
                       double *step)
{
    double most = -INFINITY;
    *low = INFINITY;
    for (size_t i = 0; i < nrow; i++) {
        const double v = value[i * ncolumn];
        if (isfinite(v)) {
            *low = fmin(*low, v);
            most = fmax(most, v);
        }
    }
    if (!(most >= *low)) // no value is finite
        *low = most = 0;
    *step = most / MOST - *low / MOST; // without overflow
}

static int32_t multiple_of(double v, double low, double step)
{
    if (!isfinite(v))
        return ABSENT;
    const double k = step > 0 ? v / step - low / step : 0;
    return (int32_t)lround(fmin(fmax(k, 0), MOST));
}

// Second differences of a column as 0, -1, 1, -2 ... -> 0, 1, 2, 3 ..., byte k of number i at
// plane[k size + i].
static void put_column(unsigned char *plane, size_t size, const double *value, size_t nrow,
                       size_t ncolumn, double low, double step)
{
    int32_t last = 0, slope = 0;
    for (size_t i = 0; i < nrow; i++) {
        const int32_t k = multiple_of(value[i * ncolumn], low, step);
        const int32_t second = k - last - slope; // below 2^26
        slope = k - last;
        last = k;
        const uint32_t z
            = second < 0 ? 2 * (uint32_t)(-(second + 1)) + 1 : 2 * (uint32_t)second;
        for (size_t b = 0; b < 4; b++)
            plane[b * size + i] = (unsigned char)(z >> 8 * b);
    }
}

size_t ct_pack_write(struct ct_json *j, struct ct_arena *a, const char *key,
                     const double *value, size_t nrow, size_t ncolumn)
{
    return ct_pack_write_rounded(j, a, key, value, nrow, ncolumn, NULL);
}

size_t ct_pack_write_rounded(struct ct_json *j, struct ct_arena *a, const char *key,
                             const double *value, size_t nrow, size_t ncolumn,
                             const double *resolution)
{
    struct ct_arena *work = ct_arena_create_under(a);
    const size_t size = nrow * ncolumn;
    double *low = CT_NEWN(work, double, ncolumn + 1),
           *step = CT_NEWN(work, double, ncolumn + 1);
    unsigned char *plane = ct_arena_calloc(work, size + 1, 4);
    for (size_t c = 0; c < ncolumn; c++) {
        find_scale(value + c, nrow, ncolumn, &low[c], &step[c]);
        if (resolution)
            step[c] = fmax(step[c], resolution[c]);
        put_column(plane + c * nrow, size, value + c, nrow, ncolumn, low[c], step[c]);
    }
    size_t n;
    const unsigned char *bytes = ct_deflate(work, plane, 4 * size, &n);
    const char *text = ct_base64(work, bytes, n);
    ct_json_object(j, key);
    ct_json_integer(j, "count", (long long)nrow);
    ct_json_integer(j, "columns", (long long)ncolumn);
    ct_json_numbers(j, "low", low, ncolumn);
    ct_json_numbers(j, "step", step, ncolumn);
    ct_json_text(j, "data", text);
    ct_json_end(j);
    const size_t length = strlen(text);
    ct_arena_destroy(work);
    return length;
}
