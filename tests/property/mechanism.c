// See mechanism.h.
#include "tests/property/mechanism.h"

#include <math.h>
#include <string.h>

// ---- text ---------------------------------------------------------------------------------------

int chance_of(int n); // system.h

void rigid_turn(const struct rigid_motion *move, const double v[3], double out[3])
{
    const double *n = move->axis, c = cos(move->angle), s = sin(move->angle);
    const double along = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = c * v[i] + s * (n[j] * v[k] - n[k] * v[j]) + (1 - c) * along * n[i];
    }
}

static const char *point_text(struct ct_arena *a, const struct ground_point *p,
                              const struct rigid_motion *move)
{
    double at[3];
    memcpy(at, p->at, sizeof at);
    if (move) {
        rigid_turn(move, p->at, at);
        for (int i = 0; i < 3; i++)
            at[i] += move->p[i];
    }
    const char *text = ct_arena_printf(a, "      %s: {at: [%.17g, %.17g, %.17g], rotate: [",
                                       p->name, at[0], at[1], at[2]);
    if (move)
        text = ct_arena_printf(a, "%s[[%.17g, %.17g, %.17g], %.17g], ", text, move->axis[0],
                               move->axis[1], move->axis[2], move->angle);
    return ct_arena_printf(a, "%s[[%.17g, %.17g, %.17g], %.17g]]}\n", text, p->axis[0],
                           p->axis[1], p->axis[2], p->angle);
}

static const char *joint_text(struct ct_arena *a, const struct joint_line *j, bool reversed)
{
    const char *from = reversed ? j->to : j->from, *to = reversed ? j->from : j->to;
    return from
             ? ct_arena_printf(a, "  %s: {from: %s, to: %s, %s}\n", j->name, from, to, j->rest)
             : ct_arena_printf(a, "  %s: {%s}\n", j->name, j->rest);
}

// Lines joined in order or by chance.
static const char *joined(struct ct_arena *a, const char **line, size_t n, bool shuffle)
{
    const char *text = "";
    for (size_t left = n; left > 0; left--) {
        size_t k = 0;
        for (size_t skip = shuffle ? (size_t)chance_of((int)left) : 0;; k++)
            // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Branch): left of n lines are there
            if (line[k] && skip-- == 0)
                break;
        text = ct_arena_printf(a, "%s%s", text, line[k]);
        line[k] = NULL;
    }
    return text;
}

const char *mechanism_text(struct ct_arena *a, const struct mechanism *m,
                           const struct rigid_motion *move, unsigned reversed, bool shuffle)
{
    const char *line[MOST_LINES];
    double g[3];
    memcpy(g, m->gravity, sizeof g);
    if (move)
        rigid_turn(move, m->gravity, g);
    size_t n = 0;
    while (n < 4 && m->point[n].name) {
        line[n] = point_text(a, &m->point[n], move);
        n++;
    }
    const char *points = joined(a, line, n, shuffle);
    for (n = 0; n < MOST_LINES && m->body[n]; n++)
        line[n] = ct_arena_printf(a, "  %s\n", m->body[n]);
    const char *bodies = joined(a, line, n, shuffle);
    for (n = 0; n < MOST_LINES && m->joint[n].name; n++)
        line[n] = joint_text(a, &m->joint[n], reversed & 1u << n);
    const char *joints = joined(a, line, n, shuffle);
    for (n = 0; n < MOST_LINES && m->force[n]; n++)
        line[n] = ct_arena_printf(a, "  %s\n", m->force[n]);
    const char *forces
        = n ? ct_arena_printf(a, "forces:\n%s", joined(a, line, n, shuffle)) : "";
    return ct_arena_printf(
        a,
        "cotree: 1\ngravity: [%.17g, %.17g, %.17g]\nbodies:\n  ground:\n    points:\n%s%s"
        "joints:\n%s%ssimulation: {duration: 0.2, samples: 3}\n",
        g[0], g[1], g[2], points, bodies, joints, forces);
}

