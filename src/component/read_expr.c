// Read expressions, and resolve names in them: parameters, signals, frames.
#include "component/read.h"

#include "base/pi.h"
#include "component/roundoff.h"
#include "expr/parse.h"
#include "expr/unit.h"

#include <math.h>
#include <string.h>

// ---- frames ------------------------------------------------------------------------------------

static const char *nearest_frame(struct ct_reader *r, const char *name)
{
    if (!ct_read_wants_suggestions(r))
        return "";
    const char **names = CT_NEWN(r->ctx->scratch, const char *, r->m->nframe);
    for (size_t i = 0; i < r->m->nframe; i++)
        names[i] = r->m->frame[i].name;
    return ct_read_suggestion(r, name, names, r->m->nframe);
}

static bool check_frame(struct ct_reader *r, const char *name, struct ct_mark at)
{
    if (ct_model_find_frame(r->m, name) >= 0)
        return true;
    const char *dot = strchr(name, '.');
    const char *body
        = dot ? ct_arena_strndup(r->ctx->scratch, name, (size_t)(dot - name)) : name;
    if (dot && ct_model_find_body(r->m, body) >= 0)
        return ct_error(r->ctx, at, CT_E_FRAME, "body '%s' has no point '%s'%s", body, dot + 1,
                        nearest_frame(r, name));
    return ct_error(r->ctx, at, CT_E_FRAME, "there is no frame '%s'%s", name,
                    nearest_frame(r, name));
}

bool ct_read_frame(struct ct_reader *r, const struct ct_node *node, int *frame)
{
    *frame = -1;
    if (!ct_read_shape(r, node, CT_NODE_SCALAR, "the name of a frame")
        || !check_frame(r, node->text, node->mark))
        return false;
    *frame = ct_model_find_frame(r->m, node->text);
    return true;
}

// ---- expressions -------------------------------------------------------------------------------

// The symbol of a signal; one per signal.
static ct_ex signal_symbol(struct ct_reader *r, const char *text, struct ct_mark at)
{
    const int known = ct_names_get(&r->signal, text);
    if (known >= 0)
        return (ct_ex){(uint32_t)known};
    const char *name = ct_arena_strdup(r->a, text);
    const ct_ex e = ct_ex_sym(r->m->x, CT_SYM_SIGNAL, name, (uint32_t)r->signal.n);
    r->m->x->sym[ct_ex_node(r->m->x, e)->a].mark = at;
    ct_names_put(r->ctx->scratch, &r->signal, name, (int)e.id);
    return e;
}

// In its own expressions a custom joint uses the names of its coordinates: in its motion they are
// the arguments, in its efforts they mean J.q1 and so on.
static bool find_joint_coordinate(struct ct_reader *r, const char *name, ct_ex *e,
                                  const char **why, enum ct_name_result *result)
{
    const struct ct_instance *custom = r->local_of;
    for (int i = 0; custom && i < custom->ncoord; i++) {
        if (strcmp(r->local_name[i], name) != 0)
            continue;
        *result = CT_NAME_OK;
        if (r->flags & CT_KEY_LOCAL) {
            *e = custom->local[i];
        } else if (r->flags & CT_KEY_STATE) {
            *e = signal_symbol(r, ct_arena_printf(r->a, "%s.q%d", custom->name, i + 1),
                               custom->mark);
        } else {
            *why = "it changes with the motion of the joint, this value does not";
            *result = CT_NAME_FORBIDDEN;
        }
        return true;
    }
    return false;
}

// In its section and its points a beam uses its `length`, in its section also the position `x`;
// there these names hide parameters.
static bool find_beam_name(struct ct_reader *r, const char *name, ct_ex *e, const char **why,
                           enum ct_name_result *result)
{
    if (!r->beam)
        return false;
    const bool is_x = strcmp(name, "x") == 0;
    if (!is_x && strcmp(name, "length") != 0)
        return false;
    if (is_x && r->flags & CT_KEY_SECTION) {
        *e = r->beam_x;
        *result = CT_NAME_OK;
        return true;
    }
    if (!is_x && r->flags & (CT_KEY_LENGTH | CT_KEY_SECTION)) {
        const struct ct_value *length = ct_instance_value(r->beam, "length");
        const bool known = length->n && !ct_ex_is_zero(length->e[0]);
        *e = known ? length->e[0] : CT_EX_ONE; // a wrong length has been reported
        *result = CT_NAME_OK;
        return true;
    }
    *why = is_x ? "only what belongs to the section changes along a beam"
                : "elements, section and points of the beam know it";
    *result = CT_NAME_FORBIDDEN;
    return ct_names_get(&r->m->parameter_index, name) < 0;
}

