// XML as a tree of elements with their places. The only user of expat.
//
// What always holds: an element's parent stands before it; names and values live in the arena.
// Text between tags is not kept.
#ifndef CT_IMPORT_XML_H
#define CT_IMPORT_XML_H

#include "base/ctx.h"

struct ct_xml_attribute {
    const char *name, *value;
};

struct ct_xml {
    const char *name;
    struct ct_mark mark; // of its tag
    struct ct_xml_attribute *attribute;
    size_t nattribute;
    struct ct_xml *parent, *child, *last, *next; // child: the first; next: the one beside
};

/// Parse n bytes; `file` names them in marks. NULL with CT_E_XML, at line and column, where the
/// text is not well-formed, declares entities, or where the program was built without expat.
const struct ct_xml *ct_xml_parse(struct ct_ctx *ctx, struct ct_arena *a, const char *file,
                                  const char *text, size_t n);
/// The first child of this name, or NULL.
const struct ct_xml *ct_xml_child(const struct ct_xml *e, const char *name);
/// The value of an attribute, or NULL.
const char *ct_xml_get(const struct ct_xml *e, const char *name);

#endif
