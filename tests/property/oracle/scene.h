// A mechanism as the generator makes it and the solver reads it: rigid bodies, joints and one
// state.
//
// Body 0 is ground. Frames of joints are given in axes of their bodies by a place and three angles,
// as in a model file. Every number here is the number of the model text: scene_round brings all of
// them to the digits that are written.
#ifndef CT_TEST_ORACLE_SCENE_H
#define CT_TEST_ORACLE_SCENE_H

#include "tests/property/oracle/pose.h"

#include <stdbool.h>
#include <stdio.h>

enum { MOST_BODIES = 12, MOST_JOINTS = 20 };

enum joint_type {
    REVOLUTE,
    PRISMATIC,
    CYLINDRICAL,
    SCREW,
    UNIVERSAL,
    SPHERICAL,
    PLANAR,
    FREE,
    WELD,
    CURVE, // a custom joint: along a bent curve, turning on the way
    DISTANCE,
    GEAR,
    JOINT_TYPES
};

extern const char *const joint_type_name[JOINT_TYPES];

/// A frame on a body: its place, and the angles of Rz Ry Rx.
struct frame {
    struct vector at;
    double angle[3];
};

/// What the model file says of a joint's initial values.
enum start_kind { START_NONE, START_GUESS, START_DEMAND };

struct joint {
    enum joint_type type;
    int from, to; // bodies; of a gear: joints
    struct frame end[2];
    struct vector axis,
        second;        // unit vectors; `second` is b of a universal joint, fixed in `to`
    double pitch;      // length per turn of a screw
    double length;     // of a distance joint
    double ratio;      // of a gear
    double q[7], u[6]; // at the start
    enum start_kind start;
    double rotate[3]; // start of a joint with a quaternion, as angles of Rz Ry Rx
    double effort, stiffness, damping, rest; // of joints with one coordinate
};

struct body {
    double mass, inertia[6]; // xx yy zz xy xz yz, about the centre of mass
    struct vector com;
    struct pose pose; // at the start
};

struct scene {
    char name[120];
    int nbody, njoint; // nbody counts ground
    int digits;        // of the numbers in the text
    struct vector gravity;
    struct body body[MOST_BODIES];
    struct joint joint[MOST_JOINTS];
};

/// Speeds and coordinates of a joint type; a rotation with three freedoms has a coordinate more
/// than speeds.
int joint_speeds(enum joint_type type);
int joint_coordinates(enum joint_type type);
/// Is coordinate k of this joint type an angle? (The first three of `free` are lengths.)
bool joint_has_quaternion(enum joint_type type);

struct axes axes_of(const struct frame *f);

/// Bring every number to the digits of the text, so that the solver computes with what the program
/// reads.
void scene_round(struct scene *s);
/// The model text, with the poses, speeds and accelerations of all bodies and joints as outputs.
void scene_write(const struct scene *s, FILE *out);

#endif
