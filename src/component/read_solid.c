// Shapes of bodies: {box: [a, b, c]}, {cylinder: [radius, length], axis: z}, {sphere: r}, {lines:
// [[x, y, z], ...]}, {file: part.stl, scale: 1}, each with `at`, `rotate`, `color`; or a list of
// them.
#include "component/read.h"
#include "component/read_stl.h"

#include <string.h>

static const char *const kinds[CT_NSOLID] = {"box", "cylinder", "sphere", "lines", "file"};

static const char wanted_shape[]
    = "a shape ({box: [a, b, c]}, {cylinder: [radius, length]}, {sphere: radius}, {lines: "
      "[[x, y, z], ...]} or {file: FILE.stl}) or a list of them";

// ---- colours ----------------------------------------------------------------------------------

#define COLOR(name, value) #name,
static const char *const colour_names[] = {
#include "component/colors.def"
};
#undef COLOR
#define COLOR(name, value) value,
static const char *const colour_values[COUNT(colour_names)] = {
#include "component/colors.def"
};
#undef COLOR

// Convert "#rgb" to "#rrggbb" and copy "#rrggbb"; NULL for any other text.
static const char *read_digits(struct ct_arena *a, const char *text)
{
    const size_t n = strlen(text);
    if (text[0] != '#' || (n != 4 && n != 7)
        || strspn(text + 1, "0123456789abcdefABCDEF") != n - 1)
        return NULL;
    if (n == 7)
        return ct_arena_strdup(a, text);
    return ct_arena_printf(a, "#%c%c%c%c%c%c", text[1], text[1], text[2], text[2], text[3],
                           text[3]);
}

static bool read_color(struct ct_reader *r, const struct ct_node *node, const char **color)
{
    if (!ct_read_shape(r, node, CT_NODE_SCALAR, "a colour: a name, or \"#rrggbb\""))
        return false;
    for (size_t i = 0; i < COUNT(colour_names); i++)
        if (strcmp(node->text, colour_names[i]) == 0)
            *color = colour_values[i];
    if (!*color)
        *color = read_digits(r->a, node->text);
    if (*color)
        return true;
    const char *near = ct_read_suggestion(r, node->text, colour_names, COUNT(colour_names));
    return ct_error(r->ctx, node->mark, CT_E_WORD, "unknown colour '%s'%s", node->text,
                    *near ? near : "; a name of CSS, or \"#rrggbb\" in quotes, is wanted");
}

// ---- sizes ------------------------------------------------------------------------------------

static bool check_positive(struct ct_reader *r, const struct ct_node *node, const char *what,
                           ct_ex e)
{
    double v;
    if (!ct_read_number(r, e, &v) || v > 0)
        return true;
    return ct_error(r->ctx, node->mark, CT_E_RANGE, "%s is %g; it must be greater than 0", what,
                    v);
}

static bool read_size(struct ct_reader *r, const struct ct_node *node, const char *what,
                      ct_ex *size)
{
    return ct_read_expr(r, node, 0, "m", size) && check_positive(r, node, what, *size);
}

static bool read_sizes(struct ct_reader *r, const struct ct_node *node, size_t n,
                       const char *wanted, const char *const *what, ct_ex *size)
{
    if (!ct_read_list(r, node, n, n, wanted))
        return false;
    bool ok = true;
    for (size_t i = 0; i < n; i++)
        ok &= read_size(r, node->item[i], what[i], &size[i]);
    return ok;
}

static bool read_lines(struct ct_reader *r, const struct ct_node *node, struct ct_solid *s)
{
    enum { MOST = 100000 }; // Limit: with a message
    if (!ct_read_list(r, node, 2, MOST, "a list of at least two points [x, y, z]"))
        return false;
    s->npoint = node->n;
    s->point = CT_NEWN(r->a, ct_ex3, node->n);
    bool ok = true;
    for (size_t i = 0; i < node->n; i++)
        ok &= ct_read_vec3(r, node->item[i], 0, "m", &s->point[i], NULL);
    return ok;
}

static bool read_file(struct ct_reader *r, const struct ct_node *node, struct ct_solid *s)
{
    const char *name;
    return ct_read_text(r, node, &name)
        && ct_stl_read(r->ctx, r->a, ct_read_path_beside(r, name), node->mark, &s->triangle,
                       &s->ntriangle);
}

