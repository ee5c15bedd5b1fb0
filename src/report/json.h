// JSON, member by member, indented.
//
//     ct_json_object(j, NULL);                    {
//     ct_json_text(j, "model", "pendulum");           "model": "pendulum",
//     ct_json_array(j, "tree");                       "tree": [
//     ct_json_text(j, NULL, "pivot");                     "pivot"
//     ct_json_end(j);                                 ],
//     ct_json_numbers(j, "q", q, 2);                  "q": [0.5, 1]
//     ct_json_end(j);                             }
//
// Every function that starts a value takes its key first: a name in an object, NULL in an array
// and at the top. What always holds: the output is valid JSON in UTF-8 for any strings; numbers
// have the fewest digits that read back; values that are not finite are null. To write to
// memory, pass the stream of open_memstream.
#ifndef CT_REPORT_JSON_H
#define CT_REPORT_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

// Limit: asserted, of the documents that are written
enum { CT_JSON_DEPTH = 32 }; // nesting, asserted

struct ct_json {
    FILE *out;
    int depth;
    uint32_t is_object;  // bit d: the container at depth d + 1 is an object
    uint32_t has_member; // bit d: it is not empty
};

void ct_json_init(struct ct_json *j, FILE *out);

void ct_json_object(struct ct_json *j, const char *key);
void ct_json_array(struct ct_json *j, const char *key);
/// Close the innermost object or array; the outermost one ends the text with a new line.
void ct_json_end(struct ct_json *j);

void ct_json_number(struct ct_json *j, const char *key, double v);
void ct_json_integer(struct ct_json *j, const char *key, long long v);
void ct_json_bool(struct ct_json *j, const char *key, bool v);
/// text == NULL gives null. Bytes that are not UTF-8 become U+FFFD.
void ct_json_text(struct ct_json *j, const char *key, const char *text);
/// An array of n numbers on one line.
void ct_json_numbers(struct ct_json *j, const char *key, const double *v, size_t n);
/// The same of n texts.
void ct_json_texts(struct ct_json *j, const char *key, const char *const *text, size_t n);

#endif
