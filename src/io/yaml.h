// This folder reads text files: whole files (text.h), CSV tables (sheet.h) and YAML. It checks
// syntax and limits sizes. The meaning of keys and values belongs to src/component.
//
// This header: YAML text -> a tree of nodes with marks.
//
//     map   { key (mark) -> node, ... }   in the order of the file
//     list  [ node, ... ]
//     scalar  text, quoted or not, mark
//
// What always holds for a tree that was read: keys are scalars and distinct within their map,
// depth and size are bounded also through aliases, text is UTF-8 without NUL. Scalars stay text:
// what is a number is for the caller to say. An alias is the anchored node itself (shared, with
// the anchored node's marks: that is where a mistake is corrected).
//
// Not accepted, each with an error: several documents, merge keys `<<`, tags other than !!str,
// keys that are not scalars, aliases inside their own anchor.
#ifndef CT_IO_YAML_H
#define CT_IO_YAML_H

#include "base/ctx.h"

enum ct_node_kind { CT_NODE_SCALAR, CT_NODE_LIST, CT_NODE_MAP };

struct ct_node;

struct ct_node_pair {
    const char *key;
    struct ct_mark mark; // of the key
    const struct ct_node *value;
};

struct ct_node {
    enum ct_node_kind kind;
    struct ct_mark mark; // first character: the quote, the bracket, the dash or the first key
    // scalars
    const char *text;
    bool is_plain; // neither quoted nor a block scalar
    bool is_exact; // character k of the text is at column mark.column + (is_plain ? 0 : 1) + k
    // lists and maps
    size_t n;
    const struct ct_node *const *item;
    const struct ct_node_pair *pair;
    // of the subtree; aliases count each time they are used
    size_t height, weight;
};

/// Reads a file: *root in the model arena, NULL if there is no tree. A duplicate key returns
/// false but still gives a tree, so that the caller can look for more errors. Marks refer to a
/// copy of path. Errors: E002, E101 to E104.
bool ct_yaml_read(struct ct_ctx *ctx, const char *path, const struct ct_node **root);

/// The same for n bytes of text; `file` is its name in marks.
bool ct_yaml_parse(struct ct_ctx *ctx, const char *file, const char *text, size_t n,
                   const struct ct_node **root);

/// Returns the pair with this key, or NULL. node may be NULL or not a map.
const struct ct_node_pair *ct_node_find(const struct ct_node *node, const char *key);
/// Returns the value of this key, or NULL.
const struct ct_node *ct_node_get(const struct ct_node *node, const char *key);
/// Is the node `~`, `null` or empty?
bool ct_node_is_null(const struct ct_node *node);
/// Describes a node for messages: "a list", "a map", "a text".
const char *ct_node_what(const struct ct_node *node);

#endif
