// Equations under construction, stage by stage; each struct is const for the stages below it.
//
//     struct ct_build_options   what is asked for
//     struct ct_topology        linear graph, plane of a planar mechanism      topology/
//     struct ct_kinematics      clusters, axes, anchors, places of nodes       kinematics/
//     struct ct_row_wrenches    what multipliers of constraint rows do         kinematics/
//     struct ct_loads           forces and torques of the model                dynamics/
//     struct ct_equations       the result (equations.h)
//
//   rotation    ground cluster --axis, angle--> cluster --> ...     a cluster is a set of frames that
//                                                                   turn together (arms, welds)
//   translation ground anchor --link--> anchor --> ...              a link is a vector fixed in a
//                                                                   cluster (plus slides)
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

/// Pieces between two nodes above which places on the way are computed on their own.
/// Chosen: fewer make equations that read as one sum, more make programs longer.
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
    int edge, index;                  // place among the edge's coordinates
    bool in_translation, in_rotation; // enters d, enters the turns
    bool is_driven;
    int q, u, driver;  // index of the unknown or the driver; -1 where not
    ct_ex value, rate; // of unknown and driven ones; measured ones: coordinate.h
};

struct ct_edge_info {
    enum ct_edge_kind kind;
    const char *name;
    struct ct_mark mark;
    int index;                      // of the body, joint or force in the model; arms: frame
    const struct ct_instance *self; // joints, forces
    ct_ex3 at;                      // arms: place in axes of the tail [m]
    ct_ex33 S; // arms: rotation of the head out of the tail's axes; bodies in a
               // plane: that of the body before its angle
    // bodies, joints, closures: with LOCAL symbols as coordinates; all others have none
    const struct ct_motion *trial;
    bool has_rotation; // false where a particle is reached
    bool must_be_branch, never_branch;
    int weight_t, weight_r;            // freedoms in the translational and rotational graph
    int first_coordinate, ncoordinate; // among the plain coordinates
    int beam; // arms of beams: number in build->flexible, with the section at `along`; else -1
    ct_ex along; // [m]
};

/// The linear graph of a model and the plane it keeps to: written by formulate/topology, const for
/// all that follows. Lengths of the lists are nnode and nedge unless a comment says otherwise.
struct ct_topology {
    struct ct_graph graph;
    struct ct_node_info *node;
    struct ct_edge_info *edge;
    struct ct_edge *wiring;           // of graph
    struct ct_coordinate *coordinate; // of all edges, without unknowns and values
    size_t nnode, node_cap, nedge, edge_cap, wiring_cap, ncoordinate, coordinate_cap;
    int *node_of_frame, *node_of_com; // by frame, by body
    int *edge_of_joint, *edge_of_body;

    // planar mechanisms: common normal and a basis of the plane (ground components)
    bool is_planar;
    bool keeps_plane;          // is_planar, or would be if something were left out
    bool is_spatial_for_beams; // for that alone the mechanism is not planar
    ct_ex3 normal;             // to that plane
    ct_ex3 plane[3];           // e1, e2, n
    ct_ex *layer;              // by node: its place along n [m]
    // by node: its axes -> ground's, joints at rest; identity where both see the normal alike
    ct_ex33 *upright;
};

/// What an edge does in coordinates of the chosen trees, by edge.
struct ct_edge_kinematics {
    ct_ex3 d;                         // its translation in axes of the tail [m]
    const struct ct_motion *motion;   // bodies, joints, closures, sections; others turn nothing
    const struct ct_station *station; // arms of beams: once the beam's coordinates are chosen
    ct_ex3 *translation, *rotation;   // of the station, by elastic coordinate
    ct_ex3 *foreshortened; // translations that forces act along, where they differ; else NULL
};

static inline bool ct_edge_is_rigid_arm(const struct ct_edge_info *e)
{
    return e->kind == CT_EDGE_ARM && e->beam < 0;
}

/// coef times a speed: of an unknown (speed >= 0) or of a driver (driver >= 0).
struct ct_term {
    int speed, driver;
    ct_ex coef;
};

