// Runtime functions of exported C; see export.h.
//
//     accelerations   [M -J'; J 0] [u'; lam] = [Q; -gam], by the pivots of the start or by
//                     elimination with complete pivoting
//     multipliers     least norm of J' lam = M u' - Q, by QR with column pivoting
//     projection      Newton's method with corrections of least norm, J d = -phi, then J du = -v
//     step            classical Runge-Kutta, then projection; a step in which a switch changes
//                     ends just after the change, and another step follows
//
// Templates of C: @ stands for the model's name, $ for the same in capitals.
#include "codegen/export.h"
#include "codegen/export_text.h"

#include "expr/print.h"

// ---- solving ----------------------------------------------------------------------------------

static const char text_helpers[] = "static void copy(double *to, const double *from, int n)\n"
                                   "{\n"
                                   "    int i;\n"
                                   "    for (i = 0; i < n; i++)\n"
                                   "        to[i] = from[i];\n"
                                   "}\n"
                                   "\n"
                                   "static int are_finite(const double *v, int n)\n"
                                   "{\n"
                                   "    int i;\n"
                                   "    for (i = 0; i < n; i++)\n"
                                   "        if (!isfinite(v[i]))\n"
                                   "            return 0;\n"
                                   "    return 1;\n"
                                   "}\n"
                                   "\n"
                                   "static double largest(const double *v, int n)\n"
                                   "{\n"
                                   "    double most = 0;\n"
                                   "    int i;\n"
                                   "    for (i = 0; i < n; i++)\n"
                                   "        if (!(fabs(v[i]) <= most))\n"
                                   "            most = fabs(v[i]);\n"
                                   "    return most;\n"
                                   "}\n"
                                   "\n";

static const char text_fixed[]
    = "static int fixed_pivots(const double *in, double *a, double *rate, double *out)\n"
      "{\n"
      "    const double *const inertia = out + $_NU + $_NQ, *const pivot = inertia + n_free;\n"
      "    int i;\n"
      "    @_solved(in, out);\n"
      "    for (i = 0; i < n_free; i++)\n"
      "        if (!(inertia[i] > 0))\n"
      "            return 0;\n"
      "    for (i = 0; i < n_pivot; i++)\n"
      "        if (!(fabs(pivot[i]) * scale[i] > weakest))\n"
      "            return 0;\n"
      "    if (!are_finite(out, $_NU))\n"
      "        return 0;\n"
      "    copy(a, out, $_NU);\n"
      "    copy(rate, out + $_NU, $_NQ);\n"
      "    return rank_fixed;\n"
      "}\n"
      "\n";

static const char text_nofixed[]
    = "static int fixed_pivots(const double *in, double *a, double *rate, double *out)\n"
      "{\n"
      "    (void)in;\n"
      "    (void)a;\n"
      "    (void)rate;\n"
      "    (void)out;\n"
      "    return 0;\n"
      "}\n"
      "\n";

static const char text_exact[] = "static int takes_part(int row)\n"
                                 "{\n"
                                 "    (void)row;\n"
                                 "    return 1;\n"
                                 "}\n"
                                 "\n"
                                 "static void close_within_data(double *out)\n"
                                 "{\n"
                                 "    (void)out;\n"
                                 "}\n"
                                 "\n";

static const char text_inexact[]
    = "/* Data close to their tolerance only: rows keep what they leave open at the start; "
      "those that depend on others take no part. */\n"
      "static int takes_part(int row)\n"
      "{\n"
      "    return !left_out[row];\n"
      "}\n"
      "\n"
      "static void close_within_data(double *out)\n"
      "{\n"
      "    int k;\n"
      "    for (k = 0; k < $_NROW; k++) {\n"
      "        out[$_OUT_PHI + k] = left_out[k] ? 0 : out[$_OUT_PHI + k] - open[k];\n"
      "        out[$_OUT_V + k] = left_out[k] ? 0 : out[$_OUT_V + k];\n"
      "    }\n"
      "    for (k = 0; k < $_NJ; k++)\n"
      "        if (left_out[@_J_row[k]])\n"
      "            out[$_OUT_J2 + k] = 0;\n"
      "}\n"
      "\n";

