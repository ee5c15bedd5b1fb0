// Printing of a listing as a C function; see c.h.
//
// A statement computes the result of one instruction, in the order of the listing; short
// expressions with a single reader are inlined. Statement k belongs to function k / split. A value
// that a later function reads is stored in w[].
#include "codegen/c.h"

#include "expr/print.h"

#include <assert.h>
#include <string.h>

static const uint32_t none = CT_VALUE_NONE;

struct text {
    char *s;
    size_t n, cap;
};

struct writer {
    struct ct_arena *arena;
    const struct ct_listing *l;
    struct ct_c_options o;
    uint32_t *statement; // by value: number of its statement
    uint32_t nstatement;
    struct statement {
        const struct ct_instruction *ins;
        uint32_t result; // index of the result in its instruction
    } * list;
    uint32_t *crossing; // by value: index in w[]; none if only its own function reads it
    uint32_t ncrossing;
    uint32_t *nread, *nread_here; // by value: number of reads in all, and in its own function
    const char *
        *within; // by value: its text if inlined in the one statement that reads it, else NULL
    const char **input; // by value of a symbol: i<slot>_<name>
    uint32_t *first_output,
        *next_output; // by value, by output: lists of 1 + k; 0 at the end
    size_t split;
    struct text text;
};

// ---- text -------------------------------------------------------------------------------------

static void put(struct writer *w, const char *s)
{
    for (; *s; s++)
        CT_PUSH(w->arena, w->text.s, w->text.n, w->text.cap, *s);
}

static void __attribute__((format(printf, 2, 3))) putf(struct writer *w, const char *fmt, ...)
{
    char line[512];
    va_list ap;
    va_start(ap, fmt);
    const int n = vsnprintf(line, sizeof line, fmt, ap);
    va_end(ap);
    if (n < (int)sizeof line) {
        put(w, line);
        return;
    }
    va_start(ap, fmt);
    put(w, ct_arena_vprintf(w->arena, fmt, ap));
    va_end(ap);
}

const char *ct_c_comment(struct ct_arena *a, const char *s)
{
    char *copy = ct_arena_strdup(a, s);
    for (char *c = copy; *c; c++) // two `?` start a trigraph, and one trigraph is a backslash
        if (*c == '*' || *c == '\\' || *c == '?' || (unsigned char)*c < ' ' || *c == 0x7f)
            *c = ' ';
    return copy;
}

// ---- statements and readers of values ----------------------------------------------------------

static bool is_statement(const struct writer *w, uint32_t v)
{
    return w->statement[v] != none;
}

static size_t part_of(const struct writer *w, uint32_t v)
{
    return w->statement[v] / w->split;
}

static void number_statements(struct writer *w)
{
    const struct ct_listing *l = w->l;
    w->statement = CT_NEWN(w->arena, uint32_t, l->nvalue);
    w->crossing = CT_NEWN(w->arena, uint32_t, l->nvalue);
    w->list = CT_NEWN(w->arena, struct statement, l->nvalue);
    w->nread = CT_NEWN(w->arena, uint32_t, l->nvalue);
    w->nread_here = CT_NEWN(w->arena, uint32_t, l->nvalue);
    w->within = CT_NEWN(w->arena, const char *, l->nvalue);
    for (size_t v = 0; v < l->nvalue; v++)
        w->statement[v] = w->crossing[v] = none;
    for (const struct ct_instruction *i = l->ins; i < l->ins + l->nins; i++)
        for (uint32_t r = 0; r < i->nres; r++) {
            w->list[w->nstatement] = (struct statement){i, r};
            w->statement[i->res[r]] = w->nstatement++;
        }
    for (uint32_t k = 0; k < w->nstatement; k++)
        for (uint32_t j = 0; j < w->list[k].ins->narg; j++) {
            const uint32_t v = w->list[k].ins->arg[j];
            w->nread[v]++;
            w->nread_here[v] += is_statement(w, v) && part_of(w, v) == k / w->split;
            if (is_statement(w, v) && part_of(w, v) != k / w->split && w->crossing[v] == none)
                w->crossing[v] = w->ncrossing++;
        }
}

static void name_inputs(struct writer *w)
{
    const struct ct_listing *l = w->l;
    w->input = CT_NEWN(w->arena, const char *, l->nvalue);
    for (size_t v = 0; v < l->nvalue; v++) {
        if (l->input[v] == none)
            continue;
        const struct ct_sym *s = ct_ex_symbol(l->x, (ct_ex){l->node[v]});
        const char *name
            = w->o.symbol ? w->o.symbol(w->o.data, w->arena, s) : ct_c_name(w->arena, s->name);
        w->input[v] = ct_arena_printf(w->arena, "i%u_%s", l->input[v], name);
    }
}

