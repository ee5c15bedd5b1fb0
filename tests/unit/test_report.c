// Writers of results: numbers, CSV, JSON, whole-or-nothing files, the progress bar.
#include "base/ctx.h"
#include "report/csv.h"
#include "report/json.h"
#include "report/number.h"
#include "report/progress.h"
#include "tests/check.h"

#include <locale.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int create(void **state)
{
    struct ct_ctx *ctx = calloc(1, sizeof *ctx);
    *state = ctx;
    return ctx && (ctx->model = ct_arena_create()) ? 0 : -1;
}

static int destroy(void **state)
{
    struct ct_ctx *ctx = *state;
    ct_arena_destroy(ctx->model);
    free(ctx);
    return 0;
}

// The contents of a file, in the context's arena; NULL if there is none.
static const char *contents(struct ct_ctx *ctx, const char *path)
{
    FILE *f = fopen(path, "r");
    if (!f)
        return NULL;
    char *text = ct_arena_alloc(ctx->model, 4096);
    fread(text, 1, 4095, f);
    fclose(f);
    return text;
}

// ---- numbers --------------------------------------------------------------------------------

static void numbers_read_back_to_the_same_bits(void **state)
{
    (void)state;
    static const double cases[]
        = {0, -0.0, 1, 0.1, -1.0 / 3, 1e300, 1e22, 4.9e-324, 123456789.125};
    for (size_t i = 0; i < COUNT(cases); i++) {
        char text[CT_NUMBER_SIZE];
        const double back = strtod(ct_number_format(text, cases[i]), NULL);
        assert_memory_equal(&back, &cases[i], sizeof back);
    }
}

static void numbers_that_are_not_finite_have_one_spelling(void **state)
{
    (void)state;
    char text[CT_NUMBER_SIZE];
    assert_string_equal(ct_number_format(text, (double)NAN), "nan");
    assert_string_equal(ct_number_format(text, -(double)NAN), "nan");
    assert_string_equal(ct_number_format(text, (double)INFINITY), "inf");
    assert_string_equal(ct_number_format(text, -(double)INFINITY), "-inf");
}

static void the_decimal_point_does_not_follow_the_locale(void **state)
{
    (void)state;
    static const char *const names[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "ps_AF.UTF-8"};
    size_t i = 0;
    while (i < COUNT(names) && !setlocale(LC_NUMERIC, names[i]))
        i++;
    if (i == COUNT(names))
        skip(); // no such locale on this machine
    char text[CT_NUMBER_SIZE];
    ct_number_format(text, -1.5e-10);
    setlocale(LC_NUMERIC, "C");
    assert_string_equal(text, "-1.5e-10");
}

// ---- CSV ------------------------------------------------------------------------------------

static bool write_row(struct ct_ctx *ctx, struct ct_csv *w, const double *value)
{
    for (size_t i = 0; i < w->ncolumn; i++)
        ct_csv_number(w, value[i]);
    return ct_csv_end_row(ctx, w);
}

static void rows_appear_under_the_name_only_when_complete(void **state)
{
    struct ct_ctx *ctx = *state;
    static const char *const column[] = {"t", "crank.q", "atan2(y, x)", "a \"b\""};
    struct ct_csv w;
    assert_true(ct_csv_open(ctx, &w, "report_a.csv", CT_SUFFIX_CSV, column, COUNT(column)));
    assert_true(write_row(ctx, &w, (const double[]){0, 0.5, -1, 1e-3}));
    assert_true(write_row(ctx, &w, (const double[]){0.25, (double)NAN, 2, 0.1}));
    assert_null(contents(ctx, "report_a.csv"));
    assert_true(ct_csv_close(ctx, &w));
    assert_string_equal(contents(ctx, "report_a.csv"),
                        "t,crank.q,\"atan2(y, x)\",\"a \"\"b\"\"\"\n"
                        "0,0.5,-1,0.001\n"
                        "0.25,nan,2,0.1\n");
    assert_null(contents(ctx, "report_a.csv.partial"));
    remove("report_a.csv");
}

static void fields_may_be_text_or_empty(void **state)
{
    struct ct_ctx *ctx = *state;
    static const char *const column[] = {"method", "error", "note"};
    struct ct_csv w;
    assert_true(ct_csv_open(ctx, &w, "report_b.csv", CT_SUFFIX_CSV, column, COUNT(column)));
    ct_csv_text(&w, "rk4");
    ct_csv_number(&w, 0.5);
    ct_csv_text(&w, "");
    assert_true(ct_csv_end_row(ctx, &w));
    ct_csv_text(&w, "two\nlines");
    ct_csv_text(&w, "");
    ct_csv_text(&w, "plain text");
    assert_true(ct_csv_end_row(ctx, &w));
    assert_true(ct_csv_close(ctx, &w));
    assert_string_equal(contents(ctx, "report_b.csv"),
                        "method,error,note\nrk4,0.5,\n\"two\nlines\",,plain text\n");
    remove("report_b.csv");
}

