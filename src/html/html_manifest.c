// Sections `left-out` and `manifest`: what the equations neglect; the sources of the page and
// the command that reproduces it.
#include "base/sha256.h"
#include "html/html.h"

#include <string.h>

void ct_html_left_out(struct ct_html *h)
{
    const struct ct_equations *e = &h->sys->equations;
    ct_html_open_section(h, "left-out", "Left out of the equations");
    if (!e->nleft_out)
        fputs("<p>Nothing.</p>\n", h->out);
    else
        fputs("<dl>\n", h->out);
    for (size_t i = 0; i < e->nleft_out; i++) {
        fputs("<dt>", h->out);
        ct_html_put(h->out, e->left_out[i].what);
        fputs("</dt>\n<dd>", h->out);
        ct_html_put(h->out, e->left_out[i].why);
        fputs("</dd>\n", h->out);
    }
    if (e->nleft_out)
        fputs("</dl>\n", h->out);
    ct_html_close_section(h);
}

// As a word of a shell: plain, or in single quotes.
static void put_shell_word(struct ct_html *h, const char *word)
{
    const char *const plain
        = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_./+:@%,=-";
    struct ct_arena *a = h->a;
    if (*word && strspn(word, plain) == strlen(word)) {
        ct_html_put(h->out, word);
        return;
    }
    char *text = CT_NEWN(a, char, 4 * strlen(word) + 3), *to = text;
    *to++ = '\'';
    for (const char *c = word; *c; c++) {
        if (*c == '\'') {
            memcpy(to, "'\\''", 4);
            to += 4;
        } else {
            *to++ = *c;
        }
    }
    *to = '\'';
    ct_html_put(h->out, text);
}

// NAME.html for the model NAME.yaml, as report names its file.
static const char *own_name(struct ct_html *h)
{
    const char *file = h->sys->model.file, *slash = strrchr(file, '/');
    const char *base = slash ? slash + 1 : file, *dot = strrchr(base, '.');
    const size_t n = dot && dot > base ? (size_t)(dot - base) : strlen(base);
    return ct_arena_printf(h->a, "%s%.*s.html", *base == '-' ? "./" : "", (int)n, base);
}

static void put_command(struct ct_html *h)
{
    const char *const *word = h->options->command;
    fputs("<code class=\"command\" id=\"command\">", h->out);
    for (size_t i = 0; i < h->options->ncommand; i++) {
        put_shell_word(h, word[i]);
        fputc(' ', h->out);
    }
    fputs("-o <span class=\"output\">", h->out);
    put_shell_word(h, own_name(h));
    fputs("</span></code>\n", h->out);
}

void ct_html_manifest(struct ct_html *h)
{
    const struct ct_source *s = h->source;
    char digest[2 * CT_SHA256_SIZE + 1];
    ct_html_open_section(h, "manifest", "Manifest");
    fprintf(h->out, "<dl>\n<dt>program</dt><dd>cotree %s</dd>\n<dt>model</dt><dd>",
            ct_version());
    ct_html_put_name(h->out, h->sys->model.file);
    fputs("</dd>\n", h->out);
    if (s->text) {
        ct_sha256_text((const unsigned char *)s->text, s->n, digest);
        fprintf(h->out,
                "<dt>SHA-256 of the model</dt><dd><code class=\"digest\">%s</code></dd>\n",
                digest);
    }
    fputs("</dl>\n", h->out);
    if (h->options->ncommand) {
        fputs("<p>This command makes the page again, byte for byte:</p>\n", h->out);
        put_command(h);
    }
    ct_html_close_section(h);
}