static void list_outputs(struct writer *w)
{
    w->first_output = CT_NEWN(w->arena, uint32_t, w->l->nvalue);
    w->next_output = CT_NEWN(w->arena, uint32_t, w->l->nout);
    for (size_t k = w->l->nout; k-- > 0;) {
        w->next_output[k] = w->first_output[w->l->out[k]];
        w->first_output[w->l->out[k]] = (uint32_t)k + 1;
    }
}

// ---- statements -------------------------------------------------------------------------------

// The text of value v as read in function number `part`.
static const char *operand_text(const struct writer *w, uint32_t v, size_t part)
{
    double number;
    if (ct_ex_is_const(w->l->x, (ct_ex){w->l->node[v]}, &number))
        return ct_number_c(w->arena, number);
    if (!is_statement(w, v))
        return w->input[v];
    if (w->within[v])
        return w->within[v];
    return part_of(w, v) == part ? ct_arena_printf(w->arena, "t%u", w->statement[v])
                                 : ct_arena_printf(w->arena, "w[%u]", w->crossing[v]);
}

static const char *operation_text(const struct writer *w, const struct statement *s,
                                  size_t part)
{
    const struct ct_instruction *i = s->ins;
    const char *arg[3] = {"", "", ""};
    for (uint32_t k = 0; k < i->narg; k++)
        arg[k] = operand_text(w, i->arg[k], part);
    switch (i->op) {
    case CT_OP_TABLE:
        return ct_arena_printf(w->arena, "%s_table(%s_table%u, %u, %s)", w->o.name, w->o.name,
                               i->table, i->order, arg[0]);
    case CT_OP_ANGLE_SIN:
        return ct_c_operation(w->arena, CT_OP_SIN, arg);
    case CT_OP_ANGLE_COS:
        return ct_c_operation(w->arena, CT_OP_COS, arg);
    case CT_OP_SINCOS:
    case CT_OP_ANGLE_SINCOS:
        return ct_c_operation(w->arena, s->result ? CT_OP_COS : CT_OP_SIN, arg);
    case CT_OP_FMA:
        return ct_arena_printf(w->arena, "fma(%s, %s, %s)", arg[0], arg[1], arg[2]);
    case CT_OP_FMS:
        return ct_arena_printf(w->arena, "fma(%s, %s, -(%s))", arg[0], arg[1], arg[2]);
    case CT_OP_FNMA:
        return ct_arena_printf(w->arena, "fma(-(%s), %s, %s)", arg[0], arg[1], arg[2]);
    default:
        return ct_c_operation(w->arena, (enum ct_op)i->op, arg);
    }
}

static uint32_t value_of(const struct writer *w, uint32_t k)
{
    return w->list[k].ins->res[w->list[k].result];
}

static bool has_label(const struct writer *w, uint32_t v)
{
    const uint32_t id = w->l->node[v];
    return id < w->l->x->label_cap && w->l->x->label[id];
}

// Inline short sums and products with one reader in the same function.
static bool stands_within(const struct writer *w, uint32_t v, const char *text)
{
    // Layout: length of an expression that is inlined
    enum { LONGEST = 40 };
    return w->nread[v] == 1 && w->crossing[v] == none && !w->first_output[v] && !has_label(w, v)
        && strlen(text) <= LONGEST;
}

static void put_statement(struct writer *w, uint32_t k)
{
    const size_t part = k / w->split;
    const uint32_t v = value_of(w, k);
    const char *text = operation_text(w, &w->list[k], part);
    if (stands_within(w, v, text)) {
        w->within[v] = ct_arena_printf(w->arena, "(%s)", text);
        return;
    }
    const bool has_name = w->crossing[v] == none || w->nread_here[v] || w->first_output[v];
    if (has_name)
        putf(w, "    const double t%u = %s;", k, text);
    else
        putf(w, "    w[%u] = %s;", w->crossing[v], text);
    if (has_label(w, v))
        putf(w, " /* %s */", ct_c_comment(w->arena, w->l->x->label[w->l->node[v]]));
    put(w, "\n");
    if (has_name && w->crossing[v] != none)
        putf(w, "    w[%u] = t%u;\n", w->crossing[v], k);
}

// ---- functions --------------------------------------------------------------------------------

// Range of statements of one function.
struct range {
    uint32_t from, to;
    bool reads_input, writes_output, uses_w;
};

static void look_at_operands(const struct writer *w, uint32_t k, unsigned char *read,
                             struct range *r)
{
    const struct ct_instruction *i = w->list[k].ins;
    for (uint32_t j = 0; j < i->narg; j++) {
        if (w->input[i->arg[j]])
            read[i->arg[j]] = r->reads_input = true;
        r->uses_w |= w->crossing[i->arg[j]] != none && part_of(w, i->arg[j]) != k / w->split;
    }
    r->uses_w |= w->crossing[i->res[w->list[k].result]] != none;
}

