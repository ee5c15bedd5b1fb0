// The derivation as JSON.
//
// Rows and columns count from 0; M holds its lower triangle. Expressions are in the grammar of
// model files with speeds as J.u and accelerations as J.a; definitions use earlier ones only.
#include "report/stage_beam.h"

#include "formulate/build.h"
#include "report/equations_print.h"
#include "report/json.h"
#include "report/provenance.h"

#include <string.h>

struct writer {
    struct ct_json j;
    struct ct_derivation *d;
};

static const char *text(struct writer *w, ct_ex v)
{
    const struct ct_print plain = {.limit = 1000000};
    return ct_derivation_text_as(w->d, v, &plain);
}

// ---- topology ------------------------------------------------------------------------------

// Coordinates of an element by the names of its dofs; fixed ones are omitted.
static void put_element(struct writer *w, const struct ct_flexible *f, int k)
{
    const struct ct_element *e = &f->element[k];
    ct_json_object(&w->j, NULL);
    ct_json_text(&w->j, "from", text(w, e->span.start));
    ct_json_text(&w->j, "to", text(w, f->beam->end[k]));
    ct_json_object(&w->j, "dofs");
    for (int j = 0; j < CT_DOF; j++)
        if (!ct_ex_is_zero(e->value[j]))
            ct_json_text(&w->j, ct_beam_dof_name(j), text(w, e->value[j]));
    ct_json_end(&w->j);
    ct_json_end(&w->j);
}

// The element as a function of its dofs, xi and h; s: its stretch. Without energy if sections
// vary.
static void put_function(struct writer *w, const struct ct_flexible *f)
{
    struct ct_beam_element e;
    ct_beam_element_derive(w->d->e->build, f, &e);
    ct_json_object(&w->j, "element");
    ct_json_text(&w->j, "u", text(w, e.axial));
    ct_json_text(&w->j, "v", text(w, e.v));
    ct_json_text(&w->j, "w", text(w, e.w));
    ct_json_text(&w->j, "phi", text(w, e.twist));
    if (e.is_constant) {
        ct_json_text(&w->j, "shortening", text(w, e.shortening));
        ct_json_array(&w->j, "strain_energy"); // a sum
        for (int i = 0; i < 4; i++)
            if (!ct_ex_is_zero(e.energy[i]))
                ct_json_text(&w->j, NULL, text(w, e.energy[i]));
        ct_json_end(&w->j);
    }
    ct_json_end(&w->j);
}

static void put_beams(struct writer *w)
{
    const struct ct_build *b = w->d->e->build;
    ct_json_array(&w->j, "beams");
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        ct_json_object(&w->j, NULL);
        ct_json_text(&w->j, "name", f->name);
        ct_json_text(&w->j, "is", ct_beam_sentence(w->d->a, f));
        ct_json_text(&w->j, "mass_per_length", text(w, f->beam->mass_per_length));
        put_function(w, f);
        ct_json_array(&w->j, "elements");
        for (int k = 0; k < f->beam->nelement; k++)
            put_element(w, f, k);
        ct_json_end(&w->j);
        ct_json_end(&w->j);
    }
    ct_json_end(&w->j);
}

// The equations of one component on a page, as text.
static void put_equations_about(struct writer *w, const struct ct_page *p, const char *name)
{
    ct_json_array(&w->j, "equations");
    for (size_t i = 0; i < p->nblock; i++)
        for (size_t k = 0; k < p->block[i].nequation; k++) {
            const struct ct_page_equation *e = &p->block[i].equation[k];
            if (!e->about || strcmp(e->about, name))
                continue;
            ct_json_object(&w->j, NULL);
            ct_json_text(&w->j, "left", e->left);
            ct_json_text(&w->j, "right", e->right);
            if (e->note)
                ct_json_text(&w->j, "note", e->note);
            ct_json_end(&w->j);
        }
    ct_json_end(&w->j);
}

static void put_component(struct writer *w, const char *name, const char *type,
                          const char *across, const char *through)
{
    ct_json_object(&w->j, NULL);
    ct_json_text(&w->j, "name", name);
    ct_json_text(&w->j, "type", type);
    ct_json_text(&w->j, "across", across);
    ct_json_text(&w->j, "through", through);
    put_equations_about(w, &w->d->page, name);
    ct_json_end(&w->j);
}