// ---- mechanisms ---------------------------------------------------------------------------------
//
// LOOP: ground.a -x- A -ball- B -cross- C -plane- ground.b, with x of any type. B's mass is off its
// frame.

#define A_BODY                                                                                 \
    "A: {mass: 1.3, inertia: [0.02, 0.03, 0.025, 0.002, -0.001, 0.003], com: [0.1, 0.02, "     \
    "-0.03], "                                                                                 \
    "points: {p: {at: [0.3, 0.1, 0.05], rotate: [[0.36, 0.48, 0.8], 0.7]}, r: [0, 0.2, 0.1]}}"
#define B_BODY                                                                                 \
    "B: {mass: 0.8, inertia: [0.01, 0.012, 0.007], com: [0.2, 0.05, 0], points: {p: {at: "     \
    "[0.4, -0.1, "                                                                             \
    "0.1], rotate: [[y, 0.4], [x, -0.3]]}, q: [0.2, 0, 0.1]}}"
#define C_BODY                                                                                 \
    "C: {mass: 0.6, inertia: 0.02, points: {p: {at: [0, 0.15, 0.1], rotate: [z, 0.5]}}}"
#define GROUND                                                                                 \
    .gravity = {1.5, -9, 2.5}, .point = {{"a", {0.1, 0.2, -0.1}, {0.6, 0, 0.8}, 0.5},          \
                                         {"b", {0.9, 0.3, 0.2}, {0, 0.8, 0.6}, -0.4}}
#define TAIL_JOINTS                                                                            \
    {"ball", "A.p", "B", "type: spherical, damping: [0.1, 0.2, 0.3]"},                         \
        {"cross", "B.p", "C",                                                                  \
         "type: universal, axes: [[1, 0.2, 0.1], [0.1, 1, 0.3]], stiffness: [2, 1]"},          \
    {                                                                                          \
        "plane", "ground.b", "C.p",                                                            \
            "type: planar, normal: [0.3, 0.2, 1], stiffness: [20, 30, 1], damping: [0.1, "     \
            "0.2, 0.1]"                                                                        \
    }
#define LOOP(title, ...)                                                                       \
    {                                                                                          \
        .name = title, GROUND, .body = {A_BODY, B_BODY, C_BODY},                               \
        .joint                                                                                 \
            = { {"x", "ground.a", "A", __VA_ARGS__},                                           \
                TAIL_JOINTS }                                                                  \
    }
#define JOINT(...)                                                                             \
    {                                                                                          \
        __VA_ARGS__                                                                            \
    }
#define LOOP_AND(title, x, more, ...)                                                          \
    {                                                                                          \
        .name = title, GROUND, .body = {A_BODY, B_BODY, C_BODY},                               \
        .joint = {{"x", "ground.a", "A", x}, TAIL_JOINTS, more}, __VA_ARGS__                   \
    }

// Planar mechanisms lie in the plane of a turned ground point.
// Point b lies 0.1 below a along the normal, which the offsets of the bars make up for.
#define TILTED                                                                                 \
    .gravity = {1, -7, 4}, .is_planar = true,                                                  \
    .point = {{"a", {0, 0, 0}, {0.6, 0.8, 0}, 0.9},                                            \
              {"b",                                                                            \
               {0.2373338472298013, 0.44699961457764903, -0.062160996827066439},               \
               {0.6, 0.8, 0},                                                                  \
               0.9}}

