// Mapping between the degrees of freedom of an element (dofs), those of the nodes (freedoms) and
// the elastic coordinates, for values, forces, masses and columns. flexible_body.h defines them.
#ifndef CT_FORMULATE_BEAM_DEGREES_OF_FREEDOM_H
#define CT_FORMULATE_BEAM_DEGREES_OF_FREEDOM_H

#include "expr/symmetric.h"
#include "formulate/beam/flexible_body.h"

/// Deformation (bit) that a kind of freedom belongs to.
unsigned ct_freedom_family(int kind);
bool ct_freedom_is_fixed(const struct ct_flexible *f, int node, int kind);
/// Parts of element e's dof j: *sign times those of the freedom; NULL if it is fixed.
const struct ct_freedom *ct_dof_freedom(const struct ct_flexible *f, int e, int j, int *sign);

/// Columns of the base's motion: p . m_rf + s . m_thetaf for a velocity p and an angular velocity s
/// of the base.
struct ct_elastic_columns {
    ct_ex3 *m_rf, *m_thetaf; // by elastic coordinate, axes of the beam
};

/// Adds a generalised force on a dof to that on its freedom.
void ct_dof_push(struct ct_build *b, const struct ct_flexible *f, int e, int j, ct_ex value,
                 ct_ex *by_freedom);
/// Entry of the mass matrix between dof j of element e and dof k of element g; the caller adds the
/// transposed pair separately.
void ct_dof_push_pair(struct ct_build *b, const struct ct_flexible *f, int e, int j, int g,
                      int k, ct_ex value, struct ct_symmetric *M);
void ct_dof_push_column(struct ct_build *b, const struct ct_flexible *f, int e, int j,
                        ct_ex3 m_rf, ct_ex3 m_thetaf, struct ct_elastic_columns *out);
/// Second derivatives of the foreshortening at the start of each element of a CHAIN, with the
/// symbols u', minus the bias.
ct_ex *ct_chain_accelerations(struct ct_build *b, const struct ct_flexible *f);

#endif
