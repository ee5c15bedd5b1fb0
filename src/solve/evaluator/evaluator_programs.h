// Programs of an evaluator, for the files of this folder: evaluator_programs.c compiles them from
// the equations, evaluator.c runs them.
#ifndef CT_SOLVE_EVALUATOR_EVALUATOR_PROGRAMS_H
#define CT_SOLVE_EVALUATOR_EVALUATOR_PROGRAMS_H

#include "solve/evaluator/evaluator.h"

/// Compiles all programs of an evaluator whose input exists.
void ct_programs_compile(struct ct_arena *a, struct ct_evaluator *m);

/// Runs native code, or the tape if that is NULL. Their work arrays differ; a tape is made only
/// when it is run.
void ct_program_use(struct ct_arena *a, struct ct_program *p, struct ct_native *native);
/// Selects native code if the evaluator asks for it; false if it is not available.
bool ct_program_choose(struct ct_arena *a, struct ct_evaluator *m, struct ct_program *p);

#endif