static enum ct_name_result find_name(void *user, const char *name, ct_ex *e, const char **why)
{
    struct ct_reader *r = user;
    enum ct_name_result result;
    if (find_joint_coordinate(r, name, e, why, &result)
        || find_beam_name(r, name, e, why, &result))
        return result;
    if (strcmp(name, "t") == 0) {
        *e = r->m->time;
        *why = "this value is constant in time";
        return r->flags & (CT_KEY_TIME | CT_KEY_STATE) ? CT_NAME_OK : CT_NAME_FORBIDDEN;
    }
    const int i = ct_names_get(&r->m->parameter_index, name);
    const int state = ct_names_get(&r->m->state_index, name);
    if (state >= 0) {
        *e = signal_symbol(r, name, r->m->state[state].mark);
        *why = r->flags & CT_KEY_TIME ? "it is a state, and this is a function of time alone"
                                      : "it is a state, and this value is constant";
        return r->flags & CT_KEY_STATE ? CT_NAME_OK : CT_NAME_FORBIDDEN;
    }
    if (i < 0)
        return CT_NAME_UNKNOWN;
    *e = r->m->parameter[i].symbol;
    if (r->m->parameter[i].is_played) {
        *e = r->m->parameter[i].played;
        *why = "a file plays this input, and the value is constant in time";
        return r->flags & (CT_KEY_TIME | CT_KEY_STATE) ? CT_NAME_OK : CT_NAME_FORBIDDEN;
    }
    return CT_NAME_OK;
}

// Does something exist that signals can be about, with this first part?
static bool signal_exists(const struct ct_reader *r, const char *first)
{
    static const char *const own[] = {"system", "energy", "constraint"};
    for (size_t i = 0; i < COUNT(own); i++)
        if (strcmp(own[i], first) == 0)
            return true;
    return ct_model_find_body(r->m, first) >= 0 || ct_names_get(&r->component, first) >= 0;
}

static const char *nearest_subject(struct ct_reader *r, const char *first)
{
    if (!ct_read_wants_suggestions(r))
        return "";
    const char **names = CT_NEWN(r->ctx->scratch, const char *, r->ncomponent + 4);
    size_t n = r->ncomponent;
    for (size_t i = 0; i < r->component.size; i++) // inserted in the order of the file
        if (r->component.slot[i].name)
            names[r->component.slot[i].index] = r->component.slot[i].name;
    names[n++] = "ground";
    names[n++] = "system";
    names[n++] = "energy";
    names[n++] = "constraint";
    return ct_read_suggestion(r, first, names, n);
}

// Does the point in BODY.POINT.PROPERTY or BODY.POINT.PROPERTY.COMPONENT exist? Components have one
// or two letters.
static bool point_exists(struct ct_reader *r, const char *text, struct ct_mark where)
{
    const char *const dot = strchr(text, '.'), *const next = dot ? strchr(dot + 1, '.') : NULL;
    if (!next || strcspn(next + 1, ". ") < 3)
        return true;
    const char *const body = ct_arena_strndup(r->ctx->scratch, text, (size_t)(dot - text));
    const char *const frame = ct_arena_strndup(r->ctx->scratch, text, (size_t)(next - text));
    return ct_model_find_body(r->m, body) < 0 || check_frame(r, frame, where);
}

