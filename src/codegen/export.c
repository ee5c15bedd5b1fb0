// A model as C source: the header, the source and its programs; see export.h.
#include "codegen/export.h"

#include "codegen/c.h"
#include "codegen/export_text.h"
#include "codegen/export_header_text.h"
#include "expr/print.h"

#include <string.h>

// ---- header -----------------------------------------------------------------------------------

static void put_constant(struct ct_export_text *t, const char *name, size_t value,
                         const char *comment)
{
    ct_export_put_named(t, "    $_");
    ct_export_putf(t, "%s = %zu,%s%s%s\n", name, value, *comment ? " /* " : "", comment,
                   *comment ? " */" : "");
}

static void put_layout(struct ct_export_text *t, const struct ct_export *x)
{
    const struct ct_equations *e = x->e;
    ct_export_put(t, "enum {\n");
    put_constant(t, "NQ", e->nq, "coordinates");
    put_constant(t, "NU", e->nu, "speeds, and behind them states");
    put_constant(t, "NSTATE", e->nstate, "states of the model, first-order equations");
    put_constant(t, "NROW", e->nrow, "constraints");
    put_constant(t, "NM", e->nM, "entries of M, lower triangle");
    put_constant(t, "NJ", e->nJ, "entries of J");
    put_constant(t, "NPARAMETER", x->at_q - 1, "parameters and inputs");
    put_constant(t, "NOUTPUT", x->output->nout, "outputs of the model");
    put_constant(t, "NROOT", e->nswitch, "switching functions");
    put_constant(t, "NREACTION", x->reaction->nout, "numbers of the wrenches of joints");
    put_constant(t, "NMEMORY", e->nmemory, "angles and rotations followed");
    ct_export_put(t, "\n    /* in[] */\n");
    put_constant(t, "T", 0, "time");
    put_constant(t, "PARAMETER", 1, "the model's parameters and inputs");
    put_constant(t, "Q", x->at_q, "coordinates");
    put_constant(t, "U", x->at_u, "speeds");
    put_constant(t, "STATE", x->at_u + e->nmotion, "states");
    put_constant(t, "A", x->at_a,
                 "derivatives of speeds, where a function needs them: its own");
    put_constant(t, "LAM", x->at_lam, "multipliers, likewise");
    put_constant(t, "MODE", x->at_switch, "switches: sides of comparisons, 0 or 1");
    put_constant(t, "MEMORY", x->at_memory, "angles and rotations followed from step to step");
    put_constant(t, "WORK", x->at_work, "energy put in since the start");
    put_constant(t, "NINPUT", x->ninput, "");
    ct_export_put(t, "\n    /* out[] of motion */\n");
    put_constant(t, "OUT_M", 0, "");
    put_constant(t, "OUT_Q", e->nM, "");
    put_constant(t, "OUT_J", e->nM + e->nu, "");
    put_constant(t, "OUT_GAM", e->nM + e->nu + e->nJ, "");
    put_constant(t, "OUT_RATE", e->nM + e->nu + e->nJ + e->nrow, "derivatives of q");
    put_constant(t, "NMOTION", x->motion->nout, "");
    ct_export_put(t, "\n    /* out[] of constraint */\n");
    put_constant(t, "OUT_PHI", 0, "");
    put_constant(t, "OUT_V", e->nrow, "");
    put_constant(t, "OUT_J2", 2 * e->nrow, "J again");
    put_constant(t, "NCONSTRAINT", x->constraint->nout, "");
    if (x->lanes > 1)
        put_constant(t, "LANES", x->lanes, "inputs side by side");
    ct_export_put(t, "\n    /* doubles of work for every function */\n");
    put_constant(t, "NWORK", ct_export_work(x), "");
    ct_export_put(t, "};\n\n");
}

static void put_items(struct ct_export_text *t, const char *what,
                      const struct ct_export_items *list)
{
    if (!list->n)
        return;
    ct_export_putf(t, " * %s:\n", what);
    for (size_t i = 0; i < list->n; i++) {
        const struct ct_export_item *item = &list->item[i];
        ct_export_putf(t, " *   %4zu  %s", item->index, ct_c_comment(t->arena, item->name));
        if (item->unit && *item->unit) // "N*m" would read as " m"
            ct_export_putf(t, " [%s]", ct_c_comment(t->arena, item->unit));
        ct_export_put(t, item->is_fixed     ? " (fixed: another value needs another export)\n"
                         : item->is_derived ? " (derived)\n"
                         : item->is_open    ? " (open: the model does not determine it)\n"
                                            : "\n");
    }
}

// What the numbers are called in the model, with their units.
static void put_names(struct ct_export_text *t, const struct ct_export *x)
{
    ct_export_put(t, "/* Numbers by name.\n *\n");
    put_items(t, "in[], parameters", &x->parameters);
    put_items(t, "in[], inputs", &x->inputs);
    put_items(t, "in[], coordinates", &x->coordinates);
    put_items(t, "in[], speeds", &x->speeds);
    put_items(t, "in[], states", &x->states);
    put_items(t, "out[] of outputs", &x->outputs);
    put_items(t, "out[] of reactions, in axes of the joint's `from`", &x->reactions);
    ct_export_put(t, " */\n\n");
}

