// JSON Schema (draft 2020-12) of the model file, from the class tables.
//
// It checks shapes, keys, required keys and words. What a schema cannot know (units, names, expressions)
// is left to the reader: a number or text stands for every scalar.
#include "component/class.h"
#include "integrate/problem.h"
#include "report/json.h"

#include <cotree/cotree.h>

#include <string.h>

static void text(struct ct_json *j, const char *key, const char *value)
{
    ct_json_text(j, key, value);
}

// key: {"$ref": "#/$defs/NAME"}, with a description where there is one
static void refer(struct ct_json *j, const char *key, const char *name, const char *doc)
{
    char path[80];
    snprintf(path, sizeof path, "#/$defs/%s", name);
    ct_json_object(j, key);
    text(j, "$ref", path);
    if (doc)
        text(j, "description", doc);
    ct_json_end(j);
}

static void closed_object(struct ct_json *j, const char *key)
{
    ct_json_object(j, key);
    text(j, "type", "object");
}

// {"type": "array", "items": item, "minItems": least, "maxItems": most}; most 0: any number
static void list_of(struct ct_json *j, const char *key, const char *item, int least, int most)
{
    ct_json_object(j, key);
    text(j, "type", "array");
    refer(j, "items", item, NULL);
    if (least)
        ct_json_integer(j, "minItems", least);
    if (most)
        ct_json_integer(j, "maxItems", most);
    ct_json_end(j);
}

static void words(struct ct_json *j, const char *key, const char *const *word, size_t n)
{
    ct_json_object(j, key);
    ct_json_array(j, "enum");
    for (size_t i = 0; i < n; i++)
        text(j, NULL, word[i]);
    ct_json_end(j);
    ct_json_end(j);
}

// {"type": TYPE}; two types as a list
static void typed(struct ct_json *j, const char *key, const char *type, const char *other)
{
    ct_json_object(j, key);
    if (!other) {
        text(j, "type", type);
    } else {
        ct_json_array(j, "type");
        text(j, NULL, type);
        text(j, NULL, other);
        ct_json_end(j);
    }
    ct_json_end(j);
}

// Keys are names of the model's own.
static void named_keys(struct ct_json *j)
{
    ct_json_object(j, "propertyNames");
    text(j, "pattern", "^[A-Za-z_][A-Za-z0-9_]*$");
    ct_json_end(j);
}

// ---- values ---------------------------------------------------------------------------------------------

static const char *scalar_of(const struct ct_key *key)
{
    return key->flags & (CT_KEY_TIME | CT_KEY_STATE) ? "function" : "scalar";
}

static void describe(struct ct_json *j, const struct ct_key *key)
{
    char doc[320];
    const bool is_word = key->kind == CT_VALUE_WORD || key->kind == CT_VALUE_WORDS;
    const bool has_unit = key->unit && *key->unit && !is_word;
    snprintf(doc, sizeof doc, "%s%s%s%s", key->doc, has_unit ? " [" : "",
             has_unit ? key->unit : "", has_unit ? "]" : "");
    text(j, "description", doc);
}

static void scalar_or_list(struct ct_json *j, const struct ct_key *key)
{
    ct_json_array(j, "anyOf");
    refer(j, NULL, scalar_of(key), NULL);
    list_of(j, NULL, key->kind == CT_VALUE_COORDS ? "hole" : scalar_of(key), key->least,
            key->most);
    ct_json_end(j);
}

// "enum": the choices of a key
static void choices(struct ct_json *j, const struct ct_key *key)
{
    ct_json_array(j, "enum");
    for (const char *p = key->unit; *p; p += *p == '|') {
        const int length = (int)strcspn(p, "|");
        char word[64];
        snprintf(word, sizeof word, "%.*s", length, p);
        text(j, NULL, word);
        p += length;
    }
    ct_json_end(j);
}

static void auto_or_choices(struct ct_json *j, const struct ct_key *key)
{
    ct_json_array(j, "anyOf");
    ct_json_object(j, NULL);
    text(j, "const", "auto");
    ct_json_end(j);
    ct_json_object(j, NULL);
    text(j, "type", "array");
    ct_json_object(j, "items");
    choices(j, key);
    ct_json_end(j);
    ct_json_bool(j, "uniqueItems", true);
    ct_json_end(j);
    ct_json_end(j);
}