static const char text_solver[]
    = "enum { n_system = $_NU + $_NROW };\n"
      "\n"
      "/* K x = b by elimination with complete pivoting; K (n_system rows of n_system + 1, b "
      "behind each row) is\n"
      " * destroyed. Unknowns that the equations leave open, as multipliers of redundant rows, "
      "are zero. Returns the rank. */\n"
      "static int eliminate(double *K, double *x)\n"
      "{\n"
      "    enum { n = n_system, m = n_system + 1 };\n"
      "    double greatest = 0;\n"
      "    int row[m], column[m], i, j, rank;\n"
      "    for (i = 0; i < n; i++) {\n"
      "        row[i] = column[i] = i;\n"
      "        x[i] = 0;\n"
      "    }\n"
      "    for (rank = 0; rank < n; rank++) {\n"
      "        int r = rank, c = rank, keep;\n"
      "        double pivot = 0;\n"
      "        for (i = rank; i < n; i++)\n"
      "            for (j = rank; j < n; j++)\n"
      "                if (fabs(K[row[i] * m + column[j]]) > pivot) {\n"
      "                    pivot = fabs(K[row[i] * m + column[j]]);\n"
      "                    r = i;\n"
      "                    c = j;\n"
      "                }\n"
      "        greatest = pivot > greatest ? pivot : greatest;\n"
      "        if (!(pivot > 1e-12 * greatest)) /* round-off of n eliminations */\n"
      "            break;\n"
      "        keep = row[r], row[r] = row[rank], row[rank] = keep;\n"
      "        keep = column[c], column[c] = column[rank], column[rank] = keep;\n"
      "        for (i = rank + 1; i < n; i++) {\n"
      "            double *const to = K + row[i] * m, *const from = K + row[rank] * m;\n"
      "            const double f = to[column[rank]] / from[column[rank]];\n"
      "            if (!(fabs(f) > 0))\n"
      "                continue;\n"
      "            for (j = rank; j < n; j++)\n"
      "                to[column[j]] -= f * from[column[j]];\n"
      "            to[n] -= f * from[n];\n"
      "        }\n"
      "    }\n"
      "    for (i = rank; i-- > 0;) {\n"
      "        double s = K[row[i] * m + n];\n"
      "        for (j = i + 1; j < rank; j++)\n"
      "            s -= K[row[i] * m + column[j]] * x[column[j]];\n"
      "        x[column[i]] = s / K[row[i] * m + column[i]];\n"
      "    }\n"
      "    return rank;\n"
      "}\n"
      "\n"
      "/* K = [M -J'; J 0] from the outputs of motion; where rows are redundant those alone "
      "that are kept, unless all are wanted: off\n"
      " * the constraints the others contradict them. */\n"
      "static void put_matrices(const double *out, double *K, int all)\n"
      "{\n"
      "    enum { m = n_system + 1 };\n"
      "    int k;\n"
      "    for (k = 0; k < n_system * m; k++)\n"
      "        K[k] = 0;\n"
      "    for (k = 0; k < $_NM; k++) {\n"
      "        K[@_M_row[k] * m + @_M_column[k]] = out[$_OUT_M + k];\n"
      "        K[@_M_column[k] * m + @_M_row[k]] = out[$_OUT_M + k];\n"
      "    }\n"
      "    for (k = 0; k < $_NJ; k++)\n"
      "        if (takes_part(@_J_row[k]) && (all || is_kept[@_J_row[k]])) {\n"
      "            K[($_NU + @_J_row[k]) * m + @_J_column[k]] = out[$_OUT_J + k];\n"
      "            K[@_J_column[k] * m + $_NU + @_J_row[k]] = -out[$_OUT_J + k];\n"
      "        }\n"
      "}\n"
      "\n"
      "/* u' and q'; work: n_accelerate doubles. Returns the rank of the equations for u' and "
      "lam. */\n"
      "static int accelerate(const double *in, double *a, double *rate, double *work)\n"
      "{\n"
      "    enum { n = n_system, m = n_system + 1 };\n"
      "    double *const out = work, *const K = work + $_NMOTION, *const x = K + n * m;\n"
      "    int all, k, rank = fixed_pivots(in, a, rate, work);\n"
      "    if (rank)\n"
      "        return rank;\n"
      "    @_motion(in, out);\n"
      "    for (all = 0; all < 2 && rank < $_NU + n_kept; all++) {\n"
      "        put_matrices(out, K, all);\n"
      "        for (k = 0; k < $_NU; k++)\n"
      "            K[k * m + n] = out[$_OUT_Q + k];\n"
      "        for (k = 0; k < $_NROW; k++)\n"
      "            K[($_NU + k) * m + n] = takes_part(k) && (all || is_kept[k]) ? "
      "-out[$_OUT_GAM + k] : 0;\n"
      "        rank = eliminate(K, x);\n"
      "    }\n"
      "    copy(a, x, $_NU);\n"
      "    copy(rate, out + $_OUT_RATE, $_NQ);\n"
      "    return rank;\n"
      "}\n"
      "\n"
      "int @_accelerations(const double *in, double *a, double *work)\n"
      "{\n"
      "    return accelerate(in, a, work + n_accelerate, work);\n"
      "}\n"
      "\n";

static const char text_least[]
    = "/* x (m), the one of least norm with A' x = b (n), by a QR factorisation of A (m x n, "
      "column-major, destroyed) with column\n"
      " * pivoting; columns that depend on others to 1e-9 take no part. work: 2 n doubles. */\n"
      "static void least_norm(double *A, int m, int n, const double *b, double *x, double "
      "*work)\n"
      "{\n"
      "    double *const diagonal = work, *const scale = work + n;\n"
      "    double first = 0;\n"
      "    enum { most = ($_NU > $_NROW ? $_NU : $_NROW) + 1 };\n"
      "    int column[most], i, j, k, rank;\n"
      "    for (j = 0; j < most; j++)\n"
      "        column[j] = j;\n"
      "    for (rank = 0; rank < m && rank < n; rank++) {\n"
      "        double norm = 0, *v;\n"
      "        int best = rank, keep;\n"
      "        for (j = rank; j < n; j++) {\n"
      "            double square = 0;\n"
      "            for (i = rank; i < m; i++)\n"
      "                square += A[i + m * column[j]] * A[i + m * column[j]];\n"
      "            if (square > norm) {\n"
      "                norm = square;\n"
      "                best = j;\n"
      "            }\n"
      "        }\n"
      "        norm = sqrt(norm);\n"
      "        first = norm > first ? norm : first;\n"
      "        if (!(norm > 1e-9 * first))\n"
      "            break;\n"
      "        keep = column[best], column[best] = column[rank], column[rank] = keep;\n"
      "        v = A + m * column[rank];\n"
      "        diagonal[rank] = v[rank] > 0 ? -norm : norm;\n"
      "        v[rank] -= diagonal[rank];\n"
      "        scale[rank] = -1 / (diagonal[rank] * v[rank]); /* 2 / v'v */\n"
      "        for (j = rank + 1; j < n; j++) {\n"
      "            double *const to = A + m * column[j], sum = 0;\n"
      "            for (i = rank; i < m; i++)\n"
      "                sum += v[i] * to[i];\n"
      "            for (i = rank; i < m; i++)\n"
      "                to[i] -= scale[rank] * sum * v[i];\n"
      "        }\n"
      "    }\n"
      "    for (i = 0; i < m; i++)\n"
      "        x[i] = 0;\n"
      "    for (k = 0; k < rank; k++) {\n"
      "        double s = b[column[k]];\n"
      "        for (j = 0; j < k; j++)\n"
      "            s -= A[j + m * column[k]] * x[j];\n"
      "        x[k] = s / diagonal[k];\n"
      "    }\n"
      "    for (k = rank; k-- > 0;) {\n"
      "        const double *const v = A + m * column[k];\n"
      "        double sum = 0;\n"
      "        for (i = k; i < m; i++)\n"
      "            sum += v[i] * x[i];\n"
      "        for (i = k; i < m; i++)\n"
      "            x[i] -= scale[k] * sum * v[i];\n"
      "    }\n"
      "}\n"
      "\n";

