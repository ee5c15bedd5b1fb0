// Functions of outputs over the runs of a study: "peak=max(abs(tip.deflection.y))".
#include "study/study.h"

#include <string.h>

static const struct ct_mark none = {0};

static const struct {
    const char *word;
    enum ct_take_kind kind;
} words[] = {{"max", CT_TAKE_MAX}, {"min", CT_TAKE_MIN},     {"mean", CT_TAKE_MEAN},
             {"rms", CT_TAKE_RMS}, {"final", CT_TAKE_FINAL}, {"time", CT_TAKE_TIME}};

const char *ct_study_take_name(enum ct_take_kind kind)
{
    for (size_t i = 0; i < COUNT(words); i++)
        if (words[i].kind == kind)
            return words[i].word;
    return "";
}

static bool wrong(struct ct_study *s, const char *text, const char *why)
{
    return ct_error(&s->own, none, CT_E_USAGE,
                    "--take '%s': %s; wanted is NAME=FUNCTION(EXPRESSION) with max, min, mean, "
                    "rms, final or time, as peak=max(abs(tip.position.y))",
                    text, why);
}

// Does the bracket that opens at text[0] close at the end of the text?
static bool is_one_bracket(const char *text)
{
    int depth = 0;
    for (; *text; text++) {
        depth += (*text == '(') - (*text == ')');
        if (depth == 0)
            return !text[1];
    }
    return false;
}

static bool read_take(struct ct_study *s, const char *text, size_t i, const char **output)
{
    struct ct_arena *a = s->own.model;
    const char *equals = strchr(text, '='), *open = equals ? strchr(equals, '(') : NULL;
    if (!equals || equals == text)
        return wrong(s, text, "there is no NAME=");
    if (!open || !is_one_bracket(open))
        return wrong(s, text, "it is no FUNCTION(EXPRESSION)");
    const char *name = ct_arena_strndup(a, text, (size_t)(equals - text));
    const char *word = ct_arena_strndup(a, equals + 1, (size_t)(open - equals - 1));
    size_t k = 0;
    while (k < COUNT(words) && strcmp(words[k].word, word) != 0)
        k++;
    if (k == COUNT(words))
        return wrong(s, text, ct_arena_printf(a, "there is no function '%s'", word));
    if (strcmp(name, "run") == 0 || strcmp(name, "status") == 0)
        return wrong(s, text, ct_arena_printf(a, "'%s' is a column of every sweep", name));
    for (size_t j = 0; j < s->plan.naxis; j++)
        if (strcmp(name, s->plan.axis[j].name) == 0)
            return wrong(s, text, ct_arena_printf(a, "'%s' is what varies", name));
    s->take[i] = words[k].kind;
    *output = ct_arena_printf(a, "%s=%.*s", name, (int)strlen(open) - 2, open + 1);
    return true;
}

bool ct_study_read_takes(struct ct_study *s, const char *const *text, size_t n)
{
    struct ct_system_options *o = &s->system_options;
    const char **output = CT_NEWN(s->own.model, const char *, o->noutput + n + 1);
    for (size_t i = 0; i < o->noutput; i++)
        output[i] = o->output[i];
    s->take = CT_NEWN(s->own.model, enum ct_take_kind, n + 1);
    s->ntake = n;
    bool ok = true;
    for (size_t i = 0; i < n; i++)
        ok &= read_take(s, text[i], i, &output[o->noutput + i]);
    o->output = output;
    o->noutput += n;
    return ok;
}
