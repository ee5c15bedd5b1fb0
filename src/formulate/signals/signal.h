// Signals. This folder turns signal names of the model (format, section 6) into expressions.
//
// It derives signals of positions, velocities and loads, on which forces may depend. Signals that
// need the dynamics are only recognised here and derived in outputs/: reactions, efforts of
// drivers, energies, loads in beams, validity of linear beams.
#ifndef CT_FORMULATE_SIGNALS_SIGNAL_H
#define CT_FORMULATE_SIGNALS_SIGNAL_H

#include "formulate/build.h"

/// Kinds of signals that need the dynamics, and the meaning of their `number`.
enum ct_dynamic_signal {
    CT_DYNAMIC_NONE,
    CT_DYNAMIC_DRIVER,    // effort of a driven coordinate: the coordinate
    CT_DYNAMIC_REACTION,  // force or torque of a joint: the joint
    CT_DYNAMIC_ENERGY,    // kinetic, potential, strain, work, total: which of them
    CT_DYNAMIC_BEAM_LOAD, // force or moment in a beam: the frame
    CT_DYNAMIC_VALIDITY,  // of a linear beam: its body
};

/// A parsed name: "rod.tip.velocity.x in crank" is owner "rod.tip", property "velocity",
/// component "x", axes "crank".
struct ct_signal {
    const char *name;
    struct ct_mark mark;
    const char *owner, *property, *component, *axes;
    enum ct_dynamic_signal dynamic;
    int number;
};

/// Parses a scalar signal into *s. out: its expression; zero if s->dynamic says that it needs the
/// dynamics. False with a diagnostic at mark if there is no such signal.
bool ct_signal_resolve(struct ct_build *b, const char *name, struct ct_mark mark,
                       struct ct_signal *s, ct_ex *out);
/// Components of a vector signal without component (".x", ".y", ".z"), NULL-terminated; NULL for a
/// scalar signal.
const char *const *ct_signal_components(struct ct_build *b, const char *name);

/// The component of v that the signal names, in the axes that it names. v: ground components.
bool ct_signal_component(struct ct_build *b, const struct ct_signal *s, ct_ex3 v, ct_ex *out);
/// Number of the signal's component, 0 to 2; -1 if it is none of x, y, z.
int ct_signal_component_index(const struct ct_signal *s);
/// Does a scalar signal have neither component nor axes?  Errors: CT_E_SIGNAL.
bool ct_signal_is_number(struct ct_build *b, const struct ct_signal *s);
/// Reports a signal that does not exist; returns false.
bool ct_signal_unknown(struct ct_build *b, const struct ct_signal *s, const char *why);

enum { CT_MOST_SIGNALS = 32 }; // Limit: signals replaced in one pass; more need another pass

/// Signals in an expression of the model, no more than CT_MOST_SIGNALS. Returns their number.
size_t ct_signals_list(struct ct_build *b, ct_ex e, ct_ex signal[CT_MOST_SIGNALS]);
/// An expression of a force or a joint with its signals and comparisons replaced.
ct_ex ct_build_value(struct ct_build *b, ct_ex e);

#endif
