// Survey of the loops of a mechanism: which joint closes each loop, the rank of its
// constraints, its distance from a singular configuration, and which joint freedoms would
// remove redundant constraints.
//
//     loop     a joint that is a chord, with its constraint rows and the branches of its circuits
//     near     the smallest nonzero singular value (counted by the rank at the start) of
//                  K_ik = J_ik S_k / N_i        (6.5a), which has no unit,
//              for the rows of one loop and for all rows. It is 0 in a singular configuration.
//     release  a freedom for a joint that makes one constraint less redundant. Let z'J = 0 and c
//              be the column of the new freedom. Then z'c is the reaction along it that the
//              multipliers z alone would make. If it is not 0, the rank grows by one and the
//              number of freedoms of the mechanism does not change.
//
// What always holds: measuring does not change the run.
#ifndef CT_ANALYSIS_LOOPS_H
#define CT_ANALYSIS_LOOPS_H

#include "sim/sim.h"

/// Limit: number of rows beyond which `near` is not measured over time; a thousand samples then
/// take seconds.
enum { CT_MOST_MEASURED_ROWS = 100 };

struct ct_loop {
    const char *name; // of the joint, or of the row if it belongs to no joint
    int joint;        // -1: none
    size_t *row;      // of the equations (nrow)
    size_t nrow, row_cap;
    // names of the edges of its circuits except arms, the closing joint first (nmember)
    const char **member;
    size_t nmember, member_cap;
    int rank;    // rank of its own rows at the start
    double near; // at the start; NAN if it is not measured
};

enum ct_release_kind { CT_RELEASE_TURN, CT_RELEASE_SLIDE, CT_RELEASE_REMOVE };

/// A freedom that a joint may be given: about or along an axis of its frame `from`, or all that
/// the joint constrains.
struct ct_release {
    int joint;
    enum ct_release_kind kind;
    int axis;       // 0, 1, 2: x, y, z
    bool is_chosen; // the chosen ones together remove all redundancy; each alone removes one
};

struct ct_loops {
    struct ct_sim *sim;
    struct ct_loop *loop;
    size_t nloop;
    // by row of the equations: it is redundant and takes no part in the dynamics
    bool *is_redundant;
    const bool *is_open; // by row: its multiplier is not unique
    int rank;            // rank of all rows at the start
    double near;         // of all rows at the start; NAN if it is not measured
    // By joint, rotations first. Empty if nothing is redundant. Also empty if the start is a
    // singular configuration, since constraints are dependent there only.
    struct ct_release *release;
    size_t nrelease;
    // workspace of ct_loops_measure
    struct ct_program J;
    double *row_size, *speed_size; // scales N and S of (6.5a) at the start
    size_t *first;                 // (nrow + 1) the first entry of each row among those of J
    int *speed;                    // (nu) those with an entry in the rows that are measured
    size_t *place;                 // (nu) their places among these; else 0
    double *A, *w, *work;
};

/// Surveys a simulation at its start, after it has been created and before it runs. Everything
/// lives in a, which must live as long as the simulation or until ct_loops_forget.
void ct_loops_create(struct ct_arena *a, struct ct_sim *sim, struct ct_loops *out);
/// near (1 + nloop, out): for all rows, then for each loop, at the present state of the run's
/// evaluator (as in the callback of a sample).
void ct_loops_measure(struct ct_loops *l, double *near);
/// Removes the references to the loops from the run's evaluator.
void ct_loops_forget(struct ct_loops *l);

/// Returns a phrase such as "let rocker_pin turn about x".
const char *ct_release_text(struct ct_arena *a, const struct ct_loops *l,
                            const struct ct_release *r);

#endif
