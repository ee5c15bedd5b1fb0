// See evaluator.h: memories.
#include "solve/evaluator/evaluator.h"

#include <math.h>
#include <string.h>

void ct_quaternion_of(const double *R, double *p)
{
    const double square[4] = {1 + R[0] + R[4] + R[8], 1 + R[0] - R[4] - R[8],
                              1 - R[0] + R[4] - R[8], 1 - R[0] - R[4] + R[8]};
    int k = 0;
    for (int i = 1; i < 4; i++)
        if (square[i] > square[k])
            k = i;
    const double s = 0.5 / sqrt(square[k]);
    const double skew[3] = {R[5] - R[7], R[6] - R[2], R[1] - R[3]};
    const double sum[3] = {R[5] + R[7], R[6] + R[2], R[1] + R[3]}; // yz, zx, xy
    p[k] = square[k] * s;
    if (k == 0) {
        for (int i = 0; i < 3; i++)
            p[1 + i] = skew[i] * s;
    } else {
        p[0] = skew[k - 1] * s;
        for (int i = 0; i < 3; i++)
            if (i != k - 1)
                p[1 + i] = sum[3 - (k - 1) - i] * s;
    }
    if (p[0] < 0)
        for (int i = 0; i < 4; i++)
            p[i] = -p[i];
}

void ct_memory_start(struct ct_evaluator *m)
{
    double *memory = m->input + m->at_memory;
    if (m->whole_turns.nout)
        ct_program_run(&m->whole_turns, m->input);
    for (size_t i = 0, k = 0; i < m->e->nmemory; i++)
        if (m->e->memory[i].kind == CT_MEMORY_TURNS)
            memory[i] = m->whole_turns.out[k++];
    ct_program_run(&m->memory, m->input);
    const double *R = m->memory.out + m->e->nmemory;
    for (size_t i = 0; i < m->e->nmemory; i++) {
        if (m->e->memory[i].kind != CT_MEMORY_QUATERNION) {
            memory[i] = m->memory.out[i];
        } else {
            if (m->e->memory[i].index == 0)
                ct_quaternion_of(R, memory + i);
            R += 9;
        }
    }
}

void ct_memory_update(struct ct_evaluator *m)
{
    double *memory = m->input + m->at_memory;
    if (!m->e->nmemory)
        return;
    ct_program_run(&m->memory, m->input);
    for (size_t i = 0; i < m->e->nmemory; i++) {
        if (ct_memory_is_updated(&m->e->memory[i]))
            memory[i] = m->memory.out[i];
        if (m->e->memory[i].kind == CT_MEMORY_QUATERNION && m->e->memory[i].index == 3)
            ct_quaternion_normalise(memory + i - 3);
    }
}

bool ct_memory_limits(const struct ct_equations *e)
{
    for (size_t i = 0; i < e->nmemory; i++)
        if (ct_memory_limits_steps(&e->memory[i]))
            return true;
    return false;
}

double ct_memory_angle_rate(struct ct_evaluator *m, double t, const double *y, double dt)
{
    const size_t n = m->e->nmemory;
    double most = 0, *now = m->turned;
    if (!ct_memory_limits(m->e))
        return 0;
    memcpy(m->ahead, y, (m->nq + m->nu) * sizeof *y);
    ct_evaluator_set(m, t, m->ahead);
    ct_program_run(&m->memory, m->input);
    memcpy(now, m->memory.out, n * sizeof *now);
    for (size_t i = 0; i < m->nu; i++)
        m->moved[i] = dt * y[m->nq + i];
    ct_evaluator_retract(m, m->ahead, m->moved);
    ct_evaluator_set(m, t + dt, m->ahead);
    ct_program_run(&m->memory, m->input);
    for (size_t i = 0; i < n; i++) {
        const bool is_half = m->e->memory[i].kind == CT_MEMORY_QUATERNION;
        if (ct_memory_limits_steps(&m->e->memory[i]))
            most = fmax(most, (is_half ? 2 : 1) * fabs(m->memory.out[i] - now[i]) / dt);
    }
    return most;
}