static bool read_kind(struct ct_reader *r, const struct ct_node *node, struct ct_solid *s)
{
    static const char *const edges[] = {
        "the first edge of the box", "the second edge of the box", "the third edge of the box"};
    static const char *const of_cylinder[]
        = {"the radius of the cylinder", "the length of the cylinder"};
    switch (s->kind) {
    case CT_SOLID_BOX:
        return read_sizes(r, node, 3, "a list of 3 edges [a, b, c]", edges, s->size);
    case CT_SOLID_CYLINDER:
        return read_sizes(r, node, 2, "[radius, length]", of_cylinder, s->size);
    case CT_SOLID_SPHERE:
        return read_size(r, node, "the radius of the sphere", &s->size[0]);
    case CT_SOLID_LINES:
        return read_lines(r, node, s);
    case CT_SOLID_FILE:
        return read_file(r, node, s);
    case CT_NSOLID:
        break;
    }
    return false;
}

// ---- one shape --------------------------------------------------------------------------------

// Find the one key that names the kind of shape. is_wanted: report if it is missing; otherwise
// another key may be a misspelling of it.
static bool find_kind(struct ct_reader *r, const struct ct_node *node, bool is_wanted,
                      struct ct_solid *s)
{
    const struct ct_node_pair *found = NULL;
    bool ok = true;
    for (size_t i = 0; i < node->n; i++)
        for (int k = 0; k < CT_NSOLID; k++) {
            if (strcmp(node->pair[i].key, kinds[k]) != 0)
                continue;
            if (found)
                ok = ct_error(
                    r->ctx, node->pair[i].mark, CT_E_CONFLICT,
                    "a shape is one thing, not both '%s' and '%s'; a list has several",
                    found->key, kinds[k]);
            found = &node->pair[i];
            s->kind = (enum ct_solid_kind)k;
        }
    if (!found)
        return is_wanted
            && ct_error(r->ctx, node->mark, CT_E_KEY_MISSING,
                        "a shape needs 'box', 'cylinder', 'sphere', 'lines' or 'file'");
    return ok;
}

static bool check_belongs(struct ct_reader *r, const struct ct_node *node,
                          const struct ct_solid *s, const char *key, enum ct_solid_kind kind)
{
    const struct ct_node_pair *p = ct_node_find(node, key);
    if (!p || s->kind == kind)
        return true;
    return ct_error(r->ctx, p->mark, CT_E_CONFLICT, "'%s' is for a '%s', not for a '%s'", key,
                    kinds[kind], kinds[s->kind]);
}

static bool read_solid(struct ct_reader *r, const char *owner, const struct ct_node *node,
                       struct ct_solid *s)
{
    static const char *const keys[] = {"box",  "cylinder", "sphere", "lines",  "file",
                                       "axis", "scale",    "at",     "rotate", "color"};
    *s = (struct ct_solid){.mark = node->mark, .scale = CT_EX_ONE};
    s->at = s->axis = (ct_ex3){{CT_EX_ZERO, CT_EX_ZERO, CT_EX_ZERO}};
    s->axis.e[2] = CT_EX_ONE;
    if (!ct_read_shape(r, node, CT_NODE_MAP, wanted_shape))
        return false;
    const char *what = ct_arena_printf(r->ctx->scratch, "a shape of body '%s'", owner);
    bool ok = ct_read_keys(r, node, what, keys, COUNT(keys));
    const bool is_known = find_kind(r, node, ok, s);
    if (is_known) {
        ok &= read_kind(r, ct_node_get(node, kinds[s->kind]), s);
        ok &= check_belongs(r, node, s, "axis", CT_SOLID_CYLINDER);
        ok &= check_belongs(r, node, s, "scale", CT_SOLID_FILE);
    }
    const struct ct_node *axis = ct_node_get(node, "axis"), *scale = ct_node_get(node, "scale"),
                         *at = ct_node_get(node, "at"), *rotate = ct_node_get(node, "rotate"),
                         *color = ct_node_get(node, "color");
    if (axis)
        ok &= ct_read_axis(r, axis, &s->axis);
    if (scale)
        ok &= ct_read_expr(r, scale, 0, "", &s->scale)
           && check_positive(r, scale, "the scale", s->scale);
    if (at)
        ok &= ct_read_vec3(r, at, 0, "m", &s->at, NULL);
    if (rotate)
        ok &= ct_read_rotations(r, rotate, 0, &s->turn, &s->nturn);
    if (color)
        ok &= read_color(r, color, &s->color);
    return ok && is_known;
}

bool ct_read_solids(struct ct_reader *r, struct ct_body *b, const struct ct_node *node)
{
    const struct ct_node *shape = ct_node_get(node, "shape");
    if (!shape || ct_node_is_null(shape))
        return true;
    const bool is_list = shape->kind == CT_NODE_LIST;
    const size_t n = is_list ? shape->n : 1;
    struct ct_solid *solid = CT_NEWN(r->a, struct ct_solid, n + 1);
    bool ok = true;
    for (size_t i = 0; i < n; i++)
        ok &= read_solid(r, b->instance.name, is_list ? shape->item[i] : shape, &solid[i]);
    b->solid = solid;
    b->nsolid = ok ? n : 0;
    return ok;
}
