// XML as a tree of elements with marks. The only user of expat.
//
// What always holds: an element comes after its parent; names and values live in the arena.
// Text between tags is not kept.
#ifndef CT_IMPORT_XML_H
#define CT_IMPORT_XML_H

#include "base/ctx.h"

struct ct_xml_attribute {
    const char *name, *value;
};

struct ct_xml {
    const char *name;
    struct ct_mark mark; // of its start tag
    struct ct_xml_attribute *attribute;
    size_t nattribute;
    struct ct_xml *parent, *child, *last, *next; // child: the first; next: the next sibling
};

/// Parses n bytes; `file` is their name in marks. NULL with CT_E_XML, at line and column, if
/// the text is not well-formed or declares entities, or if the program was built without expat.
const struct ct_xml *ct_xml_parse(struct ct_ctx *ctx, struct ct_arena *a, const char *file,
                                  const char *text, size_t n);
/// Returns the first child of this name, or NULL.
const struct ct_xml *ct_xml_child(const struct ct_xml *e, const char *name);
/// Returns the value of an attribute, or NULL.
const char *ct_xml_get(const struct ct_xml *e, const char *name);

#endif
