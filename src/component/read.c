// Read a model file: version and top-level keys here, sections in the other read_*.c. Names of all
// sections are declared before any value is read, so that the order within the file does not
// matter.
#include "component/read.h"

#include <stdlib.h>
#include <string.h>

static const char *const top_keys[]
    = {"cotree", "name",   "description", "gravity", "parameters", "inputs",
       "states", "bodies", "joints",      "forces",  "outputs",    "simulation"};

// ---- diagnostics in the order of the file ------------------------------------------------------

struct group {
    const struct ct_finding *first; // an error or warning; its notes follow
    // first position in the model file itself: for a table, where it is used
    struct ct_mark mark;
    size_t n, number;
};

static int compare_groups(const void *a, const void *b)
{
    const struct group *p = a, *q = b;
    const struct ct_mark *m = &p->mark, *n = &q->mark;
    if (!m->file != !n->file) // diagnostics of the command line come first
        return m->file ? 1 : -1;
    if (m->line != n->line)
        return m->line < n->line ? -1 : 1;
    if (m->column != n->column)
        return m->column < n->column ? -1 : 1;
    return p->number < q->number ? -1 : 1;
}

// Sort diagnostics by position in the file, because sections are read in another order.
static void sort_diagnostics(struct ct_ctx *ctx, const char *file, size_t from)
{
    const size_t n = ctx->ndiagnostic - from;
    if (n < 2)
        return;
    struct ct_finding *copy = CT_NEWN(ctx->scratch, struct ct_finding, n);
    struct group *group = CT_NEWN(ctx->scratch, struct group, n);
    memcpy(copy, ctx->diagnostic + from, n * sizeof *copy);
    size_t ngroup = 0;
    for (size_t i = 0; i < n; i++) {
        if (copy[i].severity != CT_SEVERITY_NOTE || !ngroup) {
            group[ngroup] = (struct group){&copy[i], copy[i].mark, 0, ngroup};
            ngroup++;
        }
        struct group *g = &group[ngroup - 1];
        g->n++;
        if (g->mark.file && copy[i].mark.file && strcmp(g->mark.file, file) != 0)
            g->mark = copy[i].mark;
    }
    qsort(group, ngroup, sizeof *group, compare_groups);
    for (size_t g = 0, k = from; g < ngroup; g++)
        for (size_t i = 0; i < group[g].n; i++)
            ctx->diagnostic[k++] = group[g].first[i];
}

// ---- top-level keys ----------------------------------------------------------------------------

static void check_version(struct ct_reader *r)
{
    const struct ct_node_pair *p = ct_node_find(r->root, "cotree");
    if (!p)
        ct_error(r->ctx, r->root->mark, CT_E_VERSION,
                 "the file must start with its version, 'cotree: 1'");
    else if (p != r->root->pair)
        ct_error(r->ctx, p->mark, CT_E_VERSION, "'cotree: 1' must be the first key");
    if (p && (p->value->kind != CT_NODE_SCALAR || strcmp(p->value->text, "1") != 0))
        ct_error(r->ctx, p->value->mark, CT_E_VERSION,
                 "this program reads version 1 of the format, 'cotree: 1'");
}

// File name without folder and suffix.
static const char *stem(struct ct_reader *r)
{
    const char *slash = strrchr(r->m->file, '/');
    const char *base = slash ? slash + 1 : r->m->file;
    const char *dot = strrchr(base, '.');
    char *name
        = ct_arena_strndup(r->a, base, dot && dot > base ? (size_t)(dot - base) : strlen(base));
    for (char *c = name; *c; c++) // replace control characters
        if ((unsigned char)*c < ' ' || *c == 127)
            *c = '?';
    return name;
}

// Does text contain control characters, ASCII or U+0080 to U+009F, other than those in `allowed`?
static bool has_control(const char *text, const char *allowed)
{
    for (const unsigned char *s = (const unsigned char *)text; *s; s++)
        if ((*s < ' ' && !strchr(allowed, *s)) || *s == 127
            || (*s == 0xc2 && s[1] >= 0x80 && s[1] < 0xa0))
            return true;
    return false;
}

// Read a text without control characters, which could steer the terminal where it is printed.
static void read_plain(struct ct_reader *r, const char *key, const char *allowed,
                       const char **text)
{
    const struct ct_node *node = ct_node_get(r->root, key);
    if (node && ct_read_text(r, node, text) && has_control(*text, allowed))
        ct_error(r->ctx, node->mark, CT_E_NAME, "'%s' contains control characters%s", key,
                 *allowed ? "" : "; it is a single line of text");
}

static void read_top(struct ct_reader *r)
{
    struct ct_model *m = r->m;
    check_version(r);
    ct_read_keys(r, r->root, "a model", top_keys, COUNT(top_keys));
    m->name = stem(r);
    m->description = "";
    read_plain(r, "name", "", &m->name);
    read_plain(r, "description", "\n\t", &m->description);
}

