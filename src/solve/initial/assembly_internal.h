// What the files of the assembly share.
//
//     assembly.c           iterations, from targets to initial conditions
//     assembly_targets.c   targets: demanded and guessed values of coordinates and speeds
//     assembly_data.c      constraints that are redundant within the tolerance of the data
//     assembly_report.c    error messages
//     start_demands.c      are demanded values kept by later stages?
#ifndef CT_SOLVE_INITIAL_ASSEMBLY_INTERNAL_H
#define CT_SOLVE_INITIAL_ASSEMBLY_INTERNAL_H

#include "solve/initial/assembly.h"

#include "formulate/build.h"
#include "numeric/damped.h"

/// Weight of a deviation from 0 of coordinates without a guess; guesses have 1.
/// Definition: the root of the weight in docs/format.md.
static const double ct_assembly_open_weight = 1e-3;

/// Smallest damping of Levenberg-Marquardt steps.
/// Derived: about the root of the unit round-off eps. Residuals of eps then give steps of at most
/// eps/(2 damping) = 1e-8 along directions of any singular value.
static const double ct_assembly_least_damping = 1e-8;

struct ct_assembler {
    struct ct_ctx *ctx;
    struct ct_evaluator *m;
    const struct ct_equations *e;
    struct ct_target *q, *u; // (ncoordinate)
    int *frame;              // (nframe) frames at which joints act
    double *point, length;   // positions on their bodies; natural length [m]
    size_t nframe;
    size_t nelastic;               // elastic coordinates of the beams
    const double *value;           // of the model's parameters
    bool may_stay_open;            // open loops are accepted
    bool *fixed_row;               // rows whose constant is not taken from the initial state
    size_t *first_J, *first_speed; // entries of each row of J, and of each measured speed
    int *J_column, *speed_column;
    struct ct_program *speeds; // coefficients of measured speeds
    double *y, *b, *work;
    struct ct_sparse_rows A;             // rows that must be met, then weighted targets
    double *r;                           // their residuals
    struct ct_damped *closing, *nearest; // least-squares solvers: rows to be met; all rows
    struct ct_saved_position {
        double *y, *memory;
    } before, best; // before a step; nearest to the guesses so far
    double *step;
    struct ct_target *kept_targets;
    struct ct_loop_filter *filter; // assembly_data.c
    size_t most;                   // capacity for rows
    size_t nhard;                  // rows that must be met
};

/// Filter for rows of loops that are redundant within the tolerance of the data, as those of
/// coaxial hinges with positions of few digits. It drops the component that is independent of
/// other rows only by data errors. The loops then close in the least-squares sense.
struct ct_loop_filter {
    bool is_on; // rows are filtered
    struct ct_arena *arena;
    double *B, *Q, *whole, *A; // workspace
    double *size, *r, *tau, *work, *kept_y;
    int *row;
};
struct ct_loop_filter *ct_loop_filter_create(struct ct_arena *a, const struct ct_assembler *s);
/// Filter the first nhard rows of s->A and s->r: rows of the loops for which is_loop (nrow;
/// NULL: all) holds, then demanded values.
void ct_loop_filter_apply(struct ct_assembler *s, const bool *is_loop);
/// May the loops close with the filter? Without it the iterations have ended at s->y, where the sum
/// of squares of the residuals is least: above the tolerance of the data the filter cannot close
/// them.
bool ct_loop_filter_may_hold(struct ct_assembler *s);
/// Do rows at s->y have residuals or singular values between round-off and the tolerance of the
/// data?
bool ct_loop_filter_is_due(struct ct_assembler *s);
/// Largest error of a demanded value or speed at the last evaluation; the filter may drop
/// demands.
double ct_loop_filter_missed(const struct ct_assembler *s, bool of_speeds);
/// At s->y, closed with the filter: are the residuals within the tolerance of the data, and is
/// the rank the same at other configurations?
bool ct_loop_filter_holds(struct ct_assembler *s);
/// Degrees of freedom at s->y, with the rank of the loops to the tolerance of the data.
size_t ct_loop_filter_freedoms(struct ct_assembler *s);
/// Warn by how much loops stay open.
void ct_loop_filter_warn(struct ct_assembler *s);
/// Values q and speeds u (start->e->ncoordinate, out) of all coordinates at the state y (nq +
/// nu) of equations of motion e, which is near the initial state.
void ct_start_read_back(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
                        const struct ct_equations *e, const struct ct_initial_state *start,
                        const double *y, double *q, double *u);

/// The values, or the rates, that a joint's `initial` gives.
const struct ct_value *ct_initial_value(const struct ct_edge_info *e, bool is_speed);
/// The number that `initial` gives for coordinate `index` of the joint. With `rotate` the list
/// may omit the quaternion. False: none is given.
bool ct_initial_number(const struct ct_model *model, const struct ct_value *v, int index,
                       double *out);
/// Is coordinate i an angle, so that adding 2 pi gives the same position?
bool ct_assembler_is_turn(const struct ct_assembler *s, size_t i);
/// Fills s->frame and makes s->point.
void ct_assembler_list_frames(struct ct_assembler *s, struct ct_arena *a,
                              const struct ct_model *model);
/// Fills s->q, s->u, which are zeros, and s->length.
void ct_assembler_find_targets(struct ct_assembler *s, const struct ct_model *model);

/// Deviation of coordinate i from its target. For the first three components of a quaternion,
/// the rotation vector; false for the fourth.
bool ct_assembler_deviation(const struct ct_assembler *s, size_t i, double *r);

/// Report the demanded value with the largest error, or the row with the largest residual.
/// closes: the loops close when demanded values are only guesses. Returns false. Errors:
/// CT_E_START, CT_E_ASSEMBLY.
bool ct_assembler_report_positions(struct ct_assembler *s, bool closes);
bool ct_assembler_report_speeds(struct ct_assembler *s);
/// Do the initial values of each driven joint agree with its motion? Errors: CT_E_START.
bool ct_assembler_check_drivers(struct ct_assembler *s);

#endif