/// One axis of rotation of a cluster against its parent. A quaternion gives three.
struct ct_rotation_axis {
    int cluster; // the one it introduces
    ct_ex3 axis; // unit vector
    int nterm;   // rate = sum of terms (+ what depends on time alone)
    struct ct_term *term;
    int section, turn,
        sign; // of a beam: edge number plus one, which of its turns and on which side; else 0
    ct_ex3 local;     // the axis in axes of the cluster; zero where it is not fixed there
    ct_ex rate, bias; // [rad/s], and [rad/s^2] with all u' = 0
};

struct ct_cluster {
    int parent;
    int first_axis, naxis;
    int enter, leave; // preorder interval: holds those of the clusters outboard
    ct_ex33 R;
    int base;    // accumulated angle: R = R_base Rot(axis, angle)
    ct_ex3 axis; // local
    ct_ex angle;
    int has_angle;
    ct_ex own_angle; // against its parent, where it is one turn
    ct_ex33 S;       // else its axes -> its parent's
    ct_ex omega;     // planar: w = omega * normal
    ct_ex3 w;        // angular velocity [rad/s]
};

/// Sliding of a link along p (local) at the speed of an unknown or a driver.
struct ct_translation_axis {
    int speed, driver;
    ct_ex3 p;
    ct_ex3
        extra; // what forces act along besides: foreshortening that the kinematics leaves out
};

/// Vector from the parent anchor to this one: R_cluster (local).
struct ct_anchor {
    int parent, cluster;
    int enter, leave; // preorder interval: holds those of the anchors outboard
    ct_ex3 local;
    ct_ex3 fixed, sliding; // its parts where it moves: the constant one, and what it slides by
    int ntranslation_axis;
    struct ct_translation_axis *translation_axis;
    ct_ex3 drift,
        drift_bias; // local: rate of `local`, and its second derivative with all u' = 0
    bool moves;     // has slides or a drift
};

/// Where a node is: at an anchor plus R_cluster local; its axes: R_frame S.
struct ct_node_placement {
    int anchor, cluster;
    ct_ex3 local;
    int frame; // cluster the node's axes belong to
    ct_ex33 S; // rotation of the node's axes in it, constant
};

/// Where frames are and how they move, in coordinates of the chosen trees: written by ct_unknowns_choose,
/// ct_rotation_derive and ct_translation_derive (kinematics/), const for all that follows.
struct ct_kinematics {
    struct ct_edge_kinematics *edge;  // by edge
    struct ct_coordinate *coordinate; // those of topology, with unknowns and values
    struct ct_cluster *cluster;
    struct ct_rotation_axis *rotation_axis;
    struct ct_anchor *anchor;
    struct ct_node_placement *placement; // by node
    size_t ncluster, cluster_cap, nrotation_axis, rotation_axis_cap, nanchor, anchor_cap;
};

/// What functions of kinematics/ have been asked for so far, and their workspace.
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
    } * measured;           // by coordinate, of those that are neither unknown nor driven
    struct ct_piece *piece; // of the path sought last (nanchor + 2)
    bool *marked;           // clusters that matter to it (ncluster)
    ct_ex *coefficient;     // of the speeds, in the row in hand (nu)
};

/// Masses that move alike, lumped (dynamics/augmented_body.c, mass_sums.h).
struct ct_lumped_masses {
    bool is_lumped;
    struct ct_augmented_body *augmented_body;
    size_t naugmented_body, augmented_body_cap;
    struct ct_pairs of; // number of the augmented body of (anchor, cluster)
    int *child;         // anchors, augmented body by augmented body
    ct_ex33 *inertia;   // by cluster: augmented inertia, local [kg m^2]
    ct_ex *mass;        // by anchor: of everything outboard [kg]
};

/// A load: force F at the head, torque T on the head, the opposite on the tail along the same line.
struct ct_load {
    const struct ct_instance *self;
    int tail, head;       // nodes; tail 0 is ground
    ct_ex3 force, torque; // ground components
    bool is_central; // the force points from one origin to the other: no moment of the pair
    ct_ex potential; // [J]
    ct_ex power;     // put in by the part that has no potential [W]
};

/// One piece of a path between two nodes: an anchor's link, or the offset of an end node (anchor
/// < 0).
struct ct_piece {
    int anchor, cluster, sign;
    ct_ex3 local;
};

