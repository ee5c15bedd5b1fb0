// Printing a graph as text, dot and json, against files under tests/golden/graph; --update
// rewrites them. The example is a slider-crank with arms, its mixed trees T = {O, A, B}, R =
// {O, A, guide}.
#include "graph/print.h"

#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct ct_arena *arena;
static bool update;

static int setup(void **state)
{
    (void)state;
    arena = ct_arena_create();
    return !arena;
}

static int teardown(void **state)
{
    (void)state;
    ct_arena_destroy(arena);
    return 0;
}

// ---- the slider-crank ---------------------------------------------------------------------

struct named_edge {
    const char *name, *kind;
    int tail, head, weight_T, weight_R;
    bool in_T, in_R, is_arm;
};

struct example {
    const char *const *node;
    const struct named_edge *edge;
    int nnode, nedge;
};

static const char *const crank_node[]
    = {"ground", "crank", "crank.O", "crank.A", "rod", "rod.A", "rod.B", "slider"};
static const struct named_edge crank_edge[] = {
    {"crank", "rigid", 0, 1, 2, 1, false, false, false},
    {"crank.O", "arm", 1, 2, 0, 0, true, true, true},
    {"crank.A", "arm", 1, 3, 0, 0, true, true, true},
    {"rod", "rigid", 0, 4, 2, 1, false, false, false},
    {"rod.A", "arm", 4, 5, 0, 0, true, true, true},
    {"rod.B", "arm", 4, 6, 0, 0, true, true, true},
    {"slider", "rigid", 0, 7, 2, 1, false, false, false},
    {"O", "revolute", 0, 2, 0, 1, true, true, false},
    {"A", "revolute", 3, 5, 0, 1, true, true, false},
    {"B", "revolute", 6, 7, 0, 1, true, false, false},
    {"guide", "prismatic", 0, 7, 1, 0, false, true, false},
    {"motor", "torque", 0, 2, -1, -1, false, false, false},
};
static const struct example crank
    = {crank_node, crank_edge, COUNT(crank_node), COUNT(crank_edge)};

static const char *node_name(void *data, int v)
{
    return ((const struct example *)data)->node[v];
}

static const char *edge_name(void *data, int e)
{
    return ((const struct example *)data)->edge[e].name;
}

static const char *edge_kind(void *data, int e)
{
    return ((const struct example *)data)->edge[e].kind;
}

// What a view points at.
struct stage {
    struct example example;
    struct ct_graph g;
    struct ct_tree T, R;
    struct ct_graph_names names;
    struct ct_graph_view view;
};

static struct stage *set_stage(const struct example *x)
{
    struct stage *s = CT_NEW(arena, struct stage);
    struct ct_edge *edge = CT_NEWN(arena, struct ct_edge, x->nedge);
    bool *in_T = CT_NEWN(arena, bool, x->nedge), *in_R = CT_NEWN(arena, bool, x->nedge);
    bool *is_arm = CT_NEWN(arena, bool, x->nedge);
    int *weight_T = CT_NEWN(arena, int, x->nedge), *weight_R = CT_NEWN(arena, int, x->nedge);
    for (int e = 0; e < x->nedge; e++) {
        edge[e] = (struct ct_edge){x->edge[e].tail, x->edge[e].head};
        in_T[e] = x->edge[e].in_T;
        in_R[e] = x->edge[e].in_R;
        is_arm[e] = x->edge[e].is_arm;
        weight_T[e] = x->edge[e].weight_T;
        weight_R[e] = x->edge[e].weight_R;
    }
    s->example = *x;
    s->g = (struct ct_graph){x->nnode, x->nedge, edge};
    assert_true(ct_tree_from_branches(arena, &s->g, in_T, &s->T));
    assert_true(ct_tree_from_branches(arena, &s->g, in_R, &s->R));
    s->names = (struct ct_graph_names){node_name, edge_name, edge_kind, &s->example,
                                       weight_T,  weight_R,  is_arm};
    s->view = (struct ct_graph_view){&s->g, &s->T, &s->R, &s->names};
    return s;
}

// ---- golden files -------------------------------------------------------------------------

enum format { TEXT, DOT, JSON };

/// What a printer writes, to be freed.
static char *print_view(const struct ct_graph_view *view, enum format format)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    if (format == TEXT)
        ct_graph_print(out, arena, view);
    else if (format == DOT)
        ct_graph_print_dot(out, view);
    else
        ct_graph_print_json(out, arena, view);
    fclose(out);
    return text;
}

static const char *golden_path(const char *name)
{
    const char *tests = getenv("CT_TEST_DIR");
    return ct_arena_printf(arena, "%s/golden/graph/%s", tests ? tests : "tests", name);
}

static char *read_file(const char *path)
{
    char buffer[4096], *text = NULL;
    size_t size = 0, n;
    FILE *in = fopen(path, "rb"), *out = open_memstream(&text, &size);
    if (!in)
        fail_msg("%s is missing", path);
    while ((n = fread(buffer, 1, sizeof buffer, in)) > 0)
        fwrite(buffer, 1, n, out);
    fclose(in);
    fclose(out);
    return text;
}