const struct mechanism mechanisms[] = {
    LOOP("loop: revolute",
         "type: revolute, axis: [1, 2, -1], stiffness: 3, damping: 0.2, rest: 0.1"),
    LOOP("loop: prismatic",
         "type: prismatic, axis: [1, 2, -1], stiffness: 40, damping: 0.2, effort: 2*cos(t)"),
    LOOP("loop: cylindrical",
         "type: cylindrical, axis: [0.3, 2, 1], stiffness: [30, 2], damping: [0.3, 0.1]"),
    LOOP("loop: screw", "type: screw, axis: [0.3, 2, 1], pitch: 0.3, stiffness: 2"),
    LOOP("loop: universal", "type: universal, axes: [[1, 0.3, 0], [0.2, 0.1, 1]], stiffness: "
                            "[1, 2], effort: [1, x.u2]"),
    LOOP("loop: spherical", "type: spherical"),
    LOOP("loop: planar", "type: planar, normal: [2, 1, -1], stiffness: [10, 20, 1]"),
    LOOP("loop: weld", "type: weld"),
    LOOP("loop: free",
         "type: free, stiffness: [50, 60, 70, 0, 0, 0], damping: [1, 2, 3, 0.1, 0.2, 0.3]"),
    LOOP("loop: custom",
         "type: custom, coordinates: [s, f], translate: [0.3*cos(f), 0.3*sin(f), s + 0.1*s*f], "
         "rotate: [[z, f], [x, 0.5*s*f]], stiffness: [30, 2]"),
    LOOP_AND("loop: distance", "type: universal",
             JOINT("rod", "ground.b", "B.q", "type: distance"), .is_driven = false),
    LOOP_AND("loop: gear", "type: cylindrical, axis: [0.2, 0.1, 1]",
             JOINT("cog", NULL, NULL, "type: gear, joints: [x.q2, cross.q1], ratio: -1.7"),
             .is_driven = false),
    LOOP_AND(
        "loop: forces", "type: cylindrical",
        JOINT("measure", "A.r", "C",
              "type: free, stiffness: [3, 4, 5, 0, 0, 0], damping: [1, 1, 1, 0.1, 0.1, 0.1]"),
        .force = {"line: {type: spring, from: ground.b, to: A.r, stiffness: 20, damping: 1, "
                  "length: 0.2}",
                  "soft: {type: bushing, from: A.r, to: C, stiffness: [10, 20, 30, 1, 1, 1], "
                  "damping: [1, 2, 3, 0.1, 0.2, 0.3]}",
                  "push: {type: force, at: B.q, value: [1, 2*sin(t), x.q2], in: ground.a}",
                  "carried: {type: force, at: C.p, value: [1, 0.5, 0], in: B.p}",
                  "wring: {type: torque, on: C, value: [0.1, 0.2*t, ball.u1], in: C.p}"}),
    LOOP_AND("loop: driven revolute",
             "type: revolute, axis: [1, 2, -1], motion: 0.3*sin(2*t + 0.2)",
             JOINT("measure", "ground.b", "B", "type: free"), .is_driven = true),
    LOOP_AND("loop: driven cylindrical",
             "type: cylindrical, axis: [1, 2, -1], motion: [~, 0.3*sin(2*t + 0.2)], damping: "
             "[1, 0.5]",
             JOINT("measure", "ground.b", "B", "type: free"), .is_driven = true),
    LOOP_AND("loop: driven universal",
             "type: universal, axes: [[1, 0.2, 0], [0, 1, 0.3]], motion: [0.2*t + 0.1, ~]",
             JOINT("measure", "ground.b", "B", "type: free"), .is_driven = true),
    LOOP_AND("loop: driven screw", "type: screw, pitch: 0.4, motion: 0.3*t^2 + 0.1*t",
             JOINT("measure", "ground.b", "B", "type: free"), .is_driven = true),
    LOOP_AND("loop: driven custom",
             "type: custom, coordinates: [s, f], translate: [0.3*cos(f), 0.3*sin(f), s*(1 + "
             "0.2*f)], rotate: [[z, f]], motion: [~, 0.4*sin(3*t)]",
             JOINT("measure", "ground.b", "B", "type: free"), .is_driven = true),
    LOOP_AND("loop: driven free", "type: spherical",
             JOINT("measure", "ground.b", "B",
                   "type: free, motion: [~, 0.05*sin(t) - 0.19, ~, ~, ~, ~]"),
             .is_driven = true),
    // two joints that must be branches close a loop: a weld behind the second one
    {.name = "closure",
     GROUND,
     .body = {A_BODY},
     .joint = {{"x", "ground.a", "A", "type: screw, axis: [0, 1, 2], pitch: 0.2"},
               {"six", "A.p", "ground.b",
                "type: custom, coordinates: [a, b, c, d, e, f], translate: [a, b, c], "
                "rotate: [[z, d], [x, e], [y, f]], stiffness: [1, 2, 3, 1, 1, 1]"}}},
    {.name = "open chain",
     GROUND,
     .body = {A_BODY, B_BODY, C_BODY},
     .joint = {{"x", "ground.a", "A",
                "type: free, initial: {q: [0.1, 0.2, 0.3], rotate: [[0.6, 0.8, 0], 0.5]}"},
               {"y", "B", "A.p", "type: cylindrical, axis: [0, 1, 1], stiffness: [10, 1]"},
               {"z", "B.p", "C.p", "type: screw, axis: y, pitch: -0.3"}}},
    {.name = "massless link",
     GROUND,
     .body = {A_BODY, "L: {points: {p: [0.1, 0, 0.3]}}", C_BODY},
     .joint = {{"x", "ground.a", "A", "type: revolute, axis: [0, 1, 1]"},
               {"z", "A.p", "L", "type: universal"},
               {"w", "L.p", "C", "type: spherical"},
               {"v", "ground.b", "C.p", "type: planar"}}},
    {.name = "particles",
     GROUND,
     .body = {A_BODY, "P: {type: particle, mass: 0.4}", "S: {type: particle, mass: 0.3}"},
     .joint
     = {{"x", "ground.a", "A", "type: spherical"},
        {"pin", "A.p", "P", "type: prismatic, axis: [1, 2, 1], stiffness: 20, rest: 0.1"},
        {"rod", "P", "S", "type: distance, length: 0.3"},
        {"rod2", "ground.b", "S", "type: distance"}},
     .force = {"line: {type: spring, from: A.r, to: S, stiffness: 10, length: 0.1}"},
     .is_irreversible = true},
    {.name = "particle pins",
     GROUND,
     .body = {A_BODY, "P: {type: particle, mass: 0.4}", B_BODY},
     .joint = {{"x", "ground.a", "A", "type: universal"},
               {"pin", "A.p", "P", "type: spherical"},
               {"hook", "B.q", "P", "type: revolute, axis: x"},
               {"plane", "ground.a", "P", "type: planar, normal: [1, 1, 0.2]"}},
     .is_irreversible = true},
    {.name = "tilted four-bar",
     TILTED,
     .body = {"A: {mass: 1, inertia: [0.1, 0.2, 0.25], com: [0.1, 0.05, 0.02], points: {p: "
              "{at: [0.3, 0, 0.1], rotate: [z, 0.3]}}}",
              "B: {mass: 2, inertia: [0.1, 0.2, 0.25, 0, 0, 0], com: [0.3, 0, 0], points: {p: "
              "[0.6, 0.1, 0], q: {at: [0.2, 0, 0], rotate: [y, pi]}}}",
              "C: {mass: 0.5, inertia: 0.05, points: {p: [0.4, 0, 0.2]}}",
              "D: {mass: 0.2, inertia: 0.01, com: [0.1, 0.1, 0.1]}"},
     .joint = {{"x", "ground.a", "A", "type: revolute, stiffness: 1"},
               {"y", "A.p", "B", "type: revolute, damping: 0.3"},
               {"z", "C.p", "B.p", "type: revolute"},
               {"w", "ground.b", "C", "type: revolute"},
               {"v", "B.q", "D", "type: revolute, effort: 0.2*t"}}},
    {.name = "tilted slider",
     TILTED,
     .body
     = {"A: {mass: 1, inertia: [0.1, 0.2, 0.25], com: [0.1, 0.05, 0.02], points: {p: {at: "
        "[0.3, 0, 0.1], rotate: [x, pi]}, q: [0.1, 0, -0.1]}}",
        "B: {mass: 2, inertia: [0.1, 0.2, 0.25], com: [0.3, 0, 0], points: {p: {at: [0.9, 0.1, "
        "0], rotate: [z, 0.4]}}}",
        "C: {mass: 0.5, inertia: 0.05, points: {p: {at: [0.1, 0, 0.2], rotate: [x, pi]}}}",
        "D: {mass: 0.3, inertia: 0.05}"},
     .joint
     = {{"x", "ground.a", "A", "type: revolute"},
        {"y", "A.p", "B", "type: revolute"},
        {"z", "B.p", "C.p", "type: revolute"},
        {"w", "ground.b", "C", "type: prismatic, axis: [1, 2, 0], stiffness: 30, damping: 1"},
        {"v", "ground.b", "D", "type: planar, stiffness: [1, 2, 3]"},
        {"u", "A.q", "D", "type: prismatic, axis: y"}},
     .force = {"line: {type: spring, from: C, to: D, stiffness: 20, damping: 1, length: 0.1}",
               "push: {type: force, at: B.p, value: [1, t, 0.5], in: ground.b}"}},
    {.name = "tilted weld and gear",
     TILTED,
     .body = {"A: {mass: 1, inertia: [0.1, 0.2, 0.25], com: [0.1, 0.05, 0.02], points: {p: "
              "{at: [0.3, 0, 0.1], rotate: [z, 0.4]}}}",
              "B: {mass: 2, inertia: 0.3, points: {p: {at: [0.5, 0.1, 0], rotate: [z, -0.4]}}}",
              "C: {mass: 0.5, inertia: 0.05, points: {p: [0.2, 0, -0.2]}}",
              "D: {mass: 0.3, inertia: 0.05}"},
     .joint = {{"x", "ground.a", "A", "type: planar, stiffness: [5, 6, 1]"},
               {"y", "A.p", "B", "type: weld"},
               {"z", "B.p", "C", "type: revolute"},
               {"w", "ground.b", "C.p", "type: planar, stiffness: [30, 10, 0.3]"},
               {"v", "ground.b", "D", "type: revolute"},
               {"cog", NULL, NULL, "type: gear, joints: [z, v], ratio: 2.5"}}},
    {.name = "tilted driven",
     TILTED,
     .body = {"A: {mass: 1, inertia: [0.1, 0.2, 0.25], com: [0.1, 0.05, 0.02], points: {p: "
              "{at: [0.3, 0, -0.1], rotate: [z, 0.4]}}}",
              "B: {mass: 2, inertia: 0.3, points: {p: {at: [0.9, 0.1, 0], rotate: [z, -0.4]}}}",
              "P: {type: particle, mass: 0.4}"},
     .joint = {{"x", "ground.a", "A", "type: revolute, motion: 0.5*sin(2*t)"},
               {"y", "A.p", "B", "type: revolute"},
               {"z", "ground.b", "B.p",
                "type: planar, stiffness: [3, 3, 1], damping: [0.1, 0.1, 0.1]"},
               {"w", "ground.b", "P", "type: prismatic, axis: [1, 1, 0], motion: 0.1*t"},
               {"rod", "B.p", "P", "type: distance"}},
     .is_driven = true,
     .is_irreversible = true},
    {.name = "geared driver",
     GROUND,
     .body = {A_BODY, B_BODY, "D: {mass: 0.7, inertia: 0.05}", "E: {mass: 0.2, inertia: 0.03}"},
     .joint = {{"x", "ground.a", "A", "type: revolute, axis: [1, 2, 0], motion: 0.5*sin(2*t)"},
               {"y", "A.p", "B", "type: universal"},
               {"z", "ground.b", "D", "type: prismatic, axis: [1, 1, 3], stiffness: 9"},
               {"w", "D", "E", "type: cylindrical"},
               {"cog", NULL, NULL, "type: gear, joints: [z, x], ratio: 0.3"},
               {"rack", NULL, NULL, "type: gear, joints: [x, w.q2], ratio: -1.4"}},
     .is_driven = true},
};
const size_t nmechanism = COUNT(mechanisms);
