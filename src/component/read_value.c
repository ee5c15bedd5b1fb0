// Read values by kind: from a node of the file to checked expressions.
#include "component/read.h"

#include "expr/parse.h"
#include "expr/unit.h"

#include <math.h>
#include <string.h>

// ---- directions and rotations ------------------------------------------------------------------

static bool normalise(struct ct_reader *r, const struct ct_node *node, ct_ex3 *axis)
{
    struct ct_exs *x = r->m->x;
    double v[3];
    bool constant = true;
    for (int i = 0; i < 3; i++) {
        double c;
        constant &= ct_ex_is_const(x, axis->e[i], &c);
        if (!ct_read_number(r, axis->e[i], &v[i]))
            return true; // a wrong parameter, which has been reported
    }
    // scaled, to avoid overflow and underflow of squares
    const double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (largest == 0)
        return ct_error(r->ctx, node->mark, CT_E_AXIS,
                        "the axis has no direction: all of it is 0");
    if (constant) {
        for (int i = 0; i < 3; i++)
            v[i] /= largest;
        const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        for (int i = 0; i < 3; i++)
            axis->e[i] = ct_ex_const(x, v[i] / length);
        return true;
    }
    const ct_ex length = ct_ex_fun(x, CT_OP_SQRT, ct_ex3_dot(x, *axis, *axis));
    for (int i = 0; i < 3; i++)
        axis->e[i] = ct_ex_div(x, axis->e[i], length);
    return true;
}

bool ct_read_axis(struct ct_reader *r, const struct ct_node *node, ct_ex3 *axis)
{
    *axis = (ct_ex3){{CT_EX_ZERO, CT_EX_ZERO, CT_EX_ZERO}};
    if (node->kind == CT_NODE_SCALAR && !ct_node_is_null(node)) {
        static const char *const names[] = {"x", "y", "z"};
        const int i = ct_read_word(r, node, "axis", names, COUNT(names));
        if (i >= 0)
            axis->e[i] = CT_EX_ONE;
        return i >= 0;
    }
    if (!ct_read_list(r, node, 3, 3, "x, y, z or a list of 3"))
        return false;
    return ct_read_vec3(r, node, 0, NULL, axis, NULL) && normalise(r, node, axis);
}

static bool read_turn(struct ct_reader *r, const struct ct_node *node, unsigned flags,
                      struct ct_turn *turn)
{
    if (!ct_read_list(r, node, 2, 2, "[axis, angle]"))
        return false;
    const bool ok = ct_read_axis(r, node->item[0], &turn->axis);
    return ct_read_expr(r, node->item[1], flags, "rad", &turn->angle) && ok;
}

// [z, a] is one rotation, [[z, a], [x, b]] are two; an axis may be a list itself, an angle never
static bool is_one_turn(const struct ct_node *node)
{
    return node->n == 0 || node->item[0]->kind != CT_NODE_LIST
        || (node->n == 2 && node->item[1]->kind != CT_NODE_LIST);
}

bool ct_read_rotations(struct ct_reader *r, const struct ct_node *node, unsigned flags,
                       struct ct_turn **turn, size_t *nturn)
{
    enum { MOST = 1000 }; // Limit: with a message
    *nturn = 0;
    *turn = NULL;
    if (!ct_read_list(r, node, 1, MOST, "[axis, angle] or a list of such"))
        return false;
    const bool one = is_one_turn(node);
    const size_t n = one ? 1 : node->n;
    *turn = CT_NEWN(r->a, struct ct_turn, n);
    *nturn = n;
    bool ok = true;
    for (size_t i = 0; i < n; i++)
        ok &= read_turn(r, one ? node : node->item[i], flags, &(*turn)[i]);
    return ok;
}

// ---- a value of any kind -----------------------------------------------------------------------

static bool read_scalar(struct ct_reader *r, const struct ct_node *node,
                        const struct ct_key *key, struct ct_value *v)
{
    ct_read_alloc(r, v, 1);
    v->at[0] = node->mark;
    return ct_read_expr(r, node, key->flags, key->unit, &v->e[0]);
}

