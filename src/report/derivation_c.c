// The reduced equations as one C function: parameters, unknowns, definitions, results.
#include "report/derivation.h"

#include <ctype.h>
#include <string.h>

struct names {
    struct ct_derivation *d;
    const char **of; // by symbol; NULL until it is used
    size_t n;
};

static bool is_keyword(const char *s)
{
    static const char *const word[]
        = {"auto", "break", "case", "char", "const", "continue", "default", "do", "double",
           "else", "enum", "extern", "float", "for", "goto", "if", "inline", "int", "long",
           "register", "restrict", "return", "short", "signed", "sizeof", "static", "struct",
           "switch", "typedef", "union", "unsigned", "void", "volatile", "while",
           // names used by the function itself and by math.h
           "t", "q", "u", "M", "Q", "J", "Phi", "gam", "mode", "kept", "table", "sin", "cos",
           "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "log", "sqrt",
           "pow", "fabs", "y0", "y1", "yn", "j0", "j1", "jn", "gamma"};
    for (size_t i = 0; i < COUNT(word); i++)
        if (!strcmp(word[i], s))
            return true;
    return false;
}

static bool is_taken(const struct names *n, const char *name)
{
    for (size_t i = 0; i < n->n; i++)
        if (n->of[i] && !strcmp(n->of[i], name))
            return true;
    return is_keyword(name);
}

static const char *symbol(void *data, struct ct_arena *a, const struct ct_sym *s)
{
    struct names *n = data;
    const size_t k = (size_t)(s - n->d->e->x->sym);
    if (s->kind == CT_SYM_TIME)
        return "t";
    if (s->kind == CT_SYM_SWITCH || s->kind == CT_SYM_MEMORY)
        return ct_arena_printf(a, s->kind == CT_SYM_SWITCH ? "mode[%u]" : "kept[%u]", s->index);
    if (!n->of[k]) {
        const char *name = ct_c_name(n->d->a, s->name); // outlives the arena a
        for (int i = 2; is_taken(n, name); i++)
            name = ct_arena_printf(n->d->a, "%s_%d", ct_c_name(a, s->name), i);
        n->of[k] = name;
    }
    return n->of[k];
}

struct writer {
    FILE *out;
    struct ct_derivation *d;
    struct names names;
    struct ct_print print;
    bool *is_used; // by symbol
};

static const char *text(struct writer *w, ct_ex e)
{
    return ct_derivation_text_as(w->d, e, &w->print);
}

static void mark_below(struct writer *w, const ct_ex *root, size_t nroot)
{
    struct ct_exs *x = w->d->e->x;
    const size_t n = ct_ex_walk(x, root, nroot);
    for (size_t k = 0; k < n; k++)
        if (ct_ex_symbol(x, (ct_ex){x->stack[k]}))
            w->is_used[x->node[x->stack[k]].a] = true;
}

// Declares only what the results use, to avoid compiler warnings. Definitions use earlier ones
// only.
static void mark_used(struct writer *w, const struct ct_reduced *r)
{
    const struct ct_exs *x = w->d->e->x;
    const struct ct_equations *e = w->d->e;
    w->is_used = CT_NEWN(w->d->a, bool, x->nsym);
    mark_below(w, r->M, e->nM);
    mark_below(w, r->Q, e->nu);
    mark_below(w, r->J, e->nJ);
    mark_below(w, r->phi, e->nrow);
    mark_below(w, r->gam, e->nrow);
    for (size_t i = r->definitions.n; i-- > 0;)
        if (w->is_used[ct_ex_node(x, r->definitions.at[i].symbol)->a])
            mark_below(w, &r->definitions.at[i].value, 1);
}

static void put_symbol(struct writer *w, ct_ex e, const char *value)
{
    if (w->is_used[ct_ex_node(w->d->e->x, e)->a])
        fprintf(w->out, "    const double %s = %s;\n", text(w, e), value);
}

static void put_known(struct writer *w)
{
    const struct ct_model *m = w->d->m;
    const struct ct_equations *e = w->d->e;
    struct ct_arena *a = w->d->a;
    fprintf(w->out, "    (void)t, (void)q, (void)u, (void)mode, (void)kept;\n");
    fprintf(w->out, "    (void)M, (void)Q, (void)J, (void)Phi, (void)gam;\n");
    fprintf(w->out, "\n    // parameters\n");
    for (size_t i = 0; i < m->nparameter; i++)
        put_symbol(w, m->parameter[i].symbol, ct_number_c(a, m->parameter[i].value));
    fprintf(w->out, "\n    // unknowns\n");
    for (size_t i = 0; i < e->nq; i++)
        put_symbol(w, e->q[i].symbol, ct_arena_printf(a, "q[%zu]", i));
    for (size_t i = 0; i < e->nu; i++)
        put_symbol(w, e->u[i].symbol, ct_arena_printf(a, "u[%zu]", i));
}

