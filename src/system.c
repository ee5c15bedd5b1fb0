// The pipeline: model file -> equations of motion, stage by stage.
#include "system.h"

#include "formulate/build.h"
#include "graph/print.h"
#include "io/yaml.h"
#include "report/equations_print.h"
#include "report/tree_pairs.h"
#include "solve/initial/initial_equilibrium.h"

#include <stdlib.h>
#include <string.h>

// ---- requested trees ----------------------------------------------------------------------------

static bool read_branches(struct ct_ctx *ctx, const struct ct_node *node,
                          const char *const **name, const struct ct_mark **mark, size_t *n)
{
    if (node->kind != CT_NODE_LIST)
        return ct_error(ctx, node->mark, CT_E_SHAPE, "a list of branches is wanted, not %s",
                        ct_node_what(node));
    const char **names = CT_NEWN(ctx->model, const char *, node->n + 1);
    struct ct_mark *marks = CT_NEWN(ctx->model, struct ct_mark, node->n + 1);
    bool ok = true;
    for (size_t i = 0; i < node->n; i++) {
        const struct ct_node *item = node->item[i];
        if (item->kind != CT_NODE_SCALAR)
            ok = ct_error(ctx, item->mark, CT_E_SHAPE, "a name is wanted, not %s",
                          ct_node_what(item));
        names[i] = item->kind == CT_NODE_SCALAR ? item->text : "";
        marks[i] = item->mark;
    }
    *name = names;
    *mark = marks;
    *n = node->n;
    return ok;
}

// translation: [names]
// rotation: [names]        as translation, when left out
static bool read_tree_file(struct ct_ctx *ctx, const char *path, struct ct_formulate_options *f)
{
    const struct ct_node *root = NULL;
    if (!ct_yaml_read(ctx, path, &root))
        return false;
    if (root->kind != CT_NODE_MAP)
        return ct_error(
            ctx, root->mark, CT_E_SHAPE,
            "a tree file has the keys 'translation' and 'rotation', lists of branches");
    static const char *const keys[] = {"translation", "rotation"};
    bool ok = true;
    for (size_t i = 0; i < root->n; i++) {
        const struct ct_node_pair *p = &root->pair[i];
        if (strcmp(p->key, keys[0]) == 0) {
            ok &= read_branches(ctx, p->value, &f->trans, &f->trans_mark, &f->ntrans);
        } else if (strcmp(p->key, keys[1]) == 0) {
            ok &= read_branches(ctx, p->value, &f->rot, &f->rot_mark, &f->nrot);
        } else {
            ok = ct_error(ctx, p->mark, CT_E_KEY_UNKNOWN, "a tree file has no key '%s'%s",
                          p->key, ct_suggest_or_list(ctx->scratch, p->key, keys, COUNT(keys)));
        }
    }
    if (!ct_node_get(root, keys[0]))
        return ct_error(ctx, root->mark, CT_E_KEY_MISSING, "the tree file needs 'translation'");
    if (!ct_node_get(root, keys[1])) {
        f->rot = f->trans;
        f->rot_mark = f->trans_mark;
        f->nrot = f->ntrans;
    }
    return ok;
}

static bool choose_tree(struct ct_ctx *ctx, const char *tree, struct ct_formulate_options *f)
{
    static const char *const words[] = {"auto", "joints", "absolute"};
    static const enum ct_tree_choice choices[]
        = {CT_TREE_AUTO, CT_TREE_JOINTS, CT_TREE_ABSOLUTE};
    for (size_t i = 0; i < COUNT(words); i++)
        if (!tree || strcmp(tree, words[i]) == 0) {
            f->tree = choices[i];
            return true;
        }
    char *end;
    const long number = strtol(tree, &end, 10);
    if (!*end && number > 0 && number <= CT_MOST_CANDIDATES) {
        f->tree = CT_TREE_AUTO;
        f->pick = (int)number;
        return true;
    }
    f->tree = CT_TREE_GIVEN;
    FILE *file = fopen(tree, "r");
    if (file) {
        fclose(file);
        return read_tree_file(ctx, tree, f);
    }
    return ct_error(ctx, (struct ct_mark){0}, CT_E_USAGE,
                    "tree '%s' is neither auto, joints, absolute, a number from 1 to 10 nor a "
                    "file that can be read%s",
                    tree, ct_suggest(ctx->scratch, tree, words, COUNT(words)));
}