static const char text_multipliers[]
    = "/* M u' - Q = J' lam, lam of least norm; u' is in `in`. work: n_multipliers doubles. "
      "*/\n"
      "static int find_multipliers(const double *in, double *lam, double *work)\n"
      "{\n"
      "    double *const out = work, *const r = out + $_NMOTION, *const J = r + $_NU, *const "
      "rest = J + $_NROW * $_NU;\n"
      "    const double *const a = in + $_A;\n"
      "    int k;\n"
      "    @_motion(in, out);\n"
      "    for (k = 0; k < $_NU; k++)\n"
      "        r[k] = -out[$_OUT_Q + k];\n"
      "    for (k = 0; k < $_NM; k++) {\n"
      "        const int i = @_M_row[k], j = @_M_column[k];\n"
      "        r[i] += out[$_OUT_M + k] * a[j];\n"
      "        if (i != j)\n"
      "            r[j] += out[$_OUT_M + k] * a[i];\n"
      "    }\n"
      "    for (k = 0; k < $_NROW * $_NU; k++)\n"
      "        J[k] = 0;\n"
      "    for (k = 0; k < $_NJ; k++)\n"
      "        if (takes_part(@_J_row[k]))\n"
      "            J[@_J_row[k] + $_NROW * @_J_column[k]] = out[$_OUT_J + k];\n"
      "    least_norm(J, $_NROW, $_NU, r, lam, rest);\n"
      "    return !are_finite(lam, $_NROW);\n"
      "}\n"
      "\n";

// ---- projection -------------------------------------------------------------------------------

static const char text_noquaternions[] = "static void normalise(double *q)\n"
                                         "{\n"
                                         "    (void)q;\n"
                                         "}\n"
                                         "\n"
                                         "/* q moved by d in the speeds. */\n"
                                         "static void retract(double *q, const double *d)\n"
                                         "{\n"
                                         "    int i;\n"
                                         "    for (i = 0; i < n_motion; i++)\n"
                                         "        q[place[i]] += d[i];\n"
                                         "}\n"
                                         "\n";

static const char text_quaternions[]
    = "static void normalise(double *q)\n"
      "{\n"
      "    int i, k;\n"
      "    for (i = 0; i < n_motion; i++)\n"
      "        if (place[i] < 0) {\n"
      "            double *const p = q - 1 - place[i];\n"
      "            const double norm = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * "
      "p[3]);\n"
      "            for (k = 0; k < 4 && norm > 0; k++)\n"
      "                p[k] /= norm;\n"
      "            i += 2;\n"
      "        }\n"
      "}\n"
      "\n"
      "/* q moved by d in the speeds; quaternions p become p exp(d/2). */\n"
      "static void retract(double *q, const double *d)\n"
      "{\n"
      "    int i;\n"
      "    for (i = 0; i < n_motion; i++) {\n"
      "        double *const p = q - 1 - place[i];\n"
      "        double angle, c, s, w[4];\n"
      "        if (place[i] >= 0) {\n"
      "            q[place[i]] += d[i];\n"
      "            continue;\n"
      "        }\n"
      "        angle = sqrt(d[i] * d[i] + d[i + 1] * d[i + 1] + d[i + 2] * d[i + 2]);\n"
      "        c = cos(angle / 2);\n"
      "        s = angle > 0 ? sin(angle / 2) / angle : 0.5;\n"
      "        copy(w, p, 4);\n"
      "        p[0] = w[0] * c - s * (w[1] * d[i] + w[2] * d[i + 1] + w[3] * d[i + 2]);\n"
      "        p[1] = w[1] * c + s * (w[0] * d[i] + w[2] * d[i + 2] - w[3] * d[i + 1]);\n"
      "        p[2] = w[2] * c + s * (w[0] * d[i + 1] + w[3] * d[i] - w[1] * d[i + 2]);\n"
      "        p[3] = w[3] * c + s * (w[0] * d[i + 2] + w[1] * d[i + 1] - w[2] * d[i]);\n"
      "        i += 2;\n"
      "    }\n"
      "    normalise(q);\n"
      "}\n"
      "\n";