/// Expressions of the model while their signals are replaced (signals/signal.h) and their
/// comparisons held (switch.h).
struct ct_signal_state {
    struct ct_mark holding; // where the expression stands whose comparisons are held
    // that expression as it is written, and what stands for its signals (nreplaced)
    ct_ex written;
    const ct_ex *from, *to;
    size_t nreplaced;
    int resolving;   // depth of signals within signals
    bool is_rate;    // of a state, not a force
    bool is_open;    // a reaction was met that this planar model leaves open
    bool in_outputs; // accelerations and multipliers may be used, comparisons stay as they are
    struct ct_kept_quaternion {
        bool made;
        ct_ex p[4];
    } * quaternion; // by node, of frames whose quaternion is an output
};

struct ct_augmented_body; // mass_sums.h
struct ct_flexible;       // flexible_body.h
struct ct_station;
struct ct_sweep;
struct ct_multiplier_wrench; // constraint_row.h
struct ct_coupling;

/// What is asked of the equations; const from the start.
struct ct_build_options {
    const bool *is_linear; // by body: beams left to the program that are; NULL: not known yet
    const struct ct_equations *like; // whose beams are formulated alike; NULL: none
    bool keep_all;                   // leave nothing out
    // beams do what their sections allow, whether the scene excites it or not
    bool keeps_all_deformations;
    bool drivers_are_held; // drivers stand still: time does not go on
    bool has_offsets;      // loops need not be closed (constraint_offset.h)
    bool is_rigid; // beams keep their shape: for assembly, where they are not deformed yet
};

/// What the multipliers of constraint rows do: written by ct_rows_derive (constraint_row.h), const
/// for all that follows.
struct ct_row_wrenches {
    struct ct_multiplier_wrench *multiplier_wrench;
    size_t nmultiplier_wrench, multiplier_wrench_cap;
    struct ct_coupling *coupling;
    size_t ncoupling, coupling_cap;
    int *motion_row; // by coordinate: the row of a driven chord plus one; else 0
};

/// Forces and torques: written by ct_loads_derive (dynamics.h), const for all that follows.
struct ct_loads {
    struct ct_load *load;
    size_t nload, load_cap;
    ct_ex *effort; // of joints along their unknown coordinates (nu)
};

/// What functions of dynamics/ have been asked for so far.
struct ct_dynamics_cache {
    struct ct_lumped_masses masses;
    struct ct_speed_axis { // a rotation axis or an anchor's translation axis that a speed moves
        bool is_translation;
        size_t at, next; // next: its number plus one, 0 at the end
        int k;           // term or translation
    } * speed_axis;
    size_t nspeed_axis, speed_axis_cap;
    size_t *first_speed_axis;        // by speed, numbers plus one; NULL: not listed yet
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
    bool is_derived; // by T and R, with the dynamics, when they were chosen

    // topology/: graph, coordinates without values, beams with what deforms; then the trees
    const struct ct_topology *topology;
    struct ct_flexible *flexible; // one per beam
    size_t nflexible;
    struct ct_tree T, R;

    // kinematics/: positions, velocities and accelerations; rows and their multipliers
    const struct ct_kinematics *kinematics;
    struct ct_kinematics_cache cache;
    const struct ct_row_wrenches *rows;
    struct ct_row_wrenches *open_rows; // while ct_rows_derive lists them; else NULL

    // dynamics/: loads, mass matrix, forces
    const struct ct_loads *loads;
    struct ct_loads *open_loads; // while ct_loads_derive lists them; else NULL
    struct ct_dynamics_cache dynamics;

    // signals/, outputs/
    struct ct_signal_state signals;

    struct ct_equations *eqs; // the result: every stage adds to it

    // the scene with rigid beams, once asked for (beam_error_coupled.h)
    struct ct_build *rigid;
    bool has_no_rigid; // that is of no use
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

/// Planar: v less its part along the normal; otherwise v.
ct_ex3 ct_build_in_plane(struct ct_build *b, ct_ex3 v);
/// Note what the equations leave out and why.
void ct_build_note_left_out(struct ct_build *b, const char *what, const char *why);
/// Does the model name this joint or beam under `small`? at, unless NULL, is set to where it does.
bool ct_build_is_small(const struct ct_build *b, const char *name, struct ct_mark *at);

/// Has the joint a spring, a damper, an effort or a prescribed motion along its coordinates?
bool ct_joint_is_active(const struct ct_instance *joint);

#endif
