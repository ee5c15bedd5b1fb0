// slider-crank: M u' = Q + J' lam, Phi = 0, J u' + gam = 0
//
// M (2 x 2) and J (1 x 2) are column-major; entries that are always zero are not written.
// mode: 0 or 1, the sides of comparisons (0); kept: values of the last step (0).
#include <math.h>

void slider_crank_equations(double t, const double *q, const double *u, const double *mode,
    const double *kept, double *M, double *Q, double *J, double *Phi, double *gam);

void slider_crank_equations(double t, const double *q, const double *u, const double *mode,
    const double *kept, double *M, double *Q, double *J, double *Phi, double *gam)
{
    (void)t, (void)q, (void)u, (void)mode, (void)kept;
    (void)M, (void)Q, (void)J, (void)Phi, (void)gam;

    // parameters
    const double r = 0.152;
    const double l = 0.30399999999999999;
    const double m1 = 0.34999999999999998;
    const double J1 = 0.00069999999999999999;
    const double m2 = 0.69999999999999996;
    const double J2 = 0.0054999999999999997;
    const double m3 = 0.5;
    const double torque = 0.5;

    // unknowns
    const double main_q = q[0];
    const double small_end_q = q[1];
    const double main_u = u[0];
    const double small_end_u = u[1];

    // mass matrix
    M[0 + 2 * 0] = J1 + ((r * r) * (m3 + (m2 + (0.25 * m1))));
    M[1 + 2 * 0] = -(cos((main_q + small_end_q)) * (l * (r * (m3 + (0.5 * m2)))));
    M[0 + 2 * 1] = M[1 + 2 * 0];
    M[1 + 2 * 1] = J2 + ((l * l) * (m3 + (0.25 * m2)));

    // forces
    Q[0] = torque - (sin((main_q + small_end_q)) * (l * ((small_end_u * small_end_u) * (r * (m3 + (0.5 * m2))))));
    Q[1] = -(sin((main_q + small_end_q)) * (l * ((main_u * main_u) * (r * (m3 + (0.5 * m2))))));

    // constraints
    J[0 + 1 * 0] = r * cos(main_q);
    J[0 + 1 * 1] = -(l * cos(small_end_q));
    Phi[0] = (r * sin(main_q)) - (l * sin(small_end_q));
    gam[0] = ((l * sin(small_end_q)) * (small_end_u * small_end_u)) - ((r * sin(main_q)) * (main_u * main_u));
}