static const char text_project[]
    = "/* phi, v, J as they are to be met. */\n"
      "static void constrain(const double *in, double *out)\n"
      "{\n"
      "    @_constraint(in, out);\n"
      "    close_within_data(out);\n"
      "}\n"
      "\n"
      "/* J' d = -r in the sense of least norm, by J of the outputs of constraint. work: NU "
      "NROW + 3 NROW doubles. */\n"
      "static void find_correction(const double *out, const double *r, double *d, double "
      "*work)\n"
      "{\n"
      "    double *const A = work, *const b = A + $_NU * $_NROW, *const rest = b + $_NROW;\n"
      "    int k;\n"
      "    for (k = 0; k < $_NU * $_NROW; k++)\n"
      "        A[k] = 0;\n"
      "    for (k = 0; k < $_NJ; k++)\n"
      "        A[@_J_column[k] + $_NU * @_J_row[k]] = out[$_OUT_J2 + k];\n"
      "    for (k = 0; k < $_NROW; k++)\n"
      "        b[k] = -r[k];\n"
      "    least_norm(A, $_NU, $_NROW, b, d, rest);\n"
      "}\n"
      "\n"
      "int @_project(double *in, double *work)\n"
      "{\n"
      "    double *const before = work, *const out = before + $_NQ + $_NU, *const d = out + "
      "$_NCONSTRAINT,\n"
      "           *const rest = d + $_NU;\n"
      "    double last = INFINITY;\n"
      "    int i, j, k;\n"
      "    copy(before, in + $_Q, $_NQ + $_NU);\n"
      "    normalise(in + $_Q);\n"
      "    for (i = 0;; i++) {\n"
      "        double size;\n"
      "        constrain(in, out);\n"
      "        size = largest(out + $_OUT_PHI, $_NROW);\n"
      "        if (size <= 1e-13 || (size <= 1e-10 && size > last / 4))\n"
      "            break; /* a few round-off errors of coordinates of order 1, or no less can "
      "be had */\n"
      "        if (i == 25 || !(size <= 1e3 * last) || !isfinite(size)) {\n"
      "            copy(in + $_Q, before, $_NQ + $_NU);\n"
      "            return 1;\n"
      "        }\n"
      "        last = size;\n"
      "        find_correction(out, out + $_OUT_PHI, d, rest);\n"
      "        retract(in + $_Q, d);\n"
      "    }\n"
      "    for (i = 0; i < 2; i++) { /* v is linear in u; the second correction takes off "
      "round-off */\n"
      "        find_correction(out, out + $_OUT_V, d, rest);\n"
      "        for (k = 0; k < $_NU; k++)\n"
      "            in[$_U + k] += d[k];\n"
      "        for (k = 0; k < $_NJ; k++) {\n"
      "            j = @_J_row[k];\n"
      "            out[$_OUT_V + j] += out[$_OUT_J2 + k] * d[@_J_column[k]];\n"
      "        }\n"
      "    }\n"
      "    if (are_finite(in + $_Q, $_NQ + $_NU))\n"
      "        return 0;\n"
      "    copy(in + $_Q, before, $_NQ + $_NU);\n"
      "    return 1;\n"
      "}\n"
      "\n";

// ---- switches ---------------------------------------------------------------------------------

static const char text_switch[]
    = "static int side(int i, double g)\n"
      "{\n"
      "    return g * sense[i] > 0 || (!(fabs(g) > 0) && at_zero[i]);\n"
      "}\n"
      "\n"
      "/* Does the state contradict a switch? Where a root is zero the switch may be either. "
      "*/\n"
      "static int is_contradicted(const double *in, double *g)\n"
      "{\n"
      "    int i;\n"
      "    @_roots(in, g);\n"
      "    for (i = 0; i < $_NROOT; i++)\n"
      "        if (fabs(g[i]) > 0 && side(i, g[i]) != (in[$_MODE + i] > 0))\n"
      "            return 1;\n"
      "    return 0;\n"
      "}\n"
      "\n"
      "/* The same where a step ends: a root that has come to zero has changed its side. */\n"
      "static int has_changed(const double *in, double *g)\n"
      "{\n"
      "    int i;\n"
      "    @_roots(in, g);\n"
      "    for (i = 0; i < $_NROOT; i++)\n"
      "        if (side(i, g[i]) != (in[$_MODE + i] > 0))\n"
      "            return 1;\n"
      "    return 0;\n"
      "}\n"
      "\n"
      "/* The least of the roots g, positive on the sides that the switches stand for. */\n"
      "static double least_distance(const double *in, const double *g)\n"
      "{\n"
      "    double least = INFINITY;\n"
      "    int i;\n"
      "    for (i = 0; i < $_NROOT; i++) {\n"
      "        const double distance = in[$_MODE + i] > 0 ? g[i] * sense[i] : -g[i] * "
      "sense[i];\n"
      "        least = distance < least ? distance : least;\n"
      "    }\n"
      "    return least;\n"
      "}\n"
      "\n"
      "void @_switch(double *in)\n"
      "{\n"
      "    double g[$_NROOT + 1];\n"
      "    int i, k, changes = 1;\n"
      "    for (k = 0; k <= $_NROOT && changes; k++) { /* a root may depend on other switches "
      "*/\n"
      "        changes = 0;\n"
      "        @_roots(in, g);\n"
      "        for (i = 0; i < $_NROOT; i++) {\n"
      "            const int now = side(i, g[i]);\n"
      "            changes |= now != (in[$_MODE + i] > 0);\n"
      "            in[$_MODE + i] = now;\n"
      "        }\n"
      "    }\n"
      "}\n"
      "\n";

static const char text_nomemory[] = "void @_memory(double *in)\n"
                                    "{\n"
                                    "    (void)in;\n"
                                    "}\n"
                                    "\n";

static const char text_memory[]
    = "void @_memory(double *in)\n"
      "{\n"
      "    double value[$_NMEMORY + 1];\n"
      "    int i, k;\n"
      "    @_memory_values(in, value);\n"
      "    for (i = 0; i < $_NMEMORY; i++)\n"
      "        if (is_updated[i] == 1 || is_updated[i] == 2)\n"
      "            in[$_MEMORY + i] = value[i];\n"
      "    for (i = 0; i < $_NMEMORY; i++)\n"
      "        if (is_updated[i] == 2) { /* the first number of a quaternion */\n"
      "            double *const p = in + $_MEMORY + i;\n"
      "            const double norm = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * "
      "p[3]);\n"
      "            for (k = 0; k < 4 && norm > 0; k++)\n"
      "                p[k] /= norm;\n"
      "        }\n"
      "}\n"
      "\n";

