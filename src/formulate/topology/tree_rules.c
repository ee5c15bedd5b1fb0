// See tree_selection.h: rules for branches and chords, and the order among equal weights.
#include "formulate/topology/tree_selection.h"

#include "base/sort.h"
#include "formulate/beam/section_properties.h"
#include "graph/reach.h"

#include <string.h>

// Distance of each node from ground along possible branches, as number of edges or of rotational
// degrees of freedom.
static int *node_depths(struct ct_build *b, bool by_rotation)
{
    int *depth = CT_NEWN(b->arena, int, b->topology->nnode),
        *length = CT_NEWN(b->arena, int, b->topology->nedge);
    bool *usable = CT_NEWN(b->arena, bool, b->topology->nedge);
    for (size_t e = 0; e < b->topology->nedge; e++) {
        usable[e]
            = b->topology->edge[e].kind != CT_EDGE_BODY && !b->topology->edge[e].never_branch;
        length[e] = by_rotation ? b->topology->edge[e].weight_r : 1;
    }
    ct_graph_distances(b->arena, &b->topology->graph, usable, length,
                       (int)b->topology->nnode * CT_MAX_COORD, depth);
    return depth;
}

// Is an end of the edge at a beam section whose rotation may be condensed statically because it has
// no inertia? Such a rotation depends on all nodes of the beam, so that a body attached there fills
// the mass matrix. The start of a clamped beam is fixed.
static bool rotates_condensed_section(const struct ct_build *b, size_t i)
{
    const int end[2] = {b->topology->wiring[i].tail, b->topology->wiring[i].head};
    for (int k = 0; k < 2; k++) {
        const struct ct_flexible *f = ct_flexible_of(b, b->topology->node[end[k]].body);
        if (f && (f->beam->is_chord || end[k] != f->base)
            && (f->beam->is_lumped || f->beam->theory == CT_BEAM_TIMOSHENKO)
            && (ct_ex_is_zero(ct_flexible_rotary(f, 1).value)
                || ct_ex_is_zero(ct_flexible_rotary(f, 2).value)))
            return true;
    }
    return false;
}

// Do the possible branches contain no loop, and is no joint always a chord?
static bool is_without_loops(const struct ct_build *b)
{
    int *weight = CT_NEWN(b->ctx->scratch, int, b->topology->nedge + 1),
        *piece = CT_NEWN(b->ctx->scratch, int, b->topology->nnode + 1), npiece = 1;
    size_t nusable = 0;
    struct ct_tree unused;
    for (size_t e = 0; e < b->topology->nedge; e++) {
        const enum ct_edge_kind kind = b->topology->edge[e].kind;
        if (b->topology->edge[e].never_branch && kind != CT_EDGE_FORCE)
            return false;
        const bool usable = kind != CT_EDGE_BODY && kind != CT_EDGE_FORCE;
        weight[e] = usable ? 0 : -1;
        nusable += usable;
    }
    ct_tree_kruskal(b->arena, &b->topology->graph, weight, NULL, &unused, piece);
    for (size_t i = 0; i < b->topology->nnode; i++)
        npiece = piece[i] >= npiece ? piece[i] + 1 : npiece;
    return nusable + (size_t)npiece == b->topology->nnode;
}

// Is there a beam in an open system whose own coordinates fill the mass matrix (CHAIN), while all
// beams allow the articulated-body method (6.9b)?
static bool fills_matrix(const struct ct_build *b)
{
    bool any = false;
    for (size_t i = 0; i < b->nflexible; i++)
        any = any || b->flexible[i].kinematics == CT_AXIAL_CHAIN;
    return any && ct_flexible_may_be_articulated(b) && is_without_loops(b);
}

// Does the edge connect to a beam at a section other than its base? The articulated-body method
// then needs a joint coordinate there, because an absolute angle is that of the frame of the beam.
static bool enters_section(const struct ct_build *b, size_t i, const int *depth)
{
    const int tail = b->topology->wiring[i].tail, head = b->topology->wiring[i].head,
              end = depth[head] > depth[tail] ? head : tail;
    const struct ct_flexible *f = ct_flexible_of(b, b->topology->node[end].body);
    return f && end != f->base;
}

