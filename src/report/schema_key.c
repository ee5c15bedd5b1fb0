// See schema.h.
#include "report/schema.h"

#include <string.h>

void ct_schema_refer(struct ct_json *j, const char *key, const char *name, const char *doc)
{
    char path[80];
    snprintf(path, sizeof path, "#/$defs/%s", name);
    ct_json_object(j, key);
    ct_json_text(j, "$ref", path);
    if (doc)
        ct_json_text(j, "description", doc);
    ct_json_end(j);
}

void ct_schema_object(struct ct_json *j, const char *key)
{
    ct_json_object(j, key);
    ct_json_text(j, "type", "object");
}

void ct_schema_list(struct ct_json *j, const char *key, const char *item, int least, int most)
{
    ct_json_object(j, key);
    ct_json_text(j, "type", "array");
    ct_schema_refer(j, "items", item, NULL);
    if (least)
        ct_json_integer(j, "minItems", least);
    if (most)
        ct_json_integer(j, "maxItems", most);
    ct_json_end(j);
}

void ct_schema_words(struct ct_json *j, const char *key, const char *const *word, size_t n)
{
    ct_json_object(j, key);
    ct_json_array(j, "enum");
    for (size_t i = 0; i < n; i++)
        ct_json_text(j, NULL, word[i]);
    ct_json_end(j);
    ct_json_end(j);
}

void ct_schema_typed(struct ct_json *j, const char *key, const char *type, const char *other)
{
    ct_json_object(j, key);
    if (!other) {
        ct_json_text(j, "type", type);
    } else {
        ct_json_array(j, "type");
        ct_json_text(j, NULL, type);
        ct_json_text(j, NULL, other);
        ct_json_end(j);
    }
    ct_json_end(j);
}

void ct_schema_named_keys(struct ct_json *j)
{
    ct_json_object(j, "propertyNames");
    ct_json_text(j, "pattern", "^[A-Za-z_][A-Za-z0-9_]*$");
    ct_json_end(j);
}

// ---- values --------------------------------------------------------------------------------

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
    ct_json_text(j, "description", doc);
}

static void scalar_or_list(struct ct_json *j, const struct ct_key *key)
{
    ct_json_array(j, "anyOf");
    ct_schema_refer(j, NULL, scalar_of(key), NULL);
    ct_schema_list(j, NULL, key->kind == CT_VALUE_COORDS ? "hole" : scalar_of(key), key->least,
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
        if (strcmp(word, "true") == 0 || strcmp(word, "false") == 0)
            ct_json_bool(j, NULL, *word == 't'); // as YAML reads them
        else
            ct_json_text(j, NULL, word);
        p += length;
    }
    ct_json_end(j);
}

static void auto_or_choices(struct ct_json *j, const struct ct_key *key)
{
    ct_json_array(j, "anyOf");
    ct_json_object(j, NULL);
    ct_json_text(j, "const", "auto");
    ct_json_end(j);
    ct_json_object(j, NULL);
    ct_json_text(j, "type", "array");
    ct_json_object(j, "items");
    choices(j, key);
    ct_json_end(j);
    ct_json_bool(j, "uniqueItems", true);
    ct_json_end(j);
    ct_json_end(j);
}

void ct_schema_key(struct ct_json *j, const struct ct_key *key)
{
    ct_json_object(j, key->name);
    describe(j, key);
    switch (key->kind) {
    case CT_VALUE_SCALAR:
        ct_json_text(j, "$ref",
                     key->flags & (CT_KEY_TIME | CT_KEY_STATE) ? "#/$defs/function"
                                                               : "#/$defs/scalar");
        break;
    case CT_VALUE_VEC3:
        ct_json_text(j, "type", "array");
        ct_schema_refer(j, "items", scalar_of(key), NULL);
        ct_json_integer(j, "minItems", 3);
        ct_json_integer(j, "maxItems", 3);
        break;
    case CT_VALUE_LIST:
    case CT_VALUE_COORDS:
        scalar_or_list(j, key);
        break;
    case CT_VALUE_AXIS:
        ct_json_text(j, "$ref", "#/$defs/axis");
        break;
    case CT_VALUE_AXES:
        ct_json_text(j, "type", "array");
        ct_schema_refer(j, "items", "axis", NULL);
        ct_json_integer(j, "minItems", 2);
        ct_json_integer(j, "maxItems", 2);
        break;
    case CT_VALUE_TURNS:
        ct_json_text(j, "$ref", "#/$defs/turns");
        break;
    case CT_VALUE_FRAME:
        ct_json_text(j, "type", "string");
        break;
    case CT_VALUE_NAMES:
    case CT_VALUE_JOINTS:
        ct_json_text(j, "type", "array");
        ct_schema_typed(j, "items", "string", NULL);
        ct_json_integer(j, "minItems", key->least);
        ct_json_integer(j, "maxItems", key->most);
        break;
    case CT_VALUE_POINTS:
        ct_json_text(j, "$ref", "#/$defs/points");
        break;
    case CT_VALUE_INITIAL:
        ct_json_text(j, "$ref", "#/$defs/initial");
        break;
    case CT_VALUE_COUNT:
        ct_json_text(j, "$ref", "#/$defs/scalar");
        break;
    case CT_VALUE_WORD:
        choices(j, key);
        break;
    case CT_VALUE_WORDS:
        auto_or_choices(j, key);
        break;
    case CT_VALUE_ELEMENTS:
        ct_json_array(j, "anyOf");
        ct_schema_refer(j, NULL, "scalar", NULL);
        ct_schema_list(j, NULL, "scalar", 1, 0);
        ct_json_end(j);
        break;
    case CT_VALUE_ROTARY:
        ct_json_array(j, "anyOf");
        ct_schema_typed(j, NULL, "boolean", NULL);
        ct_schema_refer(j, NULL, "vector", NULL);
        ct_json_end(j);
        break;
    case CT_VALUE_RAYLEIGH:
        ct_json_text(j, "$ref", "#/$defs/rayleigh");
        break;
    case CT_VALUE_SHAPES:
        ct_json_text(j, "$ref", "#/$defs/shapes");
        break;
    case CT_VALUE_FIELDS:
        ct_json_array(j, "anyOf");
        ct_json_object(j, NULL);
        ct_json_text(j, "const", "equilibrium");
        ct_json_end(j);
        ct_schema_refer(j, NULL, "fields", NULL);
        ct_json_end(j);
        break;
    case CT_VALUE_PLACES:
        ct_json_text(j, "$ref", "#/$defs/places");
        break;
    case CT_VALUE_SOLIDS:
        ct_json_text(j, "$ref", "#/$defs/solids");
        break;
    }
    ct_json_end(j);
}