// ---- the pipeline -------------------------------------------------------------------------------

// The file `name`; or n bytes of text, whose file that would be.
struct source {
    const char *name, *text;
    size_t n;
};

static bool read_model(struct ct_system *s, const struct source *from,
                       const struct ct_system_options *o)
{
    const double start = ct_monotonic_time();
    struct ct_set *set = CT_NEWN(s->own.model, struct ct_set, o->nset + o->noutput + 1);
    size_t n = 0;
    for (size_t i = 0; i < o->nset; i++)
        set[n++].text = o->set[i];
    for (size_t i = 0; i < o->noutput; i++)
        set[n++] = (struct ct_set){o->output[i], CT_SET_OUTPUT};
    if (o->input)
        set[n++]
            = (struct ct_set){o->input, o->hold_input ? CT_SET_INPUTS_HELD : CT_SET_INPUTS};
    s->text = from->text ? ct_arena_strndup(s->own.model, from->text, from->n) : NULL;
    const bool ok
        = (s->text ? ct_model_parse(&s->own, ct_arena_strdup(s->own.model, from->name), s->text,
                                    from->n, set, n, &s->model)
                   : ct_model_read(&s->own, from->name, set, n, &s->model))
       && ct_model_change_beams(&s->own, &s->model, o->beam_elements, o->beam_formulation);
    ct_own_next_stage(&s->own);
    s->read = ct_monotonic_time() - start;
    return ok;
}

static bool formulate(struct ct_system *s, const struct ct_formulate_options *f,
                      struct ct_equations *out, struct ct_tree_report *report)
{
    const double start = ct_monotonic_time();
    const bool ok = ct_formulate(&s->own, s->own.model, &s->model, f, out, report);
    ct_own_next_stage(&s->own);
    s->generate += ct_monotonic_time() - start;
    return ok;
}

// Equations for beams that start in equilibrium.
static bool formulate_settled(struct ct_system *s, const struct ct_system_options *o)
{
    struct ct_tree_report unused;
    struct ct_formulate_options f
        = {.tree = CT_TREE_JOINTS,
           .first = ct_initial_equilibrium_fixed_joints(s->own.model, &s->model),
           .keep_all = o->keep_all,
           .held = true,
           .gaps = true,
           .measure_all = true,
           .measured_for = &s->equations,
           .deformed = true,
           .like = &s->equations};
    if (!formulate(s, &f, &s->held_equations, &unused))
        return false;
    f.held = f.gaps = false;
    f.without_dynamics = true;
    return s->held_equations.nrow == 0 || formulate(s, &f, &s->moving_equations, &unused);
}

// Of the motion, in coordinates of the chosen trees.
static struct ct_formulate_options options_of_motion(const struct ct_system_options *o)
{
    struct ct_formulate_options f = {.keep_all = o->keep_all,
                                     .with_energy = true,
                                     .with_outputs = true,
                                     .with_solution = true,
                                     .frees_beams = o->for_analysis,
                                     .for_analysis = o->for_analysis};
    f.more = o->columns == CT_COLUMNS_COORDINATES ? CT_MORE_COORDINATES
           : o->columns == CT_COLUMNS_EFFORTS     ? CT_MORE_EFFORTS
                                                  : CT_MORE_NONE;
    return f;
}

// Of the start, through joints: it must not depend on the trees of the motion.
static struct ct_formulate_options options_of_start(const struct ct_system *s,
                                                    const struct ct_system_options *o)
{
    return (struct ct_formulate_options){.tree = CT_TREE_JOINTS,
                                         .keep_all = o->keep_all,
                                         .frees_beams = o->for_analysis,
                                         .measure_all = true,
                                         .measured_for = &s->equations,
                                         .like = &s->equations,
                                         .without_dynamics = true};
}