static void a_failed_run_keeps_the_old_result_and_the_partial_rows(void **state)
{
    struct ct_ctx *ctx = *state;
    static const char *const column[] = {"t"};
    FILE *old = fopen("report_c.csv", "w");
    assert_non_null(old);
    fputs("old\n", old);
    fclose(old);
    struct ct_csv w;
    assert_true(ct_csv_open(ctx, &w, "report_c.csv", CT_SUFFIX_CSV, column, 1));
    assert_true(write_row(ctx, &w, (const double[]){0.5}));
    ct_csv_abandon(&w);
    ct_csv_abandon(&w);
    assert_string_equal(contents(ctx, "report_c.csv"), "old\n");
    assert_string_equal(contents(ctx, "report_c.csv.partial"), "t\n0.5\n");
    assert_int_equal(ctx->nerror, 0);
    remove("report_c.csv");
    remove("report_c.csv.partial");
}

static void a_folder_that_is_missing_is_reported(void **state)
{
    struct ct_ctx *ctx = *state;
    static const char *const column[] = {"t"};
    struct ct_csv w;
    assert_false(ct_csv_open(ctx, &w, "no/such/folder/x.csv", CT_SUFFIX_CSV, column, 1));
    assert_int_equal(ctx->nerror, 1);
    assert_int_equal(ctx->diagnostic[0].code, CT_E_FILE);
    assert_string_equal(ctx->diagnostic[0].text, "cannot write 'no/such/folder/x.csv.partial': "
                                                 "No such file or directory");
    ct_csv_abandon(&w);
}

static void a_full_device_is_reported(void **state)
{
    struct ct_ctx *ctx = *state;
    static const char *const column[] = {"t"};
    if (access("/dev/full", W_OK) != 0)
        skip();
    struct ct_csv w;
    assert_true(ct_csv_open(ctx, &w, "/dev/full", CT_SUFFIX_CSV, column,
                            1)); // written directly, not beside it
    assert_null(w.file.partial);
    assert_true(write_row(ctx, &w, (const double[]){0}));
    assert_false(ct_csv_close(ctx, &w));
    assert_string_equal(ctx->diagnostic[0].text,
                        "cannot write '/dev/full': No space left on device");
}

static void a_full_device_is_noticed_while_writing(void **state)
{
    struct ct_ctx *ctx = *state;
    static const char *const column[] = {"t"};
    if (access("/dev/full", W_OK) != 0)
        skip();
    struct ct_csv w;
    assert_true(ct_csv_open(ctx, &w, "/dev/full", CT_SUFFIX_CSV, column, 1));
    long row = 0;
    while (row < 1000000 && write_row(ctx, &w, (const double[]){0.1}))
        row++;
    assert_true(row < 1000000);
    assert_int_equal(ctx->nerror, 1);
    ct_csv_abandon(&w);
}

static void a_name_taken_by_a_folder_is_reported(void **state)
{
    struct ct_ctx *ctx = *state;
    static const char *const column[] = {"t"};
    assert_int_equal(mkdir("report_folder", 0777), 0);
    struct ct_csv w;
    assert_false(ct_csv_open(ctx, &w, "report_folder", CT_SUFFIX_CSV, column, 1));
    assert_string_equal(ctx->diagnostic[0].text,
                        "cannot write 'report_folder': Is a directory");
    rmdir("report_folder");
}

static void a_name_taken_while_writing_leaves_the_partial_file(void **state)
{
    struct ct_ctx *ctx = *state;
    static const char *const column[] = {"t"};
    struct ct_csv w;
    assert_true(ct_csv_open(ctx, &w, "report_taken", CT_SUFFIX_CSV, column, 1));
    assert_int_equal(mkdir("report_taken", 0777), 0);
    assert_false(ct_csv_close(ctx, &w));
    assert_string_equal(ctx->diagnostic[0].text,
                        "cannot replace 'report_taken': Is a directory");
    assert_string_equal(contents(ctx, "report_taken.partial"), "t\n");
    rmdir("report_taken");
    remove("report_taken.partial");
}

// ---- JSON -----------------------------------------------------------------------------------

