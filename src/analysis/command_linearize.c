// Analysis `linearize`: state-space matrices of a system about a configuration, with named
// states, inputs and outputs.
#include "analysis/configuration.h"

#include "analysis/state_space.h"
#include "formulate/residual/residual.h"
#include "numeric/dense.h"
#include "report/archive.h"
#include "report/columns.h"
#include "report/json.h"
#include "analysis/model_variant.h"

#include <math.h>
#include <string.h>

struct ct_linearization {
    struct ct_ctx own;
    struct ct_system *system;
    struct ct_configuration at;
    struct ct_sim_options run;
    const char *inputs; // names as given by the caller; used during creation only
    struct ct_model *variant;
    struct ct_equations equations;
    size_t nstate, ninput, noutput;
    const char **state, **input, **output;
    size_t *parameter;     // index of the parameter of each input
    double *A, *B, *C, *D; // column-major
    // values at the configuration: states, outputs, rates of the states
    double *x0, *y0, *rate0;
};

static double *matrix(struct ct_linearization *s, size_t n, size_t m)
{
    return CT_NEWN(s->own.model, double, n *m + 1);
}

// ---- inputs ---------------------------------------------------------------------------------

// Splits a list of names at its commas.
static void split_names(struct ct_linearization *s, const char *text)
{
    struct ct_arena *a = s->own.model;
    size_t cap = 0;
    while (text) {
        const size_t n = strcspn(text, ",");
        const char *name = ct_arena_strndup(a, text, n);
        CT_PUSH(a, s->input, s->ninput, cap, name);
        text = text[n] ? text + n + 1 : NULL;
    }
}

static bool make_variant(struct ct_linearization *s, const char *inputs)
{
    if (inputs)
        split_names(s, inputs);
    else
        s->ninput = ct_variant_standard_inputs(&s->own, &s->system->model, &s->input);
    s->variant = ct_variant_create(&s->own, &s->system->model, s->ninput);
    s->parameter = CT_NEWN(s->own.model, size_t, s->ninput + 1);
    bool ok = true;
    for (size_t i = 0; i < s->ninput; i++)
        ok &= ct_variant_input(&s->own, s->variant, s->input[i], &s->parameter[i]);
    return ok
        && ct_equations_like(&s->own, s->variant, &s->system->equations, false, &s->equations);
}

// ---- derivatives of outputs and forces -----------------------------------------------------

struct slopes {
    double *q, *u, *a, *lam, *p; // n x nu, nu, nu, nrow, ninput
};

// Derivatives of f (n expressions) at the configuration.
static struct slopes evaluate_slopes(struct ct_linearization *s, const ct_ex *f, size_t n)
{
    const struct ct_equations *e = s->at.e;
    struct ct_evaluator *m = s->at.l->m;
    struct ct_arena *a = s->own.model;
    ct_ex *more = CT_NEWN(a, ct_ex, s->ninput + 1), *value;
    struct ct_slope *slope;
    struct ct_program program;
    for (size_t i = 0; i < s->ninput; i++)
        more[i] = s->variant->parameter[s->parameter[i]].symbol;
    const size_t nslope = ct_slopes_derive(e->build, a, f, n, more, s->ninput, &slope);
    value = CT_NEWN(a, ct_ex, nslope + 1);
    for (size_t i = 0; i < nslope; i++)
        value[i] = slope[i].value;
    ct_evaluator_add_program(a, m, e->x, value, nslope, &program);
    ct_program_run(&program, m->input);
    ct_evaluator_remove_program(m, &program);
    const size_t nu = e->nu;
    struct slopes out = {matrix(s, n, nu), matrix(s, n, nu), matrix(s, n, nu),
                         matrix(s, n, e->nrow), matrix(s, n, s->ninput)};
    double *const level[] = {out.q, out.u, out.a};
    for (size_t i = 0; i < nslope; i++) {
        const size_t d = slope[i].direction, last = 3 * nu + e->nrow;
        double *at = d >= last   ? out.p + n * (d - last)
                   : d >= 3 * nu ? out.lam + n * (d - 3 * nu)
                                 : level[d / nu] + n * (d % nu);
        at[slope[i].row] = program.out[i];
    }
    for (size_t k = e->nmotion; k < nu; k++)
        ct_state_take_as_place(out.q + n * k, out.u + n * k, out.a + n * k, n);
    return out;
}

