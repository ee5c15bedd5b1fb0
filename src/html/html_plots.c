// Section `plots`: a figure for each unit with the names of its columns; curves are drawn by
// the script.
#include "draw/dimension.h"
#include "html/components.h"
#include "html/html.h"
#include "report/packed.h"

#include <string.h>

static bool is_same_unit(const char *a, const char *b)
{
    return a && b ? strcmp(a, b) == 0 : a == b;
}

static const char *unit_of(const struct ct_html *h, size_t column)
{
    return ct_result_unit(&h->sys->equations, column);
}

// Is it the first column with its unit?
static bool begins_panel(const struct ct_html *h, size_t column)
{
    for (size_t i = 0; i < column; i++)
        if (is_same_unit(unit_of(h, i), unit_of(h, column)))
            return false;
    return true;
}

static void put_unit(struct ct_html *h, const char *unit)
{
    fputs(" <span class=\"unit\">[", h->out);
    ct_html_put(h->out, !unit ? "SI" : *unit ? unit : "1");
    fputs("]</span>", h->out);
}

static void put_columns(struct ct_html *h, size_t first)
{
    const struct ct_recording *r = h->recording;
    fputs("<ul class=\"columns\">\n", h->out);
    for (size_t i = first; i < r->ncolumn; i++) {
        if (!is_same_unit(unit_of(h, first), unit_of(h, i)))
            continue;
        char text[32];
        snprintf(text, sizeof text, "%.5g", r->value[i]);
        fprintf(h->out, "<li data-column=\"%zu\" tabindex=\"0\"", i);
        ct_html_put_components(h->out, ct_components_of_result(h->a, h->sys, i));
        fputs("><span class=\"swatch\"></span>", h->out);
        ct_html_put_name(h->out, h->sys->equations.result[i].name);
        put_unit(h, unit_of(h, first));
        fprintf(h->out, " <span class=\"value\">%s</span></li>\n", text);
    }
    fputs("</ul>\n", h->out);
}

static void put_panel(struct ct_html *h, size_t first)
{
    fputs("<figure data-columns=\"", h->out);
    for (size_t i = first; i < h->recording->ncolumn; i++)
        if (is_same_unit(unit_of(h, first), unit_of(h, i)))
            fprintf(h->out, i > first ? " %zu" : "%zu", i);
    fputs("\">\n", h->out);
    put_columns(h, first);
    fputs("<div class=\"chart\"></div></figure>\n", h->out);
}

void ct_html_plots(struct ct_html *h)
{
    const struct ct_recording *r = h->recording;
    ct_html_open_section(h, "plots", "Outputs");
    if (!r->ncolumn) {
        fputs("<p>The model lists no outputs.</p>\n", h->out);
        ct_html_close_section(h);
        return;
    }
    fprintf(
        h->out,
        "<p class=\"note\">Values next to the names are those at <span class=\"clock\">t = 0 "
        "s</span>. "
        "Click in a plot to go to a time, drag to zoom, double-click for all of it.");
    if (r->stride > 1)
        fprintf(h->out, " One of %zu of the %zu samples is shown.", r->stride, r->nsample);
    fputs("</p>\n<div class=\"tools\" hidden><button type=\"button\" disabled>Whole "
          "time</button><button type=\"button\" title=\"Save what is shown as a "
          "table\">CSV</button></div>\n",
          h->out);
    for (size_t i = 0; i < r->ncolumn; i++)
        if (begins_panel(h, i))
            put_panel(h, i);
    ct_html_close_section(h);
}

// The name of the model as that of a file.
static const char *file_name(struct ct_html *h)
{
    char *name = ct_arena_strdup(h->a, h->sys->model.name);
    for (char *c = name; *c; c++)
        if (!strchr("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_", *c))
            *c = '_';
    return *name ? name : "outputs";
}

void ct_html_write_run(struct ct_html *h)
{
    const struct ct_recording *r = h->recording;
    struct ct_html_data d;
    ct_html_open_data(h, &d, "data-run");
    struct ct_json *j = &d.json;
    ct_json_text(j, "model", h->sys->model.name);
    ct_json_text(j, "file", file_name(h));
    ct_json_number(j, "start", r->time[0]);
    ct_json_number(j, "end", r->time[r->nrow - 1]);
    ct_json_integer(j, "thinned", (long long)r->stride);
    ct_json_array(j, "columns");
    for (size_t i = 0; i < r->ncolumn; i++) {
        ct_json_object(j, NULL);
        ct_json_text(j, "name", h->sys->equations.result[i].name);
        ct_json_text(j, "unit", unit_of(h, i));
        ct_json_text(j, "components", ct_components_of_result(h->a, h->sys, i));
        ct_json_end(j);
    }
    ct_json_end(j);
    ct_pack_write(j, h->a, "times", r->time, r->nrow, 1);
    ct_pack_write(j, h->a, "samples", r->value, r->nrow, r->ncolumn);
    ct_html_close_data(&d);
}
