// Names and texts of the derivation; see derivation.h.
#include "report/derivation.h"

#include "expr/collect.h"
#include "formulate/dynamics/small_motion.h"

#include <string.h>

// A rate is printed as the primed coordinate; angular velocities keep their own names.
static const char *plain_name(const struct ct_derivation *d, const struct ct_sym *s)
{
    const struct ct_equations *e = d->e;
    const bool is_speed = s->kind == CT_SYM_U || s->kind == CT_SYM_A;
    if (!is_speed || s->index >= e->nu)
        return s->name;
    const struct ct_u *u = &e->u[s->index];
    const char *prime = s->kind == CT_SYM_A ? "'" : "";
    return u->q >= 0 ? ct_arena_printf(d->a, "%s'%s", e->q[u->q].name, prime)
                     : ct_arena_printf(d->a, "%s%s", u->name, prime);
}

// R_rod.xy of a definition (reduced.h) as a letter with subscripts; NULL for other names.
static const char *latex_definition(struct ct_arena *a, const char *name)
{
    static const char *const letter[][2]
        = {{"phi_", "\\varphi"}, {"c_", "c"}, {"s_", "s"}, {"R_", "R"}, {"w_", "\\omega"},
           {"al_", "\\alpha"},   {"d_", "d"}, {"v_", "v"}, {"a_", "a"}, {"F_", "F"},
           {"T_", "T"},          {"m_", "m"}, {"h_", "h"}, {"I_", "I"}, {"om_", "\\Omega"}};
    for (size_t i = 0; i < COUNT(letter); i++) {
        const size_t n = strlen(letter[i][0]);
        if (strncmp(name, letter[i][0], n))
            continue;
        const char *of = name + n, *dot = strrchr(of, '.');
        if (!dot || strspn(dot + 1, "xyz") != strlen(dot + 1))
            return ct_arena_printf(a, "%s_{\\mathrm{%s}}", letter[i][1],
                                   ct_latex_quoted(a, of));
        of = ct_arena_strndup(a, of, (size_t)(dot - of));
        return ct_arena_printf(a, "%s_{\\mathrm{%s},%s}", letter[i][1], ct_latex_quoted(a, of),
                               dot + 1);
    }
    return NULL;
}

// m_rf_rod.1.u.x of a beam (beam_parts.h); NULL for other names.
static const char *latex_part(struct ct_arena *a, const char *name)
{
    static const char *const letter[][2] = {{"m_rf_", "m_{rf"}, {"m_thetaf_", "m_{\\theta f"},
                                            {"m_ff_", "m_{ff"}, {"Q_vf_", "Q_{vf"},
                                            {"F_v_", "F_{v"},   {"T_v_", "T_{v"},
                                            {"V_q_", "V_{,q"},  {"i_", "i_{"}};
    for (size_t i = 0; i < COUNT(letter); i++) {
        const size_t n = strlen(letter[i][0]);
        if (!strncmp(name, letter[i][0], n))
            return ct_arena_printf(a, "%s%s\\mathrm{%s}}", letter[i][1],
                                   letter[i][1][strlen(letter[i][1]) - 1] == '{' ? "" : ",",
                                   ct_latex_quoted(a, name + n));
    }
    return NULL;
}

static bool is_coordinate_name(const char *name)
{
    const char *dot = strrchr(name, '.');
    return dot && strchr("qu", dot[1]) && strspn(dot + 2, "0123456789'") == strlen(dot + 2);
}

static const char *symbol(void *data, struct ct_arena *a, const struct ct_sym *s)
{
    const struct ct_derivation *d = data;
    const char *name = plain_name(d, s);
    if (!ct_derivation_is_latex(d))
        return name;
    if (s->kind == CT_SYM_LOCAL && latex_part(a, name))
        return latex_part(a, name);
    if (s->kind == CT_SYM_LOCAL && !is_coordinate_name(name)) {
        const char *definition = latex_definition(a, name);
        if (definition)
            return definition;
    }
    if (s->kind != CT_SYM_LAM)
        return ct_latex_name(a, name);
    return d->e->nrow == 1 ? "\\lambda" : ct_arena_printf(a, "\\lambda_{%u}", s->index + 1);
}

