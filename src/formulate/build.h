// Data of a formulation in progress. Each stage fills one struct; later stages only read it.
//
//     struct ct_build_options   options of the formulation
//     struct ct_topology        linear graph, plane of a planar mechanism      topology/
//     struct ct_kinematics      clusters, axes, anchors, node positions        kinematics/
//     struct ct_row_wrenches    wrenches of the constraint multipliers         kinematics/
//     struct ct_loads           forces and torques of the model                dynamics/
//     struct ct_equations       the result (equations.h)
//
//   rotation    ground cluster --axis, angle--> cluster --> ...
//   translation ground anchor --link--> anchor --> ...
//
// A cluster is a set of frames without relative rotation (arms, welds). A link is a vector fixed in
// a cluster, plus sliding displacements.
//
// What always holds: a cluster's parent and an anchor's parent have smaller numbers; number 0 is
// ground. Every node sits at an anchor plus a constant offset in a cluster. Vectors are in ground
// components unless a comment says `local` (components in a cluster).
#ifndef CT_FORMULATE_BUILD_H
#define CT_FORMULATE_BUILD_H

#include "base/pairs.h"
#include "component/model.h"
#include "component/roundoff.h"
#include "expr/switches.h"
#include "formulate/equations.h"
#include "graph/graph.h"

/// A path with more pieces than this is computed through the positions of its intermediate nodes.
/// Limit: of the time of derivation, which otherwise grows with the square of the length. Programs
/// are as long with either form; sums alone are for readers.
enum { CT_LONG_PATH = 40 };

enum ct_edge_kind { CT_EDGE_BODY, CT_EDGE_ARM, CT_EDGE_JOINT, CT_EDGE_CLOSURE, CT_EDGE_FORCE };

struct ct_node_info {
    const char *name;
    struct ct_mark mark;
    int body;
    bool is_particle; // axes stay parallel to ground
};

/// A coordinate of a joint or of a body edge: unknown, driven, or measured.
struct ct_coordinate {
    const char *name;                 // "crank.q", "crank.q2"
    int edge, index;                  // index: number among the coordinates of the edge
    bool in_translation, in_rotation; // it changes d; it changes the rotation
    bool is_driven;
    int q, u, driver;  // index of the coordinate, speed and driver; -1: none
    ct_ex value, rate; // for unknown and driven ones; for measured ones see coordinate.h
};

struct ct_edge_info {
    enum ct_edge_kind kind;
    const char *name;
    struct ct_mark mark;
    int index;                      // of the body, joint or force in the model; arms: frame
    const struct ct_instance *self; // joints, forces
    ct_ex3 at;                      // arms: position of the head in axes of the tail [m]
    // arms: rotation from axes of the head to axes of the tail; bodies in a plane: constant
    // rotation before the angle
    ct_ex33 S;
    // motion in terms of LOCAL symbols as coordinates; bodies, joints and closures only
    const struct ct_motion *trial;
    bool has_rotation; // false if one end is a particle
    bool must_be_branch, never_branch;
    int weight_t, weight_r; // degrees of freedom in the translational and rotational graph
    int first_coordinate, ncoordinate; // in the list of all coordinates
    // arms of beams: index in build->flexible, the section is at `along`; else -1
    int beam;
    ct_ex along; // [m]
};

/// The linear graph of a model and, for a planar mechanism, its plane. formulate/topology writes
/// it; later stages only read it. Lists have nnode or nedge entries unless a comment says
/// otherwise.
struct ct_topology {
    struct ct_graph graph;
    struct ct_node_info *node;
    struct ct_edge_info *edge;
    struct ct_edge *wiring;           // edges of graph
    struct ct_coordinate *coordinate; // of all edges; q, u, value and rate are not set yet
    size_t nnode, node_cap, nedge, edge_cap, wiring_cap, ncoordinate, coordinate_cap;
    int *node_of_frame, *node_of_com; // by frame, by body
    int *edge_of_joint;

