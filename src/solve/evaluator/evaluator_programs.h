// The programs of an evaluator from inside: evaluator_programs.c makes them from the equations,
// evaluator.c has them run.
#ifndef CT_SOLVE_EVALUATOR_EVALUATOR_PROGRAMS_H
#define CT_SOLVE_EVALUATOR_EVALUATOR_PROGRAMS_H

#include "solve/evaluator/evaluator.h"

/// All of an evaluator whose input is there.
void ct_programs_compile(struct ct_arena *a, struct ct_evaluator *m);

/// Native code, or the tape where that is NULL. The two keep different things in the work array; a
/// tape is made only where it is run.
void ct_program_use(struct ct_arena *a, struct ct_program *p, struct ct_native *native);
/// Native code where the evaluator wants it and it is available; false if it is not available.
bool ct_program_choose(struct ct_arena *a, struct ct_evaluator *m, struct ct_program *p);

#endif
