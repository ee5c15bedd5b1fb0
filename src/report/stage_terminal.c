// Terminal equations of each component, with the names and data of the model.
#include "report/stage_beam.h"

#include "formulate/build.h"
#include "formulate/topology/linear_graph.h"

#include <string.h>

static const char *join(struct ct_derivation *d, const char *list, const char *item)
{
    return *list ? ct_arena_printf(d->a, "%s, %s", list, item) : item;
}

// ---- laws ----------------------------------------------------------------------------------

static bool is_first_of_class(const struct ct_build *b, size_t edge)
{
    for (size_t i = 0; i < edge; i++)
        if (b->topology->edge[i].self
            && b->topology->edge[i].self->cls == b->topology->edge[edge].self->cls)
            return false;
    return true;
}

static void put_laws(struct ct_derivation *d)
{
    const struct ct_build *b = d->e->build;
    ct_page_table(&d->page, "lll");
    CT_PAGE_ROW(&d->page, "component", "across", "through");
    CT_PAGE_ROW(&d->page, "arm", "d, S constant in axes of its tail", "F, T are reactions");
    if (b->nflexible)
        CT_PAGE_ROW(&d->page, "flexible arm", "d = r, S: position and rotation of the section",
                    "F, T are reactions; effort(q) = sum of d_q . F + Y_q . T");
    for (size_t i = 0; i < b->topology->nedge; i++) {
        const struct ct_instance *self = b->topology->edge[i].self;
        if (self && b->topology->edge[i].kind != CT_EDGE_CLOSURE && is_first_of_class(b, i))
            CT_PAGE_ROW(&d->page, self->cls->name, self->cls->across, self->cls->through);
    }
    for (size_t j = 0; j < d->m->njoint; j++) { // those without an edge, gears
        const struct ct_instance *self = &d->m->joint[j];
        bool is_first = b->topology->edge_of_joint[j] < 0;
        for (size_t k = 0; k < j; k++)
            is_first &= d->m->joint[k].cls != self->cls;
        if (is_first)
            CT_PAGE_ROW(&d->page, self->cls->name, self->cls->across, self->cls->through);
    }
}

// ---- bodies and arms -----------------------------------------------------------------------

// F = m*(g - a(C))
static const char *inertia_force(struct ct_derivation *d, const struct ct_body *body,
                                 const char *com)
{
    const char *mass = ct_derivation_text(d, body->mass);
    if (ct_ex_is_zero(body->mass))
        return "0";
    if (strchr(mass, ' '))
        mass = ct_arena_printf(d->a, "(%s)", mass);
    return ct_arena_printf(
        d->a, ct_derivation_is_latex(d) ? "%s \\, (\\boldsymbol{g} - %s)" : "%s*(g - %s)", mass,
        ct_derivation_of(d, "a", com));
}

static const char *inertia_torque(struct ct_derivation *d, const struct ct_body *body)
{
    const char *inertia = ct_derivation_inertia_torque(d, body);
    return inertia ? ct_arena_printf(d->a, "-%s", inertia) : "0";
}

static void put_inertia(struct ct_derivation *d, const struct ct_body *body)
{
    const ct_ex *I = body->inertia;
    if (body->is_particle || (ct_ex_same(I[0], I[1]) && ct_ex_same(I[1], I[2])))
        return;
    const bool latex = ct_derivation_is_latex(d);
    const char *list = "";
    const bool is_diagonal = ct_ex_is_zero(I[3]) && ct_ex_is_zero(I[4]) && ct_ex_is_zero(I[5]);
    for (int i = 0; i < (is_diagonal ? 3 : 6); i++)
        list = join(d, list, ct_derivation_text(d, I[i]));
    ct_page_equation(&d->page, NULL, ct_derivation_of(d, "I", body->instance.name),
                     ct_arena_printf(d->a, latex ? "%s(%s)" : "%s[%s]",
                                     is_diagonal ? latex ? "\\operatorname{diag}" : "diag" : "",
                                     list),
                     is_diagonal ? "body axes" : "xx yy zz xy xz yz, body axes");
}