static const char text_impulse[]
    = "/* Speeds after a jump of driven rates, in no time: M du - J' L = p(before) - p(now), J "
      "du = -v. Nonzero: a place has jumped. */\n"
      "static int strike(double *in, const double *before, double *work)\n"
      "{\n"
      "    enum { n = n_system, m = n_system + 1, drivers = (n_jump - $_NU - 1) / 2, p = 2 * "
      "drivers };\n"
      "    double *const now = work, *const c = now + n_jump, *const out = c + $_NCONSTRAINT, "
      "*const K = out + $_NMOTION,\n"
      "           *const x = K + n * m;\n"
      "    double jump = 0;\n"
      "    int k;\n"
      "    @_jump(in, now);\n"
      "    constrain(in, c);\n"
      "    for (k = 0; k < drivers; k++) {\n"
      "        const double size = fabs(before[2 * k]) > 1 ? fabs(before[2 * k]) : 1;\n"
      "        if (fabs(now[2 * k] - before[2 * k]) > 1e-9 * size)\n"
      "            return 4;\n"
      "        jump = fmax(jump, fabs(now[2 * k + 1] - before[2 * k + 1]));\n"
      "    }\n"
      "    if (largest(c + $_OUT_PHI, $_NROW) > 1e-9)\n"
      "        return 4;\n"
      "    jump = fmax(jump, largest(c + $_OUT_V, $_NROW));\n"
      "    if (!(jump > 1e-9))\n"
      "        return 0;\n"
      "    @_motion(in, out);\n"
      "    put_matrices(out, K, 0);\n"
      "    for (k = 0; k < $_NU; k++)\n"
      "        K[k * m + n] = before[p + k] - now[p + k];\n"
      "    for (k = 0; k < $_NROW; k++)\n"
      "        K[($_NU + k) * m + n] = takes_part(k) && is_kept[k] ? -c[$_OUT_V + k] : 0;\n"
      "    eliminate(K, x);\n"
      "    for (k = 0; k < $_NU; k++)\n"
      "        in[$_U + k] += x[k];\n"
      "    @_jump(in, now);\n"
      "    in[$_WORK] += now[p + $_NU] - before[p + $_NU];\n"
      "    return 0;\n"
      "}\n"
      "\n"
      "/* Something changes here: switches, and speeds that must follow. */\n"
      "static int change(double *in, double *work)\n"
      "{\n"
      "    const double t = in[$_T];\n"
      "    in[$_T] = before_end(t);\n"
      "    @_jump(in, work);\n"
      "    in[$_T] = t;\n"
      "    @_switch(in);\n"
      "    return strike(in, work, work + n_jump);\n"
      "}\n"
      "\n";

static const char text_nojump[] = "static int change(double *in, double *work)\n"
                                  "{\n"
                                  "    (void)work;\n"
                                  "    @_switch(in);\n"
                                  "    return 0;\n"
                                  "}\n"
                                  "\n";

static const char text_nostops[]
    = "static double next_stop(double t, double end, int *is_kink)\n"
      "{\n"
      "    (void)t;\n"
      "    *is_kink = 0;\n"
      "    return end;\n"
      "}\n"
      "\n";

static const char text_theknots[]
    = "/* The next time behind t, up to `end`, where a table has a kink; else `end`. */\n"
      "static double next_stop(double t, double end, int *is_kink)\n"
      "{\n"
      "    int low = 0, high = n_knot;\n"
      "    while (low < high) {\n"
      "        const int middle = (low + high) / 2;\n"
      "        if (knot[middle] > t)\n"
      "            high = middle;\n"
      "        else\n"
      "            low = middle + 1;\n"
      "    }\n"
      "    *is_kink = low < n_knot && knot[low] <= end;\n"
      "    return *is_kink ? knot[low] : end;\n"
      "}\n"
      "\n";

static const char text_beforeend[]
    = "/* At a knot of a table what holds before it counts up to its very instant. */\n"
      "static double before_end(double t)\n"
      "{\n"
      "    return nextafter(t, -INFINITY);\n"
      "}\n"
      "\n";

static const char text_atend[] = "static double before_end(double t)\n"
                                 "{\n"
                                 "    return t;\n"
                                 "}\n"
                                 "\n";

// ---- steps ------------------------------------------------------------------------------------

static const char text_nopower[]
    = "static void add_power(const double *in, const double *power, const double *work)\n"
      "{\n"
      "    (void)in;\n"
      "    (void)power;\n"
      "    (void)work;\n"
      "}\n"
      "\n";

static const char text_power[]
    = "static void add_power(const double *in, double *power, const double *work)\n"
      "{\n"
      "    (void)work;\n"
      "    @_power(in, power);\n"
      "}\n"
      "\n";

static const char text_powerlam[]
    = "static void add_power(double *in, double *power, double *work)\n"
      "{\n"
      "    find_multipliers(in, in + $_LAM, work);\n"
      "    @_power(in, power);\n"
      "}\n"
      "\n";

