// modelDescription.xml of FMI 2.0 and 3.0. See fmu.h.
//
// Both versions describe the same variables. FMI 2.0 refers to variables by their order in the
// file, 3.0 by value references.
#include "export/fmu.h"

#include "expr/unit.h"
#include "report/number.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct xml {
    struct ct_fmu *f;
    struct ct_arena *arena;
    char *s;
    size_t n, cap;
};

static void put(struct xml *x, const char *s)
{
    for (; *s; s++)
        CT_PUSH(x->arena, x->s, x->n, x->cap, *s);
}

static void __attribute__((format(printf, 2, 3))) putf(struct xml *x, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    put(x, ct_arena_vprintf(x->arena, fmt, ap));
    va_end(ap);
}

// name="text"
static void attribute(struct xml *x, const char *name, const char *text)
{
    putf(x, " %s=\"", name);
    for (; *text; text++) {
        const char c = *text;
        const char quoted[] = {(unsigned char)c < ' ' || c == 0x7f ? ' ' : c, 0};
        put(x, c == '&'    ? "&amp;"
               : c == '<'  ? "&lt;"
               : c == '>'  ? "&gt;"
               : c == '"'  ? "&quot;"
               : c == '\'' ? "&apos;"
                           : quoted);
    }
    put(x, "\"");
}

static void number(struct xml *x, const char *name, double v)
{
    char text[CT_NUMBER_SIZE];
    attribute(x, name, ct_number_format(text, v));
}

static void count(struct xml *x, const char *name, size_t v)
{
    putf(x, " %s=\"%zu\"", name, v);
}

static bool is_third(const struct xml *x)
{
    return x->f->version == 3;
}

// ---- units ---------------------------------------------------------------------------------

// Exponent of rad in a product of units; elsewhere rad counts as 1.
static int exponent_of_rad(const char *text)
{
    int sign = 1, sum = 0;
    for (const char *s = text; *s;) {
        const size_t n = strcspn(s, "*/^");
        const int power = s[n] == '^' ? atoi(s + n + 1) : 1;
        if (n == 3 && !strncmp(s, "rad", 3))
            sum += sign * power;
        s += n;
        if (*s == '^')
            s += strcspn(s, "*/");
        sign = *s == '/' ? -1 : 1;
        s += *s != 0;
    }
    return sum;
}

static bool has_unit(const struct ct_fmu_variable *v)
{
    struct ct_unit u;
    size_t at;
    return v->unit && *v->unit
        && ct_unit_parse(v->unit, strlen(v->unit), &u, &at) == CT_UNIT_OK;
}

static void put_unit(struct xml *x, const char *unit)
{
    struct ct_unit u = {1, 0, 0, 0};
    size_t at;
    ct_unit_parse(unit, strlen(unit), &u, &at);
    const struct {
        const char *name;
        int exponent;
    } base[] = {{"kg", u.kg}, {"m", u.m}, {"s", u.s}, {"rad", exponent_of_rad(unit)}};
    put(x, "    <Unit");
    attribute(x, "name", unit);
    put(x, "><BaseUnit");
    for (size_t i = 0; i < COUNT(base); i++)
        if (base[i].exponent)
            putf(x, " %s=\"%d\"", base[i].name, base[i].exponent);
    if (u.si != 1)
        number(x, "factor", u.si);
    put(x, "/></Unit>\n");
}

static void put_units(struct xml *x)
{
    const struct ct_fmu *f = x->f;
    struct ct_names done = {0};
    put(x, "  <UnitDefinitions>\n");
    for (size_t i = 0; i < f->nvariable; i++) {
        const struct ct_fmu_variable *v = &f->variable[i];
        if (!has_unit(v) || ct_names_get(&done, v->unit) >= 0)
            continue;
        ct_names_put(x->arena, &done, v->unit, 0);
        put_unit(x, v->unit);
    }
    put(x, "  </UnitDefinitions>\n");
}

// ---- variables -----------------------------------------------------------------------------

static const char *describe(const struct ct_fmu_variable *v)
{
    static const char *const text[] = {"time",
                                       "parameter",
                                       "parameter that follows from others",
                                       "parameter that has decided about the equations",
                                       "input",
                                       "state",
                                       "derivative of a state",
                                       "output",
                                       "switching function"};
    return v->is_output ? "state and output" : text[v->role];
}