// ---- the order of parameters ---------------------------------------------------------------

// Order of factors: masses and inertias, then lengths, then gravity.
static int *rank_parameters(struct ct_derivation *d)
{
    struct ct_exs *x = d->e->x;
    const struct ct_model *m = d->m;
    int *rank = CT_NEWN(d->a, int, x->nsym);
    for (size_t i = 0; i < x->nsym; i++)
        rank[i] = 1;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 1; i < m->nbody && (pass == 0 || i == 1); i++) {
            const ct_ex *root = pass ? m->gravity.e : &m->body[i].mass;
            const size_t n = ct_ex_walk(x, root, pass ? 3 : 1);
            for (size_t k = 0; k < n; k++)
                if (ct_ex_symbol(x, (ct_ex){x->stack[k]}))
                    rank[x->node[x->stack[k]].a] = pass ? 2 : 0;
        }
    return rank;
}

static int rank(void *data, const struct ct_sym *s)
{
    const struct ct_derivation *d = data;
    const size_t k = (size_t)(s - d->e->x->sym);
    return k < d->nrank ? d->rank[k] : 1;
}

void ct_derivation_init(struct ct_derivation *d, struct ct_arena *a, struct ct_equations *e,
                        const struct ct_model *m, enum ct_look look)
{
    *d = (struct ct_derivation){.a = a, .e = e, .m = m, .page = {.arena = a, .look = look}};
    d->work = ct_arena_create_under(a);
    d->is_recursive
        = e->nmotion > CT_MOST_MATRIX_SPEEDS && !ct_small_motion_is_wanted(e->build);
    d->print = (struct ct_print){
        .style = look == CT_LOOK_TEXT ? CT_PRINT_TEXT : CT_PRINT_LATEX,
        .symbol = symbol,
        .rank = rank,
        .data = d,
        .fractions = true,
        .line = look == CT_LOOK_HTML ? CT_PAGE_PHONE : 0,
    };
    d->nrank = e->x->nsym;
    d->rank = rank_parameters(d);
}

void ct_derivation_append(struct ct_derivation *d, struct ct_growing_text *t, const char *more)
{
    for (; *more; more++)
        CT_PUSH(d->a, t->at, t->n, t->cap, *more);
    CT_PUSH(d->a, t->at, t->n, t->cap, '\0');
    t->n--;
}

const char *ct_derivation_text_as(struct ct_derivation *d, ct_ex v, const struct ct_print *p)
{
    const char *text = ct_arena_strdup(d->a, ct_ex_text(d->work, d->e->x, v, p));
    ct_arena_clear(d->work);
    return text;
}

const char *ct_derivation_text(struct ct_derivation *d, ct_ex v)
{
    return ct_derivation_text_as(d, v, &d->print);
}

const char *ct_derivation_exact(struct ct_derivation *d, ct_ex v)
{
    struct ct_print p = d->print;
    p.no_data = true;
    return ct_derivation_text_as(d, v, &p);
}

const char *ct_derivation_collected(struct ct_derivation *d, ct_ex v)
{
    const struct ct_collect_options o = {.scratch = d->a};
    return ct_derivation_text(d, ct_ex_collect(d->e->x, v, &o));
}

const char *ct_derivation_name(struct ct_derivation *d, const char *name)
{
    return ct_derivation_is_latex(d) ? ct_latex_name(d->a, name) : name;
}

const char *ct_derivation_of(struct ct_derivation *d, const char *letter, const char *name)
{
    if (!ct_derivation_is_latex(d))
        return ct_arena_printf(d->a, "%s(%s)", letter, name);
    const char *word = !strcmp(letter, "w")  ? "\\omega"
                     : !strcmp(letter, "al") ? "\\alpha"
                                             : letter;
    return ct_arena_printf(d->a, "\\boldsymbol{%s}_{\\mathrm{%s}}", word,
                           ct_latex_quoted(d->a, name));
}

const char *ct_derivation_effort(struct ct_derivation *d, const char *coordinate)
{
    return ct_derivation_is_latex(d)
             ? ct_arena_printf(d->a, "\\tau\\left(%s\\right)", ct_latex_name(d->a, coordinate))
             : ct_arena_printf(d->a, "effort(%s)", coordinate);
}

