// Functions shared by the parts of the reader. Each part calls only parts below it, except for
// tables in expressions:
//
//     read.c                                                      the file
//     read_parameter  read_state  read_body  read_joint  read_force  read_run   sections
//     read_beam  read_point  read_component                       parts of components
//     read_value  read_beam_value  read_field                     values by kind
//     read_expr <-> read_table                                    expressions, names, tables
//     read_node                                                   structure, keys, words
//
// What always holds: a function that returns false has reported an error. Reading then continues
// with the next value, so that one pass reports as many problems as possible.
#ifndef CT_COMPONENT_READ_H
#define CT_COMPONENT_READ_H

#include "component/model.h"
#include "io/yaml.h"

struct ct_reader {
    struct ct_ctx *ctx;
    struct ct_arena *a; // of the model
    struct ct_model *m;
    const struct ct_node *root;
    const struct ct_set *set; // overrides (nset)
    size_t nset;
    bool parameters_ok; // all have values; else checks that need a missing one are omitted
    const char **known; // names for suggestions: t and the parameters
    size_t nknown, known_cap;
    struct ct_names signal; // text -> node of its symbol
    const struct ct_instance
        *local_of; // custom joint whose coordinate names are visible, or NULL
    const char *const *local_name;
    const struct ct_instance *beam; // beam whose `length` and `x` are visible, or NULL
    ct_ex beam_x;
    // tables already read: their names ("file\ncolumn\nkind") -> number in the store
    struct ct_names table;
    struct ct_table *sampled; // the tables of the store, under construction
    // components by name, to find duplicates across sections
    struct ct_names component;
    struct ct_read_place {
        const char *sort; // "body", "joint", "force"
        struct ct_mark mark;
    } * place;
    size_t ncomponent, place_cap;
    unsigned flags; // CT_KEY_... of the value being read
    const struct ct_node **body_node, **joint_node, **force_node;
    size_t nbody_node, body_node_cap, njoint_node, joint_node_cap, nforce_node, force_node_cap;
    const struct ct_node **state_node;
    size_t nstate_node, state_node_cap;
};

// ---- keys and shapes ---------------------------------------------------------------------------

/// Check that the node is a map with keys of this list only. what: "joint 'a'", for messages.
bool ct_read_keys(struct ct_reader *r, const struct ct_node *node, const char *what,
                  const char *const *names, size_t n);
bool ct_read_shape(struct ct_reader *r, const struct ct_node *node, enum ct_node_kind kind,
                   const char *wanted);
/// Check that the node is a list with least..most entries.
bool ct_read_list(struct ct_reader *r, const struct ct_node *node, size_t least, size_t most,
                  const char *wanted);
/// Read one of n words; returns its index, or -1 after an error. what: "interpolation".
int ct_read_word(struct ct_reader *r, const struct ct_node *node, const char *what,
                 const char *const *names, size_t n);
bool ct_read_boolean(struct ct_reader *r, const struct ct_node *node, bool *value);
/// Read any text.
bool ct_read_text(struct ct_reader *r, const struct ct_node *node, const char **text);
/// Check that a name is an identifier that may name a component of this sort ("body").
bool ct_read_name(struct ct_reader *r, const char *name, struct ct_mark at, const char *sort);
/// Read the name of a body, joint or force: it must differ from all others.
bool ct_read_component_name(struct ct_reader *r, const struct ct_node_pair *p,
                            const char *sort);
/// False after many errors: a suggestion costs a pass over all names.
bool ct_read_wants_suggestions(const struct ct_reader *r);
/// "; did you mean 'x'?" or "".
const char *ct_read_suggestion(struct ct_reader *r, const char *name, const char *const *names,
                               size_t n);

// ---- values ------------------------------------------------------------------------------------

/// Read one expression; flags are CT_KEY_TIME, _STATE, _LOCAL; unit as in ct_key.
bool ct_read_expr(struct ct_reader *r, const struct ct_node *node, unsigned flags,
                  const char *unit, ct_ex *e);
/// The value of an expression. False, without an error, if it is unknown because a parameter is
/// wrong.
bool ct_read_number(struct ct_reader *r, ct_ex e, double *value);
/// Allocate n expressions and their marks, all zero.
void ct_read_alloc(struct ct_reader *r, struct ct_value *v, size_t n);
/// Read the entries of a list as expressions, each with the key's flags and unit.
bool ct_read_items(struct ct_reader *r, const struct ct_node *node, const struct ct_key *key,
                   struct ct_value *v);
