// Read outputs and simulation options.
#include "component/read.h"

#include "component/roundoff.h"
#include "expr/parse.h"

#include <limits.h>
#include <math.h>
#include <string.h>

// ---- outputs -----------------------------------------------------------------------------------

static bool add_output(struct ct_reader *r, struct ct_output output, struct ct_names *names)
{
    struct ct_model *m = r->m;
    const int known = ct_names_get(names, output.name);
    if (known >= 0) {
        ct_error(r->ctx, output.mark, CT_E_NAME_TWICE, "the output '%s' is there twice",
                 output.name);
        ct_note(r->ctx, m->output[known].mark, "the first one is here");
        return false;
    }
    if (strcmp(output.name, "t") == 0)
        return ct_error(r->ctx, output.mark, CT_E_NAME,
                        "the first column is always called 't'");
    ct_names_put(r->ctx->scratch, names, output.name, (int)m->noutput);
    CT_PUSH(r->a, m->output, m->noutput, m->output_cap, output);
    return true;
}

static bool is_state_or_input(const struct ct_model *m, const char *name)
{
    const int i = ct_names_get(&m->parameter_index, name);
    return ct_names_get(&m->state_index, name) >= 0 || (i >= 0 && m->parameter[i].is_input);
}

static bool read_signal(struct ct_reader *r, const struct ct_node *node, struct ct_output *o)
{
    const char *normal;
    o->mark = node->mark;
    if (!ct_read_shape(r, node, CT_NODE_SCALAR, "a signal or {name: NAME, value: EXPRESSION}"))
        return false;
    if (is_state_or_input(r->m, node->text)) {
        o->name = ct_arena_strdup(r->a, node->text);
        return ct_read_expr(r, node, CT_KEY_STATE, NULL, &o->value);
    }
    if (!ct_parse_is_signal(r->ctx->scratch, node->text, &normal)) {
        if (ct_is_identifier(node->text) && ct_names_get(&r->component, node->text) >= 0)
            return ct_error(
                r->ctx, node->mark, CT_E_SIGNAL_NAME,
                "'%s' is no signal; say which of its quantities, as in %s.position.x or "
                "%s.q",
                node->text, node->text, node->text);
        return ct_error(
            r->ctx, node->mark, CT_E_SIGNAL_NAME,
            "'%s' is no signal; an expression is written {name: NAME, value: EXPRESSION}",
            node->text);
    }
    o->name = ct_arena_strdup(r->a, node->text);
    o->is_signal = true;
    return ct_read_expr(r, node, CT_KEY_STATE, NULL, &o->value);
}

static bool read_named(struct ct_reader *r, const struct ct_node *node, struct ct_output *o)
{
    static const char *const keys[] = {"name", "value"};
    bool ok = ct_read_keys(r, node, "an output", keys, COUNT(keys));
    const struct ct_node *name = ct_node_get(node, "name"), *value = ct_node_get(node, "value");
    if (!name || !value)
        return ct_error(r->ctx, node->mark, CT_E_KEY_MISSING, "the output needs '%s'",
                        name ? "value" : "name");
    ok &= ct_read_text(r, name, &o->name);
    o->mark = name->mark;
    if (ok && !o->name[0])
        ok = ct_error(r->ctx, name->mark, CT_E_NAME, "the name of an output cannot be empty");
    return ct_read_expr(r, value, CT_KEY_STATE, NULL, &o->value) && ok;
}

// Add outputs of the command line to those of the file.
static void read_more(struct ct_reader *r, const char *text, struct ct_names *names)
{
    const char *equals = strchr(text, '=');
    if (!equals || equals == text) {
        ct_error(r->ctx, (struct ct_mark){0}, CT_E_USAGE,
                 "the output '%s': NAME=EXPRESSION is wanted", text);
        return;
    }
    const struct ct_node value
        = {.kind = CT_NODE_SCALAR, .text = ct_arena_strdup(r->a, equals + 1), .is_plain = true};
    struct ct_output o = {.name = ct_arena_strndup(r->a, text, (size_t)(equals - text))};
    const size_t first = r->ctx->ndiagnostic;
    if (!ct_read_expr(r, &value, CT_KEY_STATE, NULL, &o.value) || !add_output(r, o, names))
        for (size_t i = first; i < r->ctx->ndiagnostic; i++)
            if (r->ctx->diagnostic[i].severity == CT_SEVERITY_ERROR)
                r->ctx->diagnostic[i].text = ct_arena_printf(r->a, "the output '%s': %s", text,
                                                             r->ctx->diagnostic[i].text);
}

