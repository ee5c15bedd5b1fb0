// See components.h.
#include "html/components.h"

#include "formulate/build.h"

#include <ctype.h>
#include <stdint.h>
#include <string.h>

// ---- lists of names ------------------------------------------------------------------------

static bool has_name(const char *names, const char *name)
{
    const size_t n = strlen(name);
    for (const char *at = names; (at = strstr(at, name)) != NULL; at += n)
        if ((at == names || at[-1] == ' ') && (!at[n] || at[n] == ' '))
            return true;
    return false;
}

static const char *add_name(struct ct_arena *a, const char *names, const char *name)
{
    if (has_name(names, name))
        return names;
    return *names ? ct_arena_printf(a, "%s %s", names, name) : name;
}

// ---- the graph -----------------------------------------------------------------------------

const char *ct_components_of_edge(struct ct_arena *a, const struct ct_system *sys, int edge)
{
    const struct ct_edge_info *e = &sys->equations.build->topology->edge[edge];
    const struct ct_graph *g = sys->equations.graph;
    if (e->kind != CT_EDGE_ARM)
        return e->self ? add_name(a, e->self->name, e->name) : e->name;
    return add_name(a, ct_components_of_node(a, sys, g->edge[edge].head), e->name);
}

const char *ct_components_of_node(struct ct_arena *a, const struct ct_system *sys, int node)
{
    const struct ct_node_info *v = &sys->equations.build->topology->node[node];
    const char *body = v->body > 0 ? sys->model.body[v->body].instance.name : "ground";
    return add_name(a, v->name, body);
}

// ---- expressions ---------------------------------------------------------------------------

static bool is_component(const struct ct_model *m, const char *name)
{
    for (size_t i = 0; i < m->nparameter; i++)
        if (strcmp(m->parameter[i].name, name) == 0)
            return true;
    return ct_model_find_body(m, name) >= 0 || ct_model_find_joint(m, name) >= 0
        || ct_model_find_force(m, name) >= 0 || strcmp(name, "gravity") == 0;
}

static bool is_of_system(const char *name)
{
    static const char *const words[] = {"energy", "momentum", "constraint", "t"};
    for (size_t i = 0; i < COUNT(words); i++)
        if (strcmp(words[i], name) == 0)
            return true;
    return false;
}

const char *ct_components_in_text(struct ct_arena *a, const struct ct_model *m,
                                  const char *text, size_t n)
{
    const char *names = "";
    for (size_t i = 0; i < n;) {
        size_t length = 0;
        while (i + length < n
               && (isalnum((unsigned char)text[i + length]) || text[i + length] == '_'))
            length++;
        if (length && (i == 0 || text[i - 1] != '.')) {
            const char *word = ct_arena_strndup(a, text + i, length);
            const char *end = text + i + length;
            size_t more = 1;
            while (end + more < text + n
                   && (isalnum((unsigned char)end[more]) || end[more] == '_'))
                more++;
            if (is_component(m, word))
                names = add_name(a, names, word);
            else if (is_of_system(word))
                names = add_name(a, names, "system");
            if (end < text + n && *end == '.') { // a frame
                const char *frame = ct_arena_strndup(a, text + i, length + more);
                if (ct_model_find_frame(m, frame) >= 0)
                    names = add_name(a, names, frame);
            }
        }
        i += length ? length : 1;
    }
    return names;
}

static const struct ct_output *output_of(const struct ct_model *m, const char *column)
{
    for (size_t k = 0; k < m->noutput; k++) {
        const size_t n = strlen(m->output[k].name);
        if (strncmp(m->output[k].name, column, n) == 0 && (!column[n] || column[n] == '.'))
            return &m->output[k];
    }
    return NULL;
}

const char *ct_components_of_result(struct ct_arena *a, const struct ct_system *sys,
                                    size_t result)
{
    const struct ct_model *m = &sys->model;
    const char *column = sys->equations.result[result].name, *names = "";
    const struct ct_output *o = output_of(m, column);
    if (!o)
        return ct_components_in_text(a, m, column, strlen(column));
    const size_t n = ct_ex_walk(m->x, &o->value, 1);
    uint32_t *id = CT_NEWN(a, uint32_t, n + 1);
    memcpy(id, m->x->stack, n * sizeof *id);
    for (size_t i = 0; i < n; i++) {
        const struct ct_sym *s = ct_ex_symbol(m->x, (ct_ex){id[i]});
        if (!s || !s->name)
            continue;
        const char *found = ct_components_in_text(a, m, s->name, strlen(s->name));
        for (const char *word = found; *word; word += strspn(word, " ")) {
            const size_t length = strcspn(word, " ");
            names = add_name(a, names, ct_arena_strndup(a, word, length));
            word += length;
        }
    }
    return *names ? names : "system";
}