const char *ct_derivation_vector(struct ct_derivation *d, ct_ex3 v)
{
    if (ct_ex3_is_zero(v))
        return "0";
    return ct_arena_printf(d->a,
                           ct_derivation_is_latex(d) ? "(%s,\\; %s,\\; %s)" : "[%s, %s, %s]",
                           ct_derivation_text(d, v.e[0]), ct_derivation_text(d, v.e[1]),
                           ct_derivation_text(d, v.e[2]));
}

static bool is_number(struct ct_derivation *d, ct_ex e, double want)
{
    double v;
    return ct_ex_is_const(d->e->x, e, &v) && v == want;
}

const char *ct_derivation_axis(struct ct_derivation *d, ct_ex3 n)
{
    static const char *const name[] = {"x", "y", "z"}, *const minus[] = {"-x", "-y", "-z"};
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        if (!ct_ex_is_zero(n.e[j]) || !ct_ex_is_zero(n.e[k]))
            continue;
        if (is_number(d, n.e[i], 1))
            return name[i];
        if (is_number(d, n.e[i], -1))
            return minus[i];
    }
    return ct_derivation_vector(d, n);
}

size_t ct_derivation_lines(struct ct_derivation *d, ct_ex v)
{
    return 1 + ct_text_width(ct_derivation_text(d, v)) / (CT_PAGE_WIDTH - 12);
}

void ct_derivation_put_definitions(struct ct_derivation *d, const char *heading,
                                   const struct ct_definitions *list)
{
    if (!list->n)
        return;
    ct_page_folded_heading(&d->page, d->page.look == CT_LOOK_HTML ? ct_arena_printf(
                                         d->a, "%s %zu named expression%s", heading, list->n,
                                         list->n == 1 ? "" : "s")
                                                                  : heading);
    ct_page_equations(&d->page);
    for (size_t i = 0; i < list->n; i++)
        ct_page_equation(&d->page, NULL, ct_derivation_text(d, list->at[i].symbol),
                         ct_derivation_text(d, list->at[i].value), NULL);
}

// ---- inertia -------------------------------------------------------------------------------

const char *ct_derivation_inertia_force(struct ct_derivation *d, const struct ct_body *body)
{
    const struct ct_build *b = d->e->build;
    const char *mass = ct_derivation_text(d, body->mass);
    const char *com = b->topology->node[b->topology->node_of_com[body - d->m->body]].name;
    if (ct_ex_is_zero(body->mass))
        return NULL;
    if (strchr(mass, ' '))
        mass = ct_arena_printf(d->a, "(%s)", mass);
    return ct_arena_printf(
        d->a, ct_derivation_is_latex(d) ? "%s \\, (%s - \\boldsymbol{g})" : "%s*(%s - g)", mass,
        ct_derivation_of(d, "a", com));
}

const char *ct_derivation_inertia_torque(struct ct_derivation *d, const struct ct_body *body)
{
    const bool latex = ct_derivation_is_latex(d);
    const char *name = body->instance.name;
    const char *al = ct_derivation_of(d, "al", name), *w = ct_derivation_of(d, "w", name);
    bool is_massless = true;
    for (int i = 0; i < 6; i++)
        is_massless &= ct_ex_is_zero(body->inertia[i]);
    if (is_massless || body->is_particle)
        return NULL;
    if (ct_ex_same(body->inertia[0], body->inertia[1])
        && ct_ex_same(body->inertia[1], body->inertia[2])) { // I w is parallel to w
        const char *I = ct_derivation_text(d, body->inertia[0]);
        if (strchr(I, ' '))
            I = ct_arena_printf(d->a, "(%s)", I);
        return ct_arena_printf(d->a, latex ? "%s \\, %s" : "%s*%s", I, al);
    }
    const char *I = ct_derivation_of(d, "I", name);
    return ct_arena_printf(d->a, latex ? "(%s %s + %s \\times %s %s)" : "(%s*%s + %s x %s*%s)",
                           I, al, w, I, w);
}