static void put_terminal(struct writer *w)
{
    const struct ct_build *b = w->d->e->build;
    ct_stage_terminal(w->d); // the page itself is not printed
    ct_json_array(&w->j, "terminal");
    for (size_t i = 0; i < b->topology->nedge; i++) {
        const struct ct_edge_info *e = &b->topology->edge[i];
        put_component(w, e->name, w->d->e->edge_kind[i],
                      e->self        ? e->self->cls->across
                      : e->beam >= 0 ? "d = r, S: position and rotation of the section"
                                     : "d, S constant",
                      e->self ? e->self->cls->through : "F, T are reactions");
    }
    for (size_t j = 0; j < w->d->m->njoint; j++) { // gears
        const struct ct_instance *self = &w->d->m->joint[j];
        if (b->topology->edge_of_joint[j] < 0)
            put_component(w, self->name, self->cls->name, self->cls->across,
                          self->cls->through);
    }
    ct_json_end(&w->j);
    if (b->nflexible)
        put_beams(w);
}

// Rows of an integer matrix: name, edges and their signs.
static void put_rows(struct writer *w, const char *key, const char *own_key,
                     const struct ct_incidence *S, const char *const *name)
{
    struct ct_incidence rows;
    ct_incidence_transpose(w->d->a, S, &rows);
    ct_json_array(&w->j, key);
    for (int i = 0; i < S->nrow; i++) {
        ct_json_object(&w->j, NULL);
        ct_json_text(&w->j, own_key, name[i]);
        ct_json_object(&w->j, "sum");
        for (int k = rows.start[i]; k < rows.start[i + 1]; k++)
            ct_json_integer(&w->j, w->d->e->edge_name[rows.row[k]], rows.value[k]);
        ct_json_end(&w->j);
        ct_json_end(&w->j);
    }
    ct_json_end(&w->j);
}

static void put_graph(struct writer *w)
{
    struct ct_incidence A;
    const struct ct_equations *e = w->d->e;
    ct_json_object(&w->j, "graph");
    ct_json_array(&w->j, "nodes");
    for (int v = 0; v < e->graph->nnode; v++)
        ct_json_text(&w->j, NULL, e->node_name[v]);
    ct_json_end(&w->j);
    ct_json_array(&w->j, "edges");
    for (int i = 0; i < e->graph->nedge; i++) {
        ct_json_object(&w->j, NULL);
        ct_json_integer(&w->j, "number", i + 1);
        ct_json_text(&w->j, "name", e->edge_name[i]);
        ct_json_text(&w->j, "type", e->edge_kind[i]);
        ct_json_text(&w->j, "from", e->node_name[e->graph->edge[i].tail]);
        ct_json_text(&w->j, "to", e->node_name[e->graph->edge[i].head]);
        ct_json_end(&w->j);
    }
    ct_json_end(&w->j);
    ct_incidence_derive(w->d->a, e->graph, &A);
    put_rows(w, "incidence", "node", &A, (const char *const *)e->node_name + 1);
    ct_json_end(&w->j);
}

static void put_branches(struct writer *w, const char *key, const struct ct_tree *t)
{
    ct_json_array(&w->j, key);
    for (int i = 0; i < t->nbranch; i++)
        ct_json_text(&w->j, NULL, w->d->e->edge_name[t->branch[i]]);
    ct_json_end(&w->j);
}

static void put_tree(struct writer *w)
{
    const struct ct_equations *e = w->d->e;
    ct_json_object(&w->j, "tree");
    ct_json_text(&w->j, "chosen", e->how);
    put_branches(w, "translation", e->T);
    put_branches(w, "rotation", e->R);
    ct_json_end(&w->j);
    ct_json_array(&w->j, "left_out");
    for (size_t i = 0; i < e->nleft_out; i++) {
        ct_json_object(&w->j, NULL);
        ct_json_text(&w->j, "what", e->left_out[i].what);
        ct_json_text(&w->j, "why", e->left_out[i].why);
        ct_json_end(&w->j);
    }
    ct_json_end(&w->j);
}

static void put_definitions(struct writer *w, const struct ct_definitions *list)
{
    ct_json_array(&w->j, "definitions");
    for (size_t i = 0; i < list->n; i++) {
        ct_json_array(&w->j, NULL);
        ct_json_text(&w->j, NULL, text(w, list->at[i].symbol));
        ct_json_text(&w->j, NULL, text(w, list->at[i].value));
        ct_json_end(&w->j);
    }
    ct_json_end(&w->j);
}

