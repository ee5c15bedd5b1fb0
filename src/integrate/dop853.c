// Dormand-Prince 8(5,3): twelve stages a step and three more for dense output of order 7. The error
// estimate combines two embedded solutions, of order 5 and 3: with E5 and E3 their differences to
// the step, |E5|^2 / sqrt(|E5|^2 + 0.01 |E3|^2) behaves as h^8. With t = theta and s = 1 - theta
// the interpolant is
//
//     y(t + theta h) = Hermite(theta) + t^2 s^2 (F_0 + t (F_1 + s (F_2 + t F_3))),
//     F_j = h sum_i D_ji k_i
//
// Source: Dormand and Prince's method as in Hairer, Norsett and Wanner (1993), II.5, II.6 and
// II.10, key hairer1993. The tables fulfil all 200 order conditions up to order 8 (step) and all
// 85 up to order 7 (interpolant) to the 28 digits that are published. In double precision the step
// would miss those of low order by up to 4.6e-16, the same at each step: a vibration loses 7.8e-16
// (omega h)^2 of its energy (8.30). So 31 coefficients differ by some units in the last place,
// written out as powers of two, from what is published: with them the 37 conditions up to order 6,
// each over the symmetry of its tree, are met to 1.1e-18. Found by lattice reduction.
#include "integrate/stepper.h"

// Definition: of the method.
enum { STAGES = 13, ALL_STAGES = 16, CORRECTIONS = 4 };

static const double C[ALL_STAGES] = {
    0,
    0.0526001519587677318785587544488, // (12 - 2 sqrt 6) / 135
    0.0789002279381515978178381316732, // (6 - sqrt 6) / 45
    0.118350341907227396726757197510,  // (6 - sqrt 6) / 30
    0.281649658092772603273242802490,  // (6 + sqrt 6) / 30
    1. / 3,
    1. / 4,
    4. / 13,
    127. / 195,
    3. / 5,
    6. / 7,
    1,
    1,
    1. / 10,
    1. / 5,
    7. / 9,
};