static void put_results(struct writer *w, const struct ct_reduced *r)
{
    const struct ct_equations *e = w->d->e;
    fprintf(w->out, "\n    // mass matrix\n");
    for (size_t i = 0; i < e->nM; i++) {
        const int row = e->M[i].row, column = e->M[i].column;
        fprintf(w->out, "    M[%d + %zu * %d] = %s;\n", row, e->nu, column, text(w, r->M[i]));
        if (row != column)
            fprintf(w->out, "    M[%d + %zu * %d] = M[%d + %zu * %d];\n", column, e->nu, row,
                    row, e->nu, column);
    }
    fprintf(w->out, "\n    // forces\n");
    for (size_t i = 0; i < e->nu; i++)
        fprintf(w->out, "    Q[%zu] = %s;\n", i, text(w, r->Q[i]));
    if (!e->nrow)
        return;
    fprintf(w->out, "\n    // constraints\n");
    for (size_t i = 0; i < e->nJ; i++)
        fprintf(w->out, "    J[%d + %zu * %d] = %s;\n", e->J[i].row, e->nrow, e->J[i].column,
                text(w, r->J[i]));
    for (size_t i = 0; i < e->nrow; i++)
        fprintf(w->out, "    Phi[%zu] = %s;\n", i, text(w, r->phi[i]));
    for (size_t i = 0; i < e->nrow; i++)
        fprintf(w->out, "    gam[%zu] = %s;\n", i, text(w, r->gam[i]));
}

// A name inside a one-line comment: characters that could end the line become blanks.
static void put_comment_name(FILE *out, const char *name)
{
    for (; *name; name++)
        fputc(iscntrl((unsigned char)*name) ? ' ' : *name, out);
}

static void put_head(struct writer *w, const char *name)
{
    const struct ct_equations *e = w->d->e;
    fputs("// ", w->out);
    put_comment_name(w->out, w->d->m->name ? w->d->m->name : "model");
    fprintf(w->out,
            ": M u' = Q + J' lam, Phi = 0, J u' + gam = 0\n//\n"
            "// M (%zu x %zu) and J (%zu x %zu) are column-major; entries that are always zero "
            "are not "
            "written.\n"
            "// mode: 0 or 1, the sides of comparisons (%zu); kept: values of the last step "
            "(%zu).\n",
            e->nu, e->nu, e->nrow, e->nu, e->nswitch, e->nmemory);
    fprintf(w->out, "#include <math.h>\n\n");
    if (e->x->ntable)
        fprintf(w->out, "// value of a sampled function or of one of its derivatives at x\n"
                        "double table(unsigned number, unsigned order, double x);\n\n");
    fprintf(
        w->out,
        "void %s_equations(double t, const double *q, const double *u, const double *mode,\n"
        "    const double *kept, double *M, double *Q, double *J, double *Phi, double "
        "*gam);\n\n"
        "void %s_equations(double t, const double *q, const double *u, const double *mode,\n"
        "    const double *kept, double *M, double *Q, double *J, double *Phi, double "
        "*gam)\n{\n",
        name, name);
}

void ct_derivation_print_c(FILE *out, struct ct_derivation *d)
{
    struct ct_reduced r;
    struct writer w = {.out = out, .d = d};
    ct_derivation_reduce(d, &r);
    w.names = (struct names){d, CT_NEWN(d->a, const char *, d->e->x->nsym), d->e->x->nsym};
    w.print = (struct ct_print){
        .style = CT_PRINT_C, .symbol = symbol, .data = &w.names, .limit = 1000000};
    mark_used(&w, &r);
    put_head(&w, ct_c_name(d->a, d->m->name ? d->m->name : "model"));
    put_known(&w);
    if (r.definitions.n)
        fprintf(out, "\n    // shared\n");
    for (size_t i = 0; i < r.definitions.n; i++)
        put_symbol(&w, r.definitions.at[i].symbol, text(&w, r.definitions.at[i].value));
    put_results(&w, &r);
    fprintf(out, "}\n");
}
