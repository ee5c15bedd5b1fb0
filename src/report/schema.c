// JSON Schema (draft 2020-12) of the model file, from the class tables.
//
// It checks structure, keys, required keys and words. Units, names and expressions are checked
// by the reader: the schema accepts a number or text for every scalar.
#include "base/entry.h"
#include "report/schema.h"

#include "integrate/problem.h"

#include <cotree/cotree.h>

#include <string.h>

// ---- components ----------------------------------------------------------------------------

static const char *const families[] = {"body", "joint", "force"};

static void write_required(struct ct_json *j, const struct ct_key *key, int n)
{
    for (int i = 0; i < n; i++)
        if (key[i].flags & CT_KEY_REQUIRED)
            ct_json_text(j, NULL, key[i].name);
}

// Couplings of joints have neither frames nor the keys that joints share.
static bool has_frames(const struct ct_component_class *c)
{
    for (int i = 0; i < c->nkey; i++)
        if (c->key[i].kind == CT_VALUE_JOINTS)
            return false;
    return true;
}

static void write_class(struct ct_json *j, const struct ct_component_class *c)
{
    int nfamily;
    const struct ct_key *family = ct_family_keys(c->family, &nfamily);
    if (!has_frames(c))
        nfamily = 0;
    char name[64];
    snprintf(name, sizeof name, "%s.%s", families[c->family], c->name);
    ct_schema_object(j, name);
    ct_json_text(j, "description", c->summary);
    ct_json_object(j, "properties");
    ct_json_object(j, "type");
    ct_json_text(j, "const", c->name);
    ct_json_end(j);
    for (int i = 0; i < nfamily; i++)
        ct_schema_key(j, &family[i]);
    for (int i = 0; i < c->nkey; i++)
        ct_schema_key(j, &c->key[i]);
    ct_json_end(j);
    ct_json_array(j, "required");
    if (c->family != CT_FAMILY_BODY)
        ct_json_text(j, NULL, "type");
    write_required(j, family, nfamily);
    write_required(j, c->key, c->nkey);
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

// If type is NAME the object is a NAME; without type it is the standard class of its family.
static void write_choice(struct ct_json *j, const struct ct_component_class *c)
{
    char name[64];
    snprintf(name, sizeof name, "%s.%s", families[c->family], c->name);
    ct_json_object(j, NULL);
    ct_json_object(j, "if");
    ct_json_object(j, "properties");
    ct_json_object(j, "type");
    ct_json_text(j, "const", c->name);
    ct_json_end(j);
    ct_json_end(j);
    if (!c->is_standard) {
        ct_json_array(j, "required");
        ct_json_text(j, NULL, "type");
        ct_json_end(j);
    }
    ct_json_end(j);
    ct_schema_refer(j, "then", name, NULL);
    ct_json_end(j);
}

static void write_family(struct ct_json *j, enum ct_family family)
{
    ct_schema_object(j, families[family]);
    ct_json_object(j, "properties");
    ct_json_object(j, "type");
    ct_json_array(j, "enum");
    for (int i = 0; i < ct_ncomponent_class; i++)
        if (ct_component_classes[i]->family == family)
            ct_json_text(j, NULL, ct_component_classes[i]->name);
    ct_json_end(j);
    ct_json_end(j);
    ct_json_end(j);
    if (family != CT_FAMILY_BODY) {
        ct_json_array(j, "required");
        ct_json_text(j, NULL, "type");
        ct_json_end(j);
    }
    ct_json_array(j, "allOf");
    for (int i = 0; i < ct_ncomponent_class; i++)
        if (ct_component_classes[i]->family == family)
            write_choice(j, ct_component_classes[i]);
    ct_json_end(j);
    ct_json_end(j);
}

// ---- parts that are not components ---------------------------------------------------------

static void write_table(struct ct_json *j)
{
    static const char *const how[] = {"cubic", "linear"};
    ct_schema_object(j, "table");
    ct_json_text(j, "description", "a column of a CSV file against its column t");
    ct_json_object(j, "properties");
    ct_schema_typed(j, "table", "string", NULL);
    ct_schema_typed(j, "column", "string", NULL);
    ct_schema_words(j, "interpolate", how, COUNT(how));
    ct_schema_typed(j, "unit", "string", NULL);
    ct_schema_refer(j, "scale", "scalar", "a factor for its values");
    ct_json_end(j);
    ct_json_array(j, "required");
    ct_json_text(j, NULL, "table");
    ct_json_text(j, NULL, "column");
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

static void write_scalars(struct ct_json *j)
{
    ct_json_object(j, "scalar");
    ct_json_text(j, "description",
                 "a number in SI units, a quantity such as \"152 mm\", or an expression");
    ct_json_array(j, "type");
    ct_json_text(j, NULL, "number");
    ct_json_text(j, NULL, "string");
    ct_json_end(j);
    ct_json_end(j);
    ct_json_object(j, "function");
    ct_json_text(j, "description", "a scalar that may depend on time, or a table");
    ct_json_array(j, "anyOf");
    ct_schema_refer(j, NULL, "scalar", NULL);
    ct_schema_refer(j, NULL, "table", NULL);
    ct_json_end(j);
    ct_json_end(j);
    ct_json_object(j, "hole");
    ct_json_array(j, "anyOf");
    ct_schema_refer(j, NULL, "function", NULL);
    ct_schema_typed(j, NULL, "null", NULL);
    ct_json_end(j);
    ct_json_end(j);
    ct_schema_list(j, "vector", "scalar", 3, 3);
}

static void write_axes(struct ct_json *j)
{
    static const char *const axes[] = {"x", "y", "z"};
    ct_json_object(j, "axis");
    ct_json_array(j, "anyOf");
    ct_schema_words(j, NULL, axes, COUNT(axes));
    ct_schema_refer(j, NULL, "vector", NULL);
    ct_json_end(j);
    ct_json_end(j);
    ct_json_object(j, "turn");
    ct_json_text(j, "description", "[axis, angle]");
    ct_json_text(j, "type", "array");
    ct_json_array(j, "prefixItems");
    ct_schema_refer(j, NULL, "axis", NULL);
    ct_schema_refer(j, NULL, "scalar", NULL);
    ct_json_end(j);
    ct_json_integer(j, "minItems", 2);
    ct_json_integer(j, "maxItems", 2);
    ct_json_end(j);
    ct_json_object(j, "turns");
    ct_json_array(j, "anyOf");
    ct_schema_refer(j, NULL, "turn", NULL);
    ct_schema_list(j, NULL, "turn", 0, 0);
    ct_json_end(j);
    ct_json_end(j);
}

// name: {point: a place, or {at: place, rotate: turns}}
static void write_points(struct ct_json *j, const char *name, const char *place)
{
    ct_schema_object(j, name);
    ct_schema_named_keys(j);
    ct_json_object(j, "additionalProperties");
    ct_json_array(j, "anyOf");
    ct_schema_refer(j, NULL, place, NULL);
    ct_schema_object(j, NULL);
    ct_json_object(j, "properties");
    ct_schema_refer(j, "at", place, "position in axes of the body [m]");
    ct_schema_refer(j, "rotate", "turns",
                    "rotations from the axes of the body to those of the point");
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
    ct_json_end(j);
    ct_json_end(j);
    ct_json_end(j);
}

static void write_fields(struct ct_json *j, const char *name, const char *rates, bool is_list)
{
    static const char *const keys[] = {"u", "v", "w", "rx"};
    ct_schema_object(j, name);
    ct_json_object(j, "properties");
    for (size_t i = 0; i < COUNT(keys); i++) {
        if (!is_list) {
            ct_schema_refer(j, keys[i], "scalar", NULL);
            continue;
        }
        ct_json_object(j, keys[i]);
        ct_json_array(j, "anyOf");
        ct_schema_refer(j, NULL, "scalar", NULL);
        ct_schema_list(j, NULL, "scalar", 0, 0);
        ct_json_end(j);
        ct_json_end(j);
    }
    if (rates)
        ct_schema_refer(j, "rates", rates, "speeds of the same");
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

static void write_of_beams(struct ct_json *j)
{
    write_fields(j, "shapes", NULL, true);
    write_fields(j, "rates", NULL, false);
    write_fields(j, "fields", "rates", false);
    ct_json_object(j, "place");
    ct_json_text(j, "description", "distance along a beam, or [x, y, z]");
    ct_json_array(j, "anyOf");
    ct_schema_refer(j, NULL, "scalar", NULL);
    ct_schema_refer(j, NULL, "vector", NULL);
    ct_json_end(j);
    ct_json_end(j);
    write_points(j, "places", "place");
    ct_schema_object(j, "rayleigh");
    ct_json_object(j, "properties");
    ct_schema_refer(j, "alpha", "scalar", "times the mass matrix [1/s] (0)");
    ct_schema_refer(j, "beta", "scalar", "times the stiffness matrix [s] (0)");
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

// One of the kinds, with the keys common to all.
static void write_solid(struct ct_json *j, const char *kind, int length, const char *more)
{
    ct_json_object(j, NULL);
    ct_json_text(j, "type", "object");
    ct_json_object(j, "properties");
    ct_json_object(j, kind);
    if (length > 0) {
        ct_json_text(j, "type", "array");
        ct_schema_refer(j, "items", "scalar", NULL);
        ct_json_integer(j, "minItems", length);
        ct_json_integer(j, "maxItems", length);
    } else if (strcmp(kind, "lines") == 0) {
        ct_json_text(j, "type", "array");
        ct_schema_refer(j, "items", "vector", NULL);
        ct_json_integer(j, "minItems", 2);
    } else if (strcmp(kind, "file") == 0) {
        ct_json_text(j, "type", "string");
    } else {
        ct_json_text(j, "$ref", "#/$defs/scalar");
    }
    ct_json_end(j);
    if (more)
        ct_schema_refer(j, more, strcmp(more, "axis") == 0 ? "axis" : "scalar", NULL);
    ct_schema_refer(j, "at", "vector", "its position in axes of the body [m] ([0, 0, 0])");
    ct_schema_refer(j, "rotate", "turns", "rotations from the axes of the body to its own");
    ct_schema_typed(j, "color", "string", NULL);
    ct_json_end(j);
    ct_json_array(j, "required");
    ct_json_text(j, NULL, kind);
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

static void write_solids(struct ct_json *j)
{
    ct_json_object(j, "solid");
    ct_json_array(j, "anyOf");
    write_solid(j, "box", 3, NULL);
    write_solid(j, "cylinder", 2, "axis");
    write_solid(j, "sphere", 0, NULL);
    write_solid(j, "lines", 0, NULL);
    write_solid(j, "file", 0, "scale");
    ct_json_end(j);
    ct_json_end(j);
    ct_json_object(j, "solids");
    ct_json_array(j, "anyOf");
    ct_schema_refer(j, NULL, "solid", NULL);
    ct_schema_list(j, NULL, "solid", 0, 0);
    ct_schema_typed(j, NULL, "null", NULL);
    ct_json_end(j);
    ct_json_end(j);
}

static void write_initial(struct ct_json *j)
{
    static const char *const keys[] = {"q", "u"};
    ct_schema_object(j, "initial");
    ct_json_object(j, "properties");
    for (size_t i = 0; i < COUNT(keys); i++) {
        ct_json_object(j, keys[i]);
        ct_json_array(j, "anyOf");
        ct_schema_refer(j, NULL, "scalar", NULL);
        ct_schema_list(j, NULL, "hole", 0, 0);
        ct_json_end(j);
        ct_json_end(j);
    }
    ct_schema_refer(j, "rotate", "turns", NULL);
    ct_schema_typed(j, "guess", "boolean", NULL);
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

static void write_outputs(struct ct_json *j)
{
    ct_json_object(j, "output");
    ct_json_array(j, "anyOf");
    ct_schema_typed(j, NULL, "string", NULL);
    ct_schema_object(j, NULL);
    ct_json_object(j, "properties");
    ct_schema_typed(j, "name", "string", NULL);
    ct_schema_refer(j, "value", "scalar", "an expression of signals");
    ct_json_end(j);
    ct_json_array(j, "required");
    ct_json_text(j, NULL, "name");
    ct_json_text(j, NULL, "value");
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
    ct_json_end(j);
    ct_json_end(j);
}

static void write_simulation(struct ct_json *j)
{
    static const char *const jumps[] = {"impulse", "continuous"};
    static const struct {
        const char *name, *doc, *bound; // of a number; an expression has none here
        int least;
    } numbers[] = {
        {"duration", "end time [s]", "minimum", 0},
        {"samples", "number of samples, both ends included (1001)", "minimum", 2},
        {"interval", "spacing of samples, instead of their number [s]", "exclusiveMinimum", 0},
        {"tolerance", "wanted relative accuracy of the outputs (1e-8)", "exclusiveMinimum", 0},
        {"absolute", "wanted accuracy of quantities near zero (tolerance/100)",
         "exclusiveMinimum", 0},
        {"step", "fixed step [s]", "exclusiveMinimum", 0}};
    ct_schema_object(j, "simulation");
    ct_json_object(j, "properties");
    for (size_t i = 0; i < COUNT(numbers); i++) {
        ct_json_object(j, numbers[i].name);
        ct_json_text(j, "$ref", "#/$defs/scalar");
        ct_json_text(j, "description", numbers[i].doc);
        ct_json_integer(j, numbers[i].bound, numbers[i].least);
        ct_json_end(j);
    }
    ct_json_object(j, "method");
    ct_json_array(j, "enum");
    ct_json_text(j, NULL, "auto");
    for (int i = 0; i < ct_nmethod; i++)
        ct_json_text(j, NULL, ct_methods[i]->name);
    ct_json_end(j);
    ct_json_end(j);
    ct_schema_words(j, "rate_jumps", jumps, COUNT(jumps));
    ct_json_object(j, "small");
    ct_json_text(j, "type", "array");
    ct_schema_typed(j, "items", "string", NULL);
    ct_json_end(j);
    ct_json_end(j);
    ct_json_object(j, "not");
    ct_json_array(j, "required");
    ct_json_text(j, NULL, "samples");
    ct_json_text(j, NULL, "interval");
    ct_json_end(j);
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

static void write_ground(struct ct_json *j)
{
    ct_schema_object(j, "ground");
    ct_json_text(j, "description",
                 "the inertial body; it is listed only to carry points and a shape");
    ct_json_object(j, "properties");
    ct_schema_refer(j, "points", "points", NULL);
    ct_schema_refer(j, "shape", "solids", NULL);
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

static void write_input(struct ct_json *j)
{
    ct_json_object(j, "input");
    ct_json_text(j, "description",
                 "a number that the caller sets; constant until it is set again");
    ct_json_array(j, "type");
    ct_json_text(j, NULL, "object");
    ct_json_text(j, NULL, "number");
    ct_json_text(j, NULL, "string");
    ct_json_end(j);
    ct_json_object(j, "properties");
    ct_schema_refer(j, "value", "scalar", "value until it is set (0)");
    ct_schema_typed(j, "unit", "string", NULL);
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

static void write_state(struct ct_json *j)
{
    ct_schema_object(j, "state");
    ct_json_text(j, "description", "a first-order equation of the user's own: z' = rate");
    ct_json_object(j, "properties");
    ct_schema_refer(j, "rate", "function", "of time, signals and states, in SI units");
    ct_schema_refer(j, "initial", "scalar", "at the start (0)");
    ct_schema_typed(j, "unit", "string", NULL);
    ct_json_end(j);
    ct_json_array(j, "required");
    ct_json_text(j, NULL, "rate");
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

static void write_definitions(struct ct_json *j)
{
    ct_json_object(j, "$defs");
    write_scalars(j);
    write_table(j);
    write_axes(j);
    write_points(j, "points", "vector");
    write_of_beams(j);
    write_solids(j);
    write_initial(j);
    write_outputs(j);
    write_simulation(j);
    write_ground(j);
    write_input(j);
    write_state(j);
    for (int f = 0; f < (int)COUNT(families); f++) {
        write_family(j, (enum ct_family)f);
        for (int i = 0; i < ct_ncomponent_class; i++)
            if ((int)ct_component_classes[i]->family == f)
                write_class(j, ct_component_classes[i]);
    }
    ct_json_end(j);
}

// ---- the file ------------------------------------------------------------------------------

// A section: names -> components, or nothing.
static void write_section(struct ct_json *j, const char *key, const char *item, bool has_ground)
{
    ct_json_object(j, key);
    ct_json_array(j, "type");
    ct_json_text(j, NULL, "object");
    ct_json_text(j, NULL, "null");
    ct_json_end(j);
    ct_schema_named_keys(j);
    if (has_ground) {
        ct_json_object(j, "properties");
        ct_schema_refer(j, "ground", "ground", NULL);
        ct_json_end(j);
    }
    ct_schema_refer(j, "additionalProperties", item, NULL);
    ct_json_end(j);
}

static void write_sections(struct ct_json *j)
{
    ct_json_object(j, "properties");
    ct_json_object(j, "cotree");
    ct_json_text(j, "description", "version of the format");
    ct_json_integer(j, "const", 1);
    ct_json_end(j);
    ct_schema_typed(j, "name", "string", NULL);
    ct_schema_typed(j, "description", "string", NULL);
    ct_schema_refer(j, "gravity", "vector", "in ground axes [m/s^2] ([0, 0, 0])");
    write_section(j, "parameters", "scalar", false);
    write_section(j, "inputs", "input", false);
    write_section(j, "states", "state", false);
    write_section(j, "bodies", "body", true);
    write_section(j, "joints", "joint", false);
    write_section(j, "forces", "force", false);
    ct_json_object(j, "outputs");
    ct_json_array(j, "type");
    ct_json_text(j, NULL, "array");
    ct_json_text(j, NULL, "null");
    ct_json_end(j);
    ct_schema_refer(j, "items", "output", NULL);
    ct_json_end(j);
    ct_schema_refer(j, "simulation", "simulation", NULL);
    ct_json_end(j);
}

static void print_schema(const void *all, FILE *out)
{
    (void)all;
    struct ct_json j;
    ct_json_init(&j, out);
    ct_json_object(&j, NULL);
    ct_json_text(&j, "$schema", "https://json-schema.org/draft/2020-12/schema");
    ct_json_text(&j, "title", "cotree model");
    ct_json_text(&j, "type", "object");
    write_sections(&j);
    ct_json_array(&j, "required");
    ct_json_text(&j, NULL, "cotree");
    ct_json_end(&j);
    ct_json_bool(&j, "additionalProperties", false);
    write_definitions(&j);
    ct_json_end(&j);
}

void ct_schema_print(FILE *out)
{
    ct_print_to(out, print_schema, "");
}

char *ct_schema_text(void)
{
    return ct_print_text(print_schema, "");
}
