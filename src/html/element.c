// Elements of the page; see html.h.
#include "html/html.h"

#include "base/guard.h"
#include "report/mathml.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

// ---- text ----------------------------------------------------------------------------------

void ct_html_put(FILE *out, const char *text)
{
    ct_html_text(out, text, SIZE_MAX);
}

void ct_html_put_name(FILE *out, const char *text)
{
    fputs("<bdi>", out);
    ct_html_put(out, text);
    fputs("</bdi>", out);
}

void ct_html_put_components(FILE *out, const char *names)
{
    if (!names || !*names)
        return;
    fputs(" data-component=\"", out);
    ct_html_put(out, names);
    fputc('"', out);
}

// Writes 1.2e-08 as 1.2 times a power of ten.
void ct_html_put_number(FILE *out, double v)
{
    char text[40];
    if (!isfinite(v)) {
        fputs("unknown", out);
        return;
    }
    snprintf(text, sizeof text, "%.3g", fabs(v));
    char *e = strchr(text, 'e');
    if (v < 0)
        fputs("\xe2\x88\x92", out);
    if (!e) {
        fputs(text, out);
        return;
    }
    const int exponent = atoi(e + 1);
    *e = 0;
    fprintf(out,
            "%s\xc2\xb7"
            "10<sup>%s%d</sup>",
            text, exponent < 0 ? "\xe2\x88\x92" : "", abs(exponent));
}

void ct_html_put_equation(FILE *out, const char *left, const char *right)
{
    const struct ct_mathml_term term[] = {{.latex = left}, {.latex = right}};
    ct_mathml_equation(out, &(struct ct_mathml_equation){.left = {&term[0], 1},
                                                         .right = {&term[1], right ? 1 : 0}});
}

// ---- sections ------------------------------------------------------------------------------

void ct_html_open_section(struct ct_html *h, const char *id, const char *title)
{
    fprintf(h->out,
            "<section id=\"%s\" aria-labelledby=\"%s-title\">\n<h2 id=\"%s-title\">%s</h2>\n",
            id, id, id, title);
}

void ct_html_close_section(struct ct_html *h)
{
    fputs("</section>\n", h->out);
}

// ---- data ----------------------------------------------------------------------------------

// A stream into memory that lives as long as an arena.
struct ct_text_stream {
    FILE *out;
    char *text;
    size_t n;
};

static void end_stream(void *stream)
{
    struct ct_text_stream *s = stream;
    if (s->out)
        fclose(s->out);
    free(s->text);
}

struct ct_text_stream *ct_html_open_text(struct ct_html *h)
{
    struct ct_text_stream *s = CT_NEW(h->a, struct ct_text_stream);
    ct_arena_on_destroy(h->a, end_stream, s);
    s->out = open_memstream(&s->text, &s->n);
    if (!s->out)
        ct_guard_raise();
    return s;
}

FILE *ct_html_text_stream(struct ct_text_stream *s)
{
    return s->out;
}

const char *ct_html_close_text(struct ct_text_stream *s)
{
    const bool is_whole = !ferror(s->out);
    const bool is_closed = fclose(s->out) == 0;
    s->out = NULL;
    if (!is_whole || !is_closed)
        ct_guard_raise();
    return s->text;
}

void ct_html_open_data(struct ct_html *h, struct ct_html_data *d, const char *id)
{
    *d = (struct ct_html_data){.h = h, .id = id, .stream = ct_html_open_text(h)};
    ct_json_init(&d->json, d->stream->out);
    ct_json_object(&d->json, NULL);
}

// In JSON `<` occurs in strings only. It is escaped, so that no string can end the element or
// begin a comment.
void ct_html_close_data(struct ct_html_data *d)
{
    FILE *out = d->h->out;
    ct_json_end(&d->json);
    fprintf(out, "<script type=\"application/json\" id=\"%s\">", d->id);
    for (const char *at = ct_html_close_text(d->stream); *at;) {
        const size_t n = strcspn(at, "<");
        fwrite(at, 1, n, out);
        if (at[n])
            fputs("\\u003c", out);
        at += n + (at[n] != 0);
    }
    fputs("</script>\n", out);
}
