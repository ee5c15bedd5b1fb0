// Component classes and their instances. The reader fills in instances; src/formulate uses them.
//
//     class (const, components/NAME.c)          instance (model arena)
//       name, keys[] ------- checked by -------> value[] one per key
//       motion / wrench / inertia                frames, marks
//
// What always holds: a class is constant data. Its key table alone defines the checks of the
// reader, `cotree components` and `cotree schema`. Values are expressions in the model's store, in
// SI units.
#ifndef CT_COMPONENT_CLASS_H
#define CT_COMPONENT_CLASS_H

#include "expr/ex.h"

struct ct_build; // the equations under construction, formulate/build.h
struct ct_instance;

enum ct_family { CT_FAMILY_BODY, CT_FAMILY_JOINT, CT_FAMILY_FORCE };
enum ct_body_kind { CT_BODY_RIGID, CT_BODY_PARTICLE, CT_BODY_BEAM };

enum ct_value_kind {
    CT_VALUE_SCALAR, // one expression
    CT_VALUE_VEC3,   // three expressions
    CT_VALUE_LIST,   // `least`..`most` expressions; a single scalar counts as a list of one
    CT_VALUE_COORDS, // one per speed of the joint (a scalar for one); `~` leaves an entry unset
    CT_VALUE_AXIS,   // x, y, z or [ux, uy, uz]; three expressions, normalised to a unit vector
    CT_VALUE_AXES,   // two axes: six expressions
    CT_VALUE_TURNS,  // [axis, angle] or a list of such
    CT_VALUE_FRAME,  // a frame's name
    CT_VALUE_NAMES,  // list of new names (coordinates of a custom joint)
    CT_VALUE_JOINTS, // list of joint coordinates: `a` or `a.q2`
    CT_VALUE_POINTS, // the points of a body
    CT_VALUE_INITIAL, // {q:, u:, rotate:, guess:} of a joint
    CT_VALUE_WORD,    // one of the key's choices
    CT_VALUE_WORDS,   // a list of choices, each once; `auto` means not given
    CT_VALUE_COUNT,   // an integer, at least `least`
    // of beams
    CT_VALUE_ELEMENTS, // a count, or a list of positions
    CT_VALUE_ROTARY,   // true, false or three expressions
    CT_VALUE_RAYLEIGH, // {alpha: a, beta: b}: two expressions
    CT_VALUE_SHAPES,   // {u: [...], v: [...], ...}: expressions of x, each with its name
    // `equilibrium` (count 1) or {u:, v:, w:, rx:, rates: {...}}: as SHAPES; names of rates end in
    // '
    CT_VALUE_FIELDS,
    CT_VALUE_PLACES, // points; a position may be one number, the distance along the axis
    CT_VALUE_SOLIDS, // shapes for drawing a body: one or a list (solid.h)
};

enum {
    CT_KEY_REQUIRED = 1,
    CT_KEY_TIME = 2,     // may use t, and may be a {table: ...}
    CT_KEY_STATE = 4,    // may use t and signals, and may be a {table: ...}
    CT_KEY_LOCAL = 8,    // may use the coordinate names of its custom joint
    CT_KEY_LENGTH = 16,  // may use the `length` of its beam
    CT_KEY_SECTION = 32, // may use `length` and `x`, the position along its beam
};

/// One key of a component in the model file.
struct ct_key {
    const char *name;
    enum ct_value_kind kind;
    unsigned flags;
    const char *unit; // dimension of each expression: "kg", "N*m/rad", "" none; NULL: any
                      // WORD, WORDS: the choices, "linear|lumped"; the first is the default
    int least, most;  // LIST: lengths lie in least..most (inertia also checks 1, 3, 6)
    const char *doc;  // one line, with the default
};

struct ct_turn {
    ct_ex3 axis; // unit vector
    ct_ex angle; // [rad]
};

