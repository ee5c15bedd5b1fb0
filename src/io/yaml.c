// The only user of libyaml. Converts its events to nodes by recursive descent. Depth, size and
// growth by aliases are bounded here, so that later stages may recurse over the tree.
#include "io/yaml.h"

#include "base/guard.h"
#include "io/text.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

// Limit: of nesting, of values with aliases written out and of bytes. Later stages recurse over the
// tree, so E103 replaces a stack overflow or exhausted memory. (tests/unit/test_yaml.c)
enum { MAX_DEPTH = 64, MAX_WEIGHT = 2000000 };
static const size_t max_bytes = (size_t)16 << 20;

struct anchor {
    const char *name;
    const struct ct_node *node; // NULL while its content is being read
};

// Owns what libyaml allocates.
struct source {
    struct ct_ctx *ctx;
    const char *file;
    const char *text;
    size_t size;
    yaml_parser_t parser;
    yaml_event_t event;
    bool has_event;
    struct anchor *anchor;
    size_t nanchor, anchor_cap;
};

static struct ct_mark mark_of(const struct source *s, yaml_mark_t m)
{
    return (struct ct_mark){s->file, (int)m.line, (int)m.column};
}

static void drop_event(struct source *s)
{
    if (s->has_event)
        yaml_event_delete(&s->event);
    s->has_event = false;
}

// Line and column of a byte, for text that libyaml cannot decode.
static struct ct_mark mark_of_byte(const struct source *s, size_t offset)
{
    struct ct_mark m = {s->file, 0, 0};
    for (size_t i = 0; i < offset && i < s->size; i++) {
        const unsigned char c = (unsigned char)s->text[i];
        if (c == '\n') {
            m.line++;
            m.column = 0;
        } else {
            m.column += (c & 0xc0) != 0x80; // continuation bytes belong to the character before
        }
    }
    return m;
}

static bool character_is_tab(const struct source *s, yaml_mark_t m)
{
    size_t i = 0;
    for (size_t line = 0; line < m.line && i < s->size; i++)
        line += s->text[i] == '\n';
    i += m.column; // only white space comes before the tab
    return i < s->size && s->text[i] == '\t';
}

static bool report_parser(struct source *s)
{
    const yaml_parser_t *p = &s->parser;
    const char *problem = p->problem ? p->problem : "unknown reason";
    switch (p->error) {
    case YAML_MEMORY_ERROR:
        ct_guard_raise();
    case YAML_READER_ERROR:
        return ct_error(s->ctx, mark_of_byte(s, p->problem_offset), CT_E_YAML,
                        "not valid UTF-8 text: %s", problem);
    default:
        break;
    }
    const struct ct_mark at = mark_of(s, p->problem_mark);
    if (character_is_tab(s, p->problem_mark))
        return ct_error(s->ctx, at, CT_E_YAML,
                        "a tab cannot be used here; YAML wants spaces for indentation");
    ct_error(s->ctx, at, CT_E_YAML, "not valid YAML: %s", problem);
    const bool elsewhere = p->context_mark.index != p->problem_mark.index;
    if (p->context && elsewhere)
        ct_note(s->ctx, mark_of(s, p->context_mark), "%s that starts here", p->context);
    return false;
}

static bool next_event(struct source *s)
{
    drop_event(s);
    if (!yaml_parser_parse(&s->parser, &s->event))
        return report_parser(s);
    s->has_event = true;
    return true;
}

static bool open_anchor(struct source *s, const yaml_char_t *name)
{
    if (!name)
        return false;
    const struct anchor a = {ct_arena_strdup(s->ctx->scratch, (const char *)name), NULL};
    CT_PUSH(s->ctx->scratch, s->anchor, s->nanchor, s->anchor_cap, a);
    return true;
}

