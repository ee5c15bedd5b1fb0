// What the page of a report carries: samples as text, fingerprints.
#include "base/sha256.h"
#include "report/packed.h"
#include "tests/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

// ---- fingerprints -------------------------------------------------------------------------------

static void sha256_gives_the_published_digests(void **state)
{
    (void)state;
    // FIPS 180-4, examples; NIST's test of a million letters
    static const struct {
        const char *text, *digest;
    } cases[] = {{"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
                 {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
                 {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
                  "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"}};
    char text[2 * CT_SHA256_SIZE + 1];
    for (size_t i = 0; i < COUNT(cases); i++) {
        ct_sha256_text((const unsigned char *)cases[i].text, strlen(cases[i].text), text);
        assert_string_equal(text, cases[i].digest);
    }
    enum { MILLION = 1000000 };
    unsigned char *letters = malloc(MILLION);
    assert_non_null(letters);
    memset(letters, 'a', MILLION);
    ct_sha256_text(letters, MILLION, text);
    free(letters);
    assert_string_equal(text,
                        "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

static void base64_pads_to_whole_groups(void **state)
{
    (void)state;
    // RFC 4648, section 10
    static const char *const cases[][2]
        = {{"", ""},        {"f", "Zg=="},        {"fo", "Zm8="},
           {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"foobar", "Zm9vYmFy"}};
    struct ct_arena *a = ct_arena_create();
    for (size_t i = 0; i < COUNT(cases); i++)
        assert_string_equal(
            ct_base64(a, (const unsigned char *)cases[i][0], strlen(cases[i][0])), cases[i][1]);
    ct_arena_destroy(a);
}

// ---- samples ------------------------------------------------------------------------------------

static size_t decode(const char *text, unsigned char *out)
{
    static const char digit[]
        = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    uint32_t bits = 0;
    size_t n = 0;
    int nbit = 0;
    for (; *text && *text != '=' && *text != '"'; text++) {
        bits = bits << 6 | (uint32_t)(strchr(digit, *text) - digit);
        nbit += 6;
        if (nbit >= 8) {
            nbit -= 8;
            out[n++] = (unsigned char)(bits >> nbit);
        }
    }
    return n;
}

// As web/packed.js does.
static void unpack(const char *json, double *value, size_t nrow, size_t ncolumn)
{
    const size_t size = nrow * ncolumn, room = strlen(json);
    unsigned char *packed = malloc(room), *plane = malloc(4 * size);
    double *low = malloc(ncolumn * sizeof *low), *step = malloc(ncolumn * sizeof *step);
    z_stream z = {.next_in = packed, .next_out = plane, .avail_out = (uInt)(4 * size)};
    z.avail_in = (uInt)decode(strstr(json, "\"data\": \"") + 9, packed);
    assert_int_equal(inflateInit2(&z, -15), Z_OK);
    assert_int_equal(inflate(&z, Z_FINISH), Z_STREAM_END);
    assert_int_equal(z.avail_out, 0);
    inflateEnd(&z);
    const char *at = strstr(json, "\"low\": [") + 8, *to = strstr(json, "\"step\": [") + 9;
    for (size_t c = 0; c < ncolumn; c++) {
        char *end;
        low[c] = strtod(at, &end);
        at = end + 2;
        step[c] = strtod(to, &end);
        to = end + 2;
    }
    for (size_t c = 0; c < ncolumn; c++) {
        int32_t k = 0, slope = 0;
        for (size_t i = 0; i < nrow; i++) {
            uint32_t code = 0;
            for (size_t b = 0; b < 4; b++)
                code |= (uint32_t)plane[b * size + c * nrow + i] << 8 * b;
            slope += code & 1 ? -(int32_t)(code >> 1) - 1 : (int32_t)(code >> 1);
            k += slope;
            value[i * ncolumn + c] = k == 0xffffff ? (double)NAN : low[c] + step[c] * k;
        }
    }
    free(packed);
    free(plane);
    free(low);
    free(step);
}

static char *pack(struct ct_arena *a, const double *value, size_t nrow, size_t ncolumn)
{
    char *text = NULL;
    size_t n;
    FILE *out = open_memstream(&text, &n);
    struct ct_json j;
    ct_json_init(&j, out);
    ct_json_object(&j, NULL);
    ct_pack_write(&j, a, "samples", value, nrow, ncolumn);
    ct_json_end(&j);
    fclose(out);
    return text;
}

static void samples_come_back_within_half_a_step(void **state)
{
    (void)state;
    enum { NROW = 2001, NCOLUMN = 6 };
    double *value = malloc(NROW * NCOLUMN * sizeof *value),
           *back = malloc(NROW * NCOLUMN * sizeof *back);
    double low[NCOLUMN], high[NCOLUMN];
    for (size_t i = 0; i < NROW; i++) {
        const double t = (double)i / (NROW - 1);
        const double row[NCOLUMN] = {t,
                                     1e-9 * sin(40 * t),
                                     i % 500 < 250 ? -1e12 : 1e12, // jumps
                                     7.25,                         // a constant
                                     1e6 + 1e-3 * cos(9 * t),      // a small motion far out
                                     i % 2 ? 1e300 : -1e300};
        memcpy(value + NCOLUMN * i, row, sizeof row);
    }
    struct ct_arena *a = ct_arena_create();
    char *text = pack(a, value, NROW, NCOLUMN);
    unpack(text, back, NROW, NCOLUMN);
    for (size_t c = 0; c < NCOLUMN; c++) {
        low[c] = INFINITY;
        high[c] = -INFINITY;
        for (size_t i = 0; i < NROW; i++) {
            low[c] = fmin(low[c], value[NCOLUMN * i + c]);
            high[c] = fmax(high[c], value[NCOLUMN * i + c]);
        }
        const double step = high[c] / 0xfffffe - low[c] / 0xfffffe;
        const double roundoff = 4 * 2.3e-16 * fmax(fabs(low[c]), fabs(high[c]));
        for (size_t i = 0; i < NROW; i++)
            assert_true(fabs(back[NCOLUMN * i + c] - value[NCOLUMN * i + c])
                        <= 0.5001 * step + roundoff);
    }
    free(text);
    free(value);
    free(back);
    ct_arena_destroy(a);
}

static void what_is_not_finite_comes_back_as_nan(void **state)
{
    (void)state;
    const double value[] = {1, (double)NAN, 2, (double)INFINITY, (double)NAN, (double)NAN};
    double back[6];
    struct ct_arena *a = ct_arena_create();
    char *text = pack(a, value, 3, 2);
    unpack(text, back, 3, 2);
    free(text);
    assert_true(back[0] == 1 && isnan(back[1]) && fabs(back[2] - 2) < 1e-6);
    assert_true(isnan(back[3]) && isnan(back[4]) && isnan(back[5]));
    text = pack(a, value, 0, 2); // no rows
    assert_non_null(strstr(text, "\"count\": 0"));
    free(text);
    ct_arena_destroy(a);
}

// 11 outputs of a mechanism with 2001 samples: some two bytes a number.
static void smooth_samples_are_small(void **state)
{
    (void)state;
    enum { NROW = 2001, NCOLUMN = 11 };
    double *value = malloc(NROW * NCOLUMN * sizeof *value);
    for (size_t i = 0; i < NROW; i++)
        for (size_t c = 0; c < NCOLUMN; c++)
            value[NCOLUMN * i + c]
                = sin((1 + (double)c) * 2e-3 * (double)i) + 0.1 * cos(0.03 * (double)i);
    struct ct_arena *a = ct_arena_create();
    char *text = pack(a, value, NROW, NCOLUMN);
    assert_true(strlen(text) < 2 * NROW * NCOLUMN);
    free(text);
    free(value);
    ct_arena_destroy(a);
}

// Where less is of no use a step is as long as that; a column that varies by less is a constant.
static void steps_are_no_shorter_than_asked(void **state)
{
    (void)state;
    const double value[] = {0, 5, 0.5, 5 + 1e-9, 1, 5}, resolution[] = {0.01, 0.01};
    double back[6];
    char *text = NULL;
    size_t n;
    struct ct_arena *a = ct_arena_create();
    FILE *out = open_memstream(&text, &n);
    struct ct_json j;
    ct_json_init(&j, out);
    ct_json_object(&j, NULL);
    ct_pack_write_rounded(&j, a, "samples", value, 3, 2, resolution);
    ct_json_end(&j);
    fclose(out);
    assert_non_null(strstr(text, "\"step\": [0.01, 0.01]"));
    unpack(text, back, 3, 2);
    for (size_t i = 0; i < 6; i++)
        CHECK_CLOSE(back[i], i % 2 ? 5 : value[i], 0, 1e-14); // round-off: 0.5 is 50 steps
    free(text);
    ct_arena_destroy(a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sha256_gives_the_published_digests),
        cmocka_unit_test(steps_are_no_shorter_than_asked),
        cmocka_unit_test(base64_pads_to_whole_groups),
        cmocka_unit_test(samples_come_back_within_half_a_step),
        cmocka_unit_test(what_is_not_finite_comes_back_as_nan),
        cmocka_unit_test(smooth_samples_are_small),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
