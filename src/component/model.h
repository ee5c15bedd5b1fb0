// src/component reads a YAML model into component instances. It declares all names first, then
// reads values as expressions in SI units and checks them by the key tables of the component
// classes (class.h). Each read_*.c file reads one section or one kind of value (read.h). The
// kinematics of joints are functions of the classes, in components/.
//
// This file: the model as read. Names are resolved and positions in the file are kept; no equations
// are derived yet.
//
//     frame 0 = ground ("ground"); each body owns the frame of its name; each point is one more
//
// What always holds after ct_model_read: every name is resolved, units are SI, and every value has
// the right dimension and count. The definition of a parameter uses only parameters before it (in
// the order of the file where that is possible); no definition is cyclic. Expressions live in
// model->x and contain symbols of kind TIME, PARAM and SIGNAL only (LOCAL too in custom joints).
#ifndef CT_COMPONENT_MODEL_H
#define CT_COMPONENT_MODEL_H

#include "base/names.h"
#include "component/beam.h"
#include "component/class.h"
#include "component/solid.h"

struct ct_node;

struct ct_frame {
    const char *name; // "crank", "crank.tip"
    struct ct_mark mark;
    int body;  // index; 0 is ground
    ct_ex3 at; // of a point: in axes of its body [m]; zero for a body's own frame
    int nturn;
    struct ct_turn *turn; // rotation from the body's axes to those of the point: R = R1 R2 ...
};

struct ct_body {
    struct ct_instance instance; // class rigid, particle or beam; ground has class NULL
    int frame;                   // index of the body's own frame
    ct_ex mass;                  // [kg]
    ct_ex3 com;                  // [m] in body axes
    ct_ex inertia[6]; // xx yy zz xy xz yz about the centre of mass, body axes [kg m^2]
    bool is_particle;
    const struct ct_beam *beam;   // NULL: not a beam
    const struct ct_solid *solid; // shapes for drawing
    size_t nsolid;
};

struct ct_parameter {
    const char *name;
    struct ct_mark mark;
    ct_ex symbol;     // CT_SYM_PARAM; its index is the index in model->parameter
    ct_ex definition; // uses parameters before it
    const char *unit; // unit in which it was given; NULL: none
    double value;
    bool is_input;  // set from outside, also during a run
    bool is_played; // a file gives its values: `played`
    ct_ex played;   // a function of time
};

/// A user-defined state, z' = rate: of a controller, an actuator, a filter.
struct ct_state {
    const char *name;
    struct ct_mark mark, rate_mark;
    ct_ex symbol;     // the SIGNAL symbol for it in expressions
    ct_ex rate;       // of time, signals and states
    ct_ex initial;    // of parameters
    const char *unit; // of the state; NULL: none was given
};

/// One entry of `outputs`: a signal, a vector signal (which becomes several columns) or an
/// expression.
struct ct_output {
    const char *name; // as written
    struct ct_mark mark;
    bool is_signal;
    ct_ex value; // SIGNAL symbol or expression
};

enum ct_rate_jumps { CT_RATE_IMPULSE, CT_RATE_CONTINUOUS };

struct ct_simulation {
    double duration; // [s]; 0 when none was given
    bool has_duration;
    long samples;       // at least 2 unless the duration is 0; both ends included; default 1001
    double interval;    // [s] if given in place of samples (which then follow from it), else 0
    double rtol, atol;  // `tolerance` (default 1e-8), `absolute` (default tolerance / 100)
    double step;        // fixed step [s]; 0: adaptive
    const char *method; // "auto"
    struct ct_mark method_mark;
    enum ct_rate_jumps rate_jumps;
    struct ct_value small; // names
    struct ct_mark mark;   // position of the key `simulation`; of the file when there is none
};

struct ct_model {
    struct ct_exs *x;
    const char *file; // as given on the command line
    const char *name, *description;
    ct_ex time;                  // the symbol t
    ct_ex3 gravity;              // [m/s^2]
    struct ct_mark gravity_mark; // position of its key; no file where it is not given
    struct ct_parameter *parameter;
    size_t nparameter, parameter_cap;
    struct ct_state *state;
    size_t nstate, state_cap;
    struct ct_frame *frame;
    size_t nframe, frame_cap;
    struct ct_body *body; // [0] is ground
    size_t nbody, body_cap;
    struct ct_instance *joint;
    size_t njoint, joint_cap;
    struct ct_instance *force;
    size_t nforce, force_cap;
    struct ct_output *output;
    size_t noutput, output_cap;
    struct ct_simulation simulation;
    unsigned char *decided; // by symbol: a count (structure) depends on it; NULL: none does
    double *value;          // by number of symbol: t (0) and the parameters
    struct ct_names parameter_index, state_index; // names -> indices
    struct ct_names frame_index, body_index, joint_index, force_index;
};

/// An override from the command line: "NAME=VALUE", where the value is an expression or a quantity;
/// or a CSV file with values of inputs.
struct ct_set {
    const char *text;
    enum ct_set_kind {
        CT_SET_VALUE,
        CT_SET_INPUTS,      // linear interpolation between rows
        CT_SET_INPUTS_HELD, // piecewise constant: a row is valid from its time on
        CT_SET_OUTPUT       // an additional output NAME=EXPRESSION, after those of the file
    } kind;
};

/// Read, check and resolve a model file. Reports all problems that it can find in one pass, in the
/// order of the file. Table files are looked up relative to the model. Errors: all E1xx, E002 for
/// the file itself, E003 for overrides. Cost: linear in the file.
bool ct_model_read(struct ct_ctx *ctx, const char *path, const struct ct_set *set, size_t nset,
                   struct ct_model *m);
/// As ct_model_read for n bytes of text; `file` is its name in positions, and table files are
/// looked up relative to it.
bool ct_model_parse(struct ct_ctx *ctx, const char *file, const char *text, size_t n,
                    const struct ct_set *set, size_t nset, struct ct_model *m);
/// As ct_model_read for a parsed document (io/yaml.h), which must outlive the model.
bool ct_model_resolve(struct ct_ctx *ctx, const char *file, const struct ct_node *root,
                      const struct ct_set *set, size_t nset, struct ct_model *m);

/// Override the number of elements (> 0) and the formulation (not NULL) of all beams. False with an
/// error if there is no such formulation, or no beam.  Errors: E003.
bool ct_model_change_beams(struct ct_ctx *ctx, struct ct_model *m, long elements,
                           const char *formulation);

/// Value of an expression of parameters; NaN if it contains other symbols.
double ct_model_number(const struct ct_model *m, ct_ex e);

int ct_model_find_joint(const struct ct_model *m, const char *name);
int ct_model_find_frame(const struct ct_model *m, const char *name);
int ct_model_find_body(const struct ct_model *m, const char *name);
int ct_model_find_force(const struct ct_model *m, const char *name);

#endif
