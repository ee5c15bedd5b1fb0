// A run that is advanced call by call: each call integrates from the present state to a later time.
//
//     start -> to t1 -> to t2 -> [the owner changes state, parameters or time] -> start -> ...
// What always holds: programs, choices of rows and columns, sides of switches and the step size
// persist from call to call. Each call starts from the present state with new first derivatives,
// since inputs may have changed. Memory of a call is reused by the next one. Errors are controlled
// in the states; there are no samples.
#ifndef CT_SOLVE_ADVANCE_H
#define CT_SOLVE_ADVANCE_H

#include "solve/run/run.h"

struct ct_advance;

/// For a run that has begun (ct_run_begin), with the method and the tolerances of o. Everything
/// lives in a, but for the memory of calls, which lives in arenas under it.
struct ct_advance *ct_advance_create(struct ct_arena *a, struct ct_run *r,
                                     const struct ct_run_options *o);
/// Start from another state at t, independent of earlier steps. y (ny): the state, q, u, work.
/// is_assembled: it is the state of ct_run_begin or ct_run_restart, at t = 0.
/// Errors: CT_E_STUCK, CT_E_SINGULAR, CT_E_STEP_OPEN, into the run's context.
bool ct_advance_start(struct ct_advance *s, double t, const double *y, bool is_assembled);
/// To be called after a change of parameters at t: determines the sides of switches and the time
/// events again. Errors: CT_E_STUCK, into the run's context.
bool ct_advance_refresh(struct ct_advance *s, double t);
/// Integrates from t0, the time of the state, exactly to t1 > t0. *t (out): the time that was
/// reached. False with a diagnostic in the context of the run or in `said`, whose texts live until
/// the next call.
bool ct_advance_to(struct ct_advance *s, double t0, double t1, double *t, struct ct_ctx **said);
/// The state, (ny).
double *ct_advance_state(struct ct_advance *s);
/// The next step of step control [s]; 0: not known yet.
double ct_advance_next_step(const struct ct_advance *s);
void ct_advance_set_next_step(struct ct_advance *s, double h);

#endif