const char *ct_export_header(struct ct_arena *a, const struct ct_export *x)
{
    struct ct_export_text t = {.arena = a, .name = x->name};
    ct_export_putf(&t, "/* %s: equations of motion\n", ct_c_comment(a, x->title));
    ct_export_put_named(
        &t, " *\n"
            " *     M(q, t) u' = Q(q, u, t) + J(q, t)' lam\n"
            " *     phi(q, t) = 0,   v = J u + phi_t = 0,   J u' + gam = 0\n"
            " *\n"
            " * SI units and radians. Entry k of M stands at row @_M_row[k], column\n"
            " * @_M_column[k] and, being symmetric, at the mirrored place; J likewise.\n"
            " *\n"
            " * A real-time loop:\n"
            " *\n"
            " *     double in[$_NINPUT], work[$_NWORK];\n"
            " *     memcpy(in, @_start, sizeof in);\n"
            " *     for (;;) {\n"
            " *         (set inputs in in[])\n"
            " *         if (@_step(in, 1e-3, work))\n"
            " *             break;\n"
            " *     }\n"
            " */\n"
            "#ifndef $_H\n#define $_H\n\n"
            "#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n");
    put_layout(&t, x);
    put_names(&t, x);
    ct_export_put_lines(&t, text_functions);
    if (x->lanes > 1)
        ct_export_put_named(
            &t, "/* The programs for $_LANES inputs side by side: entry i of lane l at "
                "$_LANES * i + l. */\n"
                "void @_motion_lanes(const double *in, double *out);\n"
                "void @_constraint_lanes(const double *in, double *out);\n\n");
    ct_export_put_named(&t, "#ifdef __cplusplus\n}\n#endif\n\n#endif\n");
    return ct_export_finish(&t);
}

// ---- source -----------------------------------------------------------------------------------

static void put_places(struct ct_export_text *t, const char *name, const struct ct_entry *entry,
                       size_t n, bool rows)
{
    int *at = CT_NEWN(t->arena, int, n + 1);
    for (size_t k = 0; k < n; k++)
        at[k] = rows ? entry[k].row : entry[k].column;
    ct_export_put_named(t, "const int @_");
    ct_export_putf(t, "%s[] = ", name);
    ct_export_put_integers(t, at, n);
    ct_export_put(t, ";\n");
}

static void put_program(struct ct_export_text *t, const char *name, const struct ct_listing *l,
                        unsigned lanes, bool is_static)
{
    const struct ct_c_options o = {.name = ct_arena_printf(t->arena, "%s_%s", t->name, name),
                                   .title = name,
                                   .lanes = lanes,
                                   .is_static = is_static};
    ct_export_put(t, ct_c_listing(t->arena, l, &o));
    ct_export_put(t, "\n");
}

static void put_programs(struct ct_export_text *t, const struct ct_export *x)
{
    put_program(t, "motion", x->motion, 1, false);
    put_program(t, "constraint", x->constraint, 1, false);
    if (x->lanes > 1) {
        put_program(t, "motion_lanes", x->motion, x->lanes, false);
        put_program(t, "constraint_lanes", x->constraint, x->lanes, false);
    }
    if (x->solved && x->e->nu)
        put_program(t, "solved", x->solved, 1, true);
    if (ct_export_has_derived(x))
        put_program(t, "parameter_values", x->parameter, 1, true);
    put_program(t, "output_values", x->output, 1, true);
    put_program(t, "reaction_values", x->reaction, 1, true);
    put_program(t, "roots", x->root, 1, false);
    if (x->e->nmemory)
        put_program(t, "memory_values", x->memory, 1, true);
    if (x->power)
        put_program(t, "power", x->power, 1, true);
    if (x->jump)
        put_program(t, "jump", x->jump, 1, true);
}

const char *ct_export_source(struct ct_arena *a, const struct ct_export *x)
{
    struct ct_export_text t = {.arena = a, .name = x->name};
    const struct ct_equations *e = x->e;
    ct_export_putf(&t, "/* %s: see %s.h. */\n#include \"%s.h\"\n\n#include <float.h>\n",
                   ct_c_comment(a, x->title), x->name, x->name);
    put_programs(&t, x);
    put_places(&t, "M_row", e->M, e->nM, true);
    put_places(&t, "M_column", e->M, e->nM, false);
    put_places(&t, "J_row", e->J, e->nJ, true);
    put_places(&t, "J_column", e->J, e->nJ, false);
    ct_export_put_named(&t, "const double @_start[$_NINPUT] = ");
    ct_export_put_numbers(&t, x->state[0].input, x->ninput);
    ct_export_put(&t, ";\n\n");
    if (x->jump)
        ct_export_putf(&t, "enum { n_jump = %zu };\n\n", x->jump->nout);
    ct_export_runtime(&t, x);
    return ct_export_finish(&t);
}