static void put_inputs(struct writer *w, const unsigned char *read)
{
    for (size_t v = 0; v < w->l->nvalue; v++)
        if (read[v])
            putf(w, "    const double %s = in[%u];\n", w->input[v],
                 w->o.lanes * w->l->input[v]);
}

static void put_outputs(struct writer *w, uint32_t v, const char *text)
{
    for (uint32_t k = w->first_output[v]; k; k = w->next_output[k - 1])
        putf(w, "    out[%u] = %s;\n", w->o.lanes * (k - 1), text);
}

static void put_body(struct writer *w, const struct range *r, const unsigned char *read)
{
    put_inputs(w, read);
    for (uint32_t k = r->from; k < r->to; k++)
        put_statement(w, k);
    for (uint32_t k = r->from; k < r->to; k++)
        put_outputs(w, value_of(w, k), operand_text(w, value_of(w, k), k / w->split));
}

static struct range next_part(const struct writer *w, uint32_t from, unsigned char *read)
{
    struct range r = {.from = from, .to = from};
    memset(read, 0, w->l->nvalue);
    for (; r.to < w->nstatement && r.to - from < w->split; r.to++) {
        look_at_operands(w, r.to, read, &r);
        r.writes_output |= w->first_output[value_of(w, r.to)] != 0;
    }
    return r;
}

// Pass only the arguments that a function needs: an unused one gives a warning.
static const char *arguments(const struct writer *w, const struct range *r, bool types)
{
    const char *s = "";
    if (r->reads_input)
        s = types ? "const double *in" : "in";
    if (r->writes_output)
        s = ct_arena_printf(w->arena, "%s%s%sout", s, *s ? ", " : "", types ? "double *" : "");
    if (r->uses_w)
        s = ct_arena_printf(w->arena, "%s%s%sw", s, *s ? ", " : "", types ? "double *" : "");
    return s;
}

// Print the outputs that are symbols or constants, and the inputs read for them.
static void put_plain_outputs(struct writer *w)
{
    for (uint32_t v = 0; v < w->l->nvalue; v++)
        if (w->l->is_leaf[v])
            put_outputs(w, v,
                        w->input[v]
                            ? ct_arena_printf(w->arena, "in[%u]", w->o.lanes * w->l->input[v])
                            : operand_text(w, v, 0));
}

// Print a loop over the lanes.
static void put_lanes(struct writer *w)
{
    const char *n = w->o.name;
    putf(w, "\nvoid %s(const double *in, double *out);\n\n", n);
    putf(w, "void %s(const double *in, double *out)\n{\n    int lane;\n", n);
    putf(w, "    for (lane = 0; lane < %u; lane++)\n", w->o.lanes);
    putf(w, "        %s_lane(in + lane, out + lane);\n}\n", n);
}

static void put_functions(struct writer *w)
{
    const size_t npart = (w->nstatement + w->split - 1) / w->split;
    unsigned char *read = CT_NEWN(w->arena, unsigned char, w->l->nvalue);
    const char **call = CT_NEWN(w->arena, const char *, npart);
    struct range r = {0};
    for (size_t part = 0; part < npart; part++) {
        r = next_part(w, r.to, read);
        if (npart == 1)
            break;
        putf(w, "static void %s_%zu(%s)\n{\n", w->o.name, part, arguments(w, &r, true));
        put_body(w, &r, read);
        put(w, "}\n\n");
        call[part] = ct_arena_printf(w->arena, "    %s_%zu(%s);\n", w->o.name, part,
                                     arguments(w, &r, false));
    }
    if (w->o.lanes == 1 && !w->o.is_static)
        putf(w, "void %s(const double *in, double *out);\n\n", w->o.name);
    putf(w, "%svoid %s%s", w->o.lanes > 1 || w->o.is_static ? "static " : "", w->o.name,
         w->o.lanes > 1 ? "_lane" : "");
    put(w, "(const double *in, double *out)\n{\n    (void)in;\n    (void)out;\n");
    if (npart == 1)
        put_body(w, &r, read);
    if (npart > 1 && w->ncrossing)
        putf(w, "    double w[%u];\n", w->ncrossing);
    for (size_t part = 0; npart > 1 && part < npart; part++)
        put(w, call[part]);
    put_plain_outputs(w);
    put(w, "}\n");
    if (w->o.lanes > 1)
        put_lanes(w);
}

// ---- tables -----------------------------------------------------------------------------------

static void put_array(struct writer *w, uint32_t table, const char *name, const double *v,
                      size_t n)
{
    putf(w, "static const double %s_table%u_%s[] = {", w->o.name, table, name);
    for (size_t k = 0; k < n; k++)
        putf(w, "%s%s", k % 4 ? ", " : k ? ",\n    " : "\n    ", ct_number_c(w->arena, v[k]));
    put(w, "};\n");
}

