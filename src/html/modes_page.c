// The page of `modes --report`, which animates the mode selected by the user.
//
//     row 0         positions at the configuration
//     row 2 i + 1   their derivatives along the real part of mode i
//     row 2 i + 2   along its imaginary part
//
// The script shows row 0 + a (real part cos phi - imaginary part sin phi). The motion is linear
// in the amplitude a, as a mode is.
#include "analysis/modes.h"
#include "draw/picture.h"
#include "html/html.h"
#include "report/mathml.h"
#include "report/outfile.h"
#include "report/packed.h"

#include <string.h>

struct modes_page {
    struct ct_ctx *ctx;
    struct ct_modes *modes;
    const char *path;
    struct ct_animation animation;
    double *rest; // values of the scene at the configuration
    double *row;  // (1 + 2 n) x ncolumn, a row after the other
    size_t nrow;
};

// ---- rows ----------------------------------------------------------------------------------

// Derivatives by central differences. Their error is step^2 times a third derivative, plus
// round-off over step.
static void differentiate(struct modes_page *p, const double *y0, const double *shape,
                          double *out)
{
    // Derived: near the cube root of eps; both errors are then about 1e-11.
    const double step = 1e-5;
    struct ct_evaluator *m = p->modes->at.l->m;
    const size_t n = p->animation.ncolumn;
    for (int sign = -1; sign <= 1; sign += 2) {
        ct_modes_displace(p->modes, y0, shape, sign * step);
        const double *row = ct_animation_keep(&p->animation, m, 0);
        for (size_t c = 0; c < n; c++)
            out[c] += sign * row[c] / (2 * step);
    }
}

static void find_rows(struct modes_page *p)
{
    struct ct_modes *s = p->modes;
    struct ct_linear *l = s->at.l;
    struct ct_arena *a = s->own.model;
    const size_t ny = l->m->nq + l->m->nu + 1, nvalue = p->animation.scene.nvalue,
                 n = p->animation.ncolumn;
    double *y0 = CT_NEWN(a, double, ny);
    memcpy(y0, l->y, ny * sizeof *y0);
    p->nrow = 1 + 2 * s->n;
    p->row = CT_NEWN(a, double, p->nrow *n + 1);
    p->rest = CT_NEWN(a, double, nvalue + 1);
    ct_modes_displace(s, y0, y0, 0);
    memcpy(p->row, ct_animation_keep(&p->animation, l->m, 0), n * sizeof *p->row);
    memcpy(p->rest, p->animation.values.program.out, nvalue * sizeof *p->rest);
    for (size_t i = 0; i < s->n; i++)
        for (size_t part = 0; part < 2; part++)
            differentiate(p, y0, s->mode[i].shape + part * (size_t)l->nu,
                          p->row + (1 + 2 * i + part) * n);
    memcpy(l->y, y0, ny * sizeof *y0);
}

// ---- the page ------------------------------------------------------------------------------

static void put_picture(struct ct_html *h, const struct modes_page *p)
{
    const struct ct_scene *scene = &p->animation.scene;
    struct ct_picture picture = {.scene = scene, .value = p->rest, .title = scene->model->name};
    ct_view_choose(&picture.view, scene, NULL);
    ct_html_open_section(h, "motion", "Motion");
    fputs("<div id=\"motion-panel\">\n", h->out);
    ct_picture_print(h->out, h->a, &picture);
    fputs("</div>\n", h->out);
    ct_html_close_section(h);
}

static void put_about(struct ct_html *h, const struct ct_modes *s)
{
    struct ct_text_stream *text = ct_html_open_text(h);
    ct_modes_print_summary(s, ct_html_text_stream(text));
    fputs("<dl>\n", h->out);
    for (const char *line = ct_html_close_text(text); *line;) {
        const size_t n = strcspn(line, "\n"), word = strcspn(line, " \n");
        if (word)
            fprintf(h->out, "<dt>%.*s</dt>", (int)word, line);
        fputs("<dd>", h->out);
        ct_html_text(h->out, line + word, n - word);
        fputs("</dd>\n", h->out);
        line += n + (line[n] == '\n');
    }
    fputs("</dl>\n", h->out);
}

static void put_table(struct ct_html *h, const struct ct_modes *s)
{
    ct_html_open_section(h, "modes", "Modes");
    fputs("<table>\n<tr><th>mode</th><th>frequency [Hz]</th><th>damping</th></tr>\n", h->out);
    for (size_t i = 0; i < s->n; i++) {
        const struct ct_mode_info m = ct_modes_info(s, i);
        fprintf(h->out,
                "<tr><td><label><input type=\"radio\" name=\"mode\" value=\"%zu\"%s> "
                "%zu</label></td><td>%.5g</td><td>%.3g</td></tr>\n",
                i, i == 0 ? " checked" : "", i + 1, m.frequency_hz, m.damping);
    }
    fputs("</table>\n", h->out);
    put_about(h, s);
    ct_html_close_section(h);
}

static void put_data(struct ct_html *h, const struct modes_page *p)
{
    struct ct_html_data d;
    ct_html_open_data(h, &d, "data-modes");
    ct_json_integer(&d.json, "count", (long long)p->modes->n);
    ct_animation_write_geometry(h->a, &d.json, &p->animation);
    ct_pack_write(&d.json, h->a, "rows", p->row, p->nrow, p->animation.ncolumn);
    ct_html_close_data(&d);
}

static bool write(void *task)
{
    struct modes_page *p = task;
    struct ct_modes *s = p->modes;
    struct ct_arena *a = s->own.model;
    struct ct_outfile file;
    if (!ct_html_is_built(p->ctx))
        return false;
    ct_animation_create(a, s->at.e->build, CT_ANIMATION_POSITIONS, &p->animation);
    ct_animation_compile(a, &p->animation, s->at.l->m);
    find_rows(p);
    ct_evaluator_remove_program(s->at.l->m, &p->animation.values.program);
    if (!ct_outfile_open(p->ctx, &file, p->path))
        return false;
    struct ct_html h = {.out = file.stream, .ctx = p->ctx, .a = a, .sys = s->system};
    ct_html_put_head(&h);
    fputs("<body>\n<header><h1>", h.out);
    ct_html_put_name(h.out, s->system->model.name);
    fputs("</h1></header>\n<main class=\"modes\">\n", h.out);
    put_picture(&h, p);
    put_table(&h, s);
    fputs("</main>\n", h.out);
    put_data(&h, p);
    ct_html_put_script(&h);
    return ct_outfile_close(p->ctx, &file);
}

bool ct_modes_report(struct ct_ctx *ctx, struct ct_modes *modes, const char *path)
{
    struct modes_page p = {.ctx = ctx, .modes = modes, .path = path};
    return ctx && modes && ct_enter(ctx, write, &p);
}
