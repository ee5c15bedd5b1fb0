// Declarations that the files of the assembly share.
//
//     assembly.c           iterations, from the targets to a start
//     assembly_targets.c   what `initial` asks of coordinates
//     assembly_report.c    what went wrong
//     start_demands.c      does the start still have the demanded values?
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
    struct ct_target *q, *u; // by place in eqs->coordinate
    int *frame;              // (nframe) frames at which joints act
    double *point, length;   // (3 x nframe) where they are on their bodies; natural length [m]
    size_t nframe;
    size_t
        nelastic; // elastic coordinates of the beams, which are rigid unless some start deformed
    const double *value;           // of the model's parameters
    bool may_stay_open;            // a start that does not close will do
    bool *fixed_row;               // rows without an offset of their own
    size_t *first_J, *first_speed; // entries of each row of J, and of each measured speed
    int *J_column, *speed_column;
    struct ct_program *speeds; // coefficients of measured speeds
    double *y, *b, *work;
    struct ct_sparse_rows A;             // rows now; what must be met comes first
    double *r;                           // their residuals
    struct ct_damped *closing, *nearest; // for rows that must be met, for all
    struct ct_saved_position {
        double *y, *memory;
    } before, best; // before a step; the nearest so far
    double *step;
    struct ct_target *kept_targets;
    struct ct_loop_filter *filter; // assembly_data.c
    size_t most;                   // room for rows
    size_t nhard;                  // of these: what must be met
};

/// Rows of loops that depend on others but for the tolerance of the data, as those of coaxial
/// hinges whose places are given to some digits: what they say beyond the others is left out, and
/// the loops close in the least-squares sense.
struct ct_loop_filter {
    bool is_on; // rows are filtered
    struct ct_arena *arena;
    double *B, *Q, *whole, *A; // workspace
    double *size, *r, *tau, *work, *kept_y;
    int *row;
};
struct ct_loop_filter *ct_loop_filter_create(struct ct_arena *a, const struct ct_assembler *s);
/// The first rows of s->A, s->r, up to s->nhard, are those of the loops that is_loop (nrow; NULL:
/// all) names, then given values.
void ct_loop_filter_apply(struct ct_assembler *s, const bool *is_loop);
/// Have rows at s->y parts that are neither round-off nor more than the tolerance of the data?
bool ct_loop_filter_is_due(struct ct_assembler *s);
/// With the filter, at the last rows: by how much given values are missed, which it may have left
/// out.
double ct_loop_filter_missed(const struct ct_assembler *s, bool of_speeds);
/// At s->y, closed with the filter: are the gaps within the tolerance, and is the rank the same
/// elsewhere on the motion?
bool ct_loop_filter_holds(struct ct_assembler *s);
/// Freedoms that the loops leave at s->y, to the tolerance of the data.
size_t ct_loop_filter_freedoms(struct ct_assembler *s);
/// By how much loops stay open.
void ct_loop_filter_warn(struct ct_assembler *s);
/// Values q and speeds u (of start->e->ncoordinate, out) of all coordinates at the state y (nq +
/// nu) of equations of motion e, which lies near the start.
void ct_start_read_back(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
                        const struct ct_equations *e, const struct ct_initial_state *start,
                        const double *y, double *q, double *u);

/// The values, or the rates, that a joint's `initial` gives.
const struct ct_value *ct_initial_value(const struct ct_edge_info *e, bool is_speed);
/// The number that `initial` gives for coordinate `place` of the joint. With `rotate` the list may
/// omit the quaternion. False: none is given.
bool ct_initial_number(const struct ct_model *model, const struct ct_value *v, int place,
                       double *out);
/// Is coordinate i an angle for which a whole turn more is the same position?
bool ct_assembler_is_turn(const struct ct_assembler *s, size_t i);
/// Fills s->frame and makes s->point.
void ct_assembler_list_frames(struct ct_assembler *s, struct ct_arena *a,
                              const struct ct_model *model);
/// Fills s->q, s->u, which are zeros, and s->length.
void ct_assembler_find_targets(struct ct_assembler *s, const struct ct_model *model);

/// Deviation of coordinate i from its target; for three of a quaternion's four numbers a rotation,
/// for the fourth false.
bool ct_assembler_deviation(const struct ct_assembler *s, size_t i, double *r);

/// Report the given value that is missed most, or the row that is open most. closes: the loops
/// close if given values are guesses. Returns false. Errors: CT_E_START, CT_E_ASSEMBLY.
bool ct_assembler_report_positions(struct ct_assembler *s, bool closes);
bool ct_assembler_report_speeds(struct ct_assembler *s);
/// Does each driven joint start on its motion? Errors: CT_E_START.
bool ct_assembler_check_drivers(struct ct_assembler *s);

#endif
