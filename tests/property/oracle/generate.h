// Random mechanisms that close by construction: bodies get poses, then joints get their frames
// where they meet.
//
// Axes and places of joints are shared on purpose - parallel, on one line, through one point, in
// one plane - so that joints repeat what others impose. What the joints leave free is not decided
// here: the solver's singular values say it. A draw is kept if they have a clear gap and if the
// mechanism moves on with the same rank, so that nothing hangs on a singular configuration.
#ifndef CT_TEST_ORACLE_GENERATE_H
#define CT_TEST_ORACLE_GENERATE_H

#include "tests/property/oracle/scene.h"

#include <stdint.h>

enum kind {
    KIND_PAIRS, // two or three joints between two bodies, which all allow one motion
    KIND_LOOPS, // loops that share axes and places
    KIND_PLAIN, // open trees and loops in general position
    KINDS
};

/// The mechanism of a seed: the same on every machine. digits: of its numbers.
/// The scene's freedoms, by the solver, go to *freedoms.
void scene_generate(struct scene *s, enum kind kind, uint64_t seed, int digits, int *freedoms);

#endif
