// The reduced equations as equations of a page.
#include "formulate/beam/flexible_body.h"
#include "report/beam_blocks.h"
#include "report/provenance.h"

#include <string.h>

struct sides {
    ct_ex left, right;
    const char *label, *name;
};

struct group {
    struct sides *at;
    size_t n, cap;
};

// name: of the speed or row, NULL: of neither
static void add(struct ct_derivation *d, struct group *g, const char *label, const char *name,
                ct_ex left, ct_ex right)
{
    const struct sides s = {left, right, label, name};
    CT_PUSH(d->a, g->at, g->n, g->cap, s);
}

// ---- origins -------------------------------------------------------------------------------

static const char *names_of(struct ct_derivation *d, const struct ct_provenance *p,
                            const struct ct_equation_term *t)
{
    const char *names = "";
    for (size_t i = 0; i < t->norigin; i++)
        names = ct_arena_printf(d->a, "%s%s%s", names, *names ? " " : "",
                                p->origin[t->origin[i]].name);
    return *names ? names : "system";
}

// Components of each term of a side, one text per printed term; "system" if there is none.
static const char *const *components_of(struct ct_derivation *d, const struct ct_provenance *p,
                                        enum ct_equation_kind kind, size_t equation,
                                        bool is_right, const char *text)
{
    const char **list = NULL;
    size_t n = 0, cap = 0, nterm = 0;
    for (; *text; text += ct_page_first_term(text))
        nterm++;
    for (size_t i = 0; i < p->nterm; i++) {
        const struct ct_equation_term *t = &p->term[i];
        if (t->kind == kind && t->equation == equation && t->is_right == is_right)
            CT_PUSH(d->a, list, n, cap, names_of(d, p, t));
    }
    while (n < nterm)
        CT_PUSH(d->a, list, n, cap, "system");
    return list;
}

// p: provenance of the equations, from number `first` of their kind; NULL: not requested.
static void put_group(struct ct_derivation *d, const struct group *g,
                      const struct ct_provenance *p, enum ct_equation_kind kind, size_t first)
{
    ct_page_equations(&d->page);
    for (size_t i = 0; i < g->n; i++) {
        struct ct_page_equation *e
            = ct_page_equation(&d->page, g->at[i].label, ct_derivation_text(d, g->at[i].left),
                               ct_derivation_text(d, g->at[i].right), NULL);
        e->name = g->at[i].name;
        if (p) {
            e->left_components = components_of(d, p, kind, first + i, false, e->left);
            e->right_components = components_of(d, p, kind, first + i, true, e->right);
        }
    }
}

static const char *speed_label(struct ct_derivation *d, size_t i)
{
    const struct ct_u *u = &d->e->u[i];
    return u->q >= 0 ? d->e->q[u->q].name : u->name;
}

// ---- sharing -------------------------------------------------------------------------------

static bool is_long(struct ct_derivation *d, const struct group *g, size_t n)
{
    size_t lines = 0;
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < g[k].n && lines <= CT_MOST_LINES; i++)
            lines += ct_derivation_lines(d, g[k].at[i].left)
                   + ct_derivation_lines(d, g[k].at[i].right);
    return lines > CT_MOST_LINES;
}

// ---- groups --------------------------------------------------------------------------------

enum { MOTION, STATES, CLOSURE, CLOSURE_RATE, EFFORT, KINEMATIC, NGROUP };

static void fill(struct ct_derivation *d, const struct ct_reduced *r, struct group g[NGROUP])
{
    struct ct_equations *e = d->e;
    for (size_t i = 0; i < e->nu; i++)
        add(d, &g[ct_speed_is_state(e, i) ? STATES : MOTION], speed_label(d, i), e->u[i].name,
            ct_reduced_left(e, r, i), ct_reduced_right(e, r, i));
    for (size_t i = 0; i < e->nrow; i++) {
        add(d, &g[CLOSURE], e->row[i].name, e->row[i].name, r->phi[i], CT_EX_ZERO);
        add(d, &g[CLOSURE_RATE], e->row[i].name, e->row[i].name, ct_reduced_row_left(e, r, i),
            ct_ex_neg(e->x, r->gam[i]));
    }
    for (size_t i = 0; i < e->ndriver; i++)
        add(d, &g[EFFORT], e->driver[i].name, NULL, r->effort[i], CT_EX_ZERO);
    for (size_t i = 0; i < e->nq; i++)
        if (e->q[i].quaternion >= 0)
            add(d, &g[KINEMATIC], NULL, NULL, e->q[i].symbol, r->rate[i]);
}

