// What each stage of formulate/ hands over always holds (build.h): of all shipped systems and
// mechanisms, on three choices of trees, in the plane and in space.
#include "formulate/beam/flexible_body.h"
#include "formulate/kinematics/constraint_row.h"
#include "tests/property/mechanism.h"
#include "tests/property/system.h"

// A place of a stage's result that is not as it must be.
struct check {
    const char *system;
    bool ok;
};

static void demand(struct check *c, bool holds, const char *what, size_t i)
{
    if (!holds)
        print_error("%s: %s (number %zu)\n", c->system, what, i);
    c->ok &= holds;
}

static bool is_below(int i, size_t n)
{
    return i >= 0 && (size_t)i < n;
}

// ---- topology -----------------------------------------------------------------------------------

static void check_topology(struct check *c, const struct ct_build *b)
{
    const struct ct_topology *t = b->topology;
    demand(c, (size_t)t->graph.nnode == t->nnode && (size_t)t->graph.nedge == t->nedge,
           "the graph has the listed nodes and edges", 0);
    for (size_t i = 0; i < t->nedge; i++) {
        const struct ct_edge_info *e = &t->edge[i];
        demand(c,
               is_below(t->wiring[i].tail, t->nnode) && is_below(t->wiring[i].head, t->nnode),
               "an edge joins two nodes", i);
        demand(c, !(e->must_be_branch && e->never_branch), "an edge may be a branch or not", i);
        for (int k = 0; k < e->ncoordinate; k++) {
            const struct ct_coordinate *of = &t->coordinate[e->first_coordinate + k];
            demand(c, (size_t)of->edge == i && of->index == k, "coordinates lie by edge", i);
        }
    }
    const char *T = ct_tree_check(&t->graph, &b->T), *R = ct_tree_check(&t->graph, &b->R);
    demand(c, !T, T ? T : "", 0);
    demand(c, !R, R ? R : "", 0);
}

// ---- kinematics ---------------------------------------------------------------------------------

// The interval of numbers outboard of `self` lies in that of its parent, which has a smaller
// number.
static bool is_within(int self_enter, int self_leave, int enter, int leave)
{
    return enter < self_enter && self_enter <= self_leave && self_leave <= leave;
}

static void check_kinematics(struct check *c, const struct ct_build *b)
{
    const struct ct_kinematics *k = b->kinematics;
    for (size_t i = 1; i < k->ncluster; i++) {
        const struct ct_cluster *self = &k->cluster[i];
        demand(c, is_below(self->parent, i), "a cluster's parent comes before it", i);
        demand(c,
               is_within(self->enter, self->leave, k->cluster[self->parent].enter,
                         k->cluster[self->parent].leave),
               "clusters outboard are numbered together", i);
        for (int s = 0; s < self->naxis; s++)
            demand(c, (size_t)k->rotation_axis[self->first_axis + s].cluster == i,
                   "an axis belongs to the cluster it introduces", i);
    }
    for (size_t i = 1; i < k->nanchor; i++) {
        const struct ct_anchor *self = &k->anchor[i];
        demand(c, is_below(self->parent, i) && is_below(self->cluster, k->ncluster),
               "an anchor's parent comes before it", i);
        demand(c,
               is_within(self->enter, self->leave, k->anchor[self->parent].enter,
                         k->anchor[self->parent].leave),
               "anchors outboard are numbered together", i);
    }
    for (size_t i = 0; i < b->topology->nnode; i++) {
        const struct ct_node_placement *p = &k->placement[i];
        demand(c,
               is_below(p->anchor, k->nanchor) && is_below(p->cluster, k->ncluster)
                   && is_below(p->frame, k->ncluster),
               "a node sits at an anchor", i);
    }
}

// Each coordinate of the trees is an unknown or driven; each unknown is one coordinate's or a
// beam's.
static void check_unknowns(struct check *c, const struct ct_build *b)
{
    size_t nq = 0, ndriver = 0;
    for (size_t i = 0; i < b->topology->ncoordinate; i++) {
        const struct ct_coordinate *of = &b->kinematics->coordinate[i];
        demand(c, of->q < 0 || of->driver < 0, "a coordinate is unknown or driven", i);
        demand(c, of->driver < 0 || of->is_driven, "only driven coordinates have drivers", i);
        demand(c, of->q < (int)b->eqs->nq && of->u < (int)b->eqs->nu, "unknowns are listed", i);
        nq += of->q >= 0;
        ndriver += of->driver >= 0;
    }
    for (size_t i = 0; i < b->nflexible; i++)
        nq += (size_t)b->flexible[i].nelastic;
    demand(c, nq == b->eqs->nq, "every unknown is a coordinate's", nq);
    demand(c, ndriver == b->eqs->ndriver, "every driver is a coordinate's", ndriver);
}

// ---- rows and loads -----------------------------------------------------------------------------

static void check_rows(struct check *c, const struct ct_build *b)
{
    const struct ct_row_wrenches *rows = b->rows;
    bool *acts = CT_NEWN(b->ctx->scratch, bool, b->eqs->nrow + 1);
    for (size_t i = 0; i < rows->nmultiplier_wrench; i++) {
        const struct ct_multiplier_wrench *p = &rows->multiplier_wrench[i];
        demand(c, is_below(p->row, b->eqs->nrow), "a multiplier is that of a row", i);
        demand(c,
               is_below(p->tail, b->topology->nnode) && is_below(p->head, b->topology->nnode),
               "a multiplier acts between nodes", i);
        acts[p->row] = true;
    }
    for (size_t i = 0; i < rows->ncoupling; i++)
        acts[rows->coupling[i].row] = true;
    for (size_t i = 0; i < b->eqs->nJ; i++)
        acts[b->eqs->J[i].row] = true;
    for (size_t i = 0; i < b->eqs->nrow; i++)
        demand(c, acts[i], "a row's multiplier acts on something", i);
    for (size_t i = 0; i < b->loads->nload; i++)
        demand(c,
               is_below(b->loads->load[i].tail, b->topology->nnode)
                   && is_below(b->loads->load[i].head, b->topology->nnode),
               "a load acts between nodes", i);
    demand(c, !b->open_rows && !b->open_loads, "stages are closed", 0);
}

// ---- all of them --------------------------------------------------------------------------------

static bool stages_hold(struct system *s)
{
    const struct ct_formulate_options *const on[]
        = {&by_choice, &by_joints, &by_bodies, &by_joints_spatial, &by_bodies_spatial};
    struct check c = {s->name, true};
    for (size_t i = 0; i < COUNT(on); i++) {
        struct variant v;
        if (!variant_try(s, on[i], &v)) // a tree that the model does not allow
            continue;
        check_topology(&c, v.e.build);
        check_kinematics(&c, v.e.build);
        check_unknowns(&c, v.e.build);
        check_rows(&c, v.e.build);
        variant_close(&v);
    }
    return c.ok;
}

static void stages_hold_for_shipped_systems(void **state)
{
    (void)state;
    assert_true(holds_for_shipped(stages_hold, 50));
}

static void stages_hold_for_mechanisms(void **state)
{
    (void)state;
    assert_true(holds_for_mechanisms(stages_hold, 0));
    assert_true(holds_for_mechanisms(stages_hold, 1));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stages_hold_for_shipped_systems),
        cmocka_unit_test(stages_hold_for_mechanisms),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