// The pipeline. ct_formulate (formulate/formulate.c) tells how equations come about; what is done
// with them begins with ct_system_assemble, which finds consistent initial values.
static bool build(struct ct_system *s, const struct source *from,
                  const struct ct_system_options *o)
{
    struct ct_formulate_options motion = options_of_motion(o);
    const struct ct_formulate_options start = options_of_start(s, o);
    struct ct_tree_report unused;
    s->published = CT_NEW(s->own.model, struct ct_published);
    return choose_tree(&s->own, o->tree, &motion)         // which branches, if any are given
        && read_model(s, from, o)                         // text -> component instances
        && formulate(s, &motion, &s->equations, &s->tree) // equations of motion
        && formulate(s, &start, &s->start_equations,
                     &unused) // positions, to assemble the start
        && (!ct_initial_equilibrium_is_wanted(&s->model)
            || formulate_settled(s, o)); // statics, for beams that start in equilibrium
}

struct load {
    struct ct_system *s;
    struct source from;
    const struct ct_system_options *options;
};

static bool load(void *task)
{
    const struct load *l = task;
    return build(l->s, &l->from, l->options);
}

static struct ct_system *load_from(struct ct_ctx *ctx, const struct source *from,
                                   const struct ct_system_options *options)
{
    struct ct_system_options o;
    ct_options_take(&o, options, sizeof o);
    struct load l = {ct_own_alloc(ctx, sizeof *l.s), *from, &o};
    if (!l.s)
        return NULL;
    if (ct_own_enter(ctx, &l.s->own, load, &l))
        return l.s;
    ct_system_destroy(l.s);
    return NULL;
}

struct ct_system *ct_system_load(struct ct_ctx *ctx, const char *path,
                                 const struct ct_system_options *options)
{
    return ctx && path ? load_from(ctx, &(struct source){path, NULL, 0}, options) : NULL;
}

struct ct_system *ct_system_load_text(struct ct_ctx *ctx, const char *text, size_t n,
                                      const char *name, const struct ct_system_options *options)
{
    const struct source from = {name ? name : "model", text, n};
    return ctx && text ? load_from(ctx, &from, options) : NULL;
}

void ct_system_destroy(struct ct_system *sys)
{
    if (sys && sys->published)
        free(atomic_load(&sys->published->start));
    if (sys)
        ct_own_finish(&sys->own);
    free(sys);
}

struct ct_system *ct_system_borrow(struct ct_ctx *own, struct ct_system *sys)
{
    if (sys->is_private)
        return sys;
    struct ct_arena *a = own->model;
    struct ct_system *s = CT_NEW(a, struct ct_system);
    const struct ct_model *model = ct_model_fork(a, &sys->model);
    s->is_private = true;
    s->origin = sys;
    s->model = *model;
    s->tree = sys->tree;
    s->read = sys->read;
    s->generate = sys->generate;
    ct_equations_fork(own, a, &s->model, &sys->equations, &s->equations);
    ct_equations_fork(own, a, &s->model, &sys->start_equations, &s->start_equations);
    ct_equations_fork(own, a, &s->model, &sys->held_equations, &s->held_equations);
    ct_equations_fork(own, a, &s->model, &sys->moving_equations, &s->moving_equations);
    return s;
}

bool ct_system_assemble(struct ct_ctx *own, struct ct_system *sys,
                        struct ct_initial_state *start)
{
    if (!sys->held_equations.build) {
        const bool ok
            = ct_assembly_solve(own, own->model, &sys->model, &sys->start_equations, start);
        if (!ok)
            ct_note_misaligned_joint(own, own->model, &sys->model);
        return ok;
    }
    return ct_assembly_solve_open(own, own->model, &sys->model, &sys->start_equations, start)
        && ct_initial_equilibrium_solve(own, own->model, &sys->model, &sys->held_equations,
                                        &sys->moving_equations, start)
        && ct_start_meets_demands(own, start);
}

// ---- properties ---------------------------------------------------------------------------------

const char *ct_system_name(const struct ct_system *sys)
{
    if (!sys)
        return NULL;
    return sys->model.name;
}

size_t ct_system_column_count(const struct ct_system *sys)
{
    if (!sys)
        return 0;
    return sys->equations.nresult;
}

