// The trees, and the resulting unknowns, drivers and constraint rows.
#include "report/derivation.h"

#include "formulate/beam/flexible_body.h"

#include <string.h>

// ---- branches and chords -------------------------------------------------------------------

static const char *role(struct ct_derivation *d, const struct ct_tree *t, const int *weight,
                        int e, bool is_in)
{
    if (!is_in)
        return "-";
    return ct_arena_printf(d->a, "%s (%d)", t->is_branch[e] ? "branch" : "chord ", weight[e]);
}

static void put_trees(struct ct_derivation *d)
{
    const struct ct_equations *e = d->e;
    const struct ct_build *b = e->build;
    int narm = 0;
    ct_page_table(&d->page, "rllllll");
    CT_PAGE_ROW(&d->page, "#", "component", "type", "from", "to", "translation", "rotation");
    for (int i = 0; i < e->graph->nedge; i++) {
        const struct ct_edge *w = &e->graph->edge[i];
        if (b->topology->edge[i].kind == CT_EDGE_ARM) {
            narm++;
            continue;
        }
        const bool force = b->topology->edge[i].kind == CT_EDGE_FORCE;
        CT_PAGE_ROW(&d->page, ct_arena_printf(d->a, "%d", i + 1), e->edge_name[i],
                    e->edge_kind[i], e->node_name[w->tail], e->node_name[w->head],
                    force ? "chord" : role(d, e->T, e->weight_t, i, true),
                    force ? "chord"
                          : role(d, e->R, e->weight_r, i, b->topology->edge[i].has_rotation));
    }
    ct_page_sentence(&d->page, "in brackets: the unknowns an edge adds as a branch%s",
                     narm ? "; arms are branches of both trees" : "");
}

// ---- coordinates ---------------------------------------------------------------------------

static const struct ct_coordinate *coordinate_of(const struct ct_equations *e, int q)
{
    for (size_t i = 0; i < e->ncoordinate; i++)
        if (e->coordinate[i].q == q)
            return &e->coordinate[i];
    return NULL;
}

static const struct ct_measure *measure_of(const struct ct_equations *e,
                                           const struct ct_coordinate *c)
{
    const struct ct_motion *m = e->build->kinematics->edge[c->edge].motion;
    const int k = m->quaternion >= 0 && c->index > m->quaternion ? m->quaternion : c->index;
    return k < m->nmeasure ? &m->measure[k] : NULL;
}

static const char *meaning_of(struct ct_derivation *d, const struct ct_coordinate *c,
                              const char **unit)
{
    const struct ct_edge_info *e = &d->e->build->topology->edge[c->edge];
    const struct ct_measure *m = measure_of(d->e, c);
    const char *what = e->kind == CT_EDGE_BODY
                         ? ct_arena_printf(d->a, "%s %s",
                                           d->m->body[e->index].beam ? "beam" : "body", e->name)
                         : ct_arena_printf(d->a, "%s joint %s", e->self->cls->name, e->name);
    *unit = "m";
    if (!m) {
        *unit = c->in_rotation ? "rad" : "m";
        return ct_arena_printf(d->a, "coordinate %d of %s", c->index + 1, what);
    }
    if (m->kind == CT_MEASURE_QUATERNION) {
        *unit = "";
        return ct_arena_printf(d->a, "orientation of %s, unit quaternion, scalar first", what);
    }
    if (m->kind == CT_MEASURE_ANGLE) {
        *unit = "rad";
        return ct_arena_printf(d->a, "angle of %s about %s", what,
                               ct_derivation_axis(d, m->about));
    }
    if (e->kind == CT_EDGE_BODY && d->m->body[e->index].beam)
        return ct_arena_printf(d->a, "position of the frame of beam %s along %s", e->name,
                               ct_derivation_axis(d, m->along));
    return e->kind == CT_EDGE_BODY
             ? ct_arena_printf(d->a, "position of the centre of mass of %s along %s", what,
                               ct_derivation_axis(d, m->along))
             : ct_arena_printf(d->a, "displacement of %s along %s", what,
                               ct_derivation_axis(d, m->along));
}