static void read_list(struct ct_reader *r, struct ct_names *names)
{
    const struct ct_node *node = ct_node_get(r->root, "outputs");
    if (!node || ct_node_is_null(node)
        || !ct_read_shape(r, node, CT_NODE_LIST, "a list of outputs"))
        return;
    for (size_t i = 0; i < node->n; i++) {
        struct ct_output o = {0};
        const struct ct_node *item = node->item[i];
        if (item->kind == CT_NODE_MAP ? read_named(r, item, &o) : read_signal(r, item, &o))
            add_output(r, o, names);
    }
}

void ct_read_outputs(struct ct_reader *r)
{
    struct ct_names names = {0};
    read_list(r, &names);
    for (size_t i = 0; i < r->nset; i++)
        if (r->set[i].kind == CT_SET_OUTPUT)
            read_more(r, r->set[i].text, &names);
}

// ---- simulation --------------------------------------------------------------------------------

// Names of the methods; a unit test compares them with the table of integrators.
static const char *const methods[] = {"auto",
                                      "dopri5",
                                      "dop853",
                                      "rk4",
                                      "radau5",
                                      "generalized-alpha",
                                      "generalized-alpha-index3",
                                      "hht",
                                      "newmark"};

// Read a number that must be at least `least`, or greater.
static bool read_bounded(struct ct_reader *r, const struct ct_node *node, const char *key,
                         const char *unit, double least, bool strict, double *value)
{
    ct_ex e;
    if (!ct_read_expr(r, node, 0, unit, &e) || !ct_read_number(r, e, value))
        return false;
    if (*value > least || (!strict && *value == least))
        return true;
    return ct_error(r->ctx, node->mark, CT_E_RANGE, "'%s' is %g; it must be %s %g", key, *value,
                    strict ? "greater than" : "at least", least);
}

static bool read_optional(struct ct_reader *r, const struct ct_node *section, const char *key,
                          const char *unit, double *value)
{
    const struct ct_node *node = ct_node_get(section, key);
    return !node || read_bounded(r, node, key, unit, 0, true, value);
}

static const double most_samples = 1e9; // Limit: of a file, with a message

static bool read_samples(struct ct_reader *r, const struct ct_node *node,
                         struct ct_simulation *s)
{
    const bool at_rest = s->has_duration && s->duration == 0;
    double v;
    if (!read_bounded(r, node, "samples", "", at_rest ? 1 : 2, false, &v))
        return false;
    if (fabs(v - round(v)) > CT_DATA_ROUNDOFF * v)
        return ct_error(r->ctx, node->mark, CT_E_RANGE,
                        "'samples' is %g; it must be an integer", v);
    if (v > most_samples)
        return ct_error(r->ctx, node->mark, CT_E_RANGE,
                        "'samples' is %g; at most %g are possible", v, most_samples);
    s->samples = lround(v);
    return true;
}

static bool read_interval(struct ct_reader *r, const struct ct_node *node,
                          struct ct_simulation *s)
{
    if (!read_bounded(r, node, "interval", "s", 0, true, &s->interval))
        return false;
    // 10/0.01 may give 1000.0000000000001: this is not one more sample
    const double steps = ceil(s->duration / s->interval * (1 - CT_DATA_ROUNDOFF));
    if (!(steps < most_samples))
        return ct_error(r->ctx, node->mark, CT_E_RANGE,
                        "an 'interval' of %g s gives more than %g samples", s->interval,
                        most_samples);
    s->samples = (long)steps + 1;
    return true;
}

