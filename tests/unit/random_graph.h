// What the tests of graphs share: an arena per test and random graphs.
#ifndef CT_TEST_RANDOM_GRAPH_H
#define CT_TEST_RANDOM_GRAPH_H

#include "graph/graph.h"

#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct ct_arena *arena;

static inline int setup(void **state)
{
    (void)state;
    arena = ct_arena_create();
    return !arena;
}

static inline int teardown(void **state)
{
    (void)state;
    ct_arena_destroy(arena);
    return 0;
}

static uint64_t seed;

/// Uniform in 0 .. n - 1; 64-bit congruential generator, constants of Knuth (MMIX).
static inline int draw(int n)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (int)((seed >> 33) % (uint64_t)n);
}

static inline void start_random(void)
{
    const char *given = getenv("CT_TEST_SEED");
    seed = given ? strtoull(given, NULL, 10) : 20240611;
    print_message("seed %llu (CT_TEST_SEED)\n", (unsigned long long)seed);
}

/// A connected multigraph of 1 .. maxnode nodes: a random tree and up to maxextra further
/// edges, parallel ones included, orientations and edge order random.
static inline struct ct_graph random_graph(int maxnode, int maxextra)
{
    const int nnode = 1 + draw(maxnode), nextra = nnode > 1 ? draw(maxextra + 1) : 0;
    const int nedge = nnode - 1 + nextra;
    struct ct_edge *edge = CT_NEWN(arena, struct ct_edge, nedge);
    for (int e = 0; e < nedge; e++) {
        int a = e < nnode - 1 ? e + 1 : draw(nnode);
        int b = e < nnode - 1 ? draw(e + 1) : draw(nnode - 1);
        b += e >= nnode - 1 && b >= a;
        edge[e] = draw(2) ? (struct ct_edge){a, b} : (struct ct_edge){b, a};
    }
    for (int e = nedge - 1; e > 0; e--) {
        const int other = draw(e + 1);
        const struct ct_edge swap = edge[e];
        edge[e] = edge[other];
        edge[other] = swap;
    }
    return (struct ct_graph){nnode, nedge, edge};
}

static inline int *random_weights(int n, int below)
{
    int *w = CT_NEWN(arena, int, n);
    for (int i = 0; i < n; i++)
        w[i] = draw(below);
    return w;
}

#endif
