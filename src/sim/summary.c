// See summary.h.
#include "sim/summary.h"

#include "formulate/beam/flexible_body.h"

long ct_tape_count_all(const struct ct_tape_counts *c)
{
    return c->multiplications + c->additions + c->divisions + c->functions;
}

long ct_sim_operations(const struct ct_sim *sim)
{
    const struct ct_evaluator *m = ct_run_evaluator(sim->run);
    if (m->solved.nout) {
        const struct ct_tape_counts all = m->solved.listing->counts;
        return ct_tape_count_all(&all);
    }
    const struct ct_partition *partition = ct_run_partition(sim->run);
    if (partition->nsolver)
        return (long)partition->solver[0]->operations;
    const struct ct_tape_counts c = m->motion.listing->counts;
    return ct_tape_count_all(&c) + (long)ct_partition_operations(partition);
}

const char *ct_sim_solver(const struct ct_sim *sim)
{
    const struct ct_partition *partition = ct_run_partition(sim->run);
    return !partition->m->nu         ? "none"
         : partition->m->solved.nout ? "unrolled"
         : partition->nsolver        ? partition->solver[0]->kind->name
                                     : "dense";
}

long ct_sim_freedoms(const struct ct_sim *sim)
{
    return (long)sim->system->equations.nmotion - sim->report.rank;
}

long ct_sim_redundant(const struct ct_sim *sim)
{
    return (long)sim->system->equations.nrow - sim->report.rank;
}

bool ct_is_arm(const struct ct_equations *e, int edge)
{
    return e->build->topology->edge[edge].kind == CT_EDGE_ARM;
}

bool ct_is_first_of_joint(const struct ct_equations *e, const bool *row, size_t i)
{
    for (size_t k = 0; k < i && e->row[i].joint >= 0; k++)
        if (row[k] && e->row[k].joint == e->row[i].joint)
            return false;
    return row[i];
}

const char *ct_row_owner(const struct ct_sim *sim, size_t row)
{
    const struct ct_row *r = &sim->system->equations.row[row];
    return r->joint < 0 ? r->name : sim->system->model.joint[r->joint].name;
}

const struct ct_formulation_name ct_formulation_names[CT_NFORMULATION]
    = {{"embedding", "coordinate partitioning"},
       {"cutsets", "cutset sums"},
       {"composite", "composite bodies"},
       {"articulated", "articulated bodies"}};