static bool may_jump(const struct ct_fmu *f)
{
    const struct ct_equations *e = f->w->x.e;
    for (size_t i = 0; i < e->nq; i++)
        if (e->q[i].quaternion == 0)
            return true;
    return e->nrow > 0 || f->w->x.jump;
}

static void put_variable(struct xml *x, const struct ct_fmu_variable *v)
{
    static const char *const causality[] = {"independent", "parameter", "calculatedParameter",
                                            "local",       "input",     "local",
                                            "local",       "output",    "local"};
    static const char *const variability[]
        = {"continuous", "tunable",    "tunable",    "constant",  "continuous",
           "continuous", "continuous", "continuous", "continuous"};
    static const char *const initial[]
        = {NULL,    "exact",      "calculated", "exact",     NULL,
           "exact", "calculated", "calculated", "calculated"};
    const bool has_start = v->role == CT_FMU_PARAMETER || v->role == CT_FMU_CONSTANT
                        || v->role == CT_FMU_INPUT || v->role == CT_FMU_STATE;
    put(x, is_third(x) ? "    <Float64" : "    <ScalarVariable");
    attribute(x, "name", v->name);
    count(x, "valueReference", v->reference);
    attribute(x, "description", describe(v));
    attribute(x, "causality", v->is_output ? "output" : causality[v->role]);
    attribute(x, "variability", variability[v->role]);
    if (initial[v->role])
        attribute(x, "initial", initial[v->role]);
    if (!is_third(x))
        put(x, "><Real");
    if (has_unit(v))
        attribute(x, "unit", v->unit);
    if (has_start)
        number(x, "start", v->start);
    if (v->role == CT_FMU_DERIVATIVE)
        count(x, "derivative", is_third(x) ? x->f->variable[v->state].reference : v->state + 1);
    if (v->role == CT_FMU_STATE && may_jump(x->f))
        attribute(x, "reinit", "true");
    put(x, is_third(x) ? "/>\n" : "/></ScalarVariable>\n");
}

// ---- structure -----------------------------------------------------------------------------

// What a derivative or output may depend on: states, inputs, time, and the parameters that can
// be set.
static bool is_known(const struct ct_fmu_variable *v, bool of_parameter)
{
    return of_parameter
             ? v->role == CT_FMU_PARAMETER
             : v->role == CT_FMU_TIME || v->role == CT_FMU_INPUT || v->role == CT_FMU_STATE;
}

static void put_unknown(struct xml *x, const char *name, size_t i, bool has_dependencies)
{
    const struct ct_fmu *f = x->f;
    const struct ct_fmu_variable *v = &f->variable[i];
    const char *blank = "";
    putf(x, "    <%s", is_third(x) ? name : "Unknown");
    count(x, is_third(x) ? "valueReference" : "index", is_third(x) ? v->reference : i + 1);
    if (has_dependencies) {
        put(x, " dependencies=\"");
        for (size_t k = 0; k < f->nvariable; k++)
            if (is_known(&f->variable[k], v->role == CT_FMU_DERIVED)
                && v->on[f->variable[k].reference]) {
                putf(x, "%s%zu", blank, is_third(x) ? f->variable[k].reference : k + 1);
                blank = " ";
            }
        put(x, "\"");
    }
    put(x, "/>\n");
}

static bool is_output(const struct ct_fmu_variable *v)
{
    return v->role == CT_FMU_OUTPUT || v->is_output;
}

static bool is_derivative(const struct ct_fmu_variable *v)
{
    return v->role == CT_FMU_DERIVATIVE;
}

static bool is_root(const struct ct_fmu_variable *v)
{
    return v->role == CT_FMU_ROOT;
}

static bool is_calculated(const struct ct_fmu_variable *v)
{
    return v->role == CT_FMU_OUTPUT || v->role == CT_FMU_DERIVATIVE
        || v->role == CT_FMU_DERIVED;
}

// The start is assembled from all settable values, so initial unknowns depend on all of them,
// except that parameters depend on parameters only.
static void put_list(struct xml *x, const char *name, const char *list,
                     bool (*is_in)(const struct ct_fmu_variable *v))
{
    const struct ct_fmu *f = x->f;
    bool is_empty = true;
    for (size_t i = 0; i < f->nvariable && is_empty; i++)
        is_empty = !is_in(&f->variable[i]);
    if (is_empty)
        return;
    if (!is_third(x))
        putf(x, "    <%s>\n", list);
    for (size_t i = 0; i < f->nvariable; i++)
        if (is_in(&f->variable[i]))
            put_unknown(x, name, i,
                        is_in != is_calculated || f->variable[i].role == CT_FMU_DERIVED);
    if (!is_third(x))
        putf(x, "    </%s>\n", list);
}