static void put_kinematic(struct ct_derivation *d, const struct group *g)
{
    ct_page_heading(&d->page, "kinematic equations: rates of the unit quaternions");
    ct_page_equations(&d->page);
    for (size_t i = 0; i < g->n; i++) {
        const char *name
            = ct_arena_printf(d->a, "%s'", ct_ex_symbol(d->e->x, g->at[i].left)->name);
        ct_page_equation(&d->page, NULL, ct_derivation_name(d, name),
                         ct_derivation_exact(d, g->at[i].right), NULL);
    }
}

static void put_efforts(struct ct_derivation *d, const struct group *g,
                        const struct ct_provenance *p)
{
    ct_page_heading(&d->page, "efforts of the drivers");
    ct_page_equations(&d->page);
    for (size_t i = 0; i < g->n; i++) {
        struct ct_page_equation *e
            = ct_page_equation(&d->page, NULL, ct_derivation_effort(d, g->at[i].label),
                               ct_derivation_text(d, g->at[i].left), NULL);
        if (p)
            e->right_components = components_of(d, p, CT_EQUATION_EFFORT, i, false, e->right);
    }
}

// Lists all expressions of the equations and definitions; returns their number.
static size_t list_shown(struct ct_derivation *d, const struct group g[NGROUP],
                         const struct ct_reduced *r, ct_ex **e)
{
    size_t n = 0, cap = 0;
    *e = NULL;
    for (size_t k = 0; k < NGROUP; k++)
        for (size_t i = 0; i < g[k].n; i++) {
            CT_PUSH(d->a, *e, n, cap, g[k].at[i].left);
            CT_PUSH(d->a, *e, n, cap, g[k].at[i].right);
        }
    for (size_t i = 0; i < r->definitions.n; i++)
        CT_PUSH(d->a, *e, n, cap, r->definitions.at[i].value);
    return n;
}

// Does a symbol occur in an equation or a definition?
static bool shows(struct ct_derivation *d, const struct group g[NGROUP],
                  const struct ct_reduced *r, ct_ex symbol)
{
    struct ct_exs *x = d->e->x;
    ct_ex *e;
    const size_t n = list_shown(d, g, r, &e), nwalk = ct_ex_walk(x, e, n);
    for (size_t i = 0; i < nwalk; i++)
        if (x->stack[i] == symbol.id)
            return true;
    return false;
}

// Explains the symbols of switches and memories.
static void put_switches(struct ct_derivation *d, const struct group g[NGROUP],
                         const struct ct_reduced *r)
{
    const struct ct_equations *e = d->e;
    if (e->nswitch) {
        ct_page_heading(&d->page,
                        "switches, constant between events: 1 if the relation holds, else 0");
        ct_page_equations(&d->page);
    }
    for (size_t i = 0; i < e->nswitch; i++) {
        const struct ct_switch *m = &e->switches[i];
        const ct_ex holds = ct_ex_fun2(e->x, m->op, m->g, CT_EX_ZERO);
        ct_page_equation(&d->page, NULL, ct_derivation_text(d, m->symbol),
                         ct_derivation_text(d, holds), NULL);
    }
    for (size_t i = 0; i < e->nmemory; i++)
        if (shows(d, g, r, e->memory[i].symbol))
            ct_page_sentence(&d->page, "%s: %s", ct_ex_symbol(e->x, e->memory[i].symbol)->name,
                             ct_memory_is_updated(&e->memory[i])
                                 ? "value at the last step"
                                 : "constant, from the assembled start");
}

// ---- matrices ------------------------------------------------------------------------------

static const char *speed_name(struct ct_derivation *d, size_t i)
{
    return ct_derivation_text(d, d->e->u[i].derivative);
}