static const double A[ALL_STAGES][ALL_STAGES] = {
    [1] = {0.0526001519587677318785587544488},
    [2] = {0.0197250569845378994544595329183, 0.0591751709536136983633785987549},
    [3] = {0.0295875854768068491816892993775 - 11 * 0x1p-58, 0,
           0.0887627564304205475450678981324 - 0x1p-55},
    [4]
    = {0.241365134159266685502369798665 + 0x1p-54, 0,
       -0.884549479328286085344864962717 + 0x1p-53, 0.924834003261792003115737966543 + 0x1p-53},
    [5] = {1. / 27 + 25 * 0x1p-57, 0, 0, 0.170828608729473871279604482173 + 0x1p-55,
           0.125467687566822425016691814123},
    [6] = {0.037109375 - 25 * 0x1p-57, 0, 0, 0.170252211019544039314978060272 + 3 * 0x1p-54,
           0.0602165389804559606850219397283 + 5 * 0x1p-56, -0.017578125 + 0x1p-55},
    [7] = {0.0370920001185047927108779319836 + 13 * 0x1p-57, 0, 0,
           0.170383925712239993810214054705 - 0x1p-55,
           0.107262030446373284651809199168 + 3 * 0x1p-55,
           -0.0153194377486244017527936158236 - 43 * 0x1p-59,
           0.00827378916381402288758473766002 + 61 * 0x1p-59},
    [8] = {0.624110958716075717114429577812 + 0x1p-53, 0, 0, -3.36089262944694129406857109825,
           -0.868219346841726006818189891453 - 0x1p-52, 27.5920996994467083049415600797,
           20.1540675504778934086186788979, -43.4898841810699588477366255144},
    [9] = {0.477662536438264365890433908527 + 0x1p-52, 0, 0,
           -2.48811461997166764192642586468 + 0x1p-51,
           -0.590290826836842996371446475743 + 3 * 0x1p-52, 21.2300514481811942347288949897,
           15.2792336328824235832596922938, -33.2882109689848629194453265587,
           -0.0203312017085086261358222928593 + 33 * 0x1p-57},
    [10]
    = {-0.93714243008598732571704021658 - 3 * 0x1p-53, 0, 0, 5.18637242884406370830023853209,
       1.09143734899672957818500254654 - 0x1p-52, -8.14978701074692612513997267357,
       -18.5200656599969598641566180701, 22.7394870993505042818970056734,
       2.49360555267965238987089396762, -3.0467644718982195003823669022},
    [11] = {2.27331014751653820792359768449, 0, 0, -10.5344954667372501984066689879,
            -2.00087205822486249909675718444 - 0x1p-51, -17.9589318631187989172765950534,
            27.9488845294199600508499808837, -2.85899827713502369474065508674 - 0x1p-51,
            -8.87285693353062954433549289258, 12.3605671757943030647266201528,
            0.643392746015763530355970484046 - 0x1p-52},
    // the step itself: its weights, and stage 12 = f(t + h, y1)
    [12] = {0.0542937341165687622380535766363 + 5 * 0x1p-56, 0, 0, 0, 0,
            4.45031289275240888144113950566, 1.89151789931450038304281599044,
            -5.8012039600105847814672114227, 0.31116436695781989440891606237 - 0x1p-54,
            -0.152160949662516078556178806805 - 5 * 0x1p-55, 0.201365400804030348374776537501,
            0.0447106157277725905176885569043 + 0x1p-54},
    // for dense output only
    [13] = {0.0561675022830479523392909219681, 0, 0, 0, 0, 0, 0.253500210216624811088794765333,
            -0.246239037470802489917441475441, -0.124191423263816360469010140626,
            0.15329179827876569731206322685, 0.00820105229563468988491666602057,
            0.00756789766054569976138603589584, -0.008298},
    [14] = {0.0318346481635021405060768473261, 0, 0, 0, 0, 0.0283009096723667755288322961402,
            0.0535419883074385676223797384372, -0.0549237485713909884646569340306, 0, 0,
            -0.000108347328697249322858509316994, 0.000382571090835658412954920192323,
            -0.000340465008687404560802977114492, 0.141312443674632500278074618366},
    [15] = {-0.428896301583791923408573538692, 0, 0, 0, 0, -4.69762141536116384314449447206,
            7.68342119606259904184240953878, 4.06898981839711007970213554331,
            0.356727187455281109270669543021, 0, 0, 0, -0.00139902416515901462129418009734,
            2.9475147891527723389556272149, -9.15095847217987001081870187138},
};

// y1 minus the embedded solution of order 5
static const double E5[STAGES - 1] = {
    0.01312004499419488073250102996,
    0,
    0,
    0,
    0,
    -1.225156446376204440720569753,
    -0.4957589496572501915214079952,
    1.664377182454986536961530415,
    -0.350328848749973681688648729,
    0.3341791187130174790297318841,
    0.08192320648511571246570742613,
    -0.02235530786388629525884427845,
};

// weights of the embedded solution of order 3
static const double B3[STAGES - 1] = {
    [0] = 31. / 127,
    [8] = 0.733846688281611857341361741547,
    [11] = 3. / 136,
};

