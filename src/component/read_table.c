// Functions of time from files: {table: FILE.csv, column: NAME, interpolate: cubic|linear}.
//
// The file is CSV with a header; one column is `t`, strictly increasing. `cubic` is the natural
// spline: twice continuously differentiable, with second derivative 0 at both ends. A column
// heading may end with a unit, `angle [deg]`; otherwise `unit` gives it. `scale` is an additional
// factor.
#include "component/read.h"

#include "expr/quantity.h"
#include "expr/unit.h"
#include "io/sheet.h"
#include "io/text.h"

#include <errno.h>
#include <math.h>
#include <string.h>

static const size_t max_bytes = (size_t)256 << 20; // Limit: with a message

const char *ct_read_path_beside(struct ct_reader *r, const char *file)
{
    const char *slash = strrchr(r->m->file, '/');
    if (file[0] == '/' || !slash)
        return file;
    return ct_arena_printf(r->a, "%.*s%s", (int)(slash + 1 - r->m->file), r->m->file, file);
}

static bool read_csv(struct ct_reader *r, struct ct_mark mark, const char *path,
                     struct ct_sheet *csv)
{
    char *text;
    size_t n;
    switch (ct_text_read_regular(r->ctx->scratch, path, max_bytes, &text, &n)) {
    case CT_TEXT_UNREADABLE:
        return ct_error(r->ctx, mark, CT_E_TABLE, "cannot read the table '%s': %s", path,
                        strerror(errno));
    case CT_TEXT_TOO_BIG:
        return ct_error(r->ctx, mark, CT_E_TABLE, "the table '%s' is larger than %zu MiB", path,
                        max_bytes >> 20);
    case CT_TEXT_ENDLESS:
        return ct_error(r->ctx, mark, CT_E_TABLE, "the table '%s' is no regular file", path);
    case CT_TEXT_OK:
        break;
    }
    if (ct_sheet_parse(r->ctx, r->ctx->scratch, path, text, n, csv))
        return true;
    if (mark.file)
        ct_note(r->ctx, mark, "the table is used here");
    return false;
}

// Length of the name in a heading: of `angle`, or of the part before the unit in `angle [deg]`.
static size_t name_length(const char *head)
{
    size_t n = strlen(head);
    const char *bracket = strrchr(head, '[');
    if (!bracket || bracket == head || head[n - 1] != ']')
        return n;
    for (n = (size_t)(bracket - head); n && head[n - 1] == ' ';)
        n--;
    return n;
}

// The unit in a heading; NULL: none.
static const char *unit_in_head(struct ct_arena *a, const char *head)
{
    const size_t n = name_length(head);
    if (!head[n])
        return NULL;
    const char *unit = strrchr(head, '[') + 1;
    return ct_arena_strndup(a, unit, strlen(unit) - 1);
}

static bool is_called(const char *head, const char *name)
{
    const size_t n = name_length(head);
    return strcmp(head, name) == 0 || (strlen(name) == n && strncmp(head, name, n) == 0);
}

static bool find_column(struct ct_reader *r, const struct ct_node *node,
                        const struct ct_sheet *csv, const char *name, size_t *column)
{
    const char **names = CT_NEWN(r->ctx->scratch, const char *, csv->ncolumn);
    for (size_t k = 0; csv->nrow && k < csv->ncolumn; k++) {
        names[k] = csv->field[k];
        if (is_called(csv->field[k], name)) {
            *column = k;
            return true;
        }
    }
    return ct_error(r->ctx, node->mark, CT_E_TABLE, "the table '%s' has no column '%s'%s",
                    csv->file, name,
                    ct_read_suggestion(r, name, names, csv->nrow ? csv->ncolumn : 0));
}

