// See engine.h.
#include "tests/property/oracle/engine.h"

#include "cotree/cotree.h"
#include "sim/summary.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool stop_at_first(void *user, double t, const double *value, size_t n)
{
    (void)user;
    (void)t;
    (void)value;
    (void)n;
    return false;
}

static bool write_file(const struct scene *s, char *path)
{
    const int fd = mkstemp(path);
    FILE *f = fd < 0 ? NULL : fdopen(fd, "w");
    if (!f)
        return false;
    scene_write(s, f);
    return fclose(f) == 0;
}

static double value(const struct ct_sim *sim, const char *owner, int i, const char *what)
{
    char name[80];
    snprintf(name, sizeof name, "%s%d.%s", owner, i, what);
    return ct_sim_value(sim, name);
}

static struct vector vector_of(const struct ct_sim *sim, int body, const char *what)
{
    struct vector v;
    for (int i = 0; i < 3; i++) {
        char name[60];
        snprintf(name, sizeof name, "%s.%c", what, "xyz"[i]);
        v.e[i] = value(sim, "b", body, name);
    }
    return v;
}

static struct axes axes_from(const struct ct_sim *sim, int body)
{
    struct axes R;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            char name[30];
            snprintf(name, sizeof name, "rotation.%c%c", "xyz"[i], "xyz"[k]);
            R.column[k].e[i] = value(sim, "b", body, name);
        }
    return R;
}

// q or q1, q2 ...
static void read_joint(const struct ct_sim *sim, int joint, char what, int n, double *out)
{
    for (int i = 0; i < n; i++) {
        char name[20];
        if (n == 1)
            snprintf(name, sizeof name, "%c", what);
        else
            snprintf(name, sizeof name, "%c%d", what, i + 1);
        out[i] = value(sim, "j", joint + 1, name);
    }
}

static void read_motion(const struct scene *s, const struct ct_sim *sim, struct answer *out)
{
    for (int b = 0; b < s->nbody; b++) {
        if (b == 0) {
            out->at.body[b] = s->body[b].pose;
            continue;
        }
        out->at.body[b] = (struct pose){vector_of(sim, b, "position"), axes_from(sim, b)};
        out->at.v[b] = vector_of(sim, b, "velocity");
        out->at.w[b] = vector_of(sim, b, "angular_velocity");
        out->a.v[b] = vector_of(sim, b, "acceleration");
        out->a.w[b] = vector_of(sim, b, "angular_acceleration");
    }
    for (int j = 0; j < s->njoint; j++) {
        const enum joint_type type = s->joint[j].type;
        read_joint(sim, j, 'q', joint_coordinates(type), out->at.q[j]);
        read_joint(sim, j, 'u', joint_speeds(type), out->at.u[j]);
        read_joint(sim, j, 'a', joint_speeds(type), out->a.u[j]);
    }
}

// The first error, or else the first warning, without the file's name and the quoted lines.
static void keep_message(const struct ct_ctx *ctx, struct answer *out)
{
    char *text = NULL;
    size_t n = 0;
    FILE *f = open_memstream(&text, &n);
    ct_ctx_print_diagnostics(ctx, f);
    fclose(f);
    const char *said = strstr(text, "error: ");
    if (!said)
        said = strstr(text, "warning: ");
    if (said)
        snprintf(out->message, sizeof out->message, "%.*s", (int)strcspn(said, "\n"), said);
    free(text);
}

void engine_ask(const struct scene *s, const struct way *way, struct answer *out)
{
    memset(out, 0, sizeof *out);
    char path[] = "/tmp/cotree_mechanism_XXXXXX";
    struct ct_ctx *ctx = ct_ctx_create();
    const struct ct_system_options o = {.tree = way->tree, .keep_all = way->keep_all};
    struct ct_system *sys = write_file(s, path) ? ct_system_load(ctx, path, &o) : NULL;
    struct ct_sim *sim = ct_sim_create(ctx, sys, &(struct ct_sim_options){.backend = "tape"});
    out->ok = ct_sim_run(ctx, sim, &(struct ct_sim_results){.row = stop_at_first});
    keep_message(ctx, out);
    if (out->ok) {
        out->freedoms = ct_sim_freedoms(sim);
        read_motion(s, sim, out);
    }
    ct_sim_destroy(sim);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
    unlink(path);
}
