// Section `summary`: properties of the system, and indicators with links to the sections with
// details.
#include "html/html.h"

#include "formulate/beam/flexible_body.h"
#include "sim/summary.h"
#include "solve/singular/singular.h"

#include <math.h>
#include <string.h>

enum light { GOOD, FAIR, POOR };

static void put_count(struct ct_html *h, long n, const char *one, const char *many)
{
    fprintf(h->out, "%ld %s", n, n == 1 ? one : many);
}

// "A planar mechanism of 3 bodies and 4 joints with 1 degree of freedom."
static void put_sentence(struct ct_html *h)
{
    const struct ct_model *m = &h->sys->model;
    const struct ct_equations *e = &h->sys->equations;
    long nbeam = 0;
    for (size_t i = 1; i < m->nbody; i++)
        nbeam += m->body[i].beam != NULL;
    fprintf(h->out, "<p class=\"lead\">%s of ",
            e->is_planar ? "A planar system" : "A spatial system");
    put_count(h, (long)m->nbody - 1, "body", "bodies");
    if (nbeam)
        fprintf(h->out, " (%ld of them %s)", nbeam, nbeam == 1 ? "a beam" : "beams");
    fputs(m->nforce ? ", " : " and ", h->out);
    put_count(h, (long)m->njoint, "joint", "joints");
    if (m->nforce) {
        fputs(" and ", h->out);
        put_count(h, (long)m->nforce, "force element", "force elements");
    }
    fprintf(h->out, " with %ld %s of freedom%s.</p>\n", ct_sim_freedoms(h->sim),
            ct_sim_freedoms(h->sim) == 1 ? "degree" : "degrees",
            e->nrow == 0 ? "; its joints close no loop" : "");
}

static void put_fact(struct ct_html *h, const char *what, long n)
{
    fprintf(h->out, "<div><dt>%s</dt><dd>%ld</dd></div>\n", what, n);
}

static void open_light(struct ct_html *h, enum light light, const char *section,
                       const char *title)
{
    static const char *const kind[] = {"good", "fair", "poor"};
    static const char *const sign[] = {"\xe2\x9c\x93", "!", "\xe2\x9c\x97"};
    fprintf(h->out, "<li><a class=\"%s\" href=\"#%s\"><b>%s %s</b> ", kind[light], section,
            sign[light], title);
}

static void close_light(struct ct_html *h)
{
    fputs("</a></li>\n", h->out);
}

// Why a run stopped before its end: the last error.
static void put_stop(struct ct_html *h)
{
    const struct ct_finding *last = NULL;
    for (size_t k = 0; k < h->ctx->ndiagnostic; k++)
        if (h->ctx->diagnostic[k].severity == CT_SEVERITY_ERROR)
            last = &h->ctx->diagnostic[k];
    fputs("<p class=\"message poor\" role=\"alert\"><b>The run stopped before its end.</b> ",
          h->out);
    if (last)
        ct_html_put_name(h->out, last->text);
    fputs("</p>\n", h->out);
}

// Compares the estimated error with the requested one and with ten times that, as simulate
// does.
static void put_error_light(struct ct_html *h)
{
    const struct ct_sim *sim = h->sim;
    const struct ct_estimate *e = &sim->estimate;
    const double tolerance = sim->tolerance;
    const bool is_known
        = e->output && isfinite(e->worst) && e->which < h->sys->equations.nresult;
    open_light(h,
               !e->output || sim->run_options.step > 0   ? is_known ? GOOD : FAIR
               : !is_known || e->worst <= 10 * tolerance ? GOOD
                                                         : POOR,
               "accuracy", "error");
    if (is_known) {
        ct_html_put_number(h->out, e->worst);
        fputs(" in ", h->out);
        ct_html_put_name(h->out, h->sys->equations.result[e->which].name);
        if (!(sim->run_options.step > 0)) {
            fputs("; tolerance: ", h->out);
            ct_html_put_number(h->out, tolerance);
        }
    } else {
        fputs(e->output ? "that of round-off" : "not estimated", h->out);
    }
    close_light(h);
}

static void put_energy_light(struct ct_html *h)
{
    const double drift = h->sim->report.energy_drift;
    const double wanted = fmax(h->sim->tolerance, h->sim->least_rtol);
    open_light(h, drift <= 10 * wanted && !h->stopped ? GOOD : FAIR, "accuracy", "energy");
    fputs(h->stopped ? "before the stop " : "", h->out);
    fputs("the balance changes by ", h->out);
    ct_html_put_number(h->out, drift);
    fputs(" of the largest energy", h->out);
    close_light(h);
}

static void put_loops_light(struct ct_html *h)
{
    const struct ct_equations *e = &h->sys->equations;
    const long redundant = ct_sim_redundant(h->sim);
    const struct ct_rank_monitor *w = h->sim->report.singular;
    open_light(h, redundant || (w && w->npassed) ? FAIR : GOOD, "loops", "loops");
    if (!e->nrow)
        fputs("none: an open chain", h->out);
    else if (redundant)
        fprintf(h->out, "%ld of %zu constraint rows redundant", redundant, e->nrow);
    else
        fprintf(h->out, "%zu constraint %s, all independent", e->nrow,
                e->nrow == 1 ? "row" : "rows");
    if (w && w->npassed)
        fprintf(h->out, "; %ld singular %s passed", w->npassed,
                w->npassed == 1 ? "configuration" : "configurations");
    close_light(h);
}

static void put_beams_light(struct ct_html *h)
{
    const struct ct_equations *e = &h->sys->equations;
    const struct ct_run_report *r = &h->sim->report;
    const char *left = NULL;
    for (size_t i = 0; i < e->nvalidity && r->validity; i++)
        if (!left && r->validity[i].left_at >= 0)
            left = e->validity[i].beam;
    for (size_t i = 0; i < e->nbent_beam && r->slopes; i++)
        if (!left && r->slopes[i].passed_at >= 0)
            left = e->bent_beam[i].beam;
    open_light(h, left ? POOR : GOOD, "accuracy", "beams");
    if (!e->build->nflexible)
        fputs("none in this system", h->out);
    else if (left) {
        ct_html_put_name(h->out, left);
        fputs(" bends more than its model holds for", h->out);
    } else
        fputs("within what their models hold for", h->out);
    close_light(h);
}

void ct_html_summary(struct ct_html *h)
{
    const struct ct_equations *e = &h->sys->equations;
    ct_html_open_section(h, "summary", "Summary");
    put_sentence(h);
    if (h->stopped)
        put_stop(h);
    if (h->sys->model.description) {
        fputs("<p>", h->out);
        ct_html_put_name(h->out, h->sys->model.description);
        fputs("</p>\n", h->out);
    }
    fputs("<dl class=\"facts\">\n", h->out);
    put_fact(h, "degrees of freedom", ct_sim_freedoms(h->sim));
    put_fact(h, "coordinates", (long)e->nq);
    put_fact(h, "constraints", (long)e->nrow);
    put_fact(h, "redundant", ct_sim_redundant(h->sim));
    put_fact(h, "vertices", e->graph->nnode);
    put_fact(h, "edges", e->graph->nedge);
    fputs("</dl>\n<ul class=\"checks\">\n", h->out);
    put_error_light(h);
    put_energy_light(h);
    put_loops_light(h);
    put_beams_light(h);
    fputs("</ul>\n", h->out);
    ct_html_close_section(h);
}