// Order among equal weights (section 2.3). In a plane the angle of a body has the same weight as
// the angle of a joint and gives shorter expressions. It is therefore preferred to a passive joint
// on a rotating body. Exception: joints at a beam section that is not the base. If the rotation of
// that section is condensed, the exception holds only where the mass matrix would be full.
static int tie_rank(const struct ct_build *b, size_t i, const int *depth, const int *turned,
                    enum ct_tree_choice choice, bool fills)
{
    const struct ct_edge_info *e = &b->topology->edge[i];
    const int tail = b->topology->wiring[i].tail, head = b->topology->wiring[i].head,
              last = 2 * (int)b->topology->nedge;
    if (e->kind == CT_EDGE_ARM)
        return -1;
    if (e->kind == CT_EDGE_BODY)
        return b->topology->is_planar && choice == CT_TREE_AUTO ? 1 : last;
    const bool enters = enters_section(b, i, depth),
               is_first = turned[tail] == 0 || turned[head] == 0 || enters;
    if ((is_first
         && !(b->topology->is_planar && rotates_condensed_section(b, i) && !(enters && fills)))
        || (e->kind == CT_EDGE_JOINT && ct_joint_is_active(e->self)))
        return 0;
    return 2 + (depth[tail] < depth[head] ? depth[tail] : depth[head]);
}

static int order_names(const void *build, const void *left, const void *right)
{
    const struct ct_build *b = build;
    const int *i = left, *k = right;
    return strcmp(b->topology->edge[*i].name, b->topology->edge[*k].name);
}

// Orders equal ranks by name. Then the trees for assembly, and the solution that assembly finds, do
// not depend on the order of components in the file.
static void rank_by_name(const struct ct_build *b, int *rank)
{
    const int n = (int)b->topology->nedge;
    int *sorted = CT_NEWN(b->arena, int, n + 1), place = 0;
    for (int i = 0; i < n; i++)
        sorted[i] = i;
    ct_sort(b->arena, sorted, b->topology->nedge, sizeof *sorted, order_names, b);
    for (int k = 0; k < n; k++) { // place: number of names that come before
        if (k && order_names(b, &sorted[k - 1], &sorted[k]) != 0)
            place = k;
        rank[sorted[k]] = n * (rank[sorted[k]] + 1) + place;
    }
}

struct ct_pair_rules ct_pair_rules_make(struct ct_build *b,
                                        const struct ct_formulate_options *o)
{
    const enum ct_tree_choice choice = o->tree;
    const size_t n = b->topology->nedge;
    struct ct_pair_rules r = {.weight_t = CT_NEWN(b->arena, int, n),
                              .weight_r = CT_NEWN(b->arena, int, n),
                              .rank = CT_NEWN(b->arena, int, n),
                              .forced_t = CT_NEWN(b->arena, bool, n),
                              .forced_r = CT_NEWN(b->arena, bool, n),
                              .banned_t = CT_NEWN(b->arena, bool, n),
                              .banned_r = CT_NEWN(b->arena, bool, n),
                              .tied = CT_NEWN(b->arena, bool, n)};
    const int *depth = node_depths(b, false), *turned = node_depths(b, true);
    const bool fills = fills_matrix(b);
    for (size_t i = 0; i < n; i++) {
        const struct ct_edge_info *e = &b->topology->edge[i];
        const bool is_body = e->kind == CT_EDGE_BODY;
        const bool is_particle = is_body && b->model->body[e->index].is_particle;
        const bool dear = choice == CT_TREE_ABSOLUTE ? !is_body : is_body;
        const int extra = choice != CT_TREE_AUTO && dear && !e->must_be_branch ? 100 : 0;
        r.weight_t[i] = e->weight_t + extra;
        r.weight_r[i] = e->weight_r + extra;
        if (o->first && e->kind == CT_EDGE_JOINT && o->first[e->index])
            r.weight_t[i] = r.weight_r[i] = -1;
        r.rank[i] = tie_rank(b, i, depth, turned, choice, fills);
        const bool is_small = e->kind == CT_EDGE_JOINT && ct_build_is_small(b, e->name, NULL);
        r.forced_t[i] = e->must_be_branch || is_small;
        r.forced_r[i] = e->must_be_branch || is_particle || (is_small && e->has_rotation);
        r.banned_t[i] = e->never_branch;
        r.banned_r[i] = e->never_branch || !e->has_rotation;
        r.tied[i] = e->must_be_branch;
        if (is_particle)
            r.weight_r[i] = 0;
    }
    if (choice == CT_TREE_JOINTS)
        rank_by_name(b, r.rank);
    return r;
}
