// A system as source code in a folder, from inside: what its files share.
//
//     exported.c          entry points, programs, files
//     exported_items.c    names and units of the numbers
//     exported_values.c   values and a motion to compare with
//     exported_json.c     NAME.json
#ifndef CT_EXPORT_EXPORTED_H
#define CT_EXPORT_EXPORTED_H

#include "codegen/export.h"
#include "live/live.h"

// Limit: of the states that a test program compares
enum { CT_EXPORT_STATES = 4 };

struct ct_exported {
    struct ct_ctx *ctx; // the run's
    struct ct_sim *sim;
    const char *place; // a folder, or the file of an FMU
    unsigned lanes;
    struct ct_export x;
    struct ct_program reaction; // to be evaluated
    struct ct_export_state state[CT_EXPORT_STATES];
};

/// The lists of items of x.
void ct_exported_list_items(struct ct_exported *w, const struct ct_result *reaction);
/// States to compare with. Errors: E405 where the start is singular.
bool ct_exported_record_states(struct ct_exported *w);
/// A motion to compare with, x.run; none where a method of a fixed step finds none.
void ct_exported_record_motion(struct ct_exported *w);
void ct_exported_write_json(struct ct_exported *w, FILE *out);

#endif