// Parse a field that is one number, with blanks around it.
static bool parse_field(const char *text, double *value)
{
    text += strspn(text, " \t");
    const double sign = *text == '-' ? -1 : 1;
    text += *text == '-' || *text == '+';
    const size_t n = ct_number_parse(text, value);
    *value *= sign;
    return n && !text[n + strspn(text + n, " \t")] && isfinite(*value);
}

static bool read_column(struct ct_reader *r, const struct ct_sheet *csv, size_t column,
                        double *value)
{
    for (size_t i = 1; i < csv->nrow; i++) {
        const size_t k = i * csv->ncolumn + column;
        if (!parse_field(csv->field[k], &value[i - 1]))
            return ct_error(r->ctx, csv->mark[k], CT_E_TABLE_DATA,
                            "'%.60s' is not a finite number", csv->field[k]);
    }
    return true;
}

static bool check_increasing(struct ct_reader *r, const struct ct_sheet *csv, size_t column,
                             const double *x)
{
    for (size_t i = 2; i < csv->nrow; i++)
        if (!(x[i - 1] > x[i - 2]))
            return ct_error(r->ctx, csv->mark[i * csv->ncolumn + column], CT_E_TABLE_DATA,
                            "'t' must increase from row to row: %g follows %g", x[i - 1],
                            x[i - 2]);
    return true;
}

// Check that the table covers t = 0, where runs start.
static bool check_start(struct ct_reader *r, const struct ct_sheet *csv, size_t column,
                        const double *x, size_t n)
{
    const size_t row = x[0] > 0 ? 1 : n;
    if (x[0] <= 0 && x[n - 1] >= 0)
        return true;
    return ct_error(r->ctx, csv->mark[row * csv->ncolumn + column], CT_E_TABLE_DATA,
                    "the table %s at t = %g, but runs start at t = 0",
                    x[0] > 0 ? "begins" : "ends", x[row - 1]);
}

// Slopes m (n, out) of the natural spline through (x, y), n >= 2: the second derivative is
// continuous at inner points and 0 at the ends. Rows h_i = x_i+1 - x_i, d_i = (y_i+1 - y_i)/h_i:
//   2 m_0 + m_1 = 3 d_0
//   m_i-1/h_i-1 + 2 m_i (1/h_i-1 + 1/h_i) + m_i+1/h_i = 3 (d_i-1/h_i-1 + d_i/h_i)
//   m_n-2 + 2 m_n-1 = 3 d_n-2
// Diagonally dominant: elimination without pivoting is stable. work: n.
static void spline_slopes(size_t n, const double *x, const double *y, double *m, double *work)
{
    double h = x[1] - x[0], d = (y[1] - y[0]) / h;
    work[0] = 0.5; // upper diagonal after elimination
    m[0] = 1.5 * d;
    for (size_t i = 1; i < n; i++) {
        const double h0 = h, d0 = d;
        double below = 1 / h0, diagonal = 2 / h0, above = 0, right = 3 * d0 / h0;
        if (i + 1 < n) {
            h = x[i + 1] - x[i];
            d = (y[i + 1] - y[i]) / h;
            diagonal += 2 / h;
            above = 1 / h;
            right += 3 * d / h;
        }
        const double pivot = diagonal - below * work[i - 1];
        work[i] = above / pivot;
        m[i] = (right - below * m[i - 1]) / pivot;
    }
    for (size_t i = n - 1; i-- > 0;)
        m[i] -= work[i] * m[i + 1];
}

static bool is_no_name(const void *user, const char *word)
{
    (void)user;
    (void)word;
    return false;
}

// Read a unit. factor (out): one unit in SI units. what: the column; wanted: a unit of its
// dimension, NULL: any.
static bool read_unit(struct ct_reader *r, const char *what, const char *unit,
                      struct ct_mark mark, const char *wanted, double *factor)
{
    const struct ct_quantity q
        = {.text = what, .unit = unit, .mark = mark, .wanted = wanted, .is_name = is_no_name};
    *factor = 1;
    return ct_quantity_read(r->ctx, &q, factor);
}

