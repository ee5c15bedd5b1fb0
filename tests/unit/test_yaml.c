// YAML text to nodes: marks, order, aliases and limits.
#include "io/yaml.h"
#include "tests/check.h"

#include <stdlib.h>
#include <string.h>

static int create(void **state)
{
    struct ct_ctx *ctx = calloc(1, sizeof *ctx);
    *state = ctx;
    return ctx && (ctx->model = ct_arena_create()) && (ctx->scratch = ct_arena_create()) ? 0
                                                                                         : -1;
}

static int destroy(void **state)
{
    struct ct_ctx *ctx = *state;
    ct_arena_destroy(ctx->model);
    ct_arena_destroy(ctx->scratch);
    free(ctx);
    return 0;
}

static const struct ct_node *parse(struct ct_ctx *ctx, const char *text)
{
    const struct ct_node *root;
    return ct_yaml_parse(ctx, "m.yaml", text, strlen(text), &root) ? root : NULL;
}

static void check_mark(struct ct_mark m, int line, int column)
{
    assert_int_equal(m.line, line);
    assert_int_equal(m.column, column);
}

static void marks_point_at_first_characters(void **state)
{
    const struct ct_node *root = parse(*state, "a: 1\n"
                                               "b:   \"two\"\n"
                                               "c: [x,  y]\n"
                                               "d:\n"
                                               "  - p\n"
                                               "  -   {k:  v}\n"
                                               "e:\n"
                                               "  f: g\n");
    assert_non_null(root);
    check_mark(root->mark, 0, 0);
    check_mark(ct_node_find(root, "b")->mark, 1, 0);
    check_mark(ct_node_get(root, "b")->mark, 1, 5); // the quote
    const struct ct_node *c = ct_node_get(root, "c"), *d = ct_node_get(root, "d");
    check_mark(c->mark, 2, 3); // the bracket
    check_mark(c->item[1]->mark, 2, 8);
    check_mark(d->mark, 4, 2); // the first dash
    check_mark(d->item[1]->mark, 5, 6);
    check_mark(d->item[1]->pair[0].mark, 5, 7);
    check_mark(ct_node_get(root, "e")->mark, 7, 2); // the first key
    assert_string_equal(root->pair[4].key, "e");
}

static void scalars_keep_text_and_style(void **state)
{
    const struct ct_node *root
        = parse(*state, "[yes, 'yes', \"a\\tb\", ~, 1e-4, \"a\n  b\", \xc3\xa9\xc3\xa9, &x z]");
    assert_non_null(root);
    static const struct {
        const char *text;
        bool is_plain, is_exact, is_null;
    } want[] = {
        {"yes", true, true, false},
        {"yes", false, true, false},
        {"a\tb", false, false, false},
        {"~", true, true, true},
        {"1e-4", true, true, false},
        {"a b", false, false, false},
        {"\xc3\xa9\xc3\xa9", true, true, false},
        {"z", true, false, false},
    };
    assert_int_equal(root->n, COUNT(want));
    for (size_t i = 0; i < COUNT(want); i++) {
        const struct ct_node *node = root->item[i];
        assert_string_equal(node->text, want[i].text);
        assert_int_equal(node->is_plain, want[i].is_plain);
        assert_int_equal(node->is_exact, want[i].is_exact);
        assert_int_equal(ct_node_is_null(node), want[i].is_null);
    }
}

static void an_empty_value_is_null(void **state)
{
    const struct ct_node *root = parse(*state, "a:\nb: ''\nc: null\n");
    assert_non_null(root);
    assert_true(ct_node_is_null(ct_node_get(root, "a")));
    assert_false(ct_node_is_null(ct_node_get(root, "b")));
    assert_true(ct_node_is_null(ct_node_get(root, "c")));
    assert_null(ct_node_get(root, "d"));
    assert_null(ct_node_get(NULL, "d"));
}

static void an_alias_is_the_anchored_node(void **state)
{
    const struct ct_node *root = parse(*state, "a: &n [1, 2]\nb: *n\nc: &n 3\nd: *n\n");
    assert_non_null(root);
    assert_ptr_equal(ct_node_get(root, "a"), ct_node_get(root, "b"));
    assert_string_equal(ct_node_get(root, "d")->text, "3"); // the last anchor of the name
    assert_int_equal(root->weight, 1 + 3 + 3 + 1 + 1);
}

