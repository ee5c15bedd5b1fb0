// See xml.h.
#include "import/xml.h"

#include <limits.h>
#include <string.h>

#if CT_HAS_EXPAT
#include <expat.h>

struct reading {
    struct ct_ctx *ctx;
    struct ct_arena *a;
    const char *file;
    XML_Parser parser;
    struct ct_xml *root, *open;
    int depth;
    bool failed; // a diagnostic has been given
};

static struct ct_mark mark_here(const struct reading *r)
{
    return (struct ct_mark){.file = r->file,
                            .line = (int)XML_GetCurrentLineNumber(r->parser) - 1,
                            .column = (int)XML_GetCurrentColumnNumber(r->parser)};
}

static void fail(struct reading *r, const char *what)
{
    if (!r->failed)
        ct_error(r->ctx, mark_here(r), CT_E_XML, "%s", what);
    r->failed = true;
    XML_StopParser(r->parser, XML_FALSE);
}

static void XMLCALL begin(void *user, const char *name, const char **attribute)
{
    enum { DEEPEST = 100 }; // Limit: of the stack, with a message
    struct reading *r = user;
    struct ct_xml *e = CT_NEW(r->a, struct ct_xml);
    if (r->depth++ >= DEEPEST) {
        fail(r, "elements stand more than 100 deep in each other");
        return;
    }
    *e = (struct ct_xml){
        .name = ct_arena_strdup(r->a, name), .mark = mark_here(r), .parent = r->open};
    while (attribute[2 * e->nattribute])
        e->nattribute++;
    e->attribute = CT_NEWN(r->a, struct ct_xml_attribute, e->nattribute + 1);
    for (size_t i = 0; i < e->nattribute; i++)
        e->attribute[i]
            = (struct ct_xml_attribute){ct_arena_strdup(r->a, attribute[2 * i]),
                                        ct_arena_strdup(r->a, attribute[2 * i + 1])};
    if (!r->open)
        r->root = e;
    else if (r->open->last)
        r->open->last->next = e;
    else
        r->open->child = e;
    if (r->open)
        r->open->last = e;
    r->open = e;
}

static void XMLCALL end(void *user, const char *name)
{
    struct reading *r = user;
    (void)name;
    r->depth--;
    r->open = r->open->parent;
}

// Rejects entity declarations, which could make a small file very large.
static void XMLCALL declare(void *user, const char *name, int is_parameter, const char *value,
                            int length, const char *base, const char *system, const char *id,
                            const char *notation)
{
    (void)name, (void)is_parameter, (void)value, (void)length;
    (void)base, (void)system, (void)id, (void)notation;
    fail(user, "entities are not read: write what they stand for");
}

static void free_parser(void *parser)
{
    XML_ParserFree(parser);
}

const struct ct_xml *ct_xml_parse(struct ct_ctx *ctx, struct ct_arena *a, const char *file,
                                  const char *text, size_t n)
{
    struct reading r = {.ctx = ctx, .a = a, .file = file};
    // freed with `a` at the latest, because memory exhaustion jumps past the end of this
    // function
    struct ct_arena *own = ct_arena_create_under(a);
    r.parser = XML_ParserCreate(NULL);
    if (!r.parser || n > INT_MAX) {
        ct_error(ctx, (struct ct_mark){.file = file}, CT_E_XML, "the file is too large");
        return NULL;
    }
    ct_arena_on_destroy(own, free_parser, r.parser);
    XML_SetUserData(r.parser, &r);
    XML_SetElementHandler(r.parser, begin, end);
    XML_SetEntityDeclHandler(r.parser, declare);
    const bool ok = XML_Parse(r.parser, text, (int)n, 1) == XML_STATUS_OK;
    if (!ok && !r.failed)
        ct_error(ctx, mark_here(&r), CT_E_XML, "the file is not well-formed XML: %s",
                 XML_ErrorString(XML_GetErrorCode(r.parser)));
    ct_arena_destroy(own);
    return ok && !r.failed ? r.root : NULL;
}
#else
const struct ct_xml *ct_xml_parse(struct ct_ctx *ctx, struct ct_arena *a, const char *file,
                                  const char *text, size_t n)
{
    (void)a, (void)text, (void)n;
    ct_error(ctx, (struct ct_mark){.file = file}, CT_E_XML,
             "this program was built without expat, which reads XML");
    return NULL;
}
#endif

const struct ct_xml *ct_xml_child(const struct ct_xml *e, const char *name)
{
    for (const struct ct_xml *c = e->child; c; c = c->next)
        if (strcmp(c->name, name) == 0)
            return c;
    return NULL;
}

const char *ct_xml_get(const struct ct_xml *e, const char *name)
{
    for (size_t i = 0; i < e->nattribute; i++)
        if (strcmp(e->attribute[i].name, name) == 0)
            return e->attribute[i].value;
    return NULL;
}
