// See scene.h: the mechanism as model text.
#include "tests/property/oracle/scene.h"

#include <stdlib.h>

const char *const joint_type_name[JOINT_TYPES]
    = {"revolute", "prismatic", "cylindrical", "screw",  "universal", "spherical",
       "planar",   "free",      "weld",        "custom", "distance",  "gear"};

int joint_speeds(enum joint_type type)
{
    static const int n[JOINT_TYPES] = {1, 1, 2, 1, 2, 3, 3, 6, 0, 1, 0, 0};
    return n[type];
}

bool joint_has_quaternion(enum joint_type type)
{
    return type == SPHERICAL || type == FREE;
}

int joint_coordinates(enum joint_type type)
{
    return joint_speeds(type) + joint_has_quaternion(type);
}

struct axes axes_of(const struct frame *f)
{
    return from_angles(f->angle);
}

// ---- digits -------------------------------------------------------------------------------------

static void round_to(double *v, int n, int digits)
{
    char text[40];
    for (int i = 0; i < n; i++) {
        snprintf(text, sizeof text, "%.*g", digits, v[i]);
        v[i] = strtod(text, NULL);
        v[i] += 0; // no minus zero
    }
}

void scene_round(struct scene *s)
{
    const int d = s->digits;
    round_to(s->gravity.e, 3, d);
    for (int i = 1; i < s->nbody; i++) {
        struct body *b = &s->body[i];
        round_to(&b->mass, 1, d);
        round_to(b->inertia, 6, d);
        round_to(b->com.e, 3, d);
    }
    for (int i = 0; i < s->njoint; i++) {
        struct joint *j = &s->joint[i];
        for (int k = 0; k < 2; k++) {
            round_to(j->end[k].at.e, 3, d);
            round_to(j->end[k].angle, 3, d);
        }
        round_to(j->axis.e, 3, d);
        round_to(j->second.e, 3, d);
        double *const number[] = {&j->pitch,     &j->length,  &j->ratio, &j->effort,
                                  &j->stiffness, &j->damping, &j->rest};
        for (size_t k = 0; k < sizeof number / sizeof number[0]; k++)
            round_to(number[k], 1, d);
        round_to(j->q, 7, d);
        round_to(j->u, 6, d);
        round_to(j->rotate, 3, d);
    }
}

// ---- text ---------------------------------------------------------------------------------------

static void write_list(const struct scene *s, FILE *out, const double *v, int n)
{
    for (int i = 0; i < n; i++)
        fprintf(out, "%s%.*g", i ? ", " : "[", s->digits, v[i]);
    fputs("]", out);
}

static bool are_zero(const double *v, int n)
{
    for (int i = 0; i < n; i++)
        if (v[i] != 0)
            return false;
    return true;
}

static bool is_body_frame(const struct frame *f)
{
    return are_zero(f->at.e, 3) && are_zero(f->angle, 3);
}

static void write_turns(const struct scene *s, FILE *out, const double angle[3])
{
    static const char axis[] = "zyx";
    const char *separator = "";
    fputs("[", out);
    for (int i = 0; i < 3; i++)
        if (angle[i] != 0) {
            fprintf(out, "%s[%c, %.*g]", separator, axis[i], s->digits, angle[i]);
            separator = ", ";
        }
    if (!*separator)
        fputs("[z, 0]", out);
    fputs("]", out);
}

static void write_frame(const struct scene *s, FILE *out, const struct frame *f)
{
    if (are_zero(f->angle, 3)) {
        write_list(s, out, f->at.e, 3);
        return;
    }
    fputs("{at: ", out);
    write_list(s, out, f->at.e, 3);
    fputs(", rotate: ", out);
    write_turns(s, out, f->angle);
    fputs("}", out);
}

static void write_body_name(FILE *out, int body)
{
    if (body)
        fprintf(out, "b%d", body);
    else
        fputs("ground", out);
}

// Points a3, b3: the ends of joint j3.
static void write_points(const struct scene *s, FILE *out, int body)
{
    const char *separator = "";
    fputs("points: {", out);
    for (int i = 0; i < s->njoint; i++)
        for (int k = 0; k < 2; k++) {
            const struct joint *j = &s->joint[i];
            if (j->type == GEAR || (k ? j->to : j->from) != body || is_body_frame(&j->end[k]))
                continue;
            fprintf(out, "%s%c%d: ", separator, "ab"[k], i + 1);
            write_frame(s, out, &j->end[k]);
            separator = ", ";
        }
    fputs("}", out);
}

