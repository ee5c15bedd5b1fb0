// Finds which components the parts of a page belong to: the values of the attribute
// data-component.
//
// The names are those of bodies, joints, forces, frames, parameters and arms, and `ground`,
// `gravity`, `system`; several names are separated by blanks. They are identifiers of the
// model; those of frames contain a dot.
#ifndef CT_HTML_COMPONENTS_H
#define CT_HTML_COMPONENTS_H

#include "system.h"

/// Components of an edge or a node of the linear graph; for arms and frames also their body.
const char *ct_components_of_edge(struct ct_arena *a, const struct ct_system *sys, int edge);
const char *ct_components_of_node(struct ct_arena *a, const struct ct_system *sys, int node);
/// Components whose names occur in a text such as an expression; "system" for quantities of the
/// whole system.
const char *ct_components_in_text(struct ct_arena *a, const struct ct_model *m,
                                  const char *text, size_t n);
/// Components on which an output depends.
const char *ct_components_of_result(struct ct_arena *a, const struct ct_system *sys,
                                    size_t result);

/// Lines of the model file that define a component: the line of its key and the lines that
/// belong to it. For an output: its lines, with the components on which it depends.
struct ct_component_lines {
    const char *name; // several: separated by blanks
    int first, last;  // from 0
};
/// Finds all of them in n lines of text; *count (out).
struct ct_component_lines *ct_components_find_lines(struct ct_arena *a,
                                                    const struct ct_system *sys,
                                                    const char *const *line, size_t n,
                                                    size_t *count);

#endif
