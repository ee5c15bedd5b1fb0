// A mechanism through the library as a user runs it: model text -> start and accelerations at t =
// 0.
#ifndef CT_TEST_ORACLE_ENGINE_H
#define CT_TEST_ORACLE_ENGINE_H

#include "tests/property/oracle/oracle.h"

/// How the library is asked.
struct way {
    const char *name, *tree;
    bool keep_all;
};

struct answer {
    bool ok; // did it assemble and give accelerations?
    long freedoms;
    struct motion at, a; // state and accelerations
    char message[600];   // the first diagnostics
};

void engine_ask(const struct scene *s, const struct way *way, struct answer *out);

#endif
