// The program.
#include <cotree/cotree.h>

#include <string.h>

int main(int argc, char **argv)
{
    (void)argc;
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = ct_system_load(ctx, argv[2], NULL);
    struct ct_sim *sim = ct_sim_create(ctx, sys, NULL);
    if (ct_sim_run(ctx, sim, &(struct ct_sim_results){.path = argv[4]}))
        ct_sim_print_summary(sim, stderr);
    if (sim)
        ct_sim_print_check(sim, stdout);
    if (sim)
        ct_sim_write_summary(ctx, sim, "-");
    ct_ctx_print_diagnostics(ctx, stderr);
    const int status = ct_ctx_fault(ctx);
    ct_sim_destroy(sim);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
    return status;
}
