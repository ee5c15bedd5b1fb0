// Functions that write the parts of the JSON Schema.
//
//     schema.c       the sections of the model file
//     schema_key.c   values allowed for a key of a class
#ifndef CT_REPORT_SCHEMA_H
#define CT_REPORT_SCHEMA_H

#include "component/class.h"
#include "report/json.h"

/// key: {"$ref": "#/$defs/NAME"}, with a description where there is one.
void ct_schema_refer(struct ct_json *j, const char *key, const char *name, const char *doc);
/// key: {"type": "object", which stays open.
void ct_schema_object(struct ct_json *j, const char *key);
/// key: {"type": "array", "items": item, "minItems": least, "maxItems": most}; most 0: any number.
void ct_schema_list(struct ct_json *j, const char *key, const char *item, int least, int most);
/// key: {"enum": the words}.
void ct_schema_words(struct ct_json *j, const char *key, const char *const *word, size_t n);
/// key: {"type": TYPE}; two types as a list.
void ct_schema_typed(struct ct_json *j, const char *key, const char *type, const char *other);
/// Keys are names of the model's own.
void ct_schema_named_keys(struct ct_json *j);

/// Writes the values allowed for a key of a class.
void ct_schema_key(struct ct_json *j, const struct ct_key *key);

#endif
