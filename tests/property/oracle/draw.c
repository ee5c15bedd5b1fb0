// See draw.h.
#include "tests/property/oracle/draw.h"

// splitmix64 (Steele, Lea, Flood 2014)
static uint64_t next(struct draw *d)
{
    uint64_t z = (d->state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

double between(struct draw *d, double low, double high)
{
    return low + (high - low) * (double)(next(d) >> 11) / 9007199254740992.0;
}

int one_of(struct draw *d, int n)
{
    return (int)(next(d) % (uint64_t)n);
}

bool happens(struct draw *d, double probability)
{
    return between(d, 0, 1) < probability;
}

struct vector somewhere(struct draw *d, double r)
{
    struct vector v;
    for (int i = 0; i < 3; i++)
        v.e[i] = between(d, -r, r);
    return v;
}

struct vector direction(struct draw *d)
{
    struct vector v;
    do
        v = somewhere(d, 1);
    while (norm(v) < 0.3 || norm(v) > 1);
    return unit(v);
}

struct axes orientation(struct draw *d)
{
    return rotation(direction(d), between(d, -3, 3));
}

struct vector across(struct draw *d, struct vector n)
{
    struct vector v;
    do
        v = cross(n, direction(d));
    while (norm(v) < 0.3);
    return unit(v);
}