    // planar mechanisms: common normal and a basis of the plane (ground components)
    bool is_planar;
    bool keeps_plane;          // all joints keep to a plane; is_planar may still be false
    bool is_spatial_for_beams; // only the beams prevent a planar formulation
    ct_ex3 normal;             // to the plane
    ct_ex3 plane[3];           // e1, e2, n
    ct_ex *layer;              // by node: its position along n [m]
    // by node: rotation from its axes to ground axes with all joints at rest; identity where the
    // normal has the same components in both
    ct_ex33 *reference_axes;
};

/// Motion of an edge in terms of the coordinates of the chosen trees.
struct ct_edge_kinematics {
    ct_ex3 d; // vector from tail to head in axes of the tail [m]
    // bodies, joints, closures and beam sections; NULL: no relative rotation
    const struct ct_motion *motion;
    const struct ct_station *station; // arms of beams, after the choice of elastic coordinates
    ct_ex3 *translation, *rotation;   // derivatives of the station by each elastic coordinate
    // translations for generalised forces, where foreshortening makes them differ; else NULL
    ct_ex3 *foreshortened;
};

static inline bool ct_edge_is_rigid_arm(const struct ct_edge_info *e)
{
    return e->kind == CT_EDGE_ARM && e->beam < 0;
}

/// coef times a rate: of unknown number speed if speed >= 0, of driver number driver if driver >=
/// 0.
struct ct_term {
    int speed, driver;
    ct_ex coef;
};

/// One axis of rotation of a cluster relative to its parent. A quaternion has three such axes.
struct ct_rotation_axis {
    int cluster; // that has this axis
    ct_ex3 axis; // unit vector
    int nterm;   // angular rate = sum of terms, plus a function of time
    struct ct_term *term;
    // of a beam section: edge number plus one, number and sign of the rotation; else 0
    int section, turn, sign;
    ct_ex3 local;     // the axis in axes of the cluster; zero if it is not constant there
    ct_ex rate, bias; // [rad/s], and [rad/s^2] with all u' = 0
};

struct ct_cluster {
    int parent;
    int first_axis, naxis;
    int enter, leave; // preorder interval, which contains those of all outboard clusters
    ct_ex33 R;
    int base;    // accumulated angle: R = R_base Rot(axis, angle)
    ct_ex3 axis; // local
    ct_ex angle;
    int has_angle;
    ct_ex own_angle; // relative to its parent, if it has a single axis
    ct_ex33 S;       // else rotation from its axes to its parent's
    ct_ex omega;     // planar: w = omega * normal
    ct_ex3 w;        // angular velocity [rad/s]
};

/// Translation of a link along p (local) at the rate of an unknown or a driver.
struct ct_translation_axis {
    int speed, driver;
    ct_ex3 p;
    // extra: added to p for generalised forces; foreshortening that the kinematics neglects
    ct_ex3 extra;
};

/// An anchor. The vector from its parent anchor is R_cluster local.
struct ct_anchor {
    int parent, cluster;
    int enter, leave; // preorder interval, which contains those of all outboard anchors
    ct_ex3 local;
    ct_ex3 fixed, sliding; // constant and variable part of local, where it moves
    int ntranslation_axis;
    struct ct_translation_axis *translation_axis;
    // local: rate of `local`, and its second derivative with all u' = 0
    ct_ex3 drift, drift_bias;
    bool moves; // local is not constant
};

/// Position of a node: anchor + R_cluster local. Its axes: R_frame S.
struct ct_node_placement {
    int anchor, cluster;
    ct_ex3 local;
    int frame; // cluster the node's axes belong to
    ct_ex33 S; // rotation of the node's axes in it, constant
};

/// Position and motion of all frames in terms of the coordinates of the chosen trees.
/// ct_unknowns_choose, ct_rotation_derive and ct_translation_derive (kinematics/) write it; later
/// stages only read it.
struct ct_kinematics {
    struct ct_edge_kinematics *edge;  // by edge
    struct ct_coordinate *coordinate; // the list of ct_topology with q, u, value and rate set
    struct ct_cluster *cluster;
    struct ct_rotation_axis *rotation_axis;
    struct ct_anchor *anchor;
    struct ct_node_placement *placement; // by node
    size_t ncluster, cluster_cap, nrotation_axis, rotation_axis_cap, nanchor, anchor_cap;
};

