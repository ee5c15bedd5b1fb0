// What a study did, for people and for programs.
#include "study/study.h"

#include "report/json.h"

#include <string.h>

// Layout: the rest is in the summary file
enum { MOST_SHOWN = 10 };

// ---- summaries -----------------------------------------------------------------------------

static void write_axes(struct ct_json *j, const struct ct_plan *plan)
{
    ct_json_array(j, "vary");
    for (size_t i = 0; i < plan->naxis; i++) {
        const struct ct_axis *axis = &plan->axis[i];
        const bool is_normal = axis->kind == CT_AXIS_NORMAL;
        ct_json_object(j, NULL);
        ct_json_text(j, "parameter", axis->name);
        if (axis->kind == CT_AXIS_LIST) {
            ct_json_text(j, "kind", "list");
            ct_json_integer(j, "count", axis->n);
            ct_json_end(j);
            continue;
        }
        ct_json_text(j, "kind", is_normal ? "normal" : plan->is_sampled ? "uniform" : "grid");
        ct_json_number(j, is_normal ? "mean" : "from", axis->from);
        ct_json_number(j, is_normal ? "deviation" : "to", axis->to);
        if (!plan->is_sampled)
            ct_json_integer(j, "count", axis->n);
        ct_json_end(j);
    }
    ct_json_end(j);
    if (plan->is_sampled)
        ct_json_integer(j, "seed", (long long)plan->seed);
}

static void write_failures(struct ct_json *j, const struct ct_study *s)
{
    ct_json_array(j, "failures");
    for (long i = 0; i < s->plan.nmember; i++) {
        const struct ct_study_row *row = &s->row[i];
        if (row->state != CT_ROW_FAILED && row->state != CT_ROW_RESUMED_FAILED)
            continue;
        ct_json_object(j, NULL);
        ct_json_integer(j, "run", ct_plan_number(&s->plan, i));
        if (row->code)
            ct_json_integer(j, "code", row->code);
        ct_json_text(j, "message", row->message);
        ct_json_end(j);
    }
    ct_json_end(j);
}

static void write_summary(const void *object, FILE *out)
{
    const struct ct_study *s = object;
    struct ct_json j;
    ct_json_init(&j, out);
    ct_json_object(&j, NULL);
    ct_json_text(&j, "model", s->system->model.name);
    ct_json_text(&j, "results", s->path_written);
    if (s->plan.nshard) {
        ct_json_integer(&j, "shard", s->plan.shard);
        ct_json_integer(&j, "shards", s->plan.nshard);
    }
    ct_json_integer(&j, "members", s->plan.nmember);
    ct_json_integer(&j, "done", s->ndone - s->nfailed);
    ct_json_integer(&j, "failed", s->nfailed);
    ct_json_integer(&j, "resumed", s->nresumed);
    write_axes(&j, &s->plan);
    ct_json_text(&j, "method", s->method);
    ct_json_number(&j, "tolerance", s->tolerance);
    ct_json_text(&j, "backend", s->backend);
    ct_json_integer(&j, "lanes", s->lanes);
    ct_json_text(&j, "alone_because", s->alone_by);
    ct_json_integer(&j, "alone", s->nalone);
    ct_json_integer(&j, "threads", s->threads);
    ct_json_integer(&j, "steps", s->steps);
    ct_json_integer(&j, "rejected_steps", s->rejected);
    ct_json_object(&j, "seconds");
    ct_json_number(&j, "read", s->system->read);
    ct_json_number(&j, "generate", s->system->generate);
    ct_json_number(&j, "run", s->seconds);
    ct_json_end(&j);
    write_failures(&j, s);
    ct_json_end(&j);
}

struct summary {
    struct ct_ctx *ctx;
    const struct ct_study *s;
    const char *path;
};

static bool write_file(void *task)
{
    const struct summary *w = task;
    struct ct_outfile file;
    enum ct_suffix unused;
    if (!ct_suffix_read(w->ctx, w->path, CT_SUFFIX_JSON, &unused)
        || !ct_outfile_open(w->ctx, &file, strcmp(w->path, "-") == 0 ? NULL : w->path))
        return false;
    write_summary(w->s, file.stream);
    return ct_outfile_close(w->ctx, &file);
}

bool ct_study_write_summary(struct ct_ctx *ctx, const struct ct_study *s, const char *path)
{
    if (!ctx || !s || !path)
        return false;
    struct summary w = {ctx, s, path};
    return s && ct_enter(ctx, write_file, &w);
}

static void print_failures(FILE *out, const struct ct_study *s)
{
    int shown = 0;
    for (long i = 0; i < s->plan.nmember && shown < MOST_SHOWN; i++)
        if (s->row[i].state == CT_ROW_FAILED) {
            fprintf(out, "failed       run %ld: %s\n", ct_plan_number(&s->plan, i),
                    s->row[i].message);
            shown++;
        }
    if (shown == MOST_SHOWN && s->nfailed > shown)
        fprintf(out, "failed       %ld in all; --summary FILE.json lists them\n", s->nfailed);
}

static void print_summary(const void *object, FILE *out)
{
    const struct ct_study *s = object;
    fprintf(out, "%s: ", s->system->model.name);
    if (s->plan.nshard)
        fprintf(out, "shard %ld of %ld, ", s->plan.shard, s->plan.nshard);
    fprintf(out, "%ld members, %ld failed", s->plan.nmember, s->nfailed);
    if (s->nresumed)
        fprintf(out, ", %ld taken over", s->nresumed);
    fprintf(out, "\nmethod       %s, tolerance %g\n", s->method, s->tolerance);
    fprintf(out, "work         %ld steps, %ld rejected (%s)\n", s->steps, s->rejected,
            s->backend);
    fprintf(out, "lanes        %d in each of %d threads", s->lanes, s->threads);
    if (s->alone_by)
        fprintf(out, ": %s", s->alone_by);
    else if (s->nalone)
        fprintf(out, "; %ld members were run alone", s->nalone);
    fprintf(out, "\nseconds      read %.3g, generate %.3g, run %.3g\n", s->system->read,
            s->system->generate, s->seconds);
    print_failures(out, s);
    if (s->path_written)
        fprintf(out, "results      %ld rows in %s\n", s->plan.nmember, s->path_written);
}

void ct_study_print_summary(const struct ct_study *s, FILE *out)
{
    ct_print_to(out, print_summary, s);
}

char *ct_study_summary(const struct ct_study *s)
{
    return ct_print_text(print_summary, s);
}

char *ct_study_summary_json(const struct ct_study *s)
{
    return ct_print_text(write_summary, s);
}
