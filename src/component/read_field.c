// Read fields along a beam: `shapes`, and deflections and rates of `initial`.
#include "component/read.h"

#include "expr/quadrature.h"

#include <math.h>
#include <string.h>

static const char *const field_name[CT_BEAM_NFIELD] = {"u", "v", "w", "rx"};
static const char *const rate_name[CT_BEAM_NFIELD] = {"u'", "v'", "w'", "rx'"};
static const char *const unit[] = {"m", "rad", "m/s", "rad/s"};

// ---- text --------------------------------------------------------------------------------------

static void add(struct ct_value *v, const char **name, const char *own, struct ct_mark at,
                ct_ex e)
{
    name[v->n] = own;
    v->at[v->n] = at;
    v->e[v->n++] = e;
}

// Read entries u v w rx of a map, each one expression or a list of them.
static bool read_entries(struct ct_reader *r, const struct ct_node *node, unsigned flags,
                         bool is_list, bool is_rate, struct ct_value *v, const char **name)
{
    bool ok = true;
    for (int k = 0; k < CT_BEAM_NFIELD; k++) {
        const struct ct_node *item = ct_node_get(node, field_name[k]);
        const char *own = is_rate ? rate_name[k] : field_name[k],
                   *dimension = is_list ? NULL : unit[2 * is_rate + (k == CT_BEAM_FIELD_RX)];
        if (!item)
            continue;
        const bool several = is_list && item->kind == CT_NODE_LIST;
        for (size_t i = 0; i < (several ? item->n : 1); i++) {
            const struct ct_node *one = several ? item->item[i] : item;
            ct_ex e = CT_EX_ZERO;
            ok &= ct_read_expr(r, one, flags, dimension, &e);
            if (is_list || !ct_ex_is_zero(e))
                add(v, name, own, one->mark, e);
        }
    }
    return ok;
}

static size_t count_of(const struct ct_node *node)
{
    size_t n = 0;
    for (int k = 0; k < CT_BEAM_NFIELD; k++) {
        const struct ct_node *item = ct_node_get(node, field_name[k]);
        n += item ? item->kind == CT_NODE_LIST ? item->n : 1 : 0;
    }
    return n;
}

static bool read_shapes(struct ct_reader *r, const struct ct_node *node,
                        const struct ct_key *key, struct ct_value *v)
{
    if (!ct_read_shape(r, node, CT_NODE_MAP, "{v: [expressions of x], ...}"))
        return false;
    bool ok = ct_read_keys(r, node, "'shapes' of a beam", field_name, CT_BEAM_NFIELD);
    const size_t n = count_of(node);
    const char **name = CT_NEWN(r->a, const char *, n + 1);
    ct_read_alloc(r, v, n);
    v->n = 0;
    v->name = name;
    ok &= read_entries(r, node, key->flags, true, false, v, name);
    return ok
        && (v->n
            || ct_error(r->ctx, node->mark, CT_E_RANGE,
                        "'shapes' has none; give expressions of x for u, v, w or rx"));
}

bool ct_read_fields(struct ct_reader *r, const struct ct_node *node, const struct ct_key *key,
                    struct ct_value *v)
{
    static const char *const words[] = {"equilibrium"}, *const keys[]
                                                        = {"u", "v", "w", "rx", "rates"};
    if (key->kind == CT_VALUE_SHAPES)
        return read_shapes(r, node, key, v);
    if (node->kind == CT_NODE_SCALAR) {
        v->count = ct_read_word(r, node, key->name, words, COUNT(words)) == 0;
        return v->count == 1;
    }
    if (!ct_read_shape(r, node, CT_NODE_MAP, "'equilibrium' or {v: an expression of x, ...}"))
        return false;
    const char **name = CT_NEWN(r->a, const char *, 2 * CT_BEAM_NFIELD);
    const struct ct_node *rates = ct_node_get(node, "rates");
    bool ok = ct_read_keys(r, node, "'initial' of a beam", keys, COUNT(keys));
    ct_read_alloc(r, v, 2 * CT_BEAM_NFIELD);
    v->n = 0;
    v->name = name;
    ok &= read_entries(r, node, key->flags, false, false, v, name);
    if (!rates || !ok)
        return ok;
    return ct_read_shape(r, rates, CT_NODE_MAP, "{v: an expression of x, ...}")
        && ct_read_keys(r, rates, "'rates' of a beam", field_name, CT_BEAM_NFIELD)
        && read_entries(r, rates, key->flags, false, true, v, name);
}

// ---- the frame ---------------------------------------------------------------------------------

struct field_check {
    struct ct_reader *r;
    const struct ct_instance *self;
    const struct ct_beam *beam;
    const struct ct_beam_given *g;
    double *value; // of all symbols
    double length;
};