static bool read_list(struct ct_reader *r, const struct ct_node *node, const struct ct_key *key,
                      struct ct_value *v)
{
    if (node->kind != CT_NODE_LIST && key->least <= 1)
        return read_scalar(r, node, key, v);
    const char *wanted
        = key->least == key->most
            ? ct_arena_printf(r->ctx->scratch, "a list of %d", key->most)
            : ct_arena_printf(r->ctx->scratch, "a list of %d to %d", key->least, key->most);
    if (!ct_read_list(r, node, (size_t)key->least, (size_t)key->most, wanted))
        return false;
    return ct_read_items(r, node, key, v);
}

// Check unit vectors a and b (6 numbers) for being parallel, by |a x b|^2 = 1 - (a.b)^2, which has
// a round-off of some eps.
static bool check_crossed(struct ct_reader *r, const struct ct_value *v)
{
    double u[6], c = 0;
    for (int i = 0; i < 6; i++)
        if (!ct_read_number(r, v->e[i], &u[i]))
            return true;
    for (int i = 0; i < 3; i++)
        c += u[i] * u[3 + i];
    // Derived: axes given with six digits have an angle of 1e-6, whose square is 1e-12; round-off
    // is about 1e-15
    if (1 - c * c > 1e-12)
        return true;
    return ct_error(r->ctx, v->mark, CT_E_AXIS, "the two axes are parallel");
}

static bool read_axes(struct ct_reader *r, const struct ct_node *node, size_t n,
                      struct ct_value *v)
{
    ct_read_alloc(r, v, 3 * n);
    if (n == 2 && !ct_read_list(r, node, 2, 2, "a list of two axes"))
        return false;
    bool ok = true;
    for (size_t k = 0; k < n; k++) {
        const struct ct_node *one = n == 1 ? node : node->item[k];
        ct_ex3 axis;
        ok &= ct_read_axis(r, one, &axis);
        for (size_t i = 0; i < 3; i++) {
            v->e[3 * k + i] = axis.e[i];
            v->at[3 * k + i] = one->mark;
        }
    }
    return ok && (n == 1 || check_crossed(r, v));
}

static bool read_texts(struct ct_reader *r, const struct ct_node *node,
                       const struct ct_key *key, const char *wanted, struct ct_value *v)
{
    if (!ct_read_list(r, node, (size_t)key->least, (size_t)key->most, wanted))
        return false;
    const char **name = CT_NEWN(r->a, const char *, node->n);
    ct_read_alloc(r, v, node->n);
    v->name = name;
    bool ok = true;
    for (size_t i = 0; i < node->n; i++) {
        v->at[i] = node->item[i]->mark;
        name[i] = ""; // not named
        ok &= ct_read_text(r, node->item[i], &name[i]);
    }
    return ok;
}

// Read names of coordinates: new names, visible in the joint's own expressions only.
static bool read_new_names(struct ct_reader *r, const struct ct_node *node,
                           const struct ct_key *key, struct ct_value *v)
{
    if (!read_texts(r, node, key, "a list of names", v))
        return false;
    bool ok = true;
    for (size_t i = 0; i < v->n; i++) {
        if (!ct_read_name(r, v->name[i], v->at[i], "coordinate")) {
            ok = false;
            continue;
        }
        if (ct_is_reserved(v->name[i]))
            ok = ct_error(r->ctx, v->at[i], CT_E_NAME,
                          "'%s' cannot name a coordinate: it has a meaning in expressions",
                          v->name[i]);
        if (ct_names_get(&r->m->parameter_index, v->name[i]) >= 0)
            ok = ct_error(r->ctx, v->at[i], CT_E_NAME_TWICE,
                          "the coordinate '%s' has the name of a parameter", v->name[i]);
        if (ct_names_get(&r->m->state_index, v->name[i]) >= 0)
            ok = ct_error(r->ctx, v->at[i], CT_E_NAME_TWICE,
                          "the coordinate '%s' has the name of a state", v->name[i]);
        for (size_t k = 0; k < i; k++)
            if (strcmp(v->name[i], v->name[k]) == 0)
                ok = ct_error(r->ctx, v->at[i], CT_E_NAME_TWICE,
                              "the coordinate '%s' is there twice", v->name[i]);
    }
    return ok;
}