static const char text_step[]
    = "enum { n_state = $_NQ + $_NU + 1 };\n"
      "\n"
      "/* dy: q', u' and the power. */\n"
      "static void derive(double *in, double *dy, double *work)\n"
      "{\n"
      "    accelerate(in, in + $_A, dy, work);\n"
      "    copy(dy + $_NQ, in + $_A, $_NU);\n"
      "    dy[$_NQ + $_NU] = 0;\n"
      "    add_power(in, dy + $_NQ + $_NU, work);\n"
      "}\n"
      "\n"
      "/* The classical Runge-Kutta method of order 4, switches held. */\n"
      "static void advance(double *in, double h, double *work)\n"
      "{\n"
      "    static const double part[] = {0, 0.5, 0.5, 1}, weight[] = {1, 2, 2, 1};\n"
      "    double *const y = work, *const dy = y + n_state, *const sum = dy + n_state, *const "
      "rest = sum + n_state;\n"
      "    const double t = in[$_T];\n"
      "    int i, k;\n"
      "    copy(y, in + $_Q, $_NQ + $_NU);\n"
      "    y[n_state - 1] = in[$_WORK];\n"
      "    for (i = 0; i < n_state; i++)\n"
      "        dy[i] = sum[i] = 0;\n"
      "    for (k = 0; k < 4; k++) {\n"
      "        in[$_T] = k == 3 ? before_end(t + h) : t + part[k] * h;\n"
      "        for (i = 0; i < n_state - 1; i++)\n"
      "            in[$_Q + i] = y[i] + part[k] * h * dy[i];\n"
      "        in[$_WORK] = y[n_state - 1] + part[k] * h * dy[n_state - 1];\n"
      "        derive(in, dy, rest);\n"
      "        for (i = 0; i < n_state; i++)\n"
      "            sum[i] += weight[k] * dy[i];\n"
      "    }\n"
      "    in[$_T] = t + h;\n"
      "    for (i = 0; i < n_state - 1; i++)\n"
      "        in[$_Q + i] = y[i] + h / 6 * sum[i];\n"
      "    in[$_WORK] = y[n_state - 1] + h / 6 * sum[n_state - 1];\n"
      "}\n"
      "\n"
      "/* From `from` to the time `to`. */\n"
      "static int try_step(double *in, const double *from, double to, double *work)\n"
      "{\n"
      "    copy(in, from, $_NINPUT);\n"
      "    advance(in, to - from[$_T], work);\n"
      "    in[$_T] = to;\n"
      "    if (!are_finite(in + $_Q, $_NQ + $_NU))\n"
      "        return 1;\n"
      "    return @_project(in, work) ? 2 : 0;\n"
      "}\n"
      "\n";

static const char text_locate[]
    = "/* A switch changes between `from` and `in`: `in` becomes the state just behind the "
      "first change. By the rule of false position\n"
      " * that halves the weight of an end which stays (Illinois), with a bisection now and "
      "then for roots with kinks. */\n"
      "static int locate(double *in, const double *from, double *work)\n"
      "{\n"
      "    double *const g = work, *const rest = work + $_NROOT;\n"
      "    double low = from[$_T], high = in[$_T], at_low, at_high;\n"
      "    const double near = 1e-12 * (high - low) + 4 * DBL_EPSILON * fabs(high);\n"
      "    int k, kept = 0, failed = 0;\n"
      "    at_high = has_changed(in, g) ? least_distance(in, g) : 0;\n"
      "    at_low = has_changed(from, g) ? 0 : least_distance(from, g);\n"
      "    for (k = 1; k < 200 && high - low > near; k++) {\n"
      "        const double width = high - low, guess = low + width * at_low / (at_low - "
      "at_high);\n"
      "        const int is_guess = k % 4 && guess > low && guess < high;\n"
      "        double middle = is_guess ? guess : low + width / 2;\n"
      "        if (is_guess) { /* an end that is nearly there is passed, so that the other one "
      "comes near as well */\n"
      "            middle = middle - low < near / 2 ? low + near / 2 : middle;\n"
      "            middle = high - middle < near / 2 ? high - near / 2 : middle;\n"
      "        }\n"
      "        failed = try_step(in, from, middle, rest);\n"
      "        if (failed)\n"
      "            return failed;\n"
      "        if (has_changed(in, g)) {\n"
      "            high = middle;\n"
      "            at_high = least_distance(in, g);\n"
      "            at_low = kept == 1 ? at_low / 2 : at_low;\n"
      "            kept = 1;\n"
      "        } else {\n"
      "            low = middle;\n"
      "            at_low = least_distance(in, g);\n"
      "            at_high = kept == 2 ? at_high / 2 : at_high;\n"
      "            kept = 2;\n"
      "        }\n"
      "    }\n"
      "    return in[$_T] < high ? try_step(in, from, high, rest) : 0;\n"
      "}\n"
      "\n";

static const char text_thestep[]
    = "int @_step(double *in, double h, double *work)\n"
      "{\n"
      "    enum { most = 8 };\n"
      "    double *const begin = work, *const from = begin + $_NINPUT, *const rest = from + "
      "$_NINPUT;\n"
      "    const double end = in[$_T] + h;\n"
      "    int count = 0, is_late = 0, failed = !(h >= 0 && isfinite(end));\n"
      "    copy(begin, in, $_NINPUT);\n"
      "    if (!failed && is_contradicted(in, rest)) /* values have been set */\n"
      "        @_switch(in);\n"
      "    while (!failed && in[$_T] < end) {\n"
      "        int is_change, is_kink;\n"
      "        const double to = next_stop(in[$_T], end, &is_kink);\n"
      "        copy(from, in, $_NINPUT);\n"
      "        failed = try_step(in, from, to, rest);\n"
      "        is_change = !failed && has_changed(in, rest);\n"
      "        if (is_change && count++ < most)\n"
      "            failed = locate(in, from, rest);\n"
      "        else if (is_change)\n"
      "            is_late = 3;\n"
      "        @_memory(in);\n"
      "        if (!failed && (is_change || (is_kink && !(in[$_T] < to))))\n"
      "            failed = change(in, rest);\n"
      "    }\n"
      "    if (failed)\n"
      "        copy(in, begin, $_NINPUT);\n"
      "    return failed ? failed : is_late;\n"
      "}\n"
      "\n";