// Circuits with the terminal equations substituted.
static void put_substituted(struct writer *w)
{
    const struct ct_equations *e = w->d->e;
    struct ct_substituted s;
    ct_derivation_substitute(w->d, &s);
    ct_json_object(&w->j, "substituted");
    put_definitions(w, &s.definitions);
    ct_json_object(&w->j, "bodies"); // centres of mass in ground axes
    for (size_t i = 0; i < s.n; i++) {
        ct_json_array(&w->j, e->edge_name[s.edge[i]]);
        for (int k = 0; k < 3; k++)
            ct_json_text(&w->j, NULL, text(w, s.at[i].e[k]));
        ct_json_end(&w->j);
    }
    ct_json_end(&w->j);
    ct_json_object(&w->j, "joints"); // each is zero
    for (size_t i = 0; i < e->nrow; i++)
        ct_json_text(&w->j, e->row[i].name, text(w, s.phi[i]));
    ct_json_end(&w->j);
    ct_json_end(&w->j);
}

static void put_topology(struct writer *w, bool cutsets)
{
    const struct ct_equations *e = w->d->e;
    const struct ct_tree *const tree[] = {e->T, e->R};
    static const char *const key[] = {"translation", "rotation"};
    ct_json_object(&w->j, cutsets ? "cutsets" : "circuits");
    for (int i = 0; i < 2; i++) {
        struct ct_incidence S;
        if (cutsets)
            ct_cutsets_derive(w->d->a, e->graph, tree[i], &S);
        else
            ct_circuits_derive(w->d->a, e->graph, tree[i], &S);
        const char **name = CT_NEWN(w->d->a, const char *, S.nrow + 1);
        for (int k = 0; k < S.nrow; k++)
            name[k] = e->edge_name[(cutsets ? tree[i]->branch : tree[i]->chord)[k]];
        put_rows(w, key[i], cutsets ? "branch" : "chord", &S, name);
    }
    if (!cutsets)
        put_substituted(w);
    ct_json_end(&w->j);
}

// ---- the reduced equations -----------------------------------------------------------------

static void put_matrix(struct writer *w, const char *key, const struct ct_entry *entry,
                       const ct_ex *value, size_t n)
{
    ct_json_array(&w->j, key);
    for (size_t i = 0; i < n; i++) {
        ct_json_array(&w->j, NULL);
        ct_json_integer(&w->j, NULL, entry[i].row);
        ct_json_integer(&w->j, NULL, entry[i].column);
        ct_json_text(&w->j, NULL, text(w, value[i]));
        ct_json_end(&w->j);
    }
    ct_json_end(&w->j);
}

static void put_vector(struct writer *w, const char *key, const ct_ex *value, size_t n)
{
    ct_json_array(&w->j, key);
    for (size_t i = 0; i < n; i++)
        ct_json_text(&w->j, NULL, text(w, value[i]));
    ct_json_end(&w->j);
}

static void put_unknowns(struct writer *w, const struct ct_reduced *r)
{
    const struct ct_equations *e = w->d->e;
    ct_json_array(&w->j, "coordinates");
    for (size_t i = 0; i < e->nq; i++) {
        ct_json_object(&w->j, NULL);
        ct_json_text(&w->j, "name", e->q[i].name);
        ct_json_text(&w->j, "rate", text(w, r->rate[i]));
        ct_json_end(&w->j);
    }
    ct_json_end(&w->j);
    ct_json_array(&w->j, "speeds");
    for (size_t i = 0; i < e->nmotion; i++) {
        ct_json_object(&w->j, NULL);
        ct_json_text(&w->j, "name", e->u[i].name);
        ct_json_text(&w->j, "coordinate", e->u[i].q >= 0 ? e->q[e->u[i].q].name : NULL);
        ct_json_text(&w->j, "derivative", text(w, e->u[i].derivative));
        ct_json_end(&w->j);
    }
    ct_json_end(&w->j);
    if (e->nstate)
        ct_json_array(&w->j, "states");
    for (size_t i = e->nmotion; i < e->nu; i++) {
        ct_json_object(&w->j, NULL);
        ct_json_text(&w->j, "name", e->u[i].name);
        ct_json_text(&w->j, "rate", text(w, r->Q[i]));
        ct_json_end(&w->j);
    }
    if (e->nstate)
        ct_json_end(&w->j);
    ct_json_array(&w->j, "rows");
    for (size_t i = 0; i < e->nrow; i++)
        ct_json_text(&w->j, NULL, e->row[i].name);
    ct_json_end(&w->j);
}

