// Forms: ways to solve a closed system for one choice of rows and columns without seeking pivots again.
//
//     unrolled   programs made by elimination on the expressions               (formulate/elimination.h)
//     unrolled as one system   the same of [M J'; J 0]                         (formulate/kkt.h)
//     sparse     [M J'; J 0] and J_d as sparse matrices, factored with the pivots of before
//
// The order of pivots is fixed, so it is watched: the strength of a form is that of its weakest pivot against
// the others or the entries around it, and what is left of the equations is measured.
#ifndef CT_SOLVE_FORM_H
#define CT_SOLVE_FORM_H

#include "formulate/elimination.h"
#include "solve/machine.h"

struct ct_form {
    const struct ct_form_kind *kind;
    struct ct_arena *arena; // its own
    int *row, *dependent;   // kept rows (rank), dependent columns, ascending: what it is for
    size_t rank;
    double operations; // of one solution, M, Q, J and gam included
    double cost; // the same weighed by what an operation takes, in those of straight-line code
    double
        weakest; // of its pivots, at the last solution or close: what strength is, also above 1
    double
        least_part; // of the largest that an inertia of B' M B has been: below it `has_fallen`, at the last solution
    bool has_fallen;
    double volume; // their product, det J_d but for a factor; NAN: not found
    // results of check
    const double *a, *lam; // u' (nu), multipliers of the kept rows (rank)
    double left,
        left_better; // residual against the terms of the equations, before and after refinement
    double kappa;    // largest entry of B; NAN: not found
    // results of close
    const double *phi, *v, *dq,
        *du; // (nrow), (nrow); corrections of the dependent places (nu), else 0
    const double *
        shift; // to be added to du where dq leads, (6.3b); NULL: not found, as where rows are redundant
};

struct ct_form_kind {
    const char *name;
    /// NULL if a pivot is missing, it takes too many nodes or a library is missing.
    struct ct_form *(*create)(struct ct_arena *a, struct ct_machine *m,
                              const struct ct_partition *p, double most_nodes);
    double (*solve)(struct ct_form *f, struct ct_machine *m, double *a);
    void (*check)(struct ct_form *f, struct ct_machine *m);
    double (*close)(struct ct_form *f, struct ct_machine *m);
    void (*destroy)(struct ct_form *f, struct ct_machine *m); // may be NULL
};

/// Smaller systems are never cheaper as sparse matrices: unknowns.
enum { CT_LEAST_SPARSE = 100 };
extern const struct ct_form_kind ct_form_unrolled, ct_form_whole, ct_form_sparse;

/// What solving is predicted to cost in each way, M, Q, J and gam included [operations of straight-line code]; NAN: it was
/// not looked at, INFINITY: it is not possible, or `unrolled` was given up as longer than the others.
struct ct_form_costs {
    double unrolled, whole, sparse, dense;
};

/// The cheapest form of a partition by counts of operations, its order of pivots sought at the machine's input, after
/// ct_machine_motion. NULL if the solve by dense matrices is cheaper: operations [multiplications or
/// additions]. kind: of the form to make, whatever it costs; NULL: the cheapest. costs (out) may be NULL. Owned by a until destroyed.
struct ct_form *ct_form_create(struct ct_arena *a, struct ct_machine *m,
                               const struct ct_partition *p, double operations,
                               const struct ct_form_kind *kind, struct ct_form_costs *costs);
/// One of this kind if it costs no more than so much, or little more: it is given up while it is made.
struct ct_form *ct_form_create_within(struct ct_arena *a, struct ct_machine *m,
                                      const struct ct_partition *p,
                                      const struct ct_form_kind *kind, double cost);
/// One of this kind however long its programs are, up to some millions of nodes.
struct ct_form *ct_form_ask(struct ct_arena *a, struct ct_machine *m,
                            const struct ct_partition *p, const struct ct_form_kind *kind);
void ct_form_destroy(struct ct_machine *m, struct ct_form *f);
bool ct_form_is_for(const struct ct_form *f, const struct ct_partition *p);

/// u' (nu, out) and q' at the machine's input. Returns the strength, 0 if there is no finite result.
double ct_form_solve(struct ct_form *f, struct ct_machine *m, double *a);
/// Fill the results of check at the machine's input.
void ct_form_check(struct ct_form *f, struct ct_machine *m);
/// Fill the results of close at the machine's input. Returns the strength.
double ct_form_close(struct ct_form *f, struct ct_machine *m);

/// Below this strength a form is of no use: one in so many digits is lost.
extern const double ct_form_weakest;

/// The programs of an unrolled form.
///
///     solved    u', q', pivots of B' M B (nfree, positive), of J_d (npivot), whose sizes times scale are strengths; the
///               power if it depends on neither u' nor multipliers
///     checked   refined u' (nu) and lam (rank), residuals before and after (nu + rank each), Q, gam (rank), B (nB)
///     closing   Phi, v (nrow each), corrections dq, du (nu each), shift (nshift), pivots of J_d
struct ct_form_code {
    const struct ct_listing *listing; // NULL: a form of another kind
    size_t nfree, npivot;
    const double *scale;
    const struct ct_program *solved, *checked, *closing;
    size_t nB, nshift;
    double M_size, J_size; // largest entries where the form was made
    bool has_power;        // behind the pivots of `solved`
};
struct ct_form_code ct_form_code(const struct ct_form *f);

// ---- for the kinds --------------------------------------------------------------------------------

/// Fill row, dependent, rank.
void ct_form_place(struct ct_form *f, const struct ct_partition *p);
/// Values by symbol at the machine's input, for partitions; NULL where no beam is carried.
const double *ct_form_values(struct ct_arena *a, const struct ct_machine *m);
/// Operations of a program, one each.
double ct_form_operations(const struct ct_program *p);
/// Machine code of so many operations without loops [bytes].
double ct_form_code_size(double operations);
/// What so many operations of straight-line code take, in operations whose code is in the nearest caches.
double ct_form_straight_cost(double operations, double bytes);

#endif