struct ct_value {
    bool given;
    bool is_wrong;           // wrong, and reported
    struct ct_mark mark;     // of the value
    size_t n;                // number of expressions
    ct_ex *e;                // expressions
    struct ct_mark *at;      // position of each
    bool *hole;              // COORDS: true where `~` is given
    int frame;               // FRAME: index into the model's frames; -1 when not given
    const char *const *name; // NAMES, JOINTS, SHAPES, FIELDS: n texts
    size_t nturn;
    struct ct_turn *turn; // TURNS
    long count; // COUNT, ELEMENTS: the number; WORD: index of the choice; WORDS: one bit
                // per choice; ROTARY: 0 false, 1 true, 3 values
};

/// Limit: coordinates and rows of a class, by the size of arrays.
enum { CT_MAX_COORD = 12, CT_MAX_ROW = 6 };

/// How a coordinate is computed from the relative motion of the frames, for a joint that is a
/// chord.
///
///       length      q = along . d                        u = along . d'
///       angle       q = angle about `about` from v (axes of `from`) to R w (w in axes of `to`)
///                   u = (from . w_rel) + (to . w_rel),   w_rel: angular velocity, `to` in `from`
///       quaternion  first of the four stored numbers; u = components of w_rel in axes of `to`
enum ct_measure_kind { CT_MEASURE_LENGTH, CT_MEASURE_ANGLE, CT_MEASURE_QUATERNION };
struct ct_measure {
    enum ct_measure_kind kind;
    ct_ex3 along;    // LENGTH: unit vector in axes of `from`
    bool reversed;   // ANGLE: `about` is fixed in `to`, and the angle is that from R v to w
    ct_ex3 about;    // ANGLE: unit vector, in axes of `from` (of `to` when reversed)
    ct_ex3 v, w;     // ANGLE: in axes of `from` and of `to`
    ct_ex3 from, to; // ANGLE: direction of the rate, parts in axes of `from` and of `to`
};

/// Relative motion that a joint allows: translation d of the origin of `to` in axes of `from`, and
/// rotation R = R_1 R_2 ... that transforms components in `to` to components in `from`.
/// (formulation 1.3, 1.8)
struct ct_motion {
    int ncoord;                // stored coordinates: a quaternion counts 4
    int nfree;                 // speeds
    ct_ex coord[CT_MAX_COORD]; // in:  symbols (or driver expressions) of the coordinates
    const double *value; // in:  values of all symbols at the start, used only to choose axes
    ct_ex3 d;            // out: [m]
    int nturn;           // out: successive rotations, about axes of the frame rotated so far
    struct ct_turn turn[CT_MAX_COORD];
    // index of the first of 4 coordinates that are the whole rotation (then nturn = 0), or -1
    int quaternion;
    // constraint rows of the joint as a chord; translational: directions in axes of `from`
    int ntrans;
    ct_ex3 trans[3];
    // Rotational: pairs (s | t), s in axes of `from`, t in axes of `to`, with s . R t constant.
    int nrot;
    ct_ex3 rot_from[3], rot_to[3];

    int nmeasure; // length and angle: one per coordinate; quaternion: one for its four
    // last member: ct_motion_keep omits the unused part
    struct ct_measure measure[CT_MAX_COORD];
};

/// Start values of a joint: `initial: {q:, u:, rotate:, guess:}`. q has one entry per stored
/// coordinate (with `rotate`, without the four of the quaternion), u one per speed; `~` leaves an
/// entry unset.
struct ct_initial {
    struct ct_value q, u;
    struct ct_value rotate; // turns; n = 0 when absent
    bool guess;
};

struct ct_instance {
    const struct ct_component_class *cls;
    const char *name;
    struct ct_mark mark;
    const struct ct_value *value; // one per key: family keys first, then the class's own
    struct ct_initial initial;    // joints
    const ct_ex *local;           // symbols of the coordinates of a custom joint
    int ncoord, nfree;            // joints: known counts; next to a particle only lengths
    int from,
        to; // frames; -1 for gears; `force` and `torque`: from is -1, to is the frame they act on
};

