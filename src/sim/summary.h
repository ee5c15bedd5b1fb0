// What the summary of a run and that of a system say, in figures and names: of one run or of none.
//     summary.c        the figures
//     summary_file.c   for programs (--summary)
//     summary_text.c   for people
//     summary_start.c  what was asked of the joints and where they start
#ifndef CT_SUMMARY_H
#define CT_SUMMARY_H

#include "report/json.h"
#include "sim/sim.h"

/// Operations of all kinds.
long ct_tape_count_all(const struct ct_tape_counts *c);

/// Operations of one evaluation of the accelerations, the solution included.
long ct_sim_operations(const struct ct_sim *sim);

/// What finds the accelerations.
const char *ct_sim_solver(const struct ct_sim *sim);

/// Speeds less rank, and rows less rank.
long ct_sim_freedoms(const struct ct_sim *sim);
long ct_sim_redundant(const struct ct_sim *sim);

// Layout: of a line
enum { CT_MOST_START_TEXT = 256 }; // longer names are cut
/// Coordinates of the start, and of number i what was asked and found, in out; NULL: not of a
/// joint.
size_t ct_sim_start_count(const struct ct_sim *sim);
const char *ct_sim_start_text(const struct ct_sim *sim, size_t i, char *out, size_t size);
/// The same for programs, under the key "start".
void ct_sim_write_start(struct ct_json *j, const struct ct_sim *sim);

/// Writes keys into the object of a summary.
typedef void (*ct_summary_more_fn)(struct ct_json *j, const void *user);
/// As ct_sim_write_summary, with what `more` writes. Raises the guard.
bool ct_summary_write(struct ct_ctx *ctx, const struct ct_sim *sim, const char *path,
                      ct_summary_more_fn more, const void *user);

bool ct_is_arm(const struct ct_equations *e, int edge);

/// Is row i the first of its joint among those that depend (row) there? Rows of no joint count for
/// themselves.
bool ct_is_first_of_joint(const struct ct_equations *e, const bool *row, size_t i);

/// The joint of a row, else the row.
const char *ct_row_owner(const struct ct_sim *sim, size_t row);

/// How accelerations are formulated: the key for programs, the name for people. By enum
/// ct_formulation.
struct ct_formulation_name {
    const char *key, *name;
};
extern const struct ct_formulation_name ct_formulation_names[CT_NFORMULATION];

#endif