// Entries of nrow rows; row: their names, columns are those of the accelerations. is_symmetric:
// the lower triangle is given, and the other one stays blank.
static bool put_matrix(struct ct_derivation *d, const char *const *row, size_t nrow,
                       const struct ct_entry *entry, const ct_ex *value, size_t n,
                       bool is_symmetric)
{
    const size_t nu = d->e->nmotion;
    const char **cell = CT_NEWN(d->a, const char *, nrow *nu + 1);
    for (size_t k = 0; k < n; k++) {
        const size_t i = (size_t)entry[k].row, j = (size_t)entry[k].column;
        if (j >= nu) // of a state of the model, which is 1
            continue;
        cell[i * nu + j] = ct_derivation_text(d, value[k]);
    }
    ct_page_matrix(&d->page, nu + 1);
    ct_page_cell(&d->page, "");
    for (size_t j = 0; j < nu; j++)
        ct_page_cell(&d->page, speed_name(d, j));
    for (size_t i = 0; i < nrow; i++) {
        ct_page_cell(&d->page, row[i]);
        for (size_t j = 0; j < nu; j++)
            ct_page_cell(&d->page, cell[i * nu + j]        ? cell[i * nu + j]
                                   : is_symmetric && j > i ? ""
                                                           : "0");
    }
    return ct_page_matrix_end(&d->page);
}

// More rows or columns never fit a page.
// Layout: of a page
enum { MOST_COLUMNS = 40 };

// A matrix larger than a page is only mentioned; its entries are in the equations.
void ct_derivation_put_matrices(struct ct_derivation *d, const struct ct_reduced *r)
{
    const struct ct_equations *e = d->e;
    const char **row = CT_NEWN(d->a, const char *, e->nu + e->nrow + 1);
    static const char larger[] = "%zu x %zu, too wide to print; its entries are in the "
                                 "equations below";
    const size_t nu = e->nmotion;
    if (nu < 2)
        return;
    for (size_t i = 0; i < nu; i++)
        row[i] = ct_derivation_name(d, speed_label(d, i));
    ct_page_heading(&d->page, "mass matrix M (symmetric)");
    if (nu > MOST_COLUMNS || !put_matrix(d, row, nu, e->M, r->M, e->nM, true))
        ct_page_sentence(&d->page, larger, nu, nu);
    if (!e->nrow)
        return;
    ct_page_heading(&d->page, "Jacobian J of the constraints");
    for (size_t i = 0; i < e->nrow; i++)
        row[i]
            = ct_derivation_is_latex(d)
                ? ct_arena_printf(d->a, "\\mathrm{%s}", ct_latex_quoted(d->a, e->row[i].name))
                : e->row[i].name;
    if (nu > MOST_COLUMNS || e->nrow > MOST_COLUMNS
        || !put_matrix(d, row, e->nrow, e->J, r->J, e->nJ, false))
        ct_page_sentence(&d->page, larger, e->nrow, nu);
}

static const char *count(struct ct_derivation *d, size_t n, const char *one, const char *many)
{
    return n == 0 ? ct_arena_printf(d->a, "no %s", many)
                  : ct_arena_printf(d->a, "%zu %s", n, n == 1 ? one : many);
}

// Expressions with definitions: collected ones or those of the recursion, whichever is shorter.
static void share(struct ct_derivation *d, struct ct_reduced *r)
{
    struct ct_reduced plain;
    ct_reduced_label(d->e, CT_BIAS);
    ct_reduced_prepare(d->a, d->e, false, &plain);
    ct_reduced_share(d->a, d->e, &plain);
    if (r->is_collected)
        ct_reduced_share(d->a, d->e, r);
    if (!r->is_collected || plain.size < r->size)
        *r = plain;
}

static bool is_used(struct ct_exs *x, size_t nwalk, ct_ex symbol)
{
    for (size_t i = 0; i < nwalk; i++)
        if (x->stack[i] == symbol.id)
            return true;
    return false;
}