static const char text_thesmoothstep[]
    = "int @_step(double *in, double h, double *work)\n"
      "{\n"
      "    double *const begin = work, *const rest = begin + $_NINPUT;\n"
      "    const double end = in[$_T] + h;\n"
      "    int failed = !(h >= 0 && isfinite(end));\n"
      "    copy(begin, in, $_NINPUT);\n"
      "    if (!failed && h > 0)\n"
      "        failed = try_step(in, begin, end, rest);\n"
      "    if (failed)\n"
      "        copy(in, begin, $_NINPUT);\n"
      "    else\n"
      "        @_memory(in);\n"
      "    return failed;\n"
      "}\n"
      "\n";

// ---- functions of a state ----------------------------------------------------------------------

static const char text_parameters[] = "void @_parameters(double *in)\n"
                                      "{\n"
                                      "    double value[$_NPARAMETER + 1];\n"
                                      "    @_parameter_values(in, value);\n"
                                      "    copy(in + $_PARAMETER, value, $_NPARAMETER);\n"
                                      "}\n"
                                      "\n";

static const char text_noparameters[] = "void @_parameters(double *in)\n"
                                        "{\n"
                                        "    (void)in;\n"
                                        "}\n"
                                        "\n";

static const char text_outputswithout[] = "void @_outputs(const double *in, double *out)\n"
                                          "{\n"
                                          "    @_output_values(in, out);\n"
                                          "}\n"
                                          "\n";

static const char text_outputswitha[]
    = "void @_outputs(const double *in, double *out)\n"
      "{\n"
      "    double all[$_NINPUT], work[$_NWORK];\n"
      "    copy(all, in, $_NINPUT);\n"
      "    accelerate(all, all + $_A, work + n_accelerate, work);\n"
      "    @_output_values(all, out);\n"
      "}\n"
      "\n";

static const char text_outputswith[]
    = "void @_outputs(const double *in, double *out)\n"
      "{\n"
      "    double all[$_NINPUT], work[$_NWORK];\n"
      "    copy(all, in, $_NINPUT);\n"
      "    accelerate(all, all + $_A, work + n_accelerate, work);\n"
      "    find_multipliers(all, all + $_LAM, work);\n"
      "    @_output_values(all, out);\n"
      "}\n"
      "\n";

static const char text_loopsoutputs[]
    = "int @_multipliers(const double *in, double *lam, double *work)\n"
      "{\n"
      "    double *const all = work, *const rest = all + $_NINPUT;\n"
      "    copy(all, in, $_NINPUT);\n"
      "    accelerate(all, all + $_A, rest + n_accelerate, rest);\n"
      "    return !are_finite(all + $_A, $_NU) || find_multipliers(all, lam, rest);\n"
      "}\n"
      "\n";

static const char text_reactions[]
    = "int @_reactions(const double *in, double *out, double *work)\n"
      "{\n"
      "    double *const all = work, *const rest = all + $_NINPUT;\n"
      "    copy(all, in, $_NINPUT);\n"
      "    accelerate(all, all + $_A, rest + n_accelerate, rest);\n"
      "    if (!are_finite(all + $_A, $_NU) || find_multipliers(all, all + $_LAM, rest))\n"
      "        return 1;\n"
      "    @_reaction_values(all, out);\n"
      "    return 0;\n"
      "}\n"
      "\n";

// ---- entry point -------------------------------------------------------------------------------

static void put(struct ct_export_text *t, const char *s)
{
    ct_export_put_named(t, s);
}

static void put_numbers(struct ct_export_text *t, const char *declaration, const double *v,
                        size_t n)
{
    ct_export_putf(t, "static const double %s[] = ", declaration);
    ct_export_put_numbers(t, v, n);
    ct_export_put(t, ";\n");
}

static void put_integers(struct ct_export_text *t, const char *declaration, const int *v,
                         size_t n)
{
    ct_export_putf(t, "static const int %s[] = ", declaration);
    ct_export_put_integers(t, v, n);
    ct_export_put(t, ";\n");
}

bool ct_export_has_events(const struct ct_export *x)
{
    return x->e->nswitch || x->nknot;
}

static void put_fixed(struct ct_export_text *t, const struct ct_export *x)
{
    if (!x->solved || !x->e->nu) {
        put(t, text_nofixed);
        return;
    }
    ct_export_putf(t, "enum { n_free = %zu, n_pivot = %zu, rank_fixed = %zu };\n", x->nfree,
                   x->npivot, x->e->nu + x->rank);
    put_numbers(t, "scale", x->scale, x->npivot);
    ct_export_putf(t, "static const double weakest = %s;\n\n",
                   ct_number_c(t->arena, x->weakest));
    put(t, text_fixed);
}

static void put_data(struct ct_export_text *t, const struct ct_export *x)
{
    const size_t n = x->e->nrow;
    int *out = CT_NEWN(t->arena, int, n + 1);
    for (size_t i = 0; i < n && x->left_out; i++)
        out[i] = x->left_out[i];
    if (x->left_out) {
        put_integers(t, "left_out", out, n);
        put_numbers(t, "open", x->open, n);
    }
    put(t, x->left_out ? text_inexact : text_exact);
    int *kept = CT_NEWN(t->arena, int, n + 1);
    for (size_t i = 0; i < x->rank; i++)
        kept[x->row[i]] = 1;
    put_integers(t, "is_kept", kept, n);
    ct_export_putf(t, "enum { n_kept = %zu };\n\n", x->rank);
}

