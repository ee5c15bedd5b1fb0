// A parameter study: which parameters vary and what they are in each member.
//
//     grid      NAME=FROM:TO:N        N equal steps apart, both ends included; the last axis runs fastest
//     sample    NAME=FROM:TO          uniform
//               NAME=normal:MEAN:DEVIATION
//     members   the rows of a table, its columns are parameters
//
// A shard I of N is every N-th member, beginning with the I-th: costs that change along an axis are shared evenly.
//
// Samples are numbers of SplitMix64 (Steele, Lea and Flood (2014), key steele2014) in the order in which they
// are needed: two for each axis, axis after axis, member after member, u = (number >> 11) / 2^53. Uniform:
// FROM + u1 (TO - FROM). Normal: MEAN + DEVIATION sqrt(-2 log(1 - u1)) cos(2 pi u2).
//
// What always holds: a member's values depend on the study and its place alone, so that members can be made in any
// order; at the ends of an axis they are FROM and TO to the last bit.
#ifndef CT_PLAN_H
#define CT_PLAN_H

#include "component/model.h"

#include <stdint.h>

// Limit: with a message
enum { CT_MOST_MEMBERS = 100000000 };

struct ct_axis {
    const char *name;
    const char *text; // as given
    enum { CT_AXIS_RANGE, CT_AXIS_NORMAL, CT_AXIS_LIST } kind;
    double from, to;     // or mean and deviation
    const double *value; // of a list  (n)
    long n;              // steps of a grid, rows of a list; 0: not given
};

struct ct_plan {
    struct ct_axis *axis;
    size_t naxis;
    long nall;          // members
    long shard, nshard; // the part that is run, from 1; 0: all
    long nmember;       // members that are run
    bool is_sampled;
    uint64_t seed;
    const char *file; // of members; NULL: none
};

/// Read `vary` (n texts); sample > 0: so many random members, else a grid. m: the model, for the names. Errors: E003.
bool ct_plan_read(struct ct_ctx *ctx, const struct ct_model *m, const char *const *vary,
                  size_t n, long sample, uint64_t seed, struct ct_plan *out);
/// Members from a table of parameters. Errors: E003 for the file and its columns, E135.
bool ct_plan_read_members(struct ct_ctx *ctx, const struct ct_model *m, const char *path,
                          struct ct_plan *out);
/// Either, for the library: members NULL: by `vary`. Errors: E003, too, where both are given.
bool ct_plan_choose(struct ct_ctx *ctx, const struct ct_model *m, const char *members,
                    const char *const *vary, size_t n, long sample, uint64_t seed,
                    struct ct_plan *out);
/// The texts NAME=VALUE of the axes with these values (naxis) behind others; *n (inout): of them, of all.
const char **ct_plan_settings(struct ct_arena *a, const struct ct_plan *s, const double *value,
                              const char *const *set, size_t *n);
/// Keep to shard `shard` (from 1) of nshard; 0, 0: all. Errors: E003.
bool ct_plan_take_shard(struct ct_ctx *ctx, struct ct_plan *s, long shard, long nshard);
/// Number of a member that is run (from 0) among all, from 1.
long ct_plan_number(const struct ct_plan *s, long member);
/// Value of axis i in a member that is run (from 0).
double ct_plan_value(const struct ct_plan *s, long member, size_t i);

#endif
