// Gives pseudo-random variations of the *.yaml files in the folders named to the fuzz target.
//   mutate COUNT FOLDER...
//
// The generator has a fixed seed and files are taken in the order of their names: each run sees the
// same inputs. A failing one is left in mutate-failed.yaml, as the last written before the crash,
// when the environment has MUTATE_KEEP.
#include "tests/fuzz/target.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LARGEST = 1 << 14, MOST_FILES = 1024 };

struct text {
    uint8_t data[LARGEST];
    size_t n;
};

// pieces that matter to the reader, put in at random places
static const char *const token[] = {
    "\n",        ": ",       "- ",      "[",        "]",
    "{",         "}",        ", ",      "\"",       "'",
    "~",         "&a ",      "*a",      "<<",       "---\n",
    "# ",        "\t",       "|\n",     "!!x ",     "\xef\xbb\xbf",
    "\xff",      "é",        "\\",      "0",        "-1",
    "1e999",     ".nan",     "1e-400",  " mm",      " kg*m^2",
    "deg",       "^",        "(",       ")",        "sin(",
    "if(",       "t",        "pi",      ".q",       ".q9",
    "in ",       "ground",   "x",       "z",        "type: ",
    "axis: ",    "joints:",  "bodies:", "points: ", "motion: ",
    "initial: ", "free",     "gear",    "custom",   "spherical",
    "particle",  "rotate: ", "guess: ", "table: ",  "coordinates: ",
    "null",      "true",     "..",
};

static uint64_t state = 0x9e3779b97f4a7c15u;

// xorshift64*: n is small against 2^32, so the bias does not matter
static size_t random_below(size_t n)
{
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return (size_t)((state * 0x2545f4914f6cdd1du) >> 33) % n;
}

static void insert(struct text *t, size_t at, const void *piece, size_t n)
{
    if (t->n + n > LARGEST)
        return;
    memmove(t->data + at + n, t->data + at, t->n - at);
    memmove(t->data + at, piece, n);
    t->n += n;
}

static void erase(struct text *t, size_t at, size_t n)
{
    if (n > t->n - at)
        n = t->n - at;
    memmove(t->data + at, t->data + at + n, t->n - at - n);
    t->n -= n;
}

static void edit(struct text *t, const struct text *other)
{
    const size_t at = random_below(t->n + 1), n = 1 + random_below(40);
    uint8_t copy[64];
    switch (random_below(6)) {
    case 0:
        if (at < t->n)
            t->data[at] = (uint8_t)random_below(256);
        break;
    case 1:
        erase(t, at, n);
        break;
    case 2: {
        const char *s = token[random_below(sizeof token / sizeof token[0])];
        insert(t, at, s, strlen(s));
        break;
    }
    case 3: // a piece of this text again
        if (at + n <= t->n) {
            memcpy(copy, t->data + at, n);
            insert(t, random_below(t->n + 1), copy, n);
        }
        break;
    case 4: // a piece of another text
        if (at + n <= other->n)
            insert(t, random_below(t->n + 1), other->data + at, n);
        break;
    default: // a token in place of what stood there
        erase(t, at, 1 + random_below(8));
        const char *s = token[random_below(sizeof token / sizeof token[0])];
        insert(t, at, s, strlen(s));
    }
}

static int compare(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static size_t list_folder(const char *folder, char **path, size_t n)
{
    DIR *d = opendir(folder);
    if (!d) {
        perror(folder);
        exit(1);
    }
    const size_t first = n;
    for (const struct dirent *e; (e = readdir(d)) && n < MOST_FILES;) {
        const char *dot = strrchr(e->d_name, '.');
        if (!dot || strcmp(dot, ".yaml") != 0)
            continue;
        path[n] = malloc(strlen(folder) + strlen(e->d_name) + 2);
        if (!path[n])
            exit(1);
        sprintf(path[n++], "%s/%s", folder, e->d_name);
    }
    closedir(d);
    qsort(path + first, n - first, sizeof *path, compare);
    return n;
}

static void read_text(const char *path, struct text *t)
{
    FILE *f = fopen(path, "rb");
    t->n = f ? fread(t->data, 1, LARGEST, f) : 0;
    if (f)
        fclose(f);
}

static void keep(const struct text *t)
{
    FILE *f = getenv("MUTATE_KEEP") ? fopen("mutate-failed.yaml", "wb") : NULL;
    if (f) {
        fwrite(t->data, 1, t->n, f);
        fclose(f);
    }
}

int main(int argc, char **argv)
{
    static char *path[MOST_FILES];
    static struct text seed, other;
    size_t n = 0;
    for (int i = 2; i < argc; i++)
        n = list_folder(argv[i], path, n);
    const long count = argc > 1 ? atol(argv[1]) : 0;
    for (long i = 0; i < count && n; i++) {
        read_text(path[random_below(n)], &seed);
        read_text(path[random_below(n)], &other);
        for (size_t edits = 1 + random_below(6); edits-- > 0;)
            edit(&seed, &other);
        keep(&seed);
        LLVMFuzzerTestOneInput(seed.data, seed.n);
    }
    printf("%ld variations of %zu files\n", count, n);
    for (size_t i = 0; i < n; i++)
        free(path[i]);
    return n == 0;
}
