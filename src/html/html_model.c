// Section `model`: the file with the numbers of its lines, and diagnostics where they belong.
#include "html/components.h"
#include "html/html.h"

#include <string.h>

static const char *const severity_name[] = {"error", "warning", "note"};

static void put_message(struct ct_html *h, const struct ct_finding *f)
{
    fprintf(h->out, "<li class=\"message %s\"><b>%s:</b> ", severity_name[f->severity],
            severity_name[f->severity]);
    ct_html_put(h->out, f->text);
    if (f->code)
        fprintf(h->out, " [E%03d]", f->code);
    fputs("</li>\n", h->out);
}

static void put_line(struct ct_html *h, const struct ct_source *s, size_t i,
                     const struct ct_component_lines *at, size_t n)
{
    const char *names = "", *line = s->line[i];
    for (size_t k = 0; k < n; k++)
        if (at[k].first <= (int)i && (int)i <= at[k].last)
            names = *names ? ct_arena_printf(h->a, "%s %s", names, at[k].name) : at[k].name;
    fprintf(h->out, "<li class=\"code\" id=\"line-%zu\"", i + 1);
    ct_html_put_components(h->out, names);
    fputc('>', h->out);
    ct_html_put(h->out, line);
    fputs("</li>\n", h->out);
}

// A note belongs to the message before it.
static bool is_here(const struct ct_html *h, const struct ct_finding *f, size_t line)
{
    return f->mark.file && !f->mark.is_table && strcmp(f->mark.file, h->sys->model.file) == 0
        && f->mark.line == (int)line;
}

// Those without a line of this file: of the run, of tables.
static void put_others(struct ct_html *h, const struct ct_source *s)
{
    bool has_any = false;
    for (size_t k = 0; k < h->ctx->ndiagnostic; k++) {
        const struct ct_finding *f = &h->ctx->diagnostic[k];
        if (f->mark.line >= 0 && (size_t)f->mark.line < s->nline
            && is_here(h, f, (size_t)f->mark.line))
            continue;
        if (!has_any)
            fputs("<ul class=\"messages\">\n", h->out);
        has_any = true;
        put_message(h, f);
    }
    if (has_any)
        fputs("</ul>\n", h->out);
}

void ct_html_model(struct ct_html *h)
{
    const struct ct_source *s = h->source;
    size_t n = 0;
    ct_html_open_section(h, "model", "Model");
    if (!s->text) {
        fputs("<p>The text of the model is not at hand.</p>\n", h->out);
        ct_html_close_section(h);
        return;
    }
    const struct ct_component_lines *at
        = ct_components_find_lines(h->a, h->sys, s->line, s->nline, &n);
    fputs("<p class=\"note\">", h->out);
    ct_html_put_name(h->out, h->sys->model.file);
    fputs("</p>\n<ol class=\"source\">\n", h->out);
    for (size_t i = 0; i < s->nline; i++) {
        put_line(h, s, i, at, n);
        for (size_t k = 0; k < h->ctx->ndiagnostic; k++)
            if (is_here(h, &h->ctx->diagnostic[k], i))
                put_message(h, &h->ctx->diagnostic[k]);
    }
    fputs("</ol>\n", h->out);
    put_others(h, s);
    ct_html_close_section(h);
}