static void put_bodies(struct ct_derivation *d)
{
    const struct ct_model *m = d->m;
    if (m->nbody < 2)
        return;
    ct_page_heading(&d->page, "bodies: inertia and weight, at the centre of mass");
    ct_page_equations(&d->page);
    ct_page_equation(&d->page, NULL, ct_derivation_is_latex(d) ? "\\boldsymbol{g}" : "g",
                     ct_derivation_vector(d, m->gravity), "ground axes");
    for (size_t i = 1; i < m->nbody; i++) {
        const struct ct_body *body = &m->body[i];
        const char *name = body->instance.name;
        const char *com
            = d->e->build->topology->node[d->e->build->topology->node_of_com[i]].name;
        if (body->beam)
            continue;
        d->page.about = name;
        ct_page_equation(&d->page, NULL, ct_derivation_of(d, "F", name),
                         inertia_force(d, body, com), NULL);
        if (body->is_particle)
            continue;
        ct_page_equation(&d->page, NULL, ct_derivation_of(d, "T", name),
                         inertia_torque(d, body), NULL);
        put_inertia(d, body);
    }
}

static const char *turns_text(struct ct_derivation *d, const struct ct_turn *turn, int n)
{
    const bool latex = ct_derivation_is_latex(d);
    const char *s = "";
    for (int i = 0; i < n; i++)
        s = ct_arena_printf(d->a, latex ? "%s%s\\operatorname{Rot}(%s, %s)" : "%s%sRot(%s, %s)",
                            s, *s ? latex ? " \\, " : "*" : "",
                            ct_derivation_axis(d, turn[i].axis),
                            ct_derivation_text(d, turn[i].angle));
    return *s ? s : "1";
}

static void put_arms(struct ct_derivation *d)
{
    const struct ct_build *b = d->e->build;
    bool any = false;
    for (size_t i = 0; i < b->topology->nedge; i++) {
        const struct ct_edge_info *e = &b->topology->edge[i];
        if (!ct_edge_is_rigid_arm(e))
            continue;
        if (!any) {
            ct_page_heading(&d->page, "arms: from the frame of a body to its points");
            ct_page_equations(&d->page);
        }
        any = true;
        const char *body = b->topology->node[b->topology->wiring[i].tail].name;
        d->page.about = e->name;
        ct_page_equation(&d->page, NULL, ct_derivation_of(d, "d", e->name),
                         ct_derivation_vector(d, e->at),
                         ct_arena_printf(d->a, "axes of %s", body));
        if (e->index >= 0 && d->m->frame[e->index].nturn)
            ct_page_equation(
                &d->page, NULL, ct_derivation_of(d, "S", e->name),
                turns_text(d, d->m->frame[e->index].turn, d->m->frame[e->index].nturn), NULL);
    }
}

// ---- joints --------------------------------------------------------------------------------

static ct_ex element(const struct ct_value *v, int k)
{
    return v->given && (size_t)k < v->n && !v->hole[k] ? v->e[k] : CT_EX_ZERO;
}

// effort - stiffness (q - rest) - damping u along coordinate k, with q and u by their names.
static ct_ex effort_of(struct ct_derivation *d, const struct ct_instance *self, int k, ct_ex q,
                       const char *speed)
{
    struct ct_exs *x = d->e->x;
    ct_ex f = element(ct_instance_value(self, "effort"), k);
    const ct_ex stiffness = element(ct_instance_value(self, "stiffness"), k);
    const ct_ex damping = element(ct_instance_value(self, "damping"), k);
    const ct_ex stretch = ct_ex_sub(x, q, element(ct_instance_value(self, "rest"), k));
    f = ct_ex_sub(x, f, ct_ex_mul(x, stiffness, stretch));
    return ct_ex_sub(x, f,
                     ct_ex_mul(x, damping, ct_ex_sym(x, CT_SYM_LOCAL, speed, (uint32_t)k)));
}