static bool read_choice(struct ct_reader *r, const struct ct_node *node,
                        const struct ct_key *key, struct ct_value *v)
{
    size_t n;
    const char *const *word = ct_key_choices(r->ctx->scratch, key, &n);
    v->count = ct_read_word(r, node, key->name, word, n);
    return v->count >= 0;
}

static bool read_choices(struct ct_reader *r, const struct ct_node *node,
                         const struct ct_key *key, struct ct_value *v)
{
    size_t n;
    const char *const *word = ct_key_choices(r->ctx->scratch, key, &n);
    if (node->kind == CT_NODE_SCALAR && strcmp(node->text, "auto") == 0) {
        v->given = false;
        return true;
    }
    if (!ct_read_shape(
            r, node, CT_NODE_LIST,
            ct_arena_printf(r->ctx->scratch, "'auto' or a list of words (%s, ...)", word[0])))
        return false;
    bool ok = true;
    for (size_t i = 0; i < node->n; i++) {
        const int k = ct_read_word(r, node->item[i], key->name, word, n);
        if (k >= 0 && v->count & 1L << k)
            ok = ct_error(r->ctx, node->item[i]->mark, CT_E_NAME_TWICE, "'%s' is there twice",
                          word[k]);
        else if (k >= 0)
            v->count |= 1L << k;
        ok &= k >= 0;
    }
    return ok;
}

bool ct_read_value(struct ct_reader *r, const struct ct_node *node, const struct ct_key *key,
                   struct ct_value *v)
{
    v->given = true;
    v->mark = node->mark;
    switch (key->kind) {
    case CT_VALUE_SCALAR:
        return read_scalar(r, node, key, v);
    case CT_VALUE_VEC3: {
        ct_ex3 e;
        ct_read_alloc(r, v, 3);
        const bool ok = ct_read_vec3(r, node, key->flags, key->unit, &e, v->at);
        for (int i = 0; i < 3; i++)
            v->e[i] = e.e[i];
        return ok;
    }
    case CT_VALUE_LIST:
        return read_list(r, node, key, v);
    case CT_VALUE_AXIS:
        return read_axes(r, node, 1, v);
    case CT_VALUE_AXES:
        return read_axes(r, node, 2, v);
    case CT_VALUE_TURNS:
        if (node->kind == CT_NODE_LIST && node->n == 0 && key->least == 0)
            return true;
        return ct_read_rotations(r, node, key->flags, &v->turn, &v->nturn);
    case CT_VALUE_FRAME:
        return ct_read_frame(r, node, &v->frame);
    case CT_VALUE_NAMES:
        return read_new_names(r, node, key, v);
    case CT_VALUE_JOINTS:
        return read_texts(r, node, key, "a list of two joints", v);
    case CT_VALUE_WORD:
        return read_choice(r, node, key, v);
    case CT_VALUE_WORDS:
        return read_choices(r, node, key, v);
    case CT_VALUE_COUNT:
        return ct_read_count(r, node, key->name, key->least, &v->count);
    case CT_VALUE_ELEMENTS:
    case CT_VALUE_ROTARY:
    case CT_VALUE_RAYLEIGH:
    case CT_VALUE_SHAPES:
    case CT_VALUE_FIELDS:
        return ct_read_beam_value(r, node, key, v);
    case CT_VALUE_POINTS:  // read_body.c
    case CT_VALUE_PLACES:  // read_body.c
    case CT_VALUE_SOLIDS:  // read_solid.c
    case CT_VALUE_COORDS:  // read_joint.c
    case CT_VALUE_INITIAL: // read_joint.c
        break;
    }
    return true;
}