/// Value of a key of the instance by name; the key must exist (asserted). `given` tells whether the
/// user set it.
const struct ct_value *ct_instance_value(const struct ct_instance *self, const char *key);

/// What the key `value` of a force means: a vector at the frame `to`.
enum ct_applied_load { CT_APPLIED_NONE, CT_APPLIED_FORCE, CT_APPLIED_TORQUE };
/// Name of that vector as a signal: "force", "torque"; NULL for CT_APPLIED_NONE.
const char *ct_applied_load_name(enum ct_applied_load applied);

struct ct_component_class {
    const char *name, *summary;
    enum ct_family family;
    enum ct_body_kind body;   // bodies
    const struct ct_key *key; // keys of the class; those of the family are in class.c
    int nkey;
    const char *across, *through; // terminal equations, for `components` and `--show terminal`
    int ncoord, nfree;            // joints; custom: -1, from its list of coordinates
    bool always_branch;           // joints without constraint rows as a chord: screw, custom
    // joints and forces: transmits no moment, except by springs, dampers, efforts of joints
    bool is_moment_free;
    enum ct_applied_load applied; // forces
    bool is_standard;             // class of a component without `type`; at most one per family
    /// Joints with motion: fill `m` from the instance. NULL for distance and gear.
    void (*motion)(struct ct_exs *x, const struct ct_instance *self, struct ct_motion *m);
    /// Forces, distance and gear: add loads or rows through formulate/load.h and constraint_row.h.
    void (*apply)(struct ct_build *b, const struct ct_instance *self);
    /// Signals of the class (S.force, S.length ...): false if it has none of that name.
    bool (*signal)(struct ct_build *b, const struct ct_instance *self, const char *name,
                   ct_ex *out);
    const char *signals; // their names for messages: "force, length and rate"
};

// ---- functions for classes of joints to define a motion ----------------------------------------

/// The axis given under `key`; if not given, coordinate axis number `standard`.
ct_ex3 ct_instance_axis(struct ct_exs *x, const struct ct_instance *self, const char *key,
                        int standard);
/// A copy of m in the arena without the unused measures: it must not be copied as a struct.
const struct ct_motion *ct_motion_keep(struct ct_arena *a, const struct ct_motion *m);
/// Append a rotation about `axis` of the frame rotated so far.
void ct_motion_add_rotation(struct ct_motion *m, ct_ex3 axis, ct_ex angle);
/// Add three translational rows: the origins coincide.
void ct_motion_lock_translation(struct ct_exs *x, struct ct_motion *m);
/// Add three rotational rows (y|z) (z|x) (x|y): the axes coincide.
void ct_motion_lock_rotation(struct ct_exs *x, struct ct_motion *m);
/// The next coordinate is the length along a direction of `from`.
void ct_motion_measure_length(struct ct_motion *m, ct_ex3 along);
/// The next coordinate is the angle about n; across: a unit vector normal to n.
void ct_motion_measure_angle(struct ct_motion *m, ct_ex3 n, ct_ex3 across);

/// Two unit vectors that form a right-handed set with the unit vector n; coordinate axes where n is
/// one. value: values of all symbols, which decide the coordinate axis to start from.
void ct_axes_normal(struct ct_exs *x, ct_ex3 n, const double *value, ct_ex3 *e1, ct_ex3 *e2);

/// The choices of a WORD or WORDS key as n texts in arena a.
const char *const *ct_key_choices(struct ct_arena *a, const struct ct_key *key, size_t *n);

/// Keys that every joint has in addition to its own (from, to, initial, stiffness, damping, rest,
/// effort, motion); empty for other families.
const struct ct_key *ct_family_keys(enum ct_family family, int *nkey);

/// All classes in the order of components/meson.build.
extern const struct ct_component_class *const ct_component_classes[];
extern const int ct_ncomponent_class;
const struct ct_component_class *ct_component_find(enum ct_family family, const char *name);
/// The class of a component without `type`; NULL if this family needs one.
const struct ct_component_class *ct_component_standard(enum ct_family family);

#endif