const char *ct_system_column(const struct ct_system *sys, size_t i)
{
    return sys && i < sys->equations.nresult ? sys->equations.result[i].name : NULL;
}

// ---- the graph ----------------------------------------------------------------------------------

static const char *node_name(void *data, int v)
{
    const struct ct_equations *e = data;
    return e->node_name[v];
}

static const char *edge_name(void *data, int i)
{
    const struct ct_equations *e = data;
    return e->edge_name[i];
}

static const char *edge_kind(void *data, int i)
{
    const struct ct_equations *e = data;
    return e->edge_kind[i];
}

struct drawing {
    struct ct_ctx *ctx, *own;
    struct ct_system *s;
    const char *format;
    FILE *out;
};

static bool draw(void *task)
{
    const struct drawing *d = task;
    struct ct_ctx *own = d->own;
    struct ct_equations *e = &ct_system_borrow(own, d->s)->equations;
    static const char *const formats[] = {"text", "dot", "json"};
    bool *quiet = CT_NEWN(own->scratch, bool, e->graph->nedge + 1);
    bool *marked = CT_NEWN(own->scratch, bool, e->graph->nedge + 1);
    for (int i = 0; i < e->graph->nedge; i++) {
        quiet[i] = ct_edge_is_rigid_arm(&e->build->topology->edge[i]);
        marked[i] = e->build->topology->edge[i].beam >= 0;
    }
    const struct ct_graph_names names = {.node = node_name,
                                         .edge = edge_name,
                                         .kind = edge_kind,
                                         .data = e,
                                         .weight_trans = e->weight_t,
                                         .weight_rot = e->weight_r,
                                         .is_quiet = quiet,
                                         .is_marked = marked};
    const struct ct_graph_view view = {e->graph, e->T, e->R, &names};
    const char *format = d->format ? d->format : formats[0];
    bool ok = true;
    if (strcmp(format, "text") == 0)
        ct_graph_print(d->out, own->scratch, &view);
    else if (strcmp(format, "dot") == 0)
        ct_graph_print_dot(d->out, &view);
    else if (strcmp(format, "json") == 0)
        ct_graph_print_json(d->out, own->scratch, &view);
    else
        ok = ct_error(d->ctx, (struct ct_mark){0}, CT_E_USAGE,
                      "a graph has no format '%s': text, dot or json", format);
    return ok;
}

bool ct_system_print_graph(struct ct_ctx *ctx, struct ct_system *sys, const char *format,
                           FILE *out)
{
    struct ct_ctx own = {0};
    struct drawing d = {ctx, &own, sys, format, out};
    const bool ok = ctx && sys && out && ct_own_enter(ctx, &own, draw, &d);
    ct_own_finish(&own);
    return ok;
}

static bool print_trees(void *task)
{
    const struct drawing *d = task;
    const struct ct_equations *e = &d->s->equations;
    const bool is_json = d->format && !strcmp(d->format, "json");
    if (d->format && !is_json && strcmp(d->format, "text") != 0)
        return ct_error(d->ctx, (struct ct_mark){0}, CT_E_USAGE,
                        "pairs of trees have no format '%s': text or json", d->format);
    (is_json ? ct_tree_pairs_print_json : ct_tree_pairs_print_text)(d->out, d->own->scratch, e,
                                                                    &d->s->tree);
    return true;
}

bool ct_system_print_trees(struct ct_ctx *ctx, struct ct_system *sys, const char *format,
                           FILE *out)
{
    struct ct_ctx own = {0};
    struct drawing d = {ctx, &own, sys, format, out};
    const bool ok = ctx && sys && out && ct_own_enter(ctx, &own, print_trees, &d);
    ct_own_finish(&own);
    return ok;
}

// ---- the equations ------------------------------------------------------------------------------

struct printing {
    struct ct_ctx *ctx, *own;
    struct ct_system *s;
    const char *stages, *format;
    bool is_full;
    FILE *out;
};

