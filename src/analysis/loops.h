// Loops: what closes each, what its constraints leave open, how near it is to a singular configuration, and what
// to release where constraints are redundant.
//
//     loop     a joint that is a chord, with its rows, and the branches that its circuits pass
//     near     the smallest singular value that is not zero of
//                  K_ik = J_ik S_k / N_i        (6.5a), so that it has no unit
//              by the rank at the start: of the rows of a loop alone, and of all rows. It is 0 in a singular
//              configuration.
//     release  a freedom that a joint may be given so that one constraint less is redundant: with z'J = 0 and c the column
//              of the new freedom, z'c is the reaction along it that the multipliers z alone would make. Where that
//              is not 0 the rank grows by one, and the freedoms of the mechanism stay as many.
//
// What always holds: measuring changes nothing of the run.
#ifndef CT_ANALYSIS_LOOPS_H
#define CT_ANALYSIS_LOOPS_H

#include "sim/sim.h"

/// Limit: rows beyond which nothing is measured over time: a thousand samples then take seconds.
enum { CT_MOST_MEASURED_ROWS = 100 };

struct ct_loop {
    const char *name;  // of the joint, or of a row that no joint has
    int joint;         // -1: none
    const size_t *row; // of the equations (nrow)
    size_t nrow;
    const char *const *member; // edges of its circuits that are no arms, itself first (nmember)
    size_t nmember;
    int rank;    // of its rows alone, at the start
    double near; // at the start; NAN where it is not measured
};

enum ct_release_kind { CT_RELEASE_TURN, CT_RELEASE_SLIDE, CT_RELEASE_REMOVE };

/// A freedom for a joint: about or along an axis of its frame `from`, or all that it constrains.
struct ct_release {
    int joint;
    enum ct_release_kind kind;
    int axis;       // 0, 1, 2: x, y, z
    bool is_chosen; // those that are remove all redundancy; each alone removes one
};

struct ct_loops {
    struct ct_sim *sim;
    struct ct_loop *loop;
    size_t nloop;
    bool *is_redundant;  // by row of the equations: takes no part in the dynamics
    const bool *is_open; // by row: its multiplier is not unique
    int rank;            // of all rows, at the start
    double near;         // of all rows, at the start; NAN where it is not measured
    // by joint, turns first; none where nothing is redundant, and at a start in a singular configuration, as constraints
    // depend on each other there alone
    struct ct_release *release;
    size_t nrelease;
    // for ct_loops_measure
    struct ct_program J;
    double *row_size, *speed_size; // N, S at the start
    double *A, *w, *work;
};

/// Of a simulation that has been created, at its start; before it runs. Everything lives in a, which lives as long as the
/// simulation or until ct_loops_forget.
void ct_loops_create(struct ct_arena *a, struct ct_sim *sim, struct ct_loops *out);
/// near (1 + nloop, out) where the run's evaluator stands, as in the callback of a sample: of all rows, then by loop.
void ct_loops_measure(struct ct_loops *l, double *near);
/// The run's evaluator does not refer to the loops any more.
void ct_loops_forget(struct ct_loops *l);

/// "let rocker_pin turn about x", as a phrase.
const char *ct_release_text(struct ct_arena *a, const struct ct_loops *l,
                            const struct ct_release *r);

#endif