// A tag requests a type. Models have none, so tags are errors instead of being ignored.
static bool check_tag(struct source *s, const yaml_char_t *tag, struct ct_mark at)
{
    if (!tag || strcmp((const char *)tag, YAML_STR_TAG) == 0
        || strcmp((const char *)tag, "!") == 0)
        return true;
    return ct_error(s->ctx, at, CT_E_YAML_FEATURE, "the tag '%s' has no meaning in a model",
                    (const char *)tag);
}

static size_t count_characters(const char *text)
{
    size_t n = 0;
    for (; *text; text++)
        n += ((unsigned char)*text & 0xc0) != 0x80;
    return n;
}

static bool read_node(struct source *s, size_t depth, const struct ct_node **out);

static bool read_scalar(struct source *s, struct ct_node *node)
{
    const yaml_event_t *e = &s->event;
    const char *value = (const char *)e->data.scalar.value;
    if (strlen(value) != e->data.scalar.length)
        return ct_error(s->ctx, node->mark, CT_E_YAML,
                        "a text must not contain the character NUL");
    node->text = ct_arena_strndup(s->ctx->model, value, e->data.scalar.length);
    node->is_plain = e->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
    const size_t span = e->end_mark.index - e->start_mark.index;
    node->is_exact = e->start_mark.line == e->end_mark.line
                  && span == count_characters(value) + (node->is_plain ? 0 : 2);
    return check_tag(s, e->data.scalar.tag, node->mark);
}

static bool add_child(struct source *s, struct ct_node *node, const struct ct_node *child,
                      struct ct_mark at)
{
    if (child->height + 1 > node->height)
        node->height = child->height + 1;
    node->weight += child->weight;
    if (node->weight > MAX_WEIGHT)
        return ct_error(s->ctx, at, CT_E_YAML_LIMIT,
                        "the file has more than %d values when aliases are written out",
                        MAX_WEIGHT);
    return true;
}

static bool read_list(struct source *s, struct ct_node *node, size_t depth)
{
    if (!check_tag(s, s->event.data.sequence_start.tag, node->mark))
        return false;
    const struct ct_node **item = NULL;
    size_t cap = 0;
    while (next_event(s)) {
        if (s->event.type == YAML_SEQUENCE_END_EVENT) {
            node->item = item;
            return true;
        }
        const struct ct_mark at = mark_of(s, s->event.start_mark);
        const struct ct_node *child;
        if (!read_node(s, depth + 1, &child) || !add_child(s, node, child, at))
            return false;
        CT_PUSH(s->ctx->model, item, node->n, cap, child);
    }
    return false;
}

static bool read_key(struct source *s, struct ct_node_pair *pair)
{
    pair->mark = mark_of(s, s->event.start_mark);
    if (s->event.type != YAML_SCALAR_EVENT)
        return ct_error(s->ctx, pair->mark, CT_E_YAML_FEATURE, "a key must be a name");
    struct ct_node node = {.mark = pair->mark};
    if (!read_scalar(s, &node))
        return false;
    pair->key = node.text;
    if (node.is_plain && strcmp(node.text, "<<") == 0)
        return ct_error(s->ctx, pair->mark, CT_E_YAML_FEATURE,
                        "merge keys are not supported; write the keys out");
    return true;
}

static int compare_keys(const void *a, const void *b)
{
    const struct ct_node_pair *const *p = a, *const *q = b;
    const int c = strcmp((*p)->key, (*q)->key);
    return c ? c : (*p < *q ? -1 : 1); // both point into one array: order of the file
}

// Reports equal keys, which are neighbours after sorting, the earlier one first.
static bool check_distinct(struct source *s, const struct ct_node_pair *pair, size_t n)
{
    if (n < 2)
        return true;
    const struct ct_node_pair **sorted
        = CT_NEWN(s->ctx->scratch, const struct ct_node_pair *, n);
    for (size_t i = 0; i < n; i++)
        sorted[i] = &pair[i];
    qsort(sorted, n, sizeof *sorted, compare_keys);
    bool ok = true;
    for (size_t i = 1; i < n; i++)
        if (strcmp(sorted[i - 1]->key, sorted[i]->key) == 0) {
            ok = ct_error(s->ctx, sorted[i]->mark, CT_E_KEY_TWICE, "'%s' is given twice",
                          sorted[i]->key);
            ct_note(s->ctx, sorted[i - 1]->mark, "the first one is here");
        }
    return ok;
}

