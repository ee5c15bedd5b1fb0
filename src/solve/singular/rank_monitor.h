// Rank monitor: singular configurations, predicted ahead of a motion and recorded for the report when it has passed them.
//
// Where J loses rank u' has a limit along the motion that cannot be computed. The driver of the integration crosses
// such a position in one step (integrate/crossing.h); where it is and how near, is found here.  (6.8)
#ifndef CT_SOLVE_SINGULAR_RANK_MONITOR_H
#define CT_SOLVE_SINGULAR_RANK_MONITOR_H

#include "integrate/stepper.h"
#include "solve/constraint/partition.h"

enum { CT_MOST_SINGULAR = 100 }; // kept for the report
enum { CT_MOST_POLES = 4 };      // of multipliers, on one crossing

/// What was passed.
struct ct_singular_configuration {
    double t;
    int rank_loss; // of J; 0: not known, the system is too large
    bool *row;     // (nrow) those that depend on each other there
};

struct ct_rank_monitor {
    struct ct_evaluator *m;
    struct ct_partition *s;
    double time_to_singular; // time to the position ahead; INFINITY: there is none
    double wanted;           // relative, of outputs; 0: not known
    double
        farthest; // the largest pivot so far, or what a start beside a position takes it to be
    int rank;     // of J, the largest so far
    double reach; // time before it in which f is better not computed
    double most, part, t;  // the largest pivot so far, the last one against it, and its time
    double dt;             // the step before
    double pivot, fall;    // the last one, 0: not known; and what it lost in a second
    bool retains_rows;     // a step does, and there are more than it needs
    bool solver_unchanged; // the form has told of the last state that nothing has changed
    long switches, nmade;  // of the coordinate partitioning, there
    long doubted; // its choice when a step was last looked at whether it is to be shorter
    double weakest, volume; // of its form there
    struct ct_tangent_basis *there, *here,
        *along;      // the view from there, from where a step ends, and on the way
    double *u, *a;   // (nu) speeds and accelerations there, where that is known
    double swiftest; // largest speed at looks
    long nover;      // positions that fixed steps have come across
    double over;     // when first
    double closest,
        t_closest;  // the smallest part of a step that was not made to cross, and when
    bool has_poles; // they are asked for
    int npole;
    double pole
        [CT_MOST_POLES]; // times of positions on the last crossing, to all digits, that the run may begin behind or end before
    long npassed;
    struct ct_singular_configuration *passed; // the first of them (CT_MOST_SINGULAR)
    double *last;                             // the last accepted state  (nq + nu)
    double *y, *d, *x;                        // (ny), (nu), (nrow)
};

struct ct_rank_monitor *ct_rank_monitor_create(struct ct_arena *arena, struct ct_evaluator *m,
                                               struct ct_partition *s);
/// Nothing is known and nothing was passed: before a run.
void ct_rank_monitor_start(struct ct_rank_monitor *w);

/// The step that has come to an accepted state.
struct ct_rank_monitor_step {
    bool is_fixed, is_across; // of fixed size; made to cross a position
};

/// What is ahead of an accepted state, up to the event that is pending. False if the step to it has come near a singular
/// configuration, or past it, before that was foreseen, and may be taken again: not with fixed steps, which are told only whether
/// they are beside one, and counted where they have come past it.
bool ct_rank_monitor_predict(struct ct_rank_monitor *w, double t, const double *y,
                             const double *dy, double pending,
                             const struct ct_rank_monitor_step *step);
/// Speeds have jumped at y, the last accepted place: next to a position, that comes sooner or later, or not at all.
void ct_rank_monitor_reset(struct ct_rank_monitor *w, double t, const double *y,
                           const double *dy, double pending);
/// How far [rad, m] y at t, where steps begin, is from a position: above 0 ahead along the motion, below 0 behind; as the smallest
/// pivot changes within s seconds, infinite where it does not change or does not tell.
double ct_rank_monitor_distance(struct ct_rank_monitor *w, double t, const double *y,
                                const double *dy, double pending, double s);
/// Beside a position, at y: farther off the smallest pivot is so many times what it is here.
void ct_rank_monitor_scale_pivot(struct ct_rank_monitor *w, double t, const double *y,
                                 double times);
/// At y, where steps begin, a position so much ahead is known of that is nearer than positions are where they are foreseen: the
/// largest pivot is taken to be so many times the one of now.
void ct_rank_monitor_start_near(struct ct_rank_monitor *w, double t, const double *y, double in,
                                double times);
/// At y, where the time is t, it is known of a position so much ahead: the first step from there is to cross it, whatever round-off
/// beside the position makes of it, as none from nearer by would be better.
void ct_rank_monitor_announce(struct ct_rank_monitor *w, double t, const double *y, double in);
/// Is y so near to one that round-off of accelerations in double precision is felt?
bool ct_rank_monitor_is_roundoff_limited(struct ct_rank_monitor *w, double t, const double *y);
/// Is y, where steps have ended, near a singular configuration, foreseen or not, or would a step of this size, 0 where it is not fixed,
/// come past one? row (nrow, out): those that depend there; none of a large system.
bool ct_rank_monitor_is_near_singular(struct ct_rank_monitor *w, double t, const double *y,
                                      double step, bool *row);
/// Does J have less rank at y, where the coordinate partitioning has chosen, or as near to y as loops are closed, than where the mechanism can
/// go from there? row (nrow, out): those that take part in what depends at y alone. Not looked for in large systems. The machine is
/// left with its constraints at y.
bool ct_singular_start_test(struct ct_arena *scratch, const struct ct_partition *s, double t,
                            const double *y, bool *row);
/// At y in a singular configuration: what (8.23) is missed by, of the squares of the speeds that it is made of. freedoms (out): there.
double ct_singular_start_misfit(struct ct_arena *scratch, const struct ct_partition *s,
                                double t, const double *y, int *freedoms);
/// What is evaluated from now on belongs to a crossing, or does not.
void ct_rank_monitor_set_crossing(struct ct_rank_monitor *w, bool is_crossing);
/// A crossing has been made, of which the span is all but the first part, `begin` of it, and goes on to t1: find the position on it and
/// keep it. False if there is none before t1.
bool ct_rank_monitor_record(struct ct_rank_monitor *w, const struct ct_stepper_span *span,
                            double begin, double t1, double pending);

#endif