// Read the times, in seconds.
static bool read_times(struct ct_reader *r, struct ct_mark mark, const struct ct_sheet *csv,
                       size_t column, double *x)
{
    const char *unit = unit_in_head(r->ctx->scratch, csv->field[column]);
    double second = 1;
    if (unit && !read_unit(r, csv->field[column], unit, mark, "s", &second))
        return false;
    if (!read_column(r, csv, column, x))
        return false;
    for (size_t i = 0; i + 1 < csv->nrow; i++)
        x[i] *= second;
    return true;
}

static bool fill_table(struct ct_reader *r, const struct ct_node *file,
                       const struct ct_node *column, bool cubic, struct ct_table *t)
{
    struct ct_sheet csv = {0};
    size_t kt = 0, ky = 0;
    if (!read_csv(r, file->mark, t->file, &csv))
        return false;
    const bool has_t = find_column(r, file, &csv, "t", &kt);
    if (!find_column(r, column, &csv, t->column, &ky) || !has_t)
        return false;
    if (csv.nrow < 3)
        return ct_error(r->ctx, file->mark, CT_E_TABLE_DATA,
                        "the table '%s' needs at least two rows below its header", t->file);
    t->n = csv.nrow - 1;
    double *x = CT_NEWN(r->a, double, t->n), *y = CT_NEWN(r->a, double, t->n), *m = NULL;
    t->column = ct_arena_strdup(r->a, csv.field[ky]); // with its unit
    if (!read_times(r, file->mark, &csv, kt, x) || !read_column(r, &csv, ky, y)
        || !check_increasing(r, &csv, kt, x) || !check_start(r, &csv, kt, x, t->n)) {
        ct_note(r->ctx, file->mark, "the table is used here");
        return false;
    }
    if (cubic) {
        m = CT_NEWN(r->a, double, t->n);
        spline_slopes(t->n, x, y, m, CT_NEWN(r->ctx->scratch, double, t->n));
    }
    t->x = x;
    t->y = y;
    t->m = m;
    return true;
}

static uint32_t add_table(struct ct_reader *r, struct ct_table t)
{
    struct ct_exs *x = r->m->x;
    const size_t number = x->ntable;
    CT_PUSH(r->a, r->sampled, x->ntable, x->table_cap, t);
    x->table = r->sampled;
    return (uint32_t)number;
}

// Factor from the values to SI units: from `unit`, else from the heading of the column.
static bool find_factor(struct ct_reader *r, const struct ct_node *node,
                        const struct ct_table *t, const char *wanted, double *factor)
{
    const struct ct_node *unit = ct_node_get(node, "unit");
    const char *in_head = unit_in_head(r->ctx->scratch, t->column), *text;
    *factor = 1;
    if (!unit)
        return !in_head
            || read_unit(r, t->column, in_head, ct_node_get(node, "column")->mark, wanted,
                         factor);
    if (!ct_read_text(r, unit, &text)
        || !read_unit(r, t->column, text, unit->mark, wanted, factor))
        return false;
    struct ct_unit u;
    size_t at;
    if (in_head && ct_unit_parse(in_head, strlen(in_head), &u, &at) == CT_UNIT_OK
        && u.si != *factor)
        return ct_error(r->ctx, unit->mark, CT_E_CONFLICT,
                        "the head of the column says '%s', 'unit' says %s", t->column, text);
    return true;
}

// Warn of values that are hardly radians, in a table without a unit.
static void check_degrees(struct ct_reader *r, const struct ct_node *node,
                          const struct ct_table *t)
{
    double most = 0;
    for (size_t i = 0; i < t->n; i++)
        most = fmax(most, fabs(t->y[i]));
    if (most > ct_read_full_turn)
        ct_warning(
            r->ctx, ct_node_get(node, "column")->mark, CT_E_DEGREES,
            "the column '%s' goes up to %g, read as radians: %.3g turns; add 'unit: deg' "
            "if it is in degrees, 'unit: rad' if not",
            t->column, most, most / ct_read_full_turn);
}