static bool read_map(struct source *s, struct ct_node *node, size_t depth)
{
    if (!check_tag(s, s->event.data.mapping_start.tag, node->mark))
        return false;
    struct ct_node_pair *pair = NULL;
    size_t cap = 0;
    while (next_event(s)) {
        if (s->event.type == YAML_MAPPING_END_EVENT) {
            node->pair = pair;
            // the tree is complete in spite of duplicate keys, so reading continues to find
            // more errors
            check_distinct(s, pair, node->n);
            return true;
        }
        struct ct_node_pair p;
        if (!read_key(s, &p) || !next_event(s) || !read_node(s, depth + 1, &p.value)
            || !add_child(s, node, p.value, p.mark))
            return false;
        CT_PUSH(s->ctx->model, pair, node->n, cap, p);
    }
    return false;
}

static bool read_alias(struct source *s, size_t depth, const struct ct_node **out)
{
    const char *name = (const char *)s->event.data.alias.anchor;
    const struct ct_mark at = mark_of(s, s->event.start_mark);
    for (size_t i = s->nanchor; i-- > 0;) {
        if (strcmp(s->anchor[i].name, name) != 0)
            continue;
        const struct ct_node *node = s->anchor[i].node;
        if (!node)
            return ct_error(s->ctx, at, CT_E_YAML_LIMIT, "the alias '*%s' contains itself",
                            name);
        if (depth + node->height > MAX_DEPTH)
            return ct_error(s->ctx, at, CT_E_YAML_LIMIT, "lists and maps nest deeper than %d",
                            MAX_DEPTH);
        *out = node;
        return true;
    }
    return ct_error(s->ctx, at, CT_E_YAML, "the alias '*%s' has no anchor '&%s' before it",
                    name, name);
}

// Reads the node that starts with the current event.
static bool read_node(struct source *s, size_t depth, const struct ct_node **out)
{
    const struct ct_mark at = mark_of(s, s->event.start_mark);
    if (depth > MAX_DEPTH)
        return ct_error(s->ctx, at, CT_E_YAML_LIMIT, "lists and maps nest deeper than %d",
                        MAX_DEPTH);
    if (s->event.type == YAML_ALIAS_EVENT)
        return read_alias(s, depth, out);

    struct ct_node *node = CT_NEW(s->ctx->model, struct ct_node);
    node->mark = at;
    node->weight = 1;
    const size_t own = s->nanchor; // index of its anchor, if it has one
    bool ok, has_anchor = false;
    switch (s->event.type) {
    case YAML_SCALAR_EVENT:
        node->kind = CT_NODE_SCALAR;
        has_anchor = open_anchor(s, s->event.data.scalar.anchor);
        ok = read_scalar(s, node);
        break;
    case YAML_SEQUENCE_START_EVENT:
        node->kind = CT_NODE_LIST;
        has_anchor = open_anchor(s, s->event.data.sequence_start.anchor);
        ok = read_list(s, node, depth);
        break;
    case YAML_MAPPING_START_EVENT:
        node->kind = CT_NODE_MAP;
        has_anchor = open_anchor(s, s->event.data.mapping_start.anchor);
        ok = read_map(s, node, depth);
        break;
    default:
        ok = ct_error(s->ctx, at, CT_E_INTERNAL, "unexpected YAML event %d",
                      (int)s->event.type);
    }
    if (has_anchor)
        s->anchor[own].node = node;
    *out = node;
    return ok;
}

