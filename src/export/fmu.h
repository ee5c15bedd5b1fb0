// Export of a model as an FMU: what its files share.
//
//     fmu.c                files and archive
//     fmu_variables.c      names, units and references
//     fmu_dependencies.c   dependencies of derivatives and outputs; directional derivatives
//     fmu_description.c    modelDescription.xml
//     compiler.c           the binary
#ifndef CT_EXPORT_FMU_H
#define CT_EXPORT_FMU_H

#include "export/exported.h"

enum ct_fmu_role {
    CT_FMU_TIME,
    CT_FMU_PARAMETER,
    CT_FMU_DERIVED,  // parameter defined by others
    CT_FMU_CONSTANT, // parameter that has determined the form of the equations
    CT_FMU_INPUT,
    CT_FMU_STATE,
    CT_FMU_DERIVATIVE,
    CT_FMU_OUTPUT,
    CT_FMU_ROOT
};

struct ct_fmu_variable {
    const char *name, *unit; // unit NULL: not known
    enum ct_fmu_role role;
    size_t reference; // index in `in`, or behind its end (codegen/export_fmu.c)
    double start;     // start value; not for derivatives, outputs and roots
    bool is_output;   // a state that is also an output
    size_t state;     // of a derivative: index of its state variable
    const bool *on;   // by index in `in`: depends on it; NULL: not computed
};

struct ct_fmu {
    struct ct_exported *w;
    int version; // of FMI
    struct ct_export_fmu source;
    struct ct_fmu_variable *variable;
    size_t nvariable, cap;
    size_t nstate; // q, u and, if used, work
    size_t first_derivative, first_output, first_root;
};

/// Lists all variables and their dependencies.
void ct_fmu_list_variables(struct ct_fmu *f);
/// Sets `on` of derivatives, outputs, roots and derived parameters: which states, inputs,
/// settable parameters and time (index 0) they depend on.
void ct_fmu_find_dependencies(struct ct_fmu *f);
/// Makes the programs for directional derivatives.
void ct_fmu_list_directions(struct ct_fmu *f);
/// modelDescription.xml, and buildDescription.xml of FMI 3.0. They live in the arena of
/// f->w->ctx.
const char *ct_fmu_description(struct ct_fmu *f);
const char *ct_fmu_build_description(struct ct_fmu *f);

/// Writes an FMU. Errors: E002, E405, E560. Warning: E561 if it contains no binary.
bool ct_fmu_write(struct ct_exported *w, int version, const char *path);

struct ct_compiled {
    const unsigned char *b; // NULL: no library
    size_t n;
    const char *why_not;
};
/// Compiles fmu.c, NAME.c and NAME.h to a shared library by the system's cc. All lives in a.
struct ct_compiled ct_compile_library(struct ct_arena *a, const char *name, const char *header,
                                      const char *source, const char *fmu);

#endif