/// Expressions that kinematics/ has generated so far, and its workspace.
struct ct_kinematics_cache {
    // [0] with u' = 0, [1] with symbols u'
    struct ct_cluster_cache {
        ct_ex3 al[2]; // angular acceleration [rad/s^2]
        bool has_al[2];
    } * cluster; // by cluster
    struct ct_anchor_cache {
        ct_ex3 d;       // R_cluster local [m]
        ct_ex3 p;       // [m]
        ct_ex3 v, a[2]; // [m/s], [m/s^2]
        bool has_d, has_p, has_v, has_a[2];
    } * anchor; // by anchor
    struct ct_measured {
        bool made;
        ct_ex value;
    } * measured;           // by coordinate, for measured ones
    struct ct_piece *piece; // of the last path (nanchor + 2)
    bool *marked;           // clusters that affect it (ncluster)
    ct_ex *coefficient;     // of the speeds in the current row (nu)
};

/// Masses lumped on augmented bodies (dynamics/augmented_body.c, mass_sums.h).
struct ct_lumped_masses {
    bool is_lumped;
    struct ct_augmented_body *augmented_body;
    size_t naugmented_body, augmented_body_cap;
    struct ct_pairs of; // (anchor, cluster) -> number of the augmented body
    int *child;         // child anchors of each augmented body, as concatenated lists
    ct_ex33 *inertia;   // by cluster: augmented inertia, local [kg m^2]
    ct_ex *mass;        // by anchor: total outboard mass [kg]
};

/// A load: force F and torque T on the head, and the opposite wrench on the tail along the same
/// line of action.
struct ct_load {
    const struct ct_instance *self;
    int tail, head;       // nodes; tail 0 is ground
    ct_ex3 force, torque; // ground components
    bool is_central;      // the line of action passes through both origins: no moment arises
    ct_ex potential;      // [J]
    ct_ex power;          // of the part without a potential [W]
};

/// One vector of a path between two nodes: a link, or the offset of an end node (anchor < 0).
struct ct_piece {
    int anchor, cluster, sign;
    ct_ex3 local;
};

/// State of the substitution of signals (signals/signal.h) and of comparisons (switch.h) in an
/// expression.
struct ct_signal_state {
    struct ct_mark holding; // source position of the expression
    // the original expression, its signals and their replacements (nreplaced)
    ct_ex written;
    const ct_ex *from, *to;
    size_t nreplaced;
    int resolving;   // depth of signals within signals
    bool is_rate;    // the expression is the rate of a state, not a force
    bool is_open;    // it needs a reaction that a planar model does not determine
    bool in_outputs; // accelerations and multipliers are allowed; comparisons are not replaced
    struct ct_kept_quaternion {
        bool made;
        ct_ex p[4];
    } * quaternion; // by node: quaternions of frames that outputs need
};

struct ct_augmented_body; // mass_sums.h
struct ct_flexible;       // flexible_body.h
struct ct_station;
struct ct_sweep;
struct ct_multiplier_wrench; // constraint_row.h
struct ct_coupling;

/// Options of the formulation; constant.
struct ct_build_options {
    // by body: beams with automatic choice that are linear; NULL: not decided yet
    const bool *is_linear;
    const struct ct_equations *like; // take the beam formulations from these; NULL: choose
    bool keep_all;                   // no simplification, no planar formulation
    // keep all deformations of beams, also those that the model does not excite
    bool keeps_all_deformations;
    bool drivers_are_held; // drivers are constant: for static analysis
    bool has_offsets;      // constraint rows have offsets (constraint_offset.h)
    bool is_rigid;         // beams are rigid: for assembly
};

/// Wrenches and generalised forces of the constraint multipliers. ct_rows_derive (constraint_row.h)
/// writes them; later stages only read them.
struct ct_row_wrenches {
    struct ct_multiplier_wrench *multiplier_wrench;
    size_t nmultiplier_wrench, multiplier_wrench_cap;
    struct ct_coupling *coupling;
    size_t ncoupling, coupling_cap;
    int *motion_row; // by coordinate of a driven chord: number of its row plus one; else 0
};