static double field_at(const struct field_check *c, ct_ex e, double place)
{
    c->value[ct_ex_node(c->r->m->x, c->beam->x)->a] = place;
    return ct_ex_value(c->r->m->x, e, c->value);
}

// Largest value of a field inside and at the ends; not finite if one value is not.
static double size_of(const struct field_check *c, ct_ex e)
{
    enum {
        PLACES = 33
    }; // Limit: sample points for the largest value, which only serves as a scale
    double most = 0;
    for (int i = 0; i < PLACES; i++) {
        const double v = fabs(field_at(c, e, c->length * i / (PLACES - 1)));
        most = v > most || isnan(v) ? v : most;
        if (isnan(most))
            break;
    }
    return most;
}

static bool vanishes_at(const struct field_check *c, ct_ex e, double size, double place,
                        const char *what, enum ct_code code)
{
    // Derived: coefficients given with ten digits leave up to 1e-9 where a shape should vanish
    const double roundoff = 1e-9, v = field_at(c, e, place);
    if (fabs(v) <= roundoff * size)
        return true;
    return ct_error(c->r->ctx, c->g->mark, code,
                    "body '%s': the %s of this is %g at x = %g m, where the beam's frame "
                    "('frame: %s') holds it at 0",
                    c->self->name, what, v, place, c->beam->is_chord ? "chord" : "clamped");
}

static bool check_field(const struct field_check *c, enum ct_code code)
{
    const ct_ex e = c->g->value, slope = ct_ex_diff(c->r->m->x, e, c->beam->x);
    const bool across = c->g->kind == CT_BEAM_FIELD_V || c->g->kind == CT_BEAM_FIELD_W;
    const double size = size_of(c, e), steep = size_of(c, slope);
    if (!isfinite(size) || !isfinite(steep))
        return ct_error(c->r->ctx, c->g->mark, CT_E_RANGE,
                        "body '%s': this has no finite value and slope all along the beam",
                        c->self->name);
    bool ok = vanishes_at(c, e, size, 0, "value", code);
    if (across && c->beam->is_chord)
        ok &= vanishes_at(c, e, size, c->length, "value", code);
    else if (across)
        ok &= vanishes_at(c, slope, fmax(steep, size / c->length), 0, "slope", code);
    return ok;
}

// ---- filling -----------------------------------------------------------------------------------

static const struct ct_beam_given *take(struct ct_reader *r, const struct ct_value *v, int *n)
{
    struct ct_beam_given *out = CT_NEWN(r->a, struct ct_beam_given, v->n + 1);
    *n = (int)v->n;
    for (size_t i = 0; i < v->n; i++) {
        out[i] = (struct ct_beam_given){.value = v->e[i], .mark = v->at[i]};
        for (int k = 0; k < CT_BEAM_NFIELD; k++) {
            out[i].is_rate |= !strcmp(v->name[i], rate_name[k]);
            if (!strcmp(v->name[i], field_name[k]) || !strcmp(v->name[i], rate_name[k]))
                out[i].kind = (enum ct_beam_field)k;
        }
    }
    return out;
}

static bool check_keys(struct ct_reader *r, const struct ct_instance *self,
                       const struct ct_beam *beam)
{
    const struct ct_value *shapes = ct_instance_value(self, "shapes");
    if (!shapes->given)
        return true;
    if (beam->modes)
        return ct_error(r->ctx, shapes->mark, CT_E_CONFLICT,
                        "body '%s': give 'modes' or 'shapes', not both", self->name);
    if (beam->theory == CT_BEAM_TIMOSHENKO)
        return ct_error(r->ctx, shapes->mark, CT_E_CONFLICT,
                        "body '%s': 'shapes' are of the axis, whose slope the sections follow; "
                        "leave 'theory: timoshenko' out",
                        self->name);
    return true;
}

bool ct_fill_fields(struct ct_reader *r, const struct ct_instance *self, struct ct_beam *beam)
{
    struct field_check c = {.r = r, .self = self, .beam = beam};
    beam->shape = take(r, ct_instance_value(self, "shapes"), &beam->nshape);
    beam->start = take(r, ct_instance_value(self, "initial"), &beam->nstart);
    bool ok = check_keys(r, self, beam);
    if (!r->parameters_ok || !ct_read_number(r, beam->length, &c.length))
        return ok;
    c.value = CT_NEWN(r->ctx->scratch, double, r->m->x->nsym);
    memcpy(c.value, r->m->value, (1 + r->m->nparameter) * sizeof *c.value);
    for (int i = 0; i < beam->nshape + beam->nstart; i++) {
        const bool is_shape = i < beam->nshape;
        c.g = is_shape ? &beam->shape[i] : &beam->start[i - beam->nshape];
        ok &= check_field(&c, is_shape ? CT_E_CONFLICT : CT_E_INITIAL);
    }
    return ok;
}
