// A robot's links and joints as the text of a model file; see urdf.h.
//
//     link                      body, its inertial frame turned into the link's axes
//     joint from P to C         point of P's body with the joint's origin, joint from there to C
//     mimic                     gear
//     visual                    shape
//     root                      welded to the ground
#include "import/urdf.h"

#include "base/decimal.h"
#include "base/entry.h"
#include "cotree/cotree.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

struct import {
    struct ct_ctx *ctx;
    const char *path, *model;
    FILE *out;
    struct ct_urdf u;
};

// ---- values --------------------------------------------------------------------------------

static void put_number(FILE *out, double v)
{
    char text[CT_DECIMAL_SIZE];
    ct_decimal_format(text, v + 0.0); // + 0.0 turns -0 into 0
    fputs(text, out);
}

static void put_list(FILE *out, const double *v, size_t n)
{
    fputc('[', out);
    for (size_t i = 0; i < n; i++) {
        fputs(i ? ", " : "", out);
        put_number(out, v[i]);
    }
    fputc(']', out);
}

// Writes a text in quotes, because it may contain any character.
static void put_text(FILE *out, const char *text)
{
    fputc('"', out);
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c < ' ' || c == 127)
            fprintf(out, "\\x%02x", c);
        else
            fprintf(out, c == '"' || c == '\\' ? "\\%c" : "%c", c);
    }
    fputc('"', out);
}