// Rejects inputs on which the constraint rows depend: the linear equations would also need the
// rates of these inputs.
static bool check_inputs(struct ct_linearization *s)
{
    const struct ct_equations *e = s->at.e;
    ct_ex *row = CT_NEWN(s->own.model, ct_ex, 2 * e->nrow + 1);
    for (size_t i = 0; i < e->nrow; i++) {
        row[i] = e->row[i].phi;
        row[e->nrow + i] = e->row[i].v;
    }
    const struct slopes f = evaluate_slopes(s, row, 2 * e->nrow);
    for (size_t k = 0; k < s->ninput; k++)
        for (size_t i = 0; i < 2 * e->nrow; i++)
            if (f.p[i + 2 * e->nrow * k] != 0)
                return ct_error(&s->own, (struct ct_mark){.file = NULL}, CT_E_INPUT,
                                "the parameter '%s' changes lengths or places, which cannot be "
                                "an input",
                                s->input[k]);
    return true;
}

// ---- matrices -------------------------------------------------------------------------------

// out (n x k) += A (n x m) B (m x k)
static void add_product(struct ct_linearization *s, double *out, const double *A,
                        const double *B, size_t n, size_t m, size_t k)
{
    double *product = matrix(s, n, k);
    ct_matrix_multiply(product, A, B, (int)n, (int)m, (int)k);
    for (size_t i = 0; i < n * k; i++)
        out[i] += product[i];
}

// Changes of the full coordinates for k columns of y, w, w': dq, du, da (nu x k).
struct motion {
    double *dq, *du, *da;
};

static struct motion full_motion(struct ct_linearization *s, const double *y, const double *w,
                                 const double *dw, size_t k)
{
    const struct ct_linear *l = s->at.l;
    const size_t nu = (size_t)l->nu, f = (size_t)l->nfree;
    struct motion m = {matrix(s, nu, k), matrix(s, nu, k), matrix(s, nu, k)};
    add_product(s, m.dq, l->Z, y, nu, f, k);
    add_product(s, m.du, l->Z, w, nu, f, k);
    add_product(s, m.du, l->X, y, nu, f, k);
    add_product(s, m.da, l->Z, dw, nu, f, k);
    add_product(s, m.da, l->X, w, nu, f, k);
    add_product(s, m.da, l->X2, y, nu, f, k);
    return m;
}

// dlam (nrow x k) of least norm: J' dlam = M da + C du + K dq + r_p dp
static double *full_multipliers(struct ct_linearization *s, const struct motion *m,
                                const double *r_p, size_t k)
{
    const struct ct_linear *l = s->at.l;
    const size_t nu = (size_t)l->nu, nrow = (size_t)l->nrow, most = nu > nrow ? nu : nrow;
    // Derived: rows of unit size; J has round-off of about 1e-12, and some hundred terms are
    // added.
    // of dependent rows, as for the multipliers at the configuration
    const double tolerance = 1e-9;
    double *lam = matrix(s, nrow, k), *r = matrix(s, nu, k);
    if (!nrow || !nu)
        return lam;
    add_product(s, r, l->M, m->da, nu, nu, k);
    add_product(s, r, l->C, m->du, nu, nu, k);
    add_product(s, r, l->K, m->dq, nu, nu, k);
    for (size_t i = 0; i < nu * k && r_p; i++)
        r[i] += r_p[i];
    double *Jt = matrix(s, nu, nrow), *b = matrix(s, most, 1),
           *work = matrix(s, ct_lstsq_work((int)nu, (int)nrow), 1);
    int *iwork = CT_NEWN(s->own.model, int, nrow + 1);
    for (size_t c = 0; c < k; c++) {
        for (size_t i = 0; i < nrow; i++)
            for (size_t j = 0; j < nu; j++)
                Jt[j + nu * i] = l->J[i + nrow * j];
        memcpy(b, r + nu * c, nu * sizeof *b);
        ct_lstsq(b, Jt, (int)nu, (int)nrow, (int)nu, tolerance, iwork, work);
        memcpy(lam + nrow * c, b, nrow * sizeof *b);
    }
    return lam;
}

static void add_outputs(struct ct_linearization *s, double *out, const struct slopes *h,
                        const struct motion *m, const double *lam, size_t k)
{
    const struct ct_linear *l = s->at.l;
    const size_t nu = (size_t)l->nu, n = s->noutput;
    add_product(s, out, h->q, m->dq, n, nu, k);
    add_product(s, out, h->u, m->du, n, nu, k);
    add_product(s, out, h->a, m->da, n, nu, k);
    add_product(s, out, h->lam, lam, n, (size_t)l->nrow, k);
}