static void put_effort(struct ct_derivation *d, const struct ct_edge_info *e, int k, ct_ex q)
{
    const bool turns = e->trial->quaternion >= 0 && k >= e->trial->quaternion;
    const char *name = e->trial->nfree == 1 ? ct_arena_printf(d->a, "%s.q", e->name)
                                            : ct_arena_printf(d->a, "%s.q%d", e->name, k + 1);
    const char *speed = turns ? ct_arena_printf(d->a, "%s.u%d", e->name, k + 1)
                              : ct_arena_printf(d->a, "%s'", name);
    const ct_ex motion = element(ct_instance_value(e->self, "motion"), k);
    const struct ct_value *given = ct_instance_value(e->self, "motion");
    if (given->given && (size_t)k < given->n && !given->hole[k]) {
        ct_page_equation(&d->page, NULL, ct_derivation_name(d, name),
                         ct_derivation_text(d, motion), "prescribed; its effort is a reaction");
        return;
    }
    const ct_ex f = effort_of(d, e->self, k, q, speed);
    const char *along = turns ? speed : name;
    if (!ct_ex_is_zero(f))
        ct_page_equation(&d->page, NULL, ct_derivation_effort(d, along),
                         ct_derivation_text(d, f), NULL);
}

// Symbols named after the coordinates, so that chords are printed like branches.
static void name_coordinates(struct ct_derivation *d, const struct ct_edge_info *e,
                             struct ct_motion *m)
{
    *m = (struct ct_motion){.ncoord = e->trial->ncoord, .nfree = e->trial->nfree};
    for (int k = 0; k < e->ncoordinate; k++) {
        const char *name = d->e->coordinate[e->first_coordinate + k].name;
        m->coord[k] = ct_ex_sym(d->e->x, CT_SYM_LOCAL, name, (uint32_t)k);
    }
    ct_linear_graph_edge_motion(d->e->build, e, m);
}

static void put_joint(struct ct_derivation *d, const struct ct_edge_info *e)
{
    struct ct_motion m;
    if (!e->self->cls->motion) {
        const struct ct_value *length = ct_instance_value(e->self, "length"); // distance
        ct_page_equation(&d->page, NULL,
                         ct_arena_printf(d->a, "|%s|", ct_derivation_of(d, "d", e->name)),
                         length->given               ? ct_derivation_text(d, length->e[0])
                         : ct_derivation_is_latex(d) ? "\\text{the distance at the start}"
                                                     : "the distance at the start",
                         NULL);
        return;
    }
    name_coordinates(d, e, &m);
    const char *from = d->m->frame[e->self->from].name;
    ct_page_equation(&d->page, NULL, ct_derivation_of(d, "d", e->name),
                     ct_derivation_vector(d, m.d),
                     ct_ex3_is_zero(m.d) ? NULL : ct_arena_printf(d->a, "axes of %s", from));
    if (e->has_rotation) {
        const char *S = turns_text(d, m.turn, m.nturn);
        if (m.quaternion >= 0)
            S = ct_derivation_is_latex(d)
                  ? ct_arena_printf(d->a, "\\boldsymbol{S}(%s, \\ldots)",
                                    ct_derivation_text(d, m.coord[m.quaternion]))
                  : ct_arena_printf(d->a, "S(%s.q%d..q%d)", e->name, m.quaternion + 1,
                                    m.quaternion + 4);
        ct_page_equation(&d->page, NULL, ct_derivation_of(d, "S", e->name), S, NULL);
    }
    for (int k = 0; k < e->self->nfree; k++)
        put_effort(d, e, k, m.coord[k]);
}

