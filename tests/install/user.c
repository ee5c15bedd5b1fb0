// A program of somebody else's: how long the pendulum of a file takes for a swing, beside the exact
// period.
#include <cotree/cotree.h>
#include <math.h>
#include <stdio.h>

// From rest at -pi/2: the period is 4 K(1/2) sqrt(l/g), by the arithmetic-geometric mean.
static double period(double length, double gravity)
{
    double a = 1, b = sqrt(0.5);
    int i;
    for (i = 0; i < 6; i++) {
        const double mean = (a + b) / 2;
        b = sqrt(a * b);
        a = mean;
    }
    return 2 * 3.14159265358979323846 / a * sqrt(length / gravity);
}

static bool swing(struct ct_ctx *ctx, struct ct_system *sys)
{
    struct ct_sim_options options = {0};
    struct ct_sim *sim;
    double angle;
    options.until = period(1, 9.81);
    options.samples = 2;
    options.tolerance = 1e-10;
    sim = ct_sim_create(ctx, sys, &options);
    if (!sim || !ct_sim_run(ctx, sim, NULL))
        return false;
    angle = ct_sim_value(sim, "pivot.q");
    printf("back at %.6f\n", angle);
    ct_sim_destroy(sim);
    return fabs(angle + 3.14159265358979323846 / 2) < 1e-8;
}

int main(int argc, char **argv)
{
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = ctx && argc > 1 ? ct_system_load(ctx, argv[1], NULL) : NULL;
    const bool ok = sys && swing(ctx, sys);
    if (ctx)
        ct_ctx_print_diagnostics(ctx, stderr);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
    return ok ? 0 : 1;
}