static bool read_sampling(struct ct_reader *r, const struct ct_node *node,
                          struct ct_simulation *s)
{
    const struct ct_node_pair *samples = ct_node_find(node, "samples"),
                              *interval = ct_node_find(node, "interval");
    if (samples && interval) {
        const struct ct_node_pair *second = samples > interval ? samples : interval;
        return ct_error(r->ctx, second->mark, CT_E_CONFLICT,
                        "give 'samples' or 'interval', not both");
    }
    if (samples)
        return read_samples(r, samples->value, s);
    return !interval || read_interval(r, interval->value, s);
}

// Check the name of a joint or a beam: a component that has coordinates.
static bool check_small(struct ct_reader *r, const char *name, struct ct_mark at)
{
    const int body = ct_model_find_body(r->m, name);
    if (body < 0)
        return ct_read_joint_name(r, name, at) >= 0;
    const struct ct_component_class *cls = r->m->body[body].instance.cls;
    return (body > 0 && !cls)
        || (cls && cls->body == CT_BODY_BEAM) // a component without class has been reported
        || ct_error(r->ctx, at, CT_E_JOINT, "'%s' is no beam; 'small' lists joints and beams",
                    name);
}

static bool read_small(struct ct_reader *r, const struct ct_node *node, struct ct_value *v)
{
    if (!ct_read_shape(r, node, CT_NODE_LIST, "a list of joints and beams"))
        return false;
    const char **name = CT_NEWN(r->a, const char *, node->n);
    bool ok = true;
    *v = (struct ct_value){.given = true, .mark = node->mark, .frame = -1, .name = name};
    v->at = CT_NEWN(r->a, struct ct_mark, node->n);
    for (size_t i = 0; i < node->n; i++) {
        v->at[i] = node->item[i]->mark;
        if (!ct_read_text(r, node->item[i], &name[i])) {
            ok = false;
            continue;
        }
        ok &= check_small(r, name[i], v->at[i]);
    }
    v->n = node->n;
    return ok;
}

static void read_words(struct ct_reader *r, const struct ct_node *node, struct ct_simulation *s)
{
    static const char *const jumps[] = {"impulse", "continuous"};
    const struct ct_node *method = ct_node_get(node, "method"),
                         *rate_jumps = ct_node_get(node, "rate_jumps");
    if (method) {
        const int i = ct_read_word(r, method, "method", methods, COUNT(methods));
        s->method = i >= 0 ? methods[i] : "auto";
        s->method_mark = method->mark;
    }
    if (rate_jumps && ct_read_word(r, rate_jumps, "choice", jumps, COUNT(jumps)) == 1)
        s->rate_jumps = CT_RATE_CONTINUOUS;
}

void ct_read_simulation(struct ct_reader *r)
{
    static const char *const keys[]
        = {"duration", "samples", "interval",   "tolerance", "absolute",
           "method",   "step",    "rate_jumps", "small"};
    struct ct_simulation *s = &r->m->simulation;
    // Definition: the defaults of docs/format.md
    *s = (struct ct_simulation){.samples = 1001, .rtol = 1e-8, .method = "auto"};
    s->small.frame = -1;
    s->mark = (struct ct_mark){r->m->file, 0, 0};
    const struct ct_node_pair *p = ct_node_find(r->root, "simulation");
    const struct ct_node *node = p && !ct_node_is_null(p->value) ? p->value : NULL;
    if (p)
        s->mark = p->mark;
    if (node && ct_read_shape(r, node, CT_NODE_MAP, "a map of keys")) {
        ct_read_keys(r, node, "'simulation'", keys, COUNT(keys));
        const struct ct_node *duration = ct_node_get(node, "duration");
        if (duration)
            s->has_duration
                = read_bounded(r, duration, "duration", "s", 0, false, &s->duration);
        read_sampling(r, node, s);
        read_optional(r, node, "tolerance", "", &s->rtol);
        read_optional(r, node, "step", "s", &s->step);
        read_words(r, node, s);
        if (ct_node_get(node, "small"))
            read_small(r, ct_node_get(node, "small"), &s->small);
    }
    s->atol = s->rtol / 100;
    read_optional(r, node, "absolute", "", &s->atol);
}