/// Forces and torques. ct_loads_derive (dynamics.h) writes them; later stages only read them.
struct ct_loads {
    struct ct_load *load;
    size_t nload, load_cap;
    ct_ex *effort; // of joints along their unknown coordinates (nu)
};

/// Results that dynamics/ has derived so far.
struct ct_dynamics_cache {
    struct ct_lumped_masses masses;
    struct ct_speed_axis { // an axis along or about which a speed moves something
        bool is_translation;
        size_t at, next; // axis or anchor; number of the next item plus one, 0: last
        int k;           // which term or translation axis
    } * speed_axis;
    size_t nspeed_axis, speed_axis_cap;
    size_t *first_speed_axis; // by speed: number of the first item plus one; NULL: not listed
    const struct ct_sweep *sweep[2]; // by level
};

/// Equations under construction. Each stage fills its part, which later stages only read (stage.h).
struct ct_build {
    struct ct_ctx *ctx;
    struct ct_arena *arena;
    const struct ct_model *model;
    struct ct_exs *x;
    const double *value; // of all symbols at the start, by symbol index (parameters and t = 0)
    const struct ct_build_options *options;
    bool is_derived; // the tree search has already derived kinematics and dynamics

    // topology/: graph, coordinates without values, elastic coordinates of beams; then the trees
    const struct ct_topology *topology;
    struct ct_flexible *flexible; // one per beam
    size_t nflexible;
    struct ct_tree T, R;

    // kinematics/: positions, velocities and accelerations; rows and their multipliers
    const struct ct_kinematics *kinematics;
    struct ct_kinematics_cache cache;
    const struct ct_row_wrenches *rows;
    struct ct_row_wrenches *open_rows; // not NULL while ct_rows_derive fills them

    // dynamics/: loads, mass matrix, forces
    const struct ct_loads *loads;
    struct ct_loads *open_loads; // not NULL while ct_loads_derive fills them
    struct ct_dynamics_cache dynamics;

    // signals/, outputs/
    struct ct_signal_state signals;

    struct ct_equations *eqs; // the result; each stage adds its part

    // the same model with rigid beams, if requested (beam_error_coupled.h)
    struct ct_build *rigid;
    bool has_no_rigid; // it cannot be derived or gives no estimate
};

static inline const struct ct_edge_kinematics *ct_edge_kinematics(const struct ct_build *b,
                                                                  const struct ct_edge_info *e)
{
    return &b->kinematics->edge[e - b->topology->edge];
}
static inline const struct ct_motion *ct_edge_motion(const struct ct_build *b,
                                                     const struct ct_edge_info *e)
{
    return ct_edge_kinematics(b, e)->motion;
}
static inline bool ct_cluster_is_outboard(const struct ct_build *b, int inner, int outer)
{
    return b->kinematics->cluster[inner].enter <= b->kinematics->cluster[outer].enter
        && b->kinematics->cluster[outer].leave <= b->kinematics->cluster[inner].leave;
}
static inline bool ct_anchor_is_outboard(const struct ct_build *b, int inner, int outer)
{
    return b->kinematics->anchor[inner].enter <= b->kinematics->anchor[outer].enter
        && b->kinematics->anchor[outer].leave <= b->kinematics->anchor[inner].leave;
}

/// Planar: projection of v on the plane. Else v itself.
ct_ex3 ct_build_in_plane(struct ct_build *b, ct_ex3 v);
/// Record what the equations neglect and why, for the report.
void ct_build_note_left_out(struct ct_build *b, const char *what, const char *why);
/// Does the model list this joint or beam under `small`? at: its position in the file; may be NULL.
bool ct_build_is_small(const struct ct_build *b, const char *name, struct ct_mark *at);

/// Does the joint have a spring, a damper, an effort or a prescribed motion along a coordinate?
bool ct_joint_is_active(const struct ct_instance *joint);

#endif
