// Model -> trees -> reduced equations of motion.
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
    int pick; // AUTO: that candidate of the search, from 1, whatever it costs; 0: the cheapest
    bool keep_all;     // leave nothing out: spatial rows for planar mechanisms
    bool with_energy;  // kinetic and potential energy and the power are wanted
    bool with_outputs; // the outputs of the model are wanted
    enum ct_more_outputs more;
    bool with_solution; // u' in closed form where that is cheap
    enum ct_formulation
        formulation;    // of an open system with solution; AUTO: the one of fewest operations
    bool with_residual; // an implicit method will ask for the residual and its derivatives
    bool
        measure_all; // results are the coordinates of all joints and bodies instead (for assembly)
    // with measure_all: equations of motion that will start from the results. Coordinates of bodies that are not
    // among their unknowns are then left 0; NULL: all are measured
    const struct ct_equations *measured_for;
    bool rigid;    // beams keep their shape
    bool deformed; // with measure_all: beams are not rigid there
    const bool
        *first; // by joint: of those a tree through joints has all it can have; NULL: none
    const struct ct_equations *like; // beams as in these; NULL: choose
    bool gaps;             // rows of joints hold where they start (constraint_offset.h)
    bool held;             // drivers stand still at their values: for what is static
    bool without_dynamics; // neither M nor Q: positions and speeds are all that is wanted
    bool
        frees_beams; // what the scene does not excite in beams is kept, too; as in `like`, where given
    bool
        for_analysis; // large systems will be linearised, not integrated: neither M nor Q nor a
                      // solution, and trees that couple few unknowns
};

/// Up to this many speeds every formulation is tried: they are cheap to generate, and the mass matrix is what people
/// look at. Chosen: the time to generate them against shorter programs.
enum { CT_SMALL_SYSTEM = 24 };
/// Limit: speeds; full matrices of larger systems would take hours, and a message says so.
enum { CT_MOST_FULL = 3000 };
/// Speeds of the systems that are analysed with dense matrices; larger ones with sparse matrices.
/// Chosen: dense matrices take some seconds there.
enum { CT_MOST_DENSE = 300 };

/// A pair of trees that the search has weighed.
struct ct_tree_candidate {
    const bool *trans, *rot; // branches, by edge
    size_t nu, nrow;         // unknown speeds, constraint rows
    double cost;             // operations of an evaluation, in multiplications
};

enum { CT_MOST_CANDIDATES = 10 }; // Layout: of what `cotree graph --trees` lists

/// What tree selection found, for the report.
struct ct_tree_report {
    const char *how; // "exhaustive search of 441 pairs", "given", ...
    double cost, cost_least_weight;
    // the cheapest pairs of the search, by cost, then by unknowns, then as they were met; none where nothing was searched
    struct ct_tree_candidate candidate[CT_MOST_CANDIDATES];
    int ncandidate;
};

/// Equations of the model for the trees that the options ask for. Everything lives in a.
/// Errors: E2xx.
bool ct_formulate(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *m,
                  const struct ct_formulate_options *options, struct ct_equations *out,
                  struct ct_tree_report *report);

/// A copy of equations in which more can be derived, while any number of threads read the original: for one run or one
/// analysis. model: what ct_model_fork has made of theirs. Cost: the store of expressions.
void ct_equations_fork(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
                       const struct ct_equations *from, struct ct_equations *to);
/// The same of a model: its store, its parameters and their values.
struct ct_model *ct_model_fork(struct ct_arena *a, const struct ct_model *from);

/// M and Q, if the equations do not have them yet: for those who do not use the solution.
void ct_formulate_dynamics(struct ct_equations *e);

/// Only the rows of the residual form, for derivatives as numbers.
void ct_formulate_rows(struct ct_equations *e);

/// The residual form, if the equations do not have it yet: for an implicit method chosen after they were made.
void ct_formulate_residual(struct ct_equations *e);

#endif
