// See layout.h.
#include "html/layout.h"

#include <math.h>

enum { MOST_SWEEPS = 300 }; // Limit: of the time of the layout
// Layout: [px] vertices move by less than a pixel in all sweeps that would follow.
static const double still = 1e-2;

// d (n x n) = lengths of shortest paths along edges, by the algorithm of Floyd and Warshall.
static void find_distances(const struct ct_graph *g, const double *length, double *d)
{
    const size_t n = (size_t)g->nnode;
    for (size_t i = 0; i < n * n; i++)
        d[i] = i % (n + 1) ? INFINITY : 0;
    for (int e = 0; e < g->nedge; e++) {
        const size_t a = (size_t)g->edge[e].tail, b = (size_t)g->edge[e].head;
        d[a + n * b] = d[b + n * a] = fmin(d[a + n * b], length[e]);
    }
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n; j++)
                d[i + n * j] = fmin(d[i + n * j], d[i + n * k] + d[k + n * j]);
}

// Initial positions: vertices on a circle in their order, ground in its middle. No two
// coincide.
static void start(struct ct_place *at, size_t n, double radius)
{
    const double turn = 2 * acos(-1) / (double)n;
    for (size_t i = 0; i < n; i++)
        at[i] = (struct ct_place){i ? radius * cos(turn * (double)i) : 0,
                                  i ? radius * sin(turn * (double)i) : 0};
}

// Moves vertex i to the minimum of its stress, with weights d^-2, to first order. Returns the
// distance moved.
static double move(struct ct_place *at, const double *d, size_t n, size_t i)
{
    double x = 0, y = 0, sum = 0;
    for (size_t j = 0; j < n; j++) {
        const double want = d[i + n * j];
        if (j == i || !(want > 0) || isinf(want))
            continue;
        const double dx = at[i].x - at[j].x, dy = at[i].y - at[j].y;
        // Layout: against division by zero
        const double r = fmax(hypot(dx, dy), 1e-9 * want), w = 1 / (want * want);
        x += w * (at[j].x + want * dx / r);
        y += w * (at[j].y + want * dy / r);
        sum += w;
    }
    if (!(sum > 0))
        return 0;
    const struct ct_place to = {x / sum, y / sum};
    const double moved = hypot(to.x - at[i].x, to.y - at[i].y);
    at[i] = to;
    return moved;
}

// Rotates the layout so that its largest extent is along x and the first vertex is on the left.
static void align(struct ct_place *at, size_t n)
{
    double cx = 0, cy = 0, xx = 0, xy = 0, yy = 0;
    for (size_t i = 0; i < n; i++) {
        cx += at[i].x / (double)n;
        cy += at[i].y / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        at[i].x -= cx;
        at[i].y -= cy;
        xx += at[i].x * at[i].x;
        xy += at[i].x * at[i].y;
        yy += at[i].y * at[i].y;
    }
    const double angle = 0.5 * atan2(2 * xy, xx - yy);
    double c = cos(angle), s = sin(angle);
    if (c * at[0].x + s * at[0].y > 0) {
        c = -c;
        s = -s;
    }
    for (size_t i = 0; i < n; i++)
        at[i] = (struct ct_place){c * at[i].x + s * at[i].y, -s * at[i].x + c * at[i].y};
}

void ct_layout_find(struct ct_arena *scratch, const struct ct_graph *g, const double *length,
                    struct ct_place *at)
{
    const size_t n = (size_t)g->nnode;
    double *d = CT_NEWN(scratch, double, n *n + 1), longest = 0;
    find_distances(g, length, d);
    for (size_t i = 0; i < n * n; i++)
        if (isfinite(d[i]))
            longest = fmax(longest, d[i]);
    start(at, n, longest / 2);
    double moved = INFINITY;
    for (int k = 0; k < MOST_SWEEPS && moved > still; k++) {
        moved = 0;
        for (size_t i = 0; i < n; i++)
            moved = fmax(moved, move(at, d, n, i));
    }
    align(at, n);
}
