// Which components parts of the page belong to: the names of data-component.
//
// Names are those of bodies, joints, forces, frames, parameters and arms, and `ground`, `gravity`, `system`; several are separated by
// blanks. They are identifiers of the model, with a dot in those of frames.
#ifndef CT_HTML_COMPONENTS_H
#define CT_HTML_COMPONENTS_H

#include "system.h"

/// Of an edge and of a node of the linear graph: of arms and frames also their body.
const char *ct_components_of_edge(struct ct_arena *a, const struct ct_system *sys, int edge);
const char *ct_components_of_node(struct ct_arena *a, const struct ct_system *sys, int node);
/// Those whose names stand in a text, as in an expression; "system" for quantities of the whole system.
const char *ct_components_in_text(struct ct_arena *a, const struct ct_model *m,
                                  const char *text, size_t n);
/// Those that an output depends on.
const char *ct_components_of_result(struct ct_arena *a, const struct ct_system *sys,
                                    size_t result);

/// Lines of the model file that a component is written in: the line of its key, and those that belong to it; and of an
/// output, with the components that it depends on.
struct ct_component_lines {
    const char *name; // several: separated by blanks
    int first, last;  // from 0
};
/// All of them, for n lines of text; *count (out).
struct ct_component_lines *ct_components_find_lines(struct ct_arena *a,
                                                    const struct ct_system *sys,
                                                    const char *const *line, size_t n,
                                                    size_t *count);

#endif