// Parts that the equations use come before the other definitions.
static void put_before(struct ct_derivation *d, const struct ct_beam_parts *parts,
                       const struct group g[NGROUP], struct ct_reduced *r)
{
    struct ct_exs *x = d->e->x;
    const struct ct_definitions own = r->definitions, *all = &parts->definitions;
    ct_ex *symbol = CT_NEWN(d->a, ct_ex, all->n + 1), *value = CT_NEWN(d->a, ct_ex, all->n + 1),
          *root = NULL;
    size_t n = 0, cap = 0;
    for (size_t k = 0; k < NGROUP; k++)
        for (size_t i = 0; i < g[k].n; i++) {
            CT_PUSH(d->a, root, n, cap, g[k].at[i].left);
            CT_PUSH(d->a, root, n, cap, g[k].at[i].right);
        }
    for (size_t i = 0; i < own.n; i++)
        CT_PUSH(d->a, root, n, cap, own.at[i].value);
    size_t nwalk = ct_ex_walk(x, root, n);
    bool *used = CT_NEWN(d->a, bool, all->n + 1);
    for (int pass = 0; pass < 2; pass++) { // an angular velocity is used only by other parts
        for (size_t i = 0; i < all->n; i++)
            if (!used[i] && (used[i] = is_used(x, nwalk, all->at[i].symbol)))
                CT_PUSH(d->a, root, n, cap, all->at[i].value);
        nwalk = ct_ex_walk(x, root, n);
    }
    r->definitions.at = CT_NEWN(d->a, struct ct_reduced_definition, all->n + own.n + 1);
    r->definitions.n = 0;
    for (size_t i = 0; i < all->n; i++) {
        symbol[i] = all->at[i].symbol;
        value[i] = all->at[i].full;
        if (used[i])
            r->definitions.at[r->definitions.n++] = all->at[i];
    }
    r->npart = r->definitions.n;
    for (size_t i = 0; i < own.n; i++) {
        struct ct_reduced_definition *o = &r->definitions.at[r->definitions.n++];
        *o = own.at[i];
        o->full = ct_ex_subst(x, o->full, symbol, value, all->n);
    }
}

// M, Q and efforts in named parts. False: an entry of M that vanishes in the equations does not
// vanish in named parts.
static bool take_named(const struct ct_equations *e, const struct ct_named_dynamics *named,
                       struct ct_reduced *r)
{
    size_t taken = 0;
    for (size_t i = 0, k = 0; i < e->nM; i++) { // both row by row
        while (k < named->nM
               && (named->M[k].row < e->M[i].row
                   || (named->M[k].row == e->M[i].row && named->M[k].column < e->M[i].column)))
            k++;
        const bool is_there = k < named->nM && named->M[k].row == e->M[i].row
                           && named->M[k].column == e->M[i].column;
        r->M[i] = is_there ? named->M[k].value : CT_EX_ZERO;
        taken += is_there;
    }
    for (size_t i = 0; i < e->nu; i++)
        r->Q[i] = named->Q[i];
    for (size_t i = 0; i < e->ndriver; i++)
        r->effort[i] = named->effort[i];
    return taken == named->nM;
}

// Prepares r with the parts of beams by name. False: take_named fails.
static bool name_parts(struct ct_derivation *d, const struct ct_beam_parts *parts,
                       struct ct_reduced *r)
{
    struct group g[NGROUP] = {0}, shared[NGROUP] = {0};
    struct ct_named_dynamics named;
    ct_reduced_label(d->e, CT_BIAS);
    ct_named_dynamics_derive(d->a, d->e, parts->inertia, &named);
    ct_reduced_prepare(d->a, d->e, false, r);
    if (!take_named(d->e, &named, r))
        return false;
    ct_reduced_collect_all(d->a, d->e, r);
    fill(d, r, g);
    if (!r->is_collected || is_long(d, g, NGROUP))
        ct_reduced_share(d->a, d->e, r);
    fill(d, r, shared);
    put_before(d, parts, shared, r);
    return true;
}

// Expressions without definitions; false: they are too long to read.
static bool prepare(struct ct_derivation *d, struct ct_reduced *r)
{
    struct group g[NGROUP] = {0};
    ct_reduced_prepare(d->a, d->e, true, r);
    fill(d, r, g);
    return r->is_collected && !is_long(d, g, NGROUP);
}