static void read_gravity(struct ct_reader *r)
{
    const struct ct_node_pair *p = ct_node_find(r->root, "gravity");
    r->m->gravity = (ct_ex3){{CT_EX_ZERO, CT_EX_ZERO, CT_EX_ZERO}};
    r->m->gravity_mark = (struct ct_mark){0};
    if (!p)
        return;
    r->m->gravity_mark = p->mark;
    ct_read_vec3(r, p->value, 0, "m/s^2", &r->m->gravity, NULL);
}

static void mark_reached(const struct ct_model *m, const struct ct_instance *self,
                         bool *reached)
{
    if (self->from >= 0)
        reached[m->frame[self->from].body] = true;
    if (self->to >= 0)
        reached[m->frame[self->to].body] = true;
}

// Warn of a body without attachments in a model whose other bodies have joints: most often an
// oversight.
static void warn_of_lone_bodies(struct ct_reader *r)
{
    const struct ct_model *m = r->m;
    bool *reached = CT_NEWN(r->ctx->scratch, bool, m->nbody);
    for (size_t i = 0; i < m->njoint; i++)
        mark_reached(m, &m->joint[i], reached);
    for (size_t i = 0; i < m->nforce; i++)
        mark_reached(m, &m->force[i], reached);
    for (size_t i = 1; m->njoint && i < m->nbody; i++)
        if (!reached[i])
            ct_warning(r->ctx, m->body[i].instance.mark, CT_E_ALONE,
                       "no joint and no force reaches body '%s': it moves on its own; give it "
                       "a joint, of type 'free' if that is meant",
                       m->body[i].instance.name);
}

static bool read_model(struct ct_ctx *ctx, const char *file, const struct ct_node *root,
                       const struct ct_set *set, size_t nset, struct ct_model *m)
{
    struct ct_reader r
        = {.ctx = ctx, .a = ctx->model, .m = m, .root = root, .set = set, .nset = nset};
    *m = (struct ct_model){.file = file};
    m->x = CT_NEW(ctx->model, struct ct_exs);
    ct_exs_init(m->x, ctx->model);
    m->time = ct_ex_sym(m->x, CT_SYM_TIME, "t", 0);
    if (!ct_read_shape(&r, root, CT_NODE_MAP, "a map of keys that starts with 'cotree: 1'"))
        return false;
    read_top(&r);
    ct_read_states_declare(&r);
    ct_read_parameters(&r, set, nset);
    for (size_t i = 0; i < m->nstate; i++)
        CT_PUSH(r.a, r.known, r.nknown, r.known_cap, m->state[i].name);
    ct_read_bodies_declare(&r);
    ct_read_joints_declare(&r);
    ct_read_forces_declare(&r);
    read_gravity(&r);
    ct_read_bodies_fill(&r);
    ct_read_joints_fill(&r);
    ct_read_forces_fill(&r);
    if (!ctx->nerror)
        warn_of_lone_bodies(&r);
    ct_read_states_fill(&r);
    ct_read_outputs(&r);
    ct_read_simulation(&r);
    return true;
}

// Finish the model; `nerror` errors existed before this text.
static bool finish(struct ct_ctx *ctx, const char *file, const struct ct_node *root,
                   size_t nerror, size_t ndiagnostic, const struct ct_set *set, size_t nset,
                   struct ct_model *m)
{
    if (root) // also after duplicate keys: there may be more errors to report
        read_model(ctx, file, root, set, nset, m);
    sort_diagnostics(ctx, file, ndiagnostic);
    return ctx->nerror == nerror;
}

bool ct_model_read(struct ct_ctx *ctx, const char *path, const struct ct_set *set, size_t nset,
                   struct ct_model *m)
{
    const size_t nerror = ctx->nerror, ndiagnostic = ctx->ndiagnostic;
    const struct ct_node *root = NULL;
    ct_yaml_read(ctx, path, &root);
    return finish(ctx, ct_arena_strdup(ctx->model, path), root, nerror, ndiagnostic, set, nset,
                  m);
}

bool ct_model_parse(struct ct_ctx *ctx, const char *file, const char *text, size_t n,
                    const struct ct_set *set, size_t nset, struct ct_model *m)
{
    const size_t nerror = ctx->nerror, ndiagnostic = ctx->ndiagnostic;
    const struct ct_node *root = NULL;
    ct_yaml_parse(ctx, file, text, n, &root);
    return finish(ctx, file, root, nerror, ndiagnostic, set, nset, m);
}

bool ct_model_resolve(struct ct_ctx *ctx, const char *file, const struct ct_node *root,
                      const struct ct_set *set, size_t nset, struct ct_model *m)
{
    return finish(ctx, file, root, ctx->nerror, ctx->ndiagnostic, set, nset, m);
}