bool ct_read_vec3(struct ct_reader *r, const struct ct_node *node, unsigned flags,
                  const char *unit, ct_ex3 *v, struct ct_mark at[3]);
bool ct_read_axis(struct ct_reader *r, const struct ct_node *node, ct_ex3 *axis);
bool ct_read_rotations(struct ct_reader *r, const struct ct_node *node, unsigned flags,
                       struct ct_turn **turn, size_t *nturn);
bool ct_read_frame(struct ct_reader *r, const struct ct_node *node, int *frame);
/// Read a value of any kind that does not depend on coordinate counts.
bool ct_read_value(struct ct_reader *r, const struct ct_node *node, const struct ct_key *key,
                   struct ct_value *value);
/// Read an integer of least..10000, which may be computed from parameters.
bool ct_read_count(struct ct_reader *r, const struct ct_node *node, const char *name,
                   long least, long *count);
/// Read ELEMENTS, ROTARY and RAYLEIGH values.
bool ct_read_beam_value(struct ct_reader *r, const struct ct_node *node,
                        const struct ct_key *key, struct ct_value *v);
/// Read SHAPES and FIELDS (read_field.c), and check those of a beam against its frame.
bool ct_read_fields(struct ct_reader *r, const struct ct_node *node, const struct ct_key *key,
                    struct ct_value *v);
bool ct_fill_fields(struct ct_reader *r, const struct ct_instance *self, struct ct_beam *beam);
/// Read the `shape` of a body, if given, into b->solid.
bool ct_read_solids(struct ct_reader *r, struct ct_body *b, const struct ct_node *node);
/// Path of a file that the model names, relative to the model.
const char *ct_read_path_beside(struct ct_reader *r, const char *file);
/// Read {table:, column:, interpolate:, unit:, scale:}; wanted: a unit of the value's dimension,
/// NULL: any.
bool ct_read_table(struct ct_reader *r, const struct ct_node *node, const char *wanted,
                   ct_ex *e);
/// Read a CSV file: its columns become functions of time for the inputs of their names. Errors:
/// E134, E135, E412, E119.
bool ct_read_played_inputs(struct ct_reader *r, const char *path, bool holds);
/// [rad] Larger angles without a unit give a warning: E152.
extern const double ct_read_full_turn;

// ---- components --------------------------------------------------------------------------------

/// The class named by `type`, or the standard class of the family without it; NULL after an error.
const struct ct_component_class *ct_read_class(struct ct_reader *r, enum ct_family family,
                                               const struct ct_node_pair *p, const char *sort);
/// Allocate the values of all keys, none given.
void ct_read_alloc_values(struct ct_reader *r, struct ct_instance *self);
/// Check the keys of a component: unknown keys and missing required keys are errors. use_family:
/// the family's keys are allowed.
bool ct_read_component_keys(struct ct_reader *r, const struct ct_instance *self,
                            const struct ct_node *node, const char *sort, bool use_family);
/// Read the class's own keys, in the order of its table.
bool ct_read_own_values(struct ct_reader *r, struct ct_instance *self,
                        const struct ct_node *node);

// ---- sections: `declare` makes names known, `fill` reads values --------------------------------

void ct_read_parameters(struct ct_reader *r, const struct ct_set *set, size_t nset);
/// Append a separately given unit to a number that has none of its own.
const struct ct_node *ct_read_with_unit(struct ct_reader *r, const struct ct_node *number,
                                        const struct ct_node *unit);
void ct_read_states_declare(struct ct_reader *r);
void ct_read_states_fill(struct ct_reader *r);
void ct_read_bodies_declare(struct ct_reader *r);
void ct_read_bodies_fill(struct ct_reader *r);
/// Read a beam without its points; b->instance has its class. Fills b->beam, b->mass.
bool ct_read_beam(struct ct_reader *r, struct ct_body *b, const struct ct_node *node);
/// Read the points of a body; `length` is visible in those of a beam while r->beam is set.
bool ct_read_points(struct ct_reader *r, const struct ct_body *b, const struct ct_node *node);
void ct_read_joints_declare(struct ct_reader *r);
void ct_read_joints_fill(struct ct_reader *r);
void ct_read_forces_declare(struct ct_reader *r);
void ct_read_forces_fill(struct ct_reader *r);
void ct_read_outputs(struct ct_reader *r);
void ct_read_simulation(struct ct_reader *r);
/// Index of the joint of this name; -1 after an error at the mark.
int ct_read_joint_name(struct ct_reader *r, const char *name, struct ct_mark at);

#endif