// Print for each speed its coordinate; for one of the three speeds of a quaternion, -1 minus the
// index of its first number.
static void put_places(struct ct_export_text *t, const struct ct_equations *e)
{
    int *place = CT_NEWN(t->arena, int, e->nu + 1), next = 0;
    bool has_quaternions = false;
    for (size_t k = 0; k < e->nmotion; k++) {
        place[k] = e->u[k].q;
        if (e->u[k].q >= 0)
            continue;
        while (e->q[next].quaternion != 0)
            next++;
        place[k] = place[k + 1] = place[k + 2] = -1 - next++;
        has_quaternions = true;
        k += 2;
    }
    put_integers(t, "place", place, e->nmotion);
    ct_export_putf(t, "enum { n_motion = %zu }; /* speeds; states have no coordinate */\n\n",
                   e->nmotion);
    put(t, has_quaternions ? text_quaternions : text_noquaternions);
}

static void put_switches(struct ct_export_text *t, const struct ct_equations *e,
                         bool has_events)
{
    int *sense = CT_NEWN(t->arena, int, e->nswitch + 1),
        *at_zero = CT_NEWN(t->arena, int, e->nswitch + 1);
    for (size_t i = 0; i < e->nswitch; i++) {
        const enum ct_op op = e->switches[i].op;
        sense[i] = op == CT_OP_GT || op == CT_OP_GE ? 1 : -1;
        at_zero[i] = op == CT_OP_LE || op == CT_OP_GE;
    }
    if (!has_events) {
        put(t, "void @_switch(double *in)\n{\n    (void)in;\n}\n\n");
        return;
    }
    put_integers(t, "sense", sense, e->nswitch);
    put_integers(t, "at_zero", at_zero, e->nswitch);
    put(t, text_switch);
}

static void put_memory(struct ct_export_text *t, const struct ct_equations *e)
{
    int *is_updated = CT_NEWN(t->arena, int, e->nmemory + 1);
    for (size_t i = 0; i < e->nmemory; i++) {
        const struct ct_memory *m = &e->memory[i];
        is_updated[i] = m->kind == CT_MEMORY_TURNS                       ? 3
                      : !ct_memory_is_updated(m)                         ? 0
                      : m->kind == CT_MEMORY_QUATERNION && m->index == 0 ? 2
                                                                         : 1;
    }
    if (e->nmemory)
        put_integers(t, "is_updated", is_updated, e->nmemory);
    put(t, e->nmemory ? text_memory : text_nomemory);
}

void ct_export_put_next_stop(struct ct_export_text *t, size_t nknot)
{
    put(t, nknot ? text_theknots : text_nostops);
}

static void put_changes(struct ct_export_text *t, const struct ct_export *x)
{
    put(t, x->nknot ? text_beforeend : text_atend);
    if (!ct_export_has_events(x))
        return;
    if (x->nknot) {
        ct_export_putf(t, "enum { n_knot = %zu };\n", x->nknot);
        put_numbers(t, "knot", x->knot, x->nknot);
    }
    ct_export_put_next_stop(t, x->nknot);
    put(t, x->jump ? text_impulse : text_nojump);
}

static void put_step(struct ct_export_text *t, const struct ct_export *x)
{
    put(t, !x->power ? text_nopower : x->power_needs_lam ? text_powerlam : text_power);
    put(t, text_step);
    if (ct_export_has_events(x))
        put(t, text_locate);
    put(t, ct_export_has_events(x) ? text_thestep : text_thesmoothstep);
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

// Doubles of workspace for accelerations, without the rates after them.
static size_t work_of_accelerate(const struct ct_export *x)
{
    const size_t n = x->e->nu + x->e->nrow;
    return larger(x->motion->nout + n * (n + 2), x->solved ? x->solved->nout : 0);
}

size_t ct_export_work(const struct ct_export *x)
{
    const struct ct_equations *e = x->e;
    const size_t nu = e->nu, nrow = e->nrow, n = nu + nrow, nstate = e->nq + nu + 1,
                 njump = x->jump ? x->jump->nout : 0,
                 accelerate = work_of_accelerate(x) + e->nq,
                 multipliers = x->motion->nout + nu + nrow * nu + 2 * nu,
                 project = e->nq + nu + x->constraint->nout + nu + nu * nrow + 3 * nrow,
                 strike = 2 * njump + x->constraint->nout + x->motion->nout + n * (n + 2),
                 advance = 3 * nstate + larger(accelerate, multipliers),
                 try_step = larger(advance, project);
    const size_t step = 2 * x->ninput + e->nswitch + larger(try_step, x->jump ? strike : 0);
    return larger(step, x->ninput + larger(accelerate, multipliers));
}

bool ct_export_has_derived(const struct ct_export *x)
{
    for (size_t i = 0; i < x->parameters.n; i++)
        if (x->parameters.item[i].is_derived)
            return true;
    return false;
}

void ct_export_runtime(struct ct_export_text *t, const struct ct_export *x)
{
    put(t, text_helpers);
    put_data(t, x);
    ct_export_putf(t, "enum { n_accelerate = %zu };\n\n", work_of_accelerate(x));
    put_fixed(t, x);
    put(t, text_solver);
    put(t, text_least);
    put(t, text_multipliers);
    put_places(t, x->e);
    put(t, text_project);
    put_switches(t, x->e, ct_export_has_events(x));
    put_memory(t, x->e);
    put_changes(t, x);
    put_step(t, x);
    put(t, ct_export_has_derived(x) ? text_parameters : text_noparameters);
    put(t, x->needs_lam ? text_outputswith
           : x->needs_a ? text_outputswitha
                        : text_outputswithout);
    put(t, text_loopsoutputs);
    put(t, text_reactions);
}