static void write_file(const char *path, const char *text)
{
    FILE *out = fopen(path, "wb");
    if (!out)
        fail_msg("%s cannot be written", path);
    fputs(text, out);
    fclose(out);
}

static void check_golden(const char *name, enum format format)
{
    const char *path = golden_path(name);
    char *got = print_view(&set_stage(&crank)->view, format);
    if (update)
        write_file(path, got);
    char *want = read_file(path);
    const int differs = strcmp(got, want);
    if (differs)
        print_message("---- got\n%s---- want\n%s", got, want);
    free(got);
    free(want);
    assert_int_equal(differs, 0);
}

static void slider_crank_as_text(void **state)
{
    (void)state;
    check_golden("slider_crank.txt", TEXT);
}

static void slider_crank_as_dot(void **state)
{
    (void)state;
    check_golden("slider_crank.dot", DOT);
}

static void slider_crank_as_json(void **state)
{
    (void)state;
    check_golden("slider_crank.json", JSON);
}

// ---- odd names, odd graphs ----------------------------------------------------------------

/// One body on a joint, everything with a name that must be escaped.
static const struct example nasty = {
    (const char *const[]){"<ground>", "a\"b\\c\n&d \xc3\xa9"},
    (const struct named_edge[]){{"</font>", "\t", 0, 1, 0, 0, true, true, false},
                                {"\"]", "", 1, 0, 0, 0, false, false, false}},
    2,
    2,
};

static void check_contains(const struct example *x, enum format format, const char *want)
{
    char *got = print_view(&set_stage(x)->view, format);
    const bool found = strstr(got, want) != NULL;
    if (!found)
        print_message("---- got\n%s---- want in it\n%s\n", got, want);
    free(got);
    assert_true(found);
}

static void names_are_escaped(void **state)
{
    (void)state;
    check_contains(&nasty, JSON, "{\"id\": 1, \"name\": \"a\\\"b\\\\c\\u000a&d \xc3\xa9\"}");
    check_contains(&nasty, JSON, "\"name\": \"</font>\", \"kind\": \"\\u0009\"");
    check_contains(&nasty, DOT, "n1 [label=<a&quot;b&#92;c &amp;d \xc3\xa9>]");
    check_contains(&nasty, DOT, "n0 -> n1 [label=<1 &lt;/font&gt;<br/>");
    check_contains(&nasty, DOT, "n1 -> n0 [label=<2 &quot;]<br/>");
    check_contains(&nasty, DOT, ">&#160;</font>>"); // Graphviz rejects an empty label
}

static void equations_of_equal_trees_are_printed_once(void **state)
{
    (void)state;
    check_contains(&nasty, TEXT,
                   "translation and rotation: the same tree\n"
                   "  cutsets, for through variables, one per branch\n"
                   "    </font> - \"] = 0\n"
                   "  circuits, for across variables, one per chord\n"
                   "    \"] + </font> = 0\n");
}

static void ground_alone_can_be_printed(void **state)
{
    (void)state;
    const struct example alone = {crank_node, crank_edge, 1, 0};
    check_contains(&alone, TEXT, "  circuits, for across variables, one per chord\n    none\n");
    check_contains(&alone, DOT, "n0 [label=<ground>");
    check_contains(&alone, JSON, "\"edges\": [\n  ],\n");
}

/// A chain of n edges from ground with a chord back to ground from its end.
static struct example long_chain(int n)
{
    const char **node = CT_NEWN(arena, const char *, n + 1);
    struct named_edge *edge = CT_NEWN(arena, struct named_edge, n + 1);
    for (int v = 0; v <= n; v++) {
        node[v] = ct_arena_printf(arena, "frame%d", v);
        edge[v] = (struct named_edge){
            ct_arena_printf(arena, "joint%d", v), "joint", v, v + 1, 1, 1, true, true, false};
    }
    edge[n].head = 0;
    edge[n].in_T = edge[n].in_R = false;
    return (struct example){node, edge, n + 1, n + 1};
}

static void large_graphs_are_cut_short(void **state)
{
    (void)state;
    const struct example x = long_chain(80);
    check_contains(&x, TEXT, "\n  too wide to print: 81 edges\n");
    check_contains(&x, TEXT, "\n    ... and 20 more\n");
    check_contains(&x, TEXT, " + joint8\n        + joint9");
    check_contains(&x, DOT, "  n80 -> g80 ["); // a ground of its own
}

int main(int argc, char **argv)
{
    update = argc > 1 && strcmp(argv[1], "--update") == 0;
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(slider_crank_as_text),
        TEST(slider_crank_as_dot),
        TEST(slider_crank_as_json),
        TEST(names_are_escaped),
        TEST(equations_of_equal_trees_are_printed_once),
        TEST(ground_alone_can_be_printed),
        TEST(large_graphs_are_cut_short),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