static void put_joints(struct ct_derivation *d)
{
    const struct ct_build *b = d->e->build;
    if (!d->m->njoint)
        return;
    ct_page_heading(&d->page, "joints");
    ct_page_equations(&d->page);
    for (size_t j = 0; j < d->m->njoint; j++) {
        const struct ct_instance *self = &d->m->joint[j];
        d->page.about = self->name;
        if (b->topology->edge_of_joint[j] >= 0) {
            put_joint(d, &b->topology->edge[b->topology->edge_of_joint[j]]);
        } else {
            const struct ct_value *joints = ct_instance_value(self, "joints");
            const struct ct_value *ratio = ct_instance_value(self, "ratio");
            const bool latex = ct_derivation_is_latex(d);
            const char *name[2];
            for (int i = 0; i < 2; i++)
                name[i] = strchr(joints->name[i], '.')
                            ? joints->name[i]
                            : ct_arena_printf(d->a, "%s.q", joints->name[i]);
            ct_page_equation(
                &d->page, NULL, ct_derivation_name(d, name[0]),
                ct_arena_printf(d->a, latex ? "%s \\, %s + \\mathrm{const}" : "%s*%s + const",
                                ct_derivation_text(d, ratio->e[0]),
                                ct_derivation_name(d, name[1])),
                self->name);
        }
    }
}

// ---- forces --------------------------------------------------------------------------------

static const char *value_text(struct ct_derivation *d, const struct ct_value *v)
{
    if (v->n == 1)
        return ct_derivation_text(d, v->e[0]);
    const char *list = "";
    for (size_t i = 0; i < v->n; i++)
        list = join(d, list, ct_derivation_text(d, v->e[i]));
    return ct_arena_printf(d->a, ct_derivation_is_latex(d) ? "(%s)" : "[%s]", list);
}

static void put_force(struct ct_derivation *d, const struct ct_instance *self)
{
    const struct ct_component_class *cls = self->cls;
    const struct ct_value *in = NULL;
    d->page.about = self->name;
    for (int k = 0; k < cls->nkey; k++)
        if (!strcmp(cls->key[k].name, "in"))
            in = &self->value[k];
    for (int k = 0; k < cls->nkey; k++) {
        const struct ct_value *v = &self->value[k];
        if (!v->given || cls->key[k].kind == CT_VALUE_FRAME || !v->n)
            continue;
        const bool is_value = !strcmp(cls->key[k].name, "value");
        const char *key = cls->key[k].name;
        const char *left
            = is_value
                ? ct_derivation_of(d, cls->applied == CT_APPLIED_TORQUE ? "T" : "F", self->name)
            : ct_derivation_is_latex(d) ? ct_arena_printf(
                  d->a, "\\mathrm{%s}_{\\mathrm{%s}}", key, ct_latex_quoted(d->a, self->name))
                                        : ct_arena_printf(d->a, "%s(%s)", key, self->name);
        const char *note = NULL;
        if (is_value)
            note = ct_arena_printf(d->a, "axes of %s",
                                   in && in->given ? d->m->frame[in->frame].name : "ground");
        ct_page_equation(&d->page, NULL, left, value_text(d, v), note);
    }
}

static void put_forces(struct ct_derivation *d)
{
    if (!d->m->nforce)
        return;
    ct_page_heading(&d->page, "forces");
    ct_page_equations(&d->page);
    for (size_t i = 0; i < d->m->nforce; i++)
        put_force(d, &d->m->force[i]);
}

static void put_states(struct ct_derivation *d)
{
    if (!d->m->nstate)
        return;
    ct_page_heading(&d->page, "states");
    ct_page_equations(&d->page);
    for (size_t i = 0; i < d->m->nstate; i++) {
        const struct ct_state *z = &d->m->state[i];
        const ct_ex derivative = d->e->u[d->e->nmotion + i].derivative;
        ct_page_equation(&d->page, NULL, ct_derivation_text(d, derivative),
                         ct_derivation_text(d, z->rate), NULL);
    }
}

void ct_stage_terminal(struct ct_derivation *d)
{
    ct_page_title(&d->page, "Terminal equations");
    ct_page_sentence(
        &d->page,
        "across: displacement d and rotation S of the head of an edge, seen from its tail; "
        "through: force F and torque T of the component on its head");
    put_laws(d);
    put_bodies(d);
    ct_beams_put_terminal(d);
    put_arms(d);
    ct_beams_put_arms(d);
    put_joints(d);
    put_forces(d);
    put_states(d);
    d->page.about = NULL;
}
