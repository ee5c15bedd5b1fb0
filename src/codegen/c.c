// Printing expressions as a C function; see c.h.
//
// The live nodes that compute something are the statements, in the order of ids. Statement k belongs
// to part k / split. A value that a later part reads is stored in w[] by its own part; one part alone
// needs no w[].
#include "codegen/c.h"

#include "expr/print.h"

#include <assert.h>
#include <string.h>

static const uint32_t none = UINT32_MAX;

struct text {
    char *s;
    size_t n, cap;
};

struct writer {
    struct ct_arena *arena;
    const struct ct_exs *x;
    struct ct_c_options o;
    const ct_ex *out;
    size_t nout;
    uint32_t nid;
    unsigned char *live; // by id
    uint32_t *statement; // by id: number of its statement
    uint32_t nstatement;
    uint32_t *crossing; // by id: place in w[], none if only its own part reads it
    uint32_t ncrossing;
    const char **input;  // by id of a symbol: i<slot>_<name>
    const size_t **slot; // by id of a symbol
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

// A comment may not end early.
static const char *comment_text(struct ct_arena *a, const char *s)
{
    char *copy = ct_arena_strdup(a, s);
    for (char *c = copy; *c; c++)
        if (*c == '*' || *c == '\n' || *c == '\\')
            *c = ' ';
    return copy;
}

// ---- what is needed -----------------------------------------------------------------------------

static int operands(const struct ct_exs *x, uint32_t id, uint32_t arg[3])
{
    const struct ct_exnode *n = &x->node[id];
    arg[0] = n->a;
    arg[1] = n->b;
    arg[2] = n->c;
    return ct_op_info[n->op].narg;
}

static bool is_statement(const struct writer *w, uint32_t id)
{
    const uint32_t op = w->x->node[id].op;
    return w->live[id] && op != CT_OP_CONST && op != CT_OP_SYM;
}

static void mark_live(struct writer *w)
{
    uint32_t arg[3];
    for (size_t k = 0; k < w->nout; k++)
        w->nid = w->out[k].id >= w->nid ? w->out[k].id + 1 : w->nid;
    w->live = CT_NEWN(w->arena, unsigned char, w->nid);
    for (size_t k = 0; k < w->nout; k++)
        w->live[w->out[k].id] = 1;
    for (uint32_t id = w->nid; id-- > 0;)
        for (int i = w->live[id] ? operands(w->x, id, arg) : 0; i-- > 0;)
            w->live[arg[i]] = 1;
}

static size_t part_of(const struct writer *w, uint32_t id)
{
    return w->statement[id] / w->split;
}

static void number_statements(struct writer *w)
{
    uint32_t arg[3];
    w->statement = CT_NEWN(w->arena, uint32_t, w->nid);
    w->crossing = CT_NEWN(w->arena, uint32_t, w->nid);
    for (uint32_t id = 0; id < w->nid; id++) {
        w->crossing[id] = none;
        if (is_statement(w, id))
            w->statement[id] = w->nstatement++;
    }
    for (uint32_t id = 0; id < w->nid; id++)
        for (int i = is_statement(w, id) ? operands(w->x, id, arg) : 0; i-- > 0;)
            if (is_statement(w, arg[i]) && part_of(w, arg[i]) != part_of(w, id)
                && w->crossing[arg[i]] == none)
                w->crossing[arg[i]] = w->ncrossing++;
}

static void name_inputs(struct writer *w, const ct_ex *in, const size_t *slot, size_t nin)
{
    w->input = CT_NEWN(w->arena, const char *, w->nid);
    w->slot = CT_NEWN(w->arena, const size_t *, w->nid);
    for (size_t k = 0; k < nin; k++) {
        const struct ct_sym *s = ct_ex_symbol(w->x, in[k]);
        assert(s);
        if (in[k].id >= w->nid || !w->live[in[k].id])
            continue;
        const char *name
            = w->o.symbol ? w->o.symbol(w->o.data, w->arena, s) : ct_c_name(w->arena, s->name);
        w->input[in[k].id] = ct_arena_printf(w->arena, "i%zu_%s", slot[k], name);
        w->slot[in[k].id] = &slot[k];
    }
}

// ---- statements -------------------------------------------------------------------------------

// The text of node id as read by part `part`.
static const char *operand_text(const struct writer *w, uint32_t id, size_t part)
{
    double v;
    if (ct_ex_is_const(w->x, (ct_ex){id}, &v))
        return ct_number_c(w->arena, v);
    if (w->x->node[id].op == CT_OP_SYM) {
        assert(w->input[id] && "a symbol that is needed is not an input");
        return w->input[id];
    }
    return part_of(w, id) == part ? ct_arena_printf(w->arena, "t%u", w->statement[id])
                                  : ct_arena_printf(w->arena, "w[%u]", w->crossing[id]);
}

static void put_statement(struct writer *w, uint32_t id)
{
    const struct ct_exnode *n = &w->x->node[id];
    const size_t part = part_of(w, id);
    const char *arg[3] = {"", "", ""}, *value;
    uint32_t below[3];
    for (int i = operands(w->x, id, below); i-- > 0;)
        arg[i] = operand_text(w, below[i], part);
    if (n->op == CT_OP_TABLE)
        value = ct_arena_printf(w->arena, "%s_table(%s_table%u, %u, %s)", w->o.name, w->o.name,
                                n->b, n->c, arg[0]);
    else
        value = ct_c_operation(w->arena, (enum ct_op)n->op, arg);
    putf(w, "    const double t%u = %s;", w->statement[id], value);
    if (id < w->x->label_cap && w->x->label[id])
        putf(w, " /* %s */", comment_text(w->arena, w->x->label[id]));
    put(w, "\n");
    if (w->crossing[id] != none)
        putf(w, "    w[%u] = t%u;\n", w->crossing[id], w->statement[id]);
}

// ---- functions --------------------------------------------------------------------------------

// The live ids from the first statement of a part to that of the next.
struct range {
    uint32_t from, to;
    bool reads_input, writes_output, uses_w;
};

static void look_at_operands(const struct writer *w, uint32_t id, unsigned char *read,
                             size_t part, struct range *r)
{
    uint32_t arg[3];
    for (int i = operands(w->x, id, arg); i-- > 0;) {
        if (w->x->node[arg[i]].op == CT_OP_SYM)
            read[arg[i]] = r->reads_input = true;
        r->uses_w |= is_statement(w, arg[i]) && part_of(w, arg[i]) != part;
    }
    r->uses_w |= w->crossing[id] != none;
}

static void put_inputs(struct writer *w, const unsigned char *read)
{
    for (uint32_t id = 0; id < w->nid; id++)
        if (read[id])
            putf(w, "    const double %s = in[%zu];\n", w->input[id], *w->slot[id]);
}

static void put_statements(struct writer *w, const struct range *r)
{
    for (uint32_t id = r->from; id < r->to; id++)
        if (is_statement(w, id))
            put_statement(w, id);
}

// outputs[k ...): of each statement id the outputs it is, as linked lists by id.
struct outputs {
    uint32_t *first, *next; // 1 + k, 0 at the end
};

static struct outputs list_outputs(const struct writer *w)
{
    struct outputs o
        = {CT_NEWN(w->arena, uint32_t, w->nid), CT_NEWN(w->arena, uint32_t, w->nout)};
    for (size_t k = w->nout; k-- > 0;) {
        o.next[k] = o.first[w->out[k].id];
        o.first[w->out[k].id] = (uint32_t)k + 1;
    }
    return o;
}

static void put_outputs(struct writer *w, const struct outputs *o, uint32_t id, size_t part)
{
    for (uint32_t k = o->first[id]; k; k = o->next[k - 1])
        putf(w, "    out[%u] = %s;\n", k - 1, operand_text(w, id, part));
}

static void put_body(struct writer *w, const struct range *r, const struct outputs *o,
                     const unsigned char *read, size_t part)
{
    put_inputs(w, read);
    put_statements(w, r);
    for (uint32_t id = r->from; id < r->to; id++)
        if (is_statement(w, id))
            put_outputs(w, o, id, part);
}

static struct range next_part(const struct writer *w, uint32_t from, size_t part,
                              const struct outputs *o, unsigned char *read)
{
    struct range r = {.from = from};
    memset(read, 0, w->nid);
    for (r.to = from; r.to < w->nid; r.to++) {
        if (!is_statement(w, r.to))
            continue;
        if (part_of(w, r.to) != part)
            break;
        look_at_operands(w, r.to, read, part, &r);
        r.writes_output |= o->first[r.to] != 0;
    }
    return r;
}

// Only the arguments a part needs: an unused one would be a warning.
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

// Outputs that are symbols or constants, and the inputs read for them.
static void put_plain_outputs(struct writer *w, const struct outputs *o)
{
    for (uint32_t id = 0; id < w->nid; id++)
        if (!is_statement(w, id))
            for (uint32_t k = o->first[id]; k; k = o->next[k - 1]) {
                if (w->x->node[id].op == CT_OP_SYM)
                    putf(w, "    out[%u] = in[%zu];\n", k - 1, *w->slot[id]);
                else
                    putf(w, "    out[%u] = %s;\n", k - 1, operand_text(w, id, 0));
            }
}

static void put_functions(struct writer *w)
{
    const struct outputs o = list_outputs(w);
    const size_t nstatement = w->nstatement, npart = (nstatement + w->split - 1) / w->split;
    unsigned char *read = CT_NEWN(w->arena, unsigned char, w->nid);
    const char **call = CT_NEWN(w->arena, const char *, npart);
    struct range r = {0};
    for (size_t part = 0; part < npart; part++) {
        r = next_part(w, r.to, part, &o, read);
        if (npart == 1)
            break;
        putf(w, "static void %s_%zu(%s)\n{\n", w->o.name, part, arguments(w, &r, true));
        put_body(w, &r, &o, read, part);
        put(w, "}\n\n");
        call[part] = ct_arena_printf(w->arena, "    %s_%zu(%s);\n", w->o.name, part,
                                     arguments(w, &r, false));
    }
    putf(w, "void %s(const double *in, double *out);\n\n", w->o.name);
    putf(w, "void %s(const double *in, double *out)\n{\n", w->o.name);
    put(w, "    (void)in;\n    (void)out;\n");
    if (npart == 1)
        put_body(w, &r, &o, read, 0);
    if (npart > 1 && w->ncrossing)
        putf(w, "    double w[%u];\n", w->ncrossing);
    for (size_t part = 0; npart > 1 && part < npart; part++)
        put(w, call[part]);
    put_plain_outputs(w, &o);
    put(w, "}\n");
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

// The operations of ct_table_value, in its order.
static void put_table_function(struct writer *w)
{
    const char *n = w->o.name;
    putf(w, "struct %s_table {\n    int n;\n    const double *x, *y, *m;\n};\n\n", n);
    putf(w, "static double %s_table(struct %s_table t, int order, double at)\n{\n", n, n);
    put(w, "    int low = 0, high = t.n - 1, i;\n"
           "    double h, s, slope, c1, c2 = 0, c3 = 0;\n"
           "    if (!(at >= t.x[0] && at <= t.x[t.n - 1]))\n"
           "        return NAN;\n"
           "    while (high - low > 1) {\n"
           "        const int middle = (low + high) / 2;\n"
           "        if (t.x[middle] <= at)\n"
           "            low = middle;\n"
           "        else\n"
           "            high = middle;\n"
           "    }\n"
           "    i = low;\n"
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
    unsigned char *used = CT_NEWN(w->arena, unsigned char, w->x->ntable);
    bool any = false;
    for (uint32_t id = 0; id < w->nid; id++)
        if (is_statement(w, id) && w->x->node[id].op == CT_OP_TABLE)
            used[w->x->node[id].b] = any = true;
    if (!any)
        return;
    put_table_function(w);
    for (uint32_t k = 0; k < w->x->ntable; k++) {
        const struct ct_table *t = &w->x->table[k];
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
            putf(w, "%s_table%u_m};\n\n", n, k);
        else
            put(w, "0};\n\n");
    }
}

// ---- entry ------------------------------------------------------------------------------------

static void put_head(struct writer *w)
{
    put(w, "/* ");
    if (w->o.title)
        putf(w, "%s: ", comment_text(w->arena, w->o.title));
    putf(w, "%u operations. Compile with -ffp-contract=off to keep the bits. */\n",
         w->nstatement);
    put(w, "#include <math.h>\n\n");
}

const char *ct_c_function(struct ct_arena *a, const struct ct_exs *x, const ct_ex *out,
                          size_t nout, const ct_ex *in, const size_t *slot, size_t nin,
                          const struct ct_c_options *options)
{
    struct writer w = {.arena = a, .x = x, .out = out, .nout = nout};
    if (options)
        w.o = *options;
    w.o.name = w.o.name ? w.o.name : "evaluate";
    w.split = w.o.split ? w.o.split : 800;
    mark_live(&w);
    number_statements(&w);
    name_inputs(&w, in, slot, nin);
    put_head(&w);
    put_tables(&w);
    put_functions(&w);
    CT_PUSH(a, w.text.s, w.text.n, w.text.cap, '\0');
    return w.text.s;
}