static void name_states(struct ct_linearization *s, const struct ct_state_space *x)
{
    const struct ct_linear *l = s->at.l;
    const struct ct_equations *e = s->at.e;
    struct ct_arena *a = s->own.model;
    s->state = CT_NEWN(a, const char *, x->n + 1);
    s->x0 = matrix(s, (size_t)x->n, 1);
    s->rate0 = matrix(s, (size_t)x->n, 1);
    for (int i = 0; i < x->nplace; i++) {
        const int k = x->place[i] < 0 ? -1 : l->independent[x->place[i]];
        s->state[i]
            = k < 0 ? ct_arena_printf(a, "place%d", i + 1) : ct_linear_coordinate(e, a, k);
        const bool is_state = k >= 0 && ct_speed_is_state(e, (size_t)k);
        s->x0[i] = is_state                 ? l->y[e->nq + (size_t)k]
                 : k >= 0 && e->u[k].q >= 0 ? l->y[e->u[k].q]
                                            : 0;
        s->rate0[i] = is_state ? l->a[k] : k >= 0 ? l->y[e->nq + (size_t)k] : 0;
    }
    for (int i = 0; i < x->nspeed; i++) {
        const int k = x->speed[i] < 0 ? -1 : l->independent[x->speed[i]], at = x->nplace + i;
        s->state[at] = k < 0 ? ct_arena_printf(a, "speed%d", i + 1) : e->u[k].name;
        s->x0[at] = k >= 0 ? l->y[e->nq + (size_t)k] : 0;
        s->rate0[at] = k >= 0 ? l->a[k] : 0;
    }
}

// No negative zeros.
static void clear_signs(double *A, size_t n)
{
    for (size_t i = 0; i < n; i++)
        A[i] += 0.0;
}

static void restore_input(const struct ct_linear *l)
{
    struct ct_evaluator *m = l->m;
    ct_evaluator_set(m, l->t, l->y);
    memcpy(m->input + m->at_a, l->a, m->nu * sizeof *l->a);
    memcpy(m->input + m->at_lam, l->lam, m->nrow * sizeof *l->lam);
}

static bool fill(struct ct_linearization *s)
{
    const struct ct_linear *l = s->at.l;
    const struct ct_equations *e = s->at.e;
    struct ct_arena *a = s->own.model;
    struct ct_state_space x;
    if (!ct_state_space_create(&s->own, a, l, &x))
        return false;
    const size_t n = s->nstate = (size_t)x.n, f = (size_t)l->nfree, nu = (size_t)l->nu,
                 ni = s->ninput, no = s->noutput = e->nresult;
    restore_input(l);
    ct_memory_start(l->m);
    const struct slopes r = evaluate_slopes(s, e->residual->r, nu);
    ct_ex *result = CT_NEWN(a, ct_ex, no + 1);
    s->output = CT_NEWN(a, const char *, no + 1);
    for (size_t i = 0; i < no; i++) {
        result[i] = e->result[i].value;
        s->output[i] = e->result[i].name;
    }
    const struct slopes h = evaluate_slopes(s, result, no);
    s->A = x.A;
    s->B = matrix(s, n, ni);
    s->C = matrix(s, no, n);
    s->D = h.p;
    double *g = matrix(s, f, ni), *y = matrix(s, f, ni), *w = matrix(s, f, ni),
           *dw = matrix(s, f, ni); // forces of the inputs along the independent speeds: -Z' r_p
    ct_matrix_multiply_transposed(g, l->Z, r.p, (int)f, (int)nu, (int)ni);
    for (size_t i = 0; i < f * ni; i++)
        g[i] = -g[i];
    add_product(s, s->B, x.B, g, n, f, ni);
    add_product(s, y, x.y_g, g, f, f, ni);
    add_product(s, w, x.w_g, g, f, f, ni);
    add_product(s, dw, x.dw_g, g, f, f, ni);
    const struct motion by_state = full_motion(s, x.y_x, x.w_x, x.dw_x, n),
                        by_input = full_motion(s, y, w, dw, ni);
    add_outputs(s, s->C, &h, &by_state, full_multipliers(s, &by_state, NULL, n), n);
    add_outputs(s, s->D, &h, &by_input, full_multipliers(s, &by_input, r.p, ni), ni);
    clear_signs(s->A, n * n);
    clear_signs(s->B, n * ni);
    clear_signs(s->C, no * n);
    clear_signs(s->D, no * ni);
    name_states(s, &x);
    ct_program_run(&l->m->result, l->m->input);
    s->y0 = matrix(s, no, 1);
    memcpy(s->y0, l->m->result.out, no * sizeof *s->y0);
    return true;
}