static void write_key(struct ct_json *j, const struct ct_key *key)
{
    ct_json_object(j, key->name);
    describe(j, key);
    switch (key->kind) {
    case CT_VALUE_SCALAR:
        text(j, "$ref",
             key->flags & (CT_KEY_TIME | CT_KEY_STATE) ? "#/$defs/function" : "#/$defs/scalar");
        break;
    case CT_VALUE_VEC3:
        text(j, "type", "array");
        refer(j, "items", scalar_of(key), NULL);
        ct_json_integer(j, "minItems", 3);
        ct_json_integer(j, "maxItems", 3);
        break;
    case CT_VALUE_LIST:
    case CT_VALUE_COORDS:
        scalar_or_list(j, key);
        break;
    case CT_VALUE_AXIS:
        text(j, "$ref", "#/$defs/axis");
        break;
    case CT_VALUE_AXES:
        text(j, "type", "array");
        refer(j, "items", "axis", NULL);
        ct_json_integer(j, "minItems", 2);
        ct_json_integer(j, "maxItems", 2);
        break;
    case CT_VALUE_TURNS:
        text(j, "$ref", "#/$defs/turns");
        break;
    case CT_VALUE_FRAME:
        text(j, "type", "string");
        break;
    case CT_VALUE_NAMES:
    case CT_VALUE_JOINTS:
        text(j, "type", "array");
        typed(j, "items", "string", NULL);
        ct_json_integer(j, "minItems", key->least);
        ct_json_integer(j, "maxItems", key->most);
        break;
    case CT_VALUE_POINTS:
        text(j, "$ref", "#/$defs/points");
        break;
    case CT_VALUE_INITIAL:
        text(j, "$ref", "#/$defs/initial");
        break;
    case CT_VALUE_COUNT:
        text(j, "$ref", "#/$defs/scalar");
        break;
    case CT_VALUE_WORD:
        choices(j, key);
        break;
    case CT_VALUE_WORDS:
        auto_or_choices(j, key);
        break;
    case CT_VALUE_ELEMENTS:
        ct_json_array(j, "anyOf");
        refer(j, NULL, "scalar", NULL);
        list_of(j, NULL, "scalar", 1, 0);
        ct_json_end(j);
        break;
    case CT_VALUE_ROTARY:
        ct_json_array(j, "anyOf");
        typed(j, NULL, "boolean", NULL);
        refer(j, NULL, "vector", NULL);
        ct_json_end(j);
        break;
    case CT_VALUE_RAYLEIGH:
        text(j, "$ref", "#/$defs/rayleigh");
        break;
    case CT_VALUE_SHAPES:
        text(j, "$ref", "#/$defs/shapes");
        break;
    case CT_VALUE_FIELDS:
        ct_json_array(j, "anyOf");
        ct_json_object(j, NULL);
        text(j, "const", "equilibrium");
        ct_json_end(j);
        refer(j, NULL, "fields", NULL);
        ct_json_end(j);
        break;
    case CT_VALUE_PLACES:
        text(j, "$ref", "#/$defs/places");
        break;
    }
    ct_json_end(j);
}

// ---- components -------------------------------------------------------------------------------------------

static const char *const families[] = {"body", "joint", "force"};