static const double D[CORRECTIONS][ALL_STAGES] = {
    {-8.4289382761090128651353491142, 0, 0, 0, 0, 0.5667149535193777696253178359,
     -3.0689499459498916912797304727, 2.384667656512069828772814968,
     2.1170345824450282767155149946, -0.8713915837779729920678990749,
     2.240437430260788275854177165, 0.6315787787694688181557024929,
     -0.0889903364513333108206981174, 18.148505520854727256656404962,
     -9.1946323924783554000451984436, -4.4360363875948939664310572},
    {10.427508642579134603413151009, 0, 0, 0, 0, 242.28349177525818288430175319,
     165.20045171727028198505394887, -374.54675472269020279518312152,
     -22.113666853125306036270938578, 7.7334326684722638389603898808,
     -30.674084731089398182061213626, -9.3321305264302278729567221706,
     15.697238121770843886131091075, -31.139403219565177677282850411,
     -9.3529243588444783865713862664, 35.81684148639408375246589854},
    {19.985053242002433820987653617, 0, 0, 0, 0, -387.03730874935176555105901742,
     -189.17813819516756882830838328, 527.80815920542364900561016686,
     -11.573902539959630126141871134, 6.8812326946963000169666922661,
     -1.000605096691083840318386098, 0.7777137798053443209286926574,
     -2.7782057523535084065932004339, -60.196695231264120758267380846,
     84.320405506677161018159903784, 11.99229113618278932803513003},
    {-25.693933462703749003312586129, 0, 0, 0, 0, -154.18974869023643374053993627,
     -231.52937917604549567536039109, 357.6391179106141237828534991,
     93.405324183624310003907691704, -37.458323136451633156875139351,
     104.09964950896230045147246184, 29.840293426660503123344363579,
     -43.533456590011143754432175058, 96.3245539591882829483949506,
     -39.177261675615439165231486172, -149.72683625798562581422125276},
};

struct work {
    struct ct_compensation carry;
    double *k;     // (ny x 16)
    double *F;     // (ny x 4) of the interpolant
    double *spare; // two vectors (ny)
};

static void *create(struct ct_arena *a, const struct ct_method *method,
                    const struct ct_problem *p)
{
    (void)method;
    const size_t n = (size_t)p->ny;
    struct work *w = CT_NEW(a, struct work);
    *w = (struct work){.carry = ct_compensation_create(a, p->ny),
                       .k = CT_NEWN(a, double, ALL_STAGES *n),
                       .F = CT_NEWN(a, double, CORRECTIONS *n),
                       .spare = CT_NEWN(a, double, 2 * n)};
    return w;
}

// k_s for s from `first` to before `end`, the end of the step being w->spare.
static enum ct_eval stages(const struct ct_problem *p, double t, double h, const double *y,
                           int first, int end, struct work *w, struct ct_integrate_stats *stats)
{
    const int n = p->ny;
    for (int s = first; s < end; s++) {
        if (s == STAGES - 1)
            ct_stepper_advance(w->spare, y, h, A[s], w->k, s, &w->carry);
        else
            ct_stepper_combine(w->spare, y, h, A[s], w->k, s, n);
        const enum ct_eval e = ct_stepper_rhs(p, t + C[s] * h, w->spare, w->k + s * n, stats);
        if (e != CT_EVAL_OK)
            return e;
    }
    return CT_EVAL_OK;
}

// The error of order 5, smaller by as much as that of order 3 is larger.
static double estimate(const struct ct_problem *p, double t, double h, const double *y,
                       const double *y1, const struct ct_tolerance *tolerance,
                       const struct work *w)
{
    const int n = p->ny;
    double *e = w->spare, *y3 = e + n;
    ct_stepper_combine(e, NULL, h, E5, w->k, STAGES - 1, n);
    ct_stepper_subtract_roundoff(p, h, e);
    const double e5 = ct_stepper_norm(p, tolerance, y, y1, e);
    ct_stepper_combine(y3, y, h, B3, w->k, STAGES - 1, n);
    for (int i = 0; i < n; i++)
        y3[i] = y1[i] - y3[i];
    ct_stepper_subtract_roundoff(p, h, y3);
    const double joint = ct_stepper_join(e5, ct_stepper_norm(p, tolerance, y, y1, y3));
    if (e5 == 0 || !p->output_error)
        return joint;
    for (int i = 0; i < n; i++)
        e[i] *= joint / e5;
    return ct_stepper_error(p, tolerance, t + h, y, y1, e);
}