bool ct_read_table(struct ct_reader *r, const struct ct_node *node, const char *wanted,
                   ct_ex *e)
{
    static const char *const keys[] = {"table", "column", "interpolate", "unit", "scale"};
    static const char *const kinds[] = {"cubic", "linear"};
    const struct ct_node *file = ct_node_get(node, "table"),
                         *column = ct_node_get(node, "column"),
                         *interpolate = ct_node_get(node, "interpolate");
    bool ok = ct_read_keys(r, node, "a table", keys, COUNT(keys));
    int kind = 0;
    if (interpolate) {
        kind = ct_read_word(r, interpolate, "interpolation", kinds, COUNT(kinds));
        ok &= kind >= 0;
    }
    if (!column)
        ok = ct_error(r->ctx, node->mark, CT_E_KEY_MISSING, "the table needs 'column'");
    struct ct_table t = {0};
    ok &= ct_read_shape(r, file, CT_NODE_SCALAR, "the name of a file");
    ok &= !column || ct_read_text(r, column, &t.column);
    if (!ok)
        return false;
    t.file = ct_read_path_beside(r, file->text);
    // one table per file, column and kind, even if it is used several times
    const char *key = ct_arena_printf(r->ctx->scratch, "%s\n%s\n%d", t.file, t.column, kind);
    int number = ct_names_get(&r->table, key);
    if (number < 0) {
        if (!fill_table(r, file, column, kind == 0, &t))
            return false;
        number = (int)add_table(r, t);
        ct_names_put(r->ctx->scratch, &r->table, key, number);
    }
    const struct ct_table *table = &r->sampled[number];
    const struct ct_node *unit = ct_node_get(node, "unit"), *scale = ct_node_get(node, "scale");
    double factor;
    ct_ex times = CT_EX_ONE;
    if (!find_factor(r, node, table, scale ? NULL : wanted, &factor)
        || (scale && !ct_read_expr(r, scale, 0, NULL, &times)))
        return false;
    if (wanted && !strcmp(wanted, "rad") && !unit && !scale
        && name_length(table->column) == strlen(table->column))
        check_degrees(r, node, table);
    times = ct_ex_mul(r->m->x, times, ct_ex_const(r->m->x, factor));
    *e = ct_ex_mul(r->m->x, times, ct_ex_table(r->m->x, (uint32_t)number, 0, r->m->time));
    return true;
}

// ---- tables of inputs --------------------------------------------------------------------------

// Index of the input of a column; -1 after an error.
static int find_input(struct ct_reader *r, const struct ct_sheet *csv, size_t column)
{
    const struct ct_model *m = r->m;
    const char *head = csv->field[column],
               *name = ct_arena_strndup(r->ctx->scratch, head, name_length(head));
    const int i = ct_names_get(&m->parameter_index, name);
    const char **names = CT_NEWN(r->ctx->scratch, const char *, m->nparameter + 1);
    size_t n = 0;
    for (size_t k = 0; k < m->nparameter; k++)
        if (m->parameter[k].is_input)
            names[n++] = m->parameter[k].name;
    if (i >= 0 && m->parameter[i].is_played)
        ct_error(r->ctx, csv->mark[column], CT_E_NAME_TWICE, "two columns play the input '%s'",
                 name);
    else if (i >= 0 && m->parameter[i].is_input)
        return i;
    else if (i >= 0)
        ct_error(r->ctx, csv->mark[column], CT_E_INPUT,
                 "'%s' is a parameter of the model: what a file plays stands under 'inputs'",
                 name);
    else
        ct_error(r->ctx, csv->mark[column], CT_E_INPUT, "the model has no input '%s'%s", name,
                 ct_read_suggestion(r, name, names, n));
    return -1;
}