static void a_key_given_twice_leaves_a_tree_and_an_error(void **state)
{
    struct ct_ctx *ctx = *state;
    static const char text[] = "a: 1\nb: 2\na: 3\na: 4\n";
    const struct ct_node *root;
    assert_false(ct_yaml_parse(ctx, "m.yaml", text, strlen(text), &root));
    assert_non_null(root);
    assert_int_equal(ctx->nerror, 2);
    check_mark(ctx->diagnostic[0].mark, 2, 0);
    assert_int_equal(ctx->diagnostic[1].severity, CT_SEVERITY_NOTE);
    check_mark(ctx->diagnostic[1].mark, 0, 0);
}

static void what_is_refused_has_its_code_and_place(void **state)
{
    static const struct {
        const char *text;
        enum ct_code code;
        int line, column;
    } cases[] = {
        {"", CT_E_YAML, 0, 0},
        {"# only\n", CT_E_YAML, 0, 0},
        {"a: [1\n", CT_E_YAML, 1, 0},
        {"a:\n\tb: 1\n", CT_E_YAML, 1, 0},
        {"a: 1\nb: \xff\n", CT_E_YAML, 1, 3},
        {"a: *b\n", CT_E_YAML, 0, 3},
        {"a: 1\n---\nb: 1\n", CT_E_YAML_FEATURE, 1, 0},
        {"a: {<<: {b: 1}}\n", CT_E_YAML_FEATURE, 0, 4},
        {"a: !!int 1\n", CT_E_YAML_FEATURE, 0, 3},
        {"{[a]: 1}\n", CT_E_YAML_FEATURE, 0, 1},
        {"a: &a [*a]\n", CT_E_YAML_LIMIT, 0, 7},
        {"a: \"x\\0y\"\n", CT_E_YAML, 0, 3},
    };
    struct ct_ctx *ctx = *state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        ctx->ndiagnostic = 0;
        print_message("%s\n", cases[i].text);
        assert_null(parse(ctx, cases[i].text));
        assert_int_equal(ctx->diagnostic[0].code, cases[i].code);
        check_mark(ctx->diagnostic[0].mark, cases[i].line, cases[i].column);
    }
}

static void depth_is_bounded_also_through_aliases(void **state)
{
    struct ct_ctx *ctx = *state;
    char text[20000] = {0};
    memset(text, '[', 10000);
    assert_null(parse(ctx, text));
    // each line adds 20 to the depth of the one before
    size_t n = (size_t)sprintf(text, "l0: &l0 1\n");
    for (int i = 1; i < 20; i++)
        n += (size_t)sprintf(
            text + n, "l%d: &l%d [[[[[[[[[[[[[[[[[[[[*l%d]]]]]]]]]]]]]]]]]]]]\n", i, i, i - 1);
    assert_null(parse(ctx, text));
    assert_int_equal(ctx->diagnostic[ctx->ndiagnostic - 1].code, CT_E_YAML_LIMIT);
}

static void a_file_that_cannot_be_read_is_named(void **state)
{
    struct ct_ctx *ctx = *state;
    const struct ct_node *root;
    assert_false(ct_yaml_read(ctx, "no-such-file.yaml", &root));
    assert_null(root);
    assert_int_equal(ctx->diagnostic[0].code, CT_E_FILE);
    assert_null(ctx->diagnostic[0].mark.file);
    assert_false(ct_yaml_read(ctx, ".", &root)); // a folder
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, create, destroy)
    const struct CMUnitTest tests[] = {
        CASE(marks_point_at_first_characters),
        CASE(scalars_keep_text_and_style),
        CASE(an_empty_value_is_null),
        CASE(an_alias_is_the_anchored_node),
        CASE(a_key_given_twice_leaves_a_tree_and_an_error),
        CASE(what_is_refused_has_its_code_and_place),
        CASE(depth_is_bounded_also_through_aliases),
        CASE(a_file_that_cannot_be_read_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