// "rod.2.rx": of node 2 of beam rod; "rod.2.rm": in its element 2; "rod.v1", "rod.mode1": of
// the whole beam.
static const char *elastic_meaning(struct ct_derivation *d, const char *name, int body,
                                   const char **unit)
{
    const char *beam = d->m->body[body].instance.name;
    const char *node = name + strlen(beam) + 1, *kind = strrchr(name, '.') + 1;
    const bool turns = *kind == 'r';
    const struct ct_flexible *f = ct_flexible_of(d->e->build, body);
    const bool stretches = *kind == 'u' && f->kinematics == CT_AXIAL_CHAIN;
    *unit = turns ? "rad" : "m";
    if (kind == node)
        return ct_arena_printf(d->a, "amplitude of %s%s of %s", f->beam->nshape ? "shape " : "",
                               node, beam);
    if (kind[1] == 'm')
        return ct_arena_printf(
            d->a, "%s in the middle of element %.*s of %s, beyond the mean of its ends",
            turns ? "twist" : "stretch", (int)strcspn(node, "."), node, beam);
    if (stretches)
        return ct_arena_printf(d->a, "stretch of %s up to node %.*s", beam,
                               (int)strcspn(node, "."), node);
    return ct_arena_printf(d->a, "%s of node %.*s of %s %s %c",
                           turns ? "rotation" : "displacement", (int)strcspn(node, "."), node,
                           beam, turns ? "about" : "along",
                           turns ? kind[1] : (char)('x' + (*kind - 'u')));
}

static void put_unknowns(struct ct_derivation *d)
{
    const struct ct_equations *e = d->e;
    if (!e->nq)
        return;
    ct_page_heading(&d->page, "unknown coordinates");
    ct_page_table(&d->page, "LLll");
    CT_PAGE_ROW(&d->page, "coordinate", "speed", "unit", "meaning");
    for (size_t i = 0; i < e->nmotion; i++) {
        const struct ct_u *u = &e->u[i];
        const char *unit;
        const char *speed = ct_derivation_text(d, u->symbol);
        if (u->beam) {
            const char *meaning = elastic_meaning(d, e->q[u->q].name, u->beam, &unit);
            CT_PAGE_ROW(&d->page, ct_derivation_text(d, e->q[u->q].symbol), speed, unit,
                        meaning);
        } else if (u->q >= 0) {
            const char *meaning = meaning_of(d, coordinate_of(e, u->q), &unit);
            CT_PAGE_ROW(&d->page, ct_derivation_text(d, e->q[u->q].symbol), speed, unit,
                        meaning);
        } else {
            const char *of = u->joint >= 0 ? d->m->joint[u->joint].name
                                           : d->m->body[u->body].instance.name;
            CT_PAGE_ROW(&d->page, "", speed, "rad/s",
                        ct_arena_printf(d->a, "angular velocity of %s in its own axes", of));
        }
    }
    for (size_t i = 0; i < e->nq; i++)
        if (e->q[i].quaternion == 0) {
            const char *unit, *meaning = meaning_of(d, coordinate_of(e, (int)i), &unit);
            const char *last = strrchr(e->q[i + 3].name, '.');
            CT_PAGE_ROW(
                &d->page,
                ct_derivation_is_latex(d)
                    ? ct_derivation_text(d, e->q[i].symbol)
                    : ct_arena_printf(d->a, "%s..%s", e->q[i].name, last ? last + 1 : ""),
                "", "", meaning);
        }
}

static void put_states(struct ct_derivation *d)
{
    const struct ct_model *m = d->m;
    if (!m->nstate)
        return;
    ct_page_heading(&d->page, "states");
    ct_page_table(&d->page, "LlL");
    CT_PAGE_ROW(&d->page, "state", "unit", "starts at");
    for (size_t i = 0; i < m->nstate; i++)
        CT_PAGE_ROW(&d->page, ct_derivation_name(d, m->state[i].name),
                    m->state[i].unit ? m->state[i].unit : "",
                    ct_derivation_text(d, m->state[i].initial));
}

