// What property tests of whole systems share: read, assemble, move to random states, solve,
// compare.
//
//     text or file -> system (model, assembly equations, start)
//     system + trees -> variant (equations, machine, embedding) -> state -> accelerations and results
//
// A failure prints what failed and fails the running test.
#ifndef CT_TEST_PROPERTY_SYSTEM_H
#define CT_TEST_PROPERTY_SYSTEM_H

#include "formulate/build.h"
#include "formulate/formulate.h"
#include "solve/evaluator/switch_state.h"
#include "solve/run/run.h"
#include "tests/check.h"

#include <stdlib.h>
#include <string.h>

struct system {
    const char *name;
    struct ct_ctx ctx;
    struct ct_model model;
    struct ct_equations assembly;  // on trees through joints, all joints measured
    struct ct_initial_state start; // assembled at t = 0
    struct ct_evaluator *machine;  // of assembly
    struct ct_partition *embed;
    double *y; // of machine, assembled
};

struct variant {
    struct ct_arena *arena; // of its own
    struct ct_ctx ctx;
    struct ct_equations e;
    struct ct_tree_report report;
    struct ct_evaluator *m;
    struct ct_partition *s;
    double *y, *result; // nresult
};

// ---- systems ------------------------------------------------------------------------------------

/// Read and assemble; print diagnostics and fail the test if that does not work.
void system_open_file(struct system *s, const char *file); // relative to the source root
void system_open_text(struct system *s, const char *name, const char *text);
/// The same, but a failure is returned; diagnostics stay in s->ctx.
bool system_try_text(struct system *s, const char *name, const char *text);
/// Assemble again with spatial rows, for variants that keep all: body coordinates differ.
void system_keep_all(struct system *s);
void system_close(struct system *s);

/// All model files of systems/, relative to the source root.
extern const char *const shipped[];
extern const size_t nshipped;
/// Does something hold for each of them with fewer than `most` bodies?
bool holds_for_shipped(bool (*holds)(struct system *s), size_t most);
/// For each mechanism of mechanism.h, and for all but irreversible ones with the joints in
/// `reversed` exchanged?
bool holds_for_mechanisms(bool (*holds)(struct system *s), unsigned reversed);

/// Replace the outputs by one signal more.
void system_output(struct system *s, const char *signal);
void system_no_outputs(struct system *s);
/// Outputs of every body (place, axes, their rates and accelerations) and every joint (coordinates
/// of all kinds).
void system_output_motion(struct system *s);
/// Outputs of every joint: force, torque, efforts.
void system_output_reactions(struct system *s);

/// A random state near the assembled one at time t that meets all constraints; false if the
/// mechanism cannot be moved there.
bool system_random_state(struct system *s, double t, double amplitude,
                         struct ct_initial_state *out);

// ---- variants -----------------------------------------------------------------------------------

bool variant_try(struct system *s, const struct ct_formulate_options *o, struct variant *v);
void variant_open(struct system *s, const struct ct_formulate_options *o, struct variant *v);
void variant_close(struct variant *v);
/// Put a state in at time t; modes and memories follow.
void variant_set(struct variant *v, const struct ct_initial_state *state, double t);
/// The same with the state that is in v->y.
void variant_renew(struct variant *v, double t);
/// Accelerations, multipliers and results there.
bool variant_solve(struct variant *v);
/// Index of a result by name; fails if there is none.
size_t variant_result(const struct variant *v, const char *name);

extern const struct ct_formulate_options by_joints, by_bodies, by_choice, by_joints_spatial,
    by_bodies_spatial;

// ---- trees --------------------------------------------------------------------------------------

/// All admissible trees by names of branches.
struct tree_list {
    size_t n, cap;
    struct tree_names {
        const char **name;
        size_t n;
    } * tree;
};
/// T (rotation false) or R (true) of a model; the list lives in s.
struct tree_list system_trees(struct system *s, bool keep_all, bool rotation);
/// Options that give these two trees; nothing else is set.
struct ct_formulate_options trees_given(const struct tree_names *trans,
                                        const struct tree_names *rot);

// ---- chance and comparison ----------------------------------------------------------------------

void chance_start(void); // prints the seed, CT_TEST_SEED
double chance(void);     // uniform in [-1, 1)
int chance_of(int n);    // 0 .. n - 1

/// |got - want| <= tol * scale; prints what and both values and counts a failure.
bool agree(const char *system, const char *what, double got, double want, double scale,
           double tol);
double largest_of(const double *v, size_t n);
/// The same of n numbers, against the largest of `want`.
bool same(const char *system, const char *what, const double *got, const double *want, size_t n,
          double tol);

char *text_of(struct ct_arena *a, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
/// A four-bar in space, two cranks about axes at right angles: its coupler, the beam `rod` of n
/// elements that bends in both planes, hangs on two balls. keys: more of the beam; bodies, joints:
/// more lines.
char *coupler_text(struct ct_arena *a, int n, const char *keys, const char *bodies,
                   const char *joints);

#endif
