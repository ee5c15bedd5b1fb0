// This folder writes results: tables (CSV, JSON, NumPy, MATLAB), plots, the JSON Schema of
// models, and the derivation of the equations as text, LaTeX, HTML, C and JSON.
//
// This header prints the derivation, in stages from the terminal equations of the components to
// the reduced equations of motion.
//
//     terminal   the equations of each component
//     graph      the connections of components
//     tree       the choice of coordinates, with the reason
//     cutset     balances of force and torque, one per branch
//     circuit    loop closures, one per chord
//     reduced    M u' = Q + J' lam, one equation per unknown speed; the constraints
//
// What always holds: the same model, trees and format give the same bytes. The printed
// expressions equal those of struct ct_equations up to round-off.
#ifndef CT_REPORT_EQUATIONS_PRINT_H
#define CT_REPORT_EQUATIONS_PRINT_H

#include "formulate/equations.h"

#include <stdio.h>

enum {
    CT_STAGE_TERMINAL = 1,
    // Definition: bits of the stages
    CT_STAGE_GRAPH = 2,
    CT_STAGE_TREE = 4,
    CT_STAGE_CUTSET = 8,
    CT_STAGE_CIRCUIT = 16,
    CT_STAGE_REDUCED = 32,
    CT_STAGE_ALL = 63,
    CT_STAGE_DEFAULT = CT_STAGE_TREE | CT_STAGE_REDUCED
};

enum ct_equations_format {
    CT_FORMAT_TEXT,
    CT_FORMAT_LATEX,
    CT_FORMAT_HTML,
    CT_FORMAT_C,
    CT_FORMAT_JSON
};

/// Prints the stages in their order. C prints only the reduced equations. New nodes are made in
/// e->x; texts and workspace live in scratch. is_full: long lists, and the lists of systems of
/// more than CT_MOST_MATRIX_SPEEDS speeds, are not shortened. Cost: bounded for large systems,
/// whose expressions are printed by definitions instead of collected. False: writing to the
/// stream failed.
bool ct_equations_print(FILE *out, struct ct_arena *scratch, struct ct_equations *e,
                        const struct ct_model *m, unsigned stages,
                        enum ct_equations_format format, bool is_full);

/// Returns the bit of a stage by its name ("tree"), "all" for all; 0 for other names.
unsigned ct_stage_find(const char *name, size_t length);
/// Finds the format by its name; false if there is none.
bool ct_equations_format_find(const char *name, enum ct_equations_format *format);

#endif