// y (n): values in SI units. The heading gives the unit, which must have the input's dimension.
static bool read_played(struct ct_reader *r, const struct ct_sheet *csv, size_t column,
                        const struct ct_parameter *p, double *y)
{
    const char *unit = unit_in_head(r->ctx->scratch, csv->field[column]);
    struct ct_unit own = {.si = 1};
    size_t at;
    double factor = 1;
    if (unit && !read_unit(r, csv->field[column], unit, csv->mark[column], p->unit, &factor))
        return false;
    if (!unit && p->unit && ct_unit_parse(p->unit, strlen(p->unit), &own, &at) == CT_UNIT_OK
        && own.si != 1)
        ct_warning(
            r->ctx, csv->mark[column], CT_E_UNIT,
            "the column '%s' has no unit and is read in SI units, while the input is given "
            "in %s: write '%s [%s]' if that is meant",
            p->name, p->unit, p->name, p->unit);
    if (!read_column(r, csv, column, y))
        return false;
    for (size_t i = 0; i + 1 < csv->nrow; i++)
        y[i] *= factor;
    return true;
}

// t (n, out): times. False if they are missing or do not increase, or if a linear table starts
// after t = 0.
static bool read_played_times(struct ct_reader *r, const struct ct_sheet *csv, bool holds,
                              size_t *column, double *t)
{
    *column = csv->ncolumn;
    for (size_t k = 0; k < csv->ncolumn; k++)
        if (is_called(csv->field[k], "t"))
            *column = k;
    if (*column == csv->ncolumn)
        return ct_error(r->ctx, csv->mark[0], CT_E_TABLE, "the table '%s' has no column 't'",
                        csv->file);
    return read_times(r, csv->mark[*column], csv, *column, t)
        && check_increasing(r, csv, *column, t)
        && (holds || check_start(r, csv, *column, t, csv->nrow - 1));
}

// Expression of the input as a function of time; before the first row of a piecewise constant
// table, its own value.
static ct_ex play(struct ct_reader *r, const struct ct_table *t, ct_ex own)
{
    struct ct_exs *x = r->m->x;
    const ct_ex time = r->m->time, value = ct_ex_table(x, add_table(r, *t), 0, time);
    if (!t->holds || t->x[0] <= 0)
        return value;
    return ct_ex_if(x, ct_ex_fun2(x, CT_OP_LT, time, ct_ex_const(x, t->x[0])), own, value);
}

bool ct_read_played_inputs(struct ct_reader *r, const char *path, bool holds)
{
    const struct ct_mark none = {0};
    struct ct_sheet csv = {0};
    path = ct_arena_strdup(r->a, path);
    if (!read_csv(r, none, path, &csv))
        return false;
    const size_t least = holds ? 1 : 2;
    if (csv.nrow < 1 + least)
        return ct_error(r->ctx, (struct ct_mark){.file = path}, CT_E_TABLE_DATA,
                        "a table of inputs needs %s below its header",
                        holds ? "a row" : "at least two rows");
    size_t kt;
    double *t = CT_NEWN(r->a, double, csv.nrow);
    bool ok = read_played_times(r, &csv, holds, &kt, t);
    for (size_t k = 0; k < csv.ncolumn; k++) {
        const int i = k == kt ? -1 : find_input(r, &csv, k);
        double *y = CT_NEWN(r->a, double, csv.nrow);
        if (i < 0 || !read_played(r, &csv, k, &r->m->parameter[i], y)) {
            ok &= k == kt;
            continue;
        }
        struct ct_parameter *p = &r->m->parameter[i];
        const struct ct_table table = {.file = path,
                                       .column = ct_arena_strdup(r->a, csv.field[k]),
                                       .n = csv.nrow - 1,
                                       .x = t,
                                       .y = y,
                                       .holds = holds};
        p->is_played = true;
        if (ok)
            p->played = play(r, &table, p->symbol);
    }
    return ok;
}
