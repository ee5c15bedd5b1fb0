// Copy initial conditions into the state of an evaluator; see assembly.h.
#include "solve/initial/assembly.h"
#include "formulate/beam/flexible_body.h"
#include "solve/evaluator/switch_state.h"

#include <string.h>

void ct_initial_state_of_beams(const struct ct_equations *e, const double *value, double *q,
                               double *u)
{
    for (size_t i = 0; i < e->build->nflexible; i++) {
        const struct ct_flexible *f = &e->build->flexible[i];
        for (int j = 0; j < f->nelastic && f->beam->nstart; j++) {
            if (q)
                q[f->elastic[j].q] = ct_ex_value(e->x, f->elastic[j].start, value);
            if (u)
                u[f->elastic[j].u] = ct_ex_value(e->x, f->elastic[j].start_rate, value);
        }
    }
}

// States of the model's differential equations, which are not constrained.
static void start_states(const struct ct_model *model, const struct ct_equations *e, double *u)
{
    for (size_t i = 0; i < e->nstate; i++)
        u[e->nmotion + i] = ct_model_number(model, model->state[i].initial);
}

void ct_initial_state_apply(const struct ct_initial_state *s, struct ct_evaluator *m, double *y)
{
    const struct ct_equations *e = m->e;
    double *memory = m->input + m->at_memory;
    memset(y, 0, (m->nq + m->nu + 1) * sizeof *y);
    for (size_t i = 0; i < s->n; i++) {
        const struct ct_coordinate *c = &e->coordinate[i];
        const struct ct_edge_info *edge = &e->build->topology->edge[c->edge];
        if (c->q >= 0)
            y[c->q] = s->q[i];
        if (c->u >= 0)
            y[m->nq + (size_t)c->u] = s->u[i];
        for (size_t k = 0; k < e->nmemory; k++)
            if (e->memory[k].kind == CT_MEMORY_ANGLE && edge->kind == CT_EDGE_JOINT
                && edge->index == e->memory[k].joint && c->index == e->memory[k].index)
                memory[k] = s->q[i];
    }
    ct_initial_state_of_beams(e, m->model->value, s->elastic ? NULL : y, y + m->nq);
    for (size_t i = 0, k = 0; s->elastic && i < e->build->nflexible; i++)
        for (int j = 0; j < e->build->flexible[i].nelastic; j++, k++) {
            const struct ct_elastic *c = &e->build->flexible[i].elastic[j];
            y[c->q] = s->elastic[k];
            if (s->elastic_rate)
                y[m->nq + (size_t)c->u] = s->elastic_rate[k];
        }
    start_states(m->model, e, y + m->nq);
    ct_evaluator_normalise(m, y);
    ct_evaluator_set(m, 0, y);
    ct_switches_start(m, 0, y, NULL, NULL);
    ct_memory_start(m);
    if (s->is_inexact)
        ct_evaluator_set_inexact(m, s->freedoms);
}
