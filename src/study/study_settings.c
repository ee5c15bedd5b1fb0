// The settings that the rows of a study depend on, besides the varied values: a text with one
// line for each setting.
//
//     model      8f3a5c0e91d2b764, 1840 bytes
//     tolerance  1e-08
//
// Files that are read are represented by a checksum: 64-bit FNV-1a (Fowler, Noll and Vo),
// enough to detect a change. Threads, lanes and the back end are not included, because they
// change round-off errors at most.
#include "study/study.h"

#include "io/text.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

// Limit: of a file. Layout: of the names of settings
enum { MOST_TEXT = 64 << 20, WIDTH = 12 };

// Definition: of the FNV-1a hash of 64 bits
static const uint64_t offset_basis = 0xcbf29ce484222325, prime = 0x100000001b3;

static uint64_t checksum(uint64_t sum, const void *data, size_t n)
{
    const unsigned char *byte = data;
    for (size_t i = 0; i < n; i++)
        sum = (sum ^ byte[i]) * prime;
    return sum;
}

// ---- the text ------------------------------------------------------------------------------

struct settings {
    struct ct_arena *a;
    const char *text;
};

// Adds a line `name  value`; nothing if the format gives an empty value.
static void add(struct settings *w, const char *name, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

static void add(struct settings *w, const char *name, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    const char *value = ct_arena_vprintf(w->a, fmt, ap);
    va_end(ap);
    if (*value)
        w->text = ct_arena_printf(w->a, "%s%-*s %s\n", w->text, WIDTH, name, value);
}

// Formats a number with the fewest digits that identify it.
static const char *shortest(struct ct_arena *a, double value)
{
    const char *text = "";
    for (int digits = 1; digits <= 17; digits++) {
        text = ct_arena_printf(a, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    return text;
}

static void add_number(struct settings *w, const char *name, double value)
{
    if (value != 0) // nonzero: the option was given
        add(w, name, "%s", shortest(w->a, value));
}

static void add_tables(struct settings *w, const struct ct_exs *x)
{
    uint64_t sum = offset_basis;
    for (size_t i = 0; i < x->ntable; i++) {
        const struct ct_table *t = &x->table[i];
        sum = checksum(sum, t->x, t->n * sizeof *t->x);
        sum = checksum(sum, t->y, t->n * sizeof *t->y);
    }
    if (x->ntable)
        add(w, "tables", "%016" PRIx64, sum);
}

// Adds the name of a choice of trees, or the checksum of a tree file.
static void add_tree(struct settings *w, const char *tree)
{
    char *text;
    size_t n;
    if (!tree)
        return;
    if (ct_text_read(w->a, tree, MOST_TEXT, &text, &n) == CT_TEXT_OK)
        add(w, "tree", "%016" PRIx64 ", %zu bytes", checksum(offset_basis, text, n), n);
    else
        add(w, "tree", "%s", tree);
}

static void add_system(struct settings *w, const struct ct_system_options *o)
{
    for (size_t i = 0; i < o->nset; i++)
        add(w, "set", "%s", o->set[i]);
    for (size_t i = 0; i < o->noutput; i++)
        add(w, "output", "%s", o->output[i]);
    add_tree(w, o->tree);
    add(w, "keep all", "%s", o->keep_all ? "yes" : "");
    add_number(w, "elements", (double)o->beam_elements);
    add(w, "beams", "%s", o->beam_formulation ? o->beam_formulation : "");
}

static void add_run(struct settings *w, const struct ct_sim_options *o)
{
    add(w, "method", "%s", o->method ? o->method : "");
    add_number(w, "tolerance", o->tolerance);
    add_number(w, "absolute", o->absolute);
    add_number(w, "step", o->step);
    add_number(w, "until", o->until);
    add_number(w, "samples", (double)o->samples);
}

static void add_plan(struct settings *w, const struct ct_plan *p)
{
    for (size_t i = 0; i < p->naxis; i++) {
        const struct ct_axis *axis = &p->axis[i];
        if (axis->kind == CT_AXIS_LIST) {
            add(w, "member", "%s=%016" PRIx64, axis->name,
                checksum(offset_basis, axis->value, (size_t)axis->n * sizeof *axis->value));
            continue;
        }
        const char *kind = axis->kind == CT_AXIS_NORMAL ? "normal:" : "";
        const char *count = p->is_sampled ? "" : ct_arena_printf(w->a, ":%ld", axis->n);
        add(w, "vary", "%s=%s%s:%s%s", axis->name, kind, shortest(w->a, axis->from),
            shortest(w->a, axis->to), count);
    }
    if (p->is_sampled)
        add(w, "sample", "%ld, seed %" PRIu64, p->nall, p->seed);
    if (p->nshard)
        add(w, "shard", "%ld of %ld, of %ld members", p->shard, p->nshard, p->nall);
}

const char *ct_study_settings(struct ct_study *s)
{
    struct settings w = {s->own.model, ""};
    add(&w, "program", "cotree %s", ct_version());
    add(&w, "model", "%016" PRIx64 ", %zu bytes", checksum(offset_basis, s->text, s->ntext),
        s->ntext);
    add_tables(&w, s->system->model.x);
    add_system(&w, &s->system_options);
    add_run(&w, &s->run);
    add_plan(&w, &s->plan);
    for (size_t i = 0; i < s->ntake; i++)
        add(&w, "take", "%s", ct_study_take_name(s->take[i]));
    return w.text;
}

// ---- comparison ----------------------------------------------------------------------------

// Returns the line at *text without its end; *text moves to the next line.
static const char *take_line(struct ct_arena *a, const char **text)
{
    const char *line = *text;
    const size_t n = strcspn(line, "\n");
    *text = line + n + (line[n] == '\n');
    return ct_arena_strndup(a, line, n);
}

// Returns the name on a line, up to the blanks after it.
static const char *name_of(struct ct_arena *a, const char *line)
{
    size_t n = strlen(line) < WIDTH ? strlen(line) : WIDTH;
    while (n && line[n - 1] == ' ')
        n--;
    return ct_arena_strndup(a, line, n);
}

static const char *value_of(const char *line)
{
    return strlen(line) > WIDTH ? line + WIDTH + 1 : "";
}

bool ct_study_find_difference(struct ct_arena *a, const char *before, const char *now,
                              struct ct_setting_difference *out)
{
    while (*before || *now) {
        const char *rest = before;
        const char *old = take_line(a, &before), *new = take_line(a, &now);
        if (strcmp(old, new) == 0)
            continue;
        const char *old_name = name_of(a, old), *new_name = name_of(a, new);
        *out = (struct ct_setting_difference){new_name, value_of(old), value_of(new)};
        if (strcmp(old_name, new_name) == 0)
            return true;
        // a line that only one of the texts has
        const char *name = ct_arena_printf(a, "\n%-*s ", WIDTH, new_name);
        if (*new && !strstr(rest, name))
            out->before = NULL;
        else
            *out = (struct ct_setting_difference){old_name, value_of(old), NULL};
        return true;
    }
    return false;
}

bool ct_setting_is_file(const char *name)
{
    return strcmp(name, "model") == 0 || strcmp(name, "tables") == 0
        || strcmp(name, "member") == 0;
}

const char *ct_study_compare_settings(struct ct_arena *a, const char *before, const char *now)
{
    struct ct_setting_difference d;
    if (!ct_study_find_difference(a, before, now, &d))
        return NULL;
    if (!d.before)
        return ct_arena_printf(a, "'%s' is %s now and was not given", d.name, d.now);
    if (!d.now)
        return ct_arena_printf(a, "'%s' was %s and is not given now", d.name, d.before);
    if (strcmp(d.name, "member") == 0)
        return "the members have changed since";
    return ct_setting_is_file(d.name)
             ? ct_arena_printf(a, "the %s has changed since", d.name)
             : ct_arena_printf(a, "'%s' was %s and is %s now", d.name, d.before, d.now);
}
