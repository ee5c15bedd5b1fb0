// Read points of bodies: position and orientation in the body frame; on beams, along their axis.
#include "component/read.h"

#include "component/roundoff.h"

// A point of a beam rotates with the section at its position, which must lie on the beam.
static bool check_on_beam(struct ct_reader *r, const struct ct_frame *f, struct ct_mark at)
{
    const struct ct_value *length = ct_instance_value(r->beam, "length");
    double x, l;
    if (!length->n || !ct_read_number(r, length->e[0], &l) || !(l > 0)
        || !ct_read_number(r, f->at.e[0], &x))
        return true; // reported before
    const double roundoff = CT_DATA_ROUNDOFF * l;
    if (x >= -roundoff && x <= l + roundoff)
        return true;
    return ct_error(r->ctx, at, CT_E_RANGE,
                    "point '%s' is at x = %g m, the beam reaches from 0 to %g m", f->name, x,
                    l);
}

// Read [x, y, z]; on a beam also x alone.
static bool read_place(struct ct_reader *r, const struct ct_node *node, struct ct_frame *f)
{
    if (!r->beam)
        return ct_read_vec3(r, node, 0, "m", &f->at, NULL);
    const struct ct_node *along = node->kind == CT_NODE_LIST && node->n ? node->item[0] : node;
    const bool ok = node->kind == CT_NODE_LIST
                      ? ct_read_vec3(r, node, CT_KEY_LENGTH, "m", &f->at, NULL)
                      : ct_read_expr(r, node, CT_KEY_LENGTH, "m", &f->at.e[0]);
    return ok && check_on_beam(r, f, along->mark);
}

static bool read_point(struct ct_reader *r, const struct ct_node *node, struct ct_frame *f)
{
    static const char *const keys[] = {"at", "rotate"};
    if (node->kind == CT_NODE_LIST
        || (r->beam && node->kind == CT_NODE_SCALAR && !ct_node_is_null(node)))
        return read_place(r, node, f);
    const char *what = ct_arena_printf(r->ctx->scratch, "point '%s'", f->name);
    if (!ct_read_shape(r, node, CT_NODE_MAP,
                       r->beam ? "a place along the beam, [x, y, z] or {at: PLACE, rotate: "
                                 "[axis, angle]}"
                               : "[x, y, z] or {at: [x, y, z], rotate: [axis, angle]}"))
        return false;
    bool ok = ct_read_keys(r, node, what, keys, COUNT(keys));
    const struct ct_node *at = ct_node_get(node, "at"), *rotate = ct_node_get(node, "rotate");
    if (at)
        ok &= read_place(r, at, f);
    if (rotate) {
        size_t n;
        ok &= ct_read_rotations(r, rotate, 0, &f->turn, &n);
        f->nturn = (int)n;
    }
    if (!at && !rotate)
        ok = ct_error(r->ctx, f->mark, CT_E_KEY_MISSING, "%s needs 'at'", what);
    return ok;
}

bool ct_read_points(struct ct_reader *r, const struct ct_body *b, const struct ct_node *node)
{
    const struct ct_node *points = ct_node_get(node, "points");
    if (!points || ct_node_is_null(points))
        return true;
    if (!ct_read_shape(r, points, CT_NODE_MAP, "a map of points"))
        return false;
    bool ok = true;
    for (size_t i = 0; i < points->n; i++) {
        const char *name
            = ct_arena_printf(r->ctx->scratch, "%s.%s", b->instance.name, points->pair[i].key);
        const int f = ct_model_find_frame(r->m, name);
        ok &= f >= 0 && read_point(r, points->pair[i].value, &r->m->frame[f]);
    }
    return ok;
}