static bool wrong_word(struct ct_ctx *ctx, const char *what, const char *word, size_t n,
                       const char *const *words, size_t nword)
{
    const char *text = ct_arena_strndup(ctx->model, word, n);
    return ct_error(ctx, (struct ct_mark){0}, CT_E_USAGE, "equations have no %s '%s'%s", what,
                    text, ct_suggest_or_list(ctx->model, text, words, nword));
}

// Suffixes of files that are taken for formats.
static bool wrong_format(struct ct_ctx *ctx, const char *name, const char *const *formats,
                         size_t nformat)
{
    static const char *const suffix[][2] = {{"tex", "latex"}, {"txt", "text"}, {"htm", "html"}};
    for (size_t i = 0; i < COUNT(suffix); i++)
        if (!strcmp(name, suffix[i][0]))
            return ct_error(ctx, (struct ct_mark){0}, CT_E_USAGE,
                            "equations have no format '%s'; did you mean '%s'?", name,
                            suffix[i][1]);
    return wrong_word(ctx, "format", name, strlen(name), formats, nformat);
}

// A list of names, separated by commas.
static bool find_stages(struct ct_ctx *ctx, const char *text, unsigned *stages)
{
    static const char *const names[]
        = {"terminal", "graph", "tree", "cutset", "circuit", "reduced", "all"};
    bool ok = true;
    *stages = text ? 0 : CT_STAGE_DEFAULT;
    while (text) {
        const size_t n = strcspn(text, ",");
        const unsigned bit = ct_stage_find(text, n);
        if (!bit)
            ok = wrong_word(ctx, "stage", text, n, names, COUNT(names));
        *stages |= bit;
        text = text[n] ? text + n + 1 : NULL;
    }
    return ok;
}

static bool print_equations(void *task)
{
    const struct printing *p = task;
    static const char *const formats[] = {"text", "latex", "html", "c", "json"};
    const char *name = p->format ? p->format : formats[0];
    enum ct_equations_format format;
    unsigned stages;
    bool ok = find_stages(p->ctx, p->stages, &stages);
    if (!ct_equations_format_find(name, &format))
        ok = wrong_format(p->ctx, name, formats, COUNT(formats));
    if (!ok)
        return false;
    struct ct_system *s = ct_system_borrow(p->own, p->s);
    return ct_equations_print(p->out, p->own->scratch, &s->equations, &s->model, stages, format,
                              p->is_full)
        || ct_error(p->ctx, (struct ct_mark){0}, CT_E_FILE, "cannot write the equations");
}

static bool print_in_own(struct printing p)
{
    struct ct_ctx own = {0};
    p.own = &own;
    const bool ok = p.ctx && p.s && p.out && ct_own_enter(p.ctx, &own, print_equations, &p);
    ct_own_finish(&own);
    return ok;
}

bool ct_system_print_equations(struct ct_ctx *ctx, struct ct_system *sys, const char *stages,
                               const char *format, FILE *out)
{
    return print_in_own((struct printing){ctx, NULL, sys, stages, format, true, out});
}

bool ct_system_summarize_equations(struct ct_ctx *ctx, struct ct_system *sys,
                                   const char *stages, const char *format, FILE *out)
{
    return print_in_own((struct printing){ctx, NULL, sys, stages, format, false, out});
}

// ---- the same as texts --------------------------------------------------------------------------

static bool graph_into(void *task, FILE *out)
{
    const struct drawing *d = task;
    return ct_system_print_graph(d->ctx, d->s, d->format, out);
}

char *ct_system_graph(struct ct_ctx *ctx, struct ct_system *sys, const char *format)
{
    struct drawing d = {.ctx = ctx, .s = sys, .format = format};
    return ctx && sys ? ct_text_of(ctx, graph_into, &d) : NULL;
}

static bool equations_into(void *task, FILE *out)
{
    const struct printing *p = task;
    return ct_system_print_equations(p->ctx, p->s, p->stages, p->format, out);
}

char *ct_system_equations(struct ct_ctx *ctx, struct ct_system *sys, const char *stages,
                          const char *format)
{
    struct printing p = {.ctx = ctx, .s = sys, .stages = stages, .format = format};
    return ctx && sys ? ct_text_of(ctx, equations_into, &p) : NULL;
}
