// Text of exported C under construction, with substitution in templates.
#ifndef CT_CODEGEN_EXPORT_TEXT_H
#define CT_CODEGEN_EXPORT_TEXT_H

#include "base/ctx.h"

struct ct_export_text {
    struct ct_arena *arena;
    const char *name; // of the model, a C identifier
    char *s;
    size_t n, cap;
};

void ct_export_put(struct ct_export_text *t, const char *s);
void ct_export_putf(struct ct_export_text *t, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));
/// Append s, with the name in place of each @ and the name in capitals in place of each $.
void ct_export_put_named(struct ct_export_text *t, const char *s);
/// The same for the lines of a template (templates.py); the last is NULL.
void ct_export_put_lines(struct ct_export_text *t, const char *const *line);
/// Append {1, 2, 3}: n numbers, at least one.
void ct_export_put_numbers(struct ct_export_text *t, const double *v, size_t n);
void ct_export_put_integers(struct ct_export_text *t, const int *v, size_t n);
/// The whole, which lives in the arena.
const char *ct_export_finish(struct ct_export_text *t);

#endif
