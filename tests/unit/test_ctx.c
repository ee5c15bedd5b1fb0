// Diagnostics as the user reads them, and "did you mean".
#include "base/ctx.h"
#include "tests/check.h"

#include <stdlib.h>
#include <string.h>
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

// What ct_ctx_print writes, in the context's arena.
static const char *printed(struct ct_ctx *ctx)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    ct_ctx_print(ctx, out);
    fclose(out);
    const char *copy = ct_arena_strdup(ctx->model, text);
    free(text);
    return copy;
}

// Writes the text to a file in the current folder.
static const char *write_file(const char *text)
{
    static const char path[] = "ctx_test.yaml";
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs(text, f);
    fclose(f);
    return path;
}

static void an_error_shows_line_column_and_caret(void **state)
{
    struct ct_ctx *ctx = *state;
    const char *path = write_file("joints:\n  elbow:\n    axis: [0, 0, 0]\n");
    const struct ct_mark at = {path, 2, 10};
    assert_false(
        ct_error(ctx, at, CT_E_FILE, "joint '%s': the axis has no direction", "elbow"));
    assert_string_equal(
        printed(ctx),
        "ctx_test.yaml:3:11: error: joint 'elbow': the axis has no direction [E002]\n"
        "    3 |     axis: [0, 0, 0]\n"
        "      |           ^\n");
    remove(path);
}

static void a_tab_before_the_mark_stays_a_tab(void **state)
{
    struct ct_ctx *ctx = *state;
    const char *path = write_file("\tx: 1");
    ct_error(ctx, (struct ct_mark){path, 0, 1}, CT_E_FILE, "tab");
    assert_string_equal(printed(ctx), "ctx_test.yaml:1:2: error: tab [E002]\n"
                                      "    1 | \tx: 1\n"
                                      "      | \t^\n");
    remove(path);
}

static void lines_longer_than_the_buffer_are_counted_once(void **state)
{
    struct ct_ctx *ctx = *state;
    char *text = ct_arena_alloc(ctx->model, 1010);
    memset(text, '#', 1000);
    strcpy(text + 1000, "\ny: 2\n");
    const char *path = write_file(text);
    ct_error(ctx, (struct ct_mark){path, 1, 3}, CT_E_FILE, "second");
    assert_string_equal(printed(ctx), "ctx_test.yaml:2:4: error: second [E002]\n"
                                      "    2 | y: 2\n"
                                      "      |    ^\n");
    remove(path);
}

static void without_a_readable_file_only_the_sentence_is_shown(void **state)
{
    struct ct_ctx *ctx = *state;
    ct_error(ctx, (struct ct_mark){"no/such/file.yaml", 0, 0}, CT_E_FILE, "gone");
    ct_error(ctx, (struct ct_mark){0}, CT_E_USAGE, "no model given");
    assert_string_equal(printed(ctx), "no/such/file.yaml:1:1: error: gone [E002]\n"
                                      "cotree: error: no model given [E003]\n");
}

static void warnings_and_notes_are_no_errors(void **state)
{
    struct ct_ctx *ctx = *state;
    const struct ct_mark nowhere = {0};
    ct_warning(ctx, nowhere, CT_E_FILE, "odd");
    ct_note(ctx, nowhere, "because of %d", 7);
    assert_int_equal(ctx->nerror, 0);
    ct_error(ctx, nowhere, CT_E_INTERNAL, "bad");
    assert_int_equal(ctx->nerror, 1);
    assert_int_equal(ctx->ndiagnostic, 3);
    assert_string_equal(printed(ctx), "cotree: warning: odd [E002]\n"
                                      "cotree: note: because of 7\n"
                                      "cotree: error: bad [E004]\n");
}

static void the_nearest_name_is_found(void **state)
{
    (void)state;
    static const char *const names[] = {"revolute", "prismatic", "spherical", "weld"};
    static const struct {
        const char *typed, *wanted;
    } cases[] = {
        {"revolut", "revolute"},    // missing letter
        {"prsimatic", "prismatic"}, // two letters swapped
        {"sphericall", "spherical"},
        {"wedl", "weld"},
        {"gear", NULL},
        {"", NULL},
        {"something quite different, and longer than any name that could have been meant",
         NULL},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        const char *got = ct_nearest(cases[i].typed, names, COUNT(names));
        if (cases[i].wanted) {
            assert_non_null(got);
            assert_string_equal(got, cases[i].wanted);
        } else {
            assert_null(got);
        }
    }
    assert_null(ct_nearest("x", NULL, 0));
}

static void among_equally_near_names_the_first_wins(void **state)
{
    (void)state;
    static const char *const names[] = {"q1", "q2"};
    assert_string_equal(ct_nearest("q3", names, COUNT(names)), "q1");
}

int main(void)
{
#define CASE(f) cmocka_unit_test_setup_teardown(f, create, destroy)
    const struct CMUnitTest tests[] = {
        CASE(an_error_shows_line_column_and_caret),
        CASE(a_tab_before_the_mark_stays_a_tab),
        CASE(lines_longer_than_the_buffer_are_counted_once),
        CASE(without_a_readable_file_only_the_sentence_is_shown),
        CASE(warnings_and_notes_are_no_errors),
        cmocka_unit_test(the_nearest_name_is_found),
        cmocka_unit_test(among_equally_near_names_the_first_wins),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