// ---- lines of the model --------------------------------------------------------------------

struct lines {
    struct ct_arena *a;
    const char *const *line;
    size_t nline;
    struct ct_component_lines *at;
    size_t n, cap;
};

static size_t indent_of(const char *line)
{
    return strspn(line, " ");
}

static bool says_nothing(const char *line)
{
    const char c = line[indent_of(line)];
    return !c || c == '#' || c == '\r';
}

// Adds the line of a key and the more deeply indented lines after it.
static void add_lines(struct lines *l, const struct ct_model *m, const char *name,
                      struct ct_mark mark)
{
    if (!mark.file || strcmp(mark.file, m->file) != 0 || mark.line < 0
        || (size_t)mark.line >= l->nline)
        return;
    struct ct_component_lines found = {name, mark.line, mark.line};
    for (size_t i = (size_t)mark.line + 1; i < l->nline; i++) {
        if (says_nothing(l->line[i]))
            continue;
        if (indent_of(l->line[i]) <= (size_t)mark.column)
            break;
        found.last = (int)i;
    }
    CT_PUSH(l->a, l->at, l->n, l->cap, found);
}

// Adds keys at the left edge that do not belong to a component.
static void add_top_level(struct lines *l, const struct ct_model *m)
{
    static const char *const keys[][2] = {{"gravity", "gravity"},
                                          {"name", "system"},
                                          {"description", "system"},
                                          {"simulation", "system"}};
    for (size_t i = 0; i < l->nline; i++)
        for (size_t k = 0; k < COUNT(keys); k++) {
            const size_t n = strlen(keys[k][0]);
            if (strncmp(l->line[i], keys[k][0], n) == 0 && l->line[i][n] == ':')
                add_lines(l, m, keys[k][1], (struct ct_mark){.file = m->file, .line = (int)i});
        }
}

// The arm to a centre of mass is defined at the key `com`, or else by its body.
static void add_centre(struct lines *l, const struct ct_model *m, const struct ct_body *body)
{
    const struct ct_value *com = ct_instance_value(&body->instance, "com");
    const char *name = ct_arena_printf(l->a, "%s.com", body->instance.name);
    add_lines(l, m, name, com && com->given ? com->mark : body->instance.mark);
}

// Adds the entry of an output, with the components on which it depends.
static void add_outputs(struct lines *l, const struct ct_system *sys)
{
    const struct ct_model *m = &sys->model;
    const struct ct_output *before = NULL;
    for (size_t i = 0; i < sys->equations.nresult; i++) {
        const struct ct_output *o = output_of(m, sys->equations.result[i].name);
        if (!o || o == before)
            continue;
        struct ct_mark mark = o->mark;
        if (mark.line >= 0 && (size_t)mark.line < l->nline)
            mark.column = (int)indent_of(l->line[mark.line]); // all of the entry
        add_lines(l, m, ct_components_of_result(l->a, sys, i), mark);
        before = o;
    }
}

// `ground` is a body without a mark if the file does not list it.
struct ct_component_lines *ct_components_find_lines(struct ct_arena *a,
                                                    const struct ct_system *sys,
                                                    const char *const *line, size_t n,
                                                    size_t *count)
{
    const struct ct_model *m = &sys->model;
    struct lines l = {.a = a, .line = line, .nline = n};
    for (size_t i = 0; i < m->nparameter; i++)
        add_lines(&l, m, m->parameter[i].name, m->parameter[i].mark);
    for (size_t i = 0; i < m->nbody; i++)
        add_lines(&l, m, i ? m->body[i].instance.name : "ground", m->body[i].instance.mark);
    for (size_t i = 1; i < m->nbody; i++)
        if (!ct_ex3_is_zero(m->body[i].com))
            add_centre(&l, m, &m->body[i]);
    for (size_t i = 0; i < m->nframe; i++)
        if ((int)i != m->body[m->frame[i].body].frame)
            add_lines(&l, m, m->frame[i].name, m->frame[i].mark);
    for (size_t i = 0; i < m->njoint; i++)
        add_lines(&l, m, m->joint[i].name, m->joint[i].mark);
    for (size_t i = 0; i < m->nforce; i++)
        add_lines(&l, m, m->force[i].name, m->force[i].mark);
    add_outputs(&l, sys);
    add_top_level(&l, m);
    *count = l.n;
    return l.at;
}