// ---- creation -------------------------------------------------------------------------------

static bool find(void *task)
{
    struct ct_linearization *s = task;
    s->system = ct_system_borrow(&s->own, s->system);
    if (!make_variant(s, s->inputs))
        return false;
    s->at.model = s->variant;
    s->at.equations = &s->equations;
    return ct_configuration_find(&s->own, s->system, &s->run, &s->at) && check_inputs(s)
        && fill(s);
}

struct ct_linearization *ct_linearize(struct ct_ctx *ctx, struct ct_system *sys,
                                      const struct ct_linearize_options *options)
{
    struct ct_linearize_options o;
    ct_options_take(&o, options, sizeof o);
    struct ct_linearization *s = ctx && sys ? ct_own_alloc(ctx, sizeof *s) : NULL;
    if (!s)
        return NULL;
    *s = (struct ct_linearization){.system = sys,
                                   .run = o.run,
                                   .inputs = o.inputs,
                                   .at = {.about = o.about, .hold_drivers = o.hold_drivers}};
    return ct_analysis_find(ctx, s, &s->own, &s->at, find);
}

void ct_linearization_destroy(struct ct_linearization *s)
{
    if (s)
        ct_analysis_free(s, &s->own, &s->at);
}

// ---- access --------------------------------------------------------------------------------

const double *ct_linearization_matrix(const struct ct_linearization *s, char name, size_t *rows,
                                      size_t *columns)
{
    size_t ignored;
    rows = rows ? rows : &ignored;
    columns = columns ? columns : &ignored;
    *rows = *columns = 0;
    if (!s)
        return NULL;
    const struct {
        char name;
        const double *value;
        size_t rows, columns;
    } all[] = {{'A', s->A, s->nstate, s->nstate},  {'B', s->B, s->nstate, s->ninput},
               {'C', s->C, s->noutput, s->nstate}, {'D', s->D, s->noutput, s->ninput},
               {'x', s->x0, s->nstate, 1},         {'y', s->y0, s->noutput, 1},
               {'r', s->rate0, s->nstate, 1}};
    for (size_t i = 0; i < COUNT(all); i++)
        if (all[i].name == name) {
            *rows = all[i].rows;
            *columns = all[i].columns;
            return all[i].value;
        }
    *rows = *columns = 0;
    return NULL;
}

const char *ct_linearization_name(const struct ct_linearization *s, char what, size_t i)
{
    if (!s)
        return NULL;
    const size_t n = what == 'x' ? s->nstate
                   : what == 'u' ? s->ninput
                   : what == 'y' ? s->noutput
                                 : 0;
    const char **const list = what == 'x' ? s->state : what == 'u' ? s->input : s->output;
    return i < n ? list[i] : NULL;
}

// ---- files ----------------------------------------------------------------------------------

struct output {
    struct ct_ctx *ctx;
    const struct ct_linearization *s;
    const char *path;
};

// [A B; C D] with the names of rows and columns.
static bool write_csv(const struct output *o)
{
    const struct ct_linearization *s = o->s;
    struct ct_arena *a = o->ctx->model;
    struct ct_columns t;
    ct_columns_init(&t, a, "row", CT_COLUMN_TEXT);
    for (size_t j = 0; j < s->nstate; j++)
        ct_columns_add(&t, s->state[j], CT_COLUMN_NUMBER);
    for (size_t j = 0; j < s->ninput; j++)
        ct_columns_add(&t, s->input[j], CT_COLUMN_NUMBER);
    for (size_t i = 0; i < s->nstate + s->noutput; i++) {
        const bool is_state = i < s->nstate;
        const size_t r = is_state ? i : i - s->nstate, n = is_state ? s->nstate : s->noutput;
        const double *left = is_state ? s->A : s->C, *right = is_state ? s->B : s->D;
        ct_columns_text(&t, 0,
                        is_state ? ct_arena_printf(a, "d/dt %s", s->state[r]) : s->output[r]);
        for (size_t j = 0; j < s->nstate; j++)
            ct_columns_number(&t, 1 + j, left[r + n * j]);
        for (size_t j = 0; j < s->ninput; j++)
            ct_columns_number(&t, 1 + s->nstate + j, right[r + n * j]);
    }
    return ct_columns_write(o->ctx, &t, o->path);
}

static void write_names(struct ct_json *j, const char *key, const char *const *name, size_t n)
{
    ct_json_array(j, key);
    for (size_t i = 0; i < n; i++)
        ct_json_text(j, NULL, name[i]);
    ct_json_end(j);
}

