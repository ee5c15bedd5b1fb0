// The figures and names in the summary of a run and in that of a system.
//
//     summary.c        figures
//     summary_file.c   JSON (--summary)
//     summary_text.c   text
//     summary_start.c  initial values of joints: requested and found
#ifndef CT_SUMMARY_H
#define CT_SUMMARY_H

#include "report/json.h"
#include "sim/sim.h"

/// Number of operations of all kinds.
long ct_tape_count_all(const struct ct_tape_counts *c);

/// Number of operations of one evaluation of the accelerations, the linear solution included.
long ct_sim_operations(const struct ct_sim *sim);

/// Name of the solver of the accelerations.
const char *ct_sim_solver(const struct ct_sim *sim);

/// Number of freedoms (speeds minus rank) and of redundant rows (rows minus rank).
long ct_sim_freedoms(const struct ct_sim *sim);
long ct_sim_redundant(const struct ct_sim *sim);

// Layout: of a line
enum { CT_MOST_START_TEXT = 256 }; // longer names are cut
/// Number of coordinates of the start; for coordinate i writes the requested and the found
/// value into out. NULL: it belongs to no joint.
size_t ct_sim_start_count(const struct ct_sim *sim);
const char *ct_sim_start_text(const struct ct_sim *sim, size_t i, char *out, size_t size);
/// The same as JSON under the key "start".
void ct_sim_write_start(struct ct_json *j, const struct ct_sim *sim);

/// Writes additional keys into the object of a summary.
typedef void (*ct_summary_more_fn)(struct ct_json *j, const void *user);
/// As ct_sim_write_summary, with the keys that `more` writes. Raises the guard.
bool ct_summary_write(struct ct_ctx *ctx, const struct ct_sim *sim, const char *path,
                      ct_summary_more_fn more, const void *user);

bool ct_is_arm(const struct ct_equations *e, int edge);

/// Is row i the first row of its joint among the marked rows? A row without a joint counts as
/// one of its own.
bool ct_is_first_of_joint(const struct ct_equations *e, const bool *row, size_t i);

/// Name of the joint of a row; name of the row if it has no joint.
const char *ct_row_owner(const struct ct_sim *sim, size_t row);

/// Names of the formulations of the accelerations, by enum ct_formulation: the JSON key and the
/// name in text.
struct ct_formulation_name {
    const char *key, *name;
};
extern const struct ct_formulation_name ct_formulation_names[CT_NFORMULATION];

#endif
