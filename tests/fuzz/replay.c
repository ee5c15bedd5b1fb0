// Gives every file of the folders named as arguments to the fuzz target, and each file's
// beginnings: a text cut short is the commonest broken one.
#include "tests/fuzz/target.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>

static long replay_file(const char *path)
{
    FILE *f = fopen(path, "rb");
    if (!f) {
        perror(path);
        exit(1);
    }
    enum { LARGEST = 1 << 16 };
    static uint8_t data[LARGEST];
    const size_t size = fread(data, 1, LARGEST, f);
    fclose(f);
    for (size_t n = 0; n <= size; n++)
        LLVMFuzzerTestOneInput(data, n);
    return (long)size + 1;
}

static long replay_folder(const char *folder)
{
    DIR *d = opendir(folder);
    if (!d) {
        perror(folder);
        exit(1);
    }
    long count = 0;
    for (const struct dirent *e; (e = readdir(d));) {
        if (e->d_name[0] == '.')
            continue;
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
        count += replay_file(path);
    }
    closedir(d);
    return count;
}

int main(int argc, char **argv)
{
    long count = 0;
    for (int i = 1; i < argc; i++)
        count += replay_folder(argv[i]);
    printf("%ld inputs\n", count);
    return count == 0;
}