static void write_matrix(struct ct_json *j, struct ct_arena *a, const char *key,
                         const double *A, size_t n, size_t m)
{
    double *row = CT_NEWN(a, double, m + 1);
    ct_json_array(j, key);
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < m; k++)
            row[k] = A[i + n * k];
        ct_json_numbers(j, NULL, row, m);
    }
    ct_json_end(j);
}

static bool write_json(const struct output *o)
{
    const struct ct_linearization *s = o->s;
    struct ct_arena *a = o->ctx->model;
    struct ct_outfile file;
    struct ct_json j;
    if (!ct_outfile_open(o->ctx, &file, o->path))
        return false;
    ct_json_init(&j, file.stream);
    ct_json_object(&j, NULL);
    ct_json_text(&j, "model", s->system->model.name);
    ct_json_text(&j, "about", s->at.about);
    write_names(&j, "states", s->state, s->nstate);
    write_names(&j, "inputs", s->input, s->ninput);
    write_names(&j, "outputs", s->output, s->noutput);
    write_matrix(&j, a, "A", s->A, s->nstate, s->nstate);
    write_matrix(&j, a, "B", s->B, s->nstate, s->ninput);
    write_matrix(&j, a, "C", s->C, s->noutput, s->nstate);
    write_matrix(&j, a, "D", s->D, s->noutput, s->ninput);
    ct_json_numbers(&j, "x0", s->x0, s->nstate);
    ct_json_numbers(&j, "xdot0", s->rate0, s->nstate);
    ct_json_numbers(&j, "y0", s->y0, s->noutput);
    ct_json_end(&j);
    return ct_outfile_close(o->ctx, &file);
}

static bool write_archive(const struct output *o, enum ct_suffix suffix)
{
    const struct ct_linearization *s = o->s;
    struct ct_outfile file;
    struct ct_archive z;
    if (!ct_outfile_open(o->ctx, &file, o->path))
        return false;
    ct_archive_init(&z, o->ctx->model, suffix, &file);
    ct_archive_matrix(&z, "A", s->A, s->nstate, s->nstate);
    ct_archive_matrix(&z, "B", s->B, s->nstate, s->ninput);
    ct_archive_matrix(&z, "C", s->C, s->noutput, s->nstate);
    ct_archive_matrix(&z, "D", s->D, s->noutput, s->ninput);
    ct_archive_vector(&z, "x0", s->x0, s->nstate);
    ct_archive_vector(&z, "xdot0", s->rate0, s->nstate);
    ct_archive_vector(&z, "y0", s->y0, s->noutput);
    ct_archive_names(&z, "states", s->state, s->nstate);
    ct_archive_names(&z, "inputs", s->input, s->ninput);
    ct_archive_names(&z, "outputs", s->output, s->noutput);
    if (ct_archive_finish(o->ctx, &z))
        return ct_outfile_close(o->ctx, &file);
    ct_outfile_discard(&file);
    return false;
}

static bool write_all(void *task)
{
    const struct output *o = task;
    enum ct_suffix suffix;
    if (!ct_suffix_read(o->ctx, o->path, CT_SUFFIX_TABLE, &suffix))
        return false;
    return suffix == CT_SUFFIX_JSON                           ? write_json(o)
         : suffix == CT_SUFFIX_NPZ || suffix == CT_SUFFIX_MAT ? write_archive(o, suffix)
                                                              : write_csv(o);
}

bool ct_linearization_write(struct ct_ctx *ctx, const struct ct_linearization *s,
                            const char *path)
{
    if (!ctx || !s)
        return false;
    struct output o = {ctx, s, path};
    return s && ct_enter(ctx, write_all, &o);
}

static void print_names(FILE *out, const char *title, const char *const *name, size_t n)
{
    fprintf(out, "%-14s%zu", title, n);
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%s%s", i ? ", " : ": ", name[i]);
    fputc('\n', out);
}

static void print_summary(const void *object, FILE *out)
{
    const struct ct_linearization *s = object;
    ct_configuration_print(&s->at, out);
    print_names(out, "states", s->state, s->nstate);
    print_names(out, "inputs", s->input, s->ninput);
    print_names(out, "outputs", s->output, s->noutput);
}

void ct_linearization_print_summary(const struct ct_linearization *s, FILE *out)
{
    ct_print_to(out, print_summary, s);
}

char *ct_linearization_summary(const struct ct_linearization *s)
{
    return ct_print_text(print_summary, s);
}
