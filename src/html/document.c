// Writes the file of the report; see html.h.
#include "html/html.h"

#include "base/sha256.h"
#include "html/web.h"
#include "io/text.h"
#include "report/mathml.h"
#include "report/outfile.h"
#include "report/packed.h"

#include <stdlib.h>
#include <string.h>

struct report {
    struct ct_ctx *ctx, own;
    struct ct_system *given;
    struct ct_system *sys;   // for printing: with mass matrix and forces
    struct ct_system *moved; // for the run
    const struct ct_report_options *options;
    struct ct_sim *sim;
    struct ct_terms_recording terms;
    struct ct_recording recording;
    struct ct_source source;
    bool stopped; // the run ended before its end time
};

// ---- what the page is made from ------------------------------------------------------------

static void split_lines(struct ct_arena *a, struct ct_source *s)
{
    size_t cap = 0;
    for (const char *at = s->text; *at;) {
        const size_t n = strcspn(at, "\n");
        CT_PUSH(a, s->line, s->nline, cap,
                ct_arena_strndup(a, at, n - (n && at[n - 1] == '\r')));
        at += n + (at[n] == '\n');
    }
}

static void read_source(struct ct_arena *a, const struct ct_system *sys, struct ct_source *s)
{
    enum { MOST = 1 << 26 }; // Limit: more than a model may have
    char *text;
    if (sys->text) {
        s->text = sys->text;
        s->n = strlen(sys->text);
    } else if (ct_text_read_regular(a, sys->model.file, MOST, &text, &s->n) == CT_TEXT_OK) {
        s->text = text;
    }
    if (s->text)
        split_lines(a, s);
}

// Makes a copy of the system, so that further derivations do not change the caller's.
static struct ct_system *copy(struct report *r)
{
    struct ct_system *s = ct_system_borrow(&r->own, r->given);
    s->own.model = r->own.model;
    s->own.scratch = r->own.scratch;
    return s;
}

static bool prepare(void *task)
{
    struct report *r = task;
    if (!ct_html_is_built(&r->own))
        return false;
    r->sys = copy(r);
    ct_formulate_dynamics(&r->sys->equations);
    ct_terms_create(&r->terms, r->own.model, r->sys);
    r->moved = copy(r);
    ct_recording_create(&r->recording, r->moved, &r->terms);
    read_source(r->own.model, r->given, &r->source);
    return true;
}

// ---- the head ------------------------------------------------------------------------------

static void put_hash(FILE *out, struct ct_arena *a, const unsigned char *bytes, size_t n)
{
    unsigned char digest[CT_SHA256_SIZE];
    ct_sha256(bytes, n, digest);
    fprintf(out, "'sha256-%s'", ct_base64(a, digest, sizeof digest));
}

void ct_html_put_head(struct ct_html *h)
{
    FILE *out = h->out;
    const char *style = ct_arena_printf(h->a, "%s%s%.*s", ct_page_style, ct_mathml_style,
                                        (int)ct_web_style_size, (const char *)ct_web_style);
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
          "script-src ",
          out);
    put_hash(out, h->a, ct_web_script, ct_web_script_size);
    fputs("; style-src ", out);
    put_hash(out, h->a, (const unsigned char *)style, strlen(style));
    fputs("; base-uri 'none'; form-action 'none'\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
          "<meta name=\"generator\" content=\"cotree\">\n<title>",
          out);
    ct_html_put(out, h->sys->model.name);
    fputs("</title>\n<style>", out);
    fputs(style, out);
    fputs("</style>\n</head>\n", out);
}

void ct_html_put_script(struct ct_html *h)
{
    fputs("<script>", h->out);
    fwrite(ct_web_script, 1, ct_web_script_size, h->out);
    fputs("</script>\n</body>\n</html>\n", h->out);
}

bool ct_html_is_built(struct ct_ctx *ctx)
{
    return ct_web_script_size
        || ct_error(ctx, (struct ct_mark){0}, CT_E_NO_REPORT,
                    "this cotree was built without the report; see -Dreport in README.md");
}

// ---- sections ------------------------------------------------------------------------------

static const struct {
    const char *id, *name; // in the list of contents
    void (*put)(struct ct_html *h);
} sections[] = {
    {"summary", "Summary", ct_html_summary},
    {"motion", "Motion", ct_html_motion},
    {"model", "Model", ct_html_model},
    {"graph", "Graph", ct_html_graph},
    {"trees", "Trees", ct_html_trees},
    {"derivation", "Derivation", ct_html_derivation},
    {"equations", "Equations", ct_html_equations},
    {"loops", "Loops", ct_html_loops},
    {"plots", "Outputs", ct_html_plots},
    {"accuracy", "Accuracy", ct_html_accuracy},
    {"left-out", "Left out", ct_html_left_out},
    {"manifest", "Manifest", ct_html_manifest},
};

static void put_body(struct ct_html *h)
{
    FILE *out = h->out;
    fputs("<body>\n<header><h1>", out);
    ct_html_put_name(out, h->sys->model.name);
    fputs("</h1></header>\n<nav aria-label=\"sections\">", out);
    for (size_t i = 0; i < COUNT(sections); i++)
        fprintf(out, "<a href=\"#%s\">%s</a>\n", sections[i].id, sections[i].name);
    fputs("</nav>\n<main>\n", out);
    for (size_t i = 0; i < COUNT(sections); i++)
        sections[i].put(h);
    fputs("</main>\n"
          "<div id=\"transport\" class=\"controls\" role=\"group\" aria-label=\"time\" hidden>"
          "<button type=\"button\">Play</button>"
          "<input type=\"range\" aria-label=\"time\"><output></output>"
          "<select aria-label=\"speed\"></select></div>\n",
          out);
    ct_html_write_run(h);
    ct_html_put_script(h);
}

static bool write(void *task)
{
    struct report *r = task;
    struct ct_outfile file;
    if (!ct_outfile_open(r->ctx, &file, r->options->path))
        return false;
    struct ct_html h = {.out = file.stream,
                        .ctx = r->ctx,
                        .a = r->own.scratch,
                        .sys = r->sys,
                        .sim = r->sim,
                        .recording = &r->recording,
                        .terms = &r->terms,
                        .source = &r->source,
                        .stopped = r->stopped,
                        .options = r->options};
    ct_html_put_head(&h);
    put_body(&h);
    return ct_outfile_close(r->ctx, &file);
}

// ---- the whole -----------------------------------------------------------------------------

static bool make(struct report *r)
{
    struct ct_sim_options run = r->options->run;
    run.verify = true; // the page shows the estimate of the error
    r->sim = ct_sim_create(r->ctx, r->moved, &run);
    if (!r->sim)
        return false;
    const bool has_run = ct_recording_run(r->ctx, &r->recording, r->sim, r->options->bar);
    r->stopped = !has_run;
    return (has_run || r->recording.nrow > 0) && ct_enter(r->ctx, write, r) && has_run;
}

bool ct_system_report(struct ct_ctx *ctx, struct ct_system *sys,
                      const struct ct_report_options *options)
{
    struct ct_report_options o;
    ct_options_take(&o, options, sizeof o);
    struct report r = {.ctx = ctx, .given = sys, .options = &o};
    bool ok = ctx && sys && ct_own_enter(ctx, &r.own, prepare, &r);
    ok = ok && make(&r);
    ct_sim_destroy(r.sim);
    ct_own_finish(&r.own);
    return ok;
}