static enum ct_name_result find_signal(void *user, const char *text, const char *first,
                                       const char *in, struct ct_mark where,
                                       struct ct_mark where_in, ct_ex *e, const char **why)
{
    struct ct_reader *r = user;
    if (!(r->flags & CT_KEY_STATE)) {
        *why = r->flags & CT_KEY_TIME
                 ? "this is a function of time alone"
                 : "this value is constant; signals are known in forces, efforts and outputs";
        return CT_NAME_FORBIDDEN;
    }
    bool ok = true;
    if (!signal_exists(r, first))
        ok = ct_error(r->ctx, where, CT_E_SIGNAL_NAME,
                      "'%s': there is no body, joint or force '%s'%s", text, first,
                      nearest_subject(r, first));
    else if (!point_exists(r, text, where))
        ok = false;
    if (in && !check_frame(r, in, where_in))
        ok = false;
    if (!ok)
        return CT_NAME_REPORTED;
    *e = signal_symbol(r, text, where);
    return CT_NAME_OK;
}

bool ct_read_number(struct ct_reader *r, ct_ex e, double *value)
{
    if (ct_ex_is_const(r->m->x, e, value))
        return true;
    const unsigned kinds = ct_ex_kinds(r->m->x, e);
    if (kinds & ~(1u << CT_SYM_PARAM))
        return false;
    *value = ct_ex_value(r->m->x, e, r->m->value);
    return !kinds || r->parameters_ok
        || isfinite(*value); // otherwise a wrong parameter may be the cause
}

static bool is_same_dimension(const char *a, const char *b)
{
    struct ct_unit u, v;
    size_t at;
    return ct_unit_parse(a, strlen(a), &u, &at) != CT_UNIT_OK
        || ct_unit_parse(b, strlen(b), &v, &at) != CT_UNIT_OK || ct_unit_same(&u, &v);
}

// Check the unit of a parameter alone, or with a minus sign: it has the dimension in which it was
// given. The dimension of other expressions is unknown.
static bool check_parameter_unit(struct ct_reader *r, const struct ct_node *node,
                                 const char *unit, ct_ex e)
{
    const struct ct_exnode *top = ct_ex_node(r->m->x, e);
    if (top->op == CT_OP_NEG)
        e.id = top->a;
    const struct ct_sym *s = ct_ex_symbol(r->m->x, e);
    const bool is_parameter = s && s->kind == CT_SYM_PARAM;
    const int i = is_parameter ? ct_names_get(&r->m->parameter_index, s->name) : -1;
    const struct ct_parameter *p = i < 0 ? NULL : &r->m->parameter[i];
    if (!unit || !p || !p->unit || is_same_dimension(p->unit, unit))
        return true;
    if (*unit)
        ct_error(r->ctx, node->mark, CT_E_DIMENSION,
                 "the parameter '%s' is in %s, but a quantity in %s is wanted here", p->name,
                 p->unit, unit);
    else
        ct_error(r->ctx, node->mark, CT_E_DIMENSION,
                 "the parameter '%s' is in %s, but a number without a unit is wanted here",
                 p->name, p->unit);
    ct_note(r->ctx, p->mark, "it is given here");
    return false;
}

const double ct_read_full_turn = 2 * CT_PI; // Definition: [rad]

// Warn of angles that are probably in degrees: a number beyond a full turn without a unit, or a
// parameter with such a value that is an integer, as no multiple of pi is.
static void check_degrees(struct ct_reader *r, const struct ct_node *node, ct_ex e)
{
    double value;
    const char *rest, *text = node->text + strspn(node->text, " +-");
    const struct ct_sym *s = ct_ex_symbol(r->m->x, e);
    const int i
        = s && s->kind == CT_SYM_PARAM ? ct_names_get(&r->m->parameter_index, s->name) : -1;
    if (!ct_read_number(r, e, &value) || !(fabs(value) > ct_read_full_turn))
        return;
    const size_t length = ct_number_parse(text, &(double){0});
    rest = text + length + strspn(text + length, " ");
    const bool is_bare = length && !*rest;
    const bool is_whole = i >= 0 && !r->m->parameter[i].unit && value == floor(value);
    if (is_bare || is_whole)
        ct_warning(r->ctx, node->mark, CT_E_DEGREES,
                   "the angle %s is %g radians, %.3g turns: write \"%g deg\" if degrees are "
                   "meant, \"%g rad\" if not",
                   node->text, value, fabs(value) / ct_read_full_turn, value, value);
}

