// Section `accuracy`: the wanted and the estimated error, residuals of balances, and the work
// of the run. It contains nothing that depends on the computer: the same input gives the same
// page.
#include "html/html.h"

#include "accuracy/accuracy.h"
#include "sim/summary.h"
#include "solve/singular/singular.h"

#include <math.h>

static void put_row(struct ct_html *h, const char *what, double v, const char *unit)
{
    fprintf(h->out, "<tr><td class=\"words\">%s</td><td class=\"number\">", what);
    ct_html_put_number(h->out, v);
    fprintf(h->out, "</td><td>%s</td></tr>\n", unit);
}

static void put_count(struct ct_html *h, const char *what, long n)
{
    fprintf(h->out,
            "<tr><td class=\"words\">%s</td><td class=\"number\">%ld</td><td></td></tr>\n",
            what, n);
}

static void put_ledger(struct ct_html *h)
{
    const struct ct_sim *sim = h->sim;
    const struct ct_run_report *r = &sim->report;
    fputs("<div class=\"wide\"><table>\n", h->out);
    if (!(sim->run_options.step > 0))
        put_row(h, "tolerance, relative", sim->tolerance, "");
    if (sim->estimate.output)
        put_row(h, "error estimated, of the worst output", sim->estimate.worst, "");
    put_row(h, "change of the energy balance, of the largest energy", r->energy_drift, "");
    put_row(h, "largest residual of the constraints", r->position_constraint, "m, rad");
    put_row(h, "largest residual of their rates", r->velocity_constraint, "m/s, rad/s");
    fputs("</table></div>\n", h->out);
}

static void put_estimates(struct ct_html *h)
{
    const struct ct_equations *e = &h->sys->equations;
    const struct ct_estimate *s = &h->sim->estimate;
    if (!s->output) {
        if (s->how)
            fputs("<p>The second run, which would tell the error, failed.</p>\n", h->out);
        return;
    }
    fputs(
        "<details class=\"wide\"><summary>Errors of all outputs, estimated from a second run (",
        h->out);
    ct_html_put(h->out, s->how);
    fputs(
        ")</summary>\n<table><thead><tr><th>output</th><th>relative</th><th>absolute</th></tr>"
        "</thead>\n<tbody>\n",
        h->out);
    for (size_t i = 0; i < e->nresult; i++) {
        fputs("<tr><td>", h->out);
        ct_html_put_name(h->out, e->result[i].name);
        fputs("</td><td>", h->out);
        if (isnan(s->output[i].relative))
            fputs("zero but for round-off", h->out);
        else
            ct_html_put_number(h->out, s->output[i].relative);
        fputs("</td><td>", h->out);
        ct_html_put_number(h->out, s->output[i].absolute);
        fputs("</td></tr>\n", h->out);
    }
    fputs("</tbody></table></details>\n", h->out);
}

static void put_work(struct ct_html *h)
{
    const struct ct_sim *sim = h->sim;
    const struct ct_run_report *r = &sim->report;
    const struct ct_method *m = r->method ? r->method : sim->run_options.method;
    fprintf(h->out, "<h3>Work</h3>\n<p>Method %s (", m->name);
    ct_html_put(h->out, sim->method_why);
    fputs(").</p>\n<div class=\"wide\"><table>\n", h->out);
    put_count(h, "accepted steps", r->stats.steps);
    put_count(h, "steps rejected for their error", r->stats.inaccurate_steps);
    put_count(h, "steps rejected for other reasons",
              r->stats.rejected_steps - r->stats.inaccurate_steps);
    put_count(h, "evaluations of the accelerations", r->stats.evaluations);
    if (r->stats.jacobians)
        put_count(h, "Jacobians", r->stats.jacobians);
    put_count(h, "events", r->stats.events);
    put_count(h, "operations of one evaluation", ct_sim_operations(sim));
    fputs("</table></div>\n", h->out);
    if (sim->run_options.step > 0)
        fprintf(h->out,
                "<p>Steps have the fixed size %g s; their error is not controlled.</p>\n",
                sim->run_options.step);
    else
        fprintf(h->out, "<p>%s</p>\n",
                r->stats.inaccurate_steps ? "Steps were limited by the tolerance."
                                          : "No step was rejected because of its error.");
}

static void put_work_precision(struct ct_html *h)
{
    if (!h->options->accuracy)
        return;
    fputs("<h3>Work and precision</h3>\n<figure class=\"work-precision\">\n", h->out);
    ct_accuracy_print_plot(h->out, h->options->accuracy);
    fputs("<figcaption>Error against time for several methods and tolerances, as <code>cotree "
          "accuracy</code> finds them.</figcaption></figure>\n",
          h->out);
}

void ct_html_accuracy(struct ct_html *h)
{
    ct_html_open_section(h, "accuracy", "Accuracy");
    if (!(h->sim->run_options.duration > 0)) {
        fputs("<p>Nothing was integrated: there is no end time.</p>\n", h->out);
    } else {
        put_ledger(h);
        put_estimates(h);
        put_work(h);
        put_work_precision(h);
    }
    ct_html_close_section(h);
}
