// The formulation stage: derives the reduced equations of motion of a model. It builds the linear
// graph, chooses two spanning trees, and derives kinematics, constraint rows, dynamics and outputs
// as expressions. The sub-folders do one step each.
#ifndef CT_FORMULATE_FORMULATE_H
#define CT_FORMULATE_FORMULATE_H

#include "formulate/equations.h"

enum ct_tree_choice {
    CT_TREE_AUTO,     // least weight, then improved by the exact operation count (section 2.3)
    CT_TREE_JOINTS,   // through joints only
    CT_TREE_ABSOLUTE, // every body's own coordinates
    CT_TREE_GIVEN     // branches by name
};

struct ct_formulate_options {
    enum ct_tree_choice tree;
    const char *const *trans, *const *rot; // GIVEN: names of the branches that are not arms
    const struct ct_mark *trans_mark, *rot_mark; // of each name; NULL: nowhere
    size_t ntrans, nrot;
    // AUTO: number of the candidate to use, from 1, regardless of its cost; 0: the cheapest
    int pick;
    bool keep_all;     // no simplification: spatial equations for planar mechanisms
    bool with_energy;  // kinetic and potential energy and the power are wanted
    bool with_outputs; // the outputs of the model are wanted
    enum ct_more_outputs more;
    bool with_solution; // u' in closed form where that is cheap
    // for an open system with solution; AUTO: fewest operations
    enum ct_formulation formulation;
    bool with_residual; // an implicit method will ask for the residual and its derivatives
    // measure_all: the results are the coordinates of all joints and bodies (for assembly)
    bool measure_all;
    // with measure_all: the equations that will start from these results. Body coordinates that are
    // not among their unknowns are set to 0. NULL: compute all
    const struct ct_equations *measured_for;
    bool rigid;    // beams are rigid
    bool deformed; // with measure_all: beams are elastic
    // first: by joint: joints that the trees contain before all others; NULL: none
    const bool *first;
    const struct ct_equations *like; // take beam formulations from these; NULL: choose
    bool gaps; // joint rows have offsets, zero residual at the start (constraint_offset.h)
    bool held; // drivers are constant: for static analysis
    bool without_dynamics; // derive positions and velocities only, neither M nor Q
    // frees_beams: keep also deformations of beams that the model does not excite; as in
    // `like`, if given
    bool frees_beams;
    // for_analysis: large systems are only linearised: derive no M, Q or solution, choose trees
    // that couple few unknowns
    bool for_analysis;
};

/// Up to this many speeds every formulation is tried. Users read the mass matrix of such systems.
/// Default: the time to generate them against shorter programs. Test: operation_counts
enum { CT_SMALL_SYSTEM = 24 };
/// Limit: speeds; full matrices of larger systems would take hours, and a message says so.
enum { CT_MOST_FULL = 3000 };
/// Limit: speeds of analyses with dense matrices, which take some seconds at this size; larger
/// systems have sparse ones.
enum { CT_MOST_DENSE = 300 };

/// A pair of trees whose cost the search has computed.
struct ct_tree_candidate {
    const bool *trans, *rot; // branches, by edge
    size_t nu, nrow;         // unknown speeds, constraint rows
    double cost;             // operations of an evaluation, in multiplications
};

enum { CT_MOST_CANDIDATES = 10 }; // Layout: lines of `cotree graph --trees`

/// What tree selection found, for the report.
struct ct_tree_report {
    const char *how; // "exhaustive search of 441 pairs", "given", ...
    double cost, cost_least_weight;
    // the cheapest pairs, ordered by cost, then by number of unknowns, then as found; none without
    // a search
    struct ct_tree_candidate candidate[CT_MOST_CANDIDATES];
    int ncandidate;
};

/// Equations of the model for the trees that the options ask for. Everything lives in a.
/// Errors: E2xx.
bool ct_formulate(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *m,
                  const struct ct_formulate_options *options, struct ct_equations *out,
                  struct ct_tree_report *report);

/// A copy of equations for one run or one analysis. New results can be derived in the copy while
/// other threads read the original. model: the copy made by ct_model_fork. Cost: a copy of the
/// expression store.
void ct_equations_fork(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
                       const struct ct_equations *from, struct ct_equations *to);
/// A copy of a model with its own expression store, parameters and values.
struct ct_model *ct_model_fork(struct ct_arena *a, const struct ct_model *from);

/// Derives M and Q if the equations lack them, for callers that do not use the solution.
void ct_formulate_dynamics(struct ct_equations *e);

/// Derives the residual without its derivatives, for numerical differentiation.
void ct_formulate_rows(struct ct_equations *e);

/// Derives the residual form if the equations lack it: for an implicit method chosen later.
void ct_formulate_residual(struct ct_equations *e);

#endif