bool ct_read_expr(struct ct_reader *r, const struct ct_node *node, unsigned flags,
                  const char *unit, ct_ex *e)
{
    *e = CT_EX_ZERO;
    if (node->kind == CT_NODE_MAP && ct_node_get(node, "table")) {
        if (flags & (CT_KEY_TIME | CT_KEY_STATE))
            return ct_read_table(r, node, unit, e);
        return ct_error(r->ctx, node->mark, CT_E_NOT_HERE,
                        "a table cannot be used here: this value is constant in time");
    }
    if (!ct_read_shape(r, node, CT_NODE_SCALAR, "a number or an expression"))
        return false;
    r->flags = flags;
    const struct ct_scope scope = {.x = r->m->x,
                                   .user = r,
                                   .name = find_name,
                                   .signal = find_signal,
                                   .known = r->known,
                                   .nknown = r->nknown,
                                   .unit = unit};
    const struct ct_text text
        = {node->text, node->mark, node->is_exact, node->is_plain ? 0 : 1};
    if (!ct_parse(r->ctx, &scope, text, e)) {
        *e = CT_EX_ZERO; // not the valid part before the error
        return false;
    }
    double value;
    if (ct_read_number(r, *e, &value) && !isfinite(value))
        return ct_error(r->ctx, node->mark, CT_E_NUMBER, "'%s' is not a finite number",
                        node->text);
    if (unit && strcmp(unit, "rad") == 0)
        check_degrees(r, node, *e);
    return check_parameter_unit(r, node, unit, *e);
}

bool ct_read_vec3(struct ct_reader *r, const struct ct_node *node, unsigned flags,
                  const char *unit, ct_ex3 *v, struct ct_mark at[3])
{
    *v = (ct_ex3){{CT_EX_ZERO, CT_EX_ZERO, CT_EX_ZERO}};
    if (!ct_read_list(r, node, 3, 3, "a list of 3"))
        return false;
    bool ok = true;
    for (int i = 0; i < 3; i++) {
        ok &= ct_read_expr(r, node->item[i], flags, unit, &v->e[i]);
        if (at)
            at[i] = node->item[i]->mark;
    }
    return ok;
}

void ct_read_alloc(struct ct_reader *r, struct ct_value *v, size_t n)
{
    v->n = n;
    v->e = CT_NEWN(r->a, ct_ex, n);
    v->at = CT_NEWN(r->a, struct ct_mark, n);
    for (size_t i = 0; i < n; i++)
        v->e[i] = CT_EX_ZERO;
}

bool ct_read_items(struct ct_reader *r, const struct ct_node *node, const struct ct_key *key,
                   struct ct_value *v)
{
    ct_read_alloc(r, v, node->n);
    bool ok = true;
    for (size_t i = 0; i < node->n; i++) {
        v->at[i] = node->item[i]->mark;
        ok &= ct_read_expr(r, node->item[i], key->flags, key->unit, &v->e[i]);
    }
    return ok;
}

// Read a count, which determines the structure of the equations: the parameters in it are recorded.
static bool read_structural_number(struct ct_reader *r, ct_ex e, double *v)
{
    struct ct_model *m = r->m;
    if (!m->decided) {
        m->x->ndecided = m->x->nsym;
        m->decided = CT_NEWN(r->a, unsigned char, m->x->nsym);
    }
    m->x->decided = m->decided;
    const bool ok = ct_read_number(r, e, v);
    m->x->decided = NULL;
    return ok;
}

bool ct_read_count(struct ct_reader *r, const struct ct_node *node, const char *name,
                   long least, long *count)
{
    enum { MOST = 10000 }; // Limit: with a message
    ct_ex e;
    double v;
    *count = least;
    if (!ct_read_expr(r, node, 0, "", &e) || !read_structural_number(r, e, &v))
        return false;
    if (fabs(v - round(v)) > CT_DATA_ROUNDOFF * fabs(v))
        return ct_error(r->ctx, node->mark, CT_E_RANGE, "'%s' is %g; it must be an integer",
                        name, v);
    if (!(v > (double)least - 0.5 && v <= MOST))
        return ct_error(r->ctx, node->mark, CT_E_RANGE, "'%s' is %g; it must be %ld to %d",
                        name, v, least, MOST);
    *count = lround(v);
    return true;
}