void ct_derivation_reduce(struct ct_derivation *d, struct ct_reduced *r)
{
    struct ct_beam_parts parts = {0};
    if (d->is_recursive) {
        ct_reduced_recur(d->a, d->e, r);
        return;
    }
    if (prepare(d, r))
        return;
    if (d->e->nu <= CT_MOST_MATRIX_SPEEDS)
        ct_beam_parts_derive(d->a, d->e, CT_LONG_PARTS_NONE, &parts);
    if (!parts.definitions.n || !name_parts(d, &parts, r)) {
        ct_reduced_prepare(d->a, d->e, true, r);
        share(d, r);
    }
}

// Text and LaTeX print the parts of beams with their terminal equations; HTML folds them.
static void put_definitions(struct ct_derivation *d, const struct ct_reduced *r)
{
    const bool is_html = d->page.look == CT_LOOK_HTML;
    const struct ct_definitions own
        = {r->definitions.at + r->npart, r->definitions.n - r->npart};
    if (r->npart && !is_html)
        ct_page_sentence(&d->page,
                         "s, i, m_rf, m_thetaf, m_ff, Q_vf, F_v, T_v and V_q of a beam: its "
                         "matrices, printed by --show terminal");
    ct_derivation_put_definitions(d, "with", is_html ? &r->definitions : &own);
}

bool ct_derivation_blocks(struct ct_derivation *d, struct ct_reduced *r,
                          struct ct_beam_blocks *s)
{
    struct ct_beam_parts *parts = CT_NEW(d->a, struct ct_beam_parts);
    if (d->is_recursive || d->e->nu > CT_MOST_MATRIX_SPEEDS || !ct_beam_parts_exist(d->e)
        || prepare(d, r))
        return false;
    ct_reduced_label(d->e, CT_BIAS);
    ct_beam_parts_derive(d->a, d->e, CT_LONG_PARTS_TOO, parts);
    return parts->definitions.n && ct_beam_blocks_derive(d->a, d->e, parts, r, s);
}

// Explains the names of blocks, before the definitions.
static void explain_blocks(struct ct_derivation *d, const struct ct_beam_blocks *s)
{
    for (size_t i = 0; i < s->n; i++) {
        const struct ct_block_row *r = &s->row[i];
        if (r->beam < 0 || r->coordinate >= 0)
            continue;
        const struct ct_flexible *f = s->block[r->beam].f;
        const char *names = "";
        for (int k = 0; k < f->nelastic; k++)
            names = ct_arena_printf(d->a, "%s%s%s", names, k ? ", " : "", f->elastic[k].name);
        ct_page_sentence(&d->page, "%s = [%s]", r->label, names);
    }
    ct_page_sentence(
        &d->page, "s, i, m_rf, m_thetaf, m_ff, K_f, Q_vf, F_v, T_v and V_q of a beam: its "
                  "matrices, printed by --show terminal; m_rf_B.x: the entries along x of all "
                  "coordinates of beam B, as a row, ' as a column; Q_B: generalised forces of "
                  "joints, loads and outboard bodies along these, zero where not listed");
}

// Rows of blocks, and the lines that belong to one below it.
static void put_blocks(struct ct_derivation *d, const struct ct_beam_blocks *s)
{
    struct ct_exs *x = d->e->x;
    ct_page_equations(&d->page);
    for (size_t i = 0; i < s->n; i++) {
        const struct ct_block_row *r = &s->row[i];
        ct_page_equation(&d->page, r->label, ct_derivation_text(d, ct_block_left(x, r)),
                         ct_derivation_text(d, ct_block_right(x, r)), NULL);
    }
}

// Explains the names of the recursion that occur.
static const char *legend(struct ct_derivation *d, const struct ct_definitions *list)
{
    static const char *const name[][2]
        = {{"phi_", "phi, c, s: angle of a body, its cosine and sine"},
           {"R_", "R: rotation of a body"},
           {"w_", "w: angular velocity"},
           {"al_", "al: angular acceleration"},
           {"d_", "d: vector to a point from the preceding one"},
           {"v_", "v: rate of d"},
           {"a_", "a: acceleration of a point minus gravity"},
           {"m_", "m: mass of the bodies outboard of a point"},
           {"h_", "h: first moment of a body with these masses at its points"},
           {"I_", "I: its inertia with these masses"},
           {"F_", "F: force on the bodies outboard of a point, minus m*a"},
           {"T_", "T: torque on a body and the bodies outboard of it"}};
    struct ct_growing_text s = {0};
    for (size_t k = 0; k < COUNT(name); k++)
        for (size_t i = 0; i < list->n; i++)
            if (!strncmp(ct_ex_symbol(d->e->x, list->at[i].symbol)->name, name[k][0],
                         strlen(name[k][0]))) {
                ct_derivation_append(d, &s, "; ");
                ct_derivation_append(d, &s, name[k][1]);
                break;
            }
    return s.n ? s.at : "";
}