// Print the operations of ct_table_value, in the same order.
static void put_table_function(struct writer *w, bool any_holds)
{
    const char *n = w->o.name;
    putf(w, "struct %s_table {\n    int n;\n    const double *x, *y, *m;\n%s};\n\n", n,
         any_holds ? "    int holds;\n" : "");
    putf(w, "static double %s_table(struct %s_table t, int order, double at)\n{\n", n, n);
    put(w, "    int low = 0, high = t.n - 1, i;\n"
           "    double h, s, slope, c1, c2 = 0, c3 = 0;\n");
    if (any_holds)
        put(w, "    if (t.holds && order)\n"
               "        return 0;\n"
               "    if (t.holds && (t.n == 1 || at >= t.x[t.n - 1]))\n"
               "        return t.y[t.n - 1];\n"
               "    if (t.holds && at < t.x[0])\n"
               "        return t.y[0];\n");
    put(w, "    if (!(at >= t.x[0] && at <= t.x[t.n - 1]))\n"
           "        return NAN;\n"
           "    while (high - low > 1) {\n"
           "        const int middle = (low + high) / 2;\n"
           "        if (t.x[middle] <= at)\n"
           "            low = middle;\n"
           "        else\n"
           "            high = middle;\n"
           "    }\n"
           "    i = low;\n");
    if (any_holds)
        put(w, "    if (t.holds)\n"
               "        return t.y[i];\n");
    put(w, ""
           "    h = t.x[i + 1] - t.x[i];\n"
           "    s = at - t.x[i];\n"
           "    slope = (t.y[i + 1] - t.y[i]) / h;\n"
           "    c1 = slope;\n"
           "    if (t.m) {\n"
           "        c1 = t.m[i];\n"
           "        c2 = (3 * slope - 2 * t.m[i] - t.m[i + 1]) / h;\n"
           "        c3 = (t.m[i] + t.m[i + 1] - 2 * slope) / (h * h);\n"
           "    }\n"
           "    switch (order) {\n"
           "    case 0:\n"
           "        return t.y[i] + s * (c1 + s * (c2 + s * c3));\n"
           "    case 1:\n"
           "        return c1 + s * (2 * c2 + s * 3 * c3);\n"
           "    case 2:\n"
           "        return 2 * c2 + 6 * s * c3;\n"
           "    case 3:\n"
           "        return 6 * c3;\n"
           "    default:\n"
           "        return 0;\n"
           "    }\n"
           "}\n\n");
}

static void put_tables(struct writer *w)
{
    const size_t ntable = w->l->x->ntable;
    unsigned char *used = CT_NEWN(w->arena, unsigned char, ntable);
    bool any = false, any_holds = false;
    for (uint32_t k = 0; k < w->nstatement; k++)
        if (w->list[k].ins->op == CT_OP_TABLE) {
            used[w->list[k].ins->table] = any = true;
            any_holds |= w->l->table[w->list[k].ins->table].holds;
        }
    if (!any)
        return;
    put_table_function(w, any_holds);
    for (uint32_t k = 0; k < ntable; k++) {
        const struct ct_table *t = &w->l->table[k];
        if (!used[k])
            continue;
        put_array(w, k, "x", t->x, t->n);
        put_array(w, k, "y", t->y, t->n);
        if (t->m)
            put_array(w, k, "m", t->m, t->n);
        const char *n = w->o.name;
        putf(w, "static const struct %s_table %s_table%u = {%zu, %s_table%u_x, %s_table%u_y, ",
             n, n, k, t->n, n, k, n, k);
        if (t->m)
            putf(w, "%s_table%u_m", n, k);
        else
            put(w, "0");
        put(w, !any_holds ? "};\n\n" : t->holds ? ", 1};\n\n" : ", 0};\n\n");
    }
}

// ---- entry ------------------------------------------------------------------------------------

static void put_head(struct writer *w)
{
    put(w, "/* ");
    if (w->o.title)
        putf(w, "%s: ", ct_c_comment(w->arena, w->o.title));
    putf(w, "%u operations. Compile with -ffp-contract=off to keep the bits. */\n",
         w->nstatement);
    put(w, "#include <math.h>\n\n");
}

const char *ct_c_listing(struct ct_arena *a, const struct ct_listing *l,
                         const struct ct_c_options *options)
{
    struct writer w = {.arena = a, .l = l};
    if (options)
        w.o = *options;
    w.o.name = w.o.name ? w.o.name : "evaluate";
    w.split = w.o.split ? w.o.split : 800;
    w.o.lanes = w.o.lanes ? w.o.lanes : 1;
    number_statements(&w);
    name_inputs(&w);
    list_outputs(&w);
    put_head(&w);
    put_tables(&w);
    put_functions(&w);
    CT_PUSH(a, w.text.s, w.text.n, w.text.cap, '\0');
    return w.text.s;
}
