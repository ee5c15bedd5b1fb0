// The programs of a machine from inside: program.c makes them from the equations, machine.c has them run.
#ifndef CT_SOLVE_PROGRAM_H
#define CT_SOLVE_PROGRAM_H

#include "solve/machine.h"

/// All of a machine whose input is there.
void ct_programs_compile(struct ct_arena *a, struct ct_machine *m);

/// Native code, or the tape where that is NULL. The two keep different things in the work array; a tape is made only where
/// it is run.
void ct_program_use(struct ct_arena *a, struct ct_program *p, struct ct_native *native);
/// Native code where the machine wants it and it is available; false if it is not available.
bool ct_program_choose(struct ct_arena *a, struct ct_machine *m, struct ct_program *p);

#endif