static void put_extent(struct ct_derivation *d, const struct group g[NGROUP],
                       const struct ct_reduced *r)
{
    struct ct_exs *x = d->e->x;
    ct_ex *e;
    const size_t n = list_shown(d, g, r, &e), nwalk = ct_ex_walk(x, e, n);
    size_t nterm = r->definitions.n + d->e->nu;
    for (size_t i = 0; i < nwalk; i++) {
        const unsigned char op = ct_ex_node(x, (ct_ex){x->stack[i]})->op;
        nterm += op == CT_OP_ADD || op == CT_OP_SUB;
    }
    ct_page_sentence(&d->page,
                     "recursive form, as there are more than %d speeds: %zu named expressions, "
                     "%zu terms in all%s",
                     CT_MOST_MATRIX_SPEEDS, r->definitions.n, nterm,
                     legend(d, &r->definitions));
}

void ct_stage_reduced(struct ct_derivation *d)
{
    struct ct_equations *e = d->e;
    struct ct_reduced r;
    struct group g[NGROUP] = {0};
    struct ct_provenance origins,
        *p = d->page.look == CT_LOOK_HTML && !d->is_recursive ? &origins : NULL;
    struct ct_beam_blocks blocks;
    const bool has_blocks
        = d->page.look == CT_LOOK_TEXT && ct_derivation_blocks(d, &r, &blocks);
    if (has_blocks)
        r.definitions = blocks.definitions;
    else
        ct_derivation_reduce(d, &r);
    fill(d, &r, g);
    if (p)
        ct_provenance_derive(d, &r, p);
    ct_page_title(&d->page, "Equations of motion");
    ct_page_sentence(
        &d->page, "%s, %s%s%s%s", count(d, e->nmotion, "unknown speed", "unknown speeds"),
        count(d, e->nrow, "constraint", "constraints"), e->nstate ? ", " : "",
        e->nstate ? count(d, e->nstate, "state", "states") : "",
        e->nmotion ? "; each equation is the cutset of a branch, projected on its motion" : "");
    if (has_blocks)
        explain_blocks(d, &blocks);
    if (r.is_recursive)
        put_extent(d, g, &r);
    put_definitions(d, &r);
    if (!has_blocks && !r.is_recursive)
        ct_derivation_put_matrices(d, &r);
    if (e->nmotion) {
        ct_page_heading(&d->page,
                        r.is_recursive
                            ? "motion: load of each branch along its motion = its effort"
                        : e->nrow ? "motion: M u' = Q + J' lambda"
                                  : "motion: M u' = Q");
        if (has_blocks)
            put_blocks(d, &blocks);
        else
            put_group(d, &g[MOTION], p, CT_EQUATION_MOTION, 0);
    }
    if (e->nstate) {
        ct_page_heading(&d->page, "rates of the states");
        put_group(d, &g[STATES], p, CT_EQUATION_MOTION, e->nmotion);
    }
    if (e->nrow) {
        ct_page_heading(&d->page, "constraints: Phi = 0");
        put_group(d, &g[CLOSURE], p, CT_EQUATION_POSITION, 0);
        ct_page_heading(&d->page, "constraints, differentiated twice: J u' = -gam");
        put_group(d, &g[CLOSURE_RATE], p, CT_EQUATION_ACCELERATION, 0);
    }
    if (g[EFFORT].n)
        put_efforts(d, &g[EFFORT], p);
    put_switches(d, g, &r);
    if (g[KINEMATIC].n)
        put_kinematic(d, &g[KINEMATIC]);
}
