// Signals: names of the format (section 6) turned into expressions.
//
// Here are those that follow from places, velocities and loads: a force may depend on them. Those
// that follow from forces - reactions, efforts of drivers, energies, what a beam transmits, how
// good a linear beam is - are recognised here and derived in outputs/.
#ifndef CT_FORMULATE_SIGNALS_SIGNAL_H
#define CT_FORMULATE_SIGNALS_SIGNAL_H

#include "formulate/build.h"

/// Signals that follow from forces, and what `number` of them is.
enum ct_dynamic_signal {
    CT_DYNAMIC_NONE,
    CT_DYNAMIC_DRIVER,    // effort of a driven coordinate: the coordinate
    CT_DYNAMIC_REACTION,  // force or torque of a joint: the joint
    CT_DYNAMIC_ENERGY,    // kinetic, potential, strain, work, total: which of them
    CT_DYNAMIC_BEAM_LOAD, // force or moment in a beam: the frame
    CT_DYNAMIC_VALIDITY,  // of a linear beam: its body
};

/// A name taken apart: "rod.tip.velocity.x in crank" is owner "rod.tip", property "velocity",
/// component "x", axes "crank".
struct ct_signal {
    const char *name;
    struct ct_mark mark;
    const char *owner, *property, *component, *axes;
    enum ct_dynamic_signal dynamic;
    int number;
};

/// One scalar signal, taken apart in *s. out: its expression, zero where s->dynamic says that it
/// follows from forces. False with a diagnostic at mark if there is no such signal.
bool ct_signal_resolve(struct ct_build *b, const char *name, struct ct_mark mark,
                       struct ct_signal *s, ct_ex *out);
/// Components a name without one stands for (".x", ".y", ".z"); NULL-terminated, or NULL for a
/// scalar signal.
const char *const *ct_signal_components(struct ct_build *b, const char *name);

/// The component of v, in axes of ground, that the signal asks for, in the axes that it asks for.
bool ct_signal_component(struct ct_build *b, const struct ct_signal *s, ct_ex3 v, ct_ex *out);
/// Number of the signal's component, 0 to 2; -1 if it is none of x, y, z.
int ct_signal_component_index(const struct ct_signal *s);
/// Has the signal, which is one number, neither component nor axes?  Errors: CT_E_SIGNAL.
bool ct_signal_is_number(struct ct_build *b, const struct ct_signal *s);
/// The error of a signal that does not exist; always false.
bool ct_signal_unknown(struct ct_build *b, const struct ct_signal *s, const char *why);

enum { CT_MOST_SIGNALS = 32 }; // Limit: replaced at a time; more take another pass

/// Signals in an expression of the model, no more than CT_MOST_SIGNALS. Returns their number.
size_t ct_signals_list(struct ct_build *b, ct_ex e, ct_ex signal[CT_MOST_SIGNALS]);
/// An expression of a force or a joint with its signals replaced and its comparisons held.
ct_ex ct_build_value(struct ct_build *b, ct_ex e);

#endif