static enum ct_eval step(const struct ct_problem *p, double t, double h, const double *y,
                         const double *dy, const struct ct_tolerance *tolerance, double *y1,
                         double *dy1, double *err, void *work, struct ct_integrate_stats *stats)
{
    const int n = p->ny;
    struct work *w = work;
    ct_stepper_copy(w->k, dy, n);
    const enum ct_eval e = stages(p, t, h, y, 1, STAGES, w, stats);
    if (e != CT_EVAL_OK)
        return e;
    ct_stepper_copy(y1, w->spare, n);
    ct_stepper_copy(dy1, w->k + (STAGES - 1) * n, n);
    if (tolerance)
        *err = estimate(p, t, h, y, y1, tolerance, w);
    return CT_EVAL_OK;
}

static enum ct_eval prepare(const struct ct_problem *p, double t, double h, const double *y,
                            const double *y1, void *work, struct ct_integrate_stats *stats)
{
    (void)y1;
    const int n = p->ny;
    struct work *w = work;
    const enum ct_eval e = stages(p, t, h, y, STAGES, ALL_STAGES, w, stats);
    for (int j = 0; j < CORRECTIONS && e == CT_EVAL_OK; j++)
        ct_stepper_combine(w->F + j * n, NULL, h, D[j], w->k, ALL_STAGES, n);
    return e;
}

static void dense(const struct ct_problem *p, double h, double theta, const double *y,
                  const double *y1, void *work, double *out)
{
    const int n = p->ny;
    const double rest = 1 - theta, bubble = theta * theta * rest * rest;
    const struct work *w = work;
    const double *F = w->F;
    ct_stepper_hermite(out, theta, h, y, w->k, y1, w->k + (STAGES - 1) * n, n);
    for (int i = 0; i < n; i++) {
        const double inner = F[i + 2 * n] + theta * F[i + 3 * n];
        out[i] += bubble * (F[i] + theta * (F[i + n] + rest * inner));
    }
}

// Stages 11 and 12 are both at the end of the step.
static double stiffness_estimate(const struct ct_problem *p, double h, const double *y,
                                 const double *y1, void *work)
{
    enum { LAST = STAGES - 1, BEFORE = LAST - 1 };
    const int n = p->ny;
    struct work *w = work;
    ct_stepper_combine(w->spare, y, h, A[BEFORE], w->k, BEFORE, n);
    return ct_stepper_stiffness_estimate(p, h, y1, w->k + LAST * n, w->spare,
                                         w->k + BEFORE * n);
}

static const struct ct_tableau tableau = {.stages = STAGES,
                                          .stride = ALL_STAGES,
                                          .C = C,
                                          .A = &A[0][0],
                                          .E = E5,
                                          .B3 = B3,
                                          .nerror = STAGES - 1};

static const struct ct_dense_tableau dense_tableau = {.stages = ALL_STAGES,
                                                      .corrections = CORRECTIONS,
                                                      .stride = ALL_STAGES,
                                                      .C = C + STAGES,
                                                      .A = &A[STAGES][0],
                                                      .D = &D[0][0]};

const struct ct_method ct_method_dop853 = {
    .name = "dop853",
    .summary = "Dormand-Prince 8(5,3), explicit, for smooth motions and tight tolerances",
    .source = "hairer1993",
    .tableau = &tableau,
    .dense_tableau = &dense_tableau,
    .order = 8,
    .error_order = 7,
    // the two embedded solutions may agree by chance, so steps grow by this factor at most
    .most_growth = 1.5,
    .create = create,
    .restart = ct_compensation_restart,
    .accept = ct_compensation_accept,
    .step = step,
    // Derived: stable up to about 6. Steps that accuracy limits, at a tolerance of 1e-4, come
    // to 2.4
    // in a cart with a pendulum and in four-bar linkages.
    .resolved_limit = 2.5,
    // Derived: |R(z)| <= 1 for |z| <= 5.95 in the left half-plane. But on the real axis the error
    // estimate has its maximum at z = -4.95 and is zero at -5.65, so step size control alone would
    // go on to -6.4, where errors grow.
    .stability_limit = 4.8,
    .stiffness_estimate = stiffness_estimate,
    .prepare = prepare,
    .dense = dense,
};