static void write_required(struct ct_json *j, const struct ct_key *key, int n)
{
    for (int i = 0; i < n; i++)
        if (key[i].flags & CT_KEY_REQUIRED)
            text(j, NULL, key[i].name);
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
    closed_object(j, name);
    text(j, "description", c->summary);
    ct_json_object(j, "properties");
    ct_json_object(j, "type");
    text(j, "const", c->name);
    ct_json_end(j);
    for (int i = 0; i < nfamily; i++)
        write_key(j, &family[i]);
    for (int i = 0; i < c->nkey; i++)
        write_key(j, &c->key[i]);
    ct_json_end(j);
    ct_json_array(j, "required");
    if (c->family != CT_FAMILY_BODY)
        text(j, NULL, "type");
    write_required(j, family, nfamily);
    write_required(j, c->key, c->nkey);
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

// if type is NAME then the object is a NAME; a body without type is rigid
static void write_choice(struct ct_json *j, const struct ct_component_class *c)
{
    char name[64];
    snprintf(name, sizeof name, "%s.%s", families[c->family], c->name);
    ct_json_object(j, NULL);
    ct_json_object(j, "if");
    ct_json_object(j, "properties");
    ct_json_object(j, "type");
    text(j, "const", c->name);
    ct_json_end(j);
    ct_json_end(j);
    if (strcmp(c->name, "rigid") != 0) {
        ct_json_array(j, "required");
        text(j, NULL, "type");
        ct_json_end(j);
    }
    ct_json_end(j);
    refer(j, "then", name, NULL);
    ct_json_end(j);
}

static void write_family(struct ct_json *j, enum ct_family family)
{
    closed_object(j, families[family]);
    ct_json_object(j, "properties");
    ct_json_object(j, "type");
    ct_json_array(j, "enum");
    for (int i = 0; i < ct_ncomponent_class; i++)
        if (ct_component_classes[i]->family == family)
            text(j, NULL, ct_component_classes[i]->name);
    ct_json_end(j);
    ct_json_end(j);
    ct_json_end(j);
    if (family != CT_FAMILY_BODY) {
        ct_json_array(j, "required");
        text(j, NULL, "type");
        ct_json_end(j);
    }
    ct_json_array(j, "allOf");
    for (int i = 0; i < ct_ncomponent_class; i++)
        if (ct_component_classes[i]->family == family)
            write_choice(j, ct_component_classes[i]);
    ct_json_end(j);
    ct_json_end(j);
}

// ---- parts that are not components ---------------------------------------------------------------------

static void write_table(struct ct_json *j)
{
    static const char *const how[] = {"cubic", "linear"};
    closed_object(j, "table");
    text(j, "description", "a column of a CSV file against its column t");
    ct_json_object(j, "properties");
    typed(j, "table", "string", NULL);
    typed(j, "column", "string", NULL);
    words(j, "interpolate", how, COUNT(how));
    ct_json_end(j);
    ct_json_array(j, "required");
    text(j, NULL, "table");
    text(j, NULL, "column");
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

static void write_scalars(struct ct_json *j)
{
    ct_json_object(j, "scalar");
    text(j, "description",
         "a number in SI units, a quantity such as \"152 mm\", or an expression");
    ct_json_array(j, "type");
    text(j, NULL, "number");
    text(j, NULL, "string");
    ct_json_end(j);
    ct_json_end(j);
    ct_json_object(j, "function");
    text(j, "description", "a scalar that may depend on time, or a table");
    ct_json_array(j, "anyOf");
    refer(j, NULL, "scalar", NULL);
    refer(j, NULL, "table", NULL);
    ct_json_end(j);
    ct_json_end(j);
    ct_json_object(j, "hole");
    ct_json_array(j, "anyOf");
    refer(j, NULL, "function", NULL);
    typed(j, NULL, "null", NULL);
    ct_json_end(j);
    ct_json_end(j);
    list_of(j, "vector", "scalar", 3, 3);
}

static void write_axes(struct ct_json *j)
{
    static const char *const axes[] = {"x", "y", "z"};
    ct_json_object(j, "axis");
    ct_json_array(j, "anyOf");
    words(j, NULL, axes, COUNT(axes));
    refer(j, NULL, "vector", NULL);
    ct_json_end(j);
    ct_json_end(j);
    ct_json_object(j, "turn");
    text(j, "description", "[axis, angle]");
    text(j, "type", "array");
    ct_json_array(j, "prefixItems");
    refer(j, NULL, "axis", NULL);
    refer(j, NULL, "scalar", NULL);
    ct_json_end(j);
    ct_json_integer(j, "minItems", 2);
    ct_json_integer(j, "maxItems", 2);
    ct_json_end(j);
    ct_json_object(j, "turns");
    ct_json_array(j, "anyOf");
    refer(j, NULL, "turn", NULL);
    list_of(j, NULL, "turn", 0, 0);
    ct_json_end(j);
    ct_json_end(j);
}

// name: {point: a place, or {at: place, rotate: turns}}
static void write_points(struct ct_json *j, const char *name, const char *place)
{
    closed_object(j, name);
    named_keys(j);
    ct_json_object(j, "additionalProperties");
    ct_json_array(j, "anyOf");
    refer(j, NULL, place, NULL);
    closed_object(j, NULL);
    ct_json_object(j, "properties");
    refer(j, "at", place, "place in axes of the body [m]");
    refer(j, "rotate", "turns", "turns the point's axes out of the body's");
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
    closed_object(j, name);
    ct_json_object(j, "properties");
    for (size_t i = 0; i < COUNT(keys); i++) {
        if (!is_list) {
            refer(j, keys[i], "scalar", NULL);
            continue;
        }
        ct_json_object(j, keys[i]);
        ct_json_array(j, "anyOf");
        refer(j, NULL, "scalar", NULL);
        list_of(j, NULL, "scalar", 0, 0);
        ct_json_end(j);
        ct_json_end(j);
    }
    if (rates)
        refer(j, "rates", rates, "speeds of the same");
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
    text(j, "description", "distance along a beam, or [x, y, z]");
    ct_json_array(j, "anyOf");
    refer(j, NULL, "scalar", NULL);
    refer(j, NULL, "vector", NULL);
    ct_json_end(j);
    ct_json_end(j);
    write_points(j, "places", "place");
    closed_object(j, "rayleigh");
    ct_json_object(j, "properties");
    refer(j, "alpha", "scalar", "times the mass matrix [1/s] (0)");
    refer(j, "beta", "scalar", "times the stiffness matrix [s] (0)");
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

static void write_initial(struct ct_json *j)
{
    static const char *const keys[] = {"q", "u"};
    closed_object(j, "initial");
    ct_json_object(j, "properties");
    for (size_t i = 0; i < COUNT(keys); i++) {
        ct_json_object(j, keys[i]);
        ct_json_array(j, "anyOf");
        refer(j, NULL, "scalar", NULL);
        list_of(j, NULL, "hole", 0, 0);
        ct_json_end(j);
        ct_json_end(j);
    }
    refer(j, "rotate", "turns", NULL);
    typed(j, "guess", "boolean", NULL);
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

static void write_outputs(struct ct_json *j)
{
    ct_json_object(j, "output");
    ct_json_array(j, "anyOf");
    typed(j, NULL, "string", NULL);
    closed_object(j, NULL);
    ct_json_object(j, "properties");
    typed(j, "name", "string", NULL);
    refer(j, "value", "scalar", "an expression of signals");
    ct_json_end(j);
    ct_json_array(j, "required");
    text(j, NULL, "name");
    text(j, NULL, "value");
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
    closed_object(j, "simulation");
    ct_json_object(j, "properties");
    for (size_t i = 0; i < COUNT(numbers); i++) {
        ct_json_object(j, numbers[i].name);
        text(j, "$ref", "#/$defs/scalar");
        text(j, "description", numbers[i].doc);
        ct_json_integer(j, numbers[i].bound, numbers[i].least);
        ct_json_end(j);
    }
    ct_json_object(j, "method");
    ct_json_array(j, "enum");
    text(j, NULL, "auto");
    for (int i = 0; i < ct_nmethod; i++)
        text(j, NULL, ct_methods[i]->name);
    ct_json_end(j);
    ct_json_end(j);
    words(j, "rate_jumps", jumps, COUNT(jumps));
    ct_json_object(j, "small");
    text(j, "type", "array");
    typed(j, "items", "string", NULL);
    ct_json_end(j);
    ct_json_end(j);
    ct_json_object(j, "not");
    ct_json_array(j, "required");
    text(j, NULL, "samples");
    text(j, NULL, "interval");
    ct_json_end(j);
    ct_json_end(j);
    ct_json_bool(j, "additionalProperties", false);
    ct_json_end(j);
}

static void write_ground(struct ct_json *j)
{
    closed_object(j, "ground");
    text(j, "description", "the inertial body; it is listed only to carry points");
    ct_json_object(j, "properties");
    refer(j, "points", "points", NULL);
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
    write_initial(j);
    write_outputs(j);
    write_simulation(j);
    write_ground(j);
    for (int f = 0; f < (int)COUNT(families); f++) {
        write_family(j, (enum ct_family)f);
        for (int i = 0; i < ct_ncomponent_class; i++)
            if ((int)ct_component_classes[i]->family == f)
                write_class(j, ct_component_classes[i]);
    }
    ct_json_end(j);
}

// ---- the file ------------------------------------------------------------------------------------------------

// A section: names -> components, or nothing.
static void write_section(struct ct_json *j, const char *key, const char *item, bool has_ground)
{
    ct_json_object(j, key);
    ct_json_array(j, "type");
    text(j, NULL, "object");
    text(j, NULL, "null");
    ct_json_end(j);
    named_keys(j);
    if (has_ground) {
        ct_json_object(j, "properties");
        refer(j, "ground", "ground", NULL);
        ct_json_end(j);
    }
    refer(j, "additionalProperties", item, NULL);
    ct_json_end(j);
}

static void write_sections(struct ct_json *j)
{
    ct_json_object(j, "properties");
    ct_json_object(j, "cotree");
    text(j, "description", "version of the format");
    ct_json_integer(j, "const", 1);
    ct_json_end(j);
    typed(j, "name", "string", NULL);
    typed(j, "description", "string", NULL);
    refer(j, "gravity", "vector", "in ground axes [m/s^2] ([0, 0, 0])");
    write_section(j, "parameters", "scalar", false);
    write_section(j, "bodies", "body", true);
    write_section(j, "joints", "joint", false);
    write_section(j, "forces", "force", false);
    ct_json_object(j, "outputs");
    ct_json_array(j, "type");
    text(j, NULL, "array");
    text(j, NULL, "null");
    ct_json_end(j);
    refer(j, "items", "output", NULL);
    ct_json_end(j);
    refer(j, "simulation", "simulation", NULL);
    ct_json_end(j);
}

void ct_schema_print(FILE *out)
{
    struct ct_json j;
    ct_json_init(&j, out);
    ct_json_object(&j, NULL);
    text(&j, "$schema", "https://json-schema.org/draft/2020-12/schema");
    text(&j, "title", "cotree model");
    text(&j, "type", "object");
    write_sections(&j);
    ct_json_array(&j, "required");
    text(&j, NULL, "cotree");
    ct_json_end(&j);
    ct_json_bool(&j, "additionalProperties", false);
    write_definitions(&j);
    ct_json_end(&j);
}
