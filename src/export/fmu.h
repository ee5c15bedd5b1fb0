// A model as an FMU, from inside: what its files share.
//
//     fmu.c                the whole: files and archive
//     fmu_variables.c      names, units and references
//     fmu_dependencies.c   on what derivatives and outputs depend; their derivatives along a direction
//     fmu_description.c    modelDescription.xml
//     compiler.c           the binary
#ifndef CT_EXPORT_FMU_H
#define CT_EXPORT_FMU_H

#include "export/exported.h"

enum ct_fmu_role {
    CT_FMU_TIME,
    CT_FMU_PARAMETER,
    CT_FMU_DERIVED,  // parameter that follows from others
    CT_FMU_CONSTANT, // parameter that has decided about the equations
    CT_FMU_INPUT,
    CT_FMU_STATE,
    CT_FMU_DERIVATIVE,
    CT_FMU_OUTPUT,
    CT_FMU_ROOT
};

struct ct_fmu_variable {
    const char *name, *unit; // unit NULL: not known
    enum ct_fmu_role role;
    size_t reference; // index in `in`, or behind it (codegen/export_fmu.c)
    double start;     // of all but derivatives, outputs and roots
    bool is_output;   // a state that is an output as well
    size_t state;     // derivatives: which variable's they are
    const bool *on;   // by index in `in`: what it depends on; NULL: not asked for
};

struct ct_fmu {
    struct ct_exported *w;
    int version; // of FMI
    struct ct_export_fmu source;
    struct ct_fmu_variable *variable;
    size_t nvariable, cap;
    size_t nstate; // q, u and the work where something does work
    size_t first_derivative, first_output, first_root;
};

/// All variables, with what they depend on.
void ct_fmu_list_variables(struct ct_fmu *f);
/// on of derivatives, outputs, roots and derived parameters: states, inputs, raw parameters and the time (0).
void ct_fmu_find_dependencies(struct ct_fmu *f);
/// Programs of source: derivatives along a direction.
void ct_fmu_list_directions(struct ct_fmu *f);
/// modelDescription.xml; buildDescription.xml of FMI 3.0. They live in the arena of f->w->ctx.
const char *ct_fmu_description(struct ct_fmu *f);
const char *ct_fmu_build_description(struct ct_fmu *f);

/// Write an FMU. Errors: E002, E405, E560. Warning: E561 where there is no binary in it.
bool ct_fmu_write(struct ct_exported *w, int version, const char *path);

struct ct_compiled {
    const unsigned char *b; // NULL: there is none
    size_t n;
    const char *why_not;
};
/// fmu.c beside NAME.c and NAME.h as a shared library, by the system's cc. All lives in a.
struct ct_compiled ct_compile_library(struct ct_arena *a, const char *name, const char *header,
                                      const char *source, const char *fmu);

#endif