static void write_body(const struct scene *s, FILE *out, int i)
{
    const struct body *b = &s->body[i];
    fputs("  ", out);
    write_body_name(out, i);
    fputs(": {", out);
    if (i) {
        fprintf(out, "mass: %.*g, inertia: ", s->digits, b->mass);
        write_list(s, out, b->inertia, are_zero(b->inertia + 3, 3) ? 3 : 6);
        fputs(", com: ", out);
        write_list(s, out, b->com.e, 3);
        fputs(", ", out);
    }
    write_points(s, out, i);
    fputs("}\n", out);
}

static void write_end(FILE *out, const struct joint *j, int i, int k)
{
    write_body_name(out, k ? j->to : j->from);
    if (!is_body_frame(&j->end[k]))
        fprintf(out, ".%c%d", "ab"[k], i + 1);
}

static void write_keys(const struct scene *s, FILE *out, const struct joint *j)
{
    switch (j->type) {
    case SCREW:
        fprintf(out, ", pitch: %.*g", s->digits, j->pitch); // fall through
    case REVOLUTE:
    case PRISMATIC:
    case CYLINDRICAL:
        fputs(", axis: ", out);
        write_list(s, out, j->axis.e, 3);
        break;
    case UNIVERSAL:
        fputs(", axes: [", out);
        write_list(s, out, j->axis.e, 3);
        fputs(", ", out);
        write_list(s, out, j->second.e, 3);
        fputs("]", out);
        break;
    case CURVE:
        fputs(", coordinates: [c], translate: [0.3*c, 0.1*c^2, 0], rotate: [[z, c], [x, c/2]]",
              out);
        break;
    case DISTANCE:
        fprintf(out, ", length: %.*g", s->digits, j->length);
        break;
    default:
        break;
    }
}

static void write_start(const struct scene *s, FILE *out, const struct joint *j)
{
    const int nu = joint_speeds(j->type), nq = nu - 3 * joint_has_quaternion(j->type);
    if (j->start == START_NONE || nu == 0)
        return;
    fputs(", initial: {", out);
    if (nu == 1)
        fprintf(out, "q: %.*g, u: %.*g", s->digits, j->q[0], s->digits, j->u[0]);
    else {
        if (nq) {
            fputs("q: ", out);
            write_list(s, out, j->q, nq);
            fputs(", ", out);
        }
        fputs("u: ", out);
        write_list(s, out, j->u, nu);
    }
    if (joint_has_quaternion(j->type)) {
        fputs(", rotate: ", out);
        write_turns(s, out, j->rotate);
    }
    fprintf(out, "%s}", j->start == START_GUESS ? ", guess: true" : "");
}

static void write_joint(const struct scene *s, FILE *out, int i)
{
    const struct joint *j = &s->joint[i];
    fprintf(out, "  j%d: {type: %s, ", i + 1, joint_type_name[j->type]);
    if (j->type == GEAR) {
        fprintf(out, "joints: [j%d, j%d], ratio: %.*g}\n", j->from + 1, j->to + 1, s->digits,
                j->ratio);
        return;
    }
    fputs("from: ", out);
    write_end(out, j, i, 0);
    fputs(", to: ", out);
    write_end(out, j, i, 1);
    write_keys(s, out, j);
    write_start(s, out, j);
    if (joint_speeds(j->type) == 1)
        fprintf(out, ", effort: %.*g, stiffness: %.*g, damping: %.*g, rest: %.*g", s->digits,
                j->effort, s->digits, j->stiffness, s->digits, j->damping, s->digits, j->rest);
    fputs("}\n", out);
}

static void write_outputs(const struct scene *s, FILE *out)
{
    static const char *const what[]
        = {"position",         "rotation",     "velocity",
           "angular_velocity", "acceleration", "angular_acceleration"};
    const char *separator = "";
    fputs("outputs: [", out);
    for (int i = 1; i < s->nbody; i++)
        for (size_t k = 0; k < sizeof what / sizeof what[0]; k++) {
            fprintf(out, "%sb%d.%s", separator, i, what[k]);
            separator = ", ";
        }
    for (int i = 0; i < s->njoint; i++)
        if (joint_speeds(s->joint[i].type))
            fprintf(out, ", j%d.q, j%d.u, j%d.a", i + 1, i + 1, i + 1);
    fputs("]\n", out);
}

void scene_write(const struct scene *s, FILE *out)
{
    fprintf(out, "cotree: 1\nname: %s\ngravity: ", s->name);
    write_list(s, out, s->gravity.e, 3);
    fputs("\nbodies:\n", out);
    for (int i = 0; i < s->nbody; i++)
        write_body(s, out, i);
    fputs("joints:\n", out);
    for (int i = 0; i < s->njoint; i++)
        write_joint(s, out, i);
    write_outputs(s, out);
    fputs("simulation: {duration: 0.001, samples: 2}\n", out);
}
