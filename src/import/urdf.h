// This folder converts robot descriptions in URDF (Unified Robot Description Format) to model
// files.
//
//     urdf_read.c      XML -> links and joints, checked
//     urdf_geometry.c  rotations, inertias in other axes
//     urdf.c           links and joints -> text of a model
//
// What always holds after ct_urdf_read: links and joints form one tree; every number is finite;
// every `id` is a valid and unique name of the model format.
#ifndef CT_IMPORT_URDF_H
#define CT_IMPORT_URDF_H

#include "import/xml.h"

struct ct_urdf_pose {
    double xyz[3]; // [m]
    double rpy[3]; // [rad] about the fixed axes x, y, z in this order
};

struct ct_urdf_solid {
    enum { CT_URDF_BOX, CT_URDF_CYLINDER, CT_URDF_SPHERE, CT_URDF_MESH } kind;
    double size[3];    // box: edges; cylinder: radius, length; sphere: radius; mesh: scale
    const char *file;  // of a mesh, as the model file names it
    const char *color; // "#rrggbb", or NULL
    struct ct_urdf_pose pose;
};

struct ct_urdf_link {
    const char *name, *id;
    struct ct_mark mark;
    double mass, com[3];
    double inertia[6]; // xx yy zz xy xz yz about the centre of mass, in axes of the link
    struct ct_urdf_solid *solid;
    size_t nsolid, solid_cap;
    int joint; // joint that moves it; -1: root
};

enum ct_urdf_type {
    CT_URDF_REVOLUTE,
    CT_URDF_CONTINUOUS,
    CT_URDF_PRISMATIC,
    CT_URDF_FIXED,
    CT_URDF_FLOATING,
    CT_URDF_PLANAR
};

struct ct_urdf_joint {
    const char *name, *id;
    struct ct_mark mark;
    enum ct_urdf_type type;
    int parent, child; // links
    struct ct_urdf_pose pose;
    double axis[3], damping;
    const char *limits; // as text for a comment; NULL: none
    int mimic;          // joint that it follows; -1: none
    double multiplier, offset;
    const char *mimic_id; // of the gear
};

struct ct_urdf {
    const char *name;
    struct ct_urdf_link *link;
    size_t nlink, link_cap;
    struct ct_urdf_joint *joint;
    size_t njoint, joint_cap;
    int root;
};

/// Reads a file. Ignored elements give warnings. model: path of the model file to be written,
/// for the paths of meshes; NULL: not known. Errors: CT_E_XML, CT_E_URDF, CT_E_XACRO, E002.
bool ct_urdf_read(struct ct_ctx *ctx, const char *path, const char *model, struct ct_urdf *u);

/// R (3 x 3, out, column-major) = Rz(yaw) Ry(pitch) Rx(roll): maps components in the rotated
/// axes to components in the fixed ones.
void ct_urdf_rotation(double R[9], const double rpy[3]);
/// out <- R I R' for tensors [kg m^2] in the order of ct_urdf_link.
void ct_urdf_turn_inertia(double out[6], const double I[6], const double R[9]);

#endif
