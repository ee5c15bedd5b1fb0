// This folder exports a model as C source code or as an FMU (Functional Mock-up Unit). This
// header is what the files for C source share; fmu.h is for FMUs.
//
//     exported.c          entry points, programs, files
//     exported_items.c    names and units of the numbers
//     exported_values.c   values and a motion for the comparison test
//     exported_json.c     NAME.json
#ifndef CT_EXPORT_EXPORTED_H
#define CT_EXPORT_EXPORTED_H

#include "codegen/export.h"
#include "live/live.h"

// Limit: number of states that a test program compares.
enum { CT_EXPORT_STATES = 4 };

struct ct_exported {
    struct ct_ctx *ctx; // context of the run
    struct ct_sim *sim;
    const char *place; // a folder, or the file of an FMU
    unsigned lanes;
    struct ct_export x;
    struct ct_program reaction; // program to be evaluated here
    struct ct_export_state state[CT_EXPORT_STATES];
};

/// Fills the lists of items of x.
void ct_exported_list_items(struct ct_exported *w, const struct ct_result *reaction);
/// Records states for comparison. Errors: E405 if the start is singular.
bool ct_exported_record_states(struct ct_exported *w);
/// Records a motion for comparison in x.run; none if a method of fixed step fails.
void ct_exported_record_motion(struct ct_exported *w);
void ct_exported_write_json(struct ct_exported *w, FILE *out);

#endif
