// The reduced equations as equations of a page.
#include "report/derivation.h"

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

static void put_group(struct ct_derivation *d, const struct group *g)
{
    ct_page_equations(&d->page);
    for (size_t i = 0; i < g->n; i++)
        ct_page_equation(&d->page, g->at[i].label, ct_derivation_text(d, g->at[i].left),
                         ct_derivation_text(d, g->at[i].right), NULL)
            ->name
            = g->at[i].name;
}

static const char *speed_label(struct ct_derivation *d, size_t i)
{
    const struct ct_u *u = &d->e->u[i];
    return u->q >= 0 ? d->e->q[u->q].name : u->name;
}

// ---- sharing ----------------------------------------------------------------------------------

static bool is_long(struct ct_derivation *d, const struct group *g, size_t n)
{
    size_t lines = 0;
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < g[k].n && lines <= CT_MOST_LINES; i++)
            lines += ct_derivation_lines(d, g[k].at[i].left)
                   + ct_derivation_lines(d, g[k].at[i].right);
    return lines > CT_MOST_LINES;
}

// ---- groups -----------------------------------------------------------------------------------

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

static void put_efforts(struct ct_derivation *d, const struct group *g)
{
    ct_page_heading(&d->page, "efforts of the drivers");
    ct_page_equations(&d->page);
    for (size_t i = 0; i < g->n; i++)
        ct_page_equation(&d->page, NULL, ct_derivation_effort(d, g->at[i].label),
                         ct_derivation_text(d, g->at[i].left), NULL);
}

// Does a symbol stand in one of the equations, or in a definition?
static bool shows(struct ct_derivation *d, const struct group g[NGROUP],
                  const struct ct_reduced *r, ct_ex symbol)
{
    struct ct_exs *x = d->e->x;
    ct_ex *e = NULL;
    size_t n = 0, cap = 0;
    for (size_t k = 0; k < NGROUP; k++)
        for (size_t i = 0; i < g[k].n; i++) {
            CT_PUSH(d->a, e, n, cap, g[k].at[i].left);
            CT_PUSH(d->a, e, n, cap, g[k].at[i].right);
        }
    for (size_t i = 0; i < r->definitions.n; i++)
        CT_PUSH(d->a, e, n, cap, r->definitions.at[i].value);
    const size_t nwalk = ct_ex_walk(x, e, n);
    for (size_t i = 0; i < nwalk; i++)
        if (x->stack[i] == symbol.id)
            return true;
    return false;
}

// Symbols that stand for what changes at events, or from one step to the next.
static void put_held(struct ct_derivation *d, const struct group g[NGROUP],
                     const struct ct_reduced *r)
{
    const struct ct_equations *e = d->e;
    if (e->nswitch) {
        ct_page_heading(&d->page, "held between events: 1 where it holds, else 0");
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

// ---- matrices ---------------------------------------------------------------------------------

static const char *speed_name(struct ct_derivation *d, size_t i)
{
    return ct_derivation_text(d, d->e->u[i].derivative);
}

// Entries of nrow rows; row: their names, columns are those of the accelerations. is_symmetric: the lower triangle
// is given, and the other one stays blank.
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
enum { MOST_COLUMNS = 40 };

// What is larger than a page stands in the equations alone, and this is said.
void ct_derivation_put_matrices(struct ct_derivation *d, const struct ct_reduced *r)
{
    const struct ct_equations *e = d->e;
    const char **row = CT_NEWN(d->a, const char *, e->nu + e->nrow + 1);
    static const char larger[] = "%zu x %zu, larger than a page; its entries stand in the "
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
    ct_reduced_label(d->e);
    ct_reduced_prepare(d->a, d->e, false, &plain);
    ct_reduced_share(d->a, d->e, &plain);
    if (r->is_collected)
        ct_reduced_share(d->a, d->e, r);
    if (!r->is_collected || plain.size < r->size)
        *r = plain;
}

void ct_derivation_reduce(struct ct_derivation *d, struct ct_reduced *r)
{
    struct group g[NGROUP] = {0};
    ct_reduced_prepare(d->a, d->e, true, r);
    fill(d, r, g);
    if (!r->is_collected || is_long(d, g, NGROUP))
        share(d, r);
}

void ct_stage_reduced(struct ct_derivation *d)
{
    struct ct_equations *e = d->e;
    struct ct_reduced r;
    struct group g[NGROUP] = {0};
    ct_derivation_reduce(d, &r);
    fill(d, &r, g);
    ct_page_title(&d->page, "Equations of motion");
    ct_page_sentence(
        &d->page, "%s, %s%s%s%s", count(d, e->nmotion, "unknown speed", "unknown speeds"),
        count(d, e->nrow, "constraint", "constraints"), e->nstate ? ", " : "",
        e->nstate ? count(d, e->nstate, "state", "states") : "",
        e->nmotion ? "; each equation is the cutset of a branch, projected on its motion" : "");
    ct_derivation_put_definitions(d, "with", &r.definitions);
    ct_derivation_put_matrices(d, &r);
    if (e->nmotion) {
        ct_page_heading(&d->page,
                        e->nrow ? "motion: M u' = Q + J' lambda" : "motion: M u' = Q");
        put_group(d, &g[MOTION]);
    }
    if (e->nstate) {
        ct_page_heading(&d->page, "rates of the states");
        put_group(d, &g[STATES]);
    }
    if (e->nrow) {
        ct_page_heading(&d->page, "constraints: Phi = 0");
        put_group(d, &g[CLOSURE]);
        ct_page_heading(&d->page, "constraints, differentiated twice: J u' = -gam");
        put_group(d, &g[CLOSURE_RATE]);
    }
    if (g[EFFORT].n)
        put_efforts(d, &g[EFFORT]);
    put_held(d, g, &r);
    if (g[KINEMATIC].n)
        put_kinematic(d, &g[KINEMATIC]);
}
