// A parameter study: which parameters vary and what they are in each member.
//
//     grid      NAME=FROM:TO:N        N equal steps, both ends included; last axis fastest
//     sample    NAME=FROM:TO          uniform
//               NAME=normal:MEAN:DEVIATION
//     members   the rows of a table, its columns are parameters
//
// Shard I of N consists of every N-th member, beginning with the I-th. Costs that change along
// an axis are thus shared evenly.
//
// Samples use random numbers of SplitMix64 (Steele, Lea and Flood (2014), key steele2014): two
// for each axis, axis after axis, member after member, u = (number >> 11) / 2^53. Uniform: FROM
// + u1 (TO - FROM). Normal: MEAN + DEVIATION sqrt(-2 log(1 - u1)) cos(2 pi u2).
//
// What always holds: the values of a member depend only on the study and the member's number,
// so that members can be made in any order. At the ends of an axis they are exactly FROM and
// TO.
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
    long shard, nshard; // the shard that is run, from 1; 0: all members
    long nmember;       // members that are run
    bool is_sampled;
    uint64_t seed;
    const char *file; // of members; NULL: none
};

/// Reads `vary` (n texts). sample > 0: number of random members; else a grid. m: the model with
/// the parameters' names. Errors: E003.
bool ct_plan_read(struct ct_ctx *ctx, const struct ct_model *m, const char *const *vary,
                  size_t n, long sample, uint64_t seed, struct ct_plan *out);
/// Reads the members from a table of parameters. Errors: E003 for the file and its columns,
/// E135.
bool ct_plan_read_members(struct ct_ctx *ctx, const struct ct_model *m, const char *path,
                          struct ct_plan *out);
/// Reads either; members NULL: by `vary`. Errors: E003, also if both are given.
bool ct_plan_choose(struct ct_ctx *ctx, const struct ct_model *m, const char *members,
                    const char *const *vary, size_t n, long sample, uint64_t seed,
                    struct ct_plan *out);
/// Appends the texts NAME=VALUE of the axes with these values (naxis) to others; *n (inout):
/// number of texts before and after.
const char **ct_plan_settings(struct ct_arena *a, const struct ct_plan *s, const double *value,
                              const char *const *set, size_t *n);
/// Restricts the plan to shard `shard` (from 1) of nshard; 0, 0: all members. Errors: E003.
bool ct_plan_take_shard(struct ct_ctx *ctx, struct ct_plan *s, long shard, long nshard);
/// Number, from 1, among all members of the member with index `member` among those that are
/// run.
long ct_plan_number(const struct ct_plan *s, long member);
/// Value of axis i in member `member` (from 0) of those that are run.
double ct_plan_value(const struct ct_plan *s, long member, size_t i);

#endif