static void put_known(struct writer *w, const struct ct_reduced *r)
{
    const struct ct_equations *e = w->d->e;
    ct_json_object(&w->j, "parameters");
    for (size_t i = 0; i < w->d->m->nparameter; i++)
        ct_json_number(&w->j, w->d->m->parameter[i].name, w->d->m->parameter[i].value);
    ct_json_end(&w->j);
    ct_json_object(&w->j, "driven");
    for (size_t i = 0; i < e->ndriver; i++)
        ct_json_text(&w->j, e->driver[i].name, text(w, e->driver[i].value));
    ct_json_end(&w->j);
    ct_json_object(&w->j, "efforts");
    for (size_t i = 0; i < e->ndriver; i++)
        ct_json_text(&w->j, e->driver[i].name, text(w, r->effort[i]));
    ct_json_end(&w->j);
    ct_json_object(&w->j, "modes"); // 1 where it holds
    for (size_t i = 0; i < e->nswitch; i++)
        ct_json_text(&w->j, ct_ex_symbol(e->x, e->switches[i].symbol)->name,
                     ct_arena_printf(w->d->a, "%s %s 0", text(w, e->switches[i].g),
                                     ct_op_info[e->switches[i].op].name));
    ct_json_end(&w->j);
}

// Terms of the equations, and the components they come from.
static void put_terms(struct writer *w, const struct ct_reduced *r)
{
    static const char *const kind[]
        = {"motion", "position", "acceleration", "effort", "output"};
    struct ct_provenance p;
    ct_provenance_derive(w->d, r, &p);
    const char **name = CT_NEWN(w->d->a, const char *, p.norigin + 1);
    double *line = CT_NEWN(w->d->a, double, p.norigin + 1);
    ct_json_array(&w->j, "terms");
    for (size_t i = 0; i < p.nterm; i++) {
        const struct ct_equation_term *t = &p.term[i];
        ct_json_object(&w->j, NULL);
        ct_json_text(&w->j, "equation", ct_provenance_equation(w->d->e, t));
        ct_json_text(&w->j, "kind", kind[t->kind]);
        ct_json_text(&w->j, "side", t->is_right ? "right" : "left");
        ct_json_text(&w->j, "expression", text(w, t->e));
        for (size_t k = 0; k < t->norigin; k++) {
            name[k] = p.origin[t->origin[k]].name;
            line[k] = p.origin[t->origin[k]].line;
        }
        ct_json_texts(&w->j, "components", name, t->norigin);
        ct_json_numbers(&w->j, "lines", line, t->norigin);
        ct_json_end(&w->j);
    }
    ct_json_end(&w->j);
}

// Left and right sides of the recursive form.
static void put_sides(struct writer *w, const struct ct_reduced *r)
{
    ct_json_array(&w->j, "motion");
    for (size_t i = 0; i < w->d->e->nmotion; i++) {
        ct_json_array(&w->j, NULL);
        ct_json_text(&w->j, NULL, text(w, r->cutset[i]));
        ct_json_text(&w->j, NULL, text(w, r->Q[i]));
        ct_json_end(&w->j);
    }
    ct_json_end(&w->j);
}

static void put_reduced(struct writer *w)
{
    const struct ct_equations *e = w->d->e;
    struct ct_reduced r;
    ct_derivation_reduce(w->d, &r);
    put_unknowns(w, &r);
    put_known(w, &r);
    put_definitions(w, &r.definitions);
    size_t nM = e->nM;
    while (nM && ct_speed_is_state(e, (size_t)e->M[nM - 1].row)) // after all others
        nM--;
    if (r.is_recursive) {
        put_sides(w, &r);
    } else {
        put_matrix(w, "M", e->M, r.M, nM);
        put_vector(w, "Q", r.Q, e->nmotion);
    }
    put_matrix(w, "J", e->J, r.J, e->nJ);
    put_vector(w, "phi", r.phi, e->nrow);
    put_vector(w, "gam", r.gam, e->nrow);
    if (!r.is_recursive)
        put_terms(w, &r);
}

void ct_derivation_print_json(FILE *out, struct ct_derivation *d, unsigned stages)
{
    struct writer w = {.d = d};
    ct_json_init(&w.j, out);
    ct_json_object(&w.j, NULL);
    ct_json_text(&w.j, "model", d->m->name);
    if (stages & CT_STAGE_TERMINAL)
        put_terminal(&w);
    if (stages & CT_STAGE_GRAPH)
        put_graph(&w);
    if (stages & CT_STAGE_TREE)
        put_tree(&w);
    if (stages & CT_STAGE_CUTSET)
        put_topology(&w, true);
    if (stages & CT_STAGE_CIRCUIT)
        put_topology(&w, false);
    if (stages & CT_STAGE_REDUCED)
        put_reduced(&w);
    ct_json_end(&w.j);
}