static void put_drivers(struct ct_derivation *d)
{
    const struct ct_equations *e = d->e;
    if (!e->ndriver)
        return;
    ct_page_heading(&d->page, "driven coordinates");
    ct_page_equations(&d->page);
    for (size_t i = 0; i < e->ndriver; i++)
        ct_page_equation(&d->page, NULL, ct_derivation_name(d, e->driver[i].name),
                         ct_derivation_text(d, e->driver[i].value), NULL);
}

static void put_dependent(struct ct_derivation *d)
{
    const struct ct_equations *e = d->e;
    const char **name = CT_NEWN(d->a, const char *, e->ncoordinate + 1);
    struct ct_growing_text list = {0};
    size_t n = 0;
    for (size_t i = 0; i < e->ncoordinate; i++) {
        const struct ct_coordinate *c = &e->coordinate[i];
        if (c->q >= 0 || c->driver >= 0
            || e->build->topology->edge[c->edge].kind != CT_EDGE_JOINT)
            continue;
        name[n++] = c->name;
    }
    for (size_t i = 0; i < n; i++) {
        const enum ct_shown shown = ct_page_shown(&d->page, i, n);
        if (shown == CT_LEFT_OUT)
            continue;
        ct_derivation_append(d, &list, i ? ", " : "");
        ct_derivation_append(d, &list, shown == CT_SHOWN ? name[i] : "...");
    }
    if (n)
        ct_page_sentence(&d->page, "joint coordinates that follow from these by circuits: %s",
                         list.at);
}

// ---- rows ----------------------------------------------------------------------------------

static const char *row_meaning(const char *name, const char **unit)
{
    const char *part = strrchr(name, '.');
    *unit = "N";
    if (!part) {
        *unit = "";
        return "the coordinates keep their ratio";
    }
    part++;
    if (!strncmp(part, "across", 6))
        return "no displacement across the axis";
    if (!strcmp(part, "length"))
        return "the distance is kept";
    if (strlen(part) == 1 || (part[0] == 'e' && strlen(part) == 2)) // x, y, z; e1, e2
        return "the origins coincide along this axis";
    *unit = "N*m";
    if (!strcmp(part, "angle"))
        return "the angle is kept";
    if (!strncmp(part, "turn", 4))
        return "two axes keep their angle";
    *unit = "";
    return "the motion is prescribed";
}

static void put_rows(struct ct_derivation *d)
{
    const struct ct_equations *e = d->e;
    if (!e->nrow)
        return;
    ct_page_heading(&d->page, "constraint rows of the chords");
    ct_page_table(&d->page, "lLll");
    CT_PAGE_ROW(&d->page, "row", "multiplier", "unit", "meaning");
    for (size_t i = 0; i < e->nrow; i++) {
        const char *unit, *meaning = row_meaning(e->row[i].name, &unit);
        CT_PAGE_ROW(&d->page, e->row[i].name, ct_derivation_text(d, e->row[i].lam), unit,
                    meaning);
    }
}

static void put_left_out(struct ct_derivation *d)
{
    const struct ct_equations *e = d->e;
    if (!e->nleft_out)
        return;
    ct_page_heading(&d->page, "left out");
    for (size_t i = 0; i < e->nleft_out; i++)
        ct_page_sentence(&d->page, "%s: %s", e->left_out[i].what, e->left_out[i].why);
}

void ct_stage_tree(struct ct_derivation *d)
{
    ct_page_title(&d->page, "Trees");
    if (d->e->how)
        ct_page_sentence(&d->page, "chosen: %s", d->e->how);
    put_trees(d);
    put_unknowns(d);
    put_states(d);
    put_dependent(d);
    put_drivers(d);
    put_rows(d);
    put_left_out(d);
}
