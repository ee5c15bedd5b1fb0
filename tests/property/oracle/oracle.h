// A small solver in maximal coordinates: every body has its own pose, every joint its own
// equations, and nothing is eliminated.
//
//     unknowns   x = accelerations of all body frames and of all joint coordinates (u')
//     joints     G x = c      six rows for each joint: the acceleration of `to` relative to `from` is that of the joint's coordinates;
//                             one row for a distance and for a gear
//     bodies     M x + G' lambda = f
//
// The rank of G and a basis Z of its null space come from singular values, with lengths in units of
// the mechanism's size. Freedoms are the dimension of the null space. x = x0 + Z z with the least
// x0 that meets G x = c, and Z' M Z z = Z' (f - M x0). The multipliers, of which redundant joints
// leave some open, are not needed. Sources: Wittenburg, Dynamics of Multibody Systems; Udwadia and
// Kalaba for the least solution of dependent constraints. Shares nothing with the engine.
#ifndef CT_TEST_ORACLE_ORACLE_H
#define CT_TEST_ORACLE_ORACLE_H

#include "tests/property/oracle/scene.h"

/// Where everything is and how it moves: of bodies in ground axes, of joints in their coordinates.
struct motion {
    struct pose body[MOST_BODIES];
    struct vector v[MOST_BODIES], w[MOST_BODIES];
    double q[MOST_JOINTS][7], u[MOST_JOINTS][6];
};

/// Most rows and columns of G.
enum { MOST_ROWS = 6 * MOST_JOINTS, MOST_COLUMNS = 6 * MOST_BODIES + 6 * MOST_JOINTS };

struct oracle {
    const struct scene *s;
    double size; // of the mechanism [m]
    int nrow, ncol, rank, freedoms;
    int column[MOST_JOINTS]; // of the first coordinate of a joint
    double smallest,
        largest_out; // singular value that counts and that does not, at most 1 in size
    double position, velocity;     // residuals of the joints, without unit
    double *G, *c, *U, *V, *sigma; // ncol x ncol V' and so on; column-major
    double *M, *f;
};

/// The state that the scene was made in: poses and joint coordinates, speeds zero.
struct motion motion_of_scene(const struct scene *s);

/// Set up G, its singular values and the residuals at a state. Free with oracle_close.
void oracle_open(struct oracle *o, const struct scene *s, const struct motion *m);
void oracle_close(struct oracle *o);

/// The unit of coordinate i of a joint: the mechanism's size for a length, 1 for an angle.
double oracle_unit(const struct oracle *o, int joint, int i);

/// The accelerations: of motion, v and w are those of the bodies' frames, u those of the joints.
/// False if the mass matrix of the freedoms is not positive definite. stiffness of the answer: the
/// condition number of that matrix.
bool oracle_accelerations(const struct oracle *o, const struct motion *m, struct motion *a,
                          double *condition);

/// Column k of the basis of the null space, as speeds. 0 <= k < freedoms
void oracle_freedom(const struct oracle *o, int k, struct motion *speeds);

/// Go along the speeds for a time h and back onto the joints by Gauss-Newton steps; false if they
/// cannot be met there.
bool oracle_move(const struct scene *s, struct motion *m, const struct motion *speeds,
                 double h);

#endif