static bool is_zero(const double v[3])
{
    return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

// Writes Rz(yaw) Ry(pitch) Rx(roll) as rotations about axes.
static void put_rotation(FILE *out, const double rpy[3])
{
    const char *separator = "";
    fputs("rotate: [", out);
    for (int i = 2; i >= 0; i--) {
        if (rpy[i] == 0)
            continue;
        fprintf(out, "%s[%c, ", separator, 'x' + i);
        put_number(out, rpy[i]);
        fputc(']', out);
        separator = ", ";
    }
    fputc(']', out);
}

static void put_pose(FILE *out, const struct ct_urdf_pose *p, const char *before)
{
    if (!is_zero(p->xyz)) {
        fprintf(out, "%sat: ", before);
        put_list(out, p->xyz, 3);
        before = ", ";
    }
    if (!is_zero(p->rpy)) {
        fputs(before, out);
        put_rotation(out, p->rpy);
    }
}

static bool is_identity(const struct ct_urdf_pose *p)
{
    return is_zero(p->xyz) && is_zero(p->rpy);
}

// ---- bodies --------------------------------------------------------------------------------

static void put_solid(FILE *out, const struct ct_urdf_solid *s)
{
    fputs("      - {", out);
    switch (s->kind) {
    case CT_URDF_BOX:
        fputs("box: ", out);
        put_list(out, s->size, 3);
        break;
    case CT_URDF_CYLINDER:
        fputs("cylinder: ", out);
        put_list(out, s->size, 2);
        break;
    case CT_URDF_SPHERE:
        fputs("sphere: ", out);
        put_number(out, s->size[0]);
        break;
    case CT_URDF_MESH:
        fputs("file: ", out);
        put_text(out, s->file);
        if (s->size[0] != 1) {
            fputs(", scale: ", out);
            put_number(out, s->size[0]);
        }
        break;
    }
    put_pose(out, &s->pose, ", ");
    if (s->color)
        fprintf(out, ", color: \"%s\"", s->color);
    fputs("}\n", out);
}

// Sets entries to zero that are round-off of the rotation: sums of nine products.
static void clear_roundoff(double I[6])
{
    double most = 0;
    for (int i = 0; i < 6; i++)
        most = fmax(most, fabs(I[i]));
    for (int i = 3; i < 6; i++)
        if (fabs(I[i]) <= 9 * DBL_EPSILON * most)
            I[i] = 0;
}

static void put_inertia(FILE *out, const struct ct_urdf_link *l)
{
    double I[6];
    memcpy(I, l->inertia, sizeof I);
    clear_roundoff(I);
    const bool is_diagonal = is_zero(I + 3);
    if (is_diagonal && is_zero(I))
        return;
    fputs("    inertia: ", out);
    put_list(out, I, is_diagonal ? 3 : 6);
    fputc('\n', out);
}

static void put_points(FILE *out, const struct ct_urdf *u, int link)
{
    bool any = false;
    for (size_t i = 0; i < u->njoint; i++) {
        const struct ct_urdf_joint *j = &u->joint[i];
        if (j->parent != link || is_identity(&j->pose))
            continue;
        fputs(any ? "" : "    points:\n", out);
        fprintf(out, "      %s: {", j->id);
        put_pose(out, &j->pose, "");
        fputs("}\n", out);
        any = true;
    }
}

static void put_link(FILE *out, const struct ct_urdf *u, int i)
{
    const struct ct_urdf_link *l = &u->link[i];
    fprintf(out, "  %s:\n    mass: ", l->id);
    put_number(out, l->mass);
    fputc('\n', out);
    if (!is_zero(l->com)) {
        fputs("    com: ", out);
        put_list(out, l->com, 3);
        fputc('\n', out);
    }
    put_inertia(out, l);
    put_points(out, u, i);
    if (l->nsolid)
        fputs("    shape:\n", out);
    for (size_t k = 0; k < l->nsolid; k++)
        put_solid(out, &l->solid[k]);
}

// ---- joints --------------------------------------------------------------------------------

// Initial value of a joint: 0, or for a joint that mimics another one what follows from that.
static double start_of(const struct ct_urdf *u, const struct ct_urdf_joint *j)
{
    return j->mimic < 0 ? 0 : j->multiplier * start_of(u, &u->joint[j->mimic]) + j->offset;
}

static bool is_mimicked(const struct ct_urdf *u, size_t joint)
{
    for (size_t i = 0; i < u->njoint; i++)
        if (u->joint[i].mimic == (int)joint)
            return true;
    return false;
}

static void put_joint(FILE *out, const struct ct_urdf *u, size_t i)
{
    static const char *const types[]
        = {"revolute", "revolute", "prismatic", "weld", "free", "planar"};
    const struct ct_urdf_joint *j = &u->joint[i];
    if (j->limits) // may contain anything except a line break
        fprintf(out, "  # limits: %s\n", j->limits);
    fprintf(out, "  %s: {type: %s, from: %s%s%s, to: %s", j->id, types[j->type],
            u->link[j->parent].id, is_identity(&j->pose) ? "" : ".",
            is_identity(&j->pose) ? "" : j->id, u->link[j->child].id);
    if (j->type != CT_URDF_FIXED && j->type != CT_URDF_FLOATING) {
        fprintf(out, ", %s: ", j->type == CT_URDF_PLANAR ? "normal" : "axis");
        put_list(out, j->axis, 3);
    }
    if (j->damping != 0 && j->type <= CT_URDF_PRISMATIC) {
        fputs(", damping: ", out);
        put_number(out, j->damping);
    }
    if (j->mimic >= 0 || is_mimicked(u, i)) {
        fputs(", initial: {q: ", out);
        put_number(out, start_of(u, j));
        fputc('}', out);
    }
    fputs("}\n", out);
}

static void put_mimic(FILE *out, const struct ct_urdf *u, const struct ct_urdf_joint *j)
{
    if (j->mimic < 0)
        return;
    fprintf(out, "  %s: {type: gear, joints: [%s, %s], ratio: ", j->mimic_id, j->id,
            u->joint[j->mimic].id);
    put_number(out, j->multiplier);
    fputs("}\n", out);
}

static void put_outputs(FILE *out, const struct ct_urdf *u)
{
    const char *separator = "";
    fputs("outputs: [", out);
    for (size_t i = 0; i < u->njoint; i++)
        if (u->joint[i].type <= CT_URDF_PRISMATIC) {
            fprintf(out, "%s%s.q", separator, u->joint[i].id);
            separator = ", ";
        }
    fputs("]\n", out);
}

static const char *name_of_file(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static void put_model(const struct import *m)
{
    const struct ct_urdf *u = &m->u;
    FILE *out = m->out;
    fputs("cotree: 1\nname: ", out);
    put_text(out, u->name);
    fputs("\ndescription: ", out);
    put_text(out, ct_arena_printf(m->ctx->model, "from %s", name_of_file(m->path)));
    fputs("\ngravity: [0, 0, -9.81]   # z up; a URDF has none\n\nbodies:\n", out);
    for (size_t i = 0; i < u->nlink; i++)
        put_link(out, u, (int)i);
    fputs("\njoints:\n", out);
    fprintf(out, "  %s_on_ground: {type: weld, from: ground, to: %s}\n", u->link[u->root].id,
            u->link[u->root].id);
    for (size_t i = 0; i < u->njoint; i++)
        put_joint(out, u, i);
    for (size_t i = 0; i < u->njoint; i++)
        put_mimic(out, u, &u->joint[i]);
    fputc('\n', out);
    put_outputs(out, u);
    fputs("simulation: {duration: 1}\n", out);
}

static bool import(void *task)
{
    struct import *m = task;
    if (!ct_urdf_read(m->ctx, m->path, m->model, &m->u))
        return false;
    put_model(m);
    return true;
}

static bool import_into(void *task, FILE *out)
{
    struct import *m = task;
    m->out = out;
    return ct_enter(m->ctx, import, m);
}

char *ct_import_urdf(struct ct_ctx *ctx, const char *path, const char *model)
{
    struct import m = {.ctx = ctx, .path = path, .model = model};
    return ctx && path ? ct_text_of(ctx, import_into, &m) : NULL;
}