static void json_is_nested_and_indented(void **state)
{
    (void)state;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    struct ct_json j;
    ct_json_init(&j, out);
    ct_json_object(&j, NULL);
    ct_json_text(&j, "model", "pendulum");
    ct_json_array(&j, "tree");
    ct_json_text(&j, NULL, "pivot");
    ct_json_object(&j, NULL);
    ct_json_integer(&j, "n", -3);
    ct_json_end(&j);
    ct_json_end(&j);
    ct_json_array(&j, "left_out");
    ct_json_end(&j);
    ct_json_object(&j, "seconds");
    ct_json_end(&j);
    ct_json_numbers(&j, "q", (const double[]){0.5, (double)NAN, -1}, 3);
    ct_json_number(&j, "drift", -(double)INFINITY);
    ct_json_number(&j, "step", 0.1);
    ct_json_bool(&j, "done", true);
    ct_json_text(&j, "reason", NULL);
    ct_json_end(&j);
    fclose(out);
    assert_string_equal(text, "{\n"
                              "  \"model\": \"pendulum\",\n"
                              "  \"tree\": [\n"
                              "    \"pivot\",\n"
                              "    {\n"
                              "      \"n\": -3\n"
                              "    }\n"
                              "  ],\n"
                              "  \"left_out\": [],\n"
                              "  \"seconds\": {},\n"
                              "  \"q\": [0.5, null, -1],\n"
                              "  \"drift\": null,\n"
                              "  \"step\": 0.1,\n"
                              "  \"done\": true,\n"
                              "  \"reason\": null\n"
                              "}\n");
    free(text);
}

static void json_texts_are_escaped_and_always_utf8(void **state)
{
    (void)state;
    static const struct {
        const char *text, *quoted;
    } cases[] = {
        {"", "\"\""},
        {"a\"b\\c", "\"a\\\"b\\\\c\""},
        {"\n\t\r\x01\x7f", "\"\\n\\t\\u000d\\u0001\\u007f\""},
        {"\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80",
         "\"\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80\""},
        {"\xff|", "\"\xef\xbf\xbd|\""},                               // never in UTF-8
        {"\xe2\x82", "\"\xef\xbf\xbd\xef\xbf\xbd\""},                 // cut short
        {"\xc0\x80", "\"\xef\xbf\xbd\xef\xbf\xbd\""},                 // not the shortest form
        {"\xed\xa0\x80", "\"\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\""}, // surrogate
        {"\xf4\x90\x80\x80",
         "\"\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\""}, // > 10ffff
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        char *text = NULL;
        size_t size = 0;
        FILE *out = open_memstream(&text, &size);
        assert_non_null(out);
        struct ct_json j;
        ct_json_init(&j, out);
        ct_json_text(&j, NULL, cases[i].text);
        fclose(out);
        assert_string_equal(text, cases[i].quoted);
        free(text);
    }
}

static void json_nests_to_its_stated_depth(void **state)
{
    (void)state;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    struct ct_json j;
    ct_json_init(&j, out);
    for (int i = 0; i < CT_JSON_DEPTH; i++)
        ct_json_array(&j, NULL);
    ct_json_number(&j, NULL, 1);
    for (int i = 0; i < CT_JSON_DEPTH; i++)
        ct_json_end(&j);
    fclose(out);
    assert_int_equal(j.depth, 0);
    assert_string_equal(text + strlen(text) - 3, "\n]\n");
    free(text);
}

// ---- progress -------------------------------------------------------------------------------

static void a_file_sees_no_progress(void **state)
{
    (void)state;
    FILE *out = tmpfile();
    assert_non_null(out);
    struct ct_progress p;
    ct_progress_init(&p, out, "simulate");
    ct_progress_update(&p, 0.5);
    ct_progress_finish(&p);
    assert_int_equal(ftell(out), 0);
    fclose(out);
    ct_progress_finish(&(struct ct_progress){0});
}

static void a_terminal_sees_each_percent_once(void **state)
{
    (void)state;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    struct ct_progress p;
    ct_progress_init(&p, out, "simulate");
    assert_false(p.is_visible);
    p.is_visible = true; // as on a terminal
    ct_progress_update(&p, (double)NAN);
    ct_progress_update(&p, 0.5);
    ct_progress_update(&p, 0.501);
    ct_progress_update(&p, 7);
    ct_progress_finish(&p);
    ct_progress_finish(&p);
    fclose(out);
    assert_string_equal(text, "\rsimulate [##########..........]  50 %"
                              "\rsimulate [####################] 100 %"
                              "\r\033[K");
    free(text);
}

int main(void)
{
#define CASE(f) cmocka_unit_test_setup_teardown(f, create, destroy)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_read_back_to_the_same_bits),
        cmocka_unit_test(numbers_that_are_not_finite_have_one_spelling),
        cmocka_unit_test(the_decimal_point_does_not_follow_the_locale),
        CASE(rows_appear_under_the_name_only_when_complete),
        CASE(fields_may_be_text_or_empty),
        CASE(a_failed_run_keeps_the_old_result_and_the_partial_rows),
        CASE(a_folder_that_is_missing_is_reported),
        CASE(a_full_device_is_reported),
        CASE(a_full_device_is_noticed_while_writing),
        CASE(a_name_taken_by_a_folder_is_reported),
        CASE(a_name_taken_while_writing_leaves_the_partial_file),
        cmocka_unit_test(json_is_nested_and_indented),
        cmocka_unit_test(json_texts_are_escaped_and_always_utf8),
        cmocka_unit_test(json_nests_to_its_stated_depth),
        cmocka_unit_test(a_file_sees_no_progress),
        cmocka_unit_test(a_terminal_sees_each_percent_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