static bool read_document(struct source *s, const struct ct_node **root)
{
    // NOLINTNEXTLINE(misc-redundant-expression): each call takes the next event
    if (!next_event(s) || !next_event(s)) // start of stream; of document
        return false;
    if (s->event.type == YAML_STREAM_END_EVENT)
        return ct_error(s->ctx, (struct ct_mark){s->file, 0, 0}, CT_E_YAML,
                        "the file is empty");
    if (!next_event(s) || !read_node(s, 0, root) || !next_event(s) || !next_event(s))
        return false;
    if (s->event.type != YAML_STREAM_END_EVENT)
        return ct_error(s->ctx, mark_of(s, s->event.start_mark), CT_E_YAML_FEATURE,
                        "a model is one YAML document; a second one starts here");
    return true;
}

bool ct_yaml_parse(struct ct_ctx *ctx, const char *file, const char *text, size_t n,
                   const struct ct_node **root)
{
    *root = NULL;
    if (n > max_bytes)
        return ct_error(ctx, (struct ct_mark){file, 0, 0}, CT_E_YAML_LIMIT,
                        "the file is larger than %zu MiB", max_bytes >> 20);
    const size_t nerror = ctx->nerror;
    struct source *s = CT_NEW(ctx->scratch, struct source);
    *s = (struct source){.ctx = ctx, .file = file, .text = text, .size = n};
    if (!yaml_parser_initialize(&s->parser))
        ct_guard_raise();
    // if memory runs out, libyaml's objects are freed before the error goes on
    struct ct_guard g;
    ct_guard_push(&g);
    if (setjmp(g.env)) {
        ct_guard_pop(&g);
        drop_event(s);
        yaml_parser_delete(&s->parser);
        ct_guard_raise();
    }
    yaml_parser_set_input_string(&s->parser, (const unsigned char *)text, n);
    const struct ct_node *node = NULL;
    const bool ok = read_document(s, &node);
    ct_guard_pop(&g);
    drop_event(s);
    yaml_parser_delete(&s->parser);
    *root = ok ? node : NULL;
    return ok && ctx->nerror == nerror;
}

bool ct_yaml_read(struct ct_ctx *ctx, const char *path, const struct ct_node **root)
{
    char *text;
    size_t n;
    const struct ct_mark none = {0};
    *root = NULL;
    switch (ct_text_read(ctx->scratch, path, max_bytes, &text, &n)) {
    case CT_TEXT_UNREADABLE:
        return ct_error(ctx, none, CT_E_FILE, "cannot read '%s': %s", path, strerror(errno));
    case CT_TEXT_TOO_BIG:
        return ct_error(ctx, none, CT_E_YAML_LIMIT, "'%s' is larger than %zu MiB", path,
                        max_bytes >> 20);
    case CT_TEXT_ENDLESS: // a model may come from a pipe
    case CT_TEXT_OK:
        break;
    }
    return ct_yaml_parse(ctx, ct_arena_strdup(ctx->model, path), text, n, root);
}

const struct ct_node_pair *ct_node_find(const struct ct_node *node, const char *key)
{
    if (!node || node->kind != CT_NODE_MAP)
        return NULL;
    for (size_t i = 0; i < node->n; i++)
        if (strcmp(node->pair[i].key, key) == 0)
            return &node->pair[i];
    return NULL;
}

const struct ct_node *ct_node_get(const struct ct_node *node, const char *key)
{
    const struct ct_node_pair *p = ct_node_find(node, key);
    return p ? p->value : NULL;
}

bool ct_node_is_null(const struct ct_node *node)
{
    return node->kind == CT_NODE_SCALAR && node->is_plain
        && (!node->text[0] || strcmp(node->text, "~") == 0 || strcmp(node->text, "null") == 0);
}

const char *ct_node_what(const struct ct_node *node)
{
    if (node->kind == CT_NODE_LIST)
        return "a list";
    if (node->kind == CT_NODE_MAP)
        return "a map";
    return ct_node_is_null(node) ? "nothing" : "a single value";
}