// ---- the whole -----------------------------------------------------------------------------

static void put_kind(struct xml *x, const char *kind)
{
    const bool third = is_third(x);
    putf(x, "  <%s", kind);
    attribute(x, "modelIdentifier", x->f->w->x.name);
    attribute(x, third ? "canGetAndSetFMUState" : "canGetAndSetFMUstate", "true");
    attribute(x, third ? "canSerializeFMUState" : "canSerializeFMUstate", "true");
    attribute(x, third ? "providesDirectionalDerivatives" : "providesDirectionalDerivative",
              "true");
    if (!third)
        attribute(x, "canNotUseMemoryManagementFunctions", "true");
    if (kind[0] == 'C')
        attribute(x, "canHandleVariableCommunicationStepSize", "true");
    else if (third)
        attribute(x, "needsCompletedIntegratorStep", "true");
    put(x, third ? "/>\n" : ">\n    <SourceFiles><File name=\"fmu.c\"/></SourceFiles>\n  ");
    if (!third)
        putf(x, "</%s>\n", kind);
}

static void put_experiment(struct xml *x)
{
    const struct ct_sim *sim = x->f->w->sim;
    const struct ct_run_options *o = &sim->run_options;
    put(x, "  <DefaultExperiment startTime=\"0\"");
    if (o->duration > 0)
        number(x, "stopTime", o->duration);
    number(x, "tolerance", sim->tolerance);
    if (o->duration > 0 && o->nsample > 1)
        number(x, "stepSize", o->duration / (double)(o->nsample - 1));
    put(x, "/>\n");
}

const char *ct_fmu_description(struct ct_fmu *f)
{
    struct xml x = {.f = f, .arena = f->w->ctx->model};
    const struct ct_model *m = &f->w->sim->system->model;
    put(&x, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription");
    attribute(&x, "fmiVersion", is_third(&x) ? "3.0" : "2.0");
    attribute(&x, "modelName", m->name);
    attribute(&x, is_third(&x) ? "instantiationToken" : "guid", f->source.token);
    if (m->description)
        attribute(&x, "description", m->description);
    attribute(&x, "generationTool", ct_arena_printf(x.arena, "cotree %s", ct_version()));
    attribute(&x, "variableNamingConvention", "flat");
    if (!is_third(&x))
        count(&x, "numberOfEventIndicators", f->w->x.e->nswitch);
    put(&x, ">\n");
    put_kind(&x, "ModelExchange");
    put_kind(&x, "CoSimulation");
    put_units(&x);
    put_experiment(&x);
    put(&x, "  <ModelVariables>\n");
    for (size_t i = 0; i < f->nvariable; i++)
        put_variable(&x, &f->variable[i]);
    put(&x, "  </ModelVariables>\n  <ModelStructure>\n");
    put_list(&x, "Output", "Outputs", is_output);
    put_list(&x, "ContinuousStateDerivative", "Derivatives", is_derivative);
    put_list(&x, "InitialUnknown", "InitialUnknowns", is_calculated);
    if (is_third(&x))
        put_list(&x, "EventIndicator", "", is_root);
    put(&x, "  </ModelStructure>\n</fmiModelDescription>\n");
    CT_PUSH(x.arena, x.s, x.n, x.cap, '\0');
    return x.s;
}

const char *ct_fmu_build_description(struct ct_fmu *f)
{
    return ct_arena_printf(f->w->ctx->model,
                           "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                           "<fmiBuildDescription fmiVersion=\"3.0\">\n"
                           "  <BuildConfiguration modelIdentifier=\"%s\">\n"
                           "    <SourceFileSet language=\"C99\">\n"
                           "      <SourceFile name=\"fmu.c\"/>\n"
                           "    </SourceFileSet>\n"
                           "    <Library name=\"m\" external=\"true\"/>\n"
                           "  </BuildConfiguration>\n"
                           "</fmiBuildDescription>\n",
                           f->w->x.name);
}
